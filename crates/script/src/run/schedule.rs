//! The steps that apply in each scan.

use super::rows::Rows;
use crate::model::{Script, When};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Largest number of steps that may wait for their scan.
pub(crate) const PENDING_MAX: usize = 1 << 22;

/// The steps to come, and the conditional ones that wait for their conditions.
#[derive(Clone, Debug)]
pub(crate) struct Schedule {
    /// Scans and the indices of the steps that apply then, the next one on top; steps of one scan apply in file order.
    due: BinaryHeap<Reverse<(u64, usize)>>,
    /// For each step: it applies when its conditions hold next.
    armed: Vec<bool>,
    /// Some steps wait for conditions.
    watches: bool,
}

impl Schedule {
    pub(crate) fn new(script: &Script) -> Self {
        let steps = (0..).zip(&script.steps);
        // Reserves memory for all steps, so that a scan does not allocate for them.
        let mut due = BinaryHeap::with_capacity(2 * script.steps.len());
        due.extend(steps.filter_map(|(index, step)| match step.when {
            When::At(scan) => Some(Reverse((scan, index))),
            When::Holds { .. } => None,
        }));
        Self {
            due,
            armed: vec![true; script.steps.len()],
            watches: script
                .steps
                .iter()
                .any(|step| matches!(step.when, When::Holds { .. })),
        }
    }

    /// Whether steps need rows to be read.
    pub(crate) const fn watches(&self) -> bool {
        self.watches
    }

    /// The next step of this scan, in file order; each is given once.
    pub(crate) fn take(&mut self, scan: u64) -> Option<usize> {
        let Reverse((due, _)) = self.due.peek()?;
        if *due > scan {
            return None;
        }
        let Reverse((_, index)) = self.due.pop()?;
        Some(index)
    }

    /// Number of scans from this one on without a step, as far as is known.
    pub(crate) fn free_from(&self, scan: u64) -> u64 {
        self.due
            .peek()
            .map_or(u64::MAX, |Reverse((due, _))| due.saturating_sub(scan))
    }

    /// Whether more steps are waiting than permitted.
    pub(crate) fn is_full(&self) -> bool {
        self.due.len() > PENDING_MAX
    }

    /// Reads the row of `scan`: conditions that hold on it schedule their step `after` scans later than
    /// the next latch.
    pub(crate) fn look(&mut self, rows: &Rows<'_>, scan: u64) {
        for (index, (step, armed)) in rows.script.steps.iter().zip(&mut self.armed).enumerate() {
            let When::Holds {
                conditions,
                after,
                every,
            } = &step.when
            else {
                continue;
            };
            // A step that applies once and has applied need not be checked again.
            if !*armed && !*every {
                continue;
            }
            let holds = rows.hold(conditions, scan);
            if holds && *armed {
                let apply = scan.saturating_add(1).saturating_add(*after);
                self.due.push(Reverse((apply, index)));
            }
            *armed = !holds;
        }
    }
}

//! Which steps apply in which scan.

use super::rows::Rows;
use crate::model::{Script, When};

/// The steps to come, and which of the conditional ones wait for their conditions.
#[derive(Clone, Debug)]
pub(crate) struct Schedule {
    /// Scans and the indices of the steps that apply then, the last one first; steps of one scan apply in file order.
    due: Vec<(u64, usize)>,
    /// Per step: it applies when its conditions hold next.
    armed: Vec<bool>,
}

impl Schedule {
    pub(crate) fn new(script: &Script) -> Self {
        let steps = (0..).zip(&script.steps);
        // With room for every step to come, so that a scan takes no memory for them.
        let mut due = Vec::with_capacity(2 * script.steps.len());
        due.extend(steps.filter_map(|(index, step)| match step.when {
            When::At(scan) => Some((scan, index)),
            When::Holds { .. } => None,
        }));
        due.sort_unstable_by(|one, other| other.cmp(one));
        Self {
            due,
            armed: vec![true; script.steps.len()],
        }
    }

    /// The next step of this scan, in file order; each is given once.
    pub(crate) fn take(&mut self, scan: u64) -> Option<usize> {
        let (_, index) = self.due.pop_if(|(due, _)| *due <= scan)?;
        Some(index)
    }

    /// Looks at the row of `scan`: conditions that hold on it bring their step `after` scans later than the
    /// next latch.
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
            // A step that applies once and has applied need not be looked at again.
            if !*armed && !*every {
                continue;
            }
            let holds = rows.hold(conditions, scan);
            if holds && *armed {
                let apply = scan.saturating_add(1).saturating_add(*after);
                let entry = (apply, index);
                if let Err(place) = self.due.binary_search_by(|other| entry.cmp(other)) {
                    self.due.insert(place, entry);
                }
            }
            *armed = !holds;
        }
    }
}

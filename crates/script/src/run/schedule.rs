//! Which steps apply in which scan.

use super::rows::Rows;
use crate::model::{Script, When};
use std::collections::{BTreeMap, BTreeSet};

/// The steps to come, and which of the conditional ones wait for their conditions.
#[derive(Clone, Debug)]
pub(crate) struct Schedule {
    /// Indices of the steps per scan; a set, because steps of one scan apply in file order.
    due: BTreeMap<u64, BTreeSet<usize>>,
    /// Per step: it applies when its conditions hold next.
    armed: Vec<bool>,
}

impl Schedule {
    pub(crate) fn new(script: &Script) -> Self {
        let mut due: BTreeMap<u64, BTreeSet<usize>> = BTreeMap::new();
        for (index, step) in script.steps.iter().enumerate() {
            if let When::At(scan) = step.when {
                due.entry(scan).or_default().insert(index);
            }
        }
        Self {
            due,
            armed: vec![true; script.steps.len()],
        }
    }

    /// The steps of this scan, in file order.
    pub(crate) fn take(&mut self, scan: u64) -> BTreeSet<usize> {
        self.due.remove(&scan).unwrap_or_default()
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
                self.due.entry(apply).or_default().insert(index);
            }
            *armed = !holds;
        }
    }
}

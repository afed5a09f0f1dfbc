//! What the axes recorded, as notes in the trace.

use super::bench::{ScriptMachine, instance_id};
use super::rows::Shift;
use crate::model::Script;
use standstill_axis::{Event, LOG_KEPT};
use standstill_record::told::{Names, note};
use standstill_trace::{Note, Trace};

/// How many records have been taken from the ring so far, and what they speak of.
#[derive(Clone, Debug)]
pub(crate) struct Notes {
    taken: u64,
    names: Names,
}

impl Notes {
    pub(crate) fn new(script: &Script) -> Self {
        let names = Names {
            axes: script.axes.iter().map(|axis| axis.name.clone()).collect(),
            instances: (0..)
                .zip(&script.blocks)
                .map(|(index, instance)| (instance_id(index).0, instance.name.clone()))
                .collect(),
        };
        Self { taken: 0, names }
    }

    /// Gives a block instance of a guest its name.
    pub(crate) fn name(&mut self, id: u16, name: String) {
        self.names.instances.insert(id, name);
    }

    /// Takes this scan's records into the trace.
    pub(crate) fn take(&mut self, machine: &ScriptMachine, trace: &mut Trace, shifts: &mut Vec<Shift>) {
        let log = machine.log();
        let lost = (log.total() - self.taken).saturating_sub(LOG_KEPT as u64);
        let records: Vec<_> = log.since(self.taken).collect();
        self.taken = log.total();
        let scan = trace.scans().saturating_sub(1);
        if lost > 0 {
            trace.push_note(Note {
                scan,
                subject: "log".to_owned(),
                text: format!("{lost} records of this scan are lost: the ring holds {LOG_KEPT}"),
            });
        }
        for (index, record) in records.iter().enumerate() {
            if let Event::Shifted { by } = record.event {
                shifts.push(Shift {
                    scan: record.scan,
                    axis: record.axis.index(),
                    by,
                });
            }
            // Only the last plan of an axis in a scan is still there to be told in full.
            let replaced = records
                .iter()
                .skip(index + 1)
                .any(|later| later.axis == record.axis && matches!(later.event, Event::Planned { .. }));
            let axis = machine.axes().get(record.axis.index());
            let plan = axis
                .and_then(|axis| axis.plan())
                .map(|(plan, _)| plan)
                .filter(|_| !replaced);
            let scan = usize::try_from(record.scan).unwrap_or(scan);
            trace.push_note(note(&self.names, record, scan, plan));
        }
    }
}

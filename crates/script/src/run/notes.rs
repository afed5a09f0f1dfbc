//! The records of the axes, as notes in the trace.

use super::bench::{ScriptMachine, instance_id};
use super::rows::Shift;
use crate::model::Script;
use standstill_axis::{AxisId, Event, LOG_KEPT, Log, Record};
use standstill_record::told::{Names, note};
use standstill_scan::RUNTIME;
use standstill_trace::{Note, Trace};

/// The records of the scan, with the plans they refer to.
#[derive(Clone, Debug)]
pub(crate) struct Notes {
    /// Records taken from the ring so far.
    taken: u64,
    /// Those of this scan.
    records: Vec<Record>,
    /// Records of this scan that the ring lost before they were taken.
    lost: u64,
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
        Self {
            taken: 0,
            records: Vec::new(),
            lost: 0,
            names,
        }
    }

    /// Gives a block instance of a guest its name.
    pub(crate) fn name(&mut self, id: u16, name: String) {
        self.names.instances.insert(id, name);
    }

    /// Takes the records since the last call. The ring holds [`LOG_KEPT`] records and a scan may have more, so this
    /// is called between the steps of a scan and after every block.
    pub(crate) fn collect(&mut self, log: &Log) {
        let total = log.total();
        if total == self.taken {
            return;
        }
        self.lost += (total - self.taken).saturating_sub(LOG_KEPT as u64);
        self.records.extend(log.since(self.taken).copied());
        self.taken = total;
    }

    /// Drops this scan's records.
    pub(crate) fn drop_all(&mut self) {
        self.records.clear();
        self.lost = 0;
    }

    /// Writes this scan's records into the trace, and the shifts of coordinates that the ring has lost.
    pub(crate) fn take(&mut self, machine: &ScriptMachine, trace: &mut Trace) {
        self.collect(machine.log());
        let (lost, records) = (std::mem::take(&mut self.lost), &self.records);
        let scan = trace.scans().saturating_sub(1);
        if lost > 0 {
            trace.push_note(Note {
                scan,
                subject: "log".to_owned(),
                text: format!("{lost} records of this scan are lost: the ring holds {LOG_KEPT}"),
            });
        }
        for Shift { axis, by, .. } in shifts_of(machine, scan) {
            // Claims are judged by the notes of a trace when the axes no longer exist.
            let axis = machine.axes().get(axis).map_or(AxisId::NONE, |axis| axis.id());
            let left = by - told(records, axis);
            if lost > 0 && left != 0.0 {
                let record = Record {
                    scan: scan as u64,
                    axis,
                    instance: RUNTIME,
                    event: Event::Shifted { by: left },
                };
                trace.push_note(note(&self.names, &record, scan, None));
            }
        }
        for (index, record) in records.iter().enumerate() {
            // Only the last plan of an axis in a scan is still available in full.
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
        self.records.clear();
    }
}

/// The shifts of coordinates in a scan, which claims need. They come from the axes themselves: a step with more
/// records than the ring holds loses some.
pub(crate) fn shifts_of(machine: &ScriptMachine, scan: usize) -> impl Iterator<Item = Shift> {
    let axes = machine.axes().iter().enumerate();
    axes.filter_map(move |(index, axis)| {
        let by = axis.coordinates_moved(scan as u64);
        (by != 0.0).then_some(Shift {
            scan: scan as u64,
            axis: index,
            by,
        })
    })
}

/// The shift of an axis's coordinates according to the records (u).
fn told(records: &[Record], axis: AxisId) -> f64 {
    let own = records.iter().filter(|record| record.axis == axis);
    own.map(|record| match record.event {
        Event::Shifted { by } => by,
        _ => 0.0,
    })
    .sum()
}

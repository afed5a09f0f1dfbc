//! A recorder's rows as a trace.

use crate::recorder::Recorder;
use crate::ring::{AXIS_WORDS, moved};
use crate::text::{shifted, standing};
use crate::told::{self, Cells, Names, note};
use standstill_axis::{Event, Record};
use standstill_fb::PinType;
use standstill_trace::{Cell, Header, Note, RowError, Trace};
use std::fmt;
use std::string::{String, ToString};
use std::vec::Vec;

impl Recorder {
    /// The contents as a trace, for everything that reads traces. Its rows count from 0. The first note
    /// says which scans of the machine they are and what tripped the recorder. `cycle_ns` is the time
    /// between two scans (ns).
    ///
    /// Cost: proportional to scans times signals, on the heap. Not for use in a scan.
    ///
    /// # Errors
    /// [`RowError`] where a name of [`crate::Signals`] holds a control character.
    pub fn trace(&self, title: &str, cycle_ns: u64) -> Result<Trace, RowError> {
        let signals = self.signals();
        let header = Header {
            runtime: env!("CARGO_PKG_VERSION").to_string(),
            title: title.to_string(),
            cycle_ns,
            axes: signals
                .axes()
                .map(|(name, unit, config)| told::axis(name, unit, config))
                .collect(),
            instances: signals
                .instances()
                .map(|(name, _, block)| told::instance(name.to_string(), block))
                .collect(),
            ..Header::default()
        };
        let types: Vec<PinType> = signals
            .instances()
            .flat_map(|(_, _, block)| block.pins().map(|pin| pin.ty))
            .collect();
        let mut cells = Cells::new(signals.axes().map(|(name, ..)| name.to_string()));
        let mut trace = Trace::new(header);
        for row in self.rows() {
            let (axes, pins) = row.split_at(signals.axes().count() * AXIS_WORDS);
            let pins: Vec<_> = types
                .iter()
                .zip(pins)
                .map(|(ty, word)| (*ty, ty.value(*word)))
                .collect();
            for (ty, value) in &pins {
                cells.prepare(*ty, *value);
            }
            let axes = axes.chunks_exact(AXIS_WORDS).flat_map(axis_cells);
            let pins = pins.iter().map(|(ty, value)| cells.cell(*ty, *value));
            trace.push_row(&axes.chain(pins).collect::<Vec<_>>())?;
        }
        let (first, kept) = self.scans();
        let names = Names {
            axes: signals.axes().map(|(name, ..)| name.to_string()).collect(),
            instances: signals
                .instances()
                .map(|(name, number, _)| (number, name.to_string()))
                .collect(),
        };
        trace.push_note(self.standing(&names));
        for (scan, row) in self.rows().enumerate() {
            for ((name, ..), words) in signals.axes().zip(row.chunks_exact(AXIS_WORDS)) {
                let by = moved(words);
                if by != 0.0 {
                    trace.push_note(said(scan, name, |text| shifted(text, by)));
                }
            }
        }
        let others = |record: &&Record| !matches!(record.event, Event::Shifted { .. });
        for record in self.records().filter(others) {
            let row = record.scan.checked_sub(first).filter(|row| *row < kept as u64);
            if let Some(row) = row.and_then(|row| usize::try_from(row).ok()) {
                trace.push_note(note(&names, record, row, None));
            }
        }
        Ok(trace)
    }

    /// Says which scans these are, and why there are no more.
    fn standing(&self, names: &Names) -> Note {
        said(0, "recorder", |text| standing(text, self.ring(), names))
    }
}

fn said(scan: usize, subject: &str, write: impl FnOnce(&mut String) -> fmt::Result) -> Note {
    let mut text = String::new();
    // Writing to a string cannot fail.
    write(&mut text).unwrap_or_default();
    Note {
        scan,
        subject: subject.to_string(),
        text,
    }
}

/// The cells of an axis: its state, then its numbers. A shift of its coordinates is written as a note.
fn axis_cells<'c>(words: &[u64]) -> impl Iterator<Item = Cell<'c>> + use<'c> {
    let (state, numbers) = words.split_first().unwrap_or((&0, &[]));
    let (_, numbers) = numbers.split_last().unwrap_or((&0, &[]));
    let numbers: Vec<_> = numbers
        .iter()
        .map(|word| Cell::Real(f64::from_bits(*word)))
        .collect();
    core::iter::once(Cell::Name(crate::text::state(*state))).chain(numbers)
}

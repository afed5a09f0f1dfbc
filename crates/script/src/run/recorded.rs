//! Claims judged on a recording: a trace that was not made by the script.

use super::formulas::{Formulas, Truths};
use super::layout::{self, Layout};
use super::needed::{column, signals};
use super::rows::{Rows, Shift};
use super::{Outcome, told};
use crate::claims;
use crate::model::{Script, Signal};
use crate::why;
use standstill_record::text::shift;
use standstill_trace::Trace;
use std::collections::{BTreeMap, BTreeSet};

/// The reason why a recording cannot be judged.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RecordingError {
    /// Its scans are of another length.
    #[error(
        "its cycle is {found} ns and that of the script {expected} ns: scans mean other times; set `cycle` to that of \
         the recording"
    )]
    Cycle {
        /// The cycle of the script (ns).
        expected: u64,
        /// The cycle of the recording (ns).
        found: u64,
    },
    /// It lacks signals of claims.
    #[error(
        "{claim} speaks of {}, which the recording has not{}; columns go by name, as the script's own trace has them",
        .columns.join(", "),
        .others
    )]
    Missing {
        /// Path of the first claim that cannot be judged.
        claim: String,
        /// The columns that it refers to and the recording lacks.
        columns: Vec<String>,
        /// The number of other claims, in words.
        others: String,
    },
}

/// Judges the claims of a script on a recording: the contents of a flight recorder, or the trace of another run.
/// Nothing is run. Only the script's claims and the names of its axes, blocks and variables are used. Scans are
/// rows of the recording.
///
/// The motion before the first row is not known. So a difference of positions exists only from the row
/// that has enough rows before it, and limits are checked from there on.
///
/// # Errors
/// [`RecordingError`]. A claim that fails is no error but a verdict.
pub fn judge_recording(script: &Script, mut recording: Trace) -> Result<Outcome, RecordingError> {
    let (expected, found) = (script.cycle_ns.unsigned_abs(), recording.header().cycle_ns);
    if expected != found {
        return Err(RecordingError::Cycle { expected, found });
    }
    let layout = Layout::of(script, &recording);
    all_there(script, &layout)?;
    let shifts = shifts(script, &recording);
    let truths = truths(script, &layout, &recording, &shifts);
    let rows = Rows {
        script,
        layout: &layout,
        trace: &recording,
        shifts: &shifts,
        truths: &truths,
    };
    let verdicts = claims::judge(&rows);
    let why = why::why(&rows, &verdicts);
    recording.set_claims(verdicts.iter().map(told).collect());
    Ok(Outcome {
        trace: recording,
        verdicts,
        why,
        shifts,
        truths,
    })
}

/// The values that the expressions of conditions have in each row.
fn truths(script: &Script, layout: &Layout, trace: &Trace, shifts: &[Shift]) -> Truths {
    let mut truths = Truths::new(script);
    if let Ok(mut formulas) = Formulas::new(script) {
        for scan in 0..trace.scans() as u64 {
            let rows = Rows {
                script,
                layout,
                trace,
                shifts,
                truths: &Truths::default(),
            };
            formulas.look(&rows, scan, &mut truths);
        }
    }
    truths
}

/// The shifts of coordinates, from the notes of the trace.
fn shifts(script: &Script, recording: &Trace) -> Vec<Shift> {
    let axes = script.axes.iter().zip(0..);
    let axes: BTreeMap<_, _> = axes.map(|(axis, index)| (axis.name.as_str(), index)).collect();
    let mut shifts: Vec<_> = recording
        .notes()
        .iter()
        .filter_map(|note| {
            Some(Shift {
                scan: note.scan as u64,
                axis: *axes.get(note.subject.as_str())?,
                by: shift(&note.text)?,
            })
        })
        .collect();
    shifts.sort_by_key(|shift| shift.scan);
    shifts
}

fn all_there(script: &Script, layout: &Layout) -> Result<(), RecordingError> {
    let columns = layout::header(script).columns();
    let own = Layout::new(script);
    let missing = |signal: &Signal| {
        if let Signal::Formula(index) = signal {
            let formula = script.formulas.get(*index)?;
            let mut inputs = formula.inputs.iter().map(|input| &input.signal);
            let lacks = inputs.find(|signal| column(layout, signal).is_none())?;
            return Some(columns.get(column(&own, lacks)?)?.name.clone());
        }
        if column(layout, signal).is_some() {
            return None;
        }
        Some(columns.get(column(&own, signal)?)?.name.clone())
    };
    let mut broken = script.claims.iter().filter_map(|claim| {
        let lacks: BTreeSet<_> = signals(claim).iter().filter_map(missing).collect();
        (!lacks.is_empty()).then_some((claim, lacks))
    });
    let Some((claim, lacks)) = broken.next() else {
        return Ok(());
    };
    Err(RecordingError::Missing {
        claim: claim.path.clone(),
        columns: lacks.into_iter().collect(),
        others: match broken.count() {
            0 => String::new(),
            1 => " (nor what another claim speaks of)".to_owned(),
            count => format!(" (nor what {count} other claims speak of)"),
        },
    })
}

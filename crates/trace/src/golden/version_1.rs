//! Goldens of version 1: one digest over all columns of that time, in their order ([`digest::whole`]).
//!
//! A pin that was added later would change it. So a run is judged by the columns that the golden knows:
//! those of its companion, or all of them if no companion belongs to it.

use super::{Mismatch, Verdict, events_difference, kept_trace, most_cells, near, text};
use crate::column::Column;
use crate::compare::{Tolerance, Yardstick, closeness, compare_by};
use crate::digest;
use crate::trace::Trace;

/// Whether a golden text is of version 1.
pub fn is_it(reviewed: &str) -> bool {
    reviewed.contains("\ndigest per 64 scans\n")
}

/// Compares a run with a golden of version 1. Its digest counts; if that differs, its events count.
pub fn judge(reviewed: &str, companion: Option<&[u8]>, run: &Trace, yardstick: Yardstick) -> Verdict {
    let kept = kept_trace(reviewed, companion, most_cells(run));
    let run = match &kept {
        Ok(kept) => known(run, kept.columns()),
        Err(_) => run.only(&(0..run.columns().len()).collect::<Vec<_>>()),
    };
    let same_cycle = |kept: &Trace| kept.header().cycle_ns == run.header().cycle_ns;
    let digest = text::digest_text(digest::whole(&run));
    if reviewed.trim_end().ends_with(&digest) && kept.as_ref().map_or(true, same_cycle) {
        return Verdict::Old;
    }
    let found = text(&run);
    if let (Yardstick::Events(tolerance), Ok(kept)) = (yardstick, &kept)
        && near::same_events(reviewed, &found, tolerance)
        && compare_by(kept, &run, yardstick).is_none()
    {
        return Verdict::Close(closeness(kept, &run, tolerance));
    }
    let (difference, companion) = match kept {
        Ok(kept) => (compare_by(&kept, &run, yardstick), String::new()),
        Err(why) => (None, why),
    };
    let tolerance = match yardstick {
        Yardstick::Exact => Tolerance {
            absolute: 0.0,
            relative: 0.0,
        },
        Yardstick::Events(tolerance) => tolerance,
    };
    Verdict::Different(Box::new(Mismatch {
        yardstick,
        difference,
        companion,
        subjects: [Vec::new(), Vec::new()],
        text: events_difference(reviewed, &found, tolerance),
    }))
}

/// The run with the columns that a golden knows, in its order. Every column counted then, so none has a
/// default.
fn known(run: &Trace, columns: &[Column]) -> Trace {
    let places = columns.iter().filter_map(|column| run.column(&column.name));
    run.only(&places.collect::<Vec<_>>())
}

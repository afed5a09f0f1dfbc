//! The story of two traces that differ: what changed first, the events around it, its extent, and the
//! likely kind of cause.

mod cause;
mod line;
mod tell;

use std::fmt;

pub use cause::{Cause, Setting};
pub use line::Line;

use crate::column::Cell;
use crate::compare::{Difference, compare, pairs};
use crate::number::shortest;
use crate::trace::Trace;

/// How two traces differ, and the likely reasons.
#[derive(Clone, Debug, PartialEq)]
pub struct Story {
    /// The first difference.
    pub difference: Difference,
    /// The extent of the difference; `None` if the common rows are equal.
    pub extent: Option<Extent>,
    /// The place in the text of a program where it began. `None` if the first difference is not a
    /// variable of a program, or if its statements are not known.
    pub line: Option<Line>,
    /// The possible causes, the likeliest first; never empty.
    pub causes: Vec<Cause>,
}

/// The part of the common rows that differs.
#[derive(Clone, Debug, PartialEq)]
pub struct Extent {
    /// Scans in which a signal of both differs.
    pub scans: usize,
    /// Scans that both traces have.
    pub of: usize,
    /// The last scan that differs.
    pub last: usize,
    /// The number with the largest difference, relative to the largest magnitude of its column in either
    /// trace.
    pub furthest: Option<Furthest>,
}

/// The number with the largest difference.
#[derive(Clone, Debug, PartialEq)]
pub struct Furthest {
    /// Name of its column.
    pub signal: String,
    /// The scan.
    pub scan: usize,
    /// The expected value.
    pub expected: f64,
    /// The found value.
    pub found: f64,
    /// The distance over the largest magnitude of the column.
    pub share: f64,
}

/// The story of two traces; `None` if they are equal to the bit. Cost: some passes over both.
#[must_use]
pub fn story(expected: &Trace, found: &Trace) -> Option<Story> {
    let difference = compare(expected, found)?;
    let extent = extent(expected, found, &difference);
    let causes = cause::causes(expected, found, &difference, extent.as_ref());
    let line = line::line(expected, found, &difference);
    Some(Story {
        difference,
        extent,
        line,
        causes,
    })
}

fn extent(expected: &Trace, found: &Trace, difference: &Difference) -> Option<Extent> {
    let first = difference.first.as_ref()?.scan;
    let of = difference.scans.0.min(difference.scans.1);
    let pairs = pairs(expected, found);
    let mut differing = vec![false; of];
    let mut furthest: Option<Furthest> = None;
    for &(at, other) in &pairs {
        let cells = expected.cells(at).zip(found.cells(other)).enumerate();
        let cells = cells.take(of).skip(first);
        let mut worst: Option<(usize, f64, f64)> = None;
        for (scan, (a, b)) in cells {
            if crate::compare::equal(a, b) {
                continue;
            }
            if let Some(mark) = differing.get_mut(scan) {
                *mark = true;
            }
            if let (Cell::Real(a), Cell::Real(b)) = (a, b)
                && (a - b).is_finite()
                && worst.is_none_or(|(_, a_worst, b_worst)| (a - b).abs() > (a_worst - b_worst).abs())
            {
                worst = Some((scan, a, b));
            }
        }
        let Some((scan, a, b)) = worst else { continue };
        let reals = expected.reals(at).chain(found.reals(other));
        let largest = reals
            .map(f64::abs)
            .filter(|value| value.is_finite())
            .fold(0.0, f64::max);
        let share = (a - b).abs() / largest;
        if furthest.as_ref().is_none_or(|furthest| share > furthest.share) {
            furthest = Some(Furthest {
                signal: expected.columns().get(at)?.name.clone(),
                scan,
                expected: a,
                found: b,
                share,
            });
        }
    }
    Some(Extent {
        scans: differing.iter().filter(|differs| **differs).count(),
        of,
        last: differing.iter().rposition(|differs| *differs)?,
        furthest,
    })
}

impl fmt::Display for Story {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(out, "{}", self.difference)?;
        if let Some(extent) = &self.extent {
            writeln!(out, "how far it goes\n  {extent}")?;
        }
        if let Some(line) = &self.line {
            writeln!(out, "where it began\n  {line}")?;
        }
        let mut causes = self.causes.iter();
        if let Some(first) = causes.next() {
            writeln!(out, "likely cause\n  {first}\n  look at: {}", first.look_at())?;
        }
        for other in causes {
            writeln!(out, "also\n  {other}\n  look at: {}", other.look_at())?;
        }
        Ok(())
    }
}

impl fmt::Display for Extent {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            scans,
            of,
            last,
            furthest,
        } = self;
        let verb = if *scans == 1 { "differs" } else { "differ" };
        write!(out, "{scans} of {of} scans {verb}, ")?;
        if last + 1 == *of {
            write!(out, "up to the end")?;
        } else {
            write!(out, "the last is {last}; from {} on all is equal again", last + 1)?;
        }
        if let Some(Furthest {
            signal,
            scan,
            expected,
            found,
            ..
        }) = furthest
        {
            write!(
                out,
                "\n  furthest off is {signal} in scan {scan}: expected {}, found {}",
                shortest(*expected),
                shortest(*found)
            )?;
        }
        Ok(())
    }
}

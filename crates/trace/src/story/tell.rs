//! Causes in words.

use std::fmt;

use super::cause::Cause;
use crate::compare::SignalDifference;
use crate::number::{shortest, time_literal};

/// Largest number of names that a sentence lists.
const NAMED: usize = 4;

impl Cause {
    /// Where to look for the cause.
    #[must_use]
    pub const fn look_at(&self) -> &'static str {
        match self {
            Self::Cycle(..) => "`cycle` of the scripts; with another cycle every scan has another time",
            Self::Length(..) => "`scans` and `stop_when` of the scripts",
            Self::Limits(..) => {
                "the axis in the script, in a machine file that it includes, and what overrides it"
            }
            Self::Subjects(..) => {
                "`axes`, `inputs` and `blocks` of the scripts; what they share may follow from that"
            }
            Self::Order { .. } => {
                "the order of `blocks`: a wire reads an output of a block called later one scan late"
            }
            Self::Variable { .. } => "the steps that set it, and the conditions of their `when`",
            Self::Parameter(_) => {
                "the constant at the pin, the parameter behind it (`--set`), and the steps that write it"
            }
            Self::Fault { .. } => "the axis and its drive before that scan; docs/faults.md has every ErrorID",
            Self::Feedback(_) => {
                "`drive` of the axis: its delay, its scaling, its mechanism, a step that pushes it"
            }
            Self::Rounding { .. } => {
                "formulas that were written anew; `test --golden events` lets such differences pass"
            }
            Self::Path => "limits, `profile` and defaults of the axis, and the planner's version",
            Self::Shift(_) | Self::Drift(..) => {
                "what the first of these events waits for: power, a timer, the length of a move, the order of blocks"
            }
            Self::Events { .. } => "the block of the first of these events, and what gives it its inputs",
        }
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Cycle(expected, found) => write!(
                out,
                "another cycle: expected {}, found {}",
                time_literal(*expected),
                time_literal(*found)
            ),
            Self::Length(expected, found) => {
                write!(
                    out,
                    "one run is longer: expected {expected} scans, found {found}; all before is equal"
                )
            }
            Self::Limits(axis, settings) => {
                write!(out, "changed limits of {axis}:")?;
                for (index, setting) in settings.iter().enumerate() {
                    let comma = if index == 0 { "" } else { "," };
                    let text = |limit: Option<f64>| limit.map_or_else(|| "none".to_owned(), shortest);
                    let (expected, found) = (text(setting.expected), text(setting.found));
                    write!(out, "{comma} {} expected {expected}, found {found}", setting.name)?;
                }
                Ok(())
            }
            Self::Subjects(expected, found) => {
                let listed = |names: &[String]| match names.len() {
                    0 => "nothing".to_owned(),
                    count if count > NAMED => {
                        format!("{} and {} more", names[..NAMED].join(", "), count - NAMED)
                    }
                    _ => names.join(", "),
                };
                write!(
                    out,
                    "another program: only what was expected has {}, only what was found has {}",
                    listed(expected),
                    listed(found)
                )
            }
            Self::Order { expected, found } => {
                write!(
                    out,
                    "another order of blocks: {found} is called where {expected} was"
                )
            }
            Self::Variable { signal, later } => {
                let SignalDifference {
                    name,
                    expected,
                    actual,
                    ..
                } = signal;
                write!(out, "another input: {name} is {actual} instead of {expected}")?;
                match later {
                    Some(scans) => write!(out, ", the step comes {}", away(*scans)),
                    None => Ok(()),
                }
            }
            Self::Parameter(signals) => {
                write!(out, "a changed parameter:")?;
                for (index, signal) in signals.iter().take(NAMED).enumerate() {
                    let comma = if index == 0 { "" } else { "," };
                    write!(
                        out,
                        "{comma} {} is given {} instead of {}",
                        signal.name, signal.actual, signal.expected
                    )?;
                }
                match signals.len().checked_sub(NAMED + 1) {
                    Some(more) => write!(out, ", and {} more", more + 1),
                    None => Ok(()),
                }
            }
            Self::Fault { event, in_found } => {
                let which = if *in_found { "was found" } else { "was expected" };
                let what = if event.text.contains("ErrorStop") {
                    "a fault of an axis or its drive"
                } else {
                    "an error of a block"
                };
                write!(
                    out,
                    "{what}, only in what {which}: {} {} in scan {}",
                    event.subject, event.text, event.scan
                )
            }
            Self::Feedback(signal) => write!(
                out,
                "the drive answers otherwise: {signal} differs first, with equal set-points before"
            ),
            Self::Rounding { share, ulps } => {
                write!(
                    out,
                    "reordered arithmetic: every event is in its scan, and no number is off by more than "
                )?;
                write!(out, "{share:.1e} of the largest in its column")?;
                match ulps {
                    Some(1) => write!(out, ", at first 1 ULP"),
                    Some(ulps) => write!(out, ", at first {ulps} ULPs"),
                    None => Ok(()),
                }
            }
            Self::Path => write!(
                out,
                "another way to the same events: every event is in its scan, set-points are not the same"
            ),
            Self::Shift(scans) => write!(
                out,
                "a shift in time: from there on every event comes {}",
                away(*scans)
            ),
            Self::Drift(first, last) => write!(
                out,
                "other durations: the same events in the same order, the first comes {}, the last {}",
                away(*first),
                away(*last)
            ),
            Self::Events { missing, new } => {
                write!(out, "another course of events:")?;
                if let Some(event) = missing {
                    write!(
                        out,
                        " {} {} of scan {} never comes",
                        event.subject, event.text, event.scan
                    )?;
                }
                let and = if missing.is_some() && new.is_some() {
                    ","
                } else {
                    ""
                };
                match new {
                    Some(event) => {
                        write!(
                            out,
                            "{and} {} {} in scan {} is new",
                            event.subject, event.text, event.scan
                        )
                    }
                    None if missing.is_none() => write!(out, " the same ones in another order"),
                    None => Ok(()),
                }
            }
        }
    }
}

/// `2 scans later`
fn away(scans: i64) -> String {
    let plural = if scans.abs() == 1 { "" } else { "s" };
    let way = if scans < 0 { "earlier" } else { "later" };
    match scans {
        0 => "in its scan".to_owned(),
        _ => format!("{} scan{plural} {way}", scans.abs()),
    }
}

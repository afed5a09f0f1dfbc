//! A comparison as text.

use std::fmt;

use super::{Compared, Comparison, Deviation, EdgeFault, Finding, Side, scan_ns};
use crate::number::{shortest, time_literal};

/// Largest number of edges that are named for one signal.
const EDGES_SHOWN: usize = 4;

/// A time as a TIME literal, with its sign.
pub fn time(ns: i64) -> String {
    let literal = time_literal(ns.unsigned_abs());
    if ns < 0 {
        literal.replacen('#', "#-", 1)
    } else {
        literal
    }
}

pub fn range((from, to): (i64, i64)) -> String {
    format!("{} to {}", time(from), time(to))
}

/// A number in four digits, for comparison with a tolerance.
pub fn short(value: f64) -> String {
    if !value.is_finite() || value == 0.0 {
        return shortest(value);
    }
    let rounded: f64 = format!("{value:.3e}").parse().unwrap_or(value);
    shortest(rounded)
}

impl fmt::Display for Comparison {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(out, "offset     {}, {}", time(self.offset.ns), self.offset.how)?;
        if self.offset.at_border {
            writeln!(
                out,
                "           at the border of what was tried: look whether a better one lies beyond"
            )?;
        }
        let (first, last) = self.scans;
        let cycle = i64::try_from(self.cycle_ns).unwrap_or(i64::MAX);
        writeln!(
            out,
            "compared   scans {first} to {last} of 0 to {}, {}",
            self.scans_of_trace.saturating_sub(1),
            range((scan_ns(first, cycle), scan_ns(last, cycle)))
        )?;
        let (length, before, behind) = self.recorded;
        if before > 0 || behind > 0 {
            writeln!(
                out,
                "           of the recording's {} not compared: {} before, {} behind",
                time(length),
                time(before),
                time(behind)
            )?;
        }
        let width = self
            .signals
            .iter()
            .map(|signal| signal.name.chars().count())
            .max();
        for signal in &self.signals {
            self.line(signal, width.unwrap_or(0), out)?;
        }
        Ok(())
    }
}

impl Comparison {
    fn line(&self, signal: &Compared, width: usize, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let verdict = if signal.finding.holds() { "holds" } else { "FAILS" };
        write!(out, "  {verdict}  {:<width$}  ", signal.name)?;
        let within = match signal.time_tolerance {
            0 => String::new(),
            ns => format!(" within {}", time(ns)),
        };
        match &signal.finding {
            Finding::Curve {
                tolerance,
                worst,
                first,
                outside,
            } => {
                writeln!(
                    out,
                    "off by {} at most, in scan {}; tolerance {}{within}",
                    short(worst.size()),
                    worst.scan,
                    shortest(*tolerance)
                )?;
                if let Some(first) = first {
                    writeln!(
                        out,
                        "         outside in {outside} scans, first {}",
                        self.place(first)
                    )?;
                    if first.scan != worst.scan {
                        writeln!(out, "         worst {}", self.place(worst))?;
                    }
                }
            }
            Finding::Edges {
                matched,
                farthest,
                wrong,
            } => {
                let apart = match matched {
                    0 => String::new(),
                    _ => format!(", {} apart at most", time(*farthest)),
                };
                let agree = if *matched == 1 {
                    "edge agrees"
                } else {
                    "edges agree"
                };
                writeln!(
                    out,
                    "{matched} {agree}{apart}; tolerance {}",
                    time(signal.time_tolerance)
                )?;
                for fault in wrong.iter().take(EDGES_SHOWN) {
                    writeln!(out, "         {}", self.fault(fault))?;
                }
                if wrong.len() > EDGES_SHOWN {
                    writeln!(out, "         and {} more", wrong.len() - EDGES_SHOWN)?;
                }
            }
        }
        Ok(())
    }

    fn place(&self, deviation: &Deviation) -> String {
        let cycle = i64::try_from(self.cycle_ns).unwrap_or(i64::MAX);
        format!(
            "in scan {} ({}): recorded {}, trace {}",
            deviation.scan,
            time(scan_ns(deviation.scan, cycle)),
            short(deviation.recorded),
            short(deviation.found)
        )
    }

    fn fault(&self, fault: &EdgeFault) -> String {
        let cycle = i64::try_from(self.cycle_ns).unwrap_or(1).max(1);
        let (at, scan) = (time(fault.at_ns), fault.at_ns.div_euclid(cycle));
        match fault.of {
            Side::Start => format!("starts as {} at {at}, which was not recorded", fault.to),
            Side::Trace => format!(
                "changes to {} in scan {scan} ({at}), which was not recorded",
                fault.to
            ),
            Side::Recorded => format!(
                "was recorded to change to {} at {at} (scan {scan}), the trace does not",
                fault.to
            ),
        }
    }
}

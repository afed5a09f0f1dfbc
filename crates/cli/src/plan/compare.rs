//! `standstill compare-planners`: every method on every case.

use crate::exit::{Exit, Failure};
use crate::json::number;
use crate::plan::each_line;
use crate::plan::fields::Fields;
use crate::plan::methods::{self, Planned};
use crate::plan::refusal::Refusal;
use crate::table::cell_of_json;
use standstill_planner::Segment;
use std::io::{BufRead, Write};

/// The columns; quantities that the order of a plan leaves unbounded are empty.
const HEADER: &str = "case,method,scans,duration,peak_velocity,peak_acceleration,peak_jerk,peak_snap,rms_jerk,\
over_n_star,refused";

/// Prints one row for each case and method as CSV. A case is a line of `standstill plan`, whose method is
/// ignored. It may have `n_star`, the least known number of scans. `name` is the name of the input in
/// messages.
///
/// Fails if a line cannot be read, or no method takes it.
pub fn compare(input: &mut dyn BufRead, name: &str, out: &mut dyn Write) -> Result<Exit, Failure> {
    let mut exit = Exit::Passed;
    writeln!(out, "{HEADER}")?;
    each_line(input, name, |line, text| {
        let case = match Fields::of_line(text) {
            Ok(fields) if fields.id() != "null" => cell_of_json(fields.id()),
            _ => format!("line {line}"),
        };
        match rows(text) {
            Ok(rows) => {
                if rows.iter().all(|(_, row)| row.is_err()) {
                    exit = Exit::Failed;
                }
                for (method, row) in rows {
                    let row = row.unwrap_or_else(|refusal| empty(&refusal));
                    writeln!(out, "{case},{method},{row}")?;
                }
            }
            Err(refusal) => {
                exit = Exit::Failed;
                writeln!(out, "{case},,{}", empty(&refusal))?;
            }
        }
        Ok(())
    })?;
    Ok(exit)
}

type Rows = Vec<(&'static str, Result<String, Refusal>)>;

/// The results of every method for a line, without the columns that name case and method.
fn rows(text: &[u8]) -> Result<Rows, Refusal> {
    let mut fields = Fields::of_line(text)?;
    let n_star = match fields.take("n_star") {
        None => None,
        Some(text) => Some(
            serde_json::from_str::<u32>(&text)
                .map_err(|_| fields.invalid("n_star", "`n_star` must be a number of scans".to_owned()))?,
        ),
    };
    let fields = fields.checked()?;
    let problem = fields.problem()?;
    let row = |method| methods::plan_with(&fields, &problem, method).map(|planned| row(&planned, n_star));
    Ok(methods::all().map(|method| (method.name, row(method))).collect())
}

fn row(planned: &Planned, n_star: Option<u32>) -> String {
    let peak = &planned.peak;
    let bounded = |value: Option<f64>| value.map(number).unwrap_or_default();
    let rms_jerk = peak.jerk.map(|_| rms_jerk(&planned.segments));
    let over = n_star.map(|n_star| i64::from(planned.scans) - i64::from(n_star));
    [
        planned.scans.to_string(),
        number(planned.duration),
        number(peak.velocity),
        number(peak.acceleration),
        bounded(peak.jerk),
        bounded(peak.snap),
        bounded(rms_jerk),
        over.map(|over| over.to_string()).unwrap_or_default(),
        String::new(),
    ]
    .join(",")
}

/// The row of a case that a method does not take: only the reason.
fn empty(refusal: &Refusal) -> String {
    format!(",,,,,,,,{}", refusal.code())
}

/// Root of the mean square of the jerk (u/s^3), exact for segments of constant snap; 0 for no motion.
fn rms_jerk(segments: &[Segment]) -> f64 {
    let mut duration = 0.0;
    let mut squares = 0.0;
    for segment in segments {
        let (first, last) = (segment.jerk, segment.jerk + segment.snap * segment.duration);
        duration += segment.duration;
        squares += segment.duration * (first * first + first * last + last * last) / 3.0;
    }
    if duration > 0.0 {
        (squares / duration).sqrt()
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_a_jerk_that_rises_from_nothing_is_its_peak_over_root_three() {
        let rising = Segment {
            duration: 2.0,
            velocity: 0.0,
            acceleration: 0.0,
            jerk: 0.0,
            snap: 3.0,
        };
        assert!((rms_jerk(&[rising]) - 6.0 / 3.0_f64.sqrt()).abs() < 1e-14);
        assert_eq!(rms_jerk(&[]), 0.0);
    }
}

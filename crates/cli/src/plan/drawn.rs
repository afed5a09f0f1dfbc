//! Plans as a picture and as a page.

use crate::exit::{Failure, complain};
use crate::plan::methods::Planned;
use crate::plan::{Files, Plan};
use crate::report::page_failure;
use standstill_picture::{self as picture, PLANS_MAX};
use standstill_planner::Limits;
use standstill_report::{Source, html};
use standstill_trace::file::replace;
use standstill_trace::{self as trace, Axis, Cell, Header, Trace};

/// Number of points of a segment that are drawn.
const STEPS: u32 = 24;

/// Largest number of rows of a plan on a page (scans).
const ROWS_MAX: u32 = 1_000_000;

/// The name of the axis that a plan moves on its page.
const AXIS: &str = "plan";

/// Plans to draw: at most one for each colour.
#[derive(Debug, Default)]
pub struct Drawn {
    plans: Vec<picture::Plan>,
    /// Label and rows of each.
    traces: Vec<(String, Trace)>,
    /// Number of plans that were not drawn.
    left_out: usize,
}

impl Drawn {
    /// Adds the plan of a line, if it is to be drawn.
    pub fn add(&mut self, files: Files<'_>, plan: Plan<'_>) -> Result<(), Failure> {
        let Plan {
            fields,
            method,
            planned,
        } = plan;
        if files.svg.is_none() && files.report.is_none() {
            return Ok(());
        }
        if self.plans.len() == PLANS_MAX {
            self.left_out += 1;
            return Ok(());
        }
        let problem = fields.problem().ok();
        let limits = problem.map_or_else(trace::Limits::default, |problem| given(&problem.limits));
        let label = label(fields.id(), method, planned);
        if files.report.is_some() {
            let cycle = fields.required("Ts").unwrap_or(0.0);
            self.traces
                .push((label.clone(), traced(&label, cycle, &limits, planned)?));
        }
        self.plans.push(picture::Plan {
            label,
            course: course(planned),
            limits: [limits.velocity, limits.acceleration, limits.jerk, limits.snap],
        });
        Ok(())
    }

    /// Writes the requested files.
    pub fn finish(self, files: Files<'_>) -> Result<(), Failure> {
        if self.left_out > 0 {
            let (all, drawn) = (self.left_out + PLANS_MAX, PLANS_MAX);
            complain(&format!("note: of {all} plans the first {drawn} are drawn"));
        }
        if let Some(path) = files.svg {
            let picture = picture::plans("Plans", &self.plans);
            replace(path, |out| out.write_all(picture.as_bytes()))?;
        }
        if let Some(path) = files.report {
            if self.traces.is_empty() {
                return Err(Failure::usage(
                    "--report: no line was planned, so there is nothing to show",
                ));
            }
            let sources: Vec<_> = self
                .traces
                .iter()
                .map(|(name, trace)| source(name, trace))
                .collect();
            let page = html(&sources).map_err(page_failure)?;
            replace(path, |out| out.write_all(page.as_bytes()))?;
        }
        Ok(())
    }
}

fn source<'a>(name: &'a str, trace: &'a Trace) -> Source<'a> {
    Source {
        name,
        trace,
        lacks: &[],
    }
}

/// The limits that a line gives.
fn given(limits: &Limits) -> trace::Limits {
    let finite = |limit: f64| limit.is_finite().then_some(limit);
    trace::Limits {
        velocity: finite(limits.velocity),
        acceleration: finite(limits.acceleration),
        deceleration: finite(limits.deceleration),
        jerk: finite(limits.jerk),
        snap: finite(limits.snap),
        ..trace::Limits::default()
    }
}

/// The label of a plan: its id, its method, its duration.
fn label(id: &str, method: &str, planned: &Planned) -> String {
    let own = match serde_json::from_str(id) {
        Ok(serde_json::Value::Null) => String::new(),
        Ok(serde_json::Value::String(text)) if text == method => String::new(),
        Ok(serde_json::Value::String(text)) => format!("{text}: "),
        _ => format!("{id}: "),
    };
    format!(
        "{own}{method}, {} scans, {:.4} s",
        planned.scans, planned.duration
    )
}

/// The course of a plan from its segments. They give the velocity and its derivatives, and the end gives the
/// position.
fn course(planned: &Planned) -> Vec<[f64; 6]> {
    let (mut course, mut begin, mut way) = (Vec::new(), 0.0, 0.0);
    for segment in &planned.segments {
        let [v, a, j, s] = [segment.velocity, segment.acceleration, segment.jerk, segment.snap];
        let moment = |step: u32| {
            let t = segment.duration * (f64::from(step) / f64::from(STEPS));
            let position = way + t * (v + t * (a / 2.0 + t * (j / 6.0 + t * s / 24.0)));
            let velocity = v + t * (a + t * (j / 2.0 + t * s / 6.0));
            [
                begin + t,
                position,
                velocity,
                a + t * (j + t * s / 2.0),
                j + t * s,
                s,
            ]
        };
        course.extend((0..=STEPS).map(moment));
        let [end, there, ..] = moment(STEPS);
        (begin, way) = (end, there);
    }
    let shift = planned.end.position - way;
    for moment in &mut course {
        moment[1] += shift;
    }
    course
}

/// The set-points of a plan as the trace of an axis: row n is the plan n cycles after its start.
fn traced(label: &str, cycle: f64, limits: &trace::Limits, planned: &Planned) -> Result<Trace, Failure> {
    let cycle_ns = (cycle * 1e9).round();
    let is_whole = (1.0..1e15).contains(&cycle_ns) && (cycle * 1e9 - cycle_ns).abs() <= 1e-12 * cycle_ns;
    if !is_whole {
        let text = format!("--report: Ts is {cycle:?} s: a page has scans of whole nanoseconds");
        return Err(Failure::usage(&text));
    }
    if planned.scans > ROWS_MAX {
        let scans = planned.scans;
        let text = format!(
            "--report: a plan of {scans} scans is more than the {ROWS_MAX} of a page; `--svg` draws it"
        );
        return Err(Failure::usage(&text));
    }
    let mut trace = Trace::new(Header {
        title: label.to_owned(),
        cycle_ns: cycle_ns as u64,
        axes: vec![Axis {
            name: AXIS.to_owned(),
            unit: "u".to_owned(),
            limits: *limits,
            ..Axis::default()
        }],
        ..Header::default()
    });
    for scan in 0..=planned.scans {
        let point = planned.setpoints.at(scan);
        let state = if scan < planned.scans {
            "DiscreteMotion"
        } else {
            "Standstill"
        };
        let values = [
            point.position,
            point.velocity,
            point.acceleration,
            point.jerk,
            point.snap,
            point.position,
        ];
        let row: Vec<Cell<'_>> = std::iter::once(Cell::Name(state))
            .chain(values.map(Cell::Real))
            .collect();
        trace
            .push_row(&row)
            .map_err(|error| Failure::usage(&format!("--report: {error}")))?;
    }
    Ok(trace)
}

//! A plan as a line.

use crate::json::{Object, list, number, string};
use crate::plan::methods::Planned;
use standstill_planner::grid::{Counts, Peaks};
use standstill_planner::{Excess, Segment, Setpoint};

/// The line to write; `id` is JSON.
pub fn line(id: &str, method: &str, planned: &Planned) -> String {
    Object::new()
        .with("id", id)
        .with("method", string(method))
        .with("duration", number(planned.duration))
        .with("scans", planned.scans.to_string())
        .with("segments", list(planned.segments.iter().map(segment)))
        .with("peak", peak(&planned.peak))
        .with_some("unavoidable", planned.unavoidable.as_ref().map(unavoidable))
        .with_some("boxes", planned.boxes.as_deref().map(boxes))
        .with_some("counts", planned.counts.as_ref().map(counts))
        .with_some("case", planned.case.map(string))
        .with_some("end_velocity", planned.end_velocity.map(number))
        .with_some("rung", planned.rung.map(string))
        .with("end", end(&planned.end))
        .text()
}

fn segment(segment: &Segment) -> String {
    Object::new()
        .with("duration", number(segment.duration))
        .with("velocity", number(segment.velocity))
        .with("acceleration", number(segment.acceleration))
        .with("jerk", number(segment.jerk))
        .with("snap", number(segment.snap))
        .text()
}

fn peak(peak: &Peaks) -> String {
    let bounded = |value: Option<f64>| value.map_or_else(|| "null".to_owned(), number);
    Object::new()
        .with("velocity", number(peak.velocity))
        .with("acceleration", number(peak.acceleration))
        .with("jerk", bounded(peak.jerk))
        .with("snap", bounded(peak.snap))
        .text()
}

fn unavoidable(excess: &Excess) -> String {
    Object::new()
        .with("velocity", number(excess.velocity))
        .with("acceleration", number(excess.acceleration))
        .with("jerk", number(excess.jerk))
        .text()
}

fn boxes(boxes: &[u32]) -> String {
    list(boxes.iter().map(u32::to_string))
}

fn counts(counts: &Counts) -> String {
    Object::new()
        .with_some("nd", counts.nd.map(|count| count.to_string()))
        .with_some("nj", counts.nj.map(|count| count.to_string()))
        .with("na", counts.na.to_string())
        .with("nv", counts.nv.to_string())
        .text()
}

fn end(end: &Setpoint) -> String {
    Object::new()
        .with("position", number(end.position))
        .with("velocity", number(end.velocity))
        .with("acceleration", number(end.acceleration))
        .with("jerk", number(end.jerk))
        .text()
}

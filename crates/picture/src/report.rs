//! The full picture of a trace, as its page shows it: all curves and the drive's reports, claims, and
//! every pin that changes, of any type.

use std::fmt::Write;

use super::picture::{CURVE, GAP, GUTTER, Picture, ROW, class_of, wrapped};
use super::range::{Range, limits, ticks};
use crate::panels::{Curve, Wave, curves};
use standstill_trace::{Cell, Claim, ClaimVerdict, Column, Kind, Role, Trace, same, time_literal};

/// The curves of an axis, top to bottom.
const SIGNALS: [&str; 5] = ["Position", "Velocity", "Acceleration", "Jerk", "Snap"];

/// The drive's reports, drawn over the set-points.
const ACTUAL: [(&str, &str); 2] = [("Position", "ActualPosition"), ("Velocity", "ActualVelocity")];

/// A number that changes in more than one of this many scans is a curve, not a row of boxes.
const BUSY: usize = 8;

/// Largest number of letters of a title on a line.
const TITLE: usize = 88;

/// Largest number of letters of a claim's words on a line, and of lines: longer texts are cut.
const SAID: usize = 124;
const SAID_LINES: usize = 3;

/// Largest number of letters of a label left of the curves.
const GUTTER_LETTERS: usize = 27;

/// Half of the width of a claim's mark.
const MARK: f64 = 3.5;

pub const STYLE: &str = "<style>\n\
    .title { font-size: 15px; font-weight: 600 } .actual { stroke: #555; stroke-width: 1; stroke-dasharray: 3 3 }\n\
    .held { stroke: #14803f } .failed { stroke: #c22 } circle { fill: #14803f } .span { stroke-width: 4; opacity: .35 }\n\
    @media (prefers-color-scheme: dark) { .actual { stroke: #bbb } .held { stroke: #4fc882 } .failed { stroke: #ff6b6b }\n\
    circle { fill: #4fc882 } }\n\
    </style>\n";

/// The picture of a whole trace, in the layout of the HTML report: title; for every axis its states and
/// the curves that move, with limits and actual values; the claims over their scans; and every input,
/// output and input variable that changes.
///
/// Work is proportional to rows times columns.
#[must_use]
pub fn report(trace: &Trace) -> String {
    let header = trace.header();
    let mut picture = Picture::new(trace.scans());
    let ticks = ticks(trace.scans());
    picture.body.push_str(STYLE);
    heading(&mut picture, trace);
    let curves = curves(trace, &SIGNALS);
    for axis in &header.axes {
        picture.states(trace, axis);
        // A constant curve, such as the snap of an axis of order 2, shows nothing.
        let moves = |curve: &&Curve<'_>| std::ptr::eq(curve.axis, axis) && curve.least < curve.greatest;
        for curve in curves.iter().filter(moves) {
            draw(&mut picture, trace, curve, &ticks);
        }
    }
    if !header.claims.is_empty() {
        picture.over_grid(&ticks, |picture| {
            for claim in &header.claims {
                draw_claim(picture, claim);
            }
        });
        picture.y += GAP;
    }
    picture.over_grid(&ticks, |picture| pins(picture, trace));
    picture.time(header.cycle_ns, &ticks);
    picture.finish(&header.title)
}

fn heading(picture: &mut Picture, trace: &Trace) {
    let header = trace.header();
    picture.y += GAP / 2.0;
    for line in wrapped(&header.title, TITLE) {
        picture.text("title", "start", [GAP, picture.y + 4.0], &line);
        picture.y += ROW;
    }
    let mut facts = format!("cycle {}, {} scans", time_literal(header.cycle_ns), trace.scans());
    let held = |claim: &&Claim| claim.verdict == ClaimVerdict::Passed;
    if !header.claims.is_empty() {
        let held = header.claims.iter().filter(held).count();
        // Writing to a String cannot fail, here and below.
        let _ = write!(facts, ", {held} of {} claims hold", header.claims.len());
    }
    picture.text("small unit", "start", [GAP, picture.y + 3.0], &facts);
    picture.y += GAP;
}

/// A panel with a curve, and the drive's report of it.
fn draw(picture: &mut Picture, trace: &Trace, curve: &Curve<'_>, ticks: &[usize]) {
    let actual = ACTUAL.iter().find(|(signal, _)| *signal == curve.signal);
    let actual = actual.and_then(|(_, signal)| trace.column(&format!("{}.{signal}", curve.axis.name)));
    let actual: Vec<f64> = actual
        .map(|column| trace.reals(column).collect())
        .unwrap_or_default();
    let finite = actual.iter().copied().filter(|value| value.is_finite());
    let range = Range::of(
        finite.clone().fold(curve.least, f64::min),
        finite.fold(curve.greatest, f64::max),
    );
    let bottom = picture.y + CURVE;
    picture.line_of(&curve.title, &curve.values, &range, &limits(curve), ticks);
    picture.trail("actual", &actual, |value| bottom - CURVE * range.part(value));
}

/// A claim: its text, its scans, and the scans in which it was fulfilled or failed.
pub fn draw_claim(picture: &mut Picture, claim: &Claim) {
    let (mark, class) = match claim.verdict {
        ClaimVerdict::Passed => ("✓", "held"),
        ClaimVerdict::Failed => ("✗", "failed"),
    };
    let mut lines = wrapped(&format!("{} {mark}", claim.path), GUTTER_LETTERS);
    lines.truncate(1);
    picture.label("", picture.y + 11.0, lines.first().map_or("", String::as_str));
    let said = wrapped(&claim.text, SAID);
    for line in said.iter().take(SAID_LINES) {
        picture.text("small", "start", [GUTTER + 4.0, picture.y + 11.0], line);
        picture.y += 12.0;
    }
    let middle = picture.y + 5.0;
    if let Some([from, to]) = claim.scans {
        let [left, right] = [picture.x(from), picture.x(to + 1)];
        picture.line(
            &format!("{class} span"),
            &format!("M{left:.1} {middle:.1}H{right:.1}"),
        );
    }
    if let Some(held) = claim.held {
        let x = picture.x(held);
        let _ = writeln!(
            picture.body,
            "<circle cx=\"{x:.1}\" cy=\"{middle:.1}\" r=\"{MARK}\"/>"
        );
    }
    for scan in claim.failures.iter().filter_map(|failure| failure.scan) {
        let [left, right] = [-MARK, MARK].map(|half| picture.x(scan) + half);
        let [top, bottom] = [-MARK, MARK].map(|half| middle + half);
        picture.line("failed", &format!("M{left:.1} {top:.1}L{right:.1} {bottom:.1}"));
        picture.line("failed", &format!("M{left:.1} {bottom:.1}L{right:.1} {top:.1}"));
    }
    picture.y += 14.0;
}

/// A row for every input variable and pin that changes, with gaps between instances.
fn pins(picture: &mut Picture, trace: &Trace) {
    let mut before: Option<&str> = None;
    for (at, column) in trace.columns().iter().enumerate() {
        if matches!(column.role, Role::AxisState | Role::AxisValue) {
            continue;
        }
        let cells: Vec<Cell<'_>> = trace.cells(at).collect();
        let changes = cells.windows(2).filter(|pair| !same(pair[0], pair[1])).count();
        if changes == 0 {
            continue;
        }
        if before.is_some_and(|before| before != column.subject()) {
            picture.y += GAP / 2.0;
        }
        before = Some(column.subject());
        row(picture, column, &cells, changes);
    }
}

fn row(picture: &mut Picture, column: &Column, cells: &[Cell<'_>], changes: usize) {
    if column.kind == Kind::Bool {
        picture.wave(&Wave::new(column, cells.iter().copied()));
        return;
    }
    picture.label("", picture.y + 0.8 * ROW - 1.0, &column.name);
    if matches!(column.kind, Kind::Real | Kind::Integer) && changes > 2 + cells.len() / BUSY {
        let values: Vec<f64> = cells.iter().filter_map(real).collect();
        let finite = values.iter().copied().filter(|value| value.is_finite());
        let range = Range::of(finite.clone().fold(0.0, f64::min), finite.fold(0.0, f64::max));
        let bottom = picture.y + ROW;
        picture.trail("curve", &values, |value| bottom - ROW * range.part(value));
    } else {
        picture.y += 2.0;
        picture.boxes(cells.iter().copied(), ROW - 4.0);
        picture.y -= 2.0;
    }
    let (left, top, bottom) = (GUTTER - 3.0, picture.y + 3.0, picture.y + ROW - 3.0);
    let bar = format!("M{left:.1} {top:.1}V{bottom:.1}");
    picture.line(class_of(column.role), &bar);
    picture.y += ROW;
}

fn real(cell: &Cell<'_>) -> Option<f64> {
    match cell {
        Cell::Real(value) => Some(*value),
        // The time of a timer, or a count: a picture resolves less than a float does.
        Cell::Integer(value) => Some(*value as f64),
        Cell::Bool(_) | Cell::Name(_) => None,
    }
}

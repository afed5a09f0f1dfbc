//! `docs/axis-states.md` and its picture, from the arrows of the axis state machine.

use crate::{Generated, NOTICE};
use standstill_axis::{ARROWS, AxisState};
use std::fmt::Write;

pub fn pages() -> [Generated; 2] {
    [
        Generated {
            path: "docs/axis-states.md".into(),
            text: page(),
        },
        Generated {
            path: "docs/axis-states.svg".into(),
            text: picture(),
        },
    ]
}

fn page() -> String {
    let mut text = format!(
        "{NOTICE}# Axis states\n\n\
         An axis is always in exactly one of eight states. The picture and the table are drawn from the\n\
         arrows in `crates/axis/src/state.rs`, which a test holds against the function that runs.\n\n\
         ![The axis state diagram](axis-states.svg)\n\n\
         Full lines are commands, dashed lines are completions and system events. For the sake of the eye\n\
         the picture leaves out the arrows to ErrorStop (note 1) and to Disabled (note 2), which start at\n\
         every state, and arrows from a state to itself; the table has them all.\n\n\
         | from | event | to | drawn for |\n| --- | --- | --- | --- |\n"
    );
    for arrow in ARROWS {
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} |",
            arrow.from.name(),
            arrow.on.name(),
            arrow.to.name(),
            arrow.note
        );
    }
    text
}

const WIDTH: f64 = 150.0;
const HEIGHT: f64 = 44.0;

/// Centre of a state's box.
fn place(state: AxisState) -> (f64, f64) {
    match state {
        AxisState::DiscreteMotion => (120.0, 50.0),
        AxisState::ContinuousMotion => (740.0, 50.0),
        AxisState::SynchronizedMotion => (430.0, 220.0),
        AxisState::Stopping => (120.0, 240.0),
        AxisState::ErrorStop => (740.0, 240.0),
        AxisState::Homing => (120.0, 430.0),
        AxisState::Standstill => (430.0, 350.0),
        AxisState::Disabled => (740.0, 430.0),
    }
}

fn picture() -> String {
    let mut svg = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 860 490\" font-family=\"sans-serif\" font-size=\"13\">\n\
         <style>\n\
         text { fill: #222 } rect { fill: #fff; stroke: #222 } path { stroke: #555; fill: none }\n\
         .head { fill: #555; stroke: none } .note { font-size: 11px; fill: #666 }\n\
         @media (prefers-color-scheme: dark) { text { fill: #eee } rect { fill: #222; stroke: #eee } \
         path { stroke: #aaa } .head { fill: #aaa } .note { fill: #aaa } }\n\
         </style>\n\
         <defs><marker id=\"head\" viewBox=\"0 0 8 8\" refX=\"8\" refY=\"4\" markerWidth=\"8\" markerHeight=\"8\" orient=\"auto\">\
         <path class=\"head\" d=\"M0 0L8 4L0 8z\"/></marker></defs>\n",
    );
    for arrow in ARROWS {
        if arrow.from != arrow.to && arrow.note != "note 1" && arrow.note != "note 2" {
            svg.push_str(&line(arrow.from, arrow.to, arrow.note));
        }
    }
    for &state in AxisState::ALL {
        let (x, y) = place(state);
        let _ = writeln!(
            svg,
            "<rect x=\"{}\" y=\"{}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" rx=\"10\"/><text x=\"{x}\" y=\"{}\" text-anchor=\"middle\">{}</text>",
            x - WIDTH / 2.0,
            y - HEIGHT / 2.0,
            y + 4.5,
            state.name()
        );
    }
    svg.push_str("</svg>\n");
    svg
}

/// A line between two boxes, shifted to its right so that the way back has its own.
fn line(from: AxisState, to: AxisState, note: &str) -> String {
    const SHIFT: f64 = 7.0;
    let ((x0, y0), (x1, y1)) = (place(from), place(to));
    let (dx, dy) = (x1 - x0, y1 - y0);
    let length = (dx * dx + dy * dy).sqrt();
    let (sx, sy) = (-dy / length * SHIFT, dx / length * SHIFT);
    let start = edge(x0 + sx, y0 + sy, x0, y0, dx, dy);
    let end = edge(x1 + sx, y1 + sy, x1, y1, -dx, -dy);
    let dash = if note == "command" {
        ""
    } else {
        " stroke-dasharray=\"5 4\""
    };
    let mut text = format!(
        "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\"{dash} marker-end=\"url(#head)\"/>\n",
        start.0, start.1, end.0, end.1
    );
    if note != "command" && note != "done" {
        let (x, y) = (
            (start.0 + end.0) / 2.0 + sx * 1.6,
            (start.1 + end.1) / 2.0 + sy * 1.6 + 4.0,
        );
        let _ = writeln!(
            text,
            "<text class=\"note\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"middle\">{note}</text>"
        );
    }
    text
}

/// Where the ray from (`x`, `y`) along (`dx`, `dy`) leaves the box around (`cx`, `cy`).
fn edge(x: f64, y: f64, cx: f64, cy: f64, dx: f64, dy: f64) -> (f64, f64) {
    let room = |offset: f64, half: f64, step: f64| {
        if step > 0.0 {
            (half - offset) / step
        } else if step < 0.0 {
            (-half - offset) / step
        } else {
            f64::INFINITY
        }
    };
    let t = room(x - cx, WIDTH / 2.0, dx).min(room(y - cy, HEIGHT / 2.0, dy));
    (x + dx * t, y + dy * t)
}

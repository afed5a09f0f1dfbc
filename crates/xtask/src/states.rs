//! `docs/axis-states.md` and its picture, from the arrows of the axis state machine.

use crate::{Generated, NOTICE};
use standstill_axis::{ARROWS, Arrow, AxisEvent, AxisState};
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

/// The blocks that lead along an arrow.
const fn blocks(on: AxisEvent) -> &'static [&'static str] {
    match on {
        AxisEvent::StartDiscrete => &[
            "MC_MoveAbsolute",
            "MC_MoveRelative",
            "MC_MoveAdditive",
            "MC_MoveSuperimposed",
            "MC_PositionProfile",
            "MC_Halt",
        ],
        AxisEvent::StartContinuous => &[
            "MC_MoveVelocity",
            "MC_MoveContinuousAbsolute",
            "MC_MoveContinuousRelative",
            "MC_TorqueControl",
            "MC_VelocityProfile",
            "MC_AccelerationProfile",
            "MC_GearOut",
        ],
        AxisEvent::StartSynchronized => &["MC_GearIn", "MC_GearInPos", "MC_CombineAxes"],
        AxisEvent::StartHoming => &["MC_Home"],
        AxisEvent::Stop | AxisEvent::StopReleased => &["MC_Stop"],
        AxisEvent::PowerOn | AxisEvent::PowerOff => &["MC_Power"],
        AxisEvent::ResetPowered | AxisEvent::ResetUnpowered => &["MC_Reset"],
        AxisEvent::MotionDone | AxisEvent::Fault => &[],
    }
}

/// The label of an arrow: the blocks, or some of many, or an event without a command.
fn label(on: AxisEvent) -> String {
    match (on, blocks(on)) {
        (AxisEvent::MotionDone, _) => "done".to_owned(),
        (AxisEvent::StopReleased, _) => "MC_Stop: not Execute".to_owned(),
        (_, [only]) => (*only).to_owned(),
        (_, [first, ..]) => format!("{first} ..."),
        (_, []) => String::new(),
    }
}

fn page() -> String {
    let mut text = format!(
        "{NOTICE}# Axis states\n\n\
         An axis is always in exactly one of eight states. The picture and the table are drawn from the\n\
         arrows in `crates/axis/src/state.rs`, which a test holds against the function that runs.\n\n\
         ![The axis state diagram](axis-states.svg)\n\n\
         Full lines are commands, dashed lines are completions and system events. For the sake of the eye\n\
         the picture leaves out the arrows to ErrorStop (note 1) and to Disabled (note 2), which start at\n\
         every state, and arrows from a state to itself; the table has them all. Where more than one block leads along an\n\
         arrow the first is named, with dots behind it:\n\n| event | blocks |\n| --- | --- |\n"
    );
    for on in [
        AxisEvent::StartDiscrete,
        AxisEvent::StartContinuous,
        AxisEvent::StartSynchronized,
        AxisEvent::StartHoming,
        AxisEvent::Stop,
    ] {
        let links: Vec<_> = blocks(on)
            .iter()
            .map(|block| format!("[{block}](blocks/{}.md)", block.to_lowercase()))
            .collect();
        let _ = writeln!(text, "| {} | {} |", on.name(), links.join(", "));
    }
    text.push_str("\n| from | event | to | drawn for |\n| --- | --- | --- | --- |\n");
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
        AxisState::DiscreteMotion => (130.0, 50.0),
        AxisState::ContinuousMotion => (870.0, 50.0),
        AxisState::SynchronizedMotion => (500.0, 165.0),
        AxisState::Stopping => (130.0, 420.0),
        AxisState::ErrorStop => (870.0, 420.0),
        AxisState::Homing => (130.0, 640.0),
        AxisState::Standstill => (500.0, 530.0),
        AxisState::Disabled => (870.0, 640.0),
    }
}

fn picture() -> String {
    let mut svg = String::from(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 1000 690\" font-family=\"sans-serif\" font-size=\"13\">\n\
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
            svg.push_str(&line(arrow));
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

/// A line between two boxes, shifted to its right so that the opposite direction has a line of its own.
fn line(arrow: &Arrow) -> String {
    const SHIFT: f64 = 9.0;
    let ((x0, y0), (x1, y1)) = (place(arrow.from), place(arrow.to));
    let (dx, dy) = (x1 - x0, y1 - y0);
    let length = (dx * dx + dy * dy).sqrt();
    let (sx, sy) = (-dy / length * SHIFT, dx / length * SHIFT);
    let start = edge(x0 + sx, y0 + sy, x0, y0, dx, dy);
    let end = edge(x1 + sx, y1 + sy, x1, y1, -dx, -dy);
    let dash = if arrow.note == "command" {
        ""
    } else {
        " stroke-dasharray=\"5 4\""
    };
    let mut text = format!(
        "<path d=\"M{:.1} {:.1}L{:.1} {:.1}\"{dash} marker-end=\"url(#head)\"/>\n",
        start.0, start.1, end.0, end.1
    );
    // Beside the line, on its own side; nearer to its start, because many lines end at one box.
    let at = |part: f64| {
        (
            start.0 + (end.0 - start.0) * part,
            start.1 + (end.1 - start.1) * part,
        )
    };
    let is_free = |(x, y): (f64, f64)| {
        AxisState::ALL.iter().all(|state| {
            let (cx, cy) = place(*state);
            (x - cx).abs() > 0.5 * WIDTH + 20.0 || (y - cy).abs() > 0.5 * HEIGHT + 20.0
        })
    };
    let parts = if x0 == x1 { [0.5, 0.4] } else { [0.36, 0.6] };
    let (x, y) = parts
        .map(at)
        .into_iter()
        .find(|point| is_free(*point))
        .unwrap_or(at(0.5));
    let (anchor, x, y) = match sx / SHIFT {
        side if side > 0.5 => ("start", x + 5.0, y + 4.0),
        side if side < -0.5 => ("end", x - 5.0, y + 4.0),
        side => {
            let anchor = if side.abs() < 0.1 {
                "middle"
            } else if side > 0.0 {
                "start"
            } else {
                "end"
            };
            (anchor, x, if sy < 0.0 { y - 6.0 } else { y + 14.0 })
        }
    };
    let _ = writeln!(
        text,
        "<text class=\"note\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{}</text>",
        label(arrow.on)
    );
    text
}

/// The point at which the ray from (`x`, `y`) along (`dx`, `dy`) leaves the box around (`cx`, `cy`).
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

#[cfg(test)]
mod tests {
    use super::*;
    use standstill_trace::Cell;

    /// In the picture of each block's page, the block begins in some scan, and its axis is in the state
    /// then.
    #[test]
    fn the_blocks_at_the_arrows_lead_where_runs_show() {
        let pictures = crate::pictures::pictures();
        let mut seen = 0;
        for arrow in ARROWS.iter().filter(|arrow| arrow.note == "command") {
            for block in blocks(arrow.on) {
                let picture = &pictures[*block];
                let trace = picture.trace();
                let own = trace
                    .header()
                    .instances
                    .iter()
                    .filter(|instance| instance.block == *block);
                let begins = own.filter_map(|instance| {
                    let active =
                        ["Active", "Busy"].map(|pin| trace.column(&format!("{}.{pin}", instance.name)));
                    active.into_iter().flatten().next()
                });
                let there: Vec<Vec<bool>> = trace
                    .header()
                    .axes
                    .iter()
                    .filter_map(|axis| trace.column(&format!("{}.State", axis.name)))
                    .map(|state| {
                        trace
                            .cells(state)
                            .map(|cell| cell == Cell::Name(arrow.to.name()))
                            .collect()
                    })
                    .collect();
                let leads = begins.into_iter().any(|column| {
                    let mut cells = trace.cells(column).enumerate();
                    cells.any(|(scan, cell)| cell == Cell::Bool(true) && there.iter().any(|is| is[scan]))
                });
                assert!(
                    leads,
                    "{block} leads to {} nowhere in {}",
                    arrow.to.name(),
                    picture.script
                );
                seen += 1;
            }
        }
        assert!(seen > 40);
    }
}

//! The records of the axes as notes in a trace.

use crate::text::{Called, happened, subject};
use standstill_axis::{Event, Order, Record, Setpoint, StandardPlan};
use standstill_trace::{Note, shortest};
use std::borrow::ToOwned;
use std::collections::BTreeMap;
use std::format;
use std::string::{String, ToString};
use std::vec::Vec;

/// What axes and block instances are called.
#[derive(Clone, Debug, Default)]
pub struct Names {
    /// Of the axes, in the order of their ids.
    pub axes: Vec<String>,
    /// Of the instances, by their numbers in records.
    pub instances: BTreeMap<u16, String>,
}

impl Called for Names {
    fn axis(&self, place: usize) -> &str {
        self.axes.get(place).map_or("", String::as_str)
    }

    fn instance(&self, number: u16) -> Option<&str> {
        self.instances.get(&number).map(String::as_str)
    }
}

/// The note of a record for the row at `scan`. `plan` is the plan it refers to, if it is still available.
pub fn note(names: &Names, record: &Record, scan: usize, plan: Option<&StandardPlan>) -> Note {
    Note {
        scan,
        subject: subject(names, record).to_owned(),
        text: text(names, record, plan),
    }
}

fn text(names: &Names, record: &Record, plan: Option<&StandardPlan>) -> String {
    let mut text = String::new();
    // A string takes whatever is written to it.
    happened(&mut text, names, record).unwrap_or_default();
    if let (Event::Planned { .. }, Some(plan)) = (record.event, plan) {
        text += "; ";
        text += &plan_text(plan);
    }
    text
}

/// All data of a plan, with exact bits.
fn plan_text(plan: &StandardPlan) -> String {
    match plan {
        StandardPlan::Grid(grid) if grid.scans() == 0 => format!("from {}", shortest(grid.start())),
        StandardPlan::Grid(grid) => {
            let boxes = boxes_text(grid.boxes(), grid.order(), grid.amplitude());
            format!("from {}, {boxes}", shortest(grid.start()))
        }
        StandardPlan::Unequal(grid) if grid.scans() == 0 => format!("from {}", shortest(grid.start())),
        StandardPlan::Unequal(grid) => {
            let [up, down] = grid.amplitudes();
            format!(
                "from {}, up {}, down {}",
                shortest(grid.start()),
                boxes_text(grid.up(), grid.order(), up),
                boxes_text(grid.down(), grid.order(), down)
            )
        }
        StandardPlan::Ramp(ramp) => ramp_text(
            ramp.segments()
                .map(|piece| [piece.duration, piece.acceleration, piece.jerk, piece.snap])
                .collect(),
        ),
        StandardPlan::Online(plan) => {
            let pieces = plan
                .segments()
                .map(|piece| [piece.duration, piece.acceleration, piece.jerk, piece.snap])
                .collect();
            format!("{} {}", plan.rung().name(), ramp_text(pieces))
        }
        StandardPlan::Profile(plan) => {
            let node = |(time, state): (f64, Setpoint)| {
                let state = [state.position, state.velocity, state.acceleration, state.jerk].map(shortest);
                format!("{} s: {}", shortest(time), state.join(" "))
            };
            let nodes: Vec<_> = plan.nodes().map(node).collect();
            format!("curve through {}", nodes.join(", "))
        }
        StandardPlan::Sampled(plan) => ramp_text(
            plan.profile()
                .segments()
                .map(|piece| [piece.duration, piece.acceleration, piece.jerk, piece.snap])
                .collect(),
        ),
    }
}

/// The lengths of the boxes, and the highest derivative they switch on and off.
fn boxes_text(boxes: &[u32], order: Order, amplitude: f64) -> String {
    let boxes: Vec<_> = boxes.iter().map(u32::to_string).collect();
    let derivative = match order {
        Order::Two => "acceleration",
        Order::Three => "jerk",
        Order::Four => "snap",
    };
    format!("boxes {}, {derivative} {}", boxes.join(" "), shortest(amplitude))
}

/// The highest derivative of a ramp, piece by piece. With its start state this defines the ramp. Each
/// piece has its duration (s), acceleration, jerk and snap.
fn ramp_text(pieces: Vec<[f64; 4]>) -> String {
    // The highest derivative that is ever used: it is constant in every piece.
    let highest = [("snap", 3), ("jerk", 2), ("acceleration", 1)]
        .into_iter()
        .find(|(_, place)| pieces.iter().any(|piece| piece[*place] != 0.0));
    let Some((name, place)) = highest else {
        return "nothing to change".to_owned();
    };
    let texts: Vec<_> = pieces
        .iter()
        .map(|piece| format!("{} for {} s", shortest(piece[place]), shortest(piece[0])))
        .collect();
    format!("{name} {}", texts.join(", "))
}

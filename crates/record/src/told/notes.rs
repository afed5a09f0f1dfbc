//! What the axes recorded, as notes in a trace.

use standstill_axis::{Event, Excess, Goal, Order, Record, Setpoint, StandardPlan};
use standstill_trace::{Note, shortest};
use std::borrow::ToOwned;
use std::collections::BTreeMap;
use std::format;
use std::string::{String, ToString};
use std::vec::Vec;

/// What the note of a shift begins with.
const SHIFTED: &str = "coordinates moved by ";

/// What axes and block instances are called.
#[derive(Clone, Debug, Default)]
pub struct Names {
    /// Of the axes, in the order of their ids.
    pub axes: Vec<String>,
    /// Of the instances, by their numbers in records.
    pub instances: BTreeMap<u16, String>,
}

impl Names {
    fn axis(&self, record: &Record) -> &str {
        self.axes.get(record.axis.index()).map_or("", String::as_str)
    }

    fn instance(&self, record: &Record) -> Option<&str> {
        self.instances.get(&record.instance.0).map(String::as_str)
    }
}

/// The note of a record for the row at `scan`; `plan` is the plan that it speaks of, where that is still there.
pub fn note(names: &Names, record: &Record, scan: usize, plan: Option<&StandardPlan>) -> Note {
    Note {
        scan,
        subject: subject(names, record).to_owned(),
        text: text(names, record, plan),
    }
}

/// By how much the coordinates of its subject moved (u), if this is what the text of a note tells.
#[must_use]
pub fn shift(text: &str) -> Option<f64> {
    text.strip_prefix(SHIFTED)?.parse().ok()
}

/// Whose line the note stands under: what a program asked for under its instance, what the axis did under
/// the axis.
fn subject<'n>(names: &'n Names, record: &Record) -> &'n str {
    match record.event {
        Event::Refused { .. }
        | Event::PointRefused { .. }
        | Event::Clamped { .. }
        | Event::Raised { .. }
        | Event::Superimposed { .. }
        | Event::RoomAwaited => names.instance(record).unwrap_or_else(|| names.axis(record)),
        Event::Unavoidable(_)
        | Event::Planned { .. }
        | Event::Paused { .. }
        | Event::Fault { .. }
        | Event::Shifted { .. } => names.axis(record),
    }
}

fn limit_text(limit: f64) -> String {
    if limit.is_nan() {
        String::new()
    } else {
        format!(", limit {}", shortest(limit))
    }
}

fn text(names: &Names, record: &Record, plan: Option<&StandardPlan>) -> String {
    match record.event {
        Event::Refused {
            pin,
            value,
            limit,
            error,
        } => {
            let number = error.number();
            let value = match pin {
                "" => String::new(),
                // Numbers of an enumeration.
                "BufferMode" | "Direction" | "ExecutionMode" => format!(", {pin} {value}"),
                pin => format!(", {pin} {}", shortest(value)),
            };
            let limit = limit_text(limit);
            format!("refused: {number} {}{value}{limit}", error.name())
        }
        Event::PointRefused {
            point,
            what,
            value,
            limit,
            error,
        } => {
            let (number, name) = (error.number(), error.name());
            let (value, limit) = (shortest(value), limit_text(limit));
            format!("refused: {number} {name}, point {point}, {what} {value}{limit}")
        }
        Event::Clamped { pin, value, limit } => {
            format!("clamped: {pin} {} to {}", shortest(value), shortest(limit))
        }
        Event::Raised { pin, value, limit } => {
            format!("raised: {pin} {} to {}", shortest(value), shortest(limit))
        }
        Event::Unavoidable(excess) => format!("unavoidable: {}", excess_text(&excess)),
        Event::Planned { goal, scans } => {
            let goal = match goal {
                Goal::Position(position) => format!("position {}", shortest(position)),
                Goal::Velocity(velocity) => format!("velocity {}", shortest(velocity)),
                Goal::Passing { position, velocity } => {
                    format!("velocity {} at {}", shortest(velocity), shortest(position))
                }
            };
            let by = names
                .instance(record)
                .map_or_else(String::new, |name| format!(" for {name}"));
            let how = plan.map_or_else(String::new, |plan| format!("; {}", plan_text(plan)));
            format!("plan{by} to {goal} in {scans} scans{how}")
        }
        Event::Superimposed {
            distance: Some(distance),
            scans,
        } => format!("superimposes {} in {scans} scans", shortest(distance)),
        Event::Superimposed {
            distance: None,
            scans,
        } => {
            format!("superimposed motion to rest in {scans} scans")
        }
        Event::RoomAwaited => "waits for room below the axis limits".to_owned(),
        Event::Paused { error } => format!("pauses: {} {}", error.number(), error.name()),
        Event::Shifted { by } => format!("{SHIFTED}{}", shortest(by)),
        Event::Fault { error, code } => {
            format!("fault {} {}, code {code}", error.number(), error.name())
        }
    }
}

fn excess_text(excess: &Excess) -> String {
    let parts = [
        ("velocity", excess.velocity),
        ("acceleration", excess.acceleration),
        ("jerk", excess.jerk),
    ];
    let told = parts
        .iter()
        .filter(|(_, value)| *value != 0.0)
        .map(|(name, value)| format!("{name} {} above its limit", shortest(*value)));
    told.collect::<Vec<_>>().join(", ")
}

/// Everything a plan is made of, to the bit.
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

/// Box lengths and the highest derivative they switch on and off.
fn boxes_text(boxes: &[u32], order: Order, amplitude: f64) -> String {
    let boxes: Vec<_> = boxes.iter().map(u32::to_string).collect();
    let derivative = match order {
        Order::Two => "acceleration",
        Order::Three => "jerk",
        Order::Four => "snap",
    };
    format!("boxes {}, {derivative} {}", boxes.join(" "), shortest(amplitude))
}

/// The highest derivative of a ramp piece by piece; with the state it starts from, that is all of it. A piece
/// is given as its duration (s), acceleration, jerk and snap.
fn ramp_text(pieces: Vec<[f64; 4]>) -> String {
    // The highest one that is ever there: it is constant in every piece.
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

//! What the axes recorded, as notes in the trace.

use super::bench::{ScriptMachine, instance_id};
use super::rows::Shift;
use crate::model::Script;
use standstill_axis::{Event, Excess, Goal, LOG_KEPT, Order, Record, Setpoint, StandardPlan};
use standstill_trace::{Note, Trace, shortest};

/// How many records have been taken from the ring so far.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Notes {
    taken: u64,
}

impl Notes {
    /// Takes this scan's records into the trace.
    pub(crate) fn take(
        &mut self,
        script: &Script,
        machine: &ScriptMachine,
        trace: &mut Trace,
        shifts: &mut Vec<Shift>,
    ) {
        let log = machine.log();
        let lost = (log.total() - self.taken).saturating_sub(LOG_KEPT as u64);
        let records: Vec<_> = log.since(self.taken).collect();
        self.taken = log.total();
        let scan = trace.scans().saturating_sub(1);
        if lost > 0 {
            trace.push_note(Note {
                scan,
                subject: "log".to_owned(),
                text: format!("{lost} records of this scan are lost: the ring holds {LOG_KEPT}"),
            });
        }
        for (index, record) in records.iter().enumerate() {
            if let Event::Shifted { by } = record.event {
                shifts.push(Shift {
                    scan: record.scan,
                    axis: record.axis.index(),
                    by,
                });
            }
            // Only the last plan of an axis in a scan is still there to be told in full.
            let replaced = records
                .iter()
                .skip(index + 1)
                .any(|later| later.axis == record.axis && matches!(later.event, Event::Planned { .. }));
            let axis = machine.axes().get(record.axis.index());
            let plan = axis
                .and_then(|axis| axis.plan())
                .map(|(plan, _)| plan)
                .filter(|_| !replaced);
            trace.push_note(Note {
                scan: usize::try_from(record.scan).unwrap_or(scan),
                subject: subject(script, record),
                text: text(script, record, plan),
            });
        }
    }
}

fn axis_name(script: &Script, record: &Record) -> String {
    let axis = script.axes.get(record.axis.index());
    axis.map_or_else(String::new, |axis| axis.name.clone())
}

fn instance_name<'a>(script: &'a Script, record: &Record) -> Option<&'a str> {
    (0..)
        .zip(&script.blocks)
        .find(|(index, _)| instance_id(*index) == record.instance)
        .map(|(_, instance)| instance.name.as_str())
}

/// Whose line the note stands under: what a program asked for under its instance, what the axis did under
/// the axis.
fn subject(script: &Script, record: &Record) -> String {
    match record.event {
        Event::Refused { .. }
        | Event::PointRefused { .. }
        | Event::Clamped { .. }
        | Event::Raised { .. }
        | Event::Superimposed { .. }
        | Event::RoomAwaited => {
            instance_name(script, record).map_or_else(|| axis_name(script, record), str::to_owned)
        }
        Event::Unavoidable(_)
        | Event::Planned { .. }
        | Event::Paused { .. }
        | Event::Fault { .. }
        | Event::Shifted { .. } => axis_name(script, record),
    }
}

fn limit_text(limit: f64) -> String {
    if limit.is_nan() {
        String::new()
    } else {
        format!(", limit {}", shortest(limit))
    }
}

fn text(script: &Script, record: &Record, plan: Option<&StandardPlan>) -> String {
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
            let by = instance_name(script, record).map_or_else(String::new, |name| format!(" for {name}"));
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
        Event::Shifted { by } => format!("coordinates moved by {}", shortest(by)),
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

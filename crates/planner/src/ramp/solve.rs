//! The spans of a ramp at each order, mirrored so that the start velocity is not negative.

use super::inside::{self, Box4, State};
use super::path::MAX_PIECES;
use super::slope::{Box3, Slope};
use crate::kernel::{Bounds, ON_LIMIT, Scale, Sides, Spans, second, third};
use crate::{Limits, Setpoint};

/// A ramp to find: everything mirrored so that the motion starts forwards.
#[derive(Clone, Copy, Debug)]
pub(super) struct Problem<'a> {
    /// Start state; its velocity is not negative, or only by rounding.
    pub(super) start: Setpoint,
    /// Velocity to reach (u/s).
    pub(super) goal: f64,
    /// Limits to keep.
    pub(super) limits: &'a Limits,
    /// The larger of old and new limits, for as long as the start state is outside.
    pub(super) wider: &'a Limits,
}

/// Spans of (seconds, highest derivative), and the root steps it took.
pub(super) struct Solution {
    pub(super) spans: Spans<MAX_PIECES>,
    pub(super) steps: u32,
    /// Whether the start was inside and viable and the ramp keeps its direction, so that it exceeds nothing.
    pub(super) viable: bool,
}

impl Problem<'_> {
    /// The acceleration bounds the ramp itself uses (R11).
    ///
    /// Forwards, what is above zero raises the speed and what is below lowers it. Where the velocity
    /// changes its sign on the way both do both, so the lower bound of the two holds on that side; `dips`
    /// says that it goes below zero on its way to a goal that is not.
    fn sides(&self, dips: bool) -> Sides {
        let lower = self.limits.lower_acceleration();
        let reverses = self.goal < 0.0;
        Sides {
            minus: if reverses { lower } else { self.limits.deceleration },
            plus: if reverses || dips {
                lower
            } else {
                self.limits.acceleration
            },
        }
    }

    /// Order 2: one straight line, or two if the velocity has to come inside its limit first (R12).
    pub(super) fn second_order(&self) -> Solution {
        let mut spans = Spans::new();
        let sides = self.sides(false);
        let mut velocity = self.start.velocity;
        let limit = self.limits.velocity;
        let viable = velocity <= limit && velocity >= 0.0;
        if velocity > limit * (1.0 + ON_LIMIT) {
            let fast = self.wider.deceleration;
            spans.push((velocity - limit) / fast, -fast);
            velocity = limit;
        }
        let change = self.goal - velocity;
        if change > 0.0 {
            spans.push(change / sides.plus, sides.plus);
        } else {
            spans.push(-change / sides.minus, -sides.minus);
        }
        Solution {
            spans,
            steps: 0,
            viable,
        }
    }

    /// Order 3: `(velocity, acceleration)` to `(goal, 0)` (R3).
    pub(super) fn third_order(&self) -> Solution {
        let limits = self.limits;
        let scale = Scale::new(limits.acceleration.max(limits.deceleration), limits.jerk, 1);
        let start = Slope {
            v: scale.inward(self.start.velocity, 2),
            a: scale.inward(self.start.acceleration, 1),
        };
        let goal = scale.inward(self.goal, 2);
        let limit = scale.inward(limits.velocity, 2);
        let bounds = Box3 {
            up: scale.inward(limits.acceleration, 1),
            down: scale.inward(limits.deceleration, 1),
            brake_before: scale.inward(self.wider.deceleration, 1),
            jerk_before: self.wider.jerk / limits.jerk,
        };
        let (lead, steps) = start.lead_in(goal, limit, &bounds);
        let viable = lead.is_empty() && goal >= 0.0 && start.is_viable(limit);
        let state = start.after_all(&lead);
        let dips = goal >= 0.0 && state.rest() < 0.0;
        let sides = scaled(self.sides(dips), &scale, 1);
        let mut spans = Spans::new();
        spans.extend(&lead);
        spans.extend(&second(state.v, state.a, goal, sides));
        Solution {
            spans: in_seconds(&spans, &scale),
            steps,
            viable,
        }
    }

    /// Order 4: `(velocity, acceleration, jerk)` to `(goal, 0, 0)` (R4 to R10).
    pub(super) fn fourth_order(&self) -> Solution {
        let limits = self.limits;
        let scale = Scale::new(limits.acceleration.max(limits.deceleration), limits.snap, 2);
        let state = State {
            v: scale.inward(self.start.velocity, 3),
            a: scale.inward(self.start.acceleration, 2),
            j: scale.inward(self.start.jerk, 1),
        };
        let goal = scale.inward(self.goal, 3);
        let limit = scale.inward(limits.velocity, 3);
        let jerk = scale.inward(limits.jerk, 1);
        let as_given = Sides {
            minus: limits.deceleration,
            plus: limits.acceleration,
        };
        let bounds = Box4 {
            a: scaled(as_given, &scale, 2),
            brake_before: scale.inward(self.wider.deceleration, 2),
            jerk,
            jerk_before: scale.inward(self.wider.jerk, 1),
            snap_before: self.wider.snap / limits.snap,
        };
        let own = |dips| Bounds {
            v: scaled(self.sides(dips), &scale, 2),
            a: Sides::both(jerk),
        };
        let low = if goal < 0.0 { -limit } else { 0.0 };
        let lead = inside::lead_in(state, goal, (low, limit), &bounds, &own(true));
        let dips = goal >= 0.0 && (lead.state.v < 0.0 || lead.rest < 0.0);
        let State { v, a, j } = lead.state;
        let profile = third(v, a, j, goal, &own(dips));
        let mut spans = Spans::new();
        spans.extend(&lead.spans);
        spans.extend(&profile.spans);
        Solution {
            spans: in_seconds(&spans, &scale),
            steps: lead.steps.max(profile.steps),
            viable: lead.viable && goal >= 0.0,
        }
    }
}

fn scaled(sides: Sides, scale: &Scale, levels: u32) -> Sides {
    Sides {
        minus: scale.inward(sides.minus, levels),
        plus: scale.inward(sides.plus, levels),
    }
}

fn in_seconds(spans: &Spans<MAX_PIECES>, scale: &Scale) -> Spans<MAX_PIECES> {
    let mut seconds = Spans::new();
    for span in spans.iter() {
        seconds.push(scale.seconds(span.duration), scale.input(span.input));
    }
    seconds
}

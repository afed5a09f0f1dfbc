//! The spans of a ramp at each order, mirrored so that the start velocity is not negative.

use super::inside::{self, Box4, State};
use super::path::MAX_PIECES;
use crate::kernel::{Bounds, ON_LIMIT, Scale, Sides, Spans, falling_root, second, third};
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
        Solution { spans, steps: 0 }
    }

    /// Order 3: `(velocity, acceleration)` to `(goal, 0)` (R3).
    pub(super) fn third_order(&self) -> Solution {
        let limits = self.limits;
        let scale = Scale::new(limits.acceleration.max(limits.deceleration), limits.jerk, 1);
        let mut spans = Spans::new();
        let mut state = Slope {
            v: scale.inward(self.start.velocity, 2),
            a: scale.inward(self.start.acceleration, 1),
        };
        let goal = scale.inward(self.goal, 2);
        let jerk = self.wider.jerk / limits.jerk;
        let limit = scale.inward(limits.velocity, 2);
        let up = scale.inward(limits.acceleration, 1);
        let down = scale.inward(limits.deceleration, 1);
        let fast = scale.inward(self.wider.deceleration, 1);
        let rest = |state: Slope| state.v + 0.5 * state.a * state.a.abs();
        let mut steps = 0;
        if (jerk > 1.0 || fast > down) && state.v.max(rest(state)) > limit * (1.0 + ON_LIMIT) {
            // As at order 4 (R19), with a push of one span.
            let mut push = Spans::<1>::new();
            push.push((state.a + fast) / jerk, -jerk);
            let lead = |time: f64| {
                let mut spans = push.until::<3>(time);
                spans.extend(&state.after_all(&spans).inside(up, down, jerk));
                spans
            };
            let above = |time: f64| {
                let state = state.after_all(&lead(time));
                (state.v.max(rest(state)) - limit).min(rest(state) - goal)
            };
            let pushed = state.after_all(&push);
            let longest = push.duration() + (pushed.v - goal).max(0.0) / fast;
            let time;
            (time, steps) = falling_root(0.0, longest, above);
            spans.extend(&lead(time));
        } else {
            spans.extend(&state.inside(up, down, jerk));
        }
        state = state.after_all(&spans);
        let dips = goal >= 0.0 && rest(state) < 0.0;
        let sides = scaled(self.sides(dips), &scale, 1);
        spans.extend(&second(state.v, state.a, goal, sides));
        Solution {
            spans: in_seconds(&spans, &scale),
            steps,
        }
    }

    /// Order 4: `(velocity, acceleration, jerk)` to `(goal, 0, 0)` (R4 to R10).
    pub(super) fn fourth_order(&self) -> Solution {
        let limits = self.limits;
        let scale = Scale::new(limits.acceleration.max(limits.deceleration), limits.snap, 2);
        let mut spans = Spans::new();
        let mut state = State {
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
        let sides = |dips| scaled(self.sides(dips), &scale, 2);
        let lowest = if goal < 0.0 { -limit } else { 0.0 };
        let mut steps;
        let fastest = state.v.max(inside::arrested(state, jerk));
        if bounds.is_lowered() && fastest > limit * (1.0 + ON_LIMIT) {
            let hastened;
            (hastened, steps) = inside::hasten(state, limit, goal, lowest, &bounds);
            spans.extend(&hastened);
            state = state.after_all(&hastened);
        } else {
            let entering = inside::enter(state, &bounds);
            spans.extend(&entering);
            state = state.after_all(&entering);
            let slack = ON_LIMIT * limit.min(state.v.abs().max(goal.abs()));
            let bounds = Bounds {
                v: sides(true),
                a: Sides::both(jerk),
            };
            let relief;
            (relief, steps) = inside::relieve(state, lowest, limit, slack, &bounds);
            spans.extend(&relief);
            state = state.after_all(&relief);
        }

        let rest = inside::arrested(state, jerk);
        let dips = goal >= 0.0 && (state.v < 0.0 || rest < 0.0);
        let bounds = Bounds {
            v: sides(dips),
            a: Sides::both(jerk),
        };
        let profile = third(state.v, state.a, state.j, goal, &bounds);
        spans.extend(&profile.spans);
        steps = steps.max(profile.steps);
        Solution {
            spans: in_seconds(&spans, &scale),
            steps,
        }
    }
}

/// Velocity and acceleration in the kernel's units; the jerk is the input.
#[derive(Clone, Copy, Debug)]
struct Slope {
    v: f64,
    a: f64,
}

impl Slope {
    fn after_all<const N: usize>(self, spans: &Spans<N>) -> Self {
        spans.iter().fold(self, |state, span| Self {
            v: state.v + span.duration * (state.a + 0.5 * span.duration * span.input),
            a: state.a + span.duration * span.input,
        })
    }

    /// The span that brings an acceleration outside `-down ..= up` to it, if it is.
    fn inside(self, up: f64, down: f64, jerk: f64) -> Spans<1> {
        let mut spans = Spans::new();
        if self.a > up * (1.0 + ON_LIMIT) {
            spans.push((self.a - up) / jerk, -jerk);
        } else if self.a < -down * (1.0 + ON_LIMIT) {
            spans.push((-down - self.a) / jerk, jerk);
        }
        spans
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

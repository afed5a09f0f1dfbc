//! Getting a start state inside the limits at order 3, where the jerk is the input.
//!
//! Everything is in the kernel's units and mirrored so that the velocity is not negative.

use crate::kernel::{ON_LIMIT, Sides, Spans, falling_root};

/// Velocity and acceleration in the kernel's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Slope {
    pub(super) v: f64,
    pub(super) a: f64,
}

/// Bounds at order 3 in the kernel's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Box3 {
    /// Acceleration above zero.
    pub(super) up: f64,
    /// Magnitude of the acceleration below zero.
    pub(super) down: f64,
    /// The same until the state is inside; at least `down`.
    pub(super) brake_before: f64,
    /// Jerk until the state is inside, as a multiple of the jerk bound; at least 1.
    pub(super) jerk_before: f64,
    /// The velocity goes through zero afterwards, and `up` holds from there on.
    pub(super) turns: bool,
}

impl Slope {
    pub(super) fn after_all<const N: usize>(self, spans: &Spans<N>) -> Self {
        spans.iter().fold(self, |state, span| Self {
            v: state.v + span.duration * (state.a + 0.5 * span.duration * span.input),
            a: state.a + span.duration * span.input,
        })
    }

    /// The velocity once the acceleration is zero, as soon as possible (R2).
    pub(super) fn rest(self) -> f64 {
        self.v + 0.5 * self.a * self.a.abs()
    }

    /// The velocity once an acceleration below `-rate` has returned to it.
    fn at_rate(self, rate: f64) -> f64 {
        self.v - 0.5 * (self.a * self.a - rate * rate).max(0.0)
    }

    /// Whether the velocity stays in `0 ..= limit` until [`Slope::rest`].
    pub(super) fn is_viable(self, limit: f64) -> bool {
        self.v.max(self.rest()) <= limit && self.v.min(self.rest()) >= 0.0
    }

    /// The spans that bring acceleration and velocity inside, and the root steps (R19); none if they are inside.
    /// The velocity must be in `range`.
    pub(super) fn lead_in(self, goal: f64, range: Sides, bounds: &Box3) -> (Spans<3>, u32) {
        let limit = range.plus;
        let Box3 {
            down,
            brake_before: brake,
            jerk_before: jerk,
            ..
        } = *bounds;
        let is_lowered = jerk > 1.0 || brake > down;
        // It will pass zero and leave the range on the other side. Until it is through, the force that brings it
        // back is an acceleration.
        if jerk > 1.0 && self.rest() < -range.minus * (1.0 + ON_LIMIT) {
            let turned = Box3 {
                up: down,
                down: bounds.up,
                brake_before: bounds.up,
                jerk_before: jerk,
                turns: false,
            };
            let mirrored = Self {
                v: -self.v,
                a: -self.a,
            };
            let (spans, steps) = mirrored.lead_in(-goal, range.mirrored(), &turned);
            return (spans.mirrored(), steps);
        }
        if !is_lowered || self.v.max(self.rest()) <= limit * (1.0 + ON_LIMIT) {
            let mut spans = Spans::new();
            spans.extend(&self.enter(bounds));
            return (spans, 0);
        }
        let mut push = Spans::<1>::new();
        push.push((self.a + brake) / jerk, -jerk);
        let lead = |time: f64| {
            let mut spans = push.until::<3>(time);
            spans.extend(&self.after_all(&spans).enter(bounds));
            spans
        };
        let above = |time: f64| {
            let state = self.after_all(&lead(time));
            let inside = (state.v.max(state.rest()) - limit).min(state.rest() - goal);
            if bounds.turns {
                inside.min(state.at_rate(bounds.up))
            } else {
                inside
            }
        };
        let pushed = self.after_all(&push);
        let longest = push.duration() + (pushed.v - goal).max(0.0) / brake;
        let (time, steps) = falling_root(0.0, longest, above);
        (lead(time), steps)
    }

    /// The span that brings an acceleration outside its bounds to them, if it is outside.
    fn enter(self, bounds: &Box3) -> Spans<1> {
        let Box3 {
            up,
            down,
            jerk_before: jerk,
            ..
        } = *bounds;
        let mut spans = Spans::new();
        if self.a > up * (1.0 + ON_LIMIT) {
            spans.push((self.a - up) / jerk, -jerk);
        } else if self.a < -down * (1.0 + ON_LIMIT) {
            spans.push((-down - self.a) / jerk, jerk);
        }
        spans
    }
}

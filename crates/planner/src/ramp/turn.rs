//! Ramps on which the velocity changes its sign, with a deceleration of its own (O5).
//!
//! What slows the motion down on one side of zero speeds it up on the other, so such a ramp is made of legs
//! that meet where the velocity is zero. Everything is in the kernel's units and mirrored so that the
//! motion starts forwards.

use super::inside::{self, Box4, State};
use super::path::Way;
use super::solve::Ramps;
use crate::kernel::{Bounds, ON_LIMIT, Sides, Spans, THIRD_SPANS, falling_root, second, third};
use crate::{Order, Setpoint};

/// Most spans of a leg: a profile, or a push of three, a hold and a release of three.
const LEG_SPANS: usize = 7;

/// Most spans of a ramp that turns: once back if it dips, once to zero, perhaps after coming inside other
/// bounds, and on from there.
pub(super) const TURN_SPANS: usize = 3 * LEG_SPANS + 3;

/// A ramp in the making.
struct Legs {
    spans: Spans<TURN_SPANS>,
    way: Way,
    steps: u32,
}

impl Ramps {
    /// The spans from `start`, which moves forwards, to `goal`, where the velocity changes its sign on the
    /// way; also the root steps taken.
    pub(super) fn turning(&self, start: &Setpoint, goal: f64) -> (Spans<TURN_SPANS>, u32) {
        let mut legs = Legs::from(Way::new(self.order(), start));
        if goal < 0.0 {
            self.brake_to_zero(&mut legs, goal);
            self.speed_up(&mut legs, goal);
        } else if legs.until_zero(&self.plain(start, goal, self.forward())) {
            // It dips below zero: from there it comes back like a motion that starts the other way.
            let mut back = Legs::from(legs.way);
            back.way.state = mirrored(&legs.way.state);
            if goal > 0.0 {
                self.brake_to_zero(&mut back, -goal);
                self.speed_up(&mut back, -goal);
            } else {
                let stop = self.plain(&back.way.state, 0.0, self.forward());
                back.spans.extend(&stop);
            }
            legs.spans.extend(&back.spans.mirrored());
            legs.steps = legs.steps.max(back.steps);
        }
        (legs.spans, legs.steps)
    }

    /// The leg to where the velocity passes zero on the way to `goal` < 0.
    fn brake_to_zero(&self, legs: &mut Legs, goal: f64) {
        let mut direct = Legs::from(legs.way);
        direct.until_zero(&self.plain(&legs.way.state, goal, self.forward()));
        if self.may_speed_up(&direct.way.state) {
            legs.append(&direct);
        } else if !self.release_at_zero(legs) {
            // Too late for that: inside what the other side allows as soon as can be.
            let lower = Sides::both(self.acceleration());
            if self.order() == Order::Four {
                let state = state(&legs.way.state);
                let lead = inside::enter(
                    state,
                    &Box4 {
                        a: lower,
                        brake_before: lower.minus,
                        jerk: self.jerk(),
                        jerk_before: self.jerk(),
                        snap_before: 1.0,
                    },
                );
                legs.follow(&lead);
            }
            let gently = self.plain(&legs.way.state, goal, lower);
            legs.until_zero(&gently);
        }
    }

    /// Whether a state at zero velocity stays within the acceleration limit of the motion it begins.
    fn may_speed_up(&self, state: &Setpoint) -> bool {
        let (a, j) = (state.acceleration, state.jerk);
        let coming = match self.order() {
            Order::Two => 0.0,
            Order::Three => a,
            Order::Four => a.min(a + 0.5 * j * j.abs()),
        };
        coming >= -self.acceleration() * (1.0 + ON_LIMIT)
    }

    /// The leg that brakes with the deceleration, and is back at the acceleration limit, which is lower,
    /// just when the velocity is zero; whether there is one.
    fn release_at_zero(&self, legs: &mut Legs) -> bool {
        let (low, high) = (-self.deceleration(), -self.acceleration());
        let begin = legs.way;
        let push = self.change(&begin.state, low);
        let braking = |time: f64| {
            let mut leg = Legs::from(begin);
            leg.follow(&push.until::<4>(time));
            let release = self.change(&leg.way.state, high);
            leg.follow(&release);
            leg
        };
        let left = |time: f64| braking(time).way.state.velocity;
        // A state on the release itself is off it by rounding.
        let room = left(0.0);
        if room < -ON_LIMIT * self.velocity() {
            return false;
        }
        let mut pushed = begin;
        pushed.follow(&push);
        let longest = push.duration() + pushed.state.velocity.max(0.0) / self.deceleration();
        let (time, steps) = if room > 0.0 {
            falling_root(0.0, longest, left)
        } else {
            (0.0, 0)
        };
        legs.append(&braking(time));
        legs.steps = legs.steps.max(steps);
        // What the root leaves of the velocity is rounding.
        legs.way.state.velocity = legs.way.state.velocity.min(0.0);
        true
    }

    /// The leg from zero velocity on to `goal` < 0: a motion that speeds up the other way.
    fn speed_up(&self, legs: &mut Legs, goal: f64) {
        let speeding = self
            .plain(&mirrored(&legs.way.state), -goal, self.forward())
            .mirrored();
        legs.spans.extend(&speeding);
    }

    /// The bounds of a motion that keeps its sign.
    fn forward(&self) -> Sides {
        Sides {
            minus: self.deceleration(),
            plus: self.acceleration(),
        }
    }

    /// The least-time spans under the same bounds throughout.
    fn plain(&self, start: &Setpoint, goal: f64, sides: Sides) -> Spans<THIRD_SPANS> {
        let State { v, a, j } = state(start);
        let mut spans = Spans::new();
        match self.order() {
            Order::Two if goal > v => spans.push((goal - v) / sides.plus, sides.plus),
            Order::Two => spans.push((v - goal) / sides.minus, -sides.minus),
            Order::Three => spans.extend(&second(v, a, goal, sides)),
            Order::Four => {
                let bounds = Bounds {
                    v: sides,
                    a: Sides::both(self.jerk()),
                };
                spans = third(v, a, j, goal, &bounds).spans;
            }
        }
        spans
    }

    /// The least-time spans to another acceleration, with no jerk at order 4.
    fn change(&self, start: &Setpoint, acceleration: f64) -> Spans<3> {
        let change = acceleration - start.acceleration;
        let mut spans = Spans::new();
        match self.order() {
            Order::Two => {}
            Order::Three => spans.push(change.abs(), change.signum()),
            Order::Four => {
                spans = second(
                    start.acceleration,
                    start.jerk,
                    acceleration,
                    Sides::both(self.jerk()),
                );
            }
        }
        spans
    }
}

impl Legs {
    const fn from(way: Way) -> Self {
        Self {
            spans: Spans::new(),
            way,
            steps: 0,
        }
    }

    fn follow<const N: usize>(&mut self, spans: &Spans<N>) {
        self.way.follow(spans);
        self.spans.extend(spans);
    }

    /// Follows `spans` as far as the velocity is not below zero; whether it comes to that.
    fn until_zero<const N: usize>(&mut self, spans: &Spans<N>) -> bool {
        for span in spans.iter() {
            self.way.begin(span.input);
            let after = |time: f64| {
                let mut way = self.way;
                way.go(time);
                way.state
            };
            let begin = self.way.state.velocity;
            if after(span.duration).velocity >= 0.0 {
                self.spans.push(span.duration, span.input);
                self.way.go(span.duration);
                continue;
            }
            if begin > 0.0 {
                let (time, steps) = falling_root(0.0, span.duration, |time| after(time).velocity);
                self.spans.push(time, span.input);
                self.way.go(time);
                self.steps = self.steps.max(steps);
            }
            return true;
        }
        false
    }

    fn append(&mut self, other: &Self) {
        self.spans.extend(&other.spans);
        self.way = other.way;
        self.steps = self.steps.max(other.steps);
    }
}

fn state(state: &Setpoint) -> State {
    State {
        v: state.velocity,
        a: state.acceleration,
        j: state.jerk,
    }
}

fn mirrored(state: &Setpoint) -> Setpoint {
    Setpoint {
        position: -state.position,
        velocity: -state.velocity,
        acceleration: -state.acceleration,
        jerk: -state.jerk,
        snap: 0.0,
    }
}

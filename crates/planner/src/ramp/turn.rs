//! Ramps on which the velocity changes its sign, with a deceleration of its own (O5).
//!
//! The rate that slows the motion down on one side of zero speeds it up on the other, so such a ramp is made of
//! legs that meet at velocity zero. Everything is in the kernel's units and mirrored so that the motion starts
//! forwards.

use super::inside::{self, State};
use super::path::Way;
use super::solve::Ramps;
use crate::kernel::{Bounds, ON_LIMIT, Profile, Sides, Spans, THIRD_SPANS, falling_root, second, third};
use crate::math::sqrt;
use crate::{Order, Setpoint};

/// Largest number of spans of a leg: a profile, or a push of three, a hold and a release of three.
const LEG_SPANS: usize = 7;

/// Largest number of spans of a ramp that turns: once back if it dips, once to zero, possibly after getting inside
/// other bounds, and on from there.
pub(super) const TURN_SPANS: usize = 3 * LEG_SPANS + 3;

/// Twice the bracket that a false position leaves, relative to its first width: this much sooner its function is
/// surely not below zero.
const SURELY_BEFORE: f64 = 2e-14;

/// A ramp in the making.
struct Legs {
    spans: Spans<TURN_SPANS>,
    way: Way,
    steps: u32,
}

impl Ramps {
    /// The spans from `start`, which moves forwards, to `goal`, if the velocity changes its sign on the way. Also
    /// returns the root steps.
    pub(super) fn turning(&self, start: &Setpoint, goal: f64) -> (Spans<TURN_SPANS>, u32) {
        let mut legs = Legs::from(Way::new(self.order(), start, self.lower()));
        if goal < 0.0 {
            self.turn(&mut legs, goal);
        } else if legs.until_zero(&self.plain(start, goal, self.forward())) {
            // It dips below zero: from there it comes back like a motion that starts in the other direction.
            let mut back = Legs::from(legs.way);
            back.way.state = mirrored(&legs.way.state);
            if goal > 0.0 {
                self.turn(&mut back, -goal);
            } else {
                back.follow_profile(&self.plain(&back.way.state, 0.0, self.forward()));
            }
            legs.spans.extend(&back.spans.mirrored());
            legs.steps = legs.steps.max(back.steps);
        }
        (legs.spans, legs.steps)
    }

    /// The legs to `goal` < 0: braking until the velocity is zero, and speeding up from there.
    fn turn(&self, legs: &mut Legs, goal: f64) {
        let direct = self.plain(&legs.way.state, goal, self.forward());
        let mut braking = Legs::from(legs.way);
        braking.until_zero(&direct);
        if self.may_pass(&legs.way, &direct.spans, braking.spans.duration()) {
            legs.follow_profile(&direct);
        } else if self.may_speed_up(&braking.way.state) {
            legs.append(&braking);
            self.speed_up(legs, goal);
        } else {
            self.release(legs, goal);
        }
    }

    /// Whether `spans` from `begin`, which pass zero velocity after `zero`, are also the best motion from there on:
    /// inside the acceleration limit, and not kept from using it by a lower deceleration limit.
    fn may_pass(&self, begin: &Way, spans: &Spans<THIRD_SPANS>, zero: f64) -> bool {
        let mut way = *begin;
        let (mut elapsed, mut lowest) = (0.0, f64::INFINITY);
        for span in spans.iter() {
            let Setpoint {
                acceleration: a,
                jerk: j,
                snap: s,
                ..
            } = way.begin(span.input);
            let at = |time: f64| a + time * (j + 0.5 * time * s);
            let (from, to) = (zero - elapsed, span.duration);
            if from < to {
                let from = from.max(0.0);
                let flat = -j / s;
                let between = if flat > from && flat < to { flat } else { to };
                lowest = lowest.min(at(from)).min(at(between)).min(at(to));
            }
            elapsed += span.duration;
            way.go(span.duration);
        }
        if self.deceleration() < self.acceleration() {
            lowest > -self.deceleration() * (1.0 - ON_LIMIT)
        } else {
            lowest >= -self.acceleration() * (1.0 + ON_LIMIT)
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

    /// The legs that brake with the deceleration, are back at the lower acceleration limit exactly when the
    /// velocity is zero, and continue from there (O14).
    ///
    /// They come back with the jerk of [`Ramps::arrival`]. If even an immediate release is too late for that jerk,
    /// they use the least one that is early enough. A stop is on such a release, so a start that could still stop
    /// is never too late. From any other start the acceleration comes inside as soon as possible.
    fn release(&self, legs: &mut Legs, goal: f64) {
        let begin = legs.way;
        let push = self.change(&begin.state, -self.deceleration());
        let released = |time: f64, arrival: f64| {
            let mut leg = Legs::from(begin);
            leg.follow(&push.until::<4>(time));
            let limit = -self.acceleration();
            let arrival = self.reachable(&leg.way.state, arrival);
            let beyond = self.change(&leg.way.state, limit + 0.5 * arrival * arrival);
            leg.follow(&beyond.until::<4>(beyond.duration() - arrival));
            (leg, arrival)
        };
        let left = |time: f64, arrival: f64| released(time, arrival).0.way.state.velocity;
        let (wanted, steps) = self.arrival(goal);
        legs.steps = legs.steps.max(steps);
        let in_time = left(0.0, wanted) >= 0.0;
        let (time, arrival, steps) = if in_time {
            let mut pushed = begin;
            pushed.follow(&push);
            let longest = push.duration() + pushed.state.velocity.max(0.0) / self.deceleration();
            let (time, steps) = falling_root(0.0, longest, |time| left(time, wanted));
            (self.not_too_late(time, longest), wanted, steps)
        } else if self.may_speed_up(&begin.state) {
            // Inside the lower limit it can stay inside.
            legs.follow_profile(&self.plain(&begin.state, goal, Sides::both(self.acceleration())));
            return;
        } else {
            let most = self.stoppable();
            if left(0.0, most) >= 0.0 {
                let (arrival, steps) = falling_root(wanted, most, |arrival| -left(0.0, arrival));
                (0.0, arrival, steps)
            } else {
                (0.0, most, 0)
            }
        };
        let (leg, arrived) = released(time, arrival);
        legs.append(&leg);
        legs.steps = legs.steps.max(steps);
        // The remainder of the velocity after the root is rounding.
        legs.way.state.velocity = legs.way.state.velocity.min(0.0);
        if in_time && wanted > 0.0 && arrived == wanted {
            // The remainder of the goal after the root of the jerk is rounding, too; correcting it would take its
            // cube root in time.
            let arrest = self.change(&legs.way.state, 0.0);
            legs.follow(&arrest);
        } else {
            self.speed_up(legs, goal);
        }
    }

    /// The `time` at which a release begins, or a little sooner if the velocity would come to zero visibly before
    /// the acceleration reaches its limit; `longest` is the bracket of the search.
    ///
    /// At order 3 the acceleration gets there at full jerk. A velocity error that is small beside the deceleration
    /// then puts it beyond the limit by a part of it that grows with the square of their ratio.
    fn not_too_late(&self, time: f64, longest: f64) -> f64 {
        let sooner = SURELY_BEFORE * longest;
        let at_limit = self.acceleration() * self.acceleration();
        let shows = sooner * self.deceleration() > 0.5 * ON_LIMIT * at_limit;
        if self.order() == Order::Three && shows {
            (time - sooner).max(0.0)
        } else {
            time
        }
    }

    /// The jerk with which a release should come back to the acceleration limit at zero velocity. It is zero,
    /// unless the acceleration could then not be removed before the velocity passes `goal` < 0; then it is the jerk
    /// with which that is just possible. Also returns the root steps.
    fn arrival(&self, goal: f64) -> (f64, u32) {
        let beyond = |jerk: f64| {
            let state = State {
                v: 0.0,
                a: -self.acceleration(),
                j: jerk,
            };
            goal - inside::arrested(state, self.jerk())
        };
        // At order 3 the path to such a goal keeps the limit by itself.
        if self.order() < Order::Four || beyond(0.0) <= 0.0 {
            return (0.0, 0);
        }
        let most = self.stoppable();
        if beyond(most) > 0.0 {
            (most, 0)
        } else {
            falling_root(0.0, most, beyond)
        }
    }

    /// The largest jerk at the acceleration limit that can be stopped before the acceleration changes its
    /// sign.
    fn stoppable(&self) -> f64 {
        match self.order() {
            Order::Two | Order::Three => 0.0,
            Order::Four => self.jerk().min(sqrt(2.0 * self.acceleration())),
        }
    }

    /// The jerk nearest to `wanted` with which the acceleration can return to its limit from `start` without a
    /// detour.
    fn reachable(&self, start: &Setpoint, wanted: f64) -> f64 {
        let State { a, j, .. } = state(start);
        let change = -self.acceleration() - a;
        if self.order() < Order::Four || change <= 0.0 && j >= 0.0 {
            return 0.0;
        }
        // A jerk that already rises leaves this much.
        let least = if j > 0.0 {
            sqrt((j * j - 2.0 * change).max(0.0))
        } else {
            0.0
        };
        let most = sqrt((j * j + 2.0 * change).max(0.0));
        wanted.max(least).min(most)
    }

    /// The leg from zero velocity to `goal` < 0: a motion that speeds up in the other direction.
    fn speed_up(&self, legs: &mut Legs, goal: f64) {
        let Profile { spans, steps } = self.plain(&mirrored(&legs.way.state), -goal, self.forward());
        legs.spans.extend(&spans.mirrored());
        legs.steps = legs.steps.max(steps);
    }

    /// The bounds of a motion that keeps its sign.
    fn forward(&self) -> Sides {
        Sides {
            minus: self.deceleration(),
            plus: self.acceleration(),
        }
    }

    /// The least-time path under the same bounds throughout.
    fn plain(&self, start: &Setpoint, goal: f64, sides: Sides) -> Profile {
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
                return third(v, a, j, goal, &bounds);
            }
        }
        Profile { spans, steps: 0 }
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

    fn follow_profile(&mut self, profile: &Profile) {
        self.follow(&profile.spans);
        self.steps = self.steps.max(profile.steps);
    }

    /// Follows `profile` while the velocity is not below zero; returns whether it reaches zero.
    fn until_zero(&mut self, profile: &Profile) -> bool {
        self.steps = self.steps.max(profile.steps);
        for span in profile.spans.iter() {
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

//! The candidates of the ladder: push then stop, with a peak velocity, from a constant velocity.
//!
//! Everything is in the kernel's units, with positions counted from the start.

use core::cell::Cell;

use crate::Setpoint;
use crate::kernel::{MAX_STEPS, NOISE, ON_LIMIT, Point, Sides, Span, Spans, THIRD_SPANS, zero};
use crate::math::min;
use crate::ramp::path::Way;
use crate::ramp::solve::{RAMP_SPANS, Ramp, Ramps};

/// Largest number of spans of a candidate: a ramp before it, a push, a cruise and a stop.
pub(super) const CANDIDATE_SPANS: usize = 3 * RAMP_SPANS + 1;

/// Number of parts of a span of the push that are examined for the first crossing of a move that does not end at
/// rest (O4).
pub(super) const PARTS: usize = 8;

/// Largest number of ramps that [`Search::push_then_stop`] solves: one for each check of the push, one for each
/// step of the root, and those around them.
const MAX_PUSH_SOLVES: u32 = (PARTS * RAMP_SPANS) as u32 + MAX_STEPS + 6;

/// Largest number of halvings of a velocity on the last rung: the rest is rounding beside the bound.
const HALVINGS: u32 = 64;

/// Largest number of ramps that a plan may solve, on all rungs together.
pub const MAX_SOLVES: u32 = 2 * MAX_PUSH_SOLVES + 2 * (MAX_STEPS + 3) + 2 * (HALVINGS + 1) + 5;

/// The spans of a whole move.
pub(super) type Candidate = Spans<CANDIDATE_SPANS>;

/// The search for a move.
pub(super) struct Search<'a> {
    ramps: &'a Ramps,
    target: f64,
    end_velocity: f64,
    /// The velocity that a push goes for and a cruise keeps in each direction: that of the limits, or less.
    top: Sides,
    /// The largest error of the positions of start and target.
    resolution: f64,
    pub(super) work: Work,
}

/// The work of a search so far.
pub(super) struct Work {
    solves: Cell<u32>,
    steps: Cell<u32>,
}

impl Work {
    pub(super) const fn nothing() -> Self {
        Self {
            solves: Cell::new(0),
            steps: Cell::new(0),
        }
    }

    /// Number of ramps solved.
    pub(super) const fn solves(&self) -> u32 {
        self.solves.get()
    }

    /// Largest number of steps of one root.
    pub(super) const fn steps(&self) -> u32 {
        self.steps.get()
    }

    /// Counts more ramps, and the steps of another root.
    pub(super) fn add(&self, solves: u32, steps: u32) {
        self.solves.set(self.solves.get().saturating_add(solves));
        self.steps.set(self.steps.get().max(steps));
    }

    /// Counts that of a part of the search.
    pub(super) fn include(&self, part: &Self) {
        self.add(part.solves(), part.steps());
    }

    /// The same as [`zero`], with its steps counted.
    pub(super) fn zero(&self, low: Point, high: Point, function: impl FnMut(f64) -> Point) -> Point {
        let (point, steps) = zero(low, high, function);
        self.add(0, steps);
        point
    }
}

/// The last ramp of a move, from some state.
struct Stop {
    start: Setpoint,
    ramp: Ramp,
    /// The distance by which it ends beyond the target.
    beyond: f64,
    /// The part of that which may be rounding.
    noise: f64,
}

impl Stop {
    /// No stop yet. It is large, so it is built in its final place.
    const fn nothing() -> Self {
        Self {
            start: Setpoint::at_rest(0.0),
            ramp: Ramp::nothing(),
            beyond: 0.0,
            noise: 0.0,
        }
    }

    /// The distance by which it ends beyond the target in the direction `side`, for the argument `at` of a root.
    fn ahead(&self, at: f64, side: f64) -> Point {
        Point {
            at,
            value: side * self.beyond,
            noise: self.noise,
            slope: f64::NAN,
        }
    }

    /// Moves its begin to `state`, which it reaches after `time` of its first span.
    fn follow(&mut self, time: f64, state: &Setpoint) {
        if time > 0.0 {
            self.ramp.spans.advance(time);
            self.start = *state;
        }
    }

    /// The same as [`Stop::ahead`], if its start moves along a push with `input`: with the slope, except on the
    /// target, where no root needs it.
    fn ahead_of(&self, at: f64, side: f64, input: f64) -> Point {
        let ahead = self.ahead(at, side);
        if self.beyond.abs() <= self.noise {
            return ahead;
        }
        Point {
            slope: side * self.ramp.speed_of_end(input),
            ..ahead
        }
    }
}

impl<'a> Search<'a> {
    /// A search for moves of `target`, which go for the velocity `top` and end with `end_velocity`;
    /// positions are off by `resolution`.
    pub(super) const fn new(
        ramps: &'a Ramps,
        target: f64,
        end_velocity: f64,
        top: Sides,
        resolution: f64,
    ) -> Self {
        Self {
            ramps,
            target,
            end_velocity,
            top,
            resolution,
            work: Work::nothing(),
        }
    }

    /// The signed velocity that a push towards `side` goes for.
    fn top(&self, side: f64) -> f64 {
        side * self.top.towards(side)
    }

    /// The whole move, if the kernel can solve it (O3).
    pub(super) fn profile(&self, start: &Setpoint) -> Option<Spans<THIRD_SPANS>> {
        if self.end_velocity != 0.0 {
            return None;
        }
        let profile = self.ramps.position_profile(start, self.target, self.top)?;
        self.work.add(1, profile.steps);
        Some(profile.spans)
    }

    /// Push towards a velocity bound, then the fastest stop, which begins such that it ends on the target (O2).
    ///
    /// The spans are put into `spans`, which is empty.
    pub(super) fn push_then_stop(&self, spans: &mut Candidate, start: &Setpoint) {
        if let Some(profile) = self.profile(start) {
            spans.extend(&profile);
            return;
        }
        let mut stop = Stop::nothing();
        self.lay_to(&mut stop, start, self.end_velocity);
        if stop.beyond.abs() <= stop.noise.max(self.resolution) {
            spans.extend(&stop.ramp.spans);
            return;
        }
        let side = if stop.beyond < 0.0 { 1.0 } else { -1.0 };
        let top = self.top(side);
        let mut push = Ramp::nothing();
        self.lay(&mut push, start, top);
        let mut way = Way::new(self.ramps.order(), start, self.ramps.lower());
        if push.lead == 0 && self.cruises(spans, start, &push.spans, top) {
            return;
        }
        let parts = if self.end_velocity == 0.0 { 1 } else { PARTS };
        let leads_on = parts > 1 && self.leads_on(start, &push, side);
        for whole in push.spans.iter() {
            let short = if leads_on {
                self.short_behind(&mut stop, &way, whole, side)
            } else {
                None
            };
            if let Some(end) = short {
                let all = whole.split(parts);
                all.for_each(|part| spans.push(part.duration, part.input));
                way = end;
                continue;
            }
            for span in whole.split(parts) {
                way.begin(span.input);
                let after = |time: f64| {
                    let mut way = way;
                    way.go(time);
                    way.state
                };
                // As long as the push is equal to the stop, the stop ends at the same place.
                let along = min(stop.ramp.goes_along(span.input), span.duration);
                stop.follow(along, &after(along));
                if along < span.duration {
                    let from = stop.ahead_of(along, side, span.input);
                    let mut ahead = |time: f64| {
                        self.stop_from(&mut stop, &after(time));
                        stop.ahead_of(time, side, span.input)
                    };
                    let to = ahead(span.duration);
                    if to.value >= 0.0 {
                        let switch = self.work.zero(from, to, &mut ahead);
                        ahead(switch.at);
                        spans.push(switch.at, span.input);
                        spans.extend(&stop.ramp.spans);
                        return;
                    }
                }
                spans.push(span.duration, span.input);
                way.go(span.duration);
            }
        }
        self.stop_from(&mut stop, &steady(&way.state, top));
        cruise(spans, -stop.ahead(0.0, side).value, top);
        spans.extend(&stop.ramp.spans);
    }

    /// Whether the whole `push` to the velocity `top` and the stop behind it leave a move that ends at rest short
    /// of its target by more than rounding. Then no end of a span needs a check, and all three are appended to
    /// `spans`.
    fn cruises(&self, spans: &mut Candidate, start: &Setpoint, push: &Spans<RAMP_SPANS>, top: f64) -> bool {
        let end = follow(self.ramps, start, push);
        let side = top.signum();
        let least = top * top / (2.0 * self.ramps.deceleration());
        if self.end_velocity != 0.0 || side * (self.target - end.position) < least {
            return false;
        }
        let mut stop = Stop::nothing();
        self.lay_to(&mut stop, &steady(&end, top), self.end_velocity);
        let left = -side * stop.beyond;
        let duration = push.duration() + stop.ramp.spans.duration();
        let cruises = left > ON_LIMIT * (top.abs() * duration);
        if cruises {
            spans.extend(push);
            spans.push(left / top.abs(), 0.0);
            spans.extend(&stop.ramp.spans);
        }
        cruises
    }

    /// Whether a longer `push` towards `side` always leads farther, so that it reaches the target once. The push
    /// must keep its direction from the start, inside the limits, and go for at least the velocity at the end.
    fn leads_on(&self, start: &Setpoint, push: &Ramp, side: f64) -> bool {
        let end = side * self.end_velocity;
        push.viable && side * start.velocity >= 0.0 && end >= 0.0 && end <= side * self.top(side)
    }

    /// The state behind a `span` of a push towards `side`, if a stop from there ends short of the target: then a
    /// stop from each of its parts does, too. Otherwise `stop` becomes the one from the begin of the span.
    fn short_behind(&self, stop: &mut Stop, way: &Way, span: &Span, side: f64) -> Option<Way> {
        let mut end = *way;
        // Part by part, so that the bits are the same as with a check of each part.
        for part in span.split(PARTS) {
            end.begin(part.input);
            end.go(part.duration);
        }
        self.stop_from(stop, &end.state);
        if stop.ahead(0.0, side).value < 0.0 {
            return Some(end);
        }
        self.stop_from(stop, &way.state);
        None
    }

    /// A ramp to a peak velocity and one from it, with a cruise between them if it is the bound (O6).
    pub(super) fn two_phase(&self, start: &Setpoint) -> Candidate {
        let mut spans = Spans::new();
        let stop = self.stop(start);
        let side = if stop.beyond < 0.0 { 1.0 } else { -1.0 };
        let top = self.top(side);
        let through = |peak: f64| {
            let ramp = self.ramp(start, peak);
            let state = steady(&follow(self.ramps, start, &ramp), peak);
            (ramp, self.stop(&state))
        };
        let at = |peak: f64| {
            let (_, stop) = through(peak);
            stop.ahead(peak, side)
        };
        let highest = at(top);
        let lowest = stop.ahead(self.end_velocity, side);
        let peak = if highest.value > 0.0 {
            self.work.zero(lowest, highest, at)
        } else {
            highest
        };
        let (ramp, stop) = through(peak.at);
        spans.extend(&ramp);
        if peak.at == top {
            cruise(&mut spans, -peak.value, top);
        }
        spans.extend(&stop.ramp.spans);
        spans
    }

    /// Acceleration and jerk to zero as soon as possible, then push and stop (O7).
    pub(super) fn arrest_then_push(&self, start: &Setpoint) -> Candidate {
        let (low, high) = (-self.ramps.velocity(-1.0), self.ramps.velocity(1.0));
        let velocity = self.ramps.arrested(start).max(low).min(high);
        let ramp = self.ramp(start, velocity);
        let state = steady(&follow(self.ramps, start, &ramp), velocity);
        let mut spans = Spans::new();
        spans.extend(&ramp);
        let mut push = Spans::new();
        self.push_then_stop(&mut push, &state);
        spans.extend(&push);
        spans
    }

    /// The ramp to the end velocity, which is not 0, and a cruise with it (O15). `None` if that ramp ends beyond
    /// the target, or if the end velocity is larger than that of a cruise and of the start.
    ///
    /// The cruise leaves nothing for a root to find, even for a very short move.
    pub(super) fn ramp_then_cruise(&self, start: &Setpoint) -> Option<Candidate> {
        let stop = self.stop(start);
        let side = self.end_velocity.signum();
        let left = -side * stop.beyond;
        let coming = side * start.velocity;
        let most = self
            .top(side)
            .abs()
            .max(coming)
            .max(side * self.ramps.arrested(start));
        if left < 0.0 || self.end_velocity.abs() > most {
            return None;
        }
        let mut spans = Spans::new();
        spans.extend(&stop.ramp.spans);
        cruise(&mut spans, left, self.end_velocity);
        Some(spans)
    }

    /// To rest, and to the end velocity, which is not 0, with a velocity in between that is held as long as needed
    /// (O15).
    ///
    /// That velocity is the first of repeatedly halved ones with which the move does not go too far: forwards, or,
    /// if the ramp from rest would end beyond the target, backwards. So there is nothing for a root to find.
    pub(super) fn rest_then_run_up(&self, start: &Setpoint) -> Candidate {
        let brake = self.ramp(start, 0.0);
        let rest = steady(&follow(self.ramps, start, &brake), 0.0);
        let even = self.ramps.even();
        let search = Search::new(&even, self.target, self.end_velocity, self.top, self.resolution);
        let mut spans = Spans::new();
        spans.extend(&brake);
        spans.extend(&search.run_up(&rest));
        self.work.include(&search.work);
        spans
    }

    /// From `rest` to the end velocity.
    fn run_up(&self, rest: &Setpoint) -> Candidate {
        let mut spans = Spans::new();
        let direct = self.stop(rest);
        let ahead = direct.ahead(0.0, self.end_velocity.signum());
        let (way, least) = if ahead.value > ahead.noise {
            (-self.end_velocity.signum(), 0.0)
        } else {
            (self.end_velocity.signum(), self.end_velocity.abs())
        };
        let mut held = self.top(way).abs();
        for _ in 0..HALVINGS {
            let first = self.ramp(rest, way * held);
            let state = steady(&follow(self.ramps, rest, &first), way * held);
            let last = self.stop(&state);
            let left = -way * last.beyond;
            if left >= 0.0 {
                spans.extend(&first);
                spans.push(left / held, 0.0);
                spans.extend(&last.ramp.spans);
                return spans;
            }
            held = (0.5 * held).max(least);
        }
        // The rest is rounding.
        spans.extend(&direct.ramp.spans);
        spans
    }

    /// The ramp from `start` to `velocity`, as a part of a move.
    pub(super) fn ramp(&self, start: &Setpoint, velocity: f64) -> Spans<RAMP_SPANS> {
        self.whole_ramp(start, velocity).spans
    }

    /// The same as [`Search::ramp`], with all data of the ramp.
    pub(super) fn whole_ramp(&self, start: &Setpoint, velocity: f64) -> Ramp {
        let mut ramp = Ramp::nothing();
        self.lay(&mut ramp, start, velocity);
        ramp
    }

    fn lay(&self, ramp: &mut Ramp, start: &Setpoint, velocity: f64) {
        self.work.add(1, 0);
        self.ramps.lay_freely(ramp, start, velocity);
    }

    /// The speed between `near` and `far` at which the ramp alone ends on the target (O11). From `near` it ends
    /// short of the target, from `far` beyond it. `None` if they do not bracket the target. Speeds are those
    /// towards `side`.
    pub(super) fn speed_on_target(&self, start: &Setpoint, side: f64, near: f64, far: f64) -> Option<f64> {
        let at = |speed: f64| self.ramp_to(start, side * speed).ahead(speed, side);
        let (low, high) = (at(near), at(far));
        (low.value <= 0.0 && high.value > 0.0).then(|| self.work.zero(low, high, at).at)
    }

    /// Whether the ramp alone to `speed` towards the side `side` ends on the target or short of it.
    pub(super) fn ends_short(&self, start: &Setpoint, side: f64, speed: f64) -> bool {
        let end = self.ramp_to(start, side * speed);
        side * end.beyond <= end.noise.max(self.resolution)
    }

    /// The ramp from `start` to the end velocity.
    fn stop(&self, start: &Setpoint) -> Stop {
        self.ramp_to(start, self.end_velocity)
    }

    /// The same, written to `stop`, unless it already begins there.
    fn stop_from(&self, stop: &mut Stop, start: &Setpoint) {
        if stop.start != *start {
            self.lay_to(stop, start, self.end_velocity);
        }
    }

    fn ramp_to(&self, start: &Setpoint, velocity: f64) -> Stop {
        let mut stop = Stop::nothing();
        self.lay_to(&mut stop, start, velocity);
        stop
    }

    fn lay_to(&self, stop: &mut Stop, start: &Setpoint, velocity: f64) {
        self.lay(&mut stop.ramp, start, velocity);
        let spans = &stop.ramp.spans;
        let end = follow(self.ramps, start, spans);
        let added_up = start.position.abs() + self.target.abs() + spans.duration() * start.velocity.abs();
        stop.start = *start;
        stop.beyond = end.position - self.target;
        stop.noise = 0.25 * NOISE * added_up;
    }
}

/// Appends the distance `left` at the velocity `top`.
fn cruise(spans: &mut Candidate, left: f64, top: f64) {
    spans.push(left.max(0.0) / top.abs(), 0.0);
}

/// `state` with a velocity that is kept constant.
pub(super) fn steady(state: &Setpoint, velocity: f64) -> Setpoint {
    Setpoint {
        velocity,
        ..Setpoint::at_rest(state.position)
    }
}

/// The end of `spans` from `start`.
pub(super) fn follow<const N: usize>(ramps: &Ramps, start: &Setpoint, spans: &Spans<N>) -> Setpoint {
    let mut way = Way::new(ramps.order(), start, ramps.lower());
    way.follow(spans);
    way.state
}

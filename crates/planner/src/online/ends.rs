//! Moves that end with an acceleration.
//!
//! This module makes the candidates; [`ladder`](super::ladder) verifies them. A motion reversed in time is a
//! motion, too. Seen from its end, and mirrored, a move begins in the end state with its acceleration reversed, and
//! acceleration and deceleration change places. So the ramps that begin in any state serve for both ends. Equations
//! (O16) to (O20) and (O22) to (O26) are in `docs/planner-online.md`. Everything is in the kernel's units, with
//! positions counted from the start.

use super::ladder::excess_along;
use super::search::{CANDIDATE_SPANS, Candidate, PARTS, Search, Work, follow, steady};
use crate::kernel::{NOISE, ON_LIMIT, Point, Sides, Spans};
use crate::math::ceil;
use crate::ramp::path::Way;
use crate::ramp::solve::{RAMP_SPANS, Ramps};
use crate::{DirectedLimits, Limits, Order, Setpoint};

/// Largest number of spans of a candidate: a push, a cruise, and a last ramp that is a move of one order less.
pub(super) const END_SPANS: usize = RAMP_SPANS + 1 + CANDIDATE_SPANS;

/// Largest number of changes of sign that are examined for one push. The end of the last ramp may jump at a sign
/// change without a zero.
const CROSSINGS: u32 = 4;

/// Distance of the nearest end acceleration from the border of what is kept, relative to it. On the border itself a
/// limit would be kept only to rounding.
const NEAREST: f64 = 1e-7;

/// Accuracy of the fastest path to a turn, in scans.
const ROUGHLY: f64 = 1e-3;

/// Largest number of scans by which a turn in one go may be sooner than one with a constant velocity in between.
const SOONER: u32 = 16;

/// Largest number of halvings of a velocity on the last rung, and of a refused end acceleration.
const HALVINGS: u32 = 64;

/// The spans of a whole move.
pub(super) type Wide = Spans<END_SPANS>;

/// The search for a move.
pub(super) struct Ends<'a> {
    ramps: &'a Ramps,
    /// The ramps of the time-reversed motion.
    back: Ramps,
    target: f64,
    velocity: f64,
    acceleration: f64,
    /// The velocity bound of a push in each direction.
    top: Sides,
    /// The largest error of the positions of start and target.
    resolution: f64,
    pub(super) work: Work,
}

/// The last ramp of a move, from some state.
struct Last {
    spans: Candidate,
    /// The distance by which it ends beyond the target.
    beyond: f64,
    /// The part of that which may be rounding.
    noise: f64,
}

/// A ramp from the start and one from the end to the same velocity.
struct Halves {
    first: Spans<RAMP_SPANS>,
    /// Time-reversed.
    last: Spans<RAMP_SPANS>,
    /// The distance of both together.
    way: f64,
}

/// Whether a motion inside `limits` can reach the velocity and acceleration of `end`, without jerk, and continue
/// from there.
pub(super) fn is_kept(end: &Setpoint, limits: &DirectedLimits) -> bool {
    let before = Setpoint {
        acceleration: -end.acceleration,
        ..*end
    };
    let Limits {
        acceleration,
        deceleration,
        ..
    } = limits.limits;
    let back = DirectedLimits {
        limits: Limits {
            acceleration: deceleration,
            deceleration: acceleration,
            ..limits.limits
        },
        ..*limits
    };
    goes_on(end, limits) && goes_on(&before, &back)
}

/// Whether some ramp from a state keeps `limits`: the arrest, a stop, or one to a bound.
fn goes_on(state: &Setpoint, limits: &DirectedLimits) -> bool {
    let ramps = Ramps::new(limits, limits);
    let start = ramps.state_inward(state);
    let (low, high) = (-ramps.velocity(-1.0), ramps.velocity(1.0));
    let arrested = ramps.arrested(&start).max(low).min(high);
    [arrested, 0.0, low, high].into_iter().any(|goal| {
        let ramp = ramps.freely(&start, goal);
        excess_along(ramps.order(), state, ramps.scale().outward(&ramp), limits).is_none()
    })
}

/// The end acceleration nearest to that of `end` with which [`is_kept`] holds: its bound, or the result of halving.
pub(super) fn nearest_kept(end: &Setpoint, limits: &DirectedLimits) -> f64 {
    let with = |acceleration: f64| Setpoint { acceleration, ..*end };
    let Limits {
        acceleration,
        deceleration,
        ..
    } = limits.limits;
    let bound = if end.velocity == 0.0 {
        limits.limits.lower_acceleration()
    } else if end.velocity * end.acceleration > 0.0 {
        acceleration
    } else {
        deceleration
    };
    let most = end.acceleration.max(-bound).min(bound);
    if is_kept(&with(most), limits) {
        return most;
    }
    // A little inside, so that no rounding moves it out again.
    let inside = DirectedLimits {
        positive: limits.positive * (1.0 - ON_LIMIT),
        negative: limits.negative * (1.0 - ON_LIMIT),
        ..*limits
    };
    let (mut low, mut high) = (0.0, most);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        if is_kept(&with(middle), &inside) {
            low = middle;
        } else {
            high = middle;
        }
    }
    low * (1.0 - NEAREST)
}

impl<'a> Ends<'a> {
    /// A search for moves of `target` that end with `velocity` and `acceleration`.
    pub(super) const fn new(
        ramps: &'a Ramps,
        target: f64,
        (velocity, acceleration): (f64, f64),
        top: Sides,
        resolution: f64,
    ) -> Self {
        Self {
            ramps,
            back: ramps.backwards(),
            target,
            velocity,
            acceleration,
            top,
            resolution,
            work: Work::nothing(),
        }
    }

    /// The end state as the start of the time-reversed motion (O16).
    fn end(&self) -> Setpoint {
        Setpoint {
            velocity: self.velocity,
            acceleration: -self.acceleration,
            ..Setpoint::default()
        }
    }

    /// The spans of a time-reversed motion, in forward order.
    fn turned<const N: usize>(&self, spans: &Spans<N>) -> Spans<N> {
        let is_odd = self.ramps.order() == Order::Three;
        spans.backwards(if is_odd { 1.0 } else { -1.0 })
    }

    fn ramp(&self, ramps: &Ramps, start: &Setpoint, velocity: f64) -> Spans<RAMP_SPANS> {
        self.work.add(1, 0);
        ramps.freely(start, velocity)
    }

    /// The ramp from `start` to `velocity`, the time-reversed one from the end to it, and how far both lead together.
    fn halves(&self, ramps: &Ramps, start: &Setpoint, velocity: f64) -> Halves {
        let (first, last) = (
            self.ramp(ramps, start, velocity),
            self.ramp(&self.back, &self.end(), velocity),
        );
        let way = follow(ramps, start, &first).position + follow(&self.back, &self.end(), &last).position;
        Halves { first, last, way }
    }

    /// The whole move from a `start` of constant velocity. Seen from its end, it is a move that ends with that
    /// velocity (O17).
    pub(super) fn of_steady_start(&self, start: &Setpoint) -> Candidate {
        let search = Search::new(
            &self.back,
            self.target - start.position,
            start.velocity,
            self.top,
            self.resolution,
        );
        let mut spans = Candidate::new();
        search.push_then_stop(&mut spans, &self.end());
        self.work.include(&search.work);
        self.turned(&spans)
    }

    /// The last ramp: a move of one order less, from the velocity to its end value, which ends with the end
    /// acceleration (O18).
    fn last(&self, start: &Setpoint) -> Last {
        let range = self
            .ramps
            .accelerations(start.velocity, self.velocity, self.acceleration);
        let ramps = self.ramps.of_velocity(range);
        let resolution = NOISE * (start.velocity.abs() + self.velocity.abs());
        let search = Search::new(&ramps, self.velocity, self.acceleration, range, resolution);
        let mut spans = Candidate::new();
        search.push_then_stop(
            &mut spans,
            &Setpoint {
                position: start.velocity,
                velocity: start.acceleration,
                acceleration: start.jerk,
                ..Setpoint::default()
            },
        );
        self.work.include(&search.work);
        let end = follow(self.ramps, start, &spans);
        let added_up = start.position.abs() + self.target.abs() + spans.duration() * start.velocity.abs();
        Last {
            beyond: end.position - self.target,
            noise: NOISE * added_up,
            spans,
        }
    }

    /// Calls `see` with the moves that push towards the bound of one `side`, then follow the last ramp to the
    /// target (O19).
    pub(super) fn pushes(&self, start: &Setpoint, side: f64, mut see: impl FnMut(&Wide)) {
        let top = side * self.top.towards(side);
        let mut spans = Wide::new();
        let ahead = |state: &Setpoint, at: f64| {
            let last = self.last(state);
            Point {
                at,
                value: side * last.beyond,
                noise: last.noise,
                slope: f64::NAN,
            }
        };
        let mut from = ahead(start, 0.0);
        if from.value.abs() <= from.noise.max(self.resolution) {
            spans.extend(&self.last(start).spans);
            see(&spans);
            return;
        }
        let push = self.ramp(self.ramps, start, top);
        let mut way = Way::new(self.ramps.order(), start, self.ramps.lower());
        let mut crossings = 0;
        for span in push.split(PARTS) {
            way.begin(span.input);
            let after = |time: f64| {
                let mut way = way;
                way.go(time);
                way.state
            };
            let to = ahead(&after(span.duration), span.duration);
            if (from.value < 0.0) != (to.value < 0.0) && crossings < CROSSINGS {
                crossings += 1;
                let switch = self
                    .work
                    .zero(Point { at: 0.0, ..from }, to, |time| ahead(&after(time), time));
                let mut whole = spans;
                whole.push(switch.at, span.input);
                whole.extend(&self.last(&after(switch.at)).spans);
                see(&whole);
            }
            spans.push(span.duration, span.input);
            way.go(span.duration);
            from = to;
        }
        let state = steady(&way.state, top);
        let last = self.last(&state);
        let left = -side * last.beyond;
        if left >= 0.0 {
            spans.push(left / top.abs(), 0.0);
            spans.extend(&last.spans);
            see(&spans);
        }
    }

    /// A ramp from `start` to a velocity, a cruise if that is a bound, and from there the time-reversed motion from
    /// the end, in forward order (O20).
    ///
    /// The distance of both ramps together changes with the velocity without a jump, so there is always a solution.
    pub(super) fn two_phase(&self, start: &Setpoint) -> Wide {
        let beyond = |velocity: f64| {
            let Halves { first, last, way } = self.halves(self.ramps, start, velocity);
            let duration = first.duration() + last.duration();
            let added_up = self.target.abs() + duration * velocity.abs();
            Point {
                at: velocity,
                value: way - self.target,
                noise: 0.25 * NOISE * added_up,
                slope: f64::NAN,
            }
        };
        let (low, high) = (beyond(-self.top.minus), beyond(self.top.plus));
        let peak = if high.value <= 0.0 {
            high
        } else if low.value >= 0.0 {
            low
        } else {
            self.work.zero(low, high, beyond)
        };
        let is_bound = peak.at == high.at || peak.at == low.at;
        let Halves { first, last, .. } = self.halves(self.ramps, start, peak.at);
        let mut spans = Wide::new();
        spans.extend(&first);
        if is_bound {
            spans.push(peak.value.abs() / peak.at.abs(), 0.0);
        }
        spans.extend(&self.turned(&last));
        spans
    }

    /// To the end without reversal: a ramp to a velocity towards `side`, a cruise, and the time-reversed motion
    /// from the end, in forward order (O22). If `scan` is given, the move takes whole scans of that length. `None`
    /// if even the slowest remaining path to the end is too long. Also returns the part of the end acceleration
    /// with which it ends.
    ///
    /// The least whole number of scans follows from the fastest such move. The velocity follows from that number;
    /// if it can't be lowered, the end acceleration follows (O23). At order 4 from rest the fastest point has jerk,
    /// too (O24).
    pub(super) fn braking(&self, start: &Setpoint, side: f64, scan: Option<f64>) -> Option<(Wide, f64)> {
        if let Some(scan) = scan
            && self.ramps.order() == Order::Four
            && start.is_at_rest()
        {
            return Some(self.stretched(start, scan));
        }
        // The distance by which it ends beyond the target, with a cruise that makes it `whole`, or without one.
        let beyond = |speed: f64, whole: Option<f64>| {
            let Halves { first, last, way } = self.halves(self.ramps, start, side * speed);
            let moving = first.duration() + last.duration();
            let cruise = whole.map_or(0.0, |whole| speed * (whole - moving));
            let exactly = 0.25 * NOISE * (self.target.abs() + whole.unwrap_or(moving) * speed);
            Point {
                at: speed,
                value: side * (way - self.target) + cruise,
                noise: match scan {
                    // For the fastest move only the whole scans are needed.
                    Some(scan) if whole.is_none() => ROUGHLY * scan * speed,
                    _ => exactly,
                },
                slope: f64::NAN,
            }
        };
        let slowest = self.ramps.arrested(&self.end()).abs();
        // A faster start slows down sooner in one go.
        let coming = side * self.ramps.arrested(start);
        let low = beyond(slowest, None);
        let comes_faster = coming > slowest && coming <= self.top.plus;
        let low = if low.value > 0.0 && comes_faster {
            beyond(coming, None)
        } else {
            low
        };
        let top = beyond(self.top.plus, None);
        if low.value > 0.0 {
            return None;
        }
        let fastest = if top.value <= 0.0 {
            top
        } else {
            self.work.zero(low, top, |speed| beyond(speed, None))
        };
        let laid = |speed: f64, whole: Option<f64>| {
            let Halves { first, last, .. } = self.halves(self.ramps, start, side * speed);
            let moving = first.duration() + last.duration();
            let left = (-fastest.value).max(0.0);
            let cruise = whole.map_or(left / speed, |whole| whole - moving);
            let mut spans = Wide::new();
            spans.extend(&first);
            spans.push(cruise, 0.0);
            spans.extend(&self.turned(&last));
            (cruise >= 0.0).then_some((spans, 1.0))
        };
        let fast = laid(fastest.at, None);
        let Some(scan) = scan else { return fast };
        let whole = ceil(fast?.0.duration() / scan * (1.0 - ON_LIMIT)) * scan;
        let (low, high) = (beyond(low.at, Some(whole)), beyond(fastest.at, Some(whole)));
        let slower = if low.value > 0.0 {
            None
        } else if high.value <= 0.0 {
            laid(high.at, Some(whole))
        } else {
            let speed = self.work.zero(low, high, |speed| beyond(speed, Some(whole)));
            laid(speed.at, Some(whole))
        };
        let held = if comes_faster { coming } else { fastest.at };
        let found = slower.or_else(|| self.braking_softly(start, side * held, whole))?;
        Some(self.in_one_go(start, side, scan, found))
    }

    /// To the end from a constant velocity by one ramp, and the speed with which it ends: the ramp then has the
    /// length of the path (O26). `None` if a ramp to the end velocity is too short, or the slowest ramp too long.
    pub(super) fn speeding(&self, start: &Setpoint, side: f64) -> Option<(Wide, f64)> {
        let ramp = |speed: f64| {
            let end = Setpoint {
                velocity: side * speed,
                ..self.end()
            };
            (end, self.ramp(&self.back, &end, start.velocity))
        };
        let beyond = |speed: f64| {
            let (end, last) = ramp(speed);
            Point {
                at: speed,
                value: side * (follow(&self.back, &end, &last).position - self.target),
                noise: 0.25 * NOISE * (self.target.abs() + last.duration() * speed),
                slope: f64::NAN,
            }
        };
        let gained = self.ramps.arrested(&Setpoint {
            acceleration: self.acceleration.abs(),
            ..Setpoint::default()
        });
        let (low, high) = (
            beyond(side * start.velocity + gained),
            beyond(side * self.velocity),
        );
        if low.at >= high.at || low.value > 0.0 || high.value < 0.0 {
            return None;
        }
        let speed = self.work.zero(low, high, beyond).at;
        let mut spans = Wide::new();
        spans.extend(&self.turned(&ramp(speed).1));
        Some((spans, speed))
    }

    /// The turn `found` with a constant velocity in between, or a sooner one at order 3 that brakes all the way
    /// from a constant velocity (O25): jerk against the motion, with it, against it, and then the end acceleration
    /// held.
    ///
    /// A smaller end acceleration delays the turn by the time in which its jerk makes up for it.
    fn in_one_go(&self, start: &Setpoint, side: f64, scan: f64, found: (Wide, f64)) -> (Wide, f64) {
        let speed = side * start.velocity;
        if self.ramps.order() != Order::Three || start.acceleration != 0.0 || speed <= 0.0 {
            return found;
        }
        let rise = self.acceleration.abs() / self.ramps.jerk();
        let lateness = |(spans, part): &(Wide, f64)| spans.duration() - part * rise;
        let whole = found.0.duration();
        (1..=SOONER)
            .map(|fewer| whole - f64::from(fewer) * scan)
            .take_while(|time| *time > rise)
            .filter_map(|time| self.braking_all_the_way(speed, side, time))
            .fold(found, |best, other| {
                if lateness(&other) < lateness(&best) {
                    other
                } else {
                    best
                }
            })
    }

    /// The move of [`Ends::in_one_go`] from `speed` that takes this `time`, and the part of the end acceleration
    /// with which it ends.
    fn braking_all_the_way(&self, speed: f64, side: f64, time: f64) -> Option<(Wide, f64)> {
        let jerk = self.ramps.jerk();
        let rise = self.acceleration.abs() / jerk;
        let way = side * self.target;
        // `last` is the time in which the end acceleration is built up and held. Returned are the time for which it
        // is held, the time of the jerk with the motion, and that time multiplied by its distance from the end,
        // which follows from the velocity.
        let phases = |last: f64| {
            let held = (last - rise).max(0.0);
            let along = 0.5 * (time - last);
            let moment = 0.25 * (time * time - held * held) - 0.5 * speed / jerk;
            (held, along, moment)
        };
        let beyond = |last: f64| {
            let (held, along, moment) = phases(last);
            let square = along * along;
            let against = speed * time - jerk / 6.0 * (time * time * time - held * held * held) - way;
            Point {
                at: last,
                value: along * against + jerk * (moment * moment + square * square / 12.0),
                noise: 0.25 * NOISE * along * (way + speed * time),
                slope: f64::NAN,
            }
        };
        let (low, high) = (beyond(0.0), beyond(time));
        if low.value >= 0.0 || high.value <= 0.0 {
            return None;
        }
        let last = self.work.zero(low, high, beyond).at;
        let (held, along, moment) = phases(last);
        let middle = moment / along;
        let (first, third) = (time - middle - 0.5 * along, middle - 0.5 * along - held);
        // A start faster than the move permits must slow down at least as a ramp to the permitted velocity does, at
        // any time.
        let too_fast = (speed - self.top.plus).max(0.0);
        let brakes = first >= along && third >= 0.0 && jerk * first * first >= too_fast;
        let mut spans = Wide::new();
        for (duration, input) in [(first, -jerk), (along, jerk), (third, -jerk), (held, 0.0)] {
            spans.push(duration, side * input);
        }
        brakes.then_some((spans, last.min(rise) / rise))
    }

    /// To the end in the time `whole` at `velocity`, and the part of the end acceleration with which the move takes
    /// exactly that time.
    fn braking_softly(&self, start: &Setpoint, velocity: f64, whole: f64) -> Option<(Wide, f64)> {
        let first = self.ramp(self.ramps, start, velocity);
        let begin = follow(self.ramps, start, &first).position;
        let less = |lack: f64| {
            let end = self.end();
            let end = Setpoint {
                acceleration: end.acceleration * (1.0 - lack),
                ..end
            };
            let last = self.ramp(&self.back, &end, velocity);
            let left = self.target - begin - follow(&self.back, &end, &last).position;
            (last, left / velocity)
        };
        let late = |lack: f64| {
            let (last, cruise) = less(lack);
            Point {
                at: lack,
                value: first.duration() + last.duration() + cruise - whole,
                noise: 0.25 * NOISE * (self.target.abs() / velocity.abs() + whole),
                slope: f64::NAN,
            }
        };
        let (most, least) = (late(0.0), late(1.0));
        if most.value > 0.0 || least.value < 0.0 {
            return None;
        }
        let lack = self.work.zero(most, least, late).at;
        let (last, cruise) = less(lack);
        let mut spans = Wide::new();
        spans.extend(&first);
        spans.push(cruise, 0.0);
        spans.extend(&self.turned(&last));
        (cruise >= 0.0 && lack < 1.0).then_some((spans, 1.0 - lack))
    }

    /// From rest to the end in whole scans of the length `scan`, at order 4: the whole move of
    /// [`Ends::of_steady_start`], stretched in time, which lowers every derivative (O24). Also returns the part of
    /// the end acceleration with which it ends.
    fn stretched(&self, start: &Setpoint, scan: f64) -> (Wide, f64) {
        let spans = self.of_steady_start(start);
        let scans = spans.duration() / scan;
        let longer = ceil(scans * (1.0 - ON_LIMIT)) / scans;
        let square = longer * longer;
        let mut stretched = Wide::new();
        for span in spans.iter() {
            stretched.push(span.duration * longer, span.input / (square * square));
        }
        (stretched, 1.0 / square)
    }

    /// Acceleration and jerk to zero as soon as possible, then the move from a constant velocity.
    pub(super) fn arrest(&self, start: &Setpoint) -> Wide {
        let (low, high) = (-self.ramps.velocity(-1.0), self.ramps.velocity(1.0));
        let velocity = self.ramps.arrested(start).max(low).min(high);
        let ramp = self.ramp(self.ramps, start, velocity);
        let state = steady(&follow(self.ramps, start, &ramp), velocity);
        let mut spans = Wide::new();
        spans.extend(&ramp);
        spans.extend(&self.of_steady_start(&state));
        spans
    }

    /// To rest, and to the end with a velocity that is held as long as needed. It is found without a root, like
    /// (O15).
    pub(super) fn rest_then_run_up(&self, start: &Setpoint) -> Wide {
        let end = self.end();
        let brake = self.ramp(self.ramps, start, 0.0);
        let rest = steady(&follow(self.ramps, start, &brake), 0.0);
        let direct = self.ramp(&self.back, &end, 0.0);
        let ahead = self.target - rest.position - follow(&self.back, &end, &direct).position;
        let side = if ahead < 0.0 { -1.0 } else { 1.0 };
        let even = self.ramps.even();
        let mut held = self.top.towards(side);
        let mut spans = Wide::new();
        spans.extend(&brake);
        for _ in 0..HALVINGS {
            let Halves { first, last, way } = self.halves(&even, &rest, side * held);
            let left = side * (self.target - way);
            if left >= 0.0 {
                spans.extend(&first);
                spans.push(left / held, 0.0);
                spans.extend(&self.turned(&last));
                return spans;
            }
            held *= 0.5;
        }
        // The rest is rounding.
        spans.extend(&self.turned(&direct));
        spans
    }
}

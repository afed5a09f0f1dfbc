//! The share of the limits that a step between two set-points needs, at least, for any motion between them.

use super::super::commands::ROUNDING;
use super::follow::Beyond;
use standstill_planner::{Limits, Setpoint};

/// The order of the results of [`Step::needs`].
pub(super) const DERIVATIVES: [&str; 4] = ["velocity", "acceleration", "jerk", "snap"];

/// A third derivative of at most J moves the end by at most J cycle^3 / `BENT` from the position that the velocities
/// and accelerations at both ends of a scan give. `BENT` is 36 times the root of 3 (error of the trapezoidal rule
/// with end correction).
const BENT: f64 = 62.353_829_072_479_58;

/// The largest relative error of a position, relative to the largest position from which it was computed.
pub(super) const RESOLVED: f64 = 16.0 * f64::EPSILON;

/// Two set-points one scan apart.
pub(super) struct Step<'a> {
    pub last: &'a Setpoint,
    pub next: &'a Setpoint,
    /// The distance between them (u), if known.
    pub way: Option<f64>,
    /// The largest other position from which that distance was computed (u).
    pub coarsest: f64,
    /// Length of a scan (s).
    pub cycle: f64,
}

impl Step<'_> {
    /// The velocity, acceleration, jerk and snap that are reached between the two, at least, less the largest
    /// rounding error. They follow from the change of each derivative, less the part that the next derivatives
    /// explain.
    pub(super) fn needs(&self) -> [f64; 4] {
        let Self {
            last, next, cycle, ..
        } = *self;
        let velocities = [last.velocity, next.velocity];
        let accelerations = [last.acceleration, next.acceleration];
        let jerks = [last.jerk, next.jerk];
        let change = |[from, to]: [f64; 2]| to - from;
        let mean = |[from, to]: [f64; 2]| cycle * 0.5 * (from + to);
        let bend = |of: [f64; 2]| cycle * cycle / 12.0 * change(of);
        let resolved = |[from, to]: [f64; 2], more: f64| RESOLVED * (from.abs() + to.abs() + more);
        let [once, twice, thrice] = [1.0 / cycle, 4.0 / (cycle * cycle), BENT / (cycle * cycle * cycle)];
        // For a distance, a change of velocity and a change of acceleration: the part that one, two and three of its
        // derivatives explain.
        let place = resolved([last.position, next.position], self.coarsest);
        let way = |of: &dyn Fn(f64) -> f64, by: f64| {
            let off = self.way.map_or(0.0, of);
            (off.abs() - place).max(0.0) * by
        };
        let velocity = |off: f64, by: f64| (off.abs() - resolved(velocities, 0.0)).max(0.0) * by;
        let acceleration = |off: f64, by: f64| (off.abs() - resolved(accelerations, 0.0)).max(0.0) * by;
        [
            way(&|way| way, once),
            velocity(change(velocities), once).max(way(&|way| way - mean(velocities), twice)),
            acceleration(change(accelerations), once)
                .max(velocity(change(velocities) - mean(accelerations), twice))
                .max(way(&|way| way - mean(velocities) + bend(accelerations), thrice)),
            (change(jerks) * once)
                .abs()
                .max(acceleration(change(accelerations) - mean(jerks), twice))
                .max(velocity(
                    change(velocities) - mean(accelerations) + bend(jerks),
                    thrice,
                )),
        ]
    }
}

/// The part by which rounding may exceed a limit, relative to the limit, if it changes a moment by `1`. If a motion
/// is always at its limit, the room left grows with the square of the excess.
const FAR: f64 = 64.0;

/// A moment with a rounding error above this, relative to its largest possible value, is ignored.
const COARSE: f64 = 1e-3;

impl Step<'_> {
    /// The first derivative whose limit every motion between the two set-points exceeds: its name, the least value
    /// that a motion needs, and the limit. Each derivative is checked by itself, independent of the lower ones
    /// between the two.
    ///
    /// The derivative is a function of time between M - L and M + L, and the set-points give its first moments. The
    /// possible moments of such a function are known: see [`are_possible`]. M is 0, except for accelerations with
    /// different limits in the two directions.
    pub(super) fn beyond(&self, most: &Limits) -> Option<Beyond> {
        let (middle, rate) = self.rates(most);
        let limits = [(middle, rate), (0.0, most.jerk), (0.0, most.snap)];
        let mut all = DERIVATIVES.into_iter().enumerate().skip(1).zip(limits);
        let ((number, name), range) = all.find(|((number, _), range)| {
            let (_, limit) = range;
            limit.is_finite() && !self.is_possible(number + 1, *range)
        })?;
        // The limit for the direction in which the velocity changes.
        let (middle, limit) = range;
        let more = middle.copysign(middle * (self.next.velocity - self.last.velocity));
        Some((name, self.least(number + 1, range) + more, limit + more))
    }

    /// The middle of the possible accelerations, and their distance from it (u/s^2). While the velocity keeps its
    /// sign, the acceleration limit applies in one direction and the deceleration limit in the other. If the scan is
    /// long enough to brake to rest and start again, the larger one applies in both directions.
    fn rates(&self, most: &Limits) -> (f64, f64) {
        let (from, to) = (self.last.velocity, self.next.velocity);
        let (up, down) = (most.acceleration, most.deceleration);
        let keeps_sign = from * to >= 0.0 && from.abs() / down + to.abs() / up > self.cycle;
        if keeps_sign {
            (0.5 * (up - down) * (from + to).signum(), 0.5 * up + 0.5 * down)
        } else {
            (0.0, up.max(down))
        }
    }

    /// The least distance from the middle of the range that a motion can keep in the derivative of this order, to a
    /// part in 2^20; `range` is too low. Cost: at most 84 checks.
    fn least(&self, order: usize, range: (f64, f64)) -> f64 {
        let (middle, limit) = range;
        let (mut low, mut high) = (limit, 2.0 * limit);
        for _ in 0..64 {
            if self.is_possible(order, (middle, high)) {
                break;
            }
            (low, high) = (high, 2.0 * high);
        }
        for _ in 0..20 {
            let between = 0.5 * (low + high);
            if self.is_possible(order, (middle, between)) {
                high = between;
            } else {
                low = between;
            }
        }
        high
    }

    /// Whether a motion leads from one set-point to the next whose derivative of this order stays within `limit` of
    /// `middle`, which is 0 above order 2.
    fn is_possible(&self, order: usize, (middle, limit): (f64, f64)) -> bool {
        let Self {
            last, next, cycle, ..
        } = *self;
        let half = 0.5 * cycle * cycle;
        let resolved = |from: f64, to: f64| RESOLVED * (from.abs() + to.abs());
        // The final error of each derivative, from the third down, that those above do not explain, and
        // its rounding.
        let snapless = order < 4;
        let jerk = if snapless { 0.0 } else { last.jerk };
        let acceleration = if order < 3 { middle } else { last.acceleration };
        let place = resolved(last.position, next.position) + RESOLVED * self.coarsest;
        let off = [
            (next.jerk - jerk, resolved(last.jerk, next.jerk)),
            (
                next.acceleration - acceleration - jerk * cycle,
                resolved(last.acceleration, next.acceleration),
            ),
            (
                next.velocity - last.velocity - acceleration * cycle - jerk * half,
                resolved(last.velocity, next.velocity),
            ),
            (
                self.way.unwrap_or(0.0)
                    - last.velocity * cycle
                    - acceleration * half
                    - jerk * half * cycle / 3.0,
                if self.way.is_some() { place } else { f64::INFINITY },
            ),
        ];
        let mut known = [0.0; 4];
        let mut rounding = 0.0;
        let mut scale = limit * cycle;
        let all = off.into_iter().skip(4 - order).zip([1.0, 1.0, 2.0, 6.0]);
        for (number, ((off, resolved), factor)) in all.enumerate() {
            let noise = factor * resolved / scale;
            if !(noise <= COARSE) {
                break;
            }
            rounding += noise;
            if let Some(moment) = known.get_mut(number) {
                *moment = factor * off / scale;
            }
            if !are_possible(&known, number + 1, 1.0 + ROUNDING + FAR * rounding) {
                return false;
            }
            scale *= cycle;
        }
        true
    }
}

/// Whether there is a function f of time t in [0, 1] between `-most` and `most` with the first `count` of these
/// moments. A moment is the integral of f (1 - t)^n. The moments before the last of them must be known to be
/// possible.
///
/// For g between 0 and 1 with the moments c, the exponential of -(c0 / z + c1 / z^2 + ..) is 1 - (n0 / z + n1 / z^2 +
/// ..), where n are the moments of a measure. Such a g exists if that measure is nowhere negative. The same holds for
/// 1 - g, and for both with reversed time.
///
/// Source: N. I. Akhiezer and M. G. Krein, Some Questions in the Theory of Moments, on the L-problem of A. A. Markov.
fn are_possible(moments: &[f64; 4], count: usize, most: f64) -> bool {
    // The moments of g = (1 + f / most) / 2.
    let [c0, c1, c2, c3] = moments.map(|moment| 0.5 * moment / most);
    let known = [0.5 + c0, 0.25 + c1, 1.0 / 6.0 + c2, 0.125 + c3];
    let [c0, c1, c2, c3] = known;
    let reversed = [c0, c0 - c1, c0 - 2.0 * c1 + c2, c0 - 3.0 * c1 + 3.0 * c2 - c3];
    match count {
        0 => true,
        1 => (0.0..=1.0).contains(&c0),
        2 => measure(known)[1] >= 0.0 && measure(reversed)[1] >= 0.0,
        3 => spread([c0, c1, c2]) >= 0.0 && spread([1.0 - c0, 0.5 - c1, 1.0 / 3.0 - c2]) >= 0.0,
        _ => [known, reversed].into_iter().all(|moments| {
            let [_, n1, n2, n3] = measure(moments);
            n1 * n3 >= n2 * n2
        }),
    }
}

/// The moments n of the measure for the moments c.
fn measure([c0, c1, c2, c3]: [f64; 4]) -> [f64; 4] {
    let square = c0 * c0;
    [
        c0,
        c1 - square / 2.0,
        c2 - c0 * c1 + square * c0 / 6.0,
        c3 - c0 * c2 - c1 * c1 / 2.0 + square * c1 / 2.0 - square * square / 24.0,
    ]
}

/// The spread of the moments, compared with that of a function that is 1 in one piece.
fn spread([c0, c1, c2]: [f64; 3]) -> f64 {
    let square = c0 * c0;
    c0 * c2 - c1 * c1 - square * square / 12.0
}

/// A scan of constant snap from a state: velocity, acceleration, jerk and snap.
pub(super) struct Piece {
    velocity: f64,
    acceleration: f64,
    jerk: f64,
    snap: f64,
    /// The jerk at its end.
    last_jerk: f64,
    /// Velocity and acceleration at its end.
    last: (f64, f64),
    cycle: f64,
}

impl Piece {
    /// The piece of constant snap between two states a scan apart.
    pub(super) fn between(from: &Setpoint, to: &Setpoint, cycle: f64) -> Self {
        Self {
            velocity: from.velocity,
            acceleration: from.acceleration,
            jerk: from.jerk,
            snap: (to.jerk - from.jerk) / cycle,
            last_jerk: to.jerk,
            last: (to.velocity, to.acceleration),
            cycle,
        }
    }

    /// The largest magnitudes along it.
    pub(super) fn peaks(&self) -> Limits {
        let (velocity, acceleration, jerk, snap) = (self.velocity, self.acceleration, self.jerk, self.snap);
        let mut most = Limits {
            velocity: velocity.abs().max(self.last.0.abs()),
            acceleration: acceleration.abs().max(self.last.1.abs()),
            deceleration: 0.0,
            jerk: jerk.abs().max(self.last_jerk.abs()),
            snap: snap.abs(),
        };
        let is_inside = |time: f64| time > 0.0 && time < self.cycle;
        // Where the jerk is 0.
        let turn = -jerk / snap;
        if is_inside(turn) {
            let peak = acceleration + 0.5 * jerk * turn;
            most.acceleration = most.acceleration.max(peak.abs());
        }
        // Where the acceleration is 0: roots of a quadratic equation, computed without a small difference of large
        // numbers.
        let discriminant = jerk * jerk - 2.0 * snap * acceleration;
        if discriminant >= 0.0 {
            let root = -(jerk + standstill_planner::math::sqrt(discriminant).copysign(jerk));
            for time in [root / snap, 2.0 * acceleration / root] {
                if is_inside(time) {
                    let peak = velocity + time * (acceleration + time * (0.5 * jerk + time * snap / 6.0));
                    most.velocity = most.velocity.max(peak.abs());
                }
            }
        }
        most.deceleration = most.acceleration;
        most
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CYCLE: f64 = 0.01;

    /// The moments of a function that is `most` and `-most` in turn, and switches at these times.
    fn moments(most: f64, switches: &[f64]) -> [f64; 4] {
        let mut moments = [0.0; 4];
        let mut from = 0.0;
        let mut value = most;
        for &to in switches.iter().chain(&[1.0]) {
            let (from_end, to_end) = (1.0 - from, 1.0 - to);
            let (mut upper, mut lower) = (from_end, to_end);
            for (number, moment) in moments.iter_mut().enumerate() {
                *moment += value * (upper - lower) / (number + 1) as f64;
                (upper, lower) = (upper * from_end, lower * to_end);
            }
            (from, value) = (to, -value);
        }
        moments
    }

    /// Of all functions with the same first n moments, the one with the smallest magnitude changes its sign at most n
    /// - 1 times.
    #[test]
    fn moments_are_possible_up_to_the_smallest_function_that_has_them() {
        let mut random = 1_u64;
        let mut draw = || {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (random >> 11) as f64 / (1_u64 << 53) as f64
        };
        for round in 0..20_000 {
            let count = 1 + round % 4;
            let mut switches = [draw(), draw(), draw()];
            switches.sort_by(f64::total_cmp);
            let sign = if draw() < 0.5 { 1.0 } else { -1.0 };
            let of = |most: f64| moments(sign * most, &switches[..round / 4 % count]);
            let are_all = |most| (1..=count).all(|count| are_possible(&of(most), count, 1.0 + 1e-9));
            assert!(are_all(1.0), "{count} {switches:?}");
            // If a switch is next to another one or to an end, the function is hardly larger than one
            // without it.
            let ends = [0.0, switches[0], switches[1], switches[2], 1.0];
            if ends.windows(2).all(|pair| pair[1] - pair[0] > 0.05) {
                assert!(!are_all(1.001), "{count} {switches:?}");
            }
        }
    }

    /// Two pieces of constant snap, each half a scan long.
    fn after(start: &Setpoint, time: f64, snap: f64) -> Setpoint {
        let (t, t2) = (time, time * time);
        let (t3, t4) = (t2 * t, t2 * t2);
        let Setpoint {
            position,
            velocity,
            acceleration,
            jerk,
            ..
        } = *start;
        Setpoint {
            position: position + velocity * t + acceleration * t2 / 2.0 + jerk * t3 / 6.0 + snap * t4 / 24.0,
            velocity: velocity + acceleration * t + jerk * t2 / 2.0 + snap * t3 / 6.0,
            acceleration: acceleration + jerk * t + snap * t2 / 2.0,
            jerk: jerk + snap * t,
            snap,
        }
    }

    fn step<'a>(last: &'a Setpoint, next: &'a Setpoint) -> Step<'a> {
        Step {
            last,
            next,
            way: Some(next.position - last.position),
            coarsest: 0.0,
            cycle: CYCLE,
        }
    }

    fn needs(last: &Setpoint, next: &Setpoint) -> [f64; 4] {
        step(last, next).needs()
    }

    /// At the ends of the scan each derivative is within its limit. Only together they show that one was exceeded.
    #[test]
    fn a_switch_within_a_scan_shows_at_its_ends() {
        let start = Setpoint {
            position: 3.0,
            velocity: -1.0,
            acceleration: 20.0,
            ..Setpoint::default()
        };
        let middle = after(&start, 0.3 * CYCLE, 1.02e4);
        let end = after(&middle, 0.7 * CYCLE, -1.02e4);
        let limits = |snap| Limits {
            velocity: 10.0,
            acceleration: 100.0,
            deceleration: 100.0,
            jerk: 1e3,
            snap,
        };
        assert!(needs(&start, &end)[3] < 1e4);
        assert_eq!(step(&start, &end).beyond(&limits(1.0201e4)), None);
        let (name, least, limit) = step(&start, &end).beyond(&limits(1e4)).unwrap();
        assert_eq!((name, limit), ("snap", 1e4));
        assert!((least / 1.02e4 - 1.0).abs() < 1e-4, "{least}");
    }

    /// A speed that falls faster than the deceleration limit, but slower than the acceleration limit.
    #[test]
    fn each_way_has_its_own_limit() {
        let limits = Limits {
            velocity: 10.0,
            acceleration: 400.0,
            deceleration: 20.0,
            jerk: f64::INFINITY,
            snap: f64::INFINITY,
        };
        let state = |position, velocity| Setpoint {
            position,
            velocity,
            ..Setpoint::default()
        };
        for sign in [1.0, -1.0] {
            let reached = |rate: f64| {
                let start = state(sign * 3.0, sign * 5.0);
                let change = rate * CYCLE;
                let end = state(
                    sign * (3.0 + 5.0 * CYCLE + 0.5 * change * CYCLE),
                    sign * (5.0 + change),
                );
                step(&start, &end).beyond(&limits)
            };
            assert_eq!((reached(-20.0), reached(400.0)), (None, None));
            for (rate, most) in [(-21.0, 20.0), (401.0, 400.0)] {
                let (name, least, limit) = reached(rate).unwrap();
                assert_eq!((name, limit), ("acceleration", most));
                assert!((least / rate.abs() - 1.0).abs() < 1e-3, "{least}");
            }
            // It brakes to rest within the scan, and starts again in the other direction.
            let turns = step(&state(0.0, sign * 0.1), &state(sign * 0.00005, sign * -0.1)).beyond(&limits);
            assert_eq!(turns, None);
        }
    }

    #[test]
    fn a_motion_within_limits_needs_no_more_than_it_has() {
        for (first, second) in [(1e4, 1e4), (1e4, -1e4), (-1e4, 1e4), (0.0, 1e4)] {
            for cut in [0.1, 0.25, 0.5, 0.8] {
                let start = Setpoint {
                    position: 3.0,
                    velocity: -1.0,
                    acceleration: 20.0,
                    jerk: 50.0,
                    snap: 0.0,
                };
                let middle = after(&start, cut * CYCLE, first);
                let end = after(&middle, (1.0 - cut) * CYCLE, second);
                let [velocity, acceleration, jerk, snap] = needs(&start, &end);
                let most = |of: fn(&Setpoint) -> f64| {
                    let parts = (0..=1000).map(|part| f64::from(part) / 1000.0);
                    let all = parts.flat_map(|part| {
                        let first = after(&start, part * cut * CYCLE, first);
                        let second = after(&middle, part * (1.0 - cut) * CYCLE, second);
                        [of(&first).abs(), of(&second).abs()]
                    });
                    all.fold(0.0, f64::max) * (1.0 + 1e-5)
                };
                assert!(velocity <= most(|state| state.velocity));
                assert!(acceleration <= most(|state| state.acceleration));
                assert!(jerk <= most(|state| state.jerk), "{jerk} {first} {second} {cut}");
                assert!(snap <= 1e4 * (1.0 + 1e-9), "{snap} {first} {second} {cut}");
            }
        }
    }

    #[test]
    fn a_step_from_rest_to_rest_needs_what_its_way_takes() {
        let (start, end) = (Setpoint::at_rest(0.0), Setpoint::at_rest(0.5));
        let [velocity, acceleration, jerk, _] = needs(&start, &end);
        // A triangle of velocity, and two parabolas.
        let near = |value: f64, wanted: f64| (value - wanted).abs() <= 1e-9 * wanted;
        assert!(near(velocity, 50.0), "{velocity}");
        assert!(near(acceleration, 4.0 * 0.5 / 1e-4), "{acceleration}");
        assert!(near(jerk, BENT * 0.5 / 1e-6), "{jerk}");
    }

    #[test]
    fn rounding_of_a_far_place_needs_nothing() {
        let place = 1e9;
        let next = place + 2.0 * place * f64::EPSILON;
        assert_eq!(
            needs(&Setpoint::at_rest(place), &Setpoint::at_rest(next)),
            [0.0; 4]
        );
    }
}

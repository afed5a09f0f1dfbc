//! What a step from one set-point to the next needs of the limits, whatever the motion between them is.

use standstill_planner::{Limits, Setpoint};

/// What [`Step::needs`] tells, in its order.
pub(super) const DERIVATIVES: [&str; 4] = ["velocity", "acceleration", "jerk", "snap"];

/// A third derivative of at most J leads at most J cycle^3 / `BENT` off the way that velocities and accelerations at both ends
/// of a scan explain: 36 times the root of 3 (error of the trapezoidal rule with end correction).
const BENT: f64 = 62.353_829_072_479_58;

/// What a position is off by at most, relative to the largest one that enters it.
pub(super) const RESOLVED: f64 = 16.0 * f64::EPSILON;

/// Two set-points one scan apart.
pub(super) struct Step<'a> {
    pub last: &'a Setpoint,
    pub next: &'a Setpoint,
    /// The way between them (u), if known.
    pub way: Option<f64>,
    /// The largest position besides theirs that the way was made of (u).
    pub coarsest: f64,
    /// Length of a scan (s).
    pub cycle: f64,
}

impl Step<'_> {
    /// The velocity, acceleration, jerk and snap that are reached at least between the two, less what rounding may take: from the
    /// change of each derivative, and from how far that is off what the next ones explain.
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
        // Of a way, a change of velocity and one of acceleration, for what takes one, two and three derivatives of it.
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

/// A scan of constant snap, from a state on: velocity, acceleration, jerk and snap.
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
        // Where the acceleration is 0: roots of a quadratic, without taking a small difference of large numbers.
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

    /// A piece of constant snap, then another one, each half a scan long.
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

    fn needs(last: &Setpoint, next: &Setpoint) -> [f64; 4] {
        let way = Some(next.position - last.position);
        Step {
            last,
            next,
            way,
            coarsest: 0.0,
            cycle: CYCLE,
        }
        .needs()
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

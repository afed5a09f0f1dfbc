//! Follows published segments as polynomials and finds their extremes.
//!
//! It shares no code with the planner, because it checks the planner's claims. It uses only `+ - * /` and square
//! root, so that the figures are the same everywhere.

use standstill_planner::{Order, Segment, Setpoint};

/// Number of halvings of an interval to neighbouring numbers, or so near that the rest has no effect.
const HALVINGS: u32 = 60;

/// The course of a list of segments.
#[derive(Clone, Copy, Debug, Default)]
pub struct Followed {
    /// The state at the end; the position counts from the start.
    pub end: Setpoint,
    /// Time of all segments (s).
    pub duration: f64,
    /// Lowest and highest velocity (u/s).
    pub low: f64,
    /// See `low`.
    pub high: f64,
    /// Largest acceleration while the speed grows, while it falls, and while it is too near zero to
    /// decide (u/s^2).
    pub growing: f64,
    /// See `growing`.
    pub falling: f64,
    /// See `growing`.
    pub still: f64,
    /// Largest jerk (u/s^3) and snap (u/s^4).
    pub jerk: f64,
    /// See `jerk`.
    pub snap: f64,
    /// Largest jumps between segments of the derivatives that must be continuous: velocity (u/s),
    /// acceleration (u/s^2), jerk (u/s^3).
    pub jumps: [f64; 3],
}

impl Followed {
    /// Largest speed (u/s).
    pub fn speed(&self) -> f64 {
        self.high.max(-self.low)
    }

    /// Largest acceleration (u/s^2).
    pub fn acceleration(&self) -> f64 {
        self.growing.max(self.falling).max(self.still)
    }
}

/// Follows `segments` from `start`. At speeds up to `still` (u/s) rounding decides the direction.
pub fn follow(start: &Setpoint, segments: &[Segment], order: Order, still: f64) -> Followed {
    let mut state = Polynomial::of_start(start);
    let mut followed = Followed {
        low: start.velocity,
        high: start.velocity,
        ..Followed::default()
    };
    for segment in segments {
        let next = Polynomial::of_segment(state.position, segment);
        followed.jump(&state, &next, order);
        followed.look(&next, segment.duration, still);
        followed.duration += segment.duration;
        state = next.after(segment.duration);
    }
    followed.end = state.setpoint();
    followed
}

/// The state `time` (s) after the start; the position counts from there.
pub fn state_at(start: &Setpoint, segments: &[Segment], mut time: f64) -> Setpoint {
    let mut state = Polynomial::of_start(start);
    for segment in segments {
        let next = Polynomial::of_segment(state.position, segment);
        if time <= segment.duration {
            return next.after(time).setpoint();
        }
        time -= segment.duration;
        state = next.after(segment.duration);
    }
    // Only the velocity remains.
    Setpoint {
        position: state.position + state.velocity * time,
        velocity: state.velocity,
        ..Setpoint::default()
    }
}

impl Followed {
    /// Notes the jumps from one segment to the next.
    fn jump(&mut self, last: &Polynomial, next: &Polynomial, order: Order) {
        let gaps = [
            (Order::Two, next.velocity - last.velocity),
            (Order::Three, next.acceleration - last.acceleration),
            (Order::Four, next.jerk - last.jerk),
        ];
        for (jump, (least, gap)) in self.jumps.iter_mut().zip(gaps) {
            if order >= least {
                *jump = jump.max(gap.abs());
            }
        }
    }

    /// Notes the extremes along one segment.
    fn look(&mut self, segment: &Polynomial, duration: f64, still: f64) {
        let mut knots = Knots::new(duration);
        let [early, late] = zeros(segment.acceleration, segment.jerk, segment.snap / 2.0);
        for time in [-segment.jerk / segment.snap, early, late] {
            knots.add(time);
        }
        // Between these knots the velocity rises or falls, so it has one zero there or none.
        for (from, to) in knots.clone().intervals() {
            if segment.velocity(from) * segment.velocity(to) < 0.0 {
                knots.add(crossing(segment, from, to));
            }
        }
        for (from, to) in knots.intervals() {
            let velocities = [segment.velocity(from), segment.velocity(to)];
            let fastest = velocities[0].abs().max(velocities[1].abs());
            for velocity in velocities {
                self.low = self.low.min(velocity);
                self.high = self.high.max(velocity);
            }
            let most = segment
                .acceleration(from)
                .abs()
                .max(segment.acceleration(to).abs());
            let middle = 0.5 * (from + to);
            let side = if fastest <= still {
                &mut self.still
            } else if segment.velocity(middle) * segment.acceleration(middle) > 0.0 {
                &mut self.growing
            } else {
                &mut self.falling
            };
            *side = side.max(most);
        }
        let last = segment.jerk + duration * segment.snap;
        self.jerk = self.jerk.max(segment.jerk.abs()).max(last.abs());
        self.snap = self.snap.max(segment.snap.abs());
    }
}

/// A motion of constant snap, by its state at time 0.
#[derive(Clone, Copy, Debug)]
struct Polynomial {
    position: f64,
    velocity: f64,
    acceleration: f64,
    jerk: f64,
    snap: f64,
}

impl Polynomial {
    fn of_start(start: &Setpoint) -> Self {
        Self {
            position: 0.0,
            velocity: start.velocity,
            acceleration: start.acceleration,
            jerk: start.jerk,
            snap: 0.0,
        }
    }

    fn of_segment(position: f64, segment: &Segment) -> Self {
        Self {
            position,
            velocity: segment.velocity,
            acceleration: segment.acceleration,
            jerk: segment.jerk,
            snap: segment.snap,
        }
    }

    fn velocity(&self, t: f64) -> f64 {
        self.velocity + self.acceleration * t + self.jerk * t * t / 2.0 + self.snap * t * t * t / 6.0
    }

    fn acceleration(&self, t: f64) -> f64 {
        self.acceleration + self.jerk * t + self.snap * t * t / 2.0
    }

    fn after(&self, t: f64) -> Self {
        let way = self.velocity * t
            + self.acceleration * t * t / 2.0
            + self.jerk * t * t * t / 6.0
            + self.snap * t * t * t * t / 24.0;
        Self {
            position: self.position + way,
            velocity: self.velocity(t),
            acceleration: self.acceleration(t),
            jerk: self.jerk + self.snap * t,
            snap: self.snap,
        }
    }

    fn setpoint(&self) -> Setpoint {
        Setpoint {
            position: self.position,
            velocity: self.velocity,
            acceleration: self.acceleration,
            jerk: self.jerk,
            snap: self.snap,
        }
    }
}

/// Instants of a segment in order of time: its ends, three of them between, and at most one zero of the
/// velocity in each of the four intervals those make.
#[derive(Clone, Debug)]
struct Knots {
    times: [f64; 9],
    len: usize,
    duration: f64,
}

impl Knots {
    fn new(duration: f64) -> Self {
        let mut times = [duration; 9];
        times[0] = 0.0;
        Self {
            times,
            len: 2,
            duration,
        }
    }

    /// Adds an instant if it is inside the segment; a missing one is NaN or infinite.
    fn add(&mut self, time: f64) {
        if time > 0.0 && time < self.duration && self.len < self.times.len() {
            self.times[self.len] = time;
            self.len += 1;
            self.times[..self.len].sort_by(f64::total_cmp);
        }
    }

    fn intervals(&self) -> impl Iterator<Item = (f64, f64)> {
        self.times[..self.len].windows(2).map(|pair| (pair[0], pair[1]))
    }
}

/// The zeros of `c + b t + a t^2`, in the form that loses no digits; NaN or infinite if there is none.
fn zeros(c: f64, b: f64, a: f64) -> [f64; 2] {
    let root = (b * b - 4.0 * a * c).sqrt();
    let sum = -0.5 * (b + root.copysign(b));
    [sum / a, c / sum]
}

/// The zero of the velocity between two instants at which its signs differ.
fn crossing(segment: &Polynomial, mut from: f64, mut to: f64) -> f64 {
    let sign = segment.velocity(from).signum();
    for _ in 0..HALVINGS {
        let middle = 0.5 * (from + to);
        if segment.velocity(middle) * sign > 0.0 {
            from = middle;
        } else {
            to = middle;
        }
    }
    0.5 * (from + to)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn segment(duration: f64, velocity: f64, acceleration: f64, jerk: f64, snap: f64) -> Segment {
        Segment {
            duration,
            velocity,
            acceleration,
            jerk,
            snap,
        }
    }

    #[test]
    fn extremes_inside_a_segment_are_found() {
        // v = 3 t^2 - 2 t^3 - 0.5: it rises from below zero to 0.5, and falls again past t = 1.
        let start = Setpoint {
            velocity: -0.5,
            jerk: 6.0,
            ..Setpoint::default()
        };
        let seen = follow(&start, &[segment(1.5, -0.5, 0.0, 6.0, -12.0)], Order::Four, 1e-12);
        assert_eq!((seen.low, seen.high), (-0.5, 0.5));
        // It slows down to zero a second time at the acceleration -3, and speeds up backwards to -4.5.
        assert_eq!(seen.growing, 4.5);
        assert!((seen.falling - 3.0).abs() < 1e-14, "{seen:?}");
        assert_eq!((seen.jerk, seen.snap), (12.0, 12.0));
        assert_eq!(seen.jumps, [0.0; 3]);
        // Integral of v over [0, 1.5].
        assert!((seen.end.position - 0.09375).abs() < 1e-15, "{seen:?}");
    }

    #[test]
    fn jumps_are_told_of_the_derivatives_an_order_keeps() {
        let start = Setpoint::default();
        let jumping = [segment(1.0, 0.25, 0.5, 1.0, 0.0)];
        assert_eq!(follow(&start, &jumping, Order::Two, 0.0).jumps, [0.25, 0.0, 0.0]);
        assert_eq!(
            follow(&start, &jumping, Order::Three, 0.0).jumps,
            [0.25, 0.5, 0.0]
        );
        assert_eq!(follow(&start, &jumping, Order::Four, 0.0).jumps, [0.25, 0.5, 1.0]);
    }

    #[test]
    fn a_state_in_between_and_beyond_is_that_of_the_segments() {
        let start = Setpoint::default();
        let segments = [segment(1.0, 0.0, 2.0, 0.0, 0.0), segment(1.0, 2.0, 0.0, 0.0, 0.0)];
        let at = |time| {
            let state = state_at(&start, &segments, time);
            (state.position, state.velocity)
        };
        assert_eq!([at(0.5), at(1.5), at(4.0)], [(0.25, 1.0), (2.0, 2.0), (7.0, 2.0)]);
    }
}

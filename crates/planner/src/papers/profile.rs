//! A profile as a short list of polynomial pieces.

use super::{invalid, peaks, scans};
use crate::ramp::path::{moved, with_input};
use crate::{Field, Order, Peaks, PlanError, Segment, Setpoint};

/// Largest number of segments of a profile here: three to speed up, a cruise, three to slow down.
pub const MAX_SEGMENTS: usize = 7;

/// Rounding error of an acceleration that is held at zero, relative to the largest one before. A span
/// shorter than this, relative to the time before, counts as none.
const ROUNDING: f64 = 16.0 * f64::EPSILON;

/// The largest rounding error at the end of a profile, relative to the sum along the way.
const LANDING: f64 = 1e-9;

/// A duration (s) beside which the ramps at both ends of a move have no significant digits: such a move has more
/// scans than a plan can count.
const LONG: f64 = 1e9;

/// A stretch of constant jerk (order 3) or acceleration (order 2).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Piece {
    begin: f64,
    end: f64,
    /// As planned: the difference of the instants has lost digits.
    duration: f64,
    /// The state at `begin`, just after any jump.
    first: Setpoint,
}

/// A move in continuous time: at most [`MAX_SEGMENTS`] stretches of constant jerk, or at order 2 of
/// constant acceleration, that end exactly on a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile {
    start: Setpoint,
    end: Setpoint,
    pieces: [Piece; MAX_SEGMENTS],
    len: usize,
    order: Order,
}

impl Profile {
    /// The same motion in coordinates moved by `by` (u).
    pub(super) fn shift(&mut self, by: f64) {
        self.start.position += by;
        self.end.position += by;
        for piece in &mut self.pieces {
            piece.first.position += by;
        }
    }

    /// Places `spans` of (seconds, jerk; or at order 2 acceleration) one after the other from `start`.
    /// They must end at `target` (u) with `end_velocity` (u/s), up to rounding, which the last piece
    /// corrects.
    ///
    /// # Errors
    /// [`PlanError::InvalidInput`] names the target if the move is beyond the range of `f64`.
    pub(super) fn lay(
        order: Order,
        start: &Setpoint,
        spans: impl IntoIterator<Item = (f64, f64)>,
        target: f64,
        end_velocity: f64,
    ) -> Result<Self, PlanError> {
        let mut profile = Self {
            start: *start,
            end: Setpoint {
                velocity: end_velocity,
                ..Setpoint::at_rest(target)
            },
            pieces: [Piece::default(); MAX_SEGMENTS],
            len: 0,
            order,
        };
        let mut state = *start;
        let mut begin = 0.0;
        let mut largest: f64 = 0.0;
        for (duration, input) in spans {
            if !(duration > ROUNDING * begin) {
                // A length that is only rounding is no span.
                continue;
            }
            // Adding 0.0 removes the sign of zero.
            state = with_input(&state, order, input + 0.0);
            // An acceleration that is only rounding would be integrated over a long cruise.
            largest = largest.max(state.acceleration.abs());
            if input == 0.0 && state.acceleration.abs() <= ROUNDING * largest {
                state.acceleration = 0.0;
            }
            let end = begin + duration;
            if let Some(piece) = profile.pieces.get_mut(profile.len) {
                *piece = Piece {
                    begin,
                    end,
                    duration,
                    first: state,
                };
                profile.len += 1;
            }
            state = moved(&state, duration);
            begin = end;
        }
        if profile.ends_near(&state) {
            Ok(profile)
        } else if begin > LONG {
            Err(PlanError::too_far(target))
        } else {
            Err(invalid(Field::Target, target))
        }
    }

    /// Whether the pieces, which lead to `last`, end at the right state except for rounding. They do
    /// unless something overflowed or vanished on the way.
    fn ends_near(&self, last: &Setpoint) -> bool {
        let velocity = self.peaks().velocity;
        let length = self.start.position.abs() + self.end.position.abs() + velocity * self.duration();
        (last.position - self.end.position).abs() <= LANDING * length
            && (last.velocity - self.end.velocity).abs() <= LANDING * velocity
    }

    /// From rest to rest with the jerk pulses `times.jerk` of `jerk` (u/s^3, signed) (P1).
    pub(super) fn symmetric(start: f64, target: f64, jerk: f64, times: &Times) -> Result<Self, PlanError> {
        let Times {
            jerk: t_j,
            acceleration: t_a,
            velocity: t_v,
        } = *times;
        let spans = [
            (t_j, jerk),
            (t_a - t_j, 0.0),
            (t_j, -jerk),
            (t_v - t_a - t_j, 0.0),
            (t_j, -jerk),
            (t_a - t_j, 0.0),
            (t_j, jerk),
        ];
        Self::lay(Order::Three, &Setpoint::at_rest(start), spans, target, 0.0)
    }

    /// A plan without motion: at rest at `position` (u).
    pub(super) fn nothing(order: Order, position: f64) -> Self {
        let rest = Setpoint::at_rest(position);
        Self {
            start: rest,
            end: rest,
            pieces: [Piece::default(); MAX_SEGMENTS],
            len: 0,
            order,
        }
    }

    /// Time until the target is reached (s).
    pub fn duration(&self) -> f64 {
        self.last().map_or(0.0, |piece| piece.end)
    }

    /// The state at the end: exactly the target and the end velocity; higher derivatives are 0.
    pub const fn end(&self) -> Setpoint {
        self.end
    }

    /// Whether jerk is constant in each segment ([`Order::Three`]) or acceleration ([`Order::Two`]).
    pub const fn order(&self) -> Order {
        self.order
    }

    /// The duration in scans of `cycle` (s), as [`scans`] counts them.
    pub fn scans(&self, cycle: f64) -> Option<u32> {
        scans(self.duration(), cycle)
    }

    /// The set-point `time` (s) after the start; at most [`MAX_SEGMENTS`] comparisons.
    ///
    /// Up to 0 it is the start; from [`Profile::duration`] on it is the target, left with the end
    /// velocity. In between, a derivative that jumps has its value just before the instant.
    pub fn at(&self, time: f64) -> Setpoint {
        if time >= self.duration() {
            return Setpoint {
                position: self.end.position + self.end.velocity * (time - self.duration()),
                ..self.end
            };
        }
        if time <= 0.0 {
            return self.start;
        }
        let mut pieces = self.pieces.iter().take(self.len).enumerate();
        match pieces.find(|(_, piece)| time <= piece.end) {
            // The last piece is evaluated backwards from the end, so that it approaches it from one side.
            Some((index, piece)) if index + 1 == self.len => moved(&self.last_state(piece), time - piece.end),
            Some((_, piece)) => moved(&piece.first, time - piece.begin),
            None => self.end,
        }
    }

    /// The state at the end of the last piece, before the jumps there.
    fn last_state(&self, piece: &Piece) -> Setpoint {
        match self.order {
            Order::Two => Setpoint {
                acceleration: piece.first.acceleration,
                ..self.end
            },
            Order::Three | Order::Four => Setpoint {
                jerk: piece.first.jerk,
                ..self.end
            },
        }
    }

    fn last(&self) -> Option<&Piece> {
        self.len.checked_sub(1).and_then(|index| self.pieces.get(index))
    }

    /// The instants at which segments end (s), the last of which is the end of the move.
    pub fn switches(&self) -> impl Iterator<Item = f64> {
        self.pieces.iter().take(self.len).map(|piece| piece.end)
    }

    /// The segments in order of time, none of length zero.
    pub fn segments(&self) -> impl Iterator<Item = Segment> {
        let pieces = self.pieces.iter().take(self.len);
        pieces.map(|piece| Segment::of(piece.duration, &piece.first))
    }

    /// The largest magnitudes of the move, in closed form.
    pub fn peaks(&self) -> Peaks {
        let peaks = peaks(self.order, self.segments());
        Peaks {
            // A move of no length has no segments.
            velocity: peaks.velocity.max(self.end.velocity.abs()),
            ..peaks
        }
    }
}

/// The three times that make a symmetric profile (s) (P1).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Times {
    /// Length of a jerk pulse.
    pub jerk: f64,
    /// From the start to the end of constant acceleration.
    pub acceleration: f64,
    /// From the start to the start of braking.
    pub velocity: f64,
}

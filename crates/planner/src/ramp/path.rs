//! A ramp as a list of polynomial pieces, its values and its extremes.

use super::inside::LEAD_SPANS;
use crate::kernel::{THIRD_SPANS, falling_root};
use crate::math::sqrt;
use crate::{Order, Setpoint};

/// Most pieces of a ramp: getting inside the limits, then a third-order profile.
pub(super) const MAX_PIECES: usize = LEAD_SPANS + THIRD_SPANS;

/// What a jerk of zero may be off by, relative to the largest one before.
const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// A stretch of constant snap (order 4), jerk (3) or acceleration (2).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Piece {
    /// When it ends, from the start of the plan (s).
    end: f64,
    /// The state at `anchor`.
    state: Setpoint,
}

/// Pieces that follow each other from a start state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Path {
    pieces: [Piece; MAX_PIECES],
    len: usize,
    order: Order,
}

impl Path {
    pub(super) fn new(order: Order) -> Self {
        Self {
            pieces: [Piece::default(); MAX_PIECES],
            len: 0,
            order,
        }
    }

    /// Lays `spans` of (seconds, highest derivative) from `start` on and pins the end to `velocity`.
    ///
    /// The last piece is stored by the state at its end, so that it runs into the end velocity from one
    /// side, without a rounding error that would pass it.
    pub(super) fn lay(
        order: Order,
        start: &Setpoint,
        spans: impl Iterator<Item = (f64, f64)>,
        velocity: f64,
    ) -> Self {
        let mut path = Self::new(order);
        let mut state = *start;
        let mut time = 0.0;
        let mut largest_jerk: f64 = 0.0;
        for (duration, input) in spans {
            state = with_input(&state, order, input);
            // What rounding left of a jerk that is held at zero would be integrated over a long hold.
            largest_jerk = largest_jerk.max(state.jerk.abs());
            if input == 0.0 && state.jerk.abs() <= ROUNDING * largest_jerk {
                state.jerk = 0.0;
            }
            let end = time + duration;
            // A span too short to move the clock moves nothing else either.
            if end > time
                && let Some(piece) = path.pieces.get_mut(path.len)
            {
                *piece = Piece { end, state };
                path.len += 1;
                time = end;
            }
            state = moved(&state, duration);
        }
        if let Some(last) = path.len.checked_sub(1).and_then(|i| path.pieces.get_mut(i)) {
            last.state = Setpoint {
                position: state.position,
                velocity,
                acceleration: if order == Order::Two {
                    last.state.acceleration
                } else {
                    0.0
                },
                jerk: if order == Order::Three {
                    last.state.jerk
                } else {
                    0.0
                },
                snap: last.state.snap,
            };
        }
        path
    }

    /// When the last piece ends (s).
    pub(super) fn duration(&self) -> f64 {
        self.last().map_or(0.0, |piece| piece.end)
    }

    /// Position at the end of the last piece.
    pub(super) fn end_position(&self) -> Option<f64> {
        self.last().map(|piece| piece.state.position)
    }

    fn last(&self) -> Option<&Piece> {
        self.len.checked_sub(1).and_then(|i| self.pieces.get(i))
    }

    /// The state at `time` (s) after the start; at the boundary of two pieces that of the earlier one.
    pub(super) fn at(&self, time: f64) -> Option<Setpoint> {
        let mut begin = 0.0;
        for (index, piece) in self.pieces.iter().take(self.len).enumerate() {
            if time <= piece.end {
                return Some(moved(&piece.state, time - self.anchor(index, begin, piece)));
            }
            begin = piece.end;
        }
        None
    }

    /// The instant the stored state of a piece belongs to: its start, or the end of the last piece.
    fn anchor(&self, index: usize, begin: f64, piece: &Piece) -> f64 {
        if index + 1 == self.len { piece.end } else { begin }
    }

    /// Every piece with its bounds in time, and the state at its start.
    pub(super) fn stretches(&self) -> impl Iterator<Item = (Stretch, Setpoint)> {
        let mut begin = 0.0;
        self.pieces
            .iter()
            .take(self.len)
            .enumerate()
            .map(move |(index, piece)| {
                let stretch = Stretch {
                    begin,
                    end: piece.end,
                    anchor: self.anchor(index, begin, piece),
                    state: piece.state,
                };
                begin = piece.end;
                let first = moved(&stretch.state, stretch.begin - stretch.anchor);
                (stretch, first)
            })
    }

    /// The states that hold every extreme of velocity, acceleration and jerk: the ends of each piece, and
    /// inside it the zeros of jerk and acceleration (R20).
    ///
    /// `see` is also shown the states at which the velocity passes zero, from beyond `small` to beyond it
    /// on the other side, and told so, because the bounds of acceleration change there.
    pub(super) fn extremes(&self, small: f64, mut see: impl FnMut(&Setpoint, bool)) {
        for (stretch, first) in self.stretches() {
            let length = stretch.end - stretch.begin;
            let state = |time: f64| moved(&stretch.state, stretch.begin + time - stretch.anchor);
            let within = |time: f64| if time > 0.0 && time < length { time } else { length };
            see(&first, false);
            let flat = within(-first.jerk / first.snap);
            if flat < length {
                see(&state(flat), false);
            }
            let [early, late] = zeros(first.acceleration, first.jerk, first.snap).map(within);
            let (mut from, mut low) = (0.0, first);
            for to in [early.min(late), early.max(late), length] {
                if to <= from {
                    continue;
                }
                let high = state(to);
                see(&high, false);
                let sign = low.velocity.signum();
                if sign * low.velocity > small && -sign * high.velocity > small {
                    let (time, _) = falling_root(from, to, |t| sign * state(t).velocity);
                    see(&state(time), true);
                }
                (from, low) = (to, high);
            }
        }
    }

    pub(super) const fn order(&self) -> Order {
        self.order
    }
}

/// A piece as it lies in time.
pub(super) struct Stretch {
    /// Start (s).
    pub(super) begin: f64,
    /// End (s).
    pub(super) end: f64,
    /// The instant `state` belongs to (s).
    anchor: f64,
    state: Setpoint,
}

/// `state` with `input` as the derivative that `order` holds constant, and none above it.
fn with_input(state: &Setpoint, order: Order, input: f64) -> Setpoint {
    match order {
        Order::Four => Setpoint {
            snap: input,
            ..*state
        },
        Order::Three => Setpoint {
            jerk: input,
            snap: 0.0,
            ..*state
        },
        Order::Two => Setpoint {
            acceleration: input,
            jerk: 0.0,
            snap: 0.0,
            ..*state
        },
    }
}

/// The state `t` seconds later at constant snap (R21).
pub(super) fn moved(state: &Setpoint, t: f64) -> Setpoint {
    let Setpoint {
        position: p,
        velocity: v,
        acceleration: a,
        jerk: j,
        snap: s,
    } = *state;
    Setpoint {
        position: p + t * (v + t * (a / 2.0 + t * (j / 6.0 + t * (s / 24.0)))),
        velocity: v + t * (a + t * (j / 2.0 + t * (s / 6.0))),
        acceleration: a + t * (j + t * (s / 2.0)),
        jerk: j + t * s,
        snap: s,
    }
}

/// The zeros of `a + j t + s t^2/2`, in the form that loses no digits; NaN or infinite where there is none.
pub(super) fn zeros(a: f64, j: f64, s: f64) -> [f64; 2] {
    let root = sqrt(j * j - 2.0 * a * s);
    let sum = if j >= 0.0 { j + root } else { j - root };
    [-2.0 * a / sum, -sum / s]
}

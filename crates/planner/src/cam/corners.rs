//! The rows where a derivative of a cam jumps. A slave that may not let it jump comes to rest there.

use super::{Cam, CamPiece};
use crate::math::{ceil, floor};
use crate::profile::check::hull;
use crate::profile::curve::Slopes;

/// A difference up to this part of the largest value of a derivative in the cam is no jump.
const SAME: f64 = 1e-9;

/// A position counts as at a row within this distance, relative to the numbers of both.
const THERE: f64 = 1e-12;

/// The smoothness of a cam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CamSmooth {
    /// The highest order up to which all derivatives are continuous: 0 for corners, at most 3.
    pub continuity: u8,
    /// The largest jump of the first derivative that jumps: its row, from 1, and its size.
    pub jump: (usize, f64),
}

impl CamSmooth {
    /// Nothing jumps.
    pub(super) const DEFAULT: Self = Self {
        continuity: 3,
        jump: (0, 0.0),
    };
}

/// Whether a difference of this size is a jump of a derivative with this largest value in the cam.
pub(super) fn is_jump(size: f64, largest: f64) -> bool {
    !(size <= SAME * largest)
}

/// The derivatives at an end of a piece, and the rounding error of each from its control points.
#[derive(Clone, Copy, Default)]
struct End {
    slopes: Slopes,
    rounding: Slopes,
}

impl CamPiece {
    /// The begin and the end of the piece.
    fn ends(&self) -> (End, End) {
        let (first, second, third, _) = self.curve().derivatives();
        let ([f, .., to_f], [s, .., to_s], [t, .., to_t]) = (first, second, third);
        let (low, high) = hull(&self.points);
        let resolved = 4.0 * f64::EPSILON * (high - low);
        let per = 1.0 / self.width;
        let rounding = [14.0 * per, 168.0 * per * per, 1680.0 * per * per * per].map(|of| of * resolved);
        let end = |slopes| End { slopes, rounding };
        (end([f, s, t]), end([to_f, to_s, to_t]))
    }
}

impl Cam<'_> {
    /// The lowest of the first `order` derivatives that jumps at row `index`, from 0: its order less 1.
    /// The last row of a cam with periods is its first one.
    pub fn jumps_at(&self, index: usize, order: usize) -> Option<usize> {
        let last = self.pieces.len();
        let before = match index.checked_sub(1) {
            Some(before) => self.pieces.get(before),
            None => self.pieces.last().filter(|_| self.head.periodic),
        };
        let behind = match self.pieces.get(index) {
            None if index == last && self.head.periodic => self.pieces.first(),
            behind => behind,
        };
        let before = before.map_or(End::default(), |piece| piece.ends().1);
        let behind = behind.map_or(End::default(), |piece| piece.ends().0);
        let sizes = before.slopes.into_iter().zip(behind.slopes);
        let rounding = before.rounding.into_iter().zip(behind.rounding);
        sizes
            .zip(rounding)
            .zip(self.head.bounds.of_slopes())
            .take(order)
            .position(|(((one, other), rounding), largest)| {
                let size = (other - one).abs();
                is_jump(size, largest) && size > rounding.0 + rounding.1
            })
    }

    /// The next row on the master's path from `x` (u, not reduced to one period), within `reach` (u), at which one
    /// of the first `order` derivatives jumps. Returns its position, and the derivative as [`Cam::jumps_at`] does.
    /// A row at `x`, except for rounding, counts as passed.
    ///
    /// Cost: a check of each row on that path, at most one for each row of the cam.
    pub fn next_corner(&self, x: f64, forwards: bool, reach: f64, order: usize) -> Option<(f64, usize)> {
        let head = self.head;
        let length = head.end - head.begin;
        let at = THERE * (head.begin.abs() + head.end.abs() + x.abs());
        let from = if forwards { x + at } else { x - at };
        let mut base = if head.periodic {
            length * floor_of((from - head.begin) / length)
        } else {
            0.0
        };
        let pieces = self.pieces.len();
        let piece = usize::from(self.find(from - base, 0));
        // The row next to `from`: the end of its piece, or the begin; outside a cam without periods the outer one.
        let mut row = match (forwards, head.periodic) {
            (true, false) if from < head.begin => 0,
            (false, false) if from > head.end => pieces,
            (true, _) => piece + 1,
            (false, _) => piece,
        };
        for _ in 0..=pieces {
            let begin = self.pieces.get(row).map_or(head.end, |piece| piece.begin);
            let place = base + begin;
            let way = if forwards { place - from } else { from - place };
            if way > reach {
                return None;
            }
            if way >= 0.0
                && let Some(derivative) = self.jumps_at(row, order)
            {
                return Some((place, derivative));
            }
            let is_last = if forwards { row >= pieces } else { row == 0 };
            if is_last && !head.periodic {
                return None;
            }
            (row, base) = match (forwards, is_last) {
                (true, false) => (row + 1, base),
                (false, false) => (row - 1, base),
                (true, true) => (1, base + length),
                (false, true) => (pieces.saturating_sub(1), base - length),
            };
        }
        None
    }
}

/// The largest whole number not above `x`, which may be below 0.
fn floor_of(x: f64) -> f64 {
    if x < 0.0 { -ceil(-x) } else { floor(x) }
}

//! Cams: the slave's position for each position of its master, as curves of degree 7 from point to point.
//!
//! This module makes pieces from rows ([`CamBuild`]), finds their bounds and their smoothness, evaluates the value
//! and four derivatives at any position of the master, and places a cam between two axes ([`CamLaw`]). It does not
//! bring a slave onto the curve, and does not store the pieces.
//!
//! | file | subject |
//! | --- | --- |
//! | `build` | rows into pieces, some in each call |
//! | `rows` | the derivatives that a row leaves open |
//! | `bounds` | the bounds of a piece, and the motion of the master that they permit |
//! | `corners` | where a derivative jumps |
//! | `law` | the place of the slave for a place of the master: periods, scalings, the chain rule |
//!
//! All lengths on the master's side are in units of the master (u), those of the slave in units of the slave (y).

mod bounds;
mod build;
mod corners;
mod law;
mod rows;

use crate::Setpoint;
use crate::profile::curve::Curve;
pub use bounds::CamBounds;
pub use build::CamBuild;
pub use corners::CamSmooth;
pub use law::{CamAt, CamLaw};

/// Largest number of rows of a cam.
pub const CAM_ROWS: usize = 512;

/// Largest number of steps of a search among the pieces of a cam.
const STEPS: u32 = 9;

/// How the curve runs from one row to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CamShape {
    /// Derivatives at rows are estimated from the row and two neighbours on each side; degree 7 between.
    #[default]
    Through,
    /// Degree 7, with the slope, the curvature and the third derivative of both rows.
    Poly7,
    /// Degree 5, with the slope and the curvature of both rows.
    Poly5,
    /// Straight.
    Line,
    /// Degree 7, level at both rows up to the third derivative (4-5-6-7 polynomial).
    Rest7,
    /// Degree 5, level at both rows up to the second derivative (3-4-5 polynomial).
    Rest5,
}

/// A row of a cam.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CamRow {
    /// Position of the master (u).
    pub master: f64,
    /// Position of the slave (y).
    pub slave: f64,
    /// First derivative (y/u).
    pub slope: f64,
    /// Second derivative (y/u^2).
    pub curvature: f64,
    /// Third derivative (y/u^3).
    pub third: f64,
    /// The curve to the next row; not used for the last row.
    pub shape: CamShape,
}

/// A piece of a cam, from one row to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CamPiece {
    /// Its begin: of the master (u), of the slave (y).
    begin: f64,
    from: f64,
    /// Its length (u), and its control points relative to its begin (y).
    width: f64,
    points: [f64; 8],
    bounds: CamBounds,
}

impl CamPiece {
    fn curve(&self) -> Curve {
        Curve {
            time: self.width,
            from: self.from,
            points: self.points,
        }
    }

    /// The bounds of its derivatives.
    pub const fn bounds(&self) -> &CamBounds {
        &self.bounds
    }
}

/// The properties of a cam as a whole.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CamHead {
    /// First position of the master (u).
    pub begin: f64,
    /// Last position of the master (u).
    pub end: f64,
    /// Position of the slave in the first row (y).
    pub from: f64,
    /// Position of the slave in the last row (y).
    pub to: f64,
    /// The lowest and the highest position of the slave (y), within a thousandth of the range.
    pub range: (f64, f64),
    /// Whether the cam repeats: behind its last row it continues at its first.
    pub periodic: bool,
    /// The bounds of its derivatives.
    pub bounds: CamBounds,
    /// Its smoothness, including the rest before its first row and behind its last if it has no periods.
    pub smooth: CamSmooth,
    /// The same without that rest: from its first row to its last.
    pub smooth_inside: CamSmooth,
}

impl Default for CamHead {
    fn default() -> Self {
        Self {
            begin: 0.0,
            end: 1.0,
            from: 0.0,
            to: 0.0,
            range: (0.0, 0.0),
            periodic: false,
            bounds: CamBounds::default(),
            smooth: CamSmooth::DEFAULT,
            smooth_inside: CamSmooth::DEFAULT,
        }
    }
}

/// The faults of the rows of a cam.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CamCause {
    /// Fewer than two rows, or more than [`CAM_ROWS`].
    Count,
    /// A number is not finite, or so large or so small that a curve through it is not.
    NotFinite,
    /// The position of the master is not after that of the row before.
    Order,
}

/// The reason why the rows of a cam are refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CamFault {
    /// The kind of the fault.
    pub cause: CamCause,
    /// The row, from 1.
    pub row: usize,
    /// The value.
    pub value: f64,
    /// The bound that the value must be above, or may not exceed; NaN if there is none to name.
    pub limit: f64,
}

/// A cam: its properties, and its pieces.
#[derive(Clone, Copy, Debug)]
pub struct Cam<'a> {
    /// The properties.
    pub head: &'a CamHead,
    /// The pieces, in order of the master.
    pub pieces: &'a [CamPiece],
}

impl<'a> Cam<'a> {
    /// The piece that contains `place` (u); the first and the last have no outer end. `near` is the piece
    /// to try first.
    ///
    /// Cost: three comparisons for a piece next to `near`, at most 9 more for any other.
    pub fn find(&self, place: f64, near: u16) -> u16 {
        let near = usize::from(near);
        let begins_before = |index: usize| self.pieces.get(index).is_some_and(|piece| piece.begin <= place);
        let holds = |index: usize| {
            let last = index + 1 >= self.pieces.len();
            (index == 0 || begins_before(index)) && (last || !begins_before(index + 1))
        };
        let beside = [near, near.saturating_add(1), near.saturating_sub(1)];
        let found = beside
            .into_iter()
            .find(|index| *index < self.pieces.len() && holds(*index));
        let index = found.unwrap_or_else(|| {
            let (mut low, mut high) = (0, self.pieces.len());
            for _ in 0..STEPS {
                if high - low <= 1 {
                    break;
                }
                let middle = usize::midpoint(low, high);
                if begins_before(middle) {
                    low = middle;
                } else {
                    high = middle;
                }
            }
            low
        });
        u16::try_from(index).unwrap_or_default()
    }

    /// Begin and end (u) of the piece of that number; the last one for a larger number.
    pub fn ends_of(&self, index: u16) -> (f64, f64) {
        let last = self.pieces.len().saturating_sub(1);
        let piece = self.pieces.get(usize::from(index).min(last));
        piece.map_or((self.head.begin, self.head.end), |piece| {
            let next = self.pieces.get(usize::from(index).min(last) + 1);
            (piece.begin, next.map_or(self.head.end, |next| next.begin))
        })
    }

    /// The piece of that number.
    pub fn piece(&self, index: u16) -> Option<&'a CamPiece> {
        self.pieces.get(usize::from(index))
    }

    /// The slave's position at `place` (u) and four derivatives by the master, as position to snap, in the piece
    /// with that number. The place is the sum of two numbers, the second far smaller.
    ///
    /// Returns the slave's position as the begin of the piece and the distance from there. Cost: some 80
    /// operations.
    pub(crate) fn at(&self, place: (f64, f64), index: u16) -> (f64, Setpoint) {
        let Some(piece) = self.piece(index) else {
            return (self.head.from, Setpoint::default());
        };
        let within = (place.0 - piece.begin) + place.1;
        (piece.from, piece.curve().way_at(within))
    }
}

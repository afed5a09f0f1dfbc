//! The position of a cam between two axes: the slave's position as a pure function of the master's position.
//!
//! Periods are counted in integers from the master's position alone, so no error accumulates: a master that returns
//! to a position returns the slave to the same bits.

use super::bounds::behind;
use super::{Cam, CamBounds};
use crate::gear::{Double, add, divided, placed, plus};
use crate::turns::{two_product, two_sum};
use crate::{Anchor, Place, Setpoint};

/// The placement of a cam between a master and its slave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CamLaw {
    /// Factor of lengths on the master's side of the cam; not 0.
    pub master_scaling: f64,
    /// Factor of lengths on the slave's side; not 0.
    pub slave_scaling: f64,
    /// The position on the cam's master side (u) at the master's position in the anchor.
    pub origin: f64,
    /// Length of a turn (u) of the master, if it has turns.
    pub master_turn: Option<f64>,
    /// The same for the slave.
    pub slave_turn: Option<f64>,
}

/// A point on a cam.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CamAt {
    /// The place of the slave.
    pub place: Place,
    /// Its derivatives; the position is that of `place`.
    pub state: Setpoint,
    /// Whole periods before this one. On a cam without periods it is -1 before the first row, and 1 from the last
    /// row on.
    pub periods: i64,
    /// Position on the master's side of the cam (u), in its period.
    pub x: f64,
    /// Its piece.
    pub piece: u16,
}

impl CamLaw {
    /// The master's position on its side of the cam (u), relative to the first row, as exact as the sum of two
    /// numbers.
    fn way(&self, cam: &Cam<'_>, anchor: &Anchor, master: Place) -> Double {
        let from = &anchor.master;
        let turns = master.turns.wrapping_sub(from.turns);
        let within = two_sum(master.position, -from.position);
        let way = match self.master_turn {
            Some(length) => add(two_product(turns as f64, length), within),
            None => within,
        };
        let phase = two_sum(master.phase, -from.phase);
        let way = if phase.0 == 0.0 { way } else { add(way, phase) };
        let way = if self.master_scaling == 1.0 {
            way
        } else {
            divided(way, self.master_scaling)
        };
        if self.origin == cam.head.begin {
            way
        } else {
            add(way, two_sum(self.origin, -cam.head.begin))
        }
    }

    /// The master's position on its side of the cam (u), not reduced to one period.
    pub fn unwound(&self, cam: &Cam<'_>, anchor: &Anchor, master: Place) -> f64 {
        plus(self.way(cam, anchor, master), cam.head.begin).0
    }

    /// The slave's place and motion for a `master` at its place with the motion `moving`; `near` is the
    /// piece to try first.
    ///
    /// Cost: some 300 operations, and a search of at most 9 steps for a piece that is not next to `near`.
    pub fn at(&self, cam: &Cam<'_>, anchor: &Anchor, master: Place, moving: &Setpoint, near: u16) -> CamAt {
        let head = cam.head;
        let way = self.way(cam, anchor, master);
        let length = two_sum(head.end, -head.begin);
        let (periods, left) = if head.periodic {
            whole_and_rest(way, length)
        } else if way.0 < 0.0 {
            (-1, (0.0, 0.0))
        } else if way >= length {
            (1, length)
        } else {
            (0, way)
        };
        let x = plus(left, head.begin);
        let piece = cam.find(x.0, near);
        let rests = !head.periodic && periods != 0;
        let (from, curve) = if rests {
            let end = if periods < 0 { head.from } else { head.to };
            (end, Setpoint::default())
        } else {
            cam.at(x, piece)
        };
        let mut position = if self.slave_scaling == 1.0 {
            two_sum(from, curve.position)
        } else {
            add(
                two_product(self.slave_scaling, from),
                two_product(self.slave_scaling, curve.position),
            )
        };
        if head.periodic && periods != 0 && head.from != head.to {
            let rise = two_sum(head.to, -head.from);
            let (risen, error) = two_product(periods as f64, rise.0);
            let risen = add((risen, error), (periods as f64 * rise.1, 0.0));
            let (coarse, error) = two_product(self.slave_scaling, risen.0);
            position = add(position, (coarse, error + self.slave_scaling * risen.1));
        }
        let position = if anchor.slave.phase == 0.0 {
            plus(position, anchor.slave.position)
        } else {
            add(position, two_sum(anchor.slave.position, anchor.slave.phase))
        };
        let place = placed(self.slave_turn, anchor.slave.turns, position);
        CamAt {
            place,
            state: Setpoint {
                position: place.position,
                ..self.moved(&curve, moving)
            },
            periods,
            x: x.0,
            piece,
        }
    }

    /// The motion of the slave on a curve with these derivatives, behind a master with this motion.
    fn moved(&self, curve: &Setpoint, master: &Setpoint) -> Setpoint {
        let per = 1.0 / self.master_scaling;
        let first = self.slave_scaling * curve.velocity * per;
        let second = self.slave_scaling * curve.acceleration * per * per;
        let third = self.slave_scaling * curve.jerk * per * per * per;
        let fourth = self.slave_scaling * curve.snap * per * per * per * per;
        // Adding 0 changes -0 to 0.
        behind([first, second, third, fourth], master).plus(&Setpoint::at_rest(0.0))
    }

    /// The bounds of the slave's derivatives by its master from `low` to `high` on the master's side of
    /// the cam, neither reduced to one period ([`CamLaw::unwound`]).
    ///
    /// Cost: a check of each piece between them, at most 4; if there are more, the bounds of the whole
    /// cam are used.
    pub fn bounds_between(&self, cam: &Cam<'_>, low: f64, high: f64) -> CamBounds {
        cam.bounds_between(low, high)
            .scaled(self.master_scaling, self.slave_scaling)
    }
}

/// The number of times that `length` fits into `way`, and the rest, in [0, `length`).
fn whole_and_rest(way: Double, length: Double) -> (i64, Double) {
    let rest = |whole: i64| {
        let (coarse, error) = two_product(whole as f64, length.0);
        add(way, (-coarse, -(error + whole as f64 * length.1)))
    };
    let mut whole = (way.0 / length.0) as i64;
    let mut left = rest(whole);
    // The quotient is truncated towards 0, so it is off by one at most.
    for _ in 0..2 {
        if left.0 < 0.0 {
            whole = whole.wrapping_sub(1);
            left = rest(whole);
        } else if left >= length {
            whole = whole.wrapping_add(1);
            left = rest(whole);
        }
    }
    if left.0 < 0.0 {
        (whole, (0.0, 0.0))
    } else {
        (whole, left)
    }
}

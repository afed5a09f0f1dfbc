//! The derivatives that a row of a cam leaves open.

use super::{CamRow, CamShape};
use crate::profile::curve::Slopes;
use crate::profile::nodes::{Knot, STENCIL, taylor};

/// Level up to the third derivative.
pub(super) const LEVEL: Slopes = [0.0; 3];

/// The rows of a cam by number: from 0, and around the period of a cam that has one.
pub(super) struct Rows<'a> {
    pub row: &'a dyn Fn(usize) -> Option<CamRow>,
    pub count: usize,
    pub periodic: bool,
}

impl Rows<'_> {
    fn at(&self, index: usize) -> CamRow {
        (self.row)(index).unwrap_or_default()
    }

    /// The derivatives at both ends of the piece from row `index` on.
    pub(super) fn ends(&self, index: usize) -> (Slopes, Slopes) {
        match self.given(index) {
            Some(ends) => ends,
            None => (self.slopes_at(index), self.slopes_at(index + 1)),
        }
    }

    /// The same if the rows give them; none for a piece whose derivatives are estimated.
    fn given(&self, index: usize) -> Option<(Slopes, Slopes)> {
        let (from, to) = (self.at(index), self.at(index + 1));
        let (width, way) = (to.master - from.master, to.slave - from.slave);
        let all = |row: &CamRow| [row.slope, row.curvature, row.third];
        match from.shape {
            CamShape::Through => None,
            CamShape::Poly7 => Some((all(&from), all(&to))),
            CamShape::Poly5 => Some(of_degree_5(
                width,
                way,
                [from.slope, from.curvature],
                [to.slope, to.curvature],
            )),
            CamShape::Line => {
                let slopes = [way / width, 0.0, 0.0];
                Some((slopes, slopes))
            }
            CamShape::Rest7 => Some((LEVEL, LEVEL)),
            CamShape::Rest5 => Some(of_degree_5(width, way, [0.0; 2], [0.0; 2])),
        }
    }

    /// The derivatives at row `index`, between pieces whose derivatives are estimated. A neighbour of another shape
    /// gives its own. At the ends of a cam without periods the curve is level. Otherwise they are estimated.
    fn slopes_at(&self, index: usize) -> Slopes {
        if let Some(slopes) = self.held(index) {
            return slopes;
        }
        let here = self.knot(index as isize);
        let side = |step: isize| {
            let mut place = index as isize;
            let mut found = [here; 2];
            for slot in &mut found {
                if place == index as isize || !self.knot(place).anchor {
                    place += step;
                }
                *slot = self.knot(place);
            }
            found
        };
        let ([before, earlier], [behind, later]) = (side(-1), side(1));
        let knots: [Knot; STENCIL] = [earlier, before, here, behind, later];
        let [_, first, second, third] = taylor(knots, here.time);
        [first, 2.0 * second, 6.0 * third]
    }

    /// The derivatives that are known at row `index`.
    fn held(&self, index: usize) -> Option<Slopes> {
        let last = self.count.saturating_sub(1);
        let before = if index > 0 {
            Some(index - 1)
        } else {
            self.periodic.then(|| last.saturating_sub(1))
        };
        let behind = if index < last {
            Some(index)
        } else {
            self.periodic.then_some(0)
        };
        let (Some(before), Some(behind)) = (before, behind) else {
            return Some(LEVEL);
        };
        let ends = self.given(before).map(|(_, end)| end);
        ends.or_else(|| self.given(behind).map(|(begin, _)| begin))
    }

    /// Row `place`, also before the first and behind the last of a cam with periods.
    fn knot(&self, place: isize) -> Knot {
        let last = self.count.saturating_sub(1) as isize;
        let (mut within, mut periods) = (place, 0.0);
        // At most three neighbours are used, so few periods are passed.
        for _ in 0..STENCIL {
            if !self.periodic {
                within = within.min(last).max(0);
            } else if within < 0 {
                within += last;
                periods -= 1.0;
            } else if within > last {
                within -= last;
                periods += 1.0;
            }
        }
        let index = usize::try_from(within).unwrap_or_default();
        let row = self.at(index);
        let (first, end) = (self.at(0), self.at(self.count.saturating_sub(1)));
        let held = self.held(index);
        let [slope, curvature, third] = held.unwrap_or_default();
        Knot {
            time: row.master + periods * (end.master - first.master),
            value: [
                row.slave + periods * (end.slave - first.slave),
                slope,
                curvature,
                third,
            ],
            anchor: held.is_some(),
        }
    }
}

/// All three derivatives at both ends of the curve of degree 5 that meets two of them.
fn of_degree_5(width: f64, way: f64, from: [f64; 2], to: [f64; 2]) -> (Slopes, Slopes) {
    let [slope, curvature] = from;
    let [end_slope, end_curvature] = to;
    let (v0, a0) = (slope * width, curvature * width * width);
    let (v1, a1) = (end_slope * width, end_curvature * width * width);
    let per = 1.0 / (width * width * width);
    let third = (60.0 * way - 36.0 * v0 - 24.0 * v1 - 9.0 * a0 + 3.0 * a1) * per;
    let end_third = (60.0 * way - 24.0 * v0 - 36.0 * v1 - 3.0 * a0 + 9.0 * a1) * per;
    ([slope, curvature, third], [end_slope, end_curvature, end_third])
}

//! Makes pieces from rows, some in each call, so that no scan has all the work of a long table.

use super::bounds::CamBounds;
use super::corners::{CamSmooth, is_jump};
use super::rows::{LEVEL, Rows};
use super::{CAM_ROWS, CamCause, CamFault, CamHead, CamPiece, CamRow};
use crate::profile::curve::{Curve, Slopes};

/// The largest jump of each derivative: the row, from 1, and the size.
type Jumps = [(usize, f64); 3];

/// A cam being made.
#[derive(Clone, Copy, Debug)]
pub struct CamBuild {
    head: CamHead,
    count: usize,
    next: usize,
    /// The derivatives at the begin of the first piece and at the end of the last one made.
    first: Slopes,
    last: Slopes,
    jumps: Jumps,
}

impl CamBuild {
    /// A cam of `count` rows, none of which is checked yet.
    ///
    /// # Errors
    /// [`CamCause::Count`].
    pub fn new(count: usize, periodic: bool) -> Result<Self, CamFault> {
        let fault = |limit: f64| CamFault {
            cause: CamCause::Count,
            row: count,
            value: count as f64,
            limit,
        };
        if count < 2 {
            return Err(fault(2.0));
        }
        if count > CAM_ROWS {
            return Err(fault(CAM_ROWS as f64));
        }
        let head = CamHead {
            periodic,
            ..CamHead::default()
        };
        Ok(Self {
            head,
            count,
            next: 0,
            first: LEVEL,
            last: LEVEL,
            jumps: Jumps::default(),
        })
    }

    /// No piece has been made yet.
    pub const fn is_new(&self) -> bool {
        self.next == 0
    }

    /// Makes the next pieces, at most `most`, into `pieces`, which has one place less than there are
    /// rows. `row` returns a row by its number, from 0; the rows must stay the same from call to call.
    /// Returns the cam when it is complete.
    ///
    /// Cost: for each piece some 1,000 operations; if derivatives are estimated, some ten reads of rows
    /// in addition.
    ///
    /// # Errors
    /// The first [`CamFault`].
    pub fn go_on(
        &mut self,
        row: &dyn Fn(usize) -> Option<CamRow>,
        pieces: &mut [CamPiece],
        most: usize,
    ) -> Result<Option<CamHead>, CamFault> {
        let rows = Rows {
            row,
            count: self.count,
            periodic: self.head.periodic,
        };
        let pieces_in_all = self.count.saturating_sub(1);
        let end = self.next.saturating_add(most).min(pieces_in_all);
        // The rows that these pieces are made from: two on each side, and all of the other end of a
        // period.
        let near = self.next.saturating_sub(2)..end.saturating_add(3).min(self.count);
        let around = [
            0,
            1,
            2,
            self.count.saturating_sub(3),
            self.count.saturating_sub(2),
        ];
        let around = around.into_iter().filter(|index| *index + 1 < self.count);
        let pairs = near.chain(around).filter(|index| *index + 1 < self.count);
        let mut broken: Option<CamFault> = None;
        for index in pairs {
            let found = check(row, index);
            let is_earlier = |fault: &CamFault| broken.is_none_or(|broken| fault.row < broken.row);
            broken = found.filter(is_earlier).or(broken);
        }
        if let Some(fault) = broken {
            return Err(fault);
        }
        for (index, slot) in pieces.iter_mut().enumerate().take(end).skip(self.next) {
            *slot = self.made(&rows, index)?;
        }
        self.next = end;
        Ok((self.next >= pieces_in_all).then(|| self.finished(row)))
    }

    /// The piece from row `index` on.
    fn made(&mut self, rows: &Rows<'_>, index: usize) -> Result<CamPiece, CamFault> {
        let row = |index| (rows.row)(index).unwrap_or_default();
        let (from, to) = (row(index), row(index + 1));
        let (begin, end) = rows.ends(index);
        let width = to.master - from.master;
        let way = to.slave - from.slave;
        let curve = Curve::meeting(width, way, begin, end);
        let mut piece = CamPiece {
            begin: from.master,
            from: from.slave,
            width,
            points: curve.points,
            bounds: CamBounds::default(),
        };
        piece.bounds = piece.bounded();
        let CamBounds {
            first,
            second,
            third,
            fourth,
        } = piece.bounds;
        let sum = first + second + third + fourth + way + 1.0 / width;
        if !(sum.is_finite() && width > 0.0 && curve.points.into_iter().all(f64::is_finite)) {
            return Err(CamFault {
                cause: CamCause::NotFinite,
                row: index + 2,
                value: width,
                limit: f64::NAN,
            });
        }
        let range = piece.range();
        if index == 0 {
            (self.first, self.head.bounds, self.head.range) = (begin, piece.bounds, range);
            self.head.begin = from.master;
            self.head.from = from.slave;
        } else {
            let last = self.last;
            self.note_jumps(index + 1, last, begin);
            self.head.bounds = self.head.bounds.or_larger(&piece.bounds);
            let (low, high) = self.head.range;
            self.head.range = (
                if range.0 < low { range.0 } else { low },
                if range.1 > high { range.1 } else { high },
            );
        }
        self.last = end;
        Ok(piece)
    }

    /// Derivatives before and after row `row`, from 1.
    fn note_jumps(&mut self, row: usize, before: Slopes, after: Slopes) {
        let pairs = before.into_iter().zip(after);
        for (jump, (before, after)) in self.jumps.iter_mut().zip(pairs) {
            let size = (after - before).abs();
            if !(size <= jump.1) {
                *jump = (row, size);
            }
        }
    }

    fn finished(&mut self, row: &dyn Fn(usize) -> Option<CamRow>) -> CamHead {
        let (first, last) = (self.first, self.last);
        if self.head.periodic {
            self.note_jumps(1, last, first);
        }
        self.head.smooth_inside = self.smooth();
        if !self.head.periodic {
            // Before its first row and after its last the slave is at rest.
            self.note_jumps(1, LEVEL, first);
            self.note_jumps(self.count, last, LEVEL);
        }
        self.head.smooth = self.smooth();
        let end = row(self.count.saturating_sub(1)).unwrap_or_default();
        (self.head.end, self.head.to) = (end.master, end.slave);
        self.head
    }

    fn smooth(&self) -> CamSmooth {
        let jumps = self.jumps.into_iter().zip(self.head.bounds.of_slopes());
        let first = jumps
            .enumerate()
            .find(|(_, (jump, largest))| is_jump(jump.1, *largest));
        first.map_or(CamSmooth::DEFAULT, |(order, (jump, _))| CamSmooth {
            continuity: u8::try_from(order).unwrap_or_default(),
            jump,
        })
    }
}

/// The fault of row `index`, from 0, or of the next.
fn check(row: &dyn Fn(usize) -> Option<CamRow>, index: usize) -> Option<CamFault> {
    let finite = |number: usize, row: &CamRow| {
        let all = [row.master, row.slave, row.slope, row.curvature, row.third];
        all.into_iter()
            .find(|value| !value.is_finite())
            .map(|value| CamFault {
                cause: CamCause::NotFinite,
                row: number,
                value,
                limit: f64::NAN,
            })
    };
    let (from, to) = (row(index).unwrap_or_default(), row(index + 1).unwrap_or_default());
    let broken = finite(index + 1, &from).or_else(|| finite(index + 2, &to));
    broken.or_else(|| {
        (!(to.master > from.master)).then_some(CamFault {
            cause: CamCause::Order,
            row: index + 2,
            value: to.master,
            limit: from.master,
        })
    })
}

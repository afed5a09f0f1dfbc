//! Latched actual positions, and which of them can be compared.

use standstill_planner::turns::split;

/// The actual position of this scan and of the two before, and the reasons why they may not be comparable with the
/// next one. Fields that every scan reads come last; in an axis they are next to others of that kind.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Feedback {
    seam: Option<Seam>,
    /// As last latched (u).
    position: f64,
    /// The actual position of the last scan (u).
    before: f64,
    /// The actual position of the scan before the last (u).
    earlier: f64,
}

/// A change between the last latched position and the next one.
#[derive(Clone, Copy, Debug, Default)]
struct Seam {
    /// Nothing was latched yet.
    first: bool,
    /// Scans without a fresh position.
    lost: u32,
    /// The old value (u) of a position, and the new one (u).
    renamed: Option<(f64, f64)>,
}

impl Feedback {
    /// Before the first scan.
    pub fn new(position: f64) -> Self {
        Self {
            position,
            before: position,
            earlier: position,
            seam: Some(Seam {
                first: true,
                ..Seam::default()
            }),
        }
    }

    /// The actual position (u).
    #[inline]
    pub fn position(&self) -> f64 {
        self.position
    }

    /// The travel since the scan before (u).
    pub fn step(&self) -> f64 {
        self.position - self.before
    }

    /// The travel in the scan before (u).
    pub fn step_before(&self) -> f64 {
        self.before - self.earlier
    }

    /// Whether its positions can be compared with the next one.
    pub fn is_whole(&self) -> bool {
        self.seam.is_none()
    }

    /// Takes over this scan's position (u).
    #[inline]
    pub fn latch(&mut self, position: f64) {
        self.earlier = self.before;
        self.before = self.position;
        self.position = position;
    }

    /// The same if the earlier positions may have to be shifted; `length` (u) is that of a turn.
    pub fn latch_and_mend(&mut self, position: f64, length: Option<f64>) {
        self.latch(position);
        if self.seam.is_some() {
            self.mend(position);
        }
        if let Some(length) = length {
            self.come_round(length);
        }
    }

    /// This scan has no fresh position.
    pub fn latch_nothing(&mut self) {
        let seam = self.seam.get_or_insert_default();
        seam.lost = seam.lost.saturating_add(1);
    }

    /// Shifts the coordinates without motion: from the next latch on, the position `old` (u) has the value `name`
    /// (u).
    pub fn rename(&mut self, old: f64, name: f64) {
        self.seam.get_or_insert_default().renamed = Some((old, name));
    }

    /// Shifts all positions so far by `by` (u), without motion.
    pub fn shift(&mut self, by: f64) {
        self.position += by;
        self.before += by;
        self.earlier += by;
    }

    /// Sets the present position to exactly this value (u), after a shift by a rounded difference, or by a turn.
    pub fn call(&mut self, position: f64) {
        self.position = position;
    }

    /// Shifts the earlier positions by turns of `length` (u), so that each is nearest to the later one.
    #[inline]
    pub fn come_round(&mut self, length: f64) {
        let half = length / 2.0;
        let is_near = (self.before - self.position).abs() < half && (self.earlier - self.before).abs() < half;
        if !is_near {
            self.before = nearest(self.before, self.position, length);
            self.earlier = nearest(self.earlier, self.before, length);
        }
    }

    /// Makes the positions before the change comparable with `actual` (u).
    #[cold]
    #[inline(never)]
    fn mend(&mut self, actual: f64) {
        let seam = self.seam.take().unwrap_or_default();
        if seam.first {
            // Before the first scan the axis counts as at rest, at any position.
            (self.before, self.earlier) = (actual, actual);
        }
        if let Some((old, name)) = seam.renamed {
            // A position equal to the old value gets the new value exactly, without the rounding of a shift.
            let shifted = |place: f64| {
                if place == old { name } else { place + (name - old) }
            };
            (self.before, self.earlier) = (shifted(self.before), shifted(self.earlier));
        }
        if seam.lost > 0 {
            // The mean over the scans without feedback.
            let step = (actual - self.before) / (f64::from(seam.lost) + 1.0);
            (self.before, self.earlier) = (actual - step, actual - 2.0 * step);
        }
    }
}

/// `place` (u), moved by whole turns of `length` (u) so that it is nearest to `to`.
#[cold]
pub(super) fn nearest(place: f64, to: f64, length: f64) -> f64 {
    if (place - to).abs() < length / 2.0 {
        return place;
    }
    let (_, ahead) = split(place - to, length);
    to + if ahead > length / 2.0 {
        ahead - length
    } else {
        ahead
    }
}

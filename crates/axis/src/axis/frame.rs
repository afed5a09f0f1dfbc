//! What positions are called: how far the names of an axis are from those of its drive, and when they moved.

/// The names of positions.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Frame {
    /// What positions are called more than increments say (u); 0 for drives that speak units.
    shift: f64,
    /// What the drive's present commanded position is called from now on (u); none for drives that count increments.
    rename: Option<f64>,
    /// How often coordinates have moved.
    moves: u32,
    /// The last scan in which coordinates moved, and by how much in all (u).
    moved: (u64, f64),
}

impl Frame {
    /// What positions are called more than increments say (u).
    #[inline]
    pub fn shift(&self) -> f64 {
        self.shift
    }

    /// Positions are called `by` (u) more than increments say, on top of what they were.
    pub fn shift_by(&mut self, by: f64) {
        self.shift += by;
    }

    /// The drive is told that its present commanded position is called so (u).
    pub fn rename(&mut self, position: f64) {
        self.rename = Some(position);
    }

    /// The drive has yet to be told a name.
    pub fn is_renaming(&self) -> bool {
        self.rename.is_some()
    }

    /// The name to tell the drive, once.
    pub fn take_rename(&mut self) -> Option<f64> {
        self.rename.take()
    }

    /// Grows whenever coordinates move, and comes round: positions taken at different numbers cannot be compared.
    pub fn moves(&self) -> u32 {
        self.moves
    }

    /// Coordinates move: positions taken before cannot be compared with those after.
    pub fn count_move(&mut self) {
        self.moves = self.moves.wrapping_add(1);
    }

    /// By how much positions are called more from `scan` on (u), if that is the last scan in which coordinates moved; else 0.
    pub fn moved_in(&self, scan: u64) -> f64 {
        let (last, by) = self.moved;
        if last == scan { by } else { 0.0 }
    }

    /// Coordinates moved in this scan, if only by 0.
    pub fn has_moved_in(&self, scan: u64) -> bool {
        self.moved.0 == scan
    }

    /// In `scan` coordinates moved by `by` (u), on top of what they did in it before.
    pub fn note_moved(&mut self, scan: u64, by: f64) {
        self.moved = (scan, self.moved_in(scan) + by);
    }
}

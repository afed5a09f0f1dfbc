//! The names of positions: the offset between the names of an axis and those of its drive, and the scans
//! in which it changed.

/// The names of positions.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Frame {
    /// The offset of positions from what increments say (u); 0 for drives that use units.
    shift: f64,
    /// The new name of the drive's present commanded position (u); none for drives that count increments.
    rename: Option<f64>,
    /// The number of moves of the coordinates.
    moves: u32,
    /// The last scan in which coordinates moved, and the distance in all (u).
    moved: (u64, f64),
}

impl Frame {
    /// The offset of positions from what increments say (u).
    #[inline]
    pub fn shift(&self) -> f64 {
        self.shift
    }

    /// Adds `by` (u) to the offset.
    pub fn shift_by(&mut self, by: f64) {
        self.shift += by;
    }

    /// Gives the drive's present commanded position this name (u).
    pub fn rename(&mut self, position: f64) {
        self.rename = Some(position);
    }

    /// Whether the drive has not got its new position yet.
    pub fn is_renaming(&self) -> bool {
        self.rename.is_some()
    }

    /// The new name for the drive, once.
    pub fn take_rename(&mut self) -> Option<f64> {
        self.rename.take()
    }

    /// A number that grows whenever coordinates move, and wraps. Positions taken at different numbers
    /// cannot be compared.
    pub fn moves(&self) -> u32 {
        self.moves
    }

    /// Counts a move of the coordinates. Positions taken before it cannot be compared with those after
    /// it.
    pub fn count_move(&mut self) {
        self.moves = self.moves.wrapping_add(1);
    }

    /// The distance by which coordinates moved in `scan` (u), if that is the last scan in which they
    /// moved; otherwise 0.
    pub fn moved_in(&self, scan: u64) -> f64 {
        let (last, by) = self.moved;
        if last == scan { by } else { 0.0 }
    }

    /// Whether coordinates moved in this scan, even by 0.
    pub fn has_moved_in(&self, scan: u64) -> bool {
        self.moved.0 == scan
    }

    /// Notes that coordinates moved by `by` (u) in `scan`, in addition to earlier moves in it.
    pub fn note_moved(&mut self, scan: u64, by: f64) {
        self.moved = (scan, self.moved_in(scan) + by);
    }
}

//! The coordinates: the offset between positions of an axis and of its drive, and the scans in which it changed.

/// The coordinates of an axis.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Frame {
    /// The offset of positions from those of the increments (u); 0 for drives that use units.
    shift: f64,
    /// The new value of the drive's present commanded position (u); none for drives that count increments.
    rename: Option<f64>,
    /// The number of shifts of the coordinates.
    moves: u32,
    /// The sum of all shifts (u).
    total: f64,
    /// The last scan with a shift, and the sum of its shifts (u).
    moved: (u64, f64),
}

impl Frame {
    /// The offset of positions from those of the increments (u).
    #[inline]
    pub fn shift(&self) -> f64 {
        self.shift
    }

    /// Adds `by` (u) to the offset.
    pub fn shift_by(&mut self, by: f64) {
        self.shift += by;
    }

    /// Sets the drive's present commanded position to this value (u).
    pub fn rename(&mut self, position: f64) {
        self.rename = Some(position);
    }

    /// Whether the drive has not got its new position yet.
    pub fn is_renaming(&self) -> bool {
        self.rename.is_some()
    }

    /// The new value for the drive, once.
    pub fn take_rename(&mut self) -> Option<f64> {
        self.rename.take()
    }

    /// A number that grows with each shift of the coordinates, and wraps.
    pub fn moves(&self) -> u32 {
        self.moves
    }

    /// The sum of all shifts of the coordinates (u).
    pub fn total(&self) -> f64 {
        self.total
    }

    /// Counts a shift of the coordinates by `by` (u).
    pub fn count_move(&mut self, by: f64) {
        self.moves = self.moves.wrapping_add(1);
        self.total += by;
    }

    /// The shift of the coordinates in `scan` (u), if that is the last scan with a shift; otherwise 0.
    pub fn moved_in(&self, scan: u64) -> f64 {
        let (last, by) = self.moved;
        if last == scan { by } else { 0.0 }
    }

    /// Whether coordinates were shifted in this scan, even by 0.
    pub fn has_moved_in(&self, scan: u64) -> bool {
        self.moved.0 == scan
    }

    /// Notes a shift of the coordinates by `by` (u) in `scan`, in addition to earlier shifts in it.
    pub fn note_moved(&mut self, scan: u64, by: f64) {
        self.moved = (scan, self.moved_in(scan) + by);
    }
}

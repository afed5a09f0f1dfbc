//! The position of an axis in the chains of masters and slaves. [`couple`](crate::couple()) finds it from all axes.

/// The position of an axis, and whether it follows a master or has slaves. Fields that every scan reads come first.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
pub(crate) struct Links {
    is_bound: bool,
    is_followed: bool,
    some_follow: bool,
    is_above: bool,
    rank: u16,
    turn: Turn,
}

/// One entry of the order in which axes move. The entries of all axes, by number, form the whole order.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Turn {
    /// The index of the axis at this position of the order; the position is the index of the axis with
    /// this entry.
    pub index: usize,
    /// The number of axes when the order was found.
    pub among: usize,
}

impl Links {
    /// The number of masters above the axis.
    pub(crate) fn rank(&self) -> u16 {
        self.rank
    }

    pub(crate) fn set_rank(&mut self, rank: u16) {
        self.rank = rank;
    }

    #[inline]
    pub(crate) fn turn(&self) -> Turn {
        self.turn
    }

    pub(crate) fn set_turn(&mut self, turn: Turn) {
        self.turn = turn;
    }

    /// The owner of the axis or a waiting command may follow a master; never FALSE if one does.
    #[inline]
    pub(crate) fn is_bound(&self) -> bool {
        self.is_bound
    }

    pub(in crate::axis) fn set_bound(&mut self, is_bound: bool) {
        self.is_bound = is_bound;
    }

    /// Of the first axis: some axis may follow a master; never FALSE if one does.
    #[inline]
    pub(crate) fn some_follow(&self) -> bool {
        self.some_follow
    }

    pub(crate) fn set_some_follow(&mut self, some_follow: bool) {
        self.some_follow = some_follow;
    }

    /// Whether a slave may follow it, or followed it.
    #[inline]
    pub(in crate::axis) fn is_followed(&self) -> bool {
        self.is_followed
    }

    pub(crate) fn note_followed(&mut self) {
        self.is_followed = true;
    }

    /// Whether the present search for a ring has reached this axis.
    pub(crate) fn is_above(&self) -> bool {
        self.is_above
    }

    pub(crate) fn set_above(&mut self, is_above: bool) {
        self.is_above = is_above;
    }
}

//! The place of an axis among those that follow each other. [`couple`](crate::couple) finds it, looking at all of them.

/// Where an axis stands, whether it follows a master and whether some slave follows it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Links {
    rank: u16,
    turn: Turn,
    is_bound: bool,
    is_followed: bool,
    is_above: bool,
}

/// One entry of the order in which axes move; the entries of all axes, in the order of their numbers, are the whole of it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Turn {
    /// The index of the axis that moves after as many axes as the index of the one that keeps this.
    pub index: usize,
    /// How many axes there were when the order was found.
    pub among: usize,
}

impl Links {
    /// How many masters stand above the axis.
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

    /// The owner of the axis or a command that waits may follow a master; never FALSE where one does.
    #[inline]
    pub(crate) fn is_bound(&self) -> bool {
        self.is_bound
    }

    pub(in crate::axis) fn set_bound(&mut self, is_bound: bool) {
        self.is_bound = is_bound;
    }

    /// Some slave may follow it, or did.
    #[inline]
    pub(in crate::axis) fn is_followed(&self) -> bool {
        self.is_followed
    }

    pub(crate) fn note_followed(&mut self) {
        self.is_followed = true;
    }

    /// The search for a ring that is under way has come to this axis.
    pub(crate) fn is_above(&self) -> bool {
        self.is_above
    }

    pub(crate) fn set_above(&mut self, is_above: bool) {
        self.is_above = is_above;
    }
}

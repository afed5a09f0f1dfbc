//! How many ramps have been solved: what plans cost, for tests.

use core::cell::Cell;

std::thread_local! {
    static SOLVED: Cell<u64> = const { Cell::new(0) };
}

/// Ramps, and whole moves of the kernel, that this thread has solved, those of plans not taken among them.
pub fn solved() -> u64 {
    SOLVED.get()
}

/// One more.
pub(super) fn add() {
    SOLVED.set(SOLVED.get() + 1);
}

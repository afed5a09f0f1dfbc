//! The number of ramps that were solved: the cost of plans, for tests.

use core::cell::Cell;

std::thread_local! {
    static SOLVED: Cell<u64> = const { Cell::new(0) };
}

/// Number of ramps, and of whole moves of the kernel, that this thread has solved, including those of rejected
/// plans.
pub fn solved() -> u64 {
    SOLVED.get()
}

/// Counts one more.
pub(super) fn add() {
    SOLVED.set(SOLVED.get() + 1);
}

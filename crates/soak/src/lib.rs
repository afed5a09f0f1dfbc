//! Random replans, and a judge that checks the claims about every plan.
//!
//! The crate makes chains of replans from numbers, has an integrator that shares no code with the
//! planner, and the judge. `standstill soak` runs them by the million. The fuzz target in `fuzz/` chooses
//! the numbers so that they reach every branch.

#![forbid(unsafe_code)]

mod cases;
mod follow;
mod judge;
pub mod monkey;
mod random;
pub mod rules;

pub use cases::{Case, Chain, Goal, Plan};
pub use judge::{Measured, judge};
pub use random::Random;

/// Replans of the chain that a fuzzer's bytes make.
const FUZZED: u32 = 6;

/// Plans and judges the chain that `bytes` make.
///
/// # Errors
/// The broken claim of the first plan that fails, and its replan as a line of `standstill plan`.
pub fn fuzz(bytes: &[u8]) -> Result<(), String> {
    let mut chain = Chain::of(Random::of_bytes(bytes));
    for link in 0..FUZZED {
        let case = chain.next_case();
        let judged = case.plan().map_err(|error| error.to_string()).and_then(|plan| {
            let scan = chain.leave(&plan);
            let measured = judge(&case, &plan, scan)?;
            chain.follow(&plan, scan, measured.keeps);
            Ok(())
        });
        judged.map_err(|what| case.line(&format!("replan {link}: {what}")))?;
    }
    Ok(())
}

//! Searches the random replans with the most ramps and root steps: `worst_replan [MOVES]`, by default a
//! million. `instructions.rs` counts them as `WORST_REPLANS`.

use standstill_bench::{Random, any_unit};
use standstill_planner::Order;
use std::process::ExitCode;

fn main() -> ExitCode {
    let moves = std::env::args()
        .nth(1)
        .map_or(Ok(1_000_000_u64), |count| count.parse());
    let Ok(moves) = moves else {
        eprintln!("MOVES must be a whole number");
        return ExitCode::from(2);
    };
    for order in [Order::Three, Order::Four] {
        let mut most = ((0, 0), 0);
        let mut solves = 0_u64;
        for seed in 0..moves {
            let request = any_unit(&mut Random(seed), true);
            let Ok(plan) = request.plan(order) else {
                eprintln!("seed {seed} is refused: {request:?}");
                return ExitCode::FAILURE;
            };
            solves += u64::from(plan.solves());
            most = most.max(((plan.solves(), plan.steps()), seed));
        }
        let ((ramps, steps), seed) = most;
        println!(
            "{order:?}: {moves} replans, {:.2} ramps on average; worst: seed {seed}, {ramps} ramps, {steps} steps of a root",
            solves as f64 / moves as f64
        );
    }
    ExitCode::SUCCESS
}

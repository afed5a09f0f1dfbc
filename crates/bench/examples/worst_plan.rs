//! Searches the random rest-to-rest move with the most search steps: `worst_plan [MOVES]`, by default a
//! million. Prints it with the seed that `instructions.rs` counts as `WORST`.

use standstill_bench::{Move, Random, servo};
use standstill_planner::grid::Work;
use standstill_planner::{GridPlan, Method};
use std::process::ExitCode;

fn main() -> ExitCode {
    let moves = std::env::args()
        .nth(1)
        .map_or(Ok(1_000_000_u64), |count| count.parse());
    let Ok(moves) = moves else {
        eprintln!("MOVES must be a whole number");
        return ExitCode::from(2);
    };
    let mut worst: Option<(u32, u64, Work, u32, Move)> = None;
    let mut total = 0_u64;
    let mut capped = 0_u64;
    for seed in 0..moves {
        let request = servo(&mut Random(seed));
        let planned = GridPlan::new_counted(
            Method::Overlapped,
            request.start,
            request.target,
            &request.limits,
            request.cycle,
        );
        let Ok((plan, work)) = planned else {
            eprintln!("seed {seed} is refused: {request:?}");
            return ExitCode::FAILURE;
        };
        let steps = work.rows + work.candidates;
        total += u64::from(work.candidates);
        capped += u64::from(work.capped);
        if worst.as_ref().is_none_or(|(most, ..)| steps > *most) {
            worst = Some((steps, seed, work, plan.scans(), request));
        }
    }
    println!(
        "{moves} moves, {:.2} candidates on average, {capped} capped",
        total as f64 / moves as f64
    );
    if let Some((_, seed, work, scans, request)) = worst {
        println!("worst: seed {seed}, {work:?}, {scans} scans, {request:?}");
    }
    ExitCode::SUCCESS
}

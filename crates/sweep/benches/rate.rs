//! Axis-scans a second of sweeps, beside a bare loop of trapezoid samples timed in the same run.
//!
//! A case is read, run through executor, blocks, axis and drive, judged and measured; the loop computes
//! the position of a trapezoid from its parameters and adds it up. One thread each, medians of some
//! rounds. Names of sweeps after `--` select some of them.

use standstill_script::suite::Allowed;
use standstill_sweep::{Job, SweepError, run};
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

const ROUNDS: usize = 11;

/// Samples of the loop in a round.
const SAMPLES: u64 = 1_000_000;

/// An ideal axis, and one with a mechanism; those behind have no digests in their tables.
const SWEEPS: [&str; 4] = ["ideal", "ideal_bare", "turn", "turn_bare"];

fn main() -> Result<(), SweepError> {
    let here = Path::new(env!("CARGO_MANIFEST_DIR"));
    let allowed = Allowed {
        folders: vec![here.join("../../docs/sweeps")],
        ..Allowed::default()
    };
    let chosen: Vec<String> = std::env::args()
        .skip(1)
        .filter(|it| !it.starts_with('-'))
        .collect();
    for name in SWEEPS {
        if !chosen.is_empty() && !chosen.iter().any(|it| it == name) {
            continue;
        }
        let path = here.join(format!("benches/cases/{name}.sweep.json"));
        let (sweep, bare) = rates(&Job::load(&path, &allowed)?)?;
        println!(
            "{name:<12} {:>9.2e} axis-scans a second, bare trapezoids {:>9.2e}; one costs {:>6.1} of them",
            1.0 / sweep,
            1.0 / bare,
            sweep / bare
        );
    }
    Ok(())
}

/// The time of an axis-scan of a sweep and of a sample of the loop (s).
fn rates(job: &Job) -> Result<(f64, f64), SweepError> {
    let cases: Vec<u64> = (0..job.count()).collect();
    let (mut sweeps, mut loops) = (Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        let begin = Instant::now();
        let mut axis_scans = 0;
        run(job, &cases, 1, |row| {
            axis_scans += row.axis_scans;
            Ok::<_, SweepError>(())
        })?;
        sweeps.push(begin.elapsed().as_secs_f64() / axis_scans as f64);
        let begin = Instant::now();
        black_box(
            (0..SAMPLES)
                .map(|scan| trapezoid(black_box(scan % 1000) as f64 * 1e-3))
                .sum::<f64>(),
        );
        loops.push(begin.elapsed().as_secs_f64() / SAMPLES as f64);
    }
    Ok((median(sweeps), median(loops)))
}

/// A move of 1 at velocity 4 and acceleration 40, at this time (s).
fn trapezoid(time: f64) -> f64 {
    let (velocity, acceleration, length) = black_box((4.0, 40.0, 1.0));
    let ramp = velocity / acceleration;
    let plateau = length / velocity - ramp;
    if time < ramp {
        0.5 * acceleration * time * time
    } else if time < ramp + plateau {
        velocity * (time - 0.5 * ramp)
    } else {
        let left = (2.0 * ramp + plateau - time).max(0.0);
        length - 0.5 * acceleration * left * left
    }
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times[times.len() / 2]
}

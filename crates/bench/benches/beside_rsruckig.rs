//! Plans from any state beside those of `rsruckig`, an open third-order planner: the same inputs, in the
//! same run. `cargo bench -p standstill-bench --bench beside_rsruckig [-- INPUTS]`, 100,000 for each set
//! by default.
//!
//! Every input is planned once by each planner in every round. Its time is the least over the rounds, so that other
//! load of the machine has no effect; median, 99.9th percentile and largest are over the inputs. The measured time
//! includes the check of the inputs for both. rsruckig keeps its memory from plan to plan, as designed.

use rsruckig::prelude::{DataArrayOrVec, InputParameter, Ruckig, ThrowErrorHandler, Trajectory};
use standstill_bench::{CYCLE, Random, Replan, any_unit, ordinary};
use standstill_planner::{OnlinePlan, Order};
use std::hint::black_box;
use std::process::ExitCode;
use std::time::Instant;

/// How often every input is planned.
const ROUNDS: usize = 7;

/// Times two durations may differ, relative to the longer.
const SAME: f64 = 1e-6;

/// Plans at the start of each round that are not timed.
const WARM_UP: usize = 100;

/// Samples taken of each plan.
const SAMPLES: u32 = 32;

/// A name, and a function that makes an input from a seed.
type Set = (&'static str, fn(u64) -> Replan);

const SETS: [Set; 4] = [
    ("ordinary sizes, from rest", |seed| {
        ordinary(&mut Random(seed), false)
    }),
    ("ordinary sizes, moving", |seed| ordinary(&mut Random(seed), true)),
    ("servo axes in any unit, from rest", |seed| {
        any_unit(&mut Random(seed), false)
    }),
    ("servo axes in any unit, moving", |seed| {
        any_unit(&mut Random(seed), true)
    }),
];

fn main() -> ExitCode {
    // Cargo adds `--bench`.
    let inputs = std::env::args()
        .skip(1)
        .find(|argument| !argument.starts_with("--"));
    let Ok(inputs) = inputs.map_or(Ok(100_000), |count| count.parse::<u64>()) else {
        eprintln!("INPUTS must be a whole number");
        return ExitCode::from(2);
    };
    let clock = clock();
    println!("{inputs} inputs a set, {ROUNDS} rounds; reading the clock, {clock:.0} ns, is subtracted\n");
    for (name, draw) in SETS {
        let moves: Vec<Replan> = (0..inputs).map(draw).collect();
        report(name, &moves, clock);
    }
    ExitCode::SUCCESS
}

/// Times one set and prints its table.
fn report(name: &str, moves: &[Replan], clock: f64) {
    let inputs: Vec<InputParameter<1>> = moves.iter().map(theirs).collect();
    let mut otg = Ruckig::<1, ThrowErrorHandler>::new(None, CYCLE);
    let mut trajectory = Trajectory::new(None);
    let mut rows = [(); 3].map(|()| vec![f64::INFINITY; moves.len()]);
    let mut samples = [(); 3].map(|()| vec![f64::INFINITY; moves.len()]);
    let mut failures = [0_u64; 3];
    let mut durations = vec![[f64::NAN; 2]; moves.len()];
    for round in 0..ROUNDS {
        for input in inputs.iter().take(WARM_UP) {
            black_box(&otg.calculate(black_box(input), &mut trajectory));
        }
        for (index, input) in inputs.iter().enumerate() {
            let (took, planned) = time(|| otg.calculate(black_box(input), &mut trajectory));
            least(&mut rows[0], index, took - clock);
            if planned.is_err() {
                failures[0] += u64::from(round == 0);
                continue;
            }
            durations[index][0] = trajectory.get_duration();
            least(&mut samples[0], index, sample_theirs(&trajectory, clock));
        }
        for (row, order) in [(1, Order::Three), (2, Order::Four)] {
            for request in moves.iter().take(WARM_UP) {
                black_box(&black_box(request).plan(order));
            }
            for (index, request) in moves.iter().enumerate() {
                let (took, planned) = time(|| black_box(request).plan(order));
                least(&mut rows[row], index, took - clock);
                let Ok(plan) = planned else {
                    failures[row] += u64::from(round == 0);
                    continue;
                };
                if order == Order::Three {
                    durations[index][1] = plan.duration();
                }
                least(&mut samples[row], index, sample_ours(&plan, clock));
            }
        }
    }
    println!("{name}");
    println!(
        "  {:<24} {:>8} {:>8} {:>8} {:>9} {:>8} {:>9}",
        "ns", "median", "p99.9", "largest", "of seed", "sample", "failures"
    );
    let yardstick = sorted(&rows[0])[moves.len() / 2];
    for (index, planner) in ["rsruckig, order 3", "ours, order 3", "ours, order 4"]
        .into_iter()
        .enumerate()
    {
        let times = sorted(&rows[index]);
        let median = times[times.len() / 2];
        let largest = times[times.len() - 1];
        let seed = rows[index].iter().position(|time| *time == largest).unwrap_or(0);
        let sample = sorted(&samples[index])[times.len() / 2];
        println!(
            "  {planner:<24} {median:>8.0} {:>8.0} {largest:>8.0} {seed:>9} {sample:>8.1} {:>9}   {:.2}",
            times[times.len() * 999 / 1000],
            failures[index],
            median / yardstick,
        );
    }
    let longer = |one: usize, other: usize| {
        durations
            .iter()
            .filter(|pair| pair[one] > pair[other] * (1.0 + SAME))
            .count()
    };
    println!(
        "  durations at order 3: rsruckig's longer in {}, ours in {}\n",
        longer(0, 1),
        longer(1, 0)
    );
}

/// Nanoseconds of one call, and its result.
fn time<T>(run: impl FnOnce() -> T) -> (f64, T) {
    let start = Instant::now();
    let result = run();
    black_box(&result);
    (start.elapsed().as_nanos() as f64, result)
}

/// The time that [`time`] reports for an empty call: the median of many.
fn clock() -> f64 {
    let times: Vec<f64> = (0..10_001).map(|_| time(|| ()).0).collect();
    sorted(&times)[times.len() / 2]
}

fn least(times: &mut [f64], index: usize, took: f64) {
    times[index] = times[index].min(took);
}

fn sorted(values: &[f64]) -> Vec<f64> {
    let mut values = values.to_vec();
    values.sort_by(f64::total_cmp);
    values
}

fn theirs(request: &Replan) -> InputParameter<1> {
    let mut input = InputParameter::new(None);
    input.current_position[0] = request.start.position;
    input.current_velocity[0] = request.start.velocity;
    input.current_acceleration[0] = request.start.acceleration;
    input.target_position[0] = request.target;
    input.max_velocity[0] = request.limits.velocity;
    input.max_acceleration[0] = request.limits.acceleration;
    input.max_jerk[0] = request.limits.jerk;
    input
}

/// Nanoseconds of one of some samples spread over a plan.
fn sample_theirs(trajectory: &Trajectory<1>, clock: f64) -> f64 {
    let [mut position, mut velocity, mut acceleration, mut jerk] =
        [(); 4].map(|()| DataArrayOrVec::new(None, 0.0));
    let step = trajectory.get_duration() / f64::from(SAMPLES);
    let (took, ()) = time(|| {
        for sample in 0..SAMPLES {
            black_box(trajectory).at_time(
                black_box(f64::from(sample) * step),
                &mut Some(&mut position),
                &mut Some(&mut velocity),
                &mut Some(&mut acceleration),
                &mut Some(&mut jerk),
                &mut None,
            );
            black_box((&position, &velocity, &acceleration, &jerk));
        }
    });
    (took - clock) / f64::from(SAMPLES)
}

fn sample_ours(plan: &OnlinePlan, clock: f64) -> f64 {
    let scans = u64::from(plan.scans());
    let (took, ()) = time(|| {
        for sample in 0..u64::from(SAMPLES) {
            black_box(&black_box(plan).at(black_box(sample * scans / u64::from(SAMPLES))));
        }
    });
    (took - clock) / f64::from(SAMPLES)
}

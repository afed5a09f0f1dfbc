//! Workloads for counting instructions: each runs its operation inside `one_operation`, so that
//! `valgrind --tool=callgrind --toggle-collect='*one_operation*'` counts nothing else. Prints how many
//! operations ran. `.ci/instructions` compares the counts with the committed ones.

use standstill_bench::{
    CYCLE, Executed, IN_MOTION, LIMITS, ManyAxes, Move, OneAxis, Random, TARGET, Trapezoid, any_unit, servo,
};
use standstill_planner::{GridPlan, Method, Order, RampPlan, Setpoint};
use std::hint::black_box;
use std::ops::Range;
use std::process::ExitCode;

/// The seed of the move with the most search steps among a million, found by `worst_plan.rs`.
const WORST: u64 = 471_978;

/// The seeds of the replans of order 3 and 4 with the most root steps and ramps among a million, found by
/// `worst_replan.rs`.
const WORST_REPLANS: [u64; 2] = [614_139, 584_384];

/// Scans counted of an axis at rest.
const IDLE: u64 = 1000;

/// Random plans counted.
const PLANS: u64 = 1000;

/// The counted work runs below this function.
#[inline(never)]
fn one_operation<T>(run: impl FnOnce() -> T) {
    black_box(&run());
}

/// A name, and a function that runs the operation and returns how often it did.
type Workload = (&'static str, fn() -> u64);

const WORKLOADS: [Workload; 20] = [
    ("trapezoid-sample", trapezoid_sample),
    ("idle-scan", idle_scan),
    ("scan-in-motion", scan_in_motion),
    ("scan-that-plans", scan_that_plans),
    ("executor-idle-scan", executor_idle_scan),
    ("executor-scan-in-motion", executor_scan_in_motion),
    ("scan-of-64-in-motion", || {
        scan_of_many(ManyAxes::in_motion(Some(0)).expect("valid"))
    }),
    ("scan-of-64-half-in-gear", || {
        scan_of_many(ManyAxes::in_chains().expect("valid"))
    }),
    ("scan-of-64-half-on-cams", || {
        scan_of_many(ManyAxes::on_cams().expect("valid"))
    }),
    ("scan-of-64-mixed", || {
        scan_of_many(ManyAxes::in_motion(None).expect("valid"))
    }),
    ("plan-sample", plan_sample),
    ("plan", plan),
    ("worst-plan", worst_plan),
    ("ramp-sample", ramp_sample),
    ("ramp-plan", ramp_plan),
    ("replan-order-3", || replans(Order::Three, 0..PLANS)),
    ("replan-order-4", || replans(Order::Four, 0..PLANS)),
    ("worst-replan-order-3", || worst_replan(Order::Three)),
    ("worst-replan-order-4", || worst_replan(Order::Four)),
    ("replan-sample", replan_sample),
];

fn main() -> ExitCode {
    let names = || WORKLOADS.map(|(name, _)| name).join("\n");
    match std::env::args().nth(1) {
        None => {
            println!("{}", names());
            ExitCode::SUCCESS
        }
        Some(wanted) => match WORKLOADS.iter().find(|(name, _)| *name == wanted) {
            Some((_, run)) => {
                println!("{}", run());
                ExitCode::SUCCESS
            }
            None => {
                eprintln!("there is no workload {wanted}; there are:\n{}", names());
                ExitCode::from(2)
            }
        },
    }
}

fn trapezoid_sample() -> u64 {
    let plan = Trapezoid::new(0.0, TARGET, LIMITS.velocity, 1.0);
    let scans = (plan.duration() / CYCLE) as u64;
    for scan in 0..scans {
        let t = scan as f64 * CYCLE;
        one_operation(|| black_box(&plan).at(black_box(t)));
    }
    scans
}

fn idle_scan() -> u64 {
    let mut axis = OneAxis::at_rest().expect("valid");
    for _ in 0..IDLE {
        one_operation(|| black_box(&mut axis).scan());
    }
    IDLE
}

fn scan_in_motion() -> u64 {
    let (mut axis, scans) = OneAxis::in_motion().expect("valid");
    for _ in 0..scans {
        one_operation(|| black_box(&mut axis).scan());
    }
    scans
}

fn scan_that_plans() -> u64 {
    let mut axis = OneAxis::at_rest().expect("valid");
    axis.to_target.inputs.execute = true;
    one_operation(|| black_box(&mut axis).scan());
    1
}

fn executor_idle_scan() -> u64 {
    let mut rig = Executed::at_rest().expect("valid");
    for _ in 0..IDLE {
        one_operation(|| black_box(&mut rig).scan());
    }
    IDLE
}

fn executor_scan_in_motion() -> u64 {
    let (mut rig, scans) = Executed::in_motion().expect("valid");
    for _ in 0..scans {
        one_operation(|| black_box(&mut rig).scan());
    }
    scans
}

fn scan_of_many(mut axes: ManyAxes) -> u64 {
    for _ in 0..IN_MOTION {
        one_operation(|| black_box(&mut axes).scan());
    }
    IN_MOTION
}

fn one_plan(seed: u64) {
    let Move {
        start,
        target,
        limits,
        cycle,
    } = black_box(servo(&mut Random(seed)));
    one_operation(|| GridPlan::new(Method::Overlapped, start, target, &limits, cycle));
}

fn plan() -> u64 {
    (0..PLANS).for_each(one_plan);
    PLANS
}

fn worst_plan() -> u64 {
    one_plan(WORST);
    1
}

fn replans(order: Order, seeds: Range<u64>) -> u64 {
    let count = seeds.end - seeds.start;
    for seed in seeds {
        let request = any_unit(&mut Random(seed), true);
        one_operation(|| black_box(&request).plan(order));
    }
    count
}

fn worst_replan(order: Order) -> u64 {
    let [third, fourth] = WORST_REPLANS;
    let seed = if order == Order::Three { third } else { fourth };
    replans(order, seed..seed + 1)
}

fn replan_sample() -> u64 {
    let plan = any_unit(&mut Random(0), true).plan(Order::Four).expect("valid");
    for scan in 0..u64::from(plan.scans()) {
        one_operation(|| black_box(&plan).at(black_box(scan)));
    }
    u64::from(plan.scans())
}

/// The move of all measures.
fn to_target() -> GridPlan {
    GridPlan::new(Method::Overlapped, 0.0, TARGET, &LIMITS, CYCLE).expect("valid")
}

fn plan_sample() -> u64 {
    let plan = to_target();
    for scan in 0..u64::from(plan.scans()) {
        one_operation(|| black_box(&plan).at(black_box(scan)));
    }
    u64::from(plan.scans())
}

fn ramp_sample() -> u64 {
    let start = Setpoint::at_rest(0.0);
    let plan = RampPlan::new(&start, LIMITS.velocity, &LIMITS, &LIMITS, CYCLE).expect("valid");
    for scan in 0..u64::from(plan.scans()) {
        one_operation(|| black_box(&plan).at(black_box(scan)));
    }
    u64::from(plan.scans())
}

fn ramp_plan() -> u64 {
    let plan = to_target();
    let scans = u64::from(plan.scans()) - 1;
    for scan in 1..=scans {
        let start = plan.at(scan);
        one_operation(|| RampPlan::new(black_box(&start), 0.0, &LIMITS, &LIMITS, CYCLE));
    }
    scans
}

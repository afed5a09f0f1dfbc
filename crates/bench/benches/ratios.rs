//! Times of the scan path as multiples of one sample of a plain trapezoid, timed in the same run.
//!
//! Prints a table with the bars of docs/performance.md and marks values above their bar. The bars are multiples of
//! a sample computed from its parameters; the multiples of a sample planned before are shown too.

use standstill_axis::ConfigError;
use standstill_bench::{
    AXES, CYCLE, Executed, IN_MOTION, LIMITS, ManyAxes, Move, OneAxis, Random, TARGET, Trapezoid, WAYS,
    servo, trapezoid,
};
use standstill_drives::mechanism::{Gains, Load, Mechanism, Plant, Servo, SetPoint};
use standstill_planner::{GridPlan, Method, RampPlan, Setpoint};
use std::hint::black_box;
use std::time::Instant;

/// Rounds in which every measure is taken once; the median over them is reported.
const ROUNDS: usize = 101;

/// A measure: its name, the most yardsticks it may take, and one timed batch (ns for one operation).
struct Measure {
    name: &'static str,
    bar: Option<f64>,
    batch: Box<dyn FnMut() -> f64>,
}

/// Nanoseconds of one of `count` operations.
fn time(count: u64, run: impl FnOnce()) -> f64 {
    let start = Instant::now();
    run();
    start.elapsed().as_nanos() as f64 / count as f64
}

fn main() {
    let mut planned = trapezoid_sample();
    let mut yardstick = trapezoid_from_parameters();
    let mut measures = vec![
        Measure {
            name: "trapezoid sample, planned before",
            bar: None,
            batch: Box::new(trapezoid_sample()),
        },
        Measure {
            name: "trapezoid sample from its parameters (the yardstick)",
            bar: None,
            batch: Box::new(trapezoid_from_parameters()),
        },
        Measure {
            name: "scan in motion: axis, MC_Power, MC_MoveAbsolute",
            bar: Some(4.5),
            batch: Box::new(scan_in_motion()),
        },
        Measure {
            name: "the same scan through executor, machine and drive",
            bar: None,
            batch: Box::new(executor_scan_in_motion()),
        },
        Measure {
            name: "scan of 64 axes in mixed motion, per axis",
            bar: Some(8.0),
            batch: Box::new(scan_of_many(ManyAxes::in_motion(None))),
        },
        Measure {
            name: "scan of 64 axes, 32 of them slaves in chains of 4, per axis",
            bar: None,
            batch: Box::new(scan_of_many(ManyAxes::in_chains())),
        },
        Measure {
            name: "scan of a mechanism and its loops, a load on a spring",
            bar: Some(20.0),
            batch: Box::new(mechanism_scan()),
        },
        Measure {
            name: "sample of a rest-to-rest plan",
            bar: Some(6.0),
            batch: Box::new(grid_sample()),
        },
        Measure {
            name: "rest-to-rest plan, order 4, random moves",
            bar: Some(60.0),
            batch: Box::new(grid_plan()),
        },
        Measure {
            name: "sample of a ramp",
            bar: None,
            batch: Box::new(ramp_sample()),
        },
        Measure {
            name: "ramp to rest, order 4, from any scan of a move",
            bar: None,
            batch: Box::new(ramp_plan()),
        },
    ];
    // The parts of the mixture.
    measures.extend(WAYS.iter().enumerate().map(|(way, name)| Measure {
        name,
        bar: None,
        batch: Box::new(scan_of_many(ManyAxes::in_motion(Some(way)))),
    }));
    let mut times = vec![Vec::new(); measures.len()];
    let mut ratios = vec![Vec::new(); measures.len()];
    let mut planned_ratios = vec![Vec::new(); measures.len()];
    for _ in 0..ROUNDS {
        for (index, measure) in measures.iter_mut().enumerate() {
            // Close together in time, so that a busy machine slows both.
            let before = (planned(), yardstick());
            let took = (measure.batch)();
            let after = (yardstick(), planned());
            times[index].push(took);
            ratios[index].push(took / (0.5 * (before.1 + after.0)));
            planned_ratios[index].push(took / (0.5 * (before.0 + after.1)));
        }
    }
    println!(
        "{:<56} {:>9} {:>7} {:>7} {:>5}",
        "", "ns", "planned", "ratio", "bar"
    );
    for (index, measure) in measures.iter().enumerate() {
        let ratio = median(&mut ratios[index]);
        println!(
            "{:<56} {:>9.2} {:>7.2} {ratio:>7.2} {:>5}{}",
            measure.name,
            median(&mut times[index]),
            median(&mut planned_ratios[index]),
            measure.bar.map_or(String::from("-"), |bar| bar.to_string()),
            if measure.bar.is_some_and(|bar| ratio > bar) {
                "  ABOVE"
            } else {
                ""
            }
        );
    }
    println!("\nto a scan of one axis:");
    print_many("alone", true, ManyAxes::scan_alone);
    print_many("MC_Power and MC_MoveAbsolute", false, ManyAxes::scan);
}

/// Axes of the second table, and the most that one of them may cost, as a multiple of the cost of a single axis.
const MANY: [(u16, Option<f64>); 4] = [(1, None), (64, None), (512, Some(1.3)), (4096, Some(1.6))];

/// Prints the cost of one of many axes in the same move, relative to its cost in a scan of one axis.
fn print_many(what: &str, is_barred: bool, scan: fn(&mut ManyAxes)) {
    let mut batches = MANY.map(|(count, _)| scan_of_alike(count, scan));
    let mut times = MANY.map(|_| Vec::new());
    for _ in 0..ROUNDS {
        for (batch, times) in batches.iter_mut().zip(&mut times) {
            times.push(batch());
        }
    }
    let medians = times.map(|mut times| median(&mut times));
    for ((count, bar), took) in MANY.into_iter().zip(medians) {
        let ratio = took / medians[0];
        let bar = bar.filter(|_| is_barred);
        println!(
            "{:<56} {took:>9.2} {:>7} {ratio:>7.2} {:>5}{}",
            format!("scan of {count} axes, {what}, per axis"),
            "",
            bar.map_or(String::from("-"), |bar| bar.to_string()),
            if bar.is_some_and(|bar| ratio > bar) {
                "  ABOVE"
            } else {
                ""
            }
        );
    }
}

/// A few scans of `count` axes in the same move, in every round.
fn scan_of_alike(count: u16, scan: fn(&mut ManyAxes)) -> impl FnMut() -> f64 {
    let scans = (8192 / u64::from(count)).clamp(2, 40);
    let started = ManyAxes::in_a_move(count).expect("valid");
    let (mut axes, mut left) = (started.clone(), IN_MOTION);
    move || {
        if left <= scans {
            axes.clone_from(&started);
            left = IN_MOTION;
        }
        left -= scans + 1;
        // The measurement before has replaced the contents of the caches.
        scan(&mut axes);
        let took = time(scans * u64::from(count), || {
            for _ in 0..scans {
                scan(black_box(&mut axes));
            }
        });
        assert_eq!(axes.moving(), usize::from(count));
        took
    }
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// The yardstick over a whole move, scan by scan.
fn trapezoid_sample() -> impl FnMut() -> f64 {
    let plan = Trapezoid::new(0.0, TARGET, LIMITS.velocity, 1.0);
    let scans = (plan.duration() / CYCLE) as u64;
    move || {
        time(scans, || {
            for scan in 0..scans {
                black_box(&black_box(&plan).at(black_box(scan as f64 * CYCLE)));
            }
        })
    }
}

/// The same move with nothing computed before.
fn trapezoid_from_parameters() -> impl FnMut() -> f64 {
    let scans = (Trapezoid::new(0.0, TARGET, LIMITS.velocity, 1.0).duration() / CYCLE) as u64;
    move || time_parameters(scans)
}

// One copy of the code: otherwise the yardstick as a measure and as a yardstick could differ by where the compiler
// places them.
#[inline(never)]
fn time_parameters(scans: u64) -> f64 {
    time(scans, || {
        for scan in 0..scans {
            let t = black_box(scan as f64 * CYCLE);
            black_box(&trapezoid(
                black_box(TARGET),
                black_box(LIMITS.velocity),
                black_box(4.8),
                t,
            ));
        }
    })
}

fn scan_in_motion() -> impl FnMut() -> f64 {
    let (started, scans) = OneAxis::in_motion().expect("valid");
    move || {
        let mut axis = started.clone();
        let took = time(scans, || {
            for _ in 0..scans {
                black_box(&black_box(&mut axis).scan());
            }
        });
        assert!(axis.to_target.outputs.active);
        took
    }
}

fn executor_scan_in_motion() -> impl FnMut() -> f64 {
    let (started, scans) = Executed::in_motion().expect("valid");
    move || {
        let mut rig = started.clone();
        let took = time(scans, || {
            for _ in 0..scans {
                assert!(black_box(&black_box(&mut rig).scan()).is_ok());
            }
        });
        assert!(rig.program.to_target.outputs.active);
        took
    }
}

/// A few scans of all axes in every round, the whole motion over all rounds: longer batches would measure other
/// load of the machine.
fn scan_of_many(started: Result<ManyAxes, ConfigError>) -> impl FnMut() -> f64 {
    const SCANS: u64 = 7;
    let started = started.expect("valid");
    let (mut axes, mut left) = (started.clone(), IN_MOTION);
    move || {
        if left <= SCANS {
            (axes, left) = (started.clone(), IN_MOTION);
        }
        left -= SCANS + 1;
        // The measurement before has replaced the contents of the caches.
        axes.scan();
        let took = time(SCANS * u64::from(AXES), || {
            for _ in 0..SCANS {
                black_box(&mut axes).scan();
            }
        });
        assert_eq!(axes.moving(), usize::from(AXES));
        took
    }
}

/// A motor with both frictions and a load, following the move scan by scan.
fn mechanism_scan() -> impl FnMut() -> f64 {
    let plan = GridPlan::new(Method::Overlapped, 0.0, TARGET, &LIMITS, CYCLE).expect("valid");
    let set: Vec<SetPoint> = (1..=u64::from(plan.scans()))
        .map(|scan| plan.at(scan))
        .map(|set| SetPoint {
            position: set.position,
            velocity: set.velocity,
        })
        .collect();
    let plant = Plant {
        inertia: 0.02,
        viscous: 0.01,
        coulomb: 0.05,
        load: Some(Load {
            inertia: 0.05,
            stiffness: 200.0,
            damping: 0.02,
        }),
    };
    let mechanism = Mechanism::new(plant, 0.0, CYCLE).expect("valid");
    let started = Servo::new(mechanism, Gains::of(&plant, CYCLE), CYCLE).expect("valid");
    move || {
        let mut servo = started;
        time(set.len() as u64, || {
            for set in black_box(&set) {
                black_box(&mut servo).follow(*set);
            }
        })
    }
}

fn grid_sample() -> impl FnMut() -> f64 {
    let plan = GridPlan::new(Method::Overlapped, 0.0, TARGET, &LIMITS, CYCLE).expect("valid");
    let scans = u64::from(plan.scans());
    move || {
        time(scans, || {
            for scan in 0..scans {
                black_box(&black_box(&plan).at(black_box(scan)));
            }
        })
    }
}

fn grid_plan() -> impl FnMut() -> f64 {
    let mut random = Random(2026);
    let moves: Vec<Move> = (0..1024).map(|_| servo(&mut random)).collect();
    move || {
        time(moves.len() as u64, || {
            for Move {
                start,
                target,
                limits,
                cycle,
            } in black_box(&moves)
            {
                let plan = GridPlan::new(Method::Overlapped, *start, *target, limits, *cycle);
                assert!(black_box(&plan).is_ok());
            }
        })
    }
}

/// The set-points of a move to [`TARGET`].
fn setpoints() -> Vec<Setpoint> {
    let plan = GridPlan::new(Method::Overlapped, 0.0, TARGET, &LIMITS, CYCLE).expect("valid");
    (1..u64::from(plan.scans())).map(|scan| plan.at(scan)).collect()
}

fn ramp_sample() -> impl FnMut() -> f64 {
    let plan =
        RampPlan::new(&Setpoint::at_rest(0.0), LIMITS.velocity, &LIMITS, &LIMITS, CYCLE).expect("valid");
    let scans = u64::from(plan.scans());
    move || {
        time(scans, || {
            for scan in 0..scans {
                black_box(&black_box(&plan).at(black_box(scan)));
            }
        })
    }
}

fn ramp_plan() -> impl FnMut() -> f64 {
    let starts = setpoints();
    move || {
        time(starts.len() as u64, || {
            for start in black_box(&starts) {
                let plan = RampPlan::new(start, 0.0, &LIMITS, &LIMITS, CYCLE);
                assert!(black_box(&plan).is_ok());
            }
        })
    }
}

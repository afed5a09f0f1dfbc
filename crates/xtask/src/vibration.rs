//! `docs/vibration.md`: moves of one duration and three orders over one mechanism, compared.

use crate::{Generated, NOTICE};
use standstill_axis::Limits;
use standstill_drives::mechanism::{Gains, Load, Mechanism, Plant, Servo, SetPoint};
use standstill_planner::{GridPlan, Method};
use standstill_trace::svg;
use std::fmt::Write;

const CYCLE: f64 = 0.001;

/// Length of every move (rad).
const WAY: f64 = 1.0;

/// Scans looked at after the end.
const AFTER: u32 = 400;

/// Bands of the frequency of the load on its spring, the motor held (Hz).
const BANDS: [(f64, f64); 5] = [(3.0, 6.0), (6.0, 12.0), (12.0, 25.0), (25.0, 50.0), (50.0, 100.0)];

/// Frequencies tried in a band.
const TRIED: u32 = 24;

/// The frequency of the picture (Hz).
const SHOWN: f64 = 30.0;

const TWO_PI: f64 = core::f64::consts::TAU;

const PLANT: Plant = Plant {
    inertia: 0.02,
    viscous: 0.01,
    coulomb: 0.0,
    load: None,
};

const LOAD_INERTIA: f64 = 0.05;

/// What is compared: a name and limits with which the move takes 400 scans: way/v + v/a + a/j + j/s = 0.4 s.
const MOVES: [(&str, Limits); 3] = {
    const INF: f64 = f64::INFINITY;
    const fn limits(acceleration: f64, jerk: f64, snap: f64) -> Limits {
        Limits {
            velocity: 4.0,
            acceleration,
            deceleration: acceleration,
            jerk,
            snap,
        }
    }
    [
        ("trapezoid", limits(4.0 / 0.15, INF, INF)),
        ("jerk-limited", limits(4.0 / 0.11, 4.0 / 0.11 / 0.04, INF)),
        ("snap-limited", limits(40.0, 40.0 / 0.03, 40.0 / 0.03 / 0.02)),
    ]
};

/// What a move did to the mechanism.
struct Run {
    scans: u32,
    /// Largest torque of the motor.
    torque: f64,
    /// Largest distance of the motor from the set-point (rad).
    lag: f64,
    /// Largest distance of the load from the target after the end (rad).
    swing: f64,
    /// Load minus set-point, scan by scan (mrad).
    deviation: Vec<f64>,
}

fn run(limits: &Limits, frequency: f64) -> Run {
    let plan = GridPlan::new(Method::Overlapped, 0.0, WAY, limits, CYCLE).expect("a move");
    let rate = TWO_PI * frequency;
    let plant = Plant {
        load: Some(Load {
            inertia: LOAD_INERTIA,
            stiffness: LOAD_INERTIA * rate * rate,
            // A hundredth of critical damping.
            damping: 0.02 * LOAD_INERTIA * rate,
        }),
        ..PLANT
    };
    let mechanism = Mechanism::new(plant, 0.0, CYCLE).expect("a mechanism");
    let mut servo = Servo::new(mechanism, Gains::of(&plant, CYCLE), CYCLE).expect("gains");
    let mut run = Run {
        scans: plan.scans(),
        torque: 0.0,
        lag: 0.0,
        swing: 0.0,
        deviation: Vec::new(),
    };
    for scan in 1..=plan.scans() + AFTER {
        let set = plan.at(u64::from(scan));
        servo.follow(SetPoint {
            position: set.position,
            velocity: set.velocity,
        });
        let load = servo.mechanism().load_position();
        run.torque = run.torque.max(servo.torque().abs());
        run.lag = run.lag.max((set.position - servo.mechanism().position()).abs());
        if scan > plan.scans() {
            run.swing = run.swing.max((load - WAY).abs());
        }
        run.deviation.push(1e3 * (load - set.position));
    }
    run
}

pub fn pages() -> Vec<Generated> {
    let mut text = format!(
        "{NOTICE}# What a smoother profile does for a machine\n\n\
         Three moves of 1 rad in {} scans of 1 ms, one with steps of acceleration, one with limited jerk, one with limited\n\
         snap. They turn the same mechanism: a motor (0.02) and a load (0.05) on a spring, damped by 1 %, under the default\n\
         loops of a `plant` drive with full feed-forward. The experiment is in the manner of García-Martínez et al. (2018),\n\
         who compare profiles of one duration on one axis; the numbers are those of the simulation. Written by\n\
         `cargo run -p standstill-xtask --example gen`; a test keeps them fresh.\n\n\
         | profile | v | a | j | s |\n| --- | ---: | ---: | ---: | ---: |\n",
        run(&MOVES[0].1, SHOWN).scans
    );
    let number = |value: f64| {
        if value.is_finite() {
            format!("{value:.1}")
        } else {
            "-".into()
        }
    };
    for (name, limits) in &MOVES {
        let _ = writeln!(
            text,
            "| {name} | {} | {} | {} | {} |",
            number(limits.velocity),
            number(limits.acceleration),
            number(limits.jerk),
            number(limits.snap)
        );
    }
    text.push_str(
        "\n## Residual vibration, torque and tracking error\n\n\
         By the frequency of the load on its spring, the motor held; the worst of 24 frequencies in each band, because at a\n\
         single one chance decides: a ramp that lasts whole periods leaves nothing. *Swing* is the largest distance of the load\n\
         from the target after the last set-point (mrad), *torque* the largest of the motor, *lag* the largest distance of the\n\
         motor from its set-point (mrad).\n\n\
         | Hz | profile | swing | torque | lag |\n| ---: | --- | ---: | ---: | ---: |\n",
    );
    for (low, high) in BANDS {
        for (name, limits) in &MOVES {
            let (mut swing, mut torque, mut lag) = (0.0_f64, 0.0_f64, 0.0_f64);
            for index in 0..TRIED {
                let part = f64::from(index) / f64::from(TRIED);
                let run = run(limits, low + (high - low) * part);
                assert_eq!(run.scans, 400, "{name}: moves of one duration");
                swing = swing.max(run.swing);
                torque = torque.max(run.torque);
                lag = lag.max(run.lag);
            }
            let _ = writeln!(
                text,
                "| {low} to {high} | {name} | {:.3} | {torque:.2} | {:.3} |",
                1e3 * swing,
                1e3 * lag
            );
        }
    }
    let curves: Vec<_> = MOVES
        .iter()
        .map(|(name, limits)| (format!("{name} (mrad)"), run(limits, SHOWN).deviation))
        .collect();
    let _ = write!(
        text,
        "\nHow far the load is from the set-point at {} Hz, in one scale; the moves end at scan 400:\n\n\
         ![Load minus set-point of the three moves](pictures/vibration.svg)\n\n\
         ## What it says\n\n\
         - At equal duration a smoother profile needs a higher acceleration, because part of the time goes into its ramps, and\n  \
           so more torque where the load swings slowly.\n\
         - A load that swings less than some three times in a ramp of the velocity, here up to 25 Hz, sees little but the\n  \
           acceleration: the profile with the lowest one swings least. Limited jerk or snap is no help there; a lower\n  \
           acceleration, or ramps that last whole periods, are.\n\
         - For faster ones, here from 25 Hz, limited jerk leaves a fraction of the swing and the lag, because the loops can\n  \
           follow a torque without steps; where even the ramps of the jerk are slow for the load, here from 50 Hz, limited\n  \
           snap leaves the least.\n\
         - So limits that are good for a machine follow from its lowest frequency: [choosing limits](choosing-limits.md).\n",
        SHOWN
    );
    vec![
        Generated {
            path: "docs/vibration.md".into(),
            text,
        },
        Generated {
            path: "docs/pictures/vibration.svg".into(),
            text: svg::chart("Load minus set-point", 1_000_000, &curves),
        },
    ]
}

//! `docs/vibration.md`: moves of one duration and three orders over one mechanism, compared.

use crate::{Generated, NOTICE};
use standstill_axis::Limits;
use standstill_drives::mechanism::{Gains, Load, Mechanism, Plant, Servo, SetPoint};
use standstill_picture::chart;
use standstill_planner::{GridPlan, Method, ShaperKind, Shapers, VibrationMode};
use std::fmt::Write;

const CYCLE: f64 = 0.001;

/// Length of every move (rad).
const WAY: f64 = 1.0;

/// Scans after the end that are examined.
const AFTER: u32 = 400;

/// Bands of the frequency of the load on its spring, with the motor held (Hz).
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

/// The compared moves: a name, and limits with which the move takes 400 scans: way/v + v/a + a/j + j/s =
/// 0.4 s.
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

/// A move of the second part, whose load vibrates with [`SLOW`], shaped or not: its name, its method, and its
/// acceleration.
struct Slow {
    name: &'static str,
    shaper: Option<ShaperKind>,
    acceleration: f64,
}

/// The frequency of the load of the second part (Hz), for which the shapers are made.
const SLOW: f64 = 12.0;

/// Length of the moves of the second part (rad), and their scans.
const SLOW_WAY: f64 = 2.0;
const SLOW_SCANS: u32 = 1000;

/// Its other limits: velocity, and the time in which the acceleration is reached.
const SLOW_VELOCITY: f64 = 4.0;
const SLOW_RISE: f64 = 0.1;

/// Accelerations with which all of them take [`SLOW_SCANS`]: way/v + v/a + rise + shaper = 1 s.
const SLOW_MOVES: [Slow; 5] = [
    Slow {
        name: "jerk-limited",
        shaper: None,
        acceleration: 4.0 / 0.4,
    },
    Slow {
        name: "`zv`",
        shaper: Some(ShaperKind::Zv),
        acceleration: 4.0 / 0.358,
    },
    Slow {
        name: "`zvd`",
        shaper: Some(ShaperKind::Zvd),
        acceleration: 4.0 / 0.316,
    },
    Slow {
        name: "`ei`",
        shaper: Some(ShaperKind::Ei),
        acceleration: 4.0 / 0.316,
    },
    Slow {
        name: "`period`",
        shaper: Some(ShaperKind::Period),
        acceleration: 4.0 / 0.317,
    },
];

/// Differences between the frequency of the load and that of the shapers (%).
const OFF: [i32; 7] = [-20, -10, -5, 0, 5, 10, 20];

/// The effect of a move on the mechanism.
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
    run_shaped(WAY, limits, &Shapers::default(), frequency)
}

fn slow_run(of: &Slow, frequency: f64) -> Run {
    let mode = of.shaper.map(|shaper| VibrationMode {
        frequency: SLOW,
        damping: 0.01,
        shaper,
    });
    let shapers = Shapers::new(&[mode, None], CYCLE).expect("a mode");
    let limits = Limits {
        velocity: SLOW_VELOCITY,
        acceleration: of.acceleration,
        deceleration: of.acceleration,
        jerk: of.acceleration / SLOW_RISE,
        snap: f64::INFINITY,
    };
    run_shaped(SLOW_WAY, &limits, &shapers, frequency)
}

fn run_shaped(way: f64, limits: &Limits, shapers: &Shapers, frequency: f64) -> Run {
    let plan = GridPlan::new(Method::Overlapped, 0.0, way, limits, CYCLE).expect("a move");
    let scans = shapers.scans(plan.scans());
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
        scans,
        torque: 0.0,
        lag: 0.0,
        swing: 0.0,
        deviation: Vec::new(),
    };
    for scan in 1..=scans + AFTER {
        let set = shapers.at(u64::from(scan), |scan| plan.at(scan));
        servo.follow(SetPoint {
            position: set.position,
            velocity: set.velocity,
        });
        let load = servo.mechanism().load_position();
        run.torque = run.torque.max(servo.torque().abs());
        run.lag = run.lag.max((set.position - servo.mechanism().position()).abs());
        if scan > scans {
            run.swing = run.swing.max((load - way).abs());
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
         loops of a `plant` drive with full feed-forward. The experiment follows García-Martínez et al. (2018), who\n\
         compare profiles of one duration on one axis; the numbers are those of the simulation. Written by\n\
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
         The bands are frequencies of the load on its spring, with the motor held. Each row is the worst of 24 frequencies in\n\
         its band, because a single one depends on chance: a ramp that lasts whole periods leaves nothing. *Swing* is the largest distance of the load\n\
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
         - At equal duration a smoother profile needs a higher acceleration, because its ramps take part of the time. So it\n  \
           needs more torque if the load swings slowly.\n\
         - A load that swings less than about three times during a ramp of the velocity, here up to 25 Hz, reacts mainly to the\n  \
           acceleration: the profile with the lowest acceleration swings least. Limited jerk or snap does not help there. A\n  \
           lower acceleration helps, and so do ramps that last whole periods.\n\
         - For faster loads, here from 25 Hz, limited jerk leaves a fraction of the swing and the lag, because the loops can\n  \
           follow a torque without steps. If even the ramps of the jerk are slow for the load, here from 50 Hz, limited snap\n  \
           leaves the least.\n\
         - So limits that are good for a machine follow from its lowest frequency: [choosing limits](choosing-limits.md).\n",
        SHOWN
    );
    text.push_str(&shaped());
    let slow_curves: Vec<_> = SLOW_MOVES
        .iter()
        .map(|of| {
            (
                format!("{} (mrad)", of.name.replace('`', "")),
                slow_run(of, SLOW).deviation,
            )
        })
        .collect();
    vec![
        Generated {
            path: "docs/pictures/vibration-shaped.svg".into(),
            text: chart("Load minus set-point, shaped", 1_000_000, &slow_curves),
        },
        Generated {
            path: "docs/vibration.md".into(),
            text,
        },
        Generated {
            path: "docs/pictures/vibration.svg".into(),
            text: chart("Load minus set-point", 1_000_000, &curves),
        },
    ]
}

/// The second part: the same load, and moves that are shaped for it.
fn shaped() -> String {
    let mut text = String::from(SHAPED);
    let _ = write!(text, "| shaper | a | torque |");
    for off in OFF {
        let _ = write!(text, " {off} % |");
    }
    text.push_str("\n| --- | ---: | ---: |");
    text.push_str(&" ---: |".repeat(OFF.len()));
    text.push('\n');
    for of in &SLOW_MOVES {
        let name = if of.shaper.is_some() {
            of.name
        } else {
            "none, jerk-limited"
        };
        let _ = write!(
            text,
            "| {name} | {:.1} | {:.2} |",
            of.acceleration,
            slow_run(of, SLOW).torque
        );
        for off in OFF {
            let run = slow_run(of, SLOW * (1.0 + f64::from(off) / 100.0));
            assert_eq!(run.scans, SLOW_SCANS, "{}: moves of one duration", of.name);
            let _ = write!(text, " {:.3} |", 1e3 * run.swing);
        }
        text.push('\n');
    }
    text.push_str(AFTER_SHAPED);
    text
}

const SHAPED: &str = "
## Moves without swing

An axis with the key `vibration` publishes a weighted mean of its motion now and some scans before. Weights and delays
are chosen so that the vibrations excited by the parts cancel. The axis keeps every limit and ends exactly on the
target, half a period or a whole one later. `standstill identify` finds frequency and damping in a recording of the
vibrating machine
([command-line.md](command-line.md#identify-trace---signal-name---from-time---to-time---time-name---unit-unit---json)).

```text
\"axes\": {\"X\": {\"limits\": {..}, \"vibration\": [{\"frequency\": 12, \"damping\": 0.02, \"shaper\": \"ei\"}]}}
```

| shaper | takes | for |
| --- | --- | --- |
| `zv` | half a period | a frequency that is known exactly: the least time |
| `zvd` | a period | one that is known to about 10 % |
| `ei`, the default | a period | one that is known to about 15 %; leaves 3 % of the swing at the exact frequency |
| `period` | a period | a frequency without damping and its multiples; leaves nothing if the period is a whole number of scans |

The list may have two modes; their delays add up. Damping is 0 if absent. The example is the mechanism above with a
load that swings at 12 Hz, damped by 1 %, and moves of 2 rad in 1000 scans. One move has limited jerk, the others are
shaped, with an acceleration *a* for which all take the same time. Each column is a deviation of the load's frequency
from that of the shapers, with the swing that is left (mrad). The swing at 0 % is there because the motor gives way a
little.

";

const AFTER_SHAPED: &str = "
![Load minus set-point of the five moves at 12 Hz: after scan 1000 the jerk-limited one swings on, the shaped ones rest](pictures/vibration-shaped.svg)

Lines of `standstill plan`: the move before it is shaped, and through three shapers of 12 Hz.

```jsonl
{\"id\": \"plain\", \"Ts\": 0.001, \"target\": 2, \"limits\": {\"velocity\": 4, \"acceleration\": 20, \"jerk\": 400}}
{\"id\": \"zv\", \"Ts\": 0.001, \"target\": 2, \"limits\": {\"velocity\": 4, \"acceleration\": 20, \"jerk\": 400}, \"vibration\": [{\"frequency\": 12, \"shaper\": \"zv\"}]}
{\"id\": \"ei\", \"Ts\": 0.001, \"target\": 2, \"limits\": {\"velocity\": 4, \"acceleration\": 20, \"jerk\": 400}, \"vibration\": [{\"frequency\": 12}]}
{\"id\": \"period\", \"Ts\": 0.001, \"target\": 2, \"limits\": {\"velocity\": 4, \"acceleration\": 20, \"jerk\": 400}, \"vibration\": [{\"frequency\": 12, \"shaper\": \"period\"}]}
```

![Position to jerk of the four plans over time: the shaped ones end later, and their acceleration goes up in steps or in a long ramp](pictures/plan-shaped.svg)

## What a shaped axis does

- **Done is exact.** A command is Done when nothing of it is left in the shaper: position on the target, velocity 0.
  InVelocity comes when the velocity is published. A buffered command starts then. A blended command starts when the
  motion passes the end, which is before the published position does.
- **A command that takes over**, also a stop or a fault, acts on the motion at once and shows at once, but the
  contents of the shaper are published first. So the axis comes to rest later, by the delay of the shapers, and
  further on. Consider this if the axis must stop at a switch.
- **Override, blending, superimposed moves, MC_Jog, homing, MC_SetPosition, profiles, modulo axes** work as on any
  axis. Distances count from the position of the motion before the shaper, which is ahead of the published one.
- **Switched off** with `on_power_off` `ramp`, the power stays on until the published set-point is at rest. With
  `coast` and `drive`, and after faults of power or drive, the set-point follows the axis at once, and the shaper is
  empty.
- **Refused** with ErrorID 222: MC_GearIn, MC_GearInPos, MC_CamIn and MC_CombineAxes of a shaped slave, or of a shaped master's set
  values (its actual values may be followed), and MC_TorqueControl.
- **One rate.** `limits.deceleration` must equal `limits.acceleration`: a mean of motions in two directions would keep
  neither of two rates. Commands may have two. A higher `stop.deceleration` may appear while the speed still grows, if
  the stop comes within one delay after a reversal.
- **Software limits** hold for the motion before it is shaped, and so for the published positions. If a limit is
  written in motion, the contents of the shaper are still published, even beyond it. After a motion that begins
  outside, the published position may go out once more, never further than it was, until the shaper holds no position
  outside.
- **Parameters.** Modes are read by number ([parameters.md](parameters.md)), and written while the axis is at rest,
  or queued behind a move that ends. A frequency may be as low as half of the configured one, because the memory is
  sized for that.
- A period has 4 to 4096 cycles. In each scan a shaped axis computes one set-point for each part of its shapers: 2 or
  4, and for `period` as many as the period has scans ([how it works](planner.md#15-moves-without-swing), [why
  so](decisions/0018-a-filter-behind-the-motion.md)).
";

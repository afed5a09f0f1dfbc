//! Every kind of motion with every fault of a drive, in random order.

mod lies;
mod rig;

use rig::{Random, Rig, STEP, Upset};
use standstill_axis::{
    Axis, AxisState, BufferMode, Command, Direction, Dynamics, ErrorId, ExecutionMode, Factors, Fate,
    ParameterValue, Permission, Profile, ProfileKind, ProfileRow, Request, Scope, Superimpose,
};

/// The motions to try. Each is refused where the state does not allow it.
const MOTIONS: [&str; 15] = [
    "endless",
    "absolute",
    "relative",
    "additive",
    "continuous",
    "jog",
    "halt",
    "stop",
    "superimposed",
    "blended",
    "profile",
    "torque",
    "home",
    "override",
    "update",
];

fn dynamics(random: &mut Random) -> Dynamics {
    Dynamics {
        velocity: 1.0 + 99.0 * random.unit(),
        acceleration: if random.below(3) == 0 { 500.0 } else { 0.0 },
        ..Dynamics::default()
    }
}

/// Whether the motion was accepted.
fn begin(name: &str, random: &mut Random, axis: &mut Axis, scope: &mut Scope<'_>) -> bool {
    let dynamics = dynamics(random);
    let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
    let distance = sign * 15.0 * random.unit() * random.unit();
    let direction = if sign > 0.0 {
        Direction::Positive
    } else {
        Direction::Negative
    };
    let endless = Command::MoveVelocity {
        dynamics,
        direction: direction.into(),
    };
    let relative = Command::MoveRelative { distance, dynamics };
    let command = match name {
        "endless" => endless,
        "absolute" => Command::MoveAbsolute {
            position: distance,
            dynamics,
            direction: Direction::Unset.into(),
        },
        "additive" => Command::MoveAdditive { distance, dynamics },
        "continuous" => Command::MoveContinuousRelative {
            distance,
            end_velocity: 0.5 * sign * dynamics.velocity,
            dynamics,
        },
        "jog" => Command::Jog {
            forward: sign > 0.0,
            distance: if random.below(2) == 0 { 0.0 } else { distance.abs() },
            dynamics,
        },
        "halt" => Command::Halt { dynamics },
        "stop" => Command::Stop { dynamics },
        "torque" => Command::Torque {
            torque: sign * 10.0 * random.unit(),
            ramp: if random.below(2) == 0 { 0.0 } else { 100.0 },
            dynamics,
            direction: Direction::Unset.into(),
        },
        "home" => Command::Home { position: distance },
        "superimposed" => {
            let request = Superimpose { distance, dynamics };
            return axis.superimpose(&request, scope).is_ok();
        }
        "profile" => {
            let row = |delta_ns, value| ProfileRow {
                delta_ns,
                value,
                level: false,
            };
            let rows = [
                row(100_000_000, 1.0),
                row(100_000_000, 3.0),
                row(200_000_000, 2.0),
            ];
            let profile = Profile {
                kind: ProfileKind::Position,
                rows: &rows,
                time_scale: 1.0,
                scale: sign,
                offset: axis.setpoint().position,
            };
            return axis.profile(&profile, BufferMode::Aborting.into(), scope).is_ok();
        }
        "override" => {
            let factors = Factors {
                velocity: random.below(5) as f64 / 4.0,
                acceleration: 0.5 + 0.5 * random.unit(),
                jerk: 1.0,
            };
            return axis.set_override(factors, scope).is_ok();
        }
        "update" => {
            let Some(active) = axis.active_command() else {
                return false;
            };
            let command = if axis.state() == AxisState::ContinuousMotion {
                endless
            } else {
                relative
            };
            return axis.update(active, &command, scope).is_ok();
        }
        _ => relative,
    };
    let modes = [
        BufferMode::Buffered,
        BufferMode::BlendingLow,
        BufferMode::BlendingPrevious,
        BufferMode::BlendingNext,
        BufferMode::BlendingHigh,
    ];
    let buffer_mode = if name == "blended" {
        modes[random.below(5) as usize]
    } else {
        BufferMode::Aborting
    };
    let request = Request {
        buffer_mode: buffer_mode.into(),
        ..Request::aborting(command)
    };
    axis.command(&request, scope).is_ok()
}

/// What may go wrong: 0 a fault, 1 the supply, 2 the communication, 3 MC_Power off, 4 an axis fault, 5 a following
/// error above the largest, 6 a drive that does not obey, 7 a direction that MC_Power bars. Limit switches, stops
/// and software limits occur without being planned.
///
/// A schedule is a sequence of motions, with an event in the middle of most of them, and the recovery. An axis that
/// takes an arrow that the state machine does not have fails a debug assertion.
fn schedule(seed: u64, is_plant: bool, met: &mut [[u32; 8]; MOTIONS.len()]) -> f64 {
    let random = &mut Random(seed);
    let mut rig = Rig::new(random, is_plant);
    for _ in 0..3 {
        let first = random.below(MOTIONS.len() as u64) as usize;
        let upset = random.below(8) as usize;
        let when = 3 + random.below(80);
        let second = random.below(2 * when);
        let mut runs = false;
        for scan in 0..when + 60 {
            let mut power = true;
            let mut permitted = Permission::BOTH;
            if scan == when {
                met[first][upset] += u32::from(runs);
                match upset {
                    0 => rig.upset(Upset::Fault),
                    1 => rig.upset(Upset::Power),
                    2 => rig.upset(Upset::Communication),
                    _ => {}
                }
            } else if scan == when + 20 {
                rig.upset(Upset::Clear);
                rig.upset(Upset::Displace((random.below(20_000) as i32) - 10_000));
            }
            match upset {
                3 => power = !(when..when + 30).contains(&scan),
                7 if (when..when + 40).contains(&scan) => permitted.positive = false,
                6 if scan == when => rig.upset(Upset::Remote(false)),
                6 if scan == when + 40 => rig.upset(Upset::Remote(true)),
                _ => {}
            }
            rig.step(power, permitted, |axis, scope| {
                if scan == 2 {
                    let needs_owner = matches!(
                        MOTIONS[first],
                        "halt" | "stop" | "superimposed" | "blended" | "update" | "override"
                    );
                    if needs_owner {
                        begin("endless", random, axis, scope);
                    }
                    runs = begin(MOTIONS[first], random, axis, scope);
                } else if scan == second {
                    let other = MOTIONS[random.below(MOTIONS.len() as u64) as usize];
                    begin(other, random, axis, scope);
                }
                if scan == when {
                    match upset {
                        4 => axis.raise(ErrorId::AxisFault, 3, scope),
                        // Sets the supervision of a following error, or a limit, such that it is exceeded at once.
                        5 => drop(axis.write_parameter(
                            7,
                            ParameterValue::Real(1e-9),
                            ExecutionMode::Immediately.into(),
                            scope,
                        )),
                        _ => {}
                    }
                }
            });
        }
        rig.step(true, Permission::BOTH, |axis, scope| {
            let all = ParameterValue::Real(1e9);
            let mode = ExecutionMode::Immediately;
            let _ = axis.write_parameter(7, all, mode.into(), scope);
            let _ = axis.set_override(Factors::ONE, scope);
        });
        let recovered = rig.recovers();
        assert_eq!(recovered, Ok(()), "seed {seed}, {}", MOTIONS[first]);
        let mut taken = Err(ErrorId::None);
        rig.step(true, Permission::BOTH, |axis, scope| {
            // Away from a limit that it may have reached.
            let distance = -0.5_f64.copysign(axis.actual_position());
            let command = Command::MoveRelative {
                distance,
                dynamics: Dynamics::at(50.0),
            };
            taken = axis.command(&Request::aborting(command), scope);
        });
        for _ in 0..100 {
            rig.step(true, Permission::BOTH, |_, _| {});
        }
        let came_of_it = taken.map(|id| rig.axis.fate(id));
        // If MC_Home named a position far outside the software limits, only a move that ends inside is accepted.
        let is_outside = came_of_it == Err(ErrorId::TargetOutsideSoftwareLimits);
        assert!(
            came_of_it == Ok(Fate::Done) || is_outside,
            "seed {seed}: {came_of_it:?}"
        );
    }
    assert!(rig.worst <= STEP, "seed {seed}: {} u", rig.worst);
    rig.worst
}

/// Covers: CI-3, CI-5, CI-8, S10
fn schedules(seeds: core::ops::Range<u64>) {
    for is_plant in [false, true] {
        let mut met = [[0; 8]; MOTIONS.len()];
        let mut worst = 0.0_f64;
        for seed in seeds.clone() {
            worst = worst.max(schedule(seed, is_plant, &mut met));
        }
        for (name, row) in MOTIONS.iter().zip(&met) {
            println!("{name:12} {row:?}");
        }
        println!("largest step {worst} of {STEP}");
        let least = met.iter().flatten().min().copied().unwrap_or(0);
        assert!(least > 0, "every motion was met by everything");
        assert!(worst > 0.5 * STEP);
    }
}

#[test]
fn no_motion_steps_whatever_goes_wrong_and_each_is_recovered_from() {
    schedules(0..1_500);
}

#[test]
#[ignore = "the long form: 100,000 schedules, half of them of mechanisms"]
fn no_motion_steps_in_the_long_run() {
    schedules(0..50_000);
}

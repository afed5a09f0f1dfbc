//! The mechanism against independent formulas, and the drive over it.

use standstill_axis::{
    Axis, AxisConfig, AxisId, AxisState, Command, Drive, DrivePosition, Dynamics, Fate, Limits, Log,
    Permission, Request, Scaling, Scope, Standard,
};
use standstill_drives::mechanism::{
    Gains, Load, Mechanism, Plant, PlantDrive, SUBSTEPS, Servo, SetPoint, Stops,
};

const CYCLE: f64 = 0.001;

/// Seconds of one step.
const STEP: f64 = CYCLE / SUBSTEPS as f64;

const RIGID: Plant = Plant {
    inertia: 0.02,
    viscous: 0.0,
    coulomb: 0.0,
    load: None,
};

const ELASTIC: Plant = Plant {
    load: Some(Load {
        inertia: 0.05,
        stiffness: 200.0,
        damping: 0.0,
    }),
    ..RIGID
};

fn near(found: f64, expected: f64, within: f64) {
    assert!((found - expected).abs() <= within, "{found} is not {expected}");
}

#[test]
fn torque_accelerates_what_is_rigid() {
    let mut mechanism = Mechanism::new(RIGID, 3.0, CYCLE).unwrap();
    for _ in 0..1000 {
        mechanism.step(0.5);
    }
    let time = 1000.0 * STEP;
    near(mechanism.velocity(), 0.5 / 0.02 * time, 1e-12);
    near(mechanism.position(), 3.0 + 0.5 * 0.5 / 0.02 * time * time, 1e-12);
    near(mechanism.load_position(), mechanism.position(), 0.0);
}

#[test]
fn viscous_friction_has_a_final_velocity() {
    let plant = Plant {
        viscous: 0.1,
        ..RIGID
    };
    let mut mechanism = Mechanism::new(plant, 0.0, CYCLE).unwrap();
    // exp(-STEP * 0.1 / 0.02)
    let (decay, mut left) = (0.9987507809245809, 1.0);
    for _ in 0..8000 {
        mechanism.step(0.5);
        left *= decay;
        near(mechanism.velocity(), 5.0 * (1.0 - left), 1e-11);
    }
}

#[test]
fn a_load_on_a_spring_swings_with_its_frequency_and_loses_nothing() {
    let mut mechanism = Mechanism::new(ELASTIC, 0.0, CYCLE).unwrap();
    mechanism.step(1000.0);
    // Relative to the centre of mass both swing with sqrt(k (1/J1 + 1/J2)).
    let square = 200.0 * (1.0 / 0.02 + 1.0 / 0.05) * STEP * STEP;
    // The cosine of w T, by its series.
    let cosine = 1.0 - square / 2.0 * (1.0 - square / 12.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0)));
    let twist = |mechanism: &Mechanism| mechanism.position() - mechanism.load_position();
    let [first, second] = [0, 1].map(|_| {
        mechanism.step(0.0);
        twist(&mechanism)
    });
    // A swing obeys x(n+1) = 2 cos(w T) x(n) - x(n-1).
    let (mut before, mut last) = (first, second);
    let mut most = 0.0_f64;
    for _ in 0..400_000 {
        mechanism.step(0.0);
        let now = twist(&mechanism);
        near(now, 2.0 * cosine * last - before, 1e-12);
        (before, last) = (last, now);
        most = most.max(now.abs());
    }
    let late = (0..400).fold(0.0_f64, |most, _| {
        mechanism.step(0.0);
        most.max(twist(&mechanism).abs())
    });
    near(late / most, 1.0, 1e-3);
}

#[test]
fn a_stop_gives_back_what_it_took_and_no_more() {
    let hardest = RIGID.inertia / (STEP * STEP);
    let most_damping = RIGID.inertia / STEP;
    for (stiffness, damping) in [
        (hardest, 0.0),
        (0.3 * hardest, 0.0),
        (0.01 * hardest, 0.0),
        (hardest, most_damping),
        (0.01 * hardest, 0.1 * most_damping),
    ] {
        let stops = Stops {
            ends: (-0.02, 0.01),
            stiffness,
            damping,
        };
        let mechanism = Mechanism::new(RIGID, 0.0, CYCLE).unwrap();
        let mut mechanism = mechanism.between(stops, CYCLE).unwrap();
        let energy = |mechanism: &Mechanism| {
            let depth = mechanism.position() - mechanism.position().clamp(-0.02, 0.01);
            let velocity = mechanism.velocity();
            0.5 * (RIGID.inertia * velocity * velocity + stiffness * depth * depth)
        };
        mechanism.step(500.0);
        let first = energy(&mechanism);
        let mut before = first;
        for _ in 0..20_000 {
            mechanism.step(0.0);
            let now = energy(&mechanism);
            assert!(
                now <= before + 1e-9 * first,
                "{stiffness} {damping}: {now} {before}"
            );
            before = now;
        }
        if damping == 0.0 {
            near(before, first, 1e-6 * first);
        }
    }
}

#[test]
fn friction_takes_energy_from_a_load_on_any_spring_and_gives_none() {
    // The twist (rad) of the spring's swing in a step, beside the friction.
    for (angle, coulomb) in [
        (0.3, 1.0),
        (1.4, 7.0),
        (3.7, 0.2),
        (4.5, 1.1),
        (5.2, 7.6),
        (9.5, 4.1),
    ] {
        let load = Load {
            inertia: 1.7 * RIGID.inertia,
            stiffness: 0.63 * RIGID.inertia * (angle / STEP) * (angle / STEP),
            damping: 0.0,
        };
        let coulomb = 0.001 * coulomb;
        let plant = Plant {
            coulomb,
            load: Some(load),
            ..RIGID
        };
        let mut mechanism = Mechanism::new(plant, 0.0, CYCLE).unwrap();
        mechanism.step(1.0);
        // All the energy that went in.
        let first = mechanism.position();
        for _ in 0..20_000 {
            mechanism.step(0.0);
            let twist = mechanism.position() - mechanism.load_position();
            let velocity = mechanism.velocity();
            let part = 0.5 * (RIGID.inertia * velocity * velocity + load.stiffness * twist * twist);
            assert!(part <= first * (1.0 + 1e-6), "{angle} {coulomb}: {part} {first}");
        }
    }
}

#[test]
fn coulomb_friction_stops_a_motion_and_holds_it_to_the_bit() {
    let plant = Plant {
        coulomb: 0.3,
        ..RIGID
    };
    let mut mechanism = Mechanism::new(plant, 0.0, CYCLE).unwrap();
    // Less than friction moves nothing, not by rounding either.
    for count in 0..1000 {
        mechanism.step(0.000_29 * f64::from(count));
    }
    assert_eq!((mechanism.position(), mechanism.velocity()), (0.0, 0.0));
    for _ in 0..400 {
        mechanism.step(0.5);
    }
    let (velocity, from) = (mechanism.velocity(), mechanism.position());
    near(velocity, (0.5 - 0.3) / 0.02 * 400.0 * STEP, 1e-12);
    for _ in 0..4000 {
        mechanism.step(0.0);
    }
    near(
        mechanism.position() - from,
        velocity * velocity * 0.02 / (2.0 * 0.3),
        velocity * STEP,
    );
    let rest = mechanism.position();
    for _ in 0..1000 {
        mechanism.step(-0.2);
    }
    assert_eq!((mechanism.position(), mechanism.velocity()), (rest, 0.0));
}

#[test]
fn the_loops_hold_any_plant_and_follow_a_ramp() {
    for (inertia, cycle) in [(1e-6, 1e-4), (0.02, 1e-3), (50.0, 1e-2)] {
        for plant in [
            Plant { inertia, ..RIGID },
            Plant {
                inertia,
                viscous: inertia,
                coulomb: 0.1 * inertia,
                load: None,
            },
        ] {
            let mechanism = Mechanism::new(plant, 1.0, cycle).unwrap();
            let mut servo = Servo::new(mechanism, Gains::of(&plant, cycle), cycle).unwrap();
            let mut worst = 0.0_f64;
            for scan in 1..=2000_u32 {
                // It accelerates for 1000 scans, then keeps its velocity.
                let time = f64::from(scan) * cycle;
                let end = 1000.0 * cycle;
                let velocity = time.min(end);
                let position = 1.0 + 0.5 * velocity * velocity + (time - end).max(0.0) * end;
                servo.follow(SetPoint { position, velocity });
                worst = worst.max((position - servo.mechanism().position()).abs());
            }
            // A hundredth of the distance of a scan at the end.
            let way = 1000.0 * cycle * cycle;
            assert!(worst <= 0.05 * way, "{plant:?}: {worst} of {way}");
        }
    }
}

#[test]
fn a_torque_limit_delays_and_does_not_wind_up() {
    let mechanism = Mechanism::new(RIGID, 0.0, CYCLE).unwrap();
    let gains = Gains {
        torque: 1.0,
        ..Gains::of(&RIGID, CYCLE)
    };
    let mut servo = Servo::new(mechanism, gains, CYCLE).unwrap();
    // Accelerates with 60 u/s^2 for long, although the torque is enough for 50 only, and brakes with 40.
    let (mut velocity, mut position, mut lag) = (0.0_f64, 0.0_f64, 0.0_f64);
    for scan in 0..8000 {
        let rate = match scan {
            0..400 => 60.0,
            1500..2100 => -40.0,
            _ => 0.0,
        };
        position += (velocity + 0.5 * rate * CYCLE) * CYCLE;
        velocity += rate * CYCLE;
        servo.follow(SetPoint { position, velocity });
        assert!(servo.torque().abs() <= 1.0);
        let behind = position - servo.mechanism().position();
        lag = lag.max(behind);
    }
    assert!(lag > 0.5, "{lag}");
    near(servo.mechanism().position(), position, 1e-9);
}

#[test]
fn what_cannot_be_used_is_named() {
    let bad = |plant: Plant| Mechanism::new(plant, 0.0, CYCLE).unwrap_err().to_string();
    let message = bad(Plant {
        inertia: 0.0,
        ..RIGID
    });
    assert_eq!(message, "`inertia` is 0.0; give a finite number above 0");
    let message = bad(Plant {
        coulomb: f64::NAN,
        ..RIGID
    });
    assert_eq!(message, "`coulomb` is NaN; give a finite number from 0");
    let stiff = Load {
        inertia: 1e-30,
        stiffness: 1e30,
        damping: 0.0,
    };
    let message = bad(Plant {
        load: Some(stiff),
        ..RIGID
    });
    assert!(message.contains("softer, or a shorter cycle"), "{message}");
    let mechanism = Mechanism::new(RIGID, 0.0, CYCLE).unwrap();
    let gains = Gains {
        velocity: -1.0,
        ..Gains::of(&RIGID, CYCLE)
    };
    let message = Servo::new(mechanism, gains, CYCLE).unwrap_err().to_string();
    assert_eq!(message, "`gains.velocity` is -1.0; give a finite number from 0");
}

const LIMITS: Limits = Limits {
    velocity: 2.0,
    acceleration: 40.0,
    deceleration: 40.0,
    jerk: 2000.0,
    snap: 200_000.0,
};

struct Rig {
    axis: Axis,
    drive: PlantDrive,
    log: Log,
    scan: u64,
}

impl Rig {
    fn new(plant: Plant, scaling: Option<Scaling>) -> Self {
        let config = AxisConfig {
            scaling,
            ..AxisConfig::new(LIMITS)
        };
        let mechanism = Mechanism::new(plant, 0.0, CYCLE).unwrap();
        let servo = Servo::new(mechanism, Gains::of(&plant, CYCLE), CYCLE).unwrap();
        Self {
            axis: Axis::new(AxisId::new(0), config, Standard::new(CYCLE)).unwrap(),
            drive: PlantDrive::new(servo, scaling, Some(0), false),
            log: Log::default(),
            scan: 0,
        }
    }

    fn step(&mut self, during: impl FnOnce(&mut Axis, &mut Scope<'_>)) -> (f64, bool) {
        let feedback = self.drive.read(0);
        let scope = &mut Scope::new(self.scan, &mut self.log);
        self.axis.follow_feedback(&feedback, scope);
        self.axis.set_power(true, Permission::BOTH, scope);
        during(&mut self.axis, scope);
        self.axis.step_alone(scope);
        self.drive.write(0, &self.axis.drive_command());
        self.scan += 1;
        (self.axis.setpoint().position, feedback.enabled)
    }
}

#[test]
fn an_axis_moves_a_load_and_the_load_swings_behind_it() {
    for scaling in [None, Scaling::new(100_000, 1, true, 0.5).ok()] {
        let plant = Plant {
            viscous: 0.01,
            coulomb: 0.05,
            load: Some(Load {
                inertia: 0.05,
                stiffness: 200.0,
                damping: 0.02,
            }),
            ..RIGID
        };
        let mut rig = Rig::new(plant, scaling);
        for _ in 0..5 {
            rig.step(|_, _| {});
        }
        let mut command = None;
        rig.step(|axis, scope| {
            let dynamics = Dynamics::at(2.0);
            let request = Request::aborting(Command::MoveRelative {
                distance: 0.5,
                dynamics,
            });
            command = axis.command(&request, scope).ok();
        });
        let id = command.expect("accepted");
        let (mut lag, mut swing) = (0.0_f64, 0.0_f64);
        let mut done = 0;
        for _ in 0..1000 {
            let (set, _) = rig.step(|_, _| {});
            let mechanism = rig.drive.servo().mechanism();
            lag = lag.max((set - mechanism.position()).abs());
            if rig.axis.fate(id) == Fate::Done {
                done += 1;
                swing = swing.max((mechanism.load_position() - 0.5).abs());
            }
        }
        assert!(done > 300);
        // It lags by less than the distance of a scan, and the load swings.
        assert!(lag > 0.0 && lag < 2.0 * 2.0 * CYCLE, "{lag}");
        assert!(swing > 1e-5 && swing < 0.05, "{swing}");
        near(rig.drive.servo().mechanism().position(), 0.5, 2e-3);
    }
}

#[test]
fn without_power_it_coasts_and_enabling_takes_it_where_it_is() {
    let plant = Plant {
        coulomb: 0.05,
        ..RIGID
    };
    let mut rig = Rig::new(plant, None);
    for _ in 0..5 {
        rig.step(|_, _| {});
    }
    rig.step(|axis, scope| {
        let dynamics = Dynamics::at(2.0);
        let command = Command::MoveRelative {
            distance: 100.0,
            dynamics,
        };
        axis.command(&Request::aborting(command), scope).unwrap();
    });
    for _ in 0..300 {
        rig.step(|_, _| {});
    }
    let at_loss = rig.drive.servo().mechanism().position();
    rig.drive.stage_mut().cut_power();
    for _ in 0..200 {
        rig.step(|_, _| {});
    }
    assert_eq!(rig.axis.state(), AxisState::ErrorStop);
    let coasted = rig.drive.servo().mechanism().position() - at_loss;
    assert!(coasted > 0.2, "{coasted}");
    // Power returns while it still moves. From the first set-point in operation on, no step is larger than the
    // distance of a scan.
    rig.drive.stage_mut().clear_cause();
    rig.step(|axis, scope| {
        axis.reset(scope).unwrap();
    });
    let mut last: Option<f64> = None;
    for _ in 0..200 {
        let actual = match rig.drive.read(0).position {
            DrivePosition::Units(units) => units,
            DrivePosition::Increments(_) => unreachable!("the drive speaks units"),
        };
        let (set, enabled) = rig.step(|_, _| {});
        if enabled {
            let step = set - last.unwrap_or(actual);
            assert!(step.abs() <= LIMITS.velocity * CYCLE, "{step}");
        }
        last = enabled.then_some(set);
    }
    assert_eq!(rig.axis.state(), AxisState::Standstill);
}

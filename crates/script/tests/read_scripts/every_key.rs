//! A script with every key of the format, compared where the example of the format lacks it.

use standstill_axis::{
    AboveLimit, AxisId, BlockDetection, DrivePosition, EdgeWhileBusy, Following, HomeDirection, Homing,
    JogAtLimit, Limits, ModuloTargets, MoveProfile, OnLimit, OnMasterLost, PowerOff, Procedure, Scaling,
    ShaperKind, StopLimits, SwitchEdge, VibrationMode,
};
use standstill_drives::cia402::Reaction;
use standstill_drives::mechanism::{Gains, Load, Plant, Stops};
use standstill_drives::switches::{Marker, Switches};
use standstill_fb::Value;
use standstill_script::model::{
    Action, Cia402Setup, ClaimKind, Comparison, DriveChange, DriveSetup, FaultKind, IdealDriveSetup,
    MotorSetup, PlantSetup, Point, Script, Test, When, Wire,
};
use standstill_script::{format, read};

const TEXT: &str = include_str!("every_key.scan.json");

fn script(overrides: &[(String, f64)]) -> Script {
    read(TEXT, "every_key.scan.json", overrides).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn axes_take_their_configuration() {
    let script = script(&[]);
    let x = &script.axes[0];
    let inf = f64::INFINITY;
    let limits = Limits {
        velocity: 50.0,
        acceleration: 200.0,
        deceleration: 100.0,
        jerk: 2000.0,
        snap: inf,
    };
    assert_eq!(x.config.limits, limits);
    assert_eq!(x.config.defaults.snap, Some(5e5));
    assert_eq!(x.config.position, -2.5);
    assert_eq!(x.config.scaling, Scaling::new(8_388_608, 10, true, 0.25).ok());
    assert_eq!(x.config.software_limits, Some((-100.0, 100.0)));
    assert_eq!(x.config.above_limit, AboveLimit::Error);
    assert_eq!(x.config.profile, MoveProfile::SCurve);
    assert_eq!(x.config.queue, 2);
    assert_eq!(
        (x.config.stop_deceleration, x.config.stop_jerk),
        (Some(90.0), Some(1500.0))
    );
    assert_eq!(x.config.on_power_off, PowerOff::Coast);
    assert_eq!(x.config.power_timeout, Some(4));
    let following = Following {
        on_limit: OnLimit::Error,
        max_deviation: Some(0.5),
        on_master_lost: OnMasterLost::Hold,
        actual_filter: 8,
        actual_lead: true,
        cam_continuity: Some(1),
    };
    assert_eq!(x.config.following, following);
    assert!(x.config.needs_homed);
    assert!(!x.config.hardware_limits);
    let homing = Homing {
        procedure: Procedure::AbsoluteSwitch,
        direction: HomeDirection::SwitchNegative,
        edge: SwitchEdge::Falling,
        velocity: 20.0,
        creep: Some(2.0),
        pulse: true,
        block: None,
        time_limit: Some(400),
        distance_limit: Some(300.0),
    };
    assert_eq!(x.config.homing, homing);
    assert_eq!(
        x.drive,
        DriveSetup::Ideal(IdealDriveSetup {
            delay: 2,
            power_on: None,
            switches: Switches {
                limits: Some((-120.0, 120.0)),
                home: Some((0.0, 5.0)),
                marker: Some(Marker {
                    at: 2.5,
                    every: Some(10.0)
                }),
                turn: None,
            },
        })
    );

    let y = &script.axes[1];
    let limits = Limits {
        velocity: 1.0,
        acceleration: 2.0,
        deceleration: 2.0,
        jerk: inf,
        snap: inf,
    };
    assert_eq!(y.config, standstill_axis::AxisConfig::new(limits));
    assert_eq!(y.drive, DriveSetup::default());

    let own = &script.axes.last().unwrap().config;
    let application = Limits {
        velocity: 0.5,
        acceleration: 1.0,
        deceleration: 2.0,
        jerk: 3.0,
        snap: inf,
    };
    assert_eq!(own.application_limits, Some(application));
    let stop = StopLimits {
        deceleration: Some(4.0),
        jerk: Some(5.0),
        snap: Some(6.0),
    };
    assert_eq!(own.stop, Some(stop));
    assert_eq!(own.jog_at_limit, JogAtLimit::Stop);
    assert_eq!(own.modulo_targets, ModuloTargets::Wrap);
    assert_eq!(own.edge_while_busy, EdgeWhileBusy::Ignore);
    let first = VibrationMode {
        frequency: 50.0,
        damping: 0.02,
        shaper: ShaperKind::Zvd,
    };
    assert_eq!(own.vibration, [Some(first), Some(VibrationMode::new(12.0))]);

    assert_eq!(
        script.axes[2].drive,
        DriveSetup::Cia402(Cia402Setup {
            delay: 3,
            power_on: Some(20),
            start_up: 10,
            deceleration: Some(4.0),
            quick_stop: Reaction::RampAndStay,
            on_disable: Reaction::Ramp,
            on_fault: Reaction::Coast,
            homing: Some((false, 0.5)),
            motor: Some(MotorSetup {
                rated_torque: 2.0,
                max_torque: 5.0,
                inertia: 0.02,
                viscous: 0.01,
                coulomb: 0.1,
            }),
            switches: Switches {
                limits: Some((-10.0, 10.0)),
                home: Some((-1.0, 0.5)),
                ..Switches::default()
            },
        })
    );
    assert_eq!(
        script.axes[3].drive,
        DriveSetup::Plant(PlantSetup {
            power_on: Some(4),
            plant: Plant {
                inertia: 0.02,
                viscous: 0.001,
                coulomb: 0.05,
                load: Some(Load {
                    inertia: 0.05,
                    stiffness: 200.0,
                    damping: 0.01
                }),
            },
            stops: Some(Stops {
                ends: (-3.0, 3.0),
                stiffness: 500.0,
                damping: 0.5,
            }),
            gains: Gains {
                position: 50.0,
                velocity: 2.0,
                integral: 30.0,
                feed_velocity: 0.5,
                feed_acceleration: 0.0,
                torque: 9.0,
            },
            switches: Switches::default(),
        })
    );
    let block = BlockDetection {
        velocity: 0.5,
        scans: 100,
    };
    assert_eq!(script.axes[3].config.homing.block, Some(block));
}

#[test]
fn parameters_fill_in_and_overrides_replace_them() {
    let plain = script(&[]);
    assert_eq!(plain.inputs[3].initial, Value::Lreal(50.0));
    assert!(matches!(plain.steps[0].when, When::At(40)));
    let set = [
        ("v".to_owned(), 60.0),
        ("late".to_owned(), 7.0),
        ("late".to_owned(), 8.0),
    ];
    let other = script(&set);
    assert_eq!(other.inputs[3].initial, Value::Lreal(60.0));
    assert_eq!(other.axes[0].config.limits.velocity, 60.0);
    assert!(matches!(other.steps[0].when, When::At(8)));
    assert_eq!(other.parameters["v"], 60.0);
    assert!(read(TEXT, "every_key.scan.json", &[("late".to_owned(), 0.5)]).is_err());
    assert!(read(TEXT, "every_key.scan.json", &[("v".to_owned(), f64::NAN)]).is_err());
}

#[test]
fn pins_take_constants_and_wires() {
    let script = script(&[]);
    assert_eq!((script.cycle_ns, script.scans), (500_000, 2000));
    let first = &script.blocks[1];
    let pin = |name| first.block.pin(name).unwrap().0;
    let constant = |name| {
        first
            .constants
            .iter()
            .find(|(index, _)| *index == pin(name))
            .map(|(_, value)| *value)
    };
    assert_eq!(constant("Axis"), Some(Value::Axis(AxisId::new(0))));
    assert_eq!(constant("Position"), Some(Value::Lreal(f64::NEG_INFINITY)));
    assert_eq!(constant("Acceleration"), Some(Value::Lreal(50.0)));
    assert_eq!(constant("BufferMode"), Some(Value::Enum(1)));
    assert_eq!(constant("Direction"), Some(Value::Enum(17)));
    let (status, _) = script.blocks[0].block.pin("Status").unwrap();
    assert_eq!(
        first.wires,
        [
            (
                pin("Execute"),
                Wire::All(vec![Point::Input(0), Point::Pin(0, status)])
            ),
            (pin("Velocity"), Wire::From(Point::Input(1))),
        ]
    );
    // Its own output of the scan before, and an input of another instance.
    let second = &script.blocks[2];
    assert_eq!(
        second.wires[0].1,
        Wire::Any(vec![Point::Pin(1, pin("Done")), Point::Pin(2, pin("Error"))])
    );
    assert_eq!(second.wires[1].1, Wire::From(Point::Pin(1, pin("Velocity"))));

    assert_eq!((first.task, second.task), (0, 1));
    let slow = &script.tasks[1];
    assert_eq!((slow.interval, slow.priority, slow.watchdog), (Some(20), 5, None));
    assert_eq!(slow.single, Some(Wire::Not(Point::Input(0))));
    assert_eq!(script.tasks[0].watchdog, Some(3));
}

#[test]
fn steps_and_claims_take_all_their_forms() {
    let script = script(&[]);
    let (position, _) = script.blocks[1].block.pin("Position").unwrap();
    assert_eq!(
        script.steps[0].actions,
        [
            Action::Set(Point::Input(0), Value::Bool(true)),
            Action::Set(Point::Pin(1, position), Value::Lreal(3.0)),
            Action::Set(Point::Input(1), Value::Lreal(f64::INFINITY)),
        ]
    );
    assert!(
        matches!(&script.steps[1].when, When::Holds { conditions, after: 2, every: true }
        if conditions.len() == 2)
    );
    assert_eq!(
        script.steps[2].actions,
        [Action::Fault {
            axis: 0,
            kind: FaultKind::Drive,
            code: 7
        }]
    );
    assert_eq!(
        script.steps[3].actions,
        [
            Action::Fault {
                axis: 1,
                kind: FaultKind::Power,
                code: 0
            },
            Action::Clear { axis: 0 }
        ]
    );
    assert_eq!(
        script.steps[4].actions,
        [Action::Drive {
            axis: 1,
            change: DriveChange::Displace(0.5)
        }]
    );
    let of_z = |change| Action::Drive { axis: 2, change };
    assert_eq!(
        script.steps[5].actions,
        [of_z(DriveChange::Remote(false)), of_z(DriveChange::Warning(true))]
    );
    let of_y = |change| Action::Drive { axis: 1, change };
    let input = DriveChange::Input {
        number: 7,
        level: true,
    };
    let probe = DriveChange::Probe {
        number: 1,
        at: 0.25,
        level: true,
    };
    assert_eq!(script.steps[6].actions, [of_y(input), of_y(probe)]);
    let [
        Action::Drive {
            axis: 1,
            change: DriveChange::ReportPosition(DrivePosition::Units(told)),
        },
    ] = script.steps[7].actions[..]
    else {
        panic!("{:?}", script.steps[7].actions);
    };
    assert!(told.is_nan());
    let counted = DriveChange::ReportPosition(DrivePosition::Increments(-7));
    assert_eq!(
        script.steps[8].actions,
        [of_z(counted), of_z(DriveChange::ReportTorque(f64::INFINITY))]
    );

    let ranges = script
        .claims
        .iter()
        .map(|claim| (claim.range.from, claim.range.to, claim.during.len()));
    assert_eq!(
        ranges.collect::<Vec<_>>()[..8],
        [
            (40, Some(40), 0),
            (10, Some(1990), 0),
            (3, None, 1),
            (3, Some(3), 1),
            (0, Some(60), 0),
            (0, None, 0),
            (0, None, 0),
            (1, Some(100), 0)
        ]
    );
    let kinds: Vec<_> = script.claims.iter().map(|claim| &claim.kind).collect();
    assert!(matches!(kinds[0], ClaimKind::At(that) if that.len() == 3
        && that[0].test == Test::Named(Value::Enum(1))
        && that[1].test == Test::Named(Value::Enum(17))
        && that[2].test == Test::Named(Value::Axis(AxisId::new(0)))));
    assert!(matches!(kinds[1], ClaimKind::By(that)
        if that[0].test == Test::Compare(vec![Comparison::Ne(Box::new(Test::Bool(false)))])
        && that[1].test == Test::Compare(vec![Comparison::Ge(1.0), Comparison::Lt(100.0)])));
    assert!(matches!(kinds[2], ClaimKind::Always(_)));
    assert!(matches!(kinds[3], ClaimKind::Never(_)));
    assert!(matches!(kinds[4], ClaimKind::Once(that)
        if that[0].test == Test::Compare(vec![Comparison::Near { near: 0.5, within: 1e-9 }])));
    assert!(matches!(kinds[5], ClaimKind::Always(that)
        if matches!(that[1].test, Test::Exactly(value) if value.is_nan())));
    assert!(matches!(kinds[6], ClaimKind::Exclusive(points) if points.len() == 3));
    assert!(matches!(kinds[7], ClaimKind::WithinLimits { axis: 0, factor } if *factor == 1.0001));
    assert!(matches!(&script.stop_when, Some((conditions, 10)) if conditions.len() == 1));
}

#[test]
fn the_layout_keeps_it_the_same_script() {
    let once = format(TEXT, "every_key.scan.json").unwrap();
    assert_eq!(format(&once, "every_key.scan.json").unwrap(), once);
    let values = |text: &str| serde_json::from_str::<serde_json::Value>(text).unwrap();
    assert_eq!(values(&once), values(TEXT));
}

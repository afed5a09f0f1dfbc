//! Drives that report NaN, infinity or far too large numbers, in any scan of any motion.

use super::rig::{Random, Rig, STEP, Told, Upset};
use super::{MOTIONS, begin};
use standstill_axis::{
    AxisState, Command, Direction, DriveHoming, DrivePosition, DriveReport, Dynamics, ErrorClass, ErrorId,
    Permission, Request, TorqueReport,
};

const NO_NUMBERS: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

/// Finite numbers whose difference overflows or is nearly nothing.
const FAR: [f64; 8] = [
    f64::MAX,
    f64::MIN,
    1e300,
    -1e300,
    9.3e18,
    f64::MIN_POSITIVE,
    5e-324,
    -0.0,
];

fn one_of(random: &mut Random, numbers: &[f64]) -> f64 {
    numbers[random.below(numbers.len() as u64) as usize]
}

/// The false report of a drive. At least one of the two values is false.
fn lie(random: &mut Random, numbers: &[f64]) -> Told {
    let kind = random.below(3);
    Told {
        position: (kind != 1).then(|| one_of(random, numbers)),
        torque: (kind != 0).then(|| one_of(random, numbers)),
        beside: None,
    }
}

/// Random motions, faults, resets and switching. In random scans the drive reports false values for some scans.
/// [`Rig::step`] checks the claims for every scan.
fn lying(seed: u64, is_plant: bool, numbers: &[f64]) -> Rig {
    let random = &mut Random(seed);
    let mut rig = Rig::new(random, is_plant);
    rig.believes_lies = numbers.iter().all(|number| number.is_finite());
    let mut left = 0;
    for _ in 0..400 {
        if left == 0 && random.below(30) == 0 {
            left = 1 + random.below(6);
            rig.told = lie(random, numbers);
        } else if left > 0 {
            left -= 1;
            if left == 0 {
                rig.told = Told::default();
            }
        }
        match random.below(120) {
            0 => rig.upset(Upset::Fault),
            1 => rig.upset(Upset::Power),
            2 => rig.upset(Upset::Communication),
            3..6 => rig.upset(Upset::Clear),
            _ => {}
        }
        let power = random.below(40) != 0;
        rig.step(power, Permission::BOTH, |axis, scope| {
            match axis.state() {
                AxisState::ErrorStop if random.below(10) == 0 => drop(axis.reset(scope)),
                AxisState::Stopping => axis.release_stop(axis.newest_command()),
                _ => {}
            }
            if random.below(12) == 0 {
                let name = MOTIONS[random.below(MOTIONS.len() as u64) as usize];
                begin(name, random, axis, scope);
            }
            assert_ne!(axis.error_id().class(), ErrorClass::Internal, "seed {seed}");
        });
    }
    rig.told = Told::default();
    rig
}

/// Covers: R98
#[test]
fn what_is_no_number_stops_the_axis_and_is_recovered_from() {
    for is_plant in [false, true] {
        let mut refused = 0;
        for seed in 0..standstill_testkit::whole_or(2000, 500) {
            let mut rig = lying(seed, is_plant, &NO_NUMBERS);
            assert_eq!(rig.recovers(), Ok(()), "seed {seed}, plant {is_plant}");
            assert!(
                rig.worst <= STEP,
                "seed {seed}, plant {is_plant}: {} u",
                rig.worst
            );
            refused += rig.refused;
        }
        assert!(
            refused > standstill_testkit::whole_or(20_000, 5_000),
            "{refused} scans with a lie"
        );
    }
}

/// Covers: R98
#[test]
fn what_is_merely_far_is_never_commanded_as_what_is_no_number() {
    for is_plant in [false, true] {
        for seed in 0..standstill_testkit::whole_or(2000, 500) {
            lying(seed, is_plant, &FAR);
        }
    }
}

/// Covers: R98
#[test]
fn a_mixture_of_both() {
    let all = [NO_NUMBERS.as_slice(), FAR.as_slice()].concat();
    for seed in 0..standstill_testkit::whole_or(2000, 500) {
        lying(seed, true, &all);
    }
}

/// Covers: R98
#[test]
fn every_number_of_a_report_is_looked_at() {
    fn torque(actual: f64, most: f64) -> Option<TorqueReport> {
        Some(TorqueReport {
            actual,
            most,
            limited: false,
        })
    }
    const NO_PLACE: DrivePosition = DrivePosition::Units(f64::NAN);
    let no_numbers: [fn(&mut DriveReport); 8] = [
        |report| report.torque = torque(f64::INFINITY, 1.0),
        |report| report.torque = torque(0.0, f64::NAN),
        |report| report.probes[0].latched = Some(NO_PLACE),
        |report| report.probes[1].latched = Some(DrivePosition::Units(f64::INFINITY)),
        |report| report.marker.latched = Some(NO_PLACE),
        |report| report.homing = DriveHoming::Attained(NO_PLACE),
        |report| report.homing = DriveHoming::Done(NO_PLACE),
        |report| report.torque = torque(f64::NAN, f64::INFINITY),
    ];
    let numbers: [fn(&mut DriveReport); 3] = [
        |report| report.torque = torque(0.0, f64::INFINITY),
        |report| report.torque = torque(-1e300, 0.0),
        |report| report.probes[0].latched = Some(DrivePosition::Increments(i64::MAX)),
    ];
    for (told, state) in no_numbers
        .map(|told| (told, AxisState::ErrorStop))
        .into_iter()
        .chain(numbers.map(|told| (told, AxisState::Standstill)))
    {
        let mut rig = Rig::new(&mut Random(3), true);
        rig.step(true, Permission::BOTH, |_, _| {});
        rig.told = Told::beside(told);
        rig.step(true, Permission::BOTH, |axis, _| assert_eq!(axis.state(), state));
        // A drive that does not report these values leaves them alone.
        rig.told = Told::beside(|report| {
            (report.probes, report.marker) = (Default::default(), Default::default());
            report.homing = DriveHoming::Off;
        });
        assert_eq!(rig.recovers(), Ok(()));
    }
}

/// The largest torque may fall during a torque command. The ordered torque follows at once and returns along the
/// ramp.
#[test]
fn a_drive_that_can_hold_less_is_ordered_less() {
    fn most(report: &mut DriveReport, most: f64) {
        if let Some(torque) = &mut report.torque {
            torque.most = most;
        }
    }
    let mut rig = Rig::new(&mut Random(3), true);
    let command = Command::Torque {
        torque: 8.0,
        ramp: 1000.0,
        dynamics: Dynamics::default(),
        direction: Direction::Unset.into(),
    };
    rig.step(true, Permission::BOTH, |axis, scope| {
        assert!(axis.command(&Request::aborting(command), scope).is_ok());
    });
    let mut ordered = |told: Told| {
        rig.told = told;
        rig.step(true, Permission::BOTH, |_, _| {});
        rig.axis.order().torque.map(|order| order.torque)
    };
    for _ in 0..10 {
        ordered(Told::default());
    }
    assert_eq!(ordered(Told::default()), Some(8.0));
    assert_eq!(ordered(Told::beside(|report| most(report, 3.0))), Some(3.0));
    assert_eq!(ordered(Told::default()), Some(4.0));
    for none in [
        Told::beside(|report| most(report, 0.0)),
        Told::beside(|report| most(report, -5.0)),
        Told::beside(|report| report.torque = None),
    ] {
        assert_eq!(ordered(none), Some(0.0), "a drive that only measures");
    }
    assert_eq!(ordered(Told::default()), Some(1.0));
}

/// The error is that of the first cause. Reading gives the present cause.
#[test]
fn an_axis_that_is_lied_to_tells_why() {
    let random = &mut Random(1);
    let mut rig = Rig::new(random, true);
    for (told, error) in [
        (Told::position(f64::NAN), ErrorId::FeedbackInvalid),
        (Told::torque(f64::NEG_INFINITY), ErrorId::FeedbackInvalid),
    ] {
        rig.told = told;
        rig.step(true, Permission::BOTH, |axis, _| {
            assert_eq!((axis.state(), axis.error_id()), (AxisState::ErrorStop, error));
            assert_eq!(axis.fresh_position(), Err(error));
            assert_eq!(axis.actual_torque(), Err(error));
        });
        rig.told = Told::default();
        rig.upset(Upset::Communication);
        rig.step(true, Permission::BOTH, |axis, _| {
            assert_eq!(axis.error_id(), error);
            assert_eq!(axis.fresh_position(), Err(ErrorId::CommunicationLost));
        });
        assert_eq!(rig.recovers(), Ok(()));
    }
}

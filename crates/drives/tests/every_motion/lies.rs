//! Drives that tell what is no number, or far too large a one, in any scan of any motion.

use crate::rig::{Random, Rig, STEP, Told, Upset};
use crate::{MOTIONS, begin};
use standstill_axis::{AxisState, ErrorClass, ErrorId, Permission};

const NO_NUMBERS: [f64; 3] = [f64::NAN, f64::INFINITY, f64::NEG_INFINITY];

/// Numbers all the same, which differ by more than there are numbers for, or by nearly nothing.
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

/// What a drive that lies tells: at least one of the two is a lie.
fn lie(random: &mut Random, numbers: &[f64]) -> Told {
    let kind = random.below(3);
    Told {
        position: (kind != 1).then(|| one_of(random, numbers)),
        torque: (kind != 0).then(|| one_of(random, numbers)),
    }
}

/// Random motions, faults, resets and switching, and in random scans a lie for some scans. What holds in every scan is in
/// [`Rig::step`].
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
        rig.step(power, Permission::BOTH, |axis, source, log| {
            match axis.state() {
                AxisState::ErrorStop if random.below(10) == 0 => drop(axis.reset(source, log)),
                AxisState::Stopping => axis.release_stop(axis.newest_command()),
                _ => {}
            }
            if random.below(12) == 0 {
                let name = MOTIONS[random.below(MOTIONS.len() as u64) as usize];
                begin(name, random, axis, source, log);
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
        for seed in 0..2000 {
            let mut rig = lying(seed, is_plant, &NO_NUMBERS);
            assert_eq!(rig.recovers(), Ok(()), "seed {seed}, plant {is_plant}");
            assert!(
                rig.worst <= STEP,
                "seed {seed}, plant {is_plant}: {} u",
                rig.worst
            );
            refused += rig.refused;
        }
        assert!(refused > 20_000, "{refused} scans with a lie");
    }
}

/// Covers: R98
#[test]
fn what_is_merely_far_is_never_commanded_as_what_is_no_number() {
    for is_plant in [false, true] {
        for seed in 0..2000 {
            lying(seed, is_plant, &FAR);
        }
    }
}

/// Covers: R98
#[test]
fn a_mixture_of_both() {
    let all = [NO_NUMBERS.as_slice(), FAR.as_slice()].concat();
    for seed in 0..2000 {
        lying(seed, true, &all);
    }
}

/// The error is that of the first cause, and what is read tells the present one.
#[test]
fn an_axis_that_is_lied_to_tells_why() {
    let random = &mut Random(1);
    let mut rig = Rig::new(random, true);
    for (told, error) in [
        (Told::position(f64::NAN), ErrorId::FeedbackInvalid),
        (Told::torque(f64::NEG_INFINITY), ErrorId::FeedbackInvalid),
    ] {
        rig.told = told;
        rig.step(true, Permission::BOTH, |axis, _, _| {
            assert_eq!((axis.state(), axis.error_id()), (AxisState::ErrorStop, error));
            assert_eq!(axis.fresh_position(), Err(error));
            assert_eq!(axis.actual_torque(), Err(error));
        });
        rig.told = Told::default();
        rig.upset(Upset::Communication);
        rig.step(true, Permission::BOTH, |axis, _, _| {
            assert_eq!(axis.error_id(), error);
            assert_eq!(axis.fresh_position(), Err(ErrorId::CommunicationLost));
        });
        assert_eq!(rig.recovers(), Ok(()));
    }
}

//! Searches from anywhere, at any speed: the axis always ends at the same reference.

use standstill_axis::{
    Axis, AxisConfig, AxisId, AxisState, Command, Drive, DrivePosition, Fate, HomeDirection, Homing,
    IdealDrive, Limits, Log, Procedure, Request, Scope, Standard, StartState, SwitchEdge,
};
use standstill_drives::switches::{Marker, Switches, Travel};
use standstill_testkit::Random;

const CYCLE: f64 = 0.001;

const LIMITS: Limits = Limits {
    velocity: 500.0,
    acceleration: 1e4,
    deceleration: 8e3,
    jerk: 1e6,
    snap: f64::INFINITY,
};

const SWITCHES: Switches = Switches {
    limits: Some((-50.0, 50.0)),
    home: Some((3.0, 9.0)),
    marker: Some(Marker {
        at: 0.25,
        every: Some(1.0),
    }),
    turn: None,
};

/// Homes from `start` and returns the place whose position is 0 afterwards.
fn place_of_zero(homing: Homing, start: f64, delay: usize) -> f64 {
    let config = AxisConfig {
        start: StartState::Standstill,
        position: start,
        homing,
        ..AxisConfig::new(LIMITS)
    };
    let mut axis = Axis::new(AxisId::new(0), config, Standard::new(CYCLE)).expect("a good configuration");
    let mut drive = IdealDrive::new(DrivePosition::Units(start), delay, Some(0), true);
    let mut travel = Travel::new(SWITCHES, None);
    let mut log = Log::default();
    let (mut id, mut place, mut before) = (None, start, start);
    for scan in 0..20_000 {
        let mut feedback = drive.read(0);
        travel.read(&mut feedback);
        travel.report(axis.report_mut());
        axis.follow_report();
        axis.follow_feedback(&feedback, &mut Scope::new(scan, &mut log));
        let home = Request::aborting(Command::Home { position: 0.0 });
        let id = *id.get_or_insert_with(|| {
            axis.command(&home, &mut Scope::new(scan, &mut log))
                .unwrap_or_else(|error| panic!("{homing:?} from {start}: {error:?}"))
        });
        match axis.fate(id) {
            Fate::Done => {
                assert_eq!(axis.state(), AxisState::Standstill);
                // It is at `place`. This is the place of its position 0:
                return place - axis.setpoint().position;
            }
            Fate::Active { .. } => assert_eq!(axis.state(), AxisState::Homing),
            fate => panic!("{homing:?} from {start}: {fate:?}"),
        }
        axis.step_alone(&mut Scope::new(scan, &mut log));
        let setpoint = axis.setpoint();
        let command = axis.drive_command();
        if command.rename.is_none() {
            // Places are positions in the old coordinates.
            place = setpoint.position;
            assert!((place - before).abs() <= LIMITS.velocity * CYCLE * (1.0 + 1e-9));
            before = place;
        }
        travel.order(axis.order());
        if let Some(name) = command.rename {
            travel.shift(name - place);
        }
        drive.write(0, &command);
    }
    panic!("{homing:?} from {start} does not end");
}

/// Covers: V11
#[test]
fn the_reference_of_a_switch_is_the_same_from_everywhere() {
    let mut random = Random(5);
    for _ in 0..600 {
        let creep = 5.0 + 20.0 * random.unit();
        let homing = Homing {
            procedure: Procedure::AbsoluteSwitch,
            direction: random.one_of(&[
                HomeDirection::Positive,
                HomeDirection::Negative,
                HomeDirection::SwitchPositive,
                HomeDirection::SwitchNegative,
            ]),
            edge: random.one_of(&[
                SwitchEdge::Rising,
                SwitchEdge::Falling,
                SwitchEdge::SwitchPositive,
                SwitchEdge::SwitchNegative,
            ]),
            velocity: 30.0 + 300.0 * random.unit(),
            creep: Some(creep),
            ..Homing::DIRECT
        };
        let is_up = matches!(
            homing.direction,
            HomeDirection::Positive | HomeDirection::SwitchPositive
        );
        let is_lower = match homing.edge {
            SwitchEdge::Rising => is_up,
            SwitchEdge::Falling => !is_up,
            SwitchEdge::SwitchPositive => true,
            SwitchEdge::SwitchNegative => false,
        };
        let edge = if is_lower { 3.0 } else { 9.0 };
        let start = -60.0 + 120.0 * random.unit();
        let found = place_of_zero(homing, start, random.one_of(&[0, 1, 4]));
        // Behind the edge in the direction of the last approach, by at most the distance of a scan.
        let behind = if is_up { found - edge } else { edge - found };
        assert!(
            (-1e-9..=creep * CYCLE + 1e-9).contains(&behind),
            "{homing:?} from {start}: {found}"
        );
    }
}

#[test]
fn the_reference_of_a_pulse_is_its_place() {
    let mut random = Random(6);
    for _ in 0..300 {
        let direction = random.one_of(&[HomeDirection::Positive, HomeDirection::Negative]);
        let homing = Homing {
            procedure: Procedure::ReferencePulse,
            direction,
            velocity: 5.0 + 400.0 * random.unit(),
            ..Homing::DIRECT
        };
        let found = place_of_zero(homing, -20.0 + 40.0 * random.unit(), random.one_of(&[0, 3]));
        let pulse = (found - 0.25).round() + 0.25;
        assert!((found - pulse).abs() <= 1e-9, "{homing:?}: {found}");
    }
}

#[test]
fn a_limit_switch_is_the_reference_where_it_goes_off() {
    let mut random = Random(7);
    for _ in 0..300 {
        let direction = random.one_of(&[HomeDirection::Positive, HomeDirection::Negative]);
        let creep = 5.0 + 20.0 * random.unit();
        let homing = Homing {
            procedure: Procedure::LimitSwitch,
            direction,
            velocity: 30.0 + 300.0 * random.unit(),
            creep: Some(creep),
            ..Homing::DIRECT
        };
        let found = place_of_zero(homing, -60.0 + 120.0 * random.unit(), random.one_of(&[0, 2]));
        let inside = if direction == HomeDirection::Positive {
            50.0 - found
        } else {
            found + 50.0
        };
        assert!(
            (-1e-9..=creep * CYCLE + 1e-9).contains(&inside),
            "{homing:?}: {found}"
        );
    }
}

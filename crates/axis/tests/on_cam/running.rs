//! In sync: places, periods, ends, and the commands after the cam.

use super::rig::{L1, MASTER, RELATIVE, Rig, SLAVE, WIDE, config, row, up_and_back};
use standstill_axis::{AxisState, BufferMode, CamRow, CamSelection, Command, Dynamics, Fate, Limits};
use standstill_planner::CamShape;
use standstill_testkit::given;

fn stop() -> Command {
    Command::Halt {
        dynamics: Dynamics::default(),
    }
}

/// Covers: GS15, G67, G1
#[test]
fn the_table_of_the_reference() {
    let mut rig = Rig::new(config(L1, 0.0, None), config(WIDE, 0.0, None));
    let id = rig.follow(&up_and_back(), RELATIVE);
    rig.run(200.0);
    assert_eq!(rig.slave().state(), AxisState::SynchronizedMotion);
    let table = [
        (100, 2.233_333, 0.000_081),
        (270, 27.0, 1.210_317),
        (585, 90.0, 50.0),
        (1000, 173.0, 99.992_718),
        (1035, 180.0, 100.0),
        (1485, 270.0, 50.0),
        (1935, 360.0, 0.0),
    ];
    let mut ends = Vec::new();
    for n in 1..=7400_u32 {
        let before = rig.slave().cam_ends();
        rig.step();
        assert!(rig.slave().is_in_gear(), "{n}");
        assert_eq!(rig.slave().fate(id), Fate::Active { reached: true });
        if rig.slave().cam_ends() != before {
            ends.push(n);
        }
        if let Some((_, m, s)) = table.iter().find(|(at, ..)| *at == n) {
            assert!((rig.master() - m).abs() < 6e-7, "{n}");
            assert!((rig.at() - s).abs() < 6e-7, "{n}: {}", rig.at());
        }
    }
    assert_eq!(ends, [1935, 3735, 5535, 7335]);
    for (peak, expected) in rig.peaks.into_iter().zip([243.06, 927.6, 7201.6, 154_686.0]) {
        assert!((peak - expected).abs() < 2e-4 * expected, "{:?}", rig.peaks);
    }
}

/// Covers: G67
#[test]
fn backwards_it_runs_as_forwards() {
    let mut rig = Rig::new(config(L1, 0.0, None), config(WIDE, 0.0, None));
    rig.follow(&up_and_back(), RELATIVE);
    rig.run(-200.0);
    let mut ends = Vec::new();
    for n in 1..=5600_u32 {
        let before = rig.slave().cam_ends();
        rig.step();
        assert!(rig.slave().is_in_gear(), "{n}");
        if rig.slave().cam_ends() != before {
            ends.push(n);
        }
    }
    assert_eq!(ends, [1935, 3735, 5535]);
    rig.keeps_limits().unwrap();
}

/// Covers: G69, G31
#[test]
fn a_period_that_is_no_part_of_the_turn_stays_exact() {
    let fast = Limits {
        velocity: 1e5,
        acceleration: 1e7,
        deceleration: 1e7,
        jerk: 1e10,
        snap: 1e13,
    };
    let faster = Limits {
        velocity: 1e6,
        acceleration: 1e10,
        deceleration: 1e10,
        jerk: 1e14,
        snap: 1e18,
    };
    let mut rig = Rig::new(config(fast, 0.0, Some(1000.0)), config(faster, 0.0, None));
    rig.follow(&up_and_back(), RELATIVE);
    rig.run(1e5);
    // `CAM_SCANS=3610000` for a million periods.
    for _ in 0..given("CAM_SCANS", 100_000_u64) {
        let before = rig.slave().cam_ends();
        rig.step();
        assert!(rig.slave().cam_ends() - before <= 1);
    }
    rig.command(MASTER, stop());
    rig.steps(2000);
    assert!(rig.axes[MASTER].setpoint().is_at_rest());
    // The master has passed some 27,000 periods, and the slave is at the exact rest of its travel.
    let ends = rig.slave().cam_ends();
    assert!(ends > 27_000, "{ends}");
    let master = rig.master();
    // Whole numbers first: with millions of periods the rest is still exact.
    let gone = i64::from(ends) * 360;
    let turns = [gone / 1000, gone / 1000 + 1];
    let rest = turns.map(|turns| (turns * 1000 - gone) as f64 + master);
    let rest = rest.into_iter().find(|rest| (0.0..360.0).contains(rest)).unwrap();
    let mut other = Rig::new(config(fast, 0.0, None), config(faster, 0.0, None));
    other.follow(&up_and_back(), RELATIVE);
    other.command(
        MASTER,
        Command::MoveRelative {
            distance: rest,
            dynamics: Dynamics::at(1e4),
        },
    );
    other.steps(2000);
    assert!(
        (other.at() - rig.at()).abs() < 1e-9,
        "{} {}",
        other.at(),
        rig.at()
    );
}

/// Covers: G70, S8
#[test]
fn without_periods_it_ends_once_and_holds() {
    let mut rig = Rig::new(config(L1, 5.0, None), config(WIDE, 7.0, None));
    let rows = [row(0.0, 0.0, CamShape::Rest7), row(90.0, 30.0, CamShape::Rest7)];
    let once = CamSelection {
        periodic: false,
        ..RELATIVE
    };
    rig.follow(&rows, once);
    rig.run(100.0);
    rig.steps(1500);
    assert_eq!((rig.at(), rig.slave().cam_ends()), (37.0, 1));
    assert!(rig.slave().is_in_gear() && rig.state().is_at_rest());
    rig.run(-100.0);
    rig.steps(3000);
    assert_eq!((rig.at(), rig.slave().cam_ends()), (37.0, 1));
    assert!(rig.slave().is_in_gear());
    assert_eq!(rig.slave().state(), AxisState::SynchronizedMotion);
    // The waiting command starts at once from the held place.
    let request = standstill_axis::Request {
        buffer_mode: BufferMode::Buffered.into(),
        ..standstill_axis::Request::aborting(Command::MoveRelative {
            distance: 3.0,
            dynamics: Dynamics::at(50.0),
        })
    };
    let scope = &mut standstill_axis::Scope::new(rig.scan, &mut rig.log);
    rig.axes[SLAVE].command(&request, scope).unwrap();
    rig.steps(1000);
    assert_eq!(rig.at(), 40.0);
    rig.keeps_limits().unwrap();
}

/// Covers: G75
#[test]
fn a_cam_behind_a_cam_that_meets_it_stays_in_sync() {
    let mut rig = Rig::new(config(L1, 0.0, None), config(WIDE, 0.0, None));
    // Both cams continue from period to period with the same slope.
    let with_slope = |master, slave, slope| CamRow {
        slope,
        ..row(master, slave, CamShape::Poly7)
    };
    let steep = [
        with_slope(0.0, 0.0, 0.5),
        with_slope(90.0, 30.0, 0.2),
        with_slope(180.0, 75.0, 0.5),
    ];
    let flat = [
        with_slope(0.0, 0.0, 0.5),
        with_slope(120.0, 20.0, 0.1),
        with_slope(200.0, 50.0, 0.5),
    ];
    let (first, second) = (rig.select(&steep, RELATIVE), rig.select(&flat, RELATIVE));
    let (first, second) = (rig.cam_in(first), rig.cam_in(second));
    let first = rig.engage(first, BufferMode::Aborting).unwrap();
    rig.run(150.0);
    rig.step();
    let second = rig.engage(second, BufferMode::Buffered).unwrap();
    let mut switched = None;
    for n in 0..2500 {
        rig.step();
        // At first its velocity is not that of the cam.
        if n > 700 {
            assert!(rig.slave().is_in_gear(), "{n}");
        }
        if rig.slave().fate(first) == Fate::Aborted && switched.is_none() {
            switched = Some(n);
            assert_eq!(rig.slave().fate(second), Fate::Active { reached: true });
            assert!(rig.state().velocity > 70.0, "{:?}", rig.state());
            assert!((rig.at() - 75.0).abs() < 0.1, "{}", rig.at());
        }
    }
    assert!(switched.is_some());
    rig.keeps_limits().unwrap();
}

/// Covers: G76
#[test]
fn scalings_stretch_and_mirror() {
    for (slave_scaling, place) in [(2.0, 100.0), (-1.0, -50.0)] {
        let mut rig = Rig::new(config(L1, 0.0, None), config(WIDE, 0.0, None));
        let cam = rig.select(&up_and_back(), RELATIVE);
        let cam_in = standstill_axis::CamIn {
            master_scaling: 2.0,
            slave_scaling,
            ..rig.cam_in(cam)
        };
        rig.follow_cam(cam_in);
        rig.command(
            MASTER,
            Command::MoveRelative {
                distance: 180.0,
                dynamics: Dynamics::at(200.0),
            },
        );
        rig.steps(2000);
        assert!((rig.at() - place).abs() < 1e-12, "{}", rig.at());
        rig.keeps_limits().unwrap();
    }
}

/// Covers: G17, S7
#[test]
fn the_slave_keeps_its_velocity_when_it_is_let_go() {
    let mut rig = Rig::new(config(L1, 0.0, None), config(WIDE, 0.0, None));
    let id = rig.follow(&up_and_back(), RELATIVE);
    rig.run(200.0);
    rig.steps(585);
    let out = rig.command(SLAVE, Command::CamOut);
    assert_eq!(rig.slave().state(), AxisState::ContinuousMotion);
    assert_eq!(rig.slave().fate(id), Fate::Aborted);
    rig.step();
    assert_eq!(rig.slave().fate(out), Fate::Done);
    rig.steps(500);
    let kept = rig.state();
    assert!(kept.velocity > 200.0 && kept.acceleration == 0.0, "{kept:?}");
    rig.keeps_limits().unwrap();
    let again = standstill_axis::Request::aborting(Command::CamOut);
    let scope = &mut standstill_axis::Scope::new(rig.scan, &mut rig.log);
    assert_eq!(
        rig.axes[SLAVE].command(&again, scope),
        Err(standstill_axis::ErrorId::NotCoupled)
    );
}

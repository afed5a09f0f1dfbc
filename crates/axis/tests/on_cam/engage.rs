//! How a slave gets onto its cam, and what it does if it can't follow.

use super::rig::{L1, MASTER, RELATIVE, Rig, SLAVE, WIDE, config, row, up_and_back};
use standstill_axis::{
    AxisState, BufferMode, CamIn, CamRow, CamSelection, Command, Dynamics, ErrorId, Event, Fate, Limits,
    OnLimit, PhaseShift, Raw, Request, Scope, StartMode, ValueSource,
};
use standstill_planner::CamShape;

const ABSOLUTE: CamSelection = CamSelection {
    master_absolute: true,
    slave_absolute: true,
    ..RELATIVE
};

/// The slave's position on the cam of the table for a master there.
fn table(master: f64) -> f64 {
    let x = master.rem_euclid(360.0);
    let u = if x < 180.0 { x / 180.0 } else { (360.0 - x) / 180.0 };
    // 4-5-6-7 polynomial.
    100.0 * u * u * u * u * (35.0 + u * (-84.0 + u * (70.0 - 20.0 * u)))
}

/// Covers: G77
#[test]
fn onto_a_master_at_rest_it_moves_and_is_in_sync() {
    let mut rig = Rig::new(config(L1, 60.0, None), config(WIDE, -20.0, None));
    let id = rig.follow(&up_and_back(), ABSOLUTE);
    let mut scans = 0;
    while !rig.slave().is_in_gear() {
        rig.step();
        scans += 1;
        assert!(scans < 1000);
    }
    assert!((rig.at() - table(60.0)).abs() < 1e-12);
    assert_eq!(rig.slave().fate(id), Fate::Active { reached: true });
    // It takes as long as MC_MoveAbsolute, which needs the fewest scans.
    let mut other = Rig::new(config(L1, 0.0, None), config(WIDE, -20.0, None));
    let moved = other.command(
        SLAVE,
        Command::MoveAbsolute {
            position: rig.at(),
            dynamics: Dynamics::at(400.0),
            direction: Raw::default(),
        },
    );
    let mut least = 0;
    while other.slave().fate(moved) != Fate::Done {
        other.step();
        least += 1;
    }
    assert_eq!(scans, least);
    rig.run(200.0);
    rig.steps(2000);
    assert!(rig.slave().is_in_gear());
    let master = rig.master();
    assert!((rig.at() - table(master)).abs() < 1e-9);
    rig.keeps_limits().unwrap();
}

/// The slave waits on the curve ahead of its master, and starts so as to be in step with it.
///
/// Covers: G77, G78
#[test]
fn onto_a_moving_master_it_joins_ahead() {
    for (start, slave) in [(0.0, -20.0), (100.0, 50.0), (170.0, 30.0), (300.0, 0.5)] {
        let mut rig = Rig::new(config(L1, start, None), config(WIDE, slave, None));
        let cam = rig.select(&up_and_back(), ABSOLUTE);
        rig.run(200.0);
        rig.steps(400);
        rig.follow_cam(rig.cam_in(cam));
        assert_eq!(rig.slave().state(), AxisState::SynchronizedMotion);
        let mut scans = 0;
        let mut on_curve = false;
        while !rig.slave().is_in_gear() {
            rig.step();
            scans += 1;
            assert!(scans < 4000, "{start} {slave}");
            let shadow = rig.slave().coupled().and_then(|coupled| coupled.shadow);
            // Once on the curve it does not leave it.
            assert!(shadow.is_some() || !on_curve);
            on_curve |= shadow.is_some();
            if let Some(shadow) = shadow {
                assert!((rig.at() - table(shadow)).abs() < 1e-9, "{scans}");
            }
        }
        rig.steps(3000);
        assert!(rig.slave().is_in_gear());
        assert!((rig.at() - table(rig.master())).abs() < 1e-9);
        rig.keeps_limits().unwrap();
    }
}

/// Covers: G77
#[test]
fn a_sync_position_is_where_it_joins() {
    let mut rig = Rig::new(config(L1, 10.0, None), config(WIDE, -20.0, None));
    let cam = rig.select(&up_and_back(), ABSOLUTE);
    rig.run(200.0);
    rig.steps(300);
    let cam_in = CamIn {
        sync_position: 270.0,
        ..rig.cam_in(cam)
    };
    rig.follow_cam(cam_in);
    let mut rested = false;
    while !rig.slave().is_in_gear() {
        rig.step();
        assert!(rig.scan < 4000);
        rested |= rig.state().is_at_rest() && (rig.at() - 50.0).abs() < 1e-12;
    }
    assert!(rested);
    rig.keeps_limits().unwrap();
}

/// Covers: G72
#[test]
fn just_below_the_highest_velocity_it_is_in_sync_and_just_above_it_lags() {
    let one = |shape| {
        vec![
            row(0.0, 0.0, shape),
            row(180.0, 100.0, shape),
            row(360.0, 0.0, CamShape::Through),
        ]
    };
    let third = Limits {
        snap: f64::INFINITY,
        ..WIDE
    };
    let through: Vec<_> = (0..=12)
        .map(|index| {
            let x = f64::from(index) * 30.0;
            row(x, table(x), CamShape::Through)
        })
        .collect();
    let with_slopes = |shape| {
        let with = |master, slave, slope, curvature| CamRow {
            slope,
            curvature,
            ..row(master, slave, shape)
        };
        vec![
            with(0.0, 0.0, 0.5, 0.0),
            with(120.0, 90.0, 0.3, -2e-3),
            with(360.0, 20.0, 0.5, 0.0),
        ]
    };
    // A cam that is straight without end needs only velocity.
    let straight = vec![
        row(0.0, 0.0, CamShape::Line),
        row(180.0, 60.0, CamShape::Line),
        row(360.0, 120.0, CamShape::Through),
    ];
    let slow = WIDE.with_velocity(100.0);
    for (rows, limits) in [
        (with_slopes(CamShape::Poly7), WIDE),
        (with_slopes(CamShape::Poly5), third),
        (straight, slow),
        (one(CamShape::Rest7), WIDE),
        (one(CamShape::Rest5), third),
        (through, WIDE),
        (one(CamShape::Rest7), WIDE.with_velocity(4e3)),
        (
            one(CamShape::Rest7),
            Limits {
                velocity: 4e3,
                acceleration: 1e5,
                deceleration: 1e5,
                ..WIDE
            },
        ),
    ] {
        for (share, follows) in [(0.999, true), (1.03, false)] {
            let fast = Limits {
                velocity: 1e4,
                acceleration: 20.0,
                deceleration: 20.0,
                jerk: 100.0,
                snap: 1e4,
            };
            let mut rig = Rig::new(config(fast, 0.0, None), config(limits, 0.0, None));
            let cam = rig.select(&rows, RELATIVE);
            let velocity = rig.highest(cam) * share;
            rig.follow_cam(rig.cam_in(cam));
            rig.step();
            rig.run(velocity);
            for _ in 0..60_000 {
                rig.step();
                if follows {
                    assert!(rig.slave().is_in_gear(), "{limits:?} {}", rig.scan);
                }
            }
            assert_eq!(rig.axes[MASTER].setpoint().velocity, velocity);
            assert_eq!(rig.slave().is_in_gear(), follows);
            rig.keeps_limits().unwrap();
        }
    }
}

/// Covers: G47, G48, G78
#[test]
fn a_master_too_fast_is_followed_on_the_curve_and_caught_up_with() {
    let narrow = Limits {
        velocity: 300.0,
        acceleration: 1200.0,
        deceleration: 1200.0,
        jerk: 1e4,
        snap: 3e5,
    };
    let fast = L1.with_velocity(600.0);
    let mut rig = Rig::new(config(fast, 0.0, None), config(narrow, 0.0, None));
    let cam = rig.select(&up_and_back(), RELATIVE);
    rig.follow_cam(rig.cam_in(cam));
    rig.run(80.0);
    rig.steps(3000);
    assert!(rig.slave().is_in_gear());
    rig.events();
    rig.run(500.0);
    rig.step();
    let lost = |event: &Event| matches!(event, Event::SyncLost { .. });
    assert!(rig.events().iter().any(lost));
    assert!(!rig.slave().is_in_gear());
    let highest = rig.highest(cam);
    // At any velocity, its other derivatives have at most the limits of the slave at the steepest part of the cam.
    let steepest = 100.0 / 180.0 * 2.1875;
    let most = [narrow.acceleration, narrow.jerk, narrow.snap].map(|limit| 1.001 * limit / steepest);
    let mut last = None;
    let (mut ways, mut lagging) = ([0.0_f64; 4], 0_u32);
    for scan in 0..20_000 {
        if scan == 6000 {
            rig.run(100.0);
        }
        rig.step();
        let master = rig.master();
        let shadow = rig.slave().coupled().unwrap().shadow.unwrap();
        assert!((rig.at() - table(shadow)).abs() < 1e-9, "{scan}");
        // It is never ahead, except that its position may be in the next period of the master.
        assert!(shadow <= master + 360.0, "{scan}: {shadow} {master}");
        if let Some(last) = last {
            let way: f64 = shadow - last;
            let way = way - 360.0 * (way / 360.0).round();
            let speed = way / 1e-3;
            assert!(speed >= -1e-9 && speed <= highest, "{scan}: {speed}");
            ways.rotate_right(1);
            ways[0] = way;
            lagging = if rig.slave().is_in_gear() { 0 } else { lagging + 1 };
            let [a, b, c, d] = ways;
            let told = [
                (a - b) / 1e-6,
                (a - 2.0 * b + c) / 1e-9,
                (a - 3.0 * b + 3.0 * c - d) / 1e-12,
            ];
            // Before it lagged it was at the place of its master.
            let keeps = told.iter().zip(most).all(|(found, most)| found.abs() <= most);
            assert!(lagging < 5 || keeps, "{scan}: {told:?} {most:?}");
        }
        last = Some(shadow);
    }
    assert!(
        rig.slave().is_in_gear(),
        "{:?} {:?}",
        rig.slave().coupled(),
        rig.events()
    );
    assert_eq!(rig.slave().deviation(), 0.0);
    rig.keeps_limits().unwrap();
}

/// Covers: G50
#[test]
fn with_on_limit_error_it_stops_before_a_limit() {
    let mut slave = config(WIDE, 0.0, None);
    slave.following.on_limit = OnLimit::Error;
    let fast = L1.with_velocity(800.0);
    let mut rig = Rig::new(config(fast, 0.0, None), slave);
    rig.follow(&up_and_back(), RELATIVE);
    rig.step();
    rig.run(800.0);
    rig.steps(300);
    assert!(rig.slave().is_in_gear());
    rig.steps(2000);
    assert_eq!(rig.slave().state(), AxisState::ErrorStop);
    assert_eq!(rig.slave().error_id(), ErrorId::DeviationTooLarge);
    rig.keeps_limits().unwrap();
}

/// Covers: G55, G58
#[test]
fn moved_coordinates_and_stops_of_the_master_do_not_end_it() {
    let mut rig = Rig::new(config(L1, 0.0, None), config(WIDE, 0.0, None));
    rig.follow(&up_and_back(), RELATIVE);
    rig.run(150.0);
    rig.steps(700);
    for (axis, by) in [(MASTER, 1000.0), (SLAVE, -30.0)] {
        let scope = &mut Scope::new(rig.scan, &mut rig.log);
        rig.axes[axis]
            .set_position(
                by,
                true,
                standstill_axis::ExecutionMode::Immediately.into(),
                scope,
            )
            .unwrap();
        let before = rig.state();
        rig.step();
        let after = rig.state();
        assert!((after.velocity - before.velocity).abs() < 2.0, "{axis}");
        rig.steps(200);
        assert!(rig.slave().is_in_gear());
    }
    rig.command(
        MASTER,
        Command::Stop {
            dynamics: Dynamics::default(),
        },
    );
    rig.steps(1000);
    assert!(rig.slave().is_in_gear() && rig.axes[MASTER].setpoint().is_at_rest());
    let master = rig.master();
    assert!((rig.at() + 30.0 - table(master - 1000.0)).abs() < 1e-9);
}

/// Covers: G80, G76
#[test]
fn what_is_no_good_is_refused_by_number() {
    let mut rig = Rig::new(config(L1, 0.0, None), config(WIDE, 0.0, None));
    let cam = rig.select(&up_and_back(), RELATIVE);
    let good = rig.cam_in(cam);
    let mut refused = |cam_in: CamIn| rig.engage(cam_in, BufferMode::Aborting).unwrap_err();
    for scaling in [0.0, f64::NAN, f64::INFINITY, 1e-40] {
        let wrong = CamIn {
            master_scaling: scaling,
            ..good
        };
        assert_eq!(refused(wrong), ErrorId::CamScalingInvalid);
        let wrong = CamIn {
            slave_scaling: scaling,
            ..good
        };
        assert_eq!(refused(wrong), ErrorId::CamScalingInvalid);
    }
    let wrong = CamIn {
        slave_offset: f64::NAN,
        ..good
    };
    assert_eq!(refused(wrong), ErrorId::CamScalingInvalid);
    let wrong = CamIn {
        sync_position: f64::INFINITY,
        ..good
    };
    assert_eq!(refused(wrong), ErrorId::SyncPositionInvalid);
    let wrong = CamIn {
        start_distance: 360.0,
        ..good
    };
    assert_eq!(refused(wrong), ErrorId::SyncPositionInvalid);
    let wrong = CamIn {
        start_mode: Raw::new(7),
        ..good
    };
    assert_eq!(refused(wrong), ErrorId::SyncModeInvalid);
    let wrong = CamIn {
        source: ValueSource::Commanded.into(),
        ..good
    };
    assert_eq!(refused(wrong), ErrorId::MasterSourceInvalid);
    let wrong = CamIn {
        table: standstill_axis::CamId::NONE,
        ..good
    };
    assert_eq!(refused(wrong), ErrorId::CamUnknown);
    rig.retire(cam);
    assert_eq!(rig.engage(good, BufferMode::Aborting), Err(ErrorId::CamUnknown));
}

/// Covers: G74
#[test]
fn a_cam_selected_anew_does_not_change_the_one_in_use() {
    let mut rig = Rig::new(config(L1, 0.0, None), config(WIDE, 0.0, None));
    let cam = rig.select(&up_and_back(), RELATIVE);
    rig.follow_cam(rig.cam_in(cam));
    rig.run(200.0);
    rig.steps(500);
    rig.retire(cam);
    let other = [
        row(0.0, 0.0, CamShape::Rest7),
        row(180.0, 1.0, CamShape::Rest7),
        row(360.0, 0.0, CamShape::Through),
    ];
    for _ in 0..3 {
        let id = rig.select(&other, RELATIVE);
        rig.retire(id);
    }
    rig.steps(500);
    assert!(rig.slave().is_in_gear());
    assert!((rig.at() - table(rig.master())).abs() < 1e-9);
}

/// Covers: G66, G17
#[test]
fn what_is_superimposed_moves_the_cam_on() {
    let mut rig = Rig::new(config(L1, 0.0, None), config(WIDE, 0.0, None));
    let cam = rig.select(&up_and_back(), RELATIVE);
    let cam_in = CamIn {
        start_mode: StartMode::Relative.into(),
        ..rig.cam_in(cam)
    };
    rig.follow_cam(cam_in);
    rig.steps(2);
    let scope = &mut Scope::new(rig.scan, &mut rig.log);
    let added = standstill_axis::Superimpose {
        distance: 1.0,
        dynamics: Dynamics::at(1.0),
    };
    let id = rig.axes[SLAVE].superimpose(&added, scope).unwrap();
    rig.run(100.0);
    let mut ended = None;
    for scan in 0..5000 {
        rig.step();
        assert!(rig.slave().is_in_gear(), "{:?}", rig.events());
        let at = table(rig.master());
        if ended.is_none() && rig.slave().covered_distance(id) == Some(1.0) {
            ended = Some(scan);
        }
        if ended.is_some_and(|ended| scan > ended) {
            assert!((rig.at() - at - 1.0).abs() < 1e-9);
        }
        assert!((-1e-9..=1.0 + 1e-9).contains(&(rig.at() - at)));
    }
    assert!(ended.is_some());
    rig.keeps_limits().unwrap();
    let scope = &mut Scope::new(rig.scan, &mut rig.log);
    let gear_out = Request::aborting(Command::GearOut);
    assert_eq!(
        rig.axes[SLAVE].command(&gear_out, scope),
        Err(ErrorId::NotCoupled)
    );
}

/// A plan with switches between scans is nevertheless checked against the cam piece by piece.
#[test]
fn a_stop_from_speed_is_followed() {
    let mut rig = Rig::new(config(L1, 0.0, None), config(WIDE, 0.0, None));
    rig.follow(&up_and_back(), RELATIVE);
    rig.run(-200.0);
    rig.steps(3291);
    rig.command(
        MASTER,
        Command::MoveAbsolute {
            position: -720.05,
            dynamics: Dynamics::at(100.0),
            direction: Raw::default(),
        },
    );
    for _ in 0..1500 {
        rig.step();
        assert!(rig.slave().is_in_gear(), "{:?}", rig.events());
    }
    rig.keeps_limits().unwrap();
}

/// A line of its master far away does not make the places of a shadow coarser.
///
/// Covers: G45
#[test]
fn a_slave_near_0_keeps_its_limits_behind_a_master_far_away() {
    let fast = Limits {
        velocity: 1e5,
        acceleration: 1e6,
        deceleration: 1e6,
        jerk: 1e8,
        snap: 1e10,
    };
    let slow = Limits {
        velocity: 50.0,
        acceleration: 500.0,
        deceleration: 500.0,
        jerk: 5e3,
        snap: 1e5,
    };
    let mut rig = Rig::new(config(fast, 0.0, None), config(slow, 0.0, None));
    // Equally steep everywhere, so that its shadow uses all of a limit.
    let rows = [row(0.0, 0.0, CamShape::Line), row(360.0, 100.0, CamShape::Line)];
    rig.follow(&rows, RELATIVE);
    rig.run(1e5);
    rig.steps(1000);
    rig.run(5.0);
    rig.steps(1500);
    assert!(rig.slave().deviation() < -1e4 && rig.at().abs() < 200.0);
    assert_eq!(rig.keeps_limits(), Ok(()));
}

/// A way back of many turns makes the places of a shadow no coarser than one of a few turns. The master came to rest
/// many periods ahead, or went on slowly there, or was too fast to follow.
///
/// Covers: G45, G48, G78
#[test]
fn however_far_behind_a_slave_comes_back_within_its_limits() {
    let master = Limits {
        velocity: 1e6,
        acceleration: 1e7,
        deceleration: 1e7,
        jerk: 1e9,
        snap: 1e11,
    };
    let slave = Limits {
        velocity: 8e3,
        acceleration: 4e3,
        deceleration: 4e3,
        jerk: 1e4,
        snap: 1e5,
    };
    // Equally steep everywhere, so that its shadow uses all of a limit.
    let rows = [row(0.0, 0.0, CamShape::Line), row(360.0, 360.0, CamShape::Line)];
    for periods in [50.0, 510.0, 5000.0] {
        let way = periods * 360.0;
        let comes_to_rest = |rig: &mut Rig| {
            let dynamics = Dynamics::at(1e6);
            let distance = way;
            rig.command(MASTER, Command::MoveRelative { distance, dynamics });
        };
        let goes_on = |rig: &mut Rig| {
            rig.run(1e6);
            rig.steps((way / 1e3) as usize + 150);
            rig.run(5.0);
        };
        let is_too_fast = |rig: &mut Rig| {
            rig.run(2e4);
            rig.steps((way / 1e2) as usize);
            rig.run(5.0);
        };
        let masters: [&dyn Fn(&mut Rig); 3] = [&comes_to_rest, &goes_on, &is_too_fast];
        for (number, moves) in masters.into_iter().enumerate() {
            let turns = |limits| config(limits, 0.0, Some(360.0));
            let mut rig = Rig::new(turns(master), turns(slave));
            rig.follow(&rows, RELATIVE);
            moves(&mut rig);
            rig.steps(300);
            assert!(!rig.slave().is_in_gear());
            assert!(
                rig.slave().deviation() < -0.05 * way,
                "{}",
                rig.slave().deviation()
            );
            let mut scans = 0;
            while !rig.slave().is_in_gear() {
                rig.step();
                scans += 1;
                assert!(scans < 300_000, "{periods} periods, master {number}");
            }
            assert_eq!(rig.keeps_limits(), Ok(()), "{periods} periods, master {number}");
        }
    }
}

/// A number for a shift of many turns is as coarse as it is large. This causes no snap of the slave, which stays in
/// sync.
///
/// Covers: G60
#[test]
fn a_shift_of_many_turns_keeps_the_slave_in_sync() {
    let slave = Limits {
        velocity: 2000.0,
        acceleration: 2000.0,
        deceleration: 2000.0,
        jerk: 1e4,
        snap: 1e5,
    };
    let mut rig = Rig::new(config(L1, 0.0, Some(360.0)), config(slave, 0.0, Some(100.0)));
    let rows = [row(0.0, 0.0, CamShape::Line), row(360.0, 100.0, CamShape::Line)];
    rig.follow(&rows, RELATIVE);
    rig.run(5.0);
    rig.steps(500);
    let request = PhaseShift {
        master: rig.axes[MASTER].id(),
        shift: 510.0 * 360.0,
        is_relative: false,
        dynamics: Dynamics::at(5000.0),
        buffer_mode: BufferMode::Aborting.into(),
    };
    let scope = &mut Scope::new(rig.scan, &mut rig.log);
    rig.axes[SLAVE].shift_phase(&request, scope).unwrap();
    for scan in 0..38_000 {
        rig.step();
        assert!(rig.slave().is_in_gear(), "scan {scan}: {:?}", rig.events());
    }
    assert_eq!(rig.slave().phases()[0], request.shift);
    assert_eq!(rig.slave().state(), AxisState::SynchronizedMotion);
}

//! The effect of a stop or a fault of the resource on axes, and the state at a start.
//!
//! Ids: OV faults, ST starts, TM-6 nominal tick, SC-6 axes in a scan.

use crate::common::{MS, Rig};
use standstill_axis::{
    Axis, AxisId, AxisState, Command, Direction, DriveRequest, Dynamics, ErrorId, Followed, InstanceId,
    Master, Permission, Planner, Raw, Request, ValueSource, couple,
};
use standstill_fb::Context;
use standstill_scan::{Mode, NotOff, ProgramFault, ScanReport, Start};

const DYNAMICS: Dynamics = Dynamics {
    velocity: 20.0,
    acceleration: 0.0,
    deceleration: 0.0,
    jerk: 0.0,
    snap: 0.0,
};

fn command<P: Planner>(context: &mut Context<'_, P>, command: Command) {
    context.scope.instance = InstanceId(3);
    let (axis, scope) = context.axis(AxisId::new(0)).unwrap();
    axis.command(&Request::aborting(command), scope).unwrap();
}

pub fn forward<P: Planner>(context: &mut Context<'_, P>) {
    let direction: Raw<Direction> = Direction::Positive.into();
    command(
        context,
        Command::MoveVelocity {
            dynamics: DYNAMICS,
            direction,
        },
    );
}

fn back<P: Planner>(context: &mut Context<'_, P>) {
    command(
        context,
        Command::MoveAbsolute {
            position: -100.0,
            dynamics: DYNAMICS,
            direction: Raw::new(0),
        },
    );
}

struct Moving {
    rig: Rig,
    scan: i64,
}

impl Moving {
    /// An axis that has moved at a constant 20 u/s for some scans.
    fn new() -> Self {
        let mut rig = Rig::of_axes(&["X"]);
        rig.host.act = |scan, context| match scan {
            0 => {
                forward(context);
                Ok(())
            }
            501 => {
                back(context);
                Err(ProgramFault { reason: "trap" })
            }
            _ => Ok(()),
        };
        let mut moving = Self { rig, scan: 0 };
        for _ in 0..500 {
            moving.scan();
        }
        assert_eq!(moving.axis().setpoint().velocity, 20.0);
        assert_eq!(moving.axis().state(), AxisState::ContinuousMotion);
        moving
    }

    fn scan(&mut self) -> ScanReport {
        self.scan += 1;
        self.rig.scan_at((self.scan - 1) * MS as i64)
    }

    fn axis(&self) -> &Axis {
        &self.rig.machine.axes()[0]
    }

    fn start(&mut self) -> Result<(), NotOff> {
        self.rig
            .executor
            .start(Start::Cold, &mut self.rig.host, &self.rig.machine)
    }

    /// Scans until the axis is Disabled. It slows down to rest without turning round, and is switched off.
    fn comes_to_rest(&mut self) {
        let mut velocity = 20.0;
        for _ in 0..2000 {
            self.scan();
            let now = self.axis().setpoint().velocity;
            assert!((0.0..=velocity).contains(&now), "{now} after {velocity}");
            velocity = now;
            if self.axis().state() == AxisState::Disabled {
                let last = self.rig.machine.drives()[0].written.last().unwrap();
                assert_eq!(last.request, DriveRequest::Off);
                return;
            }
            assert_eq!(self.axis().state(), AxisState::Stopping);
        }
        panic!("the axis never came to rest");
    }
}

/// SC-6: a command given in scan k changes the set-point published in scan k.
#[test]
fn a_command_moves_the_axis_in_its_own_scan() {
    let mut rig = Rig::of_axes(&["X"]);
    rig.host.act = |scan, context| {
        if scan == 3 {
            forward(context);
        }
        Ok(())
    };
    for scan in 0..5 {
        rig.scan_at(scan * MS as i64);
        let written = rig.machine.drives()[0].written.last().unwrap();
        assert_eq!(written.velocity > 0.0, scan >= 3, "scan {scan}");
    }
}

/// TM-6: the same scans at any instants give the same set-points, bit for bit.
#[test]
fn late_scans_do_not_change_the_profile() {
    let written = |late: i64| {
        let mut rig = Rig::of_axes(&["X"]);
        rig.host.act = |scan, context| {
            if scan == 0 {
                back(context);
            }
            Ok(())
        };
        for scan in 0..400 {
            rig.scan_at(scan * MS as i64 + scan / 5 * late);
        }
        rig.machine.drives()[0].written.clone()
    };
    assert_eq!(written(0), written(170_000));
    assert_eq!(written(0), written(7_300_000));
}

/// OV-3, OV-6: the axis ramps down and is switched off, although no program runs. The command given in the
/// scan of the fault never shows. The state can be read all the time.
#[test]
fn a_fault_stops_every_axis() {
    let mut moving = Moving::new();
    moving.scan();
    assert_eq!(moving.scan().mode.fault(), moving.rig.host.failed.first());
    assert_eq!(moving.axis().state(), AxisState::Stopping);
    assert!(moving.axis().setpoint().velocity <= 20.0);
    moving.comes_to_rest();
    assert!(matches!(moving.rig.executor.mode(), Mode::Faulted(_)));
}

/// ST-4: a start is refused until the axis is Disabled; then programs run again, and nothing moves.
#[test]
fn a_start_waits_for_axes_that_are_off() {
    let mut moving = Moving::new();
    let refused = moving.start().unwrap_err();
    assert_eq!(refused.state, AxisState::ContinuousMotion);
    assert_eq!(
        refused.to_string(),
        "axis 0 is in ContinuousMotion: stop the resource and go on scanning until every axis is Disabled, \
         then start"
    );
    moving
        .rig
        .executor
        .stop(&mut moving.rig.host, &mut moving.rig.machine);
    assert_eq!(moving.rig.executor.mode(), Mode::Stopped);
    assert_eq!(moving.start().unwrap_err().state, AxisState::Stopping);
    moving.comes_to_rest();

    moving.start().unwrap();
    moving.rig.host.act = |_, _| Ok(());
    for _ in 0..10 {
        assert_eq!(moving.scan().executions, 1);
        let axis = moving.axis();
        assert_eq!(axis.state(), AxisState::Disabled);
        assert_eq!(axis.setpoint().position, axis.actual_position());
        assert_eq!(axis.setpoint().velocity, 0.0);
    }
}

/// ST-4: ErrorStop is a state to start from only once the axis has come to rest.
#[test]
fn a_start_waits_for_the_ramp_of_an_axis_fault() {
    let mut moving = Moving::new();
    moving.rig.host.act = |_, context| {
        let (axis, scope) = context.axis(AxisId::new(0)).unwrap();
        axis.raise(ErrorId::AxisFault, 0, scope);
        Ok(())
    };
    moving.scan();
    moving.rig.host.act = |_, _| Ok(());
    let mut refused = 0;
    while let Err(error) = moving.start() {
        assert_eq!(error.state, AxisState::ErrorStop);
        assert!(!moving.axis().setpoint().is_at_rest());
        moving.scan();
        refused += 1;
        assert!(refused < 2000);
    }
    assert!(refused > 10);
    assert_eq!(moving.axis().state(), AxisState::ErrorStop);
}

/// Before the first scan axes may be powered by configuration; a start leaves them so.
#[test]
fn the_first_start_keeps_configured_states() {
    let mut rig = Rig::of_axes(&["X"]);
    rig.executor
        .start(Start::Cold, &mut rig.host, &rig.machine)
        .unwrap();
    rig.scan_at(0);
    assert_eq!(rig.machine.axes()[0].state(), AxisState::Standstill);
}

/// Stopping twice, or after a fault, changes nothing: the fault stays readable.
#[test]
fn a_stop_after_a_fault_keeps_the_fault() {
    let mut moving = Moving::new();
    moving.scan();
    let mode = moving.scan().mode;
    moving
        .rig
        .executor
        .stop(&mut moving.rig.host, &mut moving.rig.machine);
    assert_eq!(moving.rig.executor.mode(), mode);
    assert_eq!(moving.rig.host.failed.len(), 1);
}

/// Y follows X, 1/1.
fn gear<P: Planner>(context: &mut Context<'_, P>) {
    let gear = Command::GearIn {
        followed: Followed {
            master: Master {
                axis: AxisId::new(0),
                turn: None,
            },
            numerator: 1,
            denominator: 1,
            source: Raw::from(ValueSource::Set),
        },
        sync: None,
        dynamics: Dynamics::default(),
    };
    let request = Request::aborting(gear);
    couple(context.axes, AxisId::new(1), &request, &mut context.scope).unwrap();
}

/// Covers: G86
#[test]
fn a_start_finds_no_coupling_from_before_the_stop() {
    let mut rig = Rig::of_axes(&["X", "Y"]);
    rig.host.act = |scan, context| {
        match scan {
            0 => {
                gear(context);
                forward(context);
            }
            // After the second start: power, then X alone.
            3000..3100 => {
                for axis in 0..2 {
                    let (axis, scope) = context.axis(AxisId::new(axis)).unwrap();
                    axis.set_power(true, Permission::BOTH, scope);
                }
            }
            3100 => forward(context),
            _ => {}
        }
        Ok(())
    };
    let mut scan = 0;
    let mut scans = |rig: &mut Rig, count: i64| {
        for _ in 0..count {
            rig.scan_at(scan * MS as i64);
            scan += 1;
        }
    };
    scans(&mut rig, 500);
    let [_, slave] = rig.machine.axes() else {
        panic!("two axes")
    };
    assert!(slave.is_in_gear() && slave.setpoint().velocity == 20.0);
    rig.executor.stop(&mut rig.host, &mut rig.machine);
    scans(&mut rig, 2500);
    for axis in rig.machine.axes() {
        assert_eq!(axis.state(), AxisState::Disabled);
        assert!(axis.master().is_none() && !axis.is_in_gear());
    }
    let rest = rig.machine.axes()[1].setpoint();
    assert!(rest.is_at_rest());
    rig.executor
        .start(Start::Cold, &mut rig.host, &rig.machine)
        .unwrap();
    scans(&mut rig, 500);
    let [master, slave] = rig.machine.axes() else {
        panic!("two axes")
    };
    assert_eq!(master.setpoint().velocity, 20.0);
    assert_eq!(slave.state(), AxisState::Standstill);
    assert_eq!(slave.setpoint().position.to_bits(), rest.position.to_bits());
}

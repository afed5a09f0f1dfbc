//! The motion step visits every axis once, in the order of their numbers.
//!
//! The planner of this test notes which axis asks its plan for a set-point.

use standstill_axis::{
    AxisConfig, AxisId, Command, Direction, DrivePosition, Dynamics, Excess, IdealDrive, Limits, MoveProfile,
    Passage, Plan, PlanError, Planner, ProfileFault, ProfileKind, ProfilePoint, Raw, Request, Setpoint,
    StartState,
};
use standstill_fb::Context;
use standstill_scan::{
    Executor, Machine, ProgramConfig, ProgramFault, ProgramId, Programs, ScanTime, TaskConfig,
};
use std::cell::RefCell;

thread_local! {
    static VISITED: RefCell<Vec<usize>> = const { RefCell::new(Vec::new()) };
}

struct Noting(usize);

#[derive(Clone, Copy, Debug)]
struct Note(usize);

impl Planner for Noting {
    type Plan = Note;

    fn cycle(&self) -> f64 {
        0.001
    }

    fn move_to(
        &self,
        _: MoveProfile,
        _: &Setpoint,
        _: f64,
        _: &Limits,
        _: &Limits,
    ) -> Result<Note, PlanError> {
        Ok(Note(self.0))
    }

    fn ramp_to(&self, _: &Setpoint, _: f64, _: &Limits, _: &Limits) -> Result<Note, PlanError> {
        Ok(Note(self.0))
    }

    fn pass(&self, _: &Setpoint, _: f64, _: f64, _: &Limits, _: &Limits) -> Result<Note, PlanError> {
        Ok(Note(self.0))
    }

    fn blend(
        &self,
        _: &Setpoint,
        _: f64,
        _: &Passage,
        _: &Limits,
        _: &Limits,
    ) -> Result<Option<Note>, PlanError> {
        Ok(None)
    }

    fn profile(
        &self,
        _: ProfileKind,
        _: &Setpoint,
        _: &[ProfilePoint],
        _: &Limits,
        _: Option<(f64, f64)>,
    ) -> Result<Note, ProfileFault> {
        Ok(Note(self.0))
    }

    fn entry_speed(&self, wanted: f64, _: f64, _: f64, _: &Limits) -> f64 {
        wanted
    }

    fn fits(&self, _: (&Note, u64), _: (&Note, u64), _: &Limits, _: Option<(f64, f64)>) -> bool {
        true
    }

    fn room(&self, _: (&Note, u64), limits: &Limits) -> Limits {
        *limits
    }

    fn next_switch(&self, (_, elapsed): (&Note, u64)) -> u64 {
        elapsed
    }

    fn ways(&self, _: (&Note, u64)) -> (f64, f64) {
        (0.0, 0.0)
    }
}

impl Plan for Note {
    fn scans(&self) -> u32 {
        1000
    }

    fn at(&self, scan: u64) -> Setpoint {
        VISITED.with_borrow_mut(|visited| visited.push(self.0));
        Setpoint::at_rest(1e-3 * scan as f64)
    }

    fn shift(&mut self, _: f64) {}

    fn excess(&self) -> Option<Excess> {
        None
    }

    fn excess_over(&self, _: &Limits) -> Option<Excess> {
        None
    }
}

/// Sets every axis in motion in scan 0.
struct MoveAll;

impl Programs<Noting, IdealDrive> for MoveAll {
    fn run(&mut self, _: ProgramId, context: &mut Context<'_, Noting>) -> Result<u64, ProgramFault> {
        if context.scope.scan > 0 {
            return Ok(0);
        }
        let direction: Raw<Direction> = Direction::Positive.into();
        let request = Request::aborting(Command::MoveVelocity {
            dynamics: Dynamics {
                velocity: 1.0,
                ..Dynamics::default()
            },
            direction,
        });
        for index in 0..3 {
            let (axis, scope) = context.axis(AxisId::new(index)).unwrap();
            axis.command(&request, scope).unwrap();
        }
        Ok(0)
    }

    /// Forgets the visits of commands, which look into their plans too.
    fn observe(&mut self, _: ScanTime, _: &Machine<Noting, IdealDrive>) {
        VISITED.take();
    }
}

#[test]
fn axes_advance_once_each_in_the_order_of_their_numbers() {
    let mut machine = Machine::new();
    for index in 0..3 {
        let limits = Limits {
            velocity: 50.0,
            acceleration: 200.0,
            deceleration: 200.0,
            jerk: 2000.0,
            snap: 40000.0,
        };
        let config = AxisConfig {
            start: StartState::Standstill,
            ..AxisConfig::new(limits)
        };
        let drive = IdealDrive::new(DrivePosition::Units(0.0), 0, Some(0), true);
        machine.add_axis(config, Noting(index), drive).unwrap();
    }
    let tasks = [TaskConfig::every("main", 1)];
    let mut executor = Executor::new(1, &tasks, &[ProgramConfig::with("all", "main")]).unwrap();
    for scan in 0..3 {
        executor.scan(scan, &mut MoveAll, &mut machine).unwrap();
        assert_eq!(VISITED.take(), [0, 1, 2], "scan {scan}");
    }
}

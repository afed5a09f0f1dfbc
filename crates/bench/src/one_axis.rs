//! One axis with MC_Power and MC_MoveAbsolute: in a host's own loop without a drive model, and in an
//! executor.

use standstill_axis::{
    Axis, AxisConfig, AxisId, Comms, ConfigError, DriveCommand, DriveFeedback, DrivePosition, DriveSignals,
    IdealDrive, InstanceId, Limits, Log, Plan, Scope, Standard, StartState, steps,
};
use standstill_blocks::administrative::mc_power::McPower;
use standstill_blocks::single_axis::mc_move_absolute::McMoveAbsolute;
use standstill_fb::{Context, Instance};
use standstill_scan::{
    Executor, Machine, ProgramConfig, ProgramFault, ProgramId, Programs, ScanReport, TimeRanBackwards,
};
use std::error::Error;

/// Limits of the axis: all four are reached in a move of 1.5 u.
pub const LIMITS: Limits = Limits {
    velocity: 1.2,
    acceleration: 15.0,
    deceleration: 15.0,
    jerk: 400.0,
    snap: 21000.0,
};

/// The target of the move (u); it starts at 0.
pub const TARGET: f64 = 1.5;

/// Sample time (s).
pub const CYCLE: f64 = 0.001;

/// One axis, two blocks, and a drive that follows at once.
#[derive(Clone, Debug)]
pub struct OneAxis {
    axes: [Axis; 1],
    log: Log,
    power: Instance<McPower>,
    /// MC_MoveAbsolute to [`TARGET`], Execute FALSE.
    pub to_target: Instance<McMoveAbsolute>,
    feedback: DriveFeedback,
    scan: u64,
}

impl OneAxis {
    /// A powered axis that has been at rest at 0 for a scan.
    ///
    /// # Errors
    /// None with these constants.
    pub fn at_rest() -> Result<Self, ConfigError> {
        let mut axis = Self {
            axes: [Axis::new(AXIS, config(), Standard::new(CYCLE))?],
            log: Log::default(),
            power: power(),
            to_target: to_target(),
            feedback: feedback(DrivePosition::Units(0.0)),
            scan: 0,
        };
        axis.scan();
        Ok(axis)
    }

    /// The axis in the first scan of its move, and the number of further scans that the move takes.
    ///
    /// # Errors
    /// None with these constants.
    pub fn in_motion() -> Result<(Self, u64), ConfigError> {
        let mut axis = Self::at_rest()?;
        axis.to_target.inputs.execute = true;
        axis.scan();
        let [moving] = &axis.axes;
        let scans = moving.plan().map_or(0, |(plan, _)| plan.scans());
        Ok((axis, u64::from(scans).saturating_sub(2)))
    }

    /// One scan: feedback, both blocks, motion step, drive command.
    // Inlined into the loop that times it, like the yardstick.
    #[inline(always)]
    pub fn scan(&mut self) -> DriveCommand {
        let Self { axes, log, .. } = self;
        let mut context = Context {
            now_ns: self.scan as i64 * 1_000_000,
            scope: Scope::new(self.scan, log),
            axes,
            tables: &[],
        };
        context.axes[0].follow_feedback(&self.feedback, &mut context.scope);
        self.power.call(&mut context);
        context.scope.instance = InstanceId(1);
        self.to_target.call(&mut context);
        context.scope.instance = InstanceId(0);
        steps::advance(context.axes, &mut context.scope);
        let command = context.axes[0].drive_command();
        self.feedback.position = command.position;
        self.scan += 1;
        command
    }
}

/// The same axis and blocks in a machine with an ideal drive, run by an executor.
#[derive(Clone, Debug)]
pub struct Executed {
    executor: Executor,
    machine: Machine,
    /// The host's program.
    pub program: Program,
    now_ns: i64,
}

/// A program of the two blocks.
#[derive(Clone, Debug)]
pub struct Program {
    power: Instance<McPower>,
    /// MC_MoveAbsolute to [`TARGET`].
    pub to_target: Instance<McMoveAbsolute>,
}

impl Programs<Standard, IdealDrive> for Program {
    fn run(&mut self, _: ProgramId, context: &mut Context<'_>) -> Result<u64, ProgramFault> {
        context.scope.instance = InstanceId(0);
        self.power.call(context);
        context.scope.instance = InstanceId(1);
        self.to_target.call(context);
        Ok(0)
    }
}

impl Executed {
    /// As [`OneAxis::at_rest`].
    ///
    /// # Errors
    /// None with these constants.
    pub fn at_rest() -> Result<Self, Box<dyn Error>> {
        let mut machine = Machine::new();
        let drive = IdealDrive::new(DrivePosition::Units(0.0), 0, Some(0), true);
        machine.add_axis(config(), Standard::new(CYCLE), drive)?;
        let mut rig = Self {
            executor: Executor::new(1_000_000, &[], &[ProgramConfig::free("main")])?,
            machine,
            program: Program {
                power: power(),
                to_target: to_target(),
            },
            now_ns: 0,
        };
        rig.scan()?;
        Ok(rig)
    }

    /// As [`OneAxis::in_motion`].
    ///
    /// # Errors
    /// None with these constants.
    pub fn in_motion() -> Result<(Self, u64), Box<dyn Error>> {
        let mut rig = Self::at_rest()?;
        rig.program.to_target.inputs.execute = true;
        rig.scan()?;
        let axis = rig.machine.axes().first();
        let scans = axis.and_then(Axis::plan).map_or(0, |(plan, _)| plan.scans());
        Ok((rig, u64::from(scans).saturating_sub(2)))
    }

    /// One scan.
    ///
    /// # Errors
    /// None: time does not go backwards here.
    pub fn scan(&mut self) -> Result<ScanReport, TimeRanBackwards> {
        let report = self
            .executor
            .scan(self.now_ns, &mut self.program, &mut self.machine);
        self.now_ns += 1_000_000;
        report
    }
}

/// That of an enabled drive at a position.
pub fn feedback(position: DrivePosition) -> DriveFeedback {
    DriveFeedback {
        enabled: true,
        voltage: true,
        fault: None,
        position,
        comms: Comms::Ok,
        signals: DriveSignals::default(),
    }
}

const AXIS: AxisId = AxisId::new(0);

fn config() -> AxisConfig {
    AxisConfig {
        start: StartState::Standstill,
        ..AxisConfig::new(LIMITS)
    }
}

fn power() -> Instance<McPower> {
    let mut power = Instance::<McPower>::default();
    power.inputs.axis = AXIS;
    power.inputs.enable = true;
    power
}

fn to_target() -> Instance<McMoveAbsolute> {
    let mut to_target = Instance::<McMoveAbsolute>::default();
    to_target.inputs.axis = AXIS;
    to_target.inputs.position = TARGET;
    to_target.inputs.velocity = LIMITS.velocity;
    to_target
}

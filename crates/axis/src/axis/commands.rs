//! Commands as the axis stores them: what each does, when it starts, and how it ends. These are values
//! only; nothing here knows an axis.

use super::dynamics::as_given;
use crate::{
    AxisEvent, AxisId, BufferMode, CamId, Command, CommandId, Direction, ErrorId, InstanceId, Parameter,
    ParameterValue, SyncMode, ValueSource,
};
use standstill_planner::{CamLaw, Field, Gear, Limits, Passage, PlanError, ProfileKind};

/// How far rounding may take a state beyond a limit, relative to the limit (contract: limits hold to
/// 1e-9).
pub(super) const ROUNDING: f64 = 1e-9;

/// A command that comes to rest at its end.
pub(super) const REST: Passage = Passage::REST;

/// The commands that wait and are one motion with the one before them: same direction, same limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Run {
    /// The number of these commands.
    pub count: usize,
    /// The end of the last one (u).
    pub end: f64,
    /// How the last one passes its end.
    pub passage: Passage,
}

impl Run {
    /// No such command.
    pub const NONE: Self = Self {
        count: 0,
        end: 0.0,
        passage: REST,
    };
}

/// When an admitted command starts.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Start {
    /// At once.
    Now,
    /// When it becomes active.
    Wait,
}

/// The target of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    /// A position (u).
    At(f64),
    /// A distance (u) from the position at which the command becomes active (B10).
    By(f64),
}

/// A value that a command writes when it becomes active.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Write {
    /// A digital output of the drive.
    Output { bit: u32, value: bool },
    /// A parameter.
    Parameter {
        parameter: Parameter,
        value: ParameterValue,
    },
}

/// A command after its checks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Work {
    /// To a position (u).
    Position(f64),
    /// By a distance (u) from the position at which it becomes active (B10).
    Distance(f64),
    /// Through a position with an end velocity (u/s, signed), which the axis then keeps.
    Through { to: Place, end_velocity: f64 },
    /// To a velocity (u/s). With `along` its sign is relative to the motion at the time it becomes active.
    Velocity { velocity: f64, along: bool },
    /// Along a curve. With `due` it owns the axis but has not got the points from its block yet.
    Profile {
        kind: ProfileKind,
        due: bool,
        /// Time in its table at the start of the plan in progress (s), and the factor of its times.
        since: f64,
        time_scale: f64,
    },
    /// A torque that changes by `ramp` per second (0: at once). With `along` its sign is relative to the motion at
    /// the time it becomes active.
    Torque { torque: f64, ramp: f64, along: bool },
    /// Follows a master.
    Gear(Gearing),
    /// Follows a master on a cam.
    Cam(Camming),
    /// Continues at a velocity (u/s), without its master.
    Release(f64),
    /// To velocity zero.
    Halt,
    /// To velocity zero, locked.
    Stop,
    /// The reference gets this position (u).
    Home(f64),
    /// Moves the coordinates: the actual position becomes this value, or grows by it (u).
    SetPosition { position: f64, relative: bool },
    /// Writes a value that is not part of the motion.
    Write(Write),
}

/// How a slave follows one master or two.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Gearing {
    pub first: Leg,
    /// MC_CombineAxes: the second master, whose travel is added.
    pub second: Option<Leg>,
    /// The sync positions of master and slave, if given; otherwise the law goes through their positions when the
    /// slave comes into gear.
    pub sync: Option<Sync>,
}

/// How one master is followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Leg {
    pub master: AxisId,
    /// The followed values of the master: set or actual.
    pub source: ValueSource,
    pub gear: Gear,
}

/// A sync point after its checks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Sync {
    /// Position of the master (u), and of the slave (u).
    pub master: f64,
    pub slave: f64,
    pub mode: SyncMode,
    /// The distance of the master before its sync position at which the slave starts (u), with the sign of the
    /// master's direction; 0 to start at once.
    pub start_distance: f64,
}

/// The cam and the master that a slave follows, after their checks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Camming {
    pub master: AxisId,
    /// The followed values of the master: set or actual.
    pub source: ValueSource,
    pub cam: CamId,
    /// The number of derivatives that are continuous.
    pub continuity: u8,
    /// Its steepest slope, scalings included.
    pub steepest: f64,
    /// Scalings and turns. The beginning of the cam is found when the cam is placed.
    pub law: CamLaw,
    /// The positions of the table are absolute positions of the axes: of the master, and of the slave.
    pub master_absolute: bool,
    pub slave_absolute: bool,
    pub master_offset: f64,
    pub slave_offset: f64,
    /// The position on the cam where the slave is in sync first, if given (u of the cam's master side).
    pub sync: Option<f64>,
    /// The distance of the master before that position at which the slave starts (u of the cam's master side), with
    /// the sign of the master's direction; 0 to start at once.
    pub start_distance: f64,
    /// The position on the previous cam at which this one takes over, if not at its end (u of that cam's master
    /// side).
    pub switch_at: Option<f64>,
}

impl Work {
    /// Whether the slave starts when its master reaches a position, and not at once.
    pub fn waits_for_start(&self) -> bool {
        match self {
            Self::Gear(gearing) => gearing.sync.is_some_and(|sync| sync.start_distance != 0.0),
            Self::Cam(camming) => camming.start_distance != 0.0,
            _ => false,
        }
    }
}

/// The properties of a kind of work, in one table for all uses. A property with only one use is defined there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Manner {
    /// Its name.
    pub kind: WorkKind,
    /// The transition of the state diagram with which it starts.
    pub start: AxisEvent,
    /// The action when its motion has reached its goal.
    pub ending: Ending,
    /// How its motion is checked against the software limits.
    pub watch: Watch,
    /// The position of its end, if there is one.
    pub place: Option<Place>,
    /// The velocity (u/s) at its end; 0 if it ends at rest.
    pub velocity: f64,
    /// It continues until another command takes over.
    pub endless: bool,
    /// The override applies to it. It applies to moves, but not to stops, commands that set positions, profiles,
    /// which keep their times, or torques, which are no motion (V16).
    pub overridden: bool,
    /// It takes new values from its pins while it runs (ContinuousUpdate).
    pub updated: bool,
    /// It starts a motion, so MC_Power can bar the direction it needs.
    pub barred: bool,
    /// It can pass its end in motion, for a blended command that waits (B12).
    pub blends: bool,
    /// It moves the axis when it becomes active; other kinds write something.
    pub moves: bool,
}

/// The effect when a motion has reached its goal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Ending {
    /// It is done once the axis is in position, or at once if it passes its end in motion.
    InPosition,
    /// It is done.
    AtRest,
    /// It holds the value it has reached, and a waiting command may take over.
    Holds,
    /// It is done, and the motion continues.
    RunsOn,
    /// It continues to follow its master. A waiting command may take over once it is in gear.
    Follows,
    /// No action: its block has not given its points yet.
    Due,
    /// It locks the axis while its Execute is TRUE.
    Locks,
    /// The search continues, or the reference gets this position (u).
    Names(f64),
    /// It never owns the axis.
    Never,
}

/// How a motion is checked against the software limits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Watch {
    /// It may leave them in any scan.
    Always,
    /// A curve, which was checked over its whole length.
    Curve,
    /// A move straight to its target.
    Way,
    /// A ramp to rest.
    Ramp,
    /// A torque, which is checked after every latch. It has a plan only while it is barred; that plan leads to rest.
    Torque,
    /// Not at all.
    Never,
}

/// The kinds of work of an axis, for searches over all reachable states.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum WorkKind {
    /// To a position.
    Position,
    /// By a distance.
    Distance,
    /// Through a position, with an end velocity.
    Through,
    /// To a velocity.
    Velocity,
    /// A profile whose block has not given its points yet.
    ProfileDue,
    /// A profile.
    Profile,
    /// A torque.
    Torque,
    /// Follows a master.
    Gear,
    /// Follows a master on a cam.
    Cam,
    /// Continues at a velocity, without its master.
    Release,
    /// To velocity zero.
    Halt,
    /// To velocity zero, locked.
    Stop,
    /// Homing.
    Home,
    /// Shifts the coordinates.
    SetPosition,
    /// A digital output.
    Output,
    /// A parameter.
    Parameter,
}

impl Manner {
    /// A move that ends.
    const MOVE: Self = Self {
        kind: WorkKind::Position,
        start: AxisEvent::StartDiscrete,
        ending: Ending::InPosition,
        watch: Watch::Way,
        place: None,
        velocity: 0.0,
        endless: false,
        overridden: true,
        updated: true,
        barred: true,
        blends: true,
        moves: true,
    };

    /// A motion that continues until another takes over.
    const ENDLESS: Self = Self {
        start: AxisEvent::StartContinuous,
        ending: Ending::Holds,
        watch: Watch::Always,
        endless: true,
        blends: false,
        ..Self::MOVE
    };

    /// A profile to a position.
    const PROFILE: Self = Self {
        kind: WorkKind::Profile,
        watch: Watch::Curve,
        overridden: false,
        updated: false,
        blends: false,
        ..Self::MOVE
    };

    /// A profile that ends with a velocity.
    const ENDLESS_PROFILE: Self = Self {
        start: AxisEvent::StartContinuous,
        ending: Ending::RunsOn,
        watch: Watch::Always,
        endless: true,
        ..Self::PROFILE
    };

    /// To rest.
    const RAMP: Self = Self {
        kind: WorkKind::Halt,
        ending: Ending::AtRest,
        watch: Watch::Ramp,
        overridden: false,
        updated: false,
        barred: false,
        blends: false,
        ..Self::MOVE
    };

    /// The search for the reference.
    const HOMING: Self = Self {
        kind: WorkKind::Home,
        start: AxisEvent::StartHoming,
        watch: Watch::Never,
        ..Self::RAMP
    };

    /// No motion: it writes a value when it becomes active.
    const WRITING: Self = Self {
        ending: Ending::Never,
        moves: false,
        ..Self::HOMING
    };
}

impl Work {
    /// Follows a master.
    const GEAR: Manner = Manner {
        kind: WorkKind::Gear,
        start: AxisEvent::StartSynchronized,
        ending: Ending::Follows,
        overridden: false,
        ..Manner::ENDLESS
    };

    /// The properties of this work.
    // Inlined, so that a caller finds the property it asks for without the others.
    #[inline(always)]
    pub const fn manner(&self) -> Manner {
        match *self {
            Self::Position(position) => Manner {
                place: Some(Place::At(position)),
                ..Manner::MOVE
            },
            Self::Distance(distance) => Manner {
                kind: WorkKind::Distance,
                place: Some(Place::By(distance)),
                ..Manner::MOVE
            },
            Self::Through { to, end_velocity } => Manner {
                kind: WorkKind::Through,
                place: Some(to),
                velocity: end_velocity,
                watch: if end_velocity == 0.0 {
                    Watch::Way
                } else {
                    Watch::Always
                },
                ..Manner::ENDLESS
            },
            Self::Velocity { velocity, .. } => Manner {
                kind: WorkKind::Velocity,
                velocity,
                ..Manner::ENDLESS
            },
            Self::Profile { kind, due, .. } => {
                let manner = match kind {
                    ProfileKind::Position => Manner::PROFILE,
                    ProfileKind::Velocity | ProfileKind::Acceleration => Manner::ENDLESS_PROFILE,
                };
                if due {
                    Manner {
                        kind: WorkKind::ProfileDue,
                        ending: Ending::Due,
                        ..manner
                    }
                } else {
                    manner
                }
            }
            Self::Torque { .. } => Manner {
                kind: WorkKind::Torque,
                watch: Watch::Torque,
                overridden: false,
                ..Manner::ENDLESS
            },
            Self::Gear(_) => Self::GEAR,
            Self::Cam(_) => Manner {
                kind: WorkKind::Cam,
                ..Self::GEAR
            },
            Self::Release(velocity) => Manner {
                kind: WorkKind::Release,
                velocity,
                ending: Ending::RunsOn,
                overridden: false,
                updated: false,
                ..Manner::ENDLESS
            },
            Self::Halt => Manner::RAMP,
            Self::Stop => Manner {
                kind: WorkKind::Stop,
                start: AxisEvent::Stop,
                ending: Ending::Locks,
                ..Manner::RAMP
            },
            Self::Home(position) => Manner {
                ending: Ending::Names(position),
                ..Manner::HOMING
            },
            Self::SetPosition { .. } => Manner {
                kind: WorkKind::SetPosition,
                ..Manner::WRITING
            },
            Self::Write(Write::Output { .. }) => Manner {
                kind: WorkKind::Output,
                ..Manner::WRITING
            },
            Self::Write(Write::Parameter { .. }) => Manner {
                kind: WorkKind::Parameter,
                ..Manner::WRITING
            },
        }
    }

    /// The position of its end (u); relative kinds count from `from`. `None` if it has no end.
    pub fn end(&self, from: f64) -> Option<f64> {
        Some(match self.manner().place? {
            Place::At(position) => position,
            Place::By(distance) => from + distance,
        })
    }

    /// The same with another end velocity (u/s).
    pub fn with_velocity(self, velocity: f64) -> Self {
        match self {
            Self::Through { to, .. } => Self::Through {
                to,
                end_velocity: velocity,
            },
            Self::Velocity { along, .. } => Self::Velocity { velocity, along },
            other => other,
        }
    }

    /// To `position` (u), if it leads to a position.
    pub fn at(self, position: f64) -> Self {
        match self {
            Self::Position(_) => Self::Position(position),
            other => other,
        }
    }
}

/// A command with its number, its instance and its limits. Fields of the owner that every scan reads come first.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Entry {
    /// The position of its end (u); known once the command is planned.
    pub end: Option<f64>,
    pub id: CommandId,
    pub instance: InstanceId,
    /// The override holds it at rest. It continues when the factor of the velocity is raised.
    pub halted: bool,
    /// It brakes, or is at rest, because MC_Power bars a direction it needs.
    pub paused: bool,
    /// Why it was paused. A slave keeps it until it has found a way, so that a pause that goes on is recorded once.
    pub paused_by: Option<ErrorId>,
    /// MC_Stop: Execute is still TRUE.
    pub held: bool,
    /// It has passed its position, or its profile is over, and it continues with its end velocity.
    pub passed: bool,
    /// It was to pass its end in motion, and has passed it while it was held up.
    pub is_behind: bool,
    /// No block follows it: its instance was triggered again, and that command was refused.
    pub orphaned: bool,
    /// Its work; velocities are scaled by the override.
    pub work: Work,
    /// Its limits, scaled by the override.
    pub limits: Limits,
    /// Its values before the override.
    pub asked: Asked,
    /// The position from which its distance counts (u), once it is known (R13).
    pub from: f64,
    /// The sign for mcCurrentDirection of a velocity, taken when the command became active.
    pub sign: f64,
    /// Whole turns by which the frame of a modulo axis moves when it begins.
    pub turns: i64,
    /// How it passes its end, for a blended successor.
    pub passage: Passage,
    /// The waiting commands that are one motion with it.
    pub run: Run,
    /// The next command of the same instance, which the instance follows now (B19).
    pub heir: Option<CommandId>,
    /// The direction to a position on a modulo axis. `None` if the position is one of the frame, including its turns.
    pub direction: Option<Direction>,
    /// How it follows the command before it.
    pub mode: BufferMode,
    /// The reason why it can't follow its master now; checked before each motion step.
    pub barred: Option<ErrorId>,
}

/// Values of a command before the override.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked {
    pub limits: Limits,
    /// Velocity of an endless motion, end velocity of a continuous move (u/s).
    pub velocity: f64,
}

impl Asked {
    /// Those of `work` within `limits`, or [as given](as_given) by `command`.
    pub fn by(command: &Command, work: &Work, limits: Limits) -> Self {
        let velocity = work.manner().velocity;
        let (dynamics, given) = match command {
            Command::MoveContinuousAbsolute {
                dynamics,
                end_velocity,
                ..
            }
            | Command::MoveContinuousRelative {
                dynamics,
                end_velocity,
                ..
            } => (dynamics, *end_velocity),
            Command::MoveAbsolute { dynamics, .. }
            | Command::MoveRelative { dynamics, .. }
            | Command::MoveAdditive { dynamics, .. }
            | Command::MoveVelocity { dynamics, .. }
            | Command::Jog { dynamics, .. } => (dynamics, dynamics.velocity),
            // Ramps and ends at rest have no velocity of their own. A slave has that of its master.
            Command::Torque { .. }
            | Command::Halt { .. }
            | Command::Stop { .. }
            | Command::Home { .. }
            | Command::GearIn { .. }
            | Command::CombineAxes { .. }
            | Command::GearOut
            | Command::CamIn(_)
            | Command::CamOut => return Self { limits, velocity },
        };
        Self {
            limits: as_given(dynamics, &limits),
            velocity: if velocity == 0.0 {
                0.0
            } else {
                velocity.abs().max(given.abs()).copysign(velocity)
            },
        }
    }
}

impl Entry {
    /// A command that starts at rest or with the state at the end of its predecessor.
    pub fn new(id: CommandId, instance: InstanceId, work: Work, limits: Limits, mode: BufferMode) -> Self {
        Self {
            id,
            instance,
            work,
            limits,
            asked: Asked {
                limits,
                velocity: work.manner().velocity,
            },
            halted: false,
            passed: false,
            from: 0.0,
            sign: 1.0,
            direction: None,
            turns: 0,
            mode,
            end: None,
            passage: REST,
            run: Run::NONE,
            is_behind: false,
            held: work == Work::Stop,
            paused: false,
            paused_by: None,
            orphaned: false,
            heir: None,
            barred: None,
        }
    }

    /// Its target, if it has one.
    pub fn place(&self) -> Option<Place> {
        self.work.manner().place
    }

    /// The target of its motion (u), if it has one: its end, or that of the last command that is one motion with it.
    pub fn goal(&self) -> Option<f64> {
        if self.run.count > 0 {
            Some(self.run.end)
        } else {
            self.end
        }
    }

    /// Whether it continues until another command takes over.
    pub fn is_endless(&self) -> bool {
        self.work.manner().endless
    }
}

/// The Direction pin of a command to a position; the checks refuse undefined numbers. MC_MoveAdditive leads to a
/// position of the frame.
pub(super) fn direction_of(command: &Command) -> Option<Direction> {
    match command {
        Command::MoveAbsolute { direction, .. } | Command::MoveContinuousAbsolute { direction, .. } => {
            direction.get()
        }
        Command::MoveAdditive { .. }
        | Command::MoveRelative { .. }
        | Command::MoveContinuousRelative { .. }
        | Command::MoveVelocity { .. }
        | Command::Torque { .. }
        | Command::Jog { .. }
        | Command::Halt { .. }
        | Command::Stop { .. }
        | Command::Home { .. }
        | Command::GearIn { .. }
        | Command::CombineAxes { .. }
        | Command::GearOut
        | Command::CamIn(_)
        | Command::CamOut => None,
    }
}

/// The error that a block shows for a refusal of the planner.
pub(super) fn refusal(error: PlanError) -> ErrorId {
    match error {
        PlanError::TooLong { .. } => ErrorId::MoveTooLong,
        // The distance divided by cycle^n exceeds the range of a number, so the motion takes too many scans to count.
        PlanError::InvalidInput {
            field: Field::Cycle, ..
        } => ErrorId::MoveTooLong,
        PlanError::InvalidInput {
            field: Field::Target, ..
        } => ErrorId::PositionInvalid,
        _ => ErrorId::PlanRefused,
    }
}

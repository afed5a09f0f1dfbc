//! Commands as the axis keeps them: what each does, when it starts, and how it ends. Values only; nothing here knows an axis.

use crate::{
    AxisEvent, BufferMode, Command, CommandId, Direction, ErrorId, InstanceId, Parameter, ParameterValue,
};
use standstill_planner::{Field, Limits, Passage, PlanError, ProfileKind};

/// How far, relative to a limit, rounding may carry a state beyond it (contract: limits hold to 1e-9).
pub(super) const ROUNDING: f64 = 1e-9;

/// At its end a command comes to rest.
pub(super) const REST: Passage = Passage {
    wanted: 0.0,
    most: 0.0,
};

/// When an admitted command starts.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Start {
    /// At once.
    Now,
    /// When its turn comes.
    Wait,
}

/// Where a motion leads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    /// A position (u).
    At(f64),
    /// A distance (u) from where the command becomes active (B10).
    By(f64),
}

/// What a command writes when its turn comes.
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

/// A checked command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Work {
    /// To a position (u).
    Position(f64),
    /// By a distance (u) from where it becomes active (B10).
    Distance(f64),
    /// By way of a place with an end velocity (u/s, signed), which is kept.
    Through { to: Place, end_velocity: f64 },
    /// To a velocity (u/s); with `along` its sign is taken relative to the motion when it becomes active.
    Velocity { velocity: f64, along: bool },
    /// Along a curve; with `due` its points have yet to come from its block, when it owns the axis.
    Profile {
        kind: ProfileKind,
        due: bool,
        /// Time in its table when the plan in progress began (s), and the factor of its times.
        since: f64,
        time_scale: f64,
    },
    /// A torque, changed by so much a second (0: at once); with `along` its sign is relative to the motion when it becomes
    /// active.
    Torque { torque: f64, ramp: f64, along: bool },
    /// To velocity zero.
    Halt,
    /// To velocity zero, locked.
    Stop,
    /// The present position gets a name (u).
    Home(f64),
    /// The coordinates move: the actual position becomes this, or grows by it (u).
    SetPosition { position: f64, relative: bool },
    /// Something beside the motion is written.
    Write(Write),
}

impl Work {
    /// Where it leads (u), counted from `from` where it must be; `None` for what leads nowhere.
    pub fn end(&self, from: f64) -> Option<f64> {
        match *self {
            Self::Position(position)
            | Self::Through {
                to: Place::At(position),
                ..
            } => Some(position),
            Self::Distance(distance)
            | Self::Through {
                to: Place::By(distance),
                ..
            } => Some(from + distance),
            Self::Velocity { .. }
            | Self::Profile { .. }
            | Self::Torque { .. }
            | Self::Halt
            | Self::Stop
            | Self::Home(_)
            | Self::SetPosition { .. }
            | Self::Write(_) => None,
        }
    }

    /// Where it leads, if anywhere.
    pub fn place(&self) -> Option<Place> {
        match *self {
            Self::Position(position) => Some(Place::At(position)),
            Self::Distance(distance) => Some(Place::By(distance)),
            Self::Through { to, .. } => Some(to),
            Self::Velocity { .. }
            | Self::Profile { .. }
            | Self::Torque { .. }
            | Self::Halt
            | Self::Stop
            | Self::Home(_)
            | Self::SetPosition { .. }
            | Self::Write(_) => None,
        }
    }

    /// The velocity (u/s) it goes on with, 0 if it ends at rest.
    pub fn velocity(&self) -> f64 {
        match *self {
            Self::Through { end_velocity, .. } => end_velocity,
            Self::Velocity { velocity, .. } => velocity,
            Self::Position(_)
            | Self::Distance(_)
            | Self::Profile { .. }
            | Self::Torque { .. }
            | Self::Halt
            | Self::Stop
            | Self::Home(_)
            | Self::SetPosition { .. }
            | Self::Write(_) => 0.0,
        }
    }

    /// The same with another velocity to go on with (u/s).
    pub fn with_velocity(self, velocity: f64) -> Self {
        match self {
            Self::Through { to, .. } => Self::Through {
                to,
                end_velocity: velocity,
            },
            Self::Velocity { along, .. } => Self::Velocity { velocity, along },
            Self::Position(_)
            | Self::Distance(_)
            | Self::Profile { .. }
            | Self::Torque { .. }
            | Self::Halt
            | Self::Stop
            | Self::Home(_)
            | Self::SetPosition { .. }
            | Self::Write(_) => self,
        }
    }

    /// To `position` (u), if it leads to a position.
    pub fn at(self, position: f64) -> Self {
        match self {
            Self::Position(_) => Self::Position(position),
            other => other,
        }
    }

    /// Whether the override holds for it: it does for moves, not for what stops or names places (V16).
    pub fn obeys_override(&self) -> bool {
        match self {
            Self::Position(_) | Self::Distance(_) | Self::Through { .. } | Self::Velocity { .. } => true,
            // A profile keeps its times, and a torque is no motion.
            Self::Profile { .. }
            | Self::Torque { .. }
            | Self::Halt
            | Self::Stop
            | Self::Home(_)
            | Self::SetPosition { .. }
            | Self::Write(_) => false,
        }
    }

    pub fn kind(&self) -> &'static str {
        match self {
            Self::Position(_) => "position",
            Self::Distance(_) => "distance",
            Self::Through { .. } => "through",
            Self::Velocity { .. } => "velocity",
            Self::Profile { due: true, .. } => "profile due",
            Self::Profile { .. } => "profile",
            Self::Torque { .. } => "torque",
            Self::Halt => "halt",
            Self::Stop => "stop",
            Self::Home(_) => "home",
            Self::SetPosition { .. } => "set position",
            Self::Write(Write::Output { .. }) => "output",
            Self::Write(Write::Parameter { .. }) => "parameter",
        }
    }
}

/// A command with its number, its sender and its limits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub id: CommandId,
    pub instance: InstanceId,
    /// What it does; velocities as the override has them.
    pub work: Work,
    /// Its limits, as the override has them.
    pub limits: Limits,
    /// What the program asked for, before the override.
    pub asked: Asked,
    /// The override holds it at rest: it goes on when the factor of the velocity is raised.
    pub halted: bool,
    /// It has passed the place it leads through, and goes on with its end velocity.
    pub passed: bool,
    /// Where its distance counts from (u), once that is known (R13).
    pub from: f64,
    /// mcCurrentDirection of a velocity, as it was when the command became active.
    pub sign: f64,
    /// Way round to a position on a modulo axis; `None` where the position is one of the frame, some turns on.
    pub direction: Option<Direction>,
    /// Whole turns the frame of a modulo axis moves on by when it begins.
    pub turns: i64,
    /// How it follows the command before it.
    pub mode: BufferMode,
    /// Where it ends (u), once it is known: when the command is planned.
    pub end: Option<f64>,
    /// How it is to pass its end, for a blended successor.
    pub passage: Passage,
    /// MC_Stop: Execute is still TRUE.
    pub held: bool,
    /// It brakes, or stands, because MC_Power bars a direction it needs.
    pub paused: bool,
    /// No block follows it: its instance was triggered anew and refused.
    pub orphaned: bool,
    /// What its instance gave after it, and follows now (B19).
    pub heir: Option<CommandId>,
}

/// Values of a command before the override.
#[derive(Clone, Copy, Debug)]
pub(super) struct Asked {
    pub limits: Limits,
    /// Velocity of an endless motion, end velocity of a continuous move (u/s).
    pub velocity: f64,
}

impl Entry {
    /// A command that starts at rest, or with what the one before leaves it.
    pub fn new(id: CommandId, instance: InstanceId, work: Work, limits: Limits, mode: BufferMode) -> Self {
        Self {
            id,
            instance,
            work,
            limits,
            asked: Asked {
                limits,
                velocity: work.velocity(),
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
            held: work == Work::Stop,
            paused: false,
            orphaned: false,
            heir: None,
        }
    }

    /// Where it leads, if anywhere.
    pub fn place(&self) -> Option<Place> {
        self.work.place()
    }

    /// Whether it moves the axis when its turn comes, rather than writing something.
    pub fn is_motion(&self) -> bool {
        !matches!(self.work, Work::SetPosition { .. } | Work::Write(_))
    }

    /// Whether it leads anywhere, so that it could be barred.
    pub fn leads_on(&self) -> bool {
        match self.work {
            Work::Position(_)
            | Work::Distance(_)
            | Work::Through { .. }
            | Work::Velocity { .. }
            | Work::Profile { .. }
            | Work::Torque { .. } => true,
            Work::Halt | Work::Stop | Work::Home(_) | Work::SetPosition { .. } | Work::Write(_) => false,
        }
    }

    /// Whether it goes on until another command takes over.
    pub fn is_endless(&self) -> bool {
        match self.work {
            Work::Velocity { .. } | Work::Through { .. } | Work::Torque { .. } => true,
            Work::Profile { kind, .. } => kind != ProfileKind::Position,
            _ => false,
        }
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
        | Command::Home { .. } => None,
    }
}

/// The state a command leads to.
pub(super) fn start_event(work: &Work) -> AxisEvent {
    match work {
        Work::Position(_)
        | Work::Distance(_)
        | Work::Halt
        | Work::Profile {
            kind: ProfileKind::Position,
            ..
        } => AxisEvent::StartDiscrete,
        Work::Velocity { .. } | Work::Through { .. } | Work::Profile { .. } | Work::Torque { .. } => {
            AxisEvent::StartContinuous
        }
        Work::Stop => AxisEvent::Stop,
        Work::Home(_) | Work::SetPosition { .. } | Work::Write(_) => AxisEvent::StartHoming,
    }
}

/// What a block shows of a planner's refusal.
pub(super) fn refusal(error: PlanError) -> ErrorId {
    match error {
        PlanError::TooLong { .. } => ErrorId::MoveTooLong,
        // Distance over cycle^n does not fit into a number: longer than anything countable.
        PlanError::InvalidInput {
            field: Field::Cycle, ..
        } => ErrorId::MoveTooLong,
        PlanError::InvalidInput {
            field: Field::Target, ..
        } => ErrorId::PositionInvalid,
        _ => ErrorId::PlanRefused,
    }
}

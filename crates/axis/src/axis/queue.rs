//! Commands that were accepted: the owner and those that wait.

use crate::{BufferMode, CommandId, Direction, InstanceId, QUEUE_MAX};
use standstill_planner::{Limits, Passage};

/// Where a motion leads.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Place {
    /// A position (u).
    At(f64),
    /// A distance (u) from where the command becomes active (B10).
    By(f64),
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
    /// To velocity zero.
    Halt,
    /// To velocity zero, locked.
    Stop,
    /// The present position gets a name (u).
    Home(f64),
    /// The coordinates move: the actual position becomes this, or grows by it (u).
    SetPosition { position: f64, relative: bool },
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
            Self::Velocity { .. } | Self::Halt | Self::Stop | Self::Home(_) | Self::SetPosition { .. } => {
                None
            }
        }
    }

    pub fn kind(&self) -> &'static str {
        match self {
            Self::Position(_) => "position",
            Self::Distance(_) => "distance",
            Self::Through { .. } => "through",
            Self::Velocity { .. } => "velocity",
            Self::Halt => "halt",
            Self::Stop => "stop",
            Self::Home(_) => "home",
            Self::SetPosition { .. } => "set position",
        }
    }
}

/// A command with its number, its sender and its limits.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub id: CommandId,
    pub instance: InstanceId,
    pub work: Work,
    pub limits: Limits,
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
}

impl Entry {
    /// Where it leads, if anywhere.
    pub fn place(&self) -> Option<Place> {
        match self.work {
            Work::Position(position) => Some(Place::At(position)),
            Work::Distance(distance) => Some(Place::By(distance)),
            Work::Through { to, .. } => Some(to),
            Work::Velocity { .. } | Work::Halt | Work::Stop | Work::Home(_) | Work::SetPosition { .. } => {
                None
            }
        }
    }

    /// Whether it goes on until another command takes over.
    pub fn is_endless(&self) -> bool {
        matches!(self.work, Work::Velocity { .. } | Work::Through { .. })
    }
}

/// First in, first out; at most [`QUEUE_MAX`] entries.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Queue {
    entries: [Option<Entry>; QUEUE_MAX],
    len: usize,
}

impl Queue {
    pub fn len(&self) -> usize {
        self.len
    }

    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Appends; the caller has checked the configured capacity.
    pub fn push(&mut self, entry: Entry) {
        if let Some(slot) = self.entries.get_mut(self.len) {
            *slot = Some(entry);
            self.len += 1;
        }
    }

    pub fn pop(&mut self) -> Option<Entry> {
        let first = self.entries.first_mut()?.take()?;
        self.entries.rotate_left(1);
        self.len -= 1;
        Some(first)
    }

    pub fn first(&self) -> Option<&Entry> {
        self.entries.first()?.as_ref()
    }

    pub fn iter(&self) -> impl Iterator<Item = &Entry> {
        self.entries.iter().flatten()
    }

    pub fn contains(&self, id: CommandId) -> bool {
        self.iter().any(|entry| entry.id == id)
    }
}

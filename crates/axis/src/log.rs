//! Records of what an axis did with its commands: a ring of fixed size that a host can read.

use crate::{AxisId, CamId, ErrorId, InstanceId};
use standstill_planner::Excess;

/// Number of records the ring holds; older ones are overwritten.
pub const LOG_KEPT: usize = 64;

/// The goal of a plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// Rest at a position (u).
    Position(f64),
    /// A constant velocity (u/s).
    Velocity(f64),
    /// A position passed with a velocity.
    Passing {
        /// The position (u).
        position: f64,
        /// The velocity there (u/s), signed.
        velocity: f64,
    },
}

/// How a slave gets onto the law of its gear.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Approach {
    /// Beside the law, until the difference is 0.
    Difference,
    /// To the velocity of the law in its next stretch of constant velocity.
    Stretch,
    /// As fast as possible.
    Pace,
    /// On a cam: a move in its own coordinates to a place of the curve.
    Move,
    /// On a cam: along it to rest at a row at which a derivative jumps.
    Corner,
}

impl Approach {
    /// Its name in text.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Difference => "difference",
            Self::Stretch => "stretch",
            Self::Pace => "pace",
            Self::Move => "move",
            Self::Corner => "corner",
        }
    }
}

/// An event that is recorded.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Event {
    /// A command was refused because of this pin (empty: because of the axis state).
    Refused {
        /// IEC name of the pin.
        pin: &'static str,
        /// The value at it.
        value: f64,
        /// The violated limit; NaN if there is none.
        limit: f64,
        /// The error the block shows.
        error: ErrorId,
    },
    /// A profile was refused because of a point of its table, or of the curve to that point.
    PointRefused {
        /// The point, from 1.
        point: u16,
        /// IEC name of the field, or the quantity whose limit the curve would exceed.
        what: &'static str,
        /// The value there.
        value: f64,
        /// The violated limit; NaN if there is none.
        limit: f64,
        /// The error the block shows.
        error: ErrorId,
    },
    /// A value above the axis limit was lowered to it.
    Clamped {
        /// IEC name of the pin.
        pin: &'static str,
        /// The value at it.
        value: f64,
        /// The limit used instead.
        limit: f64,
    },
    /// A value too low to keep the axis inside its limits from the present state was raised.
    Raised {
        /// IEC name of the pin.
        pin: &'static str,
        /// The requested value.
        value: f64,
        /// The value used instead.
        limit: f64,
    },
    /// A value above the limits that slaves leave was lowered to them (on_limit slow_master).
    Slowed {
        /// IEC name of the pin.
        pin: &'static str,
        /// The value without the slaves.
        value: f64,
        /// The value used instead.
        limit: f64,
    },
    /// The start state forces the plan beyond its limits by this much.
    Unavoidable(Excess),
    /// The coordinates were shifted, without motion: from this scan on the same place has a position that
    /// is larger by this amount (u).
    Shifted {
        /// By how much (u).
        by: f64,
    },
    /// A plan was accepted.
    Planned {
        /// The goal of the plan.
        goal: Goal,
        /// Its scans.
        scans: u32,
    },
    /// A superimposed motion was planned: this distance (u) to be covered, or none for a halt.
    Superimposed {
        /// As commanded (u).
        distance: Option<f64>,
        /// Its scans.
        scans: u32,
    },
    /// A superimposed command waits until the motion under it leaves room below the axis limits.
    RoomAwaited,
    /// MC_Power bars a direction the motion needs: it brakes, and continues when the direction is
    /// permitted.
    Paused {
        /// The error for this direction.
        error: ErrorId,
    },
    /// The instance was triggered again, and its new command was refused or given to another axis. Its earlier motion
    /// continues to its end, and no block follows it.
    Orphaned,
    /// The axis follows a master.
    Coupled {
        /// The master.
        master: AxisId,
        /// Gear ratio, travel of the slave per travel of the master: numerator.
        numerator: i32,
        /// Denominator.
        denominator: u16,
    },
    /// The slave approaches the law of its gear.
    Approaching {
        /// How.
        way: Approach,
        /// The velocity (u/s) it leads to; beside the law, the velocity to be taken off.
        velocity: f64,
        /// Its scans.
        scans: u32,
    },
    /// From this scan on the slave is on the law of its gear.
    InGear,
    /// The phase shift between a master and its slave begins to move.
    Phasing {
        /// To this (u of the master).
        to: f64,
        /// Its scans.
        scans: u32,
    },
    /// The slave is in sync after its master has passed the sync point.
    SyncLate {
        /// The distance of the master past it (u).
        by: f64,
    },
    /// The slave can't stay on the law of its gear, because the law exceeds a limit.
    GearLost {
        /// The quantity.
        what: &'static str,
        /// The value that the law needs.
        value: f64,
        /// The limit.
        limit: f64,
    },
    /// The commands of its masters lead a slave in gear outside its software limits.
    LeadsOutside {
        /// The rest position that the slave would have (u).
        position: f64,
        /// Its software limit on that side (u).
        limit: f64,
    },
    /// A cam was selected: the highest constant velocity of its master with which the slave can follow
    /// it.
    CamSelected {
        /// This velocity (u/s of the master).
        velocity: f64,
        /// The velocity limit of the master.
        limit: f64,
    },
    /// A cam was selected on which the slave comes to rest at a row, because its limits do not let a
    /// derivative jump there.
    CamStops {
        /// The row with the largest jump, from 1.
        row: u16,
        /// The derivative, with the name of a table.
        what: &'static str,
        /// By how much.
        jump: f64,
    },
    /// The axis goes onto a cam.
    OnCam {
        /// Its master.
        master: AxisId,
        /// The cam.
        cam: CamId,
    },
    /// The slave goes onto its cam, or along it into step with its master.
    OntoCam {
        /// How.
        way: Approach,
        /// The end position of a move (u). Otherwise the velocity that a shadow reaches (u/s of the master); beside
        /// the master, the velocity that has to be removed.
        value: f64,
        /// Its scans.
        scans: u32,
    },
    /// From this scan on the slave is on its cam at the place of its master.
    InSync,
    /// The slave can't stay there, because the cam exceeds a limit.
    SyncLost {
        /// The quantity.
        what: &'static str,
        /// The value that the cam needs.
        value: f64,
        /// The limit.
        limit: f64,
    },
    /// More than one end of the cam was passed in one scan.
    CamPassed {
        /// The number of ends.
        periods: u32,
    },
    /// The axis entered ErrorStop.
    Fault {
        /// Why.
        error: ErrorId,
        /// The drive's own code, 0 if none.
        code: u16,
    },
}

/// One entry of the ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Record {
    /// The scan it happened in.
    pub scan: u64,
    /// The axis.
    pub axis: AxisId,
    /// The block instance whose command it was.
    pub instance: InstanceId,
    /// What happened.
    pub event: Event,
}

/// The ring of records, shared by all axes of a runtime.
#[derive(Clone, Debug)]
pub struct Log {
    records: [Option<Record>; LOG_KEPT],
    total: u64,
}

impl Default for Log {
    fn default() -> Self {
        Self {
            records: [None; LOG_KEPT],
            total: 0,
        }
    }
}

impl Log {
    /// Adds a record, overwriting the oldest when full.
    pub fn push(&mut self, record: Record) {
        let place = (self.total % LOG_KEPT as u64) as usize;
        if let Some(slot) = self.records.get_mut(place) {
            *slot = Some(record);
        }
        self.total = self.total.wrapping_add(1);
    }

    /// Records ever pushed.
    pub fn total(&self) -> u64 {
        self.total
    }

    /// The records still held from number `from` on (counted from 0 since start), oldest first.
    pub fn since(&self, from: u64) -> impl Iterator<Item = &Record> {
        let oldest = self.total.saturating_sub(LOG_KEPT as u64);
        (from.max(oldest)..self.total)
            .filter_map(|number| self.records.get((number % LOG_KEPT as u64) as usize)?.as_ref())
    }
}

//! Profiles: curves through points of position, velocity or acceleration over time.
//!
//! A profile is one plan of fixed size. Its nodes have time, position and three derivatives; between two
//! nodes it is the polynomial of degree 7 that meets both. So position, velocity, acceleration and jerk
//! are continuous everywhere, from the start state to the end. Values that the points leave open are
//! estimated from their neighbours (`nodes`). Then the whole curve is checked against the limits before
//! anything moves (`check`). docs/profiles.md describes it for users.

pub(crate) mod check;
pub(crate) mod curve;
pub(crate) mod nodes;

use crate::ramp;
use crate::{Limits, Order, RampPlan, Setpoint};
use curve::Curve;

/// Largest number of points of a profile.
pub const PROFILE_POINTS: usize = 40;

/// The start, the points, and one at which an acceleration has faded out; fewer points leave room for more of
/// those.
const NODES: usize = PROFILE_POINTS + 2;

/// The largest difference, relative to itself, of a first value at time 0 from the start.
const SAME: f64 = 1e-9;

/// The quantity that a profile prescribes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProfileKind {
    /// Positions (u); it ends at rest on the last one.
    Position,
    /// Velocities (u/s); the last one is kept.
    Velocity,
    /// Accelerations (u/s^2); after the last one the acceleration fades out and the velocity is kept.
    Acceleration,
}

/// A point of a profile.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProfilePoint {
    /// Time since the start (s).
    pub time: f64,
    /// Value there: u, u/s or u/s^2.
    pub value: f64,
    /// The curve is level there: all derivatives of the value are 0, and the curve on one side does not
    /// depend on the points of the other.
    pub level: bool,
}

/// The faults of a profile.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProfileCause {
    /// There is no point, none after the start, or more than [`PROFILE_POINTS`].
    Count,
    /// A time is not finite, or not after the one before.
    Time,
    /// A value is not finite.
    Value,
    /// The first value is for the start, and the start has another.
    Start,
    /// It takes more than 2^31 - 1 scans.
    TooLong,
    /// Outside the range of positions.
    Position,
    /// The limit of this quantity.
    Velocity,
    /// The limit of this quantity.
    Acceleration,
    /// The limit of this quantity.
    Deceleration,
    /// The limit of this quantity.
    Jerk,
    /// The limit of this quantity.
    Snap,
}

/// The reason why a profile was refused.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProfileFault {
    /// The kind of the fault.
    pub cause: ProfileCause,
    /// The point at or before which the fault is, from 1; one more than the last point if it is in the
    /// fade-out.
    pub point: usize,
    /// The value there, in the unit of the cause.
    pub value: f64,
    /// The largest or the right value; NaN if there is none to name.
    pub limit: f64,
}

/// A node: time since the start (s), position since the start (u), and derivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Node {
    time: f64,
    position: f64,
    velocity: f64,
    acceleration: f64,
    jerk: f64,
}

/// A curve through points.
#[derive(Clone, Copy, Debug)]
pub struct ProfilePlan {
    nodes: [Node; NODES],
    /// Position of the start (u).
    origin: f64,
    /// Position of the end (u), to the bit.
    target: f64,
    cycle: f64,
    scans: u32,
    count: u8,
}

/// The start state. If snap is unbounded, or jerk is unbounded too, the derivatives that may jump are set
/// free.
fn free_to_jump(kind: ProfileKind, start: &Setpoint, points: &[ProfilePoint], limits: &Limits) -> Setpoint {
    let mut free = *start;
    if limits.snap == f64::INFINITY {
        free.jerk = 0.0;
        if limits.jerk == f64::INFINITY {
            let first = points.first().filter(|point| point.time == 0.0);
            free.acceleration = match (kind, first) {
                (ProfileKind::Acceleration, Some(first)) => first.value,
                _ => 0.0,
            };
        }
    }
    free
}

impl ProfilePlan {
    /// The profile through `points` from `start`, within `limits` and, if given, a range of positions
    /// (u).
    ///
    /// It starts in the given state: the first point comes after some time. A first point at time 0 only states the
    /// expected start. If one curve to the first point would exceed a limit, jerk and acceleration of the start
    /// fade out before it. Acceleration applies while the speed grows, deceleration while it falls. Limits are kept
    /// to 1e-9 of each, and to the resolution of positions: the snap on a stretch of length w in the time T is off
    /// by up to 13,440 epsilon w / T^4, the jerk by 1,680 epsilon w / T^3. A curve that comes closer to a limit
    /// than a millionth may be refused.
    ///
    /// Cost: some 100 operations for each point, and 150 for each of at most 129 pieces of the curve to it; twice
    /// that for a start with an acceleration.
    ///
    /// # Errors
    /// The first [`ProfileFault`].
    pub fn new(
        kind: ProfileKind,
        start: &Setpoint,
        points: &[ProfilePoint],
        limits: &Limits,
        range: Option<(f64, f64)>,
        cycle: f64,
    ) -> Result<Self, ProfileFault> {
        let start = free_to_jump(kind, start, points, limits);
        let through = |join| Self::through(kind, &start, points, (limits, range), cycle, join);
        match through(false) {
            // One curve over a long time swings far out to remove an acceleration of the start.
            Err(fault) if start.acceleration != 0.0 || start.jerk != 0.0 => through(true).map_err(|_| fault),
            planned => planned,
        }
    }

    fn through(
        kind: ProfileKind,
        start: &Setpoint,
        points: &[ProfilePoint],
        (limits, range): (&Limits, Option<(f64, f64)>),
        cycle: f64,
        join: bool,
    ) -> Result<Self, ProfileFault> {
        let mut plan = Self {
            nodes: [Node::default(); NODES],
            origin: start.position,
            target: start.position,
            cycle,
            scans: 0,
            count: 0,
        };
        let (count, before) = nodes::fill(&mut plan.nodes, kind, start, points, (limits, cycle), join)?;
        plan.count = u8::try_from(count).unwrap_or(u8::MAX);
        let end = plan.end();
        let last = points.last().copied().unwrap_or_default();
        plan.scans = ramp::scans(end.time, cycle).ok_or(ProfileFault {
            cause: ProfileCause::TooLong,
            point: points.len(),
            value: end.time,
            limit: f64::NAN,
        })?;
        plan.target = match kind {
            ProfileKind::Position => last.value,
            ProfileKind::Velocity | ProfileKind::Acceleration => plan.origin + end.position,
        };
        let range = range.map(|(min, max)| (min - plan.origin, max - plan.origin));
        // A first point at no time is the start itself.
        let first = points.len() - points.iter().filter(|point| point.time > 0.0).count();
        for (index, curve) in plan.curves().enumerate() {
            check::check(&curve, limits, range).map_err(|(cause, value, limit)| {
                let counted_from = match cause {
                    ProfileCause::Position => plan.origin,
                    _ => 0.0,
                };
                ProfileFault {
                    cause,
                    point: first + (index + 1).max(before) + 1 - before,
                    value: check::peak(&curve, cause, value) + counted_from,
                    limit: limit + counted_from,
                }
            })?;
        }
        Ok(plan)
    }

    fn end(&self) -> Node {
        let last = usize::from(self.count).saturating_sub(1);
        self.nodes.get(last).copied().unwrap_or_default()
    }

    /// The stretches between nodes, in order of time.
    fn curves(&self) -> impl Iterator<Item = Curve> + '_ {
        let nodes = self.nodes.get(..usize::from(self.count)).unwrap_or_default();
        let pairs = nodes.iter().zip(nodes.iter().skip(1));
        pairs.map(|(from, to)| Curve::between(from, to))
    }

    /// The nodes of the curve: the time since the start (s), and the state there.
    pub fn nodes(&self) -> impl Iterator<Item = (f64, Setpoint)> + '_ {
        let nodes = self.nodes.get(..usize::from(self.count)).unwrap_or_default();
        nodes.iter().map(|node| {
            let state = Setpoint {
                position: self.origin + node.position,
                velocity: node.velocity,
                acceleration: node.acceleration,
                jerk: node.jerk,
                snap: 0.0,
            };
            (node.time, state)
        })
    }

    /// Number of scans until the end.
    pub const fn scans(&self) -> u32 {
        self.scans
    }

    /// The set-point `scan` cycles after the start; from [`ProfilePlan::scans`] on the target, or the last velocity
    /// kept. Cost: 6 comparisons and some 80 operations.
    pub fn at(&self, scan: u64) -> Setpoint {
        let time = scan as f64 * self.cycle;
        let end = self.end();
        if scan >= u64::from(self.scans) {
            let over = if end.velocity == 0.0 {
                0.0
            } else {
                (time - end.time) * end.velocity
            };
            return Setpoint {
                velocity: end.velocity,
                ..Setpoint::at_rest(self.target + over)
            };
        }
        let index = self.index_at(time);
        let (Some(from), Some(to)) = (self.nodes.get(index), self.nodes.get(index + 1)) else {
            return Setpoint::at_rest(self.target);
        };
        let mut state = Curve::between(from, to).at(time - from.time);
        state.position += self.origin;
        state
    }

    /// The node at or before `time` (s) that another one follows.
    fn index_at(&self, time: f64) -> usize {
        let (mut low, mut high) = (0, usize::from(self.count).saturating_sub(1));
        // Halves a range of at most NODES.
        for _ in 0..6 {
            if high - low <= 1 {
                break;
            }
            let middle = usize::midpoint(low, high);
            if self.nodes.get(middle).is_some_and(|node| node.time <= time) {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }

    /// The same motion in coordinates moved by `by` (u).
    pub(crate) fn shift(&mut self, by: f64) {
        self.origin += by;
        self.target += by;
    }

    /// The motion with the end velocity alone, as a plan of its own with the same count of scans; none if
    /// `scan` is before its end, or if it ends at rest.
    pub(crate) fn cruise(&self, scan: u64) -> Option<RampPlan> {
        let end = self.end();
        if scan < u64::from(self.scans) || end.velocity == 0.0 {
            return None;
        }
        let start = self.target - end.velocity * end.time;
        Some(RampPlan::cruising(start, end.velocity, Order::Four, self.cycle))
    }

    /// The stretches from `elapsed` scans after the start on.
    fn rest(&self, elapsed: u64) -> impl Iterator<Item = Curve> + '_ {
        let time = elapsed as f64 * self.cycle;
        let nodes = self.nodes.get(..usize::from(self.count)).unwrap_or_default();
        let pairs = nodes.iter().zip(nodes.iter().skip(1));
        pairs
            .filter(move |(_, to)| to.time > time)
            .map(move |(from, to)| {
                let curve = Curve::between(from, to);
                if from.time < time {
                    curve.after(time - from.time)
                } else {
                    curve
                }
            })
    }

    /// The distances (u) of the rest upwards and downwards, up to its goal; bounded by 64 pieces for each stretch.
    pub(crate) fn ways(&self, elapsed: u64) -> (f64, f64) {
        self.rest(elapsed).fold((0.0, 0.0), |(up, down), curve| {
            let (further_up, further_down) = check::ways(&curve);
            (up + further_up, down + further_down)
        })
    }

    /// Whether the rest keeps `limits` and stays inside `range` (u), by the check of
    /// [`ProfilePlan::new`]; bounded by 64 pieces for each stretch.
    pub(crate) fn keeps(&self, elapsed: u64, limits: &Limits, range: Option<(f64, f64)>) -> bool {
        let range = range.map(|(min, max)| (min - self.origin, max - self.origin));
        self.rest(elapsed)
            .all(|curve| check::check(&curve, limits, range).is_ok())
    }
}

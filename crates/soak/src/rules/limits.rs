//! Set-points and their differences keep the limits of the axis.
//!
//! A set-point gives velocity, acceleration, jerk and snap of the motion at an instant. The backward differences of
//! the published positions give them independently. Both are checked against the limits of the axis, including
//! superimposed motions, because the sum is published. No excess is permitted: the limits of the axis can bring
//! back every state that a motion within them has reached. There is one exception that cannot always be avoided: a
//! stop in the middle of a reversal turns back. Only this may be recorded ([`check_excess`]).

use super::{Broken, rule};
use standstill_axis::{Axis, AxisConfig, Excess, Limits, Planner, Setpoint, TorqueOrder};

/// The tolerance of a limit, relative to it.
const RELATIVE: f64 = 1e-9;

/// If the velocity is at most this part of its limit, it does not give the direction of motion.
const STILL: f64 = 1e-9;

/// The resolution of a plan's 64-bit instant, relative to the time since its start.
const TICK: f64 = 2.0 * f64::EPSILON;

/// Differences of positions, newest first. The next scan computes its own from them.
const KEPT: usize = 4;

/// Number of positions needed for these.
const KNOWN: usize = KEPT + 1;

/// The recent set-points of one axis.
#[derive(Clone, Debug)]
pub struct Track {
    limits: Limits,
    cycle: f64,
    turn: Option<f64>,
    /// Powers of the cycle from 1 to 4, by which differences of that order are divided.
    over: [f64; KEPT],
    /// The last position, the distance to it and the distances before, and the number of these positions.
    position: f64,
    ways: [f64; KEPT],
    known: usize,
    /// The largest magnitude of unwrapped positions.
    largest: f64,
    unwrapped: f64,
    /// Scans since the axis was at rest.
    moving: u32,
    /// Scans of the longest motion planned since.
    longest: u32,
    /// The motion is the same as in the last scan and at rest, so no check is needed.
    resting: bool,
    /// The error of a curve's jerk and snap by the rounding of its positions.
    off: [f64; 2],
}

/// The only excess that may be recorded as unavoidable: a stop turns back, within the velocity limit.
///
/// # Errors
/// The rule that does not hold.
pub fn check_excess(excess: &Excess, limits: &Limits) -> Result<(), Broken> {
    rule(
        excess.acceleration == 0.0 && excess.jerk == 0.0 && excess.velocity <= limits.velocity,
        "limits",
        "a motion is recorded to exceed the limits of the axis",
    )
}

/// Under a torque an axis may go no faster than its limit, `most` (u/s), or than it was at the begin of the torque.
///
/// # Errors
/// The rule that does not hold.
pub fn check_torque(order: &TorqueOrder, most: f64, fastest: f64) -> Result<(), Broken> {
    let (down, up) = order.velocity;
    rule(
        down.abs().max(up.abs()) <= most.max(fastest) * (1.0 + RELATIVE),
        "V25",
        "a torque lets its axis go faster than the limit",
    )
}

/// The largest limits of a motion of the axis: its own, or those of its stops if they are higher.
fn most(config: &AxisConfig) -> Limits {
    let limits = config.limits;
    let stop = config.stop.unwrap_or_default();
    let larger = |limit: f64, stop: Option<f64>| stop.map_or(limit, |stop| limit.max(stop));
    let deceleration = larger(limits.deceleration, stop.deceleration);
    // In a mean of two directions the deceleration of a stop may show while the speed still grows
    // (docs/vibration.md).
    let is_shaped = config.vibration.iter().any(Option::is_some);
    Limits {
        acceleration: if is_shaped {
            deceleration
        } else {
            limits.acceleration
        },
        deceleration,
        jerk: larger(limits.jerk, stop.jerk),
        snap: larger(limits.snap, stop.snap),
        ..limits
    }
}

impl Track {
    /// An axis at rest.
    pub fn new<P: Planner>(axis: &Axis<P>, cycle: f64) -> Self {
        let position = axis.setpoint().position;
        let turn = axis.config().modulo;
        Self {
            limits: most(axis.config()),
            cycle,
            turn,
            over: [
                cycle,
                cycle * cycle,
                cycle * cycle * cycle,
                cycle * cycle * cycle * cycle,
            ],
            position,
            ways: [0.0; KEPT],
            known: KNOWN,
            largest: position.abs().max(turn.unwrap_or(0.0)),
            unwrapped: position,
            moving: 0,
            longest: 0,
            resting: false,
            off: [0.0; 2],
        }
    }

    /// Differences across this scan have no meaning: coordinates were shifted, or the set-point follows the
    /// feedback.
    pub fn forget(&mut self) {
        self.known = 0;
        self.resting = false;
    }

    /// A motion is planned from one position to another in `scans` scans, possibly some turns away. Its positions
    /// are rounded there, and its instants are counted back from its end.
    pub fn leads(&mut self, from: f64, to: f64, scans: u32) {
        self.largest = self.largest.max(from.abs()).max(to.abs());
        self.longest = self.longest.max(scans);
        self.resting = false;
    }

    /// It moves by a plan in addition to a law or a cam, at this distance from it: its positions are rounded there,
    /// too.
    pub fn is_beside(&mut self, deviation: f64) {
        self.largest = self.largest.max(deviation.abs());
    }

    /// The jerk and the snap of the last planned motion have this error by the rounding of its positions.
    pub fn resolves(&mut self, off: [f64; 2]) {
        self.off = off;
    }

    /// It moves `ratio` times as `master` does, and so do the roundings.
    pub fn follows(&mut self, master: &Self, ratio: f64) {
        let largest = (ratio * master.largest).abs();
        self.largest = self.largest.max(largest);
        self.off = master.off.map(|off| (ratio * off).abs());
        self.longest = self.longest.max(master.longest).max(master.moving);
        self.resting = false;
    }

    /// Checks the set-point published in a scan, and its differences, against the limits.
    ///
    /// # Errors
    /// The rule that does not hold.
    #[inline]
    pub fn check(&mut self, setpoint: &Setpoint) -> Result<(), Broken> {
        let still = setpoint.position == self.position && setpoint.is_at_rest();
        if still && self.resting {
            return Ok(());
        }
        self.check_motion(setpoint, still)
    }

    #[inline(never)]
    fn check_motion(&mut self, setpoint: &Setpoint, still: bool) -> Result<(), Broken> {
        rule(setpoint.is_finite(), "finite", "a set-point is not finite")?;
        if setpoint.is_at_rest() {
            (self.moving, self.longest) = (0, 0);
        } else {
            self.moving = self.moving.saturating_add(1);
        }
        self.check_state(setpoint)?;
        self.push(setpoint.position);
        self.check_differences()?;
        // All earlier positions that are used are at rest.
        self.resting = still && self.known == KNOWN && self.ways == [0.0; KEPT];
        Ok(())
    }

    fn check_state(&self, setpoint: &Setpoint) -> Result<(), Broken> {
        let limits = &self.limits;
        // The resolution of the plan's clock: an instant late by a tick has another state.
        let tick = TICK * f64::from(self.moving) * self.cycle;
        let inside =
            |value: f64, limit: f64, rate: f64| value.abs() <= limit * (1.0 + RELATIVE) + tick * rate;
        let acceleration = if setpoint.velocity.abs() <= STILL * limits.velocity {
            limits.acceleration.max(limits.deceleration)
        } else if setpoint.velocity * setpoint.acceleration > 0.0 {
            limits.acceleration
        } else {
            limits.deceleration
        };
        let less = |value: f64, off: f64| (value.abs() - off).max(0.0);
        let rates = [
            acceleration,
            if limits.jerk.is_finite() { limits.jerk } else { 0.0 },
            if limits.snap.is_finite() { limits.snap } else { 0.0 },
        ];
        rule(
            inside(setpoint.velocity, limits.velocity, rates[0]),
            "limits",
            "the velocity exceeds the limit of the axis",
        )?;
        rule(
            inside(setpoint.acceleration, acceleration, rates[1]),
            "limits",
            "the acceleration exceeds the limit of the axis",
        )?;
        rule(
            inside(less(setpoint.jerk, self.off[0]), limits.jerk, rates[2]),
            "limits",
            "the jerk exceeds the limit of the axis",
        )?;
        rule(
            inside(less(setpoint.snap, self.off[1]), limits.snap, 0.0),
            "limits",
            "the snap exceeds the limit of the axis",
        )?;
        Ok(())
    }

    /// The distance to a position; on a modulo axis the shorter one.
    fn push(&mut self, position: f64) {
        let mut way = position - self.position;
        self.position = position;
        if let Some(turn) = self.turn
            && way.abs() > 0.5 * turn
        {
            way -= turn.copysign(way);
        }
        self.ways.rotate_right(1);
        self.ways[0] = way;
        self.known = KNOWN.min(self.known + 1);
        if self.known == 1 {
            // The position before is not known.
            self.ways = [0.0; KEPT];
            self.unwrapped = position;
        } else {
            self.unwrapped += way;
        }
        self.largest = self.largest.max(self.unwrapped.abs()).max(position.abs());
    }

    /// `|d_k| <= limit_k (1 + 1e-9) + 2^k r / cycle^k`: the continuous plan keeps the limits, so its
    /// differences do. Each position has an error of at most r: a unit in the last place of the largest
    /// position so far, plus the velocity times two units in the last place of the time since rest, or of
    /// the longest motion planned since.
    fn check_differences(&mut self) -> Result<(), Broken> {
        const WHAT: [&str; KEPT] = [
            "the first difference of positions exceeds the velocity limit",
            "the second difference of positions exceeds the acceleration limit",
            "the third difference of positions exceeds the jerk limit",
            "the fourth difference of positions exceeds the snap limit",
        ];
        // The first known position has no distance before it.
        let known = self.known - 1;
        let limits = &self.limits;
        let [now, before, ..] = self.ways;
        // The velocity may have changed its sign within the examined scans, from or to at most this
        // value.
        let higher_bound = limits.acceleration.max(limits.deceleration);
        let may_turn = now * before <= 0.0 || now.abs().min(before.abs()) <= higher_bound * self.over[1];
        let acceleration = if known < 2 || may_turn {
            higher_bound
        } else if now.abs() > before.abs() {
            limits.acceleration
        } else {
            limits.deceleration
        };
        let bounds = [limits.velocity, acceleration, limits.jerk, limits.snap];
        let unit = self.largest.next_up() - self.largest;
        let scans = self.moving.max(self.longest);
        let unit = unit + TICK * f64::from(scans) * self.cycle * limits.velocity;
        let mut differences = self.ways;
        let mut slack = unit;
        for order in 0..known {
            slack *= 2.0;
            let value = differences[0].abs();
            let resolved = slack;
            rule(
                value <= bounds[order] * self.over[order] * (1.0 + RELATIVE) + resolved,
                "limits",
                WHAT[order],
            )?;
            for place in 0..KEPT - 1 - order {
                differences[place] -= differences[place + 1];
            }
        }
        Ok(())
    }
}

//! Modulo axes: positions that come round, turns counted in integers, and the way round to a target.
//!
//! Positions a program sees are in [0, length). The core moves in a frame of its own: a plan ends in the first
//! turn of its frame, wherever it starts, so that every target is met to the bit; an endless motion is brought
//! back when it is two turns away. The whole turns between the frame and the drive's increments are an integer.
//!
//! Source: PLCopen Motion Control Part 1, MC_MoveAbsolute and MC_DIRECTION; B8; the rule for Direction is that of
//! docs/modulo.md.

use super::queue::{Entry, Work};
use super::{Axis, Motion};
use crate::{AxisConfig, Direction, DrivePosition, ErrorId, Scaling, Turn};
use standstill_planner::turns::{split, two_product};
use standstill_planner::{Limits, Plan, Planner, Setpoint};

/// How far, relative to the way a stop takes, a target may lie before its end and still be met: rounding, and
/// no visible way back.
const ROUNDING: f64 = 1e-9;

/// An endless motion this many turns away is brought back.
const FAR: f64 = 2.0;

/// What an axis with turns has beyond a linear one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Modulo {
    /// One turn (u).
    pub length: f64,
    /// One turn in increments, for drives that count them.
    turn: Option<Turn>,
    /// Whole turns at the frame's 0. Drives that speak units know no turns, so there it means nothing.
    turns: i64,
    /// Whole turns at the actual position.
    actual_turns: i64,
}

impl Modulo {
    pub fn new(config: &AxisConfig) -> Option<Self> {
        let length = config.modulo?;
        Some(Self {
            length,
            turn: config.scaling.and_then(|scaling| scaling.turn(length)),
            turns: 0,
            actual_turns: 0,
        })
    }

    /// As programs see it.
    #[inline(never)]
    pub fn shown(&self, setpoint: &Setpoint) -> Setpoint {
        Setpoint {
            position: split(setpoint.position, self.length).1,
            ..*setpoint
        }
    }

    /// A position of the frame at the drive: in increments however many turns there were, in units in the
    /// first turn.
    #[inline(never)]
    pub fn at_drive(&self, config: &AxisConfig, position: f64) -> DrivePosition {
        let (further, position) = split(position, self.length);
        match (config.scaling, &self.turn) {
            (Some(scaling), Some(turn)) => DrivePosition::Increments(scaling.to_increments_turned(
                turn,
                self.turns.saturating_add(further),
                position,
            )),
            _ => DrivePosition::Units(position),
        }
    }

    /// The actual position (u) in the first turn.
    #[inline(never)]
    pub fn latch(&mut self, config: &AxisConfig, feedback: DrivePosition, shift: f64) -> f64 {
        let (turns, position) = match (feedback, config.scaling, &self.turn) {
            (DrivePosition::Increments(increments), Some(scaling), Some(turn)) => {
                Scaling::to_units_turned(&scaling, turn, self.length, increments)
            }
            (DrivePosition::Units(units), ..) => split(units, self.length),
            // A drive that counts increments needs a scaling; take one increment as one unit.
            (DrivePosition::Increments(increments), ..) => split(increments as f64, self.length),
        };
        let (further, position) = split(position + shift, self.length);
        self.actual_turns = turns.saturating_add(further);
        position
    }
}

impl<P: Planner> Axis<P> {
    /// The set-point takes over where the feedback is, turns included.
    pub(super) fn count_actual_turns(&mut self) {
        if let Some(modulo) = &mut self.modulo {
            modulo.turns = modulo.actual_turns;
        }
    }

    /// Whether `position` (u) is one a program may name: in the first turn, or any on a linear axis. If not,
    /// the length of a turn and the error.
    pub(super) fn in_first_turn(&self, position: f64) -> Result<(), (f64, ErrorId)> {
        match &self.modulo {
            Some(Modulo { length, .. }) if !(position >= 0.0 && position < *length) => {
                Err((*length, ErrorId::PositionOutsideModulo))
            }
            _ => Ok(()),
        }
    }

    /// Keeps an endless motion within some turns of 0. Cost: a comparison, and once in two turns about 60
    /// operations.
    #[inline(never)]
    pub(super) fn bring_back(&mut self) {
        let Some(modulo) = &mut self.modulo else { return };
        if self.setpoint.position.abs() < FAR * modulo.length {
            return;
        }
        if let Motion::Run { plan, elapsed, scans } = &mut self.motion
            && let Some(turns) = plan.bring_back(*elapsed, modulo.length)
        {
            let passed = core::mem::take(elapsed);
            *scans = u64::from(plan.scans());
            let start = plan.at(0).position;
            modulo.turns = modulo.turns.saturating_add(turns);
            self.setpoint.position = match &mut self.layer {
                Some(layer) => layer.bring_back(start, passed),
                None => start,
            };
        }
    }

    /// A plan begins: its start is the present position in the plan's frame.
    #[inline(never)]
    pub(super) fn start_of_plan(&mut self) {
        let (Some(modulo), Motion::Run { plan, .. }) = (&mut self.modulo, &self.motion) else {
            return;
        };
        let start = plan.at(0).position;
        let turns = (self.setpoint.position - start) / modulo.length;
        let nearest = (if turns < 0.0 { turns - 0.5 } else { turns + 0.5 }) as i64;
        modulo.turns = modulo.turns.saturating_add(nearest);
        self.setpoint.position = start;
        if let Some(layer) = &mut self.layer {
            layer.base.position = start;
        }
    }

    /// Start and target of a positioning command on a modulo axis, in a frame whose first turn holds the
    /// target.
    ///
    /// Cost: at most one ramp.
    #[inline(never)]
    pub(super) fn way_round(
        &self,
        entry: &Entry,
        start: &Setpoint,
        before: &Limits,
    ) -> Result<(Setpoint, f64), ErrorId> {
        let length = self.modulo.as_ref().map_or(f64::INFINITY, |modulo| modulo.length);
        let (_, here) = split(start.position, length);
        let (turns, target) = match entry.work {
            Work::Distance(distance) => {
                // Whole turns apart, so that they do not cost the rest its last bits.
                let (turns, rest) = split(distance.abs(), length);
                let (turns, rest) = if distance < 0.0 {
                    (-turns, -rest)
                } else {
                    (turns, rest)
                };
                let (further, target) = split(here + rest, length);
                (turns.saturating_add(further), target)
            }
            Work::Position(target) => (self.turns_to(target, start, here, length, entry, before)?, target),
            Work::Velocity { .. } | Work::Halt | Work::Stop | Work::Home(_) | Work::SetPosition { .. } => {
                (0, here)
            }
        };
        let (whole, error) = two_product(turns as f64, length);
        let position = (here - whole) - error;
        if !position.is_finite() {
            return Err(ErrorId::PositionInvalid);
        }
        Ok((Setpoint { position, ..*start }, target))
    }

    /// How many turns on `target` is met, both it and `here` in the first one.
    fn turns_to(
        &self,
        target: f64,
        start: &Setpoint,
        here: f64,
        length: f64,
        entry: &Entry,
        before: &Limits,
    ) -> Result<i64, ErrorId> {
        let forward = match entry.direction {
            Direction::Unset | Direction::ShortestWay => {
                let ahead = if target >= here {
                    target - here
                } else {
                    target - here + length
                };
                let forward = ahead <= length / 2.0;
                return Ok(match forward {
                    true if target < here => 1,
                    false if target > here => -1,
                    true | false => 0,
                });
            }
            Direction::Positive => true,
            Direction::Negative => false,
            Direction::Current => self.last_velocity > 0.0,
        };
        let turns = match forward {
            true if target < here => 1,
            false if target > here => -1,
            true | false => 0,
        };
        if start.is_at_rest() {
            return Ok(turns);
        }
        // A motion that cannot stop before the target goes on to its next repetition.
        let stop = self
            .planner
            .ramp_to(start, 0.0, &entry.limits, before)
            .map_err(|_| ErrorId::PlanRefused)?;
        let way = stop.at(u64::from(stop.scans())).position - start.position;
        let to_target = target + turns as f64 * length - here;
        let missing = if forward { way - to_target } else { to_target - way };
        let missing = missing - ROUNDING * way.abs();
        if missing <= 0.0 {
            return Ok(turns);
        }
        let whole = (missing / length) as i64;
        let further = whole.saturating_add(i64::from(whole as f64 * length < missing));
        Ok(if forward {
            turns.saturating_add(further)
        } else {
            turns.saturating_sub(further)
        })
    }
}

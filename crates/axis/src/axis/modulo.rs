//! Modulo axes: positions within one turn, turns counted as integers, and the direction to a target.
//!
//! Programs see positions in [0, length). The axis itself moves in a frame of its own: every plan ends in the first
//! turn of its frame, wherever it starts, so that every target is met to the bit. An endless motion is moved back
//! towards 0 when it is two turns away. The whole turns between the frame and the drive's increments are an integer.
//!
//! Source: PLCopen Motion Control Part 1, MC_MoveAbsolute and MC_DIRECTION; B8; docs/modulo.md states the rule for
//! Direction.

use super::Axis;
use super::commands::{Entry, Place, REST, Run, Work};
use crate::{AxisConfig, Direction, DrivePosition, ErrorId, ModuloTargets, Scaling, Scope, Turn};
use standstill_planner::turns::{split, two_product};
use standstill_planner::{Passage, Plan, Planner, Setpoint};

/// The distance of a target before the end of a stop that still counts as reached, relative to the travel of the
/// stop. It is rounding, and no visible reversal.
const ROUNDING: f64 = 1e-9;

/// The distance in turns at which an endless motion is moved back towards 0.
const FAR: f64 = 2.0;

/// Whether a distance (u) is so long, with turns of this `length` (u), that positions are expressed, and the rest of
/// it planned, from a nearer turn.
pub(super) fn is_far(way: f64, length: f64) -> bool {
    way.abs() >= FAR * length
}

/// The data that an axis with turns has in addition to a linear one.
#[derive(Clone, Copy, Debug)]
pub(super) struct Modulo {
    /// One turn (u).
    pub length: f64,
    /// One turn in increments, for drives that count them.
    turn: Option<Turn>,
    /// Whole turns at the frame's 0. Drives that use units have no turns, so it is not used there.
    turns: i64,
    /// Whole turns at the actual position.
    actual_turns: i64,
    /// A position of the frame (u) at which the axis was at rest when the frame was moved, and its published value
    /// before. A position some turns away has fewer bits than one in the first turn, and the position of an axis at
    /// rest must not change.
    stood: Option<(f64, f64)>,
}

impl Modulo {
    pub fn new(config: &AxisConfig) -> Option<Self> {
        let length = config.modulo?;
        Some(Self {
            length,
            turn: config.scaling.and_then(|scaling| scaling.turn(length)),
            turns: 0,
            actual_turns: 0,
            stood: None,
        })
    }

    /// Whole turns at the frame's 0.
    pub fn turns(&self) -> i64 {
        self.turns
    }

    /// Sets the turn of the axis; its position is in the first turn of the frame.
    pub fn put(&mut self, turns: i64) {
        self.turns = turns;
        self.stood = None;
    }

    /// Whether the axis may go from one position to the other within this turn, and both are published unchanged.
    #[inline]
    pub fn stays_in(&self, turns: i64, positions: [f64; 2]) -> bool {
        let turn = 0.0..self.length;
        turns == self.turns
            && self.stood.is_none()
            && positions.iter().all(|position| turn.contains(position))
    }

    /// The set-point as programs see it.
    #[inline(never)]
    pub fn shown(&self, setpoint: &Setpoint) -> Setpoint {
        setpoint.moved_to(self.in_turn(setpoint.position))
    }

    /// A position of the frame (u) in increments, for any number of turns.
    #[inline(never)]
    pub fn increments(&self, scaling: &Scaling, position: f64) -> i64 {
        let (further, position) = split(position, self.length);
        match &self.turn {
            Some(turn) => scaling.to_increments_turned(turn, self.turns.saturating_add(further), position),
            // Not reached: an axis with a scaling has a turn.
            None => scaling.to_increments(position),
        }
    }

    /// A position of the frame (u) in the first turn.
    #[inline(never)]
    pub fn in_turn(&self, position: f64) -> f64 {
        match self.stood {
            Some((here, called)) if here == position => called,
            _ => split(position, self.length).1,
        }
    }

    /// The actual position (u) in the first turn.
    #[inline(never)]
    pub fn latch(&mut self, config: &AxisConfig, feedback: DrivePosition, shift: f64) -> f64 {
        let (turns, position) = self.place_of(config, feedback, shift);
        self.actual_turns = turns;
        position
    }

    /// A position at the drive in whole turns and in the first one (u).
    #[inline]
    pub fn place_of(&self, config: &AxisConfig, feedback: DrivePosition, shift: f64) -> (i64, f64) {
        let (turns, position) = match (feedback, config.scaling, &self.turn) {
            (DrivePosition::Increments(increments), Some(scaling), Some(turn)) => {
                Scaling::to_units_turned(&scaling, turn, self.length, increments)
            }
            (DrivePosition::Units(units), ..) => split(units, self.length),
            // A drive that counts increments needs a scaling; take one increment as one unit.
            (DrivePosition::Increments(increments), ..) => split(increments as f64, self.length),
        };
        let (further, position) = split(position + shift, self.length);
        (turns.saturating_add(further), position)
    }
}

impl<P: Planner> Axis<P> {
    /// The coordinates are shifted: every position changes.
    pub(super) fn rename_places(&mut self) {
        if let Some(modulo) = &mut self.modulo {
            modulo.stood = None;
        }
    }

    /// The set-point takes the actual position, including turns.
    pub(super) fn count_actual_turns(&mut self) {
        if let Some(modulo) = &mut self.modulo {
            modulo.turns = modulo.actual_turns;
            modulo.stood = None;
        }
    }

    /// The target of an absolute move to `position` (u); in the first turn, if the axis wraps targets.
    pub(super) fn target(&self, position: f64) -> f64 {
        match (&self.modulo, self.config.modulo_targets) {
            (Some(Modulo { length, .. }), ModuloTargets::Wrap) => split(position, *length).1,
            _ => position,
        }
    }

    /// Refuses a position (u) of a program outside the first turn; on a linear axis none.
    pub(super) fn in_first_turn(
        &self,
        pin: &'static str,
        position: f64,
        scope: &mut Scope<'_>,
    ) -> Result<(), ErrorId> {
        match &self.modulo {
            Some(Modulo { length, .. }) if !(position >= 0.0 && position < *length) => {
                Err(self.refuse(pin, position, *length, ErrorId::PositionOutsideModulo, scope))
            }
            _ => Ok(()),
        }
    }

    /// Whether the set-point of a modulo axis is so far from 0 that an endless motion must be moved back.
    #[inline]
    pub(super) fn is_far_round(&self) -> bool {
        let far = |modulo: &Modulo| is_far(self.mover.setpoint().position, modulo.length);
        self.modulo.as_ref().is_some_and(far)
    }

    /// Keeps an endless motion within some turns of 0. Cost: a comparison, and about 60 operations once in two turns.
    #[inline(never)]
    pub(super) fn bring_back(&mut self) {
        let Some(modulo) = &mut self.modulo else { return };
        // If the owner is held up, its end may be in this frame.
        let is_held_up = |owner: &Entry| owner.halted || owner.paused;
        if !is_far(self.mover.setpoint().position, modulo.length)
            || self.owner.as_ref().is_some_and(is_held_up)
        {
            return;
        }
        if let Some(turns) = self.mover.bring_back(modulo.length) {
            modulo.turns = modulo.turns.saturating_add(turns);
            // Its end is in the frame that was left.
            if let Some(owner) = &mut self.owner {
                owner.end = None;
                owner.from = back_by(owner.from, turns, modulo.length);
            }
        }
    }

    /// A plan begins: the present position becomes the start in the plan's frame.
    #[inline(never)]
    pub(super) fn start_of_plan(&mut self) {
        let (Some(modulo), Some((plan, _))) = (&mut self.modulo, self.mover.plan()) else {
            return;
        };
        let start = plan.at(0).position;
        let here = self.mover.base().position;
        let turns = (here - start) / modulo.length;
        let nearest = (if turns < 0.0 { turns - 0.5 } else { turns + 0.5 }) as i64;
        modulo.turns = modulo.turns.saturating_add(nearest);
        let called = modulo.in_turn(self.mover.setpoint().position);
        self.mover.call_start(start);
        let setpoint = self.mover.setpoint();
        modulo.stood = setpoint.is_at_rest().then_some((setpoint.position, called));
    }

    /// Finds the end of `entry`, which becomes active now, and the offset of its frame from the present one.
    /// Distances, and the direction to a target, count from `from` (u). Returns its start in its frame (u).
    ///
    /// Cost: on a modulo axis at most two ramps.
    #[inline]
    pub(super) fn aim(&self, entry: &mut Entry, from: f64) -> f64 {
        let start = self.mover.setpoint().position;
        entry.sign = self.mover.last_velocity().signum();
        if let Some(Place::By(_)) = entry.place() {
            entry.from = from;
        }
        if self.modulo.is_none() {
            entry.end = entry.work.end(from);
            return start;
        }
        let here = self.mover.base().moved_to(start);
        self.aim_from(entry, &here, from)
    }

    /// The same for the command at the head of the buffer, and how it passes its end. A command that passes its end
    /// in motion need not be able to stop before it.
    ///
    /// Cost: on a modulo axis at most four ramps, and that of [`Axis::look_through`].
    pub(super) fn aim_passing(&self, entry: &mut Entry, from: f64) {
        let mut stopping = Entry {
            passage: REST,
            run: Run::NONE,
            ..*entry
        };
        let start = self.aim(&mut stopping, from);
        self.look_through(&mut stopping, start, 1);
        (entry.passage, entry.run) = (stopping.passage, stopping.run);
        self.aim(entry, from);
    }

    /// The same as [`Axis::aim`], from the state `here`.
    #[inline(never)]
    pub(super) fn aim_from(&self, entry: &mut Entry, here: &Setpoint, from: f64) -> f64 {
        match &self.modulo {
            Some(modulo) => self.aim_round(entry, here, from, modulo.length),
            None => {
                entry.end = entry.work.end(from);
                here.position
            }
        }
    }

    #[inline(never)]
    fn aim_round(&self, entry: &mut Entry, start: &Setpoint, from: f64, length: f64) -> f64 {
        (entry.turns, entry.end) = match (entry.place(), entry.direction) {
            (None, _) => (split(start.position, length).0, None),
            (Some(Place::At(target)), Some(direction)) => {
                let turns = turns_to(
                    target,
                    from,
                    length,
                    self.heading(direction, self.mover.last_velocity() > 0.0),
                );
                (self.never_back(entry, start, target, turns, length), Some(target))
            }
            (Some(Place::At(target)), None) => {
                let (turns, target) = split(target, length);
                // The target in the frame of its motion, for later calls.
                entry.work = entry.work.at(target);
                (turns, Some(target))
            }
            (Some(Place::By(distance)), _) => {
                let (turns, target) = beyond(from, distance, length);
                (turns, Some(target))
            }
        };
        entry.from = back_by(entry.from, entry.turns, length);
        back_by(start.position, entry.turns, length)
    }

    /// The end of a command in a chain, counted from `from` (u) in the frame of the command before. The motion before
    /// was `forward` or not. `None` if it has no end.
    pub(super) fn end_of_leg(&self, entry: &Entry, from: f64, forward: bool) -> Option<f64> {
        let (Some(modulo), Some(Place::At(target)), Some(direction)) =
            (&self.modulo, entry.place(), entry.direction)
        else {
            return entry.work.end(from);
        };
        let turns = turns_to(target, from, modulo.length, self.heading(direction, forward));
        Some(target + turns as f64 * modulo.length)
    }

    /// `start` in the frame of `entry`, if that is another frame.
    #[inline]
    pub(super) fn in_frame_of(&self, entry: &Entry, start: &Setpoint) -> Option<Setpoint> {
        match &self.modulo {
            Some(modulo) if entry.turns != 0 => {
                Some(start.moved_to(back_by(start.position, entry.turns, modulo.length)))
            }
            _ => None,
        }
    }

    /// The direction that a move must take: `None` for the shortest way.
    fn heading(&self, direction: Direction, forward: bool) -> Option<bool> {
        match direction {
            Direction::Unset | Direction::ShortestWay => None,
            Direction::Positive => Some(true),
            Direction::Negative => Some(false),
            Direction::Current => Some(forward),
        }
    }

    /// Whether `entry` passes its `target` from `here` without turning: with a `velocity`, or at most as fast as the
    /// next command may begin. Slowing down may take a longer distance than a stop if jerk and snap limit it. A ramp
    /// takes whole scans. A plan past a target need not, so a motion that already slows down for it can continue.
    fn passes_onward(
        &self,
        entry: &Entry,
        here: &Setpoint,
        target: f64,
        passage: &Passage,
        velocity: f64,
    ) -> bool {
        let before = self.limits_before(&entry.limits);
        let planned = if let Work::Through { .. } = entry.work {
            self.planner
                .pass(here, target, velocity, &entry.limits, &before)
                .ok()
        } else {
            let most = passage.most * (1.0 + ROUNDING);
            let blended = self.planner.blend(here, target, passage, &entry.limits, &before);
            let is_slow = |plan: &P::Plan| plan.end().velocity.abs() <= most;
            blended.ok().flatten().filter(is_slow)
        };
        planned.is_some_and(|plan| !self.turns(&plan, velocity > 0.0))
    }

    /// `turns`, plus the turns that a motion from `start` needs to slow down if it must not turn back (B8).
    pub(super) fn never_back(
        &self,
        entry: &Entry,
        start: &Setpoint,
        target: f64,
        turns: i64,
        length: f64,
    ) -> i64 {
        let heading = entry
            .direction
            .and_then(|direction| self.heading(direction, self.mover.last_velocity() > 0.0));
        let Some(forward) = heading else { return turns };
        if self.goes_on_to(entry.id) {
            return turns;
        }
        if start.is_at_rest() {
            // It may have come to rest beyond its target.
            let to_target = target - back_by(start.position, turns, length);
            let missing = if forward { -to_target } else { to_target };
            return with_further(turns, missing - ROUNDING * length, length, forward);
        }
        // As one motion it need not stop before the end of the last command.
        let (target, passage) = if entry.run.count > 0 {
            (entry.run.end, entry.run.passage)
        } else {
            (target, entry.passage)
        };
        // A command that passes its target in the same direction need not stop before it.
        let velocity = match entry.work {
            Work::Through { end_velocity, .. } if (end_velocity > 0.0) == forward => end_velocity,
            Work::Position(_) | Work::Distance(_) if passage.wanted > 0.0 => {
                let speed = passage.most.min(start.velocity.abs());
                if forward { speed } else { -speed }
            }
            _ => 0.0,
        };
        let before = self.limits_before(&entry.limits);
        let here = start.moved_to(back_by(start.position, turns, length));
        let to_target = target - here.position;
        let missing_to = |velocity: f64| {
            // The velocity at its target may be above its own limit.
            let limits = entry
                .limits
                .with_velocity(entry.limits.velocity.max(velocity.abs()));
            let ramp = self.planner.ramp_to(start, velocity, &limits, &before).ok()?;
            let way = ramp.end().position - start.position;
            let missing = if forward { way - to_target } else { to_target - way };
            Some(missing - ROUNDING * way.abs())
        };
        // If the stop can't be planned, the move can't be planned either; planning it returns the reason.
        let Some(missing) = missing_to(velocity) else {
            return turns;
        };
        let passes = || velocity != 0.0 && self.passes_onward(entry, &here, target, &passage, velocity);
        if missing <= 0.0 || passes() {
            return turns;
        }
        let missing = match entry.work {
            Work::Through { .. } => missing,
            _ => missing_to(0.0).map_or(missing, |at_rest| at_rest.min(missing)),
        };
        with_further(turns, missing, length, forward)
    }
}

/// `turns`, plus the turns in one direction that cover a `missing` distance (u).
fn with_further(turns: i64, missing: f64, length: f64, forward: bool) -> i64 {
    if missing <= 0.0 {
        return turns;
    }
    let whole = (missing / length) as i64;
    let further = whole.saturating_add(i64::from(whole as f64 * length < missing));
    if forward {
        turns.saturating_add(further)
    } else {
        turns.saturating_sub(further)
    }
}

/// `position` (u) in a frame that is `turns` whole turns ahead.
fn back_by(position: f64, turns: i64, length: f64) -> f64 {
    let (whole, error) = two_product(turns as f64, length);
    (position - whole) - error
}

/// Turns and target of a `distance` (u) from `from`. Whole turns are separated, so that the rest keeps its last bits.
fn beyond(from: f64, distance: f64, length: f64) -> (i64, f64) {
    let (from_turns, here) = split(from, length);
    let (turns, rest) = split(distance.abs(), length);
    let (turns, rest) = if distance < 0.0 {
        (-turns, -rest)
    } else {
        (turns, rest)
    };
    let (further, target) = split(here + rest, length);
    (from_turns.saturating_add(turns).saturating_add(further), target)
}

/// The number of turns to `target`, in the first turn, from `from` (u): `forward` or not, or the shortest way.
fn turns_to(target: f64, from: f64, length: f64, forward: Option<bool>) -> i64 {
    let (turns, here) = split(from, length);
    let ahead = if target >= here {
        target - here
    } else {
        target - here + length
    };
    let further = match forward.unwrap_or(ahead <= length / 2.0) {
        true if target < here => 1,
        false if target > here => -1,
        true | false => 0,
    };
    turns.saturating_add(further)
}

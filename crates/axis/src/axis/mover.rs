//! The mover of an axis: its set-point, the motion it comes from, what is superimposed on that, and the limits
//! they keep.
//!
//! It knows no commands, states or errors. `Axis` decides what it does next, and checks what it is about to
//! publish.

mod motion;
mod shaping;

use super::superimposed::Layer;
use crate::{AxisConfig, ConfigError};
use core::mem::offset_of;
pub(super) use motion::{Motion, scans_to_goal};
use shaping::Shaping;
pub(super) use shaping::even_scans;
use standstill_planner::{Limits, Plan, Planner, Setpoint, Standard};

/// The set-point of an axis and what determines the next one. What every scan looks at comes first.
#[derive(Clone, Debug)]
#[repr(C)]
pub(super) struct Mover<P: Plan> {
    /// There is `shaping`.
    is_shaped: bool,
    /// The motion may leave the software limits, so every set-point is checked.
    is_watched: bool,
    /// Of the motion; on a modulo axis its position may be some turns away from the one shown.
    setpoint: Setpoint,
    /// The last velocity that was not zero (u/s): its sign is mcCurrentDirection.
    last_velocity: f64,
    /// Limits of the present motion, for the command that takes over from it.
    in_force: Limits,
    motion: Motion<P>,
    /// Limits of the motion before, for planning the present one anew.
    before: Limits,
    /// The largest magnitude (u) that coordinates moved under the plan in progress gave its positions; see
    /// [`guard`](super::guard).
    coarsest: f64,
    /// What is between the motion and what is published.
    shaping: Option<Shaping>,
    /// A second motion on top of it.
    layer: Option<Layer<P>>,
}

// The plan has in front what most of its scans look at.
const _: () = assert!(offset_of!(Mover<<Standard as Planner>::Plan>, motion) <= 96);

/// The names of the places of a [`Mover`], to go back to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Names<P: Plan> {
    setpoint: Setpoint,
    layer: Option<Layer<P>>,
}

/// A scan of a plan beside something that moves.
#[derive(Clone, Copy, Debug)]
pub(super) struct StepBeside {
    /// The set-point of the plan.
    pub beside: Setpoint,
    /// Scans since its start.
    pub elapsed: u64,
    /// Scans from its start to its goal.
    pub scans: u64,
}

impl StepBeside {
    /// The plan is at its goal.
    pub fn is_over(&self) -> bool {
        self.elapsed >= self.scans
    }
}

impl<P: Plan> Mover<P> {
    /// At rest at the position of `config`, with scans of `cycle` (s); it holds that or follows the feedback.
    ///
    /// # Errors
    /// [`ConfigError::Vibration`] names the mode.
    pub fn new(config: &AxisConfig, cycle: f64, holds: bool) -> Result<Self, ConfigError> {
        let shaping = Shaping::new(&config.vibration, cycle, config.position)?;
        Ok(Self {
            setpoint: Setpoint::at_rest(config.position),
            last_velocity: 1.0,
            in_force: config.limits,
            is_watched: false,
            motion: if holds { Motion::Hold } else { Motion::Follow },
            is_shaped: shaping.is_some(),
            shaping,
            before: config.limits,
            coarsest: 0.0,
            layer: None,
        })
    }

    /// The set-point of the motion, with what is superimposed.
    // All that is asked in every scan is in line, so that set-points stay in registers.
    #[inline(always)]
    pub fn setpoint(&self) -> &Setpoint {
        &self.setpoint
    }

    /// The set-point without what is superimposed.
    pub fn base(&self) -> Setpoint {
        self.layer.as_ref().map_or(self.setpoint, |layer| *layer.base())
    }

    #[inline(always)]
    pub fn motion(&self) -> &Motion<P> {
        &self.motion
    }

    /// The plan in progress and the scans since its start.
    pub fn plan(&self) -> Option<(&P, u64)> {
        self.motion.plan()
    }

    /// The set-point at the goal of the plan in progress.
    pub fn goal(&self) -> Option<Setpoint> {
        let (plan, _) = self.plan()?;
        Some(plan.at(self.motion.scans()))
    }

    /// Where the plan in progress has its end (u).
    pub fn end_of_plan(&self) -> f64 {
        self.plan().map_or(self.setpoint.position, |(plan, _)| {
            plan.at(u64::from(plan.scans())).position
        })
    }

    /// The next set-point is not the last of the plan.
    #[inline]
    pub fn is_short_of_goal(&self) -> bool {
        matches!(&self.motion, Motion::Run { elapsed, scans, .. } if elapsed.wrapping_add(1) < *scans)
    }

    /// What is superimposed.
    #[inline(always)]
    pub fn layer(&self) -> Option<&Layer<P>> {
        self.layer.as_ref()
    }

    pub fn layer_mut(&mut self) -> Option<&mut Layer<P>> {
        self.layer.as_mut()
    }

    /// The limits of the present motion.
    #[inline(always)]
    pub fn in_force(&self) -> &Limits {
        &self.in_force
    }

    /// The limits of the motion before.
    pub fn before(&self) -> &Limits {
        &self.before
    }

    /// The largest magnitude (u) that its plan has had.
    pub fn coarsest(&self) -> f64 {
        self.coarsest
    }

    /// The last velocity that was not zero (u/s).
    pub fn last_velocity(&self) -> f64 {
        self.last_velocity
    }

    /// The motion may leave the software limits.
    #[inline(always)]
    pub fn is_watched(&self) -> bool {
        self.is_watched
    }

    /// Whether the motion may leave the software limits from now on.
    pub fn watch(&mut self, is_watched: bool) {
        self.is_watched = is_watched;
    }

    /// It stays where it is.
    pub fn hold(&mut self) {
        self.motion = Motion::Hold;
    }

    /// It follows the actual position.
    pub fn follow(&mut self) {
        self.motion = Motion::Follow;
    }

    /// It goes where its coupling says.
    pub fn gear(&mut self) {
        self.motion = Motion::Geared;
    }

    /// `motion` from now on, within the limits in force.
    pub fn go_on(&mut self, motion: Motion<P>) {
        self.motion = motion;
    }

    /// `motion` from now on, within `limits`.
    pub fn start(&mut self, motion: Motion<P>, limits: Limits) {
        (self.motion, self.in_force) = (motion, limits);
    }

    /// The same for a motion that is planned in the present coordinates.
    pub fn start_anew(&mut self, motion: Motion<P>, limits: Limits) {
        self.start(motion, limits);
        self.coarsest = 0.0;
    }

    /// The motion keeps `limits`.
    pub fn keep(&mut self, limits: Limits) {
        self.in_force = limits;
    }

    /// The present motion takes over from one within `limits`.
    pub fn take_over_from(&mut self, limits: Limits) {
        self.before = limits;
    }

    /// The motion keeps `limits`, and so did the one before.
    pub fn keep_only(&mut self, limits: Limits) {
        (self.in_force, self.before) = (limits, limits);
    }

    /// The next set-point of the plan; `None` without one.
    #[inline(always)]
    pub fn next(&mut self) -> Option<Setpoint> {
        let Motion::Run { plan, elapsed, .. } = &mut self.motion else {
            return None;
        };
        Some(plan.next(elapsed.wrapping_add(1)))
    }

    /// The plan goes on by a scan.
    #[inline(always)]
    pub fn count_scan(&mut self) {
        if let Motion::Run { elapsed, .. } = &mut self.motion {
            // Scans of 1 ms wrap after 10^8 years.
            *elapsed = elapsed.wrapping_add(1);
        }
    }

    /// The first set-point of the plan, which goes on from there.
    pub fn begin_plan(&mut self) -> Option<Setpoint> {
        let Motion::Run { plan, elapsed, .. } = &mut self.motion else {
            return None;
        };
        *elapsed = 1;
        Some(plan.at(1))
    }

    /// A plan beside something that moves goes on by a scan.
    pub fn step_beside(&mut self) -> Option<StepBeside> {
        let Motion::Closing { plan, elapsed, scans } = &mut self.motion else {
            return None;
        };
        *elapsed = elapsed.wrapping_add(1);
        Some(StepBeside {
            beside: plan.next(*elapsed),
            elapsed: *elapsed,
            scans: *scans,
        })
    }

    /// The motion and what is superimposed go on by a scan. Returns their sum; what follows the feedback is at
    /// `actual` (u).
    pub fn step_both(&mut self, actual: f64) -> Option<Setpoint> {
        let layer = self.layer.as_mut()?;
        let base = match &mut self.motion {
            Motion::Follow => Setpoint::at_rest(actual),
            // A motion superimposed on a law is added in the step behind the master; under a torque
            // nothing is added.
            Motion::Hold | Motion::Torque { .. } | Motion::Geared | Motion::Closing { .. } => {
                Setpoint::at_rest(layer.base().position)
            }
            Motion::Run { plan, elapsed, .. } => {
                *elapsed = elapsed.saturating_add(1);
                plan.next(*elapsed)
            }
        };
        if self.is_shaped {
            layer.count_even(&base, self.coarsest);
        }
        Some(layer.step(base))
    }

    /// Under a torque: `torque` is ordered in this scan.
    pub fn step_torque(&mut self, ordered: f64) {
        if let Motion::Torque { elapsed, torque, .. } = &mut self.motion {
            *elapsed = elapsed.saturating_add(1);
            *torque = ordered;
        }
    }

    /// `next` is the set-point.
    // Inlined, so that a set-point goes from registers to its place and is not copied through memory, which
    // takes longer than computing it.
    #[inline(always)]
    pub fn publish(&mut self, next: Setpoint) {
        if self.is_shaped() {
            // A copy, so that the set-point of an axis without a shaper needs no place in memory.
            let passed = next;
            self.pass_to_shaper(&passed);
        }
        self.setpoint = next;
        if next.velocity != 0.0 {
            self.last_velocity = next.velocity;
        }
    }

    /// The set-point is the actual state: `velocity` (u/s) at `position` (u).
    pub fn take_actual(&mut self, position: f64, velocity: f64) {
        self.setpoint = Setpoint {
            velocity,
            ..Setpoint::at_rest(position)
        };
    }

    /// The set-point is at rest at `position` (u), or is called that.
    pub fn stand_at(&mut self, position: f64) {
        self.setpoint = Setpoint::at_rest(position);
    }

    /// The plan has its goal `scans` after its start.
    pub fn set_goal(&mut self, goal: u64) {
        if let Motion::Run { scans, .. } = &mut self.motion {
            *scans = goal;
        }
    }

    /// The positions of the plan are `by` (u) larger.
    pub fn shift_plan(&mut self, by: f64) {
        if let Motion::Run { plan, .. } = &mut self.motion {
            plan.shift(by);
        }
    }

    /// The same for a plan beside something that moves.
    pub fn shift_beside(&mut self, by: f64) {
        if let Motion::Closing { plan, .. } = &mut self.motion {
            plan.shift(by);
        }
    }

    /// Coordinates move by `by` (u), and the set-point is called `at` (u). The plan keeps its places. Returns
    /// the names before.
    pub fn call(&mut self, at: f64, by: f64) -> Names<P> {
        let names = Names {
            setpoint: self.setpoint,
            layer: self.layer,
        };
        // A rounding error of the plan in progress is permanent.
        self.coarsest = self.coarsest.max(self.setpoint.position.abs()).max(at.abs());
        self.setpoint.position = at;
        if let Some(layer) = &mut self.layer {
            layer.shift(by);
        }
        names
    }

    /// The names are those of before.
    pub fn call_as_before(&mut self, names: Names<P>) {
        (self.setpoint, self.layer) = (names.setpoint, names.layer);
    }

    /// The place of the motion is called `start` (u), as its plan calls it.
    pub fn call_start(&mut self, start: f64) {
        self.setpoint.position = match &mut self.layer {
            Some(layer) => layer.start_at(start),
            None => start,
        };
    }

    /// An endless plan begins anew some turns of `length` (u) nearer to 0. Returns these turns, if it can.
    pub fn bring_back(&mut self, length: f64) -> Option<i64> {
        let Motion::Run { plan, elapsed, scans } = &mut self.motion else {
            return None;
        };
        let turns = plan.bring_back(*elapsed, length)?;
        let passed = core::mem::take(elapsed);
        *scans = u64::from(plan.scans());
        let start = plan.at(0).position;
        self.setpoint.position = match &mut self.layer {
            Some(layer) => layer.bring_back(start, passed),
            None => start,
        };
        Some(turns)
    }

    /// `layer` is superimposed.
    pub fn lay(&mut self, layer: Layer<P>) {
        self.layer = Some(layer);
    }

    /// What is superimposed; `layer` from now on if nothing was.
    pub fn layer_or(&mut self, layer: Layer<P>) -> &mut Layer<P> {
        self.layer.get_or_insert(layer)
    }

    /// Nothing is superimposed: there is one motion, that of the sum.
    pub fn drop_layer(&mut self) {
        self.layer = None;
    }
}

//! The mover of an axis: its set-point, the motion it comes from, what is superimposed on that, and the limits
//! they keep.
//!
//! It knows no commands, states or errors. `Axis` decides what it does next, and checks what it is about to
//! publish.

mod motion;
mod shaping;

use super::commands::ROUNDING;
use super::guard::Steps;
use super::superimposed::Layer;
use crate::{AxisConfig, ConfigError};
use core::mem::offset_of;
pub(super) use motion::{Motion, scans_to_goal};
use shaping::Shaping;
pub(super) use shaping::even_scans;
use standstill_planner::{Limits, Plan, Planner, Setpoint, Standard};

/// The set-point of an axis and everything that determines the next one. Fields that every scan reads come first.
#[derive(Clone, Debug)]
#[repr(C)]
pub(super) struct Mover<P: Plan> {
    /// `shaping` exists.
    is_shaped: bool,
    /// The motion may leave the software limits, so every set-point is checked.
    is_watched: bool,
    /// Set-point of the motion. On a modulo axis its position may be some turns away from the published one.
    setpoint: Setpoint,
    /// The last velocity that was not zero (u/s): its sign is mcCurrentDirection.
    last_velocity: f64,
    /// What the limits of the present motion allow in a scan.
    steps: Steps,
    motion: Motion<P>,
    /// Limits of the present motion, for the command that takes over from it.
    in_force: Limits,
    /// Limits of the motion before. They are needed to plan the present one anew.
    before: Limits,
    /// The last scan in which a command took over.
    taken_over: Option<u64>,
    /// The largest magnitude (u) that a shift of coordinates gave to positions of the plan in progress; see
    /// [`guard`](super::guard).
    coarsest: f64,
    /// The shaper between the motion and the published set-point.
    shaping: Option<Shaping>,
    /// The sample time, and a little for rounding (s).
    scan: f64,
    /// A second motion on top of it.
    layer: Option<Layer<P>>,
}

// The fields before the plan are those that most of its scans read.
const _: () = assert!(offset_of!(Mover<<Standard as Planner>::Plan>, motion) <= 96);

/// Positions of a [`Mover`] before a shift of coordinates, to undo it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Names<P: Plan> {
    setpoint: Setpoint,
    layer: Option<Layer<P>>,
}

/// A scan of a plan beside a moving reference.
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
    /// An axis at rest at the position of `config`, with scans of `cycle` (s). It holds that position or follows the
    /// feedback.
    ///
    /// # Errors
    /// [`ConfigError::Vibration`] names the mode.
    pub fn new(config: &AxisConfig, cycle: f64, holds: bool) -> Result<Self, ConfigError> {
        let shaping = Shaping::new(&config.vibration, cycle, config.position)?;
        let scan = (1.0 + ROUNDING) * cycle;
        Ok(Self {
            setpoint: Setpoint::at_rest(config.position),
            last_velocity: 1.0,
            steps: Steps::within(&config.limits, scan),
            in_force: config.limits,
            is_watched: false,
            motion: if holds { Motion::Hold } else { Motion::Follow },
            is_shaped: shaping.is_some(),
            shaping,
            before: config.limits,
            taken_over: None,
            coarsest: 0.0,
            scan,
            layer: None,
        })
    }

    /// The set-point of the motion, including the superimposed motion.
    // Everything that every scan reads is inlined, so that set-points stay in registers.
    #[inline(always)]
    pub fn setpoint(&self) -> &Setpoint {
        &self.setpoint
    }

    /// The set-point without the superimposed motion.
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

    /// The position at the end of the plan in progress (u).
    pub fn end_of_plan(&self) -> f64 {
        self.plan()
            .map_or(self.setpoint.position, |(plan, _)| plan.end().position)
    }

    /// The next set-point is not the last of the plan.
    #[inline]
    pub fn is_short_of_goal(&self) -> bool {
        matches!(&self.motion, Motion::Run { elapsed, scans, .. } if elapsed.wrapping_add(1) < *scans)
    }

    /// The superimposed motion.
    #[inline(always)]
    pub fn layer(&self) -> Option<&Layer<P>> {
        self.layer.as_ref()
    }

    pub fn layer_mut(&mut self) -> Option<&mut Layer<P>> {
        self.layer.as_mut()
    }

    /// What the limits of the present motion allow in a scan.
    #[inline(always)]
    pub fn steps(&self) -> &Steps {
        &self.steps
    }

    /// The limits of the present motion.
    pub fn in_force(&self) -> &Limits {
        &self.in_force
    }

    /// The limits of the motion before.
    pub fn before(&self) -> &Limits {
        &self.before
    }

    /// The largest magnitude (u) of positions of its plan, see the field.
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

    /// Holds the present position.
    pub fn hold(&mut self) {
        self.motion = Motion::Hold;
    }

    /// It follows the actual position.
    pub fn follow(&mut self) {
        self.motion = Motion::Follow;
    }

    /// Follows the coupling.
    pub fn gear(&mut self) {
        self.motion = Motion::Geared;
    }

    /// Continues with `motion`, within the limits in force.
    pub fn go_on(&mut self, motion: Motion<P>) {
        self.motion = motion;
    }

    /// Starts `motion` within `limits`.
    pub fn start(&mut self, motion: Motion<P>, limits: Limits) {
        self.motion = motion;
        self.keep(limits);
    }

    /// The same for a motion that is planned in the present coordinates.
    pub fn start_anew(&mut self, motion: Motion<P>, limits: Limits) {
        self.start(motion, limits);
        self.coarsest = 0.0;
    }

    /// From now on the motion keeps `limits`.
    pub fn keep(&mut self, limits: Limits) {
        self.in_force = limits;
        self.steps = Steps::within(&limits, self.scan);
    }

    /// The present motion takes over from one within `limits`.
    pub fn take_over_from(&mut self, limits: Limits) {
        self.before = limits;
    }

    /// A command takes over in `scan` from a motion within `limits`.
    pub fn taken_over_in(&mut self, scan: u64, limits: Limits) {
        self.taken_over = Some(scan);
        self.take_over_from(limits);
    }

    /// Whether the plan in progress belongs to a command that took over in this scan, and has moved nothing yet.
    pub fn has_not_moved(&self, scan: u64) -> bool {
        self.taken_over == Some(scan) && matches!(self.motion, Motion::Run { elapsed: 0, .. })
    }

    /// Both the motion and the one before keep `limits`.
    pub fn keep_only(&mut self, limits: Limits) {
        self.keep(limits);
        self.before = limits;
    }

    /// Advances the plan by a scan and returns its set-point; `None` without one.
    #[inline(always)]
    pub fn next(&mut self) -> Option<Setpoint> {
        let Motion::Run { plan, elapsed, .. } = &mut self.motion else {
            return None;
        };
        // Scans of 1 ms wrap after 10^8 years.
        *elapsed = elapsed.wrapping_add(1);
        Some(plan.next(*elapsed))
    }

    /// The first set-point of the plan. The plan continues from there.
    pub fn begin_plan(&mut self) -> Option<Setpoint> {
        let Motion::Run { plan, elapsed, .. } = &mut self.motion else {
            return None;
        };
        *elapsed = 1;
        Some(plan.at(1))
    }

    /// Advances a plan beside a moving reference by a scan.
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

    /// Advances the motion and the superimposed motion by a scan. Returns their sum. A motion that follows the
    /// feedback is at `actual` (u).
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

    /// Under a torque: the drive gets `ordered` in this scan.
    pub fn step_torque(&mut self, ordered: f64) {
        if let Motion::Torque { elapsed, torque, .. } = &mut self.motion {
            *elapsed = elapsed.saturating_add(1);
            *torque = ordered;
        }
    }

    /// Makes `next` the set-point.
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

    /// Takes the actual state as the set-point: `velocity` (u/s) at `position` (u).
    pub fn take_actual(&mut self, position: f64, velocity: f64) {
        self.setpoint = Setpoint::at_velocity(position, velocity);
    }

    /// Sets the set-point to rest at `position` (u): after a motion, or after a shift of coordinates.
    pub fn stand_at(&mut self, position: f64) {
        self.setpoint = Setpoint::at_rest(position);
    }

    /// Sets the goal of the plan to `goal` scans after its start.
    pub fn set_goal(&mut self, goal: u64) {
        if let Motion::Run { scans, .. } = &mut self.motion {
            *scans = goal;
        }
    }

    /// Shifts the positions of the plan by `by` (u).
    pub fn shift_plan(&mut self, by: f64) {
        if let Motion::Run { plan, .. } = &mut self.motion {
            plan.shift(by);
        }
    }

    /// The same for a plan beside a moving reference.
    pub fn shift_beside(&mut self, by: f64) {
        if let Motion::Closing { plan, .. } = &mut self.motion {
            plan.shift(by);
        }
    }

    /// Shifts the coordinates by `by` (u); the position of the set-point becomes `at` (u). The plan is not shifted.
    /// Returns the positions before.
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

    /// Takes back the positions from before a shift.
    pub fn call_as_before(&mut self, names: Names<P>) {
        (self.setpoint, self.layer) = (names.setpoint, names.layer);
    }

    /// Sets the position of the set-point to `start` (u), which is the same place in the frame of its plan.
    pub fn call_start(&mut self, start: f64) {
        self.setpoint.position = match &mut self.layer {
            Some(layer) => layer.start_at(start),
            None => start,
        };
    }

    /// Starts an endless plan again some turns of `length` (u) nearer to 0. Returns these turns; `None` if it can't.
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

    /// Superimposes `layer`.
    pub fn lay(&mut self, layer: Layer<P>) {
        self.layer = Some(layer);
    }

    /// The superimposed motion. If there is none, `layer` becomes it.
    pub fn layer_or(&mut self, layer: Layer<P>) -> &mut Layer<P> {
        self.layer.get_or_insert(layer)
    }

    /// Removes the superimposed motion. Only one motion remains, that of the sum.
    pub fn drop_layer(&mut self) {
        self.layer = None;
    }
}

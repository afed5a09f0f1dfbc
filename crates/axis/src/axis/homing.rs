//! Homing: the search for the reference, by the controller or by the drive.
//!
//! A search is a series of endless motions. Each one is planned at the latch of the scan in which the signal of the
//! one before was found. The reference of a switch is one of its two ends, for both directions of passing it. With a
//! creep velocity that end is passed a second time, slowly and always in the same direction. Then the axis comes to
//! rest, at some distance behind the reference, and the reference gets its position. Software limits and the override
//! do not apply. A barred direction, a time or distance that is too long, and a limit switch on the path are axis
//! errors.
//!
//! A drive that homes by itself leads, and the set-point follows it until the drive obeys the command
//! again.
//!
//! Source: PLCopen Motion Control Part 1, MC_Home; Part 5, homing procedures; V11; CiA 402, homing mode.

mod by_drive;

use super::commands::{Entry, refusal};
use super::power::Reaction;
use super::{Axis, Motion};
use crate::{AxisState, ErrorId, HomeDirection, Procedure, Scope};
use standstill_planner::{Limits, PlanError, Planner, Setpoint};

/// The step of a homing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Phase {
    /// No homing, or one that searches nothing.
    #[default]
    Idle,
    /// Towards the edge of the switch with the velocity of the search.
    Search,
    /// Past the edge again, for a second approach.
    Back,
    /// Towards the edge, slowly.
    Creep,
    /// Towards the next reference pulse.
    Pulse,
    /// Towards a mechanical stop.
    Block,
    /// The reference is known; comes to rest.
    Found,
    /// The drive homes by itself.
    Drive,
    /// The drive homes by itself, and has shifted its positions.
    Named,
    /// The drive has homed, and must return to the command.
    Return,
}

/// The progress of a homing.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Search {
    phase: Phase,
    /// The search moves towards larger positions.
    up: bool,
    /// It has reversed at a limit switch.
    turned: bool,
    /// The level of the switch in the last scan.
    was_on: bool,
    /// Scans since the start.
    scans: u64,
    /// Scans in a row with less than the velocity of a stop.
    still: u32,
    /// Travel since the start (u), and the position of the reference (u).
    way: f64,
    reference: f64,
}

impl Search {
    /// Whether there is no search.
    pub fn is_idle(&self) -> bool {
        self.phase == Phase::Idle
    }

    /// The whole state, as bits.
    pub fn bits(&self) -> [u64; 5] {
        let flags = [self.up, self.turned, self.was_on].map(u64::from);
        [
            self.phase as u64 | flags[0] << 8 | flags[1] << 9 | flags[2] << 10,
            self.scans,
            self.still.into(),
            self.way.to_bits(),
            self.reference.to_bits(),
        ]
    }

    /// Shifts the coordinates by this distance (u).
    pub fn shift(&mut self, by: f64) {
        self.reference += by;
    }
}

impl<P: Planner> Axis<P> {
    /// Refuses a homing if the drive lacks a signal for it. Nothing has moved yet.
    pub(super) fn has_signals_to_home(&self) -> Result<(), ErrorId> {
        let (homing, has) = (&self.config.homing, &self.beside.report.equipment);
        let has_it = match homing.procedure {
            Procedure::Direct | Procedure::Block => true,
            Procedure::AbsoluteSwitch => has.home_switch,
            Procedure::LimitSwitch => has.limit_switches,
            Procedure::ReferencePulse => has.marker,
            Procedure::Drive => has.homing,
        };
        if has_it && (has.marker || !homing.pulse) {
            Ok(())
        } else {
            Err(ErrorId::HomingSignalMissing)
        }
    }

    /// The first step of a homing from here.
    fn first_search(&self) -> Search {
        let homing = &self.config.homing;
        let was_on = self.home_signal(homing.direction.is_up());
        let (phase, up) = match homing.procedure {
            Procedure::Direct => (Phase::Idle, true),
            Procedure::Drive => (Phase::Drive, true),
            Procedure::ReferencePulse => (Phase::Pulse, homing.direction.is_up()),
            Procedure::Block => (Phase::Block, homing.direction.is_up()),
            // On the switch, the axis only has to move off it.
            Procedure::LimitSwitch if was_on => (Phase::Creep, !homing.direction.is_up()),
            Procedure::LimitSwitch => (Phase::Search, homing.direction.is_up()),
            Procedure::AbsoluteSwitch => {
                let up = match homing.direction {
                    // On the switch, the end is on the side the axis came from.
                    HomeDirection::Positive | HomeDirection::Negative if was_on => !homing.is_lower_end(),
                    HomeDirection::Positive => true,
                    HomeDirection::Negative => false,
                    HomeDirection::SwitchPositive => !was_on,
                    HomeDirection::SwitchNegative => was_on,
                };
                // On a limit switch there is nothing to search further out.
                (Phase::Search, up != self.is_on_limit_switch(up))
            }
        };
        Search {
            phase,
            up,
            turned: homing.procedure == Procedure::AbsoluteSwitch && self.is_on_limit_switch(!up),
            was_on,
            ..Search::default()
        }
    }

    /// The velocity (u/s) of a step; `None` if it has none of its own.
    fn velocity_of(&self, search: &Search) -> Option<f64> {
        let homing = &self.config.homing;
        let speed = match search.phase {
            Phase::Search | Phase::Back | Phase::Block => homing.velocity,
            Phase::Creep | Phase::Pulse => homing.creep.unwrap_or(homing.velocity),
            Phase::Idle | Phase::Found | Phase::Drive | Phase::Named | Phase::Return => return None,
        };
        // The application or a slave may have lowered the limit since.
        let speed = speed.min(self.slowed(&self.parameters.limits).velocity);
        Some(if search.up { speed } else { -speed })
    }

    /// The first motion of a homing.
    pub(super) fn homing_motion(&self, entry: &Entry, start: &Setpoint) -> Result<Motion<P::Plan>, ErrorId> {
        self.has_signals_to_home()?;
        let search = self.first_search();
        let Some(velocity) = self.velocity_of(&search) else {
            return Ok(Motion::Hold);
        };
        if let Some(error) = self.homing_barred(&search) {
            return Err(error);
        }
        let before = self.limits_before(&entry.limits);
        match self.planner.ramp_to(start, velocity, &entry.limits, &before) {
            Ok(plan) => Ok(Motion::along(plan)),
            Err(error) => Err(refusal(error)),
        }
    }

    /// The reason why a homing may not go in its direction.
    fn homing_barred(&self, search: &Search) -> Option<ErrorId> {
        let permitted = self.power.permitted();
        // If it reverses at a switch, that switch does not bar its direction.
        let turns = matches!(
            self.config.homing.procedure,
            Procedure::AbsoluteSwitch | Procedure::LimitSwitch
        );
        permitted.bars(search.up, !search.up).or_else(|| {
            (!turns && self.is_on_limit_switch(search.up)).then_some(ErrorId::OutwardFromLimitSwitch)
        })
    }

    /// MC_Home has become the owner.
    pub(super) fn begin_homing(&mut self) {
        self.homing = self.first_search();
        self.beside.order.homing = self.homing.phase == Phase::Drive;
        self.end_routine();
    }

    /// MC_Home no longer owns the axis.
    pub(super) fn end_homing(&mut self) {
        self.homing = Search::default();
        self.beside.order.homing = false;
        self.beside.order.marker = false;
        self.end_routine();
    }

    /// Whether a homing, or the rest of one, needs the feedback of every scan.
    pub(super) fn is_homing(&self) -> bool {
        !self.homing.is_idle() || self.moves_itself() || self.is_to_return()
    }

    /// Whether the search moves towards a limit switch on purpose, or back from one.
    pub(super) fn turns_at_limit_switch(&self, up: bool) -> bool {
        let search = &self.homing;
        self.state == AxisState::Homing && (search.phase == Phase::Search || search.up != up)
    }

    /// The switch to search for. With `up` the last approach moves towards larger positions.
    fn home_signal(&self, up: bool) -> bool {
        match self.config.homing.procedure {
            Procedure::AbsoluteSwitch => self.signals.home_switch,
            Procedure::LimitSwitch => self.is_on_limit_switch(up),
            Procedure::Direct | Procedure::ReferencePulse | Procedure::Block | Procedure::Drive => false,
        }
    }

    /// After the latch: checks what has changed, and continues with the next step.
    #[cold]
    #[inline(never)]
    pub(super) fn follow_homing(&mut self, scope: &mut Scope<'_>) {
        if self.moves_itself() || self.is_to_return() || self.is_homed_by_drive() {
            return self.follow_drive_homing(scope);
        }
        let homing = self.config.homing;
        let mut search = self.homing;
        let step = self.feedback.step();
        search.scans = search.scans.saturating_add(1);
        search.way += step.abs();
        if search.phase == Phase::Found || self.state != AxisState::Homing {
            return;
        }
        let is_up = if step == 0.0 { search.up } else { step > 0.0 };
        let on = self.home_signal(homing.direction.is_up());
        // The end of the switch that was passed. Towards larger positions the lower end switches it on.
        let passed = (on != search.was_on).then_some(on == is_up);
        search.was_on = on;
        self.homing = search;
        if homing.time_limit.is_some_and(|limit| search.scans > limit) {
            return self.trip(ErrorId::HomingTimedOut, 0, Reaction::Ramp, scope);
        }
        if homing.distance_limit.is_some_and(|limit| !(search.way <= limit)) {
            return self.trip(ErrorId::HomingTooFar, 0, Reaction::Ramp, scope);
        }
        let wanted = match homing.procedure {
            // The inner end of the limit switch.
            Procedure::LimitSwitch => homing.direction.is_up(),
            _ => homing.is_lower_end(),
        };
        let edge = passed == Some(wanted) && is_up == search.up;
        match search.phase {
            Phase::Search if edge => self.edge_found(search, scope),
            Phase::Back if edge => self.go_on(Phase::Creep, !search.up, scope),
            Phase::Creep if edge => self.switch_found(scope),
            Phase::Search if self.is_on_limit_switch(search.up) => self.turn_round(search, scope),
            Phase::Pulse => self.look_for_pulse(search, scope),
            Phase::Block => self.look_for_stop(search, step, scope),
            Phase::Idle
            | Phase::Search
            | Phase::Back
            | Phase::Creep
            | Phase::Found
            | Phase::Drive
            | Phase::Named
            | Phase::Return => {}
        }
        self.mind_permission(scope);
    }

    /// Checks that its new direction is permitted.
    fn mind_permission(&mut self, scope: &mut Scope<'_>) {
        let search = self.homing;
        let searches = self.state == AxisState::Homing && self.velocity_of(&search).is_some();
        if let Some(error) = self
            .power
            .permitted()
            .bars(search.up, !search.up)
            .filter(|_| searches)
        {
            self.trip(error, 0, Reaction::Ramp, scope);
        }
    }

    /// The edge has been passed with the velocity of the search.
    fn edge_found(&mut self, search: Search, scope: &mut Scope<'_>) {
        let homing = &self.config.homing;
        let approach = homing.direction.is_up();
        if homing.procedure == Procedure::LimitSwitch {
            // The reference is the position at which it switches off again.
            return self.go_on(Phase::Creep, !approach, scope);
        }
        match homing.creep {
            None => self.switch_found(scope),
            Some(_) if search.up == approach => self.go_on(Phase::Back, !approach, scope),
            Some(_) => self.go_on(Phase::Creep, approach, scope),
        }
    }

    /// The final edge has been passed.
    fn switch_found(&mut self, scope: &mut Scope<'_>) {
        if self.config.homing.pulse {
            self.go_on(Phase::Pulse, self.homing.up, scope);
            self.beside.order.marker = !self.beside.report.marker.armed;
        } else {
            self.found(self.feedback.position(), None, scope);
        }
    }

    /// A limit switch stops the search; it reverses.
    fn turn_round(&mut self, search: Search, scope: &mut Scope<'_>) {
        if search.turned {
            return self.trip(ErrorId::HomingSwitchNotFound, 0, Reaction::Ramp, scope);
        }
        self.homing.turned = true;
        self.go_on(Phase::Search, !search.up, scope);
    }

    /// The pulse has been latched, or the latch is not armed yet.
    fn look_for_pulse(&mut self, search: Search, scope: &mut Scope<'_>) {
        let told = self.beside.report.marker;
        if !self.beside.order.marker {
            // A position latched for another request must be cleared first.
            self.beside.order.marker = !told.armed;
        } else if let Some(latched) = told.latched.filter(|_| told.armed) {
            self.beside.order.marker = false;
            self.homing = search;
            self.found(self.place_of(latched), None, scope);
        }
    }

    /// Whether the axis is blocked at a mechanical stop; the set-point then returns to it.
    fn look_for_stop(&mut self, mut search: Search, step: f64, scope: &mut Scope<'_>) {
        let Some(block) = self.config.homing.block else {
            return;
        };
        let slow = block.velocity * self.planner.cycle();
        let stands = step.abs() < slow && self.mover.commanded().velocity.abs() >= block.velocity;
        search.still = if stands { search.still.saturating_add(1) } else { 0 };
        self.homing = search;
        if search.still >= block.scans {
            let back = self.mover.commanded().position - self.following_error();
            self.found(self.feedback.position(), Some(back), scope);
        }
    }

    /// The reference is at `reference` (u): the axis comes to rest, or first moves `to` a position (u).
    fn found(&mut self, reference: f64, to: Option<f64>, scope: &mut Scope<'_>) {
        self.homing.reference = reference;
        self.homing.phase = Phase::Found;
        let (start, profile) = (*self.mover.setpoint(), self.config.profile);
        self.go_along(scope, |planner, limits, before| match to {
            Some(end) => planner.move_to(profile, &start, end, limits, before),
            None => planner.ramp_to(&start, 0.0, limits, before),
        });
    }

    /// Continues the search within the limits that its owner has now.
    pub(super) fn search_on(&mut self, scope: &mut Scope<'_>) {
        if self.velocity_of(&self.homing).is_some() {
            self.go_on(self.homing.phase, self.homing.up, scope);
        }
    }

    /// The next phase, in a direction.
    fn go_on(&mut self, phase: Phase, up: bool, scope: &mut Scope<'_>) {
        self.homing.phase = phase;
        self.homing.up = up;
        let (start, velocity) = (
            *self.mover.setpoint(),
            self.velocity_of(&self.homing).unwrap_or(0.0),
        );
        self.go_along(scope, |planner, limits, before| {
            planner.ramp_to(&start, velocity, limits, before)
        });
    }

    /// The motion of a step, which `planned` makes from its limits and those before. They are raised if they would
    /// take the axis beyond its own.
    fn go_along(
        &mut self,
        scope: &mut Scope<'_>,
        planned: impl Fn(&P, &Limits, &Limits) -> Result<P::Plan, PlanError>,
    ) {
        let Some(mut owner) = self.owner else { return };
        let asked = owner.limits;
        let planned = self.planned_inside(asked, |limits| {
            planned(&self.planner, limits, self.mover.in_force())
        });
        match planned {
            Ok((plan, limits)) => {
                owner.limits = limits;
                self.record_raised(&asked, &limits, &mut scope.with(owner.instance));
                self.adopt(owner, Motion::along(plan), scope);
            }
            Err(error) => self.trip(refusal(error), 0, Reaction::Ramp, scope),
        }
    }

    /// A homing at its goal: the reference gets its position.
    #[cold]
    pub(super) fn settle_homing(&mut self, position: f64, scope: &mut Scope<'_>) {
        if self.homing.phase == Phase::Found && matches!(self.mover.motion(), Motion::Run { .. }) {
            // A drive sets the new position for its present set-point, so it must get the last set-point of the ramp
            // first.
            self.mover.hold();
            return;
        }
        let here = self.mover.setpoint().position;
        let reference = self.homing.reference;
        let name = match self.homing.phase {
            Phase::Idle => position,
            Phase::Found if here == reference => position,
            Phase::Found => self.shown_place(here + (position - reference)),
            Phase::Search
            | Phase::Back
            | Phase::Creep
            | Phase::Pulse
            | Phase::Block
            | Phase::Drive
            | Phase::Named
            | Phase::Return => return,
        };
        self.call_set_position(name, scope);
        self.homed = true;
        self.complete(scope);
    }

    /// A position (u) as programs see it.
    fn shown_place(&self, place: f64) -> f64 {
        self.modulo.as_ref().map_or(place, |modulo| modulo.in_turn(place))
    }
}

//! Feedback, power, faults and resets.
//!
//! Source: PLCopen Motion Control Part 1, notes 1 to 5 of the state diagram, MC_Power, MC_Reset; V9a, V10a,
//! S10 to S14; iec61131-executor CI-5, CI-8.

use super::stage::Wish;
use super::{Axis, Motion, Permission, Routine};
use crate::{
    AxisEvent, AxisState, CommandId, Comms, DriveFeedback, DrivePosition, DriveRequest, ErrorId, Event, Fate,
    PowerOff, Scope,
};
use standstill_planner::{Limits, Planner};

/// The longest step (u) of the actual position for which an axis with nothing pending does not check its velocity.
/// With any cycle from a nanosecond up the velocity is then finite. NaN and infinity are not such a step.
const USUAL_STEP: f64 = 1e290;

/// How an axis comes to rest after an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reaction {
    /// Along a ramp with the stop dynamics.
    Ramp,
    /// The drive is off already: the set-point follows the feedback.
    Follow,
}

impl<P: Planner> Axis<P> {
    /// Latches the drive's feedback of this scan and updates the state. Called before any block.
    // Inlined into its caller, like `advance`: a call alone costs a tenth of a scan with nothing pending.
    #[inline(always)]
    pub fn follow_feedback(&mut self, feedback: &DriveFeedback, scope: &mut Scope<'_>) {
        // In most scans only the position changes.
        let on_switch = feedback.signals.limit_switch_positive | feedback.signals.limit_switch_negative;
        if self.routine.is_any()
            && feedback.enabled
            && feedback.voltage
            && !on_switch
            && feedback.fault.is_none()
            && feedback.comms == Comms::Ok
            && self.latch_usual(&feedback.position)
        {
            debug_assert_eq!(self.routine, self.find_routine());
            self.signals = feedback.signals;
        } else {
            self.follow_change(feedback, scope);
        }
    }

    /// Takes the actual position of an axis with nothing pending, whose earlier positions stay valid. Returns FALSE,
    /// and takes nothing, if a full check is needed.
    // By reference: a processor that reads a pair of numbers just after they were written one by one has to wait.
    #[inline(always)]
    fn latch_usual(&mut self, told: &DrivePosition) -> bool {
        match told {
            DrivePosition::Units(units) if self.is_plain => self.latch_near(*units),
            _ => self.latch_converted(told),
        }
    }

    /// The same for a position that has to be converted, or that slaves may follow.
    #[inline(never)]
    fn latch_converted(&mut self, told: &DrivePosition) -> bool {
        let is_usual = match (told, &self.modulo) {
            (DrivePosition::Units(units), None) => self.latch_near(*units),
            (DrivePosition::Increments(increments), None) => {
                self.latch_near(self.position_at_increment(*increments))
            }
            (_, Some(_)) => self.latch_round(*told),
        };
        if is_usual && self.is_measured() {
            self.measure_actual(Some(*told));
        }
        is_usual
    }

    /// The same for a position (u) on an axis without turns.
    #[inline(always)]
    fn latch_near(&mut self, position: f64) -> bool {
        let is_usual = (position - self.feedback.position()).abs() <= USUAL_STEP;
        if is_usual {
            self.feedback.latch(position);
        }
        is_usual
    }

    /// Latches the actual position in every case. Returns FALSE, and latches nothing, if a reported value
    /// is not a number (R98).
    fn latch_told(&mut self, told: DrivePosition) -> bool {
        let is_number = told.is_finite() && self.beside.report.is_finite();
        is_number && {
            let position = self.position_of(told);
            self.latch_and_mend(position)
        }
    }

    /// Whether the axis is in operation with nothing pending and nothing supervised. It then reacts only to its
    /// feedback, its requests to the drive stay the same, and its positions need no further checks.
    ///
    /// Computed once when this state may begin; every event that ends it calls [`Axis::end_routine`]. This saves ten
    /// comparisons per scan.
    fn find_routine(&self) -> Routine {
        let is_in_operation = !matches!(self.state, AxisState::Disabled | AxisState::ErrorStop);
        let is_pending = self.failure.reset().is_some() || self.shift_due || self.frame.is_renaming();
        // After a hand-over from a torque, the axis withdraws its order in the next scan.
        let is_torque =
            matches!(self.mover.motion(), Motion::Torque { .. }) || self.beside.order.torque.is_some();
        let is_watched = self.parameters.lag.on || self.is_homing() || is_torque;
        if !(self.power.is_routine()
            && is_in_operation
            && !is_pending
            && self.feedback.is_whole()
            && !is_watched)
        {
            Routine::No
        } else if self.mover.layer().is_some() {
            Routine::Beside
        } else {
            Routine::Alone
        }
    }

    /// Something is pending, or may be.
    pub(super) fn end_routine(&mut self) {
        self.routine = Routine::No;
        self.unsettle();
    }

    /// The actual position (u), if it is a number.
    fn position_of(&mut self, told: DrivePosition) -> f64 {
        match (told, &mut self.modulo) {
            (DrivePosition::Units(units), None) => units,
            (DrivePosition::Increments(increments), None) => self.position_at_increment(increments),
            (position, Some(modulo)) => modulo.latch(&self.config, position, self.frame.shift()),
        }
    }

    /// [`Axis::latch_usual`] for a modulo axis, whose positions are never far apart.
    fn latch_round(&mut self, told: DrivePosition) -> bool {
        if !told.is_finite() {
            return false;
        }
        let position = self.position_of(told);
        self.feedback.latch(position);
        if let Some(modulo) = &self.modulo {
            self.feedback.come_round(modulo.length);
        }
        true
    }

    pub(super) fn position_at_increment(&self, increments: i64) -> f64 {
        match self.config.scaling {
            Some(scaling) => scaling.to_units(increments) + self.frame.shift(),
            // A drive that counts increments needs a scaling; take one increment as one unit.
            None => increments as f64,
        }
    }

    #[inline(never)]
    fn follow_change(&mut self, feedback: &DriveFeedback, scope: &mut Scope<'_>) {
        self.latch_signals(feedback.signals);
        let is_known = feedback.comms == Comms::Ok;
        let comms = if is_known && !self.latch_told(feedback.position) {
            Comms::Invalid
        } else {
            feedback.comms
        };
        if self.is_measured() {
            let is_fresh = comms == Comms::Ok;
            self.measure_actual(is_fresh.then_some(feedback.position));
        }
        self.power.latch(feedback, comms);
        if let Err(error) = self.fresh_position() {
            // A stage that was requested to switch off counts as off while its state is unknown. Before it is enabled
            // again the drive has to report its position.
            if self.drive_request() != DriveRequest::Enable {
                self.power.count_as_off();
            }
            self.latch_nothing();
            self.trip(error, 0, Reaction::Ramp, scope);
        } else {
            self.follow_power(feedback, scope);
            self.await_power(scope);
            self.follow_actual(scope);
            self.supervise(scope);
            if self.is_homing() {
                self.follow_homing(scope);
            }
            self.mind_limit_switches(scope);
            if self.shift_due {
                self.take_queued_shifts(scope);
            }
        }
        self.finish_reset();
        self.routine = self.find_routine();
        self.unsettle();
    }

    fn follow_power(&mut self, feedback: &DriveFeedback, scope: &mut Scope<'_>) {
        let is_lost = self.power.latch_enabled(feedback.enabled);
        if let Some(fault) = feedback.fault {
            self.power.trip();
            self.trip(ErrorId::DriveFault, fault.code, Reaction::Follow, scope);
        } else if is_lost {
            self.power.trip();
            if self.state != AxisState::Disabled {
                self.trip(ErrorId::PowerLost, 0, Reaction::Follow, scope);
            }
        }
        if self.power.is_wanted() || self.feedback.step() == 0.0 {
            self.power.end_braking();
        }
        match self.state {
            AxisState::Disabled if feedback.enabled && self.power.is_wanted() && !self.power.is_tripped() => {
                self.hold_at_actual();
                self.enter(AxisEvent::PowerOn);
            }
            AxisState::ErrorStop if !feedback.enabled => self.mover.follow(),
            AxisState::ErrorStop if matches!(self.mover.motion(), Motion::Follow) && !self.moves_itself() => {
                self.hold_at_actual();
            }
            AxisState::Disabled | AxisState::ErrorStop => {}
            _ if self.power.is_going_off() && !feedback.enabled => {
                self.power.end_going_off();
                if self.config.on_power_off == PowerOff::Drive {
                    self.power.leave_to_drive();
                }
                self.mover.follow();
                self.enter(AxisEvent::PowerOff);
            }
            _ => {}
        }
    }

    /// Power that is not confirmed in time is no longer requested.
    fn await_power(&mut self, scope: &mut Scope<'_>) {
        let Some(timeout) = self.config.power_timeout else {
            return;
        };
        if let Some(instance) = self.power.wait(timeout) {
            let error = ErrorId::PowerNotConfirmed;
            self.refuse("", f64::NAN, f64::NAN, error, &mut scope.with(instance));
        }
    }

    /// The set-point takes the actual position, so that enabling never causes a step.
    pub(super) fn hold_at_actual(&mut self) {
        self.mover.stand_at(self.feedback.position());
        self.count_actual_turns();
        self.mover.hold();
    }

    /// MC_Power: requests power or not, and sets the permitted directions. With `false` all commands are
    /// aborted in this call, and the axis goes to Disabled in its configured way (V9a). A motion that
    /// needs a direction no longer permitted brakes in this call, and continues when it is permitted
    /// again (V9).
    ///
    /// If several instances are called in one scan, the last call decides (V9b). The instance that
    /// decided in the last scan takes effect at once, others at the end of the scan if no other was
    /// called after them.
    #[inline]
    pub fn set_power(&mut self, wanted: bool, permitted: Permission, scope: &mut Scope<'_>) {
        let wish = Wish {
            wanted,
            permitted,
            instance: scope.instance,
        };
        if self.power.hear(wish) {
            self.switch(wanted, permitted, scope);
        } else {
            self.end_routine();
        }
    }

    /// Switches the axis off, regardless of MC_Power: the runtime stops.
    pub fn switch_off(&mut self, scope: &mut Scope<'_>) {
        self.power.forget_overruled();
        self.switch(false, self.power.permitted(), scope);
    }

    /// The end of a scan's calls: the last MC_Power decides.
    #[inline]
    pub(super) fn apply_power(&mut self, scope: &mut Scope<'_>) {
        if self.power.is_overruled() {
            self.change_decider(scope);
        }
    }

    #[cold]
    #[inline(never)]
    fn change_decider(&mut self, scope: &mut Scope<'_>) {
        if let Some(wish) = self.power.take_overruled() {
            self.switch(wish.wanted, wish.permitted, &mut scope.with(wish.instance));
        }
    }

    #[inline]
    fn switch(&mut self, wanted: bool, permitted: Permission, scope: &mut Scope<'_>) {
        self.power.want(wanted);
        if !wanted {
            self.switch_to_off(scope);
        } else if permitted != self.power.permitted() {
            self.permit(permitted, scope);
        }
    }

    #[inline(never)]
    fn switch_to_off(&mut self, scope: &mut Scope<'_>) {
        self.end_routine();
        self.power.let_return();
        let idle = matches!(self.state, AxisState::Disabled | AxisState::ErrorStop);
        if idle || self.power.is_going_off() {
            return;
        }
        self.end_all(Fate::Aborted, Fate::Aborted);
        self.power.go_off();
        match self.config.on_power_off {
            PowerOff::Ramp => {
                let (stop, axis) = (
                    self.slowed(&self.stop_limits()),
                    self.slowed(&self.hardest_limits()),
                );
                self.ramp_down(stop, &axis, scope);
            }
            PowerOff::Coast | PowerOff::Drive => self.mover.follow(),
        }
        if self.state != AxisState::Standstill {
            self.enter(AxisEvent::Stop);
        }
    }

    /// Plans a ramp to rest within `limits`, or within higher ones of the `axis` if these could not keep it inside
    /// them.
    pub(super) fn ramp_down(&mut self, mut limits: Limits, axis: &Limits, scope: &mut Scope<'_>) {
        // No stop is faster than this.
        self.mover.watch(false);
        // Only a plan has a set-point that is not at rest.
        if self.mover.setpoint().is_at_rest() {
            self.mover.hold();
            return;
        }
        let (start, before) = (self.mover.setpoint(), self.mover.in_force());
        let motion = match self.stopped_inside(start, &mut limits, before, axis) {
            Ok(plan) => {
                let plan = self.onto_limit(plan);
                if let Some(excess) = self.beyond_axis(&plan) {
                    self.record(Event::Unavoidable(excess), scope);
                }
                Motion::along(plan)
            }
            Err(_) => Motion::Hold,
        };
        self.mover.start(motion, limits);
    }

    /// Raises an error of the axis itself, which persists until [`Axis::clear_cause`].
    pub fn raise(&mut self, error: ErrorId, code: u16, scope: &mut Scope<'_>) {
        self.failure.set_cause(true);
        self.trip(error, code, Reaction::Ramp, scope);
    }

    /// The cause given to [`Axis::raise`] has ended; MC_Reset is still needed.
    pub fn clear_cause(&mut self) {
        self.failure.set_cause(false);
    }

    /// Enters ErrorStop: the owner fails with `error`, waiting commands fail because of the state (R77).
    /// The first error stays the one shown.
    #[cold]
    pub(super) fn trip(&mut self, error: ErrorId, code: u16, reaction: Reaction, scope: &mut Scope<'_>) {
        if self.state == AxisState::ErrorStop {
            return;
        }
        let scope = &mut self.owner_scope(scope);
        self.record(Event::Fault { error, code }, scope);
        self.end_all(Fate::Failed(error), Fate::Failed(ErrorId::InErrorStop));
        self.failure.show(error, code);
        self.power.end_going_off();
        match reaction {
            // A fault ignores slaves.
            Reaction::Ramp if self.power.is_on() && !self.moves_itself() => {
                self.ramp_down(self.stop_limits(), &self.hardest_limits(), scope);
            }
            Reaction::Ramp | Reaction::Follow => self.mover.follow(),
        }
        self.enter(AxisEvent::Fault);
    }

    /// MC_Reset: leaves ErrorStop once the axis is at rest (V10a). Outside ErrorStop it completes in the
    /// next scan without effect (V10). A reset during another one shares its result.
    ///
    /// # Errors
    /// [`ErrorId::CauseStillPresent`] if the cause is known to be still there.
    pub fn reset(&mut self, scope: &mut Scope<'_>) -> Result<CommandId, ErrorId> {
        if self.state == AxisState::ErrorStop && self.cause_known() {
            return Err(self.refuse("", f64::NAN, f64::NAN, ErrorId::CauseStillPresent, scope));
        }
        if let Some(id) = self.failure.reset() {
            return Ok(id);
        }
        let id = self.new_id();
        self.failure.begin_reset(id);
        self.end_routine();
        Ok(id)
    }

    fn cause_known(&self) -> bool {
        self.failure.has_cause()
            || self.is_silent()
            || !self.power.has_voltage()
            || self.lags()
            || self.power.fault().is_some_and(|fault| fault.cause_present)
    }

    /// Completes a reset when all its conditions are fulfilled (notes 3 and 4, S12).
    pub(super) fn finish_reset(&mut self) {
        if let Some(id) = self.failure.reset() {
            self.try_reset(id);
        }
    }

    #[cold]
    fn try_reset(&mut self, id: CommandId) {
        let (reached, moves_itself) = (self.goal_reached(), self.moves_itself());
        let through = self.mover.is_through();
        if self.state == AxisState::ErrorStop {
            let given_up = self.failure.waits_too_long() && self.power.fault().is_some();
            if given_up || self.cause_known() {
                self.failure.end_reset();
                self.decide(id, Fate::Failed(ErrorId::CauseStillPresent));
                return;
            }
            let moving =
                moves_itself || !through || (matches!(self.mover.motion(), Motion::Run { .. }) && !reached);
            let unwanted = self.power.is_on() && !self.power.is_wanted();
            if moving || unwanted || self.power.fault().is_some() {
                return;
            }
            self.power.let_return();
            self.failure.show(ErrorId::None, 0);
            self.enter(if self.power.is_on() {
                AxisEvent::ResetPowered
            } else {
                AxisEvent::ResetUnpowered
            });
        } else if self.power.is_unconfirmed() {
            self.power.let_return();
        }
        self.failure.end_reset();
        self.decide(id, Fate::Done);
    }

    #[cold]
    fn is_resetting_drive(&self) -> bool {
        self.state == AxisState::ErrorStop && self.power.fault().is_some()
    }

    /// Whether the communication is lost, so that the state of the drive is unknown.
    fn is_silent(&self) -> bool {
        self.power.comms() != Comms::Ok
    }

    /// The request to the power stage in this scan.
    pub(super) fn drive_request(&self) -> DriveRequest {
        let ramping = matches!(self.mover.motion(), Motion::Run { .. }) || !self.mover.is_through();
        if self.failure.reset().is_some() && self.is_resetting_drive() {
            DriveRequest::FaultReset
        } else if ramping && self.power.is_on() {
            DriveRequest::Enable
        } else if self.power.is_braking()
            || self.power.is_going_off() && self.config.on_power_off == PowerOff::Drive
        {
            DriveRequest::QuickStop
        } else if self.power.is_going_off() || self.power.is_tripped() || !self.power.is_wanted() {
            DriveRequest::Off
        } else if self.is_silent() && !self.power.is_on() {
            // If it were enabled now, it would step from its real position to its last known one.
            DriveRequest::Off
        } else {
            DriveRequest::Enable
        }
    }
}

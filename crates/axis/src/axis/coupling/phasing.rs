//! MC_PhasingAbsolute and MC_PhasingRelative: the slave sees its master at a shifted place.
//!
//! The shift moves on a plan of its own, in units of the master. The plan keeps the sum of master and shift inside
//! the limits of the slave: it is slower than commanded, or waits for room. The shift belongs to the slave. It
//! remains when another coupling with the same master takes over, and ends with the last coupling.
//!
//! Source: PLCopen Motion Control Part 1, MC_PhasingAbsolute, MC_PhasingRelative; V21. docs/coupling.md states what
//! the standard leaves open.

use super::super::Axis;
use super::super::commands::{Entry, Work, refusal};
use super::view::{Course, Kind, Seen, View};
use crate::{AxisId, BufferMode, Cams, CommandId, ErrorId, Event, Fate, InstanceId, PhaseShift, Scope};
use standstill_planner::{Limits, Plan, PlanError, Planner, Setpoint};

/// A change of the shift.
#[derive(Clone, Copy, Debug)]
struct Shift {
    id: CommandId,
    instance: InstanceId,
    /// To this value, or by it (u of the master).
    shift: f64,
    is_relative: bool,
    /// The commanded limits; infinite if the slave's limits decide.
    limits: Limits,
    /// Whether this command moves the shift now.
    runs: bool,
}

/// A moving shift.
#[derive(Clone, Copy, Debug)]
struct Moving<Plan> {
    plan: Plan,
    elapsed: u64,
    scans: u64,
    limits: Limits,
    /// The same, or the limits of the earlier shifts whose motion it took over.
    most: Limits,
    /// The known motion of the masters when it was planned.
    kind: Kind,
    /// The motion of the masters has changed since then, so there may be more room.
    is_dated: bool,
}

/// The shift of one master's place, as its slave sees it.
#[derive(Clone, Copy, Debug, Default)]
struct Shifts {
    /// The present shift (u of the master) and its derivatives.
    now: Setpoint,
    command: Option<Shift>,
    /// A shift that waits behind it.
    next: Option<Shift>,
}

/// The shifts of all masters of a slave.
#[derive(Clone, Copy, Debug)]
pub(in crate::axis) struct Phasing<Plan> {
    legs: [Shifts; 2],
    /// The moving shift and its master; only one moves at a time.
    motion: Option<(usize, Moving<Plan>)>,
}

impl<Plan> Default for Phasing<Plan> {
    fn default() -> Self {
        Self {
            legs: [Shifts::default(); 2],
            motion: None,
        }
    }
}

impl<Plan> Phasing<Plan> {
    /// Whether there is no shift and none is commanded.
    pub(super) fn is_none(&self) -> bool {
        let rests = |leg: &Shifts| leg.command.is_none() && leg.now.position == 0.0;
        self.motion.is_none() && self.legs.iter().all(rests)
    }

    fn shifts(&self) -> impl Iterator<Item = &Shift> {
        self.legs
            .iter()
            .flat_map(|leg| [&leg.command, &leg.next])
            .flatten()
    }
}

impl Seen {
    /// The same master, seen with a shift.
    pub(super) fn shifted(self, by: &Setpoint) -> Self {
        let mut seen = self;
        seen.unshifted = Some(self.own_rates());
        seen.place.phase += by.position;
        seen.at.velocity += by.velocity;
        seen.at.acceleration += by.acceleration;
        seen.at.jerk += by.jerk;
        seen.at.snap += by.snap;
        seen.trembles &= by.velocity == 0.0;
        seen
    }

    /// Its own velocity (u/s) and acceleration (u/s^2), without a shift.
    pub(super) fn own_rates(&self) -> [f64; 2] {
        self.unshifted.unwrap_or([self.at.velocity, self.at.acceleration])
    }

    /// The size of the numbers that give its shifted place (u).
    pub(super) fn size(&self) -> f64 {
        self.at.position.abs() + self.place.phase.abs()
    }
}

impl<P: Planner> Axis<P> {
    /// The distance by which the slave sees this master ahead of its real place (u of the master); 0 if it does not
    /// follow it.
    pub fn phase_of(&self, master: AxisId) -> f64 {
        let mut phases = self.followed().into_iter().zip(self.phases());
        phases
            .find(|(followed, _)| *followed == Some(master))
            .map_or(0.0, |(_, phase)| phase)
    }

    /// The same for each of its masters; 0 without a shift.
    pub fn phases(&self) -> [f64; 2] {
        self.follower.phasing.legs.map(|leg| leg.now.position)
    }

    /// MC_PhasingAbsolute, MC_PhasingRelative: shifts the master as the slave sees it. Nothing is planned here,
    /// because in the motion step the master moves first.
    ///
    /// # Errors
    /// The [`ErrorId`] the block shows: the axis does not follow this master, a pin is not usable, or
    /// another command already waits behind the one in progress. Nothing changes then.
    pub fn shift_phase(&mut self, request: &PhaseShift, scope: &mut Scope<'_>) -> Result<CommandId, ErrorId> {
        let Some(mode) = request.buffer_mode.get() else {
            let number = f64::from(request.buffer_mode.number());
            return Err(self.refuse("BufferMode", number, f64::NAN, ErrorId::BufferModeInvalid, scope));
        };
        self.finite("PhaseShift", request.shift, scope)?;
        let limits = self.limits_of_shift(request, scope)?;
        let is_asked = |master: &Option<AxisId>| *master == Some(request.master);
        let leg = self.followed().iter().position(is_asked);
        let Some(leg) = leg.filter(|_| !self.has_lost_master()) else {
            let master = f64::from(request.master.number());
            return Err(self.refuse("Master", master, f64::NAN, ErrorId::NotCoupled, scope));
        };
        self.unsettle();
        let shift = Shift {
            id: self.new_id(),
            instance: scope.instance,
            shift: request.shift,
            is_relative: request.is_relative,
            limits,
            runs: false,
        };
        if mode == BufferMode::Aborting {
            self.end_shifts(leg, Fate::Aborted);
        }
        if let Some(leg) = self.follower.phasing.legs.get_mut(leg) {
            let slot = if leg.command.is_none() {
                &mut leg.command
            } else {
                &mut leg.next
            };
            if slot.is_some() {
                let number = f64::from(mode as i32);
                return Err(self.refuse("BufferMode", number, f64::NAN, ErrorId::BufferFull, scope));
            }
            *slot = Some(shift);
        }
        Ok(shift.id)
    }

    fn limits_of_shift(&self, request: &PhaseShift, scope: &mut Scope<'_>) -> Result<Limits, ErrorId> {
        let dynamics = &request.dynamics;
        let pins = [
            ("Velocity", dynamics.velocity, ErrorId::VelocityInvalid),
            (
                "Acceleration",
                dynamics.acceleration,
                ErrorId::AccelerationInvalid,
            ),
            (
                "Deceleration",
                dynamics.deceleration,
                ErrorId::DecelerationInvalid,
            ),
            ("Jerk", dynamics.jerk, ErrorId::JerkInvalid),
            ("Snap", dynamics.snap, ErrorId::SnapInvalid),
        ];
        let mut most = [f64::INFINITY; 5];
        for (most, (pin, value, error)) in most.iter_mut().zip(pins) {
            if !(value >= 0.0 && value.is_finite()) {
                return Err(self.refuse(pin, value, 0.0, error, scope));
            }
            if value > 0.0 {
                *most = value;
            }
        }
        let [velocity, acceleration, deceleration, jerk, snap] = most;
        Ok(Limits {
            velocity,
            acceleration,
            deceleration,
            jerk,
            snap,
        })
    }

    /// Ends the commands for the shift of this master; the shift stays as it is.
    fn end_shifts(&mut self, leg: usize, fate: Fate) {
        let Some(leg) = self.follower.phasing.legs.get_mut(leg) else {
            return;
        };
        let ended = [leg.command.take(), leg.next.take()];
        for shift in ended.into_iter().flatten() {
            self.decide(shift.id, fate);
        }
    }

    /// Ends the shifts together with the coupling.
    pub(in crate::axis) fn end_phasing(&mut self) {
        for leg in 0..self.follower.phasing.legs.len() {
            self.end_shifts(leg, Fate::Aborted);
        }
        self.follower.phasing = Phasing::default();
    }

    /// The shifts, if `entry`, which takes over, follows the same masters and continues them.
    pub(in crate::axis) fn lend_phasing(&mut self, entry: &Entry) -> Phasing<P::Plan> {
        if self.goes_on_behind_masters(entry) {
            core::mem::take(&mut self.follower.phasing)
        } else {
            Phasing::default()
        }
    }

    /// The last owner has ended; its phase shift continues.
    pub(in crate::axis) fn keep_phasing(&mut self, phasing: Phasing<P::Plan>) {
        self.follower.phasing = phasing;
    }

    /// Whether `entry` follows the masters of the owner.
    pub(super) fn goes_on_behind_masters(&self, entry: &Entry) -> bool {
        match entry.work {
            Work::Gear(gearing) => self.followed() == gearing.masters(),
            Work::Cam(camming) => self.followed() == [Some(camming.master), None],
            _ => false,
        }
    }

    /// The state of command `id`, if it belongs to the shift in progress.
    pub(in crate::axis) fn phasing_fate(&self, id: CommandId) -> Option<Fate> {
        let shift = self.follower.phasing.shifts().find(|shift| shift.id == id)?;
        Some(if shift.runs {
            Fate::Active { reached: false }
        } else {
            Fate::Waiting
        })
    }

    /// Removes command `id` if it waits for its turn or for room. Returns whether it did.
    pub(in crate::axis) fn withdraw_shift(&mut self, id: CommandId) -> bool {
        let waits = |shift: &mut Shift| shift.id == id && !shift.runs;
        let mut taken = false;
        for leg in &mut self.follower.phasing.legs {
            let is_here = leg.command.take_if(waits).is_some() || leg.next.take_if(waits).is_some();
            if is_here {
                leg.command = leg.command.or_else(|| leg.next.take());
            }
            taken |= is_here;
        }
        if taken {
            self.decide(id, Fate::Aborted);
        }
        taken
    }

    /// Whether the shift is changing.
    pub(super) fn is_phasing(&self) -> bool {
        self.follower.phasing.motion.is_some()
    }

    /// The most of the limits that a changing shift of this master takes (u of the master).
    pub(super) fn taken_by_shift(&self, leg: usize) -> Option<&Limits> {
        let motion = self.follower.phasing.motion.as_ref();
        motion
            .filter(|(moves, _)| *moves == leg)
            .map(|(_, moving)| &moving.most)
    }

    /// The present shifts.
    pub(super) fn phases_now(&self) -> [&Setpoint; 2] {
        let [first, second] = &self.follower.phasing.legs;
        [&first.now, &second.now]
    }

    /// The masters as this slave sees them in this scan; a moving shift advances by one scan.
    ///
    /// Cost: if a command for a shift waits, a search along the masters' plans and one plan.
    pub(super) fn shifted_view<'v>(
        &mut self,
        view: &View<'v, P::Plan>,
        scope: &mut Scope<'_>,
    ) -> View<'v, P::Plan> {
        if self.follower.phasing.is_none() {
            return *view;
        }
        self.hasten_shift(view, scope);
        for leg in 0..self.follower.phasing.legs.len() {
            self.begin_shift(leg, view, scope);
        }
        let mut shifted = *view;
        for leg in &mut self.follower.phasing.legs {
            // The reason why it was stopped has ended.
            leg.now = Setpoint::at_rest(leg.now.position);
        }
        if let Some((leg, moving)) = &mut self.follower.phasing.motion {
            let leg = *leg;
            moving.elapsed = moving.elapsed.wrapping_add(1);
            let now = moving.plan.next(moving.elapsed);
            let is_over = moving.elapsed >= moving.scans;
            if let (Some(shift), Some(part)) = (
                self.follower.phasing.legs.get_mut(leg),
                shifted.future.parts.get_mut(leg),
            ) {
                shift.now = now;
                if !matches!(part.course, Course::Measured(_)) {
                    part.course = Course::Unknown;
                }
            }
            if is_over {
                self.follower.phasing.motion = None;
                self.complete_shift(leg);
            }
        }
        let [by, by_second] = self.phases_now();
        shifted.now = view.now.shifted(by);
        shifted.second = view.second.map(|seen| seen.shifted(by_second));
        shifted
    }

    fn complete_shift(&mut self, leg: usize) {
        let Some(leg) = self.follower.phasing.legs.get_mut(leg) else {
            return;
        };
        if let Some(done) = leg.command.take_if(|shift| shift.runs) {
            leg.command = leg.next.take();
            self.decide(done.id, Fate::Done);
        }
    }

    /// Begins the command that waits for room, if there is room.
    fn begin_shift(&mut self, leg: usize, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        let Some(Shifts { now, command, .. }) = self.follower.phasing.legs.get(leg).copied() else {
            return;
        };
        let Some(mut shift) = command.filter(|shift| !shift.runs) else {
            return;
        };
        // Only one shift moves at a time.
        if self
            .follower
            .phasing
            .motion
            .as_ref()
            .is_some_and(|(moves, _)| *moves != leg)
        {
            return;
        }
        let Some(room) = self.room_for_shift((leg, &shift.limits), view, &scope.cams) else {
            return;
        };
        let asked = shift.shift;
        if shift.is_relative {
            // From now on a fixed value, even if it is planned anew.
            shift.shift += now.position;
            shift.is_relative = false;
        }
        let scope = &mut scope.with(shift.instance);
        let planned = self.planned_shift(&shift, &now, &room, view);
        let is_planned = planned.is_ok();
        match planned {
            Ok(moving) => {
                shift.runs = true;
                self.run_shift(leg, shift.shift, moving, scope);
            }
            Err(error) => {
                let error = self.refuse("PhaseShift", asked, f64::NAN, refusal(error), scope);
                self.decide(shift.id, Fate::Failed(error));
            }
        }
        if let Some(leg) = self.follower.phasing.legs.get_mut(leg) {
            leg.command = if is_planned { Some(shift) } else { leg.next.take() };
        }
    }

    /// Plans the shift in progress anew if its masters leave more room since, and it is done sooner with that.
    ///
    /// Cost: that of [`Axis::shifted_view`], once for each motion of the masters.
    fn hasten_shift(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        let kind = view.future.kind();
        let Some((leg, moving)) = &mut self.follower.phasing.motion else {
            return;
        };
        moving.is_dated |= view.future.is_new || moving.kind != kind;
        let (leg, left) = (*leg, moving.scans.saturating_sub(moving.elapsed));
        if !moving.is_dated {
            return;
        }
        let Some(Shifts { now, command, .. }) = self.follower.phasing.legs.get(leg).copied() else {
            return;
        };
        let Some(shift) = command.filter(|shift| shift.runs) else {
            return;
        };
        let Some(room) = self.room_for_shift((leg, &shift.limits), view, &scope.cams) else {
            return;
        };
        if let Some((_, moving)) = &mut self.follower.phasing.motion {
            (moving.is_dated, moving.kind) = (false, kind);
        }
        match self.planned_shift(&shift, &now, &room, view) {
            Ok(moving) if moving.scans < left => {
                self.run_shift(leg, shift.shift, moving, &mut scope.with(shift.instance));
            }
            _ => {}
        }
    }

    fn run_shift(&mut self, leg: usize, to: f64, moving: Moving<P::Plan>, scope: &mut Scope<'_>) {
        let scans = moving.plan.scans();
        self.follower.phasing.motion = Some((leg, moving));
        self.record(Event::Phasing { to, scans }, scope);
    }

    /// The plan of a shift from its state `now`, within the part of the `room` that it needs.
    fn planned_shift(
        &self,
        shift: &Shift,
        now: &Setpoint,
        room: &Limits,
        view: &View<'_, P::Plan>,
    ) -> Result<Moving<P::Plan>, PlanError> {
        let asked = &shift.limits;
        let rate = asked.lower_acceleration().min(room.lower_acceleration());
        let mut limits = Limits {
            velocity: asked.velocity.min(room.velocity),
            acceleration: rate,
            deceleration: rate,
            jerk: asked.jerk.min(room.jerk),
            snap: asked.snap.min(room.snap),
        };
        let moving = self.follower.phasing.motion.as_ref().map(|(_, moving)| moving);
        let before = moving.map_or(limits, |moving| moving.limits);
        let most = moving.map(|moving| moving.most);
        let planned = |limits: &Limits| {
            self.planner
                .move_to(self.config.profile, now, shift.shift, limits, &before)
        };
        let mut plan = planned(&limits)?;
        if let (Some(most), true) = (&most, self.slows_master() && plan.excess().is_some()) {
            // At such low rates it would exceed the room left by the master.
            limits = Limits {
                velocity: limits.velocity,
                acceleration: limits.acceleration.max(most.acceleration),
                deceleration: limits.deceleration.max(most.deceleration),
                jerk: limits.jerk.max(most.jerk),
                snap: limits.snap.max(most.snap),
            };
            plan = planned(&limits)?;
        }
        Ok(Moving {
            scans: plan.scans().into(),
            plan,
            elapsed: 0,
            limits,
            most: most.map_or(limits, |before| limits.or_larger(&before)),
            kind: view.future.kind(),
            is_dated: false,
        })
    }

    /// The part of the slave's limits that the law leaves, in units of the master. None if it leaves nothing, while
    /// the slave is not in gear, or while the master's future motion is not known.
    fn room_for_shift(
        &self,
        (leg, asked): (usize, &Limits),
        view: &View<'_, P::Plan>,
        cams: &Cams<'_>,
    ) -> Option<Limits> {
        if self.is_on_cam() {
            return self.room_for_shift_on_cam(asked, view, cams);
        }
        let coupling = self.coupling()?;
        if !coupling.rung.is_locked() || self.adds_motion() {
            return None;
        }
        let limits = &self.slowed(&self.parameters.limits);
        let ratio = coupling.gearing.factor(leg, 1.0).abs();
        if ratio == 0.0 {
            return Some(*limits);
        }
        let room = match view.future.kind() {
            // The master's step in this scan belonged to another plan, which left it less room.
            _ if self.slows_master() && (view.future.is_new || view.future.is_late()) => return None,
            Kind::Still => *limits,
            Kind::Measured => self.room_now(view, limits)?,
            _ => self.room_beside(&coupling.leads(&view.future)?, limits)?,
        };
        Some(self.share_of_shift(room, limits).over(ratio))
    }
}

//! MC_PhasingAbsolute and MC_PhasingRelative: the slave sees its master ahead of where it is, or behind.
//!
//! The shift moves on a plan of its own, in units of the master, which leaves the sum of master and shift inside the limits of the
//! slave: slower than asked, or it waits until there is room. It belongs to the slave, stays when another coupling with the same
//! master takes over, and ends with the last.
//!
//! Source: PLCopen Motion Control Part 1, MC_PhasingAbsolute, MC_PhasingRelative; V21. What the standard leaves open is told in
//! docs/coupling.md.

use super::super::Axis;
use super::super::commands::{Entry, Work, refusal};
use super::Rung;
use super::view::{Course, Seen, View};
use crate::{BufferMode, CommandId, ErrorId, Event, Fate, InstanceId, PhaseShift, Scope};
use standstill_planner::{Limits, Plan, Planner, Setpoint};

/// How a shift is to change.
#[derive(Clone, Copy, Debug)]
struct Shift {
    id: CommandId,
    instance: InstanceId,
    /// To this, or by it (u of the master).
    shift: f64,
    is_relative: bool,
    /// As asked; infinite where the slave's limits decide.
    limits: Limits,
    /// The shift moves as this command says.
    runs: bool,
}

/// A moving shift.
#[derive(Clone, Copy, Debug)]
struct Moving<Plan> {
    plan: Plan,
    elapsed: u64,
    scans: u64,
    limits: Limits,
}

/// The shift between a master and what its slave sees of it.
#[derive(Clone, Copy, Debug)]
pub(in crate::axis) struct Phasing<Plan> {
    /// The shift (u of the master), and how it moves.
    now: Setpoint,
    motion: Option<Moving<Plan>>,
    command: Option<Shift>,
    /// One that is to follow it.
    next: Option<Shift>,
}

impl<Plan> Default for Phasing<Plan> {
    fn default() -> Self {
        Self {
            now: Setpoint::default(),
            motion: None,
            command: None,
            next: None,
        }
    }
}

impl<Plan> Phasing<Plan> {
    /// There is no shift, and none is asked for.
    fn is_none(&self) -> bool {
        self.command.is_none() && self.motion.is_none() && self.now.position == 0.0
    }

    fn holds(&self, id: CommandId) -> bool {
        [&self.command, &self.next]
            .into_iter()
            .flatten()
            .any(|shift| shift.id == id)
    }
}

impl Seen {
    /// The same master as it is seen with a shift.
    pub(super) fn shifted(self, by: &Setpoint) -> Self {
        let mut seen = self;
        seen.place.phase += by.position;
        seen.at.velocity += by.velocity;
        seen.at.acceleration += by.acceleration;
        seen.at.jerk += by.jerk;
        seen.at.snap += by.snap;
        seen
    }
}

impl<P: Planner> Axis<P> {
    /// By how much the slave sees its master ahead of where it is (u of the master); 0 without a coupling.
    pub fn phase(&self) -> f64 {
        self.phasing.now.position
    }

    /// MC_PhasingAbsolute, MC_PhasingRelative: what the slave sees of its master is shifted. Nothing is planned here: in the motion
    /// step the master has moved already.
    ///
    /// # Errors
    /// The [`ErrorId`] the block shows: the axis does not follow this master, a pin is not usable, or another command waits already
    /// behind the one in progress. Nothing changes then.
    pub fn shift_phase(&mut self, request: &PhaseShift, scope: &mut Scope<'_>) -> Result<CommandId, ErrorId> {
        let Some(mode) = request.buffer_mode.get() else {
            let number = f64::from(request.buffer_mode.number());
            return Err(self.refuse("BufferMode", number, f64::NAN, ErrorId::BufferModeInvalid, scope));
        };
        self.finite("PhaseShift", request.shift, scope)?;
        let limits = self.limits_of_shift(request, scope)?;
        if self.master() != Some(request.master) || self.has_lost_master() {
            let master = f64::from(request.master.number());
            return Err(self.refuse("Master", master, f64::NAN, ErrorId::NotCoupled, scope));
        }
        let shift = Shift {
            id: self.new_id(),
            instance: scope.instance,
            shift: request.shift,
            is_relative: request.is_relative,
            limits,
            runs: false,
        };
        if mode == BufferMode::Aborting {
            self.end_shifts(Fate::Aborted);
            self.phasing.command = Some(shift);
        } else if self.phasing.command.is_none() {
            self.phasing.command = Some(shift);
        } else if self.phasing.next.is_none() {
            self.phasing.next = Some(shift);
        } else {
            let number = f64::from(mode as i32);
            return Err(self.refuse("BufferMode", number, f64::NAN, ErrorId::BufferFull, scope));
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

    /// The commands for the shift have ended; it stays as it is.
    fn end_shifts(&mut self, fate: Fate) {
        let ended = [self.phasing.command.take(), self.phasing.next.take()];
        for shift in ended.into_iter().flatten() {
            self.decide(shift.id, fate);
        }
    }

    /// The coupling has ended, and with it the shift.
    pub(in crate::axis) fn end_phasing(&mut self) {
        self.end_shifts(Fate::Aborted);
        self.phasing = Phasing::default();
    }

    /// The shift, if it goes on with `entry`, which takes over: behind the same master.
    pub(in crate::axis) fn lend_phasing(&mut self, entry: &Entry) -> Phasing<P::Plan> {
        match entry.work {
            Work::Gear(gearing) if self.master() == Some(gearing.master) => {
                core::mem::take(&mut self.phasing)
            }
            _ => Phasing::default(),
        }
    }

    /// What became of command `id`, if it is one for the shift in progress.
    pub(in crate::axis) fn phasing_fate(&self, id: CommandId) -> Option<Fate> {
        let phasing = &self.phasing;
        let runs = phasing.command.is_some_and(|shift| shift.id == id && shift.runs);
        let fate = if runs {
            Fate::Active { reached: false }
        } else {
            Fate::Waiting
        };
        phasing.holds(id).then_some(fate)
    }

    /// If command `id` waits for its turn or for room, it is taken out. Returns whether that is so.
    pub(in crate::axis) fn withdraw_shift(&mut self, id: CommandId) -> bool {
        let waits = |shift: &mut Shift| shift.id == id && !shift.runs;
        let taken = self.phasing.command.take_if(waits).is_some();
        let taken = taken || self.phasing.next.take_if(waits).is_some();
        if taken {
            self.decide(id, Fate::Aborted);
            self.phasing.command = self.phasing.command.or_else(|| self.phasing.next.take());
        }
        taken
    }

    /// The shift is changing.
    pub(super) fn is_phasing(&self) -> bool {
        self.phasing.motion.is_some()
    }

    /// The shift as it is now.
    pub(super) fn phase_now(&self) -> &Setpoint {
        &self.phasing.now
    }

    /// The master as this slave sees it in this scan: the shift goes on by a scan.
    ///
    /// Cost: where a command for the shift waits, a look along the master's plan and a plan.
    pub(super) fn shifted_view<'v>(
        &mut self,
        view: &View<'v, P::Plan>,
        scope: &mut Scope<'_>,
    ) -> View<'v, P::Plan> {
        if self.phasing.is_none() {
            return *view;
        }
        self.begin_shift(view, scope);
        let mut shifted = *view;
        if let Some(moving) = &mut self.phasing.motion {
            moving.elapsed = moving.elapsed.wrapping_add(1);
            self.phasing.now = moving.plan.next(moving.elapsed);
            shifted.future.course = Course::Unknown;
            if moving.elapsed >= moving.scans {
                self.phasing.motion = None;
                self.complete_shift();
            }
        } else {
            // What brought it to rest is over.
            self.phasing.now = Setpoint::at_rest(self.phasing.now.position);
        }
        shifted.now = view.now.shifted(&self.phasing.now);
        shifted
    }

    fn complete_shift(&mut self) {
        if let Some(done) = self.phasing.command.take_if(|shift| shift.runs) {
            self.decide(done.id, Fate::Done);
            self.phasing.command = self.phasing.next.take();
        }
    }

    /// The command that waits for room begins, if there is some.
    fn begin_shift(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        let Some(mut shift) = self.phasing.command.filter(|shift| !shift.runs) else {
            return;
        };
        let Some(room) = self.room_for_shift(view) else {
            return;
        };
        let now = self.phasing.now;
        let from = if shift.is_relative { now.position } else { 0.0 };
        let target = from + shift.shift;
        let asked = &shift.limits;
        let rate = asked.lower_acceleration().min(room.lower_acceleration());
        let limits = Limits {
            velocity: asked.velocity.min(room.velocity),
            acceleration: rate,
            deceleration: rate,
            jerk: asked.jerk.min(room.jerk),
            snap: asked.snap.min(room.snap),
        };
        let before = self
            .phasing
            .motion
            .as_ref()
            .map_or(limits, |moving| moving.limits);
        let scope = &mut scope.with(shift.instance);
        let planned = self
            .planner
            .move_to(self.config.profile, &now, target, &limits, &before);
        match planned {
            Ok(plan) => {
                let scans = plan.scans();
                shift.runs = true;
                self.phasing.command = Some(shift);
                self.phasing.motion = Some(Moving {
                    plan,
                    elapsed: 0,
                    scans: scans.into(),
                    limits,
                });
                self.record(Event::Phasing { to: target, scans }, scope);
            }
            Err(error) => {
                let error = self.refuse("PhaseShift", shift.shift, f64::NAN, refusal(error), scope);
                self.phasing.command = self.phasing.next.take();
                self.decide(shift.id, Fate::Failed(error));
            }
        }
    }

    /// What the law leaves of the slave's limits, in units of the master; none while it leaves nothing, or while the slave is not
    /// in gear or what the master does next is not known.
    fn room_for_shift(&self, view: &View<'_, P::Plan>) -> Option<Limits> {
        let coupling = self.coupling.as_ref()?;
        if coupling.rung != Rung::Locked {
            return None;
        }
        let limits = &self.parameters.limits;
        let ratio = coupling.gearing.gear.derivative(1.0).abs();
        if ratio == 0.0 {
            return Some(*limits);
        }
        let room = match view.future.course {
            Course::Still => *limits,
            Course::Plan(..) => {
                let (plan, from, _) = view.future.plan()?;
                self.room_beside((plan, from), coupling.factor(&view.future), limits)?
            }
            Course::Unknown => return None,
        };
        Some(Limits {
            velocity: room.velocity / ratio,
            acceleration: room.acceleration / ratio,
            deceleration: room.deceleration / ratio,
            jerk: room.jerk / ratio,
            snap: room.snap / ratio,
        })
    }
}

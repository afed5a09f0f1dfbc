//! The part of its limits that slaves leave to their master (`on_limit` `slow_master`).
//!
//! Bounds are collected at the end of each motion step, from the lowest slaves up, and apply from then on. They apply
//! to commands of the master, to waiting commands, and to the motion in progress, which is planned anew from its
//! state as for an override. Only the ramp after a fault ignores slaves.
//!
//! A bound lasts from the first scan in gear to the end of the coupling, also while the slave lags or changes to
//! another ratio.

use super::super::commands::{Entry, Leg, REST, Work};
use super::super::inside::pins;
use super::super::{Axis, Motion};
use super::Rung;
use crate::{AxisId, Event, OnLimit, Scope};
use standstill_planner::{Limits, Planner};

/// The largest part of the room that a shift between master and slave may take, so that the master can
/// always move.
const SHARE: f64 = 0.5;

/// The part of the remaining room that a shift may take now, so that rounding keeps the master's motion
/// inside the rest.
const NEARLY_ALL: f64 = 1023.0 / 1024.0;

/// The limits that the slaves of an axis leave to it.
#[derive(Clone, Copy, Debug)]
pub(in crate::axis) struct Bound {
    /// In force.
    now: Limits,
    /// The bound found so far in this motion step.
    next: Limits,
}

impl Default for Bound {
    /// There are no slaves.
    fn default() -> Self {
        Self {
            now: Limits::NONE,
            next: Limits::NONE,
        }
    }
}

impl<P: Planner> Axis<P> {
    /// `limits`, lowered to those that slaves leave.
    pub(in crate::axis) fn slowed(&self, limits: &Limits) -> Limits {
        limits.or_smaller(&self.follower.bound.now)
    }

    /// Lowers the limits of `entry` to those that slaves leave. Commands that follow a master, keep their times or
    /// move nothing have no limits to lower here.
    pub(in crate::axis) fn bound_entry(&self, entry: &mut Entry) {
        if !Self::has_bound(&entry.work) {
            return;
        }
        entry.limits = self.slowed(&entry.limits);
        let (velocity, most) = (entry.work.manner().velocity, self.follower.bound.now.velocity);
        if velocity.abs() > most {
            entry.work = entry.work.with_velocity(most.copysign(velocity));
        }
    }

    /// Records which limits of `entry` slaves have lowered.
    pub(in crate::axis) fn record_slowed(&self, entry: &Entry, scope: &mut Scope<'_>) {
        if !self.is_slowed() || !Self::has_bound(&entry.work) {
            return;
        }
        let mut free = *entry;
        self.scale_entry(&mut free);
        let mut asked = free.limits;
        if let Work::Velocity { velocity, .. } = free.work {
            asked.velocity = velocity.abs();
        }
        let velocity = match entry.work {
            Work::Halt | Work::Stop => "",
            _ => "Velocity",
        };
        self.record_slowed_pins(velocity, &asked, scope);
    }

    /// The same for the limits `asked`. The velocity is that of pin `velocity`; without one the command
    /// only brakes.
    pub(in crate::axis) fn record_slowed_pins(
        &self,
        velocity: &'static str,
        asked: &Limits,
        scope: &mut Scope<'_>,
    ) {
        let used = self.slowed(asked);
        let only_brakes = velocity.is_empty();
        for (pin, value, limit) in pins(velocity, asked, &used) {
            let counts = !only_brakes || !matches!(pin, "" | "Acceleration");
            if counts && value > limit {
                self.record(Event::Slowed { pin, value, limit }, scope);
            }
        }
    }

    /// Whether it may slow its master down, or is slowed down itself.
    pub(crate) fn may_bound(&self) -> bool {
        let slows = self.config.following.on_limit == OnLimit::SlowMaster;
        (slows && (self.is_coupled() || self.is_on_cam())) || self.is_slowed()
    }

    /// Every velocity limit is finite, so there is a bound if the bound's velocity is finite.
    pub(in crate::axis) fn is_slowed(&self) -> bool {
        self.follower.bound.now.velocity.is_finite()
    }

    /// Called before bounds are collected: resets the bound, and notes whether its master keeps its
    /// limits.
    pub(crate) fn begin_bound(&mut self) {
        self.follower.bound.next = Limits::NONE;
        if self.config.following.on_limit != OnLimit::SlowMaster {
            return;
        }
        self.begin_bound_on_cam();
        let Some(coupling) = &mut self.follower.coupling else {
            return;
        };
        match coupling.rung {
            Rung::Locked => coupling.slows = true,
            Rung::Lost => coupling.slows = false,
            Rung::Due
            | Rung::Own
            | Rung::BesideLaw(_)
            | Rung::BesideMeasured { .. }
            | Rung::BesideLine { .. } => {}
        }
    }

    /// Lowers the bound to `bound`, the limits that a slave leaves.
    pub(crate) fn lower_bound(&mut self, bound: &Limits) {
        self.follower.bound.next = self.follower.bound.next.or_smaller(bound);
    }

    /// Whether its master keeps its limits.
    pub(super) fn slows_master(&self) -> bool {
        self.coupling().is_some_and(|coupling| coupling.slows) || self.bound_on_cam().is_some()
    }

    /// Whether its motion was planned within the limits that its slaves leave. It was not if it was planned before
    /// there were slaves, or after a fault.
    pub(super) fn keeps_bound(&self) -> bool {
        let own = Some(self.mover.in_force()).filter(|_| !matches!(self.mover.motion(), Motion::Hold));
        let added = self.mover.layer().and_then(|layer| layer.limits_in_motion());
        let mut all = own.into_iter().chain(added);
        self.is_slowed() && all.all(|limits| self.slowed(limits) == *limits)
    }

    /// The limits that it leaves to each of its masters: its own limits and what its own slaves leave,
    /// converted by the gear. Each of two masters gets half. A moving shift takes its part of them.
    pub(crate) fn bounds_of_masters(&self) -> impl Iterator<Item = (AxisId, Limits)> + use<P> {
        let coupling = self.coupling().filter(|coupling| coupling.slows);
        let bounds = coupling.map_or([None; 2], |coupling| {
            let gearing = &coupling.gearing;
            let part = if gearing.second.is_some() { 0.5 } else { 1.0 };
            let limits = self.slowed(&self.parameters.limits).times(part);
            let bound = |number: usize, leg: Leg| {
                let bound = behind(&limits, leg.gear.ratio())?;
                Some((leg.master, self.beside_shift(number, bound)))
            };
            let second = gearing.second.and_then(|leg| bound(1, leg));
            [bound(0, gearing.first), second]
        });
        let on_cam = self.master_on_cam().zip(self.bound_on_cam());
        let on_cam = on_cam.map(|(master, bound)| (master, self.beside_shift(0, bound)));
        bounds.into_iter().flatten().chain(on_cam)
    }

    /// The part of `bound` that a changing shift of this master leaves.
    fn beside_shift(&self, leg: usize, bound: Limits) -> Limits {
        let shift = self.taken_by_shift(leg);
        shift.map_or(bound, |shift| beside(&bound, shift))
    }

    /// The most of `room` that a shift between master and slave may take, in units of the master. The
    /// slave has `limits` in all.
    pub(super) fn share_of_shift(&self, room: Limits, limits: &Limits) -> Limits {
        if self.config.following.on_limit != OnLimit::SlowMaster {
            return room;
        }
        room.times(NEARLY_ALL).or_smaller(&limits.times(SHARE))
    }

    /// Applies the bound found in this motion step from now on.
    pub(crate) fn take_bound(&mut self, scope: &mut Scope<'_>) {
        if self.follower.bound.next == self.follower.bound.now {
            return;
        }
        self.follower.bound.now = self.follower.bound.next;
        self.unsettle();
        self.override_queue();
        self.bound_owner(scope);
        self.override_superimposed(scope);
    }

    /// Plans the owner anew within the new bound. If it can't be planned with it, it continues unchanged.
    fn bound_owner(&mut self, scope: &mut Scope<'_>) {
        let Some(mut owner) = self.owner.filter(|owner| Self::has_bound(&owner.work)) else {
            return;
        };
        let was = owner;
        self.note_passing(&mut owner);
        self.override_entry(&mut owner);
        if owner.limits == was.limits && owner.work == was.work {
            return;
        }
        let is_over = self.is_at_goal() && !owner.is_endless();
        if is_over || self.goes_on_within(&was, &owner) {
            self.mover
                .keep(Self::limits_of(&owner.limits, self.mover.motion()));
            self.own(owner);
            return;
        }
        self.record_slowed(&owner, &mut scope.with(owner.instance));
        let planned = if let Work::Home(_) = owner.work {
            self.own(owner);
            self.search_on(scope);
            Ok(())
        } else {
            self.replan(owner, scope)
        };
        if let Err(error) = planned {
            self.refuse_plan(&owner, error, &mut scope.with(owner.instance));
        }
        self.end_orphan();
    }

    /// Whether it has no motion, or one at its goal.
    fn is_at_goal(&self) -> bool {
        match self.mover.motion() {
            Motion::Run { elapsed, scans, .. } => elapsed >= scans,
            _ => true,
        }
    }

    /// Whether the motion in progress may continue: its limits become lower, it keeps them, and it leads to the same
    /// end.
    fn goes_on_within(&self, was: &Entry, owner: &Entry) -> bool {
        let is_lower = owner.limits == owner.limits.or_smaller(&was.limits);
        let Motion::Run { plan, elapsed, .. } = self.mover.motion() else {
            return false;
        };
        let is_alone = self.mover.layer().is_none() && owner.passage == REST && !self.replan_due;
        is_lower
            && is_alone
            && owner.work == was.work
            && self.planner.fits_behind(
                &[None; 2],
                self.mover.setpoint(),
                Some((plan, *elapsed)),
                &owner.limits,
            )
    }

    /// Whether the limits of `work` are its own, so that slaves can lower them.
    pub(in crate::axis) fn has_bound(work: &Work) -> bool {
        match work {
            Work::Position(_)
            | Work::Distance(_)
            | Work::Through { .. }
            | Work::Velocity { .. }
            | Work::Release(_)
            | Work::Halt
            | Work::Stop
            | Work::Home(_) => true,
            Work::Profile { .. }
            | Work::Torque { .. }
            | Work::Gear(_)
            | Work::Cam(_)
            | Work::SetPosition { .. }
            | Work::Write(_) => false,
        }
    }
}

/// The limits of a master whose slave has these `limits` and this gear ratio; none if the slave does not move.
fn behind(limits: &Limits, (numerator, denominator): (i32, u16)) -> Option<Limits> {
    let (ways, turns) = (f64::from(denominator), f64::from(numerator).abs());
    let behind = |limit: f64| limit * ways / turns;
    (numerator != 0).then(|| Limits {
        velocity: behind(limits.velocity),
        acceleration: behind(limits.acceleration),
        deceleration: behind(limits.deceleration),
        jerk: behind(limits.jerk),
        snap: behind(limits.snap),
    })
}

/// The part of `bound` that a moving shift leaves. A decreasing speed of the shift may be an increasing speed of the
/// slave, so the lower rate applies in both directions.
fn beside(bound: &Limits, shift: &Limits) -> Limits {
    let less = |limit: f64, taken: f64| {
        if limit.is_finite() {
            (limit - taken).max(limit * SHARE)
        } else {
            limit
        }
    };
    let rate = less(bound.lower_acceleration(), shift.lower_acceleration());
    Limits {
        velocity: less(bound.velocity, shift.velocity),
        acceleration: rate,
        deceleration: rate,
        jerk: less(bound.jerk, shift.jerk),
        snap: less(bound.snap, shift.snap),
    }
}

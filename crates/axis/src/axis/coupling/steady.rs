//! A scan in which nothing is new: the slave is in gear, or in sync on a cam, its master continues as before, and the
//! set-point is the law.
//!
//! This module does what [`follow`](super::follow) does in such a scan, and no more. If anything has changed, it
//! changes nothing and leaves the step to `follow`. So such a slave costs little more than an axis in a move, and
//! every bit of the result is the same.

use super::super::commands::ROUNDING;
use super::super::modulo::Modulo;
use super::super::{Axis, Motion, Routine};
use super::follow::LONGEST;
use super::view::{Course, Kind, KnownPart, Source};
use super::{Coupling, Seen};
use crate::{AxisId, OnLimit, Scope, ValueSource};
use standstill_planner::{Limits, Place, Planner, Setpoint};

/// The data of the last step of an axis, if some axis may follow another. They show whether anything is new in the
/// next step.
#[derive(Clone, Copy, Debug, Default)]
pub(in crate::axis) struct Steady {
    /// Nothing is new; never out of date if it is TRUE.
    is_settled: bool,
    /// In the last step nothing was new, for the axis or its masters.
    has_gone_on: bool,
    /// The room of the limits in a scan in which nothing is new; `None` before the first such scan behind
    /// a master.
    pub(super) room: Option<Room>,
    /// The place of the axis before its step in this scan, only if some slave may follow it.
    was: Seen,
    /// The source of the set-point in this scan.
    pub(super) source: Source,
}

/// The limits for the set-point of a slave in a scan in which nothing is new, computed once. All are finite, so a
/// value within them is a number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    /// Its derivatives: the limits of the slave.
    most: Limits,
    /// Distance (u) from the last set-point, and changes of velocity (u/s) and acceleration (u/s^2): the limits of
    /// the axis.
    step: [f64; 3],
    /// It is in gear by a law of axes without turns, and neither is phase shifted.
    is_straight: bool,
}

impl Room {
    /// For a slave with these limits, on an axis of `widest` limits with this sample time (s).
    fn new(limits: &Limits, widest: &Limits, cycle: f64, is_straight: bool) -> Self {
        let finite = |most: f64| most.min(f64::MAX);
        let most = |limit: f64| finite(limit * (1.0 + ROUNDING));
        let scan = LONGEST * cycle;
        Self {
            most: Limits {
                velocity: most(limits.velocity),
                acceleration: most(limits.acceleration),
                deceleration: most(limits.deceleration),
                jerk: most(limits.jerk),
                snap: most(limits.snap),
            },
            step: [
                finite(widest.velocity * scan),
                finite(widest.acceleration.max(widest.deceleration) * scan),
                finite(widest.jerk * scan),
            ],
            is_straight,
        }
    }

    /// Whether the derivatives of `next` are within the limits of the slave.
    // Inlined, so that the set-point stays in registers.
    #[inline(always)]
    pub(super) fn holds(&self, next: &Setpoint) -> bool {
        let most = &self.most;
        let rate = if next.velocity * next.acceleration < 0.0 {
            most.deceleration
        } else {
            most.acceleration
        };
        next.velocity.abs() <= most.velocity
            && next.acceleration.abs() <= rate
            && next.jerk.abs() <= most.jerk
            && next.snap.abs() <= most.snap
    }

    /// Whether the axis may go from `last` to `next` in a scan, allowing for the rounding of positions.
    // In line, so that the set-point stays in registers.
    #[inline(always)]
    fn holds_step(&self, last: &Setpoint, next: &Setpoint) -> bool {
        let [way, velocity, acceleration] = self.step;
        (next.position - last.position).abs() <= way
            && (next.velocity - last.velocity).abs() <= velocity
            && (next.acceleration - last.acceleration).abs() <= acceleration
    }
}

impl KnownPart {
    /// Whether the known motion of the master continues in this scan: it follows the plan of that axis, this number
    /// of scans after its start.
    #[inline(always)]
    pub(super) fn goes_on(&self, (root, elapsed): (usize, u64)) -> bool {
        // The first scan of a plan is recognized by the end of the plan.
        self.root == root && self.elapsed.wrapping_add(1) == elapsed && elapsed > 1
    }
}

impl Coupling {
    /// Whether the coupling permits a step in which nothing is new: it is in gear with the set-point of one master,
    /// the slave has these limits, and its coordinates were shifted this number of times.
    fn may_go_on(&self, limits: &Limits, moves: u32) -> bool {
        self.rung.is_locked()
            && self.gearing.second.is_none()
            && self.gearing.first.source == ValueSource::Set
            && self.anchor.is_some()
            && self.known[0].kind == Kind::Plan
            && self.moves == moves
            && self.limits == *limits
            && self.left == u64::MAX
    }

    /// Whether the law is that of axes without turns, and neither is phase shifted.
    fn is_straight(&self) -> bool {
        let gear = &self.gearing.first.gear;
        self.anchor.is_some_and(|anchor| gear.is_straight(&anchor))
    }
}

impl<P: Planner> Axis<P> {
    /// Whether its own state permits a next step in which nothing is new. It is then in gear, or in sync on a cam. It
    /// does not move beside the law, waits for nothing, and does not check each of its steps.
    fn may_go_on(&self) -> bool {
        let (limits, moves) = (self.slowed(&self.parameters.limits), self.frame.moves());
        let in_gear = self.coupling();
        let on_cam = self.on_cam();
        let is_locked = in_gear.is_some_and(|coupling| coupling.may_go_on(&limits, moves))
            || on_cam.is_some_and(|on_cam| on_cam.may_go_on(&limits, moves));
        is_locked
            && self.routine == Routine::Alone
            && matches!(self.mover.motion(), Motion::Geared)
            && *self.mover.in_force() == limits
            && *self.mover.before() == limits
            && self.config.following.on_limit != OnLimit::Error
            && self.parameters.software_limits.is_none()
            && self.queue.is_empty()
            && self.follower.awaited.is_none()
            && self.follower.phasing.is_none()
            && !self.is_paused()
            && !self.bars_any()
    }

    /// After a step: notes whether nothing may be new in the next one.
    pub(super) fn note_steady(&mut self) {
        self.follower.steady.is_settled = self.may_go_on();
        if self.follower.steady.is_settled {
            let is_straight = self.coupling().is_some_and(Coupling::is_straight);
            let (limits, widest) = (self.mover.in_force(), &self.config.limits);
            self.follower.steady.room = Some(Room::new(limits, widest, self.planner.cycle(), is_straight));
        }
    }

    /// Before any axis has moved in this scan: nothing is new for an axis that follows none.
    pub(crate) fn settle_alone(&mut self) {
        self.follower.steady.is_settled = true;
    }

    /// Whether nothing is new: it follows no master, or it is a slave whose next step may be one in which nothing is
    /// new. Every event that ends this calls [`Axis::unsettle`].
    #[inline]
    pub(crate) fn is_settled(&self) -> bool {
        self.follower.steady.is_settled
    }

    /// Something is new, or may be.
    #[inline]
    pub(in crate::axis) fn unsettle(&mut self) {
        self.follower.steady.is_settled = false;
    }

    /// Called before a step in which something may be new.
    pub(crate) fn begin_anew(&mut self) {
        self.unsettle();
        self.follower.steady.has_gone_on = false;
        self.note_source();
    }

    /// Notes its place before its step, if a slave may follow it.
    #[inline(always)]
    pub(crate) fn note_before(&mut self, scan: u64) {
        if !self.links.is_followed() {
            return;
        }
        if self.modulo.is_none() {
            self.follower.steady.was.at = *self.mover.setpoint();
            self.follower.steady.was.moved = self.coordinates_moved(scan);
        } else {
            self.note_before_round(scan);
        }
        if !self.links.is_bound() {
            self.note_source();
        }
    }

    /// The same on a modulo axis.
    #[inline(never)]
    fn note_before_round(&mut self, scan: u64) {
        self.follower.steady.was = self.seen_before(scan);
    }

    /// After its step: its place before the step, as noted.
    pub(crate) fn was(&self) -> Seen {
        let mut was = self.follower.steady.was;
        was.place.position = was.at.position;
        was
    }

    /// The one master of a slave for which nothing is new.
    #[inline(always)]
    pub(crate) fn steady_master(&self) -> Option<AxisId> {
        if !self.follower.steady.is_settled {
            return None;
        }
        let coupling = self.coupling();
        coupling.map_or_else(
            || self.master_on_cam(),
            |coupling| Some(coupling.gearing.first.master),
        )
    }

    /// After a step that its slaves expected: the axis whose plan it follows, and the scans since the start of that
    /// plan.
    #[inline(always)]
    fn went_on(&self) -> Option<(usize, u64)> {
        match self.mover.motion() {
            // If something was new for it or one of its masters, its slaves check the step completely.
            Motion::Geared if self.follower.steady.has_gone_on => {
                let coupling = self.coupling().filter(|_| self.follower.steady.is_settled)?;
                let known = &coupling.known[0];
                Some((known.root, known.elapsed))
            }
            Motion::Run { .. } if self.follower.steady.source == Source::Plan => match self.course() {
                Course::Plan(_, elapsed) => Some((self.id.index(), elapsed)),
                Course::Still | Course::Unknown | Course::Measured(_) => None,
            },
            _ => None,
        }
    }

    /// The step of a slave for which nothing is new, after that of its master. If its master did not continue as
    /// expected, something is new after all: returns FALSE and changes nothing.
    ///
    /// Cost: one evaluation of the law.
    #[inline(always)]
    pub(crate) fn follow_steadily(&mut self, master: &Self, scope: &mut Scope<'_>) -> bool {
        debug_assert!(self.may_go_on());
        let Some(plan) = master
            .went_on()
            .filter(|_| !master.frame.has_moved_in(scope.scan))
        else {
            return false;
        };
        let Some(coupling) = &mut self.follower.coupling else {
            return self.follow_cam_steadily(master, plan, scope);
        };
        let (known, gear) = (&mut coupling.known[0], &coupling.gearing.first.gear);
        let (Some(anchor), Some(room)) = (&coupling.anchor, &self.follower.steady.room) else {
            return false;
        };
        if !known.goes_on(plan) {
            return false;
        }
        let at = master.mover.setpoint();
        let (turns, position) = if room.is_straight
            && let Some(position) = gear.slave_straight(anchor, at.position)
        {
            (0, position)
        } else {
            let place = gear.slave(anchor, master.place());
            (place.turns, place.position)
        };
        let next = Setpoint {
            position,
            velocity: gear.derivative(at.velocity),
            acceleration: gear.derivative(at.acceleration),
            jerk: gear.derivative(at.jerk),
            snap: gear.derivative(at.snap),
        };
        if !room.holds(&next) {
            return false;
        }
        (_, known.elapsed) = plan;
        self.follower.steady.source = Source::Gear;
        let place = Place::new(turns, position);
        self.publish_steadily(place, next, scope);
        true
    }

    /// Publishes the set-point of a scan in which nothing is new; its whole turns are those of `place`.
    // In line, so that the set-point stays in registers.
    #[inline(always)]
    pub(super) fn publish_steadily(&mut self, place: Place, next: Setpoint, scope: &mut Scope<'_>) {
        self.follower.steady.has_gone_on = true;
        let positions = [self.mover.setpoint().position, next.position];
        let stays = |modulo: &Modulo| modulo.stays_in(place.turns, positions);
        if let Some(room) = &self.follower.steady.room
            && self.modulo.as_ref().is_none_or(stays)
            && room.holds_step(self.mover.setpoint(), &next)
        {
            self.mover.publish(next);
        } else {
            self.publish_behind(place, next, scope);
        }
    }
}

//! A scan in which nothing is new: the slave is in gear, its master goes on as it did, and the set-point is the law.
//!
//! It is what [`follow`](super::follow) does in such a scan and no more: where anything is not as it was, that is left to it, and
//! nothing has changed yet. So a slave in gear costs little more than an axis in a move, and every bit is the same.

use super::super::commands::ROUNDING;
use super::super::{Axis, Calm, Motion};
use super::follow::LONGEST;
use super::view::{Course, Kind, Source};
use super::{Coupling, Seen};
use crate::{AxisId, OnLimit, Scope, ValueSource};
use standstill_planner::{Limits, Place, Planner, Setpoint};

/// What a set-point in gear may have for a scan in which nothing is new, worked out once. All of it is finite, so what is within it is
/// a number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Room {
    /// Its derivatives: the limits of the slave.
    most: Limits,
    /// Way (u) from the set-point before it, and what velocity (u/s) and acceleration (u/s^2) change by: the limits of the axis.
    step: [f64; 3],
    /// The law is that of axes without turns, and neither is shifted.
    is_straight: bool,
}

impl Room {
    /// Of a slave in gear, on an axis of `widest` limits with this sample time (s).
    fn new(coupling: &Coupling, widest: &Limits, cycle: f64) -> Self {
        let (gear, limits) = (&coupling.gearing.first.gear, &coupling.limits);
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
            is_straight: coupling.anchor.is_some_and(|anchor| gear.is_straight(&anchor)),
        }
    }

    /// The derivatives of `next` are within the limits of the slave.
    // In line, so that the set-point stays in registers.
    #[inline(always)]
    fn holds(&self, next: &Setpoint) -> bool {
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

    /// The axis may go from `last` to `next` in a scan, whatever positions are rounded by.
    // In line, so that the set-point stays in registers.
    #[inline(always)]
    fn holds_step(&self, last: &Setpoint, next: &Setpoint) -> bool {
        let [way, velocity, acceleration] = self.step;
        (next.position - last.position).abs() <= way
            && (next.velocity - last.velocity).abs() <= velocity
            && (next.acceleration - last.acceleration).abs() <= acceleration
    }
}

impl<P: Planner> Axis<P> {
    /// Whether nothing of its own keeps the next step from being that of a scan in which nothing is new: it is in gear behind the
    /// set-point of one master, and neither moves beside the law nor waits for anything, nor looks at each of its steps.
    fn may_go_on(&self) -> bool {
        let limits = self.slowed(&self.parameters.limits);
        let in_gear = self.coupling.as_ref().filter(|coupling| {
            coupling.rung.is_locked()
                && coupling.gearing.second.is_none()
                && coupling.gearing.first.source == ValueSource::Set
                && coupling.anchor.is_some()
                && coupling.known[0].kind == Kind::Plan
                && coupling.moves == self.frame.moves()
                && coupling.limits == limits
                && coupling.left == u64::MAX
        });
        in_gear.is_some()
            && self.calm == Calm::Alone
            && matches!(self.motion, Motion::Geared)
            && self.in_force == limits
            && self.before == limits
            && self.config.following.on_limit != OnLimit::Error
            && self.parameters.software_limits.is_none()
            && self.queue.is_empty()
            && self.awaited.is_none()
            && self.phasing.is_none()
            && !self.is_paused()
            && !self.bars_any()
    }

    /// After a step: notes whether the next one may be that of a scan in which nothing is new.
    pub(super) fn note_steady(&mut self) {
        self.is_settled = self.may_go_on();
        if let Some(coupling) = self.coupling.as_mut().filter(|_| self.is_settled) {
            coupling.room = Some(Room::new(coupling, &self.config.limits, self.planner.cycle()));
        }
    }

    /// Before any axis has moved in this scan: nothing is new for an axis that follows none.
    pub(crate) fn settle_alone(&mut self) {
        self.is_settled = true;
    }

    /// Nothing is new: it follows none, or is a slave whose next step may be that of a scan in which nothing is new. Whatever ends
    /// that says so ([`Axis::unsettle`]).
    #[inline]
    pub(crate) fn is_settled(&self) -> bool {
        self.is_settled
    }

    /// Something is new, or may be.
    #[inline]
    pub(in crate::axis) fn unsettle(&mut self) {
        self.is_settled = false;
    }

    /// Before a step in which something may be new.
    pub(crate) fn begin_anew(&mut self) {
        self.unsettle();
        self.has_gone_on = false;
        self.note_source();
    }

    /// Before its step, if some slave may follow it: notes where it is.
    #[inline(always)]
    pub(crate) fn note_before(&mut self, scan: u64) {
        if !self.is_followed {
            return;
        }
        if self.modulo.is_none() {
            self.was.at = self.setpoint;
            self.was.moved = self.coordinates_moved(scan);
        } else {
            self.note_before_round(scan);
        }
        if !self.is_bound {
            self.note_source();
        }
    }

    /// The same on an axis that comes round.
    #[inline(never)]
    fn note_before_round(&mut self, scan: u64) {
        self.was = self.seen_before(scan);
    }

    /// After its step: where it was before that, as noted.
    pub(crate) fn was(&self) -> Seen {
        let mut was = self.was;
        was.place.position = was.at.position;
        was
    }

    /// The one master of a slave for which nothing is new.
    #[inline(always)]
    pub(crate) fn steady_master(&self) -> Option<AxisId> {
        let coupling = self.coupling.as_ref().filter(|_| self.is_settled)?;
        Some(coupling.gearing.first.master)
    }

    /// After its step, if it went on as its slaves know it: the axis whose plan it follows, and the scans after the start of that.
    #[inline(always)]
    fn went_on(&self) -> Option<(usize, u64)> {
        match &self.motion {
            // Where something was new for it, or for a master of it, its slaves look at the step as it did.
            Motion::Geared if self.has_gone_on => {
                let coupling = self.coupling.as_ref().filter(|_| self.is_settled)?;
                let known = &coupling.known[0];
                Some((known.root, known.elapsed))
            }
            Motion::Run { .. } if self.source == Source::Plan => match self.course() {
                Course::Plan(_, elapsed) => Some((self.id.index(), elapsed)),
                Course::Still | Course::Unknown | Course::Measured(_) => None,
            },
            _ => None,
        }
    }

    /// The step of a slave for which nothing is new, after that of its master. Returns FALSE, and has done nothing, if something is
    /// new all the same: its master did not go on as it was known to.
    ///
    /// Cost: one evaluation of the law.
    #[inline(always)]
    pub(crate) fn follow_steadily(&mut self, master: &Self, scope: &mut Scope<'_>) -> bool {
        debug_assert!(self.may_go_on());
        let Some((root, elapsed)) = master.went_on() else {
            return false;
        };
        let Some(coupling) = &mut self.coupling else {
            return false;
        };
        let (known, gear) = (&mut coupling.known[0], &coupling.gearing.first.gear);
        // The first scan of a plan is told by where that ends.
        let goes_on = known.root == root
            && known.elapsed.wrapping_add(1) == elapsed
            && elapsed > 1
            && !master.frame.has_moved_in(scope.scan);
        if !goes_on {
            return false;
        }
        let (Some(anchor), Some(room)) = (&coupling.anchor, &coupling.room) else {
            return false;
        };
        let at = &master.setpoint;
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
        known.elapsed = elapsed;
        self.source = Source::Gear;
        self.has_gone_on = true;
        if room.is_straight && room.holds_step(&self.setpoint, &next) {
            self.publish(next);
        } else {
            let place = Place {
                turns,
                position,
                ..Place::default()
            };
            self.publish_behind(place, next, scope);
        }
        true
    }
}

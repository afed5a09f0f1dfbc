//! A scan in which nothing is new: the slave is in gear, its master goes on as it did, and the set-point is the law.
//!
//! It is what [`follow`](super::follow) does in such a scan and no more: where anything is not as it was, that is left to it, and
//! nothing has changed yet. So a slave in gear costs little more than an axis in a move, and every bit is the same.

use super::super::{Axis, Calm, Motion};
use super::Seen;
use super::follow::{self, LONGEST};
use super::view::{Course, Kind, Source};
use crate::{AxisId, OnLimit, Scope, ValueSource};
use standstill_planner::{Planner, Setpoint};

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
        self.note_source();
    }

    /// Before its step, if some slave may follow it: notes where it is.
    #[inline(always)]
    pub(crate) fn note_before(&mut self, scan: u64) {
        if !self.is_followed {
            return;
        }
        if self.modulo.is_none() {
            self.was.place.position = self.setpoint.position;
            self.was.at = self.setpoint;
            self.was.moved = self.coordinates_moved(scan);
        } else {
            self.was = self.seen_before(scan);
        }
        if !self.is_bound {
            self.note_source();
        }
    }

    /// After its step: where it was before that, as noted.
    pub(crate) fn was(&self) -> Seen {
        self.was
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
            Motion::Geared => {
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
            && master.coordinates_moved(scope.scan) == 0.0;
        let Some(anchor) = coupling.anchor.as_ref().filter(|_| goes_on) else {
            return false;
        };
        let place = gear.slave_soon(anchor, master.place());
        let at = &master.setpoint;
        let next = Setpoint {
            position: place.position,
            velocity: gear.derivative(at.velocity),
            acceleration: gear.derivative(at.acceleration),
            jerk: gear.derivative(at.jerk),
            snap: gear.derivative(at.snap),
        };
        if follow::beyond_limits(&next, &coupling.limits).is_some() {
            return false;
        }
        known.elapsed = elapsed;
        self.source = Source::Gear;
        let is_usual = self.modulo.is_none() && next.is_finite() && {
            self.steps_within(&next, &self.config.limits, LONGEST, 0.0)
        };
        if is_usual {
            self.publish(next);
        } else {
            self.publish_behind(place, next, scope);
        }
        true
    }
}

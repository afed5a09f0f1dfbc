//! Software limits: a motion that would end outside is refused, a running motion stops inside.
//!
//! A command to a position outside is refused. So is an endless motion outwards from an axis at or beyond a limit.
//! Other motions that may leave the limits are watched: endless motions, ramps to rest that end outside, and moves
//! that brake too late and turn back outside. A watched motion ends in ErrorStop in the last scan in which the stop
//! dynamics can keep it inside. A stop that only rounding takes beyond a limit ends on the limit. An axis that is
//! outside after a push or a shift of coordinates may move to any position inside.

use super::commands::{Entry, Watch};
use super::run::RESOLUTION;
use super::superimposed::Layer;
use super::{Axis, Motion};
use crate::ErrorId;
use standstill_planner::{Limits, Plan, Planner, Setpoint};

impl<P: Planner> Axis<P> {
    /// `target` (u), if a move may end there.
    pub(super) fn allowed(&self, target: f64) -> Result<f64, ErrorId> {
        match self.parameters.software_limits {
            Some((min, max)) if target < min || target > max => Err(ErrorId::TargetOutsideSoftwareLimits),
            _ => Ok(target),
        }
    }

    /// Refuses an endless motion from `here` (u) with `velocity` (u/s) that leads further outside.
    pub(super) fn not_outward(&self, here: f64, velocity: f64) -> Result<(), ErrorId> {
        match self.parameters.software_limits {
            Some((min, max)) if (velocity > 0.0 && here >= max) || (velocity < 0.0 && here <= min) => {
                Err(ErrorId::OutwardFromSoftwareLimit)
            }
            _ => Ok(()),
        }
    }

    /// The software limit that `position` (u) is at or beyond: the upper one, else the lower one.
    pub(super) fn broken_software_limit(&self, position: f64) -> f64 {
        match self.parameters.software_limits {
            Some((_, max)) if position >= max => max,
            Some((min, _)) => min,
            None => f64::NAN,
        }
    }

    /// Whether the motion of `entry` in progress, together with the superimposed motion, may leave the software
    /// limits. Cost: at most one ramp, or a check of each piece of both.
    pub(super) fn needs_watching(&self, entry: &Entry) -> bool {
        match (self.parameters.software_limits, self.mover.layer()) {
            (Some(limits), None) => self.may_leave(entry, limits),
            (Some(limits), Some(layer)) => match entry.work.manner().watch {
                Watch::Always => true,
                Watch::Never => false,
                Watch::Curve | Watch::Ramp | Watch::Way | Watch::Torque => self.sum_leaves(layer, limits),
            },
            (None, _) => false,
        }
    }

    /// The superimposed motion or a software limit has changed: checks again whether the motion may leave the limits.
    pub(super) fn watch_anew(&mut self) {
        let is_watched = match (self.owner, self.mover.layer(), self.parameters.software_limits) {
            (Some(owner), ..) => self.needs_watching(&owner),
            (None, Some(layer), Some(limits)) => self.sum_leaves(layer, limits),
            (None, ..) => false,
        };
        self.mover.watch(is_watched);
    }

    /// Whether the sum of the owner's motion and the superimposed motion, as far as they move, turns or ends outside.
    /// Cost: a check of each of their pieces.
    #[inline(never)]
    fn sum_leaves(&self, layer: &Layer<P::Plan>, (min, max): (f64, f64)) -> bool {
        let places = [layer.base(), layer.added()].map(|part| self.still(part.position));
        let [Some(base), Some(added)] = places else {
            return true;
        };
        let base = self.mover.plan().unwrap_or((&base, 0));
        let added = layer.motion().plan().unwrap_or((&added, 0));
        let end = |(plan, _): (&P::Plan, u64)| plan.end().position;
        let (taken, rest) = (layer.taken(), end(base) + end(added) - layer.taken());
        let within = RESOLUTION * (end(base).abs() + end(added).abs());
        let range = Some((min + taken, max + taken));
        rest < min - within || rest > max + within || !self.planner.fits(base, added, &Limits::NONE, range)
    }

    #[inline(never)]
    fn may_leave(&self, entry: &Entry, (min, max): (f64, f64)) -> bool {
        let outside = |rest: f64| rest < min || rest > max;
        match entry.work.manner().watch {
            // A paused motion already brakes as hard as it would at a limit.
            _ if entry.paused => outside(self.mover.end_of_plan()),
            Watch::Always => true,
            // A curve was checked when it was planned, but coordinates may have been shifted since.
            Watch::Curve => outside(self.mover.end_of_plan()) || self.turns_outside(),
            Watch::Ramp => outside(self.mover.end_of_plan()),
            // From rest the axis moves straight to the target; from motion it may overshoot it.
            Watch::Way => {
                outside(self.mover.end_of_plan())
                    || (!self.mover.setpoint().is_at_rest()
                        && (outside(self.rest(self.mover.setpoint(), &entry.limits)) || self.turns_outside()))
            }
            Watch::Torque | Watch::Never => false,
        }
    }

    /// Whether this is the last scan in which the stop dynamics can keep a motion inside that would leave the limits.
    /// `next` is the set-point about to be published. Cost: at most two ramps.
    #[inline(never)]
    pub(super) fn would_leave(&self, next: Setpoint) -> bool {
        let Some((min, max)) = self.parameters.software_limits else {
            return false;
        };
        // Only a stop further outside than the present position counts. An axis outside may come in, and in the
        // middle of a reversal a stop turns back. A stop that would end on a limit is still in time in the next scan.
        let leaves = |rest: f64| {
            let within = RESOLUTION * (rest.abs() + next.position.abs());
            (rest > max + within && rest > next.position) || (rest < min - within && rest < next.position)
        };
        // Between two scans the motion may leave the limits and turn; a stop from there leads inside again.
        let outside = |position: f64| position < min || position > max;
        let comes_out = outside(next.position) && !outside(self.mover.setpoint().position);
        let manner = match (self.mover.motion(), &self.owner) {
            (Motion::Run { .. } | Motion::Geared | Motion::Closing { .. }, Some(owner)) => {
                Some(owner.work.manner())
            }
            // If the owner is at rest, or there is none, the superimposed motion moves alone.
            (Motion::Hold, _) if self.mover.layer().is_some() => None,
            (Motion::Run { .. } | Motion::Geared | Motion::Closing { .. }, None)
            | (Motion::Hold | Motion::Follow | Motion::Torque { .. }, _) => return false,
        };
        let leaving = match manner.map(|manner| manner.watch) {
            Some(Watch::Never) => return false,
            Some(Watch::Always) => true,
            // Both motions were checked when the later one of them began.
            _ if self.mover.layer().is_some() => self.mover.is_watched(),
            Some(Watch::Ramp | Watch::Torque) => leaves(self.mover.end_of_plan()),
            Some(Watch::Curve | Watch::Way) | None if !self.mover.is_watched() => return false,
            Some(Watch::Curve) => leaves(self.mover.end_of_plan()) || self.turns_outside(),
            // It turns back where it stops, or the position of its end was shifted since it began.
            Some(Watch::Way) | None => {
                leaves(self.mover.end_of_plan())
                    || self
                        .owner
                        .is_some_and(|owner| leaves(self.rest(&next, &owner.limits)))
                    || self.turns_outside()
            }
        };
        comes_out || (leaving && leaves(self.rest(&next, &self.stop_limits())))
    }

    /// Whether, under a torque, a stop that began a scan later would end outside and further outside than the axis
    /// is. The next scan is estimated from the last two: the same travel, plus its growth if it grew outwards. Cost:
    /// at most one ramp.
    #[cold]
    #[inline(never)]
    pub(super) fn torque_would_leave(&self) -> bool {
        let (Some((min, max)), Ok(velocity)) = (self.parameters.software_limits, self.actual_velocity())
        else {
            return false;
        };
        let gained = velocity - self.velocity_before();
        let velocity = if gained * velocity > 0.0 {
            velocity + gained
        } else {
            velocity
        };
        let position = self.feedback.position() + velocity * self.planner.cycle();
        let next = Setpoint::at_velocity(position, velocity);
        let rest = self.rest(&next, &self.stop_limits());
        (velocity > 0.0 && !(rest <= max)) || (velocity < 0.0 && !(rest >= min))
    }

    /// `ramp`, which leads to rest. If only rounding takes it beyond a software limit, it is shifted to end on the
    /// limit.
    pub(super) fn onto_limit(&self, mut ramp: P::Plan) -> P::Plan {
        let Some((min, max)) = self.parameters.software_limits else {
            return ramp;
        };
        let (start, end) = (ramp.at(0).position, ramp.end().position);
        let beyond = end - min.max(end.min(max));
        if beyond != 0.0 && beyond.abs() <= RESOLUTION * (start.abs() + end.abs()) {
            ramp.shift(-beyond);
        }
        ramp
    }

    /// The rest position of a ramp from `state` (u): within `limits`, or higher ones, as the axis would stop.
    fn rest(&self, state: &Setpoint, limits: &Limits) -> f64 {
        let (before, axis) = (self.mover.in_force(), &self.hardest_limits());
        match self.stopped_inside(state, &mut { *limits }, before, axis) {
            Ok(ramp) => ramp.end().position,
            Err(_) => state.position,
        }
    }

    /// Whether the rest of the running plan turns outside the software limits, or leaves them as a curve. Cost: a
    /// check of each of its pieces.
    #[inline(never)]
    fn turns_outside(&self) -> bool {
        let (Motion::Run { plan, elapsed, .. }, Some(range)) =
            (self.mover.motion(), self.parameters.software_limits)
        else {
            return false;
        };
        !self.turns_within((plan, *elapsed), range)
    }

    /// Whether the rest of a plan turns only within `range` (u). Cost: a check of each of its pieces.
    pub(super) fn turns_within(&self, rest: (&P::Plan, u64), range: (f64, f64)) -> bool {
        // The sum with a motion at rest.
        let still = self.still(0.0);
        still.is_none_or(|still| self.planner.fits(rest, (&still, 0), &Limits::NONE, Some(range)))
    }

    /// A plan at rest at `position` (u).
    fn still(&self, position: f64) -> Option<P::Plan> {
        let (still, limits) = (Setpoint::at_rest(position), &self.config.limits);
        self.planner.ramp_to(&still, 0.0, limits, limits).ok()
    }
}

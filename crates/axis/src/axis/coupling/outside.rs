//! A master whose commands lead a slave outside its software limits. This is reported at once, not only when the
//! slave stops.

use super::super::{Axis, Motion};
use super::view::{View, way_to_rest};
use super::{Coupling, OnCam};
use crate::{Event, Scope};
use standstill_planner::{Leads, Plan, Planner};

/// The distance (in the unit of the `leads`) from the end of this scan until all masters have come to rest. `None`
/// while it is not known or one of them is endless.
pub(super) fn way_left<Q: Plan>(view: &View<'_, Q>, leads: &Leads<'_, Q>) -> Option<f64> {
    // If the plan is not late, the end of this scan is one scan after its beginning in the leads.
    way_to_rest(leads, u64::from(!view.future.is_late()))
}

impl Coupling {
    /// The place of the law (u) when all masters have come to rest. `None` while it is not known or one
    /// of them is endless.
    fn rest_of_law<Q: Plan>(&self, view: &View<'_, Q>) -> Option<f64> {
        let anchor = self.anchor?;
        let (now, _) = self.law(&anchor, &view.seen());
        Some(now.position + way_left(view, &self.leads(&view.future)?)?)
    }
}

impl<P: Planner> Axis<P> {
    /// Whether it may leave its software limits. It can't on a plan that counts from the position `from`, comes to
    /// rest inside, and does not reverse outside.
    pub(super) fn may_leave_on_way(&self, from: Option<f64>) -> bool {
        let Some((min, max)) = self.parameters.software_limits else {
            return false;
        };
        let (Some(from), Motion::Closing { plan, scans, .. }) = (from, self.mover.motion()) else {
            return true;
        };
        let range = (min - from, max - from);
        let end = plan.at(*scans).position;
        end < range.0 || end > range.1 || !self.turns_within((plan, 0), range)
    }

    /// Records that the masters lead the slave outside its software limits, once for each end position. The law is
    /// known once the slave was in gear, or from the sync positions of MC_GearInPos. A cam is known once it has a
    /// place.
    ///
    /// Cost, if a master got another plan: one evaluation of the law or the cam, and two of each plan.
    pub(super) fn tell_outside(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        if self.parameters.software_limits.is_none() {
            return;
        }
        let rest = match &self.follower.coupling {
            Some(coupling) => coupling.rest_of_law(view),
            None => self.rest_of_cam(view, &scope.cams),
        };
        let outside = rest.filter(|rest| self.allowed(*rest).is_err());
        let told = self
            .follower
            .coupling
            .as_mut()
            .map(|coupling| &mut coupling.leads_outside);
        let Some(told) = told.or_else(|| self.follower.on_cam.as_mut().map(OnCam::leads_outside)) else {
            return;
        };
        let was = core::mem::replace(told, outside);
        if let Some(position) = outside.filter(|_| was != outside) {
            let limit = self.broken_software_limit(position);
            self.record(Event::LeadsOutside { position, limit }, scope);
        }
    }
}

//! A master that is commanded to where its slave must not go: told at once, not only when the slave stops inside.

use super::super::Axis;
use super::Coupling;
use super::view::{View, way_to_rest};
use crate::{Event, Scope};
use standstill_planner::{Plan, Planner};

impl Coupling {
    /// Where the law is (u) when all masters have come to rest; `None` while that is not known, or one of them goes on.
    fn rest_of_law<Q: Plan>(&self, view: &View<'_, Q>) -> Option<f64> {
        let anchor = self.anchor?;
        let (now, _) = self.law(&anchor, &view.seen());
        // At the end of this scan a plan that is not late is one scan further than at its beginning.
        let scan = u64::from(!view.future.is_late());
        let way = way_to_rest(&self.leads(&view.future)?, scan)?;
        Some(now.position + way)
    }
}

impl<P: Planner> Axis<P> {
    /// Records that the masters lead out of the software limits of this slave, once for each place they lead to. The law is known
    /// once it was in gear, or from the sync positions of MC_GearInPos.
    ///
    /// Cost: where a master got another plan, one evaluation of the law and two of each plan.
    pub(super) fn tell_outside(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        if self.parameters.software_limits.is_none() {
            return;
        }
        let rest = self
            .coupling
            .as_ref()
            .and_then(|coupling| coupling.rest_of_law(view));
        let outside = rest.filter(|rest| self.allowed(*rest).is_err());
        let Some(coupling) = &mut self.coupling else {
            return;
        };
        let was = core::mem::replace(&mut coupling.leads_outside, outside);
        if let Some(position) = outside.filter(|_| was != outside) {
            let limit = self.broken_software_limit(position);
            self.record(Event::LeadsOutside { position, limit }, scope);
        }
    }
}

//! The values at the pins of MC_MoveSuperimposed: as a new command, and changed while it runs.

use super::soonest::Search;
use super::{Added, Adds, Layer, Progress};
use crate::axis::Axis;
use crate::axis::dynamics::as_given;
use crate::{CommandId, ErrorId, Scope, Superimpose};
use standstill_planner::Planner;

impl<P: Planner> Axis<P> {
    /// ContinuousUpdate of MC_MoveSuperimposed: command `id` continues from its present state with other
    /// values. Its distance counts from where it did (R13). No effect on a command that has ended.
    ///
    /// Cost: that of a new command.
    ///
    /// # Errors
    /// The error that a new command with these values would show. It is recorded, and the command
    /// continues unchanged.
    pub fn update_superimposed(
        &mut self,
        id: CommandId,
        request: &Superimpose,
        scope: &mut Scope<'_>,
    ) -> Result<(), ErrorId> {
        let Some(mut layer) = self.mover.layer().copied() else {
            return Ok(());
        };
        let Some(Added {
            adds: Adds::Distance { origin, .. },
            ..
        }) = layer.command.filter(|command| command.id == id)
        else {
            return Ok(());
        };
        let command = self.added(id, origin, &layer, request, scope)?;
        let refuse = |error| self.refuse("Distance", request.distance, f64::NAN, error, scope);
        if self.follows() {
            self.propose_alone(&layer, &command).map_err(refuse)?;
            self.await_room(layer, command);
            return Ok(());
        }
        let mut search = Search::NEW;
        let proposed = self.propose(&layer, &command, &mut search).map_err(refuse)?;
        layer.command = Some(command);
        layer.try_soon();
        layer.search = search;
        self.end_routine();
        self.mover.lay(layer);
        self.add(proposed, scope);
        Ok(())
    }

    /// A command on `layer` with a distance that counts from `origin` (u), if its values and its end are valid.
    pub(super) fn added(
        &self,
        id: CommandId,
        origin: f64,
        layer: &Layer<P::Plan>,
        request: &Superimpose,
        scope: &mut Scope<'_>,
    ) -> Result<Added, ErrorId> {
        let asked = as_given(
            &request.dynamics,
            &self.superimposed_limits(&request.dynamics, scope)?,
        );
        let distance = request.distance;
        let target = origin + distance;
        let end = self.base_end(layer) + (target - layer.taken);
        // NaN where the owner has no end.
        if !target.is_finite() || end.is_infinite() {
            let error = ErrorId::PositionInvalid;
            return Err(self.refuse("Distance", distance, f64::NAN, error, scope));
        }
        self.allowed(end).map_err(|error| {
            let limit = self.broken_software_limit(end);
            self.refuse("Distance", distance, limit, error, scope)
        })?;
        let limits = self.factors.of(&asked, &self.parameters.limits);
        self.record_slowed_pins("VelocityDiff", &limits, scope);
        Ok(Added {
            id,
            instance: scope.instance,
            adds: Adds::Distance {
                distance,
                origin,
                target,
            },
            limits: self.slowed(&limits),
            asked,
            halting: self.factors.halt(),
            progress: Progress::Waits,
            orphaned: false,
        })
    }
}

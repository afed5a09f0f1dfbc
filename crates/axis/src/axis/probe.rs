//! Touch probes: the position at an edge of a probe's input.
//!
//! The drive latches the position at the first edge after it was armed, between scans. The next latch decides whether
//! that edge counts. An edge outside the window, if there is one, does not count, and the probe is armed again. To
//! arm a drive again takes one scan without a request, so edges in that scan are not seen.
//!
//! Source: PLCopen Motion Control Part 1, MC_TouchProbe and MC_AbortTrigger; V23, T39 g.

use super::Axis;
use crate::{CommandId, DrivePosition, Edge, ErrorId, Fate, PROBES, Raw, Scope, Trigger};
use standstill_planner::Planner;

/// MC_TouchProbe: values at the pins, unchecked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TouchProbe {
    /// The probe and its edge.
    pub trigger: Raw<Trigger>,
    /// First and last position (u) at which an edge counts, both included; none for everywhere.
    pub window: Option<(f64, f64)>,
    /// The earlier probing of the same instance; this one replaces it if it still waits (V23).
    pub replaces: Option<CommandId>,
}

/// A command that waits for an edge.
#[derive(Clone, Copy, Debug)]
struct Waiting {
    id: CommandId,
    edge: Edge,
    window: Option<(f64, f64)>,
    /// Whether the drive was requested to latch for it.
    armed: bool,
}

/// The probes of an axis.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Probes {
    waiting: [Option<Waiting>; PROBES],
    /// The last position each probe recorded (u), and for which command.
    recorded: [Option<(CommandId, f64)>; PROBES],
}

impl Probes {
    pub fn is_waiting(&self, id: CommandId) -> bool {
        self.waiting.iter().flatten().any(|waiting| waiting.id == id)
    }
}

/// Whether `position` (u) lies in a checked window.
fn is_inside((first, last): (f64, f64), position: f64) -> bool {
    if first <= last {
        first <= position && position <= last
    } else {
        first <= position || position <= last
    }
}

impl<P: Planner> Axis<P> {
    /// MC_TouchProbe: records the position at the next edge that counts, in every state.
    ///
    /// # Errors
    /// The [`ErrorId`] the block shows: an undefined trigger, an invalid window, or a probe that another
    /// command waits for. Nothing changes then.
    pub fn touch_probe(&mut self, request: &TouchProbe, scope: &mut Scope<'_>) -> Result<CommandId, ErrorId> {
        let (probe, edge) = self.trigger(request.trigger, scope)?;
        if let Some(window) = request.window {
            self.check_window(window, scope)?;
        }
        let before = self.beside.probes.waiting.get(probe).copied().flatten();
        if before.is_some_and(|before| Some(before.id) != request.replaces) {
            let number = f64::from(request.trigger.number());
            let error = ErrorId::TriggerTaken;
            return Err(self.refuse("TriggerInput", number, f64::NAN, error, scope));
        }
        if let Some(id) = request.replaces {
            self.forget_probe(id);
        }
        let id = self.new_id();
        // A drive that already waits for this edge continues to wait, so no edge is missed.
        let armed = before.is_some_and(|before| before.armed && before.edge == edge);
        if let Some(slot) = self.beside.probes.waiting.get_mut(probe) {
            *slot = Some(Waiting {
                id,
                edge,
                window: request.window,
                armed,
            });
        }
        if armed {
            self.order_probe(probe, Some(edge));
        } else {
            self.arm_probe(probe);
        }
        Ok(id)
    }

    /// MC_AbortTrigger: every command that waits for an edge of this probe, either edge, ends.
    ///
    /// # Errors
    /// [`ErrorId::TriggerInvalid`].
    pub fn abort_trigger(
        &mut self,
        trigger: Raw<Trigger>,
        scope: &mut Scope<'_>,
    ) -> Result<CommandId, ErrorId> {
        let (probe, _) = self.trigger(trigger, scope)?;
        if let Some(waiting) = self.end_probing(probe) {
            self.decide(waiting.id, Fate::Aborted);
        }
        Ok(self.done_at_once())
    }

    /// The position that command `id` recorded (u), in the coordinates of that time; each probe remembers
    /// the last one.
    pub fn recorded_position(&self, id: CommandId) -> Option<f64> {
        let mut recorded = self.beside.probes.recorded.iter().flatten();
        recorded.find(|(of, _)| *of == id).map(|(_, position)| *position)
    }

    /// Removes the waiting command `id` without a result.
    pub fn forget_probe(&mut self, id: CommandId) {
        for probe in 0..PROBES {
            let waiting = self.beside.probes.waiting.get(probe).copied().flatten();
            if waiting.is_some_and(|waiting| waiting.id == id) {
                self.end_probing(probe);
            }
        }
    }

    /// Takes the drive's report of this scan, before the feedback: a latched position is still in the old
    /// coordinates.
    #[inline]
    pub fn follow_report(&mut self) {
        if !self.beside.report.is_finite() {
            // The next latch is a full one.
            self.end_routine();
        }
        if self.beside.probes.waiting.iter().any(Option::is_some) {
            self.follow_probes();
        }
    }

    #[cold]
    #[inline(never)]
    fn follow_probes(&mut self) {
        for probe in 0..PROBES {
            let waiting = self.beside.probes.waiting.get(probe).copied().flatten();
            let told = self.beside.report.probes.get(probe).copied();
            let (Some(waiting), Some(told)) = (waiting, told) else {
                continue;
            };
            if !waiting.armed {
                self.arm_probe(probe);
            } else if let Some(latched) = told.latched.filter(|_| told.armed) {
                let position = self.place_of(latched);
                self.end_probing(probe);
                // A value that is not a number does not count. The axis fails because of it, and the
                // probe waits for the next.
                if latched.is_finite() && waiting.window.is_none_or(|window| is_inside(window, position)) {
                    if let Some(slot) = self.beside.probes.recorded.get_mut(probe) {
                        *slot = Some((waiting.id, position));
                    }
                    self.decide(waiting.id, Fate::Done);
                } else if let Some(slot) = self.beside.probes.waiting.get_mut(probe) {
                    *slot = Some(Waiting {
                        armed: false,
                        ..waiting
                    });
                }
            }
        }
    }

    /// Requests the drive to latch, as soon as it has cleared its earlier latched position.
    fn arm_probe(&mut self, probe: usize) {
        let told = self.beside.report.probes.get(probe);
        let free = told.is_some_and(|told| !told.armed);
        let Some(Some(waiting)) = self.beside.probes.waiting.get_mut(probe) else {
            return;
        };
        waiting.armed = free;
        let edge = free.then_some(waiting.edge);
        self.order_probe(probe, edge);
    }

    fn order_probe(&mut self, probe: usize, edge: Option<Edge>) {
        if let Some(order) = self.beside.order.probes.get_mut(probe) {
            *order = edge;
        }
    }

    fn end_probing(&mut self, probe: usize) -> Option<Waiting> {
        self.order_probe(probe, None);
        self.beside.probes.waiting.get_mut(probe)?.take()
    }

    fn trigger(&self, trigger: Raw<Trigger>, scope: &mut Scope<'_>) -> Result<(usize, Edge), ErrorId> {
        let trigger = self.element("TriggerInput", trigger, ErrorId::TriggerInvalid, scope)?;
        Ok(trigger.source())
    }

    fn check_window(&self, (first, last): (f64, f64), scope: &mut Scope<'_>) -> Result<(), ErrorId> {
        for (pin, position) in [("FirstPosition", first), ("LastPosition", last)] {
            self.finite(pin, position, scope)?;
            self.in_first_turn(pin, position, scope)?;
        }
        // Only on a modulo axis may a window cross the end of the turn.
        if first > last && self.modulo.is_none() {
            let error = ErrorId::WindowInvalid;
            return Err(self.refuse("LastPosition", last, first, error, scope));
        }
        Ok(())
    }

    /// A position at the drive as programs see it (u).
    pub(super) fn place_of(&self, latched: DrivePosition) -> f64 {
        match (latched, &self.modulo) {
            (position, Some(modulo)) => modulo.place_of(&self.config, position, self.frame.shift()).1,
            (DrivePosition::Units(units), None) => units,
            (DrivePosition::Increments(increments), None) => self.position_at_increment(increments),
        }
    }
}

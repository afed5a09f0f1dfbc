//! A superimposed distance from rest, on top of an owner in motion. Of all starts, now or later, as
//! commanded or slower, it takes the one that ends first.
//!
//! Usually a short piece of the owner's plan prevents the commanded motion from starting at once. So each
//! pace is tried from now and from each switch of that plan. A slower motion that starts now may end even
//! sooner: at one of the next switches it is tried again as commanded.

use super::plan::{PROPOSALS, Proposal, Room, limits_of, slower};
use super::{Added, Adds, Layer};
use crate::ErrorId;
use crate::axis::commands::refusal;
use crate::axis::{Axis, Motion};
use standstill_planner::{Limits, Plan, Planner};

/// Additional paces: the same path in longer time ..
const BETWEEN: [f64; 3] = [0.875, 0.625, 0.375];

/// .. and only the velocity lowered.
const VELOCITIES: [f64; 6] = [0.8, 0.6, 0.45, 0.3, 0.2, 0.1];

/// All of them.
const PACES: usize = PROPOSALS + BETWEEN.len() + VELOCITIES.len();

/// Switches of the owner's plan that are tried. Only a curve has more, and no motion can be added to a
/// curve.
const SWITCHES: usize = 16;

/// Slower motions that are tried before the commanded one ..
const BEFORE: usize = 3;

/// .. and switches at which the commanded one may begin.
const AFTER: usize = 6;

/// The owner's plan and the limits of the sum.
pub(super) struct Below<'a, Plan> {
    pub rest: (&'a Plan, u64),
    /// Limits of the axis.
    pub axis: &'a Limits,
    /// The software limits in the sum of the plans' own positions.
    pub range: Option<(f64, f64)>,
}

/// A motion, and the scans after which it starts.
struct Start<Plan> {
    proposal: Proposal<Plan>,
    wait: u64,
}

impl<P: Plan> Start<P> {
    /// Scans from now to its end.
    fn end(&self) -> u64 {
        self.wait.saturating_add(self.proposal.plan.scans().into())
    }
}

/// The limits of pace `index`; `None` if there is no room for it.
fn pace(index: usize, asked: &Limits, room: &Room) -> Option<Limits> {
    if index < PROPOSALS {
        return limits_of(index, asked, room);
    }
    let index = index - PROPOSALS;
    if let Some(rate) = BETWEEN.get(index) {
        return Some(slower(asked, *rate));
    }
    let rate = VELOCITIES.get(index.checked_sub(BETWEEN.len())?)?;
    Some(Limits {
        velocity: asked.velocity * rate,
        ..*asked
    })
}

impl<P: Planner> Axis<P> {
    /// The motion that starts now for `command`, which begins at rest; `Ok(None)` if a later start ends
    /// sooner, or nothing fits.
    ///
    /// Cost: at most 32 plans from rest, two for each pace; 18 from a moving state, [`BEFORE`] times
    /// [`AFTER`]; and a check of the sum of both plans for each pace and switch, and for each of the 18.
    ///
    /// # Errors
    /// As [`Axis::propose`].
    pub(super) fn soonest(
        &self,
        layer: &Layer<P::Plan>,
        command: &Added,
        room: &Room,
        below: &Below<'_, P::Plan>,
    ) -> Result<Option<Proposal<P::Plan>>, ErrorId> {
        let mut best: Option<Start<P::Plan>> = None;
        for index in 0..PACES {
            let Some(proposal) = self.with_pace(index, layer, command, room)? else {
                continue;
            };
            let scans = u64::from(proposal.plan.scans());
            let most = best.as_ref().map_or(u64::MAX, Start::end);
            if let Some(wait) = self.first_wait(&proposal.plan, most.saturating_sub(scans), below) {
                best = Some(Start { proposal, wait });
            }
            if best
                .as_ref()
                .is_some_and(|best| best.wait == 0 && !best.proposal.lowered)
            {
                break;
            }
        }
        let Some(best) = best else { return Ok(None) };
        if !best.proposal.lowered && best.wait == 0 {
            return Ok(Some(best.proposal));
        }
        self.before(best, layer, command, room, below)
    }

    /// The motion of a pace; `Ok(None)` if the axis alone could not make it.
    fn with_pace(
        &self,
        index: usize,
        layer: &Layer<P::Plan>,
        command: &Added,
        room: &Room,
    ) -> Result<Option<Proposal<P::Plan>>, ErrorId> {
        let (Some(limits), Adds::Distance { target, .. }) =
            (pace(index, &command.limits, room), command.adds)
        else {
            return Ok(None);
        };
        let planned = self
            .planner
            .move_to(self.config.profile, &layer.added, target, &limits, &limits);
        let plan = match planned {
            Ok(plan) => plan,
            Err(error) if index == 0 => return Err(refusal(error)),
            Err(_) => return Ok(None),
        };
        if let Some(error) = self.barred((&plan, 0), &limits, &limits) {
            return Err(error);
        }
        let lowered = index > 0;
        Ok((!self.exceeds(&Motion::along(plan))).then_some(Proposal {
            plan,
            limits,
            lowered,
        }))
    }

    /// The first wait below `most` scans, to now or to a switch of the owner's plan, after which `plan` fits from its start.
    fn first_wait(&self, plan: &P::Plan, most: u64, below: &Below<'_, P::Plan>) -> Option<u64> {
        let (owner, now) = below.rest;
        let mut scan = now;
        for _ in 0..=SWITCHES {
            let wait = scan - now;
            if wait >= most {
                return None;
            }
            if self.fits_after(plan, wait, below) {
                return Some(wait);
            }
            let next = self.planner.next_switch((owner, scan));
            if next <= scan {
                return None;
            }
            scan = next;
        }
        None
    }

    fn fits_after(&self, plan: &P::Plan, wait: u64, below: &Below<'_, P::Plan>) -> bool {
        let (owner, now) = below.rest;
        let later = (owner, now.saturating_add(wait));
        self.planner.fits(later, (plan, 0), below.axis, below.range)
    }

    /// A slower motion that starts now, speeds up at a switch and ends before `best`; otherwise `best`,
    /// if that starts now.
    fn before(
        &self,
        best: Start<P::Plan>,
        layer: &Layer<P::Plan>,
        command: &Added,
        room: &Room,
        below: &Below<'_, P::Plan>,
    ) -> Result<Option<Proposal<P::Plan>>, ErrorId> {
        let Adds::Distance { target, .. } = command.adds else {
            return Ok(None);
        };
        let mut least = best.end();
        let mut soonest = (best.wait == 0).then_some(best.proposal);
        let (owner, now) = below.rest;
        let mut tried = 0;
        for index in 1..PACES {
            let Some(slow) = self.with_pace(index, layer, command, room)? else {
                continue;
            };
            if !self.fits_after(&slow.plan, 0, below) {
                continue;
            }
            let mut scan = now;
            let mut end = None;
            for _ in 0..AFTER {
                let next = self.planner.next_switch((owner, scan));
                let wait = next - now;
                if next <= scan || wait >= least.min(slow.plan.scans().into()) {
                    break;
                }
                scan = next;
                let there = slow.plan.at(wait);
                let (profile, asked) = (self.config.profile, &command.limits);
                let fast = self.planner.move_to(profile, &there, target, asked, &slow.limits);
                if let Ok(fast) = fast
                    && self.fits_after(&fast, wait, below)
                {
                    end = Some(wait.saturating_add(fast.scans().into()));
                    break;
                }
            }
            if let Some(end) = end.filter(|end| *end < least) {
                (least, soonest) = (end, Some(slow));
            }
            tried += 1;
            if tried == BEFORE {
                break;
            }
        }
        Ok(soonest)
    }
}

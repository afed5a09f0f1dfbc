//! Blending: how fast a positioning command passes its end when a blended one waits behind it.
//!
//! Source: PLCopen Motion Control Part 1, section on aborting and buffered commands; rules B1 to B17. What the
//! standard leaves open is told in `docs/buffering.md`. The maths is the planner's.

use super::accept::REST;
use super::power::Reaction;
use super::queue::{Entry, Work};
use super::{Axis, Motion};
use crate::{BufferMode, ErrorId, Event, Fate, Goal, Log, QUEUE_MAX};
use standstill_planner::{Limits, Passage, Plan, Planner};

/// A command of a chain: the owner to be, or one that waits.
#[derive(Clone, Copy)]
struct Leg<'a> {
    entry: &'a Entry,
    /// How far it leads (u), with its direction as the sign; `None` if it leads nowhere.
    way: Option<f64>,
}

impl<P: Planner> Axis<P> {
    /// A command has been queued with `mode`: if it is to blend, the owner may have to pass its end at
    /// another speed, and is planned anew from the last set-point (B15). Failing that, its plan stays.
    pub(super) fn arm(&mut self, mode: BufferMode, scan: u64, log: &mut Log) {
        if matches!(mode, BufferMode::Aborting | BufferMode::Buffered) {
            return;
        }
        let Some(mut owner) = self.owner else { return };
        let passage = self.passage(&owner);
        let Some(end) = owner.end else { return };
        if passage == owner.passage || !matches!(self.motion, Motion::Run { .. }) {
            return;
        }
        owner.passage = passage;
        if let Some(plan) = self.blended(&owner, end, &self.before) {
            self.in_force = raised(&owner.limits, &plan);
            let event = Event::Planned {
                goal: Goal::Passing {
                    position: end,
                    velocity: plan.at(u64::from(plan.scans())).velocity,
                },
                scans: plan.scans(),
            };
            self.record(event, self.owner_source(scan), log);
            self.motion = Motion::Run { plan, elapsed: 0 };
            self.owner = Some(owner);
        }
    }

    /// The plan that passes `end` as `entry` is to; `None` if it is to come to rest there, or can't help it.
    pub(super) fn blended(&self, entry: &Entry, end: f64, before: &Limits) -> Option<P::Plan> {
        if entry.passage.wanted <= 0.0 {
            return None;
        }
        let planned = self
            .planner
            .blend(&self.setpoint, end, &entry.passage, &entry.limits, before);
        // What can't be planned blended is planned as a move to rest, whose error would be the same.
        planned
            .ok()
            .flatten()
            .filter(|plan| plan.at(u64::from(plan.scans())).velocity != 0.0)
    }

    /// Notes whose limits hold from now on, and which did for the motion taken over from.
    pub(super) fn take_over(&mut self, limits: Limits, motion: &Motion<P::Plan>) {
        self.before = if matches!(self.motion, Motion::Run { .. }) {
            self.in_force
        } else {
            limits
        };
        self.in_force = match motion {
            Motion::Run { plan, .. } => raised(&limits, plan),
            Motion::Follow | Motion::Hold => limits,
        };
    }

    /// The owner has passed its end in motion: Done, and the next takes over from the set-point (B2).
    pub(super) fn pass_on(&mut self, scan: u64, log: &mut Log) {
        let from = self.passed_end();
        self.end_owner(Fate::Done);
        self.hand_over(from, scan, log);
        if self.owner.is_none() {
            // All were checked when the owner was told to pass on.
            self.trip(ErrorId::PlanRefused, 0, Reaction::Ramp, scan, log);
        }
    }

    /// Where distances of the next command count from (u): the owner's end if it was passed in this scan,
    /// else the set position (B10).
    pub(super) fn passed_end(&self) -> f64 {
        let now = self.setpoint.position;
        match (&self.motion, &self.owner) {
            (Motion::Run { plan, elapsed }, Some(owner)) if *elapsed == u64::from(plan.scans()) => {
                owner.end.unwrap_or(now)
            }
            _ => now,
        }
    }

    /// How `first`, whose end is known, is to pass it, with the queue behind it: from the last to the first,
    /// because no command may begin faster than it can end.
    ///
    /// Cost: at most one ramp or root of ramps for each command that waits.
    pub(super) fn passage(&self, first: &Entry) -> Passage {
        const NONE: Option<Leg<'_>> = None;
        let mut legs = [NONE; QUEUE_MAX];
        let mut from = first.end;
        for (leg, entry) in legs.iter_mut().zip(self.queue.iter()) {
            let end = from.and_then(|from| entry.work.end(from));
            *leg = Some(Leg {
                entry,
                way: end
                    .zip(from)
                    .map(|(end, from)| end - from)
                    .filter(|way| way.is_finite() && end.is_some_and(|end| self.allowed(end).is_ok())),
            });
            from = end;
        }
        let mut passage = REST;
        let mut legs = legs.iter().flatten().rev().peekable();
        while let Some(next) = legs.next() {
            let leg = match legs.peek() {
                Some(leg) => **leg,
                None => Leg {
                    entry: first,
                    way: first.end.map(|end| end - self.setpoint.position),
                },
            };
            passage = self.between(&leg, next, &passage);
        }
        passage
    }

    /// How `leg` is to pass its end, if `next` passes its own as `after` says.
    fn between(&self, leg: &Leg<'_>, next: &Leg<'_>, after: &Passage) -> Passage {
        let (entry, mode) = (leg.entry, next.entry.mode);
        let direction = match (&entry.work, leg.way) {
            (Work::Position(_) | Work::Distance(_), Some(way)) if way != 0.0 => way.signum(),
            // Anything else comes to rest, or hands over with the velocity it has (B12).
            _ => return REST,
        };
        let limits = &next.entry.limits;
        // What is commanded next, and the speed it passes its end with; None if it has no end to overshoot.
        let (towards, velocity, exit) = match next.entry.work {
            Work::Position(_) | Work::Distance(_) => match next.way {
                Some(way) => (way, limits.velocity, Some(after.wanted)),
                None => return REST,
            },
            Work::Through { end_velocity, .. } => match next.way {
                Some(way) => {
                    let onwards = end_velocity * way >= 0.0;
                    (way, limits.velocity, onwards.then_some(end_velocity.abs()))
                }
                None => return REST,
            },
            Work::Velocity { velocity, along } => {
                let towards = if along { velocity * direction } else { velocity };
                (towards, velocity.abs(), None)
            }
            Work::Halt => (direction, 0.0, None),
            Work::Stop | Work::Home(_) => return REST,
        };
        // Reversed, or nowhere: at rest (B13). To the velocity 0 leads no direction.
        if towards * direction <= 0.0 && velocity != 0.0 {
            return REST;
        }
        let first = entry.limits.velocity;
        let wanted = match mode {
            BufferMode::Aborting | BufferMode::Buffered => 0.0,
            BufferMode::BlendingLow => first.min(velocity),
            BufferMode::BlendingPrevious => first,
            BufferMode::BlendingNext => velocity,
            BufferMode::BlendingHigh => first.max(velocity),
        };
        match exit {
            Some(exit) => {
                let most = self.planner.entry_speed(wanted, towards.abs(), exit, limits);
                Passage { wanted: most, most }
            }
            None => Passage {
                wanted,
                most: f64::INFINITY,
            },
        }
    }
}

/// `limits` with the velocity `plan` ends with, should it be larger (B3).
fn raised<P: Plan>(limits: &Limits, plan: &P) -> Limits {
    let end = plan.at(u64::from(plan.scans())).velocity.abs();
    Limits {
        velocity: limits.velocity.max(end),
        ..*limits
    }
}

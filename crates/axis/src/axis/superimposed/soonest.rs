//! A superimposed distance on top of an owner in motion. Of all tried motions, the one that ends first is used.
//!
//! While the owner uses a limit fully, even a slow added motion can't change in the same direction. So it has to
//! change when the owner leaves room for it. The limits for that are found by trying. Motions with some of the limits
//! lowered start now or, from rest, at a later switch of the owner's plan. A slower motion now may even end sooner,
//! because it continues faster at one of the next switches.
//!
//! The trials are spread over the scans. The best result is kept until a better one is found, and each scan tries
//! from the present state. All trials come from one fixed sequence, so the same program always finds the same motion.

use super::plan::{Proposal, Room, limits_of, slower};
use super::{Added, Adds, Layer};
use crate::ErrorId;
use crate::axis::commands::refusal;
use crate::axis::{Axis, Motion};
use standstill_planner::math::{max, min, sqrt};
use standstill_planner::{Limits, Plan, Planner, Setpoint};

/// Most plans in a scan in which the command or the owner's motion is new ..
const FIRST: u32 = 48;

/// .. and in a later one.
const LATER: u32 = 16;

/// Most sets of limits that are drawn in a scan. Many of them can't end sooner than the best known motion, and cost
/// no plan.
const DRAWS: u32 = 200;

/// After this number of scans without a better result, trying stops until just before the owner's next switch.
const FRUITLESS: u32 = 12;

/// The number of scans before a switch in which trying starts again.
const AHEAD: u64 = 3;

/// Most switches of the owner's plan that are considered. Only a curve has more, and no motion can be added to a
/// curve.
const SWITCHES: usize = 16;

/// The simple motions: the same travel at these rates ..
const PACES: [f64; 7] = [0.875, 0.75, 0.625, 0.5, 0.375, 0.25, 0.125];

/// .. and only the velocity lowered.
const VELOCITIES: [f64; 6] = [0.8, 0.6, 0.45, 0.3, 0.2, 0.1];

/// The share of the limits that are lowered, and the lowest factor.
const LOWERED: f64 = 0.3;
const LOWEST: f64 = 0.1;

/// The number of starts at later switches that are tried: after a motion in progress, after one at the velocity that
/// is always free, and after any other.
const AFTER_CURRENT: u32 = 1;
const AFTER_FREE: u32 = 4;
const AFTER_OTHER: u32 = 1;

/// The owner's plan and the limits of the sum.
pub(super) struct Below<'a, Plan> {
    pub rest: (&'a Plan, u64),
    /// Limits of the axis.
    pub axis: &'a Limits,
    /// The software limits in the sum of the plans' own positions.
    pub range: Option<(f64, f64)>,
}

/// The results for a command so far.
#[derive(Clone, Copy, Debug)]
pub(super) struct Search {
    /// The command or the owner's motion is new.
    fresh: bool,
    /// Scans to the end of the best known motion; the largest number if nothing fits.
    end: u64,
    /// The scans after which that motion starts, or continues within other limits.
    next: Option<(u64, Limits)>,
    /// Number of the last draw.
    drawn: u32,
    /// Scans without a better result, and the switches that were left then.
    fruitless: u32,
    switches: usize,
}

impl Search {
    pub const NEW: Self = Self {
        fresh: true,
        end: u64::MAX,
        next: None,
        drawn: 0,
        fruitless: 0,
        switches: 0,
    };

    /// Called at the end of a scan.
    pub fn pass(&mut self) {
        self.end = if self.end == u64::MAX {
            self.end
        } else {
            self.end.saturating_sub(1)
        };
        if let Some((wait, _)) = &mut self.next {
            *wait = wait.saturating_sub(1);
        }
    }

    /// Scans until another trial is useful; `None` if nothing will change. The owner's next switch is in `switch`
    /// scans.
    pub fn pause(&self, switch: Option<u64>) -> Option<u64> {
        let start = self.next.map(|(wait, _)| wait);
        let near = switch.map(|wait| wait.saturating_sub(AHEAD));
        let pause = match (start, near) {
            (_, Some(_)) if self.fruitless < FRUITLESS => 1,
            (Some(start), Some(near)) => start.min(near),
            (start, near) => start.or(near)?,
        };
        Some(pause.max(1))
    }

    /// The whole state, for [`crate::Outlook`].
    pub fn bits(&self) -> [u64; 9] {
        let progress = u64::from(self.drawn) << 32 | u64::from(self.fruitless);
        let flags = (self.switches as u64) << 1 | u64::from(self.fresh);
        let (wait, limits) = match &self.next {
            Some((wait, limits)) => (
                *wait,
                [
                    limits.velocity,
                    limits.acceleration,
                    limits.deceleration,
                    limits.jerk,
                    limits.snap,
                ],
            ),
            None => (u64::MAX, [0.0; 5]),
        };
        let [velocity, acceleration, deceleration, jerk, snap] = limits.map(f64::to_bits);
        [
            self.end,
            wait,
            progress,
            flags,
            velocity,
            acceleration,
            deceleration,
            jerk,
            snap,
        ]
    }

    /// The next number of a fixed sequence, from 0 to less than 1.
    fn draw(&mut self) -> f64 {
        self.drawn = self.drawn.wrapping_add(1);
        // The increment is the golden section of the range. Mixing the bits makes neighbours independent of each other.
        let mut bits = self.drawn.wrapping_mul(0x9E37_79B9);
        bits = (bits ^ (bits >> 16)).wrapping_mul(0x85EB_CA6B);
        bits = (bits ^ (bits >> 13)).wrapping_mul(0xC2B2_AE35);
        f64::from(bits ^ (bits >> 16)) / (f64::from(u32::MAX) + 1.0)
    }

    /// One of `count` numbers, starting at 0.
    fn pick(&mut self, count: usize) -> usize {
        (self.draw() * count as f64) as usize
    }

    /// The limit, or a lower value.
    fn lower(&mut self, limit: f64) -> f64 {
        if self.draw() >= LOWERED {
            return limit;
        }
        let share = self.draw();
        limit * (LOWEST + (1.0 - LOWEST) * share * share)
    }
}

/// The trials of one scan.
struct Trials<'a, P: Planner> {
    axis: &'a Axis<P>,
    below: &'a Below<'a, P::Plan>,
    /// Scans to the next switches of the owner's plan.
    switches: ([u64; SWITCHES], usize),
    /// The part of the limits that the owner's plan uses. It makes room no faster than with these.
    used: Limits,
    start: &'a Setpoint,
    /// The limits at the start, until those of the motion apply; none at rest.
    before: Option<Limits>,
    target: f64,
    asked: &'a Limits,
    /// The highest velocity: as commanded, or that of the commanded motion from this start.
    highest: f64,
    /// Plans that may still be made.
    plans: u32,
    search: Search,
    best: Option<Proposal<P::Plan>>,
}

impl<P: Planner> Axis<P> {
    /// The motion that starts now for `command`. `Ok(None)` if the motion in progress or a later start ends sooner,
    /// or nothing fits. `search` holds the results of the last scans.
    ///
    /// Cost: at most [`FIRST`] plans in the scan in which the command or the owner's motion is new, then [`LATER`] in
    /// a scan. Each is laid over the owner's plan; those from rest once for each of its [`SWITCHES`]. After
    /// [`FRUITLESS`] scans without gain only near a switch.
    ///
    /// # Errors
    /// The same as [`Axis::propose`].
    pub(super) fn soonest(
        &self,
        layer: &Layer<P::Plan>,
        command: &Added,
        room: &Room,
        below: &Below<'_, P::Plan>,
        search: &mut Search,
    ) -> Result<Option<Proposal<P::Plan>>, ErrorId> {
        let Adds::Distance { target, .. } = command.adds else {
            return Ok(None);
        };
        let moving = self.limits_in_state(&layer.added, &layer.in_force, &layer.before);
        let mut trials = Trials {
            axis: self,
            below,
            switches: self.switches(below),
            used: self.used(below, &command.limits),
            start: &layer.added,
            before: layer.moves().then_some(moving),
            target,
            asked: &command.limits,
            highest: command.limits.velocity,
            plans: if search.fresh { FIRST } else { LATER },
            search: Search {
                fresh: false,
                ..*search
            },
            best: None,
        };
        if trials.search.next.is_none() {
            trials.search.end = layer.scans_in_progress(command);
        }
        let known = trials.search.end;
        if !trials.as_commanded()? {
            trials.go_on(layer);
            trials.free(room, layer);
            if search.fresh {
                trials.simple();
            }
            trials.draw();
        }
        let mut found = trials.search;
        let switches = trials.switches.1;
        if found.end < known || found.switches != switches {
            found.fruitless = 0;
        } else {
            found.fruitless = found.fruitless.saturating_add(1);
        }
        found.switches = switches;
        let best = trials.best;
        *search = found;
        Ok(best)
    }

    /// The scans from now to the next switches of the owner's plan, and their number.
    fn switches(&self, below: &Below<'_, P::Plan>) -> ([u64; SWITCHES], usize) {
        let (owner, now) = below.rest;
        let (mut waits, mut count) = ([0; SWITCHES], 0);
        let mut scan = now;
        for wait in &mut waits {
            let next = self.planner.next_switch((owner, scan));
            if next <= scan {
                break;
            }
            scan = next;
            *wait = next.saturating_sub(now);
            count += 1;
        }
        (waits, count)
    }

    /// The part of each limit of `asked` that the owner uses, or the whole limit if it uses none.
    fn used(&self, below: &Below<'_, P::Plan>, asked: &Limits) -> Limits {
        let peaks = self.planner.peaks(below.rest).unwrap_or_default();
        let part = |asked: f64, peak: f64| if peak > 0.0 { min(asked, peak) } else { asked };
        Limits {
            velocity: asked.velocity,
            acceleration: part(asked.acceleration, peaks.acceleration),
            deceleration: part(asked.deceleration, peaks.acceleration),
            jerk: part(asked.jerk, peaks.jerk),
            snap: part(asked.snap, peaks.snap),
        }
    }
}

impl<P: Planner> Trials<'_, P> {
    /// The motion from the start as commanded. Returns whether it fits and ends first; if so, nothing can be gained.
    fn as_commanded(&mut self) -> Result<bool, ErrorId> {
        let asked = *self.asked;
        let before = self.before.unwrap_or(asked);
        self.plans = self.plans.saturating_sub(1);
        let plan = self.move_to(self.start, &asked, &before).map_err(refusal)?;
        if let Some(error) = self.axis.barred((&plan, 0), &asked, &before) {
            return Err(error);
        }
        let peaks = self.axis.planner.peaks((&plan, 0)).unwrap_or_default();
        self.highest = max(self.highest, peaks.velocity);
        if !self.axis.exceeds(&Motion::along(plan)) {
            self.see(&plan, &asked);
        }
        Ok(self.best.as_ref().is_some_and(|best| !best.lowered))
    }

    /// Starts the motion that was found to start in this scan. The motion in progress may continue faster at a later
    /// switch.
    fn go_on(&mut self, layer: &Layer<P::Plan>) {
        if let Some((0, limits)) = self.search.next {
            self.search.next = None;
            self.search.end = u64::MAX;
            if let Some(plan) = self.plan(self.start, &limits, self.before) {
                self.see(&plan, &limits);
            }
        }
        if let (Motion::Run { plan, elapsed, .. }, Some(_), None) = (&layer.motion, self.before, &self.best) {
            self.faster_later((plan, *elapsed), &layer.in_force, AFTER_CURRENT, None);
        }
    }

    /// The motion at the velocity that is always free, and the one within all limits that are always free.
    fn free(&mut self, room: &Room, layer: &Layer<P::Plan>) {
        let velocity = room.limits.velocity;
        if velocity > 0.0 && velocity < self.asked.velocity {
            let limits = self.asked.with_velocity(velocity);
            self.take(&limits, AFTER_FREE);
        }
        if let (false, Some(limits)) = (layer.moves(), limits_of(2, self.asked, room)) {
            self.take(&limits, 0);
        }
    }

    /// The same path in more time, and motions with only the velocity lowered.
    fn simple(&mut self) {
        let asked = *self.asked;
        let longer = PACES.into_iter().map(|rate| slower(&asked, rate));
        let gentler = VELOCITIES
            .into_iter()
            .map(|rate| asked.with_velocity(asked.velocity * rate));
        for limits in longer.chain(gentler) {
            if self.may_end_sooner(&limits) {
                self.take(&limits, 0);
            }
        }
    }

    /// Motions with some of the limits lowered.
    fn draw(&mut self) {
        for _ in 0..DRAWS {
            if self.plans == 0 {
                return;
            }
            let limits = self.lowered();
            if limits != *self.asked && self.may_end_sooner(&limits) {
                self.take(&limits, AFTER_OTHER);
            }
        }
    }

    fn lowered(&mut self) -> Limits {
        let asked = self.asked;
        let search = &mut self.search;
        let mut limits = Limits {
            velocity: search.lower(asked.velocity),
            acceleration: search.lower(asked.acceleration),
            deceleration: search.lower(asked.deceleration),
            jerk: search.lower(asked.jerk),
            snap: asked.snap,
        };
        let toward = (self.target - self.start.position).signum();
        if self.before.is_some() && !(self.start.acceleration * toward > 0.0) {
            limits.acceleration = asked.acceleration;
        } else if search.draw() < LOWERED {
            self.end_at_a_switch(&mut limits);
        }
        limits
    }

    /// A jerk that is reached after whole scans, and an acceleration that is reached or left at a switch of the
    /// owner's plan.
    fn end_at_a_switch(&mut self, limits: &mut Limits) {
        let asked = self.asked;
        let cycle = self.axis.planner.cycle();
        let longest = min(asked.jerk / (asked.snap * cycle) + 0.5, 8.0);
        let scans = 1.0 + (self.search.draw() * max(longest, 1.0)) as u32 as f64;
        let nearest = self.switches.1.min(6);
        let index = self.search.pick(nearest);
        let switch = self.switches.0.get(index).map_or(0.0, |wait| *wait as f64);
        let both = if self.search.draw() < 0.5 {
            switch
        } else {
            switch - scans
        };
        if both >= scans {
            limits.jerk = min(asked.snap * scans * cycle, asked.jerk);
            limits.acceleration = min(limits.jerk * both * cycle, asked.acceleration);
        }
    }

    /// Whether a motion within `limits` could end sooner than the best known one if it had its velocity at once.
    fn may_end_sooner(&self, limits: &Limits) -> bool {
        let left = self.target - self.start.position;
        let rise = max(limits.velocity - self.start.velocity * left.signum(), 0.0);
        let ramp = |change: f64, rate: f64| max(change / rate, 2.0 * sqrt(change / limits.jerk));
        let (up, down) = (
            ramp(rise, limits.acceleration),
            ramp(limits.velocity, limits.deceleration),
        );
        let way = (limits.velocity - 0.5 * rise) * up + 0.5 * limits.velocity * down;
        let even = (left.abs() - way) / limits.velocity;
        let time = if even > 0.0 {
            up + down + even
        } else {
            left.abs() / limits.velocity
        };
        time < (self.search.end as f64 + 1.0) * self.axis.planner.cycle()
    }

    /// Tries a motion. If it fits from now, also tries to continue it faster later.
    fn take(&mut self, limits: &Limits, after: u32) {
        let Some(plan) = self.plan(self.start, limits, self.before) else {
            return;
        };
        if self.see(&plan, limits) {
            self.faster_later((&plan, 0), limits, after, Some(&plan));
        }
    }

    /// Notes a motion that ends before the best known one: from now or, at rest, from a later switch. Returns whether
    /// it fits now.
    fn see(&mut self, plan: &P::Plan, limits: &Limits) -> bool {
        let scans = u64::from(plan.scans());
        if self.fits(plan, 0) {
            if scans < self.search.end {
                self.note(Some(plan), limits, scans, None);
            }
            return true;
        }
        if self.before.is_some() {
            return false;
        }
        let (waits, count) = self.switches;
        for wait in waits.into_iter().take(count) {
            let end = wait.saturating_add(scans);
            if end >= self.search.end {
                break;
            }
            if self.fits(plan, wait) {
                self.note(None, limits, end, Some((wait, *limits)));
                break;
            }
        }
        false
    }

    /// Tries `count` times to continue a motion faster from a later switch of the owner's plan. `starts` is that
    /// motion, unless it is already in progress.
    fn faster_later(
        &mut self,
        (slow, elapsed): (&P::Plan, u64),
        in_force: &Limits,
        count: u32,
        starts: Option<&P::Plan>,
    ) {
        let (waits, switches) = self.switches;
        let scans = u64::from(slow.scans()).saturating_sub(elapsed);
        let per_scan = self.asked.velocity * self.axis.planner.cycle();
        for _ in 0..count {
            let index = self.search.pick(2 * switches);
            let limits = match self.search.pick(3) {
                0 => *self.asked,
                1 => self.used,
                _ => Limits {
                    jerk: 0.6 * self.used.jerk,
                    ..self.used
                },
            };
            let Some(switch) = waits.get(index / 2) else {
                return;
            };
            let wait = switch.saturating_add(index as u64 % 2);
            let there = slow.at(elapsed.saturating_add(wait));
            let soonest = wait as f64 + (self.target - there.position).abs() / per_scan;
            if wait == 0 || wait >= scans || soonest >= self.search.end as f64 || self.plans == 0 {
                continue;
            }
            let Some(fast) = self.plan(&there, &limits, Some(*in_force)) else {
                continue;
            };
            let end = wait.saturating_add(fast.scans().into());
            if end < self.search.end && self.fits(&fast, wait) {
                self.note(starts, in_force, end, Some((wait, limits)));
            }
        }
    }

    /// Notes the best so far: `plan` from now, or the motion in progress, and the motion after it.
    fn note(&mut self, plan: Option<&P::Plan>, limits: &Limits, end: u64, next: Option<(u64, Limits)>) {
        self.search.end = end;
        self.search.next = next;
        self.best = plan.map(|plan| Proposal {
            plan: *plan,
            limits: *limits,
            lowered: *limits != *self.asked,
        });
    }

    /// The motion from `start` within `limits`, if the axis alone can make it and it is not faster than commanded.
    fn plan(&mut self, start: &Setpoint, limits: &Limits, before: Option<Limits>) -> Option<P::Plan> {
        self.plans = self.plans.checked_sub(1)?;
        let before = before.unwrap_or(*limits);
        let plan = self.move_to(start, limits, &before).ok()?;
        let planner = &self.axis.planner;
        // Lowered rates may not be enough to end an acceleration in time.
        let peak = planner.peaks((&plan, 0)).map_or(0.0, |peaks| peaks.velocity);
        let is_good = peak <= self.highest * (1.0 + 1e-9)
            && self.axis.barred((&plan, 0), limits, &before).is_none()
            && !self.axis.exceeds(&Motion::along(plan));
        is_good.then_some(plan)
    }

    fn move_to(
        &self,
        start: &Setpoint,
        limits: &Limits,
        before: &Limits,
    ) -> Result<P::Plan, standstill_planner::PlanError> {
        let profile = self.axis.config.profile;
        self.axis
            .planner
            .move_to(profile, start, self.target, limits, before)
    }

    fn fits(&self, plan: &P::Plan, wait: u64) -> bool {
        let Below { rest, axis, range } = self.below;
        let later = (rest.0, rest.1.saturating_add(wait));
        self.axis.planner.fits(later, (plan, 0), axis, *range)
    }
}

//! Several motions at once: whether their sum keeps the limits.
//!
//! This module adds two plans piece by piece, and finds the room that one leaves. It does not choose the second
//! motion. Between two switches of either plan the sum is a polynomial of constant snap, so its extremes are those
//! of [`extremes`](crate::ramp::path::Path::extremes) (R20).

use crate::ramp::excess;
use crate::ramp::path::{Path, moved};
use crate::{Limits, Order, Plan, Segment, Setpoint, StandardPlan};

/// Largest number of switches of three plans: a path, a wait and a grid plan each.
const MAX_SWITCHES: usize = 144;

/// Shorter pieces of the sum, relative to a cycle, are rounding and not motion. They occur if two
/// switches at the same scan end differ in a bit.
const GRAIN: f64 = 1e-9;

/// A jump up to this part of the change in a cycle is rounding.
const JUMP: f64 = 1e-6;

/// The largest distance of a turning point beyond the end of a range that counts as rounding, relative to
/// the numbers.
const ROUNDING: f64 = 1e-9;

/// A plan at this number of scans after its start.
pub type Part<'a> = (&'a StandardPlan, u64);

/// The rest of a master's plan, as its slave sees it.
#[derive(Debug)]
pub struct Lead<'a, Plan> {
    /// The plan.
    pub plan: &'a Plan,
    /// Scans since its start.
    pub elapsed: u64,
    /// The factor from its derivatives to those of the slave.
    pub factor: f64,
}

impl<'a, Plan> Lead<'a, Plan> {
    /// A whole plan, as it is.
    #[inline]
    pub const fn whole(plan: &'a Plan) -> Self {
        Self {
            plan,
            elapsed: 0,
            factor: 1.0,
        }
    }
}

impl<Plan> Clone for Lead<'_, Plan> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<Plan> Copy for Lead<'_, Plan> {}

/// The plans that a slave follows: of one master, or of two.
pub type Leads<'a, Plan> = [Option<Lead<'a, Plan>>; 2];

/// The rest of a plan, followed piece by piece.
struct Walk<I> {
    segments: I,
    /// State now; the position is that of the plan.
    state: Setpoint,
    /// Time until the next switch (s); infinite from the end of the plan on.
    left: f64,
    /// Velocity from the end of the plan on (u/s).
    goal: f64,
    /// The factor of its derivatives: that of a gear, or 1.
    factor: f64,
}

impl<I: Iterator<Item = Segment>> Walk<I> {
    /// Its derivatives times `factor`; the position is that of the plan.
    fn new(segments: I, (plan, elapsed): Part<'_>, factor: f64, cycle: f64) -> Self {
        let mut walk = Self {
            segments,
            state: Setpoint::default(),
            left: 0.0,
            goal: factor * plan.at(u64::from(plan.scans())).velocity,
            factor,
        };
        walk.turn();
        let mut skip = elapsed as f64 * cycle;
        for _ in 0..MAX_SWITCHES {
            // A switch that is over except for rounding counts as over.
            if skip < walk.left - GRAIN * cycle {
                break;
            }
            skip -= walk.left;
            walk.left = 0.0;
            walk.turn();
        }
        if walk.left.is_finite() {
            walk.go(skip.max(0.0));
        }
        walk.state.position = plan.at(elapsed).position;
        walk
    }

    /// Enters the next piece if the present one is over.
    fn turn(&mut self) {
        if self.left > 0.0 {
            return;
        }
        let position = self.state.position;
        (self.left, self.state) = match self.segments.next() {
            Some(segment) => (
                segment.duration,
                Setpoint {
                    position,
                    ..segment.first().times(self.factor)
                },
            ),
            None => (
                f64::INFINITY,
                Setpoint {
                    velocity: self.goal,
                    ..Setpoint::at_rest(position)
                },
            ),
        };
    }

    fn go(&mut self, time: f64) {
        self.state = moved(&self.state, time);
        self.left -= time;
        self.turn();
    }
}

/// The rest of a plan, its derivatives times `factor`.
fn walk<'a>(part: Part<'a>, factor: f64, cycle: f64) -> Walk<impl Iterator<Item = Segment> + use<'a>> {
    Walk::new(part.0.segments(), part, factor, cycle)
}

/// A piece of constant snap as a path.
fn piece(state: &Setpoint, length: f64) -> Path<1> {
    Path::follow(
        Order::Four,
        state,
        f64::INFINITY,
        core::iter::once((length, state.snap)),
    )
}

/// Whether a plan is on a curve that has no pieces of constant snap.
pub(crate) fn is_curve((plan, elapsed): Part<'_>) -> bool {
    matches!(plan, StandardPlan::Profile(profile) if elapsed < u64::from(profile.scans()))
}

/// Whether a plan has come to rest.
fn stands((plan, elapsed): Part<'_>) -> bool {
    elapsed >= u64::from(plan.scans()) && plan.at(elapsed).velocity == 0.0
}

/// Whether the sum of two plans keeps `limits` from now until both have ended, and does not turn outside `range`
/// (u), which applies to the sum of their positions.
///
/// A sum may start or end outside `range`: the caller has decided on both ends. One that starts outside and comes
/// in must stay in. Limits are kept to 1e-9 of each, positions to 1e-9 of the range's numbers. Bounded by
/// [`MAX_SWITCHES`] pieces with at most two roots each. A curve through points fits only a plan at rest, and is
/// bounded by 64 pieces for each of its stretches.
pub(crate) fn fits(
    first: Part<'_>,
    second: Part<'_>,
    limits: &Limits,
    range: Option<(f64, f64)>,
    cycle: f64,
) -> bool {
    if let (StandardPlan::Profile(profile), true) = (first.0, is_curve(first)) {
        // The room that a curve leaves to another motion is not computed.
        let at = second.0.at(second.1).position;
        return stands(second)
            && profile.keeps(first.1, limits, range.map(|(min, max)| (min - at, max - at)));
    }
    if is_curve(second) {
        return false;
    }
    let walks = [
        Some(walk(first, 1.0, cycle)),
        Some(walk(second, 1.0, cycle)),
        None,
    ];
    let room = range.map(|range| Room::of(range, first, second));
    keeps(Sum { walks }, None, limits, room, cycle)
}

/// The sum of at most three plans, followed piece by piece: those of the masters, and the slave's additional
/// motion.
struct Sum<I> {
    walks: [Option<Walk<I>>; 3],
}

impl<I: Iterator<Item = Segment>> Sum<I> {
    fn state(&self) -> Setpoint {
        let mut walks = self.walks.iter().flatten().map(|walk| walk.state);
        let first = walks.next().unwrap_or_default();
        walks.fold(first, |sum, state| sum.plus(&state))
    }

    /// Time until the next switch of any of them (s); infinite from the end of all on.
    fn left(&self) -> f64 {
        let shorter = |least: f64, left: f64| if left < least { left } else { least };
        let walks = self.walks.iter().flatten();
        walks.map(|walk| walk.left).fold(f64::INFINITY, shorter)
    }

    fn go(&mut self, time: f64) {
        for walk in self.walks.iter_mut().flatten() {
            walk.go(time);
        }
    }
}

/// Whether a sum keeps `limits` and its `room` to its end and, if it goes on from a `last` state, has no jump.
fn keeps<I: Iterator<Item = Segment>>(
    mut sum: Sum<I>,
    mut last: Option<Setpoint>,
    limits: &Limits,
    mut room: Option<Room>,
    cycle: f64,
) -> bool {
    for _ in 0..MAX_SWITCHES {
        let state = sum.state();
        if last.is_some_and(|last| !is_continuous(&last, &state, limits, cycle)) {
            return false;
        }
        let length = sum.left();
        if !length.is_finite() {
            return state.velocity.abs() <= limits.velocity * (1.0 + ROUNDING);
        }
        if length > GRAIN * cycle && !piece_fits(&state, length, limits, room.as_mut()) {
            return false;
        }
        last = last.map(|_| moved(&state, length));
        sum.go(length);
    }
    false
}

/// The plans of `leads` and, in units of the slave, the one `beside`; `None` where one of them is on a curve.
fn behind<'a>(
    leads: &Leads<'a, StandardPlan>,
    beside: Option<Part<'a>>,
    cycle: f64,
) -> Option<Sum<impl Iterator<Item = Segment> + use<'a>>> {
    let beside = beside.map(|(plan, elapsed)| Lead {
        plan,
        elapsed,
        factor: 1.0,
    });
    let parts = [leads[0], leads[1], beside];
    if parts.iter().flatten().any(|lead| is_curve(lead.part())) {
        return None;
    }
    let walk = |lead: Lead<'a, StandardPlan>| walk(lead.part(), lead.factor, cycle);
    Some(Sum {
        walks: parts.map(|lead| lead.map(walk)),
    })
}

impl<'a> Lead<'a, StandardPlan> {
    fn part(&self) -> Part<'a> {
        (self.plan, self.elapsed)
    }
}

/// Whether the rest of the masters' plans and the slave's additional motion together keep `limits` from now on. A
/// curve through points is not known, so it does not fit.
///
/// A jump of a derivative does not fit if `limits` bound the next one; `now` is the sum published for
/// this instant.
///
/// Limits are kept to 1e-9 of each. Bounded by [`MAX_SWITCHES`] pieces with at most two roots
/// each.
pub(crate) fn fits_behind(
    leads: &Leads<'_, StandardPlan>,
    now: &Setpoint,
    beside: Option<Part<'_>>,
    limits: &Limits,
    cycle: f64,
) -> bool {
    behind(leads, beside, cycle).is_some_and(|sum| keeps(sum, Some(*now), limits, None, cycle))
}

/// The lowest and the highest velocity of the rest of the masters' plans together with the slave's additional
/// motion. `None` on a curve through points. Bounded by [`MAX_SWITCHES`] pieces with at most two roots each.
pub(crate) fn velocities_behind(
    leads: &Leads<'_, StandardPlan>,
    beside: Part<'_>,
    cycle: f64,
) -> Option<(f64, f64)> {
    let mut sum = behind(leads, Some(beside), cycle)?;
    let (mut lowest, mut highest) = (f64::INFINITY, f64::NEG_INFINITY);
    for _ in 0..MAX_SWITCHES {
        let state = sum.state();
        let mut see = |velocity: f64| {
            lowest = lowest.min(velocity);
            highest = highest.max(velocity);
        };
        see(state.velocity);
        let length = sum.left();
        if !length.is_finite() {
            return Some((lowest, highest));
        }
        if length > GRAIN * cycle {
            piece(&state, length).extremes(f64::INFINITY, |state, _| see(state.velocity));
        }
        sum.go(length);
    }
    None
}

/// Whether no derivative with a bounded derivative jumps from one state to the next.
fn is_continuous(last: &Setpoint, next: &Setpoint, limits: &Limits, cycle: f64) -> bool {
    let keeps =
        |last: f64, next: f64, bound: f64| !bound.is_finite() || (next - last).abs() <= JUMP * bound * cycle;
    // In a scan no jerk changes by more than the snap permits.
    let jerk = limits.jerk.min(limits.snap * cycle);
    keeps(last.acceleration, next.acceleration, jerk) && keeps(last.jerk, next.jerk, limits.snap)
}

/// The next stretch in which the masters' plans together have a constant velocity: the scans until it
/// begins and until it ends, the largest number if it has no end. `None` on a curve through points.
///
/// Bounded by [`MAX_SWITCHES`] pieces.
pub(crate) fn stretch(leads: &Leads<'_, StandardPlan>, cycle: f64) -> Option<(u64, u64)> {
    let mut time = 0.0;
    let mut sum = behind(leads, None, cycle)?;
    // From its last scan on a plan does not change.
    let rest = |lead: &Lead<'_, StandardPlan>| u64::from(lead.plan.scans()).saturating_sub(lead.elapsed);
    let all = leads.iter().flatten().map(rest).max().unwrap_or(0);
    for _ in 0..MAX_SWITCHES {
        let even = |walk: &Walk<_>| {
            let state = &walk.state;
            state.acceleration == 0.0 && state.jerk == 0.0 && state.snap == 0.0
        };
        let is_even = sum.walks.iter().flatten().all(even);
        let left = sum.left();
        let begin = u64::from(crate::ramp::scans(time, cycle)?);
        if !left.is_finite() {
            return Some((begin.min(all), u64::MAX));
        }
        // The scan before the one in which it ends is the last that is wholly in it.
        let end = ((time + left) / cycle * (1.0 + GRAIN)) as u64;
        if is_even && end > begin {
            return Some((begin, end));
        }
        time += left;
        sum.go(left);
    }
    None
}

/// The range in which a sum may turn.
struct Room {
    /// The range, with the end of the motion inside, and rounding (u).
    min: f64,
    max: f64,
    /// Its start (u), and whether it is inside, or has come inside since.
    from: f64,
    is_in: bool,
    /// Velocity at the end of the piece before (u/s): a sum may turn just at a switch.
    velocity: f64,
}

impl Room {
    fn of((min, max): (f64, f64), first: Part<'_>, second: Part<'_>) -> Self {
        let end = |(plan, _): Part<'_>| plan.at(u64::from(plan.scans())).position;
        let from = first.0.at(first.1).position + second.0.at(second.1).position;
        let to = end(first) + end(second);
        let small = |bound: f64| {
            if bound.is_finite() {
                ROUNDING * bound.abs()
            } else {
                0.0
            }
        };
        Self {
            min: min.min(to) - small(min),
            max: max.max(to) + small(max),
            from,
            is_in: false,
            velocity: 0.0,
        }
    }

    /// The motion passes `position`; returns whether it may turn there.
    fn takes(&mut self, position: f64) -> bool {
        let is_inside = |min: f64, max: f64| min <= position && position <= max;
        if is_inside(self.min, self.max) {
            self.is_in = true;
            return true;
        }
        !self.is_in && is_inside(self.min.min(self.from), self.max.max(self.from))
    }
}

fn piece_fits(state: &Setpoint, length: f64, limits: &Limits, room: Option<&mut Room>) -> bool {
    if state.snap.abs() > limits.snap * (1.0 + ROUNDING) {
        return false;
    }
    let path = piece(state, length);
    if excess::excess(&path, 0.0, None, &(*limits).into()).is_some() {
        return false;
    }
    let Some(room) = room else { return true };
    let turned = room.velocity * state.velocity < 0.0;
    let mut fits = !turned || room.takes(state.position);
    room.velocity = moved(state, length).velocity;
    path.extremes(0.0, |state, direction| {
        let turns = direction.is_none() || state.velocity == 0.0;
        let takes = room.takes(state.position);
        fits &= !turns || takes;
    });
    fits
}

/// The part of `limits` that the rest of a plan leaves: the limits less its largest magnitudes, 0 if it
/// leaves nothing. Acceleration and deceleration are reduced by the larger of the two.
///
/// A motion within it keeps `limits` together with the plan, at any times. Bounded by [`MAX_SWITCHES`]
/// pieces.
pub(crate) fn room(part: Part<'_>, limits: &Limits, cycle: f64) -> Limits {
    let Some(peak) = peaks(part, f64::INFINITY, cycle) else {
        return Limits {
            velocity: 0.0,
            acceleration: 0.0,
            deceleration: 0.0,
            jerk: 0.0,
            snap: 0.0,
        };
    };
    let less = |limit: f64, peak: f64| {
        let rest = limit - peak;
        if rest > ROUNDING * limit || rest == f64::INFINITY {
            rest
        } else {
            0.0
        }
    };
    Limits {
        velocity: less(limits.velocity, peak.velocity),
        acceleration: less(limits.acceleration, peak.acceleration),
        deceleration: less(limits.deceleration, peak.acceleration),
        jerk: less(limits.jerk, peak.jerk),
        snap: less(limits.snap, peak.snap),
    }
}

/// The largest magnitudes of the derivatives of a plan for the next `time` (s); `None` on a curve through
/// points. Bounded by [`MAX_SWITCHES`] pieces.
pub(crate) fn peaks(part: Part<'_>, time: f64, cycle: f64) -> Option<Setpoint> {
    if is_curve(part) {
        return None;
    }
    let mut walk = walk(part, 1.0, cycle);
    let mut peak = Setpoint::default();
    let mut see = |state: &Setpoint| {
        peak.velocity = peak.velocity.max(state.velocity.abs());
        peak.acceleration = peak.acceleration.max(state.acceleration.abs());
        peak.jerk = peak.jerk.max(state.jerk.abs());
        peak.snap = peak.snap.max(state.snap.abs());
    };
    let mut left = time;
    for _ in 0..MAX_SWITCHES {
        let length = walk.left.min(left);
        if !length.is_finite() {
            break;
        }
        if length > GRAIN * cycle {
            piece(&walk.state, length).extremes(f64::INFINITY, |state, _| see(state));
        }
        left -= length;
        if !(left > 0.0) {
            return Some(peak);
        }
        walk.go(length);
    }
    peak.velocity = peak.velocity.max(walk.goal.abs());
    Some(peak)
}

/// The first scan after `elapsed` at or after the end of the piece in force at `elapsed`; `elapsed` itself
/// from the end of the plan on.
pub(crate) fn next_switch((plan, elapsed): Part<'_>, cycle: f64) -> u64 {
    if is_curve((plan, elapsed)) {
        return u64::from(plan.scans());
    }
    let walk = walk((plan, elapsed), 1.0, cycle);
    if !walk.left.is_finite() {
        return elapsed;
    }
    let scans = crate::ramp::scans(walk.left, cycle).unwrap_or(u32::MAX);
    elapsed.saturating_add(u64::from(scans.max(1)))
}

/// The distances (u) of the rest of a plan upwards and downwards, up to its goal: the sums over the stretches
/// between its turns. Bounded by [`MAX_SWITCHES`] pieces with at most two roots each.
pub(crate) fn ways(part: Part<'_>, cycle: f64) -> (f64, f64) {
    if let StandardPlan::Profile(profile) = part.0 {
        return profile.ways(part.1);
    }
    let (mut up, mut down) = (0.0, 0.0);
    each_way(part, cycle, |way| {
        if way > 0.0 {
            up += way;
        } else {
            down -= way;
        }
    });
    (up, down)
}

/// The range (u) of the rest of a plan up to its goal, relative to its present position. On a curve through points
/// it is not known; the sums of its distances are then used, which are not smaller. Bounded as [`ways`].
pub(crate) fn reach(part: Part<'_>, cycle: f64) -> (f64, f64) {
    if let StandardPlan::Profile(profile) = part.0 {
        let (up, down) = profile.ways(part.1);
        return (-down, up);
    }
    let (mut at, mut lowest, mut highest) = (0.0_f64, 0.0_f64, 0.0_f64);
    each_way(part, cycle, |way| {
        at += way;
        lowest = lowest.min(at);
        highest = highest.max(at);
    });
    (lowest, highest)
}

/// The distances (u) of the rest of a plan one after the other, with their signs: none of them turns.
fn each_way(part: Part<'_>, cycle: f64, mut go: impl FnMut(f64)) {
    let mut walk = walk(part, 1.0, cycle);
    for _ in 0..MAX_SWITCHES {
        if !walk.left.is_finite() {
            break;
        }
        if walk.left > GRAIN * cycle {
            let start = walk.state.at_origin();
            let mut from = 0.0;
            piece(&start, walk.left).extremes(0.0, |state, direction| {
                if direction.is_none() {
                    go(state.position - from);
                    from = state.position;
                }
            });
            go(moved(&start, walk.left).position - from);
        }
        walk.go(walk.left);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MoveProfile, Planner, Standard};

    const CYCLE: f64 = 0.01;
    const LIMITS: Limits = Limits {
        velocity: 100.0,
        acceleration: 1000.0,
        deceleration: 1000.0,
        jerk: f64::INFINITY,
        snap: f64::INFINITY,
    };

    /// A move over `distance` whose ramps take 10 scans at `velocity`.
    fn plan(from: f64, distance: f64, velocity: f64) -> StandardPlan {
        let limits = Limits {
            velocity,
            acceleration: velocity * 10.0,
            deceleration: velocity * 10.0,
            ..LIMITS
        };
        let standard = Standard::new(CYCLE);
        standard
            .move_to(
                MoveProfile::Overlapped,
                &Setpoint::at_rest(from),
                from + distance,
                &limits,
                &limits,
            )
            .unwrap()
    }

    #[test]
    fn a_sum_at_the_limit_fits_and_one_above_does_not() {
        let base = plan(0.0, 60.0, 60.0);
        for (velocity, fit) in [(40.0, true), (40.001, false)] {
            let added = plan(0.0, velocity, velocity);
            // Velocity breaks the limit while both cruise, acceleration while both speed up.
            assert_eq!(
                fits((&base, 0), (&added, 0), &LIMITS, None, CYCLE),
                fit,
                "{velocity}"
            );
            assert_eq!(
                fits((&base, 20), (&added, 0), &LIMITS, None, CYCLE),
                fit,
                "{velocity}"
            );
        }
        // In the other direction the sum is the smaller one, until the base is over.
        let added = plan(0.0, -100.0, 100.0);
        assert!(fits((&base, 0), (&added, 0), &LIMITS, None, CYCLE));
        assert!(
            !fits((&base, 105), (&added, 0), &LIMITS, None, CYCLE),
            "1.6 ramps at once"
        );
        assert!(fits((&base, 110), (&added, 0), &LIMITS, None, CYCLE));
    }

    #[test]
    fn a_turning_point_outside_the_range_does_not_fit() {
        let (base, added) = (plan(0.0, -30.0, 10.0), plan(0.0, 60.0, 60.0));
        let highest = (0..400)
            .map(|scan| base.at(scan).position + added.at(scan).position)
            .fold(0.0, f64::max);
        let within = |max: f64| fits((&base, 0), (&added, 0), &LIMITS, Some((-1.0, max)), CYCLE);
        assert!(within(highest + 0.01) && !within(highest - 0.01), "{highest}");
        // Both ends are decided by the caller.
        let (base, added) = (plan(0.0, 30.0, 10.0), plan(0.0, 60.0, 60.0));
        assert!(fits((&base, 0), (&added, 0), &LIMITS, Some((1.0, 2.0)), CYCLE));
    }

    #[test]
    fn room_is_what_the_rest_of_a_plan_leaves() {
        let base = plan(0.0, 60.0, 60.0);
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        let all = room((&base, 0), &LIMITS, CYCLE);
        assert!(
            near(all.velocity, 40.0) && near(all.acceleration, 400.0),
            "{all:?}"
        );
        assert_eq!(all.jerk, f64::INFINITY);
        let ended = room((&base, 110), &LIMITS, CYCLE);
        assert_eq!((ended.velocity, ended.acceleration), (100.0, 1000.0));
        assert_eq!(room((&plan(0.0, 100.0, 100.0), 50), &LIMITS, CYCLE).velocity, 0.0);
    }

    #[test]
    fn ways_are_counted_between_turns() {
        let standard = Standard::new(CYCLE);
        let moving = Setpoint {
            velocity: 50.0,
            ..Setpoint::at_rest(3.0)
        };
        // It brakes over 50^2 / (2 * 1000) = 1.25 before it comes back.
        let back = standard
            .move_to(MoveProfile::Online, &moving, 3.25, &LIMITS, &LIMITS)
            .unwrap();
        let near = |a: f64, b: f64| (a - b).abs() < 1e-9;
        let (up, down) = ways((&back, 0), CYCLE);
        assert!(near(up, 1.25) && near(down, 1.0), "{up} {down}");
        let (lowest, highest) = reach((&back, 0), CYCLE);
        assert!(lowest == 0.0 && near(highest, 1.25), "{lowest} {highest}");
        let (up, down) = ways((&back, 7), CYCLE);
        assert!(
            near(up, 0.0) && near(down, back.at(7).position - 3.25),
            "{up} {down}"
        );
        // Up to the goal of an endless motion.
        let ramp = standard
            .ramp_to(&Setpoint::at_rest(0.0), -10.0, &LIMITS, &LIMITS)
            .unwrap();
        let (up, down) = ways((&ramp, 0), CYCLE);
        assert!(up == 0.0 && near(down, 0.05), "{up} {down}");
    }

    #[test]
    fn the_next_switch_is_the_end_of_the_piece() {
        let base = plan(0.0, 60.0, 60.0);
        let switches = [
            (0, 10),
            (9, 10),
            (10, 100),
            (99, 100),
            (100, 110),
            (110, 110),
            (500, 500),
        ];
        for (elapsed, switch) in switches {
            assert_eq!(next_switch((&base, elapsed), CYCLE), switch, "{elapsed}");
        }
    }
}

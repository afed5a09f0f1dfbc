//! Whether a slave keeps its limits on a cam along what its master does next.
//!
//! The rest of a plan is looked at in pieces, and each piece with what the cam is bounded by where it leads. The bounds are on the
//! safe side by some per cent, the more so the longer the pieces.

use super::super::super::Axis;
use super::super::follow::Beyond;
use super::Curve;
use standstill_planner::{CamBounds, Lead, Limits, Place, Plan, Planner, Setpoint};

/// Most pieces of a plan that are looked at one by one.
const PIECES: u32 = 40;

/// Each of them in so many parts, as a power of two, while the master accelerates.
const PARTS: u64 = 3;

/// Most parts in all.
const PARTS_MOST: u32 = 160;

/// A plan as it is followed: where it leads the master, counted from its place now.
struct Path<'a, Q> {
    lead: &'a Lead<'a, Q>,
    from: f64,
}

impl<Q: Plan> Path<'_, Q> {
    /// The state so many scans after the start of the plan, the position counted from where the lead begins.
    fn at(&self, scan: u64) -> Setpoint {
        let at = self.lead.plan.at(scan).times(self.lead.factor);
        Setpoint {
            position: at.position - self.from,
            ..at
        }
    }
}

/// The larger of two magnitudes.
fn larger(one: f64, other: f64) -> f64 {
    one.abs().max(other.abs())
}

impl<P: Planner> Axis<P> {
    /// What a slave on `curve` would need beyond `limits` along the rest of a plan, which begins with the master at `place`. A plan
    /// of a lower `degree` than those limits changes at once what the slave may not.
    ///
    /// Cost: at most [`PARTS_MOST`] parts, for each three points of the plan and a look at up to four pieces of the cam.
    pub(super) fn beyond_on_cam(
        &self,
        curve: &Curve<'_>,
        (lead, degree): (&Lead<'_, P::Plan>, usize),
        place: Place,
        limits: &Limits,
    ) -> Option<Beyond> {
        let is_rough = degree < limits.order().degree();
        let cycle = self.planner.cycle();
        let path = Path {
            lead,
            from: lead.plan.at(lead.elapsed).position * lead.factor,
        };
        let x = curve.unwound(place);
        let end = u64::from(lead.plan.scans());
        let (mut scan, mut parts) = (lead.elapsed, 0);
        for _ in 0..PIECES {
            if scan >= end {
                return self.beyond_on_cruise(curve, x, &path.at(scan), limits);
            }
            let switch = self.planner.next_switch((lead.plan, scan));
            let switch = if switch > scan { switch.min(end) } else { end };
            let is_even = {
                let inside = path.at(scan.saturating_add(1));
                inside.acceleration == 0.0 && inside.jerk == 0.0 && inside.snap == 0.0
            };
            let step = if is_even {
                switch.saturating_sub(scan)
            } else {
                (switch.saturating_sub(scan) >> PARTS).max(1)
            };
            for _ in 0..=4_u32 << PARTS {
                if scan >= switch {
                    break;
                }
                // The last scan may end in the next piece, and is a part of its own.
                let inside = switch.saturating_sub(1).max(scan.saturating_add(1));
                let next = scan.saturating_add(step).min(inside);
                let most = part_of(&path, scan, next, cycle);
                let (low, high) = most.0;
                let per = 1.0 / curve.law.master_scaling;
                let (low, high) = (x + low * per, x + high * per);
                let bounds = curve.law.bounds_between(&curve.cam, low.min(high), low.max(high));
                let jumps = is_rough && most.1.acceleration != 0.0 && !bounds.is_level();
                let found = if jumps {
                    Some(rough(degree, limits))
                } else {
                    CamBounds::beyond(&bounds.most(&most.1), limits)
                };
                if found.is_some() {
                    return found;
                }
                scan = next;
                parts += 1;
            }
            if parts > PARTS_MOST {
                break;
            }
        }
        // The box of all that is left.
        let peaks = self.planner.peaks((lead.plan, scan));
        let bounds = curve.bounds();
        let most = peaks.map(|peaks| bounds.most(&peaks.times(lead.factor)));
        most.and_then(|most| CamBounds::beyond(&most, limits))
    }

    /// The same for a master that goes on with a constant velocity, or stands.
    fn beyond_on_cruise(
        &self,
        curve: &Curve<'_>,
        x: f64,
        from: &Setpoint,
        limits: &Limits,
    ) -> Option<Beyond> {
        if from.velocity == 0.0 {
            return None;
        }
        let per = 1.0 / curve.law.master_scaling;
        let head = curve.cam.head;
        let bounds = if head.periodic {
            curve.bounds()
        } else {
            let here = x + from.position * per;
            let forwards = from.velocity * per > 0.0;
            let (low, high) = if forwards {
                (here, head.end)
            } else {
                (head.begin, here)
            };
            curve.law.bounds_between(&curve.cam, low, high)
        };
        let even = Setpoint {
            velocity: from.velocity,
            ..Setpoint::default()
        };
        CamBounds::beyond(&bounds.most(&even), limits)
    }
}

/// What jumps behind a master of a lower degree.
fn rough(degree: usize, limits: &Limits) -> Beyond {
    if degree < 3 {
        ("jerk", f64::INFINITY, limits.jerk)
    } else {
        ("snap", f64::INFINITY, limits.snap)
    }
}

/// From where to where a part of a plan leads at most, and the largest magnitudes of its derivatives: a piece of constant snap, of
/// which the last scan may be of the next piece.
fn part_of<Q: Plan>(path: &Path<'_, Q>, from: u64, to: u64, cycle: f64) -> ((f64, f64), Setpoint) {
    let (first, inside, last) = (path.at(from), path.at(from.saturating_add(1)), path.at(to));
    let time = to.saturating_sub(from) as f64 * cycle;
    // A curve is off its chord by no more than an eighth of its second derivative times the time squared.
    let bent = 0.125 * time * time;
    let (velocity, acceleration, jerk, snap);
    if to.saturating_sub(from) == 1 {
        // The plan may go on to its next piece in between: what leads from one value to another at such a rate stays below that.
        let between = |one: f64, other: f64, rate: f64| 0.5 * (one.abs() + other.abs() + rate * time);
        snap = larger(first.snap, last.snap);
        let steepest = larger(first.jerk, last.jerk);
        jerk = steepest.max(between(first.jerk, last.jerk, snap));
        // One that begins and ends in it shows at neither end.
        let mean = (last.velocity - first.velocity).abs() / time;
        acceleration = between(first.acceleration, last.acceleration, jerk).max(mean);
        velocity = between(first.velocity, last.velocity, acceleration);
    } else {
        // A piece of constant snap, told from its inside: on its ends what jumps there may be that of the next one.
        let (back, on) = (-cycle, time - cycle);
        let jerk_at = |t: f64| inside.jerk + inside.snap * t;
        let acceleration_at = |t: f64| inside.acceleration + inside.jerk * t + 0.5 * inside.snap * t * t;
        snap = inside.snap.abs();
        jerk = larger(jerk_at(back), jerk_at(on));
        acceleration = larger(acceleration_at(back), acceleration_at(on)) + bent * snap;
        velocity = larger(first.velocity, last.velocity) + bent * jerk;
    }
    let way = bent * acceleration;
    let range = (
        first.position.min(last.position) - way,
        first.position.max(last.position) + way,
    );
    let most = Setpoint {
        position: 0.0,
        velocity,
        acceleration,
        jerk,
        snap,
    };
    (range, most)
}

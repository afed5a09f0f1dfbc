//! Whether a slave keeps its limits on a cam along the known motion of its master.
//!
//! The rest of a plan is checked in pieces, each with the bounds of the cam on that part. On a bent part of the cam
//! these bounds are some per cent too high, which is safe. They are higher still for longer pieces.

use super::super::super::Axis;
use super::super::follow::Beyond;
use super::super::outside::way_left;
use super::super::view::View;
use super::Curve;
use crate::Cams;
use standstill_planner::{CamBounds, Lead, Limits, Place, Plan, Planner, Setpoint};

/// Most pieces of a plan that are checked one by one.
const PIECES: u32 = 40;

/// While the master accelerates, each piece is checked in this number of parts, as a power of two.
const PARTS: u64 = 3;

/// Most parts in all.
const PARTS_MOST: u32 = 160;

/// A plan as it is followed: the motion of the master, counted from its present place.
struct Path<'a, Q> {
    lead: &'a Lead<'a, Q>,
    from: f64,
}

impl<Q: Plan> Path<'_, Q> {
    /// The state this number of scans after the start of the plan. The position counts from the beginning of the
    /// lead.
    fn at(&self, scan: u64) -> Setpoint {
        let at = self.lead.plan.at(scan).times(self.lead.factor);
        at.moved_to(at.position - self.from)
    }
}

/// The larger of two magnitudes.
fn larger(one: f64, other: f64) -> f64 {
    one.abs().max(other.abs())
}

impl<P: Planner> Axis<P> {
    /// The place of the slave on the cam (u) when its master has come to rest. `None` if that is not known or the
    /// motion of the master is endless.
    pub(in crate::axis::coupling) fn rest_of_cam(
        &self,
        view: &View<'_, P::Plan>,
        cams: &Cams<'_>,
    ) -> Option<f64> {
        let on_cam = self.on_cam().filter(|on_cam| !on_cam.ends.is_over())?;
        let curve = on_cam.stored_curve(cams)?;
        let lead = self.lead_of_master(view)?;
        let way = way_left(view, &[Some(lead), None])?;
        let place = view.now.place.moved_to(view.now.place.position + way);
        let at = curve.at(place, &Setpoint::default(), on_cam.at.piece);
        Some(at.place.position)
    }

    /// The first limit that a slave on `curve` would exceed along the rest of a plan, which begins with the master at
    /// `place`. The motion of a plan of a lower `degree` than the limits has jumps that the slave may not have.
    ///
    /// Cost: that of [`Axis::along_cam`].
    pub(super) fn beyond_on_cam(
        &self,
        curve: &Curve<'_>,
        (lead, degree): (&Lead<'_, P::Plan>, usize),
        place: Place,
        limits: &Limits,
    ) -> Option<Beyond> {
        let is_rough = degree < limits.order().degree();
        self.along_cam(curve, lead, place, |bounds, master| {
            if is_rough && master.acceleration != 0.0 && !bounds.is_level() {
                Some(rough(degree, limits))
            } else {
                CamBounds::beyond(&bounds.most(master), limits)
            }
        })
    }

    /// The largest magnitudes of the derivatives of a slave on `curve` along the rest of a plan, which begins with
    /// the master at `place`.
    pub(super) fn peaks_on_cam(&self, curve: &Curve<'_>, lead: &Lead<'_, P::Plan>, place: Place) -> Setpoint {
        let mut peaks = Setpoint::default();
        let _none: Option<()> = self.along_cam(curve, lead, place, |bounds, master| {
            let most = bounds.most(master);
            peaks = Setpoint {
                position: 0.0,
                velocity: larger(peaks.velocity, most.velocity),
                acceleration: larger(peaks.acceleration, most.acceleration),
                jerk: larger(peaks.jerk, most.jerk),
                snap: larger(peaks.snap, most.snap),
            };
            None
        });
        peaks
    }

    /// Checks the rest of a plan, which begins with the master at `place`, in parts. Each part has the bounds of the
    /// cam there and the largest magnitudes of the master's derivatives. Returns the first result of `found`.
    ///
    /// Cost: at most [`PARTS_MOST`] parts, for each three points of the plan and at most four pieces of the cam.
    fn along_cam<T>(
        &self,
        curve: &Curve<'_>,
        lead: &Lead<'_, P::Plan>,
        place: Place,
        mut found: impl FnMut(&CamBounds, &Setpoint) -> Option<T>,
    ) -> Option<T> {
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
                let (bounds, even) = curve.cruise(x, &path.at(scan))?;
                return found(&bounds, &even);
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
                // The last scan may hold several pieces, and is a part of its own.
                let inside = switch.saturating_sub(1).max(scan.saturating_add(1));
                let next = scan.saturating_add(step).min(inside);
                let ((low, high), most) = if next.saturating_sub(scan) > 1 {
                    part_of(&path, scan, next, cycle)
                } else {
                    let most = self.planner.peaks_in_scan((lead.plan, scan))?.times(lead.factor);
                    let beyond = bent(cycle) * most.acceleration.abs();
                    (range(&path.at(scan), &path.at(next), beyond), most)
                };
                let per = 1.0 / curve.law.master_scaling;
                let (low, high) = (x + low * per, x + high * per);
                let bounds = curve.law.bounds_between(&curve.cam, low.min(high), low.max(high));
                let answer = found(&bounds, &most);
                if answer.is_some() {
                    return answer;
                }
                scan = next;
                parts += 1;
            }
            if parts > PARTS_MOST {
                break;
            }
        }
        // One box for all the rest.
        let peaks = self.planner.peaks((lead.plan, scan))?;
        found(&curve.bounds(), &peaks.times(lead.factor))
    }
}

impl Curve<'_> {
    /// The bounds of the cam ahead of a master that is at `x` and continues with a constant velocity, and that
    /// motion. None for a master at rest.
    fn cruise(&self, x: f64, from: &Setpoint) -> Option<(CamBounds, Setpoint)> {
        if from.velocity == 0.0 {
            return None;
        }
        let per = 1.0 / self.law.master_scaling;
        let head = self.cam.head;
        let bounds = if head.periodic {
            self.bounds()
        } else {
            let here = x + from.position * per;
            let forwards = from.velocity * per > 0.0;
            let (low, high) = if forwards {
                (here, head.end)
            } else {
                (head.begin, here)
            };
            self.law.bounds_between(&self.cam, low, high)
        };
        let even = Setpoint::at_velocity(0.0, from.velocity);
        Some((bounds, even))
    }
}

/// The derivative that jumps with a master of a lower degree.
fn rough(degree: usize, limits: &Limits) -> Beyond {
    if degree < 3 {
        ("jerk", f64::INFINITY, limits.jerk)
    } else {
        ("snap", f64::INFINITY, limits.snap)
    }
}

/// The range of places of a part of a plan, and the largest magnitudes of its derivatives. The part is a piece of
/// constant snap.
fn part_of<Q: Plan>(path: &Path<'_, Q>, from: u64, to: u64, cycle: f64) -> ((f64, f64), Setpoint) {
    let (first, inside, last) = (path.at(from), path.at(from.saturating_add(1)), path.at(to));
    let time = to.saturating_sub(from) as f64 * cycle;
    let bent = bent(time);
    // Computed from within the part, because a derivative at an end may belong to the next part.
    let (back, on) = (-cycle, time - cycle);
    let jerk_at = |t: f64| inside.jerk + inside.snap * t;
    let acceleration_at = |t: f64| inside.acceleration + inside.jerk * t + 0.5 * inside.snap * t * t;
    let snap = inside.snap.abs();
    let jerk = larger(jerk_at(back), jerk_at(on));
    // The derivative is largest at an end, or where the jerk is 0.
    let level = -inside.jerk / inside.snap;
    let between = if level > back && level < on { level } else { on };
    let accelerations = [back, between, on].map(acceleration_at);
    let up = accelerations.into_iter().fold(0.0, f64::max);
    let down = accelerations.into_iter().fold(0.0, f64::min).abs();
    let acceleration = larger(up, down);
    // A part that only speeds up or only slows down has its highest velocity at an end.
    let passed = (bent * jerk).min(time * up.min(down));
    let most = Setpoint {
        position: 0.0,
        velocity: larger(first.velocity, last.velocity) + passed,
        acceleration,
        jerk,
        snap,
    };
    (range(&first, &last, bent * acceleration), most)
}

/// The largest distance of a curve from its chord for a second derivative of 1: an eighth of the `time` squared.
fn bent(time: f64) -> f64 {
    0.125 * time * time
}

/// The range between two places, extended by this distance (u) on both sides.
fn range(first: &Setpoint, last: &Setpoint, beyond: f64) -> (f64, f64) {
    (
        first.position.min(last.position) - beyond,
        first.position.max(last.position) + beyond,
    )
}

//! From points to nodes: estimates the derivatives that the points leave open, and integrates.
//!
//! Derivatives at a point are those of the polynomial through it and two neighbours on each side. The
//! start, points where the curve is level, and the end count as many times as derivatives are known there
//! (confluent divided differences), and the curve on one side does not depend on the other.

use super::{NODES, Node, PROFILE_POINTS, ProfileCause, ProfileFault, ProfileKind, ProfilePoint, SAME};
use crate::math::sqrt;
use crate::{Limits, Setpoint};

/// Neighbours and the point itself.
pub(crate) const STENCIL: usize = 5;

/// An acceleration fades out slower than it may by this factor; rounding takes far less.
const MARGIN: f64 = 1.0 + 1e-6;

/// The least length of a stretch in scans. In a shorter one nothing could change, and the fourth power of
/// its time would be lost.
const SHORTEST: f64 = 1e-9;

/// A value with its derivatives: all of them known, or, between anchors, still to be estimated.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Knot {
    pub time: f64,
    /// The value and its first three derivatives.
    pub value: [f64; 4],
    pub anchor: bool,
}

impl ProfileKind {
    /// Derivatives of the value that are continuous, up to the jerk.
    const fn known(self) -> usize {
        match self {
            Self::Position => 3,
            Self::Velocity => 2,
            Self::Acceleration => 1,
        }
    }

    /// The value and its derivatives at `node`.
    const fn of(self, node: &Node) -> [f64; 4] {
        match self {
            Self::Position => [node.position, node.velocity, node.acceleration, node.jerk],
            Self::Velocity => [node.velocity, node.acceleration, node.jerk, 0.0],
            Self::Acceleration => [node.acceleration, node.jerk, 0.0, 0.0],
        }
    }
}

/// Fills in the nodes; with `join` the start first loses its jerk and acceleration, if it can. Returns
/// the number of nodes, and how many of them come before the first one that is a point.
pub(super) fn fill(
    nodes: &mut [Node; NODES],
    kind: ProfileKind,
    start: &Setpoint,
    points: &[ProfilePoint],
    (limits, cycle): (&Limits, f64),
    join: bool,
) -> Result<(usize, usize), ProfileFault> {
    let begin = Node {
        time: 0.0,
        position: 0.0,
        velocity: start.velocity,
        acceleration: start.acceleration,
        jerk: start.jerk,
    };
    let first = points.iter().map(|point| point.time).find(|time| *time > 0.0);
    let (first, room) = (
        first.unwrap_or_default(),
        PROFILE_POINTS - points.len().min(PROFILE_POINTS),
    );
    let joined = if join {
        joined(&begin, kind, first, limits, cycle, room + 1)
    } else {
        None
    };
    let mut knots = [Knot::default(); NODES];
    let from = joined.map_or(begin, |([_, from], _)| from);
    let knotted = knots_of(
        &mut knots,
        kind,
        (start.position, &begin, &from),
        points,
        SHORTEST * cycle,
    )?;
    let mut slots = nodes.iter_mut();
    let mut count = 0;
    let mut put = |node: Node| {
        if let Some(slot) = slots.next() {
            *slot = node;
            count += 1;
        }
    };
    put(begin);
    if let Some((nodes, nodes_used)) = joined {
        nodes.into_iter().take(nodes_used).for_each(&mut put);
    }
    let mut end = from;
    for index in 1..knotted {
        let knot = estimated(&knots, knotted, index, kind);
        end = after(&end, &knot, kind);
        put(end);
    }
    if kind == ProfileKind::Acceleration && end.acceleration != 0.0 {
        let faded = faded(&end, limits, cycle);
        if faded.time > end.time {
            put(faded);
        }
    }
    Ok((count, 1 + joined.map_or(0, |(_, nodes_used)| nodes_used)))
}

/// The nodes where the jerk and then the acceleration of `begin` have faded out. This needs as much time
/// again up to the first point, at `first` (s), and room for the nodes.
///
/// The jerk fades with the whole snap, the acceleration then as at the end of a profile of accelerations.
fn joined(
    begin: &Node,
    kind: ProfileKind,
    first: f64,
    limits: &Limits,
    cycle: f64,
    room: usize,
) -> Option<([Node; 2], usize)> {
    if room < 2 {
        return None;
    }
    let time = (begin.jerk.abs() / limits.snap).max(cycle);
    let without_jerk = Node {
        time,
        position: time
            * (begin.velocity
                + time * (begin.acceleration / 2.0 + time * begin.jerk * (1.0 / 6.0 - 1.0 / 24.0))),
        velocity: begin.velocity + time * (begin.acceleration + time * begin.jerk * (1.0 / 2.0 - 1.0 / 6.0)),
        acceleration: begin.acceleration + time * begin.jerk / 2.0,
        jerk: 0.0,
    };
    if kind == ProfileKind::Acceleration {
        // It begins with the acceleration.
        return (2.0 * time <= first).then_some(([without_jerk; 2], 1));
    }
    let without_either = faded(&without_jerk, limits, cycle);
    let lies_ahead = without_either.time > time && 2.0 * without_either.time <= first;
    lies_ahead.then_some(([without_jerk, without_either], 2))
}

/// The begin of the curve, and the points after it, each more than `shortest` (s) after the one before.
fn knots_of(
    knots: &mut [Knot; NODES],
    kind: ProfileKind,
    (origin, begin, from): (f64, &Node, &Node),
    points: &[ProfilePoint],
    shortest: f64,
) -> Result<usize, ProfileFault> {
    let fault = |cause, point, value, limit| ProfileFault {
        cause,
        point,
        value,
        limit,
    };
    let most = PROFILE_POINTS as f64;
    if points.is_empty() || points.len() > PROFILE_POINTS {
        return Err(fault(ProfileCause::Count, 0, points.len() as f64, most));
    }
    let origin = match kind {
        ProfileKind::Position => origin,
        ProfileKind::Velocity | ProfileKind::Acceleration => 0.0,
    };
    let mut slots = knots.iter_mut();
    if let Some(first) = slots.next() {
        *first = Knot {
            time: from.time,
            value: kind.of(from),
            anchor: true,
        };
    }
    let (mut count, mut before) = (1, 0.0);
    for (index, point) in points.iter().enumerate() {
        let number = index + 1;
        if !point.value.is_finite() {
            return Err(fault(ProfileCause::Value, number, point.value, f64::NAN));
        }
        if index == 0 && point.time == 0.0 {
            let here = origin + kind.of(begin).first().copied().unwrap_or_default();
            if (point.value - here).abs() > SAME * (1.0 + point.value.abs() + here.abs()) {
                return Err(fault(ProfileCause::Start, number, point.value, here));
            }
            continue;
        }
        if !(point.time - before > shortest && point.time.is_finite()) {
            let least = if point.time > before { shortest } else { 0.0 };
            return Err(fault(ProfileCause::Time, number, point.time - before, least));
        }
        before = point.time;
        if let Some(slot) = slots.next() {
            *slot = Knot {
                time: point.time,
                value: [point.value - origin, 0.0, 0.0, 0.0],
                anchor: point.level || number == points.len(),
            };
            count += 1;
        }
    }
    if count < 2 {
        return Err(fault(ProfileCause::Count, 0, points.len() as f64, most));
    }
    Ok(count)
}

/// The knot `index` with its derivatives.
fn estimated(knots: &[Knot; NODES], count: usize, index: usize, kind: ProfileKind) -> Knot {
    let Some(knot) = knots.get(index).copied() else {
        return Knot::default();
    };
    if knot.anchor || index + 1 >= count {
        return knot;
    }
    // Two neighbours before and two behind; an anchor replaces all that is beyond it.
    let neighbour = |mut place: usize, step: isize| {
        let mut found = [knot; 2];
        for slot in &mut found {
            let held = knots.get(place).is_some_and(|knot| knot.anchor);
            if place == index || !held {
                place = place.saturating_add_signed(step);
            }
            *slot = knots.get(place).copied().unwrap_or(knot);
        }
        found
    };
    let ([before, earlier], [behind, later]) = (neighbour(index, -1), neighbour(index, 1));
    let [_, first, second, third] = taylor([earlier, before, knot, behind, later], knot.time);
    let mut value = [knot.value.first().copied().unwrap_or_default(), 0.0, 0.0, 0.0];
    let derivatives = [first, 2.0 * second, 6.0 * third];
    for (slot, derivative) in value.iter_mut().skip(1).zip(derivatives).take(kind.known()) {
        *slot = derivative;
    }
    Knot { value, ..knot }
}

/// The first four Taylor coefficients at `time` of the polynomial through the knots, of which equal ones share
/// derivatives.
pub(crate) fn taylor(knots: [Knot; STENCIL], time: f64) -> [f64; 4] {
    // Divided differences in place: after each round `table` holds those of one order more.
    let mut table = knots.map(|knot| knot.value.first().copied().unwrap_or_default());
    let mut newton = [0.0; STENCIL];
    for (order, slot) in newton.iter_mut().enumerate() {
        *slot = table.first().copied().unwrap_or_default();
        let mut next = table;
        let spans = knots.iter().zip(knots.iter().skip(order + 1));
        let values = table.iter().zip(table.iter().skip(1));
        for ((slot, (from, to)), (left, right)) in next.iter_mut().zip(spans).zip(values) {
            *slot = if from.time == to.time {
                // A span of time 0 is between an anchor and itself, twice at most.
                from.value.get(1).copied().unwrap_or_default()
            } else {
                (right - left) / (to.time - from.time)
            };
        }
        table = next;
    }
    // Horner's scheme on the Newton form, in powers of the distance from `time`.
    let mut series = [0.0; 4];
    for (knot, coefficient) in knots.iter().rev().zip(newton.into_iter().rev()) {
        let [zeroth, first, second, third] = series;
        let away = time - knot.time;
        series = [
            zeroth * away + coefficient,
            first * away + zeroth,
            second * away + first,
            third * away + second,
        ];
    }
    series
}

/// The node at `knot`, at which a stretch from `before` ends.
fn after(before: &Node, knot: &Knot, kind: ProfileKind) -> Node {
    let time = knot.time - before.time;
    let [value, first, second, third] = knot.value;
    match kind {
        ProfileKind::Position => Node {
            time: knot.time,
            position: value,
            velocity: first,
            acceleration: second,
            jerk: third,
        },
        // The integral of the polynomial of degree 5 that meets both.
        ProfileKind::Velocity => Node {
            time: knot.time,
            position: before.position
                + time
                    * ((before.velocity + value) / 2.0
                        + time
                            * ((before.acceleration - first) / 10.0 + time * (before.jerk + second) / 120.0)),
            velocity: value,
            acceleration: first,
            jerk: second,
        },
        // The integrals of the polynomial of degree 3 that meets both.
        ProfileKind::Acceleration => Node {
            time: knot.time,
            position: before.position
                + time
                    * (before.velocity
                        + time
                            * (0.35 * before.acceleration
                                + 0.15 * value
                                + time * (before.jerk / 20.0 - first / 30.0))),
            velocity: before.velocity
                + time * ((before.acceleration + value) / 2.0 + time * (before.jerk - first) / 12.0),
            acceleration: value,
            jerk: first,
        },
    }
}

/// The node at which the acceleration of `end` has faded to 0, no sooner than jerk and snap allow. Until then the
/// acceleration is a polynomial of degree 3, jerk and snap are at most 3 a / 2 T and 6 a / T^2, and it takes more
/// than a scan. Without bounds on both it is 0 at once.
fn faded(end: &Node, limits: &Limits, cycle: f64) -> Node {
    let size = end.acceleration.abs();
    let by_jerk = 1.5 * size / limits.jerk;
    let by_snap = sqrt(6.0 * size / limits.snap);
    let needed = by_jerk.max(by_snap) * MARGIN;
    let time = if needed > 0.0 { needed.max(cycle) } else { 0.0 };
    let knot = Knot {
        time: end.time + time,
        value: [0.0; 4],
        anchor: true,
    };
    after(end, &knot, ProfileKind::Acceleration)
}

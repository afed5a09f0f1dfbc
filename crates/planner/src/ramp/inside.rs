//! Getting a start state inside the limits at order 4, before the ramp proper.
//!
//! Until the state is inside, the larger ones of the old and the new limits hold. It takes the least time.
//! Everything is in the kernel's units and mirrored so that the velocity is not negative.

use super::path::{ROUNDING, zeros};
use crate::kernel::{Appended, Bounds, ON_LIMIT, Sides, Span, Spans, falling_root, second, second_in_three};
use crate::math::{max, min, sqrt};

/// A state in the kernel's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct State {
    pub(super) v: f64,
    pub(super) a: f64,
    pub(super) j: f64,
}

impl State {
    /// The state `t` later under constant snap `s`.
    pub(super) fn after(self, t: f64, s: f64) -> Self {
        Self {
            v: self.v + t * (self.a + t * (0.5 * self.j + t * (s / 6.0))),
            a: self.a + t * (self.j + t * (0.5 * s)),
            j: self.j + t * s,
        }
    }

    pub(super) fn after_all(self, spans: &[Span]) -> Self {
        spans
            .iter()
            .fold(self, |state, span| state.after(span.duration, span.input))
    }

    /// The same as [`State::after_all`] for spans that may include a long hold: as on a path, a jerk of zero is
    /// zero there.
    ///
    /// Otherwise a rounding error of the jerk would add up to an acceleration that is not small beside the lower
    /// bound.
    pub(super) fn led<const N: usize>(self, spans: &Spans<N>) -> Self {
        let (mut state, mut largest_jerk) = (self, 0.0);
        for span in spans.iter() {
            largest_jerk = max(state.j.abs(), largest_jerk);
            if span.input == 0.0 && state.j.abs() <= ROUNDING * largest_jerk {
                state.j = 0.0;
            }
            state = state.after(span.duration, span.input);
        }
        state
    }

    fn mirrored(self) -> Self {
        Self {
            v: -self.v,
            a: -self.a,
            j: -self.j,
        }
    }
}

/// Bounds at order 4 in the kernel's units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Box4 {
    /// Acceleration.
    pub(super) a: Sides,
    /// Magnitude of a falling velocity's acceleration until the state is inside; at least `a.minus`.
    pub(super) brake_before: f64,
    /// Jerk.
    pub(super) jerk: f64,
    /// Jerk until the state is inside; at least `jerk`.
    pub(super) jerk_before: f64,
    /// Snap until the state is inside, as a multiple of the snap bound; at least 1.
    pub(super) snap_before: f64,
    /// The velocity goes through zero afterwards, and `a.plus` holds from there on.
    pub(super) turns: bool,
}

impl Box4 {
    fn mirrored(self) -> Self {
        Self {
            a: self.a.mirrored(),
            ..self
        }
    }

    /// Mirrored for a velocity that goes through zero: until then, the force that brings it back is an
    /// acceleration.
    fn turned(&self) -> Self {
        Self {
            brake_before: self.a.plus,
            turns: false,
            ..self.mirrored()
        }
    }

    /// Whether the old limits allow a falling velocity more than the new ones.
    fn is_lowered(&self) -> bool {
        self.brake_before > self.a.minus || self.jerk_before > self.jerk || self.snap_before > 1.0
    }

    /// The largest jerk with which the acceleration may come inside from above: it must still be possible to stop
    /// it at zero, or a sooner entry would swing it to the other side (R14).
    fn entry_jerk(&self) -> f64 {
        self.jerk.min(sqrt(2.0 * self.a.plus))
    }
}

/// The part before the ramp proper, without its spans.
pub(super) struct Lead {
    /// The state after it.
    pub(super) state: State,
    /// The arrest from there.
    pub(super) arrest: [Span; 3],
    /// The velocity at the end of the arrest.
    pub(super) rest: f64,
    /// Largest number of root steps.
    pub(super) steps: u32,
}

impl Lead {
    /// No spans before the ramp proper from `state`.
    pub(super) fn none(state: State, jerk: f64) -> Self {
        let arrest = arrest(state, jerk);
        Self {
            state,
            rest: state.after_all(&arrest).v,
            arrest,
            steps: 0,
        }
    }

    /// Whether the state is inside the limits and viable, so that it needs nothing before the ramp proper. The
    /// velocity must be in `low ..= high`.
    pub(super) fn is_viable(&self, low: f64, high: f64, bounds: &Box4) -> bool {
        is_inside(self.state, bounds) && is_viable(self.state, self.rest, low, high, bounds)
    }

    /// Appends to `spans` the motion that brings a state that is not viable inside the limits, or as near to them
    /// as possible. The velocity must be in `range`, and on the ramp proper not below `low`.
    ///
    /// `own` are the bounds of the ramp proper, `bounds` those of the state.
    #[cold]
    pub(super) fn come_inside<const N: usize>(
        &mut self,
        spans: &mut Appended<'_, N>,
        goal: f64,
        (low, range): (f64, Sides),
        bounds: &Box4,
        own: &Bounds,
    ) {
        let high = range.plus;
        let state = self.state;
        // The resulting velocity may differ once acceleration and jerk are inside.
        let entered = arrested(state.led(&enter(state, bounds)), bounds.jerk);
        // It will leave the range on the other side of zero. This comes first, because the excess grows with every
        // delay.
        if bounds.is_lowered() && self.rest.min(entered) < -range.minus * (1.0 + ON_LIMIT) {
            let (first, steps) = hasten(state.mirrored(), range.minus, -goal, -high, &bounds.turned());
            self.add(spans, &first.mirrored(), steps, bounds.jerk);
            return;
        }
        if bounds.is_lowered() && state.v.max(self.rest).max(entered) > high * (1.0 + ON_LIMIT) {
            let (first, steps) = hasten(state, high, goal, low, bounds);
            self.add(spans, &first, steps, bounds.jerk);
            return;
        }
        self.add(spans, &enter(state, bounds), 0, bounds.jerk);
        let (next, steps) = relieve(self.state, self.rest, low, high, own);
        self.add(spans, &next, steps, bounds.jerk);
    }

    fn add<const N: usize, const M: usize>(
        &mut self,
        spans: &mut Appended<'_, N>,
        more: &Spans<M>,
        steps: u32,
        jerk: f64,
    ) {
        if !more.is_empty() {
            spans.extend(more.as_slice());
            *self = Self {
                steps: self.steps.max(steps),
                ..Self::none(self.state.led(more), jerk)
            };
        }
    }
}

/// Whether acceleration and jerk are inside their bounds.
fn is_inside(state: State, bounds: &Box4) -> bool {
    let on = 1.0 + ON_LIMIT;
    state.a <= bounds.a.plus * on && -state.a <= bounds.a.minus * on && state.j.abs() <= bounds.jerk * on
}

/// Whether the arrest from a state with jerk and acceleration inside keeps acceleration and velocity inside.
fn is_viable(state: State, rest: f64, low: f64, high: f64, bounds: &Box4) -> bool {
    let coming = state.a + 0.5 * state.j * state.j.abs();
    max(top(state, rest), state.v) <= high + slack(state, rest, high)
        && min(bottom(state, rest), state.v) >= low - slack(state, rest, depth(low, high))
        && coming <= bounds.a.plus * (1.0 + ON_LIMIT)
        && coming >= -bounds.a.minus * (1.0 + ON_LIMIT)
}

/// Largest number of spans of one rule of [`enter`].
const RULE_SPANS: usize = 3;

/// Largest number of spans of [`enter`]. A rule that follows another begins with the input with which that one
/// ended, so that in fact three are enough.
const ENTER_SPANS: usize = 2 * RULE_SPANS;

/// Largest number of spans of [`hasten`]: a push of three and a hold, then [`enter`].
const HASTEN_SPANS: usize = 4 + ENTER_SPANS;

/// Largest number of spans of a [`Lead`]: [`hasten`], or [`enter`] and [`relieve`].
pub(super) const LEAD_SPANS: usize = HASTEN_SPANS;

/// Each round settles acceleration, jerk or the future acceleration; no later one undoes an earlier one.
const ENTER_ROUNDS: usize = 3;

/// The spans that bring acceleration and jerk inside in least time (R13 to R16); none if they are inside.
pub(super) fn enter(state: State, bounds: &Box4) -> Spans<ENTER_SPANS> {
    let mut all = Spans::new();
    let mut state = state;
    for _ in 0..ENTER_ROUNDS {
        let step = [lower_acceleration, lower_jerk, avert_excess]
            .iter()
            .find_map(|rule| {
                rule(state, bounds)
                    .or_else(|| rule(state.mirrored(), &bounds.mirrored()).map(Spans::mirrored))
            });
        let Some(step) = step else { break };
        // Only rounding among absurd numbers gives such a long list; the ramp handles the rest.
        if all.len() > ENTER_SPANS - RULE_SPANS {
            break;
        }
        state = state.led(&step);
        all.extend(&step);
    }
    all
}

/// An acceleration above its bound comes down to it with [`Box4::entry_jerk`] (R14).
fn lower_acceleration(state: State, bounds: &Box4) -> Option<Spans<RULE_SPANS>> {
    let above = state.a > bounds.a.plus * (1.0 + ON_LIMIT);
    above.then(|| descend(state, bounds))
}

/// A jerk above its bound comes down to it (R13).
fn lower_jerk(state: State, bounds: &Box4) -> Option<Spans<RULE_SPANS>> {
    let above = state.j > bounds.jerk * (1.0 + ON_LIMIT);
    above.then(|| {
        let mut spans = Spans::new();
        let snap = bounds.snap_before;
        spans.push((state.j - bounds.jerk) / snap, -snap);
        spans
    })
}

/// If an acceleration will exceed its bound under the new snap, the old snap is used while it helps (R15, R16). If
/// the old one is no larger, the ramp itself does what is possible.
fn avert_excess(state: State, bounds: &Box4) -> Option<Spans<RULE_SPANS>> {
    let State { a, j, .. } = state;
    let snap = bounds.snap_before;
    let exceeds = j > 0.0 && a + 0.5 * j * j > bounds.a.plus * (1.0 + ON_LIMIT);
    if !exceeds || snap <= 1.0 {
        return None;
    }
    let square = (bounds.a.plus - a - j * j / (2.0 * snap)) / (0.5 - 0.5 / snap);
    if square < 0.0 {
        return Some(descend(state, bounds));
    }
    let mut spans = Spans::new();
    spans.push((j - sqrt(square)) / snap, -snap);
    Some(spans)
}

/// From an acceleration that is above its upper bound, or will be, down to it, ending at the entry jerk (R14).
fn descend(state: State, bounds: &Box4) -> Spans<RULE_SPANS> {
    let State { a, j, .. } = state;
    let (snap, entry) = (bounds.snap_before, bounds.entry_jerk());
    let drop = snap * (a - bounds.a.plus);
    let fastest = bounds.jerk_before.max(-j);
    let mut spans = Spans::new();
    if j >= -entry && j * j + 2.0 * drop <= entry * entry {
        // It is there before the jerk is.
        spans.push((j + sqrt((j * j + 2.0 * drop).max(0.0))) / snap, -snap);
    } else if j < -entry && 2.0 * drop <= j * j - entry * entry {
        // Too fast to slow down before: inside first, the jerk after.
        spans.push((-j - sqrt((j * j - 2.0 * drop).max(0.0))) / snap, snap);
    } else {
        let square = drop + 0.5 * (j * j + entry * entry);
        let peak = sqrt(square.max(0.0)).min(fastest);
        spans.push((j + peak) / snap, -snap);
        spans.push((square - peak * peak) / (snap * peak), 0.0);
        spans.push((peak - entry) / snap, snap);
    }
    spans
}

/// The spans under the old limits while the velocity is above `limit`, or will be. They push down, and return
/// inside the new acceleration and jerk exactly when the velocity is inside, too (R19).
///
/// They end sooner if the arrest then ends on `goal`, or if it then ends on `low` without exceeding `limit`. Also
/// returns the root steps.
fn hasten(state: State, limit: f64, goal: f64, low: f64, bounds: &Box4) -> (Spans<HASTEN_SPANS>, u32) {
    let snap = bounds.snap_before;
    let push = second(
        state.a / snap,
        state.j / snap,
        -bounds.brake_before / snap,
        Sides::both(bounds.jerk_before / snap),
    )
    .amplified(snap);
    let lead = |time: f64| {
        let mut spans = push.until::<HASTEN_SPANS>(time);
        spans.extend(&enter(state.led(&spans), bounds));
        spans
    };
    let above = |time: f64| {
        let state = state.led(&lead(time));
        let rest = arrested(state, bounds.jerk);
        let present = (state.v - limit).min(rest - goal);
        let to_come = (top(state, rest) - limit).min(rest - low);
        let inside = present.max(to_come);
        if bounds.turns && state.a < -bounds.a.plus {
            // It would be back at the acceleration of the other side before the velocity is inside.
            let release = second(state.a, state.j, -bounds.a.plus, Sides::both(bounds.jerk));
            inside.min(state.after_all(release.as_slice()).v)
        } else {
            inside
        }
    };
    let pushed = state.led(&push);
    let longest = push.duration() + (pushed.v - goal).max(0.0) / bounds.brake_before;
    let mut from = 0.0;
    for span in push.iter() {
        let to = from + span.duration;
        if above(to) <= 0.0 {
            let (time, steps) = falling_root(from, to, above);
            return (lead(time), steps);
        }
        from = to;
    }
    let (time, steps) = falling_root(from, longest, above);
    (lead(time), steps)
}

/// The spans that bring acceleration and jerk to zero as soon as possible.
fn arrest(state: State, jerk: f64) -> [Span; 3] {
    second_in_three(state.a, state.j, 0.0, Sides::both(jerk))
}

/// The velocity at which they end.
pub(super) fn arrested(state: State, jerk: f64) -> f64 {
    state.after_all(&arrest(state, jerk)).v
}

/// The spans that keep a velocity as near as possible to `low ..= high`, if a gentle arrest, ending at `rest`,
/// would take it out (R17, R18), and the root steps; none if it stays inside.
fn relieve(state: State, rest: f64, low: f64, high: f64, bounds: &Bounds) -> (Spans<4>, u32) {
    if (top(state, rest) - high).min(rest - low) > slack(state, rest, high) {
        push_down(state, low, high, bounds)
    } else if (low - bottom(state, rest)).min(high - rest) > slack(state, rest, depth(low, high)) {
        let (spans, steps) = push_down(state.mirrored(), -high, -low, &bounds.mirrored());
        (spans.mirrored(), steps)
    } else {
        (Spans::new(), 0)
    }
}

/// Largest distance outside a velocity `bound` that counts as on it.
fn slack(state: State, rest: f64, bound: f64) -> f64 {
    ON_LIMIT * min(max(rest.abs(), state.v.abs()), bound)
}

/// The magnitude of a lower velocity bound; for one at 0 that of the other one.
fn depth(low: f64, high: f64) -> f64 {
    if low < 0.0 { -low } else { high }
}

/// Pushes down until the arrest peaks at `high`. It ends at the latest when the acceleration is zero, because more
/// gains nothing, and before the arrest would end below `low`.
fn push_down(state: State, low: f64, high: f64, bounds: &Bounds) -> (Spans<4>, u32) {
    let push = second(state.a, state.j, -bounds.v.minus, bounds.a);
    let Some(longest) = falls_through_zero(state, &push) else {
        return (Spans::new(), 0);
    };
    let beyond = |time: f64| {
        let state = state.after_all(push.until::<4>(time).as_slice());
        let rest = arrested(state, bounds.a.plus);
        (top(state, rest) - high).min(rest - low)
    };
    let (time, steps) = if beyond(longest) >= 0.0 {
        (longest, 0)
    } else {
        falling_root(0.0, longest, beyond)
    };
    (push.until(time), steps)
}

/// The highest velocity of the arrest that ends at `rest`, if it is still to come.
fn top(state: State, rest: f64) -> f64 {
    let State { a, j, .. } = state;
    if a > 0.0 && j < 0.0 && a < 0.5 * j * j {
        // The jerk cannot be removed before the acceleration is negative (R17).
        let [zero, _] = zeros(a, j, 1.0);
        state.after(zero, 1.0).v
    } else if a > 0.0 || a + 0.5 * j * j.abs() > 0.0 {
        rest
    } else {
        f64::NEG_INFINITY
    }
}

/// The lowest velocity of the arrest that ends at `rest`, if it is still to come.
fn bottom(state: State, rest: f64) -> f64 {
    -top(state.mirrored(), -rest)
}

/// The time at which the acceleration passes zero downwards during `push`.
fn falls_through_zero(state: State, push: &Spans<3>) -> Option<f64> {
    let mut state = state;
    let mut begin = 0.0;
    for span in push.iter() {
        let zero = zeros(state.a, state.j, span.input)
            .into_iter()
            .find(|t| *t >= 0.0 && *t <= span.duration && state.j + span.input * *t < 0.0);
        if let Some(zero) = zero {
            return Some(begin + zero);
        }
        begin += span.duration;
        state = state.after(span.duration, span.input);
    }
    None
}

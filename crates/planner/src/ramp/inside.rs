//! Getting a start state inside the limits, before the ramp proper.
//!
//! Until it is inside, the larger ones of the old and the new limits hold, and the way takes the least time.
//! Everything is in the kernel's units and mirrored so that the velocity is not negative.

use super::path::zeros;
use crate::kernel::{ON_LIMIT, Sides, Spans, second};
use crate::math::sqrt;

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

    pub(super) fn after_all<const N: usize>(self, spans: &Spans<N>) -> Self {
        spans
            .iter()
            .fold(self, |state, span| state.after(span.duration, span.input))
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
    /// Jerk.
    pub(super) jerk: f64,
    /// Jerk until the state is inside; at least `jerk`.
    pub(super) jerk_before: f64,
    /// Snap until the state is inside, as a multiple of the snap bound; at least 1.
    pub(super) snap_before: f64,
}

impl Box4 {
    fn mirrored(self) -> Self {
        Self {
            a: self.a.mirrored(),
            ..self
        }
    }

    /// The largest jerk with which the acceleration may come in from above: it must still be possible to
    /// keep it above its lower bound (R14).
    fn entry_jerk(&self) -> f64 {
        self.jerk.min(sqrt(2.0 * (self.a.plus + self.a.minus)))
    }
}

/// Most spans of [`enter`].
pub(super) const ENTER_SPANS: usize = 6;

/// Each round settles acceleration, jerk or the acceleration to come; no later one undoes an earlier.
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
        state = state.after_all(&step);
        all.extend(&step);
    }
    all
}

/// An acceleration above its bound comes down to it with [`Box4::entry_jerk`] (R14).
fn lower_acceleration(state: State, bounds: &Box4) -> Option<Spans<3>> {
    let above = state.a > bounds.a.plus * (1.0 + ON_LIMIT);
    above.then(|| descend(state, bounds))
}

/// A jerk above its bound comes down to it (R13).
fn lower_jerk(state: State, bounds: &Box4) -> Option<Spans<3>> {
    let above = state.j > bounds.jerk * (1.0 + ON_LIMIT);
    above.then(|| {
        let mut spans = Spans::new();
        let snap = bounds.snap_before;
        spans.push((state.j - bounds.jerk) / snap, -snap);
        spans
    })
}

/// With an acceleration that will exceed its bound under the new snap, the old one is used while it helps
/// (R15, R16). Where the old one is no larger, the ramp itself does what can be done.
fn avert_excess(state: State, bounds: &Box4) -> Option<Spans<3>> {
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

/// From above (or bound to be above) the upper acceleration bound to it, ending at the entry jerk (R14).
fn descend(state: State, bounds: &Box4) -> Spans<3> {
    let State { a, j, .. } = state;
    let (snap, entry) = (bounds.snap_before, bounds.entry_jerk());
    let drop = snap * (a - bounds.a.plus);
    let fastest = bounds.jerk_before.max(-j);
    let mut spans = Spans::new();
    if j >= -entry && j * j + 2.0 * drop <= entry * entry {
        // There before the jerk is.
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

/// The spans that bring a falling or rising acceleration to zero soonest, if stopping it gently would take
/// the velocity further out of `low ..= high` than need be (R17, R18); none else.
pub(super) fn relieve(state: State, low: f64, high: f64, slack: f64, a: Sides, jerk: f64) -> Spans<3> {
    if state.a > 0.0 {
        relieve_top(state, high, slack, a, jerk)
    } else {
        relieve_top(state.mirrored(), -low, slack, a.mirrored(), jerk).mirrored()
    }
}

fn relieve_top(state: State, high: f64, slack: f64, a: Sides, jerk: f64) -> Spans<3> {
    let mut spans = Spans::new();
    let returns = state.a > 0.0 && state.j < 0.0 && state.a < 0.5 * state.j * state.j;
    if !returns {
        return spans;
    }
    let [gentle, _] = zeros(state.a, state.j, 1.0);
    if state.after(gentle, 1.0).v <= high + slack {
        return spans;
    }
    let push = second(state.a, state.j, -a.minus, Sides::both(jerk));
    let mut state = state;
    for span in push.iter() {
        let end = state.after(span.duration, span.input);
        if end.a > 0.0 {
            spans.push(span.duration, span.input);
            state = end;
            continue;
        }
        let zero = zeros(state.a, state.j, span.input)
            .into_iter()
            .filter(|t| *t >= 0.0 && *t <= span.duration)
            .fold(span.duration, f64::min);
        spans.push(zero, span.input);
        break;
    }
    spans
}

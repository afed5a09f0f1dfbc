//! Third order: `(x, v, a)` to `(target, 0, 0)` in least time.

use super::root::{Intercept, Rising};
use super::second::second_in_three;
use super::{Appended, NOISE, Sides, Span, Spans, raised_to};
use crate::math::{max, min, sqrt};

/// Largest number of spans of a [`third`] profile: three of the push, a cruise, three of the stop.
pub const THIRD_SPANS: usize = 7;

/// Bounds of a third-order problem; the input bound is 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Bounds on `v`, the derivative of the value.
    pub v: Sides,
    /// Bounds on `a`, the derivative of `v`.
    pub a: Sides,
}

impl Bounds {
    /// The bounds of the mirrored problem.
    pub const fn mirrored(self) -> Self {
        Self {
            v: self.v.mirrored(),
            a: self.a.mirrored(),
        }
    }
}

/// The result of [`third`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Profile {
    /// The spans in order of time.
    pub spans: Spans<THIRD_SPANS>,
    /// Steps of root finding, at most [`MAX_STEPS`](super::MAX_STEPS); 0 for a closed form.
    pub steps: u32,
}

/// `x`, `v` and `a` at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
struct State {
    x: f64,
    v: f64,
    a: f64,
}

impl State {
    /// The state `t` later under the constant input `u`.
    fn after(self, t: f64, u: f64) -> Self {
        Self {
            x: self.x + t * (self.v + t * (0.5 * self.a + t * (u / 6.0))),
            v: self.v + t * (self.a + t * (0.5 * u)),
            a: self.a + t * u,
        }
    }

    fn after_all(self, spans: &[Span]) -> Self {
        spans
            .iter()
            .fold(self, |state, span| state.after(span.duration, span.input))
    }
}

/// The least-time spans from `(x, v, a)` to `(target, 0, 0)`.
///
/// The start `(v, a)` may be any state, also one outside `bounds`; it is then brought inside first. Bounded work:
/// closed forms, or one root of at most [`MAX_STEPS`](super::MAX_STEPS) steps (R4 to R10).
pub fn third(x: f64, v: f64, a: f64, target: f64, bounds: &Bounds) -> Profile {
    let mut spans = Spans::new();
    let stop = second_in_three(v, a, 0.0, bounds.a);
    let gap = target - x - State { x: 0.0, v, a }.after_all(&stop).x;
    let steps = append_third(&mut spans.towards(1.0), (&stop, gap), (x, v, a), target, bounds);
    Profile { spans, steps }
}

/// Appends the spans of [`third`] to `spans`, with a known fastest `stop`: the path from `(v, a)` to `(0, 0)`,
/// which ends short of the target by the `gap`. Returns the steps of root finding.
pub(crate) fn append_third<const N: usize>(
    spans: &mut Appended<'_, N>,
    (stop, gap): (&[Span; 3], f64),
    (x, v, a): (f64, f64, f64),
    target: f64,
    bounds: &Bounds,
) -> u32 {
    let distance = target - x;
    let start = State { x: 0.0, v, a };
    let t = stop.iter().map(|span| span.duration).sum();
    // The input changes `a` by at most twice its bound, for any duration of the stop.
    let changed = min(t, a.abs() + 2.0 * max(bounds.a.plus, bounds.a.minus));
    let added_up = x.abs() + target.abs() + t * (v.abs() + t * (a.abs() + changed));
    if gap.abs() <= NOISE * added_up {
        spans.extend(stop);
        0
    } else if gap > 0.0 {
        push_up(spans, distance, start, bounds)
    } else {
        let mirrored = State { x: 0.0, v: -v, a: -a };
        push_up(&mut spans.mirrored(), -distance, mirrored, &bounds.mirrored())
    }
}

/// The growth of the integral of the value along the spans of [`third`] to zero, for each unit of `a` more at their
/// start (O21).
///
/// It is computed back in time from the end. Where the input switches, a change of `a` has no effect, because the
/// switch moves with it.
pub(crate) fn gain(spans: &[Span]) -> f64 {
    // The spans that finally bring `a` to zero.
    let (push, hold, release) = match spans {
        [.., push, hold, release] if hold.input == 0.0 => (push.duration, hold.duration, release.duration),
        [.., push, release] => (push.duration, 0.0, release.duration),
        _ => return 0.0,
    };
    // A start on a bound returns to it.
    if spans.first().is_some_and(|first| first.input == 0.0) {
        return 0.0;
    }
    let stop = hold + release;
    let x = -(0.5 * stop * (stop + push) + (push * push - release * release) / 6.0)
        / (hold + 0.5 * (push + release));
    let mut gains = Gains {
        x,
        v: between_switches(release, x),
        a: 0.0,
    };
    let mut next_input = 0.0;
    let mut earlier = spans.iter().rev().skip(1);
    for span in spans.iter().rev() {
        gains.a = 0.0;
        match earlier.next() {
            // `v` is on its bound: an earlier change of it has no later effect.
            Some(before) if span.input == 0.0 && before.input == next_input => {
                gains.x += span.duration;
                gains.v = between_switches(before.duration, gains.x);
            }
            _ => gains.back(span.duration),
        }
        next_input = span.input;
    }
    max(gains.a, 0.0)
}

/// The growth of an integral for each unit of the value, of `v` and of `a` at one instant.
struct Gains {
    x: f64,
    v: f64,
    a: f64,
}

impl Gains {
    /// The same at an instant `t` earlier.
    fn back(&mut self, t: f64) {
        self.a += t * (self.v + t * (0.5 * self.x + t / 6.0));
        self.v += t * (self.x + 0.5 * t);
        self.x += t;
    }
}

/// The gain of `v` at the end of a span of duration `t` with a switch at both ends; `x` is the gain of the value.
fn between_switches(t: f64, x: f64) -> f64 {
    -t * (0.5 * x + t / 6.0)
}

impl<const N: usize> Appended<'_, N> {
    /// The downward stop from `a` whose squared depth without a bound is `drop` (R5).
    fn stop(&mut self, a: f64, drop: f64, brake: f64) {
        if drop > brake * brake {
            self.push(a + brake, -1.0);
            self.push((drop - brake * brake) / brake, 0.0);
            self.push(brake, 1.0);
        } else {
            let depth = sqrt(max(drop, 0.0));
            self.push(a + depth, -1.0);
            self.push(depth, 1.0);
        }
    }
}

/// The case in which the fastest stop ends short of `distance`: push towards the upper bound of `v`, then stop.
/// Returns the steps of root finding.
///
/// The end position of the stop grows only while the push raises `a` or holds it above zero (R6). So the search
/// uses those spans alone. The first one from whose end the stop ends beyond the target has the root.
fn push_up<const N: usize>(spans: &mut Appended<'_, N>, distance: f64, start: State, bounds: &Bounds) -> u32 {
    let brake = bounds.a.minus;
    let arrest = start.v + 0.5 * start.a * start.a.abs();
    let top = raised_to(arrest, bounds.v.plus);
    let push = second_in_three(start.v, start.a, top, bounds.a);
    let mut state = start;
    for span in push.iter().filter(|span| span.duration > 0.0) {
        let end = state.after(span.duration, span.input);
        let grows = span.input > 0.0 || (span.input == 0.0 && state.a > 0.0);
        // A stop that starts upwards first continues the push: nothing grows yet (R6).
        let stops_downwards = end.v + 0.5 * end.a * end.a.abs() > 0.0;
        if grows && stops_downwards && end.x + stopping_distance(end, brake) >= distance {
            return intercept(spans, distance - state.x, state, *span, brake);
        }
        spans.push(span.duration, span.input);
        state = end;
    }
    let cruise = distance - state.x - stopping_distance(state, brake);
    spans.push(cruise / top, 0.0);
    spans.stop(0.0, top, brake);
    0
}

/// Ends the push inside a `span` that starts at `state`, such that the stop ends `left` further. Returns the steps
/// of root finding.
fn intercept<const N: usize>(
    spans: &mut Appended<'_, N>,
    left: f64,
    state: State,
    span: Span,
    brake: f64,
) -> u32 {
    if span.input > 0.0 {
        let Intercept { a, drop, steps } =
            Rising::new(left, state.v, state.a, brake).solve(state.a + span.duration);
        spans.push(a - state.a, 1.0);
        spans.stop(a, drop, brake);
        steps
    } else {
        let a = state.a;
        let highest = state.v + a * span.duration + 0.5 * a * a;
        let lowest = state.v + 0.5 * a * a;
        let drop = max(min(holding(left, state.v, a, brake), highest), lowest);
        spans.push((drop - lowest) / a, 0.0);
        spans.stop(a, drop, brake);
        0
    }
}

/// The distance by which the downward stop from `state` moves the value (R5).
fn stopping_distance(state: State, brake: f64) -> f64 {
    let State { v, a, .. } = state;
    let drop = v + 0.5 * a * a;
    a * (drop - a * a / 6.0) + depth_term(max(drop, 0.0), brake)
}

/// The part of the stopping distance that depends on `drop` alone (R5).
pub(super) fn depth_term(drop: f64, brake: f64) -> f64 {
    if drop > brake * brake {
        drop * (drop + brake * brake) / (2.0 * brake)
    } else {
        drop * sqrt(drop)
    }
}

/// `drop` at the end of a hold of `a > 0` that started at `v`, if the stop then ends `left` further (R8).
fn holding(left: f64, v: f64, a: f64, brake: f64) -> f64 {
    let budget = max(left + v * v / (2.0 * a) + a * a * a / 24.0, 0.0);
    let product = sqrt(2.0 * a * budget);
    let depth = 2.0 * product / (a + sqrt(a * a + 4.0 * product));
    if depth <= brake {
        return depth * depth;
    }
    let linear = a * brake;
    let constant = 2.0 * linear * budget / (a + brake);
    2.0 * constant / (linear + sqrt(linear * linear + 4.0 * constant))
}

#[cfg(test)]
mod tests {
    use super::*;
    use standstill_testkit::{Random, cases};
    use std::collections::BTreeSet;
    use std::vec::Vec;

    /// The integral of the value along `spans`.
    fn integral(start: State, spans: &[Span]) -> f64 {
        let (mut state, mut sum) = (start, 0.0);
        for span in spans {
            let t = span.duration;
            sum += t * (state.x + t * (state.v / 2.0 + t * (state.a / 6.0 + t * span.input / 24.0)));
            state = state.after(t, span.input);
        }
        sum
    }

    #[test]
    fn a_gain_is_the_slope_of_the_integral() {
        let mut random = Random(3);
        let mut shapes = BTreeSet::new();
        for case in 0..cases(60_000) {
            let sides = |random: &mut Random| Sides {
                minus: random.log(0.1, 10.0),
                plus: random.log(0.1, 10.0),
            };
            let bounds = Bounds {
                v: sides(&mut random),
                a: Sides::both(random.log(0.1, 10.0)),
            };
            let a = random.between(-1.0, 1.0) * bounds.a.plus;
            let v = random.between(-bounds.v.minus, bounds.v.plus);
            let x = random.sign() * random.log(1e-3, 1e2);
            let settled = v + 0.5 * a * a.abs();
            if settled > bounds.v.plus || settled < -bounds.v.minus {
                continue;
            }
            let spans_from = |a: f64| third(x, v, a, 0.0, &bounds).spans;
            let shape = |spans: &Spans<THIRD_SPANS>| -> Vec<i8> {
                spans.iter().map(|span| span.input as i8).collect()
            };
            let (spans, step) = (spans_from(a), 1e-6 * a.abs());
            let (more, less) = (spans_from(a + step), spans_from(a - step));
            // Where the shape changes, the slope bends.
            if shape(&more) != shape(&spans) || shape(&less) != shape(&spans) {
                continue;
            }
            let of = |a: f64, spans: &Spans<THIRD_SPANS>| integral(State { x, v, a }, spans.as_slice());
            let slope = (of(a + step, &more) - of(a - step, &less)) / (2.0 * step);
            let longest = spans.duration();
            let off =
                (gain(spans.as_slice()) - slope).abs() / (slope.abs() + 1e-3 * longest * longest * longest);
            assert!(off < 1e-4, "case {case}: {spans:?}, {slope}");
            shapes.insert(shape(&spans));
        }
        assert_eq!(shapes.len(), 16, "{shapes:?}");
    }
}

//! A motion as a list of polynomial pieces, its values and its extremes.

use crate::kernel::{Spans, falling_root};
use crate::math::{max, sqrt};
use crate::{Order, Segment, Setpoint};

/// What a jerk of zero may be off by, relative to the largest one before.
pub(super) const ROUNDING: f64 = 64.0 * f64::EPSILON;

/// What an acceleration that is held at zero may be off by, relative to the largest one before. It is held
/// either there or at a bound, which may be as small beside a much larger one.
const CRUISING: f64 = 1e-10;

/// By how much, relative to itself, the time of a boundary added up from spans may be off.
const SAME_TIME: f64 = 16.0 * f64::EPSILON;

/// How far beyond its ends a piece goes on, relative to its duration: no limit is exceeded by more than that.
const BEYOND: f64 = 1.0 / (1_u64 << 40) as f64;

/// The latest instant that may be `boundary`.
fn latest(boundary: f64) -> f64 {
    boundary * (1.0 + SAME_TIME)
}

/// A stretch of constant snap (order 4), jerk (3) or acceleration (2).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Piece {
    /// How long it lasts (s). It is kept, because the difference of two ends would have few digits left of a short
    /// piece late in a plan.
    duration: f64,
    /// The state at its start, of the last piece at its end.
    state: Setpoint,
}

/// The times of a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Place {
    /// Start and end; the end is part of the piece (s).
    begin: f64,
    end: f64,
    /// The instant of its state (s).
    anchor: f64,
    /// The times of the piece relative to that instant (s).
    from: f64,
    to: f64,
}

impl Place {
    /// The time from its anchor (s). It is inside the piece except for [`BEYOND`]: a time that rounding puts
    /// further outside is not part of the piece.
    #[inline(always)]
    fn since(&self, time: f64) -> f64 {
        (time - self.anchor).max(self.from).min(self.to)
    }
}

/// The piece that a motion is in.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Current {
    place: Place,
    course: Course,
    /// The end of the last piece (s). The copy here is at hand more often than the pieces.
    duration: f64,
}

impl Current {
    /// No piece: it ends before it begins.
    const NONE: Self = Self {
        place: Place {
            begin: 0.0,
            end: 0.0,
            anchor: 0.0,
            from: 0.0,
            to: 0.0,
        },
        course: Course {
            state: Setpoint::at_rest(0.0),
            sixth_of_jerk: 0.0,
            sixth_of_snap: 0.0,
            part_of_snap: 0.0,
        },
        duration: 0.0,
    };
}

/// A state, and the divided coefficients of its course at constant snap.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Course {
    state: Setpoint,
    sixth_of_jerk: f64,
    sixth_of_snap: f64,
    part_of_snap: f64,
}

impl Course {
    #[inline]
    fn of(state: Setpoint) -> Self {
        Self {
            state,
            sixth_of_jerk: state.jerk / 6.0,
            sixth_of_snap: state.snap / 6.0,
            part_of_snap: state.snap / 24.0,
        }
    }

    /// The state `t` seconds later (R21).
    #[inline(always)]
    fn after(&self, t: f64) -> Setpoint {
        let Setpoint {
            position: p,
            velocity: v,
            acceleration: a,
            jerk: j,
            snap: s,
        } = self.state;
        Setpoint {
            position: p + t * (v + t * (a / 2.0 + t * (self.sixth_of_jerk + t * self.part_of_snap))),
            velocity: v + t * (a + t * (j / 2.0 + t * self.sixth_of_snap)),
            acceleration: a + t * (j + t * (s / 2.0)),
            jerk: j + t * s,
            snap: s,
        }
    }
}

/// At most `N` pieces that follow each other from a start state.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Path<const N: usize> {
    /// The piece that [`Path::next`] used last.
    current: Current,
    pieces: [Piece; N],
    len: usize,
    order: Order,
}

impl<const N: usize> Path<N> {
    /// No pieces.
    pub(crate) const fn new(order: Order) -> Self {
        const EMPTY: Piece = Piece {
            duration: 0.0,
            state: Setpoint::at_rest(0.0),
        };
        Self {
            current: Current::NONE,
            pieces: [EMPTY; N],
            len: 0,
            order,
        }
    }

    /// Puts `spans` of (seconds, highest derivative) one after the other from `start`, without a fixed end; spans
    /// that do not fit are left out. `bound` is the lowest bound of acceleration (u/s^2).
    pub(crate) fn follow(
        order: Order,
        start: &Setpoint,
        bound: f64,
        spans: impl Iterator<Item = (f64, f64)>,
    ) -> Self {
        let mut path = Self::new(order);
        path.fill(start, bound, spans);
        path
    }

    /// The same as [`Path::follow`], on a path without pieces yet. The last piece is stored by the state at its
    /// end, which is returned.
    pub(crate) fn fill(
        &mut self,
        start: &Setpoint,
        bound: f64,
        spans: impl Iterator<Item = (f64, f64)>,
    ) -> Setpoint {
        let mut way = Way::new(self.order, start, bound);
        for (duration, input) in spans {
            let state = way.begin(input);
            if duration > 0.0
                && let Some(piece) = self.pieces.get_mut(self.len)
            {
                *piece = Piece { duration, state };
                self.len += 1;
            }
            way.go(duration);
        }
        let order = self.order;
        if let Some(last) = self.last_mut() {
            // Its own input: that of `way` may be that of a span of no length.
            let input = match order {
                Order::Four => last.state.snap,
                Order::Three => last.state.jerk,
                Order::Two => last.state.acceleration,
            };
            last.state = with_input(&way.state, order, input);
        }
        way.state
    }

    /// Makes the end exactly `velocity`, so that the last piece approaches it from one side, without a rounding
    /// error that would pass it.
    pub(crate) fn pin(&mut self, velocity: f64) {
        self.pin_both(velocity, 0.0);
    }

    /// The same as [`Path::pin`], with an `acceleration` at the end; it is not used at order 2.
    pub(crate) fn pin_both(&mut self, velocity: f64, acceleration: f64) {
        let order = self.order;
        if let Some(last) = self.last_mut() {
            let is_even = last.state.snap == 0.0 && last.state.jerk == 0.0 && last.state.acceleration == 0.0;
            if is_even {
                // The difference would step the position where a long cruise begins, so it is added to the end.
                last.state.position += (velocity - last.state.velocity) * last.duration;
            }
            last.state.velocity = velocity;
            if order >= Order::Three {
                last.state.acceleration = acceleration;
            }
            if order == Order::Four {
                last.state.jerk = 0.0;
            }
        }
    }

    fn last_mut(&mut self) -> Option<&mut Piece> {
        self.len.checked_sub(1).and_then(|i| self.pieces.get_mut(i))
    }

    /// Moves every position by `by` (u).
    pub(crate) fn shift(&mut self, by: f64) {
        for piece in &mut self.pieces {
            piece.state.position += by;
        }
        self.current = Current::NONE;
    }

    /// The end of the last piece (s).
    pub(crate) fn duration(&self) -> f64 {
        self.pieces
            .iter()
            .take(self.len)
            .fold(0.0, |time, piece| time + piece.duration)
    }

    /// Position at the end of the last piece.
    pub(crate) fn end_position(&self) -> Option<f64> {
        self.last().map(|piece| piece.state.position)
    }

    fn last(&self) -> Option<&Piece> {
        self.len.checked_sub(1).and_then(|i| self.pieces.get(i))
    }

    /// The state at `time` (s) after the start; at the boundary of two pieces that of the earlier one, even if
    /// rounding puts the boundary before `time`: of two motions that switch together none then switches a scan
    /// early.
    #[inline]
    pub(crate) fn at(&self, time: f64) -> Option<Setpoint> {
        self.place(time)
            .map(|(piece, place)| moved(&piece.state, place.since(time)))
    }

    /// The same as [`Path::at`], with the elapsed part of the whole duration, for repeated calls with times above 0
    /// that are close together: the piece is searched only where it changes.
    #[inline(always)]
    pub(crate) fn next(&mut self, time: f64) -> Option<(Setpoint, f64)> {
        if !self.is_current(time) {
            self.current = self.piece_at(time)?;
        }
        Some(self.on_current(time))
    }

    /// Whether `time` (s) is in the piece that [`Path::next`] used last.
    #[inline(always)]
    pub(crate) fn is_current(&self, time: f64) -> bool {
        time > self.current.place.begin && time <= self.current.place.end
    }

    /// The state at a `time` (s) of that piece, and the elapsed part of the whole duration.
    #[inline(always)]
    pub(crate) fn on_current(&self, time: f64) -> (Setpoint, f64) {
        let current = &self.current;
        (
            current.course.after(current.place.since(time)),
            time / current.duration,
        )
    }

    #[inline(never)]
    fn piece_at(&self, time: f64) -> Option<Current> {
        self.place(time).map(|(piece, place)| Current {
            place,
            course: Course::of(piece.state),
            duration: self.duration(),
        })
    }

    /// The piece of `time` (s), and its times; at most as many comparisons as there are pieces.
    #[inline]
    fn place(&self, time: f64) -> Option<(&Piece, Place)> {
        let mut begin = 0.0;
        for (index, piece) in self.pieces.iter().take(self.len).enumerate() {
            let end = begin + piece.duration;
            if time <= latest(end) {
                let slack = BEYOND * piece.duration;
                let (anchor, from, to) = if index + 1 == self.len {
                    (end, -piece.duration - slack, slack)
                } else {
                    (begin, -slack, piece.duration + slack)
                };
                let place = Place {
                    begin: latest(begin),
                    end: latest(end),
                    anchor,
                    from,
                    to,
                };
                return Some((piece, place));
            }
            begin = end;
        }
        None
    }

    /// Every piece, and the state at its start.
    fn stretches(&self) -> impl Iterator<Item = (Stretch, Setpoint)> {
        let pieces = self.pieces.iter().take(self.len).enumerate();
        pieces.map(move |(index, piece)| {
            let stretch = Stretch {
                duration: piece.duration,
                is_last: index + 1 == self.len,
                state: piece.state,
            };
            let first = stretch.at(0.0);
            (stretch, first)
        })
    }

    /// Every piece by the derivatives at its start.
    pub(crate) fn segments(&self) -> impl Iterator<Item = Segment> {
        self.stretches()
            .map(|(stretch, first)| Segment::of(stretch.duration, &first))
    }

    /// The states that have every extreme of velocity, acceleration and jerk: the ends of each piece, and inside it
    /// the zeros of jerk and acceleration (R20).
    ///
    /// With each comes the velocity that gives its direction: its own, or if that is no more than `small`, that of
    /// the other end of the piece. `see` also receives the states at which the velocity passes zero, from beyond
    /// `small` to beyond it on the other side. Those have no direction, because the bounds of acceleration change
    /// there.
    pub(crate) fn extremes(&self, small: f64, mut see: impl FnMut(&Setpoint, Option<f64>)) {
        for (stretch, first) in self.stretches() {
            let length = stretch.duration;
            let state = |time: f64| stretch.at(time);
            let within = |time: f64| if time > 0.0 && time < length { time } else { length };
            let last = state(length).velocity;
            let or = |velocity: f64, other: f64| if velocity.abs() > small { velocity } else { other };
            let inside = |state: &Setpoint| Some(or(state.velocity, or(first.velocity, last)));
            see(&first, Some(or(first.velocity, last)));
            let flat = within(-first.jerk / first.snap);
            if flat < length {
                let state = state(flat);
                see(&state, inside(&state));
            }
            let [early, late] = zeros(first.acceleration, first.jerk, first.snap).map(within);
            let (mut from, mut low) = (0.0, first);
            for to in [early.min(late), early.max(late), length] {
                if to <= from {
                    continue;
                }
                let high = state(to);
                see(&high, inside(&high));
                let sign = low.velocity.signum();
                if sign * low.velocity > small && -sign * high.velocity > small {
                    let (time, _) = falling_root(from, to, |t| sign * state(t).velocity);
                    see(&state(time), None);
                }
                (from, low) = (to, high);
            }
        }
    }

    /// Whether the velocity towards `side` (1 or -1) never falls below `-small`.
    pub(crate) fn keeps_side(&self, side: f64, small: f64) -> bool {
        self.stretches().all(|(stretch, first)| {
            let length = stretch.duration;
            let within = |time: f64| if time > 0.0 && time < length { time } else { length };
            let [one, other] = zeros(first.acceleration, first.jerk, first.snap).map(within);
            [0.0, one, other, length]
                .into_iter()
                .all(|time| side * moved(&first, time).velocity >= -small)
        })
    }

    /// Whether no extreme of velocity, acceleration and jerk is beyond these bounds, except for rounding. If FALSE,
    /// [`Path::extremes`] gives the values.
    pub(crate) fn is_surely_within(&self, velocity: f64, acceleration: f64, jerk: f64) -> bool {
        let within = |v: f64, a: f64| v.abs() <= velocity && a.abs() <= acceleration;
        let pieces = self.pieces.get(..self.len).unwrap_or_default();
        let Some(last) = pieces.last() else {
            return false;
        };
        // The last piece is stored by the state at its end. Differences by rounding do not matter here.
        let (begin_of_last, end) = (moved(&last.state, -last.duration), &last.state);
        let mut rest = pieces;
        while let [piece, behind @ ..] = rest {
            let (first, last, anchor) = match behind {
                [] => (&begin_of_last, end, piece.duration),
                [_] => (&piece.state, &begin_of_last, 0.0),
                [next, ..] => (&piece.state, &next.state, 0.0),
            };
            let Setpoint {
                velocity: v,
                acceleration: a,
                jerk: j,
                snap: s,
                ..
            } = *first;
            // The extreme acceleration inside, and the velocity where the acceleration passes zero.
            let turns = s != 0.0 && j * last.jerk < 0.0;
            let peak = if turns { a - j * j / (2.0 * s) } else { a };
            let passes = a * peak < 0.0 || peak * last.acceleration < 0.0;
            let top_is_within = |time: f64| {
                let is_inside = time > 0.0 && time < piece.duration;
                !is_inside || within(moved(&piece.state, time - anchor).velocity, peak)
            };
            let is_within = within(v, a) && within(v, peak) && j.abs() <= jerk;
            if !is_within || passes && !zeros(a, j, s).into_iter().all(top_is_within) {
                return false;
            }
            rest = behind;
        }
        within(end.velocity, end.acceleration) && end.jerk.abs() <= jerk
    }

    pub(crate) const fn order(&self) -> Order {
        self.order
    }
}

/// A state that follows spans one after the other.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Way {
    pub(crate) state: Setpoint,
    order: Order,
    /// The lowest bound of acceleration.
    bound: f64,
    largest_acceleration: f64,
    largest_jerk: f64,
}

impl Way {
    /// Starts at `start`; `bound` is the lowest bound of acceleration.
    pub(crate) const fn new(order: Order, start: &Setpoint, bound: f64) -> Self {
        Self {
            state: *start,
            order,
            bound,
            largest_acceleration: 0.0,
            largest_jerk: 0.0,
        }
    }

    /// The state at the start of a span in which the highest derivative is `input`.
    pub(crate) fn begin(&mut self, input: f64) -> Setpoint {
        self.state = with_input(&self.state, self.order, input);
        // A rounding error of a derivative that is held at zero would be integrated over a long hold.
        let Setpoint {
            acceleration, jerk, ..
        } = &mut self.state;
        self.largest_acceleration = max(acceleration.abs(), self.largest_acceleration);
        self.largest_jerk = max(jerk.abs(), self.largest_jerk);
        if input == 0.0 && jerk.abs() <= ROUNDING * self.largest_jerk {
            *jerk = 0.0;
            if acceleration.abs() <= (CRUISING * self.largest_acceleration).min(0.5 * self.bound) {
                *acceleration = 0.0;
            }
        }
        self.state
    }

    /// Follows all of `spans`.
    pub(crate) fn follow<const N: usize>(&mut self, spans: &Spans<N>) {
        for span in spans.iter() {
            self.begin(span.input);
            self.go(span.duration);
        }
    }

    /// Follows the span begun for `duration`.
    pub(crate) fn go(&mut self, duration: f64) {
        self.state = moved(&self.state, duration);
    }
}

/// A piece on its own.
struct Stretch {
    /// Its duration (s).
    duration: f64,
    is_last: bool,
    state: Setpoint,
}

impl Stretch {
    /// The state `time` (s) after its start.
    fn at(&self, time: f64) -> Setpoint {
        if self.is_last {
            moved(&self.state, time - self.duration)
        } else {
            moved(&self.state, time)
        }
    }
}

/// `state` with `input` as the derivative that `order` holds constant, and none above it.
pub(crate) fn with_input(state: &Setpoint, order: Order, input: f64) -> Setpoint {
    match order {
        Order::Four => Setpoint {
            snap: input,
            ..*state
        },
        Order::Three => Setpoint {
            jerk: input,
            snap: 0.0,
            ..*state
        },
        Order::Two => Setpoint {
            acceleration: input,
            jerk: 0.0,
            snap: 0.0,
            ..*state
        },
    }
}

/// The state `t` seconds later at constant snap (R21).
pub(crate) fn moved(state: &Setpoint, t: f64) -> Setpoint {
    Course::of(*state).after(t)
}

/// The zeros of `a + j t + s t^2/2`, in the form that loses no digits; NaN or infinite where there is none.
pub(crate) fn zeros(a: f64, j: f64, s: f64) -> [f64; 2] {
    if s == 0.0 {
        return [-a / j, f64::INFINITY];
    }
    let root = sqrt(j * j - 2.0 * a * s);
    // If j is zero, s decides: the mirrored piece has the same zeros to the last bit.
    let rises = j > 0.0 || (j == 0.0 && s > 0.0);
    let sum = if rises { j + root } else { j - root };
    [-2.0 * a / sum, -sum / s]
}

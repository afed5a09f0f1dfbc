//! The spans of a ramp at each order, in the kernel's units.

use super::inside::{self, Box4, LEAD_SPANS, Lead, State};
use super::slope::{Box3, Slope};
use super::turn::TURN_SPANS;
use crate::kernel::{
    Bounds, ON_LIMIT, Profile, Scale, Sides, Spans, append_third, gain, second_in_three, third,
};
use crate::{DirectedLimits, Order, Setpoint};

/// Largest number of spans of a ramp: getting inside the limits, then a ramp that may turn.
pub(crate) const RAMP_SPANS: usize = LEAD_SPANS + TURN_SPANS;

/// The freedom of a ramp to change the sign of the velocity.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Course {
    /// Keep the sign if possible: a stop should not turn back.
    Kept,
    /// Anything: the ramp is part of a move to a position.
    Free,
}

/// The limits in the kernel's units, shared by all ramps under them.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Ramps {
    order: Order,
    scale: Scale,
    velocity: Sides,
    acceleration: f64,
    deceleration: f64,
    jerk: f64,
    before: Before,
}

/// The limits, in the kernel's units, that hold while the start state is outside the new ones.
#[derive(Clone, Copy, Debug)]
struct Before {
    deceleration: f64,
    jerk: f64,
    /// The highest derivative, as a multiple of its new bound.
    input: f64,
}

/// One ramp. It is large, so it is built in its final place.
pub(crate) struct Ramp {
    /// Durations and inputs in the kernel's units.
    pub(crate) spans: Spans<RAMP_SPANS>,
    /// Number of spans that bring the start inside the limits.
    pub(crate) lead: usize,
    /// Number of root steps.
    pub(crate) steps: u32,
    /// Whether the start was inside and viable and the ramp keeps its direction, so that there is no excess.
    pub(crate) viable: bool,
    /// Whether it is a stop from a viable state inside the limits with the same bounds throughout: from any state
    /// on it, the rest of it is the stop.
    is_plain_stop: bool,
}

impl Ramp {
    /// The time for which a push with this `input` is equal to a stop, which then still ends at the same place.
    pub(crate) fn goes_along(&self, input: f64) -> f64 {
        match self.spans.as_slice() {
            [first, ..] if self.is_plain_stop && first.input == input => first.duration,
            _ => 0.0,
        }
    }

    /// The velocity of the end of a stop while a push with this `input` moves its start (O21); NaN if it is not
    /// known.
    pub(crate) fn speed_of_end(&self, input: f64) -> f64 {
        match self.spans.as_slice() {
            _ if !self.is_plain_stop => f64::NAN,
            [] => 0.0,
            spans @ [first, ..] => (input - first.input) * gain(spans),
        }
    }

    /// No ramp yet.
    pub(crate) const fn nothing() -> Self {
        Self {
            spans: Spans::new(),
            lead: 0,
            steps: 0,
            viable: false,
            is_plain_stop: false,
        }
    }
}

impl Ramps {
    /// Ramps under `limits`; until a start state is inside them under `wider`, the larger of old and new.
    pub(crate) fn new(directed: &DirectedLimits, wider: &DirectedLimits) -> Self {
        let (limits, wider) = (&directed.limits, &wider.limits);
        let order = limits.order();
        let fastest = limits.acceleration.max(limits.deceleration);
        let (scale, input) = match order {
            Order::Two => (Scale::NONE, 1.0),
            Order::Three => (Scale::new(fastest, limits.jerk, 1), wider.jerk / limits.jerk),
            Order::Four => (Scale::new(fastest, limits.snap, 2), wider.snap / limits.snap),
        };
        let inward = |value, derivative| scale.inward(value, levels(order, derivative));
        Self {
            order,
            scale,
            velocity: directed.sides().map(|side| inward(side, 1)),
            acceleration: inward(limits.acceleration, 2),
            deceleration: inward(limits.deceleration, 2),
            jerk: inward(limits.jerk, 3),
            before: Before {
                deceleration: inward(wider.deceleration, 2),
                jerk: inward(wider.jerk, 3),
                input,
            },
        }
    }

    /// The same with the lower one of acceleration and deceleration for both, in the same units: a ramp that
    /// passes zero velocity then has fewer spans.
    pub(crate) fn even(&self) -> Self {
        let lower = self.lower();
        Self {
            acceleration: lower,
            deceleration: lower,
            ..*self
        }
    }

    /// The same for a time-reversed motion: what speeds a motion up slows it down there.
    pub(crate) const fn backwards(&self) -> Self {
        Self {
            acceleration: self.deceleration,
            deceleration: self.acceleration,
            before: Before {
                deceleration: self.acceleration,
                jerk: self.jerk,
                input: 1.0,
            },
            ..*self
        }
    }

    /// Ramps of one order less, in the same units, in which the velocity takes the place of the position: those of
    /// the acceleration, within `range`.
    pub(crate) const fn of_velocity(&self, range: Sides) -> Self {
        let (order, rate, jerk) = match self.order {
            Order::Four => (Order::Three, self.jerk, 1.0),
            Order::Three | Order::Two => (Order::Two, 1.0, f64::INFINITY),
        };
        Self {
            order,
            velocity: range,
            acceleration: rate,
            deceleration: rate,
            jerk,
            before: Before {
                deceleration: rate,
                jerk,
                input: 1.0,
            },
            ..*self
        }
    }

    /// The bounds of an acceleration between the velocities `from` and `to`. If their signs differ, the lower one
    /// holds in both directions, except for the acceleration `end` itself, which a motion from rest to rest reaches
    /// from behind.
    pub(crate) fn accelerations(&self, from: f64, to: f64, end: f64) -> Sides {
        let (low, high) = (from.min(to), from.max(to));
        let (up, down) = if low < 0.0 && high > 0.0 {
            (self.lower(), self.lower())
        } else if low < 0.0 || high == 0.0 && end > 0.0 {
            (self.deceleration, self.acceleration)
        } else {
            (self.acceleration, self.deceleration)
        };
        Sides {
            minus: down.max(-end),
            plus: up.max(end),
        }
    }

    /// The order of the ramps.
    pub(crate) const fn order(&self) -> Order {
        self.order
    }

    /// The units of the kernel.
    pub(crate) const fn scale(&self) -> &Scale {
        &self.scale
    }

    /// The bound of a velocity with the sign of `side`, in the kernel's units.
    pub(crate) const fn velocity(&self, side: f64) -> f64 {
        self.velocity.towards(side)
    }

    /// The lower one of both velocity bounds in the kernel's units.
    pub(crate) const fn lower_velocity(&self) -> f64 {
        self.velocity.lower()
    }

    /// The acceleration bound in the kernel's units.
    pub(super) const fn acceleration(&self) -> f64 {
        self.acceleration
    }

    /// The deceleration bound in the kernel's units.
    pub(crate) const fn deceleration(&self) -> f64 {
        self.deceleration
    }

    /// The lower one of both in the kernel's units.
    pub(crate) const fn lower(&self) -> f64 {
        self.acceleration.min(self.deceleration)
    }

    /// The jerk bound in the kernel's units.
    pub(crate) const fn jerk(&self) -> f64 {
        self.jerk
    }

    /// A derivative of the position, 0 the position itself, in the kernel's units.
    pub(crate) fn inward(&self, value: f64, derivative: u32) -> f64 {
        self.scale.inward(value, levels(self.order, derivative))
    }

    /// A state in the kernel's units; the derivatives that may jump at this order are not used.
    pub(crate) fn state_inward(&self, state: &Setpoint) -> Setpoint {
        Setpoint {
            position: self.inward(state.position, 0),
            velocity: self.inward(state.velocity, 1),
            acceleration: self.inward(state.acceleration, 2),
            jerk: self.inward(state.jerk, 3),
            snap: 0.0,
        }
    }

    /// The ramp from `start` to the velocity `goal`, both in the kernel's units.
    ///
    /// `heading` is the direction of the motion ([`heading`]), 1 or -1.
    pub(crate) fn ramp(&self, start: &Setpoint, goal: f64, heading: f64, course: Course) -> Ramp {
        let mut ramp = Ramp::nothing();
        self.lay(&mut ramp, start, goal, heading, course);
        ramp
    }

    /// The same as [`Ramps::ramp`], written to `ramp`.
    pub(crate) fn lay(&self, ramp: &mut Ramp, start: &Setpoint, goal: f64, heading: f64, course: Course) {
        #[cfg(feature = "count")]
        super::count::add();
        // Mirrored so that the motion starts forwards. Its spans are mirrored back as they are appended.
        let state = State {
            v: heading * start.velocity,
            a: heading * start.acceleration,
            j: heading * start.jerk,
        };
        let goal = heading * goal;
        let range = if heading < 0.0 {
            self.velocity.mirrored()
        } else {
            self.velocity
        };
        ramp.spans.clear();
        ramp.is_plain_stop = false;
        match self.order {
            Order::Two => self.second_order(ramp, heading, state.v, goal, range.plus, course),
            Order::Three => self.third_order(ramp, heading, state, goal, range, course),
            Order::Four => self.fourth_order(ramp, heading, state, goal, range, course),
        }
    }

    /// The same as a part of a move: the ramp may turn.
    pub(crate) fn lay_freely(&self, ramp: &mut Ramp, start: &Setpoint, goal: f64) {
        let heading = heading(start, goal, self.lower_velocity(), self.order);
        self.lay(ramp, start, goal, heading, Course::Free);
    }

    /// The spans of [`Ramps::lay_freely`].
    pub(crate) fn freely(&self, start: &Setpoint, goal: f64) -> Spans<RAMP_SPANS> {
        let mut ramp = Ramp::nothing();
        self.lay_freely(&mut ramp, start, goal);
        ramp.spans
    }

    /// The whole move from `start` to rest at `target` with the velocity `top`, if the kernel can solve it: at order 3
    /// with the same bound on acceleration and deceleration, from a viable state that is no faster (O3).
    pub(crate) fn position_profile(&self, start: &Setpoint, target: f64, top: Sides) -> Option<Profile> {
        let &Setpoint {
            position: p,
            velocity: v,
            acceleration: a,
            ..
        } = start;
        let bounds = Bounds {
            v: top,
            a: Sides::both(self.acceleration),
        };
        let coming = |v: f64| v.abs() <= top.towards(v) * (1.0 + ON_LIMIT);
        let fits = self.order == Order::Three
            && self.acceleration == self.deceleration
            && a.abs() <= self.acceleration * (1.0 + ON_LIMIT)
            && coming(v)
            && coming(Slope { v, a }.rest());
        #[cfg(feature = "count")]
        if fits {
            super::count::add();
        }
        fits.then(|| third(p, v, a, target, &bounds))
    }

    /// The velocity of `start` once acceleration and jerk are zero, as soon as possible.
    pub(crate) fn arrested(&self, start: &Setpoint) -> f64 {
        let &Setpoint {
            velocity: v,
            acceleration: a,
            jerk: j,
            ..
        } = start;
        match self.order {
            Order::Two => v,
            Order::Three => Slope { v, a }.rest(),
            Order::Four => inside::arrested(State { v, a, j }, self.jerk),
        }
    }

    /// The same for a start in the user's units; the result is in those units, too.
    pub(crate) fn coasting(&self, start: &Setpoint) -> f64 {
        if start.acceleration == 0.0 && start.jerk == 0.0 {
            return start.velocity;
        }
        let arrested = self.arrested(&self.state_inward(start));
        self.scale.outward_value(arrested, levels(self.order, 1))
    }

    /// Whether a ramp that changes its direction has different bounds on both sides of zero.
    fn splits(&self, course: Course) -> bool {
        course == Course::Free && self.acceleration != self.deceleration
    }

    /// The acceleration bounds that a ramp itself uses (R11), for a start that moves forwards.
    ///
    /// Forwards, an acceleration above zero raises the speed and one below zero lowers it. If the velocity changes
    /// its sign on the way, each does both, so the lower bound of the two holds on that side. `dips` means that the
    /// velocity goes below zero on its way to a goal that is not below zero.
    fn sides(&self, goal: f64, dips: bool) -> Sides {
        let lower = self.lower();
        let reverses = goal < 0.0;
        Sides {
            minus: if reverses { lower } else { self.deceleration },
            plus: if reverses || dips {
                lower
            } else {
                self.acceleration
            },
        }
    }

    /// Order 2: one straight line, or two if the velocity must come inside its limit first (R12).
    fn second_order(
        &self,
        ramp: &mut Ramp,
        heading: f64,
        velocity: f64,
        goal: f64,
        limit: f64,
        course: Course,
    ) {
        let spans = &mut ramp.spans.towards(heading);
        let sides = self.sides(goal, false);
        ramp.viable = velocity <= limit && velocity >= 0.0;
        ramp.steps = 0;
        let mut velocity = velocity;
        if velocity > limit * (1.0 + ON_LIMIT) {
            let fast = self.before.deceleration;
            spans.push((velocity - limit) / fast, -fast);
            velocity = limit;
        }
        ramp.lead = spans.len();
        let change = goal - velocity;
        if goal < 0.0 && self.splits(course) {
            spans.extend(self.turning(&setpoint(velocity, 0.0, 0.0), goal).0.as_slice());
        } else if change > 0.0 {
            spans.push(change / sides.plus, sides.plus);
        } else {
            spans.push(-change / sides.minus, -sides.minus);
        }
    }

    /// Order 3: `(velocity, acceleration)` to `(goal, 0)` (R3).
    fn third_order(
        &self,
        ramp: &mut Ramp,
        heading: f64,
        start: State,
        goal: f64,
        range: Sides,
        course: Course,
    ) {
        let start = Slope {
            v: start.v,
            a: start.a,
        };
        let bounds = Box3 {
            up: self.acceleration,
            down: self.deceleration,
            brake_before: self.before.deceleration,
            jerk_before: self.before.input,
            turns: goal < 0.0 && self.splits(course),
        };
        let (lead, steps) = start.lead_in(goal, range, &bounds);
        ramp.viable = lead.is_empty() && goal >= 0.0 && start.is_viable(range.plus);
        ramp.lead = lead.len();
        ramp.steps = steps;
        let state = start.after_all(&lead);
        let dips = goal >= 0.0 && state.rest() < 0.0;
        let spans = &mut ramp.spans.towards(heading);
        spans.extend(lead.as_slice());
        if self.splits(course) && (dips || goal < 0.0) {
            let (turning, steps) = self.turning(&setpoint(state.v, state.a, 0.0), goal);
            spans.extend(turning.as_slice());
            ramp.steps = ramp.steps.max(steps);
        } else {
            spans.extend(&second_in_three(state.v, state.a, goal, self.sides(goal, dips)));
        }
    }

    /// Order 4: `(velocity, acceleration, jerk)` to `(goal, 0, 0)` (R4 to R10).
    fn fourth_order(
        &self,
        ramp: &mut Ramp,
        heading: f64,
        start: State,
        goal: f64,
        range: Sides,
        course: Course,
    ) {
        let may_turn = goal < 0.0 || course == Course::Free;
        let bounds = Box4 {
            a: Sides {
                minus: self.deceleration,
                plus: self.acceleration,
            },
            brake_before: self.before.deceleration,
            jerk: self.jerk,
            jerk_before: self.before.jerk,
            snap_before: self.before.input,
            turns: goal < 0.0 && self.splits(course),
        };
        let own = |dips| Bounds {
            v: self.sides(goal, dips),
            a: Sides::both(self.jerk),
        };
        let low = if may_turn { -range.minus } else { 0.0 };
        let spans = &mut ramp.spans.towards(heading);
        let mut lead = Lead::none(start, self.jerk);
        let viable = lead.is_viable(low, range.plus, &bounds);
        if !viable {
            lead.come_inside(spans, goal, (low, range), &bounds, &own(true));
        }
        ramp.lead = spans.len();
        let dips = goal >= 0.0 && (lead.state.v < 0.0 || lead.rest < 0.0);
        let State { v, a, j } = lead.state;
        let steps = if self.splits(course) && (dips || goal < 0.0) {
            let (turning, steps) = self.turning(&setpoint(v, a, j), goal);
            spans.extend(turning.as_slice());
            steps
        } else {
            ramp.is_plain_stop = viable && goal == 0.0;
            append_third(
                spans,
                (&lead.arrest, goal - lead.rest),
                (v, a, j),
                goal,
                &own(dips),
            )
        };
        ramp.steps = lead.steps.max(steps);
        // The acceleration that is reached while the jerk goes to zero as fast as it can.
        let settled = start.a + 0.5 * start.j * start.j.abs();
        let widened = 1.0 + ON_LIMIT;
        let held = settled <= self.acceleration * widened && settled >= -self.deceleration * widened;
        ramp.viable = viable && held && goal >= 0.0;
    }
}

fn setpoint(velocity: f64, acceleration: f64, jerk: f64) -> Setpoint {
    Setpoint {
        velocity,
        acceleration,
        jerk,
        ..Setpoint::default()
    }
}

/// The number of integrations from the input to the derivative.
const fn levels(order: Order, derivative: u32) -> u32 {
    (order.degree() as u32).saturating_sub(derivative)
}

/// A speed that is only rounding beside its bound `velocity`.
pub(crate) fn unmoved(velocity: f64) -> f64 {
    if velocity.is_finite() {
        ON_LIMIT * velocity
    } else {
        0.0
    }
}

/// The direction of a motion, 1 or -1: the sign of the velocity. If the velocity is only rounding beside its bound
/// `velocity`, the sign of the first derivative that moves it, if there is one.
pub(crate) fn heading(start: &Setpoint, goal: f64, velocity: f64, order: Order) -> f64 {
    let unless_it_jumps = |least| if order >= least { 0.0 } else { f64::INFINITY };
    let decisive = [
        (start.velocity, unmoved(velocity)),
        (start.acceleration, unless_it_jumps(Order::Three)),
        (start.jerk, unless_it_jumps(Order::Four)),
        (goal, 0.0),
        (start.velocity, 0.0),
    ];
    decisive
        .iter()
        .find(|(value, threshold)| value.abs() > *threshold)
        .map_or(1.0, |(value, _)| if *value < 0.0 { -1.0 } else { 1.0 })
}

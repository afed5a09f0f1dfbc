//! Random replans in chains, and each as a line of `standstill plan`.

use crate::random::Random;
use standstill_planner::grid::{self, Family};
use standstill_planner::{
    Excess, GridPlan, Limits, Method, OnlinePlan, Order, Peaks, PlanError, RampPlan, Segment, Setpoint,
    UnequalPlan,
};

/// Largest number of scans of a plan.
const MOST_SCANS: f64 = 2_147_483_647.0;

/// The goal of a replan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Goal {
    /// Rest at a position, from rest, on the sample grid (u).
    Grid(f64),
    /// Rest at a position (u).
    Position(f64),
    /// A position (u), passed with a velocity (u/s).
    Passing(f64, f64),
    /// A velocity (u/s); 0 is a stop.
    Velocity(f64),
}

/// One replan.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// The state of the axis.
    pub start: Setpoint,
    /// The goal.
    pub goal: Goal,
    /// The limits from now on.
    pub limits: Limits,
    /// The limits until now.
    pub before: Limits,
    /// Sample time (s).
    pub cycle: f64,
    /// Whether the start is known to need no more than `limits`.
    pub viable: bool,
}

/// A plan of any kind.
#[derive(Clone, Copy, Debug)]
#[expect(clippy::large_enum_variant, reason = "one exists at a time")]
pub enum Plan {
    /// From rest to rest on the sample grid.
    Grid(GridPlan),
    /// The same with a deceleration of its own.
    Unequal(UnequalPlan),
    /// To a position.
    Online(OnlinePlan),
    /// To a velocity.
    Ramp(RampPlan),
}

impl Case {
    /// Plans it.
    pub fn plan(&self) -> Result<Plan, PlanError> {
        let Self {
            start,
            limits,
            before,
            cycle,
            ..
        } = self;
        match self.goal {
            Goal::Grid(target) if limits.acceleration != limits.deceleration => {
                UnequalPlan::new(Family::Overlapped, start.position, target, limits, *cycle)
                    .map(Plan::Unequal)
            }
            Goal::Grid(target) => {
                GridPlan::new(Method::Overlapped, start.position, target, limits, *cycle).map(Plan::Grid)
            }
            Goal::Position(target) => {
                OnlinePlan::new(start, target, limits, before, *cycle).map(Plan::Online)
            }
            Goal::Passing(target, velocity) => {
                OnlinePlan::passing(start, target, velocity, limits, before, *cycle).map(Plan::Online)
            }
            Goal::Velocity(velocity) => {
                RampPlan::new(start, velocity, limits, before, *cycle).map(Plan::Ramp)
            }
        }
    }

    /// Whether it probably takes more scans than a plan can count: a time that is close to a lower bound takes that
    /// many.
    pub fn is_long(&self) -> bool {
        let (way, end) = match self.goal {
            Goal::Grid(target) | Goal::Position(target) => (target - self.start.position, 0.0),
            Goal::Passing(target, velocity) => (target - self.start.position, velocity),
            Goal::Velocity(velocity) => (0.0, velocity),
        };
        let Limits {
            velocity,
            acceleration,
            deceleration,
            jerk,
            snap,
        } = self.limits;
        let (way, change) = (way.abs(), self.start.velocity.abs() + end.abs());
        let rate = acceleration.min(deceleration);
        let longest = self.cycle * MOST_SCANS / 16.0;
        let cubed = longest * longest * longest;
        way / velocity >= longest
            || change / rate >= longest
            || change * change / (rate * velocity) >= longest
            || way / rate >= longest * longest
            || change / jerk >= longest * longest
            || way / jerk >= cubed
            || self.start.acceleration.abs() / jerk >= longest
            || self.start.jerk.abs() / snap >= longest
            || change / snap >= cubed
            || way / snap >= cubed * longest
    }

    /// The line of `standstill plan` that plans the same.
    pub fn line(&self, id: &str) -> String {
        let (method, target, end_velocity) = match self.goal {
            Goal::Grid(target) => ("overlapped", Some(target), None),
            Goal::Position(target) => ("online", Some(target), None),
            Goal::Passing(target, velocity) => ("online", Some(target), Some(velocity)),
            Goal::Velocity(velocity) => ("ramp", None, Some(velocity)),
        };
        let Setpoint {
            position,
            velocity,
            acceleration,
            jerk,
            ..
        } = self.start;
        let takes_before = method != "overlapped" && self.before != self.limits;
        let bound = |(_, value): &(&str, Option<f64>)| value.is_some_and(f64::is_finite);
        let object = |members: &[(&str, Option<f64>)]| {
            let members = members.iter().filter(|member| bound(member));
            // Adding 0.0 removes the sign of zero.
            let members = members.map(|(key, value)| format!("\"{key}\":{:?}", value.unwrap_or(0.0) + 0.0));
            members.collect::<Vec<_>>().join(",")
        };
        let state = object(&[
            ("Ts", Some(self.cycle)),
            ("position", Some(position)),
            ("velocity", Some(velocity)),
            ("acceleration", Some(acceleration)),
            ("jerk", Some(jerk)),
            ("target", target),
            ("end_velocity", end_velocity),
        ]);
        let bounds = |limits: &Limits| {
            object(&[
                ("velocity", Some(limits.velocity)),
                ("acceleration", Some(limits.acceleration)),
                ("deceleration", Some(limits.deceleration)),
                ("jerk", Some(limits.jerk)),
                ("snap", Some(limits.snap)),
            ])
        };
        let before = if takes_before {
            format!(",\"limits_before\":{{{}}}", bounds(&self.before))
        } else {
            String::new()
        };
        // `id` is plain text, which Rust and JSON quote alike.
        format!(
            "{{\"id\":{id:?},\"method\":\"{method}\",{state},\"limits\":{{{}}}{before}}}",
            bounds(&self.limits)
        )
    }
}

impl Plan {
    /// Scans until the goal.
    pub fn scans(&self) -> u32 {
        match self {
            Self::Grid(plan) => plan.scans(),
            Self::Unequal(plan) => plan.scans(),
            Self::Online(plan) => plan.scans(),
            Self::Ramp(plan) => plan.scans(),
        }
    }

    /// The set-point of a scan.
    pub fn at(&self, scan: u64) -> Setpoint {
        match self {
            Self::Grid(plan) => plan.at(scan),
            Self::Unequal(plan) => plan.at(scan),
            Self::Online(plan) => plan.at(scan),
            Self::Ramp(plan) => plan.at(scan),
        }
    }

    /// Time until the goal (s).
    pub fn duration(&self) -> f64 {
        match self {
            Self::Grid(plan) => plan.duration(),
            Self::Unequal(plan) => plan.duration(),
            Self::Online(plan) => plan.duration(),
            Self::Ramp(plan) => plan.duration(),
        }
    }

    /// The excess that the plan reports.
    pub fn excess(&self) -> Option<Excess> {
        match self {
            Self::Grid(_) | Self::Unequal(_) => None,
            Self::Online(plan) => plan.excess(),
            Self::Ramp(plan) => plan.excess(),
        }
    }

    /// The largest magnitudes that the plan reports.
    pub fn peaks(&self) -> Peaks {
        match self {
            Self::Grid(plan) => unbounded_where_none(plan.peaks()),
            Self::Unequal(plan) => unbounded_where_none(plan.peaks()),
            Self::Online(plan) => plan.peaks(),
            Self::Ramp(plan) => plan.peaks(),
        }
    }

    /// The stretches of constant highest derivative.
    pub fn segments(&self) -> Vec<Segment> {
        match self {
            Self::Grid(plan) => plan.segments().map(Segment::from).collect(),
            Self::Unequal(plan) => plan.segments().map(Segment::from).collect(),
            Self::Online(plan) => plan.segments().collect(),
            Self::Ramp(plan) => plan.segments().collect(),
        }
    }

    /// Whether every switch is at a scan.
    pub const fn is_on_grid(&self) -> bool {
        matches!(self, Self::Grid(_) | Self::Unequal(_))
    }
}

fn unbounded_where_none(peaks: grid::Peaks) -> Peaks {
    Peaks {
        velocity: peaks.velocity,
        acceleration: peaks.acceleration,
        jerk: peaks.jerk.unwrap_or(f64::INFINITY),
        snap: peaks.snap.unwrap_or(f64::INFINITY),
    }
}

/// The change of a chain's limits from replan to replan.
#[derive(Clone, Copy, Debug)]
enum Change {
    Never,
    Velocity,
    All,
}

/// A chain of replans: each starts at a random scan of the one before.
#[derive(Debug)]
pub struct Chain {
    random: Random,
    /// The upper bounds of all other limits.
    widest: Limits,
    change: Change,
    cycle: f64,
    /// A typical length for the limits (u).
    way: f64,
    /// The highest velocity a goal may have (u/s).
    fastest: f64,
    /// The origin of positions (u).
    origin: f64,
    start: Setpoint,
    before: Limits,
    viable: bool,
}

impl Chain {
    /// The chain of this number, at rest at first.
    pub fn new(seed: u64, number: u64) -> Self {
        Self::of(Random::new(seed, number))
    }

    /// The chain of these numbers. In every sixth some limits are never reached, or almost 0.
    pub fn of(mut random: Random) -> Self {
        let order = [Order::Two, Order::Three, Order::Four][random.below(3) as usize];
        let typical = limits(&mut random, order);
        let change = [Change::Never, Change::Velocity, Change::All][random.below(3) as usize];
        let time = typical.velocity / typical.acceleration;
        let way = typical.velocity * time;
        let cycle = time * random.log_between(0.001, 0.3);
        let widest = if random.one_in(6) {
            extreme(&mut random, &typical, cycle)
        } else {
            typical
        };
        let origin = if random.one_in(8) {
            let far = way * random.log_between(1.0, 1e4);
            random.signed(far)
        } else {
            0.0
        };
        let mut chain = Self {
            cycle,
            before: widest,
            random,
            widest,
            change,
            way,
            fastest: typical.velocity,
            origin,
            start: Setpoint::default(),
            viable: true,
        };
        chain.rest();
        chain
    }

    /// Starts again at rest, at any position.
    pub fn rest(&mut self) {
        self.start = Setpoint::at_rest(self.position(3.0));
        self.viable = true;
    }

    /// Draws the next replan.
    pub fn next_case(&mut self) -> Case {
        let limits = self.limits();
        // A motion that fits under limits also fits under larger ones.
        let viable = self.start.is_at_rest() || self.viable && contains(&limits, &self.before);
        let case = Case {
            start: self.start,
            goal: self.goal(&limits),
            limits,
            before: self.before,
            cycle: self.cycle,
            viable,
        };
        self.before = limits;
        case
    }

    /// Draws the scan at which the next replan leaves `plan`; it may be its end or later.
    pub fn leave(&mut self, plan: &Plan) -> u64 {
        self.random.below(u64::from(plan.scans()) + 2)
    }

    /// Continues from `scan` of `plan`; `keeps` says whether the whole plan keeps its limits.
    pub fn follow(&mut self, plan: &Plan, scan: u64, keeps: bool) {
        self.start = plan.at(scan);
        self.viable = keeps || scan >= u64::from(plan.scans());
    }

    fn goal(&mut self, limits: &Limits) -> Goal {
        match self.random.below(8) {
            0 => Goal::Velocity(0.0),
            1 | 2 => Goal::Velocity(self.velocity(limits)),
            3 => {
                let target = self.target();
                let velocity = self.velocity(limits).abs();
                let sense = if target < self.start.position { -1.0 } else { 1.0 };
                Goal::Passing(target, sense * velocity)
            }
            _ => {
                let target = self.target();
                // From rest, the two kinds of planning alternate.
                if self.start.is_at_rest() && self.random.one_in(2) {
                    Goal::Grid(target)
                } else {
                    Goal::Position(target)
                }
            }
        }
    }

    /// A goal velocity (u/s), sometimes exactly the limit, unless that is never reached.
    fn velocity(&mut self, limits: &Limits) -> f64 {
        let most = limits.velocity.min(self.fastest);
        let speed = match self.random.below(4) {
            0 => most,
            1 => most * self.random.log_between(1e-6, 1.0),
            _ => most * self.random.between(0.0, 1.0),
        };
        self.random.signed(speed)
    }

    /// A target (u): at the present position, next to it, or anywhere.
    fn target(&mut self) -> f64 {
        match self.random.below(8) {
            0 => self.start.position,
            1 | 2 => {
                let step = self.way * self.random.log_between(1e-9, 1e3);
                self.start.position + self.random.signed(step)
            }
            3 => self.position(30.0),
            _ => self.position(3.0),
        }
    }

    /// A position (u), at most `ways` times `way` from the origin.
    fn position(&mut self, ways: f64) -> f64 {
        self.origin + self.way * self.random.between(-ways, ways)
    }

    fn limits(&mut self) -> Limits {
        let mut limits = self.widest;
        match self.change {
            Change::Never => {}
            Change::Velocity => limits.velocity *= self.random.between(0.2, 1.0),
            Change::All => {
                let bounds = [
                    &mut limits.velocity,
                    &mut limits.acceleration,
                    &mut limits.deceleration,
                    &mut limits.jerk,
                    &mut limits.snap,
                ];
                for bound in bounds {
                    if self.random.one_in(2) {
                        *bound *= self.random.between(0.4, 1.0);
                    }
                }
            }
        }
        limits
    }
}

/// Whether no limit of `inner` is above that of `outer`.
fn contains(outer: &Limits, inner: &Limits) -> bool {
    inner.velocity <= outer.velocity
        && inner.acceleration <= outer.acceleration
        && inner.deceleration <= outer.deceleration
        && inner.jerk <= outer.jerk
        && inner.snap <= outer.snap
}

/// `typical`, with some of its limits replaced by the usual values for "no limit", or by anything from
/// 1e-12 to the largest number.
///
/// The effects of the rates differ by at most 10^4: a ramp that changes between two such rates keeps the
/// lower one to 1e-9 of the higher (docs/planner-ramps.md, section 7).
pub(crate) fn extreme(random: &mut Random, typical: &Limits, cycle: f64) -> Limits {
    let mut limits = *typical;
    let bounds = [
        &mut limits.velocity,
        &mut limits.acceleration,
        &mut limits.deceleration,
        &mut limits.jerk,
        &mut limits.snap,
    ];
    for bound in bounds {
        if bound.is_finite() && random.one_in(3) {
            *bound = match random.below(8) {
                0 => f64::MAX,
                1 => 1e30,
                2 => 1e-12 * random.log_between(1.0, 1e300),
                3 => *bound * random.log_between(1e-6, 1.0),
                _ => (*bound * random.log_between(1.0, 1e30)).min(f64::MAX),
            };
        }
    }
    let done = |rate: f64| rate.min(65536.0 * typical.velocity / cycle);
    let least = 1e-4 * done(limits.acceleration).max(done(limits.deceleration));
    limits.acceleration = limits.acceleration.max(least);
    limits.deceleration = limits.deceleration.max(least);
    limits
}

/// Limits with the proportions of servo axes, in units of length and time a thousand times smaller to a
/// thousand times larger. At order 4 every eighth set has no jerk limit.
fn limits(random: &mut Random, order: Order) -> Limits {
    let velocity = random.log_between(0.01, 10.0);
    let acceleration = velocity * random.log_between(1.0, 300.0);
    let deceleration = if random.one_in(3) {
        acceleration
    } else {
        acceleration * random.log_between(0.2, 5.0)
    };
    let jerk = acceleration * random.log_between(1.0, 1000.0);
    let snap = jerk * random.log_between(1.0, 3000.0);
    let length = random.log_between(1e-3, 1e3);
    let rate = random.log_between(1e-3, 1e3);
    let without_jerk = order == Order::Two || order == Order::Four && random.one_in(8);
    let bound = |value: f64, absent: bool| if absent { f64::INFINITY } else { value };
    Limits {
        velocity: velocity * length * rate,
        acceleration: acceleration * length * rate * rate,
        deceleration: deceleration * length * rate * rate,
        jerk: bound(jerk * length * rate * rate * rate, without_jerk),
        snap: bound(snap * length * rate * rate * rate * rate, order != Order::Four),
    }
}

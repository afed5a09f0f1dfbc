//! Checks a plan against the claims about plans.

use crate::cases::{Case, Goal, Plan};
use crate::follow::{Followed, follow, state_at};
use standstill_planner::kernel::MAX_STEPS;
use standstill_planner::online::MAX_SOLVES;
use standstill_planner::{Excess, Order, Setpoint};

/// The tolerance for a limit, a target and a jump: relative to the limit, to the distance at the velocity limit, to
/// the limit.
const RELATIVE: f64 = 1e-9;

/// Speeds up to this part of the limit count as zero: the derivatives give the direction (docs/planner-ramps.md,
/// section 4), and either bound of the acceleration may apply.
const STILL: f64 = 1e-9;

/// A velocity limit this many times higher than a plan's speeds is no measure of them.
const REACH: f64 = 1024.0 * 1024.0;

/// The error of an acceleration, relative to the largest one it comes from: a tenth of [`RELATIVE`].
const CHANGED: f64 = 1e-10;

/// The resolution of sums of positions, relative to them.
const RESOLVED: f64 = 32.0 * f64::EPSILON;

/// The resolution of a plan's clock, relative to the time it has run: an instant is also a 64-bit number.
const TICK: f64 = 2.0 * f64::EPSILON;

/// The measurements of a plan, each relative; a quantity that cannot be measured is 0.
#[derive(Clone, Copy, Debug, Default)]
pub struct Measured {
    /// Excess over the limits of velocity, acceleration, jerk and snap, if nothing forces the plan out of
    /// them.
    pub excess: [f64; 4],
    /// Excess of velocity, acceleration and jerk beyond that which the plan reports.
    pub untold: [f64; 3],
    /// Jumps of velocity, acceleration and jerk between segments.
    pub jumps: [f64; 3],
    /// Distance of the end of the segments from the target.
    pub miss: f64,
    /// Distance of a set-point from the segments.
    pub sample: f64,
    /// Difference of the reported peaks from those of the segments.
    pub peak: f64,
    /// Whether the whole plan keeps its limits, so that its rest does from anywhere on it.
    pub keeps: bool,
}

/// Judges `plan`, which is left at `scan` for the next one. Returns the measurements, or the broken
/// claim.
pub fn judge(case: &Case, plan: &Plan, scan: u64) -> Result<Measured, String> {
    let order = case.limits.order();
    let segments = plan.segments();
    if let Some(segment) = segments.iter().find(|segment| !(segment.duration > 0.0)) {
        return Err(format!("a segment of {:e} s", segment.duration));
    }
    if let Some(what) = cut_short(plan) {
        return Err(what);
    }
    // A limit far above the speeds of a plan is no measure of them.
    let end = match case.goal {
        Goal::Grid(_) | Goal::Position(_) => 0.0,
        Goal::Passing(_, velocity) | Goal::Velocity(velocity) => velocity,
    };
    let fastest = segments
        .iter()
        .fold(case.start.velocity.abs().max(end.abs()), |most, segment| {
            most.max(segment.velocity.abs())
        });
    let still = STILL * case.limits.velocity.min(REACH * fastest);
    let followed = follow(&case.start, &segments, order, still);
    let time = scan as f64 * case.cycle;
    let scale = Scale::new(case, &followed, time);
    let taken = state_at(&case.start, &segments, time);
    let mut measured = Measured {
        jumps: relative(
            scale.beyond_tick(followed.jumps),
            [scale.velocity, scale.acceleration, scale.jerk],
        ),
        miss: miss(case, plan, &followed, &scale)?,
        sample: scale.difference(case, &plan.at(scan), &taken, order),
        peak: peak(plan, &followed, &scale, order),
        keeps: plan.excess().is_none() && followed.snap <= case.limits.snap * (1.0 + RELATIVE),
        ..Measured::default()
    };
    limits(case, plan, &followed, &scale, &mut measured)?;
    published(case, plan)?;
    ends(case, plan, order, &followed, &scale)?;
    let bounded = [
        ("velocity jumps", measured.jumps[0]),
        ("acceleration jumps", measured.jumps[1]),
        ("jerk jumps", measured.jumps[2]),
        ("the segments miss the goal", measured.miss),
        ("a set-point is off its segment", measured.sample),
        ("a peak is off the segments' own", measured.peak),
    ];
    match bounded.into_iter().find(|(_, value)| !(*value <= RELATIVE)) {
        Some((what, value)) => Err(format!("{what} by {value:e}")),
        None => Ok(measured),
    }
}

/// A search that reached its cap.
fn cut_short(plan: &Plan) -> Option<String> {
    let (solves, steps) = match plan {
        Plan::Grid(_) | Plan::Unequal(_) => (0, 0),
        Plan::Online(plan) => (plan.solves(), plan.steps()),
        Plan::Ramp(plan) => (0, plan.steps()),
    };
    let cut = solves >= MAX_SOLVES || steps >= MAX_STEPS;
    cut.then(|| format!("{solves} ramps solved, {steps} steps of a root"))
}

/// The scale of differences.
struct Scale {
    /// The longest distance in the examined time (u).
    way: f64,
    /// The resolution of the positions (u).
    resolved: f64,
    velocity: f64,
    acceleration: f64,
    jerk: f64,
    /// The changes of velocity, acceleration and jerk in a tick of the clock.
    tick: [f64; 3],
}

impl Scale {
    fn new(case: &Case, followed: &Followed, time: f64) -> Self {
        let target = match case.goal {
            Goal::Grid(target) | Goal::Position(target) | Goal::Passing(target, _) => target,
            Goal::Velocity(_) => case.start.position + followed.end.position,
        };
        let finite = |bound: f64, seen: f64| if bound.is_finite() { bound.max(seen) } else { seen };
        let tick = TICK * followed.duration.max(time);
        Self {
            tick: [
                tick * followed.acceleration(),
                tick * followed.jerk + CHANGED * followed.acceleration(),
                tick * followed.snap,
            ],
            way: case.limits.velocity.max(followed.speed()) * followed.duration.max(time),
            resolved: RESOLVED * (case.start.position.abs() + target.abs()),
            velocity: case.limits.velocity.max(followed.speed()),
            acceleration: case
                .limits
                .acceleration
                .min(case.limits.deceleration)
                .max(followed.acceleration()),
            jerk: finite(case.limits.jerk, followed.jerk),
        }
    }

    /// Differences of velocity, acceleration and jerk beyond the resolution of the clock.
    fn beyond_tick(&self, differences: [f64; 3]) -> [f64; 3] {
        let mut beyond = differences;
        for (difference, tick) in beyond.iter_mut().zip(self.tick) {
            *difference = (difference.abs() - tick).max(0.0);
        }
        beyond
    }

    /// A difference of positions relative to the distance, beyond the resolution of positions.
    fn position(&self, difference: f64) -> f64 {
        let beyond = difference.abs() - self.resolved;
        if beyond > 0.0 { beyond / self.way } else { 0.0 }
    }

    /// The largest difference of a set-point from a state that counts from the start.
    fn difference(&self, case: &Case, setpoint: &Setpoint, state: &Setpoint, order: Order) -> f64 {
        let [velocity, acceleration, jerk] = self.beyond_tick([
            setpoint.velocity - state.velocity,
            setpoint.acceleration - state.acceleration,
            setpoint.jerk - state.jerk,
        ]);
        let mut most = self
            .position(setpoint.position - case.start.position - state.position)
            .max(velocity / self.velocity);
        // A derivative that may jump has two values at a switch.
        if order >= Order::Three {
            most = most.max(acceleration / self.acceleration);
        }
        if order == Order::Four {
            most = most.max(jerk / self.jerk);
        }
        most
    }
}

fn relative<const N: usize>(values: [f64; N], scales: [f64; N]) -> [f64; N] {
    let mut relative = values;
    for (value, scale) in relative.iter_mut().zip(scales) {
        // 0 of 0 is 0.
        *value = if *value == 0.0 { 0.0 } else { *value / scale };
    }
    relative
}

/// The distance of the end of the segments from the goal.
fn miss(case: &Case, plan: &Plan, followed: &Followed, scale: &Scale) -> Result<f64, String> {
    let (target, velocity) = match case.goal {
        Goal::Grid(target) | Goal::Position(target) => (Some(target), 0.0),
        Goal::Passing(target, velocity) => (Some(target), velocity),
        Goal::Velocity(velocity) => (None, velocity),
    };
    let late = (plan.duration() - followed.duration).abs();
    if late > RELATIVE * plan.duration() {
        return Err(format!("the segments last {late:e} s more or less than the plan"));
    }
    let position = target.map_or(0.0, |target| {
        scale.position(followed.end.position - (target - case.start.position))
    });
    Ok(position.max((followed.end.velocity - velocity).abs() / scale.velocity))
}

/// The difference of the reported peaks from those of the segments.
fn peak(plan: &Plan, followed: &Followed, scale: &Scale, order: Order) -> f64 {
    let peaks = plan.peaks();
    let mut most = ((peaks.velocity - followed.speed()).abs() / scale.velocity)
        .max((peaks.acceleration - followed.acceleration()).abs() / scale.acceleration);
    if order >= Order::Three {
        most = most.max((peaks.jerk - followed.jerk).abs() / scale.jerk);
    }
    most
}

/// Checks the extremes against the limits, and against the reported excess.
fn limits(
    case: &Case,
    plan: &Plan,
    followed: &Followed,
    scale: &Scale,
    measured: &mut Measured,
) -> Result<(), String> {
    let limits = &case.limits;
    let [velocity_tick, acceleration_tick, jerk_tick] = scale.tick;
    let higher = limits.acceleration.max(limits.deceleration);
    let over = |value: f64, bound: f64| {
        if bound.is_finite() {
            (value - bound).max(0.0)
        } else {
            0.0
        }
    };
    let acceleration = [
        (followed.growing - acceleration_tick, limits.acceleration),
        (followed.falling - acceleration_tick, limits.deceleration),
        (followed.still - acceleration_tick, higher),
    ];
    let speed = followed.speed() - velocity_tick;
    let highest_jerk = followed.jerk - jerk_tick;
    let velocity = over(speed, limits.velocity);
    let jerk = over(highest_jerk, limits.jerk);
    let relative_acceleration = acceleration.map(|(value, bound)| over(value, bound) / bound);
    let excess = [
        velocity / limits.velocity,
        relative_acceleration.into_iter().fold(0.0, f64::max),
        jerk / limits.jerk,
        over(followed.snap, limits.snap.max(case.before.snap)) / limits.snap,
    ];
    let names = ["velocity", "acceleration", "jerk", "snap"];
    let worst = |values: &[f64]| {
        let mut exceeded = values.iter().zip(names);
        exceeded
            .find(|(value, _)| !(**value <= RELATIVE))
            .map(|(value, name)| (name, *value))
    };
    let told = plan.excess();
    if told.is_none() || case.viable {
        if let Some((name, value)) = worst(&excess) {
            return Err(format!(
                "{name} exceeds its limit by {value:e}, which nothing forces it to"
            ));
        }
        measured.excess = excess;
    }
    let Some(told) = told else {
        return turns_back(case, followed);
    };
    // A stop in the middle of a reversal turns back, which is reported in the same way.
    let reversal = Excess {
        velocity: told.velocity,
        ..Excess::default()
    };
    if case.viable && (case.goal != Goal::Velocity(0.0) || told != reversal) {
        return Err(format!("an excess is told of that is none: {told:?}"));
    }
    let beyond = |value: f64, bound: f64, told: f64| over(over(value, bound), told) / (bound + told);
    let untold = [
        beyond(speed, limits.velocity, told.velocity),
        acceleration
            .map(|(value, bound)| beyond(value, bound, told.acceleration))
            .into_iter()
            .fold(0.0, f64::max),
        beyond(highest_jerk, limits.jerk, told.jerk),
    ];
    if let Some((name, value)) = worst(&untold) {
        return Err(format!("{name} exceeds what is told of by {value:e}"));
    }
    measured.untold = untold;
    if !(excess[3] <= RELATIVE) {
        return Err(format!("snap exceeds its limit by {:e}", excess[3]));
    }
    Ok(())
}

/// Scans at the start, in the middle and at the end of a plan whose set-points are checked.
const WINDOW: u64 = 8;

/// Checks backward differences of published positions against the limits. It does so if nothing forces the plan out
/// of the limits and some limit is far from the others, because a piece of the plan could then be lost in its
/// clock.
fn published(case: &Case, plan: &Plan) -> Result<(), String> {
    let limits = &case.limits;
    let higher = limits.acceleration.max(limits.deceleration);
    let sooner = |bound: f64, next: f64| next.is_finite() && bound < 1e-3 * case.cycle * next;
    let is_extreme = sooner(limits.velocity, higher)
        || sooner(higher, limits.jerk)
        || sooner(limits.jerk.min(higher / case.cycle), limits.snap);
    if !is_extreme || plan.excess().is_some() || limits != &case.before {
        return Ok(());
    }
    let bounds = [limits.velocity, higher, limits.jerk, limits.snap];
    let scans = u64::from(plan.scans());
    for first in [0, scans / 2, scans.saturating_sub(WINDOW)] {
        let mut values: Vec<f64> = (first..=first + WINDOW)
            .map(|scan| plan.at(scan).position)
            .collect();
        // The end of the plan enters its last piece, which may be the whole plan.
        let ends = plan.at(scans).position.abs().max(case.start.position.abs());
        let largest = values.iter().fold(ends, |most, value| most.max(value.abs()));
        // The clock resolves a position no better than its number does.
        let clock = limits.velocity.min(largest / case.cycle) * case.cycle * (first + WINDOW) as f64;
        let mut resolved = RESOLVED * (largest + clock);
        for (degree, bound) in bounds.into_iter().enumerate() {
            values = values
                .windows(2)
                .map(|pair| (pair[1] - pair[0]) / case.cycle)
                .collect();
            resolved = 2.0 * resolved / case.cycle;
            let most = values.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
            // A target that was passed is behind the end of the plan.
            if !(most <= bound * (1.0 + RELATIVE) + resolved) {
                return Err(format!(
                    "published difference {} is {most:e} near scan {first}",
                    degree + 1
                ));
            }
        }
    }
    Ok(())
}

/// A stop without a reported excess must keep the direction of motion.
fn turns_back(case: &Case, followed: &Followed) -> Result<(), String> {
    let v = case.start.velocity;
    let slack = RELATIVE * case.limits.velocity;
    let back = if v > slack {
        -followed.low
    } else if v < -slack {
        followed.high
    } else {
        // At rest the acceleration decides.
        return Ok(());
    };
    if case.goal == Goal::Velocity(0.0) && back > slack {
        return Err(format!(
            "a stop turns back with {:e}",
            back / case.limits.velocity
        ));
    }
    Ok(())
}

/// The first and the last set-points, to the bit, and the count of scans.
fn ends(case: &Case, plan: &Plan, order: Order, followed: &Followed, scale: &Scale) -> Result<(), String> {
    let last = u64::from(plan.scans());
    let needed = plan.duration() / case.cycle;
    let scans = f64::from(plan.scans());
    if !(scans >= needed * (1.0 - 2.0 * RELATIVE) && scans <= needed + 1.0) {
        return Err(format!("{scans} scans, but {needed:?} cycles"));
    }
    if last > 0 && !plan.is_on_grid() && plan.at(0) != case.start {
        return Err(format!("the first set-point is {:?}", plan.at(0)));
    }
    for scan in [last, last + 1] {
        let found = plan.at(scan);
        // `Measured::sample` checks the position during the motion.
        let expected = match case.goal {
            Goal::Grid(target) | Goal::Position(target) => Setpoint::at_rest(target),
            Goal::Passing(_, velocity) | Goal::Velocity(velocity) => Setpoint {
                velocity,
                ..Setpoint::at_rest(found.position)
            },
        };
        // On the grid the last switch is at the last scan; a derivative that may jump has not jumped just
        // before it.
        let smooth = if scan == last && plan.is_on_grid() {
            without_jumps(&found, order)
        } else {
            found
        };
        if smooth != expected {
            return Err(format!("set-point {scan} of {last} is {found:?}"));
        }
    }
    let at_end = [
        (Order::Three, followed.end.acceleration, scale.acceleration),
        (Order::Four, followed.end.jerk, scale.jerk),
    ];
    for (least, value, bound) in at_end {
        if order >= least && value.abs() > 10.0 * RELATIVE * bound {
            return Err(format!("the segments end at {:?}", followed.end));
        }
    }
    Ok(())
}

/// The state without the derivatives that may jump.
fn without_jumps(state: &Setpoint, order: Order) -> Setpoint {
    Setpoint {
        position: state.position,
        velocity: state.velocity,
        acceleration: if order >= Order::Three {
            state.acceleration
        } else {
            0.0
        },
        jerk: if order == Order::Four { state.jerk } else { 0.0 },
        snap: 0.0,
    }
}

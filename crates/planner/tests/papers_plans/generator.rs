//! The profile generator of Pietrusewicz, Waszczuk and Kubicki 2019, sections 4.1 to 4.4, sample by sample as
//! it would run on a controller, against the sequential grid plan, whose set-points are closed forms.
//!
//! Corrections (docs/planner.md, section 11): the direction is in the amplitude, so it is not applied again;
//! the switching instants are sixteen. With them the generator gives the plan's forward-Euler chain sample by
//! sample, two samples after the start edge.

use super::support::Random;
use standstill_planner::grid::Euler;
use standstill_planner::{GridPlan, Limits, Method};

/// How often each of td, tj, ta, tv has passed at the sixteen switching instants (50)-(53).
const SWITCHES: [[u32; 4]; 16] = [
    [0, 0, 0, 0],
    [1, 0, 0, 0],
    [1, 1, 0, 0],
    [2, 1, 0, 0],
    [2, 1, 1, 0],
    [3, 1, 1, 0],
    [3, 2, 1, 0],
    [4, 2, 1, 0],
    [4, 2, 1, 1],
    [5, 2, 1, 1],
    [5, 3, 1, 1],
    [6, 3, 1, 1],
    [6, 3, 2, 1],
    [7, 3, 2, 1],
    [7, 4, 2, 1],
    [8, 4, 2, 1],
];

/// The signs in (63).
const SIGNS: [i8; 16] = [1, -1, -1, 1, -1, 1, 1, -1, -1, 1, 1, -1, 1, -1, -1, 1];

/// A clock of the generator: the paper's is of seconds, in 64 or 32 bits.
pub trait Clock: Copy + PartialOrd {
    fn seconds(value: f64) -> Self;
    fn plus(self, other: Self) -> Self;
}

impl Clock for f64 {
    fn seconds(value: f64) -> Self {
        value
    }
    fn plus(self, other: Self) -> Self {
        self + other
    }
}

impl Clock for f32 {
    fn seconds(value: f64) -> Self {
        value as Self
    }
    fn plus(self, other: Self) -> Self {
        self + other
    }
}

/// The state of the generator between samples.
pub struct Generator<T> {
    cycle: f64,
    /// Inputs of the sample before: EN_start, GenStart, and t'_exec.
    enable_before: bool,
    started_before: bool,
    clock_before: T,
    /// The sixteen instants and the amplitude in force, in the units of the plan.
    instants: [T; 16],
    amplitude: i128,
    /// d, j, a, v, x of the sample before.
    chain: Euler,
}

impl<T: Clock> Generator<T> {
    pub fn new(cycle: f64) -> Self {
        Self {
            cycle,
            enable_before: false,
            started_before: false,
            clock_before: T::seconds(0.0),
            instants: [T::seconds(0.0); 16],
            amplitude: 0,
            chain: Euler::default(),
        }
    }

    /// One sample. `plan` is the plan for a start in the sample before.
    pub fn sample(&mut self, enable: bool, plan: &GridPlan) -> Euler {
        // (70), (56): a start takes effect one sample after its edge, and loads the profile.
        if self.started_before {
            self.load(plan);
        }
        // (71): the clock starts half a sample early, so that no comparison falls on a switch.
        let clock = self.clock_before;
        // (69): the edge.
        let started = enable && !self.enable_before;
        self.clock_before = if started {
            T::seconds(-self.cycle / 2.0)
        } else {
            clock.plus(T::seconds(self.cycle))
        };
        (self.enable_before, self.started_before) = (enable, started);

        // (62), (63).
        let snap = self
            .instants
            .iter()
            .zip(SIGNS)
            .filter(|(instant, _)| clock > **instant)
            .map(|(_, sign)| i128::from(sign) * self.amplitude)
            .sum();
        // (72)-(75): each from the sample before.
        let before = self.chain;
        self.chain = Euler {
            jerk: before.jerk + before.input,
            acceleration: before.acceleration + before.jerk,
            velocity: before.velocity + before.acceleration,
            position: before.position + before.velocity,
            input: snap,
        };
        self.chain
    }

    fn load(&mut self, plan: &GridPlan) {
        let counts = plan.counts().expect("a sequential plan");
        let times = [
            counts.nd.expect("order 4"),
            counts.nj.expect("order 4"),
            counts.na,
            counts.nv,
        ];
        for (instant, row) in self.instants.iter_mut().zip(SWITCHES) {
            let scans: u32 = row.iter().zip(times).map(|(times, count)| times * count).sum();
            *instant = T::seconds(f64::from(scans) * self.cycle);
        }
        self.amplitude = 1;
    }
}

/// The sequential plan from rest at 0, with bounds on velocity, acceleration, jerk and snap.
pub fn sequential(distance: f64, limits: [f64; 4], cycle: f64) -> GridPlan {
    let [velocity, acceleration, jerk, snap] = limits;
    let limits = Limits {
        velocity,
        acceleration,
        deceleration: acceleration,
        jerk,
        snap,
    };
    GridPlan::new(Method::Sequential, 0.0, distance, &limits, cycle).expect("a plan")
}

/// The first sample at which the generator leaves the plan, if it does before the plan ends.
pub fn first_difference<T: Clock>(plan: &GridPlan) -> Option<u64> {
    let mut generator = Generator::<T>::new(plan.cycle());
    let edge = 3;
    for k in 0..edge + 2 {
        let chain = generator.sample(k >= edge, plan);
        assert_eq!(chain, Euler::default(), "before the first snap");
    }
    (0..=u64::from(plan.scans()) + 5).find(|k| generator.sample(true, plan) != plan.euler(*k))
}

fn random_moves() -> Vec<GridPlan> {
    let mut random = Random(0x1E04);
    let mut moves = Vec::new();
    while moves.len() < 200 {
        let velocity = random.log(0.01, 10.0);
        let acceleration = velocity * random.log(1.0, 300.0);
        let jerk = acceleration * random.log(1.0, 1000.0);
        let snap = jerk * random.log(1.0, 3000.0);
        let distance = random.sign() * velocity * random.log(1e-4, 2.0);
        let plan = sequential(
            distance,
            [velocity, acceleration, jerk, snap],
            random.log(2e-4, 1e-2),
        );
        if plan.scans() < 4000 {
            moves.push(plan);
        }
    }
    moves
}

#[test]
fn the_generator_runs_the_plan_sample_by_sample() {
    let mut kinds = [0; 4];
    for plan in random_moves() {
        assert_eq!(first_difference::<f64>(&plan), None, "{plan:?}");
        let counts = plan.counts().expect("counts");
        kinds[0] += u32::from(counts.nj == Some(0));
        kinds[1] += u32::from(counts.na == 0);
        kinds[2] += u32::from(counts.nv == 0);
        kinds[3] += u32::from(counts.nj > Some(0) && counts.na > 0 && counts.nv > 0);
    }
    assert!(kinds.iter().all(|count| *count > 5), "{kinds:?}");
}

/// A second edge runs a second profile on top of the first: the integrators are never reset and need not be.
#[test]
fn a_second_start_goes_on_from_where_the_first_ended() {
    let limits = [1.2, 15.0, 400.0, 21_000.0];
    let first = sequential(0.35, limits, 0.001);
    let second = sequential(-0.2, limits, 0.001);
    let mut generator = Generator::<f64>::new(0.001);
    for k in 0..u64::from(first.scans()) + 20 {
        generator.sample(k > 0, &first);
    }
    let rest = generator.sample(false, &first);
    assert_eq!(rest.position, first.product() as i128);
    assert_eq!(
        (rest.velocity, rest.acceleration, rest.jerk, rest.input),
        (0, 0, 0, 0)
    );
    generator.sample(true, &second);
    generator.sample(true, &second);
    for k in 0..=u64::from(second.scans()) {
        let chain = generator.sample(true, &second);
        let expected = second.euler(k);
        assert_eq!(chain.position - rest.position, expected.position);
        assert_eq!(chain.velocity, expected.velocity);
    }
}

/// The clock adds up cycles: in 32 bits it is half a sample off, and the profile wrong, within 30 s.
/// Counting samples in whole numbers, as the plan does, never is.
#[test]
fn a_clock_of_32_bits_goes_wrong_in_a_long_move() {
    let limits = [0.05, 1.0, 20.0, 400.0];
    let long = sequential(1.5, limits, 0.001);
    assert!(long.scans() > 30_000);
    assert_eq!(first_difference::<f64>(&long), None);
    assert!(first_difference::<f32>(&long).is_some());
    let short = sequential(0.05, limits, 0.001);
    assert_eq!(first_difference::<f32>(&short), None);
}

/// In physical units and floating point, as the paper has it, the chain drifts; the integers do not.
#[test]
fn the_floating_point_chain_agrees_to_rounding() {
    for plan in random_moves().into_iter().take(60) {
        let ts = plan.cycle();
        let mut generator = Generator::<f64>::new(ts);
        let (mut x, mut v, mut a, mut j, mut d) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for k in 0..u64::from(plan.scans()) + 5 {
            (x, v, a, j) = (x + ts * v, v + ts * a, a + ts * j, j + ts * d);
            d = generator.sample(k > 0, &plan).input as f64 * plan.amplitude();
        }
        let way = plan.target();
        assert!((x - way).abs() <= 1e-9 * way.abs(), "{x} {way}");
        let peaks = plan.peaks();
        assert!(v.abs() <= 1e-9 * peaks.velocity && a.abs() <= 1e-9 * peaks.acceleration);
    }
}

//! The common parts of the grid tests: the reference vectors, seeded random moves and a digest.
use serde_json::Value;
use standstill_planner::grid::Peaks;
use standstill_planner::{GridPlan, Limits, Method, PlanError, Setpoint};
pub use standstill_testkit::Random;

/// One move to plan.
#[derive(Clone, Copy, Debug)]
pub struct Move {
    pub start: f64,
    pub target: f64,
    pub limits: Limits,
    pub cycle: f64,
}

impl Move {
    pub fn plan(&self, method: Method) -> Result<GridPlan, PlanError> {
        GridPlan::new(method, self.start, self.target, &self.limits, self.cycle)
    }
}

/// The same bound on acceleration and deceleration; infinite is none.
pub fn limits(velocity: f64, acceleration: f64, jerk: f64, snap: f64) -> Limits {
    Limits {
        velocity,
        acceleration,
        deceleration: acceleration,
        jerk,
        snap,
    }
}

/// The most that rounding may add to a bound: the slack of eq. 7 in docs/planner.md, and that of products.
const SLACK: f64 = 1.0 + 1.0 / (1_u64 << 39) as f64;

/// The largest magnitudes of the four derivatives; 0 for those that an order does not have.
pub fn four(peaks: &Peaks) -> [f64; 4] {
    let [jerk, snap] = [peaks.jerk, peaks.snap].map(Option::unwrap_or_default);
    [peaks.velocity, peaks.acceleration, jerk, snap]
}

/// Whether a continuous plan with these peaks keeps every bound; of two rates the higher one.
pub fn keeps(peaks: &Peaks, bounds: &Limits) -> bool {
    let rate = bounds.acceleration.max(bounds.deceleration);
    let bounds = [bounds.velocity, rate, bounds.jerk, bounds.snap];
    four(peaks)
        .iter()
        .zip(bounds)
        .all(|(peak, bound)| *peak <= bound * SLACK)
}

/// The vectors of tests/data/planner4-basic.json.
pub fn vectors() -> Vec<Value> {
    let text = include_str!("../data/planner4-basic.json");
    let file: Value = serde_json::from_str(text).expect("the vector file is JSON");
    file["vectors"].as_array().expect("vectors").clone()
}

/// A number of a vector file, where words stand for what JSON cannot say; null is an absent bound.
pub fn number(value: &Value) -> f64 {
    match value {
        Value::Null => f64::INFINITY,
        Value::String(word) if word == "NaN" => f64::NAN,
        Value::String(word) if word == "Infinity" => f64::INFINITY,
        Value::String(digits) => digits.parse().expect("a number"),
        _ => value.as_f64().expect("a number"),
    }
}

/// The move of a vector.
pub fn vector_move(vector: &Value) -> Move {
    let given = &vector["in"];
    let start = number(&given["x0"]);
    Move {
        start,
        // Vectors with an absolute target give both; dx is then the rounded difference.
        target: match given.get("target") {
            Some(target) => number(target),
            None => start + number(&given["dx"]),
        },
        limits: limits(
            number(&given["v"]),
            number(&given["a"]),
            number(&given["j"]),
            number(&given["s"]),
        ),
        cycle: number(&given["ts"]),
    }
}

/// `x` to a power of 0 or more, multiplied out so that every platform rounds alike.
pub fn power(x: f64, exponent: u64) -> f64 {
    (0..exponent).fold(1.0, |product, _| product * x)
}

/// A servo-like move of order 4, 3 or 2, mostly 4.
pub fn servo(random: &mut Random) -> Move {
    let velocity = random.log(0.01, 10.0);
    let acceleration = velocity * random.log(1.0, 300.0);
    let jerk = acceleration * random.log(1.0, 1000.0);
    let snap = jerk * random.log(1.0, 3000.0);
    let distance = velocity * random.log(1e-4, 10.0);
    let absent = f64::INFINITY;
    let kind = random.below(16);
    let limits = match kind {
        0 | 1 => limits(velocity, acceleration, jerk, absent),
        2 => limits(velocity, acceleration, absent, absent),
        3 => limits(absent, acceleration, jerk, snap),
        4 => limits(velocity, absent, jerk, snap),
        5 => limits(velocity, acceleration, absent, snap),
        _ => limits(velocity, acceleration, jerk, snap),
    };
    let start = match random.below(3) {
        0 => 0.0,
        1 => random.log(1e-3, 1e3),
        _ => -random.log(1e-3, 1e3),
    };
    let distance = if random.bits() & 1 == 1 {
        distance
    } else {
        -distance
    };
    Move {
        start,
        target: start + distance,
        limits,
        cycle: random.log(1e-4, 1e-2),
    }
}

/// FNV-1a of 64 bits over the bits of numbers.
pub struct Digest(pub u64);

impl Digest {
    pub fn new() -> Self {
        Self(0xCBF2_9CE4_8422_2325)
    }

    pub fn add(&mut self, word: u64) {
        for byte in word.to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3);
        }
    }

    pub fn add_setpoint(&mut self, setpoint: &Setpoint) {
        for value in setpoint.numbers() {
            self.add(value.to_bits());
        }
    }
}

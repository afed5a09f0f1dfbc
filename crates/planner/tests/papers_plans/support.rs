//! The published cases, an integrator that shares no code with the planner, and seeded random numbers.

use serde_json::Value;
use standstill_planner::papers::Profile;
use standstill_planner::{Limits, Segment};
pub use standstill_testkit::Random;

/// The cases of one system.
pub fn cases(algorithm: &str) -> Vec<Value> {
    let text = include_str!("../data/planner3-published.json");
    let file: Value = serde_json::from_str(text).expect("JSON");
    let cases = file["cases"].as_array().expect("a list").iter();
    let found: Vec<_> = cases
        .filter(|case| case["algorithm"] == algorithm)
        .cloned()
        .collect();
    assert!(!found.is_empty(), "no case of {algorithm}");
    found
}

pub fn case(id: &str) -> Value {
    let text = include_str!("../data/planner3-published.json");
    let file: Value = serde_json::from_str(text).expect("JSON");
    let mut cases = file["cases"].as_array().expect("a list").iter();
    cases.find(|case| case["id"] == id).expect("the case").clone()
}

pub fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is not a number"))
}

pub fn numbers(value: &Value) -> Vec<f64> {
    value
        .as_array()
        .unwrap_or_else(|| panic!("{value} is not a list"))
        .iter()
        .map(number)
        .collect()
}

/// A list of lists.
pub fn rows(value: &Value) -> Vec<Vec<f64>> {
    let rows = value
        .as_array()
        .unwrap_or_else(|| panic!("{value} is not a list"));
    rows.iter().map(numbers).collect()
}

/// Bounds of order 3.
pub fn bounds(velocity: f64, acceleration: f64, jerk: f64) -> Limits {
    Limits {
        velocity,
        acceleration,
        deceleration: acceleration,
        jerk,
        snap: f64::INFINITY,
    }
}

/// The bounds V, A and J of a case.
pub fn case_bounds(case: &Value) -> Limits {
    let input = &case["input"];
    bounds(number(&input["V"]), number(&input["A"]), number(&input["J"]))
}

/// Asserts that a number is within the tolerance of its case.
pub fn close(case: &Value, what: &str, value: f64, expected: f64) {
    let tolerance = &case["tolerance"];
    let bound = number(&tolerance["abs"]) + number(&tolerance["rel"]) * value.abs().max(expected.abs());
    assert!(
        (value - expected).abs() <= bound,
        "{}: {what} is {value} instead of {expected}",
        case["id"]
    );
}

/// Position, velocity and acceleration.
pub type State = [f64; 3];

/// The state after `jerk` for a time, by the moments of the jerk.
fn after([p, v, a]: State, t: f64, jerk: f64) -> State {
    let half = t * t / 2.0;
    [
        p + v * t + a * half + jerk * half * t / 3.0,
        v + a * t + jerk * half,
        a + jerk * t,
    ]
}

/// Where segments of (duration, jerk) lead.
pub fn integrated(start: State, segments: impl IntoIterator<Item = (f64, f64)>) -> State {
    segments
        .into_iter()
        .fold(start, |state, (t, jerk)| after(state, t, jerk))
}

/// The state `time` after the start, from the published segments of a move at order 3.
pub fn integrated_until(start: State, segments: &[Segment], time: f64) -> State {
    let mut state = start;
    let mut left = time;
    for segment in segments {
        let part = segment.duration.min(left);
        state = after(state, part, segment.jerk);
        left -= part;
    }
    state
}

/// Asserts the whole profile that a case states, from `start`.
pub fn same_profile(case: &Value, expected: &Value, profile: &Profile, start: State) {
    let segments: Vec<_> = profile.segments().collect();
    // Segments of length 0, and neighbours of the same jerk, say nothing.
    let mut merged: Vec<(f64, f64)> = Vec::new();
    for segment in expected["segments"].as_array().expect("a list") {
        let (t, jerk) = (number(&segment[0]), number(&segment[1]));
        match merged.last_mut() {
            _ if t < 1e-12 * number(&expected["T"]) => {}
            Some(last) if last.1 == jerk => last.0 += t,
            _ => merged.push((t, jerk)),
        }
    }
    let mut ours: Vec<(f64, f64)> = Vec::new();
    for segment in &segments {
        match ours.last_mut() {
            Some(last) if last.1 == segment.jerk => last.0 += segment.duration,
            _ => ours.push((segment.duration, segment.jerk)),
        }
    }
    assert_eq!(merged.len(), ours.len(), "{}: {ours:?}", case["id"]);
    for ((t, jerk), (expected_t, expected_jerk)) in ours.iter().zip(&merged) {
        close(case, "duration of a segment", *t, *expected_t);
        close(case, "jerk", *jerk, *expected_jerk);
    }
    close(case, "T", profile.duration(), number(&expected["T"]));
    let peaks = profile.peaks();
    let magnitude = |low: &str, high: &str| number(&expected[low]).abs().max(number(&expected[high]).abs());
    close(case, "velocity", peaks.velocity, magnitude("v_min", "v_max"));
    close(
        case,
        "acceleration",
        peaks.acceleration,
        magnitude("a_min", "a_max"),
    );
    close(case, "jerk", peaks.jerk, number(&expected["j_peak"]));
    let end = profile.end();
    let stated = numbers(&expected["end"]);
    for (value, expected) in [end.position, end.velocity, end.acceleration].iter().zip(&stated) {
        close(case, "the end", *value, *expected);
    }
    for sample in expected["samples"].as_array().into_iter().flatten() {
        let sample = numbers(sample);
        let (time, expected) = sample.split_first().expect("a time");
        let state = profile.at(*time);
        let seen = [state.position, state.velocity, state.acceleration];
        let outside = integrated_until(start, &segments, *time);
        for i in 0..3 {
            close(case, &format!("sample {i} at {time}"), seen[i], expected[i]);
            let scale = expected[i].abs() + 1e-3;
            assert!((seen[i] - outside[i]).abs() <= 1e-12 * scale.max(1.0));
        }
    }
}

/// Cube root of a positive number by Newton's steps from far away: a math library's bits differ.
pub fn cube_root(x: f64) -> f64 {
    (0..200).fold(x.max(1.0), |root, _| (2.0 * root + x / (root * root)) / 3.0)
}

/// The number of random cases: `count`, times `STANDSTILL_SOAK_FACTOR` if that is set.
pub fn rounds(count: u64) -> u64 {
    count * standstill_testkit::given("STANDSTILL_SOAK_FACTOR", 1)
}

/// Bounds of order 3 that may each be the decisive one.
pub fn random_bounds(random: &mut Random) -> Limits {
    let velocity = random.log(0.01, 100.0);
    let acceleration = velocity * random.log(0.1, 100.0);
    bounds(velocity, acceleration, acceleration * random.log(0.1, 100.0))
}

/// Asserts that a profile, stepped from `start` by its segments, keeps `limits`, is continuous and ends where
/// it says.
pub fn keeps_its_word(profile: &Profile, start: State, limits: &Limits, what: &str) {
    let mut state = start;
    let mut time = 0.0;
    let length = profile.end().position.abs() + start[0].abs() + limits.velocity * profile.duration();
    let within = |value: f64, limit: f64| value.abs() <= limit * (1.0 + 1e-9);
    for segment in profile.segments() {
        assert!(segment.duration > 0.0 && segment.duration.is_finite(), "{what}");
        assert!(within(segment.jerk, limits.jerk), "{what}");
        let [_, v, a] = state;
        assert!((segment.velocity - v).abs() <= 1e-11 * limits.velocity, "{what}");
        assert!(
            (segment.acceleration - a).abs() <= 1e-11 * limits.acceleration,
            "{what}"
        );
        // The rounding residue of a zero acceleration would be integrated over a long cruise.
        state = [state[0], segment.velocity, segment.acceleration];
        for step in 0..=8 {
            let t = segment.duration * f64::from(step) / 8.0;
            let [p, v, a] = after(state, t, segment.jerk);
            assert!(within(v, limits.velocity), "{what}: velocity {v}");
            let bound = if a * v > 0.0 {
                limits.acceleration
            } else {
                limits.deceleration
            };
            assert!(
                within(a, bound) || a.abs() < 1e-9 * limits.acceleration,
                "{what}: acceleration {a}"
            );
            let seen = profile.at(time + t);
            assert!(
                (seen.position - p).abs() <= 1e-12 * length,
                "{what}: {seen:?} {p}"
            );
            // Late in a long move an instant has no more digits than the clock.
            let clock = limits.acceleration * f64::EPSILON * profile.duration();
            assert!(
                (seen.velocity - v).abs() <= 1e-11 * limits.velocity + clock,
                "{what}"
            );
        }
        state = after(state, segment.duration, segment.jerk);
        time += segment.duration;
    }
    let end = profile.end();
    assert!((state[0] - end.position).abs() <= 1e-12 * length, "{what}");
    assert!(
        (state[1] - end.velocity).abs() <= 1e-11 * limits.velocity,
        "{what}: {state:?} {end:?}"
    );
    assert!(state[2].abs() <= 1e-9 * limits.acceleration, "{what}");
    assert!((time - profile.duration()).abs() <= 1e-12 * time, "{what}");
    assert_eq!(profile.at(profile.duration()), end, "{what}");
}

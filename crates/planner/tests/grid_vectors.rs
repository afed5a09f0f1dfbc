//! The reference vectors: counts, minima, amplitudes, checkpoints and refusals.

use crate::grid_support::{number, vector_move, vectors};
use serde_json::Value;
use standstill_planner::grid::Counts;
use standstill_planner::{GridPlan, Method, PlanError};

/// Whether a value is within `ulps` units in the last place, plus the rounding of the vector's distance by the
/// start position.
fn agrees(value: f64, expected: f64, ulps: f64, vector: &Value) -> bool {
    let request = vector_move(vector);
    let distance = number(&vector["in"]["dx"]);
    let lost = ((request.target - request.start) - distance).abs() / distance.abs();
    (value - expected).abs() <= (ulps * f64::EPSILON + lost) * expected.abs()
}

fn planned() -> impl Iterator<Item = (String, Value)> {
    vectors()
        .into_iter()
        .filter(|vector| vector.get("error").is_none())
        .map(|vector| (vector["id"].as_str().expect("id").to_owned(), vector))
}

fn count(value: &Value) -> Option<u32> {
    value.as_u64().map(|n| n as u32)
}

fn plan(vector: &Value, method: Method) -> GridPlan {
    vector_move(vector).plan(method).expect("a valid vector")
}

#[test]
fn sequential_counts_amplitude_and_peaks_are_those_of_the_vectors() {
    for (id, vector) in planned() {
        let plan = plan(&vector, Method::Sequential);
        let seq = &vector["seq"];
        assert_eq!(u64::from(plan.scans()), seq["N"].as_u64().expect("N"), "{id}");
        if plan.scans() == 0 {
            continue;
        }
        let expected = Counts {
            nd: count(&seq["nd"]),
            nj: count(&seq["nj"]),
            na: count(&seq["na"]).expect("na"),
            nv: count(&seq["nv"]).expect("nv"),
        };
        assert_eq!(plan.counts(), Some(expected), "{id}");
        assert_eq!(plan.product().to_string(), seq["P"].as_str().expect("P"), "{id}");
        let amplitude = number(&seq["amplitude"]);
        assert!(
            agrees(plan.amplitude(), amplitude, 4.0, &vector),
            "{id}: {} {amplitude}",
            plan.amplitude()
        );
        let peaks = plan.peaks();
        let pairs = [
            (Some(peaks.velocity), &seq["v_peak"]),
            (Some(peaks.acceleration), &seq["a_peak"]),
            (peaks.jerk, &seq["j_peak"]),
        ];
        for (peak, expected) in pairs {
            if let Some(peak) = peak.filter(|_| !expected.is_null()) {
                assert!(
                    agrees(peak, number(expected), 8.0, &vector),
                    "{id}: {peak} {expected}"
                );
            }
        }
    }
}

#[test]
fn grid_and_overlapped_need_exactly_the_minimum_of_the_vectors() {
    for (id, vector) in planned() {
        let grid = plan(&vector, Method::Grid);
        assert_eq!(
            u64::from(grid.scans()),
            vector["opt"]["N"].as_u64().expect("N"),
            "{id}"
        );
        let overlapped = plan(&vector, Method::Overlapped);
        match vector["ext_overlap"]["N"].as_u64() {
            Some(least) => assert_eq!(u64::from(overlapped.scans()), least, "{id}"),
            None => assert!(overlapped.scans() <= grid.scans(), "{id}"),
        }
        // Rounding to the grid can't beat the optimum of continuous time.
        if let Some(continuous) = vector["n_continuous"].as_f64() {
            assert!(f64::from(grid.scans()) >= continuous * (1.0 - 1e-9), "{id}");
        }
        if let Some(least) = vector["lp_lower_bound"].as_u64() {
            assert!(u64::from(overlapped.scans()) >= least, "{id}");
        }
    }
}

#[test]
fn forward_euler_passes_the_checkpoints_of_the_vectors() {
    for (id, vector) in planned() {
        let plan = plan(&vector, Method::Sequential);
        let distance = plan.target() - plan.start();
        let product = plan.product() as f64;
        let ts = plan.cycle();
        for check in vector["checkpoints"].as_array().expect("checkpoints") {
            let k = check["k"].as_u64().expect("k");
            let state = plan.euler(k);
            assert_eq!(
                state.position.to_string(),
                check["p"].as_str().expect("p"),
                "{id} at {k}"
            );
            let agree = |value: f64, key: &str| {
                assert!(
                    agrees(value, number(&check[key]), 8.0, &vector),
                    "{id} at {k}, {key}: {value} instead of {}",
                    check[key]
                );
            };
            agree(plan.start() + distance * (state.position as f64 / product), "x");
            agree(distance * state.velocity as f64 / (product * ts), "v");
            agree(distance * state.acceleration as f64 / (product * ts * ts), "a");
            if check.get("j").is_some_and(|j| !j.is_null()) {
                agree(distance * state.jerk as f64 / (product * ts * ts * ts), "j");
            }
        }
        let end = plan.at(u64::from(plan.scans())).position;
        assert_eq!(end.to_bits(), number(&vector["final"]).to_bits(), "{id}");
    }
}

#[test]
fn refused_vectors_are_refused_for_the_reason_of_the_vectors() {
    let mut seen = 0;
    for vector in vectors() {
        let Some(error) = vector["error"].as_str() else {
            continue;
        };
        seen += 1;
        let request = vector_move(&vector);
        if request.limits.acceleration.is_infinite() {
            // Infinite means no bound in this interface; the reader is the one to refuse the word.
            assert!(request.plan(Method::Overlapped).is_ok());
            continue;
        }
        for method in [Method::Sequential, Method::Grid, Method::Overlapped] {
            let refused = request.plan(method).expect_err("a refusal");
            let kind = match refused {
                PlanError::InvalidInput { .. } => "invalid_input",
                PlanError::TooLong { .. } => "too_long",
                other => panic!("unexpected {other:?}"),
            };
            assert_eq!(kind, error, "{}", vector["id"]);
        }
    }
    assert_eq!(seen, 6);
}

//! The planner's part of `plan`, for `crates/python/bench/speed.py`. It reads lines and prints the nanoseconds for
//! each, from keys and numbers to the plan with its segments: the least of several tries.

use standstill_cli::plan::{Given, Member, planned};
use std::hint::black_box;
use std::io::BufRead;
use std::time::Instant;

const CALLS: u32 = 20_000;
const TRIES: u32 = 9;

fn main() {
    for line in std::io::stdin().lock().lines() {
        let line: serde_json::Value = serde_json::from_str(&line.unwrap_or_default()).unwrap_or_default();
        let texts: Vec<(&String, String)> = members(&line)
            .map(|(key, value)| (key, value.to_string()))
            .collect();
        let limits: Vec<Member<'_>> = members(&line["limits"])
            .map(|(key, value)| (key.into(), Given::Number(value.as_f64().unwrap_or_default())))
            .collect();
        let whole: Vec<Member<'_>> = texts
            .iter()
            .map(|(key, text)| match (text.parse(), key.as_str()) {
                (_, "limits") => ("limits".into(), Given::Object(&limits)),
                (Ok(number), _) => (key.as_str().into(), Given::Number(number)),
                (Err(_), _) => (key.as_str().into(), Given::Json(text)),
            })
            .collect();
        let least = (0..TRIES).map(|_| {
            let begin = Instant::now();
            for _ in 0..CALLS {
                let _ = black_box(planned(black_box(whole.clone())));
            }
            begin.elapsed() / CALLS
        });
        println!("{}", least.min().unwrap_or_default().as_nanos());
    }
}

fn members(object: &serde_json::Value) -> impl Iterator<Item = (&String, &serde_json::Value)> {
    object.as_object().into_iter().flatten()
}

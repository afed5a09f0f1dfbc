//! One call of a block through the C library as a multiple of the same call in Rust, in the same run.

// Only to call the library.
#![allow(unsafe_code)]

mod hosts;

use hosts::{CHost, RustHost, Wishes};
use std::hint::black_box;
use std::time::Instant;

const ROUNDS: usize = 301;
const CALLS: u64 = 2000;
/// The most calls in Rust a call through the library may take.
const BAR: f64 = 1.5;

fn time(mut run: impl FnMut()) -> f64 {
    let start = Instant::now();
    for _ in 0..CALLS {
        run();
    }
    start.elapsed().as_nanos() as f64 / CALLS as f64
}

fn median(values: &mut [f64]) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Takes both by turns, so that a busy machine slows both.
fn compare(name: &str, mut rust: impl FnMut(u64), mut c: impl FnMut(u64)) {
    let (mut in_rust, mut in_c, mut ratios) = (Vec::new(), Vec::new(), Vec::new());
    let mut number = 0;
    for _ in 0..ROUNDS {
        let before = time(|| {
            number += 1;
            rust(number);
        });
        let took = time(|| {
            number += 1;
            c(number);
        });
        let after = time(|| {
            number += 1;
            rust(number);
        });
        in_rust.push(0.5 * (before + after));
        in_c.push(took);
        ratios.push(took / (0.5 * (before + after)));
    }
    let ratio = median(&mut ratios);
    println!(
        "{name:<34} {:>8.2} {:>8.2} {ratio:>6.2} {BAR:>5}{}",
        median(&mut in_rust),
        median(&mut in_c),
        if ratio > BAR { "  ABOVE" } else { "" }
    );
}

fn main() {
    println!(
        "{:<34} {:>8} {:>8} {:>6} {:>5}",
        "one call of MC_MoveAbsolute", "Rust ns", "C ns", "ratio", "bar"
    );
    let (mut rust, mut c) = (
        RustHost::in_motion().expect("valid"),
        CHost::in_motion().expect("valid"),
    );
    compare(
        "in progress",
        |_| assert!(black_box(rust.call(black_box(&Wishes::MOVE), black_box(0))).is_some_and(|out| out.1)),
        |_| assert!(black_box(c.call(black_box(&Wishes::MOVE))).is_some_and(|out| out.1)),
    );
    let (mut rust, mut c) = (
        RustHost::in_motion().expect("valid"),
        CHost::in_motion().expect("valid"),
    );
    // Every second call gives a command, which is planned at once.
    let wishes = |number: u64| Wishes {
        execute: number.is_multiple_of(2),
        ..Wishes::MOVE
    };
    compare(
        "commanded in every second call",
        |number| assert!(black_box(rust.call(black_box(&wishes(number)), black_box(0))).is_some()),
        |number| assert!(black_box(c.call(black_box(&wishes(number)))).is_some()),
    );
}

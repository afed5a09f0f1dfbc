//! One call of a block by a host in C beside the same call by a host in Rust, in the same run.
//!
//! Both do the work of a host in every scan: write inputs, call, read the outputs. Without a C compiler
//! there is nothing to measure, and it says so.

mod hosts;

use hosts::{CHost, RustHost};
use standstill_axis::AxisId;
use standstill_bench::{LIMITS, TARGET};
use standstill_blocks::BlockInstance;
use standstill_fb::Time;
use std::hint::black_box;
use std::process::{Command, ExitCode};
use std::time::Instant;

const ROUNDS: usize = 301;
const CALLS: u64 = 2000;
/// The most a call in C may take longer than a call in Rust (ns).
const BAR: f64 = 10.0;

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

/// Measures both in turn, so that a busy machine slows both; none if the host in C has ended.
fn compare(name: &str, host: &mut CHost, measure: &str, mut rust: impl FnMut(u64)) -> Option<()> {
    let (mut in_rust, mut in_c, mut more) = (Vec::new(), Vec::new(), Vec::new());
    let mut number = 0;
    let mut take = || {
        time(|| {
            number += 1;
            rust(number);
        })
    };
    host.time(measure, CALLS)?;
    for _ in 0..ROUNDS {
        let before = take();
        let took = host.time(measure, CALLS)?;
        let after = take();
        in_rust.push(0.5 * (before + after));
        in_c.push(took);
        more.push(took - 0.5 * (before + after));
    }
    let more = median(&mut more);
    println!(
        "{name:<62} {:>8.2} {:>8.2} {more:>6.2} {BAR:>5}{}",
        median(&mut in_rust),
        median(&mut in_c),
        if more > BAR { "  ABOVE" } else { "" }
    );
    Some(())
}

/// Compares calls of a block: the inputs that are always the same, the one that may change, and the outputs. Both
/// for hosts that write all inputs in every scan, and for hosts that write only those that may change.
macro_rules! measure {
    (
        $host:ident, $what:literal, $name:literal, $measure:literal, $block:ident,
        $inputs:ident => $same:block, $number:ident => $change:block, $outputs:ident => $good:expr
    ) => {
        for (is_anew, how, measure) in [
            (true, "all inputs", $measure),
            (true, "all from _in_default()", concat!($measure, "_default")),
            (false, "one", concat!($measure, "_kept")),
        ] {
            let mut rust = RustHost::new($name).expect("valid");
            if let (Some(BlockInstance::$block(instance)), _) = rust.parts(0) {
                let $inputs = &mut instance.inputs;
                $same
            }
            compare(&format!("{}, {how}", $what), $host, measure, |$number| {
                let (block, mut context) = rust.parts(black_box(0));
                let Some(BlockInstance::$block(instance)) = block else {
                    unreachable!("it was made above");
                };
                let $inputs = &mut instance.inputs;
                if is_anew {
                    *$inputs = Default::default();
                    $same
                }
                $change
                instance.call(&mut context);
                let $outputs = &instance.outputs;
                assert!(black_box($good));
            })?;
        }
    };
}

fn measures(host: &mut CHost) -> Option<()> {
    let axis = AxisId::new(0);
    let (velocity, target) = (black_box(LIMITS.velocity), black_box(TARGET));
    measure!(
        host, "MC_MoveAbsolute in its move", "MC_MoveAbsolute", "move", McMoveAbsolute,
        inputs => { (inputs.axis, inputs.position, inputs.velocity) = (axis, target, velocity); },
        _number => { inputs.execute = true; },
        outputs => outputs.active && !outputs.error
    );
    measure!(
        host, "the same, commanded every second time", "MC_MoveAbsolute", "command", McMoveAbsolute,
        inputs => { (inputs.axis, inputs.position, inputs.velocity) = (axis, target, velocity); },
        number => { inputs.execute = number.is_multiple_of(2); },
        outputs => !outputs.error
    );
    measure!(
        host, "MC_MoveVelocity in motion", "MC_MoveVelocity", "turn", McMoveVelocity,
        inputs => { (inputs.axis, inputs.velocity) = (axis, velocity); },
        _number => { inputs.execute = true; },
        outputs => outputs.active && !outputs.error
    );
    measure!(
        host, "MC_Power of a powered axis", "MC_Power", "power", McPower,
        inputs => { (inputs.axis, inputs.enable_positive, inputs.enable_negative) = (axis, true, true); },
        _number => { inputs.enable = true; },
        outputs => outputs.status && !outputs.error
    );
    measure!(
        host, "MC_ReadStatus", "MC_ReadStatus", "status", McReadStatus,
        inputs => { inputs.axis = axis; },
        _number => { inputs.enable = true; },
        outputs => outputs.valid && !outputs.error
    );
    measure!(
        host, "TON that runs", "TON", "timer", Ton,
        inputs => { inputs.pt = Time(1_000_000_000); },
        _number => { inputs.input = true; },
        outputs => !outputs.q
    );
    Some(())
}

fn main() -> ExitCode {
    if Command::new("cc").arg("--version").output().is_err() {
        println!("SKIP: there is no C compiler `cc`, so there is no host in C to measure");
        return ExitCode::SUCCESS;
    }
    let mut host = match CHost::start() {
        Ok(host) => host,
        Err(why) => {
            eprintln!("{why}");
            return ExitCode::FAILURE;
        }
    };
    println!(
        "{:<62} {:>8} {:>8} {:>6} {:>5}",
        "one call of .. by a host that writes ..", "Rust ns", "C ns", "more", "bar"
    );
    let all = measures(&mut host);
    if all.is_none() || !host.end() {
        eprintln!("the host in C ended before it was asked to");
        return ExitCode::FAILURE;
    }
    ExitCode::SUCCESS
}

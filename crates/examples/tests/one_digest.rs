//! Feed and place in Rust, in C, as a guest made of the same C, and as a scan script of wires: every scan is the same to the
//! bit, and so is the digest.

mod common;

#[path = "../feed_and_place/host.rs"]
mod host;

use common::*;
use standstill_export::Target;
use standstill_trace::{Cell, Trace};
use std::fs;
use std::sync::OnceLock;

/// The run of the host in Rust, which needs no other tool.
fn rust() -> &'static Trace {
    static RUN: OnceLock<Trace> = OnceLock::new();
    RUN.get_or_init(|| {
        let mut trace = empty();
        host::run(|axes, lamps| {
            let mut cells = Vec::new();
            for axis in axes {
                let setpoint = &axis.setpoint;
                cells.push(Cell::Name(axis.state.name()));
                cells.extend(
                    [
                        setpoint.position,
                        setpoint.velocity,
                        setpoint.acceleration,
                        setpoint.jerk,
                        setpoint.snap,
                        axis.actual_position,
                    ]
                    .map(Cell::Real),
                );
            }
            cells.extend([lamps.state, lamps.parts, lamps.aborts].map(|number| Cell::Integer(number.into())));
            cells.extend(
                lamps
                    .feed
                    .iter()
                    .chain(&lamps.place)
                    .map(|lamp| Cell::Bool(*lamp)),
            );
            trace.push_row(&cells).unwrap();
        })
        .unwrap();
        trace
    })
}

#[test]
fn in_rust() {
    hold("Rust", rust(), None);
}

#[test]
fn as_a_function_block_diagram() {
    let trace = of_script(&folder().join("wired.scan.json"), |run, scan| {
        let cell = |name: &str| run.cell(scan, run.column(name).unwrap()).unwrap();
        let flag = |name: &str| match cell(name) {
            Cell::Bool(value) => value,
            other => panic!("{name}: {other:?}"),
        };
        let count = |name: &str| match cell(name) {
            Cell::Integer(value) => Cell::Integer(value),
            other => panic!("{name}: {other:?}"),
        };
        // A latch stands for a state; at most one of them is on.
        let states = [
            ("feeding.Q1", 10),
            ("settling.Q1", 20),
            ("placing.Q1", 30),
            ("returning.Q1", 40),
            ("stopped.Q1", 90),
        ];
        let on: Vec<_> = states.iter().filter(|(latch, _)| flag(latch)).collect();
        assert!(on.len() <= 1, "scan {scan}: {on:?}");
        let mut cells = vec![
            Cell::Integer(on.first().map_or(0, |(_, state)| *state)),
            count("parts.CV"),
            count("aborts.CV"),
        ];
        for block in ["feed", "place"] {
            for pin in ["Busy", "Done", "CommandAborted"] {
                cells.push(Cell::Bool(flag(&format!("{block}.{pin}"))));
            }
        }
        cells
    });
    hold("wires", &trace, Some(rust()));
}

#[test]
fn in_c() {
    if !has("cc") {
        return;
    }
    let (out, library) = (scratch("feed-and-place-c"), library());
    exported(Target::C, &out);
    let program = out.join("feed_and_place");
    let mut command = vec![
        "-std=c11",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-pedantic",
        "-O2",
        "-I",
    ];
    let paths = [
        out.clone(),
        folder().join("host.c"),
        folder().join("program.c"),
        library,
    ];
    let paths = paths.map(|path| path.to_str().unwrap().to_owned());
    command.extend(paths.iter().map(String::as_str));
    command.extend(["-o", program.to_str().unwrap(), "-lpthread", "-ldl", "-lm"]);
    run("cc", command);
    let printed = run(&program, [""; 0]);
    let trace = of_lines(&String::from_utf8(printed.stdout).unwrap());
    hold("C", &trace, Some(rust()));
}

#[test]
fn as_a_guest() {
    if !has("clang") || !has("wasm-ld") {
        return;
    }
    let out = scratch("feed-and-place-guest");
    exported(Target::Wasm, &out);
    for file in ["cell.machine.json", "guest.scan.json"] {
        fs::copy(folder().join(file), out.join(file)).unwrap();
    }
    let (source, wasm) = (folder().join("program.c"), out.join("program.wasm"));
    let mut command = vec![
        "--target=wasm32".to_owned(),
        "-O2".to_owned(),
        "-ffreestanding".to_owned(),
        "-mbulk-memory".to_owned(),
        "-nostdlib".to_owned(),
        "-nostdlibinc".to_owned(),
        "-Wall".to_owned(),
        "-Wextra".to_owned(),
        "-Werror".to_owned(),
        format!("-I{}", out.display()),
        format!("-I{}", folder().join("freestanding").display()),
        "-Wl,--no-entry".to_owned(),
    ];
    let variables = VARIABLES.iter().map(|(name, _)| *name);
    command.extend(
        variables
            .chain(["Start", "Stop"])
            .map(|name| format!("-Wl,--export={name}")),
    );
    command.extend([
        source.display().to_string(),
        "-o".to_owned(),
        wasm.display().to_string(),
    ]);
    run("clang", command);
    let trace = of_guest(&out.join("guest.scan.json"), str::to_owned);
    hold("guest", &trace, Some(rust()));
}

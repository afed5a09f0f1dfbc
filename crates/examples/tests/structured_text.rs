//! `prog.st` through our own compiler, unchanged: the digest of the other hosts.

// The other tests build their hosts, too.
#[allow(dead_code)]
mod common;

use common::*;
use standstill_st::{Options, Source};
use std::fs;

#[test]
fn prog_st_as_it_stands() {
    let text = fs::read(folder().join("prog.st")).unwrap();
    let one_a_line = String::from_utf8(text.clone()).unwrap();
    // The same program with its declaration split into several.
    let split = one_a_line.replace(
        "Feed, Place, BackFeeder, BackPlacer : MC_MoveAbsolute;",
        "Feed : MC_MoveAbsolute; Place : MC_MoveAbsolute; BackFeeder, BackPlacer : MC_MoveAbsolute;",
    );
    for (name, text) in [
        ("feed-and-place-st", text),
        ("feed-and-place-st-split", split.into_bytes()),
    ] {
        let source = Source {
            name: "prog.st",
            bytes: &text,
        };
        let compiled = standstill_st::compile(&[source], &Options::default())
            .unwrap_or_else(|report| panic!("{report}"));
        let out = scratch(name);
        fs::write(out.join("program.wasm"), compiled.wasm).unwrap();
        for file in ["guest.scan.json", "cell.machine.json"] {
            fs::copy(folder().join(file), out.join(file)).unwrap();
        }
        let trace = of_guest(&out.join("guest.scan.json"), str::to_owned);
        hold("Structured Text", &trace, None);
    }
}

/// Covers: ST20, ST43
#[test]
fn prog_st_named_by_a_scan_script() {
    let trace = of_guest(&folder().join("text.scan.json"), str::to_owned);
    hold("Structured Text in a script", &trace, None);
}

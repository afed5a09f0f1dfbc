//! Other compilers accept programs of edition 2 of the standard with the same results.
//!
//! matiec is in no package registry, so this says SKIP without it. `docs/structured-text.md` lists what
//! is accepted only here.

mod matiec;

use crate::common::{Running, compiled};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

const PORTABLE: &str = include_str!("portable.st");

/// The answers of both, a line for each scan: the reference without matiec.
const AGREED: &str = include_str!("answers.txt");

/// Answers of a scan.
const ANSWERS: usize = 128;

const SCANS: usize = 12;

/// A scan is 1 ms, as ours is.
const CONFIGURATION: &str = "
CONFIGURATION Config0
  RESOURCE Res0 ON PLC
    TASK Main0(INTERVAL := T#1ms, PRIORITY := 0);
    PROGRAM I0 WITH Main0 : Main;
  END_RESOURCE
END_CONFIGURATION
";

/// Runs the program of matiec and prints its answers, a line for each scan.
const HOST: &str = r#"
#include <stdio.h>
#include "iec_std_lib.h"
#include "accessor.h"
#include "POUS.h"
TIME __CURRENT_TIME;
BOOL __DEBUG;
void config_init__(void);
void config_run__(unsigned long tick);
extern MAIN RES0__I0;
int main(void) {
    config_init__();
    for (unsigned long scan = 0; scan < SCANS; scan++) {
        __CURRENT_TIME.tv_sec = 0;
        __CURRENT_TIME.tv_nsec = (long)scan * 1000000;
        config_run__(scan);
        for (int n = 0; n < ANSWERS; n++) printf("%lld ", (long long)RES0__I0.R.value.table[n]);
        printf("\n");
    }
}
"#;

fn run(command: &mut Command) -> String {
    let ran = command.output().unwrap();
    let (said, wrong) = (
        String::from_utf8_lossy(&ran.stdout),
        String::from_utf8_lossy(&ran.stderr),
    );
    assert!(ran.status.success(), "{command:?}\n{said}{wrong}");
    said.into_owned()
}

fn of_matiec(library: &Path) -> String {
    let out = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("foreign");
    fs::create_dir_all(&out).unwrap();
    fs::write(out.join("all.st"), PORTABLE.to_owned() + CONFIGURATION).unwrap();
    let defines = format!("#define SCANS {SCANS}\n#define ANSWERS {ANSWERS}\n");
    fs::write(out.join("host.c"), defines + HOST).unwrap();
    let mut translate = Command::new("iec2c");
    run(translate
        .arg("-I")
        .arg(library)
        .args(["-p", "-T"])
        .arg(&out)
        .arg(out.join("all.st")));
    let program = out.join("host");
    let mut compile = Command::new("cc");
    compile.args(["-O1", "-w", "-DGLOBAL_CAST=", "-I"]);
    compile.arg(library.join("C")).arg("-I").arg(&out);
    let sources = ["Res0.c", "Config0.c", "host.c"].map(|name| out.join(name));
    run(compile.args(sources).arg("-o").arg(&program).arg("-lm"));
    run(&mut Command::new(program))
}

/// Covers: ST44
#[test]
fn edition_2_is_worth_the_same_in_matiec() {
    let mut ours = Running::of(compiled(PORTABLE));
    let mut told = String::new();
    for _ in 0..SCANS {
        ours.scan().unwrap();
        for n in 0..ANSWERS {
            let space = if n > 0 { " " } else { "" };
            told.push_str(&format!("{space}{}", ours.whole(&format!("R[{n}]"))));
        }
        told.push('\n');
    }
    assert_eq!(told, AGREED, "not what matiec and this compiler agreed on");
    let Some(library) = matiec::library() else {
        eprintln!("SKIP: {}", matiec::MISSING);
        return;
    };
    let theirs = of_matiec(&library);
    for (scan, (ours, theirs)) in told.lines().zip(theirs.lines().map(str::trim_end)).enumerate() {
        let differs: Vec<String> = ours
            .split(' ')
            .zip(theirs.split(' '))
            .enumerate()
            .filter(|(_, (ours, theirs))| ours != theirs)
            .map(|(n, (ours, theirs))| format!("R[{n}] ours {ours} theirs {theirs}"))
            .collect();
        assert!(differs.is_empty(), "scan {scan}: {differs:#?}");
    }
    assert_eq!(theirs.lines().count(), SCANS);
}

//! What edition 2 of the standard has, other compilers accept with the same results.
//!
//! matiec is in no package registry, so this says SKIP where there is no `iec2c` on the PATH, its library in `MATIEC_LIB` or beside
//! it. What else is accepted here and not there stands in `docs/structured-text.md`.

#[path = "../common/mod.rs"]
mod common;

use common::{Running, compiled};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

const PORTABLE: &str = include_str!("portable.st");

/// The answers of both, a line for each scan: what is held where there is no matiec.
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

/// Where `iec2c` has its standard functions; `None` without it.
fn matiec() -> Option<PathBuf> {
    Command::new("iec2c").arg("-v").output().ok()?;
    let path = env::var_os("PATH")?;
    let beside = env::split_paths(&path)
        .filter(|folder| folder.join("iec2c").exists())
        .flat_map(|folder| {
            ["lib", "../lib", "../lib/matiec", "../share/matiec/lib"].map(|lib| folder.join(lib))
        });
    let named = env::var_os("MATIEC_LIB").map(PathBuf::from);
    let found = named
        .into_iter()
        .chain(beside)
        .find(|lib| lib.join("ieclib.txt").exists());
    Some(found.expect("iec2c is here, but not its library: set MATIEC_LIB to the folder with ieclib.txt"))
}

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
    let Some(library) = matiec() else {
        eprintln!("SKIP: there is no iec2c; matiec is in no package registry, so nothing installs it");
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

//! Random well-typed programs give the same results as the same programs in C through clang.
//!
//! Without clang it says SKIP; with `CI` in the environment that is a failure. `STANDSTILL_ST_PROGRAMS=100000` runs
//! that many, `STANDSTILL_ST_SEED` others.

mod generate;

use crate::common::{Running, compile, valid};
use generate::{Generated, generate};
use standstill_guest::Settings;
use standstill_testkit::{Random, given};
use std::path::PathBuf;
use std::process::Command;
use std::{env, fs};

/// Programs of a file.
const PROGRAMS: usize = 200;

/// Number of runs of each.
const SCANS: usize = 3;

/// The output of clang's program, a line for each of ours; `None` without clang.
fn in_c(programs: &[Generated], seed: u64) -> Option<String> {
    let mut text = include_str!("prelude.h").to_owned();
    programs.iter().for_each(|it| text.push_str(&it.c));
    text.push_str("int main(void) {\n");
    for n in 0..programs.len() {
        text.push_str(&format!(
            "begin{n}(); for (int scan = 0; scan < {SCANS}; scan++) run{n}(); show{n}();\n"
        ));
    }
    text.push_str("}\n");
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join(format!("random_{seed:x}"));
    fs::create_dir_all(&folder).unwrap();
    let (source, program) = (folder.join("programs.c"), folder.join("programs"));
    fs::write(&source, text).unwrap();
    let built = Command::new("clang")
        .args(["-O0", "-ffp-contract=off", "-fno-strict-aliasing", "-w", "-o"])
        .args([&program, &source])
        .arg("-lm")
        .output();
    let built = match built {
        Ok(built) => built,
        Err(why) => {
            assert!(env::var_os("CI").is_none(), "clang is not here: {why}");
            eprintln!("SKIP: there is no clang");
            return None;
        }
    };
    assert!(
        built.status.success(),
        "{}",
        String::from_utf8_lossy(&built.stderr)
    );
    let ran = Command::new(&program).output().unwrap();
    assert!(ran.status.success(), "seed {seed}: {ran:?}");
    let _gone = fs::remove_dir_all(&folder);
    Some(String::from_utf8(ran.stdout).unwrap())
}

/// The same line from the memory of our module.
fn shown(run: &Running, n: usize, program: &Generated) -> String {
    let values = program.variables.iter().map(|it| {
        let path = format!("b{n}.{}", it.name);
        match it.ty.name {
            "REAL" | "LREAL" if run.real(&path).is_nan() => "nan ".to_owned(),
            "REAL" => format!("{:x} ", (run.real(&path) as f32).to_bits()),
            "LREAL" => format!("{:x} ", run.real(&path).to_bits()),
            _ => {
                let mask = u64::MAX >> (64 - it.ty.bits);
                format!("{:x} ", run.whole(&path) as u64 & mask)
            }
        }
    });
    values.collect()
}

/// Programs of one file, from one seed.
fn same(seed: u64, count: usize) -> bool {
    let mut random = Random(seed);
    let programs: Vec<Generated> = (0..count).map(|n| generate(&mut random, n)).collect();
    let Some(theirs) = in_c(&programs, seed) else {
        return false;
    };
    let mut text: String = programs.iter().map(|it| it.st.as_str()).collect();
    text.push_str("PROGRAM Main\nVAR\n");
    (0..count).for_each(|n| text.push_str(&format!("b{n} : B{n};\n")));
    text.push_str("END_VAR\n");
    (0..count).for_each(|n| text.push_str(&format!("b{n}();\n")));
    text.push_str("END_PROGRAM\n");
    let compiled = compile(&text).unwrap_or_else(|report| panic!("seed {seed}\n{}", report.render()));
    valid(&compiled);
    let mut run = Running::with(
        compiled,
        Settings {
            fuel: u64::MAX / 2,
            ..Settings::default()
        },
    );
    for _ in 0..SCANS {
        run.scan().unwrap_or_else(|fault| panic!("seed {seed}: {fault}"));
    }
    assert_eq!(theirs.lines().count(), count, "seed {seed}");
    for (n, (program, theirs)) in programs.iter().zip(theirs.lines()).enumerate() {
        let ours = shown(&run, n, program);
        if ours != theirs {
            let differs: Vec<String> = program
                .variables
                .iter()
                .zip(ours.split(' ').zip(theirs.split(' ')))
                .filter(|(_, (one, other))| one != other)
                .map(|(it, (one, other))| format!("{} : {} ours {one} theirs {other}", it.name, it.ty.name))
                .collect();
            panic!(
                "seed {seed}, program {n}: {differs:#?}\n{}\n{}",
                program.st, program.c
            );
        }
    }
    true
}

/// Covers: ST13, ST14, ST30, ST31, ST32, ST33, ST34, ST35, ST40
#[test]
fn programs_are_worth_what_clang_says() {
    let count = given("STANDSTILL_ST_PROGRAMS", standstill_testkit::cases(1000) as usize);
    let seed = given("STANDSTILL_ST_SEED", 1_u64);
    let each = PROGRAMS.min(count);
    let files = count.div_ceil(PROGRAMS) as u64;
    let threads = std::thread::available_parallelism().map_or(1, usize::from).min(2) as u64;
    std::thread::scope(|scope| {
        for thread in 0..threads {
            scope.spawn(move || {
                for file in (thread..files).step_by(threads as usize) {
                    if !same(seed * 1_000_000 + file, each) {
                        return;
                    }
                }
            });
        }
    });
}

//! The library from C: the examples are compiled with all warnings as errors, as C and as C++, linked to both
//! libraries, run, and run under valgrind. One of them is equal to a scan script, to the bit.
//!
//! Without a C compiler or valgrind the tests say SKIP; with `CI` in the environment that is a failure. Tests that
//! need a second build of the library under another prefix, including valgrind, say SKIP without
//! `STANDSTILL_SEARCH` in the environment: the build takes a minute. `.ci/run` leaves nothing out.

use standstill_export::{Dialect, Prefix, Target, export};
use standstill_testkit::whole_or;
use standstill_trace::Cell;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::sync::LazyLock;
use std::{env, fs};

const EXAMPLES: [&str; 7] = [
    "single_axis",
    "own_drive",
    "diagnostics",
    "home_and_latch",
    "recorder",
    "cam",
    "gears",
];

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Whether a tool can be run. Without it a test ends early with a message; in CI it fails.
fn has(tool: &str) -> bool {
    let found = Command::new(tool).arg("--version").output().is_ok();
    if !found {
        assert!(env::var_os("CI").is_none(), "CI must have {tool}");
        eprintln!("SKIP: there is no {tool}");
    }
    found
}

/// Whether a second build of the library is permitted; see the top of this file.
fn may_build_another() -> bool {
    let may = standstill_testkit::searches();
    if !may {
        eprintln!("SKIP: STANDSTILL_SEARCH is not set");
    }
    may
}

fn run(program: impl AsRef<OsStr>, arguments: &[&OsStr]) -> Output {
    let program = program.as_ref();
    let output = Command::new(program)
        .args(arguments)
        .output()
        .unwrap_or_else(|error| panic!("{}: {error}", program.display()));
    assert!(
        output.status.success(),
        "{} {arguments:?}: {}\n{}{}",
        program.display(),
        output.status,
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    output
}

fn text(output: &Output) -> String {
    String::from_utf8(output.stdout.clone()).unwrap()
}

/// The static (`a`) or the shared library (`so`) in its normal form: cargo has built both for this test, beside it.
fn library(ending: &str) -> PathBuf {
    let name = format!("libstandstill_capi.{ending}");
    let library = env::current_exe().unwrap().with_file_name(name);
    assert!(library.is_file(), "there is no {}", library.display());
    library
}

/// A prefix that is not ours.
const OTHER: &str = "acme";

/// The libraries with that prefix, not optimised and without debug information, and its headers; built once. As in
/// a release build, they have no debug assertions; the other tests have those.
static ACME: LazyLock<PathBuf> = LazyLock::new(|| {
    let folder = scratch("c-library-acme");
    for file in export(Target::C, &Prefix::new(OTHER).unwrap(), &Dialect::default()) {
        fs::write(folder.join(file.name), file.text).unwrap();
    }
    let mut cargo = Command::new(env!("CARGO"));
    cargo
        .args([
            "rustc",
            "--offline",
            "--quiet",
            "--lib",
            "--crate-type",
            "staticlib,cdylib",
        ])
        .arg("--manifest-path")
        .arg(root().join("Cargo.toml"))
        .arg("--target-dir")
        .arg(&folder)
        .env("CARGO_PROFILE_DEV_DEBUG", "false")
        .env("CARGO_PROFILE_DEV_DEBUG_ASSERTIONS", "false")
        .env("CARGO_PROFILE_DEV_OVERFLOW_CHECKS", "false")
        .env("CARGO_INCREMENTAL", "0")
        .env("STANDSTILL_PREFIX", OTHER);
    let output = cargo.output().unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    folder
});

/// One of them, by its ending.
fn acme(ending: &str) -> PathBuf {
    ACME.join(format!("debug/libstandstill_capi.{ending}"))
}

/// Compiles a program with one of the libraries; every warning of a compiler is an error.
fn compile(compiler: &[&str], source: &Path, include: &Path, library: &Path, to: &Path) {
    let (tool, options) = compiler.split_first().unwrap();
    let mut arguments: Vec<&OsStr> = options.iter().map(OsStr::new).collect();
    arguments.extend(["-Wall", "-Wextra", "-Werror", "-pedantic", "-g", "-I"].map(OsStr::new));
    arguments.push(include.as_os_str());
    arguments.push(source.as_os_str());
    arguments.push(OsStr::new("-o"));
    arguments.push(to.as_os_str());
    // From here on a compiler of C++ no longer treats the files as C++.
    arguments.extend(["-x", "none"].map(OsStr::new));
    arguments.push(library.as_os_str());
    arguments.extend(["-lpthread", "-ldl", "-lm"].map(OsStr::new));
    let rpath = format!("-Wl,-rpath,{}", library.parent().unwrap().display());
    arguments.push(OsStr::new(&rpath));
    run(tool, &arguments);
}

const C: [&str; 2] = ["cc", "-std=c11"];
const C99: [&str; 2] = ["cc", "-std=c99"];
const CPP: [&str; 4] = ["c++", "-std=c++11", "-x", "c++"];

/// An example as a program in a folder of its own, with the static library.
fn example(name: &str, folder: &str) -> PathBuf {
    let program = scratch(folder).join(name);
    let source = root().join("examples").join(format!("{name}.c"));
    compile(&C, &source, &root().join("include"), &library("a"), &program);
    program
}

#[test]
fn the_examples_run_from_c_and_cpp_with_both_libraries() {
    if !has("cc") || !has("c++") {
        return;
    }
    let (fixed, shared) = (library("a"), library("so"));
    let folder = scratch("c-examples");
    let ways = [
        ("c", &C[..], &fixed),
        ("c99", &C99[..], &shared),
        ("cpp", &CPP[..], &fixed),
    ];
    for (place, example) in EXAMPLES.iter().enumerate() {
        let source = root().join("examples").join(format!("{example}.c"));
        let mut printed = Vec::new();
        // Linking takes its time: in a short run each example is compiled in one of the ways, in turn.
        for (name, compiler, library) in ways.iter().skip(whole_or(0, place % 3)).take(whole_or(3, 1)) {
            let program = folder.join(format!("{example}-{name}"));
            compile(compiler, &source, &root().join("include"), library, &program);
            printed.push(text(&run(&program, &[])));
        }
        assert!(
            !printed[0].is_empty() && printed.iter().all(|other| *other == printed[0]),
            "{example}"
        );
    }
}

#[test]
fn the_diagnostic_ring_tells_c_what_happened() {
    if !has("cc") {
        return;
    }
    // Clamped, planned to a position, refused: 102 is a velocity that is not above 0.
    assert_eq!(
        text(&run(example("diagnostics", "c-ring"), &[])),
        "refused: limits.velocity is 0\n\
         0 scan 0 axis 1 instance 1 event 3 error 0 count 0 Velocity 99 10\n\
         1 scan 0 axis 1 instance 1 event 7 error 0 count 200  1 0\n\
         2 scan 401 axis 1 instance 1 event 1 error 102 count 0 Velocity -1 0\n"
    );
}

/// The library under another prefix, so that this prefix is tested with every example, too.
#[test]
fn valgrind_has_nothing_to_report() {
    if !may_build_another() || !has("cc") || !has("valgrind") {
        return;
    }
    let folder = scratch("c-valgrind");
    // In optimised code, valgrind sees branches on undefined values that change nothing.
    let library = acme("a");
    for example in EXAMPLES {
        let program = folder.join(example);
        let source = folder.join(format!("{example}.c"));
        let ours = fs::read_to_string(root().join("examples").join(format!("{example}.c"))).unwrap();
        let theirs = ours
            .replace("standstill", OTHER)
            .replace("STANDSTILL", &OTHER.to_uppercase());
        fs::write(&source, theirs).unwrap();
        compile(&C, &source, &ACME, &library, &program);
        let options = [
            "--quiet",
            "--error-exitcode=9",
            "--leak-check=full",
            "--errors-for-leak-kinds=all",
        ];
        let mut arguments: Vec<&OsStr> = options.iter().map(OsStr::new).collect();
        arguments.push(program.as_os_str());
        let output = run("valgrind", &arguments);
        assert_eq!(String::from_utf8_lossy(&output.stderr), "", "{example}");
    }
}

/// Compares the output of an example, row by row, with a scan script: doubles as their bits, then flags.
fn same_bits(name: &str, script: &str, reals: &[&str], flags: &[&str]) {
    if !has("cc") {
        return;
    }
    let printed = text(&run(example(name, "c-digest"), &[OsStr::new("trace")]));
    same_rows(&printed, script, reals, flags);
}

/// The run of a script for hosts.
fn outcome_of(script: &str) -> standstill_script::Outcome {
    let path = root().join("../../scan-tests/embedding").join(script);
    let script = standstill_script::read(&fs::read_to_string(path).unwrap(), script, &[]).unwrap();
    standstill_script::run(&script).unwrap()
}

fn same_rows(printed: &str, script: &str, reals: &[&str], flags: &[&str]) {
    let is_row = |line: &&str| {
        let first = line.split(' ').next().unwrap_or_default();
        first.len() == 16 && first.bytes().all(|byte| byte.is_ascii_hexdigit())
    };
    let rows: Vec<_> = printed.lines().filter(is_row).collect();
    let outcome = outcome_of(script);
    assert!(outcome.passed());
    let trace = &outcome.trace;
    let real = |scan, name| match trace.cell(scan, trace.column(name).unwrap()) {
        Some(Cell::Real(value)) => format!("{:016x} ", value.to_bits()),
        other => panic!("{name}: {other:?}"),
    };
    let flag = |scan, name| match trace.cell(scan, trace.column(name).unwrap()) {
        Some(Cell::Bool(value)) => u8::from(value).to_string(),
        other => panic!("{name}: {other:?}"),
    };
    assert_eq!(rows.len(), trace.scans());
    for (scan, row) in rows.iter().enumerate() {
        let mut expected: String = reals.iter().map(|name| real(scan, name)).collect();
        expected.extend(flags.iter().map(|name| flag(scan, name)));
        assert_eq!(*row, expected, "scan {scan}");
    }
}

#[test]
fn c_and_a_scan_script_move_by_the_same_bits() {
    same_bits(
        "single_axis",
        "power_there_and_back.scan.json",
        &["X.Position", "X.Velocity", "X.Acceleration"],
        &["power.Status", "there.Done", "back.Done"],
    );
}

#[test]
fn ctypes_and_a_scan_script_move_by_the_same_bits() {
    if !has("python3") {
        return;
    }
    let program = root().join("examples/single_axis.py");
    let include = root().join("include");
    let shared = library("so");
    let arguments = [
        program.as_os_str(),
        shared.as_os_str(),
        include.as_os_str(),
        OsStr::new("bits"),
    ];
    let printed = text(&run("python3", &arguments));
    assert!(printed.ends_with("there and back, and off\n"), "{printed}");
    same_rows(
        &printed,
        "power_there_and_back.scan.json",
        &["X.Position", "X.Velocity", "X.Acceleration"],
        &["power.Status", "there.Done", "back.Done"],
    );
}

/// Switches, inputs and probes of simulated drives are equal to those of scan scripts.
#[test]
fn c_homes_and_latches_by_the_bits_of_a_scan_script() {
    same_bits(
        "home_and_latch",
        "home_and_latch.scan.json",
        &[
            "X.Position",
            "X.Velocity",
            "Y.Position",
            "Y.ActualPosition",
            "probe_x.RecordedPosition",
            "probe_y.RecordedPosition",
        ],
        &[
            "home_x.Done",
            "home_y.Done",
            "probe_x.Done",
            "probe_y.Done",
            "gate.Value",
        ],
    );
}

/// Covers: G85
#[test]
fn a_cam_of_a_c_host_moves_by_the_bits_of_a_scan_script() {
    same_bits(
        "cam",
        "a_cam.scan.json",
        &[
            "M.Position",
            "S.Position",
            "S.Velocity",
            "select.MaxMasterVelocity",
        ],
        &["select.Done", "cam.InSync", "cam.EndOfProfile"],
    );
}

/// Covers: G5, G15, G60, G65, G85
#[test]
fn gears_of_a_c_host_move_by_the_bits_of_a_scan_script() {
    same_bits(
        "gears",
        "gears.scan.json",
        &[
            "M.Position",
            "S.Position",
            "W.Position",
            "W.Velocity",
            "shift.CoveredPhaseShift",
        ],
        &[
            "gear.InGear",
            "both.InSync",
            "shift.Done",
            "out.Done",
            "gear.CommandAborted",
        ],
    );
}

/// The same axis twice, a denominator of 0, a slave and a master that do not exist, and a ring: each has its
/// ErrorID. The comparison with the script shows that nothing moves because of them.
#[test]
fn gears_of_a_c_host_are_refused_with_their_numbers() {
    if !has("cc") {
        return;
    }
    assert_eq!(
        text(&run(example("gears", "c-gears"), &[])),
        "self 151, zero 150, nobody 100, stranger 100, ring 151\n"
    );
}

/// The dump of the recorder in memory of a C host is a trace. The readers of `explain`, `report` and `compare` read
/// its files, which are the same if written again, and its rows are those of the scan script.
#[test]
fn the_dump_of_a_c_host_is_a_trace() {
    if !has("cc") {
        return;
    }
    let program = example("recorder", "c-recorder");
    let folder = scratch("c-recorder");
    let (table, lines) = (folder.join("recorded.csv"), folder.join("recorded.jsonl"));
    let told = text(&run(&program, &[table.as_os_str()]));
    assert_eq!(told, "scans 501 to 800, axis 1 in scan 700\n");
    fs::write(&lines, run(&program, &[]).stdout).unwrap();
    let loaded = standstill_trace::file::load(&table).unwrap();
    assert!(loaded.lacks.is_empty(), "{:?}", loaded.lacks);
    let trace = &loaded.trace;
    for path in [&table, &lines] {
        let again = folder.join("again").with_extension(path.extension().unwrap());
        standstill_trace::file::save(trace, &again).unwrap();
        assert_eq!(
            fs::read_to_string(path).unwrap(),
            fs::read_to_string(&again).unwrap()
        );
    }
    let meta = |path| fs::read_to_string(standstill_trace::csv::meta_path(path)).unwrap();
    assert_eq!(meta(&table), meta(&folder.join("again.csv")));

    let outcome = outcome_of("a_drive_fails_on_the_way.scan.json");
    assert_eq!(trace.scans(), 300);
    let names = |trace: &standstill_trace::Trace| -> Vec<String> {
        trace.columns().iter().map(|column| column.name.clone()).collect()
    };
    assert_eq!(names(trace), names(&outcome.trace));
    for scan in 0..trace.scans() {
        let (ours, theirs): (Vec<_>, Vec<_>) =
            (trace.row(scan).collect(), outcome.trace.row(501 + scan).collect());
        assert_eq!(ours, theirs, "scan {scan}");
    }
}

#[test]
fn two_libraries_of_different_prefixes_live_in_one_program() {
    if !may_build_another() || !has("cc") {
        return;
    }
    let folder = scratch("c-prefix");
    let shared = acme("so");
    let source = folder.join("both.c");
    fs::write(
        &source,
        "#include \"acme_blocks.h\"\n#include \"standstill_blocks.h\"\n\
         int main(void) {\n\
             if (acme_mc_stop(0, 0, 0, 0) != ACME_NULL_POINTER) return 1;\n\
             if (standstill_mc_stop(0, 0, 0, 0) != STANDSTILL_NULL_POINTER) return 2;\n\
             return acme_abi_version() == ACME_ABI_VERSION ? 0 : 3;\n}\n",
    )
    .unwrap();
    let program = folder.join("both");
    let rpath = format!("-Wl,-rpath,{}", shared.parent().unwrap().display());
    let (include, fixed) = (root().join("include"), library("a"));
    let arguments: Vec<&OsStr> = vec![
        OsStr::new("-std=c11"),
        OsStr::new("-Werror"),
        OsStr::new("-I"),
        include.as_os_str(),
        OsStr::new("-I"),
        ACME.as_os_str(),
        source.as_os_str(),
        OsStr::new("-o"),
        program.as_os_str(),
        fixed.as_os_str(),
        shared.as_os_str(),
        OsStr::new(&rpath),
        OsStr::new("-lpthread"),
        OsStr::new("-ldl"),
        OsStr::new("-lm"),
    ];
    run("cc", &arguments);
    run(&program, &[]);
}

/// Header and library are made separately: every function that the header declares exists.
#[test]
fn every_block_has_its_function() {
    if !has("cc") {
        return;
    }
    let folder = scratch("c-all");
    let header = fs::read_to_string(root().join("include/standstill_blocks.h")).unwrap();
    let names: Vec<_> = header
        .lines()
        .filter_map(|line| line.strip_prefix("int32_t standstill_")?.split('(').next())
        .collect();
    assert_eq!(names.len(), standstill_blocks::REGISTRY.len());
    let calls: String = names
        .iter()
        .map(|name| format!("    if (standstill_{name}(0, 0, 0, 0) != STANDSTILL_NULL_POINTER) return 1;\n"))
        .collect();
    let source = folder.join("all.c");
    fs::write(
        &source,
        format!("#include \"standstill_blocks.h\"\nint main(void) {{\n{calls}    return 0;\n}}\n"),
    )
    .unwrap();
    let program = folder.join("all");
    compile(&C, &source, &root().join("include"), &library("a"), &program);
    run(&program, &[]);
}

/// The layout of an instance in rusty is that of our own C file: the compiler checks every offset.
#[test]
fn the_bodies_for_rusty_compile_and_move_an_axis() {
    if !has("cc") {
        return;
    }
    let folder = scratch("c-rusty");
    for file in export(Target::StRusty, &Prefix::default(), &Dialect::default()) {
        fs::write(folder.join(file.name), file.text).unwrap();
    }
    let source = folder.join("host.c");
    // The output of a program's compiler: zeroed instances, VAR_IN_OUT as an address.
    fs::write(
        &source,
        r#"
#include "standstill_rusty.c"
struct standstill_runtime *standstill_default;
static long long storage[1 << 15] __attribute__((aligned(16)));
int main(void) {
    struct standstill_runtime_config config = {sizeof config, 1, 4, 0, 1000000};
    struct standstill_axis_setup setup = {.size = sizeof setup};
    struct standstill_drive_setup drive = {.size = sizeof drive};
    int32_t number;
    standstill_axis_defaults(&setup);
    standstill_drive_defaults(&drive);
    setup.velocity = 10.0, setup.acceleration = 100.0, setup.start_powered = 1;
    if (standstill_runtime_init(1, storage, sizeof storage, &config, &standstill_default)) return 1;
    if (standstill_axis_add(standstill_default, &setup, &drive, &number)) return 2;
    struct standstill_reference axis = {number};
    static struct standstill_mc_move_absolute_fb move;
    move.axis = &axis, move.execute = 1, move.position = 1.0, move.velocity = 10.0;
    for (int scan = 0; scan < 400; scan++) {
        standstill_tick_begin(standstill_default, scan * 1000000LL);
        MC_MoveAbsolute(&move);
        standstill_tick_end(standstill_default);
        if (move.result) return 3;
    }
    return move.done ? 0 : 4;
}
"#,
    )
    .unwrap();
    let program = folder.join("host");
    compile(&C, &source, &folder, &library("a"), &program);
    run(&program, &[]);
}

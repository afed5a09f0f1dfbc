//! `prog.st` through STruC++: linked to the C library, and as a guest, with the digest of the other hosts.
//!
//! STruC++ is in no package registry and not in Debian, so CI cannot install it and these tests say SKIP
//! there; `docs/porting.md` lists what CI tests of this path. Here it is found as `strucpp` on the PATH,
//! its runtime's headers in `STRUCPP_RUNTIME`, archives of its standard blocks in `STRUCPP_LIBS`, if
//! needed.

mod common;

use common::*;
use standstill_export::Target;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

fn text(path: &Path) -> String {
    path.to_str().unwrap().to_owned()
}

/// Translates `prog.st`, with the shim before it, into the folder, and returns the options for C++ there; `None`
/// without STruC++.
fn translated(name: &str) -> Option<(PathBuf, Vec<String>)> {
    if Command::new("strucpp").arg("--version").output().is_err() {
        skip(
            "there is no strucpp; STruC++ is in no package registry, so nothing installs it (docs/porting.md)",
        );
        return None;
    }
    let runtime = env::var("STRUCPP_RUNTIME");
    let runtime = runtime.expect("strucpp is here: set STRUCPP_RUNTIME to its src/runtime/include");
    let out = scratch(name);
    exported(Target::StStrucpp, &out);
    let shim = fs::read_to_string(out.join("standstill_strucpp.st")).unwrap();
    let program = fs::read_to_string(folder().join("prog.st")).unwrap();
    let (all, cpp) = (out.join("all.st"), out.join("prog.cpp"));
    fs::write(&all, shim + &program).unwrap();
    let mut command = vec![
        text(&all),
        "-o".to_owned(),
        text(&cpp),
        "--no-default-libs".to_owned(),
    ];
    if let Ok(libs) = env::var("STRUCPP_LIBS") {
        command.extend(["-L".to_owned(), libs]);
    }
    run("strucpp", command);
    let options = [
        "-std=c++17",
        "-O2",
        "-w",
        "-include",
        "standstill_shim.h",
        "-I",
        &runtime,
        "-I",
    ];
    let mut compile = options.map(str::to_owned).to_vec();
    compile.extend([text(&out), text(&cpp), text(&folder().join("strucpp_main.cpp"))]);
    Some((out, compile))
}

#[test]
fn prog_st_linked_to_the_library() {
    let Some((out, mut command)) = translated("feed-and-place-strucpp") else {
        return;
    };
    if !has("cc") || !has("c++") {
        return;
    }
    let host = out.join("host.o");
    let include = format!("-I{}", out.display());
    run(
        "cc",
        [
            "-c",
            &include,
            &text(&folder().join("host.c")),
            "-o",
            &text(&host),
        ],
    );
    let program = out.join("feed_and_place");
    command.extend([text(&host), text(&library()), "-o".to_owned(), text(&program)]);
    command.extend(["-lpthread", "-ldl", "-lm"].map(str::to_owned));
    run("c++", command);
    let printed = run(&program, [""; 0]);
    hold(
        "STruC++, linked",
        &of_lines(&String::from_utf8(printed.stdout).unwrap()),
        None,
    );
}

#[test]
fn prog_st_as_a_guest() {
    let Some((out, mut command)) = translated("feed-and-place-strucpp-guest") else {
        return;
    };
    if !has("clang++") || !has("wasm-ld") {
        return;
    }
    let sysroot = env::var("WASI_SYSROOT").unwrap_or_else(|_| "/usr".to_owned());
    if !Path::new(&sysroot).join("include/wasm32-wasi/c++").exists() {
        skip(&format!(
            "there is no C++ library for WebAssembly in {sysroot}: set WASI_SYSROOT"
        ));
        return;
    }
    command.extend(["--target=wasm32-wasi", "-mexec-model=reactor", "-fno-exceptions"].map(str::to_owned));
    command.push(format!("--sysroot={sysroot}"));
    for (name, _) in VARIABLES.iter().chain(&[("Start", ""), ("Stop", "")]) {
        command.push(format!("-Wl,--export={name}"));
    }
    command.extend(["-o".to_owned(), text(&out.join("program.wasm"))]);
    run("clang++", command);
    for file in ["cell.machine.json", "guest.scan.json"] {
        fs::copy(folder().join(file), out.join(file)).unwrap();
    }
    let trace = of_guest(&out.join("guest.scan.json"), str::to_owned);
    hold("STruC++, as a guest", &trace, None);
}

/// The part of the path through STruC++ that CI tests besides the shim: the file that runs a program, with the
/// output of two releases.
#[test]
fn the_file_that_runs_a_program_compiles_wherever_the_globals_are() {
    if !has("c++") {
        return;
    }
    let shape = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/strucpp_shape");
    let main = folder().join("strucpp_main.cpp");
    for globals in ["-DGLOBALS_ARE_MEMBERS", "-UGLOBALS_ARE_MEMBERS"] {
        let options = [
            "-std=c++17",
            "-Wall",
            "-Wextra",
            "-Werror",
            "-fsyntax-only",
            globals,
            "-I",
        ];
        let mut command = options.map(str::to_owned).to_vec();
        command.extend([text(&shape), text(&main)]);
        run("c++", command);
    }
}

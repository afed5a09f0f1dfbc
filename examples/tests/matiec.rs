//! `prog.st` through matiec: linked to the C library, and as a guest, with the digest of the other hosts.
//!
//! matiec is in no package registry and not in Debian, so CI cannot install it and these tests say SKIP there; what CI holds
//! of this path is said in `docs/porting.md`. Here it is found as `iec2c` on the PATH, its library in `MATIEC_LIB`, or beside
//! it; a C library for WebAssembly in `WASI_SYSROOT`, or where Debian puts it.

mod common;

use common::*;
use standstill_export::Target;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// Where `iec2c` has its standard functions in Structured Text; the headers are in `C` below it.
fn library_of_matiec() -> Option<PathBuf> {
    if Command::new("iec2c").arg("-v").output().is_err() {
        eprintln!(
            "SKIP: there is no iec2c; matiec is in no package registry, so nothing installs it (docs/porting.md)"
        );
        return None;
    }
    let path = env::var_os("PATH").unwrap_or_default();
    let mut beside: Vec<_> = env::split_paths(&path)
        .filter(|folder| folder.join("iec2c").exists())
        .flat_map(|folder| {
            ["lib", "../lib", "../lib/matiec", "../share/matiec/lib"].map(|lib| folder.join(lib))
        })
        .collect();
    beside.splice(0..0, env::var_os("MATIEC_LIB").map(PathBuf::from));
    let found = beside.into_iter().find(|lib| lib.join("ieclib.txt").exists());
    Some(found.expect("iec2c is here, but not its library: set MATIEC_LIB to the folder with ieclib.txt"))
}

fn text(path: &Path) -> String {
    path.to_str().unwrap().to_owned()
}

/// Translates `prog.st`, with the shim before it, into the folder; `None` without matiec.
fn translated(name: &str) -> Option<(PathBuf, PathBuf)> {
    let matiec = library_of_matiec()?;
    let out = scratch(name);
    exported(Target::StMatiec, &out);
    let shim = fs::read_to_string(out.join("standstill_matiec.st")).unwrap();
    let program = fs::read_to_string(folder().join("prog.st")).unwrap();
    fs::write(out.join("all.st"), shim + &program).unwrap();
    let all = text(&out.join("all.st"));
    run("iec2c", ["-I", &text(&matiec), "-p", "-T", &text(&out), &all]);
    Some((out, matiec.join("C")))
}

/// What matiec's own text is compiled with: it has its own ideas of warnings.
fn of_matiec(out: &Path, headers: &Path) -> Vec<String> {
    let shim = "standstill_shim.h";
    let options = ["-O2", "-w", "-DGLOBAL_CAST=", "-include", shim, "-I"];
    let mut options = options.map(str::to_owned).to_vec();
    options.extend([text(headers), "-I".to_owned(), text(out)]);
    options
}

#[test]
fn prog_st_linked_to_the_library() {
    let Some((out, headers)) = translated("feed-and-place-matiec") else {
        return;
    };
    if !has("cc") {
        return;
    }
    let program = out.join("feed_and_place");
    let mut command = of_matiec(&out, &headers);
    command.push("-DMATIEC".to_owned());
    for file in ["Res0.c", "Config0.c", "standstill_matiec_main.c"] {
        command.push(text(&out.join(file)));
    }
    command.extend([text(&folder().join("host.c")), text(&library())]);
    command.extend(["-o", program.to_str().unwrap(), "-lpthread", "-ldl", "-lm"].map(str::to_owned));
    run("cc", command);
    let printed = run(&program, [""; 0]);
    hold(
        "matiec, linked",
        &of_lines(&String::from_utf8(printed.stdout).unwrap()),
        None,
    );
}

#[test]
fn prog_st_as_a_guest() {
    let Some((out, headers)) = translated("feed-and-place-matiec-guest") else {
        return;
    };
    if !has("clang") || !has("wasm-ld") {
        return;
    }
    let mut command = of_matiec(&out, &headers);
    // Older headers of matiec want those of a C library. Nothing of it is called, so nothing of WASI is imported.
    let sysroot = env::var_os("WASI_SYSROOT").map(PathBuf::from);
    let sysroot = sysroot
        .or_else(|| Some(PathBuf::from("/usr")).filter(|usr| usr.join("include/wasm32-wasi").exists()));
    if let Some(sysroot) = sysroot {
        command.extend(["--target=wasm32-wasi", "-nostartfiles", "-nodefaultlibs", "-lc"].map(str::to_owned));
        command.push(format!("--sysroot={}", text(&sysroot)));
    } else {
        let options = [
            "--target=wasm32",
            "-ffreestanding",
            "-mbulk-memory",
            "-nostdlib",
            "-nostdlibinc",
        ];
        command.extend(options.map(str::to_owned));
        command.extend(["-I".to_owned(), text(&folder().join("freestanding"))]);
    }
    command.push("-Wl,--no-entry".to_owned());
    for (name, _) in VARIABLES.iter().chain(&[("Start", ""), ("Stop", "")]) {
        command.push(format!("-Wl,--export=CONFIG0__{}", name.to_ascii_uppercase()));
    }
    for file in ["Res0.c", "Config0.c", "standstill_matiec_main.c"] {
        command.push(text(&out.join(file)));
    }
    command.extend(["-o".to_owned(), text(&out.join("prog.wasm"))]);
    run("clang", command);
    for file in ["cell.machine.json", "matiec.scan.json"] {
        fs::copy(folder().join(file), out.join(file)).unwrap();
    }
    let trace = of_guest(&out.join("matiec.scan.json"), str::to_owned);
    hold("matiec, as a guest", &trace, None);
}

//! `prog.st` through matiec: linked to the C library, and as a guest, with the digest of the other hosts.
//!
//! matiec is in no package registry and not in Debian, so CI cannot install it and these tests say SKIP
//! there; `docs/porting.md` lists what CI tests of this path. Here it is found as `iec2c` on the PATH; a
//! C library for WebAssembly in `WASI_SYSROOT`, or where Debian puts it.

mod common;
#[path = "../../st/tests/foreign/matiec.rs"]
mod matiec;

use common::*;
use standstill_export::Target;
use standstill_trace::Trace;
use std::path::{Path, PathBuf};
use std::{env, fs};

fn text(path: &Path) -> String {
    path.to_str().unwrap().to_owned()
}

/// Translates `prog.st`, with the shim before it, into the folder; `None` without matiec.
fn translated(name: &str) -> Option<(PathBuf, PathBuf)> {
    let Some(matiec) = matiec::library() else {
        skip(matiec::MISSING);
        return None;
    };
    let out = scratch(name);
    exported(Target::StMatiec, &out);
    let shim = fs::read_to_string(out.join("standstill_matiec.st")).unwrap();
    let program = fs::read_to_string(folder().join("prog.st")).unwrap();
    fs::write(out.join("all.st"), shim + &program).unwrap();
    let all = text(&out.join("all.st"));
    run("iec2c", ["-I", &text(&matiec), "-p", "-T", &text(&out), &all]);
    Some((out, matiec.join("C")))
}

/// The options for matiec's own text: it does not compile without warnings.
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
    // Older headers of matiec need those of a C library. Nothing of it is called, so nothing of WASI is imported.
    let sysroot = env::var_os("WASI_SYSROOT").map(PathBuf::from);
    let sysroot = sysroot
        .or_else(|| Some(PathBuf::from("/usr")).filter(|usr| usr.join("include/wasm32-wasi").exists()));
    if let Some(sysroot) = sysroot {
        command.extend(["--target=wasm32-wasi", "-nostartfiles", "-nodefaultlibs", "-lc"].map(str::to_owned));
        command.push(format!("--sysroot={}", text(&sysroot)));
    } else {
        command.extend(freestanding());
    }
    command.extend(exports());
    for file in ["Res0.c", "Config0.c", "standstill_matiec_main.c"] {
        command.push(text(&out.join(file)));
    }
    command.extend(["-o".to_owned(), text(&out.join("prog.wasm"))]);
    run("clang", command);
    hold("matiec, as a guest", &guest(&out), None);
}

/// A guest without any C library.
fn freestanding() -> Vec<String> {
    let include = format!("-I{}", folder().join("freestanding").display());
    let options = [
        "--target=wasm32",
        "-ffreestanding",
        "-mbulk-memory",
        "-nostdlib",
        "-nostdlibinc",
        &include,
    ];
    options.map(str::to_owned).to_vec()
}

/// The exports that the script of a guest of matiec reads and writes.
fn exports() -> Vec<String> {
    let names = VARIABLES.iter().map(|(name, _)| *name).chain(["Start", "Stop"]);
    let exports = names.map(|name| format!("-Wl,--export=CONFIG0__{}", name.to_ascii_uppercase()));
    ["-Wl,--no-entry".to_owned()].into_iter().chain(exports).collect()
}

/// The run of `prog.wasm` in the folder.
fn guest(out: &Path) -> Trace {
    for file in ["cell.machine.json", "matiec.scan.json"] {
        fs::copy(folder().join(file), out.join(file)).unwrap();
    }
    of_guest(&out.join("matiec.scan.json"), str::to_owned)
}

/// The blocks of the shim that `prog.st` uses, in the form that matiec gives them in C: a structure and a body
/// each.
fn blocks_of_the_shim(shim: &str) -> String {
    let mut out = String::new();
    for block in [
        "STANDSTILL_R_TRIG",
        "STANDSTILL_TON",
        "MC_Power",
        "MC_MoveAbsolute",
        "MC_Stop",
        "MC_ReadStatus",
    ] {
        let begin = format!("\nFUNCTION_BLOCK {block}\n");
        let (_, rest) = shim.split_once(&begin).unwrap();
        let (head, rest) = rest.split_once("\n  {{\n").unwrap();
        let (body, _) = rest.split_once("\n  }}\n").unwrap();
        let name = block.to_ascii_uppercase();
        out += "typedef struct {\n";
        for line in head.lines() {
            if let Some((variable, ty)) = line.trim().split_once(" : ") {
                let ty = ty.split([';', ' ']).next().unwrap();
                out += &format!("    __IEC_{ty}_t {};\n", variable.to_ascii_uppercase());
            }
        }
        out += &format!("}} {name};\nstatic void {name}_body__({name} *data__) {{\n{body}\n}}\n\n");
    }
    out
}

/// matiec crashes on a declaration of several block instances.
#[test]
fn prog_st_declares_each_block_instance_by_itself() {
    let program = fs::read_to_string(folder().join("prog.st")).unwrap();
    let declarations = program.lines().filter_map(|line| line.trim().split_once(" : "));
    for (names, of) in declarations.filter(|(names, _)| names.contains(',')) {
        assert!(["BOOL;", "INT;"].contains(&of), "{names} : {of}");
    }
}

/// The part of the path through matiec that CI tests: the shim and the file that runs a program, under a program in
/// matiec's form.
#[test]
fn a_program_in_the_shape_of_matiec_linked_and_as_a_guest() {
    let out = scratch("feed-and-place-matiec-shape");
    exported(Target::StMatiec, &out);
    let shim = fs::read_to_string(out.join("standstill_matiec.st")).unwrap();
    fs::write(out.join("blocks.c"), blocks_of_the_shim(&shim)).unwrap();
    let shape = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/matiec_shape");
    let sources = [
        text(&shape.join("program.c")),
        text(&out.join("standstill_matiec_main.c")),
    ];
    let options = [
        "-O2",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-include",
        "standstill_shim.h",
        "-I",
    ];
    let mut common = options.map(str::to_owned).to_vec();
    common.extend([text(&shape), "-I".to_owned(), text(&out)]);
    if has("cc") {
        let program = out.join("feed_and_place");
        let mut command = common.clone();
        command.extend(sources.clone());
        command.extend([
            "-DMATIEC".to_owned(),
            text(&folder().join("host.c")),
            text(&library()),
        ]);
        command.extend(["-o", program.to_str().unwrap(), "-lpthread", "-ldl", "-lm"].map(str::to_owned));
        run("cc", command);
        let printed = run(&program, [""; 0]);
        let trace = of_lines(&String::from_utf8(printed.stdout).unwrap());
        hold("the shape of matiec, linked", &trace, None);
    }
    if has("clang") && has("wasm-ld") {
        let mut command = common;
        command.extend(freestanding());
        command.extend(exports());
        command.extend(sources);
        command.extend(["-o".to_owned(), text(&out.join("prog.wasm"))]);
        run("clang", command);
        hold("the shape of matiec, as a guest", &guest(&out), None);
    }
}

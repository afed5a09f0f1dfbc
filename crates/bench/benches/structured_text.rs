//! Programs in Structured Text beside the same in C through clang, as guests of the same runtime, in one
//! run; and the cost of compiling.
//!
//! Without clang there is nothing to compare with: it reports that and prints the other figures.

mod hosted;

use hosted::{EMPTY, Hosted};
use standstill_export::{Dialect, Prefix, Target, export};
use standstill_st::{Options, Source, compile};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

/// Rounds of each program, in turn.
const ROUNDS: usize = 300;
const SCANS: i64 = 500;

/// A comparison: its name, the program in Structured Text, the same in C. The variables of both can be read from
/// outside, because clang leaves out variables that nobody can see.
const PAIRS: [(&str, &str, &str); 3] = [
    ("state machine", STATES_ST, STATES_C),
    ("20 blocks", BLOCKS_ST, BLOCKS_C),
    ("arithmetic loop", LOOP_ST, LOOP_C),
];

const STATES_ST: &str = "
PROGRAM Cell
VAR
    State : INT; Ticks : DINT; Parts : DINT;
    Start, Clamped, Drilled, Fault : BOOL;
    Lamp, Clamp, Drill : BOOL;
    Level : LREAL;
END_VAR
Ticks := Ticks + 1;
Start := Ticks MOD 50 = 0;
Clamped := Ticks MOD 7 = 3;
Drilled := Ticks MOD 11 = 5;
Fault := Level > 90.0 AND NOT Clamped;
CASE State OF
    0: IF Start AND NOT Fault THEN State := 10; END_IF;
    10: Clamp := TRUE; IF Clamped THEN State := 20; END_IF;
    20: Drill := TRUE; Level := Level + 0.5; IF Drilled OR Level > 95.0 THEN State := 30; END_IF;
    30: Drill := FALSE; IF NOT Drilled THEN State := 40; END_IF;
    40: Clamp := FALSE; Parts := Parts + 1; State := 0;
ELSE
    State := 0;
END_CASE;
IF Level > 95.0 THEN Level := 0.0; END_IF;
Lamp := State <> 0 OR Fault;
END_PROGRAM
";

const STATES_C: &str = "
#include <stdint.h>
int16_t state; int32_t ticks, parts;
uint8_t start, clamped, drilled, fault, lamp, clamp, drill;
double level;
__attribute__((export_name(\"plc_scan\"))) void plc_scan(int32_t tick, int64_t now) {
    (void)tick; (void)now;
    ticks = (int32_t)((uint32_t)ticks + 1u);
    start = ticks % 50 == 0;
    clamped = ticks % 7 == 3;
    drilled = ticks % 11 == 5;
    fault = level > 90.0 && !clamped;
    switch (state) {
    case 0: if (start && !fault) state = 10; break;
    case 10: clamp = 1; if (clamped) state = 20; break;
    case 20: drill = 1; level = level + 0.5; if (drilled || level > 95.0) state = 30; break;
    case 30: drill = 0; if (!drilled) state = 40; break;
    case 40: clamp = 0; parts = (int32_t)((uint32_t)parts + 1u); state = 0; break;
    default: state = 0;
    }
    if (level > 95.0) level = 0.0;
    lamp = state != 0 || fault;
}
";

const BLOCKS_ST: &str = "
PROGRAM Cell
VAR Ticks : DINT; Timers : ARRAY[0..19] OF TON; I : DINT; Count : DINT; END_VAR
Ticks := Ticks + 1;
Count := 0;
FOR I := 0 TO 19 DO
    Timers[I](IN := (Ticks + I) MOD 40 > 5, PT := T#20ms);
    IF Timers[I].Q THEN Count := Count + 1; END_IF;
END_FOR;
END_PROGRAM
";

const BLOCKS_C: &str = "
#include \"standstill_guest.h\"
static struct { uint64_t key; standstill_ton_in in; standstill_ton_out out; } timers[20];
int32_t ticks, count;
__attribute__((export_name(\"plc_init\"))) void plc_init(void) {
    for (int i = 0; i < 20; i++) {
        timers[i].in = standstill_ton_in_default();
        timers[i].out = standstill_ton_out_default();
        timers[i].in.pt = 20000000;
    }
}
__attribute__((export_name(\"plc_scan\"))) void plc_scan(int32_t tick, int64_t now) {
    (void)tick; (void)now;
    ticks = (int32_t)((uint32_t)ticks + 1u);
    int32_t found = 0;
    for (int i = 0; i < 20; i++) {
        timers[i].in.input = (ticks + i) % 40 > 5;
        (void)standstill_ton(&timers[i].key, &timers[i].in, &timers[i].out);
        if (timers[i].out.q) found++;
    }
    count = found;
}
";

const LOOP_ST: &str = "
PROGRAM Cell
VAR X : LREAL := 1.0; N : DINT; I : DINT; END_VAR
FOR I := 1 TO 500 DO
    X := X * 0.999 + 1.5 / X;
    N := N * 5 + I;
    IF N > 1000000 THEN N := N / 3; END_IF;
END_FOR;
END_PROGRAM
";

const LOOP_C: &str = "
#include <stdint.h>
double x = 1.0; int32_t n;
__attribute__((export_name(\"plc_scan\"))) void plc_scan(int32_t tick, int64_t now) {
    (void)tick; (void)now;
    for (int32_t i = 1; i <= 500; i++) {
        x = x * 0.999 + 1.5 / x;
        n = (int32_t)((uint32_t)n * 5u + (uint32_t)i);
        if (n > 1000000) n = n / 3;
    }
}
";

type Bench = hosted::Bench<Hosted>;

fn bench(module: &[u8]) -> Result<Bench, Box<dyn Error>> {
    Bench::new(Hosted::new(module)?)
}

fn of_st(text: &str) -> Result<Vec<u8>, Box<dyn Error>> {
    let source = Source {
        name: "cell.st",
        bytes: text.as_bytes(),
    };
    let compiled = compile(&[source], &Options::default()).map_err(|report| report.render())?;
    Ok(compiled.wasm)
}

/// The module that clang compiles from a program; `None` without clang.
fn of_c(text: &str, folder: &Path) -> Result<Option<Vec<u8>>, Box<dyn Error>> {
    let (source, module) = (folder.join("cell.c"), folder.join("cell.wasm"));
    std::fs::write(&source, text)?;
    for file in export(Target::Wasm, &Prefix::default(), &Dialect::default()) {
        std::fs::write(folder.join(file.name), file.text)?;
    }
    let headers = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/feed_and_place/freestanding");
    let built = Command::new("clang")
        .args([
            "--target=wasm32",
            "-O2",
            "-ffreestanding",
            "-mbulk-memory",
            "-nostdlib",
            "-nostdlibinc",
        ])
        .arg(format!("-I{}", folder.display()))
        .arg(format!("-I{}", headers.display()))
        .args(["-Wl,--no-entry", "-o"])
        .args([&module, &source])
        .output();
    let Ok(built) = built else { return Ok(None) };
    if !built.status.success() {
        return Err(String::from_utf8_lossy(&built.stderr).into());
    }
    Ok(Some(std::fs::read(module)?))
}

/// A program of about so many lines: units with a state machine each.
fn lines(count: usize) -> String {
    let mut text = String::from("PROGRAM Cell\nVAR\n");
    let units = count / 10;
    for unit in 0..units {
        text.push_str(&format!("    S{unit} : INT; L{unit} : LREAL;\n"));
    }
    text.push_str("END_VAR\n");
    for unit in 0..units {
        text.push_str(&format!(
            "CASE S{unit} OF\n    0: S{unit} := 1;\n    1:\n        L{unit} := L{unit} + 0.25 * {unit};\n        IF L{unit} > 100.0 THEN\n            S{unit} := 2;\n        END_IF;\n    2: L{unit} := 0.0; S{unit} := 0;\nEND_CASE;\n"
        ));
    }
    text.push_str("END_PROGRAM\n");
    text
}

fn main() -> Result<(), Box<dyn Error>> {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("structured_text");
    std::fs::create_dir_all(&folder)?;
    let mut empty = bench(EMPTY.as_bytes())?;
    println!(
        "{:<18}{:>10}{:>10}{:>8}{:>18}",
        "a scan of", "ST", "clang", "ratio", "without the host"
    );
    for (name, st, c) in PAIRS {
        let mut ours = bench(&of_st(st)?)?;
        let mut theirs = of_c(c, &folder)?.map(|module| bench(&module)).transpose()?;
        for _ in 0..ROUNDS {
            empty.round(SCANS)?;
            ours.round(SCANS)?;
            if let Some(theirs) = &mut theirs {
                theirs.round(SCANS)?;
            }
        }
        let ns = |bench: &Bench| bench.best * 1e9;
        match &theirs {
            None => println!("{name:<18}{:>7.0} ns   (clang is not here)", ns(&ours)),
            Some(theirs) => println!(
                "{name:<18}{:>7.0} ns{:>7.0} ns{:>8.2}{:>18.2}",
                ns(&ours),
                ns(theirs),
                ours.best / theirs.best,
                (ours.best - empty.best) / (theirs.best - empty.best),
            ),
        }
    }
    for count in [1_000, 10_000, 100_000] {
        let text = lines(count);
        let mut best = f64::MAX;
        let mut size = 0;
        for _ in 0..5 {
            let begin = Instant::now();
            size = of_st(&text)?.len();
            best = best.min(begin.elapsed().as_secs_f64());
        }
        println!(
            "{:>7} lines compiled in {:.1} ms, a module of {size} bytes",
            text.lines().count(),
            best * 1e3
        );
    }
    Ok(())
}

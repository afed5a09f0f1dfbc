//! Guests in text form under the executor: motion, snapshots, and the attacks of a hostile one.

use standstill_axis::{AxisConfig, AxisState, DrivePosition, IdealDrive, Limits, Standard};
use standstill_fb::{Context, Value};
use standstill_guest::{Fault, Guest, LoadError, Program, Settings, Symbol, SymbolError, SymbolType, Told};
use standstill_scan::{Executor, Machine, Mode, ProgramConfig, ProgramFault, ProgramId, Programs};
use std::fs;
use std::path::Path;
use std::process::Command;

const MOVE: &str = include_str!("move.wat");

struct Host {
    guest: Guest,
    fault: Option<Fault>,
}

impl Programs<Standard, IdealDrive> for Host {
    fn run(&mut self, _: ProgramId, context: &mut Context<'_>) -> Result<u64, ProgramFault> {
        self.guest.scan(context).map(|_fuel| 0).map_err(|fault| {
            let reason = fault.reason();
            self.fault = Some(fault);
            ProgramFault { reason }
        })
    }
}

struct Bench {
    machine: Machine<Standard, IdealDrive>,
    executor: Executor,
    host: Host,
    scan: i64,
}

/// The result of a scan: state, position and velocity to the bit, fuel.
type Row = (AxisState, u64, u64, u64);

impl Bench {
    fn new(guest: Guest) -> Self {
        let limits = Limits {
            velocity: 50.0,
            acceleration: 200.0,
            deceleration: 200.0,
            jerk: 2e3,
            snap: 4e4,
        };
        let mut machine = Machine::new();
        let drive = IdealDrive::new(DrivePosition::Units(0.0), 0, Some(0), false);
        machine
            .add_axis(AxisConfig::new(limits), Standard::new(0.001), drive)
            .unwrap();
        Self {
            machine,
            executor: Executor::new(1_000_000, &[], &[ProgramConfig::free("main")]).unwrap(),
            host: Host { guest, fault: None },
            scan: 0,
        }
    }

    fn scan(&mut self) -> Row {
        let now_ns = self.scan * 1_000_000;
        self.scan += 1;
        self.executor
            .scan(now_ns, &mut self.host, &mut self.machine)
            .unwrap();
        let axis = &self.machine.axes()[0];
        let setpoint = axis.setpoint();
        (
            axis.state(),
            setpoint.position.to_bits(),
            setpoint.velocity.to_bits(),
            self.host.guest.fuel_used(),
        )
    }

    fn symbol(&self, name: &str, ty: SymbolType) -> Symbol {
        Symbol {
            ty,
            address: self.host.guest.address_of(name).unwrap(),
        }
    }

    fn set(&mut self, name: &str, value: Value, ty: SymbolType) {
        let symbol = self.symbol(name, ty);
        self.host.guest.write(&symbol, value).unwrap();
    }

    fn get(&self, name: &str, ty: SymbolType) -> Value {
        self.host.guest.read(&self.symbol(name, ty)).unwrap()
    }
}

fn compile(text: &str) -> Result<Program, LoadError> {
    Program::compile(text.as_bytes(), Settings::default())
}

fn refused(text: &str) -> String {
    let error = compile(text).and_then(|program| program.start());
    error.expect_err("it is no guest").to_string()
}

#[test]
fn a_guest_moves_an_axis_and_uses_the_same_fuel_in_every_scan_at_rest() {
    let mut bench = Bench::new(compile(MOVE).unwrap().start().unwrap());
    bench.scan();
    let told = bench.host.guest.take_told();
    assert!(
        matches!(&told[..], [
            Told::Line(line),
            Told::Made { number: 1, block: "MC_Power", .. },
            Told::Made { number: 2, block: "MC_MoveAbsolute", .. },
        ] if line == "first scan"),
        "{told:?}"
    );
    let fuel: Vec<u64> = (0..50).map(|_| bench.scan().3).collect();
    assert!(
        fuel[0] > 0 && fuel.iter().all(|used| *used == fuel[0]),
        "{fuel:?}"
    );
    assert_eq!(bench.get("status", SymbolType::Bool), Value::Bool(true));
    bench.set("target", Value::Lreal(3.5), SymbolType::Lreal);
    bench.set("go", Value::Bool(true), SymbolType::Bool);
    let mut moving = 0;
    while bench.get("done", SymbolType::Bool) != Value::Bool(true) {
        moving += u64::from(bench.scan().0 == AxisState::DiscreteMotion);
        assert!(moving < 5_000);
    }
    assert!(moving > 50, "{moving}");
    assert_eq!(bench.machine.axes()[0].setpoint().position, 3.5);
}

#[test]
fn a_snapshot_between_scans_goes_on_as_the_original_does() {
    let program = compile(MOVE).unwrap();
    let mut bench = Bench::new(program.start().unwrap());
    bench.set("go", Value::Bool(true), SymbolType::Bool);
    for _ in 0..100 {
        bench.scan();
    }
    assert_eq!(bench.machine.axes()[0].state(), AxisState::DiscreteMotion);
    let snapshot = bench.host.guest.snapshot();
    let mut other = Bench {
        machine: bench.machine.clone(),
        executor: bench.executor.clone(),
        host: Host {
            guest: program.restore(&snapshot).unwrap(),
            fault: None,
        },
        scan: bench.scan,
    };
    let rows = |bench: &mut Bench| (0..900).map(|_| bench.scan()).collect::<Vec<_>>();
    let (first, second) = (rows(&mut bench), rows(&mut other));
    assert_eq!(first, second);
    assert_eq!(first.last().map(|row| row.0), Some(AxisState::Standstill));
    assert_eq!(
        bench.get("scans", SymbolType::Dword),
        other.get("scans", SymbolType::Dword)
    );
}

#[test]
fn what_is_no_guest_is_refused_with_a_reason() {
    let scan = r#"(func (export "plc_scan") (param i32 i64))"#;
    let memory = r#"(memory (export "memory") 1)"#;
    for (text, reason) in [
        ("nonsense".to_owned(), "no module of WebAssembly"),
        (format!("(module {memory})"), "it has no export `plc_scan`"),
        (format!("(module {scan})"), "it has no export `memory`"),
        (
            format!(r#"(module {memory} (func (export "plc_scan") (param i32)))"#),
            "its `plc_scan` has another type",
        ),
        (
            format!(r#"(module (import "standstill" "mc_fly" (func)) {memory} {scan})"#),
            "it imports `standstill` `mc_fly`, which does not exist here",
        ),
        (
            format!(r#"(module (import "env" "mc_power" (func)) {memory} {scan})"#),
            "imports come from the module `standstill`",
        ),
        (
            format!(r#"(module (import "wasi_snapshot_preview1" "fd_write" (func)) {memory} {scan})"#),
            "a guest has no operating system",
        ),
        (
            format!(r#"(module (import "standstill" "mc_power" (func (param i64))) {memory} {scan})"#),
            "its `mc_power` has another type",
        ),
        (
            format!(r#"(module (memory (export "memory") 257) {scan})"#),
            "its memory begins with 16842752 bytes, more than the 16777216 permitted",
        ),
        (
            format!(r#"(module {memory} {scan} (func $f) (start $f))"#),
            "no module of WebAssembly that can be used here",
        ),
        (
            format!(r#"(module {memory} {scan} (table 70000 funcref))"#),
            "no module of WebAssembly that can be used here",
        ),
        (
            format!(r#"(module {memory} {scan} (func (export "plc_init") (loop (br 0))))"#),
            "its `plc_init` failed: it used up its fuel of 1000000",
        ),
        (
            format!(r#"(module {memory} {scan} (data (i32.const 65530) "too far out"))"#),
            "no module of WebAssembly that can be used here",
        ),
    ] {
        let told = refused(&text);
        assert!(told.contains(reason), "{text}\n{told}");
    }
    let large = vec![0; standstill_guest::MODULE_MOST + 1];
    let told = Program::compile(&large, Settings::default()).unwrap_err();
    assert!(matches!(told, LoadError::Large { .. }), "{told}");
}

/// The move, and the given instructions in the scan in which `scans` is 60.
fn hostile(instructions: &str) -> String {
    let when = format!(
        "(if (i32.eq (i32.load (i32.const 24)) (i32.const 60)) (then {instructions}))\n    \
         (drop (call $power"
    );
    let text = MOVE.replacen("(drop (call $power", &when, 1);
    assert_ne!(text, MOVE);
    text
}

#[test]
fn a_guest_that_fails_at_work_stops_the_resource_and_the_axis_ramps_down() {
    for (instructions, reason) in [
        ("(loop (br 0))", "it used up its fuel of 1000000 in one call"),
        ("(unreachable)", "it trapped: "),
        ("(drop (i32.div_u (i32.const 1) (i32.const 0)))", "it trapped: "),
        (
            "(drop (i32.load (i32.const -4)))",
            "it trapped: out of bounds memory",
        ),
        (
            "(i32.store (i32.const 65528) (i32.const 16)) (drop (call $power (i32.const 64) (i32.const 65528) (i32.const 88)))",
            "mc_power: 16 bytes of `in` at address 65528",
        ),
        (
            "(drop (call $power (i32.const 64) (i32.const -1) (i32.const 88)))",
            "mc_power: 4 bytes of `in` at address 4294967295",
        ),
        (
            "(drop (call $power (i32.const 65533) (i32.const 72) (i32.const 88)))",
            "mc_power: 8 bytes of `key` at address 65533",
        ),
        (
            "(call $log (i32.const 100) (i32.const -1))",
            "log: 4294967295 bytes of `text` at address 100",
        ),
    ] {
        let text = hostile(instructions);
        let mut bench = Bench::new(compile(&text).unwrap().start().unwrap());
        bench.set("go", Value::Bool(true), SymbolType::Bool);
        while bench.executor.mode() == Mode::Running {
            bench.scan();
            assert!(bench.scan < 100, "{instructions}");
        }
        let fault = bench.host.fault.take().unwrap();
        assert!(fault.to_string().contains(reason), "{instructions}: {fault}");
        let axis = &bench.machine.axes()[0];
        assert!(
            axis.setpoint().velocity > 1.0,
            "{instructions}: it was on its way"
        );
        let rate = 200.0 * 0.001 * 1.000_001;
        let mut velocity = axis.setpoint().velocity;
        while bench.machine.is_off().is_err() {
            bench.scan();
            let next = bench.machine.axes()[0].setpoint().velocity;
            assert!(
                (next - velocity).abs() <= rate,
                "{instructions}: {velocity} {next}"
            );
            velocity = next;
            assert!(bench.scan < 2_000, "{instructions}: it never stops");
        }
        assert_eq!(velocity, 0.0);
        let mut context = bench.machine.context(
            standstill_scan::ScanTime { scan: 9, now_ns: 9 },
            standstill_scan::RUNTIME,
        );
        assert_eq!(bench.host.guest.scan(&mut context), Err(Fault::Over));
    }
}

#[test]
fn wrong_calls_get_a_code_and_nan_the_error_of_the_block() {
    for (call, code) in [
        ("(i32.const 0) (i32.const 72) (i32.const 88)", -1),
        ("(i32.const 64) (i32.const 0) (i32.const 88)", -1),
        ("(i32.const 64) (i32.const 72) (i32.const 0)", -1),
        // There is 0 at 32, which is taken as a size.
        ("(i32.const 64) (i32.const 32) (i32.const 88)", -2),
        // There is text at 512, which is taken as a key; at 104 there is the key of another block.
        ("(i32.const 512) (i32.const 72) (i32.const 88)", -10),
        ("(i32.const 104) (i32.const 72) (i32.const 88)", -11),
        ("(i32.const 64) (i32.const 72) (i32.const 88)", 0),
    ] {
        let text = hostile(&format!("(i32.store (i32.const 600) (call $power {call}))"));
        let text = text.replacen(
            "(func (export \"plc_init\")",
            "(global (export \"code\") i32 (i32.const 600))\n  \
            (func (export \"plc_init\") (i32.store (i32.const 600) (i32.const 77))",
            1,
        );
        let mut bench = Bench::new(compile(&text).unwrap().start().unwrap());
        for _ in 0..70 {
            bench.scan();
        }
        assert_eq!(
            bench.get("code", SymbolType::Dword),
            Value::Dword(i32::cast_unsigned(code)),
            "{call}"
        );
        assert_eq!(bench.executor.mode(), Mode::Running);
    }
    // In plc_init no block is called: the key stays 0.
    let text = MOVE.replacen(
        "(func (export \"plc_init\")",
        "(global (export \"code\") i32 (i32.const 600))\n  (func (export \"plc_init\") (i32.store (i32.const 600) \
         (call $power (i32.const 64) (i32.const 72) (i32.const 88)))",
        1,
    );
    let bench = Bench::new(compile(&text).unwrap().start().unwrap());
    assert_eq!(
        bench.get("code", SymbolType::Dword),
        Value::Dword((-7_i32).cast_unsigned())
    );
    // NaN is refused by the block, and the axis stays where it is.
    let mut bench = Bench::new(compile(MOVE).unwrap().start().unwrap());
    bench.set("target", Value::Lreal(f64::NAN), SymbolType::Lreal);
    bench.set("go", Value::Bool(true), SymbolType::Bool);
    for _ in 0..100 {
        bench.scan();
    }
    let error = Symbol {
        ty: SymbolType::Bool,
        address: 192,
    };
    assert_eq!(bench.host.guest.read(&error), Ok(Value::Bool(true)));
    assert_eq!(bench.machine.axes()[0].setpoint().position, 0.0);
}

#[test]
fn memory_grows_up_to_its_limit_and_not_beyond() {
    let text = r#"(module (memory (export "memory") 1) (global (export "size") i32 (i32.const 8))
        (func (export "plc_scan") (param i32 i64)
            (i32.store (i32.const 8) (memory.grow (i32.const 10)))))"#;
    let settings = Settings {
        memory: 20 << 16,
        ..Settings::default()
    };
    let program = Program::compile(text.as_bytes(), settings).unwrap();
    let mut bench = Bench::new(program.start().unwrap());
    let mut sizes = Vec::new();
    for _ in 0..3 {
        bench.scan();
        sizes.push(bench.get("size", SymbolType::Dword));
    }
    assert_eq!(
        sizes,
        [Value::Dword(1), Value::Dword(u32::MAX), Value::Dword(u32::MAX)]
    );
    // A grown memory is restored, too.
    let restored = program.restore(&bench.host.guest.snapshot()).unwrap();
    let far = Symbol {
        ty: SymbolType::Lreal,
        address: (11 << 16) - 8,
    };
    assert_eq!(restored.read(&far), Ok(Value::Lreal(0.0)));
    let outside = Symbol {
        ty: SymbolType::Lreal,
        address: (11 << 16) - 7,
    };
    assert!(matches!(
        restored.read(&outside),
        Err(SymbolError::Outside { .. })
    ));
    assert!(matches!(
        restored.address_of("nobody"),
        Err(SymbolError::Unknown(_))
    ));
}

#[test]
fn a_flood_of_instances_and_lines_ends_somewhere() {
    let text = MOVE.replacen(
        "(drop (call $power",
        "(call $log (i32.const 512) (i32.const 10)) (i64.store (i32.const 64) (i64.const 0))\n    (drop (call $power",
        1,
    );
    let again = "(call $log (i32.const 512) (i32.const 10))";
    let text = text.replacen(again, &again.repeat(40), 1);
    let mut bench = Bench::new(compile(&text).unwrap().start().unwrap());
    for _ in 0..standstill_guest::INSTANCES_MOST + 10 {
        bench.scan();
    }
    let told = bench.host.guest.take_told();
    let lines = told.iter().filter(|told| matches!(told, Told::Line(_))).count();
    assert_eq!(lines, 16);
    assert!(matches!(told.last(), Some(Told::LinesLost(lost)) if *lost > 1_000));
    let made = told
        .iter()
        .filter(|told| matches!(told, Told::Made { .. }))
        .count();
    assert_eq!(made, standstill_guest::INSTANCES_MOST);
    assert_eq!(bench.executor.mode(), Mode::Running);
}

/// The rows of a move of a guest: states and set-points to the bit.
fn rows_of(program: &Program) -> Vec<(AxisState, u64, u64)> {
    let mut bench = Bench::new(program.start().unwrap());
    let mut rows = Vec::new();
    for scan in 0..700 {
        if scan == 20 {
            bench.set("target", Value::Lreal(2.5), SymbolType::Lreal);
            bench.set("go", Value::Bool(true), SymbolType::Bool);
        }
        let (state, position, velocity, _) = bench.scan();
        rows.push((state, position, velocity));
    }
    assert_eq!(bench.get("done", SymbolType::Bool), Value::Bool(true));
    rows
}

/// Runs a compiler; `None`, with a message, if it does not exist. In CI that is a failure.
fn compiled(name: &str, compiler: &str, arguments: &[&str]) -> Option<Program> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/programs");
    let out = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let output = Command::new(compiler)
        .args(arguments)
        .arg("-o")
        .arg(&out)
        .current_dir(folder)
        .output();
    let why = match output {
        Ok(output) if output.status.success() => {
            let bytes = fs::read(out).unwrap();
            return Some(Program::compile(&bytes, Settings::default()).unwrap());
        }
        Ok(output) => String::from_utf8_lossy(&output.stderr).into_owned(),
        Err(error) => error.to_string(),
    };
    assert!(
        std::env::var_os("CI").is_none(),
        "{compiler} is needed in CI: {why}"
    );
    eprintln!("SKIPPED {name}: {compiler} cannot build it here: {why}");
    None
}

#[test]
fn the_same_program_in_c_gives_the_same_motion() {
    let arguments = [
        "--target=wasm32",
        "-O2",
        "-ffreestanding",
        "-mbulk-memory",
        "-nostdlib",
        "-nostdlibinc",
        "-Iinclude",
        "-I../../../export/tests/golden/wasm",
        "-Wall",
        "-Wextra",
        "-Werror",
        "-Wl,--no-entry",
        "-Wl,--export=go",
        "-Wl,--export=target",
        "-Wl,--export=done",
        "move.c",
    ];
    if let Some(program) = compiled("c.wasm", "clang", &arguments) {
        assert!(rows_of(&program) == rows_of(&compile(MOVE).unwrap()));
    }
}

#[test]
fn the_same_program_in_rust_gives_the_same_motion() {
    let arguments = [
        "--edition",
        "2024",
        "--target",
        "wasm32-wasip1",
        "--crate-type",
        "cdylib",
        "-O",
        "-C",
        "panic=abort",
        "move.rs",
    ];
    if let Some(program) = compiled("rust.wasm", "rustc", &arguments) {
        assert!(rows_of(&program) == rows_of(&compile(MOVE).unwrap()));
    }
}

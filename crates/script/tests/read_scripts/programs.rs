//! Scripts with programs: the data read from them, and a message for every error in one.

use super::cases::GOOD;
use standstill_fb::PinType;
use standstill_script::{ScriptError, model::Script, read_with_programs};
use std::fmt::Write;

const GUEST: &str = r#"(module (memory (export "memory") 1) (func (export "plc_scan") (param i32 i64)))"#;

/// A good guest, one without a scan, one that imports what does not exist, and no module at all.
const FILES: [(&str, &str); 4] = [
    ("main.wat", GUEST),
    ("idle.wat", r#"(module (memory (export "memory") 1))"#),
    (
        "fly.wat",
        r#"(module (import "standstill" "mc_fly" (func)) (memory (export "memory") 1)
            (func (export "plc_scan") (param i32 i64)))"#,
    ),
    ("notes.txt", "what the program shall do"),
];

/// The good script with these programs.
fn with(programs: &str) -> Result<Script, ScriptError> {
    changed(&format!(r#"{{"main": {programs}}}"#), "", "")
}

/// The good script with these programs, and one piece of it replaced.
fn changed(programs: &str, old: &str, new: &str) -> Result<Script, ScriptError> {
    let text = GOOD.replacen("{\n", &format!("{{\n  \"programs\": {programs},\n"), 1);
    assert!(text.contains(old));
    let text = text.replacen(old, new, 1);
    let mut files = |_: &str| Err("there are no files here".to_owned());
    read_with_programs(&text, "jog.scan.json", &[], &mut files, &mut |wanted| {
        let file = FILES.iter().find(|(name, _)| *name == wanted);
        file.map(|(_, text)| text.as_bytes().to_vec())
            .ok_or_else(|| "there is no such file".to_owned())
    })
}

#[test]
fn symbols_have_the_types_of_compilers_and_signals_those_of_pins() {
    let types = [
        ("BOOL", PinType::Bool),
        ("SINT", PinType::Int),
        ("INT", PinType::Int),
        ("DINT", PinType::Lreal),
        ("USINT", PinType::Word),
        ("UINT", PinType::Word),
        ("UDINT", PinType::Dword),
        ("BYTE", PinType::Word),
        ("WORD", PinType::Word),
        ("DWORD", PinType::Dword),
        ("REAL", PinType::Lreal),
        ("LREAL", PinType::Lreal),
        ("TIME", PinType::Time),
    ];
    let symbols: Vec<_> = types
        .iter()
        .map(|(ty, _)| format!(r#""my{ty}": "{ty}""#))
        .collect();
    let script = with(&format!(
        r#"{{"wasm": "main.wat", "symbols": {{{}, "far": {{"type": "DINT", "address": 4294967295}}}}}}"#,
        symbols.join(", ")
    ))
    .unwrap_or_else(|error| panic!("{error}"));
    let symbols = &script.programs[0].symbols;
    assert_eq!(symbols[0].name, "Fault");
    for (symbol, (own, signal)) in symbols[1..].iter().zip(types) {
        assert_eq!((symbol.own.iec_name(), symbol.ty), (own, signal));
    }
    assert_eq!(symbols[14].address, Some(u32::MAX));
}

#[test]
fn every_bad_program_has_its_error_and_only_that() {
    let many = |count: usize| -> String {
        let of = |number| format!(r#""p{number}": {{"wasm": "main.wat"}}"#);
        (0..count).map(of).collect::<Vec<_>>().join(", ")
    };
    let symbols = |text: &str| format!(r#"{{"main": {{"wasm": "main.wat", "symbols": {{{text}}}}}}}"#);
    let crowd: Vec<_> = (0..257).map(|number| format!(r#""s{number}": "BOOL""#)).collect();
    let main = |text: &str| format!(r#"{{"main": {text}}}"#);
    let (set, go) = (r#"{"GO": true}"#, |text: &str| format!("{{{text}}}"));
    let dint = symbols(r#""n": "DINT", "b": "BYTE", "go": "BOOL""#);
    let cases: Vec<(&str, &str, String, &str, String)> = vec![
        (
            "wrong_type",
            "programs are no list",
            "[]".into(),
            "",
            String::new(),
        ),
        (
            "too_large",
            "17 programs",
            format!("{{{}}}", many(17)),
            "",
            String::new(),
        ),
        (
            "wrong_type",
            "a program is no path",
            main("\"main.wat\""),
            "",
            String::new(),
        ),
        ("missing_key", "no module", main("{}"), "", String::new()),
        (
            "wrong_type",
            "a module without a name",
            main(r#"{"wasm": 1}"#),
            "",
            String::new(),
        ),
        (
            "unknown_key",
            "a key that does not exist",
            main(r#"{"wasm": "main.wat", "fule": 9}"#),
            "",
            String::new(),
        ),
        (
            "bad_value",
            "no fuel",
            main(r#"{"wasm": "main.wat", "fuel": 0}"#),
            "",
            String::new(),
        ),
        (
            "bad_value",
            "too much fuel",
            main(r#"{"wasm": "main.wat", "fuel": 1000000001}"#),
            "",
            String::new(),
        ),
        (
            "bad_value",
            "memory beyond 32 bits",
            main(r#"{"wasm": "main.wat", "memory": 4294967297}"#),
            "",
            String::new(),
        ),
        (
            "wrong_type",
            "may_fault is no number",
            main(r#"{"wasm": "main.wat", "may_fault": 1}"#),
            "",
            String::new(),
        ),
        (
            "bad_program",
            "no such file",
            main(r#"{"wasm": "gone.wat"}"#),
            "",
            String::new(),
        ),
        (
            "bad_program",
            "no module of WebAssembly",
            main(r#"{"wasm": "notes.txt"}"#),
            "",
            String::new(),
        ),
        (
            "bad_program",
            "no plc_scan",
            main(r#"{"wasm": "idle.wat"}"#),
            "",
            String::new(),
        ),
        (
            "bad_program",
            "an import nobody offers",
            main(r#"{"wasm": "fly.wat"}"#),
            "",
            String::new(),
        ),
        (
            "bad_program",
            "memory above its limit",
            main(r#"{"wasm": "main.wat", "memory": 65535}"#),
            "",
            String::new(),
        ),
        (
            "unknown_task",
            "a task that does not exist",
            main(r#"{"wasm": "main.wat", "task": "fast"}"#),
            "",
            String::new(),
        ),
        (
            "duplicate_name",
            "the name of a block",
            r#"{"n": {"wasm": "main.wat"}}"#.into(),
            "",
            String::new(),
        ),
        (
            "bad_name",
            "a name that is none",
            r#"{"1st": {"wasm": "main.wat"}}"#.into(),
            "",
            String::new(),
        ),
        (
            "wrong_type",
            "symbols are no list",
            main(r#"{"wasm": "main.wat", "symbols": ["n"]}"#),
            "",
            String::new(),
        ),
        (
            "too_large",
            "257 symbols",
            symbols(&crowd.join(", ")),
            "",
            String::new(),
        ),
        (
            "bad_name",
            "a symbol with a blank",
            symbols(r#""my n": "INT""#),
            "",
            String::new(),
        ),
        (
            "duplicate_name",
            "two symbols but for case",
            symbols(r#""n": "INT", "N": "INT""#),
            "",
            String::new(),
        ),
        (
            "duplicate_name",
            "the symbol of the runtime",
            symbols(r#""fault": "BOOL""#),
            "",
            String::new(),
        ),
        (
            "bad_value",
            "a type that no symbol has",
            symbols(r#""n": "STRING""#),
            "",
            String::new(),
        ),
        (
            "wrong_type",
            "a type is no number",
            symbols(r#""n": 4"#),
            "",
            String::new(),
        ),
        (
            "missing_key",
            "an address without a type",
            symbols(r#""n": {"address": 8}"#),
            "",
            String::new(),
        ),
        (
            "bad_value",
            "an address below 0",
            symbols(r#""n": {"type": "INT", "address": -1}"#),
            "",
            String::new(),
        ),
        (
            "unknown_signal",
            "a symbol nobody listed",
            dint.clone(),
            r#""m.Busy": true"#,
            r#""main.m": 1"#.into(),
        ),
        (
            "not_writable",
            "what the runtime writes",
            dint.clone(),
            set,
            go(r#""main.Fault": true"#),
        ),
        (
            "wrong_type",
            "a number for a BOOL",
            dint.clone(),
            set,
            go(r#""main.go": 1"#),
        ),
        (
            "bad_value",
            "half a DINT",
            dint.clone(),
            set,
            go(r#""main.n": 0.5"#),
        ),
        (
            "bad_value",
            "a DINT of 32 bits without a sign",
            dint.clone(),
            set,
            go(r#""main.n": 4294967295"#),
        ),
        (
            "bad_value",
            "a BYTE of nine bits",
            dint,
            set,
            go(r#""main.b": 256"#),
        ),
    ];
    let mut messages = String::new();
    for (code, title, programs, old, new) in cases {
        let error = changed(&programs, old, &new).expect_err(title);
        let diagnostics = error.diagnostics();
        let codes: Vec<_> = diagnostics
            .iter()
            .map(|diagnostic| diagnostic.code.name())
            .collect();
        assert_eq!(codes, [code], "{title}\n{error}");
        let long = |line: &str| line.len() > 400;
        let told: Vec<_> = error
            .to_string()
            .lines()
            .filter(|line| !long(line))
            .map(str::to_owned)
            .collect();
        writeln!(messages, "# {title}\n{}\n", told.join("\n")).unwrap();
    }
    insta::assert_snapshot!(messages);
}

#[test]
fn beside_programs_there_are_numbers_for_49150_instances() {
    let blocks: Vec<_> = (0..49_151)
        .map(|number| format!(r#"{{"name": "b{number}", "type": "R_TRIG"}}"#))
        .collect();
    let text = format!(
        r#"{{"standstill": 1, "cycle": "T#1ms", "scans": 1, "axes": {{}}, "expect": [],
            "programs": {{"main": {{"wasm": "main.wat"}}}}, "blocks": [{}]}}"#,
        blocks.join(", ")
    );
    let mut files = |_: &str| Err("there are no files here".to_owned());
    let mut guest = |_: &str| Ok(GUEST.as_bytes().to_vec());
    let error = read_with_programs(&text, "crowd.scan.json", &[], &mut files, &mut guest)
        .expect_err("one instance too many");
    let told: Vec<_> = (error.diagnostics().iter())
        .map(|diagnostic| (diagnostic.code.name(), diagnostic.message.as_str()))
        .collect();
    assert_eq!(
        told,
        [(
            "too_large",
            "beside programs a script has less than 49151 instances"
        )]
    );
}

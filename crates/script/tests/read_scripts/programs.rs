//! Scripts with programs: the data read from them, and a message for every error in one.

use super::cases::{GOOD, table};
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
fn beside(programs: &str) -> String {
    GOOD.replacen("{\n", &format!("{{\n  \"programs\": {programs},\n"), 1)
}

fn read(text: &str) -> Result<Script, ScriptError> {
    let mut files = |_: &str| Err("there are no files here".to_owned());
    read_with_programs(text, "jog.scan.json", &[], &mut files, &mut |wanted| {
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
    let script = read(&beside(&format!(
        r#"{{"main": {{"wasm": "main.wat", "symbols": {{{}, "far": {{"type": "DINT", "address": 4294967295}}}}}}}}"#,
        symbols.join(", ")
    )))
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
    let of = |number| format!(r#""p{number}": {{"wasm": "main.wat"}}"#);
    let programs = (0..17).map(of).collect::<Vec<_>>().join(", ");
    let of = |number| format!(r#""s{number}": "BOOL""#);
    let symbols = (0..257).map(of).collect::<Vec<_>>().join(", ");
    let mut messages = String::new();
    for case in table(include_str!("bad_programs.txt")) {
        let text = case.text(&beside(r#"{"main": {"wasm": "main.wat"}}"#));
        let text = text
            .replace("17 PROGRAMS", &programs)
            .replace("257 SYMBOLS", &symbols);
        let error = read(&text).expect_err(case.title);
        let codes: Vec<_> = error.diagnostics().iter().map(|it| it.code.name()).collect();
        assert_eq!(codes, [case.code], "{}\n{error}", case.title);
        let error = error.to_string();
        let told: Vec<_> = error.lines().filter(|line| line.len() <= 400).collect();
        writeln!(messages, "# {}\n{}\n", case.title, told.join("\n")).unwrap();
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

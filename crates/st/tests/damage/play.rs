//! Bytes as the text of a program: nothing of it panics, what compiles is a valid module, and what is laid out stays so.

use standstill_st::{Options, Source, compile, format, references};

pub fn play(bytes: &[u8]) {
    let source = Source {
        name: "prog.st",
        bytes,
    };
    let options = Options {
        lint: true,
        coverage: bytes.len().is_multiple_of(2),
        ..Options::default()
    };
    match compile(&[source], &options) {
        Ok(compiled) => {
            let _shown = compiled.report.render();
            wasmparser::validate(&compiled.wasm).expect("a valid module");
        }
        Err(report) => {
            let _shown = report.render();
        }
    }
    if let Ok(once) = format("prog.st", bytes) {
        let twice = format("prog.st", once.as_bytes()).expect("what was laid out can be read");
        assert_eq!(once, twice);
    }
    if let Ok(text) = std::str::from_utf8(bytes) {
        let _names = references(text);
    }
}

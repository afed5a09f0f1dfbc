//! Bytes as the text of a program: nothing of it panics, what compiles is a valid module, what is laid out stays so, and an
//! editor may ask at any place.

use standstill_st::editor::{complete, hover};
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
    // At a place that the bytes choose.
    let place = bytes.iter().fold(0_usize, |sum, byte| sum + usize::from(*byte)) % (bytes.len() + 1);
    if bytes.len().is_multiple_of(3) {
        let _offered = complete(&[source], &options, 0, place);
    } else {
        let (sources, found) = hover(&[source], &options, 0, place);
        if let Some(declared) = found.and_then(|it| it.declared) {
            let (file, range) = sources.locate(declared);
            assert!(file == 0 && range.end <= bytes.len(), "{range:?}");
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

//! Bytes as the text of a program: nothing panics, a compiled program is a valid module, a second layout
//! changes nothing, and an editor may ask at any place.

use standstill_st::editor::{complete, hover};
use standstill_st::{Options, Source, compile, format, references};

/// `check` fails if a module is not valid.
pub fn play(bytes: &[u8], check: fn(&[u8])) {
    let source = Source {
        name: "prog.st",
        bytes,
    };
    let options = Options {
        lint: true,
        coverage: bytes.len().is_multiple_of(2),
        ..Options::default()
    };
    let report = match compile(&[source], &options) {
        Ok(compiled) => {
            check(&compiled.wasm);
            compiled.report
        }
        Err(report) => *report,
    };
    // The bytes select the further questions and their place: most of the time is left to the compiler.
    let chosen = bytes.iter().fold(0_usize, |sum, byte| sum + usize::from(*byte));
    let place = chosen / 4 % (bytes.len() + 1);
    match chosen % 4 {
        0 => drop(complete(&[source], &options, 0, place)),
        1 => {
            let (sources, found) = hover(&[source], &options, 0, place);
            if let Some(declared) = found.and_then(|it| it.declared) {
                let (file, range) = sources.locate(declared);
                assert!(file == 0 && range.end <= bytes.len(), "{range:?}");
            }
        }
        2 => {
            if let Ok(once) = format("prog.st", bytes) {
                let twice = format("prog.st", once.as_bytes()).expect("what was laid out can be read");
                assert_eq!(once, twice);
            }
        }
        _ => {
            let _shown = report.render();
            if let Ok(text) = std::str::from_utf8(bytes) {
                let _names = references(text);
            }
        }
    }
}

//! After any change of a script, reading it gives a script or at least one message with a place in the
//! text, never a panic. Seeded, so a failure can be repeated.

use super::cases::GOOD;
use standstill_script::{format, read};
use standstill_testkit::{Random, cases, stride};

const TEXTS: [&str; 3] = [
    GOOD,
    include_str!("contract_example.scan.json"),
    include_str!("every_key.scan.json"),
];

/// Pieces that are put in place of others.
const PIECES: &[&str] = &[
    "null",
    "true",
    "0",
    "-1",
    "1.5",
    "1e308",
    "9007199254740993",
    "\"\"",
    "\"X\"",
    "\"NaN\"",
    "\"T#1ms\"",
    "\"T#-5h\"",
    "\"m.Busy\"",
    "\"X.State\"",
    "[]",
    "{}",
    "[{}]",
    "{\"param\": \"v\"}",
    "{\"from\": \"GO\"}",
    ",",
    ":",
    "}",
    "]",
    "\"",
    "\\u",
    "\u{feff}",
    "é",
    "\u{0}",
    "\n",
];

fn check(text: &str) {
    match read(text, "mutated.scan.json", &[]) {
        Ok(script) => {
            let laid_out = format(text, "").unwrap();
            assert_eq!(format(&laid_out, "").unwrap(), laid_out);
            let again = read(&laid_out, "", &[]).unwrap_or_else(|error| panic!("{error}\n{laid_out}"));
            assert_eq!(again.steps.len(), script.steps.len());
        }
        Err(error) => {
            assert!(!error.diagnostics().is_empty(), "{text}");
            for diagnostic in error.diagnostics() {
                let span = diagnostic.span.unwrap();
                let plain = text.strip_prefix('\u{feff}').unwrap_or(text);
                assert!(
                    plain.get(span.start..span.end).is_some(),
                    "{diagnostic:?}\n{text}"
                );
            }
            assert!(error.render().contains("mutated.scan.json:"), "{text}");
        }
    }
}

/// The tokens of a script, roughly: enough to swap values and keys for others.
fn tokens(text: &str) -> Vec<(usize, usize)> {
    let mut tokens = Vec::new();
    let mut start = None;
    let mut in_string = false;
    for (at, c) in text.char_indices() {
        let ends = if in_string {
            c == '"'
        } else {
            c.is_whitespace() || ",:{}[]".contains(c)
        };
        match start {
            Some(first) if ends => {
                tokens.push((first, at + usize::from(in_string)));
                (start, in_string) = (None, false);
            }
            None if !ends => (start, in_string) = (Some(at), c == '"'),
            _ => {}
        }
    }
    tokens
}

#[test]
fn every_beginning_of_a_script_is_refused_with_a_place() {
    for text in TEXTS {
        let whole = text.trim_end();
        for (at, _) in whole.char_indices().step_by(stride()) {
            let error = read(&whole[..at], "cut.scan.json", &[]).expect_err("a beginning");
            assert!(error.render().contains("cut.scan.json:"));
        }
    }
}

#[test]
fn scripts_with_pieces_exchanged_never_panic() {
    let mut random = Random(0x5eed);
    for round in 0..cases(1500) as usize {
        let mut text = TEXTS[round % TEXTS.len()].to_owned();
        for _ in 0..=random.place(2) {
            let places = tokens(&text);
            let (start, end) = places[random.place(places.len())];
            let piece = match random.place(3) {
                0 => {
                    let (from, to) = places[random.place(places.len())];
                    text[from..to].to_owned()
                }
                _ => PIECES[random.place(PIECES.len())].to_owned(),
            };
            text.replace_range(start..end, &piece);
        }
        check(&text);
    }
}

#[test]
fn scripts_with_bytes_changed_never_panic() {
    let mut random = Random(0xb17e);
    for round in 0..cases(1500) as usize {
        let mut bytes = TEXTS[round % TEXTS.len()].as_bytes().to_vec();
        for _ in 0..=random.place(3) {
            let at = random.place(bytes.len());
            match random.place(3) {
                0 => bytes[at] = random.place(256) as u8,
                1 => drop(bytes.drain(at..(at + random.place(40)).min(bytes.len()))),
                _ => {
                    let copy: Vec<u8> = bytes[at..(at + random.place(40)).min(bytes.len())].to_vec();
                    let to = random.place(bytes.len());
                    bytes.splice(to..to, copy);
                }
            }
        }
        check(&String::from_utf8_lossy(&bytes));
    }
}

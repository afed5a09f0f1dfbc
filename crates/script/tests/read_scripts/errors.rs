//! Bad scripts by hand: each has exactly one error, of the code written beside it, and the messages together
//! are a snapshot to be read.

use super::cases::{GOOD, cases};
use standstill_script::{CELLS_MAX, Code, ENTITIES_MAX, SCANS_MAX, ScriptError, read};
use std::collections::BTreeSet;
use std::fmt::Write;

fn refused(text: &str) -> ScriptError {
    read(text, "jog.scan.json", &[]).expect_err(text)
}

#[test]
fn the_good_script_is_good() {
    read(GOOD, "jog.scan.json", &[]).unwrap_or_else(|error| panic!("{error}"));
}

#[test]
fn every_bad_script_has_its_error_and_only_that() {
    let mut messages = String::new();
    for case in cases() {
        let error = refused(&case.text(GOOD));
        let codes: Vec<_> = error
            .diagnostics()
            .iter()
            .map(|diagnostic| diagnostic.code.name())
            .collect();
        assert_eq!(codes, [case.code], "{}\n{error}", case.title);
        writeln!(messages, "# {}\n{error}\n", case.title).unwrap();
    }
    insta::assert_snapshot!(messages);
}

#[test]
fn every_code_has_a_case_and_its_own_name() {
    let mut tried: BTreeSet<&str> = cases().iter().map(|case| case.code).collect();
    // Too deep for a table: see the test of the JSON reader.
    tried.insert("too_deep");
    // Of builds without an interpreter only.
    tried.insert("not_built");
    let all: BTreeSet<&str> = Code::ALL.iter().map(|code| code.name()).collect();
    assert_eq!(tried, all);
    assert_eq!(all.len(), Code::ALL.len());
    assert!(Code::ALL.iter().all(|code| code.doc().ends_with('.')));
}

#[test]
fn all_errors_show_at_once_in_the_order_of_the_text() {
    let text = GOOD
        .replace("\"velocity\": 50", "\"velocity\": -1")
        .replace("\"Execute\": false", "\"Exceute\": false, \"Velocty\": 3")
        .replace("\"m.Busy\": true", "\"m.Busy\": 3, \"k.Done\": true");
    let error = refused(&text);
    let places: Vec<_> = error
        .diagnostics()
        .iter()
        .map(|diagnostic| {
            (
                error.line_column(diagnostic.span.unwrap()),
                diagnostic.code.name(),
            )
        })
        .collect();
    assert_eq!(
        places,
        [
            ((6, 34), "bad_value"),
            ((11, 68), "unknown_pin"),
            ((11, 86), "unknown_pin"),
            ((17, 34), "wrong_type"),
            ((17, 37), "unknown_signal"),
        ],
        "{error}"
    );
}

#[test]
fn many_errors_are_counted_and_not_all_drawn() {
    let keys: Vec<String> = (0..1000).map(|number| format!("\"key{number}\": 0")).collect();
    let text = GOOD.replacen('{', &format!("{{{},", keys.join(",")), 1);
    let error = refused(&text);
    assert_eq!(error.diagnostics().len(), 1000);
    assert!(
        error
            .render()
            .ends_with("error: 980 more errors in jog.scan.json"),
        "{error}"
    );
}

#[test]
fn an_override_of_nothing_is_an_error_without_a_place() {
    let text = GOOD.replacen("\"inputs\"", "\"parameters\": {\"speed\": 1}, \"inputs\"", 1);
    let error = read(&text, "jog.scan.json", &[("sped".to_owned(), 2.0)]).unwrap_err();
    assert_eq!(error.diagnostics()[0].span, None);
    insta::assert_snapshot!(error);
}

#[test]
fn columns_count_characters_and_crlf_counts_as_one_line_end() {
    let text = GOOD
        .replacen("{\n", "{\n  \"title\": \"größer\", \"tilte\": 1,\n", 1)
        .replace('\n', "\r\n");
    let error = refused(&format!("\u{feff}{text}"));
    assert_eq!(error.line_column(error.diagnostics()[0].span.unwrap()), (2, 22));
    assert!(error.render().contains("jog.scan.json:2:22"), "{error}");
    assert!(!error.render().contains('\r'), "{error}");
}

#[test]
fn strange_names_cannot_disturb_the_terminal() {
    let text = GOOD.replacen("\"GO\": false", "\"\\u001b[2J\": false", 1);
    let error = refused(&text).render();
    assert!(error.contains("`\\u{1b}[2J` cannot be a name"), "{error}");
    assert!(!error.contains('\u{1b}'), "{error}");
    // Nor forge a line, or look like another name.
    for (hidden, shown) in [
        ("\\nerror", "\\u{a}error"),
        ("\\u200d", "\\u{200d}"),
        ("\\ufeff", "\\u{feff}"),
    ] {
        let text = GOOD.replacen("\"GO\": false", &format!("\"G{hidden}O\": false"), 1);
        let error = refused(&text).render();
        assert!(
            error.contains(&format!("`G{shown}O` cannot be a name")),
            "{error}"
        );
    }
}

/// A script of `scans` scans and `inputs` inputs, and the codes of its errors.
fn codes_of_size(cycle: &str, scans: u64, inputs: usize) -> Vec<&'static str> {
    let inputs: Vec<String> = (0..inputs).map(|number| format!("\"i{number}\": 0")).collect();
    let inputs = inputs.join(",");
    let text = format!(
        "{{\"standstill\": 1, \"cycle\": \"{cycle}\", \"scans\": {scans}, \"axes\": {{}}, \"blocks\": [], \"inputs\": {{{inputs}}}}}"
    );
    match read(&text, "size.scan.json", &[]) {
        Ok(_) => Vec::new(),
        Err(error) => error
            .diagnostics()
            .iter()
            .map(|diagnostic| diagnostic.code.name())
            .collect(),
    }
}

#[test]
fn sizes_are_allowed_up_to_the_named_limits_and_not_beyond() {
    assert!(codes_of_size("T#1ms", CELLS_MAX / 2, 0).is_empty());
    assert_eq!(codes_of_size("T#1ms", SCANS_MAX, 0), ["too_large"]);
    assert_eq!(codes_of_size("T#1ms", SCANS_MAX + 1, 0), ["too_large"]);
    // Scan, time and 98 inputs are 100 columns.
    assert!(codes_of_size("T#1ms", CELLS_MAX / 100, 98).is_empty());
    assert_eq!(codes_of_size("T#1ms", CELLS_MAX / 100 + 1, 98), ["too_large"]);
    assert!(codes_of_size("T#1ms", 1, ENTITIES_MAX).is_empty());
    assert_eq!(codes_of_size("T#1ms", 1, ENTITIES_MAX + 1), ["too_large"]);
    // 2^63 ns are about 2,562,047 hours.
    assert!(codes_of_size("T#1000h", 2562, 0).is_empty());
    assert_eq!(codes_of_size("T#1000h", 2563, 0), ["too_large"]);
}

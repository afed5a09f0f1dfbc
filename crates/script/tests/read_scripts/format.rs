//! The canonical layout: the example has a readable layout, and nothing else changes.

use standstill_script::{format, read};

const EXAMPLE: &str = include_str!("contract_example.scan.json");

#[test]
fn the_example_laid_out() {
    insta::assert_snapshot!(format(EXAMPLE, "example.scan.json").unwrap());
}

#[test]
fn laying_out_twice_changes_nothing_and_the_script_stays_the_same() {
    let once = format(EXAMPLE, "example.scan.json").unwrap();
    assert_eq!(format(&once, "example.scan.json").unwrap(), once);
    assert!(read(&once, "example.scan.json", &[]).is_ok());
    // An independent parser sees the same values, and the text shows the same order of keys.
    let values = |text: &str| serde_json::from_str::<serde_json::Value>(text).unwrap();
    assert_eq!(values(&once), values(EXAMPLE));
    let without_space = |text: &str| text.replace([' ', '\n'], "");
    assert_eq!(without_space(&once), without_space(EXAMPLE));
}

#[test]
fn marks_and_crlf_are_gone_and_strings_are_kept() {
    let text = "\u{feff}{\r\n\"b\": \"\\u00e9\\u0001\\\"\\/\",\r\n \"a\" : [ ] , \"c\":{}}";
    assert_eq!(
        format(text, "").unwrap(),
        "{\n  \"b\": \"é\\u0001\\\"/\",\n  \"a\": [],\n  \"c\": {}\n}\n"
    );
}

#[test]
fn an_error_names_the_file_and_the_place() {
    // The name as it is given; a backslash may be part of it.
    for name in ["dir/x.scan.json", "dir/x\\y.scan.json"] {
        let error = format("{\n  \"a\": 1,\n}", name).unwrap_err();
        assert!(error.render().contains(&format!("--> {name}:2:9")), "{error}");
    }
}

//! The canonical layout.

use crate::support::{SCRIPT, fed, read, standstill, with_script, write};

#[test]
fn scripts_are_laid_out_in_place_and_named() {
    let folder = with_script("fmt_files");
    write(&folder, "dense.scan.json", r#"{"standstill":1,"cycle":"T#1ms"}"#);
    let check = standstill(&folder, &["fmt", "--check", "."]);
    assert_eq!(
        (check.status, check.out.contains("./dense.scan.json\n")),
        (1, true)
    );
    assert_eq!(
        read(&folder, "dense.scan.json"),
        r#"{"standstill":1,"cycle":"T#1ms"}"#
    );
    assert_eq!(standstill(&folder, &["fmt", "."]).status, 0);
    assert_eq!(
        read(&folder, "dense.scan.json"),
        "{\n  \"standstill\": 1,\n  \"cycle\": \"T#1ms\"\n}\n"
    );
    let again = standstill(&folder, &["fmt", "--check", "."]);
    assert_eq!((again.status, again.out.as_str()), (0, ""));
}

#[test]
fn a_script_that_is_no_json_is_left_alone() {
    let folder = with_script("fmt_broken");
    write(&folder, "broken.scan.json", "{\"scans\": }");
    let ended = standstill(&folder, &["fmt", "."]);
    assert_eq!(ended.status, 3);
    ended.complains("broken.scan.json:1:11");
    assert_eq!(read(&folder, "broken.scan.json"), "{\"scans\": }");
}

#[test]
fn standard_input_is_laid_out_to_standard_output() {
    let laid_out = fed(&["fmt", "-"], SCRIPT.as_bytes());
    assert_eq!(laid_out.status, 0);
    assert_eq!(fed(&["fmt", "-"], laid_out.out.as_bytes()).out, laid_out.out);
    assert_eq!(fed(&["fmt", "--check", "-"], laid_out.out.as_bytes()).status, 0);
    assert_eq!(fed(&["fmt", "--check", "-"], b"{\"standstill\":1}").status, 1);
}

//! Goldens on disk: an accepted golden passes again, every difference is detected and named, and insta
//! reads the same files.

use crate::common;

use std::fs;
use std::path::Path;

use standstill_trace::golden::{GoldenError, Verdict, accept, exact_path, judge, text};

#[test]
fn what_is_accepted_is_the_same_until_it_is_not() {
    let snap = common::folder("accepted").join("there_and_back.snap");
    let trace = common::run(800, None);
    assert_eq!(judge(&snap, &trace).expect("readable"), Verdict::Missing);
    assert!(accept(&snap, &trace).expect("writable"));
    assert_eq!(judge(&snap, &trace).expect("readable"), Verdict::Same);
    assert!(!accept(&snap, &trace).expect("writable"), "nothing left to write");

    let verdict = judge(&snap, &common::run(800, Some(400))).expect("readable");
    let Verdict::Different(mismatch) = verdict else {
        panic!("one bit must be seen: {verdict:?}")
    };
    let told = mismatch.to_string();
    println!("{told}");
    assert!(
        told.starts_with("first difference in scan 400 (T#400ms), 1 signal\n  X.Position"),
        "{told}"
    );
    let digests = "\ndigests that differ: read, X; the same: inputs, power, there, back, wait\n";
    assert!(told.contains(digests), "{told}");
    assert!(
        told.contains("\n-end  800 scans  ") && told.contains("\n+end  800 scans  "),
        "{told}"
    );
}

#[test]
fn a_companion_that_does_not_fit_is_told_and_accepted_anew() {
    let snap = common::folder("companion").join("x.snap");
    let trace = common::run(100, None);
    accept(&snap, &trace).expect("writable");
    let of_another_run = standstill_trace::exact::encode(&common::run(100, Some(50)));
    for bad in [Some(of_another_run.as_slice()), Some(b"".as_slice()), None] {
        match bad {
            Some(bad) => fs::write(exact_path(&snap), bad).expect("writable"),
            None => fs::remove_file(exact_path(&snap)).expect("removable"),
        }
        assert!(matches!(
            judge(&snap, &trace).expect("readable"),
            Verdict::Companion(_)
        ));
        let verdict = judge(&snap, &common::run(100, Some(60))).expect("readable");
        let Verdict::Different(mismatch) = verdict else {
            panic!("{verdict:?}")
        };
        assert!(
            mismatch
                .to_string()
                .starts_with("the first differing scan cannot be named: "),
            "{mismatch}"
        );
        assert!(accept(&snap, &trace).expect("writable"));
        assert_eq!(judge(&snap, &trace).expect("readable"), Verdict::Same);
    }
}

#[test]
fn a_file_that_is_no_snapshot_is_an_error_and_can_be_accepted_over() {
    let snap = common::folder("foreign").join("x.snap");
    let trace = common::run(10, None);
    for foreign in ["", "hello\n", "---\nsource: x\n"] {
        fs::write(&snap, foreign).expect("writable");
        assert!(
            matches!(judge(&snap, &trace), Err(GoldenError::Form { .. })),
            "{foreign:?}"
        );
        accept(&snap, &trace).expect("writable");
        assert_eq!(judge(&snap, &trace).expect("readable"), Verdict::Same);
    }
    let no_folder = common::folder("foreign").join("missing").join("x.snap");
    assert!(matches!(accept(&no_folder, &trace), Err(GoldenError::Io { .. })));
}

#[test]
fn line_ends_of_a_windows_checkout_do_not_count() {
    let snap = common::folder("crlf").join("x.snap");
    let trace = common::run(100, None);
    accept(&snap, &trace).expect("writable");
    let file = fs::read_to_string(&snap).expect("readable");
    fs::write(&snap, file.replace('\n', "\r\n")).expect("writable");
    assert_eq!(judge(&snap, &trace).expect("readable"), Verdict::Same);
}

#[test]
fn insta_reads_the_file_and_its_macro_accepts_it() {
    let folder = common::folder("insta");
    let snap = folder.join("it's: a #test.snap");
    let trace = common::run(100, None);
    accept(&snap, &trace).expect("writable");
    let read = insta::Snapshot::from_file(&snap).expect("insta reads it");
    assert_eq!(read.metadata().source(), Some("it's: a #test.scan.json"));
    assert_eq!(read.metadata().expression(), Some("golden"));
    let mut settings = insta::Settings::new();
    settings.set_snapshot_path(&folder);
    settings.set_prepend_module_to_snapshot(false);
    settings.bind(|| insta::assert_snapshot!("it's: a #test", text(&trace)));
}

#[test]
fn a_file_that_insta_wrote_is_judged() {
    let folder = common::folder("insta-wrote");
    let trace = common::run(100, None);
    let snap = folder.join("x.snap");
    let meta = "source: crates/x/tests/goldens.rs\nassertion_line: 12\nexpression: \"text(&trace)\"\ninfo:\n  a: 1\n";
    fs::write(&snap, format!("---\n{meta}---\n{}", text(&trace))).expect("writable");
    fs::write(exact_path(&snap), standstill_trace::exact::encode(&trace)).expect("writable");
    assert_eq!(judge(&snap, &trace).expect("readable"), Verdict::Same);
}

#[test]
fn what_is_no_row_shows_in_the_text_alone() {
    let snap = common::folder("limits").join("x.snap");
    let trace = common::run(100, None);
    accept(&snap, &trace).expect("writable");
    let mut header = common::header();
    header.axes[0].limits.velocity = Some(250.0);
    let other = common::under(header, &trace);
    let verdict = judge(&snap, &other).expect("readable");
    let Verdict::Different(mismatch) = verdict else {
        panic!("{verdict:?}")
    };
    let told = mismatch.to_string();
    assert!(told.starts_with("every bit of the rows is equal"), "{told}");
    assert!(told.contains("+axis    X  mm  order 4  v=250.0"), "{told}");
}

/// An obstacle to the new file leaves the old one as it is.
#[test]
fn a_golden_that_cannot_be_written_is_an_error_with_its_path() {
    // The tests of the command line show that a full disk leaves the old one whole.
    let snap = Path::new(env!("CARGO_TARGET_TMPDIR")).join("golden_whole/absent/x.snap");
    let refused = accept(&snap, &common::run(60, Some(30)));
    assert!(
        matches!(&refused, Err(GoldenError::Io { path, .. }) if *path == snap),
        "{refused:?}"
    );
}

#[test]
fn no_control_character_of_a_golden_reaches_a_terminal() {
    let snap = common::folder("control").join("x.snap");
    let trace = common::run(100, None);
    accept(&snap, &trace).expect("writable");
    let reviewed = fs::read_to_string(&snap).expect("readable");
    let digests = reviewed.find("\ndigests\n").expect("a section");
    // In the events, and as the name of a subject.
    let damaged = reviewed[..digests].replacen("events\n", "events\n\u{1b}[2J", 1)
        + &reviewed[digests..].replacen("  X ", "  X\0\u{1b}[2J", 1);
    fs::write(&snap, damaged).expect("writable");
    let Verdict::Different(mismatch) = judge(&snap, &trace).expect("readable") else {
        panic!("it is another text")
    };
    let told = mismatch.to_string();
    assert!(told.contains("X\\u{0}\\u{1b}[2J"), "{told}");
    let bad = told.chars().find(|letter| letter.is_control() && *letter != '\n');
    assert_eq!(bad, None, "{told}");
}

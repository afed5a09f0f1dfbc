//! Traces in files: the name decides the form, the header goes along, and errors name the file.

mod common;

use std::fs;
use std::io;
use std::path::Path;

use standstill_trace::compare::compare;
use standstill_trace::file::{FileError, can_save, load, replace, save};
use standstill_trace::golden;

#[test]
fn every_form_comes_back() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("file");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder for the test");
    let trace = common::run(50, None);
    for name in ["run.csv", "run.jsonl"] {
        let path = folder.join(name);
        assert!(can_save(&path));
        save(&trace, &path).expect("writable");
        let loaded = load(&path).expect("our own file");
        assert_eq!(loaded.lacks, Vec::<String>::new());
        assert_eq!(loaded.trace.header(), trace.header());
        assert_eq!(compare(&loaded.trace, &trace), None);
    }
    fs::remove_file(folder.join("run.csv.meta.json")).expect("the header was written beside the rows");
    assert_eq!(load(&folder.join("run.csv")).expect("rows alone").lacks.len(), 1);

    golden::accept(&folder.join("run.snap"), &trace).expect("writable");
    let exact = load(&folder.join("run.exact")).expect("a companion");
    assert_eq!(compare(&exact.trace, &trace), None);

    let text = folder.join("run.txt");
    assert!(!can_save(&text) && !can_save(&folder.join("run.exact")));
    assert!(matches!(save(&trace, &text), Err(FileError::Form { .. })));
    assert!(matches!(
        load(&folder.join("none.csv")),
        Err(FileError::Io { .. })
    ));
    fs::write(folder.join("bad.csv"), "a;b\n").expect("writable");
    let error = load(&folder.join("bad.csv")).expect_err("no trace").to_string();
    assert!(
        error.ends_with("bad.csv: line 1, column 1: a trace begins with the columns `scan` and `time_ns`")
    );
}

#[test]
fn a_file_is_replaced_whole_or_not_at_all() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("replaced");
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder for the test");
    let path = folder.join("out.html");
    replace(&path, |out| out.write_all(b"first")).expect("writable");
    let failed = replace(&path, |out| {
        out.write_all(b"half of the sec")?;
        Err(io::Error::from(io::ErrorKind::StorageFull))
    });
    let message = failed.expect_err("no room").to_string();
    assert!(
        message.contains("out.html: ") && !message.contains("partial"),
        "{message}"
    );
    assert_eq!(fs::read_to_string(&path).expect("still there"), "first");
    assert_eq!(
        fs::read_dir(&folder).expect("readable").count(),
        1,
        "nothing is left beside it"
    );
    assert!(replace(&folder.join("absent/out.html"), |_| Ok(())).is_err());
    assert!(replace(&folder, |_| Ok(())).is_err(), "a folder is no file");
}

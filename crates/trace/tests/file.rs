//! Traces in files: the name selects the form, the header is included, and errors name the file.

use crate::common;

use std::fs;
use std::io;
use std::path::Path;

use standstill_trace::compare::compare;
use standstill_trace::csv::{self, Dialect};
use standstill_trace::file::{FileError, Saving, Streaming, can_save, load, replace, save, save_as};
use standstill_trace::{Trace, digest, golden};

#[test]
fn every_form_comes_back() {
    let folder = common::folder("file");
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
    let folder = common::folder("replaced");
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

#[test]
#[cfg(unix)]
fn nothing_is_written_through_a_link_and_permissions_stay() {
    use standstill_trace::file::{read_regular, replace_beside};
    use std::os::unix::fs::{PermissionsExt, symlink};

    let folder = common::folder("links");
    let (outside, link) = (folder.join("outside"), folder.join("link"));
    fs::write(&outside, "as it was").expect("writable");
    type Way = fn(&Path) -> Result<(), FileError>;
    let ways: [Way; 2] = [
        |path| replace(path, |out| out.write_all(b"new")),
        |path| replace_beside(path, |out| out.write_all(b"new")),
    ];
    for write in ways {
        let _ = fs::remove_file(&link);
        symlink("outside", &link).expect("a link");
        write(&link).expect("writable");
        assert!(!fs::symlink_metadata(&link).expect("it is there").is_symlink());
        assert_eq!(fs::read_to_string(&link).expect("readable"), "new");
        assert_eq!(fs::read_to_string(&outside).expect("readable"), "as it was");
    }
    let mode = |path: &Path| fs::metadata(path).expect("it is there").permissions().mode() & 0o777;
    fs::set_permissions(&outside, fs::Permissions::from_mode(0o640)).expect("ours");
    replace(&outside, |out| out.write_all(b"new")).expect("writable");
    assert_eq!(mode(&outside), 0o640);
    let fresh = folder.join("fresh");
    fs::write(&fresh, "").expect("writable");
    assert_eq!(mode(&link), mode(&fresh), "a new file is as any other");
    // A device is written where a person names it, and nowhere else.
    let null = Path::new("/dev/null");
    assert!(replace(null, |out| out.write_all(b"gone")).is_ok());
    assert!(replace_beside(null, |_| Ok(())).is_err());
    assert!(read_regular(null).is_err());
}

#[test]
fn a_trace_is_begun_before_there_is_one() {
    let folder = common::folder("begun");
    assert!(Saving::begin(&folder.join("absent/a.csv")).is_err());
    let saving = Saving::begin(&folder.join("a.csv")).expect("writable");
    assert!(!folder.join("a.csv").exists());
    drop(saving);
    assert_eq!(
        fs::read_dir(&folder).expect("readable").count(),
        0,
        "nothing is left"
    );
    let saving = Saving::begin(&folder.join("a.csv")).expect("writable");
    saving
        .finish(&common::run(5, None), Default::default())
        .expect("writable");
    assert_eq!(load(&folder.join("a.csv")).expect("our own").trace.scans(), 5);
}

#[test]
fn a_trace_that_is_written_on_the_way_is_the_one_written_at_its_end() {
    let folder = common::folder("on_the_way");
    let whole = common::run(200, None);
    for (name, dialect) in [
        ("x.csv", Dialect::default()),
        (
            "y.csv",
            Dialect {
                delimiter: ';',
                decimal_comma: true,
            },
        ),
        ("x.jsonl", Dialect::default()),
    ] {
        let (at_end, on_the_way) = (folder.join(format!("at_end_{name}")), folder.join(name));
        save_as(&whole, &at_end, dialect).expect("a folder to write to");
        let mut header = whole.header().clone();
        let claims = std::mem::take(&mut header.claims);
        let mut trace = Trace::new(header);
        let mut writing = Streaming::begin(&trace, &on_the_way, dialect).expect("a folder to write to");
        let mut notes = whole.notes().iter().peekable();
        for scan in 0..whole.scans() {
            trace
                .push_cells(whole.row(scan))
                .expect("a row of the same columns");
            while let Some(note) = notes.next_if(|note| note.scan == scan) {
                trace.push_note(note.clone());
            }
            if scan % 7 == 0 {
                writing.look(&trace).expect("room for it");
                trace.forget(3);
            }
        }
        assert!(trace.scans() == 200 && trace.first() > 180, "rows were forgotten");
        // Notes of scans that the run did not reach.
        notes.for_each(|note| trace.push_note(note.clone()));
        trace.set_claims(claims);
        let kept = writing.kept().map(|(partial, rows)| (partial.to_owned(), rows));
        assert_eq!(kept, Some((folder.join(format!("{name}.partial")), 197)));
        writing.finish(&trace).expect("room for it");
        let [expected, found] = [&at_end, &on_the_way].map(|path| load(path).expect("our own file").trace);
        assert_eq!(found.header(), expected.header());
        assert_eq!(found.notes(), expected.notes());
        assert_eq!(digest::whole(&found), digest::whole(&expected));
        if name.ends_with(".csv") {
            for of in [|path: &Path| path.to_owned(), csv::meta_path] {
                let [expected, found] =
                    [&at_end, &on_the_way].map(|path| fs::read(of(path)).expect("a file"));
                assert!(found == expected, "{name}");
            }
        }
    }
}

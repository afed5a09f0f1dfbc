//! `export`: which files it writes, and what it refuses.

use crate::support::{scratch, standstill, typed};
use std::fs;

#[test]
fn files_are_written_and_named() {
    let place = scratch("export_files");
    let ended = typed(&place, "export st-rusty --out made/here --prefix acme");
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    let names = [
        "acme.h",
        "acme_blocks.h",
        "acme_shim.h",
        "acme_rusty.st",
        "acme_rusty.c",
    ];
    assert_eq!(ended.out.lines().collect::<Vec<_>>(), names);
    let mut found: Vec<_> = fs::read_dir(place.join("made/here"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .collect();
    found.sort();
    let mut expected = names.map(str::to_owned);
    expected.sort();
    assert_eq!(found, expected);
    assert!(
        fs::read_to_string(place.join("made/here/acme_rusty.c"))
            .unwrap()
            .contains("acme_mc_move_absolute(ACME_RUNTIME &self->key")
    );
}

#[test]
fn a_prefix_that_is_no_identifier_is_bad_usage() {
    let place = scratch("export_prefix");
    for prefix in ["2a", "a-b", "Acme", ""] {
        let ended = standstill(&place, &["export", "c", "--out", "out", "--prefix", prefix]);
        assert_eq!(ended.status, 2, "{prefix}");
        ended.complains(&format!("the prefix is `{prefix}`"));
        assert!(!place.join("out").exists());
    }
}

#[test]
fn an_unknown_dialect_is_bad_usage() {
    let place = scratch("export_dialect");
    let ended = standstill(&place, &["export", "c", "--out", "out", "--dialect", "klingon"]);
    assert_eq!(ended.status, 2);
    ended.complains("there is no dialect `klingon`: choose one of twincat");
}

#[test]
fn a_folder_that_cannot_be_written_leaves_nothing() {
    let place = scratch("export_unwritable");
    fs::write(place.join("file"), "kept").unwrap();
    let ended = standstill(&place, &["export", "c", "--out", "file/below"]);
    assert_eq!(ended.status, 4);
    assert!(
        ended.err.contains("file/below") && ended.err.contains("nothing was written"),
        "{}",
        ended.err
    );
    assert_eq!(fs::read_to_string(place.join("file")).unwrap(), "kept");

    // The second file cannot take its place: the first one is not written either.
    fs::create_dir_all(place.join("half/standstill_blocks.h/in_the_way")).unwrap();
    let ended = standstill(&place, &["export", "c", "--out", "half"]);
    assert_eq!(ended.status, 4);
    ended.complains("half/standstill_blocks.h");
    assert_eq!(fs::read_dir(place.join("half")).unwrap().count(), 1);
}

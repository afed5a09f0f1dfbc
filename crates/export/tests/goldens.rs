//! The output for every target is compared with files: the headers of the C library, and those in
//! `golden/`. `STANDSTILL_GOLDENS=write` in the environment writes them.

use standstill_export::{Dialect, File, Prefix, Target, export};
use standstill_fb::ring::FIELDS;
use std::fs;
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden")
}

fn include() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../capi/include")
}

fn hold(folder: &Path, file: &File) {
    let path = folder.join(&file.name);
    if std::env::var_os("STANDSTILL_GOLDENS").is_some_and(|value| value == "write") {
        fs::create_dir_all(folder).unwrap();
        fs::write(&path, &file.text).unwrap();
    }
    let found = fs::read_to_string(&path).unwrap_or_default();
    if found != file.text {
        let same = found.lines().zip(file.text.lines()).take_while(|(a, b)| a == b);
        let line = same.count();
        panic!(
            "{} differs from line {} on:\n- {}\n+ {}\nrun `STANDSTILL_GOLDENS=write cargo test -p standstill-export`, \
             and read what changes",
            path.display(),
            line + 1,
            found.lines().nth(line).unwrap_or("(nothing)"),
            file.text.lines().nth(line).unwrap_or("(nothing)"),
        );
    }
}

/// The guest's header is written from the fields; that of the C library is not.
#[test]
fn both_headers_name_the_same_events() {
    let header = fs::read_to_string(include().join("standstill.h")).unwrap();
    let plain: Vec<_> = header.split_whitespace().filter(|word| *word != "*").collect();
    let (.., events, _) = FIELDS.iter().find(|field| field.0 == "event").unwrap();
    let events: Vec<_> = events.split_whitespace().collect();
    assert!(plain.join(" ").contains(&events.join(" ")), "{events:?}");
}

#[test]
fn every_target_writes_what_stands_here() {
    let plain = |target| export(target, &Prefix::default(), &Dialect::default());
    let headers = plain(Target::C);
    for file in &headers {
        hold(&include(), file);
    }
    let guest = plain(Target::Wasm);
    for target in Target::ALL.into_iter().filter(|target| *target != Target::C) {
        let known = |file: &&File| headers.contains(file) || (target != Target::Wasm && guest.contains(file));
        for file in plain(target).iter().filter(|file| !known(file)) {
            hold(&folder().join(target.name()), file);
        }
    }
}

#[test]
fn a_dialect_changes_names_and_numbers_and_nothing_else() {
    for name in Dialect::known() {
        let dialect = Dialect::new(name).unwrap();
        let mut differences = String::new();
        for target in [Target::StMatiec, Target::StRusty, Target::PlcopenXml] {
            let plain = export(target, &Prefix::default(), &Dialect::default());
            let other = export(target, &Prefix::default(), &dialect);
            for (plain, other) in plain.iter().zip(&other) {
                differences += &format!("== {}\n", other.name);
                // Compared line by line: a line that a dialect changes stays in its place, except for additions.
                let known: Vec<_> = plain.text.lines().collect();
                for line in other.text.lines().filter(|line| !known.contains(line)) {
                    differences += &format!("{line}\n");
                }
            }
        }
        let file = File {
            name: format!("{name}.txt"),
            text: differences,
        };
        hold(&folder().join("dialects"), &file);
    }
}

#[test]
fn a_prefix_is_in_every_name_of_c() {
    let prefix = Prefix::new("acme").unwrap();
    for target in Target::ALL {
        let plain = export(target, &Prefix::default(), &Dialect::default());
        let other = export(target, &prefix, &Dialect::default());
        assert_eq!(plain.len(), other.len());
        for (plain, other) in plain.iter().zip(&other) {
            assert_eq!(other.name, plain.name.replace("standstill", "acme"));
            for word in [
                "standstill_",
                "STANDSTILL_",
                "\"standstill.h\"",
                "\"standstill\")",
            ] {
                assert!(!other.text.contains(word), "{}: {word}", other.name);
            }
        }
    }
}

/// Our names in C must not be words of C, C++, or macros of common headers.
#[test]
fn no_field_is_a_word_of_c_or_cpp() {
    let words = "auto bool break case catch char class const continue default delete do double else enum explicit \
        export extern false float for friend goto if inline int long mutable namespace new operator private \
        protected public register restrict return short signed sizeof static struct switch template this \
        throw true try typedef typename union unsigned using virtual void volatile while xor and or not size \
        result key table";
    let words: Vec<&str> = words.split(' ').collect();
    for info in standstill_blocks::REGISTRY {
        for pin in info.pins() {
            assert!(!words.contains(&pin.field), "{}.{}", info.name, pin.field);
        }
    }
}

#[test]
fn the_imports_are_json_and_name_every_block() {
    let files = export(Target::Wasm, &Prefix::default(), &Dialect::default());
    let json = files.iter().find(|file| file.name.ends_with(".json")).unwrap();
    let value: serde_json::Value = serde_json::from_str(&json.text).unwrap();
    let imports = value["imports"].as_array().unwrap();
    assert_eq!(imports.len(), standstill_blocks::REGISTRY.len() + 2);
    // A block whose pins are fixed by IEC 61131-3.
    let timer = imports.iter().find(|import| import["name"] == "ton").unwrap();
    assert_eq!(timer["in"]["size"], 16);
    assert_eq!(timer["in"]["fields"][1]["name"], "PT");
    assert_eq!(timer["in"]["fields"][1]["offset"], 8);
}

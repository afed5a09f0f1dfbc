//! The repository is tidy: generated files are fresh, packages are complete, forbidden words stay out.

use standstill_xtask::{Compliance, Faults, Generated, Package, Requirements, files, generated, root};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

/// Computed once, because scripts run for it.
static GENERATED: LazyLock<Vec<Generated>> = LazyLock::new(generated);

#[test]
fn generated_files_are_fresh() {
    for file in GENERATED.iter() {
        let found = fs::read_to_string(root().join(&file.path)).unwrap_or_default();
        assert!(
            found == file.text,
            "{} is stale: run `cargo run -p standstill-xtask --example gen`",
            file.path
        );
    }
}

/// With a second program `cargo run` of README would be ambiguous.
#[test]
fn the_command_line_is_the_only_program() {
    let workspace = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let members = workspace
        .lines()
        .filter_map(|line| line.trim().strip_prefix('"')?.strip_suffix("\","));
    let is_program = |member: &&str| {
        let folder = root().join(member);
        let manifest = fs::read_to_string(folder.join("Cargo.toml")).unwrap();
        manifest.contains("[[bin]]")
            || ["main.rs", "bin"]
                .iter()
                .any(|name| folder.join("src").join(name).exists())
    };
    let programs: BTreeSet<_> = members.filter(is_program).collect();
    assert_eq!(programs, BTreeSet::from(["crates/cli"]));
}

/// Plain `cargo test` leaves out only what `.ci/run` names or what has no tests.
#[test]
fn a_new_crate_is_tested_by_plain_cargo_test() {
    let workspace = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let list = |key: &str| -> BTreeSet<String> {
        let (_, rest) = workspace.split_once(&format!("\n{key} = [")).unwrap();
        let (inside, _) = rest.split_once(']').unwrap();
        let members = inside.split('"').skip(1).step_by(2);
        members.map(str::to_owned).collect()
    };
    let (all, tested) = (list("members"), list("default-members"));
    let left_out: Vec<_> = all.difference(&tested).map(String::as_str).collect();
    assert_eq!(
        left_out,
        [
            "crates/bench",
            "crates/bench/panic-probe",
            "crates/bench/same-bits",
            "crates/mutants",
            "crates/peers",
            "crates/playground",
            "crates/python",
        ]
    );
}

/// If Cargo does not search for tests, a test file that is not named would not run.
#[test]
fn every_file_of_tests_is_part_of_a_program() {
    let crates = fs::read_dir(root().join("crates"))
        .unwrap()
        .map(|entry| entry.unwrap().path());
    let together = fs::read_to_string(root().join("crates/tests/Cargo.toml")).unwrap();
    for folder in crates {
        let manifest = fs::read_to_string(folder.join("Cargo.toml")).unwrap();
        if !manifest.contains("autotests = false") {
            continue;
        }
        let main = fs::read_to_string(folder.join("tests/main.rs")).unwrap();
        let name = folder.file_name().unwrap().to_str().unwrap();
        assert!(
            manifest.contains("\npath = \"tests/main.rs\"\n")
                || together.contains(&format!("\npath = \"../{name}/tests/main.rs\"\n")),
            "neither {name} nor crates/tests builds its tests"
        );
        for entry in fs::read_dir(folder.join("tests")).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_stem().unwrap().to_str().unwrap();
            let is_module = is(&path, "rs") || path.join("mod.rs").exists();
            let is_named = name == "main"
                || main.contains(&format!("\nmod {name};\n"))
                || manifest.contains(&format!("\nname = \"{name}\"\n"));
            assert!(
                !is_module || is_named,
                "{}: tests/main.rs does not name it",
                path.display()
            );
        }
    }
}

/// A test in a library that Cargo does not test would not run.
#[test]
fn libraries_that_are_not_tested_have_no_tests() {
    let files = files();
    let is_untested = |manifest: &&PathBuf| {
        let text = fs::read_to_string(manifest).unwrap();
        text.split("\n[")
            .any(|section| section.starts_with("lib]") && section.contains("\ntest = false\n"))
    };
    for manifest in files
        .iter()
        .filter(|path| path.ends_with("Cargo.toml"))
        .filter(is_untested)
    {
        let sources = manifest.with_file_name("src");
        for path in files.iter().filter(|path| path.starts_with(&sources)) {
            let has_tests = is(path, "rs") && fs::read_to_string(path).unwrap().contains("#[test]");
            assert!(
                !has_tests,
                "{} is in a library that is not tested",
                path.display()
            );
        }
    }
}

/// Rust code in its docs would not be tested.
#[test]
fn libraries_without_tests_of_docs_have_none() {
    let files = files();
    let untried = files
        .iter()
        .filter(|path| path.ends_with("Cargo.toml"))
        .filter(|manifest| {
            fs::read_to_string(manifest)
                .unwrap()
                .contains("\ndoctest = false\n")
        });
    for manifest in untried {
        let sources = manifest.with_file_name("src");
        for path in files
            .iter()
            .filter(|path| path.starts_with(&sources) && is(path, "rs"))
        {
            let text = fs::read_to_string(path).unwrap();
            let docs = text.lines().map(str::trim_start);
            let fences = docs.filter_map(|line| {
                let line = line.strip_prefix("///").or_else(|| line.strip_prefix("//!"))?;
                line.trim_start().strip_prefix("```")
            });
            for language in fences.step_by(2) {
                assert!(
                    !language.is_empty() && !language.starts_with("rust"),
                    "{} has Rust in its docs, which nothing tries",
                    path.display()
                );
            }
        }
    }
}

#[test]
fn every_block_has_a_timing_picture() {
    for info in standstill_blocks::REGISTRY {
        let path = format!("docs/blocks/{}.svg", info.name.to_lowercase());
        assert!(
            GENERATED.iter().any(|file| file.path == path),
            "{} has no line in crates/xtask/pictures.txt",
            info.name
        );
    }
}

#[test]
fn every_block_has_a_guide_or_the_word_none() {
    let problems = standstill_xtask::problems_of_guides();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn every_requirement_has_a_test_or_a_stated_gap() {
    let problems = Requirements::read().problems();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

/// Covers: R87
#[test]
fn the_compliance_statement_is_true() {
    let problems = Compliance::read().problems();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn every_error_is_shown_by_a_trace_or_has_a_reason() {
    let problems = Faults::read().problems();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

#[test]
fn the_glossary_has_every_word_that_an_event_begins_with() {
    let glossary = fs::read_to_string(root().join("docs/glossary.md")).unwrap();
    let (_, table) = glossary
        .split_once("## Words in the events of a run")
        .expect("the section of the events");
    let cells = table
        .lines()
        .filter_map(|line| line.strip_prefix("| ")?.split(" | ").next());
    let known: BTreeSet<&str> = cells
        .flat_map(|cell| cell.split(", "))
        .filter_map(|event| event.split([' ', ':']).next())
        .collect();
    let words = Faults::read().words_of_events();
    assert!(words.len() > 15, "{words:?}");
    let missing: Vec<_> = words
        .iter()
        .filter(|word| !known.contains(word.as_str()))
        .collect();
    assert!(
        missing.is_empty(),
        "docs/glossary.md, *Words in the events of a run*, has no row for {missing:?}"
    );
}

/// Checks that `cargo package` itself does not make; the rest is a step of `.ci/run`.
#[test]
fn packages_say_what_a_registry_asks_for() {
    let packages = Package::published();
    assert!(packages.len() >= 12, "{packages:?}");
    let problems: Vec<_> = packages.iter().flat_map(Package::problems).collect();
    assert!(problems.is_empty(), "{}", problems.join("\n"));
}

/// A file outside its folder is not in the package.
#[test]
fn published_sources_include_nothing_from_outside_their_package() {
    let root = root().canonicalize().unwrap();
    let sources = files().into_iter().filter(|path| is(path, "rs"));
    let all: Vec<_> = sources.map(|path| path.canonicalize().unwrap()).collect();
    for package in Package::published() {
        let folder = root.join(&package.folder);
        let sources = folder.join("src");
        for path in all.iter().filter(|path| path.starts_with(&sources)) {
            let text = fs::read_to_string(path).unwrap();
            for (at, _) in text.match_indices("include_str!(\"") {
                // The README's examples are tests of the facade, in this repository only.
                if text[..at].ends_with("#[cfg(doctest)]\n#[doc = ") {
                    continue;
                }
                let target = text[at..].split('"').nth(1).unwrap();
                let target = path.parent().unwrap().join(target).canonicalize().unwrap();
                assert!(
                    target.starts_with(&folder),
                    "{} includes {}",
                    path.display(),
                    target.display()
                );
            }
        }
    }
}

fn is(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|found| found == extension)
}

#[test]
fn forbidden_words_stay_out_of_the_sources() {
    // Written in two halves so that this file passes its own test.
    let forbidden = [
        concat!("dbg", "!("),
        concat!("FIX", "ME"),
        concat!("XX", "X "),
        concat!("TO", "DO"),
    ];
    for path in files().iter().filter(|path| is(path, "rs") || is(path, "md")) {
        let text = fs::read_to_string(path).unwrap();
        for word in forbidden {
            assert!(!text.contains(word), "{}: {word}", path.display());
        }
    }
}

#[test]
fn the_top_level_holds_what_a_newcomer_expects() {
    let allowed = [
        "CITATION.cff",
        "Cargo.lock",
        "Cargo.toml",
        "LICENSE-APACHE",
        "LICENSE-MIT",
        "README.md",
        "SECURITY.md",
        "blocks",
        "crates",
        "docs",
        "scan-tests",
        "soak-failures",
        "target",
    ];
    for entry in fs::read_dir(root()).unwrap() {
        let name = entry.unwrap().file_name().to_string_lossy().into_owned();
        assert!(
            name.starts_with('.') || allowed.contains(&name.as_str()),
            "unexpected at the top level: {name}"
        );
    }
}

/// Packages and their permitted dependencies, from bottom to top (docs/architecture.md).
const LAYERS: &str = "
planner:
axis: planner
fb: axis
blocks: axis fb
drives: axis
scan: axis fb
standstill: axis blocks fb planner record scan
record: axis fb trace
capi: axis blocks drives fb record
export: blocks fb
guest: axis blocks fb
st: blocks fb
trace:
picture: trace
report: picture trace
script: axis blocks drives fb guest planner record scan st trace
testkit:
soak: axis blocks drives fb planner script testkit
sweep: script trace
watch: axis fb script trace
live: script
lsp: blocks fb script st
cli: blocks export fb live lsp picture planner report script soak st sweep trace watch
playground: cli picture planner report script trace
python: axis cli picture script trace
xtask: axis blocks drives fb picture planner script trace
";

#[test]
fn layers_depend_only_downwards() {
    for (name, allowed) in LAYERS.lines().filter_map(|line| line.split_once(':')) {
        let folder = match name {
            "blocks" => root().join(name),
            _ => root().join("crates").join(name),
        };
        let package = match name {
            "standstill" => name.to_owned(),
            _ => format!("standstill-{name}"),
        };
        let manifest = fs::read_to_string(folder.join("Cargo.toml")).unwrap();
        assert!(manifest.contains(&format!("name = \"{package}\"")), "{name}");
        // Dev-dependencies may look upwards; only shipped code is layered.
        let shipped = manifest.split("[dev-dependencies]").next().unwrap();
        let dependencies = shipped.split("[dependencies]").nth(1).unwrap_or("");
        for line in dependencies.lines().filter(|line| line.starts_with("standstill")) {
            let dependency = line.split(['.', ' ', '=']).next().unwrap();
            let dependency = dependency.strip_prefix("standstill-").unwrap_or(dependency);
            assert!(
                allowed.split(' ').any(|layer| layer == dependency),
                "{name} must not depend on {dependency}"
            );
        }
    }
}

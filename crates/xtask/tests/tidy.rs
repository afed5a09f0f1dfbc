//! The repository is tidy: generated files are fresh, links lead somewhere, forbidden words stay out.

use standstill_xtask::{Compliance, Faults, Requirements, generated, root};
use std::fs;
use std::path::{Path, PathBuf};

#[test]
fn generated_files_are_fresh() {
    for file in generated() {
        let found = fs::read_to_string(root().join(&file.path)).unwrap_or_default();
        assert!(
            found == file.text,
            "{} is stale: run `cargo run -p standstill-xtask --example gen`",
            file.path
        );
    }
}

#[test]
fn every_block_has_a_timing_picture() {
    let files = generated();
    for info in standstill_blocks::REGISTRY {
        let path = format!("docs/blocks/{}.svg", info.name.to_lowercase());
        assert!(
            files.iter().any(|file| file.path == path),
            "{} has no line in crates/xtask/pictures.txt",
            info.name
        );
    }
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

/// Every file of the repository that people read or write, without build products.
fn files() -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut folders = vec![root()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap() {
            let path = entry.unwrap().path();
            let name = path.file_name().unwrap().to_string_lossy().into_owned();
            if path.is_dir() {
                if name != "target" && name != ".git" && name != "node_modules" {
                    folders.push(path);
                }
            } else {
                files.push(path);
            }
        }
    }
    files.sort();
    files
}

fn is(path: &Path, extension: &str) -> bool {
    path.extension().is_some_and(|found| found == extension)
}

#[test]
fn relative_links_in_docs_lead_somewhere() {
    for path in files().iter().filter(|path| is(path, "md")) {
        let text = fs::read_to_string(path).unwrap();
        for (_, rest) in text.match_indices("](").map(|(at, _)| text.split_at(at + 2)) {
            let target = rest.split([')', '#', ' ']).next().unwrap();
            if target.is_empty() || target.contains("://") {
                continue;
            }
            assert!(
                path.parent().unwrap().join(target).exists(),
                "{}: dead link {target}",
                path.display()
            );
        }
    }
}

#[test]
fn forbidden_words_stay_out_of_the_sources() {
    // Spelled in two halves so that this file passes its own test.
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

#[test]
fn layers_depend_only_downwards() {
    // Package and what it may depend on, from bottom to top (docs/architecture.md).
    let layers: [(&str, &str, &[&str]); 15] = [
        ("crates/planner", "standstill-planner", &[]),
        ("crates/axis", "standstill-axis", &["standstill-planner"]),
        ("crates/fb", "standstill-fb", &["standstill-axis"]),
        (
            "blocks",
            "standstill-blocks",
            &["standstill-axis", "standstill-fb"],
        ),
        ("crates/drives", "standstill-drives", &["standstill-axis"]),
        (
            "crates/scan",
            "standstill-scan",
            &["standstill-axis", "standstill-fb"],
        ),
        (
            "crates/standstill",
            "standstill",
            &[
                "standstill-axis",
                "standstill-blocks",
                "standstill-fb",
                "standstill-planner",
                "standstill-scan",
            ],
        ),
        (
            "crates/capi",
            "standstill-capi",
            &[
                "standstill-axis",
                "standstill-blocks",
                "standstill-drives",
                "standstill-fb",
            ],
        ),
        (
            "crates/export",
            "standstill-export",
            &["standstill-blocks", "standstill-fb"],
        ),
        ("crates/trace", "standstill-trace", &[]),
        ("crates/report", "standstill-report", &["standstill-trace"]),
        (
            "crates/script",
            "standstill-script",
            &[
                "standstill-axis",
                "standstill-blocks",
                "standstill-drives",
                "standstill-fb",
                "standstill-planner",
                "standstill-scan",
                "standstill-trace",
            ],
        ),
        (
            "crates/soak",
            "standstill-soak",
            &[
                "standstill-axis",
                "standstill-blocks",
                "standstill-fb",
                "standstill-planner",
                "standstill-scan",
            ],
        ),
        (
            "crates/cli",
            "standstill-cli",
            &[
                "standstill-blocks",
                "standstill-export",
                "standstill-fb",
                "standstill-planner",
                "standstill-report",
                "standstill-script",
                "standstill-soak",
                "standstill-trace",
            ],
        ),
        (
            "crates/xtask",
            "standstill-xtask",
            &[
                "standstill-axis",
                "standstill-blocks",
                "standstill-drives",
                "standstill-fb",
                "standstill-planner",
                "standstill-script",
                "standstill-trace",
            ],
        ),
    ];
    for (folder, name, allowed) in layers {
        let manifest = fs::read_to_string(root().join(folder).join("Cargo.toml")).unwrap();
        assert!(manifest.contains(&format!("name = \"{name}\"")), "{folder}");
        // Dev-dependencies may look upwards; only what ships is layered.
        let shipped = manifest.split("[dev-dependencies]").next().unwrap();
        let dependencies = shipped.split("[dependencies]").nth(1).unwrap_or("");
        for line in dependencies.lines().filter(|line| line.starts_with("standstill")) {
            let dependency = line.split(['.', ' ', '=']).next().unwrap();
            assert!(
                allowed.contains(&dependency),
                "{name} must not depend on {dependency}"
            );
        }
    }
}

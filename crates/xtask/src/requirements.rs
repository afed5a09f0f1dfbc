//! `docs/requirements/`: every id, its rule in a few words, and the tests that cover it.
//!
//! The rules are in `crates/xtask/requirements/*.txt`, one on each line behind its id, and so are the gaps, each
//! with its reason. A scan script claims ids with `covers`, a Rust test with a comment `Covers: R21, S3` above it.

use crate::{Generated, NOTICE, files_below, read, root, slashed};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

/// File names below `crates/xtask/requirements` and `docs/requirements`, without extension.
const AREAS: [&str; 9] = [
    "rules",
    "states",
    "buffer-modes",
    "coupling",
    "structured-text",
    "tables",
    "vendor-choices",
    "executor",
    "vibration",
];

/// Largest number of lines between a comment and its `fn`.
const REACH: usize = 8;

/// One page: its title, and its ids with their rules, in order.
#[derive(Debug)]
struct Area {
    name: &'static str,
    title: String,
    rules: Vec<(String, String)>,
}

/// A test as a page names it: text and target of a link, relative to the repository root.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Test {
    path: String,
    name: String,
}

/// A rule: its page, its id and its short text.
#[derive(Clone, Copy, Debug)]
pub struct Rule<'a> {
    pub area: &'a str,
    pub id: &'a str,
    pub text: &'a str,
}

/// All rules, gaps and tests.
#[derive(Debug)]
pub struct Requirements {
    areas: Vec<Area>,
    tests: BTreeMap<String, BTreeSet<Test>>,
    gaps: Vec<(String, String)>,
}

impl Requirements {
    /// Reads rules, gaps, scripts and tests of the repository.
    pub fn read() -> Self {
        let mut tests = BTreeMap::new();
        claims_of_scripts(&mut tests);
        claims_of_rust(&mut tests);
        Self {
            areas: AREAS.into_iter().map(area).collect(),
            tests,
            gaps: gaps(&data("gaps")),
        }
    }

    fn ids(&self) -> impl Iterator<Item = &str> {
        self.areas
            .iter()
            .flat_map(|area| area.rules.iter().map(|(id, _)| id.as_str()))
    }

    fn gap(&self, id: &str) -> Option<&str> {
        let (_, reason) = self.gaps.iter().find(|(gap, _)| gap == id)?;
        Some(reason)
    }

    /// The faults: an id with neither test nor gap or with both, a claim or a gap of an unknown id.
    pub fn problems(&self) -> Vec<String> {
        let mut found = Vec::new();
        let known: BTreeSet<&str> = self.ids().collect();
        if known.len() < self.ids().count() {
            found.push("an id stands twice in crates/xtask/requirements".into());
        }
        for id in self.ids() {
            match (self.tests.get(id), self.gap(id)) {
                (None, None) => found.push(format!(
                    "{id}: no test covers it; claim it in a test, or state the gap in crates/xtask/requirements/gaps.txt"
                )),
                (Some(tests), Some(_)) => found.push(format!(
                    "{id}: a gap is stated, but {} covers it; remove it from gaps.txt",
                    tests.first().map_or("", |test| test.path.as_str())
                )),
                _ => {}
            }
        }
        for (id, tests) in &self.tests {
            if !known.contains(id.as_str()) {
                let parts: Vec<_> = self
                    .ids()
                    .filter(|part| {
                        part.strip_prefix(id)
                            .is_some_and(|rest| rest.chars().all(char::is_alphabetic))
                    })
                    .collect();
                let help = if parts.is_empty() {
                    String::new()
                } else {
                    format!("; name its parts: {}", parts.join(", "))
                };
                for test in tests {
                    found.push(format!("{}: claims the unknown id {id}{help}", test.path));
                }
            }
        }
        for (id, _) in &self.gaps {
            if !known.contains(id.as_str()) {
                found.push(format!("gaps.txt: unknown id {id}"));
            }
            if self.gaps.iter().filter(|(other, _)| other == id).count() > 1 {
                found.push(format!("gaps.txt: {id} stands twice"));
            }
        }
        found
    }

    /// The rules that name a block, and those that the scripts in its folder below `scan-tests/` cover, in order.
    pub fn of_block(&self, block: &str) -> Vec<Rule<'_>> {
        let folder = format!("scan-tests/{}/", snake_case(block));
        let is_covered = |id: &str| {
            let tests = self.tests.get(id).into_iter().flatten();
            tests.into_iter().any(|test| test.path.starts_with(&folder))
        };
        let names = |text: &str| {
            text.split(|character: char| !(character.is_alphanumeric() || character == '_'))
                .any(|word| word == block)
        };
        self.areas
            .iter()
            .flat_map(|area| area.rules.iter().map(move |(id, text)| (area.name, id, text)))
            .filter(|(_, id, text)| names(text) || is_covered(id))
            .map(|(area, id, text)| Rule { area, id, text })
            .collect()
    }

    /// The generated pages.
    pub fn pages(&self) -> Vec<Generated> {
        let mut files: Vec<_> = self.areas.iter().map(|area| self.page(area)).collect();
        files.push(self.index());
        files
    }

    fn page(&self, area: &Area) -> Generated {
        let mut text = format!(
            "{NOTICE}# {}\n\n| id | in short | tests |\n| --- | --- | --- |\n",
            area.title
        );
        for (id, rule) in &area.rules {
            let tests = match self.tests.get(id) {
                Some(tests) => links(tests),
                None => format!("*{}.*", self.gap(id).unwrap_or("None")),
            };
            let _ = writeln!(text, "| {id} | {rule} | {tests} |");
        }
        Generated {
            path: format!("docs/requirements/{}.md", area.name),
            text,
        }
    }

    fn index(&self) -> Generated {
        let mut text = format!(
            "{NOTICE}# Requirements\n\n\
             What the blocks and axes are held to, after PLCopen motion control Part 1 and 2: each rule by its\n\
             id, in short, and the tests that cover it. Scan scripts name ids in `covers`, Rust tests in a\n\
             comment `Covers: ..`. A test fails when an id has neither a test nor a stated gap.\n\n\
             | page | ids | covered | gaps |\n| --- | ---: | ---: | ---: |\n"
        );
        for area in &self.areas {
            let covered = area
                .rules
                .iter()
                .filter(|(id, _)| self.tests.contains_key(id))
                .count();
            let _ = writeln!(
                text,
                "| [{}]({}.md) | {} | {covered} | {} |",
                area.title,
                area.name,
                area.rules.len(),
                area.rules.len() - covered
            );
        }
        text.push_str("\n## Gaps\n\n| reason | ids |\n| --- | --- |\n");
        let mut reasons: Vec<&str> = Vec::new();
        for (_, reason) in &self.gaps {
            if !reasons.contains(&reason.as_str()) {
                reasons.push(reason);
            }
        }
        for reason in reasons {
            let ids: Vec<_> = self
                .gaps
                .iter()
                .filter(|(_, other)| other == reason)
                .map(|(id, _)| id.as_str())
                .collect();
            let _ = writeln!(text, "| {reason} | {} |", ids.join(", "));
        }
        Generated {
            path: "docs/requirements/README.md".into(),
            text,
        }
    }
}

/// `MC_MoveAbsolute` as `mc_move_absolute`.
fn snake_case(block: &str) -> String {
    let mut name = String::new();
    let mut before = '_';
    for character in block.chars() {
        if character.is_uppercase() && before.is_lowercase() {
            name.push('_');
        }
        name.extend(character.to_lowercase());
        before = character;
    }
    name
}

fn links(tests: &BTreeSet<Test>) -> String {
    let links: Vec<_> = tests
        .iter()
        .map(|test| format!("[{}](../../{})", test.name, test.path))
        .collect();
    links.join(", ")
}

fn data(name: &str) -> String {
    read(&format!("crates/xtask/requirements/{name}.txt"))
}

/// A file of rules: `# title`, then `id rule` a line.
fn area(name: &'static str) -> Area {
    let text = data(name);
    let mut lines = text.lines();
    let title = lines.next().and_then(|line| line.strip_prefix("# "));
    Area {
        name,
        title: title.unwrap_or(name).into(),
        rules: lines
            .filter_map(|line| line.split_once(' '))
            .map(|(id, rule)| (id.into(), rule.into()))
            .collect(),
    }
}

/// A file of gaps: `reason: id id ..` a line.
fn gaps(text: &str) -> Vec<(String, String)> {
    text.lines()
        .filter(|line| !line.starts_with('#'))
        .filter_map(|line| line.rsplit_once(": "))
        .flat_map(|(reason, ids)| ids.split_whitespace().map(move |id| (id.into(), reason.into())))
        .collect()
}

type Claims = BTreeMap<String, BTreeSet<Test>>;

fn claims_of_scripts(claims: &mut Claims) {
    for path in below("scan-tests", "json") {
        let Ok(script) = serde_json::from_str::<serde_json::Value>(&read(&path)) else {
            continue;
        };
        let name = path
            .trim_start_matches("scan-tests/")
            .trim_end_matches(".scan.json");
        let ids = script["covers"].as_array().into_iter().flatten();
        for id in ids.filter_map(|id| id.as_str()) {
            claims.entry(id.into()).or_default().insert(Test {
                path: path.clone(),
                name: name.into(),
            });
        }
    }
}

fn claims_of_rust(claims: &mut Claims) {
    for path in ["crates", "blocks"]
        .into_iter()
        .flat_map(|folder| below(folder, "rs"))
    {
        let text = read(&path);
        let lines: Vec<&str> = text.lines().collect();
        for (place, line) in lines.iter().enumerate() {
            let comment = line.trim_start().trim_start_matches('/');
            let Some(ids) = comment.strip_prefix(" Covers: ") else {
                continue;
            };
            let name = lines
                .iter()
                .skip(place + 1)
                .take(REACH)
                .find_map(|line| line.trim_start().trim_start_matches("pub ").strip_prefix("fn "))
                .and_then(|rest| rest.split(['(', '<']).next())
                .unwrap_or(&path);
            for id in ids.split(',') {
                claims.entry(id.trim().into()).or_default().insert(Test {
                    path: path.clone(),
                    name: name.into(),
                });
            }
        }
    }
}

/// Files of one extension below a folder of the repository, relative to its root, sorted.
fn below(folder: &str, extension: &str) -> Vec<String> {
    let files = files_below(&root().join(folder)).expect("a folder of the repository");
    let wanted = files
        .iter()
        .filter(|path| path.extension() == Some(extension.as_ref()));
    wanted.map(|path| slashed(path)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn requirements(claims: &[&str], stated: &str) -> Requirements {
        let test = Test {
            path: "a.rs".into(),
            name: "a".into(),
        };
        Requirements {
            areas: vec![Area {
                name: "rules",
                title: "Rules".into(),
                rules: ["R1", "T39a", "T39b"].map(|id| (id.into(), "..".into())).into(),
            }],
            tests: claims
                .iter()
                .map(|id| ((*id).into(), BTreeSet::from([test.clone()])))
                .collect(),
            gaps: gaps(stated),
        }
    }

    #[test]
    fn each_kind_of_problem_is_found() {
        let rows: [(&[&str], &str, &str); 6] = [
            (&["R1"], "not built: T39a T39b", ""),
            (&["R1"], "not built: T39a", "T39b: no test covers it"),
            (&["R1", "T39a"], "not built: T39a T39b", "T39a: a gap is stated"),
            (
                &["R1", "R99"],
                "not built: T39a T39b",
                "claims the unknown id R99",
            ),
            (
                &["R1", "T39"],
                "not built: T39a T39b",
                "name its parts: T39a, T39b",
            ),
            (&["R1"], "not built: T39a T39b\nnever: S9", "unknown id S9"),
        ];
        for (claims, stated, expected) in rows {
            let problems = requirements(claims, stated).problems().join("\n");
            assert_eq!(problems.is_empty(), expected.is_empty(), "{problems}");
            assert!(problems.contains(expected), "{problems}");
        }
    }
}

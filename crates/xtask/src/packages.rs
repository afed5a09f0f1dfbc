//! The descriptions of the published packages: a README each, and the fields that a registry requires.

use crate::{Generated, NOTICE, read, root};
use std::fs;

/// A member of the workspace.
#[derive(Debug)]
pub struct Package {
    /// Its folder, relative to the repository root.
    pub folder: String,
    /// Its name.
    pub name: String,
    description: String,
    manifest: String,
}

impl Package {
    /// The members of the workspace that are published.
    pub fn published() -> Vec<Self> {
        let manifest = read("Cargo.toml");
        let members = between(&manifest, "members = [", "]").expect("a list of members");
        let members = members.lines().filter_map(|line| between(line, "\"", "\""));
        members
            .map(|folder| {
                let manifest = read(&format!("{folder}/Cargo.toml"));
                let said = |key| between(&manifest, &format!("\n{key} = \""), "\"\n").unwrap_or_default();
                Self {
                    folder: folder.to_owned(),
                    name: said("name").to_owned(),
                    description: said("description").to_owned(),
                    manifest: manifest.clone(),
                }
            })
            .filter(|package| !package.manifest.contains("\npublish = false\n"))
            .collect()
    }

    /// The parts that a registry, or a reader there, would miss.
    pub fn problems(&self) -> Vec<String> {
        let mut problems = Vec::new();
        let mut must = |holds: bool, what: &str| {
            if !holds {
                problems.push(format!("{}: {what}", self.folder));
            }
        };
        let list = |key: &str| {
            let list = between(&self.manifest, &format!("\n{key} = ["), "]").unwrap_or_default();
            list.split(',').filter(|word| !word.trim().is_empty()).count()
        };
        must(!self.description.is_empty(), "no description");
        must((1..=5).contains(&list("keywords")), "not 1 to 5 keywords");
        must((1..=5).contains(&list("categories")), "not 1 to 5 categories");
        let page = format!("\ndocumentation = \"https://docs.rs/{}\"\n", self.name);
        must(
            self.manifest.contains(&page),
            "documentation is not its page at docs.rs",
        );
        for licence in ["LICENSE-MIT", "LICENSE-APACHE"] {
            let found = fs::read(root().join(&self.folder).join(licence)).unwrap_or_default();
            must(
                found == fs::read(root().join(licence)).expect("a licence of the repository"),
                &format!("{licence} is not that of the repository; link it"),
            );
        }
        problems
    }

    /// The README at the registry: the beginning of the crate's own documentation.
    fn readme(&self) -> Generated {
        let source = ["src/lib.rs", "src/main.rs"].map(|file| root().join(&self.folder).join(file));
        let source = source
            .iter()
            .find_map(|path| fs::read_to_string(path).ok())
            .expect("a crate root");
        let docs: Vec<_> = source
            .lines()
            .map_while(|line| line.strip_prefix("//!"))
            .map(|line| line.strip_prefix(' ').unwrap_or(line))
            .take_while(|line| !line.starts_with("```") && !line.starts_with('#'))
            .collect();
        let text = format!(
            "{NOTICE}# {}\n\n{}\n\nPart of standstill, a PLCopen motion runtime. Licensed under either of Apache \
             License 2.0 or MIT at your\noption. **Not a safety function.**\n",
            self.name,
            without_links(docs.join("\n").trim())
        );
        Generated {
            path: format!("{}/README.md", self.folder),
            text,
        }
    }
}

/// The README of every published package.
pub fn readmes() -> Vec<Generated> {
    Package::published().iter().map(Package::readme).collect()
}

fn between<'a>(text: &'a str, before: &str, after: &str) -> Option<&'a str> {
    Some(text.split_once(before)?.1.split_once(after)?.0)
}

/// The text without links of rustdoc, which lead nowhere outside of it.
fn without_links(text: &str) -> String {
    let mut out = String::new();
    let mut rest = text;
    while let Some((before, link)) = rest.split_once("[`") {
        out.push_str(before);
        let (word, behind) = link.split_once("`]").expect("a link ends");
        out.push_str(&format!("`{word}`"));
        rest = match behind.strip_prefix('(') {
            Some(target) => target.split_once(')').expect("a target ends").1,
            None => behind,
        };
    }
    out + rest
}

//! The book as a folder of pages: mdBook's output of `docs`, with the files outside of it that its pages
//! link to, and without dead links.

use crate::{files_below, root};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Component, Path, PathBuf};

/// Completes mdBook's output in `built`/docs; returns the faults of its links.
///
/// # Errors
/// A file that cannot be read or written.
pub fn complete(built: &Path) -> std::io::Result<Vec<String>> {
    for page in files_below(&built.join("docs"))? {
        // GitHub shows the README of a folder, mdBook names it index; links are written for the former.
        if page.ends_with("index.html") {
            let readme = page.with_file_name("README.md");
            let within = readme.strip_prefix(built).expect("below the book");
            if root().join(within).exists() {
                fs::copy(&page, page.with_file_name("README.html"))?;
            }
        }
    }
    let pages: Vec<_> = files_below(&built.join("docs"))?
        .into_iter()
        .filter(|path| path.extension().is_some_and(|found| found == "html"))
        // Its links are absolute, because it is shown for any address.
        .filter(|path| !path.ends_with("404.html"))
        .collect();
    let texts: BTreeMap<_, _> = pages
        .iter()
        .map(|page| fs::read_to_string(page).map(|text| (page.clone(), text)))
        .collect::<Result<_, _>>()?;
    let anchors: BTreeMap<_, BTreeSet<_>> = texts
        .iter()
        .map(|(page, text)| (page, values(text, " id=\"").collect()))
        .collect();
    let mut problems = BTreeSet::new();
    for (page, text) in &texts {
        for link in values(text, " href=\"").chain(values(text, " src=\"")) {
            if link.contains(':') || link.starts_with('/') {
                continue;
            }
            let (target, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = match target {
                "" => page.clone(),
                target => plain(&page.parent().expect("a folder").join(target)),
            };
            let mut problem = |what: &str| {
                let page = page.strip_prefix(built).unwrap_or(page);
                problems.insert(format!("{}: {link} {what}", page.display()));
            };
            if !target.is_file() {
                let source = target.strip_prefix(built).map(|within| root().join(within));
                match source {
                    Ok(source) if source.is_file() => {
                        fs::create_dir_all(target.parent().expect("a folder"))?;
                        fs::copy(source, &target)?;
                    }
                    // A folder of the repository, for browsing.
                    Ok(source) if source.is_dir() => fs::create_dir_all(&target)?,
                    _ => problem("leads nowhere"),
                }
            } else if !anchor.is_empty() && anchors.get(&target).is_some_and(|ids| !ids.contains(anchor)) {
                problem("is no place on its page");
            }
        }
    }
    Ok(problems.into_iter().collect())
}

/// The values behind `attribute`.
fn values<'a>(text: &'a str, attribute: &'a str) -> impl Iterator<Item = &'a str> {
    text.split(attribute)
        .skip(1)
        .filter_map(|rest| rest.split('"').next())
}

/// A path without `..` and `.`.
fn plain(path: &Path) -> PathBuf {
    let mut plain = PathBuf::new();
    for part in path.components() {
        match part {
            Component::ParentDir => {
                plain.pop();
            }
            Component::CurDir => {}
            part => plain.push(part),
        }
    }
    plain
}

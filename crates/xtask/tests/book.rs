//! The links of the pages: each leads to an existing file and heading, and every page is in the book.

use standstill_xtask::{files, root};
use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// The Markdown files of the repository and their text without fenced blocks.
fn pages() -> BTreeMap<PathBuf, String> {
    files()
        .into_iter()
        .filter(|path| path.extension().is_some_and(|found| found == "md"))
        .map(|path| {
            let text = fs::read_to_string(&path).unwrap();
            let mut fenced = false;
            let lines = text.lines().filter(|line| {
                let fence = line.starts_with("```");
                fenced ^= fence;
                !fenced && !fence
            });
            (path.canonicalize().unwrap(), lines.collect::<Vec<_>>().join("\n"))
        })
        .collect()
}

/// Targets of the links of a page.
fn links(text: &str) -> impl Iterator<Item = &str> {
    text.split("](")
        .skip(1)
        .filter_map(|rest| rest.split([')', ' ']).next())
}

/// The anchors of headings at GitHub and in the book; a second heading of the same words has `-1` behind it.
fn anchors(text: &str) -> BTreeSet<String> {
    let mut found = BTreeSet::new();
    for line in text.lines().filter(|line| line.starts_with('#')) {
        let heading = without_targets(line.trim_start_matches('#').trim());
        let kept = heading
            .chars()
            .filter(|letter| letter.is_alphanumeric() || " -_".contains(*letter));
        let slug: String = kept
            .map(|letter| {
                if letter == ' ' {
                    '-'
                } else {
                    letter.to_ascii_lowercase()
                }
            })
            .collect();
        let again = (1..).map(|number| format!("{slug}-{number}"));
        let new = std::iter::once(slug.clone())
            .chain(again)
            .find(|name| !found.contains(name));
        found.insert(new.unwrap());
    }
    found
}

fn without_targets(heading: &str) -> String {
    let mut parts = heading.split("](");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| {
        text + part.split_once(')').map_or("", |(_, rest)| rest)
    })
}

#[test]
fn links_lead_to_a_file_and_a_heading() {
    let pages = pages();
    for (path, text) in &pages {
        for link in links(text).filter(|link| !link.contains("://")) {
            let (target, anchor) = link.split_once('#').unwrap_or((link, ""));
            let target = match target {
                "" => path.clone(),
                target => path.parent().unwrap().join(target),
            };
            assert!(target.exists(), "{}: dead link {link}", path.display());
            // It is the book's list of pages, and not a page of it.
            assert!(!target.ends_with("SUMMARY.md"), "{}: {link}", path.display());
            let page = pages.get(&target.canonicalize().unwrap());
            if let (false, Some(page)) = (anchor.is_empty(), page) {
                let anchors = anchors(page);
                assert!(
                    anchors.contains(anchor),
                    "{}: {link} names no heading; there are {anchors:?}",
                    path.display()
                );
            }
        }
    }
}

#[test]
fn every_page_stands_in_the_book_once() {
    let docs = root().join("docs").canonicalize().unwrap();
    let summary = fs::read_to_string(docs.join("SUMMARY.md")).unwrap();
    let listed: Vec<_> = links(&summary).map(|link| docs.join(link)).collect();
    for path in pages().keys().filter(|path| path.starts_with(&docs)) {
        let times = listed.iter().filter(|&listed| listed == path).count();
        let expected = usize::from(!path.ends_with("SUMMARY.md"));
        assert_eq!(times, expected, "{} in docs/SUMMARY.md", path.display());
    }
    let gone: Vec<_> = listed.iter().filter(|path| !path.exists()).collect();
    assert!(gone.is_empty(), "docs/SUMMARY.md lists {gone:?}");
}

#[test]
fn scripts_that_pages_name_exist() {
    let mut count = 0;
    for path in files()
        .iter()
        .filter(|path| path.extension().is_some_and(|found| found == "md"))
    {
        let text = fs::read_to_string(path).unwrap();
        for named in text
            .split_whitespace()
            .filter(|word| word.starts_with("scan-tests/") && word.ends_with(".json"))
        {
            assert!(
                root().join(named).exists(),
                "{}: {named} is not there",
                path.display()
            );
            count += 1;
        }
    }
    assert!(count > 50, "only {count} found");
}

#[test]
fn every_script_of_the_gallery_has_its_page_and_its_picture() {
    let gallery = root().join("docs/gallery");
    let index = fs::read_to_string(gallery.join("README.md")).unwrap();
    let mut count = 0;
    for path in files() {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let in_gallery = path
            .parent()
            .is_some_and(|folder| folder.ends_with(Path::new("scan-tests/gallery")));
        if let (true, Some(name)) = (in_gallery, name.strip_suffix(".scan.json")) {
            let page = fs::read_to_string(gallery.join(format!("{name}.md"))).unwrap_or_default();
            assert!(
                page.contains(&format!("]({name}.svg)")),
                "docs/gallery/{name}.md shows no {name}.svg"
            );
            assert!(
                gallery.join(format!("{name}.svg")).exists(),
                "{name} has no line in pictures.txt"
            );
            assert!(
                index.contains(&format!("]({name}.md)")),
                "docs/gallery/README.md does not list {name}"
            );
            count += 1;
        }
    }
    assert!(count >= 10, "{count} tasks");
}

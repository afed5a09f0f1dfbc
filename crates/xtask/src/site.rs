//! The book and the playground side by side: pages of the book open their script in the playground.

use crate::files_below;
use std::fs;
use std::path::Path;

/// The folders of pages about scripts, and the folders of the scripts: `scan-tests/` and this.
const FOLDERS: [&str; 2] = ["gallery", "tutorial"];

/// Adds links into the playground to the pages of the book in `site`/docs that describe a script; returns
/// their number.
///
/// A page links to `scan-tests/FOLDER/NAME.scan.json`: behind that link comes one to `playground/?gallery=NAME`.
///
/// # Errors
/// A file that cannot be read or written.
pub fn link(site: &Path) -> std::io::Result<usize> {
    let docs = site.join("docs");
    let mut links = 0;
    for page in files_below(&docs)? {
        if page.extension().is_none_or(|found| found != "html") {
            continue;
        }
        let within = page.strip_prefix(&docs).expect("below the book");
        let up = "../".repeat(within.components().count());
        let text = fs::read_to_string(&page)?;
        let (linked, found) = with_links(&text, &up);
        let (linked, more) = match within.to_str() {
            Some("tutorial.html") => with_names(&linked, &up),
            _ => (linked, 0),
        };
        let found = found + more;
        if found > 0 {
            fs::write(&page, linked)?;
            links += found;
        }
    }
    Ok(links)
}

/// The text of a page with its links, and the number added. `up` leads from the page to the site.
fn with_links(text: &str, up: &str) -> (String, usize) {
    let mut linked = String::new();
    let mut rest = text;
    let mut links = 0;
    while let Some((before, after)) = rest.split_once("</a>") {
        linked.push_str(before);
        linked.push_str("</a>");
        let href = before.rfind("<a href=\"").map(|at| &before[at + 9..]);
        let target = href.and_then(|rest| rest.split('"').next()).unwrap_or_default();
        if let Some(name) = script(target) {
            linked.push_str(&format!(
                " (<a href=\"{up}playground/?gallery={name}\">open it in the playground</a>)"
            ));
            links += 1;
        }
        rest = after;
    }
    linked.push_str(rest);
    (linked, links)
}

/// The text of the tutorial with a link where it first names each of its scripts.
fn with_names(text: &str, up: &str) -> (String, usize) {
    let mut linked = text.to_owned();
    let mut links = 0;
    for name in ["slide", "abort"] {
        let named = format!("<code>{name}.scan.json</code>");
        if linked.contains(&named) {
            let link =
                format!("{named} (<a href=\"{up}playground/?gallery={name}\">open it in the playground</a>)");
            linked = linked.replacen(&named, &link, 1);
            links += 1;
        }
    }
    (linked, links)
}

/// The name by which the playground knows the script that a link leads to.
fn script(target: &str) -> Option<&str> {
    let (_, path) = target.split_once("scan-tests/")?;
    let (folder, file) = path.split_once('/')?;
    let name = file.strip_suffix(".scan.json")?;
    (FOLDERS.contains(&folder) && !name.contains('/')).then_some(name)
}

/// Links of pages in `site`/docs into the playground that lead nowhere.
///
/// # Errors
/// A file that cannot be read.
pub fn problems(site: &Path) -> std::io::Result<Vec<String>> {
    let mut problems = Vec::new();
    for needed in [
        "index.html",
        "playground.js",
        "playground.wasm",
        "guests.wasm",
        "schema.json",
    ] {
        if !site.join("playground").join(needed).is_file() {
            problems.push(format!("playground/{needed} is not there"));
        }
    }
    let scripts = fs::read_to_string(site.join("playground/scripts.json"))?;
    let scripts: serde_json::Value = serde_json::from_str(&scripts)?;
    let known = |name: &str| {
        let mut all = scripts.as_array().into_iter().flatten();
        all.any(|group| {
            let scripts = group["scripts"].as_array();
            scripts.into_iter().flatten().any(|script| script["name"] == name)
        })
    };
    for page in files_below(&site.join("docs"))? {
        if page.extension().is_none_or(|found| found != "html") {
            continue;
        }
        let text = fs::read_to_string(&page)?;
        for rest in text.split("playground/?gallery=").skip(1) {
            let name = rest.split(['"', '<', '&', '#']).next().unwrap_or_default();
            if !known(name) {
                problems.push(format!("{}: the playground has no script {name}", page.display()));
            }
        }
    }
    Ok(problems)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_link_to_a_script_gets_one_into_the_playground() {
        let page = "<p><a href=\"../../scan-tests/gallery/press.scan.json\">The script</a>; <a href=\"x.html\">x</a></p>";
        let (linked, links) = with_links(page, "../../");
        assert_eq!(links, 1);
        assert!(linked.contains(
            "</a> (<a href=\"../../playground/?gallery=press\">open it in the playground</a>); <a"
        ));
        assert_eq!(
            with_links("<a href=\"../scan-tests/gallery/packer/packer.st\">p</a>", "").1,
            0
        );
        assert_eq!(
            with_links("<a href=\"../scan-tests/mc_stop/stop.scan.json\">p</a>", "").1,
            0
        );
    }
}

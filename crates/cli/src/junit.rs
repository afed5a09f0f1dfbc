//! The outcome of `standstill test` as JUnit XML, the form that GitHub, GitLab and Jenkins read.
//!
//! One suite for each folder, one case for each script. Names and texts come from files, so all of them are
//! escaped. Characters that XML 1.0 cannot have, such as control characters, become U+FFFD.

use crate::exit::Failure;
use standstill_picture::escaped;
use standstill_trace::file::replace;
use std::fmt::Write;
use std::path::Path;
use std::time::Duration;

/// How a case ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// It passed.
    Passed,
    /// A claim or the golden failed.
    Failed,
    /// It could not be judged.
    Broken,
}

/// One script, judged.
#[derive(Clone, Debug)]
pub struct Case {
    /// Path of the script, with `/`.
    pub file: String,
    /// How it ended.
    pub ending: Ending,
    /// The message; empty if it passed.
    pub text: String,
    /// Its duration.
    pub took: Duration,
}

impl Case {
    /// Folder and name; a script without folder is in `.`.
    fn place(&self) -> (&str, &str) {
        let (folder, name) = self.file.rsplit_once('/').unwrap_or((".", &self.file));
        (
            folder,
            name.strip_suffix(standstill_script::suite::EXTENSION)
                .unwrap_or(name),
        )
    }
}

/// Writes the cases to this file, whole or not at all.
pub fn save(cases: &[Case], path: &Path) -> Result<(), Failure> {
    let text = xml(cases);
    Ok(replace(path, |out| out.write_all(text.as_bytes()))?)
}

/// The document.
fn xml(cases: &[Case]) -> String {
    let mut suites: Vec<(&str, Vec<&Case>)> = Vec::new();
    for case in cases {
        let (folder, _) = case.place();
        match suites.iter_mut().find(|(name, _)| *name == folder) {
            Some((_, members)) => members.push(case),
            None => suites.push((folder, vec![case])),
        }
    }
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    let all: Vec<&Case> = cases.iter().collect();
    // Writing to a String cannot fail, here and below.
    let _ = writeln!(out, "<testsuites name=\"standstill\" {}>", counts(&all));
    for (folder, members) in &suites {
        let _ = writeln!(
            out,
            "  <testsuite name=\"{}\" {}>",
            attribute(folder),
            counts(members)
        );
        for case in members {
            write_case(&mut out, case);
        }
        out.push_str("  </testsuite>\n");
    }
    out.push_str("</testsuites>\n");
    out
}

fn counts(cases: &[&Case]) -> String {
    let of = |ending| cases.iter().filter(|case| case.ending == ending).count();
    let took: Duration = cases.iter().map(|case| case.took).sum();
    format!(
        "tests=\"{}\" failures=\"{}\" errors=\"{}\" skipped=\"0\" time=\"{}\"",
        cases.len(),
        of(Ending::Failed),
        of(Ending::Broken),
        seconds(took)
    )
}

fn write_case(out: &mut String, case: &Case) {
    let (folder, name) = case.place();
    let _ = write!(
        out,
        "    <testcase classname=\"{}\" name=\"{}\" file=\"{}\" time=\"{}\"",
        // Jenkins makes packages of the parts between dots.
        attribute(&folder.replace('/', ".")),
        attribute(name),
        attribute(&case.file),
        seconds(case.took)
    );
    let (element, kind) = match case.ending {
        Ending::Passed => return out.push_str("/>\n"),
        Ending::Failed => ("failure", "failed"),
        Ending::Broken => ("error", "broken"),
    };
    let mut first = case.text.lines().next().unwrap_or_default().to_owned();
    // The text that a reader shows in its list.
    if let Some(why) = case.text.lines().skip_while(|line| *line != "why").nth(1) {
        first = format!("{first}; why: {}", why.trim());
    }
    let _ = writeln!(
        out,
        ">\n      <{element} type=\"{kind}\" message=\"{}\">{}</{element}>\n    </testcase>",
        attribute(&first),
        escaped(&case.text)
    );
}

/// To the millisecond, as the readers show it.
fn seconds(time: Duration) -> String {
    format!("{:.3}", time.as_secs_f64())
}

/// Text in the form of a quoted attribute.
fn attribute(text: &str) -> String {
    // A reader would change a line end to a space.
    escaped(text).replace('\n', "&#10;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use roxmltree::{Document, Node};

    /// Text that would be markup, or is no XML at all.
    const NASTY: &str = "a<b>&\"'\t\r]]><![CDATA[ \u{1b}[2J\u{0}\u{ffff} größer";

    fn case(file: &str, ending: Ending, text: &str) -> Case {
        Case {
            file: file.to_owned(),
            ending,
            text: text.to_owned(),
            took: Duration::from_millis(1500),
        }
    }

    fn attributes<'a>(node: Node<'a, '_>, names: &[&str]) -> Vec<&'a str> {
        let value = |name: &&str| node.attribute(*name).unwrap_or("absent");
        names.iter().map(value).collect()
    }

    #[test]
    fn a_reader_finds_suites_cases_and_their_texts() {
        let text = xml(&[
            case("t/a/one.scan.json", Ending::Passed, ""),
            case("t/two.scan.json", Ending::Failed, "first line\nsecond line"),
            case("t/a/three.scan.json", Ending::Broken, "error: no"),
            case("four.json", Ending::Passed, ""),
        ]);
        let document = Document::parse(&text).unwrap();
        let root = document.root_element();
        let counts = ["name", "tests", "failures", "errors", "skipped", "time"];
        assert_eq!(
            attributes(root, &counts),
            ["standstill", "4", "1", "1", "0", "6.000"]
        );
        let suites: Vec<_> = root.children().filter(Node::is_element).collect();
        let told: Vec<_> = suites.iter().map(|suite| attributes(*suite, &counts)).collect();
        assert_eq!(
            told,
            [
                ["t/a", "2", "0", "1", "0", "3.000"],
                ["t", "1", "1", "0", "0", "1.500"],
                [".", "1", "0", "0", "0", "1.500"],
            ]
        );
        let cases: Vec<_> = root
            .descendants()
            .filter(|node| node.has_tag_name("testcase"))
            .map(|node| attributes(node, &["classname", "name", "file"]))
            .collect();
        assert_eq!(
            cases,
            [
                ["t.a", "one", "t/a/one.scan.json"],
                ["t.a", "three", "t/a/three.scan.json"],
                ["t", "two", "t/two.scan.json"],
                [".", "four.json", "four.json"],
            ]
        );
        let endings: Vec<_> = root
            .descendants()
            .filter(|node| node.has_tag_name("failure") || node.has_tag_name("error"))
            .map(|node| {
                (
                    node.tag_name().name(),
                    node.attribute("message").unwrap(),
                    node.text().unwrap(),
                )
            })
            .collect();
        assert_eq!(
            endings,
            [
                ("error", "error: no", "error: no"),
                ("failure", "first line", "first line\nsecond line")
            ]
        );
    }

    #[test]
    fn texts_stay_texts() {
        let text = xml(&[case(&format!("{NASTY}\n/{NASTY}"), Ending::Failed, NASTY)]);
        let document = Document::parse(&text).unwrap();
        let as_read = NASTY.replace(['\u{1b}', '\u{0}', '\u{ffff}'], "\u{fffd}");
        let find = |name| {
            document
                .descendants()
                .find(|node: &Node<'_, '_>| node.has_tag_name(name))
                .unwrap()
        };
        assert_eq!(
            find("testsuite").attribute("name"),
            Some(format!("{as_read}\n").as_str())
        );
        assert_eq!(find("testcase").attribute("name"), Some(as_read.as_str()));
        assert_eq!(find("failure").text(), Some(as_read.as_str()));
        assert_eq!(document.descendants().filter(Node::is_element).count(), 4);
    }

    #[test]
    fn no_cases_are_a_document_too() {
        let text = xml(&[]);
        assert_eq!(
            Document::parse(&text).unwrap().root_element().attribute("tests"),
            Some("0")
        );
    }
}

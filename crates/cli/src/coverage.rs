//! The statements and branches of Structured Text that scripts execute: as an LCOV file, on the terminal,
//! and as a page.

use crate::exit::Failure;
use standstill_script::run::Counted;
use standstill_script::suite::{self, Allowed};
use standstill_trace::file::{replace, replace_beside};
use standstill_trace::printable;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Counts of one file: by the line and column of a statement and the number of its branch, which is 0 for itself.
type Counts = BTreeMap<(u32, u32, u32), u64>;

/// The execution counts of a run's scripts.
#[derive(Debug, Default)]
pub struct Coverage {
    files: BTreeMap<String, Counts>,
}

/// The number of items, and the number executed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Share {
    hit: usize,
    of: usize,
}

impl Coverage {
    /// Runs the scripts once more, counting.
    pub fn of(scripts: &[PathBuf], allowed: &Allowed) -> Self {
        let mut coverage = Self::default();
        for script in scripts {
            // The reason why a script cannot be read or run was reported when it was judged.
            if let Ok(Some(counts)) = suite::coverage(script, allowed) {
                coverage.add(&counts);
            }
        }
        coverage
    }

    fn add(&mut self, counts: &[Counted]) {
        for it in counts {
            let file = self.files.entry(plain(&it.file)).or_default();
            *file.entry((it.line, it.column, it.branch)).or_default() += it.count;
        }
    }

    /// Writes the file, and prints the items that were not executed and the share of those that were.
    pub fn save(&self, path: &Path) -> Result<String, Failure> {
        let text = self.lcov();
        replace(path, |out| out.write_all(text.as_bytes()))?;
        let missed = self
            .files
            .iter()
            .filter_map(|(file, counts)| missed(file, counts));
        let mut lines: Vec<String> = missed.collect();
        if let Some(more @ 1..) = lines.len().checked_sub(FILES_TOLD) {
            lines.truncate(FILES_TOLD);
            lines.push(format!("  and {more} files more"));
        }
        lines.push(self.total(path));
        Ok(lines.join("\n"))
    }

    fn total(&self, path: &Path) -> String {
        let all = || self.files.values().flatten();
        let statements = share(all().filter(|((.., branch), _)| *branch == 0));
        let branches = share(all().filter(|((.., branch), _)| *branch > 0));
        format!(
            "coverage: {statements} statements, {branches} branches: {}",
            suite::shown(path)
        )
    }

    /// The sources with their counts as a separate page; returns its path.
    pub fn page(&self, folder: &Path) -> Result<String, Failure> {
        let path = folder.join("coverage.html");
        let files = self.files.iter().map(|(file, counts)| {
            // The text was compiled a moment ago, so it is UTF-8. A file that no longer exists is shown by its
            // numbers only.
            let text = std::fs::read_to_string(file).unwrap_or_default();
            table(file, &text, counts)
        });
        let body: String = files.collect();
        let page = PAGE
            .replace("{version}", env!("CARGO_PKG_VERSION"))
            .replace("{files}", &body);
        replace_beside(&path, |out| out.write_all(page.as_bytes()))?;
        Ok(suite::shown(&path))
    }

    /// The LCOV format, as `geninfo` documents it: a record for each file; a line counts as often as its most
    /// executed statement.
    fn lcov(&self) -> String {
        let mut out = String::new();
        for (file, counts) in &self.files {
            let mut lines: BTreeMap<u32, u64> = BTreeMap::new();
            // Writing to text cannot fail.
            let _written = writeln!(out, "TN:\nSF:{file}");
            let mut arms = Vec::new();
            let mut block = 0;
            for ((line, _, branch), count) in counts {
                if *branch == 0 {
                    let most = lines.entry(*line).or_default();
                    *most = (*most).max(*count);
                    block += 1;
                } else {
                    arms.push(*count);
                    let _written = writeln!(out, "BRDA:{line},{block},{},{count}", branch - 1);
                }
            }
            let hit = arms.iter().filter(|count| **count > 0).count();
            let _written = writeln!(out, "BRF:{}\nBRH:{hit}", arms.len());
            for (line, count) in &lines {
                let _written = writeln!(out, "DA:{line},{count}");
            }
            let hit = lines.values().filter(|count| **count > 0).count();
            let _written = writeln!(out, "LF:{}\nLH:{hit}\nend_of_record", lines.len());
        }
        out
    }
}

/// Largest number of files whose missing lines the terminal shows.
const FILES_TOLD: usize = 20;

/// Largest number of lines of a file that the terminal names.
const LINES_TOLD: usize = 12;

/// The page around the files; it loads nothing.
const PAGE: &str = r#"<!doctype html>
<html lang="en">
<meta charset="utf-8">
<meta http-equiv="Content-Security-Policy" content="default-src 'none'; style-src 'unsafe-inline'">
<title>Coverage</title>
<style>
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem; color: #222; background: #fff }
table { border-collapse: collapse; font: 13px/1.5 ui-monospace, monospace }
td { padding: 0 .6rem; white-space: pre; tab-size: 4 }
td.n { text-align: right; color: #666 }
tr.no td { background: #fde2e2 }
tr.part td { background: #fff3cd }
tr.yes td.n { color: #14692f }
@media (prefers-color-scheme: dark) {
  body { color: #ddd; background: #181818 } tr.no td { background: #5a2323 } tr.part td { background: #57480f }
  td.n { color: #999 } tr.yes td.n { color: #7ed99a }
}
</style>
<h1>Coverage</h1>
<p>How often the scripts executed the first statement of each line. A red line has a statement that no script executed, a yellow one
a branch that none took. standstill {version}.</p>
{files}
</html>
"#;

/// Lines with a statement that was not executed, and those with a branch that was not taken.
fn open_lines(counts: &Counts) -> (BTreeSet<u32>, BTreeSet<u32>) {
    let mut statements = BTreeSet::new();
    let mut branches = BTreeSet::new();
    for ((line, column, branch), count) in counts {
        if *count > 0 {
            continue;
        }
        // A statement that was not executed has no branch taken either.
        let ran = counts.get(&(*line, *column, 0)).is_some_and(|count| *count > 0);
        match branch {
            0 => drop(statements.insert(*line)),
            _ if ran => drop(branches.insert(*line)),
            _ => {}
        }
    }
    (statements, branches)
}

/// The lines of a file that were not executed, as one line of text; `None` if there are none.
fn missed(file: &str, counts: &Counts) -> Option<String> {
    let (statements, branches) = open_lines(counts);
    let mut parts = Vec::new();
    for (lines, one, several) in [
        (statements, "not executed: line", "not executed: lines"),
        (branches, "a branch not taken: line", "branches not taken: lines"),
    ] {
        match lines.len() {
            0 => {}
            1 => parts.push(format!("{one} {}", ranges(&lines))),
            _ => parts.push(format!("{several} {}", ranges(&lines))),
        }
    }
    (!parts.is_empty()).then(|| format!("  {file}: {}", parts.join("; ")))
}

/// `3, 7 to 9 and 4 more`
fn ranges(lines: &BTreeSet<u32>) -> String {
    let mut ranges: Vec<(u32, u32)> = Vec::new();
    for line in lines {
        match ranges.last_mut() {
            Some((_, last)) if *last + 1 == *line => *last = *line,
            _ => ranges.push((*line, *line)),
        }
    }
    let shown = ranges
        .iter()
        .take(LINES_TOLD)
        .map(|(first, last)| match last - first {
            0 => first.to_string(),
            1 => format!("{first}, {last}"),
            _ => format!("{first} to {last}"),
        });
    let shown: Vec<_> = shown.collect();
    match ranges.len().checked_sub(LINES_TOLD) {
        Some(more @ 1..) => format!("{} and {more} more", shown.join(", ")),
        _ => shown.join(", "),
    }
}

/// A file with the counts of its lines.
fn table(file: &str, text: &str, counts: &Counts) -> String {
    let statements = share(counts.iter().filter(|((.., branch), _)| *branch == 0));
    let branches = share(counts.iter().filter(|((.., branch), _)| *branch > 0));
    let (open, untaken) = open_lines(counts);
    let mut out = String::new();
    // Writing to text cannot fail.
    let _written = writeln!(
        out,
        "<h2>{}</h2>\n<p>{statements} statements, {branches} branches</p>\n<table>",
        escaped(file)
    );
    for (line, number) in text.lines().zip(1..) {
        let first = counts.range((number, 0, 0)..(number + 1, 0, 0)).next();
        let (class, count) = match first {
            None => ("", String::new()),
            Some((_, count)) => {
                let class = match (open.contains(&number), untaken.contains(&number)) {
                    (true, _) => "no",
                    (false, true) => "part",
                    (false, false) => "yes",
                };
                (class, count.to_string())
            }
        };
        let line = escaped(line.trim_start_matches('\u{FEFF}'));
        let _written = writeln!(
            out,
            "<tr class=\"{class}\"><td class=\"n\">{number}</td><td class=\"n\">{count}</td><td>{line}</td></tr>"
        );
    }
    out.push_str("</table>\n");
    out
}

fn escaped(text: &str) -> String {
    let pieces: Vec<_> = text.split('\t').map(printable).collect();
    let mut out = String::new();
    for c in pieces.join("\t").chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            c => out.push(c),
        }
    }
    out
}

fn share<'a>(counts: impl Iterator<Item = (&'a (u32, u32, u32), &'a u64)>) -> Share {
    counts.fold(Share::default(), |share, (_, count)| Share {
        hit: share.hit + usize::from(*count > 0),
        of: share.of + 1,
    })
}

impl std::fmt::Display for Share {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        // Rounded down, so that 100 % means all.
        let thousandths = (self.hit * 1000).checked_div(self.of).unwrap_or(1000);
        let (whole, tenth) = (thousandths / 10, thousandths % 10);
        write!(out, "{} of {} ({whole}.{tenth} %)", self.hit, self.of)
    }
}

/// A path without `folder/..`, so that one file under two names counts once.
fn plain(path: &str) -> String {
    let mut parts: Vec<&str> = Vec::new();
    for part in path.split('/') {
        match (part, parts.last()) {
            (".", _) => {}
            ("..", Some(last)) if *last != ".." && !last.is_empty() => drop(parts.pop()),
            _ => parts.push(part),
        }
    }
    parts.join("/")
}

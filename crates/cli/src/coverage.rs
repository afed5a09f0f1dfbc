//! Which statements and branches of Structured Text scripts execute, as an LCOV file.

use crate::exit::Failure;
use standstill_script::run::Counted;
use standstill_script::suite::{self, Allowed};
use standstill_trace::file::replace;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Counts of one file: by the line and column of a statement and the number of its branch, which is 0 for itself.
type Counts = BTreeMap<(u32, u32, u32), u64>;

/// What the scripts of a run executed.
#[derive(Debug, Default)]
pub struct Coverage {
    files: BTreeMap<String, Counts>,
}

/// How many there are, and how many of them were executed.
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
            // Why a script cannot be read or run was told when it was judged.
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

    /// Writes the file, and says what share was executed.
    pub fn save(&self, path: &Path) -> Result<String, Failure> {
        let text = self.lcov();
        replace(path, |out| out.write_all(text.as_bytes()))?;
        let all = || self.files.values().flatten();
        let statements = share(all().filter(|((.., branch), _)| *branch == 0));
        let branches = share(all().filter(|((.., branch), _)| *branch > 0));
        Ok(format!(
            "coverage: {statements} statements, {branches} branches: {}",
            suite::shown(path)
        ))
    }

    /// As `geninfo` of LCOV documents it: a record a file, a line counts as often as its most executed statement.
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

/// A path without `folder/..`, so that a file that two folders name is one.
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

//! Timing pictures of scan scripts, as `crates/xtask/pictures.txt` lists them.

use crate::{Generated, read, root};
use standstill_blocks::REGISTRY;
use standstill_picture::{report, svg};
use standstill_script::{read_with_programs, run};
use standstill_trace::Trace;
use std::collections::BTreeMap;
use std::fs;

/// The default signals of an axis in pictures, beside its states and the Booleans.
const SIGNALS: &str = "Position,Velocity";

/// The signals of a picture with the contents of a report: all of them, and the claims.
const REPORT: &str = "report";

/// A line of the list.
#[derive(Debug)]
pub struct Picture {
    /// A block, or a name.
    pub name: String,
    /// The signals it shows of each axis.
    signals: Vec<String>,
    /// The script, relative to the repository root.
    pub script: String,
    /// Title of the script.
    pub title: String,
    trace: Trace,
}

impl Picture {
    /// The path of the picture, relative to the repository root.
    pub fn path(&self) -> String {
        let name = self.name.to_lowercase();
        if name.contains('/') {
            format!("docs/{name}.svg")
        } else if REGISTRY.iter().any(|info| info.name == self.name) {
            format!("docs/blocks/{name}.svg")
        } else {
            format!("docs/pictures/{name}.svg")
        }
    }

    /// The trace that is drawn.
    #[cfg(test)]
    pub const fn trace(&self) -> &Trace {
        &self.trace
    }

    /// The drawn picture.
    pub fn drawn(&self) -> Generated {
        Generated {
            path: self.path(),
            text: match &self.signals.iter().map(String::as_str).collect::<Vec<_>>()[..] {
                [REPORT] => report(&self.trace),
                signals => svg(&self.trace, signals),
            },
        }
    }
}

/// Every picture by its name; each script is run. Panics, naming the line, if a script does not run.
pub fn pictures() -> BTreeMap<String, Picture> {
    read("crates/xtask/pictures.txt")
        .lines()
        .filter(|line| !line.starts_with('#'))
        .filter_map(|line| line.split_once(' '))
        .map(|(name, rest)| {
            let (script, signals) = rest.split_once(' ').unwrap_or((rest, SIGNALS));
            (name.to_owned(), picture(name, script, signals))
        })
        .collect()
}

fn picture(name: &str, script: &str, signals: &str) -> Picture {
    let path = format!("scan-tests/{script}.scan.json");
    let text = read(&path);
    let folder = root().join(&path);
    let mut machine = |_: &str| Err("a picture is of a script without machine files".to_owned());
    let mut program = |inner: &str| {
        let bytes = fs::read(folder.with_file_name(inner));
        bytes.map_err(|error| error.to_string())
    };
    let script = read_with_programs(&text, &path, &[], &mut machine, &mut program)
        .unwrap_or_else(|error| panic!("{error}"));
    let trace = run(&script)
        .unwrap_or_else(|error| panic!("{path}: {error}"))
        .trace;
    Picture {
        name: name.into(),
        signals: signals.split(',').map(str::to_owned).collect(),
        script: path,
        title: trace.header().title.clone(),
        trace,
    }
}

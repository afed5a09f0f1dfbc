//! The standard's catalogue, from the text files in `crates/xtask/standard`.

use crate::read;
use standstill_fb::Direction;

/// A pin of the standard.
#[derive(Clone, Debug)]
pub struct StandardPin {
    pub kind: Direction,
    /// Basic: a block that is offered must have it; otherwise extended.
    pub basic: bool,
    pub name: String,
    pub ty: String,
}

/// A function block of the standard.
#[derive(Clone, Debug)]
pub struct StandardBlock {
    pub name: String,
    /// In_outs, inputs, outputs.
    pub pins: Vec<StandardPin>,
}

/// A parameter number of the standard.
#[derive(Clone, Debug)]
pub struct Parameter {
    pub number: u16,
    pub name: String,
    pub is_bool: bool,
    pub basic: bool,
    pub writable: bool,
}

/// A comment of ours.
#[derive(Clone, Debug)]
pub struct Remark {
    /// Whether it removes the subject from the supported part.
    pub refuses: bool,
    pub subject: String,
    pub text: String,
}

/// The whole catalogue, and our comments on it.
#[derive(Clone, Debug)]
pub struct Standard {
    pub single_axis: Vec<StandardBlock>,
    pub multi_axis: Vec<StandardBlock>,
    pub elementary: Vec<String>,
    pub derived: Vec<String>,
    pub parameters: Vec<Parameter>,
    pub remarks: Vec<Remark>,
}

impl Standard {
    /// Reads the files. Panics on a line in a wrong form, naming the file and the line.
    pub fn read() -> Self {
        let types = lines("types");
        let types_of = |class: &str| {
            let lines = types.iter().filter_map(|line| line.strip_prefix(class));
            lines.flat_map(str::split_whitespace).map(Into::into).collect()
        };
        Self {
            single_axis: blocks(&lines("single_axis")),
            multi_axis: blocks(&lines("multi_axis")),
            elementary: types_of("elementary "),
            derived: types_of("derived "),
            parameters: lines("parameters").iter().map(|line| parameter(line)).collect(),
            remarks: lines("remarks").iter().map(|line| remark(line)).collect(),
        }
    }

    /// Every block, single-axis blocks first.
    pub fn blocks(&self) -> impl Iterator<Item = &StandardBlock> {
        self.single_axis.iter().chain(&self.multi_axis)
    }

    /// Comment on a pin of a block, or on that pin of every block.
    pub fn remark_on_pin(&self, block: &str, pin: &str) -> Option<&Remark> {
        self.remark(&format!("{block}.{pin}"))
            .or_else(|| self.remark(&format!("*.{pin}")))
    }

    /// Comment on a block, a type or a parameter.
    pub fn remark(&self, subject: &str) -> Option<&Remark> {
        self.remarks.iter().find(|remark| remark.subject == subject)
    }

    /// Whether a comment on this subject can be shown.
    pub fn knows(&self, subject: &str) -> bool {
        let (block, pin) = subject.split_once('.').unwrap_or((subject, ""));
        let is_pin = self
            .blocks()
            .filter(|known| block == "*" || known.name == block)
            .any(|known| pin.is_empty() || known.pins.iter().any(|known| known.name == pin));
        is_pin
            || self.derived.iter().any(|name| name == subject)
            || self.parameters.iter().any(|known| known.name == subject)
    }
}

/// The lines of a file, without comments and empty ones.
fn lines(name: &str) -> Vec<String> {
    read(&format!("crates/xtask/standard/{name}.txt"))
        .lines()
        .filter(|line| !line.is_empty() && !line.starts_with('#'))
        .map(Into::into)
        .collect()
}

/// A line without indent names a block; those below it list pins of one kind each.
fn blocks(lines: &[String]) -> Vec<StandardBlock> {
    let mut blocks: Vec<StandardBlock> = Vec::new();
    for line in lines {
        match (line.strip_prefix("  "), blocks.last_mut()) {
            (Some(rest), Some(block)) => block.pins.extend(pins(rest)),
            _ => blocks.push(StandardBlock {
                name: line.clone(),
                pins: Vec::new(),
            }),
        }
    }
    blocks
}

fn pins(line: &str) -> Vec<StandardPin> {
    let (kind, rest) = line.split_once(' ').unwrap_or((line, ""));
    let kind = match kind {
        "in_out" => Direction::InOut,
        "input" => Direction::Input,
        "output" => Direction::Output,
        _ => panic!("crates/xtask/standard: `{line}` begins neither with in_out nor input nor output"),
    };
    rest.split(", ")
        .map(|pin| match pin.split(' ').collect::<Vec<_>>()[..] {
            [mark @ ("B" | "E"), name, ty] => StandardPin {
                kind,
                basic: mark == "B",
                name: name.into(),
                ty: ty.into(),
            },
            _ => panic!("crates/xtask/standard: `{pin}` is not B or E, a name and a type"),
        })
        .collect()
}

fn parameter(line: &str) -> Parameter {
    match line.split(' ').collect::<Vec<_>>()[..] {
        [
            number,
            name,
            ty @ ("REAL" | "BOOL"),
            mark @ ("B" | "E"),
            access @ ("R" | "RW"),
        ] => Parameter {
            number: number
                .parse()
                .unwrap_or_else(|_| panic!("parameters.txt: {number} is no number")),
            name: name.into(),
            is_bool: ty == "BOOL",
            basic: mark == "B",
            writable: access == "RW",
        },
        _ => panic!("parameters.txt: `{line}` is not a number, a name, a type, a mark and an access"),
    }
}

fn remark(line: &str) -> Remark {
    let (refuses, rest) = match line.strip_prefix("not ") {
        Some(rest) => (true, rest),
        None => (false, line),
    };
    let (subject, text) = rest
        .split_once(' ')
        .unwrap_or_else(|| panic!("remarks.txt: `{line}` has no comment"));
    Remark {
        refuses,
        subject: subject.into(),
        text: text.into(),
    }
}

//! Bad scripts: a good one with one piece replaced.

/// A good script.
pub const GOOD: &str = r#"{
  "standstill": 1,
  "cycle": "T#2ms",
  "scans": 100,
  "axes": {
    "X": {"limits": {"velocity": 50, "acceleration": 200}, "state": "Standstill"}
  },
  "inputs": {"GO": false, "speed": 10},
  "blocks": [
    {"name": "m", "type": "MC_MoveAbsolute", "pins": {"Axis": "X", "Execute": {"from": "GO"}}},
    {"name": "n", "type": "MC_MoveAbsolute", "pins": {"Axis": "X", "Execute": false}}
  ],
  "steps": [
    {"at": 1, "set": {"GO": true}}
  ],
  "expect": [
    {"at": 2, "that": {"m.Busy": true}}
  ]
}
"#;

/// Who refuses it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum By {
    /// It is no JSON, so no schema ever sees it.
    Syntax,
    /// The schema too.
    Schema,
    /// Only the reader: a schema cannot say it.
    Reader,
}

/// One bad script.
pub struct Case {
    /// The code of its only error.
    pub code: &'static str,
    /// Who refuses it.
    pub by: By,
    /// What it tries.
    pub title: &'static str,
    /// Pieces of the good script, and what stands there instead.
    pieces: Vec<(String, String)>,
}

impl Case {
    /// Its text; every piece is replaced once.
    pub fn text(&self, good: &str) -> String {
        self.pieces.iter().fold(good.to_owned(), |text, (old, new)| {
            let old = if old == "(all)" { good } else { old };
            assert!(text.contains(old), "{}: {old}", self.title);
            text.replacen(old, new, 1)
        })
    }
}

/// The bad scripts of a table in the form of `bad_scripts.txt`. A title without a word for who refuses it is for the
/// reader.
pub fn table(text: &'static str) -> Vec<Case> {
    let mut cases: Vec<Case> = Vec::new();
    for line in text.lines().filter(|line| !line.starts_with('#')) {
        if let Some(piece) = line.strip_prefix("    ") {
            let (old, new) = piece.split_once(" =>").expect(line);
            let plain = |piece: &str| piece.replace("\\n", "\n");
            let new = plain(new.strip_prefix(' ').unwrap_or(new));
            let case = cases.last_mut().expect("a piece stands below its case");
            case.pieces.push((plain(old), new));
            continue;
        }
        let (kind, title) = line.split_once(": ").expect(line);
        let (code, by) = match kind.split_once(", ") {
            Some((code, "Syntax")) => (code, By::Syntax),
            Some((code, "Schema")) => (code, By::Schema),
            Some((code, "Reader")) => (code, By::Reader),
            Some(_) => panic!("{line}"),
            None => (kind, By::Reader),
        };
        cases.push(Case {
            code,
            by,
            title,
            pieces: Vec::new(),
        });
    }
    cases
}

/// The bad scripts beside [`GOOD`].
pub fn cases() -> Vec<Case> {
    table(include_str!("bad_scripts.txt"))
}

//! Snapshot files in insta's form: a line `---`, the YAML of where the text came from, a line `---`, the
//! text.
//!
//! Read and written here rather than through insta: it can read a file at run time but offers no stable
//! way to make one outside its macros, and it is a test library that the released program would carry.
//! A test holds our files against insta's reader and its macro.

use std::path::Path;

/// The text of a snapshot; `None` if this is no snapshot in insta's form. Line ends are normalised.
pub fn contents(file: &str) -> Option<String> {
    let mut lines = file.lines();
    if lines.next()? != "---" {
        return None;
    }
    lines.find(|line| *line == "---")?;
    Some(lines.collect::<Vec<_>>().join("\n"))
}

/// The file of a snapshot beside a script: its source is the script.
pub fn file(snap: &Path, contents: &str) -> String {
    let stem = snap.file_stem().unwrap_or_default().to_string_lossy();
    // A JSON string is a YAML string as well, whatever the name holds.
    let source = serde_json::Value::from(format!("{stem}.scan.json"));
    format!(
        "---\nsource: {source}\nexpression: golden\n---\n{}\n",
        contents.trim_end()
    )
}

/// Whether two texts are the same snapshot: insta, too, does not count white space at the end.
pub fn same(a: &str, b: &str) -> bool {
    a.trim_end() == b.trim_end()
}

//! Snapshot files in insta's form: a line `---`, YAML that names the source of the text, a line `---`,
//! the text.
//!
//! They are read and written here and not through insta. It can read a file at run time, but has no
//! stable way to make one outside its macros, and it is a test library that the released program would
//! contain. A test compares our files with insta's reader and its macro.

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
    // A JSON string is also a YAML string, for any name.
    let source = serde_json::Value::from(format!("{stem}.scan.json"));
    format!(
        "---\nsource: {source}\nexpression: golden\n---\n{}\n",
        contents.trim_end()
    )
}

/// Whether two texts are the same snapshot; like insta, white space at the end does not count.
pub fn same(a: &str, b: &str) -> bool {
    a.trim_end() == b.trim_end()
}

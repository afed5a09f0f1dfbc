//! The page: files as `bash .ci/site` builds them.

use super::answer::{Answer, plain};
use crate::exit::{Exit, Failure};
use serde_json::Value;
use standstill_script::suite::shown;
use std::fs::{self, File};
use std::io::{self, Read as _};
use std::path::{Component, Path, PathBuf};

/// A file that a folder must have to count as the page.
const FIRST: &str = "playground/index.html";

/// Largest number of bytes of a file that is sent, because it is read as a whole.
const BYTES_MAX: usize = 256 << 20;

/// Types by file name extension; a browser needs some of them.
const KINDS: [(&str, &str); 10] = [
    ("html", "text/html; charset=utf-8"),
    ("js", "text/javascript; charset=utf-8"),
    ("css", "text/css; charset=utf-8"),
    ("json", "application/json"),
    ("svg", "image/svg+xml"),
    ("png", "image/png"),
    ("wasm", "application/wasm"),
    ("woff2", "font/woff2"),
    ("txt", "text/plain; charset=utf-8"),
    ("md", "text/plain; charset=utf-8"),
];

/// The folder of the page.
#[derive(Debug)]
pub struct Site {
    /// The system's own path of it.
    root: PathBuf,
}

impl Site {
    /// The named folder, or the first existing one of the usual folders.
    pub fn find(named: Option<&Path>) -> Result<Self, Failure> {
        let places = named.map_or_else(expected, |folder| vec![folder.to_owned()]);
        let found = places.iter().find(|folder| folder.join(FIRST).is_file());
        let Some(found) = found else {
            let places: Vec<_> = places.iter().map(|folder| shown(folder)).collect();
            let text = format!(
                "error: {}: the page is not there (no {FIRST})\nhelp: `bash .ci/site page` in a clone of the repository builds it \
                 into target/site; `--site FOLDER` says where it is",
                places.join(", ")
            );
            return Err(Failure::Told(Exit::Io, text));
        };
        let root = found
            .canonicalize()
            .map_err(|error| Failure::io(&shown(found), &error))?;
        Ok(Self { root })
    }

    /// The file at the path of an address; for a folder its first page.
    pub fn file(&self, path: &str) -> Result<Answer, Answer> {
        let mut inner = within(path.trim_start_matches('/'))?;
        if path.ends_with('/') {
            inner.push("index.html");
        } else if self.root.join(&inner).is_dir() {
            return Ok(Answer::elsewhere(&format!("{path}/")));
        }
        let (file, length) = open(&self.root, &inner)?;
        if length > BYTES_MAX {
            let why = format!(
                "{}: it has more than the {BYTES_MAX} bytes that are given out",
                shown(&inner)
            );
            return Err(plain(413, &why));
        }
        let ending = inner.extension().and_then(|ending| ending.to_str());
        let kind = KINDS.iter().find(|(known, _)| Some(*known) == ending);
        let kind = kind.map_or("application/octet-stream", |(_, kind)| *kind);
        let mut bytes = Vec::new();
        // A file that grows meanwhile is cut at its old length.
        let read = file.take(length as u64).read_to_end(&mut bytes);
        read.map_err(|error| failed(&shown(&inner), &error))?;
        Ok(Answer::bytes(kind, bytes))
    }

    /// The list of the repository's scripts for the page.
    pub fn scripts(&self) -> Result<Value, Answer> {
        let path = self.root.join("playground/scripts.json");
        let text = fs::read_to_string(path).map_err(|error| failed("playground/scripts.json", &error))?;
        serde_json::from_str(&text).map_err(|_| plain(500, "the page is damaged: build it again"))
    }
}

/// The usual folders of the page: where it is built, in the folder of the program, and where the program
/// is built.
fn expected() -> Vec<PathBuf> {
    let mut places = vec![PathBuf::from("target/site")];
    let program = std::env::current_exe().ok();
    let folders = program
        .iter()
        .flat_map(|program| program.ancestors().skip(1).take(2));
    places.extend(folders.map(|folder| folder.join("site")));
    places
}

/// The path of an address as one that leads only downwards.
pub fn within(path: &str) -> Result<PathBuf, Answer> {
    let is_plain = |part: Component<'_>| matches!(part, Component::Normal(_));
    // A separator of one system is part of a name on another; a colon names drives and streams.
    let is_odd = path.contains(['\\', ':']) || path.chars().any(char::is_control);
    let path = Path::new(path);
    if is_odd || !path.components().all(is_plain) {
        return Err(plain(400, "a path leads down from here, by plain names"));
    }
    Ok(path.to_owned())
}

/// An open file below a folder, and its length (bytes). A link must not lead out; reading a pipe would
/// block.
pub fn open(root: &Path, inner: &Path) -> Result<(File, usize), Answer> {
    let name = shown(inner);
    let path = root.join(inner);
    let path = path.canonicalize().map_err(|error| failed(&name, &error))?;
    if !path.starts_with(root) {
        return Err(plain(403, &format!("{name}: it leads out of the folder")));
    }
    let about = fs::metadata(&path).map_err(|error| failed(&name, &error))?;
    if !about.is_file() {
        return Err(plain(403, &format!("{name}: it is no regular file")));
    }
    let file = File::open(&path).map_err(|error| failed(&name, &error))?;
    let length = usize::try_from(about.len()).map_err(|_| plain(413, &format!("{name}: it is too large")))?;
    Ok((file, length))
}

/// The message for a file that cannot be read.
pub fn failed(name: &str, error: &io::Error) -> Answer {
    let (status, why) = match error.kind() {
        io::ErrorKind::NotFound | io::ErrorKind::NotADirectory => (404, "there is no such file".to_owned()),
        io::ErrorKind::PermissionDenied => (403, "it may not be read".to_owned()),
        _ => (500, error.to_string()),
    };
    plain(status, &format!("{name}: {why}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_lead_down() {
        for good in ["a", "a/b.html", "Ä/b c.json", "a//b", "a/./b"] {
            assert!(within(good).is_ok(), "{good}");
        }
        for wrong in [
            "..",
            "../a",
            "a/../b",
            "/a",
            "a/../../b",
            "a\\b",
            "c:/a",
            "a\0b",
            "a\nb",
        ] {
            assert!(within(wrong).is_err(), "{wrong}");
        }
    }
}

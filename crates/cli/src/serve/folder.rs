//! The scripts of the folder, with the files they name.

use super::answer::{Answer, plain};
use super::desk::name_of;
use super::site::{open, within};
use crate::exit::{Exit, Failure};
use crate::saved::{self, LEFT_OUT, Stamp};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Map, Value, json};
use standstill_script::read_with_programs;
use standstill_script::suite::{EXTENSION, beside, shown};
use std::collections::BTreeMap;
use std::fs;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

/// Largest number of bytes of a script, and of a file that it names; the page reads no more.
const BYTES_MAX: usize = 1 << 20;

/// Largest number of scripts in the list, and of names that are checked for it.
const LISTED_MAX: usize = 2_000;
const NAMES_MAX: usize = 100_000;

/// Largest number of scripts whose last answer is kept.
const KNOWN_MAX: usize = 32;

/// The last answer for a script.
#[derive(Debug)]
struct Known {
    /// The files from which it was made.
    stamps: Vec<(PathBuf, Option<Stamp>)>,
    tag: String,
    body: Value,
}

/// A folder of scripts.
#[derive(Debug)]
pub struct Folder {
    name: String,
    /// The system's own path.
    root: PathBuf,
    allowed: Vec<PathBuf>,
    known: Mutex<BTreeMap<PathBuf, Known>>,
}

impl Folder {
    /// The folder at `path`; its scripts may also read files from those in `allowed`.
    pub fn new(path: PathBuf, allowed: &[PathBuf]) -> Result<Self, Failure> {
        let shown = shown(&path);
        let root = path.canonicalize().map_err(|error| Failure::io(&shown, &error))?;
        if !root.is_dir() {
            let text = format!("error: {shown}: it is no folder; give the one that it is in");
            return Err(Failure::Told(Exit::Usage, text));
        }
        Ok(Self {
            name: name_of(&path),
            root,
            allowed: allowed.to_vec(),
            known: Mutex::default(),
        })
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The list of scripts with those of the folder in front.
    pub fn listed(&self, list: Value) -> Result<Value, Answer> {
        let Value::Array(mut groups) = list else {
            return Err(plain(500, "the page is damaged: build it again"));
        };
        let scripts: Vec<Value> = self
            .scripts()
            .into_iter()
            .map(|name| json!({"name": name, "title": name, "files": []}))
            .collect();
        let own = json!({"group": "folder", "label": self.name, "served": true, "scripts": scripts});
        groups.insert(0, own);
        Ok(Value::from(groups))
    }

    /// Paths of the scripts, sorted; an item that cannot be read is ignored.
    fn scripts(&self) -> Vec<String> {
        let (mut found, mut folders, mut looked) = (Vec::new(), vec![PathBuf::new()], 0);
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(self.root.join(&folder))
                .into_iter()
                .flatten()
                .flatten()
            {
                looked += 1;
                if looked > NAMES_MAX {
                    break;
                }
                let (Ok(kind), Ok(name)) = (entry.file_type(), entry.file_name().into_string()) else {
                    continue;
                };
                let path = folder.join(&name);
                if kind.is_dir() && !name.starts_with('.') && !LEFT_OUT.contains(&name.as_str()) {
                    folders.push(path);
                } else if kind.is_file() && name.ends_with(EXTENSION) {
                    found.push(shown(&path));
                }
            }
        }
        found.sort();
        found.truncate(LISTED_MAX);
        found
    }

    /// A script with the files that it names: `{"name", "text", "files", "lacks"}`. A file that is no text is
    /// `{"base64": ".."}`, and `lacks` gives the reasons why others are missing. `tag` belongs to the answer that
    /// the page already has.
    pub fn script(&self, path: &str, tag: Option<&str>) -> Result<Answer, Answer> {
        let inner = within(path)?;
        if !path.ends_with(EXTENSION) {
            return Err(plain(
                403,
                &format!("{path}: only scripts, which end in {EXTENSION}, are opened"),
            ));
        }
        let mut known = self.known.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        let last = known.get(&inner).filter(|last| last.is_as_saved());
        if last.is_none() {
            known.remove(&inner);
            let fresh = self.read(path, &inner)?;
            if known.len() >= KNOWN_MAX {
                known.clear();
            }
            known.insert(inner.clone(), fresh);
        }
        let Some(last) = known.get(&inner) else {
            return Err(plain(500, "the script was lost on its way"));
        };
        if tag == Some(last.tag.as_str()) {
            return Ok(Answer::unchanged(&last.tag));
        }
        Ok(Answer::json(&last.body).with("etag", last.tag.clone()))
    }

    fn read(&self, path: &str, inner: &Path) -> Result<Known, Answer> {
        let place = self.root.join(inner);
        let mut files = Files {
            script: &place,
            allowed: &self.allowed,
            stamps: vec![(place.clone(), stamp(&place))],
            texts: Map::new(),
            lacks: Map::new(),
        };
        let (file, _) = open(&self.root, inner)?;
        let bytes = bounded(file).map_err(|why| plain(413, &format!("{path}: {why}")))?;
        let text = String::from_utf8(bytes)
            .map_err(|_| plain(415, &format!("{path}: it is not UTF-8; save it as UTF-8")))?;
        // It is read for the names of its files; the page reports its faults.
        let all = std::cell::RefCell::new(&mut files);
        let _ = read_with_programs(
            &text,
            path,
            &[],
            &mut |name| {
                let bytes = all.borrow_mut().load(name)?;
                String::from_utf8(bytes).map_err(|_| "it is not UTF-8; save it as UTF-8".to_owned())
            },
            &mut |name| all.borrow_mut().load(name),
        );
        let body = json!({"name": path, "text": text, "files": files.texts, "lacks": files.lacks});
        let mut hasher = DefaultHasher::new();
        body.to_string().hash(&mut hasher);
        Ok(Known {
            stamps: files.stamps,
            tag: format!("\"{:016x}\"", hasher.finish()),
            body,
        })
    }
}

impl Known {
    fn is_as_saved(&self) -> bool {
        self.stamps.iter().all(|(path, then)| stamp(path) == *then)
    }
}

/// The files that a script names, in the order of reading.
struct Files<'a> {
    script: &'a Path,
    allowed: &'a [PathBuf],
    stamps: Vec<(PathBuf, Option<Stamp>)>,
    texts: Map<String, Value>,
    lacks: Map<String, Value>,
}

impl Files<'_> {
    /// The bytes of a file; the result is kept for the page.
    fn load(&mut self, name: &str) -> Result<Vec<u8>, String> {
        let place = self.script.parent().unwrap_or(Path::new("")).join(name);
        self.stamps.push((place.clone(), stamp(&place)));
        let bytes = beside(self.script, name, self.allowed, "script").and_then(|path| {
            // Reading a pipe would block.
            if !fs::metadata(&path).map_err(|error| error.to_string())?.is_file() {
                return Err("it is no regular file".to_owned());
            }
            let file = fs::File::open(&path).map_err(|error| error.to_string())?;
            bounded(file)
        });
        match &bytes {
            Ok(bytes) => {
                let text = std::str::from_utf8(bytes)
                    .ok()
                    .filter(|text| !text.contains('\0'));
                let kept = text.map_or_else(|| json!({"base64": STANDARD.encode(bytes)}), |text| json!(text));
                self.texts.insert(name.to_owned(), kept);
            }
            Err(why) => {
                self.lacks.insert(name.to_owned(), json!(why));
            }
        }
        bytes
    }
}

/// The whole of a file that is not too large.
fn bounded(file: fs::File) -> Result<Vec<u8>, String> {
    let mut bytes = Vec::new();
    let read = file.take(BYTES_MAX as u64 + 1).read_to_end(&mut bytes);
    read.map_err(|error| error.to_string())?;
    if bytes.len() > BYTES_MAX {
        return Err(format!(
            "it has more than the {BYTES_MAX} bytes that the playground reads; `standstill run` takes it as it is"
        ));
    }
    Ok(bytes)
}

/// The stamp of a file; none for a missing one.
fn stamp(path: &Path) -> Option<Stamp> {
    let about = fs::metadata(path).ok()?;
    Some(saved::stamp(&about))
}

//! The documents that an editor has open, and the files beside them.

use crate::position::Text;
use crate::uri;
use lsp_types::Uri;
use standstill_script::suite::{EXTENSION, beside};
use std::collections::BTreeMap;
use std::fs;
use std::io::Read;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Largest number of bytes of a file that are read: the compiler's limit, and one more.
const BYTES_MOST: u64 = standstill_st::SOURCES_MOST as u64 + 1;

/// Largest number of scripts of a folder that are searched for the names of programs.
const SCRIPTS_MOST: usize = 1000;

/// A text that an editor has open.
#[derive(Debug)]
pub(crate) struct Document {
    pub uri: Uri,
    pub version: i32,
    pub text: Rc<Text>,
}

/// The kind of a document's text, by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    StructuredText,
    Script,
}

/// All open documents, by their paths; those without a path by their URI.
#[derive(Debug, Default)]
pub(crate) struct Documents {
    open: BTreeMap<PathBuf, Document>,
}

/// The path that identifies a document.
pub(crate) fn key(uri: &Uri) -> PathBuf {
    uri::path(uri).unwrap_or_else(|| PathBuf::from(uri.as_str()))
}

/// The kind of a document.
pub(crate) fn kind(path: &Path) -> Option<Kind> {
    let name = path.to_str()?.to_ascii_lowercase();
    if name.ends_with(EXTENSION) {
        Some(Kind::Script)
    } else if name.ends_with(".st") || name.ends_with(".iecst") {
        Some(Kind::StructuredText)
    } else {
        None
    }
}

impl Documents {
    pub(crate) fn put(&mut self, uri: Uri, version: i32, text: String) {
        let text = Rc::new(Text::new(text));
        self.open.insert(key(&uri), Document { uri, version, text });
    }

    pub(crate) fn remove(&mut self, uri: &Uri) {
        self.open.remove(&key(uri));
    }

    pub(crate) fn iter(&self) -> impl Iterator<Item = (&PathBuf, &Document)> {
        self.open.iter()
    }

    /// The text of a document, or of the file if it is not open.
    pub(crate) fn text(&self, path: &Path) -> Result<Rc<Text>, String> {
        if let Some(document) = self.open.get(path) {
            return Ok(document.text.clone());
        }
        // Reading a pipe would block.
        let metadata = fs::metadata(path).map_err(|_| "there is no such file".to_owned())?;
        if !metadata.is_file() {
            return Err("it is no regular file".to_owned());
        }
        let mut bytes = Vec::new();
        let read = fs::File::open(path).and_then(|file| file.take(BYTES_MOST).read_to_end(&mut bytes));
        read.map_err(|error| error.to_string())?;
        let text = String::from_utf8(bytes).map_err(|_| "it is not UTF-8".to_owned())?;
        Ok(Rc::new(Text::new(text)))
    }

    /// The file that a script or another file names, if it may be read.
    pub(crate) fn beside(&self, outer: &Path, inner: &str) -> Result<PathBuf, String> {
        // An open document is known by its own path, which may differ from the system's.
        let plain = outer.parent().unwrap_or(Path::new("")).join(inner);
        let inside = !Path::new(inner)
            .components()
            .any(|it| !matches!(it, std::path::Component::Normal(_)));
        if inside && self.open.contains_key(&plain) {
            return Ok(plain);
        }
        let real = beside(outer, inner, &[], "script")?;
        Ok(if inside { plain } else { real })
    }

    /// The files of the program that a file in Structured Text belongs to, as named by a script of its
    /// folder or of one above it. If no script names it, all `.st` files of its folder. The file itself
    /// is among them.
    pub(crate) fn project(&self, path: &Path) -> Vec<PathBuf> {
        const FOLDERS_UP: usize = 3;
        for folder in path.ancestors().skip(1).take(FOLDERS_UP) {
            for script in self.scripts(folder) {
                if let Some(files) = self.named_with(&script, path) {
                    return files;
                }
            }
        }
        let mut files = self.listed(path.parent(), |name| kind(name) == Some(Kind::StructuredText));
        if !files.iter().any(|file| file == path) {
            files.push(path.to_owned());
        }
        files.sort();
        files
    }

    fn scripts(&self, folder: &Path) -> Vec<PathBuf> {
        let mut scripts = self.listed(Some(folder), |name| kind(name) == Some(Kind::Script));
        scripts.truncate(SCRIPTS_MOST);
        scripts
    }

    /// Files of a folder on the disk and among the documents, sorted by name.
    fn listed(&self, folder: Option<&Path>, wanted: impl Fn(&Path) -> bool) -> Vec<PathBuf> {
        let Some(folder) = folder.filter(|folder| folder.is_absolute()) else {
            return Vec::new();
        };
        let entries = fs::read_dir(folder).into_iter().flatten().flatten();
        let mut found: Vec<_> = entries
            .map(|entry| entry.path())
            .filter(|path| wanted(path) && path.is_file())
            .collect();
        let open = self
            .open
            .keys()
            .filter(|path| path.parent() == Some(folder) && wanted(path));
        found.extend(open.cloned());
        found.sort();
        found.dedup();
        found
    }

    /// The files of the program of a script that names this file.
    fn named_with(&self, script: &Path, path: &Path) -> Option<Vec<PathBuf>> {
        let text = self.text(script).ok()?;
        // Reading the whole script takes longer than searching the name in it.
        if !text.as_str().contains(path.file_name()?.to_str()?) {
            return None;
        }
        let tree = crate::tree::parse(text.as_str());
        let programs = tree.get("programs")?;
        programs.members().find_map(|(_, program)| {
            let files: Vec<_> = program
                .get("st")?
                .texts()
                .filter_map(|inner| self.beside(script, inner).ok())
                .collect();
            files.iter().any(|file| file == path).then_some(files)
        })
    }
}

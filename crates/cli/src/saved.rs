//! The times and lengths of a folder's files when last saved.

use standstill_trace::file::folder_of;
use std::collections::BTreeMap;
use std::fs::{self, Metadata};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

/// Endings of files that tests write themselves.
const WRITTEN: [&str; 2] = [".new", ".partial"];

/// Folders without edited files: they may have very many files.
pub const LEFT_OUT: [&str; 2] = ["target", "node_modules"];

/// The time of saving and the length of a file.
pub type Stamp = (Option<SystemTime>, u64);

/// Those of each file below some paths.
#[derive(Debug, Default, PartialEq, Eq)]
pub struct Saved(BTreeMap<PathBuf, Stamp>);

/// The stamp of a file.
pub fn stamp(about: &Metadata) -> Stamp {
    (about.modified().ok(), about.len())
}

impl Saved {
    /// All files below the paths; for a file those of its folder. `except` and all below it are left out.
    /// An item that cannot be read is ignored.
    pub fn below(paths: &[PathBuf], except: Option<&Path>) -> Self {
        let mut folders: Vec<PathBuf> = paths
            .iter()
            .map(|path| match path.is_dir() {
                true => path.clone(),
                false => folder_of(path).to_owned(),
            })
            .collect();
        let except = except.and_then(|path| path.canonicalize().ok());
        let mut files = BTreeMap::new();
        while let Some(folder) = folders.pop() {
            for entry in fs::read_dir(&folder).into_iter().flatten().flatten() {
                let path = entry.path();
                let name = entry.file_name();
                let name = name.to_string_lossy();
                let Ok(about) = entry.metadata() else { continue };
                if name.starts_with('.') {
                    continue;
                }
                if about.is_dir() {
                    let is_left_out = except.is_some() && path.canonicalize().ok() == except;
                    if !is_left_out && !LEFT_OUT.contains(&&*name) {
                        folders.push(path);
                    }
                } else if !WRITTEN.iter().any(|ending| name.ends_with(ending)) {
                    files.insert(path, stamp(&about));
                }
            }
        }
        Self(files)
    }
}

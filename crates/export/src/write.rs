//! Files into a folder: all of them or none.

use crate::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// Why nothing was written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {source}; nothing was written: name a folder that can be written with --out", path.display())]
pub struct WriteError {
    /// Where it happened.
    pub path: PathBuf,
    /// What.
    pub source: io::Error,
}

/// Writes `files` into `folder`, which is made if it is not there.
///
/// Everything is written beside its place first and moved there when all of it stands, so that a full disk leaves what
/// was there before.
///
/// # Errors
/// [`WriteError`] names the file or folder; nothing has changed then but for a failing rename in a folder that could be
/// written, after which each file is whole, old or new.
pub fn write(folder: &Path, files: &[File]) -> Result<(), WriteError> {
    let at = |path: &Path| {
        let path = path.to_owned();
        move |source| WriteError { path, source }
    };
    fs::create_dir_all(folder).map_err(at(folder))?;
    let beside = |file: &File| folder.join(format!(".{}.part", file.name));
    let written = files.iter().try_for_each(|file| {
        let place = folder.join(&file.name);
        if place.is_dir() {
            return Err(at(&place)(io::Error::from(io::ErrorKind::IsADirectory)));
        }
        let part = beside(file);
        // Whatever has this name already, a link perhaps, gives way to a new file.
        let _ = fs::remove_file(&part);
        let new = fs::File::options().write(true).create_new(true).open(&part);
        new.and_then(|mut new| new.write_all(file.text.as_bytes()))
            .map_err(at(&part))
    });
    let moved = written.and_then(|()| {
        files.iter().try_for_each(|file| {
            let place = folder.join(&file.name);
            fs::rename(beside(file), &place).map_err(at(&place))
        })
    });
    if moved.is_err() {
        for file in files {
            // One that was never written, or moved already, is not there.
            let _ = fs::remove_file(beside(file));
        }
    }
    moved
}

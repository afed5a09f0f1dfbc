//! Files into a folder: all of them or none.

use crate::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::{fs, io};

/// The reason why nothing was written.
#[derive(Debug, thiserror::Error)]
#[error("{}: {source}; nothing was written: name a folder that can be written with --out", path.display())]
pub struct WriteError {
    /// The file or folder.
    pub path: PathBuf,
    /// The error.
    pub source: io::Error,
}

/// Writes `files` into `folder`, which is created if it does not exist.
///
/// All files are written beside their places first and moved there when all are complete, so that a full
/// disk leaves the earlier files.
///
/// # Errors
/// [`WriteError`] names the file or folder. Nothing has changed then, except after a failed rename in a
/// writable folder: then each file is whole, old or new.
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
        // An item that already has this name, perhaps a link, is replaced by a new file.
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
            // A file that was never written, or is already moved, does not exist.
            let _ = fs::remove_file(beside(file));
        }
    }
    moved
}

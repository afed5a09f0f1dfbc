//! Checks that the files a command writes differ from each other and from those that it reads.

use crate::exit::Failure;
use standstill_script::suite::shown;
use standstill_trace::csv::meta_path;
use standstill_trace::file::{can_save, folder_of, is_csv, is_special};
use std::fs;
use std::path::{Path, PathBuf};

/// A file that a command writes, with the words that name it in a message.
#[derive(Clone, Debug)]
pub struct Written {
    what: String,
    path: PathBuf,
}

/// The file of an option, if it is given.
pub fn written(option: &str, path: Option<&Path>) -> Vec<Written> {
    let path = path.into_iter();
    path.map(|path| Written {
        what: option.to_owned(),
        path: path.to_owned(),
    })
    .collect()
}

/// The files of a trace: a table has its header beside it. Refuses a file in which no trace can be written.
pub fn trace(path: Option<&Path>) -> Result<Vec<Written>, Failure> {
    if let Some(path) = path.filter(|path| !can_save(path)) {
        let name = shown(path);
        return Err(Failure::usage(&format!(
            "--trace {name}: a trace is a .csv or a .jsonl file"
        )));
    }
    let header = path.filter(|path| is_csv(path)).map(meta_path);
    let mut all = written("--trace", path);
    all.extend(written("the header of --trace", header.as_deref()));
    Ok(all)
}

/// Refuses two files in one place, by any paths, and a file in the place of one that is read. Call it before
/// anything is written.
pub fn checked<'a>(writes: &[Written], reads: impl IntoIterator<Item = &'a Path>) -> Result<(), Failure> {
    let placed: Vec<_> = writes
        .iter()
        .filter(|file| !is_special(&file.path))
        .map(|file| (file, place(&file.path)))
        .collect();
    for (index, (file, own)) in placed.iter().enumerate() {
        let same = placed.iter().take(index).find(|(_, other)| other == own);
        if let Some((other, _)) = same {
            let (what, path) = (&file.what, shown(&file.path));
            let message = format!(
                "{} and {what} are one file, {path}: each needs its own",
                other.what
            );
            return Err(Failure::usage(&message));
        }
    }
    for path in reads {
        // For a link both places count: writing would destroy its target as well as the link.
        let places = [Some(place(path)), fs::canonicalize(path).ok()];
        let lost = placed
            .iter()
            .find(|(_, own)| places.iter().flatten().any(|read| read == own));
        if let Some((file, _)) = lost {
            let message = format!("{} would replace {}, which is read", file.what, shown(path));
            return Err(Failure::usage(&message));
        }
    }
    Ok(())
}

/// The place of a file, existing or not: its own name in the system's own path of its folder. A link at this place
/// is replaced, so it is not followed.
fn place(path: &Path) -> PathBuf {
    match (fs::canonicalize(folder_of(path)), path.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        // It cannot be written at all.
        _ => path.to_owned(),
    }
}

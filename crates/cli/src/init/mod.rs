//! `standstill init`: the files of a first test.

use crate::exit::{Exit, Failure};
use standstill_script::suite::shown;
use std::fs::{self, File};
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};

/// Every file that is written, by its path in the folder.
fn files() -> [(&'static str, String); 8] {
    let workflow = include_str!("files/workflow.yml").replace("@VERSION@", env!("CARGO_PKG_VERSION"));
    [
        (
            "scan-tests/slide.machine.json",
            include_str!("files/slide.machine.json").to_owned(),
        ),
        (
            "scan-tests/out_and_back.scan.json",
            include_str!("files/out_and_back.scan.json").to_owned(),
        ),
        ("scan-tests/scan-script.schema.json", standstill_script::schema()),
        (
            "scan-tests/machine-file.schema.json",
            standstill_script::machine_schema(),
        ),
        (
            "scan-tests/.gitattributes",
            include_str!("files/gitattributes").to_owned(),
        ),
        (
            ".vscode/settings.json",
            include_str!("files/vscode.json").to_owned(),
        ),
        (
            ".idea/jsonSchemas.xml",
            include_str!("files/jetbrains.xml").to_owned(),
        ),
        (".github/workflows/motion.yml", workflow),
    ]
}

/// Writes a first test into a folder, which is created if it does not exist. If one of the files exists nothing is
/// written. If one cannot be written those before it are removed.
pub fn init(folder: &Path, out: &mut dyn Write) -> Result<Exit, Failure> {
    if fs::metadata(folder).is_ok_and(|found| !found.is_dir()) {
        let name = shown(folder);
        return Err(Failure::usage(&format!(
            "{name} exists already and is no folder: name another one"
        )));
    }
    let files = files();
    let mut clashes = Vec::new();
    for (name, _) in &files {
        clashes.extend(in_the_way(folder, name)?);
    }
    clashes.dedup();
    if !clashes.is_empty() {
        let names: Vec<_> = clashes.iter().map(|path| shown(path)).collect();
        let verb = if names.len() == 1 { "exists" } else { "exist" };
        return Err(Failure::usage(&format!(
            "{} {verb} already: nothing was written; name another folder, or move away what is there",
            names.join(", ")
        )));
    }
    let mut made = Made::default();
    for (name, text) in &files {
        made.file(&folder.join(name), text)?;
    }
    for path in made.keep() {
        writeln!(out, "wrote     {}", shown(&path))?;
    }
    let at = if folder == Path::new(".") {
        String::new()
    } else {
        format!(" {}", shown(&folder.join("scan-tests")))
    };
    writeln!(out, "\nnext: standstill test --strict{at}")?;
    Ok(Exit::Passed)
}

/// The obstacle to a new file: an existing file, or an item on its path that is no folder. Links are not followed
/// below the folder.
fn in_the_way(folder: &Path, name: &str) -> Result<Option<PathBuf>, Failure> {
    let mut path = folder.to_owned();
    let mut parts = name.split('/').peekable();
    while let Some(part) = parts.next() {
        path.push(part);
        match fs::symlink_metadata(&path) {
            Ok(found) if found.is_dir() && parts.peek().is_some() => {}
            Ok(_) => return Ok(Some(path)),
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
            Err(error) => return Err(Failure::io(&shown(&path), &error)),
        }
    }
    Ok(None)
}

/// The files made so far. They are removed when this is dropped, so that a full disk does not leave half of the
/// test.
#[derive(Debug, Default)]
struct Made {
    folders: Vec<PathBuf>,
    files: Vec<PathBuf>,
}

impl Made {
    fn file(&mut self, path: &Path, text: &str) -> Result<(), Failure> {
        let failed = |error| Failure::io(&shown(path), &error);
        if let Some(folder) = path.parent() {
            self.folder(folder).map_err(failed)?;
        }
        let mut file = File::create_new(path).map_err(failed)?;
        self.files.push(path.to_owned());
        file.write_all(text.as_bytes()).map_err(failed)
    }

    fn folder(&mut self, path: &Path) -> std::io::Result<()> {
        if path.as_os_str().is_empty() || path.is_dir() {
            return Ok(());
        }
        if let Some(parent) = path.parent() {
            self.folder(parent)?;
        }
        fs::create_dir(path)?;
        self.folders.push(path.to_owned());
        Ok(())
    }

    /// Keeps all files, and returns them.
    fn keep(mut self) -> Vec<PathBuf> {
        self.folders.clear();
        std::mem::take(&mut self.files)
    }
}

impl Drop for Made {
    fn drop(&mut self) {
        // The error also names files that cannot be removed.
        for file in &self.files {
            let _ = fs::remove_file(file);
        }
        for folder in self.folders.iter().rev() {
            let _ = fs::remove_dir(folder);
        }
    }
}

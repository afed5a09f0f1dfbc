//! The workplace of a client: the files it may read and write, and the limits of a call.

use crate::args::McpArguments;
use crate::exit::{Exit, Failure};
use standstill_script::suite::shown;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// The folder of a client, and the bounds of a call.
#[derive(Debug)]
pub struct Place {
    /// The folder that it may read, after following links.
    root: PathBuf,
    /// The folder that it may write into.
    write: Option<PathBuf>,
    /// Time of a call.
    pub time: Duration,
    /// Memory of a call (bytes).
    pub memory: u64,
}

impl Place {
    pub fn new(arguments: &McpArguments) -> Result<Self, Failure> {
        Ok(Self {
            root: folder(&arguments.folder)?,
            write: arguments.write.as_deref().map(folder).transpose()?,
            time: Duration::from_nanos(arguments.call_time),
            memory: arguments.call_memory,
        })
    }

    /// The folder in which calls work.
    pub fn root(&self) -> &Path {
        &self.root
    }

    /// Whether there is a folder to write into.
    pub fn writes(&self) -> bool {
        self.write.is_some()
    }

    /// A file or folder that may be read, as a path below the root. Links are followed, and may not lead
    /// out of it.
    pub fn readable(&self, path: &str) -> Result<String, String> {
        let real = fs::canonicalize(self.root.join(path)).map_err(|error| format!("{path}: {error}"))?;
        let Ok(inside) = real.strip_prefix(&self.root) else {
            return Err(format!(
                "{path}: it is outside the folder of this server, which is all that is read; start `standstill mcp` there"
            ));
        };
        // A name that begins with a hyphen must not become an option.
        let inside = Path::new(".").join(inside);
        inside
            .to_str()
            .map(str::to_owned)
            .ok_or_else(|| format!("{path}: its name is not UTF-8"))
    }

    /// A file to be written: a plain name in the folder for it.
    pub fn writable(&self, name: &str) -> Result<PathBuf, String> {
        let Some(folder) = &self.write else {
            return Err(format!(
                "{name}: this server writes no files; start it with `standstill mcp --write FOLDER`"
            ));
        };
        let is_plain = Path::new(name).file_name().is_some_and(|plain| plain == name);
        if !is_plain || name.starts_with('.') || name.contains(['/', '\\', ':']) {
            return Err(format!(
                "{name}: files go into the folder of --write under a plain name, such as run.html"
            ));
        }
        Ok(folder.join(name))
    }
}

/// An existing folder, after following links.
fn folder(path: &Path) -> Result<PathBuf, Failure> {
    let real = fs::canonicalize(path).map_err(|error| Failure::io(&shown(path), &error))?;
    if real.is_dir() {
        return Ok(real);
    }
    Err(Failure::Told(
        Exit::Usage,
        format!("error: {}: it is no folder", shown(path)),
    ))
}

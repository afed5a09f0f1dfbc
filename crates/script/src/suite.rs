//! Folders of scan scripts: finds them, and judges one as a test.
//!
//! The command line and the repository's own tests call the same functions, so both give the same verdict.

use crate::golden::{self, Mode, Standing};
use crate::model::Script;
use crate::read::{Parsed, Terms, read_within};
use crate::run::{Counted, Outcome, RunError, Session, run_with};
use crate::{GUEST_MEMORY, Reason, ScriptError, Warnings, warnings};
use serde_json::json;
use standstill_trace::compare::Yardstick;
use standstill_trace::file::read_regular;
pub use standstill_trace::file::shown;
use standstill_trace::golden::GoldenError;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt;
use std::fs;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

/// The end of the name of a scan script.
pub const EXTENSION: &str = ".scan.json";

/// The end of the name of a machine file, which scripts include.
pub const MACHINE_EXTENSION: &str = ".machine.json";

/// Endings of the files that belong to a script.
const COMPANIONS: [&str; 3] = [".snap", ".exact", ".snap.new"];

/// A script, run and judged.
#[derive(Clone, Debug)]
pub struct Report {
    /// Its trace and its judged claims.
    pub outcome: Outcome,
    /// The result of comparing it with its golden.
    pub golden: Standing,
    /// The reasons if it failed, the likeliest first.
    pub why: Vec<Reason>,
    /// Items that test nothing, and values that were changed on the way.
    pub warnings: Warnings,
}

impl Report {
    /// Whether all claims hold and the golden matches.
    pub fn passed(&self) -> bool {
        self.outcome.passed() && !matches!(self.golden, Standing::Failed(_))
    }
}

/// The failures, a paragraph each: claims first, in file order, and their reasons, then the golden.
impl fmt::Display for Report {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for failure in self.outcome.verdicts.iter().flat_map(|it| &it.failures) {
            writeln!(out, "{failure}")?;
        }
        let why = Reasons(&self.why);
        if !self.outcome.passed() {
            write!(out, "{why}")?;
        }
        if let Standing::Failed(what) = &self.golden {
            writeln!(out, "golden: {}", what.trim_end())?;
        }
        if self.outcome.passed() {
            write!(out, "{why}")?;
        }
        Ok(())
    }
}

/// Reasons as lines under a heading; nothing if there are none.
#[derive(Clone, Copy, Debug)]
pub struct Reasons<'a>(pub &'a [Reason]);

impl fmt::Display for Reasons<'_> {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.0.is_empty() {
            writeln!(out, "why")?;
        }
        for reason in self.0 {
            writeln!(out, "  {}", reason.text)?;
        }
        Ok(())
    }
}

/// The reason why a script could not be judged.
#[derive(Debug, thiserror::Error)]
pub enum SuiteError {
    /// A file or folder could not be read.
    #[error("{}: {source}", shown(.path))]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// The message of the system.
        source: io::Error,
    },
    /// The script is no UTF-8 text.
    #[error("{}: not UTF-8 after {valid} bytes: it looks like {like}; save it as UTF-8", shown(.path))]
    Encoding {
        /// The script.
        path: PathBuf,
        /// The number of bytes that are text.
        valid: usize,
        /// The probable encoding.
        like: &'static str,
    },
    /// The script is not valid.
    #[error(transparent)]
    Script(#[from] ScriptError),
    /// The script could not be run to its end.
    #[error("{}: {source}", shown(.path))]
    Run {
        /// The script.
        path: PathBuf,
        /// The reason.
        source: RunError,
    },
    /// The golden could not be read or written.
    #[error(transparent)]
    Golden(#[from] GoldenError),
}

impl SuiteError {
    fn io(path: &Path) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::Io {
            path: path.to_owned(),
            source,
        }
    }
}

/// Permissions of a command for its scripts, beyond those of any script.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Allowed {
    /// Folders from which files may be read, with the folders in them, in addition to the script's own.
    pub folders: Vec<PathBuf>,
    /// Memory that all guest programs of a script may have together (bytes).
    pub guest_memory: u64,
    /// Whether runs may have more cells than one trace can hold: for a command that does not keep their rows.
    pub long: bool,
}

impl Default for Allowed {
    fn default() -> Self {
        Self {
            folders: Vec::new(),
            guest_memory: GUEST_MEMORY,
            long: false,
        }
    }
}

impl Allowed {
    fn terms(&self, coverage: bool) -> Terms {
        Terms {
            guest_memory: self.guest_memory,
            coverage,
            long: self.long,
            ..Terms::default()
        }
    }
}

/// Reads and runs the script at `path`. Judges it by its claims and, with this yardstick, by its golden. Without a
/// golden, or with `"golden": false` in the script, only the claims decide. `progress` is called from time to time
/// with the number of scans done. Files that it includes must be below its folder or in a folder that `allowed`
/// permits.
///
/// # Errors
/// [`SuiteError`]. Claims and goldens that fail are no error; they are in the report.
pub fn judge_file(
    path: &Path,
    mode: Mode,
    yardstick: impl Into<Option<Yardstick>>,
    allowed: &Allowed,
    progress: impl FnMut(u64),
) -> Result<Report, SuiteError> {
    let (script, outcome) = run_script(path, &[], allowed, progress)?;
    let yardstick = yardstick.into().filter(|_| script.golden);
    let golden = match yardstick {
        Some(yardstick) => golden::judge(path, &outcome, mode, yardstick)?,
        None => Standing::Unasked,
    };
    let warnings = warnings(&script, &outcome, yardstick.is_some());
    let mut why = outcome.why.clone();
    if matches!(golden, Standing::Failed(_)) {
        match golden::why(path, &outcome.trace)? {
            Some((reason, true)) => why.insert(0, reason),
            Some((reason, false)) => why.push(reason),
            None => {}
        }
    }
    Ok(Report {
        outcome,
        golden,
        why,
        warnings,
    })
}

/// Reads and runs the script at `path`, with these values in place of its own parameters; `allowed` as for
/// [`judge_file`].
///
/// # Errors
/// [`SuiteError`], except [`SuiteError::Golden`].
pub fn run_file(
    path: &Path,
    parameters: &[(String, f64)],
    allowed: &Allowed,
    progress: impl FnMut(u64),
) -> Result<Outcome, SuiteError> {
    run_script(path, parameters, allowed, progress).map(|(_, outcome)| outcome)
}

/// The same as [`run_file`]; also returns the script.
///
/// # Errors
/// Those of [`run_file`].
pub fn run_script(
    path: &Path,
    parameters: &[(String, f64)],
    allowed: &Allowed,
    progress: impl FnMut(u64),
) -> Result<(Script, Outcome), SuiteError> {
    let (script, _) = read_file(path, parameters, allowed)?;
    let outcome = run_with(&script, progress).map_err(|source| SuiteError::Run {
        path: path.to_owned(),
        source,
    })?;
    Ok((script, outcome))
}

/// Reads the script at `path`; the script and its text. Arguments as for [`run_file`].
///
/// # Errors
/// [`SuiteError::Io`], [`SuiteError::Encoding`] or [`SuiteError::Script`].
pub fn read_file(
    path: &Path,
    parameters: &[(String, f64)],
    allowed: &Allowed,
) -> Result<(Script, String), SuiteError> {
    read_as(path, parameters, allowed, false)
}

/// Reads a machine file for its axes, like a script without steps and blocks; a file that ends in
/// `.scan.json` is a script itself.
///
/// # Errors
/// Those of [`read_file`].
pub fn read_axes(path: &Path, allowed: &Allowed) -> Result<Script, SuiteError> {
    if path.to_string_lossy().ends_with(EXTENSION) {
        return Ok(read_file(path, &[], allowed)?.0);
    }
    let machine = read_text(path)?;
    let name = path
        .file_name()
        .map(|name| name.to_string_lossy().into_owned())
        .unwrap_or_default();
    let script = json!({
        "standstill": 1,
        "cycle": "T#1ms",
        "scans": 1,
        "axes": {},
        "blocks": [],
        "include": name,
    });
    let mut load = |inner: &str| {
        if inner == name {
            Ok(machine.clone())
        } else {
            included(path, inner, allowed)
        }
    };
    let mut guest = |inner: &str| module(path, inner, allowed);
    let folder = shown(path.parent().unwrap_or(Path::new("")));
    let file = if folder.is_empty() {
        "(the script for it)".to_owned()
    } else {
        format!("{folder}/(the script for it)")
    };
    let text = format!("{script:#}\n");
    Ok(read_within(
        &text,
        &file,
        &[],
        &mut load,
        &mut guest,
        Terms::default(),
    )?)
}

/// The same as [`read_file`]; the statements of its programs in Structured Text are counted, and may take more
/// fuel.
///
/// # Errors
/// Those of [`read_file`].
pub fn read_counted(
    path: &Path,
    parameters: &[(String, f64)],
    allowed: &Allowed,
) -> Result<(Script, String), SuiteError> {
    read_as(path, parameters, allowed, true)
}

fn read_as(
    path: &Path,
    parameters: &[(String, f64)],
    allowed: &Allowed,
    coverage: bool,
) -> Result<(Script, String), SuiteError> {
    let text = read_text(path)?;
    let script = read_at(&text, path, parameters, allowed, coverage)?;
    Ok((script, text))
}

/// Reads a text as the script at `path`; files that it names are searched from there. Arguments as for
/// [`run_file`].
///
/// # Errors
/// [`ScriptError`].
pub fn read_given(
    text: &str,
    path: &Path,
    parameters: &[(String, f64)],
    allowed: &Allowed,
) -> Result<Script, ScriptError> {
    read_at(text, path, parameters, allowed, false)
}

fn read_at(
    text: &str,
    path: &Path,
    parameters: &[(String, f64)],
    allowed: &Allowed,
    coverage: bool,
) -> Result<Script, ScriptError> {
    let terms = allowed.terms(coverage);
    let mut load = |inner: &str| included(path, inner, allowed);
    let mut guest = |inner: &str| module(path, inner, allowed);
    read_within(text, &shown(path), parameters, &mut load, &mut guest, terms)
}

/// The execution counts of the statements and branches of the script's programs in Structured Text: `None` if it
/// has no such program. They are counted in a run of their own, so the judged run is the same with and without.
///
/// # Errors
/// Those of [`run_file`].
pub fn coverage(path: &Path, allowed: &Allowed) -> Result<Option<Vec<Counted>>, SuiteError> {
    let (script, _) = read_counted(path, &[], allowed)?;
    if script.programs.iter().all(|program| program.text.is_none()) {
        return Ok(None);
    }
    let run = |source| SuiteError::Run {
        path: path.to_owned(),
        source,
    };
    let mut session = Session::new(&script).map_err(run)?;
    while session.advance().map_err(run)? {}
    Ok(Some(session.counted()))
}

/// A script with all its includes, read once for runs with many values of its parameters.
#[derive(Clone, Debug)]
pub struct Texts {
    parsed: Parsed,
    terms: Terms,
    guests: BTreeMap<String, Vec<u8>>,
    /// Parameters that are used outside the axes.
    beside_axes: BTreeSet<String>,
}

impl Texts {
    /// Reads the script at `path` and the files that it includes; `allowed` as for [`judge_file`]. Also
    /// returns the script with its own parameters.
    ///
    /// # Errors
    /// [`SuiteError::Io`], [`SuiteError::Encoding`], [`SuiteError::Script`].
    pub fn read(path: &Path, allowed: &Allowed) -> Result<(Self, Script), SuiteError> {
        let mut load = |inner: &str| included(path, inner, allowed);
        let parsed = Parsed::new(&read_text(path)?, &shown(path), &mut load)?;
        let mut guests = BTreeMap::new();
        let mut guest = |inner: &str| {
            let bytes = module(path, inner, allowed)?;
            guests.insert(inner.to_owned(), bytes.clone());
            Ok(bytes)
        };
        let terms = Terms {
            guest_memory: allowed.guest_memory,
            ..Terms::default()
        };
        let script = parsed.script(&[], &mut guest, terms)?;
        let texts = Self {
            beside_axes: parsed.parameters_beside_axes(),
            parsed,
            terms,
            guests,
        };
        Ok((texts, script))
    }

    /// Gives `script`, which is that of [`Texts::read`] or was varied before, these values of its parameters. Each
    /// call must name the same parameters.
    ///
    /// # Errors
    /// [`ScriptError`] if it is not valid with them; `script` is then unusable until it gets valid values.
    pub fn vary(&self, script: &mut Script, parameters: &[(String, f64)]) -> Result<(), ScriptError> {
        let mut names = parameters.iter().map(|(name, _)| name);
        let are_in_axes = names.all(|name| !self.beside_axes.contains(name));
        if !are_in_axes || !self.parsed.vary_axes(script, parameters) {
            *script = self.script(parameters)?;
        }
        Ok(())
    }

    /// The script with these values in place of its own parameters.
    fn script(&self, parameters: &[(String, f64)]) -> Result<Script, ScriptError> {
        let mut guest = |inner: &str| {
            let bytes = self.guests.get(inner).cloned();
            bytes.ok_or_else(|| "it was not there before".to_owned())
        };
        self.parsed.script(parameters, &mut guest, self.terms)
    }
}

/// The text of a file.
///
/// # Errors
/// [`SuiteError::Io`], [`SuiteError::Encoding`].
pub fn read_text(path: &Path) -> Result<String, SuiteError> {
    let bytes = fs::read(path).map_err(SuiteError::io(path))?;
    decoded(bytes).map_err(|(valid, like)| SuiteError::Encoding {
        path: path.to_owned(),
        valid,
        like,
    })
}

/// The text of a file in UTF-8; otherwise the number of valid bytes, and the probable encoding.
fn decoded(bytes: Vec<u8>) -> Result<String, (usize, &'static str)> {
    // Every second byte of plain text in UTF-16 is 0, and a text in UTF-8 has none.
    let zero = bytes.iter().take(4).position(|byte| *byte == 0);
    let is_utf16 = matches!(bytes.as_slice(), [0xFF, 0xFE, ..] | [0xFE, 0xFF, ..]) || zero.is_some();
    String::from_utf8(bytes)
        .map_err(|error| {
            let like = if is_utf16 { UTF16 } else { LATIN1 };
            (error.utf8_error().valid_up_to(), like)
        })
        .and_then(|text| match zero {
            Some(zero) => Err((zero, UTF16)),
            None => Ok(text),
        })
}

const UTF16: &str = "UTF-16, as some editors write Unicode";
const LATIN1: &str = "Latin-1 or Windows-1252";

/// The text of a file that the script at `outer` includes.
pub(crate) fn included(outer: &Path, inner: &str, allowed: &Allowed) -> Result<String, String> {
    let bytes = read_regular(&beside(outer, inner, &allowed.folders, "script")?).map_err(why)?;
    decoded(bytes).map_err(|(_, like)| format!("it is not UTF-8 but looks like {like}; save it as UTF-8"))
}

/// The bytes of a program that the script at `outer` names.
fn module(outer: &Path, inner: &str, allowed: &Allowed) -> Result<Vec<u8>, String> {
    program_file(&beside(outer, inner, &allowed.folders, "script")?)
}

/// The bytes of a program; of a file that is too large only enough to detect this.
pub(crate) fn program_file(path: &Path) -> Result<Vec<u8>, String> {
    // Reading a pipe would block.
    if !fs::metadata(path).map_err(why)?.is_file() {
        return Err("it is no regular file".to_owned());
    }
    let file = fs::File::open(path).map_err(why)?;
    let mut bytes = Vec::new();
    let most = standstill_guest::MODULE_MOST as u64 + 1;
    file.take(most).read_to_end(&mut bytes).map_err(why)?;
    Ok(bytes)
}

/// The system's own path of a file that is named relative to the folder of `outer`, and is in this folder
/// or below, or below one of `allowed`; `what` names `outer` in a message.
///
/// # Errors
/// The reason why it cannot or may not be read, in words that are the same everywhere.
pub fn beside(outer: &Path, inner: &str, allowed: &[PathBuf], what: &str) -> Result<PathBuf, String> {
    let folder = outer.parent().unwrap_or(Path::new(""));
    // The system's own paths of both, so that no link leads outside.
    let real = |path: &Path| {
        fs::canonicalize(if path == Path::new("") {
            Path::new(".")
        } else {
            path
        })
    };
    let file = real(&folder.join(inner)).map_err(why)?;
    let below = |root: &Path| real(root).is_ok_and(|root| file.starts_with(root));
    if !below(folder) && !allowed.iter().any(|root| below(root)) {
        return Err(format!(
            "it lies outside the {what}'s folder; `--include-from` allows another one, `--allow-outside` all"
        ));
    }
    Ok(file)
}

fn why(error: io::Error) -> String {
    match error.kind() {
        io::ErrorKind::NotFound => "there is no such file".to_owned(),
        io::ErrorKind::InvalidData => "it is not UTF-8".to_owned(),
        _ => error.to_string(),
    }
}

/// All scan scripts and machine files in a folder, found like those of [`find`].
///
/// # Errors
/// A folder that cannot be read.
pub fn find_texts(path: &Path) -> Result<Vec<PathBuf>, SuiteError> {
    find_ending(path, &[EXTENSION, MACHINE_EXTENSION])
}

/// All scan scripts in a folder and the folders in it, sorted by path. A path that is a file is taken unchanged.
///
/// # Errors
/// A folder that cannot be read.
pub fn find(path: &Path) -> Result<Vec<PathBuf>, SuiteError> {
    find_ending(path, &[EXTENSION])
}

fn find_ending(path: &Path, endings: &[&str]) -> Result<Vec<PathBuf>, SuiteError> {
    if !path.is_dir() {
        fs::metadata(path).map_err(SuiteError::io(path))?;
        return Ok(vec![path.to_owned()]);
    }
    let mut files = walk(path)?;
    files.retain(|file| endings.iter().any(|ending| stem(file, ending).is_some()));
    Ok(files)
}

/// Goldens and proposals in a folder whose script no longer exists, sorted by path. Snapshots that
/// `insta` keeps for other tests are not among them.
///
/// # Errors
/// A folder that cannot be read.
pub fn orphans(folder: &Path) -> Result<Vec<PathBuf>, SuiteError> {
    let files = walk(folder)?;
    // A script of another name also has a golden if a test of its own judges it.
    let has_script = |stem: &str| {
        let is_there = |ending| {
            files
                .binary_search(&PathBuf::from(format!("{stem}{ending}")))
                .is_ok()
        };
        [EXTENSION, ".json"].into_iter().any(is_there)
    };
    let lonely = |file: &Path| {
        COMPANIONS
            .iter()
            .any(|ending| stem(file, ending).is_some_and(|stem| !has_script(&stem)))
            && !is_of_another_test(file)
    };
    Ok(files.iter().filter(|file| lonely(file)).cloned().collect())
}

/// A snapshot whose header names a source that is no scan script.
fn is_of_another_test(file: &Path) -> bool {
    // The header is at the top; a file that cannot be read is no snapshot.
    const HEADER: u64 = 4096;
    let text = begin(file, HEADER).unwrap_or_default();
    let Some(header) = text.strip_prefix("---\n") else {
        return false;
    };
    let mut lines = header.lines().take_while(|line| *line != "---");
    let source = lines.find_map(|line| line.strip_prefix("source: "));
    source.is_some_and(|source| !source.trim_matches('"').ends_with(EXTENSION))
}

/// Files in a folder that look like scan scripts except for their names, sorted by path: they are not
/// tested.
///
/// # Errors
/// A folder that cannot be read.
pub fn overlooked(folder: &Path) -> Result<Vec<PathBuf>, SuiteError> {
    let mut files = walk(folder)?;
    files.retain(|file| {
        let name = file.file_name().map(|name| name.to_string_lossy().to_lowercase());
        let name = name.unwrap_or_default();
        let is_near = name.ends_with(".json") || name.contains(".scan.");
        let is_known = [
            EXTENSION,
            MACHINE_EXTENSION,
            ".schema.json",
            ".snap",
            ".new",
            ".exact",
        ]
        .iter()
        .any(|ending| name.ends_with(ending));
        is_near && !is_known && looks_like_a_script(file)
    });
    Ok(files)
}

/// Whether the begin of a file has the keys of a script.
fn looks_like_a_script(file: &Path) -> bool {
    let text = begin(file, LOOKED_AT).unwrap_or_default();
    let has = |key: &str| text.contains(&format!("\"{key}\""));
    ["standstill", "cycle", "scans"].into_iter().all(has)
}

/// The first bytes of a file as text.
fn begin(file: &Path, most: u64) -> io::Result<String> {
    let mut bytes = Vec::new();
    fs::File::open(file)?.take(most).read_to_end(&mut bytes)?;
    Ok(String::from_utf8_lossy(&bytes).into_owned())
}

/// Bytes of a file that are read to decide whether it is a script.
const LOOKED_AT: u64 = 1 << 16;

/// The name of a script as a test: its path in `folder` without extension.
pub fn name(folder: &Path, script: &Path) -> String {
    let inner = script.strip_prefix(folder).unwrap_or(script);
    stem(inner, EXTENSION).map_or_else(|| shown(inner), |stem| shown(Path::new(&stem)))
}

fn stem(file: &Path, ending: &str) -> Option<String> {
    file.to_str()?.strip_suffix(ending).map(str::to_owned)
}

/// All files below a folder, sorted.
fn walk(folder: &Path) -> Result<Vec<PathBuf>, SuiteError> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).map_err(SuiteError::io(&folder))? {
            let entry = entry.map_err(SuiteError::io(&folder))?;
            let kind = entry.file_type().map_err(SuiteError::io(&folder))?;
            // Links to folders are not followed, because they could form a loop. Pipes and devices are no
            // scripts.
            if kind.is_dir() {
                folders.push(entry.path());
            } else if kind.is_file() || fs::metadata(entry.path()).is_ok_and(|found| found.is_file()) {
                files.push(entry.path());
            }
        }
    }
    files.sort();
    Ok(files)
}

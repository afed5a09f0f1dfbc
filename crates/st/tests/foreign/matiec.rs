//! The location of matiec, for tests of two packages.

use std::env;
use std::path::PathBuf;
use std::process::Command;

/// The message if there is nothing to run.
pub const MISSING: &str =
    "there is no iec2c; matiec is in no package registry, so nothing installs it (docs/porting.md)";

/// The folder in which `iec2c` has its standard functions in Structured Text, with the headers in `C` below it: the
/// folder of `MATIEC_LIB`, or one beside `iec2c` on the PATH. `None` without `iec2c`.
///
/// # Panics
/// If `iec2c` exists, and no such folder.
pub fn library() -> Option<PathBuf> {
    Command::new("iec2c").arg("-v").output().ok()?;
    let path = env::var_os("PATH").unwrap_or_default();
    let beside = env::split_paths(&path)
        .filter(|folder| folder.join("iec2c").exists())
        .flat_map(|folder| {
            ["lib", "../lib", "../lib/matiec", "../share/matiec/lib"].map(|lib| folder.join(lib))
        });
    let named = env::var_os("MATIEC_LIB").map(PathBuf::from);
    let found = named
        .into_iter()
        .chain(beside)
        .find(|lib| lib.join("ieclib.txt").exists());
    Some(found.expect("iec2c is here, but not its library: set MATIEC_LIB to the folder with ieclib.txt"))
}

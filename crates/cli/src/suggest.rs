//! The probable meaning of a misspelt name.

use std::fs;
use std::path::{Path, PathBuf};

/// The candidate nearest to `name` without regard to case, if one slip in three letters explains it.
pub fn nearest<'a>(name: &str, candidates: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let wanted = name.to_ascii_lowercase();
    let slips = (wanted.chars().count() / 3).max(1);
    candidates
        .map(|candidate| {
            (
                strsim::osa_distance(&wanted, &candidate.to_ascii_lowercase()),
                candidate,
            )
        })
        .filter(|(distance, _)| *distance <= slips)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

/// An existing file or folder that a missing path probably means: its first missing part is compared with
/// the names in that folder.
pub fn beside(path: &Path) -> Option<PathBuf> {
    let parts: Vec<_> = path.components().collect();
    let mut sound = PathBuf::new();
    for (at, part) in parts.iter().enumerate() {
        let next = sound.join(part);
        if next.symlink_metadata().is_ok() {
            sound = next;
            continue;
        }
        let folder = if at == 0 { Path::new(".") } else { &sound };
        let names: Vec<String> = fs::read_dir(folder)
            .ok()?
            .flatten()
            .filter_map(|entry| entry.file_name().into_string().ok())
            .collect();
        let wanted = part.as_os_str().to_str()?;
        let found = sound.join(nearest(wanted, names.iter().map(String::as_str))?);
        let whole = parts[at + 1..].iter().fold(found, |path, part| path.join(part));
        return whole.exists().then_some(whole);
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slips_are_forgiven_and_other_words_are_not() {
        let known = ["velocity", "jerk", "snap"];
        assert_eq!(nearest("velocty", known.into_iter()), Some("velocity"));
        assert_eq!(nearest("JERK", known.into_iter()), Some("jerk"));
        assert_eq!(nearest("sanp", known.into_iter()), Some("snap"));
        assert_eq!(nearest("torque", known.into_iter()), None);
    }
}

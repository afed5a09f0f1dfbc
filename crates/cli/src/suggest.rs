//! What a misspelt name was probably meant to be.

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

//! Comparison of the events of two golden texts within a tolerance.

use crate::compare::Tolerance;

/// The lines below the heading `events` of a golden text; empty if it has none.
pub fn events(text: &str) -> &str {
    let below = text.split_once("\nevents\n").map_or("", |(_, below)| below);
    below.split_once("\n\n").map_or(below, |(events, _)| events)
}

/// Whether two golden texts have the same events: the same words in the same lines. Only numbers with a
/// fraction may differ, within the tolerance. Scans, counts of scans and other whole numbers are words.
pub fn same_events(expected: &str, found: &str, tolerance: Tolerance) -> bool {
    let (mut expected, mut found) = (events(expected).lines(), events(found).lines());
    loop {
        match (expected.next(), found.next()) {
            (None, None) => return true,
            (Some(a), Some(b)) if same_line(a, b, tolerance) => {}
            _ => return false,
        }
    }
}

fn same_line(expected: &str, found: &str, tolerance: Tolerance) -> bool {
    let (mut expected, mut found) = (expected.split_whitespace(), found.split_whitespace());
    loop {
        match (expected.next(), found.next()) {
            (None, None) => return true,
            (Some(a), Some(b)) if a == b || same_number(a, b, tolerance) => {}
            _ => return false,
        }
    }
}

/// `Position=4.0` and `4.0;` are numbers with a prefix or suffix, which must be equal.
fn same_number(expected: &str, found: &str, tolerance: Tolerance) -> bool {
    let (Some((before, expected, after)), Some(other)) = (number(expected), number(found)) else {
        return false;
    };
    (before, after) == (other.0, other.2) && tolerance.passes(expected, other.1)
}

/// A word as the text before a number, the number, and the text after it.
fn number(word: &str) -> Option<(&str, f64, &str)> {
    let start = word.find(|c: char| c.is_ascii_digit() || c == '-')?;
    let (before, rest) = word.split_at(start);
    let (number, after) = rest.split_at(rest.trim_end_matches([',', ';', ':', ')']).len());
    // The numbers of texts are in their shortest form, which has a point or an exponent.
    let has_fraction = number.contains(['.', 'e']);
    Some((before, number.parse().ok().filter(|_| has_fraction)?, after))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TOLERANCE: Tolerance = Tolerance {
        absolute: 0.5,
        relative: 0.0,
    };

    fn text(events: &str) -> String {
        format!("title   t\n\nevents\n{events}\n\nset-points of X\n  1 2.0\n")
    }

    #[test]
    fn the_events_are_those_of_their_section() {
        assert_eq!(events(&text("  1  X  a\n  2  X  b")), "  1  X  a\n  2  X  b");
        assert_eq!(events("title t\n"), "");
    }

    #[test]
    fn only_numbers_with_a_fraction_may_differ() {
        let same = |a: &str, b: &str| same_events(&text(a), &text(b), TOLERANCE);
        assert!(same(
            "1  m  +Execute Position=4.0",
            "1  m  +Execute Position=4.25"
        ));
        assert!(same(
            "1  X  plan; from 4.0, snap -1.5e3",
            "1  X  plan; from 4.25, snap -1500.25"
        ));
        for (a, b) in [
            ("1  m  +Execute Position=4.0", "1  m  +Execute Position=4.75"),
            ("1  m  +Execute Position=4.0", "1  m  +Execute Velocity=4.0"),
            ("1  m  +Done", "2  m  +Done"),
            ("1  m  plan in 160 scans", "1  m  plan in 161 scans"),
            ("1  m  ErrorID=116", "1  m  ErrorID=117"),
            ("1  m  from 4.0, to", "1  m  from 4.0; to"),
            ("1  m  +Done", "1  m  +Done\n2  m  -Done"),
            ("1  m  +Done -Busy", "1  m  +Done"),
            ("1  m  -Busy", "1  m  -Done"),
        ] {
            assert!(!same(a, b) && !same(b, a), "{a} {b}");
        }
    }
}

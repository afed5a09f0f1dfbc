//! Numbers as text.

use crate::column::Cell;
use std::fmt::Write;

/// The shortest text that reads back as the same number; NaN and infinities as words, -0.0 as `0.0`.
pub fn shortest(value: f64) -> String {
    if value.is_nan() {
        "NaN".to_owned()
    } else if value.is_infinite() {
        if value > 0.0 { "Infinity" } else { "-Infinity" }.to_owned()
    } else {
        // Room for nearly all numbers, which come in parts.
        let mut text = String::with_capacity(24);
        // Adding 0.0 removes the sign of zero and changes nothing else. Writing to a String cannot fail.
        let _ = write!(text, "{:?}", value + 0.0);
        text
    }
}

/// A number in the form of [`shortest`]. Nothing else is accepted: no `nan`, no `inf`, no blanks, no
/// number too large for an f64.
pub fn parse(text: &str) -> Option<f64> {
    match text {
        "NaN" => Some(f64::NAN),
        "Infinity" => Some(f64::INFINITY),
        "-Infinity" => Some(f64::NEG_INFINITY),
        _ if text
            .bytes()
            .all(|byte| matches!(byte, b'0'..=b'9' | b'.' | b'e' | b'E' | b'+' | b'-')) =>
        {
            text.parse().ok().filter(|value: &f64| value.is_finite())
        }
        _ => None,
    }
}

/// A number for people: six decimals, no -0.000000. If it is too large or not finite, the text of [`shortest`].
pub fn fixed(value: f64) -> String {
    if !value.is_finite() || value.abs() >= 1e9 {
        return shortest(value);
    }
    let text = format!("{value:.6}");
    if text == "-0.000000" {
        "0.000000".to_owned()
    } else {
        text
    }
}

/// The text of a cell in CSV and in event lines.
pub fn cell_text(cell: Cell<'_>) -> String {
    match cell {
        Cell::Bool(true) => "TRUE".to_owned(),
        Cell::Bool(false) => "FALSE".to_owned(),
        Cell::Real(value) => shortest(value),
        Cell::Integer(value) => value.to_string(),
        Cell::Name(text) => text.to_owned(),
    }
}

/// A duration as an IEC TIME literal in the largest unit that keeps it whole.
pub fn time_literal(ns: u64) -> String {
    match ns {
        _ if ns.is_multiple_of(1_000_000_000) => format!("T#{}s", ns / 1_000_000_000),
        _ if ns.is_multiple_of(1_000_000) => format!("T#{}ms", ns / 1_000_000),
        _ if ns.is_multiple_of(1_000) => format!("T#{}us", ns / 1_000),
        _ => format!("T#{ns}ns"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shortest_texts_read_back_to_the_bit() {
        for value in [
            0.1,
            1e21,
            5e-324,
            f64::MAX,
            f64::MIN_POSITIVE,
            -1.0 / 3.0,
            1e-7,
            123_456_789.0,
        ] {
            assert_eq!(
                parse(&shortest(value)).map(f64::to_bits),
                Some(value.to_bits()),
                "{value:?}"
            );
        }
        assert_eq!(shortest(-0.0), "0.0");
        assert_eq!(shortest(f64::NEG_INFINITY), "-Infinity");
        assert!(parse("NaN").is_some_and(f64::is_nan));
        for foreign in ["nan", "inf", "", " 1", "1,5", "0x10", "true", "1e400"] {
            assert_eq!(parse(foreign), None, "{foreign}");
        }
    }

    #[test]
    fn fixed_texts_have_no_negative_zero_and_no_endless_digits() {
        assert_eq!(fixed(-1e-9), "0.000000");
        assert_eq!(fixed(-1.5), "-1.500000");
        assert_eq!(fixed(1e300), "1e300");
    }

    #[test]
    fn cycles_are_written_as_scripts_write_them() {
        assert_eq!(time_literal(1_000_000), "T#1ms");
        assert_eq!(time_literal(250_000), "T#250us");
        assert_eq!(time_literal(2_000_000_000), "T#2s");
    }
}

//! Values of arguments, from text.

use standstill_trace::csv;
use std::path::PathBuf;

/// Reads a time (ns).
pub fn period(text: &str) -> Result<u64, String> {
    let literal = match text.contains('#') {
        true => text.to_owned(),
        false => format!("T#{text}"),
    };
    let known = standstill_script::parse_time(&literal).ok();
    known
        .and_then(|ns| u64::try_from(ns).ok())
        .filter(|ns| *ns > 0)
        .ok_or_else(|| "write a time above 0 with its unit, such as 1ms or 250us".to_owned())
}

/// Reads an axis of a file.
pub fn axis(text: &str) -> Result<(PathBuf, String), String> {
    let named = text.rsplit_once('#');
    named
        .filter(|(file, name)| !file.is_empty() && !name.is_empty())
        .map(|(file, name)| (file.into(), name.to_owned()))
        .ok_or_else(|| "write a file and the name of an axis in it, such as cell.machine.json#S".to_owned())
}

/// Reads a number of bytes.
pub fn size(text: &str) -> Result<u64, String> {
    let units = [("KiB", 1 << 10), ("MiB", 1 << 20), ("GiB", 1_u64 << 30)];
    let unit = units
        .iter()
        .find_map(|(unit, bytes)| Some((text.strip_suffix(unit)?, *bytes)));
    let (number, bytes) = unit.unwrap_or((text, 1));
    let number: Option<u64> = number.parse().ok();
    number
        .and_then(|number| number.checked_mul(bytes))
        .ok_or_else(|| "write a number of bytes, or one with KiB, MiB or GiB, such as 256MiB".to_owned())
}

/// Reads the length of a scan (ns).
pub fn cycle(text: &str) -> Result<i64, String> {
    match standstill_script::parse_time(text) {
        Ok(ns) if ns > 0 => Ok(ns),
        _ => Err("write a time above 0, such as T#1ms".to_owned()),
    }
}

/// Reads a delimiter.
pub fn delimiter(text: &str) -> Result<char, String> {
    let text = if matches!(text, "tab" | "\\t") { "\t" } else { text };
    let mut characters = text.chars();
    match (characters.next(), characters.next()) {
        (Some(one), None) if csv::DELIMITERS.contains(&one) => Ok(one),
        _ => Err("write `,`, `;`, `|` or `tab`".to_owned()),
    }
}

/// Reads a tolerance.
pub fn tolerance(text: &str) -> Result<f64, String> {
    let number: Option<f64> = serde_json::from_str(text).ok();
    number
        .filter(|number| *number >= 0.0)
        .ok_or_else(|| "write a number that is not negative, such as 1e-6".to_owned())
}

/// Reads `NAME=VALUE`; the value is a number as in scripts and traces.
pub fn parameter(text: &str) -> Result<(String, f64), String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE, such as v=60")?;
    if name.is_empty() {
        return Err("the name is missing".to_owned());
    }
    let number = match value {
        "NaN" => Some(f64::NAN),
        "Infinity" => Some(f64::INFINITY),
        "-Infinity" => Some(f64::NEG_INFINITY),
        _ => serde_json::from_str(value).ok(),
    };
    let number = number.ok_or_else(|| format!("`{value}` is no number"))?;
    Ok((name.to_owned(), number))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tolerances_are_finite_and_not_negative() {
        assert_eq!(tolerance("1e-6"), Ok(1e-6));
        assert_eq!(tolerance("0"), Ok(0.0));
        for wrong in ["-1e-9", "NaN", "Infinity", "1e999", "", "1,5", "small"] {
            assert!(tolerance(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn sizes_are_whole_numbers_of_bytes() {
        assert_eq!(size("65536"), Ok(65_536));
        assert_eq!(size("64MiB"), Ok(64 << 20));
        assert_eq!(size("4GiB"), Ok(4 << 30));
        for wrong in ["", "MiB", "-1", "1.5GiB", "4GB", "4 GiB", "99999999999GiB"] {
            assert!(size(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn periods_are_times_above_zero() {
        assert_eq!(period("1ms"), Ok(1_000_000));
        assert_eq!(period("0.25ms"), Ok(250_000));
        assert_eq!(period("T#1s500ms"), Ok(1_500_000_000));
        for wrong in ["", "0ms", "-1ms", "1", "1 ms", "fast", "NaN", "1e3us"] {
            assert!(period(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn parameters_are_numbers_as_scripts_write_them() {
        assert_eq!(parameter("v=-6e1"), Ok(("v".to_owned(), -60.0)));
        assert_eq!(parameter("v=Infinity"), Ok(("v".to_owned(), f64::INFINITY)));
        assert!(parameter("v=NaN").is_ok_and(|(_, value)| value.is_nan()));
        for wrong in ["v", "=1", "v=", "v=inf", "v=1,5", "v=fast", "v=1e999"] {
            assert!(parameter(wrong).is_err(), "{wrong}");
        }
    }
}

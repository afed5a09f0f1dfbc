//! Cells as numbers, times and words.

use super::table::Cell;
use super::{Reading, Unit};
use crate::number;
use crate::read::ReadError;

/// The decimal mark: given, or found from the first number that has one.
pub struct Marks {
    mark: Option<char>,
    /// The line it was found in; `None` if it was given.
    line: Option<usize>,
    /// The first time of all (ns). Ticks since 1601 do not fit in 64 bits of nanoseconds, but their
    /// differences do.
    base: Option<i128>,
}

/// The longest recording (ns), 73 years; sums of two such times do not overflow.
pub const TIME_MAX: i64 = 1 << 61;

impl Marks {
    pub fn new(said: Option<char>, delimiter: char) -> Self {
        // With commas as separators, a decimal comma is possible only in quotes.
        let mark = said.or((delimiter == ',').then_some('.'));
        Self {
            mark,
            line: None,
            base: None,
        }
    }

    pub const fn found(&self) -> Option<char> {
        self.mark
    }

    /// The text of a number with a decimal point.
    fn pointed(&mut self, cell: &Cell<'_>) -> Result<String, ReadError> {
        let marks = || cell.text.chars().filter(|letter| matches!(letter, '.' | ','));
        let Some(mark) = marks().next() else {
            return Ok(cell.text.to_string());
        };
        if marks().count() > 1 {
            return Err(cell.error("more than one decimal mark: export without marks between thousands"));
        }
        let expected = *self.mark.get_or_insert_with(|| {
            self.line = Some(cell.line);
            mark
        });
        if mark != expected {
            let since = match self.line {
                Some(line) => format!("as line {line} has"),
                None => "as the map or the delimiter says".to_owned(),
            };
            let message = format!("`{mark}` where decimals stand behind `{expected}`, {since}");
            return Err(cell.error(&message));
        }
        Ok(cell.text.replace(',', "."))
    }

    pub fn number(&mut self, cell: &Cell<'_>) -> Result<f64, ReadError> {
        number::parse(&self.pointed(cell)?)
            .filter(|value| value.is_finite())
            .ok_or_else(|| cell.error("no finite number"))
    }

    /// A time in nanoseconds since the first one that was read, exact down to the nanosecond.
    pub fn time(&mut self, cell: &Cell<'_>, unit: Unit) -> Result<i64, ReadError> {
        let text = self.pointed(cell)?;
        let ns = nanoseconds(&text, unit).ok_or_else(|| cell.error("no time: a number is needed"))?;
        let base = *self.base.get_or_insert(ns);
        i64::try_from(ns - base)
            .ok()
            .filter(|ns| ns.abs() < TIME_MAX)
            .ok_or_else(|| cell.error("more than 73 years lie between this time and the first"))
    }

    /// A value that stays until it changes, in the form of traces.
    pub fn step(&mut self, cell: &Cell<'_>, reading: &Reading) -> Result<String, ReadError> {
        match reading {
            Reading::Curve | Reading::Whole => {
                let value = self.number(cell)?;
                // Casts saturate; the comparison accepts only numbers that did not change.
                let whole = value as i64;
                if whole as f64 == value {
                    Ok(whole.to_string())
                } else {
                    Err(cell.error("no whole number"))
                }
            }
            Reading::Bool => {
                let truth = match cell.text.to_ascii_uppercase().as_str() {
                    "TRUE" => Some(true),
                    "FALSE" => Some(false),
                    _ => match self.number(cell) {
                        Ok(1.0) => Some(true),
                        Ok(0.0) => Some(false),
                        _ => None,
                    },
                };
                let truth = truth.ok_or_else(|| cell.error("neither TRUE nor FALSE, neither 1 nor 0"))?;
                Ok(if truth { "TRUE" } else { "FALSE" }.to_owned())
            }
            Reading::Word(words) => {
                let text = cell.text.as_ref();
                if words.is_empty() {
                    return Ok(text.to_owned());
                }
                let word = words.get(text);
                word.cloned()
                    .ok_or_else(|| cell.error("the map's `values` do not say what this stands for"))
            }
        }
    }
}

/// Whether a cell could be a number, with either decimal mark.
pub fn is_number(text: &str) -> bool {
    number::parse(&text.replacen(',', ".", 1)).is_some()
}

/// The nanoseconds of a decimal number; fractions of one are cut off.
fn nanoseconds(text: &str, unit: Unit) -> Option<i128> {
    let zeros = match unit {
        Unit::Seconds => 9,
        Unit::Milliseconds => 6,
        Unit::Microseconds => 3,
        Unit::Ticks => 2,
        Unit::Nanoseconds => 0,
    };
    let (digits, exponent) = match text.split_once(['e', 'E']) {
        Some((digits, exponent)) => (digits, exponent.parse::<i32>().ok()?),
        None => (text, 0),
    };
    let (sign, digits) = match digits.strip_prefix('-') {
        Some(digits) => (-1, digits),
        None => (1, digits.strip_prefix('+').unwrap_or(digits)),
    };
    let (whole, decimals) = digits.split_once('.').unwrap_or((digits, ""));
    let all = format!("{whole}{decimals}");
    // 36 digits fit in 128 bits.
    if all.is_empty() || all.len() > 36 || !all.bytes().all(|byte| byte.is_ascii_digit()) {
        return None;
    }
    let mut value: i128 = all.parse().ok()?;
    let mut shift = exponent
        .checked_add(zeros)?
        .checked_sub(i32::try_from(decimals.len()).ok()?)?;
    // Every step brings the value nearer to its bound or to zero, so it ends within 39 of them.
    while shift > 0 && value != 0 {
        value = value.checked_mul(10)?;
        shift -= 1;
    }
    while shift < 0 && value != 0 {
        value /= 10;
        shift += 1;
    }
    // The difference of two such values does not overflow.
    (value < 1 << 120).then_some(sign * value)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_exact_nanoseconds() {
        for (text, unit, ns) in [
            ("0", Unit::Seconds, 0),
            ("0.001", Unit::Seconds, 1_000_000),
            ("-1.5", Unit::Milliseconds, -1_500_000),
            ("1e-3", Unit::Seconds, 1_000_000),
            ("2.5E+1", Unit::Microseconds, 25_000),
            ("12.0009", Unit::Nanoseconds, 12),
            ("133612345678900001", Unit::Ticks, 13_361_234_567_890_000_100),
        ] {
            assert_eq!(nanoseconds(text, unit), Some(ns), "{text}");
        }
        for text in ["", ".", "1e", "1e99", "12:00", "1e9999999999"] {
            assert_eq!(nanoseconds(text, Unit::Seconds), None, "{text}");
        }
    }
}

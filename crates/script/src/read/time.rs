//! TIME literals of IEC 61131-3: `T#14ms`, `TIME#1h_30m`, `t#2.5s`.

/// The units, largest first: name, nanoseconds, and the number of it in the next larger unit.
const UNITS: [(&str, i64, i64); 7] = [
    ("d", 86_400_000_000_000, i64::MAX),
    ("h", 3_600_000_000_000, 24),
    ("m", 60_000_000_000, 60),
    ("s", 1_000_000_000, 60),
    ("ms", 1_000_000, 1_000),
    ("us", 1_000, 1_000),
    ("ns", 1, 1_000),
];

/// The nanoseconds of a literal, or the reason why it is invalid. Case does not matter. Only the last
/// unit may have a fraction, and only the first may exceed its range (`T#25h`). Exact: nothing is
/// rounded.
///
/// # Errors
/// The reason why it is invalid, as the end of a sentence.
pub fn parse(text: &str) -> Result<i64, &'static str> {
    const TOO_LARGE: &str = "it does not fit in 64 bits of nanoseconds";
    let lower = text.to_ascii_lowercase();
    let body = ["t#", "time#", "lt#", "ltime#"]
        .iter()
        .find_map(|prefix| lower.strip_prefix(prefix))
        .ok_or("it must begin with T#")?;
    let (negative, body) = match body.strip_prefix('-') {
        Some(body) => (true, body),
        None => (false, body),
    };
    let mut rest = body;
    let mut total = 0_i64;
    let mut next_unit = 0;
    let mut fraction_seen = false;
    while !rest.is_empty() {
        if next_unit > 0 {
            rest = rest.strip_prefix('_').unwrap_or(rest);
        }
        if fraction_seen {
            return Err("only its last unit may have a fraction");
        }
        let (whole, fraction, unit, after) = part(rest)?;
        let index = UNITS
            .iter()
            .position(|(name, ..)| *name == unit)
            .ok_or("its units are d, h, m, s, ms, us, ns")?;
        if index < next_unit {
            return Err("its units must stand from the largest to the smallest, each once");
        }
        let (_, size, range) = UNITS[index];
        let count: i64 = whole.parse().map_err(|_| TOO_LARGE)?;
        if next_unit > 0 && count >= range {
            return Err("only its first unit may exceed its range");
        }
        let part = count.checked_mul(size).ok_or(TOO_LARGE)?;
        total = total.checked_add(part).ok_or(TOO_LARGE)?;
        total = total.checked_add(fraction_ns(fraction, size)?).ok_or(TOO_LARGE)?;
        fraction_seen = !fraction.is_empty();
        next_unit = index + 1;
        rest = after;
    }
    if next_unit == 0 {
        return Err("a number with a unit must follow T#");
    }
    Ok(if negative { -total } else { total })
}

/// Splits `12.5ms_..` into `12`, `5` (without trailing zeros), `ms` and the rest.
fn part(text: &str) -> Result<(String, &str, &str, &str), &'static str> {
    let split = |text: &str, is_part: fn(char) -> bool| text.find(|c| !is_part(c)).unwrap_or(text.len());
    let (whole, rest) = text.split_at(split(text, |c| c.is_ascii_digit() || c == '_'));
    if whole.is_empty() || whole.starts_with('_') || whole.ends_with('_') || whole.contains("__") {
        return Err("it is made of numbers with units, such as T#1s_500ms");
    }
    let (fraction, rest) = match rest.strip_prefix('.') {
        None => ("", rest),
        Some(rest) => {
            let (fraction, rest) = rest.split_at(split(rest, |c| c.is_ascii_digit()));
            if fraction.is_empty() {
                return Err("a digit must stand on both sides of its point");
            }
            (fraction.trim_end_matches('0'), rest)
        }
    };
    let (unit, rest) = rest.split_at(split(rest, |c| c.is_ascii_alphabetic()));
    Ok((whole.replace('_', ""), fraction, unit, rest))
}

/// The nanoseconds of the decimals `fraction` of a unit of `size` ns.
fn fraction_ns(fraction: &str, size: i64) -> Result<i64, &'static str> {
    const NOT_WHOLE: &str = "it is no whole number of nanoseconds";
    let mut numerator = i128::from(size);
    let mut total = 0_i128;
    // A day has 14 zeros and a few factors of two and five: no whole result has more decimals than this.
    if fraction.len() > 24 {
        return Err(NOT_WHOLE);
    }
    let mut scale = 1_i128;
    for digit in fraction.bytes() {
        total = total * 10 + i128::from(digit - b'0');
        scale *= 10;
    }
    numerator = total.checked_mul(numerator).ok_or(NOT_WHOLE)?;
    if numerator % scale != 0 {
        return Err(NOT_WHOLE);
    }
    i64::try_from(numerator / scale).map_err(|_| NOT_WHOLE)
}

/// The shortest literal in one unit, `T#501ms`; smaller than a second in ms, us or ns.
pub(crate) fn literal(ns: i64) -> String {
    let (name, size, _) = UNITS[4..]
        .iter()
        .find(|(_, size, _)| ns % size == 0)
        .unwrap_or(&UNITS[6]);
    format!("T#{}{name}", ns / size)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn literals_of_the_standard_are_exact() {
        for (text, ns) in [
            ("T#14ms", 14_000_000),
            ("TIME#1d2h3m4s5ms", 93_784_005_000_000),
            ("t#14.7s", 14_700_000_000),
            ("T#-14ms", -14_000_000),
            ("T#25h_15m", 90_900_000_000_000),
            ("LTIME#1us5ns", 1_005),
            ("T#62.5us", 62_500),
            ("T#0s", 0),
            ("T#1_000ms", 1_000_000_000),
            ("T#1.500s", 1_500_000_000),
        ] {
            assert_eq!(parse(text), Ok(ns), "{text}");
        }
    }

    #[test]
    fn what_is_no_literal_says_why() {
        for text in [
            "",
            "14ms",
            "T#",
            "T#ms",
            "T#14",
            "T#1.5s500ms",
            "T#500ms1s",
            "T#1s1s",
            "T#1h75m",
            "T#1x",
            "T#0.5ns",
            "T#0.00000001157407407407d",
            "T#1.s",
            "T#.5s",
            "T#1__0ms",
            "T#9999999999999d",
            "T#+1ms",
            "T#1 ms",
            "T#1s_",
            "T#é",
        ] {
            assert!(parse(text).is_err(), "{text}");
        }
    }

    #[test]
    fn literals_are_written_in_the_largest_unit_that_fits() {
        assert_eq!(literal(501_000_000), "T#501ms");
        assert_eq!(literal(62_500), "T#62500ns");
        assert_eq!(literal(62_000), "T#62us");
        assert_eq!(literal(0), "T#0ms");
        for ns in [1, 999, 62_500, 1_000_000, 5_000_000_000] {
            assert_eq!(parse(&literal(ns)), Ok(ns));
        }
    }
}

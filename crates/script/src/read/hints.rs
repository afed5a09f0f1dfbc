//! Remedies for newcomers' mistakes that are not misspellings.

/// Keys of other systems, and their names here.
const KEYS: [(&str, &str); 22] = [
    ("before", "by"),
    ("until", "by"),
    ("deadline", "by"),
    ("eventually", "by"),
    ("scan", "at"),
    ("time", "at"),
    ("then", "that"),
    ("expect", "that"),
    ("assert", "that"),
    ("globally", "always"),
    ("forall", "always"),
    ("if", "when"),
    ("start", "from"),
    ("end", "to"),
    (">=", "ge"),
    ("<=", "le"),
    (">", "gt"),
    ("<", "lt"),
    ("!=", "ne"),
    ("<>", "ne"),
    ("tolerance", "within"),
    ("approx", "near"),
];

/// The remedy for a key that has another name here.
pub(super) fn key<'a>(key: &str, mut known: impl Iterator<Item = &'a str>) -> Option<String> {
    let word = key.trim().to_ascii_lowercase();
    if matches!(word.as_str(), "=" | "==" | "eq" | "equals") && known.any(|known| known == "ge") {
        return Some("for equality write the value itself: {\"X.Position\": 20}".to_owned());
    }
    let (_, meant) = KEYS.iter().find(|(other, _)| *other == word)?;
    known
        .any(|known| known == *meant)
        .then(|| format!("`{meant}` is what it is called here"))
}

/// A required key with a value, for a reader who does not know its form.
pub(super) fn example(key: &str) -> Option<&'static str> {
    match key {
        "limits" => Some("\"limits\": {\"velocity\": 100, \"acceleration\": 1000}"),
        _ => None,
    }
}

/// The remedy for logic in a string where a wire or a signal is expected.
pub(super) fn logic(text: &str) -> Option<String> {
    let words: Vec<&str> = text.split_whitespace().collect();
    let is = |word: &str, names: &[&str]| names.iter().any(|name| name.eq_ignore_ascii_case(word));
    let parts = |names: &[&str]| {
        let parts: Vec<String> = words
            .split(|word| is(word, names))
            .map(|part| format!("\"{}\"", part.join(" ")))
            .collect();
        parts.join(", ")
    };
    let (not, and, or) = (["NOT", "!"], ["AND", "&", "&&"], ["OR", "|", "||"]);
    if words.iter().any(|word| is(word, &and)) {
        return Some(format!("write {{\"all\": [{}]}}", parts(&and)));
    }
    if words.iter().any(|word| is(word, &or)) {
        return Some(format!("write {{\"any\": [{}]}}", parts(&or)));
    }
    match words.as_slice() {
        [first, rest @ ..] if !rest.is_empty() && is(first, &not) => {
            Some(format!("write {{\"not\": \"{}\"}}", rest.join(" ")))
        }
        [only] => {
            let rest = only.strip_prefix('!').filter(|rest| !rest.is_empty())?;
            Some(format!("write {{\"not\": \"{rest}\"}}"))
        }
        _ => None,
    }
}

/// The remedy for a number in a string, or in a form that JSON does not have.
pub(super) fn number(text: &str) -> Option<String> {
    let plain = |text: &str| text.trim().parse::<f64>().is_ok_and(f64::is_finite);
    if plain(text) {
        return Some(format!("write {text} without quotes"));
    }
    let point = text.replacen(',', ".", 1);
    if text.contains(',') && plain(&point) {
        return Some(format!("write {point}: with a decimal point, without quotes"));
    }
    if let Some(value) = typed(text) {
        return Some(format!("write {value}: a number has no type and no quotes here"));
    }
    for (sign, key) in [
        (">=", "ge"),
        ("<=", "le"),
        ("<>", "ne"),
        ("!=", "ne"),
        (">", "gt"),
        ("<", "lt"),
    ] {
        if let Some(rest) = text.trim().strip_prefix(sign)
            && plain(rest)
        {
            return Some(format!("write {{\"{key}\": {}}}", rest.trim()));
        }
    }
    None
}

/// The value of an IEC literal with its type, `LREAL#4.0`, if JSON has the same value.
pub(super) fn typed(text: &str) -> Option<&str> {
    let (name, value) = text.split_once('#')?;
    let is_type = name.chars().all(|letter| letter.is_ascii_alphabetic())
        && !matches!(name.to_ascii_uppercase().as_str(), "T" | "TIME" | "LT" | "LTIME");
    let known = value.parse::<f64>().is_ok_and(f64::is_finite);
    (is_type && known).then_some(value)
}

/// The remedy for a word where TRUE or FALSE is expected.
pub(super) fn truth(text: &str) -> Option<&'static str> {
    let word = text.rsplit('#').next().unwrap_or(text).trim();
    match word.to_ascii_uppercase().as_str() {
        "TRUE" | "1" => Some("write true, without quotes"),
        "FALSE" | "0" => Some("write false, without quotes"),
        _ => None,
    }
}

/// How to read a signal of an axis where only blocks and variables can be read.
pub(super) fn axis_signal(signal: &str) -> &'static str {
    let word = signal.split('.').next().unwrap_or_default();
    match word.to_ascii_lowercase().as_str() {
        "position" | "actualposition" => {
            "a wire reads an axis through a block: give MC_ReadActualPosition a name, and read its Position"
        }
        "velocity" => {
            "a wire reads an axis through a block: give MC_ReadActualVelocity a name, and read its Velocity"
        }
        "state" => {
            "a wire reads an axis through a block: give MC_ReadStatus a name, and read its Standstill, ErrorStop, .."
        }
        _ => "a wire reads an axis through a block, such as MC_ReadStatus or MC_ReadActualPosition",
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn logic_in_a_string_becomes_a_wire() {
        let hint = |text| logic(text).unwrap_or_default();
        assert_eq!(hint("NOT there.Done"), r#"write {"not": "there.Done"}"#);
        assert_eq!(hint("!a"), r#"write {"not": "a"}"#);
        assert_eq!(hint("a AND b.Q and c"), r#"write {"all": ["a", "b.Q", "c"]}"#);
        assert_eq!(hint("a || b"), r#"write {"any": ["a", "b"]}"#);
        for plain in ["there.Done", "a b", "NOT", "", "android"] {
            assert_eq!(logic(plain), None, "{plain}");
        }
    }

    #[test]
    fn numbers_from_elsewhere_become_numbers_of_json() {
        let hint = |text| number(text).unwrap_or_default();
        assert_eq!(hint("4.5"), "write 4.5 without quotes");
        assert_eq!(hint("4,5"), "write 4.5: with a decimal point, without quotes");
        assert_eq!(
            hint("LREAL#4.0"),
            "write 4.0: a number has no type and no quotes here"
        );
        assert_eq!(hint(">= 5"), r#"write {"ge": 5}"#);
        for other in ["T#5ms", "fast", "1,2,3"] {
            assert_eq!(number(other), None, "{other}");
        }
    }

    #[test]
    fn keys_from_elsewhere_have_a_name_here() {
        let claims = || ["at", "by", "always"].into_iter();
        assert_eq!(
            key("before", claims()).as_deref(),
            Some("`by` is what it is called here")
        );
        assert_eq!(
            key(">=", ["ge", "le"].into_iter()).as_deref(),
            Some("`ge` is what it is called here")
        );
        assert_eq!(key("before", ["cycle"].into_iter()), None);
    }
}

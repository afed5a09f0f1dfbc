//! Names: which are permitted, what they refer to, and which one was probably meant.

use standstill_fb::{BlockInfo, PinType};
use std::collections::BTreeMap;

/// Keywords of IEC 61131-3 and the elementary type names, sorted. No axis, input or instance may have such a name.
pub(crate) const KEYWORDS: &[&str] = &[
    "ABSTRACT",
    "ACTION",
    "AND",
    "ARRAY",
    "AT",
    "BOOL",
    "BY",
    "BYTE",
    "CASE",
    "CHAR",
    "CLASS",
    "CONFIGURATION",
    "CONSTANT",
    "CONTINUE",
    "DATE",
    "DATE_AND_TIME",
    "DINT",
    "DO",
    "DT",
    "DWORD",
    "ELSE",
    "ELSIF",
    "EN",
    "END_ACTION",
    "END_CASE",
    "END_CLASS",
    "END_CONFIGURATION",
    "END_FOR",
    "END_FUNCTION",
    "END_FUNCTION_BLOCK",
    "END_IF",
    "END_INTERFACE",
    "END_METHOD",
    "END_NAMESPACE",
    "END_PROGRAM",
    "END_REPEAT",
    "END_RESOURCE",
    "END_STEP",
    "END_STRUCT",
    "END_TRANSITION",
    "END_TYPE",
    "END_VAR",
    "END_WHILE",
    "ENO",
    "EXIT",
    "EXTENDS",
    "FALSE",
    "FINAL",
    "FOR",
    "FUNCTION",
    "FUNCTION_BLOCK",
    "F_EDGE",
    "IF",
    "IMPLEMENTS",
    "INITIAL_STEP",
    "INT",
    "INTERFACE",
    "INTERNAL",
    "INTERVAL",
    "LDATE",
    "LDT",
    "LINT",
    "LREAL",
    "LTIME",
    "LTOD",
    "LWORD",
    "METHOD",
    "MOD",
    "NAMESPACE",
    "NON_RETAIN",
    "NOT",
    "NULL",
    "OF",
    "ON",
    "OR",
    "OVERLAP",
    "OVERRIDE",
    "PRIORITY",
    "PRIVATE",
    "PROGRAM",
    "PROTECTED",
    "PUBLIC",
    "READ_ONLY",
    "READ_WRITE",
    "REAL",
    "REF",
    "REF_TO",
    "REPEAT",
    "RESOURCE",
    "RETAIN",
    "RETURN",
    "R_EDGE",
    "SINGLE",
    "SINT",
    "STEP",
    "STRING",
    "STRUCT",
    "SUPER",
    "TASK",
    "THEN",
    "THIS",
    "TIME",
    "TIME_OF_DAY",
    "TO",
    "TOD",
    "TRANSITION",
    "TRUE",
    "TYPE",
    "UDINT",
    "UINT",
    "ULINT",
    "UNTIL",
    "USING",
    "USINT",
    "VAR",
    "VAR_ACCESS",
    "VAR_CONFIG",
    "VAR_EXTERNAL",
    "VAR_GLOBAL",
    "VAR_INPUT",
    "VAR_IN_OUT",
    "VAR_OUTPUT",
    "VAR_TEMP",
    "WCHAR",
    "WHILE",
    "WITH",
    "WORD",
    "WSTRING",
    "XOR",
];

/// The reason why `name` is not an IEC 61131-3 identifier that may be declared.
pub(crate) fn identifier_error(name: &str) -> Option<&'static str> {
    let legal_first = name.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_');
    let legal_rest = name.bytes().all(|b| b.is_ascii_alphanumeric() || b == b'_');
    if !legal_first || !legal_rest {
        return Some("a name is a letter or `_`, then letters, digits and `_`");
    }
    if name.ends_with('_') || name.contains("__") {
        return Some("no two `_` may stand together, and none at the end");
    }
    let capitals = || name.bytes().map(|byte| byte.to_ascii_uppercase());
    if KEYWORDS
        .binary_search_by(|word| word.bytes().cmp(capitals()))
        .is_ok()
    {
        return Some("it is a keyword of IEC 61131-3");
    }
    None
}

/// The item that a name of the script refers to; the number is its index among its kind.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Entity {
    Axis(usize),
    /// With its type: BOOL or LREAL, unknown if its initial value was refused.
    Input(usize, Option<PinType>),
    /// With its table, unknown if its type was refused.
    Block(usize, Option<&'static BlockInfo>),
    /// A guest program.
    Program(usize),
}

/// All names of a script. Like IEC 61131-3 it does not distinguish case.
#[derive(Debug, Default)]
pub(crate) struct Names {
    by_name: BTreeMap<String, (String, Entity)>,
}

impl Names {
    /// Adds `name`, unless it is already in use.
    pub(crate) fn add(&mut self, name: &str, entity: Entity) {
        self.by_name
            .entry(name.to_ascii_uppercase())
            .or_insert_with(|| (name.to_owned(), entity));
    }

    pub(crate) fn get(&self, name: &str) -> Option<Entity> {
        self.by_name
            .get(&name.to_ascii_uppercase())
            .map(|(_, entity)| *entity)
    }

    /// The names as written of all items that `filter` accepts.
    pub(crate) fn of(&self, filter: fn(&Entity) -> bool) -> impl Iterator<Item = &str> + Clone {
        self.by_name
            .values()
            .filter(move |(_, entity)| filter(entity))
            .map(|(name, _)| name.as_str())
    }
}

/// Longest name (characters) that is checked for misspellings.
const NAME_WITH_SLIPS: usize = 100;

/// The remedy for a name that is nearly one of `candidates`.
pub(crate) fn nearest<'a>(name: &str, candidates: impl Iterator<Item = &'a str>) -> Option<String> {
    let wanted = name.to_ascii_lowercase();
    let length = wanted.chars().count();
    // The work grows with the product of the lengths, and a long name with one wrong letter is unlikely.
    if length > NAME_WITH_SLIPS {
        return None;
    }
    // One wrong letter in three still gives a guess; so does one in a word of less than three letters. A different
    // single letter gives none.
    let slips = if length < 2 { 0 } else { (length / 3).max(1) };
    candidates
        .filter(|candidate| candidate.len() <= 8 * NAME_WITH_SLIPS)
        .map(|candidate| {
            (
                strsim::damerau_levenshtein(&wanted, &candidate.to_ascii_lowercase()),
                candidate,
            )
        })
        .min_by_key(|(distance, _)| *distance)
        .filter(|(distance, _)| *distance <= slips)
        .map(|(_, candidate)| format!("did you mean `{candidate}`?"))
}

/// The remedy for a name that is not among `candidates`: the nearest one, otherwise all if they are few.
pub(crate) fn suggestion<'a>(name: &str, candidates: impl Iterator<Item = &'a str>) -> Option<String> {
    const LISTED: usize = 12;
    let candidates: Vec<&str> = candidates.collect();
    nearest(name, candidates.iter().copied()).or_else(|| match candidates.as_slice() {
        [] => None,
        [only] => Some(format!("there is only `{only}`")),
        all if all.len() <= LISTED => {
            let all: Vec<String> = all.iter().map(|candidate| format!("`{candidate}`")).collect();
            Some(format!("one of {}", all.join(", ")))
        }
        _ => None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keywords_are_sorted_and_refused_in_any_case() {
        assert!(KEYWORDS.is_sorted());
        assert!(identifier_error("Step").is_some());
        for good in ["X", "_x", "axis_1", "StepOn", "GO"] {
            assert_eq!(identifier_error(good), None, "{good}");
        }
        for bad in ["", "1x", "a b", "a__b", "a_", "ä", "a.b", "_"] {
            assert!(identifier_error(bad).is_some(), "{bad}");
        }
    }

    #[test]
    fn suggestions_forgive_slips_but_do_not_guess_wildly() {
        let pins = ["Execute", "Position", "Velocity"];
        let suggest = |name| suggestion(name, pins.into_iter());
        assert_eq!(suggest("Exceute").as_deref(), Some("did you mean `Execute`?"));
        assert_eq!(suggest("velocty").as_deref(), Some("did you mean `Velocity`?"));
        assert_eq!(
            suggest("Zzz").as_deref(),
            Some("one of `Execute`, `Position`, `Velocity`")
        );
    }
}

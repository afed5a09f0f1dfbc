//! From IEC names to those of C.

use standstill_fb::{BlockInfo, Group};

/// The beginning of all names in C.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Prefix(String);

/// An invalid prefix.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "the prefix is `{0}`: give a C identifier of at most 32 lower-case letters, digits and underscores that begins with a \
     letter, such as `acme`"
)]
pub struct BadPrefix(String);

impl Default for Prefix {
    fn default() -> Self {
        Self("standstill".to_owned())
    }
}

impl Prefix {
    /// # Errors
    /// [`BadPrefix`] unless it is a lower-case C identifier that no compiler reserves.
    pub fn new(text: &str) -> Result<Self, BadPrefix> {
        let good = text.len() <= 32
            && text.starts_with(|letter: char| letter.is_ascii_lowercase())
            && !text.ends_with('_')
            && text
                .chars()
                .all(|letter| letter.is_ascii_lowercase() || letter.is_ascii_digit() || letter == '_');
        if good {
            Ok(Self(text.to_owned()))
        } else {
            Err(BadPrefix(text.to_owned()))
        }
    }

    /// The form for names of functions and types.
    pub fn lower(&self) -> &str {
        &self.0
    }

    /// The form for constants.
    pub fn upper(&self) -> String {
        self.0.to_ascii_uppercase()
    }

    /// A text written for the default prefix, changed to this one.
    pub fn applied(&self, text: &str) -> String {
        text.replace("standstill_", &format!("{}_", self.lower()))
            .replace("STANDSTILL_", &format!("{}_", self.upper()))
            .replace("\"standstill.h\"", &format!("\"{}.h\"", self.lower()))
    }
}

/// `MC_MoveAbsolute` as `mc_move_absolute`.
pub(crate) fn snake(name: &str) -> String {
    let mut out = String::new();
    let mut before = '_';
    for letter in name.chars() {
        let begins_word =
            letter.is_ascii_uppercase() && (before.is_ascii_lowercase() || before.is_ascii_digit());
        if begins_word {
            out.push('_');
        }
        out.push(letter.to_ascii_lowercase());
        before = letter;
    }
    out
}

/// The name of a block's function behind the prefix.
pub(crate) fn function(info: &BlockInfo) -> String {
    snake(info.name)
}

/// The name of a block in systems that already have the blocks of IEC 61131-3: ours then have the prefix.
pub(crate) fn pou(info: &BlockInfo) -> String {
    if info.group == Group::Standard {
        format!("STANDSTILL_{}", info.name)
    } else {
        info.name.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_taken_apart_at_words() {
        for (name, expected) in [
            ("MC_MoveAbsolute", "mc_move_absolute"),
            ("MC_CAMSWITCH_REF", "mc_camswitch_ref"),
            ("mcProbe1Rising", "mc_probe1_rising"),
            ("R_TRIG", "r_trig"),
            ("TON", "ton"),
        ] {
            assert_eq!(snake(name), expected);
        }
    }

    #[test]
    fn a_prefix_is_a_c_identifier_in_lower_case() {
        for good in ["a", "acme", "my_plc2"] {
            assert!(Prefix::new(good).is_ok(), "{good}");
        }
        for bad in ["", "2a", "_a", "a_", "Acme", "a-b", "a b", "ä", "a\n"] {
            let error = Prefix::new(bad).unwrap_err();
            assert!(error.to_string().contains(&format!("`{bad}`")), "{bad}");
        }
        assert!(Prefix::new(&"a".repeat(33)).is_err());
    }
}

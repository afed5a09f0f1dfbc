//! Foreign text for a terminal, a log or a file for people.
//!
//! Titles, units, names, texts of guests and paths come from the author of the script. A control
//! character in them could overwrite the screen. A line break could forge a line. A bidirectional
//! override could show a text in another order than it is read in.

use std::borrow::Cow;

/// `text` as one line with only visible characters: control characters, line and paragraph separators,
/// and those that change the direction of writing become escapes such as `\u{1b}`.
#[must_use]
pub fn printable(text: &str) -> Cow<'_, str> {
    escaped(text, is_hidden)
}

/// As [`printable`], for a text that may have lines.
#[must_use]
pub fn printable_lines(text: &str) -> Cow<'_, str> {
    escaped(text, |character| character != '\n' && is_hidden(character))
}

fn escaped(text: &str, hidden: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&hidden) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 8);
    for character in text.chars() {
        if hidden(character) {
            out.extend(character.escape_unicode());
        } else {
            out.push(character);
        }
    }
    Cow::Owned(out)
}

/// Whether a character has another effect than to be shown.
fn is_hidden(character: char) -> bool {
    character.is_control()
        || matches!(
            character,
            // Line and paragraph separators.
            '\u{2028}' | '\u{2029}'
            // Directions of writing: marks, embeddings, overrides, isolates.
            | '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
        )
}

/// Makes a text [`printable`] in place.
pub(crate) fn make_printable(text: &mut String) {
    if let Cow::Owned(seen) = printable(text) {
        *text = seen;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_does_something_is_shown_and_what_can_be_seen_stays() {
        assert_eq!(printable("a\u{1b}[2Jb\r\n\tc"), "a\\u{1b}[2Jb\\u{d}\\u{a}\\u{9}c");
        assert_eq!(
            printable("\u{202e}x\u{2066}\u{2028}\u{85}\u{7f}\u{9b}"),
            "\\u{202e}x\\u{2066}\\u{2028}\\u{85}\\u{7f}\\u{9b}"
        );
        assert_eq!(printable_lines("a\nb\u{7}\r\n"), "a\nb\\u{7}\\u{d}\n");
        for plain in ["", "Größe (µm), 速度 ≤ 5", "\\u{1b}"] {
            assert!(matches!(printable(plain), Cow::Borrowed(same) if same == plain));
        }
    }
}

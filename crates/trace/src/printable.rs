//! Foreign text for a terminal, a log or a file for people.
//!
//! Titles, units, names, texts of guests and paths come from the author of the script. A control
//! character in them could overwrite the screen. A line break could forge a line. A bidirectional
//! override could show a text in another order than it is read in. Two names that differ in an invisible
//! character would look the same.

use std::borrow::Cow;

/// `text` as one line with only visible characters. Escapes such as `\u{1b}` replace control characters, line and
/// paragraph separators, characters that change the direction of writing, and characters that are not shown.
#[must_use]
pub fn printable(text: &str) -> Cow<'_, str> {
    escaped(text, is_hidden)
}

/// The same as [`printable`], for a text that may have lines.
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

/// Whether a character has an effect other than being shown, or cannot be seen.
fn is_hidden(character: char) -> bool {
    // Most texts are pure ASCII.
    if character.is_ascii() {
        return character.is_ascii_control();
    }
    character.is_control()
        || matches!(
            character,
            // Line and paragraph separators.
            '\u{2028}' | '\u{2029}'
            // Interlinear annotation marks.
            | '\u{fff9}'..='\u{fffb}'
            // Characters for which Unicode lets a font show nothing (Default_Ignorable_Code_Point): joiners, marks
            // without width, directions of writing, fillers, variant selectors, tags.
            | '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{115f}' | '\u{1160}' | '\u{17b4}' | '\u{17b5}'
            | '\u{180b}'..='\u{180f}' | '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{206f}'
            | '\u{3164}' | '\u{fe00}'..='\u{fe0f}' | '\u{feff}' | '\u{ffa0}' | '\u{fff0}'..='\u{fff8}'
            | '\u{1bca0}'..='\u{1bca3}' | '\u{1d173}'..='\u{1d17a}' | '\u{e0000}'..='\u{e0fff}'
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
        assert_eq!(
            printable("s\u{200b}e\u{200d}t\u{feff}\u{e0041}\u{fe0f}\u{ad}"),
            "s\\u{200b}e\\u{200d}t\\u{feff}\\u{e0041}\\u{fe0f}\\u{ad}"
        );
        assert_eq!(printable_lines("a\nb\u{7}\r\n"), "a\nb\\u{7}\\u{d}\n");
        for plain in ["", "Größe (µm), 速度 ≤ 5", "\\u{1b}"] {
            assert!(matches!(printable(plain), Cow::Borrowed(same) if same == plain));
        }
    }
}

//! Places: bytes here, lines and UTF-16 units in the protocol.

use lsp_types::{Position, Range};

/// A text and the begins of its lines.
#[derive(Clone, Debug)]
pub(crate) struct Text {
    text: String,
    /// First bytes of its lines.
    lines: Vec<usize>,
    /// Bytes of a byte order mark, which the compiler and the reader do not count.
    mark: usize,
}

const MARK: char = '\u{FEFF}';

impl Text {
    pub(crate) fn new(text: String) -> Self {
        let starts = text.bytes().zip(1..).filter(|(byte, _)| *byte == b'\n');
        let lines = std::iter::once(0).chain(starts.map(|(_, next)| next)).collect();
        let mark = if text.starts_with(MARK) {
            MARK.len_utf8()
        } else {
            0
        };
        Self { text, lines, mark }
    }

    /// Without a byte order mark.
    pub(crate) fn as_str(&self) -> &str {
        self.text.get(self.mark..).unwrap_or_default()
    }

    /// The byte of [`as_str`](Self::as_str) at a position. A column behind the end of its line is that
    /// end, and one within a character is its begin.
    pub(crate) fn byte(&self, position: Position) -> usize {
        let Some(start) = self.lines.get(position.line as usize).copied() else {
            return self.text.len() - self.mark;
        };
        let line = self.text.get(start..).unwrap_or_default();
        let line = line.split('\n').next().unwrap_or_default().trim_end_matches('\r');
        let mut units = 0;
        let mut bytes = 0;
        for c in line.chars() {
            units += c.len_utf16();
            if units > position.character as usize {
                break;
            }
            bytes += c.len_utf8();
        }
        (start + bytes).saturating_sub(self.mark)
    }

    /// The position of a byte of [`as_str`](Self::as_str).
    pub(crate) fn position(&self, byte: usize) -> Position {
        let mut byte = (byte + self.mark).min(self.text.len());
        while !self.text.is_char_boundary(byte) {
            byte -= 1;
        }
        let line = self
            .lines
            .partition_point(|start| *start <= byte)
            .saturating_sub(1);
        let start = self.lines.get(line).copied().unwrap_or(0);
        let before = self.text.get(start..byte).unwrap_or_default();
        Position {
            line: line as u32,
            character: before.encode_utf16().count() as u32,
        }
    }

    pub(crate) fn range(&self, bytes: std::ops::Range<usize>) -> Range {
        Range {
            start: self.position(bytes.start),
            end: self.position(bytes.end),
        }
    }

    /// The whole text, including a byte order mark.
    pub(crate) fn whole(&self) -> Range {
        Range {
            start: Position::default(),
            end: self.range(0..self.text.len()).end,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn position(line: u32, character: u32) -> Position {
        Position { line, character }
    }

    #[test]
    fn columns_count_utf_16_units() {
        // 1, 2, 3 and 4 bytes; 1, 1, 1 and 2 units.
        let text = Text::new("aä€😀z\r\nb\n".to_owned());
        for (byte, character) in [(0, 0), (1, 1), (3, 2), (6, 3), (10, 5), (11, 6)] {
            assert_eq!(text.position(byte), position(0, character));
            assert_eq!(text.byte(position(0, character)), byte);
        }
        // Within a character, and behind the end of a line.
        assert_eq!(text.byte(position(0, 4)), 6);
        assert_eq!(text.position(8), position(0, 3));
        assert_eq!(text.byte(position(0, 99)), 11);
        assert_eq!(text.byte(position(1, 1)), 14);
        assert_eq!(text.byte(position(7, 0)), text.as_str().len());
        assert_eq!(text.position(999), position(2, 0));
    }

    #[test]
    fn a_byte_order_mark_is_a_character_of_the_editor_only() {
        let text = Text::new("\u{FEFF}ab".to_owned());
        assert_eq!(text.as_str(), "ab");
        assert_eq!(text.position(1), position(0, 2));
        assert_eq!(text.byte(position(0, 2)), 1);
        assert_eq!(text.byte(position(0, 0)), 0);
        assert_eq!(text.whole().end, position(0, 3));
    }
}

//! Strings and their escapes.

use super::Parser;
use crate::error::{Code, Diagnostic};
use crate::model::Span;

impl Parser<'_> {
    /// The string whose opening quote is here.
    pub(super) fn string(&mut self) -> Result<String, Diagnostic> {
        let open = self.at;
        self.at += 1;
        let mut out = String::new();
        while let Some(c) = self.peek() {
            let start = self.at;
            self.at += c.len_utf8();
            match c {
                '"' => {
                    self.last_end = self.at;
                    return Ok(out);
                }
                '\\' => out.push(self.escape(start)?),
                '\n' | '\r' => break,
                c if c < ' ' => {
                    let code = u32::from(c);
                    let span = Span { start, end: self.at };
                    let message = format!("the control character U+{code:04X} inside a string");
                    return Err(
                        Diagnostic::new(Code::Syntax, span, message).help(format!("write \\u{code:04x}"))
                    );
                }
                c => out.push(c),
            }
        }
        let span = Span {
            start: open,
            end: open + 1,
        };
        Err(Diagnostic::new(
            Code::Syntax,
            span,
            "a string without its closing quote on the same line",
        ))
    }

    /// The character of an escape whose backslash is at `start`.
    fn escape(&mut self, start: usize) -> Result<char, Diagnostic> {
        let kind = self.peek();
        self.at += kind.map_or(0, char::len_utf8);
        let plain = match kind {
            Some(c @ ('"' | '\\' | '/')) => Some(c),
            Some('b') => Some('\u{8}'),
            Some('f') => Some('\u{c}'),
            Some('n') => Some('\n'),
            Some('r') => Some('\r'),
            Some('t') => Some('\t'),
            Some('u') => self.unicode_escape(),
            _ => None,
        };
        plain.ok_or_else(|| {
            let span = Span { start, end: self.at };
            Diagnostic::new(Code::Syntax, span, "this is no escape sequence of JSON").help(
                "the escapes are \\\" \\\\ \\/ \\b \\f \\n \\r \\t and \\u with four hexadecimal digits (surrogates in pairs)",
            )
        })
    }

    fn unicode_escape(&mut self) -> Option<char> {
        let first = self.four_hex_digits()?;
        if !(0xD800..0xDC00).contains(&first) {
            return char::from_u32(first);
        }
        if !self.take("\\u") {
            return None;
        }
        let second = self.four_hex_digits()?;
        if !(0xDC00..0xE000).contains(&second) {
            return None;
        }
        char::from_u32(0x1_0000 + ((first - 0xD800) << 10) + (second - 0xDC00))
    }

    fn four_hex_digits(&mut self) -> Option<u32> {
        let digits = self.text.get(self.at..self.at + 4)?;
        if !digits.bytes().all(|b| b.is_ascii_hexdigit()) {
            return None;
        }
        self.at += 4;
        u32::from_str_radix(digits, 16).ok()
    }
}

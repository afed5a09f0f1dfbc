//! Strict JSON (RFC 8259) with the place of every token.
//!
//! Our own reader, because messages need the places of keys and values and the exact reason. Available
//! libraries either give no places or also accept text that strict JSON refuses.

mod string;

use crate::error::{Code, Diagnostic, ScriptError, quoted};
use crate::model::Span;
use crate::read::{hints, without_mark};
use std::collections::BTreeMap;

/// Deepest nesting of objects and lists; scripts need about 8. It bounds the recursion of the reader.
pub(crate) const DEPTH_MAX: usize = 64;

/// A value and its place.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Node {
    pub(crate) span: Span,
    pub(crate) json: Json,
}

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Json {
    Null,
    Bool(bool),
    Number(f64),
    Text(String),
    List(Vec<Node>),
    Map(Vec<(Key, Node)>),
}

/// A key and its place.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Key {
    pub(crate) span: Span,
    pub(crate) text: String,
}

impl Node {
    /// Its members; none if it is no object.
    pub(crate) fn members(&self) -> &[(Key, Self)] {
        match &self.json {
            Json::Map(members) => members,
            _ => &[],
        }
    }

    /// The value of a key, if it is an object that has it.
    pub(crate) fn member(&self, key: &str) -> Option<&Self> {
        let mut members = self.members().iter();
        members.find(|(known, _)| known.text == key).map(|(_, node)| node)
    }

    /// Its text, if it is a string.
    pub(crate) fn text(&self) -> Option<&str> {
        match &self.json {
            Json::Text(text) => Some(text),
            _ => None,
        }
    }
}

impl Json {
    /// Its kind in words.
    pub(crate) fn kind(&self) -> &'static str {
        match self {
            Self::Null => "null",
            Self::Bool(_) => "a bool",
            Self::Number(_) => "a number",
            Self::Text(_) => "a string",
            Self::List(_) => "a list",
            Self::Map(_) => "an object",
        }
    }
}

/// Reads a file, which must hold exactly one value. Also returns its text without a byte order mark: places count from
/// there.
pub(crate) fn file<'t>(text: &'t str, file_name: &str) -> Result<(&'t str, Node), ScriptError> {
    let plain = without_mark(text);
    match parse(plain) {
        Ok(root) => Ok((plain, root)),
        Err(diagnostic) => Err(ScriptError::new(file_name, plain, vec![diagnostic])),
    }
}

/// Reads `text`, which must hold exactly one value.
pub(crate) fn parse(text: &str) -> Result<Node, Diagnostic> {
    let mut parser = Parser {
        text,
        at: 0,
        last_end: 0,
    };
    let node = parser.value(0)?;
    parser.skip_space();
    if parser.at < text.len() {
        return Err(parser
            .unexpected("the end of the file")
            .help("a script is one object; nothing may follow its closing brace"));
    }
    Ok(node)
}

struct Parser<'a> {
    text: &'a str,
    at: usize,
    /// End of the last token: where a missing comma or bracket belongs.
    last_end: usize,
}

impl<'a> Parser<'a> {
    fn rest(&self) -> &'a str {
        &self.text[self.at..]
    }

    fn peek(&self) -> Option<char> {
        self.rest().chars().next()
    }

    fn skip_space(&mut self) {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_start_matches([' ', '\t', '\r', '\n']).len();
    }

    /// Takes `token` if it is here.
    fn take(&mut self, token: &str) -> bool {
        let there = self.rest().starts_with(token);
        if there {
            self.at += token.len();
            self.last_end = self.at;
        }
        there
    }

    fn value(&mut self, depth: usize) -> Result<Node, Diagnostic> {
        self.skip_space();
        if depth > DEPTH_MAX {
            return Err(Diagnostic::new(
                Code::TooDeep,
                self.token(),
                format!("nested more than {DEPTH_MAX} deep"),
            ));
        }
        let start = self.at;
        let json = match self.peek() {
            Some('{') => self.map(depth)?,
            Some('[') => self.list(depth)?,
            Some('"') => Json::Text(self.string()?),
            Some('-' | '0'..='9') => self.number()?,
            _ => self.word()?,
        };
        Ok(Node {
            span: Span { start, end: self.at },
            json,
        })
    }

    fn word(&mut self) -> Result<Json, Diagnostic> {
        let token = self.token();
        let json = match &self.text[token.start..token.end] {
            "null" => Json::Null,
            "true" => Json::Bool(true),
            "false" => Json::Bool(false),
            other => {
                let help = match other.to_ascii_lowercase().as_str() {
                    "true" | "false" => Some(format!("write {} in small letters", other.to_lowercase())),
                    "nan" => Some("write \"NaN\" with quotes".to_owned()),
                    "infinity" | "inf" => Some("write \"Infinity\" or \"-Infinity\" with quotes".to_owned()),
                    _ if other.starts_with('.') => Some("a digit must stand before the point".to_owned()),
                    _ if other.starts_with('+') => Some("a number has no plus sign".to_owned()),
                    _ => hints::typed(other).map(|value| format!("write {value}: a number has no type here")),
                };
                return Err(self.unexpected("a value").maybe_help(help));
            }
        };
        self.at = token.end;
        self.last_end = self.at;
        Ok(json)
    }

    fn map(&mut self, depth: usize) -> Result<Json, Diagnostic> {
        let open = self.at;
        self.take("{");
        let mut members: Vec<(Key, Node)> = Vec::new();
        let mut places: BTreeMap<String, Span> = BTreeMap::new();
        self.skip_space();
        if self.take("}") {
            return Ok(Json::Map(members));
        }
        loop {
            self.skip_space();
            let start = self.at;
            if self.peek() != Some('"') {
                return Err(self.no_key(members.last()));
            }
            let text = self.string()?;
            let span = Span { start, end: self.at };
            if let Some(first) = places.insert(text.clone(), span) {
                return Err(Diagnostic::new(
                    Code::DuplicateKey,
                    span,
                    format!("the key {} stands twice in one object", quoted(&text)),
                )
                .related(first, "first here")
                .help("remove one of them"));
            }
            self.skip_space();
            if !self.take(":") {
                return Err(self.missing("a colon after the key", ":"));
            }
            let value = self.value(depth + 1)?;
            members.push((Key { span, text }, value));
            if self.next_or_close("}", open)? {
                return Ok(Json::Map(members));
            }
        }
    }

    /// The text in place of a key; after a number it may be the rest of a decimal comma.
    fn no_key(&self, last: Option<&(Key, Node)>) -> Diagnostic {
        let diagnostic = self.unexpected("a key in double quotes");
        let digits = &self.rest()[..self
            .rest()
            .find(|c: char| !c.is_ascii_digit())
            .unwrap_or(self.rest().len())];
        match last.map(|(_, node)| (&node.json, node.span)) {
            Some((Json::Number(_), span)) if !digits.is_empty() => {
                let before = self.text.get(span.start..span.end).unwrap_or_default();
                diagnostic.help(format!("numbers have a decimal point: {before}.{digits}"))
            }
            _ => diagnostic,
        }
    }

    fn list(&mut self, depth: usize) -> Result<Json, Diagnostic> {
        let open = self.at;
        self.take("[");
        let mut items = Vec::new();
        self.skip_space();
        if self.take("]") {
            return Ok(Json::List(items));
        }
        loop {
            items.push(self.value(depth + 1)?);
            if self.next_or_close("]", open)? {
                return Ok(Json::List(items));
            }
        }
    }

    /// After a member: takes `,` and returns FALSE, or takes `close` and returns TRUE.
    fn next_or_close(&mut self, close: &str, open: usize) -> Result<bool, Diagnostic> {
        self.skip_space();
        if self.take(close) {
            return Ok(true);
        }
        let comma = self.at;
        if self.take(",") {
            self.skip_space();
            if self.rest().starts_with(['}', ']']) {
                let span = Span {
                    start: comma,
                    end: comma + 1,
                };
                return Err(
                    Diagnostic::new(Code::Syntax, span, "a comma before a closing bracket")
                        .help("remove the comma"),
                );
            }
            return Ok(false);
        }
        if self.at == self.text.len() {
            let span = Span {
                start: open,
                end: open + 1,
            };
            return Err(Diagnostic::new(
                Code::Syntax,
                self.token(),
                format!("the text ends before the closing `{close}`"),
            )
            .related(span, "opened here"));
        }
        Err(self.missing(&format!("`,` or `{close}`"), ","))
    }

    fn number(&mut self) -> Result<Json, Diagnostic> {
        let token = self.token();
        let text = &self.text[token.start..token.end];
        if !is_json_number(text) {
            return Err(Diagnostic::new(
                Code::Syntax,
                token,
                format!("{} is no number in JSON", quoted(text)),
            )
            .help(
                "write it like 20, -0.5 or 1.5e3; NaN and infinities as \"NaN\", \"Infinity\", \"-Infinity\"",
            ));
        }
        // The standard library rounds to the nearest double, which strict JSON numbers always have.
        let value: f64 = text.parse().unwrap_or(f64::INFINITY);
        if !value.is_finite() {
            return Err(Diagnostic::new(
                Code::NumberTooLarge,
                token,
                format!("{} is too large for a 64-bit float", quoted(text)),
            )
            .help("the largest is about 1.8e308; write \"Infinity\" in quotes if that is meant"));
        }
        self.at = token.end;
        self.last_end = self.at;
        Ok(Json::Number(value))
    }

    /// The word or the single character at this place; empty at the end of the text.
    fn token(&self) -> Span {
        let rest = self.rest();
        let is_word = |c: char| c.is_alphanumeric() || matches!(c, '_' | '.' | '+' | '-' | '#');
        let word = rest.find(|c| !is_word(c)).unwrap_or(rest.len());
        let length = if word > 0 {
            word
        } else {
            self.peek().map_or(0, char::len_utf8)
        };
        Span {
            start: self.at,
            end: self.at + length,
        }
    }

    fn unexpected(&self, expected: &str) -> Diagnostic {
        let token = self.token();
        if token.start == token.end {
            let message = format!("the text ends where {expected} is expected");
            return Diagnostic::new(Code::Syntax, token, message);
        }
        let found = &self.text[token.start..token.end];
        let message = format!("expected {expected}, found {}", quoted(found));
        let diagnostic = Diagnostic::new(Code::Syntax, token, message);
        let rest = self.rest();
        if rest.starts_with("//") || rest.starts_with("/*") || found == "#" {
            diagnostic.help("JSON has no comments; axes, blocks, steps and claims may carry \"note\": \"..\"")
        } else if found == "'" {
            diagnostic.help("strings stand in double quotes")
        } else if CURLY.iter().any(|quote| found.starts_with(*quote)) {
            diagnostic.help("a typographic quote, as word processors make them: write \" before and after")
        } else if rest.starts_with(char::is_alphabetic) && expected.contains("key") {
            diagnostic.help(format!("write \"{found}\""))
        } else {
            diagnostic
        }
    }

    /// `what` is missing at or before this place.
    fn missing(&self, what: &str, token: &str) -> Diagnostic {
        let mut diagnostic = self.unexpected(what);
        diagnostic.message = format!("expected {what} at or before this place");
        let here = Span {
            start: self.last_end,
            end: self.last_end,
        };
        diagnostic.related(here, format!("`{token}` may be missing here"))
    }
}

/// Quotation marks that JSON does not know.
const CURLY: [char; 6] = [
    '\u{201c}', '\u{201d}', '\u{201e}', '\u{2018}', '\u{2019}', '\u{ab}',
];

/// The number grammar of RFC 8259, which is narrower than what Rust parses.
fn is_json_number(text: &str) -> bool {
    let digits = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    let text = text.strip_prefix('-').unwrap_or(text);
    let (mantissa, exponent) = match text.split_once(['e', 'E']) {
        Some((mantissa, exponent)) => (mantissa, Some(exponent)),
        None => (text, None),
    };
    let (whole, fraction) = match mantissa.split_once('.') {
        Some((whole, fraction)) => (whole, Some(fraction)),
        None => (mantissa, None),
    };
    digits(whole)
        && (whole.len() == 1 || !whole.starts_with('0'))
        && fraction.is_none_or(digits)
        && exponent.is_none_or(|e| digits(e.strip_prefix(['+', '-']).unwrap_or(e)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_follow_the_grammar_of_json() {
        for good in ["0", "-0", "0.5", "-12.25e-3", "1E+5", "10"] {
            assert!(is_json_number(good), "{good}");
            assert_eq!(parse(good).unwrap().json, Json::Number(good.parse().unwrap()));
        }
        for bad in [
            "01",
            "1.",
            "-",
            "1e",
            "1e+",
            "0x10",
            "1_000",
            "--1",
            "1.5.2",
            "-Infinity",
            "1-2",
        ] {
            assert_eq!(parse(bad).unwrap_err().code, Code::Syntax, "{bad}");
        }
        for bad in [
            ".5",
            "+1",
            "NaN",
            "Infinity",
            "True",
            "undefined",
            "'a'",
            "",
            " ",
            "\u{a0}1",
        ] {
            assert_eq!(parse(bad).unwrap_err().code, Code::Syntax, "{bad}");
        }
        assert_eq!(parse("1e400").unwrap_err().code, Code::NumberTooLarge);
        assert_eq!(parse("-1e400").unwrap_err().code, Code::NumberTooLarge);
    }

    #[test]
    fn strings_take_the_escapes_of_json_and_no_others() {
        let good = r#""a\"\\\/\b\f\n\r\t\u00e9\uD83D\uDE00é""#;
        let expected = "a\"\\/\u{8}\u{c}\n\r\té😀é".to_owned();
        assert_eq!(parse(good).unwrap().json, Json::Text(expected));
        for bad in [
            r#""\x""#,
            r#""\u12""#,
            r#""\uD83D""#,
            r#""\uDE00""#,
            r#""\uD83DA""#,
            "\"a\nb\"",
            "\"\u{1}\"",
            "\"",
            "\"\\",
        ] {
            assert_eq!(parse(bad).unwrap_err().code, Code::Syntax, "{bad}");
        }
    }

    #[test]
    fn what_strict_json_does_not_have_is_refused() {
        for bad in [
            "[1,]",
            "{\"a\":1,}",
            "[1 2]",
            "{\"a\" 1}",
            "{a:1}",
            "[1] x",
            "// c\n1",
            "[1 /* c */]",
            "{,}",
            "[,]",
            "[",
            "{\"a\":",
            "]",
        ] {
            assert_eq!(parse(bad).unwrap_err().code, Code::Syntax, "{bad}");
        }
        assert_eq!(parse("{\"a\":1,\"a\":2}").unwrap_err().code, Code::DuplicateKey);
    }

    #[test]
    fn deep_nesting_ends_in_an_error() {
        let deep = "[".repeat(1_000_000);
        assert_eq!(parse(&deep).unwrap_err().code, Code::TooDeep);
        let fits = format!("{}{}", "[".repeat(DEPTH_MAX), "]".repeat(DEPTH_MAX));
        assert!(parse(&fits).is_ok());
    }

    #[test]
    fn spans_cover_exactly_the_token() {
        let text = "{ \"a\" : [10, true ] }";
        let Json::Map(members) = parse(text).unwrap().json else {
            panic!()
        };
        let (key, list) = &members[0];
        assert_eq!(&text[key.span.start..key.span.end], "\"a\"");
        assert_eq!(&text[list.span.start..list.span.end], "[10, true ]");
        let Json::List(items) = &list.json else { panic!() };
        assert_eq!(&text[items[0].span.start..items[0].span.end], "10");
        assert_eq!(&text[items[1].span.start..items[1].span.end], "true");
    }
}

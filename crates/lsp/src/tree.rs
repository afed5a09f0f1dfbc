//! JSON while it is being written: the readable part of it, with places, and never an error. Only the
//! reader of scripts reports mistakes.

use std::ops::Range;

/// Deepest nesting that is followed.
const DEPTH_MOST: usize = 64;

#[derive(Clone, Debug, Default)]
pub(crate) struct Node {
    pub span: Range<usize>,
    pub json: Json,
}

#[derive(Clone, Debug, Default)]
pub(crate) enum Json {
    /// Nothing, or no valid value.
    #[default]
    Nothing,
    /// Text without quotes: numbers and words.
    Word,
    Text(String),
    List(Vec<Node>),
    Map(Vec<Member>),
}

#[derive(Clone, Debug)]
pub(crate) struct Member {
    pub key: String,
    /// With its quotes.
    pub key_span: Range<usize>,
    /// Whether a colon follows.
    pub colon: bool,
    pub value: Node,
}

/// A step from a value to one in it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Step {
    Key(String),
    Item(usize),
}

/// The item at a place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Spot {
    /// A key, or a place for one; the span of the present text.
    Key(Range<usize>),
    /// A value, or a place for one.
    Value(Range<usize>),
}

impl Node {
    pub(crate) fn get(&self, key: &str) -> Option<&Self> {
        self.members()
            .find(|(member, _)| member.key == key)
            .map(|(_, value)| value)
    }

    pub(crate) fn members(&self) -> impl Iterator<Item = (&Member, &Self)> {
        let members = match &self.json {
            Json::Map(members) => members.as_slice(),
            _ => &[],
        };
        members.iter().map(|member| (member, &member.value))
    }

    pub(crate) fn items(&self) -> &[Self] {
        match &self.json {
            Json::List(items) => items,
            _ => &[],
        }
    }

    pub(crate) fn as_text(&self) -> Option<&str> {
        match &self.json {
            Json::Text(text) => Some(text),
            _ => None,
        }
    }

    /// Itself if it is a text, or its texts if it is a list.
    pub(crate) fn texts(&self) -> impl Iterator<Item = &str> {
        let own = self.as_text();
        own.into_iter()
            .chain(self.items().iter().filter_map(Self::as_text))
    }

    /// The value at a path.
    pub(crate) fn at(&self, path: &[Step]) -> Option<&Self> {
        path.iter().try_fold(self, |node, step| match step {
            Step::Key(key) => node.get(key),
            Step::Item(index) => node.items().get(*index),
        })
    }

    /// The path to a place, and the item there.
    pub(crate) fn spot(&self, byte: usize) -> (Vec<Step>, Spot) {
        let mut path = Vec::new();
        let spot = self.descend(byte, &mut path);
        (path, spot)
    }

    fn descend(&self, byte: usize, path: &mut Vec<Step>) -> Spot {
        let inside = |span: &Range<usize>| span.start < byte && byte < span.end;
        match &self.json {
            Json::Map(members) if inside(&self.span) => {
                for (index, member) in members.iter().enumerate() {
                    let touches = member.key_span.start <= byte && byte <= member.key_span.end;
                    if touches && !member.key_span.is_empty() {
                        return Spot::Key(member.key_span.clone());
                    }
                    let end = members
                        .get(index + 1)
                        .map_or(self.span.end, |next| next.key_span.start);
                    let near = member.colon && member.key_span.end < byte && byte <= member.value.span.end;
                    // `"key": |` has no value yet.
                    let missing = member.colon && matches!(member.value.json, Json::Nothing) && byte < end;
                    if near || (missing && byte > member.key_span.end) {
                        path.push(Step::Key(member.key.clone()));
                        return member.value.descend(byte, path);
                    }
                }
                Spot::Key(byte..byte)
            }
            Json::List(items) if inside(&self.span) => {
                let found = items
                    .iter()
                    .position(|item| item.span.start <= byte && byte <= item.span.end);
                path.push(Step::Item(found.unwrap_or(items.len())));
                match found.and_then(|index| items.get(index)) {
                    Some(item) => item.descend(byte, path),
                    None => Spot::Value(byte..byte),
                }
            }
            Json::Nothing => Spot::Value(byte..byte),
            Json::Map(_) | Json::List(_) if !(self.span.start..=self.span.end).contains(&byte) => {
                Spot::Value(byte..byte)
            }
            _ => Spot::Value(self.span.clone()),
        }
    }
}

/// Reads a text. Cost: linear in its length.
pub(crate) fn parse(text: &str) -> Node {
    let mut reader = Reader {
        text,
        at: 0,
        open: false,
    };
    reader.value(0)
}

struct Reader<'t> {
    text: &'t str,
    at: usize,
    /// Whether the text ended within an object or a list.
    open: bool,
}

impl Reader<'_> {
    fn peek(&self) -> Option<char> {
        self.text.get(self.at..)?.chars().next()
    }

    fn skip_space(&mut self) {
        while let Some(c) = self.peek().filter(|c| c.is_whitespace()) {
            self.at += c.len_utf8();
        }
    }

    fn value(&mut self, depth: usize) -> Node {
        self.skip_space();
        let start = self.at;
        let json = match self.peek() {
            Some('{') if depth < DEPTH_MOST => self.map(depth),
            Some('[') if depth < DEPTH_MOST => self.list(depth),
            Some('"') => Json::Text(self.string()),
            Some(c) if c.is_alphanumeric() || "-+._".contains(c) => self.word(),
            _ => Json::Nothing,
        };
        // An object or list that is not closed continues behind the end of the text.
        let open = matches!(json, Json::Map(_) | Json::List(_)) && self.open;
        Node {
            span: start..self.at + usize::from(open),
            json,
        }
    }

    fn word(&mut self) -> Json {
        while let Some(c) = self.peek().filter(|c| c.is_alphanumeric() || "-+._".contains(*c)) {
            self.at += c.len_utf8();
        }
        Json::Word
    }

    /// A string; one that is not closed ends with its line.
    fn string(&mut self) -> String {
        self.at += 1;
        let mut text = String::new();
        while let Some(c) = self.peek() {
            if c == '\n' || c == '\r' {
                break;
            }
            self.at += c.len_utf8();
            match c {
                '"' => break,
                '\\' => {
                    let escaped = self.peek().filter(|c| *c != '\n' && *c != '\r');
                    self.at += escaped.map_or(0, char::len_utf8);
                    text.extend(escaped);
                }
                c => text.push(c),
            }
        }
        text
    }

    fn map(&mut self, depth: usize) -> Json {
        self.at += 1;
        let mut members = Vec::new();
        loop {
            self.skip_space();
            match self.peek() {
                None => {
                    self.open = true;
                    break;
                }
                Some('}') => {
                    self.at += 1;
                    break;
                }
                // It closes an outer object or list.
                Some(']') => break,
                Some('"') => members.push(self.member(depth)),
                Some(c) => self.at += c.len_utf8(),
            }
        }
        Json::Map(members)
    }

    fn member(&mut self, depth: usize) -> Member {
        let start = self.at;
        let key = self.string();
        let key_span = start..self.at;
        self.skip_space();
        let colon = self.peek() == Some(':');
        let mut value = Node {
            span: self.at..self.at,
            json: Json::Nothing,
        };
        if colon {
            self.at += 1;
            let behind = self.at;
            value = self.value(depth + 1);
            self.skip_space();
            // The value is missing, and this is the next key.
            if matches!(value.json, Json::Text(_)) && self.peek() == Some(':') {
                self.at = value.span.start;
                value = Node {
                    span: behind..behind,
                    json: Json::Nothing,
                };
            }
        }
        Member {
            key,
            key_span,
            colon,
            value,
        }
    }

    fn list(&mut self, depth: usize) -> Json {
        self.at += 1;
        let mut items = Vec::new();
        loop {
            self.skip_space();
            match self.peek() {
                None => {
                    self.open = true;
                    break;
                }
                Some(']') => {
                    self.at += 1;
                    break;
                }
                Some('}') => break,
                _ => {
                    let from = self.at;
                    let item = self.value(depth + 1);
                    if self.at == from {
                        let skipped = self.peek().map_or(1, char::len_utf8);
                        self.at += skipped;
                    } else {
                        items.push(item);
                    }
                }
            }
        }
        Json::List(items)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(text: &str) -> (String, Spot) {
        let byte = text.find('|').unwrap();
        let text = text.replacen('|', "", 1);
        let (path, spot) = parse(&text).spot(byte);
        let path = path.iter().map(|step| match step {
            Step::Key(key) => format!(".{key}"),
            Step::Item(index) => format!("[{index}]"),
        });
        (path.collect(), spot)
    }

    #[test]
    fn a_place_has_a_path_in_a_text_that_is_whole_or_not() {
        for (text, path, is_key) in [
            (r#"{"a": {"b": [1, {"c": "x|"}]}}"#, ".a.b[1].c", false),
            (r#"{"a": {"b|": 1}}"#, ".a", true),
            (r#"{"a": {"|"#, ".a", true),
            (r#"{"a": {|}}"#, ".a", true),
            (r#"{"a": [{"b": 1}, {"c|"#, ".a[1]", true),
            (r#"{"a": |}"#, ".a", false),
            (r#"{"a": |, "b": 2}"#, ".a", false),
            ("{\"a\": |\n  \"b\": 2}", ".a", false),
            ("{\"a\": \"|\n  \"b\": 2}", ".a", false),
            (r#"{"a": [|]}"#, ".a[0]", false),
            (r#"{"a": ["x", "|"]}"#, ".a[1]", false),
            (r#"{"a": 12|, "b": 2}"#, ".a", false),
            (r#"{"a": 12, |"b": 2}"#, "", true),
            (r#"{"a": 12, | "b": 2}"#, "", true),
            (r#"{"a": [1], |"#, "", true),
        ] {
            let (found, spot) = at(text);
            assert_eq!(
                (found.as_str(), matches!(spot, Spot::Key(_))),
                (path, is_key),
                "{text}"
            );
        }
    }

    /// Cut off anywhere, and with any characters in it.
    #[test]
    fn nothing_stops_the_reader() {
        let text = r#"{"a": [1, -2.5e3, "ä\"x", {"b": null, "c": [true]}], "d": {"e": "\u00e4"}} ]}{ : , é"#;
        for (end, _) in text.char_indices() {
            let tree = parse(&text[..end]);
            for byte in 0..=end {
                let _spot = tree.spot(byte);
            }
        }
        let deep = "[".repeat(100_000);
        let _tree = parse(&deep);
        let deep = "{\"a\":".repeat(100_000);
        let _tree = parse(&deep);
    }
}

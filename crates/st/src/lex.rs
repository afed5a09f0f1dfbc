//! From text to words, numbers and signs.

use crate::error::{Code, Diagnostic, Found, quoted};
use crate::source::Span;
use std::collections::BTreeSet;

macro_rules! keywords {
    ($($variant:ident = $text:literal,)*) => {
        /// The reserved words. Words that have a meaning in one place only (TASK, WITH, INTERVAL) are names
        /// elsewhere.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        pub(crate) enum Word { $($variant,)* }

        impl Word {
            const ALL: &'static [(&'static str, Self)] = &[$(($text, Self::$variant),)*];

            pub(crate) const fn text(self) -> &'static str {
                match self { $(Self::$variant => $text,)* }
            }
        }
    };
}

// In alphabetical order, for a binary search.
keywords! {
    And = "AND", AndThen = "AND_THEN", Array = "ARRAY", At = "AT", By = "BY", Case = "CASE", Class = "CLASS",
    Configuration = "CONFIGURATION", Constant = "CONSTANT", Continue = "CONTINUE", Do = "DO", Else = "ELSE",
    Elsif = "ELSIF", EndCase = "END_CASE", EndClass = "END_CLASS", EndConfiguration = "END_CONFIGURATION",
    EndFor = "END_FOR", EndFunction = "END_FUNCTION", EndFunctionBlock = "END_FUNCTION_BLOCK", EndIf = "END_IF",
    EndInterface = "END_INTERFACE", EndMethod = "END_METHOD", EndNamespace = "END_NAMESPACE",
    EndProgram = "END_PROGRAM", EndProperty = "END_PROPERTY", EndRepeat = "END_REPEAT",
    EndResource = "END_RESOURCE", EndStruct = "END_STRUCT", EndType = "END_TYPE", EndUnion = "END_UNION",
    EndVar = "END_VAR", EndWhile = "END_WHILE", Exit = "EXIT", Extends = "EXTENDS", False = "FALSE",
    For = "FOR", Function = "FUNCTION", FunctionBlock = "FUNCTION_BLOCK", Goto = "GOTO", If = "IF",
    Implements = "IMPLEMENTS", InitialStep = "INITIAL_STEP", Interface = "INTERFACE", Jmp = "JMP",
    Method = "METHOD", Mod = "MOD", Namespace = "NAMESPACE", NonRetain = "NON_RETAIN", Not = "NOT", Of = "OF",
    Or = "OR", OrElse = "OR_ELSE", Persistent = "PERSISTENT", Pointer = "POINTER", Program = "PROGRAM",
    Property = "PROPERTY", Reference = "REFERENCE", RefTo = "REF_TO", Repeat = "REPEAT", Resource = "RESOURCE",
    Retain = "RETAIN", Return = "RETURN", Struct = "STRUCT", Super = "SUPER", Then = "THEN", This = "THIS",
    To = "TO", True = "TRUE", Type = "TYPE", Union = "UNION", Until = "UNTIL", Var = "VAR",
    VarAccess = "VAR_ACCESS", VarConfig = "VAR_CONFIG", VarExternal = "VAR_EXTERNAL", VarGlobal = "VAR_GLOBAL",
    VarInput = "VAR_INPUT", VarInst = "VAR_INST", VarInOut = "VAR_IN_OUT", VarOutput = "VAR_OUTPUT",
    VarStat = "VAR_STAT", VarTemp = "VAR_TEMP", While = "WHILE", Xor = "XOR",
}

impl Word {
    pub(crate) fn find(text: &str) -> Option<Self> {
        let upper = || text.bytes().map(|byte| byte.to_ascii_uppercase());
        let place = Self::ALL
            .binary_search_by(|(word, _)| word.bytes().cmp(upper()))
            .ok()?;
        Self::ALL.get(place).map(|(_, word)| *word)
    }
}

/// The kind of a token; its text is in the source.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Token {
    Name,
    Word(Word),
    /// `123`, `1_000`
    Integer,
    /// `16#FF`
    Based,
    /// `1.5`, `1.0E-3`
    Real,
    /// The text after `T#`, with `T#`.
    Duration,
    /// `INT#`, `E#`: the literal or element follows.
    Typed,
    /// `'text'`
    Text,
    /// `"text"`
    WideText,
    /// `%IX0.0`, `%X3`
    Address,
    Assign,
    Output,
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Plus,
    Minus,
    Star,
    Power,
    Slash,
    Ampersand,
    Open,
    Close,
    OpenBracket,
    CloseBracket,
    Comma,
    Semicolon,
    Colon,
    Dot,
    Range,
    Caret,
    /// A string that is not closed, or stands between other quotes, which has been reported.
    Broken,
    /// Signs of other languages; the text says which.
    Foreign,
    End,
}

/// Cuts a text into tokens, the last of which is [`Token::End`]. Places count from `start`.
pub(crate) fn lex(text: &str, start: u32, found: &mut Found) -> Vec<(Token, Span)> {
    lex_with_comments(text, start, found).0
}

/// The same, and the comments and pragmas between the tokens.
pub(crate) fn lex_with_comments(
    text: &str,
    start: u32,
    found: &mut Found,
) -> (Vec<(Token, Span)>, Vec<Span>) {
    let mut lexer = Lexer {
        text,
        bytes: text.as_bytes(),
        at: 0,
        start,
        told_space: false,
        told_names: BTreeSet::new(),
        told_scl: false,
        comments: Vec::new(),
        found,
    };
    let mut tokens = Vec::with_capacity(text.len() / 4);
    loop {
        lexer.skip_blank();
        let from = lexer.at;
        if from >= text.len() {
            tokens.push((Token::End, lexer.span(from)));
            return (tokens, lexer.comments);
        }
        if let Some(token) = lexer.token() {
            tokens.push((token, lexer.span(from)));
        }
    }
}

struct Lexer<'a> {
    text: &'a str,
    bytes: &'a [u8],
    at: usize,
    start: u32,
    /// Whether a space of a word processor was reported; there are usually many.
    told_space: bool,
    /// Names with other letters that were reported.
    told_names: BTreeSet<&'a str>,
    /// Whether a `#` before a name was reported.
    told_scl: bool,
    comments: Vec<Span>,
    found: &'a mut Found,
}

/// What word processors make of spaces, quotes and dashes.
const SPACES: [char; 3] = ['\u{a0}', '\u{200b}', '\u{feff}'];
const QUOTES: [char; 5] = ['‘', '’', '“', '”', '„'];
const DASHES: [char; 2] = ['–', '—'];

/// The sign that begins with these two bytes, and how many of them are its own.
const fn sign(one: u8, two: u8) -> Option<(usize, Token)> {
    let long = match (one, two) {
        (b':', b'=') => Some(Token::Assign),
        (b'=', b'>') => Some(Token::Output),
        (b'<', b'>') => Some(Token::NotEqual),
        (b'<', b'=') => Some(Token::LessEqual),
        (b'>', b'=') => Some(Token::GreaterEqual),
        (b'*', b'*') => Some(Token::Power),
        (b'.', b'.') => Some(Token::Range),
        (b'=' | b'!' | b'+' | b'-', b'=') | (b'&', b'&') | (b'|', b'|') | (b'+', b'+') => {
            Some(Token::Foreign)
        }
        _ => None,
    };
    if let Some(token) = long {
        return Some((2, token));
    }
    let token = match one {
        b'=' => Token::Equal,
        b'<' => Token::Less,
        b'>' => Token::Greater,
        b'+' => Token::Plus,
        b'-' => Token::Minus,
        b'*' => Token::Star,
        b'/' => Token::Slash,
        b'&' => Token::Ampersand,
        b'(' => Token::Open,
        b')' => Token::Close,
        b'[' => Token::OpenBracket,
        b']' => Token::CloseBracket,
        b',' => Token::Comma,
        b';' => Token::Semicolon,
        b':' => Token::Colon,
        b'.' => Token::Dot,
        b'^' => Token::Caret,
        b'!' => Token::Foreign,
        _ => return None,
    };
    Some((1, token))
}

const fn is_name(byte: u8) -> bool {
    byte.is_ascii_alphanumeric() || byte == b'_'
}

const fn is_name_start(byte: u8) -> bool {
    byte.is_ascii_alphabetic() || byte == b'_'
}

const fn is_digit(byte: u8) -> bool {
    byte.is_ascii_digit() || byte == b'_'
}

impl<'a> Lexer<'a> {
    fn span(&self, from: usize) -> Span {
        Span {
            start: self.start + from as u32,
            end: self.start + self.at as u32,
        }
    }

    fn peek(&self, ahead: usize) -> u8 {
        self.bytes.get(self.at + ahead).copied().unwrap_or(0)
    }

    fn starts_with(&self, sign: &str) -> bool {
        self.bytes
            .get(self.at..)
            .is_some_and(|rest| rest.starts_with(sign.as_bytes()))
    }

    fn skip_while(&mut self, wanted: impl Fn(u8) -> bool) {
        while self.at < self.bytes.len() && wanted(self.peek(0)) {
            self.at += 1;
        }
    }

    /// Spaces, comments and pragmas.
    fn skip_blank(&mut self) {
        loop {
            self.skip_while(|byte| byte.is_ascii_whitespace() || byte == 0x0B);
            let from = self.at;
            if self.starts_with("//") {
                self.skip_while(|byte| byte != b'\n');
            } else if self.starts_with("(*") {
                self.nested(from, "(*", "*)");
            } else if self.starts_with("/*") {
                self.nested(from, "/*", "*/");
            } else if self.peek(0) == b'{' {
                self.pragma(from);
            } else if let Some(space) = self.char_here().filter(|it| SPACES.contains(it)) {
                self.foreign_space(space);
                continue;
            } else {
                return;
            }
            self.comments.push(self.span(from));
        }
    }

    fn char_here(&self) -> Option<char> {
        self.text.get(self.at..)?.chars().next()
    }

    fn foreign_space(&mut self, space: char) {
        let from = self.at;
        self.at += space.len_utf8();
        if !self.told_space {
            self.told_space = true;
            let message = format!(
                "a space of a word processor (U+{:04X}) stands here",
                u32::from(space)
            );
            let wrong = Diagnostic::error(Code::Syntax, self.span(from), message);
            self.found
                .add(wrong.help("replace it by a plain space, here and in the rest of the file"));
        }
    }

    fn nested(&mut self, from: usize, open: &str, close: &str) {
        let mut depth = 0_usize;
        while self.at < self.bytes.len() {
            if self.starts_with(open) {
                depth += 1;
                self.at += 2;
            } else if self.starts_with(close) {
                depth -= 1;
                self.at += 2;
                if depth == 0 {
                    return;
                }
            } else {
                self.at += 1;
            }
        }
        let span = Span {
            start: self.start + from as u32,
            end: self.start + from as u32 + 2,
        };
        self.found.add(
            Diagnostic::error(Code::NotClosed, span, "a comment is opened here and not closed")
                .help(format!("comments nest: each `{open}` needs its `{close}`")),
        );
    }

    fn pragma(&mut self, from: usize) {
        const KNOWN: [&str; 5] = ["attribute", "region", "endregion", "lint", "warning"];
        self.skip_while(|byte| byte != b'}');
        if self.at >= self.bytes.len() {
            self.at = from + 1;
            let span = self.span(from);
            self.at = self.bytes.len();
            let wrong = Diagnostic::error(Code::NotClosed, span, "a pragma is opened here and not closed");
            self.found
                .add(wrong.help("write `}` at its end, or `(* .. *)` for a comment"));
            return;
        }
        self.at += 1;
        let inner = self.text.get(from + 1..self.at - 1).unwrap_or_default().trim();
        let word = inner
            .split(|c: char| !c.is_ascii_alphabetic())
            .next()
            .unwrap_or_default();
        if !KNOWN.iter().any(|known| known.eq_ignore_ascii_case(word)) {
            let message = format!("the pragma {} is not known and has no effect", quoted(inner));
            let span = self.span(from);
            let conditional = ["IF", "ELSIF", "ELSE", "END_IF"]
                .iter()
                .any(|it| word.eq_ignore_ascii_case(it));
            let help =
                conditional.then(|| "what stands between such pragmas is compiled in any case".to_owned());
            let doubt = Diagnostic::warning(Code::Doubtful, span, message);
            self.found.add(doubt.maybe_help(help));
        }
    }

    /// The next token. `None` if the text here is no token; this has then been reported.
    fn token(&mut self) -> Option<Token> {
        let byte = self.peek(0);
        if is_name_start(byte) || !byte.is_ascii() {
            return self.name();
        }
        match byte {
            b'0'..=b'9' => return Some(self.number()),
            b'\'' => return self.quoted_text(b'\'', Token::Text),
            b'"' => return self.quoted_text(b'"', Token::WideText),
            b'%' if is_name_start(self.peek(1)) => {
                self.at += 1;
                self.skip_while(|byte| is_name(byte) || byte == b'.');
                // `%I*`; behind a number it multiplies.
                if self.peek(0) == b'*' && !self.bytes.get(self.at - 1).is_some_and(u8::is_ascii_digit) {
                    self.at += 1;
                }
                return Some(Token::Address);
            }
            _ => {}
        }
        if let Some((bytes, token)) = sign(byte, self.peek(1)) {
            self.at += bytes;
            return Some(token);
        }
        let from = self.at;
        self.at += 1;
        let span = self.span(from);
        let sign = char::from(byte);
        if sign == '#' && (is_name_start(self.peek(0)) || self.peek(0) == b'"') {
            if !self.told_scl {
                self.told_scl = true;
                let message = "`#` before a name is SCL, the dialect of Siemens";
                let wrong = Diagnostic::error(Code::Syntax, span, message);
                self.found
                    .add(wrong.help("write the names without it, here and in the rest of the file"));
            }
            return None;
        }
        let wrong = match sign {
            _ if byte < b' ' => Diagnostic::error(
                Code::Syntax,
                span,
                format!("a control character (16#{byte:02X}) stands in the text"),
            ),
            '}' => Diagnostic::error(Code::Syntax, span, "`}` closes a pragma that is not open"),
            '%' => Diagnostic::error(Code::Syntax, span, "`%` begins an address such as %IX0.0")
                .help("the rest of a division is `MOD`"),
            '#' => Diagnostic::error(
                Code::Syntax,
                span,
                "`#` stands behind a type or a base, without a space: INT#5, 16#FF",
            ),
            '|' => Diagnostic::error(Code::Syntax, span, "`|` is no operator of Structured Text")
                .help("write `OR`"),
            '~' => Diagnostic::error(Code::Syntax, span, "`~` is no operator of Structured Text")
                .help("write `NOT`"),
            _ => Diagnostic::error(
                Code::Syntax,
                span,
                format!("`{sign}` has no meaning in Structured Text"),
            ),
        };
        self.found.add(wrong);
        None
    }

    fn name(&mut self) -> Option<Token> {
        let from = self.at;
        if let Some(sign) = self.char_here().filter(|sign| !sign.is_ascii()) {
            if QUOTES.contains(&sign) {
                return Some(self.foreign_quotes());
            }
            if DASHES.contains(&sign) {
                self.at += sign.len_utf8();
                let wrong = Diagnostic::error(
                    Code::Syntax,
                    self.span(from),
                    format!("`{sign}` has no meaning in Structured Text"),
                );
                self.found
                    .add(wrong.help("this dash comes from a word processor; minus is `-`"));
                return Some(Token::Minus);
            }
        }
        let ends = |letter: char| {
            let plain = u8::try_from(letter).is_ok_and(|byte| byte.is_ascii() && !is_name(byte));
            plain || SPACES.contains(&letter) || QUOTES.contains(&letter) || DASHES.contains(&letter)
        };
        self.skip_while(is_name);
        if !self.peek(0).is_ascii() {
            let rest = self.text.get(self.at..).unwrap_or_default();
            self.at += rest.find(ends).unwrap_or(rest.len());
        }
        let text = self.text.get(from..self.at).unwrap_or_default();
        if !text.is_ascii() {
            return self.foreign_letters(from);
        }
        if self.peek(0) == b'#' {
            self.at += 1;
            let kind = text.to_ascii_uppercase();
            if matches!(kind.as_str(), "T" | "TIME" | "LTIME" | "LT") {
                self.duration();
                return Some(Token::Duration);
            }
            return Some(Token::Typed);
        }
        Some(Word::find(text).map_or(Token::Name, Token::Word))
    }

    /// The text behind `T#`. A sign behind its first number is an operator, and `..` a range.
    fn duration(&mut self) {
        self.skip_while(|byte| matches!(byte, b'+' | b'-'));
        self.skip_while(is_name);
        while self.peek(0) == b'.' && self.peek(1).is_ascii_digit() {
            self.at += 1;
            self.skip_while(is_name);
        }
    }

    /// A text between the quotes of a word processor.
    fn foreign_quotes(&mut self) -> Token {
        let from = self.at;
        let rest = self.text.get(from..).unwrap_or_default();
        let line = rest.lines().next().unwrap_or_default();
        let inner = line.char_indices().skip(1);
        let mut ends = inner.filter(|(_, letter)| QUOTES.contains(letter) || *letter == '\'');
        let length = ends.next().map(|(at, letter)| at + letter.len_utf8());
        self.at += length.unwrap_or_else(|| without_end(line));
        let wrong = Diagnostic::error(
            Code::Syntax,
            self.span(from),
            "these quotes come from a word processor",
        );
        self.found.add(wrong.help("strings stand between `'`"));
        Token::Broken
    }

    /// A word with letters that an identifier cannot have.
    fn foreign_letters(&mut self, from: usize) -> Option<Token> {
        let text: &'a str = self.text.get(from..self.at).unwrap_or_default();
        let letter = text.chars().find(|c| !c.is_ascii()).unwrap_or(' ');
        let span = self.span(from);
        let wrong = Diagnostic::error(
            Code::BadName,
            span,
            format!(
                "{} has `{letter}`, and names are made of A to Z, 0 to 9 and `_`",
                quoted(text)
            ),
        );
        let help = match letter {
            'ä' | 'Ä' => "write `ae`",
            'ö' | 'Ö' => "write `oe`",
            'ü' | 'Ü' => "write `ue`",
            'ß' => "write `ss`",
            _ => "use other letters; comments and strings may have any",
        };
        if self.told_names.insert(text) {
            self.found.add(wrong.help(help));
        }
        // Except for its letters it is a name, so it is read as one, and only this is reported.
        text.starts_with(char::is_alphabetic).then_some(Token::Name)
    }

    fn number(&mut self) -> Token {
        self.skip_while(is_digit);
        if self.peek(0) == b'#' {
            self.at += 1;
            self.skip_while(is_name);
            return Token::Based;
        }
        let mut token = Token::Integer;
        // `1..5` is a range, and `w.3` a bit.
        if self.peek(0) == b'.' && self.peek(1).is_ascii_digit() {
            token = Token::Real;
            self.at += 1;
            self.skip_while(is_digit);
        }
        let exponent = matches!(self.peek(0), b'e' | b'E');
        let signed = usize::from(matches!(self.peek(1), b'+' | b'-'));
        if exponent && self.peek(1 + signed).is_ascii_digit() {
            token = Token::Real;
            self.at += 1 + signed;
            self.skip_while(is_digit);
        }
        token
    }

    fn quoted_text(&mut self, quote: u8, token: Token) -> Option<Token> {
        let from = self.at;
        self.at += 1;
        while self.at < self.bytes.len() && self.peek(0) != b'\n' {
            match self.peek(0) {
                b'$' => self.at += 2,
                byte if byte == quote => {
                    self.at += 1;
                    return Some(token);
                }
                _ => self.at += 1,
            }
        }
        // An escape may have led past the end, or into the middle of a character.
        self.at = self.at.min(self.bytes.len());
        while !self.text.is_char_boundary(self.at) {
            self.at += 1;
        }
        // The `;` of the line is rather that of the statement.
        let text = self.text.get(from..self.at).unwrap_or_default();
        self.at = from + without_end(text).max(1);
        let span = self.span(from);
        let wrong = Diagnostic::error(Code::NotClosed, span, "a string is not closed in its line");
        self.found
            .add(wrong.help("a quote inside of a string is `$'`, a new line `$N`"));
        Some(Token::Broken)
    }
}

/// The bytes of a line without the `;` at its end.
fn without_end(line: &str) -> usize {
    let line = line.trim_end();
    line.strip_suffix(';').unwrap_or(line).len()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kinds(text: &str) -> Vec<Token> {
        let mut found = Found::default();
        let tokens = lex(text, 0, &mut found);
        assert!(!found.has_errors(), "{text}");
        tokens
            .into_iter()
            .map(|(token, _)| token)
            .filter(|token| *token != Token::End)
            .collect()
    }

    #[test]
    fn keywords_are_in_order_so_that_each_is_found() {
        for (text, word) in Word::ALL {
            assert_eq!(Word::find(&text.to_lowercase()), Some(*word));
            assert_eq!(word.text(), *text);
        }
    }

    /// Covers: ST2
    #[test]
    fn comments_of_all_forms_and_pragmas_are_skipped() {
        let text = "a (* one (* two *) one *) b // c\n/* d /* e */ */ {attribute 'qualified_only'} f";
        assert_eq!(kinds(text), [Token::Name; 3]);
    }

    /// Covers: ST3
    #[test]
    fn a_range_is_no_real_and_a_bit_is_no_fraction() {
        assert_eq!(kinds("1..5"), [Token::Integer, Token::Range, Token::Integer]);
        assert_eq!(kinds("w.3"), [Token::Name, Token::Dot, Token::Integer]);
        assert_eq!(kinds("1_0.5E-3 2E5"), [Token::Real, Token::Real]);
        assert_eq!(
            kinds("16#FF_0 T#1d_2h3.5s INT#5"),
            [Token::Based, Token::Duration, Token::Typed, Token::Integer]
        );
    }

    /// Covers: ST3
    #[test]
    fn a_sign_behind_a_number_is_an_operator() {
        use Token::{Duration, Integer, Minus, Name, Plus, Range, Real};
        assert_eq!(kinds("T#1s+Wait"), [Duration, Plus, Name]);
        assert_eq!(kinds("T#1s-T#500ms"), [Duration, Minus, Duration]);
        assert_eq!(kinds("T#-1.5s-LTIME#+2ms"), [Duration, Minus, Duration]);
        assert_eq!(kinds("T#1s..T#2.5s"), [Duration, Range, Duration]);
        assert_eq!(kinds("1.5E3+x"), [Real, Plus, Name]);
        assert_eq!(kinds("1.5E-3-2.0"), [Real, Minus, Real]);
        assert_eq!(
            kinds("1-2..3+4"),
            [Integer, Minus, Integer, Range, Integer, Plus, Integer]
        );
    }
}

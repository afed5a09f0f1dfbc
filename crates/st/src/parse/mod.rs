//! From tokens to the syntax tree. A mistake is reported at its place, and reading continues behind it.

mod declaration;
mod expression;
mod literal;
mod skip;
mod statement;
mod type_spec;

use crate::error::{Code, Diagnostic, Found, nearest, quoted};
use crate::lex::{Token, Word, lex};
use crate::source::{Sources, Span};
use crate::syntax::{Expression, Ident, Item};

/// Deepest nesting of expressions, statements, types and initial values.
pub(crate) const NESTING_MOST: usize = 200;

/// Reads all files.
pub(crate) fn parse(sources: &Sources, found: &mut Found) -> Vec<Item> {
    let mut items = Vec::new();
    for file in 0..sources.count() {
        Parser::new(sources, file, found).file(&mut items);
    }
    items
}

/// Reads the first file, which is one expression.
pub(crate) fn expression(sources: &Sources, found: &mut Found) -> Expression {
    let mut parser = Parser::new(sources, 0, found);
    parser.addresses = true;
    let expression = parser.expression();
    if parser.token() != Token::End {
        let shown = parser.shown();
        let message = format!("the expression is over before {shown}");
        parser.tell_here(Code::Syntax, message, "");
    }
    expression
}

struct Parser<'a> {
    text: &'a str,
    /// Place of the text's first byte.
    start: u32,
    /// The tokens; the last one is [`Token::End`].
    tokens: Vec<(Token, Span)>,
    at: usize,
    /// The token of the last message, because one mistake has one message.
    told_at: Option<usize>,
    depth: usize,
    /// Whether the name of a declaration or element was skipped behind a mistake.
    lost: bool,
    /// Actions and properties of the unit that is being read.
    refused: Vec<Ident>,
    /// Whether an address may take the place of a member: `cell.%IX0.0`, a signal of a script.
    addresses: bool,
    /// The words that close the open parts, from the outside in.
    open: Vec<Word>,
    /// END_IF and similar words without a `;`.
    unended: Vec<Span>,
    found: &'a mut Found,
}

impl<'a> Parser<'a> {
    /// At the beginning of a file.
    fn new(sources: &'a Sources, file: usize, found: &'a mut Found) -> Self {
        let (text, start) = sources.text_of(file);
        Self {
            text,
            start,
            tokens: lex(text, start, found),
            at: 0,
            told_at: None,
            depth: 0,
            lost: false,
            refused: Vec::new(),
            addresses: false,
            open: Vec::new(),
            unended: Vec::new(),
            found,
        }
    }

    fn token(&self) -> Token {
        self.ahead(0)
    }

    fn ahead(&self, by: usize) -> Token {
        self.tokens
            .get(self.at + by)
            .map_or(Token::End, |(token, _)| *token)
    }

    fn span(&self) -> Span {
        self.ahead_span(0)
    }

    fn ahead_span(&self, by: usize) -> Span {
        self.tokens
            .get(self.at + by)
            .map_or_else(Span::default, |(_, span)| *span)
    }

    /// The last token that was taken.
    fn before(&self) -> Span {
        let place = self.at.checked_sub(1).and_then(|place| self.tokens.get(place));
        place.map_or_else(|| self.span().before(), |(_, span)| *span)
    }

    fn text_of(&self, span: Span) -> &str {
        let range = (span.start - self.start) as usize..(span.end - self.start) as usize;
        self.text.get(range).unwrap_or_default()
    }

    /// The text here, for a message.
    fn shown(&self) -> String {
        match self.token() {
            Token::End => "the end of the file".to_owned(),
            _ => quoted(self.text_of(self.span())),
        }
    }

    /// Takes the token; the end of the file stays.
    fn next(&mut self) -> Span {
        let span = self.span();
        if self.token() != Token::End {
            self.at += 1;
        }
        span
    }

    /// Takes the token as a name, whatever it is.
    fn next_ident(&mut self) -> Ident {
        let span = self.next();
        self.ident_at(span)
    }

    fn ident_at(&self, span: Span) -> Ident {
        let text = self.text_of(span).to_owned();
        Ident { text, span }
    }

    /// Passes a token behind a mistake; a name in front of `:` or `,` was probably a declaration.
    fn pass(&mut self) {
        self.lost |= self.token() == Token::Name && matches!(self.ahead(1), Token::Colon | Token::Comma);
        self.next();
    }

    /// Does something, and whether names were lost in it.
    fn losing<T>(&mut self, inner: impl FnOnce(&mut Self) -> T) -> (T, bool) {
        let before = std::mem::replace(&mut self.lost, false);
        let result = inner(self);
        let lost = std::mem::replace(&mut self.lost, before);
        (result, lost)
    }

    fn take(&mut self, token: Token) -> bool {
        let there = self.token() == token;
        if there {
            self.next();
        }
        there
    }

    fn take_word(&mut self, word: Word) -> bool {
        self.take(Token::Word(word))
    }

    /// Takes a name that has a meaning in one place only.
    fn take_name(&mut self, name: &str) -> bool {
        let there = self.is_name(name);
        if there {
            self.next();
        }
        there
    }

    fn is_name(&self, name: &str) -> bool {
        self.token() == Token::Name && self.text_of(self.span()).eq_ignore_ascii_case(name)
    }

    /// Whether a misspelt one of these words is here, which is reported and read as the word.
    fn misspelt(&mut self, words: &[Word]) -> bool {
        const LETTERS_LEAST: usize = 4;
        let text = self.text_of(self.span());
        if self.token() != Token::Name || text.len() < LETTERS_LEAST {
            return false;
        }
        let meant = nearest(text, words.iter().map(|word| word.text()));
        let Some(word) = meant.and_then(Word::find) else {
            return false;
        };
        let message = format!("there is no keyword {}", self.shown());
        self.tell_here(Code::Syntax, message, &format!("did you mean `{}`?", word.text()));
        if let Some((token, _)) = self.tokens.get_mut(self.at) {
            *token = Token::Word(word);
        }
        true
    }

    /// Reports a mistake, unless one was reported at this token.
    fn tell(&mut self, diagnostic: Diagnostic) {
        if self.told_at != Some(self.at) {
            self.told_at = Some(self.at);
            self.found.add(diagnostic);
        }
    }

    fn tell_here(&mut self, code: Code, message: impl Into<String>, help: &str) {
        let mut wrong = Diagnostic::error(code, self.span(), message);
        if !help.is_empty() {
            wrong = wrong.help(help);
        }
        self.tell(wrong);
    }

    fn unsupported(&mut self, span: Span, what: &str, instead: &str) {
        let message = format!("{what} is not supported");
        self.tell(Diagnostic::error(Code::Unsupported, span, message).help(instead));
    }

    /// Takes `token`, or reports that it is missing behind the last one taken.
    fn expect(&mut self, token: Token, sign: &str, after: &str) -> bool {
        if self.take(token) {
            return true;
        }
        let message = format!("`{sign}` is missing {after}, before {}", self.shown());
        let place = self.before().after();
        self.tell(Diagnostic::error(Code::Syntax, place, message).label(format!("`{sign}` belongs here")));
        false
    }

    fn expect_word(&mut self, word: Word, after: &str) -> bool {
        self.expect(Token::Word(word), word.text(), after)
    }

    /// A name to be declared or used; any other text is reported and not taken.
    fn ident(&mut self, what: &str) -> Option<Ident> {
        match self.token() {
            Token::Name => Some(self.next_ident()),
            Token::Word(word) => {
                let message = format!("{what} is expected, and `{}` is a keyword", word.text());
                self.tell_here(Code::BadName, message, "");
                None
            }
            _ => {
                let message = format!("{what} is expected, not {}", self.shown());
                self.tell_here(Code::Syntax, message, "");
                None
            }
        }
    }

    /// A name to be declared. A keyword in its place is reported and taken.
    fn new_name(&mut self, what: &str) -> Option<Ident> {
        if matches!(self.token(), Token::Word(_))
            && matches!(
                self.ahead(1),
                Token::Colon | Token::Comma | Token::Assign | Token::Close | Token::Semicolon
            )
        {
            let text = self.text_of(self.span());
            let message = format!("`{text}` is a keyword and cannot be the name of {what}");
            let help = format!("choose another name, such as `{text}Value`");
            self.tell_here(Code::BadName, message, &help);
            return Some(self.next_ident());
        }
        self.ident(&format!("the name of {what}"))
    }

    /// Enters one level, if that is not too deep; `None` and a message otherwise.
    fn deeper<T>(&mut self, inner: impl FnOnce(&mut Self) -> T) -> Option<T> {
        if self.depth >= NESTING_MOST {
            let message = format!("this is nested more than {NESTING_MOST} levels deep");
            self.tell_here(
                Code::TooDeep,
                message,
                "take parts of it out into variables, functions or types",
            );
            return None;
        }
        self.depth += 1;
        let result = inner(self);
        self.depth -= 1;
        Some(result)
    }

    fn file(&mut self, items: &mut Vec<Item>) {
        while self.token() != Token::End {
            let from = self.at;
            self.item(items);
            if self.at == from {
                self.next();
            }
        }
        self.tell_unended();
    }
}

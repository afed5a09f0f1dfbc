//! The canonical layout of a text: indentation, spaces and the case of keywords. The author's line ends remain;
//! comments are not changed.

use crate::error::{Found, Report};
use crate::lex::{Token, Word, lex_with_comments};
use crate::parse;
use crate::source::{Source, Sources};
use crate::types::Elementary;

const STEP: usize = 2;

/// Lays out the text of a file. Cost: linear in its bytes.
///
/// # Errors
/// The [`Report`] of a text that cannot be read, because its structure is then unknown.
pub fn format(name: &str, bytes: &[u8]) -> Result<String, Box<Report>> {
    let mut found = Found::default();
    let sources = Sources::new(&[Source { name, bytes }], &mut found);
    if found.has_errors() {
        return Err(Box::new(found.report(sources)));
    }
    let _items = parse::parse(&sources, &mut found);
    if found.has_errors() {
        return Err(Box::new(found.report(sources)));
    }
    let (text, start) = sources.text_of(0);
    let mut layout = Layout::default();
    let (tokens, comments) = lex_with_comments(text, start, &mut Found::default());
    let mut comments = comments.into_iter().peekable();
    let piece = |from: u32, to: u32| {
        let bytes = (from - start) as usize..(to - start) as usize;
        text.get(bytes).unwrap_or_default()
    };
    let line_ends = |from: u32, to: u32| piece(from, to).matches('\n').count();
    let mut before = start;
    for (place, (token, span)) in tokens.iter().enumerate() {
        // A comment to the end of its line has a line end behind it.
        let mut least = 0;
        while let Some(comment) = comments.next_if(|it| it.start < span.start) {
            let text = piece(comment.start, comment.end).trim_end();
            layout.comment(text, line_ends(before, comment.start).max(least));
            least = usize::from(text.starts_with("//"));
            before = comment.end;
        }
        let lines = line_ends(before, span.start).max(least);
        if *token != Token::End {
            let rest = tokens.get(place..).unwrap_or_default();
            layout.token(rest, piece(span.start, span.end), lines);
        }
        before = span.end;
    }
    layout.out.push('\n');
    Ok(layout.out.trim_start().to_owned())
}

/// An open construct.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Open {
    /// A unit, whose statements are not indented.
    Unit,
    /// Its contents are indented by one step.
    Block,
    /// CASE: labels by one step, statements by two.
    Case,
    Parenthesis,
}

#[derive(Default)]
struct Layout {
    out: String,
    open: Vec<Open>,
    /// The token before on this line, if any.
    last: Option<Token>,
    /// Whether the last token was an operator or opened something, so that a sign behind it is no subtraction.
    expects_value: bool,
    /// Whether the last token was such a sign.
    signed: bool,
    /// Whether a statement or declaration has begun and is not over.
    inside: bool,
    /// Whether the line began with a word that opens a unit or a section: it ends the part that the word
    /// began.
    header: bool,
    /// Whether a label of CASE is being written.
    label: bool,
}

impl Layout {
    /// Writes a comment or a pragma, with this number of line ends before it.
    fn comment(&mut self, comment: &str, lines: usize) {
        self.begin(lines, 0);
        if !self.out.is_empty() && !self.out.ends_with(['\n', ' ']) {
            self.out.push(' ');
        }
        // Line ends are LF, however many CR stood before one.
        for (index, line) in comment.split('\n').enumerate() {
            self.out.push_str(if index == 0 { "" } else { "\n" });
            self.out.push_str(line.trim_end_matches('\r'));
        }
        self.last = None;
    }

    /// Ends the line, if it ends here, and indents the next one, by `less` steps less than the open
    /// constructs.
    fn begin(&mut self, lines: usize, less: usize) {
        if lines == 0 || self.out.is_empty() {
            return;
        }
        if self.header {
            (self.header, self.inside) = (false, self.open.last() == Some(&Open::Parenthesis));
        }
        let blank = if lines > 1 { "\n\n" } else { "\n" };
        self.out.push_str(blank);
        let steps: usize = self.open.iter().map(|open| open.steps()).sum();
        let parenthesis = self.open.last() == Some(&Open::Parenthesis);
        let more = usize::from(self.inside && !parenthesis);
        let width = (steps + more).saturating_sub(less) * STEP;
        self.out.extend(std::iter::repeat_n(' ', width));
        self.last = None;
    }

    fn token(&mut self, tokens: &[(Token, crate::source::Span)], text: &str, lines: usize) {
        let Some((token, _)) = tokens.first().copied() else {
            return;
        };
        let member = self.last == Some(Token::Dot);
        let word = match token {
            Token::Word(word) if !member => Some(word),
            _ => None,
        };
        if word.is_some_and(closes) {
            self.open.pop();
        }
        let case = self.open.last() == Some(&Open::Case);
        if case && !self.inside && !self.label && is_label(tokens) {
            self.label = true;
        }
        if matches!(token, Token::Close | Token::CloseBracket) {
            self.open.pop();
        }
        if word.is_some_and(begins) {
            self.inside = false;
        }
        let outward = self.label || word == Some(Word::Else) && case;
        let middle = matches!(word, Some(Word::Else | Word::Elsif | Word::Until)) && !case;
        let closing = matches!(token, Token::Close | Token::CloseBracket)
            && self.inside
            && self.open.last() != Some(&Open::Parenthesis);
        self.begin(lines, usize::from(outward || middle || closing));
        let fresh = self.last.is_none();
        let glued = self.out.is_empty() || self.out.ends_with(['\n', ' ']);
        if !glued && (self.last.is_none() || self.space(token)) {
            self.out.push(' ');
        }
        match word {
            Some(word) => self.out.push_str(word.text()),
            None if !member && token == Token::Name && is_type(text) => {
                self.out.push_str(&text.to_ascii_uppercase());
            }
            None => self.out.push_str(text),
        }
        self.follow(token, word, fresh, case);
        self.last = Some(token);
    }

    /// The effect of a written token: the construct that it opens, and what may follow it.
    fn follow(&mut self, token: Token, word: Option<Word>, fresh: bool, case: bool) {
        self.signed = self.expects_value && matches!(token, Token::Minus | Token::Plus);
        self.expects_value = match token {
            Token::Word(Word::True | Word::False | Word::This) => false,
            Token::Word(_) => word.is_some(),
            Token::Name
            | Token::Integer
            | Token::Based
            | Token::Real
            | Token::Duration
            | Token::Text
            | Token::WideText
            | Token::Address
            | Token::Close
            | Token::CloseBracket
            | Token::Caret
            | Token::Dot => false,
            _ => true,
        };
        self.inside = !matches!(token, Token::Semicolon) && !word.is_some_and(ends);
        if token == Token::Semicolon && self.open.last() == Some(&Open::Parenthesis) {
            self.inside = true;
        }
        if self.label && token == Token::Colon {
            (self.label, self.inside) = (false, false);
        }
        if matches!(token, Token::Open | Token::OpenBracket) {
            self.open.push(Open::Parenthesis);
        }
        // `OF` of an array is followed by its type.
        if word == Some(Word::Of) && case {
            self.inside = false;
        }
        if let Some(open) = word.and_then(opens) {
            self.open.push(open);
            self.header |= fresh && matches!(token, Token::Word(word) if opens_header(word));
        }
    }

    /// Whether there is a space before a token on the same line.
    fn space(&self, token: Token) -> bool {
        use Token as T;
        match (self.last.unwrap_or(T::End), token) {
            (T::Open | T::OpenBracket | T::Dot | T::Range | T::Typed, _) => false,
            // A pin left open: `Jerk := ,`
            (T::Assign | T::Output, T::Comma | T::Close) => true,
            (_, T::Comma | T::Semicolon | T::Close | T::CloseBracket | T::Dot | T::Range | T::Caret) => false,
            (T::Name | T::Integer | T::Based | T::CloseBracket | T::Caret, T::Open | T::OpenBracket) => false,
            (_, T::Colon) => !self.label,
            _ => !self.signed,
        }
    }
}

impl Open {
    const fn steps(self) -> usize {
        match self {
            Self::Unit => 0,
            Self::Block | Self::Parenthesis => 1,
            Self::Case => 2,
        }
    }
}

/// The construct that a word opens.
const fn opens(word: Word) -> Option<Open> {
    Some(match word {
        Word::Program | Word::FunctionBlock | Word::Function | Word::Method => Open::Unit,
        Word::Case => Open::Case,
        Word::Type
        | Word::Struct
        | Word::Configuration
        | Word::Resource
        | Word::Var
        | Word::VarInput
        | Word::VarOutput
        | Word::VarInOut
        | Word::VarTemp
        | Word::VarStat
        | Word::VarExternal
        | Word::VarGlobal
        | Word::If
        | Word::For
        | Word::While
        | Word::Repeat => Open::Block,
        _ => return None,
    })
}

/// Whether the line that begins with this word is complete in itself.
const fn opens_header(word: Word) -> bool {
    !matches!(word, Word::Case | Word::If | Word::For | Word::While)
}

/// Whether a word closes a construct that another one opened.
fn closes(word: Word) -> bool {
    word.text().starts_with("END_")
}

/// Whether a statement or declaration begins or ends with this word, so that its line does not continue
/// the one before.
fn begins(word: Word) -> bool {
    closes(word)
        || opens(word).is_some_and(|open| open != Open::Block || word != Word::Struct)
        || matches!(
            word,
            Word::Else | Word::Elsif | Word::Until | Word::Exit | Word::Continue | Word::Return
        )
}

/// Whether what follows this word begins anew.
fn ends(word: Word) -> bool {
    closes(word)
        || matches!(
            word,
            Word::Then | Word::Do | Word::Else | Word::Repeat | Word::Struct | Word::Type
        )
}

fn is_type(text: &str) -> bool {
    Elementary::find(text).is_some() || text.eq_ignore_ascii_case("STRING")
}

/// Whether a label of CASE is here: text before a `:` that comes before the next statement.
fn is_label(tokens: &[(Token, crate::source::Span)]) -> bool {
    let stops = |token: &Token| {
        matches!(
            token,
            Token::Colon | Token::Semicolon | Token::Assign | Token::Open | Token::End
        ) || matches!(token, Token::Word(word) if !matches!(word, Word::True | Word::False))
    };
    let first = tokens.iter().map(|(token, _)| token).find(|token| stops(token));
    first == Some(&Token::Colon)
}

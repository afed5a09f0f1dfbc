//! Expressions, paths and calls.

use super::Parser;
use crate::error::{Code, Diagnostic, quoted};
use crate::lex::{Token, Word};
use crate::source::Span;
use crate::syntax::{
    Argument, Call, Expression, ExpressionKind as Kind, Ident, Operator, Path, Selector, Way,
};

/// The replacement for strings of wide characters.
pub(super) const STRINGS: &str = "use STRING, whose literals stand between `'`";

impl Parser<'_> {
    pub(super) fn expression(&mut self) -> Expression {
        self.chain(0)
    }

    fn operator(&mut self) -> Option<Operator> {
        Some(match self.token() {
            Token::Word(Word::Or) => Operator::Or,
            Token::Word(Word::OrElse) => Operator::OrElse,
            Token::Word(Word::Xor) => Operator::Xor,
            Token::Word(Word::And) | Token::Ampersand => Operator::And,
            Token::Word(Word::AndThen) => Operator::AndThen,
            Token::Equal => Operator::Equal,
            Token::NotEqual => Operator::NotEqual,
            Token::Less => Operator::Less,
            Token::LessEqual => Operator::LessEqual,
            Token::Greater => Operator::Greater,
            Token::GreaterEqual => Operator::GreaterEqual,
            Token::Plus => Operator::Add,
            Token::Minus => Operator::Subtract,
            Token::Star => Operator::Multiply,
            Token::Slash => Operator::Divide,
            Token::Word(Word::Mod) => Operator::Modulo,
            Token::Power => Operator::Power,
            Token::Foreign => return self.foreign_operator(),
            _ => return None,
        })
    }

    /// Operators of C: they are reported, and read with their meaning.
    fn foreign_operator(&mut self) -> Option<Operator> {
        let (operator, right) = match self.text_of(self.span()) {
            "==" => (Operator::Equal, "="),
            "!=" => (Operator::NotEqual, "<>"),
            "&&" => (Operator::And, "AND"),
            "||" => (Operator::Or, "OR"),
            _ => return None,
        };
        let message = format!("{} is an operator of C", self.shown());
        self.tell_here(Code::Syntax, message, &format!("write `{right}`"));
        Some(operator)
    }

    /// Operators that bind tighter than `level`.
    fn chain(&mut self, level: u8) -> Expression {
        let mut first = self.unary();
        while let Some(operator) = self.operator() {
            let here = operator.level();
            if here <= level {
                break;
            }
            // All that follow on the same level, from left to right.
            let mut rest = Vec::new();
            while let Some(operator) = self.operator().filter(|it| it.level() == here) {
                let span = self.next();
                rest.push((operator, span, self.chain(here)));
            }
            let end = rest.last().map_or(first.span, |(_, _, last)| last.span);
            let span = first.span.to(end);
            first = Expression {
                kind: Kind::Chain(Box::new(first), rest),
                span,
            };
        }
        first
    }

    fn unary(&mut self) -> Expression {
        let from = self.span();
        if self.token() == Token::Foreign && self.text_of(from) == "!" {
            self.tell_here(Code::Syntax, "`!` is an operator of C", "write `NOT`");
            return self.prefixed(from, Kind::Not);
        }
        match self.token() {
            Token::Minus => self.prefixed(from, |inner| match inner.kind {
                Kind::Integer(value) => Kind::Integer(-value),
                Kind::Real(value) => Kind::Real(-value),
                _ => Kind::Negative(inner),
            }),
            Token::Plus => {
                self.next();
                self.deeper(Self::unary).unwrap_or_else(|| self.given_up(from))
            }
            Token::Word(Word::Not) => self.prefixed(from, Kind::Not),
            _ => self.primary(),
        }
    }

    fn prefixed(&mut self, from: Span, make: impl FnOnce(Box<Expression>) -> Kind) -> Expression {
        self.next();
        let power = Operator::Power.level() - 1;
        let inner = self.deeper(|parser| parser.chain(power));
        let inner = inner.unwrap_or_else(|| self.given_up(from));
        if matches!(inner.kind, Kind::Chain(..)) && self.text_of(from) == "-" {
            self.found.add(
                Diagnostic::warning(
                    Code::Portability,
                    from.to(inner.span),
                    "compilers differ about `-a ** b`",
                )
                .help("here it is -(a ** b); write the parentheses"),
            );
        }
        let span = from.to(inner.span);
        Expression {
            kind: make(Box::new(inner)),
            span,
        }
    }

    /// Continues after the statement, behind a part that is nested too deep.
    fn given_up(&mut self, span: Span) -> Expression {
        let told = self.told_at == Some(self.at);
        let ends = [Word::Then, Word::Do, Word::Of].map(Token::Word);
        while self.token() != Token::Semicolon && !ends.contains(&self.token()) && !self.at_declaration() {
            self.next();
        }
        if told {
            // A missing part after it has the same cause.
            self.told_at = Some(self.at);
        }
        Expression {
            kind: Kind::Wrong,
            span,
        }
    }

    fn primary(&mut self) -> Expression {
        let from = self.span();
        let kind = match self.token() {
            Token::Word(Word::True) => self.boolean(true),
            Token::Word(Word::False) => self.boolean(false),
            Token::Integer | Token::Based => self.integer(),
            Token::Real => self.real(),
            Token::Duration => self.duration(),
            Token::Typed => self.typed(),
            Token::Open => {
                self.next();
                let inner = self.deeper(Self::expression);
                let inner = inner.unwrap_or_else(|| self.given_up(from));
                if self.token() == Token::Assign {
                    self.tell_here(
                        Code::Syntax,
                        "`:=` assigns, and this is an expression",
                        "compare with `=`",
                    );
                    self.given_up(from);
                }
                self.expect(Token::Close, ")", "behind this expression");
                return Expression {
                    span: from.to(self.before()),
                    kind: inner.kind,
                };
            }
            Token::Name => return self.name_in_expression(),
            // As functions: AND(a, b).
            Token::Word(word @ (Word::And | Word::Or | Word::Xor | Word::Mod))
                if self.ahead(1) == Token::Open =>
            {
                let span = self.next();
                let root = Ident {
                    text: word.text().to_owned(),
                    span,
                };
                let callee = Path {
                    this: false,
                    root,
                    selectors: Vec::new(),
                    span,
                };
                return self.call_expression(callee);
            }
            Token::Text => self.text(),
            Token::Broken => {
                self.next();
                // Its end is unknown, so that what is missing behind it is no other mistake.
                self.told_at = Some(self.at);
                Kind::Wrong
            }
            Token::WideText => {
                self.unsupported(from, "WSTRING", STRINGS);
                self.next();
                Kind::Wrong
            }
            Token::Address => {
                self.unsupported(
                    from,
                    "an address in an expression",
                    "declare a variable at the address: `Sensor AT %IX0.0 : BOOL;`",
                );
                self.next();
                Kind::Wrong
            }
            Token::Word(Word::This) => return self.name_in_expression(),
            Token::Word(Word::Super) => {
                self.unsupported(from, "SUPER^", super::declaration::FLAT);
                self.given_up(from);
                Kind::Wrong
            }
            _ => {
                let message = format!("an expression is expected, not {}", self.shown());
                let help = match (
                    self.text_of(self.before()).to_ascii_uppercase().as_str(),
                    self.token(),
                ) {
                    ("AND", Token::Word(Word::Then)) => "the operator is one word: AND_THEN",
                    ("OR", Token::Word(Word::Else)) => "the operator is one word: OR_ELSE",
                    _ => "",
                };
                self.tell_here(Code::Syntax, message, help);
                Kind::Wrong
            }
        };
        Expression {
            kind,
            span: from.to(self.before()),
        }
    }

    fn name_in_expression(&mut self) -> Expression {
        let Some(path) = self.path() else {
            return self.given_up(self.span());
        };
        if self.token() == Token::Open {
            return self.call_expression(path);
        }
        Expression {
            span: path.span,
            kind: Kind::Path(path),
        }
    }

    fn call_expression(&mut self, callee: Path) -> Expression {
        let call = self.call(callee);
        Expression {
            span: call.span,
            kind: Kind::Call(Box::new(call)),
        }
    }

    /// A variable, or the name of a called unit.
    pub(super) fn path(&mut self) -> Option<Path> {
        let from = self.span();
        let this = self.take_word(Word::This);
        if this {
            self.take(Token::Caret);
            self.expect(Token::Dot, ".", "behind THIS^");
        }
        let root = self.ident("a variable")?;
        let mut selectors = Vec::new();
        loop {
            match self.token() {
                Token::Dot => {
                    self.next();
                    selectors.push(self.member()?);
                }
                Token::OpenBracket => {
                    let from = self.next();
                    let indices = self.deeper(|parser| {
                        let mut indices = vec![parser.expression()];
                        while parser.take(Token::Comma) {
                            indices.push(parser.expression());
                        }
                        indices
                    });
                    let indices = match indices {
                        Some(indices) => indices,
                        None => vec![self.given_up(from)],
                    };
                    self.expect(Token::CloseBracket, "]", "behind the index");
                    selectors.push(Selector::Index(indices, from.to(self.before())));
                }
                Token::Caret => {
                    let span = self.next();
                    self.unsupported(
                        span,
                        "`^`, which follows a pointer,",
                        "hand variables over as VAR_IN_OUT",
                    );
                }
                _ => {
                    let span = from.to(self.before());
                    return Some(Path {
                        this,
                        root,
                        selectors,
                        span,
                    });
                }
            }
        }
    }

    /// The text after a `.`: a member, `3` or `%X3`.
    fn member(&mut self) -> Option<Selector> {
        let span = self.span();
        let digits = match self.token() {
            Token::Integer => self.text_of(span).to_owned(),
            Token::Address => {
                let text = self.text_of(span);
                match text.strip_prefix("%X").or_else(|| text.strip_prefix("%x")) {
                    Some(digits) => digits.to_owned(),
                    None if self.addresses => return Some(Selector::Member(self.next_ident())),
                    None => {
                        let what = format!("{} of a variable", quoted(text));
                        self.unsupported(
                            span,
                            &what,
                            "bits are read and written: w.3, w.%X3; shift with SHR for bytes",
                        );
                        self.next();
                        return None;
                    }
                }
            }
            // Members may have names that are keywords elsewhere; the declaration decides.
            Token::Word(_) => return Some(Selector::Member(self.next_ident())),
            _ => return self.ident("a member").map(Selector::Member),
        };
        self.next();
        let bit: Option<u32> = digits.parse().ok();
        match bit {
            Some(bit) if bit < 64 => Some(Selector::Bit(bit, span)),
            _ => {
                let message = format!("there is no bit {}", quoted(&digits));
                self.found
                    .add(Diagnostic::error(Code::OutOfRange, span, message).help("bits are 0 to 63 at most"));
                None
            }
        }
    }

    /// The arguments after `callee`, which is before a `(`.
    pub(super) fn call(&mut self, callee: Path) -> Call {
        let arguments = self.arguments();
        Call {
            span: callee.span.to(self.before()),
            callee,
            arguments,
        }
    }

    /// `(a, In := b, Out => c)`
    pub(super) fn arguments(&mut self) -> Vec<Argument> {
        let open = self.next();
        let list = self.deeper(|parser| {
            let mut list = Vec::new();
            while !matches!(parser.token(), Token::Close | Token::End | Token::Semicolon) {
                let from = parser.at;
                list.extend(parser.argument());
                if !parser.take(Token::Comma) {
                    break;
                }
                if parser.token() == Token::Close {
                    parser.tell_here(
                        Code::Syntax,
                        "an argument is missing behind the comma",
                        "delete the comma",
                    );
                }
                if parser.at == from {
                    break;
                }
            }
            list
        });
        if list.is_none() {
            self.given_up(open);
        }
        if !self.take(Token::Close) {
            let here = self.shown();
            let wrong = match self.token() {
                Token::Semicolon | Token::End => Diagnostic::error(
                    Code::NotClosed,
                    self.before().after(),
                    format!("`)` is missing before {here}"),
                ),
                _ => Diagnostic::error(
                    Code::Syntax,
                    self.before().after(),
                    format!("`,` or `)` is missing between arguments, before {here}"),
                ),
            };
            self.tell(wrong.related(open, "the arguments begin here"));
            self.skip_to_close();
        }
        list.unwrap_or_default()
    }

    /// After the matching `)`, if it comes before the end of the statement.
    fn skip_to_close(&mut self) {
        let mut depth = 0_usize;
        loop {
            match self.token() {
                Token::End | Token::Semicolon => return,
                Token::Word(word) if super::skip::is_item(word) || super::skip::is_statement(word) => return,
                Token::Open => depth += 1,
                Token::Close if depth == 0 => {
                    self.next();
                    return;
                }
                Token::Close => depth -= 1,
                _ => {}
            }
            self.next();
        }
    }

    fn argument(&mut self) -> Option<Argument> {
        let from = self.span();
        let inverted = self.token() == Token::Word(Word::Not)
            && self.ahead(1) == Token::Name
            && self.ahead(2) == Token::Output;
        if inverted {
            self.next();
        }
        let named = matches!(self.token(), Token::Name | Token::Word(_));
        let (name, way) = match self.ahead(1) {
            Token::Assign if named => (self.argument_name(), Way::In),
            Token::Output if named && inverted => (self.argument_name(), Way::OutInverted),
            Token::Output if named => (self.argument_name(), Way::Out),
            _ => (None, Way::In),
        };
        let enables = name
            .as_ref()
            .filter(|name| ["EN", "ENO"].contains(&name.key().as_str()));
        if let Some(name) = enables {
            self.unsupported(name.span, "a pin EN or ENO", "put the call into an IF");
            if !matches!(self.token(), Token::Comma | Token::Close) {
                self.expression();
            }
            return None;
        }
        // Assistants of editors leave pins open: `Jerk := , Done => `.
        if name.is_some() && matches!(self.token(), Token::Comma | Token::Close) {
            return Some(Argument {
                name,
                way,
                value: None,
                span: from.to(self.before()),
            });
        }
        let value = self.expression();
        if self.token() == Token::Equal || self.token() == Token::Assign {
            self.tell_here(
                Code::Syntax,
                "this is no name of an input",
                "inputs are given as Name := value",
            );
            self.given_up(from);
        }
        Some(Argument {
            name,
            way,
            value: Some(value),
            span: from.to(self.before()),
        })
    }

    fn argument_name(&mut self) -> Option<Ident> {
        let name = self.next_ident();
        self.next();
        Some(name)
    }
}

//! Types as they are written, and initial values.

use super::Parser;
use super::expression::STRINGS;
use crate::error::{Code, Diagnostic};
use crate::lex::{Token, Word};
use crate::source::Span;
use crate::syntax::{Expression, Ident, Initial, SpecKind, TypeSpec};

const POINTERS: &str = "hand variables over as VAR_IN_OUT";

impl Parser<'_> {
    /// A type; `initial` becomes the text in parentheses after a function block, as in CODESYS.
    pub(super) fn type_spec(&mut self, initial: &mut Option<Initial>) -> TypeSpec {
        let from = self.span();
        let kind = self
            .deeper(|parser| parser.spec_kind(initial))
            .unwrap_or(SpecKind::Wrong);
        TypeSpec {
            kind,
            span: from.to(self.before()),
        }
    }

    fn spec_kind(&mut self, initial: &mut Option<Initial>) -> SpecKind {
        let from = self.span();
        match self.token() {
            Token::Word(Word::Array) => self.array(),
            Token::Word(Word::Struct) => self.structure(),
            Token::Open => self.enumeration(None),
            Token::Word(word @ (Word::Pointer | Word::Reference | Word::RefTo)) => {
                let what = match word {
                    Word::RefTo => "REF_TO".to_owned(),
                    _ => format!("{} TO", word.text()),
                };
                self.next();
                self.take_word(Word::To);
                self.unsupported(from, &what, POINTERS);
                // Its target type is read, so that reading continues after it.
                let _there = self.type_spec(&mut None);
                SpecKind::Wrong
            }
            Token::Word(Word::Union) => {
                self.unsupported(
                    from,
                    "UNION",
                    "use a structure; bits are variables, `w.3`, and SHR and DWORD_TO_BYTE(..) give bytes. DWORD_TO_REAL converts the number, not its bits",
                );
                self.skip_past(Word::EndUnion);
                SpecKind::Wrong
            }
            Token::Name => self.named(initial),
            _ => {
                let message = format!("a type is expected, not {}", self.shown());
                self.tell_here(Code::Syntax, message, "");
                SpecKind::Wrong
            }
        }
    }

    fn named(&mut self, initial: &mut Option<Initial>) -> SpecKind {
        let Some(mut name) = self.ident("a type") else {
            return SpecKind::Wrong;
        };
        // A type of a library or of another name space: its last name.
        while self.token() == Token::Dot && self.ahead(1) == Token::Name {
            self.next();
            if let Some(last) = self.ident("a type") {
                name = last;
            }
        }
        let upper = name.key();
        if upper == "STRING" && matches!(self.token(), Token::OpenBracket | Token::Open) {
            let close = if self.take(Token::OpenBracket) {
                (Token::CloseBracket, "]")
            } else {
                self.next();
                (Token::Close, ")")
            };
            let length = self.expression();
            self.expect(close.0, close.1, "behind the length of a STRING");
            return SpecKind::Text(Box::new(length));
        }
        if upper == "WSTRING" {
            self.unsupported(name.span, &upper, STRINGS);
            if matches!(self.token(), Token::OpenBracket | Token::Open) {
                self.next();
                self.expression();
                if !self.take(Token::CloseBracket) {
                    self.take(Token::Close);
                }
            }
            return SpecKind::Wrong;
        }
        if self.token() != Token::Open {
            return SpecKind::Named(name);
        }
        if self.ahead(1) == Token::Name && self.ahead(2) == Token::Assign {
            if crate::types::Elementary::find(&upper).is_some() {
                return self.enumeration(Some(name));
            }
            *initial = Some(self.initial());
            return SpecKind::Named(name);
        }
        if self.ahead(1) == Token::Name && matches!(self.ahead(2), Token::Comma | Token::Close) {
            return self.enumeration(Some(name));
        }
        self.next();
        let low = self.expression();
        self.expect(Token::Range, "..", "in a subrange");
        let high = self.expression();
        self.expect(Token::Close, ")", "behind a subrange");
        SpecKind::Subrange {
            base: name,
            low,
            high,
        }
    }

    fn array(&mut self) -> SpecKind {
        self.next();
        if !self.expect(Token::OpenBracket, "[", "behind ARRAY") {
            return SpecKind::Wrong;
        }
        let mut bounds = Vec::new();
        let mut open_length = false;
        loop {
            if self.token() == Token::Star {
                let span = self.next();
                self.unsupported(
                    span,
                    "an array of any length",
                    "declare the array with its bounds",
                );
                open_length = true;
            } else {
                let low = self.expression();
                self.expect(Token::Range, "..", "between the bounds of an array");
                let high = self.expression();
                bounds.push((low, high));
            }
            if !self.take(Token::Comma) {
                break;
            }
        }
        self.expect(Token::CloseBracket, "]", "behind the bounds");
        self.expect_word(Word::Of, "behind the bounds");
        let of = self.type_spec(&mut None);
        if open_length {
            return SpecKind::Wrong;
        }
        SpecKind::Array {
            bounds,
            of: Box::new(of),
        }
    }

    fn structure(&mut self) -> SpecKind {
        let open = self.next();
        self.open.push(Word::EndStruct);
        let members = self.variables(Word::EndStruct, open, "STRUCT");
        self.open.pop();
        SpecKind::Structure(members)
    }

    fn enumeration(&mut self, base: Option<Ident>) -> SpecKind {
        let open = self.next();
        let mut elements: Vec<(Ident, Option<Expression>)> = Vec::new();
        loop {
            let Some(name) = self.new_name("an element") else {
                self.lost |= self.token() != Token::Close;
                self.skip_to_semicolon_or_close();
                break;
            };
            let value = self.take(Token::Assign).then(|| self.expression());
            elements.push((name, value));
            if self.token() == Token::Name {
                self.expect(Token::Comma, ",", "between elements");
            } else if !self.take(Token::Comma) {
                break;
            }
            if self.token() == Token::Close {
                break;
            }
        }
        if !self.take(Token::Close) {
            let message = format!("`,` or `)` is missing between elements, before {}", self.shown());
            let wrong = Diagnostic::error(Code::Syntax, self.before().after(), message);
            self.tell(wrong.related(open, "the enumeration begins here"));
            self.lost |= !matches!(self.token(), Token::Semicolon | Token::Word(_));
            self.skip_to_semicolon_or_close();
            self.take(Token::Close);
        }
        let base = base.or_else(|| {
            if self.token() == Token::Name {
                self.ident("a type")
            } else {
                None
            }
        });
        SpecKind::Enumeration { base, elements }
    }

    fn skip_to_semicolon_or_close(&mut self) {
        while !matches!(self.token(), Token::Semicolon | Token::Close) && !self.at_declaration() {
            self.pass();
        }
    }

    /// The text after `:=` of a declaration.
    pub(super) fn initial(&mut self) -> Initial {
        let from = self.span();
        let initial = self.deeper(|parser| match parser.token() {
            Token::OpenBracket => parser.list(from),
            Token::Open if parser.ahead(1) == Token::Name && parser.ahead(2) == Token::Assign => {
                parser.members(from)
            }
            _ => Initial::Value(parser.expression()),
        });
        initial.unwrap_or_else(|| {
            self.skip_to_semicolon_or_close();
            Initial::Members(Vec::new(), from)
        })
    }

    fn list(&mut self, from: Span) -> Initial {
        self.next();
        let mut items = Vec::new();
        while self.token() != Token::CloseBracket {
            let here = self.at;
            if matches!(self.token(), Token::Integer | Token::Based) && self.ahead(1) == Token::Open {
                let span = self.span();
                let kind = self.integer();
                self.next();
                let value = self.initial();
                self.expect(Token::Close, ")", "behind what is repeated");
                items.push((Some(Expression { kind, span }), value));
            } else {
                items.push((None, self.initial()));
            }
            if !self.take(Token::Comma) || self.at == here {
                break;
            }
        }
        self.expect(Token::CloseBracket, "]", "behind the values of an array");
        Initial::List(items, from.to(self.before()))
    }

    fn members(&mut self, from: Span) -> Initial {
        self.next();
        let mut members = Vec::new();
        while self.token() == Token::Name {
            let Some(name) = self.ident("a member") else { break };
            self.expect(Token::Assign, ":=", "behind the member");
            members.push((name, self.initial()));
            if !self.take(Token::Comma) {
                break;
            }
        }
        self.expect(Token::Close, ")", "behind the values of members");
        Initial::Members(members, from.to(self.before()))
    }
}

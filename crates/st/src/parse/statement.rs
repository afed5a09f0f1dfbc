//! Statements.

use super::{Parser, skip};
use crate::error::{Code, Diagnostic, quoted};
use crate::lex::{Token, Word};
use crate::source::Span;
use crate::syntax::{Branch, Case, Expression, ExpressionKind, For, Path, Statement, StatementKind as Kind};

impl Parser<'_> {
    /// Statements up to a word that begins none and that closes an open construct.
    pub(super) fn statements(&mut self) -> Vec<Statement> {
        let mut list = Vec::new();
        loop {
            // The words of other languages for ELSIF.
            let other = ["ELSEIF", "ELSE_IF", "ELIF"]
                .iter()
                .any(|word| self.is_name(word));
            if other && self.ahead(1) != Token::Assign && self.is_open(&[Word::EndIf]) {
                self.misspelt(&[Word::Elsif]);
            }
            if self.at_end() {
                break;
            }
            let from = self.at;
            list.extend(self.statement());
            if self.at == from && !self.at_end() {
                self.next();
            }
        }
        list
    }

    /// Whether the statements end here.
    fn at_end(&mut self) -> bool {
        match self.token() {
            Token::End => true,
            Token::Word(Word::Else | Word::Elsif) => self.is_open(&[Word::EndIf, Word::EndCase]),
            Token::Word(Word::Until) => self.is_open(&[Word::EndRepeat]),
            Token::Word(Word::Method | Word::Property) => true,
            Token::Word(word) => {
                (self.open.contains(&word) || skip::is_section(word) && word != Word::EndVar)
                    || matches!(
                        word,
                        Word::Program
                            | Word::FunctionBlock
                            | Word::Function
                            | Word::Type
                            | Word::Configuration
                    )
            }
            _ => self.in_case() && self.is_label(),
        }
    }

    fn is_open(&self, words: &[Word]) -> bool {
        self.open.iter().any(|word| words.contains(word))
    }

    fn in_case(&self) -> bool {
        self.open.last() == Some(&Word::EndCase)
    }

    /// Whether a label of CASE is here: names and numbers up to a `:`.
    fn is_label(&self) -> bool {
        let mut ahead = 0;
        loop {
            match self.ahead(ahead) {
                Token::Colon => return ahead > 0,
                Token::Name
                | Token::Integer
                | Token::Based
                | Token::Typed
                | Token::Duration
                | Token::Real
                | Token::Dot
                | Token::Comma
                | Token::Range
                | Token::Minus
                | Token::Plus
                | Token::Star
                | Token::Word(Word::True | Word::False) => ahead += 1,
                _ => return false,
            }
        }
    }

    fn statement(&mut self) -> Option<Statement> {
        let from = self.span();
        let kind = match self.token() {
            Token::Semicolon => {
                self.next();
                Some(Kind::Empty)
            }
            Token::Name | Token::Word(Word::This) => self.assignment_or_call(),
            Token::Word(word) => self.keyword_statement(word),
            Token::Address => {
                self.unsupported(
                    from,
                    "an address in a statement",
                    "declare a variable at the address: `Lamp AT %QX0.0 : BOOL;`",
                );
                self.skip_to_semicolon();
                None
            }
            _ => {
                let message = format!("a statement is expected, not {}", self.shown());
                self.tell_here(Code::Syntax, message, "");
                self.next();
                self.skip_to_semicolon();
                None
            }
        };
        kind.map(|kind| Statement {
            kind,
            span: from.to(self.before()),
        })
    }

    fn keyword_statement(&mut self, word: Word) -> Option<Kind> {
        let compound = match word {
            Word::If => Self::if_,
            Word::Case => Self::case,
            Word::For => Self::for_,
            Word::While => Self::while_,
            Word::Repeat => Self::repeat,
            _ => return self.simple_statement(word),
        };
        self.deeper(compound).unwrap_or_else(|| {
            // Reading continues after the whole construct, whose end is unknown.
            self.skip_to_item();
            self.told_at = Some(self.at);
            None
        })
    }

    fn simple_statement(&mut self, word: Word) -> Option<Kind> {
        let from = self.span();
        let kind = match word {
            Word::Exit => Kind::Exit,
            Word::Continue => Kind::Continue,
            Word::Return if self.has_value() => {
                self.next();
                self.tell_here(
                    Code::Syntax,
                    "RETURN takes no value",
                    "assign to the function's name, then RETURN;",
                );
                self.expression();
                self.skip_to_semicolon();
                return Some(Kind::Return);
            }
            Word::Return => Kind::Return,
            Word::Jmp | Word::Goto => {
                self.unsupported(from, word.text(), "use IF, CASE, EXIT and CONTINUE");
                self.skip_to_semicolon();
                return None;
            }
            Word::Super => {
                self.unsupported(from, "SUPER^", super::declaration::FLAT);
                self.skip_to_semicolon();
                return None;
            }
            Word::InitialStep => {
                self.unsupported(from, "SFC", "write the steps as CASE State OF ..");
                self.skip_to_item();
                return None;
            }
            Word::EndVar => {
                self.tell_here(Code::Syntax, "`END_VAR` closes a VAR that is not open", "");
                self.next();
                return None;
            }
            _ => {
                let text = word.text();
                let message = match text.strip_prefix("END_") {
                    Some(opened) => format!("`{text}` closes a {opened} that is not open"),
                    None if matches!(word, Word::Else | Word::Elsif) => {
                        format!("`{text}` without an IF or CASE")
                    }
                    None if word == Word::Then => "`THEN` without an IF".to_owned(),
                    None => format!("a statement is expected, not the keyword `{text}`"),
                };
                let wrong_name = matches!(self.ahead(1), Token::Assign | Token::Dot);
                let help = if wrong_name {
                    "a keyword cannot be the name of a variable: choose another one"
                } else {
                    ""
                };
                self.tell_here(
                    if wrong_name { Code::BadName } else { Code::Syntax },
                    message,
                    help,
                );
                self.next();
                if wrong_name {
                    self.skip_to_semicolon();
                } else {
                    self.take(Token::Semicolon);
                }
                return None;
            }
        };
        self.next();
        self.semicolon("behind this statement");
        Some(kind)
    }

    /// Whether an expression begins behind this word, on its line.
    fn has_value(&self) -> bool {
        let begins = matches!(
            self.ahead(1),
            Token::Name
                | Token::Integer
                | Token::Based
                | Token::Real
                | Token::Duration
                | Token::Typed
                | Token::Text
                | Token::Open
                | Token::Minus
                | Token::Word(Word::True | Word::False | Word::Not | Word::This)
        );
        begins && self.same_line(self.span(), self.ahead_span(1))
    }

    /// The `;` of a statement.
    fn semicolon(&mut self, after: &str) {
        if self.take(Token::Semicolon) {
            return;
        }
        self.expect(Token::Semicolon, ";", after);
        // A word that begins a statement ends this one; anything else belongs to it.
        if self.token() == Token::Name {
            return;
        }
        self.skip_to_semicolon();
    }

    /// The `;` after END_IF and similar words, which may be absent.
    fn semicolon_after_end(&mut self) {
        let span = self.before();
        if !self.take(Token::Semicolon) {
            self.unended.push(span);
        }
    }

    /// Reports a missing `;` after END_IF and similar words, once per file, because authors usually omit
    /// all of them.
    pub(super) fn tell_unended(&mut self) {
        let Some(first) = self.unended.first() else { return };
        let word = self.text_of(*first).to_ascii_uppercase();
        let more = match self.unended.len() - 1 {
            0 => String::new(),
            1 => ", and in one more place of this file".to_owned(),
            more => format!(", and in {more} more places of this file"),
        };
        let message = format!("`;` is missing behind {word}{more}");
        let doubt = Diagnostic::warning(Code::Portability, first.after(), message);
        self.found.add(doubt.help("other compilers than CODESYS want it"));
    }

    fn condition(&mut self, end: Word, after: &str) -> Expression {
        let mut condition = self.expression();
        if self.token() == Token::Assign {
            self.tell_here(
                Code::Syntax,
                "`:=` assigns, and a condition is wanted",
                "compare with `=`",
            );
            self.next();
            self.expression();
            condition.kind = ExpressionKind::Wrong;
        }
        if !self.expect_word(end, after) {
            // A `;` or another word in its place; the statements follow.
            let begins = matches!(
                self.ahead(1),
                Token::Assign | Token::Open | Token::Dot | Token::OpenBracket | Token::Equal
            );
            if matches!(self.token(), Token::Semicolon | Token::Colon)
                || self.token() == Token::Name && !begins
            {
                self.next();
            }
        }
        condition
    }

    fn end(&mut self, end: Word, open: Span, what: &str) {
        if self.take_word(end) {
            self.semicolon_after_end();
        } else {
            self.not_closed(end, open, what);
        }
    }

    fn inside(&mut self, end: Word) -> Vec<Statement> {
        self.open.push(end);
        let body = self.statements();
        self.open.pop();
        body
    }

    fn if_(&mut self) -> Option<Kind> {
        let open = self.next();
        let mut branches = Vec::new();
        let condition = self.condition(Word::Then, "behind the condition of IF");
        branches.push((condition, self.inside(Word::EndIf)));
        let mut other = Vec::new();
        loop {
            if self.take_word(Word::Elsif) {
                let condition = self.condition(Word::Then, "behind the condition of ELSIF");
                branches.push((condition, self.inside(Word::EndIf)));
            } else if self.token() == Token::Word(Word::Else)
                && self.ahead(1) == Token::Word(Word::If)
                && self.same_line(self.span(), self.ahead_span(1))
            {
                // Every ELSE IF needs an END_IF of its own, which newcomers forget; it is legal.
                self.next();
                other = self.inside(Word::EndIf);
            } else if self.take_word(Word::Else) {
                other = self.inside(Word::EndIf);
            } else {
                break;
            }
        }
        self.end(Word::EndIf, open, "IF");
        Some(Kind::If(branches, other))
    }

    fn same_line(&self, one: Span, other: Span) -> bool {
        !self.text_of(one.to(other)).contains('\n')
    }

    fn case(&mut self) -> Option<Kind> {
        let open = self.next();
        let selector = self.condition(Word::Of, "behind the selector of CASE");
        let mut branches: Vec<Branch> = Vec::new();
        let mut other = None;
        self.open.push(Word::EndCase);
        loop {
            if self.is_label() {
                let labels = self.labels();
                let body = self.statements();
                branches.push(Branch { labels, body });
            } else if self.take_word(Word::Else) {
                self.take(Token::Colon);
                // A name before a `:` is no longer a label.
                self.open.push(Word::EndCase);
                let mut body = self.statements();
                self.open.pop();
                while self.is_label() {
                    self.tell_here(
                        Code::Misplaced,
                        "a label stands behind ELSE",
                        "move ELSE to the end of CASE",
                    );
                    self.labels();
                    body.extend(self.statements());
                }
                other = Some(body);
            } else if self.token() == Token::Word(Word::EndCase) || self.at_end() {
                break;
            } else {
                let message = format!("a label such as `10:` is expected, not {}", self.shown());
                self.tell_here(
                    Code::Syntax,
                    message,
                    "each branch of CASE begins with its values and a `:`",
                );
                let from = self.at;
                self.statements();
                if self.at == from {
                    self.next();
                }
            }
        }
        self.open.pop();
        self.end(Word::EndCase, open, "CASE");
        Some(Kind::Case(Case {
            selector,
            branches,
            other,
        }))
    }

    fn labels(&mut self) -> Vec<(Expression, Option<Expression>)> {
        let mut labels = Vec::new();
        loop {
            let from = self.expression();
            let to = self.take(Token::Range).then(|| self.expression());
            labels.push((from, to));
            if !self.take(Token::Comma) {
                break;
            }
        }
        if !self.expect(Token::Colon, ":", "behind a label") {
            // There is a colon: without it this would not be a label.
            while !matches!(self.token(), Token::End | Token::Colon) {
                self.next();
            }
            self.take(Token::Colon);
        }
        labels
    }

    fn for_(&mut self) -> Option<Kind> {
        let open = self.next();
        let mut variable = self.ident("the control variable of FOR");
        if matches!(self.token(), Token::Dot | Token::OpenBracket) {
            self.tell_here(
                Code::Syntax,
                "the control variable of FOR is a plain variable",
                "count with a variable of its own, and assign it to the member within the loop",
            );
            while matches!(
                self.token(),
                Token::Dot
                    | Token::OpenBracket
                    | Token::CloseBracket
                    | Token::Name
                    | Token::Integer
                    | Token::Comma
            ) {
                self.next();
            }
            variable = None;
        }
        if self.token() == Token::Equal {
            self.tell_here(Code::Syntax, "`=` compares", "FOR i := 1 TO 10 DO");
            self.next();
        } else {
            self.expect(Token::Assign, ":=", "behind the control variable of FOR");
        }
        let from = self.expression();
        self.expect_word(Word::To, "behind the first value of FOR");
        let to = self.expression();
        let by = self.take_word(Word::By).then(|| self.expression());
        if !self.expect_word(Word::Do, "behind the last value of FOR") {
            self.take(Token::Semicolon);
        }
        let body = self.inside(Word::EndFor);
        self.end(Word::EndFor, open, "FOR");
        variable.map(|variable| {
            Kind::For(Box::new(For {
                variable,
                from,
                to,
                by,
                body,
            }))
        })
    }

    fn while_(&mut self) -> Option<Kind> {
        let open = self.next();
        let condition = self.condition(Word::Do, "behind the condition of WHILE");
        let body = self.inside(Word::EndWhile);
        self.end(Word::EndWhile, open, "WHILE");
        Some(Kind::While(condition, body))
    }

    fn repeat(&mut self) -> Option<Kind> {
        let open = self.next();
        let body = self.inside(Word::EndRepeat);
        if !self.take_word(Word::Until) {
            self.not_closed(Word::Until, open, "REPEAT");
            self.take_word(Word::EndRepeat);
            self.take(Token::Semicolon);
            return None;
        }
        let condition = self.expression();
        self.take(Token::Semicolon);
        self.end(Word::EndRepeat, open, "REPEAT");
        Some(Kind::Repeat(body, condition))
    }

    fn assignment_or_call(&mut self) -> Option<Kind> {
        if self.refused_statement() {
            return None;
        }
        if matches!(
            self.ahead(1),
            Token::Semicolon | Token::Name | Token::Word(_) | Token::End
        ) {
            let mut words = skip::STATEMENTS.to_vec();
            words.extend(&self.open);
            if self.misspelt(&words) {
                return match self.token() {
                    Token::Word(word) if !self.at_end() => self.keyword_statement(word),
                    _ => None,
                };
            }
        }
        let Some(path) = self.path() else {
            self.skip_to_semicolon();
            return None;
        };
        match self.token() {
            Token::Assign => {}
            Token::Equal => self.tell_here(
                Code::Syntax,
                "`=` compares, and its result goes nowhere",
                "assign with `:=`",
            ),
            Token::Open => {
                let call = self.call(path);
                self.semicolon("behind the call");
                return Some(Kind::Call(call));
            }
            _ => {
                self.no_assignment(&path);
                return None;
            }
        }
        self.next();
        let value = self.expression();
        if self.token() == Token::Assign {
            self.unsupported(
                self.span(),
                "to assign twice in one statement",
                "write two statements",
            );
            self.skip_to_semicolon();
            return None;
        }
        // A statement without an end continues with the name of the next one, on another line.
        if matches!(value.kind, ExpressionKind::Wrong) && self.told_at == Some(self.at) {
            self.skip_to_semicolon();
        } else {
            self.semicolon("behind the assignment");
        }
        Some(Kind::Assign(path, value))
    }

    /// Whether a label, an ACTION or SFC is here, which is reported and passed.
    fn refused_statement(&mut self) -> bool {
        let span = self.span();
        match self.ahead(1) {
            Token::Colon => {
                self.unsupported(
                    span,
                    "a label",
                    "use IF, CASE, EXIT and CONTINUE in place of jumps",
                );
                self.next();
                self.next();
            }
            Token::Name if self.is_name("ACTION") => {
                self.unsupported(span, "ACTION", super::declaration::ACTION);
                self.skip_action();
            }
            Token::Name if self.is_name("STEP") || self.is_name("TRANSITION") => {
                self.unsupported(span, "SFC", "write the steps as CASE State OF ..");
                self.skip_to_item();
            }
            _ => return false,
        }
        true
    }

    /// Reports and passes what stands behind a variable in place of `:=` or `(`.
    fn no_assignment(&mut self, path: &Path) {
        let target = self.text_of(path.span).to_owned();
        match self.token() {
            Token::Foreign => {
                let message = format!("{} is no operator of Structured Text", self.shown());
                let help = format!("write `{target} := {target} + 1;`, and compare with `=`");
                self.tell_here(Code::Syntax, message, &help);
            }
            Token::Name if self.ahead(1) == Token::Equal && self.is_vendor_assignment() => {
                let sign = self.shown();
                let what = format!("{}=`", sign.trim_end_matches('`'));
                let help = match sign.to_ascii_uppercase().as_str() {
                    "`S`" => format!("write IF .. THEN {target} := TRUE; END_IF;"),
                    "`R`" => format!("write IF .. THEN {target} := FALSE; END_IF;"),
                    _ => "hand variables over as VAR_IN_OUT".to_owned(),
                };
                self.unsupported(self.span(), &what, &help);
            }
            Token::Name if path.selectors.is_empty() && self.is_instruction(path.span) => {
                self.unsupported(path.span, "Instruction List", "write it as Structured Text");
                self.skip_to_item();
                return;
            }
            _ => {
                let message = format!("`:=` or `(` is expected behind {}", quoted(&target));
                let wrong = Diagnostic::error(Code::Syntax, path.span.after(), message);
                self.tell(wrong.help("a value is assigned with `:=`, a block is called with `()`"));
            }
        }
        self.skip_to_semicolon();
    }

    /// Whether the assignment is one of those that some systems have: `S=`, `R=`, `REF=`.
    fn is_vendor_assignment(&self) -> bool {
        ["S", "R", "REF"].iter().any(|word| self.is_name(word))
    }

    /// Whether a word is an instruction of IL.
    fn is_instruction(&self, span: Span) -> bool {
        let text = self.text_of(span).to_ascii_uppercase();
        [
            "LD", "LDN", "ST", "STN", "CAL", "CALC", "JMPC", "RET", "ANDN", "ORN",
        ]
        .contains(&text.as_str())
    }
}

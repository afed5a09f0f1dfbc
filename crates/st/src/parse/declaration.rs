//! The top level of a file, and sections of variables.

use super::{Parser, skip};
use crate::error::{Code, Diagnostic};
use crate::lex::{Token, Word};
use crate::source::Span;
use crate::syntax::{
    Configuration, Ident, Instance, Item, Section, SectionKind, SpecKind, Task, TypeDeclaration, TypeSpec,
    Unit, UnitKind, Variables,
};

/// The replacement for an ACTION.
pub(super) const ACTION: &str =
    "write a METHOD of a FUNCTION_BLOCK, or put the statements where it is called";

/// What begins at the top of a file of SCL only, and its replacement.
const SCL: [(&str, &str); 2] = [
    (
        "DATA_BLOCK",
        "write VAR_GLOBAL .. END_VAR, or an instance of a FUNCTION_BLOCK in VAR",
    ),
    ("ORGANIZATION_BLOCK", "write PROGRAM .. END_PROGRAM"),
];

/// Whether a section of variables begins with it.
fn opens_section(word: Word) -> bool {
    skip::is_section(word) && word != Word::EndVar && word != Word::EndStruct
}

pub(super) const FLAT: &str = "write FUNCTION_BLOCKs that hold instances of others, and FUNCTIONs";

impl Parser<'_> {
    pub(super) fn item(&mut self, items: &mut Vec<Item>) {
        let from = self.span();
        if matches!(self.ahead(1), Token::Name | Token::Word(_)) {
            self.misspelt(skip::ITEMS);
        }
        let Token::Word(word) = self.token() else {
            // A `;` between two programs does no harm.
            if self.take(Token::Semicolon) {
                return;
            }
            if self.is_name("ACTION") {
                self.unsupported(from, "ACTION", ACTION);
                self.skip_action();
                if let Some(Item::Unit(unit)) = items.last_mut() {
                    self.add_refused(unit);
                }
                return;
            }
            let of_siemens = SCL.iter().find(|(name, _)| self.is_name(name));
            if let Some((name, instead)) = of_siemens {
                let message = format!("{name} of SCL, the dialect of Siemens, is not supported");
                self.tell(Diagnostic::error(Code::Unsupported, from, message).help(*instead));
            } else {
                let message = format!(
                    "a PROGRAM, FUNCTION_BLOCK, FUNCTION, TYPE or VAR_GLOBAL begins here, not {}",
                    self.shown()
                );
                self.tell_here(
                    Code::Syntax,
                    message,
                    "statements stand in a PROGRAM .. END_PROGRAM",
                );
            }
            items.push(Self::unknown_item(from));
            self.skip_to_item();
            self.pass_end();
            return;
        };
        match word {
            Word::Type => self.types(items),
            Word::VarGlobal => {
                let section = self.section();
                items.extend(section.map(Item::Globals));
            }
            Word::Program => items.extend(self.unit(UnitKind::Program, Word::EndProgram)),
            Word::FunctionBlock => items.extend(self.unit(UnitKind::FunctionBlock, Word::EndFunctionBlock)),
            Word::Function => items.extend(self.unit(UnitKind::Function, Word::EndFunction)),
            Word::Configuration => items.extend(self.configuration()),
            Word::Class | Word::Interface => {
                self.unsupported(from, word.text(), FLAT);
                self.next();
                while self.is_access() {
                    self.next();
                }
                items.extend(self.name_of_damaged());
                self.skip_past(match word {
                    Word::Class => Word::EndClass,
                    _ => Word::EndInterface,
                });
            }
            // What is in it is read, so that its names are known.
            Word::Namespace => {
                self.unsupported(from, word.text(), FLAT);
                self.next();
                while matches!(self.token(), Token::Name | Token::Dot) {
                    self.next();
                }
            }
            Word::EndNamespace => {
                self.next();
            }
            Word::VarAccess | Word::VarConfig => self.refused_section(word),
            _ => {
                let message = match word.text().strip_prefix("END_") {
                    Some(opened) => format!("`{}` closes a {opened} that is not open", word.text()),
                    None => format!(
                        "`{}` cannot stand outside of a PROGRAM, FUNCTION_BLOCK or FUNCTION",
                        word.text()
                    ),
                };
                self.tell_here(Code::Syntax, message, "");
                self.next();
                self.skip_to_item();
                self.pass_end();
            }
        }
    }

    /// The name here, of something at the top of a file that is refused or cannot be read.
    fn name_of_damaged(&self) -> Option<Item> {
        (self.token() == Token::Name).then(|| Item::Damaged(self.ident_at(self.span())))
    }

    /// Something that could not be read: any unknown name may be its name.
    const fn unknown_item(span: Span) -> Item {
        let text = String::new();
        Item::Damaged(Ident { text, span })
    }

    /// Behind the end of a unit whose beginning could not be read.
    fn pass_end(&mut self) {
        if let Token::Word(Word::EndProgram | Word::EndFunction | Word::EndFunctionBlock | Word::EndType) =
            self.token()
        {
            self.next();
        }
    }

    /// Actions and properties that were read in a unit: they are refused, and known to be no mistake of those who use them.
    fn add_refused(&mut self, unit: &mut Unit) {
        let kind = match unit.kind {
            UnitKind::Function | UnitKind::Method => SectionKind::Var,
            UnitKind::Program | UnitKind::FunctionBlock => SectionKind::Input,
        };
        let names = std::mem::take(&mut self.refused);
        let section = |name| Section::plain(kind, vec![Self::of_unknown_type(vec![(name, None)])], false);
        unit.sections.extend(names.into_iter().map(section));
    }

    /// Notes the name here as that of a part of a unit that is refused.
    pub(super) fn note_refused(&mut self) {
        while self.is_access() {
            self.next();
        }
        if self.token() == Token::Name {
            self.refused.push(self.ident_at(self.span()));
        }
    }

    fn types(&mut self, items: &mut Vec<Item>) {
        let open = self.next();
        self.open.push(Word::EndType);
        loop {
            match self.token() {
                Token::Word(Word::EndType) => {
                    self.next();
                    break;
                }
                Token::Semicolon => {
                    self.next();
                }
                Token::Name => items.extend(self.type_declaration()),
                Token::Word(_) if self.ahead(1) == Token::Colon => items.extend(self.type_declaration()),
                Token::Word(word) if !skip::is_item(word) && !skip::is_section(word) => {
                    self.new_name("a type");
                    self.next();
                    self.skip_to_semicolon();
                }
                _ => {
                    self.not_closed(Word::EndType, open, "TYPE");
                    break;
                }
            }
        }
        self.open.pop();
    }

    fn type_declaration(&mut self) -> Option<Item> {
        let name = self.new_name("a type")?;
        let mut damaged = false;
        if self.token() == Token::Word(Word::Extends) {
            let span = self.span();
            self.unsupported(
                span,
                "EXTENDS",
                "repeat the members, or hold a member of the other type",
            );
            self.next();
            self.ident("a type");
            damaged = true;
        }
        let begins_type = matches!(
            self.token(),
            Token::Open | Token::Name | Token::Word(Word::Struct | Word::Array)
        );
        if !self.expect(Token::Colon, ":", "behind the name of a type") && !begins_type {
            self.skip_to_semicolon();
            return Some(Item::Damaged(name));
        }
        let mut initial = None;
        let (spec, lost) = self.losing(|parser| parser.type_spec(&mut initial));
        if self.take(Token::Assign) {
            initial = Some(self.initial());
        }
        // `E : a, b);` was to be an enumeration.
        damaged |= lost || self.token() == Token::Comma;
        // Behind END_STRUCT and END_UNION it may be absent, as in CODESYS.
        let closed = self.at.checked_sub(1).and_then(|place| self.tokens.get(place));
        let may_miss = matches!(closed, Some((Token::Word(Word::EndStruct | Word::EndUnion), _)));
        if !self.take(Token::Semicolon) && !may_miss {
            self.expect(Token::Semicolon, ";", "behind the declaration of a type");
            if !matches!(self.token(), Token::Name) {
                self.skip_to_semicolon();
            }
        }
        Some(Item::Type(TypeDeclaration {
            name,
            spec,
            initial,
            damaged,
        }))
    }

    /// Reports an open part at a place where it cannot continue.
    pub(super) fn not_closed(&mut self, end: Word, open: Span, what: &str) {
        let message = format!(
            "{what} is not closed: `{}` is missing before {}",
            end.text(),
            self.shown()
        );
        let wrong = Diagnostic::error(Code::NotClosed, self.span(), message);
        self.tell(wrong.related(open, format!("{what} is opened here")));
    }

    fn refused_section(&mut self, word: Word) {
        let span = self.next();
        self.unsupported(
            span,
            word.text(),
            "use VAR_GLOBAL, or inputs and outputs of the PROGRAM",
        );
        self.skip_past(Word::EndVar);
    }

    fn unit(&mut self, kind: UnitKind, end: Word) -> Option<Item> {
        let open = self.next();
        while self.is_access() {
            let span = self.next();
            let what = self.text_of(span).to_ascii_uppercase();
            self.unsupported(span, &what, "leave it out");
        }
        let what = match kind {
            UnitKind::Program => "a program",
            UnitKind::FunctionBlock => "a function block",
            UnitKind::Function => "a function",
            UnitKind::Method => "a method",
        };
        let Some(name) = self.new_name(what) else {
            self.next();
            self.skip_to_item();
            self.pass_end();
            return Some(Self::unknown_item(open));
        };
        let mut damaged = false;
        while let Token::Word(word @ (Word::Extends | Word::Implements)) = self.token() {
            let span = self.next();
            self.unsupported(span, word.text(), FLAT);
            while self.ident("a name").is_some() && self.take(Token::Comma) {}
            // Its base has more members.
            damaged |= word == Word::Extends;
        }
        let mut result = None;
        if kind == UnitKind::Function {
            if self.take(Token::Colon) {
                result = Some(self.type_spec(&mut None));
            }
        } else if self.token() == Token::Colon {
            let message = format!("only a FUNCTION has a type, and {} is {what}", name.text);
            self.tell_here(Code::Syntax, message, "give results by VAR_OUTPUT");
            self.next();
            self.type_spec(&mut None);
        }
        self.take(Token::Semicolon);
        let mut unit = Unit::new(kind, name, result);
        unit.damaged = damaged;
        self.rest_of_unit(&mut unit, end, open);
        Some(Item::Unit(unit))
    }

    /// Variables, statements and the end.
    fn rest_of_unit(&mut self, unit: &mut Unit, end: Word, open: Span) {
        let outer = std::mem::take(&mut self.refused);
        self.open.push(end);
        let sections = self.sections();
        unit.damaged |= sections.iter().any(|section| section.damaged);
        unit.sections = sections;
        self.body(unit, end, open);
        self.open.pop();
        self.add_refused(unit);
        self.refused = outer;
    }

    /// Whether an access word (such as PRIVATE) is here.
    fn is_access(&self) -> bool {
        ["ABSTRACT", "FINAL", "PUBLIC", "PRIVATE", "INTERNAL", "PROTECTED"]
            .iter()
            .any(|it| self.is_name(it))
            && self.ahead(1) == Token::Name
    }

    /// METHOD .. END_METHOD.
    fn method(&mut self) -> Option<Unit> {
        let open = self.next();
        let mut private = false;
        while self.is_access() {
            let span = self.next();
            match self.text_of(span).to_ascii_uppercase().as_str() {
                "PRIVATE" | "PROTECTED" => private = true,
                "ABSTRACT" => self.unsupported(span, "ABSTRACT", "give the method statements"),
                _ => {}
            }
        }
        let Some(name) = self.new_name("a method") else {
            self.skip_past(Word::EndMethod);
            return None;
        };
        let result = self.take(Token::Colon).then(|| self.type_spec(&mut None));
        self.take(Token::Semicolon);
        let mut method = Unit::new(UnitKind::Method, name, result);
        method.private = private;
        self.rest_of_unit(&mut method, Word::EndMethod, open);
        Some(method)
    }

    /// The sections of variables of a unit.
    fn sections(&mut self) -> Vec<Section> {
        let mut sections = Vec::new();
        loop {
            if self.ahead(1) == Token::Name && matches!(self.ahead(2), Token::Colon | Token::Comma) {
                self.misspelt(skip::SECTIONS);
            }
            match self.token() {
                Token::Word(word @ (Word::VarAccess | Word::VarConfig)) => self.refused_section(word),
                Token::Word(Word::VarGlobal) => {
                    let span = self.span();
                    let wrong = Diagnostic::error(
                        Code::Misplaced,
                        span,
                        "VAR_GLOBAL stands outside of programs and blocks",
                    );
                    self.tell(
                        wrong
                            .help("move it to the top of the file; here VAR_EXTERNAL names global variables"),
                    );
                    sections.extend(self.section().map(Self::as_var));
                }
                Token::Word(word) if opens_section(word) => sections.extend(self.section()),
                Token::Name if matches!(self.ahead(1), Token::Colon | Token::Comma) && self.is_closed() => {
                    let message = format!("`VAR` is missing before {}", self.shown());
                    self.tell_here(Code::Syntax, message, "");
                    let span = self.span();
                    let (variables, damaged) =
                        self.losing(|parser| parser.variables(Word::EndVar, span, "VAR"));
                    sections.push(Section::plain(SectionKind::Var, variables, damaged));
                }
                _ => return sections,
            }
        }
    }

    /// A section in a wrong place, so that only this is reported.
    fn as_var(section: Section) -> Section {
        Section {
            kind: SectionKind::Var,
            ..section
        }
    }

    /// Whether END_VAR is before whatever cannot be among declarations.
    fn is_closed(&self) -> bool {
        let rest = self.tokens.get(self.at..).unwrap_or_default();
        let words = rest.iter().filter_map(|(token, _)| match token {
            Token::Word(word) => Some(*word),
            _ => None,
        });
        let mut ends = words.filter(|word| {
            *word != Word::EndStruct
                && (skip::is_section(*word) || skip::is_item(*word) || skip::is_statement(*word))
        });
        ends.next() == Some(Word::EndVar)
    }

    /// The statements of a unit, up to and with its end; methods are between them.
    fn body(&mut self, unit: &mut Unit, end: Word, open: Span) {
        loop {
            unit.body.extend(self.statements());
            match self.token() {
                Token::Word(word) if word == end => {
                    self.next();
                    return;
                }
                Token::Word(Word::Method) if unit.kind == UnitKind::FunctionBlock => {
                    unit.methods.extend(self.method());
                }
                Token::Word(Word::Method) if unit.kind != UnitKind::Method => {
                    self.tell_here(
                        Code::Misplaced,
                        "a METHOD belongs to a FUNCTION_BLOCK",
                        "make it a FUNCTION, or the program a FUNCTION_BLOCK",
                    );
                    self.next();
                    self.note_refused();
                    self.skip_past(Word::EndMethod);
                }
                Token::Word(Word::Property) => {
                    let span = self.next();
                    self.unsupported(span, "PROPERTY", "write two methods, or VAR_INPUT and VAR_OUTPUT");
                    self.note_refused();
                    self.skip_past(Word::EndProperty);
                }
                Token::Word(word) if opens_section(word) => {
                    let message = format!("{} stands behind a statement", word.text());
                    self.tell_here(
                        Code::Misplaced,
                        message,
                        "declare variables before the first statement",
                    );
                    let section = self.section();
                    unit.damaged |= section.as_ref().is_some_and(|section| section.damaged);
                    unit.sections.extend(section);
                }
                _ => {
                    self.not_closed(end, open, &unit.name.text);
                    return;
                }
            }
        }
    }

    /// VAR .. END_VAR, of any kind.
    fn section(&mut self) -> Option<Section> {
        let open = self.span();
        let Token::Word(word) = self.token() else {
            return None;
        };
        let kind = match word {
            Word::VarInput => SectionKind::Input,
            Word::VarOutput => SectionKind::Output,
            Word::VarInOut => SectionKind::InOut,
            Word::VarTemp => SectionKind::Temp,
            Word::VarStat => SectionKind::Static,
            Word::VarExternal => SectionKind::External,
            Word::VarGlobal => SectionKind::Global,
            Word::VarInst => {
                self.unsupported(open, "VAR_INST", "use VAR of the function block");
                SectionKind::Var
            }
            _ => SectionKind::Var,
        };
        self.next();
        let (mut constant, mut retain) = (false, false);
        loop {
            match self.token() {
                Token::Word(Word::Constant) => constant = true,
                Token::Word(Word::Retain | Word::Persistent) => retain = true,
                Token::Word(Word::NonRetain) => {}
                Token::Name
                    if ["PUBLIC", "PRIVATE", "PROTECTED", "INTERNAL"]
                        .iter()
                        .any(|it| self.is_name(it))
                        && matches!(self.ahead(1), Token::Name | Token::Word(_)) =>
                {
                    let span = self.span();
                    self.unsupported(span, "access to single variables", "leave the word out");
                }
                _ => break,
            }
            self.next();
        }
        self.open.push(Word::EndVar);
        let (variables, damaged) = self.losing(|parser| parser.variables(Word::EndVar, open, word.text()));
        self.open.pop();
        Some(Section {
            kind,
            constant,
            retain,
            variables,
            damaged,
        })
    }

    /// Declarations up to and with `end`.
    pub(super) fn variables(&mut self, end: Word, open: Span, what: &str) -> Vec<Variables> {
        let mut list = Vec::new();
        let closed = end != Word::EndVar || self.is_closed();
        loop {
            if !matches!(self.ahead(1), Token::Colon | Token::Comma | Token::Word(Word::At)) {
                self.misspelt(&[end]);
            }
            match self.token() {
                Token::Word(word) if word == end => {
                    self.next();
                    // CODESYS and others allow a `;` there.
                    if end == Word::EndVar {
                        self.take(Token::Semicolon);
                    }
                    return list;
                }
                Token::Semicolon => {
                    self.next();
                }
                // A statement: declarations ended without END_VAR.
                Token::Name
                    if end == Word::EndVar
                        && !closed
                        && matches!(
                            self.ahead(1),
                            Token::Assign | Token::Open | Token::Dot | Token::OpenBracket
                        ) =>
                {
                    self.not_closed(end, open, what);
                    return list;
                }
                Token::Name => list.extend(self.variable()),
                Token::Word(_) if matches!(self.ahead(1), Token::Colon | Token::Comma) => {
                    list.extend(self.variable())
                }
                Token::Word(word)
                    if !skip::is_section(word) && !skip::is_item(word) && !skip::is_statement(word) =>
                {
                    self.new_name("a variable");
                    self.pass();
                    self.skip_to_semicolon();
                }
                Token::End | Token::Word(_) => {
                    self.not_closed(end, open, what);
                    return list;
                }
                _ => {
                    let message = format!("the name of a variable is expected, not {}", self.shown());
                    self.tell_here(Code::Syntax, message, "declare as `Name : INT := 5;`");
                    // Its name is missing: any unknown name may be it.
                    self.lost = true;
                    self.next();
                    self.skip_to_semicolon();
                }
            }
        }
    }

    fn variable(&mut self) -> Option<Variables> {
        let mut names = Vec::new();
        loop {
            let Some(name) = self.new_name("a variable") else {
                self.skip_to_semicolon();
                return Some(Self::of_unknown_type(names));
            };
            let address = if self.take_word(Word::At) {
                self.address()
            } else {
                None
            };
            names.push((name, address));
            // `a b : INT`
            if self.token() == Token::Name && matches!(self.ahead(1), Token::Comma | Token::Colon) {
                self.expect(Token::Comma, ",", "between names");
            } else if !self.take(Token::Comma) {
                break;
            }
        }
        let begins_type = match self.token() {
            Token::Name => true,
            Token::Word(word) => matches!(
                word,
                Word::Array | Word::Struct | Word::Pointer | Word::Reference | Word::RefTo
            ),
            _ => false,
        };
        if matches!(self.token(), Token::Assign | Token::Equal | Token::Semicolon) {
            let message = format!(
                "`:` and a type are missing behind the name, before {}",
                self.shown()
            );
            let wrong = Diagnostic::error(Code::Syntax, self.before().after(), message);
            self.tell(wrong.help("declare as `Name : INT := 5;`, or close the declarations with END_VAR"));
            self.skip_to_semicolon();
            return Some(Self::of_unknown_type(names));
        }
        // With a type behind the name only the `:` is missing.
        if !self.expect(Token::Colon, ":", "behind the name of a variable") && !begins_type {
            self.skip_to_semicolon();
            return Some(Self::of_unknown_type(names));
        }
        let mut initial = None;
        let spec = self.type_spec(&mut initial);
        for (word, block) in [("R_EDGE", "R_TRIG"), ("F_EDGE", "F_TRIG")] {
            if self.is_name(word) {
                let span = self.next();
                let instead = format!("call an instance of {block} with the input as its CLK, and use its Q");
                self.unsupported(span, word, &instead);
            }
        }
        if self.token() == Token::Equal {
            self.tell_here(
                Code::Syntax,
                "`=` compares",
                "an initial value stands behind `:=`",
            );
            self.next();
            initial = Some(self.initial());
        } else if self.take(Token::Assign) {
            initial = Some(self.initial());
        }
        if initial.is_some() && matches!(self.token(), Token::Comma | Token::Open) {
            self.tell_here(
                Code::Syntax,
                "a variable has one first value",
                "the values of an array stand in brackets: [1, 2, 3]",
            );
            initial = None;
            self.skip_to_semicolon();
        } else if !self.take(Token::Semicolon) {
            self.expect(Token::Semicolon, ";", "behind the declaration");
            if !matches!(self.token(), Token::Name) {
                self.skip_to_semicolon();
            }
        }
        Some(Variables { names, spec, initial })
    }

    /// Names whose type could not be read, so that only their declaration is reported.
    fn of_unknown_type(names: Vec<(Ident, Option<Ident>)>) -> Variables {
        let span = names.last().map_or_else(Span::default, |(name, _)| name.span);
        let spec = TypeSpec {
            kind: SpecKind::Wrong,
            span,
        };
        Variables {
            names,
            spec,
            initial: None,
        }
    }

    /// The address behind AT.
    fn address(&mut self) -> Option<Ident> {
        let span = self.span();
        if self.token() != Token::Address {
            let message = format!(
                "an address such as %IX0.0 is expected behind AT, not {}",
                self.shown()
            );
            self.tell_here(Code::Syntax, message, "");
            return None;
        }
        self.next();
        let text = self.text_of(span).to_ascii_uppercase();
        let body = text.get(1..).unwrap_or_default();
        let (area, rest) = body.split_at(body.len().min(1));
        let good = ["I", "Q", "M"].contains(&area)
            && (rest == "*" || {
                let digits = rest.strip_prefix(['X', 'B', 'W', 'D', 'L']).unwrap_or(rest);
                !digits.is_empty() && digits.split('.').all(|part| part.parse::<u32>().is_ok())
            });
        if !good {
            let message = format!("`{text}` is no address");
            let wrong = Diagnostic::error(Code::BadLiteral, span, message);
            self.tell(
                wrong.help("write %IX0.0, %QW2 or %MD4: I, Q or M, then X, B, W, D or L, then numbers"),
            );
        }
        Some(Ident { text, span })
    }

    fn configuration(&mut self) -> Option<Item> {
        let open = self.next();
        let name = self.new_name("a configuration")?;
        let mut configuration = Configuration {
            name,
            globals: Vec::new(),
            tasks: Vec::new(),
            programs: Vec::new(),
        };
        self.open.push(Word::EndConfiguration);
        loop {
            match self.token() {
                Token::Word(Word::EndConfiguration) => {
                    self.next();
                    break;
                }
                Token::Word(Word::Resource) => {
                    let resource = self.next();
                    self.new_name("a resource");
                    if self.take_name("ON") {
                        self.ident("the kind of a processor");
                    }
                    self.resource(&mut configuration, resource);
                }
                Token::Word(Word::EndResource) => {
                    self.tell_here(
                        Code::Syntax,
                        "`END_RESOURCE` closes a RESOURCE that is not open",
                        "",
                    );
                    self.next();
                }
                Token::Word(_) | Token::Name if self.resource_part(&mut configuration) => {}
                _ => {
                    self.not_closed(Word::EndConfiguration, open, "CONFIGURATION");
                    break;
                }
            }
        }
        self.open.pop();
        Some(Item::Configuration(configuration))
    }

    fn resource(&mut self, into: &mut Configuration, open: Span) {
        while !self.take_word(Word::EndResource) {
            if !self.resource_part(into) {
                self.not_closed(Word::EndResource, open, "RESOURCE");
                return;
            }
        }
    }

    /// A TASK, a PROGRAM or global variables; whether there was one.
    fn resource_part(&mut self, into: &mut Configuration) -> bool {
        match self.token() {
            Token::Word(Word::VarGlobal) => into.globals.extend(self.section()),
            Token::Word(word @ (Word::VarAccess | Word::VarConfig)) => self.refused_section(word),
            Token::Word(Word::Program) => into.programs.extend(self.program_instance()),
            Token::Name if self.is_name("TASK") => into.tasks.extend(self.task()),
            Token::Semicolon => {
                self.next();
            }
            _ => return false,
        }
        true
    }

    fn task(&mut self) -> Option<Task> {
        self.next();
        let name = self.new_name("a task")?;
        let mut task = Task {
            name,
            interval: None,
            priority: None,
        };
        if self.token() == Token::Open {
            for argument in self.arguments() {
                let key = argument.name.as_ref().map(Ident::key).unwrap_or_default();
                match key.as_str() {
                    "INTERVAL" => task.interval = argument.value,
                    "PRIORITY" => task.priority = argument.value,
                    "SINGLE" => {
                        self.told_at = None;
                        self.unsupported(argument.span, "SINGLE", "use INTERVAL, and R_TRIG in the program");
                    }
                    _ => {
                        self.told_at = None;
                        let message = "a TASK has INTERVAL and PRIORITY";
                        self.tell(Diagnostic::error(Code::BadArgument, argument.span, message));
                    }
                }
            }
        }
        if !self.expect(Token::Semicolon, ";", "behind a TASK") {
            self.skip_to_semicolon();
        }
        Some(task)
    }

    fn program_instance(&mut self) -> Option<Instance> {
        let from = self.next();
        self.take_word(Word::Retain);
        let Some(name) = self.new_name("a program") else {
            self.skip_to_semicolon();
            return None;
        };
        let task = if self.take_name("WITH") {
            self.ident("a task")
        } else {
            None
        };
        self.expect(Token::Colon, ":", "before the type of the program");
        let Some(program) = self.ident("a PROGRAM") else {
            self.skip_to_semicolon();
            return None;
        };
        let mut arguments = Vec::new();
        if self.token() == Token::Open {
            arguments = self.arguments();
        }
        if !self.expect(Token::Semicolon, ";", "behind a PROGRAM") {
            self.skip_to_semicolon();
        }
        Some(Instance {
            name,
            task,
            program,
            arguments,
            span: from.to(self.before()),
        })
    }
}

//! The names that may be written at a place in the text, according to the tokens before it.

use super::look::{function_text, functions, library_blocks};
use super::{Checker, UnitKind};
use crate::editor::{Completion, CompletionKind, Hover};
use crate::error::Found;
use crate::lex::{Token, Word, lex};
use crate::source::Span;
use crate::types::{Elementary, Member, MemberKind, Type, TypeId, UnitId, WRONG};
use std::collections::BTreeSet;

/// Largest number of offered names.
const MOST: usize = 2000;

/// Keywords that begin or connect statements.
const STATEMENT_WORDS: &[Word] = &[
    Word::If,
    Word::Then,
    Word::Elsif,
    Word::Else,
    Word::EndIf,
    Word::Case,
    Word::Of,
    Word::EndCase,
    Word::For,
    Word::To,
    Word::By,
    Word::Do,
    Word::EndFor,
    Word::While,
    Word::EndWhile,
    Word::Repeat,
    Word::Until,
    Word::EndRepeat,
    Word::Exit,
    Word::Continue,
    Word::Return,
    Word::And,
    Word::Or,
    Word::Xor,
    Word::Not,
    Word::Mod,
    Word::True,
    Word::False,
];

/// Keywords that begin what stands outside of units.
const UNIT_WORDS: &[Word] = &[
    Word::Program,
    Word::FunctionBlock,
    Word::Function,
    Word::Type,
    Word::VarGlobal,
    Word::Configuration,
];

/// A step of a path before the place.
#[derive(Debug)]
enum Part {
    Name(String),
    Index,
}

/// The surroundings of the place in the text.
#[derive(Debug, Default)]
struct Around {
    /// The unit and the method that are open, by name.
    unit: Option<String>,
    method: Option<String>,
    /// Between VAR and END_VAR, or TYPE and END_TYPE.
    declaring: bool,
}

/// The tokens of a file up to a place, and their text.
struct Before<'t> {
    text: &'t str,
    start: u32,
    tokens: Vec<(Token, Span)>,
}

impl Before<'_> {
    /// The token `back` tokens before the place.
    fn token(&self, back: usize) -> Token {
        self.tokens
            .iter()
            .nth_back(back)
            .map_or(Token::End, |(token, _)| *token)
    }

    fn text(&self, back: usize) -> &str {
        let found = self.tokens.iter().nth_back(back).and_then(|(_, span)| {
            let bytes = (span.start - self.start) as usize..(span.end - self.start) as usize;
            self.text.get(bytes)
        });
        found.unwrap_or_default()
    }

    fn around(&self) -> Around {
        let mut around = Around::default();
        for back in (0..self.tokens.len()).rev() {
            let name = || (back > 0).then(|| self.text(back - 1).to_ascii_uppercase());
            match self.token(back) {
                Token::Word(Word::Program | Word::FunctionBlock | Word::Function) => around.unit = name(),
                Token::Word(Word::Method) => {
                    // METHOD PRIVATE Name
                    let after = (0..back).rev().map(|back| self.text(back).to_ascii_uppercase());
                    let mut named = after.skip_while(|it| {
                        matches!(it.as_str(), "PUBLIC" | "PRIVATE" | "PROTECTED" | "INTERNAL")
                    });
                    around.method = named.next();
                }
                Token::Word(Word::EndMethod) => around.method = None,
                Token::Word(Word::EndProgram | Word::EndFunctionBlock | Word::EndFunction) => {
                    around = Around::default();
                }
                Token::Word(
                    Word::Var
                    | Word::VarInput
                    | Word::VarOutput
                    | Word::VarInOut
                    | Word::VarTemp
                    | Word::VarStat
                    | Word::VarGlobal
                    | Word::VarExternal
                    | Word::Type,
                ) => around.declaring = true,
                Token::Word(Word::EndVar | Word::EndType) => around.declaring = false,
                _ => {}
            }
        }
        around
    }

    /// The path that ends `back` tokens before the place, from its root, and whether it begins with
    /// `THIS^`; then it may be empty.
    fn path(&self, mut back: usize) -> Option<(Vec<Part>, bool)> {
        let mut parts = Vec::new();
        loop {
            match self.token(back) {
                Token::CloseBracket => {
                    let mut depth = 0_usize;
                    loop {
                        match self.token(back) {
                            Token::CloseBracket => depth += 1,
                            Token::OpenBracket => depth -= 1,
                            Token::End => return None,
                            _ => {}
                        }
                        back += 1;
                        if depth == 0 {
                            break;
                        }
                    }
                    parts.push(Part::Index);
                }
                Token::Name => {
                    parts.push(Part::Name(self.text(back).to_ascii_uppercase()));
                    back += 1;
                    if self.token(back) != Token::Dot {
                        break;
                    }
                    back += 1;
                }
                Token::Caret if self.token(back + 1) == Token::Word(Word::This) => {
                    parts.reverse();
                    return Some((parts, true));
                }
                _ => return None,
            }
        }
        parts.reverse();
        Some((parts, false))
    }

    /// The distance in tokens to the bracket that is open at the place, if the place is in a call.
    fn open_call(&self) -> Option<usize> {
        let mut depth = 0_usize;
        for back in 0..self.tokens.len() {
            match self.token(back) {
                Token::Close => depth += 1,
                Token::Open if depth == 0 => return Some(back),
                Token::Open => depth -= 1,
                Token::Semicolon | Token::Word(Word::Then | Word::Do | Word::Of) => return None,
                _ => {}
            }
        }
        None
    }
}

/// Whether the name follows a number directly, which is a mistake: `4x`.
fn is_number_before(tokens: &[(Token, Span)], name: Span) -> bool {
    matches!(tokens.last(), Some((Token::Integer | Token::Real | Token::Based | Token::Duration, span)) if span.end == name.start)
}

impl Checker<'_> {
    /// The names that may be written at a place of a file.
    pub(crate) fn complete(mut self, file: usize, place: u32) -> Vec<Completion> {
        let sources = self.sources;
        let (text, start) = sources.text_of(file);
        let Some(prefix) = text.get(..(place - start) as usize) else {
            return Vec::new();
        };
        // With one more letter, a name ends here, unless the place is in a comment, a string or a number.
        let text = format!("{prefix}x");
        let mut tokens = lex(&text, start, &mut Found::default());
        tokens.retain(|(token, _)| *token != Token::End);
        match tokens.pop() {
            Some((Token::Name | Token::Word(_), span))
                if span.end == place + 1 && !is_number_before(&tokens, span) => {}
            _ => return Vec::new(),
        }
        let before = Before {
            text: &text,
            start,
            tokens,
        };
        let around = before.around();
        self.scope = self.unit_at(&around);
        let mut found = self.by_token(&before, &around);
        found.truncate(MOST);
        found
    }

    /// The variable with this name in scripts: a global one, one of a program, or of an instance of a
    /// program.
    pub(crate) fn variable_called(mut self, path: &str) -> Option<Hover> {
        let tokens = lex(path, 0, &mut Found::default());
        let before = Before {
            text: path,
            start: 0,
            tokens: tokens
                .into_iter()
                .filter(|(token, _)| *token != Token::End)
                .collect(),
        };
        let (parts, _) = before.path(0)?;
        let (Part::Name(root), behind) = parts.split_first()? else {
            return None;
        };
        if self.global_names.contains_key(root) {
            return self.declared_by(&parts);
        }
        let programs = self
            .units
            .iter()
            .enumerate()
            .filter(|(_, it)| it.kind == UnitKind::Program);
        let programs = programs.map(|(index, it)| (it.name.to_ascii_uppercase(), UnitId(index as u32)));
        let scopes: Vec<_> = self
            .running
            .iter()
            .map(|it| (it.name.clone(), it.unit))
            .chain(programs)
            .collect();
        for (name, unit) in scopes {
            self.scope = Some(unit);
            let found = match self.declared_by(&parts) {
                None if name == *root => self.declared_by(behind),
                found => found,
            };
            if found.is_some() {
                return found;
            }
        }
        None
    }

    /// The declaration of the last name of a path.
    fn declared_by(&mut self, parts: &[Part]) -> Option<Hover> {
        let last = parts.iter().rposition(|part| matches!(part, Part::Name(_)))?;
        let Part::Name(name) = parts.get(last)? else {
            return None;
        };
        let found = match parts.get(..last)? {
            [] => match self.local(name) {
                Some((unit, place)) => self.told_of(self.unit(unit).members.list.get(place)?, ""),
                None => self.told_of(&self.globals.get(self.only_global(name)?)?.member, ""),
            },
            owner => {
                let ty = self.type_of(owner, false)?;
                match self.types.get(ty) {
                    Type::Structure(of) => self.told_of(of.members.find(name)?.1, ""),
                    Type::Block(unit) => self.told_in(*unit, self.unit(*unit).members.find(name)?.1),
                    _ => return None,
                }
            }
        };
        Some(self.in_sources(found))
    }

    fn unit_at(&self, around: &Around) -> Option<UnitId> {
        let unit = self.unit_names.get(around.unit.as_ref()?).copied()?;
        let method = around.method.as_ref();
        let method = method.and_then(|name| self.methods.get(&(unit, name.clone())).copied());
        Some(method.unwrap_or(unit))
    }

    fn by_token(&mut self, before: &Before<'_>, around: &Around) -> Vec<Completion> {
        match before.token(0) {
            Token::Dot => {
                let Some((path, this)) = before.path(1) else {
                    return Vec::new();
                };
                if path.is_empty() {
                    return self.of_this();
                }
                match self.type_of(&path, this) {
                    Some(ty) => self.parts(ty),
                    None => self.behind_name(&path),
                }
            }
            Token::Typed => {
                let name = before.text(0).trim_end_matches('#').to_ascii_uppercase();
                let ty = self.find_type(&name, Span::default()).map(|(ty, _)| ty);
                ty.map(|ty| self.parts(ty)).unwrap_or_default()
            }
            Token::Word(Word::Of) if around.declaring => self.all_types(),
            Token::Colon if around.declaring || before.token(2) == Token::Word(Word::Function) => {
                self.all_types()
            }
            Token::Open | Token::Comma => {
                let mut found = before
                    .open_call()
                    .and_then(|back| before.path(back + 1))
                    .and_then(|(path, this)| self.callee(&path, this))
                    .map(|unit| self.pins(unit))
                    .unwrap_or_default();
                found.extend(self.names(around));
                found
            }
            _ => self.names(around),
        }
    }

    /// The type of a path; `None` if it does not lead to a variable.
    fn type_of(&mut self, path: &[Part], this: bool) -> Option<TypeId> {
        let (Part::Name(root), rest) = path.split_first()? else {
            return None;
        };
        let mut rest = rest;
        let local = if this {
            let block = self.this_block()?;
            let place = self.unit(block).members.find(root)?.0;
            Some((block, place))
        } else {
            self.local(root)
        };
        let mut ty = match local {
            Some((unit, place)) => self.unit(unit).members.list.get(place)?.ty,
            None => match (self.only_global(root), self.program_named(root)) {
                (Some(place), _) => self.globals.get(place)?.member.ty,
                (None, Some(program)) => self.block_type(program),
                (None, None) => {
                    let (Part::Name(name), behind) = rest.split_first()? else {
                        return None;
                    };
                    rest = behind;
                    self.globals.get(self.listed(root, name)?)?.member.ty
                }
            },
        };
        for part in rest {
            ty = match (self.types.get(ty), part) {
                (Type::Array(array), Part::Index) => array.of,
                (Type::Structure(of), Part::Name(name)) => of.members.find(name)?.1.ty,
                (Type::Block(unit), Part::Name(name)) => self.unit(*unit).members.find(name)?.1.ty,
                _ => return None,
            };
        }
        (ty != WRONG).then_some(ty)
    }

    /// The names behind the name of an enumeration or of a list of global variables.
    fn behind_name(&mut self, path: &[Part]) -> Vec<Completion> {
        let [Part::Name(name)] = path else {
            return Vec::new();
        };
        if let Some((ty, _)) = self.find_type(name, Span::default())
            && self.types.is_enumeration(ty)
        {
            return self.parts(ty);
        }
        let globals = self.globals.iter().filter(|it| it.is_in(name));
        globals.map(|it| self.variable_offered(&it.member)).collect()
    }

    /// The block, function or method that a path calls.
    fn callee(&mut self, path: &[Part], this: bool) -> Option<UnitId> {
        if let Some(ty) = self.type_of(path, this) {
            return match self.types.get(ty) {
                Type::Block(unit) => Some(*unit),
                _ => None,
            };
        }
        let (Part::Name(last), instance) = path.split_last()? else {
            return None;
        };
        let block = match instance {
            [] => self.this_block(),
            _ => {
                let ty = self.type_of(instance, this)?;
                match *self.types.get(ty) {
                    Type::Block(unit) => Some(unit),
                    _ => None,
                }
            }
        };
        let method = block.and_then(|block| self.methods.get(&(block, last.clone())).copied());
        method.or_else(|| self.unit_names.get(last).copied().filter(|_| instance.is_empty()))
    }

    /// The arguments of a call.
    fn pins(&self, unit: UnitId) -> Vec<Completion> {
        let info = self.unit(unit);
        let members = info.members.list.iter();
        let pins = members.filter_map(|member| {
            let way = match member.kind {
                MemberKind::Input | MemberKind::InOut => ":=",
                MemberKind::Output if info.result.is_none() && member.name != "Result" => "=>",
                _ => return None,
            };
            let offered = self.variable_offered(member);
            Some(Completion {
                insert: format!("{} {way} ", member.name),
                kind: CompletionKind::Pin,
                doc: self.doc_in(unit, member),
                ..offered
            })
        });
        pins.collect()
    }

    /// The names behind a dot.
    fn parts(&self, ty: TypeId) -> Vec<Completion> {
        match self.types.get(ty) {
            Type::Enumeration(of) => {
                let elements = of.elements.iter();
                let offered = elements.map(|(name, number)| {
                    let detail = format!("{} := {number}", of.name);
                    Completion::new(name, CompletionKind::Element, detail, "")
                });
                offered.collect()
            }
            Type::Structure(of) => {
                let members = of.members.list.iter();
                members.map(|member| self.variable_offered(member)).collect()
            }
            Type::Block(unit) => {
                let program = self.unit(*unit).kind == UnitKind::Program;
                let seen = |member: &&Member| match member.kind {
                    MemberKind::Input | MemberKind::Output => true,
                    MemberKind::Var => program,
                    _ => false,
                };
                let members = self.unit(*unit).members.list.iter().filter(seen);
                let offered = members.map(|member| Completion {
                    kind: CompletionKind::Pin,
                    doc: self.doc_in(*unit, member),
                    ..self.variable_offered(member)
                });
                let mut offered: Vec<_> = offered.collect();
                offered.extend(self.methods_of(*unit));
                offered
            }
            _ => Vec::new(),
        }
    }

    fn methods_of(&self, block: UnitId) -> Vec<Completion> {
        let own = self.methods.iter().filter(|((of, _), _)| *of == block);
        let offered = own.map(|(_, method)| self.unit_offered(*method, CompletionKind::Function, "METHOD"));
        offered.collect()
    }

    /// The names behind `THIS^.`
    fn of_this(&self) -> Vec<Completion> {
        let Some(block) = self.this_block() else {
            return Vec::new();
        };
        let members = self.unit(block).members.list.iter();
        let mut offered: Vec<_> = members.map(|member| self.variable_offered(member)).collect();
        offered.extend(self.methods_of(block));
        offered
    }

    fn variable_offered(&self, member: &Member) -> Completion {
        let (detail, doc) = (self.type_name(member.ty), self.remark(member.span));
        Completion::new(&member.name, CompletionKind::Variable, detail, doc)
    }

    fn unit_offered(&self, unit: UnitId, kind: CompletionKind, detail: &str) -> Completion {
        let info = self.unit(unit);
        Completion::new(&info.name, kind, detail, self.remark(info.span))
    }

    /// Types, and blocks of which instances are declared.
    fn all_types(&self) -> Vec<Completion> {
        let mut offered = Vec::new();
        for (named, syntax) in self.named.values().map(|it| (it.found.0, it.syntax)) {
            if !self.sources.in_library(syntax.name.span) {
                let detail = match self.types.get(named) {
                    Type::Structure(_) => "STRUCT".to_owned(),
                    Type::Enumeration(_) => "an enumeration".to_owned(),
                    _ => self.type_name(named),
                };
                let doc = self.remark(syntax.name.span);
                offered.push(Completion::new(
                    &syntax.name.text,
                    CompletionKind::Type,
                    detail,
                    doc,
                ));
            }
        }
        for (index, info) in self.units.iter().enumerate() {
            if info.kind == UnitKind::Block && !self.sources.in_library(info.span) {
                let id = UnitId(index as u32);
                offered.push(self.unit_offered(id, CompletionKind::Block, "FUNCTION_BLOCK"));
            }
        }
        let blocks = library_blocks();
        offered.extend(
            blocks.map(|(name, doc)| Completion::new(name, CompletionKind::Block, "of the library", doc)),
        );
        let library = self.library_types.values().map(|ty| self.type_name(*ty));
        offered
            .extend(library.map(|name| Completion::new(&name, CompletionKind::Type, "of the library", "")));
        let elementary = Elementary::ALL.iter().map(|it| it.name());
        let elementary = elementary.chain([super::spec::TEXT]);
        offered.extend(elementary.map(|name| Completion::new(name, CompletionKind::Type, "", "")));
        for (text, doc) in [("ARRAY", "ARRAY [0..9] OF INT"), ("STRUCT", "")] {
            offered.push(Completion::new(text, CompletionKind::Keyword, "", doc));
        }
        offered
    }

    /// The names that an expression or a statement may begin with; outside of units the keywords.
    fn names(&mut self, around: &Around) -> Vec<Completion> {
        let keyword = |word: &Word| Completion::new(word.text(), CompletionKind::Keyword, "", "");
        if self.scope.is_none() {
            return UNIT_WORDS.iter().map(keyword).collect();
        }
        let mut offered = Vec::new();
        let mut seen = BTreeSet::new();
        let block = self.scope.and_then(|unit| self.unit(unit).owner);
        for unit in [self.scope, block].into_iter().flatten() {
            for member in &self.unit(unit).members.list {
                if seen.insert(member.name.to_ascii_uppercase()) {
                    offered.push(self.variable_offered(member));
                }
            }
        }
        if let Some(block) = self.this_block() {
            offered.extend(self.methods_of(block));
        }
        for global in &self.globals {
            if seen.insert(global.member.name.to_ascii_uppercase()) {
                offered.push(self.variable_offered(&global.member));
            }
        }
        for (index, info) in self.units.iter().enumerate() {
            let id = UnitId(index as u32);
            if info.kind == UnitKind::Function && !self.sources.in_library(info.span) {
                offered.push(self.unit_offered(id, CompletionKind::Function, "FUNCTION"));
            }
            let other = info.kind == UnitKind::Program && self.scope != Some(id);
            if other && seen.insert(info.name.to_ascii_uppercase()) {
                offered.push(self.unit_offered(id, CompletionKind::Block, "PROGRAM"));
            }
        }
        let enumerations = self.named.values().map(|it| it.found.0);
        let library = self.library_types.values().copied();
        for ty in enumerations
            .chain(library)
            .filter(|ty| self.types.is_enumeration(*ty))
        {
            offered.extend(
                self.parts(ty)
                    .into_iter()
                    .filter(|it| seen.insert(it.name.to_ascii_uppercase())),
            );
        }
        let function = |name| Completion::new(name, CompletionKind::Function, function_text(name), "");
        offered.extend(functions().map(function));
        if !around.declaring {
            offered.extend(STATEMENT_WORDS.iter().map(keyword));
        }
        offered
    }
}

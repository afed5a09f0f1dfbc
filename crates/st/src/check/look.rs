//! The answer to an editor's question about one place: the name there, and its declaration.

use super::{Checker, UnitKind};
use crate::editor::Hover;
use crate::library::{Function, OPERATORS, blocks, conversion};
use crate::source::Span;
use crate::syntax::{Path, Selector, SpecKind};
use crate::types::{Constant, Elementary, Member, MemberKind, Start, Type, TypeId, UnitId};
use standstill_fb::Pin;

/// The requested place, and the name there.
#[derive(Debug, Default)]
pub(crate) struct Look {
    /// Place of a requested byte, if any.
    at: Option<u32>,
    found: Option<Hover>,
}

impl Look {
    pub(crate) const fn at(place: u32) -> Self {
        Self {
            at: Some(place),
            found: None,
        }
    }
}

impl Checker<'_> {
    /// The result for the requested place.
    pub(crate) fn looked(mut self) -> Option<Hover> {
        for unit in 0..self.units.len() {
            let id = UnitId(unit as u32);
            if self.unit(id).syntax.is_some() {
                self.look_at_unit(self.unit(id).span, id);
            }
        }
        let named: Vec<_> = self.named.values().map(|it| (it.syntax, it.found.0)).collect();
        for (syntax, ty) in named {
            self.look_at_type(syntax.name.span, ty, &syntax.name.key());
            if let SpecKind::Enumeration { elements, .. } = &syntax.spec.kind {
                for (name, _) in elements {
                    self.look_at_element(name.span, ty, name.text.clone());
                }
            }
        }
        let found = self.look.found.take()?;
        Some(self.in_sources(found))
    }

    /// Without a declaration that is not in the files of the user.
    pub(super) fn in_sources(&self, found: Hover) -> Hover {
        let is_there = |span: &Span| *span != Span::default() && !self.sources.in_library(*span);
        Hover {
            declared: found.declared.filter(is_there),
            ..found
        }
    }

    /// Records the name at `span` if that is the requested place; the last one counts.
    pub(super) fn look_at(&mut self, span: Span, tell: impl FnOnce(&Self) -> Hover) {
        if self.look.at.is_some_and(|at| span.start <= at && at <= span.end) && span.start < span.end {
            let found = tell(self);
            self.look.found = Some(Hover { span, ..found });
        }
    }

    pub(super) fn look_at_member(&mut self, span: Span, unit: UnitId, place: usize) {
        self.look_at(span, |checker| {
            let member = checker.unit(unit).members.list.get(place);
            member.map_or_else(Hover::default, |member| checker.told_in(unit, member))
        });
    }

    pub(super) fn look_at_global(&mut self, span: Span, place: usize) {
        self.look_at(span, |checker| {
            checker.told_of(&checker.globals[place].member, "")
        });
    }

    /// A constant of the unit, of its block, or of the project.
    pub(super) fn look_at_constant(&mut self, path: &Path, key: &str, selectors: &[Selector]) {
        let root = path.root.span;
        match selectors {
            [Selector::Member(name)] => {
                if let Some(place) = self.listed(key, &name.key()) {
                    self.look_at_global(name.span, place);
                }
            }
            _ => match (self.local(key), self.only_global(key)) {
                (Some((unit, place)), _) => self.look_at_member(root, unit, place),
                (None, Some(place)) => self.look_at_global(root, place),
                (None, None) => {}
            },
        }
    }

    /// A member of a structure, or of an instance.
    pub(super) fn look_at_part(&mut self, span: Span, of: TypeId, key: &str) {
        if self.look.at.is_none() {
            return;
        }
        match self.types.get(of) {
            Type::Block(unit) => {
                let unit = *unit;
                if let Some((place, _)) = self.unit(unit).members.find(key) {
                    self.look_at_member(span, unit, place);
                }
            }
            Type::Structure(structure) => {
                let of = format!(" of {}", structure.name);
                if let Some(member) = structure.members.find(key).map(|(_, member)| member.clone()) {
                    self.look_at(span, |checker| checker.told_of(&member, &of));
                }
            }
            _ => {}
        }
    }

    pub(super) fn look_at_element(&mut self, span: Span, ty: TypeId, text: String) {
        self.look_at(span, |checker| {
            let of = checker.type_name(ty);
            let element = text.split(' ').next().unwrap_or_default();
            let syntax = checker.named.get(&of.to_ascii_uppercase()).map(|it| it.syntax);
            let declared = syntax.and_then(|syntax| match &syntax.spec.kind {
                SpecKind::Enumeration { elements, .. } => elements
                    .iter()
                    .find(|(name, _)| name.text.eq_ignore_ascii_case(element))
                    .map(|(name, _)| name.span),
                _ => None,
            });
            Hover {
                text: format!("{of}#{text}"),
                doc: format!("an element of the enumeration {of}"),
                declared,
                ..Hover::default()
            }
        });
    }

    pub(super) fn look_at_unit(&mut self, span: Span, unit: UnitId) {
        self.look_at(span, |checker| {
            let info = checker.unit(unit);
            Hover {
                text: checker.unit_text(unit),
                doc: match info.kind {
                    UnitKind::Library(block) => block.doc.to_owned(),
                    _ => checker.remark(info.span),
                },
                declared: Some(info.span),
                ..Hover::default()
            }
        });
    }

    pub(super) fn look_at_type(&mut self, span: Span, ty: TypeId, key: &str) {
        if let Type::Block(unit) = *self.types.get(ty)
            && !self.named.contains_key(key)
        {
            self.look_at_unit(span, unit);
            return;
        }
        self.look_at(span, |checker| {
            let declared = checker.named.get(key).map(|it| it.syntax.name.span);
            let name = declared.map_or(key, |span| checker.sources.text(span));
            Hover {
                text: match checker.type_text(ty) {
                    text if text == name => text,
                    text => format!("{name} : {text}"),
                },
                doc: declared.map_or_else(String::new, |span| checker.remark(span)),
                declared,
                ..Hover::default()
            }
        });
    }

    pub(super) fn look_at_function(&mut self, span: Span, key: &str) {
        self.look_at(span, |_| Hover {
            text: function_text(key),
            doc: "a function of the library".to_owned(),
            ..Hover::default()
        });
    }

    /// A variable in the form of its declaration.
    pub(super) fn told_of(&self, member: &Member, of: &str) -> Hover {
        let section = match member.kind {
            MemberKind::Field => "a member",
            MemberKind::Var => "VAR",
            MemberKind::Input => "VAR_INPUT",
            MemberKind::Output => "VAR_OUTPUT",
            MemberKind::InOut => "VAR_IN_OUT",
            MemberKind::Temp => "VAR_TEMP",
            MemberKind::External(_) => "VAR_GLOBAL",
            MemberKind::Result => "the value",
        };
        let constant = if member.constant { " CONSTANT" } else { "" };
        Hover {
            text: format!("{}  // {section}{constant}{of}", self.declaration(member)),
            doc: self.remark(member.span),
            declared: Some(member.span),
            ..Hover::default()
        }
    }

    /// A variable of a unit.
    pub(super) fn told_in(&self, unit: UnitId, member: &Member) -> Hover {
        let of = format!(" of {}", self.unit(unit).name);
        Hover {
            doc: self.doc_in(unit, member),
            ..self.told_of(member, &of)
        }
    }

    /// The description of a variable in the table of blocks or in the text.
    pub(super) fn doc_in(&self, unit: UnitId, member: &Member) -> String {
        match self.unit(unit).kind {
            UnitKind::Library(block) => block
                .pins()
                .find(|pin| pin.name == member.name)
                .map_or_else(String::new, pin_doc),
            _ => self.remark(member.span),
        }
    }

    /// `name AT %IX0.0 : type := value`
    pub(super) fn declaration(&self, member: &Member) -> String {
        let at = member.address.as_ref().map(|it| format!(" AT {it}"));
        let start = match &member.start {
            Start::Value(value) => self.value_text(*value, member.ty),
            _ => None,
        };
        format!(
            "{}{} : {}{}",
            member.name,
            at.unwrap_or_default(),
            self.type_name(member.ty),
            start.map_or_else(String::new, |it| format!(" := {it}"))
        )
    }

    fn value_text(&self, value: Constant, ty: TypeId) -> Option<String> {
        if let Type::Enumeration(of) = self.types.get(ty) {
            let named = of.elements.iter().find(|(_, it)| value == Constant::Integer(*it));
            return named.map(|(name, _)| name.clone());
        }
        Some(match (value, self.types.elementary(ty)?) {
            (Constant::Integer(number), Elementary::Bool) => (number != 0).to_string().to_uppercase(),
            (Constant::Integer(ns), Elementary::Time | Elementary::Ltime) => match ns {
                0 => "T#0s".to_owned(),
                _ if ns % 1_000_000 == 0 => format!("T#{}ms", ns / 1_000_000),
                _ => format!("T#{ns}ns"),
            },
            (Constant::Integer(number), _) => number.to_string(),
            (Constant::Real(number), _) => format!("{number:?}"),
        })
    }

    /// A type with its parts, on a few lines.
    fn type_text(&self, ty: TypeId) -> String {
        const SHOWN: usize = 40;
        match self.types.get(ty) {
            Type::Structure(it) => {
                let members = it.members.list.iter().take(SHOWN);
                let members = members.map(|member| format!("\n    {};", self.declaration(member)));
                let more = if it.members.list.len() > SHOWN {
                    "\n    .."
                } else {
                    ""
                };
                format!("STRUCT{}{more}\nEND_STRUCT", members.collect::<String>())
            }
            Type::Enumeration(it) => {
                let elements = it.elements.iter().take(SHOWN);
                let elements: Vec<_> = elements
                    .map(|(name, number)| format!("{name} := {number}"))
                    .collect();
                let more = if it.elements.len() > SHOWN { ", .." } else { "" };
                format!("({}{more})", elements.join(", "))
            }
            Type::Subrange { base, low, high, .. } => format!("{}({low}..{high})", base.name()),
            _ => self.type_name(ty),
        }
    }

    /// A unit with its inputs and outputs.
    fn unit_text(&self, unit: UnitId) -> String {
        let info = self.unit(unit);
        let kind = match info.kind {
            UnitKind::Function => "FUNCTION",
            UnitKind::Method => "METHOD",
            UnitKind::Block | UnitKind::Library(_) => "FUNCTION_BLOCK",
            UnitKind::Program => "PROGRAM",
        };
        let result = info.result.and_then(|place| info.members.list.get(place));
        let mut text = format!("{kind} {}", info.name);
        if let Some(result) = result {
            text.push_str(&format!(" : {}", self.type_name(result.ty)));
        }
        for (kind, section) in [
            (MemberKind::InOut, "VAR_IN_OUT"),
            (MemberKind::Input, "VAR_INPUT"),
            (MemberKind::Output, "VAR_OUTPUT"),
        ] {
            let mut members = info.members.list.iter().filter(|it| it.kind == kind).peekable();
            if members.peek().is_some() {
                text.push_str(&format!("\n{section}"));
                members.for_each(|it| text.push_str(&format!("\n    {};", self.declaration(it))));
                text.push_str("\nEND_VAR");
            }
        }
        text
    }

    /// The comment behind a declaration, or on the lines before it.
    pub(super) fn remark(&self, span: Span) -> String {
        if span == Span::default() || self.sources.in_library(span) {
            return String::new();
        }
        self.sources.remark(span)
    }
}

/// The function and its inputs.
pub(super) fn function_text(key: &str) -> String {
    if let Some(function) = Function::find(key) {
        let more = if function.is_open() { ", .." } else { "" };
        return format!("{}({}{more})", function.name(), function.inputs().join(", "));
    }
    if OPERATORS.iter().any(|(name, _)| *name == key) {
        return format!("{key}(IN1, IN2, ..)");
    }
    match conversion(key) {
        Some((_, to)) => format!("{key}(IN) : {}", to.name()),
        None => format!("{key}(..)"),
    }
}

/// The text of the table of blocks for a pin.
fn pin_doc(pin: &Pin) -> String {
    let unit = match pin.unit {
        "" => String::new(),
        unit => format!(" ({unit})"),
    };
    let extension = if pin.extension {
        ", not in the standard"
    } else {
        ""
    };
    format!("{}{unit}{extension}", pin.doc)
}

/// The names of all functions of the library except conversions.
pub(super) fn functions() -> impl Iterator<Item = &'static str> {
    let named = Function::ALL.iter().map(|it| it.name());
    named.chain(OPERATORS.iter().map(|(name, _)| *name))
}

/// The blocks of the registry, each with its one sentence.
pub(super) fn library_blocks() -> impl Iterator<Item = (&'static str, &'static str)> {
    blocks::names().filter_map(|name| Some((name, blocks::find(name)?.doc)))
}

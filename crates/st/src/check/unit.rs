//! The variables of programs, function blocks and functions.

use super::{Checker, State, UnitInfo, UnitKind};
use crate::error::{Code, Diagnostic, quoted};
use crate::library::blocks;
use crate::source::Span;
use crate::syntax::{Ident, Section, SectionKind, Variables};
use crate::types::{Member, MemberKind, Type, UnitId, WRONG};

/// Largest number of inputs of a FUNCTION: interpreters limit the parameters of one.
const INPUTS_MOST: usize = 32;

impl<'a> Checker<'a> {
    /// The unit of a block of the library, created when it is first named.
    pub(super) fn library_block(&mut self, key: &str) -> Option<UnitId> {
        let info = blocks::find(key)?;
        let members = blocks::members(info, &mut self.types, &mut self.library_types);
        let same = self
            .units
            .iter()
            .position(|unit| unit.kind == UnitKind::Library(info));
        let id = same.unwrap_or(self.units.len());
        if same.is_none() {
            self.units.push(UnitInfo {
                kind: UnitKind::Library(info),
                name: info.name.to_owned(),
                span: Span::default(),
                syntax: None,
                owner: None,
                state: State::Done,
                members,
                result: None,
                frame: 0,
            });
        }
        let id = UnitId(id as u32);
        self.unit_names.insert(key.to_owned(), id);
        Some(id)
    }

    /// Determines the variables of a unit and their places in its instances.
    pub(super) fn resolve_unit(&mut self, id: UnitId, span: Span) {
        match self.unit(id).state {
            State::Done => return,
            State::Busy => {
                let unit = self.unit(id);
                let message = format!("`{}` contains an instance of itself", unit.name);
                let wrong = Diagnostic::error(Code::Circle, span, message);
                let wrong = wrong.related(unit.span, "it is declared here");
                self.tell(wrong.help("a block can hold instances of other blocks only, and not in a circle"));
                return;
            }
            State::Todo => {}
        }
        let Some(syntax) = self.unit(id).syntax else {
            return;
        };
        self.unit_mut(id).state = State::Busy;
        let span = syntax.name.span;
        self.needing(span, (), |checker| {
            checker.in_scope(Some(id), |checker| {
                if let Some(result) = &syntax.result {
                    let (ty, start) = checker.spec(result);
                    let name = &syntax.name;
                    let member = Member::new(&name.text, ty, MemberKind::Result, name.span);
                    checker.add_member(id, name, Member { start, ..member });
                    let unit = checker.unit_mut(id);
                    unit.result = Some(unit.members.list.len() - 1);
                }
                for section in &syntax.sections {
                    checker.section(id, section);
                }
            });
        });
        let members = self.unit(id).members.list.iter();
        let inputs = members.filter(|member| member.kind.is_given()).count();
        if self.unit(id).kind.has_frame() && inputs > INPUTS_MOST {
            let message = format!("a FUNCTION or METHOD has at most {INPUTS_MOST} inputs");
            self.error(Code::TooLarge, span, message, "hand over a structure");
        }
        let unit = self.unit_mut(id);
        unit.members.close();
        unit.state = State::Done;
        if u64::from(self.unit(id).members.size) > super::spec::BYTES_MOST {
            self.unit_mut(id).members.size = 0;
            self.too_large(span);
        }
    }

    fn section(&mut self, id: UnitId, section: &'a Section) {
        let function = self.unit(id).kind.has_frame();
        for variables in &section.variables {
            if section.kind == SectionKind::External {
                self.externals(id, variables);
                continue;
            }
            let kind = match section.kind {
                SectionKind::Input => MemberKind::Input,
                SectionKind::Output => MemberKind::Output,
                SectionKind::InOut => MemberKind::InOut,
                SectionKind::Temp => MemberKind::Temp,
                _ if function => MemberKind::Temp,
                _ => MemberKind::Var,
            };
            if section.kind == SectionKind::Static && !section.constant {
                self.check_static(id, variables.spec.span);
            }
            let (ty, start) = self.declared(variables);
            self.check_kind(id, kind, ty, variables);
            for (name, address) in &variables.names {
                let member = Member {
                    start: start.clone(),
                    constant: section.constant,
                    retain: section.retain,
                    address: address.as_ref().map(|address| address.text.clone()),
                    ..Member::new(&name.text, ty, kind, name.span)
                };
                self.add_member(id, name, member);
            }
        }
    }

    /// VAR_STAT is one variable for all instances, so only a PROGRAM can have it as one of its own.
    fn check_static(&mut self, id: UnitId, span: Span) {
        match self.unit(id).kind {
            UnitKind::Function | UnitKind::Method => self.error(
                Code::Misplaced,
                span,
                "a FUNCTION or METHOD keeps nothing between calls",
                "make it a variable of a FUNCTION_BLOCK",
            ),
            UnitKind::Block => self.error(
                Code::Unsupported,
                span,
                "VAR_STAT of a FUNCTION_BLOCK, one variable for all of its instances, is not supported",
                "use VAR_GLOBAL, or VAR if each instance shall have its own",
            ),
            UnitKind::Program | UnitKind::Library(_) => {}
        }
    }

    /// Variables that cannot be declared in a section of this kind.
    fn check_kind(&mut self, id: UnitId, kind: MemberKind, ty: crate::types::TypeId, variables: &Variables) {
        let span = variables.spec.span;
        self.no_program(ty, span);
        let holds_block = self.holds_block(ty);
        if holds_block && matches!(kind, MemberKind::Input | MemberKind::Output) {
            let message = format!("{} is a function block, which is not copied", self.type_name(ty));
            self.error(Code::WrongType, span, message, "hand it over as VAR_IN_OUT");
        }
        if holds_block && kind == MemberKind::Temp {
            let what = match self.unit(id).kind {
                UnitKind::Function => "a FUNCTION",
                UnitKind::Method => "a METHOD",
                _ => "VAR_TEMP",
            };
            let message = format!("{what} keeps nothing between calls, which a function block needs");
            self.error(
                Code::Misplaced,
                span,
                message,
                "declare the instance in VAR of a FUNCTION_BLOCK or PROGRAM",
            );
        }
        if kind == MemberKind::InOut && variables.initial.is_some() {
            self.error(
                Code::Misplaced,
                span,
                "a VAR_IN_OUT has no first value: it is a variable of the caller",
                "",
            );
        }
    }

    /// Whether it contains a block.
    pub(super) fn holds_block(&self, ty: crate::types::TypeId) -> bool {
        match self.types.get(ty) {
            Type::Block(_) => true,
            Type::Array(array) => self.holds_block(array.of),
            Type::Structure(structure) => structure
                .members
                .list
                .iter()
                .any(|member| self.holds_block(member.ty)),
            _ => false,
        }
    }

    fn add_member(&mut self, id: UnitId, name: &Ident, member: Member) {
        self.check_name(name);
        if let Some((_, other)) = self.unit(id).members.find(&name.key()) {
            let other = other.span;
            self.twice(name, other);
            return;
        }
        let (size, align) = if member.kind == MemberKind::InOut {
            (4, 4)
        } else {
            self.size(member.ty)
        };
        let place = self.unit(id).members.list.len();
        self.unit_mut(id).members.add(member, size, align);
        self.look_at_member(name.span, id, place);
    }

    /// VAR_EXTERNAL: names of global variables, with their types.
    fn externals(&mut self, id: UnitId, variables: &'a Variables) {
        let (ty, _) = self.spec(&variables.spec);
        for (name, _) in &variables.names {
            let Some(place) = self.clear_global(&name.key(), name.span) else {
                if !self.global_names.contains_key(&name.key()) && !self.may_be_damaged(&name.key()) {
                    let guess = self.guess(&name.text, self.declared_globals());
                    let message = format!("there is no global variable {}", quoted(&name.text));
                    let wrong = Diagnostic::error(Code::UnknownName, name.span, message);
                    let guess = guess.or_else(|| Some("declare it in VAR_GLOBAL".to_owned()));
                    self.tell(wrong.maybe_help(guess));
                }
                // It is known from here on, so that its uses are not reported, too.
                let member = Member::new(&name.text, WRONG, MemberKind::Var, name.span);
                self.add_member(id, name, member);
                continue;
            };
            self.global(place);
            let global = &self.globals[place].member;
            if global.ty != ty && ty != WRONG && global.ty != WRONG {
                let message = format!(
                    "`{}` is declared as {} here, and as {} in VAR_GLOBAL",
                    name.text,
                    self.type_name(ty),
                    self.type_name(global.ty)
                );
                let other = global.span;
                self.tell(
                    Diagnostic::error(Code::WrongType, name.span, message).related(other, "declared here"),
                );
            }
            if let Some((_, other)) = self.unit(id).members.find(&name.key()) {
                let other = other.span;
                self.twice(name, other);
                continue;
            }
            let global = &self.globals[place].member;
            let member = Member {
                kind: MemberKind::External(place),
                span: name.span,
                ..global.clone()
            };
            self.unit_mut(id).members.put(member);
            self.look_at_global(name.span, place);
        }
    }
}

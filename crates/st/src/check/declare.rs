//! All names: the declarations of all files, before any of them is checked in detail.

use super::{Checker, ConstantEntry, ConstantKey, ElementOf, Global, NamedType, State, UnitInfo, UnitKind};
use crate::error::{Code, Diagnostic};
use crate::library::{Function, OPERATORS, blocks, conversion};
use crate::source::Span;
use crate::syntax::{self, Ident, Item, Section, SectionKind, SpecKind, TypeSpec};
use crate::types::{Elementary, Member, MemberKind, Members, Start, Type, UnitId, WRONG};
use std::collections::BTreeMap;

/// The replacement for a type of the language that is refused.
pub(super) fn in_place_of(key: &str) -> Option<&'static str> {
    Some(match key {
        "WSTRING" => "use STRING",
        "CHAR" => "use BYTE",
        "WCHAR" => "use WORD",
        "DATE" | "TIME_OF_DAY" | "TOD" | "DATE_AND_TIME" | "DT" => {
            "use TIME, which counts from the start of the run: TIME()"
        }
        "LDATE" | "LTOD" | "LDT" => "use LTIME",
        "ANY" | "ANY_NUM" | "ANY_INT" | "ANY_REAL" | "ANY_BIT" | "ANY_ELEMENTARY" | "ANY_DERIVED"
        | "ANY_MAGNITUDE" | "ANY_STRING" | "ANY_DATE" => "write a function for each type",
        "POINTER" => "hand variables over as VAR_IN_OUT",
        _ => return None,
    })
}

impl<'a> Checker<'a> {
    /// Records the names at the top level of files.
    pub(super) fn declare(&mut self, items: &'a [Item]) {
        let mut taken: BTreeMap<String, Span> = BTreeMap::new();
        for item in items {
            match item {
                Item::Type(ty) => {
                    self.new_top_name(&ty.name, &mut taken);
                    self.declare_type(ty);
                }
                Item::Unit(unit) => {
                    self.new_top_name(&unit.name, &mut taken);
                    self.declare_unit(unit);
                }
                Item::Damaged(name) if name.text.is_empty() => self.names_lost = true,
                Item::Damaged(name) => {
                    self.damaged.insert(name.key());
                }
                Item::Globals(section) => self.declare_globals(section),
                Item::Configuration(configuration) => {
                    for section in &configuration.globals {
                        self.declare_globals(section);
                    }
                }
            }
        }
        for ty in self.library_types.values() {
            if let Type::Enumeration(of) = self.types.get(*ty) {
                let names = of.elements.iter().map(|(name, _)| name.as_str());
                let there = self
                    .options
                    .dialect
                    .elements_called(&of.name)
                    .map(|(_, there)| there);
                for name in names.chain(there) {
                    let owners = self.elements.entry(name.to_ascii_uppercase()).or_default();
                    owners.push(ElementOf::Known(*ty));
                }
            }
        }
    }

    /// Reports a name at the top level of a file that is already in use.
    fn new_top_name(&mut self, name: &Ident, taken: &mut BTreeMap<String, Span>) {
        let key = name.key();
        self.check_name(name);
        if let Some(other) = taken.get(&key) {
            self.twice(name, *other);
            return;
        }
        let library = blocks::find(&key).is_some() || self.library_types.contains_key(&key);
        let function = Function::find(&key).is_some()
            || conversion(&key).is_some()
            || OPERATORS.iter().any(|(name, _)| *name == key);
        if (library || function) && !self.sources.in_library(name.span) {
            let message = format!("`{}` has that name in the library", name.text);
            self.error(
                Code::DuplicateName,
                name.span,
                message,
                "choose another name; the library needs no declaration",
            );
        }
        taken.insert(key, name.span);
    }

    pub(super) fn twice(&mut self, name: &Ident, other: Span) {
        let message = format!("the name `{}` is given twice", name.text);
        let wrong = Diagnostic::error(Code::DuplicateName, name.span, message);
        self.tell(
            wrong
                .related(other, "here it is given first")
                .help("names are compared without regard to case"),
        );
    }

    /// Reports a name that is also the name of an elementary type, or whose spelling other compilers refuse.
    pub(super) fn check_name(&mut self, name: &Ident) {
        let key = name.key();
        if Elementary::find(&key).is_some() || key == super::spec::TEXT || in_place_of(&key).is_some() {
            let message = format!("`{}` is the name of a type of the language", name.text);
            self.error(Code::BadName, name.span, message, "choose another name");
        }
        if key.starts_with('_') || key.ends_with('_') || key.contains("__") {
            let message = format!(
                "`{}` begins or ends with `_`, or has two of them in a row",
                name.text
            );
            let doubt = Diagnostic::warning(Code::Portability, name.span, message);
            self.tell(doubt.help("the standard and some compilers refuse such names"));
        }
    }

    fn declare_type(&mut self, ty: &'a syntax::TypeDeclaration) {
        let key = ty.name.key();
        // The members of a structure are named behind it; elements are not.
        self.names_lost |= ty.damaged && !matches!(ty.spec.kind, SpecKind::Structure(_));
        if let SpecKind::Enumeration { elements, .. } = &ty.spec.kind {
            for (element, _) in elements {
                let owners = self.elements.entry(element.key()).or_default();
                let owner = ElementOf::Named(key.clone());
                if !owners.contains(&owner) {
                    owners.push(owner);
                }
            }
        }
        self.named.entry(key).or_insert(NamedType {
            syntax: ty,
            state: State::Todo,
            found: (WRONG, Start::Default),
        });
    }

    fn declare_unit(&mut self, unit: &'a syntax::Unit) {
        let id = self.add_unit(unit, None);
        self.unit_names.entry(unit.name.key()).or_insert(id);
        for method in &unit.methods {
            let own = self.add_unit(method, Some(id));
            self.check_name(&method.name);
            if let Some((name, instead)) = of_the_runtime(&method.name.key()) {
                let message =
                    format!("METHOD {name}, which other systems call by themselves, is not supported");
                self.error(Code::Unsupported, method.name.span, message, instead);
            }
            if let Some(other) = self.methods.insert((id, method.name.key()), own) {
                let other = self.unit(other).span;
                self.twice(&method.name, other);
            }
        }
    }

    /// Records a unit and the names of its constants.
    fn add_unit(&mut self, unit: &'a syntax::Unit, owner: Option<UnitId>) -> UnitId {
        let id = UnitId(self.units.len() as u32);
        self.units.push(UnitInfo {
            kind: match unit.kind {
                syntax::UnitKind::Function => UnitKind::Function,
                syntax::UnitKind::FunctionBlock => UnitKind::Block,
                syntax::UnitKind::Program => UnitKind::Program,
                syntax::UnitKind::Method => UnitKind::Method,
            },
            name: unit.name.text.clone(),
            span: unit.name.span,
            syntax: Some(unit),
            owner,
            state: State::Todo,
            members: Members::default(),
            result: None,
            frame: 0,
        });
        // The caller gives an input its value, which the unit must not change.
        let is_known = |section: &&Section| {
            section.constant && !matches!(section.kind, SectionKind::Input | SectionKind::InOut)
        };
        for section in unit.sections.iter().filter(is_known) {
            for variables in &section.variables {
                for (name, _) in &variables.names {
                    let key = ConstantKey::OfUnit(id, name.key());
                    self.declare_constant(key, &variables.spec, variables.initial.as_ref());
                }
            }
        }
        id
    }

    fn declare_constant(
        &mut self,
        key: ConstantKey,
        spec: &'a TypeSpec,
        initial: Option<&'a syntax::Initial>,
    ) {
        self.constants.entry(key).or_insert(ConstantEntry {
            spec,
            initial,
            state: State::Todo,
            value: None,
        });
    }

    fn declare_globals(&mut self, section: &'a Section) {
        debug_assert_eq!(section.kind, SectionKind::Global);
        self.names_lost |= section.damaged;
        for variables in &section.variables {
            for (name, address) in &variables.names {
                self.check_name(name);
                let list = self.sources.stem(self.sources.file_index(name.span));
                let place = self.globals.len();
                let others = self.global_names.entry(name.key()).or_default();
                let same = others.iter().find(|other| self.globals[**other].is_in(list));
                if let Some(other) = same {
                    let other = self.globals[*other].member.span;
                    self.twice(name, other);
                    continue;
                }
                for other in others.iter() {
                    self.globals[*other].is_shared = true;
                }
                let is_shared = !others.is_empty();
                others.push(place);
                self.globals.push(Global {
                    member: Member {
                        constant: section.constant,
                        retain: section.retain,
                        address: address.as_ref().map(|address| address.text.clone()),
                        ..Member::new(&name.text, WRONG, MemberKind::External(place), name.span)
                    },
                    spec: Some(&variables.spec),
                    initial: variables.initial.as_ref(),
                    list: Some(list),
                    is_shared,
                    state: State::Todo,
                });
                if section.constant {
                    let key = ConstantKey::Global(place);
                    self.declare_constant(key, &variables.spec, variables.initial.as_ref());
                }
            }
        }
    }

    /// Resolves every type, variable and unit, each after those that it needs.
    pub(super) fn resolve(&mut self) {
        let names: Vec<_> = self.named.keys().cloned().collect();
        for name in names {
            self.named_type(&name, Span::default());
        }
        for place in 0..self.globals.len() {
            self.global(place);
        }
        let mut unit = 0;
        while unit < self.units.len() {
            self.resolve_unit(UnitId(unit as u32), Span::default());
            unit += 1;
        }
        for ((block, key), method) in self.methods.clone() {
            let taken = self.unit(block).members.find(&key).map(|(_, member)| member.span);
            if let (Some(other), Some(syntax)) = (taken, self.unit(method).syntax) {
                self.twice(&syntax.name, other);
            }
        }
    }

    /// Determines the type and the initial value of a global variable.
    pub(super) fn global(&mut self, place: usize) {
        let global = &mut self.globals[place];
        let (State::Todo, Some(spec)) = (global.state, global.spec) else {
            return;
        };
        global.state = State::Busy;
        let (initial, span) = (global.initial, global.member.span);
        let (ty, start) = self.in_scope(None, |checker| {
            let (ty, default) = checker.spec(spec);
            // The initial value may need this variable's type.
            checker.globals[place].member.ty = ty;
            let start = initial.map(|initial| checker.start(initial, ty));
            (ty, start.unwrap_or(default))
        });
        self.no_program(ty, span);
        let global = &mut self.globals[place];
        global.member.ty = ty;
        global.member.start = start;
        global.state = State::Done;
        self.look_at_global(span, place);
    }

    /// Programs are instantiated in a CONFIGURATION only.
    pub(super) fn no_program(&mut self, ty: crate::types::TypeId, span: Span) {
        if let Type::Block(unit) = self.types.get(ty)
            && self.unit(*unit).kind == UnitKind::Program
        {
            let message = format!("`{}` is a PROGRAM and no type", self.unit(*unit).name);
            self.error(
                Code::WrongType,
                span,
                message,
                "make it a FUNCTION_BLOCK, or run it in a CONFIGURATION",
            );
        }
    }
}

/// The remedy for a method that the runtime of other systems calls.
fn of_the_runtime(key: &str) -> Option<(&'static str, &'static str)> {
    Some(match key {
        "FB_INIT" => (
            "FB_Init",
            "give variables their first values where they are declared, `n : INT := 100;`, and instances theirs, `C : Counter := (n := 5);`",
        ),
        "FB_EXIT" => ("FB_Exit", "omit it: instances exist as long as the program"),
        "FB_REINIT" => ("FB_Reinit", "omit it: a program does not change while it runs"),
        _ => return None,
    })
}

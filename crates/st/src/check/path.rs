//! From a path in the text to an address in memory.

use super::{Checker, ConstantKey, ElementOf, Global, State, UnitKind};
use crate::error::{Code, Diagnostic, quoted};
use crate::library::{Function, blocks, conversion};
use crate::source::Span;
use crate::syntax::{Expression, Ident, Path, Selector};
use crate::typed::{Base, Expr, Index, Kind, Place};
use crate::types::{Class, Constant, Elementary, Member, MemberKind, Type, TypeId, UnitId};

/// The remedy for a member of AXIS_REF that only other systems have.
const OF_AN_AXIS: &str = "it has `Number`; blocks read the rest of an axis: MC_ReadActualPosition, MC_ReadActualVelocity, MC_ReadStatus, MC_ReadAxisError";

/// The target of a path.
pub(super) enum Named {
    /// A variable, and the reason why it must not be written, if there is one.
    Place(Place, Option<String>),
    /// A constant or an element of an enumeration.
    Value(Expr),
    /// The fault has been reported.
    Nothing,
}

impl<'a> Checker<'a> {
    /// The target of a path. If several enumerations have an element of the name, it is the one of type
    /// `expected`.
    pub(super) fn named(&mut self, path: &'a Path, expected: Option<TypeId>) -> Named {
        self.named_part(path, &path.selectors, expected)
    }

    /// The target of a path with these of its selectors.
    pub(super) fn named_part(
        &mut self,
        path: &'a Path,
        mut selectors: &'a [Selector],
        expected: Option<TypeId>,
    ) -> Named {
        let key = path.root.key();
        if path.this {
            return self.named_of_this(path, selectors);
        }
        if let Some(value) = self.constant_named(&key, selectors, path.root.span) {
            self.look_at_constant(path, &key, selectors);
            return Named::Value(value);
        }
        let mut listed = None;
        let root = self.variable(&key, path.root.span).or_else(|| {
            let (Selector::Member(name), rest) = selectors.split_first()? else {
                return None;
            };
            let place = self.listed(&key, &name.key())?;
            selectors = rest;
            listed = Some((place, name.span));
            Some(self.global_place(place))
        });
        if let Some((place, span)) = listed {
            self.look_at_global(span, place);
        }
        if let Some((place, fixed)) = root {
            return self.select(place, fixed, selectors);
        }
        if let Some(value) = self.element(path, &key, expected) {
            return value;
        }
        self.unknown(path);
        Named::Nothing
    }

    /// A variable behind `THIS^.`: one of the block, even if a method has the same name.
    fn named_of_this(&mut self, path: &'a Path, selectors: &'a [Selector]) -> Named {
        let Some(block) = self.this_block() else {
            self.error(
                Code::Misplaced,
                path.span,
                "THIS^ is the instance of a FUNCTION_BLOCK, and this is none",
                "name the variable directly",
            );
            return Named::Nothing;
        };
        let Some((place, _)) = self.unit(block).members.find(&path.root.key()) else {
            if self.is_damaged(block) {
                return Named::Nothing;
            }
            let info = self.unit(block);
            let names = info.members.list.iter().map(|member| member.name.as_str());
            let guess = self.guess(&path.root.text, names);
            let message = format!("{} has no variable {}", info.name, quoted(&path.root.text));
            self.tell(Diagnostic::error(Code::UnknownName, path.root.span, message).maybe_help(guess));
            return Named::Nothing;
        };
        self.look_at_member(path.root.span, block, place);
        if selectors.is_empty()
            && let Some(value) = self.constant(&ConstantKey::OfUnit(block, path.root.key()), path.root.span)
        {
            return Named::Value(value);
        }
        let (place, fixed) = self.member_place(block, place);
        self.select(place, fixed, selectors)
    }

    /// The function block on whose instance the statements work.
    pub(super) fn this_block(&self) -> Option<UnitId> {
        let unit = self.scope?;
        match self.unit(unit).kind {
            UnitKind::Block => Some(unit),
            _ => self.unit(unit).owner,
        }
    }

    /// A variable of the unit whose names are visible, or of the block that its method belongs to.
    pub(super) fn local(&self, key: &str) -> Option<(UnitId, usize)> {
        let scope = self.scope?;
        let units = [Some(scope), self.unit(scope).owner];
        units.into_iter().flatten().find_map(|unit| {
            let (place, _) = self.unit(unit).members.find(key)?;
            Some((unit, place))
        })
    }

    fn constant_named(&mut self, key: &str, selectors: &[Selector], span: Span) -> Option<Expr> {
        let block = self.scope.and_then(|unit| self.unit(unit).owner);
        for unit in [self.scope, block].into_iter().flatten() {
            if selectors.is_empty()
                && let Some(value) = self.constant(&ConstantKey::OfUnit(unit, key.to_owned()), span)
            {
                return Some(value);
            }
            if self
                .unit(unit)
                .members
                .find(key)
                .is_some_and(|(_, it)| !matches!(it.kind, MemberKind::External(_)))
            {
                return None;
            }
        }
        let place = match selectors {
            [] => self.only_global(key)?,
            [Selector::Member(name)] if !self.variable_exists(key) => self.listed(key, &name.key())?,
            _ => return None,
        };
        self.constant(&ConstantKey::Global(place), span)
    }

    /// The global variable of this name, if only one list has it.
    pub(super) fn only_global(&self, key: &str) -> Option<usize> {
        match self.global_names.get(key)?.as_slice() {
            [only] => Some(*only),
            _ => None,
        }
    }

    /// A global variable by the name of its list, which is that of its file, and its own: `GVL.x`
    pub(super) fn listed(&self, list: &str, key: &str) -> Option<usize> {
        let mut places = self.global_names.get(key)?.iter().copied();
        places.find(|place| self.globals[*place].is_in(list))
    }

    /// The global variable of this name. If several lists have it, that is reported, and it is none of them.
    pub(super) fn clear_global(&mut self, key: &str, span: Span) -> Option<usize> {
        let [first, second, ..] = self.global_names.get(key)?.as_slice() else {
            return self.only_global(key);
        };
        let (one, other) = (&self.globals[*first], &self.globals[*second]);
        let message = format!(
            "several lists of global variables have the name `{}`",
            one.member.name
        );
        let help = format!("name the list, too: {} or {}", one.path(), other.path());
        let wrong = Diagnostic::error(Code::DuplicateName, span, message);
        let wrong = wrong.related(other.member.span, "one of them").help(help);
        self.tell(wrong);
        None
    }

    pub(super) fn variable_exists(&self, key: &str) -> bool {
        self.local(key).is_some() || self.global_names.contains_key(key)
    }

    /// A variable of the unit, or a global one.
    fn variable(&mut self, key: &str, span: Span) -> Option<(Place, Option<String>)> {
        if let Some((unit, place)) = self.local(key) {
            self.look_at_member(span, unit, place);
            return Some(self.member_place(unit, place));
        }
        if !self.global_names.contains_key(key) {
            return self.program_instance(key, span);
        }
        let Some(place) = self.clear_global(key, span) else {
            return Some((Place::plain(Base::Memory, 0, crate::types::WRONG), None));
        };
        self.global(place);
        self.look_at_global(span, place);
        Some(self.global_place(place))
    }

    /// The PROGRAM of this name, if statements can use the name for its instance.
    pub(super) fn program_named(&self, key: &str) -> Option<UnitId> {
        let unit = self.unit_names.get(key).copied()?;
        (self.scope.is_some() && self.unit(unit).kind == UnitKind::Program).then_some(unit)
    }

    /// The instance of a PROGRAM under its own name: the one that a task runs. Without a task it gets an instance
    /// of its own, a global variable that is created when it is first named.
    fn program_instance(&mut self, key: &str, span: Span) -> Option<(Place, Option<String>)> {
        let unit = self.program_named(key)?;
        self.look_at_unit(span, unit);
        let ty = self.block_type(unit);
        let (own, members) = (self.unit(unit).span, &self.unit(unit).members);
        let (bytes, name) = (members.size, self.unit(unit).name.clone());
        let mut running = self.running.iter().filter(|it| it.unit == unit);
        match (running.next(), running.next()) {
            (Some(only), None) => return Some((Place::plain(Base::Memory, only.address, ty), None)),
            (Some(one), Some(other)) => {
                let message = format!(
                    "tasks run several instances of the PROGRAM `{name}`: {}, {}",
                    one.name, other.name
                );
                self.error(Code::UnknownName, span, message, "share VAR_GLOBAL with it");
                return Some((Place::plain(Base::Memory, 0, crate::types::WRONG), None));
            }
            (None, _) => {}
        }
        let place = self.globals.len();
        let offset = self.layout.take(bytes);
        self.check_memory(span);
        self.globals.push(Global {
            member: Member {
                offset,
                ..Member::new(&name, ty, MemberKind::External(place), own)
            },
            spec: None,
            initial: None,
            list: None,
            is_shared: false,
            state: State::Done,
        });
        self.global_names.insert(key.to_owned(), vec![place]);
        Some(self.global_place(place))
    }

    pub(super) fn global_place(&mut self, place: usize) -> (Place, Option<String>) {
        let member = &self.globals[place].member;
        let fixed = self.fixed(None, place, member);
        (Place::plain(Base::Memory, member.offset, member.ty), fixed)
    }

    /// Why a variable of a unit, or a global one, must not be written.
    fn fixed(&self, unit: Option<UnitId>, place: usize, member: &Member) -> Option<String> {
        let name = &member.name;
        if member.constant {
            Some(format!("`{name}` is a CONSTANT"))
        } else if self.body.controls.contains(&(unit, place)) {
            Some(format!(
                "`{name}` is the control variable of a FOR that is running"
            ))
        } else {
            None
        }
    }

    /// A variable of the unit whose statements these are.
    pub(super) fn member_place(&mut self, unit: UnitId, place: usize) -> (Place, Option<String>) {
        let info = self.unit(unit);
        let Some(member) = info.members.list.get(place) else {
            return (Place::plain(Base::Memory, 0, crate::types::WRONG), None);
        };
        if let MemberKind::External(global) = member.kind {
            return self.global_place(global);
        }
        let function = info.kind.has_frame();
        let fixed = self.fixed(Some(unit), place, member);
        let (frame, offset, ty) = (info.frame, member.offset, member.ty);
        let place = match (member.kind, function) {
            (MemberKind::InOut, true) => {
                Place::plain(Base::MemoryPointer(frame.saturating_add(offset)), 0, ty)
            }
            (MemberKind::InOut, false) => Place::plain(Base::ThisPointer(offset), 0, ty),
            (_, true) => Place::plain(Base::Memory, frame.saturating_add(offset), ty),
            (_, false) => Place::plain(Base::This, offset, ty),
        };
        (place, fixed)
    }

    /// Members, elements and bits of a place.
    fn select(&mut self, mut place: Place, mut fixed: Option<String>, selectors: &'a [Selector]) -> Named {
        for selector in selectors {
            if place.ty == crate::types::WRONG {
                return Named::Nothing;
            }
            let (Selector::Bit(_, span) | Selector::Index(_, span) | Selector::Member(Ident { span, .. })) =
                selector;
            if place.bit.is_some() {
                self.error(Code::UnknownMember, *span, "a bit has no parts", "");
                return Named::Nothing;
            }
            let good = match selector {
                Selector::Member(name) => self.member(&mut place, &mut fixed, name),
                Selector::Index(indices, span) => self.index(&mut place, indices, *span),
                Selector::Bit(bit, span) => self.bit(&mut place, *bit, *span),
            };
            if !good {
                return Named::Nothing;
            }
        }
        if place.ty == crate::types::WRONG {
            return Named::Nothing;
        }
        Named::Place(place, fixed)
    }

    /// The members of a structure that has few, as a help.
    fn few_members(&self, ty: TypeId) -> Option<String> {
        const FEW: usize = 4;
        let Type::Structure(structure) = self.types.get(ty) else {
            return None;
        };
        let members = structure.members.list.iter();
        let names: Vec<String> = members.map(|member| quoted(&member.name)).collect();
        (1..=FEW)
            .contains(&names.len())
            .then(|| format!("it has {}", names.join(", ")))
    }

    /// The key of a member, which may have another name in a dialect.
    pub(super) fn member_key(&self, unit: UnitId, name: &Ident) -> String {
        let info = self.unit(unit);
        let ours = match info.kind {
            UnitKind::Library(_) => self.options.dialect.pin_called(&info.name, &name.text),
            _ => None,
        };
        ours.map_or_else(|| name.key(), str::to_ascii_uppercase)
    }

    fn member(&mut self, place: &mut Place, fixed: &mut Option<String>, name: &Ident) -> bool {
        let key = match self.types.get(place.ty) {
            Type::Block(unit) => self.member_key(*unit, name),
            _ => name.key(),
        };
        let members = match self.types.get(place.ty) {
            Type::Structure(structure) => &structure.members,
            Type::Block(unit) => &self.unit(*unit).members,
            _ => {
                let type_name = self.type_name(place.ty);
                let message = format!("{type_name} has no member `{}`", name.text);
                let help = match self.types.get(place.ty) {
                    // A variable has the name of its type.
                    Type::Enumeration(of) if of.find(&name.text).is_some() => {
                        format!(
                            "a variable stands before the point; write the element as {type_name}#{}",
                            name.text
                        )
                    }
                    _ => "only structures and blocks have members".to_owned(),
                };
                self.error(Code::UnknownMember, name.span, message, &help);
                return false;
            }
        };
        let Some((_, member)) = members.find(&key) else {
            if let Type::Block(unit) = *self.types.get(place.ty)
                && self.is_damaged(unit)
            {
                return false;
            }
            let guess = self.guess(&name.text, members.list.iter().map(|member| member.name.as_str()));
            let elsewhere = self
                .options
                .dialect
                .pin_elsewhere(&self.type_name(place.ty), &name.text);
            let guess = elsewhere.or(guess);
            let axis = matches!(self.types.get(place.ty), Type::Structure(it) if it.name == "AXIS_REF");
            let guess = guess.or_else(|| axis.then(|| OF_AN_AXIS.to_owned()));
            let guess = guess.or_else(|| self.few_members(place.ty));
            let message = format!("{} has no member `{}`", self.type_name(place.ty), name.text);
            self.tell(Diagnostic::error(Code::UnknownMember, name.span, message).maybe_help(guess));
            return false;
        };
        let (ty, offset, kind) = (member.ty, member.offset, member.kind);
        match kind {
            MemberKind::Field | MemberKind::Input => {}
            MemberKind::Output => {
                *fixed = Some(format!(
                    "`{}` is an output, which only its block writes",
                    member.name
                ));
            }
            MemberKind::Var if self.is_program(place.ty) => {
                *fixed = Some(format!("`{}` is a variable inside a PROGRAM", member.name));
            }
            _ => {
                let what = if kind == MemberKind::InOut {
                    "a VAR_IN_OUT"
                } else {
                    "a variable inside"
                };
                let message = format!("`{}` is {what} of {}", member.name, self.type_name(place.ty));
                let help = if kind == MemberKind::InOut {
                    "use the variable that was handed over"
                } else {
                    "make it VAR_OUTPUT to read it, VAR_INPUT to set it"
                };
                self.error(Code::UnknownMember, name.span, message, help);
                return false;
            }
        }
        self.look_at_part(name.span, place.ty, &key);
        place.ty = ty;
        place.offset = place.offset.saturating_add(offset);
        true
    }

    fn is_program(&self, ty: TypeId) -> bool {
        matches!(self.types.get(ty), Type::Block(unit) if self.unit(*unit).kind == UnitKind::Program)
    }

    fn index(&mut self, place: &mut Place, given: &'a [Expression], span: Span) -> bool {
        let Type::Array(array) = self.types.get(place.ty) else {
            let message = format!("{} has no elements", self.type_name(place.ty));
            let help = if self.is_text(place.ty) {
                "MID(s, 1, i) is a character, i from 1; REPLACE(s, 'x', 1, i) puts another one there"
            } else {
                "only arrays are indexed"
            };
            self.error(Code::WrongType, span, message, help);
            return false;
        };
        let array = array.clone();
        if given.len() != array.bounds.len() {
            let counted = |count: usize, one: &str, several: &str| match count {
                1 => format!("1 {one}"),
                _ => format!("{count} {several}"),
            };
            let message = format!(
                "the array has {}, but here {}",
                counted(array.bounds.len(), "dimension", "dimensions"),
                counted(given.len(), "index is given", "indices are given")
            );
            let help = if given.len() < array.bounds.len() {
                "give one for each: a[i, j]"
            } else {
                "an array in an array has indices of its own: a[i][j]"
            };
            self.error(Code::WrongType, span, message, help);
            return false;
        }
        let mut stride = array.stride;
        let mut parts = Vec::new();
        for (index, (low, high)) in given.iter().zip(&array.bounds).rev() {
            parts.push((index, *low, (high - low + 1) as u32, stride));
            stride = stride.saturating_mul((high - low + 1) as u32);
        }
        // Evaluated in text order.
        for (index, low, count, stride) in parts.into_iter().rev() {
            let value = self.expression(index, None);
            let value = self.settle(value);
            if value.is_wrong() {
                return false;
            }
            if !self.types.computed(value.ty).is_some_and(Elementary::is_integer) {
                let message = format!("an index is a whole number, not {}", self.type_name(value.ty));
                let help = match self.types.elementary(value.ty) {
                    Some(it) => format!("convert it: {}_TO_INT(..)", self.conversion_name(value.ty, it)),
                    None => String::new(),
                };
                self.error(Code::WrongType, value.span, message, &help);
                return false;
            }
            if let Some(Constant::Integer(number)) = value.constant() {
                let from_low = number - i128::from(low);
                if from_low < 0 || from_low >= i128::from(count) {
                    let high = low + i64::from(count) - 1;
                    let message = format!("the index {number} is outside {low}..{high}");
                    self.error(Code::OutOfRange, value.span, message, "");
                    return false;
                }
                place.offset = place
                    .offset
                    .saturating_add((from_low as u32).saturating_mul(stride));
            } else {
                let span = value.span;
                let value = Box::new(value);
                place.indices.push(Index {
                    value,
                    low,
                    count,
                    stride,
                    span,
                });
            }
        }
        place.ty = array.of;
        true
    }

    fn bit(&mut self, place: &mut Place, bit: u32, span: Span) -> bool {
        let of = self.types.computed(place.ty);
        let Some(of) = of.filter(|it| it.is_integer() || it.class() == Class::Bits) else {
            let message = format!("{} has no bits", self.type_name(place.ty));
            self.error(
                Code::WrongType,
                span,
                message,
                "bits are those of BYTE, WORD, INT and the like",
            );
            return false;
        };
        if bit >= of.bits() {
            let message = format!("{} has the bits 0 to {}", of.name(), of.bits() - 1);
            self.error(Code::OutOfRange, span, message, "");
            return false;
        }
        place.bit = Some(bit);
        true
    }

    /// An element of an enumeration by its bare name, or as `E.a`.
    fn element(&mut self, path: &'a Path, key: &str, expected: Option<TypeId>) -> Option<Named> {
        match path.selectors.as_slice() {
            [] => {}
            [Selector::Member(name)] => {
                let known = self.named.contains_key(key)
                    || self.library_types.contains_key(key)
                    || self.options.dialect.type_called(key).is_some();
                let (ty, _) = known.then(|| self.find_type(key, path.root.span)).flatten()?;
                if ty == crate::types::WRONG {
                    return Some(Named::Nothing);
                }
                if !self.types.is_enumeration(ty) {
                    return None;
                }
                return Some(self.element_of(ty, name).map_or(Named::Nothing, Named::Value));
            }
            _ => return None,
        }
        let owners = self.elements.get(key)?.clone();
        let mut types: Vec<TypeId> = Vec::new();
        for owner in owners {
            let ty = match owner {
                ElementOf::Known(ty) => ty,
                ElementOf::Named(name) => self.named_type(&name, path.span).0,
            };
            if self.types.is_enumeration(ty) && !types.contains(&ty) {
                types.push(ty);
            }
        }
        let ty = match types.as_slice() {
            [] => return Some(Named::Nothing),
            [one] => *one,
            several => match expected.filter(|expected| several.contains(expected)) {
                Some(expected) => expected,
                None => {
                    let names: Vec<_> = several
                        .iter()
                        .map(|ty| format!("{}#{}", self.type_name(*ty), path.root.text))
                        .collect();
                    let message = format!("several enumerations have an element `{}`", path.root.text);
                    self.error(
                        Code::UnknownName,
                        path.span,
                        message,
                        &format!("write {}", names.join(" or ")),
                    );
                    return Some(Named::Nothing);
                }
            },
        };
        Some(
            self.element_of(ty, &path.root)
                .map_or(Named::Nothing, Named::Value),
        )
    }

    /// The element of this name; reports an unknown name.
    pub(super) fn element_of(&mut self, ty: TypeId, name: &Ident) -> Option<Expr> {
        if ty == crate::types::WRONG {
            return None;
        }
        let Type::Enumeration(of) = self.types.get(ty) else {
            let message = format!("{} is no enumeration", self.type_name(ty));
            self.error(Code::WrongType, name.span, message, "");
            return None;
        };
        let ours = self
            .options
            .dialect
            .elements_called(&of.name)
            .find(|(_, there)| of.library && there.eq_ignore_ascii_case(&name.text))
            .map(|(ours, _)| ours.to_owned());
        let wanted = ours.as_deref().unwrap_or(&name.text);
        let found = of.find(wanted);
        match found {
            Some((element, number)) => {
                let (number, text) = (*number, format!("{element} := {number}"));
                self.look_at_element(name.span, ty, text);
                Some(Expr::new(Kind::Integer(number), ty, name.span))
            }
            None => {
                let guess = self.guess(&name.text, of.elements.iter().map(|(name, _)| name.as_str()));
                let message = format!("{} has no element `{}`", of.name, name.text);
                self.tell(Diagnostic::error(Code::UnknownMember, name.span, message).maybe_help(guess));
                None
            }
        }
    }

    /// The elements of all enumerations that have a name, as declared.
    fn declared_elements(&self) -> impl Iterator<Item = &str> {
        let types = self.named.values().map(|it| it.found.0);
        let types = types.chain(self.library_types.values().copied());
        let elements = types.flat_map(|ty| match self.types.get(ty) {
            Type::Enumeration(of) => of.elements.as_slice(),
            _ => &[],
        });
        elements.map(|(name, _)| name.as_str())
    }

    fn unknown(&mut self, path: &Path) {
        let name = &path.root;
        let key = name.key();
        if self.may_be_lost(&key) || !self.is_news(self.scope, &key) {
            return;
        }
        let function = self
            .unit_names
            .get(&key)
            .is_some_and(|unit| self.unit(*unit).kind == UnitKind::Function);
        if function || Function::find(&key).is_some() || conversion(&key).is_some() {
            let message = format!("`{}` is a function", name.text);
            self.error(
                Code::WrongType,
                name.span,
                message,
                &format!("call it: {}(..)", name.text),
            );
            return;
        }
        if self.unit_names.contains_key(&key) || blocks::find(&key).is_some() {
            let message = format!("`{}` is a function block, not an instance of it", name.text);
            let help = format!("declare an instance: `My{0} : {0};`", name.text);
            self.error(Code::WrongType, name.span, message, &help);
            return;
        }
        let local = self.scope.map(|unit| &self.unit(unit).members);
        let local = local.into_iter().flat_map(|members| &members.list);
        let local = local.map(|member| member.name.as_str());
        let names = local
            .chain(self.declared_globals())
            .chain(self.declared_elements());
        let guess = self.guess(&key, names);
        let message = format!("there is no variable {}", quoted(&name.text));
        let wrong = Diagnostic::error(Code::UnknownName, name.span, message);
        self.tell(wrong.maybe_help(guess.or_else(|| Some("declare it in VAR .. END_VAR".to_owned()))));
    }
}

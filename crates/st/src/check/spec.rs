//! From the types of the syntax tree to resolved types.

use super::declare::in_place_of;
use super::{Checker, ElementOf, State, UnitKind};
use crate::error::{Code, Diagnostic, quoted};
use crate::library::blocks;
use crate::source::Span;
use crate::syntax::{Expression, Ident, SpecKind, TypeSpec, Variables};
use crate::types::{
    Array, Constant, Elementary, Enumeration, Member, MemberKind, Members, Start, Structure, TEXT_USUAL,
    Type, TypeId, Types, WRONG,
};

/// The name of the type of strings.
pub(super) const TEXT: &str = "STRING";

/// Largest number of dimensions of an array.
const DIMENSIONS_MOST: usize = 6;

/// Largest number of bytes of a variable.
pub(super) const BYTES_MOST: u64 = 15 << 20;

impl<'a> Checker<'a> {
    /// The type, and the initial value of its variables.
    pub(super) fn spec(&mut self, spec: &'a TypeSpec) -> (TypeId, Start) {
        match &spec.kind {
            SpecKind::Named(name) => self.type_by_name(name),
            SpecKind::Subrange { base, low, high } => (self.subrange(base, low, high, None), Start::Default),
            SpecKind::Array { bounds, of } => self.array(bounds, of, spec.span),
            SpecKind::Enumeration { base, elements } => {
                (self.enumeration(base.as_ref(), elements, None), Start::Default)
            }
            SpecKind::Structure(members) => (self.structure(members, None), Start::Default),
            SpecKind::Text(length) => (self.text_type(length), Start::Default),
            SpecKind::Wrong => (WRONG, Start::Default),
        }
    }

    /// The type of variables that are declared together, and their initial value.
    pub(super) fn declared(&mut self, variables: &'a Variables) -> (TypeId, Start) {
        let (ty, default) = self.spec(&variables.spec);
        let initial = variables.initial.as_ref();
        let start = initial.map(|initial| self.start(initial, ty));
        (ty, start.unwrap_or(default))
    }

    /// The type of a name in the text.
    pub(super) fn type_by_name(&mut self, name: &Ident) -> (TypeId, Start) {
        let key = name.key();
        if let Some(found) = self.find_type(&key, name.span) {
            self.look_at_type(name.span, found.0, &key);
            return found;
        }
        if let Some(instead) = in_place_of(&key) {
            let message = format!("{key} is not supported");
            self.error(Code::Unsupported, name.span, message, instead);
            return (WRONG, Start::Default);
        }
        if self.may_be_damaged(&key) || !self.is_news(None, &key) {
            return (WRONG, Start::Default);
        }
        let mut help = None;
        if let Some(unit) = self.unit_names.get(&key)
            && self.unit(*unit).kind == UnitKind::Function
        {
            help = Some("it is a FUNCTION, which has no instances: call it by its name".to_owned());
        }
        let guess = match key.as_str() {
            "BIT" => Some("use BOOL".to_owned()),
            _ => self.guess_type(&key),
        };
        let message = format!("there is no type or function block {}", quoted(&name.text));
        let wrong = Diagnostic::error(Code::UnknownType, name.span, message);
        self.tell(wrong.maybe_help(guess).maybe_help(help));
        (WRONG, Start::Default)
    }

    fn guess_type(&self, key: &str) -> Option<String> {
        let types = self.named.values().map(|it| it.syntax.name.text.as_str());
        let types = types.chain(self.library_types.keys().map(String::as_str));
        let elementary = Elementary::ALL.iter().map(|it| it.name());
        let units = self.declared_units().chain(blocks::names().map(|it| it as &str));
        self.guess(key, types.chain(units).chain(elementary))
    }

    /// The type of this name in upper case, if there is one.
    pub(super) fn find_type(&mut self, key: &str, span: Span) -> Option<(TypeId, Start)> {
        // The name of a library type in a dialect.
        let ours = self.options.dialect.type_called(key);
        let key = ours.filter(|_| !self.named.contains_key(key)).unwrap_or(key);
        if let Some(it) = Elementary::find(key) {
            return Some((Types::of(it), Start::Default));
        }
        if key == TEXT {
            return Some((self.types.text(TEXT_USUAL), Start::Default));
        }
        if self.named.contains_key(key) {
            return Some(self.named_type(key, span));
        }
        if let Some(ty) = self.library_types.get(key) {
            return Some((*ty, Start::Default));
        }
        let unit = self
            .unit_names
            .get(key)
            .copied()
            .or_else(|| self.library_block(key))?;
        if self.unit(unit).kind == UnitKind::Function {
            return None;
        }
        self.resolve_unit(unit, span);
        Some((self.block_type(unit), Start::Default))
    }

    /// The type of the instances of a block.
    pub(super) fn block_type(&mut self, unit: crate::types::UnitId) -> TypeId {
        self.types.shared(Type::Block(unit))
    }

    /// A type that the sources declare, resolved now if it was not resolved before.
    pub(super) fn named_type(&mut self, key: &str, span: Span) -> (TypeId, Start) {
        let wrong = (WRONG, Start::Default);
        let Some(named) = self.named.get_mut(key) else {
            return wrong;
        };
        let syntax = named.syntax;
        match named.state {
            State::Done => return named.found.clone(),
            State::Busy => {
                let message = format!("the type `{}` contains itself", syntax.name.text);
                let circle = Diagnostic::error(Code::Circle, span, message);
                self.tell(
                    circle
                        .related(syntax.name.span, "it is declared here")
                        .help("a structure cannot hold one of its own kind"),
                );
                return wrong;
            }
            State::Todo => named.state = State::Busy,
        }
        let found = self.needing(syntax.name.span, wrong, |checker| {
            checker.in_scope(None, |checker| {
                let name = Some(&syntax.name);
                let (ty, default) = match &syntax.spec.kind {
                    // Nobody may complain about the members that are missing.
                    _ if syntax.damaged => (WRONG, Start::Default),
                    SpecKind::Subrange { base, low, high } => {
                        (checker.subrange(base, low, high, name), Start::Default)
                    }
                    SpecKind::Enumeration { base, elements } => {
                        (checker.enumeration(base.as_ref(), elements, name), Start::Default)
                    }
                    SpecKind::Structure(members) => (checker.structure(members, name), Start::Default),
                    _ => checker.spec(&syntax.spec),
                };
                let Some(initial) = &syntax.initial else {
                    return (ty, default);
                };
                // The value may name the type: `(Idle, Busy) := Idle`.
                checker.know(key, (ty, default));
                (ty, checker.start(initial, ty))
            })
        });
        self.know(key, found.clone());
        found
    }

    /// Records the meaning of the name of a type in upper case.
    fn know(&mut self, key: &str, found: (TypeId, Start)) {
        if let Some(named) = self.named.get_mut(key) {
            named.found = found;
            named.state = State::Done;
        }
    }

    /// A whole number that is known before the program runs.
    pub(super) fn whole(&mut self, expression: &'a Expression) -> Option<i128> {
        let value = self.expression(expression, None);
        match (value.is_wrong(), value.constant()) {
            (true, _) => None,
            (_, Some(Constant::Integer(number))) => Some(number),
            (_, Some(Constant::Real(_))) => {
                self.error(Code::WrongType, value.span, "a whole number is expected", "");
                None
            }
            (_, None) => {
                self.not_constant(value.span);
                None
            }
        }
    }

    pub(super) fn not_constant(&mut self, span: Span) {
        self.error(
            Code::NotConstant,
            span,
            "this must be known before the program runs",
            "use literals, VAR CONSTANT and VAR_GLOBAL CONSTANT",
        );
    }

    fn integer_base(&mut self, base: &Ident) -> Option<Elementary> {
        let key = base.key();
        let (ty, _) = self.type_by_name(base);
        let found = self
            .types
            .elementary(ty)
            .filter(|it| it.is_integer() || it.class() == crate::types::Class::Bits);
        if found.is_none() && ty != WRONG {
            let message = format!("{key} is no type of whole numbers");
            self.error(
                Code::WrongType,
                base.span,
                message,
                "use INT, DINT, UINT and the like",
            );
        }
        found
    }

    fn subrange(
        &mut self,
        base: &'a Ident,
        low: &'a Expression,
        high: &'a Expression,
        name: Option<&Ident>,
    ) -> TypeId {
        let of = self.integer_base(base);
        let bounds = (self.whole(low), self.whole(high));
        let (Some(of), (Some(first), Some(last))) = (of, bounds) else {
            return WRONG;
        };
        let span = low.span.to(high.span);
        if first > last {
            let message = format!("the range {first}..{last} is empty");
            self.error(Code::OutOfRange, span, message, "the smaller bound stands first");
            return WRONG;
        }
        if !of.holds(first) || !of.holds(last) {
            let message = format!("{} does not hold {first}..{last}", of.name());
            self.error(Code::OutOfRange, span, message, "choose a larger base type");
            return WRONG;
        }
        let ty = Type::Subrange {
            name: name.map_or_else(
                || format!("{}({first}..{last})", of.name()),
                |name| name.text.clone(),
            ),
            base: of,
            low: first,
            high: last,
        };
        if name.is_some() {
            self.types.add(ty)
        } else {
            self.types.shared(ty)
        }
    }

    fn enumeration(
        &mut self,
        base: Option<&'a Ident>,
        elements: &'a [(Ident, Option<Expression>)],
        name: Option<&Ident>,
    ) -> TypeId {
        let base = match base {
            Some(base) => self.integer_base(base).unwrap_or(Elementary::Int),
            None => Elementary::Int,
        };
        let mut list: Vec<(String, i128)> = Vec::new();
        let mut keys: std::collections::BTreeMap<String, Span> = std::collections::BTreeMap::new();
        let mut next = 0;
        for (element, value) in elements {
            self.check_name(element);
            if let Some(other) = keys.insert(element.key(), element.span) {
                self.twice(element, other);
            }
            if let Some(value) = value
                && let Some(number) = self.whole(value)
            {
                next = number;
            }
            if !base.holds(next) {
                let message = format!(
                    "{} does not hold {next}, the number of `{}`",
                    base.name(),
                    element.text
                );
                self.error(
                    Code::OutOfRange,
                    element.span,
                    message,
                    "give the enumeration a larger type: `(a, b) DINT`",
                );
                return WRONG;
            }
            list.push((element.text.clone(), next));
            next += 1;
        }
        let ty = self.types.add(Type::Enumeration(Enumeration {
            name: name.map_or_else(
                || "an enumeration without a name".to_owned(),
                |name| name.text.clone(),
            ),
            base,
            elements: list,
            library: false,
        }));
        if name.is_none() {
            for (element, _) in elements {
                self.elements
                    .entry(element.key())
                    .or_default()
                    .push(ElementOf::Known(ty));
            }
        }
        ty
    }

    fn structure(&mut self, variables: &'a [Variables], name: Option<&Ident>) -> TypeId {
        let mut members = Members::default();
        for group in variables {
            let (ty, start) = self.declared(group);
            self.no_program(ty, group.spec.span);
            for (name, address) in &group.names {
                self.check_name(name);
                if let Some(address) = address {
                    self.error(
                        Code::Misplaced,
                        address.span,
                        "a member has no address",
                        "declare the variable AT it",
                    );
                }
                if let Some((_, other)) = members.find(&name.key()) {
                    let other = other.span;
                    self.twice(name, other);
                    continue;
                }
                let (size, align) = self.size(ty);
                let member = Member {
                    start: start.clone(),
                    ..Member::new(&name.text, ty, MemberKind::Field, name.span)
                };
                self.look_at(name.span, |checker| checker.told_of(&member, ""));
                members.add(member, size, align);
            }
        }
        members.close();
        if u64::from(members.size) > BYTES_MOST {
            let span = name.map_or_else(Span::default, |name| name.span);
            self.too_large(span);
            return WRONG;
        }
        self.types.add(Type::Structure(Structure {
            name: name.map_or_else(
                || "a structure without a name".to_owned(),
                |name| name.text.clone(),
            ),
            members,
        }))
    }

    pub(super) fn too_large(&mut self, span: Span) {
        let message = format!("this needs more than {BYTES_MOST} bytes");
        self.error(
            Code::TooLarge,
            span,
            message,
            "a program has 16 MiB of memory in all",
        );
    }

    fn array(
        &mut self,
        bounds: &'a [(Expression, Expression)],
        of: &'a TypeSpec,
        span: Span,
    ) -> (TypeId, Start) {
        let wrong = (WRONG, Start::Default);
        let mut found = Vec::new();
        let mut count = 1_u64;
        for (low, high) in bounds {
            let (Some(first), Some(last)) = (self.whole(low), self.whole(high)) else {
                continue;
            };
            let fits = |bound: i128| i64::try_from(bound).ok().filter(|it| i32::try_from(*it).is_ok());
            let (Some(first), Some(last)) = (fits(first), fits(last)) else {
                self.error(
                    Code::OutOfRange,
                    low.span.to(high.span),
                    "bounds of arrays are DINT",
                    "",
                );
                continue;
            };
            if first > last {
                let message = format!("the bounds {first}..{last} leave no element");
                self.error(
                    Code::OutOfRange,
                    low.span.to(high.span),
                    message,
                    "the smaller bound stands first",
                );
                continue;
            }
            found.push((first, last));
            count = count.saturating_mul((last - first + 1) as u64);
        }
        let (of, start) = self.spec(of);
        if found.len() < bounds.len() || found.is_empty() || of == WRONG {
            return wrong;
        }
        if found.len() > DIMENSIONS_MOST {
            let message = format!("an array has at most {DIMENSIONS_MOST} dimensions");
            self.error(Code::TooLarge, span, message, "use an array of arrays");
            return wrong;
        }
        self.no_program(of, span);
        let (size, align) = self.size(of);
        let stride = u64::from(size).next_multiple_of(u64::from(align).max(1)).max(1);
        if stride.saturating_mul(count) > BYTES_MOST {
            self.too_large(span);
            return wrong;
        }
        let ty = self.types.shared(Type::Array(Array {
            bounds: found,
            of,
            // Both are below the limit.
            stride: stride as u32,
            count: count as u32,
        }));
        let start = match start {
            Start::Default => Start::Default,
            other => Start::List(vec![(count as u32, other)]),
        };
        (ty, start)
    }
}

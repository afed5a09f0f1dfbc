//! Calls of the functions of the library.

use super::Checker;
use super::call::inputs;
use super::convert::as_lint;
use crate::error::{Code, Diagnostic, quoted};
use crate::library::{Function, OPERATORS, conversion};
use crate::source::Span;
use crate::syntax::{Call, Expression, Operator, Way};
use crate::typed::{Expr, Kind};
use crate::types::{ANY_INTEGER, ANY_REAL, Class, Elementary, TypeId, Types};

/// The remedy for a number without a conversion to or from STRING.
pub(super) const TO_TEXT: &str = "whole numbers, BOOL and TIME have one; make a whole number first: LINT_TO_STRING(LREAL_TO_LINT(x * 1000.0))";

/// What a STRING is while it is chosen.
const ADDRESS: Elementary = Elementary::Udint;

/// The remedy for a number that is not read from a STRING.
const OF_TEXT: &str = "STRING_TO_LINT reads a whole number, up to the first character that is no digit; of 12.5 read both sides of the point, which FIND(s, '.') finds";

impl<'a> Checker<'a> {
    /// A call of a function of the library; `None` if there is none of that name.
    pub(super) fn library_call(
        &mut self,
        key: &str,
        call: &'a Call,
        expected: Option<TypeId>,
    ) -> Option<Expr> {
        if let Some(function) = Function::find(key) {
            let arguments = self.inputs(function.name(), function.inputs(), function.is_open(), call);
            return Some(self.function_of_library(function, &arguments, call.span, expected));
        }
        if let Some((_, operator)) = OPERATORS.iter().find(|(name, _)| *name == key) {
            let arguments = self.inputs(key, &["IN1", "IN2"], true, call);
            return Some(self.operator_call(*operator, &arguments, call.span, expected));
        }
        if key == "TO_STRING" {
            return Some(self.text_of_value(call));
        }
        if let Some(found) = self.conversion_call(key, call) {
            return Some(found);
        }
        None
    }

    /// The inputs of a call in order. None if they are wrong, which is reported. `open`: more may follow the last
    /// one.
    fn inputs(&mut self, function: &str, names: &[&str], open: bool, call: &'a Call) -> Vec<&'a Expression> {
        let mut list: Vec<Option<&'a Expression>> = Vec::new();
        for (position, argument) in call.arguments.iter().enumerate() {
            let place = match &argument.name {
                None => Some(position),
                Some(name) => place_of(&name.key(), names, open),
            };
            let fits = place
                .filter(|place| argument.way == Way::In && (open || *place < names.len()) && *place < 10_000);
            let Some(place) = fits else {
                let message = match &argument.name {
                    Some(name) => format!("{function} has no input {}", quoted(&name.text)),
                    None => format!("{function} takes {}", inputs(names.len())),
                };
                let more = if open { ", .." } else { "" };
                let help = match names {
                    [] => String::new(),
                    _ => format!("it takes {}{more}", names.join(", ")),
                };
                self.error(Code::BadArgument, argument.span, message, &help);
                return Vec::new();
            };
            if place >= list.len() {
                list.resize(place + 1, None);
            }
            if list[place].is_some() {
                self.error(Code::BadArgument, argument.span, "this input is given twice", "");
            }
            list[place] = argument.value.as_ref();
        }
        let least = if open { names.len().max(2) } else { names.len() };
        if list.len() < least || list.iter().any(Option::is_none) {
            let (at_least, more) = if open { ("at least ", ", ..") } else { ("", "") };
            let message = format!("{function} takes {at_least}{}", inputs(least));
            let help = format!("it takes {}{more}", names.join(", "));
            self.error(Code::MissingArgument, call.span, message, &help);
            return Vec::new();
        }
        list.into_iter().flatten().collect()
    }

    fn operator_call(
        &mut self,
        operator: Operator,
        arguments: &[&'a Expression],
        span: Span,
        expected: Option<TypeId>,
    ) -> Expr {
        let Some((first, rest)) = arguments.split_first() else {
            return Expr::wrong(span);
        };
        let extensible = matches!(
            operator,
            Operator::Add
                | Operator::Multiply
                | Operator::And
                | Operator::Or
                | Operator::Xor
                | Operator::Greater
                | Operator::GreaterEqual
                | Operator::Equal
                | Operator::LessEqual
                | Operator::Less
        );
        if rest.len() > 1 && !extensible {
            self.error(Code::BadArgument, span, "this function takes two inputs", "");
            return Expr::wrong(span);
        }
        let compares =
            operator.level() == Operator::Equal.level() || operator.level() == Operator::Less.level();
        let wanted = if compares { None } else { expected };
        let mut left = self.expression(first, wanted);
        if !compares {
            for right in rest {
                let right = self.expression(right, wanted);
                left = self.operate(left, operator, right, span, expected);
            }
            return Expr { span, ..left };
        }
        // GT(a, b, c) is a > b AND b > c.
        let mut all: Option<Expr> = None;
        for right in rest {
            let hint = if self.types.is_enumeration(left.ty) {
                Some(left.ty)
            } else {
                None
            };
            let right = self.expression(right, hint);
            let one = self.operate(left, operator, right.clone(), span, None);
            all = Some(match all {
                None => one,
                Some(before) => self.operate(before, Operator::And, one, span, None),
            });
            left = right;
        }
        all.map_or_else(|| Expr::wrong(span), |all| Expr { span, ..all })
    }

    /// `TO_STRING(..)`: the conversion of the type of its input.
    fn text_of_value(&mut self, call: &'a Call) -> Expr {
        let arguments = self.inputs("TO_STRING", &["IN"], false, call);
        let Some(argument) = arguments.first() else {
            return Expr::wrong(call.span);
        };
        let value = self.expression(argument, None);
        let value = self.settle(value);
        if value.is_wrong() {
            return value;
        }
        let name = format!("{}_TO_STRING", self.type_name(value.ty));
        match self.unit_names.get(&name).copied() {
            Some(unit) => self.function(unit, None, call),
            None => {
                let message = format!(
                    "there is no conversion from {} to STRING",
                    self.type_name(value.ty)
                );
                self.error(Code::WrongType, call.span, message, TO_TEXT);
                Expr::wrong(call.span)
            }
        }
    }

    /// `X_TO_Y(..)` and `TO_Y(..)`.
    fn conversion_call(&mut self, key: &str, call: &'a Call) -> Option<Expr> {
        let (from_name, to) = match conversion(key) {
            Some((from, to)) => (from.map(str::to_owned), Types::of(to)),
            // To an enumeration: INT_TO_State.
            None => {
                let (from, to) = key.rsplit_once("_TO_")?;
                let (ty, _) = self.find_type(to, call.span)?;
                if !self.types.is_enumeration(ty) {
                    return None;
                }
                (Some(from.to_owned()), ty)
            }
        };
        let from = match from_name {
            None => None,
            Some(name) => Some(self.find_type(&name, call.span)?.0),
        };
        let arguments = self.inputs(key, &["IN"], false, call);
        let Some(argument) = arguments.first() else {
            return Some(Expr::wrong(call.span));
        };
        let value = match from {
            Some(from) => {
                let value = self.expression(argument, Some(from));
                match self.other_conversion(&value, from, to) {
                    Some(help) => {
                        let message = format!(
                            "{key} takes {}, not {}",
                            self.type_name(from),
                            self.type_name(value.ty)
                        );
                        self.error(Code::Conversion, value.span, message, &help);
                        Expr::wrong(value.span)
                    }
                    None => self.convert(value, from),
                }
            }
            None => {
                let value = self.expression(argument, Some(to));
                self.settle(value)
            }
        };
        if value.is_wrong() {
            return Some(Expr::wrong(call.span));
        }
        let (Some(one), Some(other)) = (self.types.elementary(value.ty), self.types.elementary(to)) else {
            if self.is_text(value.ty) {
                let name = self.type_name(to);
                let message = format!("there is no conversion from STRING to {name}");
                let help = match self.types.elementary(to).map(Elementary::class) {
                    Some(Class::Real) => OF_TEXT.to_owned(),
                    _ => format!("write STRING_TO_{name}(..)"),
                };
                self.error(Code::UnknownName, call.callee.root.span, message, &help);
                return Some(Expr::wrong(call.span));
            }
            let message = format!("{} is not converted", self.type_name(value.ty));
            self.error(Code::WrongType, value.span, message, "convert its members");
            return Some(Expr::wrong(call.span));
        };
        let kind = match value.kind {
            Kind::Integer(number)
                if one.class() != Class::Time && other.class() != Class::Time && !other.is_real() =>
            {
                Kind::Integer(other.wrapped(number))
            }
            _ => Kind::Convert(Box::new(value), one, other),
        };
        Some(Expr::new(kind, to, call.span))
    }

    /// What to write where X_TO_Y is given a value of a third type that does not become an X.
    fn other_conversion(&self, value: &Expr, from: TypeId, to: TypeId) -> Option<String> {
        let (given, wanted) = (self.types.computed(value.ty)?, self.types.computed(from)?);
        let target = self.types.elementary(to)?;
        if given.widens_to(wanted) {
            return None;
        }
        Some(if value.ty == to {
            format!("it is {} already: omit the conversion", given.name())
        } else {
            format!(
                "write {}_TO_{}(..)",
                given.name(),
                self.conversion_name(to, target)
            )
        })
    }

    fn function_of_library(
        &mut self,
        function: Function,
        arguments: &[&'a Expression],
        span: Span,
        expected: Option<TypeId>,
    ) -> Expr {
        let wrong = Expr::wrong(span);
        if function == Function::Time {
            return made(
                function,
                Elementary::Time,
                Vec::new(),
                Types::of(Elementary::Time),
                span,
            );
        }
        let Some(first) = arguments.first() else {
            return wrong;
        };
        match function {
            Function::Abs => self.one_number(function, first, span, expected),
            Function::Sqrt
            | Function::Ln
            | Function::Log
            | Function::Exp
            | Function::Sin
            | Function::Cos
            | Function::Tan
            | Function::Asin
            | Function::Acos
            | Function::Atan
            | Function::Round
            | Function::Floor
            | Function::Ceil => self.one_real(function, first, span, expected),
            Function::Trunc => self.trunc(first, span, expected),
            Function::Expt => match arguments {
                [base, exponent] => {
                    let base = self.expression(base, expected);
                    let exponent = self.expression(exponent, None);
                    self.operate(base, Operator::Power, exponent, span, expected)
                }
                _ => wrong,
            },
            Function::Atan2 => self.same(function, arguments, span, expected, |it| it.is_real()),
            Function::Min | Function::Max | Function::Limit => {
                self.same(function, arguments, span, expected, |it| {
                    it.class() != Class::Bool
                })
            }
            Function::Sel | Function::Mux => self.choice(function, arguments, span, expected),
            Function::Move => {
                let value = self.expression(first, expected);
                self.settle(value)
            }
            Function::Shl | Function::Shr | Function::Rol | Function::Ror => {
                self.shift(function, arguments, span, expected)
            }
            Function::Time => wrong,
            Function::Len
            | Function::Left
            | Function::Right
            | Function::Mid
            | Function::Concat
            | Function::Insert
            | Function::Delete
            | Function::Replace
            | Function::Find => self.text_function(function, arguments, span),
        }
    }

    fn one_number(
        &mut self,
        function: Function,
        value: &'a Expression,
        span: Span,
        expected: Option<TypeId>,
    ) -> Expr {
        let value = self.expression(value, expected);
        let value = self.settle(value);
        let of = self.types.computed(value.ty);
        match of.filter(|it| it.is_integer() || it.is_real()) {
            Some(of) => {
                let ty = value.ty;
                made(function, of, vec![value], ty, span)
            }
            None => self.no_input(function, &value, "a number"),
        }
    }

    fn one_real(
        &mut self,
        function: Function,
        value: &'a Expression,
        span: Span,
        expected: Option<TypeId>,
    ) -> Expr {
        let real = expected.filter(|ty| self.types.elementary(*ty).is_some_and(Elementary::is_real));
        let value = self.expression(value, real);
        let value = match (value.ty, real) {
            (ANY_INTEGER | ANY_REAL, Some(real)) => self.convert(value, real),
            (ANY_INTEGER, None) => self.convert(value, Types::of(Elementary::Lreal)),
            _ => self.settle(value),
        };
        let (value, of) = match self.types.computed(value.ty) {
            Some(it) if it.is_real() => (value, it),
            Some(it) if it.widens_to(Elementary::Lreal) => (
                self.convert(value, Types::of(Elementary::Lreal)),
                Elementary::Lreal,
            ),
            _ => return self.no_input(function, &value, "REAL or LREAL"),
        };
        made(function, of, vec![value], Types::of(of), span)
    }

    /// TRUNC: to the required type of whole numbers, or DINT.
    fn trunc(&mut self, value: &'a Expression, span: Span, expected: Option<TypeId>) -> Expr {
        let value = self.expression(value, None);
        let value = self.settle(value);
        let Some(of) = self.types.elementary(value.ty).filter(|it| it.is_real()) else {
            return self.no_input(Function::Trunc, &value, "REAL or LREAL");
        };
        let asked = expected
            .and_then(|ty| self.types.elementary(ty))
            .filter(|it| it.is_integer());
        let to = asked.unwrap_or(Elementary::Dint);
        // It is truncated first; then every conversion gives the same.
        let cut = made(Function::Trunc, of, vec![value], Types::of(of), span);
        Expr::new(Kind::Convert(Box::new(cut), of, to), Types::of(to), span)
    }

    pub(super) fn no_input(&mut self, function: Function, value: &Expr, wanted: &str) -> Expr {
        if !value.is_wrong() {
            let message = format!(
                "{} takes {wanted}, not {}",
                function.name(),
                self.type_name(value.ty)
            );
            self.error(Code::WrongType, value.span, message, "");
        }
        Expr::wrong(value.span)
    }

    /// Values of one type, to which all are converted.
    fn unified(
        &mut self,
        function: Function,
        arguments: &[&'a Expression],
        expected: Option<TypeId>,
    ) -> Option<(Vec<Expr>, TypeId)> {
        let values: Vec<Expr> = arguments.iter().map(|it| self.expression(it, expected)).collect();
        if values.iter().any(Expr::is_wrong) {
            return None;
        }
        if let Some(text) = self.longest_text(&values) {
            let other = values.iter().find(|value| !self.is_text(value.ty));
            if let Some(other) = other.cloned() {
                self.refuse(&other, text);
                return None;
            }
            return Some((values, text));
        }
        let mut ty: Option<TypeId> = None;
        for value in values
            .iter()
            .filter(|value| value.ty != ANY_INTEGER && value.ty != ANY_REAL)
        {
            ty = match ty {
                None => Some(value.ty),
                Some(ty) if ty == value.ty => Some(ty),
                Some(ty) => match (self.types.elementary(ty), self.types.elementary(value.ty)) {
                    (Some(one), Some(other)) if !self.types.is_enumeration(ty) => match one.common(other) {
                        Some(common) => Some(Types::of(common)),
                        None => {
                            self.refuse(value, ty);
                            return None;
                        }
                    },
                    _ => {
                        self.refuse(value, ty);
                        return None;
                    }
                },
            };
        }
        let real = values.iter().any(|value| value.ty == ANY_REAL);
        let wanted = expected.filter(|ty| self.types.elementary(*ty).is_some());
        let ty = match ty {
            Some(ty) if real && self.types.elementary(ty).is_some_and(Elementary::is_integer) => {
                Types::of(Elementary::Lreal)
            }
            Some(ty) => ty,
            None => match wanted {
                Some(ty) if !real || self.types.elementary(ty).is_some_and(Elementary::is_real) => {
                    self.types.value_type(ty)
                }
                _ => {
                    let first = values.iter().find(|value| !real || value.ty == ANY_REAL)?.clone();
                    self.settle(first).ty
                }
            },
        };
        if self.types.elementary(ty).is_none() {
            let message = format!(
                "{} takes elementary values, not {}",
                function.name(),
                self.type_name(ty)
            );
            let span = values.first().map_or_else(Span::default, |value| value.span);
            self.error(Code::WrongType, span, message, "choose with IF, and assign");
            return None;
        }
        let values: Vec<Expr> = values.into_iter().map(|value| self.convert(value, ty)).collect();
        values
            .iter()
            .all(|value| !value.is_wrong())
            .then_some((values, ty))
    }

    fn same(
        &mut self,
        function: Function,
        arguments: &[&'a Expression],
        span: Span,
        expected: Option<TypeId>,
        good: impl Fn(Elementary) -> bool,
    ) -> Expr {
        let Some((values, ty)) = self.unified(function, arguments, expected) else {
            return Expr::wrong(span);
        };
        if self.is_text(ty) && function != Function::Atan2 {
            return made(function, ADDRESS, values, ty, span);
        }
        match (self.types.computed(ty).filter(|it| good(*it)), values.first()) {
            (Some(of), _) => made(function, of, values, ty, span),
            (None, Some(first)) => {
                let first = first.clone();
                self.no_input(
                    function,
                    &first,
                    if function == Function::Atan2 {
                        "REAL or LREAL"
                    } else {
                        "numbers"
                    },
                )
            }
            (None, None) => Expr::wrong(span),
        }
    }

    /// SEL and MUX: the selector comes first.
    fn choice(
        &mut self,
        function: Function,
        arguments: &[&'a Expression],
        span: Span,
        expected: Option<TypeId>,
    ) -> Expr {
        let Some((first, rest)) = arguments.split_first() else {
            return Expr::wrong(span);
        };
        let decider = match function {
            Function::Sel => self.condition(first),
            _ => {
                let value = self.expression(first, None);
                let value = self.settle(value);
                match self.types.computed(value.ty) {
                    Some(it) if it.is_integer() => as_lint(value, it),
                    _ => self.no_input(function, &value, "a whole number as K"),
                }
            }
        };
        if decider.is_wrong() {
            return decider;
        }
        let Some((values, ty)) = self.unified(function, rest, expected) else {
            return Expr::wrong(span);
        };
        let of = self.types.elementary(ty).unwrap_or(ADDRESS);
        let mut all = vec![decider];
        all.extend(values);
        made(function, of, all, ty, span)
    }

    fn shift(
        &mut self,
        function: Function,
        arguments: &[&'a Expression],
        span: Span,
        expected: Option<TypeId>,
    ) -> Expr {
        let [value, by] = arguments else {
            return Expr::wrong(span);
        };
        let value = self.expression(value, expected);
        let bits = expected.filter(|ty| {
            self.types
                .elementary(*ty)
                .is_some_and(|it| it.class() == Class::Bits)
        });
        let value = match bits {
            Some(ty) if value.ty == ANY_INTEGER => self.convert(value, ty),
            _ => value,
        };
        if value.is_wrong() {
            return value;
        }
        let of = self
            .types
            .elementary(value.ty)
            .filter(|it| it.class() == Class::Bits);
        let Some(of) = of else {
            let message = format!(
                "{} takes BYTE, WORD, DWORD or LWORD, not {}",
                function.name(),
                self.type_name(value.ty)
            );
            let help = match self.types.elementary(value.ty) {
                Some(it) if it.is_integer() => format!("convert it: {}_TO_DWORD(..)", it.name()),
                _ => "write a literal with its type: WORD#16#FF".to_owned(),
            };
            self.tell(Diagnostic::error(Code::WrongType, value.span, message).help(help));
            return Expr::wrong(span);
        };
        let by = self.expression(by, None);
        let by = self.settle(by);
        let whole = self.types.computed(by.ty);
        let Some(whole) = whole.filter(|it| it.is_integer() || it.class() == Class::Bits) else {
            return self.no_input(function, &by, "a whole number as N");
        };
        let ty = value.ty;
        made(function, of, vec![value, as_lint(by, whole)], ty, span)
    }
}

/// The index of an input by its name: `IN3` is one of many.
fn place_of(key: &str, names: &[&str], open: bool) -> Option<usize> {
    if let Some(place) = names.iter().position(|name| *name == key) {
        return Some(place);
    }
    let last = names.last().filter(|_| open)?;
    let stem = last.trim_end_matches(|c: char| c.is_ascii_digit());
    let first: usize = last.get(stem.len()..)?.parse().ok()?;
    let number: usize = key.strip_prefix(stem)?.parse().ok()?;
    number.checked_sub(first).map(|more| names.len() - 1 + more)
}

fn made(function: Function, of: Elementary, values: Vec<Expr>, ty: TypeId, span: Span) -> Expr {
    Expr::new(Kind::Library(function, of, values), ty, span)
}

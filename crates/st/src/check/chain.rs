//! Operators: the type in which they are computed, and the values of constants.

use super::Checker;
use super::convert::widened;
use crate::error::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::{Expression, Operator};
use crate::typed::{Expr, Kind, Step};
use crate::types::{ANY_INTEGER, ANY_REAL, BOOL, Class, Constant, Elementary, TypeId, Types};

impl<'a> Checker<'a> {
    pub(super) fn chain(
        &mut self,
        first: &'a Expression,
        rest: &'a [(Operator, Span, Expression)],
        expected: Option<TypeId>,
        span: Span,
    ) -> Expr {
        let compares = rest
            .first()
            .is_some_and(|(operator, ..)| is_comparison(*operator));
        let wanted = if compares { None } else { expected };
        let mut left = self.expression(first, wanted);
        for (operator, at, right) in rest {
            let hint = if self.types.is_enumeration(left.ty) {
                Some(left.ty)
            } else {
                wanted
            };
            let right = self.expression(right, hint);
            left = self.operate(left, *operator, right, *at, expected);
        }
        Expr { span, ..left }
    }

    /// One operator.
    pub(super) fn operate(
        &mut self,
        left: Expr,
        operator: Operator,
        right: Expr,
        at: Span,
        expected: Option<TypeId>,
    ) -> Expr {
        if left.is_wrong() || right.is_wrong() {
            return Expr::wrong(left.span.to(right.span));
        }
        match operator {
            Operator::Or | Operator::OrElse | Operator::Xor | Operator::And | Operator::AndThen => {
                self.logic(left, operator, right, at, expected)
            }
            _ if is_comparison(operator) => self.compare(left, operator, right, at),
            Operator::Power => self.power(left, right, at, expected),
            _ => self.arithmetic(left, operator, right, at, expected),
        }
    }

    /// Converts both sides to one type, or reports that they have none in common.
    fn together(
        &mut self,
        left: Expr,
        operator: Operator,
        right: Expr,
        at: Span,
        expected: Option<TypeId>,
    ) -> Option<(Expr, Expr, Elementary)> {
        let expected = expected.and_then(|ty| self.types.elementary(ty));
        let (left, right) = match (is_any(&left), is_any(&right)) {
            (true, false) => {
                let left = self.meet(left, right.ty, expected);
                (left, right)
            }
            (false, true) => {
                let right = self.meet(right, left.ty, expected);
                (left, right)
            }
            _ => (self.settle(left), self.settle(right)),
        };
        if left.is_wrong() || right.is_wrong() {
            return None;
        }
        let common = match (self.types.computed(left.ty), self.types.computed(right.ty)) {
            (Some(one), Some(other)) => one.common(other),
            _ => None,
        };
        let Some(common) = common else {
            self.no_common(&left, operator, &right, at);
            return None;
        };
        let ty = Types::of(common);
        // The next step converts a chain that continues.
        let left = if matches!(left.kind, Kind::Chain(..)) {
            left
        } else {
            self.convert(left, ty)
        };
        let right = self.convert(right, ty);
        Some((left, right, common))
    }

    /// A literal without a type beside a value of type `other`.
    fn meet(&mut self, literal: Expr, other: TypeId, expected: Option<Elementary>) -> Expr {
        let Some(of) = self.types.computed(other) else {
            if self.types.is_enumeration(other) {
                return self.convert(literal, other);
            }
            return self.settle(literal);
        };
        match (&literal.kind, literal.ty) {
            (Kind::Integer(number), ANY_INTEGER) if of.is_real() || of.holds(*number) => {
                self.convert(literal, Types::of(of))
            }
            (Kind::Real(_), _) if of.is_real() => self.convert(literal, Types::of(of)),
            (Kind::Real(_), _) => {
                let real = expected
                    .filter(|it| it.is_real() && of.widens_to(*it))
                    .unwrap_or(Elementary::Lreal);
                self.convert(literal, Types::of(real))
            }
            _ if matches!(of.class(), Class::Bool | Class::Bits) => self.convert(literal, Types::of(of)),
            _ => self.settle(literal),
        }
    }

    fn no_common(&mut self, left: &Expr, operator: Operator, right: &Expr, at: Span) {
        let (one, other) = (self.type_name(left.ty), self.type_name(right.ty));
        let message = format!("`{}` does not go with {one} and {other}", operator.text());
        let mut wrong = Diagnostic::error(Code::WrongType, at, message);
        let names = (self.types.elementary(left.ty), self.types.elementary(right.ty));
        wrong = match names {
            (Some(from), Some(to)) if one != other => {
                let (from, to) = (
                    self.conversion_name(left.ty, from),
                    self.conversion_name(right.ty, to),
                );
                wrong.help(format!(
                    "convert one of them: {from}_TO_{to}(..) or {to}_TO_{from}(..)"
                ))
            }
            (Some(_), Some(_)) => wrong,
            (None, None) if self.is_text(left.ty) && self.is_text(right.ty) => {
                wrong.help("put strings together with CONCAT(..)")
            }
            (Some(_), None) if self.is_text(right.ty) => wrong.help(beside_text(operator, &one)),
            (None, Some(_)) if self.is_text(left.ty) => wrong.help(beside_text(operator, &other)),
            _ => wrong.help("structures, arrays and blocks are not computed with: use their members"),
        };
        self.tell(wrong);
    }

    fn logic(
        &mut self,
        left: Expr,
        operator: Operator,
        right: Expr,
        at: Span,
        expected: Option<TypeId>,
    ) -> Expr {
        let span = left.span.to(right.span);
        for side in [&left, &right] {
            let of = self.types.elementary(side.ty);
            let lazy = matches!(operator, Operator::AndThen | Operator::OrElse);
            let good = match of.map(Elementary::class) {
                Some(Class::Bool) => true,
                Some(Class::Bits) => !lazy,
                _ => false,
            };
            if side.ty != ANY_INTEGER && (!good || self.types.is_enumeration(side.ty)) {
                self.no_bits(side, operator.text());
                return Expr::wrong(span);
            }
        }
        let hint = expected.filter(|ty| {
            self.types
                .elementary(*ty)
                .is_some_and(|it| it.class() == Class::Bits)
        });
        let (left, right) = match hint {
            Some(ty) if left.ty == ANY_INTEGER && right.ty == ANY_INTEGER => {
                (self.convert(left, ty), self.convert(right, ty))
            }
            _ => (left, right),
        };
        if left.ty == ANY_INTEGER && right.ty == ANY_INTEGER {
            self.error(
                Code::WrongType,
                span,
                "these numbers have no type that has bits",
                "write WORD#16#FF",
            );
            return Expr::wrong(span);
        }
        let Some((left, right, ty)) = self.together(left, operator, right, at, None) else {
            return Expr::wrong(span);
        };
        if let (Kind::Integer(one), Kind::Integer(other)) = (&left.kind, &right.kind) {
            let number = match operator {
                Operator::Or | Operator::OrElse => one | other,
                Operator::Xor => one ^ other,
                _ => one & other,
            };
            return Expr::new(Kind::Integer(number), Types::of(ty), span);
        }
        self.step(left, operator, right, ty, Types::of(ty), at)
    }

    fn compare(&mut self, left: Expr, operator: Operator, right: Expr, at: Span) -> Expr {
        let span = left.span.to(right.span);
        let same = matches!(operator, Operator::Equal | Operator::NotEqual);
        let (left, right, ty) = if self.types.is_enumeration(left.ty) || self.types.is_enumeration(right.ty) {
            let of = if self.types.is_enumeration(left.ty) {
                left.ty
            } else {
                right.ty
            };
            let (left, right) = (self.convert(left, of), self.convert(right, of));
            if left.is_wrong() || right.is_wrong() {
                return Expr::wrong(span);
            }
            if !same {
                let message = "elements of an enumeration are equal or not; they have no order";
                let name = self.type_name(of);
                self.error(
                    Code::WrongType,
                    at,
                    message,
                    &format!("compare numbers: {name}_TO_INT(..)"),
                );
                return Expr::wrong(span);
            }
            let base = self.types.elementary(of).unwrap_or(Elementary::Int);
            (left, right, base)
        } else if self.is_text(left.ty) && self.is_text(right.ty) {
            return self.compare_texts(left, operator, right);
        } else {
            let text = self.is_text(left.ty);
            if self.types.elementary(left.ty).is_none() && !is_any(&left) && !text {
                let message = format!("{} is not compared as a whole", self.type_name(left.ty));
                self.error(Code::WrongType, left.span, message, "compare its members");
                return Expr::wrong(span);
            }
            match self.together(left, operator, right, at, None) {
                Some(found) => found,
                None => return Expr::wrong(span),
            }
        };
        if ty == Elementary::Bool && !same {
            self.error(Code::WrongType, at, "BOOL has no order", "compare with = or <>");
            return Expr::wrong(span);
        }
        let known = match (left.constant(), right.constant()) {
            (Some(Constant::Integer(one)), Some(Constant::Integer(other))) => {
                Some(holds(&one, operator, &other))
            }
            (Some(Constant::Real(one)), Some(Constant::Real(other))) => Some(holds(&one, operator, &other)),
            _ => None,
        };
        if let Some(holds) = known {
            return Expr::new(Kind::Integer(holds.into()), BOOL, span);
        }
        self.step(left, operator, right, ty, BOOL, at)
    }

    /// a ** b, in REAL or LREAL.
    fn power(&mut self, left: Expr, right: Expr, at: Span, expected: Option<TypeId>) -> Expr {
        let span = left.span.to(right.span);
        let expected = expected.and_then(|ty| self.types.elementary(ty));
        let narrow = |value: &Expr, checker: &Self| match checker.types.elementary(value.ty) {
            Some(it) => it.widens_to(Elementary::Real),
            None => is_any(value),
        };
        let any = is_any(&left) && is_any(&right);
        let real = self.types.elementary(left.ty) == Some(Elementary::Real)
            || any && expected == Some(Elementary::Real);
        let ty = if real && narrow(&right, self) {
            Elementary::Real
        } else {
            Elementary::Lreal
        };
        let of = Types::of(ty);
        let left = if matches!(left.kind, Kind::Chain(..)) && left.ty == of {
            left
        } else {
            self.convert(left, of)
        };
        let right = self.convert(right, of);
        if left.is_wrong() || right.is_wrong() {
            return Expr::wrong(span);
        }
        self.step(left, Operator::Power, right, ty, of, at)
    }

    fn arithmetic(
        &mut self,
        left: Expr,
        operator: Operator,
        right: Expr,
        at: Span,
        expected: Option<TypeId>,
    ) -> Expr {
        let span = left.span.to(right.span);
        if is_any(&left) && is_any(&right) {
            return self.fold_any(&left, operator, &right, at);
        }
        if let Some(value) = self.scaled_time(&left, operator, &right, at) {
            return value;
        }
        let Some((left, right, ty)) = self.together(left, operator, right, at, expected) else {
            return Expr::wrong(span);
        };
        let good = match ty.class() {
            Class::Signed | Class::Unsigned => true,
            Class::Real => operator != Operator::Modulo,
            Class::Time => matches!(operator, Operator::Add | Operator::Subtract),
            Class::Bool | Class::Bits => false,
        };
        if !good {
            let message = format!("`{}` does not go with {}", operator.text(), ty.name());
            let help = match ty.class() {
                Class::Bits => format!(
                    "convert it to a number: {0}_TO_UDINT(..), or the type you need",
                    ty.name()
                ),
                Class::Time if operator == Operator::Divide => format!(
                    "for a ratio divide numbers: {0}_TO_LREAL(..) / {0}_TO_LREAL(..)",
                    ty.name()
                ),
                Class::Time => "multiply a TIME with a number, or divide it by one".to_owned(),
                Class::Real => "MOD is for whole numbers; for a rest: x - y * FLOOR(x / y)".to_owned(),
                _ => "BOOL is no number: use IF, SEL or BOOL_TO_INT(..)".to_owned(),
            };
            self.error(Code::WrongType, at, message, &help);
            return Expr::wrong(span);
        }
        match (left.constant(), right.constant()) {
            (Some(Constant::Real(one)), Some(Constant::Real(other))) => {
                self.real(reals(one, operator, other), Types::of(ty), span)
            }
            (_, Some(Constant::Integer(0))) if matches!(operator, Operator::Divide | Operator::Modulo) => {
                self.error(Code::OutOfRange, right.span, "this divides by zero", "");
                Expr::wrong(span)
            }
            (Some(Constant::Integer(one)), Some(Constant::Integer(other))) => Expr::new(
                Kind::Integer(ty.wrapped(wholes(one, operator, other))),
                Types::of(ty),
                span,
            ),
            _ => self.step(left, operator, right, ty, Types::of(ty), at),
        }
    }

    /// Two literals without a type.
    fn fold_any(&mut self, left: &Expr, operator: Operator, right: &Expr, at: Span) -> Expr {
        let span = left.span.to(right.span);
        if let (Kind::Integer(one), Kind::Integer(other)) = (&left.kind, &right.kind) {
            if *other == 0 && matches!(operator, Operator::Divide | Operator::Modulo) {
                self.error(Code::OutOfRange, right.span, "this divides by zero", "");
                return Expr::wrong(span);
            }
            if operator == Operator::Divide && one % other != 0 {
                let message = format!(
                    "whole numbers are divided without a rest: this is {}",
                    one / other
                );
                let doubt = Diagnostic::warning(Code::Doubtful, at, message);
                self.tell(doubt.help(format!("for a fraction write {one}.0 / {other}.0")));
            }
            let number = wholes(*one, operator, *other);
            if i64::try_from(number).is_err() && u64::try_from(number).is_err() {
                self.error(Code::OutOfRange, span, "no type of whole numbers holds this", "");
                return Expr::wrong(span);
            }
            return Expr::new(Kind::Integer(number), ANY_INTEGER, span);
        }
        let number = |value: &Expr| match value.kind {
            Kind::Integer(number) => number as f64,
            Kind::Real(number) => number,
            _ => 0.0,
        };
        if operator == Operator::Modulo {
            self.error(Code::WrongType, at, "MOD is for whole numbers", "");
            return Expr::wrong(span);
        }
        Expr::new(
            Kind::Real(reals(number(left), operator, number(right))),
            ANY_REAL,
            span,
        )
    }

    /// A TIME times or divided by a number.
    fn scaled_time(&mut self, left: &Expr, operator: Operator, right: &Expr, at: Span) -> Option<Expr> {
        let class = |checker: &Self, value: &Expr| checker.types.elementary(value.ty).map(Elementary::class);
        let span = left.span.to(right.span);
        let time = class(self, left) == Some(Class::Time);
        if !time || !matches!(operator, Operator::Multiply | Operator::Divide) {
            let behind = class(self, right) == Some(Class::Time) && operator == Operator::Multiply;
            if behind && !time {
                self.error(
                    Code::WrongType,
                    at,
                    "the TIME stands before the number it is multiplied by",
                    "write T#1s * n",
                );
                return Some(Expr::wrong(span));
            }
            return None;
        }
        if class(self, right) == Some(Class::Time) {
            return None;
        }
        let right = match right.ty {
            ANY_INTEGER => self.convert(right.clone(), Types::of(Elementary::Lint)),
            _ => self.settle(right.clone()),
        };
        let number = self.types.computed(right.ty);
        let Some(number) = number.filter(|it| it.is_integer() || it.is_real()) else {
            if !right.is_wrong() {
                let message = format!(
                    "a TIME is scaled by a number, not by {}",
                    self.type_name(right.ty)
                );
                self.error(Code::WrongType, at, message, "");
            }
            return Some(Expr::wrong(span));
        };
        if operator == Operator::Divide && matches!(right.kind, Kind::Integer(0)) {
            self.error(Code::OutOfRange, right.span, "this divides by zero", "");
            return Some(Expr::wrong(span));
        }
        let ty = left.ty;
        let elementary = self.types.elementary(ty).unwrap_or(Elementary::Time);
        // Whole numbers of all widths are taken as LINT, so that there are two cases.
        let right = if number.is_real() {
            self.convert(right, Types::of(Elementary::Lreal))
        } else {
            widened(right, number, Elementary::Lint)
        };
        Some(self.step(left.clone(), operator, right, elementary, ty, at))
    }

    /// Adds a step to the chain on the left, or begins a chain.
    fn step(
        &mut self,
        left: Expr,
        operator: Operator,
        right: Expr,
        ty: Elementary,
        result: TypeId,
        at: Span,
    ) -> Expr {
        let span = left.span.to(right.span);
        let before = self.types.elementary(left.ty).unwrap_or(ty);
        let mut step = Step {
            convert: None,
            operator,
            right,
            ty,
            span: at,
        };
        let kind = match left.kind {
            Kind::Chain(first, mut steps) => {
                step.convert = (before != ty).then_some((before, ty));
                steps.push(step);
                Kind::Chain(first, steps)
            }
            kind => {
                let first = Expr { kind, ..left };
                Kind::Chain(Box::new(first), vec![step])
            }
        };
        Expr::new(kind, result, span)
    }
}

fn is_any(value: &Expr) -> bool {
    value.ty == ANY_INTEGER || value.ty == ANY_REAL
}

const fn is_comparison(operator: Operator) -> bool {
    matches!(
        operator,
        Operator::Equal
            | Operator::NotEqual
            | Operator::Less
            | Operator::LessEqual
            | Operator::Greater
            | Operator::GreaterEqual
    )
}

fn holds<T: PartialOrd>(one: &T, operator: Operator, other: &T) -> bool {
    match operator {
        Operator::Equal => one == other,
        Operator::NotEqual => one != other,
        Operator::Less => one < other,
        Operator::LessEqual => one <= other,
        Operator::Greater => one > other,
        _ => one >= other,
    }
}

fn reals(one: f64, operator: Operator, other: f64) -> f64 {
    match operator {
        Operator::Add => one + other,
        Operator::Subtract => one - other,
        Operator::Multiply => one * other,
        _ => one / other,
    }
}

/// Both have at most 64 bits, so nothing overflows; the divisor is not 0.
const fn wholes(one: i128, operator: Operator, other: i128) -> i128 {
    match operator {
        Operator::Add => one + other,
        Operator::Subtract => one - other,
        Operator::Multiply => one.wrapping_mul(other),
        Operator::Divide => one / other,
        _ => one % other,
    }
}

/// The remedy if a value of this type and a string are combined.
fn beside_text(operator: Operator, ty: &str) -> String {
    use Operator as O;
    match operator {
        _ if matches!(ty, "REAL" | "LREAL") => super::library_call::TO_TEXT.to_owned(),
        O::Add => format!("put them together with CONCAT(.., {ty}_TO_STRING(..))"),
        O::Subtract | O::Multiply | O::Divide | O::Modulo | O::Power => {
            format!("a string is no number; convert it: STRING_TO_{ty}(..)")
        }
        _ => format!("convert it: {ty}_TO_STRING(..)"),
    }
}

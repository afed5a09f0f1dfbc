//! Which value is permitted where: implicit conversions, and those that need a function.

use super::Checker;
use crate::error::{Code, Diagnostic};
use crate::source::Span;
use crate::typed::{Expr, Kind};
use crate::types::{ANY_INTEGER, ANY_REAL, Class, Elementary, Type, TypeId, Types, WRONG};

impl Checker<'_> {
    /// A literal without a type as one of the smallest type that holds it; any other value unchanged.
    pub(super) fn settle(&mut self, value: Expr) -> Expr {
        let ty = match (value.ty, &value.kind) {
            (ANY_INTEGER, Kind::Integer(number)) => {
                use Elementary::{Dint, Int, Lint, Ulint};
                let found = [Int, Dint, Lint, Ulint].into_iter().find(|it| it.holds(*number));
                Types::of(found.unwrap_or(Lint))
            }
            (ANY_REAL, _) => Types::of(Elementary::Lreal),
            _ => return value,
        };
        self.convert(value, ty)
    }

    /// The value in type `to`, if that loses nothing; otherwise a message.
    pub(super) fn convert(&mut self, value: Expr, to: TypeId) -> Expr {
        if value.is_wrong() || to == WRONG {
            return Expr::wrong(value.span);
        }
        if let Type::Subrange { base, low, high, .. } = *self.types.get(to) {
            return self.subrange_value(value, base, low, high);
        }
        if value.ty == to {
            return value;
        }
        if let (Type::Text(_), Type::Text(capacity)) = (self.types.get(value.ty), self.types.get(to)) {
            let capacity = *capacity;
            return self.text_value(value, capacity);
        }
        if self.types.is_enumeration(to) {
            return self.enumeration_value(value, to);
        }
        let Some(target) = self.types.elementary(to) else {
            return self.refuse(&value, to);
        };
        match (value.ty, &value.kind) {
            (ANY_INTEGER, Kind::Integer(number)) => self.literal(*number, target, value.span),
            (ANY_REAL, Kind::Real(number)) => self.real_literal(*number, target, value.span),
            _ => match self.types.computed(value.ty) {
                Some(from) if from.widens_to(target) => widened(value, from, target),
                _ => self.refuse(&value, to),
            },
        }
    }

    fn subrange_value(&mut self, value: Expr, base: Elementary, low: i128, high: i128) -> Expr {
        let value = self.convert(value, Types::of(base));
        let span = value.span;
        match value.kind {
            Kind::Wrong => value,
            Kind::Integer(number) if !(low..=high).contains(&number) => {
                let message = format!("{number} is outside the range {low}..{high}");
                self.error(Code::OutOfRange, span, message, "");
                Expr::wrong(span)
            }
            Kind::Integer(_) => value,
            _ => Expr {
                ty: value.ty,
                kind: Kind::Within(Box::new(value), base, low, high),
                span,
            },
        }
    }

    fn enumeration_value(&mut self, value: Expr, to: TypeId) -> Expr {
        if let Type::Enumeration(of) = self.types.get(to)
            && of.library
            && let (ANY_INTEGER, Kind::Integer(number)) = (value.ty, &value.kind)
            && of.base.holds(*number)
        {
            let Some(element) = self.options.dialect.element_numbered(&of.name, *number) else {
                return Expr { ty: to, ..value };
            };
            let ours = of
                .elements
                .iter()
                .find(|(name, _)| Some(name.as_str()) == element);
            if let Some((_, number)) = ours {
                let kind = Kind::Integer(*number);
                return Expr {
                    kind,
                    ty: to,
                    ..value
                };
            }
            let message = format!(
                "no element of {} that there is here has the number {number} in the dialect {}",
                of.name, self.options.dialect.name
            );
            self.error(Code::OutOfRange, value.span, message, "name an element");
            return Expr::wrong(value.span);
        }
        self.refuse(&value, to)
    }

    fn literal(&mut self, number: i128, to: Elementary, span: Span) -> Expr {
        let kind = match to.class() {
            Class::Real => Kind::Real(rounded(number as f64, to)),
            Class::Time => {
                let message = format!("{} is a duration, and {number} is a number", to.name());
                self.error(
                    Code::WrongType,
                    span,
                    message,
                    &format!("write T#{}ms, or another unit", number.unsigned_abs()),
                );
                return Expr::wrong(span);
            }
            _ if !to.holds(number) => {
                let (low, high) = to.range();
                let message = format!("{} does not hold {number}", to.name());
                self.error(
                    Code::OutOfRange,
                    span,
                    message,
                    &format!("it holds {low} to {high}"),
                );
                return Expr::wrong(span);
            }
            _ => Kind::Integer(number),
        };
        Expr::new(kind, Types::of(to), span)
    }

    fn real_literal(&mut self, number: f64, to: Elementary, span: Span) -> Expr {
        if !to.is_real() {
            let message = format!("{} does not hold {number:?}, a number with a point", to.name());
            let help = if to.is_integer() {
                "write a whole number, or convert with ROUND and LREAL_TO_.."
            } else {
                ""
            };
            self.error(Code::Conversion, span, message, help);
            return Expr::wrong(span);
        }
        let kept = rounded(number, to);
        if kept.is_infinite() && number.is_finite() {
            let message = format!("{} does not hold {number:?}", to.name());
            self.error(
                Code::OutOfRange,
                span,
                message,
                "its largest number is about 3.4E38: use LREAL",
            );
            return Expr::wrong(span);
        }
        Expr::new(Kind::Real(kept), Types::of(to), span)
    }

    /// A type in the name of a conversion.
    pub(super) fn conversion_name(&self, ty: TypeId, elementary: Elementary) -> String {
        match self.types.get(ty) {
            Type::Enumeration(of) if !of.name.contains(' ') => of.name.clone(),
            _ => elementary.name().to_owned(),
        }
    }

    /// Reports that a value is not implicitly converted to this type.
    pub(super) fn refuse(&mut self, value: &Expr, to: TypeId) -> Expr {
        let (from_name, to_name) = (self.type_name(value.ty), self.type_name(to));
        let message = format!("{from_name} does not become {to_name} by itself");
        let mut wrong = Diagnostic::error(Code::Conversion, value.span, message);
        let from = self.types.elementary(value.ty);
        if let (Some(from), Some(target)) = (from, self.types.elementary(to)) {
            let function = format!(
                "{}_TO_{}",
                self.conversion_name(value.ty, from),
                self.conversion_name(to, target)
            );
            wrong = wrong.help(match target.class() {
                Class::Bool => "compare it: x <> 0".to_owned(),
                _ => format!("convert it: {function}(..)"),
            });
        } else {
            wrong = wrong.label(format!("this is {from_name}"));
            let literal = matches!(value.ty, ANY_INTEGER | ANY_REAL);
            wrong = match self.types.get(to) {
                Type::Enumeration(_) if literal => wrong.help("name one of its elements"),
                Type::Array(_) if literal => {
                    wrong.help("the values of an array stand in brackets: [1, 2, 3]")
                }
                _ => wrong,
            };
        }
        self.tell(wrong);
        Expr::wrong(value.span)
    }
}

/// A number rounded to a type of floating point.
pub(super) fn rounded(number: f64, to: Elementary) -> f64 {
    if to == Elementary::Real {
        f64::from(number as f32)
    } else {
        number
    }
}

/// A value as one of a type that holds all of its values.
pub(super) fn widened(value: Expr, from: Elementary, to: Elementary) -> Expr {
    let (ty, span) = (Types::of(to), value.span);
    let kind = match value.kind {
        Kind::Integer(number) if to.is_real() => Kind::Real(rounded(number as f64, to)),
        Kind::Integer(number) => Kind::Integer(number),
        Kind::Real(number) => Kind::Real(number),
        _ => Kind::Convert(Box::new(value), from, to),
    };
    Expr::new(kind, ty, span)
}

/// A whole number of any type as LINT.
pub(super) fn as_lint(value: Expr, from: Elementary) -> Expr {
    let span = value.span;
    let kind = Kind::Convert(Box::new(value), from, Elementary::Lint);
    Expr::new(kind, Types::of(Elementary::Lint), span)
}

//! Expressions: their values and types.

use super::Checker;
use super::convert::rounded;
use super::path::Named;
use crate::error::Code;
use crate::parse::NESTING_MOST;
use crate::source::Span;
use crate::syntax::{Expression, ExpressionKind, Ident, Selector};
use crate::typed::{Expr, Kind};
use crate::types::{ANY_INTEGER, ANY_REAL, BOOL, Class, Elementary, TypeId, Types, WRONG};

impl<'a> Checker<'a> {
    /// An expression at a place for a value of type `expected`, if one is expected. The value may have
    /// another type: the caller converts it.
    pub(super) fn expression(&mut self, expression: &'a Expression, expected: Option<TypeId>) -> Expr {
        // The reader limits the size of one expression, but constants may refer to others.
        if self.depth > 2 * NESTING_MOST {
            self.error(
                Code::TooDeep,
                expression.span,
                "constants are nested too deep within each other",
                "",
            );
            return Expr::wrong(expression.span);
        }
        self.depth += 1;
        let value = self.any_expression(expression, expected);
        self.depth -= 1;
        value
    }

    fn any_expression(&mut self, expression: &'a Expression, expected: Option<TypeId>) -> Expr {
        let span = expression.span;
        let (kind, ty) = match &expression.kind {
            ExpressionKind::Bool(value) => (Kind::Integer((*value).into()), BOOL),
            ExpressionKind::Integer(value) => (Kind::Integer(*value), ANY_INTEGER),
            ExpressionKind::Real(value) => (Kind::Real(*value), ANY_REAL),
            ExpressionKind::Duration(ns, long) => {
                let ty = if *long {
                    Elementary::Ltime
                } else {
                    Elementary::Time
                };
                (Kind::Integer((*ns).into()), Types::of(ty))
            }
            ExpressionKind::Text(bytes) => {
                let ty = self.types.text(bytes.len() as u8);
                (Kind::Text(bytes.clone()), ty)
            }
            ExpressionKind::Typed(name, inner) => return self.typed(name, inner, span),
            ExpressionKind::Element(name, element) => {
                let (ty, _) = self.type_by_name(name);
                if ty == WRONG {
                    return Expr::wrong(span);
                }
                return self.element_of(ty, element).unwrap_or_else(|| Expr::wrong(span));
            }
            ExpressionKind::Path(path) => match self.named(path, expected) {
                Named::Value(value) => return Expr { span, ..value },
                Named::Place(place, _) => {
                    let ty = if place.bit.is_some() {
                        BOOL
                    } else {
                        self.types.value_type(place.ty)
                    };
                    (Kind::Load(place), ty)
                }
                Named::Nothing => return Expr::wrong(span),
            },
            ExpressionKind::Call(call) => {
                let value = self.call_value(call, expected);
                if let (Kind::Call(_), WRONG) = (&value.kind, value.ty) {
                    let name = call
                        .callee
                        .selectors
                        .last()
                        .map_or(&call.callee.root, |last| match last {
                            Selector::Member(name) => name,
                            _ => &call.callee.root,
                        });
                    let message = format!("`{}` gives no value", name.text);
                    self.error(
                        Code::WrongType,
                        span,
                        message,
                        "give it a type: FUNCTION Name : INT",
                    );
                    return Expr::wrong(span);
                }
                return value;
            }
            ExpressionKind::Negative(inner) => return self.negative(inner, expected, span),
            ExpressionKind::Not(inner) => return self.not(inner, expected, span),
            ExpressionKind::Chain(first, rest) => return self.chain(first, rest, expected, span),
            ExpressionKind::Wrong => return Expr::wrong(span),
        };
        Expr::new(kind, ty, span)
    }

    /// An expression as a value of this type.
    pub(super) fn value(&mut self, expression: &'a Expression, ty: TypeId) -> Expr {
        let value = self.expression(expression, Some(ty));
        self.convert(value, ty)
    }

    /// An expression that is a condition.
    pub(super) fn condition(&mut self, expression: &'a Expression) -> Expr {
        let value = self.expression(expression, Some(BOOL));
        if value.ty != BOOL && !value.is_wrong() && value.ty != ANY_INTEGER {
            let message = format!("a condition is BOOL, not {}", self.type_name(value.ty));
            self.error(Code::WrongType, value.span, message, "compare it: x <> 0");
            return Expr::wrong(value.span);
        }
        self.convert(value, BOOL)
    }

    /// `INT#5`
    fn typed(&mut self, name: &Ident, inner: &'a Expression, span: Span) -> Expr {
        let (ty, _) = self.type_by_name(name);
        let value = self.expression(inner, Some(ty));
        if self
            .types
            .elementary(ty)
            .is_some_and(|it| it.class() == Class::Time)
        {
            self.error(Code::BadLiteral, span, "a duration has units", "write T#10ms");
            return Expr::wrong(span);
        }
        let value = self.convert(value, ty);
        Expr { span, ..value }
    }

    fn negative(&mut self, inner: &'a Expression, expected: Option<TypeId>, span: Span) -> Expr {
        let value = self.expression(inner, expected);
        if value.is_wrong() {
            return value;
        }
        let of = self.types.computed(value.ty);
        let of = of.filter(|it| it.is_signed() || it.is_real());
        let ty = value.ty;
        let kind = match (value.kind, of) {
            (Kind::Integer(number), None) if ty == ANY_INTEGER => Kind::Integer(-number),
            (Kind::Real(number), _) => Kind::Real(-number),
            (Kind::Integer(number), Some(of)) => Kind::Integer(of.wrapped(-number)),
            (kind, Some(of)) => Kind::Negate(of, Box::new(Expr::new(kind, ty, value.span))),
            (_, None) => {
                let message = format!("{} has no sign", self.type_name(ty));
                self.error(
                    Code::WrongType,
                    span,
                    message,
                    "convert it to a signed type first",
                );
                return Expr::wrong(span);
            }
        };
        Expr::new(kind, ty, span)
    }

    fn not(&mut self, inner: &'a Expression, expected: Option<TypeId>, span: Span) -> Expr {
        let value = self.expression(inner, expected);
        let value = match expected.and_then(|ty| self.types.elementary(ty)) {
            Some(it) if value.ty == ANY_INTEGER && it.class() == Class::Bits => {
                self.convert(value, Types::of(it))
            }
            _ => self.settle(value),
        };
        if value.is_wrong() {
            return value;
        }
        let of = self.types.computed(value.ty);
        let Some(of) = of.filter(|it| matches!(it.class(), Class::Bool | Class::Bits)) else {
            self.no_bits(&value, "NOT");
            return Expr::wrong(span);
        };
        let ty = value.ty;
        let kind = match value.kind {
            Kind::Integer(number) => Kind::Integer(number ^ of.range().1),
            _ => Kind::Not(of, Box::new(value)),
        };
        Expr::new(kind, ty, span)
    }

    /// Reports that a value is neither BOOL nor a bit string.
    pub(super) fn no_bits(&mut self, value: &Expr, operator: &str) {
        let message = format!(
            "{operator} takes BOOL, BYTE, WORD, DWORD and LWORD, not {}",
            self.type_name(value.ty)
        );
        let help = match self.types.elementary(value.ty) {
            Some(it) if it.is_integer() => {
                let bits = match it.size() {
                    1 => "BYTE",
                    2 => "WORD",
                    4 => "DWORD",
                    _ => "LWORD",
                };
                format!(
                    "for its bits convert it: {}_TO_{bits}(..); for a condition compare it: x <> 0",
                    it.name()
                )
            }
            _ => "compare it, which gives a BOOL".to_owned(),
        };
        self.error(Code::WrongType, value.span, message, &help);
    }

    /// The constant result of an operation with numbers of floating point.
    pub(super) fn real(&self, number: f64, ty: TypeId, span: Span) -> Expr {
        let kept = self.types.elementary(ty).map_or(number, |it| rounded(number, it));
        Expr::new(Kind::Real(kept), ty, span)
    }
}

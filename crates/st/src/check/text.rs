//! Strings: their literals, comparisons and functions.

use super::Checker;
use super::convert::as_lint;
use crate::error::{Code, Diagnostic};
use crate::library::Function;
use crate::source::Span;
use crate::syntax::{Expression, Operator};
use crate::typed::{Expr, Kind};
use crate::types::{BOOL, Elementary, TEXT_MOST, Type, TypeId, Types};

impl<'a> Checker<'a> {
    /// The type STRING[n].
    pub(super) fn text_type(&mut self, length: &'a Expression) -> TypeId {
        let Some(number) = self.whole(length) else {
            return crate::types::WRONG;
        };
        match u8::try_from(number) {
            Ok(capacity) if (1..=TEXT_MOST).contains(&capacity) => self.types.text(capacity),
            _ => {
                let message = format!("a STRING has 1 to {TEXT_MOST} bytes, not {number}");
                self.error(Code::OutOfRange, length.span, message, "");
                crate::types::WRONG
            }
        }
    }

    pub(super) fn is_text(&self, ty: TypeId) -> bool {
        matches!(self.types.get(ty), Type::Text(_))
    }

    /// The type of the longest string among these; `None` if there is none.
    pub(super) fn longest_text(&mut self, values: &[Expr]) -> Option<TypeId> {
        let lengths = values.iter().filter_map(|value| match self.types.get(value.ty) {
            Type::Text(capacity) => Some(*capacity),
            _ => None,
        });
        let longest = lengths.max()?;
        Some(self.types.text(longest))
    }

    /// A string as one of another length. A longer value is cut when it is assigned; for a literal this
    /// is reported.
    pub(super) fn text_value(&mut self, value: Expr, capacity: u8) -> Expr {
        match &value.kind {
            Kind::Text(bytes) if bytes.len() > usize::from(capacity) => {
                let message = format!("STRING[{capacity}] does not hold {} bytes", bytes.len());
                self.error(Code::OutOfRange, value.span, message, "declare it longer");
                Expr::wrong(value.span)
            }
            _ => value,
        }
    }

    /// Two strings are compared byte by byte.
    pub(super) fn compare_texts(&mut self, left: Expr, operator: Operator, right: Expr) -> Expr {
        Expr {
            span: left.span.to(right.span),
            kind: Kind::Compare(operator, Box::new([left, right])),
            ty: BOOL,
        }
    }

    /// LEN, CONCAT and similar functions.
    pub(super) fn text_function(
        &mut self,
        function: Function,
        arguments: &[&'a Expression],
        span: Span,
    ) -> Expr {
        let inputs = function.inputs();
        let mut values = Vec::new();
        for (place, argument) in arguments.iter().enumerate() {
            let number = inputs.get(place).is_some_and(|name| ["L", "P"].contains(name));
            let value = self.expression(argument, None);
            let value = self.settle(value);
            values.push(if number {
                self.text_number(function, value)
            } else {
                self.text_input(function, value)
            });
        }
        if values.iter().any(Expr::is_wrong) {
            return Expr::wrong(span);
        }
        if matches!(function, Function::Len | Function::Find) {
            let of = Elementary::Int;
            let (kind, ty) = (Kind::Library(function, of, values), Types::of(of));
            return Expr::new(kind, ty, span);
        }
        let buffer = self.layout.take(u32::from(TEXT_MOST) + 1);
        self.check_memory(span);
        Expr::new(
            Kind::Join(function, values, buffer),
            self.types.text(TEXT_MOST),
            span,
        )
    }

    fn text_input(&mut self, function: Function, value: Expr) -> Expr {
        if value.is_wrong() || self.is_text(value.ty) {
            return value;
        }
        let name = self.type_name(value.ty);
        let message = format!("{} takes a STRING, not {name}", function.name());
        let mut wrong = Diagnostic::error(Code::WrongType, value.span, message);
        wrong = match self.types.elementary(value.ty) {
            Some(it) if it.is_real() => wrong.help(super::library_call::TO_TEXT),
            Some(_) => wrong.help(format!("convert it: {name}_TO_STRING(..)")),
            None => wrong,
        };
        self.tell(wrong);
        Expr::wrong(value.span)
    }

    /// A length or position, as LINT.
    fn text_number(&mut self, function: Function, value: Expr) -> Expr {
        let of = self.types.computed(value.ty).filter(|it| it.is_integer());
        match of.filter(|it| *it != Elementary::Ulint || matches!(value.kind, Kind::Integer(_))) {
            Some(of) => as_lint(value, of),
            _ => self.no_input(function, &value, "whole numbers up to LINT as L and P"),
        }
    }
}

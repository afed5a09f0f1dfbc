//! Expressions: their values on the stack.
//!
//! A value of up to 32 bits is an i32 that is extended by the rules of its type, so it can be compared
//! and converted directly. A computation with a type of 8 or 16 bits cuts its result to its width.

use super::function::{Function, Label, value_type};
use super::place::Root;
use super::{Context, FaultKind};
use crate::source::Span;
use crate::syntax::Operator;
use crate::typed::{Expr, Kind};
use crate::types::{Elementary, TypeId};
use wasm_encoder::{BlockType, ValType};

/// A loop that is being written.
pub(super) struct Loop {
    pub exit: Label,
    pub again: Label,
    /// Absent for a loop of the library, which ends.
    pub site: Option<i32>,
}

/// Writes one function.
pub(super) struct Emitter<'c, 'p, 'a> {
    pub context: &'c mut Context<'p, 'a>,
    pub function: Function,
    /// The address of the instance that is being called.
    pub callee: (Root, u32),
    pub loops: Vec<Loop>,
    /// The end of the function's statements.
    pub end: Option<Label>,
    /// A METHOD may be called before its block was ever given its VAR_IN_OUT.
    pub is_method: bool,
    /// The statement that is being written.
    pub statement: Span,
}

impl<'c, 'p, 'a> Emitter<'c, 'p, 'a> {
    pub(super) fn new(context: &'c mut Context<'p, 'a>, function: Function) -> Self {
        Self {
            context,
            function,
            callee: (Root::Zero, 0),
            loops: Vec::new(),
            end: None,
            is_method: false,
            statement: Span::default(),
        }
    }

    pub(super) fn site(&mut self, span: Span, kind: FaultKind) -> i32 {
        self.context.site(span, kind)
    }

    pub(super) fn type_of(&self, ty: TypeId) -> Option<Elementary> {
        self.context.program.types.elementary(ty)
    }

    /// The type of an expression that is known to have an elementary one.
    pub(super) fn elementary(&self, value: &Expr) -> Elementary {
        self.type_of(value.ty).unwrap_or(Elementary::Dint)
    }

    pub(super) fn constant(&mut self, of: Elementary, number: i128) {
        let mut sink = self.function.sink();
        // Signed and unsigned numbers have the same bits.
        match of.size() {
            8 => sink.i64_const(number as i64),
            _ => sink.i32_const(number as i32),
        };
    }

    pub(super) fn real_constant(&mut self, of: Elementary, number: f64) {
        let mut sink = self.function.sink();
        if of == Elementary::Real {
            sink.f32_const((number as f32).into());
        } else {
            sink.f64_const(number.into());
        }
    }

    /// Pushes the value; of a type with members or elements: its address.
    pub(super) fn expression(&mut self, value: &Expr) {
        match &value.kind {
            Kind::Integer(number) => {
                let of = self.elementary(value);
                self.constant(of, *number);
            }
            Kind::Real(number) => {
                let of = self.elementary(value);
                self.real_constant(of, *number);
            }
            Kind::Load(place) => self.read(place),
            Kind::Negate(of, inner) => self.negate(*of, inner),
            Kind::Not(of, inner) => {
                self.expression(inner);
                if *of == Elementary::Bool {
                    self.function.sink().i32_eqz();
                } else {
                    self.constant(*of, of.range().1);
                    self.operation(Operator::Xor, *of);
                }
            }
            Kind::Chain(first, steps) => {
                self.expression(first);
                for step in steps {
                    self.step(step);
                }
            }
            Kind::Convert(inner, from, to) => {
                self.expression(inner);
                self.convert(*from, *to);
            }
            Kind::Within(inner, of, low, high) => self.within(inner, *of, *low, *high),
            Kind::Call(call) => self.function_call(call),
            Kind::Text(bytes) => self.text(bytes),
            Kind::Join(function, values, buffer) => self.join(*function, values, *buffer, value.span),
            Kind::Compare(operator, sides) => self.compare_texts(*operator, &sides[0], &sides[1]),
            Kind::Library(function, of, values) => self.library(*function, *of, values, value.span),
            // A program with mistakes is not compiled.
            Kind::Wrong => {
                self.function.sink().unreachable();
            }
        }
    }

    fn negate(&mut self, of: Elementary, inner: &Expr) {
        match value_type(of) {
            ValType::F32 => {
                self.expression(inner);
                self.function.sink().f32_neg();
            }
            ValType::F64 => {
                self.expression(inner);
                self.function.sink().f64_neg();
            }
            _ => {
                self.constant(of, 0);
                self.expression(inner);
                self.operation(Operator::Subtract, of);
            }
        }
    }

    /// A value that must be within a subrange.
    fn within(&mut self, inner: &Expr, of: Elementary, low: i128, high: i128) {
        self.expression(inner);
        self.must_be_within(of, (low, high), inner.span);
    }

    /// A fault if the whole number on the stack is outside a subrange; it remains there.
    pub(super) fn must_be_within(&mut self, of: Elementary, (low, high): (i128, i128), span: Span) {
        let local = self.function.local(value_type(of));
        let site = self.site(span, FaultKind::Subrange);
        self.function.sink().local_tee(local);
        self.is_outside(of, low, high);
        self.fault_if(site, local, of);
        self.function.sink().local_get(local);
    }

    /// A fault if the top of the stack is true; its value is the whole number in a local variable.
    pub(super) fn fault_if(&mut self, site: i32, local: u32, of: Elementary) {
        self.function.if_(BlockType::Empty);
        self.function.sink().i32_const(site).local_get(local);
        self.fault_value(of);
        self.fault();
    }

    /// Turns a whole number on the stack into the value of a fault.
    pub(super) fn fault_value(&mut self, of: Elementary) {
        if of.size() < 8 {
            if of.is_signed() {
                self.function.sink().i64_extend_i32_s();
            } else {
                self.function.sink().i64_extend_i32_u();
            }
        }
    }

    /// The same of a fault without a value.
    pub(super) fn plain_fault_if(&mut self, site: i32) {
        self.function.if_(BlockType::Empty);
        self.function.sink().i32_const(site).i64_const(0);
        self.fault();
    }
}

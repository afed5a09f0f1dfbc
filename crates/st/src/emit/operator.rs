//! Operators.

use super::FaultKind;
use super::expression::Emitter;
use super::function::value_type;
use crate::library;
use crate::syntax::Operator;
use crate::typed::Step;
use crate::types::{Class, Elementary};
use wasm_encoder::{BlockType, ValType};

impl Emitter<'_, '_, '_> {
    /// An operator: its left side is on the stack.
    pub(super) fn step(&mut self, step: &Step) {
        if let Some((from, to)) = step.convert {
            self.convert(from, to);
        }
        match step.operator {
            Operator::AndThen | Operator::OrElse => self.lazy(step),
            Operator::Multiply | Operator::Divide
                if step.ty.class() == Class::Time && self.elementary(&step.right).is_real() =>
            {
                self.function.sink().f64_convert_i64_s();
                self.expression(&step.right);
                self.operation(step.operator, Elementary::Lreal);
                self.convert(Elementary::Lreal, Elementary::Lint);
            }
            Operator::Divide | Operator::Modulo if !step.ty.is_real() => self.divide(step),
            Operator::Power => {
                self.convert(step.ty, Elementary::Lreal);
                self.expression(&step.right);
                self.convert(step.ty, Elementary::Lreal);
                self.host(library::Function::Expt);
                self.convert(Elementary::Lreal, step.ty);
            }
            _ => {
                self.expression(&step.right);
                self.operation(step.operator, step.ty);
            }
        }
    }

    /// An operator between the two values on the stack.
    pub(super) fn operation(&mut self, operator: Operator, of: Elementary) {
        match value_type(of) {
            ValType::F32 => self.real_operation(operator, true),
            ValType::F64 => self.real_operation(operator, false),
            ValType::I64 => self.wide_operation(operator, of.is_signed()),
            _ => self.whole_operation(operator, of),
        }
    }

    /// The difference of the two whole numbers on the stack, which keeps all bits of a type of 8 or 16.
    pub(super) fn difference(&mut self, of: Elementary) {
        if of.size() == 8 {
            self.function.sink().i64_sub();
        } else {
            self.function.sink().i32_sub();
        }
    }

    /// Pushes whether the whole number on the stack is outside of `low` to `high`: x - low > high - low without a
    /// sign.
    pub(super) fn is_outside(&mut self, of: Elementary, low: i128, high: i128) {
        self.constant(of, low);
        self.difference(of);
        if of.size() == 8 {
            self.constant(of, high - low);
            self.function.sink().i64_gt_u();
        } else {
            self.constant(Elementary::Udint, high - low);
            self.function.sink().i32_gt_u();
        }
    }

    fn lazy(&mut self, step: &Step) {
        self.function.if_(BlockType::Result(ValType::I32));
        if step.operator == Operator::AndThen {
            self.expression(&step.right);
            self.function.else_();
            self.function.sink().i32_const(0);
        } else {
            self.function.sink().i32_const(1);
            self.function.else_();
            self.expression(&step.right);
        }
        self.function.end();
    }

    fn real_operation(&mut self, operator: Operator, single: bool) {
        use Operator as O;
        let mut sink = self.function.sink();
        match (operator, single) {
            (O::Add, true) => sink.f32_add(),
            (O::Add, false) => sink.f64_add(),
            (O::Subtract, true) => sink.f32_sub(),
            (O::Subtract, false) => sink.f64_sub(),
            (O::Multiply, true) => sink.f32_mul(),
            (O::Multiply, false) => sink.f64_mul(),
            (O::Divide, true) => sink.f32_div(),
            (O::Divide, false) => sink.f64_div(),
            (O::Equal, true) => sink.f32_eq(),
            (O::Equal, false) => sink.f64_eq(),
            (O::NotEqual, true) => sink.f32_ne(),
            (O::NotEqual, false) => sink.f64_ne(),
            (O::Less, true) => sink.f32_lt(),
            (O::Less, false) => sink.f64_lt(),
            (O::LessEqual, true) => sink.f32_le(),
            (O::LessEqual, false) => sink.f64_le(),
            (O::Greater, true) => sink.f32_gt(),
            (O::Greater, false) => sink.f64_gt(),
            (O::GreaterEqual, true) => sink.f32_ge(),
            (O::GreaterEqual, false) => sink.f64_ge(),
            // The checker refuses everything else.
            _ => sink.unreachable(),
        };
    }

    fn wide_operation(&mut self, operator: Operator, signed: bool) {
        use Operator as O;
        let mut sink = self.function.sink();
        match (operator, signed) {
            (O::Add, _) => sink.i64_add(),
            (O::Subtract, _) => sink.i64_sub(),
            (O::Multiply, _) => sink.i64_mul(),
            (O::Or, _) => sink.i64_or(),
            (O::Xor, _) => sink.i64_xor(),
            (O::And, _) => sink.i64_and(),
            (O::Equal, _) => sink.i64_eq(),
            (O::NotEqual, _) => sink.i64_ne(),
            (O::Less, true) => sink.i64_lt_s(),
            (O::Less, false) => sink.i64_lt_u(),
            (O::LessEqual, true) => sink.i64_le_s(),
            (O::LessEqual, false) => sink.i64_le_u(),
            (O::Greater, true) => sink.i64_gt_s(),
            (O::Greater, false) => sink.i64_gt_u(),
            (O::GreaterEqual, true) => sink.i64_ge_s(),
            (O::GreaterEqual, false) => sink.i64_ge_u(),
            _ => sink.unreachable(),
        };
    }

    fn whole_operation(&mut self, operator: Operator, of: Elementary) {
        use Operator as O;
        let mut sink = self.function.sink();
        match (operator, of.is_signed()) {
            (O::Add, _) => sink.i32_add(),
            (O::Subtract, _) => sink.i32_sub(),
            (O::Multiply, _) => sink.i32_mul(),
            (O::Or, _) => sink.i32_or(),
            (O::Xor, _) => sink.i32_xor(),
            (O::And, _) => sink.i32_and(),
            (O::Equal, _) => sink.i32_eq(),
            (O::NotEqual, _) => sink.i32_ne(),
            (O::Less, true) => sink.i32_lt_s(),
            (O::Less, false) => sink.i32_lt_u(),
            (O::LessEqual, true) => sink.i32_le_s(),
            (O::LessEqual, false) => sink.i32_le_u(),
            (O::Greater, true) => sink.i32_gt_s(),
            (O::Greater, false) => sink.i32_gt_u(),
            (O::GreaterEqual, true) => sink.i32_ge_s(),
            (O::GreaterEqual, false) => sink.i32_ge_u(),
            _ => sink.unreachable(),
        };
        if matches!(operator, O::Add | O::Subtract | O::Multiply) {
            self.narrow(of);
        }
    }

    /// A division of whole numbers, or its rest.
    fn divide(&mut self, step: &Step) {
        let of = step.ty;
        let rest = step.operator == Operator::Modulo;
        let constant = Self::is_constant(&step.right);
        if constant.is_some_and(|number| number != 0 && number != -1) {
            self.expression(&step.right);
            self.quotient(of, rest);
            self.narrow(of);
            return;
        }
        let ty = value_type(of);
        let (left, right) = (self.function.local(ty), self.function.local(ty));
        self.function.sink().local_set(left);
        self.expression(&step.right);
        let site = self.site(step.span, FaultKind::DivisionByZero);
        self.function.sink().local_tee(right);
        if of.size() == 8 {
            self.function.sink().i64_eqz();
        } else {
            self.function.sink().i32_eqz();
        }
        self.fault_if(site, left, of);
        // The least number by -1 wraps around; the processor would trap.
        let guard = of.is_signed() && of.size() >= 4 && !rest;
        if guard {
            self.function.sink().local_get(right);
            self.constant(of, -1);
            self.operation(Operator::Equal, of);
            self.function.if_(BlockType::Result(ty));
            self.constant(of, 0);
            self.function.sink().local_get(left);
            self.difference(of);
            self.function.else_();
        }
        self.function.sink().local_get(left).local_get(right);
        self.quotient(of, rest);
        if guard {
            self.function.end();
        }
        self.narrow(of);
    }

    fn quotient(&mut self, of: Elementary, rest: bool) {
        let mut sink = self.function.sink();
        match (of.size() == 8, of.is_signed(), rest) {
            (true, true, false) => sink.i64_div_s(),
            (true, false, false) => sink.i64_div_u(),
            (true, true, true) => sink.i64_rem_s(),
            (true, false, true) => sink.i64_rem_u(),
            (false, true, false) => sink.i32_div_s(),
            (false, false, false) => sink.i32_div_u(),
            (false, true, true) => sink.i32_rem_s(),
            (false, false, true) => sink.i32_rem_u(),
        };
    }
}

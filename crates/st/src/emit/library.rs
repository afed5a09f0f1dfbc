//! Functions of the library.

use super::expression::Emitter;
use super::function::{at, value_type};
use super::text::Helper;
use super::{FaultKind, Target};
use crate::layout;
use crate::library::Function;
use crate::source::Span;
use crate::syntax::Operator;
use crate::typed::Expr;
use crate::types::{Elementary, Type};
use wasm_encoder::ValType;

impl Emitter<'_, '_, '_> {
    pub(super) fn library(&mut self, function: Function, of: Elementary, values: &[Expr], span: Span) {
        match function {
            Function::Sel => self.sel(values),
            Function::Mux => self.mux(of, values, span),
            Function::Shl | Function::Shr => self.shift(function, of, values),
            Function::Rol | Function::Ror => self.rotate(function, of, values),
            Function::Time => {
                self.function.sink().i32_const(0).i64_load(at(layout::NOW, 3));
            }
            Function::Len => {
                values.iter().for_each(|value| self.expression(value));
                self.function.sink().i32_load8_u(at(0, 0));
            }
            Function::Find => {
                values.iter().for_each(|value| self.expression(value));
                self.helper(Helper::Find);
            }
            Function::Min | Function::Max | Function::Limit => self.extreme(function, of, values),
            Function::Atan2 => {
                for value in values {
                    self.expression(value);
                    self.convert(of, Elementary::Lreal);
                }
                self.host(function);
                self.convert(Elementary::Lreal, of);
            }
            _ => {
                for value in values {
                    self.expression(value);
                }
                self.one_value(function, of);
            }
        }
    }

    fn one_value(&mut self, function: Function, of: Elementary) {
        let single = of == Elementary::Real;
        let mut sink = self.function.sink();
        match (function, single) {
            (Function::Abs, _) if !of.is_real() => self.absolute(of),
            (Function::Abs, true) => _ = sink.f32_abs(),
            (Function::Abs, false) => _ = sink.f64_abs(),
            (Function::Sqrt, true) => _ = sink.f32_sqrt(),
            (Function::Sqrt, false) => _ = sink.f64_sqrt(),
            (Function::Trunc, true) => _ = sink.f32_trunc(),
            (Function::Trunc, false) => _ = sink.f64_trunc(),
            (Function::Round, true) => _ = sink.f32_nearest(),
            (Function::Round, false) => _ = sink.f64_nearest(),
            (Function::Floor, true) => _ = sink.f32_floor(),
            (Function::Floor, false) => _ = sink.f64_floor(),
            (Function::Ceil, true) => _ = sink.f32_ceil(),
            (Function::Ceil, false) => _ = sink.f64_ceil(),
            _ => {
                self.convert(of, Elementary::Lreal);
                self.host(function);
                self.convert(Elementary::Lreal, of);
            }
        }
    }

    /// A function of the host. Its numbers of 64 bits are on the stack.
    pub(super) fn host(&mut self, function: Function) {
        if let Some(name) = function.import() {
            self.context.want(Target::Import(name));
            self.function.call(Target::Import(name));
        }
    }

    /// The absolute value of a whole number.
    fn absolute(&mut self, of: Elementary) {
        if !of.is_signed() {
            return;
        }
        let local = self.function.local(value_type(of));
        let mut sink = self.function.sink();
        sink.local_set(local);
        if of.size() == 8 {
            sink.i64_const(0).local_get(local).i64_sub().local_get(local);
            sink.local_get(local).i64_const(0).i64_lt_s().select();
        } else {
            sink.i32_const(0).local_get(local).i32_sub().local_get(local);
            sink.local_get(local).i32_const(0).i32_lt_s().select();
            self.narrow(of);
        }
    }

    /// MIN, MAX, and LIMIT as MIN(MAX(IN, MN), MX). Of strings the addresses are chosen.
    fn extreme(&mut self, function: Function, of: Elementary, values: &[Expr]) {
        let text = self.is_text(values);
        let pair = |emitter: &mut Self, function: Function| match text {
            true => emitter.pair_of_texts(function),
            false => emitter.pair(function, of),
        };
        if let (Function::Limit, [least, value, most]) = (function, values) {
            self.expression(value);
            self.expression(least);
            pair(self, Function::Max);
            self.expression(most);
            pair(self, Function::Min);
            return;
        }
        for (place, value) in values.iter().enumerate() {
            self.expression(value);
            if place > 0 {
                pair(self, function);
            }
        }
    }

    fn is_text(&self, values: &[Expr]) -> bool {
        let types = &self.context.program.types;
        values
            .first()
            .is_some_and(|value| matches!(types.get(value.ty), Type::Text(_)))
    }

    /// The smaller or larger one of two strings whose addresses are on the stack.
    fn pair_of_texts(&mut self, function: Function) {
        let (one, other) = (
            self.function.local(ValType::I32),
            self.function.local(ValType::I32),
        );
        let mut sink = self.function.sink();
        sink.local_set(other).local_tee(one).local_get(other);
        sink.local_get(one).local_get(other);
        self.helper(Helper::Compare);
        self.function.sink().i32_const(0);
        self.operation(chosen_by(function), Elementary::Dint);
        self.function.sink().select();
    }

    /// The smaller or larger one of two values on the stack.
    fn pair(&mut self, function: Function, of: Elementary) {
        let least = function == Function::Min;
        let ty = value_type(of);
        match (ty, least) {
            (ValType::F32, true) => _ = self.function.sink().f32_min(),
            (ValType::F32, false) => _ = self.function.sink().f32_max(),
            (ValType::F64, true) => _ = self.function.sink().f64_min(),
            (ValType::F64, false) => _ = self.function.sink().f64_max(),
            _ => {
                let (one, other) = (self.function.local(ty), self.function.local(ty));
                let mut sink = self.function.sink();
                sink.local_set(other)
                    .local_tee(one)
                    .local_get(other)
                    .local_get(one)
                    .local_get(other);
                self.operation(chosen_by(function), of);
                self.function.sink().select();
            }
        }
    }

    fn sel(&mut self, values: &[Expr]) {
        let [decides, zero, one] = values else { return };
        let local = self.function.local(ValType::I32);
        self.expression(decides);
        self.function.sink().local_set(local);
        // The first value on the stack is taken if the last one is not 0.
        self.expression(one);
        self.expression(zero);
        self.function.sink().local_get(local).select();
    }

    fn mux(&mut self, of: Elementary, values: &[Expr], span: Span) {
        let Some((decides, inputs)) = values.split_first() else {
            return;
        };
        let given = self.function.local(ValType::I64);
        self.expression(decides);
        let site = self.site(span, FaultKind::Choice);
        self.function
            .sink()
            .local_tee(given)
            .i64_const(inputs.len() as i64)
            .i64_ge_u();
        self.fault_if(site, given, Elementary::Lint);
        let chosen = self.function.local(value_type(of));
        for (place, input) in inputs.iter().enumerate() {
            self.expression(input);
            if place > 0 {
                let mut sink = self.function.sink();
                sink.local_get(chosen)
                    .local_get(given)
                    .i64_const(place as i64)
                    .i64_eq()
                    .select();
            }
            self.function.sink().local_set(chosen);
        }
        self.function.sink().local_get(chosen);
    }

    /// SHL and SHR: 0 if all bits are shifted out.
    fn shift(&mut self, function: Function, of: Elementary, values: &[Expr]) {
        let [value, by] = values else { return };
        self.expression(value);
        let given = self.function.local(ValType::I64);
        self.expression(by);
        let mut sink = self.function.sink();
        sink.local_tee(given);
        match (of.size() == 8, function == Function::Shl) {
            (true, true) => sink.i64_shl(),
            (true, false) => sink.i64_shr_u(),
            (false, true) => sink.i32_wrap_i64().i32_shl(),
            (false, false) => sink.i32_wrap_i64().i32_shr_u(),
        };
        self.narrow(of);
        self.constant(of, 0);
        let mut sink = self.function.sink();
        sink.local_get(given)
            .i64_const(of.bits().into())
            .i64_lt_u()
            .select();
    }

    fn rotate(&mut self, function: Function, of: Elementary, values: &[Expr]) {
        let [value, by] = values else { return };
        let left = function == Function::Rol;
        self.expression(value);
        if of.size() >= 4 {
            self.expression(by);
            let mut sink = self.function.sink();
            match (of.size() == 8, left) {
                (true, true) => sink.i64_rotl(),
                (true, false) => sink.i64_rotr(),
                (false, true) => sink.i32_wrap_i64().i32_rotl(),
                (false, false) => sink.i32_wrap_i64().i32_rotr(),
            };
            return;
        }
        // In 8 and 16 bits by two shifts; the width is a power of two, so it cuts the distance.
        let bits = of.bits().cast_signed();
        let (given, by_local) = (
            self.function.local(ValType::I32),
            self.function.local(ValType::I32),
        );
        self.function.sink().local_set(given);
        self.expression(by);
        let mut sink = self.function.sink();
        sink.i32_wrap_i64()
            .i32_const(bits - 1)
            .i32_and()
            .local_set(by_local);
        sink.local_get(given).local_get(by_local);
        if left {
            sink.i32_shl();
        } else {
            sink.i32_shr_u();
        }
        sink.local_get(given)
            .i32_const(bits)
            .local_get(by_local)
            .i32_sub();
        if left {
            sink.i32_shr_u();
        } else {
            sink.i32_shl();
        }
        sink.i32_or();
        self.narrow(of);
    }
}

/// The comparison by which the first of two values is the result.
fn chosen_by(function: Function) -> Operator {
    match function {
        Function::Min => Operator::Less,
        _ => Operator::Greater,
    }
}

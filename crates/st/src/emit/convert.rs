//! Conversions between elementary types.

use super::expression::Emitter;
use super::function::value_type;
use crate::types::{Class, Elementary};
use wasm_encoder::ValType;

/// Nanoseconds of a millisecond, in which TIME becomes a number.
const MILLISECOND: i64 = 1_000_000;

impl Emitter<'_, '_, '_> {
    /// Turns the value on the stack from one type into another.
    pub(super) fn convert(&mut self, from: Elementary, to: Elementary) {
        if from == to {
            return;
        }
        match (from.class(), to.class()) {
            (Class::Time, Class::Time) => {}
            (_, Class::Bool) => self.convert_to_bool(from),
            (Class::Time, Class::Real) => {
                let mut sink = self.function.sink();
                sink.f64_convert_i64_s();
                if from == Elementary::Time {
                    sink.f64_const((MILLISECOND as f64).into()).f64_div();
                }
                self.convert(Elementary::Lreal, to);
            }
            (Class::Time, _) => {
                if from == Elementary::Time {
                    self.function.sink().i64_const(MILLISECOND).i64_div_s();
                }
                self.convert(Elementary::Lint, to);
            }
            (Class::Real, Class::Time) => {
                self.convert(from, Elementary::Lreal);
                if to == Elementary::Time {
                    self.function
                        .sink()
                        .f64_const((MILLISECOND as f64).into())
                        .f64_mul();
                }
                self.convert(Elementary::Lreal, Elementary::Lint);
            }
            (_, Class::Time) => {
                self.convert(from, Elementary::Lint);
                if to == Elementary::Time {
                    self.function.sink().i64_const(MILLISECOND).i64_mul();
                }
            }
            (Class::Real, Class::Real) => {
                if to == Elementary::Lreal {
                    self.function.sink().f64_promote_f32();
                } else {
                    self.function.sink().f32_demote_f64();
                }
            }
            (Class::Real, _) => self.real_to_whole(from, to),
            (_, Class::Real) => self.whole_to_real(from, to),
            _ => self.whole_to_whole(from, to),
        }
    }

    fn convert_to_bool(&mut self, from: Elementary) {
        let mut sink = self.function.sink();
        match value_type(from) {
            ValType::F32 => sink.f32_const(0.0.into()).f32_ne(),
            ValType::F64 => sink.f64_const(0.0.into()).f64_ne(),
            ValType::I64 => sink.i64_const(0).i64_ne(),
            _ => sink.i32_const(0).i32_ne(),
        };
    }

    fn whole_to_real(&mut self, from: Elementary, to: Elementary) {
        let wide = from.size() == 8;
        let mut sink = self.function.sink();
        match (to == Elementary::Real, wide, from.is_signed()) {
            (true, false, true) => sink.f32_convert_i32_s(),
            (true, false, false) => sink.f32_convert_i32_u(),
            (true, true, true) => sink.f32_convert_i64_s(),
            (true, true, false) => sink.f32_convert_i64_u(),
            (false, false, true) => sink.f64_convert_i32_s(),
            (false, false, false) => sink.f64_convert_i32_u(),
            (false, true, true) => sink.f64_convert_i64_s(),
            (false, true, false) => sink.f64_convert_i64_u(),
        };
    }

    fn whole_to_whole(&mut self, from: Elementary, to: Elementary) {
        match (from.size() == 8, to.size() == 8) {
            (false, true) if from.is_signed() => {
                self.function.sink().i64_extend_i32_s();
            }
            (false, true) => {
                self.function.sink().i64_extend_i32_u();
            }
            (true, false) => {
                self.function.sink().i32_wrap_i64();
                self.narrow(to);
            }
            (false, false) => {
                // A value that fits unchanged needs no instruction.
                let fits = to.size() == 4 || from.size() < to.size() && !from.is_signed();
                if !fits && !from.widens_to(to) {
                    self.narrow(to);
                }
            }
            (true, true) => {}
        }
    }

    /// Half to even, saturating; NaN becomes 0.
    fn real_to_whole(&mut self, from: Elementary, to: Elementary) {
        let single = from == Elementary::Real;
        let signed = to.is_signed();
        let mut sink = self.function.sink();
        if single {
            sink.f32_nearest();
        } else {
            sink.f64_nearest();
        }
        match (to.size() == 8, single, signed) {
            (true, true, true) => sink.i64_trunc_sat_f32_s(),
            (true, true, false) => sink.i64_trunc_sat_f32_u(),
            (true, false, true) => sink.i64_trunc_sat_f64_s(),
            (true, false, false) => sink.i64_trunc_sat_f64_u(),
            (false, true, true) => sink.i32_trunc_sat_f32_s(),
            (false, true, false) => sink.i32_trunc_sat_f32_u(),
            (false, false, true) => sink.i32_trunc_sat_f64_s(),
            (false, false, false) => sink.i32_trunc_sat_f64_u(),
        };
        if to.size() < 4 {
            let (low, high) = to.range();
            if signed {
                self.clamp(low as i32, false, true);
            }
            self.clamp(high as i32, true, signed);
        }
    }

    /// The value on the stack, or `limit` if it is beyond.
    fn clamp(&mut self, limit: i32, upper: bool, signed: bool) {
        let local = self.function.local(ValType::I32);
        let mut sink = self.function.sink();
        sink.local_tee(local)
            .i32_const(limit)
            .local_get(local)
            .i32_const(limit);
        match (upper, signed) {
            (true, true) => sink.i32_lt_s(),
            (true, false) => sink.i32_lt_u(),
            (false, _) => sink.i32_gt_s(),
        };
        sink.select();
    }

    /// Keeps the low bits of a type of 8 or 16 bits, with its sign.
    pub(super) fn narrow(&mut self, to: Elementary) {
        let mut sink = self.function.sink();
        match (to.size(), to.is_signed()) {
            (1, true) => sink.i32_extend8_s(),
            (1, false) => sink.i32_const(0xFF).i32_and(),
            (2, true) => sink.i32_extend16_s(),
            (2, false) => sink.i32_const(0xFFFF).i32_and(),
            _ => &mut sink,
        };
    }
}

//! Loops.

use super::FaultKind;
use super::expression::{Emitter, Loop};
use super::function::{Label, at, value_type};
use crate::layout;
use crate::source::Span;
use crate::syntax::Operator;
use crate::typed::{Expr, For, Stmt};
use crate::types::Elementary;
use wasm_encoder::{BlockType, ValType};

/// The step of a FOR.
#[derive(Clone, Copy, Debug)]
enum Stride {
    Known(i128),
    /// The local variables with its size, and with its direction.
    Local {
        size: u32,
        up: u32,
        signed: u32,
    },
}

impl Emitter<'_, '_, '_> {
    /// Notes the running loop, which is reported if the fuel is used up.
    fn note_loop(&mut self, site: Option<i32>) {
        let Some(site) = site else { return };
        self.function
            .sink()
            .i32_const(0)
            .i32_const(site)
            .i32_store(at(layout::LOOP_SITE, 2));
    }

    fn begin_loop(&mut self, span: Span) -> (Option<i32>, Label) {
        let keyword = Span {
            start: span.start,
            end: (span.start + 6).min(span.end),
        };
        let site = (!self.context.sources.in_library(span)).then(|| self.site(keyword, FaultKind::Loop));
        self.note_loop(site);
        (site, self.function.block())
    }

    fn end_loop(&mut self) {
        self.function.end();
        let around = self.loops.last().and_then(|around| around.site);
        self.note_loop(around);
    }

    /// The statements of a loop, within a block that CONTINUE leaves.
    fn turn(&mut self, exit: Label, site: Option<i32>, body: &[Stmt]) {
        let again = self.function.block();
        self.loops.push(Loop { exit, again, site });
        self.statements(body);
        self.loops.pop();
        self.function.end();
    }

    pub(super) fn while_(&mut self, condition: &Expr, body: &[Stmt], span: Span) {
        let (site, exit) = self.begin_loop(span);
        let top = self.function.loop_();
        self.expression(condition);
        self.function.sink().i32_eqz();
        self.function.branch_if(exit);
        self.turn(exit, site, body);
        self.function.branch(top);
        self.function.end();
        self.end_loop();
    }

    pub(super) fn repeat(&mut self, body: &[Stmt], condition: &Expr, span: Span) {
        let (site, exit) = self.begin_loop(span);
        let top = self.function.loop_();
        self.turn(exit, site, body);
        self.expression(condition);
        self.function.sink().i32_eqz();
        self.function.branch_if(top);
        self.function.end();
        self.end_loop();
    }

    /// FOR. The end is detected by the remaining distance, which cannot overflow.
    pub(super) fn for_(&mut self, each: &For, span: Span) {
        let ty = value_type(each.ty);
        let (from, to) = (self.function.local(ty), self.function.local(ty));
        self.expression(&each.from);
        self.function.sink().local_set(from);
        self.expression(&each.to);
        self.function.sink().local_set(to);
        let stride = self.stride(&each.by);
        let (root, offset) = self.pinned(&each.variable);
        let (site, exit) = self.begin_loop(span);
        self.push_root(root);
        self.function.sink().local_get(from);
        self.store_within(each.ty, each.range, each.from.span, offset);
        self.beyond(each.ty, from, to, stride);
        self.function.branch_if(exit);
        let top = self.function.loop_();
        self.turn(exit, site, &each.body);
        // From here on `from` is the value in this iteration.
        self.push_root(root);
        self.load(each.ty, offset);
        self.function.sink().local_set(from);
        self.distance_is_short(each.ty, from, to, stride);
        self.function.if_(BlockType::Empty);
        self.last_value(each, root, offset, from, stride);
        self.function.branch(exit);
        self.function.end();
        self.push_root(root);
        self.advanced(each.ty, from, stride);
        self.store_within(each.ty, each.range, each.from.span, offset);
        self.function.branch(top);
        self.function.end();
        self.end_loop();
    }

    fn stride(&mut self, by: &Expr) -> Stride {
        if let Some(number) = Self::is_constant(by) {
            return Stride::Known(number);
        }
        let (signed, size) = (
            self.function.local(ValType::I64),
            self.function.local(ValType::I64),
        );
        let up = self.function.local(ValType::I32);
        let site = self.site(by.span, FaultKind::Step);
        self.expression(by);
        let mut sink = self.function.sink();
        sink.local_tee(signed).i64_const(0).i64_gt_s().local_set(up);
        sink.local_get(signed)
            .i64_const(0)
            .local_get(signed)
            .i64_sub()
            .local_get(up)
            .select();
        sink.local_tee(size).i64_eqz();
        self.plain_fault_if(site);
        Stride::Local { size, up, signed }
    }

    /// Pushes whether the first value is already beyond the end.
    fn beyond(&mut self, ty: Elementary, from: u32, to: u32, stride: Stride) {
        match stride {
            Stride::Known(number) if number > 0 => self.between(Operator::Greater, ty, from, to),
            Stride::Known(_) => self.between(Operator::Less, ty, from, to),
            Stride::Local { up, .. } => {
                self.between(Operator::Greater, ty, from, to);
                self.between(Operator::Less, ty, from, to);
                self.function.sink().local_get(up).select();
            }
        }
    }

    /// An operator between two local variables.
    fn between(&mut self, operator: Operator, ty: Elementary, one: u32, other: u32) {
        self.function.sink().local_get(one).local_get(other);
        self.operation(operator, ty);
    }

    /// Pushes the distance from `one` to `other`, which is not negative, as a number of the width of the type.
    fn distance(&mut self, ty: Elementary, one: u32, other: u32) {
        self.function.sink().local_get(other).local_get(one);
        self.difference(ty);
    }

    /// Pushes whether less than a stride is left.
    fn distance_is_short(&mut self, ty: Elementary, from: u32, to: u32, stride: Stride) {
        match stride {
            Stride::Known(number) => {
                let (one, other) = if number > 0 { (from, to) } else { (to, from) };
                self.distance(ty, one, other);
                self.less_than_known(ty, number.unsigned_abs());
            }
            Stride::Local { size, up, .. } => {
                self.distance(ty, from, to);
                self.distance(ty, to, from);
                self.function.sink().local_get(up).select();
                if ty.size() < 8 {
                    self.function.sink().i64_extend_i32_u();
                }
                self.function.sink().local_get(size).i64_lt_u();
            }
        }
    }

    /// Compares a distance on the stack with the size of a step that may be larger than the type holds.
    fn less_than_known(&mut self, ty: Elementary, size: u128) {
        let mut sink = self.function.sink();
        match u32::try_from(size) {
            Ok(size) if ty.size() < 8 => sink.i32_const(size.cast_signed()).i32_lt_u(),
            Err(_) if ty.size() < 8 => sink.drop().i32_const(1),
            _ => sink.i64_const(size as i64).i64_lt_u(),
        };
    }

    /// Pushes the next value.
    fn advanced(&mut self, ty: Elementary, from: u32, stride: Stride) {
        self.function.sink().local_get(from);
        match stride {
            Stride::Known(number) => self.constant(ty, number),
            Stride::Local { signed, .. } => {
                self.function.sink().local_get(signed);
                if ty.size() < 8 {
                    self.function.sink().i32_wrap_i64();
                }
            }
        }
        if ty.size() == 8 {
            self.function.sink().i64_add();
        } else {
            self.function.sink().i32_add();
        }
    }

    /// After the loop the variable has the first value beyond its end, if its type can hold it.
    fn last_value(&mut self, each: &For, root: super::place::Root, offset: u32, from: u32, stride: Stride) {
        let ty = each.ty;
        let (low, high) = each.range;
        let limit = self.function.local(value_type(ty));
        match stride {
            Stride::Known(number) => {
                self.constant(ty, if number > 0 { high } else { low });
                self.function.sink().local_set(limit);
            }
            Stride::Local { up, .. } => {
                self.constant(ty, high);
                self.constant(ty, low);
                self.function.sink().local_get(up).select().local_set(limit);
            }
        }
        self.distance_is_short(ty, from, limit, stride);
        self.function.sink().i32_eqz();
        self.function.if_(BlockType::Empty);
        self.push_root(root);
        self.advanced(ty, from, stride);
        self.store(ty, offset);
        self.function.end();
    }
}

//! Strings: a byte with their length, and their bytes behind it.

use super::expression::Emitter;
use super::function::{Function, at};
use super::{FaultKind, Target};
use crate::library;
use crate::source::Span;
use crate::syntax::Operator;
use crate::typed::Expr;
use crate::types::{Elementary, TEXT_MOST};
use wasm_encoder::{BlockType, ValType};

/// Helper functions of the module for strings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Helper {
    /// `(to, capacity, from)`: copies as many bytes as there is room for.
    Assign,
    /// `(to, capacity, from, first, count)`: adds bytes from index `first` on, as many as exist and fit.
    Append,
    /// `(one, other)`: below 0, 0 or above 0, by the first byte that differs.
    Compare,
    /// `(in, what)`: the position of its first occurrence, from 1; 0 if there is none.
    Find,
}

/// All bytes of a string, and any position in it, in 32 bits.
const ALL: i32 = TEXT_MOST as i32;

/// A number larger than any string; the sum of two does not overflow.
const FAR: i64 = 1 << 30;

/// The length of the string whose address is on the stack.
fn length(function: &mut Function) {
    function.sink().i32_load8_u(at(0, 0));
}

/// Sets a local variable to the smaller of itself and the number on the stack.
fn at_most(function: &mut Function, local: u32, other: u32) {
    let mut sink = function.sink();
    sink.local_set(other)
        .local_get(local)
        .local_get(other)
        .local_get(local)
        .local_get(other);
    sink.i32_lt_s().select().local_set(local);
}

pub(super) fn helper(helper: Helper) -> Function {
    match helper {
        Helper::Assign => assign(),
        Helper::Append => append(),
        Helper::Compare => compare(),
        Helper::Find => find(),
    }
}

fn assign() -> Function {
    let mut function = Function::new(vec![ValType::I32; 3], None);
    let (to, capacity, from) = (0, 1, 2);
    let (count, other) = (function.local(ValType::I32), function.local(ValType::I32));
    function.sink().local_get(from);
    length(&mut function);
    function.sink().local_set(count).local_get(capacity);
    at_most(&mut function, count, other);
    let mut sink = function.sink();
    sink.local_get(to).i32_const(1).i32_add();
    sink.local_get(from).i32_const(1).i32_add();
    sink.local_get(count).memory_copy(0, 0);
    sink.local_get(to).local_get(count).i32_store8(at(0, 0));
    function
}

fn append() -> Function {
    let mut function = Function::new(vec![ValType::I32; 5], None);
    let (to, capacity, from, first, count) = (0, 1, 2, 3, 4);
    let (used, other) = (function.local(ValType::I32), function.local(ValType::I32));
    function.sink().local_get(to);
    length(&mut function);
    function.sink().local_set(used).local_get(from);
    length(&mut function);
    function.sink().local_get(first).i32_sub();
    at_most(&mut function, count, other);
    function.sink().local_get(capacity).local_get(used).i32_sub();
    at_most(&mut function, count, other);
    // There is nothing behind the last byte.
    function.sink().local_get(count).i32_const(0).i32_gt_s();
    function.if_(BlockType::Empty);
    let mut sink = function.sink();
    sink.local_get(to)
        .local_get(used)
        .i32_add()
        .i32_const(1)
        .i32_add();
    sink.local_get(from)
        .local_get(first)
        .i32_add()
        .i32_const(1)
        .i32_add();
    sink.local_get(count).memory_copy(0, 0);
    sink.local_get(to);
    sink.local_get(used)
        .local_get(count)
        .i32_add()
        .i32_store8(at(0, 0));
    function.end();
    function
}

/// Pushes the byte at index `index` of a string.
fn byte(function: &mut Function, text: u32, index: u32) {
    let mut sink = function.sink();
    sink.local_get(text)
        .local_get(index)
        .i32_add()
        .i32_load8_u(at(1, 0));
}

fn add_one(function: &mut Function, local: u32) {
    let mut sink = function.sink();
    sink.local_get(local).i32_const(1).i32_add().local_set(local);
}

fn compare() -> Function {
    let mut function = Function::new(vec![ValType::I32; 2], Some(ValType::I32));
    let (one, other) = (0, 1);
    let [count, index, rest] = [(); 3].map(|()| function.local(ValType::I32));
    function.sink().local_get(one);
    length(&mut function);
    function.sink().local_set(count).local_get(other);
    length(&mut function);
    at_most(&mut function, count, rest);
    let same = function.block();
    let top = function.loop_();
    function.sink().local_get(index).local_get(count).i32_ge_s();
    function.branch_if(same);
    byte(&mut function, one, index);
    byte(&mut function, other, index);
    function.sink().i32_sub().local_tee(rest);
    function.if_(BlockType::Empty);
    function.sink().local_get(rest).return_();
    function.end();
    add_one(&mut function, index);
    function.branch(top);
    function.end();
    function.end();
    function.sink().local_get(one);
    length(&mut function);
    function.sink().local_get(other);
    length(&mut function);
    function.sink().i32_sub();
    function
}

fn find() -> Function {
    let mut function = Function::new(vec![ValType::I32; 2], Some(ValType::I32));
    let (text, what) = (0, 1);
    let [last, count, begin, index, place] = [(); 5].map(|()| function.local(ValType::I32));
    function.sink().local_get(what);
    length(&mut function);
    function.sink().local_set(count).local_get(text);
    length(&mut function);
    function.sink().local_get(count).i32_sub().local_set(last);
    let nowhere = function.block();
    function.sink().local_get(count).i32_eqz();
    function.branch_if(nowhere);
    let places = function.loop_();
    function.sink().local_get(begin).local_get(last).i32_gt_s();
    function.branch_if(nowhere);
    function.sink().i32_const(0).local_set(index);
    let differs = function.block();
    let bytes = function.loop_();
    function
        .sink()
        .local_get(begin)
        .local_get(index)
        .i32_add()
        .local_set(place);
    byte(&mut function, text, place);
    byte(&mut function, what, index);
    function.sink().i32_ne();
    function.branch_if(differs);
    add_one(&mut function, index);
    function.sink().local_get(index).local_get(count).i32_lt_s();
    function.branch_if(bytes);
    function.sink().local_get(begin).i32_const(1).i32_add().return_();
    function.end();
    function.end();
    add_one(&mut function, begin);
    function.branch(places);
    function.end();
    function.end();
    function.sink().i32_const(0);
    function
}

impl Emitter<'_, '_, '_> {
    pub(super) fn helper(&mut self, helper: Helper) {
        self.context.want(Target::Text(helper));
        self.function.call(Target::Text(helper));
    }

    /// Pushes the address of a string literal.
    pub(super) fn text(&mut self, bytes: &[u8]) {
        let place = self.context.templates_at + self.context.templates.len() as u32;
        // The lexer guarantees that the length fits.
        self.context.templates.push(bytes.len() as u8);
        self.context.templates.extend(bytes);
        self.function.sink().i32_const(place.cast_signed());
    }

    /// Compares two strings; the result is a BOOL.
    pub(super) fn compare_texts(&mut self, operator: Operator, one: &Expr, other: &Expr) {
        self.expression(one);
        self.expression(other);
        self.helper(Helper::Compare);
        self.function.sink().i32_const(0);
        self.operation(operator, Elementary::Dint);
    }

    /// A function whose value is a string: its pieces one behind the other at `buffer`, whose address is pushed.
    pub(super) fn join(&mut self, function: library::Function, values: &[Expr], buffer: u32, span: Span) {
        use library::Function as F;
        let locals: Vec<u32> = values.iter().map(|value| self.text_input(value, span)).collect();
        self.function
            .sink()
            .i32_const(buffer.cast_signed())
            .i32_const(0)
            .i32_store8(at(0, 0));
        match (function, locals.as_slice()) {
            (F::Left, [text, count]) => self.piece(buffer, *text, None, Some(*count)),
            (F::Right, [text, count]) => {
                let first = self.function.local(ValType::I32);
                self.function.sink().local_get(*text);
                length(&mut self.function);
                self.function.sink().local_get(*count).i32_sub().local_set(first);
                // All of it, if that is less.
                let mut sink = self.function.sink();
                sink.local_get(first).i32_const(0).local_get(first);
                sink.i32_const(0).i32_gt_s().select().local_set(first);
                self.piece(buffer, *text, Some(first), None);
            }
            (F::Mid, [text, count, position]) => {
                self.position(*text, *position, 1, span);
                self.piece(buffer, *text, Some(*position), Some(*count));
            }
            (F::Insert, [text, piece, position]) => {
                self.position(*text, *position, 0, span);
                self.piece(buffer, *text, None, Some(*position));
                self.piece(buffer, *piece, None, None);
                self.piece(buffer, *text, Some(*position), None);
            }
            (F::Delete, [text, count, position]) => {
                self.position(*text, *position, 1, span);
                self.piece(buffer, *text, None, Some(*position));
                self.behind(*position, *count);
                self.piece(buffer, *text, Some(*position), None);
            }
            (F::Replace, [text, piece, count, position]) => {
                self.position(*text, *position, 1, span);
                self.piece(buffer, *text, None, Some(*position));
                self.piece(buffer, *piece, None, None);
                self.behind(*position, *count);
                self.piece(buffer, *text, Some(*position), None);
            }
            (_, texts) => texts
                .iter()
                .for_each(|text| self.piece(buffer, *text, None, None)),
        }
        self.function.sink().i32_const(buffer.cast_signed());
    }

    /// Evaluates an input: the address of a string, or a number that is not negative, as 32 bits.
    fn text_input(&mut self, value: &Expr, span: Span) -> u32 {
        let local = self.function.local(ValType::I32);
        self.expression(value);
        if self.type_of(value.ty).is_some() {
            let number = self.function.local(ValType::I64);
            self.function.sink().local_tee(number).i64_const(0).i64_lt_s();
            self.text_fault(number, span);
            // A position beyond every string is far enough.
            let mut sink = self.function.sink();
            sink.local_get(number).i64_const(FAR).local_get(number);
            sink.i64_const(FAR).i64_lt_s().select().i32_wrap_i64();
        }
        self.function.sink().local_set(local);
        local
    }

    /// A fault if the top of the stack is true.
    fn text_fault(&mut self, number: u32, span: Span) {
        let site = self.site(span, FaultKind::Position);
        self.fault_if(site, number, Elementary::Lint);
    }

    /// A position from `least` up to the one behind the string becomes an index from 0.
    fn position(&mut self, text: u32, position: u32, least: i32, span: Span) {
        let number = self.function.local(ValType::I64);
        let mut sink = self.function.sink();
        sink.local_get(position).i64_extend_i32_s().local_set(number);
        sink.local_get(position)
            .i32_const(least)
            .i32_sub()
            .local_tee(position);
        sink.local_get(text);
        length(&mut self.function);
        // A position below the least one wraps around and is then too large.
        self.function.sink().i32_gt_u();
        self.text_fault(number, span);
    }

    /// Advances by this many bytes.
    fn behind(&mut self, position: u32, count: u32) {
        let mut sink = self.function.sink();
        sink.local_get(position)
            .local_get(count)
            .i32_add()
            .local_set(position);
    }

    /// Adds a piece of a string: from an index or the begin, a number of bytes or all.
    fn piece(&mut self, buffer: u32, text: u32, first: Option<u32>, count: Option<u32>) {
        let mut sink = self.function.sink();
        sink.i32_const(buffer.cast_signed())
            .i32_const(ALL)
            .local_get(text);
        match first {
            Some(first) => sink.local_get(first),
            None => sink.i32_const(0),
        };
        match count {
            Some(count) => sink.local_get(count),
            None => sink.i32_const(ALL),
        };
        self.helper(Helper::Append);
    }
}

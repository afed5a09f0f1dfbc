//! Places: their addresses, and how they are read and written.

use super::expression::Emitter;
use super::function::at;
use super::{FaultKind, Target};
use crate::source::Span;
use crate::typed::{Base, Index, Kind, Place};
use crate::types::Elementary;
use wasm_encoder::{BlockType, ValType};

/// The source of an address after its indices are evaluated; it can be used any number of times.
#[derive(Clone, Copy, Debug)]
pub(super) enum Root {
    Zero,
    Local(u32),
    /// The address at this offset from a local variable, or from 0.
    Pointer(Option<u32>, u32),
}

const THIS: u32 = 0;

impl Emitter<'_, '_, '_> {
    fn root(&self, base: Base) -> (Root, u32) {
        match base {
            Base::Memory => (Root::Zero, 0),
            Base::This => (Root::Local(THIS), 0),
            Base::ThisPointer(offset) => (Root::Pointer(Some(THIS), offset), 0),
            Base::MemoryPointer(offset) => (Root::Pointer(None, offset), 0),
            Base::Callee => self.callee,
        }
    }

    pub(super) fn push_root(&mut self, root: Root) {
        if let Root::Pointer(Some(local), offset) = root
            && self.is_method
        {
            let site = self.site(self.statement, FaultKind::Unbound);
            self.function
                .sink()
                .local_get(local)
                .i32_load(at(offset, 2))
                .i32_eqz();
            self.plain_fault_if(site);
        }
        let mut sink = self.function.sink();
        match root {
            Root::Zero => sink.i32_const(0),
            Root::Local(local) => sink.local_get(local),
            Root::Pointer(Some(local), offset) => sink.local_get(local).i32_load(at(offset, 2)),
            Root::Pointer(None, offset) => sink.i32_const(0).i32_load(at(offset, 2)),
        };
    }

    /// Pushes the address of a place without its fixed offset, which is returned.
    pub(super) fn address(&mut self, place: &Place) -> u32 {
        let (root, more) = self.root(place.base);
        let mut pushed = !matches!(root, Root::Zero) || place.indices.is_empty();
        if pushed {
            self.push_root(root);
        }
        for index in &place.indices {
            self.index(index);
            if pushed {
                self.function.sink().i32_add();
            }
            pushed = true;
        }
        place.offset + more
    }

    /// Pushes the whole address.
    pub(super) fn whole_address(&mut self, place: &Place) {
        let offset = self.address(place);
        self.add_offset(offset);
    }

    pub(super) fn add_offset(&mut self, offset: u32) {
        if offset > 0 {
            self.function.sink().i32_const(offset.cast_signed()).i32_add();
        }
    }

    /// Evaluates the indices, so that the address can be used more than once.
    pub(super) fn pinned(&mut self, place: &Place) -> (Root, u32) {
        let (root, more) = self.root(place.base);
        if place.indices.is_empty() {
            return (root, place.offset + more);
        }
        let offset = self.address(place);
        let local = self.function.local(ValType::I32);
        self.function.sink().local_set(local);
        (Root::Local(local), offset)
    }

    /// Pushes the distance in bytes of an element from the first one.
    fn index(&mut self, index: &Index) {
        let of = self.elementary(&index.value);
        self.expression(&index.value);
        // 32 bits without a sign would wrap around below a negative bound.
        let wide = of.size() == 8 || of == Elementary::Udint && index.low < 0;
        let site = self.site(index.span, FaultKind::Index);
        let stride = index.stride.cast_signed();
        if wide {
            if of.size() < 8 {
                self.function.sink().i64_extend_i32_u();
            }
            let given = self.function.local(ValType::I64);
            self.function
                .sink()
                .local_tee(given)
                .i64_const(index.low)
                .i64_sub();
            self.function.sink().i64_const(index.count.into()).i64_ge_u();
            if of == Elementary::Ulint {
                // A value beyond LINT is outside every bound.
                self.function
                    .sink()
                    .local_get(given)
                    .i64_const(0)
                    .i64_lt_s()
                    .i32_or();
            }
            self.fault_if(site, given, Elementary::Lint);
            let mut sink = self.function.sink();
            sink.local_get(given)
                .i64_const(index.low)
                .i64_sub()
                .i32_wrap_i64();
        } else {
            let local = self.function.local(ValType::I32);
            let low = index.low as i32;
            if low != 0 {
                self.function.sink().i32_const(low).i32_sub();
            }
            let count = index.count.cast_signed();
            self.function.sink().local_tee(local).i32_const(count).i32_ge_u();
            self.function.if_(BlockType::Empty);
            self.function
                .sink()
                .i32_const(site)
                .local_get(local)
                .i32_const(low)
                .i32_add();
            self.fault_value(of);
            self.fault();
            self.function.sink().local_get(local);
        }
        if stride != 1 {
            self.function.sink().i32_const(stride).i32_mul();
        }
    }

    /// Ends the branch of a fault, whose site and value were pushed.
    pub(super) fn fault(&mut self) {
        self.context.want(Target::Fault);
        self.function.call(Target::Fault);
        self.function.sink().unreachable();
        self.function.end();
    }

    /// Reads a value of an elementary type at the address on the stack and `offset`.
    pub(super) fn load(&mut self, of: Elementary, offset: u32) {
        let mut sink = self.function.sink();
        match (of.is_real(), of.size(), of.is_signed()) {
            (true, 4, _) => sink.f32_load(at(offset, 2)),
            (true, ..) => sink.f64_load(at(offset, 3)),
            (_, 8, _) => sink.i64_load(at(offset, 3)),
            (_, 4, _) => sink.i32_load(at(offset, 2)),
            (_, 2, true) => sink.i32_load16_s(at(offset, 1)),
            (_, 2, false) => sink.i32_load16_u(at(offset, 1)),
            (.., true) => sink.i32_load8_s(at(offset, 0)),
            (.., false) => sink.i32_load8_u(at(offset, 0)),
        };
    }

    /// Writes the value on the stack to the address below it and `offset`.
    pub(super) fn store(&mut self, of: Elementary, offset: u32) {
        let mut sink = self.function.sink();
        match (of.is_real(), of.size()) {
            (true, 4) => sink.f32_store(at(offset, 2)),
            (true, _) => sink.f64_store(at(offset, 3)),
            (_, 8) => sink.i64_store(at(offset, 3)),
            (_, 4) => sink.i32_store(at(offset, 2)),
            (_, 2) => sink.i32_store16(at(offset, 1)),
            _ => sink.i32_store8(at(offset, 0)),
        };
    }

    /// Pushes the value at a place, or the address of a value with members or elements.
    pub(super) fn read(&mut self, place: &Place) {
        let Some(of) = self.context.program.types.elementary(place.ty) else {
            return self.whole_address(place);
        };
        let offset = self.address(place);
        self.load(of, offset);
        let Some(bit) = place.bit else { return };
        let mut sink = self.function.sink();
        if of.size() == 8 {
            sink.i64_const(bit.into()).i64_shr_u().i32_wrap_i64();
        } else {
            sink.i32_const(bit.cast_signed()).i32_shr_u();
        }
        sink.i32_const(1).i32_and();
    }

    /// Writes one bit.
    pub(super) fn write_bit(&mut self, place: &Place, of: Elementary, bit: u32, value: &crate::typed::Expr) {
        let (root, offset) = self.pinned(place);
        // The value comes first, so that its own side effects are kept.
        self.expression(value);
        let given = self.function.local(ValType::I32);
        self.function.sink().local_set(given);
        self.push_root(root);
        self.push_root(root);
        self.load(of, offset);
        let mut sink = self.function.sink();
        if of.size() == 8 {
            sink.i64_const(!(1_u64 << bit).cast_signed()).i64_and();
            sink.local_get(given)
                .i64_extend_i32_u()
                .i64_const(bit.into())
                .i64_shl()
                .i64_or();
        } else {
            sink.i32_const(!(1_u32 << bit).cast_signed()).i32_and();
            sink.local_get(given)
                .i32_const(bit.cast_signed())
                .i32_shl()
                .i32_or();
        }
        let range = self.context.program.types.range(place.ty);
        self.store_within(of, range, value.span, offset);
    }

    /// Writes the whole number on the stack as `store` does; a fault if what would be stored is outside the range.
    pub(super) fn store_within(&mut self, of: Elementary, range: (i128, i128), span: Span, offset: u32) {
        if range != of.range() {
            self.narrow(of);
            self.must_be_within(of, range, span);
        }
        self.store(of, offset);
    }

    /// Whether the value of an expression is already known.
    pub(super) const fn is_constant(value: &crate::typed::Expr) -> Option<i128> {
        match value.kind {
            Kind::Integer(number) => Some(number),
            _ => None,
        }
    }
}

//! Calls of functions and of instances.

use super::expression::Emitter;
use super::function::{at, value_type};
use super::place::Root;
use super::text::Helper;
use super::{FaultKind, Target};
use crate::check::UnitKind;
use crate::library::blocks;
use crate::source::Span;
use crate::typed::{Argument, BlockCall, Expr, FunctionCall, Place};
use crate::types::{Elementary, Type};
use standstill_fb::{BlockInfo, PinType};
use wasm_encoder::ValType;

/// Offset of the records of a table, behind their count.
const RECORDS: u32 = 8;

impl Emitter<'_, '_, '_> {
    /// A call of a FUNCTION or METHOD; its value remains on the stack.
    pub(super) fn function_call(&mut self, call: &FunctionCall) {
        if let Some(instance) = &call.instance {
            self.whole_address(instance);
        }
        for argument in &call.arguments {
            match argument {
                Argument::Value(value) => self.expression(value),
                Argument::Reference(place) => self.whole_address(place),
            }
        }
        self.context.want(Target::Unit(call.unit));
        self.function.call(Target::Unit(call.unit));
        self.outputs(&call.outputs);
        if let Some((buffer, bytes)) = call.buffer {
            let value = self.function.local(ValType::I32);
            let (buffer, bytes) = (buffer.cast_signed(), bytes.cast_signed());
            let mut sink = self.function.sink();
            sink.local_set(value).i32_const(buffer).local_get(value);
            sink.i32_const(bytes).memory_copy(0, 0).i32_const(buffer);
        }
    }

    /// Writes outputs to their variables.
    fn outputs(&mut self, outputs: &[(Place, Expr)]) {
        for (target, value) in outputs {
            self.assign(target, value);
        }
    }

    /// Writes a value of any type.
    pub(super) fn assign(&mut self, target: &Place, value: &Expr) {
        let program = self.context.program;
        match (program.types.elementary(target.ty), target.bit) {
            (Some(of), Some(bit)) => self.write_bit(target, of, bit, value),
            (Some(of), None) => {
                let offset = self.address(target);
                self.expression(value);
                self.store(of, offset);
            }
            (None, _) if matches!(program.types.get(target.ty), Type::Text(_)) => {
                self.whole_address(target);
                self.assign_text(target.ty, |emitter| emitter.expression(value));
            }
            (None, _) => {
                self.whole_address(target);
                self.expression(value);
                let bytes = program.size(target.ty).cast_signed();
                self.function.sink().i32_const(bytes).memory_copy(0, 0);
            }
        }
    }

    /// Copies a string, whose address `from` pushes, to the address on the stack.
    pub(super) fn assign_text(&mut self, to: crate::types::TypeId, from: impl FnOnce(&mut Self)) {
        if let Type::Text(capacity) = *self.context.program.types.get(to) {
            self.function.sink().i32_const(capacity.into());
            from(self);
            self.helper(Helper::Assign);
        }
    }

    pub(super) fn block_call(&mut self, call: &BlockCall, span: Span) {
        let before = self.callee;
        self.callee = self.pinned(&call.instance);
        let (root, offset) = self.callee;
        for (place, value) in &call.inputs {
            self.assign(place, value);
        }
        let program = self.context.program;
        let unit = program.unit(call.unit);
        let members = &unit.members.list;
        for (member, bound) in &call.references {
            let Some(member) = members.get(*member) else {
                continue;
            };
            match unit.kind {
                UnitKind::Library(_) => self.reference(root, offset + member.offset, bound),
                _ => {
                    self.push_root(root);
                    self.whole_address(bound);
                    self.function.sink().i32_store(at(offset + member.offset, 2));
                }
            }
        }
        if let UnitKind::Library(info) = unit.kind {
            self.library_block(info, root, offset);
        } else {
            for member in call.kept.iter().filter_map(|place| members.get(*place)) {
                let site = self.site(span, FaultKind::Unbound);
                self.push_root(root);
                self.function
                    .sink()
                    .i32_load(at(offset + member.offset, 2))
                    .i32_eqz();
                self.plain_fault_if(site);
            }
            self.push_root(root);
            self.add_offset(offset);
            self.context.want(Target::Unit(call.unit));
            self.function.call(Target::Unit(call.unit));
        }
        self.outputs(&call.outputs);
        self.callee = before;
    }

    /// The form of a variable for a block of the library: the number of an axis, or the records of a
    /// table.
    fn reference(&mut self, root: Root, offset: u32, bound: &Place) {
        let types = &self.context.program.types;
        let table =
            matches!(types.get(bound.ty), Type::Structure(it) if it.members.find("RECORDS").is_some());
        if !table {
            self.push_root(root);
            let from = self.address(bound);
            self.function
                .sink()
                .i32_load(at(from, 2))
                .i32_store(at(offset, 2));
            return;
        }
        let (from, start) = self.pinned(bound);
        self.push_root(root);
        self.push_root(from);
        self.add_offset(start + RECORDS);
        self.function.sink().i32_store(at(offset, 2));
        self.push_root(root);
        self.push_root(from);
        self.function
            .sink()
            .i32_load(at(start, 2))
            .i32_store(at(offset + 4, 2));
    }

    /// A block of the library: its key, inputs and outputs are in the instance, followed by its result.
    fn library_block(&mut self, info: &'static BlockInfo, root: Root, offset: u32) {
        let import = Target::Import(blocks::import(info));
        self.context.want(import);
        self.push_root(root);
        for part in [0, blocks::INPUTS, blocks::outputs(info)] {
            self.push_root(root);
            self.add_offset(offset + part);
        }
        self.function.call(import);
        self.function
            .sink()
            .i32_store(at(offset + blocks::result(info), 2));
        debug_assert!(
            info.outputs()
                .iter()
                .all(|pin| !matches!(pin.ty, PinType::Table(_)))
        );
    }

    /// The way in which a parameter of a FUNCTION is passed.
    pub(super) fn parameter(of: Option<Elementary>) -> ValType {
        of.map_or(ValType::I32, value_type)
    }
}

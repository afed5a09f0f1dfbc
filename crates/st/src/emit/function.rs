//! A function under construction: its instructions, its local variables, and the targets of its branches.

use super::Target;
use crate::types::Elementary;
use wasm_encoder::{BlockType, Encode, InstructionSink, MemArg, MemArgTarget, ValType};

/// Least number of bytes of a function's body. The interpreter refuses a module whose functions are shorter than 40
/// bytes on average, as a possible attack.
const BODY_LEAST: usize = 40;

pub(super) struct Function {
    pub parameters: Vec<ValType>,
    pub result: Option<ValType>,
    pub code: Vec<u8>,
    locals: Vec<ValType>,
    /// Local variables in use, in the order in which they were reserved.
    active: Vec<(ValType, u32)>,
    free: Vec<(ValType, u32)>,
    /// The places where numbers of functions are inserted.
    calls: Vec<(usize, Target)>,
    /// Open blocks.
    depth: u32,
}

/// A block that branches lead to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Label(u32);

/// An address in memory with a fixed offset; `align` is a power of two.
pub(super) const fn at(offset: u32, align: u32) -> MemArg {
    MemArg {
        offset: offset as u64,
        align,
        target: MemArgTarget::Memory(0),
        ordering: None,
    }
}

/// The representation of a value of an elementary type on the stack.
pub(super) const fn value_type(of: Elementary) -> ValType {
    match (of.is_real(), of.size()) {
        (true, 4) => ValType::F32,
        (true, _) => ValType::F64,
        (false, 8) => ValType::I64,
        (false, _) => ValType::I32,
    }
}

impl Function {
    pub(super) fn new(parameters: Vec<ValType>, result: Option<ValType>) -> Self {
        Self {
            parameters,
            result,
            code: Vec::new(),
            locals: Vec::new(),
            active: Vec::new(),
            free: Vec::new(),
            calls: Vec::new(),
            depth: 0,
        }
    }

    pub(super) fn sink(&mut self) -> InstructionSink<'_> {
        InstructionSink::new(&mut self.code)
    }

    /// A call of a function whose number is not known yet.
    pub(super) fn call(&mut self, target: Target) {
        self.code.push(0x10);
        self.calls.push((self.code.len(), target));
        self.code.extend([0x80, 0x80, 0x80, 0x80, 0x00]);
    }

    /// A local variable until [`Function::release`].
    pub(super) fn local(&mut self, ty: ValType) -> u32 {
        let place = self.free.iter().rposition(|(it, _)| *it == ty);
        let local = match place {
            Some(place) => self.free.swap_remove(place).1,
            None => {
                self.locals.push(ty);
                (self.parameters.len() + self.locals.len() - 1) as u32
            }
        };
        self.active.push((ty, local));
        local
    }

    pub(super) fn mark(&self) -> usize {
        self.active.len()
    }

    /// Releases the local variables that were reserved since.
    pub(super) fn release(&mut self, mark: usize) {
        self.free.extend(self.active.drain(mark..));
    }

    pub(super) fn block(&mut self) -> Label {
        self.sink().block(BlockType::Empty);
        self.depth += 1;
        Label(self.depth)
    }

    pub(super) fn loop_(&mut self) -> Label {
        self.sink().loop_(BlockType::Empty);
        self.depth += 1;
        Label(self.depth)
    }

    pub(super) fn if_(&mut self, ty: BlockType) {
        self.sink().if_(ty);
        self.depth += 1;
    }

    pub(super) fn else_(&mut self) {
        self.sink().else_();
    }

    pub(super) fn end(&mut self) {
        self.sink().end();
        self.depth -= 1;
    }

    /// The number of blocks between here and a label.
    pub(super) const fn distance(&self, label: Label) -> u32 {
        self.depth - label.0
    }

    pub(super) fn branch(&mut self, label: Label) {
        let distance = self.distance(label);
        self.sink().br(distance);
    }

    pub(super) fn branch_if(&mut self, label: Label) {
        let distance = self.distance(label);
        self.sink().br_if(distance);
    }

    /// The body as the section of code has it.
    pub(super) fn finish(mut self, index: impl Fn(Target) -> u32) -> Vec<u8> {
        for (place, target) in std::mem::take(&mut self.calls) {
            let number = index(target);
            for (digit, byte) in self.code.iter_mut().skip(place).take(5).enumerate() {
                *byte |= (number >> (7 * digit)) as u8 & 0x7F;
            }
        }
        if self.code.len() < BODY_LEAST {
            // Computed values stay on the stack, and nothing behind this is executed.
            self.sink().return_();
            self.code.resize(BODY_LEAST, 0x01);
            self.sink().unreachable();
        }
        self.sink().end();
        let mut groups: Vec<(u32, ValType)> = Vec::new();
        for ty in &self.locals {
            match groups.last_mut() {
                Some((count, last)) if last == ty => *count += 1,
                _ => groups.push((1, *ty)),
            }
        }
        let mut out = Vec::with_capacity(self.code.len() + 16);
        (groups.len() as u32).encode(&mut out);
        for (count, ty) in groups {
            count.encode(&mut out);
            ty.encode(&mut out);
        }
        out.extend(self.code);
        out
    }
}

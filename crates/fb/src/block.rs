//! A block as a type, an instance of it, and the data that a call may use.

use crate::flat::Pointer;
use crate::{Direction, Pin, PinError, Pins, Value};
use standstill_axis::{Axis, AxisId, ErrorId, Master, Planner, Scope, Standard};

/// The groups of the standard's catalogue, and ours for the IEC 61131-3 blocks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Group {
    /// Switches, reads or writes; moves nothing.
    Administrative,
    /// Moves one axis.
    SingleAxis,
    /// Couples axes.
    MultiAxis,
    /// Finds or sets the reference.
    Homing,
    /// IEC 61131-3 standard function blocks.
    Standard,
}

impl Group {
    /// The group's name in `standstill blocks --json`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Administrative => "administrative",
            Self::SingleAxis => "single_axis",
            Self::MultiAxis => "multi_axis",
            Self::Homing => "homing",
            Self::Standard => "standard",
        }
    }
}

/// The data that a block may use during one call.
#[derive(Debug)]
pub struct Context<'a, P: Planner = Standard> {
    /// Time of this task execution (ns). It does not change during the call.
    pub now_ns: i64,
    /// This scan, the instance being called, and the ring that takes its records.
    pub scope: Scope<'a>,
    /// The axes.
    pub axes: &'a mut [Axis<P>],
    /// The numbers of all tables.
    pub tables: &'a [f64],
}

impl<'a, P: Planner> Context<'a, P> {
    /// The axis at a pin, together with the call it is used in.
    ///
    /// # Errors
    /// [`ErrorId::AxisUnknown`] if there is no such axis.
    #[inline]
    pub fn axis(&mut self, id: AxisId) -> Result<(&mut Axis<P>, &mut Scope<'a>), ErrorId> {
        let axis = self.axes.get_mut(id.index()).ok_or(ErrorId::AxisUnknown)?;
        Ok((axis, &mut self.scope))
    }

    /// The axis at the pin Slave, together with the call it is used in.
    ///
    /// # Errors
    /// [`ErrorId::AxisUnknown`] if there is no such axis. It is recorded.
    pub fn slave(&mut self, id: AxisId) -> Result<(&mut Axis<P>, &mut Scope<'a>), ErrorId> {
        let count = self.axes.len();
        match self.axes.get_mut(id.index()) {
            Some(axis) => Ok((axis, &mut self.scope)),
            None => Err(self.scope.refuse_axis("Slave", id, count)),
        }
    }

    /// The axis at a pin as a master, with its turns if it has them.
    pub fn master(&self, axis: AxisId) -> Master {
        let turn = self.axes.get(axis.index()).and_then(|axis| axis.config().modulo);
        Master { axis, turn }
    }
}

/// A function block: its pins and what one call does.
pub trait Block: Copy + Default {
    /// IEC name.
    const NAME: &'static str;
    /// Its place in the catalogue.
    const GROUP: Group;
    /// One sentence.
    const DOC: &'static str;
    /// In_outs and inputs.
    type Inputs: Pins;
    /// Outputs.
    type Outputs: Pins;

    /// One call. Bounded work, no allocation; errors are outputs.
    fn call<P: Planner>(&mut self, inputs: &Self::Inputs, context: &mut Context<'_, P>) -> Self::Outputs;
}

/// A block with the memory IEC 61131-3 gives an instance: inputs and outputs keep their values between calls.
#[derive(Clone, Copy, Debug, Default)]
pub struct Instance<B: Block> {
    /// In_outs and inputs, as last written.
    pub inputs: B::Inputs,
    /// Outputs of the last call.
    pub outputs: B::Outputs,
    /// The state of the block itself.
    pub block: B,
}

impl<B: Block> Instance<B> {
    /// Calls the block with the present inputs.
    // Inlined, so that the outputs are written in place: after a copy the processor would wait for its
    // own writes.
    #[inline(always)]
    pub fn call<P: Planner>(&mut self, context: &mut Context<'_, P>) {
        self.outputs = self.block.call(&self.inputs, context);
    }

    /// Calls the block with the inputs in `flat` ([`Pins::set_flat`]).
    pub fn call_flat<P: Planner>(&mut self, flat: &[u8], pointer: Pointer, context: &mut Context<'_, P>) {
        self.inputs.set_flat(flat, pointer);
        self.call(context);
    }
}

/// An instance of some block, reached by pin index: in_outs, inputs, outputs in table order.
pub trait AnyInstance {
    /// The block's table.
    fn info(&self) -> &'static BlockInfo;

    /// The value at pin `index`.
    fn get(&self, index: usize) -> Option<Value>;

    /// Writes the words ([`Value::word`]) of all pins in table order, until `words` is full.
    fn put_words(&self, words: &mut [u64]);

    /// Writes in_out or input `index`.
    ///
    /// # Errors
    /// [`PinError`] if it is an output, does not exist, or has another type.
    fn set(&mut self, index: usize, value: Value) -> Result<(), PinError>;

    /// Sets the in_outs and inputs as [`Pins::set_flat`] does.
    fn set_flat(&mut self, flat: &[u8], pointer: Pointer);

    /// Writes the outputs as [`Pins::put_flat`] does.
    fn put_flat(&self, flat: &mut [u8]);
}

impl<B: Block + Described> AnyInstance for Instance<B> {
    fn info(&self) -> &'static BlockInfo {
        &B::INFO
    }

    fn get(&self, index: usize) -> Option<Value> {
        let inputs = B::Inputs::PINS.len();
        if index < inputs {
            self.inputs.get(index)
        } else {
            self.outputs.get(index - inputs)
        }
    }

    fn put_words(&self, words: &mut [u64]) {
        self.inputs.put_words(words);
        if let Some(outputs) = words.get_mut(B::Inputs::PINS.len()..) {
            self.outputs.put_words(outputs);
        }
    }

    fn set(&mut self, index: usize, value: Value) -> Result<(), PinError> {
        self.inputs.set(index, value)
    }

    #[inline]
    fn set_flat(&mut self, flat: &[u8], pointer: Pointer) {
        self.inputs.set_flat(flat, pointer);
    }

    #[inline]
    fn put_flat(&self, flat: &mut [u8]) {
        self.outputs.put_flat(flat);
    }
}

/// A block as data: what a registry lists.
#[derive(Clone, Copy, Debug)]
pub struct BlockInfo {
    /// IEC name.
    pub name: &'static str,
    /// Group of the catalogue.
    pub group: Group,
    /// One sentence.
    pub doc: &'static str,
    inputs: &'static [Pin],
    outputs: &'static [Pin],
    default: fn(usize) -> Option<Value>,
}

/// Gives every block its table.
pub trait Described: Block {
    /// The table.
    const INFO: BlockInfo = BlockInfo {
        name: Self::NAME,
        group: Self::GROUP,
        doc: Self::DOC,
        inputs: <Self::Inputs as Pins>::PINS,
        outputs: <Self::Outputs as Pins>::PINS,
        default: |index| Self::Inputs::default().get(index),
    };
}

impl<B: Block> Described for B {}

impl BlockInfo {
    /// All pins: in_outs, inputs, outputs. The position is the pin's index.
    pub fn pins(&self) -> impl Iterator<Item = &'static Pin> + Clone {
        self.inputs.iter().chain(self.outputs)
    }

    /// Pins of one kind.
    pub fn pins_of(&self, direction: Direction) -> impl Iterator<Item = &'static Pin> {
        self.pins().filter(move |pin| pin.direction == direction)
    }

    /// In_outs and inputs.
    pub const fn inputs(&self) -> &'static [Pin] {
        self.inputs
    }

    /// Outputs.
    pub const fn outputs(&self) -> &'static [Pin] {
        self.outputs
    }

    /// Number of in_outs and inputs; pins from here on are outputs.
    pub fn input_count(&self) -> usize {
        self.inputs.len()
    }

    /// Index and table entry of the pin called `name`, without regard to case.
    pub fn pin(&self, name: &str) -> Option<(usize, &'static Pin)> {
        self.pins()
            .enumerate()
            .find(|(_, pin)| pin.name.eq_ignore_ascii_case(name))
    }

    /// The value of input `index` before it is wired or written; `None` for outputs.
    pub fn default_of(&self, index: usize) -> Option<Value> {
        (self.default)(index)
    }
}

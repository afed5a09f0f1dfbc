//! Block instances that belong to the runtime.

use alloc::string::String;
use alloc::vec::Vec;
use standstill_axis::InstanceId;
use standstill_blocks::BlockInstance;
use standstill_fb::{AnyInstance, Context, PinError, Value};

/// A block instance of the runtime.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BlockId(pub(super) u16);

/// The block instances of a runtime, by number.
#[derive(Clone, Debug, Default)]
pub struct Blocks {
    /// Each with its number in records.
    all: Vec<(String, InstanceId, BlockInstance)>,
}

impl Blocks {
    /// Adds an instance; `None` if there is no number left.
    pub(super) fn add(&mut self, name: &str, number: InstanceId, instance: BlockInstance) -> Option<BlockId> {
        let id = u16::try_from(self.all.len()).ok().map(BlockId)?;
        self.all.push((name.into(), number, instance));
        Some(id)
    }

    /// The instance of this name, without regard to case.
    pub fn find(&self, name: &str) -> Option<BlockId> {
        let mut numbered = (0..).zip(&self.all);
        numbered
            .find(|(_, (known, ..))| known.eq_ignore_ascii_case(name))
            .map(|(number, _)| BlockId(number))
    }

    /// An instance; `None` for an id of another runtime.
    pub fn get(&self, id: BlockId) -> Option<&BlockInstance> {
        self.all.get(usize::from(id.0)).map(|(.., instance)| instance)
    }

    /// An instance, to write several of its inputs.
    pub fn get_mut(&mut self, id: BlockId) -> Option<&mut BlockInstance> {
        self.all.get_mut(usize::from(id.0)).map(|(.., instance)| instance)
    }

    /// Calls an instance with its present inputs. Cost: that of the block. An id of another runtime does
    /// nothing.
    pub fn call(&mut self, id: BlockId, context: &mut Context<'_>) {
        if let Some((_, number, instance)) = self.all.get_mut(usize::from(id.0)) {
            context.scope.instance = *number;
            instance.call(context);
        }
    }

    /// Writes an input or in_out by its IEC name, without regard to case. Cost: a search through the pins
    /// of the block.
    ///
    /// # Errors
    /// [`PinError`] if there is no such pin, it is an output, or it has another type.
    pub fn set(&mut self, id: BlockId, pin: &str, value: Value) -> Result<(), PinError> {
        let instance = self.get_mut(id).ok_or(PinError::NotWritable)?;
        let (index, _) = instance.info().pin(pin).ok_or(PinError::NotWritable)?;
        instance.set(index, value)
    }

    /// The value at a pin by its IEC name, without regard to case; `None` if there is no such pin.
    pub fn value(&self, id: BlockId, pin: &str) -> Option<Value> {
        let instance = self.get(id)?;
        let (index, _) = instance.info().pin(pin)?;
        instance.get(index)
    }

    /// Whether a BOOL pin is TRUE. FALSE if there is no such pin.
    pub fn is(&self, id: BlockId, pin: &str) -> bool {
        self.value(id, pin) == Some(Value::Bool(true))
    }

    /// All instances, in the order in which they were added.
    pub(super) fn instances(&self) -> impl Iterator<Item = &BlockInstance> {
        self.all.iter().map(|(.., instance)| instance)
    }

    /// The names of all instances, with their numbers in records.
    pub(super) fn named(&self) -> impl Iterator<Item = (&str, InstanceId, &BlockInstance)> {
        self.all
            .iter()
            .map(|(name, number, instance)| (name.as_str(), *number, instance))
    }
}

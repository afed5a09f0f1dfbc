//! The values of input variables and pins, and of wires.

use super::cells::{self, convert};
use crate::model::{Point, Script, Wire};
use standstill_blocks::BlockInstance;
use standstill_fb::{AnyInstance, Value};

/// The present values that a script's wires read and its steps write.
#[derive(Clone, Debug)]
pub(crate) struct Values {
    pub(crate) variables: Vec<Value>,
    pub(crate) instances: Vec<BlockInstance>,
    /// Of guest programs: the values after their last call, and those written since then.
    pub(crate) symbols: Vec<Vec<Value>>,
    /// Of the expressions of wires: the values read last.
    pub(crate) formulas: Vec<Option<Value>>,
}

impl Values {
    /// Variables at their initial values, pins at the script's constants. `None` if a block is not in the
    /// registry or refuses one of the constants, which a checked script excludes.
    pub(crate) fn new(script: &Script) -> Option<Self> {
        let mut instances = Vec::with_capacity(script.blocks.len());
        for declared in &script.blocks {
            let mut instance = BlockInstance::new(declared.block.name)?;
            for (pin, value) in &declared.constants {
                instance.set(*pin, *value).ok()?;
            }
            instances.push(instance);
        }
        Some(Self {
            variables: script.inputs.iter().map(|input| input.initial).collect(),
            instances,
            symbols: Vec::new(),
            formulas: vec![None; script.formulas.len()],
        })
    }

    /// The value at a point.
    pub(crate) fn read(&self, point: Point) -> Option<Value> {
        match point {
            Point::Input(index) => self.variables.get(index).copied(),
            Point::Pin(instance, pin) => self.instances.get(instance)?.get(pin),
            Point::Symbol(program, symbol) => self.symbols.get(program)?.get(symbol).copied(),
            Point::Formula(index) => *self.formulas.get(index)?,
        }
    }

    /// Writes a variable, or an input pin if it can hold the value.
    pub(crate) fn write(&mut self, point: Point, value: Value) -> Option<()> {
        match point {
            Point::Input(index) => {
                let variable = self.variables.get_mut(index)?;
                // A variable keeps its declared type.
                *variable = convert(value, cells::type_of(*variable))?;
            }
            Point::Pin(instance, pin) => {
                let instance = self.instances.get_mut(instance)?;
                let ty = instance.info().pins().nth(pin)?.ty;
                instance.set(pin, convert(value, ty)?).ok()?;
            }
            Point::Symbol(program, symbol) => {
                let place = self.symbols.get_mut(program)?.get_mut(symbol)?;
                *place = convert(value, cells::type_of(*place))?;
            }
            // It is never written.
            Point::Formula(_) => return None,
        }
        Some(())
    }

    /// The value of a wire; a logical wire has none if one of its points is no BOOL.
    pub(crate) fn wire(&self, wire: &Wire) -> Option<Value> {
        // The number of points that are TRUE; none if one of them is no BOOL.
        let count = |points: &[Point]| {
            let mut flags = points.iter().map(|point| self.bool(*point));
            flags.try_fold(0, |count, flag| Some(count + usize::from(flag?)))
        };
        match wire {
            Wire::From(point) => self.read(*point),
            Wire::Not(point) => Some(Value::Bool(!self.bool(*point)?)),
            Wire::Any(points) => Some(Value::Bool(count(points)? > 0)),
            Wire::All(points) => Some(Value::Bool(count(points)? == points.len())),
        }
    }

    /// The BOOL value of a wire.
    pub(crate) fn wire_bool(&self, wire: &Wire) -> Option<bool> {
        match self.wire(wire)? {
            Value::Bool(value) => Some(value),
            _ => None,
        }
    }

    fn bool(&self, point: Point) -> Option<bool> {
        match self.read(point)? {
            Value::Bool(value) => Some(value),
            _ => None,
        }
    }
}

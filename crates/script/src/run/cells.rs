//! Values at pins as cells of a trace.

use crate::model::{Point, Script};
use standstill_fb::{PinType, Value};
use standstill_record::told::Cells;
use standstill_trace::cell_text;

/// The cells of a script's trace.
pub(crate) fn cells(script: &Script) -> Cells {
    Cells::new(script.axes.iter().map(|axis| axis.name.clone()))
}

/// A value in the text of its cell; `ty` names the elements of an enum.
pub(crate) fn value_text(script: &Script, ty: Option<PinType>, value: Value) -> String {
    let mut cells = cells(script);
    let ty = ty.unwrap_or(PinType::Lreal);
    cells.prepare(ty, value);
    cell_text(cells.cell(ty, value))
}

/// A variable or pin with its name in scripts.
pub(crate) fn point_name(script: &Script, point: Point) -> String {
    match point {
        Point::Input(index) => script.inputs.get(index).map(|input| input.name.clone()),
        Point::Pin(instance, pin) => script.blocks.get(instance).and_then(|instance| {
            let pin = instance.block.pins().nth(pin)?;
            Some(format!("{}.{}", instance.name, pin.name))
        }),
        Point::Symbol(program, symbol) => script.programs.get(program).and_then(|program| {
            let symbol = program.symbols.get(symbol)?;
            Some(format!("{}.{}", program.name, symbol.name))
        }),
        Point::Formula(index) => script.formulas.get(index).map(|formula| formula.text.clone()),
    }
    .unwrap_or_default()
}

/// The type of an input variable or a guest's variable with this value.
pub(crate) fn type_of(value: Value) -> PinType {
    match value {
        Value::Bool(_) => PinType::Bool,
        Value::Int(_) => PinType::Int,
        Value::Word(_) => PinType::Word,
        Value::Dword(_) => PinType::Dword,
        Value::Time(_) => PinType::Time,
        // Other values are no types of symbols.
        _ => PinType::Lreal,
    }
}

/// A value converted to the type `ty` of a pin; `None` if the pin cannot hold it.
pub(crate) fn convert(value: Value, ty: PinType) -> Option<Value> {
    match (value, ty) {
        (Value::Bool(_), PinType::Bool)
        | (Value::Int(_), PinType::Int)
        | (Value::Lreal(_), PinType::Lreal)
        | (Value::Word(_), PinType::Word | PinType::Uint)
        | (Value::Dword(_), PinType::Dword)
        | (Value::Table(_), PinType::Table(_))
        | (Value::Time(_), PinType::Time)
        | (Value::Axis(_), PinType::Axis(_))
        | (Value::Enum(_), PinType::Enum(_)) => Some(value),
        (_, PinType::Lreal) => match value {
            Value::Time(ns) => Some(Value::Lreal(ns as f64)),
            _ => whole(value).map(|whole| Value::Lreal(whole as f64)),
        },
        (_, PinType::Int) => Some(Value::Int(whole(value)?.try_into().ok()?)),
        (_, PinType::Word | PinType::Uint) => Some(Value::Word(whole(value)?.try_into().ok()?)),
        (_, PinType::Dword) => Some(Value::Dword(whole(value)?.try_into().ok()?)),
        (_, PinType::Time) => Some(Value::Time(whole(value)?)),
        (_, PinType::Enum(_)) => Some(Value::Enum(whole(value)?.try_into().ok()?)),
        (_, PinType::Bool | PinType::Axis(_) | PinType::Table(_)) => None,
    }
}

/// A numeric value as a whole number, if it is one.
fn whole(value: Value) -> Option<i64> {
    match value {
        Value::Int(value) => Some(value.into()),
        Value::Word(value) => Some(value.into()),
        Value::Dword(value) => Some(value.into()),
        Value::Time(ns) => Some(ns),
        Value::Enum(number) => Some(number.into()),
        Value::Lreal(value) => {
            // The cast saturates, so a value that changes there and back is no i64.
            let cast = value as i64;
            (cast as f64 == value && cast != i64::MAX).then_some(cast)
        }
        Value::Bool(_) | Value::Axis(_) | Value::Table(_) => None,
    }
}

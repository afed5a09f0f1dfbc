//! Values at pins as cells of a trace.

use crate::model::{Point, Script};
use standstill_axis::AxisId;
use standstill_fb::{EnumInfo, PinType, TableRef, Value};
use standstill_trace::{Cell, cell_text};
use std::collections::BTreeMap;

/// Texts for enum numbers that have no name, and for tables; a cell only borrows its text.
#[derive(Clone, Debug, Default)]
pub(crate) struct Undefined {
    numbers: BTreeMap<i32, String>,
    tables: BTreeMap<u16, String>,
}

impl Undefined {
    /// Makes the text of a value that will need one.
    pub(crate) fn prepare(&mut self, ty: PinType, value: Value) {
        match (ty, value) {
            (PinType::Enum(info), Value::Enum(number)) if info.name_of(number).is_none() => {
                self.number(number);
            }
            (_, Value::Table(TableRef { records, .. })) => {
                let text = || format!("{records} record{}", if records == 1 { "" } else { "s" });
                self.tables.entry(records).or_insert_with(text);
            }
            _ => {}
        }
    }

    fn number(&mut self, number: i32) {
        self.numbers.entry(number).or_insert_with(|| number.to_string());
    }

    /// The cell of a value at a pin of type `ty`, once it has been prepared.
    pub(crate) fn cell<'a>(&'a self, script: &'a Script, ty: PinType, value: Value) -> Cell<'a> {
        match value {
            Value::Bool(value) => Cell::Bool(value),
            Value::Int(value) => Cell::Integer(value.into()),
            Value::Lreal(value) => Cell::Real(value),
            Value::Word(value) => Cell::Integer(value.into()),
            Value::Dword(value) => Cell::Integer(value.into()),
            Value::Table(table) => Cell::Name(self.tables.get(&table.records).map_or("", String::as_str)),
            Value::Time(ns) => Cell::Integer(ns),
            Value::Axis(id) => Cell::Name(axis_name(script, id)),
            Value::Enum(number) => Cell::Name(
                enum_name(ty, number).unwrap_or_else(|| self.numbers.get(&number).map_or("", String::as_str)),
            ),
        }
    }
}

fn axis_name(script: &Script, id: AxisId) -> &str {
    script.axes.get(id.index()).map_or("", |axis| axis.name.as_str())
}

fn enum_name(ty: PinType, number: i32) -> Option<&'static str> {
    match ty {
        PinType::Enum(info) => info.name_of(number),
        _ => None,
    }
}

/// The number behind the text of an enum cell.
pub(crate) fn enum_number(info: &EnumInfo, text: &str) -> Option<i32> {
    info.number_of(text).or_else(|| text.parse().ok())
}

/// A value as its cell reads in text; `ty` names the elements of an enum.
pub(crate) fn value_text(script: &Script, ty: Option<PinType>, value: Value) -> String {
    let mut undefined = Undefined::default();
    let ty = ty.unwrap_or(PinType::Lreal);
    if let Value::Enum(number) = value {
        undefined.number(number);
    }
    cell_text(undefined.cell(script, ty, value))
}

/// A variable or pin as scripts name it.
pub(crate) fn point_name(script: &Script, point: Point) -> String {
    match point {
        Point::Input(index) => script.inputs.get(index).map(|input| input.name.clone()),
        Point::Pin(instance, pin) => script.blocks.get(instance).and_then(|instance| {
            let pin = instance.block.pins().nth(pin)?;
            Some(format!("{}.{}", instance.name, pin.name))
        }),
    }
    .unwrap_or_default()
}

/// A value as a pin of type `ty` takes it; `None` if the pin cannot hold it.
pub(crate) fn convert(value: Value, ty: PinType) -> Option<Value> {
    match (value, ty) {
        (Value::Bool(_), PinType::Bool)
        | (Value::Int(_), PinType::Int)
        | (Value::Lreal(_), PinType::Lreal)
        | (Value::Word(_), PinType::Word)
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
        (_, PinType::Word) => Some(Value::Word(whole(value)?.try_into().ok()?)),
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
            // The cast saturates, so what does not survive it there and back is no i64.
            let cast = value as i64;
            (cast as f64 == value && cast != i64::MAX).then_some(cast)
        }
        Value::Bool(_) | Value::Axis(_) | Value::Table(_) => None,
    }
}

//! Values at pins as cells of a trace.

use standstill_axis::AxisId;
use standstill_fb::{EnumInfo, PinType, TableRef, Value};
use standstill_trace::Cell;
use std::collections::BTreeMap;
use std::format;
use std::string::{String, ToString};
use std::vec::Vec;

/// Texts of axes, of enum numbers without a name, and of tables. A cell only borrows its text.
#[derive(Clone, Debug, Default)]
pub struct Cells {
    axes: Vec<String>,
    numbers: BTreeMap<i32, String>,
    tables: BTreeMap<u16, String>,
}

impl Cells {
    /// For axes of these names, in the order of their ids.
    pub fn new(axes: impl IntoIterator<Item = String>) -> Self {
        Self {
            axes: axes.into_iter().collect(),
            ..Self::default()
        }
    }

    /// Makes the text of a value that needs one.
    pub fn prepare(&mut self, ty: PinType, value: Value) {
        match (ty, value) {
            (_, Value::Enum(number)) if enum_name(ty, number).is_none() => {
                self.numbers.entry(number).or_insert_with(|| number.to_string());
            }
            (_, Value::Table(TableRef { records, .. })) => {
                let text = || format!("{records} record{}", if records == 1 { "" } else { "s" });
                self.tables.entry(records).or_insert_with(text);
            }
            _ => {}
        }
    }

    /// The cell of a value at a pin of type `ty`, after [`Cells::prepare`].
    pub fn cell(&self, ty: PinType, value: Value) -> Cell<'_> {
        match value {
            Value::Bool(value) => Cell::Bool(value),
            Value::Int(value) => Cell::Integer(value.into()),
            Value::Lreal(value) => Cell::Real(value),
            Value::Word(value) => Cell::Integer(value.into()),
            Value::Dword(value) => Cell::Integer(value.into()),
            Value::Table(table) => Cell::Name(self.tables.get(&table.records).map_or("", String::as_str)),
            Value::Time(ns) => Cell::Integer(ns),
            Value::Axis(id) => Cell::Name(self.axis(id)),
            Value::Enum(number) => Cell::Name(
                enum_name(ty, number).unwrap_or_else(|| self.numbers.get(&number).map_or("", String::as_str)),
            ),
        }
    }

    fn axis(&self, id: AxisId) -> &str {
        self.axes.get(id.index()).map_or("", String::as_str)
    }
}

fn enum_name(ty: PinType, number: i32) -> Option<&'static str> {
    match ty {
        PinType::Enum(info) => info.name_of(number),
        _ => None,
    }
}

/// The number behind the text of an enum cell.
pub fn enum_number(info: &EnumInfo, text: &str) -> Option<i32> {
    info.number_of(text).or_else(|| text.parse().ok())
}

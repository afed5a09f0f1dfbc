//! Values of pins as words of 64 bits, and back.

use standstill_axis::AxisId;
use standstill_fb::{PinType, TableRef, Value};

/// The value as a word; its type stands elsewhere.
pub(crate) const fn of(value: Value) -> u64 {
    match value {
        Value::Bool(value) => value as u64,
        Value::Int(value) => value as i64 as u64,
        Value::Lreal(value) => value.to_bits(),
        Value::Word(value) => value as u64,
        Value::Dword(value) => value as u64,
        Value::Time(ns) => ns.cast_unsigned(),
        Value::Axis(id) => id.index() as u64,
        Value::Enum(number) => number as i64 as u64,
        Value::Table(table) => (table.first as u64) << 16 | table.records as u64,
    }
}

/// The value of this type behind a word that [`of`] made.
pub(crate) fn value(ty: PinType, word: u64) -> Value {
    match ty {
        PinType::Bool => Value::Bool(word != 0),
        PinType::Int => Value::Int(word as i16),
        PinType::Lreal => Value::Lreal(f64::from_bits(word)),
        PinType::Uint | PinType::Word => Value::Word(word as u16),
        PinType::Dword => Value::Dword(word as u32),
        PinType::Time => Value::Time(word.cast_signed()),
        PinType::Axis(_) => Value::Axis(AxisId::new(word as u16)),
        PinType::Enum(_) => Value::Enum(word as i32),
        PinType::Table(_) => Value::Table(TableRef {
            first: (word >> 16) as u32,
            records: word as u16,
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_comes_back_as_it_was() {
        for (ty, values) in [
            (PinType::Bool, &[Value::Bool(true), Value::Bool(false)][..]),
            (PinType::Int, &[Value::Int(i16::MIN), Value::Int(7)]),
            (
                PinType::Lreal,
                &[Value::Lreal(-0.0), Value::Lreal(f64::INFINITY), Value::Lreal(0.1)],
            ),
            (PinType::Word, &[Value::Word(u16::MAX)]),
            (PinType::Uint, &[Value::Word(7)]),
            (PinType::Dword, &[Value::Dword(u32::MAX)]),
            (PinType::Time, &[Value::Time(-1), Value::Time(i64::MAX)]),
            (
                PinType::Axis("AXIS_REF"),
                &[Value::Axis(AxisId::NONE), Value::Axis(AxisId::new(3))],
            ),
        ] {
            for there in values {
                let back = value(ty, of(*there));
                assert_eq!(of(back), of(*there));
                assert_eq!(back, *there);
            }
        }
        let table = Value::Table(TableRef {
            first: u32::MAX,
            records: u16::MAX,
        });
        let Value::Table(TableRef { first, records }) = table else {
            unreachable!()
        };
        let word = of(table);
        assert_eq!(((word >> 16) as u32, word as u16), (first, records));
        assert_eq!(of(Value::Enum(-3)) as i32, -3);
    }
}

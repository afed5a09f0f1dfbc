//! Pins as bytes: the one layout in which hosts in other languages hand over the inputs of a block and
//! read its outputs. The C library, WebAssembly guests and the generated headers all use it.
//!
//! A block of pins is a C structure. It begins with its own size, a `u32`. Then come its pins in table order,
//! each at the next multiple of its own size:
//!
//! | pin | bytes |
//! | --- | --- |
//! | BOOL | `u8`; anything but 0 is TRUE, 0 or 1 is written |
//! | INT, UINT, WORD, DWORD | `i16`, `u16`, `u16`, `u32` |
//! | LREAL | `f64` |
//! | TIME | `i64`, nanoseconds |
//! | enumerations | `i32`, the number |
//! | AXIS_REF and similar references | `i32`, axis numbers from 1; 0 is no axis |
//! | arrays | the address of the first record, then the number of records, a `u32` |
//!
//! Numbers are little-endian here; a big-endian host swaps the bytes of each. A record of an array is
//! laid out by the same rules without a size in front. Sizes are rounded up to a multiple of 8.

use crate::{BlockInfo, Direction, Pin, PinType};

/// Bytes of the size in front of the pins.
pub const SIZE_FIELD: usize = 4;

/// The unit to which every size is rounded up.
pub const ALIGN: usize = 8;

/// The largest number of inputs or outputs of a block, and of fields of a record.
pub const PINS_MOST: usize = 32;

/// A number in the flat form of a pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Scalar {
    /// One byte.
    U8,
    /// Two bytes, signed.
    I16,
    /// Two bytes.
    U16,
    /// Four bytes.
    U32,
    /// Four bytes, signed.
    I32,
    /// Eight bytes, signed.
    I64,
    /// IEEE 754, eight bytes.
    F64,
}

impl Scalar {
    /// Its size in bytes, which is also its alignment.
    pub const fn size(self) -> usize {
        match self {
            Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::I32 => 4,
            Self::I64 | Self::F64 => 8,
        }
    }
}

/// The width of an address on the side that the bytes come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pointer {
    /// 32 bits, as in a WebAssembly guest.
    Bits32,
    /// 64 bits.
    Bits64,
}

impl Pointer {
    /// The width on the processor this is compiled for.
    pub const NATIVE: Self = if size_of::<usize>() == 8 {
        Self::Bits64
    } else {
        Self::Bits32
    };

    /// Its size in bytes.
    pub const fn size(self) -> usize {
        match self {
            Self::Bits32 => 4,
            Self::Bits64 => 8,
        }
    }
}

impl PinType {
    /// The scalar form of a pin of this type; `None` for an array, which is an address and a count.
    pub const fn scalar(self) -> Option<Scalar> {
        Some(match self {
            Self::Bool => Scalar::U8,
            Self::Int => Scalar::I16,
            Self::Uint | Self::Word => Scalar::U16,
            Self::Dword => Scalar::U32,
            Self::Lreal => Scalar::F64,
            Self::Time => Scalar::I64,
            Self::Axis(_) | Self::Enum(_) => Scalar::I32,
            Self::Table(_) => return None,
        })
    }
}

/// The offsets of the pins of a structure.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    offsets: [usize; PINS_MOST],
    /// The size of the whole in bytes.
    pub size: usize,
}

impl Layout {
    /// The layout of the inputs or outputs of a block, after the size field.
    pub const fn of_pins(pins: &[Pin], pointer: Pointer) -> Self {
        Self::from(pins, SIZE_FIELD, pointer)
    }

    /// The layout of a record of an array.
    pub const fn of_record(fields: &[Pin]) -> Self {
        // A record has no arrays, so the width of addresses does not matter.
        Self::from(fields, 0, Pointer::Bits64)
    }

    const fn from(pins: &[Pin], start: usize, pointer: Pointer) -> Self {
        let mut layout = Self {
            offsets: [0; PINS_MOST],
            size: start,
        };
        let mut index = 0;
        let mut rest = pins;
        while let [pin, others @ ..] = rest {
            let (size, align) = match pin.ty.scalar() {
                Some(scalar) => (scalar.size(), scalar.size()),
                None => (pointer.size() + 4, pointer.size()),
            };
            let offset = layout.size.next_multiple_of(align);
            if index < PINS_MOST {
                layout.offsets[index] = offset;
            }
            layout.size = offset + size;
            index += 1;
            rest = others;
        }
        layout.size = layout.size.next_multiple_of(ALIGN);
        layout
    }

    /// The offset of pin `index`, counted among the pins of this layout.
    #[inline]
    pub const fn offset(&self, index: usize) -> usize {
        if index < PINS_MOST { self.offsets[index] } else { 0 }
    }
}

impl BlockInfo {
    /// The layout of its in_outs and inputs.
    pub const fn flat_inputs(&self, pointer: Pointer) -> Layout {
        Layout::of_pins(self.inputs(), pointer)
    }

    /// The layout of its outputs.
    pub const fn flat_outputs(&self) -> Layout {
        // No output is an array.
        Layout::of_pins(self.outputs(), Pointer::Bits64)
    }

    /// Whether an input or in_out is an array.
    pub const fn has_tables(&self) -> bool {
        let mut rest = self.inputs();
        while let [pin, others @ ..] = rest {
            if pin.ty.scalar().is_none() {
                return true;
            }
            rest = others;
        }
        false
    }

    /// Its arrays: the index of the pin, and the pin.
    pub fn tables(&self) -> impl Iterator<Item = (usize, &'static Pin)> {
        self.inputs()
            .iter()
            .enumerate()
            .filter(|(_, pin)| pin.direction != Direction::Output && pin.ty.scalar().is_none())
    }
}

/// One pin value in bytes.
pub trait Flat: Copy {
    /// The number at `offset`; zero bytes if it is outside.
    fn read(flat: &[u8], offset: usize) -> Self;
    /// Writes the number to `offset`, unless it is outside.
    fn write(self, flat: &mut [u8], offset: usize);
}

macro_rules! flat {
    ($($ty:ty),*) => {$(
        impl Flat for $ty {
            #[inline]
            fn read(flat: &[u8], offset: usize) -> Self {
                let bytes = flat.get(offset..).and_then(|rest| rest.first_chunk());
                bytes.map_or(Self::default(), |bytes| Self::from_le_bytes(*bytes))
            }

            #[inline]
            fn write(self, flat: &mut [u8], offset: usize) {
                if let Some(bytes) = flat.get_mut(offset..).and_then(|rest| rest.first_chunk_mut()) {
                    *bytes = self.to_le_bytes();
                }
            }
        }
    )*};
}

flat!(u8, i16, u16, u32, i32, i64, u64, f64);

/// An array has no scalar value: the caller reads its records and sets the pin.
impl Flat for () {
    #[inline]
    fn read(_: &[u8], _: usize) -> Self {}

    #[inline]
    fn write(self, _: &mut [u8], _: usize) {}
}

/// The address and the count of the array at `offset`.
pub fn read_table(flat: &[u8], offset: usize, pointer: Pointer) -> (u64, u32) {
    let address = match pointer {
        Pointer::Bits32 => u64::from(u32::read(flat, offset)),
        Pointer::Bits64 => u64::read(flat, offset),
    };
    (address, u32::read(flat, offset + pointer.size()))
}

/// Spreads a record into the numbers of the runtime's tables: one for each field.
///
/// Cost: a few operations for each field. Fields that do not fit into `cells` are left out.
pub fn read_record(record: &[u8], fields: &[Pin], layout: &Layout, cells: &mut [f64]) {
    for ((index, field), cell) in fields.iter().enumerate().zip(cells) {
        let offset = layout.offset(index);
        *cell = match field.ty.scalar() {
            Some(Scalar::U8) => f64::from(u8::from(u8::read(record, offset) != 0)),
            Some(Scalar::I16) => i16::read(record, offset).into(),
            Some(Scalar::U16) => u16::read(record, offset).into(),
            Some(Scalar::U32) => u32::read(record, offset).into(),
            Some(Scalar::I32) => i32::read(record, offset).into(),
            Some(Scalar::I64) => i64::read(record, offset) as f64,
            Some(Scalar::F64) => f64::read(record, offset),
            None => 0.0,
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Int, PinError, Pins, TableInfo, Time, Value, pins};
    use standstill_axis::{AxisId, BufferMode, ErrorId, Raw};

    pins! {
        in_outs {
            /// An axis.
            Axis => axis: AxisId;
        }
        inputs {
            /// A level.
            Execute => execute: bool = false, "";
            /// A small number.
            Number => number: Int = 0, "";
            /// A position.
            Position => position: f64 = 0.0, "u";
            /// Another level.
            Enable => enable: bool = true, "";
            /// A time.
            PT => pt: Time = Time(0), "";
            /// A mode.
            BufferMode => buffer_mode: Raw<BufferMode> = Raw::new(0), "";
        }
        vendor_inputs {
            /// Bits.
            Mask => mask: u32 = 0, "";
        }
        outputs {
            /// A level.
            Done => done: bool, "";
            /// An error.
            ErrorID => error_id: ErrorId, "";
            /// A number.
            Position => position: f64, "u";
        }
        vendor_outputs {}
    }

    #[test]
    fn fields_stand_where_a_c_compiler_puts_them() {
        let layout = Layout::of_pins(Inputs::PINS, Pointer::NATIVE);
        let offsets: [usize; 8] = core::array::from_fn(|index| layout.offset(index));
        assert_eq!(offsets, [4, 8, 10, 16, 24, 32, 40, 44]);
        assert_eq!(layout.size, 48);
        let layout = Layout::of_pins(Outputs::PINS, Pointer::NATIVE);
        assert_eq!([layout.offset(0), layout.offset(1), layout.offset(2)], [4, 6, 8]);
        assert_eq!(layout.size, 16);
    }

    #[test]
    fn an_array_is_an_address_and_a_count() {
        let pin = |ty| Pin {
            ty,
            ..Inputs::PINS[0]
        };
        let table = PinType::Table(TableInfo {
            name: "T",
            fields: &[],
            most: 3,
        });
        let pins = [pin(PinType::Bool), pin(table), pin(PinType::Bool)];
        let narrow = Layout::of_pins(&pins, Pointer::Bits32);
        assert_eq!([narrow.offset(1), narrow.offset(2), narrow.size], [8, 16, 24]);
        let wide = Layout::of_pins(&pins, Pointer::Bits64);
        assert_eq!([wide.offset(1), wide.offset(2), wide.size], [8, 20, 24]);
        let mut bytes = [0; 24];
        0x1122_3344_u32.write(&mut bytes, 8);
        7_u32.write(&mut bytes, 12);
        9_u32.write(&mut bytes, 16);
        assert_eq!(read_table(&bytes, 8, Pointer::Bits32), (0x1122_3344, 7));
        assert_eq!(read_table(&bytes, 8, Pointer::Bits64), (0x7_1122_3344, 9));
    }

    #[test]
    fn pins_go_through_bytes_and_back() {
        let mut inputs = Inputs::default();
        let values = [
            Value::Axis(AxisId::new(6)),
            Value::Bool(true),
            Value::Int(-3),
            Value::Lreal(-0.1),
            Value::Bool(false),
            Value::Time(-5_000_000_000),
            Value::Enum(77),
            Value::Dword(u32::MAX),
        ];
        for (index, value) in values.into_iter().enumerate() {
            assert_eq!(inputs.set(index, value), Ok::<(), PinError>(()));
        }
        let mut bytes = [0xA5; 48];
        inputs.put_flat(&mut bytes);
        assert_eq!(bytes[..10], [0xA5, 0xA5, 0xA5, 0xA5, 7, 0, 0, 0, 1, 0xA5]);
        let mut back = Inputs::default();
        back.set_flat(&bytes, Pointer::NATIVE);
        for (index, value) in values.into_iter().enumerate() {
            assert_eq!(back.get(index), Some(value), "{index}");
        }

        let outputs = Outputs {
            done: true,
            error_id: ErrorId::AxisUnknown,
            position: 1.25,
        };
        let mut bytes = [0; 16];
        outputs.put_flat(&mut bytes);
        let mut back = Outputs::default();
        back.set_flat(&bytes, Pointer::NATIVE);
        assert_eq!(back, outputs);
    }

    #[test]
    fn an_axis_number_of_no_axis_is_none_and_any_byte_but_0_is_true() {
        for (number, axis) in [
            (0, AxisId::NONE),
            (-1, AxisId::NONE),
            (i32::MIN, AxisId::NONE),
            (65_536, AxisId::NONE),
            (1, AxisId::new(0)),
            (65_535, AxisId::new(65_534)),
        ] {
            let mut bytes = [0; 48];
            i32::write(number, &mut bytes, 4);
            bytes[8] = 0x80;
            let mut inputs = Inputs::default();
            inputs.set_flat(&bytes, Pointer::NATIVE);
            assert_eq!((inputs.axis, inputs.execute), (axis, true), "{number}");
        }
    }

    #[test]
    fn bytes_that_are_missing_are_zero() {
        let mut inputs = Inputs::default();
        inputs.set_flat(&[1; 18], Pointer::NATIVE);
        assert_eq!(
            (inputs.execute, inputs.position, inputs.enable),
            (true, 0.0, false)
        );
        inputs.put_flat(&mut [0; 3]);
    }

    #[test]
    fn a_record_becomes_numbers() {
        let fields: &[Pin] = &Inputs::PINS[1..4];
        let layout = Layout::of_record(fields);
        assert_eq!(
            [layout.offset(0), layout.offset(1), layout.offset(2), layout.size],
            [0, 2, 8, 16]
        );
        let mut bytes = [0; 16];
        bytes[0] = 9;
        (-2_i16).write(&mut bytes, 2);
        1.5_f64.write(&mut bytes, 8);
        let mut cells = [0.0; 3];
        read_record(&bytes, fields, &layout, &mut cells);
        assert_eq!(cells, [1.0, -2.0, 1.5]);
    }
}

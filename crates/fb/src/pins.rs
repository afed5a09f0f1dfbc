//! Pins as data: one table per block, from which structs, docs, script names and traces come.

use crate::flat::{Flat, Pointer};
use crate::{TableInfo, TableRef};
use core::fmt;
use standstill_axis::{AxisId, ErrorId, IecEnum, Raw};

/// The three kinds of pins, in their order in every table and trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// VAR_IN_OUT.
    InOut,
    /// VAR_INPUT.
    Input,
    /// VAR_OUTPUT.
    Output,
}

/// An enumeration as data.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EnumInfo {
    /// IEC name of the type.
    pub name: &'static str,
    /// IEC names and numbers of the elements.
    pub elements: &'static [(&'static str, i32)],
}

impl EnumInfo {
    /// The name of the element `number`; `None` if it is not defined.
    pub fn name_of(&self, number: i32) -> Option<&'static str> {
        self.elements
            .iter()
            .find(|(_, n)| *n == number)
            .map(|(name, _)| *name)
    }

    /// The number of the element `name`, without regard to case.
    pub fn number_of(&self, name: &str) -> Option<i32> {
        self.elements
            .iter()
            .find(|(n, _)| n.eq_ignore_ascii_case(name))
            .map(|(_, number)| *number)
    }
}

/// The type of a pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PinType {
    /// BOOL.
    Bool,
    /// INT, 16 bits.
    Int,
    /// LREAL.
    Lreal,
    /// UINT, 16 bits; its value is that of a WORD.
    Uint,
    /// WORD, shown as a decimal number; ErrorID pins.
    Word,
    /// DWORD, a bit field.
    Dword,
    /// TIME, in nanoseconds.
    Time,
    /// An axis, or a part of an axis's drive: AXIS_REF and the reference types made from it.
    Axis(&'static str),
    /// An enumeration.
    Enum(EnumInfo),
    /// An array of records.
    Table(TableInfo),
}

impl PinType {
    /// The type's name in IEC text.
    pub const fn iec_name(self) -> &'static str {
        match self {
            Self::Bool => "BOOL",
            Self::Int => "INT",
            Self::Lreal => "LREAL",
            Self::Uint => "UINT",
            Self::Word => "WORD",
            Self::Dword => "DWORD",
            Self::Time => "TIME",
            Self::Axis(name) => name,
            Self::Enum(info) => info.name,
            Self::Table(info) => info.name,
        }
    }

    /// The value of this type from a word that [`Value::word`] made.
    pub const fn value(self, word: u64) -> Value {
        match self {
            Self::Bool => Value::Bool(word != 0),
            Self::Int => Value::Int(word as i16),
            Self::Lreal => Value::Lreal(f64::from_bits(word)),
            Self::Uint | Self::Word => Value::Word(word as u16),
            Self::Dword => Value::Dword(word as u32),
            Self::Time => Value::Time(word.cast_signed()),
            Self::Axis(_) => Value::Axis(AxisId::new(word as u16)),
            Self::Enum(_) => Value::Enum(word as i32),
            Self::Table(_) => Value::Table(TableRef {
                first: (word >> 16) as u32,
                records: word as u16,
            }),
        }
    }
}

/// The value at a pin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Value {
    /// BOOL.
    Bool(bool),
    /// INT.
    Int(i16),
    /// LREAL.
    Lreal(f64),
    /// UINT or WORD.
    Word(u16),
    /// DWORD.
    Dword(u32),
    /// TIME in nanoseconds.
    Time(i64),
    /// An axis.
    Axis(AxisId),
    /// An enumeration's number, defined or not.
    Enum(i32),
    /// The place of a table.
    Table(TableRef),
}

impl Value {
    /// The value as a word, without its type. Numbers keep their bits; signed types are sign-extended.
    pub const fn word(self) -> u64 {
        match self {
            Self::Bool(value) => value as u64,
            Self::Int(value) => value as i64 as u64,
            Self::Lreal(value) => value.to_bits(),
            Self::Word(value) => value as u64,
            Self::Dword(value) => value as u64,
            Self::Time(ns) => ns.cast_unsigned(),
            Self::Axis(id) => id.index() as u64,
            Self::Enum(number) => number as i64 as u64,
            Self::Table(table) => (table.first as u64) << 16 | table.records as u64,
        }
    }
}

/// INT as a pin's Rust type.
pub type Int = i16;

/// TIME as a pin's Rust type: nanoseconds.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Time(pub i64);

/// A Rust type that a pin can have.
pub trait PinValue: Copy {
    /// Its IEC type.
    const TYPE: PinType;
    /// Converts to data.
    fn into_value(self) -> Value;
    /// Converts from data; `None` if the type differs.
    fn from_value(value: Value) -> Option<Self>;
    /// The scalar form in bytes, equal to [`PinType::scalar`] of the type.
    type Flat: Flat;
    /// Converts to the scalar form.
    fn into_flat(self) -> Self::Flat;
    /// Converts from the scalar form.
    fn from_flat(flat: Self::Flat) -> Self;
}

macro_rules! pin_value {
    ($rust:ty, $ty:ident, $variant:ident, $flat:ty, $value:ident => $into:expr, $back:ident => $from:expr) => {
        impl PinValue for $rust {
            const TYPE: PinType = PinType::$ty;
            type Flat = $flat;

            #[inline]
            fn into_flat(self) -> $flat {
                let $value = self;
                $into
            }

            #[inline]
            fn from_flat($back: $flat) -> Self {
                $from
            }

            fn into_value(self) -> Value {
                Value::$variant(self)
            }

            fn from_value(value: Value) -> Option<Self> {
                if let Value::$variant(inner) = value {
                    Some(inner)
                } else {
                    None
                }
            }
        }
    };
}

pin_value!(bool, Bool, Bool, u8, value => u8::from(value), flat => flat != 0);
pin_value!(i16, Int, Int, i16, value => value, flat => flat);
pin_value!(u16, Uint, Word, u16, value => value, flat => flat);
pin_value!(u32, Dword, Dword, u32, value => value, flat => flat);
pin_value!(f64, Lreal, Lreal, f64, value => value, flat => flat);

macro_rules! axis_value {
    ($rust:ty, $name:literal, $id:ident => $made:expr) => {
        impl PinValue for $rust {
            const TYPE: PinType = PinType::Axis($name);
            type Flat = i32;

            #[inline]
            fn into_flat(self) -> i32 {
                axis_number(self.into())
            }

            #[inline]
            fn from_flat(flat: i32) -> Self {
                let $id = numbered_axis(flat);
                $made
            }

            fn into_value(self) -> Value {
                Value::Axis(self.into())
            }

            fn from_value(value: Value) -> Option<Self> {
                if let Value::Axis($id) = value {
                    Some($made)
                } else {
                    None
                }
            }
        }
    };
}

/// How hosts in other languages number axes: from 1, and 0 is no axis, so that zeroed memory commands nothing.
pub const fn axis_number(id: AxisId) -> i32 {
    // `AxisId::NONE` gives 0 here too.
    (id.index() as i32 + 1) % 65_536
}

/// The axis of that number; [`AxisId::NONE`] for any number that no axis can have.
pub const fn numbered_axis(number: i32) -> AxisId {
    if 0 < number && number < 65_536 {
        AxisId::new((number - 1) as u16)
    } else {
        AxisId::NONE
    }
}

/// MC_INPUT_REF: the axis whose drive has the inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InputRef(pub AxisId);

/// MC_OUTPUT_REF: the axis whose drive has the outputs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OutputRef(pub AxisId);

impl From<InputRef> for AxisId {
    fn from(input: InputRef) -> Self {
        input.0
    }
}

impl From<OutputRef> for AxisId {
    fn from(output: OutputRef) -> Self {
        output.0
    }
}

axis_value!(AxisId, "AXIS_REF", id => id);
axis_value!(InputRef, "MC_INPUT_REF", id => Self(id));
axis_value!(OutputRef, "MC_OUTPUT_REF", id => Self(id));

impl PinValue for Time {
    const TYPE: PinType = PinType::Time;
    type Flat = i64;

    #[inline]
    fn into_flat(self) -> i64 {
        self.0
    }

    #[inline]
    fn from_flat(flat: i64) -> Self {
        Self(flat)
    }

    fn into_value(self) -> Value {
        Value::Time(self.0)
    }

    fn from_value(value: Value) -> Option<Self> {
        if let Value::Time(ns) = value {
            Some(Self(ns))
        } else {
            None
        }
    }
}

impl PinValue for ErrorId {
    const TYPE: PinType = PinType::Word;
    type Flat = u16;

    #[inline]
    fn into_flat(self) -> u16 {
        self.number()
    }

    fn from_flat(flat: u16) -> Self {
        Self::from_number(flat).unwrap_or_default()
    }

    fn into_value(self) -> Value {
        Value::Word(self.number())
    }

    fn from_value(value: Value) -> Option<Self> {
        if let Value::Word(number) = value {
            Self::from_number(number)
        } else {
            None
        }
    }
}

impl<E: IecEnum> PinValue for Raw<E> {
    const TYPE: PinType = PinType::Enum(EnumInfo {
        name: E::TYPE,
        elements: E::ELEMENTS,
    });
    type Flat = i32;

    #[inline]
    fn into_flat(self) -> i32 {
        self.number()
    }

    #[inline]
    fn from_flat(flat: i32) -> Self {
        Self::new(flat)
    }

    fn into_value(self) -> Value {
        Value::Enum(self.number())
    }

    fn from_value(value: Value) -> Option<Self> {
        if let Value::Enum(number) = value {
            Some(Self::new(number))
        } else {
            None
        }
    }
}

/// One pin of a block.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pin {
    /// IEC name.
    pub name: &'static str,
    /// Name in Rust and C.
    pub field: &'static str,
    /// Type.
    pub ty: PinType,
    /// Unit, empty if none; `u` is the axis's unit.
    pub unit: &'static str,
    /// The pin is not in the standard.
    pub extension: bool,
    /// One sentence.
    pub doc: &'static str,
    /// In_out, input or output.
    pub direction: Direction,
}

/// Why a pin was not written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PinError {
    /// The block has no pin of that index, or it is an output.
    NotWritable,
    /// The value has another type than the pin.
    WrongType,
}

impl fmt::Display for PinError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NotWritable => "no such input pin",
            Self::WrongType => "the value does not have the pin's type",
        })
    }
}

impl core::error::Error for PinError {}

/// A struct of pins whose fields can be reached by index.
pub trait Pins: Copy + Default {
    /// The table, in declaration order.
    const PINS: &'static [Pin];

    /// The value at pin `index`, if there is one.
    fn get(&self, index: usize) -> Option<Value>;

    /// Writes the words ([`Value::word`]) of all pins in declaration order, until `words` is full.
    fn put_words(&self, words: &mut [u64]);

    /// Writes pin `index`.
    ///
    /// # Errors
    /// [`PinError`] if there is no such pin or the type differs.
    fn set(&mut self, index: usize, value: Value) -> Result<(), PinError>;

    /// Reads all pins except arrays from bytes laid out as [`crate::flat`] says. `width` is the width of
    /// addresses on the side the bytes come from. Missing bytes are zero.
    fn set_flat(&mut self, flat: &[u8], pointer: Pointer);

    /// Writes all pins except arrays to bytes for this processor. The size field and the padding are not
    /// written.
    fn put_flat(&self, flat: &mut [u8]);
}

/// Declares the `Inputs` and `Outputs` structs of a block and their tables.
///
/// Sections are in the order of the trace. `vendor_inputs` and `vendor_outputs` are pins the standard
/// does not have. They come after all standard pins of their kind. `..name;` stands for the pins of a group
/// (`pin_groups.rs`).
///
/// ```text
/// pins! {
///     in_outs { /// The axis to move.
///               Axis => axis: AxisId; }
///     inputs { /// A rising edge starts the move.
///              Execute => execute: bool = false, "";
///              ..rates; }
///     vendor_inputs { .. }
///     outputs { /// Target reached.
///               Done => done: bool, "";
///               ..motion; }
///     vendor_outputs { .. }
/// }
/// ```
#[macro_export]
macro_rules! pins {
    (in_outs $in_outs:tt inputs $inputs:tt vendor_inputs $vendor_inputs:tt outputs $outputs:tt vendor_outputs $vendor_outputs:tt) => {
        $crate::pins!(@rows () () $in_outs $inputs $vendor_inputs $outputs $vendor_outputs);
    };
    // Takes row after row of section after section, until all groups are replaced by their rows. The
    // parameters are the finished sections, the finished rows of the present section, its remaining rows, and
    // the sections behind it.
    (@rows $done:tt $rows:tt { ..$group:ident; $($left:tt)* } $($later:tt)*) => {
        $crate::pin_group!($group $done $rows { $($left)* } $($later)*);
    };
    (@rows $done:tt ($($rows:tt)*) { $(#[doc = $doc:literal])+ $pin:ident => $field:ident: $ty:ty; $($left:tt)* } $($later:tt)*) => {
        $crate::pins!(@rows $done ($($rows)* $(#[doc = $doc])+ $pin => $field: $ty;) { $($left)* } $($later)*);
    };
    (@rows $done:tt ($($rows:tt)*) { $(#[doc = $doc:literal])+ $pin:ident => $field:ident: $ty:ty = $default:expr, $unit:literal; $($left:tt)* } $($later:tt)*) => {
        $crate::pins!(@rows $done ($($rows)* $(#[doc = $doc])+ $pin => $field: $ty = $default, $unit;) { $($left)* } $($later)*);
    };
    (@rows $done:tt ($($rows:tt)*) { $(#[doc = $doc:literal])+ $pin:ident => $field:ident: $ty:ty, $unit:literal; $($left:tt)* } $($later:tt)*) => {
        $crate::pins!(@rows $done ($($rows)* $(#[doc = $doc])+ $pin => $field: $ty, $unit;) { $($left)* } $($later)*);
    };
    (@rows ($($done:tt)*) $rows:tt {} $next:tt $($later:tt)*) => {
        $crate::pins!(@rows ($($done)* $rows) () $next $($later)*);
    };
    (@rows ($($done:tt)*) $rows:tt {}) => {
        $crate::pins!(@structs $($done)* $rows);
    };
    (@structs
        ($($(#[doc = $io_doc:literal])+ $io_pin:ident => $io:ident: $io_ty:ty;)*)
        ($($(#[doc = $in_doc:literal])+ $in_pin:ident => $in:ident: $in_ty:ty = $in_default:expr, $in_unit:literal;)*)
        ($($(#[doc = $vi_doc:literal])+ $vi_pin:ident => $vi:ident: $vi_ty:ty = $vi_default:expr, $vi_unit:literal;)*)
        ($($(#[doc = $out_doc:literal])+ $out_pin:ident => $out:ident: $out_ty:ty, $out_unit:literal;)*)
        ($($(#[doc = $vo_doc:literal])+ $vo_pin:ident => $vo:ident: $vo_ty:ty, $vo_unit:literal;)*)
    ) => {
        /// What the caller sets: VAR_IN_OUT and VAR_INPUT.
        #[derive(Clone, Copy, Debug)]
        pub struct Inputs {
            $($(#[doc = $io_doc])+ pub $io: $io_ty,)*
            $($(#[doc = $in_doc])+ pub $in: $in_ty,)*
            $($(#[doc = $vi_doc])+ pub $vi: $vi_ty,)*
        }

        impl Default for Inputs {
            fn default() -> Self {
                Self {
                    $($io: Default::default(),)*
                    $($in: $in_default,)*
                    $($vi: $vi_default,)*
                }
            }
        }

        /// What the block shows: VAR_OUTPUT.
        // Aligned to whole words, so that the outputs of most blocks are copied as one number. A smaller
        // structure would be put together and taken apart again.
        #[derive(Clone, Copy, Debug, Default, PartialEq)]
        #[repr(align(8))]
        pub struct Outputs {
            $($(#[doc = $out_doc])+ pub $out: $out_ty,)*
            $($(#[doc = $vo_doc])+ pub $vo: $vo_ty,)*
        }

        $crate::pins!(@table Inputs {
            $(InOut $io_pin $io $io_ty, "", false, [$($io_doc)+];)*
            $(Input $in_pin $in $in_ty, $in_unit, false, [$($in_doc)+];)*
            $(Input $vi_pin $vi $vi_ty, $vi_unit, true, [$($vi_doc)+];)*
        });
        $crate::pins!(@table Outputs {
            $(Output $out_pin $out $out_ty, $out_unit, false, [$($out_doc)+];)*
            $(Output $vo_pin $vo $vo_ty, $vo_unit, true, [$($vo_doc)+];)*
        });
    };
    (@table $name:ident { $($direction:ident $pin:ident $field:ident $ty:ty, $unit:literal, $extension:literal, [$($doc:literal)+];)* }) => {
        impl $crate::Pins for $name {
            const PINS: &'static [$crate::Pin] = &[$($crate::Pin {
                name: stringify!($pin),
                field: stringify!($field),
                ty: <$ty as $crate::PinValue>::TYPE,
                unit: $unit,
                extension: $extension,
                doc: concat!($($doc),+),
                direction: $crate::Direction::$direction,
            }),*];

            fn get(&self, index: usize) -> Option<$crate::Value> {
                let mut place = 0_usize;
                $(
                    if place == index {
                        return Some(<$ty as $crate::PinValue>::into_value(self.$field));
                    }
                    place += 1;
                )*
                let _ = place;
                None
            }

            #[inline]
            fn put_words(&self, words: &mut [u64]) {
                let all = [$(<$ty as $crate::PinValue>::into_value(self.$field).word()),*];
                for (word, value) in words.iter_mut().zip(all) {
                    *word = value;
                }
            }

            fn set(&mut self, index: usize, value: $crate::Value) -> Result<(), $crate::PinError> {
                let mut place = 0_usize;
                $(
                    if place == index {
                        self.$field = <$ty as $crate::PinValue>::from_value(value)
                            .ok_or($crate::PinError::WrongType)?;
                        return Ok(());
                    }
                    place += 1;
                )*
                let _ = (place, value);
                Err($crate::PinError::NotWritable)
            }

            #[inline]
            fn set_flat(&mut self, flat: &[u8], pointer: $crate::flat::Pointer) {
                use $crate::flat::{Flat as _, Layout, Pointer};
                const { assert!(<$name as $crate::Pins>::PINS.len() <= $crate::flat::PINS_MOST) };
                const NARROW: Layout = Layout::of_pins(<$name as $crate::Pins>::PINS, Pointer::Bits32);
                const WIDE: Layout = Layout::of_pins(<$name as $crate::Pins>::PINS, Pointer::Bits64);
                let layout = match pointer {
                    Pointer::Bits32 => &NARROW,
                    Pointer::Bits64 => &WIDE,
                };
                let mut place = 0_usize;
                $(
                    // Of an array only the records matter. The reader of the records sets the pin.
                    if <$ty as $crate::PinValue>::TYPE.scalar().is_some() {
                        let number = <$ty as $crate::PinValue>::Flat::read(flat, layout.offset(place));
                        self.$field = <$ty as $crate::PinValue>::from_flat(number);
                    }
                    place += 1;
                )*
                let _ = (place, flat, layout);
            }

            #[inline]
            fn put_flat(&self, flat: &mut [u8]) {
                use $crate::flat::{Flat as _, Layout, Pointer};
                const LAYOUT: Layout = Layout::of_pins(<$name as $crate::Pins>::PINS, Pointer::NATIVE);
                let mut place = 0_usize;
                $(
                    <$ty as $crate::PinValue>::into_flat(self.$field).write(flat, LAYOUT.offset(place));
                    place += 1;
                )*
                let _ = (place, flat);
            }
        }
    };
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
                let back = ty.value(there.word());
                assert_eq!(back.word(), there.word());
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
        let word = table.word();
        assert_eq!(((word >> 16) as u32, word as u16), (first, records));
        assert_eq!(Value::Enum(-3).word() as i32, -3);
    }
}

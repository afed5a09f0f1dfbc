//! Tables at pins: arrays of records.
//!
//! A pin of such a type is a reference, as VAR_IN_OUT is: it holds the place of the records among the
//! numbers of the runtime ([`Context::tables`](crate::Context::tables)). So instances stay small however
//! large a table is. Each field of a record is one number there. Blocks read a table as a whole, into
//! memory of a fixed size.

use crate::{Pin, PinType, PinValue, Pins, Value};
use core::marker::PhantomData;

/// The type of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableInfo {
    /// IEC name of the type.
    pub name: &'static str,
    /// Fields of a record. A field that is left out is 0, FALSE, or the number 0 of an enumeration.
    pub fields: &'static [Pin],
    /// The largest number of records.
    pub most: usize,
}

/// The place of a table: its first number, and the number of records from there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TableRef {
    /// Index of its first number.
    pub first: u32,
    /// Number of records.
    pub records: u16,
}

/// A record of a table, declared with [`record!`](crate::record).
pub trait Record: Pins {
    /// IEC name of the array of such records.
    const TYPE: &'static str;
}

/// Up to `N` records that were read from a table.
#[derive(Clone, Copy, Debug)]
pub struct Table<R, const N: usize> {
    rows: [R; N],
    len: usize,
}

impl<R: Record, const N: usize> Table<R, N> {
    /// The records.
    pub fn rows(&self) -> &[R] {
        self.rows.get(..self.len).unwrap_or_default()
    }
}

/// A pin with a table of at most `N` records; empty until it is set.
#[derive(Debug)]
pub struct TableOf<R, const N: usize> {
    place: TableRef,
    of: PhantomData<R>,
}

impl<R, const N: usize> Clone for TableOf<R, N> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<R, const N: usize> Copy for TableOf<R, N> {}

impl<R, const N: usize> Default for TableOf<R, N> {
    fn default() -> Self {
        Self::new(TableRef::default())
    }
}

impl<R, const N: usize> TableOf<R, N> {
    /// The place of the table.
    pub const fn place(&self) -> TableRef {
        self.place
    }

    /// The table at `place`.
    pub const fn new(place: TableRef) -> Self {
        Self {
            place,
            of: PhantomData,
        }
    }
}

impl<R: Record, const N: usize> TableOf<R, N> {
    /// Reads record `index`, counted from 0; `None` if there is no such record.
    ///
    /// A number that does not fit its field becomes the nearest one that does. Cost: a few operations for
    /// each field.
    pub fn row(&self, tables: &[f64], index: usize) -> Option<R> {
        let width = R::PINS.len();
        if index >= usize::from(self.place.records) {
            return None;
        }
        let first = usize::try_from(self.place.first).ok()?;
        let first = first.checked_add(index.checked_mul(width)?)?;
        let cells = tables.get(first..first.checked_add(width)?)?;
        let mut row = R::default();
        for (index, (field, cell)) in R::PINS.iter().zip(cells).enumerate() {
            row.set(index, field.ty.of_cell(*cell)?).ok()?;
        }
        Some(row)
    }

    /// Reads the records; `None` if they lie outside the numbers of the runtime or are more than `N`.
    ///
    /// A number that does not fit its field becomes the nearest one that does. Cost: a few operations for
    /// each field.
    pub fn read(&self, tables: &[f64]) -> Option<Table<R, N>> {
        let width = R::PINS.len();
        let len = usize::from(self.place.records);
        let first = usize::try_from(self.place.first).ok()?;
        let end = first.checked_add(len.checked_mul(width)?)?;
        let cells = tables.get(first..end)?;
        let mut rows = [R::default(); N];
        if len > N {
            return None;
        }
        for (row, cells) in rows.iter_mut().zip(cells.chunks_exact(width.max(1))) {
            for (index, (field, cell)) in R::PINS.iter().zip(cells).enumerate() {
                row.set(index, field.ty.of_cell(*cell)?).ok()?;
            }
        }
        Some(Table { rows, len })
    }
}

impl<R: Record, const N: usize> PinValue for TableOf<R, N> {
    const TYPE: PinType = PinType::Table(TableInfo {
        name: R::TYPE,
        fields: R::PINS,
        most: N,
    });
    type Flat = ();

    fn into_flat(self) {}

    fn from_flat((): ()) -> Self {
        Self::default()
    }

    fn into_value(self) -> Value {
        Value::Table(self.place)
    }

    fn from_value(value: Value) -> Option<Self> {
        if let Value::Table(place) = value {
            Some(Self::new(place))
        } else {
            None
        }
    }
}

impl PinType {
    /// A number of a table as a field of this type; `None` if no record has such fields.
    fn of_cell(self, cell: f64) -> Option<Value> {
        Some(match self {
            Self::Bool => Value::Bool(cell != 0.0),
            // Casts saturate, and NaN becomes 0.
            Self::Int => Value::Int(cell as i16),
            Self::Uint | Self::Word => Value::Word(cell as u16),
            Self::Dword => Value::Dword(cell as u32),
            Self::Time => Value::Time(cell as i64),
            Self::Enum(_) => Value::Enum(cell as i32),
            Self::Lreal => Value::Lreal(cell),
            Self::Axis(_) | Self::Table(_) => return None,
        })
    }
}

impl Value {
    /// The value as a number of a table; TIME is exact up to 104 days. `None` if no record has such fields.
    pub fn to_cell(self) -> Option<f64> {
        Some(match self {
            Self::Bool(value) => f64::from(u8::from(value)),
            Self::Int(value) => value.into(),
            Self::Word(value) => value.into(),
            Self::Dword(value) => value.into(),
            Self::Time(ns) => ns as f64,
            Self::Enum(number) => number.into(),
            Self::Lreal(value) => value,
            Self::Axis(_) | Self::Table(_) => return None,
        })
    }
}

/// Declares the record of a table: a struct with its fields as data.
///
/// ```text
/// record! {
///     /// A point of a profile.
///     pub struct Point = "MC_TP_REF" {
///         /// Time since the point before.
///         DeltaTime => delta_time: Time, "";
///         /// Position there.
///         Position => position: f64, "u";
///     }
/// }
/// ```
#[macro_export]
macro_rules! record {
    (
        $(#[$meta:meta])*
        pub struct $name:ident = $iec:literal {
            $($(#[doc = $doc:literal])+ $pin:ident => $field:ident: $ty:ty, $unit:literal;)*
        }
    ) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, Default)]
        pub struct $name {
            $($(#[doc = $doc])+ pub $field: $ty,)*
        }

        impl $crate::Record for $name {
            const TYPE: &'static str = $iec;
        }

        $crate::pins!(@table $name {
            $(Input $pin $field $ty, $unit, false, [$($doc)+];)*
        });
    };
}

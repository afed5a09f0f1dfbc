//! Tables at pins: arrays of records, of a fixed largest length, owned by the block.
//!
//! A pin of such a type is a variable of the instance: a host writes its rows in Rust, a script through
//! [`AnyTable`]. It carries no [`Value`] but the number of its records, which is what a trace shows (`4 records`).

use crate::{Pin, PinError, PinType, PinValue, Pins, Value};

/// The type of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TableInfo {
    /// IEC name of the type.
    pub name: &'static str,
    /// Fields of a record. What a script leaves out of a record is 0, FALSE, or the first of an enumeration.
    pub fields: &'static [Pin],
    /// Most records.
    pub most: usize,
}

/// A record of a table, declared with [`record!`](crate::record).
pub trait Record: Pins {
    /// IEC name of the array of such records.
    const TYPE: &'static str;
}

/// Up to `N` records.
#[derive(Clone, Copy, Debug)]
pub struct Table<R, const N: usize> {
    rows: [R; N],
    len: usize,
}

impl<R: Record, const N: usize> Default for Table<R, N> {
    fn default() -> Self {
        Self {
            rows: [R::default(); N],
            len: 0,
        }
    }
}

impl<R: Record, const N: usize> Table<R, N> {
    /// The first `N` of `rows`.
    pub fn of(rows: &[R]) -> Self {
        let mut table = Self::default();
        for (slot, row) in table.rows.iter_mut().zip(rows) {
            *slot = *row;
            table.len += 1;
        }
        table
    }

    /// Its records.
    pub fn rows(&self) -> &[R] {
        self.rows.get(..self.len).unwrap_or_default()
    }
}

/// A table whatever its type, for what reads scripts.
pub trait AnyTable {
    /// Appends a record of default values; `false` if the table is full.
    fn push(&mut self) -> bool;

    /// Writes a field of the last record.
    ///
    /// # Errors
    /// [`PinError`] if there is no record or no such field, or its type differs.
    fn set_last(&mut self, field: usize, value: Value) -> Result<(), PinError>;
}

impl<R: Record, const N: usize> AnyTable for Table<R, N> {
    fn push(&mut self) -> bool {
        match self.rows.get_mut(self.len) {
            Some(row) => {
                *row = R::default();
                self.len += 1;
                true
            }
            None => false,
        }
    }

    fn set_last(&mut self, field: usize, value: Value) -> Result<(), PinError> {
        let last = self.len.checked_sub(1).and_then(|last| self.rows.get_mut(last));
        last.ok_or(PinError::NotWritable)?.set(field, value)
    }
}

impl<R: Record, const N: usize> PinValue for Table<R, N> {
    const TYPE: PinType = PinType::Table(TableInfo {
        name: R::TYPE,
        fields: R::PINS,
        most: N,
    });

    fn to_value(&self) -> Value {
        Value::Rows(u16::try_from(self.len).unwrap_or(u16::MAX))
    }

    fn from_value(_: Value) -> Option<Self> {
        None
    }

    fn as_table(&mut self) -> Option<&mut dyn AnyTable> {
        Some(self)
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

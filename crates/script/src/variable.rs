//! A variable of a program in Structured Text, in the forms of signals, columns and steps.

use standstill_fb::{PinType, Value};
use standstill_guest::SymbolType;
use standstill_st::{self as st, Elementary};
use standstill_trace::Cell;

/// The properties of a variable besides its name and place.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variable {
    ty: Elementary,
    type_name: String,
    meaning: st::Value,
    settable: bool,
}

impl Variable {
    pub(crate) fn new(symbol: &st::Symbol) -> Self {
        Self {
            ty: symbol.ty,
            type_name: symbol.type_name.clone(),
            meaning: symbol.value.clone(),
            settable: symbol.is_settable(),
        }
    }

    /// Its elementary type.
    #[must_use]
    pub const fn elementary(&self) -> Elementary {
        self.ty
    }

    /// Whether steps may set it: an input, a global variable that is no CONSTANT, or one AT an address.
    #[must_use]
    pub const fn is_settable(&self) -> bool {
        self.settable
    }

    /// The name of its type: for an enumeration its name, otherwise that of the elementary type.
    #[must_use]
    pub fn type_name(&self) -> &str {
        match self.meaning {
            st::Value::Element(_) => &self.type_name,
            st::Value::Plain | st::Value::Range(..) => self.ty.name(),
        }
    }

    /// Names and numbers of the elements of an enumeration.
    #[must_use]
    pub fn elements(&self) -> Option<&[(String, i128)]> {
        match &self.meaning {
            st::Value::Element(elements) => Some(elements),
            st::Value::Plain | st::Value::Range(..) => None,
        }
    }

    /// The form in which its bytes are read. Numbers of 64 bits are read as a TIME, which has 64 bits, too.
    pub(crate) const fn read_as(&self) -> SymbolType {
        match self.ty {
            Elementary::Bool => SymbolType::Bool,
            Elementary::Sint => SymbolType::Sint,
            Elementary::Usint => SymbolType::Usint,
            Elementary::Int => SymbolType::Int,
            Elementary::Uint => SymbolType::Uint,
            Elementary::Dint => SymbolType::Dint,
            Elementary::Udint => SymbolType::Udint,
            Elementary::Byte => SymbolType::Byte,
            Elementary::Word => SymbolType::Word,
            Elementary::Dword => SymbolType::Dword,
            Elementary::Real => SymbolType::Real,
            Elementary::Lreal => SymbolType::Lreal,
            Elementary::Lint
            | Elementary::Ulint
            | Elementary::Lword
            | Elementary::Time
            | Elementary::Ltime => SymbolType::Time,
        }
    }

    /// Whether it is a 64-bit whole number other than a time; no pin has that type.
    #[must_use]
    pub const fn is_wide(&self) -> bool {
        matches!(self.ty, Elementary::Lint | Elementary::Ulint | Elementary::Lword)
    }

    /// The type by which wires read it.
    pub(crate) const fn signal(&self) -> PinType {
        match self.read_as() {
            SymbolType::Time if self.is_wide() => PinType::Lreal,
            other => other.signal(),
        }
    }

    /// The whole number of this variable for `value`; `None` if it has none.
    pub(crate) fn whole(&self, value: Value) -> Option<i128> {
        Some(match value {
            Value::Bool(value) => value.into(),
            Value::Int(value) => value.into(),
            Value::Word(value) => value.into(),
            Value::Dword(value) => value.into(),
            Value::Time(bits) if matches!(self.ty, Elementary::Ulint | Elementary::Lword) => {
                bits.cast_unsigned().into()
            }
            Value::Time(value) => value.into(),
            // Every DINT is exact there.
            Value::Lreal(value) if self.ty == Elementary::Dint => i128::from(value as i64),
            _ => return None,
        })
    }

    /// The value for a whole number of this variable, which must be in its range.
    pub(crate) fn of_whole(&self, number: i128) -> Value {
        match self.read_as() {
            SymbolType::Bool => Value::Bool(number != 0),
            SymbolType::Sint | SymbolType::Int => Value::Int(number as i16),
            SymbolType::Usint | SymbolType::Uint | SymbolType::Byte | SymbolType::Word => {
                Value::Word(number as u16)
            }
            SymbolType::Udint | SymbolType::Dword => Value::Dword(number as u32),
            SymbolType::Dint | SymbolType::Real | SymbolType::Lreal => Value::Lreal(number as f64),
            // The low bits, for any sign.
            SymbolType::Time => Value::Time(number as i64),
        }
    }

    /// The least and the greatest whole number it may have; `None` for other types.
    pub(crate) fn range(&self) -> Option<(i128, i128)> {
        if let st::Value::Range(low, high) = self.meaning {
            return Some((low, high));
        }
        let bits = self.ty.size() * 8;
        Some(match self.ty {
            Elementary::Sint | Elementary::Int | Elementary::Dint | Elementary::Lint => {
                (-(1 << (bits - 1)), (1 << (bits - 1)) - 1)
            }
            Elementary::Usint
            | Elementary::Uint
            | Elementary::Udint
            | Elementary::Ulint
            | Elementary::Byte
            | Elementary::Word
            | Elementary::Dword
            | Elementary::Lword => (0, (1 << bits) - 1),
            Elementary::Bool
            | Elementary::Real
            | Elementary::Lreal
            | Elementary::Time
            | Elementary::Ltime => return None,
        })
    }

    /// The value of the variable as a cell; `None` if it is a number without a name in its enumeration.
    pub(crate) fn cell(&self, value: Value) -> Option<Cell<'_>> {
        if let Some(elements) = self.elements() {
            let whole = self.whole(value)?;
            let named = elements.iter().find(|(_, known)| *known == whole);
            return named.map(|(name, _)| Cell::Name(name));
        }
        Some(match value {
            Value::Bool(value) => Cell::Bool(value),
            Value::Lreal(value) if self.ty != Elementary::Dint => Cell::Real(value),
            // 64 bits are stored unchanged: the reader knows the type.
            Value::Time(value) => Cell::Integer(value),
            other => Cell::Integer(self.whole(other)? as i64),
        })
    }

    /// The number without a name in its enumeration, in the form of its cell.
    pub(crate) fn unnamed(&self, value: Value) -> Option<String> {
        if self.elements().is_none() || self.cell(value).is_some() {
            return None;
        }
        Some(self.whole(value).unwrap_or_default().to_string())
    }

    /// The whole number in a cell of its column.
    pub(crate) fn whole_in(&self, cell: Cell<'_>) -> Option<i128> {
        match cell {
            Cell::Integer(number) if matches!(self.ty, Elementary::Ulint | Elementary::Lword) => {
                Some(number.cast_unsigned().into())
            }
            Cell::Integer(number) => Some(number.into()),
            Cell::Bool(_) | Cell::Real(_) | Cell::Name(_) => None,
        }
    }

    /// A value of a whole number or an enumeration given as text, and as JSON; `None` if the variable has others.
    pub(crate) fn parse(&self, text: &str) -> Option<Result<(Value, String), String>> {
        if let Some(elements) = self.elements() {
            let known = elements
                .iter()
                .find(|(name, number)| name.eq_ignore_ascii_case(text) || number.to_string() == text);
            return Some(match known {
                Some((name, number)) => Ok((self.of_whole(*number), format!("\"{name}\""))),
                None => Err(format!("`{text}` is no element of {}", self.type_name())),
            });
        }
        let (low, high) = self.range()?;
        let number = text
            .parse()
            .ok()
            .filter(|number: &i128| (low..=high).contains(number));
        Some(match number {
            Some(number) if self.is_wide() => Ok((self.of_whole(number), format!("\"{number}\""))),
            Some(number) => Ok((self.of_whole(number), number.to_string())),
            None => Err(format!("`{text}` is no whole number from {low} to {high}")),
        })
    }

    /// The same value as text: an element by its name, a number unchanged.
    pub(crate) fn text(&self, value: Value) -> String {
        if self.is_wide() {
            return self.whole(value).unwrap_or_default().to_string();
        }
        let named = self.cell(value).map(standstill_trace::cell_text);
        named.or_else(|| self.unnamed(value)).unwrap_or_default()
    }
}

//! Variables of a guest by address.

use standstill_fb::flat::{Flat, Scalar};
use standstill_fb::{PinType, Value};

/// A variable in the memory of a guest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Symbol {
    /// What stands there; BOOL, INT, WORD, DWORD, LREAL or TIME.
    pub ty: PinType,
    /// Where.
    pub address: u32,
}

/// Why a variable cannot be reached.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SymbolError {
    /// No address was given and the guest exports none of this name.
    #[error(
        "the guest exports no variable `{0}`: export it, which makes it a constant of type i32 that holds its address, \
         or give its `address`"
    )]
    Unknown(String),
    /// It lies outside.
    #[error("{bytes} bytes at address {address} do not lie in the guest's memory of {memory} bytes")]
    Outside {
        /// The address.
        address: u32,
        /// Its bytes.
        bytes: usize,
        /// Bytes of the memory.
        memory: usize,
    },
}

/// The type of this name that a variable of a guest may have.
#[must_use]
pub fn symbol_type(name: &str) -> Option<PinType> {
    [
        PinType::Bool,
        PinType::Int,
        PinType::Word,
        PinType::Dword,
        PinType::Lreal,
        PinType::Time,
    ]
    .into_iter()
    .find(|ty| ty.iec_name() == name)
}

impl Symbol {
    fn place<'m>(&self, memory: &'m [u8]) -> Result<&'m [u8], SymbolError> {
        let bytes = self.ty.scalar().map_or(0, Scalar::size);
        let outside = SymbolError::Outside {
            address: self.address,
            bytes,
            memory: memory.len(),
        };
        let rest = memory.get(self.address as usize..).ok_or(outside.clone())?;
        rest.get(..bytes).ok_or(outside)
    }

    /// What stands there.
    pub(crate) fn read(&self, memory: &[u8]) -> Result<Value, SymbolError> {
        let flat = self.place(memory)?;
        Ok(match self.ty {
            PinType::Bool => Value::Bool(u8::read(flat, 0) != 0),
            PinType::Int => Value::Int(i16::read(flat, 0)),
            PinType::Word => Value::Word(u16::read(flat, 0)),
            PinType::Dword => Value::Dword(u32::read(flat, 0)),
            PinType::Time => Value::Time(i64::read(flat, 0)),
            _ => Value::Lreal(f64::read(flat, 0)),
        })
    }

    /// Puts a value there, which must be of its type.
    pub(crate) fn write(&self, memory: &mut [u8], value: Value) -> Result<(), SymbolError> {
        self.place(memory)?;
        let at = self.address as usize;
        match value {
            Value::Bool(value) => u8::from(value).write(memory, at),
            Value::Int(value) => value.write(memory, at),
            Value::Word(value) => value.write(memory, at),
            Value::Dword(value) => value.write(memory, at),
            Value::Time(value) => value.write(memory, at),
            Value::Lreal(value) => value.write(memory, at),
            Value::Axis(_) | Value::Enum(_) | Value::Table(_) => {}
        }
        Ok(())
    }
}

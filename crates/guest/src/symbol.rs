//! Variables of a guest by address.

#[cfg(feature = "engine")]
use standstill_fb::flat::Flat;
use standstill_fb::{PinType, Value};

/// The type of a guest's variable.
///
/// Signals have fewer types than compilers. A variable of a type that no signal has is seen as the next
/// type that holds all of its values: SINT as INT, UINT, USINT and BYTE as WORD, UDINT as DWORD, DINT and
/// REAL as LREAL.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum SymbolType {
    Bool,
    Sint,
    Int,
    Dint,
    Usint,
    Uint,
    Udint,
    Byte,
    Word,
    Dword,
    Real,
    Lreal,
    Time,
}

impl SymbolType {
    /// All of them.
    pub const ALL: [Self; 13] = [
        Self::Bool,
        Self::Sint,
        Self::Int,
        Self::Dint,
        Self::Usint,
        Self::Uint,
        Self::Udint,
        Self::Byte,
        Self::Word,
        Self::Dword,
        Self::Real,
        Self::Lreal,
        Self::Time,
    ];

    /// Its name in IEC text.
    #[must_use]
    pub const fn iec_name(self) -> &'static str {
        match self {
            Self::Bool => "BOOL",
            Self::Sint => "SINT",
            Self::Int => "INT",
            Self::Dint => "DINT",
            Self::Usint => "USINT",
            Self::Uint => "UINT",
            Self::Udint => "UDINT",
            Self::Byte => "BYTE",
            Self::Word => "WORD",
            Self::Dword => "DWORD",
            Self::Real => "REAL",
            Self::Lreal => "LREAL",
            Self::Time => "TIME",
        }
    }

    /// The type of this name.
    #[must_use]
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|ty| ty.iec_name() == name)
    }

    /// The type of its signal.
    #[must_use]
    pub const fn signal(self) -> PinType {
        match self {
            Self::Bool => PinType::Bool,
            Self::Sint | Self::Int => PinType::Int,
            Self::Usint | Self::Byte | Self::Uint | Self::Word => PinType::Word,
            Self::Udint | Self::Dword => PinType::Dword,
            Self::Dint | Self::Real | Self::Lreal => PinType::Lreal,
            Self::Time => PinType::Time,
        }
    }

    /// Its range of whole numbers, if its signal has a larger one.
    #[must_use]
    pub const fn narrow(self) -> Option<(i32, i32)> {
        match self {
            Self::Sint => Some((-128, 127)),
            Self::Usint | Self::Byte => Some((0, 255)),
            Self::Dint => Some((i32::MIN, i32::MAX)),
            _ => None,
        }
    }

    /// Whether a variable can have a value of the type of its signal. REAL takes every number, rounded.
    #[must_use]
    pub fn holds(self, value: Value) -> bool {
        let Some((least, most)) = self.narrow() else {
            return true;
        };
        match value {
            Value::Int(value) => (least..=most).contains(&value.into()),
            Value::Word(value) => (least..=most).contains(&value.into()),
            Value::Lreal(value) => {
                value.fract() == 0.0 && value >= f64::from(least) && value <= f64::from(most)
            }
            _ => false,
        }
    }

    /// Its bytes.
    #[cfg(feature = "engine")]
    const fn size(self) -> usize {
        match self {
            Self::Bool | Self::Sint | Self::Usint | Self::Byte => 1,
            Self::Int | Self::Uint | Self::Word => 2,
            Self::Dint | Self::Udint | Self::Dword | Self::Real => 4,
            Self::Lreal | Self::Time => 8,
        }
    }
}

/// A variable in the memory of a guest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// Its type.
    pub ty: SymbolType,
    /// Its address.
    pub address: u32,
}

/// The reason why a variable cannot be accessed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SymbolError {
    /// No address was given and the guest exports none of this name.
    #[error(
        "the guest exports no variable `{0}`: export it, which makes it a constant of type i32 that holds its address, \
         or give its `address`"
    )]
    Unknown(String),
    /// It is outside the memory.
    #[error("{bytes} bytes at address {address} do not lie in the guest's memory of {memory} bytes")]
    Outside {
        /// The address.
        address: u32,
        /// Its bytes.
        bytes: usize,
        /// Bytes of the memory.
        memory: usize,
    },
    /// The value is of another type than the signal of the variable.
    #[error("a variable of type {0} was given a value of another type")]
    Type(&'static str),
}

#[cfg(feature = "engine")]
impl Symbol {
    fn place<'m>(&self, memory: &'m [u8]) -> Result<&'m [u8], SymbolError> {
        let bytes = self.ty.size();
        let outside = SymbolError::Outside {
            address: self.address,
            bytes,
            memory: memory.len(),
        };
        let rest = memory.get(self.address as usize..).ok_or(outside.clone())?;
        rest.get(..bytes).ok_or(outside)
    }

    /// The value at the address.
    pub(crate) fn read(&self, memory: &[u8]) -> Result<Value, SymbolError> {
        let flat = self.place(memory)?;
        Ok(match self.ty {
            SymbolType::Bool => Value::Bool(u8::read(flat, 0) != 0),
            SymbolType::Sint => Value::Int(u8::read(flat, 0).cast_signed().into()),
            SymbolType::Int => Value::Int(i16::read(flat, 0)),
            SymbolType::Usint | SymbolType::Byte => Value::Word(u8::read(flat, 0).into()),
            SymbolType::Uint | SymbolType::Word => Value::Word(u16::read(flat, 0)),
            SymbolType::Udint | SymbolType::Dword => Value::Dword(u32::read(flat, 0)),
            SymbolType::Dint => Value::Lreal(i32::read(flat, 0).into()),
            SymbolType::Real => Value::Lreal(f32::from_bits(u32::read(flat, 0)).into()),
            SymbolType::Lreal => Value::Lreal(f64::read(flat, 0)),
            SymbolType::Time => Value::Time(i64::read(flat, 0)),
        })
    }

    /// Writes a value of the type of its signal. A value that it cannot have becomes the nearest one.
    pub(crate) fn write(&self, memory: &mut [u8], value: Value) -> Result<(), SymbolError> {
        self.place(memory)?;
        let at = self.address as usize;
        // Casts from floating-point numbers saturate; whole numbers are limited to the range first.
        match (self.ty, value) {
            (SymbolType::Bool, Value::Bool(value)) => u8::from(value).write(memory, at),
            (SymbolType::Sint, Value::Int(value)) => {
                (value.clamp(-128, 127) as i8).cast_unsigned().write(memory, at);
            }
            (SymbolType::Int, Value::Int(value)) => value.write(memory, at),
            (SymbolType::Usint | SymbolType::Byte, Value::Word(value)) => {
                (value.min(255) as u8).write(memory, at);
            }
            (SymbolType::Uint | SymbolType::Word, Value::Word(value)) => value.write(memory, at),
            (SymbolType::Udint | SymbolType::Dword, Value::Dword(value)) => value.write(memory, at),
            (SymbolType::Dint, Value::Lreal(value)) => (value as i32).write(memory, at),
            (SymbolType::Real, Value::Lreal(value)) => (value as f32).to_bits().write(memory, at),
            (SymbolType::Lreal, Value::Lreal(value)) => value.write(memory, at),
            (SymbolType::Time, Value::Time(value)) => value.write(memory, at),
            _ => return Err(SymbolError::Type(self.ty.iec_name())),
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_type_goes_through_memory_and_back() {
        for (ty, values) in [
            (SymbolType::Bool, &[Value::Bool(true), Value::Bool(false)][..]),
            (SymbolType::Sint, &[Value::Int(-128), Value::Int(127)]),
            (SymbolType::Int, &[Value::Int(i16::MIN)]),
            (
                SymbolType::Dint,
                &[Value::Lreal(-2_147_483_648.0), Value::Lreal(7.0)],
            ),
            (SymbolType::Usint, &[Value::Word(255)]),
            (SymbolType::Uint, &[Value::Word(65_535)]),
            (SymbolType::Udint, &[Value::Dword(u32::MAX)]),
            (SymbolType::Byte, &[Value::Word(200)]),
            (SymbolType::Word, &[Value::Word(40_000)]),
            (SymbolType::Dword, &[Value::Dword(u32::MAX)]),
            (SymbolType::Real, &[Value::Lreal(0.5), Value::Lreal(-0.0)]),
            (SymbolType::Lreal, &[Value::Lreal(0.1)]),
            (SymbolType::Time, &[Value::Time(-5)]),
        ] {
            assert_eq!(SymbolType::find(ty.iec_name()), Some(ty));
            for value in values {
                let mut memory = [0xA5; 12];
                let symbol = Symbol { ty, address: 3 };
                assert!(ty.holds(*value), "{ty:?}");
                assert_eq!(symbol.write(&mut memory, *value), Ok(()));
                assert_eq!(symbol.read(&memory), Ok(*value), "{ty:?}");
                assert_eq!(memory[..3], [0xA5; 3]);
                assert!(memory[3 + ty.size()..].iter().all(|byte| *byte == 0xA5), "{ty:?}");
            }
        }
        assert_eq!(SymbolType::find("STRING"), None);
    }

    #[test]
    fn what_a_variable_cannot_hold_is_known_and_becomes_the_nearest() {
        for (ty, value, nearest) in [
            (SymbolType::Sint, Value::Int(128), Value::Int(127)),
            (SymbolType::Byte, Value::Word(256), Value::Word(255)),
            (SymbolType::Dint, Value::Lreal(1.5), Value::Lreal(1.0)),
            (SymbolType::Dint, Value::Lreal(3e9), Value::Lreal(2_147_483_647.0)),
            (SymbolType::Dint, Value::Lreal(f64::NAN), Value::Lreal(0.0)),
        ] {
            let mut memory = [0; 8];
            let symbol = Symbol { ty, address: 0 };
            assert!(!ty.holds(value), "{value:?}");
            assert_eq!(symbol.write(&mut memory, value), Ok(()));
            assert_eq!(symbol.read(&memory), Ok(nearest), "{value:?}");
        }
        let symbol = Symbol {
            ty: SymbolType::Dint,
            address: 5,
        };
        assert_eq!(
            symbol.write(&mut [0; 12], Value::Int(1)),
            Err(SymbolError::Type("DINT"))
        );
        assert!(matches!(
            symbol.read(&[0; 8]),
            Err(SymbolError::Outside { bytes: 4, .. })
        ));
    }
}

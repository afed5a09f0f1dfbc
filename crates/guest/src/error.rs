//! The reasons why a module is no guest, and the faults of guests.

use std::fmt;

/// The reason why a module cannot be used as a guest.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum LoadError {
    /// There is no interpreter in this build.
    #[error(
        "this build has no interpreter for programs and expressions: the feature `engine` of standstill-guest is off"
    )]
    NotBuilt,
    /// WebAssembly as text, which this build does not read.
    #[error(
        "it is WebAssembly as text, and this build of standstill reads modules in their binary form only: translate it with \
         `wat2wasm`, or build standstill with the feature `wat`"
    )]
    Text,
    /// Too many bytes.
    #[error("it has {bytes} bytes, more than the {most} of a guest")]
    Large {
        /// Its bytes.
        bytes: usize,
        /// The permitted number.
        most: usize,
    },
    /// Not a module, or one with features or sizes that are not permitted.
    #[error("it is no module of WebAssembly that can be used here: {0}")]
    Module(String),
    /// An import that the host does not have.
    #[error("it imports `{module}` `{name}`, which does not exist here{hint}")]
    Import {
        /// Module of the import.
        module: String,
        /// Its name.
        name: String,
        /// The probable meaning, from the first character on.
        hint: String,
    },
    /// An import or export of another type than that in the list of imports.
    #[error("its `{name}` has another type than it must have: {wanted}")]
    Type {
        /// Its name.
        name: String,
        /// The required type.
        wanted: &'static str,
    },
    /// An export that every guest has is missing.
    #[error("it has no export `{name}`: {wanted}")]
    Export {
        /// Its name.
        name: &'static str,
        /// The required type.
        wanted: &'static str,
    },
    /// Its memory begins larger than its limit.
    #[error(
        "its memory begins with {bytes} bytes, more than the {most} permitted: raise the limit of memory, or build \
         it with less"
    )]
    Memory {
        /// Its initial size.
        bytes: u64,
        /// The permitted number.
        most: u64,
    },
    /// Its `_initialize` or `plc_init` failed.
    #[error("its `{name}` failed: {fault}")]
    Init {
        /// The function.
        name: &'static str,
        /// The fault.
        fault: Fault,
    },
}

/// A fault of a guest in a call. It does not run again.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fault {
    /// It did not end within its budget of instructions.
    Fuel {
        /// The budget.
        most: u64,
    },
    /// An instruction that cannot be executed; the name is that of the standard.
    Trap(&'static str),
    /// A block or `log` received an address that is not in the memory of the guest.
    Pointer {
        /// The function.
        function: &'static str,
        /// The argument.
        what: &'static str,
        /// The address.
        address: u32,
        /// Number of bytes that must be there.
        bytes: u64,
        /// Bytes of the memory.
        memory: u64,
    },
    /// The interpreter refused to continue.
    Other(String),
    /// It had a fault before.
    Over,
}

impl Fault {
    /// The kind of fault, as the reason for which a resource stops.
    #[must_use]
    pub const fn reason(&self) -> &'static str {
        match self {
            Self::Fuel { .. } => "the guest used up its fuel",
            Self::Trap(_) => "the guest trapped",
            Self::Pointer { .. } => "the guest gave an address outside its memory",
            Self::Other(_) => "the guest could not go on",
            Self::Over => "the guest had a fault before",
        }
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Fuel { most } => write!(
                f,
                "it used up its fuel of {most} in one call: an endless loop, or a limit of `fuel` that is too low"
            ),
            Self::Trap(name) => write!(f, "it trapped: {name}"),
            Self::Pointer {
                function,
                what,
                address,
                bytes,
                memory,
            } => write!(
                f,
                "{function}: {bytes} bytes of `{what}` at address {address} do not lie in its memory of {memory} bytes"
            ),
            Self::Other(why) => write!(f, "it could not go on: {why}"),
            Self::Over => f.write_str("it had a fault before and is not called again"),
        }
    }
}

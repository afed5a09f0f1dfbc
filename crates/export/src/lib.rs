//! Declarations of the blocks for hosts in other languages, written from the table of blocks.
//!
//! Each module writes one language. It uses only the registry and [`flat`](standstill_fb::flat), so pins,
//! layouts and defaults are those of the library. No files of other systems are copied: the shims are our
//! own text, for compilers the user has.
#![forbid(unsafe_code)]

mod c;
mod dialect;
mod guest;
mod matiec;
mod names;
mod plcopen;
mod rusty;
mod st;
mod strucpp;
mod write;

pub use dialect::{Dialect, UnknownDialect};
pub use names::{BadPrefix, Prefix};
pub use write::{WriteError, write};

/// The targets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// Hosts in C and C++: headers.
    C,
    /// matiec, the compiler of Beremiz.
    StMatiec,
    /// STruC++, the compiler of OpenPLC.
    StStrucpp,
    /// rusty, the compiler of PLC-lang.
    StRusty,
    /// Guests in WebAssembly.
    Wasm,
    /// IDEs that read PLCopen XML.
    PlcopenXml,
}

impl Target {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::C,
        Self::StMatiec,
        Self::StStrucpp,
        Self::StRusty,
        Self::Wasm,
        Self::PlcopenXml,
    ];

    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::C => "c",
            Self::StMatiec => "st-matiec",
            Self::StStrucpp => "st-strucpp",
            Self::StRusty => "st-rusty",
            Self::Wasm => "wasm",
            Self::PlcopenXml => "plcopen-xml",
        }
    }
}

/// A file to be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// Its name, without a folder.
    pub name: String,
    /// Its contents; lines end in LF.
    pub text: String,
}

impl File {
    /// A file whose name begins with the prefix, of a text with the default one.
    fn new(prefix: &Prefix, rest: &str, text: &str) -> Self {
        Self {
            name: format!("{}{rest}", prefix.lower()),
            text: prefix.applied(text),
        }
    }
}

/// All files of `target`. C names begin with `prefix`. `dialect` gives the pins and numbers of shims in
/// Structured Text and of the XML library.
pub fn export(target: Target, prefix: &Prefix, dialect: &Dialect) -> Vec<File> {
    let headers = || c::files(prefix);
    // A program in Structured Text may also become a guest, which needs only the header.
    let guest_header = || guest::files(prefix).into_iter().take(1).collect();
    match target {
        Target::C => headers(),
        Target::StMatiec => [headers(), guest_header(), matiec::files(prefix, dialect)].concat(),
        Target::StStrucpp => [headers(), guest_header(), strucpp::files(prefix, dialect)].concat(),
        Target::StRusty => [headers(), rusty::files(prefix, dialect)].concat(),
        Target::Wasm => guest::files(prefix),
        Target::PlcopenXml => plcopen::files(prefix, dialect),
    }
}

//! Structured Text of IEC 61131-3: checked, with places in every message, and compiled to a guest.
//!
//! [`compile`] takes the files of a project. It returns a WebAssembly module, which `standstill-guest` and hosts in
//! other languages run, and a table of [`Symbols`]: the place of every variable, and the place in the text for
//! every fault. [`check`] only reports mistakes. Function blocks are those of the table of blocks; a new block
//! needs no code here.
//!
//! Text becomes tokens (`lex`), a tree (`parse`), a checked program (`check`) and a module (`emit`). The
//! crate has no files, no clock, no interpreter and no machine code.
#![forbid(unsafe_code)]

mod check;
mod coverage;
mod dialect;
pub mod editor;
mod emit;
mod error;
mod format;
mod formula;
mod layout;
mod lex;
mod library;
mod lint;
mod parse;
mod source;
mod start;
mod symbols;
mod syntax;
mod typed;
mod types;

pub use coverage::Counter;
pub use dialect::Dialect;
pub use emit::FaultKind;
pub use error::{Code, Diagnostic, Report, Severity, without_joiners};
pub use format::format;
pub use formula::{Reference, references};
pub use layout::{FAULT_SITE, FAULT_VALUE, LOOP_SITE};
pub use source::{Position, SOURCES_MOST, Source, Sources, Span};
pub use symbols::{BlockAt, Place, Section, Symbol, Symbols, Task, Value, Writer};
pub use types::Elementary;

use crate::error::Found;

/// The options of the compiler.
#[derive(Clone, Debug, Default)]
pub struct Options {
    /// The PROGRAM to run in every scan. Without it a CONFIGURATION decides, or the only PROGRAM runs.
    pub program: Option<String>,
    /// Whether it is a library: there need not be a PROGRAM.
    pub library: bool,
    /// Whether to search for lints, which are warnings.
    pub lint: bool,
    /// Whether the module counts how often each statement and branch is executed.
    pub coverage: bool,
    /// Names of types, elements and pins of the library in addition to their own, and other numbers of
    /// enumerations.
    pub dialect: Dialect,
    /// Names of axes; the first one is number 1. A variable of type AXIS_REF with such a name starts as that axis.
    pub axes: Vec<String>,
    /// The axes as which variables of type AXIS_REF start: the path of the variable, and the number of the axis.
    pub bindings: Vec<(String, u16)>,
}

/// A compiled program.
#[derive(Clone, Debug)]
pub struct Compiled {
    /// The module.
    pub wasm: Vec<u8>,
    /// Its variables and places.
    pub symbols: Symbols,
    /// Its warnings.
    pub report: Report,
}

/// The faults and warnings of the sources. Cost: linear in their bytes.
#[must_use]
pub fn check(sources: &[Source<'_>], options: &Options) -> Report {
    match build(sources, options, false) {
        Ok((_, report)) | Err(report) => report,
    }
}

/// Compiles the files of a project. Cost: linear in their bytes.
///
/// # Errors
/// The [`Report`] with the faults.
pub fn compile(sources: &[Source<'_>], options: &Options) -> Result<Compiled, Box<Report>> {
    match build(sources, options, true) {
        Ok((Some((wasm, symbols)), report)) => Ok(Compiled {
            wasm,
            symbols,
            report,
        }),
        Ok((None, report)) | Err(report) => Err(Box::new(report)),
    }
}

/// The files of a project, and the library's own text as the last one.
fn project(given: &[Source<'_>], found: &mut Found) -> Sources {
    let prelude = library::prelude(given);
    let mut files = given.to_vec();
    files.push(Source {
        name: "library",
        bytes: prelude.as_bytes(),
    });
    Sources::new(&files, found)
}

type Built = (Option<(Vec<u8>, Symbols)>, Report);

fn build(given: &[Source<'_>], options: &Options, module: bool) -> Result<Built, Report> {
    let mut found = Found::default();
    let sources = project(given, &mut found);
    if found.has_errors() {
        return Err(found.report(sources));
    }
    let items = parse::parse(&sources, &mut found);
    found.all_read();
    let (program, mut found) = check::check(&sources, &items, options, found);
    let Some(mut program) = program else {
        return Err(found.report(sources));
    };
    if options.lint {
        lint::lint(&program, &sources, &mut found);
    }
    if !module || program.instances.is_empty() {
        return Ok((None, found.report(sources)));
    }
    let counters = if options.coverage {
        coverage::Counters::new(&mut program, &sources)
    } else {
        coverage::Counters::default()
    };
    let mut image = vec![0; program.layout.end as usize];
    symbols::image(&program, &mut image);
    if let Err(wrong) = symbols::bind(&program, options, &mut image) {
        found.add(wrong);
        return Err(found.report(sources));
    }
    if !options.axes.is_empty() {
        lint::without_axis(&program, &image, &sources, &mut found);
    }
    match emit::emit(&program, &image, &counters, &sources) {
        Ok(emitted) => {
            let symbols = Symbols::new(program, emitted.sites, counters.list(&sources), &sources);
            Ok((Some((emitted.wasm, symbols)), found.report(sources)))
        }
        Err(wrong) => {
            found.add(wrong);
            Err(found.report(sources))
        }
    }
}

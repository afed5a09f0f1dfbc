//! What an editor asks of a project: whose name stands at a place, where it is declared, and what may be written there.
//!
//! Nothing is kept between two questions: the project is read and checked anew, which is linear in its bytes.

use crate::Options;
use crate::check::{self, Look};
use crate::error::Found;
use crate::source::{Source, Sources, Span};

/// What is known of a name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Hover {
    /// The name.
    pub span: Span,
    /// Its declaration, in Structured Text.
    pub text: String,
    /// What is said of it: by the table of blocks, or by the comment at its declaration.
    pub doc: String,
    /// Where it is declared; `None` if that is the library.
    pub declared: Option<Span>,
}

/// What a completion is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[non_exhaustive]
pub enum CompletionKind {
    /// An input or output of a block.
    Pin,
    /// A variable, or a member of a structure.
    Variable,
    /// An element of an enumeration.
    Element,
    /// A function or a method.
    Function,
    /// A function block.
    Block,
    /// Any other type.
    Type,
    /// A reserved word.
    Keyword,
}

/// A name that may be written.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Completion {
    /// The name.
    pub name: String,
    /// What is written for it: a pin of a call goes with its sign, `Execute := `.
    pub insert: String,
    /// What it is.
    pub kind: CompletionKind,
    /// Its type, in a word or two.
    pub detail: String,
    /// What is said of it, possibly nothing.
    pub doc: String,
}

/// What stands at byte `byte` of file `file` of `sources`, if it is a name that is known; the table of files beside it says
/// where its spans are. A name is looked up at its end, too. Cost: linear in the bytes of the sources.
#[must_use]
pub fn hover(
    sources: &[Source<'_>],
    options: &Options,
    file: usize,
    byte: usize,
) -> (Sources, Option<Hover>) {
    let (sources, found) = asked(sources, file, byte, |sources, items, _, place| {
        check::look(sources, items, options, Look::at(place)).looked()
    });
    (sources, found.flatten())
}

/// What may be written at byte `byte` of file `file` of `sources`: what is typed there already is part of it, and the editor
/// chooses among the names. At most 2000. Cost: linear in the bytes of the sources.
#[must_use]
pub fn complete(sources: &[Source<'_>], options: &Options, file: usize, byte: usize) -> Vec<Completion> {
    let (_, found) = asked(sources, file, byte, |sources, items, file, place| {
        check::look(sources, items, options, Look::default()).complete(file, place)
    });
    found.unwrap_or_default()
}

/// The variable that a script calls by this path behind the key of its program: `State`, `Units[1].Mv.Done`, `Left.State`
/// for one of an instance of a CONFIGURATION. Its span says nothing. Cost: linear in the bytes of the sources.
#[must_use]
pub fn variable(sources: &[Source<'_>], options: &Options, path: &str) -> (Sources, Option<Hover>) {
    let (sources, found) = asked(sources, 0, 0, |sources, items, _, _| {
        check::look(sources, items, options, Look::default()).variable_called(path)
    });
    (sources, found.flatten())
}

/// Reads the sources and asks something of a place; nothing if it is not in them or they are too large.
fn asked<T>(
    given: &[Source<'_>],
    file: usize,
    byte: usize,
    ask: impl FnOnce(&Sources, &[crate::syntax::Item], usize, u32) -> T,
) -> (Sources, Option<T>) {
    let prelude = crate::library::prelude(given);
    let mut files = given.to_vec();
    files.push(crate::library_source(&prelude));
    let (sources, wrong) = Sources::new(&files);
    let (text, start) = sources.text_of(file);
    if !wrong.is_empty() || file >= given.len() || byte > text.len() {
        return (sources, None);
    }
    let items = crate::parse::parse(&sources, &mut Found::default());
    let found = ask(&sources, &items, file, start + byte as u32);
    (sources, Some(found))
}

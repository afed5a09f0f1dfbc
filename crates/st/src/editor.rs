//! Answers for editors: the name at a place, its declaration, and the names that may be written there.
//!
//! Nothing is kept between two questions. The project is read and checked anew, which is linear in its
//! bytes.

use crate::Options;
use crate::check::{self, Look};
use crate::error::Found;
use crate::source::{Source, Sources, Span};

/// The information about a name.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Hover {
    /// The name.
    pub span: Span,
    /// Its declaration, in Structured Text.
    pub text: String,
    /// Its description: from the table of blocks, or from the comment at its declaration.
    pub doc: String,
    /// The place of its declaration; `None` if that is the library.
    pub declared: Option<Span>,
}

/// The kind of a completion.
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
    /// The text to insert: for a pin of a call with its sign, `Execute := `.
    pub insert: String,
    /// Its kind.
    pub kind: CompletionKind,
    /// Its type, in a word or two.
    pub detail: String,
    /// Its description, possibly empty.
    pub doc: String,
}

impl Completion {
    pub(crate) fn new(
        name: &str,
        kind: CompletionKind,
        detail: impl Into<String>,
        doc: impl Into<String>,
    ) -> Self {
        Self {
            name: name.to_owned(),
            insert: name.to_owned(),
            kind,
            detail: detail.into(),
            doc: doc.into(),
        }
    }
}

/// The name at byte `byte` of file `file` of `sources`, if it is known; the table of files belongs to its
/// spans. A place at the end of a name counts as in it. Cost: linear in the bytes of the sources.
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

/// The names that may be written at byte `byte` of file `file` of `sources`. The name typed there so far
/// counts as part of it; the editor filters the names. At most 2000. Cost: linear in the bytes of the
/// sources.
#[must_use]
pub fn complete(sources: &[Source<'_>], options: &Options, file: usize, byte: usize) -> Vec<Completion> {
    let (_, found) = asked(sources, file, byte, |sources, items, file, place| {
        check::look(sources, items, options, Look::default()).complete(file, place)
    });
    found.unwrap_or_default()
}

/// The variable of a script's path behind the key of its program: `State`, `Units[1].Mv.Done`,
/// `Left.State` for one of an instance of a CONFIGURATION. Its span is not used. Cost: linear in the
/// bytes of the sources.
#[must_use]
pub fn variable(sources: &[Source<'_>], options: &Options, path: &str) -> (Sources, Option<Hover>) {
    let (sources, found) = asked(sources, 0, 0, |sources, items, _, _| {
        check::look(sources, items, options, Look::default()).variable_called(path)
    });
    (sources, found.flatten())
}

/// Reads the sources and answers a question about a place; `None` if it is not in them or they are too
/// large.
fn asked<T>(
    given: &[Source<'_>],
    file: usize,
    byte: usize,
    ask: impl FnOnce(&Sources, &[crate::syntax::Item], usize, u32) -> T,
) -> (Sources, Option<T>) {
    let mut found = Found::default();
    let sources = crate::project(given, &mut found);
    let (text, start) = sources.text_of(file);
    if found.has_errors() || file >= given.len() || byte > text.len() {
        return (sources, None);
    }
    let items = crate::parse::parse(&sources, &mut found);
    let answer = ask(&sources, &items, file, start + byte as u32);
    (sources, Some(answer))
}

//! The faults of a script, and how they are shown.

use crate::model::Span;
use annotate_snippets::{Annotation, AnnotationKind, Group, Level, Origin, Renderer, Snippet};
use standstill_st::without_joiners;
use standstill_trace::{printable, printable_lines};
use std::fmt;

macro_rules! codes {
    ($($(#[doc = $doc:literal])+ $variant:ident = $name:literal,)*) => {
        /// The kinds of errors of a script. The name is in the first line of a message; programs may rely
        /// on it.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        #[non_exhaustive]
        pub enum Code { $($(#[doc = $doc])+ $variant,)* }

        impl Code {
            /// All of them.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// The name in messages.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            /// Its meaning, one sentence.
            pub const fn doc(self) -> &'static str {
                match self { $(Self::$variant => concat!($($doc),+).trim_ascii(),)* }
            }
        }
    };
}

codes! {
    /// The text is no JSON.
    Syntax = "syntax",
    /// Objects and lists are nested deeper than the reader goes.
    TooDeep = "too_deep",
    /// A number is too large for a 64-bit float.
    NumberTooLarge = "number_too_large",
    /// A key stands twice in one object.
    DuplicateKey = "duplicate_key",
    /// A key that does not exist here.
    UnknownKey = "unknown_key",
    /// A key that must be given is not.
    MissingKey = "missing_key",
    /// A key, block or version whose feature this version of the runtime does not have.
    Unsupported = "unsupported",
    /// A value of another type than the key or pin takes.
    WrongType = "wrong_type",
    /// A value of the right type that cannot be used.
    BadValue = "bad_value",
    /// A time that is no TIME literal, or no whole multiple of the cycle.
    BadTime = "bad_time",
    /// A name that is no IEC identifier, or is a keyword.
    BadName = "bad_name",
    /// Two axes, inputs or instances have one name, without regard to case.
    DuplicateName = "duplicate_name",
    /// A block that does not exist.
    UnknownBlock = "unknown_block",
    /// A pin the block does not have.
    UnknownPin = "unknown_pin",
    /// An axis the script does not have.
    UnknownAxis = "unknown_axis",
    /// A signal, input or instance the script does not have.
    UnknownSignal = "unknown_signal",
    /// A state no axis can have.
    UnknownState = "unknown_state",
    /// An element the enumeration does not have.
    UnknownElement = "unknown_element",
    /// A task the script does not have.
    UnknownTask = "unknown_task",
    /// A parameter the script does not have.
    UnknownParameter = "unknown_parameter",
    /// An in_out that is connected to nothing.
    MissingPin = "missing_pin",
    /// A wire or a step writes an output.
    NotWritable = "not_writable",
    /// Two writers on one input.
    TwoWriters = "two_writers",
    /// Inputs that are wired in a circle into which nothing feeds.
    WireCycle = "wire_cycle",
    /// A scan outside the run.
    OutsideRun = "outside_run",
    /// A file that cannot be included: it is not there, includes itself, or lies outside what is allowed.
    BadInclude = "bad_include",
    /// An override of something that is not both in an included file and here.
    BadOverride = "bad_override",
    /// A guest program that cannot be read or used.
    BadProgram = "bad_program",
    /// A program or an expression, and this build has no interpreter for them.
    NotBuilt = "not_built",
    /// An expression that cannot be read or has no such value.
    BadExpression = "bad_expression",
    /// A script whose trace would be larger than the runtime records.
    TooLarge = "too_large",
}

/// One fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Its kind.
    pub code: Code,
    /// The fault, one sentence without a full stop.
    pub message: String,
    /// The place in the text; `None` if the cause is not in the text.
    pub span: Option<Span>,
    /// A few words under the carets; may be empty.
    pub label: String,
    /// Another relevant place with a few words, in a box because few have one.
    pub related: Option<Box<(Span, String)>>,
    /// The remedy.
    pub help: Option<String>,
}

impl Diagnostic {
    pub(crate) fn new(code: Code, span: Span, message: impl Into<String>) -> Self {
        Self {
            code,
            message: message.into(),
            span: Some(span),
            label: String::new(),
            related: None,
            help: None,
        }
    }

    /// The same, `by` bytes further on.
    pub(crate) fn moved(mut self, by: usize) -> Self {
        self.span = self.span.map(|span| span.moved(by));
        if let Some(related) = &mut self.related {
            related.0 = related.0.moved(by);
        }
        self
    }

    pub(crate) fn label(mut self, label: impl Into<String>) -> Self {
        self.label = label.into();
        self
    }

    pub(crate) fn related(mut self, span: Span, label: impl Into<String>) -> Self {
        self.related = Some(Box::new((span, label.into())));
        self
    }

    pub(crate) fn help(mut self, help: impl Into<String>) -> Self {
        self.help = Some(help.into());
        self
    }

    pub(crate) fn maybe_help(mut self, help: Option<String>) -> Self {
        self.help = help.or(self.help);
        self
    }
}

/// A text that belongs to a script.
#[derive(Clone, Debug)]
pub(crate) struct File {
    name: String,
    text: String,
    /// Offset of its first byte among those of all files.
    start: usize,
}

impl File {
    /// A text without a byte order mark; its name has `/` on every system.
    pub(crate) fn new(name: &str, text: &str, start: usize) -> Self {
        Self {
            name: name.to_owned(),
            text: text.to_owned(),
            start,
        }
    }

    /// The name as given.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    pub(crate) fn text(&self) -> &str {
        &self.text
    }

    /// Its folder with the `/` behind it; empty if there is none.
    pub(crate) fn folder(&self) -> &str {
        let end = self.name.rfind('/').map_or(0, |slash| slash + 1);
        self.name.get(..end).unwrap_or_default()
    }

    /// The first possible offset of the next file: one more than the end, because a message may point at
    /// the end of a file.
    pub(crate) fn after(&self) -> usize {
        self.start + self.text.len() + 1
    }

    /// Its text and its name, for an excerpt.
    fn snippet(&self) -> Snippet<'_, Annotation<'_>> {
        Snippet::source(without_joiners(&self.text)).path(printable(&self.name))
    }

    /// A place of all files as a place of this file.
    fn inner(&self, span: Span) -> std::ops::Range<usize> {
        span.start.saturating_sub(self.start)..span.end.saturating_sub(self.start)
    }
}

/// The faults of a refused script: at least one [`Diagnostic`], in text order.
#[derive(Clone, Debug)]
pub struct ScriptError {
    /// The script, then its included files; never empty.
    files: Vec<File>,
    diagnostics: Vec<Diagnostic>,
    /// The faults of sources in Structured Text; a diagnostic says to which program they belong.
    reports: Vec<standstill_st::Report>,
}

/// Largest number of diagnostics that are rendered in full; the rest is only counted.
pub const DIAGNOSTICS_SHOWN: usize = 20;

/// Largest number of bytes of a line that is shown with its message. The time to draw it grows with its length.
const LINE_SHOWN: usize = 20_000;

/// Largest number of characters of a name or value that a message quotes.
const SHOWN_CHARS: usize = 60;

impl ScriptError {
    /// `text` without a byte order mark: spans count from there.
    pub(crate) fn new(file_name: &str, text: &str, diagnostics: Vec<Diagnostic>) -> Self {
        Self::of(vec![File::new(file_name, text, 0)], diagnostics)
    }

    /// `files` in the order of their places, the script first.
    pub(crate) fn of(files: Vec<File>, mut diagnostics: Vec<Diagnostic>) -> Self {
        diagnostics.sort_by_key(|diagnostic| diagnostic.span.unwrap_or_default().start);
        Self {
            files,
            diagnostics,
            reports: Vec::new(),
        }
    }

    /// The same with the errors in the sources of programs.
    pub(crate) fn with_reports(self, reports: Vec<standstill_st::Report>) -> Self {
        Self { reports, ..self }
    }

    /// The errors in sources in Structured Text.
    #[must_use]
    pub fn reports(&self) -> &[standstill_st::Report] {
        &self.reports
    }

    /// The file that a place is in.
    fn file(&self, place: Span) -> &File {
        file(&self.files, place)
    }

    /// Name of the file that a place is in, as given.
    pub fn file_of(&self, place: Span) -> &str {
        &self.file(place).name
    }

    /// The file's name as given.
    pub fn file_name(&self) -> &str {
        self.file_of(Span::default())
    }

    /// The errors, in the order of the text.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// Line and column of a span's first character, both from 1; the column counts characters.
    pub fn line_column(&self, span: Span) -> (usize, usize) {
        place_of(&self.files, span)
    }

    /// The message for people: for each diagnostic the fault, file, line and column, the excerpt, a
    /// remedy. It has no colours, so it is the same everywhere. [`fmt::Display`] writes the same.
    pub fn render(&self) -> String {
        let mut out: Vec<String> = self
            .diagnostics
            .iter()
            .take(DIAGNOSTICS_SHOWN)
            .map(|diagnostic| rendered(&self.files, &Level::ERROR, diagnostic.code.name(), diagnostic))
            .collect();
        let hidden = self.diagnostics.len().saturating_sub(DIAGNOSTICS_SHOWN);
        if hidden > 0 {
            out.push(format!(
                "error: {hidden} more errors in {}",
                printable(self.file_name())
            ));
        }
        let reports = self.reports.iter().map(standstill_st::Report::render);
        out.extend(reports.map(|report| printable_lines(&report).into_owned()));
        out.join("\n\n")
    }
}

/// A message for people about a place in a text, of a level and with a name for its kind.
pub(crate) fn rendered(
    files: &[File],
    level: &Level<'static>,
    kind: &str,
    diagnostic: &Diagnostic,
) -> String {
    // They contain pieces of the script, which must not reach a terminal unchanged.
    let title = level
        .clone()
        .primary_title(printable_lines(&diagnostic.message))
        .id(kind);
    let spans = diagnostic.related.iter().map(|related| related.0);
    let is_long = diagnostic.span.into_iter().chain(spans).any(|span| {
        let file = file(files, span);
        longest_line(&file.text, file.inner(span)) > LINE_SHOWN
    });
    let mut group = match diagnostic.span {
        Some(span) if is_long => {
            let (line, column) = place_of(files, span);
            let origin = Origin::path(printable(&file(files, span).name));
            let related = diagnostic.related.iter().map(|related| &related.1);
            let labels = std::iter::once(&diagnostic.label).chain(related);
            let notes = labels.filter(|label| !label.is_empty());
            let group = Group::with_title(title).element(origin.line(line).char_column(column));
            group.elements(notes.map(|label| Level::NOTE.message(printable(label))))
        }
        None => Group::with_title(title).element(Origin::path(printable(&file(files, Span::default()).name))),
        Some(span) => {
            let found = file(files, span);
            let mut primary = AnnotationKind::Primary.span(found.inner(span));
            if !diagnostic.label.is_empty() {
                primary = primary.label(printable(&diagnostic.label));
            }
            let own = found.snippet().annotation(primary);
            match diagnostic.related.as_deref() {
                None => title.element(own),
                Some((span, label)) => {
                    let other = file(files, *span);
                    let context = AnnotationKind::Context
                        .span(other.inner(*span))
                        .label(printable(label));
                    if other.start == found.start {
                        title.element(own.annotation(context))
                    } else {
                        title.element(own).element(other.snippet().annotation(context))
                    }
                }
            }
        }
    };
    if let Some(help) = &diagnostic.help {
        group = group.element(Level::HELP.message(printable_lines(help)));
    }
    // A fixed width, so that long lines are cut in the same way everywhere.
    Renderer::plain().term_width(140).render(&[group])
}

/// The file that a place is in.
pub(crate) fn file(files: &[File], place: Span) -> &File {
    let later = files.partition_point(|file| file.start <= place.start);
    &files[later.saturating_sub(1)]
}

impl fmt::Display for ScriptError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render())
    }
}

impl std::error::Error for ScriptError {}

/// Line and column of a place in its file.
pub(crate) fn place_of(files: &[File], span: Span) -> (usize, usize) {
    let file = file(files, span);
    line_column(&file.text, file.inner(span).start)
}

/// The length of the longest line that a piece of a text is in.
fn longest_line(text: &str, piece: std::ops::Range<usize>) -> usize {
    let before = text.get(..piece.start).unwrap_or_default();
    let behind = text.get(piece.end..).unwrap_or_default();
    let start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let end = behind
        .find('\n')
        .map_or(text.len(), |newline| piece.end + newline);
    let lines = text.get(start..end).unwrap_or_default().split('\n');
    lines.map(str::len).max().unwrap_or(0)
}

/// Line and column of byte `offset`, both from 1; the column counts characters.
pub(crate) fn line_column(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let line = before.matches('\n').count() + 1;
    (line, before[line_start..].chars().count() + 1)
}

/// A piece of the script inside a sentence: in one line, in backticks, cut if long.
pub(crate) fn quoted(text: &str) -> String {
    match text.char_indices().nth(SHOWN_CHARS) {
        None => ["`", &printable(text), "`"].concat(),
        Some((end, _)) => ["`", &printable(&text[..end]), "..`"].concat(),
    }
}

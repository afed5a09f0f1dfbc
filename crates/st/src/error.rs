//! The faults of a program, and how they are shown.

use crate::source::{Position, Sources, Span};
use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet, normalize_untrusted_str};
use std::borrow::Cow;
use std::fmt;

macro_rules! codes {
    ($($(#[$doc:meta])+ $variant:ident = $name:literal,)*) => {
        /// The kinds of errors. The name is in the first line of a message; tools may rely on it.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        #[non_exhaustive]
        pub enum Code { $($(#[$doc])+ $variant,)* }

        impl Code {
            /// The name in messages.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }
        }
    };
}

codes! {
    /// Bytes that are no UTF-8.
    Encoding = "encoding",
    /// Too much text, too many variables, or too large ones.
    TooLarge = "too_large",
    /// Something is nested deeper than the compiler goes.
    TooDeep = "too_deep",
    /// A word or sign that cannot stand here, or one that is missing.
    Syntax = "syntax",
    /// A construct that is opened and not closed.
    NotClosed = "not_closed",
    /// A name that is no identifier, or is a keyword.
    BadName = "bad_name",
    /// A literal that cannot be read, or that its type does not hold.
    BadLiteral = "bad_literal",
    /// A construct of the language, or of a vendor, that is not supported.
    Unsupported = "unsupported",
    /// Two things have one name, without regard to case.
    DuplicateName = "duplicate_name",
    /// A name that nothing has.
    UnknownName = "unknown_name",
    /// A variable of type AXIS_REF that is to begin as an axis, and is not there.
    UnknownBinding = "unknown_binding",
    /// A type that does not exist.
    UnknownType = "unknown_type",
    /// A member or pin that a variable does not have.
    UnknownMember = "unknown_member",
    /// An argument that a call does not have, or has twice.
    BadArgument = "bad_argument",
    /// An argument that a call must have.
    MissingArgument = "missing_argument",
    /// A value of a type that cannot stand here.
    WrongType = "wrong_type",
    /// A value that would have to be converted by a function.
    Conversion = "conversion",
    /// A value that must be known before the program runs.
    NotConstant = "not_constant",
    /// A number outside the range it must be in.
    OutOfRange = "out_of_range",
    /// Something that must not be written.
    NotWritable = "not_writable",
    /// A statement that cannot stand here.
    Misplaced = "misplaced",
    /// Types, constants, functions or blocks that need themselves.
    Circle = "circle",
    /// The program to run is not clear, or its tasks are not.
    NoProgram = "no_program",
    /// A warning: the text works, and something in it is probably not meant.
    Doubtful = "doubtful",
    /// A warning: the text works here, and not with every other compiler.
    Portability = "portability",
    /// A lint: a block of motion is not called in every scan.
    St50 = "ST50",
    /// A lint: Execute is given a constant TRUE.
    St51 = "ST51",
    /// A lint: the outputs of two instances write one variable.
    St52 = "ST52",
    /// A lint: an instance is never called, or nobody reads whether it refused.
    St53 = "ST53",
    /// A lint: an instance is called twice in one scan.
    St54 = "ST54",
    /// A lint: two numbers with a point are compared for being equal.
    St55 = "ST55",
    /// A lint: a conversion to a type that the value had before.
    St56 = "ST56",
    /// A lint: a branch that no value reaches, or a variable that is never used.
    St57 = "ST57",
}

/// The severity of a fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Severity {
    /// The program cannot be compiled.
    Error,
    /// The program can be compiled.
    Warning,
}

/// One fault.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Its kind.
    pub code: Code,
    /// Its severity.
    pub severity: Severity,
    /// The fault, one sentence without a full stop.
    pub message: String,
    /// Its place.
    pub span: Span,
    /// A few words under the carets; may be empty.
    pub label: String,
    /// Another relevant place, with a few words.
    pub related: Option<Box<(Span, String)>>,
    /// The remedy.
    pub help: Option<String>,
}

impl Diagnostic {
    pub(crate) fn error(code: Code, span: Span, message: impl Into<String>) -> Self {
        Self {
            code,
            severity: Severity::Error,
            message: message.into(),
            span,
            label: String::new(),
            related: None,
            help: None,
        }
    }

    pub(crate) fn warning(code: Code, span: Span, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Warning,
            ..Self::error(code, span, message)
        }
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

/// Largest number of errors, and of warnings, that are kept; further ones are counted.
pub(crate) const DIAGNOSTICS_MOST: usize = 50;

/// The faults found so far.
#[derive(Clone, Debug, Default)]
pub(crate) struct Found {
    errors: Vec<Diagnostic>,
    warnings: Vec<Diagnostic>,
    error_count: usize,
    warning_count: usize,
    /// How many of the errors are those of reading, and not of names and types.
    of_reading: usize,
}

impl Found {
    pub(crate) fn add(&mut self, diagnostic: Diagnostic) {
        let (list, count) = match diagnostic.severity {
            Severity::Error => (&mut self.errors, &mut self.error_count),
            Severity::Warning => (&mut self.warnings, &mut self.warning_count),
        };
        // A piece that two others need is checked twice.
        if list.contains(&diagnostic) {
            return;
        }
        *count += 1;
        if list.len() < DIAGNOSTICS_MOST {
            list.push(diagnostic);
        }
    }

    /// All was read: what follows may have an error of reading as its cause.
    pub(crate) const fn all_read(&mut self) {
        self.of_reading = self.errors.len();
    }

    pub(crate) const fn has_errors(&self) -> bool {
        self.error_count > 0
    }

    /// Number of errors that are kept.
    pub(crate) const fn shown(&self) -> usize {
        self.errors.len()
    }

    /// All kept diagnostics: syntax errors first, then the others, each in the order of the text.
    pub(crate) fn report(self, sources: Sources) -> Report {
        let hidden = self.error_count - self.errors.len() + self.warning_count - self.warnings.len();
        let in_text = |diagnostic: &Diagnostic| (diagnostic.span, diagnostic.severity);
        let mut diagnostics = self.errors;
        let mut others = diagnostics.split_off(self.of_reading.min(diagnostics.len()));
        others.extend(self.warnings);
        diagnostics.sort_by_key(in_text);
        others.sort_by_key(in_text);
        diagnostics.extend(others);
        Report {
            sources,
            diagnostics,
            hidden,
        }
    }
}

/// The faults of the sources: those of reading first, because they cause others, each part in text order.
#[derive(Clone, Debug)]
pub struct Report {
    sources: Sources,
    diagnostics: Vec<Diagnostic>,
    hidden: usize,
}

impl Report {
    /// The errors and warnings.
    #[must_use]
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// Number of faults that are not kept.
    #[must_use]
    pub const fn hidden(&self) -> usize {
        self.hidden
    }

    /// Whether the program cannot be compiled.
    #[must_use]
    pub fn has_errors(&self) -> bool {
        self.diagnostics.iter().any(|it| it.severity == Severity::Error)
    }

    /// The files that its spans are in.
    #[must_use]
    pub const fn sources(&self) -> &Sources {
        &self.sources
    }

    /// Name of the file that a place is in, with `/`.
    #[must_use]
    pub fn file_name(&self, span: Span) -> &str {
        self.sources.file_name(span)
    }

    /// Line and column of the first character of a piece, and those behind its last one.
    #[must_use]
    pub fn positions(&self, span: Span) -> (Position, Position) {
        (self.sources.position(span.start), self.sources.position(span.end))
    }

    /// The message for people: for each diagnostic the fault, file, line and column, the excerpt, a
    /// remedy. It has no colours, so it is the same everywhere. [`fmt::Display`] writes the same.
    #[must_use]
    pub fn render(&self) -> String {
        // A fixed width, so that long lines are cut in the same way everywhere.
        let renderer = Renderer::plain().term_width(140);
        let rendered = self
            .diagnostics
            .iter()
            .map(|it| renderer.render(&[self.group(it)]));
        let mut out: Vec<String> = rendered.collect();
        if self.hidden > 0 {
            out.push(format!("{} more are not shown", self.hidden));
        }
        out.join("\n\n")
    }

    fn group<'a>(&'a self, diagnostic: &Diagnostic) -> Group<'a> {
        // They contain pieces of the source, which must not reach a terminal as control characters.
        let level = match diagnostic.severity {
            Severity::Error => Level::ERROR,
            Severity::Warning => Level::WARNING,
        };
        let title = level
            .primary_title(visible(&diagnostic.message))
            .id(diagnostic.code.name());
        let file = in_one_line(self.file_name(diagnostic.span));
        let mut group = match self.sources.excerpt(diagnostic.span) {
            None => {
                let position = self.sources.position(diagnostic.span.start);
                let origin = Origin::path(file).line(position.line as usize);
                Group::with_title(title).element(origin.char_column(position.column as usize))
            }
            Some((text, line, range)) => {
                let mut primary = AnnotationKind::Primary.span(range);
                if !diagnostic.label.is_empty() {
                    primary = primary.label(visible(&diagnostic.label));
                }
                let own = Snippet::source(without_joiners(text))
                    .line_start(line as usize)
                    .path(file);
                title.element(own.annotation(primary))
            }
        };
        if let Some((span, label)) = diagnostic.related.as_deref() {
            group = match self.sources.excerpt(*span) {
                Some((text, line, range)) => {
                    let context = AnnotationKind::Context.span(range).label(visible(label));
                    let path = in_one_line(self.file_name(*span));
                    group.element(
                        Snippet::source(without_joiners(text))
                            .line_start(line as usize)
                            .path(path)
                            .annotation(context),
                    )
                }
                None => group.element(Level::NOTE.message(visible(label))),
            };
        }
        if let Some(help) = &diagnostic.help {
            group = group.element(Level::HELP.message(visible(help)));
        }
        group
    }
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render())
    }
}

impl std::error::Error for Report {}

/// A text in which control characters and directions of writing are visible.
fn visible(text: &str) -> String {
    normalize_untrusted_str(&without_joiners(text))
}

/// The same for the name of a file.
fn in_one_line(name: &str) -> String {
    visible(name).replace('\n', "\u{240a}")
}

/// `text` with a replacement character for each joiner, which the renderer of errors would drop as if it did not exist.
/// Both have three bytes, so places stay valid.
#[must_use]
pub fn without_joiners(text: &str) -> Cow<'_, str> {
    const JOINER: char = '\u{200d}';
    if text.contains(JOINER) {
        Cow::Owned(text.replace(JOINER, "\u{fffd}"))
    } else {
        Cow::Borrowed(text)
    }
}

/// A piece of the source inside a sentence: in backticks, cut if long.
pub(crate) fn quoted(text: &str) -> String {
    const SHOWN_CHARS: usize = 60;
    let shown: String = text.chars().take(SHOWN_CHARS).collect();
    let cut = if shown.len() < text.len() { ".." } else { "" };
    format!("`{shown}{cut}`")
}

/// The candidate nearest to `name` without regard to case, as a help, if it differs in at most one letter
/// in three.
pub(crate) fn did_you_mean<'a>(name: &str, candidates: impl Iterator<Item = &'a str>) -> Option<String> {
    nearest(name, candidates).map(|candidate| format!("did you mean `{candidate}`?"))
}

/// The candidate nearest to `name`, if it is near enough.
pub(crate) fn nearest<'a>(name: &str, candidates: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let wanted: String = name.to_ascii_lowercase().chars().take(100).collect();
    let letters = wanted.chars().count();
    // A name of one letter would have none left.
    let slips = (letters / 3).max(1).min(letters.saturating_sub(1));
    candidates
        // A difference in length is a difference in letters; most names need no closer check.
        .filter(|candidate| candidate.len().abs_diff(wanted.len()) <= slips)
        .map(|candidate| {
            (
                strsim::osa_distance(&wanted, &candidate.to_ascii_lowercase()),
                candidate,
            )
        })
        .filter(|(distance, _)| *distance <= slips)
        .min_by_key(|(distance, _)| *distance)
        .map(|(_, candidate)| candidate)
}

//! What is wrong with a script, and how it is shown.

use crate::model::Span;
use annotate_snippets::{AnnotationKind, Group, Level, Origin, Renderer, Snippet, normalize_untrusted_str};
use std::fmt;

macro_rules! codes {
    ($($(#[doc = $doc:literal])+ $variant:ident = $name:literal,)*) => {
        /// The kinds of errors a script can have. The name stands in the first line of a message; scripts
        /// may rely on it.
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

            /// What it means, one sentence.
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
    /// A key or version whose feature this version of the runtime does not have.
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
    /// A script whose trace would be larger than the runtime records.
    TooLarge = "too_large",
}

/// One thing that is wrong.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// What kind.
    pub code: Code,
    /// What is wrong, one sentence without a full stop.
    pub message: String,
    /// Where in the text; `None` if the cause does not stand in it.
    pub span: Option<Span>,
    /// A few words under the carets, possibly none.
    pub label: String,
    /// Another place that matters, with a few words; in a box because few have one.
    pub related: Option<Box<(Span, String)>>,
    /// What to do about it.
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

/// Why a script was refused: at least one [`Diagnostic`], in the order of the text.
#[derive(Clone, Debug)]
pub struct ScriptError {
    file_name: String,
    text: String,
    diagnostics: Vec<Diagnostic>,
}

/// Most diagnostics that are rendered in full; the rest is only counted.
pub const DIAGNOSTICS_SHOWN: usize = 20;

/// Most characters of a name or value that a message repeats.
const SHOWN_CHARS: usize = 60;

impl ScriptError {
    /// `text` without a byte order mark: spans count from there.
    pub(crate) fn new(file_name: &str, text: &str, mut diagnostics: Vec<Diagnostic>) -> Self {
        diagnostics.sort_by_key(|diagnostic| diagnostic.span.unwrap_or_default().start);
        Self {
            // The same on every system; see the contract's rule for paths.
            file_name: file_name.replace('\\', "/"),
            text: text.to_owned(),
            diagnostics,
        }
    }

    /// The file's name as given, with `/`.
    pub fn file_name(&self) -> &str {
        &self.file_name
    }

    /// What is wrong, in the order of the text.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// Line and column of a span's first character, both from 1; the column counts characters.
    pub fn line_column(&self, span: Span) -> (usize, usize) {
        line_column(&self.text, span.start)
    }

    /// The message for people: per diagnostic what is wrong, file, line and column, the excerpt, a remedy.
    /// Without colours, so it is the same everywhere. [`fmt::Display`] writes the same.
    pub fn render(&self) -> String {
        // A fixed width, so that long lines are cut in the same way everywhere.
        let renderer = Renderer::plain().term_width(140);
        let mut out: Vec<String> = self
            .diagnostics
            .iter()
            .take(DIAGNOSTICS_SHOWN)
            .map(|diagnostic| renderer.render(&[self.group(diagnostic)]))
            .collect();
        let hidden = self.diagnostics.len().saturating_sub(DIAGNOSTICS_SHOWN);
        if hidden > 0 {
            out.push(format!("error: {hidden} more errors in {}", self.file_name));
        }
        out.join("\n\n")
    }

    fn group<'a>(&'a self, diagnostic: &Diagnostic) -> Group<'a> {
        // Pieces of the script stand in these; they must not reach a terminal as control characters.
        let visible = normalize_untrusted_str;
        let title = Level::ERROR
            .primary_title(visible(&diagnostic.message))
            .id(diagnostic.code.name());
        let mut group = match diagnostic.span {
            None => Group::with_title(title).element(Origin::path(self.file_name.as_str())),
            Some(span) => {
                let mut primary = AnnotationKind::Primary.span(span.start..span.end);
                if !diagnostic.label.is_empty() {
                    primary = primary.label(visible(&diagnostic.label));
                }
                let context = diagnostic.related.as_deref().map(|(span, label)| {
                    AnnotationKind::Context
                        .span(span.start..span.end)
                        .label(visible(label))
                });
                title.element(
                    Snippet::source(self.text.as_str())
                        .path(self.file_name.as_str())
                        .annotation(primary)
                        .annotations(context),
                )
            }
        };
        if let Some(help) = &diagnostic.help {
            group = group.element(Level::HELP.message(visible(help)));
        }
        group
    }
}

impl fmt::Display for ScriptError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.render())
    }
}

impl std::error::Error for ScriptError {}

/// Line and column of byte `offset`, both from 1; the column counts characters.
pub(crate) fn line_column(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset).unwrap_or(text);
    let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
    let line = before.matches('\n').count() + 1;
    (line, before[line_start..].chars().count() + 1)
}

/// A piece of the script inside a sentence: in backticks, cut if long.
pub(crate) fn quoted(text: &str) -> String {
    let shown: String = text.chars().take(SHOWN_CHARS).collect();
    let cut = if shown.len() < text.len() { ".." } else { "" };
    format!("`{shown}{cut}`")
}

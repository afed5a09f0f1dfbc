//! Structured Text for an editor: the project of a file, its mistakes, and the answers about a place.

use crate::documents::Documents;
use crate::position::Text;
use crate::uri;
use lsp_types::{
    CompletionItem, CompletionItemKind, CompletionTextEdit, DiagnosticRelatedInformation, DiagnosticSeverity,
    Documentation, Location, MarkupContent, MarkupKind, NumberOrString, Position, Range, TextEdit,
};
use standstill_st::editor::{Completion, CompletionKind, complete, hover};
use standstill_st::{Dialect, Options, Report, Severity, Source, Sources, Span};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// The files of a program, read.
#[derive(Debug)]
pub(crate) struct Project {
    files: Vec<(PathBuf, Rc<Text>)>,
    /// Their names in messages.
    names: Vec<String>,
    options: Options,
}

impl Project {
    /// The files that can be read, and the index of the file in question.
    pub(crate) fn new(documents: &Documents, files: &[PathBuf], dialect: &Dialect) -> Self {
        let read = |path: &PathBuf| Some((path.clone(), documents.text(path).ok()?));
        let files: Vec<_> = files.iter().filter_map(read).collect();
        let names = files.iter().map(|(path, _)| name(path)).collect();
        Self {
            files,
            names,
            options: Options {
                library: true,
                lint: true,
                dialect: dialect.clone(),
                ..Options::default()
            },
        }
    }

    pub(crate) fn sources(&self) -> Vec<Source<'_>> {
        let files = self.files.iter().zip(&self.names);
        files
            .map(|((_, text), name)| Source {
                name,
                bytes: text.as_str().as_bytes(),
            })
            .collect()
    }

    pub(crate) const fn options(&self) -> &Options {
        &self.options
    }

    /// Errors and warnings, by file.
    pub(crate) fn diagnostics(&self) -> BTreeMap<PathBuf, Vec<lsp_types::Diagnostic>> {
        let report = standstill_st::check(&self.sources(), &self.options);
        let mut found: BTreeMap<_, Vec<_>> = self
            .files
            .iter()
            .map(|(path, _)| (path.clone(), Vec::new()))
            .collect();
        for it in report.diagnostics() {
            if let Some((path, diagnostic)) = self.diagnostic(&report, it) {
                found.entry(path).or_default().push(diagnostic);
            }
        }
        found
    }

    fn diagnostic(
        &self,
        report: &Report,
        it: &standstill_st::Diagnostic,
    ) -> Option<(PathBuf, lsp_types::Diagnostic)> {
        let location = self.location(report.sources(), it.span)?;
        let (path, _) = self.files.get(report.sources().locate(it.span).0)?;
        let related = it.related.as_deref().and_then(|(span, label)| {
            Some(vec![DiagnosticRelatedInformation {
                location: self.location(report.sources(), *span)?,
                message: label.clone(),
            }])
        });
        let diagnostic = lsp_types::Diagnostic {
            range: at_least_a_character(location.range),
            severity: Some(match it.severity {
                Severity::Error => DiagnosticSeverity::ERROR,
                Severity::Warning => DiagnosticSeverity::WARNING,
            }),
            code: Some(NumberOrString::String(it.code.name().to_owned())),
            source: Some("standstill".to_owned()),
            message: with_help(&it.message, it.help.as_deref()),
            related_information: related,
            ..lsp_types::Diagnostic::default()
        };
        Some((path.clone(), diagnostic))
    }

    /// A place in one of the files.
    pub(crate) fn location(&self, sources: &Sources, span: Span) -> Option<Location> {
        let (file, bytes) = sources.locate(span);
        let (path, text) = self.files.get(file)?;
        Some(Location {
            uri: uri::uri(path)?,
            range: text.range(bytes),
        })
    }

    /// The index of a file, and the byte of it at a position.
    fn place(&self, path: &Path, position: Position) -> Option<(usize, usize, &Text)> {
        let file = self.files.iter().position(|(it, _)| it == path)?;
        let (_, text) = self.files.get(file)?;
        Some((file, text.byte(position), text))
    }

    pub(crate) fn hover(&self, path: &Path, position: Position) -> Option<lsp_types::Hover> {
        let (file, byte, text) = self.place(path, position)?;
        let (sources, found) = hover(&self.sources(), &self.options, file, byte);
        let found = found?;
        let range = text.range(sources.locate(found.span).1);
        Some(hover_of(shown(&found.text, &found.doc), range))
    }

    pub(crate) fn definition(&self, path: &Path, position: Position) -> Option<Location> {
        let (file, byte, _) = self.place(path, position)?;
        let (sources, found) = hover(&self.sources(), &self.options, file, byte);
        self.location(&sources, found?.declared?)
    }

    pub(crate) fn completions(&self, path: &Path, position: Position) -> Vec<CompletionItem> {
        let Some((file, byte, text)) = self.place(path, position) else {
            return Vec::new();
        };
        let found = complete(&self.sources(), &self.options, file, byte);
        let before = text.as_str().get(..byte).unwrap_or_default();
        let typed = before
            .bytes()
            .rev()
            .take_while(|it| it.is_ascii_alphanumeric() || *it == b'_');
        let range = text.range(byte - typed.count()..byte);
        let place = |(index, it): (usize, Completion)| item(index, it, range);
        found.into_iter().enumerate().map(place).collect()
    }
}

/// Editors mark nothing if a range is empty.
pub(crate) fn at_least_a_character(mut range: Range) -> Range {
    if range.start == range.end {
        range.end.character += 1;
    }
    range
}

pub(crate) fn with_help(message: &str, help: Option<&str>) -> String {
    match help {
        Some(help) => format!("{message}\nhelp: {help}"),
        None => message.to_owned(),
    }
}

/// A declaration and its description, as Markdown.
pub(crate) fn shown(text: &str, doc: &str) -> String {
    let mut shown = format!("```iecst\n{text}\n```");
    if !doc.is_empty() {
        shown.push_str(&format!("\n\n{}", plain(doc)));
    }
    shown
}

pub(crate) fn hover_of(value: String, range: Range) -> lsp_types::Hover {
    lsp_types::Hover {
        contents: lsp_types::HoverContents::Markup(MarkupContent {
            kind: MarkupKind::Markdown,
            value,
        }),
        range: Some(range),
    }
}

/// Text that Markdown does not change: nothing in a comment becomes a link or a picture.
pub(crate) fn plain(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        if "\\`*_{}[]<>#!|~".contains(c) {
            out.push('\\');
        }
        out.push(if c.is_control() && c != '\n' { ' ' } else { c });
    }
    out
}

fn item(index: usize, it: Completion, range: Range) -> CompletionItem {
    CompletionItem {
        kind: Some(match it.kind {
            CompletionKind::Pin => CompletionItemKind::FIELD,
            CompletionKind::Variable => CompletionItemKind::VARIABLE,
            CompletionKind::Element => CompletionItemKind::ENUM_MEMBER,
            CompletionKind::Function => CompletionItemKind::FUNCTION,
            CompletionKind::Block => CompletionItemKind::CLASS,
            CompletionKind::Type => CompletionItemKind::STRUCT,
            _ => CompletionItemKind::KEYWORD,
        }),
        // In our order: the nearest first.
        sort_text: Some(format!("{index:05}")),
        detail: (!it.detail.is_empty()).then_some(it.detail),
        documentation: (!it.doc.is_empty()).then_some(Documentation::String(it.doc)),
        text_edit: Some(CompletionTextEdit::Edit(TextEdit {
            range,
            new_text: it.insert,
        })),
        label: it.name,
        ..CompletionItem::default()
    }
}

fn name(path: &Path) -> String {
    path.file_name()
        .unwrap_or_default()
        .to_string_lossy()
        .into_owned()
}

//! Scan scripts for an editor: their mistakes, and the answers about a place. The schema gives the permitted keys
//! and values; the script itself gives the meaning of names.

mod scene;
mod schema;

use crate::documents::Documents;
use crate::text::{at_least_a_character, hover_of, plain, shown, with_help};
use crate::tree::{Node, Spot, Step};
use crate::uri;
use lsp_types::{
    CompletionItem, CompletionItemKind, CompletionTextEdit, Diagnostic, DiagnosticRelatedInformation,
    DiagnosticSeverity, Documentation, Location, NumberOrString, Position, Range, TextEdit,
};
use scene::{Kind, STATES, Scene, Signal};
use serde_json::Value;
use standstill_blocks::registry;
use standstill_fb::PinType;
use standstill_script::{ScriptError, read_with_programs};
use standstill_st::Dialect;
use std::path::Path;

/// Keys with signals as texts.
const SIGNAL_KEYS: &[&str] = &["from", "not", "any", "all", "exclusive", "same_as", "of"];

/// Keys with axes as texts.
const AXIS_KEYS: &[&str] = &["axis", "slave", "master", "within_limits"];

/// The mistakes of a script.
pub(crate) fn diagnostics(documents: &Documents, path: &Path) -> Vec<Diagnostic> {
    let Ok(text) = documents.text(path) else {
        return Vec::new();
    };
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let mut load = |inner: &str| {
        let path = documents.beside(path, inner)?;
        Ok(documents.text(&path)?.as_str().to_owned())
    };
    let mut guest = |inner: &str| {
        let path = documents.beside(path, inner)?;
        match documents.text(&path) {
            Ok(text) => Ok(text.as_str().as_bytes().to_vec()),
            // A module is not text.
            Err(_) => std::fs::read(&path).map_err(|error| error.to_string()),
        }
    };
    match read_with_programs(text.as_str(), &name, &[], &mut load, &mut guest) {
        Ok(_) => Vec::new(),
        Err(error) => {
            let told = error.diagnostics().iter();
            told.map(|it| diagnostic(documents, path, &error, it)).collect()
        }
    }
}

fn diagnostic(
    documents: &Documents,
    path: &Path,
    error: &ScriptError,
    it: &standstill_script::Diagnostic,
) -> Diagnostic {
    let own = |span| error.file_of(span) == error.file_name();
    let location = |span: standstill_script::model::Span| {
        let text = documents.text(path).ok()?;
        Some(Location {
            uri: uri::uri(path)?,
            range: at_least_a_character(text.range(span.start..span.end)),
        })
    };
    let range = it
        .span
        .filter(|span| own(*span))
        .and_then(location)
        .map(|it| it.range);
    let message = match it.span.filter(|span| !own(*span)) {
        // It is in a file that the script includes.
        Some(span) => {
            let (line, column) = error.line_column(span);
            format!("{}:{line}:{column}: {}", error.file_of(span), it.message)
        }
        None => it.message.clone(),
    };
    let mut related = Vec::new();
    if let Some((span, label)) = it.related.as_deref().filter(|(span, _)| own(*span))
        && let Some(location) = location(*span)
    {
        related.push(DiagnosticRelatedInformation {
            location,
            message: label.clone(),
        });
    }
    Diagnostic {
        range: range.unwrap_or_else(|| at_least_a_character(Range::default())),
        severity: Some(DiagnosticSeverity::ERROR),
        code: Some(NumberOrString::String(it.code.name().to_owned())),
        source: Some("standstill".to_owned()),
        message: with_help(&message, it.help.as_deref()),
        related_information: (!related.is_empty()).then_some(related),
        ..Diagnostic::default()
    }
}

/// The question about a place.
#[derive(Debug)]
pub(crate) struct Asked<'d> {
    scene: Scene<'d>,
    byte: usize,
    path: Vec<Step>,
    spot: Spot,
}

impl<'d> Asked<'d> {
    pub(crate) fn new(
        documents: &'d Documents,
        path: &Path,
        position: Position,
        dialect: &'d Dialect,
    ) -> Option<Self> {
        let scene = Scene::new(documents, path, dialect)?;
        let byte = scene.text().byte(position);
        let (path, spot) = scene.tree().spot(byte);
        Some(Self {
            scene,
            byte,
            path,
            spot,
        })
    }

    /// The key of the value, or of the list that contains it.
    fn last_key(&self) -> &str {
        let keys = self.path.iter().rev().filter_map(|step| match step {
            Step::Key(key) => Some(key.as_str()),
            Step::Item(_) => None,
        });
        keys.take(1).next().unwrap_or_default()
    }

    /// The text at the place, with its quotes, and its begin.
    fn whole(&self) -> (&str, usize) {
        let (Spot::Key(span) | Spot::Value(span)) = &self.spot;
        let text = self.scene.text().as_str().get(span.clone());
        (text.unwrap_or_default(), span.start)
    }

    /// The text at the place, without its quotes, and the place in it.
    fn inner(&self) -> (&str, usize) {
        let (text, start) = self.whole();
        let Some(open) = text.strip_prefix('"') else {
            return (text, start);
        };
        (open.strip_suffix('"').unwrap_or(open), start + 1)
    }

    /// Whether the place is between quotes.
    fn is_quoted(&self) -> bool {
        self.whole().0.starts_with('"')
    }

    /// The name at the place in a text: all of it, or one of an expression.
    fn word(&self) -> (&str, std::ops::Range<usize>) {
        let (inner, start) = self.inner();
        if !inner.starts_with('=') {
            return (inner, start..start + inner.len());
        }
        let at = self.byte.saturating_sub(start).min(inner.len());
        let part = |c: char| c.is_ascii_alphanumeric() || "_.[]%".contains(c);
        let before = inner.get(..at).unwrap_or_default();
        let from = before.trim_end_matches(part).len();
        let behind = inner.get(at..).unwrap_or_default();
        let to = at + behind.len() - behind.trim_start_matches(part).len();
        (inner.get(from..to).unwrap_or_default(), start + from..start + to)
    }

    /// The block whose pins these are.
    fn pins_of(&self) -> Option<&'static standstill_fb::BlockInfo> {
        let [Step::Key(blocks), item @ Step::Item(_), Step::Key(pins), ..] = self.path.as_slice() else {
            return None;
        };
        if blocks != "blocks" || pins != "pins" {
            return None;
        }
        let block = self.scene.tree().at(&[Step::Key(blocks.clone()), item.clone()])?;
        block.get("type").and_then(Node::as_text).and_then(registry::find)
    }

    /// Whether keys here are signals, and whether only those that steps set.
    fn signal_keys(&self) -> Option<bool> {
        match self.path.as_slice() {
            [Step::Key(steps), Step::Item(_), Step::Key(set)] if steps == "steps" && set == "set" => {
                Some(true)
            }
            path => {
                let allowed = schema::allowed(self.scene.tree(), path);
                allowed.is("conditions").then_some(false)
            }
        }
    }

    /// Whether the text here is a signal.
    fn is_signal(&self) -> bool {
        let key = self.last_key();
        let window = matches!(
            self.path.as_slice(),
            [Step::Key(expect), Step::Item(_), Step::Key(from)] if expect == "expect" && from == "from"
        );
        SIGNAL_KEYS.contains(&key) && !window
    }

    fn is_axis(&self) -> bool {
        let pin = match self.path.as_slice() {
            [.., Step::Key(pins), Step::Key(pin)] if pins == "pins" => self
                .pins_of()
                .and_then(|info| info.pins().find(|it| it.name == pin.as_str()))
                .is_some_and(|pin| matches!(pin.ty, PinType::Axis(_))),
            [Step::Key(programs), _, Step::Key(axes), _] => programs == "programs" && axes == "axes",
            _ => false,
        };
        pin || AXIS_KEYS.contains(&self.last_key())
    }

    pub(crate) fn hover(&self) -> Option<lsp_types::Hover> {
        let (word, span) = self.word();
        let value = self.hover_text(word)?;
        Some(hover_of(value, self.scene.text().range(span)))
    }

    fn hover_text(&self, word: &str) -> Option<String> {
        if word.is_empty() {
            return None;
        }
        let is_key = matches!(self.spot, Spot::Key(_));
        let signal = if is_key {
            self.signal_keys().is_some()
        } else {
            self.is_signal() || self.is_axis() || self.inner().0.starts_with('=')
        };
        if signal && let Some(told) = self.scene.told(word) {
            return Some(shown(&told.text, &told.doc));
        }
        if !is_key {
            let info = registry::find(word).filter(|_| self.last_key() == "type")?;
            return Some(format!("**{}**\n\n{}", info.name, plain(info.doc)));
        }
        let mut path = self.path.clone();
        path.push(Step::Key(word.to_owned()));
        let allowed = schema::allowed(self.scene.tree(), &path);
        let kinds = allowed.kinds();
        match (allowed.description(), kinds.as_str()) {
            (None, "") => None,
            (description, kinds) => {
                let description = description.map_or_else(String::new, |it| format!("\n\n{}", plain(it)));
                Some(format!("**{}**: {kinds}{description}", plain(word)))
            }
        }
    }

    pub(crate) fn definition(&self) -> Option<Location> {
        let (word, _) = self.word();
        if matches!(self.spot, Spot::Value(_)) {
            match self.last_key() {
                "st" | "include" | "override" | "csv" => return self.scene.file(word),
                "task" | "param" => {
                    let wanted = |kind: Kind| match self.last_key() {
                        "task" => matches!(kind, Kind::Task),
                        _ => matches!(kind, Kind::Parameter),
                    };
                    let mut named = self.scene.entities().iter();
                    let entity = named.find(|it| wanted(it.kind) && it.name.eq_ignore_ascii_case(word))?;
                    return self.scene.location(entity);
                }
                _ if !self.is_signal() && !self.is_axis() && !self.inner().0.starts_with('=') => return None,
                _ => {}
            }
        } else if self.signal_keys().is_none() {
            return None;
        }
        self.scene.told(word)?.declared
    }

    pub(crate) fn completions(&self) -> Vec<CompletionItem> {
        let offered = match &self.spot {
            Spot::Key(_) => self.keys(),
            Spot::Value(_) => self.values(),
        };
        let (_, span) = self.word();
        let range = self.scene.text().range(span);
        let quoted = self.is_quoted();
        let item = |(index, it): (usize, Offer)| CompletionItem {
            sort_text: Some(format!("{index:05}")),
            detail: (!it.detail.is_empty()).then_some(it.detail),
            documentation: (!it.doc.is_empty()).then_some(Documentation::String(it.doc)),
            kind: Some(it.kind),
            filter_text: (!quoted && it.text).then(|| format!("\"{}\"", it.label)),
            text_edit: Some(CompletionTextEdit::Edit(TextEdit {
                range,
                new_text: if quoted || !it.text {
                    it.label.clone()
                } else {
                    format!("\"{}\"", it.label)
                },
            })),
            label: it.label,
            ..CompletionItem::default()
        };
        offered.into_iter().enumerate().map(item).collect()
    }

    fn keys(&self) -> Vec<Offer> {
        if let Some(settable) = self.signal_keys() {
            let signals = self.scene.signals().into_iter();
            return signals
                .filter(|it| it.settable || !settable)
                .map(Offer::signal)
                .collect();
        }
        let node = self.scene.tree().at(&self.path);
        let (inner, _) = self.inner();
        let there = |key: &str| key != inner && node.is_some_and(|node| node.get(key).is_some());
        let mut offered: Vec<Offer> = Vec::new();
        let allowed = schema::allowed(self.scene.tree(), &self.path);
        for (key, schema) in allowed.keys() {
            if there(key) || offered.iter().any(|it| it.label == key) {
                continue;
            }
            let doc = schema.get("description").and_then(Value::as_str);
            offered.push(Offer {
                doc: doc.unwrap_or_default().to_owned(),
                ..Offer::plain(key, CompletionItemKind::PROPERTY)
            });
        }
        offered
    }

    fn values(&self) -> Vec<Offer> {
        let (inner, _) = self.inner();
        let plain = |names: &[&str], kind: CompletionItemKind| -> Vec<Offer> {
            names.iter().map(|name| Offer::plain(name, kind)).collect()
        };
        let named = |wanted: fn(Kind) -> bool| plain(&self.scene.names(wanted), CompletionItemKind::VARIABLE);
        if inner.starts_with('=') || self.is_signal() {
            let mut offered: Vec<_> = self.scene.signals().into_iter().map(Offer::signal).collect();
            if inner.starts_with('=') {
                offered.extend(plain(STATES, CompletionItemKind::ENUM_MEMBER));
                let words = [
                    "AND", "OR", "XOR", "NOT", "MOD", "TRUE", "FALSE", "ABS", "MIN", "MAX", "LIMIT",
                ];
                offered.extend(plain(&words, CompletionItemKind::KEYWORD));
            }
            return offered;
        }
        if self.is_axis() {
            return named(|kind| matches!(kind, Kind::Axis));
        }
        match self.last_key() {
            "task" => return named(|kind| matches!(kind, Kind::Task)),
            "param" => return named(|kind| matches!(kind, Kind::Parameter)),
            key if key.ends_with(".State") => return plain(STATES, CompletionItemKind::ENUM_MEMBER),
            _ => {}
        }
        let allowed = schema::allowed(self.scene.tree(), &self.path);
        let mut offered: Vec<Offer> = Vec::new();
        for value in allowed.values() {
            let (label, text) = match value {
                Value::String(text) => (text.clone(), true),
                other => (other.to_string(), false),
            };
            if !offered.iter().any(|it| it.label == label) {
                let doc = registry::find(&label).filter(|_| self.last_key() == "type");
                offered.push(Offer {
                    doc: doc.map_or("", |info| info.doc).to_owned(),
                    text,
                    ..Offer::plain(&label, CompletionItemKind::VALUE)
                });
            }
        }
        if allowed.has_booleans() && !self.is_quoted() {
            offered.extend(["true", "false"].map(|it| Offer {
                text: false,
                ..Offer::plain(it, CompletionItemKind::VALUE)
            }));
        }
        offered
    }
}

/// An item that may be written.
#[derive(Debug)]
struct Offer {
    label: String,
    detail: String,
    doc: String,
    kind: CompletionItemKind,
    /// Whether it is written in quotes.
    text: bool,
}

impl Offer {
    fn plain(label: &str, kind: CompletionItemKind) -> Self {
        Self {
            label: label.to_owned(),
            detail: String::new(),
            doc: String::new(),
            kind,
            text: true,
        }
    }

    fn signal(it: Signal) -> Self {
        Self {
            detail: it.detail,
            doc: it.doc,
            ..Self::plain(&it.name, CompletionItemKind::VARIABLE)
        }
    }
}

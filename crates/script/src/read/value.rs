//! Single values: bools, numbers with parameters, times, texts, and values of a pin's type.

use super::json::{Json, Key, Node};
use super::names::{Entity, suggestion};
use super::shape::{self, Shape};
use super::{Reader, hints, time};
use crate::error::{Code, Diagnostic, quoted};
use crate::format::number_text;
use crate::model::Span;
use standstill_axis::AxisId;
use standstill_fb::{PinType, Value};
use std::ops::RangeInclusive;

/// Whole numbers up to here are exact in a 64-bit float.
pub(crate) const WHOLE_MAX: f64 = 9_007_199_254_740_992.0;

/// The members of an object whose keys have been checked.
#[derive(Clone, Copy)]
pub(super) struct Fields<'n> {
    span: Span,
    members: &'n [(Key, Node)],
}

impl<'n> Fields<'n> {
    /// The members of a node whose keys have been checked.
    pub(super) const fn of(node: &Node, members: &'n [(Key, Node)]) -> Self {
        Self {
            span: node.span,
            members,
        }
    }

    pub(super) fn entry(&self, key: &str) -> Option<(&'n Key, &'n Node)> {
        let (key, node) = self.members.iter().find(|(k, _)| k.text == key)?;
        Some((key, node))
    }

    pub(super) fn get(&self, key: &str) -> Option<&'n Node> {
        self.entry(key).map(|(_, node)| node)
    }

    /// The members of the object of a key; none if it has no such object.
    pub(super) fn members(&self, key: &str) -> &'n [(Key, Node)] {
        self.get(key).map_or(&[], Node::members)
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (&'n Key, &'n Node)> + use<'n> {
        self.members.iter().map(|(key, node)| (key, node))
    }

    /// The opening brace: where a message about a missing key points.
    pub(super) fn brace(&self) -> Span {
        Span {
            start: self.span.start,
            end: self.span.start + 1,
        }
    }
}

/// The words that are permitted for a number.
pub(crate) const NUMBER_WORDS: [(&str, f64); 3] = [
    ("NaN", f64::NAN),
    ("Infinity", f64::INFINITY),
    ("-Infinity", f64::NEG_INFINITY),
];

/// The fault of a value that isn't what `what` takes.
pub(super) fn wrong_type(node: &Node, what: &str, expected: &str) -> Diagnostic {
    Diagnostic::new(Code::WrongType, node.span, format!("{what} takes {expected}"))
        .label(format!("this is {}", node.json.kind()))
}

fn number_word(text: &str) -> Option<f64> {
    NUMBER_WORDS
        .iter()
        .find(|(word, _)| *word == text)
        .map(|(_, value)| *value)
}

impl Reader {
    /// Adds a fault of the text.
    pub(super) fn report(&mut self, diagnostic: Diagnostic) {
        self.errors.push(diagnostic);
    }

    /// The same, for a value that is therefore missing.
    pub(super) fn refuse<T>(&mut self, diagnostic: Diagnostic) -> Option<T> {
        self.report(diagnostic);
        None
    }

    pub(super) fn map<'n>(&mut self, node: &'n Node, what: &str) -> Option<Fields<'n>> {
        if let Json::Map(members) = &node.json {
            return Some(Fields {
                span: node.span,
                members,
            });
        }
        self.refuse(wrong_type(node, what, "an object"))
    }

    pub(super) fn list<'n>(&mut self, node: &'n Node, what: &str) -> Option<&'n [Node]> {
        if let Json::List(items) = &node.json {
            return Some(items);
        }
        self.refuse(wrong_type(node, what, "a list"))
    }

    /// The members of `node`, every key of which `shape` must have.
    pub(super) fn fields<'n>(&mut self, node: &'n Node, shape: &Shape) -> Option<Fields<'n>> {
        self.members(node, shape.what, &shape.names().collect::<Vec<_>>())
    }

    /// The members of an object, each of which must be one of `keys`.
    pub(super) fn members<'n>(&mut self, node: &'n Node, what: &str, keys: &[&str]) -> Option<Fields<'n>> {
        let fields = self.map(node, what)?;
        for (key, value) in fields.iter() {
            if key.text == "note" && keys.contains(&"note") {
                let _ = self.text(value, "`note`");
            } else if !keys.contains(&key.text.as_str()) {
                self.report(
                    Diagnostic::new(
                        Code::UnknownKey,
                        key.span,
                        format!("unknown key {} in {what}", quoted(&key.text)),
                    )
                    .maybe_help(
                        hints::key(&key.text, keys.iter().copied())
                            .or_else(|| suggestion(&key.text, keys.iter().copied())),
                    ),
                );
            }
        }
        Some(fields)
    }

    /// The value of a required key.
    pub(super) fn require<'n>(&mut self, fields: &Fields<'n>, key: &str, what: &str) -> Option<&'n Node> {
        let node = fields.get(key);
        if node.is_none() {
            let message = format!("{what} needs the key `{key}`");
            let help = hints::example(key).map(|example| format!("for example {example}"));
            self.report(Diagnostic::new(Code::MissingKey, fields.brace(), message).maybe_help(help));
        }
        node
    }

    /// The value of a required key by `read`, which gets the key's name in messages.
    pub(super) fn needed<'n, T>(
        &mut self,
        fields: &Fields<'n>,
        key: &str,
        what: &str,
        read: impl FnOnce(&mut Self, &'n Node, &str) -> Option<T>,
    ) -> Option<T> {
        let node = self.require(fields, key, what)?;
        read(self, node, &quoted(key))
    }

    /// The same for a key that may be missing; its value is then `absent`.
    pub(super) fn optional<'n, T>(
        &mut self,
        fields: &Fields<'n>,
        key: &str,
        absent: T,
        read: impl FnOnce(&mut Self, &'n Node, &str) -> Option<T>,
    ) -> Option<T> {
        match fields.get(key) {
            Some(node) => read(self, node, &quoted(key)),
            None => Some(absent),
        }
    }

    /// The same for a key without a default; its value is then `None`.
    pub(super) fn if_given<'n, T>(
        &mut self,
        fields: &Fields<'n>,
        key: &str,
        read: impl FnOnce(&mut Self, &'n Node, &str) -> Option<T>,
    ) -> Option<Option<T>> {
        match fields.get(key) {
            Some(node) => read(self, node, &quoted(key)).map(Some),
            None => Some(None),
        }
    }

    pub(super) fn text<'n>(&mut self, node: &'n Node, what: &str) -> Option<&'n str> {
        if let Json::Text(text) = &node.json {
            return Some(text);
        }
        self.refuse(wrong_type(node, what, "a string"))
    }

    pub(super) fn boolean(&mut self, node: &Node, what: &str) -> Option<bool> {
        if let Json::Bool(value) = node.json {
            return Some(value);
        }
        let mut diagnostic = wrong_type(node, what, "true or false");
        if let Json::Text(text) = &node.json {
            let help = hints::truth(text).map(str::to_owned);
            diagnostic = diagnostic.maybe_help(help.or_else(|| self.wire_help(text)));
        }
        self.refuse(diagnostic)
    }

    /// The remedy for a string that is meant as a wire.
    fn wire_help(&self, text: &str) -> Option<String> {
        let name = text.split('.').next().unwrap_or_default();
        let known = self.names.get(name).is_some();
        hints::logic(text).or_else(|| known.then(|| format!("a wire is written {{\"from\": \"{text}\"}}")))
    }

    /// A number in digits, or a parameter with nothing beside its name; none otherwise, or if there is no such parameter.
    pub(super) fn plain_number(&self, node: &Node) -> Option<f64> {
        match &node.json {
            Json::Number(value) => Some(*value),
            Json::Map(members) => {
                let [(key, name)] = members.as_slice() else {
                    return None;
                };
                match &name.json {
                    Json::Text(name) if key.text == "param" => self.parameters.get(name).copied(),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    /// A number: digits, one of the words, or a parameter.
    pub(super) fn number(&mut self, node: &Node, what: &str) -> Option<f64> {
        if let Some(value) = self.plain_number(node) {
            return Some(value);
        }
        match &node.json {
            Json::Text(text) => {
                if let Some(value) = number_word(text) {
                    return Some(value);
                }
            }
            Json::Map(_) if node.member("param").is_some() => return self.parameter(node),
            _ => {}
        }
        let mut diagnostic = wrong_type(node, what, "a number");
        if let Json::Text(text) = &node.json {
            let help = hints::number(text).or_else(|| self.wire_help(text));
            diagnostic = diagnostic.help(help.unwrap_or_else(|| {
                "of strings only \"NaN\", \"Infinity\" and \"-Infinity\" are numbers".to_owned()
            }));
        }
        self.refuse(diagnostic)
    }

    fn parameter(&mut self, node: &Node) -> Option<f64> {
        let fields = self.fields(node, &shape::PARAM)?;
        let name_node = fields.get("param")?;
        let name = self.text(name_node, "`param`")?;
        let value = self.parameters.get(name).copied();
        if value.is_none() {
            let help = self
                .help(name, self.parameters.keys().map(String::as_str))
                .unwrap_or_else(|| format!("declare it: \"parameters\": {{{name:?}: 0}}"));
            self.report(
                Diagnostic::new(
                    Code::UnknownParameter,
                    name_node.span,
                    format!("the script has no parameter {}", quoted(name)),
                )
                .help(help),
            );
        }
        value
    }

    /// A number of the configuration: NaN and infinities are not permitted.
    pub(super) fn finite(&mut self, node: &Node, what: &str) -> Option<f64> {
        let value = self.number(node, what)?;
        if value.is_finite() {
            return Some(value);
        }
        self.refuse(
            Diagnostic::new(
                Code::BadValue,
                node.span,
                format!("{what} is {}: it must be a finite number", number_text(value)),
            )
            .help(
                "NaN and infinities may stand at pins and in conditions only; for no limit leave the key out",
            ),
        )
    }

    /// A whole number within `range`.
    pub(super) fn whole(&mut self, node: &Node, what: &str, range: RangeInclusive<i64>) -> Option<i64> {
        self.whole_of(node, what, range.clone(), range)
    }

    /// A whole number within `range`; an error says `told`, the range after later checks.
    fn whole_of(
        &mut self,
        node: &Node,
        what: &str,
        range: RangeInclusive<i64>,
        told: RangeInclusive<i64>,
    ) -> Option<i64> {
        let value = self.number(node, what)?;
        // Casts saturate, and the range check below is on the float, so every wrong value is found.
        let (low, high) = (*range.start() as f64, *range.end() as f64);
        if value == value.trunc() && value >= low && value <= high {
            return Some(value as i64);
        }
        let message = format!(
            "{what} is {}: it must be a whole number from {} to {}",
            number_text(value),
            told.start(),
            told.end()
        );
        self.refuse(Diagnostic::new(Code::BadValue, node.span, message))
    }

    /// A scan number or a count of scans: a whole number, or a TIME literal that is a multiple of the cycle.
    pub(super) fn scans(&mut self, node: &Node, what: &str) -> Option<u64> {
        self.scans_of(node, what, 0..=WHOLE_MAX as i64)
    }

    /// As [`Self::scans`]; an error says `told`, the range after later checks.
    pub(super) fn scans_of(&mut self, node: &Node, what: &str, told: RangeInclusive<i64>) -> Option<u64> {
        let Json::Text(_) = &node.json else {
            if !matches!(&node.json, Json::Number(_) | Json::Map(_)) {
                return self.refuse(
                    wrong_type(node, what, "a count of scans or a TIME literal")
                        .help("for example 501 or \"T#501ms\""),
                );
            }
            return self
                .whole_of(node, what, 0..=WHOLE_MAX as i64, told)
                .map(i64::unsigned_abs);
        };
        let ns = self.time_literal(node, what)?;
        if ns < 0 {
            let message = format!("{what} is negative");
            return self.refuse(Diagnostic::new(Code::BadTime, node.span, message));
        }
        let cycle = self.cycle_ns?;
        if ns % cycle == 0 {
            return Some((ns / cycle).unsigned_abs());
        }
        let below = ns - ns % cycle;
        let nearest = match below.checked_add(cycle) {
            Some(above) => format!(
                "the nearest are \"{}\" (scan {}) and \"{}\" (scan {})",
                time::literal(below),
                below / cycle,
                time::literal(above),
                above / cycle
            ),
            None => format!("the nearest is \"{}\"", time::literal(below)),
        };
        let message = format!(
            "{what} is no whole multiple of the cycle {}",
            time::literal(cycle)
        );
        self.refuse(Diagnostic::new(Code::BadTime, node.span, message).help(nearest))
    }

    /// A TIME literal, in nanoseconds.
    pub(super) fn time_literal(&mut self, node: &Node, what: &str) -> Option<i64> {
        let Json::Text(text) = &node.json else {
            return self.refuse(wrong_type(node, what, "a TIME literal").help("for example \"T#1ms\""));
        };
        match time::parse(text) {
            Ok(ns) => Some(ns),
            Err(why) => {
                let message = format!("{} is no TIME literal: {why}", quoted(text));
                self.refuse(
                    Diagnostic::new(Code::BadTime, node.span, message).help("for example \"T#500ms\""),
                )
            }
        }
    }

    /// The axis called by the string `node`.
    pub(super) fn axis_index(&mut self, node: &Node, what: &str) -> Option<usize> {
        let Json::Text(name) = &node.json else {
            return self.refuse(wrong_type(node, what, "the name of an axis"));
        };
        if let Some(Entity::Axis(index)) = self.names.get(name) {
            return Some(index);
        }
        let help = self.name_help(name, |entity| matches!(entity, Entity::Axis(_)));
        self.refuse(
            Diagnostic::new(
                Code::UnknownAxis,
                node.span,
                format!("the script has no axis {}", quoted(name)),
            )
            .maybe_help(help),
        )
    }

    /// The remedy for an unknown name among those that `filter` accepts.
    pub(super) fn name_help(&self, name: &str, filter: fn(&Entity) -> bool) -> Option<String> {
        self.help(name, self.names.of(filter))
    }

    /// The remedy for a name that is not one of `candidates`, of which there may be many. Only the first
    /// errors get one: in a long script with a misspelling in every line, each would be compared with
    /// every name.
    pub(super) fn help<'a>(
        &self,
        name: &str,
        candidates: impl Iterator<Item = &'a str> + Clone,
    ) -> Option<String> {
        const ERRORS_WITH_HELP: usize = 200;
        (self.errors.len() < ERRORS_WITH_HELP)
            .then(|| suggestion(name, candidates))
            .flatten()
    }

    /// A value of type `ty`.
    pub(super) fn value(&mut self, node: &Node, ty: PinType, what: &str) -> Option<Value> {
        match ty {
            PinType::Bool => self.boolean(node, what).map(Value::Bool),
            PinType::Lreal => self.number(node, what).map(Value::Lreal),
            PinType::Int => {
                let value = self.whole(node, what, i16::MIN.into()..=i16::MAX.into())?;
                i16::try_from(value).ok().map(Value::Int)
            }
            PinType::Uint | PinType::Word => {
                let value = self.whole(node, what, 0..=u16::MAX.into())?;
                u16::try_from(value).ok().map(Value::Word)
            }
            PinType::Dword => {
                let value = self.whole(node, what, 0..=u32::MAX.into())?;
                u32::try_from(value).ok().map(Value::Dword)
            }
            PinType::Time => self.duration(node, what).map(Value::Time),
            PinType::Table(info) => self.table(node, info, what).map(Value::Table),
            PinType::Axis(_) => {
                let index = self.axis_index(node, what)?;
                u16::try_from(index)
                    .ok()
                    .map(|index| Value::Axis(AxisId::new(index)))
            }
            PinType::Enum(info) => {
                let Json::Text(name) = &node.json else {
                    let value = self.whole(node, what, i32::MIN.into()..=i32::MAX.into())?;
                    return i32::try_from(value).ok().map(Value::Enum);
                };
                let number = info.number_of(name);
                if number.is_none() {
                    self.report(
                        Diagnostic::new(
                            Code::UnknownElement,
                            node.span,
                            format!("{} has no element {}", info.name, quoted(name)),
                        )
                        .maybe_help(suggestion(name, info.elements.iter().map(|(name, _)| *name))),
                    );
                }
                number.map(Value::Enum)
            }
        }
    }

    /// A TIME value in nanoseconds: any literal, or a count of scans.
    pub(super) fn duration(&mut self, node: &Node, what: &str) -> Option<i64> {
        if let Json::Text(_) = &node.json {
            return self.time_literal(node, what);
        }
        let scans = self.scans(node, what)?;
        let ns = i64::try_from(scans)
            .ok()
            .and_then(|scans| scans.checked_mul(self.cycle_ns?));
        if ns.is_none() && self.cycle_ns.is_some() {
            let message = format!("{what} does not fit in 64 bits of nanoseconds");
            self.report(Diagnostic::new(Code::BadTime, node.span, message));
        }
        ns
    }

    /// One of a few words.
    pub(super) fn choice<T: Copy>(&mut self, node: &Node, what: &str, words: &[(&str, T)]) -> Option<T> {
        let text = self.text(node, what)?;
        if let Some((_, value)) = words.iter().find(|(word, _)| *word == text) {
            return Some(*value);
        }
        self.refuse(
            Diagnostic::new(
                Code::BadValue,
                node.span,
                format!("{what} cannot be {}", quoted(text)),
            )
            .maybe_help(suggestion(text, words.iter().map(|(word, _)| *word))),
        )
    }
}

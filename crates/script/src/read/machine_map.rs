//! From text to a checked [`Map`]: how `standstill compare` compares a trace with the recording of a
//! machine.

use super::names::suggestion;
use super::shape::machine as shape;
use super::value::{Fields, wrong_type};
use super::{Reader, read_file};
use crate::error::{Code, Diagnostic, ScriptError, quoted};
use crate::read::json::{Json, Key, Node};
use standstill_trace::foreign::{Layout, Place, Times, Unit};
use standstill_trace::machine::{FIT_SCANS, Map, Measure, Offset, Signal};
use standstill_trace::{Column, Kind, Trace};
use std::collections::BTreeMap;

/// The version of the format that is read.
pub(crate) const MAP_VERSION: u32 = 1;

/// Largest number of columns of a recording that are searched.
pub(crate) const COLUMNS_MAX: i64 = 10_000;

/// Units of a column of times.
pub(crate) const UNITS: [(&str, Unit); 5] = [
    ("s", Unit::Seconds),
    ("ms", Unit::Milliseconds),
    ("us", Unit::Microseconds),
    ("ns", Unit::Nanoseconds),
    ("100ns", Unit::Ticks),
];

/// Delimiters by their names.
pub(crate) const DELIMITERS: [(&str, char); 4] = [(",", ','), (";", ';'), ("tab", '\t'), ("|", '|')];

/// Marks before decimals.
pub(crate) const DECIMALS: [(&str, char); 2] = [(".", '.'), (",", ',')];

/// Reads a map for this trace, which must have the signals that it names.
///
/// `file_name` is used in messages only. The work is bounded by the lengths of the text and of the list
/// of signals.
///
/// # Errors
/// [`ScriptError`] with all faults; after a syntax error only that one.
pub fn read_map(text: &str, file_name: &str, trace: &Trace) -> Result<Map, ScriptError> {
    read_file(text, file_name, |reader, root, _| reader.machine_map(root, trace))
}

impl Reader {
    fn machine_map(&mut self, root: &Node, trace: &Trace) -> Option<Map> {
        let fields = self.fields(root, &shape::MAP)?;
        self.version(&fields, ("standstill_compare", "map"), "a map", MAP_VERSION)?;
        let layout = self.require(&fields, "recording", "a map");
        let layout = layout.and_then(|node| self.recording(node));
        let time_tolerance = self.optional(&fields, "time_tolerance", 0, Self::not_negative_time)?;
        let signals = self.require(&fields, "signals", "a map");
        let signals = signals.and_then(|node| self.signals(node, trace, time_tolerance));
        let window = self.if_given(&fields, "window", Self::window)?;
        let node = self.require(&fields, "offset", "a map")?;
        let offset = self.offset(node, signals.as_deref()?, trace);
        Some(Map {
            layout: layout?,
            offset: offset?,
            window,
            signals: signals?,
        })
    }

    fn recording(&mut self, node: &Node) -> Option<Layout> {
        let fields = self.fields(node, &shape::RECORDING)?;
        let delimiter = self.if_given(&fields, "delimiter", |it, node, key| {
            it.choice(node, key, &DELIMITERS)
        })?;
        let decimal = self.if_given(&fields, "decimal", |it, node, key| {
            it.choice(node, key, &DECIMALS)
        })?;
        let node = self.require(&fields, "time", "`recording`")?;
        let time = self.fields(node, &shape::TIME)?;
        let times = if let Some(every) = time.get("every") {
            if let Some(other) = time.get("column").or(time.get("unit")) {
                let message = "with `every` no column of times is read: leave `column` and `unit` out";
                return self.refuse(Diagnostic::new(Code::BadValue, other.span, message));
            }
            let every_ns = self.time_literal(every, "`every`")?;
            if every_ns <= 0 {
                let message = "`every` must be longer than no time";
                return self.refuse(Diagnostic::new(Code::BadTime, every.span, message));
            }
            Times::Every(every_ns)
        } else {
            let node = self.require(&time, "column", "`time`")?;
            let place = self.place(node)?;
            let unit = self.needed(&time, "unit", "`time`", |it, node, key| {
                it.choice(node, key, &UNITS)
            })?;
            Times::Column { place, unit }
        };
        Some(Layout {
            delimiter,
            decimal,
            times,
        })
    }

    /// A column by its name or its number.
    fn place(&mut self, node: &Node) -> Option<Place> {
        match &node.json {
            Json::Text(name) if name.trim().is_empty() => {
                let message = "`column` names no column";
                self.refuse(
                    Diagnostic::new(Code::BadValue, node.span, message)
                        .help("give its name, or its number from 1"),
                )
            }
            Json::Text(name) => Some(Place::Name(name.trim().to_owned())),
            Json::Number(_) => {
                let number = self.whole(node, "`column`", 1..=COLUMNS_MAX)?;
                usize::try_from(number).ok().map(Place::Number)
            }
            _ => self.refuse(wrong_type(
                node,
                "`column`",
                "the name of a column or its number from 1",
            )),
        }
    }

    fn not_negative_time(&mut self, node: &Node, what: &str) -> Option<i64> {
        let ns = self.time_literal(node, what)?;
        if ns >= 0 {
            return Some(ns);
        }
        let message = format!("{what} is negative");
        self.refuse(Diagnostic::new(Code::BadTime, node.span, message))
    }

    fn window(&mut self, node: &Node, what: &str) -> Option<(i64, i64)> {
        let fields = self.fields(node, &shape::WINDOW)?;
        let (from, to) = self.limits_of_time(&fields, what)?;
        if from >= 0 {
            return Some((from, to));
        }
        let message = "`window` begins before scan 0";
        self.refuse(Diagnostic::new(Code::BadTime, node.span, message))
    }

    fn limits_of_time(&mut self, fields: &Fields<'_>, what: &str) -> Option<(i64, i64)> {
        let from = self.require(fields, "from", what)?;
        let from = self.time_literal(from, "`from`")?;
        let to_node = self.require(fields, "to", what)?;
        let to = self.time_literal(to_node, "`to`")?;
        if from <= to {
            return Some((from, to));
        }
        self.refuse(Diagnostic::new(
            Code::BadTime,
            to_node.span,
            "`to` is before `from`",
        ))
    }

    fn signals(&mut self, node: &Node, trace: &Trace, time_tolerance: i64) -> Option<Vec<Signal>> {
        let fields = self.map(node, "`signals`")?;
        let mut signals = Vec::new();
        let mut whole = true;
        for (key, node) in fields.iter() {
            match self.mapped_signal(key, node, trace, time_tolerance) {
                Some(signal) => signals.push(signal),
                None => whole = false,
            }
        }
        if whole && signals.is_empty() {
            return self.refuse(
                Diagnostic::new(Code::BadValue, node.span, "the map names no column")
                    .help("for example {\"X.Position\": {\"column\": \"ActPos\", \"tolerance\": 0.1}}"),
            );
        }
        whole.then_some(signals)
    }

    fn mapped_signal(
        &mut self,
        key: &Key,
        node: &Node,
        trace: &Trace,
        time_tolerance: i64,
    ) -> Option<Signal> {
        let columns = trace.columns();
        let Some(column) = trace.column(&key.text).and_then(|at| columns.get(at)) else {
            let names = columns.iter().map(|column: &Column| column.name.as_str());
            let message = format!("the trace has no signal {}", quoted(&key.text));
            return self.refuse(
                Diagnostic::new(Code::UnknownSignal, key.span, message)
                    .maybe_help(suggestion(&key.text, names)),
            );
        };
        let shape = match column.kind {
            Kind::Real => &shape::CURVE,
            Kind::Bool => &shape::BOOL,
            Kind::Integer => &shape::WHOLE,
            Kind::Name => &shape::WORD,
        };
        let fields = self.fields(node, shape)?;
        let measure = match column.kind {
            Kind::Real => self.curve(&fields),
            Kind::Bool => {
                let invert = self.optional(&fields, "invert", false, Self::boolean)?;
                Some(Measure::Bool { invert })
            }
            Kind::Integer => Some(Measure::Whole),
            Kind::Name => self.words(&fields).map(Measure::Word),
        };
        let place = self.require(&fields, "column", shape.what)?;
        let place = self.place(place);
        let time_tolerance =
            self.optional(&fields, "time_tolerance", time_tolerance, Self::not_negative_time)?;
        Some(Signal {
            name: key.text.clone(),
            place: place?,
            time_tolerance,
            measure: measure?,
        })
    }

    fn curve(&mut self, fields: &Fields<'_>) -> Option<Measure> {
        let factor = self.optional(fields, "factor", 1.0, Self::finite)?;
        if let (0.0, Some(node)) = (factor, fields.get("factor")) {
            let message = "`factor` is 0: everything recorded would be the same";
            return self.refuse(Diagnostic::new(Code::BadValue, node.span, message));
        }
        let sign = self.optional(fields, "sign", 1.0, Self::sign)?;
        let zero = self.optional(fields, "zero", 0.0, Self::finite)?;
        let node = self.require(fields, "tolerance", shape::CURVE.what)?;
        let tolerance = self.finite(node, "`tolerance`")?;
        if tolerance < 0.0 {
            let message = format!("`tolerance` is {tolerance:?}: it must be 0 or more");
            return self.refuse(Diagnostic::new(Code::BadValue, node.span, message));
        }
        Some(Measure::Curve {
            factor: factor * sign,
            zero,
            tolerance,
        })
    }

    fn sign(&mut self, node: &Node, what: &str) -> Option<f64> {
        let sign = self.finite(node, what)?;
        if sign.abs() == 1.0 {
            return Some(sign);
        }
        let message = format!("{what} is {sign:?}: it must be 1 or -1");
        self.refuse(Diagnostic::new(Code::BadValue, node.span, message).help("other numbers go to `factor`"))
    }

    fn words(&mut self, fields: &Fields<'_>) -> Option<BTreeMap<String, String>> {
        let Some(node) = fields.get("values") else {
            return Some(BTreeMap::new());
        };
        let values = self.map(node, "`values`")?;
        let mut words = BTreeMap::new();
        for (key, node) in values.iter() {
            words.insert(
                key.text.clone(),
                self.text(node, "an element of `values`")?.to_owned(),
            );
        }
        Some(words)
    }

    fn offset(&mut self, node: &Node, signals: &[Signal], trace: &Trace) -> Option<Offset> {
        if let Json::Text(_) = &node.json {
            return self.time_literal(node, "`offset`").map(Offset::Fixed);
        }
        let Json::Map(_) = &node.json else {
            return self.refuse(wrong_type(node, "`offset`", "a TIME literal or an object").help(
                "\"T#20ms\", {\"edge\": \"move.Done\", \"to\": true} or {\"fit\": \"X.Position\", \"from\": \"T#-1s\", \"to\": \"T#1s\"}",
            ));
        };
        if node.member("fit").is_some() {
            return self.fit(node, signals, trace);
        }
        let fields = self.fields(node, &shape::EDGE)?;
        let edge = self.require(&fields, "edge", shape::EDGE.what)?;
        let signal = self.of_map(edge, "`edge`", signals)?;
        let node = self.require(&fields, "to", shape::EDGE.what)?;
        let to = match (&signal.measure, &node.json) {
            (Measure::Curve { .. }, _) => {
                let message = format!("{} has no edges", quoted(&signal.name));
                return self.refuse(
                    Diagnostic::new(Code::BadValue, edge.span, message)
                        .help("numbers are fitted: {\"fit\": .., \"from\": .., \"to\": ..}"),
                );
            }
            (Measure::Bool { .. }, _) => {
                let to = self.boolean(node, "`to`")?;
                if to { "TRUE" } else { "FALSE" }.to_owned()
            }
            (Measure::Whole, _) => {
                let most = 1_i64 << 53;
                self.whole(node, "`to`", -most..=most)?.to_string()
            }
            (Measure::Word(_), _) => self.text(node, "`to`")?.to_owned(),
        };
        let number = self.optional(&fields, "number", 1, |it, node, key| {
            it.whole(node, key, 1..=1_000_000)
        })?;
        Some(Offset::Edge {
            signal: signal.name.clone(),
            to,
            number: usize::try_from(number).ok()?,
        })
    }

    fn fit(&mut self, node: &Node, signals: &[Signal], trace: &Trace) -> Option<Offset> {
        let fields = self.fields(node, &shape::FIT)?;
        let name = self.require(&fields, "fit", shape::FIT.what)?;
        let signal = self.of_map(name, "`fit`", signals)?;
        if !matches!(signal.measure, Measure::Curve { .. }) {
            let message = format!("{} is no curve to fit", quoted(&signal.name));
            return self.refuse(
                Diagnostic::new(Code::BadValue, name.span, message)
                    .help("take one of its edges: {\"edge\": .., \"to\": ..}"),
            );
        }
        let (from, to) = self.limits_of_time(&fields, shape::FIT.what)?;
        let cycle = i128::from(trace.header().cycle_ns.max(1));
        if (i128::from(to) - i128::from(from)) / cycle >= i128::from(FIT_SCANS) {
            let message = format!("the fit would try more than {FIT_SCANS} scans");
            return self.refuse(
                Diagnostic::new(Code::BadTime, node.span, message)
                    .help("give a rough offset first, and the window around it"),
            );
        }
        Some(Offset::Fit {
            signal: signal.name.clone(),
            from,
            to,
        })
    }

    /// A signal that the map has.
    fn of_map<'s>(&mut self, node: &Node, what: &str, signals: &'s [Signal]) -> Option<&'s Signal> {
        let name = self.text(node, what)?;
        let found = signals.iter().find(|signal| signal.name == name);
        if found.is_none() {
            let names = signals.iter().map(|signal| signal.name.as_str());
            let message = format!("`signals` has no {}", quoted(name));
            self.report(
                Diagnostic::new(Code::UnknownSignal, node.span, message).maybe_help(suggestion(name, names)),
            );
        }
        found
    }
}

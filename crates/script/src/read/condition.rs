//! Conditions: signals and what they must be.

use super::json::{Json, Key, Node};
use super::names::{Entity, suggestion};
use super::{Reader, is_note, shape};
use crate::error::{Code, Diagnostic, quoted};
use crate::format::number_text;
use crate::model::{AxisNumber, Comparison, Condition, Conditions, Signal, Span, Test};
use standstill_axis::AxisState;
use standstill_fb::{PinType, Value};

/// The numeric columns of an axis by name.
pub(crate) const AXIS_NUMBERS: [(&str, AxisNumber); 6] = [
    ("Position", AxisNumber::Position),
    ("Velocity", AxisNumber::Velocity),
    ("Acceleration", AxisNumber::Acceleration),
    ("Jerk", AxisNumber::Jerk),
    ("Snap", AxisNumber::Snap),
    ("ActualPosition", AxisNumber::ActualPosition),
];

/// What values a signal has.
#[derive(Clone, Copy, PartialEq)]
enum Kind {
    Pin(PinType),
    State,
}

impl Kind {
    fn is_numeric(self) -> bool {
        matches!(
            self,
            Self::Pin(PinType::Lreal | PinType::Int | PinType::Word | PinType::Dword | PinType::Time)
        )
    }

    fn name(self) -> &'static str {
        match self {
            Self::Pin(ty) => ty.iec_name(),
            Self::State => "the state of an axis",
        }
    }
}

impl Reader {
    pub(super) fn conditions(&mut self, node: &Node, what: &str) -> Option<Conditions> {
        let members = self.map(node, what)?;
        let has_note_variable = self.names.get("note").is_some();
        let conditions: Vec<Option<Condition>> = members
            .iter()
            .filter(|(key, node)| has_note_variable || !is_note(key, node))
            .map(|(key, node)| self.condition(key, node))
            .collect();
        if conditions.is_empty() {
            let message = format!("{what} needs at least one condition");
            self.report(Diagnostic::new(Code::BadValue, node.span, message));
            return None;
        }
        conditions.into_iter().collect()
    }

    fn condition(&mut self, key: &Key, node: &Node) -> Option<Condition> {
        let (signal, kind) = self.signal(&key.text, key.span)?;
        let what = format!("{} ({})", quoted(&key.text), kind.name());
        let test = self.test(node, kind, &what)?;
        let span = Span {
            start: key.span.start,
            end: node.span.end,
        };
        Some(Condition {
            text: key.text.clone(),
            signal,
            test,
            span,
        })
    }

    fn test(&mut self, node: &Node, kind: Kind, what: &str) -> Option<Test> {
        match &node.json {
            Json::Map(members) if members.iter().all(|(key, _)| key.text != "param") => {
                self.comparisons(node, kind, what).map(Test::Compare)
            }
            _ => self.plain(node, kind, what),
        }
    }

    /// A value as it is: what the signal must be, exactly.
    fn plain(&mut self, node: &Node, kind: Kind, what: &str) -> Option<Test> {
        match kind {
            Kind::State => {
                let names: Vec<&str> = AxisState::ALL.iter().map(|state| state.name()).collect();
                let name = self.state_name(node, what, &names)?;
                AxisState::ALL
                    .iter()
                    .find(|state| state.name() == name)
                    .map(|state| Test::State(*state))
            }
            Kind::Pin(PinType::Bool) => self.boolean(node, what).map(Test::Bool),
            Kind::Pin(ty @ (PinType::Axis(_) | PinType::Enum(_) | PinType::Table(_))) => {
                self.value(node, ty, what).map(Test::Named)
            }
            Kind::Pin(_) => self.scalar(node, kind, what).map(Test::Exactly),
        }
    }

    /// A number a numeric signal is compared with; TIME in nanoseconds.
    fn scalar(&mut self, node: &Node, kind: Kind, what: &str) -> Option<f64> {
        if kind == Kind::Pin(PinType::Time) {
            return match self.value(node, PinType::Time, what)? {
                Value::Time(ns) => Some(ns as f64),
                _ => None,
            };
        }
        self.number(node, what)
    }

    /// One of `names`, which are states.
    pub(super) fn state_name<'n>(&mut self, node: &Node, what: &str, names: &[&'n str]) -> Option<&'n str> {
        let text = self.text(node, what)?;
        let name = names.iter().find(|name| name.eq_ignore_ascii_case(text)).copied();
        if name.is_none() {
            self.report(
                Diagnostic::new(
                    Code::UnknownState,
                    node.span,
                    format!("there is no axis state {}", quoted(text)),
                )
                .maybe_help(suggestion(text, names.iter().copied())),
            );
        }
        name
    }

    fn comparisons(&mut self, node: &Node, kind: Kind, what: &str) -> Option<Vec<Comparison>> {
        let fields = self.fields(node, &shape::COMPARISON)?;
        let mut comparisons = Vec::new();
        for (key, value) in fields.iter() {
            let comparison = match key.text.as_str() {
                "note" => continue,
                "ne" => self
                    .plain(value, kind, what)
                    .map(|test| Comparison::Ne(Box::new(test))),
                "same_as" => self.same_as(value, kind, what),
                _ if !kind.is_numeric() => {
                    let message = format!("{what} is no number: only `ne` and `same_as` compare it");
                    self.report(Diagnostic::new(Code::WrongType, key.span, message));
                    None
                }
                "within" if fields.get("near").is_some() => continue,
                "within" => {
                    let message = "`within` is the tolerance of `near`, which is not given";
                    self.report(Diagnostic::new(Code::MissingKey, key.span, message));
                    None
                }
                "near" => self.near(value, fields.get("within"), key.span, kind, what),
                name => self.scalar(value, kind, what).and_then(|limit| match name {
                    "le" => Some(Comparison::Le(limit)),
                    "ge" => Some(Comparison::Ge(limit)),
                    "lt" => Some(Comparison::Lt(limit)),
                    "gt" => Some(Comparison::Gt(limit)),
                    "abs_le" => Some(Comparison::AbsLe(limit)),
                    // An unknown key, which `fields` has reported.
                    _ => None,
                }),
            };
            comparisons.push(comparison);
        }
        if comparisons.is_empty() {
            let message = format!("{what} is compared with nothing");
            self.report(
                Diagnostic::new(Code::MissingKey, node.span, message)
                    .help("for example {\"le\": 50} or {\"near\": 20, \"within\": 0.001}"),
            );
            return None;
        }
        comparisons.into_iter().collect()
    }

    fn near(
        &mut self,
        near: &Node,
        within: Option<&Node>,
        key: Span,
        kind: Kind,
        what: &str,
    ) -> Option<Comparison> {
        let near = self.scalar(near, kind, what);
        let Some(tolerance) = within else {
            let message = "`near` needs a tolerance: `within`";
            self.report(Diagnostic::new(Code::MissingKey, key, message));
            return None;
        };
        let within = self.scalar(tolerance, kind, "`within`")?;
        if !(within >= 0.0) {
            let message = format!("`within` is {}: a tolerance is 0 or more", number_text(within));
            self.report(Diagnostic::new(Code::BadValue, tolerance.span, message));
            return None;
        }
        Some(Comparison::Near { near: near?, within })
    }

    fn same_as(&mut self, node: &Node, kind: Kind, what: &str) -> Option<Comparison> {
        let text = self.text(node, "`same_as`")?;
        let (signal, other) = self.signal(text, node.span)?;
        if other == kind {
            return Some(Comparison::SameAs(text.to_owned(), signal));
        }
        let message = format!(
            "{what} cannot be the same as {}, which is {}",
            quoted(text),
            other.name()
        );
        self.report(Diagnostic::new(Code::WrongType, node.span, message));
        None
    }

    /// The signal called `text`.
    fn signal(&mut self, text: &str, span: Span) -> Option<(Signal, Kind)> {
        let (name, rest) = text.split_once('.').unwrap_or((text, ""));
        let axis = match self.names.get(name) {
            Some(Entity::Axis(axis)) => axis,
            Some(_) => {
                let (point, ty) = self.point(text, span)?;
                return Some((Signal::Point(point), Kind::Pin(ty)));
            }
            None => {
                let message = format!("there is no axis, input variable or instance {}", quoted(name));
                let help = self.name_help(name, |_| true);
                self.report(Diagnostic::new(Code::UnknownSignal, span, message).maybe_help(help));
                return None;
            }
        };
        if rest.eq_ignore_ascii_case("State") {
            return Some((Signal::State(axis), Kind::State));
        }
        let (number, difference) = match rest.split_once('.') {
            Some((number, difference)) => (number, Some(difference)),
            None => (rest, None),
        };
        let number = AXIS_NUMBERS
            .iter()
            .find(|(known, _)| known.eq_ignore_ascii_case(number))
            .map(|(_, n)| *n);
        let signal = match (number, difference) {
            (Some(number), None) => Some(Signal::Axis(axis, number)),
            (Some(AxisNumber::Position), Some(difference)) => match difference {
                "d1" => Some(Signal::Difference(axis, 1)),
                "d2" => Some(Signal::Difference(axis, 2)),
                "d3" => Some(Signal::Difference(axis, 3)),
                "d4" => Some(Signal::Difference(axis, 4)),
                _ => None,
            },
            _ => None,
        };
        if signal.is_none() {
            let message = format!("an axis has no signal {}", quoted(rest));
            let help = suggestion(
                rest,
                ["State"]
                    .into_iter()
                    .chain(AXIS_NUMBERS.iter().map(|(name, _)| *name))
                    .chain(["Position.d1", "Position.d2", "Position.d3", "Position.d4"]),
            );
            self.report(Diagnostic::new(Code::UnknownSignal, span, message).maybe_help(help));
        }
        signal.map(|signal| (signal, Kind::Pin(PinType::Lreal)))
    }
}

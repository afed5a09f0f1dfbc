//! Conditions: signals and their required values.

use super::formula::{Reads, expression};
use super::json::{Json, Key, Node};
use super::names::{Entity, suggestion};
use super::value::wrong_type;
use super::{Reader, hints, is_note, shape};
use crate::error::{Code, Diagnostic, quoted};
use crate::format::number_text;
use crate::model::{
    AxisNumber, Comparison, Condition, Conditions, Point, Signal, Span, Test, Variable, WhichMaster,
};
use standstill_axis::AxisState;
use standstill_fb::{PinType, Value};
use standstill_st::Elementary;
use std::collections::BTreeSet;

/// The numeric columns of an axis by name.
pub(crate) const AXIS_NUMBERS: [(&str, AxisNumber); 11] = [
    ("Position", AxisNumber::Position),
    ("Velocity", AxisNumber::Velocity),
    ("Acceleration", AxisNumber::Acceleration),
    ("Jerk", AxisNumber::Jerk),
    ("Snap", AxisNumber::Snap),
    ("ActualPosition", AxisNumber::ActualPosition),
    ("Deviation", AxisNumber::Deviation),
    ("Phase", AxisNumber::Phase),
    ("Phase2", AxisNumber::Phase2),
    ("Superimposed", AxisNumber::Superimposed),
    ("Shadow", AxisNumber::Shadow),
];

/// The kind of values a signal has.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum Kind {
    Pin(PinType),
    State,
    /// The master of a slave.
    Master,
    /// A variable of Structured Text: its program and its place there.
    Variable(usize, usize),
}

impl Kind {
    fn is_numeric(self) -> bool {
        matches!(
            self,
            Self::Pin(
                PinType::Lreal
                    | PinType::Int
                    | PinType::Uint
                    | PinType::Word
                    | PinType::Dword
                    | PinType::Time
            )
        )
    }

    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Pin(ty) => ty.iec_name(),
            Self::State => "the state of an axis",
            Self::Master => "the master of an axis",
            Self::Variable(..) => "a variable",
        }
    }

    /// The point of a variable.
    const fn point(self) -> Option<Point> {
        match self {
            Self::Variable(program, symbol) => Some(Point::Symbol(program, symbol)),
            Self::Pin(_) | Self::State | Self::Master => None,
        }
    }
}

impl Reader {
    pub(super) fn conditions(&mut self, node: &Node, what: &str) -> Option<Conditions> {
        if let Json::Text(text) = &node.json {
            if expression(text).is_none() {
                let wanted = "an object, or an expression, which begins with `=`";
                return self.refuse(wrong_type(node, what, wanted));
            }
            let formula = self.formula(node, text, PinType::Bool, Reads::Row)?;
            return Some(vec![Condition {
                text: text.clone(),
                signal: Signal::Formula(formula),
                test: Test::Bool(true),
                span: node.span,
            }]);
        }
        let members = self.map(node, what)?;
        let has_note_variable = self.names.get("note").is_some();
        let conditions: Vec<Option<Condition>> = members
            .iter()
            .filter(|(key, node)| has_note_variable || !is_note(key, node))
            .map(|(key, node)| self.condition(key, node))
            .collect();
        if conditions.is_empty() {
            let message = format!("{what} needs at least one condition");
            return self.refuse(Diagnostic::new(Code::BadValue, node.span, message));
        }
        let conditions: Vec<Condition> = conditions.into_iter().collect::<Option<_>>()?;
        // Equal keys were reported before; names do not distinguish case.
        let mut known = BTreeSet::new();
        let twice = conditions
            .iter()
            .find(|condition| !known.insert(condition.text.to_ascii_lowercase()));
        if let Some(twice) = twice {
            let message = format!("{what} asks twice for {}", quoted(&twice.text));
            return self.refuse(Diagnostic::new(Code::DuplicateKey, twice.span, message));
        }
        Some(conditions)
    }

    fn condition(&mut self, key: &Key, node: &Node) -> Option<Condition> {
        let (signal, kind) = self.signal(&key.text, key.span)?;
        let what = [&quoted(&key.text), " (", &self.kind_name(kind), ")"].concat();
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

    fn kind_name(&self, kind: Kind) -> String {
        let variable = kind.point().and_then(|point| self.variable_at(point));
        variable.map_or_else(
            || kind.name().to_owned(),
            |variable| variable.type_name().to_owned(),
        )
    }

    /// The variable of a kind.
    pub(super) fn variable_of(&self, kind: Kind) -> Option<Variable> {
        self.variable_at(kind.point()?).cloned()
    }

    fn is_numeric(&self, kind: Kind) -> bool {
        match self.variable_of(kind) {
            Some(variable) => variable.elements().is_none() && variable.elementary() != Elementary::Bool,
            None => kind.is_numeric(),
        }
    }

    fn test(&mut self, node: &Node, kind: Kind, what: &str) -> Option<Test> {
        match &node.json {
            Json::Map(_) if node.member("param").is_none() => {
                self.comparisons(node, kind, what).map(Test::Compare)
            }
            _ => self.plain(node, kind, what),
        }
    }

    /// A plain value: the exact value that the signal must have.
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
            Kind::Master => match &node.json {
                Json::Text(text) if text.is_empty() => Some(Test::Word(String::new())),
                _ => self.value(node, PinType::Axis("AXIS_REF"), what).map(Test::Named),
            },
            Kind::Pin(PinType::Bool) => self.boolean(node, what).map(Test::Bool),
            Kind::Pin(ty @ (PinType::Axis(_) | PinType::Enum(_) | PinType::Table(_))) => {
                self.value(node, ty, what).map(Test::Named)
            }
            Kind::Pin(_) => self.scalar(node, kind, what).map(Test::Exactly),
            Kind::Variable(..) => {
                let variable = self.variable_of(kind)?;
                self.variable_test(node, &variable, what)
            }
        }
    }

    /// A number to which a numeric signal is compared; TIME in nanoseconds.
    fn scalar(&mut self, node: &Node, kind: Kind, what: &str) -> Option<f64> {
        if let Some(variable) = self.variable_of(kind) {
            return self.variable_number(node, &variable, what);
        }
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
                _ if !self.is_numeric(kind) => {
                    let message = format!("{what} is no number: only `ne` and `same_as` compare it");
                    self.refuse(Diagnostic::new(Code::WrongType, key.span, message))
                }
                "within" if fields.get("near").is_some() => continue,
                name if self.variable_of(kind).is_some_and(|variable| variable.is_wide()) => {
                    let variable = self.variable_of(kind)?;
                    self.wide_comparison((name, key.span), value, &variable, what)
                }
                "within" => {
                    let message = "`within` is the tolerance of `near`, which is not given";
                    self.refuse(Diagnostic::new(Code::MissingKey, key.span, message))
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
            return self.refuse(
                Diagnostic::new(Code::MissingKey, node.span, message)
                    .help("for example {\"le\": 50} or {\"near\": 20, \"within\": 0.001}"),
            );
        }
        let comparisons: Vec<Comparison> = comparisons.into_iter().collect::<Option<_>>()?;
        self.contradiction(&comparisons, node.span, what);
        Some(comparisons)
    }

    fn near(
        &mut self,
        near: &Node,
        within: Option<&Node>,
        key: Span,
        kind: Kind,
        what: &str,
    ) -> Option<Comparison> {
        let other = match &near.json {
            Json::Map(_) if near.member("param").is_none() => Some(self.near_to(near, kind)),
            _ => None,
        };
        let near = match other {
            Some(_) => Some(0.0),
            None => self.scalar(near, kind, what),
        };
        let Some(tolerance) = within else {
            let message = "`near` needs a tolerance: `within`";
            return self.refuse(Diagnostic::new(Code::MissingKey, key, message));
        };
        let within = self.scalar(tolerance, kind, "`within`")?;
        if !(within >= 0.0) {
            let message = format!("`within` is {}: a tolerance is 0 or more", number_text(within));
            return self.refuse(Diagnostic::new(Code::BadValue, tolerance.span, message));
        }
        match other {
            None => Some(Comparison::Near { near: near?, within }),
            Some(other) => {
                let (name, of, plus) = other?;
                Some(Comparison::NearTo {
                    name,
                    of,
                    plus,
                    within,
                })
            }
        }
    }

    /// The signal and the number of a `near`.
    fn near_to(&mut self, node: &Node, kind: Kind) -> Option<(String, Signal, f64)> {
        let fields = self.fields(node, &shape::NEAR_TO)?;
        let plus = fields
            .get("plus")
            .map_or(Some(0.0), |node| self.scalar(node, kind, "`plus`"));
        let of = self.require(&fields, "of", "`near`")?;
        let text = self.text(of, "`of`")?;
        let (signal, other) = self.signal(text, of.span)?;
        if self.is_numeric(other) {
            return Some((text.to_owned(), signal, plus?));
        }
        let message = format!(
            "`of` takes a number, {} is {}",
            quoted(text),
            self.kind_name(other)
        );
        self.refuse(Diagnostic::new(Code::WrongType, of.span, message))
    }

    /// Comparisons that no value satisfies.
    fn contradiction(&mut self, comparisons: &[Comparison], span: Span, what: &str) {
        let mut low = (f64::NEG_INFINITY, false);
        let mut high = (f64::INFINITY, false);
        for comparison in comparisons {
            match comparison {
                Comparison::Ge(bound) if *bound > low.0 => low = (*bound, false),
                Comparison::Gt(bound) if *bound >= low.0 => low = (*bound, true),
                Comparison::Le(bound) if *bound < high.0 => high = (*bound, false),
                Comparison::Lt(bound) if *bound <= high.0 => high = (*bound, true),
                _ => {}
            }
        }
        let side = |(bound, is_open): (f64, bool), closed: &str, open: &str| {
            format!("{} {}", if is_open { open } else { closed }, number_text(bound))
        };
        if low.0 > high.0 || (low.0 == high.0 && (low.1 || high.1)) {
            let message = format!(
                "{what} contradicts itself: no number is {} and {}",
                side(low, "at least", "above"),
                side(high, "at most", "below")
            );
            self.report(
                Diagnostic::new(Code::BadValue, span, message).help("widen the bounds, or turn them"),
            );
        }
    }

    fn same_as(&mut self, node: &Node, kind: Kind, what: &str) -> Option<Comparison> {
        let text = self.text(node, "`same_as`")?;
        let (signal, other) = self.signal(text, node.span)?;
        if self.comparable(other, kind) {
            return Some(Comparison::SameAs(text.to_owned(), signal));
        }
        let message = format!(
            "{what} cannot be the same as {}, which is {}",
            quoted(text),
            self.kind_name(other)
        );
        self.refuse(Diagnostic::new(Code::WrongType, node.span, message))
    }

    /// Whether two signals can be equal to the bit: of one type, or numbers of Structured Text and
    /// others.
    fn comparable(&self, one: Kind, other: Kind) -> bool {
        let enumeration = |kind| {
            self.variable_of(kind)
                .and_then(|it| Some(it.elements()?.to_vec()))
        };
        match (one, other) {
            (Kind::Variable(..), _) | (_, Kind::Variable(..)) => {
                let is_bool = |kind| !self.is_numeric(kind) && enumeration(kind).is_none();
                enumeration(one) == enumeration(other)
                    && self.is_numeric(one) == self.is_numeric(other)
                    && is_bool(one) == is_bool(other)
                    && one != Kind::State
                    && other != Kind::State
            }
            (one, other) => one == other,
        }
    }

    /// The signal called `text`.
    pub(super) fn signal(&mut self, text: &str, span: Span) -> Option<(Signal, Kind)> {
        let (name, rest) = text.split_once('.').unwrap_or((text, ""));
        let axis = match self.names.get(name) {
            Some(Entity::Axis(axis)) => axis,
            Some(_) => {
                let (point, ty) = self.point(text, span)?;
                return Some((Signal::Point(point), self.kind_of(point, ty)));
            }
            None => {
                let message = format!("there is no axis, input variable or instance {}", quoted(name));
                let help = hints::logic(text).map(|_| {
                    "a condition is a signal and its value: {\"there.Done\": false}; several are joined by commas"
                        .to_owned()
                });
                let help = help.or_else(|| self.name_help(name, |_| true));
                return self.refuse(Diagnostic::new(Code::UnknownSignal, span, message).maybe_help(help));
            }
        };
        let signal = axis_signal(axis, rest);
        if let Some((pin, help)) = signal.as_ref().and_then(|signal| self.lacked(axis, signal)) {
            let message = format!("{} stands at no {pin}, and has no {}", quoted(name), quoted(rest));
            return self.refuse(Diagnostic::new(Code::UnknownSignal, span, message).help(help));
        }
        let kind = match signal {
            Some(Signal::State(_)) => Kind::State,
            Some(Signal::Master(..)) => Kind::Master,
            Some(_) => Kind::Pin(PinType::Lreal),
            None => {
                let message = format!("an axis has no signal {}", quoted(rest));
                let help = suggestion(
                    rest,
                    ["State", "Master", "Master2"]
                        .into_iter()
                        .chain(AXIS_NUMBERS.iter().map(|(name, _)| *name))
                        .chain(["Position.d1", "Position.d2", "Position.d3", "Position.d4"]),
                );
                return self.refuse(Diagnostic::new(Code::UnknownSignal, span, message).maybe_help(help));
            }
        };
        signal.map(|signal| (signal, kind))
    }

    /// The pin at which an axis must stand to have a signal, and the reason, if it does not stand there.
    fn lacked(&self, axis: usize, signal: &Signal) -> Option<(&'static str, &'static str)> {
        let least = match *signal {
            Signal::Master(_, WhichMaster::First) => 1,
            Signal::Master(_, WhichMaster::Second) => 2,
            Signal::Axis(_, number) => number.least_masters(),
            _ => 0,
        };
        let masters = self.masters_of(axis);
        if masters == 0 && least > 0 {
            return Some((
                "`Slave` pin",
                "Master, Deviation and Phase are signals of axes that a block of this script couples to a master",
            ));
        }
        if masters < least {
            return Some((
                "`Slave` pin of MC_CombineAxes",
                "Master2 and Phase2 are signals of axes that MC_CombineAxes couples to two masters",
            ));
        }
        match signal {
            Signal::Axis(_, AxisNumber::Superimposed) if !self.is_superimposed(axis) => Some((
                "`Axis` pin of MC_MoveSuperimposed",
                "Superimposed is a signal of axes that have a master and are moved by MC_MoveSuperimposed",
            )),
            Signal::Axis(_, AxisNumber::Shadow) if !self.on_cams.contains(&axis) => Some((
                "`Slave` pin of MC_CamIn",
                "Shadow is a signal of axes that MC_CamIn couples to a master",
            )),
            _ => None,
        }
    }
}

/// The signal of an axis by its name behind that of the axis.
fn axis_signal(axis: usize, name: &str) -> Option<Signal> {
    let is = |known: &str| name.eq_ignore_ascii_case(known);
    if is("State") {
        return Some(Signal::State(axis));
    }
    if is("Master") {
        return Some(Signal::Master(axis, WhichMaster::First));
    }
    if is("Master2") {
        return Some(Signal::Master(axis, WhichMaster::Second));
    }
    if let Some((number, difference)) = name.split_once('.') {
        let mut orders = (1..).zip(["d1", "d2", "d3", "d4"]);
        let (order, _) = orders.find(|(_, known)| *known == difference)?;
        let is_position = number.eq_ignore_ascii_case("Position");
        return is_position.then_some(Signal::Difference(axis, order));
    }
    let (_, number) = AXIS_NUMBERS.iter().find(|(known, _)| is(known))?;
    Some(Signal::Axis(axis, *number))
}

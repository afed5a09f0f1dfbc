//! The values that steps set in variables of Structured Text, and the tests of conditions on them.

use super::Reader;
use super::condition::Kind;
use super::json::{Json, Node};
use super::names::suggestion;
use super::value::WHOLE_MAX;
use crate::error::{Code, Diagnostic, quoted};
use crate::model::{Action, Comparison, Point, Relation, Span, Test, Variable};
use standstill_fb::{PinType, Value};
use standstill_st::Elementary;

impl Reader {
    /// The variable of Structured Text at a point.
    pub(super) fn variable_at(&self, point: Point) -> Option<&Variable> {
        let Point::Symbol(program, symbol) = point else {
            return None;
        };
        let program = self.programs.get(program)?.as_ref()?;
        program.symbols.get(symbol)?.variable.as_ref()
    }

    /// A step that sets a variable.
    pub(super) fn set_variable(
        &mut self,
        point: Point,
        variable: &Variable,
        (name, span): (&str, Span),
        node: &Node,
    ) -> Option<Action> {
        if !variable.is_settable() {
            let message = format!("{} is not for steps to set", quoted(name));
            let help = "steps set VAR_INPUT, VAR_GLOBAL and variables AT an address, but no CONSTANT";
            return self.refuse(Diagnostic::new(Code::NotWritable, span, message).help(help));
        }
        let what = format!("{} ({})", quoted(name), variable.type_name());
        let value = self.variable_value(node, variable, &what)?;
        Some(Action::Set(point, value))
    }

    /// A value of the type of a variable.
    fn variable_value(&mut self, node: &Node, variable: &Variable, what: &str) -> Option<Value> {
        if let Some(elements) = variable.elements() {
            return self
                .element(node, variable, elements, what)
                .map(|number| variable.of_whole(number));
        }
        match variable.elementary() {
            Elementary::Bool => self.boolean(node, what).map(Value::Bool),
            Elementary::Real => self
                .number(node, what)
                .map(|number| Value::Lreal(rounded(number))),
            Elementary::Lreal => self.number(node, what).map(Value::Lreal),
            Elementary::Time | Elementary::Ltime => self.duration(node, what).map(Value::Time),
            _ => self
                .variable_whole(node, variable, what)
                .map(|number| variable.of_whole(number)),
        }
    }

    /// A whole number that a variable can have. As digits in quotes it may be larger than a number of
    /// JSON can be.
    fn variable_whole(&mut self, node: &Node, variable: &Variable, what: &str) -> Option<i128> {
        let (low, high) = variable.range()?;
        let number = match &node.json {
            Json::Text(text) if variable.is_wide() => text.parse::<i128>().ok(),
            _ => {
                let number = self.number(node, what)?;
                if number.abs() >= WHOLE_MAX && variable.is_wide() {
                    let message = format!("{what} is beyond 2^53, where a number of JSON is not exact");
                    let help = "write its digits in quotes: \"9007199254740993\"";
                    return self.refuse(Diagnostic::new(Code::BadValue, node.span, message).help(help));
                }
                (number == number.trunc()).then_some(number as i128)
            }
        };
        let number = number.filter(|number| (low..=high).contains(number));
        if number.is_none() {
            let message = format!("{what} must be a whole number from {low} to {high}");
            self.report(Diagnostic::new(Code::BadValue, node.span, message));
        }
        number
    }

    /// The number of an element, given by name or number.
    fn element(
        &mut self,
        node: &Node,
        variable: &Variable,
        elements: &[(String, i128)],
        what: &str,
    ) -> Option<i128> {
        let Json::Text(text) = &node.json else {
            let number = self.number(node, what)?;
            let known = elements.iter().find(|(_, known)| *known as f64 == number);
            if known.is_none() {
                let message = format!("{} has no element of this number", variable.type_name());
                let names = elements.iter().map(|(name, _)| name.as_str());
                let help = suggestion("", names);
                self.report(Diagnostic::new(Code::UnknownElement, node.span, message).maybe_help(help));
            }
            return known.map(|(_, number)| *number);
        };
        // `E_State#Idle` and `E_State.Idle` mean the same as `Idle`.
        let name = text.rsplit(['#', '.']).next().unwrap_or(text);
        let known = elements
            .iter()
            .find(|(known, _)| known.eq_ignore_ascii_case(name));
        if known.is_none() {
            let message = format!("{} has no element {}", variable.type_name(), quoted(text));
            let help = suggestion(name, elements.iter().map(|(name, _)| name.as_str()));
            self.report(Diagnostic::new(Code::UnknownElement, node.span, message).maybe_help(help));
        }
        known.map(|(_, number)| *number)
    }

    /// The exact value that a variable must have.
    pub(super) fn variable_test(&mut self, node: &Node, variable: &Variable, what: &str) -> Option<Test> {
        if let Some(elements) = variable.elements() {
            let number = self.element(node, variable, elements, what)?;
            let name = elements.iter().find(|(_, known)| *known == number);
            return name.map(|(name, _)| Test::Word(name.clone()));
        }
        if variable.is_wide() {
            let number = self.variable_whole(node, variable, what)?;
            return Some(Test::Compare(vec![Comparison::Whole(Relation::Eq, number)]));
        }
        match variable.elementary() {
            Elementary::Bool => self.boolean(node, what).map(Test::Bool),
            _ => self.variable_number(node, variable, what).map(Test::Exactly),
        }
    }

    /// A number to which a variable of up to 32 bits, or of a time, is compared. It is rounded to the variable's
    /// type; a time in ns.
    pub(super) fn variable_number(&mut self, node: &Node, variable: &Variable, what: &str) -> Option<f64> {
        match variable.elementary() {
            Elementary::Time | Elementary::Ltime => self.duration(node, what).map(|ns| ns as f64),
            Elementary::Real => self.number(node, what).map(rounded),
            Elementary::Lreal => self.number(node, what),
            _ => {
                let number = self.number(node, what)?;
                if number == number.trunc() {
                    return Some(number);
                }
                let message = format!("{what} is a whole number, which is never {number}");
                self.refuse(Diagnostic::new(Code::BadValue, node.span, message))
            }
        }
    }

    /// A comparison of a whole number of 64 bits.
    pub(super) fn wide_comparison(
        &mut self,
        (key, span): (&str, Span),
        node: &Node,
        variable: &Variable,
        what: &str,
    ) -> Option<Comparison> {
        let relation = match key {
            "le" => Relation::Le,
            "ge" => Relation::Ge,
            "lt" => Relation::Lt,
            "gt" => Relation::Gt,
            "abs_le" => Relation::AbsLe,
            _ => {
                let message =
                    format!("{what} is compared exactly: with `le`, `ge`, `lt`, `gt`, `ne` and `abs_le`");
                return self.refuse(Diagnostic::new(Code::BadValue, span, message));
            }
        };
        let number = self.variable_whole(node, variable, what)?;
        Some(Comparison::Whole(relation, number))
    }

    /// The kind of the signal at a point, for conditions.
    pub(super) fn kind_of(&self, point: Point, ty: PinType) -> Kind {
        match (point, self.variable_at(point)) {
            (Point::Symbol(program, symbol), Some(_)) => Kind::Variable(program, symbol),
            _ => Kind::Pin(ty),
        }
    }
}

/// A number as a REAL holds it.
fn rounded(number: f64) -> f64 {
    f64::from(number as f32)
}

//! Wires and their sources.

use super::formula::{Reads, expression};
use super::json::{Json, Node};
use super::names::{Entity, suggestion};
use super::{Reader, hints, shape};
use crate::error::{Code, Diagnostic, quoted};
use crate::model::{Point, Span, Wire};
use standstill_fb::PinType;

impl Reader {
    /// A wire that gives a value of type `ty`.
    pub(super) fn wire(&mut self, node: &Node, ty: PinType, what: &str) -> Option<Wire> {
        if let Json::Text(text) = &node.json
            && expression(text).is_some()
        {
            let formula = self.formula(node, text, ty, Reads::Now)?;
            return Some(Wire::From(Point::Formula(formula)));
        }
        let fields = self.fields(node, &shape::WIRE)?;
        let mut kinds = fields
            .iter()
            .filter(|(key, _)| shape::WIRE_KINDS.contains(&key.text.as_str()));
        let Some((key, value)) = kinds.next() else {
            let message = "a wire says one of `from`, `not`, `any`, `all`";
            return self.refuse(Diagnostic::new(Code::MissingKey, fields.brace(), message));
        };
        if let Some((second, _)) = kinds.next() {
            let message =
                format!("two writers on {what}: a wire says only one of `from`, `not`, `any`, `all`");
            return self.refuse(
                Diagnostic::new(Code::TwoWriters, second.span, message).related(key.span, "the other one"),
            );
        }
        if key.text == "from" {
            return self.source(value, ty, what).map(Wire::From);
        }
        if ty != PinType::Bool {
            let message = format!("{what} takes a wire with `from`: `{}` gives a BOOL", key.text);
            return self.refuse(Diagnostic::new(Code::WrongType, key.span, message));
        }
        if key.text == "not" {
            return self.source(value, ty, what).map(Wire::Not);
        }
        let items = self.list(value, &quoted(&key.text))?;
        if items.is_empty() {
            let message = format!("`{}` needs at least one source", key.text);
            return self.refuse(Diagnostic::new(Code::BadValue, value.span, message));
        }
        let points = self.each(items, |reader, item| reader.source(item, ty, what))?;
        Some(if key.text == "any" {
            Wire::Any(points)
        } else {
            Wire::All(points)
        })
    }

    /// A variable or pin of type `ty`.
    fn source(&mut self, node: &Node, ty: PinType, what: &str) -> Option<Point> {
        let text = self.text(node, "the source of a wire")?;
        if expression(text).is_some() {
            return self.formula(node, text, ty, Reads::Now).map(Point::Formula);
        }
        let (point, found) = self.point(text, node.span)?;
        if let Some(variable) = self.variable_at(point)
            && (variable.is_wide() || variable.elements().is_some())
        {
            let type_name = variable.type_name().to_owned();
            let message = format!(
                "{what} cannot be wired from {}, which is {type_name}",
                quoted(text)
            );
            return self.refuse(Diagnostic::new(Code::WrongType, node.span, message));
        }
        if found == ty {
            return Some(point);
        }
        let message = format!(
            "{what} cannot be wired from {}, which is {}",
            quoted(text),
            found.iec_name()
        );
        self.refuse(Diagnostic::new(Code::WrongType, node.span, message))
    }

    /// The variable or pin called `text`, and its type.
    pub(super) fn point(&mut self, text: &str, span: Span) -> Option<(Point, PinType)> {
        let (name, pin_name) = match text.split_once('.') {
            Some((name, pin)) => (name, Some(pin)),
            None => (text, None),
        };
        let message = match (self.names.get(name), pin_name) {
            (Some(Entity::Input(index, ty)), None) => return ty.map(|ty| (Point::Input(index), ty)),
            (Some(Entity::Input(..)), Some(_)) => {
                format!("{} is an input variable and has no pins", quoted(name))
            }
            // A block whose type was refused is already reported; its pins cannot be checked.
            (Some(Entity::Block(_, None)), Some(_)) => return None,
            (Some(Entity::Block(index, Some(block))), Some(pin_name)) => {
                if let Some((pin, info)) = block.pin(pin_name) {
                    return Some((Point::Pin(index, pin), info.ty));
                }
                let message = format!("{} has no pin {}", block.name, quoted(pin_name));
                return self.refuse(
                    Diagnostic::new(Code::UnknownPin, span, message)
                        .maybe_help(suggestion(pin_name, block.pins().map(|pin| pin.name))),
                );
            }
            (Some(Entity::Block(..)), None) => {
                format!("{} is an instance: which pin? Write `{name}.Pin`", quoted(name))
            }
            (Some(Entity::Program(index)), Some(symbol)) => return self.symbol_point(index, symbol, span),
            (Some(Entity::Program(_)), None) => {
                format!(
                    "{} is a program: which variable? Write `{name}.variable`",
                    quoted(name)
                )
            }
            (Some(Entity::Axis(_)), _) => {
                format!(
                    "{} is an axis: here an input variable or the pin of an instance must stand",
                    quoted(name)
                )
            }
            (None, _) => format!("there is no input variable or instance {}", quoted(name)),
        };
        let help = match self.names.get(name) {
            Some(Entity::Axis(_)) => pin_name.map(|signal| hints::axis_signal(signal).to_owned()),
            None if hints::logic(text).is_some() => hints::logic(text),
            None => self.name_help(name, |entity| !matches!(entity, Entity::Axis(_))),
            Some(_) => None,
        };
        self.refuse(Diagnostic::new(Code::UnknownSignal, span, message).maybe_help(help))
    }
}

/// Objects at a pin are wires, except for the use of a parameter; so are expressions.
pub(super) fn is_wire(node: &Node) -> bool {
    match &node.json {
        Json::Text(text) => expression(text).is_some(),
        Json::Map(_) => node.member("param").is_none() && node.member("table").is_none(),
        _ => false,
    }
}

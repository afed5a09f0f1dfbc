//! Instances and the constants and wires at their pins.

use super::json::Node;
use super::names::{Entity, nearest, suggestion};
use super::value::Fields;
use super::wire::is_wire;
use super::{Reader, circle, is_note, shape};
use crate::error::{Code, Diagnostic, quoted};
use crate::model::{Instance, Span, Task};
use standstill_fb::{BlockInfo, Direction, Pin, PinType};
use std::collections::BTreeMap;

/// Whether a pin must be connected. This is so for in_outs that refer to something existing. Others have a variable
/// of their own.
pub(crate) fn is_needed(pin: &Pin) -> bool {
    pin.direction == Direction::InOut && matches!(pin.ty, PinType::Axis(_))
}

impl Reader {
    pub(super) fn blocks(&mut self, fields: &Fields<'_>, tasks: Option<&[Task]>) -> Option<Vec<Instance>> {
        let node = self.require(fields, "blocks", "a script")?;
        let items = self.list(node, "`blocks`")?;
        self.check_count(items.len(), node, "blocks");
        let mut index = 0;
        let blocks = self.each(items, |reader, node| {
            let block = reader.block(index, node, tasks);
            index += 1;
            block
        })?;
        if let Some(dead) = circle::dead(&self.wires) {
            self.report(circle::error(&dead, &self.wires, &blocks));
        }
        Some(blocks)
    }

    fn block(&mut self, index: usize, node: &Node, tasks: Option<&[Task]>) -> Option<Instance> {
        let fields = self.fields(node, &shape::BLOCK)?;
        let name = self.needed(&fields, "name", "a block", Self::text);
        let task = self.task_of(&fields, tasks);
        let block = self
            .require(&fields, "type", "a block")
            .and_then(|node| self.block_info(node))?;
        let place = self.stands_at(node.span, &fields);
        let mut instance = Instance {
            place,
            left_out: false,
            name: name?.to_owned(),
            block,
            task: task?,
            constants: Vec::new(),
            wires: Vec::new(),
        };
        self.pins(index, &fields, &mut instance)?;
        Some(instance)
    }

    /// Reads the pins of instance `index` into `instance`.
    fn pins(&mut self, index: usize, fields: &Fields<'_>, instance: &mut Instance) -> Option<()> {
        let block = instance.block;
        let members = self.if_given(fields, "pins", Self::map)?;
        let mut seen: BTreeMap<usize, Span> = BTreeMap::new();
        let mut good = true;
        for (key, node) in members.iter().flat_map(Fields::iter) {
            if is_note(key, node) && block.pin("note").is_none() {
                continue;
            }
            let Some((pin_index, pin)) = self.input_pin(block, &key.text, key.span) else {
                good = false;
                continue;
            };
            if let Some(first) = seen.insert(pin_index, key.span) {
                let message = format!("two writers on the pin {}", quoted(pin.name));
                self.report(
                    Diagnostic::new(Code::TwoWriters, key.span, message)
                        .related(first, "the other one; case makes no difference"),
                );
                good = false;
            }
            // This runs for every pin of every case of a sweep: `format!` would take several times as long.
            let what = [&quoted(pin.name), " (", pin.ty.iec_name(), ")"].concat();
            if !is_wire(node) {
                let value = self.value(node, pin.ty, &what);
                good &= value.is_some();
                instance.constants.extend(value.map(|value| (pin_index, value)));
            } else if let Some(wire) = self.wire(node, pin.ty, &what) {
                self.wires
                    .insert((index, pin_index), (wire.points().to_vec(), key.span));
                instance.wires.push((pin_index, wire));
            } else {
                good = false;
            }
        }
        let unconnected = block
            .pins()
            .enumerate()
            .find(|(index, pin)| is_needed(pin) && !seen.contains_key(index));
        match unconnected {
            // With a misspelled name, the missing in_out may be the pin that was meant.
            _ if !good => None,
            None => Some(()),
            Some((_, pin)) => {
                let span = fields.entry("pins").map_or(fields.brace(), |(key, _)| key.span);
                self.missing_in_out(block, pin, span);
                None
            }
        }
    }

    fn missing_in_out(&mut self, block: &BlockInfo, pin: &Pin, span: Span) {
        let message = format!(
            "the in_out {} of {} is not connected",
            quoted(pin.name),
            block.name
        );
        let axis = self.names.of(|entity| matches!(entity, Entity::Axis(_))).next();
        let help = axis.map(|axis| format!("for example \"pins\": {{\"{}\": \"{axis}\"}}", pin.name));
        self.report(Diagnostic::new(Code::MissingPin, span, message).maybe_help(help));
    }

    fn block_info(&mut self, node: &Node) -> Option<&'static BlockInfo> {
        let name = self.text(node, "`type`")?;
        let info = standstill_blocks::registry::find(name);
        if info.is_some() {
            return info;
        }
        let help = nearest(name, standstill_blocks::REGISTRY.iter().map(|info| info.name))
            .unwrap_or_else(|| "`standstill blocks` lists those there are".to_owned());
        let message = format!("there is no block {}", quoted(name));
        self.refuse(Diagnostic::new(Code::UnknownBlock, node.span, message).help(help))
    }

    /// The in_out or input called `name`.
    fn input_pin(
        &mut self,
        block: &'static BlockInfo,
        name: &str,
        span: Span,
    ) -> Option<(usize, &'static Pin)> {
        let Some((index, pin)) = block.pin(name) else {
            let inputs = block.pins().take(block.input_count());
            let message = format!("{} has no pin {}", block.name, quoted(name));
            return self.refuse(
                Diagnostic::new(Code::UnknownPin, span, message)
                    .maybe_help(suggestion(name, inputs.map(|pin| pin.name))),
            );
        };
        if index < block.input_count() {
            return Some((index, pin));
        }
        let message = format!(
            "{} is an output of {}: only inputs are written",
            quoted(pin.name),
            block.name
        );
        self.refuse(Diagnostic::new(Code::NotWritable, span, message))
    }
}

//! Instances, their constants and wires, and the tasks that call them.

use super::json::{Json, Node};
use super::names::{Entity, suggestion};
use super::value::Fields;
use super::{Reader, is_note, shape, wiring};
use crate::error::{Code, Diagnostic, quoted};
use crate::model::{Instance, Point, Span, Task, Wire};
use standstill_fb::{BlockInfo, Direction, Pin, PinType};
use std::collections::BTreeMap;

/// The task of blocks that name none.
pub(crate) const MAIN: &str = "main";

impl Reader {
    pub(super) fn tasks(&mut self, fields: &Fields<'_>) -> Option<Vec<Task>> {
        let Some(node) = fields.get("tasks") else {
            return Some(vec![Task {
                name: MAIN.to_owned(),
                interval: Some(1),
                priority: 0,
                single: None,
                watchdog: None,
            }]);
        };
        let members = self.map(node, "`tasks`")?;
        let mut places: BTreeMap<String, Span> = BTreeMap::new();
        let mut tasks = Vec::new();
        for (key, node) in members.iter() {
            if let Some(why) = super::identifier_error(&key.text) {
                let message = format!("{} cannot be a name: {why}", quoted(&key.text));
                self.report(Diagnostic::new(Code::BadName, key.span, message));
            }
            if let Some(first) = places.insert(key.text.to_ascii_uppercase(), key.span) {
                let message = format!("the name {} is taken", quoted(&key.text));
                self.report(
                    Diagnostic::new(Code::DuplicateName, key.span, message).related(first, "by this task"),
                );
            }
            tasks.push(self.task(&key.text, node));
        }
        tasks.into_iter().collect()
    }

    fn task(&mut self, name: &str, node: &Node) -> Option<Task> {
        let fields = self.fields(node, &shape::TASK)?;
        let interval = match fields.get("interval") {
            None => Some(None),
            Some(node) => self.scans(node, "`interval`").and_then(|scans| {
                if scans == 0 {
                    let message = "`interval` must be at least one cycle";
                    self.report(Diagnostic::new(Code::BadTime, node.span, message));
                    return None;
                }
                Some(Some(scans))
            }),
        };
        let priority = match fields.get("priority") {
            None => Some(0),
            Some(node) => self.whole(node, "`priority`", 0..=i64::from(u32::MAX)),
        };
        let single = match fields.get("single") {
            None => Some(None),
            Some(node) => self.wire(node, PinType::Bool, "`single`").map(Some),
        };
        let watchdog = match fields.get("watchdog") {
            None => Some(None),
            Some(node) => self.whole(node, "`watchdog`", 1..=i64::from(u32::MAX)).map(Some),
        };
        if fields.get("interval").is_none() && fields.get("single").is_none() {
            let message = format!("the task {} would never run", quoted(name));
            self.report(
                Diagnostic::new(Code::MissingKey, fields.brace(), message)
                    .help("give it an `interval`, a `single` or both"),
            );
            return None;
        }
        Some(Task {
            name: name.to_owned(),
            interval: interval?,
            priority: u32::try_from(priority?).ok()?,
            single: single?,
            watchdog: watchdog?.and_then(|scans| u32::try_from(scans).ok()),
        })
    }

    pub(super) fn blocks(&mut self, fields: &Fields<'_>, tasks: Option<&[Task]>) -> Option<Vec<Instance>> {
        let node = self.require(fields, "blocks", "a script")?;
        let items = self.list(node, "`blocks`")?;
        self.check_count(items.len(), node, "blocks");
        let mut wires = wiring::Wires::new();
        let mut index = 0;
        let blocks = self.each(items, |reader, node| {
            let block = reader.block(index, node, tasks, &mut wires);
            index += 1;
            block
        });
        let blocks = blocks?;
        if let Some(cycle) = wiring::first_cycle(&wires) {
            self.report(wiring::cycle_error(&cycle, &wires, &blocks));
        }
        Some(blocks)
    }

    fn block(
        &mut self,
        index: usize,
        node: &Node,
        tasks: Option<&[Task]>,
        wires: &mut wiring::Wires,
    ) -> Option<Instance> {
        let fields = self.fields(node, &shape::BLOCK)?;
        let name = self
            .require(&fields, "name", "a block")
            .and_then(|node| self.text(node, "`name`"));
        let task = match fields.get("task") {
            // Without a task of that name a block that names none has nowhere to run.
            None => self.task_index(MAIN, fields.brace(), tasks),
            Some(node) => {
                let name = self.text(node, "`task`")?;
                self.task_index(name, node.span, tasks)
            }
        };
        let block = self
            .require(&fields, "type", "a block")
            .and_then(|node| self.block_info(node))?;
        let mut instance = Instance {
            name: name?.to_owned(),
            block,
            task: task?,
            constants: Vec::new(),
            wires: Vec::new(),
        };
        let mut seen: BTreeMap<usize, Span> = BTreeMap::new();
        if let Some(pins_node) = fields.get("pins") {
            let pins = self.map(pins_node, "`pins`")?;
            let mut good = true;
            for (key, node) in pins.iter() {
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
                good &= self.pin(&mut instance, index, pin_index, pin, node).is_some();
                if let Some((_, wire)) = instance.wires.iter().find(|(wired, _)| *wired == pin_index) {
                    self.wired.insert((index, pin_index), key.span);
                    wires.insert((index, pin_index), (wiring::sources(wire), key.span));
                }
            }
            if !good {
                return None;
            }
        }
        for (pin_index, pin) in block.pins().enumerate() {
            if pin.direction == Direction::InOut && !seen.contains_key(&pin_index) {
                let message = format!(
                    "the in_out {} of {} is not connected",
                    quoted(pin.name),
                    block.name
                );
                let span = fields.entry("pins").map_or(fields.brace(), |(key, _)| key.span);
                let example = self.names.of(|entity| matches!(entity, Entity::Axis(_))).next();
                let help =
                    example.map(|axis| format!("for example \"pins\": {{\"{}\": \"{axis}\"}}", pin.name));
                self.report(Diagnostic::new(Code::MissingPin, span, message).maybe_help(help));
                return None;
            }
        }
        Some(instance)
    }

    fn task_index(&mut self, name: &str, span: Span, tasks: Option<&[Task]>) -> Option<usize> {
        // Tasks that were refused are already reported.
        let tasks = tasks?;
        let index = tasks.iter().position(|task| task.name.eq_ignore_ascii_case(name));
        if index.is_none() {
            let message = format!("the script has no task {}", quoted(name));
            self.report(
                Diagnostic::new(Code::UnknownTask, span, message)
                    .maybe_help(suggestion(name, tasks.iter().map(|task| task.name.as_str()))),
            );
        }
        index
    }

    fn block_info(&mut self, node: &Node) -> Option<&'static BlockInfo> {
        let name = self.text(node, "`type`")?;
        let info = standstill_blocks::registry::find(name);
        if info.is_none() {
            let help = suggestion(name, standstill_blocks::REGISTRY.iter().map(|info| info.name))
                .filter(|help| help.starts_with("did"))
                .unwrap_or_else(|| "`standstill blocks` lists those there are".to_owned());
            let message = format!("there is no block {}", quoted(name));
            self.report(Diagnostic::new(Code::UnknownBlock, node.span, message).help(help));
        }
        info
    }

    /// The in_out or input called `name`.
    pub(super) fn input_pin(
        &mut self,
        block: &'static BlockInfo,
        name: &str,
        span: Span,
    ) -> Option<(usize, &'static Pin)> {
        let Some((index, pin)) = block.pin(name) else {
            let inputs = block.pins().take(block.input_count());
            let message = format!("{} has no pin {}", block.name, quoted(name));
            self.report(
                Diagnostic::new(Code::UnknownPin, span, message)
                    .maybe_help(suggestion(name, inputs.map(|pin| pin.name))),
            );
            return None;
        };
        if index < block.input_count() {
            return Some((index, pin));
        }
        let message = format!(
            "{} is an output of {}: only inputs are written",
            quoted(pin.name),
            block.name
        );
        self.report(Diagnostic::new(Code::NotWritable, span, message));
        None
    }

    fn pin(
        &mut self,
        instance: &mut Instance,
        _index: usize,
        pin_index: usize,
        pin: &'static Pin,
        node: &Node,
    ) -> Option<()> {
        let what = format!("{} ({})", quoted(pin.name), pin.ty.iec_name());
        if is_wire(node) {
            let wire = self.wire(node, pin.ty, &what)?;
            instance.wires.push((pin_index, wire));
        } else {
            let value = self.value(node, pin.ty, &what)?;
            instance.constants.push((pin_index, value));
        }
        Some(())
    }

    /// A wire that gives a value of type `ty`.
    pub(super) fn wire(&mut self, node: &Node, ty: PinType, what: &str) -> Option<Wire> {
        let fields = self.fields(node, &shape::WIRE)?;
        let mut kinds = fields
            .iter()
            .filter(|(key, _)| shape::WIRE_KINDS.contains(&key.text.as_str()));
        let Some((key, value)) = kinds.next() else {
            let message = "a wire says one of `from`, `not`, `any`, `all`";
            self.report(Diagnostic::new(Code::MissingKey, fields.brace(), message));
            return None;
        };
        if let Some((second, _)) = kinds.next() {
            let message =
                format!("two writers on {what}: a wire says only one of `from`, `not`, `any`, `all`");
            self.report(
                Diagnostic::new(Code::TwoWriters, second.span, message).related(key.span, "the other one"),
            );
            return None;
        }
        if key.text == "from" {
            return self.source(value, ty, what).map(Wire::From);
        }
        if ty != PinType::Bool {
            let message = format!("{what} takes a wire with `from`: `{}` gives a BOOL", key.text);
            self.report(Diagnostic::new(Code::WrongType, key.span, message));
            return None;
        }
        if key.text == "not" {
            return self.source(value, ty, what).map(Wire::Not);
        }
        let items = self.list(value, &quoted(&key.text))?;
        if items.is_empty() {
            let message = format!("`{}` needs at least one source", key.text);
            self.report(Diagnostic::new(Code::BadValue, value.span, message));
            return None;
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
        let (point, found) = self.point(text, node.span)?;
        if found == ty {
            return Some(point);
        }
        let message = format!(
            "{what} takes {}, {} is {}",
            ty.iec_name(),
            quoted(text),
            found.iec_name()
        );
        self.report(Diagnostic::new(Code::WrongType, node.span, message));
        None
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
                self.report(
                    Diagnostic::new(Code::UnknownPin, span, message)
                        .maybe_help(suggestion(pin_name, block.pins().map(|pin| pin.name))),
                );
                return None;
            }
            (Some(Entity::Block(..)), None) => {
                format!("{} is an instance: which pin? Write `{name}.Pin`", quoted(name))
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
            None => suggestion(name, self.names.of(|entity| !matches!(entity, Entity::Axis(_)))),
            Some(_) => None,
        };
        self.report(Diagnostic::new(Code::UnknownSignal, span, message).maybe_help(help));
        None
    }
}

/// Objects at a pin are wires, but for the use of a parameter.
fn is_wire(node: &Node) -> bool {
    matches!(&node.json, Json::Map(members) if members.iter().all(|(key, _)| key.text != "param"))
}

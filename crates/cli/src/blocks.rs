//! `standstill blocks`: the contents of the registry.

use crate::exit::{Exit, Failure};
use crate::json::{Object, list, number, string};
use crate::suggest::nearest;
use standstill_blocks::{BlockInstance, REGISTRY};
use standstill_fb::{AnyInstance, BlockInfo, Direction, Pin, PinType, Value};
use std::io::Write;

/// The blocks with these names, without regard to case; all without any.
fn named(names: &[String]) -> Result<Vec<&'static BlockInfo>, Failure> {
    if names.is_empty() {
        return Ok(REGISTRY.iter().collect());
    }
    let find = |name: &String| {
        let mut all = REGISTRY.iter();
        let found = all.find(|info| info.name.eq_ignore_ascii_case(name));
        found.ok_or_else(|| {
            let known = REGISTRY.iter().map(|info| info.name);
            let remedy = nearest(name, known).map_or_else(
                || "`standstill blocks` lists all".to_owned(),
                |name| format!("did you mean `{name}`?"),
            );
            Failure::usage(&format!("there is no block {name}; {remedy}"))
        })
    };
    names.iter().map(find).collect()
}

/// The registry as a JSON list, one block a line.
pub fn json(names: &[String], out: &mut dyn Write) -> Result<Exit, Failure> {
    let blocks: Vec<_> = named(names)?.into_iter().map(block).collect();
    writeln!(out, "[\n{}\n]", blocks.join(",\n"))?;
    Ok(Exit::Passed)
}

fn block(info: &BlockInfo) -> String {
    let pins = |direction| {
        let pins = info
            .pins()
            .enumerate()
            .filter(move |(_, pin)| pin.direction == direction);
        list(pins.map(|(index, entry)| pin(info, index, entry)))
    };
    Object::new()
        .with("name", string(info.name))
        .with("group", string(info.group.name()))
        .with("doc", string(info.doc.trim()))
        .with("in_outs", pins(Direction::InOut))
        .with("inputs", pins(Direction::Input))
        .with("outputs", pins(Direction::Output))
        .text()
}

fn pin(info: &BlockInfo, index: usize, pin: &Pin) -> String {
    Object::new()
        .with("name", string(pin.name))
        .with("type", string(pin.ty.iec_name()))
        .with("default", default(info, index, pin.ty))
        .with("unit", string(pin.unit))
        .with("extension", pin.extension.to_string())
        .with("doc", string(pin.doc.trim()))
        .text()
}

/// The registry as a table for people.
pub fn table(names: &[String], out: &mut dyn Write) -> Result<Exit, Failure> {
    for (index, info) in named(names)?.into_iter().enumerate() {
        if index > 0 {
            writeln!(out)?;
        }
        writeln!(
            out,
            "{}  ({})\n    {}",
            info.name,
            info.group.name(),
            info.doc.trim()
        )?;
        let name_width = widest(info.pins().map(|pin| pin.name));
        let type_width = widest(info.pins().map(|pin| pin.ty.iec_name()));
        for pin in info.pins() {
            let direction = match pin.direction {
                Direction::InOut => "in_out",
                Direction::Input => "in",
                Direction::Output => "out",
            };
            let (name, ty) = (pin.name, pin.ty.iec_name());
            let unit = if pin.unit.is_empty() {
                String::new()
            } else {
                format!(" ({})", pin.unit)
            };
            let vendor = if pin.extension { " [extension]" } else { "" };
            let doc = pin.doc.trim();
            writeln!(
                out,
                "    {direction:<6}  {name:<name_width$}  {ty:<type_width$}  {doc}{unit}{vendor}"
            )?;
        }
    }
    Ok(Exit::Passed)
}

fn widest<'a>(texts: impl Iterator<Item = &'a str>) -> usize {
    texts.map(str::len).max().unwrap_or(0)
}

/// The default of a pin of a new instance, as JSON.
fn default(info: &BlockInfo, index: usize, ty: PinType) -> String {
    let value = BlockInstance::new(info.name).and_then(|instance| instance.get(index));
    match value {
        // An axis must be wired.
        None | Some(Value::Axis(_)) => "null".to_owned(),
        Some(Value::Bool(value)) => value.to_string(),
        Some(Value::Int(value)) => value.to_string(),
        Some(Value::Word(value)) => value.to_string(),
        Some(Value::Dword(value)) => value.to_string(),
        // Without records.
        Some(Value::Table(_)) => "[]".to_owned(),
        Some(Value::Lreal(value)) => number(value),
        Some(Value::Time(ns)) => string(&time(ns)),
        Some(Value::Enum(value)) => match ty {
            PinType::Enum(info) => info.name_of(value).map_or_else(|| value.to_string(), string),
            _ => value.to_string(),
        },
    }
}

/// A TIME literal in the largest unit that keeps it whole.
fn time(ns: i64) -> String {
    let units = [(1_000_000_000, "s"), (1_000_000, "ms"), (1_000, "us")];
    let (size, unit) = units
        .into_iter()
        .find(|(size, _)| ns % size == 0)
        .unwrap_or((1, "ns"));
    format!("T#{}{unit}", ns / size)
}

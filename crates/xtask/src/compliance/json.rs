//! The statement as data: one object, with one pin, parameter or type on each line.

use super::page::{NATURE, STANDARD, TRADEMARK};
use super::types::TypeRow;
use super::{Compliance, ParameterRow, Row, Statement};
use serde_json::Value;
use standstill_fb::Direction;

pub fn json(compliance: &Compliance) -> String {
    let parts = [
        field("statement", NATURE),
        field("trademark", TRADEMARK),
        field("standard", STANDARD),
        field("supplier", "the standstill contributors"),
        field("product", "standstill"),
        field("version", env!("CARGO_PKG_VERSION")),
        flag("certified", false),
        list(
            "elementary_types",
            2,
            compliance.elementary().iter().map(data_type),
        ),
        list("derived_types", 2, compliance.derived().iter().map(data_type)),
        list("blocks", 2, compliance.blocks.iter().map(block)),
        list("parameters", 2, compliance.parameters.iter().map(parameter)),
        list(
            "vendor_blocks",
            2,
            compliance.vendor_blocks().map(|info| text(info.name)),
        ),
    ];
    format!("{{\n  {}\n}}\n", parts.join(",\n  "))
}

fn text(value: &str) -> String {
    Value::from(value).to_string()
}

fn field(name: &str, value: &str) -> String {
    format!("\"{name}\": {}", text(value))
}

fn flag(name: &str, value: bool) -> String {
    format!("\"{name}\": {value}")
}

fn object<const N: usize>(fields: [String; N]) -> String {
    format!("{{{}}}", fields.join(", "))
}

fn list(name: &str, indent: usize, items: impl Iterator<Item = String>) -> String {
    let space = " ".repeat(indent);
    let items: Vec<_> = items.map(|item| format!("\n{space}  {item}")).collect();
    format!("\"{name}\": [{}\n{space}]", items.join(","))
}

fn data_type(row: &TypeRow) -> String {
    object([
        field("type", &row.name),
        flag("supported", row.supported),
        field("comment", &row.remark),
    ])
}

fn block(block: &Statement) -> String {
    object([
        field("block", &block.name),
        flag("multi_axis", block.is_multi_axis),
        flag("supported", block.info.is_some()),
        field("comment", &block.remark),
        list("pins", 4, block.rows.iter().map(pin)),
    ])
}

fn pin(row: &Row) -> String {
    let kind = match row.kind {
        Direction::InOut => "VAR_IN_OUT",
        Direction::Input => "VAR_INPUT",
        Direction::Output => "VAR_OUTPUT",
    };
    let or_null = |value: Option<&str>| value.map_or("null".into(), text);
    object([
        field("pin", &row.name),
        field("kind", kind),
        field("mark", &row.mark.to_string()),
        format!(
            "\"standard_type\": {}",
            or_null(Some(&*row.standard).filter(|ty| !ty.is_empty()))
        ),
        format!("\"type\": {}", or_null(row.here)),
        flag("supported", row.supported),
        field("comment", &row.remark),
    ])
}

fn parameter(row: &ParameterRow) -> String {
    let known = &row.parameter;
    object([
        format!("\"number\": {}", known.number),
        field("name", &known.name),
        field("type", if known.is_bool { "BOOL" } else { "REAL" }),
        field("mark", if known.basic { "B" } else { "E" }),
        field("access", if known.writable { "R/W" } else { "R" }),
        flag("readable", row.readable),
        flag("writable", row.writable),
        flag("supported", row.supported()),
        field("comment", &row.remark),
    ])
}

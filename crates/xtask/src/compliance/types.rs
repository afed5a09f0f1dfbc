//! The data types of the statement.

use super::{Compliance, joined};
use standstill_blocks::REGISTRY;
use standstill_fb::{BlockInfo, PinType};
use std::collections::BTreeSet;

/// A line of the tables of data types.
#[derive(Debug)]
pub struct TypeRow {
    pub name: String,
    pub supported: bool,
    pub remark: String,
}

impl Compliance {
    /// Elementary types: whether a pin of the registry has it, and its replacement.
    pub fn elementary(&self) -> Vec<TypeRow> {
        self.standard
            .elementary
            .iter()
            .map(|name| {
                let supported = REGISTRY.iter().flat_map(BlockInfo::pins).any(|pin| match pin.ty {
                    PinType::Enum(_) => name == "ENUM",
                    ty => ty.iec_name() == name,
                });
                let instead = self.used_instead(name);
                let remark = match instead.is_empty() {
                    false => Vec::from_iter(instead).join(", "),
                    true if supported => String::new(),
                    true => "no block that uses it is offered yet".into(),
                };
                TypeRow {
                    name: name.clone(),
                    supported,
                    remark,
                }
            })
            .collect()
    }

    /// The types that pins have here whose type is this one in the standard.
    fn used_instead(&self, name: &str) -> BTreeSet<&str> {
        let rows = self.blocks.iter().flat_map(|block| &block.rows);
        rows.filter(|row| row.standard == name)
            .filter_map(|row| row.here)
            .filter(|here| *here != name)
            .collect()
    }

    /// Derived types: whether a pin of the registry has it, and its definition.
    pub fn derived(&self) -> Vec<TypeRow> {
        self.standard
            .derived
            .iter()
            .map(|name| {
                let mut pins = REGISTRY.iter().flat_map(BlockInfo::pins);
                let pin = pins.find(|pin| pin.ty.iec_name() == name);
                let elements = match pin.map(|pin| pin.ty) {
                    Some(PinType::Enum(info)) => info
                        .elements
                        .iter()
                        .map(|(name, number)| format!("{number} {name}"))
                        .collect::<Vec<_>>()
                        .join(", "),
                    Some(PinType::Table(info)) => {
                        let fields: Vec<_> = info.fields.iter().map(|field| field.name).collect();
                        format!("array of {}", fields.join(", "))
                    }
                    _ => Vec::from_iter(self.used_instead(name)).join(", "),
                };
                let remark = self.standard.remark(name).map(|remark| remark.text.clone());
                TypeRow {
                    name: name.clone(),
                    supported: pin.is_some(),
                    remark: joined([elements, remark.unwrap_or_default()]),
                }
            })
            .collect()
    }

    /// Blocks of the standard with a pin of this type.
    pub fn users(&self, ty: &str) -> Vec<&str> {
        self.standard
            .blocks()
            .filter(|block| block.pins.iter().any(|pin| pin.ty == ty))
            .map(|block| block.name.as_str())
            .collect()
    }
}

//! `docs/compliance.md` and `docs/compliance.json`: the standard's catalogue beside the registry.
//!
//! The catalogue is our own data in `crates/xtask/standard`; the supported part follows from the registry
//! and from calls of its blocks. Nothing here names a block of the registry.

mod json;
mod page;
mod probe;
mod standard;
mod types;

use crate::Generated;
use standard::{Parameter, Standard, StandardBlock, StandardPin};
use standstill_blocks::{REGISTRY, registry::find};
use standstill_fb::{BlockInfo, Direction, Pin, PinType};

/// The three kinds of pins in the order of the form.
const KINDS: [(Direction, &str); 3] = [
    (Direction::InOut, "VAR_IN_OUT"),
    (Direction::Input, "VAR_INPUT"),
    (Direction::Output, "VAR_OUTPUT"),
];

/// A line of a block's table.
#[derive(Debug)]
struct Row {
    /// `B`, `E`, or `V` for a pin that the standard does not have.
    mark: char,
    kind: Direction,
    name: String,
    /// The standard's type; empty for `V`.
    standard: String,
    /// The type here, if there is such a pin.
    here: Option<&'static str>,
    supported: bool,
    remark: String,
}

/// A block's table.
#[derive(Debug)]
struct Statement {
    name: String,
    is_multi_axis: bool,
    /// The block of the registry, if there is one.
    info: Option<&'static BlockInfo>,
    remark: String,
    rows: Vec<Row>,
}

/// A line of the table of parameters.
#[derive(Debug)]
struct ParameterRow {
    parameter: Parameter,
    readable: bool,
    writable: bool,
    remark: String,
}

impl ParameterRow {
    fn supported(&self) -> bool {
        self.readable && (self.writable || !self.parameter.writable)
    }
}

/// The whole statement.
#[derive(Debug)]
pub struct Compliance {
    standard: Standard,
    blocks: Vec<Statement>,
    parameters: Vec<ParameterRow>,
}

impl Compliance {
    /// Compares the catalogue with the registry; runs every block a few times.
    pub fn read() -> Self {
        Self::of(Standard::read())
    }

    fn of(standard: Standard) -> Self {
        let parameters = standard
            .parameters
            .iter()
            .map(|known| parameter_row(&standard, known));
        let single = standard.single_axis.iter().map(|block| (block, false));
        let multi = standard.multi_axis.iter().map(|block| (block, true));
        let blocks = single.chain(multi);
        Self {
            parameters: parameters.collect(),
            blocks: blocks
                .map(|(block, is_multi_axis)| statement(&standard, block, is_multi_axis))
                .collect(),
            standard,
        }
    }

    /// The faults of the statement: a block without a B pin; a pin that is neither the standard's nor
    /// marked as an extension; a pin of another kind, place or type than the standard's; a comment on
    /// nothing.
    pub fn problems(&self) -> Vec<String> {
        let mut found = Vec::new();
        for block in &self.blocks {
            if let (Some(info), Some(known)) =
                (block.info, self.standard.blocks().find(|b| b.name == block.name))
            {
                self.problems_of_block(&mut found, block, info, known);
            }
        }
        for block in &self.blocks {
            if block.info.is_none() {
                found.push(format!("{}: it is of the standard, and is not built", block.name));
            }
        }
        for remark in &self.standard.remarks {
            if !self.standard.knows(&remark.subject) {
                found.push(format!("remarks.txt: {} is not in the catalogue", remark.subject));
            }
        }
        found
    }

    fn problems_of_block(
        &self,
        found: &mut Vec<String>,
        block: &Statement,
        info: &BlockInfo,
        known: &StandardBlock,
    ) {
        for row in &block.rows {
            let pin = format!("{}.{}", block.name, row.name);
            if row.mark == 'B' && !row.supported {
                found.push(format!(
                    "{pin} is a B pin: without it the block cannot be offered"
                ));
            }
            let explained = self.standard.remark(&pin).is_some();
            if row.here.is_some_and(|here| !is_type_of(&row.standard, here)) && row.mark != 'V' && !explained
            {
                found.push(format!(
                    "{pin} is {} where the standard has {}: say why in crates/xtask/standard/remarks.txt",
                    row.here.unwrap_or_default(),
                    row.standard
                ));
            }
        }
        let is_known = |pin: &&Pin| known.pins.iter().any(|other| is_same(other, pin));
        for pin in info.pins().filter(|pin| pin.extension == is_known(pin)) {
            found.push(format!(
                "{}.{} is {}",
                block.name,
                pin.name,
                if pin.extension {
                    "marked as an extension, and the standard has it"
                } else {
                    "not marked as an extension, and the standard has no such pin there"
                }
            ));
        }
        let here: Vec<_> = info.pins().filter(is_known).map(|pin| pin.name).collect();
        let there = known.pins.iter().map(|pin| pin.name.as_str());
        if here != there.filter(|name| here.contains(name)).collect::<Vec<_>>() {
            found.push(format!(
                "{}: the pins do not stand in the standard's order",
                block.name
            ));
        }
    }

    /// The page and the data.
    pub fn pages(&self) -> [Generated; 2] {
        [
            Generated {
                path: "docs/compliance.md".into(),
                text: page::page(self),
            },
            Generated {
                path: "docs/compliance.json".into(),
                text: json::json(self),
            },
        ]
    }

    /// Blocks of the registry that Part 1 and 2 of the standard do not have.
    fn vendor_blocks(&self) -> impl Iterator<Item = &'static BlockInfo> {
        REGISTRY
            .iter()
            .filter(|info| self.standard.blocks().all(|block| block.name != info.name))
    }
}

fn is_same(standard: &StandardPin, pin: &Pin) -> bool {
    standard.name == pin.name && standard.kind == pin.direction
}

/// Whether a pin may have this type without a comment: the standard leaves the width of REAL and WORD
/// open.
fn is_type_of(standard: &str, here: &str) -> bool {
    let wider: &[&str] = match standard {
        "REAL" => &["LREAL"],
        "WORD" => &["DWORD"],
        _ => &[],
    };
    standard == here || wider.contains(&here)
}

fn joined<const N: usize>(parts: [String; N]) -> String {
    let parts: Vec<_> = parts.into_iter().filter(|part| !part.is_empty()).collect();
    parts.join("; ")
}

fn statement(standard: &Standard, block: &StandardBlock, is_multi_axis: bool) -> Statement {
    let info = find(&block.name).filter(|info| info.name == block.name);
    let mut rows = Vec::new();
    for (kind, _) in KINDS {
        let known = block.pins.iter().filter(|pin| pin.kind == kind);
        rows.extend(known.map(|pin| row(standard, block, info, pin)));
        let ours = info.into_iter().flat_map(|info| info.pins_of(kind));
        rows.extend(ours.filter(|pin| pin.extension).map(|pin| Row {
            mark: 'V',
            kind,
            name: pin.name.into(),
            standard: String::new(),
            here: Some(pin.ty.iec_name()),
            supported: true,
            remark: pin.doc.trim().into(),
        }));
    }
    let remark = standard.remark(&block.name).map(|remark| remark.text.clone());
    Statement {
        name: block.name.clone(),
        is_multi_axis,
        info,
        remark: remark.unwrap_or_else(|| info.map_or("", |info| info.doc.trim()).into()),
        rows,
    }
}

fn row(standard: &Standard, block: &StandardBlock, info: Option<&BlockInfo>, known: &StandardPin) -> Row {
    let pin = info.and_then(|info| info.pins().find(|pin| is_same(known, pin)));
    let here = pin.map(|pin| pin.ty.iec_name());
    let (mut supported, mut remark) = (pin.is_some(), String::new());
    if let (Some(info), Some(pin)) = (info, pin) {
        let refused = probe::refused(info, pin);
        // A BOOL with only one permitted value is no input; an enumeration may lack elements.
        supported = pin.ty != PinType::Bool || refused.is_empty();
        let refused = refused
            .iter()
            .map(|(value, id)| format!("{value}: not yet, ErrorID {}", id.number()));
        let ours = standard.remark_on_pin(&block.name, &known.name);
        supported &= ours.is_none_or(|ours| !ours.refuses);
        remark = joined([
            here.filter(|here| **here != *known.ty)
                .unwrap_or_default()
                .to_owned(),
            ours.map_or("", |ours| &ours.text).to_owned(),
            refused.collect::<Vec<_>>().join(", "),
        ]);
    }
    Row {
        mark: if known.basic { 'B' } else { 'E' },
        kind: known.kind,
        name: known.name.clone(),
        standard: known.ty.clone(),
        here,
        supported,
        remark,
    }
}

fn parameter_row(standard: &Standard, known: &Parameter) -> ParameterRow {
    let (reader, writer, value) = match known.is_bool {
        true => ("MC_ReadBoolParameter", "MC_WriteBoolParameter", "true"),
        false => ("MC_ReadParameter", "MC_WriteParameter", "1"),
    };
    let number = known.number.to_string();
    let answers = |block: &str, output: &str| {
        let values = [("ParameterNumber", number.as_str()), ("Value", value)];
        find(block).is_some_and(|info| probe::rises(info, &values, output))
    };
    let remark = standard.remark(&known.name);
    let offered = remark.is_none_or(|remark| !remark.refuses);
    let missing = match (find(reader), find(writer)) {
        (None, _) => format!("{reader} is not offered yet"),
        (_, None) if known.writable => format!("{writer} is not offered yet"),
        _ => String::new(),
    };
    ParameterRow {
        parameter: known.clone(),
        readable: offered && answers(reader, "Valid"),
        writable: offered && known.writable && answers(writer, "Done"),
        remark: joined([remark.map_or("", |remark| &remark.text).to_owned(), missing]),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    fn problems(edit: impl Fn(&mut Standard)) -> String {
        let mut standard = Standard::read();
        edit(&mut standard);
        Compliance::of(standard).problems().join("\n")
    }

    fn halt(standard: &mut Standard) -> &mut StandardBlock {
        let mut blocks = standard.single_axis.iter_mut();
        blocks.find(|block| block.name == "MC_Halt").unwrap()
    }

    #[test]
    fn the_catalogue_has_45_blocks_and_every_type_it_uses() {
        let standard = Standard::read();
        assert_eq!((standard.single_axis.len(), standard.multi_axis.len()), (36, 9));
        assert_eq!(standard.parameters.len(), 17);
        let types: BTreeSet<_> = standard.elementary.iter().chain(&standard.derived).collect();
        for pin in standard.blocks().flat_map(|block| &block.pins) {
            assert!(types.contains(&pin.ty), "{}", pin.ty);
        }
    }

    #[test]
    fn each_kind_of_problem_is_found() {
        let pin = |basic, name: &str, ty: &str| StandardPin {
            kind: Direction::Input,
            basic,
            name: name.into(),
            ty: ty.into(),
        };
        assert_eq!(problems(|_| {}), "");
        assert_eq!(
            problems(|standard| halt(standard).pins.push(pin(false, "More", "BOOL"))),
            ""
        );
        let b_pin = problems(|standard| halt(standard).pins.push(pin(true, "More", "BOOL")));
        assert!(b_pin.contains("MC_Halt.More is a B pin"), "{b_pin}");
        let refused = problems(|standard| {
            standard.remarks.push(standard::Remark {
                refuses: true,
                subject: "MC_Halt.Execute".into(),
                text: "not yet".into(),
            });
        });
        assert!(refused.contains("MC_Halt.Execute is a B pin"), "{refused}");
        let unknown = problems(|standard| halt(standard).pins.retain(|pin| pin.name != "Jerk"));
        assert!(unknown.contains("MC_Halt.Jerk is not marked"), "{unknown}");
        let marked = problems(|standard| halt(standard).pins.push(pin(false, "Snap", "REAL")));
        assert!(marked.contains("MC_Halt.Snap is marked"), "{marked}");
        let moved = problems(|standard| halt(standard).pins.swap(2, 3));
        assert!(moved.contains("MC_Halt: the pins do not stand"), "{moved}");
        let ty = problems(|standard| halt(standard).pins[1].ty = "INT".into());
        assert!(ty.contains("MC_Halt.Execute is BOOL where"), "{ty}");
        let nothing = problems(|standard| standard.derived.clear());
        assert!(nothing.contains("AXIS_REF is not in the catalogue"), "{nothing}");
    }

    /// The data alone are enough to judge the statement.
    #[test]
    fn every_supported_row_of_the_data_is_a_pin_and_every_b_row_of_an_offered_block_is_supported() {
        let [_, data] = Compliance::read().pages();
        let data: serde_json::Value = serde_json::from_str(&data.text).unwrap();
        assert_eq!(data["certified"], false);
        let blocks = data["blocks"].as_array().unwrap();
        for block in blocks {
            let info = find(block["block"].as_str().unwrap());
            assert_eq!(block["supported"], info.is_some(), "{block}");
            for pin in block["pins"].as_array().unwrap() {
                let there = info.and_then(|info| info.pin(pin["pin"].as_str().unwrap()));
                let ty = there.map_or("", |(_, pin)| pin.ty.iec_name());
                assert_eq!(pin["type"].as_str().unwrap_or(""), ty, "{pin}");
                assert!(there.is_some() || pin["supported"] == false, "{pin}");
                assert!(
                    info.is_none() || pin["mark"] != "B" || pin["supported"] == true,
                    "{pin}"
                );
            }
        }
        let offered = blocks.iter().filter(|block| block["supported"] == true).count();
        let vendors = data["vendor_blocks"].as_array().unwrap().len();
        assert_eq!(offered + vendors, REGISTRY.len());
    }
}

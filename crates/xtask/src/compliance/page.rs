//! The statement as a page.

use super::types::TypeRow;
use super::{Compliance, KINDS, Statement};
use crate::NOTICE;
use std::fmt::Write;

/// Name and version of the standard, for page and data.
pub const STANDARD: &str =
    "PLCopen TC2, Function blocks for motion control, Part 1 and 2, version 2.0 (2011)";

/// The nature of the statement, for page and data.
pub const NATURE: &str = "A self-declaration, assessed by the project itself and by nobody else. It is not a \
                          certificate and was not submitted to PLCopen.";

/// The owner of the name.
pub const TRADEMARK: &str = "PLCopen is a trademark of its owner, the PLCopen association. standstill is not \
                             affiliated with it, and shows no logo of it.";

pub fn page(compliance: &Compliance) -> String {
    let offered = compliance
        .blocks
        .iter()
        .filter(|block| block.info.is_some())
        .count();
    let mut text = format!(
        "{NOTICE}# Compliance statement\n\n\
         {NATURE}\n\n\
         {TRADEMARK}\n\n\
         | | |\n| --- | --- |\n\
         | product | standstill {} |\n\
         | supplier | the standstill contributors; no company, no representative, no signature |\n\
         | modelled on | {STANDARD} |\n\
         | blocks offered | {offered} of {} |\n\
         | the same as data | [compliance.json](compliance.json) |\n\n\
         The catalogue of the standard stands in `crates/xtask/standard`; what is supported follows from the\n\
         registry of blocks and from calls of them. A test fails when a block is offered without one of its basic\n\
         pins, or a pin is neither the standard's nor marked as an extension. What was chosen where the standard\n\
         leaves a choice: [requirements/vendor-choices.md](requirements/vendor-choices.md). What values each pin\n\
         takes: [bad-input.md](bad-input.md).\n\n\
         Marks: B basic, every block that is offered must have the pin; E extended, may be missing; V a pin of ours\n\
         that the standard does not have.\n",
        env!("CARGO_PKG_VERSION"),
        compliance.blocks.len()
    );
    types(&mut text, compliance);
    overview(&mut text, compliance);
    text.push_str("\n## Pins\n");
    for block in &compliance.blocks {
        pins(&mut text, block);
    }
    parameters(&mut text, compliance);
    vendor_blocks(&mut text, compliance);
    text
}

fn yes(supported: bool) -> &'static str {
    if supported { "Y" } else { "N" }
}

fn types(text: &mut String, compliance: &Compliance) {
    text.push_str(
        "\n## Data types\n\n| data type | supported | if not, type used instead |\n| --- | --- | --- |\n",
    );
    for TypeRow {
        name,
        supported,
        remark,
    } in compliance.elementary()
    {
        let _ = writeln!(text, "| {name} | {} | {remark} |", yes(supported));
    }
    text.push_str(
        "\n## Derived data types\n\n| derived type | where used | supported | structure |\n| --- | --- | --- | --- |\n",
    );
    for TypeRow {
        name,
        supported,
        remark,
    } in compliance.derived()
    {
        let users = compliance.users(&name);
        let users = match users.len() {
            0..9 => users.join(", "),
            count => format!("{count} blocks"),
        };
        let _ = writeln!(text, "| {name} | {users} | {} | {remark} |", yes(supported));
    }
}

fn overview(text: &mut String, compliance: &Compliance) {
    text.push_str("\n## Overview\n");
    for (title, is_multi_axis) in [("Single-axis", false), ("Multi-axis", true)] {
        let _ = write!(
            text,
            "\n| {title} function block | supported as | comment |\n| --- | --- | --- |\n"
        );
        for block in compliance
            .blocks
            .iter()
            .filter(|block| block.is_multi_axis == is_multi_axis)
        {
            let (name, link) = (&block.name, block.name.to_lowercase());
            let _ = match block.info {
                Some(_) => writeln!(text, "| [{name}](blocks/{link}.md) | V2.0 | {} |", block.remark),
                None => writeln!(text, "| {name} | Not | {} |", block.remark),
            };
        }
    }
}

fn pins(text: &mut String, block: &Statement) {
    let not = match block.info {
        Some(_) => "",
        None => ": not supported",
    };
    let _ = write!(
        text,
        "\n### {}{not}\n\n| B/E/V | pin | type | supported | comment |\n| --- | --- | --- | --- | --- |\n",
        block.name
    );
    for (kind, title) in KINDS {
        let mut rows = block.rows.iter().filter(|row| row.kind == kind).peekable();
        if rows.peek().is_some() {
            let _ = writeln!(text, "| | *{title}* | | | |");
        }
        for row in rows {
            let ty = match row.mark {
                'V' => row.here.unwrap_or_default(),
                _ => &row.standard,
            };
            let _ = writeln!(
                text,
                "| {} | {} | {ty} | {} | {} |",
                row.mark,
                row.name,
                yes(row.supported),
                row.remark
            );
        }
    }
}

fn parameters(text: &mut String, compliance: &Compliance) {
    text.push_str(
        "\n## Parameters\n\n| number | name | type | B/E | R/W | supported | comment |\n\
         | ---: | --- | --- | --- | --- | --- | --- |\n",
    );
    for row in &compliance.parameters {
        let known = &row.parameter;
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} | {} |",
            known.number,
            known.name,
            if known.is_bool { "BOOL" } else { "REAL" },
            if known.basic { "B" } else { "E" },
            if known.writable { "R/W" } else { "R" },
            yes(row.supported()),
            row.remark
        );
    }
}

fn vendor_blocks(text: &mut String, compliance: &Compliance) {
    text.push_str(
        "\n## Blocks beside the standard\n\n\
         Not in Part 1 and 2: function blocks of IEC 61131-3 that scan scripts wire conditions with, and blocks of\n\
         ours.\n\n\
         | block | group | what it does |\n| --- | --- | --- |\n",
    );
    for info in compliance.vendor_blocks() {
        let _ = writeln!(
            text,
            "| [{}](blocks/{}.md) | {} | {} |",
            info.name,
            info.name.to_lowercase(),
            info.group.name(),
            info.doc.trim()
        );
    }
}

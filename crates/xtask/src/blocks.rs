//! `docs/blocks/`: one page per block and an index, from the registry.

use crate::{Generated, NOTICE};
use standstill_blocks::REGISTRY;
use standstill_fb::{BlockInfo, Direction, Pin, PinType, Value};
use std::fmt::Write;

pub fn pages() -> Vec<Generated> {
    let mut files: Vec<_> = REGISTRY.iter().map(page).collect();
    files.push(index());
    files
}

fn file_name(info: &BlockInfo) -> String {
    format!("{}.md", info.name.to_lowercase())
}

fn index() -> Generated {
    let mut text = format!(
        "{NOTICE}# Function blocks\n\n\
         The same list as data: `standstill blocks --json`.\n\n\
         | block | group | what it does |\n| --- | --- | --- |\n"
    );
    for info in REGISTRY {
        let group = info.group.name();
        let _ = writeln!(
            text,
            "| [{}]({}) | {group} | {} |",
            info.name,
            file_name(info),
            info.doc
        );
    }
    Generated {
        path: "docs/blocks/README.md".into(),
        text,
    }
}

fn page(info: &BlockInfo) -> Generated {
    let mut text = format!(
        "{NOTICE}# {}\n\n{}\n\nGroup: {}.\n",
        info.name,
        info.doc,
        info.group.name()
    );
    let kinds = [
        ("In_outs", Direction::InOut),
        ("Inputs", Direction::Input),
        ("Outputs", Direction::Output),
    ];
    for (title, direction) in kinds {
        let mut pins = info
            .pins()
            .enumerate()
            .filter(|(_, pin)| pin.direction == direction)
            .peekable();
        if pins.peek().is_none() {
            continue;
        }
        let _ = write!(
            text,
            "\n## {title}\n\n| pin | type | default | unit | meaning |\n| --- | --- | --- | --- | --- |\n"
        );
        for (index, pin) in pins {
            let vendor = if pin.extension {
                " Not in the standard."
            } else {
                ""
            };
            let _ = writeln!(
                text,
                "| {} | {} | {} | {} | {}{vendor} |",
                pin.name,
                pin.ty.iec_name(),
                default(info, index, pin),
                pin.unit,
                pin.doc.trim()
            );
        }
    }
    Generated {
        path: format!("docs/blocks/{}", file_name(info)),
        text,
    }
}

fn default(info: &BlockInfo, index: usize, pin: &Pin) -> String {
    if pin.direction != Direction::Input {
        return String::new();
    }
    match (info.default_of(index), pin.ty) {
        (Some(Value::Bool(value)), _) => if value { "TRUE" } else { "FALSE" }.into(),
        (Some(Value::Int(value)), _) => value.to_string(),
        (Some(Value::Lreal(value)), _) => format!("{value:?}"),
        (Some(Value::Word(value)), _) => value.to_string(),
        (Some(Value::Time(ns)), _) => format!("T#{}ms", ns / 1_000_000),
        (Some(Value::Enum(number)), PinType::Enum(info)) => info.name_of(number).unwrap_or("").into(),
        (Some(Value::Axis(_) | Value::Enum(_)) | None, _) => String::new(),
    }
}

//! `docs/blocks/`: one page per block and an index, from the registry.

use crate::pictures::Picture;
use crate::{Generated, NOTICE, Requirements};
use standstill_blocks::REGISTRY;
use standstill_fb::{BlockInfo, Direction, Pin, PinType, Value};
use std::collections::BTreeMap;
use std::fmt::Write;

pub fn pages(requirements: &Requirements, pictures: &BTreeMap<String, Picture>) -> Vec<Generated> {
    let mut files: Vec<_> = REGISTRY
        .iter()
        .map(|info| {
            let mut page = page(info);
            if let Some(picture) = pictures.get(info.name) {
                in_time(&mut page.text, picture);
            }
            rules(&mut page.text, info, requirements);
            page
        })
        .collect();
    files.push(index());
    files
}

/// The timing picture, with the script from which it is drawn.
fn in_time(text: &mut String, picture: &Picture) {
    let Picture { script, title, .. } = picture;
    let file = picture.path();
    let file = file.rsplit('/').next().unwrap_or_default();
    let _ = write!(
        text,
        "\n## In time\n\n![{title}]({file})\n\n{title}.\n\nDrawn from [the script](../../{script}); run it with\n\n    \
         cargo run --release -- run {script}\n"
    );
}

/// The rules of the block, and the differences of vendors.
fn rules(text: &mut String, info: &BlockInfo, requirements: &Requirements) {
    let rules = requirements.of_block(info.name);
    let (vendors, standard): (Vec<_>, Vec<_>) =
        rules.into_iter().partition(|rule| rule.area == "vendor-choices");
    let parts = [
        ("Rules", "Each id leads to its tests.", standard),
        ("Where vendors differ", "What is done here.", vendors),
    ];
    for (title, about, rules) in parts {
        if rules.is_empty() {
            continue;
        }
        let _ = write!(
            text,
            "\n## {title}\n\n{about}\n\n| id | in short |\n| --- | --- |\n"
        );
        for rule in rules {
            let _ = writeln!(
                text,
                "| [{}](../requirements/{}.md) | {} |",
                rule.id, rule.area, rule.text
            );
        }
    }
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
    tables(&mut text, info);
    Generated {
        path: format!("docs/blocks/{}", file_name(info)),
        text,
    }
}

/// The records of the block's tables.
fn tables(text: &mut String, info: &BlockInfo) {
    for pin in info.pins() {
        let PinType::Table(table) = pin.ty else { continue };
        let _ = write!(
            text,
            "\n## {}\n\nAt most {} records of these fields; in a script a list of objects, and what is left out of one is \
             0.\n\n| field | type | unit | meaning |\n| --- | --- | --- | --- |\n",
            table.name, table.most
        );
        for field in table.fields {
            let (ty, doc) = (field.ty.iec_name(), field.doc.trim());
            let _ = writeln!(text, "| {} | {ty} | {} | {doc} |", field.name, field.unit);
        }
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
        (Some(Value::Dword(value)), _) => value.to_string(),
        (Some(Value::Time(ns)), _) => format!("T#{}ms", ns / 1_000_000),
        (Some(Value::Enum(number)), PinType::Enum(info)) => info.name_of(number).unwrap_or("").into(),
        (Some(Value::Axis(_) | Value::Enum(_) | Value::Table(_)) | None, _) => String::new(),
    }
}

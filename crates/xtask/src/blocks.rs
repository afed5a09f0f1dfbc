//! `docs/blocks/`: one page per block and an index, from the registry.

use crate::guides::guides;
use crate::pictures::Picture;
use crate::{Faults, Generated, NOTICE, Requirements, bad_input};
use standstill_axis::ErrorId;
use standstill_blocks::REGISTRY;
use standstill_fb::{BlockInfo, Direction, Pin, PinType, Value};
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

pub fn pages(
    requirements: &Requirements,
    pictures: &BTreeMap<String, Picture>,
    faults: &Faults,
) -> Vec<Generated> {
    let seen = faults.by_block();
    let guides = guides();
    let mut files: Vec<_> = REGISTRY
        .iter()
        .map(|info| {
            let more = guides.get(info.name).map_or("", String::as_str);
            let mut page = page(info, more);
            errors(&mut page.text, info, &seen, faults);
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
        "\n## In time\n\n![{title}]({file})\n\n{title}.\n\nDrawn from [the script](../../{script}); run it in the folder of the \
         repository with\n\n    standstill run {script}\n"
    );
}

/// The ErrorIDs that tests see at the block: with bad input, and in scan scripts.
fn errors(text: &mut String, info: &BlockInfo, seen: &BTreeMap<(String, u16), String>, faults: &Faults) {
    if info.pin("ErrorID").is_none() {
        return;
    }
    let mut found: BTreeMap<u16, BTreeSet<String>> = BTreeMap::new();
    for pin in info.pins().filter(|pin| matches!(pin.ty, PinType::Axis(_))) {
        let number = ErrorId::AxisUnknown.number();
        found.entry(number).or_default().insert(format!("`{}`", pin.name));
    }
    let of_block = |table| {
        let rows = bad_input::table(table).into_iter();
        rows.filter(|row| row.first().is_some_and(|block| block == info.name))
    };
    for row in of_block("pins") {
        for cell in row.iter().skip(2).filter_map(|cell| cell.parse().ok()) {
            found.entry(cell).or_default().insert(format!("`{}`", row[1]));
        }
    }
    for row in of_block("states") {
        for (cell, state) in row.iter().skip(2).zip(bad_input::STATES) {
            if let Ok(number) = cell.parse() {
                found.entry(number).or_default().insert(state.into());
            }
        }
    }
    for ((block, number), script) in seen {
        if block == info.name {
            let places = found.entry(*number).or_default();
            if places.is_empty() {
                places.insert(format!("[a script](../../scan-tests/{script}.scan.json)"));
            }
        }
    }
    if found.is_empty() {
        return;
    }
    text.push_str(
        "\n## Errors\n\nThe ErrorIDs that this block shows in the tests. The last column names the pins with a bad value, \
         or the states\nof the axis, in which it does so ([bad input](../bad-input.md)); for other errors, a script in which \
         it does so.\n\n| ErrorID | cause | seen with |\n| ---: | --- | --- |\n",
    );
    for (number, places) in found {
        let places: Vec<_> = places.into_iter().collect();
        let (anchor, cause) = faults.entry(number);
        let _ = writeln!(
            text,
            "| [{number}](../faults.md#{anchor}) | {cause} | {} |",
            places.join(", ")
        );
    }
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

fn page(info: &BlockInfo, more: &str) -> Generated {
    let mut text = format!("{NOTICE}# {}\n\n{}\n", info.name, info.doc);
    if !more.is_empty() {
        let _ = write!(text, "\nMore: {more}.\n");
    }
    let _ = write!(text, "\nGroup: {}.\n", info.group.name());
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

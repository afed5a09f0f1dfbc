//! Random programs in Structured Text: the instances and the steps of an episode, written as a program, move the
//! axes as the script does.

use super::wired::{info, rows};
use serde_json::{Map, Value, json};
use standstill_fb::{Direction, PinType, TableInfo};
use standstill_script::{Outcome, read_with_programs};
use standstill_soak::monkey::{judge, record};
use standstill_testkit::cases;
use std::collections::BTreeMap;
use std::fmt::Write;

/// Variables for the numbers that have no literal: steps of the script set them.
const SPECIAL: [(&str, &str); 3] = [
    ("Infinite", "Infinity"),
    ("Minus_Infinite", "-Infinity"),
    ("Undefined", "NaN"),
];

fn text(value: &Value) -> &str {
    value.as_str().expect("text")
}

/// A value at a pin or in a record, in Structured Text. `None` for the number of an element that does not exist,
/// which the compiler refuses.
fn literal(ty: PinType, value: &Value) -> Option<String> {
    let whole = || value.as_i64().expect("a whole number");
    match ty {
        PinType::Enum(info) => {
            let known = info
                .elements
                .iter()
                .any(|(_, number)| i64::from(*number) == whole());
            known.then(|| value.to_string())
        }
        PinType::Bool => Some(if value == &json!(true) { "TRUE" } else { "FALSE" }.to_owned()),
        PinType::Lreal => Some(match value {
            Value::String(word) => {
                let special = SPECIAL.iter().find(|(_, name)| name == word);
                special.expect("one of them").0.to_owned()
            }
            number => {
                let text = format!("{:?}", number.as_f64().expect("a number"));
                // An exponent needs a fraction before it.
                match text.split_once('e') {
                    Some((digits, exponent)) if !digits.contains('.') => format!("{digits}.0E{exponent}"),
                    _ => text,
                }
            }
        }),
        PinType::Time => Some(match value {
            Value::String(time) => time.clone(),
            _ => format!("T#{}ns", whole()),
        }),
        _ => Some(value.to_string()),
    }
}

/// A program as written.
#[derive(Default)]
struct Program {
    declared: String,
    calls: String,
    /// By scan, the assignments before the blocks are called.
    assigned: BTreeMap<u64, String>,
    /// The variable for a signal of the script, and its type.
    variables: BTreeMap<String, (String, PinType)>,
}

impl Program {
    fn declare(&mut self, variable: &str, ty: &str) {
        // Writing to a String cannot fail.
        let _ = writeln!(self.declared, "  {variable} : {ty};");
    }

    fn assign(&mut self, scan: u64, variable: &str, value: &str) {
        let _ = writeln!(
            self.assigned.entry(scan).or_default(),
            "      {variable} := {value};"
        );
    }

    /// An instance and its call. Parts that the compiler refuses are removed from the script, too.
    fn block(&mut self, block: &mut Value) {
        let (name, info) = (text(&block["name"]).to_owned(), info(block));
        self.declare(&name, info.name);
        let given = block["pins"].as_object_mut().expect("pins");
        let mut arguments = Vec::new();
        for pin in info.pins() {
            let is_input = pin.direction != Direction::InOut && !matches!(pin.ty, PinType::Table(_));
            let variable = match (pin.ty, given.get(pin.name)) {
                (PinType::Axis("AXIS_REF"), Some(axis)) => text(axis).to_owned(),
                _ if is_input => format!("{name}.{}", pin.name),
                _ => format!("{name}_{}", pin.name),
            };
            if !is_input {
                arguments.push(format!("{} := {variable}", pin.name));
            }
            match (pin.ty, given.get(pin.name)) {
                (PinType::Axis("AXIS_REF"), _) => {}
                (PinType::Axis(ty), axis) => {
                    self.declare(&variable, ty);
                    let axis = text(axis.expect("an axis"));
                    self.assign(0, &format!("{variable}.Number"), &format!("{axis}.Number"));
                }
                (PinType::Table(table), records) => self.table(&variable, &table, records),
                (ty, value) => {
                    if let (PinType::Enum(info), false) = (ty, is_input) {
                        self.declare(&variable, info.name);
                    }
                    match value.map(|value| literal(ty, value)) {
                        Some(Some(value)) => self.assign(0, &variable, &value),
                        Some(None) => drop(given.remove(pin.name)),
                        None => {}
                    }
                    self.variables
                        .insert(format!("{name}.{}", pin.name), (variable, ty));
                }
            }
        }
        let _ = writeln!(self.calls, "  {name}({});", arguments.join(", "));
    }

    fn table(&mut self, variable: &str, table: &TableInfo, records: Option<&Value>) {
        self.declare(variable, table.name);
        let records = records.map_or(&[][..], |records| records.as_array().expect("records"));
        self.assign(0, &format!("{variable}.Count"), &records.len().to_string());
        for (place, record) in records.iter().enumerate() {
            for field in table.fields {
                if let Some(value) = record.get(field.name) {
                    let value = literal(field.ty, value).expect("an element");
                    self.assign(0, &format!("{variable}.Records[{place}].{}", field.name), &value);
                }
            }
        }
    }

    /// The inputs that a step sets; returns whether the compiler accepts their values.
    fn step(&mut self, step: &Value) -> bool {
        let scan = step["at"].as_u64().expect("a scan");
        step["set"]
            .as_object()
            .into_iter()
            .flatten()
            .all(|(signal, value)| {
                let (variable, ty) = self.variables[signal].clone();
                let value = literal(ty, value);
                if let Some(value) = &value {
                    self.assign(scan, &variable, value);
                }
                value.is_some()
            })
    }
}

/// The blocks of `script` and its steps that set inputs, as a program; and the script of that program. Parts that
/// the compiler refuses are removed from `script`.
fn written(script: &mut Value) -> (String, Value) {
    let mut program = Program::default();
    let blocks = script["blocks"].as_array_mut().expect("blocks");
    blocks.iter_mut().for_each(|block| program.block(block));
    let instances: Vec<_> = blocks.iter().map(|block| block["name"].clone()).collect();
    let steps = script["steps"].as_array_mut().expect("steps");
    steps.retain(|step| program.step(step));
    let others = steps.iter().filter(|step| step.get("set").is_none()).cloned();
    let specials: Map<_, _> = SPECIAL
        .iter()
        .map(|(name, value)| (format!("main.{name}"), json!(value)))
        .collect();
    let steps: Vec<_> = [json!({"at": 0, "set": specials})]
        .into_iter()
        .chain(others)
        .collect();
    let mut hosted = script.clone();
    hosted["programs"] = json!({"main": {"st": "random.st", "trace": instances}});
    hosted["blocks"] = json!([]);
    hosted["steps"] = Value::Array(steps);
    let axes: Vec<_> = script["axes"]
        .as_object()
        .expect("axes")
        .keys()
        .cloned()
        .collect();
    let assigned = program.assigned.iter();
    let cases: String = assigned
        .map(|(scan, text)| format!("    {scan}:\n{text}"))
        .collect();
    let source = format!(
        "PROGRAM Random\nVAR_INPUT\n  {} : LREAL;\nEND_VAR\nVAR\n  {} : AXIS_REF;\n  Scan : DINT := -1;\n{}END_VAR\n  \
         Scan := Scan + 1;\n  CASE Scan OF\n{cases}  END_CASE;\n{}END_PROGRAM\n",
        SPECIAL.map(|(name, _)| name).join(", "),
        axes.join(", "),
        program.declared,
        program.calls
    );
    (source, hosted)
}

/// The run of a script whose program is `program`.
fn run(script: &Value, program: &str) -> Outcome {
    let text = serde_json::to_string_pretty(script).expect("JSON");
    let mut machine = |name: &str| Err(format!("{name}: there is none"));
    let mut source = |_: &str| Ok(program.as_bytes().to_vec());
    let read = read_with_programs(&text, "random.scan.json", &[], &mut machine, &mut source)
        .unwrap_or_else(|error| panic!("{error}\n{program}\n{text}"));
    let (_, failure) = judge(&read);
    assert_eq!(failure, None, "{program}\n{text}");
    standstill_script::run(&read).expect("a run")
}

/// Its columns by name, with a NaN equal to itself and without the name of the program; and its events.
fn seen(outcome: &Outcome) -> (BTreeMap<String, Vec<String>>, Vec<String>) {
    let rows = rows(outcome);
    let name = |name: &str| name.strip_prefix("main.").unwrap_or(name).to_owned();
    let columns = outcome.trace.columns().iter().enumerate();
    let columns = columns.map(|(place, column)| {
        let cells = rows.iter().map(|row| row[place].clone());
        (name(&column.name), cells.collect())
    });
    let notes = outcome.trace.notes().iter();
    let notes =
        notes.map(|note| format!("{} {} {}", note.scan, note.subject, note.text).replace("main.", ""));
    (columns.collect(), notes.collect())
}

/// A block does the same for any caller.
#[test]
fn a_program_in_structured_text_moves_the_axes_as_a_script_does() {
    let mut compared = 0;
    for number in 0..cases(400) {
        let mut script: Value = serde_json::from_str(&record(19, number, 200).2.text()).expect("JSON");
        let (program, hosted) = written(&mut script);
        let (plain, plain_notes) = seen(&run(&script, ""));
        let (hosted, hosted_notes) = seen(&run(&hosted, &program));
        for (name, column) in &plain {
            // Axes and tables at pins are variables of the program, not pins.
            let Some(other) = hosted.get(name) else { continue };
            compared += 1;
            if let Some(scan) = (0..column.len()).find(|scan| column[*scan] != other[*scan]) {
                let (is, is_there) = (&column[scan], &other[scan]);
                panic!("episode {number}, scan {scan}: {name} is {is}, in the program {is_there}\n{program}");
            }
        }
        assert_eq!(plain_notes, hosted_notes, "episode {number}\n{program}");
    }
    assert!(
        compared > 50 * cases(400),
        "only {compared} columns were compared"
    );
}

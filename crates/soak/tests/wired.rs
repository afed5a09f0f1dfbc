//! Random programs with wires and tasks: the script of an episode, rewired at random, keeps the order of a scan.
//!
//! The expected value of a pin is found from the rows alone. Tasks that are due run by priority, each with its
//! blocks in the order of the script. A wire has the value that its source has when its block is called. A block
//! that is not called keeps its pins.

use serde_json::{Map, Value, json};
use standstill_blocks::{REGISTRY, registry::find};
use standstill_fb::{BlockInfo, Direction, Group, Pin, PinType};
use standstill_script::{Ahead, Outcome, Session};
use standstill_soak::monkey::{judge, record};
use standstill_testkit::{Random, cases};
use std::collections::{BTreeMap, BTreeSet};

/// In the order in which they are written: alphabetical.
const TASKS: [&str; 3] = ["fast", "main", "slow"];

pub fn info(block: &Value) -> &'static BlockInfo {
    find(block["type"].as_str().expect("a type")).expect("a block of the registry")
}

fn name(block: &Value) -> &str {
    block["name"].as_str().expect("a name")
}

/// All outputs that a BOOL pin may be wired to.
fn bool_outputs(blocks: &[Value]) -> Vec<String> {
    let outputs = |block: &Value| {
        let pins = info(block).pins();
        let flags = pins.filter(|pin| pin.direction == Direction::Output && pin.ty == PinType::Bool);
        flags
            .map(|pin| format!("{}.{}", name(block), pin.name))
            .collect::<Vec<_>>()
    };
    blocks.iter().flat_map(outputs).collect()
}

fn one_of<'a, T>(random: &mut Random, list: &'a [T]) -> &'a T {
    &list[random.below(list.len() as u64) as usize]
}

/// A timer, a counter or the like.
fn standard_block(random: &mut Random, number: usize) -> Value {
    let kinds: Vec<_> = REGISTRY
        .iter()
        .filter(|info| info.group == Group::Standard)
        .collect();
    let info = one_of(random, &kinds);
    let mut pins = Map::new();
    for pin in info.pins().filter(|pin| pin.direction == Direction::Input) {
        let value = match pin.ty {
            PinType::Time => json!(format!("T#{}ms", random.below(40))),
            PinType::Int => json!(random.below(5)),
            _ => continue,
        };
        pins.insert(pin.name.to_owned(), value);
    }
    json!({"name": format!("S{number}"), "type": info.name, "pins": pins})
}

/// A wire of a BOOL that uses the input variable `own`.
fn bool_wire(random: &mut Random, own: &str, outputs: &[String]) -> Value {
    let other = one_of(random, outputs);
    match random.below(5) {
        0 => json!({ "not": own }),
        1 => json!({ "any": [own, other] }),
        2 => json!({ "all": [own, other] }),
        3 => json!({ "any": [other, own, one_of(random, outputs)] }),
        _ => json!({ "from": own }),
    }
}

/// The script `text` with additional timers and counters, and all blocks in three tasks. Half of the pins are wired
/// to input variables, which the steps set instead, and to outputs.
fn rewired(random: &mut Random, text: &str) -> Value {
    let mut script: Value = serde_json::from_str(text).expect("JSON");
    let mut blocks = script["blocks"].as_array().expect("blocks").clone();
    blocks.extend((0..3).map(|number| standard_block(random, number)));
    let outputs = bool_outputs(&blocks);
    let mut inputs = Map::new();
    let mut variables = BTreeMap::new();
    for block in &mut blocks {
        let pins = info(block).pins();
        for pin in pins.filter(|pin| pin.direction == Direction::Input) {
            let start = match pin.ty {
                PinType::Bool => json!(false),
                PinType::Lreal => json!(0.5),
                _ => continue,
            };
            if random.below(2) == 0 {
                continue;
            }
            let signal = format!("{}.{}", name(block), pin.name);
            let own = format!("v{}", inputs.len());
            let wire = if pin.ty == PinType::Bool {
                bool_wire(random, &own, &outputs)
            } else {
                json!({ "from": own })
            };
            let given = block["pins"]
                .as_object_mut()
                .expect("pins")
                .insert(pin.name.to_owned(), wire);
            inputs.insert(own.clone(), given.unwrap_or(start));
            variables.insert(signal, own);
        }
        block["task"] = json!(one_of(random, TASKS.as_slice()));
    }
    for step in script["steps"].as_array_mut().expect("steps") {
        let Some(set) = step.get_mut("set").and_then(Value::as_object_mut) else {
            continue;
        };
        let old = std::mem::take(set);
        set.extend(old.into_iter().map(|(signal, value)| {
            let own = variables.get(&signal).cloned().unwrap_or(signal);
            (own, value)
        }));
    }
    let flags = variables_of_bool(&inputs);
    let task = |random: &mut Random| {
        let mut task = json!({"interval": 1 + random.below(5), "priority": random.below(3)});
        if !flags.is_empty() && random.below(3) == 0 {
            let own = one_of(random, &flags);
            task["single"] = bool_wire(random, own, &outputs);
        }
        task
    };
    script["tasks"] = TASKS
        .iter()
        .map(|name| ((*name).to_owned(), task(random)))
        .collect();
    script["inputs"] = Value::Object(inputs);
    script["blocks"] = Value::Array(blocks);
    script
}

/// Names of the input variables that are BOOL.
fn variables_of_bool(inputs: &Map<String, Value>) -> Vec<String> {
    let flags = inputs.iter().filter(|(_, value)| value.is_boolean());
    flags.map(|(name, _)| name.clone()).collect()
}

/// A wire: how it joins its signals, and their columns.
struct Wire {
    kind: String,
    of: Vec<usize>,
}

impl Wire {
    /// Its value if the signals are those of `row`.
    fn value(&self, row: &[String]) -> String {
        let mut signals = self.of.iter().map(|column| row[*column].clone());
        let mut is_true = |signal: String| signal == "Bool(true)";
        match self.kind.as_str() {
            "from" => signals.next().expect("a signal"),
            "not" => format!("Bool({})", !signals.any(&mut is_true)),
            "any" => format!("Bool({})", signals.any(is_true)),
            _ => format!("Bool({})", signals.all(is_true)),
        }
    }
}

struct Task {
    interval: u64,
    priority: u64,
    single: Option<Wire>,
    was_single: bool,
}

impl Task {
    /// Whether it runs in a scan in which the signals are those of `row`.
    fn is_due(&mut self, scan: usize, row: &[String]) -> bool {
        let single = self
            .single
            .as_ref()
            .is_some_and(|wire| wire.value(row) == "Bool(true)");
        let was = std::mem::replace(&mut self.was_single, single);
        if single {
            !was
        } else {
            (scan as u64).is_multiple_of(self.interval)
        }
    }
}

struct Instance {
    task: usize,
    /// Columns of its pins that only its call changes.
    own: Vec<usize>,
    /// All columns of its pins.
    all: Vec<usize>,
    /// Columns of its wired pins.
    wires: Vec<(usize, Wire)>,
}

/// A script in the form in which its rows are judged.
struct Judge {
    names: Vec<String>,
    inputs: Vec<usize>,
    tasks: Vec<Task>,
    instances: Vec<Instance>,
}

impl Judge {
    fn new(script: &Value, names: Vec<String>) -> Self {
        let column = |signal: &str| names.iter().position(|name| name == signal).expect("a column");
        let wire = |wire: &Value| {
            let (kind, of) = wire.as_object()?.iter().next()?;
            let list = of.as_array().cloned().unwrap_or_else(|| vec![of.clone()]);
            let of = list
                .iter()
                .map(|signal| column(signal.as_str().expect("a signal")));
            Some(Wire {
                kind: kind.clone(),
                of: of.collect(),
            })
        };
        let task = |name: &&str| {
            let task = &script["tasks"][name];
            Task {
                interval: task["interval"].as_u64().expect("a count"),
                priority: task["priority"].as_u64().expect("a number"),
                single: task.get("single").and_then(wire),
                was_single: false,
            }
        };
        let instance = |block: &Value| {
            let pins = || {
                info(block)
                    .pins()
                    .map(|pin| (pin, column(&format!("{}.{}", name(block), pin.name))))
            };
            let wires = pins().filter_map(|(pin, column)| Some((column, wire(&block["pins"][pin.name])?)));
            let is_free =
                |pin: &Pin| pin.direction == Direction::Input && !block["pins"][pin.name].is_object();
            Instance {
                task: TASKS
                    .iter()
                    .position(|task| block["task"] == json!(task))
                    .expect("a task"),
                own: pins()
                    .filter(|(pin, _)| !is_free(pin))
                    .map(|(_, column)| column)
                    .collect(),
                all: pins().map(|(_, column)| column).collect(),
                wires: wires.collect(),
            }
        };
        Self {
            inputs: script["inputs"]
                .as_object()
                .expect("inputs")
                .keys()
                .map(|name| column(name))
                .collect(),
            tasks: TASKS.iter().map(task).collect(),
            instances: script["blocks"]
                .as_array()
                .expect("blocks")
                .iter()
                .map(instance)
                .collect(),
            names,
        }
    }

    /// Judges every pin of every scan. Returns how many wires had another value than in the scan before.
    fn judge(&mut self, rows: &[Vec<String>], what: &str) -> usize {
        let mut changed = 0;
        // Before the first scan every BOOL is FALSE, and no wire reads an output of another type.
        let at_first = |cell: &String| {
            if cell.starts_with("Bool") {
                "Bool(false)"
            } else {
                cell
            }
            .to_owned()
        };
        let mut stands: Vec<String> = rows[0].iter().map(at_first).collect();
        for (scan, row) in rows.iter().enumerate() {
            let before = stands.clone();
            let take = |stands: &mut Vec<String>, columns: &[usize]| {
                columns
                    .iter()
                    .for_each(|column| stands[*column].clone_from(&row[*column]));
            };
            take(&mut stands, &self.inputs);
            let mut due: Vec<usize> = (0..self.tasks.len()).collect();
            due.retain(|task| self.tasks[*task].is_due(scan, &stands));
            due.sort_by_key(|task| self.tasks[*task].priority);
            for task in &due {
                for instance in self.instances.iter().filter(|instance| instance.task == *task) {
                    for (column, wire) in &instance.wires {
                        let is = wire.value(&stands);
                        assert_eq!(row[*column], is, "{what}, scan {scan}: {}", self.names[*column]);
                        changed += usize::from(before[*column] != is);
                    }
                    take(&mut stands, &instance.all);
                }
            }
            // A step may write a pin without a wire at any time.
            for instance in self
                .instances
                .iter()
                .filter(|instance| scan > 0 && !due.contains(&instance.task))
            {
                for column in &instance.own {
                    let name = &self.names[*column];
                    assert_eq!(
                        row[*column], before[*column],
                        "{what}, scan {scan}: {name} of a block that is not called"
                    );
                }
            }
        }
        changed
    }
}

/// The cells of each row, as text: a NaN is then equal to itself.
pub fn rows(outcome: &Outcome) -> Vec<Vec<String>> {
    let row = |scan| outcome.trace.row(scan).map(|cell| format!("{cell:?}")).collect();
    (0..outcome.trace.scans()).map(row).collect()
}

/// Covers: TK-1, TK-2, TK-3, TK-4, TK-6
#[test]
fn wires_and_tasks_keep_the_order_of_a_scan() {
    let mut changed = 0;
    let mut drawn = BTreeSet::new();
    for number in 0..cases(400) {
        let mut random = Random(number);
        let text = record(17, number, 200).2.text();
        let script = rewired(&mut random, &text);
        let text = serde_json::to_string_pretty(&script).expect("JSON");
        let read = standstill_script::read(&text, "wired.scan.json", &[])
            .unwrap_or_else(|error| panic!("{error:?}\n{text}"));
        drawn.extend(
            script["blocks"]
                .as_array()
                .expect("blocks")
                .iter()
                .map(|block| info(block).name),
        );
        let (_, failure) = judge(&read);
        assert_eq!(failure, None, "episode {number}\n{text}");
        let outcome = standstill_script::run(&read).expect("a run");
        let names = outcome.trace.columns().iter().map(|column| column.name.clone());
        let rows_by_scan = rows(&outcome);
        changed += Judge::new(&script, names.collect()).judge(&rows_by_scan, &format!("episode {number}"));
        // Leaving out calls that would do nothing new changes no row.
        let mut far = Session::new(&read).expect("a run");
        while !matches!(far.advance_far(100).expect("a scan"), Ahead::Scans(0)) {}
        assert_eq!(rows(&far.finish()), rows_by_scan, "episode {number}");
    }
    // Another test checks that the other blocks are drawn.
    let standard = REGISTRY.iter().filter(|info| info.group == Group::Standard);
    let missing: Vec<_> = standard
        .map(|info| info.name)
        .filter(|name| !drawn.contains(name))
        .collect();
    assert!(missing.is_empty(), "never drawn: {missing:?}");
    assert!(changed as u64 > 8 * cases(400), "only {changed} wires changed");
}

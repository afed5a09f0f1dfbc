//! Mutants of a script's program: small changes, each of which a claim should detect.
//!
//! The changes are made to the parts that a machine builder writes: constants at pins and in tables,
//! wires, blocks and limits. Steps and claims are not changed, because they are the test.
//! `docs/mutants.md` lists the changes.

use crate::claims::Verdict;
use crate::model::{Point, Script, Wire};
use crate::run::cells::point_name;
use crate::run::{Outcome, run};
use standstill_axis::Limits;
use standstill_fb::{PinType, TableInfo, TableRef, Value};
use standstill_trace::{Cell, Trace, shortest};

/// Factors on a number.
const FACTORS: [f64; 2] = [0.9, 1.1];

/// A change of a script's program.
#[derive(Clone, Debug, PartialEq)]
pub struct Mutant {
    /// JSON path of the change, such as `blocks[2].pins.Velocity`.
    pub path: String,
    /// The old and the new value, in a few words.
    pub says: String,
    change: Change,
}

#[derive(Clone, Debug, PartialEq)]
enum Change {
    /// Another constant at a pin.
    Constant(usize, usize, Value),
    /// Another number in a table: its index among the numbers of all tables.
    Cell(usize, f64),
    /// Another wire to a pin.
    Wire(usize, usize, Wire),
    /// Other limits of an axis.
    Limits(usize, Limits),
    /// A block that is never called.
    LeftOut(usize),
}

/// The fate of a mutant.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Fate {
    /// This claim failed, the first in file order.
    Killed(String),
    /// No claim detected it.
    Survived,
    /// The run does not differ, except for the changed value itself; there is nothing to detect.
    Same,
    /// The script cannot be run with it.
    Impossible,
}

/// All mutants of a script in file order. If there are more than `most`, only `most` of them, drawn from
/// the seed.
#[must_use]
pub fn mutants(script: &Script, seed: u64, most: usize) -> Vec<Mutant> {
    let mut all = Vec::new();
    for index in 0..script.axes.len() {
        limits(script, index, &mut all);
    }
    for index in 0..script.blocks.len() {
        block(script, index, &mut all);
    }
    drawn(all, seed, most)
}

/// This many of all, in their order. Whether one is drawn depends only on the seed, its path and its
/// change.
fn drawn(all: Vec<Mutant>, seed: u64, most: usize) -> Vec<Mutant> {
    if all.len() <= most {
        return all;
    }
    let mut ranked: Vec<(u64, usize)> = all
        .iter()
        .enumerate()
        .map(|(index, mutant)| (rank(mutant, seed), index))
        .collect();
    ranked.sort_unstable();
    let mut chosen: Vec<usize> = ranked.into_iter().take(most).map(|(_, index)| index).collect();
    chosen.sort_unstable();
    chosen
        .into_iter()
        .filter_map(|index| all.get(index).cloned())
        .collect()
}

fn rank(mutant: &Mutant, seed: u64) -> u64 {
    let mut hash = standstill_trace::digest::Fnv1a::new();
    hash.write(&seed.to_le_bytes());
    hash.write(mutant.path.as_bytes());
    hash.write(mutant.says.as_bytes());
    hash.finish()
}

fn limits(script: &Script, index: usize, all: &mut Vec<Mutant>) {
    let Some(axis) = script.axes.get(index) else {
        return;
    };
    let old = axis.config.limits;
    // The default of the deceleration is the acceleration.
    let one = old.deceleration == old.acceleration;
    type Set = fn(&mut Limits, f64);
    let each: [(&str, f64, Set); 5] = [
        ("velocity", old.velocity, |limits, value| limits.velocity = value),
        ("acceleration", old.acceleration, |limits, value| {
            limits.acceleration = value;
        }),
        (
            "deceleration",
            if one { f64::INFINITY } else { old.deceleration },
            |limits, value| limits.deceleration = value,
        ),
        ("jerk", old.jerk, |limits, value| limits.jerk = value),
        ("snap", old.snap, |limits, value| limits.snap = value),
    ];
    for (key, value, set) in each.into_iter().filter(|(_, value, _)| value.is_finite()) {
        for factor in FACTORS {
            let mut limits = old;
            set(&mut limits, value * factor);
            if one {
                limits.deceleration = limits.acceleration;
            }
            all.push(Mutant {
                path: format!("axes.{}.limits.{key}", axis.name),
                says: format!("{} to {}", shortest(value), shortest(value * factor)),
                change: Change::Limits(index, limits),
            });
        }
    }
}

fn block(script: &Script, index: usize, all: &mut Vec<Mutant>) {
    let Some(instance) = script.blocks.get(index) else {
        return;
    };
    all.push(Mutant {
        path: format!("blocks[{index}]"),
        says: format!("{} left out", instance.name),
        change: Change::LeftOut(index),
    });
    for (pin, found) in instance.block.inputs().iter().enumerate() {
        let path = format!("blocks[{index}].pins.{}", found.name);
        let constant = instance.constants.iter().find(|(at, _)| *at == pin);
        let constant = constant.map(|(_, value)| *value);
        if let Some((_, wire)) = instance.wires.iter().find(|(at, _)| *at == pin) {
            if let Some((wire, says)) = rewired(wire, found.ty) {
                all.push(Mutant {
                    path,
                    says,
                    change: Change::Wire(index, pin, wire),
                });
            }
            continue;
        }
        if let (Some(Value::Table(place)), PinType::Table(info)) = (constant, found.ty) {
            table(script, &path, place, info, all);
        }
        let others = match (constant, found.ty) {
            (Some(value), _) if !matches!(found.ty, PinType::Enum(_)) => numbers(value),
            (constant, PinType::Enum(info)) => {
                let now = constant.or_else(|| instance.block.default_of(pin));
                element(info.elements, now, found.name, constant.is_some())
            }
            _ => Vec::new(),
        };
        for (value, says) in others {
            all.push(Mutant {
                path: path.clone(),
                says,
                change: Change::Constant(index, pin, value),
            });
        }
    }
}

/// The numbers of a table at a pin that are not 0: a value left out of a record is 0, too.
fn table(script: &Script, path: &str, place: TableRef, info: TableInfo, all: &mut Vec<Mutant>) {
    let first = usize::try_from(place.first).unwrap_or(usize::MAX);
    let cells = script.tables.iter().enumerate().skip(first);
    let records = cells.zip((0..usize::from(place.records)).flat_map(|record| {
        let fields = info.fields.iter();
        fields.map(move |field| (record, field))
    }));
    for ((at, cell), (record, field)) in records.filter(|((_, cell), _)| **cell != 0.0) {
        let others = match field.ty {
            PinType::Bool => numbers(Value::Bool(true)),
            PinType::Int => numbers(Value::Int(*cell as i16)),
            PinType::Time => numbers(Value::Time(*cell as i64)),
            PinType::Lreal => numbers(Value::Lreal(*cell)),
            PinType::Enum(info) => {
                let now = Some(Value::Enum(*cell as i32));
                element(info.elements, now, field.name, true)
            }
            _ => Vec::new(),
        };
        for (value, says) in others {
            if let Some(cell) = value.to_cell() {
                all.push(Mutant {
                    path: format!("{path}[{record}].{}", field.name),
                    says,
                    change: Change::Cell(at, cell),
                });
            }
        }
    }
}

/// A constant a tenth less and a tenth more; for a BOOL the opposite.
fn numbers(value: Value) -> Vec<(Value, String)> {
    match value {
        Value::Bool(value) => {
            let name = |value: bool| if value { "TRUE" } else { "FALSE" };
            vec![(
                Value::Bool(!value),
                format!("{} to {}", name(value), name(!value)),
            )]
        }
        Value::Lreal(value) if value != 0.0 && value.is_finite() => FACTORS
            .iter()
            .map(|factor| {
                let other = value * factor;
                (
                    Value::Lreal(other),
                    format!("{} to {}", shortest(value), shortest(other)),
                )
            })
            .collect(),
        Value::Time(ns) if ns != 0 => [ns / 10 * 9, ns / 10 * 11]
            .into_iter()
            .filter(|other| *other != ns)
            .map(|other| {
                let literal = crate::read::time::literal;
                (
                    Value::Time(other),
                    format!("{} to {}", literal(ns), literal(other)),
                )
            })
            .collect(),
        Value::Int(value) if value != 0 => {
            // A tenth of a small number is 0, so the change is at least one.
            let step = (value / 10).abs().max(1);
            let others = [value.saturating_sub(step), value.saturating_add(step)];
            let each = others.into_iter();
            each.map(|other| (Value::Int(other), format!("{value} to {other}")))
                .collect()
        }
        _ => Vec::new(),
    }
}

/// Another element. For a buffer mode: aborting if it waits, buffered if it aborts. For others the next
/// one. An enumeration that the script does not name is not changed, except buffer modes.
fn element(
    elements: &[(&'static str, i32)],
    now: Option<Value>,
    pin: &str,
    named: bool,
) -> Vec<(Value, String)> {
    let Some(Value::Enum(number)) = now else {
        return Vec::new();
    };
    let place = elements.iter().position(|(_, other)| *other == number);
    let (Some(place), true) = (place, named || pin == "BufferMode") else {
        return Vec::new();
    };
    let to = match (pin, place) {
        ("BufferMode", 0) => 1,
        ("BufferMode", _) => 0,
        _ => (place + 1) % elements.len(),
    };
    match (elements.get(place), elements.get(to)) {
        (Some((from, _)), Some((name, number))) if from != name => {
            vec![(Value::Enum(*number), format!("{from} to {name}"))]
        }
        _ => Vec::new(),
    }
}

/// A logical wire inverted.
fn rewired(wire: &Wire, ty: PinType) -> Option<(Wire, String)> {
    if ty != PinType::Bool {
        return None;
    }
    Some(match wire {
        Wire::From(point) => (Wire::Not(*point), "from to not".to_owned()),
        Wire::Not(point) => (Wire::From(*point), "not to from".to_owned()),
        Wire::Any(points) if points.len() > 1 => (Wire::All(points.clone()), "any to all".to_owned()),
        Wire::All(points) if points.len() > 1 => (Wire::Any(points.clone()), "all to any".to_owned()),
        Wire::Any(_) | Wire::All(_) => return None,
    })
}

impl Mutant {
    /// The script with the change.
    fn applied(&self, script: &Script) -> Option<Script> {
        let mut script = script.clone();
        match &self.change {
            Change::Constant(instance, pin, value) => {
                let constants = &mut script.blocks.get_mut(*instance)?.constants;
                constants.retain(|(at, _)| at != pin);
                constants.push((*pin, *value));
            }
            Change::Cell(at, cell) => *script.tables.get_mut(*at)? = *cell,
            Change::Wire(instance, pin, wire) => {
                let wires = &mut script.blocks.get_mut(*instance)?.wires;
                let (_, place) = wires.iter_mut().find(|(at, _)| at == pin)?;
                *place = wire.clone();
            }
            Change::Limits(axis, limits) => {
                let config = &mut script.axes.get_mut(*axis)?.config;
                config.limits = *limits;
                config.check().ok()?;
            }
            Change::LeftOut(instance) => script.blocks.get_mut(*instance)?.left_out = true,
        }
        Some(script)
    }

    /// The column that shows the change itself.
    fn own_column(&self, script: &Script) -> Option<String> {
        match self.change {
            Change::Constant(instance, pin, _) | Change::Wire(instance, pin, _) => {
                Some(point_name(script, Point::Pin(instance, pin)))
            }
            // A table is no column.
            Change::Cell(..) | Change::Limits(..) | Change::LeftOut(_) => None,
        }
    }

    /// Runs the script with the change; `original` is its run without. Goldens are not used.
    #[must_use]
    pub fn judge(&self, script: &Script, original: &Outcome) -> Fate {
        let Some(outcome) = self.applied(script).and_then(|script| run(&script).ok()) else {
            return Fate::Impossible;
        };
        let failed = outcome.verdicts.iter().find(|verdict| !Verdict::passed(verdict));
        match failed {
            Some(verdict) => Fate::Killed(verdict.path.clone()),
            None if same(
                &original.trace,
                &outcome.trace,
                self.own_column(script).as_deref(),
            ) =>
            {
                Fate::Same
            }
            None => Fate::Survived,
        }
    }
}

/// Whether two runs have the same rows, except one column.
fn same(one: &Trace, other: &Trace, without: Option<&str>) -> bool {
    let equal = |a: Cell<'_>, b: Cell<'_>| match (a, b) {
        (Cell::Real(a), Cell::Real(b)) => a.to_bits() == b.to_bits(),
        _ => a == b,
    };
    let columns = one.columns().iter().enumerate();
    let mut columns = columns.filter(|(_, column)| Some(column.name.as_str()) != without);
    one.scans() == other.scans()
        && columns.all(|(at, _)| {
            let mut cells = one.cells(at).zip(other.cells(at));
            cells.all(|(a, b)| equal(a, b))
        })
}

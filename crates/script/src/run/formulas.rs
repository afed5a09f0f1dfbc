//! Running expressions: their values in wires, and on the rows of a trace.

use super::RunError;
use super::rows::Rows;
use crate::model::{AxisNumber, Formula, FormulaInput, Script, Signal};
use standstill_axis::{AxisState, Coupled, Setpoint};
use standstill_fb::Value;
use standstill_guest::{Entry, Fault, Guest};
use standstill_st::{FAULT_SITE, FAULT_VALUE, FaultKind};
use standstill_trace::Cell;

/// The guests of expressions, in the order of the script.
#[derive(Debug)]
pub(crate) struct Formulas {
    guests: Vec<Guest>,
}

/// The values of an axis that an expression reads.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reading {
    pub(crate) state: AxisState,
    pub(crate) setpoint: Setpoint,
    pub(crate) actual: f64,
    pub(crate) coupled: Option<Coupled>,
}

/// The results of the expressions of conditions on each row; expressions of wires have none.
#[derive(Clone, Debug, Default)]
pub(crate) struct Truths {
    /// The first scan with known results.
    first: u64,
    /// By expression, then by scan.
    all: Vec<Vec<bool>>,
    /// The expression, the scan, and the reason why it has no value.
    faults: Vec<(usize, u64, String)>,
}

impl Truths {
    pub(crate) fn new(script: &Script) -> Self {
        Self {
            first: 0,
            all: vec![Vec::new(); script.formulas.len()],
            faults: Vec::new(),
        }
    }

    /// Whether an expression is TRUE on the row of a scan; one that faulted is not.
    pub(crate) fn get(&self, formula: usize, scan: u64) -> Option<bool> {
        let row = usize::try_from(scan.checked_sub(self.first)?).ok()?;
        self.all.get(formula)?.get(row).copied()
    }

    /// Drops the rows before a scan.
    pub(crate) fn forget(&mut self, scan: u64) {
        let rows = usize::try_from(scan - self.first).unwrap_or(usize::MAX);
        for own in &mut self.all {
            own.drain(..rows.min(own.len()));
        }
        self.faults.retain(|(_, fault, _)| *fault >= scan);
        self.first = scan;
    }

    /// The faults of an expression, in the order of scans.
    pub(crate) fn faults(&self, formula: usize) -> impl Iterator<Item = (u64, &str)> {
        let own = self.faults.iter().filter(move |(index, ..)| *index == formula);
        own.map(|(_, scan, why)| (*scan, why.as_str()))
    }

    /// Notes that the expression of a wire has no value.
    pub(crate) fn fault(&mut self, formula: usize, scan: u64, why: String) {
        self.faults.push((formula, scan, why));
    }
}

impl Formulas {
    pub(crate) fn new(script: &Script) -> Result<Self, RunError> {
        let start = |formula: &Formula| {
            formula.guest.start().map_err(|error| RunError::Program {
                program: formula.text.clone(),
                reason: error.to_string(),
            })
        };
        let guests = script.formulas.iter().map(start).collect::<Result<_, _>>()?;
        Ok(Self { guests })
    }

    /// The value of an expression; `source` returns its variables.
    ///
    /// # Errors
    /// The reason why it has none.
    pub(crate) fn value(
        &mut self,
        script: &Script,
        index: usize,
        (scan, now_ns): (u64, i64),
        mut source: impl FnMut(&FormulaInput) -> Option<Value>,
    ) -> Result<Value, String> {
        let formula = script.formulas.get(index).ok_or("there is no such expression")?;
        let guest = self.guests.get_mut(index).ok_or("there is no such expression")?;
        for input in &formula.inputs {
            let value = source(input).ok_or("a signal is not there")?;
            guest
                .write(&input.symbol, value)
                .map_err(|error| error.to_string())?;
        }
        let outcome = guest.evaluate(Entry::SCAN, scan, now_ns);
        outcome.map_err(|fault| told(formula, guest, &fault))?;
        guest.read(&formula.result).map_err(|error| error.to_string())
    }

    /// Evaluates the expressions of conditions on the row of a scan, which is held.
    pub(crate) fn look(&mut self, rows: &Rows<'_>, scan: u64, truths: &mut Truths) {
        let now_ns = rows.script.cycle_ns.saturating_mul(scan.cast_signed());
        for (index, _) in rows
            .script
            .formulas
            .iter()
            .enumerate()
            .filter(|(_, it)| it.in_rows)
        {
            let source = |input: &FormulaInput| of_cell(input, rows.cell(&input.signal, scan)?);
            let truth = match self.value(rows.script, index, (scan, now_ns), source) {
                Ok(value) => value == Value::Bool(true),
                Err(why) => {
                    truths.fault(index, scan, why);
                    false
                }
            };
            if let Some(own) = truths.all.get_mut(index) {
                own.push(truth);
            }
        }
    }
}

/// Largest number of BOOL operands of an expression for which all combinations are tried.
const TURNED_MOST: usize = 8;

/// The BOOL operands of an expression that are wrong in a scan: all operands of the smallest sets that make the
/// expression `wanted` if inverted together. Empty if it already has this value, if no set changes it, or if there
/// are too many operands to try.
///
/// Cost: at most 2^[`TURNED_MOST`] evaluations.
pub(crate) fn turned(rows: &Rows<'_>, index: usize, wanted: bool, scan: u64) -> Option<Vec<usize>> {
    let formula = rows.script.formulas.get(index)?;
    let now_ns = rows.script.cycle_ns.saturating_mul(scan.cast_signed());
    let mut values = Vec::new();
    for input in &formula.inputs {
        values.push(of_cell(input, rows.cell(&input.signal, scan)?)?);
    }
    let operands: Vec<usize> = (0..values.len())
        .filter(|place| matches!(values.get(*place), Some(Value::Bool(_))))
        .collect();
    if operands.len() > TURNED_MOST {
        return None;
    }
    let mut guest = formula.guest.start().ok()?;
    let mut with = |turns: u32| -> Option<bool> {
        for (place, (input, value)) in formula.inputs.iter().zip(&values).enumerate() {
            let turned = operands
                .iter()
                .position(|operand| *operand == place)
                .is_some_and(|bit| turns >> bit & 1 == 1);
            let value = match *value {
                Value::Bool(value) => Value::Bool(value != turned),
                value => value,
            };
            guest.write(&input.symbol, value).ok()?;
        }
        guest.evaluate(Entry::SCAN, scan, now_ns).ok()?;
        match guest.read(&formula.result).ok()? {
            Value::Bool(value) => Some(value),
            _ => None,
        }
    };
    let mut found: Option<u32> = None;
    let mut fewest = u32::MAX;
    for turns in 0..1_u32 << operands.len() {
        let count = turns.count_ones();
        if count <= fewest && with(turns) == Some(wanted) {
            let others = found.filter(|_| count == fewest).unwrap_or(0);
            (found, fewest) = (Some(others | turns), count);
        }
    }
    let found = found.filter(|_| fewest > 0)?;
    let places = operands.into_iter().enumerate();
    let places = places.filter(|(bit, _)| found >> bit & 1 == 1);
    Some(places.map(|(_, place)| place).collect())
}

/// The present value of an axis signal.
pub(crate) fn of_reading(input: &FormulaInput, reading: &Reading) -> Option<Value> {
    let setpoint = &reading.setpoint;
    Some(match input.signal {
        Signal::State(_) => {
            let number = AxisState::ALL.iter().position(|state| *state == reading.state)?;
            input.variable.of_whole(number as i128)
        }
        Signal::Axis(_, number) => Value::Lreal(match number {
            AxisNumber::Position => setpoint.position,
            AxisNumber::Velocity => setpoint.velocity,
            AxisNumber::Acceleration => setpoint.acceleration,
            AxisNumber::Jerk => setpoint.jerk,
            AxisNumber::Snap => setpoint.snap,
            AxisNumber::ActualPosition => reading.actual,
            AxisNumber::Deviation => reading.coupled.map_or(0.0, |coupled| coupled.deviation),
            AxisNumber::Phase => reading.coupled.map_or(0.0, |coupled| coupled.phase),
            AxisNumber::Phase2 => {
                let second = reading.coupled.and_then(|coupled| coupled.second);
                second.map_or(0.0, |(_, phase)| phase)
            }
            AxisNumber::Superimposed => reading.coupled.map_or(0.0, |coupled| coupled.superimposed),
            AxisNumber::Shadow => reading.coupled.and_then(|coupled| coupled.shadow).unwrap_or(0.0),
        }),
        Signal::Point(_) | Signal::Master(..) | Signal::Difference(..) | Signal::Formula(_) => return None,
    })
}

/// The value of a variable or pin in the type of the expression's variable; `whole` is its number, if its
/// type differs.
pub(crate) fn of_value(input: &FormulaInput, value: Value, whole: Option<i128>) -> Value {
    match (value, whole) {
        (Value::Enum(number), _) => input.variable.of_whole(number.into()),
        (_, Some(whole)) if input.variable.elements().is_some() => input.variable.of_whole(whole),
        (value, _) => value,
    }
}

/// The value of a cell in the type of the expression's variable.
fn of_cell(input: &FormulaInput, cell: Cell<'_>) -> Option<Value> {
    Some(match cell {
        Cell::Bool(value) => Value::Bool(value),
        Cell::Real(value) => Value::Lreal(value),
        Cell::Integer(number) => input.variable.of_whole(number.into()),
        Cell::Name(name) => {
            let known = input.names.iter().find(|(known, _)| known == name);
            let number = known.map(|(_, number)| *number).or_else(|| name.parse().ok())?;
            input.variable.of_whole(number)
        }
    })
}

/// The reason why an expression has no value.
fn told(formula: &Formula, guest: &Guest, fault: &Fault) -> String {
    let site = guest.bits(FAULT_SITE, 4).unwrap_or_default();
    let kind = usize::try_from(site)
        .ok()
        .and_then(|site| formula.places.get(site.checked_sub(1)?));
    let Some(kind) = kind.filter(|_| matches!(fault, Fault::Trap(_))) else {
        return fault.to_string();
    };
    let value = guest
        .bits(FAULT_VALUE, 8)
        .and_then(|bits| FaultKind::value(*kind, bits.cast_signed()));
    match value {
        Some(value) => format!("{}: {value}", kind.text()),
        None => kind.text().to_owned(),
    }
}

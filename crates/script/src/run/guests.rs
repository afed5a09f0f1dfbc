//! The guest programs of a run.

use super::RunError;
use super::notes::Notes;
use crate::model::{Program, Script};
use standstill_fb::{Context, Value};
use standstill_guest::{Guest, Symbol, Told};
use standstill_trace::{Note, Trace};

/// Guests at work, in the order of the script.
#[derive(Debug, Default)]
pub(crate) struct Guests {
    all: Vec<Running>,
}

#[derive(Debug)]
struct Running {
    guest: Guest,
    /// Those behind `Fault`.
    symbols: Vec<Symbol>,
    fault: Option<String>,
    /// Whether the fault stands in the trace.
    told: bool,
}

impl Guests {
    /// Starts the guests of a script.
    pub(crate) fn new(script: &Script) -> Result<Self, RunError> {
        let all = script.programs.iter().map(start).collect::<Result<_, _>>()?;
        Ok(Self { all })
    }

    /// The values of their symbols.
    pub(crate) fn values(&self, script: &Script) -> Result<Vec<Vec<Value>>, RunError> {
        let values = |(running, program): (&Running, &Program)| {
            let read = |symbol| {
                running.guest.read(symbol).map_err(|error| RunError::Program {
                    program: program.name.clone(),
                    reason: error.to_string(),
                })
            };
            std::iter::once(Ok(Value::Bool(false)))
                .chain(running.symbols.iter().map(read))
                .collect()
        };
        self.all.iter().zip(&script.programs).map(values).collect()
    }

    pub(crate) fn has_fault(&self) -> bool {
        self.all.iter().any(|running| running.fault.is_some())
    }

    /// One execution of a program.
    pub(crate) fn scan(&mut self, index: usize, context: &mut Context<'_>) -> Result<(), &'static str> {
        let Some(running) = self.all.get_mut(index) else {
            return Ok(());
        };
        running.guest.scan(context).map(|_fuel| ()).map_err(|fault| {
            running.fault = Some(fault.to_string());
            fault.reason()
        })
    }

    /// Takes what stands in the symbols of a program now.
    pub(crate) fn refresh(&self, index: usize, values: &mut [Value]) {
        let (Some(running), [fault, values @ ..]) = (self.all.get(index), values) else {
            return;
        };
        *fault = Value::Bool(running.fault.is_some());
        for (symbol, value) in running.symbols.iter().zip(values) {
            // Memory never shrinks, so what was there at the start still is.
            if let Ok(now) = running.guest.read(symbol) {
                *value = now;
            }
        }
    }

    /// Writes a symbol of a program; 0 is `Fault`.
    pub(crate) fn write(&mut self, program: usize, symbol: usize, value: Value) {
        let Some(running) = self.all.get_mut(program) else {
            return;
        };
        if let Some(symbol) = symbol
            .checked_sub(1)
            .and_then(|symbol| running.symbols.get(symbol))
        {
            // As for reading.
            let _there = running.guest.write(symbol, value);
        }
    }

    /// Takes what guests told into the trace.
    pub(crate) fn take_told(&mut self, script: &Script, notes: &mut Notes, trace: &mut Trace) {
        let scan = trace.scans().saturating_sub(1);
        for (running, program) in self.all.iter_mut().zip(&script.programs) {
            let mut note = |text| {
                trace.push_note(Note {
                    scan,
                    subject: program.name.clone(),
                    text,
                });
            };
            for told in running.guest.take_told() {
                match told {
                    Told::Line(line) => note(format!("says: {line}")),
                    Told::LinesLost(lost) => note(format!("{lost} lines more are lost")),
                    Told::Made { id, number, block } => {
                        let name = format!("{}.{block}.{number}", program.name);
                        note(format!("makes the instance {name}"));
                        notes.name(id.0, name);
                    }
                }
            }
            if let Some(fault) = &running.fault
                && !running.told
            {
                running.told = true;
                note(format!("faults: {fault}; the resource stops, axes ramp down"));
            }
        }
    }
}

fn start(program: &Program) -> Result<Running, RunError> {
    let wrong = |reason: String| RunError::Program {
        program: program.name.clone(),
        reason,
    };
    let guest = program.guest.start().map_err(|error| wrong(error.to_string()))?;
    let symbol = |symbol: &crate::model::Symbol| {
        let address = match symbol.address {
            Some(address) => address,
            None => guest
                .address_of(symbol.export.as_ref().unwrap_or(&symbol.name))
                .map_err(|error| wrong(error.to_string()))?,
        };
        Ok(Symbol {
            ty: symbol.own,
            address,
        })
    };
    let symbols = program.symbols.iter().skip(1).map(symbol);
    Ok(Running {
        symbols: symbols.collect::<Result<_, RunError>>()?,
        guest,
        fault: None,
        told: false,
    })
}

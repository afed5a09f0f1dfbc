//! The guest programs of a run.

use super::RunError;
use super::notes::Notes;
use crate::model::{Program, Script};
use standstill_fb::{Context, Value};
use standstill_guest::{Entry, Fault, Guest, Symbol, Told};
use standstill_st::{FAULT_SITE, FAULT_VALUE, LOOP_SITE};
use standstill_trace::{Note, Trace};

/// Running guests, in the order of the script.
#[derive(Debug, Default)]
pub(crate) struct Guests {
    all: Vec<Running>,
}

/// A statement of Structured Text, or a branch of one, and its number of executions.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Counted {
    /// Its file.
    pub file: String,
    /// The line of the statement.
    pub line: u32,
    /// The column, in characters from 1.
    pub column: u32,
    /// 0 for the statement; otherwise the number of one of its branches, from 1. The last one is ELSE.
    pub branch: u32,
    /// Number of executions.
    pub count: u64,
}

#[derive(Debug)]
struct Running {
    guest: Guest,
    /// The symbols behind `Fault`.
    symbols: Vec<Symbol>,
    /// The functions of its calls.
    entries: Vec<Entry>,
    fault: Option<Fault>,
    /// Whether the fault has been written to the trace.
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

    /// The execution counts of the statements of Structured Text so far.
    pub(crate) fn counted(&self, script: &Script) -> Vec<Counted> {
        let mut all = Vec::new();
        for (running, program) in self.all.iter().zip(&script.programs) {
            let counters = program.text.iter().flat_map(|text| text.symbols.counters());
            all.extend(counters.map(|counter| Counted {
                file: counter.file.clone(),
                line: counter.position.line,
                column: counter.position.column,
                branch: counter.branch,
                // Memory never shrinks, so it exists.
                count: running.guest.bits(counter.address, 8).unwrap_or(0),
            }));
        }
        all
    }

    /// The variables of a program in Structured Text.
    pub(crate) fn variables(&self, script: &Script, program: usize) -> Vec<super::Shown> {
        match (self.all.get(program), script.programs.get(program)) {
            (Some(running), Some(program)) => super::variables::shown(program, &running.guest),
            _ => Vec::new(),
        }
    }

    pub(crate) fn has_fault(&self) -> bool {
        self.all.iter().any(|running| running.fault.is_some())
    }

    /// One execution of a program, by one of its calls.
    pub(crate) fn scan(
        &mut self,
        index: usize,
        call: usize,
        context: &mut Context<'_>,
    ) -> Result<(), &'static str> {
        let Some(running) = self.all.get_mut(index) else {
            return Ok(());
        };
        let entry = running.entries.get(call).copied().unwrap_or(Entry::SCAN);
        running
            .guest
            .scan_entry(entry, context)
            .map(|_fuel| ())
            .map_err(|fault| {
                let reason = fault.reason();
                running.fault = Some(fault);
                reason
            })
    }

    /// Takes the present values of a program's symbols.
    pub(crate) fn refresh(&self, index: usize, values: &mut [Value]) {
        let (Some(running), [fault, values @ ..]) = (self.all.get(index), values) else {
            return;
        };
        *fault = Value::Bool(running.fault.is_some());
        for (symbol, value) in running.symbols.iter().zip(values) {
            // Memory never shrinks, so the memory of the start still exists.
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

    /// Takes the texts of guests into the trace.
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
                    Told::Made { id, key, .. } if instance(program, key).is_some() => {
                        // It exists from the start, so creating it is no event.
                        notes.name(id.0, instance(program, key).unwrap_or_default());
                    }
                    Told::Made {
                        id, number, block, ..
                    } => {
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
                let fault = place(program, &running.guest, fault).unwrap_or_else(|| fault.to_string());
                note(format!("faults: {fault}; the resource stops, axes ramp down"));
            }
        }
    }
}

/// The name of a block instance of Structured Text, by the address of its key.
fn instance(program: &Program, key: u32) -> Option<String> {
    program.text.as_ref()?.blocks.get(&key).cloned()
}

/// The place in the sources of a program's fault, and its reason.
fn place(program: &Program, guest: &Guest, fault: &Fault) -> Option<String> {
    let text = program.text.as_ref()?;
    let site = match fault {
        Fault::Trap(_) => FAULT_SITE,
        Fault::Fuel { .. } => LOOP_SITE,
        Fault::Pointer { .. } | Fault::Other(_) | Fault::Over => return None,
    };
    let number = u32::try_from(guest.bits(site, 4)?).ok()?;
    let place = text.symbols.place(number)?;
    // Notes do not depend on the folder from which the script is run.
    let file = place.file.strip_prefix(&text.folder).unwrap_or(&place.file);
    let (line, column) = (place.position.line, place.position.column);
    let mut says = format!("{file}:{line}:{column}: {}", place.kind.text());
    if let Fault::Fuel { most } = fault {
        says.push_str(&format!(", and the fuel of {most} is used up"));
    } else if let Some(value) = place.kind.value(guest.bits(FAULT_VALUE, 8)?.cast_signed()) {
        says.push_str(&format!(": {value}"));
    }
    Some(says)
}

fn start(program: &Program) -> Result<Running, RunError> {
    let wrong = |reason: String| RunError::Program {
        program: program.name.clone(),
        reason,
    };
    let mut guest = program.guest.start().map_err(|error| wrong(error.to_string()))?;
    let entries = program.calls.iter().map(|call| match &call.entry {
        None => Ok(Entry::SCAN),
        Some(name) => guest
            .entry(name)
            .ok_or_else(|| wrong(format!("it has no function `{name}`"))),
    });
    let entries = entries.collect::<Result<_, _>>()?;
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
        entries,
        guest,
        fault: None,
        told: false,
    })
}

//! `standstill plan`: one JSON object a line in, one a line out.

mod compare;
mod drawn;
mod fields;
mod grid;
mod methods;
mod online;
mod papers;
mod ramp;
mod refusal;
mod reply;
mod samples;
mod shaped;
mod shared;

use crate::exit::{Exit, Failure};
use crate::{limit, out};
use drawn::Drawn;
use fields::Fields;
use samples::Samples;
use std::io::{BufRead, Write};
use std::path::Path;

pub use compare::compare;
pub use fields::{Given, Member};
pub use methods::Planned;
pub use refusal::Refusal;

/// The files to write; absent ones are not wanted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Files<'a> {
    /// The set-points of every plan, as CSV.
    pub samples: Option<&'a Path>,
    /// A picture of the first plans.
    pub svg: Option<&'a Path>,
    /// A page of them.
    pub report: Option<&'a Path>,
}

/// Answers every line of `input` that is not blank, in order. `name` is the name of the input in
/// messages.
///
/// Flushes `out` before it waits for more input, so that a program can exchange lines with it.
pub fn plan(input: &mut dyn BufRead, name: &str, out: &mut dyn Write) -> Result<Exit, Failure> {
    answer(input, name, out, &mut |_| Ok(()))
}

/// The same as [`plan`]; planned lines also go to the files.
pub fn plan_to_files(
    input: &mut dyn BufRead,
    name: &str,
    files: Files<'_>,
    out: &mut dyn Write,
) -> Result<Exit, Failure> {
    let mut samples = files.samples.map(Samples::create).transpose()?;
    let mut drawn = Drawn::default();
    let exit = answer(input, name, out, &mut |plan| {
        if let Some(samples) = &mut samples {
            samples.add(plan.fields.id(), plan.planned)?;
        }
        drawn.add(files, plan)
    })?;
    if let Some(samples) = samples {
        samples.finish()?;
    }
    drawn.finish(files)?;
    Ok(exit)
}

/// Plans for a host that has the fields of a line separately, each key once. Returns the name of the
/// method, and the plan.
///
/// # Errors
/// [`Refusal`], as on a line.
pub fn planned(members: Vec<Member<'_>>) -> Result<(&'static str, Planned), Refusal> {
    methods::plan(&Fields::of_members(members).checked()?)
}

/// A line that was planned.
#[derive(Clone, Copy)]
struct Plan<'a> {
    fields: &'a Fields<'a>,
    method: &'a str,
    planned: &'a Planned,
}

/// Answers every line, and calls `each` with those that were planned.
fn answer(
    input: &mut dyn BufRead,
    name: &str,
    out: &mut dyn Write,
    each: &mut dyn FnMut(Plan<'_>) -> Result<(), Failure>,
) -> Result<Exit, Failure> {
    let mut exit = Exit::Passed;
    each_line(input, name, |_, line| {
        let (id, planned) = match Fields::of_line(line) {
            Ok(fields) => {
                let checked = fields.checked();
                let planned = checked.and_then(|fields| Ok((methods::plan(&fields)?, fields)));
                (fields.id(), planned)
            }
            Err(refusal) => ("null", Err(refusal)),
        };
        match planned {
            Ok(((method, planned), fields)) => {
                writeln!(out, "{}", reply::line(id, method, &planned))?;
                each(Plan {
                    fields: &fields,
                    method,
                    planned: &planned,
                })?;
            }
            Err(refusal) => {
                exit = Exit::Failed;
                writeln!(out, "{}", refusal.line(id))?;
            }
        }
        out.flush()?;
        Ok(())
    })?;
    Ok(exit)
}

/// Calls `each` for every line of `input` that is not blank, with its number from 1.
fn each_line(
    input: &mut dyn BufRead,
    name: &str,
    mut each: impl FnMut(usize, &[u8]) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let mut line = Vec::new();
    for number in 1.. {
        line.clear();
        limit::doing(format!("waiting for line {number} of {name}"));
        let read = input.read_until(b'\n', &mut line);
        if read.map_err(|error| Failure::io(name, &error))? == 0 {
            break;
        }
        let text = if number == 1 {
            line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&line)
        } else {
            &line
        };
        let text = text.trim_ascii();
        if !text.is_empty() {
            limit::doing(format!("line {number} of {name}"));
            each(number, text)?;
        }
        // The input may be endless, and the answers have no reader.
        if out::is_closed() {
            break;
        }
    }
    Ok(())
}

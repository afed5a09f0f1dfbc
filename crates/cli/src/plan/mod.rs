//! `standstill plan`: one JSON object a line in, one a line out.

mod compare;
mod fields;
mod grid;
mod methods;
mod online;
mod papers;
mod ramp;
mod refusal;
mod reply;
mod samples;
mod shared;

use crate::exit::{Exit, Failure};
use crate::{limit, out};
use fields::Fields;
use samples::Samples;
use std::io::{BufRead, Write};
use std::path::Path;

pub use compare::compare;

/// Answers every line of `input` that is not blank, in order. `name` stands for the input in messages.
/// Set-points go to the file `samples`.
///
/// Flushes `out` before it waits for more input, so that a program can hold a conversation.
pub fn plan(
    input: &mut dyn BufRead,
    name: &str,
    samples: Option<&Path>,
    out: &mut dyn Write,
) -> Result<Exit, Failure> {
    let mut exit = Exit::Passed;
    let mut samples = samples.map(Samples::create).transpose()?;
    each_line(input, name, |_, line| {
        let (id, planned) = match Fields::of_line(line) {
            Ok(fields) => {
                let planned = fields.checked().and_then(|fields| methods::plan(&fields));
                (fields.id(), planned)
            }
            Err(refusal) => ("null", Err(refusal)),
        };
        match planned {
            Ok((method, planned)) => {
                writeln!(out, "{}", reply::line(id, method, &planned))?;
                if let Some(samples) = &mut samples {
                    samples.add(id, &planned)?;
                }
            }
            Err(refusal) => {
                exit = Exit::Failed;
                writeln!(out, "{}", refusal.line(id))?;
            }
        }
        out.flush()?;
        Ok(())
    })?;
    if let Some(samples) = samples {
        samples.finish()?;
    }
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
        // There may be no end to the input, and nobody wants the answers.
        if out::is_closed() {
            break;
        }
    }
    Ok(())
}

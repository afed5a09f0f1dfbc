//! `standstill plan`: one JSON object a line in, one a line out.

mod fields;
mod grid;
mod methods;
mod online;
mod papers;
mod ramp;
mod refusal;
mod reply;
mod shared;

use crate::exit::{Exit, Failure};
use fields::Fields;
use std::io::{BufRead, Write};

/// Answers every line of `input` that is not blank, in order. `name` stands for the input in messages.
///
/// Flushes `out` before it waits for more input, so that a program can hold a conversation.
pub fn plan(input: &mut dyn BufRead, name: &str, out: &mut dyn Write) -> Result<Exit, Failure> {
    let mut exit = Exit::Passed;
    let mut line = Vec::new();
    let mut first = true;
    loop {
        line.clear();
        let read = input.read_until(b'\n', &mut line);
        if read.map_err(|error| Failure::io(name, &error))? == 0 {
            return Ok(exit);
        }
        let text = if first {
            line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(&line)
        } else {
            &line
        };
        first = false;
        let text = text.trim_ascii();
        if text.is_empty() {
            continue;
        }
        let (planned, answer) = answer(text);
        if !planned {
            exit = Exit::Failed;
        }
        writeln!(out, "{answer}")?;
        out.flush()?;
    }
}

/// Whether the line could be planned, and the line that answers it.
fn answer(line: &[u8]) -> (bool, String) {
    let fields = match Fields::of_line(line) {
        Ok(fields) => fields,
        Err(refusal) => return (false, refusal.line("null")),
    };
    match fields.checked().and_then(|fields| methods::plan(&fields)) {
        Ok((method, planned)) => (true, reply::line(fields.id(), method, &planned)),
        Err(refusal) => (false, refusal.line(fields.id())),
    }
}

//! Traces as a value change dump (IEEE 1364), which GTKWave, Surfer and other waveform viewers open.
//!
//! Axes and instances are scopes, input variables are in the scope `inputs`. BOOL is a wire, a number a
//! real, a whole number an integer of 64 bits; states and other names are strings, an extension that both
//! viewers know. Only changes are written. The dump ends a scan after the last row, so that this one also
//! has a width.

use std::io::{self, Write};

use crate::column::{Cell, Column, Kind};
use crate::events::{VARIABLES, same};
use crate::number::shortest;
use crate::trace::Trace;

/// Writes the trace. Text that the form cannot have is changed: blanks in names become `_`, an empty name
/// `-`.
///
/// # Errors
/// Those of `out`.
pub fn write(trace: &Trace, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "$version standstill {} $end", word(&trace.header().runtime))?;
    writeln!(out, "$timescale 1 ns $end")?;
    writeln!(out, "$scope module standstill $end")?;
    declare(trace.columns(), out)?;
    writeln!(out, "$upscope $end\n$enddefinitions $end")?;
    let mut before: Vec<Option<Cell<'_>>> = vec![None; trace.columns().len()];
    for scan in 0..trace.scans() {
        let mut told = false;
        for (at, (cell, before)) in trace.row(scan).zip(&mut before).enumerate() {
            if before.is_none_or(|before| !same(before, cell)) {
                if !told {
                    writeln!(out, "#{}", trace.time_ns(scan))?;
                    told = true;
                }
                writeln!(out, "{}{}", change(cell), code(at))?;
                *before = Some(cell);
            }
        }
    }
    writeln!(out, "#{}", trace.time_ns(trace.scans()))
}

/// The variables, a scope for each run of columns of one subject.
fn declare(columns: &[Column], out: &mut impl Write) -> io::Result<()> {
    let mut rest = columns.iter().enumerate().peekable();
    while let Some((at, first)) = rest.next() {
        let subject = first.subject();
        let scope = if subject.is_empty() { VARIABLES } else { subject };
        writeln!(out, "$scope module {} $end", word(scope))?;
        variable(at, first, out)?;
        while let Some((at, column)) = rest.next_if(|(_, column)| column.subject() == subject) {
            variable(at, column, out)?;
        }
        writeln!(out, "$upscope $end")?;
    }
    Ok(())
}

fn variable(at: usize, column: &Column, out: &mut impl Write) -> io::Result<()> {
    let kind = match column.kind {
        Kind::Bool => "wire 1",
        Kind::Real => "real 64",
        Kind::Integer => "integer 64",
        Kind::Name => "string 1",
    };
    writeln!(out, "$var {kind} {} {} $end", code(at), word(column.signal()))
}

/// A value in the form before the code of its variable.
fn change(cell: Cell<'_>) -> String {
    match cell {
        Cell::Bool(value) => u8::from(value).to_string(),
        Cell::Real(value) => format!("r{} ", shortest(value)),
        // Two's complement.
        Cell::Integer(value) => format!("b{value:b} "),
        Cell::Name(text) => format!("s{} ", word(text)),
    }
}

/// The short name of a variable: its number in digits from `!` to `~`, the lowest first.
fn code(mut number: usize) -> String {
    let mut code = String::new();
    loop {
        // Below 127, so it is a character of its own.
        code.push(char::from(b'!' + (number % 94) as u8));
        number /= 94;
        if number == 0 {
            return code;
        }
        number -= 1;
    }
}

/// Text as one word.
fn word(text: &str) -> String {
    if text.is_empty() {
        return "-".to_owned();
    }
    let plain = |character: char| {
        if character.is_whitespace() || character.is_control() {
            '_'
        } else {
            character
        }
    };
    text.chars().map(plain).collect()
}

#[cfg(test)]
mod tests {
    use super::code;
    use std::collections::BTreeSet;

    #[test]
    fn codes_are_short_printable_and_all_different() {
        let codes: Vec<String> = (0..20_000).map(code).collect();
        assert!(
            codes
                .iter()
                .all(|code| code.len() <= 3 && code.bytes().all(|byte| (33..127).contains(&byte)))
        );
        assert_eq!(codes.iter().collect::<BTreeSet<_>>().len(), codes.len());
        assert_eq!(
            (code(0), code(93), code(94)),
            ("!".into(), "~".into(), "!!".into())
        );
    }
}

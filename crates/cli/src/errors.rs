//! `standstill blocks --error` and `standstill explain-error`: the meaning and the remedy of an ErrorID.

use crate::exit::{Exit, Failure};
use crate::suggest::nearest;
use standstill_script::ErrorId;
use std::io::Write;

/// Prints the error with this number or name.
pub fn explain(wanted: &str, out: &mut dyn Write) -> Result<Exit, Failure> {
    let error = find(wanted).ok_or_else(|| unknown(wanted))?;
    let (number, name) = (error.number(), error.name());
    writeln!(
        out,
        "{number} {name}\n    {}\n    remedy: {}",
        error.cause(),
        error.remedy()
    )?;
    Ok(Exit::Passed)
}

fn find(wanted: &str) -> Option<ErrorId> {
    if let Ok(number) = wanted.parse() {
        return ErrorId::from_number(number);
    }
    let named = |error: &&ErrorId| error.name().eq_ignore_ascii_case(wanted);
    ErrorId::ALL.iter().find(named).copied()
}

fn unknown(wanted: &str) -> Failure {
    let remedy = match wanted.parse::<u16>() {
        // The hundreds give the subject of an error.
        Ok(number) => {
            let of_class = ErrorId::ALL
                .iter()
                .filter(|error| error.number() / 100 == number / 100);
            let numbers: Vec<_> = of_class.map(|error| error.number().to_string()).collect();
            match &numbers[..] {
                [] => "numbers are from 100 to 999".to_owned(),
                numbers => format!("of its hundred there are {}", numbers.join(", ")),
            }
        }
        Err(_) => nearest(wanted, ErrorId::ALL.iter().map(|error| error.name())).map_or_else(
            || "give a number such as 201, or a name such as NotPowered".to_owned(),
            |name| format!("did you mean `{name}`?"),
        ),
    };
    Failure::usage(&format!("there is no ErrorID {wanted}; {remedy}"))
}

//! Reasons in words.

use standstill_axis::ErrorId;

/// An error with its remedy: `201 NotPowered: switch it on with MC_Power and wait for Status`. `told` has its
/// number, its name and other known facts.
pub(super) fn error(told: &str, id: ErrorId) -> String {
    format!("{told}: {}", phrase(id.remedy()))
}

/// A sentence as part of another: without its full stop, and in lower case unless it begins with a name.
pub(super) fn phrase(sentence: &str) -> String {
    let sentence = sentence.trim_end_matches('.');
    let word = sentence.split(' ').next().unwrap_or_default();
    let is_name = word.chars().skip(1).any(|letter| !letter.is_lowercase());
    let mut letters = sentence.chars();
    match letters.next() {
        Some(first) if !is_name => first.to_lowercase().chain(letters).collect(),
        _ => sentence.to_owned(),
    }
}

/// The error that a note begins with, `201 NotPowered, ..`.
pub(super) fn error_of(told: &str) -> Option<ErrorId> {
    let number = told.split([' ', ',']).next()?;
    ErrorId::from_number(number.parse().ok()?)
}

/// A note as a line of its own, if it reports a refusal, a fault or a changed value.
pub(super) fn noted(subject: &str, scan: u64, text: &str) -> Option<String> {
    if let Some(told) = text.strip_prefix("refused: ") {
        return Some(format!(
            "{subject} was refused in scan {scan}: {}",
            error(told, error_of(told)?)
        ));
    }
    if let Some(told) = text.strip_prefix("fault ") {
        return Some(format!(
            "{subject} went to ErrorStop in scan {scan}: {}",
            error(told, error_of(told)?)
        ));
    }
    changed(subject, scan, text)
}

/// `move.Velocity was clamped in scan 5: 25000.0 to 50.0`, with the likely cause.
pub(super) fn changed(subject: &str, scan: u64, text: &str) -> Option<String> {
    let (how, told) = text.split_once(": ")?;
    if !matches!(how, "clamped" | "raised" | "slowed") {
        return None;
    }
    let (pin, values) = told.split_once(' ')?;
    let (from, to) = values.split_once(" to ")?;
    if how == "slowed" {
        return Some(format!(
            "{subject}.{pin} was lowered in scan {scan} to what a slave can follow: {from} to {to}"
        ));
    }
    let hint = per_minute(pin, from, to);
    Some(format!(
        "{subject}.{pin} was {how} in scan {scan}: {from} to {to}{hint}"
    ))
}

/// A velocity sixty times too large is probably per minute.
fn per_minute(pin: &str, from: &str, to: &str) -> String {
    let numbers = from.parse::<f64>().ok().zip(to.parse::<f64>().ok());
    match numbers {
        Some((from, to)) if pin == "Velocity" && to > 0.0 && from >= 20.0 * to => {
            "; velocities are per second: is this one per minute?".to_owned()
        }
        _ => String::new(),
    }
}

/// ` scan 7` or ` scans 7 to 9`.
pub(super) fn scans(from: u64, to: u64) -> String {
    if from == to {
        format!("scan {from}")
    } else {
        format!("scans {from} to {to}")
    }
}

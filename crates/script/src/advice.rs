//! Hints for legal scripts that may not do what their author means.

use standstill_axis::{HomeDirection, Homing, Procedure};
use standstill_drives::switches::Switches;
use standstill_trace::shortest;

/// The position of a homing's reference relative to the start of the search (u). `None` on a modulo axis, or if the
/// search has no single target.
struct Way {
    what: &'static str,
    from: f64,
    to: f64,
    up: bool,
}

fn way(start: f64, homing: &Homing, switches: &Switches) -> Option<Way> {
    if switches.turn.is_some() {
        return None;
    }
    let is_on = switches
        .home
        .is_some_and(|(from, to)| (from..=to).contains(&start));
    let up = match homing.direction {
        HomeDirection::Positive => true,
        HomeDirection::Negative => false,
        HomeDirection::SwitchPositive => !is_on,
        HomeDirection::SwitchNegative => is_on,
    };
    let (what, from, to) = match homing.procedure {
        Procedure::AbsoluteSwitch => {
            let (from, to) = switches.home?;
            ("home switch", from, to)
        }
        Procedure::ReferencePulse => {
            let marker = switches.marker.filter(|marker| marker.every.is_none())?;
            ("reference pulse", marker.at, marker.at)
        }
        Procedure::LimitSwitch | Procedure::Direct | Procedure::Block | Procedure::Drive => return None,
    };
    Some(Way { what, from, to, up })
}

/// A sentence with the place of the reference that a homing searches; it says so if that is behind the
/// search.
pub(crate) fn reference(axis: &str, start: f64, homing: &Homing, switches: &Switches) -> Option<String> {
    let Way { what, from, to, up } = way(start, homing, switches)?;
    let side = match behind(start, from, to, up) {
        true => ", which is behind the search",
        false => "",
    };
    let place = if from == to {
        format!("at {}", shortest(from))
    } else {
        format!("from {} to {}", shortest(from), shortest(to))
    };
    let direction = if up { "positive" } else { "negative" };
    Some(format!(
        "the {what} of {axis} is {place}{side}: it begins at {} in {direction} direction",
        shortest(start)
    ))
}

/// The same as [`reference`], but only if the reference is behind the search.
pub(crate) fn reference_behind(
    axis: &str,
    start: f64,
    homing: &Homing,
    switches: &Switches,
) -> Option<String> {
    let Way { from, to, up, .. } = way(start, homing, switches)?;
    let text = reference(axis, start, homing, switches)?;
    behind(start, from, to, up).then_some(text)
}

fn behind(start: f64, from: f64, to: f64, up: bool) -> bool {
    if up { to < start } else { from > start }
}

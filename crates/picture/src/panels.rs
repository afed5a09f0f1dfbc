//! The contents of pictures of a trace: curves of axes, waves of Booleans.

use standstill_trace::{Axis, Cell, Column, Kind, Role, Trace, axis_title, fixed};

/// One signal of one axis over all scans.
pub struct Curve<'a> {
    /// Its axis.
    pub axis: &'a Axis,
    /// The signal, of [`standstill_trace::AXIS_SIGNALS`].
    pub signal: &'a str,
    /// Name and unit.
    pub title: String,
    /// One value for each scan.
    pub values: Vec<f64>,
    /// Least finite value.
    pub least: f64,
    /// Greatest finite value.
    pub greatest: f64,
}

/// The `signals` of every axis that the trace has, axis by axis.
pub fn curves<'a>(trace: &'a Trace, signals: &'a [&'a str]) -> Vec<Curve<'a>> {
    let axes = trace.header().axes.iter();
    let wanted = axes.flat_map(|axis| signals.iter().map(move |signal| (axis, *signal)));
    wanted
        .filter_map(|(axis, signal)| {
            let values: Vec<f64> = trace
                .reals(trace.column(&format!("{}.{signal}", axis.name))?)
                .collect();
            let finite = values.iter().copied().filter(|value| value.is_finite());
            let [least, greatest] = [finite.clone().reduce(f64::min)?, finite.reduce(f64::max)?];
            Some(Curve {
                axis,
                signal,
                title: title(axis, signal),
                values,
                least,
                greatest,
            })
        })
        .collect()
}

fn title(axis: &Axis, signal: &str) -> String {
    let per = match signal {
        _ if axis.unit.is_empty() => "",
        "Velocity" => "/s",
        "Acceleration" => "/s^2",
        "Jerk" => "/s^3",
        "Snap" => "/s^4",
        _ => "",
    };
    let title = axis_title(axis).replacen(&axis.name, &format!("{}.{signal}", axis.name), 1);
    title
        .strip_suffix(')')
        .map_or(title.clone(), |start| format!("{start}{per})"))
}

/// A Boolean over all scans.
pub struct Wave {
    /// Name of its column.
    pub name: String,
    /// The role of its column.
    pub role: Role,
    /// One level for each scan.
    pub levels: Vec<bool>,
}

impl Wave {
    /// The Boolean of a column with these cells.
    pub fn new<'t>(column: &Column, cells: impl Iterator<Item = Cell<'t>>) -> Self {
        Self {
            name: column.name.clone(),
            role: column.role,
            levels: cells.map(|cell| cell == Cell::Bool(true)).collect(),
        }
    }
}

/// The Booleans that change.
pub fn waves(trace: &Trace) -> Vec<Wave> {
    let columns = trace
        .columns()
        .iter()
        .enumerate()
        .filter(|(_, column)| column.kind == Kind::Bool);
    columns
        .map(|(at, column)| Wave::new(column, trace.cells(at)))
        .filter(|wave| wave.levels.windows(2).any(|pair| pair[0] != pair[1]))
        .collect()
}

/// A number for a label: no zeros at its end.
pub fn compact(value: f64) -> String {
    let text = fixed(value);
    if text.contains('e') || !text.contains('.') {
        return text;
    }
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

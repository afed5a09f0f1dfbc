//! The columns that claims and steps read. A recording needs them to be judged. A run that nobody reads need keep
//! no others.

use super::layout::Layout;
use crate::model::{AxisNumber, Claim, ClaimKind, Condition, Point, Script, Signal, When};
use standstill_trace::Column;
use std::collections::BTreeSet;

/// The columns that claims, steps and the end of the run read, and those of `names`; `all` are the columns of the
/// script's own trace.
pub(super) fn columns(script: &Script, all: &[Column], names: &[String]) -> BTreeSet<usize> {
    let mut read = Vec::new();
    for step in &script.steps {
        if let When::Holds { conditions, .. } = &step.when {
            read.extend(conditions.iter().flat_map(Condition::signals).cloned());
        }
    }
    if let Some((conditions, _)) = &script.stop_when {
        read.extend(conditions.iter().flat_map(Condition::signals).cloned());
    }
    for claim in &script.claims {
        read.extend(signals(claim));
        // If a recording lacks these, they are 0.
        if let ClaimKind::Follows(follow) = &claim.kind {
            let numbers = [AxisNumber::Phase, AxisNumber::Superimposed];
            read.extend(numbers.map(|number| Signal::Axis(follow.slave, number)));
        }
    }
    let formulas = script.formulas.iter().filter(|formula| formula.in_rows);
    read.extend(formulas.flat_map(|formula| formula.inputs.iter().map(|input| input.signal.clone())));
    let layout = Layout::new(script);
    let named = (0..).zip(all);
    let named = named.filter(|(_, column)| names.contains(&column.name));
    let read = read.iter().filter_map(|signal| column(&layout, signal));
    let mut columns: BTreeSet<usize> = read.chain(named.map(|(place, _)| place)).collect();
    // A trace counts its rows by their cells.
    if columns.is_empty() {
        columns.insert(0);
    }
    columns
}

/// The column from which a signal is read.
pub(super) fn column(layout: &Layout, signal: &Signal) -> Option<usize> {
    match *signal {
        Signal::Difference(axis, _) => layout.number(axis, AxisNumber::Position),
        _ => layout.column(signal),
    }
}

/// All signals that a claim reads.
pub(crate) fn signals(claim: &Claim) -> Vec<Signal> {
    let mut found = Vec::new();
    match &claim.kind {
        ClaimKind::Exclusive(points) => {
            found.extend(points.iter().map(|(_, point): &(_, Point)| Signal::Point(*point)));
        }
        ClaimKind::WithinLimits { axis, .. } => found.push(Signal::Axis(*axis, AxisNumber::Position)),
        ClaimKind::Follows(follow) => {
            found.extend([follow.slave, follow.master].map(|axis| Signal::Axis(axis, AxisNumber::Position)));
        }
        _ => {}
    }
    let window = claim.window.from.iter().chain(&claim.window.to).flatten();
    let conditions = claim.conditions().chain(window);
    found.extend(conditions.flat_map(Condition::signals).cloned());
    found
}

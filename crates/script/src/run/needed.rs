//! The columns that claims and steps read. A recording needs them to be judged. A run that nobody reads need keep
//! no others.

use super::layout::Layout;
use crate::model::{AxisNumber, Claim, ClaimKind, Comparison, Condition, Point, Script, Signal, Test, When};
use standstill_trace::Column;
use std::collections::BTreeSet;

/// The columns that claims, steps and the end of the run read, and those of `names`; `all` are the columns of the
/// script's own trace.
pub(super) fn columns(script: &Script, all: &[Column], names: &[String]) -> BTreeSet<usize> {
    let mut read = Vec::new();
    for step in &script.steps {
        if let When::Holds { conditions, .. } = &step.when {
            all_of(conditions, &mut read);
        }
    }
    if let Some((conditions, _)) = &script.stop_when {
        all_of(conditions, &mut read);
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

/// All signals that conditions read.
fn all_of<'c>(conditions: impl IntoIterator<Item = &'c Condition>, found: &mut Vec<Signal>) {
    for condition in conditions {
        found.push(condition.signal.clone());
        compared(&condition.test, found);
    }
}

/// The column of a signal.
pub(super) fn column(layout: &Layout, signal: &Signal) -> Option<usize> {
    match *signal {
        Signal::Point(point) => layout.point(point),
        Signal::State(axis) => layout.state(axis),
        Signal::Master(axis, which) => layout.master(axis, which),
        Signal::Axis(axis, number) => layout.number(axis, number),
        Signal::Difference(axis, _) => layout.number(axis, AxisNumber::Position),
        Signal::Formula(_) => None,
    }
}

/// All signals that a claim reads.
pub(super) fn signals(claim: &Claim) -> Vec<Signal> {
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
    all_of(claim.conditions().chain(window), &mut found);
    found
}

/// The signals that a test compares with.
fn compared(test: &Test, found: &mut Vec<Signal>) {
    let Test::Compare(comparisons) = test else {
        return;
    };
    for comparison in comparisons {
        match comparison {
            Comparison::SameAs(_, other) | Comparison::NearTo { of: other, .. } => found.push(other.clone()),
            // A script's nesting is bounded by its reader.
            Comparison::Ne(inner) => compared(inner, found),
            Comparison::Near { .. }
            | Comparison::Le(_)
            | Comparison::Ge(_)
            | Comparison::Lt(_)
            | Comparison::Gt(_)
            | Comparison::AbsLe(_)
            | Comparison::Whole(..) => {}
        }
    }
}

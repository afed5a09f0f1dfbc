//! Claims that test nothing.

use super::Warning;
use crate::claims::relative::scans_of;
use crate::claims::{judges_a_row, relative};
use crate::model::{Action, Claim, ClaimKind, Comparison, Condition, Point, Script, Signal, Test};
use crate::run::Rows;
use standstill_trace::{Cell, shortest};

/// Looks at every claim.
pub(super) fn look(rows: &Rows<'_>, all: &mut Vec<Warning>) {
    // Claims on faults of programs have no text of their own.
    let claims = rows
        .script
        .claims
        .iter()
        .filter(|claim| claim.path.starts_with("expect["));
    for claim in claims.filter(|claim| !claim.may_be_vacuous) {
        if let Some(why) = relative::asks_nothing(rows, claim).or_else(|| never_asked(rows, claim)) {
            all.push(Warning::vacuous(claim.path.clone(), claim.span, why));
        }
        for condition in conditions(&claim.kind) {
            if let Some(why) = constant(rows, condition) {
                all.push(Warning::vacuous(claim.path.clone(), condition.span, why));
            } else if let Some(why) = too_wide(rows, condition) {
                all.push(Warning::vacuous(claim.path.clone(), condition.span, why));
            }
        }
    }
}

/// The reason why a claim is never checked.
fn never_asked(rows: &Rows<'_>, claim: &Claim) -> Option<String> {
    let during = &claim.during;
    match &claim.kind {
        ClaimKind::Always(_) | ClaimKind::Never(_)
            if !during.is_empty() && !scans_of(rows, claim.range).any(|scan| rows.hold(during, scan)) =>
        {
            Some("the claim asks for nothing: its `while` held in no scan".to_owned())
        }
        ClaimKind::Follows(_) if !judges_a_row(rows, claim) => {
            Some("the claim asks for nothing: its `while` held in no two scans on end".to_owned())
        }
        _ => None,
    }
}

/// All conditions that a claim checks, without those that say when.
fn conditions(kind: &ClaimKind) -> &[Condition] {
    match kind {
        ClaimKind::At(that)
        | ClaimKind::By(that)
        | ClaimKind::Once(that)
        | ClaimKind::Always(that)
        | ClaimKind::Never(that)
        | ClaimKind::Answered { that, .. }
        | ClaimKind::NeverFor { that, .. }
        | ClaimKind::Count { that, .. } => that,
        ClaimKind::Exclusive(_)
        | ClaimKind::WithinLimits { .. }
        | ClaimKind::Follows(_)
        | ClaimKind::Duration { .. } => &[],
    }
}

/// The reason why a condition cannot change: nothing wires or sets its signal.
fn constant(rows: &Rows<'_>, condition: &Condition) -> Option<String> {
    let is_constant = match condition.signal {
        Signal::Point(point) => is_constant(rows.script, point),
        Signal::Formula(formula) => {
            let inputs = rows.script.formulas.get(formula).map(|found| &found.inputs);
            let mut inputs = inputs?.iter();
            inputs
                .all(|input| matches!(input.signal, Signal::Point(point) if is_constant(rows.script, point)))
        }
        Signal::State(_) | Signal::Master(..) | Signal::Axis(..) | Signal::Difference(..) => false,
    };
    is_constant.then(|| {
        format!(
            "the claim on {} tests nothing: no wire and no step writes it",
            condition.text
        )
    })
}

/// Whether a point is an input, of the script or of a block, that keeps its value in every run.
fn is_constant(script: &Script, point: Point) -> bool {
    let is_input = match point {
        Point::Input(_) => true,
        Point::Pin(instance, pin) => {
            let found = script.blocks.get(instance);
            found.is_some_and(|found| {
                let wired = found.wires.iter().any(|(wired, _)| *wired == pin);
                pin < found.block.input_count() && !wired
            })
        }
        Point::Symbol(..) | Point::Formula(_) => false,
    };
    let mut actions = script.steps.iter().flat_map(|step| &step.actions);
    let is_set = actions.any(|action| matches!(action, Action::Set(set, _) if *set == point));
    is_input && !is_set
}

/// The reason why a tolerance accepts every value of the signal.
fn too_wide(rows: &Rows<'_>, condition: &Condition) -> Option<String> {
    let Test::Compare(comparisons) = &condition.test else {
        return None;
    };
    let within = comparisons.iter().find_map(|comparison| match comparison {
        Comparison::Near { within, .. } => Some(*within),
        _ => None,
    })?;
    let values = (0..rows.count()).filter_map(|scan| match rows.cell(&condition.signal, scan)? {
        Cell::Real(value) if value.is_finite() => Some(value),
        Cell::Integer(value) => Some(value as f64),
        _ => None,
    });
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
        (low.min(value), high.max(value))
    });
    let range = high - low;
    (range > 0.0 && within > range).then(|| {
        format!(
            "the claim on {} tests nothing: it allows {} on both sides, and all values lie within {}",
            condition.text,
            shortest(within),
            shortest(range)
        )
    })
}

//! Inputs without a reader, blocks without effect, axes without commands.

use super::Warning;
use crate::model::{Action, Condition, Instance, Point, Script, Signal, When, Wire};
use crate::run::{Rows, signals};
use standstill_trace::Cell;
use std::collections::BTreeSet;

/// Checks every input variable, block, program and axis.
pub(super) fn look(rows: &Rows<'_>, all: &mut Vec<Warning>) {
    let script = rows.script;
    let read = read_inputs(script);
    for (index, input) in script.inputs.iter().enumerate() {
        if !input.place.may_be_vacuous && !read.contains(&index) {
            let message = format!("the input {} is read by no wire, step or claim", input.name);
            all.push(Warning::vacuous(
                format!("inputs.{}", input.name),
                input.place.span,
                message,
            ));
        }
    }
    let idle: Vec<bool> = (0..script.tasks.len())
        .map(|task| never_runs(rows, task))
        .collect();
    let is_idle = |task: usize| idle.get(task).copied().unwrap_or(false);
    for (index, instance) in script.blocks.iter().enumerate() {
        if instance.place.may_be_vacuous {
            continue;
        }
        let name = &instance.name;
        let message = if is_idle(instance.task) {
            Some(format!("{name} is never called: its task never runs"))
        } else {
            never_commanded(rows, index, instance)
        };
        if let Some(message) = message {
            all.push(Warning::vacuous(
                format!("blocks[{index}]"),
                instance.place.span,
                message,
            ));
        }
    }
    for program in &script.programs {
        let runs = program.calls.iter().any(|call| !call.task.is_some_and(is_idle));
        if !runs && !program.place.may_be_vacuous {
            let message = format!(
                "the program {} never runs: no task that runs calls it",
                program.name
            );
            let path = format!("programs.{}", program.name);
            all.push(Warning::vacuous(path, program.place.span, message));
        }
    }
    for (index, axis) in script.axes.iter().enumerate() {
        if !axis.place.may_be_vacuous && !is_commanded(script, index) {
            let message = format!("no block commands the axis {}", axis.name);
            all.push(Warning::vacuous(
                format!("axes.{}", axis.name),
                axis.place.span,
                message,
            ));
        }
    }
}

/// The input variables that wires, steps or claims read.
fn read_inputs(script: &Script) -> BTreeSet<usize> {
    let wires = script.blocks.iter().flat_map(|block| &block.wires);
    let wires = wires.map(|(_, wire)| wire);
    let singles = script.tasks.iter().filter_map(|task| task.single.as_ref());
    let wired = wires.chain(singles).flat_map(Wire::points).copied();
    let of_formulas = script.formulas.iter().flat_map(|formula| &formula.inputs);
    let of_formulas = of_formulas.map(|input| input.signal.clone());
    let whens = script.steps.iter().filter_map(|step| match &step.when {
        When::Holds { conditions, .. } => Some(conditions),
        When::At(_) => None,
    });
    let stop = script.stop_when.iter().map(|(conditions, _)| conditions);
    let of_steps = whens.chain(stop).flatten();
    let of_steps = of_steps.flat_map(Condition::signals).cloned();
    let of_claims = script.claims.iter().flat_map(signals);
    let points = of_formulas.chain(of_steps).chain(of_claims);
    let points = points.filter_map(|signal| match signal {
        Signal::Point(point) => Some(point),
        _ => None,
    });
    wired
        .chain(points)
        .filter_map(|point| match point {
            Point::Input(index) => Some(index),
            Point::Pin(..) | Point::Symbol(..) | Point::Formula(_) => None,
        })
        .collect()
}

/// Whether a task has neither an interval nor an edge that starts it.
pub(crate) fn never_runs(rows: &Rows<'_>, task: usize) -> bool {
    let Some(task) = rows.script.tasks.get(task) else {
        return false;
    };
    let Some(single) = task.single.as_ref().filter(|_| task.interval.is_none()) else {
        return false;
    };
    // A wire with `not` may start it in any scan.
    let ever = |point: &Point| is_ever(rows, *point);
    match single {
        Wire::Not(_) => false,
        Wire::From(point) => !ever(point),
        Wire::Any(points) => !points.iter().any(ever),
        Wire::All(points) => !points.iter().all(ever),
    }
}

/// Whether a point is TRUE in some scan.
fn is_ever(rows: &Rows<'_>, point: Point) -> bool {
    let signal = Signal::Point(point);
    (0..rows.count()).any(|scan| rows.cell(&signal, scan) == Some(Cell::Bool(true)))
}

/// The reason why a block has nothing to do in the whole run.
fn never_commanded(rows: &Rows<'_>, index: usize, instance: &Instance) -> Option<String> {
    let triggers: Vec<(usize, &str)> = instance.triggers().collect();
    let any = triggers
        .iter()
        .any(|(pin, _)| is_ever(rows, Point::Pin(index, *pin)));
    if any || triggers.is_empty() {
        return None;
    }
    let names: Vec<&str> = triggers.iter().map(|(_, name)| *name).collect();
    Some(format!(
        "{} is never commanded: {} is FALSE in every scan",
        instance.name,
        names.join(" and ")
    ))
}

/// Whether the axis is at a pin of a block that does more than read, or a step or a program acts on it.
fn is_commanded(script: &Script, axis: usize) -> bool {
    let commands =
        |instance: &Instance| !instance.block.name.starts_with("MC_Read") && instance.has_axis(axis);
    let mut actions = script.steps.iter().flat_map(|step| &step.actions);
    let acts = actions.any(|action| match action {
        Action::Fault { axis: on, .. } | Action::Clear { axis: on } | Action::Drive { axis: on, .. } => {
            *on == axis
        }
        Action::Set(..) => false,
    });
    acts || !script.programs.is_empty() || script.blocks.iter().any(commands)
}

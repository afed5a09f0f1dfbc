//! The lints, each by its code.

use super::facts::{Call, Facts, Variable};
use crate::check::{Program, UnitKind};
use crate::error::{Code, Diagnostic};
use crate::typed::Base;
use crate::types::{Member, MemberKind, Type, UnitId};
use std::collections::{BTreeMap, BTreeSet};

/// All findings.
pub(super) fn all(program: &Program<'_>, facts: &Facts) -> Vec<Diagnostic> {
    let mut told = Vec::new();
    let mut by_variable: BTreeMap<Variable, Vec<&Call>> = BTreeMap::new();
    for call in &facts.calls {
        by_variable.entry(call.variable).or_default().push(call);
    }
    for (variable, calls) in &by_variable {
        if !facts.always.contains(variable) {
            not_always(program, calls, &mut told);
        }
        twice(program, calls, &mut told);
        always_true(program, facts, calls, &mut told);
    }
    two_writers(program, facts, &mut told);
    refusals(program, facts, &by_variable, &mut told);
    unused(program, facts, &mut told);
    for span in &facts.equal {
        let message = "two numbers with a point are compared for being equal to the bit";
        told.push(
            Diagnostic::warning(Code::St55, *span, message)
                .help("compare their difference: ABS(a - b) < 0.001"),
        );
    }
    for (span, before) in &facts.narrowed {
        let message = format!(
            "the value is {} before it is made wider and narrow again",
            before.name()
        );
        told.push(Diagnostic::warning(Code::St56, *span, message).help("leave the conversion out"));
    }
    for span in &facts.unreachable {
        let message = "no value leads to this branch of the CASE";
        told.push(Diagnostic::warning(Code::St57, *span, message));
    }
    told
}

fn member<'p>(program: &'p Program<'_>, variable: Variable) -> Option<&'p Member> {
    match variable.unit {
        None => program.globals.get(variable.member).map(|global| &global.member),
        Some(unit) => program.unit(unit).members.list.get(variable.member),
    }
}

fn name<'p>(program: &'p Program<'_>, variable: Variable) -> &'p str {
    member(program, variable).map_or("", |member| &member.name)
}

/// The block of a call, if it is one of motion.
fn motion(program: &Program<'_>, unit: UnitId) -> bool {
    matches!(program.unit(unit).kind, UnitKind::Library(info) if info.name.starts_with("MC_"))
}

/// The offset of the pin of a unit in an instance.
fn pin(program: &Program<'_>, unit: UnitId, key: &str) -> Option<u32> {
    let found = program.unit(unit).members.find(key);
    found.map(|(_, member)| member.offset)
}

/// ST50: there is a path on which a motion block is not called.
fn not_always(program: &Program<'_>, calls: &[&Call], told: &mut Vec<Diagnostic>) {
    let Some(first) = calls.first().filter(|call| motion(program, call.callee)) else {
        return;
    };
    let name = name(program, first.variable);
    let message = format!(
        "`{name}` is not called in every scan: while it is not, its outputs stand still and an edge may be missed"
    );
    told.push(
        Diagnostic::warning(Code::St50, first.span, message)
            .help("call it on every path, and say in Execute or Enable when it works"),
    );
}

/// ST54: one block is called twice on one path.
fn twice(program: &Program<'_>, calls: &[&Call], told: &mut Vec<Diagnostic>) {
    for (place, second) in calls.iter().enumerate() {
        let on_path = |first: &&&Call| {
            first.place == second.place
                && !first.indexed
                && !second.indexed
                && first.lists.last().is_some_and(|list| second.lists.contains(list))
        };
        if let Some(first) = calls.iter().take(place).find(on_path) {
            let name = name(program, second.variable);
            let message = format!("`{name}` is called a second time in the same scan");
            told.push(
                Diagnostic::warning(Code::St54, second.span, message).related(first.span, "the first one"),
            );
        }
    }
}

/// ST51: Execute is always TRUE.
fn always_true(program: &Program<'_>, facts: &Facts, calls: &[&Call], told: &mut Vec<Diagnostic>) {
    let Some(first) = calls.first().filter(|call| motion(program, call.callee)) else {
        return;
    };
    let Some(execute) = pin(program, first.callee, "EXECUTE") else {
        return;
    };
    let given = |call: &Call| call.inputs.iter().find(|(at, ..)| *at == execute).copied();
    // A call that does not give this input uses the value that a statement has written to it.
    let is_written = facts.assigned.contains(&(first.variable, execute));
    let may_be_false = |call: &Call| given(call).map_or(is_written, |(_, value, _)| !value);
    let others = calls.iter().filter(|call| may_be_false(call));
    let others: BTreeSet<(Base, u32)> = others.map(|call| call.place).collect();
    let any_other = calls.iter().any(|call| call.indexed && may_be_false(call));
    for call in calls {
        let Some((_, true, span)) = given(call) else {
            continue;
        };
        if any_other || others.contains(&call.place) || call.indexed && !others.is_empty() {
            continue;
        }
        let message = "Execute is always TRUE: it rises once, and never again";
        told.push(Diagnostic::warning(Code::St51, span, message).help("give it a condition"));
    }
}

/// The variable to which a call writes an output: its unit, and the place.
type Target = (Option<UnitId>, Base, u32);

/// ST52: two instances write one variable.
fn two_writers(program: &Program<'_>, facts: &Facts, told: &mut Vec<Diagnostic>) {
    // The first call that writes each variable, and the first one of another instance.
    let mut writers: BTreeMap<Target, (&Call, Option<&Call>)> = BTreeMap::new();
    for call in &facts.calls {
        for (base, offset, span) in &call.targets {
            let key = (call.variable.unit, *base, *offset);
            let (first, second) = writers.entry(key).or_insert((call, None));
            let other = if first.place == call.place {
                *second
            } else {
                second.get_or_insert(call);
                Some(*first)
            };
            if let Some(other) = other {
                let name = |call: &Call| name(program, call.variable);
                let message = format!(
                    "`{}` and `{}` write the same variable: the one called last wins",
                    name(other),
                    name(call)
                );
                told.push(
                    Diagnostic::warning(Code::St52, *span, message).related(other.span, "the other one"),
                );
            }
        }
    }
}

/// ST53: Error and ErrorID of a motion block are never read.
fn refusals(
    program: &Program<'_>,
    facts: &Facts,
    calls: &BTreeMap<Variable, Vec<&Call>>,
    told: &mut Vec<Diagnostic>,
) {
    let reads: BTreeSet<(Variable, u32)> = facts.reads.iter().copied().collect();
    for (variable, calls) in calls {
        let Some(first) = calls.first().filter(|call| motion(program, call.callee)) else {
            continue;
        };
        let pins = ["ERROR", "ERRORID"].map(|key| pin(program, first.callee, key));
        let Some(error) = pins[0] else { continue };
        let is_read =
            |at: u32| reads.contains(&(*variable, at)) || calls.iter().any(|call| call.outputs.contains(&at));
        let handed = reads.contains(&(*variable, 0));
        if handed || is_read(error) || pins[1].is_some_and(is_read) {
            continue;
        }
        let name = name(program, *variable);
        let message = format!("nobody reads `{name}.Error`: the program cannot notice a refusal");
        told.push(Diagnostic::warning(Code::St53, first.span, message));
    }
}

/// ST53 and ST57: instances that are never called, and variables that are never used.
fn unused(program: &Program<'_>, facts: &Facts, told: &mut Vec<Diagnostic>) {
    let of_units = program.units.iter().enumerate().flat_map(|(unit, info)| {
        let own = matches!(
            info.kind,
            UnitKind::Program | UnitKind::Block | UnitKind::Function | UnitKind::Method
        );
        let members = info.members.list.iter().enumerate().filter(move |_| own);
        members.map(move |(place, member)| {
            let unit = Some(UnitId(unit as u32));
            (Variable { unit, member: place }, member)
        })
    });
    let of_all = program.globals.iter().enumerate().map(|(place, global)| {
        let variable = Variable {
            unit: None,
            member: place,
        };
        (variable, &global.member)
    });
    for (variable, member) in of_units.chain(of_all) {
        let own = variable.unit.is_none() || matches!(member.kind, MemberKind::Var | MemberKind::Temp);
        if !own || member.constant || member.address.is_some() {
            continue;
        }
        let mut ty = member.ty;
        while let Type::Array(array) = program.types.get(ty) {
            ty = array.of;
        }
        match program.types.get(ty) {
            Type::Block(_) if facts.called.contains(&variable) => {}
            Type::Block(_) => {
                let message = format!("`{}` is declared and never called", member.name);
                told.push(Diagnostic::warning(Code::St53, member.span, message));
            }
            // The script, or another program, may use a global variable.
            _ if variable.unit.is_none() || facts.used.contains(&variable) => {}
            _ => {
                let message = format!("`{}` is never used", member.name);
                told.push(Diagnostic::warning(Code::St57, member.span, message));
            }
        }
    }
}

/// See [`super::without_axis`].
pub(super) fn without_axis(program: &Program<'_>, facts: &Facts, image: &[u8]) -> Vec<Diagnostic> {
    let is_axis = |member: &Member| matches!(program.types.get(member.ty), Type::Structure(structure) if structure.name == "AXIS_REF");
    let mut assigned = facts.assigned.iter().filter_map(|(it, _)| member(program, *it));
    if assigned.any(is_axis) {
        return Vec::new();
    }
    let of_programs = program.instances.iter().flat_map(|instance| {
        let members = program.unit(instance.unit).members.list.iter();
        members.enumerate().map(|(place, member)| {
            let unit = Some(instance.unit);
            (Variable { unit, member: place }, member, instance.address)
        })
    });
    let globals = program.globals.iter().enumerate().map(|(place, global)| {
        let unit = None;
        (Variable { unit, member: place }, &global.member, 0)
    });
    let lacks = |(variable, member, begin): &(Variable, &Member, u32)| {
        let at = (begin + member.offset) as usize;
        facts.used.contains(variable)
            && is_axis(member)
            && !matches!(member.kind, MemberKind::InOut | MemberKind::External(_))
            && image.get(at..at + 4).is_none_or(|number| number == [0; 4])
    };
    let without = of_programs.chain(globals).filter(lacks);
    let told = without.map(|(_, member, _)| {
        let name = &member.name;
        let message = format!("`{name}` names no axis: blocks refuse it with ErrorID 100");
        Diagnostic::warning(Code::Doubtful, member.span, message).help(format!(
            "call an axis `{name}`, or bind it in a script: `\"axes\": {{\"{name}\": \"X\"}}`"
        ))
    });
    told.collect()
}

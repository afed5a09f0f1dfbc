//! The statements of all units, and the state kept while those of one unit are checked.

use super::{Body, Checker};
use crate::error::{Code, Diagnostic};
use crate::source::Span;
use crate::types::{MemberKind, UnitId};
use std::collections::{BTreeMap, BTreeSet};

/// A variable of a unit, or a global one.
pub(super) type Variable = (Option<UnitId>, usize);

/// A call within a FOR, which must not write the control variable.
#[derive(Debug)]
pub(super) struct LoopCall {
    pub control: Variable,
    pub caller: UnitId,
    pub callee: UnitId,
    pub span: Span,
}

#[derive(Debug, Default)]
pub(super) struct BodyState {
    /// Control variables of running loops.
    pub controls: Vec<Variable>,
    /// Number of enclosing loops.
    pub loops: usize,
    /// In_outs that a call of this instance binds, by the text of the instance.
    bound: BTreeMap<String, BTreeSet<usize>>,
    /// Calls that leave out in_outs.
    kept: Vec<(String, usize, Span, UnitId)>,
}

impl Checker<'_> {
    /// Checks the statements of all units.
    pub(super) fn bodies(&mut self) -> Vec<Body> {
        let mut bodies = Vec::new();
        for index in 0..self.units.len() {
            let id = UnitId(index as u32);
            let Some(syntax) = self.unit(id).syntax else {
                continue;
            };
            self.body = BodyState::default();
            let statements = self.in_scope(Some(id), |checker| checker.statements(&syntax.body));
            self.check_kept();
            let function = self.unit(id).kind.has_frame();
            let members = self.unit(id).members.list.iter().enumerate();
            let fresh = members.filter(|(_, member)| match member.kind {
                MemberKind::Temp | MemberKind::Result => true,
                MemberKind::Output => function,
                _ => false,
            });
            bodies.push(Body {
                unit: id,
                fresh: fresh.map(|(place, _)| place).collect(),
                statements,
            });
        }
        self.body = BodyState::default();
        bodies
    }

    /// Records which in_outs a call binds, and which it leaves unchanged.
    pub(super) fn note_bound(
        &mut self,
        instance: &str,
        given: impl Iterator<Item = usize>,
        kept: &[usize],
        span: Span,
        unit: UnitId,
    ) {
        let entry = self.body.bound.entry(instance.to_owned()).or_default();
        entry.extend(given);
        let kept = kept.iter().map(|place| (instance.to_owned(), *place, span, unit));
        self.body.kept.extend(kept);
    }

    /// Reports an in_out that no call of an instance binds: it refers to nothing.
    pub(super) fn check_kept(&mut self) {
        for (instance, place, span, unit) in std::mem::take(&mut self.body.kept) {
            let name = self
                .unit(unit)
                .members
                .list
                .get(place)
                .map_or("", |member| &member.name)
                .to_owned();
            let given = self
                .body
                .bound
                .get(&instance)
                .is_some_and(|given| given.contains(&place));
            let message = format!("the call does not give `{name}`");
            if given {
                let doubt = Diagnostic::warning(Code::Portability, span, message);
                self.tell(
                    doubt.help("it is the one of the call before; other compilers want it at every call"),
                );
            } else {
                let help = format!("write {name} := and a variable");
                self.error(
                    Code::MissingArgument,
                    span,
                    format!("{message}, and no other call does"),
                    &help,
                );
            }
        }
    }

    /// Records a call for the search for recursion, and for what it writes.
    pub(super) fn note_call(&mut self, callee: UnitId, span: Span) {
        if let Some(caller) = self.scope {
            let controls = self.body.controls.iter();
            self.loop_calls.extend(controls.map(|control| LoopCall {
                control: *control,
                caller,
                callee,
                span,
            }));
            self.edges
                .entry(caller)
                .or_default()
                .entry(callee)
                .or_insert(span);
        }
    }
}

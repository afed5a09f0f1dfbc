//! The calls between units: no recursion, and no chain of calls that is too long.

use super::Checker;
use crate::error::{Code, Diagnostic};
use crate::types::UnitId;
use std::collections::{BTreeMap, BTreeSet};

/// Largest number of nested calls.
pub(crate) const CALLS_MOST: u32 = 64;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Mark {
    Open,
    /// The longest chain of calls that begins here.
    Depth(u32),
}

impl Checker<'_> {
    pub(super) fn check_calls(&mut self) {
        let mut marks: BTreeMap<UnitId, Mark> = BTreeMap::new();
        for unit in 0..self.units.len() {
            self.follow(UnitId(unit as u32), &mut marks);
        }
    }

    /// Follows the calls that begin at `start`, without recursion.
    fn follow(&mut self, start: UnitId, marks: &mut BTreeMap<UnitId, Mark>) {
        if marks.contains_key(&start) {
            return;
        }
        let callees = |checker: &Self, unit: UnitId| -> Vec<UnitId> {
            checker
                .edges
                .get(&unit)
                .map(|edges| edges.keys().copied().collect())
                .unwrap_or_default()
        };
        let mut row = vec![(start, callees(self, start), 0_u32)];
        marks.insert(start, Mark::Open);
        while let Some((unit, rest, deepest)) = row.last_mut() {
            let (unit, next) = (*unit, rest.pop());
            let Some(next) = next else {
                let depth = *deepest + 1;
                marks.insert(unit, Mark::Depth(depth));
                row.pop();
                if let Some((.., above)) = row.last_mut() {
                    *above = (*above).max(depth);
                }
                if depth == CALLS_MOST + 1 {
                    let message = format!("more than {CALLS_MOST} calls are within each other");
                    let span = self.unit(unit).span;
                    self.error(Code::TooDeep, span, message, "call with fewer units between");
                }
                continue;
            };
            match marks.get(&next) {
                Some(Mark::Depth(depth)) => *deepest = (*deepest).max(*depth),
                Some(Mark::Open) => {
                    let from = row.iter().position(|(unit, ..)| *unit == next).unwrap_or(0);
                    let circle: Vec<UnitId> = row.iter().skip(from).map(|(unit, ..)| *unit).collect();
                    self.circle(&circle);
                }
                None => {
                    marks.insert(next, Mark::Open);
                    let callees = callees(self, next);
                    row.push((next, callees, 0));
                }
            }
        }
    }

    /// Reports calls within a FOR that write its control variable.
    pub(super) fn check_loops(&mut self) {
        for call in std::mem::take(&mut self.loop_calls) {
            let Some(writers) = self.writers.get(&call.control) else {
                continue;
            };
            if writers.keys().all(|unit| *unit == call.caller) {
                continue;
            }
            let called = self.called_from(call.callee);
            let Some((_, written)) = writers.iter().find(|(unit, _)| called.contains(unit)) else {
                continue;
            };
            let name = match call.control {
                (Some(unit), place) => &self.unit(unit).members.list[place].name,
                (None, place) => &self.globals[place].member.name,
            };
            let message = format!(
                "the call of `{}` writes `{name}`, the control variable of a FOR that is running",
                self.unit(call.callee).name
            );
            let wrong = Diagnostic::error(Code::NotWritable, call.span, message);
            let wrong = wrong.related(*written, "it is written here");
            self.tell(wrong.help("use another control variable, a VAR of the unit with the FOR"));
        }
    }

    /// A unit, and all that its calls lead to.
    fn called_from(&self, unit: UnitId) -> BTreeSet<UnitId> {
        let mut called = BTreeSet::from([unit]);
        let mut rest = vec![unit];
        while let Some(edges) = rest.pop().map(|unit| self.edges.get(&unit)) {
            let callees = edges.into_iter().flat_map(|edges| edges.keys());
            rest.extend(callees.filter(|callee| called.insert(**callee)));
        }
        called
    }

    fn circle(&mut self, circle: &[UnitId]) {
        let (Some(first), Some(last)) = (circle.first(), circle.last()) else {
            return;
        };
        let mut names: Vec<_> = circle.iter().map(|unit| self.unit(*unit).name.as_str()).collect();
        names.push(&self.unit(*first).name);
        let message = format!("calls go round in a circle: {}", names.join(" -> "));
        let span = self
            .edges
            .get(last)
            .and_then(|edges| edges.get(first))
            .copied()
            .unwrap_or_default();
        let wrong = Diagnostic::error(Code::Circle, span, message);
        self.tell(wrong.help("a program cannot call itself, not even through others: use a loop"));
    }
}

//! The instances that are called on every path through a body.

use super::facts::Variable;
use std::collections::BTreeSet;

/// The instances that are certainly called on a path; `None` if the path is never taken.
pub(super) type Way = Option<BTreeSet<Variable>>;

/// Joins two paths: the instances called on both of them are certainly called.
pub(super) fn meet(way: &mut Way, other: Way) {
    *way = match (way.take(), other) {
        (Some(mut called), Some(other)) => {
            called.retain(|variable| other.contains(variable));
            Some(called)
        }
        (one, other) => one.or(other),
    };
}

/// The path through a body, statement by statement.
#[derive(Debug, Default)]
pub(super) struct Paths {
    /// The calls of each enclosing list of statements so far, from the outside in.
    lists: Vec<Way>,
    /// The enclosing loops: the number of lists around each, and the paths that leave its body early.
    loops: Vec<(usize, Way)>,
    /// The paths that return.
    returned: Way,
}

impl Paths {
    pub(super) fn begin_list(&mut self) {
        self.lists.push(Some(BTreeSet::new()));
    }

    /// The path through the list to its end.
    pub(super) fn end_list(&mut self) -> Way {
        self.lists.pop().flatten()
    }

    pub(super) fn begin_loop(&mut self) {
        self.loops.push((self.lists.len(), None));
    }

    /// The path through the body of a loop, whose list has ended with `way`.
    pub(super) fn end_loop(&mut self, mut way: Way) -> Way {
        let left = self.loops.pop().and_then(|(_, left)| left);
        meet(&mut way, left);
        way
    }

    pub(super) fn call(&mut self, variable: Variable) {
        if let Some(Some(called)) = self.lists.last_mut() {
            called.insert(variable);
        }
    }

    /// The current list continues behind this path.
    pub(super) fn go_on(&mut self, way: Way) {
        let Some(list) = self.lists.last_mut() else { return };
        match (list.as_mut(), way) {
            (Some(called), Some(way)) => called.extend(way),
            _ => *list = None,
        }
    }

    /// EXIT or CONTINUE.
    pub(super) fn leave_loop(&mut self) {
        if let Some((enclosing, mut left)) = self.loops.pop() {
            meet(&mut left, self.so_far(enclosing));
            self.loops.push((enclosing, left));
        }
        self.go_on(None);
    }

    /// RETURN.
    pub(super) fn leave(&mut self) {
        let way = self.so_far(0);
        meet(&mut self.returned, way);
        self.go_on(None);
    }

    /// The instances called on all paths through a body, whose list has ended with `way`.
    pub(super) fn on_all(mut self, way: Way) -> BTreeSet<Variable> {
        meet(&mut self.returned, way);
        self.returned.unwrap_or_default()
    }

    /// The path from the beginning of a list to here.
    fn so_far(&self, first: usize) -> Way {
        let mut called = BTreeSet::new();
        for list in self.lists.get(first..)? {
            called.extend(list.as_ref()?);
        }
        Some(called)
    }
}

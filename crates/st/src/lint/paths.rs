//! What is called on every path through a body.

use super::facts::Variable;
use std::collections::BTreeSet;

/// The instances that are called for sure on a way; `None` if nothing comes along it.
pub(super) type Way = Option<BTreeSet<Variable>>;

/// Two ways lead to one place: what was called on both of them was called for sure.
pub(super) fn meet(way: &mut Way, other: Way) {
    *way = match (way.take(), other) {
        (Some(mut called), Some(other)) => {
            called.retain(|variable| other.contains(variable));
            Some(called)
        }
        (one, other) => one.or(other),
    };
}

/// The way through a body, statement by statement.
#[derive(Debug, Default)]
pub(super) struct Paths {
    /// What each enclosing list of statements has called by itself so far, from the outside in.
    lists: Vec<Way>,
    /// The enclosing loops: how many lists enclose each, and the ways that leave its body early.
    loops: Vec<(usize, Way)>,
    /// The ways that return.
    returned: Way,
}

impl Paths {
    pub(super) fn begin_list(&mut self) {
        self.lists.push(Some(BTreeSet::new()));
    }

    /// The way through the list to its end.
    pub(super) fn end_list(&mut self) -> Way {
        self.lists.pop().flatten()
    }

    pub(super) fn begin_loop(&mut self) {
        self.loops.push((self.lists.len(), None));
    }

    /// The way through the body of a loop, whose list has ended in this way.
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

    /// The current list goes on behind this way.
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

    /// What is called on all ways through a body, whose list has ended in this way.
    pub(super) fn on_all(mut self, way: Way) -> BTreeSet<Variable> {
        meet(&mut self.returned, way);
        self.returned.unwrap_or_default()
    }

    /// The way from the beginning of a list to here.
    fn so_far(&self, first: usize) -> Way {
        let mut called = BTreeSet::new();
        for list in self.lists.get(first..)? {
            called.extend(list.as_ref()?);
        }
        Some(called)
    }
}

//! Counters of statements and branches, made on request.
//!
//! They are placed behind the variables, so these keep their addresses. They count in 64 bits. They cost
//! fuel, so a judged run has none, and coverage is counted in a run of its own.

use crate::check::Program;
use crate::source::{Position, Sources, Span};
use crate::typed::{Stmt, StmtKind};
use std::collections::BTreeMap;

/// The place of a counter: the begin of its statement, and 0, or the number of one of its branches.
type Key = (u32, u32);

/// A counter of a statement, or of a branch of one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Counter {
    /// The file, as it was given.
    pub file: String,
    /// The begin of the statement.
    pub position: Position,
    /// 0 for the statement; otherwise the number of one of its branches, from 1. The last branch is ELSE,
    /// even if it is not written.
    pub branch: u32,
    /// The address of the count in memory, 8 bytes.
    pub address: u32,
}

/// All counters of a program; none unless requested.
#[derive(Debug, Default)]
pub(crate) struct Counters {
    places: BTreeMap<Key, u32>,
}

impl Counters {
    /// Finds the statements of the sources, and takes memory for their counters.
    pub(crate) fn new(program: &mut Program<'_>, sources: &Sources) -> Self {
        let mut keys = Vec::new();
        for body in &program.bodies {
            if !sources.in_library(program.unit(body.unit).span) {
                statements(&body.statements, &mut keys);
            }
        }
        let mut places = BTreeMap::new();
        for key in keys {
            places.insert(key, program.layout.take(8));
        }
        Self { places }
    }

    pub(crate) fn address(&self, at: Span, branch: u32) -> Option<u32> {
        self.places.get(&(at.start, branch)).copied()
    }

    /// For the table of symbols.
    pub(crate) fn list(&self, sources: &Sources) -> Vec<Counter> {
        let each = self.places.iter().map(|((start, branch), address)| Counter {
            file: sources
                .file_name(Span {
                    start: *start,
                    end: *start,
                })
                .to_owned(),
            position: sources.position(*start),
            branch: *branch,
            address: *address,
        });
        each.collect()
    }
}

/// The keys of statements and of all within them. The nesting is limited by the parser.
fn statements(list: &[Stmt], keys: &mut Vec<Key>) {
    for statement in list {
        let start = statement.span.start;
        keys.push((start, 0));
        let mut branches = |count: usize| keys.extend((1..=count as u32 + 1).map(|branch| (start, branch)));
        match &statement.kind {
            StmtKind::If(arms, other) => {
                branches(arms.len());
                arms.iter().for_each(|(_, body)| statements(body, keys));
                statements(other, keys);
            }
            StmtKind::Case(_, _, arms, other) => {
                branches(arms.len());
                arms.iter().for_each(|arm| statements(&arm.body, keys));
                statements(other, keys);
            }
            StmtKind::For(each) => statements(&each.body, keys),
            StmtKind::While(_, body) | StmtKind::Repeat(body, _) => statements(body, keys),
            StmtKind::Assign(..)
            | StmtKind::Evaluate(_)
            | StmtKind::Block(_)
            | StmtKind::Exit
            | StmtKind::Continue
            | StmtKind::Return => {}
        }
    }
}

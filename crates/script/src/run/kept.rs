//! The columns that a run keeps, prepared once for all runs of a script with other values of its parameters.

use super::layout::{self, Layout};
use super::needed;
use super::row::RowWriter;
use crate::model::Script;
use standstill_trace::{Header, Trace};
use std::sync::Arc;

/// The columns of the trace of a run, and how they are written.
#[derive(Clone, Debug)]
pub struct Kept {
    pub(super) layout: Arc<Layout>,
    pub(super) writer: RowWriter,
    /// Without rows.
    pub(super) trace: Trace,
    /// The columns of a whole trace.
    pub(super) all: usize,
}

impl Kept {
    /// All columns.
    #[must_use]
    pub fn all(script: &Script) -> Self {
        let trace = Trace::new(layout::header(script));
        Self::with(script, Layout::new(script), trace.columns().len(), trace)
    }

    /// The columns that claims and steps of the script read, and those of `names`. Such a trace knows no blocks and
    /// has no notes of commands. The reasons of failed claims are not searched.
    #[must_use]
    pub fn read(script: &Script, names: &[String]) -> Self {
        let header = layout::header(script);
        let all = header.columns();
        let columns = needed::columns(script, &all, names);
        let header = Header {
            inputs: Vec::new(),
            instances: Vec::new(),
            ..header
        };
        let (layout, count) = (Layout::of_some(script, &columns), all.len());
        let trace = Trace::with_some(header, all, |place| columns.contains(&place));
        Self::with(script, layout, count, trace)
    }

    fn with(script: &Script, layout: Layout, all: usize, trace: Trace) -> Self {
        Self {
            writer: RowWriter::new(script, &layout),
            layout: Arc::new(layout),
            trace,
            all,
        }
    }

    /// Describes the axes as those of a script that differs only in the values of its parameters.
    pub(super) fn describe(&mut self, script: &Script) {
        self.trace.describe_as(&Header {
            title: script.title.clone(),
            axes: layout::axes(script),
            ..Header::default()
        });
    }

    /// Prepares for the next run: drops the rows and keeps their memory.
    pub(super) fn cleared(mut self) -> Self {
        self.writer.restart();
        self.trace.clear();
        self
    }
}

//! Access to rows, notes and the script for the search for reasons.

use super::words;
use crate::claims::Verdict;
use crate::model::{ClaimKind, Condition, Instance, Point, Script, Signal, Test, When, Wire};
use crate::run::Rows;
use crate::run::cells::point_name;
use crate::warn::never_runs;
use standstill_axis::ErrorId;
use standstill_fb::{Group, PinType, Value};
use standstill_trace::{Cell, Note, cell_text};
use std::cell::Cell as Counter;
use std::rc::Rc;

/// Access to a run.
#[derive(Clone)]
pub(super) struct Look<'a> {
    pub(super) rows: Rows<'a>,
    /// Points and scans at which claims that hold, or steps, need something to be TRUE.
    counted_on: Rc<Vec<(Point, u64)>>,
    /// Remaining reads.
    left: Rc<Counter<u64>>,
}

/// Whether a condition asks for a BOOL to be FALSE.
pub(super) fn wants_false(condition: &Condition) -> bool {
    matches!(condition.test, Test::Bool(false))
}

impl<'a> Look<'a> {
    pub(super) fn new(rows: &Rows<'a>, verdicts: &[Verdict]) -> Self {
        Self {
            rows: *rows,
            counted_on: Rc::new(counted_on(rows, verdicts)),
            left: Rc::new(Counter::new(
                super::LOOKS_MOST + super::PASSES_MOST * rows.count(),
            )),
        }
    }

    /// Counts reads of the trace.
    fn spend(&self, looks: u64) {
        self.left.set(self.left.get().saturating_sub(looks));
    }

    /// Whether all reads are used up.
    pub(super) fn is_spent(&self) -> bool {
        self.left.get() == 0
    }

    /// The notes on a subject up to a scan.
    pub(super) fn notes_on(&self, subject: &'a str, scan: u64) -> impl Iterator<Item = &'a Note> + use<'a> {
        let notes = self.rows.trace.notes();
        let end = notes.partition_point(|note| note.scan as u64 <= scan);
        let notes = notes.get(..end).unwrap_or_default();
        self.spend(notes.len() as u64);
        notes.iter().filter(move |note| note.subject == subject)
    }

    /// The task that would call an instance, if it never runs.
    pub(super) fn idle_task(&self, instance: usize) -> Option<&'a str> {
        let index = self.instance(instance)?.task;
        let task = self.script().tasks.get(index)?;
        // The rows are only read for such a task.
        if task.single.is_some() {
            self.spend(self.rows.count());
        }
        never_runs(&self.rows, index).then_some(task.name.as_str())
    }

    pub(super) fn script(&self) -> &'a Script {
        self.rows.script
    }

    pub(super) fn last(&self) -> u64 {
        self.rows.count().saturating_sub(1)
    }

    pub(super) fn instance(&self, instance: usize) -> Option<&'a Instance> {
        self.script().blocks.get(instance)
    }

    /// Name of an instance.
    pub(super) fn name(&self, instance: usize) -> &'a str {
        self.instance(instance).map_or("", |instance| &instance.name)
    }

    pub(super) fn axis_name(&self, axis: usize) -> &'a str {
        self.script().axes.get(axis).map_or("", |axis| &axis.name)
    }

    /// The name of a point in scripts.
    pub(super) fn called(&self, point: Point) -> String {
        point_name(self.script(), point)
    }

    /// The pin of this name.
    pub(super) fn pin(&self, instance: usize, name: &str) -> Option<Point> {
        let (pin, _) = self.instance(instance)?.block.pin(name)?;
        Some(Point::Pin(instance, pin))
    }

    /// Whether a pin is a BOOL.
    pub(super) fn is_bool(&self, instance: usize, pin: usize) -> bool {
        let found = self.instance(instance);
        let found = found.and_then(|found| found.block.pins().nth(pin));
        found.is_some_and(|pin| pin.ty == PinType::Bool)
    }

    /// The wire to an input.
    pub(super) fn wire(&self, instance: usize, pin: usize) -> Option<&'a Wire> {
        let wires = &self.instance(instance)?.wires;
        wires
            .iter()
            .find(|(wired, _)| *wired == pin)
            .map(|(_, wire)| wire)
    }

    pub(super) fn cell(&self, point: Point, scan: u64) -> Option<Cell<'a>> {
        self.of(&Signal::Point(point), scan)
    }

    /// The value of a signal in a scan.
    pub(super) fn of(&self, signal: &Signal, scan: u64) -> Option<Cell<'a>> {
        self.spend(1);
        self.rows.cell(signal, scan)
    }

    pub(super) fn is_true(&self, point: Point, scan: u64) -> bool {
        self.cell(point, scan) == Some(Cell::Bool(true))
    }

    /// The value of the pin of this name.
    pub(super) fn at(&self, instance: usize, name: &str, scan: u64) -> Option<Cell<'a>> {
        self.cell(self.pin(instance, name)?, scan)
    }

    /// Whether a block has a pin of this name, and it is TRUE.
    pub(super) fn shows(&self, instance: usize, name: &str, scan: u64) -> bool {
        self.at(instance, name, scan) == Some(Cell::Bool(true))
    }

    /// The last rising edge of an input that starts a block, up to `to`, and the input.
    pub(super) fn last_start(&self, instance: usize, to: u64) -> Option<(u64, usize)> {
        let triggers = self.triggers(instance).into_iter();
        let edges = triggers.filter_map(|pin| Some((self.last_rise(Point::Pin(instance, pin), to)?, pin)));
        edges.max()
    }

    /// The first scan of a range in which the point is TRUE.
    pub(super) fn first_true(&self, point: Point, from: u64, to: u64) -> Option<u64> {
        (from..=to.min(self.last())).find(|&scan| self.is_true(point, scan))
    }

    /// Whether the point is TRUE and was not in the scan before; TRUE in the first row is an edge.
    pub(super) fn rises(&self, point: Point, scan: u64) -> bool {
        self.is_true(point, scan)
            && scan
                .checked_sub(1)
                .is_none_or(|before| !self.is_true(point, before))
    }

    /// The first rising edge of a range.
    pub(super) fn first_rise(&self, point: Point, from: u64, to: u64) -> Option<u64> {
        (from..=to.min(self.last())).find(|&scan| self.rises(point, scan))
    }

    /// The last rising edge up to `to`.
    pub(super) fn last_rise(&self, point: Point, to: u64) -> Option<u64> {
        (0..=to.min(self.last()))
            .rev()
            .find(|&scan| self.rises(point, scan))
    }

    /// The last scan of the time in which a point stays TRUE, from `scan` on.
    pub(super) fn end_of(&self, point: Point, scan: u64) -> u64 {
        let fallen = (scan..=self.last()).find(|&scan| !self.is_true(point, scan));
        fallen.map_or(self.last(), |fallen| fallen.saturating_sub(1))
    }

    /// The axes at the pins of an instance.
    pub(super) fn axes_of(&self, instance: usize) -> Vec<usize> {
        let constants = self.instance(instance).map(|instance| &instance.constants);
        let axis = |(_, value): &(usize, Value)| match value {
            Value::Axis(id) => Some(id.index()),
            _ => None,
        };
        constants.into_iter().flatten().filter_map(axis).collect()
    }

    /// The instances that may move an axis, in call order.
    pub(super) fn commanders(&self, axis: usize) -> Vec<usize> {
        let moves = |instance: &Instance| {
            matches!(
                instance.block.group,
                Group::SingleAxis | Group::MultiAxis | Group::Homing
            )
        };
        let all = self.script().blocks.iter().enumerate();
        all.filter(|(_, instance)| moves(instance) && instance.has_axis(axis))
            .map(|(index, _)| index)
            .collect()
    }

    /// The inputs that start a block.
    pub(super) fn triggers(&self, instance: usize) -> Vec<usize> {
        let found = self.instance(instance).into_iter();
        found.flat_map(Instance::triggers).map(|(pin, _)| pin).collect()
    }

    /// The note on a subject in a scan that begins with a word.
    pub(super) fn note(&self, subject: &str, scan: u64, begins: &str) -> Option<&'a str> {
        let notes = self.rows.trace.notes();
        let first = notes.partition_point(|note| (note.scan as u64) < scan);
        let here = notes.get(first..)?.iter();
        here.take_while(|note| note.scan as u64 == scan)
            .find(|note| note.subject == subject && note.text.starts_with(begins))
            .map(|note| note.text.as_str())
    }

    /// The last note on a subject from `from` to `to` that begins with a word.
    pub(super) fn last_note(
        &self,
        subject: &str,
        begins: &str,
        from: u64,
        to: u64,
    ) -> Option<(u64, &'a str)> {
        let notes = self.rows.trace.notes();
        let place = |scan: u64| notes.partition_point(|note| (note.scan as u64) < scan);
        let notes = notes
            .get(place(from)..place(to.saturating_add(1)))
            .unwrap_or_default();
        self.spend(notes.len() as u64);
        notes
            .iter()
            .rev()
            .find(|note| note.subject == subject && note.text.starts_with(begins))
            .map(|note| (note.scan as u64, note.text.as_str()))
    }

    /// The value of an ErrorID pin.
    pub(super) fn error_id(&self, instance: usize, scan: u64) -> Option<ErrorId> {
        match self.at(instance, "ErrorID", scan)? {
            Cell::Integer(number) => ErrorId::from_number(u16::try_from(number).ok()?),
            _ => None,
        }
    }

    /// Whether the script's author needs this point to be TRUE from `scan` on.
    pub(super) fn is_counted_on(&self, point: Point, scan: u64) -> bool {
        let end = self.end_of(point, scan);
        let mut all = self.counted_on.iter();
        all.any(|(counted, at)| *counted == point && (scan..=end).contains(at))
    }

    /// The constants and wired values of the numeric inputs of a block in a scan: `Position 100.0, Velocity 50.0`.
    pub(super) fn values(&self, instance: usize, scan: u64) -> String {
        let Some(found) = self.instance(instance) else {
            return String::new();
        };
        let named = |pin: &usize| {
            found.constants.iter().any(|(index, _)| index == pin) || self.wire(instance, *pin).is_some()
        };
        let inputs = found.block.inputs().iter().enumerate();
        let told = inputs.filter(|(index, pin)| {
            named(index) && !matches!(pin.ty, PinType::Bool | PinType::Axis(_) | PinType::Table(_))
        });
        let told = told.filter_map(|(index, pin)| {
            let cell = self.cell(Point::Pin(instance, index), scan)?;
            let text = match (pin.ty, cell) {
                (PinType::Time, Cell::Integer(ns)) => crate::read::time::literal(ns),
                _ => cell_text(cell),
            };
            Some(format!("{} {text}", pin.name))
        });
        told.collect::<Vec<_>>().join(", ")
    }

    /// Refusals, faults, clamps and raises up to a scan, as lines: context for any reason.
    pub(super) fn told_by(&self, latest: u64) -> Vec<(u64, String)> {
        let notes = self.rows.trace.notes().iter();
        let notes = notes.take_while(|note| note.scan as u64 <= latest);
        let mut told: Vec<(u64, String)> = Vec::new();
        for note in notes {
            if let Some(text) = words::noted(&note.subject, note.scan as u64, &note.text)
                && !told.iter().any(|(_, known)| *known == text)
            {
                told.push((note.scan as u64, text));
            }
            if told.len() >= super::TOLD_MOST {
                break;
            }
        }
        told
    }
}

/// The points that claims that hold, and steps, need.
fn counted_on(rows: &Rows<'_>, verdicts: &[Verdict]) -> Vec<(Point, u64)> {
    let mut counted = Vec::new();
    let mut add = |conditions: &[Condition], scan: u64| {
        for condition in conditions {
            let asks = match (&condition.signal, &condition.test) {
                (Signal::Point(point), Test::Bool(true)) => Some(*point),
                (Signal::Point(Point::Pin(instance, pin)), Test::Exactly(number)) if *number != 0.0 => {
                    error_beside(rows.script, *instance, *pin)
                }
                _ => None,
            };
            counted.extend(asks.map(|point| (point, scan)));
        }
    };
    for (claim, verdict) in rows.script.claims.iter().zip(verdicts) {
        match (&claim.kind, verdict.scans) {
            (ClaimKind::At(that) | ClaimKind::By(that) | ClaimKind::Once(that), Some(_)) => {
                if let Some(held) = verdict.held {
                    add(that, held);
                }
            }
            (ClaimKind::Always(that), Some([from, to])) if verdict.passed() => {
                if let Some(scan) = (from..=to).find(|&scan| rows.hold(&claim.during, scan)) {
                    add(that, scan);
                    add(&claim.during, scan);
                }
            }
            _ => {}
        }
    }
    for step in &rows.script.steps {
        if let When::Holds { conditions, .. } = &step.when
            && let Some(scan) = (0..rows.count()).find(|&scan| rows.hold(conditions, scan))
        {
            add(conditions, scan);
        }
    }
    counted
}

/// The `Error` pin that goes with an `ErrorID`.
fn error_beside(script: &Script, instance: usize, pin: usize) -> Option<Point> {
    let block = script.blocks.get(instance)?.block;
    let is_id = block.pins().nth(pin)?.name == "ErrorID";
    let (error, _) = block.pin("Error").filter(|_| is_id)?;
    Some(Point::Pin(instance, error))
}

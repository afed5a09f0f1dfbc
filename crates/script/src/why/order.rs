//! Wires that are read one scan late, because the block that they read is called later.

use super::{Finding, Rank, Walk};
use crate::model::{Condition, Point, Signal, Wire};

/// A claim that is missed by more scans has another reason than the order of calls.
const LATE_MOST: u64 = 3;

/// Largest number of wires through which one chain of cause and effect is followed.
const WIRES_MOST: usize = 32;

/// Largest number of wires that are listed for the cause of an edge.
const TOLD_MOST: usize = 2;

impl Walk<'_> {
    /// The wire that is read late, if a condition becomes true late by the same time.
    pub(super) fn late(&self, condition: &Condition, scan: u64) -> Option<Finding> {
        let rows = &self.look.rows;
        let came = (scan + 1..=scan + LATE_MOST).find(|&scan| rows.holds(condition, scan))?;
        let causes = self.causes(&condition.signal, came);
        causes
            .into_iter()
            .find_map(|cause| self.late_behind(cause, scan, came))
    }

    /// The wire that is read late on the path to a point that rose late.
    fn late_behind(&self, cause: Point, scan: u64, came: u64) -> Option<Finding> {
        let (mut signal, mut at) = (cause, came);
        let mut late = Vec::new();
        for _ in 0..WIRES_MOST {
            let Some((instance, pin, source, rose)) = self.edge_behind(signal, at) else {
                break;
            };
            if self.reads_late(instance, pin, source) {
                late.push((instance, pin, source));
            }
            (signal, at) = (source, rose);
        }
        let (instance, pin, source) = late.first().copied()?;
        if (late.len() as u64) < came - scan {
            return None;
        }
        let name = self.look.name(instance);
        let other = match source {
            Point::Pin(other, _) => self.look.name(other),
            _ => "",
        };
        let text = format!(
            "{} reads {} one scan late: {other} is called after {name}; call it before",
            self.look.called(Point::Pin(instance, pin)),
            self.look.called(source)
        );
        Some(Finding::new(Rank::Order, Some(scan), text))
    }

    /// The points that a signal depends on: itself, or the edges given to its axis.
    fn causes(&self, signal: &Signal, scan: u64) -> Vec<Point> {
        match *signal {
            Signal::Point(point) => vec![point],
            Signal::Formula(formula) => {
                let found = self.look.script().formulas.get(formula);
                let read = found.map_or(&[][..], |found| &found.inputs).iter();
                read.filter_map(|input| match input.signal {
                    Signal::Point(point) => Some(point),
                    _ => None,
                })
                .collect()
            }
            Signal::State(axis)
            | Signal::Master(axis, _)
            | Signal::Axis(axis, _)
            | Signal::Difference(axis, _) => {
                let all = self.look.commanders(axis).into_iter();
                let edges = all.flat_map(|instance| {
                    let triggers = self.look.triggers(instance).into_iter();
                    triggers.map(move |pin| Point::Pin(instance, pin))
                });
                edges
                    .filter(|edge| self.look.last_rise(*edge, scan).is_some())
                    .collect()
            }
        }
    }

    /// The wire whose edge caused the value of a point in a scan: the input it feeds, its source, and
    /// when that rose.
    fn edge_behind(&self, point: Point, scan: u64) -> Option<(usize, usize, Point, u64)> {
        let Point::Pin(instance, pin) = point else {
            return None;
        };
        let is_input = pin < self.look.instance(instance)?.block.input_count();
        let (rose, pin) = match is_input {
            true => (self.look.last_rise(point, scan)?, pin),
            false => self.look.last_start(instance, scan)?,
        };
        let wire = self.look.wire(instance, pin)?;
        let sources = wire.points().iter().copied();
        let (came, source) = if let Wire::Not(source) = wire {
            (rose, *source)
        } else {
            let risen = sources.filter_map(|source| Some((self.look.last_rise(source, rose)?, source)));
            risen.max_by_key(|(came, _)| *came)?
        };
        Some((instance, pin, source, came))
    }
}

impl Walk<'_> {
    /// How an input rose, a phrase for each wire:
    /// `back.Execute is held.Q, held.IN is not press.InTorque`.
    pub(super) fn brought_by(&self, instance: usize, scan: u64) -> String {
        let mut told = Vec::new();
        let start = self.look.last_start(instance, scan);
        let mut next = start.map(|(rose, pin)| (Point::Pin(instance, pin), rose));
        while let Some((point, at)) = next.take().filter(|_| told.len() < TOLD_MOST) {
            let Some((instance, pin, source, rose)) = self.edge_behind(point, at) else {
                break;
            };
            let not = match self.look.wire(instance, pin) {
                Some(Wire::Not(_)) => "not ",
                _ => "",
            };
            let what = self.look.called(Point::Pin(instance, pin));
            told.push(format!("{what} is {not}{}", self.look.called(source)));
            next = Some((source, rose));
        }
        told.join(", ")
    }
}

//! The golden text of a trace.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::column::{Cell, Role};
use crate::events::{events, lines};
use crate::extremes::{axis_title, extremes_text};
use crate::header::{Axis, Header, Limits};
use crate::number::{cell_text, fixed, shortest, time_literal};
use crate::subjects::{Subject, subjects, together};
use crate::trace::Trace;

/// The heading above the digests.
const DIGESTS: &str = "digests";

/// Approximate number of rows at equal distances in a set-point table, in addition to those of events.
const TABLE_ROWS: usize = 16;

/// The golden text: header, events, a thin table of set-points per axis, extremes against limits, the
/// digest of every subject, and at the end one of all. It has no version, date or path, so it changes
/// only when behaviour does.
#[must_use]
pub fn text(trace: &Trace) -> String {
    let events = events(trace);
    let mut text = header(trace);
    section(&mut text, "events", &lines(&events));
    let mut scans: BTreeMap<&str, Vec<usize>> = BTreeMap::new();
    for event in &events {
        scans.entry(&event.subject).or_default().push(event.scan);
    }
    for axis in &trace.header().axes {
        text.push('\n');
        let own = scans.get(axis.name.as_str());
        text.push_str(&set_points(trace, axis, own.map_or(&[], Vec::as_slice)));
    }
    text.push('\n');
    text.push_str(&extremes_text(trace));
    let subjects = subjects(trace);
    section(&mut text, DIGESTS, &digest_lines(&subjects));
    // Writing to a String cannot fail, here and below.
    let _ = writeln!(
        text,
        "\nend  {} scans  {}",
        trace.scans(),
        digest_text(together(&subjects))
    );
    text
}

/// The digest of all subjects in the form of the last line.
pub fn digest_text(digest: u64) -> String {
    format!("{digest:016x}")
}

fn section(text: &mut String, title: &str, lines: &str) {
    let _ = write!(text, "\n{title}\n{lines}");
}

fn header(trace: &Trace) -> String {
    let Header {
        title,
        covers,
        cycle_ns,
        axes,
        instances,
        ..
    } = trace.header();
    let mut text = format!("title   {}\n", if title.is_empty() { "(none)" } else { title });
    if !covers.is_empty() {
        let _ = writeln!(text, "covers  {}", covers.join(" "));
    }
    let _ = writeln!(text, "cycle   {}", time_literal(*cycle_ns));
    for axis in axes {
        let _ = writeln!(text, "axis    {}", axis_line(axis));
    }
    let bound = in_outs(trace);
    for instance in instances {
        let axes = bound.get(instance.name.as_str());
        let axes = axes.map_or_else(String::new, |axes| axes.join(", "));
        let bound = if axes.is_empty() {
            axes
        } else {
            format!("({axes})")
        };
        let _ = writeln!(text, "block   {}  {}{bound}", instance.name, instance.block);
    }
    text
}

fn axis_line(axis: &Axis) -> String {
    let mut words = vec![axis.name.clone()];
    if !axis.unit.is_empty() {
        words.push(axis.unit.clone());
    }
    words.push(format!("order {}", axis.order));
    let Limits {
        position_min,
        position_max,
        velocity,
        acceleration,
        deceleration,
        jerk,
        snap,
    } = axis.limits;
    let named = [
        ("min", position_min),
        ("max", position_max),
        ("v", velocity),
        ("a", acceleration),
        ("d", deceleration),
        ("j", jerk),
        ("s", snap),
    ];
    words.extend(
        named
            .iter()
            .filter_map(|(name, limit)| Some(format!("{name}={}", shortest((*limit)?)))),
    );
    if let Some(scaling) = axis.scaling {
        let sign = if scaling.invert { "-" } else { "" };
        words.push(format!(
            "scaling={sign}{}/{}+{}",
            scaling.increments,
            scaling.units,
            shortest(scaling.offset)
        ));
    }
    words.join("  ")
}

/// The axes that the in-out pins of each instance were bound to in scan 0.
fn in_outs(trace: &Trace) -> BTreeMap<&str, Vec<String>> {
    let mut bound: BTreeMap<&str, Vec<String>> = BTreeMap::new();
    for (column, cell) in trace.columns().iter().zip(trace.row(0)) {
        if column.role == Role::InOut {
            bound.entry(column.subject()).or_default().push(cell_text(cell));
        }
    }
    bound
}

/// Set-points at equal distances and at the scans in which the axis had an event. Rows at rest that
/// repeat the row above are left out.
fn set_points(trace: &Trace, axis: &Axis, events: &[usize]) -> String {
    let quantities = ["Position", "Velocity", "Acceleration", "Jerk"];
    let columns = quantities.map(|quantity| trace.column(&format!("{}.{quantity}", axis.name)));
    let mut text = format!("set-points of {}\n{:>7}", axis_title(axis), "scan");
    for quantity in quantities {
        let _ = write!(text, " {quantity:>16}");
    }
    text.push('\n');
    let mut above = None;
    for scan in table_scans(trace, events) {
        let values = columns.map(
            |column| match column.and_then(|column| trace.cell(scan, column)) {
                Some(Cell::Real(value)) => Some(value),
                _ => None,
            },
        );
        let shown = values.map(|value| value.map_or_else(String::new, fixed));
        let at_rest = values
            .iter()
            .skip(1)
            .all(|value| value.is_none_or(|value| value == 0.0));
        if at_rest && above.as_ref() == Some(&shown) {
            continue;
        }
        let _ = write!(text, "{scan:>7}");
        for cell in &shown {
            let _ = write!(text, " {cell:>16}");
        }
        text.push('\n');
        above = Some(shown);
    }
    text
}

fn table_scans(trace: &Trace, events: &[usize]) -> Vec<usize> {
    let scans = trace.scans();
    let step = round_step(scans.div_ceil(TABLE_ROWS));
    let mut chosen: Vec<usize> = (0..scans)
        .step_by(step)
        .chain(events.iter().copied())
        .chain(scans.checked_sub(1))
        .collect();
    chosen.retain(|&scan| scan < scans);
    chosen.sort_unstable();
    chosen.dedup();
    chosen
}

/// The least number of 1, 2, 5, 10, 20, 50 .. that is not below `least`.
fn round_step(least: usize) -> usize {
    let mut power = 1;
    loop {
        for step in [power, 2 * power, 5 * power] {
            if step >= least {
                return step;
            }
        }
        power *= 10;
    }
}

/// One line a subject: its name and its digest.
fn digest_lines(subjects: &[Subject]) -> String {
    let names = subjects.iter().map(|subject| subject.name.chars().count());
    let width = names.max().unwrap_or(0);
    subjects.iter().fold(String::new(), |mut text, subject| {
        let digest = digest_text(subject.digest);
        let _ = writeln!(text, "  {:<width$}  {digest}", subject.name);
        text
    })
}

/// The subjects of two golden texts whose digests differ, and those whose digests are equal. A subject
/// that only one of them has differs.
pub fn moved<'t>(reviewed: &'t str, found: &'t str) -> [Vec<&'t str>; 2] {
    let (reviewed, found) = (digests(reviewed), digests(found));
    let mut names: Vec<&str> = found.iter().map(|(name, _)| *name).collect();
    let gone = reviewed.iter().map(|(name, _)| *name);
    names.extend(gone.filter(|name| found.iter().all(|(other, _)| other != name)));
    names.dedup();
    let of = |all: &[(&'t str, &'t str)], name: &str| -> Vec<&'t str> {
        let own = all.iter().filter(|(other, _)| *other == name);
        own.map(|(_, digest)| *digest).collect()
    };
    let (same, other) = names
        .into_iter()
        .partition(|name| of(&reviewed, name) == of(&found, name));
    [other, same]
}

/// The names and digests that a golden text lists.
fn digests(text: &str) -> Vec<(&str, &str)> {
    let lines = text.lines().skip_while(|line| *line != DIGESTS).skip(1);
    lines
        .take_while(|line| !line.is_empty())
        .filter_map(|line| {
            let (name, digest) = line.trim().rsplit_once("  ")?;
            Some((name.trim_end(), digest))
        })
        .collect()
}

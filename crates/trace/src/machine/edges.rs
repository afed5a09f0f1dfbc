//! Lists of edges against lists of edges.

use super::{EdgeFault, Finding, Pair, Side, scan_ns};
use crate::foreign::Channel;
use crate::number::cell_text;
use crate::trace::Trace;

/// A value from a time (ns) on; the first of a list is no edge.
pub type Edge = (i64, String);

/// The recorded edges, with their times moved by `shift`.
pub fn recorded(pair: &Pair<'_>, shift: i64) -> Vec<Edge> {
    match &pair.channel {
        Channel::Steps(steps) => {
            let moved = |(ns, value): &Edge| (ns.saturating_add(shift), value.clone());
            steps.changes.iter().map(moved).collect()
        }
        Channel::Curve(_) => Vec::new(),
    }
}

/// The first value of a column of the trace and its changes, each at the time of its scan.
pub fn of_trace(trace: &Trace, column: usize, cycle: i64) -> Vec<Edge> {
    let mut edges: Vec<Edge> = Vec::new();
    for (scan, cell) in trace.cells(column).enumerate() {
        let value = cell_text(cell);
        if edges.last().is_none_or(|(_, last)| *last != value) {
            edges.push((scan_ns(scan, cycle), value));
        }
    }
    edges
}

/// The value at a time; before the first edge the first value.
fn value_at(edges: &[Edge], ns: i64) -> Option<&str> {
    let behind = edges.partition_point(|(time, _)| *time <= ns);
    edges
        .get(behind.saturating_sub(1))
        .map(|(_, value)| value.as_str())
}

/// Pairs edges to the same value that are at most `tolerance` (ns) apart, each with the earliest one
/// still free. An edge without counterpart counts in the window, except within `tolerance` of its ends,
/// where the counterpart may be outside.
pub fn compare(recorded: &[Edge], found: &[Edge], window: (i64, i64), tolerance: i64) -> Finding {
    let mut wrong = Vec::new();
    let start = value_at(found, window.0);
    let near = |(ns, _): &&Edge| ns.abs_diff(window.0) <= tolerance.unsigned_abs();
    let starts_so = value_at(recorded, window.0) == start
        || recorded
            .iter()
            .filter(near)
            .any(|(_, value)| Some(value.as_str()) == start)
        || value_at(recorded, window.0.saturating_sub(tolerance)) == start;
    if let (false, Some(value)) = (starts_so, start) {
        wrong.push(EdgeFault {
            at_ns: window.0,
            to: value.to_owned(),
            of: Side::Start,
        });
    }
    let inner = (
        window.0.saturating_add(tolerance),
        window.1.saturating_sub(tolerance),
    );
    let mut fault = |edge: &Edge, of: Side| {
        if edge.0 > inner.0 && edge.0 <= inner.1 {
            wrong.push(EdgeFault {
                at_ns: edge.0,
                to: edge.1.clone(),
                of,
            });
        }
    };
    // The first entries are values, not edges.
    let (mut left, mut right) = (
        recorded.iter().skip(1).peekable(),
        found.iter().skip(1).peekable(),
    );
    let (mut matched, mut farthest) = (0, 0);
    loop {
        match (left.peek(), right.peek()) {
            (None, None) => break,
            (Some(a), Some(b)) if a.1 == b.1 && a.0.abs_diff(b.0) <= tolerance.unsigned_abs() => {
                // A value that both have before the window does not count.
                let inside = |ns: i64| ns >= window.0 && ns <= window.1;
                if inside(a.0) || inside(b.0) {
                    matched += 1;
                    farthest = farthest.max(i64::try_from(a.0.abs_diff(b.0)).unwrap_or(i64::MAX));
                }
                left.next();
                right.next();
            }
            (Some(a), Some(b)) if a.0 <= b.0 => {
                fault(a, Side::Recorded);
                left.next();
            }
            (Some(a), None) => {
                fault(a, Side::Recorded);
                left.next();
            }
            (_, Some(b)) => {
                fault(b, Side::Trace);
                right.next();
            }
        }
    }
    wrong.sort_by_key(|fault| fault.at_ns);
    Finding::Edges {
        matched,
        farthest,
        wrong,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn edges(first: bool, times: &[i64]) -> Vec<Edge> {
        let mut value = first;
        let mut list = vec![(0, text(first))];
        for &ns in times {
            value = !value;
            list.push((ns, text(value)));
        }
        list
    }

    fn text(value: bool) -> String {
        if value { "TRUE" } else { "FALSE" }.to_owned()
    }

    /// Matched edges and their farthest distance; then the faults.
    fn compared(recorded: &[i64], found: &[i64]) -> (usize, i64, Vec<(i64, Side)>) {
        match compare(&edges(false, recorded), &edges(false, found), (0, 100), 3) {
            Finding::Edges {
                matched,
                farthest,
                wrong,
            } => (
                matched,
                farthest,
                wrong.into_iter().map(|fault| (fault.at_ns, fault.of)).collect(),
            ),
            Finding::Curve { .. } => unreachable!("edges give edges"),
        }
    }

    #[test]
    fn edges_pair_within_the_tolerance_of_time_and_no_further() {
        assert_eq!(compared(&[10, 20], &[12, 17]), (2, 3, vec![]));
        let late = vec![(20, Side::Recorded), (24, Side::Trace)];
        assert_eq!(compared(&[10, 20], &[12, 24]), (1, 2, late));
    }

    #[test]
    fn a_pulse_of_one_side_shows_both_its_edges() {
        let extra = vec![(40, Side::Trace), (41, Side::Trace)];
        assert_eq!(compared(&[10], &[10, 40, 41]), (1, 0, extra));
        let missed = vec![(40, Side::Recorded), (41, Side::Recorded)];
        assert_eq!(compared(&[10, 40, 41, 60], &[10, 60]), (2, 0, missed));
    }

    #[test]
    fn at_the_ends_of_the_window_a_counterpart_may_lie_outside() {
        assert_eq!(compared(&[2], &[]), (0, 0, vec![]));
        assert_eq!(compared(&[98], &[]), (0, 0, vec![]));
        assert_eq!(compared(&[97], &[]), (0, 0, vec![(97, Side::Recorded)]));
    }

    #[test]
    fn another_value_from_the_start_is_told_even_without_edges() {
        let finding = compare(&edges(false, &[]), &edges(true, &[]), (0, 100), 3);
        let Finding::Edges { wrong, .. } = finding else {
            unreachable!("edges give edges")
        };
        assert_eq!(wrong.len(), 1);
        assert_eq!(wrong[0].of, Side::Start);
    }
}

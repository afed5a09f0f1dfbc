//! Claims and conditions as text.

use crate::model::{ClaimKind, Comparison, Condition, Range, Signal, Test};
use crate::run::Rows;
use crate::run::cells::value_text;
use standstill_trace::{cell_text, shortest};

/// What a claim says, in one line.
pub(super) fn claim(rows: &Rows<'_>, kind: &ClaimKind) -> String {
    match kind {
        ClaimKind::At(scan, that) => format!("at {scan}: {}", conditions(rows, that)),
        ClaimKind::By(range, that) => {
            format!("once at least{}: {}", scans(*range), conditions(rows, that))
        }
        ClaimKind::Always { range, during, that } => {
            format!(
                "always{}{}: {}",
                scans(*range),
                whenever(rows, during),
                conditions(rows, that)
            )
        }
        ClaimKind::Never { range, during, that } => {
            format!(
                "never{}{}: {}",
                scans(*range),
                whenever(rows, during),
                conditions(rows, that)
            )
        }
        ClaimKind::Once(range, that) => {
            format!("exactly once{}: {}", scans(*range), conditions(rows, that))
        }
        ClaimKind::Exclusive(range, points) => {
            let names: Vec<_> = points.iter().map(|(name, _)| name.as_str()).collect();
            format!("at most one{}: {}", scans(*range), names.join(", "))
        }
        ClaimKind::WithinLimits { range, axis, factor } => {
            let axis = rows.script.axes.get(*axis).map_or("", |axis| axis.name.as_str());
            let factor = match factor {
                1.0 => String::new(),
                factor => format!(" times {}", shortest(*factor)),
            };
            format!("{axis} within its limits{factor}{}", scans(*range))
        }
    }
}

/// ` from 3 to 9`, as far as the range says so.
fn scans(Range { from, to }: Range) -> String {
    let from = match from {
        0 => String::new(),
        from => format!(" from {from}"),
    };
    match to {
        Some(to) => format!("{from} to {to}"),
        None => from,
    }
}

fn whenever(rows: &Rows<'_>, during: &[Condition]) -> String {
    match during {
        [] => String::new(),
        during => format!(" while {}", conditions(rows, during)),
    }
}

/// `first.Done TRUE, X.Velocity <= 50.0`
pub(super) fn conditions(rows: &Rows<'_>, conditions: &[Condition]) -> String {
    let each = |condition: &Condition| {
        format!(
            "{} {}",
            condition.text,
            test(rows, &condition.signal, &condition.test)
        )
    };
    conditions.iter().map(each).collect::<Vec<_>>().join(", ")
}

/// What a test asks for: `TRUE`, `DiscreteMotion`, `<= 50.0`.
pub(super) fn test(rows: &Rows<'_>, signal: &Signal, test: &Test) -> String {
    match test {
        Test::Bool(value) => value.to_string().to_uppercase(),
        Test::Exactly(value) => shortest(*value),
        Test::State(state) => state.name().to_owned(),
        Test::Named(value) => value_text(rows.script, rows.pin_type(signal), *value),
        Test::Compare(comparisons) => comparisons
            .iter()
            .map(|one| comparison(rows, signal, one))
            .collect::<Vec<_>>()
            .join(" and "),
    }
}

fn comparison(rows: &Rows<'_>, signal: &Signal, comparison: &Comparison) -> String {
    match comparison {
        Comparison::Near { near, within } => {
            format!("within {} of {}", shortest(*within), shortest(*near))
        }
        Comparison::Le(bound) => format!("<= {}", shortest(*bound)),
        Comparison::Ge(bound) => format!(">= {}", shortest(*bound)),
        Comparison::Lt(bound) => format!("< {}", shortest(*bound)),
        Comparison::Gt(bound) => format!("> {}", shortest(*bound)),
        Comparison::AbsLe(bound) => format!("of magnitude <= {}", shortest(*bound)),
        Comparison::Ne(other) => format!("other than {}", test(rows, signal, other)),
        Comparison::SameAs(name, _) => format!("the same as {name}"),
    }
}

/// The values a condition looks at in a scan: `X.Velocity 50.1`, and what it is compared with.
pub(super) fn values(rows: &Rows<'_>, condition: &Condition, scan: u64) -> String {
    let text = |signal| {
        rows.cell(signal, scan)
            .map_or_else(|| "nothing".to_owned(), cell_text)
    };
    let mut text_of_all = text(&condition.signal);
    if let Test::Compare(comparisons) = &condition.test {
        for comparison in comparisons {
            if let Comparison::SameAs(name, other) = comparison {
                text_of_all.push_str(&format!(" ({name} {})", text(other)));
            }
        }
    }
    text_of_all
}

//! Claims and conditions as text.

use crate::model::{Bounds, ClaimKind, Comparison, Condition, Follow, Range, Relation, Signal, Test};
use crate::run::Rows;
use crate::run::cells::value_text;
use standstill_trace::{cell_text, shortest};

/// A claim in one line of text.
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
            let axis = axis_name(rows, *axis);
            let factor = match factor {
                1.0 => String::new(),
                factor => format!(" times {}", shortest(*factor)),
            };
            format!("{axis} within its limits{factor}{}", scans(*range))
        }
        ClaimKind::Follows {
            range,
            during,
            follow,
        } => format!("{}{}{}", law(rows, follow), scans(*range), whenever(rows, during)),
        ClaimKind::Answered {
            range,
            during,
            when,
            within,
            that,
            first,
        } => format!(
            "{} {}{}{}: within {within} scans {}",
            if *first {
                "after the first rising of"
            } else {
                "after each rising of"
            },
            conditions(rows, when),
            scans(*range),
            whenever(rows, during),
            conditions(rows, that)
        ),
        ClaimKind::NeverFor {
            range,
            during,
            that,
            scans: most,
        } => format!(
            "never for {most} scans on end{}{}: {}",
            scans(*range),
            whenever(rows, during),
            conditions(rows, that)
        ),
        ClaimKind::Duration {
            range,
            during,
            ends: [begin, end],
            bounds,
            each,
        } => format!(
            "{} from {} to {}{}{}: {} scans",
            if *each { "each time" } else { "the first time" },
            conditions(rows, begin),
            conditions(rows, end),
            scans(*range),
            whenever(rows, during),
            bounded(*bounds)
        ),
        ClaimKind::Count {
            range,
            during,
            that,
            bounds,
        } => format!(
            "{} risings{}{}: {}",
            bounded(*bounds),
            scans(*range),
            whenever(rows, during),
            conditions(rows, that)
        ),
    }
}

/// `S follows M at 3/7`
pub(super) fn law(rows: &Rows<'_>, follow: &Follow) -> String {
    let through = match follow.anchor {
        Some([master, slave]) => format!(" through {} at {}", shortest(slave), shortest(master)),
        None => String::new(),
    };
    let (slave, master) = (axis_name(rows, follow.slave), axis_name(rows, follow.master));
    format!(
        "{slave} follows {master} at {}/{}{through}",
        follow.num, follow.den
    )
}

pub(super) fn axis_name<'a>(rows: &Rows<'a>, axis: usize) -> &'a str {
    rows.script.axes.get(axis).map_or("", |axis| &axis.name)
}

/// `3 to 5`, `at most 5`; only for bounds that are given.
pub(super) fn bounded(bounds: Bounds) -> String {
    match (bounds.ge, bounds.le) {
        (Some(ge), Some(le)) if ge == le => format!("exactly {ge}"),
        (Some(ge), Some(le)) => format!("{ge} to {le}"),
        (Some(ge), None) => format!("at least {ge}"),
        (None, Some(le)) => format!("at most {le}"),
        (None, None) => "any number of".to_owned(),
    }
}

/// ` from 3 to 9`; only for ends that are given.
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

/// The condition of a test: `TRUE`, `DiscreteMotion`, `<= 50.0`.
pub(super) fn test(rows: &Rows<'_>, signal: &Signal, test: &Test) -> String {
    match test {
        Test::Bool(value) => value.to_string().to_uppercase(),
        Test::Exactly(value) => shortest(*value),
        Test::State(state) => state.name().to_owned(),
        Test::Named(value) => value_text(rows.script, rows.pin_type(signal), *value),
        Test::Word(word) => word.clone(),
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
        Comparison::NearTo {
            name, plus, within, ..
        } => format!("within {} of {name} plus {}", shortest(*within), shortest(*plus)),
        Comparison::Le(bound) => format!("<= {}", shortest(*bound)),
        Comparison::Ge(bound) => format!(">= {}", shortest(*bound)),
        Comparison::Lt(bound) => format!("< {}", shortest(*bound)),
        Comparison::Gt(bound) => format!("> {}", shortest(*bound)),
        Comparison::AbsLe(bound) => format!("of magnitude <= {}", shortest(*bound)),
        Comparison::Ne(other) => format!("other than {}", test(rows, signal, other)),
        Comparison::SameAs(name, _) => format!("the same as {name}"),
        Comparison::Whole(relation, bound) => {
            let sign = match relation {
                Relation::Eq => "",
                Relation::Le => "<= ",
                Relation::Ge => ">= ",
                Relation::Lt => "< ",
                Relation::Gt => "> ",
                Relation::AbsLe => "of magnitude <= ",
            };
            format!("{sign}{bound}")
        }
    }
}

/// Whether a signal is an expression without a value in a scan, which counts as FALSE. Another failure of its claim
/// gives the reason.
fn faulted(rows: &Rows<'_>, signal: &Signal, scan: u64) -> bool {
    let Signal::Formula(formula) = *signal else {
        return false;
    };
    rows.truths.faults(formula).any(|(fault, _)| fault == scan)
}

/// The values that a condition uses in a scan: `X.Velocity 50.1`, and the value that it is compared with.
pub(super) fn values(rows: &Rows<'_>, condition: &Condition, scan: u64) -> String {
    let text = |signal: &Signal| match rows.cell(signal, scan) {
        None => "nothing".to_owned(),
        Some(_) if faulted(rows, signal, scan) => "no value".to_owned(),
        Some(cell) => cell_text(cell),
    };
    let mut text_of_all = text(&condition.signal);
    if let Test::Compare(comparisons) = &condition.test {
        for comparison in comparisons {
            if let Comparison::SameAs(name, other) | Comparison::NearTo { name, of: other, .. } = comparison {
                text_of_all.push_str(&format!(" ({name} {})", text(other)));
            }
        }
    }
    text_of_all
}

//! Claims and conditions as text.

use crate::model::{Bounds, Claim, ClaimKind, Comparison, Condition, Follow, Range, Relation, Signal, Test};
use crate::run::Rows;
use crate::run::cells::value_text;
use standstill_trace::{cell_text, shortest};

/// A claim in one line of text.
pub(super) fn claim(rows: &Rows<'_>, claim: &Claim) -> String {
    let all = |that: &[Condition]| conditions(rows, that);
    let covered = format!("{}{}", scans(claim.range), whenever(rows, &claim.during));
    match &claim.kind {
        ClaimKind::At(that) => format!("at {}: {}", claim.range.from, all(that)),
        ClaimKind::By(that) => format!("once at least{covered}: {}", all(that)),
        ClaimKind::Always(that) => format!("always{covered}: {}", all(that)),
        ClaimKind::Never(that) => format!("never{covered}: {}", all(that)),
        ClaimKind::Once(that) => format!("exactly once{covered}: {}", all(that)),
        ClaimKind::Exclusive(points) => {
            let names: Vec<_> = points.iter().map(|(name, _)| name.as_str()).collect();
            format!("at most one{covered}: {}", names.join(", "))
        }
        ClaimKind::WithinLimits { axis, factor } => {
            let axis = axis_name(rows, *axis);
            let factor = match factor {
                1.0 => String::new(),
                factor => format!(" times {}", shortest(*factor)),
            };
            format!("{axis} within its limits{factor}{covered}")
        }
        ClaimKind::Follows(follow) => format!("{}{covered}", law(rows, follow)),
        ClaimKind::Answered {
            when,
            within,
            that,
            first,
        } => {
            let which = if *first { "the first" } else { "each" };
            let (when, that) = (all(when), all(that));
            format!("after {which} rising of {when}{covered}: within {within} scans {that}")
        }
        ClaimKind::NeverFor { that, scans: most } => {
            format!("never for {most} scans on end{covered}: {}", all(that))
        }
        ClaimKind::Duration { ends, bounds, each } => {
            let which = if *each { "each time" } else { "the first time" };
            let [begin, end] = ends.each_ref().map(|end| all(end));
            let bounds = bounded(*bounds);
            format!("{which} from {begin} to {end}{covered}: {bounds} scans")
        }
        ClaimKind::Count { that, bounds } => {
            format!("{} risings{covered}: {}", bounded(*bounds), all(that))
        }
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

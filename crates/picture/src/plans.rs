//! The picture of plans: their courses over each other, from one start.

use super::across::{Line, Panel, Panels};
use super::picture::{GUTTER, Picture, ROW, wrapped};

/// The largest number of plans that are drawn: the number of colours.
pub const PLANS_MAX: usize = 6;

const STYLE: &str = "<style>\n\
    .p0 { stroke: #1d5fc4 } .p1 { stroke: #c2500a } .p2 { stroke: #14773f } .p3 { stroke: #8a2fb0 } .p4 { stroke: #a01840 }\n\
    .p5 { stroke: #5c5c00 }\n\
    @media (prefers-color-scheme: dark) { .p0 { stroke: #7fb2ff } .p1 { stroke: #ffa566 } .p2 { stroke: #63d297 }\n\
    .p3 { stroke: #d59bf0 } .p4 { stroke: #ff8fae } .p5 { stroke: #d8d46a } }\n\
    </style>\n";

/// Largest number of letters of a plan's label on its line.
const LABEL: usize = 110;

/// The curves, below each other, and their units.
const TITLES: [(&str, &str); 5] = [
    ("Position", "u"),
    ("Velocity", "u/s"),
    ("Acceleration", "u/s^2"),
    ("Jerk", "u/s^3"),
    ("Snap", "u/s^4"),
];

/// A plan to draw.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// Its label.
    pub label: String,
    /// Points of its course: time (s), position, velocity, acceleration, jerk, snap (in u and s). Times do not
    /// fall; at equal ones a value jumps.
    pub course: Vec<[f64; 6]>,
    /// Limits of velocity, acceleration, jerk and snap, if there are some.
    pub limits: [Option<f64>; 4],
}

/// The picture of up to [`PLANS_MAX`] plans: the labels, then position to snap, each in one range for all
/// plans. Limits are dashed where a curve comes near. Quantities that are constant in every plan are left
/// out.
///
/// Work is proportional to the points.
#[must_use]
pub fn plans(title: &str, plans: &[Plan]) -> String {
    let plans = &plans[..plans.len().min(PLANS_MAX)];
    let mut picture = Picture::new(0);
    picture.body.push_str(STYLE);
    for (plan, at) in plans.iter().zip(0..) {
        let y = picture.y + 4.0;
        picture.line(&format!("p{at}"), &format!("M{GUTTER} {:.1}h24", y - 4.0));
        let label = wrapped(&plan.label, LABEL).into_iter().next().unwrap_or_default();
        picture.text("", "start", [GUTTER + 30.0, y], &label);
        picture.y += ROW;
    }
    let moments = || plans.iter().flat_map(|plan| &plan.course);
    let end = moments().map(|moment| moment[0]).fold(0.0, f64::max);
    let mut panels = Panels::new(picture, (0.0, end));
    for (at, (name, unit)) in TITLES.iter().enumerate() {
        let lines = plans.iter().zip(0..).map(|(plan, line)| Line {
            class: format!("p{line}"),
            points: plan
                .course
                .iter()
                .map(|moment| [moment[0], moment[at + 1]])
                .collect(),
        });
        let lines: Vec<Line> = lines.collect();
        panels.draw(&Panel {
            title: &format!("{name} ({unit})"),
            lines: &lines,
            limits: &limits(plans, at),
            marks: &[],
            with_zero: true,
        });
    }
    panels.finish(title, "time (s)")
}

/// The limits of a panel, each once, on both sides.
fn limits(plans: &[Plan], panel: usize) -> Vec<f64> {
    let own = |plan: &Plan| panel.checked_sub(1).and_then(|at| plan.limits[at]);
    let mut all: Vec<f64> = plans
        .iter()
        .filter_map(own)
        .flat_map(|limit| [limit, -limit])
        .collect();
    all.sort_by(f64::total_cmp);
    all.dedup();
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(label: &str, end: f64) -> Plan {
        Plan {
            label: label.to_owned(),
            course: vec![
                [0.0, 0.0, 0.0, 2.0, 0.0, 0.0],
                [0.5 * end, 1.0, 2.0, 2.0, 0.0, 0.0],
                [0.5 * end, 1.0, 2.0, -2.0, 0.0, 0.0],
                [end, 2.0, 0.0, -2.0, 0.0, 0.0],
            ],
            limits: [Some(2.0), Some(50.0), None, None],
        }
    }

    #[test]
    fn courses_labels_and_near_limits_are_drawn() {
        let picture = plans("two", &[plan("<one>", 1.0), plan("two", 2.0)]);
        assert!(picture.contains(">&lt;one&gt;<"), "{picture}");
        assert!(
            picture.contains(">Position (u)<") && !picture.contains(">Jerk"),
            "{picture}"
        );
        // A legend and three panels for each; the limit of velocity alone is near.
        for class in ["p0", "p1"] {
            assert_eq!(
                picture.matches(&format!("class=\"{class}\"")).count(),
                4,
                "{picture}"
            );
        }
        assert_eq!(picture.matches("class=\"limit\"").count(), 1, "{picture}");
        // The shorter one ends in the middle: 190 + 660 / 2.
        let first = picture
            .lines()
            .filter(|line| line.contains("class=\"p0\""))
            .nth(1)
            .unwrap_or_default();
        assert!(first.contains("L520.0 "), "{first}");
        assert!(
            picture.contains(">0.5<") && picture.contains(">time (s)<"),
            "{picture}"
        );
    }

    #[test]
    fn nothing_and_too_much_to_draw_have_a_picture() {
        assert!(plans("", &[]).ends_with("</svg>\n"));
        let many: Vec<Plan> = (0..9).map(|at| plan(&at.to_string(), 1e-9)).collect();
        let picture = plans("", &many);
        assert!(
            picture.contains(">5<") && !picture.contains(">6</text>"),
            "{picture}"
        );
        let still = Plan {
            course: vec![[0.0; 6]; 2],
            ..plan("still", 1.0)
        };
        assert!(plans("", &[still]).contains(">still<"));
        let endless = Plan {
            course: vec![[f64::INFINITY; 6]; 2],
            ..plan("endless", 1.0)
        };
        assert!(plans("", &[endless]).ends_with("</svg>\n"));
    }
}

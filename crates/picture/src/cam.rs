//! The picture of a cam: the slave's position, and its derivatives by the master.

use super::across::{Line, Panel, Panels};
use super::picture::{GUTTER, Picture, ROW};

const STYLE: &str = "<style>\n\
    .mark { fill: #c2500a; stroke: none }\n\
    @media (prefers-color-scheme: dark) { .mark { fill: #ffa566 } }\n\
    </style>\n";

/// More rows than this are not marked: their dots would hide the curve.
const MARKS_MOST: usize = 100;

/// The curves, below each other.
const TITLES: [&str; 5] = ["Slave", "Slope", "Curvature", "Third", "Fourth"];

/// The picture of a cam. `course` are points of it (positions of the master and the slave, four derivatives of the
/// slave by the master) whose master positions do not fall; at equal ones a value jumps. `rows` are marked. Curves
/// that are always 0 are left out.
///
/// Work is proportional to the points.
#[must_use]
pub fn cam(title: &str, course: &[[f64; 6]], rows: &[[f64; 2]]) -> String {
    let place = |moment: Option<&[f64; 6]>| moment.map_or(0.0, |moment| moment[0]);
    let mut picture = Picture::new(0);
    picture.body.push_str(STYLE);
    picture.text("", "start", [GUTTER, picture.y + 4.0], title);
    picture.y += ROW;
    let mut panels = Panels::new(picture, (place(course.first()), place(course.last())));
    for (at, name) in (1..).zip(TITLES) {
        let lines = [Line {
            class: "curve".to_owned(),
            points: course.iter().map(|moment| [moment[0], moment[at]]).collect(),
        }];
        let marks = if at == 1 && rows.len() <= MARKS_MOST {
            rows
        } else {
            &[]
        };
        panels.draw(&Panel {
            title: name,
            lines: &lines,
            limits: &[],
            marks,
            with_zero: at > 1,
        });
    }
    panels.finish(title, "master (u)")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cam_has_a_panel_for_each_derivative_that_is_not_0_and_its_rows_are_marked() {
        let straight = [[-10.0, 5.0, 0.5, 0.0, 0.0, 0.0], [10.0, 15.0, 0.5, 0.0, 0.0, 0.0]];
        let picture = cam("<knife>", &straight, &[[-10.0, 5.0], [10.0, 15.0]]);
        assert!(picture.contains(">&lt;knife&gt;</text>"), "{picture}");
        assert!(
            picture.contains(">Slope<") && !picture.contains(">Curvature<"),
            "{picture}"
        );
        assert_eq!(picture.matches("class=\"mark\"").count(), 2, "{picture}");
        // The axis begins where the cam does.
        assert!(
            picture.contains(">-10<") && picture.contains(">master (u)<"),
            "{picture}"
        );
        assert!(cam("", &[], &[]).ends_with("</svg>\n"));
    }
}

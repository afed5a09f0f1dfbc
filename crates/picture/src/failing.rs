//! The picture of a test that fails: the run over the expected run, their first difference, the cause,
//! and the claims in words.

use super::picture::{CURVE, GAP, GUTTER, Picture, ROW};
use super::range::{Range, limits, ticks};
use super::report::{self, draw_claim};
use crate::panels::{Curve, Wave, curves};
use standstill_trace::story::story;
use standstill_trace::{ClaimVerdict, Kind, Trace};

/// The curves of an axis that are drawn.
const SIGNALS: [&str; 2] = ["Position", "Velocity"];

const STYLE: &str = "<style>\n\
    .was { stroke: #777; stroke-dasharray: 5 3 } .part { stroke: #c22; stroke-width: 1; stroke-dasharray: 4 3 }\n\
    .bad { fill: #b01010 } rect.cause { fill: #fff0f0; stroke: #d88 }\n\
    @media (prefers-color-scheme: dark) { .was { stroke: #999 } .part { stroke: #ff6b6b } .bad { fill: #ff8a8a }\n\
    rect.cause { fill: #3a1d1f; stroke: #a55 } }\n\
    </style>\n";

/// The picture of a run of the script `name` that differs from the expected one: verdict and likeliest
/// cause, the states of each axis, its position and velocity over the expected ones, every Boolean output
/// that differs, and the claims in words. A line marks the first scan in which any of these differ.
///
/// Work is proportional to rows times columns.
#[must_use]
pub fn failing(name: &str, expected: &Trace, found: &Trace) -> String {
    let mut picture = Picture::new(found.scans());
    picture.body.push_str(report::STYLE);
    picture.body.push_str(STYLE);
    heading(&mut picture, name, expected, found);
    let (top, ticks) = (picture.y, ticks(found.scans()));
    let (before, after) = (curves(expected, &SIGNALS), curves(found, &SIGNALS));
    let differing = differing(expected, found);
    for axis in &found.header().axes {
        picture.states(found, axis);
        for curve in after.iter().filter(|curve| std::ptr::eq(curve.axis, axis)) {
            draw(
                &mut picture,
                before.iter().find(|was| was.title == curve.title),
                curve,
                &ticks,
            );
        }
    }
    picture.over_grid(&ticks, |picture| {
        for (was, is) in &differing {
            let y = picture.y;
            picture.wave_of("was", was);
            picture.y = y;
            picture.wave(is);
        }
    });
    picture.y += GAP;
    let bottom = picture.y - GAP + 4.0;
    if let Some(scan) = parting(&before, &after, &differing) {
        let x = picture.x(scan);
        picture.line("part", &format!("M{x:.1} {top:.1}V{bottom:.1}"));
    }
    picture.over_grid(&ticks, |picture| {
        for claim in &found.header().claims {
            draw_claim(picture, claim);
        }
    });
    picture.time(found.header().cycle_ns, &ticks);
    picture.finish(&format!("{name}: a test that fails"))
}

/// Verdict, cause, and the legend.
fn heading(picture: &mut Picture, name: &str, expected: &Trace, found: &Trace) {
    let claims = &found.header().claims;
    let held = claims
        .iter()
        .filter(|claim| claim.verdict == ClaimVerdict::Passed)
        .count();
    picture.y += GAP / 2.0;
    let verdict = format!("{name}: FAILED, {held} of {} claims hold", claims.len());
    picture.text("title bad", "start", [GAP, picture.y + 4.0], &verdict);
    picture.y += ROW;
    let cause = story(expected, found).and_then(|story| story.causes.into_iter().next());
    if let Some(cause) = cause {
        picture.note("cause", &cause.to_string());
    }
    let y = picture.y + 3.0;
    picture.line("curve", &format!("M{GUTTER} {:.1}h24", y - 4.0));
    picture.text("small unit", "start", [GUTTER + 30.0, y], "this run");
    picture.line("was", &format!("M{:.1} {:.1}h24", GUTTER + 100.0, y - 4.0));
    picture.text("small unit", "start", [GUTTER + 130.0, y], "as it was (golden)");
    picture.line("part", &format!("M{:.1} {:.1}v10", GUTTER + 250.0, y - 9.0));
    picture.text("small unit", "start", [GUTTER + 258.0, y], "where they part");
    picture.y += GAP;
}

/// Booleans that both runs have and that differ: expected and actual.
fn differing(expected: &Trace, found: &Trace) -> Vec<(Wave, Wave)> {
    let columns = found.columns().iter().enumerate();
    let columns = columns.filter(|(_, column)| column.kind == Kind::Bool);
    let both = columns.filter_map(|(at, column)| {
        let was = expected.cells(expected.column(&column.name)?);
        Some((Wave::new(column, was), Wave::new(column, found.cells(at))))
    });
    both.filter(|(was, is)| was.levels != is.levels).collect()
}

/// A panel with both curves in one range.
fn draw(picture: &mut Picture, was: Option<&Curve<'_>>, is: &Curve<'_>, ticks: &[usize]) {
    let both = [was, Some(is)].into_iter().flatten();
    let range = Range::of(
        both.clone().map(|curve| curve.least).fold(is.least, f64::min),
        both.map(|curve| curve.greatest).fold(is.greatest, f64::max),
    );
    let bottom = picture.y + CURVE;
    picture.line_of(&is.title, &is.values, &range, &limits(is), ticks);
    if let Some(was) = was {
        picture.trail("was", &was.values, |value| bottom - CURVE * range.part(value));
    }
}

/// The first scan in which any of them differ.
fn parting(before: &[Curve<'_>], after: &[Curve<'_>], waves: &[(Wave, Wave)]) -> Option<usize> {
    let curves = after.iter().filter_map(|is| {
        let was = before.iter().find(|was| was.title == is.title)?;
        let mut both = was.values.iter().zip(&is.values);
        both.position(|(was, is)| was != is)
    });
    let waves = waves.iter().filter_map(|(was, is)| {
        let mut both = was.levels.iter().zip(&is.levels);
        both.position(|(was, is)| was != is)
    });
    curves.chain(waves).min()
}

#[cfg(test)]
mod tests {
    use super::*;
    use standstill_trace::{Axis, Cell, Claim, ClaimFailure, Header, Input};

    fn trace(turns: usize) -> Trace {
        let mut trace = Trace::new(Header {
            title: "there".into(),
            cycle_ns: 1_000_000,
            axes: vec![Axis {
                name: "X".into(),
                ..Axis::default()
            }],
            inputs: vec![Input {
                name: "GO".into(),
                iec_type: "BOOL".into(),
            }],
            claims: vec![Claim {
                path: "expect[0].never".into(),
                text: "never <GO>".into(),
                verdict: ClaimVerdict::Failed,
                scans: Some([0, 99]),
                held: None,
                failures: vec![ClaimFailure {
                    scan: Some(turns),
                    text: "GO TRUE".into(),
                }],
            }],
            ..Header::default()
        });
        for scan in 0..100 {
            let place = scan.min(turns) as f64;
            let mut row = vec![Cell::Name("DiscreteMotion")];
            row.extend([place, 0.0, 0.0, 0.0, 0.0, place].map(Cell::Real));
            row.push(Cell::Bool(scan >= turns));
            trace.push_row(&row).expect("a row of the header");
        }
        trace
    }

    #[test]
    fn it_shows_both_runs_where_they_part_and_the_claims_in_their_words() {
        let picture = failing("<there>", &trace(50), &trace(70));
        assert!(
            picture.contains("&lt;there&gt;: FAILED, 0 of 1 claims hold"),
            "{picture}"
        );
        assert!(picture.contains(">never &lt;GO&gt;<"), "{picture}");
        assert_eq!(
            picture.matches("class=\"was\"").count(),
            4,
            "legend, two curves, one wave: {picture}"
        );
        // Scan 50 of 100 on a scale from 190 to 850: there the expected one rises.
        let part = picture
            .lines()
            .filter(|line| line.starts_with("<path class=\"part\""))
            .nth(1);
        assert!(part.is_some_and(|line| line.contains("M520.0 ")), "{picture}");
    }

    #[test]
    fn equal_runs_part_nowhere() {
        let picture = failing("there", &trace(50), &trace(50));
        assert_eq!(
            picture.matches("<path class=\"part\"").count(),
            1,
            "the legend alone: {picture}"
        );
    }
}

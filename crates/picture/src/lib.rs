//! Scan traces as pictures: curves with limits, axis states, and the Booleans that change as a timing diagram.
//!
//! [`report`] draws a whole run, [`failing`] a failing one, [`svg`] the requested signals; [`plans()`] and
//! [`cam()`] draw the plans and cams of the command line. [`plot`] draws in a terminal.
//!
//! Pictures are drawn in numbers with one decimal, so the same trace gives the same bytes everywhere.
//! Their colours follow the reader's light or dark theme. They load nothing.

#![forbid(unsafe_code)]

mod across;
mod cam;
mod failing;
mod markup;
mod panels;
mod picture;
mod plans;
mod plot;
mod range;
mod report;

pub use cam::cam;
pub use failing::failing;
pub use markup::escaped;
use panels::{curves, waves};
use picture::{GAP, Picture};
pub use picture::{Theme, themed};
pub use plans::{PLANS_MAX, Plan, plans};
pub use plot::plot;
use range::{Range, ticks};
pub use report::report;
use standstill_trace::Trace;

/// The picture of a trace. For every axis: its states and the curves of `signals` (names of
/// [`AXIS_SIGNALS`](standstill_trace::AXIS_SIGNALS); limits near a curve are dashed). Then every Boolean that
/// changes, with inputs and outputs distinct, over scans and time.
///
/// A pulse of one scan stays visible in a run of any length. Work is proportional to rows times columns.
#[must_use]
pub fn svg(trace: &Trace, signals: &[&str]) -> String {
    let mut picture = Picture::new(trace.scans());
    let curves = curves(trace, signals);
    let waves = waves(trace);
    let ticks = ticks(trace.scans());
    for axis in &trace.header().axes {
        picture.states(trace, axis);
        for curve in curves.iter().filter(|curve| std::ptr::eq(curve.axis, axis)) {
            picture.curve(curve, &ticks);
        }
    }
    picture.over_grid(&ticks, |picture| {
        for (index, wave) in waves.iter().enumerate() {
            let before = index.checked_sub(1).and_then(|before| waves.get(before));
            if before.is_some_and(|before| subject(&before.name) != subject(&wave.name)) {
                picture.y += GAP / 2.0;
            }
            picture.wave(wave);
        }
    });
    picture.time(trace.header().cycle_ns, &ticks);
    picture.finish(&trace.header().title)
}

/// Curves with one value for each scan, below each other: a title and its values, over scans of `cycle_ns`. All
/// have one range, so that they can be compared.
#[must_use]
pub fn chart(title: &str, cycle_ns: u64, curves: &[(String, Vec<f64>)]) -> String {
    let scans = curves.iter().map(|(_, values)| values.len()).max().unwrap_or(0);
    let mut picture = Picture::new(scans);
    let ticks = ticks(scans);
    let all = || curves.iter().flat_map(|(_, values)| values).copied();
    let range = Range::of(all().fold(0.0, f64::min), all().fold(0.0, f64::max));
    for (title, values) in curves {
        picture.line_of(title, values, &range, &[], &ticks);
    }
    picture.time(cycle_ns, &ticks);
    picture.finish(title)
}

fn subject(name: &str) -> &str {
    name.split('.').next().unwrap_or(name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use standstill_trace::Cell;
    use standstill_trace::{Axis, Header, Input, Limits};

    fn trace(title: &str, scans: usize, pulse: usize) -> Trace {
        let mut trace = Trace::new(Header {
            title: title.into(),
            cycle_ns: 1_000_000,
            axes: vec![Axis {
                name: "X".into(),
                unit: "mm".into(),
                limits: Limits {
                    velocity: Some(2.0),
                    ..Limits::default()
                },
                ..Axis::default()
            }],
            inputs: vec![Input {
                name: "GO".into(),
                iec_type: "BOOL".into(),
            }],
            ..Header::default()
        });
        for scan in 0..scans {
            let place = scan as f64;
            let velocity = if scan < scans / 2 { 2.0 } else { 1.0 };
            let mut row = vec![Cell::Name(if scan < scans / 2 {
                "DiscreteMotion"
            } else {
                "Standstill"
            })];
            row.extend([place, velocity, 0.0, 0.0, 0.0, place].map(Cell::Real));
            row.push(Cell::Bool(scan == pulse));
            trace.push_row(&row).expect("a row of the header");
        }
        trace
    }

    #[test]
    fn every_text_is_escaped() {
        let picture = svg(&trace("<img onerror=\"x\"> & \u{7}", 10, 3), &["Position"]);
        assert!(picture.contains("<title>&lt;img onerror=&quot;x&quot;&gt; &amp; \\u{7}</title>"));
        assert!(!picture.contains("<img"));
    }

    #[test]
    fn a_pulse_of_one_scan_is_drawn_however_long_the_run() {
        let picture = svg(&trace("", 100_000, 70_000), &[]);
        let wave = picture
            .lines()
            .find(|line| line.contains("class=\"in\""))
            .expect("a wave");
        assert_eq!(wave.matches('V').count(), 2, "{wave}");
    }

    #[test]
    fn straight_lines_have_two_points_and_limits_near_a_curve_are_drawn() {
        let picture = svg(&trace("", 1000, 3), &["Position", "Velocity"]);
        let curves: Vec<_> = picture
            .lines()
            .filter(|line| line.contains("\"curve\""))
            .collect();
        let [position, velocity] = curves[..] else {
            panic!("{picture}")
        };
        assert_eq!(position.matches('L').count(), 1, "{position}");
        assert_eq!(velocity.matches('L').count(), 3, "{velocity}");
        assert_eq!(
            picture.matches("\"limit\"").count(),
            1,
            "only the upper limit is near"
        );
        assert!(picture.contains(">DiscreteMotion<") && picture.contains(">Standstill<"));
    }

    #[test]
    fn a_picture_for_one_light_has_its_colours_alone() {
        let both = report(&trace("there", 100, 3));
        assert_eq!(both.matches("@media").count(), 2);
        for (theme, kept, gone) in [
            (Theme::Light, "#1d5fc4", "#7fb2ff"),
            (Theme::Dark, "#7fb2ff", "@media"),
        ] {
            let one = themed(&both, theme);
            assert!(one.contains(kept) && !one.contains(gone), "{theme:?}: {one}");
            assert_eq!(
                one.matches('{').count(),
                one.matches('}').count(),
                "{theme:?}: {one}"
            );
            assert_eq!(one.matches("</style>").count(), 2, "{theme:?}: {one}");
            assert!(one.ends_with("</svg>\n"));
        }
    }

    #[test]
    fn a_trace_without_rows_has_a_picture() {
        assert!(svg(&trace("", 0, 0), &["Position"]).ends_with("</svg>\n"));
    }

    #[test]
    fn ticks_are_round_and_few() {
        for scans in [0, 1, 7, 10, 99, 1234, 1_000_000] {
            let ticks = ticks(scans);
            assert!((1..=12).contains(&ticks.len()), "{scans}: {ticks:?}");
            assert_eq!(ticks[0], 0);
        }
        assert_eq!(ticks(1600), [0, 200, 400, 600, 800, 1000, 1200, 1400, 1600]);
    }
}

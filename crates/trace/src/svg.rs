//! A run as a picture: curves with limits, axis states, and the Booleans that change as a timing diagram.
//!
//! The picture is drawn in numbers with one decimal, so the same trace gives the same bytes everywhere. Its colours
//! follow the reader's light or dark theme; it loads nothing.

use std::fmt::Write;

use crate::column::{Cell, Role};
use crate::header::Axis;
use crate::number::time_literal;
use crate::panels::{Curve, Wave, compact, curves, waves};
use crate::trace::Trace;

/// Width of the picture.
const WIDTH: f64 = 880.0;

/// Room for labels left of the curves.
const GUTTER: f64 = 190.0;

/// Room right of the curves, for half a tick label.
const MARGIN: f64 = 30.0;

/// Height of a curve.
const CURVE: f64 = 84.0;

/// Height of a band of states, and of the row of a Boolean.
const ROW: f64 = 18.0;

/// Height of a Boolean that is TRUE.
const LEVEL: f64 = 11.0;

/// Between one panel and the next.
const GAP: f64 = 14.0;

/// A point this near to the line between its neighbours is left out.
const NEAR: f64 = 0.1;

/// About so many ticks on the time axis.
const TICKS: f64 = 8.0;

/// Width of a character of a label, for what fits into a band.
const CHARACTER: f64 = 6.6;

const STYLE: &str = "<style>\n\
    text { fill: #222 } .small { font-size: 10px } .unit { fill: #666 }\n\
    path { fill: none; stroke-width: 1.5 } .frame { stroke: #bbb; stroke-width: 1 } .grid { stroke: #e4e4e4; stroke-width: 1 }\n\
    .limit { stroke: #c02020; stroke-width: 1; stroke-dasharray: 5 4 } .curve { stroke: #1d5fc4 }\n\
    .in { stroke: #8a5a00 } .out { stroke: #14773f } rect { fill: #eef2f8; stroke: #bbb }\n\
    @media (prefers-color-scheme: dark) { text { fill: #eee } .unit { fill: #aaa } .frame { stroke: #666 }\n\
    .grid { stroke: #333 } .limit { stroke: #ff7070 } .curve { stroke: #7fb2ff } .in { stroke: #e0b050 }\n\
    .out { stroke: #63d297 } rect { fill: #232a36; stroke: #666 } }\n\
    </style>\n";

/// The picture of a trace: for every axis its states and the curves of `signals` (names of
/// [`AXIS_SIGNALS`](crate::AXIS_SIGNALS); limits near a curve are dashed), then every Boolean that changes,
/// inputs and outputs told apart, over scans and time.
///
/// A pulse of one scan stays visible however long the run. Work is proportional to rows times columns.
#[must_use]
pub fn svg(trace: &Trace, signals: &[&str]) -> String {
    let mut picture = Picture {
        body: String::new(),
        y: GAP,
        scans: trace.scans(),
    };
    let curves = curves(trace, signals);
    let waves = waves(trace);
    let ticks = ticks(trace.scans());
    for axis in &trace.header().axes {
        picture.states(trace, axis);
        for curve in curves.iter().filter(|curve| std::ptr::eq(curve.axis, axis)) {
            picture.curve(curve, &ticks);
        }
    }
    let (top, place) = (picture.y, picture.body.len());
    for (index, wave) in waves.iter().enumerate() {
        let before = index.checked_sub(1).and_then(|before| waves.get(before));
        if before.is_some_and(|before| subject(&before.name) != subject(&wave.name)) {
            picture.y += GAP / 2.0;
        }
        picture.wave(wave);
    }
    // Below the waves, which are to hide it.
    let waves = picture.body.split_off(place);
    if !waves.is_empty() {
        picture.grid(&ticks, top, picture.y + 4.0);
    }
    picture.body.push_str(&waves);
    picture.time(trace.header().cycle_ns, &ticks);
    picture.finish(&trace.header().title)
}

/// Curves of one value a scan each, below each other: a title and its values, over scans of `cycle_ns`. All are drawn
/// in one range, so that they can be compared.
#[must_use]
pub fn chart(title: &str, cycle_ns: u64, curves: &[(String, Vec<f64>)]) -> String {
    let scans = curves.iter().map(|(_, values)| values.len()).max().unwrap_or(0);
    let mut picture = Picture {
        body: String::new(),
        y: GAP,
        scans,
    };
    let ticks = ticks(scans);
    let all = || curves.iter().flat_map(|(_, values)| values).copied();
    let range = Range::of(all().fold(0.0, f64::min), all().fold(0.0, f64::max));
    for (title, values) in curves {
        picture.line_of(title, values, &range, &[], &ticks);
    }
    picture.time(cycle_ns, &ticks);
    picture.finish(title)
}

/// A picture that grows downwards.
struct Picture {
    body: String,
    /// Where the next panel begins.
    y: f64,
    scans: usize,
}

impl Picture {
    /// Where a scan is, the number of scans being the right end.
    fn x(&self, scan: usize) -> f64 {
        GUTTER + (WIDTH - MARGIN - GUTTER) * (scan as f64 / self.scans.max(1) as f64)
    }

    fn line(&mut self, class: &str, path: &str) {
        // Writing to a String cannot fail, here and below.
        let _ = writeln!(self.body, "<path class=\"{class}\" d=\"{path}\"/>");
    }

    fn text(&mut self, class: &str, anchor: &str, [x, y]: [f64; 2], text: &str) {
        let text = escaped(text);
        let _ = writeln!(
            self.body,
            "<text class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{text}</text>"
        );
    }

    fn label(&mut self, class: &str, y: f64, text: &str) {
        self.text(class, "end", [GUTTER - 8.0, y], text);
    }

    /// The band of an axis' states, each named where it fits.
    fn states(&mut self, trace: &Trace, axis: &Axis) {
        let Some(column) = trace.column(&format!("{}.State", axis.name)) else {
            return;
        };
        let y = self.y;
        self.label("", y + 0.7 * ROW, &format!("{}.State", axis.name));
        let states: Vec<Cell<'_>> = trace.cells(column).collect();
        let mut first = 0;
        for run in states.chunk_by(|one, other| one == other) {
            let [left, right] = [first, first + run.len()].map(|scan| self.x(scan));
            let _ = writeln!(
                self.body,
                "<rect x=\"{left:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{ROW}\"/>",
                right - left
            );
            if let Some(Cell::Name(name)) = run.first()
                && CHARACTER * name.len() as f64 <= right - left
            {
                self.text("small", "middle", [0.5 * (left + right), y + 0.7 * ROW], name);
            }
            first += run.len();
        }
        self.y += ROW + GAP;
    }

    fn curve(&mut self, curve: &Curve<'_>, ticks: &[usize]) {
        let range = Range::of(curve.least, curve.greatest);
        self.line_of(&curve.title, &curve.values, &range, &limits(curve), ticks);
    }

    /// A panel with one curve.
    fn line_of(&mut self, title: &str, values: &[f64], range: &Range, limits: &[f64], ticks: &[usize]) {
        let (top, bottom) = (self.y, self.y + CURVE);
        let height = |value: f64| bottom - CURVE * range.part(value);
        self.grid(ticks, top, bottom);
        if range.least < 0.0 && range.greatest > 0.0 {
            let zero = format!("M{GUTTER} {:.1}H{:.1}", height(0.0), WIDTH - MARGIN);
            self.line("frame", &zero);
        }
        for limit in limits.iter().filter(|limit| range.has(**limit)) {
            let y = height(*limit);
            self.line("limit", &format!("M{GUTTER} {y:.1}H{:.1}", WIDTH - MARGIN));
        }
        let points: Vec<[f64; 2]> = (0..)
            .map(|scan| self.x(scan))
            .zip(values.iter().map(|value| height(*value)))
            .map(|(x, y)| [x, y])
            .collect();
        for part in points
            .split(|[_, y]| !y.is_finite())
            .filter(|part| !part.is_empty())
        {
            self.line("curve", &path(part));
        }
        self.label("", top + 0.5 * CURVE, title);
        for value in [range.greatest, range.least] {
            let y = height(value).clamp(top + 6.0, bottom - 2.0) + 3.0;
            if (y - top - 0.5 * CURVE).abs() > 12.0 {
                self.label("small unit", y, &compact(value));
            }
        }
        self.y = bottom + GAP;
    }

    /// Vertical lines at the ticks, and a frame.
    fn grid(&mut self, ticks: &[usize], top: f64, bottom: f64) {
        let path: String = ticks
            .iter()
            .map(|tick| format!("M{:.1} {top:.1}V{bottom:.1}", self.x(*tick)))
            .collect();
        self.line("grid", &path);
        let right = WIDTH - MARGIN;
        self.line("frame", &format!("M{GUTTER} {top:.1}V{bottom:.1}H{right:.1}"));
    }

    fn wave(&mut self, wave: &Wave) {
        let low = self.y + 0.8 * ROW;
        let height = |level: bool| if level { low - LEVEL } else { low };
        let mut path = String::new();
        let mut level = wave.levels.first().copied().unwrap_or_default();
        let _ = write!(path, "M{:.1} {:.1}", self.x(0), height(level));
        for (scan, next) in wave.levels.iter().enumerate() {
            if *next != level {
                let _ = write!(path, "H{:.1}V{:.1}", self.x(scan), height(*next));
                level = *next;
            }
        }
        let _ = write!(path, "H{:.1}", self.x(self.scans));
        let class = match wave.role {
            Role::Variable | Role::Input => "in",
            Role::AxisState | Role::AxisValue | Role::InOut | Role::Output => "out",
        };
        self.line(class, &path);
        self.label("", low - 1.0, &wave.name);
        self.y += ROW;
    }

    /// All of it, below a title that readers of pages are told.
    fn finish(self, title: &str) -> String {
        let height = self.y + GAP;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH:.0} {height:.0}\" font-family=\"sans-serif\" \
             font-size=\"12\">\n<title>{}</title>\n{STYLE}{}</svg>\n",
            escaped(title),
            self.body
        )
    }

    /// The time axis.
    fn time(&mut self, cycle_ns: u64, ticks: &[usize]) {
        let bottom = self.y + 4.0;
        for tick in ticks {
            let place = [self.x(*tick), bottom + 12.0];
            self.text("small", "middle", place, &tick.to_string());
        }
        let cycle = time_literal(cycle_ns);
        self.label("small unit", bottom + 12.0, &format!("scan of {cycle}"));
        self.y = bottom + 12.0;
    }
}

/// What a curve is drawn in: its values, with some room around them.
struct Range {
    least: f64,
    greatest: f64,
    low: f64,
    high: f64,
}

impl Range {
    fn of(least: f64, greatest: f64) -> Self {
        // Halved first, so that no difference of finite numbers overflows.
        let room = match 0.15 * (0.5 * greatest - 0.5 * least) {
            0.0 => 1.0_f64.max(0.5 * greatest.abs()),
            room => room,
        };
        Self {
            least,
            greatest,
            low: least - room,
            high: greatest + room,
        }
    }

    fn has(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// 0 at the bottom, 1 at the top.
    fn part(&self, value: f64) -> f64 {
        (0.5 * value - 0.5 * self.low) / (0.5 * self.high - 0.5 * self.low)
    }
}

/// What the curve must stay within.
fn limits(curve: &Curve<'_>) -> Vec<f64> {
    let limits = &curve.axis.limits;
    let both = |bound: Option<f64>| bound.into_iter().flat_map(|bound| [-bound, bound]).collect();
    match curve.signal {
        "Position" | "ActualPosition" => [limits.position_min, limits.position_max]
            .into_iter()
            .flatten()
            .collect(),
        "Velocity" => both(limits.velocity),
        "Acceleration" => both(limits.acceleration),
        "Jerk" => both(limits.jerk),
        "Snap" => both(limits.snap),
        _ => Vec::new(),
    }
}

/// Scans at round numbers.
fn ticks(scans: usize) -> Vec<usize> {
    let step = (0..)
        .map_while(|exponent| 10_usize.checked_pow(exponent))
        .flat_map(|ten| [1, 2, 5].map(|factor| ten.saturating_mul(factor)))
        .find(|step| *step as f64 * TICKS >= scans as f64)
        .unwrap_or(usize::MAX);
    (0..=scans).step_by(step).collect()
}

/// A line through the points, without those that a reader cannot tell from the line between the others.
fn path(points: &[[f64; 2]]) -> String {
    let mut text = String::new();
    let mut points = points.iter().copied();
    let Some(mut from) = points.next() else {
        return text;
    };
    let _ = write!(text, "M{:.1} {:.1}", from[0], from[1]);
    let (mut last, mut slopes) = (from, f64::NEG_INFINITY..=f64::INFINITY);
    for [x, y] in points {
        let slope = |y: f64, from: [f64; 2]| (y - from[1]) / (x - from[0]);
        if !slopes.contains(&slope(y, from)) {
            let _ = write!(text, "L{:.1} {:.1}", last[0], last[1]);
            from = last;
            slopes = f64::NEG_INFINITY..=f64::INFINITY;
        }
        let (low, high) = (slope(y - NEAR, from), slope(y + NEAR, from));
        slopes = slopes.start().max(low)..=slopes.end().min(high);
        last = [x, y];
    }
    if last != from {
        let _ = write!(text, "L{:.1} {:.1}", last[0], last[1]);
    }
    text
}

fn subject(name: &str) -> &str {
    name.split('.').next().unwrap_or(name)
}

/// Text as XML has it; control characters, which XML has not, are left out.
fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for character in text.chars().filter(|character| !character.is_control()) {
        match character {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            _ => escaped.push(character),
        }
    }
    escaped
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::header::{Header, Input, Limits};

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
        assert!(picture.contains("<title>&lt;img onerror=&quot;x&quot;&gt; &amp; </title>"));
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

//! The drawing itself: panels below each other on one scale of scans.

use std::fmt::Write;

use super::range::{Range, limits, path};
use crate::markup::escaped;
use crate::panels::{Curve, Wave, compact};
use standstill_trace::{Axis, Cell, Role, Trace, cell_text, same, time_literal};

/// Width of the picture.
pub const WIDTH: f64 = 880.0;

/// Room for labels left of the curves.
pub const GUTTER: f64 = 190.0;

/// Room right of the curves, for half a tick label.
const MARGIN: f64 = 30.0;

/// The right end of the curves.
pub const RIGHT: f64 = WIDTH - MARGIN;

/// Height of a curve.
pub const CURVE: f64 = 84.0;

/// Height of a band of states, and of the row of a Boolean.
pub const ROW: f64 = 18.0;

/// Height of a Boolean that is TRUE.
const LEVEL: f64 = 11.0;

/// Distance from one panel to the next.
pub const GAP: f64 = 14.0;

/// Width of a character of a label, to decide whether it fits into a band.
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

/// Largest number of letters of a note on a line.
const NOTE: usize = 120;

/// A text as lines of a limited number of letters; a word that is longer is cut.
pub fn wrapped(text: &str, letters: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= letters => {
                line.push(' ');
                line.push_str(word);
            }
            _ if word.chars().count() <= letters => lines.push(word.to_owned()),
            _ => {
                let cut = word.chars().take(letters.saturating_sub(1));
                lines.push(cut.chain(['…']).collect());
            }
        }
    }
    lines
}

/// The theme in which a picture is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Theme {
    /// Light, independent of the reader's system.
    Light,
    /// Dark, likewise.
    Dark,
}

/// The begin and the end of the dark colours.
const DARK: [&str; 2] = ["@media (prefers-color-scheme: dark) {", " }\n</style>"];

/// A picture of this module for one theme only: for pages that choose between two files.
#[must_use]
pub fn themed(picture: &str, theme: Theme) -> String {
    let [begin, end] = DARK;
    let mut parts = picture.split(begin);
    let mut text = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let (dark, rest) = part.split_once(end).unwrap_or((part, ""));
        if theme == Theme::Dark {
            text.push_str(dark.trim_start());
        }
        text.push_str("\n</style>");
        text.push_str(rest);
    }
    text
}

/// The class of a line for a variable or a pin.
pub const fn class_of(role: Role) -> &'static str {
    match role {
        Role::Variable | Role::Input => "in",
        Role::AxisState | Role::AxisValue | Role::InOut | Role::Output => "out",
    }
}

/// A cell for a box: numbers as labels have them.
fn box_text(cell: Cell<'_>) -> String {
    match cell {
        Cell::Real(value) => compact(value),
        other => cell_text(other),
    }
}

/// A picture that grows downwards.
pub struct Picture {
    pub body: String,
    /// Position of the next panel.
    pub y: f64,
    pub scans: usize,
}

impl Picture {
    /// An empty one, over a number of scans.
    pub const fn new(scans: usize) -> Self {
        Self {
            body: String::new(),
            y: GAP,
            scans,
        }
    }

    /// The place of a scan; the number of scans is the right end.
    pub fn x(&self, scan: usize) -> f64 {
        GUTTER + (RIGHT - GUTTER) * (scan as f64 / self.scans.max(1) as f64)
    }

    pub fn line(&mut self, class: &str, path: &str) {
        // Writing to a String cannot fail, here and below.
        let _ = writeln!(self.body, "<path class=\"{class}\" d=\"{path}\"/>");
    }

    pub fn text(&mut self, class: &str, anchor: &str, [x, y]: [f64; 2], text: &str) {
        let text = escaped(text);
        let _ = writeln!(
            self.body,
            "<text class=\"{class}\" x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\">{text}</text>"
        );
    }

    pub fn label(&mut self, class: &str, y: f64, text: &str) {
        self.text(class, "end", [GUTTER - 8.0, y], text);
    }

    /// The band of an axis' states, with names if they fit.
    pub fn states(&mut self, trace: &Trace, axis: &Axis) {
        let name = format!("{}.State", axis.name);
        if let Some(column) = trace.column(&name) {
            self.label("", self.y + 0.7 * ROW, &name);
            self.boxes(trace.cells(column), ROW);
            self.y += ROW + GAP;
        }
    }

    /// A box for every stretch of equal cells, with its text if that fits.
    pub fn boxes<'t>(&mut self, cells: impl Iterator<Item = Cell<'t>>, row: f64) {
        let y = self.y;
        let cells: Vec<Cell<'_>> = cells.collect();
        let mut first = 0;
        for run in cells.chunk_by(|one, other| same(*one, *other)) {
            let [left, right] = [first, first + run.len()].map(|scan| self.x(scan));
            let _ = writeln!(
                self.body,
                "<rect x=\"{left:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{row}\"/>",
                right - left
            );
            if let Some(text) = run.first().map(|cell| box_text(*cell))
                && CHARACTER * text.len() as f64 <= right - left
            {
                self.text("small", "middle", [0.5 * (left + right), y + 0.7 * row], &text);
            }
            first += run.len();
        }
    }

    pub fn curve(&mut self, curve: &Curve<'_>, ticks: &[usize]) {
        let range = Range::of(curve.least, curve.greatest);
        self.line_of(&curve.title, &curve.values, &range, &limits(curve), ticks);
    }

    /// A panel with one curve.
    pub fn line_of(&mut self, title: &str, values: &[f64], range: &Range, limits: &[f64], ticks: &[usize]) {
        let (top, bottom) = (self.y, self.y + CURVE);
        let height = |value: f64| bottom - CURVE * range.part(value);
        self.panel(&self.places(ticks), range, limits);
        self.trail("curve", values, height);
        self.label("", top + 0.5 * CURVE, title);
        for value in [range.greatest, range.least] {
            let y = height(value).clamp(top + 6.0, bottom - 2.0) + 3.0;
            if (y - top - 0.5 * CURVE).abs() > 12.0 {
                self.label("small unit", y, &compact(value));
            }
        }
        self.y = bottom + GAP;
    }

    /// A line through values, broken where they are not finite.
    pub fn trail(&mut self, class: &str, values: &[f64], height: impl Fn(f64) -> f64) {
        let points = values.iter().enumerate();
        let points: Vec<[f64; 2]> = points
            .map(|(scan, value)| [self.x(scan), height(*value)])
            .collect();
        for part in points
            .split(|[_, y]| !y.is_finite())
            .filter(|part| !part.is_empty())
        {
            self.line(class, &path(part));
        }
    }

    /// The background of a curve: a grid, a line at 0, and limits near the curve.
    pub fn panel(&mut self, places: &[f64], range: &Range, limits: &[f64]) {
        let bottom = self.y + CURVE;
        let across = |value: f64| {
            let y = bottom - CURVE * range.part(value);
            format!("M{GUTTER} {y:.1}H{RIGHT:.1}")
        };
        self.grid(places, self.y, bottom);
        if range.least < 0.0 && range.greatest > 0.0 {
            self.line("frame", &across(0.0));
        }
        for limit in limits.iter().filter(|limit| range.has(**limit)) {
            self.line("limit", &across(*limit));
        }
    }

    fn places(&self, ticks: &[usize]) -> Vec<f64> {
        ticks.iter().map(|tick| self.x(*tick)).collect()
    }

    /// Vertical lines at these places, and a frame.
    fn grid(&mut self, places: &[f64], top: f64, bottom: f64) {
        let lines = places.iter().map(|x| format!("M{x:.1} {top:.1}V{bottom:.1}"));
        self.line("grid", &lines.collect::<String>());
        self.line("frame", &format!("M{GUTTER} {top:.1}V{bottom:.1}H{RIGHT:.1}"));
    }

    /// The drawing of `rows`, with a grid below it, which it hides.
    pub fn over_grid(&mut self, ticks: &[usize], rows: impl FnOnce(&mut Self)) {
        let (top, place) = (self.y, self.body.len());
        rows(self);
        let rows = self.body.split_off(place);
        if !rows.is_empty() {
            self.grid(&self.places(ticks), top, self.y + 4.0);
        }
        self.body.push_str(&rows);
    }

    pub fn wave(&mut self, wave: &Wave) {
        self.wave_of(class_of(wave.role), wave);
        self.label("", self.y - 0.2 * ROW - 1.0, &wave.name);
    }

    /// The line of a Boolean without its name.
    pub fn wave_of(&mut self, class: &str, wave: &Wave) {
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
        self.line(class, &path);
        self.y += ROW;
    }

    /// A box across the picture with a text in it.
    pub fn note(&mut self, class: &str, text: &str) {
        let lines = wrapped(text, NOTE);
        let (top, height) = (self.y, 16.0 * lines.len() as f64 + 8.0);
        let _ = writeln!(
            self.body,
            "<rect class=\"{class}\" x=\"{GAP:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{height:.1}\" rx=\"4\"/>",
            WIDTH - 2.0 * GAP
        );
        for (line, at) in lines.iter().zip(0..) {
            let y = top + 16.0 * (f64::from(at) + 1.0);
            self.text("", "start", [GAP + 8.0, y], line);
        }
        self.y = top + height + GAP;
    }

    /// The whole picture, below a title for screen readers.
    pub fn finish(self, title: &str) -> String {
        let height = self.y + GAP;
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {WIDTH:.0} {height:.0}\" font-family=\"sans-serif\" \
             font-size=\"12\">\n<title>{}</title>\n{STYLE}{}</svg>\n",
            escaped(title),
            self.body
        )
    }

    /// The time axis.
    pub fn time(&mut self, cycle_ns: u64, ticks: &[usize]) {
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

//! Curves below each other over an axis other than scans: times, or positions of a master.

use super::picture::{CURVE, GAP, GUTTER, Picture, RIGHT};
use super::range::{Range, path, ticks};
use crate::panels::compact;

/// Largest number of numbers on the axis.
const TICKS_MOST: usize = 24;

/// A curve.
pub struct Line {
    /// The class of its colour.
    pub class: String,
    /// Its points; those that are not finite are left out.
    pub points: Vec<[f64; 2]>,
}

/// One of the curves' panels.
pub struct Panel<'a> {
    /// Name and unit.
    pub title: &'a str,
    /// Its lines.
    pub lines: &'a [Line],
    /// Values that are dashed if a line comes near.
    pub limits: &'a [f64],
    /// Points to be marked.
    pub marks: &'a [[f64; 2]],
    /// Whether 0 is in its range.
    pub with_zero: bool,
}

/// Panels over one axis.
pub struct Panels {
    pub picture: Picture,
    begin: f64,
    end: f64,
    ticks: Vec<f64>,
}

impl Panels {
    pub fn new(picture: Picture, (begin, end): (f64, f64)) -> Self {
        Self {
            picture,
            begin,
            end,
            ticks: round_between(begin, end),
        }
    }

    pub fn x(&self, place: f64) -> f64 {
        let (way, whole) = (place - self.begin, self.end - self.begin);
        GUTTER + (RIGHT - GUTTER) * if whole > 0.0 { way / whole } else { 0.0 }
    }

    /// Draws a panel. Draws nothing if 0 must be in its range and no line leaves 0.
    pub fn draw(&mut self, panel: &Panel<'_>) {
        let Panel {
            title,
            lines,
            limits,
            marks,
            with_zero,
        } = panel;
        let all = || {
            lines
                .iter()
                .flat_map(|line| &line.points)
                .map(|[_, value]| *value)
        };
        let zero = with_zero.then_some(0.0);
        let values = || all().filter(|value| value.is_finite()).chain(zero);
        let (least, greatest) = (values().reduce(f64::min), values().reduce(f64::max));
        let (Some(least), Some(greatest)) = (least, greatest) else {
            return;
        };
        if least == greatest && *with_zero {
            return;
        }
        let (top, bottom) = (self.picture.y, self.picture.y + CURVE);
        let range = Range::of(least, greatest);
        let height = |value: f64| bottom - CURVE * range.part(value);
        let places: Vec<f64> = self.ticks.iter().map(|tick| self.x(*tick)).collect();
        self.picture.panel(&places, &range, limits);
        for line in *lines {
            let points = line.points.iter().filter(|[_, value]| value.is_finite());
            let points: Vec<[f64; 2]> = points
                .map(|[place, value]| [self.x(*place), height(*value)])
                .collect();
            self.picture.line(&line.class, &path(&points));
        }
        self.picture.label("", top + 0.5 * CURVE, title);
        let largest = greatest.abs().max(least.abs());
        for value in [greatest, least] {
            let y = height(value).clamp(top + 6.0, bottom - 2.0) + 3.0;
            self.picture.label("small unit", y, &told(value, largest));
        }
        for [place, value] in *marks {
            let (x, y) = (self.x(*place), height(*value));
            self.picture.line(
                "mark",
                &format!("M{:.1} {y:.1}a2.5 2.5 0 1 0 5 0a2.5 2.5 0 1 0 -5 0", x - 2.5),
            );
        }
        self.picture.y = bottom + GAP;
    }

    /// The whole picture, above the numbers of the axis and their title.
    pub fn finish(mut self, title: &str, across: &str) -> String {
        let y = self.picture.y + 4.0;
        for tick in std::mem::take(&mut self.ticks) {
            let place = [self.x(tick), y];
            self.picture.text("small", "middle", place, &compact(tick));
        }
        self.picture.label("small unit", y, across);
        self.picture.y = y;
        self.picture.finish(title)
    }
}

/// A value for a label. A value that six decimals hardly show gets a power of ten, unless it is rounding
/// relative to the `largest`.
fn told(value: f64, largest: f64) -> String {
    if (1e-9 * largest..1e-3).contains(&value.abs()) && value != 0.0 {
        format!("{value:.3e}")
    } else {
        compact(value)
    }
}

/// Round numbers from one to the other.
fn round_between(begin: f64, end: f64) -> Vec<f64> {
    let whole = end - begin;
    // A power of ten with at least a hundred thousand steps over the range.
    let mut scale = 1.0;
    while whole / scale > 1e6 && scale < 1e300 {
        scale *= 10.0;
    }
    while whole / scale < 1e5 && scale > 1e-300 {
        scale /= 10.0;
    }
    let steps = (whole / scale).min(1e7) as usize;
    let step = ticks(steps).get(1).copied().unwrap_or(1) as f64;
    let first = (begin / scale / step).ceil();
    (0..TICKS_MOST)
        .map(|tick| (first + tick as f64) * step)
        .take_while(|number| *number <= (end / scale).min(begin / scale + 1e7))
        .map(|number| number * scale)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_on_the_axis_are_round_wherever_it_begins() {
        let told = |begin, end| {
            round_between(begin, end)
                .into_iter()
                .map(compact)
                .collect::<Vec<_>>()
        };
        assert_eq!(told(0.0, 1.9), ["0", "0.5", "1", "1.5"]);
        assert_eq!(told(-90.0, 280.0), ["-50", "0", "50", "100", "150", "200", "250"]);
        assert_eq!(told(0.0, 0.0), ["0"]);
    }
}

//! Curves and edges for a terminal.

use std::fmt::Write;
use std::ops::Range;

use crate::panels::{Curve, compact, curves, waves};
use standstill_trace::Trace;
use standstill_trace::time_literal;

/// Lines of a curve.
const HEIGHT: usize = 10;

/// The least width of a curve (characters).
const WIDTH_MIN: usize = 20;

/// A character of Braille is this many dots wide and high.
const DOTS: (usize, usize) = (2, 4);

/// Position and velocity of every axis as curves, and below them the Booleans that change, drawn high and
/// low: `▔` TRUE, `▁` FALSE, `│` both within one character, so that every pulse shows. Lines are at most
/// `width` characters wide, if that leaves room for a curve.
#[must_use]
pub fn plot(trace: &Trace, width: usize) -> String {
    let curves: Vec<Curve> = curves(trace, &["Position", "Velocity"]);
    let waves = waves(trace);
    let labels = curves
        .iter()
        .flat_map(|curve| [compact(curve.least), compact(curve.greatest)]);
    let labels = labels.chain(waves.iter().map(|wave| wave.name.clone()));
    let gutter = labels.map(|label| label.chars().count()).max().unwrap_or(0);
    let width = width.saturating_sub(gutter + 1).max(WIDTH_MIN);
    let mut text = String::new();
    for curve in &curves {
        draw_curve(&mut text, curve, gutter, width);
    }
    for wave in &waves {
        // Writing to a String cannot fail, here and below.
        let _ = writeln!(text, "{:>gutter$} {}", wave.name, edges(&wave.levels, width));
    }
    let last = trace.scans().saturating_sub(1);
    let end = format!("scan {last}, {}", time_literal(trace.time_ns(last)));
    let room = width.saturating_sub("scan 0".len());
    let _ = writeln!(text, "{:>gutter$} scan 0{end:>room$}", "");
    text
}

fn draw_curve(text: &mut String, curve: &Curve, gutter: usize, width: usize) {
    let Curve {
        title,
        values,
        least,
        greatest,
        ..
    } = curve;
    if least == greatest {
        let _ = writeln!(text, "{title}: {} throughout\n", compact(*least));
        return;
    }
    let rows = canvas(curve, values, width);
    let zero = (*least < 0.0 && *greatest > 0.0).then(|| height_of(curve, 0.0) / DOTS.1);
    let _ = writeln!(text, "{title}");
    for (row, line) in rows.iter().enumerate() {
        let label = match row {
            0 => compact(*greatest),
            _ if row + 1 == HEIGHT => compact(*least),
            _ if Some(row) == zero => "0".to_owned(),
            _ => String::new(),
        };
        let line: String = line.iter().map(|dots| braille(*dots)).collect();
        let _ = writeln!(text, "{label:>gutter$} {}", line.trim_end_matches(braille(0)));
    }
    text.push('\n');
}

/// The dots of a curve, one byte a character. Each column of dots shows all values of its scans and is
/// joined to the column before it.
fn canvas(curve: &Curve, values: &[f64], width: usize) -> Vec<Vec<u8>> {
    let mut rows = vec![vec![0_u8; width]; HEIGHT];
    let mut before = None;
    for x in 0..width * DOTS.0 {
        let scans = share(values.len(), x, width * DOTS.0);
        let heights = values
            .get(scans)
            .unwrap_or_default()
            .iter()
            .filter(|value| value.is_finite());
        let heights: Vec<usize> = heights.map(|value| height_of(curve, *value)).collect();
        let joined = heights.iter().copied().chain(before);
        let (Some(top), Some(bottom)) = (joined.clone().min(), joined.max()) else {
            continue;
        };
        for y in top..=bottom {
            if let Some(dots) = rows.get_mut(y / DOTS.1).and_then(|row| row.get_mut(x / DOTS.0)) {
                *dots |= dot(x % DOTS.0, y % DOTS.1);
            }
        }
        before = heights.last().copied();
    }
    rows
}

/// The row of dots of a value, 0 at the top.
fn height_of(curve: &Curve, value: f64) -> usize {
    let steps = (HEIGHT * DOTS.1 - 1) as f64;
    // Halved first, so that no difference of finite numbers overflows.
    let span = curve.greatest / 2.0 - curve.least / 2.0;
    let part = (curve.greatest / 2.0 - value / 2.0) / span;
    (part * steps).round().clamp(0.0, steps) as usize
}

/// The scans of column `x` of `columns`: at least one, and together all of them.
fn share(scans: usize, x: usize, columns: usize) -> Range<usize> {
    let first = x * scans / columns;
    let end = (x + 1) * scans / columns;
    first..end.max(first + 1).min(scans)
}

/// The bit of a dot in a Braille character (Unicode numbers the lowest row last).
const fn dot(x: usize, y: usize) -> u8 {
    match (x, y) {
        (0, 0) => 0x01,
        (0, 1) => 0x02,
        (0, 2) => 0x04,
        (0, _) => 0x40,
        (_, 0) => 0x08,
        (_, 1) => 0x10,
        (_, 2) => 0x20,
        (_, _) => 0x80,
    }
}

fn braille(dots: u8) -> char {
    char::from_u32(0x2800 + u32::from(dots)).unwrap_or(' ')
}

fn edges(levels: &[bool], width: usize) -> String {
    (0..width)
        .map(|x| {
            let share = levels.get(share(levels.len(), x, width)).unwrap_or_default();
            match (share.contains(&true), share.contains(&false)) {
                (true, false) => '▔',
                (true, true) => '│',
                (false, _) => '▁',
            }
        })
        .collect()
}

//! The extremes of an axis, and the part of its limits that it used.

use std::fmt::Write;

use crate::column::{Cell, Kind};
use crate::header::Axis;
use crate::number::{fixed, shortest};
use crate::trace::Trace;

/// The extreme of one quantity of an axis over a whole trace.
#[derive(Clone, Debug, PartialEq)]
pub struct Extreme {
    /// The axis.
    pub axis: String,
    /// The quantity: `least position`, `greatest position`, or a magnitude: `velocity`, `acceleration`,
    /// `deceleration`, `jerk`, `snap`.
    pub quantity: &'static str,
    /// Its value (u, u/s .. u/s^4); NaN if one occurred.
    pub value: f64,
    /// The first scan that reached it.
    pub scan: usize,
    /// The axis limit, if there is one.
    pub limit: Option<f64>,
}

/// The extremes of every axis in order. `deceleration` is separate from `acceleration` if their limits
/// differ. Missing signals are left out.
#[must_use]
pub fn extremes(trace: &Trace) -> Vec<Extreme> {
    let mut found = Extremes::new(trace);
    found.look(trace);
    found.all().collect()
}

/// The extremes as aligned lines, one block per axis.
#[must_use]
pub fn extremes_text(trace: &Trace) -> String {
    let mut found = Extremes::new(trace);
    found.look(trace);
    found.text()
}

/// The extremes of a trace that grows and may forget rows that were read.
#[derive(Clone, Debug)]
pub struct Extremes {
    /// Number of scans that were read.
    scans: usize,
    axes: Vec<OfAxis>,
}

impl Extremes {
    /// The extremes before the first row.
    #[must_use]
    pub fn new(trace: &Trace) -> Self {
        let axes = trace.header().axes.iter();
        Self {
            scans: 0,
            axes: axes.map(|axis| OfAxis::new(trace, axis)).collect(),
        }
    }

    /// The same without the least and the greatest positions.
    #[must_use]
    pub fn of_derivatives(trace: &Trace) -> Self {
        let mut extremes = Self::new(trace);
        extremes.axes.iter_mut().for_each(|axis| axis.columns[0] = None);
        extremes
    }

    /// Reads the rows that the trace has received since the last call.
    pub fn look(&mut self, trace: &Trace) {
        for axis in &mut self.axes {
            axis.look(trace, self.scans);
        }
        self.scans = trace.scans();
    }

    /// The result of [`extremes`] for the rows so far.
    pub fn all(&self) -> impl Iterator<Item = Extreme> + '_ {
        self.axes.iter().flat_map(OfAxis::all)
    }

    /// The extreme so far of a quantity ([`Extreme::quantity`]) of an axis, and its limit. `axis` is the index in
    /// the header.
    #[must_use]
    pub fn of(&self, axis: usize, quantity: &str) -> Option<(f64, Option<f64>)> {
        let mut found = self.axes.get(axis)?.found();
        let (_, (value, _), limit) = found.find(|(name, ..)| *name == quantity)?;
        Some((value, limit))
    }

    /// The result of [`extremes_text`] for the rows so far.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = String::new();
        for of_axis in &self.axes {
            let axis = &of_axis.axis;
            let unit = if axis.unit.is_empty() {
                String::new()
            } else {
                format!(" ({})", axis.unit)
            };
            // Writing to a String cannot fail, here and below.
            let _ = writeln!(text, "extremes of {}{unit}", axis.name);
            for extreme in of_axis.all() {
                let _ = writeln!(text, "{}", line(&extreme));
            }
        }
        text
    }
}

fn line(extreme: &Extreme) -> String {
    let Extreme {
        quantity,
        value,
        scan,
        limit,
        ..
    } = *extreme;
    let bound = match limit {
        None if quantity.ends_with("position") => String::new(),
        None => "no limit".to_owned(),
        Some(limit) if quantity.ends_with("position") => format!("limit {}", shortest(limit)),
        Some(limit) => format!("{:.2} % of {}", 100.0 * value / limit, shortest(limit)),
    };
    let line = format!("  {quantity:<17} {:>16}  at {scan:<7} {bound}", fixed(value));
    line.trim_end().to_owned()
}

/// The axis and its unit: `X (mm)`.
pub fn axis_title(axis: &Axis) -> String {
    if axis.unit.is_empty() {
        axis.name.clone()
    } else {
        format!("{} ({})", axis.name, axis.unit)
    }
}

/// The extremes of one axis so far.
#[derive(Clone, Debug)]
struct OfAxis {
    axis: Axis,
    /// Columns of position, velocity, acceleration, jerk and snap, if they are numbers.
    columns: [Option<usize>; 5],
    least: Peak,
    greatest: Peak,
    velocity: Peak,
    acceleration: Peak,
    /// For falling speed, if it has a limit of its own.
    deceleration: Peak,
    jerk: Peak,
    snap: Peak,
}

impl OfAxis {
    fn new(trace: &Trace, axis: &Axis) -> Self {
        let column = |name: &str| {
            let at = trace.column(&[&axis.name, ".", name].concat())?;
            (trace.columns().get(at)?.kind == Kind::Real).then_some(at)
        };
        Self {
            axis: axis.clone(),
            columns: ["Position", "Velocity", "Acceleration", "Jerk", "Snap"].map(column),
            least: Peak::default(),
            greatest: Peak::default(),
            velocity: Peak::default(),
            acceleration: Peak::default(),
            deceleration: Peak::default(),
            jerk: Peak::default(),
            snap: Peak::default(),
        }
    }

    fn has_one_limit(&self) -> bool {
        self.axis.limits.acceleration == self.axis.limits.deceleration
    }

    /// Reads the rows from a scan on.
    fn look(&mut self, trace: &Trace, from: usize) {
        let [position, velocity, acceleration, jerk, snap] = self.columns;
        self.least.look(trace, from, position, |position| -position);
        self.greatest.look(trace, from, position, |position| position);
        self.velocity.look(trace, from, velocity, f64::abs);
        self.jerk.look(trace, from, jerk, f64::abs);
        self.snap.look(trace, from, snap, f64::abs);
        if self.has_one_limit() {
            self.acceleration.look(trace, from, acceleration, f64::abs);
        } else if let (Some(velocity), Some(acceleration)) = (velocity, acceleration) {
            for scan in from.max(trace.first())..trace.scans() {
                let number = |column| match trace.cell(scan, column) {
                    Some(Cell::Real(number)) => number,
                    _ => 0.0,
                };
                let [speeding, slowing] = by_sense(number(velocity), number(acceleration));
                self.acceleration.take(scan, speeding);
                self.deceleration.take(scan, slowing);
            }
        }
    }

    fn all(&self) -> impl Iterator<Item = Extreme> + '_ {
        self.found().map(|(quantity, (value, scan), limit)| Extreme {
            axis: self.axis.name.clone(),
            quantity,
            value,
            scan,
            limit,
        })
    }

    /// Quantities with their extremes, the scans of these, and the limits.
    fn found(&self) -> impl Iterator<Item = (&'static str, (f64, usize), Option<f64>)> + '_ {
        let limits = &self.axis.limits;
        let least = Peak(self.least.0.map(|(value, scan)| (-value, scan)));
        let all = [
            ("least position", least, limits.position_min),
            ("greatest position", self.greatest, limits.position_max),
            ("velocity", self.velocity, limits.velocity),
            ("acceleration", self.acceleration, limits.acceleration),
            ("deceleration", self.deceleration, limits.deceleration),
            ("jerk", self.jerk, limits.jerk),
            ("snap", self.snap, limits.snap),
        ];
        all.into_iter()
            .filter_map(|(quantity, peak, limit)| Some((quantity, peak.0?, limit)))
    }
}

/// The magnitude of an acceleration that speeds up (or starts from rest), and of one that slows down. The other one
/// is 0.
fn by_sense(velocity: f64, acceleration: f64) -> [f64; 2] {
    let slows = (velocity > 0.0 && acceleration < 0.0) || (velocity < 0.0 && acceleration > 0.0);
    let size = acceleration.abs();
    if slows { [0.0, size] } else { [size, 0.0] }
}

/// The greatest value and its first scan. A NaN is greater than all numbers, so that it is not missed.
#[derive(Clone, Copy, Debug, Default)]
struct Peak(Option<(f64, usize)>);

impl Peak {
    /// Reads the numbers of a column from a scan on; `rank` gives their order.
    fn look(&mut self, trace: &Trace, from: usize, column: Option<usize>, rank: impl Fn(f64) -> f64) {
        let numbers = column.and_then(|column| trace.reals_from(column, from));
        let Some((numbers, same)) = numbers else { return };
        let from = from.max(trace.first());
        if let Some(most) = greatest(numbers, &rank).filter(|most| self.is_below(*most)) {
            let is_it = |number: &f64| rank(*number) == most || (most.is_nan() && number.is_nan());
            let place = numbers.iter().position(is_it).unwrap_or_default();
            self.take(from + place, most);
        }
        if let Some(same) = same {
            self.take(from + numbers.len(), rank(same));
        }
    }

    fn take(&mut self, scan: usize, value: f64) {
        if self.is_below(value) {
            self.0 = Some((value, scan));
        }
    }

    fn is_below(&self, value: f64) -> bool {
        let Some((peak, _)) = self.0 else { return true };
        value > peak || (value.is_nan() && !peak.is_nan())
    }
}

/// The greatest rank of some numbers. NaN if there is one, so that it is not missed; none of no numbers.
pub fn greatest(numbers: &[f64], rank: impl Fn(f64) -> f64) -> Option<f64> {
    if numbers
        .iter()
        .fold(false, |found, number| found | number.is_nan())
    {
        return Some(f64::NAN);
    }
    let greater = |one: f64, other: f64| if other > one { other } else { one };
    // Several at once, so that none waits for the one before.
    let mut most = [f64::NEG_INFINITY; 8];
    let (eights, rest) = numbers.as_chunks::<8>();
    for eight in eights {
        for (most, number) in most.iter_mut().zip(eight) {
            *most = greater(*most, rank(*number));
        }
    }
    let all = most.into_iter().chain(rest.iter().map(|number| rank(*number)));
    (!numbers.is_empty()).then(|| all.fold(f64::NEG_INFINITY, greater))
}

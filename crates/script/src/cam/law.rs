//! Rows for the usual laws of rest-to-rest cams.
//!
//! The runtime has no sines, because they differ in a bit between machines. Here, laws with sines become
//! pieces of degree 7 with the law's own derivatives in each row. The result is the same everywhere,
//! because the sines are those of `libm`.

use super::table::law_name;
use standstill_axis::{CamCurve, CamRow};
use std::f64::consts::PI;
use std::fmt::Write;

/// Pieces of a law with sines; those of all laws begin at eighths.
const PIECES: u32 = 8;

/// A value below this share of the largest one is rounding (for example the sine of a whole turn).
const ROUNDING: f64 = 1e-13;

/// A law of VDI 2143, from rest to rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// Modified sine: low torque, jerk steps at the ends.
    ModifiedSine,
    /// Sinoid, also called cycloidal: the acceleration is one sine.
    Sinoid,
    /// 3-4-5 polynomial.
    Poly345,
    /// 4-5-6-7 polynomial: the jerk does not step.
    Poly4567,
    /// Modified acceleration trapezoid: the least acceleration.
    Trapezoid,
}

impl Law {
    /// All of them.
    pub const ALL: [Self; 5] = [
        Self::ModifiedSine,
        Self::Sinoid,
        Self::Poly345,
        Self::Poly4567,
        Self::Trapezoid,
    ];

    /// Its name on the command line.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::ModifiedSine => "modified-sine",
            Self::Sinoid => "sinoid",
            Self::Poly345 => "poly345",
            Self::Poly4567 => "poly4567",
            Self::Trapezoid => "trapezoid",
        }
    }

    /// The first half of a law with sines; the second half is its mirror. None for a polynomial.
    fn half(self) -> &'static [Part] {
        match self {
            Self::Sinoid => const { &[sine(0.5, 2.0 * PI, 0.0)] },
            Self::ModifiedSine => {
                const { &[sine(0.125, 4.0 * PI, 0.0), sine(0.5, 4.0 * PI / 3.0, PI / 3.0)] }
            }
            Self::Trapezoid => {
                const {
                    &[
                        sine(0.125, 4.0 * PI, 0.0),
                        Part {
                            until: 0.375,
                            sine: None,
                        },
                        sine(0.5, 4.0 * PI, -PI),
                    ]
                }
            }
            Self::Poly345 | Self::Poly4567 => &[],
        }
    }
}

/// A part of a law's acceleration, up to a position; the largest acceleration is 1. It is a sine of this frequency
/// and phase, or constantly 1.
struct Part {
    until: f64,
    sine: Option<(f64, f64)>,
}

const fn sine(until: f64, frequency: f64, phase: f64) -> Part {
    Part {
        until,
        sine: Some((frequency, phase)),
    }
}

/// Position and three derivatives.
type At = [f64; 4];

impl Part {
    /// Its value at the distance `way` behind `from`; the law had reached `before` there.
    fn on(&self, from: f64, before: At, way: f64) -> At {
        let [y, v, ..] = before;
        match self.sine {
            None => [y + v * way + 0.5 * way * way, v + way, 1.0, 0.0],
            Some((frequency, phase)) => {
                let (begin, end) = (frequency * from + phase, frequency * (from + way) + phase);
                let [cos_begin, cos_end] = [begin, end].map(libm::cos);
                let [sin_begin, sin_end] = [begin, end].map(libm::sin);
                [
                    y + v * way + cos_begin / frequency * way
                        - (sin_end - sin_begin) / (frequency * frequency),
                    v + (cos_begin - cos_end) / frequency,
                    sin_end,
                    frequency * cos_end,
                ]
            }
        }
    }
}

/// The law at `x` in its first half, with a lift that is not yet scaled to 1.
fn along(half: &[Part], x: f64) -> At {
    let (mut from, mut at) = (0.0, [0.0; 4]);
    for part in half {
        let end = part.until.min(x);
        at = part.on(from, at, end - from);
        from = end;
        if x <= part.until {
            break;
        }
    }
    at
}

/// The begin and the end of a law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lift {
    /// First position of the master (u).
    pub begin: f64,
    /// Travel of the master, above 0 (u).
    pub width: f64,
    /// First position of the slave (y).
    pub from: f64,
    /// Travel of the slave (y), in either direction.
    pub lift: f64,
}

/// The rows of a law.
///
/// # Errors
/// The fault of the lift, with its value and the remedy.
fn rows(law: Law, lift: &Lift) -> Result<Vec<(CamRow, CamCurve)>, String> {
    let Lift {
        begin,
        width,
        from,
        lift: way,
    } = *lift;
    let finite = [("begin", begin), ("width", width), ("from", from), ("lift", way)];
    if let Some((name, value)) = finite.into_iter().find(|(_, value)| !value.is_finite()) {
        return Err(format!("--{name} is {value:?}: write a finite number"));
    }
    if width <= 0.0 {
        return Err(format!(
            "--width is {width:?}: the master goes forwards, write a number above 0"
        ));
    }
    if way == 0.0 {
        return Err("--lift is 0.0: write how far the slave goes, below 0 for the way back".to_owned());
    }
    let rest = |share: f64, shape: CamCurve| {
        let row = CamRow {
            master: begin + share * width,
            slave: from + share * way,
            ..CamRow::default()
        };
        (row, shape)
    };
    let made = match law {
        Law::Poly345 => vec![rest(0.0, CamCurve::Rest5), rest(1.0, CamCurve::Rest7)],
        Law::Poly4567 => vec![rest(0.0, CamCurve::Rest7), rest(1.0, CamCurve::Rest7)],
        Law::ModifiedSine | Law::Sinoid | Law::Trapezoid => {
            let half = law.half();
            let scale = 0.5 / along(half, 0.5)[0];
            (0..=PIECES)
                .map(|piece| {
                    let x = f64::from(piece) / f64::from(PIECES);
                    let is_second = x > 0.5;
                    let [y, v, a, j] =
                        along(half, if is_second { 1.0 - x } else { x }).map(|value| scale * value);
                    let (y, a) = if is_second { (1.0 - y, -a) } else { (y, a) };
                    let exact = |value: f64, per: f64| {
                        if value.abs() < ROUNDING * scale {
                            0.0
                        } else {
                            value * way / per
                        }
                    };
                    let shape = if piece < PIECES {
                        CamCurve::Poly7
                    } else {
                        CamCurve::Rest7
                    };
                    let row = CamRow {
                        master: begin + x * width,
                        slave: from + y * way,
                        slope: exact(v, width),
                        curvature: exact(a, width * width),
                        third: exact(j, width * width * width),
                        ..CamRow::default()
                    };
                    (row, shape)
                })
                .collect()
        }
    };
    let numbers = |row: &CamRow| [row.master, row.slave, row.slope, row.curvature, row.third];
    let rises = made.windows(2).all(|pair| match pair {
        [(one, _), (other, _)] => other.master > one.master,
        _ => true,
    });
    if !rises || !made.iter().flat_map(|(row, _)| numbers(row)).all(f64::is_finite) {
        return Err(format!(
            "--width {width:?} with --lift {way:?} and --begin {begin:?} gives rows that numbers can't tell: write a larger width"
        ));
    }
    Ok(made)
}

/// The rows of a law as a CSV file that `tables` reads.
///
/// # Errors
/// The fault of the lift, with its value and the remedy.
pub fn csv(law: Law, lift: &Lift) -> Result<String, String> {
    let rows = rows(law, lift)?;
    let mut text = format!(
        "# {}, lift {:?} over {:?}\nMaster,Slave,Slope,Curvature,Third,Law\n",
        law.name(),
        lift.lift,
        lift.width
    );
    for (row, shape) in rows {
        let [master, slave, slope, curvature, third] =
            [row.master, row.slave, row.slope, row.curvature, row.third].map(|value| value + 0.0);
        // Writing to a String cannot fail.
        let _ = writeln!(
            text,
            "{master:?},{slave:?},{slope:?},{curvature:?},{third:?},{}",
            law_name(shape)
        );
    }
    Ok(text)
}

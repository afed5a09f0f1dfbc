//! Filters that let a load come to rest without residual vibration (docs/planner.md, section 15).
//!
//! A shaper publishes a mean of past set-points: `sum w_i x(t - d_i)` with weights above 0 that sum to one, at
//! delays of whole scans. Such a mean keeps every bound that the motion itself keeps, of its derivatives and of its
//! positions. It is at the target when its last part is. The weights are chosen such that the vibrations excited by
//! the parts of the mean cancel.

use crate::error::check_positive;
use crate::math::{floor, sqrt};
use crate::{Field, PlanError, Setpoint};
use core::f64::consts::{FRAC_PI_2, TAU};

/// Largest number of modes for which one motion is shaped.
pub const MODES: usize = 2;

/// Longest period of a mode (scans); shortest is [`SHORTEST_PERIOD`].
pub const LONGEST_PERIOD: f64 = 4096.0;

/// Shortest period of a mode (scans): set-points hardly show a faster one.
pub const SHORTEST_PERIOD: f64 = 4.0;

/// Highest damping ratio: with more damping there is no vibration.
pub const DAMPING_MAX: f64 = 0.9;

/// The residual vibration that `ei` leaves of a mode whose frequency is known exactly, as a part of the unshaped
/// one. The usual value is 0.05, for frequencies known to 20 %; this one is for those known to 15 %.
const TOLERATED: f64 = 0.03;

/// A delay this near to a whole number of scans counts as one (scans): 1 / (12.5 Hz * 0.001 s) means 80.
const WHOLE: f64 = 1e-6;

/// How a shaper spreads a motion over the period of a mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShaperKind {
    /// The mean over one period.
    Period,
    /// Two parts, half a period apart: the shortest; for a frequency that is known well.
    Zv,
    /// Three parts over a period, which leave almost no vibration for a small error of the frequency, too.
    Zvd,
    /// Three parts over a period, which leave 3 % at the frequency itself, and no more than that within 15 % of it.
    #[default]
    Ei,
}

impl ShaperKind {
    /// All of them, in the order of their numbers, from 1 on.
    pub const ALL: [Self; 4] = [Self::Period, Self::Zv, Self::Zvd, Self::Ei];

    /// Its name in scripts and on lines of plans.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Period => "period",
            Self::Zv => "zv",
            Self::Zvd => "zvd",
            Self::Ei => "ei",
        }
    }
}

/// A vibration mode of a load, and the shaper against it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VibrationMode {
    /// Frequency without damping (Hz).
    pub frequency: f64,
    /// Damping ratio, from 0 to [`DAMPING_MAX`].
    pub damping: f64,
    /// The shaper.
    pub shaper: ShaperKind,
}

impl VibrationMode {
    /// A mode of this frequency (Hz) without damping, with the shaper `ei`.
    pub const fn new(frequency: f64) -> Self {
        Self {
            frequency,
            damping: 0.0,
            shaper: ShaperKind::Ei,
        }
    }
}

/// A part of the mean: its weight, and its delay.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tap {
    /// Delay (scans), not 0.
    pub delay: u32,
    /// Weight, at least 0.
    pub weight: f64,
}

/// The shaper of one mode at one sample time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shaper {
    form: Form,
    /// The longest delay (scans).
    delay: u32,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Form {
    /// Parts at a few delays; those not needed have weight 0.
    Parts([Tap; 4]),
    /// A part at each delay. The one after the first weighs `second`, each further one `ratio` times the one
    /// before, and the last one in addition `last` times that.
    Every { second: f64, ratio: f64, last: f64 },
}

impl Shaper {
    /// The shaper for `mode` with sample time `cycle` (s).
    ///
    /// Cost: for `period` a product for each scan of it, at most [`LONGEST_PERIOD`].
    ///
    /// # Errors
    /// [`PlanError::InvalidInput`] for a value that is no number or not positive, [`PlanError::OutOfRange`] for a
    /// period that is too short or too long, or too much damping; each names the nearest permitted value.
    pub fn new(mode: &VibrationMode, cycle: f64) -> Result<Self, PlanError> {
        let wave = Wave::new(mode, cycle)?;
        Ok(match mode.shaper {
            ShaperKind::Period => wave.every(),
            ShaperKind::Zv => wave.parts(1.0, &[(0.5, 1.0)]),
            ShaperKind::Zvd => wave.parts(1.0, &[(0.5, 2.0), (1.0, 1.0)]),
            ShaperKind::Ei => {
                let (outer, middle) = (0.25 * (1.0 + TOLERATED), 0.5 * (1.0 - TOLERATED));
                wave.parts(outer, &[(0.5, middle), (1.0, outer)])
            }
        })
    }

    /// Its longest delay (scans), at least 1: the shaped motion ends this much later than the motion itself.
    pub const fn delay(&self) -> u32 {
        self.delay
    }

    /// The delayed parts, in order of their delays, at most one for each scan of [`Shaper::delay`]. The rest of the
    /// weights up to one is that of the part without delay.
    pub fn taps(&self) -> impl Iterator<Item = Tap> + '_ {
        let (parts, second, ratio, last) = match &self.form {
            Form::Parts(parts) => (parts.as_slice(), 0.0, 0.0, 0.0),
            Form::Every { second, ratio, last } => ([].as_slice(), *second, *ratio, *last),
        };
        let every = if parts.is_empty() { self.delay } else { 0 };
        let mut next = second;
        let each = (1..=every).map(move |delay| {
            let weight = if delay == every { next * last } else { next };
            next *= ratio;
            Tap { delay, weight }
        });
        let parts = parts.iter().copied().filter(|tap| tap.weight > 0.0);
        parts.chain(each)
    }

    /// The difference between the mean and `now`. The mean is that of `now` and of the `past`, the motion a number
    /// of scans ago.
    ///
    /// If the motion has had a constant velocity for as long as [`Shaper::delay`], the difference of velocity and
    /// higher derivatives is exactly 0. If it has been at rest, that of the position is, too. Cost: one set-point
    /// for each of [`Shaper::taps`].
    pub fn lag(&self, now: &Setpoint, past: impl Fn(u32) -> Setpoint) -> Setpoint {
        let mut late = Setpoint::default();
        for tap in self.taps() {
            let then = past(tap.delay);
            late.position += tap.weight * (then.position - now.position);
            late.velocity += tap.weight * (then.velocity - now.velocity);
            late.acceleration += tap.weight * (then.acceleration - now.acceleration);
            late.jerk += tap.weight * (then.jerk - now.jerk);
            late.snap += tap.weight * (then.snap - now.snap);
        }
        late
    }
}

/// A mode in scans.
struct Wave {
    /// Its period, with damping.
    period: f64,
    /// The decay of its amplitude in a scan: `exp(-sigma)`.
    sigma: f64,
}

impl Wave {
    fn new(mode: &VibrationMode, cycle: f64) -> Result<Self, PlanError> {
        let (frequency, damping) = (mode.frequency, mode.damping);
        check_positive(Field::Cycle, cycle)?;
        check_positive(Field::Frequency, frequency)?;
        if damping.is_nan() {
            return Err(PlanError::InvalidInput {
                field: Field::Damping,
                value: damping,
            });
        }
        let out_of_range = |field, value, nearest| {
            Err(PlanError::OutOfRange {
                field,
                value,
                nearest,
            })
        };
        if !(0.0..=DAMPING_MAX).contains(&damping) {
            return out_of_range(Field::Damping, damping, damping.clamp(0.0, DAMPING_MAX));
        }
        let slower = sqrt(1.0 - damping * damping);
        let period = 1.0 / (frequency * cycle * slower);
        let fitting = |period: f64| 1.0 / (period * cycle * slower);
        if !(period >= SHORTEST_PERIOD - WHOLE) {
            return out_of_range(Field::Frequency, frequency, fitting(SHORTEST_PERIOD));
        }
        if !(period <= LONGEST_PERIOD + WHOLE) {
            return out_of_range(Field::Frequency, frequency, fitting(LONGEST_PERIOD));
        }
        Ok(Self {
            period,
            sigma: TAU * damping * frequency * cycle,
        })
    }

    /// Parts of these weights, each given with its delay (periods); the first of all has no delay.
    ///
    /// A later part also weighs less, as a damped vibration does. A part that is due between two scans is divided
    /// between them, so that the mode sees it at its time and with its size: with `a` before, `b` after and a share
    /// `f` of a scan between, `a + b exp(-p) = exp(-p f)` for the pole `p` of the mode.
    fn parts(&self, first: f64, later: &[(f64, f64)]) -> Shaper {
        let angle = TAU / self.period;
        let mut taps = [Tap::default(); 4];
        for (pair, (periods, weight)) in taps.chunks_exact_mut(2).zip(later) {
            let (scan, share) = self.place(periods * self.period);
            let sines = [
                sine(angle * (1.0 - share)) / sine(angle),
                sine(angle * share) / sine(angle),
            ];
            for ((tap, delay), part) in pair.iter_mut().zip([scan, scan + 1]).zip(sines) {
                let fallen = decay(self.sigma * f64::from(delay));
                *tap = Tap {
                    delay,
                    weight: weight * fallen * part,
                };
            }
        }
        let all = taps.iter().fold(first, |sum, tap| sum + tap.weight);
        for tap in &mut taps {
            tap.weight /= all;
        }
        let late = taps.iter().filter(|tap| tap.weight > 0.0);
        let delay = late.map(|tap| tap.delay).max().unwrap_or(1);
        Shaper {
            form: Form::Parts(taps),
            delay,
        }
    }

    /// A part for each scan of a period, and for the last one the share that belongs to it.
    fn every(&self) -> Shaper {
        let (whole, share) = self.place(self.period);
        let ratio = decay(self.sigma);
        let (delay, last) = if share > 0.0 {
            (whole, share)
        } else {
            (whole.saturating_sub(1), 1.0)
        };
        let (mut all, mut weight) = (1.0, 1.0);
        for scan in 1..=delay {
            weight *= ratio;
            all += if scan == delay { weight * last } else { weight };
        }
        let second = ratio / all;
        Shaper {
            form: Form::Every { second, ratio, last },
            delay,
        }
    }

    /// A delay as whole scans and the remaining share of one.
    fn place(&self, delay: f64) -> (u32, f64) {
        let nearest = floor(delay + 0.5);
        if (delay - nearest).abs() <= WHOLE {
            return (nearest as u32, 0.0);
        }
        let whole = floor(delay);
        (whole as u32, delay - whole)
    }
}

/// `exp(-x)` for x from 0, within 1e-12 of itself down to 1e-300: the series for a 1024th of `x`, squared ten times.
fn decay(x: f64) -> f64 {
    let part = x / 1024.0;
    let series = (1..=8).rev().fold(1.0, |sum, n| 1.0 - sum * part / f64::from(n));
    (0..10).fold(series, |power, _| power * power)
}

/// `sin x` for x from 0 to a right angle, within 1e-15: the series to the 21st power.
fn sine(x: f64) -> f64 {
    debug_assert!((0.0..=FRAC_PI_2 + WHOLE).contains(&x), "sine of {x}");
    let square = x * x;
    let terms = (1..=10).rev();
    x * terms.fold(1.0, |sum, n| 1.0 - sum * square / f64::from(2 * n * (2 * n + 1)))
}

/// The shapers of all modes of a motion, one after the other.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shapers([Option<Shaper>; MODES]);

impl Shapers {
    /// The shapers for `modes` with sample time `cycle` (s); those that are `None` change nothing.
    ///
    /// # Errors
    /// The index of the mode, and the error of [`Shaper::new`].
    pub fn new(modes: &[Option<VibrationMode>; MODES], cycle: f64) -> Result<Self, (usize, PlanError)> {
        let mut shapers = Self::default();
        for (place, (shaper, mode)) in shapers.0.iter_mut().zip(modes).enumerate() {
            *shaper = match mode {
                Some(mode) => Some(Shaper::new(mode, cycle).map_err(|error| (place, error))?),
                None => None,
            };
        }
        Ok(shapers)
    }

    /// The shapers in the order in which they apply.
    pub fn iter(&self) -> impl Iterator<Item = &Shaper> {
        self.0.iter().flatten()
    }

    /// The sum of their delays (scans).
    pub fn delay(&self) -> u32 {
        self.iter().map(Shaper::delay).sum()
    }

    /// Scans until a shaped motion of `scans` scans is at its target; 0 if there is nothing to do.
    pub fn scans(&self, scans: u32) -> u32 {
        match scans {
            0 => 0,
            scans => scans.saturating_add(self.delay()),
        }
    }

    /// Set-point `scan` of a shaped motion from rest to rest. `plan` returns the set-points of the motion, from 0,
    /// the start, on. From [`Shapers::scans`] on it is exactly the target.
    ///
    /// Cost: the product of the numbers of [`Shaper::taps`], each one set-point of the plan.
    pub fn at(&self, scan: u64, plan: impl Fn(u64) -> Setpoint) -> Setpoint {
        let since = |scan: u64, delay: u32| scan.saturating_sub(delay.into());
        let [first, second] = &self.0;
        let lag = |scan: u64| {
            let lag = |shaper: &Shaper| shaper.lag(&plan(scan), |delay| plan(since(scan, delay)));
            first.as_ref().map_or(Setpoint::default(), lag)
        };
        let once = |scan: u64| plan(scan).plus(&lag(scan));
        let lag_of_second = |shaper: &Shaper| shaper.lag(&once(scan), |delay| once(since(scan, delay)));
        let second = second.as_ref().map_or(Setpoint::default(), lag_of_second);
        plan(scan).plus(&lag(scan).plus(&second))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    // The library is the reference.
    #[allow(clippy::disallowed_methods)]
    #[test]
    fn decay_and_sine_are_those_of_the_library() {
        for step in 0..=2000 {
            let x = f64::from(step) * 0.01;
            assert!((decay(x) / (-x).exp() - 1.0).abs() < 1e-12, "exp(-{x})");
            let angle = FRAC_PI_2 * f64::from(step) / 2000.0;
            assert!((sine(angle) - angle.sin()).abs() < 1e-15, "sin {angle}");
        }
    }
}

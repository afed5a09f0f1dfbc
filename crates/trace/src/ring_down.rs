//! A decaying oscillation: its frequency and damping, from samples.
//!
//! The samples are fitted by `exp(-d t) (a cos w t + b sin w t) + c + e t` with least squares. For given `w` and
//! `d` the rest is linear, so only those two are searched: first on a grid that is fine enough for every peak, then
//! by steps that halve. The straight line takes motion slower than the window, such as a loop that settles.
//!
//! Gives the same bits on every processor: it uses `+ - * / sqrt`, and the exponential and the sine of `libm` once
//! for each try.

use std::f64::consts::PI;
use std::fmt;

/// Largest number of samples of a fit. A longer window is reduced to this number by means over equal blocks, which
/// change neither frequency nor damping.
pub const SAMPLES: usize = 1024;

/// The least number of samples.
pub const SAMPLES_MIN: usize = 16;

/// Least number of periods in a window.
pub const PERIODS_MIN: f64 = 2.0;

/// Least part of the oscillation that a fit must explain.
pub const EXPLAINED_MIN: f64 = 0.5;

/// The largest damping ratio of an oscillation, as a part of the turn: a motion that decays faster is a
/// loop that settles.
pub const DAMPING_MAX: f64 = 0.5;

/// The same for a growing oscillation, which the loops of the drive feed.
pub const GROWTH_MAX: f64 = 0.1;

/// Rates of decay on the grid, in one window.
const DECAYS: [f64; 5] = [0.0, 4.0, 24.0, 96.0, 400.0];

/// The part of the sum of squares that is known in one sample: a smaller remainder of the fit may be rounding.
const RESOLVED: f64 = 4.0 * f64::EPSILON;

/// A fit whose decay is this near to a bound, as a part of the turn, counts as on it.
const ON_BOUND: f64 = 1e-6;

/// Halvings of the steps around the best point of the grid.
const HALVINGS: u32 = 40;

/// Largest number of moves between two halvings.
const MOVES: u32 = 40;

/// The largest part of the samples, beside their level, that counts as rounding.
const STILL: f64 = 1e-12;

/// An oscillation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RingDown {
    /// Its frequency without damping (Hz), above 0.
    pub frequency: f64,
    /// Its uncertainty (Hz) with a probability of 95 %, if the rest of the fit is noise.
    pub frequency_within: f64,
    /// Its damping ratio, below 1; negative if it grows.
    pub damping: f64,
    /// Its uncertainty, in the same way.
    pub damping_within: f64,
    /// Its amplitude at the start of the window, in the unit of the samples.
    pub swing: f64,
    /// The part of the sum of squares, beside a straight line, that it explains: at most 1.
    pub explained: f64,
    /// Its periods in the window.
    pub periods: f64,
}

/// Why there is no oscillation in the result.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum NoRingDown {
    /// There are only this many samples.
    Short(usize),
    /// A sample is not a finite number: its index, from 0.
    Broken(usize),
    /// Nothing moves except by rounding.
    Still,
    /// The best fit explains no more than this.
    Unexplained(f64),
    /// The best fit has no more periods than this.
    Slow(f64),
    /// The best fit has this damping ratio, which is the largest or the least of the search: a better fit is beyond
    /// it.
    Bound(f64),
    /// The samples do not determine the frequency and the damping of the best fit.
    Vague,
}

impl fmt::Display for NoRingDown {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Short(samples) => write!(
                out,
                "there are {samples} samples, and it takes {SAMPLES_MIN}: take a longer window"
            ),
            Self::Broken(place) => write!(
                out,
                "sample {place} is no finite number: take a window without it"
            ),
            Self::Still => write!(out, "nothing moves: record it after a faster move"),
            Self::Unexplained(part) => write!(
                out,
                "no single frequency explains more than {:.0} % of it: take a window in which it swings freely",
                100.0 * part
            ),
            Self::Slow(periods) => write!(
                out,
                "the best fit has {periods:.1} periods, and it takes {PERIODS_MIN}: take a longer window"
            ),
            Self::Bound(damping) => write!(
                out,
                "it {} too fast: the best fit has a damping ratio of {damping:.4}, and no other is looked for beyond that",
                if *damping < 0.0 { "grows" } else { "decays" }
            ),
            Self::Vague => write!(
                out,
                "frequency and damping of the best fit are not determined: take more samples of the swing"
            ),
        }
    }
}

/// Finds the oscillation in samples that are `step` (s, above 0) apart.
///
/// # Errors
/// Samples without an oscillation; see [`NoRingDown`].
///
/// # Cost
/// About 10,000 fits of at most [`SAMPLES`] samples for every factor of 4 that the window is longer than that.
pub fn identify(samples: &[f64], step: f64) -> Result<RingDown, NoRingDown> {
    if samples.len() < SAMPLES_MIN {
        return Err(NoRingDown::Short(samples.len()));
    }
    if let Some(place) = samples.iter().position(|value| !value.is_finite()) {
        return Err(NoRingDown::Broken(place));
    }
    // Fast oscillations decay soon, slow ones need the whole window: the same search on its first part,
    // on more, on all.
    let mut best: Option<(f64, RingDown)> = None;
    let mut worst = NoRingDown::Still;
    let mut length = samples.len();
    loop {
        match in_window(samples.get(..length).unwrap_or(samples), step) {
            // The window in which more energy is explained.
            Ok((energy, found)) => {
                if best.is_none_or(|(most, _)| energy > most) {
                    best = Some((energy, found));
                }
            }
            Err(why) => {
                if length == samples.len() {
                    worst = why;
                }
            }
        }
        if length <= SAMPLES {
            break;
        }
        length = (length / 4).max(SAMPLES);
    }
    best.map(|(_, found)| found).ok_or(worst)
}

/// The same in one window; also the explained sum of squares (times s).
fn in_window(samples: &[f64], step: f64) -> Result<(f64, RingDown), NoRingDown> {
    let block = samples.len().div_ceil(SAMPLES);
    let means: Vec<f64> = samples
        .chunks_exact(block)
        .map(|block| block.iter().sum::<f64>() / block.len() as f64)
        .collect();
    let step = step * block as f64;
    let level = means.iter().fold(0.0_f64, |most, value| most.max(value.abs()));
    let middle = means.iter().sum::<f64>() / means.len() as f64;
    let most = means
        .iter()
        .fold(0.0_f64, |most, value| most.max((value - middle).abs()));
    if !(most > STILL * level) || !most.is_finite() {
        return Err(NoRingDown::Still);
    }
    let scaled: Vec<f64> = means.iter().map(|value| (value - middle) / most).collect();
    let count = scaled.len() as f64;
    let line = Fit::of(&scaled, None).left;
    if !(line > 0.0) {
        return Err(NoRingDown::Still);
    }

    // A peak is half a period in the window wide; the search begins at one and a half periods.
    let width = 0.5 * PI / count;
    let lines = (0.95 * PI / width) as usize;
    let grid = (6..lines).flat_map(|line| {
        DECAYS.map(|decay| Try {
            turn: line as f64 * width,
            decay: decay / count,
        })
    });
    let mut best = (
        f64::INFINITY,
        Try {
            turn: 0.0,
            decay: 0.0,
        },
    );
    for at in grid.filter(Try::is_swing) {
        let left = Fit::of(&scaled, Some(at)).left;
        if left < best.0 {
            best = (left, at);
        }
    }
    // The search for a fast decay uses larger steps, because its grid is coarser and its peak is wider.
    let decay = (0.25 * best.1.decay).max(1.0 / count);
    let (left, at) = refined(&scaled, best, width * decay * count, decay);
    let explained = 1.0 - left / line;
    if explained < EXPLAINED_MIN {
        return Err(NoRingDown::Unexplained(explained.max(0.0)));
    }
    let periods = at.turn * count / (2.0 * PI);
    if periods < PERIODS_MIN {
        return Err(NoRingDown::Slow(periods));
    }
    let natural = (at.turn * at.turn + at.decay * at.decay).sqrt();
    if at.is_on_bound() {
        return Err(NoRingDown::Bound(at.decay / natural));
    }

    // Means over blocks are lower than their samples.
    let whole: Vec<f64> = samples.iter().map(|value| (value - middle) / most).collect();
    let blocks = block as f64;
    let fit = Fit::of(
        &whole,
        Some(Try {
            turn: at.turn / blocks,
            decay: at.decay / blocks,
        }),
    );
    let (turn_within, decay_within) =
        within(&scaled, at, left.max(RESOLVED * line * count)).ok_or(NoRingDown::Vague)?;
    let found = RingDown {
        frequency: natural / (2.0 * PI * step),
        frequency_within: (at.turn * turn_within + at.decay.abs() * decay_within)
            / (natural * 2.0 * PI * step),
        damping: at.decay / natural,
        damping_within: (at.turn * at.turn * decay_within + at.turn * at.decay.abs() * turn_within)
            / (natural * natural * natural),
        swing: most * (fit.cosine * fit.cosine + fit.sine * fit.sine).sqrt(),
        explained,
        periods,
    };
    Ok(((line - left) * most * most * step, found))
}

/// Turn (rad) and decay of an oscillation from one sample to the next.
#[derive(Clone, Copy, Debug)]
struct Try {
    turn: f64,
    decay: f64,
}

impl Try {
    fn is_swing(&self) -> bool {
        let is_slow = -GROWTH_MAX * self.turn <= self.decay && self.decay <= DAMPING_MAX * self.turn;
        self.turn > 0.0 && self.turn < PI && is_slow
    }

    fn is_on_bound(&self) -> bool {
        let ratio = self.decay / self.turn;
        ratio >= DAMPING_MAX - ON_BOUND || ratio <= ON_BOUND - GROWTH_MAX
    }
}

/// The best of a few neighbours at a time, with steps that halve.
fn refined(samples: &[f64], (mut left, mut at): (f64, Try), turn: f64, decay: f64) -> (f64, Try) {
    let (mut turn, mut decay) = (turn, decay);
    for _ in 0..HALVINGS {
        for _ in 0..MOVES {
            // Diagonals, too: for an oscillation with fast decay, turn and decay change the fit together.
            let neighbours = [
                (1.0, 0.0),
                (-1.0, 0.0),
                (0.0, 1.0),
                (0.0, -1.0),
                (1.0, 1.0),
                (-1.0, -1.0),
                (1.0, -1.0),
                (-1.0, 1.0),
            ]
            .map(|(by, more)| Try {
                turn: at.turn + by * turn,
                decay: at.decay + more * decay,
            });
            let before = left;
            for neighbour in neighbours {
                if neighbour.is_swing() {
                    let tried = Fit::of(samples, Some(neighbour)).left;
                    if tried < left {
                        (left, at) = (tried, neighbour);
                    }
                }
            }
            if left >= before {
                break;
            }
        }
        (turn, decay) = (0.5 * turn, 0.5 * decay);
    }
    (left, at)
}

/// The uncertainty of turn and decay, 95 %, from the growth of the sum of squares around the best fit. `None` if it
/// does not grow in every direction.
fn within(samples: &[f64], at: Try, left: f64) -> Option<(f64, f64)> {
    let count = samples.len() as f64;
    let (turn, decay) = (0.01 / count, 0.01 / count);
    let sum = |by: f64, more: f64| {
        let near = Try {
            turn: at.turn + by * turn,
            decay: at.decay + more * decay,
        };
        Fit::of(samples, Some(near)).left
    };
    let here = sum(0.0, 0.0);
    let of_turn = (sum(1.0, 0.0) + sum(-1.0, 0.0) - 2.0 * here) / (turn * turn);
    let of_decay = (sum(0.0, 1.0) + sum(0.0, -1.0) - 2.0 * here) / (decay * decay);
    let of_both = (sum(1.0, 1.0) + sum(-1.0, -1.0) - sum(1.0, -1.0) - sum(-1.0, 1.0)) / (4.0 * turn * decay);
    let spread = 2.0 * left / (count - 6.0);
    let whole = of_turn * of_decay - of_both * of_both;
    if !(whole > 0.0 && of_turn > 0.0) {
        return None;
    }
    let bound = |curvature: f64| 1.96 * (spread * curvature / whole).sqrt();
    Some((bound(of_decay), bound(of_turn)))
}

/// The best oscillation with given turn and decay, beside a straight line.
struct Fit {
    cosine: f64,
    sine: f64,
    /// The sum of squares that is left.
    left: f64,
}

impl Fit {
    fn of(samples: &[f64], at: Option<Try>) -> Self {
        let (by_cosine, by_sine) = at.map_or((0.0, 0.0), |at| {
            let fade = libm::exp(-at.decay);
            (fade * libm::cos(at.turn), fade * libm::sin(at.turn))
        });
        // Without an oscillation both are 0 everywhere.
        let (mut c, mut s) = (if at.is_some() { 1.0 } else { 0.0 }, 0.0);
        let by = 2.0 / samples.len() as f64;
        let mut x = -1.0;
        // Sums of the products of cosine, sine, 1 and the position from -1 to 1, and of each with the samples.
        let (mut cc, mut cs, mut c1, mut cx, mut ss, mut s1, mut sx) = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0);
        let (mut x1, mut xx) = (0.0, 0.0);
        let (mut yc, mut ys, mut y1, mut yx, mut yy) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for y in samples {
            cc += c * c;
            cs += c * s;
            c1 += c;
            cx += c * x;
            ss += s * s;
            s1 += s;
            sx += s * x;
            x1 += x;
            xx += x * x;
            yc += y * c;
            ys += y * s;
            y1 += y;
            yx += y * x;
            yy += y * y;
            (c, s) = (c * by_cosine - s * by_sine, c * by_sine + s * by_cosine);
            x += by;
        }
        let count = samples.len() as f64;
        let matrix = [
            [cc, cs, c1, cx],
            [0.0, ss, s1, sx],
            [0.0, 0.0, count, x1],
            [0.0, 0.0, 0.0, xx],
        ];
        let [cosine, sine, level, slope] = solved(matrix, [yc, ys, y1, yx]);
        Self {
            cosine,
            sine,
            left: (yy - cosine * yc - sine * ys - level * y1 - slope * yx).max(0.0),
        }
    }
}

/// Solves symmetric equations, given by the upper half; rows and columns of 0 stay 0.
fn solved(mut matrix: [[f64; 4]; 4], mut right: [f64; 4]) -> [f64; 4] {
    for pivot in 0..4 {
        // Below this a row has no more information than those before it.
        if !(matrix[pivot][pivot] > 1e-13) {
            matrix[pivot] = [0.0; 4];
            right[pivot] = 0.0;
            continue;
        }
        let upper = matrix[pivot];
        for row in pivot + 1..4 {
            let factor = upper[row] / upper[pivot];
            for (cell, above) in matrix[row].iter_mut().zip(upper).skip(row) {
                *cell -= factor * above;
            }
            right[row] -= factor * right[pivot];
        }
    }
    let mut found = [0.0; 4];
    for row in (0..4).rev() {
        if matrix[row][row] > 0.0 {
            let known: f64 = (row + 1..4)
                .map(|column| matrix[row][column] * found[column])
                .sum();
            found[row] = (right[row] - known) / matrix[row][row];
        }
    }
    found
}

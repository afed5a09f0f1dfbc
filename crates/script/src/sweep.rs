//! The parameters that a sweep varies, and its cases.
//!
//! A case is a number. Its parameters follow from the number and the file alone, so any process may
//! compute any case. A sample can be extended: with a larger `count` the first cases stay the same.

use crate::error::{Code, Diagnostic, ScriptError, quoted};
use crate::model::{Script, Span};
use crate::read::names::suggestion;
use standstill_trace::{Column, Kind, Trace};

/// Largest number of cases of one sweep.
pub const CASES_MAX: u64 = 10_000_000;

/// A sweep file, read and checked; it is not yet compared with the script that it names.
#[derive(Clone, Debug)]
pub struct Sweep {
    /// Name and text of the file, for messages.
    pub(crate) file: (String, String),
    /// The script's path, relative to the folder of the sweep file.
    pub script: String,
    pub(crate) script_place: Span,
    pub(crate) varied: Vec<Varied>,
    pub(crate) draw: Draw,
    pub(crate) measures: Vec<Measure>,
    /// Whether the table has the digest of every case. Without it a case need not write unused columns.
    pub has_digest: bool,
}

/// A parameter and its values.
#[derive(Clone, Debug)]
pub(crate) struct Varied {
    pub(crate) name: String,
    pub(crate) place: Span,
    pub(crate) values: Values,
}

/// The values of a parameter.
#[derive(Clone, Debug)]
pub(crate) enum Values {
    /// These values.
    List(Vec<f64>),
    /// From the first to the second, both included; a number of them in a grid, any in a sample.
    Range {
        from: f64,
        to: f64,
        count: u64,
        scale: Scale,
    },
}

/// The spacing of values between two ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Scale {
    /// At equal differences.
    Linear,
    /// At equal ratios.
    Log,
}

impl Scale {
    /// The value at `place`, 0 to 1, between the two.
    fn at(self, from: f64, to: f64, place: f64) -> f64 {
        let value = match self {
            Self::Linear => from + (to - from) * place,
            // In software, so that it has the same bits on every machine.
            Self::Log => from * libm::pow(to / from, place),
        };
        // Rounding must not exceed the ends.
        value.clamp(from.min(to), from.max(to))
    }
}

/// The cases of a sweep.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Draw {
    /// Every value of a parameter with every one of the others; the last parameter varies fastest.
    Grid,
    /// A number of cases, with each parameter drawn independently.
    Sample { seed: u64, count: u64 },
}

/// A figure that every run gives.
#[derive(Clone, Debug)]
pub struct Measure {
    /// Its column.
    pub name: String,
    pub(crate) place: Span,
    /// The kind of the figure.
    pub take: Take,
    /// The signal: a column of the trace.
    pub signal: String,
    pub(crate) signal_place: Span,
}

/// The quantity that a measure takes of a signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Take {
    /// Its value in the last row.
    Last,
    /// Its greatest value.
    Max,
    /// Its least value.
    Min,
    /// Its greatest magnitude.
    AbsMax,
    /// The first scan in which it is TRUE.
    First,
    /// The number of scans in which it is TRUE.
    Count,
}

/// The names of the quantities.
pub(crate) const TAKES: [(&str, Take); 6] = [
    ("last", Take::Last),
    ("max", Take::Max),
    ("min", Take::Min),
    ("abs_max", Take::AbsMax),
    ("first", Take::First),
    ("count", Take::Count),
];

impl Take {
    /// The kinds of signals it can be taken of, if this kind is not one.
    fn refuses(self, kind: Kind) -> Option<&'static str> {
        match (self, kind) {
            (Self::Last, _)
            | (Self::Max | Self::Min | Self::AbsMax, Kind::Real | Kind::Integer)
            | (Self::First | Self::Count, Kind::Bool) => None,
            (Self::First | Self::Count, _) => Some("a BOOL"),
            (Self::Max | Self::Min | Self::AbsMax, _) => Some("a number"),
        }
    }
}

impl Sweep {
    /// The number of cases: 1 to [`CASES_MAX`].
    pub fn count(&self) -> u64 {
        match self.draw {
            Draw::Sample { count, .. } => count,
            Draw::Grid => self.varied.iter().map(|varied| varied.values.count()).product(),
        }
    }

    /// The names of the parameters, in file order.
    pub fn parameters(&self) -> impl Iterator<Item = &str> {
        self.varied.iter().map(|varied| varied.name.as_str())
    }

    /// The figures to be taken, in file order.
    pub fn measures(&self) -> &[Measure] {
        &self.measures
    }

    /// The text of the file, without a byte order mark.
    pub fn text(&self) -> &str {
        &self.file.1
    }

    /// The parameters of a case, in file order; the work is proportional to their number.
    pub fn case(&self, number: u64) -> Vec<(String, f64)> {
        let mut rest = number;
        let mut values: Vec<(String, f64)> = Vec::with_capacity(self.varied.len());
        match self.draw {
            Draw::Grid => {
                for varied in self.varied.iter().rev() {
                    let count = varied.values.count();
                    values.push((varied.name.clone(), varied.values.step(rest % count)));
                    rest /= count;
                }
                values.reverse();
            }
            Draw::Sample { seed, .. } => {
                for (index, varied) in (0..).zip(&self.varied) {
                    let random = mixed(mixed(seed ^ mixed(number)) ^ mixed(index));
                    values.push((varied.name.clone(), varied.values.draw(random)));
                }
            }
        }
        values
    }

    /// The message that the script cannot be read, with the reason.
    pub fn no_script(&self, why: &str) -> ScriptError {
        let message = format!("{} cannot be had: {why}", quoted(&self.script));
        let diagnostic = Diagnostic::new(Code::BadInclude, self.script_place, message);
        ScriptError::new(&self.file.0, &self.file.1, vec![diagnostic])
    }

    /// Checks the names in the file against the script and the trace of its run. Also checks that no two columns of
    /// a table with these have one name.
    ///
    /// # Errors
    /// [`ScriptError`] with every name that does not exist or is ambiguous.
    pub fn check(&self, script: &Script, trace: &Trace, columns: &[String]) -> Result<(), ScriptError> {
        let mut errors = Vec::new();
        for varied in &self.varied {
            if !script.parameters.contains_key(&varied.name) {
                let known = script.parameters.keys().map(String::as_str);
                let message = format!("{} has no parameter {}", self.script, quoted(&varied.name));
                let diagnostic = Diagnostic::new(Code::UnknownParameter, varied.place, message);
                errors.push(diagnostic.maybe_help(suggestion(&varied.name, known)));
            }
        }
        for measure in &self.measures {
            errors.extend(measure.error(trace));
        }
        let own = self.varied.iter().map(|varied| (&varied.name, varied.place));
        let own: Vec<_> = own
            .chain(self.measures.iter().map(|measure| (&measure.name, measure.place)))
            .collect();
        for (index, (name, place)) in own.iter().enumerate() {
            if columns.contains(name) || own[..index].iter().any(|(other, _)| other == name) {
                let message = format!("the table has a column {} already", quoted(name));
                errors.push(Diagnostic::new(Code::DuplicateName, *place, message));
            }
        }
        if errors.is_empty() {
            return Ok(());
        }
        Err(ScriptError::new(&self.file.0, &self.file.1, errors))
    }
}

impl Measure {
    fn error(&self, trace: &Trace) -> Option<Diagnostic> {
        let columns = trace.columns();
        let Some(column) = trace.column(&self.signal).and_then(|at| columns.get(at)) else {
            let names = columns.iter().map(|column: &Column| column.name.as_str());
            let message = format!("the trace has no signal {}", quoted(&self.signal));
            let diagnostic = Diagnostic::new(Code::UnknownSignal, self.signal_place, message);
            return Some(diagnostic.maybe_help(suggestion(&self.signal, names)));
        };
        let wanted = self.take.refuses(column.kind)?;
        let take = TAKES.iter().find(|(_, take)| *take == self.take);
        let message = format!(
            "{} is taken of {wanted}, which {} is not",
            quoted(take.map_or("", |(name, _)| name)),
            quoted(&self.signal)
        );
        Some(Diagnostic::new(Code::WrongType, self.signal_place, message))
    }
}

impl Values {
    pub(crate) fn count(&self) -> u64 {
        match self {
            Self::List(list) => list.len() as u64,
            Self::Range { count, .. } => *count,
        }
    }

    /// The value at this index of a grid; both ends to the bit.
    fn step(&self, index: u64) -> f64 {
        match self {
            Self::List(list) => usize::try_from(index)
                .ok()
                .and_then(|index| list.get(index))
                .copied()
                .unwrap_or(f64::NAN),
            Self::Range { from, .. } if index == 0 => *from,
            Self::Range { to, count, .. } if index + 1 == *count => *to,
            Self::Range {
                from,
                to,
                count,
                scale,
            } => scale.at(*from, *to, index as f64 / (count - 1) as f64),
        }
    }

    /// The value for these 64 bits.
    fn draw(&self, random: u64) -> f64 {
        match self {
            Self::List(list) => {
                // The upper half of a product of 128 bits is below the length.
                let index = (u128::from(random) * list.len() as u128) >> 64;
                usize::try_from(index)
                    .ok()
                    .and_then(|index| list.get(index))
                    .copied()
                    .unwrap_or(f64::NAN)
            }
            Self::Range { from, to, scale, .. } => {
                // 53 bits are exact.
                let place = (random >> 11) as f64 / (1_u64 << 53) as f64;
                scale.at(*from, *to, place)
            }
        }
    }
}

/// The finisher of SplitMix64 (Steele, Lea, Flood 2014): every bit of the number affects every bit of the
/// result.
const fn mixed(number: u64) -> u64 {
    let z = number.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ (z >> 31)
}

#[cfg(test)]
mod tests {
    use crate::read_sweep;

    fn sweep(text: &str) -> super::Sweep {
        let text = format!("{{\"standstill_sweep\": 1, \"script\": \"a.scan.json\", {text}}}");
        read_sweep(&text, "a.sweep.json").unwrap_or_else(|error| panic!("{error}"))
    }

    fn values(sweep: &super::Sweep, case: u64) -> Vec<f64> {
        sweep.case(case).into_iter().map(|(_, value)| value).collect()
    }

    #[test]
    fn the_last_parameter_of_a_grid_varies_fastest() {
        let sweep = sweep(r#""grid": {"v": [1, 2], "a": {"from": 10, "to": 30, "count": 3}}"#);
        assert_eq!(sweep.count(), 6);
        assert_eq!(sweep.parameters().collect::<Vec<_>>(), ["v", "a"]);
        let cases: Vec<_> = (0..6).map(|case| values(&sweep, case)).collect();
        assert_eq!(
            cases,
            [
                [1.0, 10.0],
                [1.0, 20.0],
                [1.0, 30.0],
                [2.0, 10.0],
                [2.0, 20.0],
                [2.0, 30.0]
            ]
        );
    }

    #[test]
    fn a_range_ends_to_the_bit_and_goes_by_ratios_where_asked_to() {
        let sweep = sweep(r#""grid": {"j": {"from": 0.1, "to": 0.7, "count": 4, "scale": "log"}}"#);
        let cases: Vec<_> = (0..4).map(|case| values(&sweep, case)[0]).collect();
        assert_eq!(
            (cases[0].to_bits(), cases[3].to_bits()),
            (0.1_f64.to_bits(), 0.7_f64.to_bits())
        );
        for pair in cases.windows(2) {
            let ratio = pair[1] / pair[0];
            assert!((ratio * ratio * ratio - 7.0).abs() < 1e-12, "{cases:?}");
        }
    }

    #[test]
    fn a_sample_is_spread_over_its_range_and_does_not_depend_on_its_length() {
        let of = |count: u64| {
            sweep(&format!(
                r#""sample": {{"seed": 3, "count": {count}, "of": {{"v": {{"from": -1, "to": 3}}, "m": [0, 1, 2]}}}}"#
            ))
        };
        let (short, long) = (of(10), of(4000));
        for case in 0..10 {
            assert_eq!(short.case(case), long.case(case));
        }
        let all: Vec<_> = (0..4000).map(|case| values(&long, case)).collect();
        assert!(all.iter().all(|case| (-1.0..=3.0).contains(&case[0])));
        let mean = all.iter().map(|case| case[0]).sum::<f64>() / 4000.0;
        assert!((mean - 1.0).abs() < 0.1, "{mean}");
        for value in [0.0, 1.0, 2.0] {
            let share = all.iter().filter(|case| case[1] == value).count();
            assert!((1200..1470).contains(&share), "{value} {share} times");
        }
        // Another seed is another sample; these bits are part of the meaning of a sweep file.
        assert_eq!(
            values(&long, 0)[0].to_bits(),
            FIRST.to_bits(),
            "{:?}",
            values(&long, 0)[0]
        );
    }

    const FIRST: f64 = -0.079_443_633_538_005_99;
}

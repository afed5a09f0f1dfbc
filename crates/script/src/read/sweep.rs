//! From text to a checked [`Sweep`]: which parameters of a script vary, and how.

use super::shape::sweep as shape;
use super::value::{WHOLE_MAX, wrong_type};
use super::{Reader, is_note, read_file};
use crate::error::{Code, Diagnostic, ScriptError, quoted};
use crate::read::json::{Json, Key, Node};
use crate::sweep::{CASES_MAX, Draw, Measure, Scale, Sweep, TAKES, Values, Varied};

/// The version of the format that is read.
pub(crate) const SWEEP_VERSION: u32 = 1;

/// The spacing of values between two ends.
pub(crate) const SCALES: [(&str, Scale); 2] = [("linear", Scale::Linear), ("log", Scale::Log)];

/// Reads a sweep file.
///
/// `file_name` is used in messages only. The work is bounded by the length of the text.
///
/// # Errors
/// [`ScriptError`] with all faults; after a syntax error only that one.
pub fn read_sweep(text: &str, file_name: &str) -> Result<Sweep, ScriptError> {
    read_file(text, file_name, |reader, root, plain| {
        reader.sweep(root, (file_name.to_owned(), plain.to_owned()))
    })
}

impl Reader {
    fn sweep(&mut self, root: &Node, file: (String, String)) -> Option<Sweep> {
        let fields = self.fields(root, &shape::SWEEP)?;
        self.version(&fields, ("standstill_sweep", "sweep"), "a sweep", SWEEP_VERSION)?;
        for key in ["$schema", "title"] {
            self.optional(&fields, key, "", Self::text)?;
        }
        let script = self.needed(&fields, "script", "a sweep", |it, node, key| {
            Some((it.text(node, key)?, node.span))
        });
        let measures = self.optional(&fields, "measure", Vec::new(), Self::measures);
        let has_digest = self.optional(&fields, "digest", true, Self::boolean);
        let varied = match (fields.get("grid"), fields.entry("sample")) {
            (Some(_), Some((key, _))) => {
                let message = "a sweep has a `grid` or a `sample`, not both";
                self.refuse(Diagnostic::new(Code::BadValue, key.span, message))
            }
            (Some(node), None) => self
                .varied(node, "`grid`", true)
                .map(|varied| (varied, Draw::Grid)),
            (None, Some((_, node))) => self.sample(node),
            (None, None) => {
                let message = "a sweep needs the key `grid` or the key `sample`";
                self.refuse(
                    Diagnostic::new(Code::MissingKey, fields.brace(), message)
                        .help("for example \"grid\": {\"v\": [10, 20, 50]}"),
                )
            }
        };
        let (varied, draw) = varied?;
        self.check_cases(&varied, draw, root)?;
        let (script, script_place) = script?;
        Some(Sweep {
            file,
            script: script.to_owned(),
            script_place,
            varied,
            draw,
            measures: measures?,
            has_digest: has_digest?,
        })
    }

    fn sample(&mut self, node: &Node) -> Option<(Vec<Varied>, Draw)> {
        let fields = self.fields(node, &shape::SAMPLE)?;
        let seed = self.needed(&fields, "seed", "`sample`", |it, node, key| {
            it.whole(node, key, 0..=WHOLE_MAX as i64)
        });
        let count = self.needed(&fields, "count", "`sample`", |it, node, key| {
            it.whole(node, key, 1..=CASES_MAX as i64)
        });
        let varied = self.needed(&fields, "of", "`sample`", |it, node, key| {
            it.varied(node, key, false)
        });
        let draw = Draw::Sample {
            seed: seed?.unsigned_abs(),
            count: count?.unsigned_abs(),
        };
        Some((varied?, draw))
    }

    /// The parameters and their values.
    fn varied(&mut self, node: &Node, what: &str, grid: bool) -> Option<Vec<Varied>> {
        let members = self.map(node, what)?;
        let varied: Vec<_> = members
            .iter()
            .filter(|(key, node)| !is_note(key, node))
            .map(|(key, node)| {
                Some(Varied {
                    name: key.text.clone(),
                    place: key.span,
                    values: self.values(key, node, grid)?,
                })
            })
            .collect();
        if varied.is_empty() {
            let message = format!("{what} varies nothing");
            return self.refuse(
                Diagnostic::new(Code::BadValue, node.span, message)
                    .help("name a parameter of the script: {\"v\": [10, 20, 50]}"),
            );
        }
        varied.into_iter().collect()
    }

    fn values(&mut self, key: &Key, node: &Node, grid: bool) -> Option<Values> {
        let what = quoted(&key.text);
        match &node.json {
            Json::List(items) if items.is_empty() => {
                let message = format!("{what} has no values");
                self.refuse(Diagnostic::new(Code::BadValue, node.span, message))
            }
            Json::List(items) => self
                .each(items, |reader, item| reader.number(item, &what))
                .map(Values::List),
            Json::Map(_) if grid => self.values_between(node, &shape::STEPS),
            Json::Map(_) => self.values_between(node, &shape::RANGE),
            _ => {
                let diagnostic = wrong_type(node, &what, "a list of values or a range");
                let range = if grid { ", \"count\": 9}" } else { "}" };
                self.refuse(diagnostic.help(format!("[10, 20, 50] or {{\"from\": 10, \"to\": 50{range}")))
            }
        }
    }

    fn values_between(&mut self, node: &Node, shape: &super::shape::Shape) -> Option<Values> {
        let fields = self.fields(node, shape)?;
        let end = |reader: &mut Self, key: &str| {
            let node = reader.require(&fields, key, shape.what)?;
            let value = reader.finite(node, &quoted(key))?;
            Some((value, node.span))
        };
        let (from, to) = (end(self, "from"), end(self, "to"));
        let count = if shape.has("count") {
            let node = self.require(&fields, "count", shape.what)?;
            self.whole(node, "`count`", 2..=CASES_MAX as i64)?.unsigned_abs()
        } else {
            1
        };
        let scale = self.optional(&fields, "scale", Scale::Linear, |it, node, key| {
            it.choice(node, key, &SCALES)
        })?;
        let ((from, from_place), (to, to_place)) = (from?, to?);
        if scale == Scale::Log
            && let Some((value, place)) = [(from, from_place), (to, to_place)]
                .into_iter()
                .find(|(value, _)| *value <= 0.0)
        {
            let message = format!("{value:?} is on no logarithmic scale: it must be more than 0");
            return self.refuse(Diagnostic::new(Code::BadValue, place, message));
        }
        if !(to - from).is_finite() || (scale == Scale::Log && !(to / from).is_normal()) {
            let message = "the range is wider than a 64-bit float can step through";
            return self.refuse(Diagnostic::new(Code::BadValue, to_place, message));
        }
        Some(Values::Range {
            from,
            to,
            count,
            scale,
        })
    }

    fn check_cases(&mut self, varied: &[Varied], draw: Draw, root: &Node) -> Option<()> {
        let count = match draw {
            Draw::Sample { count, .. } => Some(count),
            Draw::Grid => varied
                .iter()
                .try_fold(1_u64, |cases, varied| cases.checked_mul(varied.values.count())),
        };
        if count.is_some_and(|count| count <= CASES_MAX) {
            return Some(());
        }
        let message = format!("the grid has more than {CASES_MAX} cases");
        self.refuse(
            Diagnostic::new(Code::TooLarge, root.span, message)
                .help("a `sample` draws as many of them as you can afford"),
        )
    }

    fn measures(&mut self, node: &Node, what: &str) -> Option<Vec<Measure>> {
        let members = self.map(node, what)?;
        let measures: Vec<_> = members
            .iter()
            .filter(|(key, node)| !is_note(key, node))
            .map(|(key, node)| self.measure(key, node))
            .collect();
        measures.into_iter().collect()
    }

    fn measure(&mut self, key: &Key, node: &Node) -> Option<Measure> {
        let fields = self.fields(node, &shape::MEASURE)?;
        let mut taken = TAKES
            .iter()
            .filter_map(|(name, take)| fields.get(name).map(|node| (*take, node)));
        let (Some((take, signal)), None) = (taken.next(), taken.next()) else {
            let message = format!("{} takes one thing of one signal", quoted(&key.text));
            return self.refuse(
                Diagnostic::new(Code::BadValue, node.span, message)
                    .help("for example {\"abs_max\": \"X.FollowingError\"} or {\"first\": \"move.Done\"}"),
            );
        };
        Some(Measure {
            name: key.text.clone(),
            place: key.span,
            take,
            signal: self.text(signal, "a measure")?.to_owned(),
            signal_place: signal.span,
        })
    }
}

//! Warnings: legal items of a script that test nothing, and values that are changed silently.
//!
//! They are found from the rows and notes of the run, after it. A warning alone never changes a verdict.

mod claims;
mod subjects;

pub(crate) use subjects::never_runs;

use crate::advice;
use crate::error::{Code, Diagnostic, File, file, place_of, rendered};
use crate::model::{Script, Span, When};
use crate::run::{Outcome, rows_of};
use annotate_snippets::Level;
use std::fmt;
use std::sync::Arc;

/// Largest number of warnings of one script that are rendered in full; the rest is counted.
const SHOWN_MOST: usize = 20;

/// The subject of a warning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum WarningKind {
    /// It tests nothing.
    Vacuous,
    /// A value above its limit was lowered.
    Clamped,
    /// An item of a program in Structured Text works, but is probably not meant.
    Doubtful,
    /// It may mean something other than intended; no test fails because of it.
    Note,
}

impl WarningKind {
    /// Its name in messages.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Vacuous => "vacuous",
            Self::Clamped => "clamped",
            Self::Doubtful => "doubtful",
            Self::Note => "note",
        }
    }
}

/// One warning.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Warning {
    /// Its kind.
    pub kind: WarningKind,
    /// JSON path of its subject, such as `steps[2]`.
    pub path: String,
    /// The place of the subject.
    pub span: Span,
    /// The problem, one sentence without a full stop.
    pub message: String,
    /// The remedy.
    pub help: String,
}

impl Warning {
    pub(crate) fn vacuous(path: String, span: Span, message: String) -> Self {
        Self {
            kind: WarningKind::Vacuous,
            path,
            span,
            message,
            help: "mend it or take it out; \"vacuous\": \"allowed\" beside it says that it is meant"
                .to_owned(),
        }
    }

    /// Whether a strict test fails because of it.
    #[must_use]
    pub const fn counts(&self) -> bool {
        !matches!(self.kind, WarningKind::Note)
    }
}

/// The warnings of a script, in the order of its text.
#[derive(Clone, Debug, Default)]
pub struct Warnings {
    files: Arc<[File]>,
    /// All of them.
    pub all: Vec<Warning>,
}

impl Warnings {
    /// File, line and column of a warning, both numbers from 1.
    #[must_use]
    pub fn place(&self, warning: &Warning) -> (&str, usize, usize) {
        let (line, column) = place_of(&self.files, warning.span);
        (file(&self.files, warning.span).name(), line, column)
    }

    /// Whether a strict test fails because of one of them.
    #[must_use]
    pub fn count(&self) -> bool {
        self.all.iter().any(Warning::counts)
    }

    /// Each that makes a strict test fail, as a line with its place.
    pub fn lines(&self) -> impl Iterator<Item = String> + '_ {
        let counted = self.all.iter().filter(|warning| warning.counts());
        counted.map(|warning| {
            let (_, line, column) = self.place(warning);
            let (path, kind) = (&warning.path, warning.kind.name());
            format!("{path} ({line}:{column}): {kind}: {}", warning.message)
        })
    }
}

/// For people, each with its place in the text.
impl fmt::Display for Warnings {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for warning in self.all.iter().take(SHOWN_MOST) {
            let level = match warning.kind {
                WarningKind::Note => Level::NOTE,
                WarningKind::Vacuous | WarningKind::Clamped | WarningKind::Doubtful => Level::WARNING,
            };
            let diagnostic = Diagnostic::new(Code::BadValue, warning.span, &warning.message)
                .maybe_help(Some(warning.help.clone()).filter(|help| !help.is_empty()));
            writeln!(
                out,
                "{}",
                rendered(&self.files, &level, warning.kind.name(), &diagnostic)
            )?;
        }
        match self.all.len().checked_sub(SHOWN_MOST) {
            Some(more @ 1..) => writeln!(
                out,
                "warning: {more} more in {}",
                file(&self.files, Span::default()).name()
            ),
            _ => Ok(()),
        }
    }
}

/// The items that test nothing according to the run, and the values that were changed in it; `has_golden` means
/// that the run also has a golden.
///
/// If the rows of the run were dropped on the way, only the warnings of the script's text are found.
///
/// Cost: some passes over the rows for suspicious items, and few reads for all others.
#[must_use]
pub fn warnings(script: &Script, outcome: &Outcome, has_golden: bool) -> Warnings {
    let mut all = Vec::new();
    if script.files.is_empty() {
        return Warnings {
            files: Arc::clone(&script.files),
            all,
        };
    }
    // Whether an item tests nothing is decided by all rows; a shorter run of the same script has them.
    let has_rows = outcome.trace.first() == 0;
    rows_of(script, outcome, |rows| {
        if !has_rows {
            return;
        }
        for (index, step) in script.steps.iter().enumerate() {
            if !step.place.may_be_vacuous
                && let Some(why) = not_applied(&step.when, rows)
            {
                all.push(Warning::vacuous(format!("steps[{index}]"), step.place.span, why));
            }
        }
        claims::look(rows, &mut all);
        subjects::look(rows, &mut all);
    });
    if !script.clamps_expected && has_rows {
        clamps(script, outcome, &mut all);
    }
    references(script, &mut all);
    doubts(script, &mut all);
    if script.claims.is_empty() && !has_golden {
        let message = "the script has no claims and no golden: it tests nothing".to_owned();
        let span = Span { start: 0, end: 1 };
        all.push(Warning::vacuous("expect".to_owned(), span, message));
    }
    // An included file is shared: an item that one script does not use, another one may.
    let own = script.files.first().map_or(0, File::after);
    all.retain(|warning| warning.kind != WarningKind::Vacuous || warning.span.start < own);
    all.sort_by_key(|warning| warning.span.start);
    Warnings {
        files: Arc::clone(&script.files),
        all,
    }
}

/// The reason why a step was never applied.
fn not_applied(when: &When, rows: &crate::run::Rows<'_>) -> Option<String> {
    let count = rows.count();
    let last = count.saturating_sub(1);
    match when {
        When::At(at) if *at < count => None,
        When::At(at) => Some(format!(
            "the step is never applied: it is for scan {at}, and the run ended with scan {last}"
        )),
        When::Holds {
            conditions, after, ..
        } => {
            let Some(held) = (0..count).find(|&scan| rows.hold(conditions, scan)) else {
                return Some("the step is never applied: its `when` held in no scan".to_owned());
            };
            let applied = held.saturating_add(1).saturating_add(*after);
            (applied >= count).then(|| {
                format!("the step is never applied: its `when` held in scan {held}, so it is for scan {applied}, and the run ended with scan {last}")
            })
        }
    }
}

/// Values that were lowered to a limit, each pin once.
fn clamps(script: &Script, outcome: &Outcome, all: &mut Vec<Warning>) {
    let mut told: Vec<(&str, &str)> = Vec::new();
    for note in outcome.trace.notes() {
        let Some((pin, values)) = note
            .text
            .strip_prefix("clamped: ")
            .and_then(|text| text.split_once(' '))
        else {
            continue;
        };
        if told.contains(&(note.subject.as_str(), pin)) {
            continue;
        }
        told.push((&note.subject, pin));
        let owner = note.subject.split('.').next().unwrap_or_default();
        let mut blocks = script.blocks.iter().enumerate();
        let (path, span) = match blocks.find(|(_, block)| block.name == note.subject) {
            Some((index, block)) => (format!("blocks[{index}]"), block.place.span),
            None => {
                let program = script.programs.iter().find(|program| program.name == owner);
                let span = program.map_or(Span { start: 0, end: 1 }, |program| program.place.span);
                (format!("programs.{owner}"), span)
            }
        };
        let values = values.replacen(" to ", " was lowered to ", 1);
        all.push(Warning {
            kind: WarningKind::Clamped,
            path,
            span,
            message: format!("{}.{pin} {values} in scan {}", note.subject, note.scan),
            help: "stay below the limit of the axis, raise it, or say \"clamps\": \"expected\"".to_owned(),
        });
    }
}

/// What the compiler finds doubtful in programs in Structured Text.
fn doubts(script: &Script, all: &mut Vec<Warning>) {
    for program in &script.programs {
        for doubt in program.text.iter().flat_map(|text| &text.doubtful) {
            all.push(Warning {
                kind: WarningKind::Doubtful,
                path: format!("programs.{}", program.name),
                span: program.place.span,
                message: doubt.message.clone(),
                help: doubt.help.clone(),
            });
        }
    }
}

/// Simulated references that are behind the search for them.
fn references(script: &Script, all: &mut Vec<Warning>) {
    for axis in &script.axes {
        let homes = script.blocks.iter().any(|block| block.block.name == "MC_Home");
        if axis.config.modulo.is_some() {
            continue;
        }
        let behind = advice::reference_behind(
            &axis.name,
            axis.config.position,
            &axis.config.homing,
            axis.drive.switches(),
        );
        if let Some(message) = behind.filter(|_| homes) {
            all.push(Warning {
                kind: WarningKind::Note,
                path: format!("axes.{}", axis.name),
                span: axis.place.span,
                message,
                help: "turn `direction` of its `homing`, or move the switch, unless it is to turn at a limit switch"
                    .to_owned(),
            });
        }
    }
}

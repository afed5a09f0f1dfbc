//! `standstill test`: scripts as tests of their claims and goldens.

use crate::apart;
use crate::args::{Golden, SCRIPTS, TestArguments};
use crate::cores;
use crate::coverage::Coverage;
use crate::exit::{Exit, Failure, complain, go_on};
use crate::failing::Pages;
use crate::json::Object;
use crate::junit::{self, Case, Ending};
use crate::limit;
use crate::mutate::mutate;
use crate::outcome;
use crate::progress::Progress;
use crate::report::load;
use crate::saved::Saved;
use standstill_script::golden::{Mode, Standing};
use standstill_script::suite::{self, Allowed, Report, SuiteError};
use standstill_script::{Warnings, judge_recording};
use standstill_trace::compare::{Tolerance, Yardstick};
use std::collections::BTreeSet;
use std::fmt;
use std::fs;
use std::io::{self, BufRead, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::thread;
use std::time::{Duration, Instant};

/// The arguments, and what follows from them.
#[derive(Clone, Copy, Debug)]
struct Wish<'a> {
    given: &'a TestArguments,
    /// Scripts, and folders of them.
    paths: &'a [PathBuf],
    /// How exactly a run must agree with its golden; not at all if absent.
    yardstick: Option<Yardstick>,
    /// Permissions of scripts beyond those of any script.
    allowed: &'a Allowed,
}

impl Wish<'_> {
    fn scripts(&self) -> Result<Vec<PathBuf>, Failure> {
        found(self.paths, self.given.word.as_deref())
    }
}

/// Does with the scripts what the arguments ask for.
pub fn test(given: &TestArguments, out: &mut dyn Write) -> Result<Exit, Failure> {
    let paths = &where_scripts_are(&given.paths);
    let allowed = &given.outside.allowed();
    if given.list {
        return list(paths, given.word.as_deref(), out);
    }
    if given.mutate {
        let scripts = found(paths, given.word.as_deref())?;
        return mutate(&scripts, given.seed, allowed, given.json, out);
    }
    let wish = Wish {
        given,
        paths,
        yardstick: yardstick(given.golden, given.abs, given.rel)?,
        allowed,
    };
    if given.watch {
        return watch(wish, out);
    }
    if given.review {
        return review(wish, &mut io::stdin().lock(), out);
    }
    judge(wish, out)
}

/// How exactly a run must agree with its golden, from the arguments.
fn yardstick(golden: Golden, abs: Option<f64>, rel: Option<f64>) -> Result<Option<Yardstick>, Failure> {
    let tolerance = Tolerance::default();
    match (golden, abs.or(rel)) {
        (Golden::Events, _) => Ok(Some(Yardstick::Events(Tolerance {
            absolute: abs.unwrap_or(tolerance.absolute),
            relative: rel.unwrap_or(tolerance.relative),
        }))),
        (Golden::Exact, None) => Ok(Some(Yardstick::Exact)),
        (Golden::None, None) => Ok(None),
        (Golden::Exact | Golden::None, Some(_)) => Err(Failure::usage(
            "--abs and --rel are for --golden events: to the bit there is no tolerance",
        )),
    }
}

/// Judges all scripts at the paths, in sorted order, and reports goldens without a script.
fn judge(wish: Wish<'_>, out: &mut dyn Write) -> Result<Exit, Failure> {
    if !wish.given.json {
        return told(wish, &BTreeSet::new(), out).map(|tally| tally.exit());
    }
    let tally = told(wish, &BTreeSet::new(), &mut io::sink())?;
    let exit = tally.exit();
    writeln!(out, "{}", tally.json(exit))?;
    Ok(exit)
}

/// Prints the paths of the scripts.
fn list(paths: &[PathBuf], word: Option<&str>, out: &mut dyn Write) -> Result<Exit, Failure> {
    for script in found(paths, word)? {
        writeln!(out, "{}", suite::shown(&script))?;
    }
    Ok(Exit::Passed)
}

/// Time between two checks for saved files.
const LOOK_EVERY: Duration = Duration::from_millis(200);

/// For every golden that is missing or differs, if all claims hold: asks whether to replace it by the run. If there
/// is no answer, this one and all later ones are not changed.
fn review(wish: Wish<'_>, answers: &mut dyn BufRead, out: &mut dyn Write) -> Result<Exit, Failure> {
    let Some(yardstick) = wish.yardstick else {
        return Err(Failure::usage(
            "--review is of goldens, and --golden none asks for none",
        ));
    };
    let accept = Mode::from_environment(true).map_err(|error| Failure::usage(&error.to_string()))?;
    let mut tally = Tally::default();
    let scripts = wish.scripts()?;
    let mut unasked = false;
    for script in &scripts {
        let name = suite::shown(script);
        limit::doing(name.clone());
        let judge = |mode| suite::judge_file(script, mode, yardstick, wish.allowed, |_| {});
        let mut judged = judge(Mode::Check);
        if let Ok(report) = &judged
            && report.outcome.passed()
            && !report.passed()
            && !unasked
        {
            writeln!(out, "differs   {name}")?;
            for line in report.to_string().lines() {
                writeln!(out, "    {line}")?;
            }
            out.flush()?;
            let answer = answer(answers);
            unasked = answer.is_none();
            if answer == Some(true) {
                judged = judge(accept);
            }
        }
        let (ending, text) = match judged {
            Ok(report) => tally.judged(&name, &report, out)?,
            Err(error) => tally.broken(&name, error.into(), out)?,
        };
        tally.add(name, ending, text, Duration::ZERO);
    }
    write!(out, "{tally}")?;
    Ok(tally.exit())
}

/// Yes or no. Any other answer ends the review.
fn answer(answers: &mut dyn BufRead) -> Option<bool> {
    loop {
        complain("take it as the golden? yes, no, or quit");
        let mut line = String::new();
        if answers.read_line(&mut line).is_err() || line.is_empty() {
            return None;
        }
        match line.trim().to_lowercase().as_str() {
            "y" | "yes" => return Some(true),
            "n" | "no" => return Some(false),
            "q" | "quit" => return None,
            _ => {}
        }
    }
}

/// Judges the scripts, and again whenever a file was saved: failed ones first. It ends when its output has no
/// reader.
fn watch(wish: Wish<'_>, out: &mut dyn Write) -> Result<Exit, Failure> {
    let mut failed = BTreeSet::new();
    loop {
        let before = Saved::below(wish.paths, wish.given.report.as_deref());
        match told(wish, &failed, out) {
            Ok(tally) => failed = tally.bad().map(|case| case.file.clone()).collect(),
            // For example a folder that is empty for now.
            Err(failure @ Failure::Told(..)) => drop(go_on(Err(failure), out)?),
            Err(failure) => return Err(failure),
        }
        out.flush()?;
        complain("watching; tests run again when a file is saved");
        while Saved::below(wish.paths, wish.given.report.as_deref()) == before {
            thread::sleep(LOOK_EVERY);
        }
        writeln!(out)?;
    }
}

/// Judges the requested scripts, those named `first` before the others, and prints the results as text.
fn told(wish: Wish<'_>, first: &BTreeSet<String>, out: &mut dyn Write) -> Result<Tally, Failure> {
    if wish.given.accept && wish.yardstick.is_none() {
        return Err(Failure::usage(
            "--accept writes goldens, and --golden none asks for none",
        ));
    }
    let writes = [
        apart::written("--junit", wish.given.junit.as_deref()),
        apart::written("--coverage", wish.given.coverage.as_deref()),
    ];
    let reads = wish
        .paths
        .iter()
        .map(PathBuf::as_path)
        .chain(wish.given.recording.as_deref());
    apart::checked(&writes.concat(), reads)?;
    let tally = match wish.given.recording.as_deref() {
        Some(recording) => on_recording(wish, recording, out)?,
        None => judged(wish, first, out)?,
    };
    write!(out, "{tally}")?;
    if let Some(path) = wish.given.junit.as_deref() {
        junit::save(&tally.cases, path)?;
    }
    if let Some(path) = wish.given.coverage.as_deref() {
        limit::doing("counting what the scripts execute");
        let coverage = Coverage::of(&wish.scripts()?, wish.allowed);
        writeln!(out, "{}", coverage.save(path)?)?;
        if let Some(folder) = wish.given.report.as_deref() {
            fs::create_dir_all(folder).map_err(|error| Failure::io(&suite::shown(folder), &error))?;
            writeln!(out, "    report: {}", coverage.page(folder)?)?;
        }
    }
    Ok(tally)
}

fn judged(wish: Wish<'_>, first: &BTreeSet<String>, out: &mut dyn Write) -> Result<Tally, Failure> {
    let mode =
        Mode::from_environment(wish.given.accept).map_err(|error| Failure::usage(&error.to_string()))?;
    let mut scripts = wish.scripts()?;
    // The sort is stable.
    scripts.sort_by_key(|script| !first.contains(&suite::shown(script)));
    let mut pages = wish.given.report.as_deref().map(Pages::new).transpose()?;
    let mut tally = Tally {
        strict: wish.given.strict,
        json: wish.given.json,
        ..Tally::default()
    };
    let mut progress = Progress::new(true);
    let scans: Vec<_> = scripts.iter().map(|_| AtomicU64::new(0)).collect();
    let judge = |index: usize| {
        let begin = Instant::now();
        let told = |count| scans[index].store(count, Ordering::Relaxed);
        let judged = suite::judge_file(&scripts[index], mode, wish.yardstick, wish.allowed, told);
        (judged, begin.elapsed())
    };
    let take = |index: usize, judged: Option<(Result<Report, SuiteError>, Duration)>| {
        let script = &scripts[index];
        let name = suite::shown(script);
        let Some((judged, took)) = judged else {
            let mut place = format!("{} of {}{}: {name}", index + 1, scripts.len(), tally.trouble());
            match scans[index].load(Ordering::Relaxed) {
                0 => {}
                count => place.push_str(&format!(", {count} scans")),
            }
            limit::doing(place.clone());
            progress.show(|| place);
            return Ok(());
        };
        progress.clear();
        let (ending, text) = match judged {
            Ok(report) => {
                let judged = tally.judged(&name, &report, out)?;
                if let (Ending::Failed, Some(pages)) = (judged.0, &mut pages) {
                    writeln!(
                        out,
                        "    report: {}",
                        pages.write(script, &report, wish.yardstick)?
                    )?;
                }
                judged
            }
            Err(error) => tally.broken(&name, error.into(), out)?,
        };
        tally.add(name, ending, text, took);
        Ok(())
    };
    cores::in_order(scripts.len(), threads(&wish, &scripts), judge, take)?;
    let folders = wish.paths.iter().filter(|path| path.is_dir());
    // For single scripts, other files are not reported.
    for folder in folders.filter(|_| wish.given.word.is_none()) {
        tally.orphans(&suite::orphans(folder)?, out)?;
        mention(folder)?;
    }
    Ok(tally)
}

/// The number of threads that judge the scripts.
fn threads(wish: &Wish<'_>, scripts: &[PathBuf]) -> usize {
    // A script that is named twice writes its golden twice, so one run must follow the other.
    let files: BTreeSet<_> = scripts.iter().map(|path| path.canonicalize().ok()).collect();
    if files.len() < scripts.len() {
        return 1;
    }
    wish.given.threads.map_or_else(cores::processors, usize::from)
}

/// Reports files that look like scripts but have another name.
fn mention(folder: &Path) -> Result<(), Failure> {
    for file in suite::overlooked(folder)? {
        let (name, ending) = (suite::shown(&file), suite::EXTENSION);
        complain(&format!(
            "note: {name} looks like a scan script, but is not tested: its name does not end in {ending}"
        ));
    }
    Ok(())
}

/// Judges the claims of one script on a recording.
fn on_recording(wish: Wish<'_>, recording: &Path, out: &mut dyn Write) -> Result<Tally, Failure> {
    let [script] = wish.paths else {
        return Err(Failure::usage("--recording is judged by one script"));
    };
    if script.is_dir() {
        let name = suite::shown(script);
        let message = format!("{name}: --recording is judged by one script, and this is a folder");
        return Err(Failure::usage(&message));
    }
    limit::doing(suite::shown(script));
    let begin = Instant::now();
    let (judge, _) = suite::read_file(script, &[], wish.allowed)?;
    let outcome = judge_recording(&judge, load(recording)?.1.trace).map_err(|error| {
        Failure::Told(
            Exit::BadInput,
            format!("error: {}: {error}", suite::shown(recording)),
        )
    })?;
    // This trace has no golden, so none is missing. The behaviour of the script is not the recorded one.
    let report = Report {
        why: outcome.why.clone(),
        outcome,
        golden: Standing::Unasked,
        warnings: Warnings::default(),
    };
    let name = suite::shown(script);
    let mut tally = Tally {
        json: wish.given.json,
        ..Tally::default()
    };
    let shown = format!("{name} on {}", suite::shown(recording));
    let (ending, text) = tally.judged(&shown, &report, out)?;
    tally.add(name, ending, text, begin.elapsed());
    Ok(tally)
}

/// The paths. Without any, `scan-tests`, or the working folder if there is none.
pub fn where_scripts_are(paths: &[PathBuf]) -> Vec<PathBuf> {
    if !paths.is_empty() {
        return paths.to_vec();
    }
    let folder = Path::new(SCRIPTS);
    let here = if folder.is_dir() { folder } else { Path::new(".") };
    vec![here.to_owned()]
}

/// All scripts at the paths whose own paths contain `word`, without regard to case.
fn found(paths: &[PathBuf], word: Option<&str>) -> Result<Vec<PathBuf>, Failure> {
    let mut all = Vec::new();
    for path in paths {
        limit::doing(format!("looking for scripts in {}", suite::shown(path)));
        let scripts = suite::find(path)?;
        if scripts.is_empty() {
            if path.is_dir() {
                mention(path)?;
            }
            let message = format!(
                "{}: there is no {} file in it; `standstill init` writes a first one",
                suite::shown(path),
                suite::EXTENSION
            );
            return Err(Failure::usage(&message));
        }
        all.extend(scripts);
    }
    let Some(word) = word else { return Ok(all) };
    let count = all.len();
    let wanted = word.to_lowercase();
    all.retain(|script| suite::shown(script).to_lowercase().contains(&wanted));
    if all.is_empty() {
        let message =
            format!("-k {word}: none of {count} scripts has that in its path; `--list` prints them");
        return Err(Failure::usage(&message));
    }
    Ok(all)
}

/// The results of the scripts so far.
#[derive(Debug, Default)]
struct Tally {
    passed: usize,
    accepted: usize,
    failed: usize,
    /// The statuses of scripts that could not be judged.
    broken: Vec<Exit>,
    orphans: usize,
    /// Everything that was judged, in order.
    cases: Vec<Case>,
    /// The same as JSON.
    told: Vec<Object>,
    /// Warnings fail.
    strict: bool,
    /// The output is JSON; its data are collected only then.
    json: bool,
}

impl Tally {
    fn add(&mut self, file: String, ending: Ending, text: String, took: Duration) {
        let case = Case {
            file,
            ending,
            text,
            took,
        };
        self.cases.push(case);
    }

    fn judged(
        &mut self,
        name: &str,
        report: &Report,
        out: &mut dyn Write,
    ) -> Result<(Ending, String), Failure> {
        let passed = report.passed() && !(self.strict && report.warnings.count());
        let (count, word) = match (&report.golden, passed) {
            (_, false) | (Standing::Failed(_), _) => (&mut self.failed, "FAILED"),
            (Standing::Accepted, true) => (&mut self.accepted, "accepted"),
            (Standing::Same | Standing::Close(_) | Standing::Old(_) | Standing::Unasked, true) => {
                (&mut self.passed, "ok")
            }
        };
        if self.json {
            self.told.push(outcome::judged(name, word, report));
        }
        *count += 1;
        writeln!(out, "{word:<8}  {name}")?;
        if let (Standing::Close(Some(how)), true) = (&report.golden, report.passed()) {
            writeln!(out, "    {how}")?;
        }
        if let (Standing::Old(note), true) = (&report.golden, report.passed()) {
            writeln!(out, "    {note}")?;
        }
        let mut text = report.to_string();
        if self.strict {
            text.extend(report.warnings.lines().map(|line| format!("{line}\n")));
        }
        for line in text.lines() {
            writeln!(out, "    {line}")?;
        }
        if !report.warnings.all.is_empty() {
            // Text printed before must come before it.
            out.flush()?;
            complain(report.warnings.to_string().trim_end());
        }
        let ending = if passed { Ending::Passed } else { Ending::Failed };
        Ok((ending, text))
    }

    fn broken(
        &mut self,
        name: &str,
        failure: Failure,
        out: &mut dyn Write,
    ) -> Result<(Ending, String), Failure> {
        let text = match &failure {
            Failure::Told(_, text) => text.clone(),
            Failure::Output(_) => String::new(),
        };
        writeln!(out, "BROKEN    {name}")?;
        self.told.push(outcome::broken(name, &text));
        self.broken.push(go_on(Err(failure), out)?);
        Ok((Ending::Broken, text))
    }

    fn orphans(&mut self, orphans: &[PathBuf], out: &mut dyn Write) -> Result<(), Failure> {
        self.orphans += orphans.len();
        for orphan in orphans {
            let (name, text) = (suite::shown(orphan), "its script is not there any more");
            writeln!(out, "ORPHAN    {name}\n    {text}")?;
            self.told.push(outcome::orphaned(&name));
            self.add(name, Ending::Failed, text.to_owned(), Duration::ZERO);
        }
        Ok(())
    }

    /// The cases that did not pass.
    fn bad(&self) -> impl Iterator<Item = &Case> + Clone {
        self.cases.iter().filter(|case| case.ending != Ending::Passed)
    }

    /// The failures so far, in a few words for the line of progress.
    fn trouble(&self) -> String {
        match self.failed + self.broken.len() {
            0 => String::new(),
            count => format!(", {count} failed"),
        }
    }

    /// The whole outcome as one JSON object.
    fn json(&self, exit: Exit) -> String {
        let counts = [
            ("passed", self.passed),
            ("accepted", self.accepted),
            ("failed", self.failed),
            ("broken", self.broken.len()),
            ("orphaned", self.orphans),
        ];
        outcome::whole("test", exit, &counts, &self.told)
    }

    fn exit(&self) -> Exit {
        let judged = Exit::of(self.failed == 0 && self.orphans == 0);
        self.broken.iter().copied().fold(judged, Exit::max)
    }
}

/// The failures by name, if there are several scripts, then the counts: the end of a long list is what one sees.
impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            passed,
            accepted,
            failed,
            broken,
            orphans,
            cases,
            ..
        } = self;
        let bad = self.bad();
        if cases.len() > 1 && bad.clone().next().is_some() {
            writeln!(f, "\nto look at")?;
            for case in bad {
                writeln!(f, "  {}", case.file)?;
            }
        }
        let scripts = passed + accepted + failed + broken.len();
        let counts = [
            (*passed, "passed"),
            (*accepted, "accepted"),
            (*failed, "failed"),
            (broken.len(), "broken"),
            (*orphans, "orphaned"),
        ];
        let counts = counts.iter().filter(|(count, _)| *count > 0);
        let counts: Vec<_> = counts.map(|(count, what)| format!("{count} {what}")).collect();
        let plural = if scripts == 1 { "" } else { "s" };
        writeln!(f, "{scripts} script{plural}: {}", counts.join(", "))
    }
}

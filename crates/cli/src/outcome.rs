//! The output of commands with `--json`: the contents of their text, for programs.

use crate::exit::Exit;
use crate::json::{Object, list, string};
use standstill_script::golden::Standing;
use standstill_script::suite::Report;
use standstill_script::{Failure, Outcome, Reason, Verdict, Warnings};
use standstill_trace::compare::SignalDifference;
use standstill_trace::digest;
use standstill_trace::story::Story;

/// The schema of the output.
pub fn schema() -> String {
    include_str!("outcome.schema.json").to_owned()
}

/// The common begin of every outcome.
pub fn begun(command: &str, exit: Exit) -> Object {
    Object::new()
        .with("standstill_json", "1")
        .with("command", string(command))
        .with("passed", (exit == Exit::Passed).to_string())
        .with("status", (exit as u8).to_string())
}

/// The answer of a command that could not do its work, with the text of standard error.
pub fn refused(command: &str, exit: Exit, text: &str) -> String {
    begun(command, exit).with("error", string(text.trim_end())).text()
}

/// The difference of two traces with these names.
pub fn explained(exit: Exit, (expected, found): (&str, &str), story: Option<&Story>) -> String {
    begun("explain", exit)
        .with("expected", string(expected))
        .with("found", string(found))
        .with_some("story", story.map(told_story))
        .text()
}

fn told_story(story: &Story) -> String {
    let difference = &story.difference;
    let (expected, found) = difference.scans;
    let rows = Object::new()
        .with("expected", expected.to_string())
        .with("found", found.to_string());
    let first = difference.first.as_ref().map(|first| {
        Object::new()
            .with("scan", first.scan.to_string())
            .with("signals", list(first.signals.iter().map(signal)))
            .text()
    });
    let extent = story.extent.as_ref().map(|extent| {
        Object::new()
            .with("scans", extent.scans.to_string())
            .with("of", extent.of.to_string())
            .with("last", extent.last.to_string())
            .text()
    });
    let line = story.line.as_ref().map(|line| {
        Object::new()
            .with("scan", line.scan.to_string())
            .with("signal", string(&line.signal))
            .with("expected", string(&line.expected))
            .with("found", string(&line.found))
            .with("stayed", line.stayed.to_string())
            .with("places", strings(&line.places))
            .text()
    });
    let causes = story.causes.iter().map(|cause| string(&cause.to_string()));
    Object::new()
        .with("rows", rows.text())
        .with("only_expected", strings(&difference.only_expected))
        .with("only_found", strings(&difference.only_actual))
        .with_some("first", first)
        .with_some("extent", extent)
        .with_some("line", line)
        .with("causes", list(causes))
        .with("text", string(story.to_string().trim_end()))
        .text()
}

fn strings(texts: &[String]) -> String {
    list(texts.iter().map(|text| string(text)))
}

fn signal(signal: &SignalDifference) -> String {
    Object::new()
        .with("signal", string(&signal.name))
        .with("expected", string(&signal.expected))
        .with("found", string(&signal.actual))
        .with_some("ulps", signal.ulps.map(|ulps| ulps.to_string()))
        .text()
}

/// The whole outcome as one object.
pub fn whole(command: &str, exit: Exit, counts: &[(&str, usize)], scripts: &[Object]) -> String {
    let all = counts.iter().fold(Object::new(), |all, (what, count)| {
        all.with(what, count.to_string())
    });
    begun(command, exit)
        .with_some("counts", (!counts.is_empty()).then(|| all.text()))
        .with("scripts", list(scripts.iter().cloned().map(Object::text)))
        .text()
}

/// A script that was run.
pub fn run(name: &str, outcome: &Outcome, digest: u64, warnings: &Warnings) -> Object {
    let verdict = if outcome.passed() { "passed" } else { "failed" };
    ran(name, verdict, (outcome, digest), &outcome.why, warnings)
}

/// A script that was judged; `word` is the one in the text.
pub fn judged(name: &str, word: &str, report: &Report) -> Object {
    let verdict = match word {
        "ok" => "passed",
        "accepted" => "accepted",
        _ => "failed",
    };
    let digest = digest::whole(&report.outcome.trace);
    let (golden, text) = match &report.golden {
        Standing::Same => ("same", None),
        Standing::Close(how) => ("close", how.as_ref().map(ToString::to_string)),
        Standing::Old(note) => ("old", Some(note.clone())),
        Standing::Unasked => ("none", None),
        Standing::Accepted => ("accepted", None),
        Standing::Failed(what) => ("failed", Some(what.clone())),
    };
    let golden = Object::new()
        .with("verdict", string(golden))
        .with_some("text", text.map(|text| string(text.trim_end())));
    let outcome = (&report.outcome, digest);
    ran(name, verdict, outcome, &report.why, &report.warnings).with("golden", golden.text())
}

/// A script that could not be judged, and the reason.
pub fn broken(name: &str, text: &str) -> Object {
    named(name, "broken").with("error", string(text.trim_end()))
}

/// A golden whose script no longer exists.
pub fn orphaned(name: &str) -> Object {
    named(name, "orphaned")
}

/// The common begin of every script.
pub fn named(name: &str, verdict: &str) -> Object {
    Object::new()
        .with("script", string(name))
        .with("verdict", string(verdict))
}

fn ran(
    name: &str,
    verdict: &str,
    (outcome, digest): (&Outcome, u64),
    why: &[Reason],
    warnings: &Warnings,
) -> Object {
    named(name, verdict)
        .with("title", string(&outcome.trace.header().title))
        .with("scans", outcome.trace.scans().to_string())
        .with("digest", string(&format!("{digest:016x}")))
        .with("claims", list(outcome.verdicts.iter().map(claim)))
        .with("why", list(why.iter().map(reason)))
        .with("warnings", list(told(warnings)))
}

fn claim(verdict: &Verdict) -> String {
    let scans = verdict
        .scans
        .map(|scans| list(scans.map(|scan| scan.to_string())));
    let failures = (!verdict.passed()).then(|| list(verdict.failures.iter().map(failure)));
    Object::new()
        .with("path", string(&verdict.path))
        .with("text", string(&verdict.says))
        .with("passed", verdict.passed().to_string())
        .with_some("scans", scans)
        .with_some("held", verdict.held.map(|held| held.to_string()))
        .with_some("failures", failures)
        .text()
}

fn failure(failure: &Failure) -> String {
    Object::new()
        .with("path", string(&failure.path))
        .with_some("scan", failure.scan.map(|scan| scan.to_string()))
        .with("text", string(&failure.text))
        .text()
}

fn reason(reason: &Reason) -> String {
    Object::new()
        .with_some("scan", reason.scan.map(|scan| scan.to_string()))
        .with("text", string(&reason.text))
        .with("claims", strings(&reason.claims))
        .text()
}

fn told(warnings: &Warnings) -> impl Iterator<Item = String> + '_ {
    warnings.all.iter().map(|warning| {
        let (file, line, column) = warnings.place(warning);
        Object::new()
            .with("kind", string(warning.kind.name()))
            .with("path", string(&warning.path))
            .with("file", string(file))
            .with("line", line.to_string())
            .with("column", column.to_string())
            .with("text", string(&warning.message))
            .text()
    })
}

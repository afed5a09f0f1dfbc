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
    let mut object = begun("explain", exit);
    object = object.with("expected", string(expected));
    object = object.with("found", string(found));
    if let Some(story) = story {
        object = object.with("story", told_story(story));
    }
    object.text()
}

fn told_story(story: &Story) -> String {
    let difference = &story.difference;
    let (expected, found) = difference.scans;
    let names = |names: &[String]| list(names.iter().map(|name| string(name)));
    let rows = Object::new()
        .with("expected", expected.to_string())
        .with("found", found.to_string());
    let mut object = Object::new()
        .with("rows", rows.text())
        .with("only_expected", names(&difference.only_expected))
        .with("only_found", names(&difference.only_actual));
    if let Some(first) = &difference.first {
        let part = Object::new()
            .with("scan", first.scan.to_string())
            .with("signals", list(first.signals.iter().map(signal)));
        object = object.with("first", part.text());
    }
    if let Some(extent) = &story.extent {
        let part = Object::new()
            .with("scans", extent.scans.to_string())
            .with("of", extent.of.to_string())
            .with("last", extent.last.to_string());
        object = object.with("extent", part.text());
    }
    if let Some(line) = &story.line {
        let part = Object::new()
            .with("scan", line.scan.to_string())
            .with("signal", string(&line.signal))
            .with("expected", string(&line.expected))
            .with("found", string(&line.found))
            .with("stayed", line.stayed.to_string())
            .with("places", names(&line.places));
        object = object.with("line", part.text());
    }
    let causes = story.causes.iter().map(|cause| string(&cause.to_string()));
    object
        .with("causes", list(causes))
        .with("text", string(story.to_string().trim_end()))
        .text()
}

fn signal(signal: &SignalDifference) -> String {
    let mut object = Object::new()
        .with("signal", string(&signal.name))
        .with("expected", string(&signal.expected))
        .with("found", string(&signal.actual));
    if let Some(ulps) = signal.ulps {
        object = object.with("ulps", ulps.to_string());
    }
    object.text()
}

/// The whole outcome as one object.
pub fn whole(command: &str, exit: Exit, counts: &[(&str, usize)], scripts: &[Object]) -> String {
    let mut object = begun(command, exit);
    if !counts.is_empty() {
        let mut all = Object::new();
        for (what, count) in counts {
            all = all.with(what, count.to_string());
        }
        object = object.with("counts", all.text());
    }
    object = object.with("scripts", list(scripts.iter().cloned().map(Object::text)));
    object.text()
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
    let mut object = ran(
        name,
        verdict,
        (&report.outcome, digest),
        &report.why,
        &report.warnings,
    );
    let (golden, text) = match &report.golden {
        Standing::Same => ("same", None),
        Standing::Close(how) => ("close", how.as_ref().map(ToString::to_string)),
        Standing::Old(note) => ("old", Some(note.clone())),
        Standing::Unasked => ("none", None),
        Standing::Accepted => ("accepted", None),
        Standing::Failed(what) => ("failed", Some(what.clone())),
    };
    let mut standing = Object::new();
    standing = standing.with("verdict", string(golden));
    if let Some(text) = text {
        standing = standing.with("text", string(text.trim_end()));
    }
    object = object.with("golden", standing.text());
    object
}

/// A script that could not be judged, and the reason.
pub fn broken(name: &str, text: &str) -> Object {
    let mut object = named(name, "broken");
    object = object.with("error", string(text.trim_end()));
    object
}

/// A golden whose script no longer exists.
pub fn orphaned(name: &str) -> Object {
    named(name, "orphaned")
}

/// The common begin of every script.
pub fn named(name: &str, verdict: &str) -> Object {
    let mut object = Object::new();
    object = object.with("script", string(name));
    object = object.with("verdict", string(verdict));
    object
}

fn ran(
    name: &str,
    verdict: &str,
    (outcome, digest): (&Outcome, u64),
    why: &[Reason],
    warnings: &Warnings,
) -> Object {
    let mut object = named(name, verdict);
    object = object.with("title", string(&outcome.trace.header().title));
    object = object.with("scans", outcome.trace.scans().to_string());
    object = object.with("digest", string(&format!("{digest:016x}")));
    object = object.with("claims", list(outcome.verdicts.iter().map(claim)));
    object = object.with("why", list(why.iter().map(reason)));
    object = object.with("warnings", list(told(warnings)));
    object
}

fn claim(verdict: &Verdict) -> String {
    let mut object = Object::new();
    object = object.with("path", string(&verdict.path));
    object = object.with("text", string(&verdict.says));
    object = object.with("passed", verdict.passed().to_string());
    if let Some(scans) = verdict.scans {
        object = object.with("scans", list(scans.map(|scan| scan.to_string())));
    }
    if let Some(held) = verdict.held {
        object = object.with("held", held.to_string());
    }
    if !verdict.passed() {
        object = object.with("failures", list(verdict.failures.iter().map(failure)));
    }
    object.text()
}

fn failure(failure: &Failure) -> String {
    let mut object = Object::new();
    object = object.with("path", string(&failure.path));
    if let Some(scan) = failure.scan {
        object = object.with("scan", scan.to_string());
    }
    object = object.with("text", string(&failure.text));
    object.text()
}

fn reason(reason: &Reason) -> String {
    let mut object = Object::new();
    if let Some(scan) = reason.scan {
        object = object.with("scan", scan.to_string());
    }
    object = object.with("text", string(&reason.text));
    object = object.with("claims", list(reason.claims.iter().map(|path| string(path))));
    object.text()
}

fn told(warnings: &Warnings) -> impl Iterator<Item = String> + '_ {
    warnings.all.iter().map(|warning| {
        let (file, line, column) = warnings.place(warning);
        let mut object = Object::new();
        object = object.with("kind", string(warning.kind.name()));
        object = object.with("path", string(&warning.path));
        object = object.with("file", string(file));
        object = object.with("line", line.to_string());
        object = object.with("column", column.to_string());
        object = object.with("text", string(&warning.message));
        object.text()
    })
}

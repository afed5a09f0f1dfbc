//! The texts of the page: facts, sources, failing claims. All of it is ready markup.

use crate::{Mark, Source};
use standstill_picture::escaped;
use standstill_trace::{ClaimVerdict, Trace, time_literal};
use std::fmt::Write;

/// The letters of a page's traces.
const LETTERS: [&str; crate::TRACES_MAX] = ["A", "B", "C", "D", "E", "F"];

/// Largest number of failing claims that are shown in full.
const FAILURES_TOLD: usize = 12;

/// The title of the page.
pub fn title(sources: &[Source<'_>]) -> String {
    match sources {
        [source] => own_title(source).to_owned(),
        [first, ..] if sources.iter().all(|other| own_title(other) == own_title(first)) => {
            format!("{}: {} traces", own_title(first), sources.len())
        }
        _ => format!("{} traces over each other", sources.len()),
    }
}

fn own_title<'a>(source: &Source<'a>) -> &'a str {
    match source.trace.header().title.as_str() {
        "" => source.name,
        title => title,
    }
}

/// The line below the title: cycle, length, claims.
pub fn facts(sources: &[Source<'_>]) -> String {
    let Some(first) = sources.first() else {
        return String::new();
    };
    let header = first.trace.header();
    let mut facts = vec![format!("cycle {}", time_literal(header.cycle_ns))];
    if let [source] = sources {
        facts.push(format!(
            "{} scans, {}",
            source.trace.scans(),
            length(source.trace)
        ));
    }
    let mut text: String = facts
        .iter()
        .map(|fact| format!("<span>{}</span>", escaped(fact)))
        .collect();
    let claims = sources.iter().flat_map(|source| &source.trace.header().claims);
    let (held, all) = claims.fold((0, 0), |(held, all), claim| {
        (held + usize::from(claim.verdict == ClaimVerdict::Passed), all + 1)
    });
    if all > 0 {
        let class = if held == all { "good" } else { "bad" };
        // Writing to a String cannot fail, here and below.
        let _ = write!(text, "<span class=\"{class}\">{held} of {all} claims hold</span>");
    }
    if let [source] = sources {
        let _ = write!(text, "<span>{}</span>", escaped(source.name));
    }
    text
}

/// The exact length of a run.
fn length(trace: &Trace) -> String {
    let ns = trace.time_ns(trace.scans());
    let rest = format!("{:09}", ns % 1_000_000_000);
    let rest = rest.trim_end_matches('0');
    match rest {
        "" => format!("{} s", ns / 1_000_000_000),
        rest => format!("{}.{rest} s", ns / 1_000_000_000),
    }
}

/// The list of traces if there are several, and the missing parts of their files.
pub fn sources(sources: &[Source<'_>]) -> String {
    let mut text = String::new();
    if sources.len() > 1 {
        text.push_str("<ul class=\"sources\">\n");
        for ((at, source), letter) in sources.iter().enumerate().zip(LETTERS) {
            let _ = writeln!(
                text,
                "<li class=\"t{at}\"><b>{letter}</b>{}: {} scans, {}</li>",
                escaped(source.name),
                source.trace.scans(),
                length(source.trace)
            );
        }
        text.push_str("</ul>\n");
        let mut lengths = sources.iter().map(|source| source.trace.scans());
        let first = lengths.next();
        if lengths.any(|scans| Some(scans) != first) {
            text.push_str(
                "<p class=\"lacks\">The traces have different lengths; the shorter ones end earlier.</p>\n",
            );
        }
    }
    for source in sources.iter().filter(|source| !source.lacks.is_empty()) {
        let _ = writeln!(
            text,
            "<p class=\"lacks\">{} lacks {}.</p>",
            escaped(source.name),
            escaped(&source.lacks.join(", "))
        );
    }
    text
}

/// The places of interest, each a button that moves there.
pub fn marks(marks: &[Mark]) -> String {
    let mut text = String::new();
    for mark in marks {
        let title = escaped(&mark.title);
        let title = match mark.scan {
            Some(scan) => {
                format!("<button type=\"button\" class=\"goto\" data-scan=\"{scan}\">{title}</button>")
            }
            None => format!("<b>{title}</b>"),
        };
        let _ = writeln!(
            text,
            "<div class=\"difference\">{title}<pre>{}</pre></div>",
            escaped(mark.text.trim_end())
        );
    }
    text
}

/// The claims that failed, with the actual values.
pub fn failures(sources: &[Source<'_>]) -> String {
    let mut told = Vec::new();
    for (source, letter) in sources.iter().zip(LETTERS) {
        let whose = if sources.len() > 1 {
            format!("{letter}: ")
        } else {
            String::new()
        };
        let claims = source.trace.header().claims.iter();
        for claim in claims.filter(|claim| claim.verdict == ClaimVerdict::Failed) {
            if claim.failures.is_empty() {
                told.push(format!("{whose}{}: {}", claim.path, claim.text));
            }
            let reasons = claim.failures.iter();
            told.extend(reasons.map(|failure| format!("{whose}{}", failure.text)));
        }
    }
    if told.is_empty() {
        return String::new();
    }
    let mut text = String::from("<ul class=\"failures\">\n");
    for line in told.iter().take(FAILURES_TOLD) {
        let _ = writeln!(text, "<li>{}</li>", escaped(line));
    }
    if let Some(more @ 1..) = told.len().checked_sub(FAILURES_TOLD) {
        let _ = writeln!(text, "<li>and {more} more</li>");
    }
    text.push_str("</ul>\n");
    text
}

/// The last line of the page: the programs that made the traces and the page.
pub fn footer(sources: &[Source<'_>]) -> String {
    let Some(first) = sources.first() else {
        return String::new();
    };
    let header = first.trace.header();
    let mut text = format!("standstill {}", env!("CARGO_PKG_VERSION"));
    if !header.runtime.is_empty() && header.runtime != env!("CARGO_PKG_VERSION") {
        let _ = write!(text, ", trace of {}", escaped(&header.runtime));
    }
    if !header.script_hash.is_empty() && sources.len() == 1 {
        let _ = write!(text, ", script {}", escaped(&header.script_hash));
    }
    if !header.covers.is_empty() && sources.len() == 1 {
        let _ = write!(text, ", covers {}", escaped(&header.covers.join(" ")));
    }
    text.push_str(". Curves are drawn by uPlot, © 2022 Leon Sorokin, MIT licence.");
    text
}

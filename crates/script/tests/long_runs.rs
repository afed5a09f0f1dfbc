//! A run that drops its rows on the way equals a run that keeps them: the same verdicts in the same words, the same
//! digest, extremes and events. A run that keeps few columns has the same verdicts. Half of the claims of every
//! scan test are broken on purpose, so that there are words to compare.

use super::common::{scan_tests, script};
use serde_json::{Value, json};
use standstill_script::model::Script;
use standstill_script::suite::{Allowed, find, read_given, read_text};
use standstill_script::{Ahead, Kept, Outcome, SCANS_MAX, Session, Verdict, keeps_rows};
use standstill_testkit::Random;
use standstill_trace::{Event, EventLog, Extremes, digest, events, extremes_text};
use std::path::Path;

/// The data of a run that can be compared with and without all rows.
#[derive(Debug, PartialEq)]
struct Told {
    verdicts: Vec<Verdict>,
    scans: usize,
    digest: u64,
    extremes: String,
    events: Vec<Event>,
}

fn whole(script: &Script) -> Option<Told> {
    let mut session = Session::new(script).ok()?;
    while session.advance().ok()? {}
    let Outcome { trace, verdicts, .. } = session.finish();
    Some(Told {
        verdicts,
        scans: trace.scans(),
        digest: digest::whole(&trace),
        extremes: extremes_text(&trace),
        events: events(&trace),
    })
}

/// The same, with rows forgotten after every `every` scans.
fn streamed(script: &Script, every: u64) -> Option<Told> {
    streamed_by(script, every, |session, _| session.advance().ok().map(u64::from))
}

/// The same, without idle programs.
fn streamed_far(script: &Script, every: u64) -> Option<Told> {
    streamed_by(script, every, |session, room| {
        match session.advance_far(room).ok()? {
            Ahead::Scans(scans) => Some(scans),
            Ahead::Broken => panic!("nothing in a scan test is unforeseen"),
        }
    })
}

/// `advance` receives the largest number of scans that it may do.
fn streamed_by<'s>(
    script: &'s Script,
    every: u64,
    advance: impl Fn(&mut Session<'s>, u64) -> Option<u64>,
) -> Option<Told> {
    let mut session = Session::long(script).ok()?;
    let mut digest = digest::Whole::default();
    let mut extremes = Extremes::new(session.trace());
    let mut log = EventLog::default();
    let mut events = Vec::new();
    loop {
        let room = every - session.scans() % every;
        if advance(&mut session, room)? == 0 {
            break;
        }
        if session.scans() % every == 0 || session.is_over() {
            digest.look(session.trace());
            extremes.look(session.trace());
            events.extend(log.take(session.trace()));
            session.forget();
        }
    }
    let Outcome { trace, verdicts, .. } = session.finish();
    assert!(
        trace.scans() - trace.first() <= 8 || trace.first() == 0,
        "few rows are kept"
    );
    Some(Told {
        verdicts,
        scans: trace.scans(),
        digest: digest.finish(),
        extremes: extremes.text(),
        events,
    })
}

/// Scans and verdicts of a run that keeps only the columns that claims and steps read, and forgets rows as
/// [`streamed`] does.
fn lean(script: &Script, every: u64) -> Option<(usize, Vec<Verdict>)> {
    let mut session = Session::keeping(script, Kept::read(script, &[])).ok()?;
    while session.advance().ok()? {
        if session.scans() % every == 0 {
            session.forget();
        }
    }
    let Outcome { trace, verdicts, .. } = session.finish();
    Some((trace.scans(), verdicts))
}

/// Inverts truth values and changes numbers, about half of them.
fn breaks(value: &mut Value, random: &mut Random) {
    match value {
        Value::Bool(truth) if random.bits() & 1 == 0 => *truth = !*truth,
        Value::Number(number) => {
            if let Some(scan) = number.as_u64() {
                let by = [0, 0, 1, 7][usize::try_from(random.bits() % 4).unwrap_or(0)];
                *value = json!(scan.saturating_add(by));
            } else if let Some(real) = number.as_f64() {
                *value = json!(if random.bits() & 1 == 0 { real } else { real * 0.9 });
            }
        }
        Value::Array(all) => all.iter_mut().for_each(|value| breaks(value, random)),
        Value::Object(all) => all.values_mut().for_each(|value| breaks(value, random)),
        _ => {}
    }
}

#[test]
fn claims_are_judged_the_same_with_few_rows_at_a_time() {
    let scripts = find(&scan_tests()).unwrap_or_else(|error| panic!("{error}"));
    let (mut passed, mut failed, mut unreadable) = (0, 0, 0);
    let step = standstill_testkit::whole_or(1, 61);
    for (seed, path) in (1..).zip(&scripts).step_by(step) {
        let text = read_text(path).unwrap_or_else(|error| panic!("{error}"));
        let mut random = Random(seed);
        let json: Value = serde_json::from_str(text.trim_start_matches('\u{feff}'))
            .unwrap_or_else(|error| panic!("{}: {error}", path.display()));
        // The result may be unreadable, for example a range that ends before it begins. Other changes are then
        // tried.
        let broken = (0..4).find_map(|_| {
            let mut json = json.clone();
            if let Some(expect) = json.get_mut("expect") {
                breaks(expect, &mut random);
            }
            read_given(&json.to_string(), path, &[], &Allowed::default()).ok()
        });
        let script = broken.unwrap_or_else(|| {
            unreadable += 1;
            read_given(&text, path, &[], &Allowed::default()).unwrap_or_else(|error| panic!("{error}"))
        });
        let every = 1 + random.bits() % 50;
        let expected = whole(&script);
        assert_eq!(
            streamed(&script, every),
            expected,
            "{} by {every}",
            path.display()
        );
        assert_eq!(
            streamed_far(&script, every),
            expected,
            "{} far by {every}",
            path.display()
        );
        assert_eq!(
            lean(&script, every),
            expected.as_ref().map(|told| (told.scans, told.verdicts.clone())),
            "{} with few columns",
            path.display()
        );
        for verdict in expected.iter().flat_map(|told| &told.verdicts) {
            *(if verdict.passed() {
                &mut passed
            } else {
                &mut failed
            }) += 1;
        }
    }
    assert!(
        passed.min(failed) > scripts.len() / step * 5 / 8 && unreadable < scripts.len() / step / 4,
        "{passed} passed, {failed} failed, {unreadable} were not readable"
    );
}

const ENDLESS: &str = r#"{"standstill": 1, "cycle": "T#1ms", "scans": SCANS, "axes": {}, "inputs": {"GO": false}, "blocks": [
    {"name": "t", "type": "TON", "pins": {"IN": {"not": "t.Q"}, "PT": "T#3ms"}}],
  "expect": [EXPECT]}"#;

/// The failures of a claim on a timer that is TRUE in scans 3, 8, 13 .. of 100. They are the same with all rows and
/// with a few.
fn failures(claim: &str) -> Vec<String> {
    let text = ENDLESS.replace("SCANS", "100").replace("EXPECT", claim);
    let script = script(&text);
    let told = whole(&script).expect("it runs");
    for every in [1, 2, 3, 5, 7, 64, 99, 100] {
        assert_eq!(
            streamed(&script, every).as_ref(),
            Some(&told),
            "{claim} by {every}"
        );
    }
    let failures = told.verdicts.iter().flat_map(|verdict| &verdict.failures);
    failures.map(|failure| failure.text.clone()).collect()
}

#[test]
fn what_lies_far_from_a_failing_scan_is_still_found() {
    for (claim, text) in [
        (
            r#"{"at": 50, "that": {"t.ET": 1}}"#,
            "0 at scan 50, expected 1000000.0; it came at 51, 1 later",
        ),
        (
            r#"{"at": 7, "that": {"t.ET": 1}}"#,
            "2000000 at scan 7, expected 1000000.0; it was so at 6, 1 earlier",
        ),
        (
            r#"{"by": 12, "from": 9, "that": {"t.Q": true}}"#,
            "FALSE at scan 12, expected TRUE; it came at 13, 1 later",
        ),
        (
            r#"{"once": {"t.Q": true}, "from": 9, "to": 10}"#,
            "t.Q TRUE did not hold in scans 9 to 10, expected exactly once; it was so at 8, 2 earlier",
        ),
        (
            r#"{"never": {"t.Q": true}, "for": 1}"#,
            "t.Q TRUE held in scans 3 to 3, expected never for 1 scans on end",
        ),
        (
            r#"{"when": {"t.Q": true}, "within": 0, "that": {"GO": true}}"#,
            "t.Q TRUE rose in scan 3, and GO TRUE did not come by scan 3; it was so in no scan; 19 more without an answer",
        ),
        (
            r#"{"after": {"t.Q": true}, "by": 200, "that": {"GO": true}}"#,
            "t.Q TRUE rose in scan 3, and GO TRUE did not come by scan 203; the run ended with scan 99, before that",
        ),
        (
            r#"{"duration": [{"t.Q": true}, {"t.Q": false}], "ge": 30, "each": true}"#,
            "from t.Q TRUE in scan 3 to t.Q FALSE in scan 4 are 1 scans, expected at least 30",
        ),
        (
            r#"{"duration": [{"t.Q": true}, {"GO": true}], "le": 30}"#,
            "t.Q TRUE rose in scan 3, and GO TRUE never rose from there on",
        ),
        (
            r#"{"from": {"when": {"t.Q": true}}, "to": {"when": {"t.Q": false}}, "always": {"GO": true}}"#,
            "FALSE at scan 3, expected TRUE; it was so in no scan; broken in 2 scans: 3, 4",
        ),
        (
            r#"{"count": {"t.Q": true}, "eq": 1}"#,
            "t.Q TRUE rose 20 times, expected exactly 1; it did in 20 scans: 3, 8, 13, 18, 23 .. 98",
        ),
    ] {
        assert_eq!(failures(claim), [text], "{claim}");
    }
}

#[test]
fn only_a_command_that_keeps_no_rows_takes_more_scans() {
    let text = ENDLESS.replace("EXPECT", "");
    let read = |scans: u64, long| {
        let text = text.replace("SCANS", &scans.to_string());
        let allowed = Allowed {
            long,
            ..Allowed::default()
        };
        read_given(&text, Path::new("t.scan.json"), &[], &allowed)
    };
    let said = |scans, long| read(scans, long).expect_err("it is too long").to_string();
    assert!(said(SCANS_MAX, false).contains("`standstill run` keeps no rows"));
    assert!(said(SCANS_MAX + 1, true).contains("are more than the 1000000000 of one run"));
    let long = read(SCANS_MAX, true).expect("a long run");
    assert!(!keeps_rows(&long));
    assert!(keeps_rows(&read(1_000_000, true).expect("a short one")));
}

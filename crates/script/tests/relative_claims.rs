//! Claims relative to events, against an evaluator of their definition that shares no code with the judge: lists of BOOLs and
//! the quantifiers of `docs/claims.md`. Traces and claims are random, from a fixed seed.

use super::common::{failures, outcome};
use standstill_script::{read, run};
use standstill_testkit::Random;

const PAGE: &str = include_str!("../../../docs/claims.md");

/// Whether the claim is fulfilled in a run in which the inputs `a`, `b` and `w` have these values.
fn judged(claim: &str, rows: &[[bool; 3]]) -> bool {
    let steps: Vec<String> = (0..)
        .zip(rows)
        .map(|(scan, [a, b, w])| format!(r#"{{"at": {scan}, "set": {{"a": {a}, "b": {b}, "w": {w}}}}}"#))
        .collect();
    let text = format!(
        r#"{{"standstill": 1, "cycle": "T#1ms", "scans": {}, "axes": {{}}, "blocks": [],
            "inputs": {{"a": false, "b": false, "w": false}}, "steps": [{}], "expect": [{claim}]}}"#,
        rows.len(),
        steps.join(",")
    );
    let script = read(&text, "random.scan.json", &[]).unwrap_or_else(|error| panic!("{claim}\n{error}"));
    run(&script).unwrap().passed()
}

/// `.#..` as rows.
fn course(text: &str) -> Vec<bool> {
    text.chars().map(|mark| mark == '#').collect()
}

#[test]
fn the_courses_of_the_page_are_as_it_says() {
    let mut count = 0;
    for line in PAGE.lines().filter(|line| line.starts_with("| `{")) {
        let cells: Vec<&str> = line.trim_matches(['|', ' ']).split(" | ").collect();
        let [claim, a, b, verdict] = cells.as_slice() else {
            panic!("{line}")
        };
        let plain = |cell: &str| cell.trim_matches('`').to_owned();
        let (a, b) = (course(&plain(a)), course(&plain(b)));
        let rows: Vec<_> = a.iter().zip(&b).map(|(a, b)| [*a, *b, false]).collect();
        assert_eq!(judged(&plain(claim), &rows), verdict.trim() == "holds", "{line}");
        count += 1;
    }
    assert!(count >= 20, "{count}");
}

#[test]
fn the_example_of_the_page_is_a_script() {
    let example = PAGE
        .split("```json")
        .nth(1)
        .and_then(|rest| rest.split("```").next())
        .unwrap();
    let text = format!(
        r#"{{"standstill": 1, "cycle": "T#10ms", "scans": 500, "inputs": {{"go": false}},
            "axes": {{"X": {{"limits": {{"velocity": 50, "acceleration": 200}}, "state": "Standstill"}}}},
            "blocks": [
              {{"name": "out", "type": "MC_MoveAbsolute", "pins": {{"Axis": "X", "Execute": {{"from": "go"}}, "Position": 40, "Velocity": 50}}}},
              {{"name": "home", "type": "MC_MoveAbsolute", "pins": {{"Axis": "X", "Execute": {{"from": "out.Done"}}, "Velocity": 50}}}}],
            "steps": [{{"at": 3, "set": {{"go": true}}}}], {example}}}"#
    );
    let outcome = outcome(&text);
    assert!(outcome.passed(), "{:?}", outcome.verdicts);
}

/// The window and the `while` of a claim.
#[derive(Clone, Copy, Default)]
struct Scope {
    from: Option<Edge>,
    to: Option<Edge>,
    during: bool,
}

#[derive(Clone, Copy)]
enum Edge {
    Scan(u64),
    WhenW,
}

impl Scope {
    fn draw(random: &mut Random, last: u64) -> Self {
        let mut edge = |least| match random.below(4) {
            0 => Some(Edge::Scan(least + random.below(last + 1 - least))),
            1 => Some(Edge::WhenW),
            _ => None,
        };
        let from = edge(0);
        let least = if let Some(Edge::Scan(scan)) = from {
            scan
        } else {
            0
        };
        let to = edge(least);
        Self {
            from,
            to,
            during: random.below(3) == 0,
        }
    }

    fn text(self) -> String {
        let edge = |key: &str, edge: Option<Edge>| match edge {
            Some(Edge::Scan(scan)) => format!(r#", "{key}": {scan}"#),
            Some(Edge::WhenW) => format!(r#", "{key}": {{"when": {{"w": true}}}}"#),
            None => String::new(),
        };
        let during = if self.during {
            r#", "while": {"b": true}"#
        } else {
            ""
        };
        format!("{}{}{during}", edge("from", self.from), edge("to", self.to))
    }

    /// Whether each row is in the window; none if it never begins.
    fn rows(self, rows: &[[bool; 3]]) -> Option<Vec<bool>> {
        let w = |from: usize| (from..rows.len()).find(|row| rows[*row][2]);
        let from = match self.from {
            Some(Edge::Scan(scan)) => scan as usize,
            Some(Edge::WhenW) => w(0)?,
            None => 0,
        };
        let to = match self.to {
            Some(Edge::Scan(scan)) => scan as usize,
            Some(Edge::WhenW) => w(from).unwrap_or(rows.len()),
            None => rows.len(),
        };
        Some((0..rows.len()).map(|row| from <= row && row <= to).collect())
    }
}

/// Rows in which `values` rise, inside the window and the `while`.
fn risings(values: &[bool], inside: &[bool]) -> Vec<usize> {
    let all = 0..values.len();
    all.filter(|row| values[*row] && (*row == 0 || !values[row - 1]) && inside[*row])
        .collect()
}

fn next_rising(values: &[bool], from: usize) -> Option<usize> {
    (from..values.len()).find(|row| values[*row] && (*row == 0 || !values[row - 1]))
}

/// A claim as text, and whether it is fulfilled by its definition.
fn drawn(random: &mut Random, rows: &[[bool; 3]]) -> (String, bool) {
    let n = rows.len();
    let a: Vec<bool> = rows.iter().map(|row| row[0]).collect();
    let b: Vec<bool> = rows.iter().map(|row| row[1]).collect();
    let scope = Scope::draw(random, n as u64 - 1);
    let inside = scope.rows(rows);
    let begins = inside.is_some();
    let mut inside = inside.unwrap_or_else(|| vec![false; n]);
    for (row, inside) in inside.iter_mut().enumerate() {
        *inside &= !scope.during || b[row];
    }
    let t = random.below(5);
    let scoped = scope.text();
    match random.below(5) {
        kind @ (0 | 1) => {
            let mut risen = risings(&a, &inside);
            if kind == 1 {
                risen.truncate(1);
            }
            let answered = |r: &usize| (*r..=(r + t as usize).min(n - 1)).any(|row| b[row]);
            let (key, limit) = [("when", "within"), ("after", "by")][kind as usize];
            let text =
                format!(r#"{{"{key}": {{"a": true}}, "{limit}": {t}, "that": {{"b": true}}{scoped}}}"#);
            (text, risen.iter().all(answered))
        }
        2 => {
            let k = t as usize + 1;
            let bad = (0..n).any(|i| i + k <= n && (i..i + k).all(|row| a[row] && inside[row]));
            (format!(r#"{{"never": {{"a": true}}, "for": {k}{scoped}}}"#), !bad)
        }
        3 => {
            let each = random.one_in(2);
            let mut risen = risings(&a, &inside);
            if !each {
                risen.truncate(1);
            }
            let (key, fits): (&str, fn(u64, u64) -> bool) = match random.one_in(2) {
                true => ("le", |found, t| found <= t),
                false => ("ge", |found, t| found >= t),
            };
            let good = |r: &usize| next_rising(&b, *r).is_some_and(|d| fits((d - r) as u64, t));
            let text = format!(
                r#"{{"duration": [{{"a": true}}, {{"b": true}}], "{key}": {t}, "each": {each}{scoped}}}"#
            );
            (text, risen.iter().all(good))
        }
        _ => {
            let found = risings(&a, &inside).len() as u64;
            debug_assert!(begins || found == 0);
            let (key, fits) =
                [("eq", found == t), ("le", found <= t), ("ge", found >= t)][random.below(3) as usize];
            (
                format!(r#"{{"count": {{"a": true}}, "{key}": {t}{scoped}}}"#),
                fits,
            )
        }
    }
}

#[test]
fn random_claims_on_random_traces_are_judged_by_their_definition() {
    let mut random = Random(0x5ca1_ab1e);
    let (mut held, mut failed) = (0, 0);
    for _ in 0..4_000 {
        let length = 1 + random.below(14);
        let rows: Vec<[bool; 3]> = (0..length)
            .map(|_| [random.one_in(2), random.one_in(2), random.one_in(2)])
            .collect();
        let (claim, expected) = drawn(&mut random, &rows);
        assert_eq!(judged(&claim, &rows), expected, "{claim}\n{rows:?}");
        if expected { held += 1 } else { failed += 1 }
    }
    assert!(held > 500 && failed > 500, "{held} held, {failed} failed");
}

/// The message for a claim that is not valid.
fn refused(claim: &str) -> String {
    let text = format!(
        r#"{{"standstill": 1, "cycle": "T#2ms", "scans": 9, "axes": {{}}, "blocks": [],
            "inputs": {{"a": false, "v": 0}}, "expect": [{claim}]}}"#
    );
    read(&text, "a.scan.json", &[]).unwrap_err().to_string()
}

#[test]
fn claims_that_cannot_be_are_refused_with_place_and_remedy() {
    for (claim, said) in [
        (
            r#"{"count": {"a": true}, "ge": 3, "le": 2}"#,
            "contradicts itself: no number is at least 3 and at most 2",
        ),
        (
            r#"{"at": 1, "that": {"v": {"gt": 3, "le": 3}}}"#,
            "contradicts itself: no number is above 3 and at most 3",
        ),
        (r#"{"always": {"v": 0, "V": 1}}"#, "asks twice for `V`"),
        (r#"{"count": {"a": true}}"#, "give `le` or `ge`"),
        (r#"{"duration": [{"a": true}], "le": 1}"#, "takes two conditions"),
        (
            r#"{"when": {"a": true}, "within": "T#1ms", "that": {"a": false}}"#,
            "no whole multiple of the cycle",
        ),
        (
            r#"{"never": {"a": true}, "for": 0}"#,
            "`for` is 0: it must be one scan at least",
        ),
        (
            r#"{"never": {"a": true}, "from": 5, "to": 3}"#,
            "before it begins with scan 5",
        ),
        (
            r#"{"never": {"a": true}, "from": {"when": {"a": 5}}}"#,
            "takes true or false",
        ),
        (
            r#"{"at": 1, "that": {"v": {"near": {"of": "a"}, "within": 1}}}"#,
            "`of` takes a number",
        ),
        (
            r#"{"when": {"a": true}, "that": {"a": false}}"#,
            "needs the key `within`",
        ),
    ] {
        let found = refused(claim);
        assert!(
            found.contains(said) && found.contains("a.scan.json:2:"),
            "{claim}\n{found}"
        );
    }
}

#[test]
fn near_takes_another_signal() {
    let run = |claim: &str| {
        let text = format!(
            r#"{{"standstill": 1, "cycle": "T#1ms", "scans": 3, "axes": {{}}, "blocks": [],
                "inputs": {{"v": 1, "u": 0}}, "steps": [{{"at": 1, "set": {{"v": 5, "u": 3.5}}}}], "expect": [{claim}]}}"#
        );
        outcome(&text)
    };
    let near = |plus: f64, within: f64| {
        format!(r#"{{"always": {{"v": {{"near": {{"of": "u", "plus": {plus}}}, "within": {within}}}}}}}"#)
    };
    assert!(run(&near(1.25, 0.25)).passed());
    let failed = run(&near(1.0, 0.25));
    assert_eq!(
        failed.verdicts[0].failures[0].to_string(),
        "expect[0].always.v: 5.0 (u 3.5) at scan 1, expected within 0.25 of u plus 1.0; it came at 0, 1 earlier; \
         broken in 2 scans: 1, 2"
            .replace("it came at 0", "it was so at 0")
    );
}

#[test]
fn failures_name_the_rising_and_what_was_missed() {
    let text = r#"{"standstill": 1, "cycle": "T#1ms", "scans": 9, "axes": {}, "blocks": [],
        "inputs": {"a": false, "b": false}, "steps": [{"at": 2, "set": {"a": true}}, {"at": 6, "set": {"b": true}}],
        "expect": [{"when": {"a": true}, "within": 3, "that": {"b": true}}, {"after": {"b": true}, "by": 9, "that": {"a": false}},
          {"duration": [{"a": true}, {"b": true}], "le": 3}, {"count": {"a": true}, "eq": 2}, {"never": {"a": true}, "for": 3}]}"#;
    assert_eq!(
        failures(&outcome(text)),
        [
            "expect[0].that: a TRUE rose in scan 2, and b TRUE did not come by scan 5; it came at 6, 1 later",
            "expect[1].that: b TRUE rose in scan 6, and a FALSE did not come by scan 15; the run ended with scan 8, before that",
            "expect[2].duration: from a TRUE in scan 2 to b TRUE in scan 6 are 4 scans, expected at most 3",
            "expect[3].count: a TRUE rose 1 times, expected exactly 2; it did in scan 2",
            "expect[4].never: a TRUE held in scans 2 to 4, expected never for 3 scans on end",
        ]
    );
}

//! A run that advances scan by scan equals the whole run, claims are decided as in the final judgement,
//! and changes on the way can be saved as a script.

use super::common;
use standstill_script::model::Point;
use standstill_script::suite::{Allowed, find, read_file};
use standstill_script::{Session, Standing, with_changes};
use standstill_trace::compare::compare;

const SCRIPT: &str = r#"{"standstill": 1, "title": "One move", "cycle": "T#1ms", "scans": 300,
  "axes": {"X": {"unit": "mm", "limits": {"velocity": 50, "acceleration": 1000}, "state": "Standstill"}},
  "inputs": {"GO": false, "way": 4},
  "blocks": [
    {"name": "m", "type": "MC_MoveAbsolute", "pins": {"Axis": "X", "Execute": {"from": "GO"}, "Position": {"from": "way"}, "Velocity": 50}},
    {"name": "t", "type": "TON", "pins": {"IN": {"from": "GO"}, "PT": "T#20ms"}}
  ],
  "expect": [{"by": 299, "that": {"m.Done": true}}, {"never": {"m.Error": true}}, {"at": 299, "that": {"m.Done": true}}]}"#;

#[test]
fn claims_are_decided_on_the_way_as_they_are_judged_at_the_end() {
    let scripts = find(&common::scan_tests()).unwrap_or_else(|error| panic!("{error}"));
    let (mut early, mut claims) = (0, 0);
    for path in scripts.iter().step_by(standstill_testkit::whole_or(5, 53)) {
        let (script, _) = read_file(path, &[], &Allowed::default()).unwrap_or_else(|error| panic!("{error}"));
        let mut session = Session::new(&script).unwrap_or_else(|error| panic!("{error}"));
        let mut decided = vec![Standing::Open; script.claims.len()];
        while session.advance().unwrap_or_else(|error| panic!("{error}")) {
            if session.is_over() {
                break;
            }
            for (before, now) in decided.iter_mut().zip(session.standings()) {
                assert!(
                    *before == Standing::Open || before == now,
                    "{}: what is decided stays so",
                    path.display()
                );
                *before = *now;
            }
        }
        let at_end = session.standings().to_vec();
        let outcome = session.finish();
        for (index, verdict) in outcome.verdicts.iter().enumerate() {
            let held = matches!(at_end[index], Standing::Held(_));
            assert_eq!(held, verdict.passed(), "{} {}", path.display(), verdict.path);
            match decided[index] {
                Standing::Open => {}
                Standing::Held(_) => assert!(verdict.passed(), "{} {}", path.display(), verdict.path),
                Standing::Failed(_) => assert!(!verdict.passed(), "{} {}", path.display(), verdict.path),
            }
            early += usize::from(decided[index] != Standing::Open);
            claims += 1;
        }
    }
    assert!(
        early > claims / 4,
        "{early} of {claims} claims are decided before the end"
    );
}

#[test]
fn a_claim_that_fails_is_told_in_its_scan() {
    let script = SCRIPT
        .replace("\"by\": 299", "\"by\": 40")
        .replace("{\"m.Error\": true}", "{\"t.Q\": true}");
    let script = script
        .replace("\"GO\": false", "\"GO\": true")
        .replace("\"at\": 299", "\"at\": 100");
    let script = common::script(&script);
    let mut session = Session::new(&script).unwrap_or_else(|error| panic!("{error}"));
    let mut told = Vec::new();
    while session.advance().unwrap_or_else(|error| panic!("{error}")) {
        let scan = session.scans() - 1;
        for (claim, standing) in session.standings().iter().enumerate() {
            if matches!(standing, Standing::Held(at) | Standing::Failed(at) if *at == scan) {
                told.push((claim, *standing));
            }
        }
    }
    let expected = [
        (1, Standing::Failed(20)),
        (0, Standing::Failed(40)),
        (2, Standing::Failed(100)),
    ];
    assert_eq!(told, expected);
}

#[test]
fn what_is_changed_on_the_way_is_a_script_too() {
    for text in [
        SCRIPT.to_owned(),
        SCRIPT.replace(
            "\"expect\"",
            "\"steps\": [{\"at\": 3, \"set\": {\"way\": 3}}], \"expect\"",
        ),
    ] {
        let script = common::script(&text);
        let mut session = Session::new(&script).unwrap_or_else(|error| panic!("{error}"));
        let pin = |instance: usize, name: &str| {
            let mut pins = script.blocks[instance].block.pins();
            Point::Pin(instance, pins.position(|pin| pin.name == name).expect("a pin"))
        };
        let advance = |session: &mut Session<'_>, scans| {
            for _ in 0..scans {
                session.advance().unwrap_or_else(|error| panic!("{error}"));
            }
        };
        advance(&mut session, 3);
        for (point, value) in [
            (Point::Input(1), "1.5"),
            (Point::Input(1), "2.5e0"),
            (pin(0, "Velocity"), "25"),
            (pin(0, "BufferMode"), "mcBuffered"),
            (pin(1, "PT"), "T#1s500us"),
        ] {
            assert_eq!(session.change(point, value), Ok(()), "{value}");
        }
        advance(&mut session, 4);
        assert_eq!(session.change(Point::Input(0), "true"), Ok(()));
        for (point, value, why) in [
            (Point::Input(0), "yes", "GO: `yes` is neither TRUE nor FALSE"),
            (Point::Input(1), "4,5", "way: `4,5` is no number"),
            (
                pin(0, "Execute"),
                "TRUE",
                "m.Execute: it is wired: change what the wire comes from",
            ),
            (pin(0, "Done"), "TRUE", "m.Done: it is an output"),
            (pin(0, "Axis"), "X", "m.Axis: it is set once and for all"),
            (
                pin(0, "BufferMode"),
                "mcSoon",
                "m.BufferMode: `mcSoon` is no element of MC_BUFFER_MODE",
            ),
        ] {
            assert_eq!(session.change(point, value), Err(why.to_owned()));
        }
        let time = session.change(pin(1, "PT"), "20").expect_err("no unit");
        assert!(
            time.starts_with("t.PT: `20` is no time such as T#1s500ms: "),
            "{time}"
        );
        while session.advance().unwrap_or_else(|error| panic!("{error}")) {}
        assert_eq!(
            session.change(Point::Input(0), "false"),
            Err("the run is over".to_owned())
        );
        let saved = with_changes(&text, "s", session.changes()).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!(
            saved.matches("\"at\": 3,").count(),
            text.matches("\"at\": 3,").count() + 1,
            "{saved}"
        );
        let again = common::outcome(&saved);
        let outcome = session.finish();
        assert_eq!(compare(&outcome.trace, &again.trace), None, "{saved}");
        assert!(outcome.trace.column("m.Done").is_some_and(|done| {
            outcome
                .trace
                .cells(done)
                .any(|cell| cell == standstill_trace::Cell::Bool(true))
        }));
    }
}

#[test]
fn inputs_are_found_by_name_and_written_all_or_none() {
    let script = common::script(SCRIPT);
    let mut session = Session::new(&script).unwrap();
    let [go, way] = ["go", "WAY"].map(|name| session.point(name).unwrap());
    assert_eq!((go, way), (Point::Input(0), Point::Input(1)));
    assert_eq!(session.point("m.position"), Some(Point::Pin(0, 3)));
    assert_eq!(
        (session.point("m.Nothing"), session.point("nobody")),
        (None, None)
    );
    assert_eq!(session.settable()[..3], ["GO", "way", "m.ContinuousUpdate"]);

    let refused = session.change_all(&[(go, "TRUE".to_owned()), (way, "far".to_owned())]);
    assert_eq!(refused.unwrap_err(), "way: `far` is no number");
    session.advance().unwrap();
    assert_eq!(session.text(go).as_deref(), Some("FALSE"));
    assert!(session.changes().is_empty());
    session
        .change_all(&[(go, "TRUE".to_owned()), (way, "3".to_owned())])
        .unwrap();
    session.advance().unwrap();
    assert_eq!(session.text(go).as_deref(), Some("TRUE"));
    assert_eq!(session.text(way).as_deref(), Some("3.0"));
}

#[test]
fn a_drive_that_is_led_is_where_it_is_led_to() {
    let script = common::script(SCRIPT);
    let mut session = Session::new(&script).unwrap();
    let go = session.point("GO").unwrap();
    session.change(go, "TRUE").unwrap();
    assert!(session.lead(1, 0.0).is_err() && session.lead(0, f64::NAN).is_err());
    let mut ordered = session.ordered(0).unwrap();
    assert_eq!((ordered.position, ordered.velocity), (0.0, 0.0));
    for _ in 0..100 {
        session.lead(0, ordered.position / 2.0).unwrap();
        session.advance().unwrap();
        let trace = session.trace();
        let actual = trace.column("X.ActualPosition").unwrap();
        let actual = trace.reals(actual).last().unwrap();
        assert_eq!(actual, ordered.position / 2.0);
        ordered = session.ordered(0).unwrap();
        let position = trace.column("X.Position").unwrap();
        assert_eq!(trace.reals(position).last(), Some(ordered.position));
    }
    assert!(ordered.position > 3.0);
}

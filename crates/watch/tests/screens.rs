//! The screen and the effect of keys, on a terminal of 80 by 24.

use ratatui::Terminal;
use ratatui::backend::TestBackend;
use ratatui::style::Color;
use standstill_script::model::Script;
use standstill_script::read;
use standstill_watch::{App, Key, Mode, draw};

const SCRIPT: &str = r#"{"standstill": 1, "title": "There, and back", "cycle": "T#1ms", "scans": 400,
  "axes": {
    "X": {"unit": "mm", "limits": {"velocity": 50, "acceleration": 1000, "jerk": 50000, "snap": 5000000}, "state": "Standstill"},
    "Y": {"limits": {"velocity": 5, "acceleration": 10}, "software_limits": {"min": -1, "max": 2.5}}
  },
  "inputs": {"GO": false, "way": 4},
  "blocks": [
    {"name": "there", "type": "MC_MoveAbsolute", "pins": {"Axis": "X", "Execute": {"from": "GO"}, "Position": {"from": "way"}, "Velocity": 50}},
    {"name": "back", "type": "MC_MoveAbsolute", "pins": {"Axis": "X", "Execute": {"from": "there.Done"}, "Position": 0, "Velocity": 25}}
  ],
  "steps": [{"at": 10, "set": {"GO": true}}],
  "expect": [
    {"by": 390, "that": {"back.Done": true, "X.Position": 0}},
    {"at": 20, "that": {"there.Active": true}},
    {"never": {"there.Done": true}},
    {"within_limits": "X", "factor": 1.000001}
  ]}"#;

fn script() -> Script {
    read(SCRIPT, "t.scan.json", &[]).unwrap_or_else(|error| panic!("{error}"))
}

fn app(script: &Script) -> App<'_> {
    let save = Box::new(|changes: &[standstill_script::Change]| match changes.len() {
        1 => Ok("written: t.watched.scan.json".to_owned()),
        _ => Err("too many".to_owned()),
    });
    App::new(script, "t.scan.json", save).unwrap_or_else(|error| panic!("{error}"))
}

fn keys(app: &mut App<'_>, keys: &str) {
    for key in keys.chars() {
        app.key(match key {
            '\n' => Key::Enter,
            '\t' => Key::Tab,
            '\u{8}' => Key::Backspace,
            '\u{1b}' => Key::Escape,
            'V' => Key::Down(1),
            other => Key::Char(other),
        });
        // As fast as possible.
        app.elapsed(0.0);
        while app.mode() != Mode::Running && app.work() {}
    }
}

fn terminal(app: &App<'_>, size: (u16, u16), color: bool) -> Terminal<TestBackend> {
    let mut terminal = Terminal::new(TestBackend::new(size.0, size.1)).unwrap();
    terminal.draw(|frame| draw(frame, app, color)).unwrap();
    terminal
}

fn screen(app: &App<'_>) -> String {
    terminal(app, (80, 24), false).backend().to_string()
}

#[track_caller]
fn shows(app: &App<'_>, text: &str) {
    let screen = screen(app);
    assert!(screen.contains(text), "no {text:?} in\n{screen}");
}

#[test]
fn before_the_first_scan() {
    let script = script();
    insta::assert_snapshot!(screen(&app(&script)));
}

#[test]
fn steps_events_and_claims_are_reached_and_shown() {
    let script = script();
    let mut app = app(&script);
    keys(&mut app, "s");
    assert_eq!(app.scans(), 1);
    keys(&mut app, "S");
    assert_eq!(app.scans(), 11, "scan 10 is the step's");
    keys(&mut app, "c");
    assert_eq!(
        (app.scans(), app.tally()),
        (21, (1, 0, 3)),
        "the claim about scan 20 holds"
    );
    insta::assert_snapshot!("in_motion", screen(&app));
    keys(&mut app, "e");
    assert_eq!(
        (app.scans(), app.tally()),
        (171, (1, 1, 2)),
        "there.Done, which should never come"
    );
    insta::assert_snapshot!("at_an_event", screen(&app));
    keys(&mut app, "\t");
    insta::assert_snapshot!("the_other_axis", screen(&app));
    keys(&mut app, "cc");
    assert_eq!(
        app.scans(),
        400,
        "the run goes to its end for what is decided there"
    );
    assert_eq!(app.tally(), (3, 1, 0));
    insta::assert_snapshot!("over", screen(&app));
    let outcome = app.finish();
    assert_eq!(
        outcome.verdicts.iter().filter(|verdict| verdict.passed()).count(),
        3
    );
}

#[test]
fn a_value_is_changed_and_the_run_follows() {
    let script = script();
    let mut app = app(&script);
    keys(&mut app, "s\n");
    shows(&app, "GO = true from scan 1 on; w writes a script");
    keys(&mut app, "s");
    shows(&app, "> DiscreteMotion");
    keys(&mut app, "w");
    shows(&app, "written: t.watched.scan.json");
    keys(&mut app, "V\n2x\u{8}.5");
    insta::assert_snapshot!("editing", screen(&app));
    keys(&mut app, "\ns");
    shows(&app, "way");
    keys(&mut app, "w");
    shows(&app, "not written: too many");
    keys(&mut app, "\nq\u{1b}");
    assert!(
        !app.is_done(),
        "q is text there, and escape leaves the text alone"
    );
    keys(&mut app, "\nmuch\n");
    shows(&app, "way: `much` is no number");
    keys(&mut app, "VV\n");
    shows(&app, "there.Execute: it is wired");
    keys(&mut app, "r");
    assert_eq!(app.scans(), 0);
    keys(&mut app, "w");
    shows(&app, "nothing was changed");
}

#[test]
fn a_running_script_follows_the_clock_and_a_key_stops_it() {
    let script = script();
    let mut app = app(&script);
    keys(&mut app, " ");
    app.elapsed(0.0405);
    while app.work() {
        if app.scans() > 300 {
            break;
        }
    }
    assert_eq!(app.scans(), 40, "40 ms are 40 cycles");
    keys(&mut app, "+");
    app.elapsed(0.01);
    while app.work() {
        if app.scans() > 300 {
            break;
        }
    }
    assert_eq!(app.scans(), 140, "ten times as fast");
    keys(&mut app, " ");
    app.elapsed(1.0);
    assert!(!app.work());
    assert_eq!((app.scans(), app.mode()), (140, Mode::Paused));
}

#[test]
fn the_help_names_every_key_and_any_key_takes_it_away() {
    let script = script();
    let mut app = app(&script);
    keys(&mut app, "?");
    insta::assert_snapshot!("help", screen(&app));
    keys(&mut app, "q");
    assert!(!app.is_done());
    assert!(!screen(&app).contains("this help"));
    keys(&mut app, "q");
    assert!(app.is_done());
}

#[test]
fn a_small_terminal_says_what_it_needs_and_a_large_one_shows_more() {
    let script = script();
    let mut app = app(&script);
    keys(&mut app, "eee");
    for size in [(79, 24), (80, 23), (20, 3), (1, 1)] {
        let text = terminal(&app, size, true).backend().to_string();
        assert!(!text.contains("DiscreteMotion"), "{text}");
    }
    let text = terminal(&app, (79, 24), true).backend().to_string();
    let told = "The terminal has 79x24, this needs 80x24: make it larger, or q to end.";
    assert!(text.contains(told), "{text}");
    let large = terminal(&app, (160, 60), true).backend().to_string();
    assert!(
        large.contains("back MC_MoveAbsolute") && large.contains("CommandAborted"),
        "{large}"
    );
}

/// Colours are used only if requested; their information is also there without them.
#[test]
fn without_colour_nothing_is_coloured() {
    let script = script();
    let mut app = app(&script);
    keys(&mut app, "ece");
    let colors = |color| {
        let terminal = terminal(&app, (80, 24), color);
        let cells = terminal.backend().buffer().content().iter();
        cells
            .filter(|cell| cell.fg != Color::Reset || cell.bg != Color::Reset)
            .count()
    };
    assert!(colors(true) > 20);
    assert_eq!(colors(false), 0);
}

/// Names come from files: they must not move the cursor or break the frame.
#[test]
fn titles_are_cut_and_cannot_steer_the_terminal() {
    let long = SCRIPT.replace("There, and back", &"ü\\u001b[2J".repeat(60));
    let script = read(&long, "t.scan.json", &[]).unwrap_or_else(|error| panic!("{error}"));
    let text = screen(&app(&script));
    assert!(!text.contains('\u{1b}'), "{text}");
    assert!(text.contains("before scan 0 of 400"), "{text}");
}

/// The run of a script that ends early gives the reason and remains visible.
#[test]
fn a_run_that_breaks_off_says_why() {
    let text = SCRIPT.replace(
        "{\"at\": 10, \"set\": {\"GO\": true}}",
        "{\"at\": 3, \"drive\": {\"axis\": \"X\", \"displace\": 1}}",
    );
    let script = read(&text, "t.scan.json", &[]).unwrap_or_else(|error| panic!("{error}"));
    let mut app = app(&script);
    keys(&mut app, "S");
    assert_eq!(app.broken().map(|why| why.contains("X is powered")), Some(true));
    keys(&mut app, "s ");
    shows(&app, "the run ended: steps[0], scan 3: X is powered");
    keys(&mut app, "r");
    assert_eq!(app.broken(), None);
}

/// The guide shows a real screen.
#[test]
fn the_guide_shows_this_screen() {
    let script = script();
    let mut app = app(&script);
    keys(&mut app, "sSc");
    let shown: Vec<String> = screen(&app)
        .lines()
        .map(|line| line.trim_matches('"').trim_end().to_owned())
        .collect();
    let guide = include_str!("../../../docs/watch.md");
    assert!(
        guide.contains(&format!("```text\n{}\n```", shown.join("\n"))),
        "{}",
        shown.join("\n")
    );
    for (key, _) in standstill_watch::KEYS {
        for word in key
            .split_whitespace()
            .filter(|word| !matches!(*word, "up" | "down"))
        {
            assert!(guide.contains(&format!("`{word}`")), "{word}");
        }
    }
}

/// Two axes of a program, in files of their own, read to be watched.
fn watched_program() -> Script {
    let folder = std::path::PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("watched_program");
    std::fs::create_dir_all(&folder).unwrap();
    let cell = "PROGRAM Cell
VAR_INPUT Go : BOOL; END_VAR
VAR State : (Idle, Busy); n : INT; parts : ARRAY [0..3] OF INT; wait : TIME; END_VAR
CASE State OF
\tIdle:
\t\tIF Go THEN State := Busy; END_IF;
\tBusy:
\t\tparts[n] := 7;
\t\tn := n + 1;
END_CASE;
wait := T#20ms * n;
END_PROGRAM
";
    let script = r#"{"standstill": 1, "cycle": "T#1ms", "scans": 20, "axes": {}, "blocks": [],
      "programs": {"cell": {"st": "cell.st", "may_fault": true}},
      "steps": [{"at": 2, "set": {"cell.Go": true}}], "expect": []}"#;
    std::fs::write(folder.join("cell.st"), cell).unwrap();
    let path = folder.join("t.scan.json");
    std::fs::write(&path, script).unwrap();
    let read =
        standstill_script::suite::read_counted(&path, &[], &standstill_script::suite::Allowed::default());
    read.unwrap_or_else(|error| panic!("{error}")).0
}

/// The lines of the screen; several spaces become one.
fn program_screen(app: &App<'_>) -> Vec<String> {
    let screen = screen(app);
    let words = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
    screen.lines().map(words).collect()
}

#[test]
fn a_program_is_looked_at_line_by_line() {
    let script = watched_program();
    let mut app = app(&script);
    let has = |screen: &[String], text: &str| screen.iter().any(|line| line.contains(text));
    keys(&mut app, "v");
    let before = program_screen(&app);
    for text in [
        "> cell: the source",
        "│cell.st",
        "8 parts[n] := 7;",
        " State Idle",
        "wait T#0ms",
    ] {
        assert!(has(&before, text), "{text} {before:#?}");
    }
    // In scan 2 it receives the command.
    keys(&mut app, "sss");
    let going = program_screen(&app);
    for text in ["6> IF Go THEN State := Busy;", "8 parts[n] := 7;", "*State Busy"] {
        assert!(has(&going, text), "{text} {going:#?}");
    }
    keys(&mut app, "s");
    let busy = program_screen(&app);
    for text in [
        "8> parts[n] := 7;",
        "6 IF Go",
        "*parts[0] 7",
        "*wait T#20ms",
        " State Busy",
    ] {
        assert!(has(&busy, text), "{text} {busy:#?}");
    }
    // A fault names the place, the value and the scan.
    keys(&mut app, "S");
    let over = program_screen(&app);
    let fault = "scan 7: cell.st:8:9: an index outside the bounds of its array: the index is 4";
    assert!(has(&over, fault), "{over:#?}");
    // The two sides scroll independently.
    keys(&mut app, "VVV");
    let scrolled = program_screen(&app);
    assert!(
        !has(&scrolled, "1 PROGRAM Cell") && has(&scrolled, "8 parts"),
        "{scrolled:#?}"
    );
    keys(&mut app, "\tVV");
    let scrolled = program_screen(&app);
    assert!(
        has(&scrolled, "> variables") && !has(&scrolled, "State Busy"),
        "{scrolled:#?}"
    );
    keys(&mut app, "\n");
    assert!(has(&program_screen(&app), "v leads there"));
    keys(&mut app, "v");
    assert!(
        has(&program_screen(&app), "events"),
        "behind the last program the axes are back"
    );
}

#[test]
fn a_script_without_a_program_says_so() {
    let script = script();
    let mut app = app(&script);
    keys(&mut app, "v");
    shows(&app, "no program in Structured Text");
}

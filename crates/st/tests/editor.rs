//! The information on names and the completions for an editor, at places marked by `|`.

use crate::common::source;
use standstill_st::editor::{Completion, CompletionKind, Hover, complete, hover, variable};
use standstill_st::{Options, Source, Sources};

const TYPES: &str = "TYPE E_State : (Idle, Moving := 5) DINT; END_TYPE
TYPE Recipe : STRUCT
    Length : LREAL := 40.0; // from part to part
END_STRUCT END_TYPE
(* Sees that a valve is open. *)
FUNCTION_BLOCK Valve
VAR_INPUT Open : BOOL; END_VAR
VAR_OUTPUT IsOpen : BOOL; END_VAR
VAR inside : INT; END_VAR
METHOD Flush : INT VAR_INPUT Times : INT; END_VAR Flush := Times; END_METHOD
IsOpen := Open;
END_FUNCTION_BLOCK
FUNCTION Twice : INT VAR_INPUT a : INT; END_VAR Twice := 2 * a; END_FUNCTION
";

fn options() -> Options {
    Options {
        library: true,
        ..Options::default()
    }
}

/// The text without its mark, and the place of the mark.
fn marked(text: &str) -> (String, usize) {
    let at = text.find('|').expect("a mark");
    (text.replacen('|', "", 1), at)
}

fn ask<T>(text: &str, ask: impl FnOnce(&[Source<'_>], usize) -> T) -> T {
    let (text, at) = marked(text);
    let sources = [source("types.st", TYPES), source("main.st", &text)];
    ask(&sources, at)
}

/// The answer for the mark in a program's statements.
fn told(statements: &str) -> (Sources, Hover) {
    let (sources, found) = ask(&program(statements), |sources, at| {
        hover(sources, &options(), 1, at)
    });
    (sources, found.expect("a name"))
}

fn program(statements: &str) -> String {
    format!(
        "PROGRAM Main
VAR_INPUT Start : BOOL; END_VAR
VAR
    Mv : MC_MoveAbsolute; (* to the gripper *)
    Valves : ARRAY [1..3] OF Valve;
    State : E_State;
    r : Recipe;
    X : AXIS_REF;
    i : INT;
END_VAR
VAR CONSTANT LIMIT_UP : LREAL := 25.0; END_VAR
{statements}
END_PROGRAM
"
    )
}

fn offered(text: &str) -> Vec<Completion> {
    ask(text, |sources, at| complete(sources, &options(), 1, at))
}

fn names(found: &[Completion]) -> Vec<&str> {
    found.iter().map(|it| it.name.as_str()).collect()
}

#[test]
fn names_are_told_with_their_declaration_and_what_is_said_of_them() {
    for (statements, text, doc) in [
        ("M|v();", "Mv : MC_MoveAbsolute  // VAR of Main", "to the gripper"),
        (
            "i := r.Len|gth;",
            "Length : LREAL := 40.0  // a member of Recipe",
            "from part to part",
        ),
        (
            "State := Mov|ing;",
            "E_State#Moving := 5",
            "an element of the enumeration E_State",
        ),
        (
            "State := E_State#Id|le;",
            "E_State#Idle := 0",
            "an element of the enumeration E_State",
        ),
        (
            "i := Twi|ce(2);",
            "FUNCTION Twice : INT\nVAR_INPUT\n    a : INT;\nEND_VAR",
            "",
        ),
        ("i := ABS|(i);", "ABS(IN)", "a function of the library"),
        (
            "r.Length := LIMIT_|UP;",
            "LIMIT_UP : LREAL := 25.0  // VAR CONSTANT of Main",
            "",
        ),
        (
            "Valves[i].|Open := TRUE;",
            "Open : BOOL  // VAR_INPUT of Valve",
            "",
        ),
        (
            "i := Valves[1].Flu|sh(3);",
            "METHOD Flush : INT\nVAR_INPUT\n    Times : INT;\nEND_VAR",
            "",
        ),
        ("FOR |i := 1 TO 3 DO END_FOR;", "i : INT  // VAR of Main", ""),
        ("i := X.Num|ber;", "Number : DINT  // a member of AXIS_REF", ""),
    ] {
        let (_, hover) = told(statements);
        assert_eq!(
            (hover.text.as_str(), hover.doc.as_str()),
            (text, doc),
            "{statements}"
        );
    }
    // The text of the table of blocks.
    let (_, pin) = told("Mv(Axis := X, Velo|city := 5.0);");
    assert!(pin.text.starts_with("Velocity : LREAL"), "{}", pin.text);
    assert!(pin.doc.contains("(u/s)"), "{}", pin.doc);
    let (_, block) = ask(&program("").replace("MC_Move", "MC_|Move"), |sources, at| {
        hover(sources, &options(), 1, at)
    });
    let block = block.unwrap();
    assert!(
        block.text.contains("VAR_IN_OUT\n    Axis : AXIS_REF;"),
        "{}",
        block.text
    );
    assert_eq!(block.declared, None);
}

#[test]
fn declarations_are_found_in_other_files() {
    for (statements, file, line) in [
        ("M|v();", "main.st", "    Mv : MC_MoveAbsolute;"),
        ("State := Mov|ing;", "types.st", "TYPE E_State : (Idle, Moving"),
        ("i := r.Len|gth;", "types.st", "    Length : LREAL"),
        ("i := Twi|ce(2);", "types.st", "FUNCTION Twice"),
        ("i := Valves[1].Flush(Ti|mes := 3);", "types.st", "METHOD Flush"),
        ("Valves[i](|Open := TRUE);", "types.st", "VAR_INPUT Open"),
    ] {
        let (sources, hover) = told(statements);
        let declared = hover.declared.expect(statements);
        assert_eq!(sources.file_name(declared), file, "{statements}");
        let (index, bytes) = sources.locate(declared);
        let text = if index == 0 {
            TYPES.to_owned()
        } else {
            marked(&program(statements)).0
        };
        let place = text.find(line).expect("the line");
        let end = place + text[place..].find('\n').unwrap();
        assert!((place..end).contains(&bytes.start), "{statements}: {bytes:?}");
    }
}

#[test]
fn nothing_is_told_of_what_is_no_name() {
    for statements in ["i := 4|2;", "i := i +| 1;", "// M|v", "i := unknown|;"] {
        let (_, found) = ask(&program(statements), |sources, at| {
            hover(sources, &options(), 1, at)
        });
        assert!(
            found.as_ref().is_none_or(|it| it.text.starts_with("i :")),
            "{statements}: {found:?}"
        );
    }
}

/// A text is incomplete while it is written: the offers depend on the text before the place.
#[test]
fn members_are_offered_behind_a_point_in_a_text_that_is_broken() {
    let pins = offered(&program("IF Start THEN\n  Mv.|"));
    assert!(names(&pins).contains(&"Done") && names(&pins).contains(&"Position"));
    assert!(
        !names(&pins).contains(&"Axis"),
        "an in_out cannot be read from outside"
    );
    let done = pins.iter().find(|it| it.name == "Done").unwrap();
    assert_eq!((done.kind, done.detail.as_str()), (CompletionKind::Pin, "BOOL"));
    assert!(!done.doc.is_empty());
    assert_eq!(
        names(&offered(&program("i := Valves[i + 1].Is|"))),
        ["Open", "IsOpen", "Flush"]
    );
    assert_eq!(names(&offered(&program("r.|\n  i := 3;"))), ["Length"]);
    assert_eq!(
        names(&offered(&program("State := E_State#|"))),
        ["Idle", "Moving"]
    );
    assert_eq!(
        names(&offered(&program("State := E_State.|"))),
        ["Idle", "Moving"]
    );
    assert_eq!(names(&offered(&program("i := X.|;"))), ["Number"]);
    assert!(offered(&program("i.|")).is_empty());
    assert!(offered(&program("nothing.|")).is_empty());
    let method = "FUNCTION_BLOCK Tank VAR level : INT; END_VAR
METHOD Fill VAR_INPUT By : INT; END_VAR level := |; END_METHOD END_FUNCTION_BLOCK";
    let inside = offered(method);
    assert!(
        names(&inside).starts_with(&["By", "level", "Fill"]),
        "{:?}",
        names(&inside)
    );
    assert_eq!(
        names(&offered(&method.replace("level := |", "THIS^.|"))),
        ["level", "Fill"]
    );
}

#[test]
fn a_call_is_offered_its_pins_with_their_signs() {
    let found = offered(&program("Mv(Axis := X, Exe|"));
    let pin = |name: &str| {
        found
            .iter()
            .find(|it| it.name == name && it.kind == CompletionKind::Pin)
    };
    assert_eq!(pin("Execute").unwrap().insert, "Execute := ");
    assert_eq!(pin("Done").unwrap().insert, "Done => ");
    assert!(
        names(&found).contains(&"Start"),
        "a value may stand there as well"
    );
    let function = offered(&program("i := Twice(|);"));
    assert_eq!(function[0].insert, "a := ");
    let nested = offered(&program("Valves[1](Open := Twice(|) > 3);"));
    assert_eq!(nested[0].insert, "a := ");
    let value = offered(&program("Mv(Axis := |"));
    assert!(names(&value).contains(&"X") && !names(&value).contains(&"Execute"));
}

#[test]
fn types_and_blocks_are_offered_where_they_are_declared() {
    let types = offered("PROGRAM Main VAR Mv : |");
    for name in [
        "MC_MoveAbsolute",
        "TON",
        "Valve",
        "Recipe",
        "E_State",
        "LREAL",
        "AXIS_REF",
        "STRING",
    ] {
        assert!(names(&types).contains(&name), "{name}");
    }
    assert!(!names(&types).contains(&"Twice"));
    let elements = offered("PROGRAM Main VAR a : ARRAY [0..3] OF MC|");
    assert!(names(&elements).contains(&"MC_GearIn"));
    assert!(!names(&offered(&program("CASE i OF 1: |"))).contains(&"LREAL"));
}

#[test]
fn statements_are_offered_what_is_in_scope() {
    let found = offered(&program("|"));
    for name in ["Mv", "State", "Idle", "Twice", "ABS", "IF", "mcPositiveDirection"] {
        assert!(names(&found).contains(&name), "{name}");
    }
    assert!(!names(&found).contains(&"inside"));
    for nowhere in ["// M|", "(* M| *)", "i := 4|;", "i := LEN('M|');"] {
        assert!(offered(&program(nowhere)).is_empty(), "{nowhere}");
    }
    assert!(names(&offered("P|")).contains(&"PROGRAM"));
}

#[test]
fn programs_are_offered_by_their_names_with_their_variables() {
    let other = "PROGRAM Other VAR_OUTPUT Ready : BOOL; END_VAR VAR Step : INT; END_VAR END_PROGRAM ";
    let found = offered(&format!("{other}PROGRAM Main |; END_PROGRAM"));
    assert!(names(&found).contains(&"Other"), "{found:?}");
    assert!(!names(&found).contains(&"Main"), "{found:?}");
    let found = offered(&format!("{other}PROGRAM Main IF Other.| END_PROGRAM"));
    assert_eq!(names(&found), ["Ready", "Step"]);
}

/// Every place of a text that is cut off anywhere.
#[test]
fn no_place_of_a_broken_text_leads_to_a_panic() {
    let whole = program(
        "IF Start THEN Mv(Axis := X, Execute := TRUE); Valves[i].Flush(2); END_IF; // äöü\n State := E_State#Idle;",
    );
    for at in 0..=whole.len() {
        let cut = whole.get(..at).unwrap_or_default();
        for text in [whole.as_str(), cut] {
            let source = [source("main.st", text)];
            let _found = complete(&source, &options(), 0, at);
            let _found = hover(&source, &options(), 0, at);
        }
    }
    assert!(complete(&[], &options(), 0, 0).is_empty());
    assert!(complete(&[], &options(), 3, 7).is_empty());
}

#[test]
fn variables_are_found_by_the_paths_that_scripts_have() {
    let (text, _) = marked(&program("|"));
    let configured = "VAR_GLOBAL Guard : BOOL; // closed
END_VAR CONFIGURATION C RESOURCE R ON PLC TASK t(INTERVAL := T#1ms); PROGRAM Left WITH t : Main; END_RESOURCE END_CONFIGURATION";
    let sources = [
        source("types.st", TYPES),
        source("main.st", &text),
        source("conf.st", configured),
    ];
    for (path, declared, file) in [
        ("State", "State : E_State", Some("main.st")),
        ("valves[2].IsOpen", "IsOpen : BOOL", Some("types.st")),
        ("Left.r.Length", "Length : LREAL := 40.0", Some("types.st")),
        ("Main.i", "i : INT", Some("main.st")),
        ("Guard", "Guard : BOOL", Some("conf.st")),
        ("Mv.Done", "Done : BOOL", None),
    ] {
        let (all, found) = variable(&sources, &options(), path);
        let found = found.expect(path);
        assert!(found.text.starts_with(declared), "{path}: {}", found.text);
        assert_eq!(found.declared.map(|span| all.file_name(span)), file, "{path}");
    }
    for nothing in [
        "", "Stat", "State.x", "Valves[", "]", "Left", "Guard.x", "Mv.Don", "1",
    ] {
        let (_, found) = variable(&sources, &options(), nothing);
        assert_eq!(found, None, "{nothing}");
    }
}

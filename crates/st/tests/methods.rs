//! Methods of function blocks.

use crate::common::{Running, wrong};

fn run(text: &str) -> Running {
    let mut running = Running::new(text);
    running.scan().unwrap_or_else(|fault| panic!("{fault}"));
    running
}

const TANK: &str = "
TYPE Level : STRUCT High : INT; Low : INT; END_STRUCT; END_TYPE
FUNCTION_BLOCK Tank
VAR_INPUT Step : INT := 1; END_VAR
VAR_OUTPUT Calls : INT; END_VAR
VAR Filled : INT; Capacity : INT := 10; Last : ARRAY [1..3] OF INT; t : TON; END_VAR
VAR CONSTANT Most : INT := 100; END_VAR

METHOD PUBLIC Fill : BOOL
VAR_INPUT Amount : INT; Times : INT := 1; END_VAR
VAR_OUTPUT Rest : INT; END_VAR
VAR i, Filled : INT; END_VAR
FOR i := 1 TO Times DO
  Filled := Filled + Amount;
END_FOR;
THIS^.Filled := THIS^.Filled + Filled;
Count();
Last[2] := Filled;
Rest := Capacity - THIS^.Filled;
Fill := Rest >= 0 AND THIS^.Filled < Most;
END_METHOD

METHOD PRIVATE Count
Calls := Calls + 1;
END_METHOD

METHOD Levels : Level
VAR_IN_OUT Other : INT; END_VAR
Levels.High := Capacity;
Levels.Low := Filled;
Other := Other + 1;
END_METHOD

Capacity := Capacity + Step;
THIS^.Count();
END_FUNCTION_BLOCK
";

/// Covers: ST15
#[test]
fn methods_work_on_the_variables_of_their_instance() {
    let run = run(&format!(
        "{TANK}
PROGRAM Main
VAR Tanks : ARRAY [1..2] OF Tank; i, r, n : INT; good, bad : BOOL; l : Level; END_VAR
i := 2;
good := Tanks[i].Fill(3, Times := 2, Rest => r);
bad := NOT Tanks[1].Fill(Amount := 11);
Tanks[2]();
l := Tanks[2].Levels(Other := n);
END_PROGRAM"
    ));
    for (path, value) in [
        ("good", 1),
        ("bad", 1),
        ("r", 4),
        ("n", 1),
        ("Tanks[1].Calls", 1),
        ("Tanks[2].Calls", 2),
        ("Tanks[2].Filled", 6),
        ("Tanks[2].Last[2]", 6),
        ("Tanks[1].Last[2]", 11),
        ("l.High", 11),
        ("l.Low", 6),
    ] {
        assert_eq!(run.whole(path), value, "{path}");
    }
}

/// Covers: ST15
#[test]
fn methods_call_blocks_of_their_instance_and_are_called_through_an_in_out() {
    let mut run = Running::new(
        "
FUNCTION_BLOCK Pulse
VAR Edge : R_TRIG; Seen : INT; END_VAR
METHOD Look : INT
VAR_INPUT x : BOOL; END_VAR
Edge(CLK := x);
IF Edge.Q THEN Seen := Seen + 1; END_IF;
Look := Seen;
END_METHOD
END_FUNCTION_BLOCK
FUNCTION_BLOCK User
VAR_IN_OUT p : Pulse; END_VAR
VAR_OUTPUT n : INT; END_VAR
n := p.Look(TRUE) * 10 + p.Look(x := FALSE);
END_FUNCTION_BLOCK
PROGRAM Main VAR p : Pulse; u : User; END_VAR
u(p := p);
END_PROGRAM",
    );
    run.scan().unwrap();
    assert_eq!(run.whole("u.n"), 11);
    run.scan().unwrap();
    assert_eq!(run.whole("u.n"), 22);
}

/// Covers: ST15, ST22
#[test]
fn mistakes_with_methods_are_told() {
    for (text, message) in [
        (
            "FUNCTION_BLOCK A METHOD M M(); END_METHOD END_FUNCTION_BLOCK",
            "calls go round in a circle",
        ),
        (
            "FUNCTION_BLOCK A METHOD M END_METHOD METHOD m END_METHOD END_FUNCTION_BLOCK",
            "the name `m` is given twice",
        ),
        (
            "FUNCTION_BLOCK A VAR m : INT; END_VAR METHOD M END_METHOD END_FUNCTION_BLOCK",
            "the name `M` is given twice",
        ),
        (
            "FUNCTION_BLOCK A METHOD PRIVATE M END_METHOD END_FUNCTION_BLOCK PROGRAM P VAR a : A; END_VAR a.M(); END_PROGRAM",
            "the method `M` of A is private",
        ),
        (
            "FUNCTION_BLOCK A METHOD M VAR t : TON; END_VAR END_METHOD END_FUNCTION_BLOCK",
            "a METHOD keeps nothing between calls",
        ),
        (
            "FUNCTION_BLOCK A METHOD M : INT VAR_STAT n : INT; END_VAR END_METHOD END_FUNCTION_BLOCK",
            "a FUNCTION or METHOD keeps nothing",
        ),
        (
            "FUNCTION_BLOCK A METHOD M END_FUNCTION_BLOCK",
            "M is not closed: `END_METHOD` is missing",
        ),
        (
            "PROGRAM P METHOD M END_METHOD END_PROGRAM",
            "a METHOD belongs to a FUNCTION_BLOCK",
        ),
        (
            "PROGRAM P VAR x : INT; END_VAR THIS^.x := 1; END_PROGRAM",
            "THIS^ is the instance",
        ),
        (
            "FUNCTION_BLOCK A METHOD ABSTRACT M END_METHOD END_FUNCTION_BLOCK",
            "ABSTRACT is not supported",
        ),
        (
            "FUNCTION_BLOCK A METHOD M END_METHOD END_FUNCTION_BLOCK PROGRAM P VAR a : A; x : INT; END_VAR x := a.M(); END_PROGRAM",
            "`M` gives no value",
        ),
        (
            "FUNCTION_BLOCK A THIS^.y := 1; END_FUNCTION_BLOCK",
            "A has no variable `y`",
        ),
        (
            "FUNCTION_BLOCK A SUPER^(); END_FUNCTION_BLOCK",
            "SUPER^ is not supported",
        ),
    ] {
        let told = wrong(text);
        assert!(
            told.iter().any(|(_, it)| it.contains(message)),
            "{text}\n{told:?}"
        );
    }
}

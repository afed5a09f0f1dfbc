//! Types, units, statements and faults of whole programs.

use crate::common;

use crate::common::{Running, compile, compile_with, ran, source, wrong};
use standstill_st::{FaultKind, Options};

fn run(text: &str) -> Running {
    let mut running = Running::new(text);
    running.scan().unwrap_or_else(|fault| panic!("{fault}"));
    running
}

/// Covers: ST1, ST2, ST5
#[test]
fn case_of_names_comments_and_line_ends_do_not_matter() {
    let text = "\u{feff}program MAIN\r\nvar\r\n\tCount : int; // one\r\nend_var\r\n(* (* two *) *) COUNT := count + 1; /* three */\r\n{region 'x'}\r\nEND_Program";
    assert_eq!(run(text).whole("count"), 1);
}

/// Covers: ST10, ST11
#[test]
fn variables_begin_as_their_types_and_declarations_say() {
    let run = run("
TYPE
  Colour : (Red := 3, Green, Blue := 10) USINT;
  Level : INT(5..20);
  Speed : LREAL := 2.5;
  Point : STRUCT
    X : LREAL := 1.0;
    Y : LREAL;
    C : Colour := Green;
  END_STRUCT;
  Row : ARRAY [-1..1] OF INT;
END_TYPE
PROGRAM Main
VAR
  c : Colour;
  l : Level;
  v : Speed;
  p, q : Point := (Y := 4.0);
  r : Row := [7, 2(9)];
  m : ARRAY [0..1, 1..3] OF INT := [1, 2, 3, 4, 5, 6];
  z : ARRAY [1..4] OF INT := [3(5)];
  w : ARRAY [0..2] OF Speed;
  pp : ARRAY [0..1] OF Point := [(X := 9.0)];
  t : TON := (PT := T#5s);
  u : TON(PT := T#6s);
  b : BOOL := TRUE;
  d : TIME := T#1s;
  x : REAL := 0.1;
END_VAR
END_PROGRAM");
    for (path, value) in [
        ("c", 3),
        ("l", 5),
        ("p.C", 4),
        ("r[-1]", 7),
        ("r[1]", 9),
        ("m[0, 1]", 1),
        ("m[1, 3]", 6),
        ("z[3]", 5),
        ("z[4]", 0),
        ("t.PT", 5_000_000_000),
        ("u.PT", 6_000_000_000),
        ("b", 1),
        ("d", 1_000_000_000),
    ] {
        assert_eq!(run.whole(path), value, "{path}");
    }
    for (path, value) in [
        ("v", 2.5),
        ("p.X", 1.0),
        ("q.Y", 4.0),
        ("w[2]", 2.5),
        ("pp[0].X", 9.0),
        ("pp[1].X", 1.0),
    ] {
        assert_eq!(run.real(path), value, "{path}");
    }
}

/// Covers: ST12, ST15, ST23
#[test]
fn instances_keep_their_values_and_arrays_of_them_are_called() {
    let mut run = Running::new(
        "
FUNCTION_BLOCK Counter
VAR_INPUT Step : INT := 1; END_VAR
VAR_OUTPUT Value : INT; END_VAR
VAR_IN_OUT Total : INT; END_VAR
Value := Value + Step;
Total := Total + Step;
END_FUNCTION_BLOCK
PROGRAM Main
VAR
  Units : ARRAY [1..3] OF Counter;
  i, Sum, Read : INT;
  a, b : ARRAY [0..1] OF INT := [1, 2];
END_VAR
FOR i := 1 TO 3 DO
  Units[i](Step := i, Total := Sum);
END_FOR;
Units[2].Step := 10;
Units[2](Total := Sum, Value => Read);
a[0] := 7;
b := a;
END_PROGRAM",
    );
    run.scan().unwrap();
    assert_eq!(
        (run.whole("Sum"), run.whole("Read"), run.whole("b[0]")),
        (16, 12, 7)
    );
    assert_eq!((run.whole("Units[1].Value"), run.whole("Units[3].Value")), (1, 3));
    run.scan().unwrap();
    assert_eq!((run.whole("Sum"), run.whole("Units[2].Value")), (32, 24));
}

/// Covers: ST20, ST21, ST24
#[test]
fn several_files_are_one_project() {
    let files = [
        (
            "GVL.st",
            "VAR_GLOBAL CONSTANT N : INT := M + 1; M : INT := 3; END_VAR VAR_GLOBAL Count : INT := N; Lamp AT %QX0.1 : BOOL; END_VAR",
        ),
        (
            "cell.st",
            "PROGRAM Cell VAR_EXTERNAL Count : INT; END_VAR VAR a : ARRAY [1..N] OF INT; t : INT; END_VAR
          Count := Count + GVL.N; a[N] := Double(x := Count, Twice => t); Lamp := TRUE; END_PROGRAM",
        ),
        (
            "f.st",
            "FUNCTION Double : INT VAR_INPUT x : INT; y : INT := 2; END_VAR VAR_OUTPUT Twice : INT; END_VAR
          Double := x * y; Twice := Double * 2; END_FUNCTION",
        ),
    ];
    let sources = files.map(|(name, text)| source(name, text));
    let compiled =
        standstill_st::compile(&sources, &Options::default()).unwrap_or_else(|report| panic!("{report}"));
    let mut run = Running::of(compiled);
    run.scan().unwrap();
    assert_eq!(
        (
            run.whole("Count"),
            run.whole("Cell.a[4]"),
            run.whole("t"),
            run.whole("%QX0.1")
        ),
        (8, 16, 32, 1)
    );
}

/// Covers: ST21, ST22
#[test]
fn temporary_variables_begin_anew_and_functions_have_no_state() {
    let mut run = Running::new(
        "
TYPE P : STRUCT A : INT := 4; B : ARRAY [0..1] OF INT; END_STRUCT; END_TYPE
FUNCTION F : P
VAR_INPUT x : INT; END_VAR
VAR n : INT := 5; l : P; END_VAR
VAR_IN_OUT io : INT; END_VAR
n := n + x;
io := io + 1;
l.B[1] := n + l.A;
F := l;
F.A := F.A + 1;
END_FUNCTION
PROGRAM Main
VAR r : P; c : INT; END_VAR
VAR_TEMP t : INT := 3; END_VAR
t := t + 1;
r := F(x := t, io := c);
r := F(x := t, io := c);
END_PROGRAM",
    );
    for scans in 1..=2 {
        run.scan().unwrap();
        assert_eq!(
            (run.whole("r.A"), run.whole("r.B[1]"), run.whole("t")),
            (5, 13, 4)
        );
        assert_eq!(run.whole("c"), 2 * scans);
    }
}

/// Covers: ST20
#[test]
fn tasks_run_by_interval_and_priority_and_programs_are_connected() {
    let mut run = Running::new("
PROGRAM Fast VAR_INPUT In : INT; END_VAR VAR_OUTPUT Out : INT; END_VAR Out := In + 1; Order := Order * 10 + 1; END_PROGRAM
PROGRAM Slow VAR n : INT; END_VAR n := n + 1; Order := Order * 10 + 2; END_PROGRAM
CONFIGURATION C
  VAR_GLOBAL g, h : INT; Order : LINT; END_VAR
  RESOURCE R ON PLC
    TASK Late(INTERVAL := T#3ms, PRIORITY := 2);
    TASK Early(INTERVAL := T#1ms, PRIORITY := 1);
    PROGRAM s WITH Late : Slow;
    PROGRAM f WITH Early : Fast(In := g, Out => h);
  END_RESOURCE
END_CONFIGURATION");
    run.set("g", 41);
    for _ in 0..5 {
        run.scan().unwrap();
    }
    assert_eq!(
        (run.whole("h"), run.whole("s.n"), run.whole("Order")),
        (42, 2, 1_211_121)
    );
    let tasks: Vec<_> = run
        .compiled
        .symbols
        .tasks()
        .iter()
        .map(|task| task.name.clone())
        .collect();
    assert_eq!(tasks, ["Late", "Early"]);
}

/// Covers: ST20, ST43
#[test]
fn a_program_that_is_called_by_its_name_has_one_instance() {
    let text = "
        PROGRAM Other
        VAR_INPUT n : INT; END_VAR VAR_OUTPUT o : INT; END_VAR VAR k : INT := 10; END_VAR
          k := k + 1; o := n + k;
        END_PROGRAM
        PROGRAM Third Other(); END_PROGRAM
        FUNCTION_BLOCK Watch VAR_OUTPUT seen : INT; END_VAR seen := Main.x * 100 + Other.k; END_FUNCTION_BLOCK
        PROGRAM Main
        VAR x : INT; w : Watch; END_VAR
          Other(n := 3, o => x); Third(); w(); Other.n := 7;
        END_PROGRAM";
    let main = Options {
        program: Some("Main".to_owned()),
        ..Options::default()
    };
    let mut running = Running::of(compile_with(text, &main).unwrap());
    running.scan().unwrap();
    assert_eq!(running.whole("x"), 14);
    assert_eq!(running.whole("other.k"), 12);
    assert_eq!(running.whole("w.seen"), 1412);
    assert_eq!(running.whole("Other.n"), 7);
    // If a task runs an instance, the name means that one. With two such instances it is ambiguous.
    let with = |programs: &str| {
        format!(
            "PROGRAM P VAR_OUTPUT o : INT; END_VAR o := o + 1; END_PROGRAM
             PROGRAM Q VAR seen : INT; END_VAR seen := P.o; END_PROGRAM
             CONFIGURATION C RESOURCE R ON PLC {programs} END_RESOURCE END_CONFIGURATION"
        )
    };
    let mut running = Running::new(&with("PROGRAM A : P; PROGRAM B : Q;"));
    running.scan().unwrap();
    assert_eq!((running.whole("A.o"), running.whole("B.seen")), (1, 1));
    let told = wrong(&with("PROGRAM A : P; PROGRAM B : Q; PROGRAM Z : P;"));
    assert_eq!(told[0].1, "tasks run several instances of the PROGRAM `P`: A, Z");
}

/// Covers: ST30
#[test]
fn statements_do_what_they_say() {
    let run = ran(
        "i, s, n, w, r, e, c, k : INT; u : USINT; d : DINT; m : SINT; q : LINT; count : INT; step : INT := -2; x : INT;
         col : (Red, Green, Blue); z : INT;",
        "FOR i := 1 TO 10 DO IF i = 3 THEN CONTINUE; ELSIF i = 8 THEN EXIT; END_IF; s := s + i; END_FOR;
         FOR u := 250 TO 255 DO n := n + 1; END_FOR;
         FOR m := 126 TO -128 BY -100 DO c := c + 1; END_FOR;
         FOR q := 9223372036854775806 TO 9223372036854775807 DO k := k + 1; END_FOR;
         FOR d := 10 TO 1 BY step DO count := count + 1; END_FOR;
         FOR x := 5 TO 4 DO count := 100; END_FOR;
         WHILE w < 5 DO w := w + 1; END_WHILE
         REPEAT r := r + 1; UNTIL r >= 3 END_REPEAT;
         CASE s OF 1..24: e := 1; 25, 26: e := 2; ELSE e := 3; END_CASE;
         col := Green;
         CASE col OF Red: z := 1; Green: z := 2; Blue: z := 3; END_CASE;
         ;
         RETURN;",
    );
    for (path, value) in [
        ("s", 25),
        ("i", 8),
        ("n", 6),
        ("u", 255),
        ("c", 3),
        ("k", 2),
        ("d", 0),
        ("count", 5),
        ("x", 5),
        ("w", 5),
        ("r", 3),
        ("e", 2),
        ("z", 2),
    ] {
        assert_eq!(run.whole(path), value, "{path}");
    }
}

/// FOR over every start, end and step of a small type, compared with counting in wide numbers.
/// Covers: ST30
#[test]
fn for_ends_at_the_ends_of_the_range_of_its_type() {
    let mut text = "PROGRAM P VAR low, high, i : SINT; step : INT; n : DINT; last : SINT; END_VAR
        n := 0; FOR i := low TO high BY step DO n := n + 1; last := i; END_FOR; END_PROGRAM"
        .to_owned();
    for known in [None, Some(1), Some(-1), Some(7), Some(-128), Some(300)] {
        if let Some(known) = known {
            text = format!(
                "PROGRAM P VAR low, high, i : SINT; step : INT; n : DINT; last : SINT; END_VAR
                 n := 0; FOR i := low TO high BY {known} DO n := n + 1; last := i; END_FOR; END_PROGRAM"
            );
        }
        let mut run = Running::new(&text);
        for from in [-128_i128, -127, -1, 0, 5, 126, 127] {
            for to in [-128_i128, -100, 0, 6, 127] {
                for by in [1_i128, -1, 3, -3, 200, -255] {
                    let by = known.unwrap_or(by);
                    run.set("low", from as u64);
                    run.set("high", to as u64);
                    run.set("step", by as u64);
                    run.scan().unwrap();
                    let mut count = 0;
                    let mut at = from;
                    while if by > 0 { at <= to } else { at >= to } {
                        count += 1;
                        at += by;
                    }
                    assert_eq!(run.whole("n"), count, "{from} {to} {by}");
                    let last = if (-128..=127).contains(&at) { at } else { at - by };
                    assert_eq!(
                        run.whole("i"),
                        if count == 0 { from } else { last },
                        "{from} {to} {by}"
                    );
                }
            }
        }
    }
}

/// Covers: ST36
#[test]
fn a_fault_names_its_place_and_value_and_writes_nothing_half() {
    for (statements, kind, line, column, value) in [
        ("x := 7;\nx := 100 / z;", FaultKind::DivisionByZero, 6, 10, 100),
        ("x := 7;\nx := a[x];", FaultKind::Index, 6, 8, 7),
        ("x := 7;\na[x - 9] := 1;", FaultKind::Index, 6, 3, -2),
        ("x := 7;\ns := x;", FaultKind::Subrange, 6, 6, 7),
        ("x := 7;\nx := MUX(x, 1, 2);", FaultKind::Choice, 6, 6, 7),
        (
            "x := 7;\nFOR i := 1 TO 5 BY z DO x := 1; END_FOR;",
            FaultKind::Step,
            6,
            20,
            0,
        ),
        ("x := 7;\nx := x MOD z;", FaultKind::DivisionByZero, 6, 8, 7),
    ] {
        let text = format!(
            "PROGRAM P VAR\n x, z, i : INT; a : ARRAY [0..3] OF INT;\n s : INT(0..5);\nEND_VAR\n{statements}\nEND_PROGRAM"
        );
        let mut run = Running::new(&text);
        assert!(run.scan().is_err(), "{statements}");
        let (place, found) = run.fault();
        assert_eq!(
            (place.kind, place.position.line, place.position.column),
            (kind, line, column),
            "{statements}"
        );
        assert_eq!((found, place.file.as_str()), (value, "prog.st"), "{statements}");
        assert_eq!((run.whole("x"), run.whole("s")), (7, 0), "{statements}");
    }
}

/// Covers: ST14, ST30, ST36
#[test]
fn a_value_never_leaves_its_subrange() {
    for (ty, first, statement, value) in [
        ("INT(0..3)", 2, "x.4 := TRUE;", 18),
        ("INT(2..3)", 2, "x.1 := FALSE;", 0),
        ("SINT(0..100)", 5, "x.7 := TRUE;", -123),
        ("SINT(-128..0)", -1, "x.7 := FALSE;", 127),
        ("LINT(0..10)", 7, "x.62 := TRUE;", (1 << 62) + 7),
        ("UDINT(1..2)", 1, "x.31 := TRUE;", (1 << 31) + 1),
        ("INT(0..3)", 2, "t(Q => x.2, CLK := TRUE);", 6),
        ("INT(0..3)", 2, "F(Out => x.2);", 6),
        ("INT(0..3)", 3, "FOR x := 0 TO 9 DO ; END_FOR;", 4),
        ("INT(0..3)", 2, "FOR x := 4 TO 9 DO ; END_FOR;", 4),
        ("SINT(-2..2)", -1, "FOR x := 2 TO -9 BY -3 DO ; END_FOR;", -4),
        ("INT(0..3)", 3, "FOR x := 1 TO 9 BY two DO ; END_FOR;", 5),
        ("ULINT(0..3)", 3, "FOR x := 0 TO 9 DO ; END_FOR;", 4),
    ] {
        let text = format!(
            "FUNCTION F VAR_OUTPUT Out : BOOL := TRUE; END_VAR END_FUNCTION
PROGRAM P VAR x : {ty} := {first}; two : INT := 2; t : R_TRIG; after : BOOL; END_VAR
{statement} after := TRUE;
END_PROGRAM"
        );
        let mut run = Running::new(&text);
        assert!(run.scan().is_err(), "{ty} {statement}");
        let (place, found) = run.fault();
        assert_eq!(
            (place.kind, found),
            (FaultKind::Subrange, value),
            "{ty} {statement}"
        );
        assert_eq!(
            (run.whole("x"), run.whole("after")),
            (first, 0),
            "{ty} {statement}"
        );
    }
    for (ty, first, statement, then) in [
        ("INT(0..3)", 2, "x.0 := TRUE;", 3),
        ("SINT(-128..0)", -1, "x.0 := FALSE;", -2),
        ("LINT(-8..-1)", -1, "x.2 := FALSE;", -5),
        ("INT(0..3)", 2, "FOR x := 0 TO 3 DO ; END_FOR;", 3),
        ("USINT(0..250)", 2, "FOR x := 0 TO 249 BY 100 DO ; END_FOR;", 200),
    ] {
        let mut run = Running::new(&format!(
            "PROGRAM P VAR x : {ty} := {first}; END_VAR {statement} END_PROGRAM"
        ));
        run.scan().unwrap_or_else(|fault| panic!("{fault}\n{statement}"));
        assert_eq!(run.whole("x"), then, "{ty} {statement}");
    }
}

/// Covers: ST36
#[test]
fn a_loop_of_the_library_is_never_the_endless_one() {
    let mut run = Running::new(
        "PROGRAM P VAR n : INT := 1; END_VAR\nWHILE n < 10 DO\n  n := LEN(INT_TO_STRING(n));\nEND_WHILE;\nEND_PROGRAM",
    );
    assert!(matches!(run.scan(), Err(standstill_guest::Fault::Fuel { .. })));
    let place = run.compiled.symbols.place(run.loop_site()).unwrap();
    assert_eq!((place.file.as_str(), place.position.line), ("prog.st", 2));
}

/// Covers: ST36
#[test]
fn an_endless_loop_uses_up_its_fuel_and_is_named() {
    let mut run = Running::new(
        "PROGRAM P VAR i : INT; END_VAR\nFOR i := 1 TO 3 DO ; END_FOR;\n  WHILE TRUE DO i := 0; END_WHILE;\nEND_PROGRAM",
    );
    assert!(matches!(run.scan(), Err(standstill_guest::Fault::Fuel { .. })));
    let bits = run.whole("i");
    assert_eq!(bits, 0);
    let site = run.loop_site();
    let place = run.compiled.symbols.place(site).unwrap();
    assert_eq!(
        (place.kind, place.position.line, place.position.column),
        (FaultKind::Loop, 3, 3)
    );
}

/// Covers: ST36
#[test]
fn the_least_number_divided_by_minus_one_wraps_and_an_index_of_any_width_is_checked() {
    let run = ran(
        "d, q : DINT := -2147483648; m : DINT := -1; l, k : LINT := -9223372036854775808; n : LINT := -1;
         a : ARRAY [-2..1] OF INT; u : UDINT := 1; x : ULINT; s : SINT := -2;",
        "q := d / m; k := l / n; d := d MOD m; a[u] := 5; a[x] := 6; a[s] := 7;",
    );
    assert_eq!(run.whole("q"), -(1 << 31));
    assert_eq!(run.whole("k"), -(1 << 63));
    assert_eq!(
        (run.whole("a[1]"), run.whole("a[0]"), run.whole("a[-2]")),
        (5, 6, 7)
    );
    for (ty, value) in [
        ("UDINT", "4294967295"),
        ("ULINT", "18446744073709551615"),
        ("LINT", "-3"),
        ("DINT", "2"),
    ] {
        let text = format!(
            "PROGRAM P VAR i : {ty} := {value}; a : ARRAY [-2..1] OF INT; END_VAR a[i] := 1; END_PROGRAM"
        );
        assert!(Running::new(&text).scan().is_err(), "{ty}");
    }
}

/// Covers: ST41
#[test]
fn blocks_of_the_registry_are_known_by_both_names_and_counters_have_all_widths() {
    let mut run = Running::new("
PROGRAM P VAR
  t : TON; s : STANDSTILL_TON; e : R_TRIG; n : CTU; c : CTUD_DINT; l : CTU_ULINT; dir : MC_DIRECTION; Q : BOOL; In : BOOL;
END_VAR
t(IN := TRUE, PT := T#2ms, Q => Q);
s(IN := TRUE, PT := T#1ms);
e(CLK := In);
n(CU := e.Q, PV := 1);
c(CU := e.Q, PV := 1);
l(CU := e.Q, PV := 1);
dir := mcPositiveDirection;
dir := MC_DIRECTION#mcNegativeDirection;
dir := 1;
END_PROGRAM");
    run.scan().unwrap();
    run.set("In", 1);
    run.scan().unwrap();
    assert_eq!((run.whole("Q"), run.whole("s.Q")), (0, 1));
    run.scan().unwrap();
    assert_eq!(
        (
            run.whole("Q"),
            run.whole("n.CV"),
            run.whole("c.CV"),
            run.whole("l.CV")
        ),
        (1, 1, 1, 1)
    );
    assert_eq!(
        (
            run.whole("c.QU"),
            run.whole("c.QD"),
            run.whole("dir"),
            run.whole("t.Result")
        ),
        (1, 0, 1, 0)
    );
}

/// Every block of the registry is called with all of its pins: the module is valid, and the block answers.
/// Covers: ST41
#[test]
fn every_block_of_the_registry_can_be_called() {
    use standstill_fb::{Direction, PinType};
    for info in standstill_blocks::REGISTRY {
        let mut variables = format!("it : {};\n", info.name);
        let mut arguments = Vec::new();
        for (place, pin) in info.pins().enumerate() {
            let reference = matches!(pin.ty, PinType::Axis(_) | PinType::Table(_));
            let sign = if pin.direction == Direction::Output {
                "=>"
            } else {
                ":="
            };
            variables += &format!("v{place} : {};\n", pin.ty.iec_name());
            if pin.direction != Direction::Input || reference {
                arguments.push(format!("{} {sign} v{place}", pin.name));
            }
        }
        let run = ran(&variables, &format!("it({});", arguments.join(", ")));
        assert_eq!(run.whole("it.Result"), 0, "{}", info.name);
    }
}

/// Covers: ST12
#[test]
fn a_reference_begins_as_the_axis_of_its_name_or_the_one_it_is_bound_to() {
    let text =
        "PROGRAM Cell VAR X, Feeder, Other : AXIS_REF; All : ARRAY [1..2] OF AXIS_REF; END_VAR END_PROGRAM";
    let options = Options {
        axes: vec!["W".to_owned(), "x".to_owned()],
        bindings: vec![("Feeder".to_owned(), 7), ("all[2]".to_owned(), 9)],
        ..Options::default()
    };
    let run = Running::of(compile_with(text, &options).unwrap());
    let numbers =
        ["X", "Feeder", "Other", "All[1]", "All[2]"].map(|name| run.whole(&format!("{name}.Number")));
    assert_eq!(numbers, [2, 7, 0, 0, 9]);
    let wrong = Options {
        bindings: vec![("Feedr".to_owned(), 1)],
        ..Options::default()
    };
    let report = compile_with(text, &wrong).unwrap_err();
    assert!(report.render().contains("Feedr"));
}

/// Covers: ST43
#[test]
fn every_variable_has_a_path() {
    let compiled = common::compiled(
        "FUNCTION_BLOCK U VAR_INPUT A : BOOL; END_VAR VAR T : TON; END_VAR T(IN := A, PT := T#1s); END_FUNCTION_BLOCK
         PROGRAM Cell VAR Units : ARRAY [1..2] OF U; END_VAR Units[1](A := TRUE); END_PROGRAM",
    );
    let paths: Vec<_> = compiled
        .symbols
        .leaves(1000)
        .into_iter()
        .map(|symbol| symbol.path)
        .collect();
    for path in ["Cell.Units[1].A", "Cell.Units[2].T.ET"] {
        assert!(paths.iter().any(|it| it == path), "{path}: {paths:?}");
        assert_eq!(compiled.symbols.find(&path.to_lowercase()).unwrap().path, path);
    }
    for path in [
        "Cell.Units[3].A",
        "Cell.Units",
        "nothing",
        "Cell..A",
        "",
        "Cell.Units[",
        "Cell.Units[1,2].A",
    ] {
        assert_eq!(compiled.symbols.find(path), None, "{path}");
    }
}

/// Covers: ST22
#[test]
fn circles_are_shown() {
    for (text, circle) in [
        ("FUNCTION F : INT F := F(); END_FUNCTION", "F -> F"),
        (
            "FUNCTION F : INT F := G(); END_FUNCTION FUNCTION G : INT G := F(); END_FUNCTION",
            "F -> G -> F",
        ),
        (
            "FUNCTION_BLOCK A VAR_IN_OUT b : A; END_VAR b(b := b); END_FUNCTION_BLOCK",
            "A -> A",
        ),
    ] {
        let told = wrong(text);
        assert!(
            told.iter()
                .any(|(code, message)| *code == "circle" && message.contains(circle)),
            "{text}: {told:?}"
        );
    }
    for text in [
        "FUNCTION_BLOCK A VAR b : A; END_VAR END_FUNCTION_BLOCK",
        "FUNCTION_BLOCK A VAR b : ARRAY [0..1] OF B; END_VAR END_FUNCTION_BLOCK FUNCTION_BLOCK B VAR a : A; END_VAR END_FUNCTION_BLOCK",
        "TYPE S : STRUCT s : S; END_STRUCT; END_TYPE",
        "VAR_GLOBAL CONSTANT A : INT := B; B : INT := A; END_VAR",
    ] {
        let told = wrong(text);
        assert!(told.iter().any(|(code, _)| *code == "circle"), "{text}: {told:?}");
    }
}

/// A module has no more functions and data than the interpreter accepts, for any number of units and variables.
#[test]
fn many_small_functions_and_scattered_values_make_a_module_that_runs() {
    let mut text = String::new();
    let mut body = String::new();
    for n in 0..200 {
        text += &format!("FUNCTION F{n} : INT F{n} := {n}; END_FUNCTION\n");
        body += &format!("s := s + F{n}();\n");
    }
    let globals: String = (0..2000)
        .map(|n| format!("g{n} : LREAL := 1.5; h{n} : ARRAY [0..40] OF BYTE;\n"))
        .collect();
    let text =
        format!("{text} VAR_GLOBAL {globals} END_VAR PROGRAM P VAR s : INT; END_VAR {body} END_PROGRAM");
    let run = run(&text);
    assert_eq!((run.whole("s"), run.real("g1999")), (19_900, 1.5));
}

#[test]
fn a_function_has_as_many_inputs_as_the_interpreter_takes() {
    let text = |count: usize| {
        let inputs: String = (0..count).map(|n| format!("a{n} : INT := {n}; ")).collect();
        format!(
            "FUNCTION F : INT VAR_INPUT {inputs} END_VAR F := a0 + a{}; END_FUNCTION PROGRAM P VAR x : INT; END_VAR x := F(a0 := 5); END_PROGRAM",
            count - 1
        )
    };
    assert_eq!(run(&text(32)).whole("x"), 36);
    assert!(wrong(&text(33)).iter().any(|(code, _)| *code == "too_large"));
}

#[test]
fn what_cannot_run_is_told() {
    for text in [
        "",
        "VAR_GLOBAL x : INT; END_VAR",
        "PROGRAM A END_PROGRAM PROGRAM B END_PROGRAM",
    ] {
        let report = compile(text).unwrap_err();
        assert!(
            report
                .diagnostics()
                .iter()
                .any(|it| it.code.name() == "no_program"),
            "{text}"
        );
    }
}

/// Covers: ST11
#[test]
fn the_default_of_a_type_may_name_what_the_type_declares() {
    let mut running = Running::new(
        "TYPE Mode : (Idle := 3, Homing, Feed) := Feed; Level : INT (0..9) := 4;
         Wide : (Low, High := 70000) DINT := Wide#High; END_TYPE
         PROGRAM P VAR m : Mode; l : Level; w : Wide; n : DINT; END_VAR
         IF m = Mode#Feed AND w = High THEN n := n + 1; END_IF; END_PROGRAM",
    );
    running.scan().unwrap();
    assert_eq!(running.whole("n"), 1);
    assert_eq!(running.whole("l"), 4);
    // A structure still can't contain itself, not even in its default.
    let told = wrong("TYPE S : STRUCT a : S := (a := 1); END_STRUCT; END_TYPE");
    assert_eq!(told[0].0, "circle", "{told:?}");
}

/// The codes and messages of what is wrong or doubtful in a program that runs alone.
fn told(text: &str) -> Vec<(&'static str, String)> {
    let options = Options {
        program: Some("P".to_owned()),
        ..Options::default()
    };
    common::told(&standstill_st::check(&[source("prog.st", text)], &options))
}

/// Covers: ST21
#[test]
fn one_address_is_one_variable() {
    let other =
        "PROGRAM Q VAR Go AT %IX0.0 : BOOL; END_VAR VAR_OUTPUT o : BOOL; END_VAR o := Go; END_PROGRAM\n";
    let main = |body: &str| {
        format!("{other}PROGRAM P VAR Start AT %IX0.0, b : BOOL; END_VAR b := Start; {body} END_PROGRAM")
    };
    // A PROGRAM that does not run has no variables.
    assert_eq!(told(&main("")), []);
    let message = "`Go` and `Start` are two variables at one address, %IX0.0".to_owned();
    assert_eq!(told(&main("Q(); b := Q.o;")), [("duplicate_name", message)]);
    let overlap = |one: &str, two: &str| {
        told(&format!(
            "PROGRAM P VAR a AT {one} : WORD; b AT {two} : BYTE; END_VAR a := b; END_PROGRAM"
        ))
    };
    let whole = "`b` at %MB0 is a part of `a` at %MD0 in other systems; here they are apart".to_owned();
    for pair in [
        "a AT %MD0 : DWORD; b AT %MB0 : BYTE",
        "b AT %MB0 : BYTE; a AT %MD0 : DWORD",
    ] {
        let text = format!("PROGRAM P VAR {pair}; END_VAR a := b; END_PROGRAM");
        assert_eq!(told(&text), [("portability", whole.clone())], "{pair}");
    }
    let apart = "`b` at %MB1 is a part of `a` at %MW0 in other systems; here they are apart".to_owned();
    assert_eq!(overlap("%MW0", "%MB1"), [("portability", apart)]);
    for (one, two) in [
        ("%MW0", "%MB2"),
        ("%MW0", "%QB1"),
        ("%MW0", "%MW1"),
        ("%M*", "%M*"),
    ] {
        assert_eq!(overlap(one, two), [], "{one} {two}");
    }
}

/// Covers: ST24, ST44
#[test]
fn a_call_by_name_may_leave_an_input_out() {
    let text = |input: &str| {
        format!(
            "FUNCTION F : INT VAR_INPUT a : INT; {input}; END_VAR F := a - b; END_FUNCTION\n\
             PROGRAM P VAR x : INT; END_VAR x := F(a := 3); END_PROGRAM"
        )
    };
    assert_eq!(told(&text("b : INT := 2")), []);
    let message = "the call of F does not give `b`".to_owned();
    assert_eq!(told(&text("b : INT")), [("portability", message)]);
}

/// Covers: ST20, ST43
#[test]
fn a_global_variable_is_found_by_its_list_too() {
    let list = "VAR_GLOBAL Axes : ARRAY [1..2] OF AXIS_REF; bStart : BOOL; END_VAR";
    let main = "PROGRAM P VAR n : INT; END_VAR IF GVL.bStart THEN n := 1; END_IF; END_PROGRAM";
    let sources = [source("lists/GVL.st", list), source("main.st", main)];
    let options = Options {
        bindings: vec![("GVL.Axes[2]".to_owned(), 7)],
        ..Options::default()
    };
    let compiled = standstill_st::compile(&sources, &options).unwrap();
    let found = |path: &str| compiled.symbols.find(path).map(|it| it.path);
    assert_eq!(found("gvl.bstart"), Some("bStart".to_owned()));
    assert_eq!(found("GVL.Axes[1].Number"), Some("Axes[1].Number".to_owned()));
    assert_eq!(
        (found("main.bStart"), found("GVL"), found("GVL.n")),
        (None, None, None)
    );
    let run = Running::of(compiled);
    assert_eq!(run.whole("Axes[2].Number"), 7);
}

/// Covers: ST20
#[test]
fn a_name_of_two_lists_needs_its_list() {
    const LIST: &str = "{attribute 'qualified_only'}\nVAR_GLOBAL x : INT := 1; END_VAR VAR_GLOBAL CONSTANT N : INT := 2; END_VAR";
    let messages = |main: &str| {
        let lists = ["A.st", "B.st"].map(|name| source(name, LIST));
        let sources = [lists[0], lists[1], source("main.st", main)];
        let report = standstill_st::check(&sources, &Options::default());
        let told = report.diagnostics().iter();
        told.map(|it| (it.message.clone(), it.help.clone().unwrap_or_default()))
            .collect::<Vec<_>>()
    };
    assert_eq!(
        messages("PROGRAM P VAR Rows : ARRAY [1..B.N] OF INT; END_VAR A.x := B.x + A.N; END_PROGRAM"),
        []
    );
    let told = (
        "several lists of global variables have the name `x`".to_owned(),
        "name the list, too: A.x or B.x".to_owned(),
    );
    for main in [
        "PROGRAM P x := 1; END_PROGRAM",
        "PROGRAM P VAR y : INT; END_VAR y := X + 1; END_PROGRAM",
        "PROGRAM P FOR x := 1 TO 3 DO ; END_FOR; END_PROGRAM",
        "PROGRAM P VAR_EXTERNAL x : INT; END_VAR x := x + 1; END_PROGRAM",
    ] {
        assert_eq!(messages(main), std::slice::from_ref(&told), "{main}");
    }
    let told = messages("PROGRAM P VAR Rows : ARRAY [1..N] OF INT; END_VAR END_PROGRAM");
    assert!(told[0].0.contains("`N`"), "{told:?}");
    // A local variable is meant where there is one.
    assert_eq!(
        messages("PROGRAM P VAR x : INT; END_VAR x := 1; A.x := 2; END_PROGRAM"),
        []
    );
}

/// Covers: ST20, ST43
#[test]
fn variables_of_two_lists_have_paths_of_their_own() {
    let sources = [
        source("A.st", "VAR_GLOBAL x : INT; r : AXIS_REF; END_VAR"),
        source("B.st", "VAR_GLOBAL x : INT; r : AXIS_REF; y : DINT; END_VAR"),
        source(
            "main.st",
            "PROGRAM P A.x := A.x + 1; B.x := 10 * A.x; y := B.r.Number; END_PROGRAM",
        ),
    ];
    let options = Options {
        bindings: vec![("b.R".to_owned(), 7)],
        ..Options::default()
    };
    let compiled =
        standstill_st::compile(&sources, &options).unwrap_or_else(|report| panic!("{}", report.render()));
    let found = |path: &str| compiled.symbols.find(path).map(|symbol| symbol.path);
    assert_eq!(found("a.x"), Some("A.x".to_owned()));
    assert_eq!(found("B.X"), Some("B.x".to_owned()));
    assert_eq!(found("B.y"), Some("y".to_owned()));
    assert_eq!(found("x"), None);
    let mut run = Running::of(compiled);
    run.scan().unwrap_or_else(|fault| panic!("{fault}"));
    let values = ["A.x", "B.x", "y", "A.r.Number"].map(|path| run.whole(path));
    assert_eq!(values, [1, 10, 7, 0]);
}

//! Errors: each is reported at its place, with its reason, and never causes a panic or a long run.

use crate::common;

use crate::common::wrong;
use standstill_st::{Code, Options, Severity, Source};
use standstill_testkit::Random;
use std::time::Instant;

/// A mistake, its code, the part of the text where it is reported (empty: between two characters), and a word of
/// the message or of the help.
const MISTAKES: &[(&str, Code, &str, &str)] = &[
    (
        "PROGRAM P VAR x : INT; END_VAR x := 1 x := 2; END_PROGRAM",
        Code::Syntax,
        "",
        "`;`",
    ),
    (
        "PROGRAM P VAR x : INT END_VAR END_PROGRAM",
        Code::Syntax,
        "",
        "`;`",
    ),
    (
        "PROGRAM P VAR x : INT; END_VAR x = 1; END_PROGRAM",
        Code::Syntax,
        "=",
        "`:=`",
    ),
    (
        "PROGRAM P VAR x : INT; END_VAR IF x == 1 THEN x := 2; END_IF; END_PROGRAM",
        Code::Syntax,
        "==",
        "`=`",
    ),
    (
        "PROGRAM P VAR x : INT; END_VAR IF x := 1 THEN x := 2; END_IF; END_PROGRAM",
        Code::Syntax,
        ":=",
        "compare with `=`",
    ),
    (
        "PROGRAM P VAR x : BOOL; END_VAR IF x && x THEN ; END_IF; END_PROGRAM",
        Code::Syntax,
        "&&",
        "`AND`",
    ),
    (
        "PROGRAM P VAR x : BOOL; END_VAR x := !x; END_PROGRAM",
        Code::Syntax,
        "!",
        "`NOT`",
    ),
    (
        "PROGRAM P VAR x : INT; END_VAR x != 1; END_PROGRAM",
        Code::Syntax,
        "!=",
        "Structured Text",
    ),
    (
        "PROGRAM P VAR x : INT; END_VAR x += 1; END_PROGRAM",
        Code::Syntax,
        "+=",
        "x := x + 1",
    ),
    (
        "PROGRAM P VAR x : INT; END_VAR IF x = 1 THEN x := 2; END_PROGRAM",
        Code::NotClosed,
        "END_PROGRAM",
        "END_IF",
    ),
    (
        "PROGRAM P VAR x : INT; END_VAR FOR x := 1 TO 2 DO ; END_IF; END_FOR; END_PROGRAM",
        Code::Syntax,
        "END_IF",
        "not open",
    ),
    (
        "PROGRAM P VAR x : INT; x := 1; END_PROGRAM",
        Code::NotClosed,
        "x",
        "END_VAR",
    ),
    ("PROGRAM P VAR END_VAR ; ", Code::NotClosed, "", "END_PROGRAM"),
    (
        "PROGRAM P VAR while : INT; END_VAR END_PROGRAM",
        Code::BadName,
        "while",
        "keyword",
    ),
    (
        "PROGRAM P VAR int : INT; END_VAR END_PROGRAM",
        Code::BadName,
        "int",
        "type",
    ),
    (
        "PROGRAM P VAR Zähler : INT; END_VAR END_PROGRAM",
        Code::BadName,
        "Zähler",
        "`ae`",
    ),
    (
        "PROGRAM P VAR x : INT; END_VAR x := (1 + 2; END_PROGRAM",
        Code::Syntax,
        "",
        "`)`",
    ),
    (
        "PROGRAM P VAR x : INT; END_VAR (* not closed x := 1; END_PROGRAM",
        Code::NotClosed,
        "(*",
        "comment",
    ),
    (
        "PROGRAM P VAR x : INT; END_VAR x := y; END_PROGRAM",
        Code::UnknownName,
        "y",
        "y",
    ),
    (
        "PROGRAM P VAR Counter : INT; END_VAR Countr := 1; END_PROGRAM",
        Code::UnknownName,
        "Countr",
        "`Counter`",
    ),
    (
        "TYPE E : (eIdle, eRun); END_TYPE PROGRAM P VAR x : E; END_VAR x := eRunn; END_PROGRAM",
        Code::UnknownName,
        "eRunn",
        "`eRun`",
    ),
    (
        "FUNCTION_BLOCK FB_Axis END_FUNCTION_BLOCK PROGRAM P VAR x : FB_Axes; END_VAR END_PROGRAM",
        Code::UnknownType,
        "FB_Axes",
        "`FB_Axis`",
    ),
    (
        "PROGRAM P VAR x : INTT; END_VAR END_PROGRAM",
        Code::UnknownType,
        "INTT",
        "`INT`",
    ),
    (
        "PROGRAM P VAR x : INT; y : DINT; END_VAR x := y; END_PROGRAM",
        Code::Conversion,
        "y",
        "DINT_TO_INT",
    ),
    (
        "PROGRAM P VAR x : INT; END_VAR x := 1.5; END_PROGRAM",
        Code::Conversion,
        "1.5",
        "point",
    ),
    (
        "PROGRAM P VAR x : REAL; y : LREAL; END_VAR x := y; END_PROGRAM",
        Code::Conversion,
        "y",
        "LREAL_TO_REAL",
    ),
    (
        "PROGRAM P VAR x : LREAL; y : LINT; END_VAR x := y; END_PROGRAM",
        Code::Conversion,
        "y",
        "LINT_TO_LREAL",
    ),
    (
        "PROGRAM P VAR x : BOOL; END_VAR x := x + 1; END_PROGRAM",
        Code::WrongType,
        "+",
        "BOOL",
    ),
    (
        "PROGRAM P VAR x : INT; END_VAR IF x THEN ; END_IF; END_PROGRAM",
        Code::WrongType,
        "x",
        "x <> 0",
    ),
    (
        "PROGRAM P VAR x : INT; END_VAR x := x AND 1; END_PROGRAM",
        Code::WrongType,
        "x",
        "INT_TO_WORD",
    ),
    (
        "PROGRAM P VAR t : TIME; END_VAR t := 100; END_PROGRAM",
        Code::WrongType,
        "100",
        "T#100ms",
    ),
    (
        "PROGRAM P VAR a : ARRAY [0..3] OF INT; END_VAR a[4] := 1; END_PROGRAM",
        Code::OutOfRange,
        "4",
        "0..3",
    ),
    (
        "PROGRAM P VAR a : ARRAY [0..3] OF INT; END_VAR a[1, 2] := 1; END_PROGRAM",
        Code::WrongType,
        "[1, 2]",
        "1 dimension,",
    ),
    (
        "PROGRAM P VAR x : INT; END_VAR x := 10 / 0; END_PROGRAM",
        Code::OutOfRange,
        "0",
        "zero",
    ),
    (
        "PROGRAM P VAR x, X : INT; END_VAR END_PROGRAM",
        Code::DuplicateName,
        "X",
        "twice",
    ),
    (
        "PROGRAM P VAR CONSTANT x : INT := 1; END_VAR x := 2; END_PROGRAM",
        Code::NotWritable,
        "x",
        "constant",
    ),
    (
        "PROGRAM P VAR t : TON; END_VAR t.Q := TRUE; END_PROGRAM",
        Code::NotWritable,
        "t.Q",
        "output",
    ),
    (
        "PROGRAM P VAR i : INT; END_VAR FOR i := 1 TO 3 DO i := 2; END_FOR; END_PROGRAM",
        Code::NotWritable,
        "i",
        "FOR",
    ),
    (
        "PROGRAM P VAR i : INT; END_VAR FOR i := 1 TO 3 BY 0 DO ; END_FOR; END_PROGRAM",
        Code::OutOfRange,
        "0",
        "never ends",
    ),
    (
        "PROGRAM P VAR t : TON; END_VAR t(INN := TRUE); END_PROGRAM",
        Code::BadArgument,
        "INN",
        "`IN`",
    ),
    (
        "PROGRAM P VAR c : CTU; END_VAR c(RESET := TRUE); END_PROGRAM",
        Code::BadArgument,
        "RESET",
        "it has CU, R, PV",
    ),
    (
        "PROGRAM P VAR t : TON; END_VAR t(IN := TRUE, IN := FALSE); END_PROGRAM",
        Code::BadArgument,
        "IN := FALSE",
        "twice",
    ),
    (
        "PROGRAM P VAR t : TON; b : BOOL; END_VAR t(Q := b); END_PROGRAM",
        Code::BadArgument,
        "Q := b",
        "=>",
    ),
    (
        "PROGRAM P VAR m : MC_MoveAbsolute; END_VAR m(Execute := TRUE); END_PROGRAM",
        Code::MissingArgument,
        "m(Execute := TRUE)",
        "Axis",
    ),
    (
        "PROGRAM P TON(IN := TRUE); END_PROGRAM",
        Code::WrongType,
        "TON",
        "declare",
    ),
    ("PROGRAM P EXIT; END_PROGRAM", Code::Misplaced, "EXIT;", "outside"),
    (
        "PROGRAM P VAR x : INT; END_VAR CASE x OF 1: ; 1: ; END_CASE; END_PROGRAM",
        Code::DuplicateName,
        "1",
        "two branches",
    ),
    (
        "PROGRAM P VAR x : INT(5..1); END_VAR END_PROGRAM",
        Code::OutOfRange,
        "5..1",
        "empty",
    ),
    (
        "PROGRAM P VAR a : ARRAY [5..1] OF INT; END_VAR END_PROGRAM",
        Code::OutOfRange,
        "5..1",
        "element",
    ),
    (
        "PROGRAM P VAR n : INT; a : ARRAY [0..n] OF INT; END_VAR END_PROGRAM",
        Code::NotConstant,
        "n",
        "CONSTANT",
    ),
    (
        "PROGRAM P VAR x : INT; END_VAR x := 'text'; END_PROGRAM",
        Code::Conversion,
        "'text'",
        "STRING",
    ),
    (
        "PROGRAM P VAR x : STRING[255]; END_VAR END_PROGRAM",
        Code::OutOfRange,
        "255",
        "1 to 254",
    ),
    (
        "PROGRAM P VAR x : STRING[3] := 'four'; END_VAR END_PROGRAM",
        Code::OutOfRange,
        "'four'",
        "does not hold 4 bytes",
    ),
    (
        "PROGRAM P VAR x : STRING; END_VAR x := 'a' + x; END_PROGRAM",
        Code::WrongType,
        "+",
        "CONCAT",
    ),
    (
        "PROGRAM P VAR x : STRING; n : INT; END_VAR x := CONCAT('a', n); END_PROGRAM",
        Code::WrongType,
        "n",
        "INT_TO_STRING",
    ),
    (
        "PROGRAM P VAR x : STRING; END_VAR x := x + 5; END_PROGRAM",
        Code::WrongType,
        "+",
        "CONCAT(.., INT_TO_STRING(..))",
    ),
    (
        "PROGRAM P VAR x : STRING; n : INT; END_VAR n := n * x; END_PROGRAM",
        Code::WrongType,
        "*",
        "STRING_TO_INT",
    ),
    (
        "PROGRAM P VAR x : STRING; y : LREAL; END_VAR x := CONCAT(x, y); END_PROGRAM",
        Code::WrongType,
        "y",
        "whole number first",
    ),
    (
        "PROGRAM P VAR x : STRING; END_VAR x := LREAL_TO_STRING(1.5); END_PROGRAM",
        Code::UnknownName,
        "LREAL_TO_STRING",
        "whole number first",
    ),
    (
        "PROGRAM P VAR x : STRING; END_VAR x := 'a$x'; END_PROGRAM",
        Code::BadLiteral,
        "'a$x'",
        "$0A",
    ),
    (
        "PROGRAM P VAR x : STRING; END_VAR IF x = 5 THEN END_IF; END_PROGRAM",
        Code::WrongType,
        "=",
        "TO_STRING",
    ),
    (
        "PROGRAM P VAR x : WSTRING; END_VAR END_PROGRAM",
        Code::Unsupported,
        "WSTRING",
        "WSTRING",
    ),
    (
        "PROGRAM P VAR x : DATE; END_VAR END_PROGRAM",
        Code::Unsupported,
        "DATE",
        "TIME",
    ),
    (
        "PROGRAM P VAR x : DT := DT#2020-01-01-00:00:00; END_VAR END_PROGRAM",
        Code::Unsupported,
        "DT#",
        "TIME",
    ),
    (
        "PROGRAM P VAR x : TIME; END_VAR x := T#5; END_PROGRAM",
        Code::BadLiteral,
        "T#5",
        "`T#5` is no duration: a unit is missing behind `5`",
    ),
    (
        "PROGRAM P VAR x : TIME; END_VAR x := T#S; END_PROGRAM",
        Code::BadLiteral,
        "T#S",
        "a number is missing before `S`",
    ),
    (
        "PROGRAM P VAR x : INT; END_VAR x := SEL(FALSE, D#2020-01-01, 5); END_PROGRAM",
        Code::Unsupported,
        "D#",
        "TIME",
    ),
    (
        "PROGRAM P VAR x : POINTER TO INT; END_VAR END_PROGRAM",
        Code::Unsupported,
        "POINTER",
        "VAR_IN_OUT",
    ),
    (
        "PROGRAM P VAR x : REFERENCE TO INT; END_VAR END_PROGRAM",
        Code::Unsupported,
        "REFERENCE",
        "VAR_IN_OUT",
    ),
    (
        "PROGRAM P VAR x : REF_TO INT; END_VAR END_PROGRAM",
        Code::Unsupported,
        "REF_TO",
        "VAR_IN_OUT",
    ),
    ("CLASS C END_CLASS", Code::Unsupported, "CLASS", "FUNCTION_BLOCK"),
    (
        "INTERFACE I END_INTERFACE",
        Code::Unsupported,
        "INTERFACE",
        "FUNCTION_BLOCK",
    ),
    (
        "NAMESPACE N END_NAMESPACE",
        Code::Unsupported,
        "NAMESPACE",
        "FUNCTION_BLOCK",
    ),
    (
        "FUNCTION_BLOCK A EXTENDS B END_FUNCTION_BLOCK",
        Code::Unsupported,
        "EXTENDS",
        "EXTENDS",
    ),
    (
        "FUNCTION_BLOCK A IMPLEMENTS B END_FUNCTION_BLOCK",
        Code::Unsupported,
        "IMPLEMENTS",
        "IMPLEMENTS",
    ),
    (
        "FUNCTION_BLOCK A PROPERTY P : INT END_PROPERTY END_FUNCTION_BLOCK",
        Code::Unsupported,
        "PROPERTY",
        "PROPERTY",
    ),
    ("PROGRAM P JMP a; END_PROGRAM", Code::Unsupported, "JMP", "CASE"),
    ("PROGRAM P a: ; END_PROGRAM", Code::Unsupported, "a", "label"),
    (
        "PROGRAM P INITIAL_STEP a: END_STEP END_PROGRAM",
        Code::Unsupported,
        "INITIAL_STEP",
        "CASE",
    ),
    (
        "PROGRAM P LD a ST b END_PROGRAM",
        Code::Unsupported,
        "LD",
        "Structured Text",
    ),
    (
        "PROGRAM P Stop(); END_PROGRAM ACTION Stop: ; END_ACTION FUNCTION Stop : INT END_FUNCTION",
        Code::Unsupported,
        "ACTION",
        "METHOD",
    ),
    (
        "FUNCTION_BLOCK B ACTION Stop: ; END_ACTION END_FUNCTION_BLOCK",
        Code::Unsupported,
        "ACTION",
        "METHOD",
    ),
    (
        "PROGRAM P VAR a, b : BOOL; END_VAR a S= b; END_PROGRAM",
        Code::Unsupported,
        "S",
        "a := TRUE",
    ),
    (
        "PROGRAM P VAR a, b : BOOL; END_VAR a R= b; END_PROGRAM",
        Code::Unsupported,
        "R",
        "a := FALSE",
    ),
    (
        "PROGRAM P VAR a, b : BOOL; END_VAR a := a AND THEN b; END_PROGRAM",
        Code::Syntax,
        "THEN",
        "AND_THEN",
    ),
    (
        "PROGRAM P VAR a : BIT; END_VAR END_PROGRAM",
        Code::UnknownType,
        "BIT",
        "BOOL",
    ),
    (
        "PROGRAM P VAR a : DINT; END_VAR a := ADR(a); END_PROGRAM",
        Code::Unsupported,
        "ADR",
        "VAR_IN_OUT",
    ),
    (
        "TYPE E : (A, B); END_TYPE PROGRAM P VAR x : E; END_VAR x := 1; END_PROGRAM",
        Code::Conversion,
        "1",
        "one of its elements",
    ),
    (
        "TYPE E : (A, B); END_TYPE PROGRAM P VAR e : E; END_VAR e := E.B; END_PROGRAM",
        Code::UnknownMember,
        "B",
        "E#B",
    ),
    (
        "PROGRAM P VAR x : ARRAY [1..3] OF INT := 1; END_VAR END_PROGRAM",
        Code::Conversion,
        "1",
        "[1, 2, 3]",
    ),
    (
        "PROGRAM P VAR n : INT; END_VAR n := 1; END_PROGRAM PROGRAM Q P.n := 2; END_PROGRAM",
        Code::NotWritable,
        "P.n",
        "inside a PROGRAM",
    ),
    (
        "PROGRAM P Q(); END_PROGRAM PROGRAM Q P(); END_PROGRAM",
        Code::Circle,
        "P()",
        "P -> Q -> P",
    ),
    (
        "VAR_ACCESS a : B : INT; END_VAR",
        Code::Unsupported,
        "VAR_ACCESS",
        "VAR_GLOBAL",
    ),
    (
        "VAR_CONFIG a : INT; END_VAR",
        Code::Unsupported,
        "VAR_CONFIG",
        "VAR_GLOBAL",
    ),
    (
        "PROGRAM P VAR t : TON; END_VAR t(EN := TRUE); END_PROGRAM",
        Code::Unsupported,
        "EN",
        "IF",
    ),
    (
        "PROGRAM P VAR x : BOOL; END_VAR x := %IX0.0; END_PROGRAM",
        Code::Unsupported,
        "%IX0.0",
        "AT",
    ),
    (
        "FUNCTION F : INT VAR_INPUT x : ANY_NUM; END_VAR END_FUNCTION",
        Code::Unsupported,
        "ANY_NUM",
        "each type",
    ),
    (
        "TYPE U : UNION a : INT; END_UNION END_TYPE",
        Code::Unsupported,
        "UNION",
        "structure",
    ),
    (
        "FUNCTION_BLOCK TON END_FUNCTION_BLOCK",
        Code::DuplicateName,
        "TON",
        "library",
    ),
    (
        "TYPE A : (x, y); B : (x, z); END_TYPE PROGRAM P VAR i : INT; END_VAR i := x; END_PROGRAM",
        Code::UnknownName,
        "x",
        "A#x",
    ),
    (
        "TYPE E : (a, b); END_TYPE PROGRAM P VAR i : INT; e : E; END_VAR i := e; END_PROGRAM",
        Code::Conversion,
        "e",
        "E_TO_INT",
    ),
    (
        "TYPE S : STRUCT a : INT; END_STRUCT; END_TYPE PROGRAM P VAR s, t : S; b : BOOL; END_VAR b := s = t; END_PROGRAM",
        Code::WrongType,
        "s",
        "members",
    ),
    (
        "PROGRAM P VAR x : INT := T#1s; END_VAR END_PROGRAM",
        Code::Conversion,
        "T#1s",
        "TIME_TO_INT",
    ),
    (
        "PROGRAM P VAR x : TIME := T#1x; END_VAR END_PROGRAM",
        Code::BadLiteral,
        "T#1x",
        "duration",
    ),
    (
        "PROGRAM P VAR x : INT := 3#12; END_VAR END_PROGRAM",
        Code::BadLiteral,
        "3#12",
        "base",
    ),
    (
        "FUNCTION F : INT VAR t : TON; END_VAR END_FUNCTION",
        Code::Misplaced,
        "TON",
        "FUNCTION_BLOCK",
    ),
    (
        "FUNCTION_BLOCK A VAR_INPUT t : TON; END_VAR END_FUNCTION_BLOCK",
        Code::WrongType,
        "TON",
        "VAR_IN_OUT",
    ),
    (
        "CONFIGURATION C TASK t(INTERVAL := T#0s); END_CONFIGURATION",
        Code::WrongType,
        "T#0s",
        "INTERVAL",
    ),
    (
        "CONFIGURATION C TASK t(SINGLE := TRUE); END_CONFIGURATION",
        Code::Unsupported,
        "SINGLE := TRUE",
        "R_TRIG",
    ),
    (
        "VAR_GLOBAL g : INT; END_VAR PROGRAM P FOR g := 1 TO 3 DO g := 1; END_FOR; END_PROGRAM",
        Code::NotWritable,
        "g",
        "control variable",
    ),
    (
        "VAR_GLOBAL g : INT; END_VAR PROGRAM P VAR_EXTERNAL g : INT; END_VAR FOR g := 1 TO 3 DO prog.g := 1; END_FOR; END_PROGRAM",
        Code::NotWritable,
        "prog.g",
        "control variable",
    ),
    (
        "VAR_GLOBAL g : INT; END_VAR PROGRAM P FOR g := 1 TO 3 DO FOR g := 1 TO 2 DO ; END_FOR; END_FOR; END_PROGRAM",
        Code::NotWritable,
        "g",
        "control variable",
    ),
    (
        "VAR_GLOBAL g : INT; END_VAR FUNCTION F : INT VAR_IN_OUT x : INT; END_VAR x := 1; F := x; END_FUNCTION PROGRAM P VAR n : INT; END_VAR FOR g := 1 TO 3 DO n := F(x := g); END_FOR; END_PROGRAM",
        Code::NotWritable,
        "g",
        "control variable",
    ),
    (
        "VAR_GLOBAL g : INT; END_VAR FUNCTION F : INT VAR_OUTPUT y : INT; END_VAR y := 1; END_FUNCTION PROGRAM P VAR n : INT; END_VAR FOR g := 1 TO 3 DO n := F(y => g); END_FOR; END_PROGRAM",
        Code::NotWritable,
        "g",
        "control variable",
    ),
    (
        "FUNCTION F : INT VAR_INPUT a, b, c : INT; END_VAR F := a; END_FUNCTION PROGRAM P VAR n : INT; END_VAR n := F(1); END_PROGRAM",
        Code::MissingArgument,
        "F(1)",
        "takes 3 inputs, and `b`, `c` are missing",
    ),
    (
        "FUNCTION F : INT VAR_INPUT a, b : INT := 5; END_VAR F := a; END_FUNCTION PROGRAM P VAR n : INT; END_VAR n := F(1); END_PROGRAM",
        Code::MissingArgument,
        "F(1)",
        "`b` is missing",
    ),
    (
        "FUNCTION F : INT VAR_INPUT a : INT; END_VAR F := a; END_FUNCTION PROGRAM P VAR n : INT; END_VAR n := F(1, 2); END_PROGRAM",
        Code::BadArgument,
        "2",
        "takes 1 input",
    ),
    (
        "FUNCTION_BLOCK B METHOD M : INT VAR_INPUT a, b : INT; END_VAR M := a; END_METHOD END_FUNCTION_BLOCK PROGRAM P VAR n : INT; x : B; END_VAR n := x.M(1); END_PROGRAM",
        Code::MissingArgument,
        "x.M(1)",
        "`b` is missing",
    ),
    (
        "FUNCTION_BLOCK B VAR n : INT; END_VAR METHOD FB_Init : BOOL n := 1; END_METHOD END_FUNCTION_BLOCK",
        Code::Unsupported,
        "FB_Init",
        "where they are declared",
    ),
    (
        "FUNCTION_BLOCK B METHOD fb_exit : BOOL END_METHOD END_FUNCTION_BLOCK",
        Code::Unsupported,
        "fb_exit",
        "FB_Exit",
    ),
    (
        "VAR_GLOBAL a AT %IX0.0 : BOOL; b AT %I0.0 : BOOL; END_VAR",
        Code::DuplicateName,
        "b",
        "`a` and `b` are two variables at one address, %IX0.0",
    ),
    (
        "PROGRAM P VAR s : STRING; b : BOOL; END_VAR s := SEL(b, 'no', 1); END_PROGRAM",
        Code::Conversion,
        "1",
        "STRING",
    ),
    (
        "PROGRAM P VAR X : AXIS_REF; x1 : LREAL; END_VAR x1 := X.NcToPlc.ActPos; END_PROGRAM",
        Code::UnknownMember,
        "NcToPlc",
        "MC_ReadActualPosition",
    ),
    (
        "PROGRAM P VAR x : LREAL; i : INT; END_VAR i := REAL_TO_INT(x); END_PROGRAM",
        Code::Conversion,
        "x",
        "write LREAL_TO_INT",
    ),
    (
        "PROGRAM P VAR i, n : INT; END_VAR i := REAL_TO_INT(DINT_TO_INT(n)); i := DINT_TO_INT(LINT#1); END_PROGRAM",
        Code::Conversion,
        "LINT#1",
        "write LINT_TO_INT",
    ),
    (
        "PROGRAM P VAR x : LREAL; s : STRING; END_VAR x := STRING_TO_LREAL(s); END_PROGRAM",
        Code::UnknownName,
        "STRING_TO_LREAL",
        "STRING_TO_LINT reads",
    ),
    (
        "PROGRAM P VAR i : INT; s : STRING; END_VAR i := TO_INT(s); END_PROGRAM",
        Code::UnknownName,
        "TO_INT",
        "STRING_TO_INT",
    ),
    (
        "PROGRAM P VAR i : INT; END_VAR i := MAX(IN0 := i, IN1 := 3); END_PROGRAM",
        Code::BadArgument,
        "IN0 := i",
        "it takes IN1, ..",
    ),
    (
        "PROGRAM P VAR x : LREAL; END_VAR x := SIN(); END_PROGRAM",
        Code::MissingArgument,
        "SIN()",
        "takes 1 input",
    ),
    (
        "PROGRAM P VAR s, t : STRING; END_VAR t := s[1]; END_PROGRAM",
        Code::WrongType,
        "[1]",
        "MID(s, 1, i)",
    ),
    (
        "PROGRAM P VAR a, b : TIME; x : LREAL; END_VAR x := a / b; END_PROGRAM",
        Code::WrongType,
        "/",
        "TIME_TO_LREAL",
    ),
    (
        "PROGRAM P VAR a : ARRAY [1..3] OF INT; i : INT; END_VAR i := a[1, 2]; END_PROGRAM",
        Code::WrongType,
        "[1, 2]",
        "has 1 dimension, but here 2 indices are given",
    ),
];

/// Covers: ST5, ST13, ST15, ST20, ST21, ST23, ST24, ST30
#[test]
fn every_mistake_is_told_at_its_place_with_what_to_do() {
    let mut failures = Vec::new();
    for (text, code, piece, word) in MISTAKES {
        let source = Source {
            name: "prog.st",
            bytes: text.as_bytes(),
        };
        let options = Options {
            library: true,
            ..Options::default()
        };
        let report = standstill_st::check(&[source], &options);
        let shown = report.render();
        let found = report
            .diagnostics()
            .iter()
            .find(|it| it.severity == Severity::Error);
        let good = found.is_some_and(|it| {
            let at = &text[it.span.start as usize..it.span.end as usize];
            it.code == *code && at == *piece
        });
        if !good || !shown.to_lowercase().contains(&word.to_lowercase()) {
            failures.push(format!(
                "{text}\nwanted {} at `{piece}` with {word}\n{shown}\n",
                code.name()
            ));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// One mistake has one message, and the text behind it is checked, too.
#[test]
fn reading_goes_on_behind_a_mistake() {
    let text = "PROGRAM P\nVAR\n  a : INT\n  b : INTT;\n  c : INT;\nEND_VAR\nIF a = 1 THE\n  c := 2;\nEND_IF;\nd := 1;\nc = 3;\nEND_PROGRAM\n";
    let told = wrong(text);
    let codes: Vec<_> = told.iter().map(|it| it.0).collect();
    assert_eq!(
        codes,
        ["syntax", "syntax", "syntax", "unknown_type", "unknown_name"],
        "{told:#?}"
    );
}

/// Texts with one mistake each, a piece of its message and one of its help.
const ONE_MISTAKE: &[(&str, &str, &str)] = &[
    (
        "TYPE E : ( a := 0 b, c ); END_TYPE PROGRAM P VAR s : E; END_VAR
         CASE s OF E.a: s := E#b; b: s := c; END_CASE; s := E.c; END_PROGRAM",
        "`,` is missing between elements",
        "",
    ),
    (
        "TYPE E : ( a, 5, c ); END_TYPE PROGRAM P VAR e : E; END_VAR e := E.c; e := E#c; e := c; END_PROGRAM",
        "the name of an element is expected, not `5`",
        "",
    ),
    (
        "TYPE E : a, b, c ); END_TYPE PROGRAM P VAR v : E; END_VAR v := b; v := E.c; END_PROGRAM",
        "`;` is missing behind the declaration of a type",
        "",
    ),
    (
        "PROGRAM P VAR n INT; END_VAR n := 1; n := n + 1; END_PROGRAM",
        "`:` is missing behind the name of a variable",
        "",
    ),
    (
        "PROGRAM P VAR n := 5; m : INT; END_VAR n := n + m; END_PROGRAM",
        "`:` and a type are missing behind the name",
        "",
    ),
    (
        "PROGRAM P VAR a b : INT; END_VAR a := b; END_PROGRAM",
        "`,` is missing between names",
        "",
    ),
    (
        "PROGRAM P VAR x, y : INT; x := 1; y := 2; IF x = 1 THEN y := x; END_IF; END_PROGRAM",
        "`END_VAR` is missing before `x`",
        "",
    ),
    (
        "PROGRAM P x, y : INT; END_VAR x := y; END_PROGRAM",
        "`VAR` is missing before `x`",
        "",
    ),
    (
        "TYPE S : STRUCT a : INT; 5 b : INT; END_STRUCT END_TYPE PROGRAM P VAR s : S; END_VAR s.b := s.a; END_PROGRAM",
        "the name of a variable is expected, not `5`",
        "",
    ),
    (
        "FUNCTION_BLOCK B PROPERTY Pos : INT GET Pos := 1; END_GET END_PROPERTY END_FUNCTION_BLOCK
         PROGRAM P VAR b : B; i : INT; END_VAR i := b.Pos; b.Pos := 1; END_PROGRAM",
        "PROPERTY",
        "two methods",
    ),
    (
        "FUNCTION_BLOCK A VAR_INPUT x : INT; END_VAR END_FUNCTION_BLOCK
         FUNCTION_BLOCK B EXTENDS A x := x + 1; END_FUNCTION_BLOCK
         PROGRAM P VAR b : B := (x := 1); END_VAR b(x := 5); b.x := b.y; b.Go(); END_PROGRAM",
        "EXTENDS",
        "",
    ),
    (
        "TYPE A : STRUCT x : INT; END_STRUCT B EXTENDS A : STRUCT y : INT; END_STRUCT END_TYPE
         PROGRAM P VAR b : B; END_VAR b.x := b.y; END_PROGRAM",
        "EXTENDS",
        "",
    ),
    (
        "INTERFACE I METHOD Go END_METHOD END_INTERFACE PROGRAM P VAR i : I; END_VAR i.Go(); END_PROGRAM",
        "INTERFACE",
        "",
    ),
    (
        "NAMESPACE N FUNCTION_BLOCK B VAR_INPUT x : INT; END_VAR END_FUNCTION_BLOCK END_NAMESPACE
         PROGRAM P VAR b : N.B; END_VAR b(x := 1); END_PROGRAM",
        "NAMESPACE",
        "",
    ),
    (
        "PROGRAM P A_Do(); END_PROGRAM ACTION A_Do: ; END_ACTION PROGRAM Q P.A_Do(); END_PROGRAM",
        "ACTION",
        "METHOD",
    ),
    (
        "FUNCTION_BLOCK B A_Do(); ACTION A_Do: ; END_ACTION END_FUNCTION_BLOCK
         PROGRAM P VAR b : B; END_VAR b.A_Do(); END_PROGRAM",
        "ACTION",
        "METHOD",
    ),
    (
        "TYPE U : UNION a : INT; END_UNION END_TYPE PROGRAM P VAR u : U; END_VAR u.a := 1; END_PROGRAM",
        "UNION",
        "",
    ),
    (
        "PROGRAM P VAR t : TON; END_VAR t(EN := TRUE, IN := TRUE); END_PROGRAM",
        "a pin EN or ENO",
        "",
    ),
    (
        "PROGRAM P VAR a : ARRAY [0..2] OF INT := 1, 2, 3; b : INT; END_VAR a[0] := b; END_PROGRAM",
        "one first value",
        "[1, 2, 3]",
    ),
    (
        "PROGRAM P VAR a : ARRAY [0..2] OF INT := 3(0); b : INT; END_VAR a[0] := b; END_PROGRAM",
        "one first value",
        "[1, 2, 3]",
    ),
    (
        "PROGRAM P VAR b : BOOL; i : INT; END_VAR CASE b OF 0: i := 1; 1: i := 2; END_CASE; END_PROGRAM",
        "not by BOOL",
        "use IF",
    ),
    (
        "PROGRAM P VAR s : STRING; i : INT; END_VAR CASE s OF 1: i := 1; 2: i := 2; END_CASE; END_PROGRAM",
        "not by STRING[80]",
        "use IF",
    ),
    (
        "PROGRAM P VAR s : STRING; i : INT; END_VAR\n s := 'abc;\n i := LEN(s);\n END_PROGRAM",
        "not closed",
        "",
    ),
    (
        "PROGRAM P VAR s : STRING; i : INT; END_VAR\n i := LEN('abc);\n i := 2;\n END_PROGRAM",
        "not closed",
        "",
    ),
    (
        "PROGRAM P VAR s : STRING := 'abc;\n i : INT; END_VAR\n i := LEN(s);\n END_PROGRAM",
        "not closed",
        "",
    ),
    (
        "PROGRAM P VAR s : STRING; END_VAR s := ‘one two’; s := 'x'; END_PROGRAM",
        "these quotes",
        "between `'`",
    ),
    (
        "PROGRAM P VAR x : INT; END_VAR x\u{a0}:=\u{a0}1; x\u{a0}:=\u{a0}x + 1; END_PROGRAM",
        "a space of a word processor",
        "plain space",
    ),
    (
        "PROGRAM P VAR x : INT; END_VAR x := x – 1; END_PROGRAM",
        "`–` has no meaning",
        "minus is `-`",
    ),
    (
        "PROGRAM P VAR Zähler : INT; END_VAR Zähler := Zähler + 1; END_PROGRAM",
        "`Zähler` has `ä`",
        "`ae`",
    ),
    (
        "<?xml version=\"1.0\"?>\n<TcPlcObject><POU><Declaration><![CDATA[PROGRAM Main]]></Declaration></POU></TcPlcObject>",
        "is XML",
        "<![CDATA[",
    ),
    (
        "PROGRAM P VAR x : INT; END_VAR IF x = 1 THEN x := 2; ELSEIF x = 2 THEN x := 3; ELSE x := 4; END_IF; END_PROGRAM",
        "no keyword `ELSEIF`",
        "`ELSIF`",
    ),
    (
        "PROGRAM P VAR x : INT; END_VAR IF x = 1 THEN x := 2; END_FI; x := 3; END_PROGRAM",
        "no keyword `END_FI`",
        "`END_IF`",
    ),
    (
        "FUNCTION F : INT VAR_INPUT a : INT; END_VAR RETURN a; END_FUNCTION",
        "RETURN takes no value",
        "the function's name",
    ),
    (
        "TYPE S : STRUCT i : INT; END_STRUCT END_TYPE
         PROGRAM P VAR s : S; END_VAR FOR s.i := 1 TO 5 DO s.i := 2; EXIT; END_FOR; END_PROGRAM",
        "a plain variable",
        "",
    ),
    (
        "FUNCTOIN_BLOCK B VAR_INPUT x : INT; END_VAR END_FUNCTION_BLOCK PROGRAM P VAR b : B; END_VAR b(x := 1); END_PROGRAM",
        "no keyword `FUNCTOIN_BLOCK`",
        "`FUNCTION_BLOCK`",
    ),
    (
        "FUNCTION_BLOCK VAR_INPUT x : INT; END_VAR END_FUNCTION_BLOCK PROGRAM P VAR b : B; END_VAR b(x := 1); END_PROGRAM",
        "the name of a function block is expected",
        "",
    ),
];

/// One mistake has one message, with what it takes away from others.
#[test]
fn one_mistake_has_one_message() {
    let mut failures = Vec::new();
    for (text, message, help) in ONE_MISTAKE {
        let source = Source {
            name: "prog.st",
            bytes: text.as_bytes(),
        };
        let options = Options {
            library: true,
            ..Options::default()
        };
        let report = standstill_st::check(&[source], &options);
        let mut errors = report
            .diagnostics()
            .iter()
            .filter(|it| it.severity == Severity::Error);
        let good = errors.next().is_some_and(|it| {
            it.message.contains(message) && it.help.as_deref().unwrap_or_default().contains(help)
        });
        if !good || errors.next().is_some() {
            failures.push(format!("{text}\n{}\n", report.render()));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// The cause is told before what follows from it, also if it stands in a later file.
#[test]
fn mistakes_of_reading_are_told_first() {
    let file = |name, text: &'static str| Source {
        name,
        bytes: text.as_bytes(),
    };
    let files = [
        file("a.st", "PROGRAM P VAR x : INT; END_VAR x := y; END_PROGRAM"),
        file("b.st", "TYPE E : (a, b) END_TYPE"),
    ];
    let report = standstill_st::check(&files, &Options::default());
    let told: Vec<_> = report.diagnostics().iter().map(|it| it.code).collect();
    assert_eq!(told, [Code::Syntax, Code::UnknownName], "{report}");
}

#[test]
fn at_most_fifty_are_kept_and_the_others_counted() {
    let body: String = (0..500).map(|n| format!("x{n} := 1;\n")).collect();
    let text = format!("PROGRAM P\n{body}END_PROGRAM");
    let source = Source {
        name: "prog.st",
        bytes: text.as_bytes(),
    };
    let report = standstill_st::check(&[source], &Options::default());
    assert_eq!((report.diagnostics().len(), report.hidden()), (50, 450));
}

/// Covers: ST5
#[test]
fn what_is_nested_too_deep_or_too_large_is_told_at_once() {
    let (deep, many) = standstill_testkit::whole_or((100_000, 10_000), (10_000, 1_000));
    let program = |body: String| {
        format!("PROGRAM P VAR x : INT; b : BOOL; a : ARRAY [0..1] OF INT; END_VAR {body} END_PROGRAM")
    };
    let texts = [
        program(format!("x := {}1{};", "(".repeat(deep), ")".repeat(deep))),
        program(format!("x := {}1;", "(".repeat(deep))),
        program(format!("b := {}TRUE;", "NOT ".repeat(deep))),
        program(format!("x := {}1;", "- ".repeat(deep))),
        program(format!("x := {}0{};", "a[".repeat(deep), "]".repeat(deep))),
        program(format!("x := {}0{};", "ABS(".repeat(deep), ")".repeat(deep))),
        program("IF b THEN ".repeat(deep)),
        program("WHILE b DO ".repeat(deep)),
        program("CASE x OF 1: ".repeat(deep)),
        format!("TYPE T : {} INT; END_TYPE", "ARRAY [0..0] OF ".repeat(deep)),
        format!("TYPE T : {}", "STRUCT a : ".repeat(deep)),
        format!("VAR_GLOBAL x : INT := {}1; END_VAR", "[".repeat(deep)),
        "(*".repeat(deep),
        (0..many)
            .map(|n| format!("TYPE T{n} : T{}; END_TYPE ", n + 1))
            .collect(),
        format!(
            "VAR_GLOBAL CONSTANT {} END_VAR",
            (0..many)
                .map(|n| format!("c{n} : INT := c{}; ", n + 1))
                .collect::<String>()
        ),
    ];
    for text in texts {
        let begin = Instant::now();
        let told = wrong(&text);
        assert!(!told.is_empty(), "{}", &text[..80]);
        assert!(begin.elapsed().as_secs() < 10, "{}", &text[..80]);
    }
    let large = vec![b' '; standstill_st::SOURCES_MOST + 1];
    let source = Source {
        name: "large.st",
        bytes: &large,
    };
    let report = standstill_st::check(&[source], &Options::default());
    assert_eq!(report.diagnostics()[0].code, Code::TooLarge);
    let latin = Source {
        name: "latin1.st",
        bytes: b"PROGRAM P (* f\xFCr *) END_PROGRAM",
    };
    let report = standstill_st::check(&[latin], &Options::default());
    assert_eq!(report.diagnostics()[0].code, Code::Encoding);
    assert!(report.render().contains("latin1.st:1:15"), "{}", report.render());
}

/// Long rows are no depth: they are compiled, in a time that grows with their length.
#[test]
fn long_rows_are_compiled() {
    let terms = standstill_testkit::whole_or(20_000, 4_000);
    let sum = vec!["x"; terms].join(" + ");
    let branches: String = (0..terms)
        .map(|n| format!("ELSIF x = {} THEN x := {}; ", n % 30_000, n % 100))
        .collect();
    let labels: String = (0..terms / 4)
        .map(|n| format!("{}: x := {}; ", n * 6, n % 100))
        .collect();
    let text = format!(
        "PROGRAM P VAR x : INT; END_VAR x := {sum}; IF x = -1 THEN x := 0; {branches} END_IF; CASE x OF {labels} END_CASE; END_PROGRAM"
    );
    let compiled = common::compiled(&text);
    assert!(compiled.wasm.len() < 2 << 20);
    let mut run = common::Running::of(compiled);
    run.scan().unwrap();
}

const SOUP: &[&str] = &[
    "PROGRAM",
    "END_PROGRAM",
    "FUNCTION",
    "END_FUNCTION",
    "FUNCTION_BLOCK",
    "END_FUNCTION_BLOCK",
    "TYPE",
    "END_TYPE",
    "STRUCT",
    "END_STRUCT",
    "VAR",
    "VAR_INPUT",
    "VAR_OUTPUT",
    "VAR_IN_OUT",
    "VAR_TEMP",
    "VAR_EXTERNAL",
    "VAR_GLOBAL",
    "CONSTANT",
    "END_VAR",
    "CONFIGURATION",
    "END_CONFIGURATION",
    "RESOURCE",
    "END_RESOURCE",
    "TASK",
    "WITH",
    "ON",
    "AT",
    "IF",
    "THEN",
    "ELSIF",
    "ELSE",
    "END_IF",
    "CASE",
    "OF",
    "END_CASE",
    "FOR",
    "TO",
    "BY",
    "DO",
    "END_FOR",
    "WHILE",
    "END_WHILE",
    "REPEAT",
    "UNTIL",
    "END_REPEAT",
    "EXIT",
    "CONTINUE",
    "RETURN",
    "ARRAY",
    "INT",
    "LREAL",
    "BOOL",
    "TIME",
    "TON",
    "MC_Power",
    "AXIS_REF",
    "a",
    "b",
    "P",
    "Q",
    "x",
    "1",
    "0",
    "16#FF",
    "1.5",
    "T#1s",
    "INT#",
    "E#",
    "'s'",
    "%IX0.0",
    ":=",
    "=>",
    "=",
    "<>",
    "<",
    "..",
    "+",
    "-",
    "*",
    "/",
    "**",
    "(",
    ")",
    "[",
    "]",
    ",",
    ";",
    ":",
    ".",
    "^",
    "AND",
    "NOT",
    "ABS",
    "INT_TO_LREAL",
    "METHOD",
    "END_METHOD",
    "THIS",
    "CLASS",
    "(*",
    "*)",
    "{",
    "}",
    "ü",
    "$",
    "#",
    "==",
];

/// No text made of words of the language leads to a panic or an endless loop. A text that compiles is a valid
/// module.
#[test]
fn no_soup_of_tokens_and_no_cut_program_leads_to_a_panic() {
    let whole = "TYPE E : (a, b); S : STRUCT p : LREAL; q : ARRAY [0..3] OF INT; END_STRUCT; END_TYPE
        VAR_GLOBAL CONSTANT N : INT := 3; END_VAR VAR_GLOBAL g : S; END_VAR
        FUNCTION F : INT VAR_INPUT x : INT; END_VAR F := x * 2 + N; END_FUNCTION
        FUNCTION_BLOCK B VAR_INPUT x : INT; END_VAR VAR_OUTPUT y : INT; END_VAR VAR t : TON; END_VAR
          t(IN := x > 1, PT := T#1s); y := SEL(t.Q, x, F(x)); END_FUNCTION_BLOCK
        PROGRAM P VAR i : INT; e : E; m : ARRAY [1..2] OF B; w : WORD; END_VAR
          FOR i := 1 TO 2 DO m[i](x := i); IF m[i].y > 3 THEN EXIT; END_IF; END_FOR;
          CASE e OF a: e := b; b: w.3 := TRUE; END_CASE; g.q[i] := LREAL_TO_INT(g.p ** 2.0);
          REPEAT i := i - 1; UNTIL i < 0 END_REPEAT; END_PROGRAM";
    let words: Vec<&str> = whole.split_inclusive([' ', ';', '(', ')', '.', ':']).collect();
    for seed in 1..=standstill_testkit::cases(3000) {
        let mut random = Random(seed);
        let text = if seed % 2 == 0 {
            let count = random.place(120);
            let soup: Vec<_> = (0..count).map(|_| SOUP[random.place(SOUP.len())]).collect();
            soup.join(" ")
        } else {
            // The program with a few words left out, doubled, or replaced.
            let mut words = words.clone();
            for _ in 0..=random.place(4) {
                let at = random.place(words.len());
                match random.place(3) {
                    0 => drop(words.remove(at)),
                    1 => words.insert(at, words[at]),
                    _ => words[at] = SOUP[random.place(SOUP.len())],
                }
            }
            words.concat()
        };
        let result = std::panic::catch_unwind(|| match common::compile(&text) {
            Ok(compiled) => wasmparser::validate(&compiled.wasm)
                .map(|_| ())
                .map_err(|error| error.to_string()),
            Err(report) => {
                let _shown = report.render();
                Ok(())
            }
        });
        assert!(matches!(result, Ok(Ok(()))), "seed {seed}: {result:?}\n{text}");
    }
    assert!(common::compile(whole).is_ok());
}

/// Twice the text takes about twice the time: a number of lines and ten times as many are compared generously, because other
/// work runs beside this.
#[test]
fn time_grows_with_the_text_and_not_with_its_square() {
    let text = |lines: usize| {
        let body: String = (0..lines)
            .map(|n| format!("v{n} := v{} * 2 + {};\n", n / 2, n % 100))
            .collect();
        let variables: String = (0..lines).map(|n| format!("v{n} : DINT;\n")).collect();
        format!("PROGRAM P\nVAR\n{variables}END_VAR\n{body}END_PROGRAM\n")
    };
    let time = |lines: usize| {
        let text = text(lines);
        let best = (0..3).map(|_| {
            let begin = Instant::now();
            assert!(common::compile(&text).is_ok());
            begin.elapsed()
        });
        best.min().unwrap().as_secs_f64()
    };
    let lines = standstill_testkit::whole_or(2000, 500);
    let (short, long) = (time(lines), time(10 * lines));
    assert!(long < short * 60.0, "{short} {long}");
}

#[test]
fn one_other_missing_semicolon_is_one_place() {
    let told = wrong("PROGRAM P VAR x : INT; END_VAR IF x > 1 THEN END_IF IF x > 1 THEN END_IF END_PROGRAM");
    let message = "`;` is missing behind END_IF, and in one more place of this file";
    assert_eq!(told, [("portability", message.to_owned())]);
}

/// A valid program in which a token is omitted, doubled, or swapped with the next one rarely has many messages.
#[test]
fn few_messages_follow_from_one_wrong_token() {
    const MANY: usize = 5;
    let whole = include_str!("mistakes.st");
    assert!(common::compile(whole).is_ok(), "{:?}", wrong(whole));
    let tokens: Vec<&str> = whole.split_inclusive([' ', '\n']).collect();
    let (mut wrongs, mut many) = (0, Vec::new());
    let changes = (0..tokens.len()).flat_map(|at| (0..3).map(move |kind| (at, kind)));
    for (at, kind) in changes.step_by(standstill_testkit::stride()) {
        let mut tokens = tokens.clone();
        match kind {
            0 => tokens[at] = "\n",
            1 => tokens.insert(at, tokens[at]),
            _ => {
                let next = (at + 1).min(tokens.len() - 1);
                tokens.swap(at, next);
            }
        }
        let told = wrong(&tokens.concat());
        let errors = told
            .iter()
            .filter(|it| it.0 != "portability" && it.0 != "doubtful");
        let errors: Vec<_> = errors.collect();
        wrongs += usize::from(!errors.is_empty());
        if errors.len() >= MANY {
            let around = tokens[at.saturating_sub(3)..(at + 3).min(tokens.len())].concat();
            many.push(format!("{around}\n{errors:#?}\n"));
        }
    }
    // Of all changes it is one in 112.
    let most = wrongs / 60 + 2;
    assert!(
        many.len() <= most,
        "{} of {wrongs}\n{}",
        many.len(),
        many.join("\n")
    );
}

/// Covers: ST30
#[test]
fn a_missing_semicolon_behind_end_if_is_told_once_for_a_file() {
    let each = "IF x > 1 THEN x := 1; END_IF ".repeat(60);
    let told = wrong(&format!("PROGRAM P VAR x : INT; END_VAR {each} END_PROGRAM"));
    let message = "`;` is missing behind END_IF, and in 59 more places of this file";
    assert_eq!(told, [("portability", message.to_owned())]);
}

//! Supported and refused constructs: every row of the two tables of docs/structured-text.md is compiled
//! here, run for a scan, and its value compared; the tables must be those that this file writes. With
//! `STANDSTILL_DOCS=update` they are written.

use crate::common::{Running, checked, compile, compile_with, wrong};
use std::fmt::Write as _;
use std::path::Path;

/// A supported construct: the variables and statements of a program with it, and the value of `r` then.
struct Row {
    area: &'static str,
    what: &'static str,
    /// The text in the table; it replaces `@` in the fields below.
    example: &'static str,
    /// Before the PROGRAM.
    before: &'static str,
    /// Between VAR and END_VAR, or other sections if it begins with `VAR`.
    variables: &'static str,
    statements: &'static str,
    worth: i128,
}

const fn row(
    area: &'static str,
    what: &'static str,
    example: &'static str,
    before: &'static str,
    variables: &'static str,
    statements: &'static str,
    worth: i128,
) -> Row {
    Row {
        area,
        what,
        example,
        before,
        variables,
        statements,
        worth,
    }
}

const TEXT: &str = "text";
const TYPES: &str = "types";
const UNITS: &str = "units";
const SECTIONS: &str = "variables";
const STATEMENTS: &str = "statements";
const OPERATORS: &str = "operators";
const LIBRARY: &str = "library";

#[rustfmt::skip]
const ROWS: &[Row] = &[
    row(TEXT, "names and keywords without case", "R := r + 1", "", "r : INT;", "@;", 1),
    row(TEXT, "comments, nested too", "(* a (* b *) *) // c", "", "r : INT := 1;", "@\n", 1),
    row(TEXT, "comments of C", "/* a */", "", "r : INT := 1;", "@", 1),
    row(TEXT, "pragmas, skipped", "{attribute 'x'}", "", "r : INT := 1;", "@", 1),
    row(TEXT, "numbers with a base, with `_`", "16#FF + 2#1_000", "", "r : INT;", "r := @;", 263),
    row(TEXT, "typed literals", "WORD#16#FF", "", "r : WORD;", "r := @;", 255),
    row(TEXT, "exponents", "1.5E3", "", "r : INT;", "r := LREAL_TO_INT(@);", 1500),
    row(TEXT, "durations", "T#1m2s3.5ms", "", "r : LINT;", "r := LTIME_TO_LINT(@);", 62_003_500_000),
    row(TEXT, "strings with `$`", "'it$'s$N'", "", "r : INT;", "r := LEN(@);", 5),
    row(TYPES, "BOOL", "TRUE", "", "r : BOOL;", "r := @;", 1),
    row(TYPES, "SINT, INT, DINT, LINT", "LINT#9_000_000_000", "", "r : LINT;", "r := @;", 9_000_000_000),
    row(TYPES, "USINT, UINT, UDINT, ULINT", "USINT#255", "", "r : USINT;", "r := @;", 255),
    row(TYPES, "BYTE, WORD, DWORD, LWORD", "DWORD#16#FFFF_FFFF", "", "r : DWORD;", "r := @;", 0xFFFF_FFFF),
    row(TYPES, "REAL, LREAL", "LREAL#2.5", "", "r : INT;", "r := LREAL_TO_INT(@ * 4.0);", 10),
    row(TYPES, "TIME, LTIME: 64 bits of ns", "LTIME#5us", "", "r : LTIME;", "r := @;", 5000),
    row(TYPES, "STRING, STRING[n], n up to 254", "STRING[5]", "", "s : @; t : STRING := 'abcdefgh'; r : INT;", "s := t; r := LEN(s);", 5),
    row(TYPES, "enumerations", "(Red, Green := 5, Blue)", "TYPE C : @; END_TYPE", "c : C := Blue; r : INT;", "r := C_TO_INT(c);", 6),
    row(TYPES, "enumerations of a type of their own", "(Low, High := 200) USINT", "TYPE C : @; END_TYPE", "c : C; r : INT;", "c := High; r := TO_INT(c);", 200),
    row(TYPES, "elements by `E#a` and `E.a`", "C#Green = C.Green", "TYPE C : (Red, Green) DINT; END_TYPE", "r : BOOL;", "r := @;", 1),
    row(TYPES, "subranges", "INT(0..10)", "", "a : @ := 7; r : INT;", "r := a;", 7),
    row(TYPES, "structures with first values", "STRUCT X : INT := 3; END_STRUCT", "TYPE P : @; END_TYPE", "p : P; r : INT;", "r := p.X;", 3),
    row(TYPES, "arrays of up to 6 dimensions", "ARRAY [-1..1, 0..2] OF INT", "", "a : @; r : INT;", "a[-1, 2] := 4; r := a[-1, 2];", 4),
    row(TYPES, "arrays of arrays", "a[1][2]", "", "a : ARRAY [0..1] OF ARRAY [0..2] OF INT; r : INT;", "@ := 6; r := @;", 6),
    row(TYPES, "aliases", "TYPE Speed : INT; END_TYPE", "@", "s : Speed := 3; r : INT;", "r := s;", 3),
    row(TYPES, "first values of arrays", "[3(2), 7]", "", "a : ARRAY [0..3] OF INT := @; r : INT;", "r := a[2] + a[3];", 9),
    row(TYPES, "first values of structures and instances", "(PT := T#1s)", "", "t : TON := @; r : LINT;", "r := LTIME_TO_LINT(t.PT);", 1_000_000_000),
    row(TYPES, "instances in structures and arrays", "Units[2] (CLK := TRUE)", "", "Units : ARRAY [1..2] OF R_TRIG; r : BOOL;", "@; r := Units[2].Q;", 1),
    row(TYPES, "AXIS_REF and arrays of it", "Axes[2].Number", "", "Axes : ARRAY [1..2] OF AXIS_REF; r : DINT;", "r := @;", 0),
    row(TYPES, "copies of arrays and structures", "b := a", "", "a, b : ARRAY [0..1] OF INT := [1, 2]; r : INT;", "a[1] := 8; @; r := b[1];", 8),
    row(UNITS, "FUNCTION", "Twice(4)", "FUNCTION Twice : INT VAR_INPUT x : INT; END_VAR Twice := 2 * x; END_FUNCTION", "r : INT;", "r := @;", 8),
    row(UNITS, "FUNCTION_BLOCK", "b(In := 3)", "FUNCTION_BLOCK B VAR_INPUT In : INT; END_VAR VAR_OUTPUT Out : INT; END_VAR Out := In + 1; END_FUNCTION_BLOCK", "b : B; r : INT;", "@; r := b.Out;", 4),
    row(UNITS, "METHOD, THIS^", "b.Add(3)", "FUNCTION_BLOCK B VAR n : INT := 1; END_VAR METHOD Add : INT VAR_INPUT n : INT; END_VAR Add := n + THIS^.n; END_METHOD END_FUNCTION_BLOCK", "b : B; r : INT;", "r := @;", 4),
    row(UNITS, "several units in one file, in any order", "F()", "FUNCTION F : INT F := G(); END_FUNCTION FUNCTION G : INT G := 6; END_FUNCTION", "r : INT;", "r := @;", 6),
    row(UNITS, "calls of a PROGRAM by its name, and its variables", "Other()", "PROGRAM Other VAR n : INT := 4; END_VAR n := n + 1; END_PROGRAM", "r : INT;", "@; r := Other.n;", 5),
    row(UNITS, "VAR_GLOBAL at the top of a file", "VAR_GLOBAL g : INT := 4; END_VAR", "@", "r : INT;", "r := g;", 4),
    row(UNITS, "lists by the name of their file", "prog.g", "VAR_GLOBAL g : INT := 4; END_VAR", "r : INT;", "r := @;", 4),
    row(SECTIONS, "VAR_INPUT, VAR_OUTPUT", "VAR_OUTPUT r : INT := 2; END_VAR", "", "@", "", 2),
    row(SECTIONS, "VAR_IN_OUT, by reference", "b(x := r)", "FUNCTION_BLOCK B VAR_IN_OUT x : INT; END_VAR x := x + 5; END_FUNCTION_BLOCK", "b : B; r : INT;", "@;", 5),
    row(SECTIONS, "VAR_TEMP, new at every call", "VAR_TEMP t : INT := 3; END_VAR", "", "VAR r : INT; END_VAR @", "t := t + 1; r := t;", 4),
    row(SECTIONS, "VAR_EXTERNAL", "VAR_EXTERNAL g : INT; END_VAR", "VAR_GLOBAL g : INT := 9; END_VAR", "VAR r : INT; END_VAR @", "r := g;", 9),
    row(SECTIONS, "VAR_STAT of a PROGRAM", "VAR_STAT r : INT := 1; END_VAR", "", "@", "", 1),
    row(SECTIONS, "CONSTANT", "VAR CONSTANT N : INT := 3; END_VAR", "", "@ VAR a : ARRAY [1..N] OF INT; r : INT; END_VAR", "a[N] := 2; r := a[3];", 2),
    row(SECTIONS, "RETAIN, PERSISTENT", "VAR RETAIN r : INT := 1; END_VAR", "", "@", "", 1),
    row(SECTIONS, "AT an address", "r AT %QW2 : INT := 7;", "", "@", "", 7),
    row(STATEMENTS, "IF, ELSIF, ELSE", "IF a THEN r := 1; ELSE r := 2; END_IF", "", "a : BOOL; r : INT;", "@;", 2),
    row(STATEMENTS, "CASE with values, lists, ranges", "CASE a OF 1, 3..5: r := 1; ELSE r := 2; END_CASE", "", "a : INT := 4; r : INT;", "@;", 1),
    row(STATEMENTS, "FOR with BY", "FOR i := 5 TO 1 BY -2 DO r := r + i; END_FOR", "", "i, r : INT;", "@;", 9),
    row(STATEMENTS, "WHILE", "WHILE r < 3 DO r := r + 1; END_WHILE", "", "r : INT;", "@;", 3),
    row(STATEMENTS, "REPEAT", "REPEAT r := r + 1; UNTIL r >= 4 END_REPEAT", "", "r : INT;", "@;", 4),
    row(STATEMENTS, "EXIT, CONTINUE, RETURN", "IF i = 2 THEN CONTINUE; END_IF", "", "i, r : INT;", "FOR i := 1 TO 3 DO @; r := r + i; END_FOR RETURN; r := 0;", 4),
    row(STATEMENTS, "no `;` behind END_IF and its kin", "END_IF r := 2;", "", "r : INT;", "IF r = 0 THEN r := 1; @", 2),
    row(STATEMENTS, "calls by name and by place", "F(b := 1, a := 2) + F(1, 2)", "FUNCTION F : INT VAR_INPUT a, b : INT; END_VAR F := 10 * a + b; END_FUNCTION", "r : INT;", "r := @;", 33),
    row(STATEMENTS, "outputs by `=>` and `NOT =>`", "t(CLK := TRUE, NOT Q => r)", "", "t : R_TRIG; r : BOOL;", "@;", 0),
    row(STATEMENTS, "pins left open in a call", "c(CU := TRUE, R := , CV => )", "", "c : CTU; r : INT;", "@; r := c.CV;", 1),
    row(STATEMENTS, "inputs of instances as variables", "t.CLK := TRUE", "", "t : R_TRIG; r : BOOL;", "@; t(); r := t.Q;", 1),
    row(OPERATORS, "`-`, `*`, `/`, MOD, `+`", "-7 / 2 * 10 + -7 MOD 3", "", "r : INT;", "r := @;", -31),
    row(OPERATORS, "`**`", "2.0 ** 3.0", "", "r : INT;", "r := LREAL_TO_INT(@);", 8),
    row(OPERATORS, "comparisons", "1 < 2 AND 2 <> 3", "", "r : BOOL;", "r := @;", 1),
    row(OPERATORS, "AND, `&`, OR, XOR, NOT", "TRUE XOR NOT FALSE & TRUE", "", "r : BOOL;", "r := @;", 0),
    row(OPERATORS, "AND_THEN, OR_ELSE", "i <> 0 AND_THEN 10 / i > 1", "", "i : INT; r : BOOL;", "r := @;", 0),
    row(OPERATORS, "bits", "r.3 := TRUE; r.%X0 := TRUE", "", "r : WORD;", "@;", 9),
    row(OPERATORS, "TIME and numbers", "T#10ms * 3", "", "r : TIME;", "r := @;", 30_000_000),
    row(LIBRARY, "ABS SQRT LN LOG EXP EXPT SIN COS TAN ASIN ACOS ATAN ATAN2", "SQRT(ABS(-16.0))", "", "r : INT;", "r := LREAL_TO_INT(@);", 4),
    row(LIBRARY, "TRUNC ROUND FLOOR CEIL", "TRUNC(-2.7)", "", "r : DINT;", "r := @;", -2),
    row(LIBRARY, "ADD SUB MUL DIV GT GE EQ LE LT NE AND OR XOR NOT", "ADD(1, 2, 3)", "", "r : INT;", "r := @;", 6),
    row(LIBRARY, "MIN MAX LIMIT SEL MUX MOVE", "LIMIT(0, 12, MUX(1, 3, 10))", "", "r : INT;", "r := @;", 10),
    row(LIBRARY, "SHL SHR ROL ROR", "ROL(BYTE#16#81, 1)", "", "r : BYTE;", "r := @;", 3),
    row(LIBRARY, "X_TO_Y and TO_Y of all elementary types but STRING", "LREAL_TO_INT(2.5) + TO_INT(3.5)", "", "r : INT;", "r := @;", 6),
    row(LIBRARY, "LEN LEFT RIGHT MID CONCAT INSERT DELETE REPLACE FIND", "FIND(CONCAT('ab', 'cd'), 'cd')", "", "r : INT;", "r := @;", 3),
    row(LIBRARY, "X_TO_STRING, STRING_TO_X of whole numbers, bit strings, BOOL, TIME, LTIME", "STRING_TO_INT(INT_TO_STRING(-42))", "", "r : INT;", "r := @;", -42),
    row(LIBRARY, "TIME(): since the start of the run", "TIME()", "", "r : TIME;", "r := @;", 0),
    row(LIBRARY, "TON, R_TRIG, SR, CTU and their kin", "c(CU := TRUE, PV := 1)", "", "c : CTU; r : BOOL;", "@; r := c.Q;", 1),
    row(LIBRARY, "counters of other widths", "c(CU := TRUE, PV := 5)", "", "c : CTU_ULINT; r : ULINT;", "@; r := c.CV;", 1),
    row(LIBRARY, "all blocks of the registry", "Mv(Axis := X, Execute := TRUE)", "", "Mv : MC_MoveAbsolute; X : AXIS_REF; r : BOOL;", "@; r := Mv.Error;", 1),
    row(LIBRARY, "the names of `export st-matiec`", "t(CLK := TRUE)", "", "t : STANDSTILL_R_TRIG; r : BOOL;", "@; r := t.Q;", 1),
    row(LIBRARY, "enumerations of pins", "MC_BUFFER_MODE#mcBuffered", "", "m : MC_BUFFER_MODE; r : DINT;", "m := @; r := MC_BUFFER_MODE_TO_DINT(m);", 1),
];

/// A refused construct: its name, and a text with it.
const REFUSED: &[(&str, &str)] = &[
    ("WSTRING", "PROGRAM P VAR s : WSTRING; END_VAR END_PROGRAM"),
    ("DATE and its kin", "PROGRAM P VAR d : DATE; END_VAR END_PROGRAM"),
    ("TIME_OF_DAY", "PROGRAM P VAR d : TOD; END_VAR END_PROGRAM"),
    (
        "POINTER TO",
        "PROGRAM P VAR p : POINTER TO INT; END_VAR END_PROGRAM",
    ),
    (
        "REFERENCE TO",
        "PROGRAM P VAR p : REFERENCE TO INT; END_VAR END_PROGRAM",
    ),
    ("REF_TO", "PROGRAM P VAR p : REF_TO INT; END_VAR END_PROGRAM"),
    ("CLASS", "CLASS C END_CLASS"),
    ("INTERFACE", "INTERFACE I END_INTERFACE"),
    ("EXTENDS", "FUNCTION_BLOCK B EXTENDS A END_FUNCTION_BLOCK"),
    ("IMPLEMENTS", "FUNCTION_BLOCK B IMPLEMENTS I END_FUNCTION_BLOCK"),
    (
        "PROPERTY",
        "FUNCTION_BLOCK B PROPERTY P : INT END_PROPERTY END_FUNCTION_BLOCK",
    ),
    ("NAMESPACE", "NAMESPACE N END_NAMESPACE"),
    ("UNION", "TYPE U : UNION a : INT; END_UNION; END_TYPE"),
    (
        "ANY types",
        "FUNCTION F : INT VAR_INPUT a : ANY_NUM; END_VAR END_FUNCTION",
    ),
    ("SFC", "PROGRAM P INITIAL_STEP s: END_STEP END_PROGRAM"),
    ("Instruction List", "PROGRAM P LD a ST b END_PROGRAM"),
    ("ACTION", "PROGRAM P A(); END_PROGRAM ACTION A: ; END_ACTION"),
    (
        "`S=`, `R=`, `REF=`",
        "PROGRAM P VAR a : BOOL; END_VAR a S= TRUE; END_PROGRAM",
    ),
    ("ADR", "PROGRAM P VAR a : INT; END_VAR a := ADR(a); END_PROGRAM"),
    (
        "SIZEOF",
        "PROGRAM P VAR a : INT; END_VAR a := SIZEOF(a); END_PROGRAM",
    ),
    (
        "MEMCPY and its kin",
        "PROGRAM P VAR a : INT; END_VAR MEMCPY(a, a, 2); END_PROGRAM",
    ),
    ("VAR_ACCESS", "PROGRAM P VAR_ACCESS a : INT; END_VAR END_PROGRAM"),
    ("VAR_CONFIG", "VAR_CONFIG a : INT; END_VAR"),
    (
        "VAR_STAT of a FUNCTION_BLOCK",
        "FUNCTION_BLOCK B VAR_STAT a : INT; END_VAR END_FUNCTION_BLOCK",
    ),
    (
        "VAR_STAT of a PROGRAM with several instances",
        "PROGRAM Q VAR_STAT a : INT; END_VAR END_PROGRAM CONFIGURATION C RESOURCE R ON x TASK T(INTERVAL := T#1ms);
         PROGRAM p WITH T : Q; PROGRAM q WITH T : Q; END_RESOURCE END_CONFIGURATION",
    ),
    (
        "VAR_INST",
        "FUNCTION_BLOCK B METHOD M VAR_INST a : INT; END_VAR END_METHOD END_FUNCTION_BLOCK",
    ),
    (
        "METHOD FB_Init",
        "FUNCTION_BLOCK B METHOD FB_Init : BOOL END_METHOD END_FUNCTION_BLOCK",
    ),
    (
        "METHOD FB_Exit, FB_Reinit",
        "FUNCTION_BLOCK B METHOD FB_Exit : BOOL END_METHOD END_FUNCTION_BLOCK",
    ),
    (
        "R_EDGE, F_EDGE",
        "PROGRAM P VAR_INPUT a : BOOL R_EDGE; END_VAR END_PROGRAM",
    ),
    ("JMP and labels", "PROGRAM P JMP a; END_PROGRAM"),
    (
        "EN and ENO",
        "PROGRAM P VAR t : TON; END_VAR t(EN := TRUE); END_PROGRAM",
    ),
];

fn text(row: &Row) -> String {
    let put = |part: &str| part.replace('@', row.example);
    let variables = put(row.variables);
    let variables = if variables.starts_with("VAR") {
        variables
    } else {
        format!("VAR {variables} END_VAR")
    };
    format!(
        "{}\nPROGRAM Main\n{variables}\n{}\nEND_PROGRAM\n",
        put(row.before),
        put(row.statements)
    )
}

fn supported() -> String {
    let mut table = "| | what | for example |\n| --- | --- | --- |\n".to_owned();
    let mut area = "";
    for row in ROWS {
        let shown = if row.area == area { "" } else { row.area };
        area = row.area;
        let _written = writeln!(
            table,
            "| {shown} | {} | `{}` |",
            row.what,
            row.example.replace('|', "\\|")
        );
    }
    table
}

fn help_of(source: &str) -> String {
    let report = checked(source);
    let refused = report
        .diagnostics()
        .iter()
        .find(|it| it.code == standstill_st::Code::Unsupported);
    let refused = refused.unwrap_or_else(|| panic!("{}", report.render()));
    refused.help.clone().unwrap_or_default()
}

fn refused() -> String {
    let mut table = "| refused | instead |\n| --- | --- |\n".to_owned();
    for (what, source) in REFUSED {
        let _written = writeln!(table, "| {what} | {} |", help_of(source));
    }
    table
}

#[test]
fn what_the_page_says_is_supported_works() {
    for row in ROWS {
        let text = text(row);
        assert!(
            text.contains(row.example),
            "{}: the example is no part of the program",
            row.what
        );
        let main = standstill_st::Options {
            program: Some("Main".to_owned()),
            ..standstill_st::Options::default()
        };
        let compiled = compile_with(&text, &main);
        let compiled = compiled.unwrap_or_else(|report| panic!("{}", report.render()));
        let mut running = Running::of(compiled);
        running.scan().unwrap_or_else(|fault| panic!("{fault}\n{text}"));
        assert_eq!(running.whole("r"), row.worth, "{}\n{text}", row.what);
    }
}

#[test]
fn what_the_page_says_is_refused_is_refused_with_what_to_write_instead() {
    for (what, source) in REFUSED {
        assert!(compile(source).is_err(), "{what}");
        assert!(!wrong(source).is_empty(), "{what}");
        assert!(!help_of(source).is_empty(), "{what}");
    }
}

/// The tables are between comments that name them.
#[test]
fn the_page_has_the_tables_of_these_tests() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/structured-text.md");
    let page = std::fs::read_to_string(&path).unwrap();
    let mut new = page.clone();
    for (name, table) in [("supported", supported()), ("refused", refused())] {
        let (begin, end) = (format!("<!-- begin {name} -->\n"), format!("<!-- end {name} -->"));
        let from = new.find(&begin).unwrap_or_else(|| panic!("no {begin}")) + begin.len();
        let to = new.find(&end).unwrap_or_else(|| panic!("no {end}"));
        new.replace_range(from..to, &table);
    }
    if std::env::var_os("STANDSTILL_DOCS").is_some_and(|it| it == "update") {
        std::fs::write(&path, &new).unwrap();
    } else {
        assert!(
            page == new,
            "docs/structured-text.md is old: run this test with STANDSTILL_DOCS=update"
        );
    }
}

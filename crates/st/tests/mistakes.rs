//! Errors: each is reported at its place, with its reason, and never causes a panic or a long run.

use crate::common;

use crate::common::{checked, source, wrong};
use standstill_st::{Code, Options, Severity, Source};
use standstill_testkit::Random;
use std::time::Instant;

/// The table says what its columns are.
const MISTAKES: &str = include_str!("mistakes.txt");

/// Covers: ST5, ST13, ST15, ST20, ST21, ST23, ST24, ST30
#[test]
fn every_mistake_is_told_at_its_place_with_what_to_do() {
    let mut failures = Vec::new();
    for row in MISTAKES.lines().filter(|line| !line.starts_with('#')) {
        let columns: Vec<&str> = row.splitn(4, " | ").collect();
        let [code, piece, word, text] = columns[..] else {
            panic!("a row has four columns: {row}");
        };
        let report = checked(text);
        let shown = report.render();
        let found = report
            .diagnostics()
            .iter()
            .find(|it| it.severity == Severity::Error);
        let good = found.is_some_and(|it| {
            let at = &text[it.span.start as usize..it.span.end as usize];
            it.code.name() == code && at == piece
        });
        if !good || !shown.to_lowercase().contains(&word.to_lowercase()) {
            failures.push(format!(
                "{text}\nwanted {code} at `{piece}` with {word}\n{shown}\n"
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
        "PROGRAM P VAR n : INT; k : ARRAY [0..3] OF INT; END_VAR #n := #n + 1; k[#n] := 3; END_PROGRAM",
        "SCL",
        "without it",
    ),
    (
        "DATA_BLOCK Data VAR n : INT; END_VAR BEGIN n := 3; END_DATA_BLOCK PROGRAM P END_PROGRAM",
        "DATA_BLOCK of SCL",
        "VAR_GLOBAL",
    ),
    (
        "ORGANIZATION_BLOCK Cycle VAR_TEMP x : INT; END_VAR BEGIN x := 3; END_ORGANIZATION_BLOCK PROGRAM P END_PROGRAM",
        "ORGANIZATION_BLOCK of SCL",
        "PROGRAM",
    ),
    (
        "PROGRAM P VAR_INPUT a, b : BOOL R_EDGE; END_VAR VAR n : INT; END_VAR IF a OR b THEN n := n + 1; END_IF; END_PROGRAM",
        "R_EDGE",
        "R_TRIG",
    ),
    (
        "PROGRAM P VAR_INPUT a : BOOL F_EDGE := TRUE; END_VAR VAR n : INT; END_VAR IF a THEN n := n + 1; END_IF; END_PROGRAM",
        "F_EDGE",
        "F_TRIG",
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
        let report = checked(text);
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
    let files = [
        source("a.st", "PROGRAM P VAR x : INT; END_VAR x := y; END_PROGRAM"),
        source("b.st", "TYPE E : (a, b) END_TYPE"),
    ];
    let report = standstill_st::check(&files, &Options::default());
    let told: Vec<_> = report.diagnostics().iter().map(|it| it.code).collect();
    assert_eq!(told, [Code::Syntax, Code::UnknownName], "{report}");
}

#[test]
fn at_most_fifty_are_kept_and_the_others_counted() {
    let body: String = (0..500).map(|n| format!("x{n} := 1;\n")).collect();
    let text = format!("PROGRAM P\n{body}END_PROGRAM");
    let report = standstill_st::check(&[source("prog.st", &text)], &Options::default());
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

const SOUP: &str = "PROGRAM END_PROGRAM FUNCTION END_FUNCTION FUNCTION_BLOCK END_FUNCTION_BLOCK TYPE END_TYPE STRUCT \
    END_STRUCT VAR VAR_INPUT VAR_OUTPUT VAR_IN_OUT VAR_TEMP VAR_EXTERNAL VAR_GLOBAL CONSTANT END_VAR \
    CONFIGURATION END_CONFIGURATION RESOURCE END_RESOURCE TASK WITH ON AT IF THEN ELSIF ELSE END_IF CASE OF \
    END_CASE FOR TO BY DO END_FOR WHILE END_WHILE REPEAT UNTIL END_REPEAT EXIT CONTINUE RETURN ARRAY INT \
    LREAL BOOL TIME TON MC_Power AXIS_REF a b P Q x 1 0 16#FF 1.5 T#1s INT# E# 's' %IX0.0 := => = <> < .. + - \
    * / ** ( ) [ ] , ; : . ^ AND NOT ABS INT_TO_LREAL METHOD END_METHOD THIS CLASS (* *) { } ü $ # ==";

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
    let soup: Vec<&str> = SOUP.split(' ').collect();
    for seed in 1..=standstill_testkit::cases(3000) {
        let mut random = Random(seed);
        let text = if seed % 2 == 0 {
            let count = random.place(120);
            let text: Vec<_> = (0..count).map(|_| soup[random.place(soup.len())]).collect();
            text.join(" ")
        } else {
            // The program with a few words left out, doubled, or replaced.
            let mut words = words.clone();
            for _ in 0..=random.place(4) {
                let at = random.place(words.len());
                match random.place(3) {
                    0 => drop(words.remove(at)),
                    1 => words.insert(at, words[at]),
                    _ => words[at] = soup[random.place(soup.len())],
                }
            }
            words.concat()
        };
        let result = std::panic::catch_unwind(|| match common::compile(&text) {
            Ok(compiled) => standstill_testkit::peers::module(&compiled.wasm),
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

/// Where a name is misspelt in its declaration, its uses are right.
#[test]
fn a_misspelt_declaration_is_told_once() {
    for (text, message) in [
        (
            "PROGRAM P VAR Stat : INT; END_VAR State := State + 1; FOR State := 1 TO 3 DO ; END_FOR; IF State > 1 THEN State := 0; END_IF; END_PROGRAM",
            "there is no variable `State`",
        ),
        (
            "FUNCTION_BLOCK Conveyr END_FUNCTION_BLOCK PROGRAM P VAR a, b : Conveyor; c : Conveyor; END_VAR a(); b(); c(); END_PROGRAM",
            "there is no type or function block `Conveyor`",
        ),
        (
            "FUNCTION Are : INT END_FUNCTION PROGRAM P VAR n : INT; END_VAR n := Area(); n := n + Area(); END_PROGRAM",
            "there is no function `Area`",
        ),
    ] {
        let told: Vec<_> = wrong(text).into_iter().map(|it| it.1).collect();
        assert_eq!(told, [message]);
    }
    // Each unit has its own variables.
    let told =
        wrong("FUNCTION_BLOCK B x := 1; x := 2; END_FUNCTION_BLOCK PROGRAM P x := 1; x := 2; END_PROGRAM");
    assert_eq!(told.len(), 2, "{told:?}");
}

/// Covers: ST21, ST30
#[test]
fn what_shares_nothing_is_allowed() {
    for text in [
        // Its own variable, a global one that is read, and one that is written outside of the loop.
        "VAR_GLOBAL i, n : INT; END_VAR FUNCTION F : INT VAR i : INT; END_VAR i := 5; n := n + 1; F := i; END_FUNCTION
         FUNCTION G : INT i := 0; END_FUNCTION
         PROGRAM P VAR s : INT; END_VAR s := G(); FOR i := 1 TO G() + 3 DO s := s + F(); END_FOR; s := G(); END_PROGRAM",
        "FUNCTION_BLOCK B VAR i : INT; END_VAR FOR i := 1 TO 3 DO ; END_FOR; END_FUNCTION_BLOCK
         PROGRAM P VAR b : B; i : INT; END_VAR FOR i := 1 TO 3 DO b(); END_FOR; END_PROGRAM",
        // One instance, known to others by reference.
        "FUNCTION_BLOCK B VAR In AT %IX0.0 : BOOL; END_VAR END_FUNCTION_BLOCK
         FUNCTION_BLOCK U VAR_IN_OUT b : B; END_VAR b(); END_FUNCTION_BLOCK
         PROGRAM P VAR b : ARRAY [1..1] OF B; u, v : U; END_VAR u(b := b[1]); v(b := b[1]); END_PROGRAM",
    ] {
        let told = wrong(text);
        assert!(told.iter().all(|it| it.0 == "portability"), "{told:?}");
    }
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

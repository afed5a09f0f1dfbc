//! The canonical layout of a text.

use standstill_st::format;

fn laid_out(text: &str) -> String {
    format("prog.st", text.as_bytes()).unwrap_or_else(|report| panic!("{}", report.render()))
}

/// Each line as it is typed, and as it is laid out; `None` if it is dropped.
#[rustfmt::skip]
const LINES: &[(&str, Option<&str>)] = &[
    ("\u{feff}type  Step:(Idle,Moving:=5 );", Some("TYPE Step : (Idle, Moving := 5);")),
    ("   Point : struct", Some("  Point : STRUCT")),
    ("x,y:lreal ; // of the plane", Some("    x, y : LREAL; // of the plane")),
    ("end_struct; end_type", Some("  END_STRUCT; END_TYPE")),
    ("", None),
    ("", Some("")),
    ("program  Main", Some("PROGRAM Main")),
    ("var", Some("VAR")),
    ("  a,b : int:=-5;   m:array[-1..2] of int := [1, 2(3)]; (* two", Some("  a, b : INT := -5; m : ARRAY [-1..2] OF INT := [1, 2(3)]; (* two")),
    ("   lines *)", Some("   lines *)")),
    ("(* a line that was ended\r\r", Some("  (* a line that was ended")),
    ("twice *)", Some("twice *)")),
    ("end_var", Some("END_VAR")),
    ("  var_input  Go : bool ; end_var", Some("VAR_INPUT Go : BOOL; END_VAR")),
    ("{region 'x'}", Some("{region 'x'}")),
    ("if Go and not( a>-b )then a:=a-1;", Some("IF Go AND NOT (a > -b) THEN a := a - 1;")),
    ("      elsif a=- 1 then", Some("ELSIF a = -1 THEN")),
    ("b := m[ -1 ]*( a+b );", Some("  b := m[-1] * (a + b);")),
    ("else", Some("ELSE")),
    ("   (* nothing *)", Some("  (* nothing *)")),
    ("   ;", Some("  ;")),
    ("  end_if;", Some("END_IF;")),
    ("case a of", Some("CASE a OF")),
    (" 1,2 .. 3: b:=1;", Some("  1, 2..3: b := 1;")),
    ("    for a := 1 to 3 by -1 do", Some("    FOR a := 1 TO 3 BY -1 DO")),
    (" exit;", Some("      EXIT;")),
    ("    end_for;", Some("    END_FOR;")),
    ("   INT#4:", Some("  INT#4:")),
    ("b := max(1,", Some("    b := max(1,")),
    ("a,", Some("      a,")),
    ("b", Some("      b")),
    (");", Some("    );")),
    ("else", Some("  ELSE")),
    ("b.3 := w.%X3;", Some("    b.3 := w.%X3;")),
    ("end_case;", Some("END_CASE;")),
    ("repeat", Some("REPEAT")),
    ("b := b", Some("  b := b")),
    ("+ 1; // up", Some("    + 1; // up")),
    ("until b>3", Some("UNTIL b > 3")),
    ("end_repeat;\r", Some("END_REPEAT;")),
    ("Mv(Axis:=X,Done=>d,", Some("Mv(Axis := X, Done => d,")),
    ("Execute := TRUE);", Some("  Execute := TRUE);")),
    ("Mv(Axis := X,Jerk:=,Velocity := );", Some("Mv(Axis := X, Jerk := , Velocity := );")),
    ("end_program", Some("END_PROGRAM")),
];

fn ugly() -> String {
    LINES.iter().map(|(typed, _)| format!("{typed}\n")).collect()
}

fn pretty() -> String {
    let lines = LINES.iter().filter_map(|(_, laid_out)| *laid_out);
    lines.map(|line| format!("{line}\n")).collect()
}

#[test]
fn a_text_is_indented_by_what_is_open_and_its_lines_stay() {
    assert_eq!(laid_out(&ugly()), pretty());
}

#[test]
fn what_is_laid_out_stays_as_it_is() {
    assert_eq!(laid_out(&pretty()), pretty());
    let methods = "FUNCTION_BLOCK A
VAR
  n : INT;
END_VAR

METHOD Up : INT
VAR_INPUT Step : INT := 1; END_VAR
n := n + Step; // more
Up := THIS^.n;
END_METHOD

n := -n;
END_FUNCTION_BLOCK
";
    assert_eq!(laid_out(methods), methods);
    // Mistakes of types and names do not matter. A text that cannot be read is not changed.
    assert!(format("prog.st", b"PROGRAM P IF x THEN END_PROGRAM").is_err());
}

/// The texts of the repository do not change in a second layout, and keep their words.
#[test]
fn programs_of_the_repository_keep_their_words() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut count = 0;
    for place in [
        "scan-tests/gallery",
        "scan-tests/structured_text",
        "crates/examples",
    ] {
        let mut folders = vec![folder.join(place)];
        while let Some(inner) = folders.pop() {
            for entry in std::fs::read_dir(inner).unwrap().flatten() {
                let path = entry.path();
                if path.is_dir() {
                    folders.push(path);
                } else if path.extension().is_some_and(|it| it == "st") {
                    let text = std::fs::read_to_string(&path).unwrap();
                    let once = laid_out(&text);
                    assert_eq!(laid_out(&once), once, "{}", path.display());
                    let words = |text: &str| text.to_uppercase().split_whitespace().collect::<String>();
                    assert_eq!(words(&once), words(&text), "{}", path.display());
                    count += 1;
                }
            }
        }
    }
    assert!(count >= 5, "{count}");
}

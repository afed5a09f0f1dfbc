//! Names and numbers of other systems.

use crate::common::{Running, compile_with};

use standstill_st::{Compiled, Dialect, Options, Report};

fn dialect() -> Dialect {
    let three = |one: &str, two: &str, there: &str| (one.to_owned(), two.to_owned(), there.to_owned());
    Dialect {
        name: "other".to_owned(),
        types: vec![
            ("AXIS_REF".to_owned(), "AXIS_OF_OTHERS".to_owned()),
            ("MC_DIRECTION".to_owned(), "Ways".to_owned()),
        ],
        elements: vec![three("MC_DIRECTION", "mcPositiveDirection", "Up")],
        numbers: vec![("MC_DIRECTION".to_owned(), -1, "mcNegativeDirection".to_owned())],
        pins: vec![three("MC_Power", "EnablePositive", "Enable_Positive")],
        others: Vec::new(),
    }
}

fn compiled(body: &str) -> Result<Compiled, Box<Report>> {
    let text = format!(
        "PROGRAM Main VAR X : AXIS_OF_OTHERS; p : MC_Power; m : MC_MoveAbsolute; w : Ways; b : BOOL; END_VAR {body} END_PROGRAM"
    );
    let options = Options {
        dialect: dialect(),
        ..Options::default()
    };
    compile_with(&text, &options)
}

/// Covers: ST42
#[test]
fn names_and_numbers_of_a_dialect_are_ours() {
    let body = "p(Axis := X, Enable_Positive := FALSE); b := p.Enable_Positive; p.EnableNegative := TRUE;
        w := Up; w := Ways#Up; w := Ways.mcCurrentDirection; m.Direction := -1;";
    let mut run = Running::of(compiled(body).unwrap_or_else(|report| panic!("{report}")));
    run.scan().unwrap();
    assert_eq!(run.whole("w"), 4);
    assert_eq!(run.whole("m.Direction"), 3);
    assert_eq!(run.whole("p.EnablePositive"), 0);
}

/// Covers: ST42
#[test]
fn what_a_dialect_does_not_have_is_told() {
    for (body, message) in [
        ("m.Direction := 2;", "has the number 2 in the dialect other"),
        ("w := Down;", "there is no variable `Down`"),
        ("p(Enable_Negative := TRUE);", "has no pin `Enable_Negative`"),
    ] {
        let report = compiled(body).unwrap_err();
        let told = report.diagnostics().iter().any(|it| it.message.contains(message));
        assert!(told, "{body}\n{report}");
    }
}

/// Covers: ST42
#[test]
fn a_pin_of_another_dialect_is_told_with_ours() {
    let others = ["this", "that"].map(|name| Dialect {
        name: name.to_owned(),
        pins: vec![("CTU".to_owned(), "R".to_owned(), "RESET".to_owned())],
        ..Dialect::default()
    });
    let options = Options {
        dialect: Dialect {
            others: others.to_vec(),
            ..Dialect::default()
        },
        ..Options::default()
    };
    let text = "PROGRAM P VAR c : CTU; END_VAR c(RESET := TRUE); c.RESET := TRUE; END_PROGRAM";
    let report = compile_with(text, &options).unwrap_err();
    let help = "here it is `R`; --dialect this or that takes the names of that system";
    let helps: Vec<_> = report.diagnostics().iter().map(|it| it.help.as_deref()).collect();
    assert_eq!(helps, [Some(help); 2], "{report}");
}

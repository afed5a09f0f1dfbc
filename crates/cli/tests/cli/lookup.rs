//! Reference output: blocks, errors, completions, manual pages.

use crate::support::{Ended, read, scratch, standstill};
use std::path::Path;
use std::process::Command;

fn asked(arguments: &[&str]) -> Ended {
    standstill(Path::new("."), arguments)
}

#[test]
fn a_block_is_found_by_its_name() {
    let one = asked(&["blocks", "MC_TouchProbe"]);
    assert_eq!(one.status, 0, "{}", one.err);
    one.prints_first("MC_TouchProbe  (administrative)\n");
    assert!(
        one.out.contains("WindowOnly") && !one.out.contains("MC_AbortTrigger  ("),
        "{}",
        one.out
    );
    let two = asked(&["blocks", "mc_stop", "MC_HALT", "--json"]);
    let list: serde_json::Value = serde_json::from_str(&two.out).unwrap();
    let names: Vec<_> = list
        .as_array()
        .unwrap()
        .iter()
        .map(|block| &block["name"])
        .collect();
    assert_eq!(names, ["MC_Stop", "MC_Halt"]);
    let slip = asked(&["blocks", "MC_TouchProb"]);
    assert_eq!((slip.status, slip.out.as_str()), (2, ""));
    slip.complains("there is no block MC_TouchProb; did you mean `MC_TouchProbe`?");
}

#[test]
fn an_error_is_explained_by_number_and_by_name() {
    let by_number = asked(&["blocks", "--error", "201"]);
    assert_eq!(by_number.status, 0, "{}", by_number.err);
    by_number.prints_first("201 NotPowered\n    ");
    assert!(
        by_number.out.contains("\n    remedy: ") && by_number.out.contains("MC_Power"),
        "{}",
        by_number.out
    );
    for other in [
        &["explain-error", "201"][..],
        &["explain-error", "notpowered"],
        &["blocks", "--error", "NotPowered"],
    ] {
        assert_eq!(asked(other).out, by_number.out, "{other:?}");
    }
    for (wanted, remedy) in [
        ("199", "of its hundred there are 100, 101"),
        ("842", "numbers are from 100 to 999"),
        ("NotPowerd", "did you mean `NotPowered`?"),
        ("-7", "such as 201"),
    ] {
        let none = asked(&["explain-error", "--", wanted]);
        assert_eq!((none.status, none.out.as_str()), (2, ""), "{wanted}");
        assert!(
            none.err.contains(&format!("there is no ErrorID {wanted}; ")) && none.err.contains(remedy),
            "{}",
            none.err
        );
    }
}

#[test]
fn every_shell_has_its_completions() {
    for shell in ["bash", "elvish", "fish", "powershell", "zsh"] {
        let ended = asked(&["completions", shell]);
        assert_eq!(ended.status, 0, "{}", ended.err);
        assert!(
            ended.out.contains("compare-planners") && ended.out.contains("strict"),
            "{shell}"
        );
    }
    assert_eq!(asked(&["completions", "tcsh"]).status, 2);
    // The use by bash: a command and one of its options are completed.
    let script = asked(&["completions", "bash"]).out;
    let complete = format!(
        "{script}\nCOMP_WORDS=(standstill test --str); COMP_CWORD=2; _standstill standstill --str test; echo \"${{COMPREPLY[@]}}\""
    );
    let Ok(output) = Command::new("bash").args(["-c", &complete]).output() else {
        println!("SKIP: no bash");
        return;
    };
    assert_eq!(
        String::from_utf8_lossy(&output.stdout).trim(),
        "--strict",
        "{output:?}"
    );
}

#[test]
fn every_command_has_a_manual_page() {
    let folder = scratch("lookup_man");
    let ended = standstill(&folder, &["man", "pages/man1"]);
    assert_eq!(
        (ended.status, ended.out.as_str()),
        (0, "manual pages are in pages/man1\n")
    );
    assert!(read(&folder, "pages/man1/standstill.1").contains("standstill\\-test(1)"));
    let page = read(&folder, "pages/man1/standstill-test.1");
    assert!(
        page.contains(".TH standstill-test 1") && page.contains("\\-\\-strict"),
        "{page}"
    );
    // A folder that cannot be made.
    let clash = standstill(&folder, &["man", "pages/man1/standstill.1/more"]);
    assert_eq!(clash.status, 4);
    clash.complains_first("error: pages/man1/standstill.1/more: ");
}

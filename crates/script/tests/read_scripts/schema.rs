//! The JSON Schema against an independent validator, the committed file, and the reader.

use super::cases::{By, GOOD, cases};
use standstill_script::{machine_schema, map_schema, read, schema, sweep_schema};
use standstill_testkit::peers::Schema;
use std::path::{Path, PathBuf};

#[test]
fn the_committed_schema_is_fresh() {
    for (file, fresh, command) in [
        ("scan-script.schema.json", schema(), "schema"),
        ("compare-map.schema.json", map_schema(), "schema map"),
        ("sweep.schema.json", sweep_schema(), "schema sweep"),
        ("machine-file.schema.json", machine_schema(), "schema machine"),
    ] {
        let path = docs().join(file);
        let committed = std::fs::read_to_string(&path).unwrap_or_default();
        assert!(
            committed == fresh,
            "docs/{file} is stale: write the output of `standstill {command}` to it"
        );
    }
}

fn docs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs")
}

#[test]
fn the_schema_of_machine_files_takes_good_ones_and_refuses_others() {
    // Nothing in it but what is used.
    for unused in ["\"step\"", "\"claim\"", "\"conditions\""] {
        assert!(!machine_schema().contains(&format!("{unused}: {{")), "{unused}");
    }
    let Some(validator) = Schema::new(&machine_schema()) else {
        return;
    };
    let path = docs().join("../scan-tests/include/feeder.machine.json");
    let good = std::fs::read_to_string(path).unwrap();
    assert_eq!(validator.check(&good), Ok(()));
    assert_eq!(validator.check(r#"{"standstill": 1}"#), Ok(()));
    for (from, to) in [
        ("\"standstill\": 1", "\"standstill\": 2"),
        ("\"inputs\"", "\"steps\": [], \"inputs\""),
        ("\"inputs\"", "\"cycle\": \"T#1ms\", \"inputs\""),
        ("\"velocity\": 400, ", "\"velocity\": -400, "),
        ("\"Distance\"", "\"Way\""),
        ("MC_MoveRelative", "MC_MoveSideways"),
    ] {
        assert!(good.contains(from), "{from}");
        assert!(
            validator.check(&good.replacen(from, to, 1)).is_err(),
            "{from} as {to}"
        );
    }
}

#[test]
fn the_schema_of_maps_takes_good_ones_and_refuses_others() {
    let Some(validator) = Schema::new(&map_schema()) else {
        return;
    };
    let good = std::fs::read_to_string(docs().join("compare/map.json")).unwrap();
    assert_eq!(validator.check(&good), Ok(()));
    for offset in ["\"T#-1ms\"", r#"{"edge": "feed.Busy", "to": true, "number": 2}"#] {
        let fit = r#"{"fit": "X.Position", "from": "T#-200ms", "to": "T#200ms"}"#;
        assert!(good.contains(fit));
        assert_eq!(validator.check(&good.replace(fit, offset)), Ok(()));
        assert!(validator.check(&good.replace(fit, "0")).is_err());
    }
    for (from, to) in [
        ("\"column\": \"Axis1.ActPos\", ", ""),
        ("\"sign\": -1", "\"sign\": 2"),
        ("\"ms\"", "\"minutes\""),
        ("\"tolerance\": 0.02", "\"tolerance\": -0.02"),
        ("\"signals\"", "\"signal\""),
    ] {
        assert!(good.contains(from), "{from}");
        assert!(
            validator.check(&good.replacen(from, to, 1)).is_err(),
            "{from} as {to}"
        );
    }
}

#[test]
fn the_schema_of_sweeps_takes_good_ones_and_refuses_others() {
    let Some(validator) = Schema::new(&sweep_schema()) else {
        return;
    };
    let good = std::fs::read_to_string(docs().join("sweeps/turn.sweep.json")).unwrap();
    assert_eq!(validator.check(&good), Ok(()));
    let sample = r#"{"standstill_sweep": 1, "script": "a.scan.json",
        "sample": {"seed": 0, "count": 5, "of": {"v": {"from": 1, "to": 2}, "note": [1, "NaN"]}}}"#;
    assert_eq!(validator.check(sample), Ok(()));
    for (from, to) in [
        ("\"script\"", "\"scripts\""),
        ("[20, 40, 60]", "[]"),
        ("[20, 40, 60]", "20"),
        ("\"count\": 5", "\"count\": 1"),
        ("\"scale\": \"log\"", "\"scale\": \"root\""),
        ("\"first\"", "\"second\""),
        ("\"grid\"", "\"sample\""),
        (
            "\"measure\"",
            "\"sample\": {\"seed\": 1, \"count\": 1, \"of\": {\"v\": [1]}}, \"measure\"",
        ),
    ] {
        assert!(good.contains(from), "{from}");
        assert!(
            validator.check(&good.replacen(from, to, 1)).is_err(),
            "{from} as {to}"
        );
    }
}

#[test]
fn good_scripts_pass_the_schema_and_the_reader() {
    let validator = Schema::new(&schema());
    let scripts = [
        GOOD,
        include_str!("contract_example.scan.json"),
        include_str!("every_key.scan.json"),
    ];
    for script in scripts {
        if let Some(validator) = &validator {
            assert_eq!(validator.check(script), Ok(()), "{script}");
        }
        if let Err(error) = read(script, "good.scan.json", &[]) {
            panic!("{error}");
        }
    }
}

#[test]
fn the_schema_refuses_what_a_schema_can_refuse() {
    let Some(validator) = Schema::new(&schema()) else {
        return;
    };
    let mut wrong = Vec::new();
    for case in cases() {
        let accepted = validator.check(&case.text(GOOD)).is_ok();
        match case.by {
            By::Schema if accepted => wrong.push(format!("the schema takes: {}", case.title)),
            By::Reader if !accepted => wrong.push(format!("the schema also refuses: {}", case.title)),
            By::Syntax | By::Schema | By::Reader => {}
        }
    }
    assert_eq!(wrong, Vec::<String>::new());
}

//! The JSON Schema against an independent validator, the committed file, and the reader.

use crate::cases::{By, GOOD, cases};
use boon::{Compiler, SchemaIndex, Schemas};
use standstill_script::{read, schema};
use std::path::Path;

struct Validator {
    schemas: Schemas,
    index: SchemaIndex,
}

impl Validator {
    fn new() -> Self {
        let mut schemas = Schemas::new();
        let mut compiler = Compiler::new();
        let document = serde_json::from_str(&schema()).unwrap();
        compiler
            .add_resource("scan-script.schema.json", document)
            .unwrap();
        let index = compiler.compile("scan-script.schema.json", &mut schemas).unwrap();
        Self { schemas, index }
    }

    fn accepts(&self, script: &str) -> Result<(), String> {
        let value = serde_json::from_str(script).map_err(|error| error.to_string())?;
        self.schemas
            .validate(&value, self.index)
            .map_err(|error| format!("{error:#}"))
    }
}

#[test]
fn the_committed_schema_is_fresh() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/scan-script.schema.json");
    let committed = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == schema(),
        "docs/scan-script.schema.json is stale: write the output of `standstill schema` to it"
    );
}

#[test]
fn good_scripts_pass_the_schema_and_the_reader() {
    let validator = Validator::new();
    let scripts = [
        GOOD,
        include_str!("contract_example.scan.json"),
        include_str!("every_key.scan.json"),
    ];
    for script in scripts {
        assert_eq!(validator.accepts(script), Ok(()), "{script}");
        if let Err(error) = read(script, "good.scan.json", &[]) {
            panic!("{error}");
        }
    }
}

#[test]
fn the_schema_refuses_what_a_schema_can_refuse() {
    let validator = Validator::new();
    for case in cases() {
        let accepted = validator.accepts(&case.text()).is_ok();
        match case.by {
            By::Syntax => {}
            By::Schema => assert!(!accepted, "the schema takes: {}", case.title),
            By::Reader => assert!(accepted, "the schema also refuses: {}", case.title),
        }
    }
}

//! The information of the program about itself: blocks, schema, version, help.

use crate::support::{command, ended};
use serde_json::Value;

fn printed(arguments: &[&str]) -> String {
    let ended = ended(&mut command(arguments));
    assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{arguments:?}");
    ended.out
}

#[test]
fn blocks_are_listed_with_every_pin_as_data() {
    let blocks: Value = serde_json::from_str(&printed(&["blocks", "--json"])).expect("JSON");
    let blocks = blocks.as_array().expect("a list");
    for block in blocks {
        let keys: Vec<_> = block.as_object().expect("an object").keys().collect();
        // serde_json sorts keys; the order of the text is checked below.
        assert_eq!(keys, ["doc", "group", "in_outs", "inputs", "name", "outputs"]);
        let groups = [
            "administrative",
            "single_axis",
            "multi_axis",
            "homing",
            "standard",
        ];
        assert!(
            groups.contains(&block["group"].as_str().expect("a string")),
            "{block}"
        );
        for pin in ["in_outs", "inputs", "outputs"]
            .iter()
            .flat_map(|kind| block[kind].as_array().expect("a list"))
        {
            let keys: Vec<_> = pin.as_object().expect("an object").keys().collect();
            assert_eq!(keys, ["default", "doc", "extension", "name", "type", "unit"]);
            let references = ["AXIS_REF", "MC_INPUT_REF", "MC_OUTPUT_REF"];
            assert_eq!(
                pin["default"].is_null(),
                references.iter().any(|name| pin["type"] == *name),
                "{}.{}",
                block["name"],
                pin["name"]
            );
        }
    }
    let block = |name: &str| {
        blocks
            .iter()
            .find(|block| block["name"] == name)
            .expect("a block")
    };
    let pin = |block: &Value, name: &str| {
        let pins = ["in_outs", "inputs", "outputs"]
            .iter()
            .flat_map(|kind| block[kind].as_array().expect("a list"));
        pins.into_iter()
            .find(|pin| pin["name"] == name)
            .expect("a pin")
            .clone()
    };
    let absolute = block("MC_MoveAbsolute");
    assert_eq!(pin(absolute, "BufferMode")["default"], "mcAborting");
    assert_eq!(pin(absolute, "BufferMode")["type"], "MC_BUFFER_MODE");
    assert_eq!(pin(absolute, "Position")["unit"], "u");
    assert_eq!(pin(absolute, "Snap")["extension"], true);
    assert_eq!(pin(absolute, "Execute")["default"], false);
    assert_eq!(pin(block("TON"), "PT")["default"], "T#0s");
}

#[test]
fn blocks_are_listed_for_people_too() {
    let text = printed(&["blocks"]);
    assert!(text.starts_with("MC_Power  (administrative)\n"));
    assert!(text.contains("\n    in      Position"));
}

#[test]
fn keys_stand_in_the_published_order() {
    let text = printed(&["blocks", "--json"]);
    let first = text.lines().nth(1).expect("a block");
    let places: Vec<_> = ["name", "group", "doc", "in_outs", "inputs", "outputs"]
        .iter()
        .map(|key| first.find(&format!("\"{key}\":")).expect("the key"))
        .collect();
    assert!(places.is_sorted(), "{first}");
    assert!(
        first.contains(
            r#"{"name":"Axis","type":"AXIS_REF","default":null,"unit":"","extension":false,"doc":"#
        )
    );
}

#[test]
fn the_schema_is_json() {
    let schema: Value = serde_json::from_str(&printed(&["schema"])).expect("JSON");
    assert_eq!(schema["$schema"], "https://json-schema.org/draft/2020-12/schema");
}

#[test]
fn version_and_help_go_to_standard_output() {
    assert_eq!(
        printed(&["--version"]),
        format!("standstill {}\n", env!("CARGO_PKG_VERSION"))
    );
    assert!(printed(&["--help"]).contains("Exit status: 0 passed"));
}

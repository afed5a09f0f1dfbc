//! The XML library is read back with a reader that is not ours, and has every pin of every block.

use plcopen::Root_project_Inline;
use standstill_blocks::REGISTRY;
use standstill_export::{Dialect, Prefix, Target, export};
use standstill_fb::Direction;

#[test]
fn another_reader_finds_every_pin_of_every_block() {
    let files = export(Target::PlcopenXml, &Prefix::default(), &Dialect::default());
    let project: Root_project_Inline = plcopen::from_str(&files[0].text).unwrap();
    let types = project.types.unwrap();
    let pous = types.pous.unwrap().pou;
    assert_eq!(pous.len(), REGISTRY.len());
    for (pou, info) in pous.iter().zip(REGISTRY) {
        assert_eq!(pou.name.trim_start_matches("STANDSTILL_"), info.name);
        assert_eq!(pou.pou_type, "functionBlock");
        let interface = pou.interface.as_ref().unwrap();
        let mut found: Vec<(Direction, &str)> = Vec::new();
        let in_outs = interface.in_out_vars.iter().flat_map(|list| &list.variable);
        found.extend(in_outs.map(|variable| (Direction::InOut, variable.name.as_str())));
        let inputs = interface.input_vars.iter().flat_map(|list| &list.variable);
        found.extend(inputs.map(|variable| (Direction::Input, variable.name.as_str())));
        let outputs = interface.output_vars.iter().flat_map(|list| &list.variable);
        found.extend(outputs.map(|variable| (Direction::Output, variable.name.as_str())));
        let expected: Vec<_> = info.pins().map(|pin| (pin.direction, pin.name)).collect();
        assert_eq!(found, expected, "{}", info.name);
        assert!(pou.body.iter().any(|body| body.st.is_some()), "{}", info.name);
    }
    let declared: Vec<_> = types
        .data_types
        .unwrap()
        .data_type
        .iter()
        .map(|ty| ty.name.clone())
        .collect();
    for pin in REGISTRY.iter().flat_map(|info| info.pins()) {
        let name = pin.ty.iec_name();
        let elementary = ["BOOL", "INT", "LREAL", "UINT", "WORD", "DWORD", "TIME"].contains(&name);
        assert!(
            elementary || declared.iter().any(|ty| ty == name),
            "{name} is not declared"
        );
    }
}

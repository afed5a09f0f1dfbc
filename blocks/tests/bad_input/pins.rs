//! Every bad value at every pin.

use super::{Cell, rows, same_motion, trigger};
use crate::bench::Bench;
use standstill_axis::{Event, Record};
use standstill_blocks::{BlockInstance, REGISTRY};
use standstill_fb::{AnyInstance, PinType, Value};
use std::collections::BTreeSet;

/// The values tried at a pin of this type, in the order of the cells; one list for each cell.
fn values(ty: PinType) -> Vec<Vec<Value>> {
    let one = |value| vec![value];
    match ty {
        PinType::Lreal => [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -1.0, 1e300]
            .map(|value| one(Value::Lreal(value)))
            .into(),
        PinType::Int => [0, -1, i16::MAX].map(|value| one(Value::Int(value))).into(),
        PinType::Time => [0, -1, i64::MAX].map(|value| one(Value::Time(value))).into(),
        PinType::Enum(info) => {
            let beyond = info.elements.iter().map(|(_, number)| number + 1).max();
            vec![[i32::MIN, -1, beyond.unwrap(), i32::MAX].map(Value::Enum).into()]
        }
        PinType::Uint => [0, 1, u16::MAX].map(|value| one(Value::Word(value))).into(),
        PinType::Bool | PinType::Word | PinType::Dword | PinType::Axis(_) | PinType::Table(_) => Vec::new(),
    }
}

fn table() -> Vec<(&'static str, &'static str, Vec<Cell>)> {
    rows(include_str!("pins.txt"))
}

/// Covers: R91
#[test]
fn every_numeric_and_enumeration_pin_has_its_row() {
    let mut expected = BTreeSet::new();
    for info in REGISTRY {
        for pin in info.pins().take(info.input_count()) {
            let cells = values(pin.ty).len();
            if cells > 0 {
                expected.insert((info.name, pin.name, cells));
            }
        }
    }
    let rows = table();
    let found: BTreeSet<_> = rows
        .iter()
        .map(|(block, pin, cells)| (*block, *pin, cells.len()))
        .collect();
    assert_eq!(found.len(), rows.len(), "a row stands in pins.txt twice");
    let missing: Vec<_> = expected.difference(&found).collect();
    let surplus: Vec<_> = found.difference(&expected).collect();
    let lists = (missing.is_empty(), surplus.is_empty());
    assert_eq!(
        lists,
        (true, true),
        "pins.txt lacks {missing:?}, and has besides {surplus:?}"
    );
}

fn clamped(bench: &Bench, pin: &str) -> bool {
    bench.log.since(0).any(
        |record| matches!(record, Record { event: Event::Clamped { pin: found, .. }, .. } if *found == pin),
    )
}

fn refused(bench: &Bench, pin: &str) -> bool {
    bench.log.since(0).any(|record| match record.event {
        Event::Refused { pin: found, .. } => found == pin,
        // A value of a profile that is invalid only in combination with its table.
        Event::PointRefused { .. } => true,
        _ => false,
    })
}

/// Covers: R17, R18, R34, R38, R53, R56, R58, R91, R92, V1, V2, V8, V8a, T5
#[test]
fn each_value_gives_what_its_cell_says() {
    for (name, pin, cells) in table() {
        let info = standstill_blocks::registry::find(name).unwrap();
        let (_, entry) = info.pin(pin).unwrap();
        for (cell, values) in cells.into_iter().zip(values(entry.ty)) {
            for value in values {
                let mut bench = Bench::ready_for(name);
                let mut block = bench.block(name);
                let good = bench.get(&block, pin).unwrap();
                bench.set(&mut block, pin, value);
                let what = format!("{name}.{pin} = {value:?}, {cell:?}");
                let Some(trigger) = trigger(&block) else {
                    // A standard block: it has no Error and ignores the value.
                    bench.scan(&mut [&mut block]);
                    continue;
                };
                bench.set(&mut block, trigger, Value::Bool(true));
                let still = bench.clone();
                bench.scan(&mut [&mut block]);
                assert_eq!(bench.error(&block), cell.error(), "{what}");
                assert_eq!(bench.flag(&block, "Error"), cell.error() != 0, "{what}");
                assert_eq!(clamped(&bench, pin), cell == Cell::Clamped, "{what}");
                if cell.error() != 0 {
                    unaffected(&bench, still, &what);
                    // An Enable block stays Busy: the error is recoverable.
                    assert_eq!(bench.flag(&block, "Busy"), trigger == "Enable", "{what}");
                    // A block that only reads leaves no record.
                    let writes =
                        trigger != "Enable" || ["MC_SetOverride", "MC_DigitalCamSwitch"].contains(&name);
                    assert_eq!(refused(&bench, pin), writes, "{what}");
                    recovers(&mut bench, &mut block, (trigger, pin, good), &what);
                    a_motion_goes_on(name, pin, value, trigger, &what);
                }
                for _ in 0..50 {
                    bench.scan(&mut [&mut block]);
                }
            }
        }
    }
}

/// Compares the axis with one that was not called.
fn unaffected(bench: &Bench, mut without: Bench, what: &str) {
    without.scan(&mut []);
    assert!(same_motion(bench, &without, 0), "{what}");
}

/// With a valid value the block works, an Enable block without a new edge.
fn recovers(
    bench: &mut Bench,
    block: &mut BlockInstance,
    (trigger, pin, good): (&str, &str, Value),
    what: &str,
) {
    bench.set(block, pin, good);
    if trigger != "Enable" {
        bench.scan(&mut [block]);
        assert!(
            bench.flag(block, "Error"),
            "{what}: Error goes before the trigger"
        );
        bench.set(block, trigger, Value::Bool(false));
        bench.scan(&mut [block]);
        assert!(!bench.flag(block, "Error") && bench.error(block) == 0, "{what}");
        bench.set(block, trigger, Value::Bool(true));
    }
    bench.scan(&mut [block]);
    assert!(!bench.flag(block, "Error"), "{what}: mended");
    // MC_SetPosition is done in the call.
    let done = block.info().pin("Done").is_some() && bench.flag(block, "Done");
    assert!(bench.flag(block, "Busy") || done, "{what}: mended");
}

/// The bad command changes neither the motion of another instance nor the outputs of that instance.
fn a_motion_goes_on(name: &str, pin: &str, value: Value, trigger: &str, what: &str) {
    let mut bench = Bench::new();
    let mut owner = bench.block("MC_MoveVelocity");
    bench.set(&mut owner, "Execute", Value::Bool(true));
    for _ in 0..20 {
        bench.scan(&mut [&mut owner]);
    }
    let (mut without, mut twin) = (bench.clone(), owner);
    let mut block = bench.block(name);
    bench.set(&mut block, pin, value);
    bench.set(&mut block, trigger, Value::Bool(true));
    for _ in 0..50 {
        bench.scan(&mut [&mut owner, &mut block]);
        without.scan(&mut [&mut twin]);
        assert!(bench.flag(&block, "Error"), "{what}: in motion");
        assert!(bench.flag(&owner, "Active"), "{what}: in motion");
        assert!(same_motion(&bench, &without, 0), "{what}: in motion");
    }
}

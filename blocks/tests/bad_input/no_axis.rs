//! Every block wired to no axis, or to one that does not exist.

use super::{refers_to_axis, same_motion, trigger};
use crate::bench::{AXIS, Bench};
use standstill_axis::{AxisId, ErrorId, Event};
use standstill_blocks::REGISTRY;
use standstill_fb::{AnyInstance, Value};

/// Covers: R38, R55, R57, T39f
#[test]
fn an_axis_that_does_not_exist_is_an_error_until_the_next_edge() {
    for info in REGISTRY.iter().filter(|info| refers_to_axis(info)) {
        for nowhere in [AxisId::NONE, AxisId::new(2)] {
            let mut bench = Bench::new();
            let mut without = bench.clone();
            let mut block = bench.block(info.name);
            let trigger = trigger(&block).unwrap();
            bench.wire(&mut block, nowhere);
            bench.scan(&mut [&mut block]);
            assert!(
                !bench.flag(&block, "Error"),
                "{}: not asked for anything",
                info.name
            );
            let told = bench.log.total();
            bench.set(&mut block, trigger, Value::Bool(true));
            for _ in 0..3 {
                bench.scan(&mut [&mut block]);
                assert!(bench.flag(&block, "Error"), "{}", info.name);
                assert_eq!(
                    bench.error(&block),
                    ErrorId::AxisUnknown.number(),
                    "{}",
                    info.name
                );
                for pin in ["Busy", "Valid", "Active", "Done", "Status"] {
                    assert!(!bench.flag(&block, pin), "{}.{pin}", info.name);
                }
            }
            // No axis can record that the slave does not exist.
            if block.info().pin("Slave").is_some() {
                let records: Vec<_> = bench.log.since(told).map(|record| record.event).collect();
                let refused = Event::Refused {
                    pin: "Slave",
                    value: f64::from(nowhere.number()),
                    limit: 2.0,
                    error: ErrorId::AxisUnknown,
                };
                assert_eq!(records, [refused], "{}", info.name);
            }
            for _ in 0..4 {
                without.scan(&mut []);
            }
            assert!(same_motion(&bench, &without, 0) && same_motion(&bench, &without, 1));
            bench.wire(&mut block, AXIS);
            bench.set(&mut block, trigger, Value::Bool(false));
            bench.scan(&mut [&mut block]);
            assert!(
                !bench.flag(&block, "Error") && bench.error(&block) == 0,
                "{}",
                info.name
            );
            bench.set(&mut block, trigger, Value::Bool(true));
            bench.scan(&mut [&mut block]);
            // A block that ends a coupling finds no coupling.
            let error = match info.name {
                "MC_GearOut" | "MC_CamOut" | "MC_PhasingAbsolute" | "MC_PhasingRelative" => {
                    ErrorId::NotCoupled
                }
                _ => ErrorId::None,
            };
            assert_eq!(bench.error(&block), error.number(), "{}", info.name);
        }
    }
}

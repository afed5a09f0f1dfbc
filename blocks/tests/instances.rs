//! The guarantees of instances for a host: which command they follow, and how long their results are
//! kept.

use crate::bench::Bench;
use standstill_axis::{AxisId, AxisState, ErrorId, Event};
use standstill_fb::{TableRef, Value};

/// Covers: R7
#[test]
fn an_instance_keeps_to_the_axis_it_commanded() {
    let mut bench = Bench::new();
    let mut moving = bench.block("MC_MoveAbsolute");
    bench.set(&mut moving, "Execute", Value::Bool(true));
    bench.scan(&mut [&mut moving]);
    bench.set(&mut moving, "Axis", Value::Axis(AxisId::new(1)));
    bench.scan(&mut [&mut moving]);
    assert!(bench.flag(&moving, "Busy"));
    assert_eq!(bench.axes[1].state(), AxisState::Standstill);
    for _ in 0..2000 {
        bench.scan(&mut [&mut moving]);
    }
    assert!(bench.flag(&moving, "Done"));
    assert_eq!(bench.axes[0].setpoint().position, 1.0);
}

/// Covers: R94
#[test]
fn numbers_of_commands_rise() {
    let mut bench = Bench::new();
    let mut last = None;
    for _ in 0..5 {
        let mut moving = bench.block("MC_MoveVelocity");
        bench.set(&mut moving, "Execute", Value::Bool(true));
        bench.scan(&mut [&mut moving]);
        let id = bench.axes[0].active_command();
        assert!(id > last, "{id:?} after {last:?}");
        last = id;
    }
}

/// Covers: R36, R37, R95
#[test]
fn a_result_is_kept_for_64_later_commands() {
    for (later, expected) in [(63, ErrorId::None), (65, ErrorId::FateLost)] {
        let mut bench = Bench::new();
        let mut forgotten = bench.block("MC_MoveVelocity");
        bench.set(&mut forgotten, "Execute", Value::Bool(true));
        bench.scan(&mut [&mut forgotten]);
        for _ in 0..later {
            let mut next = bench.block("MC_MoveVelocity");
            bench.set(&mut next, "Execute", Value::Bool(true));
            bench.scan(&mut [&mut next]);
            assert!(bench.flag(&forgotten, "Busy"), "outputs change in calls only");
        }
        bench.scan(&mut [&mut forgotten]);
        assert_eq!(bench.error(&forgotten), expected.number(), "{later}");
        assert_eq!(
            bench.flag(&forgotten, "CommandAborted"),
            expected == ErrorId::None
        );
    }
}

/// Covers: R38
#[test]
fn a_table_that_does_not_stand_where_the_pin_says_is_recorded() {
    for (name, table) in [
        ("MC_PositionProfile", "TimePosition"),
        ("MC_VelocityProfile", "TimeVelocity"),
        ("MC_AccelerationProfile", "TimeAcceleration"),
    ] {
        let mut bench = Bench::new();
        let mut profile = bench.block(name);
        let nowhere = TableRef {
            first: 1_000_000,
            records: 1,
        };
        bench.set(&mut profile, table, Value::Table(nowhere));
        bench.set(&mut profile, "Execute", Value::Bool(true));
        bench.scan(&mut [&mut profile]);
        let error = ErrorId::TableUnknown;
        assert_eq!(bench.error(&profile), error.number(), "{name}");
        let told = bench.log.since(0).any(|record| {
            matches!(record.event, Event::Refused { pin, error: told, .. } if pin == table && told == error)
        });
        assert!(told, "{name}");
        assert_eq!(bench.axes[0].state(), AxisState::Standstill);
    }
}

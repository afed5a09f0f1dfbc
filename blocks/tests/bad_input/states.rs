//! Every block in every state.

use super::{Cell, refers_to_axis, rows, same_motion, trigger};
use crate::bench::{AXIS, Bench};
use standstill_axis::{AxisState, BufferMode, ErrorId, Scope, StartState};
use standstill_blocks::{BlockInstance, REGISTRY};
use standstill_fb::Value;

/// The columns of the table; the last one is the ramp before Disabled.
const COLUMNS: [AxisState; 8] = [
    AxisState::Disabled,
    AxisState::Standstill,
    AxisState::Homing,
    AxisState::Stopping,
    AxisState::DiscreteMotion,
    AxisState::ContinuousMotion,
    AxisState::ErrorStop,
    AxisState::Stopping,
];

fn table() -> Vec<(&'static str, &'static str, Vec<Cell>)> {
    rows(include_str!("states.txt"))
}

#[test]
fn every_block_with_an_axis_has_its_rows() {
    let mut expected = Vec::new();
    for info in REGISTRY.iter().filter(|info| refers_to_axis(info)) {
        if info.pin("BufferMode").is_some() {
            expected.push((info.name, "aborting", COLUMNS.len()));
            expected.push((info.name, "buffered", COLUMNS.len()));
        } else {
            expected.push((info.name, "-", COLUMNS.len()));
        }
    }
    let mut found: Vec<_> = table()
        .iter()
        .map(|(block, mode, cells)| (*block, *mode, cells.len()))
        .collect();
    expected.sort_unstable();
    found.sort_unstable();
    assert_eq!(found, expected, "states.txt (left) and the registry (right)");
}

/// A running instance on the first axis.
fn executed(bench: &Bench, name: &str) -> BlockInstance {
    let mut block = bench.block(name);
    bench.set(&mut block, "Execute", Value::Bool(true));
    block
}

/// Both axes: the first in the state of `column` in the middle of a scan, after the latch; the second moving.
fn brought_to(column: usize) -> Bench {
    let mut bench = Bench::started(if column == 0 {
        StartState::Disabled
    } else {
        StartState::Standstill
    });
    let mut neighbour = executed(&bench, "MC_MoveVelocity");
    bench.wire(&mut neighbour, standstill_axis::AxisId::new(1));
    bench.scan(&mut [&mut neighbour]);
    let motion = match column {
        3 | 5 => Some("MC_MoveVelocity"),
        4 | 7 => Some("MC_MoveAbsolute"),
        _ => None,
    };
    if let Some(name) = motion {
        let mut owner = executed(&bench, name);
        for _ in 0..20 {
            bench.scan(&mut [&mut owner]);
        }
    }
    bench.latch();
    match column {
        2 => {
            let mut home = executed(&bench, "MC_Home");
            bench.call(&mut home);
        }
        3 => {
            let mut stop = executed(&bench, "MC_Stop");
            bench.call(&mut stop);
        }
        6 => {
            let axis = &mut bench.axes[AXIS.index()];
            axis.raise(ErrorId::AxisFault, 0, &mut Scope::new(bench.scan, &mut bench.log));
            axis.clear_cause();
        }
        7 => {
            let mut power = bench.block("MC_Power");
            bench.call(&mut power);
        }
        _ => {}
    }
    assert_eq!(bench.axes[0].state(), COLUMNS[column], "column {column}");
    bench
}

/// Covers: R34, R38, R78, S3, S10, V6, V6a, V7a, V10, V11, T5
#[test]
fn each_state_gives_what_its_cell_says() {
    for (name, mode, cells) in table() {
        for (column, cell) in cells.into_iter().enumerate() {
            let mut bench = brought_to(column);
            let mut without = bench.clone();
            let mut block = bench.block(name);
            if mode == "buffered" {
                bench.set(&mut block, "BufferMode", Value::Enum(BufferMode::Buffered as i32));
            }
            let trigger = trigger(&block).unwrap();
            bench.set(&mut block, trigger, Value::Bool(true));
            bench.call(&mut block);
            let what = format!("{name} {mode} in {:?}, column {column}", COLUMNS[column]);
            assert_eq!(bench.error(&block), cell.error(), "{what}");
            assert_eq!(bench.flag(&block, "Error"), cell.error() != 0, "{what}");
            bench.advance();
            without.advance();
            let refused = cell.error() != 0;
            for _ in 0..20 {
                assert!(same_motion(&bench, &without, 1), "{what}: the other axis");
                if refused {
                    assert!(!bench.flag(&block, "Busy"), "{what}");
                    assert!(same_motion(&bench, &without, 0), "{what}");
                }
                bench.scan(&mut [&mut block]);
                without.scan(&mut []);
            }
            if refused {
                assert_eq!(bench.error(&block), cell.error(), "{what}: until Execute falls");
                bench.set(&mut block, trigger, Value::Bool(false));
                bench.scan(&mut [&mut block]);
                assert!(!bench.flag(&block, "Error") && bench.error(&block) == 0, "{what}");
            }
        }
    }
}

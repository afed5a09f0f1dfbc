//! The reaction of blocks to bad input, compared with two tables.
//!
//! `pins.txt` has the result of each bad value at every numeric and enumeration pin of every registered
//! block, `states.txt` the result of each block in each state of the axis. A block or pin without a row
//! fails. Both tables are published as `docs/bad-input.md`.

mod no_axis;
mod pins;
mod states;

use crate::bench::Bench;
use standstill_axis::AxisState;
use standstill_blocks::BlockInstance;
use standstill_fb::{BlockInfo, PinType};

/// What a table expects of one call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cell {
    /// Accepted.
    Fine,
    /// Accepted with the axis limit in its place, and recorded.
    Clamped,
    /// Error with this ErrorID.
    Error(u16),
}

impl Cell {
    fn read(text: &str) -> Self {
        match text {
            "ok" => Self::Fine,
            "clamp" => Self::Clamped,
            number => Self::Error(number.parse().expect("ok, clamp or an ErrorID")),
        }
    }

    fn error(self) -> u16 {
        match self {
            Self::Fine | Self::Clamped => 0,
            Self::Error(number) => number,
        }
    }
}

/// Rows of a table: two words and the cells behind them.
fn rows(table: &'static str) -> Vec<(&'static str, &'static str, Vec<Cell>)> {
    table
        .lines()
        .filter(|line| !line.starts_with('#'))
        .map(|line| {
            let mut words = line.split_whitespace();
            let mut word = || words.next().expect("block and pin or mode");
            let (block, second) = (word(), word());
            (block, second, words.map(Cell::read).collect())
        })
        .collect()
}

/// The pin that makes a block act, if it has one.
fn trigger(block: &BlockInstance) -> Option<&'static str> {
    use standstill_fb::AnyInstance;
    ["Execute", "Enable", "JogForward"]
        .into_iter()
        .find(|name| block.info().pin(name).is_some())
}

/// Whether the block has an axis, or something of a drive.
fn refers_to_axis(info: &BlockInfo) -> bool {
    info.pins().any(|pin| matches!(pin.ty, PinType::Axis(_)))
}

/// Whether two benches show the same motion, to the bit.
fn same_motion(one: &Bench, other: &Bench, axis: usize) -> bool {
    let view = |bench: &Bench| -> (AxisState, [u64; 3], u16) {
        let axis = &bench.axes[axis];
        let setpoint = axis.setpoint();
        (
            axis.state(),
            [setpoint.position, setpoint.velocity, setpoint.acceleration].map(f64::to_bits),
            axis.error_id().number(),
        )
    };
    view(one) == view(other)
}

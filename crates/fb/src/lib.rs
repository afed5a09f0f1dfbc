//! The common part of all function blocks: pins as data, and the cores that own edges, results and
//! readings.
//!
//! This crate has no block and no motion. A block says only which command it gives. The cores own rising
//! edges, results that stay until Execute falls, and outputs that show for at least one call.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod block;
mod enable;
mod execute;
pub mod flat;
mod pin_groups;
mod pins;
pub mod ring;
mod table;
mod update;

pub use block::{AnyInstance, Block, BlockInfo, Context, Described, Group, Instance};
pub use enable::{EnableCore, Reading};
pub use execute::{ExecuteCore, Phase};
pub use pins::{
    Direction, EnumInfo, InputRef, Int, OutputRef, Pin, PinError, PinType, PinValue, Pins, Time, Value,
    axis_number, numbered_axis,
};
#[doc(hidden)]
pub use standstill_axis::{Dynamics, ErrorId, Fate};
pub use table::{Record, Table, TableInfo, TableOf, TableRef};
pub use update::{Move, UpdateCore, Values};

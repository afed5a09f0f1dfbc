//! Process data of a node: the values a bus carries in every scan.

use standstill_axis::{Equipment, PROBES};

/// Mode of operation 8: cyclic synchronous position.
pub const MODE_CSP: i8 = 8;

/// Mode of operation 6: homing.
pub const MODE_HM: i8 = 6;

/// Mode of operation 9: cyclic synchronous velocity.
pub const MODE_CSV: i8 = 9;

/// Mode of operation 10: cyclic synchronous torque.
pub const MODE_CST: i8 = 10;

/// The data that a node sends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    /// 6041h
    pub statusword: u16,
    /// 6061h, the mode in force.
    pub mode: i8,
    /// 6064h (increments), modulo 2^32.
    pub position: i32,
    /// 606Ch (increments/s)
    pub velocity: i32,
    /// 6077h (thousandths of the rated torque), positive in counting direction.
    pub torque: i16,
    /// 603Fh
    pub error_code: u16,
    /// 60FDh: bit 0 negative limit switch, 1 positive limit switch, 2 home switch.
    pub digital_inputs: u32,
    /// 60B9h
    pub probe_status: u16,
    /// 60BAh to 60BDh (increments), modulo 2^32: latched at the rising and the falling edge of each
    /// probe.
    pub probe_positions: [[i32; 2]; PROBES],
}

/// The data that a node receives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Outputs {
    /// 6040h
    pub controlword: u16,
    /// 6060h
    pub mode: i8,
    /// 607Ah (increments), modulo 2^32.
    pub target_position: i32,
    /// 60FFh (increments/s), of mode 9. The adapter never requests that mode.
    pub target_velocity: i32,
    /// 6071h (thousandths of the rated torque), of mode 10.
    pub target_torque: i16,
    /// 60B8h
    pub probe_function: u16,
}

/// A CiA 402 node on any bus. It exchanges process data once per scan.
pub trait Node {
    /// This scan's inputs; `None` if they did not arrive.
    fn inputs(&mut self, now_ns: i64) -> Option<Inputs>;

    /// This scan's outputs.
    fn outputs(&mut self, now_ns: i64, outputs: &Outputs);

    /// The equipment of the node. By default it has both kinds of switches, in 60FDh, and mode 6. A node with less
    /// overrides it.
    fn equipment(&self) -> Equipment {
        Equipment {
            home_switch: true,
            limit_switches: true,
            marker: false,
            homing: true,
        }
    }

    /// 6072h: the largest torque it holds in mode 10 (thousandths of the rated torque). 0, the default, if it does
    /// not have the mode.
    fn max_torque(&self) -> u16 {
        0
    }

    /// 607Ch: the position its own homing gives to the reference (increments).
    fn home_offset(&self) -> i32 {
        0
    }
}

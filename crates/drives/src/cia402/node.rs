//! Process data of a node: what a bus carries in every scan.

use standstill_axis::Equipment;

/// Mode of operation 8: cyclic synchronous position.
pub const MODE_CSP: i8 = 8;

/// Mode of operation 6: homing.
pub const MODE_HM: i8 = 6;

/// What a node sends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Inputs {
    /// 6041h
    pub statusword: u16,
    /// 6061h, the mode in force.
    pub mode: i8,
    /// 6064h (increments), modulo 2^32.
    pub position: i32,
    /// 603Fh
    pub error_code: u16,
    /// 60FDh: bit 0 negative limit switch, 1 positive limit switch, 2 home switch.
    pub digital_inputs: u32,
}

/// What a node receives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Outputs {
    /// 6040h
    pub controlword: u16,
    /// 6060h
    pub mode: i8,
    /// 607Ah (increments), modulo 2^32.
    pub target_position: i32,
}

/// A CiA 402 node on whatever bus, exchanging process data once a scan.
pub trait Node {
    /// This scan's inputs; `None` if they did not arrive.
    fn inputs(&mut self, now_ns: i64) -> Option<Inputs>;

    /// This scan's outputs.
    fn outputs(&mut self, now_ns: i64, outputs: &Outputs);

    /// What it has. By default both kinds of switches, in 60FDh, and mode 6; a node that has less says so.
    fn equipment(&self) -> Equipment {
        Equipment {
            home_switch: true,
            limit_switches: true,
            marker: false,
            homing: true,
        }
    }

    /// 607Ch: the position its own homing gives to the reference (increments).
    fn home_offset(&self) -> i32 {
        0
    }
}

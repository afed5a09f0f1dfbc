//! Process data of a node: what a bus carries in every scan.

/// Mode of operation 8: cyclic synchronous position.
pub const MODE_CSP: i8 = 8;

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
}

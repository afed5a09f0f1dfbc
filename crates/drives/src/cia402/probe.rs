//! Touch probes: the requests of a controller, and the latches of a simulated node.
//!
//! Source: CiA 402, objects 60B8h (function), 60B9h (status) and 60BAh to 60BDh (positions).

use super::adapter::extended;
use super::node::Inputs;
use crate::nearest;
use crate::wire::Wire;
use standstill_axis::{DrivePosition, DriveReport, Edge, PROBES, ProbeReport};

/// Bits of 60B8h for probe 1; those of probe 2 are eight higher.
pub struct ProbeFunction;

impl ProbeFunction {
    /// Enabled: armed while it is set.
    pub const ENABLE: u16 = 1 << 0;

    /// Every edge is latched, not only the first.
    pub const CONTINUOUS: u16 = 1 << 1;

    /// The source: 0 is the probe's input.
    pub const SOURCE: u16 = 0b11 << 2;

    /// Rising edges are latched.
    pub const RISING: u16 = 1 << 4;

    /// Falling edges are latched.
    pub const FALLING: u16 = 1 << 5;

    /// Waits for one edge.
    const fn once(edge: Edge) -> u16 {
        match edge {
            Edge::Rising => Self::ENABLE | Self::RISING,
            Edge::Falling => Self::ENABLE | Self::FALLING,
        }
    }
}

/// Bits of 60B9h for probe 1; those of probe 2 are eight higher.
pub struct ProbeStatus;

impl ProbeStatus {
    /// It is enabled.
    pub const ENABLED: u16 = 1 << 0;

    /// The position at a rising edge is stored.
    pub const RISING: u16 = 1 << 1;

    /// The position at a falling edge is stored.
    pub const FALLING: u16 = 1 << 2;

    const fn stored(edge: Edge) -> u16 {
        match edge {
            Edge::Rising => Self::RISING,
            Edge::Falling => Self::FALLING,
        }
    }
}

/// The bits of one probe.
const fn of(word: u16, probe: usize) -> u16 {
    word >> (8 * probe) & 0xff
}

/// The controller's side. To arm a probe anew it disables the probe, and enables it again once the status
/// shows that it was disabled.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Link {
    ordered: [Option<Edge>; PROBES],
    /// The requested edge of each probe.
    asked: [Option<Edge>; PROBES],
}

impl Link {
    pub fn order(&mut self, probes: [Option<Edge>; PROBES]) {
        self.ordered = probes;
    }

    /// 60B8h, from the last inputs.
    pub fn give(&mut self, inputs: &Inputs) -> u16 {
        let mut function = 0;
        for (probe, (ordered, asked)) in self.ordered.iter().zip(&mut self.asked).enumerate() {
            let is_enabled = of(inputs.probe_status, probe) & ProbeStatus::ENABLED != 0;
            let may_go_on = *asked == *ordered || !is_enabled;
            *asked = ordered.filter(|_| may_go_on);
            function |= asked.map_or(0, ProbeFunction::once) << (8 * probe);
        }
        function
    }

    /// The report for the axis. Latched positions are within 2^31 increments of `position`.
    pub fn report(&self, inputs: &Inputs, position: i64, report: &mut DriveReport) {
        let probes = self.asked.iter().zip(&inputs.probe_positions).enumerate();
        for ((probe, (asked, positions)), told) in probes.zip(&mut report.probes) {
            let status = of(inputs.probe_status, probe);
            let latched = asked.filter(|edge| status & ProbeStatus::stored(*edge) != 0);
            let [rising, falling] = *positions;
            *told = ProbeReport {
                armed: status & ProbeStatus::ENABLED != 0,
                latched: latched.map(|edge| {
                    let raw = match edge {
                        Edge::Rising => rising,
                        Edge::Falling => falling,
                    };
                    DrivePosition::Increments(extended(position, raw))
                }),
            };
        }
    }
}

/// The node's side. Between two feedbacks the position is taken as linear, and the increment nearest to
/// the edge is latched.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NodeProbes {
    wires: [Wire; PROBES],
    function: u16,
    status: u16,
    /// 60BAh to 60BDh: positions at the rising and the falling edge of each probe.
    positions: [[i32; 2]; PROBES],
    /// The position of the feedback before.
    before: Option<i64>,
}

impl NodeProbes {
    /// Sets the input of `probe`, counted from 0, to `level`. The change is at the part `at` of the
    /// interval that ends with the next feedback.
    pub fn set(&mut self, probe: usize, at: f64, level: bool) {
        if let Some(wire) = self.wires.get_mut(probe) {
            wire.set(at, level);
        }
    }

    /// Renames positions: each counts `by` increments more.
    pub fn count_from(&mut self, by: i64) {
        self.before = self.before.map(|before| before.saturating_add(by));
    }

    /// Takes 60B8h. A disabled probe clears its stored positions. A source other than the input does not
    /// exist.
    pub fn obey(&mut self, function: u16) {
        for probe in 0..PROBES {
            let (asked, before) = (of(function, probe), of(self.function, probe));
            let enabled = asked & ProbeFunction::ENABLE != 0 && asked & ProbeFunction::SOURCE == 0;
            if !enabled || asked != before {
                self.status &= !(0xff << (8 * probe));
            }
            if enabled {
                self.status |= ProbeStatus::ENABLED << (8 * probe);
            }
        }
        self.function = function;
    }

    /// Ends the interval at `position`.
    pub fn latch(&mut self, position: i64) {
        let before = self.before.replace(position).unwrap_or(position);
        let way = position.saturating_sub(before) as f64;
        let words = (self.function, &mut self.status);
        for (probe, (wire, stored)) in self.wires.iter_mut().zip(&mut self.positions).enumerate() {
            let (function, status) = (of(words.0, probe), &mut *words.1);
            wire.take(|at, edge| {
                let (slot, wanted) = match edge {
                    Edge::Rising => (0, ProbeFunction::RISING),
                    Edge::Falling => (1, ProbeFunction::FALLING),
                };
                let told = ProbeStatus::stored(edge) << (8 * probe);
                let is_enabled = *status & ProbeStatus::ENABLED << (8 * probe) != 0;
                let counts = *status & told == 0 || function & ProbeFunction::CONTINUOUS != 0;
                if let Some(slot) = stored.get_mut(slot)
                    && is_enabled
                    && function & wanted != 0
                    && counts
                {
                    // Modulo 2^32, as the position counts.
                    *slot = before.saturating_add(nearest(at * way)) as i32;
                    *status |= told;
                }
            });
        }
    }

    /// 60B9h, and 60BAh to 60BDh.
    pub fn told(&self) -> (u16, [[i32; 2]; PROBES]) {
        (self.status, self.positions)
    }
}

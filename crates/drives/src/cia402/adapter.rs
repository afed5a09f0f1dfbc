//! A drive made of any CiA 402 node.

use super::homing::Link;
use super::node::{Inputs, MODE_CSP, MODE_CST, Node, Outputs};
use super::probe;
use super::sequencer::{Memory, controlword};
use super::torque::{self, TorqueScale};
use super::words::{State, Statusword};
use standstill_axis::{
    Comms, Drive, DriveCommand, DriveFeedback, DriveOrder, DrivePosition, DriveReport, DriveRequest,
    DriveSignals, Fault,
};

/// Makes a [`Drive`] of a [`Node`] in cyclic synchronous position mode. It changes to homing mode or to
/// cyclic synchronous torque mode while the axis asks for it.
///
/// - The node's position is modulo 2^32. It is extended, so it may wrap any number of times, if it moves
///   less than 2^31 increments between two scans (DR-2).
/// - Operation counts as enabled when the state is Operation enabled and the mode is acknowledged (CI-7).
///   Until then the target is the actual position, so that enabling never makes a step (CI-3).
/// - Until the change to torque mode is acknowledged, the node keeps its velocity. On the way back its torque is 0
///   until position mode is acknowledged. Both changes take no time if the node answers in the same scan.
/// - The adapter keeps the velocity bounds of a torque command by reducing the torque near them. The profile has
///   only one bound (6080h) for both directions; it stays under the node's control.
/// - If inputs do not arrive, the communication is lost in the same scan (CI-8); outputs are still sent.
/// - A node that is not under remote control counts as a node without supply: not ready, no error (CI-6).
///
/// Positions at this drive are increments, so its axis needs a scaling.
#[derive(Clone, Copy, Debug)]
pub struct Adapter<N> {
    node: N,
    memory: Memory,
    homing: Link,
    torque: torque::Link,
    probes: probe::Link,
    last: Inputs,
    /// The node's position, extended.
    position: i64,
    /// The last target, and its distance from the one before.
    target: (i64, i64),
    /// Nothing has arrived yet.
    fresh: bool,
    simulated: bool,
}

impl<N: Node> Adapter<N> {
    /// The state before the first scan. Positions begin at the node's position, which is within 2^31 of
    /// 0.
    pub fn new(node: N) -> Self {
        Self {
            node,
            memory: Memory::default(),
            homing: Link::default(),
            torque: torque::Link::default(),
            probes: probe::Link::default(),
            last: Inputs::default(),
            position: 0,
            target: (0, 0),
            fresh: true,
            simulated: false,
        }
    }

    /// The same for a node that measures torque. The node holds a torque if its 6072h permits it.
    pub fn with_torque(mut self, scale: TorqueScale) -> Self {
        self.torque.set_scale(scale);
        self
    }

    /// The node.
    pub fn node(&self) -> &N {
        &self.node
    }

    /// The node.
    pub fn node_mut(&mut self) -> &mut N {
        &mut self.node
    }

    /// Marks the drive as simulated: nothing real moves.
    pub(super) fn simulated(mut self) -> Self {
        self.simulated = true;
        self
    }

    /// The last state that the node reported.
    pub fn state(&self) -> State {
        Statusword(self.last.statusword).state()
    }

    fn take(&mut self, inputs: Inputs) {
        if self.fresh {
            self.position = i64::from(inputs.position);
            self.target = (self.position, 0);
        } else {
            self.position = extended(self.position, inputs.position);
        }
        self.fresh = false;
        self.last = inputs;
        let reference = extended(self.position, self.node.home_offset());
        self.homing.take(&inputs, DrivePosition::Increments(reference));
        self.torque.take(&inputs);
    }

    fn is_enabled(&self) -> bool {
        let is_in_mode = self.last.mode == MODE_CSP || self.homing.leads() || self.torque.leads();
        self.state() == State::OperationEnabled && is_in_mode
    }

    /// 607Ah, extended.
    fn target(&self, command: &DriveCommand) -> i64 {
        let (before, step) = self.target;
        let is_in_mode = self.last.mode == MODE_CSP;
        match command.position {
            _ if !self.is_enabled() => self.position,
            DrivePosition::Increments(_) if is_in_mode && self.torque.is_wanted() => {
                before.saturating_add(step)
            }
            // On the way back from torque mode, the target must be right in the scan in which position
            // mode begins.
            DrivePosition::Increments(increments) if is_in_mode || self.torque.is_on_way_back() => increments,
            // Without a scaling the size of an increment is unknown to the axis: it does not move.
            DrivePosition::Increments(_) | DrivePosition::Units(_) => self.position,
        }
    }
}

/// The position nearest to `before` whose low 32 bits are those of `raw`.
pub(super) fn extended(before: i64, raw: i32) -> i64 {
    let low = before as i32;
    before.saturating_add(i64::from(raw.wrapping_sub(low)))
}

impl<N: Node> Drive for Adapter<N> {
    fn read(&mut self, now_ns: i64) -> DriveFeedback {
        let arrived = self.node.inputs(now_ns);
        if let Some(inputs) = arrived {
            self.take(inputs);
        }
        let status = Statusword(self.last.statusword);
        let is_faulty = matches!(status.state(), State::Fault | State::FaultReactionActive);
        let input = |bit: u32| self.last.digital_inputs & (1 << bit) != 0;
        DriveFeedback {
            enabled: self.is_enabled(),
            voltage: status.voltage() && status.remote(),
            fault: is_faulty.then_some(Fault {
                code: self.last.error_code,
                // The profile does not say whether a reset will work. Only an attempt shows it.
                cause_present: false,
            }),
            position: DrivePosition::Increments(self.position),
            comms: if arrived.is_some() { Comms::Ok } else { Comms::Lost },
            signals: DriveSignals {
                simulated: self.simulated,
                home_switch: input(2),
                limit_switch_positive: input(1),
                limit_switch_negative: input(0),
                warning: status.warning(),
            },
        }
    }

    fn write(&mut self, now_ns: i64, command: &DriveCommand) {
        let request = if self.fresh {
            DriveRequest::Off
        } else {
            command.request
        };
        let (word, memory) = controlword(request, Statusword(self.last.statusword), self.memory);
        self.memory = memory;
        let target = self.target(command);
        self.target = (target, target.saturating_sub(self.target.0));
        let enable = request == DriveRequest::Enable;
        let (mode, bits) = self.homing.give(&self.last, enable);
        let outputs = Outputs {
            controlword: word | bits,
            mode: if self.torque.is_wanted() && enable {
                MODE_CST
            } else {
                mode
            },
            // Modulo 2^32, as the node counts.
            target_position: target as i32,
            target_velocity: 0,
            target_torque: self.torque.give(&self.last, self.node.max_torque()),
            probe_function: self.probes.give(&self.last),
        };
        self.node.outputs(now_ns, &outputs);
    }

    fn report(&mut self, report: &mut DriveReport) {
        report.homing = self.homing.told();
        report.equipment = self.node.equipment();
        report.torque = self.torque.report(&self.last, self.node.max_torque());
        self.probes.report(&self.last, self.position, report);
    }

    fn order(&mut self, order: &DriveOrder) {
        self.homing.order(order.homing);
        self.torque.order(order.torque);
        self.probes.order(order.probes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Covers: DR-2
    #[test]
    fn a_wrapping_position_goes_on() {
        let mut position = i64::from(i32::MAX) - 3;
        let mut raw = position as i32;
        for step in [1, 2, 3, 1 << 30, -(1 << 30), -9, i32::MAX, i32::MIN + 1] {
            raw = raw.wrapping_add(step);
            let next = extended(position, raw);
            assert_eq!(next - position, i64::from(step));
            position = next;
        }
        assert_eq!(extended(0x7fff_ffff, i32::MIN), 0x8000_0000);
    }
}

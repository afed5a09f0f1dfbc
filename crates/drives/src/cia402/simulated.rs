//! A node in memory only, with every state and transition of the profile.

use super::adapter::Adapter;
use super::homing::{NodeHoming, Progress, REFERENCE_LIMIT};
use super::motor::{Motor, MotorLoad};
use super::node::{Inputs, MODE_CSP, MODE_CST, MODE_CSV, MODE_HM, Node, Outputs};
use super::probe::NodeProbes;
use super::state::{Transition, command_transition};
use super::words::{Command, State};
use crate::nearest;
use standstill_axis::{Equipment, Powered};

/// A simulated node behind the adapter: a drive for tests without hardware.
pub type Cia402Drive = Adapter<SimulatedNode>;

/// How a drive comes to rest when it may not follow its command (objects 605Ah to 605Eh).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Reaction {
    /// Torque off at once.
    Coast,
    /// Along a ramp; then as the transition requires.
    #[default]
    Ramp,
    /// Along a ramp. The quick stop then stays active until the controller sends another command (605Ah 5 to 8).
    RampAndStay,
}

/// Settings of a simulated node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings {
    /// Position before the first scan (increments).
    pub position: i64,
    /// Whether operation is enabled before the first scan.
    pub enabled: bool,
    /// Scans from a target to the actual position that meets it, in addition to the one of the bus; at
    /// most [`DELAY_MAX`](standstill_axis::DELAY_MAX).
    pub delay: usize,
    /// Scans of self-test.
    pub start_up: u32,
    /// Scans from Switched on to Operation enabled; `None` for never.
    pub power_on: Option<u32>,
    /// Ramp of reactions (increments/scan^2), above 0.
    pub deceleration: f64,
    /// 605Ah
    pub quick_stop: Reaction,
    /// 605Bh and 605Ch
    pub leaving: Reaction,
    /// 605Eh
    pub fault: Reaction,
    /// The end switches are active below and above these (increments).
    pub ends: Option<(i64, i64)>,
    /// The home switch is active between these two (increments).
    pub home: Option<(i64, i64)>,
    /// Homing mode; `None` if it does not have the mode.
    pub homing: Option<NodeHoming>,
    /// The load in torque mode. `None` if it does not have the mode and measures no torque.
    pub load: Option<MotorLoad>,
    /// Scans per second, above 0: the bus has velocities per second.
    pub rate: f64,
    /// Scans from the request of a mode until it is in force, in addition to the one of the bus.
    pub mode_change: u32,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            position: 0,
            enabled: false,
            delay: 0,
            start_up: 0,
            power_on: Some(0),
            deceleration: 1.0,
            quick_stop: Reaction::Ramp,
            leaving: Reaction::Coast,
            fault: Reaction::Ramp,
            ends: None,
            home: None,
            homing: None,
            load: None,
            rate: 1000.0,
            mode_change: 0,
        }
    }
}

/// A CiA 402 node in a cyclic synchronous mode (position, velocity, torque) or homing mode, with two touch probes.
#[derive(Clone, Copy, Debug)]
pub struct SimulatedNode {
    settings: Settings,
    state: State,
    /// Scans in this state.
    waited: u32,
    /// The state in which a ramp ends when the motor is at rest (transitions 5 and 8).
    leaving: Option<State>,
    controlword: u16,
    mode: i8,
    /// Scans since the request of another mode.
    changing: u32,
    motor: Motor,
    probes: NodeProbes,
    homing: Progress,
    /// Increments that its own homing has subtracted from its count.
    origin: i64,
    error_code: u16,
    fault_pending: bool,
    cause_present: bool,
    voltage: bool,
    remote: bool,
    warning: bool,
    connected: bool,
    /// The transitions taken so far, one bit for each number.
    taken: u32,
}

impl SimulatedNode {
    /// Before the first scan.
    pub fn new(settings: Settings) -> Self {
        Self {
            state: if settings.enabled {
                State::OperationEnabled
            } else {
                State::NotReadyToSwitchOn
            },
            waited: 0,
            leaving: None,
            controlword: 0,
            mode: MODE_CSP,
            changing: 0,
            motor: Motor::new(settings.position, settings.delay, settings.load),
            probes: NodeProbes::default(),
            homing: Progress::Idle,
            origin: 0,
            error_code: 0,
            fault_pending: false,
            cause_present: false,
            voltage: true,
            remote: true,
            warning: false,
            connected: true,
            taken: 0,
            settings,
        }
    }

    /// Its state.
    pub fn state(&self) -> State {
        self.state
    }

    /// Actual position (increments).
    pub fn position(&self) -> i64 {
        self.motor.actual()
    }

    /// Increments that its own homing has subtracted from its count since the start.
    pub fn origin(&self) -> i64 {
        self.origin
    }

    /// The transitions taken so far: bit n for number n.
    pub fn taken(&self) -> u32 {
        self.taken
    }

    /// Raises a fault with the drive's own `code`. Its cause stays until [`SimulatedNode::clear_cause`].
    pub fn fail(&mut self, code: u16) {
        self.error_code = code;
        self.fault_pending = true;
        self.cause_present = true;
    }

    /// The power stage loses its supply, or safe torque off is requested: the torque is 0 at once.
    pub fn cut_power(&mut self) {
        self.voltage = false;
        if matches!(
            self.state,
            State::ReadyToSwitchOn | State::SwitchedOn | State::OperationEnabled | State::QuickStopActive
        ) {
            let number = match self.state {
                State::ReadyToSwitchOn => 7,
                State::SwitchedOn => 10,
                State::OperationEnabled => 9,
                _ => 12,
            };
            self.enter(number, State::SwitchOnDisabled);
        }
        self.motor.let_go();
    }

    /// Inputs no longer arrive; outputs still do.
    pub fn cut_communication(&mut self) {
        self.connected = false;
    }

    /// Removes the causes of all faults. A fault of the drive stays until it is reset.
    pub fn clear_cause(&mut self) {
        self.cause_present = false;
        self.voltage = true;
        self.connected = true;
    }

    /// Sets the input of touch probe `number`, 0 or 1, to `level`. The change is at the part `at` (0 to
    /// 1) of the interval that ends with the next inputs. Up to four changes in one interval are kept.
    pub fn set_probe(&mut self, number: usize, at: f64, level: bool) {
        self.probes.set(number, at, level);
    }

    /// Sets whether it obeys the control word.
    pub fn set_remote(&mut self, remote: bool) {
        self.remote = remote;
    }

    /// Sets whether it shows a warning.
    pub fn set_warning(&mut self, warning: bool) {
        self.warning = warning;
    }

    /// Someone pushes the motor by `distance` increments.
    ///
    /// # Errors
    /// [`Powered`] while it has torque.
    pub fn displace(&mut self, distance: i64) -> Result<(), Powered> {
        if self.state.has_torque() {
            return Err(Powered);
        }
        self.motor.stand_at(self.motor.actual().saturating_add(distance));
        Ok(())
    }

    fn enter(&mut self, number: u8, state: State) {
        self.taken |= 1 << number;
        self.state = state;
        self.waited = 0;
        self.leaving = None;
        if !state.has_torque() {
            self.motor.let_go();
        }
        if state != State::OperationEnabled {
            self.homing = Progress::Idle;
        }
    }

    /// Reactions of the drive itself, before it reads the control word.
    fn by_itself(&mut self) {
        let Settings {
            start_up,
            quick_stop,
            fault,
            ..
        } = self.settings;
        let at_rest = self.motor.is_at_rest();
        let is_faulty = matches!(self.state, State::Fault | State::FaultReactionActive);
        if self.fault_pending && !is_faulty {
            let had_torque = self.state.has_torque();
            self.enter(13, State::FaultReactionActive);
            if !had_torque || fault == Reaction::Coast {
                self.motor.let_go();
            }
            return;
        }
        match self.state {
            State::NotReadyToSwitchOn if self.waited >= start_up => self.enter(1, State::SwitchOnDisabled),
            State::FaultReactionActive if at_rest => self.enter(14, State::Fault),
            State::QuickStopActive if quick_stop == Reaction::Coast => {
                self.enter(12, State::SwitchOnDisabled);
            }
            State::QuickStopActive if quick_stop == Reaction::Ramp && at_rest => {
                self.enter(12, State::SwitchOnDisabled);
            }
            State::OperationEnabled if at_rest => {
                if let Some(to) = self.leaving {
                    let number = if to == State::SwitchedOn { 5 } else { 8 };
                    self.enter(number, to);
                }
            }
            _ => {}
        }
    }

    fn obey(&mut self, controlword: u16) {
        let rises = controlword & !self.controlword & Command::FAULT_RESET != 0;
        self.controlword = controlword;
        if !self.remote {
            return;
        }
        if self.state == State::Fault && rises && !self.cause_present {
            self.fault_pending = false;
            self.error_code = 0;
            self.enter(15, State::SwitchOnDisabled);
            return;
        }
        let Some(arrow) = command_transition(self.state, Command::of(controlword)) else {
            return;
        };
        if self.permits(&arrow) {
            self.take(&arrow);
        }
    }

    fn permits(&self, arrow: &Transition) -> bool {
        match arrow.number {
            // Without voltage the motor stays where it is.
            2 | 3 => self.voltage,
            4 => self.settings.power_on.is_some_and(|scans| self.waited >= scans),
            16 => self.settings.quick_stop == Reaction::RampAndStay,
            _ => true,
        }
    }

    fn take(&mut self, arrow: &Transition) {
        let ramps = matches!(arrow.number, 5 | 8) && self.settings.leaving != Reaction::Coast;
        if ramps && !self.motor.is_at_rest() {
            self.leaving = Some(arrow.to);
        } else {
            self.enter(arrow.number, arrow.to);
            if arrow.number == 11 && self.settings.quick_stop == Reaction::Coast {
                self.motor.let_go();
            }
        }
    }

    fn turn(&mut self, outputs: &Outputs) {
        let brakes = matches!(self.state, State::QuickStopActive | State::FaultReactionActive)
            || self.leaving.is_some();
        if brakes {
            self.motor.brake(self.settings.deceleration);
        } else if self.state == State::OperationEnabled {
            match self.mode {
                MODE_HM => self.home(),
                MODE_CSV => self
                    .motor
                    .run(f64::from(outputs.target_velocity) / self.settings.rate),
                MODE_CST => self.motor.turn(f64::from(outputs.target_torque)),
                _ => {
                    // The target is modulo 2^32: it is taken as the position nearest to the last target.
                    let newest = self.motor.newest();
                    let step = i64::from(outputs.target_position.wrapping_sub(newest as i32));
                    self.motor.follow(newest.saturating_add(step));
                }
            }
        }
    }

    /// A request for an unknown mode gets no answer.
    fn take_mode(&mut self, mode: i8) {
        let is_known = match mode {
            MODE_CSP | MODE_CSV => true,
            MODE_CST => self.settings.load.is_some(),
            MODE_HM => self.settings.homing.is_some(),
            _ => false,
        };
        if !is_known || mode == self.mode {
            self.changing = 0;
        } else if self.changing < self.settings.mode_change {
            self.changing += 1;
        } else {
            self.changing = 0;
            self.homing = Progress::Idle;
            self.mode = mode;
        }
    }

    /// One scan of homing mode.
    fn home(&mut self) {
        let asked = self.controlword & (Command::HOMING | Command::HALT) == Command::HOMING;
        let at_rest = self.motor.is_at_rest();
        self.homing = match (self.homing, asked) {
            (Progress::Idle, true) if at_rest => {
                self.error_code = 0;
                Progress::Searching
            }
            (Progress::Idle | Progress::Searching, false) => Progress::Idle,
            (progress, _) => progress,
        };
        let rate = self.settings.deceleration;
        let Some(NodeHoming { up, velocity }) = self.settings.homing else {
            return self.motor.brake(rate);
        };
        if self.homing != Progress::Searching {
            return self.motor.brake(rate);
        }
        let (end, home) = (if up { 0b10 } else { 0b01 }, 0b100);
        if self.switches() & home != 0 {
            let reference = self.position();
            self.origin = self.origin.saturating_add(reference);
            self.motor.count_from(reference.saturating_neg());
            self.probes.count_from(reference.saturating_neg());
            self.homing = Progress::Attained;
            self.motor.brake(rate);
        } else if self.switches() & end != 0 {
            self.homing = Progress::Failed;
            self.error_code = REFERENCE_LIMIT;
            self.motor.brake(rate);
        } else {
            self.motor.ramp(if up { velocity } else { -velocity }, rate);
        }
    }

    fn statusword(&self) -> u16 {
        let bit = |is_set: bool, number: u32| u16::from(is_set) << number;
        let is_limited = self.switches() & 0b11 != 0;
        let follows = self.state == State::OperationEnabled && self.leaving.is_none();
        self.state.bits()
            | bit(self.voltage, 4)
            | bit(self.warning, 7)
            | bit(self.remote, 9)
            | bit(is_limited, 11)
            | if self.mode == MODE_HM {
                self.homing.status(self.motor.is_at_rest()).bits()
            } else {
                bit(follows, 12)
            }
    }

    /// 60FDh
    fn switches(&self) -> u32 {
        let Settings { ends, home, .. } = self.settings;
        let position = self.position().saturating_add(self.origin);
        let bit = |is_set: bool, number: u32| u32::from(is_set) << number;
        bit(ends.is_some_and(|(low, _)| position <= low), 0)
            | bit(ends.is_some_and(|(_, high)| position >= high), 1)
            | bit(home.is_some_and(|(from, to)| (from..=to).contains(&position)), 2)
    }
}

impl Node for SimulatedNode {
    fn inputs(&mut self, _now_ns: i64) -> Option<Inputs> {
        // Edges are latched even if the bus does not carry them.
        self.probes.latch(self.position());
        let (probe_status, probe_positions) = self.probes.told();
        let bounded = |value: f64, most: i32| nearest(value).clamp(-i64::from(most), i64::from(most));
        let velocity = bounded(self.motor.velocity() * self.settings.rate, i32::MAX);
        self.connected.then(|| Inputs {
            statusword: self.statusword(),
            mode: self.mode,
            // Modulo 2^32, as real counters are.
            position: self.position() as i32,
            velocity: velocity as i32,
            torque: bounded(self.motor.torque(), i32::from(i16::MAX)) as i16,
            error_code: self.error_code,
            digital_inputs: self.switches(),
            probe_status,
            probe_positions,
        })
    }

    fn outputs(&mut self, _now_ns: i64, outputs: &Outputs) {
        self.waited = self.waited.saturating_add(1);
        self.by_itself();
        self.obey(outputs.controlword);
        self.take_mode(outputs.mode);
        self.probes.obey(outputs.probe_function);
        self.turn(outputs);
    }

    fn equipment(&self) -> Equipment {
        Equipment {
            home_switch: self.settings.home.is_some(),
            limit_switches: self.settings.ends.is_some(),
            marker: false,
            homing: self.settings.homing.is_some(),
        }
    }

    fn max_torque(&self) -> u16 {
        self.settings.load.map_or(0, |load| load.most)
    }
}

impl Cia402Drive {
    /// A simulated node behind an adapter.
    pub fn simulated_node(settings: Settings) -> Self {
        Self::new(SimulatedNode::new(settings)).simulated()
    }
}

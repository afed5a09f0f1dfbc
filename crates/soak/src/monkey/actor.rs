//! The actor of a random program: a monkey that presses everything.

use super::draw::one_of;
use super::program::Role;
use crate::random::Random;
use crate::rules::Kind;
use serde_json::{Value as Json, json};
use standstill_axis::{Axis, AxisState};
use standstill_fb::{Direction, Pin, PinType, Value};
use standstill_script::model::{FaultKind, Point, Script};
use standstill_script::{Session, write};

/// Longest pause between two bursts of actions (scans).
const PAUSE: f64 = 150.0;

/// One in this many numbers is one that no pin should get.
const BAD: u64 = 60;

/// Numbers that no pin should get.
const BAD_NUMBERS: [f64; 9] = [
    f64::NAN,
    1e-300,
    f64::INFINITY,
    f64::NEG_INFINITY,
    -1.0,
    0.0,
    1e300,
    -1e300,
    1e9,
];

/// The kinds of faults, with their names in scripts.
const FAULTS: [(FaultKind, &str); 4] = [
    (FaultKind::Axis, "axis"),
    (FaultKind::Drive, "drive"),
    (FaultKind::Power, "power"),
    (FaultKind::Communication, "communication"),
];

/// The code of injected faults.
const FAULT_CODE: u16 = 7;

/// Presses at random, and keeps a record.
#[derive(Debug)]
pub struct Monkey<'a> {
    random: &'a mut Random,
    /// Length of a scan (s).
    cycle: f64,
    roles: Vec<Role>,
    next: u64,
    /// Axes with a cause that persists.
    broken: Vec<bool>,
    /// Everything done, as steps.
    pub minutes: Vec<Json>,
}

impl<'a> Monkey<'a> {
    /// Takes its numbers from `random`.
    pub fn new(random: &'a mut Random, script: &Script) -> Self {
        Self {
            random,
            cycle: script.cycle_ns as f64 / 1e9,
            roles: script.blocks.iter().map(Role::of).collect(),
            next: 0,
            broken: vec![false; script.axes.len()],
            minutes: Vec::new(),
        }
    }

    /// Acts before a scan, or waits.
    pub fn act(&mut self, session: &mut Session<'_>) {
        if session.scans() < self.next {
            return;
        }
        let axis = self.random.below(session.axes().len() as u64) as usize;
        for _ in 0..1 + self.random.below(3) {
            self.press(axis, session);
        }
        self.next = session.scans() + 1 + self.random.log_between(1.0, PAUSE) as u64;
    }

    /// Makes an axis or its drive fail; without a fault its cause is removed.
    fn fail(&mut self, session: &mut Session<'_>, axis: usize, fault: Option<(FaultKind, &str)>) {
        self.broken[axis] = fault.is_some();
        session.fail(axis, fault.map(|(kind, _)| (kind, FAULT_CODE)));
        let (scan, name) = (session.scans(), &session.script().axes[axis].name);
        self.minutes.push(match fault {
            Some((_, kind)) => {
                json!({"at": scan, "fault": {"axis": name, "kind": kind, "code": FAULT_CODE}})
            }
            None => json!({"at": scan, "clear": {"axis": name}}),
        });
    }

    /// Writes an input.
    fn set(&mut self, session: &mut Session<'_>, pin: Point, value: Value) {
        let Some(value) = write::value(value) else { return };
        let text = value.as_str().map_or_else(|| value.to_string(), str::to_owned);
        // Drawn for the pin's type.
        if session.change(pin, &text).is_ok()
            && let Some(change) = session.changes().last()
        {
            let set = json!({ (change.name.as_str()): value });
            self.minutes.push(json!({"at": change.scan, "set": set}));
        }
    }

    fn press(&mut self, axis: usize, session: &mut Session<'_>) {
        if self.broken[axis] && self.random.one_in(3) {
            self.fail(session, axis, None);
            return;
        }
        if self.random.one_in(100) {
            let fault = one_of(self.random, &FAULTS);
            self.fail(session, axis, Some(fault));
            return;
        }
        // In an axis out of operation, the inputs that bring it back are pressed more often.
        let wanted = match session.axes()[axis].state() {
            AxisState::ErrorStop if self.random.one_in(2) => Some("MC_Reset"),
            AxisState::Disabled if self.random.one_in(2) => Some("MC_Power"),
            _ => None,
        };
        let of_axis: Vec<_> = (0..self.roles.len())
            .filter(|index| {
                let role = &self.roles[*index];
                role.axis == Some(axis) && wanted.is_none_or(|name| role.info.name == name)
            })
            .collect();
        if of_axis.is_empty() {
            return;
        }
        let block = one_of(self.random, &of_axis);
        let role = self.roles[block];
        let Some(trigger) = role.trigger else { return };
        let trigger = Point::Pin(block, trigger);
        let on = session.value(trigger) == Some(Value::Bool(true));
        // Power is left on most of the time.
        if role.kind == Kind::Power && on && !self.random.one_in(15) {
            return;
        }
        if !on || self.random.one_in(10) {
            self.fill_in(block, &role, axis, session);
        }
        self.set(session, trigger, Value::Bool(!on));
    }

    /// Changes some inputs of an instance of an axis.
    fn fill_in(&mut self, block: usize, role: &Role, axis: usize, session: &mut Session<'_>) {
        for (pin, entry) in role.info.pins().enumerate() {
            if entry.direction != Direction::Input || Some(pin) == role.trigger {
                continue;
            }
            let pin = Point::Pin(block, pin);
            if let Some(value) = self.value(role, entry, &session.axes()[axis])
                && session.value(pin) != Some(value)
            {
                self.set(session, pin, value);
            }
        }
    }

    /// A value for a pin; none leaves it unchanged.
    fn value(&mut self, role: &Role, pin: &Pin, axis: &Axis) -> Option<Value> {
        let (kind, block) = (role.kind, role.info.name);
        match pin.ty {
            PinType::Bool => {
                let odds = match (kind, pin.name) {
                    // Both are needed to switch on.
                    (Kind::Power, _) => return Some(Value::Bool(!self.random.one_in(20))),
                    (_, "Relative" | "Value") => 2,
                    _ => 12,
                };
                Some(Value::Bool(self.random.one_in(odds)))
            }
            PinType::Enum(info) => Some(Value::Enum(if self.random.one_in(30) {
                99
            } else {
                one_of(self.random, info.elements).1
            })),
            PinType::Lreal if self.random.one_in(BAD) => {
                Some(Value::Lreal(one_of(self.random, &BAD_NUMBERS)))
            }
            PinType::Lreal => self.number(block, pin.name, axis).map(Value::Lreal),
            // The mask of tracks, or a cam's number: a slot, and the number of times it was used.
            PinType::Dword if pin.name == "CamTableID" => {
                let (slot, generation) = (self.random.below(3) as u32, 1 + self.random.below(4) as u32);
                Some(Value::Dword((generation << 16) | (slot + 1)))
            }
            PinType::Dword => Some(Value::Dword(self.random.below(16) as u32)),
            // The software limits more often than others.
            PinType::Int if pin.name == "ParameterNumber" => Some(Value::Int(if self.random.one_in(3) {
                self.random.below(19) as i16
            } else {
                2 + self.random.below(4) as i16
            })),
            // Ratios, small ones more often, sometimes 0.
            PinType::Int => Some(Value::Int(self.random.below(9) as i16 - 4)),
            PinType::Uint => Some(Value::Word(self.random.below(5) as u16)),
            PinType::Word | PinType::Time | PinType::Axis(_) | PinType::Table(_) => None,
        }
    }

    /// A number that makes sense at a pin.
    fn number(&mut self, block: &str, pin: &str, axis: &Axis) -> Option<f64> {
        let config = axis.config();
        let limits = &config.limits;
        let way = limits.velocity * self.cycle;
        match pin {
            "Position" => {
                let near = axis.setpoint().position + self.length(way);
                Some(match config.modulo {
                    Some(turn) if !self.random.one_in(20) => near.rem_euclid(turn).min(turn.next_down()),
                    _ => near,
                })
            }
            // For a profile: the position of the axis, or 0, or any.
            "Offset" if block == "MC_PositionProfile" => match self.random.below(8) {
                0 => Some(0.0),
                1 => Some(self.length(way)),
                _ => Some(axis.setpoint().position),
            },
            "Offset" => Some(if self.random.one_in(4) {
                0.2 * limits.velocity * self.random.between(-1.0, 1.0)
            } else {
                0.0
            }),
            // Sometimes a value that makes the times 0.
            "TimeScale" if self.random.one_in(8) => Some(self.random.log_between(1e-300, 1e300)),
            "TimeScale" => Some(self.random.between(0.8, 2.0)),
            // For a parameter: a software limit nearby, or a limit of motions.
            "Value" if self.random.one_in(4) => self.part(limits.velocity),
            "Value" => Some(axis.setpoint().position + self.length(way)),
            "PositionScale" | "VelocityScale" | "AccelerationScale" => Some(self.random.between(-1.0, 1.0)),
            // For the window of a probe.
            "FirstPosition" | "LastPosition" => Some(axis.setpoint().position + self.length(way)),
            // It is not supported, so it need not be tried often.
            "MasterStartDistance" => Some(if self.random.one_in(10) { way } else { 0.0 }),
            "MasterSyncPosition" => Some(if self.random.one_in(2) {
                0.0
            } else {
                self.length(way).abs()
            }),
            "MasterOffset" | "SlaveOffset" => Some(self.length(way)),
            "MasterScaling" | "SlaveScaling" => Some(match self.random.below(6) {
                0 => -1.0,
                1 => 0.5,
                2 => 2.0,
                3 if self.random.one_in(4) => 0.0,
                _ => 1.0,
            }),
            "Distance" => Some(self.length(way)),
            "Velocity" | "VelocityDiff" | "EndVelocity" => {
                let part = self.part(limits.velocity)?;
                let part = if pin == "EndVelocity" { 0.5 * part } else { part };
                Some(if self.random.one_in(8) { -part } else { part })
            }
            "Acceleration" => self.magnitude(limits.acceleration),
            "Deceleration" => self.magnitude(limits.deceleration),
            // If there is no limit, every power of ten is equally likely.
            "Jerk" if limits.jerk.is_infinite() => {
                Some(limits.acceleration / self.cycle * self.random.log_between(1e-3, 1e18))
            }
            "Snap" if limits.snap.is_infinite() => {
                let jerk = limits.jerk.min(limits.acceleration / self.cycle);
                Some(jerk / self.cycle * self.random.log_between(1e-3, 1e18))
            }
            "Jerk" => self.magnitude(limits.jerk),
            "Snap" => self.magnitude(limits.snap),
            // Factors and all others: around 1.
            _ => Some(self.random.between(0.0, 1.25)),
        }
    }

    /// The distance of some scans, in either direction, sometimes 0.
    fn length(&mut self, way: f64) -> f64 {
        if self.random.one_in(12) {
            return 0.0;
        }
        let length = way * self.random.log_between(0.1, 300.0);
        self.random.signed(length)
    }

    /// The default of the axis in half of the cases.
    fn magnitude(&mut self, limit: f64) -> Option<f64> {
        if self.random.one_in(2) {
            Some(0.0)
        } else {
            self.part(limit)
        }
    }

    /// A part of a limit, sometimes more than it.
    fn part(&mut self, limit: f64) -> Option<f64> {
        limit.is_finite().then(|| {
            let part = if self.random.one_in(20) { 1.5 } else { 1.0 };
            limit * part * self.random.between(0.05, 1.0)
        })
    }
}

//! The actors of a run: a monkey that presses everything, and a replay of its record.

use super::draw::one_of;
use super::run::{Hands, Instance};
use super::scenario::{Action, Bench, FaultKind, Scenario, Step};
use crate::random::Random;
use crate::rules::Kind;
use standstill_axis::{Axis, AxisState};
use standstill_fb::{AnyInstance, Direction, Pin, PinType, Value};

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

/// Presses at random, and keeps a record.
#[derive(Debug)]
pub struct Monkey<'a> {
    random: &'a mut Random,
    /// Length of a scan (s).
    cycle: f64,
    next: u64,
    /// The remaining actions of this scan, last first.
    todo: Vec<Action>,
    /// Axes with a cause that persists.
    broken: Vec<bool>,
    /// Everything done.
    pub minutes: Vec<Step>,
}

impl<'a> Monkey<'a> {
    /// Takes its numbers from `random`.
    pub fn new(random: &'a mut Random, cycle: f64) -> Self {
        Self {
            random,
            cycle,
            next: 0,
            todo: Vec::new(),
            broken: Vec::new(),
            minutes: Vec::new(),
        }
    }

    /// The actions in this scan.
    fn draw(&mut self, machine: &Bench, instances: &[Instance]) {
        self.broken.resize(machine.axes().len(), false);
        let axis = self.random.below(machine.axes().len() as u64) as usize;
        let mut actions = Vec::new();
        for _ in 0..1 + self.random.below(3) {
            self.press(axis, machine, instances, &mut actions);
        }
        actions.reverse();
        self.todo = actions;
    }

    fn press(&mut self, axis: usize, machine: &Bench, instances: &[Instance], actions: &mut Vec<Action>) {
        let state = machine.axes()[axis].state();
        if self.broken[axis] && self.random.one_in(3) {
            self.broken[axis] = false;
            actions.push(Action::Clear { axis });
            return;
        }
        if self.random.one_in(100) {
            let kinds = [
                FaultKind::Axis,
                FaultKind::Drive,
                FaultKind::Power,
                FaultKind::Communication,
            ];
            self.broken[axis] = true;
            actions.push(Action::Fault {
                axis,
                kind: one_of(self.random, &kinds),
            });
            return;
        }
        // In an axis out of operation, the inputs that bring it back are pressed more often.
        let wanted = match state {
            AxisState::ErrorStop if self.random.one_in(2) => Some("MC_Reset"),
            AxisState::Disabled if self.random.one_in(2) => Some("MC_Power"),
            _ => None,
        };
        let of_axis: Vec<_> = (0..instances.len())
            .filter(|index| {
                let instance = &instances[*index];
                instance.axis == axis && wanted.is_none_or(|name| instance.block.info().name == name)
            })
            .collect();
        if of_axis.is_empty() {
            return;
        }
        let block = one_of(self.random, &of_axis);
        let instance = &instances[block];
        let Some(trigger) = instance.trigger else { return };
        // Power is left on most of the time.
        if instance.kind == Kind::Power && instance.on && !self.random.one_in(15) {
            return;
        }
        if !instance.on || self.random.one_in(10) {
            self.fill_in(block, instance, &machine.axes()[axis], actions);
        }
        actions.push(Action::Set {
            block,
            pin: trigger,
            value: Value::Bool(!instance.on),
        });
    }

    /// Changes some inputs of an instance.
    fn fill_in(&mut self, block: usize, instance: &Instance, axis: &Axis, actions: &mut Vec<Action>) {
        for (pin, entry) in instance.block.info().pins().enumerate() {
            if entry.direction != Direction::Input || Some(pin) == instance.trigger {
                continue;
            }
            if let Some(value) = self.value(instance, entry, axis)
                && instance.block.get(pin) != Some(value)
            {
                actions.push(Action::Set { block, pin, value });
            }
        }
    }

    /// A value for a pin; none leaves it unchanged.
    fn value(&mut self, instance: &Instance, pin: &Pin, axis: &Axis) -> Option<Value> {
        let (kind, block) = (instance.kind, instance.block.info().name);
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

impl Hands for Monkey<'_> {
    fn next(&mut self, scan: u64, machine: &Bench, instances: &[Instance]) -> Option<Action> {
        if self.todo.is_empty() {
            if scan < self.next {
                return None;
            }
            self.draw(machine, instances);
            self.next = scan + 1 + self.random.log_between(1.0, PAUSE) as u64;
        }
        let action = self.todo.pop()?;
        self.minutes.push(Step { scan, action });
        Some(action)
    }
}

/// Performs the steps of a scenario.
#[derive(Debug)]
pub struct Replay<'a> {
    steps: core::slice::Iter<'a, Step>,
}

impl<'a> Replay<'a> {
    /// Of `scenario`.
    pub fn new(scenario: &'a Scenario) -> Self {
        Self {
            steps: scenario.steps.iter(),
        }
    }
}

impl Hands for Replay<'_> {
    fn next(&mut self, scan: u64, _: &Bench, _: &[Instance]) -> Option<Action> {
        let step = self.steps.as_slice().first()?;
        if step.scan > scan {
            return None;
        }
        self.steps.next();
        Some(step.action)
    }
}

//! One axis, a drive of a few bits, and four block instances, called in a fixed order.

use crate::countdown::Countdown;
use crate::rules;
use standstill_axis::{
    Axis, AxisConfig, AxisId, AxisState, Comms, DriveFeedback, DrivePosition, DriveRequest, DriveSignals,
    ErrorId, Fault, InstanceId, Limits, Log, Outlook, Plan, Scope, StartState, steps,
};
use standstill_blocks::BlockInstance;
use standstill_fb::{AnyInstance, Context, Value};
use standstill_soak::rules::{Kind, Outputs, Shown};
use std::slice;

/// What happens to the axis in a scan besides block inputs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum AxisEvent {
    #[default]
    Nothing,
    AxisFault,
    DriveFault,
    PowerLoss,
    CausesGone,
    Reset,
}

impl AxisEvent {
    const ALL: [Self; 6] = [
        Self::Reset,
        Self::Nothing,
        Self::AxisFault,
        Self::DriveFault,
        Self::PowerLoss,
        Self::CausesGone,
    ];
}

/// One scan's inputs. The two motion blocks: Execute and the number of their buffer mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Inputs {
    pub execute: [bool; 2],
    pub mode: [u8; 2],
    pub stop: bool,
    pub enable: bool,
    pub event: AxisEvent,
}

impl Inputs {
    fn changes_to(&self, next: &Self) -> usize {
        let changes = [
            self.execute[0] != next.execute[0],
            self.execute[1] != next.execute[1],
            self.stop != next.stop,
            self.enable != next.enable,
            next.event != AxisEvent::Nothing,
        ];
        changes.iter().filter(|changed| **changed).count()
    }
}

/// A drive of three bits and a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
struct Drive {
    enabled: bool,
    voltage: bool,
    fault: Option<bool>,
    position: u64,
}

#[derive(Clone)]
pub struct System {
    axis: [Axis<Countdown>; 1],
    drive: Drive,
    blocks: [BlockInstance; 4],
    kinds: [Kind; 4],
    outputs: [Outputs; 4],
    /// The outputs that the blocks would show if they were called now with unchanged inputs.
    polled: [Shown; 4],
    inputs: Inputs,
    /// Buffer modes to try besides mcAborting.
    modes: &'static [u8],
    scans: u64,
}

/// Positions of the instances in call order. MC_Stop is between the two motion blocks: one is called before it and
/// one after it.
pub const NAMES: [&str; 4] = ["power", "first", "stop", "second"];
const POWER: usize = 0;
const FIRST: usize = 1;
const STOP: usize = 2;
const SECOND: usize = 3;

/// Names a state: systems of equal keys behave alike from now on.
///
/// Command numbers only grow, so they must not be part of it. They need not be: an instance follows at most
/// one command, which owns the axis or is superimposed (it polls as Active, and the two are different kinds of
/// block), waits in the only place of the queue or for room (Busy but not Active), or has ended as polling shows.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Key {
    axis: Outlook,
    setpoint: (u64, u64),
    /// Position and velocity at the end of the plan.
    goal: Option<(u64, u64)>,
    drive: Drive,
    inputs: Inputs,
    shown: [Shown; 4],
    polled: [Shown; 4],
}

impl System {
    pub fn new(first: &'static str, second: &'static str, modes: &'static [u8]) -> Self {
        let limits = Limits {
            velocity: 10.0,
            acceleration: 10.0,
            deceleration: 10.0,
            ..Limits::NONE
        };
        // One place in the queue suffices to fill it.
        let config = AxisConfig {
            start: StartState::Standstill,
            queue: 1,
            ..AxisConfig::new(limits)
        };
        let names = ["MC_Power", first, "MC_Stop", second];
        let mut blocks = names.map(|name| BlockInstance::new(name).expect("a registered block"));
        for block in &mut blocks {
            set(block, "Axis", Value::Axis(AxisId::new(0)));
        }
        for (place, position) in [(FIRST, 1.0), (SECOND, 0.0)] {
            let has = |block: &BlockInstance, pin: &str| block.info().pin(pin).is_some();
            let block = &mut blocks[place];
            // No distance, in two scans: the number of positions would be infinite if they added up.
            let distance = has(block, "Distance") && !has(block, "EndVelocity");
            let velocity = if distance { 2.0 } else { 1.0 };
            for (pin, value) in [
                ("Position", position),
                ("Velocity", velocity),
                ("EndVelocity", 1.0),
                ("VelocityDiff", 2.0),
            ] {
                if has(block, pin) {
                    set(block, pin, Value::Lreal(value));
                }
            }
            if has(block, "ExecutionMode") {
                set(block, "ExecutionMode", Value::Enum(1));
            }
        }
        let inputs = Inputs {
            enable: true,
            ..Inputs::default()
        };
        let drive = Drive {
            enabled: true,
            voltage: true,
            fault: None,
            position: 0,
        };
        let kinds = blocks.each_ref().map(|block| Kind::of(block.info()));
        let outputs = blocks.each_ref().map(|block| Outputs::of(block.info()));
        Self {
            axis: [Axis::new(AxisId::new(0), config, Countdown).expect("a good configuration")],
            drive,
            blocks,
            kinds,
            outputs,
            polled: Default::default(),
            inputs,
            modes,
            scans: 0,
        }
    }

    pub fn state(&self) -> AxisState {
        self.axis[0].state()
    }

    /// The present inputs, without an event.
    pub fn held(&self) -> Inputs {
        Inputs {
            event: AxisEvent::Nothing,
            ..self.inputs
        }
    }

    /// All inputs worth trying: at most `changes` things change in a scan, and a buffer mode matters only at a
    /// rising edge.
    pub fn choices(&self, changes: usize) -> Vec<Inputs> {
        let modes = |place: usize| {
            let mut modes = vec![(false, 0), (true, 0)];
            let block = &self.blocks[[FIRST, SECOND][place]];
            if !self.inputs.execute[place] && block.info().pin("BufferMode").is_some() {
                modes.extend(self.modes.iter().map(|mode| (true, *mode)));
            }
            modes
        };
        let mut all = Vec::new();
        for (first, first_mode) in modes(0) {
            for (second, second_mode) in modes(1) {
                for bits in 0..4 {
                    for event in AxisEvent::ALL {
                        let inputs = Inputs {
                            execute: [first, second],
                            mode: [first_mode, second_mode],
                            stop: bits & 1 != 0,
                            enable: bits & 2 != 0,
                            event,
                        };
                        if self.inputs.changes_to(&inputs) <= changes {
                            all.push(inputs);
                        }
                    }
                }
            }
        }
        all
    }

    /// One scan in the order of the contract; an error names the broken rule.
    pub fn scan(&mut self, inputs: &Inputs) -> Result<(), String> {
        let before = self.inputs;
        let state_before = self.state();
        self.inputs = *inputs;
        self.apply(inputs);
        let mut log = Log::default();
        let feedback = self.read();
        self.axis[0].follow_feedback(&feedback, &mut Scope::new(self.scans, &mut log));
        let state_at_call = self.state();
        let was = self.shown();
        self.call(&mut log);
        let shown = self.shown();
        let scene = rules::Scene {
            before: &before,
            inputs,
            was: &was,
            shown: &shown,
            state_before,
            state_at_call,
            state: self.state(),
            powered: self.axis[0].is_powered(),
        };
        rules::calls(&scene, self.kinds)?;
        steps::advance(
            slice::from_mut(&mut self.axis[0]),
            &mut Scope::new(self.scans, &mut log),
        );
        self.write();
        self.scans += 1;
        self.polled = self.poll();
        rules::truth(&self.polled, &self.axis[0].outlook(), self.kinds)
    }

    fn apply(&mut self, inputs: &Inputs) {
        match inputs.event {
            AxisEvent::Nothing => {}
            AxisEvent::AxisFault => {
                self.axis[0].raise(ErrorId::AxisFault, 1, &mut Scope::new(0, &mut Log::default()));
            }
            AxisEvent::DriveFault => {
                self.drive.fault = Some(true);
                self.drive.enabled = false;
            }
            AxisEvent::PowerLoss => {
                self.drive.voltage = false;
                self.drive.enabled = false;
            }
            AxisEvent::Reset => {
                // A refused reset shows at its block and nowhere else.
                let _ = self.axis[0].reset(&mut Scope::new(0, &mut Log::default()));
            }
            AxisEvent::CausesGone => {
                self.axis[0].clear_cause();
                self.drive.voltage = true;
                self.drive.fault = self.drive.fault.map(|_| false);
            }
        }
        for (place, index) in [(FIRST, 0), (SECOND, 1)] {
            let trigger = trigger(&self.blocks[place]);
            set(
                &mut self.blocks[place],
                trigger,
                Value::Bool(inputs.execute[index]),
            );
            if self.blocks[place].info().pin("BufferMode").is_some() {
                let mode = Value::Enum(i32::from(inputs.mode[index]));
                set(&mut self.blocks[place], "BufferMode", mode);
            }
        }
        set(&mut self.blocks[STOP], "Execute", Value::Bool(inputs.stop));
        set(&mut self.blocks[POWER], "Enable", Value::Bool(inputs.enable));
    }

    fn read(&self) -> DriveFeedback {
        DriveFeedback {
            enabled: self.drive.enabled,
            voltage: self.drive.voltage,
            fault: self.drive.fault.map(|cause_present| Fault {
                code: 7,
                cause_present,
            }),
            position: DrivePosition::Units(f64::from_bits(self.drive.position)),
            comms: Comms::Ok,
            signals: DriveSignals::default(),
        }
    }

    fn call(&mut self, log: &mut Log) {
        for (place, block) in (0..).zip(&mut self.blocks) {
            block.call(&mut Context {
                now_ns: 0,
                scope: Scope {
                    instance: InstanceId(place),
                    ..Scope::new(self.scans, log)
                },
                axes: &mut self.axis,
                tables: &[],
            });
        }
    }

    fn write(&mut self) {
        let command = self.axis[0].drive_command();
        match command.request {
            DriveRequest::Enable => self.drive.enabled = self.drive.voltage && self.drive.fault.is_none(),
            DriveRequest::FaultReset => {
                self.drive.fault = self.drive.fault.filter(|present| *present);
                self.drive.enabled = false;
            }
            DriveRequest::Off | DriveRequest::QuickStop => self.drive.enabled = false,
        }
        if self.drive.enabled {
            self.drive.position = self.axis[0].setpoint().position.to_bits();
        }
    }

    /// The outputs that the blocks would show if they were called now with unchanged inputs.
    fn poll(&self) -> [Shown; 4] {
        let mut copy = self.clone();
        copy.call(&mut Log::default());
        copy.shown()
    }

    fn shown(&self) -> [Shown; 4] {
        let mut shown = [Shown::default(); 4];
        for ((shown, outputs), block) in shown.iter_mut().zip(&self.outputs).zip(&self.blocks) {
            *shown = outputs.read(block);
        }
        shown
    }

    pub fn key(&self) -> Key {
        let axis = &self.axis[0];
        let setpoint = axis.setpoint();
        let mut outlook = axis.outlook().without_numbers();
        // No instance here asks whether the axis is homed.
        outlook.homed = false;
        Key {
            axis: outlook,
            setpoint: (setpoint.position.to_bits(), setpoint.velocity.to_bits()),
            goal: axis.plan().map(|(plan, _)| {
                let end = plan.at(u64::from(plan.scans()));
                (end.position.to_bits(), end.velocity.to_bits())
            }),
            drive: self.drive,
            inputs: Inputs {
                mode: [0; 2],
                ..self.held()
            },
            // The error number has no effect on the next scans.
            shown: self.shown().map(Shown::without_error_id),
            polled: self.polled.map(Shown::without_error_id),
        }
    }
}

fn set(block: &mut BlockInstance, pin: &str, value: Value) {
    let (index, _) = block.info().pin(pin).expect("a pin of the block");
    block.set(index, value).expect("a value of the pin's type");
}

/// The pin that gives the command.
pub fn trigger(block: &BlockInstance) -> &'static str {
    if block.info().pin("Execute").is_some() {
        "Execute"
    } else {
        "JogForward"
    }
}

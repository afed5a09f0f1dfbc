//! A machine: axes, ideal drives and instances of blocks, all drawn at random, and random actions on
//! them.

use core::array::from_fn;
use standstill_axis::{
    Axis, AxisConfig, AxisId, AxisState, Drive, DrivePosition, Event, IdealDrive, InstanceId, Limits, Log,
    MoveProfile, PowerOff, Scaling, Scope, Standard, StartState, steps,
};
use standstill_blocks::{BlockInstance, REGISTRY};
use standstill_fb::{AnyInstance, Context, Direction, Group, Pin, PinType, TableInfo, TableRef, Value};
use standstill_testkit::Random;

const AXES: usize = 3;

/// Instances of an axis; the first switches it on, the second resets it.
const BLOCKS: usize = 8;

/// Numbers of all tables.
const CELLS: usize = 48;

/// Lengths of a cycle (ns).
const CYCLES: [i64; 4] = [250_000, 1_000_000, 2_000_000, 10_000_000];

#[derive(Debug)]
pub struct Machine {
    cycle_ns: i64,
    axes: [Axis; AXES],
    drives: [IdealDrive; AXES],
    log: Log,
    /// Records before this scan.
    told: u64,
    blocks: [[BlockInstance; BLOCKS]; AXES],
    tables: [f64; CELLS],
}

impl Machine {
    pub fn new(random: &mut Random) -> Self {
        let cycle_ns = random.one_of(&CYCLES);
        let cycle = cycle_ns as f64 / 1e9;
        let configs: [_; AXES] = from_fn(|_| config(random, cycle));
        let axes = from_fn(|at| {
            Axis::new(id(at), configs[at], Standard::new(cycle)).expect("configurations are drawn valid")
        });
        let drives = from_fn(|at| drive(random, &configs[at]));
        let tables = from_fn(|_| random.between(-0.1, 0.1));
        let blocks = from_fn(|axis| {
            from_fn(|place| {
                let name = match place {
                    0 => "MC_Power",
                    1 => "MC_Reset",
                    // Half of the others move it.
                    _ => loop {
                        let info = random.one_of(REGISTRY);
                        if place % 2 == 0 || info.group == Group::SingleAxis {
                            break info.name;
                        }
                    },
                };
                block(random, name, axis, &configs[axis], cycle)
            })
        });
        Self {
            cycle_ns,
            axes,
            drives,
            log: Log::default(),
            told: 0,
            blocks,
            tables,
        }
    }

    /// One scan, and every bit that it publishes.
    pub fn scan(&mut self, scan: u64, random: &mut Random, fold: &mut impl FnMut(u64)) {
        let now_ns = self.cycle_ns * scan.cast_signed();
        self.told = self.log.total();
        self.disturb(random);
        for (axis, drive) in self.axes.iter_mut().zip(&mut self.drives) {
            axis.follow_feedback(&drive.read(now_ns), &mut Scope::new(scan, &mut self.log));
        }
        let mut instance = 0;
        for block in self.blocks.as_flattened_mut() {
            instance += 1;
            block.call(&mut Context {
                now_ns,
                scope: Scope {
                    scan,
                    instance: InstanceId(instance),
                    log: &mut self.log,
                    cams: standstill_axis::Cams::default(),
                    history: &mut [],
                },
                axes: &mut self.axes,
                tables: &self.tables,
            });
        }
        steps::advance(&mut self.axes, &mut Scope::new(scan, &mut self.log));
        for (axis, drive) in self.axes.iter_mut().zip(&mut self.drives) {
            let command = axis.drive_command();
            drive.write(now_ns, &command);
            fold(match command.position {
                DrivePosition::Units(units) => units.to_bits(),
                DrivePosition::Increments(increments) => increments.cast_unsigned(),
            });
        }
        self.publish(fold);
    }

    /// Presses, changes values, breaks and repairs drives.
    fn disturb(&mut self, random: &mut Random) {
        let at = random.below(AXES as u64) as usize;
        let place = random.below(BLOCKS as u64) as usize;
        let block = &mut self.blocks[at][place];
        if place == 0 {
            // Mostly on.
            set(block, "Enable", Value::Bool(!random.one_in(20)));
        } else if random.one_in(3) {
            let cycle = self.cycle_ns as f64 / 1e9;
            draw(random, block, self.axes[at].config(), cycle);
        } else {
            for pin in ["Execute", "Enable", "JogForward", "IN", "CLK", "CU", "CD"] {
                set(block, pin, Value::Bool(random.one_in(2)));
            }
        }
        if random.one_in(1000) {
            match random.below(3) {
                0 => self.drives[at].fail(7),
                1 => self.drives[at].cut_power(),
                _ => self.drives[at].cut_communication(),
            }
        }
        if random.one_in(50) {
            self.drives[at].clear_cause();
            self.axes[at].clear_cause();
        }
    }

    /// Set-points, states and errors of the axes, and all outputs of the blocks.
    fn publish(&self, fold: &mut impl FnMut(u64)) {
        for axis in &self.axes {
            let setpoint = axis.setpoint();
            for number in [
                setpoint.position,
                setpoint.velocity,
                setpoint.acceleration,
                setpoint.jerk,
                setpoint.snap,
                axis.actual_position(),
            ] {
                fold(number.to_bits());
            }
            fold(axis.state() as u64 | u64::from(axis.error_id().number()) << 32);
        }
        for block in self.blocks.as_flattened() {
            for (index, pin) in block.info().pins().enumerate() {
                if pin.direction == Direction::Output {
                    fold(block.get(index).map_or(0, word));
                }
            }
        }
    }

    pub fn states(&self) -> [AxisState; AXES] {
        from_fn(|at| self.axes[at].state())
    }

    /// The records of this scan.
    pub fn events(&self) -> impl Iterator<Item = Event> {
        self.log.since(self.told).map(|record| record.event)
    }
}

fn id(axis: usize) -> AxisId {
    AxisId::new(axis as u16)
}

/// An axis of order 2, 3 or 4 whose ramps take a few scans.
fn config(random: &mut Random, cycle: f64) -> AxisConfig {
    let order = 2 + random.below(3);
    let velocity = random.one_of(&[0.5, 20.0, 800.0]) * random.between(0.5, 2.0);
    let acceleration = velocity / (cycle * random.between(2.0, 40.0));
    let jerk = acceleration / (cycle * random.between(2.0, 20.0));
    let snap = jerk / (cycle * random.between(2.0, 20.0));
    let mut config = AxisConfig::new(Limits {
        velocity,
        acceleration,
        deceleration: acceleration * random.between(0.5, 1.5),
        jerk: if order > 2 { jerk } else { f64::INFINITY },
        snap: if order > 3 { snap } else { f64::INFINITY },
    });
    let way = velocity * cycle;
    config.start = random.one_of(&[StartState::Standstill, StartState::Disabled]);
    match random.below(4) {
        0 => config.modulo = Some(way * random.between(20.0, 500.0)),
        1 => config.software_limits = Some((-way * random.between(50.0, 500.0), way * 500.0)),
        2 => config.scaling = Scaling::new(1 << 20, random.one_of(&[1, 7, 360]), random.one_in(2), 0.0).ok(),
        _ => {}
    }
    config.on_power_off = random.one_of(&[PowerOff::Ramp, PowerOff::Coast, PowerOff::Drive]);
    config.profile = random.one_of(&MoveProfile::ALL);
    if config.check().is_err() {
        config.profile = MoveProfile::Overlapped;
    }
    config
}

fn drive(random: &mut Random, config: &AxisConfig) -> IdealDrive {
    let position = match config.scaling {
        Some(_) => DrivePosition::Increments(0),
        None => DrivePosition::Units(0.0),
    };
    let enabled = config.start == StartState::Standstill;
    IdealDrive::new(
        position,
        random.below(4) as usize,
        Some(random.below(6) as u32),
        enabled,
    )
}

fn block(random: &mut Random, name: &str, axis: usize, config: &AxisConfig, cycle: f64) -> BlockInstance {
    let mut block = BlockInstance::new(name).expect("a name of the registry");
    for (index, pin) in block.info().pins().enumerate() {
        let value = match pin.ty {
            PinType::Axis(_) if pin.name == "Master2" => Value::Axis(id((axis + 2) % AXES)),
            PinType::Axis(_) if pin.name.starts_with("Master") => Value::Axis(id((axis + 1) % AXES)),
            PinType::Axis(_) => Value::Axis(id(axis)),
            PinType::Table(of) => Value::Table(table(random, of)),
            PinType::Lreal if pin.direction == Direction::Input => number(random, pin, config, cycle),
            _ => continue,
        };
        block.set(index, value).expect("a value of the pin's type");
    }
    if name == "MC_Power" {
        set(&mut block, "Enable", Value::Bool(true));
    }
    block
}

/// A few records at a random place among the numbers of all tables.
fn table(random: &mut Random, of: TableInfo) -> TableRef {
    let most = (CELLS / of.fields.len()).min(of.most);
    let records = 1 + random.below(most as u64);
    let last = CELLS - records as usize * of.fields.len();
    TableRef {
        first: random.below(last as u64 + 1) as u32,
        records: records as u16,
    }
}

/// Another value at one of the inputs.
fn draw(random: &mut Random, block: &mut BlockInstance, config: &AxisConfig, cycle: f64) {
    let pins = block.info().pins().count() as u64;
    let index = random.below(pins) as usize;
    let Some(pin) = block.info().pins().nth(index) else {
        return;
    };
    let value = match pin.ty {
        PinType::Bool => Value::Bool(random.one_in(2)),
        PinType::Int => Value::Int(random.below(12) as i16),
        PinType::Uint | PinType::Word => Value::Word(random.below(12) as u16),
        PinType::Dword => Value::Dword(random.below(1 << 32) as u32),
        PinType::Time => Value::Time(random.below(100_000_000).cast_signed()),
        PinType::Enum(_) => Value::Enum(random.below(6) as i32),
        PinType::Lreal => number(random, pin, config, cycle),
        PinType::Axis(_) | PinType::Table(_) => return,
    };
    // An output cannot be written.
    let _refused = block.set(index, value);
}

/// A number that suits the unit of the pin, and sometimes one that does not.
fn number(random: &mut Random, pin: &Pin, config: &AxisConfig, cycle: f64) -> Value {
    let limits = &config.limits;
    let part = random.between(0.05, 1.0);
    let magnitude = match pin.unit {
        "u" => random.one_of(&[1.0, 30.0, 500.0]) * limits.velocity * cycle,
        "u/s" => limits.velocity,
        // A zero takes the default of the axis.
        "u/s^2" | "u/s^3" | "u/s^4" if random.one_in(2) => 0.0,
        "u/s^2" => limits.acceleration,
        "u/s^3" if limits.jerk.is_finite() => limits.jerk,
        "u/s^4" if limits.snap.is_finite() => limits.snap,
        "u/s^3" | "u/s^4" => 0.0,
        _ => 1.25,
    };
    let signed = pin.unit == "u" && random.one_in(2) || random.one_in(16);
    Value::Lreal(part * if signed { -magnitude } else { magnitude })
}

/// Writes an input by its name, if the block has it.
fn set(block: &mut BlockInstance, name: &str, value: Value) {
    if let Some((index, _)) = block.info().pin(name) {
        // A pin of this name with another type is not changed.
        let _refused = block.set(index, value);
    }
}

fn word(value: Value) -> u64 {
    match value {
        Value::Bool(value) => u64::from(value),
        Value::Int(value) => i64::from(value).cast_unsigned(),
        Value::Lreal(value) => value.to_bits(),
        Value::Word(value) => u64::from(value),
        Value::Dword(value) => u64::from(value),
        Value::Time(value) => value.cast_unsigned(),
        Value::Axis(value) => value.index() as u64,
        Value::Enum(value) => i64::from(value).cast_unsigned(),
        Value::Table(value) => u64::from(value.first) << 32 | u64::from(value.records),
    }
}

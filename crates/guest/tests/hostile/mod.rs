//! Bytes as a hostile guest: it calls any block, `log` and `log_read` with any addresses, sizes, counts and pins, and
//! any of its variables is read and written from outside. A fuzzer makes the bytes, or a test does.
//!
//! The rules: nothing panics, every call answers with a code of the list or ends the guest by a fault,
//! and after a fault every axis ramps down and switches off.

use standstill_axis::{AxisConfig, DrivePosition, IdealDrive, Limits, Standard};
use standstill_blocks::REGISTRY;
use standstill_fb::flat::{Pointer, Scalar};
use standstill_fb::{Context, Pin, PinType, Value};
use standstill_guest::{Fault, Guest, Program, Settings, Symbol, SymbolError, SymbolType};
use standstill_scan::{Executor, Machine, Mode, ProgramConfig, ProgramFault, ProgramId, Programs};
use std::fmt::Write as _;
use std::sync::LazyLock;

/// Largest number of calls of a scan.
const CALLS: u32 = 6;

/// Largest number of scans of a case.
const SCANS: u32 = 150;

/// Begin of the areas of 1024 bytes for each block: key, inputs, outputs.
const PLACES: u32 = 4096;

/// Address of the records of arrays.
const RECORDS: u32 = PLACES + 1024 * REGISTRY.len() as u32;

/// Acceleration and deceleration of the axes (u/s^2).
const RATE: f64 = 200.0;

const CYCLE: f64 = 0.001;

/// At 0 the number of calls, from 16 on calls of 24 bytes: function and five arguments. The globals count results
/// that are 0 and keep one that has no meaning. No call can overwrite them.
static PROGRAM: LazyLock<Program> = LazyLock::new(|| {
    let mut text = "(module\n".to_owned();
    for (index, name) in NAMES.iter().enumerate() {
        let _ = writeln!(
            text,
            "(import \"standstill\" \"{name}\" (func $f{index} (param i32 i32 i32) (result i32)))"
        );
    }
    text += "(import \"standstill\" \"log\" (func $log (param i32 i32)))
        (import \"standstill\" \"log_read\" (func $log_read (param i32 i32 i32 i32 i32) (result i32)))
        (memory (export \"memory\") 1)
        (global $good (export \"good\") (mut i32) (i32.const 0))
        (global $bad (export \"bad\") (mut i32) (i32.const 0))
        (func $call (param $at i32) (result i32) (local $f i32)
          (local.set $f (i32.load (local.get $at)))\n";
    let argument = |number: usize| format!("(i32.load offset={} (local.get $at))", 4 * number);
    for index in 0..REGISTRY.len() {
        let _ = writeln!(
            text,
            "(if (i32.eq (local.get $f) (i32.const {index})) (then (return (call $f{index} {} {} {}))))",
            argument(1),
            argument(2),
            argument(3)
        );
    }
    let _ = writeln!(
        text,
        "(if (i32.eq (local.get $f) (i32.const {})) (then (call $log {} {}) (return (i32.const 0))))
        (call $log_read {} {} {} {} {}))",
        REGISTRY.len(),
        argument(1),
        argument(2),
        argument(1),
        argument(2),
        argument(3),
        argument(4),
        argument(5)
    );
    text += "(func (export \"plc_scan\") (param i32 i64) (local $n i32)
        (local $code i32)
        (block $end (loop $next
          (br_if $end (i32.ge_u (local.get $n) (i32.load (i32.const 0))))
          (local.set $code (call $call (i32.add (i32.const 16) (i32.mul (local.get $n) (i32.const 24)))))
          (if (i32.eqz (local.get $code))
            (then (global.set $good (i32.add (global.get $good) (i32.const 1))))
            (else (if (i32.and (i32.ne (local.get $code) (i32.const -17)) (i32.or
                (i32.gt_s (local.get $code) (i32.const 0)) (i32.lt_s (local.get $code) (i32.const -12))))
              (then (global.set $bad (local.get $code))))))
          (local.set $n (i32.add (local.get $n) (i32.const 1)))
          (br $next)))))";
    Program::compile(text.as_bytes(), Settings::default()).expect("a good guest")
});

macro_rules! names {
    ($($group:ident :: $name:ident :: $block:ident)*) => {
        const NAMES: &[&str] = &[$(stringify!($name)),*];
    };
}

standstill_blocks::for_every_block!(names);

fn place_of(name: &str) -> u32 {
    let place = NAMES.iter().position(|known| *known == name);
    place.expect("it is a block") as u32
}

struct Host {
    guest: Guest,
    fault: Option<Fault>,
}

impl Programs<Standard, IdealDrive> for Host {
    fn run(&mut self, _: ProgramId, context: &mut Context<'_>) -> Result<u64, ProgramFault> {
        self.guest.scan(context).map_err(|fault| {
            let reason = fault.reason();
            self.fault = Some(fault);
            ProgramFault { reason }
        })
    }
}

/// The rest of the input; zeros when it has run out.
struct Bytes<'a> {
    left: &'a [u8],
    /// This many of 256 addresses, sizes and counts are invalid.
    hostility: u8,
}

impl Bytes<'_> {
    fn byte(&mut self) -> u8 {
        let Some((first, rest)) = self.left.split_first() else {
            return 0;
        };
        self.left = rest;
        *first
    }

    fn number(&mut self) -> u64 {
        u64::from_le_bytes(std::array::from_fn(|_| self.byte()))
    }

    fn below(&mut self, end: u32) -> u32 {
        u32::from(self.byte()) % end
    }

    /// Usually `good`, otherwise a value of a hostile guest.
    fn or(&mut self, good: u32) -> u32 {
        if self.hostility == 0 || self.byte() >= self.hostility {
            return good;
        }
        match self.below(8) {
            0 => 0,
            1 => u32::MAX - self.below(128),
            // Near the end of the memory.
            2 | 3 => 65_536 - self.below(300),
            // Over the place of another call.
            4 | 5 => PLACES + 64 * self.below(256),
            6 => good.wrapping_add(self.below(16)),
            _ => self.number() as u32,
        }
    }

    /// A double, usually of a realistic size.
    fn double(&mut self) -> f64 {
        match self.byte() {
            0..=229 => f64::from(self.byte()) * 0.5 - 8.0,
            230..=239 => f64::NAN,
            _ => f64::from_bits(self.number()),
        }
    }
}

struct Case<'a> {
    bytes: Bytes<'a>,
    host: Host,
    machine: Machine<Standard, IdealDrive>,
    executor: Executor,
    now_ns: i64,
}

impl Case<'_> {
    fn write(&mut self, ty: SymbolType, address: u32, value: Value) {
        let outcome = self.host.guest.write(&Symbol { ty, address }, value);
        assert_eq!(outcome, Ok(()), "{address}");
    }

    fn write_number(&mut self, address: u32, number: u32) {
        self.write(SymbolType::Dword, address, Value::Dword(number));
    }

    /// Puts one call into the list of the guest.
    fn queue(&mut self, place: u32) {
        let any = self.bytes.below(REGISTRY.len() as u32 + 4);
        // Often a block that moves an axis.
        let function = match self.bytes.byte() {
            0..=79 => place_of("mc_power"),
            80..=139 => place_of("mc_move_velocity"),
            _ => any,
        };
        let block = REGISTRY.get(function as usize);
        let base = PLACES + 1024 * function.min(REGISTRY.len() as u32 - 1);
        let mut arguments = [base, base + 16, base + 512, 0, 0];
        if let Some(info) = block {
            let (inputs, outputs) = (info.flat_inputs(Pointer::Bits32), info.flat_outputs());
            for (address, size) in [(base + 16, inputs.size), (base + 512, outputs.size)] {
                let size = self.bytes.or(size as u32);
                self.write_number(address, size);
            }
            for (index, pin) in info.inputs().iter().enumerate() {
                if self.bytes.byte() > 60 {
                    self.pin(base + 16 + inputs.offset(index) as u32, pin);
                }
            }
        } else if function == REGISTRY.len() as u32 {
            arguments = [base, self.bytes.below(64), 0, 0, 0];
        } else {
            // The arguments of `log_read`: next, records, size, room, copied.
            arguments = [base, base + 16, 96, self.bytes.below(6), base + 8];
        }
        let entry = 16 + 24 * place;
        self.write_number(entry, function);
        for (index, good) in (0_u32..).zip(arguments) {
            let argument = self.bytes.or(good);
            self.write_number(entry + 4 + 4 * index, argument);
        }
    }

    fn pin(&mut self, address: u32, pin: &Pin) {
        let (ty, value) = match (pin.ty, pin.ty.scalar()) {
            (PinType::Axis(_), _) => {
                let axis = 1 + self.bytes.below(2);
                let axis = self.bytes.or(axis);
                (SymbolType::Dword, Value::Dword(axis))
            }
            (PinType::Table(_), _) | (_, None) => {
                let records = self.bytes.or(RECORDS);
                self.write_number(address, records);
                let count = self.bytes.below(8);
                let count = self.bytes.or(count);
                self.write_number(address + 4, count);
                return;
            }
            (_, Some(Scalar::U8)) => (SymbolType::Byte, Value::Word((self.bytes.byte() > 50).into())),
            (_, Some(Scalar::F64)) => (SymbolType::Lreal, Value::Lreal(self.bytes.double())),
            (_, Some(Scalar::I64)) => (SymbolType::Time, Value::Time(self.bytes.number() as i64)),
            (_, Some(Scalar::I16 | Scalar::U16)) => (SymbolType::Word, Value::Word(self.bytes.byte().into())),
            (_, Some(Scalar::I32 | Scalar::U32)) => {
                let small = self.bytes.below(4);
                (SymbolType::Dword, Value::Dword(self.bytes.or(small)))
            }
        };
        self.write(ty, address, value);
    }

    /// Number of calls done; a restored guest continues to count.
    fn done(&self) -> u32 {
        self.host.guest.address_of("good").expect("it is exported")
    }

    /// A variable at any address, read and written back.
    fn variable(&mut self) {
        let ty = SymbolType::ALL[self.bytes.below(13) as usize];
        let address = self.bytes.or(RECORDS);
        let symbol = Symbol { ty, address };
        match self.host.guest.read(&symbol) {
            Ok(value) => assert_eq!(self.host.guest.write(&symbol, value), Ok(())),
            Err(error) => {
                assert!(matches!(error, SymbolError::Outside { .. }), "{error}");
                assert!(address > 65_536 - 8, "{address}");
            }
        }
    }

    fn scan(&mut self) {
        self.executor
            .scan(self.now_ns, &mut self.host, &mut self.machine)
            .expect("time goes on");
        self.now_ns += 1_000_000;
    }

    fn velocities(&self) -> Vec<f64> {
        let axes = self.machine.axes().iter();
        axes.map(|axis| axis.setpoint().velocity).collect()
    }

    /// After a fault: no axis brakes harder than permitted, and all are off in the end.
    fn stops(&mut self) {
        let most = RATE * CYCLE * 1.000_001;
        let mut before = self.velocities();
        for _ in 0..5_000 {
            if self.machine.is_off().is_ok() {
                assert!(before.iter().all(|velocity| *velocity == 0.0), "{before:?}");
                return;
            }
            self.scan();
            let now = self.velocities();
            for (before, now) in before.iter().zip(&now) {
                assert!((now - before).abs() <= most, "{before} {now}");
            }
            before = now;
        }
        panic!("it never stops: {before:?}");
    }
}

/// The result of a case.
#[derive(Debug, Default)]
#[allow(dead_code)]
pub struct Played {
    /// The guest had a fault.
    pub fault: bool,
    /// An axis was moving at that time.
    pub moving: bool,
    /// Number of calls done.
    pub done: u32,
}

/// Plays a case to its end.
pub fn play(bytes: &[u8]) -> Played {
    let limits = Limits {
        velocity: 50.0,
        acceleration: RATE,
        deceleration: RATE,
        jerk: 2e3,
        snap: 4e4,
    };
    let mut machine = Machine::new();
    for _ in 0..2 {
        let drive = IdealDrive::new(DrivePosition::Units(0.0), 0, Some(0), false);
        machine
            .add_axis(AxisConfig::new(limits), Standard::new(CYCLE), drive)
            .expect("a good axis");
    }
    let guest = PROGRAM.start().expect("it starts");
    let mut case = Case {
        bytes: Bytes {
            left: bytes.get(1..).unwrap_or_default(),
            hostility: bytes.first().map_or(0, |first| first % 4),
        },
        host: Host { guest, fault: None },
        machine,
        executor: Executor::new(1_000_000, &[], &[ProgramConfig::free("main")]).expect("a good program"),
        now_ns: 0,
    };
    for _ in 0..SCANS {
        if case.bytes.left.is_empty() {
            break;
        }
        let calls = case.bytes.below(CALLS + 1);
        case.write_number(0, calls);
        for place in 0..calls {
            case.queue(place);
        }
        case.variable();
        case.scan();
        // A fault elsewhere does not stop the resource: axes have their own faults.
        assert_eq!(case.host.fault.is_some(), case.executor.mode() != Mode::Running);
        if case.host.fault.is_some() {
            let moving = case.velocities().iter().any(|velocity| *velocity != 0.0);
            case.stops();
            return Played {
                fault: true,
                moving,
                done: case.done(),
            };
        }
        assert_eq!(case.host.guest.address_of("bad"), Ok(0));
        if case.bytes.byte() > 250 {
            let snapshot = case.host.guest.snapshot();
            case.host.guest = PROGRAM.restore(&snapshot).expect("there is memory");
        }
        let _told = case.host.guest.take_told();
    }
    Played {
        done: case.done(),
        ..Played::default()
    }
}

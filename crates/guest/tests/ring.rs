//! The diagnostic ring as read by a guest.

use standstill_axis::{AxisId, Event, IdealDrive, InstanceId, Record, Standard};
use standstill_fb::Value;
use standstill_guest::{Guest, Program, Settings, Symbol, SymbolType};
use standstill_scan::{Machine, RUNTIME, ScanTime};

/// Calls `log_read` with the five numbers at 16 and writes its code to 8; before, in `plc_init`, to 12.
const READER: &str = r#"(module
  (import "standstill" "log_read" (func $read (param i32 i32 i32 i32 i32) (result i32)))
  (memory (export "memory") 1)
  (func $call (result i32)
    (call $read (i32.load (i32.const 16)) (i32.load (i32.const 20)) (i32.load (i32.const 24))
      (i32.load (i32.const 28)) (i32.load (i32.const 32))))
  (func (export "plc_init") (i32.store (i32.const 12) (call $call)))
  (func (export "plc_scan") (param i32 i64) (i32.store (i32.const 8) (call $call))))"#;

struct Bench {
    guest: Guest,
    machine: Machine<Standard, IdealDrive>,
}

impl Bench {
    fn new() -> Self {
        let program = Program::compile(READER.as_bytes(), Settings::default()).unwrap();
        Self {
            guest: program.start().unwrap(),
            machine: Machine::new(),
        }
    }

    fn at(&self, address: u32, ty: SymbolType) -> Value {
        self.guest.read(&Symbol { ty, address }).unwrap()
    }

    /// Makes this number of records.
    fn record(&mut self, records: u64) {
        let context = self.machine.context(ScanTime { scan: 0, now_ns: 0 }, RUNTIME);
        for scan in 0..records {
            context.scope.log.push(Record {
                scan,
                axis: AxisId::new(0),
                instance: InstanceId(9),
                event: Event::Shifted { by: 2.5 },
            });
        }
    }

    /// A scan with these arguments; returns the code.
    fn read(&mut self, arguments: [u32; 5]) -> Result<Value, String> {
        for (address, argument) in (16..).step_by(4).zip(arguments) {
            let symbol = Symbol {
                ty: SymbolType::Udint,
                address,
            };
            self.guest.write(&symbol, Value::Dword(argument)).unwrap();
        }
        let mut context = self.machine.context(ScanTime { scan: 1, now_ns: 1 }, RUNTIME);
        self.guest.scan(&mut context).map_err(|fault| fault.to_string())?;
        Ok(self.at(8, SymbolType::Dint))
    }
}

#[test]
fn records_are_copied_oldest_first_and_those_overwritten_are_left_out() {
    let mut bench = Bench::new();
    // Outside a scan.
    assert_eq!(bench.at(12, SymbolType::Dint), Value::Lreal(-7.0));
    let given = [64, 1024, 104, 40, 72];
    assert_eq!(bench.read(given), Ok(Value::Lreal(0.0)));
    assert_eq!(bench.at(72, SymbolType::Udint), Value::Dword(0));
    bench.record(70);
    for (copied, next, first) in [(40, 46, 6), (24, 70, 46), (0, 70, 46)] {
        assert_eq!(bench.read(given), Ok(Value::Lreal(0.0)));
        assert_eq!(bench.at(72, SymbolType::Udint), Value::Dword(copied));
        assert_eq!(bench.at(64, SymbolType::Time), Value::Time(next));
        assert_eq!(bench.at(1024, SymbolType::Time), Value::Time(first));
    }
    // The second record, one stride further: number, scan, axis, no instance of the guest, event, value.
    let second = 1024 + 104;
    assert_eq!(bench.at(second, SymbolType::Time), Value::Time(47));
    assert_eq!(bench.at(second + 8, SymbolType::Time), Value::Time(47));
    assert_eq!(bench.at(second + 16, SymbolType::Dint), Value::Lreal(1.0));
    assert_eq!(bench.at(second + 20, SymbolType::Udint), Value::Dword(0));
    assert_eq!(bench.at(second + 24, SymbolType::Dint), Value::Lreal(6.0));
    assert_eq!(bench.at(second + 40, SymbolType::Lreal), Value::Lreal(2.5));
}

#[test]
fn wrong_arguments_get_a_code_or_end_the_guest() {
    for (arguments, outcome) in [
        ([0, 1024, 96, 8, 72], Ok(-1.0)),
        ([64, 0, 96, 8, 72], Ok(-1.0)),
        ([64, 1024, 96, 8, 0], Ok(-1.0)),
        ([64, 1024, 95, 8, 72], Ok(-2.0)),
        // No room and no records: only `next` and `copied` are written.
        ([64, 0, 96, 0, 72], Ok(0.0)),
        (
            [65_529, 1024, 96, 8, 72],
            Err("log_read: 8 bytes of `next` at address 65529"),
        ),
        (
            [64, 1024, 96, 8, 65_533],
            Err("log_read: 4 bytes of `copied` at address 65533"),
        ),
        (
            [64, 65_441, 96, 1, 72],
            Err("log_read: 96 bytes of `records` at address 65441"),
        ),
        (
            [64, 1024, u32::MAX, u32::MAX, 72],
            Err("log_read: 18446744065119617025 bytes of `records` at address 1024"),
        ),
    ] {
        let mut bench = Bench::new();
        bench.record(1);
        let found = bench.read(arguments);
        match outcome {
            Ok(code) => assert_eq!(found, Ok(Value::Lreal(code)), "{arguments:?}"),
            Err(text) => {
                let told = found.unwrap_err();
                assert!(told.starts_with(text), "{arguments:?}: {told}");
            }
        }
    }
}

//! A guest under an executor with an axis, and its fastest scan.

use standstill_axis::{AxisConfig, DrivePosition, IdealDrive, Limits, Standard, StartState};
use standstill_fb::Context;
use standstill_guest::{Guest, Program, Settings};
use standstill_scan::{Executor, Machine, ProgramConfig, ProgramFault, ProgramId, Programs};
use std::error::Error;
use std::time::Instant;

/// A guest that does nothing: the cost of the interpreter itself.
pub const EMPTY: &str = r#"(module
  (memory (export "memory") 1)
  (func (export "plc_scan") (param i32 i64)))"#;

pub struct Hosted(pub Guest);

impl Hosted {
    pub fn new(module: &[u8]) -> Result<Self, Box<dyn Error>> {
        Ok(Self(Program::compile(module, Settings::default())?.start()?))
    }
}

impl Programs<Standard, IdealDrive> for Hosted {
    fn run(&mut self, _: ProgramId, context: &mut Context<'_>) -> Result<u64, ProgramFault> {
        let fuel = self.0.scan(context);
        fuel.map(|_| 0).map_err(|fault| ProgramFault {
            reason: fault.reason(),
        })
    }
}

/// A program under an executor with an axis.
pub struct Bench<R> {
    pub program: R,
    pub machine: Machine<Standard, IdealDrive>,
    executor: Executor,
    now_ns: i64,
    /// Seconds of a scan in the fastest round.
    pub best: f64,
}

impl<R: Programs<Standard, IdealDrive>> Bench<R> {
    pub fn new(program: R) -> Result<Self, Box<dyn Error>> {
        let limits = Limits {
            velocity: 50.0,
            acceleration: 200.0,
            deceleration: 200.0,
            jerk: 2e3,
            snap: 4e4,
        };
        let config = AxisConfig {
            start: StartState::Standstill,
            ..AxisConfig::new(limits)
        };
        let mut machine = Machine::new();
        let drive = IdealDrive::new(DrivePosition::Units(0.0), 0, Some(0), true);
        machine.add_axis(config, Standard::new(0.001), drive)?;
        Ok(Self {
            program,
            machine,
            executor: Executor::new(1_000_000, &[], &[ProgramConfig::free("main")])?,
            now_ns: 0,
            best: f64::MAX,
        })
    }

    /// So many scans.
    pub fn round(&mut self, scans: i64) -> Result<(), Box<dyn Error>> {
        let begin = Instant::now();
        for _ in 0..scans {
            let report = self
                .executor
                .scan(self.now_ns, &mut self.program, &mut self.machine)?;
            assert!(report.mode.fault().is_none(), "{:?}", report.mode);
            self.now_ns += 1_000_000;
        }
        // Other load of the machine can only add to it.
        self.best = self.best.min(begin.elapsed().as_secs_f64() / scans as f64);
        Ok(())
    }
}

//! A guest's scan beside that of a native program, in one run: each calls one MC_MoveAbsolute in the middle of a move,
//! under the same executor, axis and drive.

use standstill_axis::{
    AxisConfig, AxisId, DrivePosition, IdealDrive, InstanceId, Limits, Standard, StartState,
};
use standstill_blocks::single_axis::mc_move_absolute::McMoveAbsolute;
use standstill_fb::{Context, Instance};
use standstill_guest::{Guest, Program, Settings};
use standstill_scan::{Executor, Machine, ProgramConfig, ProgramFault, ProgramId, Programs};
use std::time::Instant;

const ROUNDS: usize = 31;
const SCANS: i64 = 20_000;

/// Key at 104, inputs at 112, outputs at 184; the target is beyond what the bench reaches.
const GUEST: &str = r#"(module
  (import "standstill" "mc_move_absolute" (func $move (param i32 i32 i32) (result i32)))
  (memory (export "memory") 1)
  (func (export "plc_init")
    (i32.store (i32.const 112) (i32.const 72))
    (i32.store (i32.const 116) (i32.const 1))
    (f64.store (i32.const 128) (f64.const 1e6))
    (f64.store (i32.const 136) (f64.const 50))
    (i32.store (i32.const 184) (i32.const 16)))
  (func (export "plc_scan") (param $tick i32) (param $now i64)
    (i32.store8 (i32.const 120) (i32.const 1))
    (drop (call $move (i32.const 104) (i32.const 112) (i32.const 184)))))"#;

struct Native(Instance<McMoveAbsolute>);

impl Programs<Standard, IdealDrive> for Native {
    fn run(&mut self, _: ProgramId, context: &mut Context<'_>) -> Result<u64, ProgramFault> {
        context.instance = InstanceId(1);
        self.0.inputs.execute = true;
        self.0.call(context);
        Ok(0)
    }
}

struct Hosted(Guest);

impl Programs<Standard, IdealDrive> for Hosted {
    fn run(&mut self, _: ProgramId, context: &mut Context<'_>) -> Result<u64, ProgramFault> {
        let fuel = self.0.scan(context);
        fuel.map(|_| 0).map_err(|fault| ProgramFault {
            reason: fault.reason(),
        })
    }
}

/// Seconds of a scan, the median of some rounds.
fn timed(program: &mut impl Programs<Standard, IdealDrive>) -> f64 {
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
    machine
        .add_axis(config, Standard::new(0.001), drive)
        .expect("a good axis");
    let mut executor = Executor::new(1_000_000, &[], &[ProgramConfig::free("main")]).expect("a good program");
    let mut now_ns = 0;
    let mut times: Vec<f64> = (0..ROUNDS)
        .map(|_| {
            let begin = Instant::now();
            for _ in 0..SCANS {
                let report = executor
                    .scan(now_ns, program, &mut machine)
                    .expect("time goes on");
                assert!(report.mode.fault().is_none());
                now_ns += 1_000_000;
            }
            begin.elapsed().as_secs_f64() / SCANS as f64
        })
        .collect();
    assert!(machine.axes()[0].setpoint().velocity > 0.0, "it moves");
    times.sort_by(f64::total_cmp);
    times[ROUNDS / 2]
}

fn main() {
    let mut native = Instance::<McMoveAbsolute>::default();
    native.inputs.axis = AxisId::new(0);
    (native.inputs.position, native.inputs.velocity) = (1e6, 50.0);
    let native = timed(&mut Native(native));
    let program = Program::compile(GUEST.as_bytes(), Settings::default()).expect("a good guest");
    let mut guest = Hosted(program.start().expect("it starts"));
    let hosted = timed(&mut guest);
    println!("a native program's scan {:>8.1} ns", native * 1e9);
    println!(
        "a guest's scan          {:>8.1} ns, {} fuel",
        hosted * 1e9,
        guest.0.fuel_used()
    );
    let ratio = hosted / native;
    println!(
        "ratio                   {ratio:>8.2} (bar 4){}",
        if ratio > 4.0 { "  ABOVE" } else { "" }
    );
}

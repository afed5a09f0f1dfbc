//! A guest's scan beside that of a native program, in one run: each calls one MC_MoveAbsolute in the
//! middle of a move, under the same executor, axis and drive. A guest that does nothing shows the cost of
//! the interpreter itself.

mod hosted;

use hosted::{Bench, EMPTY, Hosted};
use standstill_axis::{AxisId, IdealDrive, InstanceId, Standard};
use standstill_blocks::single_axis::mc_move_absolute::McMoveAbsolute;
use standstill_fb::{Context, Instance};
use standstill_scan::{ProgramFault, ProgramId, Programs};
use std::error::Error;

/// Rounds of each program, in turn.
const ROUNDS: usize = 4_000;
const SCANS: i64 = 2_000;

/// Key at 104, inputs at 112, outputs at 184; the bench does not reach the target.
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

struct Nothing;

impl Programs<Standard, IdealDrive> for Nothing {
    fn run(&mut self, _: ProgramId, _: &mut Context<'_>) -> Result<u64, ProgramFault> {
        Ok(0)
    }
}

struct Native(Instance<McMoveAbsolute>);

impl Programs<Standard, IdealDrive> for Native {
    fn run(&mut self, _: ProgramId, context: &mut Context<'_>) -> Result<u64, ProgramFault> {
        context.scope.instance = InstanceId(1);
        self.0.inputs.execute = true;
        self.0.call(context);
        Ok(0)
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut native = Instance::<McMoveAbsolute>::default();
    native.inputs.axis = AxisId::new(0);
    (native.inputs.position, native.inputs.velocity) = (1e6, 50.0);
    let mut nothing = Bench::new(Nothing)?;
    let mut native = Bench::new(Native(native))?;
    let mut empty = Bench::new(Hosted::new(EMPTY.as_bytes())?)?;
    let mut hosted = Bench::new(Hosted::new(GUEST.as_bytes())?)?;
    for _ in 0..ROUNDS {
        nothing.round(SCANS)?;
        native.round(SCANS)?;
        empty.round(SCANS)?;
        hosted.round(SCANS)?;
    }
    let machines = [&native.machine, &hosted.machine];
    assert!(
        machines
            .iter()
            .all(|machine| machine.axes()[0].setpoint().velocity > 0.0)
    );
    for (what, time) in [
        ("no program's scan", nothing.best),
        ("a native program's scan", native.best),
        ("an empty guest's scan", empty.best),
        ("a guest's scan", hosted.best),
    ] {
        println!("{what:<24}{:>8.1} ns", time * 1e9);
    }
    println!("fuel of the guest       {:>8}", hosted.program.0.fuel_used());
    let ratio = hosted.best / native.best;
    println!(
        "ratio                   {ratio:>8.2} (bar 4){}",
        if ratio > 4.0 { "  ABOVE" } else { "" }
    );
    Ok(())
}

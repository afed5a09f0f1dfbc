//! The smallest host: one axis, two blocks of the runtime, scanned until the move is done.

use standstill::prelude::*;

struct Turn {
    power: BlockId,
    go: BlockId,
}

impl Program for Turn {
    fn run(
        &mut self,
        _: ProgramId,
        blocks: &mut Blocks,
        context: &mut Context<'_>,
    ) -> Result<u64, ProgramFault> {
        blocks.call(self.power, context);
        let powered = blocks.is(self.power, "Status");
        // A misspelt pin is a fault of the program, not a move that never happens.
        let set = blocks.set(self.go, "Execute", Value::Bool(powered));
        set.map_err(|_| ProgramFault {
            reason: "MC_MoveAbsolute has no Execute",
        })?;
        blocks.call(self.go, context);
        Ok(0)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let limits = Limits {
        velocity: 50.0,
        acceleration: 200.0,
        deceleration: 200.0,
        jerk: 2e3,
        snap: 4e4,
    };
    let mut builder = Builder::new(1_000_000);
    let drive = IdealDrive::new(DrivePosition::Units(0.0), 0, Some(0), false);
    let x = builder.axis("X", "mm", AxisConfig::new(limits), drive)?;
    let (power, go) = (
        builder.block("power", "MC_Power")?,
        builder.block("go", "MC_MoveAbsolute")?,
    );
    let mut runtime = builder.ready()?.start(Turn { power, go });
    for block in [power, go] {
        runtime.blocks_mut().set(block, "Axis", Value::Axis(x))?;
    }
    runtime.blocks_mut().set(power, "Enable", Value::Bool(true))?;
    runtime.blocks_mut().set(go, "Position", Value::Lreal(10.0))?;
    runtime.blocks_mut().set(go, "Velocity", Value::Lreal(50.0))?;
    // A soft-PLC calls this from its cyclic task, with the time of its clock.
    for now_ns in (0..2_000_000_000).step_by(1_000_000) {
        let report = runtime.scan(now_ns)?;
        if runtime.blocks().is(go, "Done") {
            println!(
                "at {} mm in scan {}",
                runtime.machine().axes()[0].setpoint().position,
                report.scan
            );
            return Ok(());
        }
    }
    Err("the move was not done in 2 s".into())
}

#[test]
fn it_comes_to_its_target() {
    main().unwrap();
}

//! A host that records in production: the last scans are kept, and frozen when an axis goes into ErrorStop.
//!
//! The dump is a normal trace: `standstill report recording.jsonl -o recording.html` shows it,
//! `standstill explain` compares it with another one.

use standstill::prelude::*;

/// A machine that moves to and fro, and whose drive fails in scan 700.
struct Line {
    power: BlockId,
    go: BlockId,
}

impl Program for Line {
    fn latch(&mut self, time: ScanTime, machine: &mut Machine) {
        if time.scan == 700 {
            machine.drives_mut()[0].fail(42);
        }
    }

    fn run(
        &mut self,
        _: ProgramId,
        blocks: &mut Blocks,
        context: &mut Context<'_>,
    ) -> Result<u64, ProgramFault> {
        blocks.call(self.power, context);
        blocks.call(self.go, context);
        // The next move begins where this one ends.
        if blocks.is(self.go, "Done")
            && let Some(Value::Lreal(target)) = blocks.value(self.go, "Position")
        {
            let misspelt = |_| ProgramFault {
                reason: "no such pin",
            };
            blocks
                .set(self.go, "Execute", Value::Bool(false))
                .map_err(misspelt)?;
            blocks.call(self.go, context);
            blocks
                .set(self.go, "Position", Value::Lreal(10.0 - target))
                .map_err(misspelt)?;
            blocks
                .set(self.go, "Execute", Value::Bool(true))
                .map_err(misspelt)?;
        }
        Ok(0)
    }
}

fn recorded() -> Result<Running<Line>, Box<dyn std::error::Error>> {
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
    builder.record(Setup {
        scans: 300,
        after: 50,
        ..Setup::default()
    });
    let mut runtime = builder.ready()?.start(Line { power, go });
    for (block, pin, value) in [
        (power, "Axis", Value::Axis(x)),
        (power, "Enable", Value::Bool(true)),
        (go, "Axis", Value::Axis(x)),
        (go, "Position", Value::Lreal(10.0)),
        (go, "Velocity", Value::Lreal(50.0)),
    ] {
        runtime.blocks_mut().set(block, pin, value)?;
    }
    for scan in 0..2000 {
        runtime.blocks_mut().set(go, "Execute", Value::Bool(scan > 5))?;
        runtime.scan(scan * 1_000_000)?;
    }
    Ok(runtime)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let runtime = recorded()?;
    let recorder = runtime.recorder().ok_or("it records")?;
    let trace = recorder.trace("The line before its fault", 1_000_000)?;
    standstill_trace::file::save(&trace, "recording.jsonl".as_ref())?;
    println!(
        "{} scans in recording.jsonl: {}",
        trace.scans(),
        trace.notes()[0].text
    );
    Ok(())
}

/// The recording is equal to the run, bit for bit. It has the scans before the fault and those after it.
#[test]
fn the_recording_shows_what_led_to_the_fault() {
    use standstill_trace::{Cell, events_text};

    let runtime = recorded().unwrap();
    let recorder = runtime.recorder().unwrap();
    assert_eq!(recorder.state(), standstill::record::State::Frozen);
    // 50 scans after the one of the fault, 249 before it.
    assert_eq!(recorder.scans(), (451, 300));
    let trace = recorder.trace("The line before its fault", 1_000_000).unwrap();
    assert_eq!(
        trace.notes()[0].text,
        "scans 451 to 750 of the machine; tripped by ErrorStop of X in scan 700, here 249"
    );
    let state = trace.column("X.State").unwrap();
    assert_eq!(trace.cell(248, state), Some(Cell::Name("DiscreteMotion")));
    assert_eq!(trace.cell(249, state), Some(Cell::Name("ErrorStop")));
    let events = events_text(&trace);
    assert!(
        events.contains("fault 511") || events.contains(", code 42"),
        "{events}"
    );
    assert!(events.contains("+Error"), "{events}");
}

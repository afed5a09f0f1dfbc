//! A host with its own drive and its own block beside the standard ones, all in its own structs.
//!
//! The drive represents a drive on a fieldbus: in every scan it takes a position in increments and reports
//! the position of the shaft. The program moves to and fro. A block that is no motion block counts the turns.

use standstill::axis::{Comms, DriveSignals, Scaling};
use standstill::prelude::*;

/// The bus data of a servo. Here it is a shaft that follows one scan later.
#[derive(Debug, Default)]
struct Servo {
    shaft: i64,
    enabled: bool,
}

impl Drive for Servo {
    fn read(&mut self, _now_ns: i64) -> DriveFeedback {
        DriveFeedback {
            enabled: self.enabled,
            voltage: true,
            fault: None,
            position: DrivePosition::Increments(self.shaft),
            comms: Comms::Ok,
            signals: DriveSignals::default(),
        }
    }

    fn write(&mut self, _now_ns: i64, command: &DriveCommand) {
        // Only an enabled drive follows its command.
        if let (true, DrivePosition::Increments(position)) = (self.enabled, command.position) {
            self.shaft = position;
        }
        self.enabled = command.request == DriveRequest::Enable;
    }
}

/// A block of the host's own: counts rising edges.
#[derive(Debug, Default)]
struct Counter {
    last: bool,
    count: u32,
}

impl Counter {
    fn call(&mut self, signal: bool) {
        self.count += u32::from(signal && !self.last);
        self.last = signal;
    }
}

/// The program. Its blocks are fields, so their pins are fields, too.
#[derive(Debug)]
struct ToAndFro {
    numbers: [InstanceId; 3],
    power: Instance<McPower>,
    there: Instance<McMoveAbsolute>,
    back: Instance<McMoveAbsolute>,
    turns: Counter,
}

impl Program<Servo> for ToAndFro {
    fn run(&mut self, _: ProgramId, _: &mut Blocks, context: &mut Context<'_>) -> Result<u64, ProgramFault> {
        let [power, there, back] = self.numbers;
        context.scope.instance = power;
        self.power.call(context);
        // The first move stays done until the second one is done. This keeps the second one running.
        self.there.inputs.execute = self.power.outputs.status && !self.back.outputs.done;
        context.scope.instance = there;
        self.there.call(context);
        self.back.inputs.execute = self.there.outputs.done;
        context.scope.instance = back;
        self.back.call(context);
        self.turns.call(self.back.outputs.done);
        Ok(0)
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let limits = Limits {
        velocity: 20.0,
        acceleration: 300.0,
        deceleration: 300.0,
        jerk: 1e4,
        snap: 1e6,
    };
    // 4096 increments are one turn of the motor, 360 degrees, behind a gear of 10.
    let scaling = Scaling::new(40_960, 360, false, 0.0)?;
    let config = AxisConfig {
        scaling: Some(scaling),
        ..AxisConfig::new(limits)
    };
    let mut builder = Builder::new(1_000_000);
    let x = builder.axis("X", "deg", config, Servo::default())?;
    let numbers = [
        builder.own_block::<McPower>("power")?,
        builder.own_block::<McMoveAbsolute>("there")?,
        builder.own_block::<McMoveAbsolute>("back")?,
    ];
    let mut program = ToAndFro {
        numbers,
        power: Instance::default(),
        there: Instance::default(),
        back: Instance::default(),
        turns: Counter::default(),
    };
    (program.power.inputs.axis, program.power.inputs.enable) = (x, true);
    for (block, position) in [(&mut program.there, 5.0), (&mut program.back, 0.0)] {
        (block.inputs.axis, block.inputs.position, block.inputs.velocity) = (x, position, 20.0);
    }
    let mut runtime = builder.ready()?.start(program);
    // A real host serves its bus here: it reads the inputs, computes the scan, and sends the outputs.
    for now_ns in (0..10_000_000_000).step_by(1_000_000) {
        runtime.scan(now_ns)?;
        if runtime.program().turns.count == 3 {
            let shaft = runtime.machine().drives()[0].shaft;
            println!(
                "to and fro three times in {} ms, the shaft at {shaft} increments",
                now_ns / 1_000_000
            );
            return Ok(());
        }
    }
    Err("no three turns in 10 s".into())
}

#[test]
fn it_goes_to_and_fro() {
    main().unwrap();
}

//! A host in Rust for feed and place: the program of `prog.st` with its blocks in its own struct, the
//! cell, and the buttons.

use standstill::blocks::administrative::mc_read_status::McReadStatus;
use standstill::blocks::standard::{r_trig::RTrig, ton::Ton};
use standstill::fb::Time;
use standstill::prelude::*;

/// Scans of the run.
pub const SCANS: i64 = 5700;
const CYCLE_NS: u64 = 1_000_000;

/// The changes of the buttons: scan, Start or Stop, and the new state.
const PRESSES: [(i64, Button, bool); 16] = [
    (20, Button::Start, true),
    (40, Button::Start, false),
    (1400, Button::Start, true),
    (1440, Button::Start, false),
    (1900, Button::Stop, true),
    (2000, Button::Stop, false),
    (2600, Button::Start, true),
    (2610, Button::Start, false),
    (2700, Button::Stop, true),
    (2710, Button::Stop, false),
    (3300, Button::Start, true),
    (3680, Button::Stop, true),
    (3700, Button::Stop, false),
    (3800, Button::Start, false),
    (4200, Button::Start, true),
    (4210, Button::Start, false),
];

#[derive(Clone, Copy, Debug)]
enum Button {
    Start,
    Stop,
}

/// The lamps and values of a panel.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lamps {
    /// Number of the state.
    pub state: i16,
    /// Parts that were placed.
    pub parts: i16,
    /// Cycles that were stopped.
    pub aborts: i16,
    /// Busy, Done and CommandAborted of the move that feeds.
    pub feed: [bool; 3],
    /// The same of the move that places.
    pub place: [bool; 3],
}

/// An axis after a scan.
#[derive(Clone, Copy, Debug)]
pub struct Shown {
    /// Its state after the program has run.
    pub state: AxisState,
    /// Its set-point.
    pub setpoint: Setpoint,
    /// The position of its drive at the start of the scan (u).
    pub actual_position: f64,
}

/// The PROGRAM: fields are its variables.
#[derive(Debug, Default)]
struct FeedAndPlace {
    start: bool,
    stop: bool,
    lamps: Lamps,
    start_edge: Instance<RTrig>,
    power_feeder: Instance<McPower>,
    power_placer: Instance<McPower>,
    settle: Instance<Ton>,
    feed: Instance<McMoveAbsolute>,
    place: Instance<McMoveAbsolute>,
    back_feeder: Instance<McMoveAbsolute>,
    back_placer: Instance<McMoveAbsolute>,
    stop_feeder: Instance<McStop>,
    stop_placer: Instance<McStop>,
    feeder_status: Instance<McReadStatus>,
    placer_status: Instance<McReadStatus>,
    /// The states of the axes after the program has run.
    states: [Option<AxisState>; 2],
}

impl FeedAndPlace {
    /// Pins that never change are set once.
    fn new(feeder: AxisId, placer: AxisId) -> Self {
        let mut new = Self::default();
        new.power_feeder.inputs.axis = feeder;
        new.power_placer.inputs.axis = placer;
        new.stop_feeder.inputs.axis = feeder;
        new.stop_placer.inputs.axis = placer;
        new.feeder_status.inputs.axis = feeder;
        new.placer_status.inputs.axis = placer;
        new.power_feeder.inputs.enable = true;
        new.power_placer.inputs.enable = true;
        new.feeder_status.inputs.enable = true;
        new.placer_status.inputs.enable = true;
        new.settle.inputs.pt = Time(50_000_000);
        for (block, axis, position, velocity) in [
            (&mut new.feed, feeder, 40.0, 200.0),
            (&mut new.place, placer, 25.0, 100.0),
            (&mut new.back_feeder, feeder, 0.0, 200.0),
            (&mut new.back_placer, placer, 0.0, 100.0),
        ] {
            block.inputs.axis = axis;
            block.inputs.position = position;
            block.inputs.velocity = velocity;
        }
        new
    }

    /// The state after this scan's CASE.
    fn next(&mut self) -> i16 {
        let lamps = &mut self.lamps;
        match lamps.state {
            0 if self.start_edge.outputs.q
                && !self.stop
                && self.power_feeder.outputs.status
                && self.power_placer.outputs.status =>
            {
                10
            }
            10 if self.feed.outputs.command_aborted => 90,
            10 if self.feed.outputs.done => 20,
            20 if self.stop => 90,
            20 if self.settle.outputs.q => 30,
            30 if self.place.outputs.command_aborted => 90,
            30 if self.place.outputs.done => {
                lamps.parts += 1;
                40
            }
            40 if self.back_feeder.outputs.command_aborted || self.back_placer.outputs.command_aborted => 90,
            40 if self.back_feeder.outputs.done && self.back_placer.outputs.done => 0,
            90 if !self.stop
                && self.feeder_status.outputs.standstill
                && self.placer_status.outputs.standstill =>
            {
                lamps.aborts += 1;
                40
            }
            same => same,
        }
    }
}

impl Program for FeedAndPlace {
    fn run(&mut self, _: ProgramId, _: &mut Blocks, context: &mut Context<'_>) -> Result<u64, ProgramFault> {
        self.start_edge.inputs.clk = self.start;
        self.start_edge.call(context);
        self.power_feeder.call(context);
        self.power_placer.call(context);

        let state = self.next();
        self.lamps.state = state;

        self.settle.inputs.input = state == 20;
        self.feed.inputs.execute = state == 10;
        self.place.inputs.execute = state == 30;
        self.back_feeder.inputs.execute = state == 40;
        self.back_placer.inputs.execute = state == 40;
        self.stop_feeder.inputs.execute = self.stop;
        self.stop_placer.inputs.execute = self.stop;
        self.settle.call(context);
        for block in [
            &mut self.feed,
            &mut self.place,
            &mut self.back_feeder,
            &mut self.back_placer,
        ] {
            block.call(context);
        }
        self.stop_feeder.call(context);
        self.stop_placer.call(context);
        self.feeder_status.call(context);
        self.placer_status.call(context);

        let outputs = |block: &Instance<McMoveAbsolute>| {
            let outputs = &block.outputs;
            [outputs.busy, outputs.done, outputs.command_aborted]
        };
        self.lamps.feed = outputs(&self.feed);
        self.lamps.place = outputs(&self.place);
        for (state, axis) in self.states.iter_mut().zip(context.axes.iter()) {
            *state = Some(axis.state());
        }
        Ok(0)
    }
}

/// Runs the cell and shows every scan: both axes, and the lamps.
///
/// # Errors
/// The reason for which a runtime cannot be built or a scan cannot run.
pub fn run(mut show: impl FnMut(&[Shown], &Lamps)) -> Result<(), Box<dyn std::error::Error>> {
    let mut builder = Builder::new(CYCLE_NS);
    let mut axis = |name, velocity, acceleration, jerk, snap| {
        let limits = Limits {
            velocity,
            acceleration,
            deceleration: acceleration,
            jerk,
            snap,
        };
        let drive = IdealDrive::new(DrivePosition::Units(0.0), 0, Some(0), false);
        builder.axis(name, "mm", AxisConfig::new(limits), drive)
    };
    let feeder = axis("Feeder", 200.0, 2000.0, 50_000.0, 2_000_000.0)?;
    let placer = axis("Placer", 100.0, 1000.0, 20_000.0, 1_000_000.0)?;
    let mut runtime = builder.ready()?.start(FeedAndPlace::new(feeder, placer));
    for scan in 0..SCANS {
        for (_, button, pressed) in PRESSES.iter().filter(|(at, ..)| *at == scan) {
            let program = runtime.program_mut();
            match button {
                Button::Start => program.start = *pressed,
                Button::Stop => program.stop = *pressed,
            }
        }
        runtime.scan(scan * CYCLE_NS.cast_signed())?;
        let program = runtime.program();
        let axes = runtime.machine().axes().iter().zip(program.states);
        let shown: Vec<_> = axes
            .filter_map(|(axis, state)| {
                Some(Shown {
                    state: state?,
                    setpoint: axis.setpoint(),
                    actual_position: axis.actual_position(),
                })
            })
            .collect();
        show(&shown, &program.lamps);
    }
    Ok(())
}

#[allow(dead_code)]
fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut before = Lamps::default();
    let mut scan = 0;
    run(|axes, lamps| {
        if lamps.state != before.state {
            let [x, y] = [0, 1].map(|axis| axes.get(axis).map_or(f64::NAN, |axis| axis.setpoint.position));
            println!(
                "scan {scan:4}: state {:2}, feeder {x:6.3} mm, placer {y:6.3} mm, {} parts, {} aborts",
                lamps.state, lamps.parts, lamps.aborts
            );
        }
        before = *lamps;
        scan += 1;
    })
}

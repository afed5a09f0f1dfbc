//! Nothing accumulates: many moves there and back, and a long time at rest.
//!
//! An hour of standstill at 1 ms with `STANDSTILL_SOAK=3600000`; a minute in a plain run.

use standstill_axis::{
    AxisConfig, AxisId, AxisState, DrivePosition, IdealDrive, InstanceId, Scaling, Standard, StartState,
};
use standstill_bench::{CYCLE, LIMITS};
use standstill_blocks::single_axis::mc_move_absolute::McMoveAbsolute;
use standstill_fb::{Context, Instance};
use standstill_scan::{Executor, Machine, ProgramConfig, ProgramFault, ProgramId, Programs};

/// One MC_MoveAbsolute for each axis.
struct Program(Vec<Instance<McMoveAbsolute>>);

impl Programs<Standard, IdealDrive> for Program {
    fn run(&mut self, _: ProgramId, context: &mut Context<'_>) -> Result<u64, ProgramFault> {
        for (number, block) in self.0.iter_mut().enumerate() {
            context.scope.instance = InstanceId(number as u16);
            block.call(context);
        }
        Ok(0)
    }
}

struct Rig {
    executor: Executor,
    machine: Machine,
    program: Program,
    now_ns: i64,
}

impl Rig {
    /// Powered axes with these scalings, at rest at 0.
    fn new(scalings: &[Option<Scaling>]) -> Self {
        let mut machine = Machine::new();
        let mut blocks = Vec::new();
        for scaling in scalings {
            let config = AxisConfig {
                start: StartState::Standstill,
                scaling: *scaling,
                ..AxisConfig::new(LIMITS)
            };
            let zero = scaling.map_or(DrivePosition::Units(0.0), |_| DrivePosition::Increments(0));
            let drive = IdealDrive::new(zero, 3, Some(0), true);
            let axis = machine
                .add_axis(config, Standard::new(CYCLE), drive)
                .expect("valid");
            let mut block = Instance::<McMoveAbsolute>::default();
            block.inputs.axis = axis;
            block.inputs.velocity = LIMITS.velocity;
            blocks.push(block);
        }
        Self {
            executor: Executor::new(1_000_000, &[], &[ProgramConfig::free("main")]).expect("valid"),
            machine,
            program: Program(blocks),
            now_ns: 0,
        }
    }

    fn scan(&mut self) {
        let report = self
            .executor
            .scan(self.now_ns, &mut self.program, &mut self.machine);
        assert!(report.is_ok());
        self.now_ns += 1_000_000;
    }

    /// Moves the axis to `target` and waits for Done.
    fn go(&mut self, axis: usize, target: f64) {
        self.program.0[axis].inputs.position = target;
        self.program.0[axis].inputs.execute = true;
        for _ in 0..100_000 {
            self.scan();
            if self.program.0[axis].outputs.done {
                self.program.0[axis].inputs.execute = false;
                self.scan();
                return;
            }
        }
        panic!("no Done: {:?}", self.program.0[axis].outputs);
    }

    fn position(&self, axis: u16) -> f64 {
        self.machine.axes()[AxisId::new(axis).index()].setpoint().position
    }
}

/// 1,000 moves 0 <-> 10.1 by MC_MoveAbsolute, a twentieth of them in a plain test run: each ends at its target to
/// the bit.
#[test]
fn a_thousand_moves_there_and_back_end_on_zero() {
    let mut rig = Rig::new(&[None]);
    for _ in 0..standstill_testkit::cases(500) {
        rig.go(0, 10.1);
        assert_eq!(rig.position(0).to_bits(), 10.1_f64.to_bits());
        rig.go(0, 0.0);
        assert_eq!(rig.position(0).to_bits(), 0.0_f64.to_bits());
    }
}

/// After a move that ends between two increments an axis does not move: not a bit of any value changes.
#[test]
fn nothing_creeps_at_standstill() {
    let scans = standstill_testkit::soak(60_000);
    let ratio = Scaling::new(4096, 7, false, 0.25).expect("valid");
    let mut rig = Rig::new(&[None, Some(ratio)]);
    rig.go(0, 1.0 / 3.0);
    rig.go(1, 1.0 / 3.0);
    // The feedback is some scans late.
    (0..10).for_each(|_| rig.scan());
    let state = |rig: &Rig| {
        let mut bits = Vec::new();
        for (axis, drive) in rig.machine.axes().iter().zip(rig.machine.feedback()) {
            let setpoint = axis.setpoint();
            assert_eq!(axis.state(), AxisState::Standstill);
            assert!(setpoint.is_at_rest());
            bits.push((
                setpoint.position.to_bits(),
                axis.actual_position().to_bits(),
                drive.position,
            ));
        }
        bits
    };
    let before = state(&rig);
    for scan in 0..scans {
        rig.scan();
        // Compared in full every few scans, and at the first and the last scan.
        if scan % 1000 == 0 || scan + 1 == scans {
            assert_eq!(state(&rig), before, "scan {scan}");
        }
    }
    println!("{scans} scans at standstill");
}

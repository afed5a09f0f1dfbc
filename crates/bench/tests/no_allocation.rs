//! A scan never uses the heap: commands, buffers, aborts, faults, resets, bad numbers.

mod counting;

use counting::allocations;
use standstill::prelude::{BlockId, Blocks, Builder, Setup};
use standstill_axis::{
    AxisConfig, AxisId, AxisState, BufferMode, CamCurve, DrivePosition, Following, IdealDrive, InstanceId,
    Scaling, Standard, StartMode, StartState,
};
use standstill_bench::{CYCLE, IN_MOTION, LIMITS, ManyAxes, Random};
use standstill_blocks::multi_axis::mc_cam_table_select::CamPoint;
use standstill_blocks::{BlockInstance, REGISTRY};
use standstill_fb::{AnyInstance, Context, Direction, PinType, Value};
use standstill_scan::{
    Executor, Machine, ProgramConfig, ProgramFault, ProgramId, Programs, ScanTime, TaskConfig,
};

const AXES: u16 = 4;
const SCANS: i64 = 5000;

/// Every block of the registry on every axis, with inputs that change at random.
struct Monkey {
    random: Random,
    /// Blocks of each axis, in call order.
    blocks: Vec<Vec<BlockInstance>>,
    /// States seen, by their index in [`AxisState::ALL`].
    seen: [bool; AxisState::ALL.len()],
}

impl Monkey {
    fn new() -> Self {
        let of_axis = |axis| {
            let wired = |info: &standstill_fb::BlockInfo| {
                let mut block = BlockInstance::new(info.name).expect("registered");
                for (pin, info) in block.info().pins().enumerate() {
                    if let PinType::Axis(_) = info.ty {
                        block
                            .set(pin, Value::Axis(AxisId::new(axis)))
                            .expect("an axis pin");
                    }
                }
                block
            };
            REGISTRY.iter().map(wired).collect()
        };
        Self {
            random: Random(4),
            blocks: (0..AXES).map(of_axis).collect(),
            seen: [false; AxisState::ALL.len()],
        }
    }

    /// A value that suits the pin nearly always.
    fn value(random: &mut Random, name: &str, ty: PinType) -> Option<Value> {
        Some(match ty {
            // Power stays on most of the time, and both directions are permitted.
            PinType::Bool if name.starts_with("Enable") => Value::Bool(!random.bits().is_multiple_of(8)),
            PinType::Bool => Value::Bool(random.bits().is_multiple_of(2)),
            PinType::Lreal => Value::Lreal(match random.bits() % 16 {
                0 => f64::NAN,
                1 => -1.0,
                2..6 => 0.0,
                _ => random.log(1e-2, 10.0),
            }),
            PinType::Int => Value::Int(3),
            PinType::Time => Value::Time(10_000_000),
            PinType::Enum(_) => Value::Enum((random.bits() % 8) as i32 - 1),
            PinType::Dword => Value::Dword(random.bits() as u32),
            PinType::Uint => Value::Word((random.bits() % 4) as u16),
            PinType::Word | PinType::Axis(_) | PinType::Table(_) => return None,
        })
    }
}

impl Programs<Standard, IdealDrive> for Monkey {
    /// The world: drives fail and recover.
    fn latch(&mut self, _: ScanTime, machine: &mut Machine) {
        for drive in machine.drives_mut() {
            match self.random.bits() % 1000 {
                0 => drive.fail(77),
                1 => drive.cut_power(),
                2 => drive.cut_communication(),
                3..30 => drive.clear_cause(),
                _ => {}
            }
        }
    }

    fn run(&mut self, program: ProgramId, context: &mut Context<'_>) -> Result<u64, ProgramFault> {
        let random = &mut self.random;
        let blocks = self.blocks.get_mut(program.0).into_iter().flatten();
        for (number, block) in blocks.enumerate() {
            if random.bits().is_multiple_of(40) {
                let info = block.info();
                let inputs = info.pins().filter(|pin| pin.direction == Direction::Input);
                for pin in inputs {
                    if let (Some((index, _)), Some(value)) =
                        (info.pin(pin.name), Self::value(random, pin.name, pin.ty))
                    {
                        block.set(index, value).expect("an input of this type");
                    }
                }
            }
            context.scope.instance = InstanceId(number as u16);
            block.call(context);
        }
        Ok(0)
    }

    fn observe(&mut self, _: ScanTime, machine: &Machine) {
        for (state, seen) in AxisState::ALL.iter().zip(&mut self.seen) {
            *seen |= machine.axes().iter().any(|axis| axis.state() == *state);
        }
    }
}

fn machine() -> Machine {
    let mut machine = Machine::new();
    for axis in 0..AXES {
        let config = AxisConfig {
            start: StartState::Standstill,
            scaling: (axis == 1).then(|| Scaling::new(1000, 1, false, 0.0).expect("valid")),
            software_limits: (axis == 2).then_some((-20.0, 20.0)),
            ..AxisConfig::new(LIMITS)
        };
        let home = if axis == 1 {
            DrivePosition::Increments(0)
        } else {
            DrivePosition::Units(0.0)
        };
        let drive = IdealDrive::new(home, usize::from(axis), Some(2), true);
        machine
            .add_axis(config, Standard::new(CYCLE), drive)
            .expect("valid");
    }
    machine
}

#[test]
fn no_scan_uses_the_heap() {
    let mut machine = machine();
    let programs = [
        ProgramConfig::with("a", "fast"),
        ProgramConfig::with("b", "fast"),
        ProgramConfig::with("c", "slow"),
        ProgramConfig::free("d"),
    ];
    let tasks = [
        TaskConfig::every("fast", 1_000_000),
        TaskConfig::every("slow", 2_000_000),
    ];
    let mut executor = Executor::new(1_000_000, &tasks, &programs).expect("valid");
    let mut monkey = Monkey::new();
    for scan in 0..SCANS {
        let before = allocations();
        let report = executor.scan(scan * 1_000_000, &mut monkey, &mut machine);
        assert_eq!(allocations() - before, 0, "scan {scan}");
        assert!(report.is_ok());
    }
    // The count covered what it is meant to.
    for (state, seen) in AxisState::ALL.iter().zip(monkey.seen) {
        let reachable = *state != AxisState::SynchronizedMotion;
        assert_eq!(seen, reachable, "{}", state.name());
    }
    assert!(machine.log().total() > 500, "{} records", machine.log().total());
}

#[test]
fn no_scan_of_64_axes_in_mixed_motion_uses_the_heap() {
    for _ in 0..SCANS / IN_MOTION as i64 + 1 {
        let mut axes = ManyAxes::in_motion(None).expect("valid");
        for scan in 0..IN_MOTION {
            let before = allocations();
            axes.scan();
            assert_eq!(allocations() - before, 0, "scan {scan}");
        }
    }
}

/// Covers: G84
#[test]
fn no_scan_of_64_axes_of_which_32_follow_others_uses_the_heap() {
    let mut axes = ManyAxes::chains_at_rest().expect("valid");
    // From rest through getting into gear (in `set_off`) to the end of the motions.
    let before = allocations();
    axes = axes.set_off();
    for _ in 0..SCANS {
        axes.scan();
    }
    assert_eq!(allocations() - before, 0);
    assert!(axes.in_gear() > 0, "none is in gear");
}

#[test]
fn the_count_sees_an_allocation() {
    let before = allocations();
    drop(std::hint::black_box(Vec::<u8>::with_capacity(1)));
    assert_eq!(allocations() - before, 1);
}

/// What a program does with cams, scan by scan.
struct CamShow {
    blocks: Vec<BlockId>,
}

impl standstill::runtime::Program for CamShow {
    fn run(
        &mut self,
        _: ProgramId,
        blocks: &mut Blocks,
        context: &mut Context<'_>,
    ) -> Result<u64, ProgramFault> {
        for block in &self.blocks {
            blocks.call(*block, context);
        }
        Ok(0)
    }
}

/// No call of a cam uses the heap, with a table of 512 rows too: selected, selected anew while it runs, engaged,
/// switched over, shifted, refused, stopped at corners, disengaged.
///
/// Covers: G79, G84
#[test]
fn no_call_and_no_scan_with_cams_uses_the_heap() {
    let row = |master: f64, slave: f64, law: CamCurve| CamPoint {
        master,
        slave,
        law: law.into(),
        ..CamPoint::default()
    };
    let lift = |height: f64, law: CamCurve| [row(0.0, 0.0, law), row(18.0, height, law), row(36.0, 0.0, law)];
    let long: Vec<_> = (0..512_u16)
        .map(|index| {
            row(
                f64::from(index),
                0.01 * f64::from(index % 511 % 7),
                CamCurve::Through,
            )
        })
        .collect();
    let bad = [row(0.0, 0.0, CamCurve::Line), row(0.0, 1.0, CamCurve::Line)];

    let mut builder = Builder::new(1_000_000);
    let mut axis = |name: &str, cam_continuity: Option<u8>| {
        let following = Following {
            cam_continuity,
            ..Following::DEFAULT
        };
        let config = AxisConfig {
            start: StartState::Standstill,
            following,
            ..AxisConfig::new(LIMITS)
        };
        let drive = IdealDrive::new(DrivePosition::Units(0.0), 0, Some(0), true);
        builder.axis(name, "mm", config, drive).expect("a good axis")
    };
    let (master, slave, rough) = (axis("M", None), axis("S", None), axis("Rough", Some(0)));
    let tables = [
        builder.table(&lift(2.0, CamCurve::Rest7)),
        builder.table(&lift(3.0, CamCurve::Rest7)),
        builder.table(&lift(2.0, CamCurve::Line)),
        builder.table(&long),
        builder.table(&bad),
    ];
    let [low, high, corners, long, bad] = tables.map(|table| Value::Table(table.expect("not too long")));
    let kinds = [
        ("select", "MC_CamTableSelect"),
        ("selectLong", "MC_CamTableSelect"),
        ("selectCorners", "MC_CamTableSelect"),
        ("selectBad", "MC_CamTableSelect"),
        ("cam", "MC_CamIn"),
        ("next", "MC_CamIn"),
        ("onCorners", "MC_CamIn"),
        ("shift", "MC_PhasingRelative"),
        ("out", "MC_CamOut"),
        ("run", "MC_MoveVelocity"),
    ];
    let ids = kinds.map(|(name, kind)| builder.block(name, kind).expect("registered"));
    let [
        select,
        select_long,
        select_corners,
        select_bad,
        cam,
        next,
        on_corners,
        shift,
        out,
        run,
    ] = ids;
    let program = CamShow { blocks: ids.to_vec() };
    let mut runtime = builder.ready().expect("it fits").start(program);
    runtime.machine_mut().set_usual_cam_store();
    let blocks = runtime.blocks_mut();
    for id in ids {
        let of = if [select_corners, on_corners].contains(&id) {
            rough
        } else {
            slave
        };
        for (pin, axis) in [("Master", master), ("Slave", of), ("Axis", master)] {
            // A block has some of these pins.
            let _none = blocks.set(id, pin, Value::Axis(axis));
        }
        let _none = blocks.set(id, "Periodic", Value::Bool(true));
    }
    let set_table = [
        (select, low),
        (select_long, long),
        (select_corners, corners),
        (select_bad, bad),
    ];
    for (id, table) in set_table {
        blocks.set(id, "CamTable", table).expect("a table");
    }
    let relative = Value::Enum(StartMode::Relative as i32);
    for (id, pin, value) in [
        (cam, "StartMode", relative),
        (next, "StartMode", relative),
        (on_corners, "StartMode", relative),
        (shift, "PhaseShift", Value::Lreal(2.0)),
        (shift, "Velocity", Value::Lreal(1.0)),
        (run, "Velocity", Value::Lreal(8.0)),
    ] {
        blocks.set(id, pin, value).expect("a pin");
    }

    let edge = |blocks: &mut Blocks, id: BlockId, level: bool| {
        blocks.set(id, "Execute", Value::Bool(level)).expect("a pin");
    };
    let wire = |blocks: &mut Blocks, from: BlockId, to: BlockId| {
        let number = blocks.value(from, "CamTableID").expect("an output");
        blocks.set(to, "CamTableID", number).expect("a pin");
    };
    let (mut in_sync, mut lags, mut most_busy) = (0, 0, 0);
    let before = allocations();
    for scan in 0..40_000_i64 {
        let blocks = runtime.blocks_mut();
        match scan {
            1 => [select, select_long, select_corners, select_bad]
                .into_iter()
                .for_each(|id| edge(blocks, id, true)),
            30 => {
                wire(blocks, select, cam);
                wire(blocks, select_corners, on_corners);
                [cam, on_corners, run]
                    .into_iter()
                    .for_each(|id| edge(blocks, id, true));
            }
            // Selected anew while it runs, with another table, and replaced at the end of the period.
            3000 => {
                edge(blocks, select, false);
                blocks.set(select, "CamTable", high).expect("a table");
            }
            3001 => edge(blocks, select, true),
            3100 => {
                wire(blocks, select, next);
                let buffered = Value::Enum(BufferMode::Buffered as i32);
                blocks.set(next, "BufferMode", buffered).expect("a pin");
                edge(blocks, next, true);
            }
            12_000 => edge(blocks, shift, true),
            18_000 => {
                // Replaced by the long one at once.
                wire(blocks, select_long, cam);
                edge(blocks, cam, false);
            }
            18_001 => edge(blocks, cam, true),
            25_000 => edge(blocks, out, true),
            27_000 => edge(blocks, cam, false),
            27_001 => edge(blocks, cam, true),
            _ => {}
        }
        runtime.scan(scan * 1_000_000).expect("time goes on");
        let blocks = runtime.blocks();
        most_busy += u32::from(blocks.is(select_long, "Busy"));
        in_sync += u32::from(blocks.is(cam, "InSync")) + u32::from(blocks.is(next, "InSync"));
        lags += u32::from(!blocks.is(on_corners, "InSync"));
    }
    assert_eq!(
        allocations() - before,
        0,
        "a call or a scan with cams used the heap"
    );
    // The count covered what it is meant to.
    let blocks = runtime.blocks();
    assert_eq!(most_busy, 16);
    assert!(blocks.is(select_bad, "Error"));
    assert!(blocks.is(next, "CommandAborted") && blocks.is(shift, "Done") && blocks.is(out, "Done"));
    assert!(
        in_sync > 20_000 && lags > 100,
        "{in_sync} in sync, {lags} lagging"
    );
}

/// A runtime that records: built with the heap, then scanned, tripped and armed again without it.
#[test]
fn a_runtime_with_a_recorder_scans_without_the_heap() {
    struct Program(BlockId);

    impl standstill::runtime::Program for Program {
        fn run(
            &mut self,
            _: ProgramId,
            blocks: &mut Blocks,
            context: &mut Context<'_>,
        ) -> Result<u64, ProgramFault> {
            blocks.call(self.0, context);
            Ok(0)
        }
    }

    let config = AxisConfig {
        start: StartState::Standstill,
        ..AxisConfig::new(LIMITS)
    };
    let mut builder = Builder::new(1_000_000);
    let drive = IdealDrive::new(DrivePosition::Units(0.0), 0, Some(0), true);
    let x = builder.axis("X", "mm", config, drive).expect("a good axis");
    let go = builder.block("go", "MC_MoveAbsolute").expect("a good block");
    builder.record(Setup {
        scans: 100,
        after: 20,
        ..Setup::default()
    });
    let mut runtime = builder.ready().expect("it fits").start(Program(go));
    runtime
        .blocks_mut()
        .set(go, "Axis", Value::Axis(x))
        .expect("a pin");
    runtime
        .blocks_mut()
        .set(go, "Velocity", Value::Lreal(1.0))
        .expect("a pin");
    let before = allocations();
    let (mut frozen, mut errors) = (0, 0);
    for scan in 0..SCANS {
        let blocks = runtime.blocks_mut();
        let _set = blocks.set(go, "Position", Value::Lreal(scan as f64));
        let _set = blocks.set(go, "Execute", Value::Bool(scan % 7 > 2));
        if scan % 500 == 300 {
            runtime.machine_mut().drives_mut()[0].fail(7);
        }
        runtime.scan(scan * 1_000_000).expect("time goes on");
        errors += u64::from(runtime.blocks().is(go, "Error"));
        let recorder = runtime.recorder_mut().expect("it records");
        if recorder.state() == standstill::record::State::Frozen {
            frozen += 1;
            recorder.arm();
        }
    }
    assert_eq!(allocations() - before, 0, "a scan used the heap");
    assert!(
        frozen > 0 && errors > 0,
        "{frozen} times frozen, {errors} scans with an error"
    );
}

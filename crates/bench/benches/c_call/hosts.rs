//! A block through the C library beside the same block in Rust.
//!
//! Both are what a host does in every scan: it fills in the inputs, calls, and looks at the outputs.

use standstill_axis::{
    Axis, AxisConfig, AxisId, Comms, ConfigError, DriveFeedback, DrivePosition, DriveSignals, InstanceId,
    Log, Standard, StartState,
};
use standstill_blocks::BlockInstance;
use standstill_capi as c;
use standstill_fb::Context;
use std::hint::black_box;
use std::mem::MaybeUninit;
use std::ptr::{from_mut, from_ref, null_mut};

use standstill_bench::{CYCLE, LIMITS, TARGET};

/// How a host in C sees the function of a block.
type Call = unsafe extern "C" fn(*mut c::Runtime, *mut u64, *const u8, *mut u8) -> i32;

/// What the program of a host knows.
#[derive(Clone, Copy, Debug)]
pub struct Wishes {
    /// Execute.
    pub execute: bool,
    /// Where to.
    pub position: f64,
    /// How fast.
    pub velocity: f64,
}

impl Wishes {
    /// The move of all measures.
    pub const MOVE: Self = Self {
        execute: true,
        position: TARGET,
        velocity: LIMITS.velocity,
    };
}

/// A host in Rust that has its instances in a list, as one that reads its program from somewhere does.
#[derive(Debug)]
pub struct RustHost {
    axes: [Axis; 1],
    log: Log,
    blocks: Vec<BlockInstance>,
    scan: u64,
}

impl RustHost {
    /// A powered axis in the first scan of the move.
    ///
    /// # Errors
    /// None with these constants.
    pub fn in_motion() -> Result<Self, ConfigError> {
        let config = AxisConfig {
            start: StartState::Standstill,
            ..AxisConfig::new(LIMITS)
        };
        let mut axis = Axis::new(AxisId::new(0), config, Standard::new(CYCLE))?;
        let mut log = Log::default();
        let feedback = DriveFeedback {
            enabled: true,
            voltage: true,
            fault: None,
            position: DrivePosition::Units(0.0),
            comms: Comms::Ok,
            signals: DriveSignals::default(),
        };
        axis.follow_feedback(&feedback, 0, &mut log);
        let mut host = Self {
            axes: [axis],
            log,
            blocks: BlockInstance::new("MC_MoveAbsolute").into_iter().collect(),
            scan: 0,
        };
        host.call(&Wishes::MOVE, 0);
        Ok(host)
    }

    /// One call: whether the move is in progress.
    #[inline(always)]
    pub fn call(&mut self, wishes: &Wishes, place: usize) -> Option<(bool, bool, bool)> {
        let Some(BlockInstance::McMoveAbsolute(instance)) = self.blocks.get_mut(place) else {
            return None;
        };
        let inputs = &mut instance.inputs;
        *inputs = Default::default();
        inputs.axis = AxisId::new(0);
        inputs.execute = wishes.execute;
        inputs.position = wishes.position;
        inputs.velocity = wishes.velocity;
        let mut context = Context {
            now_ns: 0,
            scan: self.scan,
            instance: InstanceId(1),
            axes: &mut self.axes,
            log: &mut self.log,
            tables: &[],
        };
        instance.call(&mut context);
        let outputs = &instance.outputs;
        Some((outputs.done, outputs.active, outputs.error))
    }
}

/// MC_MoveAbsolute as `standstill_blocks.h` lays it out.
#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
struct In {
    size: u32,
    axis: i32,
    execute: u8,
    continuous_update: u8,
    reserved: [u8; 6],
    position: f64,
    velocity: f64,
    acceleration: f64,
    deceleration: f64,
    jerk: f64,
    direction: i32,
    buffer_mode: i32,
    snap: f64,
}

#[derive(Clone, Copy, Debug, Default)]
#[repr(C)]
struct Out {
    size: u32,
    done: u8,
    busy: u8,
    active: u8,
    command_aborted: u8,
    error: u8,
    reserved: u8,
    error_id: u16,
    rest: u32,
}

/// A host of the C library, with a tick open.
#[derive(Debug)]
pub struct CHost {
    runtime: *mut c::Runtime,
    function: Call,
    key: u64,
    /// Kept from scan to scan, as the instance of the host in Rust keeps its own.
    out: Out,
    _storage: Vec<u128>,
}

impl CHost {
    /// As [`RustHost::in_motion`]; none if a function of the library says anything but OK.
    pub fn in_motion() -> Option<Self> {
        let config = c::RuntimeConfig {
            size: size_of::<c::RuntimeConfig>() as u32,
            axes: 1,
            instances: 16,
            reserved: 0,
            cycle_ns: 1_000_000,
        };
        let mut bytes = 0;
        // SAFETY: all pointers lead to what their types say, sizes are set, and the storage lives in the host.
        unsafe {
            if c::standstill_runtime_size(&config, &mut bytes) != 0 {
                return None;
            }
            let mut storage = vec![0_u128; bytes.div_ceil(16)];
            let mut runtime = null_mut();
            let at = storage.as_mut_ptr().cast();
            if c::standstill_runtime_init(c::ABI_VERSION, at, bytes, &config, &mut runtime) != 0 {
                return None;
            }
            let mut axis = MaybeUninit::<c::AxisSetup>::zeroed().assume_init();
            axis.size = size_of::<c::AxisSetup>() as u32;
            c::standstill_axis_defaults(&mut axis);
            axis.start_powered = 1;
            (axis.velocity, axis.acceleration) = (LIMITS.velocity, LIMITS.acceleration);
            (axis.jerk, axis.snap) = (LIMITS.jerk, LIMITS.snap);
            let mut drive = MaybeUninit::<c::DriveSetup>::zeroed().assume_init();
            drive.size = size_of::<c::DriveSetup>() as u32;
            c::standstill_drive_defaults(&mut drive);
            let mut number = 0;
            let good = c::standstill_axis_add(runtime, &axis, &drive, &mut number) == 0
                && c::standstill_tick_begin(runtime, 0) == 0;
            let mut host = Self {
                runtime,
                // Hidden from the compiler: in C no call of the library is put in line.
                function: black_box(c::mc_move_absolute),
                key: 0,
                out: Out {
                    size: size_of::<Out>() as u32,
                    ..Out::default()
                },
                _storage: storage,
            };
            good.then(|| {
                host.call(&Wishes::MOVE);
                host
            })
        }
    }

    /// One call, as a host in C makes it.
    #[inline(always)]
    pub fn call(&mut self, wishes: &Wishes) -> Option<(bool, bool, bool)> {
        let given = In {
            size: size_of::<In>() as u32,
            axis: 1,
            execute: wishes.execute.into(),
            position: wishes.position,
            velocity: wishes.velocity,
            ..In::default()
        };
        // SAFETY: all pointers lead to what their types say, and sizes are set.
        let code = unsafe {
            (self.function)(
                self.runtime,
                &mut self.key,
                from_ref(&given).cast(),
                from_mut(&mut self.out).cast(),
            )
        };
        let out = &self.out;
        (code == 0).then_some((out.done != 0, out.active != 0, out.error != 0))
    }
}

//! All calls of a scan in the four bottom crates, with values that the compiler does not know.
//!
//! `examples/image.rs` links it to a bare-metal image whose panic handler does not exist: the linker keeps
//! the handler only if a panic can be reached. `.ci/no-panic` does that and measures the image.
#![no_std]
#![forbid(unsafe_code)]

use core::hint::black_box;
use standstill_axis::{
    Axis, AxisConfig, AxisId, BufferMode, Command, Comms, Drive, DriveFeedback, DrivePosition, ErrorId,
    Fault, IdealDrive, InstanceId, Limits, Log, Permission, Planner, PowerOff, Raw, Request, Scaling, Scope,
    Setpoint, Standard, StartState, steps,
};
use standstill_blocks::{BlockInstance, REGISTRY};
use standstill_fb::{AnyInstance, Context, PinType, TableRef, Time, Value};
use standstill_planner::grid::Family;
use standstill_planner::{GridPlan, Method, MoveProfile, Plan, RampPlan, UnequalPlan};

/// Something of any value.
fn any<T>(value: T) -> T {
    black_box(value)
}

/// One axis, one instance of a block, and a drive.
#[derive(Debug)]
pub struct Image {
    axes: [Axis; 1],
    log: Log,
    block: BlockInstance,
    drive: IdealDrive,
    scan: u64,
}

impl Image {
    /// An axis of any configuration with a block of any kind; none if either is not valid.
    pub fn new() -> Option<Self> {
        let config = AxisConfig {
            position: any(0.0),
            start: any(StartState::Standstill),
            scaling: any(Scaling::new(any(1), any(1), any(false), any(0.0)).ok()),
            software_limits: any(None),
            queue: any(8),
            stop_deceleration: any(None),
            stop_jerk: any(None),
            on_power_off: any(PowerOff::Ramp),
            needs_homed: any(false),
            override_max: any(1.0),
            ..any(AxisConfig::new(any(Limits::NONE)))
        };
        let info = REGISTRY.get(any(0))?;
        Some(Self {
            axes: [Axis::new(AxisId::new(any(0)), config, Standard::new(any(0.001))).ok()?],
            log: Log::default(),
            block: BlockInstance::new(info.name)?,
            drive: IdealDrive::new(any(DrivePosition::Units(0.0)), any(1), any(Some(1)), any(true)),
            scan: any(0),
        })
    }

    /// One scan in a host, with all other calls that a host may make in it.
    pub fn scan(&mut self) {
        let Self {
            axes,
            log,
            block,
            drive,
            scan,
        } = any(self);
        let real = drive.read(any(0));
        let feedback = DriveFeedback {
            enabled: any(real.enabled),
            voltage: any(real.voltage),
            fault: any(Some(Fault {
                code: any(1),
                cause_present: any(true),
            })),
            position: any(real.position),
            comms: any(Comms::Lost),
            signals: any(real.signals),
        };
        for axis in axes.iter_mut() {
            axis.follow_feedback(&any(feedback), &mut Scope::new(*scan, log));
        }
        if let Some((index, pin)) = block.info().pins().enumerate().nth(any(0)) {
            let _refused = any(block.set(index, input(pin.ty)));
        }
        let mut context = Context {
            now_ns: any(0),
            scope: Scope {
                scan: *scan,
                instance: InstanceId(any(0)),
                log,
                cams: standstill_axis::Cams::default(),
                history: &mut [],
            },
            axes,
            tables: &any([0.0; 64]),
        };
        any(&mut *block).call(&mut context);
        any(block.get(any(0)));
        for axis in axes.iter_mut() {
            command(any(&mut *axis), log);
        }
        let mut past = any([Setpoint::default(); 8]);
        let mut scope = Scope::new(*scan, log);
        scope.history = any(&mut past);
        steps::advance(any(&mut *axes), &mut scope);
        for axis in axes.iter_mut() {
            drive.write(any(0), &axis.drive_command());
        }
        for record in log.since(any(0)) {
            any(record);
        }
        disturb(any(&mut *drive));
        *scan = scan.wrapping_add(1);
    }
}

/// A value for a pin of this type.
fn input(ty: PinType) -> Value {
    any(match ty {
        PinType::Bool => Value::Bool(any(true)),
        PinType::Int => Value::Int(any(1)),
        PinType::Lreal => Value::Lreal(any(1.0)),
        PinType::Uint | PinType::Word => Value::Word(any(1)),
        PinType::Time => Value::Time(any(Time(1)).0),
        PinType::Dword => Value::Dword(any(1)),
        PinType::Table(_) => Value::Table(TableRef {
            first: any(0),
            records: any(1),
        }),
        PinType::Axis(_) => Value::Axis(AxisId::new(any(0))),
        PinType::Enum(_) => Value::Enum(any(1)),
    })
}

/// The commands that a host, or a block of its own, may give an axis.
fn command(axis: &mut Axis, log: &mut Log) {
    let scope = &mut Scope {
        scan: any(0),
        instance: InstanceId(any(0)),
        log,
        cams: standstill_axis::Cams::default(),
        history: &mut [],
    };
    let request = Request {
        command: any(Command::Home { position: any(0.0) }),
        buffer_mode: any(Raw::<BufferMode>::new(any(0))),
        replaces: any(axis.active_command()),
    };
    let id = any(axis.command(&request, scope));
    if let Ok(id) = id {
        any(axis.fate(id));
        axis.release_stop(any(id));
    }
    axis.set_power(any(true), any(Permission::BOTH), scope);
    axis.raise(any(ErrorId::AxisFault), any(1), scope);
    axis.clear_cause();
    let _reset = any(axis.reset(scope));
    any(axis.outlook());
    any(axis.plan().map(|(plan, elapsed)| plan.at(elapsed)));
}

/// The disturbances of a simulation to its drives.
fn disturb(drive: &mut IdealDrive) {
    drive.fail(any(1));
    drive.cut_power();
    drive.cut_communication();
    drive.clear_cause();
    let _powered = any(drive.displace(any(1.0)));
}

/// The planner without an axis: every method, every view of a plan.
pub fn plan() {
    let (start, target, velocity, cycle) = (any(0.0), any(1.0), any(1.0), any(0.001));
    let limits = any(Limits::NONE);
    let from = any(Setpoint::at_rest(start));
    let method = any(Method::Overlapped);
    if let Ok((plan, work)) = any(GridPlan::new_counted(method, start, target, &limits, cycle)) {
        any((
            work,
            plan.at(any(1)),
            plan.euler(any(1)),
            plan.peaks(),
            plan.counts(),
        ));
        any((plan.boxes(), plan.product(), plan.amplitude()));
        for segment in any(plan.segments()) {
            any(segment);
        }
    }
    let family = any(Family::Overlapped);
    if let Ok((plan, work)) = any(UnequalPlan::new_counted(family, start, target, &limits, cycle)) {
        any((work, plan.at(any(1)), plan.peaks(), plan.amplitudes()));
        any((plan.up(), plan.down()));
        for segment in any(plan.segments()) {
            any(segment);
        }
    }
    if let Ok(plan) = any(RampPlan::new(&from, velocity, &limits, &any(limits), cycle)) {
        any((plan.at(any(1)), plan.peaks(), plan.excess(), plan.end_position()));
        for segment in plan.segments() {
            any(segment);
        }
    }
    let standard = Standard::new(cycle);
    if let Ok(plan) =
        any(standard.move_to(any(MoveProfile::Overlapped), &from, target, &limits, &any(limits)))
    {
        any((plan.scans(), plan.at(any(1)), plan.excess()));
    }
}

//! Random machines.

use super::program::{Block, Program, kind_of};
use crate::cases::extreme;
use crate::random::Random;
use serde_json::{Map, Value as Json};
use standstill_axis::{
    AboveLimit, AxisConfig, BlockDetection, Defaults, EdgeWhileBusy, Following, HomeDirection, Homing,
    InPosition, JogAtLimit, Limits, ModuloTargets, MoveProfile, OnLimit, OnMasterLost, PowerOff, Procedure,
    QUEUE_MAX, Scaling, ShaperKind, StartState, StopLimits, SwitchEdge, VibrationMode,
};
use standstill_blocks::REGISTRY;
use standstill_drives::cia402::Reaction;
use standstill_drives::mechanism::{Load, Mechanism, Plant, Stops};
use standstill_drives::simulated::{Cia402Setup, DriveSetup, IdealDriveSetup, MotorSetup, PlantSetup};
use standstill_drives::switches::{Marker, Switches};
use standstill_fb::{BlockInfo, Pin, PinType};
use standstill_script::write;

use crate::rules::Kind;

/// Names of axes; no machine has more.
const AXES: [&str; 3] = ["X", "Y", "Z"];

/// Sequences that occur more often than by chance: a curve, a command that waits for an edge and one that
/// ends it, limits that are written while moves blend.
const FAVOURED: [&[&str]; 22] = [
    &["MC_PositionProfile"],
    &["MC_VelocityProfile"],
    &["MC_AccelerationProfile"],
    &["MC_VelocityProfile", "MC_PositionProfile"],
    &["MC_TouchProbe", "MC_TouchProbe", "MC_AbortTrigger"],
    &["MC_DigitalCamSwitch"],
    &["MC_WriteParameter", "MC_MoveRelative", "MC_MoveRelative"],
    &["MC_WriteParameter", "MC_WriteBoolParameter", "MC_MoveAbsolute"],
    &["MC_GearIn", "MC_GearOut"],
    &["MC_GearIn", "MC_GearIn", "MC_MoveVelocity"],
    &["MC_GearIn", "MC_PhasingAbsolute", "MC_PhasingRelative"],
    &["MC_GearInPos", "MC_GearOut", "MC_MoveVelocity"],
    &["MC_GearInPos", "MC_GearIn"],
    &["MC_CombineAxes", "MC_GearOut", "MC_MoveVelocity"],
    &["MC_CombineAxes", "MC_PhasingAbsolute", "MC_GearIn"],
    &["MC_GearInPos", "MC_PhasingRelative", "MC_MoveAbsolute"],
    &["MC_CamTableSelect", "MC_CamIn", "MC_CamOut"],
    &["MC_CamTableSelect", "MC_CamIn", "MC_CamIn", "MC_MoveVelocity"],
    &["MC_CamTableSelect", "MC_CamIn", "MC_GearIn"],
    &["MC_GearIn", "MC_MoveSuperimposed", "MC_HaltSuperimposed"],
    &["MC_GearIn", "MC_MoveSuperimposed", "MC_MoveSuperimposed"],
    &["MC_GearInPos", "MC_MoveSuperimposed", "MC_PhasingAbsolute"],
];

/// Lengths of a scan (ns).
const CYCLES: [i64; 4] = [1_000_000, 250_000, 2_000_000, 10_000_000];

/// A machine and the blocks of a program, for `scans` scans.
pub fn program(random: &mut Random, scans: u64) -> Program {
    let cycle_ns = one_of(random, &CYCLES);
    let cycle = cycle_ns as f64 / 1e9;
    let axes = axes(random, cycle);
    let mut program = Program::new(cycle_ns, scans);
    let each = axes.iter().enumerate();
    let mut blocks: Vec<_> = each
        .flat_map(|(place, (config, _))| blocks(random, place, axes.len(), &config.limits, cycle))
        .collect();
    shuffle(random, &mut blocks);
    for (number, block) in (1..).zip(&mut blocks) {
        let (_, short) = block.block.split_once('_').unwrap_or(("", block.block));
        block.name = format!("{short}{number}");
    }
    program.blocks = blocks;
    let axes = AXES.iter().zip(&axes);
    program.axes = axes
        .map(|(name, (config, drive))| ((*name).to_owned(), write::axis(config, drive)))
        .collect();
    program
}

/// The axes of a machine and their drives.
fn axes(random: &mut Random, cycle: f64) -> Vec<(AxisConfig, DriveSetup)> {
    let count = 1 + random.below(AXES.len() as u64);
    (0..count).map(|_| axis(random, cycle)).collect()
}

fn shuffle<T>(random: &mut Random, list: &mut [T]) {
    for last in (1..list.len()).rev() {
        list.swap(last, random.below(last as u64 + 1) as usize);
    }
}

/// A list's entry at random.
pub fn one_of<T: Copy>(random: &mut Random, list: &[T]) -> T {
    list[random.below(list.len() as u64) as usize]
}

/// Limits of order 2, 3 or 4 whose parts all take a few scans.
fn limits(random: &mut Random, cycle: f64) -> Limits {
    let order = random.below(4);
    let velocity = random.log_between(0.5, 200.0);
    let times = [(); 3].map(|()| cycle * random.log_between(2.0, 30.0));
    let acceleration = velocity / times[0];
    let jerk = acceleration / times[1];
    Limits {
        velocity,
        acceleration,
        deceleration: if random.one_in(2) {
            acceleration
        } else {
            acceleration * random.between(0.3, 3.0)
        },
        jerk: if order >= 1 { jerk } else { f64::INFINITY },
        snap: if order >= 2 {
            jerk / times[2]
        } else {
            f64::INFINITY
        },
    }
}

/// An axis; every part of its configuration differs from the default in some axes. In every eighth some
/// rates are the usual values for "no limit"; its velocity stays, so that programs know how fast it is.
fn axis(random: &mut Random, cycle: f64) -> (AxisConfig, DriveSetup) {
    let typical = limits(random, cycle);
    let limits = if random.one_in(8) {
        Limits {
            velocity: typical.velocity,
            ..extreme(random, &typical, cycle)
        }
    } else {
        typical
    };
    let way = limits.velocity * cycle;
    let mut config = AxisConfig::new(limits);
    if !random.one_in(8) {
        config.start = StartState::Standstill;
    }
    match random.below(4) {
        0 => config.modulo = Some(way * random.log_between(5.0, 500.0)),
        1 => {
            let reach = way * random.log_between(30.0, 1000.0);
            config.software_limits = Some((-reach * random.between(0.1, 1.0), reach));
        }
        _ => {}
    }
    if random.one_in(3) {
        config.profile = one_of(random, &MoveProfile::ALL);
    }
    if random.one_in(4) {
        config.queue = random.below(QUEUE_MAX as u64 + 1) as usize;
    }
    if random.one_in(8) {
        config.above_limit = AboveLimit::Error;
    }
    if random.one_in(3) {
        config.on_power_off = one_of(random, &[PowerOff::Coast, PowerOff::Drive]);
    }
    if random.one_in(4) {
        config.stop_deceleration = Some(limits.deceleration * random.between(0.2, 1.0));
    }
    if random.one_in(4) && limits.jerk.is_finite() {
        config.stop_jerk = Some(limits.jerk * random.between(0.2, 1.0));
    }
    config.needs_homed = random.one_in(20);
    if random.one_in(4) {
        let mut part = |limit: f64| limit.is_finite().then(|| limit * random.between(0.2, 1.0));
        config.defaults = Defaults {
            acceleration: part(limits.acceleration),
            deceleration: part(limits.deceleration),
            jerk: part(limits.jerk),
            snap: part(limits.snap),
        };
    }
    if random.one_in(6) {
        let increments = one_of(random, &[1000, 65536, 1 << 20]);
        config.scaling = Scaling::new(increments, one_of(random, &[1, 7, 360]), random.one_in(2), 0.0).ok();
    }
    if random.one_in(4) {
        config.following = Following {
            on_limit: one_of(random, &[OnLimit::Lag, OnLimit::Error, OnLimit::SlowMaster]),
            max_deviation: random.one_in(2).then(|| way * random.log_between(1.0, 1000.0)),
            on_master_lost: one_of(random, &[OnMasterLost::Error, OnMasterLost::Hold]),
            actual_filter: one_of(random, &[0, 1, 4, 16, 64]),
            actual_lead: random.one_in(4),
            // Not a draw of its own, so that old seeds still give the same cases.
            cam_continuity: (limits.velocity.to_bits() & 1 == 0).then_some(0),
        };
    }
    // A value that the configuration refuses is removed.
    if config.check().is_err() {
        config.profile = MoveProfile::Overlapped;
    }
    if config.check().is_err() {
        config.following.actual_filter = Following::DEFAULT.actual_filter;
    }
    if config.check().is_err() {
        config.scaling = None;
    }
    let drive = drive(random, &config, cycle);
    supervise(random, &mut config, cycle);
    homing(random, &mut config, &drive, cycle);
    choices(random, &mut config);
    vibration(&mut config, cycle);
    (config, drive)
}

/// One or two modes on every sixteenth axis with one rate.
fn vibration(config: &mut AxisConfig, cycle: f64) {
    // Not a draw of its own, so that old seeds still give the same cases.
    let bits = config.limits.velocity.to_bits() >> 1;
    if bits & 15 != 0 {
        return;
    }
    let mut random = Random::new(bits, 0);
    let mut mode = || VibrationMode {
        frequency: 1.0 / (cycle * random.log_between(8.0, 200.0)),
        damping: if random.one_in(2) {
            0.0
        } else {
            random.between(0.0, 0.5)
        },
        shaper: one_of(&mut random, &ShaperKind::ALL),
    };
    let plain = config.vibration;
    config.vibration[0] = Some(mode());
    if bits & 16 != 0 {
        config.vibration[1] = Some(mode());
    }
    if config.check().is_err() {
        config.vibration = plain;
    }
}

/// The supervision beside the set-points.
fn supervise(random: &mut Random, config: &mut AxisConfig, cycle: f64) {
    let way = config.limits.velocity * cycle;
    if random.one_in(6) {
        config.override_max = random.between(1.0, 2.0);
    }
    if random.one_in(8) {
        config.power_timeout = Some(1 + random.below(10));
    }
    config.hardware_limits = !random.one_in(8);
    if random.one_in(8) {
        config.in_position = Some(InPosition {
            window: way * random.log_between(0.01, 10.0),
            scans: random.below(4) as u32,
        });
    }
    if random.one_in(10) {
        config.max_following_error = Some(way * random.log_between(1.0, 100.0));
    }
}

/// Other settings of a machine's axes.
fn choices(random: &mut Random, config: &mut AxisConfig) {
    let limits = config.limits;
    if random.one_in(5) {
        let mut part = |limit: f64| {
            (limit.is_finite() && random.one_in(2))
                .then(|| (limit * random.log_between(0.2, 5.0)).min(f64::MAX))
        };
        let stop = StopLimits {
            deceleration: part(limits.deceleration),
            jerk: part(limits.jerk),
            snap: part(limits.snap),
        };
        if stop != StopLimits::default() {
            (config.stop_deceleration, config.stop_jerk, config.stop) = (None, None, Some(stop));
        }
    }
    if random.one_in(6) {
        let mut part = |limit: f64| {
            let share = random.between(0.2, 1.0);
            if limit.is_finite() { limit * share } else { limit }
        };
        config.application_limits = Some(Limits {
            velocity: part(limits.velocity),
            acceleration: part(limits.acceleration),
            deceleration: part(limits.deceleration),
            jerk: part(limits.jerk),
            snap: part(limits.snap),
        });
    }
    if random.one_in(2) {
        config.jog_at_limit = JogAtLimit::Stop;
    }
    if random.one_in(3) {
        config.modulo_targets = ModuloTargets::Wrap;
    }
    if random.one_in(6) {
        config.edge_while_busy = EdgeWhileBusy::Ignore;
    }
}

/// A drive: an ideal one more often than the others.
fn drive(random: &mut Random, config: &AxisConfig, cycle: f64) -> DriveSetup {
    let limits = &config.limits;
    let power_on = if random.one_in(2) {
        Some(0)
    } else if random.one_in(20) {
        None
    } else {
        Some(random.below(6) as u32)
    };
    let delay = if random.one_in(2) {
        0
    } else {
        random.below(4) as usize
    };
    let switches = switches(random, config, cycle);
    let reactions = [Reaction::Coast, Reaction::Ramp, Reaction::RampAndStay];
    match random.below(6) {
        0 if config.scaling.is_some() => DriveSetup::Cia402(Cia402Setup {
            delay,
            power_on,
            start_up: random.below(4) as u32,
            deceleration: random
                .one_in(2)
                .then(|| (limits.deceleration * random.between(0.5, 2.0)).min(f64::MAX)),
            quick_stop: one_of(random, &reactions),
            on_disable: one_of(random, &reactions[..2]),
            on_fault: one_of(random, &reactions[..2]),
            homing: random
                .one_in(2)
                .then(|| (random.one_in(2), limits.velocity * random.between(0.1, 0.5))),
            motor: random.one_in(2).then(|| motor(random, limits)),
            switches,
        }),
        1 => plant(random, config, cycle, power_on, switches),
        _ => DriveSetup::Ideal(IdealDriveSetup {
            delay,
            power_on,
            switches,
        }),
    }
}

/// A motor that is usually strong enough for the limits of the axis.
fn motor(random: &mut Random, limits: &Limits) -> MotorSetup {
    let inertia = random.log_between(0.01, 10.0);
    let rated_torque = (inertia * limits.acceleration * random.log_between(0.3, 3.0)).min(f64::MAX);
    MotorSetup {
        rated_torque,
        max_torque: (rated_torque * random.between(1.0, 4.0)).min(f64::MAX),
        inertia,
        viscous: if random.one_in(2) {
            0.0
        } else {
            (0.1 * rated_torque / limits.velocity).min(f64::MAX)
        },
        coulomb: if random.one_in(2) { 0.0 } else { 0.1 * rated_torque },
    }
}

/// A mechanism, and loops that hold it.
fn plant(
    random: &mut Random,
    config: &AxisConfig,
    cycle: f64,
    power_on: Option<u32>,
    switches: Switches,
) -> DriveSetup {
    let limits = &config.limits;
    let motor = motor(random, limits);
    let reach = limits.velocity * cycle * random.log_between(50.0, 2000.0);
    let mut setup = PlantSetup {
        power_on,
        plant: Plant {
            inertia: motor.inertia,
            viscous: motor.viscous,
            coulomb: motor.coulomb,
            load: random.one_in(3).then(|| Load {
                inertia: motor.inertia * random.between(0.2, 2.0),
                stiffness: motor.inertia * random.between(0.05, 1.0) / (400.0 * cycle * cycle),
                damping: motor.inertia * random.between(0.0, 0.05) / cycle,
            }),
        },
        stops: (config.modulo.is_none() && random.one_in(2)).then(|| Stops {
            ends: (config.position - reach, config.position + reach),
            stiffness: motor.inertia / (400.0 * cycle * cycle),
            damping: motor.inertia * random.between(0.0, 0.1) / cycle,
        }),
        switches,
        ..PlantSetup::NONE
    };
    // Friction that is too stiff to be followed is refused.
    if Mechanism::new(setup.plant, config.position, cycle).is_err() {
        setup.plant.viscous = 0.0;
    }
    if random.one_in(4) {
        setup.gains.torque = motor.max_torque;
    }
    if random.one_in(4) {
        let own = setup.with_gains(cycle).gains;
        let mut part = |gain: f64| gain * random.between(0.3, 1.0);
        setup.gains.position = part(own.position);
        setup.gains.velocity = part(own.velocity);
        setup.gains.integral = part(own.integral);
        setup.gains.feed_velocity = part(1.0);
        setup.gains.feed_acceleration = part(1.0);
    }
    DriveSetup::Plant(setup.with_gains(cycle))
}

/// Switches along the travel, sometimes.
fn switches(random: &mut Random, config: &AxisConfig, cycle: f64) -> Switches {
    let way = config.limits.velocity * cycle;
    let mut place = |least: f64, most: f64| config.position + way * random.log_between(least, most);
    let near = [(); 6].map(|()| place(10.0, 1000.0));
    let [low, high, from, wide, at, every] = near.map(|place| place - config.position);
    Switches {
        limits: random
            .one_in(4)
            .then_some((config.position - low, config.position + high)),
        home: random.one_in(3).then(|| {
            let from = if random.one_in(2) { from } else { -from };
            (config.position + from, config.position + from + wide)
        }),
        marker: random.one_in(3).then(|| Marker {
            at: config.position + at,
            every: random.one_in(2).then_some(every),
        }),
        turn: None,
    }
}

/// A homing whose needs the drive meets; a value that the configuration refuses is removed.
fn homing(random: &mut Random, config: &mut AxisConfig, drive: &DriveSetup, cycle: f64) {
    if !random.one_in(2) {
        return;
    }
    let limits = config.limits;
    let velocity = limits.velocity * random.between(0.05, 0.6);
    let directions = [
        HomeDirection::Positive,
        HomeDirection::Negative,
        HomeDirection::SwitchPositive,
        HomeDirection::SwitchNegative,
    ];
    let edges = [
        SwitchEdge::Rising,
        SwitchEdge::Falling,
        SwitchEdge::SwitchPositive,
        SwitchEdge::SwitchNegative,
    ];
    let search = Homing {
        velocity,
        direction: one_of(random, &directions[..2]),
        time_limit: random.one_in(3).then(|| 50 + random.below(2000)),
        distance_limit: random
            .one_in(3)
            .then(|| limits.velocity * cycle * random.log_between(100.0, 2000.0)),
        ..Homing::DIRECT
    };
    let creep = random.one_in(2).then(|| velocity * random.between(0.1, 1.0));
    let pulse = drive.switches().marker.is_some() && random.one_in(2);
    let mut homings = vec![];
    if drive.switches().home.is_some() {
        homings.push(Homing {
            procedure: Procedure::AbsoluteSwitch,
            direction: one_of(random, &directions),
            edge: one_of(random, &edges),
            creep,
            pulse,
            ..search
        });
    }
    if drive.switches().limits.is_some() {
        homings.push(Homing {
            procedure: Procedure::LimitSwitch,
            creep,
            pulse,
            ..search
        });
    }
    if drive.switches().marker.is_some() {
        homings.push(Homing {
            procedure: Procedure::ReferencePulse,
            ..search
        });
    }
    match drive {
        DriveSetup::Plant(plant) if plant.stops.is_some() => homings.push(Homing {
            procedure: Procedure::Block,
            block: Some(BlockDetection {
                velocity: velocity * random.between(0.1, 0.9),
                scans: 1 + random.below(20) as u32,
            }),
            ..search
        }),
        DriveSetup::Cia402(Cia402Setup { homing: Some(_), .. }) => homings.push(Homing {
            procedure: Procedure::Drive,
            time_limit: search.time_limit,
            ..Homing::DIRECT
        }),
        DriveSetup::Plant(_) | DriveSetup::Cia402(_) | DriveSetup::Ideal(_) => {}
    }
    if homings.is_empty() {
        return;
    }
    config.homing = one_of(random, &homings);
    if config.check().is_err() {
        config.homing = Homing::DIRECT;
    }
}

/// MC_Power, MC_Reset and some more for an axis of `count`.
fn blocks(random: &mut Random, axis: usize, count: usize, limits: &Limits, cycle: f64) -> Vec<Block> {
    let of = |kinds: &[Kind]| -> Vec<&'static BlockInfo> {
        REGISTRY
            .iter()
            .filter(|info| kinds.contains(&kind_of(info)))
            .collect()
    };
    let owners = of(&[
        Kind::Motion,
        Kind::Stop,
        Kind::Jog,
        Kind::Superimposed,
        Kind::HaltSuperimposed,
    ]);
    let others = of(&[Kind::Administrative, Kind::Reading]);
    let mut names = vec!["MC_Power", "MC_Reset"];
    for _ in 0..2 + random.below(3) {
        names.push(one_of(random, &owners).name);
    }
    if random.one_in(2) {
        names.push(one_of(random, &others).name);
    }
    if random.one_in(3) {
        names.extend(one_of(random, &FAVOURED));
    }
    let mut block = |name: &'static str| Block {
        name: String::new(),
        block: name,
        pins: pins(random, one(name), axis, count, limits, cycle),
    };
    names.into_iter().map(&mut block).collect()
}

/// The pins of a block that hold from the start.
fn pins(
    random: &mut Random,
    info: &BlockInfo,
    axis: usize,
    count: usize,
    limits: &Limits,
    cycle: f64,
) -> Map<String, Json> {
    let mut pins = Map::new();
    for pin in info.pins() {
        let value = match pin.ty {
            PinType::Axis(_) => AXES[wired(pin, axis, count)].into(),
            PinType::Table(of) => write::table(&of, &records(random, of.name, limits, cycle)),
            _ => match (info.name, pin.name) {
                ("MC_Power", "Enable") => true.into(),
                // The first cam that is selected.
                ("MC_CamIn", "CamTableID") => 0x1_0001.into(),
                _ => continue,
            },
        };
        pins.insert(pin.name.to_owned(), value);
    }
    pins
}

/// The axis of `count` at a pin of a block of `axis`. A master is the next axis, so that all of them
/// could form a ring; a second master is the one after that, which is the same one if there are two.
fn wired(pin: &Pin, axis: usize, count: usize) -> usize {
    let further = match pin.name {
        "Master" | "Master1" => 1,
        "Master2" if count > 2 => 2,
        "Master2" => 1,
        _ => 0,
    };
    (axis + further) % count
}

/// The records of a table.
fn records(random: &mut Random, of: &str, limits: &Limits, cycle: f64) -> Vec<Vec<f64>> {
    match of {
        "MC_TP_REF" | "MC_TV_REF" | "MC_TA_REF" => points(random, of, limits, cycle),
        "MC_CAM_REF" => curve(random, limits.velocity * cycle),
        "MC_CAMSWITCH_REF" => (0..1 + random.below(3))
            .map(|_| cam(random, limits.velocity * cycle))
            .collect(),
        _ => Vec::new(),
    }
}

/// Points of a profile that most axes can follow from rest: time since the one before (ns), value, and whether the
/// curve is level there.
fn points(random: &mut Random, of: &str, limits: &Limits, cycle: f64) -> Vec<Vec<f64>> {
    // The time in which the axis reaches its velocity and returns to rest, by all its limits.
    let jerk = limits.jerk.min(limits.acceleration / cycle);
    let snap = limits.snap.min(jerk / cycle);
    let slow = limits.velocity / limits.acceleration.min(limits.deceleration)
        + limits.acceleration / jerk
        + jerk / snap;
    let count = 1 + random.below(6);
    let mut position = 0.0;
    let point = |_| {
        let time = slow * random.log_between(0.7, 10.0);
        let part = random.between(-0.4, 0.4);
        let value = match of {
            "MC_TP_REF" => {
                position += part * limits.velocity * time;
                position
            }
            "MC_TV_REF" => 2.0 * part * limits.velocity,
            _ => part * limits.velocity / time,
        };
        let late = if random.one_in(40) { -1.0 } else { 1.0 };
        vec![
            late * (time * 1e9).floor(),
            value,
            f64::from(u8::from(random.one_in(4))),
        ]
    };
    (0..count).map(point).collect()
}

/// Rows of a cam over the distance of a few hundred scans: master, slave, three derivatives, law.
fn curve(random: &mut Random, way: f64) -> Vec<Vec<f64>> {
    let law = one_of(random, &[0.0, 4.0, 4.0, 5.0]);
    let mut master = 0.0;
    let mut row = |slave: f64, random: &mut Random| {
        let row = vec![master, slave, 0.0, 0.0, 0.0, law];
        master += way * random.log_between(30.0, 300.0);
        row
    };
    let mut rows = vec![row(0.0, random)];
    for _ in 0..1 + random.below(4) {
        let slave = way * random.between(-60.0, 60.0);
        rows.push(row(slave, random));
    }
    if random.one_in(2) {
        rows.push(row(0.0, random));
    }
    rows
}

/// A cam over the distance of some scans: track, ends, direction, mode, duration (ns).
fn cam(random: &mut Random, way: f64) -> Vec<f64> {
    let first = random.between(-50.0, 50.0) * way;
    vec![
        random.below(4) as f64 + 1.0,
        first,
        first + random.log_between(0.1, 50.0) * way,
        random.below(3) as f64,
        random.below(2) as f64,
        random.below(20) as f64 * 1e6,
    ]
}

/// A block of the registry by its name there.
fn one(name: &'static str) -> &'static BlockInfo {
    REGISTRY
        .iter()
        .find(|info| info.name == name)
        .unwrap_or(&REGISTRY[0])
}

#[cfg(test)]
mod tests {
    use super::*;
    use standstill_axis::keys::{AXIS, Key, Object};
    use standstill_drives::keys::{CIA402, IDEAL, PLANT};
    use standstill_fb::Group;
    use std::collections::BTreeSet;

    /// A block that programs do not contain would count as correct without a test.
    #[test]
    fn every_block_of_an_axis_is_played() {
        for info in REGISTRY.iter().filter(|info| info.group != Group::Standard) {
            assert_ne!(kind_of(info), Kind::Other, "{}", info.name);
            let is_favoured = FAVOURED.iter().any(|names| names.contains(&info.name));
            assert!(is_favoured || info.group != Group::MultiAxis, "{}", info.name);
        }
    }

    /// The keys whose values in `of` differ from those in `plain`.
    fn differing<T>(object: &Object<T>, name: &str, of: &T, plain: &T, all: &mut BTreeSet<String>) {
        object.each(&mut |key: &'static Key<T>| {
            if !key.is_same(of, plain) {
                all.insert(format!("{name}.{}", key.path));
            }
        });
    }

    fn paths<T>(object: &Object<T>, name: &str) -> Vec<String> {
        let mut paths = Vec::new();
        object.each(&mut |key| paths.push(format!("{name}.{}", key.path)));
        paths
    }

    /// So would a key.
    #[test]
    fn every_key_of_an_axis_and_of_a_drive_is_played() {
        let mut played = BTreeSet::new();
        for number in 0..3000 {
            let mut random = Random::new(7, number);
            let cycle = one_of(&mut random, &CYCLES) as f64 / 1e9;
            for (config, drive) in axes(&mut random, cycle) {
                differing(
                    &AXIS,
                    "axis",
                    &config,
                    &AxisConfig::new(Limits::NONE),
                    &mut played,
                );
                match &drive {
                    DriveSetup::Ideal(setup) => {
                        differing(&IDEAL, "ideal", setup, &IdealDriveSetup::PLAIN, &mut played);
                    }
                    DriveSetup::Cia402(setup) => {
                        differing(&CIA402, "cia402", setup, &Cia402Setup::PLAIN, &mut played);
                    }
                    DriveSetup::Plant(setup) => {
                        differing(&PLANT, "plant", setup, &PlantSetup::NONE, &mut played);
                    }
                }
            }
        }
        let all = [
            paths(&AXIS, "axis"),
            paths(&IDEAL, "ideal"),
            paths(&CIA402, "cia402"),
            paths(&PLANT, "plant"),
        ]
        .concat();
        let missing: Vec<_> = all.iter().filter(|path| !played.contains(*path)).collect();
        // Drawn positions are around the start position of an axis, so that position may be 0.
        assert_eq!(missing, ["axis.position"]);
    }
}

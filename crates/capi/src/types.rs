//! The structures that cross the border: plain, without hidden gaps, each beginning with its size.

use core::ffi::c_char;

/// The result of a function.
///
/// With any code except OK and INTERNAL the function has done nothing: it has written no output, called no block,
/// and begun or ended no motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Code {
    /// Done.
    Ok = 0,
    /// A pointer that must not be null is null.
    NullPointer = -1,
    /// The size in front of a structure is smaller than that of its first version: it was not set.
    StructSize = -2,
    /// The host was compiled with the header of another ABI version.
    AbiMismatch = -3,
    /// The storage is smaller than runtime_size says, or not aligned to 16 bytes.
    Storage = -4,
    /// There is no runtime at this address: it was not initialised, or it was closed.
    NoRuntime = -5,
    /// Another thread is in the runtime, or has a tick open.
    OtherThread = -6,
    /// Blocks are called between tick_begin and tick_end only.
    NotInTick = -7,
    /// Only outside a tick: before tick_begin, or after tick_end.
    InTick = -8,
    /// The instant is before that of the previous tick: use a monotonic clock.
    TimeBackwards = -9,
    /// No instance has this key: it belongs to another runtime, was released, or was overwritten.
    UnknownKey = -10,
    /// The key belongs to an instance of another block.
    WrongBlock = -11,
    /// The runtime was set up for fewer axes or instances.
    NoRoom = -12,
    /// No axis has this number; the first is 1.
    UnknownAxis = -13,
    /// A value of the configuration is invalid; config_error returns its key.
    BadConfig = -14,
    /// The drive under the axis is of another kind. Simulated drives take no feedback; others cannot be made to
    /// fail.
    WrongDrive = -15,
    /// A number is not one of the permitted choices.
    BadValue = -16,
    /// An array has more records than its block accepts, or records at address null.
    Table = -17,
    /// An axis is switched on or moving: stop, and continue with ticks until every axis is Disabled.
    NotOff = -18,
    /// The resource was stopped: blocks are not called, and the axes are stopping and switching off.
    Stopped = -19,
    /// A defect of the library was caught. It has stopped the resource as stop does, and the resource stays
    /// stopped.
    Internal = -20,
    /// No flight recorder was set up.
    NoRecorder = -21,
}

/// Sizes of a runtime, fixed for its life.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct RuntimeConfig {
    /// sizeof this structure.
    pub size: u32,
    /// Largest number of axes, 1 to 1024.
    pub axes: u32,
    /// Largest number of block instances, up to 65534.
    pub instances: u32,
    /// Number of set-points kept for axes with vibration, in all, up to 2^24. For each mode of an axis: twice its
    /// period in ticks, divided by 1 - damping^2, but at most 4096, and 4. Each takes 40 bytes of storage.
    pub history: u32,
    /// Nominal time between ticks (ns), above 0. Every tick_end advances motion by this time, even if it is late.
    pub cycle_ns: i64,
}

/// The configuration of an axis. axis_defaults fills in everything except the five limits; docs/scan-scripts.md
/// describes each.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct AxisSetup {
    /// sizeof this structure.
    pub size: u32,
    /// 0: power off. 1: powered from the start, as if MC_Power had been called.
    pub start_powered: u32,
    /// Largest velocity (u/s), above 0.
    pub velocity: f64,
    /// Largest rate while the speed grows (u/s^2), above 0.
    pub acceleration: f64,
    /// Largest rate while the speed falls (u/s^2); 0: that of acceleration.
    pub deceleration: f64,
    /// Largest jerk (u/s^3); 0: no limit.
    pub jerk: f64,
    /// Largest snap (u/s^4); 0: no limit.
    pub snap: f64,
    /// Value for 0 at the pin Acceleration; 0: the limit. The same for the next three.
    pub default_acceleration: f64,
    /// The same for Deceleration.
    pub default_deceleration: f64,
    /// The same for Jerk.
    pub default_jerk: f64,
    /// The same for Snap.
    pub default_snap: f64,
    /// Position at the start (u).
    pub position: f64,
    /// Number of drive increments in scaling_units; 0: the drive uses units.
    pub scaling_increments: u32,
    /// Number of user units in scaling_increments.
    pub scaling_units: u32,
    /// The drive counts in the other direction if not 0.
    pub scaling_invert: u32,
    /// Treatment of values above the limits: 0 lowers and records them, 1 refuses the command.
    pub above_limit: i32,
    /// Position at increment 0 (u).
    pub scaling_offset: f64,
    /// Length of a turn (u); 0: a linear axis.
    pub modulo: f64,
    /// Lowest target of a move (u); -INFINITY for none.
    pub software_limit_min: f64,
    /// Highest target of a move (u); INFINITY for none.
    pub software_limit_max: f64,
    /// Method of planning moves: 0 overlapped, 1 grid, 2 sequential, 3 online, 4 fastest, 5 s_curve, 6 trapezoid, 7
    /// short_path.
    pub profile: i32,
    /// Largest number of waiting commands, 0 to 16.
    pub queue: u32,
    /// Reaction to switching off in motion: 0 ramps down, 1 coasts, 2 leaves it to the drive.
    pub on_power_off: i32,
    /// Absolute moves need MC_Home first if not 0.
    pub needs_homed: u32,
    /// Deceleration of ramps without a command (u/s^2); 0: the limit.
    pub stop_deceleration: f64,
    /// Jerk of ramps without a command (u/s^3); 0: the limit.
    pub stop_jerk: f64,
    /// Largest factor of MC_SetOverride, at least 1.
    pub override_max: f64,
    /// Largest following error (u); 0: not supervised.
    pub max_following_error: f64,
    /// A move is done when the actual position is this near to the target (u); 0: the set position decides alone.
    pub in_position_window: f64,
    /// .. for this number of scans.
    pub in_position_scans: u32,
    /// Stops at the limit switches that the drive reports if not 0.
    pub hardware_limits: u32,
    /// MC_Home: 0 direct, 1 absolute switch, 2 limit switch, 3 reference pulse, 4 block, 5 by the drive.
    pub homing: i32,
    /// 0 positive, 1 negative, 2 by the switch, positive, 3 by the switch, negative.
    pub homing_direction: i32,
    /// 0 rising, 1 falling, 2 lower end, 3 upper end.
    pub homing_edge: i32,
    /// The reference is the pulse behind the switch if not 0.
    pub homing_pulse: u32,
    /// Velocity of the search (u/s).
    pub homing_velocity: f64,
    /// Velocity of a second approach (u/s); 0: there is none.
    pub homing_creep: f64,
    /// An axis slower than this is at rest at its block (u/s).
    pub homing_block_velocity: f64,
    /// .. for this number of scans.
    pub homing_block_scans: u64,
    /// Largest number of scans of the search; 0: any.
    pub homing_time_limit: u64,
    /// Largest distance of the search (u); 0: any.
    pub homing_distance_limit: f64,
    /// Largest number of scans until the drive confirms its power, then MC_Power shows error 503; 0: any. A
    /// structure that ends before this field has 0.
    pub power_timeout: u64,
    /// Largest distance of a slave from the law of its gear (u), then error 420; 0: any distance. In a structure
    /// that ends before this field, it and all later ones are 0.
    pub max_deviation: f64,
    /// Reaction of a slave that cannot keep up: 0 lags and catches up, 1 stops with error 420, 2 makes its master
    /// move no faster than the slave can follow while it is in gear.
    pub on_limit: i32,
    /// Reaction of a slave whose master goes out of operation: 0 stops with error 421, 1 comes to rest and stays
    /// coupled.
    pub on_master_lost: i32,
    /// As a master of actual values: number of scans of each of the four averages that filter it for slaves, at
    /// most 64; 0: 16; below 0: no filter.
    pub actual_filter: i32,
    /// As a master of actual values: slaves see it ahead by the delay of the filter at its velocity, if not 0.
    pub actual_lead: u32,
    /// Limits of commands: velocity (u/s), at most that of the axis; 0: that of the axis, here and in the next
    /// four.
    pub application_velocity: f64,
    /// .. acceleration (u/s^2).
    pub application_acceleration: f64,
    /// .. deceleration (u/s^2); 0: the acceleration above, but at most the deceleration of the axis.
    pub application_deceleration: f64,
    /// .. jerk (u/s^3).
    pub application_jerk: f64,
    /// .. snap (u/s^4).
    pub application_snap: f64,
    /// Deceleration of MC_Stop and of ramps without a command, which may be above the limit (u/s^2); 0: the limit,
    /// here and in the next two. If one of the three is set, stop_deceleration and stop_jerk must be 0.
    pub hard_stop_deceleration: f64,
    /// .. jerk (u/s^3).
    pub hard_stop_jerk: f64,
    /// .. snap (u/s^4).
    pub hard_stop_snap: f64,
    /// A held MC_Jog at a software limit: 0 error 402 before it, 1 at rest on it.
    pub jog_at_limit: i32,
    /// Absolute targets outside the first turn: 0 error 119, 1 moved into it.
    pub modulo_targets: i32,
    /// A rising edge of Execute while the instance is Busy: 0 starts the command anew, 1 does nothing.
    pub edge_while_busy: i32,
    /// Number of derivatives of a cam that must be continuous for a slave, 1 to 3; below 0: none; 0: 3 with a snap
    /// limit, 2 with a jerk limit, 1 without. If its limits need more, it stops at the rows at which one jumps.
    pub cam_continuity: i32,
    /// Frequency without damping (Hz) of the load's vibration; 0: none, and nothing is shaped.
    /// RuntimeConfig.history is the memory.
    pub vibration_frequency: f64,
    /// Its damping ratio, 0 to 0.9.
    pub vibration_damping: f64,
    /// Frequency of a second mode (Hz); 0: none.
    pub vibration2_frequency: f64,
    /// Its damping ratio.
    pub vibration2_damping: f64,
    /// The shaper of the first mode: 0 ei, 1 period, 2 zv, 3 zvd.
    pub vibration_shaper: i32,
    /// The shaper of the second mode.
    pub vibration2_shaper: i32,
}

/// The drive under an axis. drive_defaults gives an ideal one.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct DriveSetup {
    /// sizeof this structure.
    pub size: u32,
    /// 0: the host's own, with feedback_write and command_read. Simulated: 1 ideal, 2 CiA 402 node (needs a scaling
    /// of the axis), 3 a motor with a mechanism.
    pub kind: i32,
    /// Ideal and CiA 402: scans from command to actual position beyond the first, at most 64.
    pub delay: u32,
    /// Simulated: scans until power is confirmed; below 0: never.
    pub power_on: i32,
    /// CiA 402: scans of self-test.
    pub start_up: u32,
    /// CiA 402, object 605Ah: 0 coast, 1 ramp, 2 ramp and stay.
    pub quick_stop: i32,
    /// CiA 402, objects 605Bh and 605Ch: 0 coast, 1 ramp.
    pub on_disable: i32,
    /// CiA 402, object 605Eh: 0 coast, 1 ramp.
    pub on_fault: i32,
    /// CiA 402: rate of its own ramps (u/s^2); 0: the limit of the axis.
    pub deceleration: f64,
    /// Mechanism: torque for an acceleration of the motor (torque s^2/u), above 0.
    pub inertia: f64,
    /// Friction that grows with velocity (torque s/u).
    pub viscous: f64,
    /// Friction that does not (torque).
    pub coulomb: f64,
    /// Load on a spring: its inertia; 0: everything is rigid.
    pub load_inertia: f64,
    /// Its spring (torque/u).
    pub load_stiffness: f64,
    /// Its damping (torque s/u).
    pub load_damping: f64,
    /// Largest torque of the motor; 0: any; for a CiA 402 drive three times the rated one.
    pub torque_max: f64,
    /// From here on for simulated drives; a structure that ends here has none of these. There are limit switches
    /// along the travel if not 0.
    pub limit_switches: u32,
    /// There is a home switch if not 0.
    pub home_switch: u32,
    /// The drive latches reference pulses if not 0.
    pub marker: u32,
    /// CiA 402, homing by the drive: 0 upwards, 1 downwards, to the edge at which its home switch becomes active.
    pub homing_direction: i32,
    /// The limit switches are active up to this (u) ..
    pub limit_switch_negative: f64,
    /// .. and from this on (u).
    pub limit_switch_positive: f64,
    /// The home switch is active from this (u) ..
    pub home_switch_from: f64,
    /// .. to this (u).
    pub home_switch_to: f64,
    /// Position of a reference pulse (u) ..
    pub marker_at: f64,
    /// .. and the distance to the next one (u); 0: there is only one.
    pub marker_every: f64,
    /// CiA 402: velocity of homing by the drive (u/s); 0: it has no homing mode.
    pub homing_velocity: f64,
    /// CiA 402: rated torque of its motor, which has inertia, viscous, coulomb and torque_max; 0: it has no torque
    /// mode and reports no torque.
    pub rated_torque: f64,
    /// Mechanism: springs at the ends of the travel (torque/u); 0: it has no end.
    pub stop_stiffness: f64,
    /// Their damping (torque s/u).
    pub stop_damping: f64,
    /// Begin of the lower one (u).
    pub stop_negative: f64,
    /// Begin of the upper one (u).
    pub stop_positive: f64,
    /// Mechanism, its loops: position (1/s); NaN: a value that is stable for any rigid mechanism. The same for the
    /// next two.
    pub gain_position: f64,
    /// Velocity (torque s/u).
    pub gain_velocity: f64,
    /// Integral of velocity (torque/u).
    pub gain_integral: f64,
    /// The part of the velocity that is fed forward.
    pub feed_velocity: f64,
    /// The part of the acceleration's torque that is fed forward.
    pub feed_acceleration: f64,
}

/// The report of a host's own drive in a tick. The next tick_begin takes it, once: a tick without a new report has
/// lost its communication with the drive.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Feedback {
    /// sizeof this structure.
    pub size: u32,
    /// The power stage is on and follows the command.
    pub enabled: u8,
    /// Power for the stage is available.
    pub voltage: u8,
    /// A fault is pending.
    pub fault: u8,
    /// .. and its cause is still present.
    pub cause_present: u8,
    /// The drive's own error code: of its fault, or of its failed homing.
    pub fault_code: u16,
    /// The feedback is old: no new one has arrived.
    pub lost: u8,
    /// A warning is present.
    pub warning: u8,
    /// The home switch.
    pub home_switch: u8,
    /// The limit switch in positive direction, as the drive counts.
    pub limit_switch_positive: u8,
    /// The limit switch in negative direction.
    pub limit_switch_negative: u8,
    /// The drive is a simulated one.
    pub simulated: u8,
    /// Actual position (u) of an axis without scaling.
    pub position: f64,
    /// Actual position of an axis with scaling.
    pub increments: i64,
    /// Digital inputs, one bit each.
    pub inputs: u32,
    /// Present digital outputs, one bit each.
    pub outputs: u32,
    /// Actual torque, in the drive's unit.
    pub torque: f64,
    /// The largest torque it can hold; 0: it only measures.
    pub torque_max: f64,
    /// The torque is known.
    pub torque_known: u8,
    /// It does not hold the requested torque.
    pub torque_limited: u8,
    /// It has a home switch; the next three are alike.
    pub has_home_switch: u8,
    /// Limit switches at both ends.
    pub has_limit_switches: u8,
    /// It latches the reference pulse.
    pub has_marker: u8,
    /// It homes by itself.
    pub has_homing: u8,
    /// The latch of the reference pulse is armed.
    pub marker_armed: u8,
    /// .. and has one: marker_position or marker_increments.
    pub marker_latched: u8,
    /// Probes 1 and 2 are armed.
    pub probe_armed: [u8; 2],
    /// .. and have an edge.
    pub probe_latched: [u8; 2],
    /// Homing by itself: 0 off, 1 busy, 2 attained, 3 done, 4 failed.
    pub homing: i32,
    /// Positions at the edges of the probes (u).
    pub probe_position: [f64; 2],
    /// The same in increments.
    pub probe_increments: [i64; 2],
    /// Position at the reference pulse (u).
    pub marker_position: f64,
    /// The same in increments.
    pub marker_increments: i64,
    /// Position of the reference, attained or done (u).
    pub home_position: f64,
    /// The same in increments.
    pub home_increments: i64,
}

/// The command for a host's own drive, after tick_end.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Command {
    /// sizeof this structure.
    pub size: u32,
    /// Power stage: 0 off, 1 operation enabled, 2 quick stop, 3 fault reset.
    pub request: i32,
    /// Set-point for the end of the tick (u), of an axis without scaling.
    pub position: f64,
    /// The same for an axis with scaling.
    pub increments: i64,
    /// Velocity (u/s) for feed-forward.
    pub velocity: f64,
    /// From now on the position of the previous command has this value (u); valid if renamed.
    pub rename: f64,
    /// Torque to hold instead of the position; valid if has_torque.
    pub torque: f64,
    /// .. at no less than this velocity (u/s)
    pub velocity_min: f64,
    /// .. and no more than this.
    pub velocity_max: f64,
    /// Digital outputs, one bit each.
    pub outputs: u32,
    /// Positions are renamed: see rename.
    pub renamed: u8,
    /// A torque is to be held.
    pub has_torque: u8,
    /// The drive is to latch the next reference pulse.
    pub marker: u8,
    /// The drive is to home by itself.
    pub homing: u8,
    /// Edges that probes 1 and 2 wait for: 0 none, 1 a rising edge, 2 a falling one.
    pub probe_edge: [u8; 2],
    /// 0.
    pub reserved: [u8; 6],
}

/// The present data of an axis.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct AxisStatus {
    /// sizeof this structure.
    pub size: u32,
    /// 0 Disabled, 1 Standstill, 2 Homing, 3 DiscreteMotion, 4 ContinuousMotion, 5 SynchronizedMotion, 6 Stopping,
    /// 7 ErrorStop.
    pub state: i32,
    /// Set position (u).
    pub position: f64,
    /// Set velocity (u/s).
    pub velocity: f64,
    /// Set acceleration (u/s^2).
    pub acceleration: f64,
    /// Jerk of the set-point (u/s^3).
    pub jerk: f64,
    /// Snap of the set-point (u/s^4).
    pub snap: f64,
    /// Actual position (u).
    pub actual_position: f64,
    /// ErrorID of the pending axis error, 0 without one.
    pub error_id: u32,
    /// The drive's own code.
    pub error_code: u32,
    /// Operation is enabled.
    pub powered: u32,
    /// The reference is known.
    pub homed: u32,
}

/// Number of bytes of a name in a record.
pub const NAME: usize = 32;

/// One entry of the diagnostic ring, which keeps the last 64.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Record {
    /// Its number, from 0 since the start.
    pub number: u64,
    /// The tick in which it happened, from 0.
    pub scan: u64,
    /// The axis.
    pub axis: i32,
    /// The low half of the key of the block instance; 0: the runtime itself.
    pub instance: u32,
    /// 1 refused, 2 point refused, 3 clamped, 4 raised, 5 unavoidable, 6 shifted, 7 planned to a position, 8 planned
    /// to a velocity, 9 planned past a position, 10 superimposed, 11 room awaited, 12 paused, 13 fault, 14 orphaned,
    /// 15 coupled, 16 approaching the law of a gear, 17 in gear, 18 no longer in gear, 19 in sync late, 20 phase shift
    /// planned, 21 lowered to what a slave can follow, 22 cam selected, 23 onto a cam, 24 plan onto a cam, 25 in sync,
    /// 26 no longer in sync, 27 more than one end of a cam passed in a scan, 28 a master leads out of a software limit,
    /// 29 the slave of a cam rests at a row.
    pub event: i32,
    /// ErrorID, 0 without one.
    pub error_id: u32,
    /// Scans of a plan, number of a point, of a row or of a master, ends of a cam, or code of a drive.
    pub count: u64,
    /// The requested value; the excess of velocity; the target; the velocity; the numerator of a ratio; the number of a
    /// cam; the jump.
    pub value: f64,
    /// The value used instead, or the limit; the excess of acceleration; the velocity when passing; the denominator.
    pub limit: f64,
    /// The excess of jerk.
    pub third: f64,
    /// Name of the pin, field, quantity or way, with a 0 at its end; empty: the axis state decided.
    pub name: [c_char; NAME],
}

/// The reason why a configuration was refused.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct ConfigFault {
    /// sizeof this structure.
    pub size: u32,
    /// 0.
    pub reserved: u32,
    /// The refused value; 0 if it is no number.
    pub value: f64,
    /// The key, as in scan scripts, with a 0 at its end; empty: nothing was refused.
    pub key: [c_char; NAME],
}

/// The disturbances of a simulated drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Mishap {
    /// Removes the cause of any of them.
    Clear = 0,
    /// A fault of the drive with its own code.
    Fault = 1,
    /// The supply of the power stage fails.
    Power = 2,
    /// Feedback no longer arrives.
    Communication = 3,
    /// The axis itself fails; CLEAR ends that, too.
    Axis = 4,
    /// A CiA 402 drive no longer obeys its controller ..
    Local = 5,
    /// .. and obeys it again.
    Remote = 6,
    /// A CiA 402 drive shows a warning ..
    Warning = 7,
    /// .. and shows none.
    NoWarning = 8,
}

impl Mishap {
    /// All values, each at the index of its number.
    pub(crate) const ALL: [Self; 9] = [
        Self::Clear,
        Self::Fault,
        Self::Power,
        Self::Communication,
        Self::Axis,
        Self::Local,
        Self::Remote,
        Self::Warning,
        Self::NoWarning,
    ];
}

/// The extent of a flight recorder, and its trigger.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct RecorderConfig {
    /// sizeof this structure.
    pub size: u32,
    /// Scans that are kept: the last ones, and after a freeze those around the trigger. 1 to 2^24.
    pub scans: u32,
    /// Of these, the number of scans after that of the trigger; less than scans.
    pub after: u32,
    /// Number of records (plans, refusals, faults) that are kept, up to 2^24; newer ones replace older ones.
    pub records: u32,
    /// The event that freezes it: 0 an axis that goes into ErrorStop, or recorder_trip; 1 only recorder_trip.
    pub trigger: i32,
    /// 0.
    pub reserved: u32,
}

/// Number of bytes of a unit's label.
pub const UNIT: usize = 16;

/// A name for a flight recorder: of a block instance, which is then recorded, or of an axis, which is always
/// recorded.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Recorded {
    /// Key of the instance, if the entry is no axis.
    pub key: u64,
    /// Number of the axis; 0: the entry is an instance.
    pub axis: i32,
    /// 0.
    pub reserved: u32,
    /// The name in columns of the trace: an IEC identifier, with a 0 at its end. An axis without an entry is axis1,
    /// ..
    pub name: [c_char; NAME],
    /// Label of the axis' unit, or empty; with a 0 at its end.
    pub unit: [c_char; UNIT],
}

/// The present state of a flight recorder.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct RecorderStatus {
    /// sizeof this structure.
    pub size: u32,
    /// 0 keeps the last scans, 1 has tripped, 2 frozen.
    pub state: i32,
    /// Number of the first scan in it.
    pub first: u64,
    /// Number of scans in it.
    pub scans: u64,
    /// The scan that tripped it, if it has tripped.
    pub tripped_at: u64,
    /// The axis that went into ErrorStop; 0: the host tripped it.
    pub axis: i32,
    /// Number of scans until it freezes, if it has tripped.
    pub left: u32,
}

/// The progress of reading the text of a flight recorder.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct Dump {
    /// sizeof this structure.
    pub size: u32,
    /// The text: 0 JSON Lines, all in one; 1 CSV, 2 the header for the file NAME.csv.meta.json beside it.
    pub form: i32,
    /// The line to continue with; 0 before the first part, like the other fields.
    pub line: u64,
    /// Number of its bytes that were already read.
    pub skip: u64,
    /// The recorder's stamp at the first part.
    pub stamp: u64,
}

// There is no padding that a compiler might fill in: every byte belongs to a field.
const _: () = assert!(size_of::<RuntimeConfig>() == 24);
const _: () = assert!(size_of::<AxisSetup>() == 416);
const _: () = assert!(size_of::<DriveSetup>() == 248);
const _: () = assert!(size_of::<Feedback>() == 136);
const _: () = assert!(size_of::<Command>() == 80);
const _: () = assert!(size_of::<AxisStatus>() == 72);
const _: () = assert!(size_of::<Record>() == 96);
const _: () = assert!(size_of::<ConfigFault>() == 48);
const _: () = assert!(size_of::<RecorderConfig>() == 24);
const _: () = assert!(size_of::<Recorded>() == 64);
const _: () = assert!(size_of::<RecorderStatus>() == 40);
const _: () = assert!(size_of::<Dump>() == 32);

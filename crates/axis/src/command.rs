//! The vocabulary that blocks and axes share: axes, instances, commands and their values.

use crate::{CamId, Edge, StartMode};

/// Handle of an axis: its index in the slice of axes. It holds no live state, so copying it in and out
/// around a call has the same effect as passing it by reference (IEC 61131-3 VAR_IN_OUT).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct AxisId(u16);

impl AxisId {
    /// The handle of no axis: what an unwired `Axis` pin holds.
    pub const NONE: Self = Self(u16::MAX);

    /// The axis at `index`.
    pub const fn new(index: u16) -> Self {
        Self(index)
    }

    /// Its number for people and for hosts in other languages, from 1; 0 for no axis.
    pub const fn number(self) -> u16 {
        self.0.wrapping_add(1)
    }

    /// Its index in the slice of axes.
    pub const fn index(self) -> usize {
        self.0 as usize
    }
}

impl Default for AxisId {
    fn default() -> Self {
        Self::NONE
    }
}

/// The block instance that gave a command. It is used in records only; the axis does not read it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InstanceId(pub u16);

/// Number of a command, rising per axis and never reused (R94).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CommandId(pub(crate) u64);

/// An enumeration of the standard with its IEC names and our numbers.
pub trait IecEnum: Copy + 'static {
    /// The type's name in IEC text.
    const TYPE: &'static str;
    /// Names and numbers in declaration order.
    const ELEMENTS: &'static [(&'static str, i32)];

    /// The element with this number.
    fn from_number(number: i32) -> Option<Self>;
}

/// The number at an enum pin, which a program may set to an undefined value.
#[derive(Debug)]
pub struct Raw<E> {
    number: i32,
    of: core::marker::PhantomData<E>,
}

impl<E> Clone for Raw<E> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<E> Copy for Raw<E> {}

impl<E> PartialEq for Raw<E> {
    fn eq(&self, other: &Self) -> bool {
        self.number == other.number
    }
}

/// The number 0, which every enumeration defines.
impl<E: IecEnum> Default for Raw<E> {
    fn default() -> Self {
        Self::new(0)
    }
}

impl<E: IecEnum> Raw<E> {
    /// A pin holding `number`, defined or not.
    pub const fn new(number: i32) -> Self {
        Self {
            number,
            of: core::marker::PhantomData,
        }
    }

    /// The number.
    pub const fn number(self) -> i32 {
        self.number
    }

    /// The element, or `None` if the number is undefined.
    pub fn get(self) -> Option<E> {
        E::from_number(self.number)
    }
}

macro_rules! iec_enum {
    ($(#[$meta:meta])* $name:ident = $iec:literal { $($(#[$doc:meta])* $element:ident = $text:literal, $number:literal;)* }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum $name { $($(#[$doc])* $element = $number,)* }

        impl IecEnum for $name {
            const TYPE: &'static str = $iec;
            const ELEMENTS: &'static [(&'static str, i32)] = &[$(($text, $number)),*];

            fn from_number(number: i32) -> Option<Self> {
                match number {
                    $($number => Some(Self::$element),)*
                    _ => None,
                }
            }
        }

        impl From<$name> for $crate::Raw<$name> {
            fn from(element: $name) -> Self {
                Self::new(element as i32)
            }
        }
    };
}

pub(crate) use iec_enum;

iec_enum! {
    /// How a command follows the one before it (MC_BUFFER_MODE, numbers in table order: V8a).
    BufferMode = "MC_BUFFER_MODE" {
        /// At once; interrupts the motion in progress and clears the buffer.
        Aborting = "mcAborting", 0;
        /// When the previous motion has finished.
        Buffered = "mcBuffered", 1;
        /// At the previous end position, with the lower of the two velocities.
        BlendingLow = "mcBlendingLow", 2;
        /// At the previous end position, with the previous velocity.
        BlendingPrevious = "mcBlendingPrevious", 3;
        /// At the previous end position, with the next velocity.
        BlendingNext = "mcBlendingNext", 4;
        /// At the previous end position, with the higher of the two velocities.
        BlendingHigh = "mcBlendingHigh", 5;
    }
}

impl BufferMode {
    /// The previous end position is passed in motion.
    pub const fn blends(self) -> bool {
        !matches!(self, Self::Aborting | Self::Buffered)
    }

    /// The velocity of this mode between two commands with these velocities.
    pub(crate) const fn speed_between(self, previous: f64, next: f64) -> f64 {
        match self {
            Self::Aborting | Self::Buffered => 0.0,
            Self::BlendingLow => previous.min(next),
            Self::BlendingPrevious => previous,
            Self::BlendingNext => next,
            Self::BlendingHigh => previous.max(next),
        }
    }
}

iec_enum! {
    /// Direction of a motion (MC_DIRECTION, numbers: V8). 0 stands for "not set": the shortest way for
    /// positioning, positive for velocity.
    Direction = "MC_DIRECTION" {
        /// Not set.
        Unset = "mcDirectionUnset", 0;
        /// Towards larger positions.
        Positive = "mcPositiveDirection", 1;
        /// The direction with the shorter distance on a modulo axis.
        ShortestWay = "mcShortestWay", 2;
        /// Towards smaller positions.
        Negative = "mcNegativeDirection", 3;
        /// The direction of the present motion.
        Current = "mcCurrentDirection", 4;
    }
}

iec_enum! {
    /// Which values of an axis are meant (MC_SOURCE, numbers in the standard's order).
    ValueSource = "MC_SOURCE" {
        /// The values at the pins of the active command.
        Commanded = "mcCommandedValue", 0;
        /// The newest set-point.
        Set = "mcSetValue", 1;
        /// The newest feedback.
        Actual = "mcActualValue", 2;
    }
}

iec_enum! {
    /// When an administrative command takes effect (MC_EXECUTION_MODE).
    ExecutionMode = "MC_EXECUTION_MODE" {
        /// In the call itself.
        Immediately = "mcImmediately", 0;
        /// Like a buffered motion: when the earlier commands have finished.
        Queued = "mcQueued", 1;
    }
}

iec_enum! {
    /// Which repetition of its sync position MC_GearInPos takes on a modulo slave (MC_SYNC_MODE, numbers in the
    /// standard's order).
    SyncMode = "MC_SYNC_MODE" {
        /// The nearest to where the slave would be without it.
        Shortest = "mcShortest", 0;
        /// The nearest ahead: the slave speeds up.
        CatchUp = "mcCatchUp", 1;
        /// The nearest behind: the slave slows down. It is never faster than in sync.
        SlowDown = "mcSlowDown", 2;
    }
}

iec_enum! {
    /// How MC_CombineAxes combines two masters (MC_COMBINE_MODE, numbers in the standard's order).
    CombineMode = "MC_COMBINE_MODE" {
        /// The travels of both are added.
        Add = "mcAddAxes", 0;
        /// The travel of the second is subtracted from that of the first.
        Subtract = "mcSubAxes", 1;
    }
}

iec_enum! {
    /// What triggers a touch probe (MC_TRIGGER_REF, vendor specific): an edge at one of the probe inputs of the
    /// axis's drive.
    Trigger = "MC_TRIGGER_REF" {
        /// The first probe, from FALSE to TRUE.
        Probe1Rising = "mcProbe1Rising", 0;
        /// The first probe, from TRUE to FALSE.
        Probe1Falling = "mcProbe1Falling", 1;
        /// The second probe, from FALSE to TRUE.
        Probe2Rising = "mcProbe2Rising", 2;
        /// The second probe, from TRUE to FALSE.
        Probe2Falling = "mcProbe2Falling", 3;
    }
}

impl Trigger {
    /// The probe, counted from 0, and the edge.
    pub const fn source(self) -> (usize, Edge) {
        match self {
            Self::Probe1Rising => (0, Edge::Rising),
            Self::Probe1Falling => (0, Edge::Falling),
            Self::Probe2Rising => (1, Edge::Rising),
            Self::Probe2Falling => (1, Edge::Falling),
        }
    }
}

/// The largest number of commands that can wait behind the active one; the configured queue is at most
/// this.
pub const QUEUE_MAX: usize = 16;

/// The dynamic values at a block's pins, unchecked. For `acceleration`, `deceleration`, `jerk` and `snap`
/// 0 takes the axis default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Dynamics {
    /// Velocity (u/s).
    pub velocity: f64,
    /// Acceleration (u/s^2).
    pub acceleration: f64,
    /// Deceleration (u/s^2).
    pub deceleration: f64,
    /// Jerk (u/s^3).
    pub jerk: f64,
    /// Snap (u/s^4), a vendor pin.
    pub snap: f64,
}

/// A command for an axis: values at the pins, unchecked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command {
    /// To an absolute position; the velocity must be positive.
    MoveAbsolute {
        /// Target (u).
        position: f64,
        /// Dynamic values.
        dynamics: Dynamics,
        /// Direction on a modulo axis; ignored on a linear one.
        direction: Raw<Direction>,
    },
    /// By a distance from the set position at the start; the velocity must be positive.
    MoveRelative {
        /// Distance (u), signed.
        distance: f64,
        /// Dynamic values.
        dynamics: Dynamics,
    },
    /// By a distance from the last commanded target, or from the set position if there is none; the
    /// velocity must be positive.
    MoveAdditive {
        /// Distance (u), signed.
        distance: f64,
        /// Dynamic values.
        dynamics: Dynamics,
    },
    /// To an absolute position, and from there on without end; the velocity must be positive.
    MoveContinuousAbsolute {
        /// Target (u).
        position: f64,
        /// Velocity at the target and after it (u/s), signed.
        end_velocity: f64,
        /// Dynamic values.
        dynamics: Dynamics,
        /// Direction on a modulo axis; ignored on a linear one.
        direction: Raw<Direction>,
    },
    /// The same by a distance from the set position at the start.
    MoveContinuousRelative {
        /// Distance (u), signed.
        distance: f64,
        /// Velocity at the target and from there on (u/s), signed.
        end_velocity: f64,
        /// Dynamic values.
        dynamics: Dynamics,
    },
    /// To an endless motion.
    MoveVelocity {
        /// Dynamic values; the velocity is signed, 0 allowed.
        dynamics: Dynamics,
        /// Its sign multiplies that of the velocity (V3).
        direction: Raw<Direction>,
    },
    /// Holds a torque within velocity and acceleration limits, instead of moving to a place; a velocity
    /// of 0 takes the axis limit.
    Torque {
        /// Torque to hold, in the drive's unit, signed.
        torque: f64,
        /// Its largest change per second; 0 for no limit.
        ramp: f64,
        /// Dynamic values.
        dynamics: Dynamics,
        /// Its sign multiplies that of the torque.
        direction: Raw<Direction>,
    },
    /// MC_Jog: starts an endless motion, or moves by a distance; the velocity must be positive.
    Jog {
        /// Towards larger positions.
        forward: bool,
        /// Distance (u), not negative; 0 for an endless motion.
        distance: f64,
        /// Dynamic values.
        dynamics: Dynamics,
    },
    /// To velocity zero; other commands may interrupt it. The velocity of `dynamics` is not read.
    Halt {
        /// Dynamic values.
        dynamics: Dynamics,
    },
    /// To velocity zero; locks the axis until it is released. The velocity of `dynamics` is not read.
    Stop {
        /// Dynamic values.
        dynamics: Dynamics,
    },
    /// MC_Home: the reference gets the position `position`.
    Home {
        /// Position of the reference (u).
        position: f64,
    },
    /// MC_GearIn and MC_GearInPos: follows a master. Give this command through [`couple`](crate::couple()),
    /// which sees both axes.
    GearIn {
        /// The master, and how it is followed.
        followed: Followed,
        /// MC_GearInPos: the sync positions. None for MC_GearIn, which takes the positions at which it
        /// comes into gear.
        sync: Option<SyncPoint>,
        /// Dynamic values until the slave is in gear. The velocity is read only with a sync point; 0
        /// takes the axis limit.
        dynamics: Dynamics,
    },
    /// MC_CombineAxes: follows the sum or the difference of two masters, each after its gear ratio. Give it
    /// through [`couple`](crate::couple()).
    CombineAxes {
        /// The masters, and how each is followed.
        masters: [Followed; 2],
        /// Whether the travel of the second is added or subtracted.
        mode: Raw<CombineMode>,
    },
    /// MC_GearOut: no longer follows its master; keeps the velocity.
    GearOut,
    /// MC_CamIn: follows a master on a cam. Give it through [`couple`](crate::couple()).
    CamIn(CamIn),
    /// MC_CamOut: leaves its cam and keeps the velocity.
    CamOut,
}

/// MC_CamIn: values at the pins, unchecked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CamIn {
    /// The master.
    pub master: Master,
    /// The followed values of the master.
    pub source: Raw<ValueSource>,
    /// The cam.
    pub table: CamId,
    /// Where the cam lies.
    pub start_mode: Raw<StartMode>,
    /// The place of the master where the cam's place 0 is (u of the master).
    pub master_offset: f64,
    /// The place of the slave where the cam's place 0 is (u).
    pub slave_offset: f64,
    /// Factor of the lengths on the master's side of the cam.
    pub master_scaling: f64,
    /// The slave's side.
    pub slave_scaling: f64,
    /// Distance of the master before the sync position at which the slave starts (u of the master).
    pub start_distance: f64,
    /// The place on the cam where the slave is in sync first (u of the cam's master side); 0 leaves it
    /// open.
    pub sync_position: f64,
    /// The place on the previous cam where this one takes over (u of that cam's master side); 0 for its
    /// end.
    pub switch_at: f64,
}

impl CamIn {
    /// All values except the master, as bits.
    fn bits(&self) -> ([u64; 7], [i64; 3]) {
        let values = [
            self.master_offset,
            self.slave_offset,
            self.master_scaling,
            self.slave_scaling,
            self.start_distance,
            self.sync_position,
            self.switch_at,
        ];
        let numbers = [
            i64::from(self.source.number()),
            i64::from(self.start_mode.number()),
            i64::from(self.table.number()),
        ];
        (values.map(f64::to_bits), numbers)
    }
}

/// How a master is followed: values at the pins, unchecked.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Followed {
    /// The master.
    pub master: Master,
    /// Gear ratio, travel of the slave per travel of the master: numerator, signed, 0 allowed.
    pub numerator: i16,
    /// Denominator, above 0.
    pub denominator: i32,
    /// The followed values of the master.
    pub source: Raw<ValueSource>,
}

impl Followed {
    /// All but the master.
    fn values(&self) -> [i32; 3] {
        [self.numerator.into(), self.denominator, self.source.number()]
    }
}

/// A master as a command names it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Master {
    /// The axis.
    pub axis: AxisId,
    /// The length of its turn (u), if it has turns.
    pub turn: Option<f64>,
}

/// The sync positions of a master and its slave, and the approach to them: pins of MC_GearInPos.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SyncPoint {
    /// Of the master (u).
    pub master: f64,
    /// Of the slave (u).
    pub slave: f64,
    /// Which repetition of the slave's sync position, on a modulo slave.
    pub mode: Raw<SyncMode>,
    /// Distance of the master before its sync position at which the slave starts (u), with the sign of the
    /// master's direction; 0 starts at once.
    pub start_distance: f64,
}

impl Dynamics {
    /// A velocity (u/s) with the defaults of the axis.
    pub fn at(velocity: f64) -> Self {
        Self {
            velocity,
            ..Self::default()
        }
    }

    /// Those of a command that only comes to rest.
    pub fn braking(deceleration: f64, jerk: f64, snap: f64) -> Self {
        Self {
            deceleration,
            jerk,
            snap,
            ..Self::default()
        }
    }

    fn bits(&self) -> [u64; 5] {
        let values = [
            self.velocity,
            self.acceleration,
            self.deceleration,
            self.jerk,
            self.snap,
        ];
        values.map(f64::to_bits)
    }
}

impl Command {
    /// The axis is to follow a master.
    pub fn follows(&self) -> bool {
        matches!(
            self,
            Self::GearIn { .. } | Self::CombineAxes { .. } | Self::CamIn(_)
        )
    }

    /// Whether `other` has the same values, bit for bit; masters are not compared.
    pub fn is_same(&self, other: &Self) -> bool {
        let law = |command: &Self| match command {
            Self::GearIn { followed, sync, .. } => ([followed.values(), [0; 3]], 0, *sync),
            Self::CombineAxes { masters, mode } => {
                let [first, second] = masters;
                ([first.values(), second.values()], mode.number(), None)
            }
            _ => ([[0; 3]; 2], 0, None),
        };
        let cam = |command: &Self| match command {
            Self::CamIn(cam) => Some(cam.bits()),
            _ => None,
        };
        core::mem::discriminant(self) == core::mem::discriminant(other)
            && self.bits() == other.bits()
            && cam(self) == cam(other)
            && law(self) == law(other)
    }

    /// All its values: two numbers, the direction, the dynamic values.
    fn bits(&self) -> ([u64; 2], i32, [u64; 5]) {
        let none = Dynamics::default();
        let (first, second, direction, dynamics) = match self {
            Self::MoveAbsolute {
                position,
                dynamics,
                direction,
            } => (*position, 0.0, direction.number(), dynamics),
            Self::MoveContinuousAbsolute {
                position,
                end_velocity,
                dynamics,
                direction,
            } => (*position, *end_velocity, direction.number(), dynamics),
            Self::MoveRelative { distance, dynamics } | Self::MoveAdditive { distance, dynamics } => {
                (*distance, 0.0, 0, dynamics)
            }
            Self::MoveContinuousRelative {
                distance,
                end_velocity,
                dynamics,
            } => (*distance, *end_velocity, 0, dynamics),
            Self::MoveVelocity { dynamics, direction } => (0.0, 0.0, direction.number(), dynamics),
            Self::Torque {
                torque,
                ramp,
                dynamics,
                direction,
            } => (*torque, *ramp, direction.number(), dynamics),
            Self::Jog {
                forward,
                distance,
                dynamics,
            } => (*distance, 0.0, i32::from(*forward), dynamics),
            Self::Halt { dynamics } | Self::Stop { dynamics } => (0.0, 0.0, 0, dynamics),
            Self::Home { position } => (*position, 0.0, 0, &none),
            Self::GearIn { dynamics, .. } => (0.0, 0.0, 0, dynamics),
            Self::CombineAxes { .. } | Self::GearOut | Self::CamIn(_) | Self::CamOut => (0.0, 0.0, 0, &none),
        };
        ([first.to_bits(), second.to_bits()], direction, dynamics.bits())
    }
}

/// A command and its buffer mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// The command.
    pub command: Command,
    /// Its buffer mode.
    pub buffer_mode: Raw<BufferMode>,
    /// The command that the same instance gave before and that this one replaces (R32).
    pub replaces: Option<CommandId>,
}

impl Request {
    /// `command`, aborting.
    pub fn aborting(command: Command) -> Self {
        Self {
            command,
            buffer_mode: BufferMode::Aborting.into(),
            replaces: None,
        }
    }
}

/// MC_PhasingAbsolute, MC_PhasingRelative: values at the pins, unchecked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PhaseShift {
    /// The master whose place is shifted.
    pub master: AxisId,
    /// The shift (u of the master), signed; positive means ahead of its real place.
    pub shift: f64,
    /// Whether it is added to the present shift.
    pub is_relative: bool,
    /// Dynamic values of the shift (u of the master); 0 takes the part that the limits of the slave
    /// leave.
    pub dynamics: Dynamics,
    /// How it follows an earlier phasing; blending modes act as mcBuffered.
    pub buffer_mode: Raw<BufferMode>,
}

/// MC_MoveSuperimposed: values at the pins, unchecked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Superimpose {
    /// Distance to add (u), signed.
    pub distance: f64,
    /// Dynamic values of the added motion; the velocity (VelocityDiff) must be positive.
    pub dynamics: Dynamics,
}

impl Superimpose {
    /// Whether `other` has the same values, bit for bit.
    pub fn is_same(&self, other: &Self) -> bool {
        self.distance.to_bits() == other.distance.to_bits() && self.dynamics.bits() == other.dynamics.bits()
    }
}

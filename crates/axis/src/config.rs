//! The configuration of an axis, checked once before the first scan.

use crate::keys::{self, Bounds, Holds};
use crate::{Homing, Procedure, QUEUE_MAX, Scaling};
use core::fmt;
use standstill_planner::shaper::{DAMPING_MAX, LONGEST_PERIOD, MODES, SHORTEST_PERIOD};
use standstill_planner::{Field, Limits, MoveProfile, PlanError, Shapers, VibrationMode};

/// What happens to a value above the axis limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum AboveLimit {
    /// It is lowered to the limit and recorded (V2).
    #[default]
    Clamp,
    /// The command is refused.
    Error,
}

/// How an axis stops when it is switched off while moving (V9a).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PowerOff {
    /// It ramps down, then power goes off.
    #[default]
    Ramp,
    /// Power goes off at once.
    Coast,
    /// The drive stops by itself.
    Drive,
}

/// The reaction of a slave in gear when its master's motion exceeds its limits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OnLimit {
    /// It lags, and catches up onto the same law as soon as it can.
    #[default]
    Lag,
    /// It is an axis error (420), raised while a stop still keeps the limits.
    Error,
    /// Once in gear, its master stays within what the slave can follow: every plan of the master keeps
    /// the limits that its slaves leave. For motions of the master without such a plan (docs/coupling.md)
    /// the slave lags.
    SlowMaster,
}

/// The reaction of a slave when the set-point of its master is no longer the result of a plan.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OnMasterLost {
    /// It is an axis error (421).
    #[default]
    Error,
    /// It comes to rest with the stop dynamics and stays coupled at rest, until a block couples it anew.
    Hold,
}

/// The behaviour of a held jog at a software limit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum JogAtLimit {
    /// It continues towards the limit, and the axis stops before it with an error.
    #[default]
    Error,
    /// It comes to rest on the limit and stays there while the button is held.
    Stop,
}

/// The treatment of an absolute target outside the first turn of a modulo axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ModuloTargets {
    /// The move is refused (119).
    #[default]
    Error,
    /// It is brought into the first turn: 370 of 360 degrees is 10.
    Wrap,
}

/// The effect of a rising edge of Execute while the instance is Busy.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EdgeWhileBusy {
    /// It starts the command again, with the values at the pins.
    #[default]
    Restart,
    /// No effect: the instance continues its command.
    Ignore,
}

/// Dynamics of stops alone; each may be above the limit of the axis. `None` takes that limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StopLimits {
    /// Deceleration (u/s^2).
    pub deceleration: Option<f64>,
    /// Jerk (u/s^3).
    pub jerk: Option<f64>,
    /// Snap (u/s^4).
    pub snap: Option<f64>,
}

/// How an axis follows another one, and how others follow its actual values.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Following {
    /// The reaction when it cannot keep up.
    pub on_limit: OnLimit,
    /// The largest distance from the law once it was in gear (u). Beyond it is an axis error (420);
    /// `None` for no limit.
    pub max_deviation: Option<f64>,
    /// The reaction when its master goes out of operation.
    pub on_master_lost: OnMasterLost,
    /// As a master of actual values: scans per average of the four that filter its position for slaves,
    /// at most [`ACTUAL_FILTER_MAX`]; 0 for no filter.
    pub actual_filter: u32,
    /// As a master of actual values: whether its slaves see it ahead by the delay of the filter at its
    /// present velocity.
    pub actual_lead: bool,
    /// The number of derivatives of a cam that must be continuous, at most [`CAM_CONTINUITY_MAX`]; `None`
    /// for its order: 3 with a snap limit, 2 with a jerk limit, 1 without. If the order is higher than
    /// this number, it comes to rest at the rows where a derivative jumps.
    pub cam_continuity: Option<u8>,
}

/// Longest average of the filter of actual values (scans). For each of them the ring takes 16 bytes of
/// every axis.
pub const ACTUAL_FILTER_MAX: u32 = 64;

/// The largest number of derivatives of a cam that can be required to be continuous.
pub const CAM_CONTINUITY_MAX: u8 = 3;

impl Default for Following {
    fn default() -> Self {
        Self::DEFAULT
    }
}

impl Following {
    /// It lags as far as necessary; a lost master is an error; averages of 16 scans, without lead; cams
    /// as smooth as its order.
    pub const DEFAULT: Self = Self {
        on_limit: OnLimit::Lag,
        max_deviation: None,
        on_master_lost: OnMasterLost::Error,
        actual_filter: 16,
        actual_lead: false,
        cam_continuity: None,
    };
}

/// The state an axis starts in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StartState {
    /// Power off.
    #[default]
    Disabled,
    /// Powered, as if MC_Power had been called.
    Standstill,
}

/// The meaning of 0 at a pin; `None` takes the limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Defaults {
    /// Acceleration (u/s^2).
    pub acceleration: Option<f64>,
    /// Deceleration (u/s^2).
    pub deceleration: Option<f64>,
    /// Jerk (u/s^3).
    pub jerk: Option<f64>,
    /// Snap (u/s^4).
    pub snap: Option<f64>,
}

/// The window a move ends in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InPosition {
    /// Largest distance between actual position and set position (u).
    pub window: f64,
    /// Scans the actual position stays inside before the move is done; 0 for the first scan inside.
    pub scans: u32,
}

/// Everything about an axis that does not change while it runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisConfig {
    /// Limits of all set-points.
    pub limits: Limits,
    /// Limits of commands, each at most the limit of the axis, until MC_WriteParameter changes them;
    /// `None` for the limits of the axis.
    pub application_limits: Option<Limits>,
    /// The meaning of 0 at a pin.
    pub defaults: Defaults,
    /// Position at the start (u).
    pub position: f64,
    /// State at the start.
    pub start: StartState,
    /// Drive increments, or `None` if the drive uses user units.
    pub scaling: Option<Scaling>,
    /// Length of one turn (u): positions are in [0, this) and wrap. `None` for a linear axis.
    pub modulo: Option<f64>,
    /// Lowest and highest position (u) a move may end at.
    pub software_limits: Option<(f64, f64)>,
    /// The treatment of values above the limits.
    pub above_limit: AboveLimit,
    /// How moves to a position are planned.
    pub profile: MoveProfile,
    /// Commands that can wait, the active one not counted; at most [`QUEUE_MAX`].
    pub queue: usize,
    /// Deceleration of ramps without a command (u/s^2); `None` takes the limit.
    pub stop_deceleration: Option<f64>,
    /// Jerk of ramps without a command (u/s^3); `None` takes the limit.
    pub stop_jerk: Option<f64>,
    /// Dynamics of MC_Stop and of ramps without a command. They may exceed the limits;
    /// `stop_deceleration` and `stop_jerk` are then `None`.
    pub stop: Option<StopLimits>,
    /// How the axis stops when switched off while moving.
    pub on_power_off: PowerOff,
    /// What MC_Home does.
    pub homing: Homing,
    /// The axis stops at the hardware limit switches of its drive.
    pub hardware_limits: bool,
    /// Absolute moves need MC_Home first (V11a).
    pub needs_homed: bool,
    /// Largest factor MC_SetOverride takes, at least 1. The limits also apply to factors above 1 (V16).
    pub override_max: f64,
    /// Scans from the first request for power to its confirmation by the drive, at least 1. If it takes
    /// longer, MC_Power has an error (503), and power is no longer requested. `None` for no time-out.
    pub power_timeout: Option<u64>,
    /// Largest following error (u); a larger one is an axis error. `None` if it is not supervised.
    pub max_following_error: Option<f64>,
    /// A move to rest is done when the actual position has been in this window (V12d); `None` if the set position
    /// decides alone.
    pub in_position: Option<InPosition>,
    /// How it follows another axis.
    pub following: Following,
    /// What a held jog does at a software limit.
    pub jog_at_limit: JogAtLimit,
    /// The treatment of absolute targets outside the first turn.
    pub modulo_targets: ModuloTargets,
    /// What a rising edge of Execute does while the instance is Busy.
    pub edge_while_busy: EdgeWhileBusy,
    /// The vibration modes of its load, and the shaper against each.
    pub vibration: [Option<VibrationMode>; MODES],
}

impl AxisConfig {
    /// An axis at 0 within `limits`, with defaults for everything else.
    pub const fn new(limits: Limits) -> Self {
        Self {
            limits,
            application_limits: None,
            defaults: Defaults {
                acceleration: None,
                deceleration: None,
                jerk: None,
                snap: None,
            },
            position: 0.0,
            start: StartState::Disabled,
            scaling: None,
            modulo: None,
            software_limits: None,
            above_limit: AboveLimit::Clamp,
            profile: MoveProfile::Overlapped,
            queue: 8,
            stop_deceleration: None,
            stop_jerk: None,
            stop: None,
            on_power_off: PowerOff::Ramp,
            homing: Homing::DIRECT,
            hardware_limits: true,
            needs_homed: false,
            override_max: 1.0,
            power_timeout: None,
            max_following_error: None,
            in_position: None,
            following: Following::DEFAULT,
            jog_at_limit: JogAtLimit::Error,
            modulo_targets: ModuloTargets::Error,
            edge_while_busy: EdgeWhileBusy::Restart,
            vibration: [None; MODES],
        }
    }

    /// Checks every value.
    ///
    /// # Errors
    /// [`ConfigError`] names the first invalid key, with its value.
    pub fn check(&self) -> Result<(), ConfigError> {
        self.check_positive()?;
        let application = |part: fn(&Limits) -> f64| self.application_limits.as_ref().map(part);
        let above = [
            (
                "defaults.acceleration",
                self.defaults.acceleration,
                self.limits.acceleration,
            ),
            (
                "defaults.deceleration",
                self.defaults.deceleration,
                self.limits.deceleration,
            ),
            ("defaults.jerk", self.defaults.jerk, self.limits.jerk),
            ("defaults.snap", self.defaults.snap, self.limits.snap),
            (
                "stop_deceleration",
                self.stop_deceleration,
                self.limits.deceleration,
            ),
            ("stop_jerk", self.stop_jerk, self.limits.jerk),
            (
                "application_limits.velocity",
                application(|it| it.velocity),
                self.limits.velocity,
            ),
            (
                "application_limits.acceleration",
                application(|it| it.acceleration),
                self.limits.acceleration,
            ),
            (
                "application_limits.deceleration",
                application(|it| it.deceleration),
                self.limits.deceleration,
            ),
            (
                "application_limits.jerk",
                application(|it| it.jerk),
                self.limits.jerk,
            ),
            (
                "application_limits.snap",
                application(|it| it.snap),
                self.limits.snap,
            ),
        ];
        for (key, value, limit) in above {
            if let Some(value) = value
                && value > limit
            {
                return Err(ConfigError::AboveLimit { key, value, limit });
            }
        }
        if self.stop.is_some() && (self.stop_deceleration.is_some() || self.stop_jerk.is_some()) {
            return Err(ConfigError::StopTwice);
        }
        let Limits {
            acceleration,
            deceleration,
            ..
        } = self.limits;
        if self.vibration.iter().any(Option::is_some) && acceleration != deceleration {
            return Err(ConfigError::VibrationRates {
                acceleration,
                deceleration,
            });
        }
        if !(self.override_max >= 1.0 && self.override_max.is_finite()) {
            return Err(ConfigError::OverrideMax {
                value: self.override_max,
            });
        }
        if self.power_timeout == Some(0) {
            return Err(ConfigError::NotPositive {
                key: "power_timeout",
                value: 0.0,
            });
        }
        if !self.position.is_finite() {
            return Err(ConfigError::NotFinite {
                key: "position",
                value: self.position,
            });
        }
        if let Some(length) = self.modulo {
            self.check_modulo(length)?;
        }
        if let Some((min, max)) = self.software_limits {
            for (key, value) in [("software_limits.min", min), ("software_limits.max", max)] {
                if value.is_nan() {
                    return Err(ConfigError::NotFinite { key, value });
                }
            }
            if !(min < max) {
                return Err(ConfigError::SoftwareLimits { min, max });
            }
        }
        let filter = self.following.actual_filter;
        if filter > ACTUAL_FILTER_MAX {
            return Err(ConfigError::ActualFilter { value: filter });
        }
        if filter == 0 && self.scaling.is_some() && self.limits.snap.is_finite() {
            return Err(ConfigError::ActualFilterOff {
                snap: self.limits.snap,
            });
        }
        if let Some(value) = self.following.cam_continuity
            && value > CAM_CONTINUITY_MAX
        {
            return Err(ConfigError::CamContinuity { value });
        }
        if self.queue > QUEUE_MAX {
            return Err(ConfigError::Queue { value: self.queue });
        }
        self.homing.check(&self.limits)?;
        if self.homing.procedure == Procedure::Drive && self.scaling.is_none() {
            return Err(ConfigError::HomingMissing {
                key: "scaling",
                procedure: Procedure::Drive,
            });
        }
        self.check_profile()
    }

    /// Checks the values that depend on the sample time (s).
    ///
    /// # Errors
    /// [`ConfigError::Vibration`] names the first mode that is not usable.
    pub fn check_cycle(&self, cycle: f64) -> Result<(), ConfigError> {
        Shapers::new(&self.vibration, cycle)
            .map(|_| ())
            .map_err(|(place, error)| ConfigError::Vibration { place, error })
    }

    /// Refuses numbers that must be above 0 and are not. `homing` checks its own numbers, because some of them have
    /// no meaning for other procedures.
    fn check_positive(&self) -> Result<(), ConfigError> {
        let mut wrong = Ok(());
        keys::AXIS.each(&mut |key| {
            if let Holds::Number { bounds, get, .. } = key.holds
                && bounds == Bounds::POSITIVE
                && !key.path.starts_with("homing.")
                && let Some(value) = get(self).filter(|value| !bounds.hold(*value))
                && wrong.is_ok()
            {
                wrong = Err(ConfigError::NotPositive { key: key.path, value });
            }
        });
        wrong
    }

    /// Refuses a profile that is useless for the axis, because it cannot keep one of its limits.
    fn check_profile(&self) -> Result<(), ConfigError> {
        let snap = ("limits.snap", self.limits.snap);
        let jerk = ("limits.jerk", self.limits.jerk);
        let unkept: &[_] = match self.profile {
            MoveProfile::SCurve | MoveProfile::ShortPath => &[snap],
            MoveProfile::Trapezoid => &[snap, jerk],
            MoveProfile::Overlapped
            | MoveProfile::Grid
            | MoveProfile::Sequential
            | MoveProfile::Online
            | MoveProfile::Fastest => &[],
        };
        match unkept.iter().find(|(_, limit)| limit.is_finite()) {
            Some((key, limit)) => Err(ConfigError::Profile {
                profile: self.profile,
                key,
                limit: *limit,
            }),
            None => Ok(()),
        }
    }

    fn check_modulo(&self, length: f64) -> Result<(), ConfigError> {
        if !(length > 0.0 && length <= MODULO_MAX) {
            return Err(ConfigError::Modulo { value: length });
        }
        if !(self.position >= 0.0 && self.position < length) {
            return Err(ConfigError::PositionOutsideModulo {
                value: self.position,
                length,
            });
        }
        if self.software_limits.is_some() {
            return Err(ConfigError::ModuloWithSoftwareLimits);
        }
        if self.scaling.is_some_and(|scaling| scaling.turn(length).is_none()) {
            return Err(ConfigError::ModuloNotRational { value: length });
        }
        Ok(())
    }
}

/// Longest turn (u): beyond it positions resolve no better than a whole unit.
pub const MODULO_MAX: f64 = 9_007_199_254_740_992.0;

/// The reason why an axis was not set up.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum ConfigError {
    /// A value that must be positive is not, or is infinite where a number is needed.
    NotPositive {
        /// The configuration key.
        key: &'static str,
        /// Its value.
        value: f64,
    },
    /// A value that must be finite is not.
    NotFinite {
        /// The configuration key.
        key: &'static str,
        /// Its value.
        value: f64,
    },
    /// A default or stop value is above the limit of the axis.
    AboveLimit {
        /// The configuration key.
        key: &'static str,
        /// Its value.
        value: f64,
        /// The limit.
        limit: f64,
    },
    /// A mode of `vibration` that can't be shaped at the sample time.
    Vibration {
        /// Its position in the list.
        place: usize,
        /// The fault.
        error: PlanError,
    },
    /// `vibration` with two rates: in a mean of both directions of motion neither would be kept.
    VibrationRates {
        /// The acceleration limit (u/s^2).
        acceleration: f64,
        /// The deceleration limit (u/s^2).
        deceleration: f64,
    },
    /// `stop` beside `stop_deceleration` or `stop_jerk`.
    StopTwice,
    /// The lower software limit is not below the upper one.
    SoftwareLimits {
        /// Lower limit (u).
        min: f64,
        /// Upper limit (u).
        max: f64,
    },
    /// A turn that is not above 0, or longer than [`MODULO_MAX`].
    Modulo {
        /// Length (u).
        value: f64,
    },
    /// The start position is not in the first turn.
    PositionOutsideModulo {
        /// Position (u).
        value: f64,
        /// Length of a turn (u).
        length: f64,
    },
    /// Software limits on a modulo axis.
    ModuloWithSoftwareLimits,
    /// A turn cannot be written as a fraction of drive increments with parts below 2^63.
    ModuloNotRational {
        /// Length (u).
        value: f64,
    },
    /// More derivatives of a cam are required to be continuous than are checked.
    CamContinuity {
        /// So many.
        value: u8,
    },
    /// An average of actual values is longer than [`ACTUAL_FILTER_MAX`].
    ActualFilter {
        /// The configured number of scans.
        value: u32,
    },
    /// The filter is off for an axis that counts increments and has a snap limit, which a single
    /// increment exceeds.
    ActualFilterOff {
        /// The limit (u/s^4).
        snap: f64,
    },
    /// The queue is longer than [`QUEUE_MAX`].
    Queue {
        /// The configured number of places.
        value: usize,
    },
    /// The largest override factor is below 1 or not finite.
    OverrideMax {
        /// The factor.
        value: f64,
    },
    /// The profile cannot keep a limit of the axis.
    Profile {
        /// The configured profile.
        profile: MoveProfile,
        /// The configuration key of the limit.
        key: &'static str,
        /// The limit.
        limit: f64,
    },
    /// A key of `homing` that its procedure does not use.
    HomingKey {
        /// The configuration key.
        key: &'static str,
        /// The procedure.
        procedure: Procedure,
    },
    /// A velocity of `homing` that must not be above that of the search.
    HomingFaster {
        /// The configuration key.
        key: &'static str,
        /// Its value.
        value: f64,
        /// Velocity of the search (u/s).
        search: f64,
    },
    /// A key of `homing` that its procedure needs is missing.
    HomingMissing {
        /// The configuration key.
        key: &'static str,
        /// The procedure.
        procedure: Procedure,
    },
    /// A ratio of zero, or an offset that is not finite.
    Scaling {
        /// Drive increments.
        increments: u32,
        /// User units.
        units: u32,
        /// Position at increment 0 (u).
        offset: f64,
    },
}

impl ConfigError {
    /// The configuration key it refers to.
    pub const fn key(&self) -> &'static str {
        match self {
            Self::NotPositive { key, .. }
            | Self::NotFinite { key, .. }
            | Self::AboveLimit { key, .. }
            | Self::HomingFaster { key, .. }
            | Self::HomingKey { key, .. } => key,
            Self::HomingMissing { .. } => "homing",
            Self::Vibration { place, error } => vibration_key(*place, error),
            Self::VibrationRates { .. } => "limits.deceleration",
            Self::StopTwice => "stop",
            Self::SoftwareLimits { .. } => "software_limits",
            Self::Modulo { .. } | Self::ModuloNotRational { .. } => "modulo",
            Self::PositionOutsideModulo { .. } => "position",
            Self::ModuloWithSoftwareLimits => "software_limits",
            Self::ActualFilter { .. } | Self::ActualFilterOff { .. } => "coupling.actual_filter",
            Self::CamContinuity { .. } => "coupling.cam_continuity",
            Self::Queue { .. } => "queue",
            Self::OverrideMax { .. } => "override_max",
            Self::Profile { .. } => "profile",
            Self::Scaling { .. } => "scaling",
        }
    }
}

/// The key for a fault of a mode.
const fn vibration_key(place: usize, error: &PlanError) -> &'static str {
    match (error, place) {
        (
            PlanError::InvalidInput {
                field: Field::Damping,
                ..
            }
            | PlanError::OutOfRange {
                field: Field::Damping,
                ..
            },
            0,
        ) => "vibration.0.damping",
        (
            PlanError::InvalidInput {
                field: Field::Damping,
                ..
            }
            | PlanError::OutOfRange {
                field: Field::Damping,
                ..
            },
            _,
        ) => "vibration.1.damping",
        (_, 0) => "vibration.0.frequency",
        (_, _) => "vibration.1.frequency",
    }
}

fn vibration_fault(f: &mut fmt::Formatter<'_>, place: usize, error: &PlanError) -> fmt::Result {
    let key = vibration_key(place, error);
    match error {
        PlanError::OutOfRange {
            field: Field::Damping,
            value,
            ..
        } => {
            write!(
                f,
                "{key} is {value:?}: a damping ratio is from 0 to {DAMPING_MAX}"
            )
        }
        PlanError::OutOfRange { value, nearest, .. } => write!(
            f,
            "{key} is {value:?}: a period takes from {SHORTEST_PERIOD} to {LONGEST_PERIOD} cycles, so the nearest frequency is {nearest:?}; a shorter or longer cycle moves the range"
        ),
        PlanError::InvalidInput { value, .. } => {
            write!(f, "{key} is {value:?}: it must be a finite number above 0")
        }
        other => write!(f, "{key}: {other}"),
    }
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotPositive { key, value } => {
                let absent = match key.rsplit('.').next() {
                    Some("jerk" | "snap" | "max_deviation" | "max_following_error" | "power_timeout") => {
                        "; leave it out for no limit"
                    }
                    Some("deceleration") => "; leave it out for its default",
                    _ => "",
                };
                write!(
                    f,
                    "{key} is {value:?}: it must be a finite number above 0{absent}"
                )
            }
            Self::NotFinite { key, value } => write!(f, "{key} is {value:?}: it must be a finite number"),
            Self::AboveLimit { key, value, limit } => {
                write!(
                    f,
                    "{key} is {value:?}, above the axis limit {limit:?}: lower it or raise the limit"
                )
            }
            Self::Vibration { place, error } => vibration_fault(f, place, &error),
            Self::VibrationRates {
                acceleration,
                deceleration,
            } => write!(
                f,
                "limits.deceleration is {deceleration:?} and limits.acceleration {acceleration:?}: an axis with vibration has one rate, so give both the lower one; commands may have two"
            ),
            Self::StopTwice => write!(
                f,
                "stop beside stop_deceleration or stop_jerk: say in stop alone how the axis stops"
            ),
            Self::SoftwareLimits { min, max } => {
                write!(
                    f,
                    "software_limits.min is {min:?} and max {max:?}: min must be below max"
                )
            }
            Self::Modulo { value } => write!(
                f,
                "modulo is {value:?}: the length of a turn must be above 0 and at most {MODULO_MAX:?}"
            ),
            Self::PositionOutsideModulo { value, length } => write!(
                f,
                "position is {value:?}: on a modulo axis it must be from 0 to below the length of a turn, {length:?}"
            ),
            Self::ModuloWithSoftwareLimits => write!(
                f,
                "software_limits on a modulo axis: its positions come round, so nothing lies outside; leave them out, or modulo"
            ),
            Self::ModuloNotRational { value } => write!(
                f,
                "modulo is {value:?}: with this scaling a turn is no fraction of increments with parts below 2^63; choose a unit of which a turn is a whole number"
            ),
            Self::CamContinuity { value } => write!(
                f,
                "coupling.cam_continuity is {value}: at most {CAM_CONTINUITY_MAX} derivatives are looked at"
            ),
            Self::ActualFilter { value } => write!(
                f,
                "coupling.actual_filter is {value} scans: at most {ACTUAL_FILTER_MAX} are averaged"
            ),
            Self::ActualFilterOff { snap } => write!(
                f,
                "coupling.actual_filter is 0 on an axis with scaling and a limits.snap of {snap:?}: a single increment is beyond that; give it some scans, 16 by default"
            ),
            Self::Queue { value } => write!(f, "queue is {value}: at most {QUEUE_MAX} commands can wait"),
            Self::OverrideMax { value } => write!(
                f,
                "override_max is {value:?}: the largest override factor must be a finite number of at least 1"
            ),
            Self::Profile { profile, key, limit } => write!(
                f,
                "profile is {}, which cannot keep {key} {limit:?}: leave that limit out or choose another profile, such as fastest",
                profile.name()
            ),
            Self::HomingKey { key, procedure } => write!(
                f,
                "{key} has no meaning with this value for the procedure {}: leave it out",
                procedure.name()
            ),
            Self::HomingFaster { key, value, search } => {
                write!(
                    f,
                    "{key} is {value:?}, above homing.velocity {search:?}: lower it"
                )
            }
            Self::HomingMissing { key, procedure } => {
                write!(f, "the procedure {} needs {key}: give it", procedure.name())
            }
            Self::Scaling {
                increments,
                units,
                offset,
            } => write!(
                f,
                "scaling is {increments} increments to {units} units with offset {offset:?}: both integers must be at least 1 and the offset finite"
            ),
        }
    }
}

impl core::error::Error for ConfigError {}

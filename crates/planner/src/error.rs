//! Why a plan was refused.

use core::fmt;

/// The input that a [`PlanError`] refers to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Field {
    /// Sample time (s).
    Cycle,
    /// Target position (u).
    Target,
    /// Start position (u).
    Position,
    /// Start velocity (u/s).
    Velocity,
    /// Start acceleration (u/s^2).
    Acceleration,
    /// Start jerk (u/s^3).
    Jerk,
    /// Velocity at the end (u/s).
    EndVelocity,
    /// Acceleration at the end (u/s^2).
    EndAcceleration,
    /// Velocity bound (u/s).
    LimitVelocity,
    /// Velocity bound towards larger positions (u/s).
    VelocityLimitPositive,
    /// Velocity bound towards smaller positions (u/s).
    VelocityLimitNegative,
    /// Acceleration bound (u/s^2).
    LimitAcceleration,
    /// Deceleration bound (u/s^2).
    LimitDeceleration,
    /// Jerk bound (u/s^3).
    LimitJerk,
    /// Snap bound (u/s^4).
    LimitSnap,
    /// Prescribed duration of a move (s).
    Duration,
    /// Share of the duration in which a timed move speeds up.
    Gamma,
    /// Share of the acceleration in which a timed move's jerk acts.
    Phi,
    /// Frequency of a mode (Hz).
    Frequency,
    /// Damping ratio of a mode.
    Damping,
}

impl Field {
    /// The name the field has on a `standstill plan` line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cycle => "Ts",
            Self::Target => "target",
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
            Self::EndVelocity => "end_velocity",
            Self::EndAcceleration => "end_acceleration",
            Self::LimitVelocity => "limits.velocity",
            Self::VelocityLimitPositive => "velocity_limits.positive",
            Self::VelocityLimitNegative => "velocity_limits.negative",
            Self::LimitAcceleration => "limits.acceleration",
            Self::LimitDeceleration => "limits.deceleration",
            Self::LimitJerk => "limits.jerk",
            Self::LimitSnap => "limits.snap",
            Self::Duration => "duration",
            Self::Gamma => "gamma",
            Self::Phi => "phi",
            Self::Frequency => "vibration.frequency",
            Self::Damping => "vibration.damping",
        }
    }
}

/// Why a plan was refused. Nothing moves on a refusal.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum PlanError {
    /// An input is NaN, infinite where a number is needed, zero or negative where it must be positive.
    InvalidInput {
        /// The input.
        field: Field,
        /// Its value.
        value: f64,
    },
    /// The move needs more scans than a plan can count.
    TooLong {
        /// The bound that makes it so long, or the target.
        field: Field,
        /// Its value.
        value: f64,
    },
    /// No bound is given, so the move would take no time.
    Unbounded,
    /// A value that does not fit the rest of the request, although another value would.
    OutOfRange {
        /// The input.
        field: Field,
        /// Its value.
        value: f64,
        /// The nearest value that fits.
        nearest: f64,
    },
    /// The goal cannot be reached with the given path.
    Unreachable {
        /// The input that is out of reach.
        field: Field,
        /// Its value.
        value: f64,
        /// The nearest value within reach.
        nearest: f64,
    },
}

impl fmt::Display for PlanError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::InvalidInput {
                field: field @ (Field::Gamma | Field::Phi),
                value,
            } => {
                write!(
                    f,
                    "{} is {value:?}: it must be above 0 and at most 0.5",
                    field.name()
                )
            }
            Self::InvalidInput { field, value } => {
                write!(
                    f,
                    "{} is {value:?}: it must be finite, and positive where it is a limit or a time",
                    field.name()
                )
            }
            Self::TooLong { field, value } => write!(
                f,
                "the move is too long for {} = {value:?}: a plan counts at most 2147483647 scans; raise the limit, shorten the move or lengthen the cycle",
                field.name()
            ),
            Self::Unbounded => write!(f, "no limit is given: give at least one"),
            Self::OutOfRange {
                field,
                value,
                nearest,
            } => {
                write!(
                    f,
                    "{} is {value:?}: the nearest that fits is {nearest:?}",
                    field.name()
                )
            }
            Self::Unreachable {
                field,
                value,
                nearest,
            } => write!(
                f,
                "{} = {value:?} cannot be reached on this way: the nearest within reach is {nearest:?}",
                field.name()
            ),
        }
    }
}

impl core::error::Error for PlanError {}

impl PlanError {
    /// A move to `target` (u) that takes more scans than a plan can count.
    pub(crate) const fn too_far(target: f64) -> Self {
        Self::TooLong {
            field: Field::Target,
            value: target,
        }
    }
}

/// The signed distance (u) from `start` to `target`, which are finite and not too far from each other.
pub(crate) const fn distance(start: f64, target: f64) -> Result<f64, PlanError> {
    let distance = target - start;
    let (field, value) = if !start.is_finite() {
        (Field::Position, start)
    } else if !distance.is_finite() {
        (Field::Target, target)
    } else {
        return Ok(distance);
    };
    Err(PlanError::InvalidInput { field, value })
}

/// Refuses a value that is not positive and finite.
pub(crate) const fn check_positive(field: Field, value: f64) -> Result<(), PlanError> {
    if value > 0.0 && value.is_finite() {
        Ok(())
    } else {
        Err(PlanError::InvalidInput { field, value })
    }
}

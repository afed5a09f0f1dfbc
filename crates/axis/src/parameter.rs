//! The parameters of an axis by number, and their values.

use crate::ErrorId;

/// A parameter of an axis, by its number: below 1000 in the standard, from 1000 on ours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parameter {
    /// 1: the set position last published (u).
    CommandedPosition = 1,
    /// 2: upper software limit (u).
    SwLimitPos,
    /// 3: lower software limit (u).
    SwLimitNeg,
    /// 4: the upper software limit is on.
    EnableLimitPos,
    /// 5: the lower software limit is on.
    EnableLimitNeg,
    /// 6: the following error is supervised.
    EnablePosLagMonitoring,
    /// 7: largest following error (u).
    MaxPositionLag,
    /// 8: velocity limit of the axis (u/s).
    MaxVelocitySystem,
    /// 9: velocity limit of the application (u/s).
    MaxVelocityAppl,
    /// 10: actual velocity (u/s).
    ActualVelocity,
    /// 11: set velocity last published (u/s).
    CommandedVelocity,
    /// 12: acceleration limit of the axis (u/s^2).
    MaxAccelerationSystem,
    /// 13: acceleration limit of the application (u/s^2).
    MaxAccelerationAppl,
    /// 14: deceleration limit of the axis (u/s^2).
    MaxDecelerationSystem,
    /// 15: deceleration limit of the application (u/s^2).
    MaxDecelerationAppl,
    /// 16: jerk limit of the axis (u/s^3).
    MaxJerkSystem,
    /// 17: jerk limit of the application (u/s^3).
    MaxJerkAppl,
    /// 1000: the drive's own code of the axis error; 0 without one.
    DriveErrorCode = 1000,
    /// 1001: following error: the set position published in the scan before, minus the actual position (u).
    PositionLag,
    /// 1002: frequency of the first mode of `vibration` (Hz); 0 without one.
    Vibration1Frequency,
    /// 1003: its damping ratio.
    Vibration1Damping,
    /// 1004: its shaper: 1 `period`, 2 `zv`, 3 `zvd`, 4 `ei`.
    Vibration1Shaper,
    /// 1005: frequency of the second mode (Hz); 0 without one.
    Vibration2Frequency,
    /// 1006: its damping ratio.
    Vibration2Damping,
    /// 1007: its shaper.
    Vibration2Shaper,
}

impl Parameter {
    /// The parameters of the standard, by number from 1.
    pub const ALL: [Self; 17] = [
        Self::CommandedPosition,
        Self::SwLimitPos,
        Self::SwLimitNeg,
        Self::EnableLimitPos,
        Self::EnableLimitNeg,
        Self::EnablePosLagMonitoring,
        Self::MaxPositionLag,
        Self::MaxVelocitySystem,
        Self::MaxVelocityAppl,
        Self::ActualVelocity,
        Self::CommandedVelocity,
        Self::MaxAccelerationSystem,
        Self::MaxAccelerationAppl,
        Self::MaxDecelerationSystem,
        Self::MaxDecelerationAppl,
        Self::MaxJerkSystem,
        Self::MaxJerkAppl,
    ];

    /// Ours, in the order of the numbers from 1000 on.
    pub const OURS: [Self; 8] = [
        Self::DriveErrorCode,
        Self::PositionLag,
        Self::Vibration1Frequency,
        Self::Vibration1Damping,
        Self::Vibration1Shaper,
        Self::Vibration2Frequency,
        Self::Vibration2Damping,
        Self::Vibration2Shaper,
    ];

    pub(crate) fn of(number: i16) -> Result<Self, ErrorId> {
        let place = |first: i16| usize::try_from(number.checked_sub(first)?).ok();
        let of_the_standard = place(1).and_then(|place| Self::ALL.get(place));
        let parameter = of_the_standard.or_else(|| place(1000).and_then(|place| Self::OURS.get(place)));
        parameter.copied().ok_or(ErrorId::ParameterNumberInvalid)
    }
}

/// The value of a parameter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ParameterValue {
    /// REAL.
    Real(f64),
    /// BOOL.
    Bool(bool),
}

impl ParameterValue {
    /// The number to show in a record.
    pub(crate) fn shown(self) -> f64 {
        match self {
            Self::Real(value) => value,
            Self::Bool(on) => f64::from(u8::from(on)),
        }
    }

    /// Its number.
    ///
    /// # Errors
    /// [`ErrorId::ParameterKindInvalid`] if it is a BOOL.
    pub(crate) fn real(self) -> Result<f64, ErrorId> {
        match self {
            Self::Real(value) => Ok(value),
            Self::Bool(_) => Err(ErrorId::ParameterKindInvalid),
        }
    }

    /// Its truth value.
    ///
    /// # Errors
    /// [`ErrorId::ParameterKindInvalid`] if it is a REAL.
    pub(crate) fn flag(self) -> Result<bool, ErrorId> {
        match self {
            Self::Bool(on) => Ok(on),
            Self::Real(_) => Err(ErrorId::ParameterKindInvalid),
        }
    }
}

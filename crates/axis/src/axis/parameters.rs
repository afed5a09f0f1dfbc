//! Parameters by number: MC_ReadParameter, MC_WriteParameter and their BOOL variants.
//!
//! The system values are those of the configuration and never change. The application may set lower limits, and move
//! the software limits. New values apply to commands accepted later. Software limits also apply to the motion in
//! progress: a motion that would leave them is watched. It ends in ErrorStop: in time for the stop dynamics to keep
//! it inside, or at once if that is no longer possible.
//!
//! Source: PLCopen Motion Control Part 1, sections of the four blocks and the list of parameters.

use super::Axis;
use super::commands::{Work, Write};
use super::supervision::Lag;
use crate::{AxisConfig, CommandId, ErrorId, ExecutionMode, Parameter, ParameterValue, Raw, Scope};
use standstill_planner::shaper::MODES;
use standstill_planner::{Limits, PlanError, Planner, ShaperKind, Shapers, VibrationMode};

/// The reason why a parameter was not written: the pin, and the violated limit.
#[derive(Clone, Copy, Debug)]
struct Unwritten {
    pin: &'static str,
    limit: f64,
    error: ErrorId,
}

impl From<ErrorId> for Unwritten {
    /// The number is not valid for the value.
    fn from(error: ErrorId) -> Self {
        Self::number(error)
    }
}

impl Unwritten {
    /// The number is not valid.
    const fn number(error: ErrorId) -> Self {
        Self {
            pin: "ParameterNumber",
            limit: f64::NAN,
            error,
        }
    }

    /// The value is not valid.
    const fn value(limit: f64, error: ErrorId) -> Self {
        Self {
            pin: "Value",
            limit,
            error,
        }
    }
}

/// The parameters that an application can write.
#[derive(Clone, Copy, Debug)]
pub(super) struct Parameters {
    /// Limits for the commands of the application; at most those of the axis.
    pub limits: Limits,
    /// Lowest and highest end position (u) of a move, infinite if that side is off; `None` without both.
    pub software_limits: Option<(f64, f64)>,
    /// Supervision of the following error.
    pub lag: Lag,
    /// The vibration modes of the load.
    pub modes: [Option<VibrationMode>; MODES],
    /// Lower and upper software limit (u), infinite if never given, and whether it is on.
    lower: (f64, bool),
    upper: (f64, bool),
}

impl Parameters {
    pub fn new(config: &AxisConfig) -> Self {
        let (min, max) = config
            .software_limits
            .unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        Self {
            limits: config.application_limits.unwrap_or(config.limits),
            software_limits: config.software_limits,
            lag: Lag::new(config.max_following_error),
            modes: config.vibration,
            lower: (min, min.is_finite()),
            upper: (max, max.is_finite()),
        }
    }

    /// As bits, for comparing.
    pub fn bits(&self) -> [u64; 16] {
        let Limits {
            velocity,
            acceleration,
            deceleration,
            jerk,
            ..
        } = self.limits;
        let flag = |on: bool| f64::from(u8::from(on));
        let lag = self.lag.most;
        let (lower, upper) = (self.lower, self.upper);
        let flags = (flag(lower.1), flag(upper.1), flag(self.lag.on));
        let [first, second] = self.modes.map(numbers);
        [
            velocity,
            acceleration,
            deceleration,
            jerk,
            lower.0,
            upper.0,
            lag,
            flags.0,
            flags.1,
            flags.2,
            first[0],
            first[1],
            first[2],
            second[0],
            second[1],
            second[2],
        ]
        .map(f64::to_bits)
    }

    /// The same with a change of a software limit or of its switch.
    fn with_software_limit(mut self, change: impl FnOnce(&mut Self)) -> Result<Self, Unwritten> {
        change(&mut self);
        let side = |(at, on): (f64, bool), off: f64| if on { at } else { off };
        let min = side(self.lower, f64::NEG_INFINITY);
        let max = side(self.upper, f64::INFINITY);
        for (at, on) in [self.lower, self.upper] {
            if on && !at.is_finite() {
                return Err(Unwritten::value(at, ErrorId::ParameterMissing));
            }
        }
        if !(min < max) {
            return Err(Unwritten::value(f64::NAN, ErrorId::SoftwareLimitsCrossed));
        }
        self.software_limits = (self.lower.1 || self.upper.1).then_some((min, max));
        Ok(self)
    }
}

/// The values of a mode as its parameters; zeros without a mode.
fn numbers(mode: Option<VibrationMode>) -> [f64; 3] {
    let number = |mode: &VibrationMode| match mode.shaper {
        ShaperKind::Period => 1.0,
        ShaperKind::Zv => 2.0,
        ShaperKind::Zvd => 3.0,
        ShaperKind::Ei => 4.0,
    };
    mode.map_or([0.0; 3], |mode| [mode.frequency, mode.damping, number(&mode)])
}

/// The mode of a parameter, and the index of the parameter in it.
fn place_of(parameter: Parameter) -> (usize, usize) {
    let place = (parameter as usize).saturating_sub(Parameter::Vibration1Frequency as usize);
    (place / 3, place % 3)
}

/// A position that is finite.
fn position(value: f64) -> Result<f64, Unwritten> {
    if value.is_finite() {
        Ok(value)
    } else {
        Err(Unwritten::value(f64::NAN, ErrorId::ParameterValueInvalid))
    }
}

/// A limit above 0, not below `least`, and at most `system`.
fn limit(value: f64, least: f64, system: f64) -> Result<f64, Unwritten> {
    // NaN is not above 0.
    if !(value > 0.0) {
        return Err(Unwritten::value(0.0, ErrorId::ParameterValueInvalid));
    }
    if value > system {
        return Err(Unwritten::value(system, ErrorId::ParameterAboveSystem));
    }
    if value < least && value < system {
        return Err(Unwritten::value(least, ErrorId::MoveTooLong));
    }
    Ok(value)
}

impl<P: Planner> Axis<P> {
    /// MC_ReadParameter: the REAL parameter `number`. A missing limit reads as infinity.
    ///
    /// # Errors
    /// [`ErrorId::ParameterNumberInvalid`] if there is no such parameter,
    /// [`ErrorId::ParameterKindInvalid`] if it is a BOOL, those of [`Axis::fresh_position`] if its value
    /// is not fresh.
    pub fn real_parameter(&self, number: i16) -> Result<f64, ErrorId> {
        match self.parameter(Parameter::of(number)?)? {
            ParameterValue::Real(value) => Ok(value),
            ParameterValue::Bool(_) => Err(ErrorId::ParameterKindInvalid),
        }
    }

    /// MC_ReadBoolParameter: the BOOL parameter `number`.
    ///
    /// # Errors
    /// As [`Axis::real_parameter`], with REAL for BOOL.
    pub fn bool_parameter(&self, number: i16) -> Result<bool, ErrorId> {
        match self.parameter(Parameter::of(number)?)? {
            ParameterValue::Bool(on) => Ok(on),
            ParameterValue::Real(_) => Err(ErrorId::ParameterKindInvalid),
        }
    }

    fn parameter(&self, parameter: Parameter) -> Result<ParameterValue, ErrorId> {
        let (own, system) = (&self.parameters, &self.config.limits);
        Ok(match parameter {
            Parameter::EnableLimitPos => ParameterValue::Bool(own.upper.1),
            Parameter::EnableLimitNeg => ParameterValue::Bool(own.lower.1),
            Parameter::EnablePosLagMonitoring => ParameterValue::Bool(own.lag.on),
            Parameter::CommandedPosition => ParameterValue::Real(self.setpoint().position),
            Parameter::SwLimitPos => ParameterValue::Real(own.upper.0),
            Parameter::SwLimitNeg => ParameterValue::Real(own.lower.0),
            Parameter::MaxPositionLag => ParameterValue::Real(own.lag.most),
            Parameter::MaxVelocitySystem => ParameterValue::Real(system.velocity),
            Parameter::MaxVelocityAppl => ParameterValue::Real(own.limits.velocity),
            Parameter::ActualVelocity => ParameterValue::Real(self.actual_velocity()?),
            Parameter::CommandedVelocity => ParameterValue::Real(self.mover.commanded().velocity),
            Parameter::MaxAccelerationSystem => ParameterValue::Real(system.acceleration),
            Parameter::MaxAccelerationAppl => ParameterValue::Real(own.limits.acceleration),
            Parameter::MaxDecelerationSystem => ParameterValue::Real(system.deceleration),
            Parameter::MaxDecelerationAppl => ParameterValue::Real(own.limits.deceleration),
            Parameter::MaxJerkSystem => ParameterValue::Real(system.jerk),
            Parameter::MaxJerkAppl => ParameterValue::Real(own.limits.jerk),
            Parameter::DriveErrorCode => ParameterValue::Real(self.failure.code().into()),
            Parameter::PositionLag => {
                self.fresh_position()?;
                ParameterValue::Real(self.following_error())
            }
            Parameter::Vibration1Frequency
            | Parameter::Vibration1Damping
            | Parameter::Vibration1Shaper
            | Parameter::Vibration2Frequency
            | Parameter::Vibration2Damping
            | Parameter::Vibration2Shaper => ParameterValue::Real(self.number_of_mode(parameter)),
        })
    }

    /// MC_WriteParameter and MC_WriteBoolParameter: parameter `number` gets `value`, in every state,
    /// without changing the state. With `mcQueued` it waits like a buffered command while the axis has an
    /// owner. Its value is checked in the call, and again when it becomes active.
    ///
    /// # Errors
    /// The [`ErrorId`] the block shows: a number that is unknown, of the other kind or read-only; a value
    /// out of range; an undefined mode; a full buffer. Nothing changes then.
    pub fn write_parameter(
        &mut self,
        number: i16,
        value: ParameterValue,
        mode: Raw<ExecutionMode>,
        scope: &mut Scope<'_>,
    ) -> Result<CommandId, ErrorId> {
        let queued = self.is_queued(mode, scope)?;
        let parameter = Parameter::of(number)
            .map_err(|error| self.refuse("ParameterNumber", number.into(), f64::NAN, error, scope))?;
        if queued {
            self.written(parameter, value)
                .map_err(|why| self.refuse_write(parameter, value, why, scope))?;
            let write = Write::Parameter { parameter, value };
            return self.enqueue(Work::Write(write), scope);
        }
        self.write_now(parameter, value, scope)?;
        Ok(self.done_at_once())
    }

    /// Writes `value` to `parameter`. It was given in this scan or before.
    ///
    /// # Errors
    /// As [`Axis::write_parameter`].
    pub(super) fn write_now(
        &mut self,
        parameter: Parameter,
        value: ParameterValue,
        scope: &mut Scope<'_>,
    ) -> Result<(), ErrorId> {
        let parameters = self
            .written(parameter, value)
            .and_then(|new| self.admit_modes(new))
            .map_err(|why| self.refuse_write(parameter, value, why, scope))?;
        self.set_parameters(parameters, scope);
        Ok(())
    }

    /// `new`, unless it changes the shaper of a motion.
    fn admit_modes(&self, new: Parameters) -> Result<Parameters, Unwritten> {
        let rests = self.mover.setpoint().is_at_rest() && self.mover.is_through();
        if new.modes == self.parameters.modes || rests {
            Ok(new)
        } else {
            Err(Unwritten::value(f64::NAN, ErrorId::InMotion))
        }
    }

    fn refuse_write(
        &self,
        parameter: Parameter,
        value: ParameterValue,
        why: Unwritten,
        scope: &mut Scope<'_>,
    ) -> ErrorId {
        let shown = if why.pin == "Value" {
            value.shown()
        } else {
            f64::from(parameter as u16)
        };
        self.refuse(why.pin, shown, why.limit, why.error, scope)
    }

    /// The parameters after this one is written.
    fn written(&self, parameter: Parameter, value: ParameterValue) -> Result<Parameters, Unwritten> {
        let mut new = self.parameters;
        let system = &self.config.limits;
        let on_modulo = self.modulo.is_some();
        match parameter {
            Parameter::SwLimitPos
            | Parameter::SwLimitNeg
            | Parameter::EnableLimitPos
            | Parameter::EnableLimitNeg
                if on_modulo =>
            {
                Err(Unwritten::number(ErrorId::ParameterOnModulo))
            }
            Parameter::SwLimitPos => {
                let at = position(value.real()?)?;
                new.with_software_limit(|new| new.upper.0 = at)
            }
            Parameter::SwLimitNeg => {
                let at = position(value.real()?)?;
                new.with_software_limit(|new| new.lower.0 = at)
            }
            Parameter::EnableLimitPos => {
                let on = value.flag()?;
                new.with_software_limit(|new| new.upper.1 = on)
            }
            Parameter::EnableLimitNeg => {
                let on = value.flag()?;
                new.with_software_limit(|new| new.lower.1 = on)
            }
            Parameter::EnablePosLagMonitoring => {
                new.lag.on = value.flag()?;
                if new.lag.on && !new.lag.most.is_finite() {
                    return Err(Unwritten::value(new.lag.most, ErrorId::ParameterMissing));
                }
                Ok(new)
            }
            Parameter::MaxPositionLag => {
                new.lag.most = limit(position(value.real()?)?, 0.0, f64::INFINITY)?;
                Ok(new)
            }
            Parameter::MaxVelocityAppl => {
                new.limits.velocity = limit(value.real()?, 0.0, system.velocity)?;
                Ok(new)
            }
            Parameter::MaxAccelerationAppl => {
                let least = system.velocity / self.longest();
                new.limits.acceleration = limit(value.real()?, least, system.acceleration)?;
                Ok(new)
            }
            Parameter::MaxDecelerationAppl => {
                let least = system.velocity / self.longest();
                new.limits.deceleration = limit(value.real()?, least, system.deceleration)?;
                Ok(new)
            }
            Parameter::MaxJerkAppl => {
                let least = system.acceleration.max(system.deceleration) / self.longest();
                new.limits.jerk = limit(value.real()?, least, system.jerk)?;
                Ok(new)
            }
            Parameter::Vibration1Frequency
            | Parameter::Vibration1Damping
            | Parameter::Vibration1Shaper
            | Parameter::Vibration2Frequency
            | Parameter::Vibration2Damping
            | Parameter::Vibration2Shaper => {
                new.modes = self.modes_with(parameter, value.real()?)?;
                Ok(new)
            }
            Parameter::CommandedPosition
            | Parameter::MaxVelocitySystem
            | Parameter::ActualVelocity
            | Parameter::CommandedVelocity
            | Parameter::MaxAccelerationSystem
            | Parameter::MaxDecelerationSystem
            | Parameter::MaxJerkSystem
            | Parameter::DriveErrorCode
            | Parameter::PositionLag => {
                value.real()?;
                Err(Unwritten::number(ErrorId::ParameterReadOnly))
            }
        }
    }

    /// A value of a mode; 0 without a mode.
    fn number_of_mode(&self, parameter: Parameter) -> f64 {
        let (mode, part) = place_of(parameter);
        let mode = self.parameters.modes.get(mode).copied().flatten();
        numbers(mode).get(part).copied().unwrap_or_default()
    }

    /// The modes after one of their values is changed. The axis must be configured with that mode, and its memory
    /// must be large enough.
    fn modes_with(
        &self,
        parameter: Parameter,
        value: f64,
    ) -> Result<[Option<VibrationMode>; MODES], Unwritten> {
        let (place, part) = place_of(parameter);
        let mut modes = self.parameters.modes;
        let Some(Some(mode)) = modes.get_mut(place) else {
            return Err(Unwritten::number(ErrorId::VibrationMissing));
        };
        match part {
            0 => mode.frequency = value,
            1 => mode.damping = value,
            _ => {
                // 1 to 4; any other value is not in the list.
                let place = ShaperKind::ALL
                    .iter()
                    .zip(1_u8..)
                    .find(|(_, number)| f64::from(*number) == value);
                let Some((shaper, _)) = place else {
                    return Err(Unwritten::value(f64::NAN, ErrorId::ParameterValueInvalid));
                };
                mode.shaper = *shaper;
            }
        }
        let shapers = Shapers::new(&modes, self.planner.cycle()).map_err(|(_, error)| {
            let limit = match error {
                PlanError::OutOfRange { nearest, .. } => nearest,
                _ => f64::NAN,
            };
            Unwritten::value(limit, ErrorId::ParameterValueInvalid)
        })?;
        let set_up = self.config.vibration.get(place).copied().flatten();
        let least = set_up.map_or(f64::NAN, |mode| 0.5 * mode.frequency);
        if part == 0 && value < least {
            return Err(Unwritten::value(least, ErrorId::ParameterValueInvalid));
        }
        if !self.mover.has_history_for(&shapers) {
            return Err(Unwritten::value(f64::NAN, ErrorId::ParameterValueInvalid));
        }
        Ok(modes)
    }

    fn set_parameters(&mut self, parameters: Parameters, scope: &mut Scope<'_>) {
        if self.parameters.modes != parameters.modes
            && let Ok(shapers) = Shapers::new(&parameters.modes, self.planner.cycle())
        {
            self.mover.set_shapers(shapers);
        }
        let limits_moved = self.parameters.software_limits != parameters.software_limits;
        self.parameters = parameters;
        self.end_routine();
        if limits_moved {
            // The motion and the commands that wait were checked against the old limits.
            if self.mover.layer().is_some() {
                self.watch_anew();
            } else {
                self.mover
                    .watch(self.owner.is_some() && self.parameters.software_limits.is_some());
            }
            self.arm_anew(scope);
        }
    }
}

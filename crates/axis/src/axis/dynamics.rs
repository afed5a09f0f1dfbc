//! Converts the values at a block's pins to the limits of a motion.
//!
//! One rule applies to Acceleration, Deceleration, Jerk and Snap. 0 takes the axis default, which is the
//! axis limit unless configured. If both are missing, jerk and snap are unlimited and acceleration is an
//! error. Values above the limit are clamped and recorded, or refused (V2).

use super::Axis;
use crate::{AboveLimit, Defaults, Dynamics, ErrorId, Event, IecEnum, Raw, Scope, StopLimits};
use standstill_planner::{Limits, Planner};

/// The largest number of scans that a rate may take from 0 to its limit. A lower rate is useless, and its
/// motion could not be stopped in a countable number of scans.
const LONGEST: f64 = 268_435_456.0;

/// A pin that carries a magnitude.
struct Magnitude {
    pin: &'static str,
    value: f64,
    default: Option<f64>,
    limit: f64,
    /// The lowest useful value other than 0.
    least: f64,
    invalid: ErrorId,
    /// The error if 0 has no default; `None` means unlimited.
    missing: Option<ErrorId>,
    above: ErrorId,
}

/// `limits` of a motion, but with the larger values of the pins. The override needs the values as given, because it
/// applies the limits in force at its time. Snap has no factor.
pub(super) fn as_given(pins: &Dynamics, limits: &Limits) -> Limits {
    limits.or_larger(&Limits {
        velocity: pins.velocity.abs(),
        acceleration: pins.acceleration,
        deceleration: pins.deceleration,
        jerk: pins.jerk,
        snap: limits.snap,
    })
}

impl<P: Planner> Axis<P> {
    /// Limits of a motion. The velocity is that of the axis; positioning moves lower it.
    pub(super) fn resolve(&self, dynamics: &Dynamics, scope: &mut Scope<'_>) -> Result<Limits, ErrorId> {
        self.resolve_within(&self.parameters.limits, &self.config.defaults, dynamics, scope)
    }

    /// The same for MC_Stop, which uses the dynamics of stops if the axis has its own.
    pub(super) fn resolve_stop(&self, dynamics: &Dynamics, scope: &mut Scope<'_>) -> Result<Limits, ErrorId> {
        if self.config.stop.is_none() {
            return self.resolve(dynamics, scope);
        }
        let limits = Limits {
            acceleration: self.parameters.limits.acceleration,
            velocity: self.parameters.limits.velocity,
            ..self.stop_limits()
        };
        self.resolve_within(&limits, &Defaults::default(), dynamics, scope)
    }

    fn resolve_within(
        &self,
        limits: &Limits,
        defaults: &Defaults,
        dynamics: &Dynamics,
        scope: &mut Scope<'_>,
    ) -> Result<Limits, ErrorId> {
        let longest = self.longest();
        let rate = limits.acceleration.max(limits.deceleration);
        let jolt = if limits.jerk.is_finite() {
            limits.jerk
        } else {
            rate / longest
        };
        let acceleration = Magnitude {
            pin: "Acceleration",
            value: dynamics.acceleration,
            default: defaults.acceleration,
            limit: limits.acceleration,
            least: limits.velocity / longest,
            invalid: ErrorId::AccelerationInvalid,
            missing: Some(ErrorId::AccelerationMissing),
            above: ErrorId::AccelerationAboveLimit,
        };
        let deceleration = Magnitude {
            pin: "Deceleration",
            value: dynamics.deceleration,
            default: defaults.deceleration,
            limit: limits.deceleration,
            least: limits.velocity / longest,
            invalid: ErrorId::DecelerationInvalid,
            missing: Some(ErrorId::DecelerationMissing),
            above: ErrorId::DecelerationAboveLimit,
        };
        let jerk = Magnitude {
            pin: "Jerk",
            value: dynamics.jerk,
            default: defaults.jerk,
            limit: limits.jerk,
            least: rate / longest,
            invalid: ErrorId::JerkInvalid,
            missing: None,
            above: ErrorId::JerkAboveLimit,
        };
        let snap = Magnitude {
            pin: "Snap",
            value: dynamics.snap,
            default: defaults.snap,
            limit: limits.snap,
            least: jolt / longest,
            invalid: ErrorId::SnapInvalid,
            missing: None,
            above: ErrorId::SnapAboveLimit,
        };
        Ok(Limits {
            velocity: limits.velocity,
            acceleration: self.magnitude(&acceleration, scope)?,
            deceleration: self.magnitude(&deceleration, scope)?,
            jerk: self.magnitude(&jerk, scope)?,
            snap: self.magnitude(&snap, scope)?,
        })
    }

    /// The longest time (s) that a rate may take from 0 to its limit.
    pub(super) fn longest(&self) -> f64 {
        LONGEST * self.planner.cycle()
    }

    /// The velocity of a positioning move at `pin`: above 0, at most the axis limit.
    pub(super) fn positive_velocity(
        &self,
        pin: &'static str,
        value: f64,
        scope: &mut Scope<'_>,
    ) -> Result<f64, ErrorId> {
        if !(value > 0.0 && value.is_finite()) {
            return Err(self.refuse(pin, value, 0.0, ErrorId::VelocityInvalid, scope));
        }
        self.within(
            pin,
            value,
            self.parameters.limits.velocity,
            ErrorId::VelocityAboveLimit,
            scope,
        )
    }

    /// The velocity of an endless motion: signed, at most the axis limit in magnitude.
    pub(super) fn endless_velocity(&self, value: f64, scope: &mut Scope<'_>) -> Result<f64, ErrorId> {
        if !value.is_finite() {
            return Err(self.refuse("Velocity", value, f64::NAN, ErrorId::VelocityInvalid, scope));
        }
        let limit = self.parameters.limits.velocity;
        self.within("Velocity", value, limit, ErrorId::VelocityAboveLimit, scope)
    }

    /// The end velocity of a continuous move: signed, at most `velocity` in magnitude.
    pub(super) fn end_velocity(
        &self,
        value: f64,
        velocity: f64,
        scope: &mut Scope<'_>,
    ) -> Result<f64, ErrorId> {
        let invalid = ErrorId::EndVelocityInvalid;
        if !value.is_finite() {
            return Err(self.refuse("EndVelocity", value, f64::NAN, invalid, scope));
        }
        let limit = self.parameters.limits.velocity;
        // Velocity above the axis limit was clamped before, or the command was refused.
        if value.abs().min(limit) > velocity {
            return Err(self.refuse("EndVelocity", value, velocity, invalid, scope));
        }
        let above = ErrorId::EndVelocityAboveLimit;
        self.within("EndVelocity", value, limit, above, scope)
    }

    /// Limits of a ramp without a command: power-off, ErrorStop.
    pub(super) fn stop_limits(&self) -> Limits {
        let limits = self.config.limits;
        let stop = self.config.stop.unwrap_or(StopLimits {
            deceleration: self.config.stop_deceleration,
            jerk: self.config.stop_jerk,
            snap: None,
        });
        Limits {
            deceleration: stop.deceleration.unwrap_or(limits.deceleration),
            jerk: stop.jerk.unwrap_or(limits.jerk),
            snap: stop.snap.unwrap_or(limits.snap),
            ..limits
        }
    }

    /// Limits that no motion of the axis exceeds, not even a stop.
    pub(super) fn hardest_limits(&self) -> Limits {
        match self.config.stop {
            Some(_) => self.config.limits.or_larger(&self.stop_limits()),
            None => self.config.limits,
        }
    }

    fn magnitude(&self, pin: &Magnitude, scope: &mut Scope<'_>) -> Result<f64, ErrorId> {
        if !(pin.value >= 0.0 && pin.value.is_finite()) {
            return Err(self.refuse(pin.pin, pin.value, 0.0, pin.invalid, scope));
        }
        if pin.value > 0.0 {
            // An axis with such low limits may use them.
            if pin.value < pin.least && pin.value < pin.limit {
                return Err(self.refuse(pin.pin, pin.value, pin.least, ErrorId::MoveTooLong, scope));
            }
            return self.within(pin.pin, pin.value, pin.limit, pin.above, scope);
        }
        match (pin.default, pin.missing) {
            (Some(default), _) => Ok(default.min(pin.limit)),
            (None, Some(error)) if !pin.limit.is_finite() => {
                Err(self.refuse(pin.pin, pin.value, f64::NAN, error, scope))
            }
            (None, _) => Ok(pin.limit),
        }
    }

    /// `value` if its magnitude is within `limit`; otherwise the result of the axis's setting for values
    /// above a limit.
    fn within(
        &self,
        pin: &'static str,
        value: f64,
        limit: f64,
        above: ErrorId,
        scope: &mut Scope<'_>,
    ) -> Result<f64, ErrorId> {
        if value.abs() <= limit {
            return Ok(value);
        }
        let limit = if value < 0.0 { -limit } else { limit };
        match self.config.above_limit {
            AboveLimit::Clamp => {
                self.record(Event::Clamped { pin, value, limit }, scope);
                Ok(limit)
            }
            AboveLimit::Error => Err(self.refuse(pin, value, limit, above, scope)),
        }
    }

    /// The element at an enum pin. An undefined number is refused; the last element has the largest one.
    pub(super) fn element<E: IecEnum>(
        &self,
        pin: &'static str,
        raw: Raw<E>,
        error: ErrorId,
        scope: &mut Scope<'_>,
    ) -> Result<E, ErrorId> {
        let last = E::ELEMENTS.last().map_or(0, |(_, number)| *number);
        raw.get()
            .ok_or_else(|| self.refuse(pin, f64::from(raw.number()), f64::from(last), error, scope))
    }

    /// Records that a block which only reads the axis refuses the value at `pin`.
    pub fn note_refusal(
        &self,
        pin: &'static str,
        value: f64,
        limit: f64,
        error: ErrorId,
        scope: &mut Scope<'_>,
    ) {
        self.refuse(pin, value, limit, error, scope);
    }

    pub(super) fn refuse(
        &self,
        pin: &'static str,
        value: f64,
        limit: f64,
        error: ErrorId,
        scope: &mut Scope<'_>,
    ) -> ErrorId {
        self.record(
            Event::Refused {
                pin,
                value,
                limit,
                error,
            },
            scope,
        );
        error
    }
}

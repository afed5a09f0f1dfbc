//! From the structures of C to the configuration of an axis.

use crate::{AxisSetup, DriveSetup};
use standstill_axis::{
    AboveLimit, AxisConfig, BlockDetection, ConfigError, Defaults, HomeDirection, Homing, InPosition, Limits,
    MoveProfile, PowerOff, Procedure, Scaling, StartState, SwitchEdge,
};

/// What cannot be used.
pub(crate) struct SetupFault {
    pub key: &'static str,
    pub value: f64,
}

impl AxisSetup {
    /// Everything but the limits at its default, as `AxisConfig::new` has it.
    pub(crate) const fn defaults(size: u32) -> Self {
        Self {
            size,
            start_powered: 0,
            velocity: 0.0,
            acceleration: 0.0,
            deceleration: 0.0,
            jerk: 0.0,
            snap: 0.0,
            default_acceleration: 0.0,
            default_deceleration: 0.0,
            default_jerk: 0.0,
            default_snap: 0.0,
            position: 0.0,
            scaling_increments: 0,
            scaling_units: 1,
            scaling_invert: 0,
            above_limit: 0,
            scaling_offset: 0.0,
            modulo: 0.0,
            software_limit_min: f64::NEG_INFINITY,
            software_limit_max: f64::INFINITY,
            profile: 0,
            queue: 8,
            on_power_off: 0,
            needs_homed: 0,
            stop_deceleration: 0.0,
            stop_jerk: 0.0,
            override_max: 1.0,
            max_following_error: 0.0,
            in_position_window: 0.0,
            in_position_scans: 0,
            hardware_limits: 1,
            homing: 0,
            homing_direction: 0,
            homing_edge: 0,
            homing_pulse: 0,
            homing_velocity: 0.0,
            homing_creep: 0.0,
            homing_block_velocity: 0.0,
            homing_block_scans: 0,
            homing_time_limit: 0,
            homing_distance_limit: 0.0,
        }
    }

    /// As the axis takes it.
    pub(crate) fn config(&self) -> Result<AxisConfig, SetupFault> {
        let or = |value: f64, instead: f64| if value == 0.0 { instead } else { value };
        let scaling = (self.scaling_increments != 0).then(|| {
            Scaling::new(
                self.scaling_increments,
                self.scaling_units,
                self.scaling_invert != 0,
                self.scaling_offset,
            )
        });
        let unlimited =
            self.software_limit_min == f64::NEG_INFINITY && self.software_limit_max == f64::INFINITY;
        Ok(AxisConfig {
            limits: Limits {
                velocity: self.velocity,
                acceleration: self.acceleration,
                deceleration: or(self.deceleration, self.acceleration),
                jerk: or(self.jerk, f64::INFINITY),
                snap: or(self.snap, f64::INFINITY),
            },
            defaults: Defaults {
                acceleration: given(self.default_acceleration),
                deceleration: given(self.default_deceleration),
                jerk: given(self.default_jerk),
                snap: given(self.default_snap),
            },
            position: self.position,
            start: if self.start_powered == 0 {
                StartState::Disabled
            } else {
                StartState::Standstill
            },
            scaling: scaling.transpose().map_err(|error| refused(&error))?,
            modulo: given(self.modulo),
            software_limits: (!unlimited).then_some((self.software_limit_min, self.software_limit_max)),
            above_limit: choice(
                "above_limit",
                self.above_limit,
                &[AboveLimit::Clamp, AboveLimit::Error],
            )?,
            profile: choice("profile", self.profile, &MoveProfile::ALL)?,
            queue: self.queue as usize,
            stop_deceleration: given(self.stop_deceleration),
            stop_jerk: given(self.stop_jerk),
            on_power_off: choice(
                "on_power_off",
                self.on_power_off,
                &[PowerOff::Ramp, PowerOff::Coast, PowerOff::Drive],
            )?,
            homing: self.homing()?,
            hardware_limits: self.hardware_limits != 0,
            needs_homed: self.needs_homed != 0,
            override_max: self.override_max,
            max_following_error: given(self.max_following_error),
            in_position: given(self.in_position_window).map(|window| InPosition {
                window,
                scans: self.in_position_scans,
            }),
        })
    }

    fn homing(&self) -> Result<Homing, SetupFault> {
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
        Ok(Homing {
            procedure: choice("homing", self.homing, &Procedure::ALL)?,
            direction: choice("homing_direction", self.homing_direction, &directions)?,
            edge: choice("homing_edge", self.homing_edge, &edges)?,
            velocity: self.homing_velocity,
            creep: given(self.homing_creep),
            pulse: self.homing_pulse != 0,
            block: given(self.homing_block_velocity).map(|velocity| BlockDetection {
                velocity,
                scans: u32::try_from(self.homing_block_scans).unwrap_or(u32::MAX),
            }),
            time_limit: (self.homing_time_limit != 0).then_some(self.homing_time_limit),
            distance_limit: given(self.homing_distance_limit),
        })
    }
}

impl DriveSetup {
    /// An ideal drive without delay.
    pub(crate) const fn defaults(size: u32) -> Self {
        Self {
            size,
            kind: 1,
            delay: 0,
            power_on: 0,
            start_up: 0,
            quick_stop: 1,
            on_disable: 0,
            on_fault: 1,
            deceleration: 0.0,
            inertia: 0.0,
            viscous: 0.0,
            coulomb: 0.0,
            load_inertia: 0.0,
            load_stiffness: 0.0,
            load_damping: 0.0,
            torque_max: 0.0,
        }
    }
}

/// 0 stands for what is not given; NaN is a value, and refused as one.
fn given(value: f64) -> Option<f64> {
    (value != 0.0).then_some(value)
}

fn choice<T: Copy>(key: &'static str, number: i32, of: &[T]) -> Result<T, SetupFault> {
    let chosen = usize::try_from(number).ok().and_then(|number| of.get(number));
    chosen.copied().ok_or(SetupFault {
        key,
        value: number.into(),
    })
}

/// The key and the value an error of the axis speaks of.
pub(crate) fn refused(error: &ConfigError) -> SetupFault {
    let value = match *error {
        ConfigError::NotPositive { value, .. }
        | ConfigError::NotFinite { value, .. }
        | ConfigError::AboveLimit { value, .. }
        | ConfigError::Modulo { value }
        | ConfigError::PositionOutsideModulo { value, .. }
        | ConfigError::ModuloNotRational { value }
        | ConfigError::OverrideMax { value }
        | ConfigError::HomingFaster { value, .. } => value,
        ConfigError::SoftwareLimits { min, .. } => min,
        ConfigError::Queue { value } => value as f64,
        ConfigError::Profile { limit, .. } => limit,
        ConfigError::Scaling { units, .. } => units.into(),
        _ => 0.0,
    };
    SetupFault {
        key: error.key(),
        value,
    }
}

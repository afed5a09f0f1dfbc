//! Converts the structures of C to the configuration of an axis.

use crate::{AxisSetup, DriveSetup};
use standstill_axis::{
    AboveLimit, AxisConfig, BlockDetection, ConfigError, Defaults, EdgeWhileBusy, Following, HomeDirection,
    Homing, InPosition, JogAtLimit, Limits, ModuloTargets, MoveProfile, OnLimit, OnMasterLost, PlanError,
    PowerOff, Procedure, Scaling, ShaperKind, StartState, StopLimits, SwitchEdge, VibrationMode,
};
use standstill_drives::cia402::Reaction;
use standstill_drives::mechanism::{Gains, Load, Plant, Stops};
use standstill_drives::simulated::{self, Cia402Setup, IdealDriveSetup, MotorSetup, PlantSetup};
use standstill_drives::switches::{Marker, Switches};

/// A vibration mode of the load; none without a frequency.
fn mode(
    key: &'static str,
    (frequency, damping, shaper): (f64, f64, i32),
) -> Result<Option<VibrationMode>, SetupFault> {
    let shapers = [
        ShaperKind::Ei,
        ShaperKind::Period,
        ShaperKind::Zv,
        ShaperKind::Zvd,
    ];
    let shaper = choice(key, shaper, &shapers)?;
    Ok(given(frequency).map(|frequency| VibrationMode {
        frequency,
        damping,
        shaper,
    }))
}

/// The invalid value of a configuration.
pub(crate) struct SetupFault {
    pub key: &'static str,
    pub value: f64,
}

impl AxisSetup {
    /// Everything except the limits at its default, as in `AxisConfig::new`.
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
            power_timeout: 0,
            max_deviation: 0.0,
            on_limit: 0,
            on_master_lost: 0,
            actual_filter: 0,
            actual_lead: 0,
            application_velocity: 0.0,
            application_acceleration: 0.0,
            application_deceleration: 0.0,
            application_jerk: 0.0,
            application_snap: 0.0,
            hard_stop_deceleration: 0.0,
            hard_stop_jerk: 0.0,
            hard_stop_snap: 0.0,
            jog_at_limit: 0,
            modulo_targets: 0,
            edge_while_busy: 0,
            cam_continuity: 0,
            vibration_frequency: 0.0,
            vibration_damping: 0.0,
            vibration2_frequency: 0.0,
            vibration2_damping: 0.0,
            vibration_shaper: 0,
            vibration2_shaper: 0,
        }
    }

    /// The configuration in the axis's own type.
    pub(crate) fn config(&self) -> Result<AxisConfig, SetupFault> {
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
        let limits = Limits {
            velocity: self.velocity,
            acceleration: self.acceleration,
            deceleration: or(self.deceleration, self.acceleration),
            jerk: or(self.jerk, f64::INFINITY),
            snap: or(self.snap, f64::INFINITY),
        };
        Ok(AxisConfig {
            limits,
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
            power_timeout: (self.power_timeout != 0).then_some(self.power_timeout),
            max_following_error: given(self.max_following_error),
            in_position: given(self.in_position_window).map(|window| InPosition {
                window,
                scans: self.in_position_scans,
            }),
            following: Following {
                on_limit: choice(
                    "on_limit",
                    self.on_limit,
                    &[OnLimit::Lag, OnLimit::Error, OnLimit::SlowMaster],
                )?,
                max_deviation: given(self.max_deviation),
                on_master_lost: choice(
                    "on_master_lost",
                    self.on_master_lost,
                    &[OnMasterLost::Error, OnMasterLost::Hold],
                )?,
                actual_filter: match self.actual_filter {
                    0 => Following::DEFAULT.actual_filter,
                    scans => u32::try_from(scans).unwrap_or(0),
                },
                actual_lead: self.actual_lead != 0,
                cam_continuity: match self.cam_continuity {
                    0 => None,
                    given => Some(u8::try_from(given.max(0)).unwrap_or(u8::MAX)),
                },
            },
            application_limits: self.application_limits(&limits),
            stop: self.stop(),
            jog_at_limit: choice(
                "jog_at_limit",
                self.jog_at_limit,
                &[JogAtLimit::Error, JogAtLimit::Stop],
            )?,
            modulo_targets: choice(
                "modulo_targets",
                self.modulo_targets,
                &[ModuloTargets::Error, ModuloTargets::Wrap],
            )?,
            edge_while_busy: choice(
                "edge_while_busy",
                self.edge_while_busy,
                &[EdgeWhileBusy::Restart, EdgeWhileBusy::Ignore],
            )?,
            vibration: [
                mode(
                    "vibration_shaper",
                    (
                        self.vibration_frequency,
                        self.vibration_damping,
                        self.vibration_shaper,
                    ),
                )?,
                mode(
                    "vibration2_shaper",
                    (
                        self.vibration2_frequency,
                        self.vibration2_damping,
                        self.vibration2_shaper,
                    ),
                )?,
            ],
        })
    }

    fn application_limits(&self, limits: &Limits) -> Option<Limits> {
        let parts = [
            self.application_velocity,
            self.application_acceleration,
            self.application_deceleration,
            self.application_jerk,
            self.application_snap,
        ];
        parts.iter().any(|part| *part != 0.0).then(|| {
            let acceleration = or(self.application_acceleration, limits.deceleration);
            Limits {
                velocity: or(self.application_velocity, limits.velocity),
                acceleration: or(self.application_acceleration, limits.acceleration),
                deceleration: or(
                    self.application_deceleration,
                    acceleration.min(limits.deceleration),
                ),
                jerk: or(self.application_jerk, limits.jerk),
                snap: or(self.application_snap, limits.snap),
            }
        })
    }

    fn stop(&self) -> Option<StopLimits> {
        let stop = StopLimits {
            deceleration: given(self.hard_stop_deceleration),
            jerk: given(self.hard_stop_jerk),
            snap: given(self.hard_stop_snap),
        };
        (stop != StopLimits::default()).then_some(stop)
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
            limit_switches: 0,
            home_switch: 0,
            marker: 0,
            homing_direction: 0,
            limit_switch_negative: 0.0,
            limit_switch_positive: 0.0,
            home_switch_from: 0.0,
            home_switch_to: 0.0,
            marker_at: 0.0,
            marker_every: 0.0,
            homing_velocity: 0.0,
            rated_torque: 0.0,
            stop_stiffness: 0.0,
            stop_damping: 0.0,
            stop_negative: 0.0,
            stop_positive: 0.0,
            gain_position: f64::NAN,
            gain_velocity: f64::NAN,
            gain_integral: f64::NAN,
            feed_velocity: 1.0,
            feed_acceleration: 1.0,
        }
    }

    /// The simulated drive under an axis of this configuration. `cycle_ns` is the cycle in nanoseconds.
    pub(crate) fn simulated(
        &self,
        axis: &AxisConfig,
        cycle_ns: i64,
    ) -> Result<simulated::DriveSetup, SetupFault> {
        let power_on = u32::try_from(self.power_on).ok();
        let switches = self.switches()?;
        Ok(match self.kind {
            1 => simulated::DriveSetup::Ideal(IdealDriveSetup {
                delay: self.delay as usize,
                power_on,
                switches,
            }),
            2 => simulated::DriveSetup::Cia402(self.cia402(axis, power_on, switches)?),
            3 => {
                let plant = Plant {
                    inertia: self.inertia,
                    viscous: self.viscous,
                    coulomb: self.coulomb,
                    load: (self.load_inertia != 0.0).then_some(Load {
                        inertia: self.load_inertia,
                        stiffness: self.load_stiffness,
                        damping: self.load_damping,
                    }),
                };
                let setup = PlantSetup {
                    power_on,
                    plant,
                    stops: (self.stop_stiffness != 0.0).then_some(Stops {
                        ends: (self.stop_negative, self.stop_positive),
                        stiffness: self.stop_stiffness,
                        damping: self.stop_damping,
                    }),
                    gains: Gains {
                        position: self.gain_position,
                        velocity: self.gain_velocity,
                        integral: self.gain_integral,
                        feed_velocity: self.feed_velocity,
                        feed_acceleration: self.feed_acceleration,
                        torque: given(self.torque_max).unwrap_or(f64::INFINITY),
                    },
                    switches,
                };
                simulated::DriveSetup::Plant(setup.with_gains(cycle_ns as f64 / 1e9))
            }
            other => return Err(fault("drive.kind", other.into())),
        })
    }

    fn cia402(
        &self,
        axis: &AxisConfig,
        power_on: Option<u32>,
        switches: Switches,
    ) -> Result<Cia402Setup, SetupFault> {
        let scaling = axis.scaling.ok_or(fault("scaling_increments", 0.0))?;
        let rate = given(self.deceleration).unwrap_or(axis.limits.deceleration);
        // The node brakes in increments, so their number must be finite.
        let counted = rate * (f64::from(scaling.increments()) / f64::from(scaling.units()));
        if !(rate > 0.0 && counted.is_finite()) {
            return Err(fault("drive.deceleration", rate));
        }
        let reactions = [Reaction::Coast, Reaction::Ramp, Reaction::RampAndStay];
        let [coast, ramp, _] = reactions;
        let upwards = choice("drive.homing_direction", self.homing_direction, &[true, false])?;
        if !(self.homing_velocity >= 0.0 && self.homing_velocity.is_finite()) {
            return Err(fault("drive.homing_velocity", self.homing_velocity));
        }
        Ok(Cia402Setup {
            delay: self.delay as usize,
            power_on,
            start_up: self.start_up,
            deceleration: Some(rate),
            quick_stop: choice("drive.quick_stop", self.quick_stop, &reactions)?,
            on_disable: choice("drive.on_disable", self.on_disable, &[coast, ramp])?,
            on_fault: choice("drive.on_fault", self.on_fault, &[coast, ramp])?,
            homing: (self.homing_velocity != 0.0).then_some((upwards, self.homing_velocity)),
            motor: self.motor()?,
            switches,
        })
    }

    /// The motor of a CiA 402 drive, within the values its bus can express.
    fn motor(&self) -> Result<Option<MotorSetup>, SetupFault> {
        let rated_torque = self.rated_torque;
        if rated_torque == 0.0 {
            return Ok(None);
        }
        let motor = MotorSetup {
            rated_torque,
            max_torque: given(self.torque_max).unwrap_or(3.0 * rated_torque),
            inertia: self.inertia,
            viscous: self.viscous,
            coulomb: self.coulomb,
        };
        // The smallest value on the bus is a thousandth of the rated torque, the largest 32767 of them.
        let told = 0.001 * rated_torque..=f64::from(i16::MAX) / 1000.0 * rated_torque;
        let finite = [rated_torque, motor.inertia, motor.viscous, motor.coulomb].map(f64::is_finite);
        let good = [
            (
                "drive.rated_torque",
                rated_torque,
                rated_torque > 0.0 && finite[0],
            ),
            ("drive.inertia", motor.inertia, motor.inertia > 0.0 && finite[1]),
            ("drive.viscous", motor.viscous, motor.viscous >= 0.0 && finite[2]),
            ("drive.coulomb", motor.coulomb, motor.coulomb >= 0.0 && finite[3]),
            (
                "drive.torque_max",
                motor.max_torque,
                told.contains(&motor.max_torque),
            ),
        ];
        match good.into_iter().find(|(_, _, good)| !good) {
            Some((key, value, _)) => Err(fault(key, value)),
            None => Ok(Some(motor)),
        }
    }

    /// The switches and pulses along the travel.
    fn switches(&self) -> Result<Switches, SetupFault> {
        let pair = |there: u32, keys: [&'static str; 2], from: f64, to: f64| {
            if there == 0 {
                return Ok(None);
            }
            let [first, second] = keys;
            if !from.is_finite() {
                return Err(fault(first, from));
            }
            if !(to.is_finite() && from <= to) {
                return Err(fault(second, to));
            }
            Ok(Some((from, to)))
        };
        let limits = pair(
            self.limit_switches,
            ["drive.limit_switch_negative", "drive.limit_switch_positive"],
            self.limit_switch_negative,
            self.limit_switch_positive,
        )?;
        let home = pair(
            self.home_switch,
            ["drive.home_switch_from", "drive.home_switch_to"],
            self.home_switch_from,
            self.home_switch_to,
        )?;
        let marker = if self.marker == 0 {
            None
        } else if !self.marker_at.is_finite() {
            return Err(fault("drive.marker_at", self.marker_at));
        } else if !(self.marker_every >= 0.0 && self.marker_every.is_finite()) {
            return Err(fault("drive.marker_every", self.marker_every));
        } else {
            Some(Marker {
                at: self.marker_at,
                every: given(self.marker_every),
            })
        };
        Ok(Switches {
            limits,
            home,
            marker,
            // The value of the axis is filled in when the drive is made.
            turn: None,
        })
    }
}

const fn fault(key: &'static str, value: f64) -> SetupFault {
    SetupFault { key, value }
}

/// `instead` if the value is 0, which means not given. NaN is a value, and is refused as one.
fn or(value: f64, instead: f64) -> f64 {
    if value == 0.0 { instead } else { value }
}

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

/// The key and the value that an error of the axis refers to.
pub(crate) fn refused(error: &ConfigError) -> SetupFault {
    let value = match *error {
        ConfigError::NotPositive { value, .. }
        | ConfigError::NotFinite { value, .. }
        | ConfigError::Vibration {
            error: PlanError::InvalidInput { value, .. } | PlanError::OutOfRange { value, .. },
            ..
        }
        | ConfigError::VibrationRates {
            deceleration: value, ..
        }
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

#[cfg(test)]
mod tests {
    extern crate std;

    use super::*;
    use standstill_axis::keys::AXIS;
    use std::vec::Vec;

    /// The action of a host to set a key, in addition to the key's own rules.
    type Set = fn(&mut AxisSetup);

    /// Every key of an axis, and how a C host sets it.
    const KEYS: &[(&str, Set)] = &[
        ("limits.velocity", |axis| axis.velocity = 7.0),
        ("limits.acceleration", |axis| axis.acceleration = 70.0),
        ("limits.deceleration", |axis| axis.deceleration = 60.0),
        ("limits.jerk", |axis| axis.jerk = 1e3),
        ("limits.snap", |axis| axis.snap = 1e5),
        ("defaults.acceleration", |axis| axis.default_acceleration = 5.0),
        ("defaults.deceleration", |axis| axis.default_deceleration = 5.0),
        ("defaults.jerk", |axis| axis.default_jerk = 5.0),
        ("defaults.snap", |axis| axis.default_snap = 5.0),
        ("position", |axis| axis.position = 3.0),
        ("state", |axis| axis.start_powered = 1),
        ("scaling.increments", |axis| axis.scaling_increments = 1000),
        ("scaling.units", |axis| {
            (axis.scaling_increments, axis.scaling_units) = (1000, 3)
        }),
        ("scaling.invert", |axis| {
            (axis.scaling_increments, axis.scaling_invert) = (1000, 1)
        }),
        ("scaling.offset", |axis| {
            (axis.scaling_increments, axis.scaling_offset) = (1000, 0.5)
        }),
        ("modulo", |axis| axis.modulo = 360.0),
        ("software_limits.min", |axis| axis.software_limit_min = -5.0),
        ("software_limits.max", |axis| axis.software_limit_max = 5.0),
        ("above_limit", |axis| axis.above_limit = 1),
        ("profile", |axis| axis.profile = 3),
        ("queue", |axis| axis.queue = 16),
        ("stop_deceleration", |axis| axis.stop_deceleration = 50.0),
        ("stop_jerk", |axis| axis.stop_jerk = 500.0),
        ("stop.deceleration", |axis| axis.hard_stop_deceleration = 500.0),
        ("stop.jerk", |axis| axis.hard_stop_jerk = 5e4),
        ("stop.snap", |axis| axis.hard_stop_snap = 5e6),
        ("application_limits.velocity", |axis| {
            axis.application_velocity = 7.0
        }),
        ("application_limits.acceleration", |axis| {
            axis.application_acceleration = 70.0
        }),
        ("application_limits.deceleration", |axis| {
            axis.application_deceleration = 60.0
        }),
        ("application_limits.jerk", |axis| axis.application_jerk = 1e3),
        ("application_limits.snap", |axis| axis.application_snap = 1e5),
        ("jog_at_limit", |axis| axis.jog_at_limit = 1),
        ("modulo_targets", |axis| axis.modulo_targets = 1),
        ("edge_while_busy", |axis| axis.edge_while_busy = 1),
        ("on_power_off", |axis| axis.on_power_off = 2),
        ("hardware_limits", |axis| axis.hardware_limits = 0),
        ("homing.procedure", |axis| {
            (axis.homing, axis.homing_velocity) = (1, 2.0)
        }),
        ("homing.direction", |axis| axis.homing_direction = 3),
        ("homing.edge", |axis| axis.homing_edge = 2),
        ("homing.velocity", |axis| axis.homing_velocity = 2.0),
        ("homing.creep", |axis| axis.homing_creep = 1.0),
        ("homing.pulse", |axis| axis.homing_pulse = 1),
        ("homing.block.velocity", |axis| axis.homing_block_velocity = 1.0),
        ("homing.block.time", |axis| {
            (axis.homing_block_velocity, axis.homing_block_scans) = (1.0, 9);
        }),
        ("homing.time_limit", |axis| axis.homing_time_limit = 9),
        ("homing.distance_limit", |axis| axis.homing_distance_limit = 9.0),
        ("needs_homed", |axis| axis.needs_homed = 1),
        ("override_max", |axis| axis.override_max = 1.5),
        ("power_timeout", |axis| axis.power_timeout = 9),
        ("in_position.window", |axis| axis.in_position_window = 0.1),
        ("in_position.time", |axis| {
            (axis.in_position_window, axis.in_position_scans) = (0.1, 9)
        }),
        ("max_following_error", |axis| axis.max_following_error = 0.5),
        ("coupling.on_limit", |axis| axis.on_limit = 2),
        ("coupling.max_deviation", |axis| axis.max_deviation = 0.5),
        ("coupling.on_master_lost", |axis| axis.on_master_lost = 1),
        ("coupling.actual_filter", |axis| axis.actual_filter = -1),
        ("coupling.actual_lead", |axis| axis.actual_lead = 1),
        ("coupling.cam_continuity", |axis| axis.cam_continuity = -1),
        ("vibration.0.frequency", |axis| axis.vibration_frequency = 12.0),
        ("vibration.0.damping", |axis| {
            (axis.vibration_frequency, axis.vibration_damping) = (12.0, 0.02);
        }),
        ("vibration.0.shaper", |axis| {
            (axis.vibration_frequency, axis.vibration_shaper) = (12.0, 2);
        }),
        ("vibration.1.frequency", |axis| axis.vibration2_frequency = 12.0),
        ("vibration.1.damping", |axis| {
            (axis.vibration2_frequency, axis.vibration2_damping) = (12.0, 0.02);
        }),
        ("vibration.1.shaper", |axis| {
            (axis.vibration2_frequency, axis.vibration2_shaper) = (12.0, 2);
        }),
    ];

    /// A C host can set up everything that a script can.
    #[test]
    fn every_key_of_an_axis_has_its_fields() {
        let mut plain = AxisSetup::defaults(0);
        (plain.velocity, plain.acceleration) = (10.0, 100.0);
        let Ok(without) = plain.config() else {
            unreachable!()
        };
        let mut paths = Vec::new();
        AXIS.each(&mut |key| paths.push(key.path));
        let known: Vec<_> = KEYS.iter().map(|(path, _)| *path).collect();
        for path in &paths {
            assert!(known.contains(path), "a host in C cannot set {path}");
        }
        for (path, set) in KEYS {
            let key = AXIS.find(path).expect("a key of the table");
            let mut setup = plain;
            set(&mut setup);
            let Ok(with) = setup.config() else {
                panic!("{path}")
            };
            assert!(!key.is_same(&without, &with), "{path} is not set");
        }
    }
}

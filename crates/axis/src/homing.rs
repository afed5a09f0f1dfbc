//! The homing procedure of an axis: the configuration of MC_Home.

use crate::ConfigError;
use standstill_planner::Limits;

/// The procedure of MC_Home to find the reference.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Procedure {
    /// No motion: the present position of the axis is the reference.
    #[default]
    Direct,
    /// An edge of the home switch.
    AbsoluteSwitch,
    /// The position at which the limit switch switches off again.
    LimitSwitch,
    /// The next reference pulse (index, marker) of the encoder, latched by the drive.
    ReferencePulse,
    /// A mechanical stop.
    Block,
    /// The drive homes by itself: CiA 402 homing mode.
    Drive,
}

impl Procedure {
    /// All of them.
    pub const ALL: [Self; 6] = [
        Self::Direct,
        Self::AbsoluteSwitch,
        Self::LimitSwitch,
        Self::ReferencePulse,
        Self::Block,
        Self::Drive,
    ];

    /// Its name in scripts and messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Direct => "direct",
            Self::AbsoluteSwitch => "absolute_switch",
            Self::LimitSwitch => "limit_switch",
            Self::ReferencePulse => "reference_pulse",
            Self::Block => "block",
            Self::Drive => "drive",
        }
    }
}

/// Where a search begins (MC_HOME_DIRECTION).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum HomeDirection {
    /// Towards larger positions.
    #[default]
    Positive,
    /// Towards smaller positions.
    Negative,
    /// Towards larger positions if the home switch is off, towards smaller ones if it is on.
    SwitchPositive,
    /// The opposite direction.
    SwitchNegative,
}

impl HomeDirection {
    /// Whether the last approach moves towards larger positions.
    pub const fn is_up(self) -> bool {
        matches!(self, Self::Positive | Self::SwitchPositive)
    }
}

/// Which edge of the home switch is the reference (MC_SWITCH_MODE).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SwitchEdge {
    /// The edge at which the switch turns on, in the direction of the search.
    #[default]
    Rising,
    /// The edge at which it turns off, in the direction of the search.
    Falling,
    /// Its lower end: it turns on upwards and off downwards.
    SwitchPositive,
    /// Its upper end: it turns on downwards and off upwards.
    SwitchNegative,
}

/// The condition for standing at a mechanical stop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockDetection {
    /// The actual velocity is below this (u/s) ..
    pub velocity: f64,
    /// .. for this number of scans, while the set velocity is above it.
    pub scans: u32,
}

/// The homing of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Homing {
    /// The procedure.
    pub procedure: Procedure,
    /// Where the search begins.
    pub direction: HomeDirection,
    /// The edge, for a home switch.
    pub edge: SwitchEdge,
    /// Velocity of the search (u/s).
    pub velocity: f64,
    /// Velocity of a second, slower approach of a switch (u/s); `None` if the first one counts.
    pub creep: Option<f64>,
    /// The reference is the next reference pulse behind the edge of the switch.
    pub pulse: bool,
    /// For a mechanical stop.
    pub block: Option<BlockDetection>,
    /// Scans the search may take; `None` for no limit.
    pub time_limit: Option<u64>,
    /// Distance the axis may travel in the search (u), all parts added; `None` for no limit.
    pub distance_limit: Option<f64>,
}

impl Homing {
    /// Takes over the position of the axis, without motion.
    pub const DIRECT: Self = Self {
        procedure: Procedure::Direct,
        direction: HomeDirection::Positive,
        edge: SwitchEdge::Rising,
        velocity: 0.0,
        creep: None,
        pulse: false,
        block: None,
        time_limit: None,
        distance_limit: None,
    };

    /// Whether the controller moves the axis to find the reference.
    pub const fn searches(&self) -> bool {
        !matches!(self.procedure, Procedure::Direct | Procedure::Drive)
    }

    /// Whether the reference is at the lower end of the home switch.
    pub(crate) const fn is_lower_end(&self) -> bool {
        match self.edge {
            SwitchEdge::SwitchPositive => true,
            SwitchEdge::SwitchNegative => false,
            SwitchEdge::Rising => self.direction.is_up(),
            SwitchEdge::Falling => !self.direction.is_up(),
        }
    }

    /// Refuses invalid values, and keys that the procedure does not use.
    pub(crate) fn check(&self, limits: &Limits) -> Result<(), ConfigError> {
        let searches = self.searches();
        let switch = matches!(self.procedure, Procedure::AbsoluteSwitch | Procedure::LimitSwitch);
        let start = Self::DIRECT;
        let idle = [
            ("homing.direction", !searches && self.direction != start.direction),
            (
                "homing.direction",
                self.procedure != Procedure::AbsoluteSwitch
                    && matches!(
                        self.direction,
                        HomeDirection::SwitchPositive | HomeDirection::SwitchNegative
                    ),
            ),
            (
                "homing.edge",
                self.procedure != Procedure::AbsoluteSwitch && self.edge != start.edge,
            ),
            ("homing.velocity", !searches && self.velocity != start.velocity),
            ("homing.creep", !switch && self.creep.is_some()),
            ("homing.pulse", !switch && self.pulse),
            (
                "homing.block",
                self.procedure != Procedure::Block && self.block.is_some(),
            ),
            (
                "homing.time_limit",
                self.procedure == Procedure::Direct && self.time_limit.is_some(),
            ),
            (
                "homing.distance_limit",
                !searches && self.distance_limit.is_some(),
            ),
        ];
        let procedure = self.procedure;
        if let Some((key, _)) = idle.iter().find(|(_, given)| *given) {
            return Err(ConfigError::HomingKey { key, procedure });
        }
        let missing = [
            ("homing.velocity", searches && self.velocity == 0.0),
            (
                "homing.block",
                procedure == Procedure::Block && self.block.is_none(),
            ),
        ];
        if let Some((key, _)) = missing.iter().find(|(_, missing)| *missing) {
            return Err(ConfigError::HomingMissing { key, procedure });
        }
        let positive = [
            ("homing.velocity", searches.then_some(self.velocity)),
            ("homing.creep", self.creep),
            ("homing.distance_limit", self.distance_limit),
            ("homing.block.velocity", self.block.map(|block| block.velocity)),
        ];
        for (key, value) in positive {
            if let Some(value) = value
                && !(value > 0.0 && value.is_finite())
            {
                return Err(ConfigError::NotPositive { key, value });
            }
        }
        if self.velocity > limits.velocity {
            return Err(ConfigError::AboveLimit {
                key: "homing.velocity",
                value: self.velocity,
                limit: limits.velocity,
            });
        }
        let slower = [
            ("homing.creep", self.creep),
            ("homing.block.velocity", self.block.map(|block| block.velocity)),
        ];
        match slower.into_iter().find(|(_, value)| *value > Some(self.velocity)) {
            Some((key, value)) => Err(ConfigError::HomingFaster {
                key,
                value: value.unwrap_or(f64::NAN),
                search: self.velocity,
            }),
            None => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const LIMITS: Limits = Limits {
        velocity: 10.0,
        ..Limits::NONE
    };

    #[test]
    fn the_end_that_is_meant_does_not_depend_on_the_start() {
        use HomeDirection as D;
        use SwitchEdge as E;
        for (direction, edge, is_lower) in [
            (D::Positive, E::Rising, true),
            (D::Positive, E::Falling, false),
            (D::Negative, E::Rising, false),
            (D::Negative, E::Falling, true),
            (D::SwitchPositive, E::Rising, true),
            (D::SwitchNegative, E::Rising, false),
            (D::Negative, E::SwitchPositive, true),
            (D::Positive, E::SwitchNegative, false),
        ] {
            let homing = Homing {
                direction,
                edge,
                ..Homing::DIRECT
            };
            assert_eq!(homing.is_lower_end(), is_lower, "{direction:?} {edge:?}");
        }
    }

    #[test]
    fn keys_that_mean_nothing_are_refused() {
        let search = |procedure| Homing {
            procedure,
            velocity: 5.0,
            block: (procedure == Procedure::Block).then_some(BlockDetection {
                velocity: 1.0,
                scans: 5,
            }),
            ..Homing::DIRECT
        };
        for procedure in Procedure::ALL {
            let base = if search(procedure).searches() {
                search(procedure)
            } else {
                Homing {
                    procedure,
                    ..Homing::DIRECT
                }
            };
            assert_eq!(base.check(&LIMITS), Ok(()), "{procedure:?}");
            let switch = matches!(procedure, Procedure::AbsoluteSwitch | Procedure::LimitSwitch);
            let changed = [
                (
                    switch,
                    Homing {
                        creep: Some(2.0),
                        ..base
                    },
                ),
                (switch, Homing { pulse: true, ..base }),
                (
                    procedure == Procedure::AbsoluteSwitch,
                    Homing {
                        edge: SwitchEdge::Falling,
                        ..base
                    },
                ),
                (
                    procedure == Procedure::AbsoluteSwitch,
                    Homing {
                        direction: HomeDirection::SwitchPositive,
                        ..base
                    },
                ),
                (
                    base.searches(),
                    Homing {
                        distance_limit: Some(1.0),
                        ..base
                    },
                ),
                (
                    procedure != Procedure::Direct,
                    Homing {
                        time_limit: Some(1),
                        ..base
                    },
                ),
                (
                    false,
                    Homing {
                        velocity: 11.0,
                        ..base
                    },
                ),
                (
                    false,
                    Homing {
                        creep: Some(6.0),
                        ..base
                    },
                ),
                (
                    false,
                    Homing {
                        distance_limit: Some(f64::NAN),
                        ..base
                    },
                ),
            ];
            for (good, homing) in changed {
                assert_eq!(homing.check(&LIMITS).is_ok(), good, "{homing:?}");
            }
        }
    }

    #[test]
    fn velocities_and_ways_are_finite_and_above_0() {
        let good = Homing {
            procedure: Procedure::AbsoluteSwitch,
            velocity: 5.0,
            creep: Some(2.0),
            distance_limit: Some(1.0),
            ..Homing::DIRECT
        };
        assert_eq!(good.check(&Limits::NONE), Ok(()));
        let bad = [0.0, -1.0, f64::INFINITY, f64::NEG_INFINITY, f64::NAN];
        for value in bad {
            let refused = |key, homing: Homing| match homing.check(&Limits::NONE) {
                Err(ConfigError::NotPositive { key: named, .. }) => assert_eq!(named, key, "{value}"),
                // 0 means that the velocity was not given.
                Err(ConfigError::HomingMissing { key: named, .. }) if value == 0.0 => assert_eq!(named, key),
                other => panic!("{key} {value}: {other:?}"),
            };
            refused(
                "homing.velocity",
                Homing {
                    velocity: value,
                    ..good
                },
            );
            refused(
                "homing.creep",
                Homing {
                    creep: Some(value),
                    ..good
                },
            );
            refused(
                "homing.distance_limit",
                Homing {
                    distance_limit: Some(value),
                    ..good
                },
            );
        }
    }
}

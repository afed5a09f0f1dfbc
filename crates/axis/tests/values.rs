//! Values of configurations and commands: which are refused, and which count as equal.

use standstill_axis::{
    AxisConfig, Command, ConfigError, Defaults, Direction, Dynamics, InPosition, Limits, MODULO_MAX, Raw,
    Scaling, Superimpose,
};

fn turning(length: f64, position: f64, scaling: Option<Scaling>) -> Result<(), ConfigError> {
    AxisConfig {
        modulo: Some(length),
        position,
        scaling,
        ..AxisConfig::new(Limits {
            velocity: 10.0,
            acceleration: 100.0,
            deceleration: 100.0,
            ..Limits::NONE
        })
    }
    .check()
}

#[test]
fn a_turn_is_above_0_and_no_longer_than_positions_resolve() {
    for length in [f64::MIN_POSITIVE, 1.0, 360.0, MODULO_MAX] {
        assert_eq!(turning(length, 0.0, None), Ok(()), "{length:?}");
    }
    for length in [
        0.0,
        -360.0,
        f64::NAN,
        MODULO_MAX.next_up(),
        f64::INFINITY,
        f64::NEG_INFINITY,
    ] {
        let refused = turning(length, 0.0, None);
        assert!(
            matches!(refused, Err(ConfigError::Modulo { .. })),
            "{length:?}: {refused:?}"
        );
    }
}

#[test]
fn an_axis_with_turns_starts_in_the_first() {
    for position in [0.0, 1.0, 360.0_f64.next_down()] {
        assert_eq!(turning(360.0, position, None), Ok(()), "{position:?}");
    }
    for position in [-f64::MIN_POSITIVE, -1.0, 360.0, 1000.0] {
        let refused = turning(360.0, position, None);
        assert_eq!(
            refused,
            Err(ConfigError::PositionOutsideModulo {
                value: position,
                length: 360.0
            })
        );
    }
}

#[test]
fn a_turn_is_a_fraction_of_increments() {
    let scaling = Scaling::new(8_388_608, 360, false, 0.0).ok();
    assert!(scaling.is_some());
    assert_eq!(turning(360.0, 0.0, scaling), Ok(()));
    assert_eq!(turning(0.1, 0.0, scaling), Ok(()));
    assert_eq!(
        turning(f64::MIN_POSITIVE, 0.0, scaling),
        Err(ConfigError::ModuloNotRational {
            value: f64::MIN_POSITIVE
        })
    );
    assert_eq!(turning(f64::MIN_POSITIVE, 0.0, None), Ok(()));
}

/// A configuration with a value for every magnitude.
fn full() -> AxisConfig {
    AxisConfig {
        defaults: Defaults {
            acceleration: Some(50.0),
            deceleration: Some(50.0),
            jerk: Some(500.0),
            snap: Some(5000.0),
        },
        stop_deceleration: Some(50.0),
        stop_jerk: Some(500.0),
        max_following_error: Some(1.0),
        in_position: Some(InPosition {
            window: 0.1,
            scans: 0,
        }),
        ..AxisConfig::new(Limits {
            velocity: 10.0,
            acceleration: 100.0,
            deceleration: 100.0,
            jerk: 1000.0,
            snap: 10_000.0,
        })
    }
}

#[test]
fn magnitudes_are_above_0_and_finite_but_for_limits_left_out() {
    assert_eq!(full().check(), Ok(()));
    type Set = fn(&mut AxisConfig, f64);
    let set: [(Set, bool); 13] = [
        (|it, value| it.limits.velocity = value, true),
        (|it, value| it.limits.acceleration = value, true),
        (|it, value| it.limits.deceleration = value, true),
        (|it, value| it.limits.jerk = value, false),
        (|it, value| it.limits.snap = value, false),
        (|it, value| it.defaults.acceleration = Some(value), true),
        (|it, value| it.defaults.deceleration = Some(value), true),
        (|it, value| it.defaults.jerk = Some(value), true),
        (|it, value| it.defaults.snap = Some(value), true),
        (|it, value| it.stop_deceleration = Some(value), true),
        (|it, value| it.stop_jerk = Some(value), true),
        (|it, value| it.max_following_error = Some(value), true),
        (
            |it, value| {
                it.in_position = Some(InPosition {
                    window: value,
                    scans: 0,
                })
            },
            true,
        ),
    ];
    for (at, (set, is_finite)) in set.into_iter().enumerate() {
        for value in [0.0, -0.0, -1.0, f64::NAN, f64::NEG_INFINITY, f64::INFINITY] {
            let mut config = full();
            set(&mut config, value);
            let refused = matches!(config.check(), Err(ConfigError::NotPositive { .. }));
            assert_eq!(refused, is_finite || value != f64::INFINITY, "{at} {value:?}");
        }
    }
}

#[test]
fn the_largest_factor_is_a_number_from_1_on() {
    for (most, is_good) in [
        (1.0, true),
        (1.5, true),
        (1.0_f64.next_down(), false),
        (0.0, false),
        (f64::NAN, false),
        (f64::INFINITY, false),
    ] {
        let config = AxisConfig {
            override_max: most,
            ..full()
        };
        assert_eq!(config.check().is_ok(), is_good, "{most:?}");
    }
}

/// A command of each kind, with values of its own that start at `base`.
fn commands(base: f64) -> [Command; 10] {
    let dynamics = Dynamics {
        velocity: base,
        acceleration: base + 1.0,
        deceleration: base + 2.0,
        jerk: base + 3.0,
        snap: base + 4.0,
    };
    let direction = Raw::from(Direction::Positive);
    let (position, distance, end_velocity) = (base, base, base + 5.0);
    [
        Command::MoveAbsolute {
            position,
            dynamics,
            direction,
        },
        Command::MoveContinuousAbsolute {
            position,
            end_velocity,
            dynamics,
            direction,
        },
        Command::MoveRelative { distance, dynamics },
        Command::MoveAdditive { distance, dynamics },
        Command::MoveContinuousRelative {
            distance,
            end_velocity,
            dynamics,
        },
        Command::MoveVelocity { dynamics, direction },
        Command::Torque {
            torque: base,
            ramp: base + 5.0,
            dynamics,
            direction,
        },
        Command::Jog {
            forward: true,
            distance,
            dynamics,
        },
        Command::Halt { dynamics },
        Command::Stop { dynamics },
    ]
}

#[test]
fn commands_are_the_same_if_kind_and_values_are() {
    let (all, others) = (commands(1.0), commands(2.0));
    for (at, one) in all.iter().enumerate() {
        for (of, other) in all.iter().enumerate() {
            assert_eq!(one.is_same(other), at == of, "{one:?} {other:?}");
        }
        assert!(!one.is_same(&others[at]), "{one:?}");
    }
    let home = |position| Command::Home { position };
    assert!(home(1.0).is_same(&home(1.0)) && !home(1.0).is_same(&home(-1.0)));
    // Compared to the bit: NaN is equal to itself, and the two zeros differ.
    assert!(home(f64::NAN).is_same(&home(f64::NAN)));
    assert!(!home(0.0).is_same(&home(-0.0)));
}

#[test]
fn one_other_value_is_another_command() {
    let dynamics = Dynamics::default();
    let moved = |position, direction: Direction, dynamics| Command::MoveAbsolute {
        position,
        direction: direction.into(),
        dynamics,
    };
    let plain = moved(1.0, Direction::Positive, dynamics);
    assert!(!plain.is_same(&moved(1.0, Direction::Negative, dynamics)));
    let given = |of: fn(&mut Dynamics)| {
        let mut changed = Dynamics::default();
        of(&mut changed);
        changed
    };
    let added = |distance, dynamics| Superimpose { distance, dynamics };
    assert!(added(1.0, dynamics).is_same(&added(1.0, dynamics)));
    assert!(!added(1.0, dynamics).is_same(&added(2.0, dynamics)));
    for changed in [
        given(|it| it.velocity = 7.0),
        given(|it| it.acceleration = 7.0),
        given(|it| it.deceleration = 7.0),
        given(|it| it.jerk = 7.0),
        given(|it| it.snap = 7.0),
    ] {
        assert!(
            !plain.is_same(&moved(1.0, Direction::Positive, changed)),
            "{changed:?}"
        );
        assert!(!added(1.0, dynamics).is_same(&added(1.0, changed)), "{changed:?}");
    }
    let through = |end_velocity| Command::MoveContinuousRelative {
        distance: 1.0,
        end_velocity,
        dynamics,
    };
    assert!(!through(1.0).is_same(&through(2.0)));
    let jog = |forward| Command::Jog {
        forward,
        distance: 1.0,
        dynamics,
    };
    assert!(!jog(true).is_same(&jog(false)));
}

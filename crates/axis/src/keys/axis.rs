//! The keys of an axis.

use super::{Bounds, Holds, Key, Null, Object};
use crate::{
    ACTUAL_FILTER_MAX, AboveLimit, AxisConfig, BlockDetection, CAM_CONTINUITY_MAX, EdgeWhileBusy,
    HomeDirection, InPosition, JogAtLimit, MODULO_MAX, ModuloTargets, OnLimit, OnMasterLost, PowerOff,
    Procedure, QUEUE_MAX, Scaling, StartState, SwitchEdge,
};
use standstill_planner::shaper::DAMPING_MAX;
use standstill_planner::{Limits, MoveProfile, ShaperKind, VibrationMode};

/// The index of a value in a list of all values.
macro_rules! place {
    ($all:expr, $value:expr) => {
        $all.iter().position(|known| *known == $value)
    };
}

/// The names of all values of an enumeration.
macro_rules! names {
    ($all:expr) => {{
        let mut words = [""; $all.len()];
        let mut index = 0;
        while index < words.len() {
            words[index] = $all[index].name();
            index += 1;
        }
        words
    }};
}

/// A key that is TRUE or FALSE.
macro_rules! flag {
    ($path:literal, $($field:ident).+, $absent:literal, $doc:literal) => {
        Key::new(
            $path,
            Some($absent),
            $doc,
            Holds::Bool {
                get: |config| config.$($field).+,
                set: |config, value| config.$($field).+ = value,
            },
        )
    };
}

/// A key for one of the words of an enumeration.
macro_rules! word {
    ($path:literal, $($field:ident).+, [$(($word:expr, $value:expr)),+ $(,)?], $absent:expr, $doc:literal) => {
        Key::new(
            $path,
            $absent,
            $doc,
            Holds::Word {
                words: &[$($word),+],
                get: |config| place!([$($value),+], config.$($field).+),
                set: |config, place| {
                    if let Some(value) = [$($value),+].get(place) {
                        config.$($field).+ = *value;
                    }
                },
            },
        )
    };
}

/// A key for a number that may be absent.
macro_rules! optional {
    ($path:literal, $($field:ident).+, $absent:literal, $doc:literal) => {
        Key::number(
            $path,
            Bounds::POSITIVE,
            Some($absent),
            $doc,
            |config| config.$($field).+,
            |config, value| config.$($field).+ = Some(value),
        )
    };
}

/// A key for a limit that an axis may be without.
macro_rules! limit {
    ($path:literal, $field:ident, $absent:literal, $doc:literal) => {
        Key {
            null: Some(Null::ABSENT),
            ..Key::number(
                $path,
                Bounds::POSITIVE,
                Some($absent),
                $doc,
                |config| Some(config.limits.$field).filter(|limit| *limit != f64::INFINITY),
                |config, value| config.limits.$field = value,
            )
        }
    };
}

/// The largest number of scans that a file can give exactly.
const SCANS: u64 = 1 << 53;

/// The keys of an axis.
pub static AXIS: Object<AxisConfig> = Object::new(
    "an axis",
    &[
        Key::object("limits", "`limits`", LIMITS, None, "limits of all set-points"),
        Key::object(
            "application_limits",
            "`application_limits`",
            APPLICATION_LIMITS,
            Some("`limits`"),
            "upper limits of commands, each at most that of `limits`; MC_WriteParameter changes them, see parameters.md",
        ),
        Key::object(
            "defaults",
            "`defaults`",
            DEFAULTS,
            Some("the limits"),
            "values for a 0 at the pins Acceleration, Deceleration, Jerk, Snap; not above the limits",
        ),
        Key::number(
            "position",
            Bounds::FINITE,
            Some("0"),
            "position at the start (u); with `modulo` in the first turn",
            |config| Some(config.position),
            |config, value| config.position = value,
        ),
        word!(
            "state",
            start,
            [
                ("Disabled", StartState::Disabled),
                ("Standstill", StartState::Standstill)
            ],
            Some("`Disabled`"),
            "`Disabled`, or `Standstill`: powered as if MC_Power had been called"
        ),
        Key::object(
            "scaling",
            "`scaling`",
            SCALING,
            Some("the drive uses user units"),
            "the drive counts increments",
        ),
        Key::number(
            "modulo",
            Bounds {
                most: MODULO_MAX,
                ..Bounds::POSITIVE
            },
            Some("the axis is linear"),
            "length of a turn (u), above 0: positions wrap and are shown in [0, length), see modulo.md",
            |config| config.modulo,
            |config, value| config.modulo = Some(value),
        ),
        Key::new(
            "software_limits",
            Some("none"),
            "range in which moves may end, at least one of its limits; see below",
            Holds::Object(Object {
                needs_one: true,
                ..Object::new("`software_limits`", SOFTWARE_LIMITS)
            }),
        ),
        word!(
            "above_limit",
            above_limit,
            [("clamp", AboveLimit::Clamp), ("error", AboveLimit::Error)],
            Some("`clamp`"),
            "a value above a limit is lowered and recorded: `clamp`; the command is refused: `error`"
        ),
        Key::new(
            "profile",
            Some("`overlapped`"),
            "how moves to a position are planned (planner.md, section 13): from rest with every switch at a scan end by `overlapped`, `grid`, `sequential`; with switches anywhere by `online`; `fastest` is the shorter of `overlapped` and `online`, ties to `overlapped`; by a paper's method `s-curve`, `short-path` (no limit on snap) or `trapezoid` (none on jerk either). What the profile cannot serve, such as a move that takes over from a motion, is planned by `online`",
            Holds::Word {
                words: &PROFILES,
                get: |config| place!(MoveProfile::ALL, config.profile),
                set: |config, place| {
                    if let Some(profile) = MoveProfile::ALL.get(place) {
                        config.profile = *profile;
                    }
                },
            },
        ),
        Key::new(
            "queue",
            Some("8"),
            "commands that can wait behind the active one, 0 to 16",
            Holds::Whole {
                range: (0, QUEUE_MAX as u64),
                get: |config| Some(config.queue as u64),
                set: |config, value| config.queue = usize::try_from(value).unwrap_or(usize::MAX),
            },
        ),
        optional!(
            "stop_deceleration",
            stop_deceleration,
            "the limit",
            "deceleration (u/s^2) of ramps without a command: after power-off and after faults; not above the limit"
        ),
        optional!(
            "stop_jerk",
            stop_jerk,
            "the limit",
            "jerk (u/s^3) of the same ramps; not above the limit"
        ),
        Key::new(
            "stop",
            Some("MC_Stop has those of a command"),
            "dynamics of stops only, which may be above `limits`: of MC_Stop (they are its values for 0 at a pin and its upper limits), of ramps without a command, of limit switches, software limits and barred directions; at least one of them, and not beside `stop_deceleration` and `stop_jerk`",
            Holds::Object(Object {
                needs_one: true,
                ..Object::new("`stop`", STOP)
            }),
        ),
        word!(
            "on_power_off",
            on_power_off,
            [
                ("ramp", PowerOff::Ramp),
                ("coast", PowerOff::Coast),
                ("drive", PowerOff::Drive)
            ],
            Some("`ramp`"),
            "what the axis does when it is switched off while moving: `ramp`, `coast`, `drive`"
        ),
        flag!(
            "hardware_limits",
            hardware_limits,
            "true",
            "the axis stops at the limit switches of its drive (410, 210), see homing.md"
        ),
        Key::object(
            "homing",
            "`homing`",
            HOMING,
            Some("the present position becomes the reference"),
            "what MC_Home does, see homing.md",
        ),
        flag!(
            "needs_homed",
            needs_homed,
            "false",
            "absolute moves need MC_Home first"
        ),
        Key::number(
            "override_max",
            Bounds::from(1.0),
            Some("1"),
            "the largest factor that MC_SetOverride accepts, from 1; the limits still apply",
            |config| Some(config.override_max),
            |config, value| config.override_max = value,
        ),
        Key::new(
            "power_timeout",
            Some("no time limit"),
            "time (scans, or TIME, above 0) in which the drive has to confirm the power that MC_Power requests; after it MC_Power shows Error 503, the axis stays Disabled, and a new Enable or MC_Reset requests power again",
            Holds::Scans {
                range: (1, SCANS),
                get: |config| config.power_timeout,
                set: |config, value| config.power_timeout = Some(value),
            },
        ),
        Key::object(
            "in_position",
            "`in_position`",
            IN_POSITION,
            Some("the set position decides alone"),
            "when a move that ends at rest is done",
        ),
        optional!(
            "max_following_error",
            max_following_error,
            "not supervised",
            "a set position further than this (u) from the actual position is an axis error (404); MC_WriteParameter changes it"
        ),
        Key::object(
            "coupling",
            "`coupling`",
            COUPLING,
            Some("as without its keys"),
            "behaviour of the axis as a slave, and for slaves that follow its actual values, see coupling.md",
        ),
        word!(
            "jog_at_limit",
            jog_at_limit,
            [("error", JogAtLimit::Error), ("stop", JogAtLimit::Stop)],
            Some("`error`"),
            "a held MC_Jog at a software limit: ErrorStop before it, `error`; at rest on it, `stop`, see jogging.md"
        ),
        word!(
            "modulo_targets",
            modulo_targets,
            [("error", ModuloTargets::Error), ("wrap", ModuloTargets::Wrap)],
            Some("`error`"),
            "the target of an absolute move outside the first turn: refused (119), `error`; brought into it, `wrap`, see modulo.md"
        ),
        word!(
            "edge_while_busy",
            edge_while_busy,
            [
                ("restart", EdgeWhileBusy::Restart),
                ("ignore", EdgeWhileBusy::Ignore)
            ],
            Some("`restart`"),
            "a rising edge of Execute while the instance is Busy: starts the command anew, `restart`; does nothing, `ignore`, as blocks of Tc2 do. An edge of MC_Stop is never ignored: Execute is its lock"
        ),
        Key::new(
            "vibration",
            Some("none, nothing is shaped"),
            "list of the one or two modes in which its load swings: set-points are shaped so that moves end without swing, see vibration.md",
            Holds::List(&[
                Object::new("a mode of `vibration`", MODE_0),
                Object::new("a mode of `vibration`", MODE_1),
            ]),
        ),
    ],
);

/// The keys of the mode at an index of the list.
macro_rules! mode {
    ($place:literal, $frequency:literal, $damping:literal, $shaper:literal) => {
        &[
            Key::number(
                $frequency,
                Bounds::POSITIVE,
                None,
                "frequency without damping (Hz): a period takes from 4 to 4096 cycles",
                |config| config.vibration[$place].map(|mode| mode.frequency),
                |config, value| {
                    config.vibration[$place].get_or_insert(VibrationMode::new(value)).frequency = value;
                },
            ),
            Key::number(
                $damping,
                Bounds {
                    most: DAMPING_MAX,
                    ..Bounds::from(0.0)
                },
                Some("0"),
                "damping ratio, from 0 to 0.9",
                |config| config.vibration[$place].map(|mode| mode.damping),
                |config, value| {
                    if let Some(mode) = &mut config.vibration[$place] {
                        mode.damping = value;
                    }
                },
            ),
            Key::new(
                $shaper,
                Some("`ei`"),
                "`zv`, the shortest, for a frequency that is known; `zvd` and `ei`, twice as long, for one that is not; `period`, the mean over a period",
                Holds::Word {
                    words: &SHAPERS,
                    get: |config| {
                        let mode = config.vibration[$place]?;
                        place!(ShaperKind::ALL, mode.shaper)
                    },
                    set: |config, place| {
                        if let (Some(mode), Some(shaper)) = (&mut config.vibration[$place], ShaperKind::ALL.get(place)) {
                            mode.shaper = *shaper;
                        }
                    },
                },
            ),
        ]
    };
}

const MODE_0: &[Key<AxisConfig>] = mode!(
    0,
    "vibration.0.frequency",
    "vibration.0.damping",
    "vibration.0.shaper"
);
const MODE_1: &[Key<AxisConfig>] = mode!(
    1,
    "vibration.1.frequency",
    "vibration.1.damping",
    "vibration.1.shaper"
);

const SHAPERS: [&str; ShaperKind::ALL.len()] = names!(ShaperKind::ALL);

const PROFILES: [&str; MoveProfile::ALL.len()] = names!(MoveProfile::ALL);

const LIMITS: &[Key<AxisConfig>] = &[
    Key::number(
        "limits.velocity",
        Bounds::POSITIVE,
        None,
        "largest velocity (u/s)",
        |config| Some(config.limits.velocity),
        |config, value| config.limits.velocity = value,
    ),
    Key::number(
        "limits.acceleration",
        Bounds::POSITIVE,
        None,
        "largest rate while the speed grows (u/s^2)",
        |config| Some(config.limits.acceleration),
        // The default of the deceleration is the acceleration.
        |config, value| {
            config.limits.acceleration = value;
            if config.limits.deceleration == f64::INFINITY {
                config.limits.deceleration = value;
            }
        },
    ),
    Key {
        null: Some(Null::ABSENT),
        ..Key::number(
            "limits.deceleration",
            Bounds::POSITIVE,
            Some("the acceleration"),
            "largest rate while the speed falls (u/s^2)",
            |config| Some(config.limits.deceleration),
            |config, value| config.limits.deceleration = value,
        )
    },
    limit!(
        "limits.jerk",
        jerk,
        "no limit: the axis is of order 2",
        "largest jerk (u/s^3)"
    ),
    limit!(
        "limits.snap",
        snap,
        "no limit: the axis is of order 3 or 2",
        "largest snap (u/s^4)"
    ),
];

/// A key for a limit of the application. Its default is the limit of the axis, which is read before.
macro_rules! application {
    ($path:literal, $field:ident, $absent:literal, $doc:literal) => {
        Key {
            null: Some(Null::ABSENT),
            ..Key::number(
                $path,
                Bounds::POSITIVE,
                Some($absent),
                $doc,
                |config| {
                    let limits = config.application_limits.as_ref();
                    limits.map(|it| it.$field).filter(|limit| *limit != f64::INFINITY)
                },
                |config, value| application(config).$field = value,
            )
        }
    };
}

/// The limits of the application; they start as those of the axis.
fn application(config: &mut AxisConfig) -> &mut Limits {
    config.application_limits.get_or_insert(config.limits)
}

const APPLICATION_LIMITS: &[Key<AxisConfig>] = &[
    application!(
        "application_limits.velocity",
        velocity,
        "that of the axis",
        "largest velocity (u/s)"
    ),
    Key::number(
        "application_limits.acceleration",
        Bounds::POSITIVE,
        Some("that of the axis"),
        "largest rate while the speed grows (u/s^2)",
        |config| config.application_limits.map(|it| it.acceleration),
        // The default of the deceleration is the acceleration, as far as the axis permits.
        |config, value| {
            let deceleration = config.limits.deceleration;
            let limits = application(config);
            limits.acceleration = value;
            if limits.deceleration == deceleration {
                limits.deceleration = value.min(deceleration);
            }
        },
    ),
    application!(
        "application_limits.deceleration",
        deceleration,
        "the acceleration given here, as far as the axis has it; else that of the axis",
        "largest rate while the speed falls (u/s^2)"
    ),
    application!(
        "application_limits.jerk",
        jerk,
        "that of the axis",
        "largest jerk (u/s^3)"
    ),
    application!(
        "application_limits.snap",
        snap,
        "that of the axis",
        "largest snap (u/s^4)"
    ),
];

/// A key for one of the stop limits.
macro_rules! stop {
    ($path:literal, $field:ident, $doc:literal) => {
        Key::number(
            $path,
            Bounds::POSITIVE,
            Some("the limit"),
            $doc,
            |config| config.stop.and_then(|stop| stop.$field),
            |config, value| config.stop.get_or_insert_default().$field = Some(value),
        )
    };
}

const STOP: &[Key<AxisConfig>] = &[
    stop!("stop.deceleration", deceleration, "deceleration (u/s^2)"),
    stop!("stop.jerk", jerk, "jerk (u/s^3)"),
    stop!("stop.snap", snap, "snap (u/s^4)"),
];

const DEFAULTS: &[Key<AxisConfig>] = &[
    optional!(
        "defaults.acceleration",
        defaults.acceleration,
        "the limit",
        "for Acceleration (u/s^2)"
    ),
    optional!(
        "defaults.deceleration",
        defaults.deceleration,
        "the limit",
        "for Deceleration (u/s^2)"
    ),
    optional!("defaults.jerk", defaults.jerk, "the limit", "for Jerk (u/s^3)"),
    optional!("defaults.snap", defaults.snap, "the limit", "for Snap (u/s^4)"),
];

/// Changes a scaling, starting from one increment per unit; an invalid change is left out.
fn scale(config: &mut AxisConfig, change: impl FnOnce(&mut (u32, u32, bool, f64))) {
    let mut parts = config.scaling.map_or((1, 1, false, 0.0), |old| {
        (old.increments(), old.units(), old.invert(), old.offset())
    });
    change(&mut parts);
    let (increments, units, invert, offset) = parts;
    if let Ok(scaling) = Scaling::new(increments, units, invert, offset) {
        config.scaling = Some(scaling);
    }
}

const COUNT: (u64, u64) = (1, u32::MAX as u64);

const SCALING: &[Key<AxisConfig>] = &[
    Key::new(
        "scaling.increments",
        None,
        "this number of increments of the drive ..",
        Holds::Whole {
            range: COUNT,
            get: |config| config.scaling.map(|scaling| scaling.increments().into()),
            set: |config, value| scale(config, |parts| parts.0 = u32::try_from(value).unwrap_or(0)),
        },
    ),
    Key::new(
        "scaling.units",
        None,
        ".. is this number of user units",
        Holds::Whole {
            range: COUNT,
            get: |config| config.scaling.map(|scaling| scaling.units().into()),
            set: |config, value| scale(config, |parts| parts.1 = u32::try_from(value).unwrap_or(0)),
        },
    ),
    Key::new(
        "scaling.invert",
        Some("false"),
        "the drive counts the other way",
        Holds::Bool {
            get: |config| config.scaling.is_some_and(|scaling| scaling.invert()),
            set: |config, value| scale(config, |parts| parts.2 = value),
        },
    ),
    Key::number(
        "scaling.offset",
        Bounds::FINITE,
        Some("0"),
        "position at increment 0 (u)",
        |config| config.scaling.map(|scaling| scaling.offset()),
        |config, value| scale(config, |parts| parts.3 = value),
    ),
];

const NO_END: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

const SOFTWARE_LIMITS: &[Key<AxisConfig>] = &[
    Key::number(
        "software_limits.min",
        Bounds::FINITE,
        Some("none"),
        "lowest position (u)",
        |config| {
            config
                .software_limits
                .map(|(min, _)| min)
                .filter(|min| *min != NO_END.0)
        },
        |config, value| config.software_limits.get_or_insert(NO_END).0 = value,
    ),
    Key::number(
        "software_limits.max",
        Bounds::FINITE,
        Some("none"),
        "highest position (u), above the lowest",
        |config| {
            config
                .software_limits
                .map(|(_, max)| max)
                .filter(|max| *max != NO_END.1)
        },
        |config, value| config.software_limits.get_or_insert(NO_END).1 = value,
    ),
];

const NO_WINDOW: InPosition = InPosition {
    window: 0.0,
    scans: 0,
};

const IN_POSITION: &[Key<AxisConfig>] = &[
    Key::number(
        "in_position.window",
        Bounds::POSITIVE,
        None,
        "the actual position has been within this (u) of the set position ..",
        |config| config.in_position.map(|it| it.window),
        |config, value| config.in_position.get_or_insert(NO_WINDOW).window = value,
    ),
    Key::new(
        "in_position.time",
        Some("0"),
        ".. for this long (scans, or TIME)",
        Holds::Scans {
            range: (0, SCANS),
            get: |config| config.in_position.map(|it| it.scans.into()),
            set: |config, value| {
                config.in_position.get_or_insert(NO_WINDOW).scans = u32::try_from(value).unwrap_or(u32::MAX);
            },
        },
    ),
];

const COUPLING: &[Key<AxisConfig>] = &[
    word!(
        "coupling.on_limit",
        following.on_limit,
        [
            ("lag", OnLimit::Lag),
            ("error", OnLimit::Error),
            ("slow_master", OnLimit::SlowMaster)
        ],
        Some("`lag`"),
        "if it cannot follow: it lags (`lag`), stops with error 420 (`error`), or limits its master to what it can follow (`slow_master`)"
    ),
    optional!(
        "coupling.max_deviation",
        following.max_deviation,
        "any",
        "largest distance from the law (u) once it was on it; more is error 420"
    ),
    word!(
        "coupling.on_master_lost",
        following.on_master_lost,
        [("error", OnMasterLost::Error), ("hold", OnMasterLost::Hold)],
        Some("`error`"),
        "if its master goes out of operation: it stops with error 421 (`error`), or comes to rest and stays coupled (`hold`)"
    ),
    Key::new(
        "coupling.actual_filter",
        Some("16 scans"),
        "length of each of the four averages through which slaves see its actual values (scans, at most 64, or TIME; 0 for none)",
        Holds::Scans {
            range: (0, ACTUAL_FILTER_MAX as u64),
            get: |config| Some(config.following.actual_filter.into()),
            set: |config, value| config.following.actual_filter = u32::try_from(value).unwrap_or(u32::MAX),
        },
    ),
    flag!(
        "coupling.actual_lead",
        following.actual_lead,
        "false",
        "slaves of its actual values see it ahead by the delay of the averages"
    ),
    Key::new(
        "coupling.cam_continuity",
        Some("3 with a snap limit, 2 with a jerk limit, 1 without"),
        "number of derivatives of a cam that must be continuous (0 to 3); if its limits require more, it stops at the rows at which one jumps",
        Holds::Whole {
            range: (0, CAM_CONTINUITY_MAX as u64),
            get: |config| config.following.cam_continuity.map(Into::into),
            set: |config, value| {
                config.following.cam_continuity = Some(u8::try_from(value).unwrap_or(CAM_CONTINUITY_MAX));
            },
        },
    ),
];

const PROCEDURES: [&str; Procedure::ALL.len()] = names!(Procedure::ALL);

const NO_BLOCK: BlockDetection = BlockDetection {
    velocity: 0.0,
    scans: 0,
};

const HOMING: &[Key<AxisConfig>] = &[
    Key::new(
        "homing.procedure",
        None,
        "`direct`, `absolute_switch`, `limit_switch`, `reference_pulse`, `block`, `drive`",
        Holds::Word {
            words: &PROCEDURES,
            get: |config| place!(Procedure::ALL, config.homing.procedure),
            set: |config, place| {
                if let Some(procedure) = Procedure::ALL.get(place) {
                    config.homing.procedure = *procedure;
                }
            },
        },
    ),
    word!(
        "homing.direction",
        homing.direction,
        [
            ("positive", HomeDirection::Positive),
            ("negative", HomeDirection::Negative),
            ("switch_positive", HomeDirection::SwitchPositive),
            ("switch_negative", HomeDirection::SwitchNegative),
        ],
        Some("`positive`"),
        "where the search begins: `positive`, `negative`; for a home switch also `switch_positive`, `switch_negative`"
    ),
    word!(
        "homing.edge",
        homing.edge,
        [
            ("rising", SwitchEdge::Rising),
            ("falling", SwitchEdge::Falling),
            ("switch_positive", SwitchEdge::SwitchPositive),
            ("switch_negative", SwitchEdge::SwitchNegative),
        ],
        Some("`rising`"),
        "of the home switch: `rising`, `falling`, `switch_positive`, `switch_negative`"
    ),
    Key::number(
        "homing.velocity",
        Bounds::POSITIVE,
        Some("needed for a search"),
        "of the search (u/s), not above that of the limits",
        |config| Some(config.homing.velocity).filter(|velocity| *velocity != 0.0),
        |config, value| config.homing.velocity = value,
    ),
    optional!(
        "homing.creep",
        homing.creep,
        "the first one counts",
        "of the second approach of a switch (u/s), not above `velocity`"
    ),
    flag!(
        "homing.pulse",
        homing.pulse,
        "false",
        "the next reference pulse behind the edge of the switch is the reference"
    ),
    Key::object(
        "homing.block",
        "`block` of a homing",
        BLOCK,
        Some("needed for `block`"),
        "condition for a mechanical stop",
    ),
    Key::new(
        "homing.time_limit",
        Some("none"),
        "of the search (scans, or TIME)",
        Holds::Scans {
            range: (0, SCANS),
            get: |config| config.homing.time_limit,
            set: |config, value| config.homing.time_limit = Some(value),
        },
    ),
    optional!(
        "homing.distance_limit",
        homing.distance_limit,
        "none",
        "travel of the search (u)"
    ),
];

const BLOCK: &[Key<AxisConfig>] = &[
    Key::number(
        "homing.block.velocity",
        Bounds::POSITIVE,
        None,
        "the actual velocity is below this (u/s), which is not above that of the search ..",
        |config| config.homing.block.map(|block| block.velocity),
        |config, value| config.homing.block.get_or_insert(NO_BLOCK).velocity = value,
    ),
    Key::new(
        "homing.block.time",
        None,
        ".. for this long (scans, or TIME)",
        Holds::Scans {
            range: (0, SCANS),
            get: |config| config.homing.block.map(|block| block.scans.into()),
            set: |config, value| {
                config.homing.block.get_or_insert(NO_BLOCK).scans = u32::try_from(value).unwrap_or(u32::MAX);
            },
        },
    ),
];

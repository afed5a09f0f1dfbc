//! The keys of the simulated drives, each described once, like those of an axis
//! ([`standstill_axis::keys`]).

use crate::cia402::Reaction;
use crate::mechanism::{Load, Stops};
use crate::simulated::{Cia402Setup, IdealDriveSetup, MotorSetup, PlantSetup};
use crate::switches::Marker;
use standstill_axis::DELAY_MAX;
use standstill_axis::keys::{Bounds, Holds, Key, Null, Object};

/// The largest number of scans that a file can give exactly.
const SCANS: (u64, u64) = (0, 1 << 53);

/// From 0 on.
const FROM_ZERO: Bounds = Bounds::from(0.0);

/// The default of a place that is not given.
const NOWHERE: (f64, f64) = (0.0, 0.0);

fn short(scans: u64) -> u32 {
    u32::try_from(scans).unwrap_or(u32::MAX)
}

/// How long positions take.
macro_rules! delay {
    () => {
        Key::new(
            "delay",
            Some("0"),
            "scans by which the actual position follows its command, 0 to 64",
            Holds::Scans {
                range: (0, DELAY_MAX as u64),
                get: |setup| Some(setup.delay as u64),
                set: |setup, scans| setup.delay = usize::try_from(scans).unwrap_or(usize::MAX),
            },
        )
    };
}

/// How long power takes.
macro_rules! power_on {
    () => {
        Key {
            null: Some(Null {
                is: |setup| setup.power_on.is_none(),
                set: |setup| setup.power_on = None,
            }),
            ..Key::new(
                "power_on",
                Some("0"),
                "scans until the drive confirms its power; null: never",
                Holds::Scans {
                    range: SCANS,
                    get: |setup| setup.power_on.map(u64::from),
                    set: |setup, scans| setup.power_on = Some(short(scans)),
                },
            )
        }
    };
}

/// Switches and markers along the travel of any drive.
macro_rules! limit_switches {
    () => {
        Key::object(
            "limit_switches",
            "`limit_switches`",
            &[
                Key::number(
                    "limit_switches.negative",
                    Bounds::FINITE,
                    None,
                    "the one in negative direction is active up to here (u)",
                    |setup| setup.switches.limits.map(|(end, _)| end),
                    |setup, end| setup.switches.limits.get_or_insert(NOWHERE).0 = end,
                ),
                Key::number(
                    "limit_switches.positive",
                    Bounds::FINITE,
                    None,
                    "the other one from here on (u), not below",
                    |setup| setup.switches.limits.map(|(_, end)| end),
                    |setup, end| setup.switches.limits.get_or_insert(NOWHERE).1 = end,
                ),
            ],
            Some("none"),
            "switches at the ends of the travel",
        )
    };
}

/// The switches and pulses along the travel of any drive.
macro_rules! home_switch {
    () => {
        Key::object(
            "home_switch",
            "`home_switch`",
            &[
                Key::number(
                    "home_switch.from",
                    Bounds::FINITE,
                    None,
                    "it is active from here (u) ..",
                    |setup| setup.switches.home.map(|(end, _)| end),
                    |setup, end| setup.switches.home.get_or_insert(NOWHERE).0 = end,
                ),
                Key::number(
                    "home_switch.to",
                    Bounds::FINITE,
                    None,
                    ".. to here (u), not below",
                    |setup| setup.switches.home.map(|(_, end)| end),
                    |setup, end| setup.switches.home.get_or_insert(NOWHERE).1 = end,
                ),
            ],
            Some("none"),
            "the home switch",
        )
    };
}

const NO_MARKER: Marker = Marker { at: 0.0, every: None };

/// The switches and pulses along the travel of any drive.
macro_rules! marker {
    () => {
        Key::object(
            "marker",
            "`marker`",
            &[
                Key::number(
                    "marker.at",
                    Bounds::FINITE,
                    None,
                    "a reference pulse is here (u), which the drive latches between scans",
                    |setup| setup.switches.marker.map(|marker| marker.at),
                    |setup, at| setup.switches.marker.get_or_insert(NO_MARKER).at = at,
                ),
                Key::number(
                    "marker.every",
                    Bounds::POSITIVE,
                    Some("there is one"),
                    "the distance from one pulse to the next (u), above 0",
                    |setup| setup.switches.marker.and_then(|marker| marker.every),
                    |setup, every| setup.switches.marker.get_or_insert(NO_MARKER).every = Some(every),
                ),
            ],
            Some("none"),
            "reference pulses of the encoder",
        )
    };
}

/// The keys of the ideal drive.
pub static IDEAL: Object<IdealDriveSetup> = Object::new(
    "the ideal drive",
    &[
        delay!(),
        power_on!(),
        limit_switches!(),
        home_switch!(),
        marker!(),
    ],
);

/// The ways a CiA 402 drive comes to rest by itself; the last one is for the quick stop only.
const REACTIONS: [Reaction; 3] = [Reaction::Coast, Reaction::Ramp, Reaction::RampAndStay];

/// A reaction of a CiA 402 drive.
macro_rules! reaction {
    ($path:literal, $field:ident, $words:expr, $absent:literal, $doc:literal) => {
        Key::new(
            $path,
            Some($absent),
            $doc,
            Holds::Word {
                words: $words,
                get: |setup: &Cia402Setup| REACTIONS.iter().position(|known| *known == setup.$field),
                set: |setup, place| {
                    if let Some(reaction) = REACTIONS.get(place) {
                        setup.$field = *reaction;
                    }
                },
            },
        )
    };
}

/// The keys of a CiA 402 drive.
pub static CIA402: Object<Cia402Setup> = Object::new(
    "a CiA 402 drive",
    &[
        delay!(),
        power_on!(),
        Key::new(
            "start_up",
            Some("0"),
            "scans of self-test before it can be switched on",
            Holds::Scans {
                range: SCANS,
                get: |setup| Some(setup.start_up.into()),
                set: |setup, scans| setup.start_up = short(scans),
            },
        ),
        Key::number(
            "deceleration",
            Bounds::POSITIVE,
            Some("that of the axis limits"),
            "rate of the drive's own ramps (u/s^2)",
            |setup| setup.deceleration,
            |setup, rate| setup.deceleration = Some(rate),
        ),
        reaction!(
            "quick_stop",
            quick_stop,
            &["coast", "ramp", "stay"],
            "`ramp`",
            "605Ah: `coast`, `ramp`, or `stay`: a ramp, then torque until the next request"
        ),
        reaction!(
            "on_disable",
            on_disable,
            &["coast", "ramp"],
            "`coast`",
            "605Bh and 605Ch, leaving Operation enabled by control word: `coast` or `ramp`"
        ),
        reaction!(
            "on_fault",
            on_fault,
            &["coast", "ramp"],
            "`ramp`",
            "605Eh: `coast` or `ramp`"
        ),
        Key::object(
            "homing",
            "`homing` of a drive",
            NODE_HOMING,
            Some("it has no homing mode"),
            "homing mode: it moves to the point at which its home switch goes on; a limit switch on the way is its error (8612h)",
        ),
        Key::object(
            "motor",
            "the motor of a drive",
            MOTOR,
            Some("it has no torque mode and measures no torque"),
            "its load under a torque, in a unit of torque of your choice. In position mode it follows its target with any torque that this needs, and reports the torque",
        ),
        limit_switches!(),
        home_switch!(),
        marker!(),
    ],
);

const NO_HOMING: (bool, f64) = (true, 0.0);

const NODE_HOMING: &[Key<Cia402Setup>] = &[
    Key::number(
        "homing.velocity",
        Bounds::POSITIVE,
        None,
        "its velocity (u/s)",
        |setup| setup.homing.map(|(_, velocity)| velocity),
        |setup, velocity| setup.homing.get_or_insert(NO_HOMING).1 = velocity,
    ),
    Key::new(
        "homing.direction",
        Some("`positive`"),
        "`positive`, `negative`",
        Holds::Word {
            words: &["positive", "negative"],
            get: |setup| setup.homing.map(|(up, _)| usize::from(!up)),
            set: |setup, place| setup.homing.get_or_insert(NO_HOMING).0 = place == 0,
        },
    ),
];

/// Default ratio of the largest torque to the rated torque.
const MAX_TORQUE: f64 = 3.0;

const NO_MOTOR: MotorSetup = MotorSetup {
    rated_torque: 0.0,
    max_torque: 0.0,
    inertia: 0.0,
    viscous: 0.0,
    coulomb: 0.0,
};

/// A number of the motor.
macro_rules! motor {
    ($path:literal, $field:ident, $bounds:expr, $absent:expr, $doc:literal) => {
        Key::number(
            $path,
            $bounds,
            $absent,
            $doc,
            |setup| setup.motor.map(|motor| motor.$field),
            |setup, value| setup.motor.get_or_insert(NO_MOTOR).$field = value,
        )
    };
}

const MOTOR: &[Key<Cia402Setup>] = &[
    Key::number(
        "motor.rated_torque",
        Bounds::POSITIVE,
        None,
        "6076h (torque)",
        |setup| setup.motor.map(|motor| motor.rated_torque),
        |setup, torque| {
            let motor = setup.motor.get_or_insert(NO_MOTOR);
            motor.rated_torque = torque;
            if motor.max_torque == 0.0 {
                motor.max_torque = MAX_TORQUE * torque;
            }
        },
    ),
    motor!(
        "motor.inertia",
        inertia,
        Bounds::POSITIVE,
        None,
        "torque for an acceleration (torque s^2/u)"
    ),
    motor!(
        "motor.max_torque",
        max_torque,
        Bounds::POSITIVE,
        Some("three times the rated one"),
        "6072h (torque), from a thousandth of the rated one to 32.767 times as much"
    ),
    motor!(
        "motor.viscous",
        viscous,
        FROM_ZERO,
        Some("0"),
        "friction that grows with velocity (torque s/u)"
    ),
    motor!(
        "motor.coulomb",
        coulomb,
        FROM_ZERO,
        Some("0"),
        "friction that does not (torque)"
    ),
];

/// The keys of a drive with a mechanism. Gains that are not given are NaN until
/// [`PlantSetup::with_gains`].
pub static PLANT: Object<PlantSetup> = Object::new(
    "a plant",
    &[
        power_on!(),
        Key::number(
            "inertia",
            Bounds::POSITIVE,
            None,
            "of the motor: torque for an acceleration (torque s^2/u)",
            |setup| Some(setup.plant.inertia),
            |setup, value| setup.plant.inertia = value,
        ),
        Key::number(
            "viscous",
            FROM_ZERO,
            Some("0"),
            "friction at the motor that grows with velocity (torque s/u)",
            |setup| Some(setup.plant.viscous),
            |setup, value| setup.plant.viscous = value,
        ),
        Key::number(
            "coulomb",
            FROM_ZERO,
            Some("0"),
            "friction at the motor that does not (torque)",
            |setup| Some(setup.plant.coulomb),
            |setup, value| setup.plant.coulomb = value,
        ),
        Key::object(
            "load",
            "the load of a plant",
            LOAD,
            Some("the mechanism is rigid"),
            "load on a spring",
        ),
        Key::object(
            "gains",
            "the gains of a plant",
            GAINS,
            Some("what holds any rigid plant"),
            "of its loops",
        ),
        Key::number(
            "torque",
            Bounds::POSITIVE,
            Some("no limit"),
            "largest torque",
            |setup| Some(setup.gains.torque).filter(|torque| *torque != f64::INFINITY),
            |setup, value| setup.gains.torque = value,
        ),
        Key::object(
            "stops",
            "`stops`",
            STOPS,
            Some("the travel has no end"),
            "mechanical stops: springs at the ends of the travel",
        ),
        limit_switches!(),
        home_switch!(),
        marker!(),
    ],
);

const NO_LOAD: Load = Load {
    inertia: 0.0,
    stiffness: 0.0,
    damping: 0.0,
};

/// A number of the load.
macro_rules! load {
    ($path:literal, $field:ident, $bounds:expr, $absent:expr, $doc:literal) => {
        Key::number(
            $path,
            $bounds,
            $absent,
            $doc,
            |setup| setup.plant.load.map(|load| load.$field),
            |setup, value| setup.plant.load.get_or_insert(NO_LOAD).$field = value,
        )
    };
}

const LOAD: &[Key<PlantSetup>] = &[
    load!(
        "load.inertia",
        inertia,
        Bounds::POSITIVE,
        None,
        "its inertia (torque s^2/u)"
    ),
    load!(
        "load.stiffness",
        stiffness,
        Bounds::POSITIVE,
        None,
        "of the spring (torque/u)"
    ),
    load!(
        "load.damping",
        damping,
        FROM_ZERO,
        Some("0"),
        "of the spring (torque s/u)"
    ),
];

/// A gain.
macro_rules! gain {
    ($path:literal, $field:ident, $absent:literal, $doc:literal) => {
        Key::number(
            $path,
            FROM_ZERO,
            Some($absent),
            $doc,
            |setup| Some(setup.gains.$field).filter(|gain| !gain.is_nan()),
            |setup, value| setup.gains.$field = value,
        )
    };
}

const GAINS: &[Key<PlantSetup>] = &[
    gain!(
        "gains.position",
        position,
        "what holds any rigid plant",
        "velocity for a position error (1/s)"
    ),
    gain!(
        "gains.velocity",
        velocity,
        "what holds any rigid plant",
        "torque for a velocity error (torque s/u)"
    ),
    gain!(
        "gains.integral",
        integral,
        "what holds any rigid plant",
        "torque a second for a velocity error (torque/u)"
    ),
    gain!(
        "gains.feed_velocity",
        feed_velocity,
        "1",
        "part of the set velocity that is fed forward"
    ),
    gain!(
        "gains.feed_acceleration",
        feed_acceleration,
        "1",
        "part of the torque for the set acceleration that is fed forward"
    ),
];

const NO_STOPS: Stops = Stops {
    ends: NOWHERE,
    stiffness: 0.0,
    damping: 0.0,
};

const STOPS: &[Key<PlantSetup>] = &[
    Key::number(
        "stops.negative",
        Bounds::FINITE,
        None,
        "where the lower one begins (u)",
        |setup| setup.stops.map(|stops| stops.ends.0),
        |setup, value| setup.stops.get_or_insert(NO_STOPS).ends.0 = value,
    ),
    Key::number(
        "stops.positive",
        Bounds::FINITE,
        None,
        "where the upper one begins (u), above the lower one",
        |setup| setup.stops.map(|stops| stops.ends.1),
        |setup, value| setup.stops.get_or_insert(NO_STOPS).ends.1 = value,
    ),
    Key::number(
        "stops.stiffness",
        Bounds::POSITIVE,
        None,
        "of the springs (torque/u)",
        |setup| setup.stops.map(|stops| stops.stiffness),
        |setup, value| setup.stops.get_or_insert(NO_STOPS).stiffness = value,
    ),
    Key::number(
        "stops.damping",
        FROM_ZERO,
        Some("0"),
        "of the springs (torque s/u)",
        |setup| setup.stops.map(|stops| stops.damping),
        |setup, value| setup.stops.get_or_insert(NO_STOPS).damping = value,
    ),
];

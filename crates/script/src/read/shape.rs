//! Which keys stand in which object of a script. The reader and the JSON Schema both read this.

/// The keys of one kind of object.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    /// The object in words, as in "unknown key `x` in ..".
    pub(crate) what: &'static str,
    /// Keys that exist.
    pub(crate) keys: &'static [&'static str],
    /// Keys of the format whose feature does not exist yet.
    pub(crate) later: &'static [&'static str],
}

const fn shape(what: &'static str, keys: &'static [&'static str]) -> Shape {
    Shape {
        what,
        keys,
        later: &[],
    }
}

pub(crate) const SCRIPT: Shape = shape(
    "a script",
    &[
        "$schema",
        "standstill",
        "title",
        "covers",
        "cycle",
        "scans",
        "include",
        "override",
        "parameters",
        "axes",
        "inputs",
        "tasks",
        "blocks",
        "tables",
        "cams",
        "programs",
        "steps",
        "expect",
        "stop_when",
        "after",
        "golden",
        "clamps",
    ],
);
/// What scripts include.
pub(crate) const MACHINE: Shape = shape(
    "a machine file",
    &[
        "$schema",
        "standstill",
        "title",
        "include",
        "override",
        "parameters",
        "axes",
        "inputs",
        "tasks",
        "blocks",
        "note",
    ],
);
/// A table of a script.
pub(crate) const TABLE: Shape = shape("a table", &["type", "rows", "csv", "note"]);
/// Where a pin takes it.
pub(crate) const TABLE_USE: Shape = shape("a table's use", &["table", "note"]);
/// The store of cams.
pub(crate) const CAMS: Shape = shape("`cams`", &["slots", "stretches", "note"]);
pub(crate) const PARAM: Shape = shape("a parameter's use", &["param", "note"]);

pub(crate) const AXIS: Shape = Shape {
    what: "an axis",
    keys: &[
        "unit",
        "limits",
        "application_limits",
        "defaults",
        "position",
        "state",
        "scaling",
        "modulo",
        "software_limits",
        "above_limit",
        "profile",
        "queue",
        "stop_deceleration",
        "stop_jerk",
        "stop",
        "on_power_off",
        "hardware_limits",
        "homing",
        "needs_homed",
        "override_max",
        "power_timeout",
        "in_position",
        "max_following_error",
        "coupling",
        "jog_at_limit",
        "modulo_targets",
        "edge_while_busy",
        "drive",
        "vacuous",
        "note",
    ],
    later: &[],
};
pub(crate) const LIMITS: Shape = shape(
    "`limits`",
    &["velocity", "acceleration", "deceleration", "jerk", "snap", "note"],
);
pub(crate) const APPLICATION_LIMITS: Shape = shape(
    "`application_limits`",
    &["velocity", "acceleration", "deceleration", "jerk", "snap", "note"],
);
pub(crate) const STOP: Shape = shape("`stop`", &["deceleration", "jerk", "snap", "note"]);
pub(crate) const DEFAULTS: Shape = shape(
    "`defaults`",
    &["acceleration", "deceleration", "jerk", "snap", "note"],
);
pub(crate) const SCALING: Shape = shape("`scaling`", &["increments", "units", "invert", "offset", "note"]);
pub(crate) const SOFTWARE_LIMITS: Shape = shape("`software_limits`", &["min", "max", "note"]);
pub(crate) const IN_POSITION: Shape = shape("`in_position`", &["window", "time", "note"]);
pub(crate) const COUPLING: Shape = Shape {
    what: "`coupling`",
    keys: &[
        "on_limit",
        "max_deviation",
        "on_master_lost",
        "actual_filter",
        "actual_lead",
        "note",
    ],
    later: &["cam_continuity"],
};
pub(crate) const HOMING: Shape = shape(
    "`homing`",
    &[
        "procedure",
        "direction",
        "edge",
        "velocity",
        "creep",
        "pulse",
        "block",
        "time_limit",
        "distance_limit",
        "note",
    ],
);
pub(crate) const BLOCK_DETECTION: Shape = shape("`block` of a homing", &["velocity", "time", "note"]);
pub(crate) const DRIVE: Shape = Shape {
    what: "`drive`",
    keys: &["ideal", "cia402", "plant", "note"],
    later: &[],
};
pub(crate) const IDEAL: Shape = shape(
    "the ideal drive",
    &[
        "delay",
        "power_on",
        "limit_switches",
        "home_switch",
        "marker",
        "note",
    ],
);
pub(crate) const CIA402: Shape = shape(
    "a CiA 402 drive",
    &[
        "delay",
        "power_on",
        "start_up",
        "deceleration",
        "quick_stop",
        "on_disable",
        "on_fault",
        "homing",
        "motor",
        "limit_switches",
        "home_switch",
        "marker",
        "note",
    ],
);
pub(crate) const PLANT: Shape = shape(
    "a plant",
    &[
        "power_on",
        "inertia",
        "viscous",
        "coulomb",
        "load",
        "gains",
        "torque",
        "stops",
        "limit_switches",
        "home_switch",
        "marker",
        "note",
    ],
);
pub(crate) const LOAD: Shape = shape(
    "the load of a plant",
    &["inertia", "stiffness", "damping", "note"],
);
pub(crate) const STOPS: Shape = shape(
    "the stops of a plant",
    &["negative", "positive", "stiffness", "damping", "note"],
);
pub(crate) const GAINS: Shape = shape(
    "the gains of a plant",
    &[
        "position",
        "velocity",
        "integral",
        "feed_velocity",
        "feed_acceleration",
        "note",
    ],
);
pub(crate) const LIMIT_SWITCHES: Shape = shape("`limit_switches`", &["negative", "positive", "note"]);
pub(crate) const HOME_SWITCH: Shape = shape("`home_switch`", &["from", "to", "note"]);
pub(crate) const NODE_HOMING: Shape = shape("`homing` of a drive", &["direction", "velocity", "note"]);
pub(crate) const MOTOR: Shape = shape(
    "the motor of a drive",
    &[
        "rated_torque",
        "max_torque",
        "inertia",
        "viscous",
        "coulomb",
        "note",
    ],
);
pub(crate) const MARKER: Shape = shape("`marker`", &["at", "every", "note"]);

pub(crate) const BLOCK: Shape = shape("a block", &["name", "type", "task", "pins", "vacuous", "note"]);
pub(crate) const WIRE: Shape = shape("a wire", &["from", "not", "any", "all", "note"]);
/// The keys of a wire that say what it does; it has exactly one of them.
pub(crate) const WIRE_KINDS: [&str; 4] = ["from", "not", "any", "all"];
pub(crate) const TASK: Shape = shape("a task", &["interval", "priority", "single", "watchdog"]);

pub(crate) const PROGRAM: Shape = shape(
    "a program",
    &[
        "wasm",
        "st",
        "program",
        "task",
        "axes",
        "trace",
        "fuel",
        "memory",
        "symbols",
        "may_fault",
        "vacuous",
        "note",
    ],
);
/// The keys of a program that is a module already.
pub(crate) const PROGRAM_MODULE: Shape = shape(
    "a program",
    &[
        "wasm",
        "task",
        "fuel",
        "memory",
        "symbols",
        "may_fault",
        "vacuous",
        "note",
    ],
);
/// The keys of a program in Structured Text.
pub(crate) const PROGRAM_TEXT: Shape = shape(
    "a program",
    &[
        "st",
        "program",
        "task",
        "axes",
        "trace",
        "fuel",
        "memory",
        "may_fault",
        "vacuous",
        "note",
    ],
);
pub(crate) const SYMBOL: Shape = shape("a symbol", &["type", "address", "export", "note"]);

pub(crate) const INPUT: Shape = shape("an input variable", &["value", "vacuous", "note"]);

pub(crate) const STEP: Shape = shape(
    "a step",
    &[
        "at", "when", "after", "every", "set", "fault", "clear", "drive", "vacuous", "note",
    ],
);
pub(crate) const FAULT: Shape = shape("`fault`", &["axis", "kind", "code", "note"]);
pub(crate) const CLEAR: Shape = shape("`clear`", &["axis", "note"]);
pub(crate) const DRIVE_STEP: Shape = shape(
    "a `drive` step",
    &[
        "axis", "displace", "remote", "warning", "input", "probe", "report", "note",
    ],
);
pub(crate) const DRIVE_REPORT: Shape = shape("`report` of a drive", &["position", "torque", "note"]);
pub(crate) const DRIVE_INPUT: Shape = shape("`input` of a drive", &["number", "value", "note"]);
pub(crate) const DRIVE_PROBE: Shape = shape("`probe` of a drive", &["number", "at", "value", "note"]);

pub(crate) const COMPARISON: Shape = shape(
    "a comparison",
    &[
        "near", "within", "le", "ge", "lt", "gt", "ne", "abs_le", "same_as", "note",
    ],
);

pub(crate) const CLAIM_AT: Shape = shape("a claim with `at`", &["at", "that", "vacuous", "note"]);
pub(crate) const CLAIM_BY: Shape = shape("a claim with `by`", &["by", "from", "that", "vacuous", "note"]);
pub(crate) const CLAIM_ALWAYS: Shape = shape(
    "a claim with `always`",
    &["always", "from", "to", "while", "vacuous", "note"],
);
pub(crate) const CLAIM_NEVER: Shape = shape(
    "a claim with `never`",
    &["never", "for", "from", "to", "while", "vacuous", "note"],
);
pub(crate) const CLAIM_ONCE: Shape = shape("a claim with `once`", &["once", "from", "to", "vacuous", "note"]);
pub(crate) const CLAIM_EXCLUSIVE: Shape = shape(
    "a claim with `exclusive`",
    &["exclusive", "from", "to", "vacuous", "note"],
);
pub(crate) const CLAIM_WITHIN_LIMITS: Shape = shape(
    "a claim with `within_limits`",
    &["within_limits", "factor", "from", "to", "vacuous", "note"],
);
pub(crate) const CLAIM_FOLLOWS: Shape = shape(
    "a claim with `follows`",
    &["follows", "from", "to", "vacuous", "note"],
);
pub(crate) const FOLLOWS: Shape = shape(
    "`follows`",
    &["slave", "master", "num", "den", "while", "anchor", "note"],
);
pub(crate) const ANCHOR: Shape = shape("`anchor`", &["master", "slave", "note"]);

pub(crate) const CLAIM_WHEN: Shape = shape(
    "a claim with `when`",
    &["when", "within", "that", "from", "to", "while", "vacuous", "note"],
);
pub(crate) const CLAIM_AFTER: Shape = shape(
    "a claim with `after`",
    &["after", "by", "that", "from", "to", "while", "vacuous", "note"],
);
pub(crate) const CLAIM_DURATION: Shape = shape(
    "a claim with `duration`",
    &[
        "duration", "le", "ge", "each", "from", "to", "while", "vacuous", "note",
    ],
);
pub(crate) const CLAIM_COUNT: Shape = shape(
    "a claim with `count`",
    &[
        "count", "eq", "le", "ge", "from", "to", "while", "vacuous", "note",
    ],
);
/// Where a window begins or ends.
pub(crate) const WINDOW_EDGE: Shape = shape("the begin or end of a window", &["when", "note"]);
pub(crate) const NEAR_TO: Shape = shape("`near`", &["of", "plus", "note"]);

/// The kinds of claims; the first key of each names it. One with `after` has a `by`, too.
pub(crate) const CLAIMS: [Shape; 12] = [
    CLAIM_AFTER,
    CLAIM_WHEN,
    CLAIM_DURATION,
    CLAIM_COUNT,
    CLAIM_AT,
    CLAIM_BY,
    CLAIM_ALWAYS,
    CLAIM_NEVER,
    CLAIM_ONCE,
    CLAIM_EXCLUSIVE,
    CLAIM_WITHIN_LIMITS,
    CLAIM_FOLLOWS,
];

/// The objects of a map for `standstill compare`.
pub(crate) mod machine {
    use super::{Shape, shape};

    pub(crate) const MAP: Shape = shape(
        "a map",
        &[
            "$schema",
            "standstill_compare",
            "recording",
            "offset",
            "window",
            "time_tolerance",
            "signals",
            "note",
        ],
    );
    pub(crate) const RECORDING: Shape = shape("`recording`", &["delimiter", "decimal", "time", "note"]);
    pub(crate) const TIME: Shape = shape("`time`", &["column", "unit", "every", "note"]);
    pub(crate) const WINDOW: Shape = shape("`window`", &["from", "to", "note"]);
    pub(crate) const EDGE: Shape = shape("an offset by an edge", &["edge", "to", "number", "note"]);
    pub(crate) const FIT: Shape = shape("a fitted offset", &["fit", "from", "to", "note"]);
    pub(crate) const CURVE: Shape = shape(
        "the map of a number",
        &[
            "column",
            "factor",
            "sign",
            "zero",
            "tolerance",
            "time_tolerance",
            "note",
        ],
    );
    pub(crate) const BOOL: Shape = shape(
        "the map of a truth value",
        &["column", "invert", "time_tolerance", "note"],
    );
    pub(crate) const WHOLE: Shape = shape("the map of a whole number", &["column", "time_tolerance", "note"]);
    pub(crate) const WORD: Shape = shape(
        "the map of a word",
        &["column", "values", "time_tolerance", "note"],
    );
}

/// The objects of a sweep.
pub(crate) mod sweep {
    use super::{Shape, shape};

    pub(crate) const SWEEP: Shape = shape(
        "a sweep",
        &[
            "$schema",
            "standstill_sweep",
            "title",
            "script",
            "grid",
            "sample",
            "measure",
            "note",
        ],
    );
    pub(crate) const SAMPLE: Shape = shape("`sample`", &["seed", "count", "of", "note"]);
    pub(crate) const STEPS: Shape = shape("a range of a grid", &["from", "to", "count", "scale", "note"]);
    pub(crate) const RANGE: Shape = shape("a range of a sample", &["from", "to", "scale", "note"]);
    pub(crate) const MEASURE: Shape = shape(
        "a measure",
        &["last", "max", "min", "abs_max", "first", "count", "note"],
    );
}

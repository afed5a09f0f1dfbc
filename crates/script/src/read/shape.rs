//! The keys of each object of a script, and their permitted values. The reader and the JSON Schema both
//! use this; the keys of axes and drives are described with their structures ([`standstill_axis::keys`],
//! [`standstill_drives::keys`]).

use crate::schema::of::*;
use serde_json::Value;

/// A key, and the schema of its value.
pub(crate) type Field = (&'static str, fn() -> Value);

/// The keys of one kind of object.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shape {
    /// The object in words, as in "unknown key `x` in ..".
    pub(crate) what: &'static str,
    /// Keys that exist.
    pub(crate) keys: &'static [Field],
}

impl Shape {
    /// The names of the keys.
    pub(crate) fn names(&self) -> impl Iterator<Item = &'static str> + Clone + use<> {
        self.keys.iter().map(|(name, _)| *name)
    }

    /// Whether there is such a key.
    pub(crate) fn has(&self, name: &str) -> bool {
        self.names().any(|known| known == name)
    }
}

const fn shape(what: &'static str, keys: &'static [Field]) -> Shape {
    Shape { what, keys }
}

pub(crate) const SCRIPT: Shape = shape(
    "a script",
    &[
        ("$schema", text),
        ("standstill", version),
        ("title", text),
        ("covers", texts),
        ("cycle", cycle),
        ("scans", rows),
        ("include", text_or_texts),
        ("override", text_or_texts),
        ("parameters", parameters),
        ("axes", axes),
        ("inputs", inputs),
        ("tasks", tasks),
        ("blocks", blocks),
        ("tables", tables),
        ("cams", cams),
        ("programs", programs),
        ("steps", steps),
        ("expect", claims),
        ("stop_when", conditions),
        ("after", scans),
        ("golden", boolean),
        ("clamps", clamps),
    ],
);
/// What scripts include.
pub(crate) const MACHINE: Shape = shape(
    "a machine file",
    &[
        ("$schema", text),
        ("standstill", version),
        ("title", text),
        ("include", text_or_texts),
        ("override", text_or_texts),
        ("parameters", parameters),
        ("axes", axes),
        ("inputs", inputs),
        ("tasks", tasks),
        ("blocks", blocks),
        ("note", text),
    ],
);
/// A table of a script.
pub(crate) const TABLE: Shape = shape(
    "a table",
    &[
        ("type", text),
        ("rows", table_rows),
        ("csv", text),
        ("note", text),
    ],
);
/// The use of a table at a pin.
pub(crate) const TABLE_USE: Shape = shape("a table's use", &[("table", text), ("note", text)]);
/// The store of cams.
pub(crate) const CAMS: Shape = shape(
    "`cams`",
    &[("slots", cam_slots), ("stretches", cam_pieces), ("note", text)],
);
pub(crate) const PARAM: Shape = shape("a parameter's use", &[("param", text), ("note", text)]);

pub(crate) const DRIVE: Shape = shape(
    "`drive`",
    &[
        ("ideal", ideal_drive),
        ("cia402", cia402_drive),
        ("plant", plant),
        ("note", text),
    ],
);

pub(crate) const BLOCK: Shape = shape(
    "a block",
    &[
        ("name", identifier),
        ("type", block_type),
        ("task", text),
        ("pins", any_object),
        ("vacuous", vacuous),
        ("note", text),
    ],
);
pub(crate) const WIRE: Shape = shape(
    "a wire",
    &[
        ("from", text),
        ("not", text),
        ("any", some_texts),
        ("all", some_texts),
        ("note", text),
    ],
);
/// The keys for the kind of a wire; it has exactly one of them.
pub(crate) const WIRE_KINDS: [&str; 4] = ["from", "not", "any", "all"];
pub(crate) const TASK: Shape = shape(
    "a task",
    &[
        ("interval", interval),
        ("priority", priority),
        ("single", wire),
        ("watchdog", watchdog),
    ],
);

pub(crate) const PROGRAM: Shape = shape(
    "a program",
    &[
        ("wasm", text),
        ("st", files),
        ("program", text),
        ("task", text),
        ("axes", program_axes),
        ("trace", texts),
        ("fuel", fuel),
        ("memory", memory),
        ("symbols", symbols),
        ("may_fault", boolean),
        ("vacuous", vacuous),
        ("note", text),
    ],
);
/// The keys of a program that is a module already.
pub(crate) const PROGRAM_MODULE: Shape = shape(
    "a program",
    &[
        ("wasm", text),
        ("task", text),
        ("fuel", fuel),
        ("memory", memory),
        ("symbols", symbols),
        ("may_fault", boolean),
        ("vacuous", vacuous),
        ("note", text),
    ],
);
/// The keys of a program in Structured Text.
pub(crate) const PROGRAM_TEXT: Shape = shape(
    "a program",
    &[
        ("st", files),
        ("program", text),
        ("task", text),
        ("axes", program_axes),
        ("trace", texts),
        ("fuel", fuel),
        ("memory", memory),
        ("may_fault", boolean),
        ("vacuous", vacuous),
        ("note", text),
    ],
);
pub(crate) const SYMBOL: Shape = shape(
    "a symbol",
    &[
        ("type", symbol_type),
        ("address", count),
        ("export", text),
        ("note", text),
    ],
);

pub(crate) const INPUT: Shape = shape(
    "an input variable",
    &[("value", input_value), ("vacuous", vacuous), ("note", text)],
);

pub(crate) const STEP: Shape = shape(
    "a step",
    &[
        ("at", scans),
        ("when", conditions),
        ("after", scans),
        ("every", boolean),
        ("set", set),
        ("fault", fault),
        ("clear", clear),
        ("drive", drive_step),
        ("vacuous", vacuous),
        ("note", text),
    ],
);
pub(crate) const FAULT: Shape = shape(
    "`fault`",
    &[
        ("axis", text),
        ("kind", fault_kind),
        ("code", word_16),
        ("note", text),
    ],
);
pub(crate) const CLEAR: Shape = shape("`clear`", &[("axis", text), ("note", text)]);
pub(crate) const DRIVE_STEP: Shape = shape(
    "a `drive` step",
    &[
        ("axis", text),
        ("displace", finite),
        ("remote", boolean),
        ("warning", boolean),
        ("input", drive_input),
        ("probe", drive_probe),
        ("report", drive_report),
        ("note", text),
    ],
);
pub(crate) const DRIVE_REPORT: Shape = shape(
    "`report` of a drive",
    &[("position", number), ("torque", number), ("note", text)],
);
pub(crate) const DRIVE_INPUT: Shape = shape(
    "`input` of a drive",
    &[("number", input_number), ("value", boolean), ("note", text)],
);
pub(crate) const DRIVE_PROBE: Shape = shape(
    "`probe` of a drive",
    &[
        ("number", probe_number),
        ("at", part),
        ("value", boolean),
        ("note", text),
    ],
);

pub(crate) const COMPARISON: Shape = shape(
    "a comparison",
    &[
        ("near", near),
        ("within", within),
        ("le", bound),
        ("ge", bound),
        ("lt", bound),
        ("gt", bound),
        ("ne", value),
        ("abs_le", bound),
        ("same_as", text),
        ("note", text),
    ],
);

pub(crate) const CLAIM_AT: Shape = shape(
    "a claim with `at`",
    &[
        ("at", scans),
        ("that", conditions),
        ("vacuous", vacuous),
        ("note", text),
    ],
);
pub(crate) const CLAIM_BY: Shape = shape(
    "a claim with `by`",
    &[
        ("by", scans),
        ("from", range_end),
        ("that", conditions),
        ("vacuous", vacuous),
        ("note", text),
    ],
);
pub(crate) const CLAIM_ALWAYS: Shape = shape(
    "a claim with `always`",
    &[
        ("always", conditions),
        ("from", range_end),
        ("to", range_end),
        ("while", conditions),
        ("vacuous", vacuous),
        ("note", text),
    ],
);
pub(crate) const CLAIM_NEVER: Shape = shape(
    "a claim with `never`",
    &[
        ("never", conditions),
        ("for", rows),
        ("from", range_end),
        ("to", range_end),
        ("while", conditions),
        ("vacuous", vacuous),
        ("note", text),
    ],
);
pub(crate) const CLAIM_ONCE: Shape = shape(
    "a claim with `once`",
    &[
        ("once", conditions),
        ("from", range_end),
        ("to", range_end),
        ("vacuous", vacuous),
        ("note", text),
    ],
);
pub(crate) const CLAIM_EXCLUSIVE: Shape = shape(
    "a claim with `exclusive`",
    &[
        ("exclusive", two_texts),
        ("from", range_end),
        ("to", range_end),
        ("vacuous", vacuous),
        ("note", text),
    ],
);
pub(crate) const CLAIM_WITHIN_LIMITS: Shape = shape(
    "a claim with `within_limits`",
    &[
        ("within_limits", text),
        ("factor", positive),
        ("from", range_end),
        ("to", range_end),
        ("vacuous", vacuous),
        ("note", text),
    ],
);
pub(crate) const CLAIM_FOLLOWS: Shape = shape(
    "a claim with `follows`",
    &[
        ("follows", follows),
        ("from", range_end),
        ("to", range_end),
        ("vacuous", vacuous),
        ("note", text),
    ],
);
pub(crate) const FOLLOWS: Shape = shape(
    "`follows`",
    &[
        ("slave", text),
        ("master", text),
        ("num", int_16),
        ("den", ratio_den),
        ("while", conditions),
        ("anchor", anchor),
        ("note", text),
    ],
);
pub(crate) const ANCHOR: Shape = shape(
    "`anchor`",
    &[("master", number), ("slave", number), ("note", text)],
);

pub(crate) const CLAIM_WHEN: Shape = shape(
    "a claim with `when`",
    &[
        ("when", conditions),
        ("within", scans),
        ("that", conditions),
        ("from", range_end),
        ("to", range_end),
        ("while", conditions),
        ("vacuous", vacuous),
        ("note", text),
    ],
);
pub(crate) const CLAIM_AFTER: Shape = shape(
    "a claim with `after`",
    &[
        ("after", conditions),
        ("by", scans),
        ("that", conditions),
        ("from", range_end),
        ("to", range_end),
        ("while", conditions),
        ("vacuous", vacuous),
        ("note", text),
    ],
);
pub(crate) const CLAIM_DURATION: Shape = shape(
    "a claim with `duration`",
    &[
        ("duration", two_conditions),
        ("le", scans),
        ("ge", scans),
        ("each", boolean),
        ("from", range_end),
        ("to", range_end),
        ("while", conditions),
        ("vacuous", vacuous),
        ("note", text),
    ],
);
pub(crate) const CLAIM_COUNT: Shape = shape(
    "a claim with `count`",
    &[
        ("count", conditions),
        ("eq", scans),
        ("le", scans),
        ("ge", scans),
        ("from", range_end),
        ("to", range_end),
        ("while", conditions),
        ("vacuous", vacuous),
        ("note", text),
    ],
);
/// The begin or the end of a window.
pub(crate) const WINDOW_EDGE: Shape = shape(
    "the begin or end of a window",
    &[("when", conditions), ("note", text)],
);
pub(crate) const NEAR_TO: Shape = shape("`near`", &[("of", text), ("plus", bound), ("note", text)]);

/// The kinds of claims; the first key of each names it. A claim with `after` also has a `by`.
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
    use crate::schema::of::{boolean, plain, text};
    use crate::schema_map::*;

    pub(crate) const MAP: Shape = shape(
        "a map",
        &[
            ("$schema", text),
            ("standstill_compare", map_version),
            ("recording", recording),
            ("offset", offset),
            ("window", map_window),
            ("time_tolerance", map_time),
            ("signals", signals),
            ("note", text),
        ],
    );
    pub(crate) const RECORDING: Shape = shape(
        "`recording`",
        &[
            ("delimiter", delimiter),
            ("decimal", decimal),
            ("time", recording_time),
            ("note", text),
        ],
    );
    pub(crate) const TIME: Shape = shape(
        "`time`",
        &[
            ("column", column),
            ("unit", time_unit),
            ("every", map_time),
            ("note", text),
        ],
    );
    pub(crate) const WINDOW: Shape = shape(
        "`window`",
        &[("from", map_time), ("to", map_time), ("note", text)],
    );
    pub(crate) const EDGE: Shape = shape(
        "an offset by an edge",
        &[
            ("edge", text),
            ("to", edge_value),
            ("number", edge_number),
            ("note", text),
        ],
    );
    pub(crate) const FIT: Shape = shape(
        "a fitted offset",
        &[
            ("fit", text),
            ("from", map_time),
            ("to", map_time),
            ("note", text),
        ],
    );
    pub(crate) const CURVE: Shape = shape(
        "the map of a number",
        &[
            ("column", column),
            ("factor", plain),
            ("sign", sign),
            ("zero", plain),
            ("tolerance", not_negative),
            ("time_tolerance", map_time),
            ("note", text),
        ],
    );
    pub(crate) const BOOL: Shape = shape(
        "the map of a truth value",
        &[
            ("column", column),
            ("invert", boolean),
            ("time_tolerance", map_time),
            ("note", text),
        ],
    );
    pub(crate) const WHOLE: Shape = shape(
        "the map of a whole number",
        &[("column", column), ("time_tolerance", map_time), ("note", text)],
    );
    pub(crate) const WORD: Shape = shape(
        "the map of a word",
        &[
            ("column", column),
            ("values", map_values),
            ("time_tolerance", map_time),
            ("note", text),
        ],
    );
}

/// The objects of a sweep.
pub(crate) mod sweep {
    use super::{Shape, shape};
    use crate::schema::of::{boolean, plain, text};
    use crate::schema_sweep::*;

    pub(crate) const SWEEP: Shape = shape(
        "a sweep",
        &[
            ("$schema", text),
            ("standstill_sweep", sweep_version),
            ("title", text),
            ("script", text),
            ("grid", grid),
            ("sample", sample),
            ("measure", measures),
            ("digest", boolean),
            ("note", text),
        ],
    );
    pub(crate) const SAMPLE: Shape = shape(
        "`sample`",
        &[("seed", seed), ("count", cases), ("of", sampled), ("note", text)],
    );
    pub(crate) const STEPS: Shape = shape(
        "a range of a grid",
        &[
            ("from", plain),
            ("to", plain),
            ("count", grid_count),
            ("scale", scale),
            ("note", text),
        ],
    );
    pub(crate) const RANGE: Shape = shape(
        "a range of a sample",
        &[("from", plain), ("to", plain), ("scale", scale), ("note", text)],
    );
    pub(crate) const MEASURE: Shape = shape(
        "a measure",
        &[
            ("last", text),
            ("max", text),
            ("min", text),
            ("abs_max", text),
            ("first", text),
            ("count", text),
            ("note", text),
        ],
    );
}

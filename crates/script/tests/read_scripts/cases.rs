//! Bad scripts: a good one with one piece replaced.

/// A good script.
pub const GOOD: &str = r#"{
  "standstill": 1,
  "cycle": "T#2ms",
  "scans": 100,
  "axes": {
    "X": {"limits": {"velocity": 50, "acceleration": 200}, "state": "Standstill"}
  },
  "inputs": {"GO": false, "speed": 10},
  "blocks": [
    {"name": "m", "type": "MC_MoveAbsolute", "pins": {"Axis": "X", "Execute": {"from": "GO"}}},
    {"name": "n", "type": "MC_MoveAbsolute", "pins": {"Axis": "X", "Execute": false}}
  ],
  "steps": [
    {"at": 1, "set": {"GO": true}}
  ],
  "expect": [
    {"at": 2, "that": {"m.Busy": true}}
  ]
}
"#;

/// Who refuses it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum By {
    /// It is no JSON, so no schema ever sees it.
    Syntax,
    /// The schema too.
    Schema,
    /// Only the reader: a schema cannot say it.
    Reader,
}

/// One bad script.
pub struct Case {
    /// The code of its only error.
    pub code: &'static str,
    /// What it tries.
    pub title: &'static str,
    /// Who refuses it.
    pub by: By,
    /// What is replaced in [`GOOD`], once.
    pub old: &'static str,
    /// By what.
    pub new: &'static str,
}

impl Case {
    /// Its text.
    pub fn text(&self) -> String {
        assert!(GOOD.contains(self.old), "{}", self.title);
        GOOD.replacen(self.old, self.new, 1)
    }
}

const fn case(code: &'static str, by: By, title: &'static str, old: &'static str, new: &'static str) -> Case {
    Case {
        code,
        title,
        by,
        old,
        new,
    }
}

const PINS: &str = r#""Execute": false"#;
const CAMS: &str = r#""type": "MC_MoveAbsolute", "pins": {"Axis": "X", "Execute": false}"#;
const LIMITS: &str = r#""velocity": 50, "acceleration": 200}"#;
const STEP: &str = r#"{"at": 1, "set": {"GO": true}}"#;
const CLAIM: &str = r#"{"at": 2, "that": {"m.Busy": true}}"#;

/// All of them.
pub fn cases() -> Vec<Case> {
    use By::{Reader, Schema, Syntax};
    vec![
        // Text that is no JSON.
        case(
            "syntax",
            Syntax,
            "a missing comma",
            "\"scans\": 100,",
            "\"scans\": 100",
        ),
        case(
            "syntax",
            Syntax,
            "a missing comma in a list",
            "\"GO\"}}},\n",
            "\"GO\"}}}\n",
        ),
        case(
            "syntax",
            Syntax,
            "a missing colon",
            "\"scans\": 100",
            "\"scans\" 100",
        ),
        case(
            "syntax",
            Syntax,
            "a comma too many",
            "\"speed\": 10}",
            "\"speed\": 10,}",
        ),
        case(
            "syntax",
            Syntax,
            "a comment",
            "\"scans\": 100,",
            "\"scans\": 100, // rows",
        ),
        case("syntax", Syntax, "single quotes", "\"GO\": false", "'GO': false"),
        case(
            "syntax",
            Syntax,
            "a key without quotes",
            "\"GO\": false",
            "GO: false",
        ),
        case("syntax", Syntax, "TRUE as in IEC text", "false}}", "FALSE}}"),
        case(
            "syntax",
            Syntax,
            "NaN without quotes",
            "\"speed\": 10",
            "\"speed\": NaN",
        ),
        case(
            "syntax",
            Syntax,
            "a hexadecimal number",
            "\"speed\": 10",
            "\"speed\": 0x10",
        ),
        case(
            "syntax",
            Syntax,
            "a string that does not end",
            "\"T#2ms\"",
            "\"T#2ms",
        ),
        case("syntax", Syntax, "an unknown escape", "\"T#2ms\"", "\"T\\#2ms\""),
        case("syntax", Syntax, "text after the end", "  ]\n}\n", "  ]\n}\n}\n"),
        case("syntax", Syntax, "a brace that is missing", "  ]\n}\n", "  ]\n"),
        case(
            "duplicate_key",
            Syntax,
            "a key twice",
            "\"scans\": 100,",
            "\"scans\": 100, \"cycle\": \"T#1ms\",",
        ),
        case(
            "number_too_large",
            Syntax,
            "a huge number",
            "\"speed\": 10",
            "\"speed\": 1e400",
        ),
        // Keys.
        case(
            "unknown_key",
            Schema,
            "an unknown key of the script",
            "\"inputs\"",
            "\"input\": {}, \"inputs\"",
        ),
        case(
            "unknown_key",
            Schema,
            "an unknown limit",
            LIMITS,
            "\"velocity\": 50, \"acceleration\": 200, \"jrek\": 1}",
        ),
        case(
            "bad_value",
            Schema,
            "a turn of no length",
            "\"state\"",
            "\"modulo\": 0, \"state\"",
        ),
        case(
            "bad_value",
            Reader,
            "half a turn in a scan",
            "\"state\"",
            "\"modulo\": 0.1, \"state\"",
        ),
        case(
            "bad_value",
            Reader,
            "a start outside the first turn",
            "\"state\"",
            "\"modulo\": 360, \"position\": 360, \"state\"",
        ),
        case(
            "bad_value",
            Reader,
            "software limits where positions come round",
            "\"state\"",
            "\"modulo\": 360, \"software_limits\": {\"min\": 5}, \"state\"",
        ),
        case(
            "bad_value",
            Reader,
            "a turn that is no fraction of increments",
            "\"state\"",
            "\"modulo\": 0.7, \"scaling\": {\"increments\": 4294967291, \"units\": 1}, \"state\"",
        ),
        case(
            "bad_value",
            Reader,
            "a following error of nothing",
            "\"state\"",
            "\"max_following_error\": 0, \"state\"",
        ),
        case(
            "missing_key",
            Schema,
            "a time without a window",
            "\"state\"",
            "\"in_position\": {\"time\": 2}, \"state\"",
        ),
        case(
            "bad_value",
            Reader,
            "a window below nothing",
            "\"state\"",
            "\"in_position\": {\"window\": -1, \"time\": 2}, \"state\"",
        ),
        case(
            "missing_key",
            Reader,
            "a CiA 402 drive without increments",
            "\"state\"",
            "\"drive\": {\"cia402\": {}}, \"state\"",
        ),
        case(
            "bad_value",
            Reader,
            "two drives",
            "\"state\"",
            "\"drive\": {\"ideal\": {}, \"cia402\": {}}, \"state\"",
        ),
        case(
            "bad_value",
            Reader,
            "a home switch the wrong way round",
            "\"state\"",
            "\"scaling\": {\"increments\": 9, \"units\": 1}, \"drive\": {\"cia402\": {\"home_switch\": {\"from\": 2, \"to\": 1}}}, \"state\"",
        ),
        case(
            "bad_value",
            Schema,
            "a drive that stays where it should not",
            "\"state\"",
            "\"scaling\": {\"increments\": 9, \"units\": 1}, \"drive\": {\"cia402\": {\"on_fault\": \"stay\"}}, \"state\"",
        ),
        case(
            "missing_key",
            Schema,
            "a plant without inertia",
            "\"state\"",
            "\"drive\": {\"plant\": {}}, \"state\"",
        ),
        case(
            "bad_value",
            Reader,
            "a plant with a load of nothing",
            "\"state\"",
            "\"drive\": {\"plant\": {\"inertia\": 1, \"load\": {\"inertia\": 0, \"stiffness\": 1}}}, \"state\"",
        ),
        case(
            "bad_value",
            Reader,
            "gains below zero",
            "\"state\"",
            "\"drive\": {\"plant\": {\"inertia\": 1, \"gains\": {\"position\": -1}}}, \"state\"",
        ),
        case(
            "unsupported",
            Schema,
            "a later version of the format",
            "\"standstill\": 1",
            "\"standstill\": 2",
        ),
        case("missing_key", Schema, "no cycle", "\"cycle\": \"T#2ms\",", ""),
        case(
            "missing_key",
            Schema,
            "an axis without limits",
            "\"limits\": {\"velocity\": 50, \"acceleration\": 200}, ",
            "",
        ),
        case(
            "missing_key",
            Schema,
            "limits without velocity",
            "\"velocity\": 50, ",
            "",
        ),
        case(
            "missing_key",
            Schema,
            "velocity null",
            "\"velocity\": 50",
            "\"velocity\": null",
        ),
        // Values of the axis.
        case(
            "bad_value",
            Schema,
            "a limit that is NaN",
            "\"velocity\": 50",
            "\"velocity\": \"NaN\"",
        ),
        case(
            "bad_value",
            Schema,
            "a limit that is infinite",
            "\"acceleration\": 200",
            "\"acceleration\": \"Infinity\"",
        ),
        case(
            "bad_value",
            Schema,
            "a limit of zero",
            "\"velocity\": 50",
            "\"velocity\": 0",
        ),
        case(
            "bad_value",
            Schema,
            "a negative limit",
            "\"acceleration\": 200",
            "\"acceleration\": -200",
        ),
        case(
            "bad_value",
            Reader,
            "a default above its limit",
            "\"state\"",
            "\"defaults\": {\"acceleration\": 300}, \"state\"",
        ),
        case(
            "bad_value",
            Reader,
            "software limits the wrong way round",
            "\"state\"",
            "\"software_limits\": {\"min\": 5, \"max\": -5}, \"state\"",
        ),
        case(
            "bad_value",
            Schema,
            "a scaling of zero",
            "\"state\"",
            "\"scaling\": {\"increments\": 0, \"units\": 1}, \"state\"",
        ),
        case(
            "bad_value",
            Schema,
            "a queue that is too long",
            "\"state\"",
            "\"queue\": 17, \"state\"",
        ),
        case(
            "bad_value",
            Schema,
            "a feedback delay that is too long",
            "\"state\"",
            "\"drive\": {\"ideal\": {\"delay\": 65}}, \"state\"",
        ),
        case(
            "bad_value",
            Schema,
            "an unknown word",
            "\"state\"",
            "\"above_limit\": \"clmap\", \"state\"",
        ),
        case(
            "bad_value",
            Schema,
            "an unknown profile",
            "\"state\"",
            "\"profile\": \"fastets\", \"state\"",
        ),
        case(
            "bad_value",
            Reader,
            "a profile that cannot keep a limit",
            "200}",
            "200, \"jerk\": 2000}, \"profile\": \"trapezoid\"",
        ),
        case(
            "bad_value",
            Schema,
            "a state no axis starts in",
            "\"Standstill\"",
            "\"Homing\"",
        ),
        case(
            "unknown_state",
            Schema,
            "an unknown state",
            "\"Standstill\"",
            "\"Standstil\"",
        ),
        // Wrong types.
        case("wrong_type", Schema, "a script that is a list", GOOD, "[1, 2]\n"),
        case(
            "wrong_type",
            Schema,
            "a number in quotes",
            "\"velocity\": 50",
            "\"velocity\": \"50\"",
        ),
        case(
            "wrong_type",
            Schema,
            "a string at a BOOL pin",
            PINS,
            "\"Execute\": \"GO\"",
        ),
        case(
            "wrong_type",
            Schema,
            "a bool at an LREAL pin",
            PINS,
            "\"Velocity\": true",
        ),
        case(
            "wrong_type",
            Schema,
            "a number for an axis",
            "\"Axis\": \"X\", \"Execute\": false",
            "\"Axis\": 0",
        ),
        case(
            "wrong_type",
            Schema,
            "an input that is a list",
            "\"speed\": 10",
            "\"speed\": [10]",
        ),
        case("wrong_type", Schema, "a cycle without unit", "\"T#2ms\"", "2"),
        case(
            "wrong_type",
            Reader,
            "a BOOL pin wired from a number",
            "{\"from\": \"GO\"}",
            "{\"from\": \"speed\"}",
        ),
        case(
            "wrong_type",
            Reader,
            "a number pin wired from a BOOL",
            PINS,
            "\"Velocity\": {\"from\": \"m.Done\"}",
        ),
        case(
            "wrong_type",
            Reader,
            "a negated number",
            PINS,
            "\"Velocity\": {\"not\": \"GO\"}",
        ),
        case(
            "wrong_type",
            Reader,
            "a state compared as a number",
            CLAIM,
            "{\"always\": {\"X.State\": {\"le\": 3}}}",
        ),
        case(
            "wrong_type",
            Reader,
            "exclusive numbers",
            CLAIM,
            "{\"exclusive\": [\"m.Busy\", \"m.Velocity\"]}",
        ),
        case(
            "wrong_type",
            Schema,
            "a parameter at a BOOL pin",
            PINS,
            "\"Execute\": {\"param\": \"v\"}",
        ),
        // Times and scans.
        case(
            "bad_time",
            Reader,
            "no multiple of the cycle",
            STEP,
            "{\"at\": \"T#3ms\", \"set\": {\"GO\": true}}",
        ),
        case(
            "bad_time",
            Schema,
            "no TIME literal",
            STEP,
            "{\"at\": \"3ms\", \"set\": {\"GO\": true}}",
        ),
        case(
            "bad_time",
            Reader,
            "units out of order",
            "\"T#2ms\"",
            "\"T#2ms1s\"",
        ),
        case("bad_time", Reader, "a cycle of nothing", "\"T#2ms\"", "\"T#0ms\""),
        case(
            "bad_value",
            Schema,
            "half a scan",
            STEP,
            "{\"at\": 1.5, \"set\": {\"GO\": true}}",
        ),
        case(
            "outside_run",
            Reader,
            "a claim after the end",
            CLAIM,
            "{\"at\": 100, \"that\": {\"m.Busy\": true}}",
        ),
        case(
            "bad_value",
            Reader,
            "a range the wrong way round",
            CLAIM,
            "{\"never\": {\"m.Busy\": true}, \"from\": 9, \"to\": 5}",
        ),
        case(
            "too_large",
            Schema,
            "10^9 scans",
            "\"scans\": 100",
            "\"scans\": 1000000000",
        ),
        case(
            "too_large",
            Reader,
            "too many cells",
            "\"scans\": 100",
            "\"scans\": 10000000",
        ),
        case(
            "bad_value",
            Schema,
            "no scan at all",
            "\"scans\": 100",
            "\"scans\": 0",
        ),
        // Names.
        case("bad_name", Schema, "no identifier", "\"speed\"", "\"max speed\""),
        case("bad_name", Schema, "a keyword", "\"speed\"", "\"STEP\""),
        case(
            "duplicate_name",
            Reader,
            "two of one name but for case",
            "\"name\": \"n\"",
            "\"name\": \"x\"",
        ),
        case(
            "unknown_block",
            Schema,
            "an unknown block",
            "\"n\", \"type\": \"MC_MoveAbsolute\"",
            "\"n\", \"type\": \"MC_MoveAbsolut\"",
        ),
        case(
            "unknown_block",
            Schema,
            "a block of which nothing is near",
            "\"n\", \"type\": \"MC_MoveAbsolute\"",
            "\"n\", \"type\": \"Lamp\"",
        ),
        case(
            "unknown_pin",
            Schema,
            "an unknown pin",
            PINS,
            "\"Exceute\": false",
        ),
        case(
            "unknown_axis",
            Reader,
            "an unknown axis",
            "\"Axis\": \"X\", \"Execute\": false",
            "\"Axis\": \"Y\"",
        ),
        case(
            "unknown_element",
            Schema,
            "an unknown element",
            PINS,
            "\"BufferMode\": \"mcBufered\"",
        ),
        case(
            "unknown_signal",
            Reader,
            "a wire from nowhere",
            "{\"from\": \"GO\"}",
            "{\"from\": \"GOO\"}",
        ),
        case(
            "unknown_signal",
            Reader,
            "a wire from an instance",
            "{\"from\": \"GO\"}",
            "{\"from\": \"n\"}",
        ),
        case(
            "unknown_signal",
            Reader,
            "a wire from an axis",
            "{\"from\": \"GO\"}",
            "{\"from\": \"X.Position\"}",
        ),
        case(
            "unknown_signal",
            Reader,
            "a claim on an unknown signal",
            CLAIM,
            "{\"never\": {\"X.Postion\": 3}}",
        ),
        case(
            "unknown_signal",
            Reader,
            "a difference of order five",
            CLAIM,
            "{\"never\": {\"X.Position.d5\": 3}}",
        ),
        case(
            "unknown_pin",
            Reader,
            "a claim on an unknown pin",
            CLAIM,
            "{\"never\": {\"m.Don\": true}}",
        ),
        case(
            "unknown_state",
            Reader,
            "a claim on an unknown state",
            CLAIM,
            "{\"never\": {\"X.State\": \"Moving\"}}",
        ),
        case(
            "unknown_task",
            Reader,
            "an unknown task",
            "\"Execute\": false}",
            "\"Execute\": false}, \"task\": \"slow\"",
        ),
        case(
            "unknown_parameter",
            Reader,
            "an unknown parameter",
            "\"speed\": 10",
            "\"speed\": {\"param\": \"v\"}",
        ),
        // Wires and writers.
        case(
            "missing_pin",
            Schema,
            "no axis",
            "\"Axis\": \"X\", \"Execute\": false",
            "\"Execute\": false",
        ),
        case(
            "not_writable",
            Schema,
            "a constant at an output",
            PINS,
            "\"Done\": true",
        ),
        case(
            "not_writable",
            Reader,
            "a step that writes an output",
            STEP,
            "{\"at\": 1, \"set\": {\"m.Done\": true}}",
        ),
        case(
            "two_writers",
            Reader,
            "a wire and a step",
            STEP,
            "{\"at\": 1, \"set\": {\"m.Execute\": true}}",
        ),
        case(
            "two_writers",
            Schema,
            "a pin twice but for case",
            PINS,
            "\"Execute\": false, \"execute\": {\"from\": \"GO\"}",
        ),
        case(
            "two_writers",
            Schema,
            "a wire of two kinds",
            PINS,
            "\"Execute\": {\"from\": \"GO\", \"not\": \"GO\"}",
        ),
        case(
            "wire_cycle",
            Reader,
            "an input wired from itself",
            PINS,
            "\"Execute\": {\"from\": \"n.Execute\"}",
        ),
        case(
            "wire_cycle",
            Reader,
            "two inputs wired in a circle",
            "{\"from\": \"GO\"}}},\n    {\"name\": \"n\", \"type\": \"MC_MoveAbsolute\", \"pins\": {\"Axis\": \"X\", \"Execute\": false",
            "{\"from\": \"n.Execute\"}}},\n    {\"name\": \"n\", \"type\": \"MC_MoveAbsolute\", \"pins\": {\"Axis\": \"X\", \"Execute\": {\"any\": [\"m.Execute\", \"n.Execute\"]}",
        ),
        // Steps, tasks, claims.
        case(
            "missing_key",
            Schema,
            "a step that never happens",
            STEP,
            "{\"set\": {\"GO\": true}}",
        ),
        case(
            "unknown_key",
            Schema,
            "a step with two whens",
            STEP,
            "{\"at\": 1, \"when\": {\"GO\": true}, \"set\": {\"GO\": true}}",
        ),
        case(
            "unknown_key",
            Schema,
            "every with at",
            STEP,
            "{\"at\": 1, \"every\": true, \"set\": {\"GO\": true}}",
        ),
        case(
            "missing_key",
            Schema,
            "a step that does nothing",
            STEP,
            "{\"at\": 1}",
        ),
        case(
            "missing_key",
            Reader,
            "a drive step that does nothing",
            STEP,
            "{\"at\": 1, \"drive\": {\"axis\": \"X\"}}",
        ),
        case(
            "bad_value",
            Reader,
            "a drive step of another drive",
            STEP,
            "{\"at\": 1, \"drive\": {\"axis\": \"X\", \"remote\": false}}",
        ),
        case(
            "bad_value",
            Schema,
            "an input beyond the last",
            STEP,
            "{\"at\": 1, \"drive\": {\"axis\": \"X\", \"input\": {\"number\": 32, \"value\": true}}}",
        ),
        case(
            "bad_value",
            Reader,
            "a probe after the end of its scan",
            STEP,
            "{\"at\": 1, \"drive\": {\"axis\": \"X\", \"probe\": {\"number\": 1, \"at\": 1.5, \"value\": true}}}",
        ),
        case(
            "unknown_key",
            Schema,
            "a drive step no drive knows",
            STEP,
            "{\"at\": 1, \"drive\": {\"axis\": \"X\", \"displace\": 1, \"torque\": 3}}",
        ),
        case(
            "bad_value",
            Schema,
            "an unknown fault",
            STEP,
            "{\"at\": 1, \"fault\": {\"axis\": \"X\", \"kind\": \"driver\"}}",
        ),
        case(
            "missing_key",
            Schema,
            "a task that never runs",
            "\"inputs\"",
            "\"tasks\": {\"main\": {\"priority\": 1}}, \"inputs\"",
        ),
        case(
            "missing_key",
            Schema,
            "a claim that claims nothing",
            CLAIM,
            "{\"alwyas\": {\"GO\": true}}",
        ),
        case(
            "missing_key",
            Schema,
            "a claim without conditions",
            CLAIM,
            "{\"at\": 5}",
        ),
        case(
            "unknown_key",
            Schema,
            "while at one scan",
            CLAIM,
            "{\"at\": 5, \"that\": {\"GO\": true}, \"while\": {\"GO\": true}}",
        ),
        case(
            "bad_value",
            Schema,
            "no condition at all",
            CLAIM,
            "{\"always\": {}}",
        ),
        case(
            "missing_key",
            Schema,
            "near without within",
            CLAIM,
            "{\"always\": {\"X.Position\": {\"near\": 3}}}",
        ),
        case(
            "missing_key",
            Schema,
            "after without stop_when",
            "\"inputs\"",
            "\"after\": 3, \"inputs\"",
        ),
        case(
            "wrong_type",
            Schema,
            "a table that is no list",
            CAMS,
            r#""type": "MC_DigitalCamSwitch", "pins": {"Axis": "X", "Outputs": "X", "Switches": 3}"#,
        ),
        case(
            "unknown_key",
            Schema,
            "a record with an unknown field",
            CAMS,
            r#""type": "MC_DigitalCamSwitch", "pins": {"Axis": "X", "Outputs": "X", "Switches": [{"TrackNumbr": 1}]}"#,
        ),
        case(
            "wrong_type",
            Schema,
            "a record with a text for a number",
            CAMS,
            r#""type": "MC_DigitalCamSwitch", "pins": {"Axis": "X", "Outputs": "X", "Switches": [{"TrackNumber": 1, "FirstOnPosition": "far"}]}"#,
        ),
        case(
            "bad_value",
            Schema,
            "a table with too many records",
            CAMS,
            r#""type": "MC_DigitalCamSwitch", "pins": {"Axis": "X", "Outputs": "X", "Switches": [{}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}, {}]}"#,
        ),
        case(
            "wrong_type",
            Reader,
            "a table wired from another type",
            CAMS,
            r#""type": "MC_DigitalCamSwitch", "pins": {"Axis": "X", "Outputs": "X", "Switches": {"from": "m.Done"}}"#,
        ),
        case(
            "missing_pin",
            Schema,
            "outputs of no axis",
            CAMS,
            r#""type": "MC_DigitalCamSwitch", "pins": {"Axis": "X"}"#,
        ),
    ]
}

//! The description of a run: the header before the rows, and the columns that follow from it.

use serde::{Deserialize, Serialize};

use crate::column::{Column, Kind, Role};
use crate::read::ReadError;
use crate::trace::Note;

/// The columns of every axis after its name, in the order of the file. `State` is a name, the others are numbers:
/// the set-point at the end of the scan, and the position that the drive reported at its start. Later versions
/// append columns and do not reorder them.
pub const AXIS_SIGNALS: [&str; 7] = [
    "State",
    "Position",
    "Velocity",
    "Acceleration",
    "Jerk",
    "Snap",
    "ActualPosition",
];

/// Further columns of every axis at a `Slave` pin ([`Axis::slave`]): the master's name, the distance of
/// the set-point from the law (u), and the phase shift of the master (u of the master). Empty and 0 while
/// it follows none.
pub const SLAVE_SIGNALS: [&str; 3] = ["Master", "Deviation", "Phase"];

/// Further columns of every axis at the `Slave` pin of MC_CombineAxes ([`Axis::combined`]): the name of
/// the second master, and its phase shift (u of that master).
pub const COMBINED_SIGNALS: [&str; 2] = ["Master2", "Phase2"];

/// A further column of every axis at a `Slave` pin that MC_MoveSuperimposed may move
/// ([`Axis::superimposed`]): the distance superimposed on its law (u).
pub const SUPERIMPOSED_SIGNALS: [&str; 1] = ["Superimposed"];

/// A further column of every axis at the `Slave` pin of MC_CamIn ([`Axis::on_cam`]): the position of the master (u
/// of the master) at which the slave is on the curve. In sync it is the position of its master. It is 0 while the
/// slave is not on the curve.
pub const CAM_SIGNALS: [&str; 1] = ["Shadow"];

/// The description of a run: everything but its rows.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Header {
    /// Version of the runtime that made the trace.
    #[serde(default)]
    pub runtime: String,
    /// Title of the script; may be empty.
    #[serde(default)]
    pub title: String,
    /// Ids of the requirements that the script covers.
    #[serde(default)]
    pub covers: Vec<String>,
    /// A hash of the script's text, in the caller's form; empty if there was none.
    #[serde(default)]
    pub script_hash: String,
    /// Length of a scan (ns).
    pub cycle_ns: u64,
    /// The axes in script order.
    pub axes: Vec<Axis>,
    /// The script's input variables.
    pub inputs: Vec<Input>,
    /// The block instances in call order.
    pub instances: Vec<Instance>,
    /// The claims with their verdicts; empty until they are judged.
    #[serde(default)]
    pub claims: Vec<Claim>,
    /// The positions of the cams that axes were on, in the order of their first rows; at most [`CAMS_MAX`].
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cams: Vec<Cam>,
}

/// Largest number of entries of [`Header::cams`]; later ones are not kept.
pub const CAMS_MAX: usize = 64;

/// A cam with its position between two axes, for pictures.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Cam {
    /// The slave, by its index in [`Header::axes`].
    pub slave: usize,
    /// The master, likewise.
    pub master: usize,
    /// The first and the last row in which the cam was at this position.
    pub scans: [usize; 2],
    /// Position of the master at the first row of the table (u of the master), relative to its position in the
    /// first of the scans.
    pub begin: f64,
    /// Travel of the master from the first row to the last (u of the master); negative if it moves backwards.
    pub length: f64,
    /// Whether the table repeats.
    pub periodic: bool,
    /// Position of the slave at the first row (u).
    pub from: f64,
    /// The distances of the slave from there (u) at equal steps of the master, from the first row to the
    /// last, rounded to 32-bit floats.
    pub points: Vec<f64>,
}

/// One axis of the run. Units are `u`; the label is in `unit`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Axis {
    /// Its name in the script.
    pub name: String,
    /// Label of the user's unit, for example `mm`; empty if none was given.
    #[serde(default)]
    pub unit: String,
    /// Order of its profiles: 4 with a snap limit, 3 without, 2 without a jerk limit; 0 if not known.
    #[serde(default)]
    pub order: u8,
    /// Its limits.
    #[serde(default)]
    pub limits: Limits,
    /// Length of a turn (u) of a modulo axis; absent on a linear one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub modulo: Option<f64>,
    /// The ratio of units to drive increments; absent if the drive uses units.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scaling: Option<Scaling>,
    /// Whether it is at a `Slave` pin and also has the columns of [`SLAVE_SIGNALS`].
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub slave: bool,
    /// Whether it is at the `Slave` pin of MC_CombineAxes and also has the columns of
    /// [`COMBINED_SIGNALS`].
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub combined: bool,
    /// Whether it is at a `Slave` pin and at the `Axis` pin of MC_MoveSuperimposed, and also has the
    /// column of [`SUPERIMPOSED_SIGNALS`].
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub superimposed: bool,
    /// Whether it is at the `Slave` pin of MC_CamIn and also has the column of [`CAM_SIGNALS`].
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub on_cam: bool,
}

impl Axis {
    /// Its columns after its name, in the order of the file.
    pub fn signals(&self) -> impl Iterator<Item = &'static str> {
        let of_slave = if self.slave { &SLAVE_SIGNALS[..] } else { &[] };
        let of_combined = if self.combined { &COMBINED_SIGNALS[..] } else { &[] };
        let superimposed = if self.superimposed {
            &SUPERIMPOSED_SIGNALS[..]
        } else {
            &[]
        };
        let all = AXIS_SIGNALS.iter().chain(of_slave).chain(of_combined);
        let of_cam = if self.on_cam { &CAM_SIGNALS[..] } else { &[] };
        all.chain(superimposed).chain(of_cam).copied()
    }
}

/// Limits of an axis; absent means none.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Limits {
    /// Least position (u).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_min: Option<f64>,
    /// Greatest position (u).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position_max: Option<f64>,
    /// Largest speed (u/s).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub velocity: Option<f64>,
    /// Largest acceleration while speeding up (u/s^2).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub acceleration: Option<f64>,
    /// Largest acceleration while slowing down (u/s^2).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub deceleration: Option<f64>,
    /// Largest jerk (u/s^3).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub jerk: Option<f64>,
    /// Largest snap (u/s^4).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub snap: Option<f64>,
}

/// The integer ratio between units and drive increments.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scaling {
    /// This many increments ..
    pub increments: i64,
    /// .. are this many units.
    pub units: i64,
    /// The drive counts in the other direction.
    #[serde(default)]
    pub invert: bool,
    /// Position at increment 0 (u).
    #[serde(default)]
    pub offset: f64,
}

/// An input variable of the script.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// Its name.
    pub name: String,
    /// Its IEC type, for example `BOOL`.
    #[serde(rename = "type")]
    pub iec_type: String,
}

/// A block instance.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Instance {
    /// Its name.
    pub name: String,
    /// Its block, for example `MC_MoveAbsolute`.
    #[serde(rename = "type")]
    pub block: String,
    /// Its pins as in the block's table: in-outs, inputs, outputs.
    pub pins: Vec<Pin>,
}

/// A pin of a block instance.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Pin {
    /// Its name.
    pub name: String,
    /// Its IEC type, for example `LREAL`.
    #[serde(rename = "type")]
    pub iec_type: String,
    /// Its direction.
    pub direction: Direction,
    /// Text of its default value, if that is known; see [`Column::default`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub default: Option<String>,
    /// The script names it; see [`Column::named`].
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub named: bool,
    /// The statements of the program that write it, in text order; for a variable of a program in
    /// Structured Text.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub written: Vec<Written>,
}

/// A statement that writes a variable.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Written {
    /// File, line and column: `cell.st:31:5`.
    pub at: String,
    /// Text of the value it writes, where that is a constant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<String>,
}

/// The direction of a pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Direction {
    /// `VAR_IN_OUT`
    InOut,
    /// `VAR_INPUT`
    Input,
    /// `VAR_OUTPUT`
    Output,
}

/// A claim of the script, judged.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Claim {
    /// Its place in the script, for example `expect[2]`.
    pub path: String,
    /// Its statement.
    pub text: String,
    /// Whether it is fulfilled.
    pub verdict: ClaimVerdict,
    /// The first and the last scan it refers to; absent if that is not known or not in the run.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scans: Option<[usize; 2]>,
    /// The scan in which a claim that needs only one was fulfilled.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub held: Option<usize>,
    /// The reasons against it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub failures: Vec<ClaimFailure>,
}

/// One reason against a claim.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ClaimFailure {
    /// The first scan that shows it; absent if it is about the run as a whole.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scan: Option<usize>,
    /// The actual and the expected value.
    pub text: String,
}

/// Whether a claim is fulfilled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum ClaimVerdict {
    /// It is fulfilled.
    Passed,
    /// It is not fulfilled.
    Failed,
}

impl Claim {
    /// Every text in it.
    pub(crate) fn texts_mut(&mut self) -> impl Iterator<Item = &mut String> {
        let failures = self.failures.iter_mut().map(|failure| &mut failure.text);
        [&mut self.path, &mut self.text].into_iter().chain(failures)
    }
}

impl Header {
    /// Every text in it.
    pub(crate) fn texts_mut(&mut self) -> impl Iterator<Item = &mut String> {
        let Self {
            runtime,
            title,
            covers,
            script_hash,
            axes,
            inputs,
            instances,
            claims,
            cycle_ns: _,
            cams: _,
        } = self;
        let axes = axes.iter_mut().flat_map(|axis| [&mut axis.name, &mut axis.unit]);
        let inputs = inputs
            .iter_mut()
            .flat_map(|input| [&mut input.name, &mut input.iec_type]);
        let instances = instances.iter_mut().flat_map(|instance| {
            let pins = instance.pins.iter_mut();
            [&mut instance.name, &mut instance.block]
                .into_iter()
                .chain(pins.flat_map(|pin| {
                    let written = pin.written.iter_mut();
                    [&mut pin.name, &mut pin.iec_type]
                        .into_iter()
                        .chain(&mut pin.default)
                        .chain(written.flat_map(|it| std::iter::once(&mut it.at).chain(&mut it.value)))
                }))
        });
        let claims = claims.iter_mut().flat_map(Claim::texts_mut);
        [runtime, title, script_hash]
            .into_iter()
            .chain(covers)
            .chain(axes)
            .chain(inputs)
            .chain(instances)
            .chain(claims)
    }

    /// The columns of the trace in file order, after `scan` and `time_ns`: the axes, the input variables,
    /// the pins of the instances. No other code knows the order.
    #[must_use]
    pub fn columns(&self) -> Vec<Column> {
        let axes = self
            .axes
            .iter()
            .flat_map(|axis| axis.signals().map(|signal| axis_column(&axis.name, signal)));
        let inputs = self.inputs.iter().map(|input| Column {
            name: input.name.clone(),
            kind: Kind::of_iec_type(&input.iec_type),
            role: Role::Variable,
            is_time: is_time(&input.iec_type),
            default: None,
            named: false,
        });
        let pins = self.instances.iter().flat_map(|instance| {
            instance.pins.iter().map(|pin| Column {
                name: format!("{}.{}", instance.name, pin.name),
                kind: Kind::of_iec_type(&pin.iec_type),
                role: Role::of_direction(pin.direction),
                is_time: is_time(&pin.iec_type),
                default: pin.default.clone(),
                named: pin.named,
            })
        });
        axes.chain(inputs).chain(pins).collect()
    }

    /// The header as one line of JSON, beginning with the version of the format. It is the first line of
    /// a JSON Lines trace, and the whole `.meta.json` file beside a CSV trace.
    #[must_use]
    pub fn to_json(&self) -> String {
        // Strings, integers and finite numbers only. An infinite limit is no limit: serde_json writes it
        // as null, which is read as none.
        let fields = serde_json::to_string(self).unwrap_or_default();
        format!("{{\"{VERSION_KEY}\":{VERSION},{}", fields.trim_start_matches('{'))
    }

    /// Reads the text of [`Header::to_json`], of this version or with keys that a later one added.
    ///
    /// # Errors
    /// Text that is not JSON, not a trace header, or of another version of the format.
    pub fn from_json(text: &str) -> Result<Self, ReadError> {
        Self::with_notes(text).map(|(header, _)| header)
    }

    /// The same as [`Header::to_json`], with the notes of the run.
    pub(crate) fn json_with_notes(&self, notes: &[Note]) -> String {
        let json = self.to_json();
        match (notes, json.strip_suffix('}')) {
            ([_, ..], Some(open)) => {
                // Strings and integers: JSON can hold all of them.
                let notes = serde_json::to_string(notes).unwrap_or_default();
                format!("{open},\"notes\":{notes}}}")
            }
            _ => json,
        }
    }

    /// The same as [`Header::from_json`], with the notes of the run.
    pub(crate) fn with_notes(text: &str) -> Result<(Self, Vec<Note>), ReadError> {
        let text = text.trim_start_matches('\u{feff}');
        let probe: Probe = serde_json::from_str(text).map_err(|error| ReadError::json(&error, 1))?;
        match probe.standstill_trace {
            Some(VERSION) => serde_json::from_str(text)
                .map(|header| (header, probe.notes))
                .map_err(|error| ReadError::json(&error, 1)),
            Some(other) => Err(ReadError::at(
                1,
                None,
                format!("trace format {other}; this version reads {VERSION}"),
            )),
            None => Err(ReadError::at(
                1,
                None,
                format!("no trace header: `{VERSION_KEY}` is missing"),
            )),
        }
    }
}

/// The key that marks a header.
pub(crate) const VERSION_KEY: &str = "standstill_trace";

/// The version of the trace format.
const VERSION: u64 = 1;

#[derive(Deserialize)]
struct Probe {
    standstill_trace: Option<u64>,
    #[serde(default)]
    notes: Vec<Note>,
}

/// The column of an axis signal.
pub(crate) fn axis_column(axis: &str, signal: &str) -> Column {
    let (kind, role) = match signal {
        "State" => (Kind::Name, Role::AxisState),
        "Master" | "Master2" => (Kind::Name, Role::AxisValue),
        _ => (Kind::Real, Role::AxisValue),
    };
    Column {
        name: format!("{axis}.{signal}"),
        kind,
        role,
        is_time: false,
        default: None,
        named: false,
    }
}

fn is_time(iec_type: &str) -> bool {
    matches!(iec_type, "TIME" | "LTIME")
}

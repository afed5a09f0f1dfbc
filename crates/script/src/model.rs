//! A scan script as values: checked, names resolved to indices, parameters filled in.

use crate::error::File;
use standstill_axis::{AxisConfig, AxisState};
use standstill_fb::{BlockInfo, Group, PinType, TableInfo, TableRef, Value};
use std::collections::BTreeMap;
use std::sync::Arc;

pub use crate::variable::Variable;
pub use standstill_drives::simulated::{
    Cia402Setup, DriveChange, DriveSetup, IdealDriveSetup, MotorSetup, PlantSetup,
};

/// A script that has been read and checked.
#[derive(Clone, Debug)]
pub struct Script {
    /// One line of text, empty if none.
    pub title: String,
    /// Requirement ids, free text.
    pub covers: Vec<String>,
    /// Length of a scan (ns).
    pub cycle_ns: i64,
    /// Largest number of rows of the trace.
    pub scans: u64,
    /// Axes in script order; the index is their [`AxisId`](standstill_axis::AxisId).
    pub axes: Vec<Axis>,
    /// Script variables.
    pub inputs: Vec<Input>,
    /// The numbers of all tables, one after the other.
    pub tables: Vec<f64>,
    /// The tables in the section `tables`.
    pub named_tables: Vec<NamedTable>,
    /// The store of cams: slots, and pieces in all.
    pub cams: (usize, usize),
    /// Block instances in call order.
    pub blocks: Vec<Instance>,
    /// Guest programs; each runs in its task after the task's instances.
    pub programs: Vec<Program>,
    /// Expressions, in the order of reading.
    pub formulas: Vec<Formula>,
    /// Tasks; at least `main`.
    pub tasks: Vec<Task>,
    /// Steps in file order.
    pub steps: Vec<Step>,
    /// Claims in file order.
    pub claims: Vec<Claim>,
    /// Ends the run before `scans` rows: conditions, and scans after them.
    pub stop_when: Option<(Conditions, u64)>,
    /// Values of the script's parameters, after overrides.
    pub parameters: BTreeMap<String, f64>,
    /// Whether a golden counts in addition to the claims.
    pub golden: bool,
    /// Values above the limits are intended.
    pub clamps_expected: bool,
    /// The texts that places point into.
    pub(crate) files: Arc<[File]>,
    /// FNV-1a 64 of the script's bytes.
    pub hash: u64,
}

impl Script {
    /// The variable of a guest program at a point.
    pub(crate) fn symbol(&self, point: Point) -> Option<&Symbol> {
        match point {
            Point::Symbol(program, symbol) => self.programs.get(program)?.symbols.get(symbol),
            Point::Input(_) | Point::Pin(..) | Point::Formula(_) => None,
        }
    }

    /// The variable of Structured Text at a point.
    pub(crate) fn variable(&self, point: Point) -> Option<&Variable> {
        self.symbol(point)?.variable.as_ref()
    }

    /// The type of a pin, or of the signal of a guest's variable.
    pub(crate) fn type_of(&self, point: Point) -> Option<PinType> {
        match point {
            Point::Pin(instance, pin) => {
                let instance = self.blocks.get(instance)?;
                instance.block.pins().nth(pin).map(|pin| pin.ty)
            }
            point => self.symbol(point).map(|symbol| symbol.ty),
        }
    }
}

/// The place of an item in a script, and whether it may test nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Place {
    /// The place.
    pub span: Span,
    /// `"vacuous": "allowed"`
    pub may_be_vacuous: bool,
}

/// A table in the section `tables`.
#[derive(Clone, Debug)]
pub struct NamedTable {
    /// Name as written.
    pub name: String,
    /// Its type.
    pub info: TableInfo,
    /// The place of its numbers in [`Script::tables`].
    pub place: TableRef,
}

/// An axis of the script.
#[derive(Clone, Debug)]
pub struct Axis {
    /// Name as written.
    pub name: String,
    /// Label of the unit.
    pub unit: String,
    /// Configuration.
    pub config: AxisConfig,
    /// Its drive.
    pub drive: DriveSetup,
    /// The largest number of masters that a block with this axis at its `Slave` pin gives it: 0 for none, 2 for
    /// MC_CombineAxes.
    pub masters: usize,
    /// It has a master, and a block with it at its `Axis` pin superimposes motions.
    pub superimposed: bool,
    /// MC_CamIn has it at its `Slave` pin.
    pub on_cam: bool,
    /// Its place.
    pub place: Place,
}

/// A script variable.
#[derive(Clone, Debug)]
pub struct Input {
    /// Name as written.
    pub name: String,
    /// Value before any step: `Bool` or `Lreal`.
    pub initial: Value,
    /// Its place.
    pub place: Place,
}

/// A block instance.
#[derive(Clone, Debug)]
pub struct Instance {
    /// Name as written.
    pub name: String,
    /// Its block.
    pub block: &'static BlockInfo,
    /// Index of its task in [`Script::tasks`].
    pub task: usize,
    /// Constants, by pin index; in_outs included.
    pub constants: Vec<(usize, Value)>,
    /// Wires, by pin index.
    pub wires: Vec<(usize, Wire)>,
    /// Never called; only in a mutant.
    pub(crate) left_out: bool,
    /// Its place.
    pub place: Place,
}

impl Instance {
    /// The inputs that start it: index and name.
    pub(crate) fn triggers(&self) -> impl Iterator<Item = (usize, &'static str)> {
        let is_standard = self.block.group == Group::Standard;
        let is_trigger =
            move |name| is_standard || matches!(name, "Execute" | "Enable" | "JogForward" | "JogBackward");
        let inputs = self.block.inputs().iter().enumerate();
        inputs
            .filter(move |(_, pin)| pin.ty == PinType::Bool && is_trigger(pin.name))
            .map(|(index, pin)| (index, pin.name))
    }

    /// Whether the axis is at one of its pins.
    pub(crate) fn has_axis(&self, axis: usize) -> bool {
        let mut constants = self.constants.iter();
        constants.any(|(_, value)| matches!(value, Value::Axis(id) if id.index() == axis))
    }
}

/// A guest program.
#[derive(Clone, Debug)]
pub struct Program {
    /// Name as written.
    pub name: String,
    /// When it runs; at least one.
    pub calls: Vec<Call>,
    /// The compiled program.
    pub guest: standstill_guest::Program,
    /// Its variables that are signals; the first is `Fault`, which the runtime writes.
    pub symbols: Vec<Symbol>,
    /// Its place.
    pub place: Place,
    /// Data of a program in Structured Text.
    pub text: Option<Arc<ProgramText>>,
}

/// When a program runs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Call {
    /// Index of the task in [`Script::tasks`]; `None` runs once a scan, after all tasks.
    pub task: Option<usize>,
    /// The function that it calls; `plc_scan` if absent.
    pub entry: Option<String>,
}

/// A doubtful place of a program in Structured Text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Doubt {
    /// `cell.st:12:5: ` and the doubt, in one line.
    pub message: String,
    /// The remedy.
    pub help: String,
}

/// A program in Structured Text.
#[derive(Clone, Debug)]
pub struct ProgramText {
    /// Its variables and places.
    pub symbols: standstill_st::Symbols,
    /// Its instances of blocks by the address of their key, with the names that records show.
    pub blocks: BTreeMap<u32, String>,
    /// The compiler's doubts: place in the sources, the doubt, and the remedy.
    pub doubtful: Vec<Doubt>,
    /// Its files: their names in messages, and their text without a byte order mark.
    pub sources: Vec<(String, String)>,
    /// The script's folder, with which the names of its files begin.
    pub folder: String,
}

/// A variable of a guest.
#[derive(Clone, Debug)]
pub struct Symbol {
    /// Name as written.
    pub name: String,
    /// Type of its signal.
    pub ty: PinType,
    /// The type of the variable itself, which the type of its signal can hold.
    pub own: standstill_guest::SymbolType,
    /// Its address; if absent, the address that the guest exports.
    pub address: Option<u32>,
    /// The name of the guest's export; its own name if absent.
    pub export: Option<String>,
    /// Its variable in Structured Text.
    pub variable: Option<Variable>,
}

/// An expression in Structured Text.
#[derive(Clone, Debug)]
pub struct Formula {
    /// As written, with its `=`.
    pub text: String,
    /// Its place.
    pub span: Span,
    /// Whether it belongs to a condition, which reads rows; otherwise it belongs to a wire.
    pub in_rows: bool,
    /// Its compiled program.
    pub guest: standstill_guest::Program,
    /// The signals it reads.
    pub inputs: Vec<FormulaInput>,
    /// The place of its value.
    pub result: standstill_guest::Symbol,
    /// The type of its value.
    pub ty: PinType,
    /// The possible errors in it, by the number of their place.
    pub places: Vec<standstill_st::FaultKind>,
}

/// A signal that an expression reads.
#[derive(Clone, Debug)]
pub struct FormulaInput {
    /// The signal.
    pub signal: Signal,
    /// The variable that holds it.
    pub symbol: standstill_guest::Symbol,
    /// The properties of the variable.
    pub variable: Variable,
    /// Names and numbers of the elements, if it has some.
    pub names: Vec<(String, i128)>,
}

/// The source of a value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Point {
    /// Script variable by index.
    Input(usize),
    /// Pin of an instance, both by index.
    Pin(usize, usize),
    /// Variable of a guest program, both by index; 0 is `Fault`.
    Symbol(usize, usize),
    /// An expression of a wire by index.
    Formula(usize),
}

/// The source of an input pin.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wire {
    /// The value unchanged; also numeric.
    From(Point),
    /// Negated.
    Not(Point),
    /// At least one is TRUE.
    Any(Vec<Point>),
    /// All are TRUE.
    All(Vec<Point>),
}

impl Wire {
    /// The points that it reads.
    #[must_use]
    pub fn points(&self) -> &[Point] {
        match self {
            Self::From(point) | Self::Not(point) => std::slice::from_ref(point),
            Self::Any(points) | Self::All(points) => points,
        }
    }
}

/// A task.
#[derive(Clone, Debug)]
pub struct Task {
    /// Name as written.
    pub name: String,
    /// Scans between two executions; `None` has no period.
    pub interval: Option<u64>,
    /// 0 is the highest.
    pub priority: u32,
    /// A rising edge executes the task once.
    pub single: Option<Wire>,
    /// Consecutive overruns until the watchdog fires; `None` has no watchdog.
    pub watchdog: Option<u32>,
}

/// A place in the script's text, for messages; the places of included files follow.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Span {
    /// First byte.
    pub start: usize,
    /// Byte after the last.
    pub end: usize,
}

impl Span {
    /// The same piece, `by` bytes further on.
    pub(crate) const fn moved(self, by: usize) -> Self {
        Self {
            start: self.start + by,
            end: self.end + by,
        }
    }
}

/// When a step applies.
#[derive(Clone, Debug)]
pub enum When {
    /// At the input latch of this scan.
    At(u64),
    /// `after` scans later than the latch that follows a row on which all conditions hold.
    Holds {
        /// The conditions.
        conditions: Conditions,
        /// Additional scans.
        after: u64,
        /// Re-arms once the conditions have been false.
        every: bool,
    },
}

impl When {
    /// Number of rows that it reads in a scan.
    pub(crate) fn looks(&self) -> u64 {
        match self {
            Self::At(_) => 0,
            Self::Holds { conditions, .. } => conditions.len() as u64,
        }
    }
}

/// One step.
#[derive(Clone, Debug)]
pub struct Step {
    /// Its time.
    pub when: When,
    /// Its actions, in file order.
    pub actions: Vec<Action>,
    /// Its place.
    pub place: Place,
}

/// An action of a step.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Writes a variable or an input pin that is not wired.
    Set(Point, Value),
    /// Makes an axis or its drive fail.
    Fault {
        /// Index of the axis.
        axis: usize,
        /// The kind of the fault.
        kind: FaultKind,
        /// The code that the axis or drive shows.
        code: u16,
    },
    /// The cause of the axis's fault is gone.
    Clear {
        /// Index of the axis.
        axis: usize,
    },
    /// Changes the drive.
    Drive {
        /// Index of the axis.
        axis: usize,
        /// The change.
        change: DriveChange,
    },
}

/// The kinds of faults.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// The drive reports a fault and switches off.
    Drive,
    /// The power stage goes off.
    Power,
    /// Feedback is lost.
    Communication,
    /// The axis itself.
    Axis,
}

/// A value of the trace that a condition reads.
#[derive(Clone, Debug, PartialEq)]
pub enum Signal {
    /// A variable or a pin.
    Point(Point),
    /// State of an axis.
    State(usize),
    /// A number of an axis.
    Axis(usize, AxisNumber),
    /// A master of an axis at a `Slave` pin; empty while it follows none.
    Master(usize, WhichMaster),
    /// Backward difference of published positions of this order (1-4) over cycle^order.
    Difference(usize, u8),
    /// An expression of a condition by index: a BOOL.
    Formula(usize),
}

/// The masters of a slave.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WhichMaster {
    /// The only one, or the first of two.
    First,
    /// The second of two (MC_CombineAxes).
    Second,
}

/// The numeric columns of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisNumber {
    /// Set position.
    Position,
    /// Set velocity.
    Velocity,
    /// Set acceleration.
    Acceleration,
    /// Set jerk.
    Jerk,
    /// Set snap.
    Snap,
    /// Actual position.
    ActualPosition,
    /// Distance of a slave from the law.
    Deviation,
    /// Phase shift: the distance by which a slave sees its master further ahead.
    Phase,
    /// The distance by which a slave of two masters sees the second one further ahead.
    Phase2,
    /// The motion that is superimposed on the law of a slave.
    Superimposed,
    /// The position of the master at which a slave on a cam is.
    Shadow,
}

impl AxisNumber {
    /// The least number of masters that an axis needs for this column.
    pub(crate) const fn least_masters(self) -> usize {
        match self {
            Self::Deviation | Self::Phase | Self::Superimposed | Self::Shadow => 1,
            Self::Phase2 => 2,
            _ => 0,
        }
    }
}

/// All must hold.
pub type Conditions = Vec<Condition>;

/// A test on one signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Condition {
    /// The signal as written.
    pub text: String,
    /// The signal.
    pub signal: Signal,
    /// The required value.
    pub test: Test,
    /// Its place.
    pub span: Span,
}

impl Condition {
    /// The signals that it reads.
    pub(crate) fn signals(&self) -> impl Iterator<Item = &Signal> {
        let comparisons = match &self.test {
            Test::Compare(comparisons) => comparisons.as_slice(),
            _ => &[],
        };
        let others = comparisons.iter().filter_map(Comparison::other);
        std::iter::once(&self.signal).chain(others)
    }
}

/// The required value of a signal.
#[derive(Clone, Debug, PartialEq)]
pub enum Test {
    /// A BOOL.
    Bool(bool),
    /// Exactly this number (also TIME ns, INT, WORD, enum numbers).
    Exactly(f64),
    /// An axis state.
    State(AxisState),
    /// An enum element or axis, by number.
    Named(Value),
    /// An element of an enumeration of Structured Text, as its cells have it.
    Word(String),
    /// Comparisons, all must hold.
    Compare(Vec<Comparison>),
}

/// A comparison.
#[derive(Clone, Debug, PartialEq)]
pub enum Comparison {
    /// Within `within` of `near`.
    Near {
        /// The value.
        near: f64,
        /// The tolerance.
        within: f64,
    },
    /// Within `within` of another signal plus a number.
    NearTo {
        /// The other signal as written.
        name: String,
        /// The other signal.
        of: Signal,
        /// The value that is added to it.
        plus: f64,
        /// The tolerance.
        within: f64,
    },
    /// `<=`
    Le(f64),
    /// `>=`
    Ge(f64),
    /// `<`
    Lt(f64),
    /// `>`
    Gt(f64),
    /// Different: the test inside, on a plain value, must not hold.
    Ne(Box<Test>),
    /// Magnitude `<=`
    AbsLe(f64),
    /// Equal to the bit to another signal.
    SameAs(String, Signal),
    /// For a variable with a 64-bit whole number: exact, although an f64 may not be.
    Whole(Relation, i128),
}

/// The relation of two whole numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Relation {
    Eq,
    Le,
    Ge,
    Lt,
    Gt,
    AbsLe,
}

impl Relation {
    /// Whether `value` has this relation to `bound`.
    #[must_use]
    pub const fn holds(self, value: i128, bound: i128) -> bool {
        match self {
            Self::Eq => value == bound,
            Self::Le => value <= bound,
            Self::Ge => value >= bound,
            Self::Lt => value < bound,
            Self::Gt => value > bound,
            Self::AbsLe => value.abs() <= bound,
        }
    }
}

/// A statement of the script's author about the run.
#[derive(Clone, Debug)]
pub struct Claim {
    /// Path in the script, such as `expect[2]`.
    pub path: String,
    /// Its place.
    pub span: Span,
    /// `"vacuous": "allowed"`
    pub may_be_vacuous: bool,
    /// The scans it covers, as far as numbers define them.
    pub range: Range,
    /// The scans it covers, if conditions define them.
    pub window: Window,
    /// `while`: scans in which these do not hold are not judged; rising edges in them do not count.
    pub during: Conditions,
    /// Its statement.
    pub kind: ClaimKind,
}

/// The begin and the end of the scans that a claim covers, instead of the range in it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Window {
    /// The first row in which these hold.
    pub from: Option<Conditions>,
    /// The first row from there on in which these hold; the end of the run if none.
    pub to: Option<Conditions>,
}

/// The bounds of a count or a duration.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Bounds {
    /// At least.
    pub ge: Option<u64>,
    /// At most.
    pub le: Option<u64>,
}

impl Bounds {
    /// Whether a number is inside.
    pub fn admit(self, number: u64) -> bool {
        self.ge.is_none_or(|ge| number >= ge) && self.le.is_none_or(|le| number <= le)
    }
}

/// First and last scan of a claim; `None` is the end of the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Range {
    /// First scan.
    pub from: u64,
    /// Last scan, inclusive.
    pub to: Option<u64>,
}

/// A slave, its master, and the law between them.
#[derive(Clone, Debug, PartialEq)]
pub struct Follow {
    /// Index of the slave.
    pub slave: usize,
    /// Index of the master.
    pub master: usize,
    /// The slave moves `num` / `den` times the distance of its master.
    pub num: i16,
    /// Above 0.
    pub den: u16,
    /// A position of the master (u), and the position of the slave then (u).
    pub anchor: Option<[f64; 2]>,
}

/// The statement of a claim about the scans that it covers.
#[derive(Clone, Debug)]
pub enum ClaimKind {
    /// Holds in the only scan.
    At(Conditions),
    /// Holds at least once.
    By(Conditions),
    /// Holds in every scan.
    Always(Conditions),
    /// Holds in no scan together.
    Never(Conditions),
    /// Holds in exactly one scan.
    Once(Conditions),
    /// At most one of these is TRUE in every scan.
    Exclusive(Vec<(String, Point)>),
    /// d1..d4 of the axis stay inside its limits times the factor.
    WithinLimits {
        /// Index of the axis.
        axis: usize,
        /// Factor on every limit.
        factor: f64,
    },
    /// The slave is at the position of the law, to the bit.
    Follows(Follow),
    /// After each rising edge (or the first) `that` holds in some row, at most `within` scans later.
    Answered {
        /// The conditions whose rising edge counts.
        when: Conditions,
        /// Largest number of scans until the answer.
        within: u64,
        /// The answer.
        that: Conditions,
        /// Only the first rising edge.
        first: bool,
    },
    /// Does not hold together in `scans` rows in a row.
    NeverFor {
        /// The conditions.
        that: Conditions,
        /// Rows.
        scans: u64,
    },
    /// The scans from a rising edge of the first to the next one of the second are within the bounds.
    Duration {
        /// The begin and the end.
        ends: [Conditions; 2],
        /// Scans.
        bounds: Bounds,
        /// Every rising edge of the first, not only the first one.
        each: bool,
    },
    /// The number of rising edges is within the bounds.
    Count {
        /// The conditions whose rising edge counts.
        that: Conditions,
        /// Times.
        bounds: Bounds,
    },
}

impl Comparison {
    /// The other signal that it compares with, if any.
    pub fn other(&self) -> Option<&Signal> {
        match self {
            Self::SameAs(_, signal) | Self::NearTo { of: signal, .. } => Some(signal),
            _ => None,
        }
    }
}

impl Claim {
    /// Every condition in it, except those of its window.
    pub fn conditions(&self) -> impl Iterator<Item = &Condition> {
        let [first, second]: [&[Condition]; 2] = match &self.kind {
            ClaimKind::At(that)
            | ClaimKind::By(that)
            | ClaimKind::Always(that)
            | ClaimKind::Never(that)
            | ClaimKind::Once(that)
            | ClaimKind::NeverFor { that, .. }
            | ClaimKind::Count { that, .. } => [that, &[]],
            ClaimKind::Answered { when, that, .. } => [when, that],
            ClaimKind::Duration { ends, .. } => ends.each_ref().map(Vec::as_slice),
            ClaimKind::Exclusive(_) | ClaimKind::WithinLimits { .. } | ClaimKind::Follows(_) => [&[], &[]],
        };
        self.during.iter().chain(first).chain(second)
    }

    /// The largest number of reads of a row that judging takes in a scan.
    pub(crate) fn looks(&self) -> u64 {
        let during = self.during.len();
        let looks = match &self.kind {
            ClaimKind::At(that)
            | ClaimKind::By(that)
            | ClaimKind::Once(that)
            | ClaimKind::Never(that)
            | ClaimKind::NeverFor { that, .. } => during + that.len(),
            ClaimKind::Always(that) => that.len().saturating_mul(1 + during),
            ClaimKind::Exclusive(points) => points.len(),
            // The rows before decide whether a condition rises.
            ClaimKind::Answered { when, that, .. } => during + 2 * when.len() + that.len(),
            ClaimKind::Count { that, .. } => during + 2 * that.len(),
            ClaimKind::Duration {
                ends: [first, second],
                ..
            } => during + 2 * (first.len() + second.len()),
            // Positions of four differences.
            ClaimKind::WithinLimits { .. } => 14,
            // Two positions and the phase, and the arithmetic, which counts as further ones.
            ClaimKind::Follows(_) => during + 14,
        };
        looks as u64
    }
}

//! A scan script as values: checked, names resolved to indices, parameters filled in.

use standstill_axis::{AxisConfig, AxisState};
use standstill_fb::{BlockInfo, PinType, Value};
use std::collections::BTreeMap;

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
    /// Rows of the trace at most.
    pub scans: u64,
    /// Axes in script order; the index is their [`AxisId`](standstill_axis::AxisId).
    pub axes: Vec<Axis>,
    /// Script variables.
    pub inputs: Vec<Input>,
    /// The numbers of all tables, one after the other.
    pub tables: Vec<f64>,
    /// Block instances in call order.
    pub blocks: Vec<Instance>,
    /// Guest programs; each runs in its task after the task's instances.
    pub programs: Vec<Program>,
    /// Tasks; at least `main`.
    pub tasks: Vec<Task>,
    /// Steps in file order.
    pub steps: Vec<Step>,
    /// Claims in file order.
    pub claims: Vec<Claim>,
    /// Ends the run before `scans` rows: conditions, and scans after them.
    pub stop_when: Option<(Conditions, u64)>,
    /// Values of the script's parameters, overrides applied.
    pub parameters: BTreeMap<String, f64>,
    /// FNV-1a 64 of the script's bytes.
    pub hash: u64,
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
}

/// A script variable.
#[derive(Clone, Debug)]
pub struct Input {
    /// Name as written.
    pub name: String,
    /// Value before any step: `Bool` or `Lreal`.
    pub initial: Value,
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
}

/// A guest program.
#[derive(Clone, Debug)]
pub struct Program {
    /// Name as written.
    pub name: String,
    /// Index of its task in [`Script::tasks`].
    pub task: usize,
    /// What was compiled.
    pub guest: standstill_guest::Program,
    /// Its variables that are signals; before them stands `Fault`, which the runtime writes.
    pub symbols: Vec<Symbol>,
}

/// A variable of a guest.
#[derive(Clone, Debug)]
pub struct Symbol {
    /// Name as written.
    pub name: String,
    /// Type of its signal.
    pub ty: PinType,
    /// Its own type, which that of its signal holds.
    pub own: standstill_guest::SymbolType,
    /// Where it stands; where the guest exports it if absent.
    pub address: Option<u32>,
    /// What the guest exports it as; by its name if absent.
    pub export: Option<String>,
}

/// Where a value comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Point {
    /// Script variable by index.
    Input(usize),
    /// Pin of an instance, both by index.
    Pin(usize, usize),
    /// Variable of a guest program, both by index; 0 is `Fault`.
    Symbol(usize, usize),
}

/// What feeds an input pin.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Wire {
    /// The value as it is; also numeric.
    From(Point),
    /// Negated.
    Not(Point),
    /// At least one is TRUE.
    Any(Vec<Point>),
    /// All are TRUE.
    All(Vec<Point>),
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

/// A place in the script's text, for messages; those of included files follow on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Span {
    /// First byte.
    pub start: usize,
    /// Byte after the last.
    pub end: usize,
}

impl Span {
    /// The same piece, so many bytes further on.
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
        /// What must hold.
        conditions: Conditions,
        /// Further scans.
        after: u64,
        /// Re-arms once the conditions have been false.
        every: bool,
    },
}

impl When {
    /// Looks at the row of a scan.
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
    /// When.
    pub when: When,
    /// What, in file order.
    pub actions: Vec<Action>,
}

/// What a step does.
#[derive(Clone, Debug, PartialEq)]
pub enum Action {
    /// Writes a variable or an input pin that is not wired.
    Set(Point, Value),
    /// Makes an axis or its drive fail.
    Fault {
        /// Index of the axis.
        axis: usize,
        /// What fails.
        kind: FaultKind,
        /// Code it shows.
        code: u16,
    },
    /// The cause of the axis's fault is gone.
    Clear {
        /// Index of the axis.
        axis: usize,
    },
    /// Does something to the drive.
    Drive {
        /// Index of the axis.
        axis: usize,
        /// What.
        change: DriveChange,
    },
}

/// What fails.
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

/// A value of the trace a condition looks at.
#[derive(Clone, Debug, PartialEq)]
pub enum Signal {
    /// A variable or a pin.
    Point(Point),
    /// State of an axis.
    State(usize),
    /// A number of an axis.
    Axis(usize, AxisNumber),
    /// Backward difference of published positions of this order (1-4) over cycle^order.
    Difference(usize, u8),
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
    /// What it must be.
    pub test: Test,
    /// Where it stands.
    pub span: Span,
}

/// What a signal must be.
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
    /// `<=`
    Le(f64),
    /// `>=`
    Ge(f64),
    /// `<`
    Lt(f64),
    /// `>`
    Gt(f64),
    /// Different; the test inside must not hold.
    Ne(Box<Test>),
    /// Magnitude `<=`
    AbsLe(f64),
    /// Equal to the bit to another signal.
    SameAs(String, Signal),
}

/// What the script's author says of the run.
#[derive(Clone, Debug)]
pub struct Claim {
    /// Path in the script, such as `expect[2]`.
    pub path: String,
    /// Where it stands.
    pub span: Span,
    /// What it says.
    pub kind: ClaimKind,
}

/// First and last scan a claim looks at; `None` is the run's end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Range {
    /// First scan.
    pub from: u64,
    /// Last scan, inclusive.
    pub to: Option<u64>,
}

/// What a claim says.
#[derive(Clone, Debug)]
pub enum ClaimKind {
    /// Holds in this scan.
    At(u64, Conditions),
    /// Holds at least once within the range.
    By(Range, Conditions),
    /// Holds in every scan of the range in which `during` holds.
    Always {
        /// Scans.
        range: Range,
        /// `while`
        during: Conditions,
        /// What holds.
        that: Conditions,
    },
    /// Holds in no scan of the range in which `during` holds.
    Never {
        /// Scans.
        range: Range,
        /// `while`
        during: Conditions,
        /// What does not hold.
        that: Conditions,
    },
    /// Holds in exactly one scan of the range.
    Once(Range, Conditions),
    /// At most one of these is TRUE in every scan of the range.
    Exclusive(Range, Vec<(String, Point)>),
    /// d1..d4 of the axis stay inside its limits times the factor.
    WithinLimits {
        /// Scans.
        range: Range,
        /// Index of the axis.
        axis: usize,
        /// Factor on every limit.
        factor: f64,
    },
}

impl ClaimKind {
    /// Looks at the row of a scan that judging it takes at most.
    pub(crate) fn looks(&self) -> u64 {
        let looks = match self {
            Self::At(_, that) | Self::By(_, that) | Self::Once(_, that) => that.len(),
            Self::Always { during, that, .. } => that.len().saturating_mul(1 + during.len()),
            Self::Never { during, that, .. } => during.len() + that.len(),
            Self::Exclusive(_, points) => points.len(),
            // Positions of four differences.
            Self::WithinLimits { .. } => 14,
        };
        looks as u64
    }
}

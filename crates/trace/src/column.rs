//! Columns and cells.

use crate::header::Direction;
use crate::number;

/// The type of the cells of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// TRUE or FALSE.
    Bool,
    /// A 64-bit float.
    Real,
    /// A whole number: counters, `ErrorID`, TIME in nanoseconds. ULINT values above `i64::MAX` do not fit.
    Integer,
    /// A word: axis states, axes, enum elements, and all other values that are text.
    Name,
}

impl Kind {
    /// Its name for other programs.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Bool => "bool",
            Self::Real => "real",
            Self::Integer => "integer",
            Self::Name => "name",
        }
    }

    /// The kind of an IEC type. Types other than elementary numbers and BOOL (enums, `AXIS_REF`,
    /// structures) are shown by name.
    #[must_use]
    pub fn of_iec_type(iec_type: &str) -> Self {
        match iec_type {
            "BOOL" => Self::Bool,
            "REAL" | "LREAL" => Self::Real,
            "SINT" | "INT" | "DINT" | "LINT" | "USINT" | "UINT" | "UDINT" | "ULINT" | "BYTE" | "WORD"
            | "DWORD" | "LWORD" | "TIME" | "LTIME" => Self::Integer,
            _ => Self::Name,
        }
    }
}

/// What a column describes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The state of an axis.
    AxisState,
    /// A set-point or feedback of an axis.
    AxisValue,
    /// An input variable of the script.
    Variable,
    /// An in-out pin.
    InOut,
    /// An input pin.
    Input,
    /// An output pin; also any pin of a trace that was read without its header.
    Output,
}

impl Role {
    /// The role of a pin with this direction.
    #[must_use]
    pub const fn of_direction(direction: Direction) -> Self {
        match direction {
            Direction::InOut => Self::InOut,
            Direction::Input => Self::Input,
            Direction::Output => Self::Output,
        }
    }
}

/// One column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// `axis.Signal`, `instance.Pin`, or the name of an input variable.
    pub name: String,
    /// The kind of its cells.
    pub kind: Kind,
    /// The role of the column.
    pub role: Role,
    /// Whether it is a TIME (ns), which may change in every scan.
    pub is_time: bool,
    /// The text of its default value, if known: for an input or output pin. Unless the column is
    /// [named](Self::named), events show it only once it has another value, and a golden leaves it out if
    /// it keeps the default in all rows.
    pub default: Option<String>,
    /// Whether the script names this input pin: with a constant, a wire or a step. Then every row counts.
    pub named: bool,
}

impl Column {
    /// The axis or instance; empty for an input variable.
    #[must_use]
    pub fn subject(&self) -> &str {
        self.name.split_once('.').map_or("", |(subject, _)| subject)
    }

    /// The value of [`Column::default`]; also none if its text is not a value of the column's kind.
    pub(crate) fn default_cell(&self) -> Option<Cell<'_>> {
        Cell::read(self.kind, self.default.as_deref()?)
    }

    /// The same as [`Column::default_cell`], if the default is not shown.
    pub(crate) fn unsaid(&self) -> Option<Cell<'_>> {
        self.default_cell().filter(|_| !self.named)
    }

    /// The pin, the axis signal or the input variable.
    #[must_use]
    pub fn signal(&self) -> &str {
        self.name
            .split_once('.')
            .map_or(self.name.as_str(), |(_, signal)| signal)
    }
}

/// The value of a column in a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell<'a> {
    /// TRUE or FALSE.
    Bool(bool),
    /// A number. A trace holds no -0.0 and only one NaN, see
    /// [`Trace::push_row`](crate::Trace::push_row).
    Real(f64),
    /// A whole number; TIME is in nanoseconds.
    Integer(i64),
    /// A word.
    Name(&'a str),
}

impl<'a> Cell<'a> {
    /// The cell of a kind that has this text; none if there is none.
    pub(crate) fn read(kind: Kind, text: &'a str) -> Option<Self> {
        match kind {
            Kind::Bool => match text {
                "TRUE" => Some(Self::Bool(true)),
                "FALSE" => Some(Self::Bool(false)),
                _ => None,
            },
            Kind::Real => number::parse(text).map(Self::Real),
            Kind::Integer => text.parse().ok().map(Self::Integer),
            Kind::Name => Some(Self::Name(text)),
        }
    }

    /// The kind of the cell.
    #[must_use]
    pub const fn kind(&self) -> Kind {
        match self {
            Self::Bool(_) => Kind::Bool,
            Self::Real(_) => Kind::Real,
            Self::Integer(_) => Kind::Integer,
            Self::Name(_) => Kind::Name,
        }
    }
}

/// The bits with which a trace stores a number: without the sign of zero and the payload of NaN.
pub(crate) const fn canonical_bits(value: f64) -> u64 {
    if value.is_nan() {
        0x7ff8_0000_0000_0000
    } else {
        // Adding 0 turns -0 into 0.
        (value + 0.0).to_bits()
    }
}

//! A recorder's scans as the text of a trace, line by line, without a heap.
//!
//! The text is the same that `standstill-trace` writes for these rows. The recorder of the C library is in the
//! memory of its host; a test there compares the two texts.

mod number;
mod sentence;

use number::Real;
pub use sentence::{Called, happened, shift, shifted, standing, subject};

use crate::ring::{AXIS_WORDS, Ring, moved};
use core::fmt::{self, Display, Write};
use standstill_axis::{AxisConfig, AxisState, Event, Order, Record};
use standstill_fb::{BlockInfo, Direction, PinType, TableRef, Value};

/// A recorder: its contents, and the places they are at.
pub trait Recorded: Called {
    /// The position of rows and records.
    fn ring(&self) -> &Ring;

    /// Unit label and configuration of the axis at an index; none behind the last axis.
    fn axis_setup(&self, place: usize) -> Option<(&str, &AxisConfig)>;

    /// Name and block of the instance at an index; none behind the last instance.
    fn instance_setup(&self, place: usize) -> Option<(&str, &'static BlockInfo)>;

    /// The words at a place of the ring: of every axis, then of every instance.
    fn row(&self, place: usize) -> &[u64];

    /// The record at a place of the ring.
    fn record(&self, place: usize) -> Option<&Record>;
}

/// The forms of a trace.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// JSON Lines: the header, then an object a scan.
    JsonLines,
    /// A table: the names of the columns, then a line a scan.
    Csv,
    /// The file beside a table: the header.
    Meta,
}

impl Form {
    /// The number of lines for a recorder.
    pub fn lines(self, recorded: &impl Recorded) -> u64 {
        match self {
            Self::JsonLines | Self::Csv => 1 + recorded.ring().scans().1 as u64,
            Self::Meta => 1,
        }
    }
}

/// Writes line `line` of a form, counted from 0, with its end; nothing behind the last line. `cycle_ns`
/// is the time between two scans (ns).
///
/// Cost: proportional to the number of signals; for a header also to the number of records.
///
/// # Errors
/// Those of `out`.
pub fn line(
    out: &mut impl Write,
    form: Form,
    line: u64,
    recorded: &impl Recorded,
    title: &str,
    cycle_ns: u64,
) -> fmt::Result {
    if line >= form.lines(recorded) {
        return Ok(());
    }
    match (form, line.checked_sub(1)) {
        (Form::Csv, None) => names(out, recorded)?,
        (_, None) => header(out, recorded, title, cycle_ns)?,
        (_, Some(scan)) => row(out, form, scan, recorded, cycle_ns)?,
    }
    out.write_str("\n")
}

/// The columns of every axis, in the order of its words. The last word is written as a note.
const SIGNALS: [&str; AXIS_WORDS - 1] = [
    "State",
    "Position",
    "Velocity",
    "Acceleration",
    "Jerk",
    "Snap",
    "ActualPosition",
];

fn axes(recorded: &impl Recorded) -> impl Iterator<Item = (&str, &str, &AxisConfig)> {
    (0..).map_while(|place| {
        let (unit, config) = recorded.axis_setup(place)?;
        Some((recorded.axis(place), unit, config))
    })
}

fn instances(recorded: &impl Recorded) -> impl Iterator<Item = (&str, &'static BlockInfo)> {
    (0..).map_while(|place| recorded.instance_setup(place))
}

fn names(out: &mut impl Write, recorded: &impl Recorded) -> fmt::Result {
    out.write_str("scan,time_ns")?;
    for (axis, ..) in axes(recorded) {
        for signal in SIGNALS {
            write!(out, ",{axis}.{signal}")?;
        }
    }
    for (instance, block) in instances(recorded) {
        for pin in block.pins() {
            write!(out, ",{instance}.{}", pin.name)?;
        }
    }
    Ok(())
}

fn row(out: &mut impl Write, form: Form, scan: u64, recorded: &impl Recorded, cycle_ns: u64) -> fmt::Result {
    let is_json = form == Form::JsonLines;
    let time_ns = scan.wrapping_mul(cycle_ns);
    match is_json {
        true => write!(out, "{{\"scan\":{scan},\"time_ns\":{time_ns}")?,
        false => write!(out, "{scan},{time_ns}")?,
    }
    let place = usize::try_from(scan)
        .ok()
        .and_then(|scan| recorded.ring().row(scan));
    let mut words = place.map_or(&[][..], |place| recorded.row(place)).iter().copied();
    let mut cell = |of: &str, signal: &str, value: Cell<'_>| {
        out.write_str(",")?;
        if is_json {
            write!(out, "\"{of}.{signal}\":")?;
        }
        value.write(out, is_json)
    };
    for (axis, ..) in axes(recorded) {
        for signal in SIGNALS {
            let word = words.next().unwrap_or_default();
            let value = if signal == "State" {
                Cell::Name(state(word))
            } else {
                Cell::Real(f64::from_bits(word))
            };
            cell(axis, signal, value)?;
        }
        words.next();
    }
    for (instance, block) in instances(recorded) {
        for pin in block.pins() {
            let value = pin.ty.value(words.next().unwrap_or_default());
            cell(instance, pin.name, Cell::of(pin.ty, value, recorded))?;
        }
    }
    out.write_str(if is_json { "}" } else { "" })
}

/// The order of the profiles of an axis.
pub(crate) const fn order(config: &AxisConfig) -> u8 {
    match config.limits.order() {
        Order::Two => 2,
        Order::Three => 3,
        Order::Four => 4,
    }
}

/// The name of a state by its word in a row.
pub(crate) fn state(word: u64) -> &'static str {
    let found = AxisState::ALL.iter().find(|known| **known as u64 == word);
    found.map_or("", |known| known.name())
}

/// A value in the form of a trace.
enum Cell<'a> {
    Bool(bool),
    Integer(i64),
    Real(f64),
    Name(&'a str),
    /// A number in place of a missing name.
    Nameless(i32),
    Records(u16),
}

impl<'a> Cell<'a> {
    fn of(ty: PinType, value: Value, names: &'a impl Called) -> Self {
        match value {
            Value::Bool(value) => Self::Bool(value),
            Value::Int(value) => Self::Integer(value.into()),
            Value::Lreal(value) => Self::Real(value),
            Value::Word(value) => Self::Integer(value.into()),
            Value::Dword(value) => Self::Integer(value.into()),
            Value::Time(ns) => Self::Integer(ns),
            Value::Table(TableRef { records, .. }) => Self::Records(records),
            Value::Axis(id) => Self::Name(names.axis(id.index())),
            Value::Enum(number) => match ty {
                PinType::Enum(info) => info.name_of(number).map_or(Self::Nameless(number), Self::Name),
                _ => Self::Nameless(number),
            },
        }
    }

    fn write(&self, out: &mut impl Write, is_json: bool) -> fmt::Result {
        let is_quoted = is_json
            && match self {
                Self::Bool(_) | Self::Integer(_) => false,
                Self::Real(value) => !value.is_finite(),
                Self::Name(_) | Self::Nameless(_) | Self::Records(_) => true,
            };
        let quote = if is_quoted { "\"" } else { "" };
        out.write_str(quote)?;
        match *self {
            Self::Bool(value) => out.write_str(match (value, is_json) {
                (true, true) => "true",
                (true, false) => "TRUE",
                (false, true) => "false",
                (false, false) => "FALSE",
            })?,
            Self::Integer(value) => write!(out, "{value}")?,
            Self::Real(value) => write!(out, "{}", Real(value))?,
            Self::Name(text) => out.write_str(text)?,
            Self::Nameless(number) => write!(out, "{number}")?,
            Self::Records(1) => out.write_str("1 record")?,
            Self::Records(records) => write!(out, "{records} records")?,
        }
        out.write_str(quote)
    }
}

/// The members of a JSON object, one after the other.
struct Members<'w, W> {
    out: &'w mut W,
    is_first: bool,
}

impl<W: Write> Members<'_, W> {
    fn key(&mut self, key: &str) -> fmt::Result {
        let comma = if core::mem::take(&mut self.is_first) {
            ""
        } else {
            ","
        };
        write!(self.out, "{comma}\"{key}\":")
    }

    fn value(&mut self, key: &str, value: impl Display) -> fmt::Result {
        self.key(key)?;
        write!(self.out, "{value}")
    }

    /// A text without characters that need escaping.
    fn text(&mut self, key: &str, value: &str) -> fmt::Result {
        self.key(key)?;
        write!(self.out, "\"{value}\"")
    }

    /// A limit; none if it is not finite.
    fn limit(&mut self, key: &str, value: Option<f64>) -> fmt::Result {
        match value.filter(|value| value.is_finite()) {
            None => Ok(()),
            Some(value) => self.value(key, Real(value)),
        }
    }

    /// A list or an object; the caller writes its text to the result.
    fn nested<'s>(&'s mut self, key: &str) -> Result<&'s mut W, fmt::Error> {
        self.key(key)?;
        Ok(self.out)
    }
}

fn object<W: Write>(out: &mut W, write: impl FnOnce(&mut Members<'_, W>) -> fmt::Result) -> fmt::Result {
    out.write_str("{")?;
    write(&mut Members { out, is_first: true })?;
    out.write_str("}")
}

fn list<W: Write, T>(
    out: &mut W,
    items: impl Iterator<Item = T>,
    mut write: impl FnMut(&mut W, T) -> fmt::Result,
) -> fmt::Result {
    out.write_str("[")?;
    let mut is_first = true;
    for item in items {
        if !core::mem::take(&mut is_first) {
            out.write_str(",")?;
        }
        write(out, item)?;
    }
    out.write_str("]")
}

fn header<W: Write>(out: &mut W, recorded: &impl Recorded, title: &str, cycle_ns: u64) -> fmt::Result {
    object(out, |header| {
        header.value("standstill_trace", 1)?;
        header.text("runtime", env!("CARGO_PKG_VERSION"))?;
        header.text("title", title)?;
        header.value("covers", "[]")?;
        header.text("script_hash", "")?;
        header.value("cycle_ns", cycle_ns)?;
        list(
            header.nested("axes")?,
            axes(recorded),
            |out, (name, unit, config)| axis(out, name, unit, config),
        )?;
        header.value("inputs", "[]")?;
        list(
            header.nested("instances")?,
            instances(recorded),
            |out, (name, block)| instance(out, name, block),
        )?;
        header.value("claims", "[]")?;
        let out = header.nested("notes")?;
        out.write_str("[")?;
        note(out, 0, "recorder", |out| standing(out, recorded.ring(), recorded))?;
        let (first, kept) = recorded.ring().scans();
        // In the order of their scans; in a scan, shifts of coordinates come first.
        let mut shifts = shifts(recorded);
        let mut next = shifts.next();
        let mut shifts_until = |out: &mut W, last: u64| {
            while let Some((row, axis, by)) = next.filter(|(row, ..)| *row <= last) {
                out.write_str(",")?;
                note(out, row, axis, |out| shifted(out, by))?;
                next = shifts.next();
            }
            Ok(())
        };
        let records = recorded.ring().records();
        for record in records.filter_map(|place| recorded.record(place)) {
            let row = record.scan.checked_sub(first).filter(|row| *row < kept as u64);
            let Some(row) = row.filter(|_| !matches!(record.event, Event::Shifted { .. })) else {
                continue;
            };
            shifts_until(out, row)?;
            out.write_str(",")?;
            note(out, row, subject(recorded, record), |out| {
                happened(out, recorded, record)
            })?;
        }
        shifts_until(out, u64::MAX)?;
        out.write_str("]")
    })
}

/// The shifts of coordinates: the row, the axis, and the distance (u).
fn shifts(recorded: &impl Recorded) -> impl Iterator<Item = (u64, &str, f64)> {
    let (_, kept) = recorded.ring().scans();
    (0..kept).flat_map(move |row| {
        let place = recorded.ring().row(row);
        let words = place.map_or(&[][..], |place| recorded.row(place));
        let told = axes(recorded).zip(words.chunks_exact(AXIS_WORDS));
        told.map(move |((axis, ..), words)| (row as u64, axis, moved(words)))
            .filter(|(.., by)| *by != 0.0)
    })
}

fn axis<W: Write>(out: &mut W, name: &str, unit: &str, config: &AxisConfig) -> fmt::Result {
    let limits = &config.limits;
    object(out, |axis| {
        axis.text("name", name)?;
        axis.text("unit", unit)?;
        axis.value("order", order(config))?;
        object(axis.nested("limits")?, |told| {
            told.limit("position_min", config.software_limits.map(|(min, _)| min))?;
            told.limit("position_max", config.software_limits.map(|(_, max)| max))?;
            told.limit("velocity", Some(limits.velocity))?;
            told.limit("acceleration", Some(limits.acceleration))?;
            told.limit("deceleration", Some(limits.deceleration))?;
            told.limit("jerk", Some(limits.jerk))?;
            told.limit("snap", Some(limits.snap))
        })?;
        axis.limit("modulo", config.modulo)?;
        let Some(scaling) = config.scaling else {
            return Ok(());
        };
        object(axis.nested("scaling")?, |told| {
            told.value("increments", scaling.increments())?;
            told.value("units", scaling.units())?;
            told.value("invert", scaling.invert())?;
            told.limit("offset", Some(scaling.offset()))
        })
    })
}

fn instance<W: Write>(out: &mut W, name: &str, block: &'static BlockInfo) -> fmt::Result {
    object(out, |told| {
        told.text("name", name)?;
        told.text("type", block.name)?;
        list(told.nested("pins")?, block.pins(), |out, pin| {
            object(out, |told| {
                told.text("name", pin.name)?;
                told.text("type", pin.ty.iec_name())?;
                told.text(
                    "direction",
                    match pin.direction {
                        Direction::InOut => "in_out",
                        Direction::Input => "input",
                        Direction::Output => "output",
                    },
                )
            })
        })
    })
}

fn note<W: Write>(
    out: &mut W,
    scan: u64,
    subject: &str,
    text: impl FnOnce(&mut W) -> fmt::Result,
) -> fmt::Result {
    object(out, |note| {
        note.value("scan", scan)?;
        note.text("subject", subject)?;
        let out = note.nested("text")?;
        out.write_str("\"")?;
        text(out)?;
        out.write_str("\"")
    })
}

//! Where the signals of a script stand in a row of a trace, and the header of its own one.

use crate::model::{AxisNumber, Point, Program, Script, Symbol};
use standstill_fb::{PinType, Value};
use standstill_record::told;
use standstill_trace as trace;

/// Column numbers of a script's signals: the axes, the input variables, the pins in call order.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    /// First column of the input variables.
    variables: usize,
    /// First column of each instance.
    instances: Vec<usize>,
    /// First column of each guest program.
    programs: Vec<usize>,
    /// Where a trace that is not of the script's own run has these columns.
    elsewhere: Option<Vec<Option<usize>>>,
}

impl Layout {
    pub(crate) fn new(script: &Script) -> Self {
        let variables = script.axes.len() * trace::AXIS_SIGNALS.len();
        let mut next = variables + script.inputs.len();
        let mut instances = Vec::with_capacity(script.blocks.len());
        for instance in &script.blocks {
            instances.push(next);
            next += instance.block.pins().count();
        }
        let mut programs = Vec::with_capacity(script.programs.len());
        for program in &script.programs {
            programs.push(next);
            next += program.symbols.len();
        }
        Self {
            variables,
            instances,
            programs,
            elsewhere: None,
        }
    }

    /// The columns of a script as a trace has them by name: those of the same name and kind.
    pub(crate) fn of(script: &Script, recording: &trace::Trace) -> Self {
        let place = |column: trace::Column| {
            let place = recording.column(&column.name)?;
            (recording.columns().get(place)?.kind == column.kind).then_some(place)
        };
        let columns = header(script).columns();
        Self {
            elsewhere: Some(columns.into_iter().map(place).collect()),
            ..Self::new(script)
        }
    }

    /// Whether the trace may begin amid motion: it is not of the script's own run.
    pub(crate) const fn is_of_recording(&self) -> bool {
        self.elsewhere.is_some()
    }

    /// Where the trace has a column of the script.
    fn place(&self, column: usize) -> Option<usize> {
        match &self.elsewhere {
            None => Some(column),
            Some(places) => *places.get(column)?,
        }
    }

    /// Column of a variable or pin.
    pub(crate) fn point(&self, point: Point) -> Option<usize> {
        self.place(match point {
            Point::Input(index) => self.variables + index,
            Point::Pin(instance, pin) => self.instances.get(instance)? + pin,
            Point::Symbol(program, symbol) => self.programs.get(program)? + symbol,
        })
    }

    /// Column of an axis state.
    pub(crate) fn state(&self, axis: usize) -> Option<usize> {
        self.place(axis * trace::AXIS_SIGNALS.len())
    }

    /// Column of a number of an axis; the order is that of [`trace::AXIS_SIGNALS`].
    pub(crate) fn number(&self, axis: usize, number: AxisNumber) -> Option<usize> {
        let place = match number {
            AxisNumber::Position => 1,
            AxisNumber::Velocity => 2,
            AxisNumber::Acceleration => 3,
            AxisNumber::Jerk => 4,
            AxisNumber::Snap => 5,
            AxisNumber::ActualPosition => 6,
        };
        self.place(axis * trace::AXIS_SIGNALS.len() + place)
    }
}

/// What a trace of the script says of itself before it has rows and verdicts.
pub(crate) fn header(script: &Script) -> trace::Header {
    trace::Header {
        runtime: env!("CARGO_PKG_VERSION").to_owned(),
        title: script.title.clone(),
        covers: script.covers.clone(),
        script_hash: format!("{:016x}", script.hash),
        cycle_ns: script.cycle_ns.unsigned_abs(),
        axes: script
            .axes
            .iter()
            .map(|axis| told::axis(&axis.name, &axis.unit, &axis.config))
            .collect(),
        inputs: script
            .inputs
            .iter()
            .map(|input| trace::Input {
                name: input.name.clone(),
                iec_type: type_of(input.initial).to_owned(),
            })
            .collect(),
        instances: script
            .blocks
            .iter()
            .map(|instance| told::instance(instance.name.clone(), instance.block))
            .chain(script.programs.iter().map(program))
            .collect(),
        claims: Vec::new(),
    }
}

/// A guest program stands in a trace as an instance whose pins are its symbols.
fn program(program: &Program) -> trace::Instance {
    let pin = |symbol: &Symbol| trace::Pin {
        name: symbol.name.clone(),
        iec_type: symbol.ty.iec_name().to_owned(),
        direction: trace::Direction::Output,
    };
    trace::Instance {
        name: program.name.clone(),
        block: "PROGRAM".to_owned(),
        pins: program.symbols.iter().map(pin).collect(),
    }
}

/// Type of an input variable; a script knows only these two.
fn type_of(value: Value) -> &'static str {
    match value {
        Value::Bool(_) => PinType::Bool.iec_name(),
        _ => PinType::Lreal.iec_name(),
    }
}

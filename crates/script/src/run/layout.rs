//! The columns of a script's signals in a row of a trace, and the header of its own trace.

use super::cells;
use crate::model::{Action, AxisNumber, Point, Program, Script, Signal, Symbol, Variable, WhichMaster};
use standstill_blocks::BlockInstance;
use standstill_fb::{AnyInstance, Direction};
use standstill_record::told;
use standstill_trace::{self as trace, Kind};
use std::collections::BTreeSet;
use std::ops::Range;

/// Column numbers of a script's signals: the axes, the input variables, the pins in call order.
#[derive(Clone, Debug)]
pub(crate) struct Layout {
    /// Columns of each axis.
    axes: Vec<Range<usize>>,
    /// The column of the superimposed distance of each, if it has one.
    superimposed: Vec<Option<usize>>,
    /// The column of the shadow of each, if it has one.
    shadows: Vec<Option<usize>>,
    /// First column of the input variables.
    variables: usize,
    /// First column of each instance.
    instances: Vec<usize>,
    /// First column of each guest program.
    programs: Vec<usize>,
    /// The columns in a trace that lacks some of them, or has others between them.
    elsewhere: Option<Vec<Option<usize>>>,
    /// Whether the trace is not of the script's own run.
    of_recording: bool,
}

impl Layout {
    pub(crate) fn new(script: &Script) -> Self {
        let mut next = 0;
        let mut axes = Vec::with_capacity(script.axes.len());
        let mut superimposed = Vec::with_capacity(script.axes.len());
        let mut shadows = Vec::with_capacity(script.axes.len());
        for axis in &script.axes {
            let first = next;
            let of_slave = match axis.masters {
                0 => 0,
                1 => trace::SLAVE_SIGNALS.len(),
                _ => trace::SLAVE_SIGNALS.len() + trace::COMBINED_SIGNALS.len(),
            };
            next += trace::AXIS_SIGNALS.len() + of_slave;
            superimposed.push(axis.superimposed.then_some(next));
            if axis.superimposed {
                next += trace::SUPERIMPOSED_SIGNALS.len();
            }
            shadows.push(axis.on_cam.then_some(next));
            if axis.on_cam {
                next += trace::CAM_SIGNALS.len();
            }
            axes.push(first..next);
        }
        let variables = next;
        next += script.inputs.len();
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
            axes,
            superimposed,
            shadows,
            variables,
            instances,
            programs,
            elsewhere: None,
            of_recording: false,
        }
    }

    /// The columns of a script in a trace, by name: those of the same name and kind.
    pub(crate) fn of(script: &Script, recording: &trace::Trace) -> Self {
        let place = |column: trace::Column| {
            let place = recording.column(&column.name)?;
            (recording.columns().get(place)?.kind == column.kind).then_some(place)
        };
        let columns = header(script).columns();
        Self {
            elsewhere: Some(columns.into_iter().map(place).collect()),
            of_recording: true,
            ..Self::new(script)
        }
    }

    /// The columns of a script whose trace has only these.
    pub(crate) fn of_some(script: &Script, kept: &BTreeSet<usize>) -> Self {
        let end = kept.last().map_or(0, |last| last + 1);
        let mut places = vec![None; end];
        for (place, column) in kept.iter().enumerate() {
            places[*column] = Some(place);
        }
        Self {
            elsewhere: Some(places),
            ..Self::new(script)
        }
    }

    /// Whether the trace may begin in motion: it is not of the script's own run.
    pub(crate) const fn is_of_recording(&self) -> bool {
        self.of_recording
    }

    /// Whether the trace has all of these columns, as the script's own run does.
    pub(crate) const fn has_all(&self) -> bool {
        self.elsewhere.is_none()
    }

    /// The index of a column of the script in the trace.
    pub(super) fn place(&self, column: usize) -> Option<usize> {
        match &self.elsewhere {
            None => Some(column),
            Some(places) => places.get(column).copied().flatten(),
        }
    }

    /// Column of a signal; none for one that depends on more than a row.
    pub(crate) fn column(&self, signal: &Signal) -> Option<usize> {
        match *signal {
            Signal::Point(point) => self.point(point),
            Signal::State(axis) => self.state(axis),
            Signal::Master(axis, which) => self.master(axis, which),
            Signal::Axis(axis, number) => self.number(axis, number),
            Signal::Difference(..) | Signal::Formula(_) => None,
        }
    }

    /// Column of a variable or pin.
    pub(crate) fn point(&self, point: Point) -> Option<usize> {
        self.place(match point {
            Point::Input(index) => self.variables + index,
            Point::Pin(instance, pin) => self.instances.get(instance)? + pin,
            Point::Symbol(program, symbol) => self.programs.get(program)? + symbol,
            Point::Formula(_) => return None,
        })
    }

    /// Column of an axis state.
    pub(crate) fn state(&self, axis: usize) -> Option<usize> {
        self.of_axis(axis, 0)
    }

    /// Column of the name of a slave's master.
    pub(crate) fn master(&self, axis: usize, which: WhichMaster) -> Option<usize> {
        let place = match which {
            WhichMaster::First => 7,
            WhichMaster::Second => 10,
        };
        self.of_axis(axis, place)
    }

    /// Column of a number of an axis, if it has it; the order is that of [`trace::AXIS_SIGNALS`], then
    /// [`trace::SLAVE_SIGNALS`] and [`trace::COMBINED_SIGNALS`].
    pub(crate) fn number(&self, axis: usize, number: AxisNumber) -> Option<usize> {
        let place = match number {
            AxisNumber::Position => 1,
            AxisNumber::Velocity => 2,
            AxisNumber::Acceleration => 3,
            AxisNumber::Jerk => 4,
            AxisNumber::Snap => 5,
            AxisNumber::ActualPosition => 6,
            AxisNumber::Deviation => 8,
            AxisNumber::Phase => 9,
            AxisNumber::Phase2 => 11,
            AxisNumber::Superimposed => return self.place((*self.superimposed.get(axis)?)?),
            AxisNumber::Shadow => return self.place((*self.shadows.get(axis)?)?),
        };
        self.of_axis(axis, place)
    }

    fn of_axis(&self, axis: usize, place: usize) -> Option<usize> {
        self.place(self.axes.get(axis)?.clone().nth(place)?)
    }
}

/// The header of the script's trace before it has rows and verdicts.
pub(crate) fn header(script: &Script) -> trace::Header {
    trace::Header {
        runtime: env!("CARGO_PKG_VERSION").to_owned(),
        title: script.title.clone(),
        covers: script.covers.clone(),
        script_hash: format!("{:016x}", script.hash),
        cycle_ns: script.cycle_ns.unsigned_abs(),
        axes: axes(script),
        inputs: script
            .inputs
            .iter()
            .map(|input| trace::Input {
                name: input.name.clone(),
                iec_type: cells::type_of(input.initial).iec_name().to_owned(),
            })
            .collect(),
        instances: blocks(script)
            .into_iter()
            .chain(script.programs.iter().map(program))
            .collect(),
        claims: Vec::new(),
        cams: Vec::new(),
    }
}

/// The axes, with their limits.
pub(crate) fn axes(script: &Script) -> Vec<trace::Axis> {
    let axes = script.axes.iter();
    axes.map(|axis| trace::Axis {
        slave: axis.masters > 0,
        combined: axis.masters > 1,
        superimposed: axis.superimposed,
        on_cam: axis.on_cam,
        ..told::axis(&axis.name, &axis.unit, &axis.config)
    })
    .collect()
}

/// The block instances, with the defaults of their pins and the inputs that the script names.
fn blocks(script: &Script) -> Vec<trace::Instance> {
    let actions = script.steps.iter().flat_map(|step| &step.actions);
    let set: BTreeSet<(usize, usize)> = actions
        .filter_map(|action| match action {
            Action::Set(Point::Pin(instance, pin), _) => Some((*instance, *pin)),
            _ => None,
        })
        .collect();
    let mut texts = cells::cells(script);
    let mut all = Vec::with_capacity(script.blocks.len());
    for (index, instance) in script.blocks.iter().enumerate() {
        let constants = instance.constants.iter().map(|(pin, _)| *pin);
        let named: BTreeSet<usize> = constants
            .chain(instance.wires.iter().map(|(pin, _)| *pin))
            .collect();
        let fresh = BlockInstance::new(instance.block.name);
        let mut header = told::instance(instance.name.clone(), instance.block);
        for ((at, pin), header) in instance.block.pins().enumerate().zip(&mut header.pins) {
            if pin.direction == Direction::InOut {
                continue;
            }
            header.named = named.contains(&at) || set.contains(&(index, at));
            if let Some(value) = fresh.as_ref().and_then(|fresh| fresh.get(at)) {
                texts.prepare(pin.ty, value);
                header.default = Some(trace::cell_text(texts.cell(pin.ty, value)));
            }
        }
        all.push(header);
    }
    all
}

/// A guest program is an instance in a trace, with its symbols as pins. All are outputs, and zero before
/// it writes them.
fn program(program: &Program) -> trace::Instance {
    let pin = |symbol: &Symbol| {
        let own = symbol.variable.as_ref().map(Variable::type_name);
        let iec_type = own.unwrap_or_else(|| symbol.ty.iec_name());
        trace::Pin {
            name: symbol.name.clone(),
            iec_type: iec_type.to_owned(),
            direction: trace::Direction::Output,
            default: zero(Kind::of_iec_type(iec_type)),
            named: false,
            written: written(program, symbol),
        }
    };
    trace::Instance {
        name: program.name.clone(),
        block: "PROGRAM".to_owned(),
        pins: program.symbols.iter().map(pin).collect(),
    }
}

/// The statements that write a variable of a program in Structured Text.
fn written(program: &Program, symbol: &Symbol) -> Vec<trace::Written> {
    let Some(text) = &program.text else {
        return Vec::new();
    };
    let Some(found) = text.symbols.find(&symbol.name) else {
        return Vec::new();
    };
    let each = text.symbols.writers(&found).into_iter();
    each.map(|it| {
        // It does not depend on the folder from which the script is run.
        let file = it.file.strip_prefix(&text.folder).unwrap_or(&it.file);
        trace::Written {
            at: format!("{file}:{}:{}", it.position.line, it.position.column),
            value: it.value,
        }
    })
    .collect()
}

/// The default value of a guest's variable.
fn zero(kind: Kind) -> Option<String> {
    let text = match kind {
        Kind::Bool => "FALSE",
        Kind::Real => "0.0",
        Kind::Integer => "0",
        Kind::Name => return None,
    };
    Some(text.to_owned())
}

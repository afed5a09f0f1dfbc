//! The row of a scan. Its structure is prepared once. In a scan, axes, variables, pins and symbols are read as
//! words, and only cells whose word has changed are made again.

use super::bench::ScriptMachine;
use super::cells;
use super::layout::Layout;
use super::values::Values;
use crate::model::{Point, Script};
use standstill_axis::{AxisId, AxisState};
use standstill_fb::{AnyInstance, PinType, Value};
use standstill_record::told::Cells;
use standstill_record::{AXIS_WORDS, write_axis};
use standstill_scan::ScanTime;
use standstill_trace::{Cell, RowError, Trace};

/// Additional words of a slave, in the order of their columns.
const SLAVE_WORDS: usize = 7;

/// Writes the rows of a script's run.
#[derive(Clone, Debug)]
pub(super) struct RowWriter {
    parts: Vec<Part>,
    /// Words of the part that is being read.
    words: Vec<u64>,
    cells: Cells,
}

/// An axis, the variables, an instance or a program, of which the trace has a column.
#[derive(Clone, Debug)]
struct Part {
    of: Of,
    columns: Vec<Column>,
    /// The index of its first column in the trace.
    first: usize,
    /// Number of its words.
    count: usize,
    /// Its words in the last row; none before the first one.
    words: Vec<u64>,
    /// Whether it may change while programs are idle.
    moves: bool,
    /// The columns of an axis that change while it only continues: the numbers of its set-point, and its actual
    /// position.
    motion: ([Option<usize>; 5], Option<usize>),
}

#[derive(Clone, Copy, Debug)]
enum Of {
    Axis(usize),
    Variables,
    Instance(usize),
    Program(usize),
}

/// A column of the trace.
#[derive(Clone, Debug)]
struct Column {
    /// The index of its word in its part.
    place: usize,
    /// The meaning of the word.
    told: Told,
}

#[derive(Clone, Copy, Debug)]
enum Told {
    State,
    Pin(PinType),
    /// A symbol of this guest program.
    Symbol(usize),
}

/// The source of a row.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub(super) script: &'a Script,
    pub(super) values: &'a Values,
    pub(super) machine: &'a ScriptMachine,
    /// Axis states after all blocks were called, before the motion step.
    pub(super) states: &'a [AxisState],
    pub(super) scan: u64,
}

impl RowWriter {
    /// For the columns that the layout has a place for.
    pub(super) fn new(script: &Script, layout: &Layout) -> Self {
        let mut all = parts(script);
        let mut next = 0;
        for part in &mut all {
            part.columns.retain(|_| {
                next += 1;
                layout.place(next - 1).is_some()
            });
        }
        all.retain(|part| !part.columns.is_empty());
        let mut first = 0;
        for part in &mut all {
            part.first = first;
            first += part.columns.len();
            // In the order of `write_axis`, behind the state.
            part.motion = ([1, 2, 3, 4, 5].map(|place| part.column(place)), part.column(6));
        }
        Self {
            words: vec![0; all.iter().map(|part| part.count).max().unwrap_or(0)],
            parts: all,
            cells: cells::cells(script),
        }
    }

    /// The next row is the first one of another run.
    pub(super) fn restart(&mut self) {
        self.parts.iter_mut().for_each(|part| part.words.clear());
    }

    /// These instances may change while programs are idle, as axes do.
    pub(super) fn mind(&mut self, instances: &[usize]) {
        for part in &mut self.parts {
            part.moves |= matches!(part.of, Of::Instance(index) if instances.contains(&index));
        }
    }

    /// Writes the row of a scan. It allocates only for the trace, and there only for new texts.
    pub(super) fn write(&mut self, source: &Source<'_>, trace: &mut Trace) -> Result<(), RowError> {
        for part in &mut self.parts {
            part.write(source, (&mut self.words, &mut self.cells), trace)?;
        }
        trace.push_next(1);
        Ok(())
    }

    /// The same for a scan in which programs were idle.
    pub(super) fn write_resting(&mut self, source: &Source<'_>, trace: &mut Trace) -> Result<(), RowError> {
        for part in self.parts.iter_mut().filter(|part| part.moves) {
            match part.of {
                Of::Axis(axis) => part.write_motion(source, axis, trace),
                _ => part.write(source, (&mut self.words, &mut self.cells), trace)?,
            }
        }
        trace.push_next(1);
        Ok(())
    }

    /// Advances the axes alone for `scans` scans and writes their rows; `first` is the first scan.
    pub(super) fn write_along(
        &mut self,
        scans: usize,
        first: ScanTime,
        machine: &mut ScriptMachine,
        trace: &mut Trace,
    ) {
        trace.push_next(scans);
        for axis in 0..machine.axes().len() {
            let is_its = |part: &&mut Part| matches!(part.of, Of::Axis(of) if of == axis);
            let part = self.parts.iter_mut().find(is_its);
            let (columns, _) = part.map_or(&([None; 5], None), Part::moved);
            trace.write_last_reals(scans, columns, |places| {
                machine.along(axis, first, scans, |scan, setpoint| {
                    for (of_column, number) in places.iter_mut().zip(setpoint.numbers()) {
                        if let Some(place) = of_column.get_mut(scan) {
                            *place = number;
                        }
                    }
                });
            });
        }
    }
}

impl Part {
    /// Writes those cells whose words have changed.
    fn write(
        &mut self,
        source: &Source<'_>,
        (words, cells): (&mut [u64], &mut Cells),
        trace: &mut Trace,
    ) -> Result<(), RowError> {
        let words = words.get_mut(..self.count).unwrap_or_default();
        source.put(self.of, words);
        // Compared one by one: the words were just written so, and a processor waits before it reads several of
        // them at once.
        let is_new = self.words.is_empty();
        self.words.resize(self.count, 0);
        for (at, column) in (self.first..).zip(&self.columns) {
            let (Some(&word), Some(before)) = (words.get(column.place), self.words.get_mut(column.place))
            else {
                continue;
            };
            if *before == word && !is_new {
                continue;
            }
            *before = word;
            if let Told::Pin(PinType::Lreal) = column.told {
                trace.set_next_real(at, f64::from_bits(word));
            } else {
                column.write(word, source, cells, (at, &mut *trace))?;
            }
        }
        Ok(())
    }

    /// Writes the cells of an axis that change while it only continues: the numbers of its motion.
    fn write_motion(&mut self, source: &Source<'_>, axis: usize, trace: &mut Trace) {
        let Some(axis) = source.machine.axes().get(axis) else {
            return;
        };
        let (of_setpoint, actual) = self.moved();
        for (at, number) in of_setpoint.iter().zip(axis.setpoint().numbers()) {
            if let Some(at) = at {
                trace.set_next_real(*at, number);
            }
        }
        if let Some(at) = actual {
            trace.set_next_real(*at, axis.actual_position());
        }
    }

    /// See [`Part::motion`]. The next whole row writes all cells of the part again.
    fn moved(&mut self) -> &([Option<usize>; 5], Option<usize>) {
        self.words.clear();
        &self.motion
    }

    /// The column in the trace of a word of the part.
    fn column(&self, word: usize) -> Option<usize> {
        let mut columns = self.columns.iter();
        let place = columns.position(|column| column.place == word)?;
        Some(self.first + place)
    }
}

impl Column {
    /// Writes the cell of a word that is no number of 64 bits.
    // Numbers are written separately: they change in nearly every scan, and their code then needs few registers.
    #[inline(never)]
    fn write(
        &self,
        word: u64,
        source: &Source<'_>,
        cells: &mut Cells,
        (at, trace): (usize, &mut Trace),
    ) -> Result<(), RowError> {
        match self.told {
            Told::State => trace.set_next(at, Cell::Name(state(word))),
            Told::Pin(ty) => {
                let value = ty.value(word);
                cells.prepare(ty, value);
                trace.set_next(at, cells.cell(ty, value))
            }
            Told::Symbol(program) => source.symbol(program, self.place, |cell| trace.set_next(at, cell)),
        }
    }
}

impl Source<'_> {
    /// Writes the words of a part to `words`.
    fn put(&self, of: Of, words: &mut [u64]) {
        match of {
            Of::Axis(index) => self.put_axis(index, words),
            Of::Variables => put_values(&self.values.variables, words),
            Of::Instance(index) => {
                if let Some(instance) = self.values.instances.get(index) {
                    instance.put_words(words);
                }
            }
            Of::Program(index) => put_values(self.symbols(index), words),
        }
    }

    fn put_axis(&self, index: usize, words: &mut [u64]) {
        let (Some(axis), Some(state)) = (self.machine.axes().get(index), self.states.get(index)) else {
            return;
        };
        write_axis(words, self.scan, *state, axis);
        let of_slave = words.get_mut(AXIS_WORDS..).unwrap_or_default();
        if of_slave.is_empty() {
            return;
        }
        let coupled = axis.coupled();
        let second = coupled.and_then(|coupled| coupled.second);
        let master = |master: Option<AxisId>| Value::Axis(master.unwrap_or(AxisId::NONE));
        let real = |value: Option<f64>| Value::Lreal(value.unwrap_or(0.0));
        let values: [Value; SLAVE_WORDS] = [
            master(coupled.map(|coupled| coupled.master)),
            real(coupled.map(|coupled| coupled.deviation)),
            real(coupled.map(|coupled| coupled.phase)),
            master(second.map(|(master, _)| master)),
            real(second.map(|(_, phase)| phase)),
            real(coupled.map(|coupled| coupled.superimposed)),
            real(coupled.and_then(|coupled| coupled.shadow)),
        ];
        put_values(&values, of_slave);
    }

    fn symbols(&self, program: usize) -> &[Value] {
        self.values.symbols.get(program).map_or(&[], Vec::as_slice)
    }

    /// Calls `take` with the cell of a symbol.
    fn symbol<T>(&self, program: usize, place: usize, take: impl FnOnce(Cell<'_>) -> T) -> T {
        let variable = self.script.variable(Point::Symbol(program, place));
        let value = self
            .symbols(program)
            .get(place)
            .copied()
            .unwrap_or(Value::Bool(false));
        match variable {
            None => take(Cells::default().cell(cells::type_of(value), value)),
            Some(variable) => match variable.cell(value) {
                Some(cell) => take(cell),
                // A number without a name in its enumeration; a correct program has none.
                None => take(Cell::Name(&variable.unnamed(value).unwrap_or_default())),
            },
        }
    }
}

fn put_values(values: &[Value], words: &mut [u64]) {
    for (word, value) in words.iter_mut().zip(values) {
        *word = value.word();
    }
}

/// The state at a place of [`AxisState::ALL`].
fn state(word: u64) -> &'static str {
    let state = usize::try_from(word).ok().and_then(|at| AxisState::ALL.get(at));
    state.map_or("", |state| state.name())
}

/// All parts of a script with all their columns, in the order of the trace.
fn parts(script: &Script) -> Vec<Part> {
    let mut all = Vec::new();
    for (index, axis) in script.axes.iter().enumerate() {
        let (real, name) = (Told::Pin(PinType::Lreal), Told::Pin(PinType::Axis("AXIS_REF")));
        let of_all = [(0, Told::State)]
            .into_iter()
            .chain((1..=6).map(|place| (place, real)));
        let of_slave = [(0, name), (1, real), (2, real)];
        let of_combined = [(3, name), (4, real)];
        let besides = of_slave
            .into_iter()
            .filter(|_| axis.masters > 0)
            .chain(of_combined.into_iter().filter(|_| axis.masters > 1))
            .chain(axis.superimposed.then_some((5, real)))
            .chain(axis.on_cam.then_some((6, real)))
            .map(|(place, told)| (AXIS_WORDS + place, told));
        let count = match besides.clone().next() {
            Some(_) => AXIS_WORDS + SLAVE_WORDS,
            None => AXIS_WORDS,
        };
        all.push(Part::new(Of::Axis(index), count, of_all.chain(besides)));
    }
    let variables = script.inputs.iter().map(|input| cells::type_of(input.initial));
    all.push(Part::of_each(Of::Variables, variables.map(Told::Pin)));
    for (index, instance) in script.blocks.iter().enumerate() {
        let pins = instance.block.pins().map(|pin| Told::Pin(pin.ty));
        all.push(Part::of_each(Of::Instance(index), pins));
    }
    for (index, program) in script.programs.iter().enumerate() {
        let symbols = program.symbols.iter().map(|_| Told::Symbol(index));
        all.push(Part::of_each(Of::Program(index), symbols));
    }
    all
}

impl Part {
    fn new(of: Of, count: usize, columns: impl Iterator<Item = (usize, Told)>) -> Self {
        let columns = columns.map(|(place, told)| Column { place, told }).collect();
        Self {
            of,
            columns,
            first: 0,
            count,
            words: Vec::new(),
            moves: matches!(of, Of::Axis(_)),
            motion: ([None; 5], None),
        }
    }

    /// It has a column for each of its words.
    fn of_each(of: Of, told: impl Iterator<Item = Told>) -> Self {
        let mut part = Self::new(of, 0, (0..).zip(told));
        part.count = part.columns.len();
        part
    }
}

//! The script's side of a scan: steps at the latch, blocks behind their wires, a row at the end.

use super::RunError;
use super::cams::Cams;
use super::cells;
use super::drive::ScriptDrive;
use super::formulas::{self, Formulas, Reading, Truths};
use super::guests::Guests;
use super::kept::Kept;
use super::layout::Layout;
use super::notes::{self, Notes};
use super::rest::Rest;
use super::row::{RowWriter, Source};
use super::rows::{ROWS_KEPT, Rows, Shift};
use super::schedule::Schedule;
use super::values::Values;
use super::witness::Witness;
use crate::model::{Action, AxisNumber, FaultKind, FormulaInput, Point, Script, Signal, Wire};
use standstill_axis::{Axis, AxisId, AxisState, ErrorId, InstanceId, Standard};
use standstill_fb::{Context, Value};
use standstill_scan::{Machine, ProgramFault, ProgramId, Programs, RUNTIME, ScanTime, TaskId};
use standstill_trace::{Note, RowError, Trace};
use std::sync::Arc;

/// The machine of a script: Standard planners over simulated drives.
pub(crate) type ScriptMachine = Machine<Standard, ScriptDrive>;

/// The number of an instance in records; 0 belongs to no instance and means the host.
pub(crate) fn instance_id(index: usize) -> InstanceId {
    u16::try_from(index + 1).map_or(RUNTIME, InstanceId)
}

/// The axes and drives of a script in their state before the first scan.
pub(crate) fn machine(script: &Script) -> Result<ScriptMachine, RunError> {
    let mut machine = Machine::new();
    machine.tables_mut().clone_from(&script.tables);
    // No other block puts a cam there.
    let selects = script
        .blocks
        .iter()
        .any(|instance| instance.block.name == "MC_CamTableSelect");
    if selects || !script.programs.is_empty() {
        machine.set_cam_store(script.cams.0, script.cams.1);
    }
    let planner = Standard::new(script.cycle_ns as f64 / 1e9);
    for axis in &script.axes {
        let drive =
            ScriptDrive::new(&axis.drive, &axis.config, script.cycle_ns).map_err(|error| RunError::Axis {
                axis: axis.name.clone(),
                reason: error.to_string(),
            })?;
        machine
            .add_axis(axis.config, planner, drive)
            .map_err(|error| RunError::Axis {
                axis: axis.name.clone(),
                reason: error.to_string(),
            })?;
    }
    Ok(machine)
}

/// Makes an axis or its drive fail.
fn fail(axis: usize, kind: FaultKind, code: u16, time: ScanTime, machine: &mut ScriptMachine) {
    let drive = machine.drives_mut().get_mut(axis);
    match (kind, drive) {
        (FaultKind::Drive, Some(drive)) => drive.simulated.fail(code),
        (FaultKind::Power, Some(drive)) => drive.simulated.cut_power(),
        (FaultKind::Communication, Some(drive)) => drive.simulated.cut_communication(),
        (FaultKind::Axis, _) => {
            let mut context = machine.context(time, InstanceId::default());
            let id = u16::try_from(axis).map_or(AxisId::NONE, AxisId::new);
            if let Ok((axis, scope)) = context.axis(id) {
                axis.raise(ErrorId::AxisFault, code, scope);
            }
        }
        (FaultKind::Drive | FaultKind::Power | FaultKind::Communication, None) => {}
    }
}

/// The instances of a task, and its calls of guest programs: the program, and the number of the call.
type OfTask = (Vec<usize>, Vec<(usize, usize)>);

/// The instances and calls of each task; the last entry is for those without a task.
fn by_task(script: &Script) -> Vec<OfTask> {
    let mut tasks = vec![(Vec::new(), Vec::new()); script.tasks.len() + 1];
    let called = script.blocks.iter().enumerate();
    for (index, instance) in called.filter(|(_, instance)| !instance.left_out) {
        if let Some((blocks, _)) = tasks.get_mut(instance.task) {
            blocks.push(index);
        }
    }
    for (index, program) in script.programs.iter().enumerate() {
        for (place, call) in program.calls.iter().enumerate() {
            let task = call.task.unwrap_or(script.tasks.len());
            if let Some((_, guests)) = tasks.get_mut(task) {
                guests.push((index, place));
            }
        }
    }
    tasks
}

/// The reason why the resource stops if an expression fails.
const WIRE_FAULT: &str = "an expression in a wire has no value";

/// The values of an axis that expressions read.
fn reading(axis: &Axis<Standard>) -> Reading {
    Reading {
        state: axis.state(),
        setpoint: axis.setpoint(),
        actual: axis.actual_position(),
        coupled: axis.coupled(),
    }
}

/// A script that is running.
pub(crate) struct Bench<'a> {
    script: &'a Script,
    layout: Arc<Layout>,
    pub(super) values: Values,
    /// The instances and calls of each task, then those without one, in file order.
    tasks: Vec<OfTask>,
    writer: RowWriter,
    schedule: Schedule,
    /// Whether the programs are idle; none if they may do something new in any scan.
    rest: Option<Rest>,
    /// An event occurred that could not be foreseen, while the programs were assumed to be idle.
    pub(super) rest_broken: bool,
    /// Axis states after all blocks were called, before the motion step.
    states: Vec<AxisState>,
    notes: Notes,
    pub(super) guests: Guests,
    formulas: Formulas,
    truths: Truths,
    /// The values of the axes that expressions in a task's wire read: those latched.
    readings: Vec<Reading>,
    /// The current scan.
    time: ScanTime,
    pub(super) trace: Trace,
    /// The columns of a whole trace.
    columns: usize,
    /// The shifts of coordinates, for differences of positions.
    shifts: Vec<Shift>,
    /// The positions of the cams that axes are on.
    cams: Cams,
    /// The values that the next latch writes after its steps.
    pub(super) changes: Vec<(Point, Value)>,
    /// The faults that the next latch raises or clears after its steps.
    faults: Vec<Action>,
    /// Last scan of the run, once `stop_when` has held.
    last_scan: Option<u64>,
    /// An expression in a wire had no value.
    wire_fault: bool,
    /// The reason why the run ended early. The executor's hooks return nothing, so it is stored here.
    error: Option<RunError>,
}

impl<'a> Bench<'a> {
    pub(crate) fn new(script: &'a Script, kept: Kept) -> Result<Self, RunError> {
        let mut values = Values::new(script)
            .ok_or_else(|| RunError::Internal("the script was not checked before its run".to_owned()))?;
        let guests = Guests::new(script)?;
        values.symbols = guests.values(script)?;
        let rest = Rest::new(script);
        let Kept {
            layout,
            mut writer,
            trace,
            all: columns,
        } = kept;
        writer.mind(rest.as_ref().map_or(&[], Rest::readers));
        Ok(Self {
            script,
            writer,
            rest,
            rest_broken: false,
            layout,
            guests,
            formulas: Formulas::new(script)?,
            truths: Truths::new(script),
            readings: Vec::with_capacity(script.axes.len()),
            time: ScanTime { scan: 0, now_ns: 0 },
            values,
            tasks: by_task(script),
            schedule: Schedule::new(script),
            states: Vec::with_capacity(script.axes.len()),
            notes: Notes::new(script),
            trace,
            columns,
            shifts: Vec::new(),
            cams: Cams::new(script),
            changes: Vec::new(),
            faults: Vec::new(),
            last_scan: None,
            wire_fault: false,
            error: None,
        })
    }

    /// Returns the error of the last scan.
    pub(crate) fn check(&mut self) -> Result<(), RunError> {
        self.error.take().map_or(Ok(()), Err)
    }

    /// Whether a guest program, or an expression in a wire, has had a fault.
    pub(crate) fn has_fault(&self) -> bool {
        self.guests.has_fault() || self.wire_fault
    }

    /// The values of the expressions that a wire reads now.
    fn compute(
        &mut self,
        wire: &Wire,
        time: ScanTime,
        reading: &dyn Fn(usize) -> Option<Reading>,
    ) -> Result<(), ProgramFault> {
        for point in wire.points() {
            let Point::Formula(index) = *point else { continue };
            let (script, values) = (self.script, &self.values);
            let source = |input: &FormulaInput| match input.signal {
                Signal::Point(point) => {
                    let value = values.read(point)?;
                    let whole = script.variable(point).and_then(|variable| variable.whole(value));
                    Some(formulas::of_value(input, value, whole))
                }
                Signal::State(axis) | Signal::Axis(axis, _) => formulas::of_reading(input, &reading(axis)?),
                Signal::Master(..) | Signal::Difference(..) | Signal::Formula(_) => None,
            };
            let outcome = self
                .formulas
                .value(script, index, (time.scan, time.now_ns), source);
            let place = self.values.formulas.get_mut(index);
            match (outcome, place) {
                (Ok(value), Some(place)) => *place = Some(value),
                (outcome, _) => {
                    let why = outcome.err().unwrap_or_default();
                    self.truths.fault(index, time.scan, why);
                    self.wire_fault = true;
                    return Err(ProgramFault { reason: WIRE_FAULT });
                }
            }
        }
        Ok(())
    }

    /// Whether `scan` is the last one.
    pub(crate) fn is_over(&self, scan: u64) -> bool {
        self.last_scan.is_some_and(|last| scan >= last)
    }

    /// The rows so far.
    pub(crate) fn rows(&self) -> Rows<'_> {
        Rows {
            script: self.script,
            layout: &self.layout,
            trace: &self.trace,
            shifts: &self.shifts,
            truths: &self.truths,
        }
    }

    /// Makes an axis or its drive fail at the next latch, after its steps. Without a fault it removes the cause.
    pub(crate) fn fail(&mut self, axis: usize, fault: Option<(FaultKind, u16)>) {
        self.faults.push(match fault {
            Some((kind, code)) => Action::Fault { axis, kind, code },
            None => Action::Clear { axis },
        });
    }

    /// The data for judging claims.
    pub(crate) fn into_rows(self) -> (Trace, Vec<Shift>, Truths) {
        (self.trace, self.shifts, self.truths)
    }

    /// The data that the run keeps of its rows.
    pub(crate) fn into_kept(self) -> Kept {
        Kept {
            layout: self.layout,
            writer: self.writer,
            trace: self.trace,
            all: self.columns,
        }
    }

    /// Drops all rows except the last few, with their data.
    pub(crate) fn forget(&mut self) {
        self.trace.forget(ROWS_KEPT);
        let first = self.trace.first() as u64;
        self.truths.forget(first);
        let old = self.shifts.partition_point(|shift| shift.scan < first);
        self.shifts.drain(..old);
    }

    /// Number of scans after the last one, `scan`, in which the programs would be idle, as far as is known.
    pub(crate) fn rests_after(&mut self, scan: u64, machine: &ScriptMachine) -> u64 {
        let Some(rest) = &mut self.rest else { return 0 };
        let is_disturbed = !self.faults.is_empty() || !self.changes.is_empty();
        if is_disturbed || !rest.begins(scan, &self.values, machine) {
            return 0;
        }
        let left = self.last_scan.map_or(u64::MAX, |last| last.saturating_sub(scan));
        self.schedule.free_from(scan + 1).min(left)
    }

    /// Counts scans that were done without the programs.
    pub(crate) fn went_on(&mut self, scans: u64) {
        if let Some(rest) = &mut self.rest {
            rest.went_on(scans);
        }
    }

    /// Whether all axes are at rest and have no command to process.
    pub(crate) fn is_still(&self) -> bool {
        self.rest.as_ref().is_some_and(Rest::is_still)
    }

    /// Number of the next scans that the axes can do alone, without their drives.
    pub(crate) fn moves_alone(&self, machine: &ScriptMachine) -> u64 {
        let shown = (0..self.script.axes.len()).any(|axis| {
            let column = self.layout.number(axis, AxisNumber::ActualPosition);
            column.is_some()
        });
        let is_watched = self.schedule.watches() || self.script.stop_when.is_some();
        match &self.rest {
            Some(rest) if !shown && !is_watched => rest.moves_alone(machine),
            _ => 0,
        }
    }

    /// Advances the axes alone for `scans` scans; `first` is the first of them.
    pub(crate) fn go_along(&mut self, scans: u64, first: ScanTime, machine: &mut ScriptMachine) {
        let scans = usize::try_from(scans).unwrap_or_default();
        self.writer.write_along(scans, first, machine, &mut self.trace);
        // The reports of drives for another scan cannot be corrected.
        self.rest_broken |= !self.rest.as_ref().is_some_and(|rest| rest.lasts(machine));
    }

    /// Adds a note at the last scan.
    pub(crate) fn tell(&mut self, subject: &str, text: &str) {
        self.trace.push_note(Note {
            scan: self.trace.scans().saturating_sub(1),
            subject: subject.to_owned(),
            text: text.to_owned(),
        });
    }

    /// Ends the run after this scan; the first reason counts.
    fn stop(&mut self, error: RunError) {
        self.error.get_or_insert(error);
    }

    fn apply(&mut self, step: usize, action: &Action, time: ScanTime, machine: &mut ScriptMachine) {
        let scan = time.scan;
        match *action {
            Action::Set(point, value) => self.write(point, Some(value), scan),
            Action::Fault { axis, kind, code } => fail(axis, kind, code, time, machine),
            Action::Clear { axis } => {
                if let Some(drive) = machine.drives_mut().get_mut(axis) {
                    drive.simulated.clear_cause();
                }
                if let Some(axis) = machine.axes_mut().get_mut(axis) {
                    axis.clear_cause();
                }
            }
            Action::Drive { axis, change } => {
                let drive = machine.drives_mut().get_mut(axis);
                if drive.is_some_and(|drive| drive.simulated.change(change).is_err()) {
                    let axis = self.script.axes.get(axis);
                    let axis = axis.map_or_else(String::new, |axis| axis.name.clone());
                    self.stop(RunError::Displaced { step, scan, axis });
                }
            }
        }
    }

    /// Writes the row of a scan by `write`.
    fn write_row(
        &mut self,
        scan: u64,
        machine: &ScriptMachine,
        write: impl FnOnce(&mut RowWriter, &Source<'_>, &mut Trace) -> Result<(), RowError>,
    ) {
        let source = Source {
            script: self.script,
            values: &self.values,
            machine,
            states: &self.states,
            scan,
        };
        if let Err(error) = write(&mut self.writer, &source, &mut self.trace) {
            self.stop(RunError::Internal(error.to_string()));
        }
    }

    /// Evaluates what expressions, steps and the end of the run need from the row of a scan.
    fn watch_row(&mut self, scan: u64) {
        let script = self.script;
        if script.formulas.is_empty() && script.stop_when.is_none() && !self.schedule.watches() {
            return;
        }
        let mut truths = std::mem::take(&mut self.truths);
        let rows = Rows {
            script,
            layout: &self.layout,
            trace: &self.trace,
            shifts: &self.shifts,
            // Expressions do not read each other.
            truths: &Truths::default(),
        };
        self.formulas.look(&rows, scan, &mut truths);
        let rows = Rows {
            truths: &truths,
            ..rows
        };
        self.schedule.look(&rows, scan);
        if self.schedule.is_full() {
            self.error.get_or_insert(RunError::Pending { scan });
        }
        if self.last_scan.is_none()
            && let Some((conditions, after)) = &script.stop_when
            && rows.hold(conditions, scan)
        {
            self.last_scan = Some(scan.saturating_add(*after));
        }
        self.truths = truths;
    }

    /// Calls the instances of a task and its guest programs before a witness, if there is one.
    pub(super) fn run_before(
        &mut self,
        program: ProgramId,
        context: &mut Context<'_, Standard>,
        mut witness: Option<&mut dyn Witness>,
    ) -> Result<u64, ProgramFault> {
        let script = self.script;
        let ProgramId(task) = program;
        if self.wire_fault {
            return Err(ProgramFault { reason: WIRE_FAULT });
        }
        self.notes.collect(context.scope.log);
        if let Some(witness) = &mut witness {
            witness.begins(context.scope.scan, context.axes);
        }
        for place in 0.. {
            let index = self.tasks.get(task).and_then(|(blocks, _)| blocks.get(place));
            let Some((index, declared)) = index.and_then(|&index| Some((index, script.blocks.get(index)?)))
            else {
                break;
            };
            let time = ScanTime {
                scan: context.scope.scan,
                now_ns: context.now_ns,
            };
            let axes = &*context.axes;
            for (_, wire) in &declared.wires {
                self.compute(wire, time, &|axis| Some(reading(axes.get(axis)?)))?;
            }
            self.feed(index, &declared.wires, context.scope.scan);
            context.scope.instance = instance_id(index);
            if let Some(instance) = self.values.instances.get_mut(index) {
                if let Some(witness) = &mut witness {
                    witness.before(index, context);
                }
                instance.call(context);
                if let Some(witness) = &mut witness {
                    witness.after(index, instance, context);
                }
                self.notes.collect(context.scope.log);
            }
        }
        let guests = self.tasks.get(task).map(|(_, guests)| guests.as_slice());
        for &(index, call) in guests.unwrap_or_default() {
            let outcome = self.guests.scan(index, call, context);
            if let Some(values) = self.values.symbols.get_mut(index) {
                self.guests.refresh(index, values);
            }
            self.notes.collect(context.scope.log);
            outcome.map_err(|reason| ProgramFault { reason })?;
        }
        Ok(0)
    }

    /// Writes the wired inputs of an instance, in pin order.
    fn feed(&mut self, instance: usize, wires: &[(usize, Wire)], scan: u64) {
        for (pin, wire) in wires {
            let value = self.values.wire(wire);
            self.write(Point::Pin(instance, *pin), value, scan);
        }
    }

    /// Writes a value to its point; a value that does not fit ends the run.
    fn write(&mut self, point: Point, value: Option<Value>, scan: u64) {
        if value.and_then(|value| self.values.write(point, value)).is_none() {
            let value = value.map_or_else(
                || "what its wire carries".to_owned(),
                |value| cells::value_text(self.script, None, value),
            );
            self.stop(RunError::Value {
                scan,
                target: cells::point_name(self.script, point),
                value,
            });
        } else if let Point::Symbol(program, symbol) = point
            && let Some(value) = self.values.read(point)
        {
            self.guests.write(program, symbol, value);
        }
    }
}

impl Programs<Standard, ScriptDrive> for Bench<'_> {
    fn latch(&mut self, time: ScanTime, machine: &mut ScriptMachine) {
        let script = self.script;
        if let Some(rest) = &mut self.rest {
            let is_due = self.schedule.free_from(time.scan) == 0;
            rest.begin(
                machine,
                is_due || !self.faults.is_empty() || !self.changes.is_empty(),
            );
        }
        self.cams.look(machine, &mut self.trace);
        while let Some(index) = self.schedule.take(time.scan) {
            let actions = script.steps.get(index).map_or(&[][..], |step| &step.actions);
            for action in actions {
                self.apply(index, action, time, machine);
                self.notes.collect(machine.log());
            }
        }
        for action in std::mem::take(&mut self.faults) {
            self.apply(script.steps.len(), &action, time, machine);
            self.notes.collect(machine.log());
        }
        for (point, value) in std::mem::take(&mut self.changes) {
            self.write(point, Some(value), time.scan);
        }
        self.time = time;
        // No other code uses them.
        if script.tasks.iter().any(|task| task.single.is_some()) {
            self.readings.clear();
            self.readings.extend(machine.axes().iter().map(reading));
        }
    }

    fn single(&mut self, task: TaskId) -> bool {
        let script = self.script;
        let Some(single) = script.tasks.get(task.0).and_then(|task| task.single.as_ref()) else {
            return false;
        };
        let readings = std::mem::take(&mut self.readings);
        let computed = self.compute(single, self.time, &|axis| readings.get(axis).copied());
        self.readings = readings;
        // A fault here stops the resource at the next program that runs.
        computed.is_ok() && self.values.wire_bool(single).unwrap_or(false)
    }

    fn run(&mut self, program: ProgramId, context: &mut Context<'_, Standard>) -> Result<u64, ProgramFault> {
        self.run_before(program, context, None)
    }

    fn observe(&mut self, _time: ScanTime, machine: &ScriptMachine) {
        self.notes.collect(machine.log());
        self.states.clear();
        self.states.extend(machine.axes().iter().map(|axis| axis.state()));
        if let Some(rest) = &mut self.rest {
            rest.called(machine);
        }
    }

    fn idle(&mut self, time: ScanTime, machine: &mut ScriptMachine) {
        self.time = time;
        let Some(rest) = &self.rest else { return };
        for &index in rest.readers() {
            let mut context = machine.context(time, instance_id(index));
            if let Some(instance) = self.values.instances.get_mut(index) {
                instance.call(&mut context);
            }
        }
    }

    fn idled(&mut self, time: ScanTime, machine: &ScriptMachine) -> bool {
        self.write_row(time.scan, machine, RowWriter::write_resting);
        self.watch_row(time.scan);
        let lasts = self.rest.as_ref().is_some_and(|rest| rest.lasts(machine));
        let is_broken = |rest: &Rest| rest.is_broken(machine);
        self.rest_broken |= !lasts && self.rest.as_ref().is_none_or(is_broken);
        let is_awaited = self.schedule.free_from(time.scan + 1) == 0 || self.is_over(time.scan);
        lasts && !is_awaited && self.error.is_none()
    }

    fn published(&mut self, time: ScanTime, machine: &ScriptMachine) {
        self.write_row(time.scan, machine, RowWriter::write);
        self.guests
            .take_told(self.script, &mut self.notes, &mut self.trace);
        let scan = self.trace.scans().saturating_sub(1);
        self.shifts.extend(notes::shifts_of(machine, scan));
        if self.layout.has_all() {
            self.notes.take(machine, &mut self.trace);
        } else {
            // A trace without blocks has no notes on them either.
            self.notes.drop_all();
        }
        self.watch_row(time.scan);
    }
}

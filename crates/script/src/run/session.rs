//! A run that advances scan by scan, and whose inputs may be changed on the way.

use super::bench::{self, Bench, ScriptMachine};
use super::cells;
use super::drive::Ordered;
use super::kept::Kept;
use super::witness::{Witness, Witnessed};
use super::{Outcome, RunError, executor, told};
use crate::CELLS_MAX;
use crate::claims::{self, Judges, Standing, Standings, Verdict};
use crate::model::{FaultKind, Point, Script};
use crate::read::time;
use crate::why;
use standstill_axis::{Axis, Standard};
use standstill_fb::{Direction, PinType, Value};
use standstill_scan::{Executor, ScanReport, ScanTime, TimeRanBackwards};
use standstill_trace::{Trace, shortest};

/// Whether a trace with this many columns can hold the rows of a script.
fn fits(script: &Script, columns: usize) -> Result<(), RunError> {
    let scans = script.scans;
    if scans.saturating_mul(columns as u64) > CELLS_MAX {
        return Err(RunError::TooLarge { scans, columns });
    }
    Ok(())
}

/// Number of scans with the same commands, beyond the delay of the drives, after which neither an axis nor a drive
/// depends on earlier ones.
const REMEMBERED: u64 = 6;

/// A run of a script that advances on request.
pub struct Session<'a> {
    script: &'a Script,
    machine: ScriptMachine,
    executor: Executor,
    bench: Bench<'a>,
    /// Scans done.
    scans: u64,
    /// The last scans in which nothing moved.
    still: u64,
    over: bool,
    /// Programs no longer run; the axes stop and switch off.
    stopping: bool,
    changes: Vec<Change>,
    standings: Standings,
    judges: Judges<'a>,
}

/// A value that was written from outside, as a step of the script would.
#[derive(Clone, Debug, PartialEq)]
pub struct Change {
    /// The scan whose latch wrote it.
    pub scan: u64,
    /// The variable or pin.
    pub point: Point,
    /// Its name in scripts.
    pub name: String,
    /// The value in the JSON form of scripts.
    pub json: String,
}

/// The progress of [`Session::advance_far`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ahead {
    /// Number of scans done.
    Scans(u64),
    /// The run cannot continue: its last rows are incomplete.
    Broken,
}

impl<'a> Session<'a> {
    /// A run before its first scan.
    ///
    /// # Errors
    /// [`RunError`]: the script cannot be set up, or its rows are more than fit into one trace.
    pub fn new(script: &'a Script) -> Result<Self, RunError> {
        let session = Self::long(script)?;
        fits(script, session.trace().columns().len())?;
        Ok(session)
    }

    /// The same as [`Session::new`], for one of many runs of a script with other values of its parameters. `kept`,
    /// from any of these runs, gives the columns of the trace. [`Session::into_kept`] returns it for the next run.
    ///
    /// # Errors
    /// Those of [`Session::new`].
    pub fn keeping(script: &'a Script, mut kept: Kept) -> Result<Self, RunError> {
        let columns = kept.all;
        kept.describe(script);
        let session = Self::with(script, kept)?;
        fits(script, columns)?;
        Ok(session)
    }

    /// The value that [`Session::keeping`] received, for another run. The rows of this run are dropped, and their
    /// memory is kept.
    #[must_use]
    pub fn into_kept(self) -> Kept {
        self.bench.into_kept().cleared()
    }

    /// The same as [`Session::new`], for a run of any length whose rows are read on the way and then dropped by
    /// [`Session::forget`].
    ///
    /// # Errors
    /// [`RunError`]: the script cannot be set up.
    pub fn long(script: &'a Script) -> Result<Self, RunError> {
        Self::with(script, Kept::all(script))
    }

    /// The same as [`Session::long`], with only the columns that claims and steps read: for a run of which nobody
    /// reads the rows.
    ///
    /// # Errors
    /// Those of [`Session::long`].
    pub fn without_rows(script: &'a Script) -> Result<Self, RunError> {
        Self::with(script, Kept::read(script, &[]))
    }

    fn with(script: &'a Script, kept: Kept) -> Result<Self, RunError> {
        Ok(Self {
            script,
            machine: bench::machine(script)?,
            executor: executor(script)?,
            bench: Bench::new(script, kept)?,
            scans: 0,
            still: 0,
            over: script.scans == 0,
            stopping: false,
            changes: Vec::new(),
            standings: Standings::new(script),
            judges: Judges::new(script),
        })
    }

    /// Judges the claims on the rows so far, then drops all but the last few. From then on the state of claims
    /// during the run ([`Session::standings`]) is not known. Their verdicts at the end are.
    pub fn forget(&mut self) {
        self.judges.look(&self.bench.rows());
        self.bench.forget();
    }

    /// Runs the next scan. Returns FALSE if the run was over before.
    ///
    /// # Errors
    /// [`RunError`]; the run is over then.
    pub fn advance(&mut self) -> Result<bool, RunError> {
        self.advance_by(|executor, now_ns, bench, machine| executor.scan(now_ns, bench, machine))
    }

    /// The same as [`Session::advance`]; `witness` sees every call.
    ///
    /// # Errors
    /// Those of [`Session::advance`].
    pub fn advance_before(&mut self, witness: &mut dyn Witness) -> Result<bool, RunError> {
        self.advance_by(|executor, now_ns, bench, machine| {
            executor.scan(now_ns, &mut Witnessed { bench, witness }, machine)
        })
    }

    /// Runs the next scan by `scan`.
    fn advance_by(
        &mut self,
        scan_by: impl FnOnce(
            &mut Executor,
            i64,
            &mut Bench<'a>,
            &mut ScriptMachine,
        ) -> Result<ScanReport, TimeRanBackwards>,
    ) -> Result<bool, RunError> {
        if self.over {
            return Ok(false);
        }
        // If this scan ends early, the run ends.
        self.over = true;
        let scan = self.scans;
        let columns = self.trace().columns().len();
        // The script's own scans were checked; those of a stop are additional.
        if self.stopping && (scan + 1).saturating_mul(columns as u64) > CELLS_MAX {
            return Err(RunError::TooLarge {
                scans: scan + 1,
                columns,
            });
        }
        let now_ns = self.now_ns();
        let report = scan_by(&mut self.executor, now_ns, &mut self.bench, &mut self.machine)
            .map_err(|error| RunError::Internal(error.to_string()))?;
        self.bench.check()?;
        // A guest that faults has stopped the resource: the run continues while its axes ramp down.
        if let Some(&fault) = report.mode.fault()
            && !self.bench.has_fault()
        {
            return Err(RunError::Internal(self.executor.describe(fault).to_string()));
        }
        self.scans = scan + 1;
        self.over = if self.stopping {
            self.machine.is_off().is_ok()
        } else {
            self.bench.is_over(scan) || self.scans >= self.script.scans
        };
        Ok(true)
    }

    /// The time of the next scan (ns).
    fn now_ns(&self) -> i64 {
        self.script.cycle_ns.saturating_mul(self.scans.cast_signed())
    }

    /// Runs the next scan, and at once the following ones in which the programs would do nothing new, at most
    /// `most` scans in all. The rows are the same as with [`Session::advance`]. Returns the number of scans; 0 if
    /// the run was over before.
    ///
    /// # Errors
    /// [`RunError`]; the run is over then. With [`Ahead::Broken`] an event occurred that only a run by
    /// [`Session::advance`] shows.
    pub fn advance_far(&mut self, most: u64) -> Result<Ahead, RunError> {
        if !self.advance()? {
            return Ok(Ahead::Scans(0));
        }
        let left = self
            .script
            .scans
            .saturating_sub(self.scans)
            .min(most.saturating_sub(1));
        if self.over || self.stopping || left == 0 {
            return Ok(Ahead::Scans(1));
        }
        let rests = self.bench.rests_after(self.scans - 1, &self.machine).min(left);
        let done = self.go_on(rests);
        self.bench.check()?;
        self.bench.went_on(done);
        self.scans += done;
        self.over = self.bench.is_over(self.scans - 1) || self.scans >= self.script.scans;
        if self.bench.rest_broken {
            self.over = true;
            return Ok(Ahead::Broken);
        }
        Ok(Ahead::Scans(done + 1))
    }

    /// Does the next scans, in which the programs are idle. Returns their number: all of them, unless the programs
    /// stop being idle before, or do not run in every tick.
    fn go_on(&mut self, scans: u64) -> u64 {
        let mut drives = self.machine.drives().iter();
        let delay = drives.try_fold(0, |most, drive| Some(drive.delay()?.max(most)));
        let settles_in = delay.map(|delay| delay as u64 + REMEMBERED);
        match settles_in {
            Some(settles_in) if scans > 0 && self.bench.is_still() => self.stand(scans, settles_in),
            Some(settles_in) => {
                self.still = 0;
                self.move_on(scans, settles_in)
            }
            None => {
                self.still = 0;
                self.coast(scans)
            }
        }
    }

    fn coast(&mut self, scans: u64) -> u64 {
        self.executor.coast(scans, &mut self.bench, &mut self.machine)
    }

    /// The same if all axes are at rest, with drives that settle after `settles_in` scans.
    fn stand(&mut self, scans: u64, settles_in: u64) -> u64 {
        let settling = settles_in.saturating_sub(self.still).min(scans);
        let done = self.coast(settling);
        self.still += done;
        if done < settling {
            return done;
        }
        let stood = self.executor.stand(scans - done);
        // Rows that are equal to the last one.
        let rows = usize::try_from(stood).unwrap_or_default();
        self.bench.trace.push_next(rows);
        done + stood
    }

    /// The same if axes move: without drives, as long as enough scans are left for the drives to settle.
    fn move_on(&mut self, scans: u64, settles_in: u64) -> u64 {
        let alone = self.bench.moves_alone(&self.machine).min(scans);
        let first = ScanTime {
            scan: self.scans,
            now_ns: self.now_ns(),
        };
        let done = self.executor.stand(alone.saturating_sub(settles_in));
        if done > 0 {
            self.bench.go_along(done, first, &mut self.machine);
        }
        done + self.coast(scans - done)
    }

    /// Reserves memory for the rows of the whole run, so that scans do not allocate for them: at most [`CELLS_MAX`]
    /// cells of at most 8 bytes.
    pub fn reserve(&mut self) {
        let left = self.script.scans.saturating_sub(self.scans);
        let rows = usize::try_from(left).unwrap_or_default();
        self.bench.trace.reserve(rows);
    }

    /// Call it between two scans of a paced run: it does postponed work of the trace in small parts, so that no
    /// scan has much of it. Cost: at most as many cells as the trace has columns.
    pub fn keep_up(&mut self) {
        self.bench.trace.keep_up();
    }

    /// Stops the programs for good: from the next scan on none is called, and every axis stops and
    /// switches off in its configured way. [`Session::advance`] then continues until all are off, even
    /// past the script's own end. Its steps still apply, because drives still need them. `reason` becomes
    /// a note at the last scan. No effect on a run that is over or already stops.
    pub fn stop(&mut self, reason: &str) {
        if self.over || self.stopping {
            return;
        }
        self.stopping = true;
        self.bench.tell("run", reason);
        self.executor.stop(&mut self.bench, &mut self.machine);
        self.over = self.machine.is_off().is_ok();
    }

    /// The first axis that is neither Disabled nor at rest in ErrorStop, and its state.
    #[must_use]
    pub fn not_off(&self) -> Option<(&str, &'static str)> {
        let on = self.machine.is_off().err()?;
        let axis = self.script.axes.get(on.axis.index())?;
        Some((&axis.name, on.state.name()))
    }

    /// All variables of a program in Structured Text as they are now, at most 2000; none for another
    /// program. Cost: linear in their number.
    #[must_use]
    pub fn variables(&self, program: usize) -> Vec<super::Shown> {
        self.bench.guests.variables(self.script, program)
    }

    /// The execution counts of statements of Structured Text, if the script was read with counting. Cost:
    /// linear in the statements.
    #[must_use]
    pub fn counted(&self) -> Vec<super::Counted> {
        self.bench.guests.counted(self.script)
    }

    /// Scans done so far.
    #[must_use]
    pub const fn scans(&self) -> u64 {
        self.scans
    }

    /// Whether the run has ended.
    #[must_use]
    pub const fn is_over(&self) -> bool {
        self.over
    }

    /// The script.
    #[must_use]
    pub const fn script(&self) -> &'a Script {
        self.script
    }

    /// The rows so far; [`Session::finish`] adds the verdicts of claims.
    #[must_use]
    pub fn trace(&self) -> &Trace {
        &self.bench.trace
    }

    /// The state of every claim, in file order. Cost: proportional to the scans since the last call; at
    /// the end of the run that of judging.
    pub fn standings(&mut self) -> &[Standing] {
        self.standings.look(&self.bench.rows(), self.over)
    }

    /// The axes, in the order of the script.
    #[must_use]
    pub fn axes(&self) -> &[Axis<Standard>] {
        self.machine.axes()
    }

    /// The value at a point.
    #[must_use]
    pub fn value(&self, point: Point) -> Option<Value> {
        self.bench.values.read(point)
    }

    /// The value at a point in the form of a trace; a TIME as a literal.
    #[must_use]
    pub fn text(&self, point: Point) -> Option<String> {
        let value = self.value(point)?;
        Some(match (self.script.variable(point), value) {
            (Some(variable), _) if variable.is_wide() => variable.text(value),
            (_, Value::Time(ns)) => time::literal(ns),
            (Some(variable), _) => variable.text(value),
            (None, _) => cells::value_text(self.script, self.script.type_of(point), value),
        })
    }

    /// The text of every claim, in file order.
    #[must_use]
    pub fn claims(&self) -> Vec<String> {
        claims::say(&self.bench.rows())
    }

    /// Writes a value, given as text, at the latch of the next scan, after the steps of the script. Values have the
    /// form of scripts: `TRUE`, numbers, `T#5ms`, names of enums.
    ///
    /// # Errors
    /// The reason why it cannot be written there, for people.
    pub fn change(&mut self, point: Point, text: &str) -> Result<(), String> {
        let change = self.checked(point, text)?;
        self.enter(change);
        Ok(())
    }

    /// Writes all of these as [`Session::change`] does, or none if one of them cannot be written.
    ///
    /// # Errors
    /// Those of [`Session::change`], for the first one.
    pub fn change_all(&mut self, changes: &[(Point, String)]) -> Result<(), String> {
        let checked = changes.iter().map(|(point, text)| self.checked(*point, text));
        let checked: Vec<(Value, Change)> = checked.collect::<Result<_, _>>()?;
        checked.into_iter().for_each(|change| self.enter(change));
        Ok(())
    }

    fn enter(&mut self, (value, change): (Value, Change)) {
        self.bench.changes.push((change.point, value));
        self.changes.push(change);
    }

    /// A value that can be written at a point, given as text.
    fn checked(&self, point: Point, text: &str) -> Result<(Value, Change), String> {
        let name = cells::point_name(self.script, point);
        if self.over {
            return Err("the run is over".to_owned());
        }
        let (value, json) = self
            .parse(point, text.trim())
            .map_err(|why| format!("{name}: {why}"))?;
        if let Some(symbol) = self.script.symbol(point)
            && symbol.variable.is_none()
            && !symbol.own.holds(value)
        {
            let ty = symbol.own.iec_name();
            return Err(format!("{name}: a {ty} does not hold `{}`", text.trim()));
        }
        let change = Change {
            scan: self.scans,
            point,
            name,
            json,
        };
        Ok((value, change))
    }

    /// The reason why a point cannot be written; `None` if it can.
    #[must_use]
    pub fn obstacle(&self, point: Point) -> Option<&'static str> {
        let (instance, pin) = match point {
            Point::Input(_) => return None,
            Point::Formula(_) => return Some("it is an expression"),
            Point::Symbol(_, 0) => return Some("the runtime writes it"),
            Point::Symbol(..) => {
                let variable = self
                    .script
                    .variable(point)
                    .filter(|variable| !variable.is_settable());
                return variable.map(
                    |_| "only inputs, global variables and those AT an address are set, and no constants",
                );
            }
            Point::Pin(instance, pin) => (instance, pin),
        };
        let instance = self.script.blocks.get(instance)?;
        let info = instance.block.pins().nth(pin)?;
        if instance.wires.iter().any(|(wired, _)| *wired == pin) {
            return Some("it is wired: change what the wire comes from");
        }
        match (info.direction, info.ty) {
            (Direction::Output, _) => Some("it is an output"),
            (Direction::InOut, _) | (_, PinType::Axis(_) | PinType::Table(_)) => {
                Some("it is set once and for all")
            }
            (Direction::Input, _) => None,
        }
    }

    /// The value of a text at a point, and as JSON.
    fn parse(&self, point: Point, text: &str) -> Result<(Value, String), String> {
        if let Some(obstacle) = self.obstacle(point) {
            return Err(obstacle.to_owned());
        }
        if let Some(whole) = self
            .script
            .variable(point)
            .and_then(|variable| variable.parse(text))
        {
            return whole;
        }
        let ty = self.script.type_of(point);
        let now = self.value(point).ok_or("there is no such pin")?;
        let number = || -> Result<f64, String> {
            let word = matches!(text, "NaN" | "Infinity" | "-Infinity");
            let known = text
                .parse()
                .ok()
                .filter(|number: &f64| word || number.is_finite());
            known.ok_or_else(|| format!("`{text}` is no number"))
        };
        let whole = |least: i64, most: i64, value: fn(i64) -> Value| {
            let known = text.parse().ok().filter(|number| (least..=most).contains(number));
            let known = known.map(|number| (value(number), number.to_string()));
            known.ok_or_else(|| format!("`{text}` is no whole number from {least} to {most}"))
        };
        match (now, ty) {
            (Value::Bool(_), _) => match text.to_ascii_uppercase().as_str() {
                "TRUE" | "1" => Ok((Value::Bool(true), "true".to_owned())),
                "FALSE" | "0" => Ok((Value::Bool(false), "false".to_owned())),
                _ => Err(format!("`{text}` is neither TRUE nor FALSE")),
            },
            (Value::Lreal(_), _) => {
                let number = number()?;
                let json = match number.is_finite() {
                    true => shortest(number),
                    false => format!("\"{text}\""),
                };
                Ok((Value::Lreal(number), json))
            }
            (Value::Int(_), _) => whole(i16::MIN.into(), i16::MAX.into(), |number| {
                Value::Int(number as i16)
            }),
            (Value::Word(_), _) => whole(0, u16::MAX.into(), |number| Value::Word(number as u16)),
            (Value::Dword(_), _) => whole(0, u32::MAX.into(), |number| Value::Dword(number as u32)),
            (Value::Time(_), _) => {
                let ns = time::parse(text)
                    .map_err(|why| format!("`{text}` is no time such as T#1s500ms: {why}"))?;
                Ok((Value::Time(ns), format!("\"{}\"", time::literal(ns))))
            }
            (Value::Enum(_), Some(PinType::Enum(info))) => {
                let known = info.number_of(text).or_else(|| text.parse().ok());
                let number = known.ok_or_else(|| format!("`{text}` is no element of {}", info.name))?;
                let json = info.name_of(number).map(|name| format!("\"{name}\""));
                Ok((Value::Enum(number), json.unwrap_or_else(|| number.to_string())))
            }
            (Value::Enum(_) | Value::Axis(_) | Value::Table(_), _) => {
                Err("it is set once and for all".to_owned())
            }
        }
    }

    /// The variable or pin of this name in scripts; case does not count.
    #[must_use]
    pub fn point(&self, name: &str) -> Option<Point> {
        let same = |known: &str| known.eq_ignore_ascii_case(name);
        if let Some(input) = self.script.inputs.iter().position(|input| same(&input.name)) {
            return Some(Point::Input(input));
        }
        let (subject, signal) = name.split_once('.')?;
        for (index, instance) in self.script.blocks.iter().enumerate() {
            if instance.name.eq_ignore_ascii_case(subject) {
                let mut pins = instance.block.pins();
                let pin = pins.position(|pin| pin.name.eq_ignore_ascii_case(signal))?;
                return Some(Point::Pin(index, pin));
            }
        }
        for (index, program) in self.script.programs.iter().enumerate() {
            if program.name.eq_ignore_ascii_case(subject) {
                let mut symbols = program.symbols.iter();
                let symbol = symbols.position(|symbol| symbol.name.eq_ignore_ascii_case(signal))?;
                return Some(Point::Symbol(index, symbol));
            }
        }
        None
    }

    /// Names that [`Session::change`] can write to.
    #[must_use]
    pub fn settable(&self) -> Vec<String> {
        let script = self.script;
        let inputs = (0..script.inputs.len()).map(Point::Input);
        let pins = script.blocks.iter().enumerate().flat_map(|(index, instance)| {
            (0..instance.block.pins().count()).map(move |pin| Point::Pin(index, pin))
        });
        let symbols = script.programs.iter().enumerate().flat_map(|(index, program)| {
            (0..program.symbols.len()).map(move |symbol| Point::Symbol(index, symbol))
        });
        let points = inputs.chain(pins).chain(symbols);
        points
            .filter(|point| self.obstacle(*point).is_none())
            .map(|point| cells::point_name(script, point))
            .collect()
    }

    /// The order of an axis, given by its index in the script, to its drive in the last scan; before the first one
    /// its start.
    #[must_use]
    pub fn ordered(&self, axis: usize) -> Option<Ordered> {
        Some(self.machine.drives().get(axis)?.ordered())
    }

    /// Overrides the position of an axis's drive, given by its index in the script: from the next scan on
    /// it is this one (u), in the drive's own coordinates (see [`Ordered`]), independent of its
    /// simulation. Power and faults are still those of the simulation.
    ///
    /// # Errors
    /// The reason for people: it is not a number, or there is no such axis.
    pub fn lead(&mut self, axis: usize, position: f64) -> Result<(), String> {
        if !position.is_finite() {
            return Err(format!("the position is {position}: a drive is somewhere"));
        }
        let drive = self.machine.drives_mut().get_mut(axis);
        drive.ok_or("there is no such axis")?.lead(position);
        Ok(())
    }

    /// Makes an axis or its drive fail at the latch of the next scan, as a step `fault` does; without a
    /// fault its cause is removed, as by a step `clear`.
    pub fn fail(&mut self, axis: usize, fault: Option<(FaultKind, u16)>) {
        self.bench.fail(axis, fault);
    }

    /// The changes from outside so far.
    #[must_use]
    pub fn changes(&self) -> &[Change] {
        &self.changes
    }

    /// Judges the claims on the rows so far.
    #[must_use]
    pub fn verdicts(&mut self) -> Vec<Verdict> {
        let rows = self.bench.rows();
        self.judges.look(&rows);
        self.judges.verdicts(&rows)
    }

    /// The same as [`Session::verdicts`], without the texts of the claims ([`Verdict::says`]).
    #[must_use]
    pub fn verdicts_untold(&mut self) -> Vec<Verdict> {
        let rows = self.bench.rows();
        self.judges.look(&rows);
        self.judges.untold(&rows)
    }

    /// Judges the claims on the rows so far. The reasons of failed claims are searched only if all rows
    /// are still held.
    #[must_use]
    pub fn finish(mut self) -> Outcome {
        let verdicts = self.verdicts();
        let rows = self.bench.rows();
        let why = match rows.trace.first() {
            0 if rows.layout.has_all() => why::why(&rows, &verdicts),
            _ => Vec::new(),
        };
        let (mut trace, shifts, truths) = self.bench.into_rows();
        trace.set_claims(verdicts.iter().map(told).collect());
        Outcome {
            trace,
            verdicts,
            why,
            shifts,
            truths,
        }
    }

    /// The rows so far, without judging the claims. Claims of a run that was stopped refer to scans that never
    /// happened.
    #[must_use]
    pub fn into_trace(self) -> Trace {
        self.bench.into_rows().0
    }
}

//! The run of a random program, with every rule checked in every scan.

use super::program::Role;
use crate::rules::arrows::{Part, Reach};
use crate::rules::fence::Fence;
use crate::rules::law::Law;
use crate::rules::limits::{Track, check_excess, check_torque};
use crate::rules::{Broken, Call, Held, Kind, Outputs, Shown, Truth, check_call, check_truth};
use standstill_axis::{
    Axis, AxisState, CommandId, EdgeWhileBusy, Event, Fate, LOG_KEPT, Log, Plan, Record, Standard,
    StandardPlan, WorkKind,
};
use standstill_blocks::BlockInstance;
use standstill_fb::{AnyInstance, Context, Value};
use standstill_script::model::{Action, Script};
use standstill_script::{Session, Witness};

/// What the rules know of an instance.
#[derive(Clone, Debug)]
struct Instance {
    role: Role,
    /// The outputs of its last call.
    shown: Shown,
    /// Execute or Enable at the last call.
    was_on: bool,
    outputs: Outputs,
    command: Option<CommandId>,
    fate: Option<Fate>,
    /// Its last command, ended or not, and the one it had in motion then (B19).
    given: [Option<CommandId>; 2],
}

/// A rule that was broken in a run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Failure {
    /// The scan.
    pub scan: u64,
    /// The instance or axis.
    pub who: Who,
    /// The rule.
    pub broken: Broken,
    /// The outputs of the instance.
    pub shown: Option<Shown>,
    /// The state of the axis.
    pub state: Option<AxisState>,
}

impl Failure {
    /// A program that does not run to its end has broken no other rule.
    pub(super) fn refused(scan: u64) -> Self {
        Self {
            scan,
            who: Who::Axis(0),
            broken: Broken {
                id: "refused",
                what: "the program cannot run",
            },
            shown: None,
            state: None,
        }
    }
}

/// The instance or axis that breaks a rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Who {
    /// A block instance, by index.
    Instance(usize),
    /// An axis, by index.
    Axis(usize),
}

/// The observations of a run.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Seen {
    /// Scans done.
    pub scans: u64,
    /// Commands accepted.
    pub accepted: u64,
    /// Commands that ended in Done, CommandAborted and Error, except those replaced by their own
    /// instance.
    pub ended: [u64; 3],
    /// Commands refused.
    pub refused: u64,
    /// Faults injected.
    pub faults: u64,
    /// Stops in the middle of a reversal, which turned back.
    pub turned_back: u64,
    /// Hash of everything that was published and shown, to the bit.
    pub digest: u64,
}

impl Seen {
    fn fold(&mut self, word: u64) {
        // FNV-1a over whole words.
        self.digest = (self.digest ^ word).wrapping_mul(0x0000_0100_0000_01b3);
        self.digest ^= self.digest >> 29;
    }
}

/// Checks the rules in every scan of a program.
struct Rules {
    instances: Vec<Instance>,
    /// The axis before the call that is being made.
    found: Option<Found>,
    reach: Reach,
    tracks: Vec<Track>,
    fences: Vec<Fence>,
    laws: Vec<Law>,
    /// The state of each axis as last seen.
    states: Vec<AxisState>,
    following: Vec<bool>,
    /// Whether MC_TorqueControl owned each axis at the end of the scan before.
    torques: Vec<bool>,
    /// Whether the set-point of each axis is measured: it is under a torque, or the motion that took over
    /// from one is not at rest yet.
    measured: Vec<bool>,
    /// The largest speed (u/s) of each axis since then, or the present one.
    fastest: Vec<f64>,
    /// The motion of each axis that no instance follows, as recorded.
    orphans: Vec<Option<CommandId>>,
    /// Records taken from the ring so far, and those of this scan.
    taken: u64,
    records: Vec<Record>,
    /// Number of coordinate moves of each axis at the last check.
    moves: Vec<u32>,
    /// Blocks move axes that are not known here to be theirs: programs call them, or a step changes their axis.
    has_others: bool,
    failure: Option<Failure>,
    seen: Seen,
}

/// An axis before a call.
#[derive(Clone, Copy, Debug)]
struct Found {
    /// Index of the axis.
    axis: usize,
    state: AxisState,
    newest: CommandId,
    /// The profile of the instance owns its axis and gives its points in this call.
    due: bool,
    /// A rising edge would be ignored.
    ignoring: bool,
}

impl Instance {
    fn new(role: Role) -> Self {
        Self {
            outputs: Outputs::of(role.info),
            role,
            shown: Shown::default(),
            was_on: false,
            command: None,
            fate: None,
            given: [None; 2],
        }
    }

    /// Whether it waits in the buffer of its axis, according to its outputs.
    fn waits(&self) -> bool {
        let elsewhere =
            matches!(self.role.info.name, "MC_Reset" | "MC_TouchProbe") || self.role.kind.is_superimposed();
        self.shown.busy && !self.shown.active && !elsewhere
    }

    fn follows_commands(&self) -> bool {
        matches!(
            self.role.kind,
            Kind::Motion | Kind::Stop | Kind::Superimposed | Kind::HaltSuperimposed
        )
    }
}

/// Runs a script, in which `act` may act before every scan.
///
/// Ends at the first broken rule. A script that cannot run breaks one, too.
pub fn run(script: &Script, mut act: impl FnMut(&mut Session<'_>)) -> (Seen, Option<Failure>) {
    let Ok(mut session) = Session::without_rows(script) else {
        return (Seen::default(), Some(Failure::refused(0)));
    };
    let mut rules = Rules::new(script, session.axes());
    while rules.failure.is_none() && !session.is_over() {
        act(&mut session);
        if session.advance_before(&mut rules).is_err() {
            rules.failure = Some(Failure::refused(session.scans()));
        }
    }
    (rules.seen, rules.failure)
}

impl Rules {
    fn new(script: &Script, axes: &[Axis<Standard>]) -> Self {
        let cycle = script.cycle_ns as f64 / 1e9;
        let count = axes.len();
        Self {
            instances: script.blocks.iter().map(Role::of).map(Instance::new).collect(),
            found: None,
            reach: Reach::default(),
            tracks: axes.iter().map(|axis| Track::new(axis, cycle)).collect(),
            fences: axes.iter().map(Fence::new).collect(),
            laws: vec![Law::default(); count],
            states: axes.iter().map(Axis::state).collect(),
            following: vec![true; count],
            torques: vec![false; count],
            measured: vec![false; count],
            fastest: vec![0.0; count],
            orphans: vec![None; count],
            taken: 0,
            records: Vec::new(),
            moves: axes.iter().map(Axis::coordinates).collect(),
            has_others: !script.programs.is_empty() || changes_axes(script),
            failure: None,
            seen: Seen::default(),
        }
    }

    #[cold]
    fn fail(&mut self, scan: u64, who: Who, broken: Broken) {
        let (shown, state) = match who {
            Who::Instance(index) => (self.instances.get(index).map(|instance| instance.shown), None),
            Who::Axis(index) => (None, self.states.get(index).copied()),
        };
        self.failure.get_or_insert(Failure {
            scan,
            who,
            broken,
            shown,
            state,
        });
    }

    /// State changes of all axes since the last check.
    fn follow_states(&mut self, part: Part, scan: u64, axes: &[Axis<Standard>]) {
        for (index, axis) in axes.iter().enumerate() {
            let (was, now) = (self.states[index], axis.state());
            if was != now {
                self.states[index] = now;
                if let Err(broken) = self.reach.check(part, was, now) {
                    self.fail(scan, Who::Axis(index), broken);
                }
            }
        }
    }

    /// Under a torque the set-point is the actual state (docs/torque.md), which no limit of the axis bounds. This
    /// holds from the latch behind the motion step in which the torque became active, even if another motion takes
    /// over before a torque is ordered.
    fn follow_torques(&mut self, axes: &[Axis<Standard>]) {
        for (index, axis) in axes.iter().enumerate() {
            let is_held = axis.order().torque.is_some();
            let began = core::mem::replace(&mut self.torques[index], is_torque(axis));
            let setpoint = axis.setpoint();
            let was_measured = self.measured[index];
            self.measured[index] = is_held || began || (was_measured && !setpoint.is_at_rest());
            let before = if was_measured { self.fastest[index] } else { 0.0 };
            self.fastest[index] = before.max(setpoint.velocity.abs());
        }
    }

    /// Checks the outputs of an instance that was called.
    fn check_outputs(
        &mut self,
        index: usize,
        block: &BlockInstance,
        axes: &[Axis<Standard>],
    ) -> Result<(), Broken> {
        let Some(found) = self.found.take() else {
            return Ok(());
        };
        let Found { state, newest, .. } = found;
        let axis = &axes[found.axis];
        let refusing = matches!(state, AxisState::Disabled | AxisState::ErrorStop);
        let instance = &mut self.instances[index];
        // MC_Power lets a paused command go on, which may fail.
        let starts = found.due || instance.role.kind == Kind::Power;
        let part = if starts { Part::DueCall } else { Part::Call };
        let (was, now) = (instance.shown, instance.outputs.read(block));
        let on = instance.role.trigger.and_then(|pin| block.get(pin)) == Some(Value::Bool(true));
        // An ignored edge does not count as one.
        let ignored = found.ignoring && axis.newest_command() == newest;
        let (executed, execute) = (instance.was_on || ignored, on);
        instance.was_on = execute;
        instance.shown = now;
        if was != now {
            self.seen.fold(
                index as u64 ^ u64::from(now.error_id) << 16
                    | u64::from(now.busy) << 40
                    | u64::from(now.active) << 41
                    | u64::from(now.done) << 42
                    | u64::from(now.aborted) << 43
                    | u64::from(now.reached) << 44
                    | u64::from(now.status) << 45
                    | u64::from(now.valid) << 46,
            );
        }
        let call = Call {
            kind: instance.role.kind,
            executed,
            execute,
            was,
            now,
            refusing,
            powered: axis.is_powered(),
        };
        check_call(&call)?;
        if axis.newest_command() != newest {
            let moving = instance
                .given
                .into_iter()
                .flatten()
                .find(|id| axis.active_command() == Some(*id));
            instance.given = [Some(axis.newest_command()), moving];
        } else if now.error && instance.command.is_some() {
            // A command that has completed and continues, such as a profile with a velocity at its end, needs no
            // instance.
            let is_over = |id: &CommandId| axis.fate(*id) == Fate::Done;
            instance.given = instance.given.map(|id| id.filter(is_over));
        }
        if instance.role.kind == Kind::Jog {
            // Its commands follow each other, so the fate of one of them is not its output.
            if axis.newest_command() != newest {
                self.seen.accepted += 1;
                (instance.command, instance.fate) = (Some(axis.newest_command()), None);
            }
            instance.command = instance.command.filter(|_| now.busy);
        }
        if instance.follows_commands() {
            let rising = execute && !executed;
            if rising {
                self.seen.accepted += u64::from(now.busy);
                self.seen.refused += u64::from(now.error);
                instance.command = now.busy.then(|| axis.newest_command());
                instance.fate = None;
            }
            if let Some(id) = instance.command {
                let fate = axis.fate(id);
                let [done, aborted, failed] = ended(fate);
                let agrees = (now.busy, now.done, now.aborted, now.error)
                    == (!(done | aborted | failed), done, aborted, failed);
                if !agrees {
                    return Err(Broken {
                        id: "R21",
                        what: "an instance does not show what became of its command",
                    });
                }
                if !now.busy {
                    instance.command = None;
                    for (count, ended) in self.seen.ended.iter_mut().zip([done, aborted, failed]) {
                        *count += u64::from(ended);
                    }
                }
            }
        }
        let (was, now) = (state, axis.state());
        if was != now {
            self.states[found.axis] = now;
            self.reach.check(part, was, now)?;
        }
        Ok(())
    }

    /// The checks after the motion step.
    fn check_axis(
        &mut self,
        index: usize,
        axis: &Axis<Standard>,
        axes: &[Axis<Standard>],
    ) -> Result<(), Broken> {
        let state = axis.state();
        let setpoint = axis.setpoint();
        self.seen.fold(setpoint.position.to_bits() ^ (state as u64) << 52);
        let following = axis.is_following();
        if following || self.following[index] || self.measured[index] {
            // While it returns into operation it takes over at the actual position.
            self.tracks[index].forget();
        }
        if self.measured[index] {
            self.fences[index].forget();
        }
        self.following[index] = following;
        if !following && !self.measured[index] {
            // It begins in this scan, or began in the call before this step; not every one is recorded.
            if let Some((plan, 0 | 1)) = axis.plan() {
                let scans = plan.scans();
                let [from, to] = [0, u64::from(scans)].map(|scan| plan.at(scan).position);
                self.tracks[index].leads(from, to, scans);
                self.tracks[index].resolves(resolution(plan));
            }
            for (master, numerator, denominator) in axis.gears().into_iter().flatten() {
                if let Some(master) = self.tracks.get(master.index()).cloned() {
                    let ratio = f64::from(numerator) / f64::from(denominator);
                    self.tracks[index].follows(&master, ratio);
                }
            }
            if let Some(master) = axis.master().filter(|_| axis.is_on_a_cam())
                && let Some((track, of)) = self
                    .tracks
                    .get(master.index())
                    .cloned()
                    .zip(axes.get(master.index()))
            {
                // The slope of the cam is not known here: one with which both go as fast as they may.
                let ratio = axis.config().limits.velocity / of.config().limits.velocity;
                self.tracks[index].follows(&track, ratio);
            }
            self.tracks[index].is_beside(axis.deviation());
            self.tracks[index].check(&setpoint)?;
        }
        self.fences[index].check(axis)?;
        self.laws[index].check(axis, axes)?;
        if state == AxisState::ErrorStop && axis.error_id().number() >= 900 {
            return Err(Broken {
                id: "R79",
                what: "a defect is reported",
            });
        }
        if let Some(order) = axis.order().torque {
            check_torque(&order, axis.config().limits.velocity, self.fastest[index])?;
        }
        self.check_commands(index, axis)
    }

    fn check_commands(&mut self, index: usize, axis: &Axis<Standard>) -> Result<(), Broken> {
        let mut beside_held = false;
        for instance in &mut self.instances {
            if instance.role.axis != Some(index) {
                continue;
            }
            let Some(id) = instance.command else { continue };
            let fate = axis.fate(id);
            if Some(fate) != instance.fate {
                let was = instance.fate.replace(fate);
                check_life(was, fate, instance.role.kind)?;
            }
            beside_held |= instance.role.kind.is_superimposed();
        }
        let (state, owned) = (axis.state(), axis.active_command().is_some());
        self.check_followed(index, axis)?;
        // The superimposed motion is read only if there may be one, because the result is large.
        let added = if beside_held || (state == AxisState::DiscreteMotion && !owned) {
            axis.outlook().superimposed.and_then(|beside| beside.command)
        } else {
            None
        };
        let holds = |id| {
            self.instances
                .iter()
                .any(|one| one.role.axis == Some(index) && one.command == Some(id))
        };
        let truth = Truth {
            state,
            owned,
            stopping: owned && state == AxisState::Stopping,
            waiting: axis.waiting(),
            awaited: axis.awaited_command().is_some(),
            shift_due: state == AxisState::Standstill && axis.waiting() > 0 && shift_is_due(axis),
            added: added.map(|(.., own)| own),
            orphaned: added.is_some_and(|(id, ..)| !holds(id)),
        };
        let held = self
            .instances
            .iter()
            .filter(|instance| instance.role.axis == Some(index));
        check_truth(
            &truth,
            held.filter_map(|instance| {
                let superimposed = instance.role.kind.is_superimposed();
                let fate = instance.fate.filter(|_| instance.command.is_some())?;
                let active = matches!(fate, Fate::Active { .. }) && instance.role.kind != Kind::Stop;
                let busy = matches!(fate, Fate::Active { .. } | Fate::Waiting);
                Some(Held {
                    superimposed,
                    busy,
                    active,
                })
            }),
        )
    }

    /// No motion without a block: an owner or a waiting command belongs to an instance, or is recorded as
    /// orphaned.
    fn check_followed(&self, index: usize, axis: &Axis<Standard>) -> Result<(), Broken> {
        if self.has_others {
            return Ok(());
        }
        let instances = || {
            self.instances
                .iter()
                .filter(|instance| instance.role.axis == Some(index))
        };
        let broken = |what| Err(Broken { id: "R97", what });
        // At the end of a command that fails at rest.
        let is_over = axis.plan().is_some_and(|(plan, _)| plan.scans() == 0);
        if let Some(owner) = axis.active_command()
            && !is_over
            && !instances().any(|instance| instance.given.contains(&Some(owner)))
        {
            if self.orphans[index] != Some(owner) {
                return broken("a motion without a block");
            }
            if axis.outlook().paused {
                return broken("a motion without a block is held up, to go on by itself");
            }
        }
        if axis.waiting() > 0 && axis.waiting() > instances().filter(|instance| instance.waits()).count() {
            return broken("a command waits without a block");
        }
        if let Some(awaited) = axis.awaited_command()
            && !instances().any(|instance| instance.given.contains(&Some(awaited)))
        {
            return broken("a command waits for its start point without a block");
        }
        Ok(())
    }

    /// Takes the records since the last call. The ring holds [`LOG_KEPT`] records and a scan may have
    /// more, so this is called after every block.
    fn collect(&mut self, log: &Log) {
        let new = log.total() - self.taken;
        assert!(new <= LOG_KEPT as u64, "the ring has lost some of {new} records");
        self.records.extend(log.since(self.taken).copied());
        self.taken = log.total();
    }

    /// Across a shift of coordinates, differences have no meaning.
    fn follow_coordinates(&mut self, axes: &[Axis<Standard>]) {
        for (index, axis) in axes.iter().enumerate() {
            let moves = axis.coordinates();
            if core::mem::replace(&mut self.moves[index], moves) != moves {
                self.tracks[index].forget();
                self.fences[index].forget();
                self.laws.iter_mut().for_each(Law::forget);
            }
        }
    }

    /// The records of this scan, and the rules that require a record.
    fn read_records(&mut self, scan: u64, axes: &[Axis<Standard>], log: &Log) {
        self.collect(log);
        let mut found = None;
        for record in core::mem::take(&mut self.records) {
            match record.event {
                Event::Unavoidable(excess) => {
                    let index = record.axis.index();
                    let limits = &axes[index].config().limits;
                    self.seen.turned_back += 1;
                    let is_planned = !self.measured[index];
                    if let Err(broken) = check_excess(&excess, limits)
                        && is_planned
                    {
                        found = Some((index, broken));
                    }
                }
                Event::Orphaned => {
                    let index = record.axis.index();
                    self.orphans[index] = axes[index].active_command();
                }
                Event::Refused { .. }
                | Event::PointRefused { .. }
                | Event::Shifted { .. }
                | Event::Clamped { .. }
                | Event::Raised { .. }
                | Event::Slowed { .. }
                | Event::Superimposed { .. }
                | Event::RoomAwaited
                | Event::Planned { .. }
                | Event::Paused { .. }
                | Event::Coupled { .. }
                | Event::Approaching { .. }
                | Event::InGear
                | Event::GearLost { .. }
                | Event::SyncLate { .. }
                | Event::Phasing { .. }
                | Event::LeadsOutside { .. }
                | Event::CamSelected { .. }
                | Event::CamStops { .. }
                | Event::OnCam { .. }
                | Event::OntoCam { .. }
                | Event::InSync
                | Event::SyncLost { .. }
                | Event::CamPassed { .. }
                | Event::Fault { .. } => {}
            }
        }
        if let Some((axis, broken)) = found {
            self.fail(scan, Who::Axis(axis), broken);
        }
    }
}

/// Whether a step changes the axis of an instance.
fn changes_axes(script: &Script) -> bool {
    let mut actions = script.steps.iter().flat_map(|step| &step.actions);
    actions.any(|action| matches!(action, Action::Set(_, Value::Axis(_))))
}

/// The error of a plan's jerk and snap by the rounding of positions: none, except on a curve, whose
/// stretches have polynomials of degree 7 (docs/profiles.md).
fn resolution(plan: &StandardPlan) -> [f64; 2] {
    let StandardPlan::Profile(profile) = plan else {
        return [0.0; 2];
    };
    let mut off = [0.0_f64; 2];
    let mut last = None;
    for (time, state) in profile.nodes() {
        if let Some((before, from)) = last.replace((time, state.position)) {
            let (time, way): (f64, f64) = (time - before, state.position - from);
            let unit = f64::EPSILON * way.abs() / (time * time * time);
            off = [off[0].max(1680.0 * unit), off[1].max(13_440.0 * unit / time)];
        }
    }
    off
}

/// Whether MC_TorqueControl owns the axis. Its motion has no plan, which is checked first because the other result
/// is large.
fn is_torque(axis: &Axis<Standard>) -> bool {
    let is_owner = |(_, kind, _)| kind == WorkKind::Torque;
    axis.state() == AxisState::ContinuousMotion
        && axis.plan().is_none()
        && axis.outlook().owner.is_some_and(is_owner)
}

/// Whether MC_SetPosition is the first command that waits.
#[cold]
fn shift_is_due(axis: &Axis<Standard>) -> bool {
    let [first, ..] = axis.outlook().waiting;
    first.is_some_and(|(_, kind, _)| kind == WorkKind::SetPosition)
}

/// Done, CommandAborted and Error of a fate.
fn ended(fate: Fate) -> [bool; 3] {
    match fate {
        Fate::Waiting | Fate::Active { .. } => [false; 3],
        Fate::Done => [true, false, false],
        Fate::Aborted => [false, true, false],
        Fate::Failed(_) => [false, false, true],
    }
}

/// A command waits, is active, and ends, each at most once. MC_Stop is done while it holds the axis, and
/// a superimposed command may have to wait again.
fn check_life(was: Option<Fate>, now: Fate, kind: Kind) -> Result<(), Broken> {
    let stage = |fate: Fate| match fate {
        Fate::Waiting => 0,
        Fate::Active { .. } => 1,
        Fate::Done => 2,
        Fate::Aborted => 3,
        Fate::Failed(_) => 4,
    };
    let Some(was) = was.map(stage) else { return Ok(()) };
    let now = stage(now);
    let lives_on = was < 2 && (now >= was || kind.is_superimposed());
    if lives_on || was == now {
        Ok(())
    } else {
        Err(Broken {
            id: "R26",
            what: "a command that ended ends again, or one that was active waits",
        })
    }
}

impl Witness for Rules {
    fn begins(&mut self, scan: u64, axes: &[Axis<Standard>]) {
        self.follow_states(Part::Feedback, scan, axes);
    }

    fn before(&mut self, instance: usize, context: &Context<'_, Standard>) {
        let Instance { role, command, .. } = self.instances[instance];
        let Some(axis) = role.axis.and_then(|axis| context.axes.get(axis)) else {
            return;
        };
        let state = axis.state();
        self.found = Some(Found {
            axis: axis.id().index(),
            state,
            newest: axis.newest_command(),
            due: command.is_some_and(|id| axis.profile_is_due(id)),
            ignoring: axis.config().edge_while_busy == EdgeWhileBusy::Ignore
                && state != AxisState::Stopping
                && command.is_some_and(|id| ended(axis.fate(id)) == [false; 3]),
        });
    }

    fn after(&mut self, instance: usize, block: &BlockInstance, context: &Context<'_, Standard>) {
        if let Err(broken) = self.check_outputs(instance, block, context.axes) {
            self.fail(context.scope.scan, Who::Instance(instance), broken);
        }
        self.collect(context.scope.log);
    }

    fn published(&mut self, scan: u64, axes: &[Axis<Standard>], log: &Log) {
        self.seen.scans += 1;
        self.follow_states(Part::Motion, scan, axes);
        self.follow_torques(axes);
        self.follow_coordinates(axes);
        self.read_records(scan, axes, log);
        for (index, axis) in axes.iter().enumerate() {
            if let Err(broken) = self.check_axis(index, axis, axes) {
                self.fail(scan, Who::Axis(index), broken);
            }
        }
    }
}

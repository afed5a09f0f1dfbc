//! One axis: its data, and the values that other code may read.
//!
//! `Axis` decides. Values and arithmetic are in parts of their own with private fields:
//!
//! | part | what it holds |
//! | --- | --- |
//! | [`commands`] | a command: its work, the properties of each kind of work, its entry |
//! | [`mover`] | the set-point, the motion it comes from, what is superimposed and published, and the limits they keep |
//! | [`queue`] | commands that wait |
//! | [`stage`] | the power stage: what is requested, and what the drive reports |
//! | [`failure`] | the error shown, whether its cause persists, the reset under way |
//! | [`feedback`] | actual positions, and which of them can be compared |
//! | [`frame`] | the coordinates of the axis and of its drive |
//! | [`modulo`] | turns, and the shortest way |
//! | [`measured`] | actual positions as slaves see them: filtered |
//! | [`coupling`] | how it follows others and is followed, which only that folder writes |
//!
//! The decisions are in one file for each subject:
//!
//! | file | subject |
//! | --- | --- |
//! | [`accept`], [`queued`], [`update`], [`retrigger`] | commands: taken or refused, administrative ones that wait, new values, replaced ones |
//! | [`dynamics`], [`factors`], [`parameters`] | limits from pins, the override, parameters by number |
//! | [`step`], [`replan`], [`blend`], [`through`], [`run`], [`turn`], [`inside`], [`guard`] | the motion step and hand-over, changes of the owner's motion while it runs, the velocity at its end, ends that are passed on a ramp, chains as one motion, turns between commands, take-overs within the limits, no step of the set-point |
//! | [`superimposed`] | a second motion on top |
//! | [`coupling`] | slaves |
//! | [`profile`], [`torque`], [`jog`], [`homing`] | curves through points, torques, MC_Jog, the search for the reference |
//! | [`power`], [`permission`], [`limit_switches`], [`software_limits`], [`supervision`] | feedback, power, faults and resets; directions, switches, limits, following error |
//! | [`coordinates`], [`reading`], [`outputs`], [`probe`] | moved coordinates, values for reading blocks, inputs and outputs, positions at edges |
//! | [`going`] | scans in which nothing but the set-point changes |

mod accept;
mod blend;
mod commands;
mod coordinates;
mod coupling;
mod dynamics;
mod factors;
mod failure;
mod feedback;
mod frame;
mod going;
mod guard;
mod homing;
mod inside;
mod jog;
mod limit_switches;
mod measured;
mod modulo;
mod mover;
mod outputs;
mod parameters;
mod permission;
mod power;
mod probe;
mod profile;
mod queue;
mod queued;
mod reading;
mod replan;
mod retrigger;
mod run;
mod software_limits;
mod stage;
mod step;
mod superimposed;
mod supervision;
mod through;
mod torque;
mod turn;
mod update;

use crate::fate::Fates;
use crate::{
    AxisConfig, AxisEvent, AxisId, AxisState, BufferMode, CommandId, ConfigError, DIGITAL, DriveCommand,
    DriveOrder, DrivePosition, DriveReport, DriveRequest, DriveSignals, ErrorId, Event, Fate, QUEUE_MAX,
    Record, Scope, StartState, state,
};
pub use commands::WorkKind;
use commands::{Ending, Entry, Work};
use core::mem::offset_of;
pub use coupling::{CamFit, CamLaid, Coupled};
pub(crate) use coupling::{Future, Part, Seen, Turn, Values, View};
pub use factors::Factors;
use feedback::Feedback;
use frame::Frame;
pub use going::Going;
use modulo::Modulo;
use mover::{Motion, Mover};
pub use outputs::CamTrack;
pub use permission::Permission;
pub use probe::TouchProbe;
pub use profile::{Profile, ProfileRow};
use queue::Queue;
pub use reading::{MotionState, Pace, Way};
use stage::Power;
use standstill_planner::{Planner, Setpoint, Standard};

/// The values exchanged with a drive in addition to its motion.
#[derive(Clone, Copy, Debug, Default)]
struct BesideMotion {
    report: DriveReport,
    order: DriveOrder,
    probes: probe::Probes,
    /// The outputs that follow positions.
    cam_tracks: [CamTrack; DIGITAL as usize],
}

/// Whether a scan is routine: it must check little, see [`Axis::find_routine`]. `No` may be out of date; the others
/// never are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Routine {
    /// Something is pending, or may be.
    No,
    /// In operation with nothing pending, but something superimposed.
    Beside,
    /// In operation with nothing pending.
    Alone,
}

impl Routine {
    #[inline]
    fn is_any(self) -> bool {
        self != Self::No
    }
}

/// The future behaviour of an axis, see [`Axis::outlook`]; for searches over all reachable states.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Outlook {
    /// State of the axis.
    pub state: AxisState,
    /// `None` if the set-point follows the feedback, 0 if it holds, else one more than the scans to the goal.
    pub scans_left: Option<u32>,
    /// The owner: its number, its work, and whether MC_Stop's Execute holds it.
    pub owner: Option<(CommandId, WorkKind, bool)>,
    /// MC_Stop has come to rest and is held.
    pub stop_held: bool,
    /// Commands that wait, in order, with their buffer modes.
    pub waiting: [Option<(CommandId, WorkKind, BufferMode)>; QUEUE_MAX],
    /// MC_Power.Enable.
    pub power_wanted: bool,
    /// The directions MC_Power permits.
    pub permitted: Permission,
    /// The owner waits for permission to continue.
    pub paused: bool,
    /// Operation is enabled.
    pub power_on: bool,
    /// On the way to Disabled.
    pub going_off: bool,
    /// Power was lost, or not confirmed in time, and does not return by itself.
    pub tripped: bool,
    /// It was not confirmed in time.
    pub unconfirmed: bool,
    /// Scans since power was requested, if there is a time-out.
    pub power_waited: u64,
    /// The axis error.
    pub error: ErrorId,
    /// Its cause persists.
    pub cause_present: bool,
    /// A reset under way.
    pub reset: Option<CommandId>,
    /// MC_Home has been done.
    pub homed: bool,
    /// The search of MC_Home, as bits.
    pub homing: [u64; 5],
    /// The last motion was in positive direction.
    pub forward: bool,
    /// The superimposed motion.
    pub superimposed: Option<Beside>,
    /// The override, as bits.
    pub factors: [u64; 3],
    /// The parameters that the application can write by number, as bits.
    pub parameters: [u64; 16],
    /// Scans in a row the axis has been inside the in-position window, at the end of a move.
    pub inside_for: u32,
    /// The owner's motion does not lead to its goal: the override halts it, MC_Power bars it, or it has
    /// to be planned anew.
    pub held_up: bool,
}

/// The future behaviour of a superimposed motion, part of [`Outlook`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Beside {
    /// The command: its number, its work, and whether it moves now; otherwise it waits for room.
    pub command: Option<(CommandId, WorkKind, bool)>,
    /// 0 if the added motion holds, otherwise one more than the scans to its goal.
    pub scans_left: u32,
    /// Scans of the owner's plan until a command that waits or was lowered is tried again; the largest
    /// number if it waits for the next plan.
    pub tried_in: u32,
    /// The results of the search for such a command, and where it continues, as bits.
    pub found: [u64; 9],
    /// Position and velocity of the owner's own set-point, as bits.
    pub base: (u64, u64),
    /// The added position and the distance left to add, as bits.
    pub added: (u64, u64),
}

impl Outlook {
    /// Removes command numbers, which only grow, so that different histories can be compared.
    pub fn without_numbers(mut self) -> Self {
        const NUMBERLESS: CommandId = CommandId(0);
        if let Some((id, ..)) = &mut self.owner {
            *id = NUMBERLESS;
        }
        for (id, ..) in self.waiting.iter_mut().flatten() {
            *id = NUMBERLESS;
        }
        self.reset = self.reset.map(|_| NUMBERLESS);
        if let Some(Beside {
            command: Some((id, ..)),
            ..
        }) = &mut self.superimposed
        {
            *id = NUMBERLESS;
        }
        self
    }
}

/// One axis.
// With thousands of axes the time of a scan is that of memory. So the fields that every scan of a motion reads are
// next to each other, in this order: the beginning of `owner`, and the end of `feedback` up to the beginning of the
// plan in `mover`. Fields that some axes need in every scan are in between.
#[derive(Clone, Debug)]
#[repr(C)]
pub struct Axis<P: Planner = Standard> {
    owner: Option<Entry>,
    /// The coordinates.
    frame: Frame,
    modulo: Option<Modulo>,
    power: Power,
    /// Actual positions.
    feedback: Feedback,
    /// How little a scan must check.
    routine: Routine,
    state: AxisState,
    /// Positions are taken and published as they are: no increments, no turns, no shift, no shaper, and no measured
    /// values that slaves could follow.
    is_plain: bool,
    /// The owner is MC_Stop, at rest, and held by its Execute.
    stop_held: bool,
    /// The owner has values that its motion does not use yet, because a superimposed motion leaves no
    /// room.
    replan_due: bool,
    /// A queued MC_SetPosition takes effect at the next latch.
    shift_due: bool,
    homed: bool,
    /// Switches, as last reported.
    signals: DriveSignals,
    id: AxisId,
    planner: P,
    /// Its place among axes that follow each other.
    links: coupling::Links,
    /// Its motion.
    mover: Mover<P::Plan>,
    /// How it follows others and is followed.
    follower: coupling::Follower<P::Plan>,
    /// The peripherals of the drive.
    beside: BesideMotion,
    /// Its actual positions as slaves see them.
    measured: measured::Measured,
    config: AxisConfig,
    /// The override.
    factors: Factors,
    /// The parameters that the application can write.
    parameters: parameters::Parameters,
    failure: failure::Failure,
    /// The search of MC_Home.
    homing: homing::Search,
    /// The end of a move in position.
    arrival: supervision::Arrival,
    queue: Queue,
    fates: Fates,
}

// Every field in between costs time in each scan of many axes.
const _: () = assert!(offset_of!(Axis, mover) - offset_of!(Axis, feedback) <= 104);

impl<P: Planner> Axis<P> {
    /// The axis `id`, set up as `config` says, moved by `planner`.
    ///
    /// # Errors
    /// [`ConfigError`] names the key that is not usable.
    pub fn new(id: AxisId, config: AxisConfig, planner: P) -> Result<Self, ConfigError> {
        config.check()?;
        let powered = config.start == StartState::Standstill;
        let mover = Mover::new(&config, planner.cycle(), powered)?;
        let measured = measured::Measured::new(&config);
        let is_plain =
            config.scaling.is_none() && config.modulo.is_none() && !mover.is_shaped() && !measured.is_there();
        Ok(Self {
            id,
            config,
            planner,
            state: if powered {
                AxisState::Standstill
            } else {
                AxisState::Disabled
            },
            mover,
            modulo: Modulo::new(&config),
            feedback: Feedback::new(config.position),
            beside: BesideMotion::default(),
            frame: Frame::default(),
            owner: None,
            follower: coupling::Follower::default(),
            stop_held: false,
            queue: Queue::default(),
            fates: Fates::default(),
            power: Power::new(powered),
            failure: failure::Failure::default(),
            homed: false,
            homing: homing::Search::default(),
            shift_due: false,
            factors: Factors::ONE,
            parameters: parameters::Parameters::new(&config),
            arrival: supervision::Arrival::default(),
            replan_due: false,
            routine: Routine::No,
            measured,
            signals: DriveSignals::default(),
            links: coupling::Links::default(),
            is_plain,
        })
    }

    /// Its handle.
    pub fn id(&self) -> AxisId {
        self.id
    }

    /// Its configuration.
    pub fn config(&self) -> &AxisConfig {
        &self.config
    }

    /// Its state.
    pub fn state(&self) -> AxisState {
        self.state
    }

    /// The set-point last published; on a modulo axis its position is in the first turn.
    #[inline]
    pub fn setpoint(&self) -> Setpoint {
        match &self.modulo {
            None => self.mover.commanded(),
            Some(modulo) => modulo.shown(&self.mover.commanded()),
        }
    }

    /// The same as a reference, if it need not be computed.
    #[inline]
    pub fn setpoint_in_place(&self) -> Option<&Setpoint> {
        (self.modulo.is_none() && !self.mover.is_shaped()).then(|| self.mover.setpoint())
    }

    /// Actual position (u), as last latched. While the communication is lost, or the drive reports an
    /// invalid number, it is the last good one.
    pub fn actual_position(&self) -> f64 {
        self.feedback.position()
    }

    /// The shift of coordinates in `scan` (u), if that is the last scan with a shift; otherwise 0. Records of it may
    /// be lost from their ring of [`LOG_KEPT`](crate::LOG_KEPT) entries; this value is there for every axis.
    pub fn coordinates_moved(&self, scan: u64) -> f64 {
        self.frame.moved_in(scan)
    }

    /// Operation is enabled (MC_Power.Status).
    pub fn is_powered(&self) -> bool {
        self.power.is_on()
    }

    /// The reason why requested power is not on: [`ErrorId::PowerNotConfirmed`] after the time-out of the
    /// axis. It stays until MC_Power no longer requests power, or MC_Reset starts a new attempt.
    pub fn power_error(&self) -> Option<ErrorId> {
        self.power.is_unconfirmed().then_some(ErrorId::PowerNotConfirmed)
    }

    /// Number of past set-points that its shaper needs; 0 without one. The host lends this number of places of
    /// [`Scope::history`]. [`Axis::set_history`] sets the first of them.
    pub fn history_needed(&self) -> usize {
        self.mover.history_needed()
    }

    /// Its part of [`Scope::history`] begins at this place. Before this call, or with fewer places than it needs, the
    /// axis is not shaped.
    pub fn set_history(&mut self, first: usize) {
        self.mover.set_history(first);
    }

    /// Whether there is a shaper between its motion and its drive.
    #[inline(always)]
    pub(crate) fn is_shaped(&self) -> bool {
        self.mover.is_shaped()
    }

    /// The end of a motion step: computes the published set-point.
    #[inline(always)]
    pub(crate) fn shape(&mut self, scope: &mut Scope<'_>) {
        if !self.is_plain {
            self.mover.shape(scope.history);
        }
    }

    /// Whether the set-point is the actual position and not a planned one: the axis is not in operation.
    pub fn is_following(&self) -> bool {
        matches!(self.mover.motion(), Motion::Follow)
    }

    /// MC_Home has been done.
    pub fn is_homed(&self) -> bool {
        self.homed
    }

    /// The axis error; `None` outside ErrorStop.
    pub fn error_id(&self) -> ErrorId {
        self.failure.error()
    }

    /// The drive's or fault's own code belonging to [`Axis::error_id`], 0 if none.
    pub fn error_code(&self) -> u16 {
        self.failure.code()
    }

    /// The plan in progress and the scans since its start.
    pub fn plan(&self) -> Option<(&P::Plan, u64)> {
        self.mover.plan()
    }

    /// The command that owns the axis; a superimposed one does not.
    pub fn active_command(&self) -> Option<CommandId> {
        self.owner.as_ref().map(|owner| owner.id)
    }

    /// The number of the command accepted last.
    pub fn newest_command(&self) -> CommandId {
        self.fates.newest()
    }

    /// Commands that wait.
    pub fn waiting(&self) -> usize {
        self.queue.len()
    }

    /// The state of command `id`. Bounded by the queue and the fates kept.
    #[inline]
    pub fn fate(&self, id: CommandId) -> Fate {
        match &self.owner {
            Some(owner) if owner.id == id => self.fate_of_owner(owner),
            _ => self.fate_of_other(id),
        }
    }

    // Inlined into its block; what is seldom asked is not.
    #[inline(always)]
    fn fate_of_owner(&self, owner: &Entry) -> Fate {
        if let Work::Release(_) = owner.work {
            return if self.is_released(owner) {
                Fate::Done
            } else {
                Fate::Active { reached: false }
            };
        }
        if self.goal_reached() {
            return self.fate_at_goal(owner);
        }
        if owner.passed && self.profile_is_over() {
            Fate::Done
        } else {
            Fate::Active { reached: false }
        }
    }

    /// The state of the owner once its motion has reached its goal.
    #[inline(never)]
    fn fate_at_goal(&self, owner: &Entry) -> Fate {
        match owner.work.manner().ending {
            // A stop at rest has completed.
            _ if self.stop_held => Fate::Done,
            Ending::RunsOn if self.profile_is_over() => Fate::Done,
            Ending::Follows => Fate::Active {
                reached: self.is_in_gear(),
            },
            ending => Fate::Active {
                reached: ending == Ending::Holds && !self.is_held_up(),
            },
        }
    }

    /// The state of a command that is not the owner.
    #[inline(never)]
    fn fate_of_other(&self, id: CommandId) -> Fate {
        if self.queue.contains(id)
            || self.awaits_start(id)
            || self.beside.probes.is_waiting(id)
            || self.failure.reset() == Some(id)
        {
            return Fate::Waiting;
        }
        if let Some(fate) = self.superimposed_fate(id).or_else(|| self.phasing_fate(id)) {
            return fate;
        }
        self.fates.find(id).unwrap_or(Fate::Failed(ErrorId::FateLost))
    }

    /// The future behaviour of an axis without masters, probes and outputs: everything except positions, results of
    /// ended commands and the configuration. Two such axes of equal outlook and set-point behave alike from now on,
    /// unless a shaper still holds past motion, limits were lowered in motion, or a shift of the coordinates is due. Not
    /// in it: couplings, probes, cam tracks, the filter of actual positions, the limits in force before a change, and
    /// the shift of coordinates that is due.
    pub fn outlook(&self) -> Outlook {
        let mut waiting = [None; QUEUE_MAX];
        for (slot, entry) in waiting.iter_mut().zip(self.queue.iter()) {
            *slot = Some((entry.id, entry.work.manner().kind, entry.mode));
        }
        Outlook {
            state: self.state,
            scans_left: self.mover.motion().scans_left(),
            owner: self
                .owner
                .as_ref()
                .map(|owner| (owner.id, owner.work.manner().kind, owner.held)),
            stop_held: self.stop_held,
            waiting,
            power_wanted: self.power.is_wanted(),
            permitted: self.power.permitted(),
            paused: self.is_paused(),
            power_on: self.power.is_on(),
            going_off: self.power.is_going_off(),
            tripped: self.power.is_tripped(),
            unconfirmed: self.power.is_unconfirmed(),
            power_waited: self.power.waited(),
            error: self.failure.error(),
            cause_present: self.failure.has_cause(),
            reset: self.failure.reset(),
            homed: self.homed,
            homing: self.homing.bits(),
            forward: self.mover.last_velocity() > 0.0,
            superimposed: self.superimposed_outlook(),
            factors: self.factors.bits(),
            parameters: self.parameters.bits(),
            inside_for: self.arrival.scans(),
            held_up: self.is_held_up(),
        }
    }

    /// The last report of the drive beside its motion; the machine writes it before the blocks are
    /// called.
    pub fn report(&self) -> &DriveReport {
        &self.beside.report
    }

    /// As [`Axis::report`], for the machine.
    pub fn report_mut(&mut self) -> &mut DriveReport {
        &mut self.beside.report
    }

    /// The orders for the drive beside its motion.
    pub fn order(&self) -> &DriveOrder {
        &self.beside.order
    }

    /// The drive's command for this scan.
    #[inline(always)]
    pub fn drive_command(&mut self) -> DriveCommand {
        let (request, rename) = if self.routine.is_any() {
            (DriveRequest::Enable, None)
        } else {
            (self.drive_request(), self.frame.take_rename())
        };
        let (position, velocity) = if self.is_plain {
            let at = self.mover.setpoint();
            (DrivePosition::Units(at.position), at.velocity)
        } else {
            let at = self.mover.commanded();
            (self.position_at_drive(at.position), at.velocity)
        };
        DriveCommand {
            request,
            position,
            velocity,
            rename,
        }
    }

    // Calls return only plain numbers. An enum from a call passes through memory, which takes longer than the rest of
    // the scan's drive command.
    #[inline]
    fn position_at_drive(&self, position: f64) -> DrivePosition {
        let position = position - self.frame.shift();
        match (&self.config.scaling, &self.modulo) {
            (None, None) => DrivePosition::Units(position),
            (Some(scaling), None) => DrivePosition::Increments(scaling.to_increments(position)),
            (None, Some(modulo)) => DrivePosition::Units(modulo.in_turn(position)),
            (Some(scaling), Some(modulo)) => DrivePosition::Increments(modulo.increments(scaling, position)),
        }
    }

    /// Whether a motion at its goal counts as there: its own part has come out of the shaper, or it hands over in
    /// motion.
    #[inline(always)]
    fn is_goal_published(&self) -> bool {
        self.mover.is_base_through() || self.passes_in_motion()
    }

    /// Whether the motion has reached its goal. A motion that holds or is in gear has; one that follows the feedback has
    /// not.
    #[inline(always)]
    fn goal_reached(&self) -> bool {
        match self.mover.motion() {
            Motion::Run { elapsed, scans, .. } => elapsed >= scans && self.is_goal_published(),
            Motion::Hold | Motion::Geared => true,
            Motion::Follow | Motion::Closing { .. } => false,
            Motion::Torque { torque, .. } => self.torque_is_held(*torque),
        }
    }

    /// Whether the owner's present motion does not lead to its goal. The end of that motion is then not the goal.
    fn is_held_up(&self) -> bool {
        self.replan_due
            || self
                .owner
                .as_ref()
                .is_some_and(|owner| owner.halted || owner.paused)
    }

    /// The one place where the state changes.
    fn enter(&mut self, event: AxisEvent) {
        self.end_routine();
        match state::next(self.state, event) {
            Ok(next) => self.state = next,
            Err(_) => debug_assert!(false, "{:?} in {:?}", event, self.state),
        }
    }

    /// Command `id` has ended with `fate`.
    fn decide(&mut self, id: CommandId, fate: Fate) {
        self.fates.record(id, fate);
    }

    fn new_id(&mut self) -> CommandId {
        self.fates.new_id()
    }

    /// The number of a command that is done in its call.
    fn done_at_once(&mut self) -> CommandId {
        let id = self.new_id();
        self.decide(id, Fate::Done);
        id
    }

    /// Ends the owner, the superimposed motion and all waiting commands.
    fn end_all(&mut self, owner: Fate, waiting: Fate) {
        self.end_superimposed(owner);
        self.end_owner(owner);
        // Bounded by QUEUE_MAX: each pass removes one.
        while let Some(entry) = self.queue.pop() {
            self.decide(entry.id, waiting);
        }
        self.end_awaited(waiting);
    }

    /// Makes `entry` the owner, or gives the owner its values.
    fn own(&mut self, entry: Entry) {
        self.owner = Some(entry);
    }

    fn end_owner(&mut self, fate: Fate) {
        let is_over = self.profile_is_over();
        if let Some(owner) = self.owner.take() {
            // A stop at rest is done, whatever ends its hold. So is a profile at its end.
            let over = match owner.work {
                // In every case the coupling has ended.
                Work::Release(_) => self.is_released(&owner) || fate == Fate::Aborted,
                _ => self.stop_held || is_over,
            };
            self.decide(owner.id, if over { Fate::Done } else { fate });
            if matches!(owner.work, Work::Home(_)) {
                self.end_homing();
            }
        }
        self.stop_held = false;
        self.replan_due = false;
        self.end_coupling();
    }

    fn record(&self, event: Event, scope: &mut Scope<'_>) {
        scope.log.push(Record {
            scan: scope.scan,
            axis: self.id,
            instance: scope.instance,
            event,
        });
    }
}

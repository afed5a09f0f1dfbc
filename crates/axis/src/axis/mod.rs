//! One axis: what it knows and what others may ask.
//!
//! The parts of its behaviour have a file each: [`dynamics`] turns pin values into limits, [`accept`] decides
//! on commands, [`step`] moves and hands over, [`modulo`] counts turns and finds the way round, [`power`] reacts
//! to feedback, power, faults and resets.

mod accept;
mod dynamics;
mod modulo;
mod power;
mod queue;
mod step;

use crate::fate::Fates;
use crate::{
    AxisConfig, AxisEvent, AxisId, AxisState, CommandId, ConfigError, DriveCommand, DriveFeedback,
    DrivePosition, ErrorId, Event, Fate, InstanceId, Log, QUEUE_MAX, Record, StartState, state,
};
use modulo::Modulo;
use queue::{Entry, Queue, Work};
use standstill_planner::{Limits, Plan, Planner, Setpoint, Standard};

/// Who gives a command and when; goes into the records.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// The scan.
    pub scan: u64,
    /// The block instance.
    pub instance: InstanceId,
}

/// Where the set-point comes from.
#[derive(Clone, Copy, Debug)]
enum Motion<Plan> {
    /// The actual position: the axis is not in operation.
    Follow,
    /// It stays where it is.
    Hold,
    /// A plan, so many scans after its start.
    Run { plan: Plan, elapsed: u64 },
}

/// What is known of the power stage.
#[derive(Clone, Copy, Debug)]
struct Power {
    /// MC_Power.Enable.
    wanted: bool,
    /// Operation is enabled.
    on: bool,
    /// Switched off on request; the axis ramps down or waits for the power stage.
    going_off: bool,
    /// Power was lost: it does not come back before a reset or a new rising Enable.
    tripped: bool,
    /// What the last MC_Power of this scan asked for, and which instance.
    asked: Option<(bool, InstanceId)>,
    /// The instance that spoke last in the scan before.
    decider: Option<InstanceId>,
}

/// What an axis will do next, see [`Axis::outlook`]; for searches over all reachable states.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Outlook {
    /// State of the axis.
    pub state: AxisState,
    /// `None` if the set-point follows the feedback, 0 if it holds, else one more than the scans to the goal.
    pub scans_left: Option<u32>,
    /// The owner: its number, what it does, and whether MC_Stop's Execute holds it.
    pub owner: Option<(CommandId, &'static str, bool)>,
    /// MC_Stop has come to rest and is held.
    pub stop_held: bool,
    /// Commands that wait, in order.
    pub waiting: [Option<(CommandId, &'static str)>; QUEUE_MAX],
    /// MC_Power.Enable.
    pub power_wanted: bool,
    /// Operation is enabled.
    pub power_on: bool,
    /// On the way to Disabled.
    pub going_off: bool,
    /// Power was lost and does not come back by itself.
    pub tripped: bool,
    /// The axis error.
    pub error: ErrorId,
    /// Its cause persists.
    pub cause_present: bool,
    /// A reset under way.
    pub reset: Option<CommandId>,
    /// MC_Home has been done.
    pub homed: bool,
    /// The last motion was in positive direction.
    pub forward: bool,
}

impl Outlook {
    /// Without command numbers, which only grow: those of different histories become comparable.
    pub fn without_numbers(mut self) -> Self {
        const NUMBERLESS: CommandId = CommandId(0);
        if let Some((id, ..)) = &mut self.owner {
            *id = NUMBERLESS;
        }
        for (id, _) in self.waiting.iter_mut().flatten() {
            *id = NUMBERLESS;
        }
        self.reset = self.reset.map(|_| NUMBERLESS);
        self
    }
}

/// One axis.
#[derive(Clone, Debug)]
pub struct Axis<P: Planner = Standard> {
    id: AxisId,
    config: AxisConfig,
    planner: P,
    state: AxisState,
    /// On a modulo axis its position may be some turns away from the one shown.
    setpoint: Setpoint,
    actual: f64,
    modulo: Option<Modulo>,
    feedback: DriveFeedback,
    motion: Motion<P::Plan>,
    /// Limits of the present motion, for whoever takes over from it.
    in_force: Limits,
    /// Sign of the last velocity that was not zero (mcCurrentDirection).
    last_direction: f64,
    owner: Option<Entry>,
    /// The owner is MC_Stop, stands, and is held by its Execute.
    stop_held: bool,
    queue: Queue,
    fates: Fates,
    last_id: u64,
    power: Power,
    error: ErrorId,
    error_code: u16,
    /// The cause of an axis fault persists.
    cause_present: bool,
    reset: Option<power::Reset>,
    homed: bool,
    rename: Option<f64>,
}

impl<P: Planner> Axis<P> {
    /// The axis `id`, set up as `config` says, moved by `planner`.
    ///
    /// # Errors
    /// [`ConfigError`] names the key that is not usable.
    pub fn new(id: AxisId, config: AxisConfig, planner: P) -> Result<Self, ConfigError> {
        config.check()?;
        let powered = config.start == StartState::Standstill;
        let feedback = DriveFeedback {
            enabled: powered,
            voltage: true,
            fault: None,
            position: position_at_drive(&config, config.position),
            comms: crate::Comms::Ok,
        };
        Ok(Self {
            id,
            config,
            planner,
            state: if powered {
                AxisState::Standstill
            } else {
                AxisState::Disabled
            },
            setpoint: Setpoint::at_rest(config.position),
            actual: config.position,
            modulo: Modulo::new(&config),
            feedback,
            motion: if powered { Motion::Hold } else { Motion::Follow },
            in_force: config.limits,
            last_direction: 1.0,
            owner: None,
            stop_held: false,
            queue: Queue::default(),
            fates: Fates::default(),
            last_id: 0,
            power: Power {
                wanted: powered,
                on: powered,
                going_off: false,
                tripped: false,
                asked: None,
                decider: None,
            },
            error: ErrorId::None,
            error_code: 0,
            cause_present: false,
            reset: None,
            homed: false,
            rename: None,
        })
    }

    /// Its handle.
    pub fn id(&self) -> AxisId {
        self.id
    }

    /// How it was set up.
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
            None => self.setpoint,
            Some(modulo) => modulo.shown(&self.setpoint),
        }
    }

    /// Actual position (u), as last latched.
    pub fn actual_position(&self) -> f64 {
        self.actual
    }

    /// Operation is enabled (MC_Power.Status).
    pub fn is_powered(&self) -> bool {
        self.power.on
    }

    /// MC_Home has been done.
    pub fn is_homed(&self) -> bool {
        self.homed
    }

    /// The axis error; `None` outside ErrorStop.
    pub fn error_id(&self) -> ErrorId {
        self.error
    }

    /// The drive's or fault's own code belonging to [`Axis::error_id`], 0 if none.
    pub fn error_code(&self) -> u16 {
        self.error_code
    }

    /// The plan in progress and the scans since its start.
    pub fn plan(&self) -> Option<(&P::Plan, u64)> {
        match &self.motion {
            Motion::Run { plan, elapsed } => Some((plan, *elapsed)),
            Motion::Follow | Motion::Hold => None,
        }
    }

    /// The command that owns the axis.
    pub fn active_command(&self) -> Option<CommandId> {
        self.owner.as_ref().map(|owner| owner.id)
    }

    /// Commands that wait.
    pub fn waiting(&self) -> usize {
        self.queue.len()
    }

    /// What became of command `id`. Bounded by the queue and the fates kept.
    #[inline]
    pub fn fate(&self, id: CommandId) -> Fate {
        if let Some(owner) = &self.owner
            && owner.id == id
        {
            return match owner.work {
                Work::Stop if self.stop_held => Fate::Done,
                Work::Velocity { .. } => Fate::Active {
                    reached: self.goal_reached(),
                },
                Work::Position(_) | Work::Distance(_) | Work::Halt | Work::Stop | Work::Home(_) => {
                    Fate::Active { reached: false }
                }
            };
        }
        if self.queue.contains(id) || self.reset.as_ref().is_some_and(|reset| reset.id == id) {
            return Fate::Waiting;
        }
        self.fates.find(id).unwrap_or(Fate::Failed(ErrorId::FateLost))
    }

    /// What the axis will do next: everything but positions, results of ended commands and the configuration.
    /// Two axes of equal outlook and set-point behave alike from now on.
    pub fn outlook(&self) -> Outlook {
        let mut waiting = [None; QUEUE_MAX];
        for (slot, entry) in waiting.iter_mut().zip(self.queue.iter()) {
            *slot = Some((entry.id, entry.work.kind()));
        }
        Outlook {
            state: self.state,
            scans_left: match &self.motion {
                Motion::Follow => None,
                Motion::Hold => Some(0),
                Motion::Run { plan, elapsed } => {
                    // At least 1, to tell a plan at its goal from holding.
                    let left = u64::from(plan.scans()).saturating_sub(*elapsed);
                    Some(u32::try_from(left).unwrap_or(u32::MAX).saturating_add(1))
                }
            },
            owner: self
                .owner
                .as_ref()
                .map(|owner| (owner.id, owner.work.kind(), owner.held)),
            stop_held: self.stop_held,
            waiting,
            power_wanted: self.power.wanted,
            power_on: self.power.on,
            going_off: self.power.going_off,
            tripped: self.power.tripped,
            error: self.error,
            cause_present: self.cause_present,
            reset: self.reset.as_ref().map(|reset| reset.id),
            homed: self.homed,
            forward: self.last_direction > 0.0,
        }
    }

    /// The drive's command for this scan.
    #[inline]
    pub fn drive_command(&mut self) -> DriveCommand {
        DriveCommand {
            request: self.drive_request(),
            position: match &self.modulo {
                None => position_at_drive(&self.config, self.setpoint.position),
                Some(modulo) => modulo.at_drive(&self.config, self.setpoint.position),
            },
            velocity: self.setpoint.velocity,
            rename: self
                .rename
                .take()
                .map(|position| position_at_drive(&self.config, position)),
        }
    }

    /// The running plan has reached its goal; a motion without a plan has.
    fn goal_reached(&self) -> bool {
        match &self.motion {
            Motion::Run { plan, elapsed } => *elapsed >= u64::from(plan.scans()),
            Motion::Hold => true,
            Motion::Follow => false,
        }
    }

    /// The one place where the state changes.
    fn enter(&mut self, event: AxisEvent) {
        match state::next(self.state, event) {
            Ok(next) => self.state = next,
            Err(_) => debug_assert!(false, "{:?} in {:?}", event, self.state),
        }
    }

    fn new_id(&mut self) -> CommandId {
        self.last_id = self.last_id.wrapping_add(1);
        CommandId(self.last_id)
    }

    /// Ends the owner and everything that waits.
    fn end_all(&mut self, owner: Fate, waiting: Fate) {
        self.end_owner(owner);
        // Bounded by QUEUE_MAX: each round takes one out.
        while let Some(entry) = self.queue.pop() {
            self.fates.record(entry.id, waiting);
        }
    }

    fn end_owner(&mut self, fate: Fate) {
        if let Some(owner) = self.owner.take() {
            // A stop that stands has completed, whatever ends its hold.
            let fate = if self.stop_held { Fate::Done } else { fate };
            self.fates.record(owner.id, fate);
        }
        self.stop_held = false;
    }

    fn record(&self, event: Event, source: Source, log: &mut Log) {
        log.push(Record {
            scan: source.scan,
            axis: self.id,
            instance: source.instance,
            event,
        });
    }
}

fn position_at_drive(config: &AxisConfig, position: f64) -> DrivePosition {
    match config.scaling {
        Some(scaling) => DrivePosition::Increments(scaling.to_increments(position)),
        None => DrivePosition::Units(position),
    }
}

//! Slaves with one master or two: MC_GearIn, MC_CombineAxes and MC_GearOut on the slave's side.
//!
//! In gear the set-point *is* the law, a function of the master's place in the same scan
//! ([`Gear`]). InGear is that state; positions are not compared. A slave that is not in
//! gear yet, or could not keep up, moves on plans of its own within its limits, in one of three ways (rungs): beside
//! the moving law, onto the law's next stretch of constant velocity, or as fast as possible. A command plans nothing
//! when it is accepted. The plan is made in the motion step, after that of the master, so that everything commanded
//! to the master in this scan counts.
//!
//! | file | subject |
//! | --- | --- |
//! | [`view`] | the values of its master that a slave may use |
//! | [`follow`] | the motion step of a slave |
//! | [`needs`] | the share of the limits that a step between two set-points needs |
//! | [`approach`] | the rungs: how a slave gets onto the law |
//! | [`bound`] | the part of its limits that slaves leave to their master |
//! | [`cam`] | the same on a cam, in a folder of its own |
//! | [`links`] | the place of an axis among masters and slaves |
//! | [`phasing`] | a shift of the master's place as the slave sees it |
//! | [`steady`] | the motion step in a scan in which nothing is new |
//! | [`sync`] | MC_GearInPos: a law given by sync positions, and a start that waits for a place of the master |
//!
//! Source: PLCopen Motion Control Part 1, MC_GearIn, MC_GearOut; V16, V18, V18b, V18d. docs/coupling.md states what
//! the standard leaves open.

mod approach;
mod bound;
mod cam;
mod follow;
mod links;
mod needs;
mod outside;
mod phasing;
mod steady;
mod sync;
mod view;

use super::commands::{Entry, Gearing, Leg, Sync, Work};
use super::{Axis, Motion};
use crate::{
    Approach, AxisId, BufferMode, CombineMode, CommandId, ErrorId, Event, Followed, QUEUE_MAX, Raw, Scope,
    SyncMode, SyncPoint, ValueSource,
};
use bound::Bound;
use cam::OnCam;
pub use cam::{CamFit, CamLaid};
pub(crate) use links::{Links, Turn};
use phasing::Phasing;
use standstill_planner::{Anchor, Gear, Limits, Place, Plan, Planner, Setpoint};
use steady::Steady;
use sync::Awaited;
pub(super) use view::Kind;
use view::SeenBoth;
pub(super) use view::way_to_rest;
pub(crate) use view::{Future, Part, Seen, View};

/// A master, and which of its values are followed.
pub(crate) type Values = (AxisId, ValueSource);

/// The largest position (u) of sync points and cams; beyond it numbers are too coarse.
const FURTHEST: f64 = 1e15;

/// How a slave that is not in gear gets into gear.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Rung {
    /// The next motion step decides.
    Due,
    /// It is in gear.
    Locked,
    /// A plan in the slave's own coordinates, to the velocity of the law or as fast as possible.
    Own,
    /// A plan beside the law through this anchor.
    BesideLaw(Anchor),
    /// The same beside a law whose future motion is not known, within this room.
    BesideMeasured { anchor: Anchor, room: Limits },
    /// The master went out of operation: the slave is at rest until a block couples it again.
    Lost,
    /// A plan beside a straight line, with the place of the line at the start and its velocity (u/s). The law joins
    /// the line this number of scans after the start of the plan.
    BesideLine { start: Place, velocity: f64, begin: u64 },
}

impl Rung {
    const fn is_locked(&self) -> bool {
        matches!(self, Self::Locked)
    }
}

/// How an axis follows its master, for traces.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupled {
    /// The master.
    pub master: AxisId,
    /// Set position less the position of the law (u); 0 in gear, and before it was in gear.
    pub deviation: f64,
    /// The phase shift: the slave sees the master this distance ahead of its real place (u of the master).
    pub phase: f64,
    /// The second master of MC_CombineAxes, and its phase shift.
    pub second: Option<(AxisId, f64)>,
    /// The superimposed distance since the law got its place (u).
    pub superimposed: f64,
    /// On a cam: the place of the slave on the curve as a place of the master (u of the master), if it is on the
    /// curve.
    pub shadow: Option<f64>,
}

/// How an axis follows others, and is followed.
#[derive(Clone, Debug)]
pub(super) struct Follower<Plan> {
    /// How the owner follows a master.
    coupling: Option<Coupling>,
    /// The same on a cam.
    on_cam: Option<OnCam>,
    /// The number of cam ends reached.
    cam_ends: u32,
    /// In its last step it was on its law, and the law was at rest.
    stands: bool,
    /// In its last step it was on its law, and its masters only trembled.
    trembles: bool,
    /// The phase shift between it and its master.
    phasing: Phasing<Plan>,
    /// The command that waits for a place of a master.
    awaited: Option<Awaited>,
    /// The part of its limits that its slaves leave.
    bound: Bound,
    /// Whether anything is new, if some axis may follow another.
    steady: Steady,
}

impl<P: Plan> Default for Follower<P> {
    fn default() -> Self {
        Self {
            coupling: None,
            on_cam: None,
            cam_ends: 0,
            stands: false,
            trembles: false,
            phasing: Phasing::default(),
            awaited: None,
            bound: Bound::default(),
            steady: Steady::default(),
        }
    }
}

/// The part of the last owner's coupling that a command continues.
#[derive(Clone, Debug)]
pub(super) struct Kept<Plan> {
    coupling: Option<Coupling>,
    phasing: Phasing<Plan>,
    awaited: Option<Awaited>,
}

/// The names of the pins for one master.
struct LegPins {
    master: &'static str,
    numerator: &'static str,
    denominator: &'static str,
    source: &'static str,
}

const GEAR_PINS: LegPins = LegPins {
    master: "Master",
    numerator: "RatioNumerator",
    denominator: "RatioDenominator",
    source: "MasterValueSource",
};

const COMBINED_PINS: [LegPins; 2] = [
    LegPins {
        master: "Master1",
        numerator: "GearRatioNumeratorM1",
        denominator: "GearRatioDenominatorM1",
        source: "MasterValueSourceM1",
    },
    LegPins {
        master: "Master2",
        numerator: "GearRatioNumeratorM2",
        denominator: "GearRatioDenominatorM2",
        source: "MasterValueSourceM2",
    },
];

/// How the owner follows its master, or its two masters.
#[derive(Clone, Copy, Debug)]
struct Coupling {
    gearing: Gearing,
    /// The place of the law: the first place of the slave in gear, or the given place.
    anchor: Option<Anchor>,
    /// It has been in gear.
    was_in_gear: bool,
    /// It was in gear when the same gear was commanded again, and no motion step has followed yet.
    is_kept: bool,
    /// It is in time for its sync point only if it moves back to meet the law.
    goes_back: bool,
    rung: Rung,
    /// The masters at the end of the last scan, in their present coordinates.
    was: SeenBoth,
    /// The known part of their future motion.
    known: view::Known,
    /// Scans until the way onto the law is searched again; the largest number for never.
    left: u64,
    /// The approach recorded last, and its velocity (u/s).
    told: Option<(Approach, f64)>,
    /// The position to which the masters lead it (u), if that is outside its software limits.
    leads_outside: Option<f64>,
    /// The limits that its way was last checked against.
    limits: Limits,
    /// The number of shifts of the slave's own coordinates.
    moves: u32,
    /// The distance of the slave from the law (u); 0 in gear, and before it was in gear.
    deviation: f64,
    /// Its master is slowed down to keep the limits of the slave.
    slows: bool,
    /// The distance superimposed on the law, less the place of the layer that is added to it (u).
    lead: f64,
}

impl Gearing {
    pub(super) fn legs(&self) -> [Option<Leg>; 2] {
        [Some(self.first), self.second]
    }

    /// The masters.
    pub(super) fn masters(&self) -> [Option<AxisId>; 2] {
        self.legs().map(|leg| leg.map(|leg| leg.master))
    }

    /// The masters, and the values of each that are followed.
    fn values(&self) -> [Option<Values>; 2] {
        self.legs().map(|leg| leg.map(|leg| (leg.master, leg.source)))
    }

    /// The place of the slave for the given masters.
    pub(super) fn slave(&self, anchor: &Anchor, masters: [Place; 2]) -> Place {
        let gear = &self.first.gear;
        match &self.second {
            None => gear.slave(anchor, masters[0]),
            Some(second) => gear.slave_of_two(&second.gear, anchor, masters),
        }
    }

    /// The slave's derivative for given derivatives of the masters.
    pub(super) fn derivative(&self, of_masters: [f64; 2]) -> f64 {
        let first = self.first.gear.derivative(of_masters[0]);
        match &self.second {
            None => first,
            Some(second) => first + second.gear.derivative(of_masters[1]),
        }
    }

    /// The factor from a derivative of master number `leg` to its part of the slave's derivative, multiplied by `by`.
    pub(super) fn factor(&self, leg: usize, by: f64) -> f64 {
        match (&self.second, leg) {
            (_, 0) => self.first.gear.derivative(by),
            (Some(second), _) => second.gear.derivative(by),
            (None, _) => 0.0,
        }
    }
}

impl Coupling {
    /// From now on added distances move the law, from its present place. The layer is at `place` (u).
    pub(super) fn lay_layer(&mut self, place: f64) {
        self.lead = self.superimposed() - place;
    }

    /// The distance superimposed on the law (u).
    fn superimposed(&self) -> f64 {
        self.anchor.map_or(0.0, |anchor| anchor.slave.phase)
    }

    /// Whether it has a sync point and must not be faster than at that point.
    fn goes_slowly(&self) -> bool {
        let slow = |sync: Sync| sync.mode == SyncMode::SlowDown;
        self.gearing.sync.is_some_and(slow)
    }

    /// Whether it is on the way to a given sync point.
    fn is_syncing(&self) -> bool {
        self.gearing.sync.is_some() && !self.was_in_gear
    }

    /// Whether it waits for the law when it is ahead of it, and does not move back to meet it.
    fn waits_ahead(&self) -> bool {
        self.is_syncing() && !self.goes_back
    }

    fn new(gearing: Gearing, limits: Limits, moves: u32) -> Self {
        Self {
            gearing,
            anchor: None,
            was_in_gear: false,
            is_kept: false,
            goes_back: false,
            rung: Rung::Due,
            was: SeenBoth::default(),
            known: view::Known::default(),
            left: u64::MAX,
            told: None,
            leads_outside: None,
            limits,
            moves,
            deviation: 0.0,
            slows: false,
            lead: 0.0,
        }
    }
}

impl<P: Planner> Axis<P> {
    /// How the owner follows its masters in a gear.
    #[inline]
    fn coupling(&self) -> Option<&Coupling> {
        self.follower.coupling.as_ref()
    }

    /// How the owner follows its master on a cam.
    #[inline]
    fn on_cam(&self) -> Option<&OnCam> {
        self.follower.on_cam.as_ref()
    }

    /// Whether the owner follows a master.
    #[inline]
    pub(super) fn is_coupled(&self) -> bool {
        self.follower.coupling.is_some()
    }

    /// Whether the set-point published last is that of the law, and the slave stays in gear.
    #[inline]
    pub fn is_in_gear(&self) -> bool {
        let is_locked = |coupling: &Coupling| coupling.rung.is_locked();
        let is_locked = self.coupling().is_some_and(is_locked);
        (is_locked || self.is_in_sync_on_cam()) && !self.is_paused()
    }

    /// How the owner follows its master; `None` while it follows none.
    pub fn coupled(&self) -> Option<Coupled> {
        let on_cam = self.coupled_on_cam();
        let gear = self.coupling().map(|coupling| Coupled {
            master: coupling.gearing.first.master,
            deviation: coupling.deviation,
            phase: self.phases()[0],
            second: coupling
                .gearing
                .second
                .map(|second| (second.master, self.phases()[1])),
            superimposed: coupling.superimposed(),
            shadow: None,
        });
        gear.or(on_cam)
    }

    /// The master the owner follows, the first one of two.
    pub fn master(&self) -> Option<AxisId> {
        self.followed()[0]
    }

    /// The masters the owner follows.
    pub fn followed(&self) -> [Option<AxisId>; 2] {
        let coupling = self.coupling();
        coupling.map_or([self.master_on_cam(), None], |coupling| {
            coupling.gearing.masters()
        })
    }

    /// The masters the owner follows, and which values of each.
    pub(crate) fn followed_values(&self) -> [Option<Values>; 2] {
        let coupling = self.coupling();
        let on_cam = [self.values_on_cam(), None];
        coupling.map_or(on_cam, |coupling| coupling.gearing.values())
    }

    /// Whether the owner follows actual values of a master instead of its set position.
    pub fn follows_actual(&self) -> bool {
        let is_actual = |(_, source): Values| source == ValueSource::Actual;
        let [first, second] = self.followed_values();
        first.is_some_and(is_actual) || second.is_some_and(is_actual)
    }

    /// The masters the owner follows, each with its ratio. The numerator is also negative if the master's motion is
    /// subtracted.
    pub fn gears(&self) -> [Option<(AxisId, i32, u16)>; 2] {
        let Some(coupling) = &self.follower.coupling else {
            return [None; 2];
        };
        let ratio = |leg: Leg| {
            let (numerator, denominator) = leg.gear.ratio();
            (leg.master, numerator, denominator)
        };
        coupling.gearing.legs().map(|leg| leg.map(ratio))
    }

    /// Whether the master went out of operation. The slave is then at rest until a block couples it again.
    pub fn has_lost_master(&self) -> bool {
        matches!(self.rung(), Some(Rung::Lost)) || self.has_lost_master_on_cam()
    }

    /// Whether it is on the way to the given sync point.
    pub fn is_syncing(&self) -> bool {
        self.coupling().is_some_and(Coupling::is_syncing)
    }

    /// The distance of a slave from the law of its gear (u). It is 0 in gear, before it was in gear
    /// without a sync point, and for any other axis.
    pub fn deviation(&self) -> f64 {
        let on_cam = self.deviation_on_cam();
        self.coupling().map_or(on_cam, |coupling| coupling.deviation)
    }

    /// Checks the pins of MC_GearIn and MC_GearInPos that define the law.
    pub(super) fn check_gear(
        &self,
        followed: &Followed,
        sync: Option<SyncPoint>,
        scope: &mut Scope<'_>,
    ) -> Result<Gearing, ErrorId> {
        let first = self.check_leg(followed, &GEAR_PINS, scope)?;
        let sync = match sync {
            Some(point) => Some(self.check_sync(&point, followed.master.turn, scope)?),
            None => None,
        };
        Ok(Gearing {
            first,
            second: None,
            sync,
        })
    }

    /// Checks the pins of MC_CombineAxes.
    pub(super) fn check_combination(
        &self,
        masters: &[Followed; 2],
        mode: Raw<CombineMode>,
        scope: &mut Scope<'_>,
    ) -> Result<Gearing, ErrorId> {
        let first = self.check_leg(&masters[0], &COMBINED_PINS[0], scope)?;
        let mut second = self.check_leg(&masters[1], &COMBINED_PINS[1], scope)?;
        match self.element("CombineMode", mode, ErrorId::SyncModeInvalid, scope)? {
            CombineMode::Add => {}
            CombineMode::Subtract => second.gear = second.gear.reversed(),
        }
        Ok(Gearing {
            first,
            second: Some(second),
            sync: None,
        })
    }

    /// Checks the pins for one master.
    fn check_leg(&self, followed: &Followed, pins: &LegPins, scope: &mut Scope<'_>) -> Result<Leg, ErrorId> {
        let Followed {
            master,
            numerator,
            denominator,
            source,
        } = *followed;
        self.check_master(pins.master, master.axis, scope)?;
        let Some(positive) = u16::try_from(denominator).ok().filter(|value| *value > 0) else {
            let denominator = f64::from(denominator);
            return Err(self.refuse(pins.denominator, denominator, 1.0, ErrorId::RatioInvalid, scope));
        };
        let source = self.check_source(pins.source, source, scope)?;
        let turn = self.config.modulo;
        let Some(gear) = Gear::new(numerator, positive, master.turn, turn) else {
            let [up, down] = Gear::largest_ratio(master.turn.unwrap_or_default(), turn.unwrap_or_default());
            let (numerator, denominator) = (f64::from(numerator), f64::from(positive));
            let (pin, value, limit) = if numerator.abs() > up {
                (pins.numerator, numerator, up)
            } else {
                (pins.denominator, denominator, down)
            };
            return Err(self.refuse(pin, value, limit, ErrorId::CouplingRatioTooFine, scope));
        };
        Ok(Leg {
            master: master.axis,
            source,
            gear,
        })
    }

    /// Checks that a master is another axis.
    fn check_master(&self, pin: &'static str, master: AxisId, scope: &mut Scope<'_>) -> Result<(), ErrorId> {
        if master != self.id {
            return Ok(());
        }
        let number = f64::from(master.number());
        Err(self.refuse(pin, number, f64::NAN, ErrorId::CouplingRing, scope))
    }

    /// Checks which values of a master are followed.
    fn check_source(
        &self,
        pin: &'static str,
        source: Raw<ValueSource>,
        scope: &mut Scope<'_>,
    ) -> Result<ValueSource, ErrorId> {
        let (most, error) = match source.get() {
            Some(source @ (ValueSource::Set | ValueSource::Actual)) => return Ok(source),
            Some(ValueSource::Commanded) => (1.0, ErrorId::MasterSourceInvalid),
            None => (2.0, ErrorId::SourceInvalid),
        };
        Err(self.refuse(pin, f64::from(source.number()), most, error, scope))
    }

    /// MC_GearOut: continues at the velocity that is left once acceleration and jerk are 0.
    pub(super) fn release(&self) -> (Work, Limits) {
        let limits = self.slowed(&self.parameters.limits);
        let velocity = if self.is_paused() {
            0.0
        } else {
            self.planner.coasting(self.mover.setpoint(), &limits)
        };
        (Work::Release(velocity), limits)
    }

    /// A motion that followed its master until now continues at the velocity that is left once acceleration and jerk
    /// are 0.
    pub(super) fn go_on_alone(&mut self, before: &Limits) {
        if !matches!(self.mover.motion(), Motion::Geared | Motion::Closing { .. }) {
            return;
        }
        let limits = self.slowed(&self.parameters.limits);
        let velocity = self.planner.coasting(self.mover.setpoint(), &limits);
        let ramp = self
            .planner
            .ramp_to(self.mover.setpoint(), velocity, &limits, before);
        self.mover.go_on(ramp.map_or(Motion::Hold, Motion::along));
    }

    /// Whether MC_GearOut is done: a motion step has passed without the master.
    #[inline]
    pub(super) fn is_released(&self, owner: &Entry) -> bool {
        matches!(owner.work, Work::Release(_))
            && !matches!(self.mover.motion(), Motion::Run { elapsed: 0, .. })
    }

    /// The motion of `entry` until the next motion step chooses another one.
    ///
    /// # Errors
    /// The reason why it cannot follow its master, or that the axis is outside its software limits.
    pub(super) fn gear_motion(&self, entry: &Entry, start: &Setpoint) -> Result<Motion<P::Plan>, ErrorId> {
        if let Some(error) = entry.barred {
            return Err(error);
        }
        self.allowed(start.position)?;
        Ok(Motion::Geared)
    }

    /// The present coupling, if `entry` continues it: the same gear to the same master, in gear.
    fn coupling_kept(&self, entry: &Entry) -> Option<Coupling> {
        let kept = self.follower.coupling.filter(|coupling| {
            let is_in_gear = coupling.rung.is_locked() || coupling.is_kept;
            is_in_gear && Work::Gear(coupling.gearing) == entry.work && !self.is_paused()
        });
        kept.map(|coupling| Coupling {
            rung: Rung::Due,
            is_kept: true,
            ..coupling
        })
    }

    /// The part of the present owner's coupling that `entry`, which takes over now, continues; `None` if the owner
    /// does not follow and no command waits for its start point. A command that waits for its start point is kept
    /// unless `entry` aborts.
    pub(super) fn lend_following(&mut self, entry: &Entry, mode: BufferMode) -> Option<Kept<P::Plan>> {
        let follows = self.follows() || self.follower.awaited.is_some();
        follows.then(|| Kept {
            coupling: self.coupling_kept(entry),
            phasing: self.lend_phasing(entry),
            awaited: self.follower.awaited.take_if(|_| mode != BufferMode::Aborting),
        })
    }

    /// The last owner has ended; its coupling continues as `kept`.
    pub(super) fn keep_following(&mut self, kept: Option<Kept<P::Plan>>) {
        debug_assert!(self.follows() || self.follower.phasing.is_none());
        if let Some(kept) = kept {
            self.follower.coupling = kept.coupling;
            self.follower.phasing = kept.phasing;
            self.follower.awaited = kept.awaited;
        }
    }

    /// Ends the coupling.
    pub(super) fn end_coupling(&mut self) {
        let was_behind_gear = self.follower.coupling.take().is_some();
        if self.follower.on_cam.take().is_some() || was_behind_gear {
            self.end_phasing();
        }
    }

    /// A distance is added from the place (u) `added` of its layer: the law counts from there.
    pub(super) fn lay_layer_on_law(&mut self, added: f64) {
        if let Some(coupling) = &mut self.follower.coupling {
            coupling.lay_layer(added);
        }
        self.lay_layer_on_cam(added);
    }

    /// The command that waits for a place of its master while another one owns the axis (MC_GearInPos
    /// before its start point).
    pub fn awaited_command(&self) -> Option<CommandId> {
        let awaited = self.follower.awaited.as_ref();
        awaited.map(|awaited| awaited.entry.id)
    }

    /// `entry` follows a master from the next motion step on, or has new values for it.
    pub(super) fn await_master(&mut self, entry: &Entry, scope: &mut Scope<'_>) {
        if let Work::Cam(camming) = entry.work {
            return self.await_master_on_cam(camming, entry, scope);
        }
        let Work::Gear(gearing) = entry.work else { return };
        self.links.set_bound(true);
        let known = self.coupling().map(|coupling| coupling.gearing);
        if known != Some(gearing) {
            for leg in gearing.legs().into_iter().flatten() {
                let (numerator, denominator) = leg.gear.ratio();
                let event = Event::Coupled {
                    master: leg.master,
                    numerator,
                    denominator,
                };
                self.record(event, &mut scope.with(entry.instance));
            }
        }
        let (limits, moves) = (self.slowed(&self.parameters.limits), self.frame.moves());
        let coupling = self
            .follower
            .coupling
            .get_or_insert_with(|| Coupling::new(gearing, limits, moves));
        let is_new = coupling.gearing != gearing;
        if is_new {
            coupling.gearing = gearing;
            coupling.anchor = None;
            coupling.was_in_gear = false;
            coupling.is_kept = false;
            coupling.goes_back = false;
            coupling.deviation = 0.0;
        }
        // After the master is lost, another ratio must not start a motion.
        if coupling.rung != Rung::Lost && (is_new || !coupling.rung.is_locked()) {
            coupling.rung = Rung::Due;
        }
        self.end_routine();
    }

    /// The motion leaves the law for some time. The way onto it is searched once the motion may continue.
    pub(super) fn leave_law(&mut self) {
        if let Some(coupling) = &mut self.follower.coupling {
            coupling.rung = Rung::Due;
            coupling.told = None;
        }
        self.leave_cam();
    }

    /// Its place among axes that follow each other.
    #[inline]
    pub(crate) fn links(&self) -> &Links {
        &self.links
    }

    pub(crate) fn links_mut(&mut self) -> &mut Links {
        &mut self.links
    }

    /// The masters it follows, and those whose place a command of it waits for.
    pub(crate) fn masters(&self) -> impl Iterator<Item = AxisId> + use<P> {
        let [first, second] = self.followed();
        [first, second, self.awaited_master()].into_iter().flatten()
    }

    /// Notes a waiting command, which may follow a master.
    pub(super) fn note_bound(&mut self, entry: &Entry) {
        self.unsettle();
        if matches!(entry.work, Work::Gear(_) | Work::Cam(_)) {
            self.links.set_bound(true);
        }
    }

    /// Finds again whether the owner, or a waiting command, may follow a master. Returns whether a waiting one may.
    pub(crate) fn renew_bound(&mut self) -> bool {
        let couples = |entry: &Entry| matches!(entry.work, Work::Gear(_) | Work::Cam(_));
        let waits = !self.queue.is_empty() && self.queue.iter().any(couples);
        let is_bound = self.is_coupled() || self.is_on_cam() || self.follower.awaited.is_some() || waits;
        self.links.set_bound(is_bound);
        waits
    }

    /// The masters of commands that wait, in order.
    pub(crate) fn masters_of_waiting(&self) -> [[Option<Values>; 2]; QUEUE_MAX] {
        let mut masters = [[None; 2]; QUEUE_MAX];
        for (masters, entry) in masters.iter_mut().zip(self.queue.iter()) {
            match entry.work {
                Work::Gear(gearing) => *masters = gearing.values(),
                Work::Cam(camming) => *masters = [Some((camming.master, camming.source)), None],
                _ => {}
            }
        }
        masters
    }

    /// Sets for each waiting command the reason why it can't follow its master now.
    pub(crate) fn bar_waiting(&mut self, barred: &[Option<ErrorId>; QUEUE_MAX]) {
        for (entry, error) in self.queue.iter_mut().zip(barred) {
            entry.barred = *error;
        }
    }

    /// Records that the slave is in gear from now on.
    fn record_in_gear(&self, scope: &mut Scope<'_>) {
        self.record(Event::InGear, &mut self.owner_scope(scope));
    }
}

//! Behind a master, or two: MC_GearIn, MC_CombineAxes and MC_GearOut on the slave's side.
//!
//! Once in gear the set-point *is* the law, a function of the master's place in the same scan
//! ([`Gear`](standstill_planner::Gear)); InGear is that state and no comparison. Until then, and after the slave could not
//! keep up, it moves on plans of its own within its limits, in one of three ways (rungs): beside the moving law, onto the next
//! stretch of constant velocity of it, or as fast as it may. Nothing is planned when a command is taken: in the motion step the
//! master has moved already, and whatever was commanded to it in this scan counts.
//!
//! | file | subject |
//! | --- | --- |
//! | [`view`] | what a slave may know of its master |
//! | [`follow`] | the motion step of a slave |
//! | [`needs`] | what a step from one set-point to the next needs of the limits |
//! | [`approach`] | the rungs: how a slave comes onto the law |
//! | [`bound`] | what the limits of slaves leave to their master |
//! | [`cam`] | the same on a cam, in a folder of its own |
//! | [`links`] | the place of an axis among masters and slaves |
//! | [`phasing`] | a shift between the master and what the slave sees of it |
//! | [`steady`] | the same in a scan in which nothing is new |
//! | [`sync`] | MC_GearInPos: a law that is given, and a start that waits for a place of the master |
//!
//! Source: PLCopen Motion Control Part 1, MC_GearIn, MC_GearOut; V16, V18, V18b, V18d. What the standard leaves open is told in
//! docs/coupling.md.

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
    Approach, AxisId, CombineMode, ErrorId, Event, Followed, QUEUE_MAX, Raw, Scope, SyncMode, SyncPoint,
    ValueSource,
};
pub(super) use bound::Bound;
pub(super) use cam::OnCam;
pub use cam::{CamFit, CamLaid};
pub(crate) use links::{Links, Turn};
pub(super) use phasing::Phasing;
use standstill_planner::{Anchor, Gear, Limits, Place, Planner, Setpoint};
pub(super) use steady::Steady;
pub(super) use sync::Awaited;
pub(super) use view::Kind;
use view::SeenBoth;
pub(crate) use view::{Future, Part, Seen, View};
pub(super) use view::{end_of, way_to_rest};

/// A master, and which of its values are followed.
pub(crate) type Values = (AxisId, ValueSource);

/// Places further from 0 than this (u) are no sync points and have no cam: numbers tell them too coarsely.
const FURTHEST: f64 = 1e15;

/// How a slave that is not in gear comes there.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Rung {
    /// The next motion step decides.
    Due,
    /// It is in gear.
    Locked,
    /// A plan in the slave's own coordinates, to the velocity of the law or as fast as it may.
    Own,
    /// A plan beside the law through this anchor.
    BesideLaw(Anchor),
    /// The same beside the law of measured values, within this room.
    BesideMeasured { anchor: Anchor, room: Limits },
    /// The master went out of operation: the slave rests until a block couples it anew.
    Lost,
    /// A plan beside a straight line, onto which the law leads in so many scans from the start of the plan: its place then and
    /// its velocity (u/s).
    BesideLine { start: Place, velocity: f64, begin: u64 },
}

impl Rung {
    const fn is_locked(&self) -> bool {
        matches!(self, Self::Locked)
    }
}

/// How an axis follows its master: what a trace shows of it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Coupled {
    /// The master.
    pub master: AxisId,
    /// Set position less that of the law (u); 0 in gear, and before it was there.
    pub deviation: f64,
    /// By how much the master is seen further on than it is (u of the master).
    pub phase: f64,
    /// The second master of MC_CombineAxes, and by how much that is seen further on.
    pub second: Option<(AxisId, f64)>,
    /// What was superimposed on the law since it lies where it does (u).
    pub superimposed: f64,
    /// On a cam: the place of the master the slave is at (u of the master), if it is on the curve.
    pub shadow: Option<f64>,
}

/// The names of the pins that say how a master is followed.
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
pub(super) struct Coupling {
    gearing: Gearing,
    /// Where the law lies: where the slave was in gear first, or as given.
    anchor: Option<Anchor>,
    /// It has been in gear.
    was_in_gear: bool,
    /// It was in gear when the same gear was commanded once more, and no motion step has been since.
    is_kept: bool,
    rung: Rung,
    /// The masters at the end of the scan before, in their coordinates of now.
    was: SeenBoth,
    /// What was known of their way ahead.
    known: view::Known,
    /// Scans until the way onto the law is looked for again; the largest number for never.
    left: u64,
    /// The way recorded last, and its velocity (u/s).
    told: Option<(Approach, f64)>,
    /// Where the masters lead it (u), if that is outside its software limits.
    leads_outside: Option<f64>,
    /// The limits it was last held against.
    limits: Limits,
    /// How often the slave's own coordinates had moved.
    moves: u32,
    /// By how much the slave is off the law (u); 0 in gear, and before it was there.
    deviation: f64,
    /// Its master keeps the limits of the slave.
    slows: bool,
    /// What was superimposed on the law, less the place of the layer that is added to it (u).
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

    /// The masters, and which values of each are followed.
    fn values(&self) -> [Option<Values>; 2] {
        self.legs().map(|leg| leg.map(|leg| (leg.master, leg.source)))
    }

    /// Where the slave is for masters that are there.
    pub(super) fn slave(&self, anchor: &Anchor, masters: [Place; 2]) -> Place {
        let gear = &self.first.gear;
        match &self.second {
            None => gear.slave(anchor, masters[0]),
            Some(second) => gear.slave_of_two(&second.gear, anchor, masters),
        }
    }

    /// The slave's derivative for those of the masters.
    pub(super) fn derivative(&self, of_masters: [f64; 2]) -> f64 {
        let first = self.first.gear.derivative(of_masters[0]);
        match &self.second {
            None => first,
            Some(second) => first + second.gear.derivative(of_masters[1]),
        }
    }

    /// What a derivative of the master of this number is multiplied by to be its part of that of the slave; `by` comes before.
    pub(super) fn factor(&self, leg: usize, by: f64) -> f64 {
        match (&self.second, leg) {
            (_, 0) => self.first.gear.derivative(by),
            (Some(second), _) => second.gear.derivative(by),
            (None, _) => 0.0,
        }
    }
}

impl Coupling {
    /// What is added from now on moves the law on from where it is: the layer is at `place` (u).
    pub(super) fn lay_layer(&mut self, place: f64) {
        self.lead = self.superimposed() - place;
    }

    /// What was superimposed on the law (u).
    fn superimposed(&self) -> f64 {
        self.anchor.map_or(0.0, |anchor| anchor.slave.phase)
    }

    /// It is given a sync point, and not to be faster than there.
    fn goes_slowly(&self) -> bool {
        let slow = |sync: Sync| sync.mode == SyncMode::SlowDown;
        self.gearing.sync.is_some_and(slow)
    }

    /// On the way to a sync point that was given.
    fn is_syncing(&self) -> bool {
        self.gearing.sync.is_some() && !self.was_in_gear
    }

    fn new(gearing: Gearing, limits: Limits, moves: u32) -> Self {
        Self {
            gearing,
            anchor: None,
            was_in_gear: false,
            is_kept: false,
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
    /// The owner follows a master.
    #[inline]
    pub(super) fn is_coupled(&self) -> bool {
        self.coupling.is_some()
    }

    /// The set-point published last is that of the law, and it stays so.
    #[inline]
    pub fn is_in_gear(&self) -> bool {
        let is_locked = |coupling: &Coupling| coupling.rung.is_locked();
        let is_locked = self.coupling.as_ref().is_some_and(is_locked);
        (is_locked || self.is_in_sync_on_cam()) && !self.is_paused()
    }

    /// How the owner follows its master; `None` while it follows none.
    pub fn coupled(&self) -> Option<Coupled> {
        let on_cam = self.coupled_on_cam();
        let gear = self.coupling.as_ref().map(|coupling| Coupled {
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
        let coupling = self.coupling.as_ref();
        coupling.map_or([self.master_on_cam(), None], |coupling| {
            coupling.gearing.masters()
        })
    }

    /// The masters the owner follows, and which values of each.
    pub(crate) fn followed_values(&self) -> [Option<Values>; 2] {
        let coupling = self.coupling.as_ref();
        let on_cam = [self.values_on_cam(), None];
        coupling.map_or(on_cam, |coupling| coupling.gearing.values())
    }

    /// The owner follows actual values of a master, not where that is to be.
    pub fn follows_actual(&self) -> bool {
        let is_actual = |(_, source): Values| source == ValueSource::Actual;
        let [first, second] = self.followed_values();
        first.is_some_and(is_actual) || second.is_some_and(is_actual)
    }

    /// The masters the owner follows, each with its ratio: numerator, below 0 also where its way is taken away, and denominator.
    pub fn gears(&self) -> [Option<(AxisId, i32, u16)>; 2] {
        let Some(coupling) = &self.coupling else {
            return [None; 2];
        };
        let ratio = |leg: Leg| {
            let (numerator, denominator) = leg.gear.ratio();
            (leg.master, numerator, denominator)
        };
        coupling.gearing.legs().map(|leg| leg.map(ratio))
    }

    /// The master went out of operation, and the slave rests until a block couples it anew.
    pub fn has_lost_master(&self) -> bool {
        matches!(self.rung(), Some(Rung::Lost)) || self.has_lost_master_on_cam()
    }

    /// On the way to the sync point it was given, and not there yet.
    pub fn is_syncing(&self) -> bool {
        self.coupling.as_ref().is_some_and(Coupling::is_syncing)
    }

    /// By how much a slave is off the law of its gear (u); 0 in gear, before it was there without a sync point, and for any
    /// other axis.
    pub fn deviation(&self) -> f64 {
        let on_cam = self.deviation_on_cam();
        self.coupling
            .as_ref()
            .map_or(on_cam, |coupling| coupling.deviation)
    }

    /// The values at the pins of MC_GearIn and MC_GearInPos that say which law holds.
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

    /// The values at the pins of MC_CombineAxes.
    pub(super) fn check_combination(
        &self,
        masters: &[Followed; 2],
        mode: Raw<CombineMode>,
        scope: &mut Scope<'_>,
    ) -> Result<Gearing, ErrorId> {
        let first = self.check_leg(&masters[0], &COMBINED_PINS[0], scope)?;
        let mut second = self.check_leg(&masters[1], &COMBINED_PINS[1], scope)?;
        match mode.get() {
            Some(CombineMode::Add) => {}
            Some(CombineMode::Subtract) => second.gear = second.gear.reversed(),
            None => {
                let number = f64::from(mode.number());
                return Err(self.refuse("CombineMode", number, 1.0, ErrorId::SyncModeInvalid, scope));
            }
        }
        Ok(Gearing {
            first,
            second: Some(second),
            sync: None,
        })
    }

    /// The values at the pins for one master.
    fn check_leg(&self, followed: &Followed, pins: &LegPins, scope: &mut Scope<'_>) -> Result<Leg, ErrorId> {
        let Followed {
            master,
            numerator,
            denominator,
            source,
        } = *followed;
        let mut refuse = |pin, value: f64, limit, error| Err(self.refuse(pin, value, limit, error, scope));
        if master.axis == self.id {
            let number = f64::from(master.axis.number());
            return refuse(pins.master, number, f64::NAN, ErrorId::CouplingRing);
        }
        let Some(positive) = u16::try_from(denominator).ok().filter(|value| *value > 0) else {
            let denominator = f64::from(denominator);
            return refuse(pins.denominator, denominator, 1.0, ErrorId::RatioInvalid);
        };
        let number = f64::from(source.number());
        let source = match source.get() {
            Some(source @ (ValueSource::Set | ValueSource::Actual)) => source,
            Some(ValueSource::Commanded) => {
                return refuse(pins.source, number, 1.0, ErrorId::MasterSourceInvalid);
            }
            None => return refuse(pins.source, number, 2.0, ErrorId::SourceInvalid),
        };
        let turn = self.modulo.as_ref().map(|modulo| modulo.length);
        let Some(gear) = Gear::new(numerator, positive, master.turn, turn) else {
            let [up, down] = Gear::largest_ratio(master.turn.unwrap_or_default(), turn.unwrap_or_default());
            let (numerator, denominator) = (f64::from(numerator), f64::from(positive));
            let (pin, value, limit) = if numerator.abs() > up {
                (pins.numerator, numerator, up)
            } else {
                (pins.denominator, denominator, down)
            };
            return refuse(pin, value, limit, ErrorId::CouplingRatioTooFine);
        };
        Ok(Leg {
            master: master.axis,
            source,
            gear,
        })
    }

    /// MC_GearOut: on with the velocity that is left when acceleration and jerk are gone.
    pub(super) fn release(&self) -> (Work, Limits) {
        let limits = self.slowed(&self.parameters.limits);
        let velocity = if self.is_paused() {
            0.0
        } else {
            self.planner.coasting(&self.setpoint, &limits)
        };
        (Work::Release(velocity), limits)
    }

    /// What moved behind its master until now goes on with the velocity that is left when acceleration and jerk are gone.
    pub(super) fn go_on_alone(&mut self, before: &Limits) {
        if !matches!(self.motion, Motion::Geared | Motion::Closing { .. }) {
            return;
        }
        let limits = self.slowed(&self.parameters.limits);
        let velocity = self.planner.coasting(&self.setpoint, &limits);
        let ramp = self.planner.ramp_to(&self.setpoint, velocity, &limits, before);
        self.motion = ramp.map_or(Motion::Hold, Motion::along);
    }

    /// MC_GearOut is done: a motion step has gone by without the master.
    #[inline]
    pub(super) fn is_released(&self, owner: &Entry) -> bool {
        matches!(owner.work, Work::Release(_)) && !matches!(self.motion, Motion::Run { elapsed: 0, .. })
    }

    /// The motion of `entry` until the next motion step finds one.
    ///
    /// # Errors
    /// Why it can't go behind its master, or that the axis stands outside its software limits.
    pub(super) fn gear_motion(&self, entry: &Entry, start: &Setpoint) -> Result<Motion<P::Plan>, ErrorId> {
        if let Some(error) = entry.barred {
            return Err(error);
        }
        self.allowed(start.position)?;
        Ok(Motion::Geared)
    }

    /// The present coupling, if `entry` is to go on in it: the same gear to the same master, in gear.
    pub(super) fn coupling_kept(&self, entry: &Entry) -> Option<Coupling> {
        let kept = self.coupling.filter(|coupling| {
            let is_in_gear = coupling.rung.is_locked() || coupling.is_kept;
            is_in_gear && Work::Gear(coupling.gearing) == entry.work && !self.is_paused()
        });
        kept.map(|coupling| Coupling {
            rung: Rung::Due,
            is_kept: true,
            ..coupling
        })
    }

    /// `entry` follows a master from the next motion step on, or has new values for it.
    pub(super) fn await_master(&mut self, entry: &Entry, scope: &mut Scope<'_>) {
        if let Work::Cam(camming) = entry.work {
            return self.await_master_on_cam(camming, entry, scope);
        }
        let Work::Gear(gearing) = entry.work else { return };
        self.links.set_bound(true);
        let known = self.coupling.as_ref().map(|coupling| coupling.gearing);
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
            .coupling
            .get_or_insert_with(|| Coupling::new(gearing, limits, moves));
        let is_new = coupling.gearing != gearing;
        if is_new {
            coupling.gearing = gearing;
            coupling.anchor = None;
            coupling.was_in_gear = false;
            coupling.is_kept = false;
            coupling.deviation = 0.0;
        }
        // Where the master was lost another ratio is no wish to move again.
        if coupling.rung != Rung::Lost && (is_new || !coupling.rung.is_locked()) {
            coupling.rung = Rung::Due;
        }
        self.stir();
    }

    /// The motion is not the law's for a while: the way onto it is looked for when it may go on.
    pub(super) fn leave_law(&mut self) {
        if let Some(coupling) = &mut self.coupling {
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

    /// Whom it follows, and for whose place a command of it waits.
    pub(crate) fn masters(&self) -> impl Iterator<Item = AxisId> + use<P> {
        let [first, second] = self.followed();
        [first, second, self.awaited_master()].into_iter().flatten()
    }

    /// A command waits, maybe one that follows a master.
    pub(super) fn note_bound(&mut self, entry: &Entry) {
        self.unsettle();
        if matches!(entry.work, Work::Gear(_) | Work::Cam(_)) {
            self.links.set_bound(true);
        }
    }

    /// Notes anew whether the owner, or a command that waits, may follow a master. Returns whether one that waits may.
    pub(crate) fn renew_bound(&mut self) -> bool {
        let couples = |entry: &Entry| matches!(entry.work, Work::Gear(_) | Work::Cam(_));
        let waits = !self.queue.is_empty() && self.queue.iter().any(couples);
        let is_bound = self.is_coupled() || self.is_on_cam() || self.awaited.is_some() || waits;
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

    /// Why each command that waits could not go behind its master now.
    pub(crate) fn bar_waiting(&mut self, barred: &[Option<ErrorId>; QUEUE_MAX]) {
        for (entry, error) in self.queue.iter_mut().zip(barred) {
            entry.barred = *error;
        }
    }

    /// Tells that the slave follows its master on a law, and from when on in gear.
    fn record_in_gear(&self, scope: &mut Scope<'_>) {
        self.record(Event::InGear, &mut self.owner_scope(scope));
    }
}

//! Slaves on a cam: MC_CamIn and MC_CamOut on the slave's side.
//!
//! In sync the set-point *is* the cam at the master's place in the same scan ([`CamLaw`]). A slave that can't be
//! there stays on the curve, and follows a master of its own that lags: its shadow. It does not leave the curve,
//! because that could move a tool into an obstacle. Only before it has reached the curve does the slave move in its
//! own coordinates. That move ends at a place where the curve is at rest.
//!
//! | file | subject |
//! | --- | --- |
//! | [`follow`] | the motion step of a slave on a cam |
//! | [`onto`] | how it gets onto the curve |
//! | [`start`] | a start that waits for a place of the master |
//! | [`shadow`] | its shadow in step with the master |
//! | [`near`] | a shadow many turns behind its master |
//! | [`corners`] | rest at rows where a derivative of the cam jumps |
//! | [`ahead`] | whether it keeps its limits along the future motion of the master, and where that motion ends |
//! | [`beside`] | the limits that it leaves to a shift, and to its master |
//! | [`steady`] | the motion step in a scan in which nothing is new |
//! | [`ends`], [`after`] | ends of a cam, and the change to the next command |
//! | [`laid`] | the place of the cam, for drawing |
//!
//! Source: PLCopen Motion Control Part 1, MC_CamTableSelect, MC_CamIn, MC_CamOut; V20 to V20b, S8. docs/cams.md
//! states what the standard leaves open.

mod after;
mod ahead;
mod beside;
mod corners;
mod ends;
mod follow;
mod laid;
mod near;
mod onto;
mod shadow;
mod start;
mod steady;

use super::super::Axis;
use super::super::commands::{Camming, Entry};
use super::view::{Known, Seen};
use super::{Coupled, FURTHEST, Values};
use crate::{Approach, AxisId, CamId, CamIn, CamSelection, Cams, ErrorId, Event, OnLimit, Scope, StartMode};
use ends::Ends;
pub use laid::CamLaid;
use standstill_planner::{
    Anchor, Cam, CamAt, CamBounds, CamHead, CamLaw, CamSmooth, Limits, Place, Planner, Setpoint,
};

/// How an axis fits a cam, without scalings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CamFit {
    /// The number of derivatives that must be continuous: its cam_continuity. Without that it is 3 with a snap limit,
    /// 2 with a jerk limit, and otherwise 1.
    pub needed: usize,
    /// The number that are continuous. Without a jerk limit the rest before the first row and behind the last
    /// one does not count.
    pub smooth: CamSmooth,
    /// The number that its limits require. It comes to rest at a row where one of these jumps.
    pub limits_need: usize,
    /// The highest or the lowest position of the cam if it is outside the software limits, the limit, and the error
    /// for a cam with absolute slave positions.
    pub outside: Option<(f64, f64, ErrorId)>,
    /// The highest constant velocity of the master (u/s) with which the slave can follow.
    pub highest: f64,
    /// The limits from which it results.
    pub limits: Limits,
}

impl CamFit {
    /// The derivatives of the slave by its master, with the names of a table.
    pub const DERIVATIVES: [&'static str; 3] = ["Slope", "Curvature", "Third"];

    /// The name of the derivative of this order, less 1.
    fn derivative(order: usize) -> &'static str {
        Self::DERIVATIVES.get(order).copied().unwrap_or_default()
    }
}

/// The place of the slave, and how it moves.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Rung {
    /// The next motion step decides.
    Due,
    /// It is in sync.
    Locked,
    /// On the curve at a place of its own, by a plan beside a line. The line begins at `start` and has this velocity
    /// (u/s of the master). The master follows the line from this number of scans after the start of the plan.
    BesideLine { start: Place, velocity: f64, begin: u64 },
    /// The same beside the master itself.
    BesideMaster,
    /// The same beside a master whose future motion is not known, within this room.
    BesideMeasured { room: Limits },
    /// On the curve at a place of its own, by a plan from `start` to rest at a corner or before it.
    Corner { start: Place },
    /// A move in the slave's own coordinates, in the turn with this number. It ends at the place of the curve for a
    /// master at this place, or at rest if there is none.
    Moving { turns: i64, to: Option<Place> },
    /// It waits at its position: no plan onto the curve exists yet.
    Waiting,
    /// The master went out of operation: the slave is at rest until a block couples it again.
    Lost,
}

impl Rung {
    const fn is_locked(&self) -> bool {
        matches!(self, Self::Locked)
    }
}

/// A master of the slave's own: its place, and its motion there.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Shadow {
    place: Place,
    at: Setpoint,
}

impl Shadow {
    /// The master itself.
    fn of(master: &Seen) -> Self {
        Self {
            place: master.place,
            at: master.at,
        }
    }

    /// At rest at this place.
    fn at_rest(place: Place) -> Self {
        Self {
            place,
            at: Setpoint::at_rest(place.position),
        }
    }
}

/// How the owner follows a cam.
#[derive(Clone, Copy, Debug)]
pub(in crate::axis) struct OnCam {
    camming: Camming,
    /// The place of the cam, once it is known.
    anchor: Option<Anchor>,
    /// The beginning of the cam: a place of the master, and the place of the cam there, if both were fixed before it
    /// was engaged.
    begins: Option<(Place, f64)>,
    /// It has to be in sync at its sync position, and the way there is not chosen yet.
    is_timed: bool,
    rung: Rung,
    /// It has been in sync.
    was_in_sync: bool,
    /// The place of the slave on the curve, as a place of its master, if it is on the curve.
    shadow: Option<Shadow>,
    /// The limits of the shadow in motion. While it `slows` down, they apply only along its way.
    shadow_limits: Limits,
    slows: bool,
    /// Limits with which its shadow can come to rest before the next corner of the cam, and the limits of the slave
    /// at that time.
    brakes: Option<(Limits, Limits)>,
    /// The place on the cam at the end of the last scan.
    at: CamAt,
    ends: Ends,
    /// The master at the end of the last scan, in its present coordinates.
    was: Seen,
    /// The known part of the master's future motion.
    known: Known,
    /// Scans until the way is searched again; the largest number for never.
    left: u64,
    /// The approach recorded last.
    told: Option<Approach>,
    /// The limits against which it was last checked.
    limits: Limits,
    /// The number of shifts of the slave's own coordinates.
    moves: u32,
    /// The distance of the slave from the cam at its master's place (u).
    deviation: f64,
    /// The first position of the cam plus the superimposed distance, less the place of the layer that is added to it
    /// (u).
    lead: f64,
    /// The first position of the cam, without the distance superimposed since (u).
    laid: f64,
    /// The limits that it leaves to its master, once the master keeps the limits of the slave.
    bound: Option<Limits>,
    /// The position to which its master leads it (u), if that is outside its software limits.
    leads_outside: Option<f64>,
}

/// A cam at its place.
#[derive(Clone, Copy)]
struct Curve<'a> {
    cam: Cam<'a>,
    law: CamLaw,
    anchor: Anchor,
}

impl Curve<'_> {
    /// The place of the slave for a master at `place`.
    fn at(&self, place: Place, moving: &Setpoint, near: u16) -> CamAt {
        self.law.at(&self.cam, &self.anchor, place, moving, near)
    }

    /// The master's place on its side of the cam, not reduced to one period (u).
    fn unwound(&self, place: Place) -> f64 {
        self.law.unwound(&self.cam, &self.anchor, place)
    }

    /// The inverse: a place of the master at `x` (u), as seen from `near`.
    fn place_of(&self, x: f64, near: Place) -> Place {
        let further = (x - self.unwound(near)) * self.law.master_scaling;
        near.moved_to(near.position + further)
    }

    /// The bounds of its derivatives over the whole cam.
    fn bounds(&self) -> CamBounds {
        let head = self.cam.head;
        head.bounds
            .scaled(self.law.master_scaling, self.law.slave_scaling)
    }

    /// Whether the slave is at the same place one period later.
    fn repeats(&self) -> bool {
        let head = self.cam.head;
        head.periodic && head.from == head.to
    }

    /// One period of the master (u of the master), without its sign.
    fn period(&self) -> f64 {
        ((self.cam.head.end - self.cam.head.begin) * self.law.master_scaling).abs()
    }
}

impl OnCam {
    fn new(camming: Camming, limits: Limits, moves: u32) -> Self {
        Self {
            camming,
            anchor: None,
            begins: None,
            is_timed: false,
            rung: Rung::Due,
            was_in_sync: false,
            shadow: None,
            shadow_limits: Limits::NONE,
            slows: false,
            brakes: None,
            at: CamAt::default(),
            ends: Ends::default(),
            was: Seen::default(),
            known: Known::default(),
            left: u64::MAX,
            told: None,
            limits,
            moves,
            deviation: 0.0,
            lead: 0.0,
            laid: 0.0,
            bound: None,
            leads_outside: None,
        }
    }

    /// The position to which its master leads it (u), as last recorded.
    pub(super) fn leads_outside(&mut self) -> &mut Option<f64> {
        &mut self.leads_outside
    }

    /// The cam at its place, once that is known.
    fn curve<'a>(&self, cam: Cam<'a>) -> Option<Curve<'a>> {
        Some(Curve {
            cam,
            law: self.camming.law,
            anchor: self.anchor?,
        })
    }

    /// The same, if the store has the cam.
    fn stored_curve<'a>(&self, cams: &'a Cams<'_>) -> Option<Curve<'a>> {
        self.curve(cams.cam(self.camming.cam)?)
    }
}

impl<P: Planner> Axis<P> {
    /// Whether the owner is on a cam.
    #[inline]
    pub(crate) fn is_on_cam(&self) -> bool {
        self.follower.on_cam.is_some()
    }

    /// Whether the owner follows a master on a cam.
    pub fn is_on_a_cam(&self) -> bool {
        self.is_on_cam()
    }

    /// Whether the owner is on this cam, or a waiting command uses it.
    pub fn uses_cam(&self, id: CamId) -> bool {
        let is_of = |entry: &Entry| matches!(entry.work, super::super::commands::Work::Cam(camming) if camming.cam == id);
        let runs = self.on_cam().is_some_and(|on_cam| on_cam.camming.cam == id);
        let awaits = self
            .follower
            .awaited
            .as_ref()
            .is_some_and(|awaited| is_of(&awaited.entry));
        runs || awaits || self.owner.as_ref().is_some_and(is_of) || self.queue.iter().any(is_of)
    }

    /// The number of cam ends that this axis has reached. It only grows, until it wraps.
    pub fn cam_ends(&self) -> u32 {
        self.follower.cam_ends
    }

    /// How this axis fits a complete cam, without scalings.
    pub fn fit_of_cam(&self, head: &CamHead) -> CamFit {
        let limits = self.slowed(&self.parameters.limits);
        let (low, high) = head.range;
        let outside = |place: f64| {
            let error = self.allowed(place).err()?;
            Some((place, self.broken_software_limit(place), error))
        };
        CamFit {
            needed: self.needed_of_cam(),
            smooth: self.smooth_of_cam(head),
            limits_need: self.corner_order(),
            outside: if self.modulo.is_some() {
                None
            } else {
                outside(high).or_else(|| outside(low))
            },
            highest: head.bounds.highest_velocity(&limits),
            limits,
        }
    }

    /// The number of derivatives of a cam that must not jump for this axis to accept it.
    fn needed_of_cam(&self) -> usize {
        let configured = self.config.following.cam_continuity;
        configured.map_or_else(|| self.corner_order(), usize::from)
    }

    /// The smoothness of a cam as far as this axis needs it. Without a jerk limit the cam may begin and end with a
    /// slope.
    fn smooth_of_cam(&self, head: &CamHead) -> CamSmooth {
        if self.corner_order() > 1 {
            head.smooth
        } else {
            head.smooth_inside
        }
    }

    /// Checks a complete cam for MC_CamTableSelect. Returns the highest constant velocity of `master`
    /// (u/s) with which this axis can follow it, without scalings.
    ///
    /// # Errors
    /// The reason why this axis can't follow the cam: [`ErrorId::CamNotSmooth`],
    /// [`ErrorId::TargetOutsideSoftwareLimits`] of an absolute cam, [`ErrorId::CamBeyondLimits`]. It is recorded.
    pub fn check_cam(
        &self,
        head: &CamHead,
        selection: &CamSelection,
        master_velocity: f64,
        scope: &mut Scope<'_>,
    ) -> Result<f64, ErrorId> {
        let fit = self.fit_of_cam(head);
        self.check_smooth(head, scope)?;
        if selection.slave_absolute
            && let Some((place, limit, error)) = fit.outside
        {
            return Err(self.refuse("CamTable", place, limit, error, scope));
        }
        let highest = fit.highest;
        let is_slower = highest < master_velocity;
        if is_slower && self.config.following.on_limit == OnLimit::Error {
            let error = ErrorId::CamBeyondLimits;
            return Err(self.refuse("CamTable", master_velocity, highest, error, scope));
        }
        let event = Event::CamSelected {
            velocity: highest,
            limit: master_velocity,
        };
        self.record(event, scope);
        let CamSmooth { continuity, jump } = head.smooth;
        if usize::from(continuity) < fit.limits_need {
            let (row, jump) = jump;
            let event = Event::CamStops {
                row: u16::try_from(row).unwrap_or(u16::MAX),
                what: CamFit::derivative(continuity.into()),
                jump,
            };
            self.record(event, scope);
        }
        Ok(highest)
    }

    /// # Errors
    /// [`ErrorId::CamNotSmooth`].
    fn check_smooth(&self, head: &CamHead, scope: &mut Scope<'_>) -> Result<(), ErrorId> {
        let CamSmooth { continuity, jump } = self.smooth_of_cam(head);
        if usize::from(continuity) >= self.needed_of_cam() {
            return Ok(());
        }
        let what = CamFit::derivative(continuity.into());
        let (row, jump) = jump;
        Err(self.refuse_row(row, what, jump, 0.0, ErrorId::CamNotSmooth, scope))
    }

    /// Records that a row of a table is refused, and returns its error.
    pub fn refuse_row(
        &self,
        row: usize,
        what: &'static str,
        value: f64,
        limit: f64,
        error: ErrorId,
        scope: &mut Scope<'_>,
    ) -> ErrorId {
        let refused = Event::PointRefused {
            point: u16::try_from(row).unwrap_or(u16::MAX),
            what,
            value,
            limit,
            error,
        };
        self.record(refused, scope);
        error
    }

    pub(in crate::axis) fn master_on_cam(&self) -> Option<AxisId> {
        self.on_cam().map(|on_cam| on_cam.camming.master)
    }

    pub(super) fn values_on_cam(&self) -> Option<Values> {
        let on_cam = self.on_cam()?;
        Some((on_cam.camming.master, on_cam.camming.source))
    }

    pub(super) fn has_lost_master_on_cam(&self) -> bool {
        self.on_cam().is_some_and(|on_cam| on_cam.rung == Rung::Lost)
    }

    pub(super) fn deviation_on_cam(&self) -> f64 {
        self.on_cam().map_or(0.0, |on_cam| on_cam.deviation)
    }

    /// Whether it is in sync and the cam has begun.
    pub(super) fn is_in_sync_on_cam(&self) -> bool {
        let is_in_sync = |on_cam: &OnCam| on_cam.rung.is_locked() && on_cam.ends.has_begun();
        self.on_cam().is_some_and(is_in_sync)
    }

    pub(super) fn coupled_on_cam(&self) -> Option<Coupled> {
        let on_cam = self.on_cam()?;
        let place = on_cam.shadow.map(|shadow| shadow.place);
        let turn = on_cam.camming.law.master_turn;
        let shadow = place.map(|place| match turn {
            Some(length) => standstill_planner::turns::split(place.position + place.phase, length).1,
            None => place.position + place.phase,
        });
        Some(Coupled {
            master: on_cam.camming.master,
            deviation: on_cam.deviation,
            phase: self.phases()[0],
            second: None,
            superimposed: on_cam
                .anchor
                .map_or(0.0, |anchor| anchor.slave.phase - on_cam.laid),
            shadow,
        })
    }

    /// The master of its cam at the end of the last scan.
    pub(super) fn master_of_cam_was(&self) -> Option<&Seen> {
        self.on_cam().map(|on_cam| &on_cam.was)
    }

    /// The largest position of its master with which the cam is evaluated (u of the slave).
    pub(super) fn size_of_master_on_cam(&self) -> f64 {
        self.on_cam()
            .map_or(0.0, |on_cam| on_cam.camming.steepest * on_cam.was.size())
    }

    /// Before any axis has moved in this scan: notes its master.
    pub(super) fn note_master_on_cam(&mut self, seen: Seen) {
        if let Some(on_cam) = &mut self.follower.on_cam {
            on_cam.was = seen;
        }
    }

    /// The motion leaves the curve.
    pub(super) fn leave_cam(&mut self) {
        if let Some(on_cam) = &mut self.follower.on_cam {
            on_cam.rung = Rung::Due;
            on_cam.shadow = None;
        }
    }

    /// Checks the pins of MC_CamIn.
    pub(in crate::axis) fn check_cam_in(
        &self,
        cam: &CamIn,
        scope: &mut Scope<'_>,
    ) -> Result<Camming, ErrorId> {
        self.check_master("Master", cam.master.axis, scope)?;
        let source = self.check_source("MasterValueSource", cam.source, scope)?;
        let mode = self.element("StartMode", cam.start_mode, ErrorId::SyncModeInvalid, scope)?;
        let mut refuse = |pin, value: f64, limit, error| Err(self.refuse(pin, value, limit, error, scope));
        for (pin, value) in [
            ("MasterScaling", cam.master_scaling),
            ("SlaveScaling", cam.slave_scaling),
        ] {
            // Any other value is so far from 1 that a cam and its derivatives would no longer be finite.
            if !(value.is_normal() && value.abs() > 1e-30 && value.abs() < 1e30) {
                return refuse(pin, value, f64::NAN, ErrorId::CamScalingInvalid);
            }
        }
        for (pin, value) in [
            ("MasterOffset", cam.master_offset),
            ("SlaveOffset", cam.slave_offset),
        ] {
            if !(value.abs() <= FURTHEST) {
                return refuse(pin, value, FURTHEST, ErrorId::CamScalingInvalid);
            }
        }
        for (pin, value) in [
            ("MasterSyncPosition", cam.sync_position),
            ("MasterStartDistance", cam.start_distance),
            ("SwitchAt", cam.switch_at),
        ] {
            if !(value.abs() <= FURTHEST) {
                return refuse(pin, value, FURTHEST, ErrorId::SyncPositionInvalid);
            }
        }
        let Some(selection) = scope.cams.selection(cam.table) else {
            let number = f64::from(cam.table.number());
            return Err(self.refuse("CamTableID", number, f64::NAN, ErrorId::CamUnknown, scope));
        };
        let head = scope.cams.cam(cam.table).map(|cam| *cam.head);
        if let Some(head) = head {
            // The cam may have been selected for another slave.
            self.check_smooth(&head, scope)?;
            let period = head.end - head.begin;
            if head.periodic && !(cam.start_distance.abs() < period) {
                let error = ErrorId::SyncPositionInvalid;
                return Err(self.refuse("MasterStartDistance", cam.start_distance, period, error, scope));
            }
            let is_in_cam = head.periodic || (head.begin..=head.end).contains(&cam.sync_position);
            if cam.start_distance != 0.0 && !is_in_cam {
                let limit = if cam.sync_position > head.end {
                    head.end
                } else {
                    head.begin
                };
                let error = ErrorId::SyncPositionInvalid;
                return Err(self.refuse("MasterSyncPosition", cam.sync_position, limit, error, scope));
            }
        }
        let slave_turn = self.config.modulo;
        Ok(Camming {
            master: cam.master.axis,
            source,
            cam: cam.table,
            continuity: head.map_or(0, |head| head.smooth.continuity),
            steepest: head.map_or(0.0, |head| {
                let bounds = head.bounds.scaled(cam.master_scaling, cam.slave_scaling);
                bounds.first
            }),
            law: CamLaw {
                master_scaling: cam.master_scaling,
                slave_scaling: cam.slave_scaling,
                origin: 0.0,
                master_turn: cam.master.turn,
                slave_turn,
            },
            master_absolute: selection.master_absolute,
            slave_absolute: selection.slave_absolute && mode != StartMode::Relative,
            master_offset: cam.master_offset,
            slave_offset: cam.slave_offset,
            sync: (cam.sync_position != 0.0 || cam.start_distance != 0.0).then_some(cam.sync_position),
            start_distance: cam.start_distance,
            switch_at: (cam.switch_at != 0.0).then_some(cam.switch_at),
        })
    }

    /// `entry` moves onto a cam from the next motion step on, or has new values for it.
    pub(super) fn await_master_on_cam(&mut self, camming: Camming, entry: &Entry, scope: &mut Scope<'_>) {
        self.links.set_bound(true);
        let known = self.on_cam().map(|on_cam| on_cam.camming);
        if known != Some(camming) {
            let event = Event::OnCam {
                master: camming.master,
                cam: camming.cam,
            };
            self.record(event, &mut scope.with(entry.instance));
        }
        let (limits, moves) = (self.slowed(&self.parameters.limits), self.frame.moves());
        let on_cam = self
            .follower
            .on_cam
            .get_or_insert_with(|| OnCam::new(camming, limits, moves));
        let is_lost = on_cam.rung == Rung::Lost;
        if on_cam.camming != camming {
            // After the master is lost, other values must not start a motion.
            *on_cam = OnCam {
                was: on_cam.was,
                known: on_cam.known,
                ..OnCam::new(camming, limits, moves)
            };
        }
        on_cam.rung = if is_lost { Rung::Lost } else { Rung::Due };
        self.end_routine();
    }
}

//! MC_GearInPos: a law that is given before the slave is on it, and a start that waits for a position of the master.
//! MC_CamIn may also have such a start.
//!
//! Until the start the command waits beside the owner of the slave, and does not affect it. When the master crosses
//! the start point, the command is checked first: can the slave be in sync in time? Only then is the owner
//! interrupted.
//!
//! Source: PLCopen Motion Control Part 1, MC_GearInPos; V19, V19a. docs/coupling.md states what the standard leaves
//! open.

use super::super::commands::{Entry, Gearing, Sync, Work};
use super::super::{Axis, Motion};
use super::view::{Seen, View};
use super::{Coupling, FURTHEST, Rung, Values};
use crate::{
    AxisId, BufferMode, Cams, Command, CommandId, ErrorId, Event, Fate, Scope, SyncMode, SyncPoint,
    ValueSource,
};
use standstill_planner::turns::split;
use standstill_planner::{Anchor, CamLaw, Limits, Place, Plan, Planner, Setpoint};

/// The largest rounding error of a master's place, relative to the numbers it is made of.
const ROUNDING: f64 = 1e-9;

/// Most times that a span of scans is halved; a plan has at most 2^31 scans.
const HALVINGS: u32 = 32;

/// Most start distances that are tried for the record of a start that is too late.
const TRIALS: u32 = 4;

/// The reason why a slave can't be in sync in time: the pin, its value and the limit.
pub(super) type NotInTime = (&'static str, f64, f64, ErrorId);

/// A command that waits for a place of its master.
#[derive(Clone, Copy, Debug)]
pub(in crate::axis) struct Awaited {
    pub(in crate::axis) entry: Entry,
    master: AxisId,
    source: ValueSource,
    /// The master at the end of the last scan, in its present coordinates.
    was: Seen,
    start: StartPoint,
    /// The place of its cam at the master, once that is known, and the place of the cam there.
    laid: Option<(Place, f64)>,
}

/// A place of the master at which a command starts.
#[derive(Clone, Copy, Debug)]
struct StartPoint {
    /// The sync point, and the distance of the start point before it, with the sign of the direction in which the
    /// master crosses it.
    goal: f64,
    distance: f64,
    /// It has not been checked yet.
    is_new: bool,
    /// The master has been between start and sync point since the command was given, and has not moved back.
    is_between: bool,
}

/// A step of the master: its start, its end, and the distance between them.
struct Course {
    before: f64,
    here: f64,
    way: f64,
    /// Its velocity after the step.
    velocity: f64,
    /// The distance after which it is at the same place again.
    length: Option<f64>,
}

/// The remainder of `value` in [0, `length`).
fn wrapped(value: f64, length: f64) -> f64 {
    split(value, length).1
}

impl StartPoint {
    const fn new(goal: f64, distance: f64) -> Self {
        Self {
            goal,
            distance,
            is_new: true,
            is_between: false,
        }
    }

    /// Whether the master has reached the start point in this scan, or is between it and the sync point.
    fn starts(&mut self, course: &Course) -> bool {
        let Self { goal, distance, .. } = *self;
        if distance == 0.0 {
            return true;
        }
        let heading = 1.0_f64.copysign(distance);
        let (before, here) = (course.before, course.here);
        let point = goal - distance;
        let way = heading * course.way;
        let has_crossed = match course.length {
            None => heading * (before - point) < 0.0 && heading * (here - point) >= 0.0,
            // The master is behind the start point by less than its travel in this scan.
            Some(length) => wrapped(heading * (here - point), length) < way,
        };
        if core::mem::take(&mut self.is_new) {
            self.is_between = match course.length {
                None => heading * (here - point) >= 0.0 && heading * (goal - here) >= 0.0,
                Some(length) => wrapped(heading * (goal - here), length) <= distance.abs(),
            };
        } else if way < 0.0 {
            self.is_between = false;
        }
        let moves_on = heading * course.velocity > 0.0;
        has_crossed || (self.is_between && moves_on)
    }
}

impl Awaited {
    /// The waiting `entry`; `None` if it has nothing to wait for.
    fn new(entry: Entry) -> Option<Self> {
        let (master, source, goal, distance) = match entry.work {
            Work::Gear(gearing) => {
                let sync = gearing.sync?;
                let first = gearing.first;
                (first.master, first.source, sync.master, sync.start_distance)
            }
            Work::Cam(camming) => (
                camming.master,
                camming.source,
                camming.sync.unwrap_or(0.0),
                camming.start_distance,
            ),
            _ => return None,
        };
        Some(Self {
            entry,
            master,
            source,
            was: Seen::default(),
            start: StartPoint::new(goal, distance),
            laid: None,
        })
    }

    /// The place of the cam at its master with new values. A cam that counts from the master's place at the edge
    /// keeps it.
    fn laid_for(&self, entry: &Entry, cams: &Cams<'_>) -> Option<(Place, f64)> {
        let (Work::Cam(before), Work::Cam(camming)) = (self.entry.work, entry.work) else {
            return None;
        };
        let (place, _) = self.laid?;
        let is_counted_on = !before.master_absolute && !camming.master_absolute;
        let is_same_master = (before.master, before.source) == (camming.master, camming.source);
        if !(is_counted_on && is_same_master) {
            return None;
        }
        let offset = camming.master_offset - before.master_offset;
        let place = place.moved_to(place.position + offset);
        Some((place, cams.cam(camming.cam)?.head.begin))
    }

    /// The step of the master from the end of the last scan to `now`, on the master's side of the cam if a cam is
    /// given. `turn` is the length of the master's turn (u).
    fn course(&mut self, now: &Seen, turn: Option<f64>, cams: &Cams<'_>) -> Option<Course> {
        // A shift of coordinates within the motion step was not seen before it.
        let late = now.moved - self.was.moved;
        if let Work::Cam(camming) = self.entry.work {
            let cam = cams.cam(camming.cam)?;
            let mut was = self.was.place;
            was.position += late;
            if let (Some((place, _)), false) = (&mut self.laid, camming.master_absolute) {
                place.position += now.moved;
            }
            let (place, origin) = *self.laid.get_or_insert_with(|| camming.laid(was, cam.head));
            let law = CamLaw {
                origin,
                ..camming.law
            };
            let anchor = Anchor {
                master: place,
                ..Anchor::default()
            };
            let (before, here) = (
                law.unwound(&cam, &anchor, was),
                law.unwound(&cam, &anchor, now.place),
            );
            return Some(Course {
                before,
                here,
                way: here - before,
                velocity: now.at.velocity / law.master_scaling,
                length: cam.head.periodic.then_some(cam.head.end - cam.head.begin),
            });
        }
        let (before, here) = (self.was.place.position + late, now.place.position);
        let turns = now.place.turns.wrapping_sub(self.was.place.turns) as f64;
        Some(Course {
            before,
            here,
            way: turns * turn.unwrap_or(0.0) + (here - before),
            velocity: now.at.velocity,
            length: turn,
        })
    }
}

impl<P: Planner> Axis<P> {
    /// Checks the pins that only MC_GearInPos has; `turn` is the length of the master's turn (u).
    pub(super) fn check_sync(
        &self,
        point: &SyncPoint,
        turn: Option<f64>,
        scope: &mut Scope<'_>,
    ) -> Result<Sync, ErrorId> {
        let own_turn = self.config.modulo;
        let places = [
            ("MasterSyncPosition", point.master, turn),
            ("SlaveSyncPosition", point.slave, own_turn),
        ];
        for (pin, value, turn) in places {
            let is_in_turn = turn.is_none_or(|length| value >= 0.0 && value < length);
            if !(value.abs() <= FURTHEST && is_in_turn) {
                let limit = turn.unwrap_or(FURTHEST);
                return Err(self.refuse(pin, value, limit, ErrorId::SyncPositionInvalid, scope));
            }
        }
        self.inside("SlaveSyncPosition", point.slave, scope)?;
        let distance = point.start_distance;
        if !(distance.abs() <= FURTHEST && turn.is_none_or(|length| distance.abs() < length)) {
            let limit = turn.unwrap_or(FURTHEST);
            let error = ErrorId::SyncPositionInvalid;
            return Err(self.refuse("MasterStartDistance", distance, limit, error, scope));
        }
        let mode = self.element("SyncMode", point.mode, ErrorId::SyncModeInvalid, scope)?;
        Ok(Sync {
            master: point.master,
            slave: point.slave,
            mode,
            start_distance: distance,
        })
    }

    /// Makes a command wait for its start point. It replaces one that waited before.
    pub(in crate::axis) fn await_start(
        &mut self,
        work: Work,
        limits: Limits,
        mode: BufferMode,
        scope: &mut Scope<'_>,
    ) -> Result<CommandId, ErrorId> {
        if mode != BufferMode::Aborting {
            let number = f64::from(mode as i32);
            return Err(self.refuse("BufferMode", number, 0.0, ErrorId::BufferModeNotHere, scope));
        }
        self.end_awaited(Fate::Aborted);
        let entry = Entry::new(self.new_id(), scope.instance, work, limits, mode);
        self.links.set_bound(true);
        self.unsettle();
        self.follower.awaited = Awaited::new(entry);
        Ok(entry.id)
    }

    /// Gives command `id`, if it waits for its start point, these values from now on.
    pub(in crate::axis) fn update_awaited(
        &mut self,
        id: CommandId,
        command: &Command,
        scope: &mut Scope<'_>,
    ) -> Result<(), ErrorId> {
        let Some(before) = self.follower.awaited.filter(|awaited| awaited.entry.id == id) else {
            return Ok(());
        };
        let mut entry = before.entry;
        let Some((work, limits)) = self.check_update(&entry, command, scope)? else {
            return Ok(());
        };
        self.take_values(&mut entry, command, work, limits);
        // A command that starts at once takes over in the next motion step, like one at its start point.
        self.follower.awaited = Awaited::new(entry).map(|awaited| Awaited {
            was: before.was,
            laid: before.laid_for(&entry, &scope.cams),
            ..awaited
        });
        Ok(())
    }

    /// Whether command `id` waits for its start point.
    pub(in crate::axis) fn awaits_start(&self, id: CommandId) -> bool {
        self.follower
            .awaited
            .as_ref()
            .is_some_and(|awaited| awaited.entry.id == id)
    }

    /// Ends the command that waits for its start point.
    pub(in crate::axis) fn end_awaited(&mut self, fate: Fate) {
        if let Some(awaited) = self.follower.awaited.take() {
            self.decide(awaited.entry.id, fate);
        }
    }

    /// The master whose place a command waits for.
    pub(crate) fn awaited_master(&self) -> Option<AxisId> {
        self.follower.awaited.as_ref().map(|awaited| awaited.master)
    }

    /// The same master, with its followed values.
    pub(crate) fn awaited_values(&self) -> Option<Values> {
        self.follower
            .awaited
            .as_ref()
            .map(|awaited| (awaited.master, awaited.source))
    }

    /// Before any axis has moved in this scan: notes the place of the master for which a command waits.
    pub(crate) fn note_awaited_master(&mut self, seen: Seen) {
        if let Some(awaited) = &mut self.follower.awaited {
            awaited.was = seen;
        }
    }

    /// Whether the command that waits for a place of its master starts in this scan, with the master seen
    /// at `now`. `turn` is the length of the master's turn (u). Call it once in a motion step.
    pub(crate) fn reaches_start(&mut self, now: &Seen, turn: Option<f64>, cams: &Cams<'_>) -> bool {
        let Some(awaited) = &mut self.follower.awaited else {
            return false;
        };
        let course = awaited.course(now, turn, cams);
        course.is_some_and(|course| awaited.start.starts(&course))
    }

    /// The master is at the start point of a waiting command. The command takes over, or it fails and the
    /// owner of the axis continues.
    ///
    /// Cost: that of the plans tried in the search for a way onto a law. For a start that is too late, up to 18 times
    /// that.
    pub(crate) fn start_at_point(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        let Some(Awaited { entry, was, laid, .. }) = self.follower.awaited else {
            return;
        };
        let is_same_master = self.goes_on_behind_masters(&entry);
        let seen = if is_same_master {
            was.shifted(self.phases_now()[0])
        } else {
            was
        };
        let found = match entry.work {
            Work::Gear(gearing) => self.gear_starts(&entry, gearing, seen, view),
            Work::Cam(camming) => self
                .cam_starts(&entry, camming, (seen, laid), view, scope)
                .map(|()| false),
            _ => return,
        };
        let goes_back = match found {
            Ok(goes_back) => goes_back,
            Err((pin, value, limit, error)) => {
                return self.fail_awaited((pin, value, limit), error, scope);
            }
        };
        self.follower.awaited = None;
        let before = self.limits_before(&entry.limits);
        let phasing = self.lend_phasing(&entry);
        self.end_all(Fate::Aborted, Fate::Aborted);
        self.follower.phasing = phasing;
        self.begin(entry, Motion::Geared, before, scope);
        self.note_start_on_cam(laid);
        if let Some(coupling) = &mut self.follower.coupling {
            coupling.goes_back = goes_back;
        }
        self.note_masters([was, Seen::default()]);
    }

    /// Checks that a gear that starts now is in sync in time. Returns whether it moves back for that.
    fn gear_starts(
        &mut self,
        entry: &Entry,
        gearing: Gearing,
        seen: Seen,
        view: &View<'_, P::Plan>,
    ) -> Result<bool, NotInTime> {
        let coupling = Coupling {
            was: [seen, Seen::default()],
            ..Coupling::new(gearing, self.slowed(&self.parameters.limits), self.frame.moves())
        };
        let own = self.follower.coupling.replace(coupling);
        let found = self.way_at_start(entry, view);
        let lent = core::mem::replace(&mut self.follower.coupling, own);
        found.map(|()| lent.is_some_and(|coupling| coupling.goes_back))
    }

    /// The command that waits for a place of its master can't follow it: it fails, and the owner of the
    /// axis continues.
    pub(crate) fn bar_awaited(&mut self, error: ErrorId, scope: &mut Scope<'_>) {
        let master = self.awaited_master().unwrap_or_default();
        self.fail_awaited(("Master", f64::from(master.number()), f64::NAN), error, scope);
    }

    fn fail_awaited(&mut self, at: (&'static str, f64, f64), error: ErrorId, scope: &mut Scope<'_>) {
        let Some(Awaited { entry, .. }) = self.follower.awaited.take() else {
            return;
        };
        let (pin, value, limit) = at;
        let scope = &mut scope.with(entry.instance);
        self.refuse(pin, value, limit, error, scope);
        self.decide(entry.id, Fate::Failed(error));
        self.lose_heir(entry.id, scope);
    }

    /// Checks that `entry` is in sync in time; its coupling is lent for this check.
    ///
    /// # Errors
    /// The pin, its value, the limit, and the reason.
    fn way_at_start(&mut self, entry: &Entry, view: &View<'_, P::Plan>) -> Result<(), NotInTime> {
        let late = self.late_at_start(entry, view)?;
        let Some(coupling) = self.follower.coupling else {
            return Ok(());
        };
        let (Some(anchor), Some(sync)) = (coupling.anchor, coupling.gearing.sync) else {
            return Ok(());
        };
        let distance = sync.start_distance;
        let exact = ROUNDING * (distance.abs() + anchor.master.position.abs());
        if late <= exact {
            return Ok(());
        }
        let left = 1.0_f64.copysign(distance) * self.way_to_sync(view, &anchor);
        // The master may reach its start point anywhere in a scan.
        let in_scan = (view.now.at.velocity * self.planner.cycle()).abs();
        let mut enough = distance.abs() + late;
        for _ in 0..TRIALS {
            // After that distance a master with turns is at its sync point again.
            let exists = enough.is_finite() && view.turn.is_none_or(|length| enough < length);
            if !exists {
                break;
            }
            let late = self.late_from(coupling, enough - left, entry, view)? + in_scan;
            if late <= exact {
                let enough = enough.copysign(distance);
                return Err(("MasterStartDistance", distance, enough, ErrorId::SyncNotReachable));
            }
            // From further away the way of the slave may be longer and take less time than the master.
            enough += 2.0 * late;
        }
        let (pin, value) = match sync.mode {
            SyncMode::Shortest => ("MasterStartDistance", distance),
            mode => ("SyncMode", f64::from(mode as i32)),
        };
        Err((pin, value, f64::NAN, ErrorId::SyncNotReachable))
    }

    /// The delay (u of the master) with which `entry` would be in sync if its master were `further` (u) from its sync
    /// point; `coupling` is lent for this check.
    fn late_from(
        &mut self,
        coupling: Coupling,
        further: f64,
        entry: &Entry,
        view: &View<'_, P::Plan>,
    ) -> Result<f64, NotInTime> {
        let distance = coupling.gearing.sync.map_or(0.0, |sync| sync.start_distance);
        let shift = Setpoint::at_rest(-further * 1.0_f64.copysign(distance));
        let shifted = View {
            now: view.now.shifted(&shift),
            ..*view
        };
        self.follower.coupling = Some(Coupling {
            was: coupling.was.map(|seen| seen.shifted(&shift)),
            anchor: None,
            goes_back: false,
            ..coupling
        });
        self.late_at_start(entry, &shifted)
    }

    /// The delay (u of the master) of `entry` at its sync point; infinite if no way leads onto the law. A slave that
    /// would be late because it waits moves back instead, if its mode permits that.
    fn late_at_start(&mut self, entry: &Entry, view: &View<'_, P::Plan>) -> Result<f64, NotInTime> {
        self.lay_law(view);
        let late = self.late_on_way(entry, view)?;
        let Some(coupling) = &mut self.follower.coupling else {
            return Ok(late);
        };
        let may_go_back = |sync: Sync| sync.mode == SyncMode::Shortest;
        if !(late > 0.0 && coupling.gearing.sync.is_some_and(may_go_back)) {
            return Ok(late);
        }
        coupling.goes_back = true;
        let late_by_going_back = self.late_on_way(entry, view)?;
        if let Some(coupling) = &mut self.follower.coupling {
            coupling.goes_back = late_by_going_back < late;
        }
        Ok(late.min(late_by_going_back))
    }

    /// The same for the way that is found.
    fn late_on_way(&self, entry: &Entry, view: &View<'_, P::Plan>) -> Result<f64, NotInTime> {
        let in_time = Ok(f64::NEG_INFINITY);
        let Some(coupling) = &self.follower.coupling else {
            return in_time;
        };
        let (Some(anchor), Some(sync)) = (coupling.anchor, coupling.gearing.sync) else {
            return in_time;
        };
        let master = f64::from(coupling.gearing.first.master.number());
        let not_at_all = |error| ("Master", master, f64::NAN, error);
        self.gear_motion(entry, self.mover.setpoint())
            .map_err(not_at_all)?;
        let difference = self.difference(coupling, &anchor);
        if difference.is_at_rest() && difference.position == 0.0 {
            return in_time;
        }
        let speed = self.law_speed(view);
        let asked = self.limits_of_approach(entry).velocity;
        let found = self.way_onto(entry, view, anchor, &difference);
        let way = found.map_err(|error| match error {
            ErrorId::MasterTooFast if sync.mode == SyncMode::SlowDown && asked > speed => {
                let number = f64::from(sync.mode as i32);
                ("SyncMode", number, f64::NAN, ErrorId::SyncNotReachable)
            }
            ErrorId::MasterTooFast => ("Velocity", asked, speed, error),
            other => not_at_all(other),
        })?;
        let Some(lock) = way.scans_to_lock() else {
            return Ok(f64::INFINITY);
        };
        let heading = 1.0_f64.copysign(sync.start_distance);
        Ok(heading * (self.way_of_master(view, lock) - self.way_to_sync(view, &anchor)))
    }

    /// The distance (u) of the master from its sync point at the end of the last scan.
    fn way_to_sync(&self, view: &View<'_, P::Plan>, anchor: &Anchor) -> f64 {
        let Some(coupling) = &self.follower.coupling else {
            return 0.0;
        };
        let was = coupling.was[0].place;
        let turns = anchor.master.turns.wrapping_sub(was.turns) as f64;
        turns * view.turn.unwrap_or(0.0) + (anchor.master.position - was.position) - was.phase
    }

    /// The distance (u) that the master covers in this many scans from the end of the last one, as far as
    /// is known.
    fn way_of_master(&self, view: &View<'_, P::Plan>, scans: u64) -> f64 {
        let cycle = self.planner.cycle();
        match view.future.plan() {
            Some((plan, from, late)) => {
                let to = from.saturating_add(scans.saturating_sub(late));
                let way = view.future.parts[0].factor * (plan.at(to).position - plan.at(from).position);
                let first = self.coupling().map_or(0.0, |coupling| {
                    let turns = view.now.place.turns.wrapping_sub(coupling.was[0].place.turns) as f64;
                    turns * view.turn.unwrap_or(0.0)
                        + (view.now.place.position - coupling.was[0].place.position)
                });
                if late > 0 { way + first } else { way }
            }
            None => view.now.at.velocity * cycle * scans as f64,
        }
    }

    /// Scans from the end of the last one until the master has covered `way` (u) in the direction of its
    /// motion, as far as is known; none if never.
    fn scans_of_master(&self, view: &View<'_, P::Plan>, way: f64) -> Option<u64> {
        let heading = 1.0_f64.copysign(view.now.at.velocity);
        let left = heading * way;
        let is_there = |scans: u64| heading * self.way_of_master(view, scans) >= left;
        let (mut low, mut high) = (0, 1_u64 << HALVINGS);
        if !is_there(high) {
            return None;
        }
        for _ in 0..HALVINGS {
            let middle = low + (high - low) / 2;
            if is_there(middle) {
                high = middle;
            } else {
                low = middle;
            }
        }
        Some(high)
    }

    /// Fixes the turns of a law with sync positions: that of the master, and that of the slave. No effect on any
    /// other law, or on one whose turns are fixed.
    pub(super) fn lay_law(&mut self, view: &View<'_, P::Plan>) {
        let Some(coupling) = &self.follower.coupling else {
            return;
        };
        let (Some(sync), None) = (coupling.gearing.sync, coupling.anchor) else {
            return;
        };
        if coupling.rung == Rung::Lost {
            return;
        }
        let mut anchor = Anchor {
            master: Place::new(master_turn(&sync, &coupling.was[0], view), sync.master),
            slave: Place::new(0, sync.slave),
            ..Anchor::default()
        };
        if let Some(length) = self.config.modulo {
            anchor.slave.turns = self.slave_turn(&sync, &anchor, length, view);
        }
        if let Some(coupling) = &mut self.follower.coupling {
            coupling.anchor = Some(anchor);
        }
    }

    /// The turn, of `length` (u), in which the slave is when the master is at the sync point.
    fn slave_turn(&self, sync: &Sync, anchor: &Anchor, length: f64, view: &View<'_, P::Plan>) -> i64 {
        let Some(coupling) = &self.follower.coupling else {
            return 0;
        };
        let here = self.place();
        let cycle = self.planner.cycle();
        // The slave's position without the command when the master is there, and its position with the command. If
        // the master's future motion is not known, its present place counts.
        let scans = self.scans_of_master(view, self.way_to_sync(view, anchor));
        let (kept, wanted) = match scans {
            Some(scans) => {
                let way = self.mover.setpoint().velocity * (scans as f64 * cycle);
                (here.position + way, anchor.slave)
            }
            None => {
                let (place, _) = coupling.law(anchor, &coupling.was);
                (here.position, place)
            }
        };
        // The turn of the law that is at or before `kept`, counted from that of the slave.
        let (before, rest) = split(kept - wanted.position, length);
        let line = coupling.gearing.first.gear.derivative(view.now.at.velocity);
        let is_forward = line >= 0.0;
        let further = match sync.mode {
            _ if rest == 0.0 => 0,
            SyncMode::CatchUp => i64::from(is_forward),
            SyncMode::SlowDown => i64::from(!is_forward),
            SyncMode::Shortest => {
                let left = length - rest;
                i64::from(if is_forward { left <= rest } else { left < rest })
            }
        };
        let turns = here.turns.wrapping_add(before).wrapping_add(further);
        // The law is given by its place at the sync point.
        turns.wrapping_sub(wanted.turns).wrapping_add(anchor.slave.turns)
    }

    /// In sync for the first time: records it if the master is past the sync point.
    pub(super) fn note_sync(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        let Some(coupling) = &mut self.follower.coupling else {
            return;
        };
        if coupling.was_in_gear {
            return;
        }
        coupling.was_in_gear = true;
        let Some((anchor, _)) = coupling.anchor.zip(coupling.gearing.sync) else {
            return;
        };
        let turns = view.now.place.turns.wrapping_sub(anchor.master.turns) as f64;
        let here = view.now.place.position + view.now.place.phase;
        let past = turns * view.turn.unwrap_or(0.0) + (here - anchor.master.position);
        let numbers = anchor.master.position.abs() + view.now.place.position.abs() + view.turn.unwrap_or(0.0);
        if past * view.now.at.velocity > 0.0 && past.abs() > ROUNDING * numbers {
            self.record(Event::SyncLate { by: past.abs() }, &mut self.owner_scope(scope));
        }
    }
}

/// The turn of the master's sync point. From the start point on it is the turn ahead; otherwise the next one that the
/// master passes, or the present one while it is at rest.
fn master_turn<Q>(sync: &Sync, was: &Seen, view: &View<'_, Q>) -> i64 {
    let Some(length) = view.turn else { return 0 };
    let (from, heading) = if sync.start_distance == 0.0 {
        (was.place, view.now.at.velocity)
    } else {
        let heading = 1.0_f64.copysign(sync.start_distance);
        let point = wrapped(sync.master - sync.start_distance, length);
        let here = view.now.place;
        let is_behind = heading * (here.position - point) < 0.0;
        let back = if is_behind { heading as i64 } else { 0 };
        let start = Place {
            turns: here.turns.wrapping_sub(back),
            position: point,
            ..here
        };
        (start, sync.start_distance)
    };
    if heading > 0.0 && sync.master < from.position {
        from.turns.wrapping_add(1)
    } else if heading < 0.0 && sync.master > from.position {
        from.turns.wrapping_sub(1)
    } else {
        from.turns
    }
}

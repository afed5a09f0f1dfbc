//! Profiles: motions along curves through points of a table.
//!
//! The whole curve is planned when the command becomes active. It starts in the present state of the
//! axis, and is refused, with the point and the limit, if it would leave a limit of the axis. From then
//! on it is a plan like others. Its times are fixed, so the override does not act on it, nothing is
//! superimposed on it, and a stopped profile does not continue.
//!
//! A waiting profile has no points here: they are in a table of the runtime, which only its block can
//! read. When it becomes active it owns the axis, which continues as its predecessor left it, and its
//! block gives the points in its next call. If the block is called in every scan, before the motion step,
//! this takes no extra scan.
//!
//! Source: PLCopen Motion Control Part 1, MC_PositionProfile, MC_VelocityProfile, MC_AccelerationProfile; V24.

use super::commands::{Ending, Entry, Start, Work};
use super::power::Reaction;
use super::{Axis, Motion};
use crate::{
    AxisEvent, AxisState, BufferMode, Command, CommandId, Dynamics, ErrorId, Fate, Raw, Request, Scope,
};
use standstill_planner::{
    PROFILE_POINTS, Plan, Planner, ProfileCause, ProfileFault, ProfileKind, ProfilePoint,
};

/// In seconds.
const HALF_A_NANOSECOND: f64 = 0.5e-9;

/// A record of a profile's table.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProfileRow {
    /// Time since the record before; for the first, since the start (ns).
    pub delta_ns: i64,
    /// Value at that time: u, u/s or u/s^2.
    pub value: f64,
    /// The curve is level there.
    pub level: bool,
}

/// MC_PositionProfile and similar: values at the pins and in the table, unchecked.
#[derive(Clone, Copy, Debug)]
pub struct Profile<'a> {
    /// The kind of the values.
    pub kind: ProfileKind,
    /// The table; a profile uses at most [`PROFILE_POINTS`] of its rows.
    pub rows: &'a [ProfileRow],
    /// Factor of all times; above 0.
    pub time_scale: f64,
    /// Factor of all values.
    pub scale: f64,
    /// Added to all values.
    pub offset: f64,
}

/// The points of a profile that are still ahead.
struct Points {
    points: [ProfilePoint; PROFILE_POINTS],
    count: usize,
    /// Points that are already passed.
    passed: usize,
}

impl Points {
    fn get(&self) -> &[ProfilePoint] {
        self.points.get(..self.count).unwrap_or_default()
    }
}

impl Profile<'_> {
    /// The points after `since` (s of the table's times). Refused with the pin, its value and limit.
    fn points(&self, since: f64) -> Result<Points, (&'static str, f64, f64, ErrorId)> {
        let invalid = ErrorId::ProfileScaleInvalid;
        if !(self.time_scale > 0.0 && self.time_scale.is_finite()) {
            return Err(("TimeScale", self.time_scale, 0.0, invalid));
        }
        if !self.scale.is_finite() {
            return Err((self.scale_pin(), self.scale, f64::NAN, invalid));
        }
        if !self.offset.is_finite() {
            return Err(("Offset", self.offset, f64::NAN, invalid));
        }
        let mut points = Points {
            points: [ProfilePoint::default(); PROFILE_POINTS],
            count: 0,
            passed: 0,
        };
        let table = ErrorId::ProfileTableInvalid;
        if self.rows.len() > PROFILE_POINTS {
            let (rows, most) = (self.rows.len() as f64, PROFILE_POINTS as f64);
            return Err((self.table_pin(), rows, most, table));
        }
        // Summed in nanoseconds, so that no rounding accumulates (V24).
        let mut sum: i64 = 0;
        for row in self.rows {
            sum = sum
                .checked_add(row.delta_ns)
                .ok_or(("DeltaTime", row.delta_ns as f64, f64::NAN, table))?;
            let time = sum as f64 / 1e9;
            // A point less than half a unit of the table ahead counts as passed.
            if since > 0.0 && time - since <= HALF_A_NANOSECOND {
                points.passed += 1;
                continue;
            }
            if let Some(slot) = points.points.get_mut(points.count) {
                *slot = ProfilePoint {
                    time: (time - since) * self.time_scale,
                    value: self.offset + self.scale * row.value,
                    level: row.level,
                };
                points.count += 1;
            }
        }
        Ok(points)
    }

    /// The pin of the table.
    const fn table_pin(&self) -> &'static str {
        match self.kind {
            ProfileKind::Position => "TimePosition",
            ProfileKind::Velocity => "TimeVelocity",
            ProfileKind::Acceleration => "TimeAcceleration",
        }
    }

    /// The pin of the amplitude.
    const fn scale_pin(&self) -> &'static str {
        match self.kind {
            ProfileKind::Position => "PositionScale",
            ProfileKind::Velocity => "VelocityScale",
            ProfileKind::Acceleration => "AccelerationScale",
        }
    }

    /// The field of the table with the values.
    const fn field(&self) -> &'static str {
        match self.kind {
            ProfileKind::Position => "Position",
            ProfileKind::Velocity => "Velocity",
            ProfileKind::Acceleration => "Acceleration",
        }
    }

    /// The error that a block shows for a refusal of the planner, and the pin or field.
    fn refusal(&self, fault: &ProfileFault) -> (&'static str, ErrorId) {
        let (table, beyond) = (ErrorId::ProfileTableInvalid, ErrorId::ProfileBeyondLimits);
        match fault.cause {
            ProfileCause::Count => (self.table_pin(), table),
            ProfileCause::Time => ("DeltaTime", table),
            ProfileCause::Value => (self.field(), table),
            ProfileCause::Start => (self.field(), ErrorId::ProfileStartMismatch),
            ProfileCause::TooLong => ("DeltaTime", ErrorId::MoveTooLong),
            ProfileCause::Position => ("Position", ErrorId::TargetOutsideSoftwareLimits),
            ProfileCause::Velocity => ("Velocity", beyond),
            ProfileCause::Acceleration => ("Acceleration", beyond),
            ProfileCause::Deceleration => ("Deceleration", beyond),
            ProfileCause::Jerk => ("Jerk", beyond),
            ProfileCause::Snap => ("Snap", beyond),
        }
    }
}

impl<P: Planner> Axis<P> {
    /// Takes a profile, or refuses it without any effect on the axis or the queue (R38).
    ///
    /// A profile that starts at once is planned at once. One that waits is only checked; its block must
    /// call [`Axis::profile_is_due`] in each call, and then [`Axis::start_profile`].
    ///
    /// Cost: that of [`Planner::profile`].
    ///
    /// # Errors
    /// The [`ErrorId`] the block shows; the refusal is recorded with the point, the value and the limit.
    pub fn profile(
        &mut self,
        profile: &Profile<'_>,
        buffer_mode: Raw<BufferMode>,
        scope: &mut Scope<'_>,
    ) -> Result<CommandId, ErrorId> {
        // Among other commands it is handled like any move.
        let any = Command::Halt {
            dynamics: Dynamics::default(),
        };
        let request = Request {
            buffer_mode,
            ..Request::aborting(any)
        };
        let (mode, start) = self.admit_recorded(&request, scope)?;
        if profile.kind == ProfileKind::Position && self.config.needs_homed && !self.homed {
            let (pin, error) = (profile.table_pin(), ErrorId::NotHomed);
            return Err(self.refuse(pin, f64::NAN, f64::NAN, error, scope));
        }
        let work = Work::Profile {
            kind: profile.kind,
            due: start == Start::Wait,
            since: 0.0,
            time_scale: profile.time_scale,
        };
        let limits = self.slowed(&self.parameters.limits);
        let mut entry = Entry::new(self.new_id(), scope.instance, work, limits, mode);
        match start {
            Start::Wait => {
                self.looked_at(profile, scope)?;
                self.unsettle();
                self.queue.push(entry);
                self.start_beside(scope);
            }
            Start::Now => {
                let motion = self.plan_profile(&mut entry, profile, scope)?;
                let before = self.limits_before(&entry.limits);
                self.end_all(Fate::Aborted, Fate::Aborted);
                self.begin(entry, motion, before, scope);
            }
        }
        Ok(entry.id)
    }

    /// Whether the profile `id` owns the axis and has not got its points yet.
    pub fn profile_is_due(&self, id: CommandId) -> bool {
        let due = |owner: &Entry| matches!(owner.work, Work::Profile { due: true, .. });
        self.owner
            .as_ref()
            .is_some_and(|owner| owner.id == id && due(owner))
    }

    /// The profile `id`, which is due, starts with these points. If it cannot, it ends with the error,
    /// and the next command becomes active. If there is none, an axis in motion enters ErrorStop.
    ///
    /// Cost: that of [`Planner::profile`].
    pub fn start_profile(&mut self, id: CommandId, profile: &Profile<'_>, scope: &mut Scope<'_>) {
        let Some(mut owner) = self.owner.filter(|_| self.profile_is_due(id)) else {
            return;
        };
        owner.work = Work::Profile {
            kind: profile.kind,
            due: false,
            since: 0.0,
            time_scale: profile.time_scale,
        };
        match self.plan_profile(&mut owner, profile, scope) {
            Ok(motion) => {
                // The curve starts at the sum.
                self.end_superimposed(Fate::Aborted);
                self.enter(owner.work.manner().start);
                self.mover.take_over_from(self.limits_before(&owner.limits));
                self.adopt(owner, motion, scope);
            }
            Err(error) => self.drop_profile(error, scope),
        }
    }

    /// New values for the profile `id` in progress (ContinuousUpdate): from the present state to the
    /// remaining points, in the remaining time multiplied by the new factor. Otherwise like
    /// [`Axis::profile`].
    ///
    /// # Errors
    /// The error that a new profile with these values would show. It is recorded, and the profile
    /// continues unchanged.
    pub fn update_profile(
        &mut self,
        id: CommandId,
        profile: &Profile<'_>,
        scope: &mut Scope<'_>,
    ) -> Result<(), ErrorId> {
        let Some(mut owner) = self.owner.filter(|owner| owner.id == id && !owner.paused) else {
            return Ok(());
        };
        let (
            Work::Profile {
                due: false,
                since,
                time_scale,
                ..
            },
            Motion::Run { elapsed, scans, .. },
        ) = (owner.work, self.mover.motion())
        else {
            return Ok(());
        };
        if elapsed >= scans {
            return Ok(());
        }
        owner.work = Work::Profile {
            kind: profile.kind,
            due: false,
            since: since + *elapsed as f64 * self.planner.cycle() / time_scale,
            time_scale: profile.time_scale,
        };
        owner.limits = self.slowed(&self.parameters.limits);
        let motion = self.plan_profile(&mut owner, profile, scope)?;
        self.mover.take_over_from(self.limits_before(&owner.limits));
        self.adopt(owner, motion, scope);
        Ok(())
    }

    /// The next command is a profile: it owns the axis from now on; the axis continues as at the end of
    /// its predecessor. It waits for a superimposed motion to end. A superimposed command that waits for
    /// room would not find any beside it.
    pub(super) fn begin_due(&mut self, mut next: Entry) {
        if self.mover.layer().is_some_and(|layer| layer.moves()) {
            return;
        }
        let before = self.limits_before(&next.limits);
        // The added distance stays added while the axis continues unchanged.
        self.end_superimposed_command(Fate::Aborted);
        self.queue.pop();
        self.end_owner(self.fate_at_hand_over());
        let starts_at_rest = self.mover.setpoint().is_at_rest();
        if starts_at_rest {
            self.mover.hold();
        } else {
            self.go_on_alone(&before);
        }
        next.limits = self.slowed(&self.parameters.limits);
        self.mover.keep(before);
        self.mover.watch(self.needs_watching(&next));
        // At rest it may still fail, and no arrow leads from ContinuousMotion to Standstill.
        self.enter(if starts_at_rest {
            AxisEvent::StartDiscrete
        } else {
            next.work.manner().start
        });
        self.own(next);
    }

    /// Whether the owner is an endless profile that has reached its end. It has completed, and keeps its
    /// velocity unless its direction is barred.
    #[inline(never)]
    pub(super) fn profile_is_over(&self) -> bool {
        let runs_on = |owner: &&Entry| owner.work.manner().ending == Ending::RunsOn;
        let owner = self.owner.as_ref().filter(runs_on);
        owner.is_some_and(|owner| owner.passed || (!owner.paused && self.goal_reached()))
    }

    /// The owner brakes, or something is superimposed on it: a profile that is over stays so meanwhile.
    pub(super) fn note_end_of_profile(&mut self) {
        let is_over = self.profile_is_over();
        if let Some(owner) = &mut self.owner {
            owner.passed |= is_over;
        }
    }

    /// The owner, a profile that was due, has ended at rest. The axis may have come to rest since it became active:
    /// under a torque it moves as its drive does.
    pub(super) fn rest_due(&mut self) {
        if self.state == AxisState::ContinuousMotion {
            self.enter(AxisEvent::StartDiscrete);
        }
        self.come_to_rest();
    }

    /// A due profile cannot start.
    #[cold]
    fn drop_profile(&mut self, error: ErrorId, scope: &mut Scope<'_>) {
        self.end_owner(Fate::Failed(error));
        if self.mover.setpoint().is_at_rest() {
            self.rest_due();
        }
        self.hand_over(self.mover.setpoint().position, scope);
        if self.owner.is_none() && !self.mover.setpoint().is_at_rest() {
            self.trip(error, 0, Reaction::Ramp, scope);
        }
    }

    /// Refuses values that are wrong for any start.
    fn looked_at(&self, profile: &Profile<'_>, scope: &mut Scope<'_>) -> Result<(), ErrorId> {
        let refuse = |(pin, value, limit, error)| self.refuse(pin, value, limit, error, scope);
        let points = profile.points(0.0).map_err(refuse)?;
        let mut before = 0.0;
        for (index, point) in points.get().iter().enumerate() {
            let cause = if !point.value.is_finite() {
                Some((ProfileCause::Value, point.value))
            } else if !(point.time > before || (index == 0 && point.time == 0.0)) {
                Some((ProfileCause::Time, point.time - before))
            } else {
                None
            };
            if let Some((cause, value)) = cause {
                let fault = ProfileFault {
                    cause,
                    point: index + 1,
                    value,
                    limit: if cause == ProfileCause::Time {
                        0.0
                    } else {
                        f64::NAN
                    },
                };
                return Err(self.refuse_profile(profile, &fault, 0, scope));
            }
            before = point.time;
        }
        if before > 0.0 {
            return Ok(());
        }
        let fault = ProfileFault {
            cause: ProfileCause::Count,
            point: 0,
            value: points.count as f64,
            limit: PROFILE_POINTS as f64,
        };
        Err(self.refuse_profile(profile, &fault, 0, scope))
    }

    /// The curve from the present state. Only `entry` changes.
    fn plan_profile(
        &self,
        entry: &mut Entry,
        profile: &Profile<'_>,
        scope: &mut Scope<'_>,
    ) -> Result<Motion<P::Plan>, ErrorId> {
        let since = match entry.work {
            Work::Profile { since, .. } => since,
            _ => 0.0,
        };
        let points = profile
            .points(since)
            .map_err(|(pin, value, limit, error)| self.refuse(pin, value, limit, error, scope))?;
        if since > 0.0 {
            // It continues in its present frame.
            entry.turns = 0;
        } else {
            self.aim(entry, self.mover.setpoint().position);
        }
        let start = self
            .in_frame_of(entry, self.mover.setpoint())
            .unwrap_or(*self.mover.setpoint());
        let range = self.parameters.software_limits;
        let plan = self
            .planner
            .profile(profile.kind, &start, points.get(), &entry.limits, range)
            .map_err(|fault| self.refuse_profile(profile, &fault, points.passed, scope))?;
        self.permitted(entry, &plan, &entry.limits)
            .map_err(|error| self.refuse(profile.table_pin(), f64::NAN, f64::NAN, error, scope))?;
        entry.end = (profile.kind == ProfileKind::Position).then(|| plan.end().position);
        Ok(Motion::along(plan))
    }

    fn refuse_profile(
        &self,
        profile: &Profile<'_>,
        fault: &ProfileFault,
        passed: usize,
        scope: &mut Scope<'_>,
    ) -> ErrorId {
        let (what, error) = profile.refusal(fault);
        if fault.point == 0 {
            return self.refuse(what, fault.value, fault.limit, error, scope);
        }
        self.refuse_row(fault.point + passed, what, fault.value, fault.limit, error, scope)
    }
}

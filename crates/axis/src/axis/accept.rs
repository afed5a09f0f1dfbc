//! How an axis takes a command: it refuses it, starts it, or lets it wait.
//!
//! Source: PLCopen Motion Control Part 1, state diagram and sections on aborting and buffered commands; the
//! table "state x command" with the choices V6, V6a, V7a, V11.

use super::commands::{Asked, Ending, Entry, Place, Run, Start, Work, direction_of, refusal};
use super::{Axis, Motion};
use crate::{
    AxisEvent, AxisState, BufferMode, Command, CommandId, Direction, Dynamics, ErrorId, Fate, Raw, Request,
    Scope,
};
use standstill_planner::{Limits, Planner, Setpoint};

impl<P: Planner> Axis<P> {
    /// Takes a command, or refuses it without any effect on the axis or the queue (R38). Give a command that follows
    /// a master to [`couple`](crate::couple()), which sees all axes.
    ///
    /// Cost: at most one plan. A blended command that waits costs in addition a ramp, or at most a root
    /// of ramps, for each waiting command, and the owner's plan with a blended end.
    ///
    /// # Errors
    /// The [`ErrorId`] the block shows; the refusal is recorded with pin, value and limit. [`ErrorId::AxisUnknown`]
    /// for a command that follows a master.
    pub fn command(&mut self, request: &Request, scope: &mut Scope<'_>) -> Result<CommandId, ErrorId> {
        if request.command.follows() {
            return Err(self.refuse("Master", f64::NAN, f64::NAN, ErrorId::AxisUnknown, scope));
        }
        self.take(request, scope)
    }

    /// The same for any command.
    pub(crate) fn take(&mut self, request: &Request, scope: &mut Scope<'_>) -> Result<CommandId, ErrorId> {
        let (mode, start) = self.admit_recorded(request, scope)?;
        let (work, limits) = self.check(&request.command, start, scope)?;
        if let Work::Cam(camming) = work
            && let (Some(place), BufferMode::Aborting) = (camming.switch_at, mode)
        {
            let error = ErrorId::BufferModeNotHere;
            return Err(self.refuse("SwitchAt", place, 0.0, error, scope));
        }
        if work.waits_for_start() {
            return self.await_start(work, limits, mode, scope);
        }
        let mut entry = Entry::new(self.new_id(), scope.instance, work, limits, mode);
        entry.asked = Asked::by(&request.command, &work, limits);
        entry.direction = direction_of(&request.command);
        self.override_entry(&mut entry);
        if let (Command::MoveAdditive { .. }, Work::Position(_)) = (&request.command, work) {
            entry.from = self.commanded_target().unwrap_or(self.mover.setpoint().position);
        }
        match start {
            Start::Wait => {
                self.note_bound(&entry);
                self.queue.push(entry);
                self.arm(mode, scope);
                self.start_beside(scope);
            }
            Start::Now => {
                let in_force = *self.mover.in_force();
                if self.mover.has_not_moved(scope.scan) {
                    // The axis still moves within the limits of the motion before.
                    self.mover.keep(*self.mover.before());
                }
                self.aim(&mut entry, self.mover.setpoint().position);
                let asked = entry.limits;
                let motion = self.plan_for(&mut entry).map_err(|error| {
                    self.mover.keep(in_force);
                    self.refuse_plan(&entry, error, scope)
                })?;
                let before = self.limits_before(&entry.limits);
                let kept = self.lend_following(&entry, mode);
                self.end_all(Fate::Aborted, Fate::Aborted);
                self.keep_following(kept);
                self.begin(entry, motion, before, scope);
                self.record_raised(&asked, &entry.limits, scope);
            }
        }
        Ok(entry.id)
    }

    /// MC_Stop's Execute fell: the lock ends as soon as the axis is at rest (note 6).
    pub fn release_stop(&mut self, id: CommandId) {
        if let Some(owner) = &mut self.owner
            && owner.id == id
        {
            owner.held = false;
            if self.stop_held {
                self.end_owner(Fate::Done);
                self.enter(AxisEvent::StopReleased);
            }
        }
    }

    /// Calls [`Axis::admit`] and records a refusal.
    pub(super) fn admit_recorded(
        &self,
        request: &Request,
        scope: &mut Scope<'_>,
    ) -> Result<(BufferMode, Start), ErrorId> {
        self.admit(request).map_err(|(pin, error)| {
            let value = match pin {
                "BufferMode" => f64::from(request.buffer_mode.number()),
                "Slave" => f64::from(self.id.number()),
                _ => f64::NAN,
            };
            self.refuse(pin, value, f64::NAN, error, scope)
        })
    }

    /// The rules of the axis state.
    fn admit(&self, request: &Request) -> Result<(BufferMode, Start), (&'static str, ErrorId)> {
        let Some(mode) = request.buffer_mode.get() else {
            return Err(("BufferMode", ErrorId::BufferModeInvalid));
        };
        self.start(request, mode != BufferMode::Aborting)
            .map(|start| (mode, start))
    }

    fn start(&self, request: &Request, buffered: bool) -> Result<Start, (&'static str, ErrorId)> {
        if matches!(request.command, Command::GearOut) {
            let start = self.is_coupled().then_some(Start::Now);
            return start.ok_or(("Slave", ErrorId::NotCoupled));
        }
        if matches!(request.command, Command::CamOut) {
            let start = self.is_on_cam().then_some(Start::Now);
            return start.ok_or(("Slave", ErrorId::NotCoupled));
        }
        if self.mover.is_shaped() {
            match request.command {
                Command::Torque { .. } => return Err(("Axis", ErrorId::Shaped)),
                Command::GearIn { .. } | Command::CamIn(_) | Command::CombineAxes { .. } => {
                    return Err(("Slave", ErrorId::Shaped));
                }
                _ => {}
            }
        }
        if self.power.is_going_off() {
            return Err(("", ErrorId::PoweringOff));
        }
        let stop = matches!(request.command, Command::Stop { .. });
        let home = matches!(request.command, Command::Home { .. });
        let refuse = |error| Err(("", error));
        // MC_Home starts at rest, so it cannot follow an endless motion.
        let wait = || {
            if home && self.predecessor_is_endless() {
                refuse(ErrorId::InMotion)
            } else {
                self.wait()
            }
        };
        match self.state {
            AxisState::Disabled => refuse(ErrorId::NotPowered),
            AxisState::ErrorStop => refuse(ErrorId::InErrorStop),
            // An idle axis starts at once in every mode (B9). A command waits only in the scan in which
            // MC_Stop released the axis.
            AxisState::Standstill if buffered && !self.queue.is_empty() => wait(),
            AxisState::Standstill => Ok(Start::Now),
            AxisState::Homing if stop || (home && !buffered && !self.is_homed_by_drive()) => Ok(Start::Now),
            AxisState::Homing if buffered && !stop => wait(),
            AxisState::Homing => refuse(ErrorId::InHoming),
            // The same instance may stop again with other values (V7a).
            AxisState::Stopping
                if stop && request.replaces.is_some() && request.replaces == self.active_command() =>
            {
                Ok(Start::Now)
            }
            AxisState::Stopping if buffered && !stop && !home => self.wait(),
            AxisState::Stopping => refuse(ErrorId::InStopping),
            AxisState::DiscreteMotion | AxisState::ContinuousMotion | AxisState::SynchronizedMotion => {
                if buffered {
                    wait()
                } else if home {
                    refuse(ErrorId::InMotion)
                } else {
                    Ok(Start::Now)
                }
            }
        }
    }

    pub(super) fn wait(&self) -> Result<Start, (&'static str, ErrorId)> {
        if self.queue.len() < self.config.queue {
            Ok(Start::Wait)
        } else {
            Err(("BufferMode", ErrorId::BufferFull))
        }
    }

    /// Whether a command that waits now would follow an endless motion, and so could not start at rest.
    fn predecessor_is_endless(&self) -> bool {
        let last = self.queue.last_motion().or(self.owner.as_ref());
        last.is_some_and(Entry::is_endless)
    }

    /// Checks the values at the pins.
    pub(super) fn check(
        &self,
        command: &Command,
        start: Start,
        scope: &mut Scope<'_>,
    ) -> Result<(Work, Limits), ErrorId> {
        match *command {
            Command::MoveAbsolute {
                position,
                ref dynamics,
                direction,
            } => {
                let position = self.absolute(position, direction, scope)?;
                Ok((Work::Position(position), self.positioning(dynamics, scope)?))
            }
            Command::MoveContinuousAbsolute {
                position,
                end_velocity,
                ref dynamics,
                direction,
            } => {
                let to = Place::At(self.absolute(position, direction, scope)?);
                self.through(to, end_velocity, dynamics, scope)
            }
            Command::MoveContinuousRelative {
                distance,
                end_velocity,
                ref dynamics,
            } => {
                let to = Place::By(self.finite("Distance", distance, scope)?);
                self.through(to, end_velocity, dynamics, scope)
            }
            Command::MoveAdditive {
                distance,
                ref dynamics,
            } => {
                let distance = self.finite("Distance", distance, scope)?;
                let work = match self.commanded_target() {
                    // A waiting command counts from the end of the one before it, which is the last
                    // commanded target.
                    Some(target) if start == Start::Now => {
                        let position = self.finite("Distance", target + distance, scope)?;
                        self.inside("Distance", position, scope)?;
                        Work::Position(position)
                    }
                    _ => Work::Distance(distance),
                };
                Ok((work, self.positioning(dynamics, scope)?))
            }
            Command::MoveRelative {
                distance,
                ref dynamics,
            } => {
                let distance = self.finite("Distance", distance, scope)?;
                Ok((Work::Distance(distance), self.positioning(dynamics, scope)?))
            }
            Command::MoveVelocity {
                ref dynamics,
                direction,
            } => {
                let velocity = self.endless_velocity(dynamics.velocity, scope)?;
                let work = self.directed(velocity, direction).ok_or_else(|| {
                    let number = f64::from(direction.number());
                    self.refuse("Direction", number, f64::NAN, ErrorId::DirectionInvalid, scope)
                })?;
                Ok((work, self.resolve(dynamics, scope)?))
            }
            Command::Torque {
                torque,
                ramp,
                ref dynamics,
                direction,
            } => self.check_torque((torque, ramp), dynamics, direction, scope),
            Command::Jog {
                forward,
                distance,
                ref dynamics,
            } => self.jog(forward, distance, dynamics, scope),
            Command::Halt { ref dynamics } => Ok((Work::Halt, self.resolve(dynamics, scope)?)),
            Command::Stop { ref dynamics } => Ok((Work::Stop, self.resolve_stop(dynamics, scope)?)),
            Command::Home { position } => {
                let position = self.finite("Position", position, scope)?;
                self.in_first_turn("Position", position, scope)?;
                if !self.is_resolved(position) {
                    return Err(self.refuse("Position", position, f64::NAN, ErrorId::PositionInvalid, scope));
                }
                self.has_signals_to_home()
                    .map_err(|error| self.refuse("", f64::NAN, f64::NAN, error, scope))?;
                let limits = if self.config.homing.searches() {
                    self.resolve(&Dynamics::default(), scope)?
                } else {
                    self.config.limits
                };
                Ok((Work::Home(position), limits))
            }
            Command::GearIn {
                ref followed,
                sync,
                ref dynamics,
            } => {
                let gearing = self.check_gear(followed, sync, scope)?;
                let limits = match sync {
                    Some(_) if dynamics.velocity != 0.0 => self.positioning(dynamics, scope)?,
                    _ => self.resolve(dynamics, scope)?,
                };
                Ok((Work::Gear(gearing), limits))
            }
            Command::CombineAxes { ref masters, mode } => {
                let gearing = self.check_combination(masters, mode, scope)?;
                // The block has no dynamic values.
                Ok((Work::Gear(gearing), self.parameters.limits))
            }
            Command::CamIn(ref cam) => {
                let camming = self.check_cam_in(cam, scope)?;
                // The block has no dynamic values.
                Ok((Work::Cam(camming), self.parameters.limits))
            }
            Command::GearOut | Command::CamOut => Ok(self.release()),
        }
    }

    /// The target of an absolute move.
    fn absolute(
        &self,
        position: f64,
        direction: Raw<Direction>,
        scope: &mut Scope<'_>,
    ) -> Result<f64, ErrorId> {
        self.element("Direction", direction, ErrorId::DirectionInvalid, scope)?;
        let position = self.target(self.finite("Position", position, scope)?);
        self.in_first_turn("Position", position, scope)?;
        self.inside("Position", position, scope)?;
        if self.config.needs_homed && !self.homed {
            return Err(self.refuse("Position", position, f64::NAN, ErrorId::NotHomed, scope));
        }
        Ok(position)
    }

    /// Refuses a target outside the software limits.
    pub(super) fn inside(
        &self,
        pin: &'static str,
        target: f64,
        scope: &mut Scope<'_>,
    ) -> Result<(), ErrorId> {
        match self.allowed(target) {
            Ok(_) => Ok(()),
            Err(error) => {
                let limit = self.broken_software_limit(target);
                Err(self.refuse(pin, target, limit, error, scope))
            }
        }
    }

    /// A motion through a position.
    fn through(
        &self,
        to: Place,
        end_velocity: f64,
        dynamics: &Dynamics,
        scope: &mut Scope<'_>,
    ) -> Result<(Work, Limits), ErrorId> {
        let limits = self.positioning(dynamics, scope)?;
        let end_velocity = self.end_velocity(end_velocity, limits.velocity, scope)?;
        Ok((Work::Through { to, end_velocity }, limits))
    }

    /// The place where the owner of a discrete motion ends (u): its target, or where the ramp of MC_Halt
    /// comes to rest (V13, V13b).
    fn commanded_target(&self) -> Option<f64> {
        let owner = self.owner.as_ref()?;
        match owner.work.manner().ending {
            Ending::InPosition => owner.end,
            Ending::AtRest => Some(self.mover.end_of_plan()),
            _ => None,
        }
    }

    pub(super) fn finite(
        &self,
        pin: &'static str,
        value: f64,
        scope: &mut Scope<'_>,
    ) -> Result<f64, ErrorId> {
        if value.is_finite() {
            return Ok(value);
        }
        Err(self.refuse(pin, value, f64::NAN, ErrorId::PositionInvalid, scope))
    }

    fn positioning(&self, dynamics: &Dynamics, scope: &mut Scope<'_>) -> Result<Limits, ErrorId> {
        let velocity = self.positive_velocity("Velocity", dynamics.velocity, scope)?;
        Ok(self.resolve(dynamics, scope)?.with_velocity(velocity))
    }

    /// The sign of Velocity times the sign of Direction (V3).
    fn directed(&self, velocity: f64, direction: Raw<Direction>) -> Option<Work> {
        match direction.get()? {
            Direction::Unset | Direction::Positive => Some(Work::Velocity {
                velocity,
                along: false,
            }),
            Direction::Negative => Some(Work::Velocity {
                velocity: -velocity,
                along: false,
            }),
            Direction::Current => Some(Work::Velocity {
                velocity,
                along: true,
            }),
            Direction::ShortestWay => None,
        }
    }

    /// Plans a command from the present set-point. Its limits are raised if the axis could not stay
    /// inside its own with them. Only `entry` changes.
    pub(super) fn plan_for(&self, entry: &mut Entry) -> Result<Motion<P::Plan>, ErrorId> {
        let before = if self.passes_its_end(&entry.limits) {
            // From a blended end on, the limits of the second command apply alone (B5).
            entry.limits
        } else {
            self.limits_before(&entry.limits)
        };
        let motion = self.plan_from(entry, self.mover.setpoint(), &before)?;
        self.kept_inside(entry, motion, self.mover.setpoint(), &before)
    }

    /// Plans a command from `start`, a state of a motion within `before`. If waiting commands are one motion with it,
    /// plans to the end of the last of them; `entry` then holds their run.
    pub(super) fn plan_from(
        &self,
        entry: &mut Entry,
        start: &Setpoint,
        before: &Limits,
    ) -> Result<Motion<P::Plan>, ErrorId> {
        let framed = self.in_frame_of(entry, start);
        let start = framed.as_ref().unwrap_or(start);
        let end = match entry.end {
            Some(end) if !end.is_finite() => return Err(ErrorId::PositionInvalid),
            Some(end) => self.allowed(end)?,
            None => start.position,
        };
        let profile = self.config.profile;
        let planned = match entry.work {
            _ if entry.halted => {
                entry.run = Run::NONE;
                let ramp = self.planner.ramp_to(start, 0.0, &entry.limits, before);
                ramp.map(|ramp| self.onto_limit(ramp))
            }
            Work::Position(_) | Work::Distance(_) => match self.ahead(entry, start, before) {
                Some(plan) => Ok(plan),
                None => self.planner.move_to(profile, start, end, &entry.limits, before),
            },
            Work::Through {
                end_velocity: 0.0, ..
            } => self.planner.move_to(profile, start, end, &entry.limits, before),
            Work::Through { end_velocity, .. } if entry.passed => {
                self.planner.ramp_to(start, end_velocity, &entry.limits, before)
            }
            Work::Through { end_velocity, .. } => {
                self.planner.pass(start, end, end_velocity, &entry.limits, before)
            }
            Work::Velocity { velocity, along } => {
                let velocity = if along { velocity * entry.sign } else { velocity };
                self.not_outward(start.position, velocity)?;
                self.planner.ramp_to(start, velocity, &entry.limits, before)
            }
            Work::Gear(_) | Work::Cam(_) => return self.gear_motion(entry, start),
            Work::Release(velocity) => self.planner.ramp_to(start, velocity, &entry.limits, before),
            Work::Halt | Work::Stop => {
                let ramp = self.planner.ramp_to(start, 0.0, &entry.limits, before);
                ramp.map(|ramp| self.onto_limit(ramp))
            }
            Work::Torque { .. } => {
                let velocity = self.torque_goal(entry, start)?;
                self.planner.ramp_to(start, velocity, &entry.limits, before)
            }
            // Its times have passed.
            Work::Profile { .. } => return Err(ErrorId::ProfileInterrupted),
            Work::Home(_) => return self.homing_motion(entry, start),
            Work::SetPosition { .. } | Work::Write(_) => return Ok(Motion::Hold),
        };
        match planned {
            Ok(plan) => {
                self.permitted(entry, &plan, before)?;
                match entry.work {
                    Work::Torque { .. } if !entry.halted => Ok(self.under_torque(plan)),
                    _ => Ok(self.along(entry, plan)),
                }
            }
            Err(error) => Err(refusal(error)),
        }
    }

    /// Records why a plan was refused, with the pin that caused it.
    pub(super) fn refuse_plan(&self, entry: &Entry, error: ErrorId, scope: &mut Scope<'_>) -> ErrorId {
        let (pin, value) = match entry.work {
            Work::Position(target)
            | Work::Through {
                to: Place::At(target),
                ..
            } => ("Position", target),
            Work::Distance(distance)
            | Work::Through {
                to: Place::By(distance),
                ..
            } => ("Distance", distance),
            Work::Velocity { velocity, .. } => ("Velocity", velocity),
            Work::Gear(gearing) => ("Master", f64::from(gearing.first.master.number())),
            Work::Cam(camming) => ("Master", f64::from(camming.master.number())),
            Work::Release(_) => ("Slave", f64::from(self.id.number())),
            Work::Torque { torque, .. } => ("Torque", torque),
            Work::Halt | Work::Stop => ("Deceleration", entry.limits.deceleration),
            Work::Home(position) | Work::SetPosition { position, .. } => ("Position", position),
            Work::Profile { .. } | Work::Write(_) => ("", f64::NAN),
        };
        let limit = match error {
            ErrorId::TargetOutsideSoftwareLimits | ErrorId::OutwardFromSoftwareLimit => {
                let end = entry.end.unwrap_or(self.mover.setpoint().position);
                self.broken_software_limit(end + self.superimposed_left())
            }
            _ => f64::NAN,
        };
        self.refuse(pin, value, limit, error, scope)
    }

    /// Makes `entry` the owner; it takes over from a motion within `before`.
    pub(super) fn begin(
        &mut self,
        entry: Entry,
        motion: Motion<P::Plan>,
        before: Limits,
        scope: &mut Scope<'_>,
    ) {
        self.enter(entry.work.manner().start);
        self.mover.taken_over_in(scope.scan, before);
        self.record_slowed(&entry, &mut scope.with(entry.instance));
        self.adopt(entry, motion, scope);
        if matches!(entry.work, Work::Home(_)) {
            self.begin_homing();
        }
        if self.moves_itself() {
            // A drive that homes by itself is stopped first.
            self.mover.follow();
        }
    }
}

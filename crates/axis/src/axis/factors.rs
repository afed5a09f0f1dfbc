//! The override: factors on the velocities, accelerations and jerks of commands.
//!
//! A command keeps the values of the program beside the scaled values, so factors never multiply twice.
//! With velocity factor 0 the owner comes to rest and stays the owner: the state does not change, nothing
//! completes, and nothing takes over until the factor is raised.
//!
//! Source: PLCopen Motion Control Part 1, MC_SetOverride; S5, S6, B17, T39d, V16.

use super::Axis;
use super::commands::Entry;
use crate::{ErrorId, Scope};
use standstill_planner::{Limits, Planner};

/// Factors of an override. The axis starts with 1 for each.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Factors {
    /// Factor of velocities, at least 0.
    pub velocity: f64,
    /// Factor of accelerations and decelerations, above 0.
    pub acceleration: f64,
    /// Of jerks, above 0.
    pub jerk: f64,
}

impl Factors {
    /// No override.
    pub const ONE: Self = Self {
        velocity: 1.0,
        acceleration: 1.0,
        jerk: 1.0,
    };

    /// The factors as bits, to detect a change.
    pub fn bits(&self) -> [u64; 3] {
        [self.velocity, self.acceleration, self.jerk].map(f64::to_bits)
    }

    /// Whether the velocity is held at 0.
    pub fn halt(&self) -> bool {
        self.velocity == 0.0
    }

    /// The limits `asked`, scaled, and at most those of `axis`. With velocity factor 0 the motion is a
    /// ramp to rest, which needs no velocity above the commanded one.
    pub(super) fn of(&self, asked: &Limits, axis: &Limits) -> Limits {
        Limits {
            velocity: scaled(
                asked.velocity,
                if self.halt() { 1.0 } else { self.velocity },
                axis.velocity,
            ),
            acceleration: scaled(asked.acceleration, self.acceleration, axis.acceleration),
            deceleration: scaled(asked.deceleration, self.acceleration, axis.deceleration),
            jerk: scaled(asked.jerk, self.jerk, axis.jerk),
            snap: asked.snap,
        }
    }
}

/// `asked`, lowered to `limit`, times `factor`, in magnitude at most `limit`; 0 only if one of them is 0.
fn scaled(asked: f64, factor: f64, limit: f64) -> f64 {
    let asked = lowered(asked, limit);
    let product = asked * factor;
    // A product too small for a number means slow. It must not become 0, because no limit is 0.
    let value = if product == 0.0 && asked != 0.0 && factor != 0.0 {
        f64::MIN_POSITIVE.copysign(asked)
    } else {
        product
    };
    lowered(value, limit)
}

/// `value`, in magnitude at most `limit`.
fn lowered(value: f64, limit: f64) -> f64 {
    if value.abs() <= limit {
        value
    } else if value < 0.0 {
        -limit
    } else {
        limit
    }
}

impl<P: Planner> Axis<P> {
    /// The override in force.
    pub fn factors(&self) -> Factors {
        self.factors
    }

    /// MC_SetOverride: `factors` apply from now on, to the motion in progress, to waiting commands and to
    /// new ones. Works in every state and does not change it. Ramps to rest (MC_Halt, MC_Stop, power,
    /// errors) are not scaled.
    ///
    /// Cost: a comparison if nothing changes; otherwise the owner and a superimposed motion are planned
    /// anew.
    ///
    /// # Errors
    /// The [`ErrorId`] the block shows: a factor out of range, or a motion that could not be planned
    /// anew. Nothing changes then.
    #[inline]
    pub fn set_override(&mut self, factors: Factors, scope: &mut Scope<'_>) -> Result<(), ErrorId> {
        if factors == self.factors {
            return Ok(());
        }
        self.change_override(factors, scope)
    }

    #[inline(never)]
    fn change_override(&mut self, factors: Factors, scope: &mut Scope<'_>) -> Result<(), ErrorId> {
        let most = self.config.override_max;
        let pins = [
            ("VelFactor", factors.velocity, true),
            ("AccFactor", factors.acceleration, false),
            ("JerkFactor", factors.jerk, false),
        ];
        for (pin, value, may_be_0) in pins {
            // NaN is none of these.
            if !((value > 0.0 || (may_be_0 && value == 0.0)) && value <= most) {
                let limit = if value > most { most } else { 0.0 };
                return Err(self.refuse(pin, value, limit, ErrorId::FactorInvalid, scope));
            }
        }
        let before = self.factors;
        self.factors = factors;
        self.override_queue();
        if let Err(error) = self.override_owner(scope) {
            self.factors = before;
            self.override_queue();
            return Err(self.refuse("VelFactor", factors.velocity, f64::NAN, error, scope));
        }
        self.override_superimposed(scope);
        Ok(())
    }

    /// Scales `entry` by the override, then lowers it to the limits that slaves leave.
    pub(super) fn override_entry(&self, entry: &mut Entry) {
        self.scale_entry(entry);
        self.bound_entry(entry);
    }

    /// Scales `entry` by the override, without regard to slaves.
    pub(super) fn scale_entry(&self, entry: &mut Entry) {
        if !entry.work.manner().overridden {
            if Self::has_bound(&entry.work) {
                entry.limits = entry.asked.limits;
            }
            return;
        }
        let (factors, axis) = (&self.factors, &self.parameters.limits);
        entry.limits = factors.of(&entry.asked.limits, axis);
        // Halted by the override: the goal waits; it does not become 0.
        let factor = if factors.halt() { 1.0 } else { factors.velocity };
        let velocity = scaled(entry.asked.velocity, factor, axis.velocity);
        entry.work = entry.work.with_velocity(velocity);
        entry.halted = factors.halt();
    }

    pub(super) fn override_queue(&mut self) {
        let mut queue = self.queue;
        for entry in queue.iter_mut() {
            self.override_entry(entry);
        }
        self.queue = queue;
    }

    fn override_owner(&mut self, scope: &mut Scope<'_>) -> Result<(), ErrorId> {
        let Some(mut owner) = self.owner.filter(|owner| owner.work.manner().overridden) else {
            return Ok(());
        };
        self.note_passing(&mut owner);
        owner.is_behind |= owner.halted && self.is_past_its_end(&owner);
        self.override_entry(&mut owner);
        if !self.leaves_to_next(owner, scope) {
            self.replan(owner, scope)?;
            // A paused motion that still can't continue waits with the new factors.
            let _waits = self.resume_at_rest(scope);
        }
        self.end_orphan();
        Ok(())
    }
}

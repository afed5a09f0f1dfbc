//! `MC_SetOverride`: factors on the velocities, accelerations and jerks of an axis.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; R15, R52 to R60, V16.

use standstill_axis::{AxisId, CommandId, ErrorId, Factors, Planner};
use standstill_fb::{Block, Context, EnableCore, Group, pins};

pins! {
    in_outs {
        /// The axis to slow down or speed up.
        Axis => axis: AxisId;
    }
    inputs {
        /// The factors are written in every call while TRUE; the last written ones stay.
        Enable => enable: bool = false, "";
        /// Factor of velocities, from 0 to 1 or the `override_max` of the axis; 0 brings it to rest and keeps its
        /// state.
        VelFactor => vel_factor: f64 = 1.0, "";
        /// Factor of accelerations and decelerations, above 0.
        AccFactor => acc_factor: f64 = 1.0, "";
        /// Factor of jerks, above 0.
        JerkFactor => jerk_factor: f64 = 1.0, "";
    }
    vendor_inputs {}
    outputs {
        /// The factors are in force.
        Enabled => enabled: bool, "";
        /// Enabled, and not ended by an error.
        Busy => busy: bool, "";
        /// The factors at the pins are refused; the previous ones stay in force.
        Error => error: bool, "";
        /// Why; 0 without an error.
        ErrorID => error_id: ErrorId, "";
    }
    vendor_outputs {}
}

/// Factors that were refused, as bits, and the command that was active then.
#[derive(Clone, Copy, Debug)]
struct Refusal {
    factors: [u64; 3],
    active: Option<CommandId>,
    error: ErrorId,
}

/// State kept between calls.
#[doc(alias = "MC_SetOverride")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McSetOverride {
    core: EnableCore,
    /// The last refusal. The same factors are not tried or recorded again in every call.
    refused: Option<Refusal>,
}

fn factors_of(inputs: &Inputs) -> Factors {
    Factors {
        velocity: inputs.vel_factor,
        acceleration: inputs.acc_factor,
        jerk: inputs.jerk_factor,
    }
}

impl Block for McSetOverride {
    const NAME: &'static str = "MC_SetOverride";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str = "Sets factors on the velocities, accelerations and jerks of an axis; they hold for the motion in progress and for all that follow.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        if !inputs.enable {
            self.refused = None;
        }
        let refused = &mut self.refused;
        let written = self
            .core
            .write(inputs.enable, inputs.axis, context, |axis, scope| {
                let factors = factors_of(inputs);
                if factors == axis.factors() {
                    *refused = None;
                    return Ok(());
                }
                let bits = factors.bits();
                let active = axis.active_command();
                if let Some(refusal) = refused
                    && refusal.factors == bits
                    && refusal.active == active
                {
                    return Err(refusal.error);
                }
                let taken = axis.set_override(factors, scope);
                *refused = taken.err().map(|error| Refusal {
                    factors: bits,
                    active,
                    error,
                });
                taken
            });
        Outputs {
            enabled: written.is_valid(),
            busy: written.is_busy(),
            error: written.is_error(),
            error_id: written.error_id(),
        }
    }
}

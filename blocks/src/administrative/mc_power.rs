//! `MC_Power`: switches the power stage of an axis.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; V9, V9a, V9b. `Enable` switches the power
//! stage, not the block (R60). With several instances on one axis the last call in the scan decides.

use standstill_axis::{AxisId, ErrorId, Permission, Planner};
use standstill_fb::{Block, Context, Group, pins};

pins! {
    in_outs {
        /// The axis to switch.
        Axis => axis: AxisId;
    }
    inputs {
        /// Power is requested while TRUE.
        Enable => enable: bool = false, "";
        /// Motion in positive direction is permitted. With FALSE a command that needs it is refused. A motion that
        /// needs it brakes with the stop dynamics, stays Busy, and continues when it is permitted again.
        EnablePositive => enable_positive: bool = true, "";
        /// The same for the negative direction.
        EnableNegative => enable_negative: bool = true, "";
    }
    vendor_inputs {}
    outputs {
        /// The power stage is really on.
        Status => status: bool, "";
        /// Status can be relied on.
        Valid => valid: bool, "";
        /// The block cannot do what its inputs ask, or the drive has not done it in time; power is then not
        /// requested.
        Error => error: bool, "";
        /// Why; 0 without an error.
        ErrorID => error_id: ErrorId, "";
    }
    vendor_outputs {}
}

/// Keeps no state: it works on the level of its inputs.
#[doc(alias = "MC_Power")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McPower;

impl Block for McPower {
    const NAME: &'static str = "MC_Power";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str = "Switches the power stage of an axis.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    // One of the two blocks that nearly every axis calls in every scan.
    #[inline(always)]
    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let (axis, scope) = match context.axis(inputs.axis) {
            Ok(found) => found,
            Err(id) if inputs.enable => return refused(id),
            Err(_) => return Outputs::default(),
        };
        let permitted = Permission {
            positive: inputs.enable_positive,
            negative: inputs.enable_negative,
        };
        axis.set_power(inputs.enable, permitted, scope);
        let status = axis.is_powered();
        match axis.power_error().filter(|_| inputs.enable) {
            Some(error) => Outputs {
                status,
                ..refused(error)
            },
            None => Outputs {
                status,
                valid: inputs.enable,
                ..Outputs::default()
            },
        }
    }
}

#[cold]
fn refused(error_id: ErrorId) -> Outputs {
    Outputs {
        error: true,
        error_id,
        ..Outputs::default()
    }
}

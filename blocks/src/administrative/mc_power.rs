//! `MC_Power`: switches the power stage of an axis.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; V9, V9a, V9b. `Enable` switches the power
//! stage, not the block (R60). With several instances on one axis the last call in the scan decides.

use standstill_axis::{AxisId, ErrorId, Planner};
use standstill_fb::{Block, Context, Group, pins};

pins! {
    in_outs {
        /// The axis to switch.
        Axis => axis: AxisId;
    }
    inputs {
        /// Power is wanted as long as TRUE.
        Enable => enable: bool = false, "";
        /// Motion in positive direction is permitted; FALSE is not supported yet.
        EnablePositive => enable_positive: bool = true, "";
        /// Motion in negative direction is permitted; FALSE is not supported yet.
        EnableNegative => enable_negative: bool = true, "";
    }
    vendor_inputs {}
    outputs {
        /// The power stage is really on.
        Status => status: bool, "";
        /// Status can be relied on.
        Valid => valid: bool, "";
        /// The block cannot do what its inputs ask; power is then not wanted.
        Error => error: bool, "";
        /// Why; 0 without an error.
        ErrorID => error_id: ErrorId, "";
    }
    vendor_outputs {}
}

/// Keeps nothing: level in, level out.
#[doc(alias = "MC_Power")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McPower;

impl Block for McPower {
    const NAME: &'static str = "MC_Power";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str = "Switches the power stage of an axis.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    // Called in every scan: in line, the outputs of the usual case are one constant.
    #[inline(always)]
    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let (axis, log, source) = match context.axis(inputs.axis) {
            Ok(found) => found,
            Err(id) if inputs.enable => return refused(false, id),
            Err(_) => return Outputs::default(),
        };
        if inputs.enable && !(inputs.enable_positive && inputs.enable_negative) {
            axis.set_power(false, source, log);
            return refused(axis.is_powered(), ErrorId::DirectionEnableUnsupported);
        }
        axis.set_power(inputs.enable, source, log);
        Outputs {
            status: axis.is_powered(),
            valid: inputs.enable,
            ..Outputs::default()
        }
    }
}

fn refused(status: bool, error_id: ErrorId) -> Outputs {
    Outputs {
        status,
        error: true,
        error_id,
        ..Outputs::default()
    }
}

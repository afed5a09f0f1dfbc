//! `MC_ReadStatus`: the state of an axis.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; rules R52 to R59.

use standstill_axis::{AxisId, AxisState, ErrorId, Planner};
use standstill_fb::{Block, Context, Group, pins};

pins! {
    in_outs {
        /// The axis to read.
        Axis => axis: AxisId;
    }
    inputs {
        /// Read in every call while TRUE.
        Enable => enable: bool = false, "";
    }
    vendor_inputs {}
    outputs {
        /// The other outputs can be relied on.
        Valid => valid: bool, "";
        /// Enabled.
        Busy => busy: bool, "";
        /// The block cannot read.
        Error => error: bool, "";
        /// Why; 0 without an error.
        ErrorID => error_id: ErrorId, "";
        /// The axis is in this state.
        ErrorStop => error_stop: bool, "";
        /// The axis is in this state.
        Disabled => disabled: bool, "";
        /// The axis is in this state.
        Stopping => stopping: bool, "";
        /// The axis is in this state.
        Homing => homing: bool, "";
        /// The axis is in this state.
        Standstill => standstill: bool, "";
        /// The axis is in this state.
        DiscreteMotion => discrete_motion: bool, "";
        /// The axis is in this state.
        ContinuousMotion => continuous_motion: bool, "";
        /// The axis is in this state.
        SynchronizedMotion => synchronized_motion: bool, "";
    }
    vendor_outputs {}
}

/// Keeps nothing: reads in every call.
#[doc(alias = "MC_ReadStatus")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McReadStatus;

impl Block for McReadStatus {
    const NAME: &'static str = "MC_ReadStatus";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str = "Reads the state of an axis.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        if !inputs.enable {
            return Outputs::default();
        }
        match context.axes.get(inputs.axis.index()) {
            Some(axis) => Outputs {
                valid: true,
                busy: true,
                error_stop: axis.state() == AxisState::ErrorStop,
                disabled: axis.state() == AxisState::Disabled,
                stopping: axis.state() == AxisState::Stopping,
                homing: axis.state() == AxisState::Homing,
                standstill: axis.state() == AxisState::Standstill,
                discrete_motion: axis.state() == AxisState::DiscreteMotion,
                continuous_motion: axis.state() == AxisState::ContinuousMotion,
                synchronized_motion: axis.state() == AxisState::SynchronizedMotion,
                ..Outputs::default()
            },
            // Not recoverable: the pin is wired to nothing (R57).
            None => Outputs {
                error: true,
                error_id: ErrorId::AxisUnknown,
                ..Outputs::default()
            },
        }
    }
}

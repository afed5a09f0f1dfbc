//! `MC_ReadStatus`: the state of an axis.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; rules R52 to R59.

use standstill_axis::{AxisId, AxisState, Planner};
use standstill_fb::{Block, Context, EnableCore, Group, pins};

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
        ..reading;
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

/// State kept between calls.
#[doc(alias = "MC_ReadStatus")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McReadStatus {
    core: EnableCore,
}

impl Block for McReadStatus {
    const NAME: &'static str = "MC_ReadStatus";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str = "Reads the state of an axis.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let reading = self
            .core
            .scan(inputs.enable, inputs.axis, context, |axis| Ok(Some(axis.state())));
        let state = reading.value();
        Outputs {
            error_stop: state == Some(AxisState::ErrorStop),
            disabled: state == Some(AxisState::Disabled),
            stopping: state == Some(AxisState::Stopping),
            homing: state == Some(AxisState::Homing),
            standstill: state == Some(AxisState::Standstill),
            discrete_motion: state == Some(AxisState::DiscreteMotion),
            continuous_motion: state == Some(AxisState::ContinuousMotion),
            synchronized_motion: state == Some(AxisState::SynchronizedMotion),
            ..(&reading).into()
        }
    }
}

//! `MC_ReadMotionState`: the state of the motion of an axis.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; rules R52 to R59, V12b.

use standstill_axis::{AxisId, Pace, Planner, Raw, ValueSource, Way};
use standstill_fb::{Block, Context, EnableCore, Group, pins};

pins! {
    in_outs {
        /// The axis to read.
        Axis => axis: AxisId;
    }
    inputs {
        /// Read in every call while TRUE.
        Enable => enable: bool = false, "";
        /// The values to evaluate; may change while Enable is TRUE.
        Source => source: Raw<ValueSource> = ValueSource::Set.into(), "";
    }
    vendor_inputs {}
    outputs {
        ..reading;
        /// The velocity is constant, 0 included. Set values may change only in steps; actual ones must stay within
        /// a window.
        ConstantVelocity => constant_velocity: bool, "";
        /// The magnitude of the velocity grows.
        Accelerating => accelerating: bool, "";
        /// The magnitude of the velocity shrinks.
        Decelerating => decelerating: bool, "";
        /// The position increases. For set values: it is commanded to increase.
        DirectionPositive => direction_positive: bool, "";
        /// The position decreases. For set values: it is commanded to decrease.
        DirectionNegative => direction_negative: bool, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_ReadMotionState")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McReadMotionState {
    core: EnableCore,
}

impl Block for McReadMotionState {
    const NAME: &'static str = "MC_ReadMotionState";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str =
        "Reads whether an axis speeds up, slows down or keeps its velocity, and in which direction it moves.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let reading = self.core.scan(inputs.enable, inputs.axis, context, |axis| {
            axis.motion_state(inputs.source).map(Some)
        });
        let state = reading.value();
        let (pace, way) = (state.map(|state| state.pace), state.map(|state| state.way));
        Outputs {
            constant_velocity: pace == Some(Pace::Constant),
            accelerating: pace == Some(Pace::Accelerating),
            decelerating: pace == Some(Pace::Decelerating),
            direction_positive: way == Some(Way::Positive),
            direction_negative: way == Some(Way::Negative),
            ..(&reading).into()
        }
    }
}

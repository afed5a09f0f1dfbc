//! `MC_ReadDigitalInput`: a digital input of a drive.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; rules R52 to R59, V26.

use standstill_axis::Planner;
use standstill_fb::{Block, Context, EnableCore, Group, InputRef, Int, pins};

pins! {
    in_outs {
        /// The axis whose drive has the input.
        Input => input: InputRef;
    }
    inputs {
        /// Read in every call while TRUE.
        Enable => enable: bool = false, "";
        /// Which input, from 0 to 31.
        InputNumber => input_number: Int = 0, "";
    }
    vendor_inputs {}
    outputs {
        ..reading;
        /// Its level, as latched in this scan; shorter pulses are missed.
        Value => value: bool, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_ReadDigitalInput")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McReadDigitalInput {
    core: EnableCore,
}

impl Block for McReadDigitalInput {
    const NAME: &'static str = "MC_ReadDigitalInput";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str = "Reads a digital input of a drive.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let reading = self
            .core
            .scan(inputs.enable, inputs.input.into(), context, |axis| {
                axis.digital_input(inputs.input_number)
            });
        Outputs {
            value: reading.value(),
            ..(&reading).into()
        }
    }
}

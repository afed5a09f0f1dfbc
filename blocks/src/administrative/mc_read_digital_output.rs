//! `MC_ReadDigitalOutput`: a digital output of a drive.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; rules R52 to R59, V26.

use standstill_axis::Planner;
use standstill_fb::{Block, Context, EnableCore, Group, Int, OutputRef, pins};

pins! {
    in_outs {
        /// The axis whose drive has the output.
        Output => output: OutputRef;
    }
    inputs {
        /// Read in every call while TRUE.
        Enable => enable: bool = false, "";
        /// Which output, from 0 to 31.
        OutputNumber => output_number: Int = 0, "";
    }
    vendor_inputs {}
    outputs {
        ..reading;
        /// The level that the drive shows, as latched in this scan: it was written in the scan before.
        Value => value: bool, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_ReadDigitalOutput")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McReadDigitalOutput {
    core: EnableCore,
}

impl Block for McReadDigitalOutput {
    const NAME: &'static str = "MC_ReadDigitalOutput";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str = "Reads back a digital output of a drive.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let reading = self
            .core
            .scan(inputs.enable, inputs.output.into(), context, |axis| {
                axis.digital_output(inputs.output_number)
            });
        Outputs {
            value: reading.value(),
            ..(&reading).into()
        }
    }
}

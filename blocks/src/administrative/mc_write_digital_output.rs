//! `MC_WriteDigitalOutput`: writes a digital output of a drive once.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; V26.

use standstill_axis::{ExecutionMode, Planner, Raw};
use standstill_fb::{Block, Context, ExecuteCore, Group, Int, OutputRef, pins};

pins! {
    in_outs {
        /// The axis whose drive has the output.
        Output => output: OutputRef;
    }
    inputs {
        /// A rising edge writes the values of that call.
        Execute => execute: bool = false, "";
        /// Which output, from 0 to 31.
        OutputNumber => output_number: Int = 0, "";
        /// The level to write.
        Value => value: bool = false, "";
        /// At once, or like a buffered motion.
        ExecutionMode => execution_mode: Raw<ExecutionMode> = Raw::new(0), "";
    }
    vendor_inputs {}
    outputs {
        /// Written: the drive has it from the end of this scan on, queued from that of the scan before.
        Done => done: bool, "";
        ..queued;
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_WriteDigitalOutput")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McWriteDigitalOutput {
    core: ExecuteCore,
}

impl Block for McWriteDigitalOutput {
    const NAME: &'static str = "MC_WriteDigitalOutput";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str = "Writes a digital output of a drive once.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let output = inputs.output.into();
        let phase = self.core.scan(inputs.execute, output, context, |axis, _, scope| {
            axis.write_output(inputs.output_number, inputs.value, inputs.execution_mode, scope)
        });
        Outputs {
            done: phase.is_done(),
            ..phase.into()
        }
    }
}

//! `MC_CamOut`: a slave leaves its cam and keeps its velocity.
//!
//! Source: PLCopen Motion Control Part 1, section of that name.

use standstill_axis::{AxisId, Command, ErrorId, Planner, Request};
use standstill_fb::{Block, Context, ExecuteCore, Group, pins};

pins! {
    in_outs {
        /// The axis that MC_CamIn has coupled to a master.
        Slave => slave: AxisId;
    }
    inputs {
        /// A rising edge ends the coupling.
        Execute => execute: bool = false, "";
    }
    vendor_inputs {}
    outputs {
        /// The coupling has ended.
        Done => done: bool, "";
        /// Not finished.
        Busy => busy: bool, "";
        /// Refused, or ended by an error.
        Error => error: bool, "";
        /// Why; 0 without an error.
        ErrorID => error_id: ErrorId, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_CamOut")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McCamOut {
    core: ExecuteCore,
}

impl Block for McCamOut {
    const NAME: &'static str = "MC_CamOut";
    const GROUP: Group = Group::MultiAxis;
    const DOC: &'static str = "Ends MC_CamIn; the slave keeps its velocity.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let phase = self
            .core
            .scan_among(inputs.execute, inputs.slave, context, |context, replaces| {
                let (axis, scope) = context.slave(inputs.slave)?;
                let request = Request {
                    replaces,
                    ..Request::aborting(Command::CamOut)
                };
                axis.command(&request, scope)
            });
        Outputs {
            done: phase.is_done(),
            busy: phase.is_busy(),
            error: phase.is_error(),
            error_id: phase.error_id(),
        }
    }
}

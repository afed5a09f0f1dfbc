//! `MC_Halt`: a controlled stop that other commands may interrupt.
//!
//! Source: PLCopen Motion Control Part 1, section of that name.

use standstill_axis::{AxisId, BufferMode, Command, Dynamics, Planner, Raw, Request};
use standstill_fb::{Block, Context, ExecuteCore, Group, pins};

pins! {
    in_outs {
        /// The axis to move.
        Axis => axis: AxisId;
    }
    inputs {
        /// A rising edge starts the stop with the values of that call.
        Execute => execute: bool = false, "";
        /// Rate while the speed falls; 0 takes the axis default.
        Deceleration => deceleration: f64 = 0.0, "u/s^2";
        /// Jerk; 0 takes the axis default, and no limit if there is none.
        Jerk => jerk: f64 = 0.0, "u/s^3";
        /// How the command follows the one before it.
        BufferMode => buffer_mode: Raw<BufferMode> = Raw::new(0), "";
    }
    vendor_inputs {
        ..snap;
    }
    outputs {
        /// The axis is at rest.
        Done => done: bool, "";
        ..motion;
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_Halt")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McHalt {
    core: ExecuteCore,
}

impl Block for McHalt {
    const NAME: &'static str = "MC_Halt";
    const GROUP: Group = Group::SingleAxis;
    const DOC: &'static str = "Brings one axis to velocity zero; other commands may interrupt.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let phase = self
            .core
            .scan(inputs.execute, inputs.axis, context, |axis, replaces, scope| {
                let request = Request {
                    command: Command::Halt {
                        dynamics: Dynamics::braking(inputs.deceleration, inputs.jerk, inputs.snap),
                    },
                    buffer_mode: inputs.buffer_mode,
                    replaces,
                };
                axis.command(&request, scope)
            });
        Outputs {
            done: phase.is_done(),
            ..phase.into()
        }
    }
}

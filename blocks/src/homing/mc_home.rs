//! `MC_Home`: the axis searches its reference and sets its position there.
//!
//! Source: PLCopen Motion Control Part 1, section of that name.
//!
//! The configuration of the axis decides what to search and how: see `docs/homing.md`.

use standstill_axis::{AxisId, BufferMode, Command, Planner, Raw, Request};
use standstill_fb::{Block, Context, ExecuteCore, Group, pins};

pins! {
    in_outs {
        /// The axis to move.
        Axis => axis: AxisId;
    }
    inputs {
        /// A rising edge starts the homing with the values of that call.
        Execute => execute: bool = false, "";
        /// Position of the reference; finite.
        Position => position: f64 = 0.0, "u";
        /// How the command follows the one before it.
        BufferMode => buffer_mode: Raw<BufferMode> = Raw::new(0), "";
    }
    vendor_inputs {}
    outputs {
        /// The reference is found, its position is set, and the axis is at rest.
        Done => done: bool, "";
        ..motion;
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_Home")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McHome {
    core: ExecuteCore,
}

impl Block for McHome {
    const NAME: &'static str = "MC_Home";
    const GROUP: Group = Group::Homing;
    const DOC: &'static str =
        "Finds the reference of an axis as its configuration says, and sets its position.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let phase = self
            .core
            .scan(inputs.execute, inputs.axis, context, |axis, replaces, scope| {
                let request = Request {
                    command: Command::Home {
                        position: inputs.position,
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

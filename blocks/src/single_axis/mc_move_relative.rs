//! `MC_MoveRelative`: one axis by a distance.
//!
//! Source: PLCopen Motion Control Part 1, section of that name.

use standstill_axis::{AxisId, BufferMode, Command, Planner, Raw};
use standstill_fb::{Block, Context, Group, Move, UpdateCore, pins};

pins! {
    in_outs {
        /// The axis to move.
        Axis => axis: AxisId;
    }
    inputs {
        /// A rising edge starts the move with the values of that call.
        Execute => execute: bool = false, "";
        /// Changed inputs hold for the motion in progress while TRUE, if it was TRUE at the rising edge.
        ContinuousUpdate => continuous_update: bool = false, "";
        /// Signed distance from the set position at the start; finite.
        Distance => distance: f64 = 0.0, "u";
        /// Largest velocity, above 0; not necessarily reached.
        Velocity => velocity: f64 = 0.0, "u/s";
        ..rates;
        /// How the command follows the one before it.
        BufferMode => buffer_mode: Raw<BufferMode> = Raw::new(0), "";
    }
    vendor_inputs {
        ..snap;
    }
    outputs {
        /// The distance is covered.
        Done => done: bool, "";
        ..motion;
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_MoveRelative")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McMoveRelative {
    core: UpdateCore<Command>,
}

impl Block for McMoveRelative {
    const NAME: &'static str = "MC_MoveRelative";
    const GROUP: Group = Group::SingleAxis;
    const DOC: &'static str = "Moves one axis by a distance from its set position at the start.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let pins = Move {
            axis: inputs.axis,
            execute: inputs.execute,
            continuous_update: inputs.continuous_update,
        };
        let values = || Command::MoveRelative {
            distance: inputs.distance,
            dynamics: inputs.dynamics(inputs.velocity),
        };
        let phase = self.core.command(pins, inputs.buffer_mode, context, values);
        Outputs {
            done: phase.is_done(),
            ..phase.into()
        }
    }
}

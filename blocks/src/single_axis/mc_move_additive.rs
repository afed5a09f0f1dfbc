//! `MC_MoveAdditive`: one axis by a distance, added to its last commanded position.
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
        /// Signed distance from the last commanded target; finite. Without such a target, from the set position at
        /// the start: in Standstill, and behind or during an endless motion.
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
#[doc(alias = "MC_MoveAdditive")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McMoveAdditive {
    core: UpdateCore<Command>,
}

impl Block for McMoveAdditive {
    const NAME: &'static str = "MC_MoveAdditive";
    const GROUP: Group = Group::SingleAxis;
    const DOC: &'static str = "Moves one axis by a distance from its last commanded target.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let pins = Move {
            axis: inputs.axis,
            execute: inputs.execute,
            continuous_update: inputs.continuous_update,
        };
        let values = || Command::MoveAdditive {
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

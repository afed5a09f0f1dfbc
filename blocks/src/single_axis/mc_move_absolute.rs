//! `MC_MoveAbsolute`: one axis to one position.
//!
//! Source: PLCopen Motion Control Part 1, section of that name.

use standstill_axis::{AxisId, BufferMode, Command, Direction, Planner, Raw};
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
        /// Target in axis coordinates; finite.
        Position => position: f64 = 0.0, "u";
        /// Largest velocity, above 0; not necessarily reached.
        Velocity => velocity: f64 = 0.0, "u/s";
        ..rates;
        /// Direction of travel on a modulo axis; ignored on a linear one.
        Direction => direction: Raw<Direction> = Raw::new(0), "";
        /// How the command follows the one before it.
        BufferMode => buffer_mode: Raw<BufferMode> = Raw::new(0), "";
    }
    vendor_inputs {
        ..snap;
    }
    outputs {
        /// The target is reached.
        Done => done: bool, "";
        ..motion;
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_MoveAbsolute")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McMoveAbsolute {
    core: UpdateCore<Command>,
}

impl Block for McMoveAbsolute {
    const NAME: &'static str = "MC_MoveAbsolute";
    const GROUP: Group = Group::SingleAxis;
    const DOC: &'static str = "Moves one axis to an absolute position.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    // One of the two blocks that nearly every axis calls in every scan.
    #[inline(always)]
    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let pins = Move {
            axis: inputs.axis,
            execute: inputs.execute,
            continuous_update: inputs.continuous_update,
        };
        let values = || Command::MoveAbsolute {
            position: inputs.position,
            direction: inputs.direction,
            dynamics: inputs.dynamics(inputs.velocity),
        };
        let phase = self.core.command(pins, inputs.buffer_mode, context, values);
        Outputs {
            done: phase.is_done(),
            ..phase.into()
        }
    }
}

//! `MC_MoveVelocity`: an endless motion at a velocity.
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
        /// A rising edge starts the motion with the values of that call.
        Execute => execute: bool = false, "";
        /// Changed inputs hold for the motion in progress while TRUE, if it was TRUE at the rising edge.
        ContinuousUpdate => continuous_update: bool = false, "";
        /// Velocity to reach; signed, 0 allowed.
        Velocity => velocity: f64 = 0.0, "u/s";
        ..rates;
        /// mcPositiveDirection, mcNegativeDirection or mcCurrentDirection; its sign multiplies that of Velocity.
        Direction => direction: Raw<Direction> = Raw::new(0), "";
        /// How the command follows the one before it.
        BufferMode => buffer_mode: Raw<BufferMode> = Raw::new(0), "";
    }
    vendor_inputs {
        ..snap;
    }
    outputs {
        /// The set velocity is the commanded one.
        InVelocity => in_velocity: bool, "";
        ..motion;
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_MoveVelocity")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McMoveVelocity {
    core: UpdateCore<Command>,
}

impl Block for McMoveVelocity {
    const NAME: &'static str = "MC_MoveVelocity";
    const GROUP: Group = Group::SingleAxis;
    const DOC: &'static str = "Moves one axis endlessly at a velocity.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let pins = Move {
            axis: inputs.axis,
            execute: inputs.execute,
            continuous_update: inputs.continuous_update,
        };
        let values = || Command::MoveVelocity {
            direction: inputs.direction,
            dynamics: inputs.dynamics(inputs.velocity),
        };
        let phase = self.core.command(pins, inputs.buffer_mode, context, values);
        Outputs {
            in_velocity: phase.is_reached(),
            ..phase.into()
        }
    }
}

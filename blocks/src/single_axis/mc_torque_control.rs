//! `MC_TorqueControl`: commands a torque instead of a position.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; V25.

use standstill_axis::{AxisId, BufferMode, Command, Direction, Dynamics, Planner, Raw};
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
        /// Torque or force to hold, in the unit of the drive; signed, positive towards larger positions.
        Torque => torque: f64 = 0.0, "torque";
        /// Largest rate of change of the torque ordered; 0 for no ramp.
        TorqueRamp => torque_ramp: f64 = 0.0, "torque/s";
        /// Largest speed, above 0; 0 takes the axis limit.
        Velocity => velocity: f64 = 0.0, "u/s";
        /// Rate at which the velocity limit moves away from 0; 0 takes the axis default.
        Acceleration => acceleration: f64 = 0.0, "u/s^2";
        /// Rate at which the velocity limit moves towards 0; 0 takes the axis default.
        Deceleration => deceleration: f64 = 0.0, "u/s^2";
        /// Jerk of the velocity limit; 0 takes the axis default, and no limit if there is none.
        Jerk => jerk: f64 = 0.0, "u/s^3";
        /// mcPositiveDirection, mcNegativeDirection or mcCurrentDirection; its sign multiplies that of Torque.
        Direction => direction: Raw<Direction> = Raw::new(0), "";
        /// How the command follows the one before it.
        BufferMode => buffer_mode: Raw<BufferMode> = Raw::new(0), "";
    }
    vendor_inputs {
        /// Snap of the velocity limit; 0 takes the axis default, and no limit if there is none.
        Snap => snap: f64 = 0.0, "u/s^4";
    }
    outputs {
        /// The torque ordered is the commanded one, and nothing limits it.
        InTorque => in_torque: bool, "";
        ..motion;
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_TorqueControl")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McTorqueControl {
    core: UpdateCore<Command>,
}

impl Block for McTorqueControl {
    const NAME: &'static str = "MC_TorqueControl";
    const GROUP: Group = Group::SingleAxis;
    const DOC: &'static str = "Holds a torque with one axis, within a velocity.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let pins = Move {
            axis: inputs.axis,
            execute: inputs.execute,
            continuous_update: inputs.continuous_update,
        };
        let values = || Command::Torque {
            torque: inputs.torque,
            ramp: inputs.torque_ramp,
            direction: inputs.direction,
            dynamics: Dynamics {
                velocity: inputs.velocity,
                acceleration: inputs.acceleration,
                deceleration: inputs.deceleration,
                jerk: inputs.jerk,
                snap: inputs.snap,
            },
        };
        let phase = self.core.command(pins, inputs.buffer_mode, context, values);
        Outputs {
            in_torque: phase.is_reached(),
            ..phase.into()
        }
    }
}

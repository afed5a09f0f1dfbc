//! `MC_MoveContinuousRelative`: one axis by a distance; it then continues at a given velocity.
//!
//! Source: PLCopen Motion Control Part 1, section of that name.

use standstill_axis::{AxisId, BufferMode, Command, Dynamics, ErrorId, Planner, Raw, Request};
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
        /// Signed distance from the set position at the start; finite.
        Distance => distance: f64 = 0.0, "u";
        /// Velocity at the target and from there on; signed, its magnitude at most Velocity, 0 allowed.
        EndVelocity => end_velocity: f64 = 0.0, "u/s";
        /// Largest velocity, above 0; not necessarily reached.
        Velocity => velocity: f64 = 0.0, "u/s";
        /// Rate while the speed grows; 0 takes the axis default.
        Acceleration => acceleration: f64 = 0.0, "u/s^2";
        /// Rate while the speed falls; 0 takes the axis default.
        Deceleration => deceleration: f64 = 0.0, "u/s^2";
        /// Jerk; 0 takes the axis default, and no limit if there is none.
        Jerk => jerk: f64 = 0.0, "u/s^3";
        /// How the command follows the one before it.
        BufferMode => buffer_mode: Raw<BufferMode> = Raw::new(0), "";
    }
    vendor_inputs {
        /// Snap; 0 takes the axis default, and no limit if there is none.
        Snap => snap: f64 = 0.0, "u/s^4";
    }
    outputs {
        /// The distance is covered and the axis runs at the end velocity.
        InEndVelocity => in_end_velocity: bool, "";
        /// Not finished.
        Busy => busy: bool, "";
        /// The block controls the axis.
        Active => active: bool, "";
        /// Interrupted by another command.
        CommandAborted => command_aborted: bool, "";
        /// Refused, or ended by an error.
        Error => error: bool, "";
        /// Why; 0 without an error.
        ErrorID => error_id: ErrorId, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_MoveContinuousRelative")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McMoveContinuousRelative {
    core: UpdateCore<Command>,
}

impl Block for McMoveContinuousRelative {
    const NAME: &'static str = "MC_MoveContinuousRelative";
    const GROUP: Group = Group::SingleAxis;
    const DOC: &'static str = "Moves one axis by a distance and keeps it going at an end velocity.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let pins = Move {
            axis: inputs.axis,
            execute: inputs.execute,
            continuous_update: inputs.continuous_update,
        };
        let values = || Command::MoveContinuousRelative {
            distance: inputs.distance,
            end_velocity: inputs.end_velocity,
            dynamics: Dynamics {
                velocity: inputs.velocity,
                acceleration: inputs.acceleration,
                deceleration: inputs.deceleration,
                jerk: inputs.jerk,
                snap: inputs.snap,
            },
        };
        let phase = self
            .core
            .scan(pins, context, values, |axis, command, replaces, scope| {
                let request = Request {
                    command,
                    buffer_mode: inputs.buffer_mode,
                    replaces,
                };
                axis.command(&request, scope)
            });
        Outputs {
            in_end_velocity: phase.is_reached(),
            busy: phase.is_busy(),
            active: phase.is_active(),
            command_aborted: phase.is_aborted(),
            error: phase.is_error(),
            error_id: phase.error_id(),
        }
    }
}

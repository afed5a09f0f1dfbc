//! `MC_Stop`: a controlled stop that locks the axis.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; points S1 to S3.

use standstill_axis::{AxisId, BufferMode, Command, CommandId, Dynamics, ErrorId, Planner, Request};
use standstill_fb::{Block, Context, ExecuteCore, Group, pins};

pins! {
    in_outs {
        /// The axis to move.
        Axis => axis: AxisId;
    }
    inputs {
        /// A rising edge starts the stop; the axis stays locked while TRUE.
        Execute => execute: bool = false, "";
        /// Rate while the speed falls; 0 takes the axis default.
        Deceleration => deceleration: f64 = 0.0, "u/s^2";
        /// Jerk; 0 takes the axis default, and no limit if there is none.
        Jerk => jerk: f64 = 0.0, "u/s^3";
    }
    vendor_inputs {
        ..snap;
    }
    outputs {
        /// The velocity is zero.
        Done => done: bool, "";
        /// Not finished.
        Busy => busy: bool, "";
        /// Interrupted by switching power off.
        CommandAborted => command_aborted: bool, "";
        /// Refused, or ended by an error.
        Error => error: bool, "";
        /// Why; 0 without an error.
        ErrorID => error_id: ErrorId, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_Stop")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McStop {
    core: ExecuteCore,
    /// The stop that locks the axis until Execute falls; the lock remains after `Done`.
    lock: Option<(AxisId, CommandId)>,
}

impl Block for McStop {
    const NAME: &'static str = "MC_Stop";
    const GROUP: Group = Group::SingleAxis;
    const DOC: &'static str = "Brings one axis to velocity zero and locks it while Execute is TRUE.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let lock = &mut self.lock;
        let phase = self
            .core
            .scan(inputs.execute, inputs.axis, context, |axis, replaces, scope| {
                let request = Request {
                    command: Command::Stop {
                        dynamics: Dynamics::braking(inputs.deceleration, inputs.jerk, inputs.snap),
                    },
                    buffer_mode: BufferMode::Aborting.into(),
                    replaces,
                };
                let id = axis.command(&request, scope)?;
                *lock = Some((inputs.axis, id));
                Ok(id)
            });
        if !inputs.execute
            && let Some((axis, id)) = self.lock.take()
            && let Some(axis) = context.axes.get_mut(axis.index())
        {
            axis.release_stop(id);
        }
        Outputs {
            done: phase.is_done(),
            busy: phase.is_busy(),
            command_aborted: phase.is_aborted(),
            error: phase.is_error(),
            error_id: phase.error_id(),
        }
    }
}

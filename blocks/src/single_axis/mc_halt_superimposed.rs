//! `MC_HaltSuperimposed`: stops the superimposed motion; the motion under it continues.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; V14a.

use standstill_axis::{AxisId, Dynamics, ErrorId, Planner};
use standstill_fb::{Block, Context, ExecuteCore, Group, pins};

pins! {
    in_outs {
        /// The axis to move.
        Axis => axis: AxisId;
    }
    inputs {
        /// A rising edge starts the stop with the values of that call.
        Execute => execute: bool = false, "";
        /// Rate while the speed of the added motion falls; 0 takes the axis default.
        Deceleration => deceleration: f64 = 0.0, "u/s^2";
        /// Jerk; 0 takes the axis default, and no limit if there is none.
        Jerk => jerk: f64 = 0.0, "u/s^3";
    }
    vendor_inputs {
        ..snap;
    }
    outputs {
        /// No superimposed motion is in progress.
        Done => done: bool, "";
        /// Not finished.
        Busy => busy: bool, "";
        /// Interrupted by another command.
        CommandAborted => command_aborted: bool, "";
        /// Refused, or ended by an error.
        Error => error: bool, "";
        /// Why; 0 without an error.
        ErrorID => error_id: ErrorId, "";
    }
    vendor_outputs {
        /// The added motion is the block's; FALSE while it waits for room below the axis limits.
        Active => active: bool, "";
    }
}

/// State kept between calls.
#[doc(alias = "MC_HaltSuperimposed")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McHaltSuperimposed {
    core: ExecuteCore,
}

impl Block for McHaltSuperimposed {
    const NAME: &'static str = "MC_HaltSuperimposed";
    const GROUP: Group = Group::SingleAxis;
    const DOC: &'static str = "Stops what is superimposed on the motion of one axis, which goes on.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let phase = self
            .core
            .scan(inputs.execute, inputs.axis, context, |axis, _, scope| {
                let dynamics = Dynamics::braking(inputs.deceleration, inputs.jerk, inputs.snap);
                axis.halt_superimposed(&dynamics, scope)
            });
        Outputs {
            done: phase.is_done(),
            busy: phase.is_busy(),
            command_aborted: phase.is_aborted(),
            error: phase.is_error(),
            error_id: phase.error_id(),
            active: phase.is_active(),
        }
    }
}

//! `MC_MoveSuperimposed`: a distance on top of the motion in progress.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; rules R51, R65, R66, S9, V14.

use standstill_axis::{AxisId, CommandId, Dynamics, ErrorId, Planner, Superimpose};
use standstill_fb::{Block, Context, Group, Move, UpdateCore, pins};

pins! {
    in_outs {
        /// The axis to move.
        Axis => axis: AxisId;
    }
    inputs {
        /// A rising edge starts the added motion with the values of that call.
        Execute => execute: bool = false, "";
        /// Changed inputs hold for the added motion while TRUE, if it was TRUE at the rising edge.
        ContinuousUpdate => continuous_update: bool = false, "";
        /// Signed distance to add; finite.
        Distance => distance: f64 = 0.0, "u";
        /// Largest velocity of the added motion, above 0; not necessarily reached.
        VelocityDiff => velocity_diff: f64 = 0.0, "u/s";
        /// Rate while the speed of the added motion grows; 0 takes the axis default.
        Acceleration => acceleration: f64 = 0.0, "u/s^2";
        /// Rate while the speed of the added motion falls; 0 takes the axis default.
        Deceleration => deceleration: f64 = 0.0, "u/s^2";
        /// Jerk of the added motion; 0 takes the axis default, and no limit if there is none.
        Jerk => jerk: f64 = 0.0, "u/s^3";
    }
    vendor_inputs {
        /// Snap of the added motion; 0 takes the axis default, and no limit if there is none.
        Snap => snap: f64 = 0.0, "u/s^4";
    }
    outputs {
        /// The distance is added.
        Done => done: bool, "";
        /// Not finished.
        Busy => busy: bool, "";
        /// Interrupted by another command.
        CommandAborted => command_aborted: bool, "";
        /// Refused, or ended by an error.
        Error => error: bool, "";
        /// Why; 0 without an error.
        ErrorID => error_id: ErrorId, "";
        /// Distance added since the rising edge; kept until the next one.
        CoveredDistance => covered_distance: f64, "u";
    }
    vendor_outputs {
        /// The added motion is the block's; FALSE while it waits for room below the axis limits.
        Active => active: bool, "";
    }
}

/// State kept between calls.
#[doc(alias = "MC_MoveSuperimposed")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McMoveSuperimposed {
    core: UpdateCore<Superimpose>,
    command: Option<(AxisId, CommandId)>,
    covered: f64,
}

impl Block for McMoveSuperimposed {
    const NAME: &'static str = "MC_MoveSuperimposed";
    const GROUP: Group = Group::SingleAxis;
    const DOC: &'static str = "Adds a distance to the motion in progress, which keeps its time and path.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let pins = Move {
            axis: inputs.axis,
            execute: inputs.execute,
            continuous_update: inputs.continuous_update,
        };
        let values = || Superimpose {
            distance: inputs.distance,
            dynamics: Dynamics {
                velocity: inputs.velocity_diff,
                acceleration: inputs.acceleration,
                deceleration: inputs.deceleration,
                jerk: inputs.jerk,
                snap: inputs.snap,
            },
        };
        let (command, covered) = (&mut self.command, &mut self.covered);
        let phase = self.core.scan(pins, context, values, |axis, request, _, scope| {
            (*command, *covered) = (None, 0.0);
            let id = axis.superimpose(&request, scope)?;
            *command = Some((inputs.axis, id));
            Ok(id)
        });
        if let Some((axis, id)) = self.command {
            if let Some(now) = context
                .axes
                .get(axis.index())
                .and_then(|axis| axis.covered_distance(id))
            {
                self.covered = now;
            }
            if !phase.is_busy() {
                self.command = None;
            }
        }
        Outputs {
            done: phase.is_done(),
            busy: phase.is_busy(),
            command_aborted: phase.is_aborted(),
            error: phase.is_error(),
            error_id: phase.error_id(),
            covered_distance: self.covered,
            active: phase.is_active(),
        }
    }
}

//! `MC_TouchProbe`: the position of an axis at an event.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; V23, T39 g.

use standstill_axis::{AxisId, CommandId, ErrorId, Planner, Raw, TouchProbe, Trigger};
use standstill_fb::{Block, Context, ExecuteCore, Group, pins};

pins! {
    in_outs {
        /// The axis.
        Axis => axis: AxisId;
        /// The probe of its drive, and the edge; mcProbe1Rising if it is left out.
        TriggerInput => trigger_input: Raw<Trigger>;
    }
    inputs {
        /// A rising edge arms the probe for one event; it arms a waiting probe anew.
        Execute => execute: bool = false, "";
        /// TRUE: only an event inside the window counts.
        WindowOnly => window_only: bool = false, "";
        /// Start of the window in positive direction, included.
        FirstPosition => first_position: f64 = 0.0, "u";
        /// End of the window, included; on a modulo axis the window may pass the end of the modulo range.
        LastPosition => last_position: f64 = 0.0, "u";
    }
    vendor_inputs {}
    outputs {
        /// An event was recorded.
        Done => done: bool, "";
        /// Waiting for an event.
        Busy => busy: bool, "";
        /// MC_AbortTrigger ended the waiting.
        CommandAborted => command_aborted: bool, "";
        /// Refused.
        Error => error: bool, "";
        /// Why; 0 without an error.
        ErrorID => error_id: ErrorId, "";
        /// Position at the event, in the coordinates in force then; it stays until the next event is recorded.
        RecordedPosition => recorded_position: f64, "u";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_TouchProbe")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McTouchProbe {
    core: ExecuteCore,
    /// The last command that was accepted, until it ends.
    given: Option<(AxisId, CommandId)>,
    recorded: f64,
}

impl Block for McTouchProbe {
    const NAME: &'static str = "MC_TouchProbe";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str = "Records the position of an axis at the first event of a probe input.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let given = &mut self.given;
        // A command still waits for the probe after a refused edge. The core forgets it, so the block
        // keeps it here.
        let phase = self
            .core
            .scan_among(inputs.execute, inputs.axis, context, |context, _| {
                let held = given.filter(|(axis, _)| *axis == inputs.axis).map(|(_, id)| id);
                let (axis, scope) = context.axis(inputs.axis)?;
                let request = TouchProbe {
                    trigger: inputs.trigger_input,
                    window: inputs
                        .window_only
                        .then_some((inputs.first_position, inputs.last_position)),
                    replaces: held,
                };
                let id = axis.touch_probe(&request, scope)?;
                // The Axis pin may have changed since.
                if let Some((elsewhere, id)) = given.replace((inputs.axis, id))
                    && elsewhere != inputs.axis
                    && let Ok((axis, ..)) = context.axis(elsewhere)
                {
                    axis.forget_probe(id);
                }
                Ok(id)
            });
        if phase.is_done()
            && let Some((axis, id)) = self.given.take()
            && let Some(position) = context
                .axes
                .get(axis.index())
                .and_then(|axis| axis.recorded_position(id))
        {
            self.recorded = position;
        }
        Outputs {
            done: phase.is_done(),
            busy: phase.is_busy(),
            command_aborted: phase.is_aborted(),
            error: phase.is_error(),
            error_id: phase.error_id(),
            recorded_position: self.recorded,
        }
    }
}

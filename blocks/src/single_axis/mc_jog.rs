//! `MC_Jog`: moves an axis by hand, as long as a button is held or by a step.
//!
//! Source: none, this block is not in the PLCopen standard. Its pins and outputs follow the rules R8 and R19 to R38
//! as far as the level of two buttons has an edge. docs/jogging.md describes the block.

use standstill_axis::{Axis, AxisId, Command, CommandId, Dynamics, ErrorId, Fate, Planner, Request, Scope};
use standstill_fb::{Block, Context, Group, Phase, pins};

pins! {
    in_outs {
        /// The axis to move.
        Axis => axis: AxisId;
    }
    inputs {}
    vendor_inputs {
        /// TRUE moves towards larger positions, with the values of the call in which it rises. FALSE, or both TRUE,
        /// stops.
        JogForward => jog_forward: bool = false, "";
        /// The same towards smaller positions.
        JogBackward => jog_backward: bool = false, "";
        /// Length of a step, after which the axis stops even if the button is held; 0 moves while it is held.
        Distance => distance: f64 = 0.0, "u";
        /// Largest velocity; above 0, the buttons give the direction.
        Velocity => velocity: f64 = 0.0, "u/s";
        /// Rate while the speed grows; 0 takes the axis default.
        Acceleration => acceleration: f64 = 0.0, "u/s^2";
        /// Rate while the speed falls, at the release too; 0 takes the axis default.
        Deceleration => deceleration: f64 = 0.0, "u/s^2";
        /// Jerk; 0 takes the axis default, and no limit if there is none.
        Jerk => jerk: f64 = 0.0, "u/s^3";
        ..snap;
    }
    outputs {}
    vendor_outputs {
        /// The axis is at rest after the release or the step.
        Done => done: bool, "";
        /// Moving, or braking after the release.
        Busy => busy: bool, "";
        /// The block controls the axis.
        Active => active: bool, "";
        /// Interrupted by another command; the button has to be released before the next try.
        CommandAborted => command_aborted: bool, "";
        /// Refused, or ended by an error; the button has to be released before the next try.
        Error => error: bool, "";
        /// Why; 0 without an error.
        ErrorID => error_id: ErrorId, "";
    }
}

/// A command of this block, and the values for its stop.
#[derive(Clone, Copy, Debug)]
struct Given {
    axis: AxisId,
    id: CommandId,
    dynamics: Dynamics,
}

/// State kept between calls.
#[doc(alias = "MC_Jog")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McJog {
    /// The button held in the last call: TRUE is forward, FALSE backward.
    held: Option<bool>,
    given: Option<Given>,
    /// The last result; not used while there is a command.
    phase: Phase,
}

/// The active button, forward or backward. Both together count as none.
fn button(inputs: &Inputs) -> Option<bool> {
    match (inputs.jog_forward, inputs.jog_backward) {
        (true, false) => Some(true),
        (false, true) => Some(false),
        (true, true) | (false, false) => None,
    }
}

impl McJog {
    /// A button is pressed: starts a motion, which replaces the one of this instance.
    fn press<P: Planner>(
        &mut self,
        forward: bool,
        inputs: &Inputs,
        context: &mut Context<'_, P>,
    ) -> Result<Given, ErrorId> {
        let (axis, scope) = context.axis(inputs.axis)?;
        let dynamics = Dynamics {
            velocity: inputs.velocity,
            acceleration: inputs.acceleration,
            deceleration: inputs.deceleration,
            jerk: inputs.jerk,
            snap: inputs.snap,
        };
        let command = Command::Jog {
            forward,
            distance: inputs.distance,
            dynamics,
        };
        let id = axis.command(&Request::aborting(command), scope)?;
        Ok(Given {
            axis: inputs.axis,
            id,
            dynamics,
        })
    }

    /// No button, or both: stops the motion of this instance.
    fn release<P: Planner>(&mut self, context: &mut Context<'_, P>) -> Result<(), ErrorId> {
        let Some(given) = &mut self.given else {
            return Ok(());
        };
        let (axis, scope) = context.axis(given.axis)?;
        if Phase::from(axis.fate(given.id)).is_busy() {
            let gentle = halt(axis, given.dynamics, scope);
            // If the gentle ramp would take too long, the axis must still stop.
            given.id = gentle.or_else(|_| halt(axis, Dynamics::default(), scope))?;
        }
        Ok(())
    }

    /// A button was pressed or released.
    fn change<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Result<(), ErrorId> {
        let Some(forward) = self.held else {
            return self.release(context);
        };
        if self.given.is_some_and(|given| given.axis != inputs.axis) {
            // This press moves another axis, and no button holds the motion of the one before.
            let released = self.release(context);
            self.given = None;
            released?;
        }
        match self.press(forward, inputs, context) {
            Ok(given) => {
                self.given = Some(given);
                Ok(())
            }
            Err(error) => {
                // The other button is released: its motion must not continue.
                let released = self.release(context);
                self.given = None;
                released.and(Err(error))
            }
        }
    }

    fn phase<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Phase {
        let held = button(inputs);
        if held != self.held {
            self.held = held;
            if let Err(error) = self.change(inputs, context) {
                self.phase = Fate::Failed(error).into();
                return self.phase;
            }
        }
        let phase = match &self.given {
            Some(given) => match context.axes.get(given.axis.index()) {
                Some(axis) => axis.fate(given.id).into(),
                None => Fate::Failed(ErrorId::AxisUnknown).into(),
            },
            // A result shown in an earlier call disappears when no button is held.
            None if held.is_none() => Phase::default(),
            None => self.phase,
        };
        if !phase.is_busy() {
            self.given = None;
        }
        self.phase = phase;
        phase
    }
}

/// MC_Halt with these values.
fn halt<P: Planner>(
    axis: &mut Axis<P>,
    dynamics: Dynamics,
    scope: &mut Scope<'_>,
) -> Result<CommandId, ErrorId> {
    axis.command(&Request::aborting(Command::Halt { dynamics }), scope)
}

impl Block for McJog {
    const NAME: &'static str = "MC_Jog";
    const GROUP: Group = Group::SingleAxis;
    const DOC: &'static str =
        "Moves one axis by hand, while a button is held or by a step. Vendor extension, not in the standard.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let phase = self.phase(inputs, context);
        Outputs {
            done: phase.is_done(),
            busy: phase.is_busy(),
            active: phase.is_active(),
            command_aborted: phase.is_aborted(),
            error: phase.is_error(),
            error_id: phase.error_id(),
        }
    }
}

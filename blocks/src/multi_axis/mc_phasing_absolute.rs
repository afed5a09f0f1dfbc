//! `MC_PhasingAbsolute`: shifts the master's position as its slave sees it, to an absolute value.
//!
//! Source: PLCopen Motion Control Part 1, section of that name.

use standstill_axis::{AxisId, BufferMode, Dynamics, ErrorId, PhaseShift, Planner, Raw};
use standstill_fb::{Block, Context, ExecuteCore, Group, pins};

pins! {
    in_outs {
        /// The axis that is followed.
        Master => master: AxisId;
        /// The axis that follows it.
        Slave => slave: AxisId;
    }
    inputs {
        /// A rising edge shifts the master as the slave sees it.
        Execute => execute: bool = false, "";
        /// Distance by which the slave sees the master ahead of its position; below 0 behind.
        PhaseShift => phase_shift: f64 = 0.0, "u";
        /// Largest speed of the shift; 0 takes what the slave's limits leave.
        Velocity => velocity: f64 = 0.0, "u/s";
        /// Rate while that speed grows; 0 takes what the slave's limits leave.
        Acceleration => acceleration: f64 = 0.0, "u/s^2";
        /// Rate while that speed falls; the lower of the two rates holds. 0 takes what the slave's limits leave.
        Deceleration => deceleration: f64 = 0.0, "u/s^2";
        /// Jerk of the shift; 0 takes what the slave's limits leave.
        Jerk => jerk: f64 = 0.0, "u/s^3";
        /// How the shift follows one in progress: mcAborting takes over, the other modes wait for its end.
        BufferMode => buffer_mode: Raw<BufferMode> = Raw::new(0), "";
    }
    vendor_inputs {
        /// Snap of the shift; 0 takes what the slave's limits leave.
        Snap => snap: f64 = 0.0, "u/s^4";
    }
    outputs {
        /// The shift is reached.
        Done => done: bool, "";
        /// Not finished.
        Busy => busy: bool, "";
        /// The shift moves; FALSE while it waits for room.
        Active => active: bool, "";
        /// Interrupted by another phasing, or the coupling has ended.
        CommandAborted => command_aborted: bool, "";
        /// Refused, or ended by an error.
        Error => error: bool, "";
        /// Why; 0 without an error.
        ErrorID => error_id: ErrorId, "";
        /// The present shift, updated while Busy.
        AbsolutePhaseShift => absolute_phase_shift: f64, "u";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_PhasingAbsolute")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McPhasingAbsolute {
    core: ExecuteCore,
    /// The shift in the last call in which it changed.
    shift: f64,
    was_busy: bool,
}

impl Block for McPhasingAbsolute {
    const NAME: &'static str = "MC_PhasingAbsolute";
    const GROUP: Group = Group::MultiAxis;
    const DOC: &'static str =
        "Shifts the place of a master, as its slave sees it, to a distance from where it is.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let phase = self
            .core
            .scan_among(inputs.execute, inputs.slave, context, |context, _| {
                let (slave, scope) = context.slave(inputs.slave)?;
                let request = PhaseShift {
                    master: inputs.master,
                    shift: inputs.phase_shift,
                    is_relative: false,
                    dynamics: Dynamics {
                        velocity: inputs.velocity,
                        acceleration: inputs.acceleration,
                        deceleration: inputs.deceleration,
                        jerk: inputs.jerk,
                        snap: inputs.snap,
                    },
                    buffer_mode: inputs.buffer_mode,
                };
                slave.shift_phase(&request, scope)
            });
        let slave = context.axes.get(inputs.slave.index());
        if let Some(slave) = slave.filter(|_| phase.is_busy() || self.was_busy) {
            self.shift = slave.phase_of(inputs.master);
        }
        self.was_busy = phase.is_busy();
        Outputs {
            done: phase.is_done(),
            busy: phase.is_busy(),
            active: phase.is_active(),
            command_aborted: phase.is_aborted(),
            error: phase.is_error(),
            error_id: phase.error_id(),
            absolute_phase_shift: self.shift,
        }
    }
}

//! `MC_AccelerationProfile`: a motion along a curve of acceleration over time.
//!
//! Source: PLCopen Motion Control Part 1, section of that name. docs/profiles.md describes the curve.

use super::profile::{Pins, Point, Points, ProfileCore, Shape};
use standstill_axis::{AxisId, BufferMode, Planner, ProfileKind, ProfileRow, Raw};
use standstill_fb::{Block, Context, Group, Time, pins, record};

record! {
    /// A point of an acceleration profile.
    pub struct AccelerationPoint = "MC_TA_REF" {
        /// Time since the point before, above 0; for the first point since the start, where 0 is allowed.
        DeltaTime => delta_time: Time, "";
        /// Acceleration there, signed: above 0 towards larger positions.
        Acceleration => acceleration: f64, "u/s^2";
        /// The curve is level there: no jerk.
        Level => level: bool, "";
    }
}

impl Point for AccelerationPoint {
    const KIND: ProfileKind = ProfileKind::Acceleration;
    const PIN: &'static str = "TimeAcceleration";

    fn row(&self) -> ProfileRow {
        ProfileRow {
            delta_ns: self.delta_time.0,
            value: self.acceleration,
            level: self.level,
        }
    }
}

pins! {
    in_outs {
        /// The axis to move.
        Axis => axis: AxisId;
        /// The points, at most 40.
        TimeAcceleration => time_acceleration: Points<AccelerationPoint>;
    }
    inputs {
        /// A rising edge starts the profile with the values of that call.
        Execute => execute: bool = false, "";
        /// Changed inputs hold for the points still ahead while TRUE, if it was TRUE at the rising edge.
        ContinuousUpdate => continuous_update: bool = false, "";
        /// Factor of all times, above 0.
        TimeScale => time_scale: f64 = 1.0, "";
        /// Factor of all accelerations.
        AccelerationScale => acceleration_scale: f64 = 1.0, "";
        /// Added to all accelerations.
        Offset => offset: f64 = 0.0, "u/s^2";
        /// How the command follows the one before it. It starts at rest or in the state in which the one before
        /// ends.
        BufferMode => buffer_mode: Raw<BufferMode> = Raw::new(0), "";
    }
    vendor_inputs {}
    outputs {
        /// The last point is reached and the acceleration has faded out; the axis keeps its velocity.
        ProfileCompleted => profile_completed: bool, "";
        ..motion;
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_AccelerationProfile")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McAccelerationProfile {
    core: ProfileCore<AccelerationPoint>,
}

impl Block for McAccelerationProfile {
    const NAME: &'static str = "MC_AccelerationProfile";
    const GROUP: Group = Group::SingleAxis;
    const DOC: &'static str = "Moves one axis along a curve of acceleration over time.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let pins = Pins {
            axis: inputs.axis,
            execute: inputs.execute,
            continuous_update: inputs.continuous_update,
            buffer_mode: inputs.buffer_mode,
        };
        let shape = Shape {
            table: inputs.time_acceleration,
            time_scale: inputs.time_scale,
            scale: inputs.acceleration_scale,
            offset: inputs.offset,
        };
        let phase = self.core.scan(&pins, &shape, context);
        Outputs {
            profile_completed: phase.is_done(),
            ..phase.into()
        }
    }
}

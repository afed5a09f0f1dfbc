//! `MC_PositionProfile`: a motion along a curve of position over time.
//!
//! Source: PLCopen Motion Control Part 1, section of that name. docs/profiles.md describes the curve.

use super::profile::{Pins, Point, Points, ProfileCore, Shape};
use standstill_axis::{AxisId, BufferMode, Planner, ProfileKind, ProfileRow, Raw};
use standstill_fb::{Block, Context, Group, Time, pins, record};

record! {
    /// A point of a position profile.
    pub struct PositionPoint = "MC_TP_REF" {
        /// Time since the point before, above 0; for the first point since the start, where 0 is allowed.
        DeltaTime => delta_time: Time, "";
        /// Position there.
        Position => position: f64, "u";
        /// The curve is level there: the axis is at rest, without acceleration and jerk.
        Level => level: bool, "";
    }
}

impl Point for PositionPoint {
    const KIND: ProfileKind = ProfileKind::Position;
    const PIN: &'static str = "TimePosition";

    fn row(&self) -> ProfileRow {
        ProfileRow {
            delta_ns: self.delta_time.0,
            value: self.position,
            level: self.level,
        }
    }
}

pins! {
    in_outs {
        /// The axis to move.
        Axis => axis: AxisId;
        /// The points, at most 40.
        TimePosition => time_position: Points<PositionPoint>;
    }
    inputs {
        /// A rising edge starts the profile with the values of that call.
        Execute => execute: bool = false, "";
        /// Changed inputs hold for the points still ahead while TRUE, if it was TRUE at the rising edge.
        ContinuousUpdate => continuous_update: bool = false, "";
        /// Factor of all times, above 0.
        TimeScale => time_scale: f64 = 1.0, "";
        /// Factor of all positions.
        PositionScale => position_scale: f64 = 1.0, "";
        /// Added to all positions.
        Offset => offset: f64 = 0.0, "u";
        /// How the command follows the one before it. It starts at rest or in the state in which the one before
        /// ends.
        BufferMode => buffer_mode: Raw<BufferMode> = Raw::new(0), "";
    }
    vendor_inputs {}
    outputs {
        /// The axis is at rest on the last point.
        Done => done: bool, "";
        ..motion;
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_PositionProfile")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McPositionProfile {
    core: ProfileCore<PositionPoint>,
}

impl Block for McPositionProfile {
    const NAME: &'static str = "MC_PositionProfile";
    const GROUP: Group = Group::SingleAxis;
    const DOC: &'static str = "Moves one axis along a curve of position over time.";
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
            table: inputs.time_position,
            time_scale: inputs.time_scale,
            scale: inputs.position_scale,
            offset: inputs.offset,
        };
        let phase = self.core.scan(&pins, &shape, context);
        Outputs {
            done: phase.is_done(),
            ..phase.into()
        }
    }
}

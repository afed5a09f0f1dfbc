//! `MC_GearIn`: a slave follows a master by a ratio.
//!
//! Source: PLCopen Motion Control Part 1, section of that name.

use standstill_axis::{
    Axis, AxisId, BufferMode, Command, Dynamics, Followed, Planner, Raw, Request, ValueSource, couple,
};
use standstill_fb::{Block, Context, Group, Move, UpdateCore, pins};

pins! {
    in_outs {
        /// The axis to follow.
        Master => master: AxisId;
        /// The axis that follows.
        Slave => slave: AxisId;
    }
    inputs {
        /// A rising edge couples the axes with the values of that call.
        Execute => execute: bool = false, "";
        /// Changed inputs hold for the coupling in progress while TRUE, if it was TRUE at the rising edge.
        ContinuousUpdate => continuous_update: bool = false, "";
        /// Travel of the slave for that of the master, as a ratio: numerator, signed; 0 brings the slave to rest.
        RatioNumerator => ratio_numerator: i16 = 0, "";
        /// Denominator of the ratio, above 0.
        RatioDenominator => ratio_denominator: u16 = 0, "";
        /// mcSetValue, or mcActualValue for the filtered feedback of the master's drive.
        MasterValueSource => master_value_source: Raw<ValueSource> = Raw::new(1), "";
        /// Rate while the speed grows, until in gear; 0 takes the axis default.
        Acceleration => acceleration: f64 = 0.0, "u/s^2";
        /// Rate while the speed falls, until in gear; 0 takes the axis default.
        Deceleration => deceleration: f64 = 0.0, "u/s^2";
        /// Jerk until in gear; 0 takes the axis default, and no limit if there is none.
        Jerk => jerk: f64 = 0.0, "u/s^3";
        /// How the command follows the one before it.
        BufferMode => buffer_mode: Raw<BufferMode> = Raw::new(0), "";
    }
    vendor_inputs {
        /// Snap until in gear; 0 takes the axis default, and no limit if there is none.
        Snap => snap: f64 = 0.0, "u/s^4";
    }
    outputs {
        /// The set position of the slave is the one that the ratio demands.
        InGear => in_gear: bool, "";
        ..coupling;
    }
    vendor_outputs {
        /// Distance of the slave from its position in gear, once it was in gear; 0 in gear.
        Deviation => deviation: f64, "u";
        /// The master went out of operation; the slave is at rest until it is coupled again (axis key
        /// coupling.on_master_lost).
        MasterLost => master_lost: bool, "";
    }
}

/// State kept between calls.
#[doc(alias = "MC_GearIn")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McGearIn {
    core: UpdateCore<Command>,
}

impl Block for McGearIn {
    const NAME: &'static str = "MC_GearIn";
    const GROUP: Group = Group::MultiAxis;
    const DOC: &'static str = "Lets one axis follow another by a ratio.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let pins = Move {
            axis: inputs.slave,
            execute: inputs.execute,
            continuous_update: inputs.continuous_update,
        };
        let values = |context: &Context<'_, P>| Command::GearIn {
            followed: Followed {
                master: context.master(inputs.master),
                numerator: inputs.ratio_numerator,
                denominator: inputs.ratio_denominator.into(),
                source: inputs.master_value_source,
            },
            sync: None,
            dynamics: Dynamics {
                velocity: 0.0,
                acceleration: inputs.acceleration,
                deceleration: inputs.deceleration,
                jerk: inputs.jerk,
                snap: inputs.snap,
            },
        };
        let phase = self
            .core
            .scan_among(pins, context, values, |context, command, replaces| {
                let request = Request {
                    command,
                    buffer_mode: inputs.buffer_mode,
                    replaces,
                };
                couple(context.axes, inputs.slave, &request, &mut context.scope)
            });
        if phase.is_reached() {
            // There is nothing else to report.
            return Outputs {
                in_gear: true,
                busy: true,
                active: true,
                ..Outputs::default()
            };
        }
        self.out_of_gear(context.axes.get(inputs.slave.index()))
    }
}

impl McGearIn {
    /// The outputs while the slave is not in gear, or not by this block.
    #[inline(never)]
    fn out_of_gear<P: Planner>(&self, slave: Option<&Axis<P>>) -> Outputs {
        let phase = self.core.phase();
        let slave = slave.filter(|_| phase.is_active());
        Outputs {
            deviation: slave.map_or(0.0, |slave| slave.deviation()),
            master_lost: slave.is_some_and(|slave| slave.has_lost_master()),
            ..phase.into()
        }
    }
}

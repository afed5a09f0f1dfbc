//! `MC_CombineAxes`: a slave follows the sum of the travels of two masters.
//!
//! Source: PLCopen Motion Control Part 1, section of that name.

use standstill_axis::{
    AxisId, BufferMode, CombineMode, Command, Followed, Planner, Raw, Request, ValueSource, couple,
};
use standstill_fb::{Block, Context, Group, Move, UpdateCore, pins};

pins! {
    in_outs {
        /// The first axis to follow.
        Master1 => master1: AxisId;
        /// The second axis to follow; it may be the same one.
        Master2 => master2: AxisId;
        /// The axis that follows.
        Slave => slave: AxisId;
    }
    inputs {
        /// A rising edge couples the axes with the values of that call.
        Execute => execute: bool = false, "";
        /// Changed inputs hold for the coupling in progress while TRUE, if it was TRUE at the rising edge.
        ContinuousUpdate => continuous_update: bool = false, "";
        /// mcAddAxes: the travels of both masters are added; mcSubAxes: that of the second is subtracted.
        CombineMode => combine_mode: Raw<CombineMode> = Raw::new(0), "";
        /// Travel of the slave for that of the first master, as a ratio: numerator, signed, 0 allowed.
        GearRatioNumeratorM1 => gear_ratio_numerator_m1: i16 = 1, "";
        /// Denominator of that ratio, above 0.
        GearRatioDenominatorM1 => gear_ratio_denominator_m1: i16 = 1, "";
        /// Travel of the slave for that of the second master: numerator, signed, 0 allowed.
        GearRatioNumeratorM2 => gear_ratio_numerator_m2: i16 = 1, "";
        /// Denominator of that ratio, above 0.
        GearRatioDenominatorM2 => gear_ratio_denominator_m2: i16 = 1, "";
        /// Which values of the first master are followed.
        MasterValueSourceM1 => master_value_source_m1: Raw<ValueSource> = Raw::new(1), "";
        /// Which values of the second master are followed.
        MasterValueSourceM2 => master_value_source_m2: Raw<ValueSource> = Raw::new(1), "";
        /// How the command follows the one before it.
        BufferMode => buffer_mode: Raw<BufferMode> = Raw::new(0), "";
    }
    vendor_inputs {}
    outputs {
        /// The set position of the slave is the one that the masters demand.
        InSync => in_sync: bool, "";
        ..coupling;
    }
    vendor_outputs {
        /// Distance of the slave from its position in sync, once it was in sync; 0 in sync.
        Deviation => deviation: f64, "u";
        /// A master went out of operation; the slave is at rest until it is coupled again (axis key
        /// coupling.on_master_lost).
        MasterLost => master_lost: bool, "";
    }
}

/// State kept between calls.
#[doc(alias = "MC_CombineAxes")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McCombineAxes {
    core: UpdateCore<Command>,
}

impl Block for McCombineAxes {
    const NAME: &'static str = "MC_CombineAxes";
    const GROUP: Group = Group::MultiAxis;
    const DOC: &'static str = "Lets one axis follow two others at once: their ways are added, or subtracted.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let pins = Move {
            axis: inputs.slave,
            execute: inputs.execute,
            continuous_update: inputs.continuous_update,
        };
        let values = |context: &Context<'_, P>| {
            let first = Followed {
                master: context.master(inputs.master1),
                numerator: inputs.gear_ratio_numerator_m1,
                denominator: inputs.gear_ratio_denominator_m1.into(),
                source: inputs.master_value_source_m1,
            };
            let second = Followed {
                master: context.master(inputs.master2),
                numerator: inputs.gear_ratio_numerator_m2,
                denominator: inputs.gear_ratio_denominator_m2.into(),
                source: inputs.master_value_source_m2,
            };
            Command::CombineAxes {
                masters: [first, second],
                mode: inputs.combine_mode,
            }
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
        let slave = context.axes.get(inputs.slave.index());
        let slave = slave.filter(|_| phase.is_active());
        Outputs {
            in_sync: phase.is_reached(),
            deviation: slave.map_or(0.0, |slave| slave.deviation()),
            master_lost: slave.is_some_and(|slave| slave.has_lost_master()),
            ..phase.into()
        }
    }
}

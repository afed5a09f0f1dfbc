//! `MC_GearInPos`: a slave follows a master by a ratio, synchronized at given positions of both.
//!
//! Source: PLCopen Motion Control Part 1, section of that name.

use standstill_axis::{
    AxisId, BufferMode, Command, Dynamics, Followed, Planner, Raw, Request, SyncMode, SyncPoint, ValueSource,
    couple,
};
use standstill_fb::{Block, Context, ExecuteCore, Group, pins};

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
        /// Travel of the slave for that of the master, as a ratio: numerator, signed; 0 brings the slave to rest.
        RatioNumerator => ratio_numerator: i16 = 0, "";
        /// Denominator of the ratio, above 0.
        RatioDenominator => ratio_denominator: u16 = 0, "";
        /// mcSetValue, or mcActualValue for the filtered feedback of the master's drive.
        MasterValueSource => master_value_source: Raw<ValueSource> = Raw::new(1), "";
        /// Position of the master at the sync point.
        MasterSyncPosition => master_sync_position: f64 = 0.0, "u";
        /// Position of the slave at the sync point.
        SlaveSyncPosition => slave_sync_position: f64 = 0.0, "u";
        /// On a modulo slave, selects one of the equivalent positions; with mcSlowDown the slave is never faster
        /// than in sync.
        SyncMode => sync_mode: Raw<SyncMode> = Raw::new(0), "";
        /// Distance of the master before its sync point at which the slave starts. Above 0 for a master that moves
        /// forwards, below 0 for one that moves backwards. 0 starts at once.
        MasterStartDistance => master_start_distance: f64 = 0.0, "u";
        /// Largest speed from StartSync until InSync; 0 takes the axis limit.
        Velocity => velocity: f64 = 0.0, "u/s";
        /// Rate while the speed grows, until in sync; 0 takes the axis default.
        Acceleration => acceleration: f64 = 0.0, "u/s^2";
        /// Rate while the speed falls, until in sync; 0 takes the axis default.
        Deceleration => deceleration: f64 = 0.0, "u/s^2";
        /// Jerk until in sync; 0 takes the axis default, and no limit if there is none.
        Jerk => jerk: f64 = 0.0, "u/s^3";
        /// How the command follows the one before it; mcAborting with a MasterStartDistance.
        BufferMode => buffer_mode: Raw<BufferMode> = Raw::new(0), "";
    }
    vendor_inputs {
        /// Snap until in sync; 0 takes the axis default, and no limit if there is none.
        Snap => snap: f64 = 0.0, "u/s^4";
    }
    outputs {
        /// The slave approaches the sync point; FALSE from InSync on.
        StartSync => start_sync: bool, "";
        /// The set position of the slave is the one that the ratio demands.
        InSync => in_sync: bool, "";
        ..coupling;
    }
    vendor_outputs {
        /// Distance of the slave from its position in sync; 0 in sync.
        Deviation => deviation: f64, "u";
        /// The master went out of operation; the slave is at rest until it is coupled again (axis key
        /// coupling.on_master_lost).
        MasterLost => master_lost: bool, "";
    }
}

/// State kept between calls.
#[doc(alias = "MC_GearInPos")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McGearInPos {
    core: ExecuteCore,
}

impl Block for McGearInPos {
    const NAME: &'static str = "MC_GearInPos";
    const GROUP: Group = Group::MultiAxis;
    const DOC: &'static str = "Lets one axis follow another by a ratio, through a given place of both.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let phase = self
            .core
            .scan_among(inputs.execute, inputs.slave, context, |context, replaces| {
                let request = Request {
                    command: Command::GearIn {
                        followed: Followed {
                            master: context.master(inputs.master),
                            numerator: inputs.ratio_numerator,
                            denominator: inputs.ratio_denominator.into(),
                            source: inputs.master_value_source,
                        },
                        sync: Some(SyncPoint {
                            master: inputs.master_sync_position,
                            slave: inputs.slave_sync_position,
                            mode: inputs.sync_mode,
                            start_distance: inputs.master_start_distance,
                        }),
                        dynamics: Dynamics {
                            velocity: inputs.velocity,
                            acceleration: inputs.acceleration,
                            deceleration: inputs.deceleration,
                            jerk: inputs.jerk,
                            snap: inputs.snap,
                        },
                    },
                    buffer_mode: inputs.buffer_mode,
                    replaces,
                };
                couple(context.axes, inputs.slave, &request, &mut context.scope)
            });
        let slave = context.axes.get(inputs.slave.index());
        let slave = slave.filter(|_| phase.is_active());
        let deviation = slave.map(|slave| slave.deviation());
        Outputs {
            start_sync: slave.is_some_and(|slave| slave.is_syncing()),
            in_sync: phase.is_reached(),
            deviation: deviation.unwrap_or_default(),
            master_lost: slave.is_some_and(|slave| slave.has_lost_master()),
            ..phase.into()
        }
    }
}

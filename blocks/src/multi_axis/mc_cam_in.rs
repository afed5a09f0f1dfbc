//! `MC_CamIn`: a slave follows a master on a cam.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; V20 to V20b.

use standstill_axis::{
    AxisId, BufferMode, CamId, CamIn, Command, CommandId, Planner, Raw, Request, StartMode, ValueSource,
    couple, update_coupled,
};
use standstill_fb::{Block, Context, Group, Move, UpdateCore, Values, pins};

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
        /// Changed inputs hold for the cam in progress while TRUE, if it was TRUE at the rising edge.
        ContinuousUpdate => continuous_update: bool = false, "";
        /// Position of the master at position 0 of the cam.
        MasterOffset => master_offset: f64 = 0.0, "u of the master";
        /// Position of the slave at position 0 of the cam.
        SlaveOffset => slave_offset: f64 = 0.0, "u";
        /// Factor of the master's side of the cam: above 1 the master needs a longer travel.
        MasterScaling => master_scaling: f64 = 1.0, "";
        /// Factor of the slave's side of the cam; negative mirrors it.
        SlaveScaling => slave_scaling: f64 = 1.0, "";
        /// Distance of the master before MasterSyncPosition, on its side of the cam, at which the slave starts.
        /// Above 0 for a cam that runs forwards, below 0 for one that runs backwards. 0 starts at once.
        MasterStartDistance => master_start_distance: f64 = 0.0, "u of the master";
        /// With a MasterStartDistance, the position on the cam's master side at which the slave is in sync first.
        /// Without one, the slave joins there; 0 is then the first row that it can reach in time.
        MasterSyncPosition => master_sync_position: f64 = 0.0, "u of the master";
        /// mcAbsolute as selected, mcRelative so that the cam passes through the position of the slave, mcRampIn as
        /// mcAbsolute.
        StartMode => start_mode: Raw<StartMode> = Raw::new(0), "";
        /// mcSetValue, or mcActualValue for the filtered feedback of the master's drive.
        MasterValueSource => master_value_source: Raw<ValueSource> = Raw::new(1), "";
        /// The cam, from MC_CamTableSelect.
        CamTableID => cam_table_id: u32 = 0, "";
        /// How the command follows the one before it.
        BufferMode => buffer_mode: Raw<BufferMode> = Raw::new(0), "";
    }
    vendor_inputs {
        /// With BufferMode mcBuffered behind another cam: the position on that cam's master side at which this one
        /// takes over; 0 for its end.
        SwitchAt => switch_at: f64 = 0.0, "u of the master";
    }
    outputs {
        /// The set position of the slave is on the cam.
        InSync => in_sync: bool, "";
        ..coupling;
        /// TRUE for one call each time the end of the cam is reached; running backwards, its first row.
        EndOfProfile => end_of_profile: bool, "";
    }
    vendor_outputs {
        /// Distance of the slave from its position on the cam; 0 in sync.
        Deviation => deviation: f64, "u";
        /// The master went out of operation; the slave is at rest until it is coupled again (axis key
        /// coupling.on_master_lost).
        MasterLost => master_lost: bool, "";
    }
}

/// The command of the block, from its pins. It is smaller than a [`Command`].
#[derive(Clone, Copy, Debug)]
struct Commanded {
    master: AxisId,
    source: Raw<ValueSource>,
    start_mode: Raw<StartMode>,
    table: u32,
    offsets: [f64; 2],
    scalings: [f64; 2],
    sync: [f64; 2],
    switch_at: f64,
}

impl Commanded {
    fn command<P: Planner>(&self, context: &Context<'_, P>) -> Command {
        let [master_offset, slave_offset] = self.offsets;
        let [master_scaling, slave_scaling] = self.scalings;
        let [start_distance, sync_position] = self.sync;
        Command::CamIn(CamIn {
            master: context.master(self.master),
            source: self.source,
            table: CamId::from_number(self.table),
            start_mode: self.start_mode,
            master_offset,
            slave_offset,
            master_scaling,
            slave_scaling,
            start_distance,
            sync_position,
            switch_at: self.switch_at,
        })
    }
}

impl Values for Commanded {
    fn is_same(&self, other: &Self) -> bool {
        let bits = |values: &Self| {
            let [a, b] = values.offsets;
            let [c, d] = values.scalings;
            let [e, f] = values.sync;
            [a, b, c, d, e, f, values.switch_at].map(f64::to_bits)
        };
        let numbers = |values: &Self| {
            let modes = [values.source.number(), values.start_mode.number()];
            (values.master, modes, values.table)
        };
        bits(self) == bits(other) && numbers(self) == numbers(other)
    }

    fn apply<P: Planner>(&self, axis: AxisId, id: CommandId, context: &mut Context<'_, P>) {
        let command = self.command(context);
        // The block shows no Error: the running command continues unchanged (R21).
        let _recorded = update_coupled(context.axes, axis, id, &command, &mut context.scope);
    }
}

/// State kept between calls.
#[doc(alias = "MC_CamIn")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McCamIn {
    core: UpdateCore<Commanded>,
    /// The number of cam ends the slave has reached while the block is active.
    ends: Option<u32>,
}

impl Block for McCamIn {
    const NAME: &'static str = "MC_CamIn";
    const GROUP: Group = Group::MultiAxis;
    const DOC: &'static str = "Lets one axis follow another on a cam.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let pins = Move {
            axis: inputs.slave,
            execute: inputs.execute,
            continuous_update: inputs.continuous_update,
        };
        let values = |_: &Context<'_, P>| Commanded {
            master: inputs.master,
            source: inputs.master_value_source,
            start_mode: inputs.start_mode,
            table: inputs.cam_table_id,
            offsets: [inputs.master_offset, inputs.slave_offset],
            scalings: [inputs.master_scaling, inputs.slave_scaling],
            sync: [inputs.master_start_distance, inputs.master_sync_position],
            switch_at: inputs.switch_at,
        };
        let phase = self
            .core
            .scan_among(pins, context, values, |context, commanded, replaces| {
                let request = Request {
                    command: commanded.command(context),
                    buffer_mode: inputs.buffer_mode,
                    replaces,
                };
                couple(context.axes, inputs.slave, &request, &mut context.scope)
            });
        let slave = context.axes.get(inputs.slave.index());
        let ends = slave.map(|slave| slave.cam_ends());
        // Also in the call in which a buffered cam has taken over at the end.
        let end_of_profile = self.ends.is_some() && self.ends != ends;
        self.ends = ends.filter(|_| phase.is_active());
        if phase.is_reached() {
            // There is nothing else to report.
            return Outputs {
                in_sync: true,
                busy: true,
                active: true,
                end_of_profile,
                ..Outputs::default()
            };
        }
        let slave = slave.filter(|_| phase.is_active());
        Outputs {
            end_of_profile,
            deviation: slave.map(|slave| slave.deviation()).unwrap_or_default(),
            master_lost: slave.is_some_and(|slave| slave.has_lost_master()),
            ..phase.into()
        }
    }
}

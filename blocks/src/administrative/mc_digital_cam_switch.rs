//! `MC_DigitalCamSwitch`: digital outputs that follow the position of an axis.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; T39 h.

pub use super::cams::{CamSwitch, TrackOption};
use super::cams::{Cams, Refusal, SWITCHES, Sample, TRACKS, check};
use standstill_axis::{Axis, AxisId, ErrorId, Planner, Raw, ValueSource};
use standstill_fb::{Block, Context, EnableCore, Group, OutputRef, Table, pins};

pins! {
    in_outs {
        /// The axis whose position switches.
        Axis => axis: AxisId;
        /// The cams; none if it is left out.
        Switches => switches: Table<CamSwitch, SWITCHES>;
        /// The axis whose drive has the outputs: track 1 is output 0, track 32 output 31.
        Outputs => outputs: OutputRef;
        /// Compensation and hysteresis of track 1, of track 2 and so on; of those left out 0.
        TrackOptions => track_options: Table<TrackOption, TRACKS>;
    }
    inputs {
        /// The tracks switch while TRUE; when it falls they are off.
        Enable => enable: bool = false, "";
        /// A bit for each track, the least significant one for track 1; other outputs are left alone.
        EnableMask => enable_mask: u32 = 0, "";
        /// mcSetValue or mcActualValue, as they stand at the beginning of the scan.
        ValueSource => value_source: Raw<ValueSource> = Raw::new(1), "";
    }
    vendor_inputs {}
    outputs {
        /// The tracks of the mask are working.
        InOperation => in_operation: bool, "";
        /// Enabled, and not ended by an error.
        Busy => busy: bool, "";
        /// A value at a pin or in a table is no good; the tracks are off.
        Error => error: bool, "";
        /// Why; 0 without an error.
        ErrorID => error_id: ErrorId, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_DigitalCamSwitch")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McDigitalCamSwitch {
    core: EnableCore,
    cams: Cams,
    /// Outputs this instance writes, and of which axis.
    owned: (AxisId, u32),
    /// What was recorded last, not to record it in every call.
    refused: Option<ErrorId>,
}

/// The bits of the tracks that have a switch.
fn used(inputs: &Inputs) -> u32 {
    let tracks = inputs.switches.rows().iter();
    tracks
        .filter_map(|switch| 1_u32.checked_shl(u32::try_from(switch.track_number).ok()?.checked_sub(1)?))
        .fold(0, |bits, bit| bits | bit)
}

fn sample<P: Planner>(axis: &Axis<P>, inputs: &Inputs, now_ns: i64) -> Result<Sample, Refusal> {
    let set = axis.setpoint();
    let lost = |error| ("ValueSource", f64::NAN, f64::NAN, error);
    let (position, velocity) = match inputs.value_source.get() {
        Some(ValueSource::Set) => (set.position, set.velocity),
        Some(ValueSource::Actual) => (
            axis.fresh_position().map_err(lost)?,
            axis.actual_velocity().map_err(lost)?,
        ),
        Some(ValueSource::Commanded) | None => {
            let number = f64::from(inputs.value_source.number());
            return Err(("ValueSource", number, f64::NAN, ErrorId::SourceInvalid));
        }
    };
    Ok(Sample {
        now_ns,
        position,
        velocity,
        turn: axis.config().modulo,
        coordinates: axis.coordinates(),
    })
}

impl Block for McDigitalCamSwitch {
    const NAME: &'static str = "MC_DigitalCamSwitch";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str =
        "Switches digital outputs at positions of an axis, in either direction of motion.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let Self {
            core, cams, refused, ..
        } = self;
        let now_ns = context.now_ns;
        let outputs = AxisId::from(inputs.outputs);
        // Without outputs there is nothing to do either.
        let axis = match context.axes.get(outputs.index()) {
            Some(_) => inputs.axis,
            None => AxisId::NONE,
        };
        let working = core.write(inputs.enable, axis, context, |axis, source, log| {
            let (switches, tracks) = (inputs.switches.rows(), inputs.track_options.rows());
            let sample =
                check(switches, tracks, axis.config().modulo).and_then(|()| sample(axis, inputs, now_ns));
            match sample {
                Ok(sample) => {
                    *refused = None;
                    Ok(cams.scan(switches, tracks, inputs.enable_mask, &sample))
                }
                Err((pin, value, limit, error)) => {
                    if refused.replace(error) != Some(error) {
                        axis.note_refusal(pin, value, limit, error, source, log);
                    }
                    Err(error)
                }
            }
        });
        if !working.is_valid() {
            self.cams = Cams::default();
        }
        if !inputs.enable {
            self.refused = None;
        }
        let (held_by, held) = self.owned;
        let tracks = if working.is_valid() {
            inputs.enable_mask & used(inputs)
        } else {
            0
        };
        if held != 0
            && let Some(axis) = context.axes.get_mut(held_by.index())
        {
            let left = if held_by == outputs { held & !tracks } else { held };
            axis.write_outputs(left, 0);
        }
        if let Some(axis) = context.axes.get_mut(outputs.index()) {
            axis.write_outputs(tracks, working.value());
        }
        self.owned = (outputs, tracks);
        Outputs {
            in_operation: working.is_valid(),
            busy: working.is_busy(),
            error: working.is_error(),
            error_id: working.error_id(),
        }
    }
}

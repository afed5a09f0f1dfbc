//! `MC_DigitalCamSwitch`: digital outputs that follow the position of an axis.
//!
//! It owns the outputs of those tracks in its mask that have a switch. The memory of each output is kept
//! with the output.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; T39 h.

pub use super::cams::{CamSwitch, TrackOption};
use super::cams::{Cams, Refusal, SWITCHES, Sample, TRACKS, check};
use standstill_axis::{Axis, AxisId, CamTrack, ErrorId, Planner, Raw, ValueSource};
use standstill_fb::{Block, Context, EnableCore, Group, Int, OutputRef, Reading, TableOf, pins};

pins! {
    in_outs {
        /// The axis whose position switches.
        Axis => axis: AxisId;
        /// The cams; none if it is left out.
        Switches => switches: TableOf<CamSwitch, SWITCHES>;
        /// The axis whose drive has the outputs: track 1 is output 0, track 32 output 31.
        Outputs => outputs: OutputRef;
        /// Compensation and hysteresis of track 1, of track 2 and so on; 0 for those left out.
        TrackOptions => track_options: TableOf<TrackOption, TRACKS>;
    }
    inputs {
        /// The tracks switch while TRUE; they are off when it falls.
        Enable => enable: bool = false, "";
        /// A bit for each track, the least significant one for track 1; other outputs are not changed.
        EnableMask => enable_mask: u32 = 0, "";
        /// mcSetValue or mcActualValue, as of the beginning of the scan.
        ValueSource => value_source: Raw<ValueSource> = Raw::new(1), "";
    }
    vendor_inputs {}
    outputs {
        /// The tracks of the mask are working.
        InOperation => in_operation: bool, "";
        /// Enabled, and not ended by an error.
        Busy => busy: bool, "";
        /// A value at a pin or in a table is invalid; the tracks are off.
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
    /// The axis that `cams` has followed.
    followed: AxisId,
    /// The outputs this instance writes, and their axis.
    owned: (AxisId, u32),
    /// The error last recorded. It is recorded once and not in every call.
    refused: Option<ErrorId>,
}

/// The bits of the tracks that have a switch.
fn used(switches: &[CamSwitch]) -> u32 {
    let bit = |track: Int| 1_u32.checked_shl(u32::try_from(track).ok()?.checked_sub(1)?);
    let bits = switches.iter().filter_map(|switch| bit(switch.track_number));
    bits.fold(0, |all, bit| all | bit)
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
        is_set: inputs.value_source.get() == Some(ValueSource::Set),
        coordinates: axis.coordinates(),
        moved: axis.coordinates_total(),
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
        let outputs = AxisId::from(inputs.outputs);
        // Without outputs there is nothing to switch.
        let axis = match context.axes.get(outputs.index()) {
            Some(_) => inputs.axis,
            None => AxisId::NONE,
        };
        let (now_ns, tables) = (context.now_ns, context.tables);
        let refused = &mut self.refused;
        let read = |axis: &Axis<P>| -> Result<_, Refusal> {
            let lost = |pin| (pin, f64::NAN, f64::NAN, ErrorId::TableUnknown);
            let switches = inputs.switches.read(tables).ok_or(lost("Switches"))?;
            let options = inputs.track_options.read(tables).ok_or(lost("TrackOptions"))?;
            check(switches.rows(), options.rows(), axis.config().modulo)?;
            Ok((switches, options, sample(axis, inputs, now_ns)?))
        };
        let working = self.core.write(inputs.enable, axis, context, |axis, scope| {
            let read = read(axis);
            let error = read.as_ref().err().map(|(.., error)| *error);
            // Recorded once and not in every call.
            if let Err((pin, value, limit, error)) = read
                && *refused != Some(error)
            {
                axis.note_refusal(pin, value, limit, error, scope);
            }
            *refused = error;
            read.map_err(|(.., error)| error)
        });
        if !inputs.enable {
            self.refused = None;
        }
        let shown = Outputs {
            in_operation: matches!(working, Reading::Valid(_)),
            busy: matches!(working, Reading::Valid(_) | Reading::Recoverable(_)),
            error: matches!(working, Reading::Recoverable(_) | Reading::Failed(_)),
            error_id: match working {
                Reading::Off | Reading::Valid(_) => ErrorId::None,
                Reading::Recoverable(error) | Reading::Failed(error) => error,
            },
        };
        let tracks = match &working {
            Reading::Valid((switches, ..)) => inputs.enable_mask & used(switches.rows()),
            Reading::Off | Reading::Recoverable(_) | Reading::Failed(_) => 0,
        };
        self.take(outputs, tracks, context);
        if core::mem::replace(&mut self.followed, inputs.axis) != inputs.axis {
            // The way from the place of one axis to that of the other is no motion.
            self.cams = Cams::default();
        }
        match working {
            Reading::Valid((switches, options, sample)) => {
                if let Some(axis) = context.axes.get_mut(outputs.index()) {
                    let (switches, options) = (switches.rows(), options.rows());
                    let memory = axis.cam_tracks_mut();
                    let on = self.cams.scan(switches, options, tracks, memory, &sample);
                    axis.write_outputs(tracks, on);
                }
            }
            Reading::Off | Reading::Recoverable(_) | Reading::Failed(_) => self.cams = Cams::default(),
        }
        shown
    }
}

impl McDigitalCamSwitch {
    /// Takes over the outputs of `tracks`. Outputs it wrote before and no longer owns are switched off;
    /// new ones start from their initial state.
    fn take<P: Planner>(&mut self, outputs: AxisId, tracks: u32, context: &mut Context<'_, P>) {
        let (by, held) = core::mem::replace(&mut self.owned, (outputs, tracks));
        let kept = if by == outputs { held & tracks } else { 0 };
        if let Some(axis) = context.axes.get_mut(by.index()) {
            axis.write_outputs(held & !kept, 0);
        }
        let new = tracks & !kept;
        if new != 0
            && let Some(axis) = context.axes.get_mut(outputs.index())
        {
            for (index, track) in axis.cam_tracks_mut().iter_mut().enumerate() {
                if new & (1 << index) != 0 {
                    *track = CamTrack::default();
                }
            }
        }
    }
}

//! Digital inputs and outputs of the drive under an axis.
//!
//! Source: PLCopen Motion Control Part 1, MC_ReadDigitalInput, MC_ReadDigitalOutput, MC_WriteDigitalOutput; V26.

use super::Axis;
use super::commands::{Work, Write};
use crate::{CommandId, DIGITAL, ErrorId, ExecutionMode, Raw, Scope};
use standstill_planner::Planner;

/// The state of an output that follows positions (MC_DigitalCamSwitch). It is kept with the output, because only one
/// instance writes it. So instances stay small.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CamTrack {
    /// On by position.
    pub on: bool,
    /// Index of the cam that switched it on.
    pub by: usize,
    /// The position at which that cam would switch it off, in the present direction (u).
    pub leave: f64,
    /// The position at which it last switched by position (u).
    pub point: Option<f64>,
    /// On by time until this instant (ns).
    pub until: Option<i64>,
    /// The position that switched it on by time, while that is within the hysteresis (u).
    pub held_at: Option<f64>,
}

/// The bit of input or output `number`.
fn bit_of(number: i16) -> Result<u32, ErrorId> {
    // There are DIGITAL bits, so larger numbers do not exist.
    let number = u32::try_from(number).ok();
    let bit = number.and_then(|number| 1_u32.checked_shl(number));
    bit.ok_or(ErrorId::DigitalNumberInvalid)
}

impl<P: Planner> Axis<P> {
    /// Digital input `number` as the drive reported it in this scan.
    ///
    /// # Errors
    /// [`ErrorId::DigitalNumberInvalid`], or those of [`Axis::fresh_position`] if the last report is old.
    pub fn digital_input(&self, number: i16) -> Result<bool, ErrorId> {
        let bit = bit_of(number)?;
        self.told()?;
        Ok(self.report().inputs & bit != 0)
    }

    /// The level of digital output `number`, read back from the drive in this scan.
    ///
    /// # Errors
    /// As [`Axis::digital_input`].
    pub fn digital_output(&self, number: i16) -> Result<bool, ErrorId> {
        let bit = bit_of(number)?;
        self.told()?;
        Ok(self.report().outputs & bit != 0)
    }

    /// MC_WriteDigitalOutput: digital output `number` gets `value` at the end of this scan, in every state. With
    /// `mcQueued` it waits like a buffered command while the axis has an owner.
    ///
    /// # Errors
    /// The [`ErrorId`] the block shows: a number out of range, an undefined mode, a lost communication, a
    /// full buffer. Nothing changes then.
    pub fn write_output(
        &mut self,
        number: i16,
        value: bool,
        mode: Raw<ExecutionMode>,
        scope: &mut Scope<'_>,
    ) -> Result<CommandId, ErrorId> {
        let queued = self.is_queued(mode, scope)?;
        let bit = bit_of(number).map_err(|error| {
            let most = f64::from(DIGITAL - 1);
            self.refuse("OutputNumber", number.into(), most, error, scope)
        })?;
        self.told()
            .map_err(|error| self.refuse("", f64::NAN, f64::NAN, error, scope))?;
        if queued {
            return self.enqueue(Work::Write(Write::Output { bit, value }), scope);
        }
        self.set_output(bit, value);
        Ok(self.done_at_once())
    }

    /// Sets the outputs of `mask` to the levels of `on` at the end of this scan.
    pub fn write_outputs(&mut self, mask: u32, on: u32) {
        let outputs = &mut self.beside.order.outputs;
        *outputs = (*outputs & !mask) | (on & mask);
    }

    /// The states of digital outputs that follow positions, in order of their numbers.
    pub fn cam_tracks_mut(&mut self) -> &mut [CamTrack; DIGITAL as usize] {
        &mut self.beside.cam_tracks
    }

    pub(super) fn set_output(&mut self, bit: u32, value: bool) {
        self.write_outputs(bit, if value { bit } else { 0 });
    }

    /// Whether the drive's report is from this scan.
    fn told(&self) -> Result<(), ErrorId> {
        self.fresh_position().map(|_| ())
    }
}

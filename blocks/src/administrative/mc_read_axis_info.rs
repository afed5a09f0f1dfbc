//! `MC_ReadAxisInfo`: modes, switches and status of an axis.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; rules R52 to R59.

use standstill_axis::{AxisId, DriveSignals, Planner};
use standstill_fb::{Block, Context, EnableCore, Group, pins};

pins! {
    in_outs {
        /// The axis to read.
        Axis => axis: AxisId;
    }
    inputs {
        /// Read in every call while TRUE.
        Enable => enable: bool = false, "";
    }
    vendor_inputs {}
    outputs {
        ..reading;
        /// The home switch is active; FALSE if the drive reports none, as the ideal drive.
        HomeAbsSwitch => home_abs_switch: bool, "";
        /// The positive hardware end switch is active; FALSE if the drive reports none, as the ideal drive.
        LimitSwitchPos => limit_switch_pos: bool, "";
        /// The negative hardware end switch is active; FALSE if the drive reports none, as the ideal drive.
        LimitSwitchNeg => limit_switch_neg: bool, "";
        /// The drive is simulated, as the ideal drive.
        Simulation => simulation: bool, "";
        /// Feedback of this scan has arrived.
        CommunicationReady => communication_ready: bool, "";
        /// The power stage can be switched on, or is on: communication and supply are there and no drive fault pends.
        ReadyForPowerOn => ready_for_power_on: bool, "";
        /// The power stage is on.
        PowerOn => power_on: bool, "";
        /// MC_Home has been done.
        IsHomed => is_homed: bool, "";
        /// The drive reports a warning; FALSE if it reports none, as the ideal drive.
        AxisWarning => axis_warning: bool, "";
    }
    vendor_outputs {}
}

/// What is read.
#[derive(Clone, Copy, Debug, Default)]
struct Info {
    signals: DriveSignals,
    communicating: bool,
    ready: bool,
    powered: bool,
    homed: bool,
}

/// State kept between calls.
#[doc(alias = "MC_ReadAxisInfo")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McReadAxisInfo {
    core: EnableCore,
}

impl Block for McReadAxisInfo {
    const NAME: &'static str = "MC_ReadAxisInfo";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str =
        "Reads what is known of an axis beside its state: switches, communication, power, reference.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let reading = self.core.scan(inputs.enable, inputs.axis, context, |axis| {
            Ok(Info {
                signals: axis.drive_signals(),
                communicating: axis.is_communicating(),
                ready: axis.is_ready_for_power(),
                powered: axis.is_powered(),
                homed: axis.is_homed(),
            })
        });
        let info = reading.value();
        Outputs {
            home_abs_switch: info.signals.home_switch,
            limit_switch_pos: info.signals.limit_switch_positive,
            limit_switch_neg: info.signals.limit_switch_negative,
            simulation: info.signals.simulated,
            communication_ready: info.communicating,
            ready_for_power_on: info.ready,
            power_on: info.powered,
            is_homed: info.homed,
            axis_warning: info.signals.warning,
            ..(&reading).into()
        }
    }
}

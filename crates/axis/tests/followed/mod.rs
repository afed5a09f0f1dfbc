//! Drives that follow at once.

use standstill_axis::{Axis, Comms, DriveFeedback, DriveRequest, DriveSignals, Log, Scope};

/// The reports of the drives at the beginning of a scan.
pub fn follow_drives(axes: &mut [Axis], scan: u64, log: &mut Log) {
    for axis in axes {
        let command = axis.drive_command();
        let feedback = DriveFeedback {
            enabled: command.request == DriveRequest::Enable,
            voltage: true,
            fault: None,
            position: command.position,
            comms: Comms::Ok,
            signals: DriveSignals::default(),
        };
        axis.follow_feedback(&feedback, &mut Scope::new(scan, log));
    }
}

//! Drives that follow at once, and masters that are followed.

use standstill_axis::{
    Axis, Comms, DriveFeedback, DriveRequest, DriveSignals, Followed, Log, Master, Scope, ValueSource,
};

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

/// A gear with this ratio behind `master`.
pub fn behind(master: &Axis, (numerator, denominator): (i16, u16), source: ValueSource) -> Followed {
    Followed {
        master: Master {
            axis: master.id(),
            turn: master.config().modulo,
        },
        numerator,
        denominator: denominator.into(),
        source: source.into(),
    }
}

//! A drive with a mechanism behind it.

use super::servo::{Servo, SetPoint};
use standstill_axis::{
    Comms, Drive, DriveCommand, DriveFeedback, DriveOrder, DrivePosition, DriveReport, IdealDrive, Powered,
    Scaling, TorqueOrder, TorqueReport,
};

/// A simulated drive that turns a mechanism. Its power stage is that of an [`IdealDrive`]; without torque the
/// mechanism coasts.
#[derive(Clone, Copy, Debug)]
pub struct PlantDrive {
    stage: IdealDrive,
    servo: Servo,
    /// Converts units to increments; `None` if the drive uses units.
    scaling: Option<Scaling>,
    /// The last position before the communication was lost.
    stale: DrivePosition,
    /// The torque to hold, from the order of this scan.
    torque: Option<TorqueOrder>,
}

impl PlantDrive {
    /// Creates a drive over `servo`. With the `scaling` of its axis it counts increments. Power is
    /// confirmed after `power_on` further scans, or never; `enabled` says whether it is on from the
    /// start.
    pub fn new(servo: Servo, scaling: Option<Scaling>, power_on: Option<u32>, enabled: bool) -> Self {
        let mut drive = Self {
            stage: IdealDrive::new(DrivePosition::Units(0.0), 0, power_on, enabled),
            servo,
            scaling,
            stale: DrivePosition::Units(0.0),
            torque: None,
        };
        drive.stale = drive.told(servo.mechanism().position());
        drive
    }

    /// The loops and the mechanism.
    pub fn servo(&self) -> &Servo {
        &self.servo
    }

    /// The power stage, which fails as that of an ideal drive.
    pub fn stage_mut(&mut self) -> &mut IdealDrive {
        &mut self.stage
    }

    /// Someone pushes the mechanism by `distance` (u) while the power stage is off.
    ///
    /// # Errors
    /// [`Powered`] while it is on.
    pub fn displace(&mut self, distance: f64) -> Result<(), Powered> {
        if self.stage.is_enabled() {
            return Err(Powered);
        }
        self.servo.shift(distance);
        Ok(())
    }

    /// A position (u) in the form the drive reports it.
    fn told(&self, position: f64) -> DrivePosition {
        match &self.scaling {
            None => DrivePosition::Units(position),
            Some(scaling) => DrivePosition::Increments(scaling.to_increments(position)),
        }
    }

    /// A commanded position, converted to units.
    fn meant(&self, position: DrivePosition) -> f64 {
        match (position, &self.scaling) {
            (DrivePosition::Units(units), _) => units,
            (DrivePosition::Increments(increments), Some(scaling)) => scaling.to_units(increments),
            // An axis with a scaling has a drive with one, too.
            (DrivePosition::Increments(increments), None) => increments as f64,
        }
    }
}

impl Drive for PlantDrive {
    fn read(&mut self, now_ns: i64) -> DriveFeedback {
        let feedback = self.stage.read(now_ns);
        if feedback.comms == Comms::Ok {
            self.stale = self.told(self.servo.mechanism().position());
        }
        DriveFeedback {
            position: self.stale,
            ..feedback
        }
    }

    fn write(&mut self, now_ns: i64, command: &DriveCommand) {
        let followed = self.stage.is_enabled();
        match command.rename {
            // Passed by reference: a copy would be read before it is written.
            None => self.stage.write(now_ns, command),
            Some(name) => {
                self.servo.rename(name - self.servo.set_point().position);
                let rename = None;
                self.stage.write(now_ns, &DriveCommand { rename, ..*command });
            }
        }
        // The first set-point in operation is the actual position; delayed set-points are dropped.
        let operates = followed && self.stage.is_enabled();
        if let Some(order) = self.torque.take().filter(|_| operates) {
            self.servo.hold(order.torque, order.velocity);
        } else if operates {
            self.servo.follow(SetPoint {
                position: self.meant(command.position),
                velocity: command.velocity,
            });
        } else {
            self.servo.coast();
        }
    }

    fn report(&mut self, report: &mut DriveReport) {
        report.torque = Some(TorqueReport {
            actual: self.servo.torque(),
            most: self.servo.most_torque(),
            limited: self.servo.is_limited(),
        });
    }

    fn order(&mut self, order: &DriveOrder) {
        self.torque = order.torque;
    }
}

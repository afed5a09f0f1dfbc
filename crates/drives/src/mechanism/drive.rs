//! A drive with a mechanism behind it.

use super::servo::{Servo, SetPoint};
use standstill_axis::{Comms, Drive, DriveCommand, DriveFeedback, DrivePosition, IdealDrive, Powered};

/// A simulated drive that turns a mechanism. Its power stage is that of an [`IdealDrive`]; without torque the
/// mechanism coasts.
#[derive(Clone, Copy, Debug)]
pub struct PlantDrive {
    stage: IdealDrive,
    servo: Servo,
    /// Increments a unit, negative if they count the other way; `None`: the drive speaks units.
    per_unit: Option<f64>,
    /// The position (u) at increment 0.
    offset: f64,
    /// What was told last before the communication was lost.
    stale: DrivePosition,
}

impl PlantDrive {
    /// Over `servo`; with `counts`, (increments a unit, position at increment 0), it counts increments. Power is
    /// confirmed after `power_on` further scans, or never; `enabled` from the start or not.
    pub fn new(servo: Servo, counts: Option<(f64, f64)>, power_on: Option<u32>, enabled: bool) -> Self {
        let mut drive = Self {
            stage: IdealDrive::new(DrivePosition::Units(0.0), 0, power_on, enabled),
            servo,
            per_unit: counts.map(|(per_unit, _)| per_unit),
            offset: counts.map_or(0.0, |(_, offset)| offset),
            stale: DrivePosition::Units(0.0),
        };
        drive.stale = drive.told(servo.mechanism().position());
        drive
    }

    /// The loops and the mechanism.
    pub fn servo(&self) -> &Servo {
        &self.servo
    }

    /// See [`IdealDrive::fail`].
    pub fn fail(&mut self, code: u16) {
        self.stage.fail(code);
    }

    /// See [`IdealDrive::cut_power`].
    pub fn cut_power(&mut self) {
        self.stage.cut_power();
    }

    /// See [`IdealDrive::cut_communication`].
    pub fn cut_communication(&mut self) {
        self.stage.cut_communication();
    }

    /// See [`IdealDrive::clear_cause`].
    pub fn clear_cause(&mut self) {
        self.stage.clear_cause();
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

    /// A position (u) as the drive tells it.
    fn told(&self, position: f64) -> DrivePosition {
        match self.per_unit {
            None => DrivePosition::Units(position),
            Some(per_unit) => {
                let exact = (position - self.offset) * per_unit;
                DrivePosition::Increments((if exact < 0.0 { exact - 0.5 } else { exact + 0.5 }) as i64)
            }
        }
    }

    /// A position as the drive is told it (u).
    fn meant(&self, position: DrivePosition) -> f64 {
        match (position, self.per_unit) {
            (DrivePosition::Units(units), _) => units,
            (DrivePosition::Increments(increments), Some(per_unit)) => {
                self.offset + increments as f64 / per_unit
            }
            // An axis with a scaling gives its drive one, too.
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
        if let Some(name) = command.rename {
            self.servo.shift(name - self.servo.set_point().position);
        }
        let followed = self.stage.is_enabled();
        self.stage.write(
            now_ns,
            &DriveCommand {
                rename: None,
                ..*command
            },
        );
        // The first set-point in operation is the actual position, whatever was on its way.
        if followed && self.stage.is_enabled() {
            self.servo.follow(SetPoint {
                position: self.meant(command.position),
                velocity: command.velocity,
            });
        } else {
            self.servo.coast();
        }
    }
}

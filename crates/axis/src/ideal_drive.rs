//! A simulated drive that follows its command exactly, after a delay of some scans, and can be made to
//! fail.

use crate::{Comms, Drive, DriveCommand, DriveFeedback, DrivePosition, DriveRequest, DriveSignals, Fault};

/// Longest delay (scans) from command to actual position.
pub const DELAY_MAX: usize = 64;

/// Follows every set-point `delay` scans late; confirms power `power_on` scans late.
#[derive(Clone, Copy, Debug)]
pub struct IdealDrive {
    /// Commanded positions that are still delayed, as a ring; the oldest is the actual position.
    line: [DrivePosition; DELAY_MAX + 1],
    head: usize,
    delay: usize,
    power_on: Option<u32>,
    enabled: bool,
    /// Scans since Enable was requested; it is not confirmed yet.
    waited: u32,
    fault: Option<Fault>,
    voltage: bool,
    comms: Comms,
    stale: DrivePosition,
}

impl IdealDrive {
    /// A drive at rest at `position` with a delay of `delay` scans (at most [`DELAY_MAX`], larger values
    /// are cut). It confirms power after `power_on` further scans, or never. `enabled` says whether it is
    /// on from the start.
    pub fn new(position: DrivePosition, delay: usize, power_on: Option<u32>, enabled: bool) -> Self {
        Self {
            line: [position; DELAY_MAX + 1],
            head: 0,
            delay: delay.min(DELAY_MAX),
            power_on,
            enabled,
            waited: 0,
            fault: None,
            voltage: true,
            comms: Comms::Ok,
            stale: position,
        }
    }

    /// Raises a drive fault with the drive's own `code`: the power stage goes off.
    pub fn fail(&mut self, code: u16) {
        self.fault = Some(Fault {
            code,
            cause_present: true,
        });
        self.enabled = false;
    }

    /// The power stage loses its supply.
    pub fn cut_power(&mut self) {
        self.voltage = false;
        self.enabled = false;
    }

    /// Feedback no longer arrives; commands still do.
    pub fn cut_communication(&mut self) {
        self.stale = self.actual();
        self.comms = Comms::Lost;
    }

    /// Removes the causes of all faults. A drive fault stays until it is reset.
    pub fn clear_cause(&mut self) {
        if let Some(fault) = &mut self.fault {
            fault.cause_present = false;
        }
        self.voltage = true;
        self.comms = Comms::Ok;
    }

    /// Someone pushes the axis by `distance` (u or increments) while the power stage is off.
    ///
    /// # Errors
    /// [`Powered`] while it is on: an ideal drive holds its position.
    pub fn displace(&mut self, distance: f64) -> Result<(), Powered> {
        if self.enabled {
            return Err(Powered);
        }
        self.hold(match self.actual() {
            DrivePosition::Units(units) => DrivePosition::Units(units + distance),
            DrivePosition::Increments(increments) => {
                DrivePosition::Increments(increments.saturating_add(distance as i64))
            }
        });
        Ok(())
    }

    /// The scans from a command to the actual position.
    pub fn delay(&self) -> usize {
        self.delay
    }

    /// Whether the power stage is on.
    pub fn is_enabled(&self) -> bool {
        self.enabled
    }

    fn actual(&self) -> DrivePosition {
        self.line
            .get((self.head + DELAY_MAX + 1 - self.delay) % (DELAY_MAX + 1))
            .copied()
            .unwrap_or(self.stale)
    }

    /// Comes to rest at `position`; delayed positions are discarded.
    fn hold(&mut self, position: DrivePosition) {
        self.line = [position; DELAY_MAX + 1];
    }

    fn follow(&mut self, position: DrivePosition) {
        self.head = (self.head + 1) % (DELAY_MAX + 1);
        if let Some(slot) = self.line.get_mut(self.head) {
            *slot = position;
        }
    }

    /// Sets the newest commanded position to `name`, and shifts the delayed positions by the same amount.
    fn rename(&mut self, name: f64) {
        let Some(&DrivePosition::Units(newest)) = self.line.get(self.head) else {
            return;
        };
        for place in &mut self.line {
            if let DrivePosition::Units(old) = place {
                // A position that already arrived gets this value exactly, without the rounding of a shift.
                *old = if *old == newest {
                    name
                } else {
                    *old + (name - newest)
                };
            }
        }
    }
}

/// The power stage is on, so the axis cannot be pushed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Powered;

impl Drive for IdealDrive {
    fn read(&mut self, _now_ns: i64) -> DriveFeedback {
        let lost = self.comms == Comms::Lost;
        DriveFeedback {
            enabled: self.enabled,
            voltage: self.voltage,
            fault: self.fault,
            position: if lost { self.stale } else { self.actual() },
            comms: self.comms,
            // An ideal drive has no switches and no warnings.
            signals: DriveSignals {
                simulated: true,
                ..DriveSignals::default()
            },
        }
    }

    fn write(&mut self, _now_ns: i64, command: &DriveCommand) {
        if let Some(name) = command.rename {
            self.rename(name);
        }
        match command.request {
            DriveRequest::Enable if self.fault.is_none() && self.voltage => {
                if !self.enabled {
                    self.enabled = self.power_on.is_some_and(|scans| self.waited >= scans);
                    self.waited = self.waited.saturating_add(1);
                }
            }
            DriveRequest::FaultReset => {
                self.fault = self.fault.filter(|fault| fault.cause_present);
                self.switch_off();
            }
            DriveRequest::Enable | DriveRequest::Off | DriveRequest::QuickStop => self.switch_off(),
        }
        if self.enabled {
            self.waited = 0;
            self.follow(command.position);
        }
    }
}

impl IdealDrive {
    /// Without power the axis stops where it is; delayed positions are dropped.
    fn switch_off(&mut self) {
        self.enabled = false;
        self.waited = 0;
        self.hold(self.actual());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use DrivePosition::Units;

    fn command(request: DriveRequest, position: f64) -> DriveCommand {
        DriveCommand {
            request,
            position: Units(position),
            velocity: 0.0,
            rename: None,
        }
    }

    #[test]
    fn actual_is_the_command_of_delay_plus_one_scans_ago() {
        for delay in 0..4 {
            let mut drive = IdealDrive::new(Units(0.0), delay, Some(0), true);
            for scan in 0..10_usize {
                let wanted = scan.checked_sub(delay + 1).map_or(0.0, |row| row as f64 + 1.0);
                assert_eq!(drive.read(0).position, Units(wanted), "delay {delay} scan {scan}");
                drive.write(0, &command(DriveRequest::Enable, scan as f64 + 1.0));
            }
        }
    }

    #[test]
    fn power_is_confirmed_late_or_never() {
        for (power_on, confirmed_after) in [(Some(0), Some(1)), (Some(3), Some(4)), (None, None)] {
            let mut drive = IdealDrive::new(Units(0.0), 0, power_on, false);
            let mut seen = None;
            for scan in 0..20 {
                if drive.read(0).enabled && seen.is_none() {
                    seen = Some(scan);
                }
                drive.write(0, &command(DriveRequest::Enable, 0.0));
            }
            assert_eq!(seen, confirmed_after);
        }
    }

    #[test]
    fn a_fault_stays_until_its_cause_is_gone_and_it_is_reset() {
        let mut drive = IdealDrive::new(Units(0.0), 0, Some(0), true);
        drive.fail(7);
        drive.write(0, &command(DriveRequest::FaultReset, 0.0));
        assert_eq!(
            drive.read(0).fault,
            Some(Fault {
                code: 7,
                cause_present: true
            })
        );
        drive.clear_cause();
        drive.write(0, &command(DriveRequest::Enable, 0.0));
        assert!(drive.read(0).fault.is_some());
        drive.write(0, &command(DriveRequest::FaultReset, 0.0));
        assert!(drive.read(0).fault.is_none());
    }

    #[test]
    fn only_a_powerless_axis_can_be_pushed() {
        let mut drive = IdealDrive::new(Units(1.0), 2, Some(0), true);
        assert_eq!(drive.displace(10.0), Err(Powered));
        drive.write(0, &command(DriveRequest::Off, 5.0));
        assert_eq!(drive.displace(10.0), Ok(()));
        assert_eq!(drive.read(0).position, Units(11.0));
    }

    #[test]
    fn power_is_not_confirmed_with_a_fault_or_without_supply() {
        let mut drive = IdealDrive::new(Units(0.0), 0, Some(0), false);
        drive.fail(7);
        drive.clear_cause();
        drive.write(0, &command(DriveRequest::Enable, 0.0));
        assert!(!drive.is_enabled(), "a fault is reset before power comes");
        drive.write(0, &command(DriveRequest::FaultReset, 0.0));
        drive.cut_power();
        drive.write(0, &command(DriveRequest::Enable, 0.0));
        assert!(!drive.is_enabled());
        drive.clear_cause();
        drive.write(0, &command(DriveRequest::Enable, 0.0));
        assert!(drive.is_enabled());
    }

    #[test]
    fn a_new_name_is_taken_by_what_is_on_its_way_too() {
        let mut drive = IdealDrive::new(Units(0.0), 2, Some(0), true);
        for place in [1.0, 3.0, 7.0] {
            drive.write(0, &command(DriveRequest::Enable, place));
        }
        // 7 was commanded last and becomes 100: the delayed positions keep their distance.
        drive.write(
            0,
            &DriveCommand {
                rename: Some(100.0),
                ..command(DriveRequest::Enable, 102.0)
            },
        );
        let mut told = [0.0; 3];
        for place in &mut told {
            let Units(position) = drive.read(0).position else {
                unreachable!()
            };
            *place = position;
            drive.write(0, &command(DriveRequest::Enable, 102.0));
        }
        assert_eq!(told, [96.0, 100.0, 102.0]);
    }
}

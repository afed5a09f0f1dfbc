//! An axis over an ideal drive, and a generator of cases.

use standstill_axis::{
    Axis, AxisConfig, AxisId, Command, CommandId, Drive, DrivePosition, Fate, IdealDrive, Log, Request,
    Scope, Standard,
};
pub use standstill_testkit::Random;

pub const CYCLE: f64 = 0.001;

/// An axis over its drive.
#[derive(Clone)]
pub struct Rig {
    pub axis: Axis,
    pub drive: IdealDrive,
    pub log: Log,
    pub scan: u64,
    turn: f64,
    /// Travel of the published positions since the start (u), on a modulo axis the shorter distance in each scan.
    pub way: f64,
    /// Least and largest velocity published (u/s).
    pub least: f64,
    pub most: f64,
}

impl Rig {
    pub fn new(config: AxisConfig) -> Self {
        let position = match config.scaling {
            Some(scaling) => DrivePosition::Increments(scaling.to_increments(config.position)),
            None => DrivePosition::Units(config.position),
        };
        Self {
            axis: Axis::new(AxisId::new(0), config, Standard::new(CYCLE)).unwrap(),
            drive: IdealDrive::new(position, 0, Some(0), true),
            log: Log::default(),
            scan: 0,
            turn: config.modulo.unwrap_or(f64::INFINITY),
            way: 0.0,
            least: 0.0,
            most: 0.0,
        }
    }

    pub fn command(&mut self, command: Command) -> CommandId {
        self.axis
            .command(
                &Request::aborting(command),
                &mut Scope::new(self.scan, &mut self.log),
            )
            .unwrap()
    }

    /// One scan; returns the increments that the drive reported, 0 if it uses units.
    pub fn step(&mut self) -> i64 {
        let feedback = self.drive.read(0);
        self.axis
            .follow_feedback(&feedback, &mut Scope::new(self.scan, &mut self.log));
        let before = self.axis.setpoint().position;
        self.axis.step_alone(&mut Scope::new(self.scan, &mut self.log));
        let now = self.axis.setpoint();
        self.drive.write(0, &self.axis.drive_command());
        let mut difference = now.position - before;
        if self.turn.is_finite() {
            assert!((0.0..self.turn).contains(&now.position), "{now:?}");
            if difference > self.turn / 2.0 {
                difference -= self.turn;
            } else if difference < -self.turn / 2.0 {
                difference += self.turn;
            }
        }
        self.way += difference;
        self.least = self.least.min(now.velocity);
        self.most = self.most.max(now.velocity);
        self.scan += 1;
        match feedback.position {
            DrivePosition::Increments(increments) => increments,
            DrivePosition::Units(_) => 0,
        }
    }

    /// Travel and velocities count from here.
    pub fn forget(&mut self) {
        let velocity = self.axis.setpoint().velocity;
        (self.way, self.least, self.most) = (0.0, velocity, velocity);
    }

    /// Steps until the command has ended, and returns its fate.
    pub fn run(&mut self, id: CommandId) -> Fate {
        for _ in 0..200_000 {
            if !matches!(self.axis.fate(id), Fate::Active { .. } | Fate::Waiting) {
                return self.axis.fate(id);
            }
            self.step();
        }
        panic!("the move does not end");
    }
}

//! Axes without drives, scan by scan.

use crate::followed::{behind, follow_drives};
use standstill_axis::{
    Axis, AxisConfig, AxisId, Command, CommandId, Dynamics, ErrorId, Log, Request, Scope, Standard,
    SyncPoint, ValueSource, couple, steps,
};

/// Axes, and the number of the next scan.
pub struct Rig {
    pub axes: Vec<Axis>,
    pub log: Log,
    pub scan: u64,
}

impl Rig {
    pub fn new(configs: &[AxisConfig], cycle: f64) -> Self {
        let axes = configs.iter().enumerate().map(|(number, config)| {
            let id = AxisId::new(u16::try_from(number).expect("few axes"));
            Axis::new(id, *config, Standard::new(cycle)).expect("a good configuration")
        });
        Self {
            axes: axes.collect(),
            log: Log::default(),
            scan: 0,
        }
    }

    /// Gives a command in the next scan.
    pub fn command(&mut self, axis: usize, command: Command) -> Result<CommandId, ErrorId> {
        let scope = &mut Scope::new(self.scan, &mut self.log);
        let id = self.axes[axis].id();
        couple(&mut self.axes, id, &Request::aborting(command), scope)
    }

    /// MC_GearIn, or MC_GearInPos with a `sync` point.
    pub fn gear(
        &self,
        master: usize,
        ratio: (i16, u16),
        sync: Option<SyncPoint>,
        dynamics: Dynamics,
    ) -> Command {
        Command::GearIn {
            followed: behind(&self.axes[master], ratio, ValueSource::Set),
            sync,
            dynamics,
        }
    }

    /// The motion step of a scan, and the reports of drives that follow at once at the beginning of the next one.
    pub fn step(&mut self) {
        steps::advance(&mut self.axes, &mut Scope::new(self.scan, &mut self.log));
        self.scan += 1;
        follow_drives(&mut self.axes, self.scan, &mut self.log);
    }
}

//! A master, its slave, and their cams, scan by scan.

use crate::followed::follow_drives;
use crate::standing;
use standstill_axis::{
    Axis, AxisConfig, AxisId, BufferMode, CamId, CamIn, CamPiece, CamRow, CamSelection, CamSlot, Cams,
    Command, CommandId, Direction, Dynamics, ErrorId, Event, Limits, Log, Master, Raw, Request, Scope,
    Setpoint, Standard, StartMode, ValueSource, couple, steps,
};
use standstill_planner::CamShape;

pub const MASTER: usize = 0;
pub const SLAVE: usize = 1;

/// The limits of the master in the tables.
pub const L1: Limits = Limits {
    velocity: 200.0,
    acceleration: 1000.0,
    deceleration: 1000.0,
    jerk: 2e4,
    snap: 1e6,
};

/// Those of the slave in table GS15.
pub const WIDE: Limits = Limits {
    velocity: 400.0,
    acceleration: 5000.0,
    deceleration: 5000.0,
    jerk: 1e5,
    snap: 5e6,
};

pub struct Rig {
    pub axes: Vec<Axis>,
    pub log: Log,
    pub scan: u64,
    slots: Vec<CamSlot>,
    pieces: Vec<CamPiece>,
    cycle: f64,
    /// Differences of published positions of the slave, newest first, and the largest of each order.
    positions: [f64; 5],
    pub peaks: [f64; 4],
    /// The largest number from which its positions were computed.
    pub largest: f64,
    /// Drives report that nothing is pending; otherwise every motion step is a full one.
    pub drives_tell: bool,
    /// The digest of all bits that the slave published so far.
    pub digest: u64,
    told: u64,
}

pub fn config(limits: Limits, position: f64, modulo: Option<f64>) -> AxisConfig {
    AxisConfig {
        position,
        modulo,
        ..standing::config(limits)
    }
}

pub fn row(master: f64, slave: f64, shape: CamShape) -> CamRow {
    CamRow {
        master,
        slave,
        shape,
        ..CamRow::default()
    }
}

/// Table GS15: up 100 over 180 and back.
pub fn up_and_back() -> Vec<CamRow> {
    vec![
        row(0.0, 0.0, CamShape::Rest7),
        row(180.0, 100.0, CamShape::Rest7),
        row(360.0, 0.0, CamShape::Through),
    ]
}

/// Periodic, and relative to the present positions of both axes.
pub const RELATIVE: CamSelection = CamSelection {
    master: AxisId::NONE,
    slave: AxisId::NONE,
    periodic: true,
    master_absolute: false,
    slave_absolute: false,
};

impl Rig {
    pub fn new(master: AxisConfig, slave: AxisConfig) -> Self {
        Self::with_cycle(master, slave, 1e-3)
    }

    pub fn with_cycle(master: AxisConfig, slave: AxisConfig, cycle: f64) -> Self {
        let axis = |number, config| {
            Axis::new(AxisId::new(number), config, Standard::new(cycle)).expect("a good configuration")
        };
        Self {
            axes: vec![axis(0, master), axis(1, slave)],
            log: Log::default(),
            scan: 0,
            slots: vec![CamSlot::default(); 4],
            pieces: vec![CamPiece::default(); 64],
            cycle,
            positions: [slave.position; 5],
            peaks: [0.0; 4],
            largest: 0.0,
            drives_tell: true,
            digest: 0,
            told: 0,
        }
    }

    pub fn slave(&self) -> &Axis {
        &self.axes[SLAVE]
    }

    pub fn at(&self) -> f64 {
        self.slave().setpoint().position
    }

    pub fn select(&mut self, rows: &[CamRow], selection: CamSelection) -> CamId {
        let mut cams = Cams::new(&mut self.slots, &mut self.pieces);
        let axes = &self.axes;
        let is_used = |id| axes.iter().any(|axis| axis.uses_cam(id));
        let id = cams.begin(rows.len(), selection, is_used).unwrap().unwrap();
        let row = |index: usize| rows.get(index).copied();
        while cams.go_on(id, &row).unwrap().is_none() {}
        id
    }

    pub fn retire(&mut self, id: CamId) {
        Cams::new(&mut self.slots, &mut self.pieces).retire(id);
    }

    /// The highest velocity of the master at which the slave keeps its limits.
    pub fn highest(&mut self, id: CamId) -> f64 {
        let cams = Cams::new(&mut self.slots, &mut self.pieces);
        let head = *cams.cam(id).unwrap().head;
        head.bounds.highest_velocity(&self.axes[SLAVE].config().limits)
    }

    pub fn cam_in(&self, id: CamId) -> CamIn {
        CamIn {
            master: Master {
                axis: self.axes[MASTER].id(),
                turn: self.axes[MASTER].config().modulo,
            },
            source: Raw::from(ValueSource::Set),
            table: id,
            start_mode: Raw::from(StartMode::Absolute),
            master_offset: 0.0,
            slave_offset: 0.0,
            master_scaling: 1.0,
            slave_scaling: 1.0,
            start_distance: 0.0,
            sync_position: 0.0,
            switch_at: 0.0,
        }
    }

    /// Puts the slave onto a cam of these rows.
    pub fn follow(&mut self, rows: &[CamRow], selection: CamSelection) -> CommandId {
        let cam = self.select(rows, selection);
        self.follow_cam(self.cam_in(cam))
    }

    /// Puts the slave onto a cam at once.
    pub fn follow_cam(&mut self, cam_in: CamIn) -> CommandId {
        self.engage(cam_in, BufferMode::Aborting).unwrap()
    }

    /// The position of the master.
    pub fn master(&self) -> f64 {
        self.axes[MASTER].setpoint().position
    }

    pub fn engage(&mut self, cam_in: CamIn, mode: BufferMode) -> Result<CommandId, ErrorId> {
        let request = Request {
            buffer_mode: mode.into(),
            ..Request::aborting(Command::CamIn(cam_in))
        };
        let slave = self.axes[SLAVE].id();
        let scope = &mut Scope {
            cams: Cams::new(&mut self.slots, &mut self.pieces),
            history: &mut [],
            ..Scope::new(self.scan, &mut self.log)
        };
        couple(&mut self.axes, slave, &request, scope)
    }

    pub fn command(&mut self, axis: usize, command: Command) -> CommandId {
        let scope = &mut Scope::new(self.scan, &mut self.log);
        self.axes[axis]
            .command(&Request::aborting(command), scope)
            .unwrap()
    }

    pub fn run(&mut self, velocity: f64) {
        self.command(
            MASTER,
            Command::MoveVelocity {
                dynamics: Dynamics::at(velocity),
                direction: Raw::from(Direction::Unset),
            },
        );
    }

    /// The reports of drives that follow at once, at the beginning of a scan.
    fn follow_drives(&mut self) {
        follow_drives(&mut self.axes, self.scan, &mut self.log);
    }

    /// The motion step of a scan, and the beginning of the next one.
    pub fn step(&mut self) {
        let scope = &mut Scope {
            cams: Cams::new(&mut self.slots, &mut self.pieces),
            history: &mut [],
            ..Scope::new(self.scan, &mut self.log)
        };
        steps::advance(&mut self.axes, scope);
        self.scan += 1;
        if self.drives_tell {
            self.follow_drives();
        }
        self.note_bits();
        let now = self.at();
        let turn = self.slave().config().modulo;
        self.positions.rotate_right(1);
        if let Some(turn) = turn {
            let passed = ((now - self.positions[1]) / turn).round();
            for place in &mut self.positions[1..] {
                *place += passed * turn;
            }
        }
        self.positions[0] = now;
        let master = self.axes[MASTER].setpoint().position;
        self.largest = self.largest.max(now.abs()).max(master.abs());
        let [a, b, c, d, e] = self.positions;
        let differences = [
            a - b,
            a - 2.0 * b + c,
            a - 3.0 * b + 3.0 * c - d,
            a - 4.0 * b + 6.0 * c - 4.0 * d + e,
        ];
        let mut per = 1.0;
        for (peak, difference) in self.peaks.iter_mut().zip(differences) {
            per /= self.cycle;
            *peak = peak.max((difference * per).abs());
        }
    }

    fn note_bits(&mut self) {
        let slave = &self.axes[SLAVE];
        let state = slave.setpoint();
        let coupled = slave.coupled();
        let shadow = coupled.and_then(|coupled| coupled.shadow).unwrap_or(f64::NAN);
        let numbers = [
            state.position,
            state.velocity,
            state.acceleration,
            state.jerk,
            state.snap,
            slave.deviation(),
            shadow,
            f64::from(slave.cam_ends()),
            f64::from(u8::from(slave.is_in_gear())),
        ];
        for number in numbers {
            let mixed = (self.digest ^ number.to_bits()).wrapping_mul(0x9E37_79B9_7F4A_7C15);
            self.digest = mixed.rotate_left(29);
        }
    }

    pub fn steps(&mut self, count: usize) {
        for _ in 0..count {
            self.step();
        }
    }

    /// Whether the slave has kept its limits so far, except for rounding of its positions.
    pub fn keeps_limits(&self) -> Result<(), String> {
        let limits = self.slave().config().limits;
        let bounds = [limits.velocity, limits.acceleration, limits.jerk, limits.snap];
        let largest = self.positions[0]
            .abs()
            .max(self.slave().config().modulo.unwrap_or(0.0))
            .max(100.0);
        let resolved = 8.0 * largest * f64::EPSILON;
        let mut per = 1.0;
        for (order, (peak, bound)) in self.peaks.into_iter().zip(bounds).enumerate() {
            per *= 2.0 / self.cycle;
            if peak > bound * (1.0 + 1e-9) + resolved * per {
                return Err(format!(
                    "d{}: {peak} above {bound} at scan {}",
                    order + 1,
                    self.scan
                ));
            }
        }
        Ok(())
    }

    /// The records since the last call.
    pub fn events(&mut self) -> Vec<Event> {
        let events = self.log.since(self.told).map(|record| record.event).collect();
        self.told = self.log.total();
        events
    }

    pub fn state(&self) -> Setpoint {
        self.slave().setpoint()
    }
}

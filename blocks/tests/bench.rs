//! Two axes with drives that follow exactly, and instances of any block on the first.

use standstill_axis::{
    Axis, AxisConfig, AxisId, CamCurve, CamId, CamPiece, CamRow, CamSelection, CamSlot, Cams, Comms,
    DriveCommand, DriveFeedback, DrivePosition, DriveRequest, DriveSignals, Limits, Log, Scope, Standard,
    StartState, TorqueReport, steps,
};
use standstill_blocks::BlockInstance;
use standstill_fb::{AnyInstance, Context, PinType, TableRef, Value};

/// Sample time (s).
const CYCLE: f64 = 0.001;

/// A table with one point for the profile blocks: after 4 s (DeltaTime in ns) at 1, not level. Behind it are two
/// rows of a cam.
const POINTS: [f64; 15] = [
    4e9, 1.0, 0.0, // the point
    0.0, 0.0, 0.0, 0.0, 0.0, 4.0, // from rest
    100.0, 1.0, 0.0, 0.0, 0.0, 4.0, // to rest
];

/// The rows.
const ROWS: TableRef = TableRef { first: 3, records: 2 };

/// The axis the blocks are wired to.
pub const AXIS: AxisId = AxisId::new(0);

#[derive(Clone)]
pub struct Bench {
    pub axes: [Axis; 2],
    pub log: Log,
    drives: [DriveCommand; 2],
    pub scan: u64,
    slots: [CamSlot; 3],
    pieces: [CamPiece; 3],
    /// A cam that is selected.
    cam: CamId,
}

impl Bench {
    /// Two axes in Standstill at 0.
    pub fn new() -> Self {
        Self::started(StartState::Standstill)
    }

    /// Two axes at rest in the state that the block needs: a phasing block needs its slave in gear.
    pub fn ready_for(name: &str) -> Self {
        let mut bench = Self::new();
        if name.starts_with("MC_Phasing") {
            let mut gear = bench.block("MC_GearIn");
            bench.set(&mut gear, "Execute", Value::Bool(true));
            for _ in 0..2 {
                bench.scan(&mut [&mut gear]);
            }
            assert!(bench.flag(&gear, "InGear"));
        }
        bench
    }

    pub fn started(start: StartState) -> Self {
        let limits = Limits {
            velocity: 10.0,
            acceleration: 100.0,
            deceleration: 100.0,
            jerk: 5000.0,
            snap: 500_000.0,
        };
        let config = AxisConfig {
            start,
            ..AxisConfig::new(limits)
        };
        let on = start == StartState::Standstill;
        let drive = DriveCommand {
            request: if on {
                DriveRequest::Enable
            } else {
                DriveRequest::Off
            },
            position: DrivePosition::Units(0.0),
            velocity: 0.0,
            rename: None,
        };
        Self {
            axes: [0, 1].map(|id| Axis::new(AxisId::new(id), config, Standard::new(CYCLE)).unwrap()),
            log: Log::default(),
            drives: [drive; 2],
            scan: 0,
            slots: Default::default(),
            pieces: Default::default(),
            cam: CamId::NONE,
        }
        .with_cam()
    }

    /// The rows are selected.
    fn with_cam(mut self) -> Self {
        let mut cams = Cams::new(&mut self.slots, &mut self.pieces);
        let selection = CamSelection {
            periodic: true,
            ..CamSelection::default()
        };
        self.cam = cams.begin(2, selection, |_| false).unwrap().unwrap();
        let row = |index: usize| {
            Some(CamRow {
                master: index as f64 * 100.0,
                shape: CamCurve::Rest7.shape(),
                ..CamRow::default()
            })
        };
        cams.go_on(self.cam, &row).unwrap().unwrap();
        self
    }

    /// An instance of the block, wired to the first axis, with values a motion can start with.
    pub fn block(&self, name: &str) -> BlockInstance {
        let mut block = BlockInstance::new(name).unwrap();
        self.wire(&mut block, AXIS);
        let good = [
            ("Position", Value::Lreal(1.0)),
            ("Distance", Value::Lreal(1.0)),
            ("Velocity", Value::Lreal(5.0)),
            ("VelocityDiff", Value::Lreal(1.0)),
            ("Torque", Value::Lreal(1.0)),
            ("WindowOnly", Value::Bool(true)),
            ("CamTableID", Value::Dword(self.cam.number())),
            ("CamTable", Value::Table(ROWS)),
            ("RatioNumerator", Value::Int(1)),
            ("RatioDenominator", Value::Word(1)),
            ("LastPosition", Value::Lreal(f64::MAX)),
        ];
        let parameter = if name.contains("Bool") { 6 } else { 9 };
        let number = ("ParameterNumber", Value::Int(parameter));
        let value = name == "MC_WriteParameter";
        let value = value.then_some(("Value", Value::Lreal(10.0)));
        let good = good.into_iter().chain([number]).chain(value);
        let points = Value::Table(TableRef { first: 0, records: 1 });
        let tables = ["TimePosition", "TimeVelocity", "TimeAcceleration"].map(|pin| (pin, points));
        for (pin, value) in good.chain(tables) {
            if let Some((index, _)) = block.info().pin(pin)
                && index < block.info().input_count()
            {
                block.set(index, value).unwrap();
            }
        }
        block
    }

    /// Wires every reference of the block to this axis, and a reference to a master to the other one.
    pub fn wire(&self, block: &mut BlockInstance, axis: AxisId) {
        for (index, pin) in block.info().pins().enumerate() {
            if let PinType::Axis(_) = pin.ty {
                let axis = match axis.index() {
                    at @ (0 | 1) if pin.name.starts_with("Master") => AxisId::new(1 - at as u16),
                    _ => axis,
                };
                block.set(index, Value::Axis(axis)).unwrap();
            }
        }
    }

    pub fn set(&self, block: &mut BlockInstance, pin: &str, value: Value) {
        let (index, _) = block.info().pin(pin).unwrap();
        block.set(index, value).unwrap();
    }

    pub fn get(&self, block: &BlockInstance, pin: &str) -> Option<Value> {
        block.get(block.info().pin(pin)?.0)
    }

    /// The BOOL at a pin; FALSE if the block has no such pin.
    pub fn flag(&self, block: &BlockInstance, pin: &str) -> bool {
        self.get(block, pin) == Some(Value::Bool(true))
    }

    /// ErrorID, 0 if the block has none.
    pub fn error(&self, block: &BlockInstance) -> u16 {
        match self.get(block, "ErrorID") {
            Some(Value::Word(number)) => number,
            _ => 0,
        }
    }

    /// Feedback is latched.
    pub fn latch(&mut self) {
        for (axis, drive) in self.axes.iter_mut().zip(&self.drives) {
            // It can hold a torque, under which it does not move.
            axis.report_mut().torque = Some(TorqueReport {
                actual: 0.0,
                most: 10.0,
                limited: false,
            });
            let feedback = DriveFeedback {
                enabled: drive.request == DriveRequest::Enable,
                voltage: true,
                fault: None,
                position: drive.position,
                comms: Comms::Ok,
                signals: DriveSignals::default(),
            };
            axis.follow_feedback(&feedback, &mut Scope::new(self.scan, &mut self.log));
        }
    }

    pub fn call(&mut self, block: &mut BlockInstance) {
        block.call(&mut Context {
            now_ns: self.scan as i64 * 1_000_000,
            scope: Scope {
                cams: Cams::new(&mut self.slots, &mut self.pieces),
                ..Scope::new(self.scan, &mut self.log)
            },
            axes: &mut self.axes,
            tables: &POINTS,
        });
    }

    /// Advances both axes and checks that they stay finite.
    pub fn advance(&mut self) {
        let scope = &mut Scope {
            cams: Cams::new(&mut self.slots, &mut self.pieces),
            ..Scope::new(self.scan, &mut self.log)
        };
        steps::advance(&mut self.axes, scope);
        for (axis, drive) in self.axes.iter_mut().zip(&mut self.drives) {
            assert!(axis.setpoint().is_finite(), "scan {}", self.scan);
            // The drive follows at once, in the coordinates of the command.
            *drive = axis.drive_command();
        }
        self.scan += 1;
    }

    /// A whole scan with these blocks in this order.
    pub fn scan(&mut self, blocks: &mut [&mut BlockInstance]) {
        self.latch();
        for block in blocks {
            self.call(block);
        }
        self.advance();
    }
}

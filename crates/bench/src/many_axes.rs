//! Many axes in one runtime, each with its own kind of motion.

use crate::{CYCLE, LIMITS, feedback};
use standstill_axis::{
    Axis, AxisConfig, AxisId, AxisState, BufferMode, CamId, CamPiece, CamRow, CamSelection, CamSlot, Cams,
    ConfigError, DriveFeedback, DrivePosition, InstanceId, Log, Scaling, Scope, Standard, StartMode,
    StartState, steps,
};
use standstill_blocks::BlockInstance;
use standstill_fb::{AnyInstance, Context, Value};
use standstill_planner::CamShape;

/// Axes of [`ManyAxes`].
pub const AXES: u16 = 64;

/// Scans after the start in which every axis of [`ManyAxes`] is in motion.
pub const IN_MOTION: u64 = 800;

/// Kinds of motion; in the mixture axis n has kind n modulo their number.
pub const WAYS: [&str; 8] = [
    "MC_MoveAbsolute",
    "MC_MoveRelative after MC_MoveVelocity",
    "MC_MoveVelocity",
    "MC_MoveVelocity, modulo axis",
    "MC_MoveAbsolute, drive that counts",
    "MC_MoveSuperimposed on MC_MoveRelative, software limits",
    "three blended MC_MoveRelative",
    "MC_Jog under MC_SetOverride",
];

/// As a slave of the axis before it.
const SLAVE: usize = WAYS.len();

/// On a cam behind the axis before it.
const ON_CAM: usize = SLAVE + 1;

/// Up and back over 2 u of the master: within the limits of the slave for any motion of the master.
const CAM: [(f64, f64); 3] = [(0.0, 0.0), (1.0, 0.1), (2.0, 0.0)];

/// 64 axes with MC_Power and one to three motion blocks each, and drives that follow at once. Among them are moves
/// on the grid and from motion, endless motions on linear and modulo axes, steps of a drive that counts, a
/// superimposed distance, a blended chain, a jog, and a move under an override.
#[derive(Clone, Debug)]
pub struct ManyAxes {
    /// The axes.
    pub axes: Vec<Axis>,
    log: Log,
    /// Blocks in call order, those of an axis one after the other.
    blocks: Vec<BlockInstance>,
    feedback: Vec<DriveFeedback>,
    cam: ([CamSlot; 1], [CamPiece; 2]),
    scan: u64,
}

impl ManyAxes {
    /// The axes at rest, powered: a mixture of [`WAYS`], or `only` one of them.
    ///
    /// # Errors
    /// None with these constants.
    pub fn at_rest(only: Option<usize>) -> Result<Self, ConfigError> {
        Self::with_ways(AXES, |number| only.unwrap_or(usize::from(number) % WAYS.len()))
    }

    /// This many axes, all in motion by MC_MoveAbsolute.
    ///
    /// # Errors
    /// None with these constants.
    pub fn in_a_move(count: u16) -> Result<Self, ConfigError> {
        Ok(Self::with_ways(count, |_| 0)?.set_off())
    }

    /// Powered, at rest: every axis will move in the kind given for its number. In the kinds [`SLAVE`]
    /// and [`ON_CAM`] it is a slave of the one before it.
    fn with_ways(count: u16, way_of: impl Fn(u16) -> usize) -> Result<Self, ConfigError> {
        let mut rig = Self {
            axes: Vec::with_capacity(usize::from(count)),
            log: Log::default(),
            blocks: Vec::new(),
            feedback: Vec::new(),
            cam: Default::default(),
            scan: 0,
        };
        let cam = rig.select();
        for number in 0..count {
            let way = way_of(number);
            let config = AxisConfig {
                start: StartState::Standstill,
                modulo: (way == 3).then_some(1.0),
                scaling: if way == 4 {
                    Scaling::new(100_000, 1, false, 0.0).ok()
                } else {
                    None
                },
                software_limits: (way == 5).then_some((-10.0, 10.0)),
                ..AxisConfig::new(LIMITS)
            };
            rig.axes
                .push(Axis::new(AxisId::new(number), config, Standard::new(CYCLE))?);
            rig.feedback.push(feedback(if way == 4 {
                DrivePosition::Increments(0)
            } else {
                DrivePosition::Units(0.0)
            }));
            rig.add(number, "MC_Power", &[("Enable", Value::Bool(true))]);
            // A little apart, so that they do not switch in the same scans.
            let part = f64::from(number) / f64::from(count);
            let velocity = ("Velocity", Value::Lreal(1.0 + 0.2 * part));
            let distance = |times: f64| ("Distance", Value::Lreal(times * (1.4 + 0.1 * part)));
            let position = ("Position", Value::Lreal(1.4 + 0.1 * part));
            let blended = ("BufferMode", Value::Enum(BufferMode::BlendingLow as i32));
            match way {
                0 | 4 => rig.add(number, "MC_MoveAbsolute", &[position, velocity]),
                1 => {
                    rig.add(number, "MC_MoveVelocity", &[velocity]);
                    rig.add(number, "MC_MoveRelative", &[distance(1.0), velocity]);
                }
                2 | 3 => rig.add(number, "MC_MoveVelocity", &[velocity]),
                5 => {
                    rig.add(number, "MC_MoveRelative", &[distance(1.0), velocity]);
                    let least = ("VelocityDiff", Value::Lreal(0.1));
                    let rate = ("Acceleration", Value::Lreal(1.0));
                    rig.add(number, "MC_MoveSuperimposed", &[distance(-0.1), least, rate]);
                }
                6 => {
                    rig.add(number, "MC_MoveRelative", &[distance(0.4), velocity]);
                    rig.add(number, "MC_MoveRelative", &[distance(0.4), velocity, blended]);
                    rig.add(number, "MC_MoveRelative", &[distance(0.4), velocity, blended]);
                }
                SLAVE => {
                    let master = Value::Axis(AxisId::new(number.saturating_sub(1)));
                    let ratio = [
                        ("RatioNumerator", Value::Int(-3)),
                        ("RatioDenominator", Value::Word(4)),
                    ];
                    rig.add(number, "MC_GearIn", &[("Master", master), ratio[0], ratio[1]]);
                }
                ON_CAM => {
                    let master = Value::Axis(AxisId::new(number.saturating_sub(1)));
                    let relative = Value::Enum(StartMode::Relative as i32);
                    let pins = [
                        ("Master", master),
                        ("CamTableID", Value::Dword(cam.number())),
                        ("StartMode", relative),
                    ];
                    rig.add(number, "MC_CamIn", &pins);
                }
                _ => {
                    let half = ("VelFactor", Value::Lreal(0.5));
                    rig.add(number, "MC_SetOverride", &[("Enable", Value::Bool(true)), half]);
                    rig.add(number, "MC_Jog", &[velocity]);
                }
            }
        }
        rig.scan();
        Ok(rig)
    }

    /// The cam of all slaves: periodic, relative to both places.
    fn select(&mut self) -> CamId {
        let (slots, pieces) = &mut self.cam;
        let mut cams = Cams::new(slots, pieces);
        let selection = CamSelection {
            master: AxisId::NONE,
            slave: AxisId::NONE,
            periodic: true,
            master_absolute: false,
            slave_absolute: false,
        };
        let begun = cams.begin(CAM.len(), selection, |_| false);
        let Ok(Ok(id)) = begun else { return CamId::NONE };
        let row = |index: usize| {
            let (master, slave) = *CAM.get(index)?;
            Some(CamRow {
                master,
                slave,
                shape: CamShape::Rest7,
                ..CamRow::default()
            })
        };
        while let Ok(None) = cams.go_on(id, &row) {}
        id
    }

    fn add(&mut self, axis: u16, name: &str, pins: &[(&str, Value)]) {
        let Some(mut block) = BlockInstance::new(name) else {
            return;
        };
        // An axis has one of the two names.
        let wires = ["Axis", "Slave"].map(|pin| (pin, Value::Axis(AxisId::new(axis))));
        for (pin, value) in pins.iter().chain(&wires) {
            if let Some((index, _)) = block.info().pin(pin) {
                let set = block.set(index, *value);
                debug_assert_eq!(set, Ok(()), "{name}.{pin}");
            }
        }
        self.blocks.push(block);
    }

    /// The axes in motion; they stay in motion for [`IN_MOTION`] more scans.
    ///
    /// # Errors
    /// None with these constants.
    pub fn in_motion(only: Option<usize>) -> Result<Self, ConfigError> {
        Ok(Self::at_rest(only)?.set_off())
    }

    /// The axes at rest, half of them to become slaves: of eight axes four move by MC_MoveAbsolute, and a chain of
    /// four follows the last of these by MC_GearIn.
    ///
    /// # Errors
    /// None with these constants.
    pub fn chains_at_rest() -> Result<Self, ConfigError> {
        Self::with_ways(AXES, |number| if number % 8 < 4 { 0 } else { SLAVE })
    }

    /// The same in motion, all slaves in gear.
    ///
    /// # Errors
    /// None with these constants.
    pub fn in_chains() -> Result<Self, ConfigError> {
        Ok(Self::chains_at_rest()?.set_off())
    }

    /// All axes in motion: every second one by MC_MoveAbsolute, the others in sync on a cam behind the one before.
    ///
    /// # Errors
    /// None with these constants.
    pub fn on_cams() -> Result<Self, ConfigError> {
        let rig = Self::with_ways(AXES, |number| if number % 2 == 0 { 0 } else { ON_CAM })?;
        Ok(rig.set_off())
    }

    /// Gives every axis its commands, and scans until all are in motion.
    #[must_use]
    pub fn set_off(self) -> Self {
        let mut rig = self;
        // Block after block, so that the second block of an axis takes over from the first, or waits
        // behind it.
        for round in 0..3 {
            let mut last = (AxisId::NONE, 0);
            for block in &mut rig.blocks {
                let info = block.info();
                let trigger = ["Execute", "JogForward"]
                    .into_iter()
                    .find_map(|name| Some(info.pin(name)?.0));
                let axis = info.pin("Axis").or(info.pin("Slave"));
                let axis = axis.and_then(|(index, _)| block.get(index));
                if let (Some(index), Some(Value::Axis(axis))) = (trigger, axis) {
                    last = (axis, if last.0 == axis { last.1 + 1 } else { 0 });
                    if last.1 == round {
                        let set = block.set(index, Value::Bool(true));
                        debug_assert_eq!(set, Ok(()));
                    }
                }
            }
            for _ in 0..100 {
                rig.scan();
            }
        }
        rig
    }

    /// Axes in gear, or in sync on a cam.
    pub fn in_gear(&self) -> usize {
        self.axes.iter().filter(|axis| axis.is_in_gear()).count()
    }

    /// Axes in DiscreteMotion, ContinuousMotion or SynchronizedMotion whose set-point moves.
    pub fn moving(&self) -> usize {
        let moves = |axis: &&Axis| {
            let moving = matches!(
                axis.state(),
                AxisState::DiscreteMotion | AxisState::ContinuousMotion | AxisState::SynchronizedMotion
            );
            moving && axis.setpoint().velocity != 0.0
        };
        self.axes.iter().filter(moves).count()
    }

    /// One scan of all axes: feedback, blocks, motion steps, drive commands.
    pub fn scan(&mut self) {
        let Self { axes, log, cam, .. } = self;
        let (slots, pieces) = cam;
        let mut scope = Scope::new(self.scan, log);
        for (axis, feedback) in axes.iter_mut().zip(&self.feedback) {
            axis.follow_feedback(feedback, &mut scope);
        }
        let mut context = Context {
            now_ns: self.scan as i64 * 1_000_000,
            scope: Scope {
                cams: Cams::new(slots, pieces),
                history: &mut [],
                ..Scope::new(self.scan, log)
            },
            axes,
            tables: &[],
        };
        for (number, block) in (0..).zip(&mut self.blocks) {
            context.scope.instance = InstanceId(number);
            block.call(&mut context);
        }
        let Context { axes, scope, .. } = &mut context;
        scope.instance = InstanceId::default();
        steps::advance(axes, scope);
        for (axis, feedback) in self.axes.iter_mut().zip(&mut self.feedback) {
            feedback.position = axis.drive_command().position;
        }
        self.scan += 1;
    }

    /// The same without blocks.
    pub fn scan_alone(&mut self) {
        let Self { axes, log, .. } = self;
        let mut scope = Scope::new(self.scan, log);
        for (axis, feedback) in axes.iter_mut().zip(&self.feedback) {
            axis.follow_feedback(feedback, &mut scope);
        }
        let mut feedback = self.feedback.iter_mut();
        steps::advance_each(axes, &mut scope, |axis| {
            if let Some(feedback) = feedback.next() {
                feedback.position = axis.drive_command().position;
            }
        });
        self.scan += 1;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_of_them_stay_in_sync_on_a_cam() {
        let mut rig = ManyAxes::on_cams().unwrap();
        for scan in 0..IN_MOTION {
            rig.scan();
            assert_eq!(rig.in_gear(), usize::from(AXES) / 2, "scan {scan}");
        }
    }

    #[test]
    fn all_axes_move_all_the_time_and_no_block_complains() {
        let mut rig = ManyAxes::in_motion(None).unwrap();
        for scan in 0..IN_MOTION {
            rig.scan();
            assert_eq!(rig.moving(), usize::from(AXES), "scan {scan}");
        }
        for block in &rig.blocks {
            let error = block
                .info()
                .pin("ErrorID")
                .and_then(|(index, _)| block.get(index));
            assert_eq!(error, Some(Value::Word(0)), "{}", block.info().name);
        }
        let waiting: usize = rig.axes.iter().map(Axis::waiting).sum();
        assert!(waiting > 0, "a chain");
        let beside = rig
            .axes
            .iter()
            .filter(|axis| axis.outlook().superimposed.is_some())
            .count();
        assert_eq!(beside, usize::from(AXES) / WAYS.len());
    }
}

//! The motor of a simulated node: ideal, with a delay of some scans.

use crate::nearest;
use standstill_axis::DELAY_MAX;

/// Positions of a ramp stay in the range in which a 64-bit float is exact to the increment.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// The load that a simulated node turns in torque mode. All torques are in thousandths of the rated
/// torque.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorLoad {
    /// Torque for an acceleration of 1 increment/scan^2, above 0.
    pub inertia: f64,
    /// Friction at a velocity of 1 increment/scan, from 0.
    pub viscous: f64,
    /// Friction against any motion, from 0.
    pub coulomb: f64,
    /// 6072h, the largest torque it holds, above 0.
    pub most: u16,
}

impl MotorLoad {
    /// The torque that changes one velocity (increments/scan) to another within a scan.
    fn needed(&self, before: f64, after: f64) -> f64 {
        let coulomb = if after == 0.0 {
            0.0
        } else {
            self.coulomb.copysign(after)
        };
        self.inertia * (after - before) + self.viscous * after + coulomb
    }

    /// The velocity (increments/scan) after a scan under `torque`.
    fn velocity(&self, before: f64, torque: f64) -> f64 {
        // Friction that grows with velocity is solved implicitly, so that no amount of it oscillates.
        let free = (self.inertia * before + torque) / (self.inertia + self.viscous);
        let held = self.coulomb / (self.inertia + self.viscous);
        if free.abs() <= held {
            0.0
        } else {
            free - held.copysign(free)
        }
    }
}

/// Follows every target `delay` scans late, and brakes by itself when required. Under a torque, and at a
/// velocity, there is no target and no delay.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motor {
    /// Positions that are still delayed, as a ring; the oldest is the actual one.
    line: [i64; DELAY_MAX + 1],
    head: usize,
    delay: usize,
    /// The newest position, with its fraction of an increment.
    late: usize,
    /// The newest position, between increments.
    place: f64,
    /// Increments a scan.
    velocity: f64,
    /// The torque of the last scan (thousandths of the rated torque).
    torque: f64,
    load: Option<MotorLoad>,
}

impl Motor {
    /// At rest.
    pub fn new(position: i64, delay: usize, load: Option<MotorLoad>) -> Self {
        Self {
            line: [position; DELAY_MAX + 1],
            head: 0,
            delay: delay.min(DELAY_MAX),
            late: delay.min(DELAY_MAX),
            place: position as f64,
            velocity: 0.0,
            torque: 0.0,
            load,
        }
    }

    /// The actual position.
    pub fn actual(&self) -> i64 {
        self.line
            .get((self.head + DELAY_MAX + 1 - self.late) % (DELAY_MAX + 1))
            .copied()
            .unwrap_or_default()
    }

    /// The newest position that it was sent to.
    pub fn newest(&self) -> i64 {
        self.line.get(self.head).copied().unwrap_or_default()
    }

    /// Velocity (increments/scan).
    pub fn velocity(&self) -> f64 {
        self.velocity
    }

    /// Torque of the last scan (thousandths of the rated one).
    pub fn torque(&self) -> f64 {
        self.torque
    }

    /// Moves to `target` within this scan.
    pub fn follow(&mut self, target: i64) {
        self.be_late(self.delay);
        let before = self.velocity;
        self.velocity = target.saturating_sub(self.newest()) as f64;
        self.place = target as f64;
        self.push(target);
        self.feel(before);
    }

    /// One scan at `velocity` (increments/scan).
    pub fn run(&mut self, velocity: f64) {
        self.be_late(0);
        self.ramp(velocity, f64::INFINITY);
    }

    /// One scan under `torque` (thousandths of the rated torque), within the exact range.
    pub fn turn(&mut self, torque: f64) {
        self.be_late(0);
        let Some(load) = self.load else { return };
        let most = f64::from(load.most);
        let torque = torque.max(-most).min(most);
        let velocity = load.velocity(self.velocity, torque);
        self.ramp(velocity, f64::INFINITY);
        self.torque = torque;
    }

    /// Sets the delay; delayed positions are dropped.
    fn be_late(&mut self, late: usize) {
        if self.late != late {
            let actual = self.actual();
            self.line = [actual; DELAY_MAX + 1];
            self.place = actual as f64;
            self.late = late;
        }
    }

    /// Computes the torque of a scan that began with velocity `before`.
    fn feel(&mut self, before: f64) {
        self.torque = self.load.map_or(0.0, |load| load.needed(before, self.velocity));
    }

    /// One scan of a ramp to rest with `deceleration` (increments/scan^2).
    pub fn brake(&mut self, deceleration: f64) {
        self.ramp(0.0, deceleration);
    }

    /// One scan of a ramp to `velocity` (increments/scan) with `rate` (increments/scan^2).
    pub fn ramp(&mut self, velocity: f64, rate: f64) {
        let before = self.velocity;
        let missing = velocity - before;
        self.velocity = if missing.abs() <= rate {
            velocity
        } else {
            before + rate.copysign(missing)
        };
        self.place = (self.place + 0.5 * (before + self.velocity)).clamp(-EXACT, EXACT);
        self.push(nearest(self.place));
        self.feel(before);
    }

    /// Renames positions: each counts `by` increments more from now on.
    pub fn count_from(&mut self, by: i64) {
        for position in &mut self.line {
            *position = position.saturating_add(by);
        }
        self.place += by as f64;
    }

    /// Whether it is at rest with no delayed position.
    pub fn is_at_rest(&self) -> bool {
        self.velocity == 0.0 && self.actual() == self.newest()
    }

    /// Without torque it stops where it is; delayed positions are dropped.
    pub fn let_go(&mut self) {
        self.stand_at(self.actual());
    }

    /// Someone moved the motor to `position`.
    pub fn stand_at(&mut self, position: i64) {
        *self = Self::new(position, self.delay, self.load);
    }

    fn push(&mut self, position: i64) {
        self.head = (self.head + 1) % (DELAY_MAX + 1);
        if let Some(slot) = self.line.get_mut(self.head) {
            *slot = position;
        }
    }
}

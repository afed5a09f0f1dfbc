//! What a simulated node turns: an ideal motor, some scans late.

use crate::nearest;
use standstill_axis::DELAY_MAX;

/// Positions of a ramp stay within the increments a 64-bit float knows apart.
const EXACT: f64 = 9_007_199_254_740_992.0;

/// Follows every target `delay` scans late, and comes to rest by itself when it has to.
#[derive(Clone, Copy, Debug)]
pub(super) struct Motor {
    /// Positions on their way, a ring; the oldest is the actual one.
    line: [i64; DELAY_MAX + 1],
    head: usize,
    delay: usize,
    /// The newest position, between increments.
    place: f64,
    /// Increments a scan.
    velocity: f64,
}

impl Motor {
    /// At rest.
    pub fn new(position: i64, delay: usize) -> Self {
        Self {
            line: [position; DELAY_MAX + 1],
            head: 0,
            delay: delay.min(DELAY_MAX),
            place: position as f64,
            velocity: 0.0,
        }
    }

    /// Where it is.
    pub fn actual(&self) -> i64 {
        self.line
            .get((self.head + DELAY_MAX + 1 - self.delay) % (DELAY_MAX + 1))
            .copied()
            .unwrap_or_default()
    }

    /// The newest position it was sent to.
    pub fn newest(&self) -> i64 {
        self.line.get(self.head).copied().unwrap_or_default()
    }

    /// Goes to `target` within this scan.
    pub fn follow(&mut self, target: i64) {
        self.velocity = target.saturating_sub(self.newest()) as f64;
        self.place = target as f64;
        self.push(target);
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
    }

    /// From now on every position counts `by` increments more.
    pub fn count_from(&mut self, by: i64) {
        for position in &mut self.line {
            *position = position.saturating_add(by);
        }
        self.place += by as f64;
    }

    /// At rest, with nothing on its way.
    pub fn is_at_rest(&self) -> bool {
        self.velocity == 0.0 && self.actual() == self.newest()
    }

    /// Without torque it stands where it is; what was on its way is dropped.
    pub fn let_go(&mut self) {
        self.stand_at(self.actual());
    }

    /// Someone moved it.
    pub fn stand_at(&mut self, position: i64) {
        *self = Self::new(position, self.delay);
    }

    fn push(&mut self, position: i64) {
        self.head = (self.head + 1) % (DELAY_MAX + 1);
        if let Some(slot) = self.line.get_mut(self.head) {
            *slot = position;
        }
    }
}

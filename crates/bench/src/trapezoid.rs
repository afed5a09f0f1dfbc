//! The yardstick: what a plain trapezoid of velocity costs per sample on the same machine.

/// A rest-to-rest move with a trapezoid of velocity, planned once.
#[derive(Clone, Copy, Debug)]
pub struct Trapezoid {
    start: f64,
    target: f64,
    /// Signed (u/s^2).
    acceleration: f64,
    /// Signed velocity of the plateau (u/s).
    plateau: f64,
    /// When the plateau begins, when it ends, and when the move ends (s).
    times: [f64; 3],
}

/// What it tells of one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Position (u).
    pub position: f64,
    /// Velocity (u/s).
    pub velocity: f64,
    /// Acceleration (u/s^2).
    pub acceleration: f64,
}

impl Trapezoid {
    /// A symmetric move from `start` to `target` (u) that reaches `velocity` (u/s) for `hold` > 0 seconds.
    pub fn new(start: f64, target: f64, velocity: f64, hold: f64) -> Self {
        let distance = target - start;
        let plateau = if distance < 0.0 { -velocity } else { velocity };
        let rise = distance / plateau - hold;
        Self {
            start,
            target,
            acceleration: plateau / rise,
            plateau,
            times: [rise, rise + hold, rise + hold + rise],
        }
    }

    /// Duration (s).
    pub fn duration(&self) -> f64 {
        self.times[2]
    }

    /// Position, velocity and acceleration at `t` seconds after the start, in closed form.
    pub fn at(&self, t: f64) -> Sample {
        let [rise, fall, end] = self.times;
        if t <= 0.0 {
            Sample {
                position: self.start,
                ..Sample::default()
            }
        } else if t < rise {
            Sample {
                position: self.start + 0.5 * self.acceleration * t * t,
                velocity: self.acceleration * t,
                acceleration: self.acceleration,
            }
        } else if t < fall {
            Sample {
                position: self.start + self.plateau * (t - 0.5 * rise),
                velocity: self.plateau,
                acceleration: 0.0,
            }
        } else if t < end {
            let left = end - t;
            Sample {
                position: self.target - 0.5 * self.acceleration * left * left,
                velocity: self.acceleration * left,
                acceleration: -self.acceleration,
            }
        } else {
            Sample {
                position: self.target,
                ..Sample::default()
            }
        }
    }
}

//! The yardsticks: the cost per sample of a plain trapezoid of velocity on the same machine, planned once
//! or from its parameters each time.

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

/// Its state at one instant.
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

/// A sample of the shortest symmetric trapezoid over `distance` (u) within `velocity` (u/s) and `acceleration`
/// (u/s^2), `t` seconds after the start, in closed form from these four values.
pub fn trapezoid(distance: f64, velocity: f64, acceleration: f64, t: f64) -> Sample {
    let sign = if distance < 0.0 { -1.0 } else { 1.0 };
    let length = distance.abs();
    let full = velocity / acceleration;
    let (plateau, rise, hold) = if length >= velocity * full {
        (velocity, full, length / velocity - full)
    } else {
        let rise = (length / acceleration).sqrt();
        (acceleration * rise, rise, 0.0)
    };
    let left = rise + hold + rise - t;
    if t <= 0.0 {
        Sample::default()
    } else if t < rise {
        Sample {
            position: sign * 0.5 * acceleration * t * t,
            velocity: sign * acceleration * t,
            acceleration: sign * acceleration,
        }
    } else if t < rise + hold {
        Sample {
            position: sign * plateau * (t - 0.5 * rise),
            velocity: sign * plateau,
            acceleration: 0.0,
        }
    } else if left > 0.0 {
        Sample {
            position: sign * (length - 0.5 * acceleration * left * left),
            velocity: sign * acceleration * left,
            acceleration: -sign * acceleration,
        }
    } else {
        Sample {
            position: distance,
            ..Sample::default()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Trapezoid, trapezoid};

    /// The two give the same results for a move, so neither leaves out work.
    #[test]
    fn both_forms_agree() {
        for distance in [1.5, -1.5] {
            let planned = Trapezoid::new(0.0, distance, 1.2, 1.0);
            for scan in -5..1600 {
                let t = f64::from(scan) * 0.001;
                let (one, other) = (planned.at(t), trapezoid(distance, 1.2, 4.8, t));
                assert!((one.position - other.position).abs() < 1e-12, "{t}");
                assert!((one.velocity - other.velocity).abs() < 1e-12, "{t}");
            }
        }
    }
}

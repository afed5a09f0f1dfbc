//! The second view of a plan: the forward-Euler chain as exact whole numbers.

use super::GridPlan;

/// State of the chain `j += d; a += j; v += a; x += v` (each from the value its input had before) after k
/// samples, in whole numbers (docs/planner.md, eq. 23).
///
/// With the signed distance dx, product P and sample time Ts the physical values are `start + dx x / P`,
/// `dx v / (P Ts)`, `dx a / (P Ts^2)`, `dx j / (P Ts^3)`. At order m the chain has m integrators, so at
/// order 3 there is no `jerk` and at order 2 no `acceleration` either; they are 0.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Euler {
    /// Position, 0 to P.
    pub position: i128,
    /// Velocity.
    pub velocity: i128,
    /// Acceleration.
    pub acceleration: i128,
    /// Jerk.
    pub jerk: i128,
    /// The input of the chain from this sample to the next: -1, 0 or 1 times the amplitude.
    pub input: i128,
}

impl GridPlan {
    /// The forward-Euler chain after `scan` samples, in closed form: 16 terms at most.
    ///
    /// Exact for every `scan`; from [`GridPlan::scans`] on the position is [`GridPlan::product`] and the
    /// rest is 0.
    pub fn euler(&self, scan: u64) -> Euler {
        if self.scans == 0 {
            return Euler::default();
        }
        let k = i128::from(scan.min(u64::from(self.scans)));
        let mut sums = [0_i128; 5];
        for subset in 0..1_u32 << self.order.degree() {
            let mut instant = 0;
            for (bit, length) in self.boxes.iter().enumerate() {
                if subset >> bit & 1 == 1 {
                    instant += i128::from(*length);
                }
            }
            let since = k - instant;
            if since >= 0 {
                let sign = if subset.count_ones() % 2 == 0 { 1 } else { -1 };
                for (sum, choose) in sums.iter_mut().zip(binomials(since)) {
                    *sum += sign * choose;
                }
            }
        }
        // The sum of powers 0 is the input of the chain; each integrator has that of one power more.
        let [input, ..] = sums;
        let degree = self.order.degree();
        let sum = |derivative| match degree.saturating_sub(derivative) {
            0 => 0,
            power => sums.get(power).copied().unwrap_or(0),
        };
        Euler {
            position: sum(0),
            velocity: sum(1),
            acceleration: sum(2),
            jerk: sum(3),
            input,
        }
    }
}

/// The binomial coefficients n over 0 to n over 4, for 0 <= n < 2^31.
fn binomials(n: i128) -> [i128; 5] {
    let two = n * (n - 1) / 2;
    let three = two * (n - 2) / 3;
    let four = three * (n - 3) / 4;
    [1, n, two, three, four]
}

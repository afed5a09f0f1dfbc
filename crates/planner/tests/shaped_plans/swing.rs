//! A load on a spring, simulated: the judge of the remaining swing. It shares no code with the shapers.

use standstill_planner::Setpoint;

/// A load on a spring under an axis: `q'' + 2 z w q' + w^2 q = -x''`, with `q` the distance of the load from the axis.
#[derive(Clone, Copy, Debug)]
pub struct Load {
    pub frequency: f64,
    pub damping: f64,
}

/// Places and weights of Gauss's quadrature with three points, for the stretch from -1 to 1.
const GAUSS: [(f64, f64); 3] = [
    (-0.774_596_669_241_483_4, 5.0 / 9.0),
    (0.0, 8.0 / 9.0),
    (0.774_596_669_241_483_4, 5.0 / 9.0),
];

impl Load {
    /// How far (u) the load swings to either side after the last of `scans` scans, at rest before the first.
    ///
    /// Within a scan the acceleration is the one at its end, traced back along the jerk and the snap in force just before.
    /// The response to it is Duhamel's integral.
    // The judge uses the library's functions: its bits do not matter.
    #[allow(clippy::disallowed_methods)]
    pub fn swing(&self, scans: u32, cycle: f64, at: impl Fn(u64) -> Setpoint) -> f64 {
        let natural = std::f64::consts::TAU * self.frequency;
        let sigma = self.damping * natural;
        let damped = natural * (1.0 - self.damping * self.damping).sqrt();
        let end = f64::from(scans) * cycle;
        let (mut real, mut imaginary) = (0.0, 0.0);
        for scan in 1..=scans {
            let here = at(scan.into());
            for (place, weight) in GAUSS {
                let left = 0.5 * cycle * (1.0 - place);
                let acceleration = here.acceleration - left * (here.jerk - 0.5 * left * here.snap);
                let to_go = end - (f64::from(scan) * cycle - left);
                let part = 0.5 * cycle * weight * acceleration * (-sigma * to_go).exp();
                real += part * (damped * to_go).cos();
                imaginary += part * (damped * to_go).sin();
            }
        }
        real.hypot(imaginary) / damped
    }
}

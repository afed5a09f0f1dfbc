//! The swing that shapers leave, and the properties of a plan that they keep. The load is simulated by [`swing`].

mod kept;
mod swing;
mod yardstick;

use standstill_planner::{GridPlan, Limits, Method, Setpoint, ShaperKind, Shapers, VibrationMode};

/// A grid plan through shapers.
struct Shaped {
    plan: GridPlan,
    shapers: Shapers,
}

impl Shaped {
    fn new(way: f64, limits: &Limits, shapers: Shapers, cycle: f64) -> Self {
        let plan = GridPlan::new(Method::Overlapped, 0.0, way, limits, cycle).expect("a plan");
        Self { plan, shapers }
    }

    fn scans(&self) -> u32 {
        self.shapers.scans(self.plan.scans())
    }

    fn at(&self, scan: u64) -> Setpoint {
        self.shapers.at(scan, |scan| self.plan.at(scan))
    }

    fn peak_acceleration(&self) -> f64 {
        let at = |scan| self.at(scan).acceleration.abs();
        (0..=u64::from(self.scans())).map(at).fold(0.0, f64::max)
    }
}

fn mode(frequency: f64, damping: f64, shaper: ShaperKind) -> Option<VibrationMode> {
    Some(VibrationMode {
        frequency,
        damping,
        shaper,
    })
}

/// Limits of order 2, 3 or 4: the jerk rises to the acceleration in `ramp` seconds, the snap to the jerk in an eighth of it.
fn limits(order: u32, velocity: f64, acceleration: f64, ramp: f64) -> Limits {
    let from = |least: u32, value: f64| if order >= least { value } else { f64::INFINITY };
    Limits {
        velocity,
        acceleration,
        deceleration: acceleration,
        jerk: from(3, acceleration / ramp),
        snap: from(4, 8.0 * acceleration / (ramp * ramp)),
    }
}

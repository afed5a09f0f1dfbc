//! Shaped moves against a jerk-limited one that takes as many scans.

use super::swing::Load;
use super::{Shaped, limits, mode};
use standstill_planner::{ShaperKind, Shapers};

/// A move, in periods of its load: how long its velocity rises, how long it is constant, and how long the
/// acceleration of the jerk-limited move rises.
struct Move {
    name: &'static str,
    rise: f64,
    cruise: f64,
    jerk: f64,
}

const MOVES: [Move; 3] = [
    Move {
        name: "pick",
        rise: 5.75,
        cruise: 3.0,
        jerk: 0.2,
    },
    Move {
        name: "transfer",
        rise: 6.75,
        cruise: 4.0,
        jerk: 0.2,
    },
    Move {
        name: "shuttle",
        rise: 6.0,
        cruise: 5.5,
        jerk: 0.2,
    },
];

/// The most that each shaper may leave.
const YARDSTICK: [(ShaperKind, f64); 3] = [
    (ShaperKind::Zv, 1.0 / 6.0),
    (ShaperKind::Ei, 1.0 / 20.0),
    (ShaperKind::Zvd, 1.0 / 32.0),
];

/// True frequencies, as a ratio to the one that the shaper was made for.
const OFF: [f64; 5] = [0.9, 0.95, 1.0, 1.05, 1.1];

const CYCLE: f64 = 1e-3;

impl Move {
    /// Its way at a velocity of 1, and the acceleration.
    fn way(&self, period: f64) -> (f64, f64) {
        let way = (self.rise + self.jerk + self.cruise) * period;
        (way, 1.0 / (self.rise * period))
    }

    fn plain(&self, period: f64) -> Shaped {
        let (way, acceleration) = self.way(period);
        let limits = limits(3, 1.0, acceleration, self.jerk * period);
        Shaped::new(way, &limits, Shapers::default(), CYCLE)
    }

    /// The same way through shapers, with the acceleration at which it takes at most `scans`.
    fn shaped(&self, order: u32, period: f64, shapers: Shapers, scans: u32) -> Shaped {
        let (way, acceleration) = self.way(period);
        let with = |acceleration| {
            let limits = limits(order, 1.0, acceleration, self.jerk * period);
            Shaped::new(way, &limits, shapers, CYCLE)
        };
        let (mut low, mut high) = (0.5 * acceleration, 20.0 * acceleration);
        for _ in 0..24 {
            let middle = 0.5 * (low + high);
            if with(middle).scans() > scans {
                low = middle;
            } else {
                high = middle;
            }
        }
        with(high)
    }
}

/// The largest swing of loads around this frequency.
fn swing(plan: &Shaped, frequency: f64, damping: f64) -> f64 {
    let places: Vec<_> = (0..=u64::from(plan.scans())).map(|scan| plan.at(scan)).collect();
    let swing = |off| {
        let load = Load {
            frequency: frequency * off,
            damping,
        };
        load.swing(plan.scans(), CYCLE, |scan| places[scan as usize])
    };
    OFF.map(swing).into_iter().fold(0.0, f64::max)
}

/// In as many scans, with 1 to 1.3 times the acceleration, at orders 2 to 4, for loads up to 10 % off.
///
/// Covers: VB3
#[test]
fn a_shaped_move_leaves_its_part_of_the_swing_of_a_jerk_limited_one() {
    for (frequency, damping) in [(20.0, 0.0), (20.0, 0.01), (12.0, 0.01)] {
        let period = 1.0 / frequency;
        for one in &MOVES {
            let plain = one.plain(period);
            let unshaped = swing(&plain, frequency, damping);
            for (shaper, most) in YARDSTICK {
                let shapers =
                    Shapers::new(&[mode(frequency, damping, shaper), None], CYCLE).expect("shapers");
                for order in [2, 3, 4] {
                    let what = format!("{} {shaper:?} order {order}, {frequency} Hz, {damping}", one.name);
                    let plan = one.shaped(order, period, shapers, plain.scans());
                    assert_eq!(plan.scans(), plain.scans(), "{what}");
                    let higher = plan.peak_acceleration() / plain.peak_acceleration();
                    assert!(
                        (1.0..=1.3).contains(&higher),
                        "{what}: {higher} times the acceleration"
                    );
                    let left = swing(&plan, frequency, damping) / unshaped;
                    assert!(left <= most, "{what}: leaves 1/{:.1}", 1.0 / left);
                }
            }
        }
    }
}

/// Against the same move unshaped, at the frequency that the shaper was made for, for any fraction of a scan in its
/// period: nothing is left. Exceptions: `ei`, which tolerates 3 %, and the fraction of a scan that `period` cannot
/// place.
///
/// Covers: VB2
#[test]
fn at_the_frequency_itself_nothing_is_left_but_what_the_shaper_tolerates() {
    for frequency in [50.0, 20.0, 17.3, 12.5, 6.1] {
        for damping in [0.0, 0.01, 0.1] {
            for order in [2, 3, 4] {
                let period = 1.0 / frequency;
                let limits = limits(order, 1.0, 0.4 / period, 0.3 * period);
                let load = Load { frequency, damping };
                let left = |shaper| {
                    let shapers =
                        Shapers::new(&[mode(frequency, damping, shaper), None], CYCLE).expect("shapers");
                    let plan = Shaped::new(5.3 * period, &limits, shapers, CYCLE);
                    let plain = Shaped::new(5.3 * period, &limits, Shapers::default(), CYCLE);
                    load.swing(plan.scans(), CYCLE, |scan| plan.at(scan))
                        / load.swing(plain.scans(), CYCLE, |scan| plain.at(scan))
                };
                let what = format!("{frequency} Hz, {damping}, order {order}");
                assert!(left(ShaperKind::Zv) < 1e-9, "{what}");
                assert!(left(ShaperKind::Zvd) < 1e-9, "{what}");
                assert!((0.0..0.0301).contains(&left(ShaperKind::Ei)), "{what}");
                let most = if (CYCLE * frequency).recip().fract() == 0.0 && damping == 0.0 {
                    1e-9
                } else {
                    1e-3
                };
                assert!(
                    left(ShaperKind::Period) < most,
                    "{what}: {}",
                    left(ShaperKind::Period)
                );
            }
        }
    }
}

/// Two modes, each with a shaper of its own: loads of both frequencies, also 10 % off.
///
/// Covers: VB13
#[test]
fn two_modes_come_to_rest_together() {
    let loads = [(7.0, 0.01), (19.0, 0.02)];
    for order in [2, 3, 4] {
        let limits = limits(order, 1.0, 4.0, 0.02);
        let plain = Shaped::new(0.8, &limits, Shapers::default(), CYCLE);
        let unshaped = loads.map(|(frequency, damping)| swing(&plain, frequency, damping));
        let pairs = ShaperKind::ALL
            .into_iter()
            .flat_map(|first| ShaperKind::ALL.map(|second| [first, second]));
        // In a short run every third pair: each kind is still once the first and once the second.
        for kinds in pairs.step_by(standstill_testkit::whole_or(1, 3)) {
            let modes = [0, 1].map(|load| mode(loads[load].0, loads[load].1, kinds[load]));
            let shapers = Shapers::new(&modes, CYCLE).expect("shapers");
            let plan = Shaped::new(0.8, &limits, shapers, CYCLE);
            for (load, (frequency, damping)) in loads.into_iter().enumerate() {
                let what = format!("{kinds:?}, order {order}, {frequency} Hz");
                let left = swing(&plan, frequency, damping) / unshaped[load];
                let most = match kinds[load] {
                    ShaperKind::Period => 0.13,
                    ShaperKind::Zv => 1.0 / 6.0,
                    ShaperKind::Zvd | ShaperKind::Ei => 1.0 / 30.0,
                };
                assert!(left <= most, "{what}: leaves 1/{:.1}", 1.0 / left);
            }
        }
    }
}

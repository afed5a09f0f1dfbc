//! Measured masters: the values that a slave of actual values sees. No report of the master's drive takes the slave
//! beyond its limits.
//!
//! The check uses neither filter nor planner. It takes differences of published positions, and sums of its own over
//! the reported positions.

use crate::draw;
use crate::followed::behind;
use standstill_axis::{
    Axis, AxisConfig, AxisId, AxisState, Command, Comms, DriveFeedback, DrivePosition, DriveSignals,
    Dynamics, ErrorId, ExecutionMode, Limits, Log, Request, Scaling, Scope, Standard, StartState, SyncMode,
    SyncPoint, ValueSource, couple, steps,
};
use standstill_testkit::{Random, cases};

const CYCLE: f64 = 0.001;

/// Increments per unit.
const UNIT: f64 = 1000.0;

/// A master that counts increments, and its slave.
struct Bench {
    axes: [Axis<Standard>; 2],
    log: Log,
    scan: u64,
    /// Positions published by the slave.
    published: Vec<f64>,
    /// The largest of its positions.
    farthest: f64,
}

fn axis(number: u16, config: AxisConfig) -> Axis<Standard> {
    let config = AxisConfig {
        start: StartState::Standstill,
        ..config
    };
    let planner = Standard::new(CYCLE);
    Axis::new(AxisId::new(number), config, planner).expect("a good configuration")
}

impl Bench {
    fn new(filter: u32, limits: Limits) -> Self {
        let mut master = AxisConfig::new(Limits {
            velocity: 1e4,
            acceleration: 1e6,
            deceleration: 1e6,
            jerk: 1e9,
            snap: f64::INFINITY,
        });
        master.scaling = Scaling::new(UNIT as u32, 1, false, 0.0).ok();
        master.following.actual_filter = filter;
        Self {
            axes: [axis(0, master), axis(1, AxisConfig::new(limits))],
            log: Log::default(),
            scan: 0,
            published: vec![0.0],
            farthest: 0.0,
        }
    }

    fn couple(&mut self, ratio: (i16, u16), sync: Option<SyncPoint>) -> Result<(), ErrorId> {
        let command = Command::GearIn {
            followed: behind(&self.axes[0], ratio, ValueSource::Actual),
            sync,
            dynamics: Dynamics::default(),
        };
        let scope = &mut Scope::new(self.scan, &mut self.log);
        couple(&mut self.axes, AxisId::new(1), &Request::aborting(command), scope).map(|_| ())
    }

    /// Before the blocks: the master's drive reports these increments, or nothing.
    fn latch(&mut self, increments: Option<i64>) {
        let told = |position, comms| DriveFeedback {
            enabled: true,
            voltage: true,
            fault: None,
            position,
            comms,
            signals: DriveSignals::default(),
        };
        let master = match increments {
            Some(increments) => told(DrivePosition::Increments(increments), Comms::Ok),
            None => told(DrivePosition::Increments(0), Comms::Lost),
        };
        let slave = told(DrivePosition::Units(self.axes[1].setpoint().position), Comms::Ok);
        let scope = &mut Scope::new(self.scan, &mut self.log);
        for (axis, feedback) in self.axes.iter_mut().zip([master, slave]) {
            axis.follow_feedback(&feedback, scope);
        }
    }

    /// After the blocks.
    fn advance(&mut self) {
        steps::advance(&mut self.axes, &mut Scope::new(self.scan, &mut self.log));
        self.scan += 1;
        let position = self.axes[1].setpoint().position;
        self.farthest = self.farthest.max(position.abs());
        self.published.push(position);
    }

    fn scan(&mut self, increments: i64) {
        self.latch(Some(increments));
        self.advance();
    }

    fn slave(&self) -> &Axis<Standard> {
        &self.axes[1]
    }
}

/// The largest ratio of backward differences of orders 1 to 4 to the limits, less the resolution of positions.
fn most(published: &[f64], limits: &Limits, farthest: f64) -> f64 {
    let mut differences = published.to_vec();
    let rate = limits.acceleration.max(limits.deceleration);
    let mut worst = 0.0_f64;
    let mut resolved = farthest * f64::EPSILON * 4.0;
    for limit in [limits.velocity, rate, limits.jerk, limits.snap] {
        differences = differences
            .windows(2)
            .map(|pair| (pair[1] - pair[0]) / CYCLE)
            .collect();
        resolved *= 2.0 / CYCLE;
        for value in &differences {
            worst = worst.max((value.abs() - resolved) / limit);
        }
    }
    worst
}

/// Four averages of the last positions, each a plain sum, as positions at the ends of scans.
fn averaged(told: &[i64], length: usize) -> Vec<f64> {
    let mut values: Vec<i128> = told.iter().map(|told| i128::from(*told)).collect();
    for _ in 0..4 {
        let at = |index: usize, back: usize| values[index.saturating_sub(back)];
        values = (0..values.len())
            .map(|index| (0..length).map(|back| at(index, back)).sum())
            .collect();
    }
    let scale = (length as f64) * (length as f64) * (length as f64) * (length as f64);
    let at = |index: usize, back: usize| values[index.saturating_sub(back)];
    (0..values.len())
        .map(|index| {
            let sum = at(index, 0) + 11 * at(index, 1) + 11 * at(index, 2) + at(index, 3);
            sum as f64 / (24.0 * scale)
        })
        .collect()
}

const AMPLE: Limits = Limits {
    velocity: 1e5,
    acceleration: 1e8,
    deceleration: 1e8,
    jerk: 1e12,
    snap: f64::INFINITY,
};

/// Covers: G81
#[test]
fn a_slave_in_gear_is_on_the_averages_of_what_was_told() {
    let mut random = Random(81);
    for length in [1_u32, 2, 3, 16, 17, 64] {
        let mut bench = Bench::new(length, AMPLE);
        let mut told = vec![0_i64; 4 * length as usize + 8];
        let settled = told.len();
        for increments in &told.clone() {
            bench.scan(*increments);
        }
        bench.couple((1, 1), None).expect("taken");
        for _ in 0..2000 {
            let last = told.last().copied().unwrap_or(0);
            // Never so slow that it counts as at rest.
            told.push(last + 5 + i64::try_from(random.below(200)).expect("small"));
        }
        let expected = averaged(&told, length as usize);
        for (increments, place) in told.iter().zip(&expected).skip(settled) {
            bench.scan(*increments);
            assert!(bench.slave().is_in_gear(), "{length}");
            let published = bench.slave().setpoint().position;
            assert!(
                (published - place / UNIT).abs() <= 4.0 * f64::EPSILON * published.abs(),
                "{length}: {published} {place}"
            );
        }
    }
}

/// Covers: G81
#[test]
fn noise_of_an_increment_stays_below_the_bounds_in_closed_form() {
    let mut random = Random(5);
    for length in [4_u32, 8, 16, 32, 64] {
        let mut bench = Bench::new(length, AMPLE);
        let mut place = 0;
        bench.scan(0);
        bench.couple((1, 1), None).expect("taken");
        // At a constant velocity, so that the rest is noise. The first scans are the start.
        for scan in 0..6000 {
            place += 100;
            // Now and then the worst noise possible: a whole average in one direction, then one in the other.
            let noise = if scan % 1000 < 500 {
                i64::try_from(random.below(3)).expect("small") - 1
            } else {
                1 - 2 * (i64::from(scan) / i64::from(length) % 2)
            };
            bench.scan(place + noise);
        }
        let noise = 1.0 / UNIT;
        let span = f64::from(length) * CYCLE;
        let mut differences = bench.published[1000..].to_vec();
        let mut resolved = bench.farthest * f64::EPSILON * 4.0;
        for (order, bound) in [2.0, 4.0, 8.0, 16.0].into_iter().enumerate() {
            differences = differences
                .windows(2)
                .map(|pair| (pair[1] - pair[0]) / CYCLE)
                .collect();
            resolved *= 2.0 / CYCLE;
            let steady = if order == 0 { 100.0 / UNIT / CYCLE } else { 0.0 };
            let worst = differences.iter().map(|value| (value - steady).abs());
            let worst = worst.fold(0.0, f64::max);
            let mut bound = bound * noise;
            for _ in 0..=order {
                bound /= span;
            }
            assert!(worst <= bound + resolved, "{length} {order}: {worst} {bound}");
            println!("{length} scans, order {}: {worst:.3} of {bound:.3}", order + 1);
        }
    }
}

/// Covers: G82
#[test]
fn a_master_at_rest_that_trembles_by_an_increment_moves_nothing() {
    let mut random = Random(82);
    for length in [1_u32, 16, 64] {
        for rest in [0_i64, 12_345, -7] {
            let mut bench = Bench::new(length, AMPLE);
            for _ in 0..400 {
                bench.scan(rest);
            }
            bench.couple((3, 7), None).expect("taken");
            for _ in 0..2000 {
                bench.scan(rest + i64::try_from(random.below(3)).expect("small") - 1);
                assert!(bench.slave().is_in_gear());
                assert_eq!(bench.slave().setpoint().position, 0.0);
            }
            // It follows larger changes.
            for _ in 0..600 {
                bench.scan(rest + 2);
            }
            let followed = bench.slave().setpoint().position;
            let expected = 3.0 / 7.0 * 2.0 / UNIT;
            assert!((followed - expected).abs() < 1e-12, "{followed} {expected}");
        }
    }
}

/// The possible reports of a drive: motions, noise, rest, jumps of any size.
fn nonsense(random: &mut Random, scans: usize) -> Vec<i64> {
    let whole = |value: f64| value as i64;
    let mut told = Vec::new();
    let (mut place, mut pace) = (0_i64, 0.0_f64);
    while told.len() < scans {
        let kind = random.below(8);
        let length = 1 + random.below(300);
        let size = whole(random.log(1.0, 1e4));
        for _ in 0..length {
            let noise = whole(random.between(-1.0, 1.0) * size as f64);
            match kind {
                0 => {}
                1 => pace += random.between(-2.0, 2.0),
                2 => pace *= 0.97,
                3 => pace = random.between(-300.0, 300.0),
                _ => {}
            }
            let step = match kind {
                0 => 0,
                4 => noise,
                5 if told.len() % 50 == 0 => whole(random.between(-1e9, 1e9)),
                6 if told.len() % 90 == 0 => noise.saturating_mul(1 << 40),
                _ => whole(pace),
            };
            place = place.saturating_add(step);
            told.push(match kind {
                7 => place.saturating_add(noise),
                _ => place,
            });
        }
    }
    told.truncate(scans);
    told
}

/// Covers: G83, G45, G46
#[test]
fn whatever_the_drive_tells_the_slave_keeps_its_limits() {
    let episodes = cases(300);
    let (mut worst, mut in_gear, mut scans) = (0.0_f64, 0_u64, 0_u64);
    for seed in 0..episodes {
        let mut random = Random(seed);
        let limits = draw::limits(&mut random);
        let filter = [1, 4, 16, 16, 16, 40, 64][random.below(7) as usize];
        let mut bench = Bench::new(filter, limits);
        let ratio = (random.below(9) as i16 - 4, 1 + random.below(5) as u16);
        let sync = (random.below(3) == 0).then(|| SyncPoint {
            master: random.between(-5.0, 50.0),
            slave: random.between(-5.0, 5.0),
            start_distance: [0.0, 0.0, 2.0, -1.0][random.below(4) as usize],
            mode: SyncMode::Shortest.into(),
        });
        let told = nonsense(&mut random, 3000);
        let couples_at = random.below(1500) as usize;
        for (scan, increments) in told.iter().enumerate() {
            bench.latch(Some(*increments));
            if scan == couples_at || (scan > couples_at && random.below(700) == 0) {
                bench.couple(ratio, sync).expect("taken");
            }
            if random.below(900) == 0 {
                let scope = &mut Scope::new(bench.scan, &mut bench.log);
                let by = random.between(-10.0, 10.0);
                bench.axes[0]
                    .set_position(by, true, ExecutionMode::Immediately.into(), scope)
                    .expect("taken");
            }
            bench.advance();
            scans += 1;
            in_gear += u64::from(bench.slave().is_in_gear());
            assert_ne!(
                bench.slave().state(),
                AxisState::ErrorStop,
                "{seed} {scan} {:?}",
                bench.slave().error_id()
            );
        }
        let master = told.iter().map(|told| told.unsigned_abs()).max().unwrap_or(0) as f64 / UNIT;
        let master = master * f64::from(ratio.0).abs() / f64::from(ratio.1);
        let most = most(&bench.published, &limits, bench.farthest.max(master));
        assert!(most <= 1.0 + 1e-6, "{seed}: {most} {limits:?} {filter}");
        worst = worst.max(most);
    }
    println!("{episodes} episodes, {in_gear} of {scans} scans in gear, at most {worst} of a limit");
    assert!(
        in_gear * 20 > scans,
        "the slaves were hardly ever in gear: {in_gear} of {scans}"
    );
}

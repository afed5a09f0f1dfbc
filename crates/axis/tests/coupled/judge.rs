//! The rules for published positions: differences within the limits, and rows in gear on the law to the bit.

use super::exact::{Law, Row};
use super::rig::Rig;
use crate::standing;
use standstill_axis::{Axis, AxisConfig, AxisId, Command, CommandId, Direction, Dynamics, Limits};

/// By how much a limit may be exceeded, relative to it.
const RELATIVE: f64 = 1e-9;

/// The resolution of an instant of a plan, relative to the time since the start of the motion.
const TICK: f64 = 2.0 * f64::EPSILON;

const NAMES: [&str; 4] = ["velocity", "acceleration", "jerk", "snap"];

/// The last published positions of one axis.
pub struct Track {
    bounds: [f64; 4],
    cycle: f64,
    turn: Option<f64>,
    /// Whole turns, counted from the published positions.
    pub turns: i64,
    position: f64,
    /// Distances from scan to scan, newest first.
    ways: [f64; 4],
    known: usize,
    /// The largest number from which a position is computed (u).
    pub largest: f64,
    /// The longest time of a motion (s).
    pub time: f64,
}

impl Track {
    pub fn new(axis: &Axis, cycle: f64) -> Self {
        let limits = axis.config().limits;
        let turn = axis.config().modulo;
        let position = axis.setpoint().position;
        Self {
            bounds: [
                limits.velocity,
                limits.acceleration.max(limits.deceleration),
                limits.jerk,
                limits.snap,
            ],
            cycle,
            turn,
            turns: 0,
            position,
            ways: [0.0; 4],
            known: 4,
            // An endless motion is moved back when it is two turns away.
            largest: position.abs().max(3.0 * turn.unwrap_or(0.0)),
            time: 0.0,
        }
    }

    /// Takes the set-point of a scan. Returns the largest excess of the set-point and the differences over a limit,
    /// relative to the limit, less the resolution of positions; an error if that is more than allowed.
    pub fn take(&mut self, axis: &Axis) -> Result<f64, String> {
        let setpoint = axis.setpoint();
        self.time = if setpoint.is_at_rest() {
            0.0
        } else {
            self.time + self.cycle
        };
        let mut way = setpoint.position - self.position;
        self.position = setpoint.position;
        if let Some(turn) = self.turn {
            let passed = -(way / turn).round();
            self.turns += passed as i64;
            way += passed * turn;
        }
        self.ways.rotate_right(1);
        self.ways[0] = way;
        self.known = 4.min(self.known + 1);
        // A way onto the law is computed from the place of the law. On a modulo axis it is planned anew every two
        // turns.
        let deviation = match self.turn {
            Some(turn) => axis.deviation().abs().min(2.0 * turn),
            None => axis.deviation().abs(),
        };
        self.largest = self.largest.max(setpoint.position.abs() + deviation);
        // Rounding of a position, and of its instant.
        let mut resolved = (self.largest.next_up() - self.largest) + TICK * self.time * self.bounds[0];
        let mut differences = self.ways;
        let mut worst = 0.0_f64;
        let told = [
            setpoint.velocity,
            setpoint.acceleration,
            setpoint.jerk,
            setpoint.snap,
        ];
        for order in 0..4 {
            resolved *= 2.0 / self.cycle;
            let bound = self.bounds[order];
            let value = differences[0] / self.cycle;
            for place in 0..3 - order {
                differences[place] = (differences[place] - differences[place + 1]) / self.cycle;
            }
            let over = ((value.abs() - resolved) / bound - 1.0).max(0.0);
            let rate = self.bounds.get(order + 1).copied().unwrap_or(0.0);
            let rate = if rate.is_finite() { rate } else { 0.0 };
            let over_told = ((told[order].abs() - TICK * self.time * rate) / bound - 1.0).max(0.0);
            for (what, over, value) in [("difference", over, value), ("told", over_told, told[order])] {
                if over > RELATIVE {
                    return Err(format!(
                        "{what}: {} is {value:e}, limit {bound:e}, {over:e} over it",
                        NAMES[order]
                    ));
                }
                worst = worst.max(over);
            }
        }
        Ok(worst)
    }
}

/// The place of an axis: turns and position, and the distance by which it sees its master ahead.
#[derive(Clone, Copy)]
pub struct Where(i64, f64, f64);

/// The places of all axes.
pub fn places(axes: &[Axis], tracks: &[Track]) -> Vec<Where> {
    let place =
        |(axis, track): (&Axis, &Track)| Where(track.turns, axis.setpoint().position, axis.phases()[0]);
    axes.iter().zip(tracks).map(place).collect()
}

/// The law of a slave, found from its rows.
#[derive(Default)]
pub struct Locked {
    /// Master, ratio, and the command that owns the slave.
    of: Option<(AxisId, i32, u16, Option<CommandId>)>,
    /// The sync positions of MC_GearInPos.
    given: Option<(f64, f64)>,
    /// Rows that may be on the law.
    anchors: Vec<Row>,
    was_locked: bool,
    /// The number of checked rows.
    pub rows: u64,
}

impl Locked {
    /// A command took over, other than the same gear again: it leads to another law.
    pub fn begin_anew(&mut self) {
        self.was_locked = false;
        self.of = None;
    }

    /// Checks the row of axis `index` after a scan against its law. The places of all axes were `before` the scan,
    /// and are `now` after it. `given` are the sync positions of MC_GearInPos. The slave `came_into_gear` in this
    /// scan, and may have lost it again in it.
    pub fn take(
        &mut self,
        index: usize,
        axes: &[Axis],
        (before, now): (&[Where], &[Where]),
        given: Option<(f64, f64)>,
        came_into_gear: bool,
    ) -> Result<(), String> {
        let axis = &axes[index];
        let Some((master, numerator, denominator)) = axis.gears()[0] else {
            *self = Self {
                rows: self.rows,
                ..Self::default()
            };
            return Ok(());
        };
        let law = Law {
            numerator,
            denominator,
            master_turn: axes[master.index()].config().modulo,
            slave_turn: axis.config().modulo,
        };
        let row = |places: &[Where]| Row {
            turns: places[master.index()].0,
            master: places[master.index()].1,
            phase: places[index].2,
            slave: places[index].1,
        };
        let (before, row) = (row(before), row(now));
        let of = Some((master, numerator, denominator, axis.active_command()));
        let is_locked = axis.is_in_gear();
        let same_gear =
            |other: &(AxisId, i32, u16, _)| (other.0, other.1, other.2) == (master, numerator, denominator);
        // The same gear commanded again with MC_GearIn while in gear is the same law; any other command makes a new
        // one.
        let is_same = given.is_none() && self.given.is_none() && self.of.as_ref().is_some_and(same_gear);
        let goes_on = self.of == of || (is_same && self.was_locked);
        if !goes_on {
            self.anchors.clear();
        }
        self.of = of;
        self.given = given;
        self.was_locked = is_locked;
        if !is_locked {
            // If it came into gear but has no row in gear, the law goes through its place before, and it returns to
            // that law.
            if came_into_gear && given.is_none() && self.anchors.is_empty() {
                self.anchors.push(before);
            }
            return Ok(());
        }
        self.rows += 1;
        if self.anchors.is_empty() {
            self.anchors = match given {
                // The slave has chosen the turn of the master in which the sync point is.
                Some((at, slave)) => (-200..=200)
                    .map(|turns| Row {
                        turns: if law.master_turn.is_some() {
                            row.turns + turns
                        } else {
                            0
                        },
                        master: at,
                        phase: 0.0,
                        slave,
                    })
                    .collect(),
                // On the law from this row on. If it was on the law when it was coupled, from the row before.
                None => vec![before, row],
            };
        }
        self.anchors.retain(|anchor| law.holds(anchor, &row));
        if self.anchors.is_empty() {
            return Err(format!(
                "off its law: {law:?} {row:?}, before {before:?}, given {given:?}"
            ));
        }
        Ok(())
    }
}

/// In gear, the same gear commanded twice in one scan changes no bit.
///
/// Covers: G28
#[test]
fn the_same_gear_twice_in_one_scan_is_the_same_law() {
    let limits = Limits {
        velocity: 200.0,
        acceleration: 1000.0,
        deceleration: 1000.0,
        jerk: 20_000.0,
        snap: 1e6,
    };
    let config = standing::config(limits);
    let mut rig = Rig::new(&[config; 3], 0.001);
    let gear = rig.gear(0, (3, 7), None, Dynamics::default());
    for slave in [1, 2] {
        rig.command(slave, gear).expect("taken");
    }
    let run = Command::MoveVelocity {
        dynamics: Dynamics::at(150.0),
        direction: Direction::Unset.into(),
    };
    rig.command(0, run).expect("taken");
    for scan in 0..400 {
        if scan % 50 == 49 {
            rig.command(1, gear).expect("taken");
            rig.command(1, gear).expect("taken");
        }
        rig.step();
        let [_, often, once] = &rig.axes[..] else {
            panic!("three axes")
        };
        assert!(often.is_in_gear(), "scan {scan}");
        assert_eq!(often.setpoint(), once.setpoint(), "scan {scan}");
    }
}

/// A way of many turns back onto the law makes the places of the slave no coarser than a way of a few turns.
///
/// Covers: G45, G48
#[test]
fn however_far_behind_a_slave_comes_back_within_its_limits() {
    let fast = Limits {
        velocity: 1e5,
        acceleration: 1e7,
        deceleration: 1e7,
        jerk: 1e9,
        snap: 1e11,
    };
    let slow = Limits {
        velocity: 2000.0,
        acceleration: 4000.0,
        deceleration: 4000.0,
        jerk: 1e4,
        snap: 1e5,
    };
    let config = |limits| AxisConfig {
        modulo: Some(360.0),
        ..standing::config(limits)
    };
    for turns in [50.0, 500.0, 1500.0] {
        let mut rig = Rig::new(&[config(fast), config(slow)], 0.001);
        let gear = rig.gear(0, (1, 1), None, Dynamics::default());
        rig.command(1, gear).expect("taken");
        let go = Command::MoveRelative {
            distance: turns * 360.0,
            dynamics: Dynamics::at(1e5),
        };
        let mut track = Track::new(&rig.axes[1], 0.001);
        rig.step();
        rig.command(0, go).expect("taken");
        let mut scans = 0;
        loop {
            rig.step();
            scans += 1;
            // It may take any time.
            track.time = 0.0;
            assert_eq!(
                track.take(&rig.axes[1]).err(),
                None,
                "{turns} turns, scan {scans}"
            );
            if rig.axes[1].is_in_gear() {
                break;
            }
            assert!(scans < 300_000, "{turns} turns");
        }
        assert_eq!(track.turns, turns as i64);
    }
}

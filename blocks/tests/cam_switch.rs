//! Cams switch in the right scan, at every speed, in both directions, on axes with and without turns.
//!
//! The expected outputs are computed without the block's arithmetic: the position is followed without
//! turns, and every turn has its own cams.

use standstill_axis::{
    Axis, AxisConfig, AxisId, Command, Comms, Direction, DriveFeedback, DrivePosition, DriveSignals,
    Dynamics, Limits, Log, Request, Scope, Standard, StartState, steps,
};
use standstill_blocks::administrative::mc_digital_cam_switch::{
    CamSwitch, Inputs, McDigitalCamSwitch, TrackOption,
};
use standstill_fb::{Context, Instance, OutputRef, Pins, TableOf, TableRef, Time};
use standstill_testkit::Random;
use std::slice;

const CYCLE_NS: i64 = 1_000_000;
const CYCLE: f64 = 1e-3;
const TURN: f64 = 360.0;

const LIMITS: Limits = Limits {
    velocity: 1e6,
    acceleration: 1e8,
    deceleration: 1e8,
    jerk: f64::INFINITY,
    snap: f64::INFINITY,
};

/// Up to 20 scans, either sign, to the microsecond.
fn compensation(random: &mut Random) -> Time {
    Time((random.bits() % 40_000) as i64 * 1000 - 20 * CYCLE_NS)
}

/// Records as numbers of a table.
fn cells<R: Pins>(records: &[R]) -> Vec<f64> {
    let of = |record: &R| {
        (0..R::PINS.len())
            .map_while(|field| record.get(field)?.to_cell())
            .collect()
    };
    records
        .iter()
        .flat_map(|record| -> Vec<f64> { of(record) })
        .collect()
}

/// The cams in the scan of a position, in units without turns.
struct Judge {
    first: f64,
    last: f64,
    velocity: f64,
    on: f64,
    off: f64,
    turns: core::ops::RangeInclusive<i64>,
    /// Too near to an edge to decide.
    close: f64,
}

enum Verdict {
    On,
    Off,
    Open,
}

impl Judge {
    fn position_mode(&self, position: f64) -> Verdict {
        let (enter, leave) = (self.velocity * self.on, self.velocity * self.off);
        let forward = self.velocity > 0.0;
        let before = position - self.velocity * CYCLE;
        let mut on = false;
        for turn in self.turns.clone() {
            let shift = turn as f64 * TURN;
            let (first, last) = (self.first + shift, self.last + shift);
            let (lower, upper) = if forward {
                (first + enter, last + leave)
            } else {
                (first + leave, last + enter)
            };
            let near = |edge: f64| (edge - position).abs() < self.close || (edge - before).abs() < self.close;
            if (upper - lower).abs() < self.close || near(lower) || near(upper) {
                return Verdict::Open;
            }
            if upper < lower {
                continue;
            }
            let passed = if forward {
                before < lower && lower <= position
            } else {
                position <= upper && upper < before
            };
            on |= passed || (lower <= position && position <= upper);
        }
        if on { Verdict::On } else { Verdict::Off }
    }

    /// Scans since the edge of a cam in time mode was met last.
    fn since_met(&self, position: f64) -> Option<f64> {
        let edges = self.turns.clone().map(|turn| {
            let edge = self.first + turn as f64 * TURN + self.velocity * self.on;
            (position - edge) / (self.velocity * CYCLE)
        });
        edges.filter(|scans| *scans >= 0.0).reduce(f64::min)
    }
}

/// Covers: R38, R56
#[test]
fn a_table_that_is_not_there_or_too_long_is_an_error_until_it_is_mended() {
    let id = AxisId::new(0);
    let config = AxisConfig {
        start: StartState::Standstill,
        ..AxisConfig::new(LIMITS)
    };
    let mut axes = [Axis::new(id, config, Standard::new(CYCLE)).expect("a good configuration")];
    let mut log = Log::default();
    // At 0 each of them is on.
    let tables = cells(
        &[CamSwitch {
            track_number: 1,
            ..CamSwitch::default()
        }; 33],
    );
    let mut block = Instance::<McDigitalCamSwitch> {
        inputs: Inputs {
            axis: id,
            outputs: OutputRef(id),
            enable: true,
            enable_mask: 1,
            ..Inputs::default()
        },
        ..Instance::default()
    };
    let too_many = u32::try_from(tables.len()).expect("some numbers");
    let rows = [
        (0, 32, 0),
        (0, 33, 135),
        (6, 32, 0),
        (7, 32, 135),
        (u32::MAX, 1, 135),
        (too_many, 0, 0),
    ];
    for (first, records, error) in rows {
        block.inputs.switches = TableOf::new(TableRef { first, records });
        block.call(&mut Context {
            now_ns: 0,
            scope: Scope::new(0, &mut log),
            axes: &mut axes,
            tables: &tables,
        });
        assert_eq!(block.outputs.error_id.number(), error, "{records} from {first}");
        let on = error == 0 && records > 0;
        assert_eq!(axes[0].order().outputs, u32::from(on), "{records} from {first}");
    }
}

/// Covers: T39h
#[test]
fn cams_switch_in_the_right_scan_at_every_speed() {
    let mut random = Random(5);
    let (mut judged, mut ons, mut open) = (0_u32, 0_u32, 0_u32);
    for case in 0..600 {
        // From a creep to 150 degrees a scan.
        let part = random.unit();
        let speed = 1.5e5 * (part * part) * (part * part) + 1.0;
        let velocity = if random.one_in(2) { speed } else { -speed };
        let modulo = random.one_in(2);
        let config = AxisConfig {
            start: StartState::Standstill,
            modulo: modulo.then_some(TURN),
            ..AxisConfig::new(LIMITS)
        };
        let id = AxisId::new(0);
        let mut axes = [Axis::new(id, config, Standard::new(CYCLE)).expect("a good configuration")];
        let mut log = Log::default();
        let (on, off) = (compensation(&mut random), compensation(&mut random));
        let (first, last) = if modulo {
            (TURN * random.unit(), TURN * random.unit())
        } else {
            // Somewhere on the path of the run.
            let (one, other) = (random.unit() * 100.0, random.unit() * 100.0);
            let way = velocity * CYCLE;
            ((one * way).min(other * way), (one * way).max(other * way))
        };
        let duration = Time((1 + random.bits() % 30) as i64 * CYCLE_NS);
        let cam = CamSwitch {
            track_number: 1,
            first_on: first,
            last_on: last,
            ..CamSwitch::default()
        };
        let timed = CamSwitch {
            track_number: 2,
            mode: 1,
            duration,
            ..cam
        };
        let option = TrackOption {
            on_compensation: on,
            off_compensation: off,
            hysteresis: 0.0,
        };
        let inputs = Inputs {
            axis: id,
            outputs: OutputRef(id),
            switches: TableOf::new(TableRef { first: 0, records: 2 }),
            track_options: TableOf::new(TableRef {
                first: u32::try_from(cells(&[cam, timed]).len()).expect("some numbers"),
                records: 2,
            }),
            enable: true,
            enable_mask: 3,
            ..Inputs::default()
        };
        let mut block = Instance::<McDigitalCamSwitch> {
            inputs,
            ..Instance::default()
        };
        let mut tables = cells(&[cam, timed]);
        tables.extend(cells(&[option, option]));
        let seconds = |time: Time| time.0 as f64 * 1e-9;
        let far = 4 + (speed * 0.3 / TURN) as i64;
        let judge = Judge {
            first,
            last: if modulo && first > last { last + TURN } else { last },
            velocity,
            on: seconds(on),
            off: seconds(off),
            turns: if modulo { -far..=far } else { 0..=0 },
            close: 1e-6 * (1.0 + speed * 0.2),
        };
        // The position at the beginning of the scan, without turns.
        let mut position = 0.0;
        for scan in 0..150 {
            let feedback = DriveFeedback {
                enabled: true,
                voltage: true,
                fault: None,
                position: DrivePosition::Units(0.0),
                comms: Comms::Ok,
                signals: DriveSignals::default(),
            };
            axes[0].follow_feedback(&feedback, &mut Scope::new(scan, &mut log));
            if scan == 0 {
                let command = Command::MoveVelocity {
                    dynamics: Dynamics::at(velocity),
                    direction: Direction::Unset.into(),
                };
                let request = Request::aborting(command);
                axes[0]
                    .command(&request, &mut Scope::new(scan, &mut log))
                    .expect("a motion");
            }
            let steady = axes[0].setpoint().velocity == velocity;
            block.call(&mut Context {
                now_ns: scan as i64 * CYCLE_NS,
                scope: Scope::new(scan, &mut log),
                axes: &mut axes,
                tables: &tables,
            });
            assert!(block.outputs.in_operation);
            let outputs = axes[0].order().outputs;
            // Looking ahead uses the present velocity, so it is exact from the second steady scan on.
            if steady && scan > 5 {
                let what = format!("case {case}, scan {scan}: {velocity} u/s, cam {first} to {last}");
                match judge.position_mode(position) {
                    Verdict::Open => open += 1,
                    Verdict::On => {
                        assert_eq!(outputs & 1, 1, "{what}: on");
                        (judged, ons) = (judged + 1, ons + 1);
                    }
                    Verdict::Off => {
                        assert_eq!(outputs & 1, 0, "{what}: off");
                        judged += 1;
                    }
                }
                // Edges before the steady part are not judged.
                let length = seconds(duration) - seconds(on) + seconds(off);
                if let Some(since) = judge
                    .since_met(position)
                    .filter(|since| *since < scan as f64 - 8.0)
                {
                    let scans = since.floor();
                    let whole = (since - since.round()).abs() < 1e-3 || (scans - length / CYCLE).abs() < 1e-3;
                    if !whole {
                        let expected = scans * CYCLE < length;
                        assert_eq!(outputs & 2 != 0, expected, "{what}: timed, met {since} scans ago");
                        judged += 1;
                    }
                }
            }
            let before = axes[0].setpoint();
            steps::advance(slice::from_mut(&mut axes[0]), &mut Scope::new(scan, &mut log));
            let after = axes[0].setpoint();
            let shown = after.position - before.position;
            // Of the distances that fit the positions, the one nearest to the prediction from the velocities.
            let expected = 0.5 * (before.velocity + after.velocity) * CYCLE;
            let turns = if modulo {
                ((expected - shown) / TURN).round()
            } else {
                0.0
            };
            position += shown + turns * TURN;
        }
    }
    println!("{judged} judged, {ons} of them on, {open} too near to an edge");
    assert!(judged > 50_000 && ons > 10_000 && open < judged / 10);
}

//! How soon a slave is on its law, compared with the least number of scans by linear programming.
//!
//! `lock_times.py` draws the cases and solves them; `lock_times.json` holds both. `least` is the number of the first
//! set-point on the law, counted from 1 in the scan of the command, for the best sequence of snaps that are each held
//! for a scan. A plan that switches between scans may need one less.

use super::rig::Rig;
use crate::standing;
use serde_json::{Value, json};
use standstill_axis::{Command, Direction, Dynamics, Limits, Setpoint, SyncPoint};

const MASTER: usize = 0;
const SLAVE: usize = 1;

/// A case that takes longer never ends.
const MOST_SCANS: u64 = 20_000;

/// Scans of the law that are written for the linear program.
const WRITTEN: usize = 400;

struct Case(Value);

/// The result of a case.
struct Run {
    /// The slave in the scan before the command.
    start: Setpoint,
    /// The law from that scan on: its position from the start of the slave, velocity, acceleration, jerk.
    law: Vec<[f64; 4]>,
    /// Scans until the slave was on it.
    took: u64,
}

impl Case {
    fn number(&self, key: &str) -> f64 {
        self.0[key]
            .as_f64()
            .unwrap_or_else(|| panic!("{key} of {}", self.0))
    }

    fn count(&self, key: &str) -> u64 {
        self.0[key]
            .as_u64()
            .unwrap_or_else(|| panic!("{key} of {}", self.0))
    }

    fn limits(&self, key: &str) -> Limits {
        let bound = |place: usize| self.0[key][place].as_f64().unwrap_or(f64::INFINITY);
        Limits {
            velocity: bound(0),
            acceleration: bound(1),
            deceleration: bound(1),
            jerk: bound(2),
            snap: bound(3),
        }
    }

    /// Runs the case on the axes.
    fn run(&self) -> Run {
        let cycle = self.number("cycle");
        let configs = ["master", "slave"].map(|key| standing::config(self.limits(key)));
        let mut rig = Rig::new(&configs, cycle);
        let ratio = (self.number("numerator") as i16, self.count("denominator") as u16);
        let factor = f64::from(ratio.0) / f64::from(ratio.1);
        // Each axis gets its velocity this number of scans before the slave is coupled.
        let leads = [("master", MASTER), ("slave", SLAVE)].map(|(key, axis)| {
            let lead = self.count(&format!("{key}_lead"));
            (axis, self.number(&format!("{key}_velocity")), lead)
        });
        let halt = self.count("master_halt");
        let longest = leads.iter().fold(halt, |most, (.., lead)| most.max(*lead)) + 1;
        for left in (1..=longest).rev() {
            for (axis, velocity, lead) in leads {
                if lead == left && velocity != 0.0 {
                    rig.command(axis, to_velocity(velocity)).expect("taken");
                }
            }
            if halt == left {
                let dynamics = Dynamics::default();
                rig.command(MASTER, Command::Halt { dynamics }).expect("taken");
            }
            rig.step();
        }
        let (master, start) = (rig.axes[MASTER].setpoint(), rig.axes[SLAVE].setpoint());
        let dynamics = Dynamics::at(self.number("velocity"));
        let offset = self.number("ahead");
        let sync = self.0["sync"].as_bool().expect("sync").then(|| SyncPoint {
            master: master.position,
            slave: start.position - offset,
            ..SyncPoint::default()
        });
        let gear = rig.gear(MASTER, ratio, sync, dynamics);
        rig.command(SLAVE, gear).expect("taken");
        // A master that is commanded in this scan has not moved yet when the slave is coupled.
        if leads[0].2 == 0 && leads[0].1 != 0.0 {
            rig.command(MASTER, to_velocity(leads[0].1)).expect("taken");
        }
        let law = |now: &Setpoint| {
            [
                factor * (now.position - master.position) - offset,
                factor * now.velocity,
                factor * now.acceleration,
                factor * now.jerk,
            ]
        };
        let (mut rows, mut took) = (vec![law(&master)], None);
        for scan in 1..MOST_SCANS {
            rig.step();
            if rows.len() <= WRITTEN {
                rows.push(law(&rig.axes[MASTER].setpoint()));
            }
            if took.is_none() && rig.axes[SLAVE].is_in_gear() {
                took = Some(scan);
            }
            if took.is_some() && rows.len() > WRITTEN {
                break;
            }
        }
        Run {
            start,
            law: rows,
            took: took.unwrap_or_else(|| panic!("never in gear: {}", self.0)),
        }
    }
}

fn to_velocity(velocity: f64) -> Command {
    Command::MoveVelocity {
        dynamics: Dynamics::at(velocity),
        direction: Direction::Unset.into(),
    }
}

fn cases(text: &str) -> Vec<Case> {
    let list: Vec<Value> = serde_json::from_str(text).expect("JSON");
    list.into_iter().map(Case).collect()
}

/// Covers: G54
#[test]
fn a_slave_is_on_its_law_within_a_scan_of_the_least() {
    let cases = cases(include_str!("lock_times.json"));
    let (mut even, mut ratios) = (0, Vec::new());
    for case in &cases {
        let (took, least) = (case.run().took, case.count("least"));
        let name = case.0["name"].as_str().expect("a name");
        if case.0["group"] == "accelerating" {
            ratios.push((took as f64 / least as f64, name));
        } else {
            even += 1;
            assert!(
                took.abs_diff(least) <= 1,
                "{name}: {took} scans, the least are {least}"
            );
        }
    }
    ratios.sort_by(|one, other| one.0.total_cmp(&other.0));
    let (middle, worst) = (ratios[ratios.len() / 2], ratios[ratios.len() - 1]);
    println!(
        "{even} cases with masters at rest or constant velocity within a scan of the least; {} with accelerating masters: \
         median {:.3} times the least, the worst {:.3} ({})",
        ratios.len(),
        middle.0,
        worst.0,
        worst.1
    );
    assert!(
        even >= 60 && ratios.len() >= 20,
        "{even} and {} cases",
        ratios.len()
    );
    assert!(middle.0 <= 1.1, "median {middle:?}");
}

/// For `lock_times.py`: runs the cases of the file STANDSTILL_CASES and writes the results to a file of the same name
/// with `.runs` at its end.
#[test]
#[ignore = "writes a file for lock_times.py"]
fn runs_for_the_linear_programme() {
    let path = std::env::var("STANDSTILL_CASES").expect("STANDSTILL_CASES");
    let text = std::fs::read_to_string(&path).expect("readable");
    let runs: Vec<Value> = cases(&text)
        .iter()
        .map(|case| {
            let Run { start, law, took } = case.run();
            let start = [start.velocity, start.acceleration, start.jerk];
            json!({"start": start, "law": law, "took": took})
        })
        .collect();
    let text = serde_json::to_string(&runs).expect("JSON");
    std::fs::write(format!("{path}.runs"), text).expect("written");
}

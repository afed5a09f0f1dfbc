//! A slave in gear is at the position that the law of its gear gives, row after row (G1, G11, G31).

use super::{Broken, rule};
use standstill_axis::{Axis, AxisId, CommandId, Standard};

/// A master in a row in which its slave is in gear.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Leg {
    gear: (AxisId, i32, u16),
    /// Its position (u).
    at: f64,
    /// The phase shift by which the slave sees it ahead (u of the master).
    phase: f64,
    turn: Option<f64>,
}

impl Leg {
    fn ratio(&self) -> f64 {
        let (_, numerator, denominator) = self.gear;
        f64::from(numerator) / f64::from(denominator)
    }

    /// The distance that the slave must have moved since the master was at `from`.
    fn way_since(&self, from: &Self) -> f64 {
        self.ratio() * (way(self.at, from.at, self.turn) + (self.phase - from.phase))
    }

    /// The largest number in the computation.
    fn size(&self) -> f64 {
        let own = self.at.abs() + self.phase.abs() + self.turn.unwrap_or(0.0);
        self.ratio().abs() * own
    }
}

/// Positions of one row in which a slave is in gear.
#[derive(Clone, Copy, Debug)]
struct Row {
    legs: [Option<Leg>; 2],
    command: Option<CommandId>,
    /// The superimposed distance (u).
    superimposed: f64,
    slave: f64,
}

impl Row {
    fn size(&self) -> f64 {
        self.slave.abs() + self.superimposed.abs() + self.legs.iter().flatten().map(Leg::size).sum::<f64>()
    }
}

/// The law of one slave.
#[derive(Clone, Copy, Debug, Default)]
pub struct Law {
    /// A row on it; on modulo axes the row before.
    anchor: Option<Row>,
}

/// A difference; on a modulo axis the shorter one.
fn way(to: f64, from: f64, turn: Option<f64>) -> f64 {
    let way = to - from;
    turn.map_or(way, |turn| way - turn * (way / turn).round())
}

impl Law {
    /// Positions are renamed from now on.
    pub fn forget(&mut self) {
        self.anchor = None;
    }

    /// Checks a row of the axis, whose masters are among `axes`.
    ///
    /// # Errors
    /// It is off the law by more than two roundings of every number in it.
    pub fn check(&mut self, axis: &Axis<Standard>, axes: &[Axis<Standard>]) -> Result<(), Broken> {
        // Its view of actual values is not published; a cam has its own tests.
        if !axis.is_in_gear() || axis.follows_actual() || axis.is_on_a_cam() {
            self.forget();
            return Ok(());
        }
        let phases = axis.phases();
        let legs = [0, 1].map(|leg: usize| {
            let gear = axis.gears()[leg]?;
            let master = axes.get(gear.0.index())?;
            Some(Leg {
                gear,
                at: master.setpoint().position,
                phase: phases[leg],
                turn: master.config().modulo,
            })
        });
        let row = Row {
            legs,
            command: axis.active_command(),
            superimposed: axis.coupled().map_or(0.0, |coupled| coupled.superimposed),
            slave: axis.setpoint().position,
        };
        let gears = |row: &Row| row.legs.map(|leg| leg.map(|leg| leg.gear));
        let is_same = |anchor: &Row| gears(anchor) == gears(&row) && anchor.command == row.command;
        let Some(anchor) = self.anchor.filter(is_same) else {
            self.anchor = Some(row);
            return Ok(());
        };
        let turn = axis.config().modulo;
        let ways = row.legs.iter().flatten().zip(anchor.legs.iter().flatten());
        let law: f64 = ways.map(|(now, then)| now.way_since(then)).sum();
        let added = row.superimposed - anchor.superimposed;
        let off = way(row.slave - anchor.slave, law + added, turn).abs();
        let rounding = 4.0 * f64::EPSILON * (row.size() + anchor.size() + turn.unwrap_or(0.0));
        if turn.is_some() || row.legs.iter().flatten().any(|leg| leg.turn.is_some()) {
            self.anchor = Some(row);
        }
        rule(
            off <= rounding,
            "G1",
            "a slave in gear is not where its law puts it",
        )
    }
}

//! A slave in gear is where the law of its gear puts it, row after row (G1, G11, G31).

use super::{Broken, rule};
use standstill_axis::{Axis, AxisId, CommandId, Standard};

/// Positions of one row in which a slave is in gear.
#[derive(Clone, Copy, Debug)]
struct Row {
    gear: (AxisId, i16, u16),
    command: Option<CommandId>,
    master: f64,
    /// By how much the slave sees its master ahead (u of the master).
    phase: f64,
    slave: f64,
}

/// The law of one slave.
#[derive(Clone, Copy, Debug, Default)]
pub struct Law {
    /// A row on it; on modulo axes the row before.
    anchor: Option<Row>,
}

/// A difference, on a modulo axis the shorter way.
fn way(to: f64, from: f64, turn: Option<f64>) -> f64 {
    let way = to - from;
    turn.map_or(way, |turn| way - turn * (way / turn).round())
}

impl Law {
    /// Positions have other names from now on.
    pub fn forget(&mut self) {
        self.anchor = None;
    }

    /// A row of the axis, whose masters are among `axes`.
    ///
    /// # Errors
    /// It is off the law by more than two roundings of every number that enters.
    pub fn check(&mut self, axis: &Axis<Standard>, axes: &[Axis<Standard>]) -> Result<(), Broken> {
        let gear = axis.gear().filter(|_| axis.is_in_gear());
        let master = gear.and_then(|(master, ..)| axes.get(master.index()));
        let (Some(gear), Some(master)) = (gear, master) else {
            self.forget();
            return Ok(());
        };
        let row = Row {
            gear,
            command: axis.active_command(),
            master: master.setpoint().position,
            phase: axis.phase(),
            slave: axis.setpoint().position,
        };
        let is_same = |anchor: &Row| anchor.gear == row.gear && anchor.command == row.command;
        let Some(anchor) = self.anchor.filter(is_same) else {
            self.anchor = Some(row);
            return Ok(());
        };
        let (turn, master_turn) = (axis.config().modulo, master.config().modulo);
        let (_, numerator, denominator) = gear;
        let ratio = f64::from(numerator) / f64::from(denominator);
        let seen = way(row.master, anchor.master, master_turn) + (row.phase - anchor.phase);
        let off = way(row.slave - anchor.slave, ratio * seen, turn).abs();
        let size = |row: &Row| row.slave.abs() + ratio.abs() * (row.master.abs() + row.phase.abs());
        let turns = turn.unwrap_or(0.0) + ratio.abs() * master_turn.unwrap_or(0.0);
        let rounding = 4.0 * f64::EPSILON * (size(&row) + size(&anchor) + turns);
        if turn.or(master_turn).is_some() {
            self.anchor = Some(row);
        }
        rule(
            off <= rounding,
            "G1",
            "a slave in gear is not where its law puts it",
        )
    }
}

//! Digital inputs, outputs and probes of a simulated drive.

use crate::nearest;
use crate::wire::Wire;
use standstill_axis::{DriveOrder, DrivePosition, DriveReport, Edge, PROBES, ProbeReport};

/// A probe's input and its latched position.
#[derive(Clone, Copy, Debug, Default)]
struct Probe {
    wire: Wire,
    ordered: Option<Edge>,
    latched: Option<DrivePosition>,
}

/// The peripherals of a simulated drive.
///
/// Between two feedbacks the position is taken as linear. A probe's edge within that interval latches the
/// position there; positions in increments are rounded to the nearest one.
#[derive(Clone, Copy, Debug, Default)]
pub struct Peripherals {
    inputs: u32,
    outputs: u32,
    probes: [Probe; PROBES],
    /// The position of the feedback before.
    before: Option<DrivePosition>,
    /// Length of a turn (u), for a drive that uses units and whose positions are modulo.
    turn: Option<f64>,
}

impl Peripherals {
    /// Peripherals of a drive. `turn` (u) is the modulo length of a drive that uses units, if it has one.
    pub fn new(turn: Option<f64>) -> Self {
        Self {
            turn,
            ..Self::default()
        }
    }

    /// Renames positions in units: each is `by` (u) more from now on.
    pub fn shift(&mut self, by: f64) {
        if let Some(DrivePosition::Units(before)) = &mut self.before {
            *before += by;
        }
    }

    /// Sets the digital input `number`. Inputs from [`standstill_axis::DIGITAL`] on do not exist.
    pub fn set_input(&mut self, number: u32, level: bool) {
        if let Some(bit) = 1_u32.checked_shl(number) {
            self.inputs = if level {
                self.inputs | bit
            } else {
                self.inputs & !bit
            };
        }
    }

    /// Sets the input of probe `number`, counted from 0, to `level`. The change is at the part `at` (0 to
    /// 1) of the interval that ends with the next feedback. Up to four changes in one interval are kept.
    pub fn set_probe(&mut self, number: usize, at: f64, level: bool) {
        if let Some(probe) = self.probes.get_mut(number) {
            probe.wire.set(at, level);
        }
    }

    /// Takes the position (as fed back in this scan) and fills in the report.
    pub fn report(&mut self, position: DrivePosition, report: &mut DriveReport) {
        let before = self.before.replace(position).unwrap_or(position);
        for (probe, told) in self.probes.iter_mut().zip(&mut report.probes) {
            let (ordered, latched) = (probe.ordered, &mut probe.latched);
            probe.wire.take(|at, edge| {
                if Some(edge) == ordered && latched.is_none() {
                    *latched = Some(between(before, position, at, self.turn));
                }
            });
            *told = ProbeReport {
                armed: probe.ordered.is_some(),
                latched: probe.latched,
            };
        }
        (report.inputs, report.outputs) = (self.inputs, self.outputs);
    }

    /// Takes the orders for the drive.
    pub fn order(&mut self, order: &DriveOrder) {
        self.outputs = order.outputs;
        for (probe, edge) in self.probes.iter_mut().zip(order.probes) {
            // A probe starts afresh when it is armed for another edge, or armed again after it was
            // disarmed.
            if probe.ordered != edge {
                probe.latched = None;
            }
            probe.ordered = edge;
        }
    }
}

/// The position at a part of the distance between two positions. Modulo positions take the shorter direction.
// If this were inlined, its products would be computed ahead in every scan, even without a turn. The values are
// then garbage and mostly denormal, which takes a processor a hundred times as long.
#[cold]
#[inline(never)]
fn between(from: DrivePosition, to: DrivePosition, part: f64, turn: Option<f64>) -> DrivePosition {
    match (from, to) {
        (DrivePosition::Units(from), DrivePosition::Units(to)) => {
            let way = match turn {
                Some(turn) if to - from > 0.5 * turn => to - from - turn,
                Some(turn) if to - from < -0.5 * turn => to - from + turn,
                _ => to - from,
            };
            DrivePosition::Units(from + part * way)
        }
        (DrivePosition::Increments(from), DrivePosition::Increments(to)) => {
            let exact = part * to.saturating_sub(from) as f64;
            DrivePosition::Increments(from.saturating_add(nearest(exact)))
        }
        // A drive does not change its kind of position.
        (_, to) => to,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use DrivePosition::{Increments, Units};

    fn armed(edge: Option<Edge>) -> DriveOrder {
        DriveOrder {
            probes: [edge, None],
            ..DriveOrder::default()
        }
    }

    #[test]
    fn the_first_edge_of_the_right_kind_is_latched_where_it_was() {
        let mut device = Peripherals::default();
        let mut report = DriveReport::default();
        device.report(Units(10.0), &mut report);
        device.order(&armed(Some(Edge::Rising)));
        // Rising at a quarter of the distance from 10 to 14.
        device.set_probe(0, 0.25, true);
        device.report(Units(14.0), &mut report);
        let seen = ProbeReport {
            armed: true,
            latched: Some(Units(11.0)),
        };
        assert_eq!(report.probes, [seen, ProbeReport::default()]);
        // Later edges do not count until it is armed again.
        for (level, position) in [(false, 15.0), (true, 16.0)] {
            device.set_probe(0, 0.5, level);
            device.report(Units(position), &mut report);
            assert_eq!(report.probes[0], seen);
        }
        device.order(&armed(None));
        device.report(Units(17.0), &mut report);
        assert_eq!(report.probes[0], ProbeReport::default());
        device.order(&armed(Some(Edge::Falling)));
        device.set_probe(0, 1.0, false);
        device.report(Units(19.0), &mut report);
        assert_eq!(report.probes[0].latched, Some(Units(19.0)));
    }

    #[test]
    fn increments_are_latched_to_the_nearest() {
        for (from, to, part, expected) in [(0, 10, 0.26, 3), (0, -10, 0.26, -3), (-5, 5, 0.5, 0)] {
            assert_eq!(
                between(Increments(from), Increments(to), part, None),
                Increments(expected)
            );
        }
    }

    #[test]
    fn units_that_come_round_are_latched_on_the_shorter_way() {
        for (from, to, expected) in [(358.0, 2.0, 361.0), (2.0, 358.0, -1.0), (10.0, 14.0, 13.0)] {
            let seen = between(Units(from), Units(to), 0.75, Some(360.0));
            assert_eq!(seen, Units(expected), "the axis brings it into the turn");
        }
    }

    #[test]
    fn a_new_name_is_no_way() {
        let mut device = Peripherals::default();
        let mut report = DriveReport::default();
        device.report(Units(10.0), &mut report);
        device.order(&armed(Some(Edge::Rising)));
        device.shift(-10.0);
        device.set_probe(0, 0.5, true);
        device.report(Units(2.0), &mut report);
        assert_eq!(report.probes[0].latched, Some(Units(1.0)));
    }

    #[test]
    fn inputs_are_set_and_outputs_shown() {
        let mut device = Peripherals::default();
        let mut report = DriveReport::default();
        device.set_input(31, true);
        device.set_input(2, true);
        device.set_input(2, false);
        device.set_input(32, true);
        device.order(&DriveOrder {
            outputs: 5,
            ..DriveOrder::default()
        });
        device.report(Units(0.0), &mut report);
        assert_eq!((report.inputs, report.outputs), (1 << 31, 5));
    }
}

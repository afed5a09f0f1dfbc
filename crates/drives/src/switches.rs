//! Switches and reference pulses along the travel of a simulated drive.

use standstill_axis::{
    DriveFeedback, DriveOrder, DrivePosition, DriveReport, DriveSignals, Equipment, ProbeReport, Scaling,
    split,
};

/// The places of an encoder's reference pulses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Marker {
    /// One of the places (u).
    pub at: f64,
    /// Distance from one to the next (u), above 0; `None` if there is only one.
    pub every: Option<f64>,
}

/// The switches and pulses along the travel. Their places (u) keep their values when the axis renames its
/// positions.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Switches {
    /// The limit switches are active below the first place and above the second (u); the places are included.
    pub limits: Option<(f64, f64)>,
    /// The home switch is active from the first to the second (u).
    pub home: Option<(f64, f64)>,
    /// Reference pulses.
    pub marker: Option<Marker>,
    /// Length of a turn (u) of a modulo axis.
    pub turn: Option<f64>,
}

impl Switches {
    /// Nothing along the travel.
    pub const NONE: Self = Self {
        limits: None,
        home: None,
        marker: None,
        turn: None,
    };

    /// The available equipment.
    pub fn equipment(&self) -> Equipment {
        Equipment {
            home_switch: self.home.is_some(),
            limit_switches: self.limits.is_some(),
            marker: self.marker.is_some(),
            homing: false,
        }
    }

    /// Sets the available switches for a drive at `place` (u).
    pub fn show(&self, place: f64, signals: &mut DriveSignals) {
        let place = self.turn.map_or(place, |turn| split(place, turn).1);
        if let Some((low, high)) = self.limits {
            signals.limit_switch_negative = place <= low;
            signals.limit_switch_positive = place >= high;
        }
        if let Some((from, to)) = self.home {
            signals.home_switch = (from..=to).contains(&place);
        }
    }

    /// The first reference pulse between one place (u), which is excluded, and another (u).
    pub fn pulse_between(&self, from: f64, to: f64) -> Option<f64> {
        let Marker { at, every } = self.marker?;
        let is_between = |place: f64| (from < place && place <= to) || (to <= place && place < from);
        // On a modulo axis a single pulse repeats once per turn.
        let Some(every) = every.or(self.turn) else {
            return is_between(at).then_some(at);
        };
        let (count, _) = split(from - at, every);
        let near = count as f64;
        let candidates = if from < to {
            [near, near + 1.0]
        } else {
            [near, near - 1.0]
        };
        candidates
            .into_iter()
            .map(|count| at + count * every)
            .find(|place| is_between(*place))
    }
}

/// The travel of a simulated drive: its place, the switches there, and the latch of the reference pulse.
#[derive(Clone, Copy, Debug)]
pub struct Travel {
    switches: Switches,
    /// Of a drive that counts increments.
    scaling: Option<Scaling>,
    /// The offset of positions in units from their places (u).
    renamed: f64,
    /// Increments that the drive has dropped from its count.
    origin: i64,
    /// Places at the last two feedbacks (u).
    places: Option<[f64; 2]>,
    ordered: bool,
    latched: Option<DrivePosition>,
}

impl Travel {
    /// Along `switches`, for a drive with the `scaling` of its axis.
    pub fn new(switches: Switches, scaling: Option<Scaling>) -> Self {
        Self {
            switches,
            scaling,
            renamed: 0.0,
            origin: 0,
            places: None,
            ordered: false,
            latched: None,
        }
    }

    /// Renames positions in units: each is `by` (u) more from now on.
    pub fn shift(&mut self, by: f64) {
        self.renamed += by;
    }

    /// From now on the count of increments is `origin` less than at the start.
    pub fn drop_increments(&mut self, origin: i64) {
        self.origin = origin;
    }

    /// Takes the position and sets the existing switches.
    pub fn read(&mut self, feedback: &mut DriveFeedback) {
        let place = match (feedback.position, &self.scaling) {
            (DrivePosition::Units(units), _) => units - self.renamed,
            (DrivePosition::Increments(increments), Some(scaling)) => {
                scaling.to_units(increments.saturating_add(self.origin))
            }
            (DrivePosition::Increments(increments), None) => increments as f64,
        };
        let before = self.places.map_or(place, |[_, before]| before);
        self.places = Some([before, place]);
        let signals = &mut feedback.signals;
        self.switches.show(place, signals);
        let counts_down = self.scaling.is_some_and(|scaling| scaling.invert());
        if counts_down && self.switches.limits.is_some() {
            // A drive reports positions in its own count.
            (signals.limit_switch_negative, signals.limit_switch_positive) =
                (signals.limit_switch_positive, signals.limit_switch_negative);
        }
    }

    /// Fills in the report: the equipment, and the latched pulse between the last two feedbacks.
    pub fn report(&mut self, report: &mut DriveReport) {
        if let (true, None, Some([from, to])) = (self.ordered, self.latched, self.places) {
            self.latched = self.pulse_between(from, to);
        }
        report.marker = ProbeReport {
            armed: self.ordered,
            latched: self.latched,
        };
        let has = self.switches.equipment();
        report.equipment.marker = has.marker;
        report.equipment.home_switch |= has.home_switch;
        report.equipment.limit_switches |= has.limit_switches;
    }

    /// Takes the command for the drive.
    pub fn order(&mut self, order: &DriveOrder) {
        // The latch starts afresh when it is armed.
        if !self.ordered {
            self.latched = None;
        }
        self.ordered = order.marker;
    }

    fn pulse_between(&self, from: f64, to: f64) -> Option<DrivePosition> {
        // On a modulo axis the shorter direction is taken.
        let from = match self.switches.turn {
            Some(turn) if to - from > 0.5 * turn => from + turn,
            Some(turn) if from - to > 0.5 * turn => from - turn,
            _ => from,
        };
        let place = self.switches.pulse_between(from, to)?;
        Some(match &self.scaling {
            None => DrivePosition::Units(place + self.renamed),
            Some(scaling) => {
                DrivePosition::Increments(scaling.to_increments(place).saturating_sub(self.origin))
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_pulse_on_the_way_is_found() {
        let every = |every| Switches {
            marker: Some(Marker { at: 1.0, every }),
            ..Switches::default()
        };
        let periodic = every(Some(10.0));
        for (from, to, expected) in [
            (0.0, 0.5, None),
            (0.0, 1.0, Some(1.0)),
            (1.0, 2.0, None),
            (0.0, 30.0, Some(1.0)),
            (2.0, 0.0, Some(1.0)),
            (1.0, -8.0, None),
            (1.0, -9.0, Some(-9.0)),
            (-9.5, -8.5, Some(-9.0)),
            (12.0, 10.0, Some(11.0)),
            (11.0, 11.0, None),
        ] {
            assert_eq!(periodic.pulse_between(from, to), expected, "{from} to {to}");
        }
        assert_eq!(every(None).pulse_between(2.0, 30.0), None);
        assert_eq!(every(None).pulse_between(30.0, 0.0), Some(1.0));
        assert_eq!(Switches::default().pulse_between(0.0, 9.0), None);
    }

    #[test]
    fn switches_show_where_they_are_and_come_round() {
        let mut signals = DriveSignals::default();
        let switches = Switches {
            limits: Some((-5.0, 400.0)),
            home: Some((350.0, 359.0)),
            marker: None,
            turn: Some(360.0),
        };
        switches.show(-5.0, &mut signals);
        assert!(signals.home_switch && !signals.limit_switch_negative);
        let linear = Switches {
            turn: None,
            ..switches
        };
        linear.show(-5.0, &mut signals);
        assert!(!signals.home_switch && signals.limit_switch_negative);
        linear.show(400.0, &mut signals);
        assert!(signals.limit_switch_positive && !signals.limit_switch_negative);
    }
}

//! The drive of an axis.

use super::json::{Json, Node};
use super::value::Fields;
use super::{Reader, shape};
use crate::error::{Code, Diagnostic};
use crate::model::{Cia402Setup, DriveSetup, IdealDriveSetup, MotorSetup, PlantSetup};
use standstill_axis::DELAY_MAX;
use standstill_drives::cia402::Reaction;
use standstill_drives::mechanism::{Gains, Load, Mechanism, Plant, Servo, Stops};
use standstill_drives::switches::{Marker, Switches};

/// How a CiA 402 drive comes to rest by itself; `stay` is for the quick stop only.
pub(crate) const REACTIONS: [(&str, Reaction); 3] = [
    ("coast", Reaction::Coast),
    ("ramp", Reaction::Ramp),
    ("stay", Reaction::RampAndStay),
];

/// Largest torque by the rated one where none is given.
const MAX_TORQUE: f64 = 3.0;

pub(crate) const NODE_DIRECTIONS: [(&str, bool); 2] = [("positive", true), ("negative", false)];

impl Reader {
    /// The drive of an axis with a scaling, or without.
    pub(super) fn drive(&mut self, axis: &Fields<'_>, is_scaled: bool) -> Option<DriveSetup> {
        let Some(node) = axis.get("drive") else {
            return Some(DriveSetup::default());
        };
        let fields = self.fields(node, &shape::DRIVE)?;
        let mut kinds = fields
            .iter()
            .filter(|(key, _)| matches!(key.text.as_str(), "ideal" | "cia402" | "plant"));
        let Some((key, node)) = kinds.next() else {
            return Some(DriveSetup::default());
        };
        if let Some((second, _)) = kinds.next() {
            let message = format!("an axis has one drive, `{}` or `{}`", key.text, second.text);
            self.report(Diagnostic::new(Code::BadValue, second.span, message));
            return None;
        }
        match key.text.as_str() {
            "ideal" => self.ideal(node).map(DriveSetup::Ideal),
            "plant" => self.plant(node).map(DriveSetup::Plant),
            _ if !is_scaled => {
                let message = "a CiA 402 drive counts increments, so its axis needs `scaling`";
                self.report(
                    Diagnostic::new(Code::MissingKey, key.span, message)
                        .help("for example \"scaling\": {\"increments\": 10000, \"units\": 1}"),
                );
                None
            }
            _ => self.cia402(node).map(DriveSetup::Cia402),
        }
    }

    fn plant(&mut self, node: &Node) -> Option<PlantSetup> {
        let fields = self.fields(node, &shape::PLANT)?;
        let power_on = self.power_on(&fields);
        let inertia = self
            .require(&fields, "inertia", "a plant")
            .and_then(|node| self.finite(node, "`inertia`"));
        let viscous = self.optional(&fields, "viscous", "`viscous`");
        let coulomb = self.optional(&fields, "coulomb", "`coulomb`");
        let torque = self.optional(&fields, "torque", "`torque`");
        let load = fields
            .get("load")
            .map_or(Some(None), |node| self.load(node).map(Some));
        let stops = fields
            .get("stops")
            .map_or(Some(None), |node| self.stops(node).map(Some));
        let switches = self.switches(&fields);
        let plant = Plant {
            inertia: inertia?,
            viscous: viscous?.unwrap_or(0.0),
            coulomb: coulomb?.unwrap_or(0.0),
            load: load?,
        };
        let cycle = self.cycle_ns? as f64 / 1e9;
        let mut gains = Gains::of(&plant, cycle);
        if let Some(limit) = torque? {
            gains.torque = limit;
        }
        if let Some(node) = fields.get("gains") {
            self.gains(node, &mut gains)?;
        }
        // What is wrong with it shows when it is made.
        let stops = stops?;
        let made = Mechanism::new(plant, 0.0, cycle)
            .and_then(|made| stops.map_or(Ok(made), |stops| made.between(stops, cycle)))
            .and_then(|made| Servo::new(made, gains, cycle));
        if let Err(error) = made {
            self.report(Diagnostic::new(Code::BadValue, fields.brace(), error.to_string()));
            return None;
        }
        Some(PlantSetup {
            power_on: power_on?,
            plant,
            stops,
            gains,
            switches: switches?,
        })
    }

    fn load(&mut self, node: &Node) -> Option<Load> {
        let fields = self.fields(node, &shape::LOAD)?;
        let mut needed = |key: &str| {
            let node = self.require(&fields, key, "the load of a plant")?;
            self.finite(node, &format!("`{key}`"))
        };
        let (inertia, stiffness) = (needed("inertia"), needed("stiffness"));
        let damping = self.optional(&fields, "damping", "`damping`");
        Some(Load {
            inertia: inertia?,
            stiffness: stiffness?,
            damping: damping?.unwrap_or(0.0),
        })
    }

    fn stops(&mut self, node: &Node) -> Option<Stops> {
        let fields = self.fields(node, &shape::STOPS)?;
        let mut needed = |key: &str| {
            let node = self.require(&fields, key, "`stops`")?;
            self.finite(node, &format!("`stops.{key}`"))
        };
        let (low, high, stiffness) = (needed("negative"), needed("positive"), needed("stiffness"));
        let damping = self.optional(&fields, "damping", "`stops.damping`");
        Some(Stops {
            ends: (low?, high?),
            stiffness: stiffness?,
            damping: damping?.unwrap_or(0.0),
        })
    }

    fn gains(&mut self, node: &Node, gains: &mut Gains) -> Option<()> {
        let fields = self.fields(node, &shape::GAINS)?;
        let mut good = Some(());
        for (key, gain) in [
            ("position", &mut gains.position),
            ("velocity", &mut gains.velocity),
            ("integral", &mut gains.integral),
            ("feed_velocity", &mut gains.feed_velocity),
            ("feed_acceleration", &mut gains.feed_acceleration),
        ] {
            match self.optional(&fields, key, &format!("`{key}`")) {
                Some(Some(value)) => *gain = value,
                Some(None) => {}
                None => good = None,
            }
        }
        good
    }

    fn ideal(&mut self, node: &Node) -> Option<IdealDriveSetup> {
        let fields = self.fields(node, &shape::IDEAL)?;
        let delay = self.delay(&fields, "the ideal drive");
        let power_on = self.power_on(&fields);
        let switches = self.switches(&fields);
        Some(IdealDriveSetup {
            delay: delay?,
            power_on: power_on?,
            switches: switches?,
        })
    }

    fn cia402(&mut self, node: &Node) -> Option<Cia402Setup> {
        let fields = self.fields(node, &shape::CIA402)?;
        let delay = self.delay(&fields, "the drive");
        let power_on = self.power_on(&fields);
        let start_up = fields.get("start_up").map_or(Some(0), |node| {
            Some(u32::try_from(self.scans(node, "`start_up`")?).unwrap_or(u32::MAX))
        });
        let deceleration = self.optional(&fields, "deceleration", "`deceleration`");
        let mut reaction = |key: &str, words: &[(&str, Reaction)], otherwise| {
            fields.get(key).map_or(Some(otherwise), |node| {
                self.choice(node, &format!("`{key}`"), words)
            })
        };
        let quick_stop = reaction("quick_stop", &REACTIONS, Reaction::Ramp);
        let [coast, ramp, _] = REACTIONS;
        let on_disable = reaction("on_disable", &[coast, ramp], Reaction::Coast);
        let on_fault = reaction("on_fault", &[coast, ramp], Reaction::Ramp);
        let homing = fields
            .get("homing")
            .map_or(Some(None), |node| self.node_homing(node).map(Some));
        let motor = fields
            .get("motor")
            .map_or(Some(None), |node| self.motor(node).map(Some));
        let switches = self.switches(&fields);
        Some(Cia402Setup {
            delay: delay?,
            power_on: power_on?,
            start_up: start_up?,
            deceleration: deceleration?,
            quick_stop: quick_stop?,
            on_disable: on_disable?,
            on_fault: on_fault?,
            homing: homing?,
            motor: motor?,
            switches: switches?,
        })
    }

    fn motor(&mut self, node: &Node) -> Option<MotorSetup> {
        let fields = self.fields(node, &shape::MOTOR)?;
        let mut needed = |key: &str| {
            let node = self.require(&fields, key, "the motor of a drive")?;
            self.finite(node, &format!("`motor.{key}`"))
        };
        let (rated, inertia) = (needed("rated_torque"), needed("inertia"));
        let mut optional = |key: &str| self.optional(&fields, key, &format!("`motor.{key}`"));
        let (most, viscous, coulomb) = (optional("max_torque"), optional("viscous"), optional("coulomb"));
        let rated_torque = rated?;
        let motor = MotorSetup {
            rated_torque,
            max_torque: most?.unwrap_or(MAX_TORQUE * rated_torque),
            inertia: inertia?,
            viscous: viscous?.unwrap_or(0.0),
            coulomb: coulomb?.unwrap_or(0.0),
        };
        // A thousandth of the rated torque is the smallest the bus can say, 32767 the most.
        let range = 0.001 * rated_torque..=f64::from(i16::MAX) / 1000.0 * rated_torque;
        let rows = [
            (
                "rated_torque",
                motor.rated_torque,
                motor.rated_torque > 0.0,
                "above 0",
            ),
            ("inertia", motor.inertia, motor.inertia > 0.0, "above 0"),
            ("viscous", motor.viscous, motor.viscous >= 0.0, "from 0"),
            ("coulomb", motor.coulomb, motor.coulomb >= 0.0, "from 0"),
            (
                "max_torque",
                motor.max_torque,
                range.contains(&motor.max_torque),
                "from a thousandth of `rated_torque` to 32.767 times as much",
            ),
        ];
        if let Some((key, value, _, wanted)) = rows.into_iter().find(|(_, _, good, _)| !good) {
            let message = format!("`motor.{key}` is {value:?}: it must be {wanted}");
            self.report(Diagnostic::new(Code::BadValue, fields.brace(), message));
            return None;
        }
        Some(motor)
    }

    fn node_homing(&mut self, node: &Node) -> Option<(bool, f64)> {
        let fields = self.fields(node, &shape::NODE_HOMING)?;
        let up = fields.get("direction").map_or(Some(true), |node| {
            self.choice(node, "`homing.direction`", &NODE_DIRECTIONS)
        });
        let velocity = self
            .require(&fields, "velocity", "`homing` of a drive")
            .and_then(|node| self.finite(node, "`homing.velocity`"));
        let (up, velocity) = (up?, velocity?);
        if velocity <= 0.0 {
            let message = format!("`homing.velocity` is {velocity:?}: it must be above 0");
            self.report(Diagnostic::new(Code::BadValue, fields.brace(), message));
            return None;
        }
        Some((up, velocity))
    }

    /// What stands along the travel of any drive.
    fn switches(&mut self, fields: &Fields<'_>) -> Option<Switches> {
        let limits = self.pair(fields, "limit_switches", ["negative", "positive"]);
        let home = self.pair(fields, "home_switch", ["from", "to"]);
        let marker = fields
            .get("marker")
            .map_or(Some(None), |node| self.marker(node).map(Some));
        Some(Switches {
            limits: limits?,
            home: home?,
            marker: marker?,
            turn: None,
        })
    }

    fn marker(&mut self, node: &Node) -> Option<Marker> {
        let fields = self.fields(node, &shape::MARKER)?;
        let at = self
            .require(&fields, "at", "`marker`")
            .and_then(|node| self.finite(node, "`marker.at`"));
        let every = self.optional(&fields, "every", "`marker.every`");
        let (at, every) = (at?, every?);
        if let Some(every) = every.filter(|every| *every <= 0.0) {
            let message = format!("`marker.every` is {every:?}: the distance of two pulses is above 0");
            self.report(Diagnostic::new(Code::BadValue, fields.brace(), message));
            return None;
        }
        Some(Marker { at, every })
    }

    fn delay(&mut self, fields: &Fields<'_>, what: &str) -> Option<usize> {
        let Some(node) = fields.get("delay") else {
            return Some(0);
        };
        let delay = self.scans(node, "`delay`")?;
        usize::try_from(delay)
            .ok()
            .filter(|delay| *delay <= DELAY_MAX)
            .or_else(|| {
                let message = format!("{what} delays by {DELAY_MAX} scans at most, not {delay}");
                self.report(Diagnostic::new(Code::BadValue, node.span, message));
                None
            })
    }

    fn power_on(&mut self, fields: &Fields<'_>) -> Option<Option<u32>> {
        match fields.get("power_on") {
            None => Some(Some(0)),
            Some(node) if matches!(node.json, Json::Null) => Some(None),
            Some(node) => {
                let scans = self.scans(node, "`power_on`")?;
                Some(Some(u32::try_from(scans).unwrap_or(u32::MAX)))
            }
        }
    }

    /// Two positions (u), the first not above the second.
    fn pair(&mut self, fields: &Fields<'_>, key: &str, ends: [&str; 2]) -> Option<Option<(f64, f64)>> {
        let Some(node) = fields.get(key) else {
            return Some(None);
        };
        let shape = if key == "home_switch" {
            &shape::HOME_SWITCH
        } else {
            &shape::LIMIT_SWITCHES
        };
        let fields = self.fields(node, shape)?;
        let mut end = |name: &str| {
            let node = self.require(&fields, name, &format!("`{key}`"))?;
            self.finite(node, &format!("`{key}.{name}`"))
        };
        let (first, second) = (end(ends[0]), end(ends[1]));
        let (first, second) = (first?, second?);
        if first > second {
            let message = format!(
                "`{key}.{}` is {first:?}, above `{}`, {second:?}",
                ends[0], ends[1]
            );
            self.report(
                Diagnostic::new(Code::BadValue, fields.brace(), message).help("swap the two positions"),
            );
            return None;
        }
        Some(Some((first, second)))
    }
}

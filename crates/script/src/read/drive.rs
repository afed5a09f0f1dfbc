//! The drive of an axis.

use super::json::{Json, Node};
use super::value::{Fields, wrong_type};
use super::{Reader, shape};
use crate::error::{Code, Diagnostic};
use crate::model::{Cia402Setup, DriveSetup, IdealDriveSetup, PlantSetup};
use standstill_axis::keys::Object;
use standstill_drives::keys;
use standstill_drives::mechanism::{Mechanism, Servo};
use standstill_drives::switches::Switches;

/// The kinds of drives, by their keys.
#[derive(Clone, Copy, Debug)]
pub(crate) enum DriveKind {
    Ideal,
    Cia402,
    Plant,
}

impl DriveKind {
    pub(crate) const ALL: [(&str, Self); 3] = [
        ("ideal", Self::Ideal),
        ("cia402", Self::Cia402),
        ("plant", Self::Plant),
    ];
}

impl Reader {
    /// The drive of an axis with a scaling, or without.
    pub(super) fn drive(&mut self, axis: &Fields<'_>, is_scaled: bool) -> Option<DriveSetup> {
        let Some(node) = axis.get("drive") else {
            return Some(DriveSetup::default());
        };
        if let Json::Text(name) = &node.json
            && DriveKind::ALL.iter().any(|(known, _)| known == name)
        {
            let help = format!("write \"drive\": {{{name:?}: {{}}}}");
            return self.refuse(wrong_type(node, "`drive`", "an object").help(help));
        }
        let fields = self.fields(node, &shape::DRIVE)?;
        let mut kinds = fields.iter().filter_map(|(key, node)| {
            let (_, kind) = DriveKind::ALL.iter().find(|(name, _)| *name == key.text)?;
            Some((*kind, key, node))
        });
        let Some((kind, key, node)) = kinds.next() else {
            return Some(DriveSetup::default());
        };
        if let Some((_, second, _)) = kinds.next() {
            let message = format!("an axis has one drive, `{}` or `{}`", key.text, second.text);
            return self.refuse(Diagnostic::new(Code::BadValue, second.span, message));
        }
        match kind {
            DriveKind::Ideal => self.ideal(node).map(DriveSetup::Ideal),
            DriveKind::Plant => self.plant(node).map(DriveSetup::Plant),
            DriveKind::Cia402 if !is_scaled => {
                let message = "a CiA 402 drive counts increments, so its axis needs `scaling`";
                self.refuse(
                    Diagnostic::new(Code::MissingKey, key.span, message)
                        .help("for example \"scaling\": {\"increments\": 10000, \"units\": 1}"),
                )
            }
            DriveKind::Cia402 => self.cia402(node).map(DriveSetup::Cia402),
        }
    }

    /// A drive by its table, every value in its range.
    fn simulated<'n, T>(
        &mut self,
        node: &'n Node,
        object: &Object<T>,
        plain: T,
        switches: impl FnOnce(&T) -> Switches,
    ) -> Option<(T, Fields<'n>)> {
        let mut setup = plain;
        let fields = self.keys(node, object, &[], &mut setup)?;
        self.in_range(&fields, object, &setup)?;
        self.check_switches(&fields, &switches(&setup))?;
        Some((setup, fields))
    }

    fn ideal(&mut self, node: &Node) -> Option<IdealDriveSetup> {
        let plain = IdealDriveSetup::PLAIN;
        let (setup, _) = self.simulated(node, &keys::IDEAL, plain, |setup| setup.switches)?;
        Some(setup)
    }

    fn plant(&mut self, node: &Node) -> Option<PlantSetup> {
        let (setup, fields) = self.simulated(node, &keys::PLANT, PlantSetup::NONE, |setup| setup.switches)?;
        let cycle = self.cycle_ns? as f64 / 1e9;
        let setup = setup.with_gains(cycle);
        // Its faults show when it is created.
        let made = Mechanism::new(setup.plant, 0.0, cycle)
            .and_then(|made| setup.stops.map_or(Ok(made), |stops| made.between(stops, cycle)))
            .and_then(|made| Servo::new(made, setup.gains, cycle));
        if let Err(error) = made {
            return self.refuse(Diagnostic::new(Code::BadValue, fields.brace(), error.to_string()));
        }
        Some(setup)
    }

    fn cia402(&mut self, node: &Node) -> Option<Cia402Setup> {
        let (setup, fields) =
            self.simulated(node, &keys::CIA402, Cia402Setup::PLAIN, |setup| setup.switches)?;
        let Some(motor) = setup.motor else {
            return Some(setup);
        };
        // The smallest value on the bus is a thousandth of the rated torque, the largest 32767 of them.
        let range = 0.001 * motor.rated_torque..=f64::from(i16::MAX) / 1000.0 * motor.rated_torque;
        if range.contains(&motor.max_torque) {
            return Some(setup);
        }
        let span = fields.get("motor").map_or(fields.brace(), |node| node.span);
        let message = format!(
            "`motor.max_torque` is {:?}: it must be from a thousandth of `rated_torque` to 32.767 times as much",
            motor.max_torque
        );
        self.refuse(Diagnostic::new(Code::BadValue, span, message))
    }

    /// The first of two places must not be above the second.
    fn check_switches(&mut self, fields: &Fields<'_>, switches: &Switches) -> Option<()> {
        let pairs = [
            ("limit_switches", ["negative", "positive"], switches.limits),
            ("home_switch", ["from", "to"], switches.home),
        ];
        let mut good = Some(());
        for (key, ends, pair) in pairs {
            let Some((first, second)) = pair.filter(|(first, second)| first > second) else {
                continue;
            };
            let span = fields.get(key).map_or(fields.brace(), |node| node.span);
            let message = format!(
                "`{key}.{}` is {first:?}, above `{}`, {second:?}",
                ends[0], ends[1]
            );
            self.report(Diagnostic::new(Code::BadValue, span, message).help("swap the two positions"));
            good = None;
        }
        good
    }
}

//! Steps: their time and their effect.

use super::json::{Key, Node};
use super::value::Fields;
use super::{Reader, is_note, shape};
use crate::error::{Code, Diagnostic, quoted};
use crate::model::{Action, DriveChange, DriveSetup, FaultKind, Point, Span, Step, When};
use standstill_axis::{DIGITAL, DrivePosition, PROBES};
use std::collections::BTreeMap;

pub(crate) const FAULT_KINDS: [(&str, FaultKind); 4] = [
    ("drive", FaultKind::Drive),
    ("power", FaultKind::Power),
    ("communication", FaultKind::Communication),
    ("axis", FaultKind::Axis),
];

impl Reader {
    pub(super) fn steps(&mut self, fields: &Fields<'_>) -> Option<Vec<Step>> {
        let Some(node) = fields.get("steps") else {
            return Some(Vec::new());
        };
        let items = self.list(node, "`steps`")?;
        self.each(items, Self::step)
    }

    fn step(&mut self, node: &Node) -> Option<Step> {
        let fields = self.fields(node, &shape::STEP)?;
        let when = self.when(&fields);
        let mut news = Vec::new();
        for (key, value) in fields.iter() {
            news.push(match key.text.as_str() {
                "set" => self.set(value),
                "fault" => self.fault(value).map(|action| vec![action]),
                "clear" => self.clear(value).map(|action| vec![action]),
                "drive" => self.drive_step(value),
                _ => continue,
            });
        }
        let actions = news.into_iter().collect::<Option<Vec<_>>>()?.concat();
        if actions.is_empty() {
            let message = "a step does nothing without `set`, `fault`, `clear` or `drive`";
            return self.refuse(Diagnostic::new(Code::MissingKey, fields.brace(), message));
        }
        let place = self.stands_at(node.span, &fields);
        Some(Step {
            when: when?,
            actions,
            place,
        })
    }

    fn when(&mut self, fields: &Fields<'_>) -> Option<When> {
        match (fields.entry("at"), fields.entry("when")) {
            (Some((_, node)), None) => {
                for key in ["after", "every"] {
                    if let Some((key, _)) = fields.entry(key) {
                        let message = format!("`{}` belongs to `when`, not to `at`", key.text);
                        self.report(Diagnostic::new(Code::UnknownKey, key.span, message));
                    }
                }
                self.scan_in_run(node, "`at`").map(When::At)
            }
            (None, Some((_, node))) => {
                let conditions = self.conditions(node, "`when`");
                let after = self.optional(fields, "after", 0, Self::scans);
                let every = self.optional(fields, "every", false, Self::boolean);
                Some(When::Holds {
                    conditions: conditions?,
                    after: after?,
                    every: every?,
                })
            }
            (Some((first, _)), Some((second, _))) => {
                let message = "a step has `at` or `when`, not both";
                self.refuse(
                    Diagnostic::new(Code::UnknownKey, second.span, message)
                        .related(first.span, "the other one"),
                )
            }
            (None, None) => {
                let message = "a step needs `at` or `when`";
                self.refuse(
                    Diagnostic::new(Code::MissingKey, fields.brace(), message)
                        .help("`at` names a scan, `when` conditions on the trace"),
                )
            }
        }
    }

    /// A scan of the run: 0 to `scans` - 1.
    pub(super) fn scan_in_run(&mut self, node: &Node, what: &str) -> Option<u64> {
        let scan = self.scans(node, what)?;
        let Some(count) = self.scan_count else {
            return Some(scan);
        };
        if scan < count {
            return Some(scan);
        }
        let message = format!("{what} is scan {scan}, but the run's last scan is {}", count - 1);
        self.refuse(
            Diagnostic::new(Code::OutsideRun, node.span, message)
                .help("scans are counted from 0; or raise `scans`"),
        )
    }

    fn set(&mut self, node: &Node) -> Option<Vec<Action>> {
        let members = self.map(node, "`set`")?;
        let has_note_variable = self.names.get("note").is_some();
        let mut places: BTreeMap<String, Span> = BTreeMap::new();
        let mut actions = Vec::new();
        for (key, value) in members.iter() {
            if is_note(key, value) && !has_note_variable {
                continue;
            }
            if let Some(first) = places.insert(key.text.to_ascii_uppercase(), key.span) {
                let message = format!("two writers on {}", quoted(&key.text));
                self.report(
                    Diagnostic::new(Code::TwoWriters, key.span, message)
                        .related(first, "the other one; case makes no difference"),
                );
            }
            actions.push(self.set_one(&key.text, key.span, value));
        }
        actions.into_iter().collect()
    }

    fn set_one(&mut self, name: &str, span: Span, node: &Node) -> Option<Action> {
        let (point, ty) = self.point(name, span)?;
        if let Point::Pin(instance, pin) = point {
            if let Some(super::Entity::Block(_, Some(block))) =
                self.names.get(name.split('.').next().unwrap_or_default())
                && pin >= block.input_count()
            {
                let message = format!("{} is an output: only inputs are written", quoted(name));
                return self.refuse(Diagnostic::new(Code::NotWritable, span, message));
            }
            if let Some((_, wire)) = self.wires.get(&(instance, pin)) {
                let message = format!("two writers on {}: a wire and this step", quoted(name));
                return self.refuse(
                    Diagnostic::new(Code::TwoWriters, span, message)
                        .related(*wire, "wired here")
                        .help("set the input variable the wire reads, or replace the wire by a constant"),
                );
            }
        }
        if let Point::Symbol(_, 0) = point {
            let message = format!("{} is written by the runtime", quoted(name));
            return self.refuse(Diagnostic::new(Code::NotWritable, span, message));
        }
        if let Some(variable) = self.variable_at(point).cloned() {
            return self.set_variable(point, &variable, (name, span), node);
        }
        let what = format!("{} ({})", quoted(name), ty.iec_name());
        let value = self.value(node, ty, &what)?;
        self.symbol_holds(point, value, node.span, &quoted(name))
            .then_some(Action::Set(point, value))
    }

    fn fault(&mut self, node: &Node) -> Option<Action> {
        let fields = self.fields(node, &shape::FAULT)?;
        let axis = self.axis_of(&fields, "`fault`");
        let kind = self.needed(&fields, "kind", "`fault`", |it, node, key| {
            it.choice(node, key, &FAULT_KINDS)
        });
        let code = self.optional(&fields, "code", 0, |it, node, key| {
            it.whole(node, key, 0..=i64::from(u16::MAX))
        });
        Some(Action::Fault {
            axis: axis?,
            kind: kind?,
            code: u16::try_from(code?).ok()?,
        })
    }

    fn clear(&mut self, node: &Node) -> Option<Action> {
        let fields = self.fields(node, &shape::CLEAR)?;
        let axis = self.axis_of(&fields, "`clear`")?;
        Some(Action::Clear { axis })
    }

    fn drive_step(&mut self, node: &Node) -> Option<Vec<Action>> {
        let fields = self.fields(node, &shape::DRIVE_STEP)?;
        let axis = self.axis_of(&fields, "a `drive` step");
        let mut news = Vec::new();
        for (key, value) in fields.iter() {
            let name = format!("`{}`", key.text);
            let new = match key.text.as_str() {
                "displace" => self.finite(value, &name).map(DriveChange::Displace),
                "remote" => self.boolean(value, &name).map(DriveChange::Remote),
                "warning" => self.boolean(value, &name).map(DriveChange::Warning),
                "input" => self.input(value),
                "probe" => self.probe(value),
                "report" => {
                    news.push(self.drive_report(value, axis));
                    continue;
                }
                _ => continue,
            };
            let new = new.filter(|change| self.knows_change(key, axis, change));
            news.push(new.map(|change| vec![change]));
        }
        let (axis, changes) = (axis?, news.into_iter().collect::<Option<Vec<_>>>()?.concat());
        if changes.is_empty() {
            let message = "a `drive` step needs what is to happen";
            return self.refuse(Diagnostic::new(Code::MissingKey, fields.brace(), message).help(
                "give `displace`, `input`, `probe` or `report`, or for a CiA 402 drive `remote` or `warning`",
            ));
        }
        let actions = changes.into_iter();
        Some(actions.map(|change| Action::Drive { axis, change }).collect())
    }

    fn input(&mut self, node: &Node) -> Option<DriveChange> {
        let fields = self.fields(node, &shape::DRIVE_INPUT)?;
        let last = i64::from(DIGITAL) - 1;
        let number = self.needed(&fields, "number", "`input`", |it, node, key| {
            it.whole(node, key, 0..=last)
        });
        let level = self.needed(&fields, "value", "`input`", Self::boolean);
        Some(DriveChange::Input {
            number: u32::try_from(number?).ok()?,
            level: level?,
        })
    }

    fn probe(&mut self, node: &Node) -> Option<DriveChange> {
        let fields = self.fields(node, &shape::DRIVE_PROBE)?;
        let last = PROBES as i64;
        let number = self.needed(&fields, "number", "`probe`", |it, node, key| {
            it.whole(node, key, 1..=last)
        });
        let at = self.optional(&fields, "at", 1.0, Self::finite);
        let level = self.needed(&fields, "value", "`probe`", Self::boolean);
        let (number, at, level) = (number?, at?, level?);
        if !(0.0..=1.0).contains(&at) {
            let message = format!("`at` is {at:?}, a part of a scan is from 0 to 1");
            return self.refuse(Diagnostic::new(Code::BadValue, fields.brace(), message));
        }
        Some(DriveChange::Probe {
            number: usize::try_from(number - 1).ok()?,
            at,
            level,
        })
    }

    /// The value that a drive reports instead of the measured one.
    fn drive_report(&mut self, node: &Node, axis: Option<usize>) -> Option<Vec<DriveChange>> {
        let fields = self.fields(node, &shape::DRIVE_REPORT)?;
        let drive = self.drive_of(axis);
        let mut changes = Vec::new();
        if let Some(node) = fields.get("position") {
            let position = match drive {
                // A count of increments is always a number.
                Some((_, true)) => self
                    .whole(node, "`report.position`", i64::MIN..=i64::MAX)
                    .map(DrivePosition::Increments),
                Some((_, false)) | None => self.number(node, "`report.position`").map(DrivePosition::Units),
            };
            changes.push(DriveChange::ReportPosition(position?));
        }
        if let Some((key, node)) = fields.entry("torque") {
            let torque = self.number(node, "`report.torque`")?;
            let tells_torque = match drive {
                Some((DriveSetup::Ideal(_), _)) => false,
                Some((DriveSetup::Cia402(setup), _)) => setup.motor.is_some(),
                Some((DriveSetup::Plant(_), _)) | None => true,
            };
            if !tells_torque {
                let message = "this drive tells no torque";
                return self.refuse(
                    Diagnostic::new(Code::BadValue, key.span, message)
                        .help("a `plant` does, and a `cia402` drive with a `motor`"),
                );
            }
            changes.push(DriveChange::ReportTorque(torque));
        }
        if changes.is_empty() {
            let message = "`report` needs `position` or `torque`";
            return self.refuse(Diagnostic::new(Code::MissingKey, fields.brace(), message));
        }
        Some(changes)
    }

    /// The drive of an axis, and whether it counts increments; none if it could not be read.
    fn drive_of(&self, axis: Option<usize>) -> Option<(DriveSetup, bool)> {
        self.drives.get(axis?).copied().flatten()
    }

    /// Whether the drive of `axis` supports the change; drives that could not be read were reported
    /// before.
    fn knows_change(&mut self, key: &Key, axis: Option<usize>, change: &DriveChange) -> bool {
        let is_of_bus = matches!(change, DriveChange::Remote(_) | DriveChange::Warning(_));
        let is_on_bus = matches!(self.drive_of(axis), None | Some((DriveSetup::Cia402(_), _)));
        if is_of_bus && !is_on_bus {
            let message = format!("only a CiA 402 drive has `{}`", key.text);
            self.report(
                Diagnostic::new(Code::BadValue, key.span, message)
                    .help("give the axis \"drive\": {\"cia402\": {}}"),
            );
        }
        is_on_bus || !is_of_bus
    }

    fn axis_of(&mut self, fields: &Fields<'_>, what: &str) -> Option<usize> {
        let node = self.require(fields, "axis", what)?;
        self.axis_index(node, "`axis`")
    }
}

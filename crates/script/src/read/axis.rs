//! Axes and their drives.

use super::Reader;
use super::json::{Json, Key, Node};
use super::value::Fields;
use crate::error::{Code, Diagnostic};
use crate::model::{Axis, Span};
use standstill_axis::{AxisConfig, AxisState, Limits, keys};

/// The keys of an axis that are not part of its configuration.
pub(crate) const OTHERS: [&str; 3] = ["unit", "drive", "vacuous"];

impl Reader {
    pub(super) fn axes(&mut self, fields: &Fields<'_>) -> Option<Vec<Axis>> {
        let node = self.require(fields, "axes", "a script")?;
        let members = self.map(node, "`axes`")?;
        self.check_count(members.iter().count(), node, "axes");
        let axes: Vec<Option<Axis>> = (0..)
            .zip(members.iter())
            .map(|(index, (key, node))| self.axis(index, key, node))
            .collect();
        axes.into_iter().collect()
    }

    fn axis(&mut self, index: usize, key: &Key, node: &Node) -> Option<Axis> {
        // Without limits no check below is possible, but mistakes in the other keys are still reported.
        let mut config = AxisConfig::new(Limits::NONE);
        let good = self.keys(node, &keys::AXIS, &OTHERS, &mut config);
        let Json::Map(members) = &node.json else {
            self.drives.push(None);
            return None;
        };
        let fields = Fields::of(node, members);
        let unit = self.optional(&fields, "unit", "", Self::text);
        let place = self.stands_at(key.span, &fields);
        let drive = self.drive(&fields, config.scaling.is_some());
        self.drives
            .push(drive.map(|drive| (drive, config.scaling.is_some())));
        good?;
        let cycle = self.cycle_ns.map(|cycle_ns| cycle_ns as f64 / 1e9);
        let checked = config
            .check()
            .and_then(|()| cycle.map_or(Ok(()), |cycle| config.check_cycle(cycle)));
        if let Err(error) = checked {
            return self.refuse(Diagnostic::new(
                Code::BadValue,
                place_of(key, node, error.key()),
                error.to_string(),
            ));
        }
        self.check_turn(&fields, &config)?;
        Some(Axis {
            name: key.text.clone(),
            unit: unit?.to_owned(),
            config,
            drive: drive?,
            masters: self.masters_of(index),
            superimposed: self.is_superimposed(index),
            on_cam: self.on_cams.contains(&index),
            place,
        })
    }

    /// The index of the start state of an axis among those that are permitted.
    pub(super) fn start_state(&mut self, node: &Node, names: &[&'static str]) -> Option<usize> {
        if let Json::Text(text) = &node.json
            && AxisState::ALL.iter().any(|state| state.name() == text)
            && !names.contains(&text.as_str())
        {
            let message = format!("an axis cannot start in {text}");
            let help = names.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>();
            return self.refuse(
                Diagnostic::new(Code::BadValue, node.span, message)
                    .help(format!("it starts in {}", help.join(" or "))),
            );
        }
        let name = self.state_name(node, "`state`", names)?;
        names.iter().position(|known| *known == name)
    }

    /// An axis that moves half a turn in a scan could have moved in either direction.
    fn check_turn(&mut self, axis: &Fields<'_>, config: &AxisConfig) -> Option<()> {
        let (Some(node), Some(length), Some(cycle_ns)) = (axis.get("modulo"), config.modulo, self.cycle_ns)
        else {
            return Some(());
        };
        let way = config.limits.velocity * (cycle_ns as f64 / 1e9);
        if way < length / 2.0 {
            return Some(());
        }
        let message = format!(
            "`modulo` is {length:?}, and at its velocity limit the axis goes {way:?} in a cycle: half a turn or more, so positions would not tell which way"
        );
        self.refuse(
            Diagnostic::new(Code::BadValue, node.span, message)
                .help("lower `limits.velocity`, or give a longer turn or a shorter `cycle`"),
        )
    }
}

/// The place of the configuration key `path`, such as `limits.jerk`, in the axis `node`: its value, or
/// the name of the axis if it was left out.
fn place_of(axis: &Key, node: &Node, path: &str) -> Span {
    let mut place = node;
    for part in path.split('.') {
        let inner = match &place.json {
            Json::List(items) => part.parse::<usize>().ok().and_then(|index| items.get(index)),
            _ => place.member(part),
        };
        match inner {
            Some(inner) => place = inner,
            None => return axis.span,
        }
    }
    place.span
}

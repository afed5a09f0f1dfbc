//! Other values of a script's parameters, without reading the whole script again.

use super::json::{Json, Node};
use super::value::Fields;
use super::{Parsed, Reader};
use crate::model::Script;
use std::collections::BTreeSet;

impl Parsed {
    /// The names of the parameters that are used outside `axes`.
    pub(crate) fn parameters_beside_axes(&self) -> BTreeSet<String> {
        let mut names = BTreeSet::new();
        let beside = self.root.members().iter().filter(|(key, _)| key.text != "axes");
        beside.for_each(|(_, node)| add_parameters(node, &mut names));
        names
    }

    /// Gives `script`, which was read from this text, other values of parameters that are used in its axes only.
    /// The rest of the script depends on the keys of an axis and not on its numbers, so nothing else changes.
    /// Returns FALSE if these values are invalid; `script` is then unusable until it gets valid ones.
    pub(crate) fn vary_axes(&self, script: &mut Script, parameters: &[(String, f64)]) -> bool {
        let mut reader = Reader {
            parameters: std::mem::take(&mut script.parameters),
            cycle_ns: Some(script.cycle_ns),
            ..Reader::default()
        };
        let mut are_known = true;
        for (name, value) in parameters {
            match reader.parameters.get_mut(name) {
                Some(place) => *place = *value,
                None => are_known = false,
            }
        }
        let axes = reader.axes(&Fields::of(&self.root, self.root.members()));
        script.parameters = reader.parameters;
        let Some(axes) = axes.filter(|_| are_known && reader.errors.is_empty()) else {
            return false;
        };
        for (axis, varied) in script.axes.iter_mut().zip(axes) {
            (axis.config, axis.drive) = (varied.config, varied.drive);
        }
        true
    }
}

/// Adds the names of the parameters that are used below a node. The reader of JSON bounds the recursion.
fn add_parameters(node: &Node, names: &mut BTreeSet<String>) {
    match &node.json {
        Json::List(items) => items.iter().for_each(|item| add_parameters(item, names)),
        Json::Map(members) => {
            for (key, node) in members {
                if let ("param", Json::Text(name)) = (key.text.as_str(), &node.json) {
                    names.insert(name.clone());
                }
                add_parameters(node, names);
            }
        }
        Json::Null | Json::Bool(_) | Json::Number(_) | Json::Text(_) => {}
    }
}

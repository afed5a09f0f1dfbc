//! Objects with their keys in a table: those of axes and drives.

use super::Reader;
use super::json::{Json, Node};
use super::value::Fields;
use crate::error::{Code, Diagnostic};
use crate::format::number_text;
use standstill_axis::keys::{Bounds, Holds, Key, Object};

/// The name of a key in messages: with its object.
fn called<T>(key: &Key<T>) -> String {
    match key.path.rsplit_once('.') {
        // The index of an object in a list.
        Some((above, name)) if above.ends_with(|last: char| last.is_ascii_digit()) => format!("`{name}`"),
        Some((above, name)) => format!("`{}.{name}`", above.rsplit('.').next().unwrap_or(above)),
        None => format!("`{}`", key.path),
    }
}

impl Reader {
    /// Reads the keys of `object` in `node` into `to`, and returns all its members. All mistakes are
    /// reported before it fails. `others` are keys that are read elsewhere.
    pub(super) fn keys<'n, T>(
        &mut self,
        node: &'n Node,
        object: &Object<T>,
        others: &[&'static str],
        to: &mut T,
    ) -> Option<Fields<'n>> {
        let names: Vec<_> = object
            .keys
            .iter()
            .map(Key::name)
            .chain(others.iter().copied())
            .collect();
        let known: Vec<_> = names.iter().copied().chain(["note"]).collect();
        let fields = self.members(node, object.what, &known)?;
        if object.needs_one && names.iter().all(|name| fields.get(name).is_none()) {
            let quoted: Vec<_> = names.iter().map(|name| format!("`{name}`")).collect();
            let message = format!("{} needs at least one of {}", object.what, quoted.join(", "));
            return self.refuse(Diagnostic::new(Code::MissingKey, fields.brace(), message));
        }
        let mut good = true;
        for (key, name) in object.keys.iter().zip(names) {
            good &= match fields.get(name) {
                Some(node) if key.is_needed() && matches!(node.json, Json::Null) => {
                    let message = format!("{} needs the key `{name}`", object.what);
                    self.report(Diagnostic::new(Code::MissingKey, node.span, message));
                    false
                }
                Some(node) => self.key(node, key, to).is_some(),
                None if key.is_needed() => self.require(&fields, name, object.what).is_some(),
                None => true,
            };
        }
        good.then_some(fields)
    }

    fn key<T>(&mut self, node: &Node, key: &Key<T>, to: &mut T) -> Option<()> {
        if let (Some(null), Json::Null) = (&key.null, &node.json) {
            (null.set)(to);
            return Some(());
        }
        let what = || called(key);
        match &key.holds {
            Holds::Bool { set, .. } => set(to, self.boolean(node, &what())?),
            Holds::Word { words, set, .. } => set(to, self.word(node, key.path, &what(), words)?),
            Holds::Number { set, .. } => {
                // In a sweep nearly all of them are valid in every case and need no name.
                let plain = self.plain_number(node).filter(|value| value.is_finite());
                set(to, plain.or_else(|| self.finite(node, &what()))?);
            }
            Holds::Whole { range, set, .. } => {
                let end = |end: u64| i64::try_from(end).unwrap_or(i64::MAX);
                let value = self.whole(node, &what(), end(range.0)..=end(range.1))?;
                set(to, value.unsigned_abs());
            }
            Holds::Scans { set, .. } => set(to, self.scans(node, &what())?),
            Holds::Object(object) => {
                self.keys(node, object, &[], to)?;
            }
            Holds::List(places) => {
                let items = self.list(node, &what())?;
                if items.len() > places.len() {
                    let message = format!(
                        "{} has {} entries: at most {} are taken",
                        what(),
                        items.len(),
                        places.len()
                    );
                    return self.refuse(Diagnostic::new(Code::BadValue, node.span, message));
                }
                let mut good = true;
                for (item, object) in items.iter().zip(*places) {
                    good &= self.keys(item, object, &[], to).is_some();
                }
                return good.then_some(());
            }
        }
        Some(())
    }

    /// The index of a word among those that a key permits.
    fn word(&mut self, node: &Node, path: &str, what: &str, words: &[&'static str]) -> Option<usize> {
        if path == "state" {
            return self.start_state(node, words);
        }
        let places: Vec<_> = words.iter().copied().zip(0..).collect();
        self.choice(node, what, &places)
    }

    /// Refuses numbers and scans outside the ranges of their keys. An axis has its own messages for that; a drive
    /// does not.
    pub(super) fn in_range<T>(&mut self, fields: &Fields<'_>, object: &Object<T>, of: &T) -> Option<()> {
        let mut good = Some(());
        for key in object.keys {
            let Some(node) = fields.get(key.name()) else {
                continue;
            };
            let refused = match &key.holds {
                Holds::Number { bounds, get, .. } => get(of)
                    .filter(|value| !bounds.hold(*value))
                    .map(|value| format!("is {}: it must be {}", number_text(value), range_text(bounds))),
                Holds::Scans { range, get, .. } => get(of)
                    .filter(|scans| !(range.0..=range.1).contains(scans))
                    .map(|scans| format!("is {scans} scans: it must be from {} to {}", range.0, range.1)),
                Holds::Object(object) => {
                    let inner = Fields::of(node, node.members());
                    good = self.in_range(&inner, object, of).and(good);
                    None
                }
                Holds::Bool { .. } | Holds::Word { .. } | Holds::Whole { .. } | Holds::List(_) => None,
            };
            if let Some(why) = refused {
                let message = format!("{} {why}", called(key));
                self.report(Diagnostic::new(Code::BadValue, node.span, message));
                good = None;
            }
        }
        good
    }
}

fn range_text(bounds: &Bounds) -> String {
    match (bounds.is_above, bounds.most == f64::MAX) {
        (true, true) => format!("above {}", number_text(bounds.least)),
        (false, true) => format!("at least {}", number_text(bounds.least)),
        (true, false) => format!(
            "above {} and at most {}",
            number_text(bounds.least),
            number_text(bounds.most)
        ),
        (false, false) => format!(
            "from {} to {}",
            number_text(bounds.least),
            number_text(bounds.most)
        ),
    }
}

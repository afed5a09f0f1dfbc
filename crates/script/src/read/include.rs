//! `include`: the shared part of scripts, read from machine files and put below the script's own.
//!
//! A machine file is a part of a script: axes, inputs, tasks, blocks and parameters. The parts are merged
//! before anything else is read, so the reader does not know the file of an entry. The entry's place
//! does, see [`ScriptError`](crate::ScriptError).

use super::json::{self, Json, Key, Node};
use super::value::wrong_type;
use super::{Reader, SCRIPT_VERSION, VERSION, shape, without_mark};
use crate::error::{Code, Diagnostic, File, quoted};
use crate::model::Span;
use std::collections::btree_map::Entry;
use std::collections::{BTreeMap, VecDeque};

/// Largest number of files of one script.
pub(super) const FILES_MAX: usize = 64;

/// The keys of a script that a machine file may have.
const SECTIONS: [&str; 5] = ["parameters", "axes", "inputs", "tasks", "blocks"];

type Members = Vec<(Key, Node)>;

/// The names of `override`, with their places, by the name in capitals; entries of one name in their order.
type Overrides = BTreeMap<String, VecDeque<(String, Span)>>;

/// Returns the text of a file, named relative to the script's folder, or the reason why not.
pub(super) type Load<'a> = &'a mut dyn FnMut(&str) -> Result<String, String>;

/// The texts of a script. Places are counted through all of them.
pub(super) struct Files<'a> {
    load: Load<'a>,
    /// The script first.
    pub(super) read: Vec<File>,
    /// Paths of `read` except the first, relative to the script's folder.
    paths: Vec<String>,
    /// The chain of files that leads to the one being read.
    open: Vec<String>,
}

impl<'a> Files<'a> {
    pub(super) fn new(file_name: &str, text: &str, load: Load<'a>) -> Self {
        Self {
            load,
            read: vec![File::new(file_name, text, 0)],
            paths: Vec::new(),
            open: Vec::new(),
        }
    }
}

impl Reader {
    /// The script with its included files.
    pub(super) fn with_includes(&mut self, root: Node, files: &mut Files<'_>) -> Node {
        let Node { span, json } = root;
        let json = match json {
            Json::Map(members) => Json::Map(self.expanded(members, files)),
            other => other,
        };
        Node { span, json }
    }

    /// The members of a script or a machine file, those of the files it includes first.
    fn expanded(&mut self, members: Members, files: &mut Files<'_>) -> Members {
        let mut texts = |wanted: &str| {
            let found = members.iter().find(|(key, _)| key.text == wanted);
            found.map_or_else(Vec::new, |(_, node)| self.texts(node))
        };
        let (paths, overrides) = (texts("include"), texts("override"));
        let mut below = Members::new();
        for (path, span) in paths {
            for (key, node) in self.machine(&path, span, files) {
                self.lay(&mut below, key, node, &mut Overrides::new());
            }
        }
        let mut wanted = Overrides::new();
        for (name, span) in overrides {
            let upper = name.to_ascii_uppercase();
            wanted.entry(upper).or_default().push_back((name, span));
        }
        let mut rest = Members::new();
        for (key, node) in members {
            match key.text.as_str() {
                "include" | "override" => {}
                section if SECTIONS.contains(&section) => self.lay(&mut below, key, node, &mut wanted),
                _ => rest.push((key, node)),
            }
        }
        for (name, span) in wanted.into_values().flatten() {
            let message = format!("nothing overrides {}", quoted(&name));
            self.report(
                Diagnostic::new(Code::BadOverride, span, message)
                    .help("`override` names what an included file and this one both have"),
            );
        }
        rest.extend(below);
        rest
    }

    /// The strings of a list, or a single string in place of one.
    fn texts(&mut self, node: &Node) -> Vec<(String, Span)> {
        let items = match &node.json {
            Json::List(items) => items.as_slice(),
            _ => std::slice::from_ref(node),
        };
        let text = |node: &Node| match &node.json {
            Json::Text(text) => Some((text.clone(), node.span)),
            _ => self.refuse(wrong_type(
                node,
                "`include` or `override`",
                "a string or a list of them",
            )),
        };
        items.iter().filter_map(text).collect()
    }

    /// The sections of a machine file; none of a file that was read before.
    fn machine(&mut self, path: &str, span: Span, files: &mut Files<'_>) -> Members {
        let refused = |message: String| Diagnostic::new(Code::BadInclude, span, message);
        let Some(path) = beside(files.open.last().map_or("", String::as_str), path) else {
            let message = format!("{} is no path to a machine file", quoted(path));
            self.report(
                refused(message).help("write a relative path with `/`, from the file that includes it"),
            );
            return Members::new();
        };
        if files.open.contains(&path) {
            let message = format!("{} includes itself", quoted(&path));
            self.report(refused(message).help(format!("the way: {} -> {path}", files.open.join(" -> "))));
            return Members::new();
        }
        if files.paths.contains(&path) {
            return Members::new();
        }
        if files.read.len() >= FILES_MAX {
            self.report(refused(format!("more than the {FILES_MAX} files of one script")));
            return Members::new();
        }
        let text = match (files.load)(&path) {
            Ok(text) => text,
            Err(why) => {
                self.report(refused(format!("{} cannot be included: {why}", quoted(&path))));
                return Members::new();
            }
        };
        let start = files.read.last().map_or(0, File::after);
        let folder = files.read.first().map_or("", |script| script.folder());
        let file = File::new(&format!("{folder}{path}"), without_mark(&text), start);
        let parsed = json::parse(file.text());
        files.read.push(file);
        files.paths.push(path.clone());
        let mut root = match parsed {
            Ok(root) => root,
            Err(diagnostic) => {
                self.report(diagnostic.moved(start));
                return Members::new();
            }
        };
        move_places(&mut root, start);
        let good = self
            .fields(&root, &shape::MACHINE)
            .and_then(|fields| self.version(&fields, SCRIPT_VERSION, "a machine file", VERSION));
        let Json::Map(members) = root.json else {
            return Members::new();
        };
        if good.is_none() {
            return Members::new();
        }
        files.open.push(path);
        let mut members = self.expanded(members, files);
        files.open.pop();
        members.retain(|(key, _)| SECTIONS.contains(&key.text.as_str()));
        members
    }

    /// Lays a section over the existing ones. A used override is removed from the list.
    fn lay(&mut self, below: &mut Members, key: Key, node: Node, overrides: &mut Overrides) {
        let Some((_, there)) = below.iter_mut().find(|(other, _)| other.text == key.text) else {
            below.push((key, node));
            return;
        };
        match (&mut there.json, node.json) {
            (Json::Map(there), Json::Map(entries)) => {
                let mut places = Places::new(there.iter().map(|(key, _)| key.text.as_str()));
                for (key, node) in entries {
                    match places
                        .of(&key.text, there.len())
                        .and_then(|place| there.get_mut(place))
                    {
                        None => there.push((key, node)),
                        Some((other, entry)) => {
                            if self.permitted(&key.text, key.span, other.span, overrides) {
                                replace(entry, node);
                            }
                        }
                    }
                }
            }
            (Json::List(there), Json::List(entries)) => {
                let mut places = Places::default();
                for (place, (name, _)) in there
                    .iter()
                    .enumerate()
                    .filter_map(|(place, node)| Some((place, name_of(node)?)))
                {
                    places.of(name, place);
                }
                for node in entries {
                    let name = name_of(&node).map(|(name, span)| (name.to_owned(), span));
                    let clash = (name.as_ref())
                        .and_then(|(name, _)| places.of(name, there.len()))
                        .and_then(|place| there.get_mut(place));
                    match (clash, name) {
                        (Some(entry), Some((name, span))) => {
                            let other = name_of(entry).map_or(entry.span, |(_, span)| span);
                            if self.permitted(&name, span, other, overrides) {
                                replace(entry, node);
                            }
                        }
                        _ => there.push(node),
                    }
                }
            }
            // It has the wrong type, or would be laid over something that has: the reader reports it.
            (there, json @ (Json::Map(_) | Json::List(_)))
                if !matches!(there, Json::Map(_) | Json::List(_)) =>
            {
                drop(json);
            }
            (_, json) => {
                *there = Node {
                    span: node.span,
                    json,
                };
            }
        }
    }

    /// Whether the entry may be laid over one of an included file; reports an error if not.
    fn permitted(&mut self, name: &str, span: Span, other: Span, overrides: &mut Overrides) -> bool {
        let wanted = overrides.get_mut(&name.to_ascii_uppercase());
        if wanted.is_some_and(|wanted| wanted.pop_front().is_some()) {
            return true;
        }
        let message = format!("the name {} is taken by an included file", quoted(name));
        self.report(
            Diagnostic::new(Code::DuplicateName, span, message)
                .related(other, "by this one")
                .help(format!(
                    "to change what that file says of it, add \"override\": [\"{name}\"]"
                )),
        );
        false
    }
}

/// Indices of entries by name, without regard to case.
#[derive(Default)]
struct Places(BTreeMap<String, usize>);

impl Places {
    /// Those of a list of names.
    fn new<'n>(names: impl Iterator<Item = &'n str>) -> Self {
        let mut places = Self::default();
        for (place, name) in names.enumerate() {
            places.of(name, place);
        }
        places
    }

    /// The index of a name. A name without an index gets the index `free`.
    fn of(&mut self, name: &str, free: usize) -> Option<usize> {
        match self.0.entry(name.to_ascii_uppercase()) {
            Entry::Occupied(place) => Some(*place.get()),
            Entry::Vacant(place) => {
                place.insert(free);
                None
            }
        }
    }
}

/// The `name` of a block.
fn name_of(node: &Node) -> Option<(&str, Span)> {
    let node = node.member("name")?;
    Some((node.text()?, node.span))
}

/// Keys of `by` replace those of the entry, pins one by one; the others stay.
fn replace(entry: &mut Node, by: Node) {
    replace_members(entry, by, |key, there, node| match key {
        "pins" => replace_members(there, node, |_, pin, node| *pin = node),
        _ => *there = node,
    });
}

/// The members of `by` replace those of `entry` of the same key as `lay` says, or are added to them.
fn replace_members(entry: &mut Node, by: Node, lay: impl Fn(&str, &mut Node, Node)) {
    match (&mut entry.json, by.json) {
        (Json::Map(there), Json::Map(members)) => {
            let keys = there.iter().map(|(key, _)| key.text.clone()).zip(0..);
            let mut places: BTreeMap<String, usize> = keys.collect();
            for (key, node) in members {
                let place = places.get(&key.text).copied();
                match place.and_then(|place| there.get_mut(place)) {
                    Some((other, value)) => {
                        lay(&key.text, value, node);
                        *other = key;
                    }
                    None => {
                        places.insert(key.text.clone(), there.len());
                        there.push((key, node));
                    }
                }
            }
        }
        (_, json) => {
            *entry = Node { span: by.span, json };
        }
    }
}

/// The path of a file named in another one, relative to the script's folder, without `.` and, as far as it goes,
/// without `..`; none if it is empty, absolute or written with backslashes.
fn beside(from: &str, path: &str) -> Option<String> {
    if path.is_empty() || path.starts_with('/') || path.contains(['\\', ':', '\0']) {
        return None;
    }
    let mut parts: Vec<&str> = from.split('/').collect();
    parts.pop();
    for part in path.split('/') {
        match (part, parts.last()) {
            ("" | ".", _) => {}
            ("..", Some(last)) if *last != ".." => {
                parts.pop();
            }
            _ => parts.push(part),
        }
    }
    (!parts.is_empty()).then(|| parts.join("/"))
}

/// Moves every place of a tree; bounded by the depth the JSON reader allows.
fn move_places(node: &mut Node, by: usize) {
    let moved = |span: &mut Span| *span = span.moved(by);
    moved(&mut node.span);
    match &mut node.json {
        Json::List(items) => items.iter_mut().for_each(|item| move_places(item, by)),
        Json::Map(members) => members.iter_mut().for_each(|(key, value)| {
            moved(&mut key.span);
            move_places(value, by);
        }),
        Json::Null | Json::Bool(_) | Json::Number(_) | Json::Text(_) => {}
    }
}

//! From text to a checked [`Script`].
//!
//! There are two passes over the parsed text. The first declares the names of axes, inputs and instances. The
//! second reads the rest, so that a wire may refer to a block further down. Every function reports the errors that
//! it finds and continues, so that one run shows all errors. A script is returned only if there were none.

pub(crate) mod axis;
pub(crate) mod block;
mod circle;
mod condition;
pub(crate) mod drive;
mod expect;
mod formula;
mod hints;
mod include;
pub(crate) mod json;
mod keys;
pub(crate) mod machine_map;
pub(crate) mod names;
pub(crate) mod program;
mod relative;
pub(crate) mod shape;
pub(crate) mod step;
pub(crate) mod sweep;
mod table;
mod task;
mod text;
pub(crate) mod time;
pub(crate) mod value;
mod variable;
mod vary;
mod wire;

use crate::error::{Code, Diagnostic, File, ScriptError, quoted};
use crate::format::number_text;
use crate::model::{Claim, Conditions, DriveSetup, Formula, Input, Place, Program, Script, Span};
use json::{Json, Key, Node};
use names::{Entity, Names, identifier_error};
pub use program::GUEST_MEMORY;
use standstill_axis::{CAM_PIECES, CAM_SLOTS};
use standstill_fb::{PinType, TableInfo, TableRef, Value};
use standstill_trace::digest::Fnv1a;
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;
use value::{Fields, wrong_type};

/// Largest number of scans of one run; 10^9 are 11.6 days at 1 ms.
pub const SCANS_MAX: u64 = 1_000_000_000;

/// Largest number of cells (rows times columns) of one run's trace.
pub const CELLS_MAX: u64 = 100_000_000;

/// Largest number of reads of rows by the conditions of a script's claims and steps, each in every scan: some
/// minutes of computing.
pub const LOOKS_MAX: u64 = 10_000_000_000;

/// Largest number of slots of the store of cams. The largest number of pieces is a million, which take 120 MB.
pub const CAM_SLOTS_MOST: usize = 65_000;

/// See [`CAM_SLOTS_MOST`].
pub const CAM_PIECES_MOST: usize = 1_000_000;

/// Largest number of axes, inputs or instances of one script each: their numbers are 16 bits wide.
pub const ENTITIES_MAX: usize = 65_000;

/// The version of the format that is read.
pub const VERSION: u32 = 1;

/// The key with the version of a script or a machine file, and the name of their format.
const SCRIPT_VERSION: (&str, &str) = ("standstill", "script");

/// The data collected while a script is read.
#[derive(Default)]
struct Reader {
    parameters: BTreeMap<String, f64>,
    names: Names,
    /// The tasks by name in capitals.
    task_places: BTreeMap<String, usize>,
    cycle_ns: Option<i64>,
    scan_count: Option<u64>,
    /// The drives of the axes, if they could be read, and whether they count increments.
    drives: Vec<Option<(DriveSetup, bool)>>,
    /// The wires read so far.
    wires: circle::Wires,
    /// The numbers of the tables read so far.
    tables: Vec<f64>,
    /// The script's tables by name; none for a table that was refused.
    named_tables: BTreeMap<String, (Option<TableRef>, TableInfo)>,
    /// The guest programs read so far.
    programs: Vec<Option<Program>>,
    terms: Terms,
    /// Some names may be missing because of another mistake, so an unknown name is no evidence.
    lacks_names: bool,
    /// The script's folder, with the `/` behind it; empty if none.
    folder: String,
    /// The names of the axes as the script spells them.
    axis_names: Vec<String>,
    /// Those at a `Slave` pin.
    slaves: BTreeMap<usize, usize>,
    /// Axes at the `Axis` pin of MC_MoveSuperimposed.
    superimposed: BTreeSet<usize>,
    /// Axes at the `Slave` pin of MC_CamIn.
    on_cams: BTreeSet<usize>,
    /// The expressions read so far.
    formulas: Vec<Formula>,
    /// Faults of sources in Structured Text.
    reports: Vec<standstill_st::Report>,
    errors: Vec<Diagnostic>,
}

/// Reads a scan script.
///
/// `file_name` is used in messages only. `overrides` replace values of the script's parameters; the last one of a
/// name counts. A byte order mark and CRLF are accepted. The work is bounded by the length of the text.
///
/// # Errors
/// [`ScriptError`] with all faults; after a syntax error only that one.
pub fn read(text: &str, file_name: &str, overrides: &[(String, f64)]) -> Result<Script, ScriptError> {
    read_with(text, file_name, overrides, &mut |_| {
        Err("there are no files here".to_owned())
    })
}

/// The same as [`read`], for a script that may include machine files. `load` returns the text of a file, named
/// relative to the script's folder, or the reason why not. It is called once for each file, and for at most 63.
///
/// # Errors
/// Those of [`read`]; messages about an included file name that file.
pub fn read_with(
    text: &str,
    file_name: &str,
    overrides: &[(String, f64)],
    load: &mut dyn FnMut(&str) -> Result<String, String>,
) -> Result<Script, ScriptError> {
    read_with_programs(text, file_name, overrides, load, &mut |_| {
        Err("there are no files here".to_owned())
    })
}

/// The same as [`read_with`], for a script that may have guest programs. `guest` returns the bytes of one, named
/// relative to the script's folder, or the reason why not. Together they may have [`GUEST_MEMORY`].
///
/// # Errors
/// Those of [`read_with`].
pub fn read_with_programs(
    text: &str,
    file_name: &str,
    overrides: &[(String, f64)],
    load: &mut dyn FnMut(&str) -> Result<String, String>,
    guest: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
) -> Result<Script, ScriptError> {
    read_within(text, file_name, overrides, load, guest, Terms::default())
}

/// The conditions under which programs run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Terms {
    /// Memory that all guests may have together (bytes).
    pub guest_memory: u64,
    /// Whether programs in Structured Text count their statements.
    pub coverage: bool,
    /// Whether the rows of the run are dropped on the way. There may then be more cells than one trace can have.
    pub long: bool,
    /// Whether a program has a task `main`, which runs in every scan, where the script's `tasks` do not name one.
    pub adds_main: bool,
}

impl Default for Terms {
    fn default() -> Self {
        Self {
            guest_memory: GUEST_MEMORY,
            coverage: false,
            long: false,
            adds_main: false,
        }
    }
}

/// The same as [`read_with_programs`], under other conditions.
///
/// # Errors
/// As [`read_with`].
pub(crate) fn read_within(
    text: &str,
    file_name: &str,
    overrides: &[(String, f64)],
    load: &mut dyn FnMut(&str) -> Result<String, String>,
    guest: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
    terms: Terms,
) -> Result<Script, ScriptError> {
    Parsed::new(text, file_name, load)?.script(overrides, guest, terms)
}

/// A script with its includes, as far as parameters do not affect it.
#[derive(Clone, Debug)]
pub(crate) struct Parsed {
    root: Node,
    /// The script first.
    files: Arc<[File]>,
    /// Of the texts of all files.
    hash: Fnv1a,
}

impl Parsed {
    /// Parses a script and the files that it includes; arguments as for [`read_with`].
    ///
    /// # Errors
    /// [`ScriptError`]: a syntax error, or a file that could not be read.
    pub(crate) fn new(
        text: &str,
        file_name: &str,
        load: &mut dyn FnMut(&str) -> Result<String, String>,
    ) -> Result<Self, ScriptError> {
        let (plain, root) = json::file(text, file_name)?;
        let mut reader = Reader::default();
        let mut files = include::Files::new(file_name, plain, load);
        let root = reader.with_includes(root, &mut files);
        // A missing name may be in the file that could not be read.
        if !reader.errors.is_empty() {
            return Err(ScriptError::of(files.read, reader.errors));
        }
        let mut hash = Fnv1a::new();
        hash.write(text.as_bytes());
        for file in files.read.iter().skip(1) {
            hash.write(file.text().as_bytes());
        }
        Ok(Self {
            root,
            files: files.read.into(),
            hash,
        })
    }

    /// A name for a program that nothing in the script has: the wanted one if it can be one, or `other`, with a number
    /// behind it if need be.
    pub(crate) fn free_name(&self, wanted: &str, other: &str) -> String {
        let members = |key: &str| self.root.member(key).map_or(&[][..], Node::members);
        let keys = ["axes", "inputs"]
            .into_iter()
            .flat_map(members)
            .map(|(key, _)| key.text.as_str());
        let blocks = match self.root.member("blocks").map(|node| &node.json) {
            Some(Json::List(items)) => items.as_slice(),
            _ => &[],
        };
        let blocks = blocks.iter().filter_map(|block| block.member("name")?.text());
        let taken: BTreeSet<String> = keys.chain(blocks).map(str::to_ascii_uppercase).collect();
        [wanted.to_owned(), other.to_owned()]
            .into_iter()
            .chain((2..).map(|number: u64| format!("{other}{number}")))
            .find(|name| identifier_error(name).is_none() && !taken.contains(&name.to_ascii_uppercase()))
            .unwrap_or_default()
    }

    /// The script with these parameters; arguments as for [`read_with_programs`].
    ///
    /// # Errors
    /// [`ScriptError`] with all faults.
    pub(crate) fn script(
        &self,
        overrides: &[(String, f64)],
        guest: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
        terms: Terms,
    ) -> Result<Script, ScriptError> {
        let mut hash = self.hash;
        let mut keep = |path: &str| {
            let bytes = guest(path)?;
            hash.write(&bytes);
            Ok(bytes)
        };
        let mut reader = Reader {
            terms,
            folder: self.files.first().map_or("", |script| script.folder()).to_owned(),
            ..Reader::default()
        };
        let script = reader.script(&self.root, overrides, &mut keep);
        reader.leave_out_what_follows();
        match script {
            Some(script) if reader.errors.is_empty() => Ok(Script {
                hash: hash.finish(),
                files: Arc::clone(&self.files),
                ..script
            }),
            _ => {
                debug_assert!(!reader.errors.is_empty(), "refused without a reason");
                Err(ScriptError::of(self.files.to_vec(), reader.errors).with_reports(reader.reports))
            }
        }
    }
}

/// Reads a file that is no script by `read`, which gets its value and its text without a byte order mark.
fn read_file<T>(
    text: &str,
    file_name: &str,
    read: impl FnOnce(&mut Reader, &Node, &str) -> Option<T>,
) -> Result<T, ScriptError> {
    let (plain, root) = json::file(text, file_name)?;
    let mut reader = Reader::default();
    match read(&mut reader, &root, plain) {
        Some(it) if reader.errors.is_empty() => Ok(it),
        _ => {
            debug_assert!(!reader.errors.is_empty(), "refused without a reason");
            Err(ScriptError::new(file_name, plain, reader.errors))
        }
    }
}

/// `text` without a byte order mark.
pub(crate) fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

impl Reader {
    fn script(
        &mut self,
        root: &Node,
        overrides: &[(String, f64)],
        guest: &mut dyn FnMut(&str) -> Result<Vec<u8>, String>,
    ) -> Option<Script> {
        let fields = self.fields(root, &shape::SCRIPT)?;
        // There may be other faults beside a missing key.
        if self
            .version(&fields, SCRIPT_VERSION, "a script", VERSION)
            .is_none()
            && fields.get("standstill").is_some()
        {
            return None;
        }
        if let Some(node) = fields.get("$schema") {
            self.text(node, "`$schema`")?;
        }
        self.parameters(&fields, overrides);
        let cycle = self.cycle(&fields);
        self.declare(&fields);
        let scans = self.scan_number(&fields);

        let title = self.optional(&fields, "title", "", Self::text);
        let covers = self.covers(&fields);
        let axes = self.axes(&fields);
        let inputs = self.inputs(&fields);
        // Before anything that may name one of their variables.
        let programs = self.programs(&fields, guest);
        let tables = self.tables(&fields, guest);
        let cams = self.cams(&fields);
        let mut tasks = self.tasks(&fields);
        self.program_calls(&fields, &mut tasks);
        let blocks = self.blocks(&fields, tasks.as_deref());
        let steps = self.steps(&fields);
        let claims = self
            .claims(&fields)
            .map(|claims| [claims, self.fault_claims(&fields)].concat());
        let stop_when = self.stop_when(&fields);
        let golden = self.optional(&fields, "golden", true, Self::boolean);
        let clamps = self.optional(&fields, "clamps", false, |it, node, key| {
            it.choice(node, key, &CLAMPS)
        });
        programs?;
        tables?;
        let programs: Option<Vec<Program>> = std::mem::take(&mut self.programs).into_iter().collect();
        let script = Script {
            title: title?.to_owned(),
            covers: covers?,
            cycle_ns: cycle?,
            scans: scans?,
            axes: axes?,
            inputs: inputs?,
            blocks: blocks?,
            programs: programs?,
            tasks: tasks?,
            steps: steps?,
            claims: claims?,
            stop_when: stop_when?,
            formulas: std::mem::take(&mut self.formulas),
            tables: std::mem::take(&mut self.tables),
            named_tables: self.tables_by_name(),
            cams: cams?,
            parameters: std::mem::take(&mut self.parameters),
            golden: golden?,
            clamps_expected: clamps?,
            files: Arc::default(),
            hash: 0,
        };
        if !self.terms.long {
            self.check_size(&script, fields.get("scans")?.span);
        }
        self.check_looks(&script, fields.get("scans")?.span);
        Some(script)
    }

    /// Checks the version of a format; `key` says it, `what` is the object that has it.
    fn version(
        &mut self,
        fields: &Fields<'_>,
        (key, format): (&str, &str),
        what: &str,
        read: u32,
    ) -> Option<()> {
        let node = self.require(fields, key, what)?;
        let called = format!("`{key}`, the version of the format,");
        let version = self.whole(node, &called, 1..=i64::from(u32::MAX))?;
        if version == i64::from(read) {
            return Some(());
        }
        let message = format!("version {version} of the {format} format is not supported");
        self.refuse(
            Diagnostic::new(Code::Unsupported, node.span, message)
                .help(format!("this runtime reads version {read}")),
        )
    }

    fn parameters(&mut self, fields: &Fields<'_>, overrides: &[(String, f64)]) {
        let declared = fields
            .get("parameters")
            .and_then(|node| self.map(node, "`parameters`"));
        for (key, node) in declared.iter().flat_map(Fields::iter) {
            let value = match &node.json {
                // A parameter of a parameter would need an order, and has no use.
                Json::Map(_) => self.refuse(wrong_type(node, &quoted(&key.text), "a number")),
                _ => self.number(node, &quoted(&key.text)),
            };
            // A refused value is already reported, so its uses need not be.
            self.parameters.insert(key.text.clone(), value.unwrap_or(1.0));
        }
        for (name, value) in overrides {
            if let Some(place) = self.parameters.get_mut(name) {
                *place = *value;
                continue;
            }
            let help = self
                .help(name, self.parameters.keys().map(String::as_str))
                .unwrap_or_else(|| {
                    "declare it under \"parameters\" and use it as {\"param\": ..}".to_owned()
                });
            let message = format!(
                "the script has no parameter {} to set to {}",
                quoted(name),
                number_text(*value)
            );
            let mut diagnostic = Diagnostic::new(Code::UnknownParameter, Span::default(), message).help(help);
            diagnostic.span = None;
            self.report(diagnostic);
        }
    }

    fn cycle(&mut self, fields: &Fields<'_>) -> Option<i64> {
        let node = self.require(fields, "cycle", "a script")?;
        let ns = self.time_literal(node, "`cycle`")?;
        if ns > 0 {
            self.cycle_ns = Some(ns);
            return Some(ns);
        }
        self.refuse(Diagnostic::new(
            Code::BadTime,
            node.span,
            "`cycle` must be longer than nothing",
        ))
    }

    fn scan_number(&mut self, fields: &Fields<'_>) -> Option<u64> {
        let node = self.require(fields, "scans", "a script")?;
        let scans = self.scans_of(node, "`scans`", 1..=SCANS_MAX as i64)?;
        let end_ns = i64::try_from(scans)
            .ok()
            .and_then(|scans| scans.checked_mul(self.cycle_ns.unwrap_or(1)));
        let diagnostic = if scans == 0 {
            Diagnostic::new(Code::BadValue, node.span, "a run has at least one scan")
        } else if scans > SCANS_MAX {
            Diagnostic::new(
                Code::TooLarge,
                node.span,
                format!("{scans} scans are more than the {SCANS_MAX} of one run"),
            )
            .help("a longer `cycle` covers the same time with fewer scans; `stop_when` ends a run earlier")
        } else if end_ns.is_none() {
            Diagnostic::new(
                Code::TooLarge,
                node.span,
                "the run's end does not fit in 64 bits of nanoseconds",
            )
        } else {
            self.scan_count = Some(scans);
            return Some(scans);
        };
        self.refuse(diagnostic)
    }

    /// Removes errors that follow from other mistakes: unknown names, if some names could not be read.
    fn leave_out_what_follows(&mut self) {
        let follows = |error: &Diagnostic| matches!(error.code, Code::UnknownSignal | Code::UnknownAxis);
        if self.lacks_names && !self.errors.iter().all(follows) {
            self.errors.retain(|error| !follows(error));
        }
    }

    /// Declares every name, and checks it.
    fn declare(&mut self, fields: &Fields<'_>) {
        let is_there = |key: &str| {
            let node = fields.get(key).map(|node| &node.json);
            matches!(node, Some(Json::Map(_) | Json::List(_)))
        };
        let lacks = |key: &str| {
            let node = fields.get(key);
            node.is_some_and(|node| !matches!(node.json, Json::Map(_)))
        };
        let is_slip = |key: &str| {
            !shape::SCRIPT.has(key) && names::nearest(key, ["inputs", "programs"].into_iter()).is_some()
        };
        self.lacks_names = !is_there("axes")
            || !is_there("blocks")
            || lacks("inputs")
            || lacks("programs")
            || fields.iter().any(|(key, _)| is_slip(&key.text));
        let mut places: BTreeMap<String, Span> = BTreeMap::new();
        for (index, (key, _)) in fields.members("axes").iter().enumerate() {
            self.axis_names.push(key.text.clone());
            self.declare_name(&mut places, &key.text, key.span, Entity::Axis(index));
        }
        for (index, (key, node)) in fields.members("inputs").iter().enumerate() {
            let ty = match (&node.json, node.member("value").map(|node| &node.json)) {
                (Json::Bool(_), _) | (_, Some(Json::Bool(_))) => Some(PinType::Bool),
                (Json::Null | Json::List(_), _) => None,
                _ => Some(PinType::Lreal),
            };
            self.declare_name(&mut places, &key.text, key.span, Entity::Input(index, ty));
        }
        for (index, (key, _)) in fields.members("programs").iter().enumerate() {
            self.declare_name(&mut places, &key.text, key.span, Entity::Program(index));
        }
        if let Some(Json::List(items)) = fields.get("blocks").map(|node| &node.json) {
            for (index, node) in items.iter().enumerate() {
                self.declare_block(&mut places, index, node);
            }
        }
    }

    /// Declares the name of a block, and what its pins say about axes.
    fn declare_block(&mut self, places: &mut BTreeMap<String, Span>, index: usize, node: &Node) {
        let pins = node.member("pins");
        if let Some(slave) = pins.and_then(|pins| self.axis_at(pins, "Slave")) {
            let second = pins.and_then(|pins| pin_of(pins, "Master2"));
            let masters = if second.is_some() { 2 } else { 1 };
            let most = self.slaves.entry(slave).or_default();
            *most = masters.max(*most);
        }
        let name = node.member("type").and_then(Node::text);
        let info = name.and_then(standstill_blocks::registry::find);
        match info.map(|info| info.name) {
            Some("MC_CamIn") => {
                let slave = pins.and_then(|pins| self.axis_at(pins, "Slave"));
                self.on_cams.extend(slave);
            }
            Some("MC_MoveSuperimposed") => {
                let axis = pins.and_then(|pins| self.axis_at(pins, "Axis"));
                self.superimposed.extend(axis);
            }
            _ => {}
        }
        match node.member("name") {
            Some(Node {
                span,
                json: Json::Text(name),
            }) => self.declare_name(places, name, *span, Entity::Block(index, info)),
            _ => self.lacks_names = true,
        }
    }

    /// The axis at this pin, if there is one.
    fn axis_at(&self, pins: &Node, pin: &str) -> Option<usize> {
        match self.names.get(pin_of(pins, pin)?.text()?)? {
            Entity::Axis(axis) => Some(axis),
            _ => None,
        }
    }

    /// The largest number of masters that a block of the script gives an axis.
    fn masters_of(&self, axis: usize) -> usize {
        self.slaves.get(&axis).copied().unwrap_or(0)
    }

    /// The store of cams: slots, and pieces in all.
    fn cams(&mut self, fields: &Fields<'_>) -> Option<(usize, usize)> {
        let Some(node) = fields.get("cams") else {
            return Some((CAM_SLOTS, CAM_PIECES));
        };
        let fields = self.fields(node, &shape::CAMS)?;
        let mut number = |key: &str, most: usize, usual: usize| {
            self.optional(&fields, key, usual, |it, node, key| {
                let value = it.whole(node, key, 0..=most as i64)?;
                usize::try_from(value).ok()
            })
        };
        let slots = number("slots", CAM_SLOTS_MOST, CAM_SLOTS);
        let pieces = number("stretches", CAM_PIECES_MOST, CAM_PIECES);
        slots.zip(pieces)
    }

    /// Whether it has a master, and motions may be superimposed on it.
    fn is_superimposed(&self, axis: usize) -> bool {
        self.masters_of(axis) > 0 && self.superimposed.contains(&axis)
    }

    fn check_name(&mut self, name: &str, span: Span) {
        if let Some(why) = identifier_error(name) {
            let message = format!("{} cannot be a name: {why}", quoted(name));
            self.report(Diagnostic::new(Code::BadName, span, message));
        }
    }

    fn declare_name(&mut self, places: &mut BTreeMap<String, Span>, name: &str, span: Span, entity: Entity) {
        self.check_name(name, span);
        if let Some(first) = places.insert(name.to_ascii_uppercase(), span) {
            let message = format!("the name {} is taken", quoted(name));
            self.report(
                Diagnostic::new(Code::DuplicateName, span, message)
                    .related(first, "by this one")
                    .help(
                        "axes, inputs, instances and programs share one set of names, without regard to case",
                    ),
            );
        }
        self.names.add(name, entity);
    }

    fn covers(&mut self, fields: &Fields<'_>) -> Option<Vec<String>> {
        let Some(node) = fields.get("covers") else {
            return Some(Vec::new());
        };
        let items = self.list(node, "`covers`")?;
        self.each(items, |reader, item| {
            reader.text(item, "`covers`").map(str::to_owned)
        })
    }

    fn inputs(&mut self, fields: &Fields<'_>) -> Option<Vec<Input>> {
        let Some(node) = fields.get("inputs") else {
            return Some(Vec::new());
        };
        let members = self.map(node, "`inputs`")?;
        self.check_count(members.iter().count(), node, "inputs");
        let mut inputs = Vec::new();
        for (key, node) in members.iter() {
            let what = quoted(&key.text);
            let mut place = Place {
                span: key.span,
                may_be_vacuous: false,
            };
            let mut node = node;
            if let Some(inner) = node.member("value") {
                let fields = self.fields(node, &shape::INPUT);
                place.may_be_vacuous = fields.is_some_and(|fields| self.may_be_vacuous(&fields));
                node = inner;
            }
            let initial = match &node.json {
                Json::Bool(value) => Some(Value::Bool(*value)),
                Json::Null | Json::List(_) => self.refuse(wrong_type(node, &what, "a bool or a number")),
                _ => self.number(node, &what).map(Value::Lreal),
            };
            inputs.push(initial.map(|initial| Input {
                name: key.text.clone(),
                initial,
                place,
            }));
        }
        inputs.into_iter().collect()
    }

    /// Whether the author permits this item to test nothing.
    fn may_be_vacuous(&mut self, fields: &Fields<'_>) -> bool {
        fields
            .get("vacuous")
            .is_some_and(|node| self.choice(node, "`vacuous`", &[("allowed", true)]).is_some())
    }

    /// The place of an item, with the author's note on it.
    fn stands_at(&mut self, span: Span, fields: &Fields<'_>) -> Place {
        Place {
            span,
            may_be_vacuous: self.may_be_vacuous(fields),
        }
    }

    fn stop_when(&mut self, fields: &Fields<'_>) -> Option<Option<(Conditions, u64)>> {
        let after = self.optional(fields, "after", 0, Self::scans);
        match (fields.get("stop_when"), fields.entry("after")) {
            (Some(node), _) => Some(Some((self.conditions(node, "`stop_when`")?, after?))),
            (None, None) => Some(None),
            (None, Some((key, _))) => {
                let message = "`after` says how long a run goes on after `stop_when`, which is not given";
                self.refuse(Diagnostic::new(Code::MissingKey, key.span, message))
            }
        }
    }

    /// All results of `f`, or none if one failed; `f` is called for every item, to report all errors.
    fn each<T>(
        &mut self,
        items: &[Node],
        mut f: impl FnMut(&mut Self, &Node) -> Option<T>,
    ) -> Option<Vec<T>> {
        let results: Vec<Option<T>> = items.iter().map(|item| f(self, item)).collect();
        results.into_iter().collect()
    }

    fn check_count(&mut self, count: usize, node: &Node, what: &str) {
        if count > ENTITIES_MAX {
            let span = Span {
                start: node.span.start,
                end: node.span.start + 1,
            };
            let message = format!("{count} {what} are more than the {ENTITIES_MAX} of one script");
            self.report(Diagnostic::new(Code::TooLarge, span, message));
        }
    }

    fn check_size(&mut self, script: &Script, span: Span) {
        let pins: usize = script.blocks.iter().map(|block| block.block.pins().count()).sum();
        let symbols: usize = script.programs.iter().map(|program| program.symbols.len()).sum();
        let columns = (2 + 7 * script.axes.len() + script.inputs.len() + pins + symbols) as u64;
        if script.scans.saturating_mul(columns) > CELLS_MAX {
            let message = format!(
                "{} scans of {columns} columns are more than the {CELLS_MAX} cells of one trace",
                script.scans
            );
            self.report(Diagnostic::new(Code::TooLarge, span, message).help(format!(
                "with these columns at most {} scans; a longer `cycle` covers the same time with fewer; `standstill run` keeps no \
                 rows of a long run and takes more",
                CELLS_MAX / columns
            )));
        }
    }

    fn check_looks(&mut self, script: &Script, span: Span) {
        let claims = script.claims.iter().map(Claim::looks);
        let steps = script.steps.iter().map(|step| step.when.looks());
        let looks = claims.chain(steps).fold(0, u64::saturating_add);
        let looks = looks.saturating_mul(script.scans);
        if looks > LOOKS_MAX && !self.terms.long {
            let message = format!(
                "claims and steps take {looks} looks at rows, more than the {LOOKS_MAX} of one run: their conditions \
                 times the scans"
            );
            let help = "a longer `cycle` covers the same time with fewer scans";
            self.report(Diagnostic::new(Code::TooLarge, span, message).help(help));
        }
    }
}

/// The permitted values of `clamps`.
pub(crate) const CLAMPS: [(&str, bool); 1] = [("expected", true)];

/// Whether this is the note of a map of names, which is not a name. By the contract any object may have one.
fn is_note(key: &Key, node: &Node) -> bool {
    key.text == "note" && matches!(node.json, Json::Text(_))
}

/// The value at a pin of a block.
fn pin_of<'a>(pins: &'a Node, pin: &str) -> Option<&'a Node> {
    let mut pins = pins.members().iter();
    pins.find(|(key, _)| key.text.eq_ignore_ascii_case(pin))
        .map(|(_, node)| node)
}

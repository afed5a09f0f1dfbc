//! The names of a script: axes, inputs, instances, programs, tasks, including those of its machine files.

use crate::documents::Documents;
use crate::position::Text;
use crate::text::Project;
use crate::tree::{self, Node};
use crate::uri;
use lsp_types::Location;
use standstill_blocks::registry;
use standstill_fb::{BlockInfo, Pin};
use standstill_st::editor::{Hover, variable};
use standstill_st::{Dialect, Options};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::rc::Rc;

/// Largest number of files of a script.
const FILES_MOST: usize = 64;

/// Largest number of variables of a program that are offered.
const VARIABLES_MOST: usize = 1000;

/// The signals of an axis, except its state.
const AXIS_SIGNALS: &[(&str, &str, &str)] = &[
    ("State", "state", "State after all blocks were called in the scan"),
    ("Position", "LREAL", "Set-point of the end of the scan (u)"),
    ("Velocity", "LREAL", "Set-point of the velocity (u/s)"),
    ("Acceleration", "LREAL", "Set-point of the acceleration (u/s^2)"),
    ("Jerk", "LREAL", "Set-point of the jerk (u/s^3)"),
    ("Snap", "LREAL", "Set-point of the snap (u/s^4)"),
    ("ActualPosition", "LREAL", "Position that the drive reported (u)"),
    (
        "Position.d1",
        "LREAL",
        "First difference of published positions, by the cycle (u/s)",
    ),
    (
        "Position.d2",
        "LREAL",
        "Second difference of published positions (u/s^2)",
    ),
    (
        "Position.d3",
        "LREAL",
        "Third difference of published positions (u/s^3)",
    ),
    (
        "Position.d4",
        "LREAL",
        "Fourth difference of published positions (u/s^4)",
    ),
];

pub(crate) const STATES: &[&str] = &[
    "Disabled",
    "Standstill",
    "Homing",
    "Stopping",
    "DiscreteMotion",
    "ContinuousMotion",
    "SynchronizedMotion",
    "ErrorStop",
];

#[derive(Clone, Copy, Debug)]
pub(crate) enum Kind {
    Axis,
    Input,
    Block(Option<&'static BlockInfo>),
    Program,
    Task,
    Parameter,
}

/// Something that has a name.
#[derive(Clone, Debug)]
pub(crate) struct Entity {
    pub name: String,
    pub kind: Kind,
    file: usize,
    span: Range<usize>,
}

/// A signal that may be read.
#[derive(Clone, Debug)]
pub(crate) struct Signal {
    pub name: String,
    pub detail: String,
    pub doc: String,
    /// Whether steps may set it.
    pub settable: bool,
}

/// The information about a name in a script.
#[derive(Debug)]
pub(crate) struct Told {
    /// As Structured Text.
    pub text: String,
    pub doc: String,
    pub declared: Option<Location>,
}

#[derive(Debug)]
pub(crate) struct Scene<'d> {
    documents: &'d Documents,
    dialect: &'d Dialect,
    /// The script first.
    files: Vec<(PathBuf, Rc<Text>, Node)>,
    entities: Vec<Entity>,
}

impl<'d> Scene<'d> {
    pub(crate) fn new(documents: &'d Documents, path: &Path, dialect: &'d Dialect) -> Option<Self> {
        let mut scene = Self {
            documents,
            dialect,
            files: Vec::new(),
            entities: Vec::new(),
        };
        scene.include(path.to_owned());
        let mut next = 0;
        while let Some((outer, _, tree)) = scene.files.get(next) {
            let inner = tree
                .get("include")
                .map(|it| it.texts().map(str::to_owned).collect::<Vec<_>>());
            let outer = outer.clone();
            for inner in inner.unwrap_or_default() {
                if let Ok(path) = documents.beside(&outer, &inner) {
                    scene.include(path);
                }
            }
            next += 1;
        }
        for file in 0..scene.files.len() {
            scene.declare(file);
        }
        (!scene.files.is_empty()).then_some(scene)
    }

    fn include(&mut self, path: PathBuf) {
        if self.files.len() >= FILES_MOST || self.files.iter().any(|(it, ..)| *it == path) {
            return;
        }
        if let Ok(text) = self.documents.text(&path) {
            let tree = tree::parse(text.as_str());
            self.files.push((path, text, tree));
        }
    }

    fn declare(&mut self, file: usize) {
        let (_, _, tree) = &self.files[file];
        let mut found = Vec::new();
        let maps = [
            ("axes", Kind::Axis),
            ("inputs", Kind::Input),
            ("programs", Kind::Program),
            ("tasks", Kind::Task),
            ("parameters", Kind::Parameter),
        ];
        for (key, kind) in maps {
            for (member, _) in tree.get(key).into_iter().flat_map(Node::members) {
                found.push(Entity {
                    name: member.key.clone(),
                    kind,
                    file,
                    span: member.key_span.clone(),
                });
            }
        }
        for block in tree.get("blocks").map(Node::items).unwrap_or_default() {
            if let Some(name) = block.get("name")
                && let Some(text) = name.as_text()
            {
                let info = block.get("type").and_then(Node::as_text);
                found.push(Entity {
                    name: text.to_owned(),
                    kind: Kind::Block(info.and_then(registry::find)),
                    file,
                    span: name.span.clone(),
                });
            }
        }
        self.entities.extend(found);
    }

    pub(crate) fn tree(&self) -> &Node {
        &self.files[0].2
    }

    pub(crate) fn text(&self) -> &Text {
        &self.files[0].1
    }

    pub(crate) fn entities(&self) -> &[Entity] {
        &self.entities
    }

    pub(crate) fn names(&self, wanted: impl Fn(Kind) -> bool) -> Vec<&str> {
        let found = self.entities.iter().filter(|it| wanted(it.kind));
        found.map(|it| it.name.as_str()).collect()
    }

    /// The place of a declaration.
    pub(crate) fn location(&self, entity: &Entity) -> Option<Location> {
        let (path, text, _) = self.files.get(entity.file)?;
        Some(Location {
            uri: uri::uri(path)?,
            range: text.range(entity.span.clone()),
        })
    }

    /// The file that a text of the script names.
    pub(crate) fn file(&self, inner: &str) -> Option<Location> {
        let path = self.documents.beside(&self.files[0].0, inner).ok()?;
        Some(Location {
            uri: uri::uri(&path)?,
            range: lsp_types::Range::default(),
        })
    }

    /// The sources of a program in Structured Text.
    fn project(&self, name: &str) -> Option<Project> {
        let (path, _, tree) = &self.files[0];
        let mut programs = tree.get("programs")?.members();
        let (_, program) = programs.find(|(member, _)| member.key.eq_ignore_ascii_case(name))?;
        let files = program.get("st")?.texts();
        let files: Vec<_> = files
            .filter_map(|inner| self.documents.beside(path, inner).ok())
            .collect();
        Some(Project::new(self.documents, &files, self.dialect))
    }

    /// All signals. For those of programs, the programs are compiled.
    pub(crate) fn signals(&self) -> Vec<Signal> {
        let mut found = Vec::new();
        for entity in &self.entities {
            let name = &entity.name;
            match entity.kind {
                Kind::Axis => found.extend(AXIS_SIGNALS.iter().map(|(signal, ty, doc)| Signal {
                    name: format!("{name}.{signal}"),
                    detail: (*ty).to_owned(),
                    doc: (*doc).to_owned(),
                    settable: false,
                })),
                Kind::Input => found.push(Signal {
                    name: name.clone(),
                    detail: "input".to_owned(),
                    doc: String::new(),
                    settable: true,
                }),
                Kind::Block(info) => {
                    let pins = info.into_iter().flat_map(BlockInfo::pins);
                    found.extend(pins.map(|pin| Signal {
                        name: format!("{name}.{}", pin.name),
                        detail: pin.ty.iec_name().to_owned(),
                        doc: pin_doc(pin),
                        settable: pin.direction == standstill_fb::Direction::Input,
                    }));
                }
                Kind::Program => found.extend(self.variables(name)),
                Kind::Task | Kind::Parameter => {}
            }
        }
        found
    }

    /// The variables of a program, if it can be compiled.
    fn variables(&self, name: &str) -> Vec<Signal> {
        let Some(project) = self.project(name) else {
            return Vec::new();
        };
        let program = self.files[0].2.get("programs").and_then(|it| it.get(name));
        let options = Options {
            program: program
                .and_then(|it| it.get("program"))
                .and_then(Node::as_text)
                .map(str::to_owned),
            dialect: self.dialect.clone(),
            ..Options::default()
        };
        let Ok(compiled) = standstill_st::compile(&project.sources(), &options) else {
            return Vec::new();
        };
        let leaves = compiled.symbols.leaves(VARIABLES_MOST).into_iter();
        let signal = |it: standstill_st::Symbol| Signal {
            name: format!("{name}.{}", compiled.symbols.short(&it.path)),
            settable: it.is_settable(),
            detail: it.type_name,
            doc: String::new(),
        };
        leaves.map(signal).collect()
    }

    /// The information about a signal, or about the name of an axis, an input or similar.
    pub(crate) fn told(&self, path: &str) -> Option<Told> {
        let (name, rest) = path
            .split_once('.')
            .map_or((path, None), |(name, rest)| (name, Some(rest)));
        let entity = self
            .entities
            .iter()
            .find(|it| it.name.eq_ignore_ascii_case(name))?;
        let declared = self.location(entity);
        let told = |text: String, doc: &str| Told {
            text,
            doc: doc.to_owned(),
            declared: declared.clone(),
        };
        let plain = |what: &str| told(format!("{}  // {what}", entity.name), "");
        Some(match (entity.kind, rest) {
            (Kind::Axis, None) => told(format!("{} : AXIS_REF", entity.name), ""),
            (Kind::Axis, Some(signal)) => {
                let (signal, ty, doc) = AXIS_SIGNALS
                    .iter()
                    .find(|(it, ..)| it.eq_ignore_ascii_case(signal))?;
                told(format!("{}.{signal} : {ty}", entity.name), doc)
            }
            (Kind::Input, _) => plain("input of the script"),
            (Kind::Task, _) => plain("task"),
            (Kind::Parameter, _) => plain("parameter of the script"),
            (Kind::Block(info), None) => {
                let ty = info.map_or("?", |info| info.name);
                let doc = info.map_or("", |info| info.doc);
                told(format!("{} : {ty}", entity.name), doc)
            }
            (Kind::Block(info), Some(pin)) => {
                let info = info?;
                let pin = info.pins().find(|it| it.name.eq_ignore_ascii_case(pin))?;
                told(
                    format!("{}.{} : {}", entity.name, pin.name, pin.ty.iec_name()),
                    &pin_doc(pin),
                )
            }
            (Kind::Program, None) => plain("program"),
            (Kind::Program, Some(path)) => return self.told_of_variable(&entity.name, path),
        })
    }

    fn told_of_variable(&self, program: &str, path: &str) -> Option<Told> {
        let project = self.project(program)?;
        let (sources, found) = variable(&project.sources(), project.options(), path);
        let Hover {
            text, doc, declared, ..
        } = found?;
        Some(Told {
            text,
            doc,
            declared: declared.and_then(|span| project.location(&sources, span)),
        })
    }
}

/// The description of a pin in the table of blocks.
fn pin_doc(pin: &Pin) -> String {
    match pin.unit {
        "" => pin.doc.to_owned(),
        unit => format!("{} ({unit})", pin.doc),
    }
}

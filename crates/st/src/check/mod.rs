//! From the syntax tree to the checked program: names, types, constants, calls.

mod address;
mod body;
mod call;
mod chain;
mod complete;
mod configuration;
mod constant;
mod convert;
mod declare;
mod expression;
mod graph;
mod library_call;
mod look;
mod path;
mod spec;
mod start;
mod statement;
mod text;
mod unit;

use crate::error::{Code, DIAGNOSTICS_MOST, Diagnostic, Found, did_you_mean};
use crate::layout::Layout;
use crate::library::blocks;
use crate::source::{Sources, Span};
use crate::syntax::{Initial, Item, TypeDeclaration, TypeSpec, Unit};
use crate::typed::Stmt;
use crate::types::{Constant, Member, Members, TypeId, Types, UnitId};
use crate::{Options, parse::NESTING_MOST};
use standstill_fb::BlockInfo;
use std::collections::{BTreeMap, BTreeSet};

pub(crate) use configuration::{Instance, Task};
pub(crate) use look::Look;

/// The units that can be called or instantiated.
#[derive(Clone, Copy, Debug)]
pub(crate) enum UnitKind {
    Function,
    /// Of the block that [`UnitInfo::owner`] names.
    Method,
    Block,
    Program,
    Library(&'static BlockInfo),
}

impl UnitKind {
    /// Whether its variables are created at every call, and so have an address of their own.
    pub(crate) const fn has_frame(self) -> bool {
        matches!(self, Self::Function | Self::Method)
    }
}

impl PartialEq for UnitKind {
    fn eq(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Library(one), Self::Library(other)) => one.name == other.name,
            _ => std::mem::discriminant(self) == std::mem::discriminant(other),
        }
    }
}

#[derive(Debug)]
pub(crate) struct UnitInfo<'a> {
    pub kind: UnitKind,
    pub name: String,
    pub span: Span,
    syntax: Option<&'a Unit>,
    /// The block that a method belongs to.
    pub owner: Option<UnitId>,
    state: State,
    pub members: Members,
    /// The member that is the value of a function.
    pub result: Option<usize>,
    /// The address of a function's variables.
    pub frame: u32,
}

/// The state of an item whose resolution may need others first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum State {
    Todo,
    Busy,
    Done,
}

#[derive(Debug)]
struct NamedType<'a> {
    syntax: &'a TypeDeclaration,
    state: State,
    found: (TypeId, crate::types::Start),
}

#[derive(Debug)]
pub(crate) struct Global<'a> {
    pub member: Member,
    /// Absent for the instance of a PROGRAM, whose type is known.
    spec: Option<&'a TypeSpec>,
    initial: Option<&'a Initial>,
    /// The list that it is in: the name of its file. None for the instance of a PROGRAM.
    pub list: Option<&'a str>,
    /// Whether another list has its name, too, so that only `List.name` is clear.
    is_shared: bool,
    state: State,
}

impl Global<'_> {
    /// Its name, with that of its list if another one has it, too.
    pub(crate) fn path(&self) -> String {
        match self.list {
            Some(list) if self.is_shared => format!("{list}.{}", self.member.name),
            _ => self.member.name.clone(),
        }
    }

    pub(crate) fn is_in(&self, list: &str) -> bool {
        self.list.is_some_and(|own| own.eq_ignore_ascii_case(list))
    }
}

/// How a constant is known: in its unit, or as a global variable.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum ConstantKey {
    OfUnit(UnitId, String),
    Global(usize),
}

/// A constant of a unit or of the project.
#[derive(Debug)]
struct ConstantEntry<'a> {
    spec: &'a TypeSpec,
    initial: Option<&'a Initial>,
    state: State,
    value: Option<(TypeId, Constant)>,
}

/// Levels of an expression that a nested declaration counts as, because of its use of the stack.
const NEED: usize = 4;

/// The enumeration that has an element.
#[derive(Clone, Debug, PartialEq, Eq)]
enum ElementOf {
    Named(String),
    Known(TypeId),
}

/// An instance of a PROGRAM.
#[derive(Debug)]
struct Running {
    /// In upper case.
    name: String,
    unit: UnitId,
    address: u32,
}

/// A unit's statements, checked.
#[derive(Debug)]
pub(crate) struct Body {
    pub unit: UnitId,
    pub statements: Vec<Stmt>,
    /// Variables that each call initializes: VAR_TEMP, and all variables of a function.
    pub fresh: Vec<usize>,
}

/// The checked program.
#[derive(Debug)]
pub(crate) struct Program<'a> {
    pub types: Types,
    pub units: Vec<UnitInfo<'a>>,
    pub globals: Vec<Global<'a>>,
    pub bodies: Vec<Body>,
    pub instances: Vec<Instance<'a>>,
    pub tasks: Vec<Task>,
    /// Whether a CONFIGURATION selects the programs that run.
    pub is_configured: bool,
    pub layout: Layout,
}

impl<'a> Program<'a> {
    pub(crate) fn unit(&self, id: UnitId) -> &UnitInfo<'a> {
        &self.units[id.0 as usize]
    }

    /// Bytes of a type.
    pub(crate) fn size(&self, ty: TypeId) -> u32 {
        self.types.size(ty, |unit| self.unit(unit).members.size).0
    }
}

pub(crate) struct Checker<'a> {
    sources: &'a Sources,
    is_configured: bool,
    options: &'a Options,
    pub(crate) found: Found,
    types: Types,
    /// Of the library, in upper case.
    library_types: BTreeMap<String, TypeId>,
    named: BTreeMap<String, NamedType<'a>>,
    units: Vec<UnitInfo<'a>>,
    unit_names: BTreeMap<String, UnitId>,
    /// By block and name.
    methods: BTreeMap<(UnitId, String), UnitId>,
    globals: Vec<Global<'a>>,
    /// The global variables of a name, in upper case: at most one of each list.
    global_names: BTreeMap<String, Vec<usize>>,
    /// Names at the top of files that are refused or could not be read, in upper case.
    damaged: BTreeSet<String>,
    /// Names that nothing has, in upper case: of variables in a unit, others in the project.
    unknown: BTreeSet<(Option<UnitId>, String)>,
    /// Whether further such names are not known.
    names_lost: bool,
    constants: BTreeMap<ConstantKey, ConstantEntry<'a>>,
    elements: BTreeMap<String, Vec<ElementOf>>,
    layout: Layout,
    /// The unit whose names are visible.
    scope: Option<UnitId>,
    depth: usize,
    body: body::BodyState,
    edges: BTreeMap<UnitId, BTreeMap<UnitId, Span>>,
    /// The units whose statements write a variable, and one place of each.
    writers: BTreeMap<body::Variable, BTreeMap<UnitId, Span>>,
    loop_calls: Vec<body::LoopCall>,
    look: Look,
    /// The instances of programs that tasks run.
    running: Vec<Running>,
}

/// Checks a project. There is a program if it has no mistakes.
pub(crate) fn check<'a>(
    sources: &'a Sources,
    items: &'a [Item],
    options: &'a Options,
    found: Found,
) -> (Option<Program<'a>>, Found) {
    let (checker, tasks, instances, bodies) = checked(sources, items, options, found, Look::default());
    let Checker {
        found,
        types,
        units,
        globals,
        layout,
        is_configured,
        ..
    } = checker;
    if found.has_errors() {
        return (None, found);
    }
    let program = Program {
        types,
        units,
        globals,
        bodies,
        instances,
        tasks,
        is_configured,
        layout,
    };
    (Some(program), found)
}

/// Checks a project for an editor's question about one place in it.
pub(crate) fn look<'a>(
    sources: &'a Sources,
    items: &'a [Item],
    options: &'a Options,
    look: Look,
) -> Checker<'a> {
    let (checker, ..) = checked(sources, items, options, Found::default(), look);
    checker
}

type Checked<'a> = (Checker<'a>, Vec<Task>, Vec<Instance<'a>>, Vec<Body>);

fn checked<'a>(
    sources: &'a Sources,
    items: &'a [Item],
    options: &'a Options,
    found: Found,
    look: Look,
) -> Checked<'a> {
    let mut types = Types::new();
    let library_types = blocks::types(&mut types);
    let mut checker = Checker {
        sources,
        options,
        is_configured: false,
        found,
        types,
        library_types,
        named: BTreeMap::new(),
        units: Vec::new(),
        unit_names: BTreeMap::new(),
        methods: BTreeMap::new(),
        globals: Vec::new(),
        global_names: BTreeMap::new(),
        damaged: BTreeSet::new(),
        unknown: BTreeSet::new(),
        names_lost: false,
        constants: BTreeMap::new(),
        elements: BTreeMap::new(),
        layout: Layout::default(),
        scope: None,
        depth: 0,
        body: body::BodyState::default(),
        edges: BTreeMap::new(),
        writers: BTreeMap::new(),
        loop_calls: Vec::new(),
        look,
        running: Vec::new(),
    };
    checker.declare(items);
    checker.resolve();
    let (mut tasks, mut instances) = checker.configuration(items);
    checker.place_all(&mut tasks, &mut instances);
    let running = instances.iter().map(|instance| Running {
        name: instance.name.to_ascii_uppercase(),
        unit: instance.unit,
        address: instance.address,
    });
    checker.running = running.collect();
    let bodies = checker.bodies();
    checker.run(&mut tasks, &instances);
    checker.check_calls();
    checker.check_loops();
    checker.check_addresses();
    (checker, tasks, instances, bodies)
}

impl<'a> Checker<'a> {
    fn tell(&mut self, diagnostic: Diagnostic) {
        self.found.add(diagnostic);
    }

    fn error(&mut self, code: Code, span: Span, message: impl Into<String>, help: &str) {
        let mut wrong = Diagnostic::error(code, span, message);
        if !help.is_empty() {
            wrong = wrong.help(help);
        }
        self.found.add(wrong);
    }

    /// The name that was probably meant. The search is slow, so it is done only for messages that are shown.
    fn guess<'n>(&self, name: &str, candidates: impl Iterator<Item = &'n str>) -> Option<String> {
        if self.found.shown() >= DIAGNOSTICS_MOST {
            return None;
        }
        did_you_mean(name, candidates)
    }

    /// The global variables as declared, for guesses.
    fn declared_globals(&self) -> impl Iterator<Item = &str> {
        self.globals.iter().map(|global| global.member.name.as_str())
    }

    /// The units that are called by their names as declared, for guesses.
    fn declared_units(&self) -> impl Iterator<Item = &str> {
        let units = self.units.iter().filter(|unit| unit.owner.is_none());
        units.map(|unit| unit.name.as_str())
    }

    /// Whether a name at the top of a file may be one whose declaration has been reported.
    fn may_be_damaged(&self, key: &str) -> bool {
        self.names_lost || self.damaged.contains(key)
    }

    /// Whether an unknown name in statements may be one whose declaration has been reported.
    fn may_be_lost(&self, key: &str) -> bool {
        let block = self.scope.and_then(|unit| self.unit(unit).owner);
        let mut units = [self.scope, block].into_iter().flatten();
        self.may_be_damaged(key) || units.any(|unit| self.is_damaged(unit))
    }

    /// Whether an unknown name is one that was not reported before: all uses of one that is misspelt where it is
    /// declared are one mistake.
    fn is_news(&mut self, scope: Option<UnitId>, key: &str) -> bool {
        self.unknown.insert((scope, key.to_owned()))
    }

    /// Whether a unit has variables that are not known.
    fn is_damaged(&self, unit: UnitId) -> bool {
        self.unit(unit).syntax.is_some_and(|syntax| syntax.damaged)
    }

    fn unit(&self, id: UnitId) -> &UnitInfo<'a> {
        &self.units[id.0 as usize]
    }

    fn unit_mut(&mut self, id: UnitId) -> &mut UnitInfo<'a> {
        &mut self.units[id.0 as usize]
    }

    /// Resolves an item that another one needs first, unless the chain of such items is too long.
    fn needing<T>(&mut self, span: Span, other: T, inner: impl FnOnce(&mut Self) -> T) -> T {
        if self.depth + NEED >= NESTING_MOST {
            let most = NESTING_MOST / NEED;
            let message = format!("this needs more than {most} other declarations one through another");
            self.error(Code::TooDeep, span, message, "declare with fewer steps between");
            return other;
        }
        self.depth += NEED;
        let result = inner(self);
        self.depth -= NEED;
        result
    }

    /// Runs `inner` with the names of a unit visible.
    fn in_scope<T>(&mut self, scope: Option<UnitId>, inner: impl FnOnce(&mut Self) -> T) -> T {
        let before = std::mem::replace(&mut self.scope, scope);
        let result = inner(self);
        self.scope = before;
        result
    }

    /// Bytes and alignment of a type.
    fn size(&self, ty: TypeId) -> (u32, u32) {
        self.types.size(ty, |unit| self.unit(unit).members.size)
    }

    /// The name of a type in messages.
    fn type_name(&self, ty: TypeId) -> String {
        use crate::types::Type;
        match self.types.get(ty) {
            Type::Elementary(it) => it.name().to_owned(),
            Type::Enumeration(it) => it.name.clone(),
            Type::Subrange { name, .. } => name.clone(),
            Type::Text(capacity) => format!("STRING[{capacity}]"),
            Type::Structure(it) => it.name.clone(),
            Type::Array(it) => {
                let bounds: Vec<_> = it
                    .bounds
                    .iter()
                    .map(|(low, high)| format!("{low}..{high}"))
                    .collect();
                format!("ARRAY [{}] OF {}", bounds.join(", "), self.type_name(it.of))
            }
            Type::Block(unit) => self.unit(*unit).name.clone(),
            Type::AnyInteger => "a whole number".to_owned(),
            Type::AnyReal => "a number with a point".to_owned(),
            Type::Wrong => "?".to_owned(),
        }
    }
}

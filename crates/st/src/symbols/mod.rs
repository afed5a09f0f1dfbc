//! The addresses of a module's variables, and the place in the text of a fault.

mod bind;
mod columns;
mod writers;

pub(crate) use bind::bind;
pub use columns::BlockAt;
pub use writers::Writer;

use crate::check::{Program, UnitKind};
use crate::coverage::Counter;
use crate::emit::{FaultKind, Site};
use crate::source::{Position, Sources, Span};
use crate::start;
use crate::types::{Array, Elementary, Member, MemberKind, Members, Type, TypeId, Types};
use standstill_fb::BlockInfo;

/// The use of a variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Section {
    /// VAR_GLOBAL.
    Global,
    /// VAR_INPUT.
    Input,
    /// VAR_OUTPUT.
    Output,
    /// VAR, VAR_TEMP, and members of structures.
    Internal,
}

/// The meaning of the number in a variable.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Value {
    /// The number itself.
    Plain,
    /// An element of an enumeration: names and numbers.
    Element(Vec<(String, i128)>),
    /// The number itself, from the first to the last of a subrange.
    Range(i128, i128),
}

/// A variable, or a part of one, that has an elementary type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// Its path, as declared: `cell.Units[1].Done`.
    pub path: String,
    /// Its representation in memory.
    pub ty: Elementary,
    /// The name of its type in the sources.
    pub type_name: String,
    /// Its address.
    pub address: u32,
    /// Its use.
    pub section: Section,
    /// `%IX0.0`, if it is declared AT one.
    pub at: Option<String>,
    /// Whether it is declared RETAIN or PERSISTENT.
    pub retain: bool,
    /// Whether it is declared CONSTANT.
    pub constant: bool,
    /// The meaning of its numbers.
    pub value: Value,
}

impl Symbol {
    /// Whether a host may set it: an input, a global variable that is no CONSTANT, or one AT an address.
    #[must_use]
    pub fn is_settable(&self) -> bool {
        match self.section {
            Section::Input => true,
            Section::Global => !self.constant,
            Section::Output | Section::Internal => self.at.is_some(),
        }
    }
}

/// A place in the sources.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file, as it was given.
    pub file: String,
    /// Line and column.
    pub position: Position,
    /// The fault that can happen there.
    pub kind: FaultKind,
}

/// A task of a CONFIGURATION, or the programs that have none.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Task {
    /// Its name; empty for the programs without a task.
    pub name: String,
    /// The function that the module exports to run it alone: `plc_task_` and its name in upper case.
    pub entry: String,
    /// Time from one run to the next (ns); in every scan if absent.
    pub interval_ns: Option<i64>,
    /// Priority; 0 is the highest.
    pub priority: i64,
}

#[derive(Clone, Debug)]
struct Unit {
    members: Members,
    /// The block, if it is one of the library.
    library: Option<&'static BlockInfo>,
}

#[derive(Clone, Debug)]
struct Root {
    /// A variable, or an instance of a program.
    member: Member,
    address: u32,
    section: Section,
    instance: bool,
    /// Its name; of a global variable whose name another list has, too, with that of its list.
    path: String,
    /// The name of its file, of a global variable.
    list: String,
}

/// The variables of a module by their paths, and its places.
#[derive(Debug, Clone)]
pub struct Symbols {
    types: std::sync::Arc<Types>,
    units: Vec<Unit>,
    roots: Vec<Root>,
    places: Vec<Place>,
    counters: Vec<Counter>,
    tasks: Vec<Task>,
    is_configured: bool,
    writes: Vec<writers::Write>,
}

/// A part of a variable while a path is followed.
#[derive(Clone)]
struct Part {
    path: String,
    ty: TypeId,
    address: u32,
    section: Section,
    retain: bool,
    constant: bool,
    at: Option<String>,
}

impl Symbols {
    pub(crate) fn new(
        program: Program<'_>,
        sites: Vec<Site>,
        counters: Vec<Counter>,
        sources: &Sources,
    ) -> Self {
        let places = sites.into_iter().map(|site| Place {
            file: sources.file_name(site.span).to_owned(),
            position: sources.position(site.span.start),
            kind: site.kind,
        });
        let places = places.collect();
        let writes = writers::writes(&program, sources);
        let globals = program.globals.iter().map(|global| Root {
            address: global.member.offset,
            member: global.member.clone(),
            section: Section::Global,
            instance: false,
            path: global.path(),
            list: global.list.unwrap_or_default().to_owned(),
        });
        let mut roots: Vec<Root> = globals.collect();
        let mut types = program.types;
        roots.extend(program.instances.iter().map(|instance| {
            let ty = types.shared(Type::Block(instance.unit));
            Root {
                member: Member::new(&instance.name, ty, MemberKind::Var, Span::default()),
                address: instance.address,
                section: Section::Internal,
                instance: true,
                path: instance.name.clone(),
                list: String::new(),
            }
        }));
        let tasks = program.tasks.iter().map(|task| Task {
            name: task.name.clone(),
            entry: entry(&task.name),
            interval_ns: task.interval_ns,
            priority: task.priority,
        });
        let units = program.units.into_iter().map(|unit| Unit {
            library: match unit.kind {
                UnitKind::Library(info) => Some(info),
                _ => None,
            },
            members: unit.members,
        });
        Self {
            tasks: tasks.collect(),
            is_configured: program.is_configured,
            units: units.collect(),
            types: std::sync::Arc::new(types),
            roots,
            places,
            counters,
            writes,
        }
    }

    /// Whether a CONFIGURATION selects the programs that run.
    #[must_use]
    pub const fn is_configured(&self) -> bool {
        self.is_configured
    }

    /// The tasks of the CONFIGURATION. Its programs without a task are in a task without a name. Without a
    /// CONFIGURATION this is the only task.
    #[must_use]
    pub fn tasks(&self) -> &[Task] {
        &self.tasks
    }

    /// The counters of statements and branches; none unless
    /// [`Options::coverage`](crate::Options::coverage) is set.
    #[must_use]
    pub fn counters(&self) -> &[Counter] {
        &self.counters
    }

    /// The places of faults and loops; number 1 is the first one.
    #[must_use]
    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// The place with the number at [`FAULT_SITE`](crate::FAULT_SITE) or [`LOOP_SITE`](crate::LOOP_SITE);
    /// `None` for 0.
    #[must_use]
    pub fn place(&self, number: u32) -> Option<&Place> {
        self.places.get((number as usize).checked_sub(1)?)
    }

    /// The variable with this path, without regard to case: `global`, `instance.variable`, and `variable` if there
    /// is one instance of a program. A global variable hides a local one; it is also found by the name of its file,
    /// `GVL.global`, and only so if several files have its name. `%IX0.0` finds the variable AT that address.
    #[must_use]
    pub fn find(&self, path: &str) -> Option<Symbol> {
        if path.starts_with('%') {
            let at = |symbol: &Symbol| {
                symbol
                    .at
                    .as_deref()
                    .is_some_and(|at| at.eq_ignore_ascii_case(path))
            };
            return self.leaves(usize::MAX).into_iter().find(at);
        }
        self.symbol(&self.part(path)?)
    }

    /// The part at a path.
    fn part(&self, path: &str) -> Option<Part> {
        self.follow(path, |_| ())
    }

    /// The part at a path; `visit` gets each part on the way, from the outside in, and the last one.
    fn follow(&self, path: &str, mut visit: impl FnMut(&Part)) -> Option<Part> {
        let mut rest = path;
        let name = next_name(&mut rest)?;
        let named = |root: &&Root| root.path.eq_ignore_ascii_case(name);
        let of_instance = || self.member(&self.root(self.only_instance()?), name);
        let found = self.roots.iter().find(named).map(|root| self.root(root));
        let mut part = match found.or_else(of_instance) {
            Some(part) => part,
            None => self.listed(name, &mut rest)?,
        };
        visit(&part);
        while !rest.is_empty() {
            part = if let Some(behind) = rest.strip_prefix('.') {
                rest = behind;
                let name = next_name(&mut rest)?;
                self.member(&part, name)?
            } else {
                let (inner, behind) = rest.strip_prefix('[')?.split_once(']')?;
                rest = behind;
                self.element(&part, inner)?
            };
            visit(&part);
        }
        Some(part)
    }

    /// A global variable by the name of its file and its own, which is taken from the rest of the path.
    fn listed(&self, list: &str, rest: &mut &str) -> Option<Part> {
        *rest = rest.strip_prefix('.')?;
        let name = next_name(rest)?;
        let mut globals = self.roots.iter().filter(|root| root.section == Section::Global);
        let root = globals.find(|root| {
            root.list.eq_ignore_ascii_case(list) && root.member.name.eq_ignore_ascii_case(name)
        })?;
        Some(self.root(root))
    }

    /// The instance of a program, if there is only one.
    fn only_instance(&self) -> Option<&Root> {
        let mut instances = self.roots.iter().filter(|root| root.instance);
        let (only, None) = (instances.next()?, instances.next()) else {
            return None;
        };
        Some(only)
    }

    /// All variables of elementary types, at most `most`, in the order of memory.
    #[must_use]
    pub fn leaves(&self, most: usize) -> Vec<Symbol> {
        let mut found = Vec::new();
        for root in &self.roots {
            self.search(&self.root(root), columns::Wanted::All, most, &mut found);
        }
        found
    }

    fn root(&self, root: &Root) -> Part {
        Part {
            path: root.path.clone(),
            ty: root.member.ty,
            address: root.address,
            section: root.section,
            retain: root.member.retain,
            constant: root.member.constant,
            at: root.member.address.clone(),
        }
    }

    fn members(&self, ty: TypeId) -> Option<&Members> {
        match self.types.get(ty) {
            Type::Structure(structure) => Some(&structure.members),
            Type::Block(unit) => self.units.get(unit.0 as usize).map(|unit| &unit.members),
            _ => None,
        }
    }

    fn part_of(&self, of: &Part, member: &Member) -> Option<Part> {
        let section = match member.kind {
            MemberKind::InOut | MemberKind::External(_) => return None,
            MemberKind::Input => Section::Input,
            MemberKind::Output => Section::Output,
            MemberKind::Field => of.section,
            _ => Section::Internal,
        };
        Some(Part {
            path: format!("{}.{}", of.path, member.name),
            ty: member.ty,
            address: of.address + member.offset,
            section,
            retain: of.retain || member.retain,
            constant: of.constant || member.constant,
            at: member.address.clone(),
        })
    }

    fn member(&self, of: &Part, name: &str) -> Option<Part> {
        let (_, member) = self.members(of.ty)?.find(&name.to_ascii_uppercase())?;
        self.part_of(of, member)
    }

    fn element(&self, of: &Part, indices: &str) -> Option<Part> {
        let Type::Array(array) = self.types.get(of.ty) else {
            return None;
        };
        let given: Vec<i64> = indices
            .split(',')
            .map(|index| index.trim().parse().ok())
            .collect::<Option<_>>()?;
        if given.len() != array.bounds.len() {
            return None;
        }
        let mut number = 0;
        for (index, (low, high)) in given.iter().zip(&array.bounds) {
            if index < low || index > high {
                return None;
            }
            number = number * (high - low + 1) + (index - low);
        }
        Some(Self::element_at(of, array, &given, number as u32))
    }

    /// The element with these indices, which is this one in memory.
    fn element_at(of: &Part, array: &Array, indices: &[i64], number: u32) -> Part {
        let shown: Vec<_> = indices.iter().map(ToString::to_string).collect();
        Part {
            path: format!("{}[{}]", of.path, shown.join(", ")),
            ty: array.of,
            address: of.address + number * array.stride,
            section: of.section,
            retain: of.retain,
            constant: of.constant,
            at: None,
        }
    }

    fn symbol(&self, part: &Part) -> Option<Symbol> {
        let ty = self.types.elementary(part.ty)?;
        let (type_name, value) = match self.types.get(part.ty) {
            Type::Enumeration(of) => (of.name.clone(), Value::Element(of.elements.clone())),
            Type::Subrange { name, low, high, .. } => (name.clone(), Value::Range(*low, *high)),
            _ => (ty.name().to_owned(), Value::Plain),
        };
        Some(Symbol {
            path: part.path.clone(),
            ty,
            type_name,
            address: part.address,
            section: part.section,
            retain: part.retain,
            constant: part.constant,
            at: part.at.clone(),
            value,
        })
    }
}

/// The function that a module exports to run a task alone.
pub(crate) fn entry(task: &str) -> String {
    format!("plc_task_{}", task.to_ascii_uppercase())
}

/// Takes the next name of a path.
fn next_name<'p>(rest: &mut &'p str) -> Option<&'p str> {
    let end = rest.find(['.', '[']).unwrap_or(rest.len());
    let (name, behind) = rest.split_at(end);
    *rest = behind;
    (!name.is_empty()).then_some(name)
}

/// Writes the contents of the memory before the first scan.
pub(crate) fn image(program: &Program<'_>, memory: &mut [u8]) {
    for global in &program.globals {
        start::write(
            program,
            global.member.ty,
            &global.member.start,
            memory,
            global.member.offset,
        );
    }
    for instance in &program.instances {
        start::members_of(program, instance.unit, memory, instance.address);
    }
}

//! Where the variables of a module stand, and which place in the text a fault means.

use crate::Options;
use crate::check::{Instance, Program, UnitKind};
use crate::emit::{FaultKind, Site};
use crate::error::{Code, Diagnostic};
use crate::source::{Position, Sources, Span};
use crate::start;
use crate::types::{Elementary, Member, MemberKind, Members, Start, Type, TypeId, Types};

/// What a variable is for.
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

/// What the number in a variable means.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Value {
    /// Itself.
    Plain,
    /// An element of an enumeration: names and numbers.
    Element(Vec<(String, i128)>),
}

/// A variable, or a part of one, that has an elementary type.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Symbol {
    /// Its path, as declared: `cell.Units[1].Done`.
    pub path: String,
    /// How it stands in memory.
    pub ty: Elementary,
    /// What its type is called in the sources.
    pub type_name: String,
    /// Where it stands.
    pub address: u32,
    /// What it is for.
    pub section: Section,
    /// `%IX0.0`, if it is declared AT one.
    pub at: Option<String>,
    /// Whether it is declared RETAIN or PERSISTENT.
    pub retain: bool,
    /// What its numbers mean.
    pub value: Value,
}

/// A place in the sources.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file, as it was given.
    pub file: String,
    /// Line and column.
    pub position: Position,
    /// What can happen there.
    pub kind: FaultKind,
}

/// A task of a CONFIGURATION; the module exports `plc_task_` and its name in upper case, which runs it alone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Task {
    /// Its name.
    pub name: String,
    /// Time from one run to the next (ns); in every scan if absent.
    pub interval_ns: Option<i64>,
    /// 0 comes first.
    pub priority: i64,
}

#[derive(Clone, Debug)]
struct Unit {
    name: String,
    members: Members,
}

#[derive(Clone, Debug)]
struct Root {
    /// A variable, or an instance of a program.
    member: Member,
    address: u32,
    section: Section,
    instance: bool,
}

/// The variables of a module by their paths, and its places.
#[derive(Debug, Clone)]
pub struct Symbols {
    types: std::sync::Arc<Types>,
    units: Vec<Unit>,
    roots: Vec<Root>,
    places: Vec<Place>,
    tasks: Vec<Task>,
}

/// A part of a variable while a path is followed.
#[derive(Clone)]
struct Part {
    path: String,
    ty: TypeId,
    address: u32,
    section: Section,
    retain: bool,
    at: Option<String>,
}

impl Symbols {
    pub(crate) fn new(program: Program<'_>, sites: Vec<Site>, sources: &Sources) -> Self {
        let places = sites.into_iter().map(|site| Place {
            file: sources.file_name(site.span).to_owned(),
            position: sources.position(site.span.start),
            kind: site.kind,
        });
        let places = places.collect();
        let globals = program.globals.iter().map(|global| Root {
            address: global.member.offset,
            member: global.member.clone(),
            section: Section::Global,
            instance: false,
        });
        let mut roots: Vec<Root> = globals.collect();
        let mut types = program.types;
        roots.extend(program.instances.iter().map(|instance| Root {
            member: instance_member(instance, types.shared(Type::Block(instance.unit))),
            address: instance.address,
            section: Section::Internal,
            instance: true,
        }));
        let tasks = program
            .tasks
            .iter()
            .filter(|task| !task.name.is_empty())
            .map(|task| Task {
                name: task.name.clone(),
                interval_ns: task.interval_ns,
                priority: task.priority,
            });
        let units = program.units.into_iter().map(|unit| Unit {
            name: unit.name,
            members: unit.members,
        });
        Self {
            tasks: tasks.collect(),
            units: units.collect(),
            types: std::sync::Arc::new(types),
            roots,
            places,
        }
    }

    /// The tasks of the CONFIGURATION; none if there is none.
    #[must_use]
    pub fn tasks(&self) -> &[Task] {
        &self.tasks
    }

    /// The places of faults and loops; number 1 is the first one.
    #[must_use]
    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// The place with the number that stands at [`FAULT_SITE`](crate::FAULT_SITE) or
    /// [`LOOP_SITE`](crate::LOOP_SITE); `None` for 0.
    #[must_use]
    pub fn place(&self, number: u32) -> Option<&Place> {
        self.places.get((number as usize).checked_sub(1)?)
    }

    /// The variable with this path, without regard to case: `global`, `instance.variable`, and `variable` where there
    /// is one instance of a program. A global variable hides a local one. `%IX0.0` finds the variable AT that address.
    #[must_use]
    pub fn find(&self, path: &str) -> Option<Symbol> {
        let mut rest = path;
        if path.starts_with('%') {
            return self.leaves(usize::MAX).into_iter().find(|symbol| {
                symbol
                    .at
                    .as_deref()
                    .is_some_and(|at| at.eq_ignore_ascii_case(path))
            });
        }
        let name = next_name(&mut rest)?;
        let named = |root: &&Root| root.member.name.eq_ignore_ascii_case(name);
        let mut part = match self.roots.iter().find(named) {
            Some(root) => self.root(root),
            None => {
                let mut instances = self.roots.iter().filter(|root| root.instance);
                let (only, None) = (instances.next()?, instances.next()) else {
                    return None;
                };
                self.member(&self.root(only), name)?
            }
        };
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
        }
        self.symbol(&part)
    }

    /// All variables of elementary types, at most so many, in the order of memory.
    #[must_use]
    pub fn leaves(&self, most: usize) -> Vec<Symbol> {
        let mut found = Vec::new();
        for root in &self.roots {
            self.collect(&self.root(root), most, &mut found);
        }
        found
    }

    fn root(&self, root: &Root) -> Part {
        Part {
            path: root.member.name.clone(),
            ty: root.member.ty,
            address: root.address,
            section: root.section,
            retain: root.member.retain,
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
            MemberKind::Field if of.section != Section::Global => of.section,
            _ => Section::Internal,
        };
        Some(Part {
            path: format!("{}.{}", of.path, member.name),
            ty: member.ty,
            address: of.address + member.offset,
            section,
            retain: of.retain || member.retain,
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
        let shown: Vec<_> = given.iter().map(ToString::to_string).collect();
        Some(Part {
            path: format!("{}[{}]", of.path, shown.join(", ")),
            ty: array.of,
            address: of.address + number as u32 * array.stride,
            section: of.section,
            retain: of.retain,
            at: None,
        })
    }

    fn symbol(&self, part: &Part) -> Option<Symbol> {
        let ty = self.types.elementary(part.ty)?;
        let (type_name, value) = match self.types.get(part.ty) {
            Type::Enumeration(of) => (of.name.clone(), Value::Element(of.elements.clone())),
            Type::Subrange { name, .. } => (name.clone(), Value::Plain),
            _ => (ty.name().to_owned(), Value::Plain),
        };
        Some(Symbol {
            path: part.path.clone(),
            ty,
            type_name,
            address: part.address,
            section: part.section,
            retain: part.retain,
            at: part.at.clone(),
            value,
        })
    }

    fn collect(&self, part: &Part, most: usize, found: &mut Vec<Symbol>) {
        if found.len() >= most {
            return;
        }
        if let Some(symbol) = self.symbol(part) {
            found.push(symbol);
            return;
        }
        if let Some(members) = self.members(part.ty) {
            for part in members
                .list
                .iter()
                .filter_map(|member| self.part_of(part, member))
            {
                self.collect(&part, most, found);
            }
        }
        let Type::Array(array) = self.types.get(part.ty) else {
            return;
        };
        let mut indices: Vec<i64> = array.bounds.iter().map(|(low, _)| *low).collect();
        for number in 0..array.count {
            if found.len() >= most {
                return;
            }
            let shown: Vec<_> = indices.iter().map(ToString::to_string).collect();
            let element = Part {
                path: format!("{}[{}]", part.path, shown.join(", ")),
                ty: array.of,
                address: part.address + number * array.stride,
                section: part.section,
                retain: part.retain,
                at: None,
            };
            self.collect(&element, most, found);
            for (index, (low, high)) in indices.iter_mut().zip(&array.bounds).rev() {
                if *index < *high {
                    *index += 1;
                    break;
                }
                *index = *low;
            }
        }
    }

    /// The name of the function block a variable is an instance of.
    #[must_use]
    pub fn block_of(&self, path: &str) -> Option<&str> {
        let mut rest = path;
        let name = next_name(&mut rest)?;
        let root = self
            .roots
            .iter()
            .find(|root| root.member.name.eq_ignore_ascii_case(name))?;
        let mut part = self.root(root);
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
        }
        match self.types.get(part.ty) {
            Type::Block(unit) => self.units.get(unit.0 as usize).map(|unit| unit.name.as_str()),
            _ => None,
        }
    }
}

/// Takes the name a path goes on with.
fn next_name<'p>(rest: &mut &'p str) -> Option<&'p str> {
    let end = rest.find(['.', '[']).unwrap_or(rest.len());
    let (name, behind) = rest.split_at(end);
    *rest = behind;
    (!name.is_empty()).then_some(name)
}

fn instance_member(instance: &Instance<'_>, ty: TypeId) -> Member {
    Member {
        name: instance.name.clone(),
        ty,
        kind: MemberKind::Var,
        offset: 0,
        start: Start::Default,
        span: Span::default(),
        constant: false,
        retain: false,
        address: None,
    }
}

/// Writes what stands in memory before the first scan.
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

/// Writes which axis each variable of type AXIS_REF begins as.
pub(crate) fn bind(program: &Program<'_>, options: &Options, memory: &mut [u8]) -> Result<(), Diagnostic> {
    let mut found = Vec::new();
    for global in &program.globals {
        references(
            program,
            global.member.ty,
            &global.member.name,
            global.member.offset,
            &mut found,
        );
    }
    for instance in &program.instances {
        let members = &program.units[instance.unit.0 as usize].members;
        let path = &instance.name;
        member_references(program, &members.list, path, instance.address, &mut found);
    }
    for (path, _, address) in &found {
        let name = path.rsplit('.').next().unwrap_or(path);
        let axis = options
            .axes
            .iter()
            .position(|axis| axis.eq_ignore_ascii_case(name));
        if let Some(axis) = axis {
            put(memory, *address, axis as u32 + 1);
        }
    }
    let only = match program.instances.as_slice() {
        [one] => Some(one.name.as_str()),
        _ => None,
    };
    for (path, number) in &options.bindings {
        let within = only.map(|name| format!("{name}.{path}"));
        let same = |known: &str| {
            known.eq_ignore_ascii_case(path)
                || within.as_ref().is_some_and(|it| known.eq_ignore_ascii_case(it))
        };
        match found.iter().find(|(known, ..)| same(known)) {
            Some((.., address)) => put(memory, *address, (*number).into()),
            None => {
                let known = found.iter().map(|(path, ..)| path.as_str());
                let guess = crate::error::did_you_mean(path, known);
                let message = format!("there is no variable `{path}` of type AXIS_REF to bind to an axis");
                return Err(Diagnostic::error(Code::UnknownName, Span::default(), message).maybe_help(guess));
            }
        }
    }
    Ok(())
}

fn put(memory: &mut [u8], address: u32, number: u32) {
    let at = address as usize;
    if let Some(place) = memory.get_mut(at..at + 4) {
        place.copy_from_slice(&number.to_le_bytes());
    }
}

/// All variables of type AXIS_REF: path, type and address.
type References = Vec<(String, TypeId, u32)>;

fn references(program: &Program<'_>, ty: TypeId, path: &str, address: u32, found: &mut References) {
    /// More axes than any script has.
    const MOST: usize = 65_536;
    if found.len() >= MOST {
        return;
    }
    match program.types.get(ty) {
        Type::Structure(structure) if structure.name == "AXIS_REF" => {
            found.push((path.to_owned(), ty, address))
        }
        Type::Structure(structure) => {
            member_references(program, &structure.members.list, path, address, found)
        }
        Type::Block(unit) => {
            let unit = &program.units[unit.0 as usize];
            if !matches!(unit.kind, UnitKind::Library(_)) {
                member_references(program, &unit.members.list, path, address, found);
            }
        }
        Type::Array(array) if program.types.elementary(array.of).is_none() && array.bounds.len() == 1 => {
            let before = found.len();
            for number in 0..array.count {
                let index = array.bounds.first().map_or(0, |(low, _)| *low) + i64::from(number);
                references(
                    program,
                    array.of,
                    &format!("{path}[{index}]"),
                    address + number * array.stride,
                    found,
                );
                // What the first element does not have no other one has.
                if found.len() == before {
                    return;
                }
            }
        }
        _ => {}
    }
}

fn member_references(
    program: &Program<'_>,
    members: &[Member],
    path: &str,
    address: u32,
    found: &mut References,
) {
    for member in members {
        if !matches!(member.kind, MemberKind::InOut | MemberKind::External(_)) {
            let path = format!("{path}.{}", member.name);
            references(program, member.ty, &path, address + member.offset, found);
        }
    }
}

/// Names of elementary types that a guest's symbols have, too.
impl Elementary {
    /// The type by which the host of a guest reads it; `None` if no signal has 64 bits of that kind.
    #[must_use]
    pub const fn guest_type(self) -> Option<&'static str> {
        match self {
            Self::Lint | Self::Ulint | Self::Lword => None,
            Self::Ltime => Some("TIME"),
            other => Some(other.name()),
        }
    }
}

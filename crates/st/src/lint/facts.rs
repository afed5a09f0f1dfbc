//! The uses of a program's variables: calls, reads and writes.

use super::paths::{Paths, Way, meet};
use crate::check::Program;
use crate::source::Span;
use crate::syntax::Operator;
use crate::typed::{Argument, Base, Branch, Expr, Kind, Place, Stmt, StmtKind};
use crate::types::{Elementary, Member, MemberKind, Type, UnitId};
use std::collections::BTreeSet;

/// A variable of a unit, or a global one, by its index.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct Variable {
    /// `None` if it is global.
    pub unit: Option<UnitId>,
    pub member: usize,
}

/// A call of an instance.
#[derive(Debug)]
pub(super) struct Call {
    pub variable: Variable,
    /// An element of an array: the index is known only at run time.
    pub indexed: bool,
    /// The base of its address, and the offset of the instance.
    pub place: (Base, u32),
    pub callee: UnitId,
    /// The enclosing lists of statements, from the outside in; the last one is its own.
    pub lists: Vec<usize>,
    /// Inputs by their offset in the instance, whether they are constant TRUE, and the place.
    pub inputs: Vec<(u32, bool, Span)>,
    /// Outputs by their place in the instance.
    pub outputs: Vec<u32>,
    /// Variables that take its outputs: the base of their address, and their offset.
    pub targets: Vec<(Base, u32, Span)>,
    pub span: Span,
}

/// All facts.
#[derive(Debug, Default)]
pub(super) struct Facts {
    pub calls: Vec<Call>,
    /// Instances that are called on every path through a body.
    pub always: BTreeSet<Variable>,
    /// Instances that are called directly or by one of their methods, or that are passed to a unit that may call
    /// them.
    pub called: BTreeSet<Variable>,
    /// Variables that are read, written, called or passed.
    pub used: BTreeSet<Variable>,
    /// Parts of variables that a statement gives a value: the variable, and the offset as in `reads`.
    pub assigned: BTreeSet<(Variable, u32)>,
    /// Reads of a part of a variable: its offset, and for an array whether it is any element.
    pub reads: Vec<(Variable, u32)>,
    /// Comparisons of two numbers with a point.
    pub equal: Vec<Span>,
    /// Conversions to a type that the value had before: the place, and the name of that type.
    pub narrowed: Vec<(Span, Elementary)>,
    /// Branches of CASE that no value reaches.
    pub unreachable: Vec<Span>,
}

/// Reads all statements.
pub(super) fn gather(program: &Program<'_>) -> Facts {
    let mut facts = Facts::default();
    let mut lists = 0;
    let places = Places::new(program);
    let bodies = program
        .bodies
        .iter()
        .map(|body| (Some(body.unit), &body.statements));
    let tasks = program.tasks.iter().map(|task| (None, &task.statements));
    for (unit, statements) in bodies.chain(tasks) {
        let mut walk = Walk {
            program,
            places: &places,
            unit,
            facts: &mut facts,
            lists: Vec::new(),
            next: &mut lists,
            paths: Paths::default(),
        };
        let way = walk.list(statements);
        let called = walk.paths.on_all(way);
        facts.always.extend(called);
    }
    facts
}

/// The variables of a unit, or the global ones, in the order of memory: begin, end, and index in their list.
#[derive(Default)]
struct Spans(Vec<(u32, u32, usize)>);

impl Spans {
    fn new(mut spans: Vec<(u32, u32, usize)>) -> Self {
        spans.sort_unstable();
        Self(spans)
    }

    /// The variable at an offset.
    fn at(&self, offset: u32) -> Option<usize> {
        let behind = self.0.partition_point(|(begin, ..)| *begin <= offset);
        let (_, end, member) = self.0.get(behind.checked_sub(1)?)?;
        (offset < *end).then_some(*member)
    }
}

/// The places of all variables.
struct Places {
    globals: Spans,
    /// For each unit the variables that it holds, and its in_outs, of which it holds only the addresses.
    units: Vec<(Spans, Spans)>,
}

impl Places {
    fn new(program: &Program<'_>) -> Self {
        let span = |(place, member): (usize, &Member)| {
            let bytes = match member.kind {
                MemberKind::InOut => 1,
                _ => program.size(member.ty).max(1),
            };
            (member.offset, member.offset.saturating_add(bytes), place)
        };
        let globals = program.globals.iter().map(|global| &global.member);
        let units = program.units.iter().map(|info| {
            let members = info.members.list.iter().enumerate();
            let own = members.filter(|(_, member)| !matches!(member.kind, MemberKind::External(_)));
            let (pointers, held): (Vec<_>, Vec<_>) =
                own.partition(|(_, member)| member.kind == MemberKind::InOut);
            let spans = |members: Vec<_>| Spans::new(members.into_iter().map(span).collect());
            (spans(held), spans(pointers))
        });
        Self {
            globals: Spans::new(globals.enumerate().map(span).collect()),
            units: units.collect(),
        }
    }
}

struct Walk<'w, 'p, 'a> {
    program: &'p Program<'a>,
    places: &'w Places,
    unit: Option<UnitId>,
    facts: &'w mut Facts,
    lists: Vec<usize>,
    next: &'w mut usize,
    paths: Paths,
}

impl Walk<'_, '_, '_> {
    fn list(&mut self, statements: &[Stmt]) -> Way {
        *self.next += 1;
        self.lists.push(*self.next);
        self.paths.begin_list();
        for statement in statements {
            self.statement(statement);
        }
        self.lists.pop();
        self.paths.end_list()
    }

    fn looping(&mut self, statements: &[Stmt]) -> Way {
        self.paths.begin_loop();
        let way = self.list(statements);
        self.paths.end_loop(way)
    }

    fn statement(&mut self, statement: &Stmt) {
        match &statement.kind {
            StmtKind::Assign(target, value) => {
                self.assign(target);
                self.expression(value);
            }
            StmtKind::Evaluate(value) => self.expression(value),
            StmtKind::Block(call) => self.call(call, statement.span),
            StmtKind::If(branches, other) => {
                let mut way = None;
                for (condition, body) in branches {
                    self.expression(condition);
                    meet(&mut way, self.list(body));
                }
                meet(&mut way, self.list(other));
                self.paths.go_on(way);
            }
            StmtKind::Case(selector, _, branches, other) => {
                self.expression(selector);
                let range = match &selector.kind {
                    Kind::Load(place) => match self.program.types.get(place.ty) {
                        Type::Subrange { low, high, .. } => Some((*low, *high)),
                        _ => None,
                    },
                    _ => None,
                };
                let mut way = None;
                for branch in branches {
                    let beyond = |(low, high): (i128, i128)| {
                        branch.labels.iter().all(|(from, to)| *to < low || *from > high)
                    };
                    if let (true, Some(first)) = (range.is_some_and(beyond), branch.body.first()) {
                        self.facts.unreachable.push(first.span);
                    }
                    meet(&mut way, self.list(&branch.body));
                }
                let otherwise = self.list(other);
                if !other.is_empty() || !self.is_complete(selector, branches) {
                    meet(&mut way, otherwise);
                }
                self.paths.go_on(way);
            }
            StmtKind::For(each) => {
                self.assign(&each.variable);
                for value in [&each.from, &each.to, &each.by] {
                    self.expression(value);
                }
                // A FOR over the elements of an array is assumed to run.
                let way = self.looping(&each.body);
                self.paths.go_on(Some(way.unwrap_or_default()));
            }
            StmtKind::While(condition, body) => {
                self.expression(condition);
                self.looping(body);
            }
            StmtKind::Repeat(body, condition) => {
                let way = self.looping(body);
                self.paths.go_on(way);
                self.expression(condition);
            }
            StmtKind::Exit | StmtKind::Continue => self.paths.leave_loop(),
            StmtKind::Return => self.paths.leave(),
        }
    }

    /// Whether each possible value of a subrange or an enumeration leads to a branch.
    fn is_complete(&self, selector: &Expr, branches: &[Branch]) -> bool {
        let Kind::Load(place) = &selector.kind else {
            return false;
        };
        let labels = branches.iter().flat_map(|branch| &branch.labels);
        match self.program.types.get(place.ty) {
            Type::Subrange { low, high, .. } => {
                let mut labels: Vec<_> = labels.copied().collect();
                labels.sort_unstable();
                let mut next = *low;
                for (from, to) in labels {
                    if from <= next {
                        next = next.max(to + 1);
                    }
                }
                next > *high
            }
            Type::Enumeration(enumeration) => {
                let labels: BTreeSet<i128> = labels.filter(|(from, to)| from == to).map(|it| it.0).collect();
                enumeration
                    .elements
                    .iter()
                    .all(|(_, number)| labels.contains(number))
            }
            _ => false,
        }
    }

    fn call(&mut self, call: &crate::typed::BlockCall, span: Span) {
        self.write(&call.instance);
        self.may_call(&call.instance);
        for (_, place) in &call.references {
            self.pass(place);
        }
        for (_, value) in &call.inputs {
            self.expression(value);
        }
        for (target, _) in &call.outputs {
            self.assign(target);
        }
        let Some((variable, _)) = self.variable(&call.instance) else {
            return;
        };
        self.paths.call(variable);
        let is_true = |value: &Expr| matches!(value.kind, Kind::Integer(1)) && value.ty == crate::types::BOOL;
        let outputs = call.outputs.iter().filter_map(|(_, value)| place_in(value));
        let begin = call.instance.offset;
        self.facts.calls.push(Call {
            variable,
            indexed: !call.instance.indices.is_empty(),
            place: (call.instance.base, begin),
            callee: call.unit,
            lists: self.lists.clone(),
            inputs: call
                .inputs
                .iter()
                .map(|(place, value)| (relative(place, begin), is_true(value), value.span))
                .collect(),
            outputs: outputs.map(|place| relative(place, begin)).collect(),
            targets: call
                .outputs
                .iter()
                .filter(|(target, _)| target.indices.is_empty() && target.bit.is_none())
                .map(|(target, _)| (target.base, target.offset, span))
                .collect(),
            span,
        });
    }

    fn expression(&mut self, value: &Expr) {
        match &value.kind {
            Kind::Integer(_) | Kind::Real(_) | Kind::Text(_) | Kind::Wrong => {}
            Kind::Join(_, values, _) => values.iter().for_each(|value| self.expression(value)),
            Kind::Compare(_, sides) => sides.iter().for_each(|side| self.expression(side)),
            Kind::Load(place) => self.read(place),
            Kind::Negate(_, inner) | Kind::Not(_, inner) | Kind::Within(inner, ..) => self.expression(inner),
            Kind::Convert(inner, from, to) => {
                if let Kind::Convert(_, before, middle) = &inner.kind
                    && middle == from
                    && before.widens_to(*to)
                    && before.widens_to(*from)
                    && !from.widens_to(*to)
                {
                    self.facts.narrowed.push((value.span, *before));
                }
                self.expression(inner);
            }
            Kind::Chain(first, steps) => {
                self.expression(first);
                for step in steps {
                    if matches!(step.operator, Operator::Equal | Operator::NotEqual) && step.ty.is_real() {
                        self.facts.equal.push(step.span);
                    }
                    self.expression(&step.right);
                }
            }
            Kind::Call(call) => {
                if let Some(instance) = &call.instance {
                    self.write(instance);
                    self.may_call(instance);
                }
                for argument in &call.arguments {
                    match argument {
                        Argument::Value(value) => self.expression(value),
                        Argument::Reference(place) => self.pass(place),
                    }
                }
                for (target, _) in &call.outputs {
                    self.assign(target);
                }
            }
            Kind::Library(_, _, values) => values.iter().for_each(|value| self.expression(value)),
        }
    }

    fn indices(&mut self, place: &Place) {
        for index in &place.indices {
            self.expression(&index.value);
        }
    }

    fn write(&mut self, place: &Place) {
        self.indices(place);
        if let Some((variable, _)) = self.variable(place) {
            self.facts.used.insert(variable);
        }
    }

    fn assign(&mut self, place: &Place) {
        self.write(place);
        if let Some(part) = self.variable(place) {
            self.facts.assigned.insert(part);
        }
    }

    /// A variable that is passed by its address. An instance, or something that contains instances, may be called
    /// there.
    fn pass(&mut self, place: &Place) {
        self.read(place);
        if matches!(
            self.program.types.get(place.ty),
            Type::Block(_) | Type::Array(_) | Type::Structure(_)
        ) {
            self.may_call(place);
        }
    }

    fn may_call(&mut self, place: &Place) {
        if let Some((variable, _)) = self.variable(place) {
            self.facts.called.insert(variable);
        }
    }

    fn read(&mut self, place: &Place) {
        self.indices(place);
        if let Some((variable, within)) = self.variable(place) {
            self.facts.used.insert(variable);
            self.facts.reads.push((variable, within));
        }
    }

    /// The variable of a place, and the offset in it; for an array of blocks, the offset in its first element.
    fn variable(&self, place: &Place) -> Option<(Variable, u32)> {
        let program = self.program;
        let (unit, offset) = match (place.base, self.unit) {
            // A method works on the variables of its block.
            (Base::This, Some(unit)) => (program.unit(unit).owner.or(Some(unit)), place.offset),
            (Base::ThisPointer(offset), Some(unit)) => (program.unit(unit).owner.or(Some(unit)), offset),
            (Base::Memory | Base::MemoryPointer(_), Some(unit)) if program.unit(unit).kind.has_frame() => {
                let address = match place.base {
                    Base::MemoryPointer(address) => address,
                    _ => place.offset,
                };
                let (frame, size) = (program.unit(unit).frame, program.unit(unit).members.size);
                match address.checked_sub(frame).filter(|offset| *offset < size) {
                    Some(offset) => (Some(unit), offset),
                    None => (None, address),
                }
            }
            (Base::Memory, _) => (None, place.offset),
            _ => return None,
        };
        let (member, declared) = match unit {
            Some(unit) => {
                let (held, pointers) = self.places.units.get(unit.0 as usize)?;
                let spans = match place.base {
                    Base::ThisPointer(_) | Base::MemoryPointer(_) => pointers,
                    _ => held,
                };
                let member = spans.at(offset)?;
                (member, program.unit(unit).members.list.get(member)?)
            }
            None => {
                let member = self.places.globals.at(offset)?;
                (member, &program.globals.get(member)?.member)
            }
        };
        let mut within = offset - declared.offset;
        let mut ty = declared.ty;
        while let Type::Array(array) = program.types.get(ty) {
            within %= array.stride.max(1);
            ty = array.of;
        }
        Some((Variable { unit, member }, within))
    }
}

/// The place that a value is read from.
fn place_in(value: &Expr) -> Option<&Place> {
    match &value.kind {
        Kind::Load(place) => Some(place),
        Kind::Convert(inner, ..) | Kind::Not(_, inner) | Kind::Within(inner, ..) => place_in(inner),
        _ => None,
    }
}

/// The offset of a pin in its instance.
fn relative(place: &Place, begin: u32) -> u32 {
    match place.base {
        Base::Callee => place.offset,
        _ => place.offset.saturating_sub(begin),
    }
}

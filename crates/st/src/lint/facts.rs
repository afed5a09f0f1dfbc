//! The uses of a program's variables: calls, reads and writes.

use crate::check::Program;
use crate::source::Span;
use crate::typed::{Argument, Base, Expr, Kind, Place, Stmt, StmtKind};
use crate::types::{Elementary, MemberKind, Type, TypeId, UnitId};

/// A variable of a unit, or a global one, by its place.
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
    /// Whether it is in a branch.
    pub branch: bool,
    /// Inputs by their offset in the instance, whether they are constant TRUE, and the place.
    pub inputs: Vec<(u32, bool, Span)>,
    /// Outputs by their place in the instance.
    pub outputs: Vec<u32>,
    /// Variables that take its outputs: the base of their address, and their offset.
    pub targets: Vec<(Base, u32, Span)>,
    pub span: Span,
}

/// All of it.
#[derive(Debug, Default)]
pub(super) struct Facts {
    pub calls: Vec<Call>,
    /// Variables that are read, written, called or passed.
    pub used: std::collections::BTreeSet<Variable>,
    /// Variables that a statement gives a value.
    pub assigned: std::collections::BTreeSet<Variable>,
    /// Reads of a part of a variable: its offset, and for an array whether it is any element.
    pub reads: Vec<(Variable, u32)>,
    /// Comparisons of two numbers with a point.
    pub equal: Vec<Span>,
    /// Conversions to a type that the value had before, where, and the name of that type.
    pub narrowed: Vec<(Span, Elementary)>,
    /// Branches of CASE that no value reaches.
    pub unreachable: Vec<Span>,
}

/// Looks at all statements.
pub(super) fn gather(program: &Program<'_>) -> Facts {
    let mut facts = Facts::default();
    let mut lists = 0;
    for body in &program.bodies {
        let mut walk = Walk {
            program,
            unit: Some(body.unit),
            facts: &mut facts,
            lists: Vec::new(),
            next: &mut lists,
            branches: 0,
        };
        walk.list(&body.statements);
    }
    for task in &program.tasks {
        let mut walk = Walk {
            program,
            unit: None,
            facts: &mut facts,
            lists: Vec::new(),
            next: &mut lists,
            branches: 0,
        };
        walk.list(&task.statements);
    }
    facts
}

struct Walk<'w, 'p, 'a> {
    program: &'p Program<'a>,
    unit: Option<UnitId>,
    facts: &'w mut Facts,
    lists: Vec<usize>,
    next: &'w mut usize,
    branches: usize,
}

impl Walk<'_, '_, '_> {
    fn list(&mut self, statements: &[Stmt]) {
        *self.next += 1;
        self.lists.push(*self.next);
        for statement in statements {
            self.statement(statement);
        }
        self.lists.pop();
    }

    fn branch(&mut self, statements: &[Stmt]) {
        self.branches += 1;
        self.list(statements);
        self.branches -= 1;
    }

    fn statement(&mut self, statement: &Stmt) {
        match &statement.kind {
            StmtKind::Assign(target, value) | StmtKind::Copy(target, value, _) => {
                self.write(target);
                if let Some((variable, _)) = self.variable(target) {
                    self.facts.assigned.insert(variable);
                }
                self.expression(value);
            }
            StmtKind::Evaluate(value) => self.expression(value),
            StmtKind::Block(call) => self.call(call, statement.span),
            StmtKind::If(branches, other) => {
                for (condition, body) in branches {
                    self.expression(condition);
                    self.branch(body);
                }
                self.branch(other);
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
                for branch in branches {
                    let beyond = |(low, high): (i128, i128)| {
                        branch.labels.iter().all(|(from, to)| *to < low || *from > high)
                    };
                    if let (true, Some(first)) = (range.is_some_and(beyond), branch.body.first()) {
                        self.facts.unreachable.push(first.span);
                    }
                    self.branch(&branch.body);
                }
                self.branch(other);
            }
            StmtKind::For(each) => {
                self.write(&each.variable);
                for value in [&each.from, &each.to, &each.by] {
                    self.expression(value);
                }
                self.list(&each.body);
            }
            StmtKind::While(condition, body) => {
                self.expression(condition);
                self.branch(body);
            }
            StmtKind::Repeat(body, condition) => {
                self.list(body);
                self.expression(condition);
            }
            StmtKind::Exit | StmtKind::Continue | StmtKind::Return => {}
        }
    }

    fn call(&mut self, call: &crate::typed::BlockCall, span: Span) {
        self.write(&call.instance);
        for (_, place) in &call.references {
            self.read(place);
        }
        for (_, value) in &call.inputs {
            self.expression(value);
        }
        for (target, _) in &call.outputs {
            self.write(target);
        }
        let Some((variable, _)) = self.variable(&call.instance) else {
            return;
        };
        let is_true = |value: &Expr| matches!(value.kind, Kind::Integer(1)) && value.ty == crate::types::BOOL;
        let outputs = call.outputs.iter().filter_map(|(_, value)| place_in(value));
        let begin = call.instance.offset;
        self.facts.calls.push(Call {
            variable,
            indexed: !call.instance.indices.is_empty(),
            place: (call.instance.base, begin),
            callee: call.unit,
            lists: self.lists.clone(),
            branch: self.branches > 0,
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
                    use crate::typed::Operation::{Equal, NotEqual};
                    if matches!(step.operation, Equal | NotEqual) && step.ty.is_real() {
                        self.facts.equal.push(step.span);
                    }
                    self.expression(&step.right);
                }
            }
            Kind::Call(call) => {
                if let Some(instance) = &call.instance {
                    self.write(instance);
                }
                for argument in &call.arguments {
                    match argument {
                        Argument::Value(value) => self.expression(value),
                        Argument::Reference(place) => self.read(place),
                    }
                }
                for (target, _) in &call.outputs {
                    self.write(target);
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

    fn read(&mut self, place: &Place) {
        self.indices(place);
        if let Some((variable, within)) = self.variable(place) {
            self.facts.used.insert(variable);
            self.facts.reads.push((variable, within));
        }
    }

    /// The variable a place is in, and where in it; of an array of blocks, where in its first element.
    fn variable(&self, place: &Place) -> Option<(Variable, u32)> {
        let program = self.program;
        let info = |unit: UnitId| program.units.get(unit.0 as usize);
        let (unit, offset) = match (place.base, self.unit) {
            // A method works on the variables of its block.
            (Base::This, Some(unit)) => (info(unit)?.owner.or(Some(unit)), place.offset),
            (Base::ThisPointer(offset), Some(unit)) => (info(unit)?.owner.or(Some(unit)), offset),
            (Base::Memory | Base::MemoryPointer(_), Some(unit)) if info(unit)?.kind.has_frame() => {
                let address = match place.base {
                    Base::MemoryPointer(address) => address,
                    _ => place.offset,
                };
                let (frame, size) = (info(unit)?.frame, info(unit)?.members.size);
                match address.checked_sub(frame).filter(|offset| *offset < size) {
                    Some(offset) => (Some(unit), offset),
                    None => (None, address),
                }
            }
            (Base::Memory, _) => (None, place.offset),
            _ => return None,
        };
        let size = |ty: TypeId| {
            program
                .types
                .size(ty, |unit| info(unit).map_or(0, |info| info.members.size))
                .0
        };
        let found = match unit {
            Some(unit) => {
                let mut members = info(unit)?.members.list.iter().enumerate();
                members.find(|(_, member)| {
                    let pointer = matches!(place.base, Base::ThisPointer(_) | Base::MemoryPointer(_));
                    // Of a VAR_IN_OUT the unit holds the address alone.
                    let bytes = if pointer { 1 } else { size(member.ty).max(1) };
                    (member.offset..member.offset + bytes).contains(&offset)
                        && pointer == (member.kind == MemberKind::InOut)
                        && !matches!(member.kind, MemberKind::External(_))
                })
            }
            None => {
                let mut globals = program.globals.iter().map(|global| &global.member).enumerate();
                globals.find(|(_, member)| {
                    (member.offset..member.offset + size(member.ty).max(1)).contains(&offset)
                })
            }
        };
        let (member, declared) = found?;
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

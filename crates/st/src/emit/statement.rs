//! Statements, and the functions made of units and tasks.

use super::Context;
use super::expression::Emitter;
use super::function::{Function, at, value_type};
use super::place::Root;
use crate::check::{Task, UnitKind};
use crate::layout;
use crate::source::Span;
use crate::start;
use crate::syntax::Operator;
use crate::typed::{Base, Branch, Expr, Place, Stmt, StmtKind};
use crate::types::{Elementary, Member, MemberKind, Type, UnitId};
use wasm_encoder::{BlockType, ValType};

/// Largest number of table entries for each label: states are often numbered in tens.
const SPARSE: i128 = 16;

/// The function that the host calls: it stores the time and runs the tasks that are due, or `only` one of them.
pub(super) fn scan(context: &mut Context<'_, '_>, only: Option<usize>) -> Function {
    let tasks = &context.program.tasks;
    let mut emitter = Emitter::new(context, Function::new(vec![ValType::I32, ValType::I64], None));
    emitter
        .function
        .sink()
        .i32_const(0)
        .local_get(1)
        .i64_store(at(layout::NOW, 3));
    if let Some(task) = only.and_then(|task| tasks.get(task)) {
        emitter.statements(&task.statements);
        return emitter.function;
    }
    let mut order: Vec<&Task> = tasks.iter().collect();
    order.sort_by_key(|task| task.priority);
    for task in order {
        let Some(interval) = task.interval_ns else {
            emitter.statements(&task.statements);
            continue;
        };
        let due = at(task.due, 3);
        let mut sink = emitter.function.sink();
        sink.local_get(1).i32_const(0).i64_load(due).i64_ge_s();
        emitter.function.if_(BlockType::Empty);
        // Due again at the next multiple of the interval, even after a long pause.
        let mut sink = emitter.function.sink();
        sink.i32_const(0).local_get(1).i64_const(interval).i64_div_s();
        sink.i64_const(1)
            .i64_add()
            .i64_const(interval)
            .i64_mul()
            .i64_store(due);
        emitter.statements(&task.statements);
        emitter.function.end();
    }
    emitter.function
}

/// A program, a function block, a FUNCTION or a METHOD, which gets its instance before its parameters.
pub(super) fn unit(context: &mut Context<'_, '_>, id: UnitId) -> Function {
    let program = context.program;
    let info = program.unit(id);
    let is_function = info.kind.has_frame();
    let is_method = info.kind == UnitKind::Method;
    let members = &info.members.list;
    let result = info.result.and_then(|place| members.get(place));
    let (parameters, value) = if is_function {
        let taken = members.iter().filter(|member| member.kind.is_given());
        let taken = taken.map(|member| match member.kind {
            MemberKind::InOut => ValType::I32,
            _ => Emitter::parameter(program.types.elementary(member.ty)),
        });
        (
            is_method
                .then_some(ValType::I32)
                .into_iter()
                .chain(taken)
                .collect(),
            result.map(|member| Emitter::parameter(program.types.elementary(member.ty))),
        )
    } else {
        (vec![ValType::I32], None)
    };
    let body = context.bodies.get(&id).copied();
    let mut emitter = Emitter::new(context, Function::new(parameters, value));
    emitter.is_method = is_method;
    let (root, frame) = if is_function {
        (Root::Zero, info.frame)
    } else {
        (Root::Local(0), 0)
    };
    if is_function {
        emitter.take_parameters(members, frame, u32::from(is_method));
    }
    if let Some(body) = body {
        for member in body.fresh.iter().filter_map(|place| members.get(*place)) {
            emitter.fresh(member, root, frame);
        }
        emitter.end = Some(emitter.function.block());
        emitter.statements(&body.statements);
        emitter.function.end();
    }
    if let Some(member) = result {
        emitter.read(&Place::plain(Base::Memory, frame + member.offset, member.ty));
    }
    emitter.function
}

impl Emitter<'_, '_, '_> {
    /// Copies the parameters of a FUNCTION, from local variable `first` on, to the addresses of its
    /// variables.
    fn take_parameters(&mut self, members: &[Member], frame: u32, first: u32) {
        let taken = members.iter().filter(|member| member.kind.is_given());
        for (local, member) in (first..).zip(taken) {
            let offset = frame + member.offset;
            match (member.kind, self.type_of(member.ty)) {
                (MemberKind::InOut, _) => {
                    self.function
                        .sink()
                        .i32_const(0)
                        .local_get(local)
                        .i32_store(at(offset, 2));
                }
                (_, Some(of)) => {
                    self.function.sink().i32_const(0).local_get(local);
                    self.store(of, offset);
                }
                (_, None) if matches!(self.context.program.types.get(member.ty), Type::Text(_)) => {
                    self.function.sink().i32_const(offset.cast_signed());
                    self.assign_text(member.ty, |emitter| {
                        emitter.function.sink().local_get(local);
                    });
                }
                (_, None) => {
                    let bytes = self.context.program.size(member.ty);
                    let mut sink = self.function.sink();
                    sink.i32_const(offset.cast_signed()).local_get(local);
                    sink.i32_const(bytes.cast_signed()).memory_copy(0, 0);
                }
            }
        }
    }

    /// Gives a variable its initial value, as at every call.
    fn fresh(&mut self, member: &Member, root: Root, frame: u32) {
        let program = self.context.program;
        let bytes = program.size(member.ty);
        let mut image = vec![0; bytes as usize];
        start::write(program, member.ty, &member.start, &mut image, 0);
        let offset = frame + member.offset;
        if let Some(of) = self.type_of(member.ty) {
            let mut number = [0; 8];
            number[..image.len().min(8)].copy_from_slice(&image[..image.len().min(8)]);
            let bits = u64::from_le_bytes(number);
            self.push_root(root);
            match value_type(of) {
                ValType::F32 => self.real_constant(of, f32::from_bits(bits as u32).into()),
                ValType::F64 => self.real_constant(of, f64::from_bits(bits)),
                _ => self.constant(of, bits.cast_signed().into()),
            }
            self.store(of, offset);
            return;
        }
        self.push_root(root);
        self.add_offset(offset);
        let size = bytes.cast_signed();
        if image.iter().all(|byte| *byte == 0) {
            self.function.sink().i32_const(0).i32_const(size).memory_fill(0);
        } else {
            let from = self.context.templates_at + self.context.templates.len() as u32;
            self.context.templates.extend(image);
            self.function
                .sink()
                .i32_const(from.cast_signed())
                .i32_const(size)
                .memory_copy(0, 0);
        }
    }

    /// Counts a statement or one of its branches, if requested.
    fn count(&mut self, place: Span, branch: u32) {
        if let Some(address) = self.context.counters.address(place, branch) {
            let mut sink = self.function.sink();
            sink.i32_const(0).i32_const(0).i64_load(at(address, 3));
            sink.i64_const(1).i64_add().i64_store(at(address, 3));
        }
    }

    /// The statements of a branch, the first of which is number 1.
    fn branch(&mut self, list: &[Stmt], of: Span, number: u32) {
        self.count(of, number);
        self.statements(list);
    }

    pub(super) fn statements(&mut self, list: &[Stmt]) {
        let outer = self.statement;
        for statement in list {
            let mark = self.function.mark();
            self.statement = statement.span;
            self.count(statement.span, 0);
            self.statement(statement);
            self.function.release(mark);
        }
        self.statement = outer;
    }

    fn statement(&mut self, statement: &Stmt) {
        let span = statement.span;
        match &statement.kind {
            StmtKind::Assign(target, value) => self.assign(target, value),
            StmtKind::Evaluate(value) => {
                self.expression(value);
                let empty = value.ty == crate::types::WRONG;
                if !empty {
                    self.function.sink().drop();
                }
            }
            StmtKind::Block(call) => self.block_call(call, span),
            StmtKind::If(branches, other) => self.if_(branches, other, span),
            StmtKind::Case(selector, of, branches, other) => self.case(selector, *of, branches, other, span),
            StmtKind::For(each) => self.for_(each, span),
            StmtKind::While(condition, body) => self.while_(condition, body, span),
            StmtKind::Repeat(body, condition) => self.repeat(body, condition, span),
            StmtKind::Exit => {
                if let Some(exit) = self.loops.last().map(|it| it.exit) {
                    self.function.branch(exit);
                }
            }
            StmtKind::Continue => {
                if let Some(again) = self.loops.last().map(|it| it.again) {
                    self.function.branch(again);
                }
            }
            StmtKind::Return => {
                if let Some(end) = self.end {
                    self.function.branch(end);
                }
            }
        }
    }

    fn if_(&mut self, branches: &[(Expr, Vec<Stmt>)], other: &[Stmt], span: Span) {
        let last = branches.len() as u32 + 1;
        if let [(condition, body)] = branches {
            self.expression(condition);
            self.function.if_(BlockType::Empty);
            self.branch(body, span, 1);
            if !other.is_empty() || self.context.counters.address(span, last).is_some() {
                self.function.else_();
                self.branch(other, span, last);
            }
            self.function.end();
            return;
        }
        // Not nested, so that a long chain of ELSIFs is not deep.
        let end = self.function.block();
        for (number, (condition, body)) in (1..).zip(branches) {
            self.expression(condition);
            self.function.if_(BlockType::Empty);
            self.branch(body, span, number);
            self.function.branch(end);
            self.function.end();
        }
        self.branch(other, span, last);
        self.function.end();
    }

    fn case(&mut self, selector: &Expr, of: Elementary, branches: &[Branch], other: &[Stmt], span: Span) {
        let ty = value_type(of);
        let local = self.function.local(ty);
        self.expression(selector);
        self.function.sink().local_set(local);
        let labels = || branches.iter().flat_map(|branch| &branch.labels);
        let low = labels().map(|(from, _)| *from).min().unwrap_or(0);
        let high = labels().map(|(_, to)| *to).max().unwrap_or(0);
        let count = labels().count() as i128;
        if ty == ValType::I32 && count >= 3 && high - low < count * SPARSE {
            self.table(local, (low, high), branches, other, span);
        } else {
            self.comparisons(local, of, branches, other, span);
        }
    }

    /// A branch by table: one jump for any number of labels.
    fn table(
        &mut self,
        local: u32,
        (low, high): (i128, i128),
        branches: &[Branch],
        other: &[Stmt],
        span: Span,
    ) {
        let count = branches.len() as u32;
        let mut targets = vec![count; (high - low + 1) as usize];
        for (place, branch) in (0..).zip(branches) {
            for (from, to) in &branch.labels {
                let range = (from - low) as usize..=(to - low) as usize;
                targets.get_mut(range).unwrap_or_default().fill(place);
            }
        }
        let end = self.function.block();
        let _otherwise = self.function.block();
        for _ in branches {
            self.function.block();
        }
        let mut sink = self.function.sink();
        sink.local_get(local)
            .i32_const(low as i32)
            .i32_sub()
            .br_table(targets, count);
        for (number, branch) in (1..).zip(branches) {
            self.function.end();
            self.branch(&branch.body, span, number);
            self.function.branch(end);
        }
        self.function.end();
        self.branch(other, span, count + 1);
        self.function.end();
    }

    /// One comparison after the other.
    fn comparisons(&mut self, local: u32, of: Elementary, branches: &[Branch], other: &[Stmt], span: Span) {
        let end = self.function.block();
        for (number, branch) in (1..).zip(branches) {
            for (place, (from, to)) in branch.labels.iter().enumerate() {
                self.function.sink().local_get(local);
                self.constant(of, *from);
                if from == to {
                    self.operation(Operator::Equal, of);
                } else if of.size() == 8 {
                    self.difference(of);
                    self.constant(of, to - from);
                    self.function.sink().i64_le_u();
                } else {
                    self.difference(of);
                    self.constant(Elementary::Udint, to - from);
                    self.function.sink().i32_le_u();
                }
                if place > 0 {
                    self.function.sink().i32_or();
                }
            }
            self.function.if_(BlockType::Empty);
            self.branch(&branch.body, span, number);
            self.function.branch(end);
            self.function.end();
        }
        self.branch(other, span, branches.len() as u32 + 1);
        self.function.end();
    }
}

//! Statements.

use super::Checker;
use super::body::Variable;
use super::convert::widened;
use super::path::Named;
use crate::error::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::{Case, Expression, For, Ident, Path, Selector, Statement, StatementKind};
use crate::typed::{Branch, Expr, Kind, Place, Stmt, StmtKind};
use crate::types::{BOOL, Constant, Elementary, MemberKind, Type, TypeId, Types};

impl<'a> Checker<'a> {
    pub(super) fn statements(&mut self, list: &'a [Statement]) -> Vec<Stmt> {
        let mut checked = Vec::with_capacity(list.len());
        let mut after: Option<Span> = None;
        for statement in list {
            if let Some(end) = after.take()
                && !matches!(statement.kind, StatementKind::Empty)
            {
                let doubt = Diagnostic::warning(Code::Doubtful, statement.span, "this is never reached");
                self.tell(doubt.related(end, "the statements before end here"));
            }
            let kind = self.statement(statement);
            if matches!(kind, Some(StmtKind::Exit | StmtKind::Continue | StmtKind::Return)) {
                after = Some(statement.span);
            }
            checked.extend(kind.map(|kind| Stmt {
                kind,
                span: statement.span,
            }));
        }
        checked
    }

    fn statement(&mut self, statement: &'a Statement) -> Option<StmtKind> {
        Some(match &statement.kind {
            StatementKind::Empty => return None,
            StatementKind::Assign(path, value) => return self.assignment(path, value),
            StatementKind::Call(call) => return self.call_statement(call),
            StatementKind::If(branches, other) => {
                let mut checked = Vec::new();
                for (condition, body) in branches {
                    let condition = self.condition(condition);
                    checked.push((condition, self.statements(body)));
                }
                let other = self.statements(other);
                StmtKind::If(checked, other)
            }
            StatementKind::Case(case) => return self.case(case, statement.span),
            StatementKind::For(each) => return self.for_(each),
            StatementKind::While(condition, body) => {
                let condition = self.condition(condition);
                let body = self.looped(body);
                StmtKind::While(condition, body)
            }
            StatementKind::Repeat(body, condition) => {
                let body = self.looped(body);
                let condition = self.condition(condition);
                StmtKind::Repeat(body, condition)
            }
            StatementKind::Exit | StatementKind::Continue => {
                let exit = matches!(statement.kind, StatementKind::Exit);
                if self.body.loops == 0 {
                    let what = if exit { "EXIT" } else { "CONTINUE" };
                    let message = format!("{what} stands outside of a FOR, WHILE or REPEAT");
                    self.error(
                        Code::Misplaced,
                        statement.span,
                        message,
                        "RETURN leaves a program or block",
                    );
                    return None;
                }
                if exit { StmtKind::Exit } else { StmtKind::Continue }
            }
            StatementKind::Return => StmtKind::Return,
        })
    }

    fn looped(&mut self, body: &'a [Statement]) -> Vec<Stmt> {
        self.body.loops += 1;
        let body = self.statements(body);
        self.body.loops -= 1;
        body
    }

    /// A variable that is written.
    pub(super) fn target(&mut self, path: &'a Path) -> Option<Place> {
        match self.named(path, None) {
            Named::Nothing => None,
            Named::Value(_) => {
                let message = format!("`{}` is a constant", path.root.text);
                self.error(Code::NotWritable, path.span, message, "assign to a variable");
                None
            }
            Named::Place(_, Some(why)) => {
                self.error(Code::NotWritable, path.span, why, "assign to another variable");
                None
            }
            Named::Place(place, None) => {
                self.note_write_to(path);
                Some(place)
            }
        }
    }

    fn assignment(&mut self, path: &'a Path, value: &'a Expression) -> Option<StmtKind> {
        let Some(target) = self.target(path) else {
            // Its other errors are still reported.
            self.expression(value, None);
            return None;
        };
        let ty = if target.bit.is_some() { BOOL } else { target.ty };
        if let Type::Block(_) = self.types.get(ty) {
            let message = format!("an instance of {} is not assigned", self.type_name(ty));
            self.error(
                Code::WrongType,
                path.span,
                message,
                "set its inputs, or hand it over as VAR_IN_OUT",
            );
            return None;
        }
        if self.types.elementary(ty).is_none() && self.holds_block(ty) {
            let message = "what holds an instance of a block is not assigned";
            self.error(Code::WrongType, path.span, message, "assign its members");
            return None;
        }
        let value = self.value(value, ty);
        if value.is_wrong() {
            return None;
        }
        Some(StmtKind::Assign(target, value))
    }

    fn case(&mut self, case: &'a Case, span: Span) -> Option<StmtKind> {
        let selector = self.expression(&case.selector, None);
        let selector = self.settle(selector);
        let of = self
            .types
            .elementary(selector.ty)
            .filter(|it| !it.is_real() && *it != Elementary::Bool);
        // Of a selector that is refused the labels cannot be right.
        let ty = if of.is_some() {
            selector.ty
        } else {
            crate::types::WRONG
        };
        if of.is_none() && !selector.is_wrong() {
            let message = format!(
                "CASE goes by whole numbers and enumerations, not by {}",
                self.type_name(selector.ty)
            );
            self.error(Code::WrongType, selector.span, message, "use IF");
        }
        let mut seen: Vec<(i128, i128, Span)> = Vec::new();
        let mut branches = Vec::new();
        for branch in &case.branches {
            let mut labels = Vec::new();
            for (low, high) in &branch.labels {
                let from = self.label(low, ty);
                let to = match high {
                    Some(high) => self.label(high, ty),
                    None => from,
                };
                let (Some(from), Some(to)) = (from, to) else {
                    continue;
                };
                let at = high.as_ref().map_or(low.span, |high| low.span.to(high.span));
                if from > to {
                    self.error(
                        Code::OutOfRange,
                        at,
                        format!("the range {from}..{to} is empty"),
                        "the smaller value stands first",
                    );
                    continue;
                }
                labels.push((from, to));
                seen.push((from, to, at));
            }
            let body = self.statements(&branch.body);
            branches.push(Branch { labels, body });
        }
        self.check_labels(&mut seen);
        if case.other.is_none() {
            self.check_complete(ty, &seen, span);
        }
        let other = case
            .other
            .as_ref()
            .map(|body| self.statements(body))
            .unwrap_or_default();
        Some(StmtKind::Case(selector, of?, branches, other))
    }

    fn label(&mut self, label: &'a Expression, ty: TypeId) -> Option<i128> {
        let value = self.value(label, ty);
        match value.constant() {
            Some(Constant::Integer(number)) => Some(number),
            _ if value.is_wrong() => None,
            _ => {
                self.not_constant(value.span);
                None
            }
        }
    }

    /// Reports two branches for one value.
    fn check_labels(&mut self, seen: &mut [(i128, i128, Span)]) {
        seen.sort_by_key(|(from, _, span)| (*from, *span));
        let mut furthest: Option<(i128, Span)> = None;
        for (from, to, span) in seen.iter() {
            if let Some((end, other)) = furthest
                && *from <= end
            {
                let (first, second) = if other < *span {
                    (other, *span)
                } else {
                    (*span, other)
                };
                let wrong = Diagnostic::error(
                    Code::DuplicateName,
                    second,
                    format!("the value {from} has two branches"),
                );
                self.tell(wrong.related(first, "the other one"));
            }
            if furthest.is_none_or(|(end, _)| *to > end) {
                furthest = Some((*to, *span));
            }
        }
    }

    /// Reports elements that no branch of a CASE without ELSE names.
    fn check_complete(&mut self, ty: TypeId, seen: &[(i128, i128, Span)], span: Span) {
        let Type::Enumeration(of) = self.types.get(ty) else {
            return;
        };
        let missing: Vec<_> = of
            .elements
            .iter()
            .filter(|(_, number)| {
                let behind = seen.partition_point(|(from, ..)| from <= number);
                let before = seen.get(..behind).and_then(<[_]>::last);
                before.is_none_or(|(_, to, _)| number > to)
            })
            .map(|(name, _)| name.as_str())
            .take(4)
            .collect();
        if !missing.is_empty() {
            let message = format!("CASE has no branch for {}", missing.join(", "));
            let at = Span {
                start: span.start,
                end: span.start + 4,
            };
            let doubt = Diagnostic::warning(Code::Doubtful, at, message);
            self.tell(doubt.help("add the branches, or an ELSE"));
        }
    }

    fn for_(&mut self, each: &'a For) -> Option<StmtKind> {
        let path_span = each.variable.span;
        let control = self.variable_of(&each.variable.key());
        let found = self.control(&each.variable, control);
        let declared = found.as_ref().map(|place| place.ty);
        let of = declared
            .and_then(|ty| self.types.computed(ty))
            .filter(|it| it.is_integer());
        if let (Some(ty), None) = (declared, of)
            && ty != crate::types::WRONG
        {
            let message = format!(
                "the control variable of FOR is a whole number, not {}",
                self.type_name(ty)
            );
            self.error(
                Code::WrongType,
                path_span,
                message,
                "use INT or DINT; for a REAL use WHILE",
            );
        }
        let ty = of.map_or(crate::types::WRONG, Types::of);
        let from = self.value(&each.from, ty);
        let to = self.value(&each.to, ty);
        let by = match &each.by {
            Some(by) => self.step_value(by),
            None => Expr::new(Kind::Integer(1), Types::of(Elementary::Lint), each.from.span),
        };
        let around = self.body.controls.len();
        self.body.controls.extend(control);
        let body = self.looped(&each.body);
        self.body.controls.truncate(around);
        let (variable, of) = (found?, of?);
        if from.is_wrong() || to.is_wrong() || by.is_wrong() {
            return None;
        }
        let range = self.types.range(variable.ty);
        Some(StmtKind::For(Box::new(crate::typed::For {
            variable,
            ty: of,
            range,
            from,
            to,
            by,
            body,
        })))
    }

    /// The control variable of a FOR.
    fn control(&mut self, name: &Ident, control: Option<Variable>) -> Option<Place> {
        let key = name.key();
        let (place, fixed) = match (self.local(&key), control) {
            (Some((unit, place)), _) => {
                self.look_at_member(name.span, unit, place);
                self.member_place(unit, place)
            }
            (None, Some((_, place))) => {
                self.look_at_global(name.span, place);
                self.global_place(place)
            }
            (None, None) => {
                let several = self.global_names.contains_key(&key);
                if several {
                    self.clear_global(&key, name.span);
                } else if !self.may_be_lost(&key) && self.is_news(self.scope, &key) {
                    let message = format!("there is no variable `{}`", name.text);
                    let help = "declare the control variable: `i : INT;`";
                    self.error(Code::UnknownName, name.span, message, help);
                }
                return None;
            }
        };
        if let Some(why) = fixed {
            self.error(Code::NotWritable, name.span, why, "use another control variable");
            return None;
        }
        self.note_write(control, name.span);
        Some(place)
    }

    /// Records a write to the variable at the root of a path.
    pub(super) fn note_write_to(&mut self, path: &Path) {
        let key = path.root.key();
        let variable = match path.selectors.first() {
            _ if path.this => self.this_block().and_then(|block| {
                let (place, _) = self.unit(block).members.find(&key)?;
                Some((Some(block), place))
            }),
            Some(Selector::Member(name)) => self
                .variable_of(&key)
                .or_else(|| Some((None, self.listed(&key, &name.key())?))),
            _ => self.variable_of(&key),
        };
        self.note_write(variable, path.span);
    }

    fn note_write(&mut self, variable: Option<Variable>, span: Span) {
        if let (Some(variable), Some(unit)) = (variable, self.scope) {
            let writers = self.writers.entry(variable).or_default();
            writers.entry(unit).or_insert(span);
        }
    }

    /// How the variable of this name is known: as one of its unit, or as a global one.
    fn variable_of(&self, key: &str) -> Option<Variable> {
        let Some((unit, place)) = self.local(key) else {
            return Some((None, self.only_global(key)?));
        };
        let member = self.unit(unit).members.list.get(place)?;
        Some(match member.kind {
            MemberKind::External(global) => (None, global),
            _ => (Some(unit), place),
        })
    }

    /// The step of FOR as a LINT: it may be negative if the control variable is unsigned.
    fn step_value(&mut self, by: &'a Expression) -> Expr {
        let value = self.expression(by, None);
        let value = self.settle(value);
        let span = value.span;
        let Some(it) = self.types.elementary(value.ty).filter(|it| it.is_integer()) else {
            if !value.is_wrong() {
                let message = format!(
                    "the step of FOR is a whole number, not {}",
                    self.type_name(value.ty)
                );
                self.error(Code::WrongType, span, message, "");
            }
            return Expr::wrong(span);
        };
        if it == Elementary::Ulint {
            self.error(
                Code::WrongType,
                span,
                "the step of FOR is LINT at most",
                "convert it: ULINT_TO_LINT(..)",
            );
            return Expr::wrong(span);
        }
        if let Kind::Integer(0) = value.kind {
            self.error(Code::OutOfRange, span, "a FOR with a step of 0 never ends", "");
            return Expr::wrong(span);
        }
        widened(value, it, Elementary::Lint)
    }
}

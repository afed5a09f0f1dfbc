//! The statements that write a variable.

use super::{Symbol, Symbols};
use crate::check::{Body, Program};
use crate::source::{Position, Sources, Span};
use crate::typed::{Argument, Base, Expr, Kind, Place, Stmt, StmtKind};
use crate::types::{Constant, Elementary, Type, UnitId};

/// Largest number of writers of one variable that are listed.
const MOST: usize = 16;

/// A statement that writes a variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Writer {
    /// The file, as it was given.
    pub file: String,
    /// The begin of the statement; for an input given in a call, the place of its value.
    pub position: Position,
    /// The value that it writes, if that is a constant: in the form of a trace.
    pub value: Option<String>,
}

/// Bytes that a statement may write.
#[derive(Clone, Debug)]
pub(super) struct Write {
    /// The unit whose instances they are in; `None` counts from the beginning of memory.
    unit: Option<UnitId>,
    start: u32,
    end: u32,
    file: String,
    position: Position,
    value: Option<Constant>,
    /// The call of an instance, which writes any of its variables.
    is_call: bool,
}

/// The variables that the statements of a program write, in the order of the text.
pub(super) fn writes(program: &Program<'_>, sources: &Sources) -> Vec<Write> {
    let mut finder = Finder {
        program,
        sources,
        unit: None,
        found: Vec::new(),
    };
    for body in &program.bodies {
        finder.body(body);
    }
    finder.found
}

struct Finder<'p> {
    program: &'p Program<'p>,
    sources: &'p Sources,
    /// The unit of `This`.
    unit: Option<UnitId>,
    found: Vec<Write>,
}

impl Finder<'_> {
    fn body(&mut self, body: &Body) {
        let info = self.program.unit(body.unit);
        if !self.sources.in_library(info.span) {
            self.unit = Some(info.owner.unwrap_or(body.unit));
            self.statements(&body.statements);
        }
    }

    fn write(&mut self, place: &Place, span: Span, value: Option<Constant>, is_call: bool) {
        let unit = match place.base {
            Base::Memory => None,
            Base::This => self.unit,
            // The target of an in_out is known only at run time; its caller is listed instead.
            Base::ThisPointer(_) | Base::MemoryPointer(_) | Base::Callee => return,
        };
        // An index that is known only at run time may be any.
        let reach: u32 = place.indices.iter().map(|it| it.stride * (it.count - 1)).sum();
        self.found.push(Write {
            unit,
            start: place.offset,
            end: place.offset + reach + self.program.size(place.ty),
            file: self.sources.file_name(span).to_owned(),
            position: self.sources.position(span.start),
            value: value.filter(|_| place.bit.is_none()),
            is_call,
        });
    }

    fn statements(&mut self, list: &[Stmt]) {
        for statement in list {
            self.statement(statement);
        }
    }

    fn statement(&mut self, statement: &Stmt) {
        let span = statement.span;
        match &statement.kind {
            StmtKind::Assign(place, value) => {
                self.write(place, span, value.constant(), false);
                self.expression(value, span);
            }
            StmtKind::Evaluate(value) => self.expression(value, span),
            StmtKind::Block(call) => {
                for (input, value) in &call.inputs {
                    let mut place = call.instance.clone();
                    place.offset += input.offset;
                    place.ty = input.ty;
                    self.write(&place, value.span, value.constant(), false);
                }
                self.write(&call.instance, span, None, true);
                for (_, place) in &call.references {
                    self.write(place, span, None, true);
                }
                for (place, _) in &call.outputs {
                    self.write(place, span, None, false);
                }
            }
            StmtKind::If(arms, other) => {
                arms.iter().for_each(|(_, body)| self.statements(body));
                self.statements(other);
            }
            StmtKind::Case(_, _, arms, other) => {
                arms.iter().for_each(|arm| self.statements(&arm.body));
                self.statements(other);
            }
            StmtKind::For(each) => {
                self.write(&each.variable, span, None, false);
                self.statements(&each.body);
            }
            StmtKind::While(_, body) | StmtKind::Repeat(body, _) => self.statements(body),
            StmtKind::Exit | StmtKind::Continue | StmtKind::Return => {}
        }
    }

    /// The writes of calls in an expression. Calls nested deep in it are left out, because few functions
    /// have outputs.
    fn expression(&mut self, value: &Expr, span: Span) {
        if let Kind::Call(call) = &value.kind {
            for (place, _) in &call.outputs {
                self.write(place, span, None, false);
            }
            for argument in &call.arguments {
                if let Argument::Reference(place) = argument {
                    self.write(place, span, None, true);
                }
            }
            if let Some(instance) = &call.instance {
                self.write(instance, span, None, true);
            }
        }
    }
}

impl Symbols {
    /// The statements that write a variable, in text order, at most 16. A call of an instance is listed
    /// only if no statement writes the variable itself. A write through an in_out is listed at the call
    /// that passes the variable. Cost: linear in the statements of the program.
    #[must_use]
    pub fn writers(&self, symbol: &Symbol) -> Vec<Writer> {
        let owners = self.owners(&symbol.path);
        let writes = |write: &&Write| {
            let own = |(unit, address): &(Option<UnitId>, u32)| {
                *unit == write.unit
                    && symbol
                        .address
                        .checked_sub(*address)
                        .is_some_and(|offset| (write.start..write.end).contains(&offset))
            };
            owners.iter().any(own)
        };
        let found: Vec<&Write> = self.writes.iter().filter(writes).collect();
        let own = found.iter().any(|write| !write.is_call);
        let kept = found
            .into_iter()
            .filter(|write| !(own && write.is_call))
            .take(MOST);
        let writer = |write: &Write| Writer {
            file: write.file.clone(),
            position: write.position,
            value: write.value.and_then(|value| value_text(symbol, value)),
        };
        kept.map(writer).collect()
    }

    /// The instances that a variable is in, from the outside in: the unit and the begin of each; and memory as a
    /// whole.
    fn owners(&self, path: &str) -> Vec<(Option<UnitId>, u32)> {
        let mut owners = vec![(None, 0)];
        let _last = self.follow(path, |part| {
            if let Type::Block(unit) = self.types.get(part.ty) {
                owners.push((Some(*unit), part.address));
            }
        });
        owners
    }
}

/// A constant as a trace shows it.
fn value_text(symbol: &Symbol, value: Constant) -> Option<String> {
    Some(match (value, &symbol.value) {
        (Constant::Integer(number), super::Value::Element(elements)) => elements
            .iter()
            .find(|(_, it)| *it == number)
            .map_or_else(|| number.to_string(), |(name, _)| name.clone()),
        (Constant::Integer(number), _) if symbol.ty == Elementary::Bool => {
            if number == 0 { "FALSE" } else { "TRUE" }.to_owned()
        }
        (Constant::Integer(number), _) => number.to_string(),
        // A trace writes -0.0 as 0.0.
        (Constant::Real(number), _) if symbol.ty == Elementary::Lreal => format!("{:?}", number + 0.0),
        (Constant::Real(_), _) => return None,
    })
}

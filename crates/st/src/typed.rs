//! The checked program: every name is an address, every expression has a type, every conversion is
//! explicit.

use crate::source::Span;
use crate::syntax::Operator;
use crate::types::{Elementary, TypeId, UnitId};

/// A variable or a part of one.
#[derive(Clone, Debug)]
pub(crate) struct Place {
    pub base: Base,
    pub offset: u32,
    pub indices: Vec<Index>,
    pub ty: TypeId,
    /// One bit of it.
    pub bit: Option<u32>,
}

impl Place {
    /// A place without indices.
    pub(crate) const fn plain(base: Base, offset: u32, ty: TypeId) -> Self {
        Self {
            base,
            offset,
            indices: Vec::new(),
            ty,
            bit: None,
        }
    }
}

/// The base of an address.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Base {
    /// The beginning of memory.
    Memory,
    /// The instance of this unit.
    This,
    /// The target of the pointer at this offset of the instance: an in_out.
    ThisPointer(u32),
    /// The target of the pointer at this address: an in_out of a function.
    MemoryPointer(u32),
    /// The instance that is being called.
    Callee,
}

/// An index that is known only at run time.
#[derive(Clone, Debug)]
pub(crate) struct Index {
    pub value: Box<Expr>,
    pub low: i64,
    pub count: u32,
    pub stride: u32,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub(crate) struct Expr {
    pub kind: Kind,
    pub ty: TypeId,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub(crate) enum Kind {
    /// Whole numbers, BOOL, bits, TIME, enumerations.
    Integer(i128),
    Real(f64),
    /// The value at a place; for a type with members or elements: its address.
    Load(Place),
    Negate(Elementary, Box<Expr>),
    Not(Elementary, Box<Expr>),
    Chain(Box<Expr>, Vec<Step>),
    Convert(Box<Expr>, Elementary, Elementary),
    /// Its value, which must be within a subrange.
    Within(Box<Expr>, Elementary, i128, i128),
    Call(Box<FunctionCall>),
    /// The bytes of a string; its address is pushed.
    Text(Vec<u8>),
    /// A function whose value is a string, built at this address.
    Join(crate::library::Function, Vec<Expr>, u32),
    /// Two strings.
    Compare(Operator, Box<[Expr; 2]>),
    /// A function of the library, computed in this type.
    Library(crate::library::Function, Elementary, Vec<Expr>),
    Wrong,
}

/// An operator and its right side; its left side is converted first.
#[derive(Clone, Debug)]
pub(crate) struct Step {
    pub convert: Option<(Elementary, Elementary)>,
    pub operator: Operator,
    pub right: Expr,
    /// The type in which it is computed; a TIME is scaled by a LINT or an LREAL.
    pub ty: Elementary,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub(crate) struct FunctionCall {
    pub unit: UnitId,
    /// Of a method: its instance.
    pub instance: Option<Place>,
    /// In the order of its parameters.
    pub arguments: Vec<Argument>,
    /// The targets of outputs, and their values there.
    pub outputs: Vec<(Place, Expr)>,
    /// The buffer for a value with members, elements or bytes, and its size: the next call of the
    /// function overwrites its own.
    pub buffer: Option<(u32, u32)>,
}

#[derive(Clone, Debug)]
pub(crate) enum Argument {
    /// A value, or the address of one with members or elements, which is copied.
    Value(Expr),
    /// The address of a variable.
    Reference(Place),
}

#[derive(Clone, Debug)]
pub(crate) struct BlockCall {
    pub instance: Place,
    pub unit: UnitId,
    /// Inputs of the called instance, and their values.
    pub inputs: Vec<(Place, Expr)>,
    /// In_outs, by member, and their variables.
    pub references: Vec<(usize, Place)>,
    /// In_outs that this call does not give: the address must have been given before.
    pub kept: Vec<usize>,
    pub outputs: Vec<(Place, Expr)>,
}

#[derive(Clone, Debug)]
pub(crate) struct Stmt {
    pub kind: StmtKind,
    pub span: Span,
}

#[derive(Clone, Debug)]
pub(crate) enum StmtKind {
    /// A variable, or one of its bits.
    Assign(Place, Expr),
    /// A function whose value is not used.
    Evaluate(Expr),
    Block(Box<BlockCall>),
    If(Vec<(Expr, Vec<Stmt>)>, Vec<Stmt>),
    Case(Expr, Elementary, Vec<Branch>, Vec<Stmt>),
    For(Box<For>),
    While(Expr, Vec<Stmt>),
    Repeat(Vec<Stmt>, Expr),
    Exit,
    Continue,
    Return,
}

#[derive(Clone, Debug)]
pub(crate) struct Branch {
    pub labels: Vec<(i128, i128)>,
    pub body: Vec<Stmt>,
}

#[derive(Clone, Debug)]
pub(crate) struct For {
    pub variable: Place,
    pub ty: Elementary,
    /// The range of the variable.
    pub range: (i128, i128),
    pub from: Expr,
    pub to: Expr,
    pub by: Expr,
    pub body: Vec<Stmt>,
}

impl Expr {
    pub(crate) const fn new(kind: Kind, ty: TypeId, span: Span) -> Self {
        Self { kind, ty, span }
    }

    pub(crate) const fn wrong(span: Span) -> Self {
        Self {
            kind: Kind::Wrong,
            ty: crate::types::WRONG,
            span,
        }
    }

    pub(crate) fn is_wrong(&self) -> bool {
        self.ty == crate::types::WRONG
    }

    pub(crate) fn constant(&self) -> Option<crate::types::Constant> {
        match self.kind {
            Kind::Integer(value) => Some(crate::types::Constant::Integer(value)),
            Kind::Real(value) => Some(crate::types::Constant::Real(value)),
            _ => None,
        }
    }
}

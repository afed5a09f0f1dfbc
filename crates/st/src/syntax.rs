//! The syntax tree: the text in its structure, with its places, before names and types are resolved.

use crate::source::Span;

/// A name as in the text.
#[derive(Clone, Debug)]
pub(crate) struct Ident {
    pub text: String,
    pub span: Span,
}

impl Ident {
    /// The key for comparisons.
    pub(crate) fn key(&self) -> String {
        self.text.to_ascii_uppercase()
    }
}

/// An item at the top level of a file.
#[derive(Debug)]
pub(crate) enum Item {
    Type(TypeDeclaration),
    Globals(Section),
    Unit(Unit),
    Configuration(Configuration),
    /// The name of something that is refused or could not be read, which has been reported.
    Damaged(Ident),
}

#[derive(Debug)]
pub(crate) struct TypeDeclaration {
    pub name: Ident,
    pub spec: TypeSpec,
    pub initial: Option<Initial>,
    /// Whether parts of it could not be read, which has been reported.
    pub damaged: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum UnitKind {
    Function,
    FunctionBlock,
    Program,
    Method,
}

/// A program, a function block, a function or a method.
#[derive(Debug)]
pub(crate) struct Unit {
    pub kind: UnitKind,
    pub name: Ident,
    pub result: Option<TypeSpec>,
    pub sections: Vec<Section>,
    pub body: Vec<Statement>,
    /// Of a function block.
    pub methods: Vec<Self>,
    /// Of a method: whether only its block calls it.
    pub private: bool,
    /// Whether it has variables that could not be read or are refused, which has been reported.
    pub damaged: bool,
}

impl Unit {
    /// A unit without contents.
    pub(crate) const fn new(kind: UnitKind, name: Ident, result: Option<TypeSpec>) -> Self {
        Self {
            kind,
            name,
            result,
            sections: Vec::new(),
            body: Vec::new(),
            methods: Vec::new(),
            private: false,
            damaged: false,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SectionKind {
    Var,
    Input,
    Output,
    InOut,
    Temp,
    Static,
    External,
    Global,
}

/// VAR .. END_VAR.
#[derive(Debug)]
pub(crate) struct Section {
    pub kind: SectionKind,
    pub constant: bool,
    pub retain: bool,
    pub variables: Vec<Variables>,
    /// Whether others of its variables could not be read, which has been reported.
    pub damaged: bool,
}

impl Section {
    /// A section without CONSTANT and RETAIN.
    pub(crate) const fn plain(kind: SectionKind, variables: Vec<Variables>, damaged: bool) -> Self {
        Self {
            kind,
            constant: false,
            retain: false,
            variables,
            damaged,
        }
    }
}

/// Names that are declared together.
#[derive(Debug)]
pub(crate) struct Variables {
    pub names: Vec<(Ident, Option<Ident>)>,
    pub spec: TypeSpec,
    pub initial: Option<Initial>,
}

#[derive(Debug)]
pub(crate) struct TypeSpec {
    pub kind: SpecKind,
    pub span: Span,
}

#[derive(Debug)]
pub(crate) enum SpecKind {
    Named(Ident),
    Subrange {
        base: Ident,
        low: Expression,
        high: Expression,
    },
    Array {
        bounds: Vec<(Expression, Expression)>,
        of: Box<TypeSpec>,
    },
    Enumeration {
        base: Option<Ident>,
        elements: Vec<(Ident, Option<Expression>)>,
    },
    Structure(Vec<Variables>),
    /// STRING with a given length.
    Text(Box<Expression>),
    /// Its fault has been reported.
    Wrong,
}

#[derive(Debug)]
pub(crate) enum Initial {
    Value(Expression),
    /// `[1, 3(0)]`: the number of times, and the value.
    List(Vec<(Option<Expression>, Initial)>, Span),
    /// `(X := 1.0, Y := 2.0)`
    Members(Vec<(Ident, Initial)>, Span),
}

#[derive(Debug)]
pub(crate) struct Expression {
    pub kind: ExpressionKind,
    pub span: Span,
}

#[derive(Debug)]
pub(crate) enum ExpressionKind {
    Bool(bool),
    Integer(i128),
    Real(f64),
    /// Nanoseconds; whether it is an LTIME.
    Duration(i64, bool),
    /// The bytes of `'text'`.
    Text(Vec<u8>),
    /// `INT#5`
    Typed(Ident, Box<Expression>),
    /// `E#a`
    Element(Ident, Ident),
    Path(Path),
    Call(Box<Call>),
    Negative(Box<Expression>),
    Not(Box<Expression>),
    /// Operators of one level, from left to right: a chain, so that a long sum is not deep.
    Chain(Box<Expression>, Vec<(Operator, Span, Expression)>),
    /// Its error has been reported.
    Wrong,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Operator {
    Or,
    OrElse,
    Xor,
    And,
    AndThen,
    Equal,
    NotEqual,
    Less,
    LessEqual,
    Greater,
    GreaterEqual,
    Add,
    Subtract,
    Multiply,
    Divide,
    Modulo,
    Power,
}

impl Operator {
    /// Its precedence; a larger number binds tighter.
    pub(crate) const fn level(self) -> u8 {
        match self {
            Self::Or | Self::OrElse => 1,
            Self::Xor => 2,
            Self::And | Self::AndThen => 3,
            Self::Equal | Self::NotEqual => 4,
            Self::Less | Self::LessEqual | Self::Greater | Self::GreaterEqual => 5,
            Self::Add | Self::Subtract => 6,
            Self::Multiply | Self::Divide | Self::Modulo => 7,
            Self::Power => 8,
        }
    }

    pub(crate) const fn text(self) -> &'static str {
        match self {
            Self::Or => "OR",
            Self::OrElse => "OR_ELSE",
            Self::Xor => "XOR",
            Self::And => "AND",
            Self::AndThen => "AND_THEN",
            Self::Equal => "=",
            Self::NotEqual => "<>",
            Self::Less => "<",
            Self::LessEqual => "<=",
            Self::Greater => ">",
            Self::GreaterEqual => ">=",
            Self::Add => "+",
            Self::Subtract => "-",
            Self::Multiply => "*",
            Self::Divide => "/",
            Self::Modulo => "MOD",
            Self::Power => "**",
        }
    }
}

/// `Units[i].Mv.Done`, `w.%X3`
#[derive(Debug)]
pub(crate) struct Path {
    /// Whether `THIS^.` is before it.
    pub this: bool,
    pub root: Ident,
    pub selectors: Vec<Selector>,
    pub span: Span,
}

#[derive(Debug)]
pub(crate) enum Selector {
    Member(Ident),
    Index(Vec<Expression>, Span),
    Bit(u32, Span),
}

#[derive(Debug)]
pub(crate) struct Call {
    pub callee: Path,
    pub arguments: Vec<Argument>,
    pub span: Span,
}

#[derive(Debug)]
pub(crate) struct Argument {
    pub name: Option<Ident>,
    pub way: Way,
    /// Absent in `Out =>`, which assigns to nothing, and in `In :=`, which gives nothing.
    pub value: Option<Expression>,
    pub span: Span,
}

/// The direction of an argument.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Way {
    /// `x` or `In := x`
    In,
    /// `Out => x`
    Out,
    /// `NOT Out => x`
    OutInverted,
}

#[derive(Debug)]
pub(crate) struct Statement {
    pub kind: StatementKind,
    pub span: Span,
}

#[derive(Debug)]
pub(crate) enum StatementKind {
    Empty,
    Assign(Path, Expression),
    Call(Call),
    If(Vec<(Expression, Vec<Statement>)>, Vec<Statement>),
    Case(Case),
    For(Box<For>),
    While(Expression, Vec<Statement>),
    Repeat(Vec<Statement>, Expression),
    Exit,
    Continue,
    Return,
}

#[derive(Debug)]
pub(crate) struct Case {
    pub selector: Expression,
    pub branches: Vec<Branch>,
    pub other: Option<Vec<Statement>>,
}

#[derive(Debug)]
pub(crate) struct Branch {
    /// From, and up to.
    pub labels: Vec<(Expression, Option<Expression>)>,
    pub body: Vec<Statement>,
}

#[derive(Debug)]
pub(crate) struct For {
    pub variable: Ident,
    pub from: Expression,
    pub to: Expression,
    pub by: Option<Expression>,
    pub body: Vec<Statement>,
}

#[derive(Debug)]
pub(crate) struct Configuration {
    pub name: Ident,
    pub globals: Vec<Section>,
    pub tasks: Vec<Task>,
    pub programs: Vec<Instance>,
}

#[derive(Debug)]
pub(crate) struct Task {
    pub name: Ident,
    pub interval: Option<Expression>,
    pub priority: Option<Expression>,
}

/// PROGRAM name WITH task : type (..);
#[derive(Debug)]
pub(crate) struct Instance {
    pub name: Ident,
    pub task: Option<Ident>,
    pub program: Ident,
    pub arguments: Vec<Argument>,
    pub span: Span,
}

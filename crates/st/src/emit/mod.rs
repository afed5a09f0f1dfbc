//! From the checked program to a module.
//!
//! Every unit that is called becomes a function: an instance gets its address, a FUNCTION its parameters. A call is
//! written with space for any function number. The number is filled in at the end, when all functions have one.

mod call;
mod convert;
mod expression;
mod function;
mod library;
mod looping;
mod operator;
mod place;
mod statement;
mod text;

use crate::check::{Body, Program};
use crate::coverage::Counters;
use crate::error::{Code, Diagnostic};
use crate::layout;
use crate::source::{Sources, Span};
use crate::types::UnitId;
use function::Function;
use std::collections::BTreeMap;
use wasm_encoder::{
    CodeSection, ConstExpr, DataSection, EntityType, ExportKind, ExportSection, FunctionSection,
    GlobalSection, GlobalType, ImportSection, MemorySection, MemoryType, Module, TypeSection, ValType,
};

/// Largest number of bytes of a function; interpreters and browsers refuse more.
const FUNCTION_MOST: usize = 7_000_000;

/// Largest number of variables that are exported by name; all are in the table of symbols.
const EXPORTS_MOST: usize = 900;

/// The target of a call.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Target {
    /// `(site, value)`: records a fault, and traps.
    Fault,
    Unit(UnitId),
    Text(text::Helper),
    Import(&'static str),
}

/// The kinds of faults.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum FaultKind {
    /// A division of whole numbers by zero; the value is the dividend.
    DivisionByZero,
    /// An index outside its bounds; the value is the index.
    Index,
    /// A value outside its subrange; the fault has this value.
    Subrange,
    /// MUX chose an input that it does not have; the value is K.
    Choice,
    /// FOR has a step of 0.
    Step,
    /// A VAR_IN_OUT was never bound.
    Unbound,
    /// A position outside a string, or a negative length; the fault has this value.
    Position,
    /// No fault: a loop, which is reported if the fuel is used up.
    Loop,
}

impl FaultKind {
    /// The text behind "the program stopped: ".
    #[must_use]
    pub const fn text(self) -> &'static str {
        match self {
            Self::DivisionByZero => "a division by zero",
            Self::Index => "an index outside the bounds of its array",
            Self::Subrange => "a value outside its subrange",
            Self::Choice => "MUX has no such input",
            Self::Step => "a FOR with a step of 0",
            Self::Unbound => "a VAR_IN_OUT that was never given",
            Self::Position => "a position outside of its string",
            Self::Loop => "a loop that did not end",
        }
    }

    /// The meaning of the fault's value; empty if it has none.
    #[must_use]
    pub fn value(self, value: i64) -> Option<String> {
        let what = match self {
            Self::DivisionByZero => "the dividend",
            Self::Index => "the index",
            Self::Subrange => "the value",
            Self::Choice => "K",
            Self::Position => "the position",
            Self::Step | Self::Unbound | Self::Loop => return None,
        };
        Some(format!("{what} is {value}"))
    }
}

/// A place where a fault can happen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Site {
    pub span: Span,
    pub kind: FaultKind,
}

/// The data of the module while its functions are written.
struct Context<'p, 'a> {
    program: &'p Program<'a>,
    bodies: BTreeMap<UnitId, &'p Body>,
    /// All called targets, in the order of their first call.
    wanted: Vec<Target>,
    numbers: BTreeMap<Target, usize>,
    sites: Vec<Site>,
    counters: &'p Counters,
    /// Initial values of variables that are created at every call, behind everything else.
    templates: Vec<u8>,
    templates_at: u32,
    sources: &'p Sources,
}

impl Context<'_, '_> {
    fn want(&mut self, target: Target) -> usize {
        if let Some(number) = self.numbers.get(&target) {
            return *number;
        }
        let number = self.wanted.len();
        self.wanted.push(target);
        self.numbers.insert(target, number);
        number
    }

    fn site(&mut self, span: Span, kind: FaultKind) -> i32 {
        self.sites.push(Site { span, kind });
        i32::try_from(self.sites.len()).unwrap_or(i32::MAX)
    }
}

/// A module and its places.
pub(crate) struct Emitted {
    pub wasm: Vec<u8>,
    pub sites: Vec<Site>,
}

/// Writes the module; `image` is the memory before the first scan.
pub(crate) fn emit(
    program: &Program<'_>,
    image: &[u8],
    counters: &Counters,
    sources: &Sources,
) -> Result<Emitted, Diagnostic> {
    let mut context = Context {
        program,
        bodies: program.bodies.iter().map(|body| (body.unit, body)).collect(),
        wanted: Vec::new(),
        numbers: BTreeMap::new(),
        sites: Vec::new(),
        counters,
        templates: Vec::new(),
        templates_at: program.layout.end.next_multiple_of(8),
        sources,
    };
    context.want(Target::Fault);
    let mut exported = vec![("plc_scan".to_owned(), statement::scan(&mut context, None))];
    for (place, task) in program.tasks.iter().enumerate() {
        let name = crate::symbols::entry(&task.name);
        exported.push((name, statement::scan(&mut context, Some(place))));
    }
    if exported.iter().any(|(_, scan)| scan.code.len() > FUNCTION_MOST) {
        return Err(too_large(Span::default()));
    }
    let mut functions: Vec<(Target, Function)> = Vec::new();
    let mut next = 0;
    while let Some(target) = context.wanted.get(next).copied() {
        next += 1;
        let function = match target {
            Target::Import(_) => continue,
            Target::Fault => fault_function(),
            Target::Text(helper) => text::helper(helper),
            Target::Unit(unit) => statement::unit(&mut context, unit),
        };
        if function.code.len() > FUNCTION_MOST {
            return Err(too_large(match target {
                Target::Unit(unit) => program.unit(unit).span,
                _ => Span::default(),
            }));
        }
        functions.push((target, function));
    }
    let wasm = module(&context, functions, exported, image);
    Ok(Emitted {
        wasm,
        sites: context.sites,
    })
}

fn too_large(span: Span) -> Diagnostic {
    let what = "this is larger than a function of a module may be";
    Diagnostic::error(Code::TooLarge, span, what).help("take parts of it out into function blocks")
}

/// Records the place and the value of a fault, and traps.
fn fault_function() -> Function {
    let mut function = Function::new(vec![ValType::I32, ValType::I64], None);
    function
        .sink()
        .i32_const(0)
        .local_get(0)
        .i32_store(function::at(layout::FAULT_SITE, 2));
    function
        .sink()
        .i32_const(0)
        .local_get(1)
        .i64_store(function::at(layout::FAULT_VALUE, 3));
    function.sink().unreachable();
    function
}

/// Puts the functions, the memory and the exports together.
fn module(
    context: &Context<'_, '_>,
    mut functions: Vec<(Target, Function)>,
    exported: Vec<(String, Function)>,
    image: &[u8],
) -> Vec<u8> {
    let program = context.program;
    let imports = context.wanted.iter().filter(|it| matches!(it, Target::Import(_)));
    let mut indices: BTreeMap<Target, u32> = imports.copied().zip(0..).collect();
    let imported = indices.len() as u32;
    indices.extend(functions.iter().map(|(target, _)| *target).zip(imported..));

    let mut exports = ExportSection::new();
    exports.export("memory", ExportKind::Memory, 0);
    for (index, (name, function)) in (imported + functions.len() as u32..).zip(exported) {
        exports.export(&name, ExportKind::Func, index);
        // The owner of the target does not matter.
        functions.push((Target::Fault, function));
    }

    let mut types = Signatures::default();
    let mut import_section = ImportSection::new();
    for target in &context.wanted {
        let Target::Import(name) = target else { continue };
        let (parameters, result) = match *name {
            "math_pow" | "math_atan2" => (vec![ValType::F64; 2], ValType::F64),
            name if name.starts_with("math_") => (vec![ValType::F64], ValType::F64),
            _ => (vec![ValType::I32; 3], ValType::I32),
        };
        import_section.import(
            "standstill",
            name,
            EntityType::Function(types.number(&parameters, Some(result))),
        );
    }
    let mut function_section = FunctionSection::new();
    let mut code = CodeSection::new();
    for (_, function) in functions {
        function_section.function(types.number(&function.parameters, function.result));
        code.raw(&function.finish(|target| indices.get(&target).copied().unwrap_or(0)));
    }
    let mut memory = MemorySection::new();
    let end = u64::from(context.templates_at) + context.templates.len() as u64;
    memory.memory(MemoryType {
        minimum: end.div_ceil(1 << 16).max(1),
        maximum: None,
        memory64: false,
        shared: false,
        page_size_log2: None,
    });
    let globals = variables(program, &mut exports);

    let mut module = Module::new();
    module.section(&types.section);
    if imported > 0 {
        module.section(&import_section);
    }
    module.section(&function_section);
    module.section(&memory);
    if !globals.is_empty() {
        module.section(&globals);
    }
    module.section(&exports);
    module.section(&code);
    let mut data = DataSection::new();
    segments(image, 0, &mut data);
    segments(&context.templates, context.templates_at, &mut data);
    if !data.is_empty() {
        module.section(&data);
    }
    module.finish()
}

/// The types of functions, each once.
#[derive(Default)]
struct Signatures {
    section: TypeSection,
    known: Vec<(Vec<ValType>, Option<ValType>)>,
}

impl Signatures {
    fn number(&mut self, parameters: &[ValType], result: Option<ValType>) -> u32 {
        let same = |known: &(Vec<ValType>, Option<ValType>)| known.0 == parameters && known.1 == result;
        let place = self.known.iter().position(same).unwrap_or_else(|| {
            self.section.ty().function(parameters.iter().copied(), result);
            self.known.push((parameters.to_vec(), result));
            self.known.len() - 1
        });
        place as u32
    }
}

/// Exports the addresses of global variables of elementary types by their paths.
fn variables(program: &Program<'_>, exports: &mut ExportSection) -> GlobalSection {
    let mut globals = GlobalSection::new();
    let variables = program.globals.iter();
    let variables = variables.filter(|global| program.types.elementary(global.member.ty).is_some());
    let free = |name: &str| name != "memory" && !name.starts_with("plc_");
    for (place, global) in variables
        .filter(|global| free(&global.member.name))
        .take(EXPORTS_MOST)
        .enumerate()
    {
        let ty = GlobalType {
            val_type: ValType::I32,
            mutable: false,
            shared: false,
        };
        globals.global(ty, &ConstExpr::i32_const(global.member.offset.cast_signed()));
        exports.export(&global.path(), ExportKind::Global, place as u32);
    }
    globals
}

/// The parts of the memory that are not 0; at most 400, because interpreters limit them.
fn segments(image: &[u8], at: u32, data: &mut DataSection) {
    let mut gap = 16;
    let runs = loop {
        let runs = runs(image, gap);
        if runs.len() <= 400 {
            break runs;
        }
        gap *= 2;
    };
    for run in runs {
        let offset = at + run.start as u32;
        let bytes = image.get(run).unwrap_or_default();
        data.active(
            0,
            &ConstExpr::i32_const(offset.cast_signed()),
            bytes.iter().copied(),
        );
    }
}

/// Parts of the image with fewer than `gap` zeros in a row inside.
fn runs(image: &[u8], gap: usize) -> Vec<std::ops::Range<usize>> {
    let mut runs: Vec<std::ops::Range<usize>> = Vec::new();
    for (place, _) in image.iter().enumerate().filter(|(_, byte)| **byte != 0) {
        match runs.last_mut() {
            Some(last) if place - last.end < gap => last.end = place + 1,
            _ => runs.push(place..place + 1),
        }
    }
    runs
}

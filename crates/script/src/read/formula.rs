//! Expressions: a string that begins with `=` is an expression in Structured Text over the signals of the
//! script.

use super::Reader;
use super::condition::Kind;
use super::json::Node;
use super::program::ARE_RUN;
use crate::error::{Code, Diagnostic, quoted};
use crate::model::{Formula, FormulaInput, Signal, Span, Variable};
use standstill_axis::AxisState;
use standstill_fb::{EnumInfo, PinType};
use standstill_guest::{LoadError, Settings};
use standstill_st::{self as st, Options, Reference, Source};

/// Largest number of expressions of a script; each has a page of memory of its own.
const FORMULAS_MAX: usize = 1000;

/// The begin of an expression.
const SIGN: char = '=';

/// The use of an expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Reads {
    /// In a wire: the value at the call of its block.
    Now,
    /// In a condition: a row of the trace.
    Row,
}

/// The text of an expression with its signals replaced by the names of variables.
#[derive(Default)]
struct Body {
    text: String,
    /// Pieces: the begin of each here and in the original, its length here and there.
    pieces: Vec<[usize; 4]>,
}

impl Body {
    fn push(&mut self, text: &str, from: usize, length: usize) {
        self.pieces.push([self.text.len(), from, text.len(), length]);
        self.text.push_str(text);
    }

    /// The place in the original.
    fn original(&self, at: usize) -> usize {
        let piece = self.pieces.iter().rev().find(|piece| piece[0] <= at);
        piece.map_or(0, |[begin, from, here, there]| match here == there {
            true => from + (at - begin).min(*there),
            false if at == *begin => *from,
            false => from + there,
        })
    }
}

/// An expression in the text of a string; `None` if it is none.
pub(super) fn expression(text: &str) -> Option<&str> {
    text.strip_prefix(SIGN)
}

impl Reader {
    /// The expression in `node`, whose value is of type `ty`; its number.
    pub(super) fn formula(&mut self, node: &Node, text: &str, ty: PinType, reads: Reads) -> Option<usize> {
        let inner = expression(text)?;
        if !ARE_RUN {
            let message = format!("the expression cannot run: {}", LoadError::NotBuilt);
            return self.refuse(Diagnostic::new(Code::NotBuilt, node.span, message));
        }
        if self.formulas.len() >= FORMULAS_MAX {
            let message = format!("a script has at most {FORMULAS_MAX} expressions");
            return self.refuse(Diagnostic::new(Code::TooLarge, node.span, message));
        }
        let place = Place::new(node.span, text);
        let references = match st::references(inner) {
            Ok(references) => references,
            Err(report) => {
                self.refused(&report, |at| at, place, &[]);
                return None;
            }
        };
        let mut declared = Declared::default();
        let body = self.body(inner, &references, reads, place, &mut declared)?;
        let wanted = match ty {
            PinType::Axis(_) | PinType::Table(_) => {
                let message = format!("an expression gives no {}", ty.iec_name());
                return self.refuse(Diagnostic::new(Code::WrongType, node.span, message));
            }
            other => other.iec_name(),
        };
        let head = format!(
            "{}PROGRAM Expression\n{}VAR_OUTPUT result : {wanted}; END_VAR\nresult :=\n",
            declared.types,
            declared.variables()
        );
        let program = format!("{head}{}\n;\nEND_PROGRAM\n", body.text);
        let source = Source {
            name: "expression",
            bytes: program.as_bytes(),
        };
        let compiled = match st::compile(&[source], &Options::default()) {
            Ok(compiled) => compiled,
            Err(report) => {
                let back = |at: usize| body.original(at.saturating_sub(head.len()));
                self.refused(&report, back, place, &declared.paths);
                return None;
            }
        };
        let settings = Settings {
            memory: 1 << 20,
            ..Settings::default()
        };
        let guest = match standstill_guest::Program::compile(&compiled.wasm, settings) {
            Ok(guest) => guest,
            Err(why) => {
                let message = format!("the expression cannot run: {why}");
                return self.refuse(Diagnostic::new(Code::BadProgram, node.span, message));
            }
        };
        let find = |name: &str| compiled.symbols.find(name);
        let inputs = declared
            .inputs
            .iter()
            .enumerate()
            .map(|(place, (signal, names))| {
                let symbol = find(&variable(place))?;
                let variable = Variable::new(&symbol);
                Some(FormulaInput {
                    signal: signal.clone(),
                    symbol: standstill_guest::Symbol {
                        ty: variable.read_as(),
                        address: symbol.address,
                    },
                    variable,
                    names: names.clone(),
                })
            });
        let inputs = inputs.collect::<Option<Vec<_>>>()?;
        let result = find("result")?;
        self.formulas.push(Formula {
            text: text.to_owned(),
            span: node.span,
            in_rows: reads == Reads::Row,
            guest,
            inputs,
            result: standstill_guest::Symbol {
                ty: Variable::new(&result).read_as(),
                address: result.address,
            },
            ty,
            places: compiled.symbols.places().iter().map(|place| place.kind).collect(),
        });
        Some(self.formulas.len() - 1)
    }

    /// The text with declared variables in the place of signals.
    fn body(
        &mut self,
        text: &str,
        references: &[Reference],
        reads: Reads,
        place: Place,
        declared: &mut Declared,
    ) -> Option<Body> {
        let mut body = Body::default();
        let (mut at, mut good) = (0, true);
        for reference in references {
            let root = reference.path.split(['.', '[']).next().unwrap_or_default();
            // A name that the script does not have may belong to an enumeration; if not, the compiler
            // reports it.
            if self.names.get(root).is_none() {
                continue;
            }
            let (start, end) = (reference.span.start as usize, reference.span.end as usize);
            let span = place.of(start, end);
            let Some((signal, kind)) = self.formula_signal(&reference.path, span, reads) else {
                good = false;
                continue;
            };
            let Some(name) = self.declare_signal(declared, &reference.path, signal, kind, span) else {
                good = false;
                continue;
            };
            body.push(text.get(at..start)?, at, start - at);
            body.push(&name, start, end - start);
            at = end;
        }
        body.push(text.get(at..)?, at, text.len() - at);
        good.then_some(body)
    }

    /// The signal that an expression reads by this name.
    fn formula_signal(&mut self, path: &str, span: Span, reads: Reads) -> Option<(Signal, Kind)> {
        let (signal, kind) = self.signal(path, span)?;
        if let (Signal::Difference(..), Reads::Now) = (&signal, reads) {
            let message = format!(
                "{} is known when the scan is over: conditions read it, wires do not",
                quoted(path)
            );
            return self.refuse(Diagnostic::new(Code::UnknownSignal, span, message));
        }
        Some((signal, kind))
    }

    /// The variable for a signal.
    fn declare_signal(
        &mut self,
        declared: &mut Declared,
        path: &str,
        signal: Signal,
        kind: Kind,
        span: Span,
    ) -> Option<String> {
        if let Some(known) = declared.inputs.iter().position(|(other, _)| *other == signal) {
            return Some(variable(known));
        }
        let (ty, names) = match kind {
            Kind::State => {
                let names: Vec<_> = (0..)
                    .zip(AxisState::ALL)
                    .map(|(number, state)| (state.name().to_owned(), number))
                    .collect();
                (declared.enumeration("AXIS_STATE", &names), names)
            }
            Kind::Pin(PinType::Enum(info)) => (info.name.to_owned(), of_info(&info)),
            Kind::Master | Kind::Pin(PinType::Axis(_) | PinType::Table(_)) => {
                let message = format!(
                    "{} is {}, which expressions do not read",
                    quoted(path),
                    kind.name()
                );
                return self.refuse(Diagnostic::new(Code::WrongType, span, message));
            }
            Kind::Pin(ty) => (ty.iec_name().to_owned(), Vec::new()),
            Kind::Variable(..) => {
                let variable = self.variable_of(kind)?;
                match variable.elements() {
                    None => (variable.elementary().name().to_owned(), Vec::new()),
                    // Enumerations of the library are known.
                    Some(elements) if is_library(variable.type_name()) => {
                        (variable.type_name().to_owned(), elements.to_vec())
                    }
                    Some(elements) => (
                        declared.enumeration(variable.type_name(), elements),
                        elements.to_vec(),
                    ),
                }
            }
        };
        declared.paths.push(path.to_owned());
        declared.declarations.push(ty);
        declared.inputs.push((signal, names));
        Some(variable(declared.inputs.len() - 1))
    }

    /// Reports the faults of an expression in the words of the compiler.
    fn refused(
        &mut self,
        report: &st::Report,
        back: impl Fn(usize) -> usize,
        place: Place,
        paths: &[String],
    ) {
        for wrong in report
            .diagnostics()
            .iter()
            .filter(|it| it.severity == st::Severity::Error)
        {
            let span = place.of(back(wrong.span.start as usize), back(wrong.span.end as usize));
            let mut message = wrong.message.clone();
            let mut help = wrong.help.clone();
            message = message.replace("the end of the file", "its end");
            // The longest numbers first: `signal_12` begins like `signal_1`.
            for (number, path) in paths.iter().enumerate().rev() {
                message = message.replace(&variable(number), path);
                help = help.map(|help| help.replace(&variable(number), path));
            }
            if wrong.code == st::Code::UnknownName {
                message = message.replace("variable", "signal, input variable or element");
                help = help.filter(|help| !help.contains("VAR"));
            }
            self.report(Diagnostic::new(Code::BadExpression, span, message).maybe_help(help));
        }
    }
}

/// The variable for a signal.
fn variable(number: usize) -> String {
    format!("signal_{number}")
}

fn of_info(info: &EnumInfo) -> Vec<(String, i128)> {
    info.elements
        .iter()
        .map(|(name, number)| ((*name).to_owned(), i128::from(*number)))
        .collect()
}

/// Whether a type is one of the pins of blocks.
fn is_library(name: &str) -> bool {
    let pins = standstill_blocks::REGISTRY.iter().flat_map(|info| info.pins());
    pins.filter_map(|pin| match pin.ty {
        PinType::Enum(info) => Some(info.name),
        _ => None,
    })
    .any(|known| known.eq_ignore_ascii_case(name))
}

/// The declarations in the program of an expression.
#[derive(Default)]
struct Declared {
    /// Enumerations of programs, and that of axis states.
    types: String,
    /// Types of the variables.
    declarations: Vec<String>,
    /// Signals, with names and numbers of their elements if they have some.
    inputs: Vec<(Signal, Vec<(String, i128)>)>,
    /// Their names in the script.
    paths: Vec<String>,
    /// Names of enumerations that are taken.
    taken: Vec<(String, Vec<(String, i128)>)>,
}

impl Declared {
    fn variables(&self) -> String {
        let declarations = self.declarations.iter().enumerate();
        let lines =
            declarations.map(|(number, ty)| format!("VAR_INPUT {} : {ty}; END_VAR\n", variable(number)));
        lines.collect()
    }

    /// Declares an enumeration. If two programs have one of the same name, one of them gets another name.
    fn enumeration(&mut self, name: &str, elements: &[(String, i128)]) -> String {
        let same = |(_, known): &&(String, Vec<(String, i128)>)| known == elements;
        if let Some((known, _)) = self.taken.iter().find(same) {
            return known.clone();
        }
        // An enumeration without a name is called by these words.
        let name = if name.contains(' ') { "Enumeration" } else { name };
        let is_taken = self
            .taken
            .iter()
            .any(|(known, _)| known.eq_ignore_ascii_case(name));
        let name = if is_taken {
            format!("{name}_{}", self.taken.len())
        } else {
            name.to_owned()
        };
        let listed: Vec<_> = elements
            .iter()
            .map(|(name, number)| format!("{name} := {number}"))
            .collect();
        self.types
            .push_str(&format!("TYPE {name} : ({}) DINT; END_TYPE\n", listed.join(", ")));
        self.taken.push((name.clone(), elements.to_vec()));
        name
    }
}

/// The place of an expression's text.
#[derive(Clone, Copy)]
struct Place {
    span: Span,
    /// Whether every byte of the text is one of the file.
    plain: bool,
}

impl Place {
    fn new(span: Span, text: &str) -> Self {
        let plain = span.end - span.start == text.len() + 2;
        Self { span, plain }
    }

    /// A part of the text behind its sign.
    fn of(self, start: usize, end: usize) -> Span {
        if !self.plain {
            return self.span;
        }
        // A quote and the sign are before it, a quote after it.
        let at = |offset: usize| (self.span.start + 2 + offset).min(self.span.end - 1);
        Span {
            start: at(start),
            end: at(end).max(at(start)),
        }
    }
}

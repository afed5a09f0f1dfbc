//! Programs in Structured Text: their sources, their axes, and which of their variables are columns.

use super::json::{Json, Node};
use super::names::{Entity, suggestion};
use super::program::{FAULT, LoadGuest};
use super::task::MAIN;
use super::value::{Fields, wrong_type};
use super::{Reader, is_note};
use crate::error::{Code, Diagnostic, quoted};
use crate::model::{Call, Doubt, Place, Point, Program, ProgramText, Span, Symbol, Task, Variable};
use standstill_fb::PinType;
use standstill_guest::Settings;
use standstill_st::{self as st, Compiled, Options, Source, Symbols};
use std::sync::Arc;

/// Factor on the fuel of a program that counts its statements: counting one takes six instructions.
const COUNTING: u64 = 16;

/// Largest number of files of a program.
const FILES_MAX: usize = 64;

/// Largest number of variables of a program that are columns.
const COLUMNS_MAX: usize = 4096;

/// Largest number of instances of blocks whose names are known; a guest has fewer.
const BLOCKS_MAX: usize = 4096;

/// Largest number of variables that are searched for a suggestion.
const GUESSES_MAX: usize = 2000;

/// Without a byte order mark.
fn text(bytes: &[u8]) -> String {
    let text = String::from_utf8_lossy(bytes);
    text.strip_prefix('\u{FEFF}').unwrap_or(&text).to_owned()
}

/// The warnings of a report. A warning about other compilers says nothing about this run.
fn doubtful(report: &st::Report) -> Vec<Doubt> {
    let each = report.diagnostics().iter();
    let each = each.filter(|it| it.code != st::Code::Portability);
    let doubts = each.map(|it| {
        let (from, _) = report.positions(it.span);
        let (file, line, column) = (report.file_name(it.span), from.line, from.column);
        Doubt {
            message: format!("{file}:{line}:{column}: {}", it.message),
            help: it.help.clone().unwrap_or_default(),
        }
    });
    doubts.collect()
}

impl Reader {
    /// A program with the sources in `st`.
    pub(super) fn text_program(
        &mut self,
        name: &str,
        fields: &Fields<'_>,
        place: Place,
        mut settings: Settings,
        load: LoadGuest<'_>,
    ) -> Option<Program> {
        let files = self.sources(fields.get("st")?, load);
        let bindings = self.bindings(fields);
        let program = self.if_given(fields, "program", Self::text);
        let options = Options {
            program: program?.map(str::to_owned),
            coverage: self.terms.coverage,
            axes: self.axis_names.clone(),
            bindings: bindings?,
            ..Options::default()
        };
        if options.coverage {
            settings.fuel = settings.fuel.saturating_mul(COUNTING);
        }
        let files = files?;
        let compiled = self.compiled(&files, &options, fields)?;
        let guest = match standstill_guest::Program::compile(&compiled.wasm, settings) {
            Ok(guest) => guest,
            Err(why) => {
                let message = format!("the program {} cannot run: {why}", quoted(name));
                return self.refuse(Diagnostic::new(Code::BadProgram, fields.get("st")?.span, message));
            }
        };
        let symbols = self.columns(name, fields, &compiled.symbols)?;
        let blocks = compiled.symbols.blocks(BLOCKS_MAX);
        let named = |at: st::BlockAt| {
            let path = compiled.symbols.short(&at.path);
            (at.address, format!("{name}.{path}"))
        };
        let text = ProgramText {
            blocks: blocks.into_iter().map(named).collect(),
            doubtful: doubtful(&compiled.report),
            // A compiled text is UTF-8.
            sources: files
                .into_iter()
                .map(|(name, bytes)| (name, text(&bytes)))
                .collect(),
            folder: self.folder.clone(),
            symbols: compiled.symbols,
        };
        Some(Program {
            name: name.to_owned(),
            calls: Vec::new(),
            guest,
            symbols,
            place,
            text: Some(Arc::new(text)),
        })
    }

    /// The files of `st`: their names in messages, and their texts.
    fn sources(&mut self, node: &Node, load: LoadGuest<'_>) -> Option<Vec<(String, Vec<u8>)>> {
        let items = match &node.json {
            Json::List(items) => items.as_slice(),
            _ => std::slice::from_ref(node),
        };
        if items.is_empty() || items.len() > FILES_MAX {
            let message = format!("`st` names 1 to {FILES_MAX} files");
            return self.refuse(Diagnostic::new(Code::BadValue, node.span, message));
        }
        let folder = self.folder.clone();
        self.each(items, |reader, item| {
            let Json::Text(path) = &item.json else {
                return reader.refuse(wrong_type(item, "`st`", "a path or a list of paths"));
            };
            match load(path) {
                Ok(bytes) => Some((format!("{folder}{path}"), bytes)),
                Err(why) => {
                    let message = format!("{} cannot be read: {why}", quoted(path));
                    reader.refuse(Diagnostic::new(Code::BadProgram, item.span, message))
                }
            }
        })
    }

    /// The variables of type AXIS_REF that `axes` binds, with the number of their axis.
    fn bindings(&mut self, fields: &Fields<'_>) -> Option<Vec<(String, u16)>> {
        let Some(node) = fields.get("axes") else {
            return Some(Vec::new());
        };
        let members = self.map(node, "`axes` of a program")?;
        let mut bindings = Vec::new();
        for (key, node) in members.iter() {
            if is_note(key, node) && !matches!(self.names.get("note"), Some(Entity::Axis(_))) {
                continue;
            }
            let index = self.axis_index(node, &quoted(&key.text));
            bindings.push(index.and_then(|index| Some((key.text.clone(), u16::try_from(index + 1).ok()?))));
        }
        bindings.into_iter().collect()
    }

    /// Compiles. The report shows the faults of the sources with their places.
    fn compiled(
        &mut self,
        files: &[(String, Vec<u8>)],
        options: &Options,
        fields: &Fields<'_>,
    ) -> Option<Compiled> {
        let sources: Vec<_> = files.iter().map(|(name, bytes)| Source { name, bytes }).collect();
        let report = match st::compile(&sources, options) {
            Ok(compiled) => return Some(compiled),
            Err(report) => report,
        };
        let unbound = |it: &&st::Diagnostic| it.code == st::Code::UnknownBinding;
        if let Some(wrong) = report.diagnostics().iter().find(unbound) {
            let mut bound = fields.members("axes").iter();
            let key = bound.find(|(key, _)| wrong.message.contains(&format!("`{}`", key.text)));
            let span = key.map_or(fields.brace(), |(key, _)| key.span);
            return self.refuse(
                Diagnostic::new(Code::UnknownSignal, span, wrong.message.clone())
                    .maybe_help(wrong.help.clone()),
            );
        }
        let count = report.diagnostics().iter();
        let count = count.filter(|it| it.severity == st::Severity::Error).count() + report.hidden();
        let mistakes = if count == 1 { "a mistake" } else { "mistakes" };
        let message = format!("the sources of this program have {mistakes}, told below");
        let span = fields.get("st").map_or(fields.brace(), |node| node.span);
        self.report(Diagnostic::new(Code::BadProgram, span, message));
        self.reports.push(*report);
        None
    }

    /// The variables that are columns, behind `Fault`.
    fn columns(&mut self, name: &str, fields: &Fields<'_>, symbols: &Symbols) -> Option<Vec<Symbol>> {
        let found = match fields.get("trace") {
            None => symbols.usual(COLUMNS_MAX + 1),
            Some(node) => {
                let items = self.list(node, "`trace`")?;
                let lists = self.each(items, |reader, item| {
                    let path = reader.text(item, "a path of `trace`")?;
                    let found = symbols.below(path, COLUMNS_MAX + 1);
                    if found.as_ref().is_none_or(Vec::is_empty) {
                        reader.unknown_variable(name, path, symbols, item.span);
                    }
                    found
                })?;
                lists.into_iter().flatten().collect()
            }
        };
        if found.len() > COLUMNS_MAX {
            let message = format!(
                "the program {} has more than {COLUMNS_MAX} variables to show",
                quoted(name)
            );
            let help = "name those that matter: \"trace\": [\"State\", \"Mv\"]";
            return self.refuse(Diagnostic::new(Code::TooLarge, fields.brace(), message).help(help));
        }
        let mut columns = vec![fault_symbol()];
        for symbol in &found {
            let column = column(symbols, symbol);
            if !columns.iter().any(|known| known.name == column.name) {
                columns.push(column);
            }
        }
        Some(columns)
    }

    /// The variable of a program in Structured Text at a path. It becomes a column if it is not one yet.
    pub(super) fn variable_point(
        &mut self,
        index: usize,
        text: &Arc<ProgramText>,
        path: &str,
        span: Span,
    ) -> Option<(Point, PinType)> {
        let found = text
            .symbols
            .find(path)
            .map(|symbol| column(&text.symbols, &symbol));
        let program = self.programs.get_mut(index)?.as_mut()?;
        let Some(found) = found else {
            let name = program.name.clone();
            self.unknown_variable(&name, path, &text.symbols, span);
            return None;
        };
        let ty = found.ty;
        let known = program
            .symbols
            .iter()
            .position(|symbol| symbol.name == found.name);
        let place = known.unwrap_or(program.symbols.len());
        if known.is_none() {
            program.symbols.push(found);
        }
        Some((Point::Symbol(index, place), ty))
    }

    fn unknown_variable(&mut self, name: &str, path: &str, symbols: &Symbols, span: Span) {
        let inner = symbols.below(path, 1).and_then(|inner| inner.into_iter().next());
        let diagnostic = if symbols.is_text(path) {
            let message = format!("{} is a STRING, which is no signal", quoted(path));
            let help = "compare it in the program: `IsReady := Message = 'ready';`";
            Diagnostic::new(Code::UnknownSignal, span, message).help(help)
        } else if let Some(first) = inner {
            let message = format!("{} has members or elements: which of them?", quoted(path));
            let help = format!("for example `{name}.{}`", symbols.short(&first.path));
            Diagnostic::new(Code::UnknownSignal, span, message).help(help)
        } else {
            let message = format!("the program {} has no variable {}", quoted(name), quoted(path));
            let known = symbols.leaves(GUESSES_MAX);
            let known: Vec<&str> = known.iter().map(|symbol| symbols.short(&symbol.path)).collect();
            let mut indices = path.split('[').skip(1);
            let computed = indices.any(|index| index.starts_with(|c: char| c.is_ascii_alphabetic()));
            let help = if computed {
                Some("indices of signals are numbers: let the program compute what is to be read".to_owned())
            } else {
                suggestion(path, known.iter().copied())
            };
            Diagnostic::new(Code::UnknownSignal, span, message).maybe_help(help)
        };
        self.report(diagnostic);
    }

    /// The times at which the programs run. The tasks of a CONFIGURATION become tasks of the script, and its
    /// programs without one run after all of them.
    pub(super) fn program_calls(&mut self, fields: &Fields<'_>, tasks: &mut Option<Vec<Task>>) {
        if self.replaces_main(fields) {
            self.task_places.clear();
            tasks.iter_mut().for_each(Vec::clear);
        }
        for (index, (key, node)) in fields.members("programs").iter().enumerate() {
            if !matches!(node.json, Json::Map(_)) {
                continue;
            }
            let task = node.member("task");
            // A program that was refused is already reported.
            if task.is_none() && self.programs.get(index).is_none_or(Option::is_none) {
                continue;
            }
            let text = self
                .programs
                .get(index)
                .and_then(|program| program.as_ref()?.text.clone());
            let symbols = text.as_ref().map(|text| &text.symbols);
            let listed = symbols.filter(|symbols| symbols.is_configured());
            if let (Some(_), Some(node)) = (listed, task) {
                let message = "the CONFIGURATION of the sources says which tasks there are";
                self.report(Diagnostic::new(Code::BadValue, node.span, message).help("leave `task` out"));
            }
            let own = |reader: &mut Self, tasks: &mut Option<Vec<Task>>| {
                let (name, span) = match task {
                    None => {
                        reader.add_main(tasks);
                        (MAIN, key.span)
                    }
                    Some(node) => (reader.text(node, "`task`")?, node.span),
                };
                reader.task_index(name, span, tasks.as_deref())
            };
            let calls: Option<Vec<Call>> = if let Some(symbols) = listed {
                let call = |task: &st::Task| {
                    let index = if task.name.is_empty() {
                        None
                    } else {
                        Some(self.configured_task(task, key.span, tasks.as_mut())?)
                    };
                    Some(Call {
                        task: index,
                        entry: Some(task.entry.clone()),
                    })
                };
                symbols.tasks().iter().map(call).collect()
            } else {
                let task = own(self, tasks);
                task.map(|task| {
                    vec![Call {
                        task: Some(task),
                        entry: None,
                    }]
                })
            };
            if let (Some(calls), Some(Some(program))) = (calls, self.programs.get_mut(index)) {
                program.calls = calls;
            }
        }
    }

    /// Whether a TASK called `main` takes the place of the predefined one, which nobody uses.
    fn replaces_main(&self, fields: &Fields<'_>) -> bool {
        let blocks = fields.get("blocks").map(|node| &node.json);
        let no_blocks = matches!(blocks, Some(Json::List(items)) if items.is_empty());
        let programs: Option<Vec<&Symbols>> = self
            .programs
            .iter()
            .flatten()
            .map(|program| Some(&program.text.as_ref()?.symbols))
            .map(|symbols| symbols.filter(|symbols| symbols.is_configured()))
            .collect();
        let is_main = |task: &st::Task| task.name.eq_ignore_ascii_case(MAIN);
        fields.get("tasks").is_none()
            && no_blocks
            && programs.is_some_and(|all| all.iter().any(|symbols| symbols.tasks().iter().any(is_main)))
    }

    /// The script's task that a TASK becomes.
    fn configured_task(
        &mut self,
        task: &st::Task,
        span: Span,
        tasks: Option<&mut Vec<Task>>,
    ) -> Option<usize> {
        let (tasks, cycle) = (tasks?, self.cycle_ns?);
        let interval_ns = task.interval_ns.unwrap_or(cycle);
        let title = format!("TASK {}", quoted(&task.name));
        if interval_ns % cycle != 0 {
            let (interval, cycle) = (super::time::literal(interval_ns), super::time::literal(cycle));
            let message =
                format!("{title} has an INTERVAL of {interval}, no whole multiple of the cycle {cycle}");
            return self.refuse(Diagnostic::new(Code::BadTime, span, message));
        }
        let interval = Some((interval_ns / cycle).unsigned_abs());
        let priority = u32::try_from(task.priority.max(0)).unwrap_or(u32::MAX);
        let upper = task.name.to_ascii_uppercase();
        let Some(place) = self.task_places.get(&upper).copied() else {
            self.task_places.insert(upper, tasks.len());
            tasks.push(Task {
                name: task.name.clone(),
                interval,
                priority,
                single: None,
                watchdog: None,
            });
            return Some(tasks.len() - 1);
        };
        let there = tasks.get(place)?;
        if (there.interval, there.priority) != (interval, priority) {
            let shown = |scans: u64| super::time::literal(cycle.saturating_mul(scans.cast_signed()));
            let other = there.interval.map_or_else(
                || "no INTERVAL".to_owned(),
                |scans| format!("INTERVAL {}", shown(scans)),
            );
            let message = format!(
                "{title} has INTERVAL {} and PRIORITY {priority}, the task of this name that is there already has {other} and PRIORITY {}",
                super::time::literal(interval_ns),
                there.priority
            );
            let help = "give it another name, or say the same `interval` and `priority` in `tasks`";
            return self.refuse(Diagnostic::new(Code::BadTime, span, message).help(help));
        }
        Some(place)
    }
}

/// The signal that the runtime writes.
pub(super) fn fault_symbol() -> Symbol {
    Symbol {
        name: FAULT.to_owned(),
        ty: PinType::Bool,
        own: standstill_guest::SymbolType::Bool,
        address: None,
        export: None,
        variable: None,
    }
}

/// A variable as a signal. If the runtime's own signal has the same name, the variable is named by its whole path.
fn column(symbols: &Symbols, symbol: &st::Symbol) -> Symbol {
    let short = symbols.short(&symbol.path);
    let own = short.eq_ignore_ascii_case(FAULT);
    let variable = Variable::new(symbol);
    Symbol {
        name: if own {
            symbol.path.clone()
        } else {
            short.to_owned()
        },
        ty: variable.signal(),
        own: variable.read_as(),
        address: Some(symbol.address),
        export: None,
        variable: Some(variable),
    }
}

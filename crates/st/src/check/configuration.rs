//! The tasks and programs that run, from a CONFIGURATION, or the only program.

use super::{Checker, UnitKind};
use crate::error::{Code, Diagnostic, quoted};
use crate::source::Span;
use crate::syntax::{Argument, Configuration, Expression, Item, SectionKind};
use crate::typed::{Base, Place, Stmt};
use crate::types::{Class, Constant, UnitId, WRONG};

/// Programs that run together.
#[derive(Debug)]
pub(crate) struct Task {
    /// Its name; empty for the task that runs in every scan.
    pub name: String,
    /// Time from one run to the next (ns); in every scan if absent.
    pub interval_ns: Option<i64>,
    /// Priority; 0 is the highest.
    pub priority: i64,
    /// The address of its next due time.
    pub due: u32,
    /// The calls of its programs.
    pub statements: Vec<Stmt>,
}

/// A program that runs.
#[derive(Debug)]
pub(crate) struct Instance<'a> {
    pub name: String,
    pub unit: UnitId,
    /// Its task.
    pub task: usize,
    pub address: u32,
    arguments: &'a [Argument],
    span: Span,
}

impl<'a> Checker<'a> {
    /// The programs and the tasks in which they run.
    pub(super) fn configuration(&mut self, items: &'a [Item]) -> (Vec<Task>, Vec<Instance<'a>>) {
        let mut configurations = items.iter().filter_map(|item| match item {
            Item::Configuration(configuration) => Some(configuration),
            _ => None,
        });
        let first = configurations.next();
        if let (Some(first), Some(second)) = (first, configurations.next()) {
            let wrong = Diagnostic::error(Code::NoProgram, second.name.span, "there are two CONFIGURATIONs");
            self.tell(
                wrong
                    .related(first.name.span, "the other one")
                    .help("one project has one"),
            );
        }
        match (&self.options.program, first) {
            (None, Some(configuration)) => {
                self.is_configured = true;
                self.configured(configuration)
            }
            (Some(name), _) => {
                let name = name.clone();
                self.named_program(&name)
            }
            (None, None) => self.only_program(),
        }
    }

    /// The instance of a PROGRAM that runs alone, in every scan.
    fn every_scan(&self, unit: UnitId) -> (Vec<Task>, Vec<Instance<'a>>) {
        let info = self.unit(unit);
        let instance = Instance {
            name: info.name.clone(),
            unit,
            task: 0,
            address: 0,
            arguments: &[],
            span: info.span,
        };
        (vec![always()], vec![instance])
    }

    fn programs(&self) -> Vec<UnitId> {
        let units = self.units.iter().enumerate();
        let programs = units.filter(|(_, unit)| unit.kind == UnitKind::Program);
        programs.map(|(place, _)| UnitId(place as u32)).collect()
    }

    fn named_program(&mut self, name: &str) -> (Vec<Task>, Vec<Instance<'a>>) {
        let found = self.unit_names.get(&name.to_ascii_uppercase()).copied();
        let found = found.filter(|unit| self.unit(*unit).kind == UnitKind::Program);
        let Some(unit) = found else {
            let names: Vec<_> = self
                .programs()
                .iter()
                .map(|unit| self.unit(*unit).name.clone())
                .collect();
            let message = format!("there is no PROGRAM {}", quoted(name));
            let help = if names.is_empty() {
                "the sources have none".to_owned()
            } else {
                format!("there is {}", names.join(", "))
            };
            self.error(Code::NoProgram, Span::default(), message, &help);
            return (Vec::new(), Vec::new());
        };
        self.every_scan(unit)
    }

    fn only_program(&mut self) -> (Vec<Task>, Vec<Instance<'a>>) {
        match self.programs().as_slice() {
            // It may be the one that could not be read.
            [] if self.options.library || self.found.has_errors() => (Vec::new(), Vec::new()),
            [] => {
                let message = "there is no PROGRAM to run";
                self.error(
                    Code::NoProgram,
                    Span::default(),
                    message,
                    "write PROGRAM Name .. END_PROGRAM",
                );
                (Vec::new(), Vec::new())
            }
            [one] => self.every_scan(*one),
            _ if self.options.library => (Vec::new(), Vec::new()),
            [first, second, ..] => {
                let (one, other) = (self.unit(*first), self.unit(*second));
                let wrong = Diagnostic::error(Code::NoProgram, other.span, "there are several PROGRAMs");
                let wrong = wrong.related(one.span, "another one");
                self.tell(wrong.help("say which one runs, or write a CONFIGURATION with their tasks"));
                (Vec::new(), Vec::new())
            }
        }
    }

    fn configured(&mut self, configuration: &'a Configuration) -> (Vec<Task>, Vec<Instance<'a>>) {
        let mut tasks: Vec<Task> = Vec::new();
        let mut names: std::collections::BTreeMap<String, (usize, Span)> = std::collections::BTreeMap::new();
        for task in &configuration.tasks {
            let interval_ns = task.interval.as_ref().and_then(|it| self.interval(it));
            let priority = task
                .priority
                .as_ref()
                .and_then(|it| self.priority(it))
                .unwrap_or(0);
            if let Some((_, other)) = names.get(&task.name.key()) {
                self.twice(&task.name, *other);
                continue;
            }
            names.insert(task.name.key(), (tasks.len(), task.name.span));
            tasks.push(Task {
                name: task.name.text.clone(),
                interval_ns,
                priority,
                ..always()
            });
        }
        let mut instances: Vec<Instance<'a>> = Vec::new();
        let mut taken: std::collections::BTreeMap<String, Span> = std::collections::BTreeMap::new();
        let mut without = None;
        for program in &configuration.programs {
            if let Some(other) = taken.insert(program.name.key(), program.name.span) {
                self.twice(&program.name, other);
            }
            let task = match &program.task {
                None => Some(*without.get_or_insert_with(|| {
                    tasks.push(always());
                    tasks.len() - 1
                })),
                Some(name) => {
                    let found = names.get(&name.key()).map(|(task, _)| *task);
                    if found.is_none() {
                        let guess = self.guess(&name.text, names.keys().map(String::as_str));
                        let message = format!("there is no TASK {}", quoted(&name.text));
                        self.tell(Diagnostic::error(Code::UnknownName, name.span, message).maybe_help(guess));
                    }
                    found
                }
            };
            let unit = self.unit_names.get(&program.program.key()).copied();
            let unit = unit.filter(|unit| self.unit(*unit).kind == UnitKind::Program);
            let Some(unit) = unit else {
                if !self.may_be_damaged(&program.program.key()) {
                    let message = format!("there is no PROGRAM {}", quoted(&program.program.text));
                    self.error(Code::UnknownName, program.program.span, message, "");
                }
                continue;
            };
            self.look_at_unit(program.program.span, unit);
            if instances.iter().any(|it| it.unit == unit) {
                self.check_static_of_several(unit, program.name.span);
            }
            let Some(task) = task else { continue };
            instances.push(Instance {
                name: program.name.text.clone(),
                unit,
                task,
                address: 0,
                arguments: &program.arguments,
                span: program.span,
            });
        }
        if configuration.programs.is_empty() && !self.options.library {
            let message = "the CONFIGURATION runs no PROGRAM";
            self.error(
                Code::NoProgram,
                configuration.name.span,
                message,
                "write PROGRAM Name WITH Task : Type;",
            );
        }
        (tasks, instances)
    }

    /// VAR_STAT of a PROGRAM that has several instances.
    fn check_static_of_several(&mut self, unit: UnitId, span: Span) {
        let mut sections = self.unit(unit).syntax.iter().flat_map(|it| &it.sections);
        if sections.any(|it| it.kind == SectionKind::Static && !it.constant) {
            let name = &self.unit(unit).name;
            let message = format!(
                "the PROGRAM {name} has several instances, and VAR_STAT, one variable for all of them, is not supported"
            );
            let help = "use VAR_GLOBAL, or VAR if each instance shall have its own";
            self.error(Code::Unsupported, span, message, help);
        }
    }

    fn priority(&mut self, expression: &'a Expression) -> Option<i64> {
        let priority = self.whole(expression)?;
        if priority < 0 {
            let message = "PRIORITY is 0 or more";
            self.error(Code::OutOfRange, expression.span, message, "0 is the highest");
        }
        Some(i64::try_from(priority).unwrap_or(i64::MAX))
    }

    fn interval(&mut self, expression: &'a Expression) -> Option<i64> {
        let value = self.expression(expression, None);
        if value.is_wrong() {
            return None;
        }
        let time = self
            .types
            .elementary(value.ty)
            .is_some_and(|it| it.class() == Class::Time);
        match value.constant() {
            Some(Constant::Integer(ns)) if time && ns > 0 => i64::try_from(ns).ok(),
            _ => {
                let message = "INTERVAL is a constant TIME above 0";
                self.error(Code::WrongType, value.span, message, "write INTERVAL := T#10ms");
                None
            }
        }
    }

    /// Gives every variable its address.
    pub(super) fn place_all(&mut self, tasks: &mut [Task], instances: &mut [Instance<'a>]) {
        for task in tasks {
            task.due = self.layout.take(8);
        }
        for place in 0..self.globals.len() {
            let (ty, span) = (self.globals[place].member.ty, self.globals[place].member.span);
            let (size, _) = self.size(ty);
            self.globals[place].member.offset = self.layout.take(if ty == WRONG { 0 } else { size });
            self.check_memory(span);
        }
        self.place_frames(false);
        for instance in instances {
            let size = self.unit(instance.unit).members.size;
            instance.address = self.layout.take(size);
            self.check_memory(instance.span);
        }
        self.place_frames(true);
    }

    /// Gives the variables of functions an address, those of the sources or those of the library.
    fn place_frames(&mut self, prelude: bool) {
        for place in 0..self.units.len() {
            let unit = &self.units[place];
            let (span, bytes) = (unit.span, unit.members.size);
            if unit.kind.has_frame() && self.sources.in_library(span) == prelude {
                self.units[place].frame = self.layout.take(bytes);
                self.check_memory(span);
            }
        }
    }

    pub(super) fn check_memory(&mut self, span: Span) {
        if u64::from(self.layout.end) > super::spec::BYTES_MOST {
            self.too_large(span);
            self.layout.end = 0;
        }
    }

    /// The calls of the programs of each task.
    pub(super) fn run(&mut self, tasks: &mut [Task], instances: &[Instance<'a>]) {
        for instance in instances {
            let ty = self.block_type(instance.unit);
            let place = Place::plain(Base::Memory, instance.address, ty);
            let call = self.in_scope(None, |checker| {
                checker.block_call(
                    place,
                    instance.unit,
                    instance.arguments,
                    instance.span,
                    instance.span,
                )
            });
            let Some(task) = tasks.get_mut(instance.task) else {
                continue;
            };
            task.statements.extend(call.map(|kind| Stmt {
                kind,
                span: instance.span,
            }));
        }
        self.check_kept();
    }
}

fn always() -> Task {
    Task {
        name: String::new(),
        interval_ns: None,
        priority: i64::MAX,
        due: 0,
        statements: Vec::new(),
    }
}

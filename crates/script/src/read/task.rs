//! Tasks: when they run, and the task of each block.

use super::json::Node;
use super::value::Fields;
use super::{Reader, shape};
use crate::error::{Code, Diagnostic, quoted};
use crate::model::{Span, Task};
use standstill_fb::PinType;
use std::collections::BTreeMap;

/// The task of blocks that name none.
pub(super) const MAIN: &str = "main";

impl Reader {
    pub(super) fn tasks(&mut self, fields: &Fields<'_>) -> Option<Vec<Task>> {
        let Some(node) = fields.get("tasks") else {
            self.task_places.insert(MAIN.to_ascii_uppercase(), 0);
            return Some(vec![predefined()]);
        };
        let members = self.map(node, "`tasks`")?;
        let mut places: BTreeMap<String, Span> = BTreeMap::new();
        let mut tasks = Vec::new();
        for (key, node) in members.iter() {
            self.check_name(&key.text, key.span);
            let upper = key.text.to_ascii_uppercase();
            if let Some(first) = places.insert(upper.clone(), key.span) {
                let message = format!("the name {} is taken", quoted(&key.text));
                self.report(
                    Diagnostic::new(Code::DuplicateName, key.span, message).related(first, "by this task"),
                );
            }
            self.task_places.entry(upper).or_insert(tasks.len());
            tasks.push(self.task(&key.text, node));
        }
        tasks.into_iter().collect()
    }

    /// Adds a task `main` where there is none and the terms permit it.
    pub(super) fn add_main(&mut self, tasks: &mut Option<Vec<Task>>) {
        if let Some(tasks) = tasks
            && self.terms.adds_main
            && !self.task_places.contains_key(&MAIN.to_ascii_uppercase())
        {
            self.task_places.insert(MAIN.to_ascii_uppercase(), tasks.len());
            tasks.push(predefined());
        }
    }

    fn task(&mut self, name: &str, node: &Node) -> Option<Task> {
        let fields = self.fields(node, &shape::TASK)?;
        let interval = self.if_given(&fields, "interval", |it, node, key| {
            match it.scans(node, key)? {
                0 => {
                    let message = "`interval` must be at least one cycle";
                    it.refuse(Diagnostic::new(Code::BadTime, node.span, message))
                }
                scans => Some(scans),
            }
        });
        let priority = self.optional(&fields, "priority", 0, |it, node, key| {
            it.whole(node, key, 0..=i64::from(u32::MAX))
        });
        let single = self.if_given(&fields, "single", |it, node, key| {
            it.wire(node, PinType::Bool, key)
        });
        let watchdog = self.if_given(&fields, "watchdog", |it, node, key| {
            it.whole(node, key, 1..=i64::from(u32::MAX))
        });
        if fields.get("interval").is_none() && fields.get("single").is_none() {
            let message = format!("the task {} would never run", quoted(name));
            return self.refuse(
                Diagnostic::new(Code::MissingKey, fields.brace(), message)
                    .help("give it an `interval`, a `single` or both"),
            );
        }
        Some(Task {
            name: name.to_owned(),
            interval: interval?,
            priority: u32::try_from(priority?).ok()?,
            single: single?,
            watchdog: watchdog?.and_then(|scans| u32::try_from(scans).ok()),
        })
    }

    /// The task of the block `fields`.
    pub(super) fn task_of(&mut self, fields: &Fields<'_>, tasks: Option<&[Task]>) -> Option<usize> {
        match fields.get("task") {
            None => self.task_index(MAIN, fields.brace(), tasks),
            Some(node) => {
                let name = self.text(node, "`task`")?;
                self.task_index(name, node.span, tasks)
            }
        }
    }

    pub(super) fn task_index(&mut self, name: &str, span: Span, tasks: Option<&[Task]>) -> Option<usize> {
        // Tasks that were refused are already reported.
        let tasks = tasks?;
        let index = self.task_places.get(&name.to_ascii_uppercase()).copied();
        if index.is_none() {
            let message = format!("the script has no task {}", quoted(name));
            let help = self.help(name, tasks.iter().map(|task| task.name.as_str()));
            self.report(Diagnostic::new(Code::UnknownTask, span, message).maybe_help(help));
        }
        index
    }
}

/// The task of a script without `tasks`.
fn predefined() -> Task {
    Task {
        name: MAIN.to_owned(),
        interval: Some(1),
        priority: 0,
        single: None,
        watchdog: None,
    }
}

//! Makes a program that breaks a rule smaller: fewer instances, fewer steps, fewer changes, rounder numbers.

use super::judge;
use super::program::{Program, scan_of, set_by};
use super::run::Failure;
use serde_json::{Value as Json, json};
use standstill_script::model::Script;

/// Largest number of scans that are run to find a smaller program.
const BUDGET: u64 = 4_000_000;

struct Shrinker<J> {
    judge: J,
    best: Program,
    failure: Failure,
    /// Scans left to run.
    budget: u64,
}

/// The smallest program found that breaks the same rule as `program`, and its failure.
pub fn shrink(failure: Failure, program: Program) -> (Failure, Program) {
    shrink_by(failure, program, |_, script| {
        let (seen, failure) = judge(script);
        (seen.scans, failure)
    })
}

/// The same as [`shrink`], with another judge, which gets a program and its script and returns the
/// number of scans that it ran and its failure.
pub fn shrink_by<J>(failure: Failure, program: Program, judge: J) -> (Failure, Program)
where
    J: Fn(&Program, &Script) -> (u64, Option<Failure>),
{
    let mut shrinker = Shrinker {
        judge,
        best: program,
        failure,
        budget: BUDGET,
    };
    shrinker.end();
    // Each pass may make room for another; most need two rounds.
    for _ in 0..6 {
        let before = shrinker.best.clone();
        shrinker.fewer_blocks();
        shrinker.fewer_steps();
        shrinker.fewer_axes();
        shrinker.fewer_changes();
        shrinker.plainer();
        shrinker.sooner();
        shrinker.rounder();
        if shrinker.best == before || shrinker.budget == 0 {
            break;
        }
    }
    (shrinker.failure, shrinker.best)
}

impl<J: Fn(&Program, &Script) -> (u64, Option<Failure>)> Shrinker<J> {
    /// Takes `candidate` if it breaks the same rule.
    fn attempt(&mut self, candidate: Program) -> bool {
        if candidate == self.best || self.budget < candidate.scans {
            return false;
        }
        let Ok(script) = candidate.read() else {
            return false;
        };
        let (scans, failure) = (self.judge)(&candidate, &script);
        self.budget = self.budget.saturating_sub(scans);
        match failure {
            Some(failure) if failure.broken == self.failure.broken => {
                self.failure = failure;
                self.best = candidate;
                self.end();
                true
            }
            Some(_) | None => false,
        }
    }

    /// The same with the best program as `change` makes it.
    fn attempt_with(&mut self, change: impl FnOnce(&mut Program)) -> bool {
        let mut changed = self.best.clone();
        change(&mut changed);
        self.attempt(changed)
    }

    /// Removes all actions after the failure.
    fn end(&mut self) {
        let last = self.failure.scan;
        self.best.scans = last + 1;
        self.best.steps.retain(|step| scan_of(step) <= last);
    }

    fn fewer_blocks(&mut self) {
        for index in (0..self.best.blocks.len()).rev() {
            self.attempt_with(|less| {
                let name = less.blocks.remove(index).name;
                let of_it = |step: &Json| set_by(step).is_some_and(|(block, ..)| block == name);
                less.steps.retain(|step| !of_it(step));
            });
        }
    }

    fn fewer_axes(&mut self) {
        let names: Vec<_> = self.best.axes.keys().cloned().collect();
        for name in names.iter().rev() {
            self.attempt_with(|less| {
                less.axes.remove(name);
                let of_it = |step: &Json| {
                    let fault = step.get("fault").or_else(|| step.get("clear"));
                    fault.is_some_and(|fault| fault["axis"] == json!(name))
                };
                less.steps.retain(|step| !of_it(step));
            });
        }
    }

    /// Halves, quarters and so on of the steps, down to single ones.
    fn fewer_steps(&mut self) {
        let mut length = self.best.steps.len().div_ceil(2).max(1);
        loop {
            let mut start = 0;
            while start < self.best.steps.len() {
                let end = (start + length).min(self.best.steps.len());
                let taken = self.attempt_with(|less| drop(less.steps.drain(start..end)));
                if !taken {
                    start += length;
                }
            }
            if length == 1 {
                return;
            }
            length = length.div_ceil(2);
        }
    }

    /// Replaces steps by values that hold from the start.
    fn fewer_changes(&mut self) {
        let mut index = 0;
        while index < self.best.steps.len() {
            let taken = self.attempt_with(|less| {
                let step = less.steps.remove(index);
                let set = set_by(&step);
                let block =
                    set.and_then(|(name, ..)| less.blocks.iter_mut().find(|block| block.name == name));
                if let (Some(block), Some((_, pin, value))) = (block, set) {
                    block.pins.insert(pin.to_owned(), value.clone());
                }
            });
            index += usize::from(!taken);
        }
    }

    /// Leaves out keys of axes and drives, pins, and records of tables.
    fn plainer(&mut self) {
        for name in self.best.axes.keys().cloned().collect::<Vec<_>>() {
            self.attempt_with(|less| less.axes[&name]["state"] = json!("Standstill"));
            self.without_parts(&|program| &mut program.axes[&name]);
        }
        for index in 0..self.best.blocks.len() {
            let pins: Vec<_> = self.best.blocks[index].pins.keys().cloned().collect();
            for pin in pins {
                let taken = self.attempt_with(|less| drop(less.blocks[index].pins.remove(&pin)));
                if !taken {
                    self.without_parts(&|program| &mut program.blocks[index].pins[&pin]);
                }
            }
        }
    }

    /// Leaves out the members and elements of a part, and those of its parts.
    fn without_parts(&mut self, part: &dyn Fn(&mut Program) -> &mut Json) {
        let keys: Vec<Key> = match part(&mut self.best.clone()) {
            Json::Object(members) => members.keys().cloned().map(Key::Member).collect(),
            Json::Array(elements) => (0..elements.len()).rev().map(Key::Element).collect(),
            _ => return,
        };
        for key in keys {
            let taken = self.attempt_with(|less| match (part(less), &key) {
                (Json::Object(members), Key::Member(name)) => drop(members.remove(name)),
                (Json::Array(elements), Key::Element(index)) => drop(elements.remove(*index)),
                _ => {}
            });
            if !taken {
                self.without_parts(&|program| match &key {
                    Key::Member(name) => &mut part(program)[name],
                    Key::Element(index) => &mut part(program)[*index],
                });
            }
        }
    }

    /// Shorter pauses.
    fn sooner(&mut self) {
        for index in 0..self.best.steps.len() {
            let mut by = self.pause_before(index);
            while by > 0 {
                let taken = self.attempt_with(|less| {
                    for step in &mut less.steps[index..] {
                        step["at"] = json!(scan_of(step) - by);
                    }
                });
                if taken {
                    by = self.pause_before(index).min(by);
                } else {
                    by /= 2;
                }
                if index >= self.best.steps.len() {
                    return;
                }
            }
        }
    }

    fn pause_before(&self, index: usize) -> u64 {
        let scan = |index: usize| self.best.steps.get(index).map_or(0, scan_of);
        match index.checked_sub(1) {
            Some(before) => scan(index) - scan(before),
            // An edge of a script needs a scan before it.
            None => scan(index).saturating_sub(1),
        }
    }

    /// Numbers of one, two, three digits.
    fn rounder(&mut self) {
        for index in 0..numbers(&mut self.best.clone()).len() {
            for digits in 1..=4 {
                let mut less = self.best.clone();
                let mut numbers = numbers(&mut less);
                let Some(number) = numbers.get_mut(index) else {
                    return;
                };
                let is = number.as_f64().unwrap_or(0.0);
                let round = rounded(is, digits);
                if round == is {
                    break;
                }
                **number = json!(round);
                if self.attempt(less) {
                    break;
                }
            }
        }
    }
}

/// A part of JSON.
enum Key {
    Member(String),
    Element(usize),
}

/// Every number of a program with a fraction.
fn numbers(program: &mut Program) -> Vec<&mut Json> {
    let mut all = Vec::new();
    let axes = program.axes.values_mut();
    let pins = program
        .blocks
        .iter_mut()
        .flat_map(|block| block.pins.values_mut());
    let steps = program.steps.iter_mut().filter_map(|step| step.get_mut("set"));
    for part in axes.chain(pins).chain(steps) {
        numbers_in(part, &mut all);
    }
    all
}

fn numbers_in<'a>(part: &'a mut Json, all: &mut Vec<&'a mut Json>) {
    match part {
        Json::Object(members) => members.values_mut().for_each(|member| numbers_in(member, all)),
        Json::Array(elements) => elements.iter_mut().for_each(|element| numbers_in(element, all)),
        Json::Number(number) if number.is_f64() => all.push(part),
        _ => {}
    }
}

/// `number` to `digits` significant digits.
fn rounded(number: f64, digits: usize) -> f64 {
    format!("{number:.*e}", digits - 1).parse().unwrap_or(number)
}

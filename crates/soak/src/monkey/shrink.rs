//! Makes a scenario that breaks a rule smaller: fewer instances, fewer steps, fewer changes, rounder numbers.

use super::replay;
use super::run::Failure;
use super::scenario::{Action, Scenario, Step};
use standstill_axis::keys::{AXIS, Holds};
use standstill_axis::{AxisConfig, Limits, StartState};
use standstill_drives::simulated::DriveSetup;
use standstill_fb::Value;

/// Largest number of scans that are run to find a smaller scenario.
const BUDGET: u64 = 4_000_000;

struct Shrinker<J> {
    judge: J,
    best: Scenario,
    failure: Failure,
    /// Scans left to run.
    budget: u64,
}

/// The smallest scenario found that breaks the same rule as `scenario`, and its failure.
pub fn shrink(failure: Failure, scenario: Scenario) -> (Failure, Scenario) {
    shrink_by(failure, scenario, |candidate| {
        let (seen, failure) = replay(candidate);
        (seen.scans, failure)
    })
}

/// The same as [`shrink`], with another judge, which returns the number of scans that a scenario ran and its
/// failure.
pub fn shrink_by<J>(failure: Failure, scenario: Scenario, judge: J) -> (Failure, Scenario)
where
    J: Fn(&Scenario) -> (u64, Option<Failure>),
{
    let mut shrinker = Shrinker {
        judge,
        best: scenario,
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
        shrinker.plainer_axes();
        shrinker.fewer_changes();
        shrinker.shorter_tables();
        shrinker.sooner();
        shrinker.rounder();
        if shrinker.best == before || shrinker.budget == 0 {
            break;
        }
    }
    (shrinker.failure, shrinker.best)
}

impl<J: Fn(&Scenario) -> (u64, Option<Failure>)> Shrinker<J> {
    /// Takes `candidate` if it breaks the same rule.
    fn attempt(&mut self, candidate: Scenario) -> bool {
        if candidate == self.best || self.budget < candidate.scans {
            return false;
        }
        let (scans, failure) = (self.judge)(&candidate);
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

    /// Removes all actions after the failure.
    fn end(&mut self) {
        let last = self.failure.scan;
        self.best.scans = last + 1;
        self.best.steps.retain(|step| step.scan <= last);
    }

    fn fewer_blocks(&mut self) {
        for index in (0..self.best.blocks.len()).rev() {
            let mut less = self.best.clone();
            less.blocks.remove(index);
            less.steps.retain_mut(|step| match &mut step.action {
                Action::Set { block, .. } if *block == index => false,
                Action::Set { block, .. } => {
                    *block -= usize::from(*block > index);
                    true
                }
                Action::Fault { .. } | Action::Clear { .. } => true,
            });
            self.attempt(less);
        }
    }

    fn fewer_axes(&mut self) {
        for index in (0..self.best.axes.len()).rev() {
            if self.best.axes.len() == 1 || self.best.blocks.iter().any(|block| block.axis == index) {
                continue;
            }
            let mut less = self.best.clone();
            less.axes.remove(index);
            for block in &mut less.blocks {
                block.axis -= usize::from(block.axis > index);
            }
            less.steps.retain_mut(|step| match &mut step.action {
                Action::Fault { axis, .. } | Action::Clear { axis } if *axis == index => false,
                Action::Fault { axis, .. } | Action::Clear { axis } => {
                    *axis -= usize::from(*axis > index);
                    true
                }
                Action::Set { .. } => true,
            });
            self.attempt(less);
        }
    }

    /// Halves, quarters and so on of the steps, down to single ones.
    fn fewer_steps(&mut self) {
        let mut length = self.best.steps.len().div_ceil(2).max(1);
        loop {
            let mut start = 0;
            while start < self.best.steps.len() {
                let mut less = self.best.clone();
                let end = (start + length).min(less.steps.len());
                less.steps.drain(start..end);
                if !self.attempt(less) {
                    start += length;
                }
            }
            if length == 1 {
                return;
            }
            length = length.div_ceil(2);
        }
    }

    /// Sets each part of a configuration to its default.
    fn plainer_axes(&mut self) {
        let mut keys: Vec<_> = AXIS.keys.iter().collect();
        AXIS.each(&mut |key| keys.push(key));
        let paths: Vec<_> = keys
            .iter()
            .filter(|key| !key.is_needed())
            .map(|key| key.path)
            .collect();
        for axis in 0..self.best.axes.len() {
            for path in &paths {
                let mut less = self.best.clone();
                let config = &mut less.axes[axis].config;
                *config = without(config, path);
                self.attempt(less);
            }
            let mut less = self.best.clone();
            less.axes[axis].config.start = StartState::Standstill;
            self.attempt(less);
            let mut less = self.best.clone();
            less.axes[axis].drive = DriveSetup::default();
            self.attempt(less);
        }
    }

    /// Replaces steps by values that hold from the start.
    fn fewer_changes(&mut self) {
        let mut index = 0;
        while index < self.best.steps.len() {
            let mut less = self.best.clone();
            let step = less.steps.remove(index);
            let taken = match step.action {
                Action::Set { block, pin, value } => {
                    let constants = &mut less.blocks[block].constants;
                    constants.retain(|(other, _)| *other != pin);
                    constants.push((pin, value));
                    self.attempt(less)
                }
                Action::Fault { .. } | Action::Clear { .. } => false,
            };
            index += usize::from(!taken);
        }
        for block in 0..self.best.blocks.len() {
            for place in (0..self.best.blocks[block].constants.len()).rev() {
                let mut less = self.best.clone();
                less.blocks[block].constants.remove(place);
                self.attempt(less);
            }
        }
    }

    /// Tables with fewer records.
    fn shorter_tables(&mut self) {
        for block in 0..self.best.blocks.len() {
            for table in 0..self.best.blocks[block].tables.len() {
                for record in (0..self.best.blocks[block].tables[table].records.len()).rev() {
                    let mut less = self.best.clone();
                    less.blocks[block].tables[table].records.remove(record);
                    self.attempt(less);
                }
            }
        }
    }

    /// Shorter pauses.
    fn sooner(&mut self) {
        for index in 0..self.best.steps.len() {
            let mut by = self.pause_before(index);
            while by > 0 {
                let mut less = self.best.clone();
                for Step { scan, .. } in &mut less.steps[index..] {
                    *scan -= by;
                }
                if self.attempt(less) {
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
        let scan = |index: usize| self.best.steps.get(index).map_or(0, |step| step.scan);
        match index.checked_sub(1) {
            Some(before) => scan(index) - scan(before),
            // An edge of a script needs a scan before it.
            None => scan(index).saturating_sub(1),
        }
    }

    /// Numbers of one, two, three digits.
    fn rounder(&mut self) {
        for index in 0..numbers(&mut self.best.clone(), None).len() {
            for digits in 1..=4 {
                let mut less = self.best.clone();
                let Some(number) = numbers(&mut less, None).get(index).copied() else {
                    return;
                };
                let round = rounded(number, digits);
                if round == number {
                    break;
                }
                numbers(&mut less, Some((index, round)));
                if self.attempt(less) {
                    break;
                }
            }
        }
    }
}

/// A configuration with a key, or all of an object's keys, at the default.
fn without(config: &AxisConfig, path: &str) -> AxisConfig {
    let mut plain = AxisConfig::new(Limits::NONE);
    AXIS.each(&mut |key| {
        let is_it = key.path == path
            || key
                .path
                .strip_prefix(path)
                .is_some_and(|rest| rest.starts_with('.'));
        if !is_it && !key.is_same(config, &plain) {
            key.take(config, &mut plain);
        }
    });
    plain
}

/// Every number of a scenario that can be changed; one of them is changed.
fn numbers(scenario: &mut Scenario, change: Option<(usize, f64)>) -> Vec<f64> {
    let mut all = Vec::new();
    let mut look = |number: f64| {
        let new = change
            .filter(|(index, _)| *index == all.len())
            .map(|(_, new)| new);
        all.push(number);
        new
    };
    for axis in &mut scenario.axes {
        let config = &mut axis.config;
        AXIS.each(&mut |key| {
            if let Holds::Number { get, set, .. } = &key.holds
                && let Some(new) = get(config).and_then(&mut look)
            {
                set(config, new);
            }
        });
    }
    let constants = scenario.blocks.iter_mut().flat_map(|block| &mut block.constants);
    let constants = constants.map(|(_, value)| value);
    let steps = scenario
        .steps
        .iter_mut()
        .filter_map(|step| match &mut step.action {
            Action::Set { value, .. } => Some(value),
            Action::Fault { .. } | Action::Clear { .. } => None,
        });
    for value in constants.chain(steps) {
        if let Value::Lreal(number) = value
            && let Some(new) = look(*number)
        {
            *number = new;
        }
    }
    all
}

/// `number` to `digits` significant digits.
fn rounded(number: f64, digits: usize) -> f64 {
    if !number.is_finite() {
        return number;
    }
    format!("{number:.*e}", digits - 1).parse().unwrap_or(number)
}

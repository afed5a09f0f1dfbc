//! The reasons why an input did not get its expected value: wires, steps, variables.

use super::{Finding, Rank, Walk};
use crate::model::{Action, Point, Signal, Step, When, Wire};
use crate::run::turned;
use standstill_fb::Value;
use standstill_trace::{Cell, cell_text};

/// The course of a point that is not TRUE in time.
fn missed(rose: Option<u64>, since: u64) -> String {
    match (rose, since) {
        (Some(later), _) => format!("rose only in scan {later}"),
        (None, 0) => "never rose".to_owned(),
        (None, since) => format!("did not rise again after scan {}", since - 1),
    }
}

impl Walk<'_> {
    /// The reason why a point was not TRUE from `since` to `scan`.
    pub(super) fn point(&mut self, point: Point, since: u64, scan: u64) -> Vec<Finding> {
        match point {
            Point::Pin(instance, pin) => {
                let found = self.look.instance(instance);
                if found.is_some_and(|found| pin < found.block.input_count()) {
                    self.feed(instance, pin, since, scan)
                } else {
                    self.block(instance, Some(pin), since, scan)
                }
            }
            Point::Input(_) => self.steps(point, since, scan),
            Point::Symbol(..) if self.setters(point).next().is_some() => self.steps(point, since, scan),
            Point::Symbol(..) => self.written(point, scan).into_iter().collect(),
            Point::Formula(formula) => self.formula(formula, true, since, scan),
        }
    }

    /// The reason why an expression does not have its expected value: the BOOL operands that would have
    /// to be inverted, if there are such; otherwise all that it reads.
    pub(super) fn formula(&mut self, index: usize, wanted: bool, since: u64, scan: u64) -> Vec<Finding> {
        let script = self.look.script();
        let Some(formula) = script.formulas.get(index).filter(|_| self.enter(5, index, 0)) else {
            return Vec::new();
        };
        let turned = turned(&self.look.rows, index, wanted, scan);
        let mut found = Vec::new();
        for (place, input) in formula.inputs.iter().enumerate() {
            let now = self.look.of(&input.signal, scan);
            let is_decisive = turned.as_ref().map(|turned| turned.contains(&place));
            match (&input.signal, now, is_decisive) {
                (_, _, Some(false)) => {}
                (signal, Some(Cell::Bool(true)), Some(true)) => {
                    found.extend(self.too_high(&formula.text, signal, scan));
                }
                // It is TRUE, which may be intended.
                (_, Some(Cell::Bool(true)), None) if since == 0 => {}
                (Signal::Point(point), Some(Cell::Bool(_)), _) => {
                    found.extend(self.point(*point, since, scan));
                }
                (signal, _, _) => found.extend(self.standing(signal, scan)),
            }
        }
        found
    }

    /// An operand that is TRUE and so keeps an expression from its expected value.
    fn too_high(&mut self, text: &str, signal: &Signal, scan: u64) -> Vec<Finding> {
        let Signal::Point(point) = *signal else {
            return self.standing(signal, scan);
        };
        let name = self.look.called(point);
        let rose = self.look.last_rise(point, scan).unwrap_or(0);
        let by = match point {
            Point::Input(_) => self.written(point, scan).into_iter().collect(),
            _ => self.standing(signal, scan),
        };
        let since = if rose == 0 {
            "from the first scan on".to_owned()
        } else {
            format!("since scan {rose}")
        };
        let mut told = format!("{name} is TRUE {since}, and `{text}` would need it FALSE");
        if let Some(by) = by.first() {
            told = format!("{told}; {}", by.line());
        }
        vec![Finding::new(Rank::Stopped, Some(rose), told)]
    }

    /// The reason why an input of a block was not TRUE.
    pub(super) fn feed(&mut self, instance: usize, pin: usize, since: u64, scan: u64) -> Vec<Finding> {
        let input = Point::Pin(instance, pin);
        if !self.enter(0, instance, pin) {
            return Vec::new();
        }
        // A value that never existed did not fail to return.
        let since = if self.look.last_rise(input, scan).is_some() {
            since
        } else {
            0
        };
        let what = self.look.called(input);
        let Some(wire) = self.look.wire(instance, pin) else {
            return self.unwired(instance, pin, since, scan);
        };
        let rises = |walk: &Self, point| walk.look.first_rise(point, since, u64::MAX);
        match wire {
            Wire::From(source) => {
                let rose = rises(self, *source);
                let name = self.look.called(*source);
                let step = format!("{what} is {name}, which {}", missed(rose, since));
                let found = self.deeper(input, |walk| walk.point(*source, since, scan));
                self.behind(found, &step, scan)
            }
            Wire::Not(source) => {
                let name = self.look.called(*source);
                let text = format!("{what} is `not` {name}, which stays {}", self.text(*source, scan));
                vec![Finding::new(Rank::Stopped, Some(since), text)]
            }
            Wire::Any(points) => {
                let step = format!("{what} is any of {}, none of which rose", self.list(points));
                let points = points.clone();
                let found = self.deeper(input, |walk| {
                    let each = points.iter();
                    each.flat_map(|point| walk.point(*point, since, scan)).collect()
                });
                self.behind(found, &step, scan)
            }
            Wire::All(points) => {
                let step = format!(
                    "{what} is all of {}, which were not TRUE together",
                    self.list(points)
                );
                let missing: Vec<Point> = points
                    .iter()
                    .copied()
                    .filter(|point| self.look.first_true(*point, since, scan).is_none())
                    .collect();
                if missing.is_empty() {
                    return vec![Finding::new(Rank::Stopped, Some(scan), step)];
                }
                let mut found = Vec::new();
                for point in missing {
                    let rose = rises(self, point);
                    let (all, name) = (self.list(points), self.look.called(point));
                    let step = format!("{what} is all of {all}, and {name} {}", missed(rose, since));
                    let own = self.deeper(input, |walk| walk.point(point, since, scan));
                    found.extend(self.behind(own, &step, scan));
                }
                found
            }
        }
    }

    /// A block that waits for itself. A motion that was in progress and stopped has another reason.
    pub(super) fn ring(&self, instance: usize, since: u64) -> Option<Finding> {
        let mut way = self.path.iter().filter(|_| since == 0);
        let waits = way.find(|input| matches!(input, Point::Pin(other, _) if *other == instance))?;
        let what = self.look.called(*waits);
        let text = format!("{what} waits for itself: these wires are a ring that nothing starts");
        Some(Finding::new(Rank::Follows, Some(since), text))
    }

    /// The wire of an input, between commas: `, which is `not` enable,`; nothing if there is none.
    pub(super) fn wired(&self, instance: usize, pin: usize) -> String {
        let wire = self.look.wire(instance, pin);
        wire.map_or_else(String::new, |wire| match wire {
            Wire::From(point) => format!(", which is {},", self.look.called(*point)),
            Wire::Not(point) => format!(", which is `not` {},", self.look.called(*point)),
            Wire::Any(points) => format!(", which is any of {},", self.list(points)),
            Wire::All(points) => format!(", which is all of {},", self.list(points)),
        })
    }

    /// Findings with a step in front of each; the step itself if there are none.
    pub(super) fn behind(&self, found: Vec<Finding>, step: &str, scan: u64) -> Vec<Finding> {
        if found.is_empty() {
            return vec![Finding::new(Rank::Follows, Some(scan), step.to_owned())];
        }
        found.into_iter().map(|finding| finding.after(step)).collect()
    }

    fn list(&self, points: &[Point]) -> String {
        let names: Vec<_> = points.iter().map(|point| self.look.called(*point)).collect();
        names.join(", ")
    }

    fn text(&self, point: Point, scan: u64) -> String {
        self.look
            .cell(point, scan)
            .map_or_else(|| "as it is".to_owned(), cell_text)
    }

    /// The reason why an input without a wire was not TRUE.
    fn unwired(&mut self, instance: usize, pin: usize, since: u64, scan: u64) -> Vec<Finding> {
        let point = Point::Pin(instance, pin);
        let what = self.look.called(point);
        if self.setters(point).next().is_some() {
            return self.steps(point, since, scan);
        }
        let text = match self.look.cell(point, scan) {
            Some(Cell::Bool(true)) if since > 0 => {
                format!("{what} is TRUE in every scan, so it has no second edge")
            }
            value => {
                let value = value.map_or_else(|| "not known".to_owned(), cell_text);
                format!("{what} is {value}: no wire feeds it and no step sets it")
            }
        };
        vec![Finding::new(Rank::Stopped, Some(since), text)]
    }

    /// The steps that make a point TRUE, or give it a number.
    fn setters(&self, point: Point) -> impl Iterator<Item = (usize, &'_ Step)> {
        let steps = self.look.script().steps.iter().enumerate();
        steps.filter(move |(_, step)| {
            let mut actions = step.actions.iter();
            actions.any(|action| match action {
                Action::Set(set, Value::Bool(value)) => *set == point && *value,
                Action::Set(set, _) => *set == point,
                _ => false,
            })
        })
    }

    /// The reason why no step set a variable or a pin in time.
    pub(super) fn steps(&mut self, point: Point, since: u64, scan: u64) -> Vec<Finding> {
        let (kind, place, inner) = match point {
            Point::Input(index) => (1, index, 0),
            Point::Pin(instance, pin) => (6, instance, pin),
            Point::Symbol(program, symbol) => (7, program, symbol),
            Point::Formula(index) => (8, index, 0),
        };
        if !self.enter(kind, place, inner) {
            return Vec::new();
        }
        let name = self.look.called(point);
        let setters: Vec<(usize, Step)> = self
            .setters(point)
            .map(|(index, step)| (index, step.clone()))
            .collect();
        if setters.is_empty() {
            let text = format!("no step sets {name} to TRUE");
            return vec![Finding::new(Rank::Stopped, Some(since), text)];
        }
        let mut found = Vec::new();
        for (index, step) in &setters {
            match &step.when {
                When::At(at) if *at > scan => {
                    let text = format!("steps[{index}] sets {name} only in scan {at}");
                    found.push(Finding::new(Rank::Stopped, Some(*at), text));
                }
                When::At(at) => found.extend(self.set_back(point, *index, *at)),
                When::Holds { conditions, .. } => {
                    found.extend(self.conditional(*index, point, conditions, since, scan));
                }
            }
        }
        found
    }

    /// A variable that a step set, and another step reset before it was read or had its value long enough.
    fn set_back(&self, point: Point, step: usize, at: u64) -> Option<Finding> {
        if self.look.is_true(point, at) {
            return None;
        }
        let name = self.look.called(point);
        let other = match point {
            Point::Symbol(..) => "its program",
            _ => "another step",
        };
        let text =
            format!("steps[{step}] sets {name} in scan {at}, and {other} sets it back in the same scan");
        Some(Finding::new(Rank::Stopped, Some(at), text))
    }

    /// The reason why a step with `when` was not applied in time.
    fn conditional(
        &mut self,
        step: usize,
        point: Point,
        conditions: &[crate::model::Condition],
        since: u64,
        scan: u64,
    ) -> Vec<Finding> {
        let rows = self.look.rows;
        let held = |from: u64| (from..scan).any(|scan| rows.hold(conditions, scan));
        if held(since) {
            return Vec::new();
        }
        let since = if since > 0 && held(0) { since } else { 0 };
        let name = self.look.called(point);
        let when = crate::claims::conditions_text(&rows, conditions);
        let way = format!("steps[{step}] sets {name} when {when}, which did not hold in time");
        let missing: Vec<_> = conditions
            .iter()
            .filter(|condition| !(since..=scan).any(|scan| rows.holds(condition, scan)))
            .cloned()
            .collect();
        if missing.is_empty() {
            let text = format!("steps[{step}] sets {name} when {when}, which never held together");
            return self.apart(point, conditions, &text, since, scan);
        }
        let mut found = Vec::new();
        for condition in &missing {
            let own = self.deeper(point, |walk| walk.condition(condition, since, scan));
            found.extend(self.behind(own, &way, scan));
        }
        found
    }

    /// The reason why conditions never held together: what kept the last of them FALSE, in the last scan
    /// in which all others held.
    fn apart(
        &mut self,
        point: Point,
        conditions: &[crate::model::Condition],
        way: &str,
        since: u64,
        scan: u64,
    ) -> Vec<Finding> {
        let rows = self.look.rows;
        let alone = |scan: u64| {
            let mut unmet = conditions.iter().filter(|condition| !rows.holds(condition, scan));
            let one = unmet.next()?;
            unmet.next().is_none().then_some((one, scan))
        };
        let Some((condition, at)) = (since..=scan).rev().find_map(alone) else {
            return vec![Finding::new(Rank::Stopped, Some(scan), way.to_owned())];
        };
        let found = self.deeper(point, |walk| walk.condition(condition, at, at));
        self.behind(found, way, scan)
    }

    /// The writer of a variable that has no block behind it.
    pub(super) fn written(&mut self, point: Point, scan: u64) -> Option<Finding> {
        let name = self.look.called(point);
        if let Point::Symbol(program, symbol) = point {
            let program = self.look.script().programs.get(program)?;
            let what = match symbol {
                0 => format!("program {} had a fault", program.name),
                _ => format!("{name} is written by program {}", program.name),
            };
            return Some(Finding::new(Rank::Follows, Some(scan), what));
        }
        let setters = self.look.script().steps.iter().enumerate();
        let sets = |step: &Step| {
            let mut actions = step.actions.iter();
            actions.any(|action| matches!(action, Action::Set(set, _) if *set == point))
        };
        let names: Vec<_> = setters
            .filter(|(_, step)| sets(step))
            .map(|(index, _)| format!("steps[{index}]"))
            .collect();
        let text = match names.as_slice() {
            [] => format!("{name} has its initial value: no step sets it"),
            names => format!("{name} is set by {}", names.join(", ")),
        };
        Some(Finding::new(Rank::Follows, Some(scan), text))
    }

    /// Whether a wire reads a point of a block that is called later in the same scan.
    pub(super) fn reads_late(&self, instance: usize, pin: usize, source: Point) -> bool {
        let Some(wire) = self.look.wire(instance, pin) else {
            return false;
        };
        let Point::Pin(other, of) = source else {
            return false;
        };
        let is_output = |instance: usize| {
            let found = self.look.instance(instance);
            found.is_some_and(|found| of >= found.block.input_count())
        };
        let task = |instance: usize| self.look.instance(instance).map(|found| found.task);
        wire.points().contains(&source)
            && other > instance
            && task(other) == task(instance)
            && is_output(other)
    }
}

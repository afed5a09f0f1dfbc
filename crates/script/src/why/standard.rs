//! The reasons why the output of a timer, counter, latch or edge detector is not TRUE.

use super::{Finding, Rank, Walk, words};
use crate::model::{Point, Wire};
use standstill_trace::Cell;

impl Walk<'_> {
    /// TON: its input was never TRUE, or not for long enough.
    pub(super) fn timer(&mut self, instance: usize, since: u64, scan: u64) -> Vec<Finding> {
        let Some(input @ Point::Pin(_, pin)) = self.look.pin(instance, "IN") else {
            return Vec::new();
        };
        let output = self.look.pin(instance, "Q");
        let again = output.and_then(|output| self.look.last_rise(output, scan));
        let since = again.map_or(since, |rose| since.max(rose + 1));
        let rose = (since..=scan)
            .rev()
            .find(|&scan| self.look.rises(input, scan))
            .or_else(|| self.look.is_true(input, scan).then_some(since));
        let Some(rose) = rose else {
            return self.feed(instance, pin, since, scan);
        };
        let end = self.look.end_of(input, rose).min(scan);
        let name = self.look.name(instance);
        let needs = self.time(instance, "PT", rose);
        let mut text = format!(
            "{name}.IN was TRUE in {} only, and {name}.PT is {needs}",
            words::scans(rose, end)
        );
        if end == scan {
            text = format!("{name}.IN is TRUE since scan {rose}, and {name}.PT is {needs}");
        } else if let Some(fell) = self.source_fell(instance, pin, end) {
            text = format!("{text}; {fell}");
        }
        vec![Finding::new(Rank::Stopped, Some(rose), text)]
    }

    /// A TIME input as a literal.
    fn time(&self, instance: usize, name: &str, scan: u64) -> String {
        match self.look.at(instance, name, scan) {
            Some(Cell::Integer(ns)) => crate::read::time::literal(ns),
            _ => "not known".to_owned(),
        }
    }

    /// The reason why an output that a wire reads fell, if its block's Execute had fallen.
    fn source_fell(&self, instance: usize, pin: usize, end: u64) -> Option<String> {
        let Some(Wire::From(Point::Pin(other, of))) = self.look.wire(instance, pin) else {
            return None;
        };
        let execute = self.look.pin(*other, "Execute")?;
        let rose = self.look.last_rise(execute, end)?;
        let fell = self.look.end_of(execute, rose) + 1;
        let source = self.look.called(Point::Pin(*other, *of));
        (fell <= end + 1).then(|| {
            format!(
                "{}.Execute fell in scan {fell}, so {source} fell after one scan",
                self.look.name(*other)
            )
        })
    }

    /// Any other standard block: the input it still waits for.
    pub(super) fn standard(
        &mut self,
        instance: usize,
        pin: Option<usize>,
        since: u64,
        scan: u64,
    ) -> Vec<Finding> {
        let Some(block) = self.look.instance(instance).map(|found| found.block) else {
            return Vec::new();
        };
        let name = self.look.name(instance);
        if let Some(reset) = self.held_back(instance, scan) {
            return vec![reset];
        }
        let counted = ["CU", "CD"].into_iter().find_map(|pin| block.pin(pin));
        if let Some((input, found)) = counted {
            let point = Point::Pin(instance, input);
            let edges = (0..=scan).filter(|&scan| self.look.rises(point, scan)).count();
            let last = self.look.last_rise(point, scan);
            let step = format!(
                "{name} counted {edges} of {} edges of {} by scan {scan}",
                self.preset(instance, scan),
                found.name
            );
            let more = self.feed(instance, input, last.map_or(0, |last| last + 1), scan);
            return self.behind(more, &step, scan);
        }
        let asked = pin.map(|pin| Point::Pin(instance, pin));
        let again = asked.and_then(|asked| self.look.last_rise(asked, scan));
        let since = again.map_or(since, |rose| since.max(rose + 1));
        let set = ["S1", "S", "CLK", "IN"]
            .into_iter()
            .find_map(|pin| block.pin(pin));
        set.map_or_else(Vec::new, |(input, _)| self.feed(instance, input, since, scan))
    }

    /// A latch or counter that its reset holds.
    fn held_back(&self, instance: usize, scan: u64) -> Option<Finding> {
        let mut resets = ["R1", "R"]
            .into_iter()
            .filter_map(|pin| self.look.pin(instance, pin));
        let reset = resets.find(|reset| self.look.is_true(*reset, scan))?;
        let rose = self.look.last_rise(reset, scan).unwrap_or(0);
        let Point::Pin(_, pin) = reset else { return None };
        let by = self.wired(instance, pin);
        let text = format!("{}{by} is TRUE since scan {rose}", self.look.called(reset));
        Some(Finding::new(Rank::Stopped, Some(rose), text))
    }

    fn preset(&self, instance: usize, scan: u64) -> String {
        match self.look.at(instance, "PV", scan) {
            Some(Cell::Integer(number)) => number.to_string(),
            _ => "its".to_owned(),
        }
    }
}

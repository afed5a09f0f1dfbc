//! The reasons why the output of a block is not TRUE.

use super::{Finding, Rank, Walk, words};
use crate::model::{Instance, Point};
use standstill_axis::{ErrorClass, ErrorId};
use standstill_fb::Group;
use standstill_trace::Cell;

/// The explanation of a command that takes the axis at once.
const ABORTING: &str = " with BufferMode mcAborting";

impl Walk<'_> {
    /// The reason why an output (any, without `pin`) was not TRUE from `since` to `scan`.
    pub(super) fn block(
        &mut self,
        instance: usize,
        pin: Option<usize>,
        since: u64,
        scan: u64,
    ) -> Vec<Finding> {
        if !self.enter(2, instance, pin.unwrap_or(usize::MAX)) {
            return self.ring(instance, since).into_iter().collect();
        }
        let Some(found) = self.look.instance(instance) else {
            return Vec::new();
        };
        if let Some(task) = self.look.idle_task(instance) {
            let text = format!("{} is never called: its task {task} never runs", found.name);
            return vec![Finding::new(Rank::Stopped, None, text)];
        }
        match found.block.name {
            "MC_Power" => match self.look.axes_of(instance).first() {
                Some(axis) => self.power(*axis, scan),
                None => Vec::new(),
            },
            "TON" => self.timer(instance, since, scan),
            _ if found.block.group == Group::Standard => self.standard(instance, pin, since, scan),
            _ if self.look.pin(instance, "Execute").is_some() => self.execute(instance, pin, since, scan),
            _ => self.enabled(instance, since, scan),
        }
    }

    /// A block with Execute: not triggered, refused, aborted, waiting or in progress.
    fn execute(&mut self, instance: usize, asked: Option<usize>, since: u64, scan: u64) -> Vec<Finding> {
        let Some(execute @ Point::Pin(_, trigger)) = self.look.pin(instance, "Execute") else {
            return Vec::new();
        };
        let Some(rose) = self.look.last_rise(execute, scan) else {
            return self.feed(instance, trigger, since, scan);
        };
        if let Some(found) = self.ended_badly(instance, rose, scan) {
            return found;
        }
        if let Some(asked) = asked.map(|pin| Point::Pin(instance, pin))
            && let Some(came) = self.look.first_true(asked, rose, scan)
        {
            let end = self.look.end_of(asked, came);
            if came < since {
                return self.feed(instance, trigger, came + 1, scan);
            }
            if end < scan && self.is_result(asked) {
                return vec![self.passed_by(instance, asked, came, end)];
            }
            if end < scan && !self.look.shows(instance, "Busy", scan) {
                return vec![self.follows(instance, rose, scan)];
            }
        }
        if !self.look.shows(instance, "Busy", scan) {
            // It has finished, and was expected once more.
            return self.feed(instance, trigger, rose + 1, scan);
        }
        if self.look.pin(instance, "Active").is_some() && !self.look.shows(instance, "Active", scan) {
            return self.waits(instance, rose, scan);
        }
        vec![self.under_way(instance, rose, scan)]
    }

    /// Whether a pin shows that a command has ended properly.
    fn is_result(&self, point: Point) -> bool {
        !["Busy", "Active", "InVelocity", "InTorque"]
            .iter()
            .any(|name| match point {
                Point::Pin(instance, _) => self.look.pin(instance, name) == Some(point),
                _ => false,
            })
    }

    /// Whether a block only reads an axis.
    fn is_reader(&self, instance: usize) -> bool {
        let found = self.look.instance(instance);
        found.is_some_and(|found| found.block.name.starts_with("MC_Read"))
    }

    /// The reason why a number at an output differs.
    pub(super) fn number(&mut self, instance: usize, scan: u64) -> Vec<Finding> {
        if !self.enter(4, instance, 0) {
            return Vec::new();
        }
        let mut found = match self.began(instance, scan) {
            None => {
                let trigger = self.look.triggers(instance).into_iter().next();
                trigger.map_or_else(Vec::new, |pin| self.feed(instance, pin, 0, scan))
            }
            Some(rose) => match self.ended_badly(instance, rose, scan) {
                Some(bad) => bad,
                None if self.is_reader(instance) => Vec::new(),
                None => vec![self.follows(instance, rose, scan)],
            },
        };
        for axis in self.look.axes_of(instance) {
            found.extend(self.axis(axis, scan));
        }
        found
    }

    /// An output that was TRUE and is not any more.
    fn passed_by(&self, instance: usize, asked: Point, came: u64, end: u64) -> Finding {
        let execute = self.look.pin(instance, "Execute");
        let fell = execute.map(|execute| {
            let edge = self.look.last_rise(execute, came);
            edge.map_or(came, |edge| self.look.end_of(execute, edge) + 1)
        });
        let mut text = format!(
            "{} was TRUE in {} only",
            self.look.called(asked),
            words::scans(came, end)
        );
        if let Some(fell) = fell.filter(|fell| *fell <= end + 1) {
            text.push_str(&format!(
                ": {}.Execute fell in scan {fell}, and outputs fall with it",
                self.look.name(instance)
            ));
        }
        Finding::new(Rank::Stopped, Some(came), text)
    }

    /// The command of the axis for which this one waits.
    fn waits(&mut self, instance: usize, rose: u64, scan: u64) -> Vec<Finding> {
        let name = self.look.name(instance);
        let axes = self.look.axes_of(instance);
        let all = axes.iter().flat_map(|axis| self.look.commanders(*axis));
        let ahead: Vec<usize> = all
            .filter(|other| *other != instance)
            .filter(|other| self.look.shows(*other, "Active", scan))
            .collect();
        let Some(other) = ahead.first() else {
            let text = format!("{name} is Busy since scan {rose} and has not become Active");
            return vec![Finding::new(Rank::Slow, Some(rose), text)];
        };
        let step = format!("{name} waits since scan {rose} behind {}", self.look.name(*other));
        let began = self.began(*other, scan).unwrap_or(rose);
        vec![self.under_way(*other, began, scan).after(&step)]
    }

    /// The last trigger of a block up to a scan.
    pub(super) fn began(&self, instance: usize, scan: u64) -> Option<u64> {
        self.look.last_start(instance, scan).map(|(rose, _)| rose)
    }

    /// An error or an abortion after the trigger in `rose`.
    pub(super) fn ended_badly(&mut self, instance: usize, rose: u64, scan: u64) -> Option<Vec<Finding>> {
        if let Some(error) = self.look.pin(instance, "Error")
            && let Some(at) = self.look.first_true(error, rose, scan)
        {
            return Some(self.failed(instance, error, at));
        }
        let aborted = self.look.pin(instance, "CommandAborted")?;
        let at = self.look.first_true(aborted, rose, scan)?;
        Some(self.aborted(instance, aborted, at))
    }

    /// A block that shows an error in a scan.
    pub(super) fn failed(&mut self, instance: usize, error: Point, at: u64) -> Vec<Finding> {
        let name = self.look.name(instance);
        let expected = self.look.is_counted_on(error, at);
        let rank = if expected { Rank::Expected } else { Rank::Stopped };
        let Some(id) = self.look.error_id(instance, at) else {
            let text = format!("{name}.Error rose in scan {at}");
            return vec![Finding::new(rank, Some(at), text)];
        };
        let refused = self.look.note(name, at, "refused: ");
        let (how, told) = match refused.and_then(|note| note.strip_prefix("refused: ")) {
            Some(told) => ("was refused", told.to_owned()),
            None => ("failed", format!("{} {}", id.number(), id.name())),
        };
        let text = format!("{name} {how} in scan {at}: {}", words::error(&told, id));
        let mut finding = Finding::new(rank, Some(at), text);
        let axes = self.look.axes_of(instance);
        let behind = axes.first().map_or_else(Vec::new, |axis| match (id, id.class()) {
            (ErrorId::NotPowered | ErrorId::PoweringOff, _) => self.power(*axis, at),
            (ErrorId::InErrorStop, _)
            | (_, ErrorClass::Axis | ErrorClass::Drive | ErrorClass::Communication) => {
                self.fault(*axis, at).into_iter().collect()
            }
            _ => Vec::new(),
        });
        match behind.into_iter().next() {
            None => {}
            Some(root) if id == ErrorId::InErrorStop => return vec![root.after(&finding.text)],
            // The axis stopped for the same reason.
            Some(root) if root.scan == Some(at) && root.text.contains(id.name()) => {}
            Some(root) => finding.text = format!("{}; {}", finding.text, root.line()),
        }
        if let Some(hint) = axes.first().and_then(|axis| self.reference(*axis, id)) {
            finding.text = format!("{}; {hint}", finding.text);
        }
        vec![finding]
    }

    /// A block that shows CommandAborted in a scan, and the command that aborted it.
    pub(super) fn aborted(&mut self, instance: usize, aborted: Point, at: u64) -> Vec<Finding> {
        let name = self.look.name(instance);
        let expected = self.look.is_counted_on(aborted, at);
        let rank = if expected { Rank::Expected } else { Rank::Stopped };
        for axis in self.look.axes_of(instance) {
            let all = self.look.commanders(axis).into_iter();
            let given = |other: usize| {
                let triggers = self.look.triggers(other).into_iter();
                let mut triggers = triggers.map(|pin| Point::Pin(other, pin));
                triggers.any(|trigger| {
                    self.look.rises(trigger, at)
                        || at
                            .checked_sub(1)
                            .is_some_and(|before| self.look.rises(trigger, before))
                })
            };
            let by: Vec<usize> = all.filter(|other| *other != instance && given(*other)).collect();
            // The one that was called last has the axis.
            let stays = |other: &usize| !self.look.shows(*other, "CommandAborted", at);
            let aborts = |other: &usize| matches!(self.mode(*other, at).as_str(), "" | ABORTING);
            let mut last = by.iter().copied().rev();
            let by = last
                .clone()
                .find(|other| stays(other) && aborts(other))
                .or_else(|| last.clone().find(stays))
                .or_else(|| last.next());
            if let Some(other) = by {
                let axis = self.look.axis_name(axis);
                let mode = self.mode(other, at);
                let mut text = format!(
                    "{name} was aborted in scan {at} by {}, which commands {axis} too{mode}",
                    self.look.name(other)
                );
                if self.began(instance, at) == self.began(other, at) {
                    text.push_str(": both are given in one scan, and the one called last stays");
                } else {
                    let brought = self.brought_by(other, at);
                    if !brought.is_empty() {
                        text = format!("{text}: {brought}");
                    }
                }
                return vec![Finding::new(rank, Some(at), text)];
            }
            if let Some(finding) = self.unpowered(axis, at) {
                let step = format!("{name} was aborted in scan {at}");
                return vec![finding.after(&step)];
            }
        }
        let text = format!("{name} was aborted in scan {at}");
        vec![Finding::new(rank, Some(at), text)]
    }

    /// ` with BufferMode mcAborting`
    fn mode(&self, instance: usize, scan: u64) -> String {
        match self.look.at(instance, "BufferMode", scan) {
            Some(Cell::Name(mode)) => format!(" with BufferMode {mode}"),
            _ => String::new(),
        }
    }

    /// A block that works while an input is TRUE.
    fn enabled(&mut self, instance: usize, since: u64, scan: u64) -> Vec<Finding> {
        let Some((rose, pin)) = self.look.last_start(instance, scan) else {
            let each = self.look.triggers(instance).into_iter();
            return each
                .flat_map(|pin| self.feed(instance, pin, since, scan))
                .collect();
        };
        if let Some(found) = self.ended_badly(instance, rose, scan) {
            return found;
        }
        if let Some(fell) = self.let_go(Point::Pin(instance, pin), rose, scan) {
            return vec![fell];
        }
        let axes = self.look.axes_of(instance);
        let writers = self.writers(instance).into_iter();
        let mut found: Vec<Finding> = writers
            .flat_map(|writer| match self.began(writer, scan) {
                None => self.block(writer, None, since, scan),
                Some(rose) => match self.ended_badly(writer, rose, scan) {
                    Some(bad) => bad,
                    None => vec![self.follows(writer, rose, scan)],
                },
            })
            .collect();
        found.extend(axes.into_iter().flat_map(|axis| self.axis(axis, scan)));
        found
    }

    /// The blocks that write the digital outputs that this one reads.
    fn writers(&self, instance: usize) -> Vec<usize> {
        let is_reader = |found: &Instance| found.block.name == "MC_ReadDigitalOutput";
        if !self.look.instance(instance).is_some_and(is_reader) {
            return Vec::new();
        }
        let axes = self.look.axes_of(instance);
        let all = self.look.script().blocks.iter().enumerate();
        let writes = |other: &Instance| {
            let names = ["MC_WriteDigitalOutput", "MC_DigitalCamSwitch"];
            names.contains(&other.block.name) && axes.iter().any(|axis| other.has_axis(*axis))
        };
        all.filter(|(_, other)| writes(other))
            .map(|(index, _)| index)
            .collect()
    }

    /// The input that rose last and started the block, if it is no longer TRUE.
    fn let_go(&self, point: Point, rose: u64, scan: u64) -> Option<Finding> {
        let end = self.look.end_of(point, rose);
        let text = format!(
            "{} was TRUE in {} only",
            self.look.called(point),
            words::scans(rose, end)
        );
        (end < scan).then(|| Finding::new(Rank::Stopped, Some(end + 1), text))
    }

    /// An output that is TRUE and should not be, or a wrong number.
    pub(super) fn stands(&mut self, instance: usize, pin: usize, scan: u64) -> Vec<Finding> {
        let Some(found) = self.look.instance(instance) else {
            return Vec::new();
        };
        let point = Point::Pin(instance, pin);
        let name = found.block.pins().nth(pin).map_or("", |pin| pin.name);
        let since = self.look.last_rise(point, scan).unwrap_or(scan);
        match name {
            "Error" => self.failed(instance, point, since),
            "CommandAborted" => self.aborted(instance, point, since),
            _ if pin < found.block.input_count() => Vec::new(),
            _ => match self.began(instance, scan) {
                Some(rose) => vec![self.follows(instance, rose, scan)],
                None => Vec::new(),
            },
        }
    }
}

//! The reasons for the position and the state of an axis.

use super::{Finding, Rank, Walk, words};
use crate::model::{Action, AxisNumber, Point, Signal};
use standstill_axis::{AxisState, ErrorId};
use standstill_trace::{Cell, shortest};

/// A value above this share of a limit is held by the limit.
const AT_LIMIT: f64 = 0.999;

impl Walk<'_> {
    /// The reason for the state of an axis in a scan.
    pub(super) fn axis(&mut self, axis: usize, scan: u64) -> Vec<Finding> {
        if !self.enter(3, axis, 0) {
            return Vec::new();
        }
        let commanders = self.look.commanders(axis);
        if commanders.is_empty() {
            return self.idle(axis, scan);
        }
        let mut found = Vec::new();
        let mut latest: Option<(bool, u64, usize)> = None;
        for instance in commanders.iter().copied() {
            if self.look.is_spent() {
                break;
            }
            if let Some(error) = self.look.pin(instance, "Error")
                && let Some(at) = self.look.first_rise(error, 0, scan)
            {
                found.extend(self.failed(instance, error, at));
            }
            let is_active = self.look.shows(instance, "Active", scan);
            let began = self.began(instance, scan);
            latest = latest.max(began.map(|began| (is_active, began, instance)));
            found.extend(self.clamped(instance, scan));
            found.extend(self.pushed_aside(instance, scan));
        }
        match latest {
            Some((_, rose, instance)) => {
                if let Some(bad) = self.ended_badly(instance, rose, scan) {
                    found.extend(bad);
                } else if self.look.shows(instance, "Busy", scan) {
                    found.push(self.follows(instance, rose, scan));
                } else {
                    // Perhaps the next motion is missing.
                    let next = self.untriggered(&commanders, scan).into_iter();
                    found.extend(next.filter(|next| next.way.len() > 1 || next.rank != Rank::Stopped));
                    found.push(self.follows(instance, rose, scan));
                }
            }
            None => {
                let missing = self.untriggered(&commanders, scan);
                found.extend(self.strayed(axis, scan));
                found.extend(missing);
            }
        }
        found.extend(self.fault(axis, scan));
        if found.iter().all(|finding| finding.rank > Rank::Stopped) {
            found.extend(self.unpowered(axis, scan));
        }
        found
    }

    /// An axis that no block commands.
    fn idle(&mut self, axis: usize, scan: u64) -> Vec<Finding> {
        let mut found: Vec<Finding> = self.fault(axis, scan).into_iter().collect();
        found.extend(self.foreign(axis, scan));
        let name = self.look.axis_name(axis);
        if found.is_empty() && self.look.script().programs.is_empty() {
            let text = match self.strayed(axis, scan) {
                Some(stray) => format!("no block commands {name}; {}", stray.text),
                None => format!("no block commands {name}"),
            };
            found.push(Finding::new(Rank::Stopped, Some(0), text));
        }
        found
    }

    /// For an axis that nothing has moved: two blocks that act on another axis in one scan. One of them may be
    /// meant for this axis.
    fn strayed(&mut self, axis: usize, scan: u64) -> Option<Finding> {
        let axes = 0..self.look.script().axes.len();
        let others = axes.filter(|other| *other != axis);
        let all: Vec<usize> = others.flat_map(|other| self.look.commanders(other)).collect();
        let stray = all.into_iter().find_map(|instance| {
            if self.look.is_spent() {
                return None;
            }
            let found = self.pushed_aside(instance, scan)?;
            found.text.contains("in one scan").then_some(found)
        })?;
        let name = self.look.axis_name(axis);
        let text = format!("nothing has moved {name} by scan {scan}; {}", stray.text);
        Some(Finding::new(Rank::Stopped, stray.scan, text))
    }

    /// A command that another one aborted at once, or one whose mode the script gives.
    fn pushed_aside(&mut self, instance: usize, scan: u64) -> Option<Finding> {
        let aborted = self.look.pin(instance, "CommandAborted")?;
        let at = self.look.first_rise(aborted, 0, scan)?;
        let mut found = self.aborted(instance, aborted, at).into_iter().next()?;
        let is_telling = found.text.contains("in one scan") || self.has_mode(&found.text);
        if found.rank == Rank::Expected || !is_telling {
            return None;
        }
        found.rank = Rank::Changed;
        Some(found)
    }

    /// Whether the block that aborts in this sentence has a BufferMode in the script.
    fn has_mode(&self, text: &str) -> bool {
        let mut all = self.look.script().blocks.iter().enumerate();
        all.any(|(index, instance)| {
            let mode = self.look.pin(index, "BufferMode");
            let mut given = instance.constants.iter();
            text.contains(&format!(" by {},", instance.name))
                && given.any(|(pin, _)| mode == Some(Point::Pin(index, *pin)))
        })
    }

    /// The reason why blocks that never started have not started.
    fn untriggered(&mut self, instances: &[usize], scan: u64) -> Vec<Finding> {
        let mut found = Vec::new();
        for instance in instances.iter().copied() {
            if !self.look.is_spent() && self.began(instance, scan).is_none() {
                let trigger = self.look.triggers(instance).into_iter().next();
                found.extend(trigger.map_or_else(Vec::new, |pin| self.feed(instance, pin, 0, scan)));
            }
        }
        found
    }

    fn state(&self, axis: usize, scan: u64) -> Option<&str> {
        match self.look.of(&Signal::State(axis), scan)? {
            Cell::Name(name) => Some(name),
            _ => None,
        }
    }

    /// The cause of the axis's ErrorStop.
    pub(super) fn fault(&self, axis: usize, scan: u64) -> Option<Finding> {
        let stopped = AxisState::ErrorStop.name();
        if self.state(axis, scan) != Some(stopped) {
            return None;
        }
        let entered = (0..scan)
            .rev()
            .find(|&scan| self.state(axis, scan) != Some(stopped))
            .map_or(0, |before| before + 1);
        let name = self.look.axis_name(axis);
        let note = self.look.note(name, entered, "fault ");
        let told = note.and_then(|note| note.strip_prefix("fault ")).unwrap_or("");
        let id = words::error_of(told);
        let (cause, by_step) = (
            id.map_or_else(|| told.to_owned(), |id| words::error(told, id)),
            self.is_by_step(axis),
        );
        let mut text = format!("{name} went to ErrorStop in scan {entered}: {cause}");
        if let Some(hint) = id.and_then(|id| self.reference(axis, id)) {
            text = format!("{text}; {hint}");
        }
        let rank = if by_step { Rank::Expected } else { Rank::Stopped };
        Some(Finding::new(rank, Some(entered), text))
    }

    /// Whether a step of the script makes the axis fail.
    fn is_by_step(&self, axis: usize) -> bool {
        let mut actions = self.look.script().steps.iter().flat_map(|step| &step.actions);
        actions.any(|action| matches!(action, Action::Fault { axis: failing, .. } if *failing == axis))
    }

    /// Refusals of blocks that the script does not have: those of programs.
    fn foreign(&self, axis: usize, scan: u64) -> Option<Finding> {
        let programs = &self.look.script().programs;
        let of_program = |subject: &str| {
            let owner = subject.split('.').next().unwrap_or_default();
            programs.iter().any(|program| program.name == owner)
        };
        let notes = self.look.rows.trace.notes().iter();
        let mut notes = notes.filter(|note| note.scan as u64 <= scan && of_program(&note.subject));
        let text = notes.find_map(|note| {
            let text = words::noted(&note.subject, note.scan as u64, &note.text)?;
            Some((note.scan as u64, text))
        });
        let (at, text) = text?;
        let way = format!("{} is commanded by a program", self.look.axis_name(axis));
        Some(Finding::new(Rank::Stopped, Some(at), text).after(&way))
    }

    /// The reason why the axis has no power in a scan; nothing if it has.
    pub(super) fn unpowered(&mut self, axis: usize, scan: u64) -> Option<Finding> {
        if self.state(axis, scan) != Some(AxisState::Disabled.name()) {
            return None;
        }
        let name = self.look.axis_name(axis);
        let step = format!("{name} is Disabled in scan {scan}");
        let found = self.power(axis, scan).into_iter().next()?;
        Some(found.after(&step))
    }

    /// The reason why the power of an axis is off.
    pub(super) fn power(&mut self, axis: usize, scan: u64) -> Vec<Finding> {
        let name = self.look.axis_name(axis);
        let all = self.look.script().blocks.iter().enumerate();
        let powers: Vec<usize> = all
            .filter(|(_, instance)| instance.block.name == "MC_Power")
            .map(|(index, _)| index)
            .collect();
        let own = powers
            .iter()
            .copied()
            .find(|index| self.look.axes_of(*index).contains(&axis));
        let Some(instance) = own else {
            let others: Vec<_> = powers.iter().map(|power| self.look.name(*power)).collect();
            let text = match others.as_slice() {
                [] => format!("there is no MC_Power for {name}, and it does not start in Standstill"),
                others => format!(
                    "no MC_Power is for {name} ({} is for another axis), and it does not start in Standstill",
                    others.join(", ")
                ),
            };
            return vec![Finding::new(Rank::Stopped, Some(0), text)];
        };
        let Some(enable @ Point::Pin(_, pin)) = self.look.pin(instance, "Enable") else {
            return Vec::new();
        };
        if let Some(error) = self.look.pin(instance, "Error")
            && let Some(at) = self.look.first_rise(error, 0, scan)
        {
            return self.failed(instance, error, at);
        }
        let power = self.look.name(instance);
        let Some(rose) = self.look.last_rise(enable, scan) else {
            return self.feed(instance, pin, 0, scan);
        };
        let end = self.look.end_of(enable, rose);
        let text = if end < scan {
            let by = self.wired(instance, pin);
            format!("{power}.Enable{by} was TRUE in {} only", words::scans(rose, end))
        } else {
            let status = self.look.pin(instance, "Status");
            match status.and_then(|status| self.look.first_true(status, rose, u64::MAX)) {
                Some(on) if on <= scan => return Vec::new(),
                Some(on) => format!(
                    "{power}.Enable rose in scan {rose}, and the drive has power from scan {on} on: wait for {power}.Status"
                ),
                None => format!(
                    "{power}.Enable rose in scan {rose}, and the drive of {name} never confirmed its power"
                ),
            }
        };
        vec![Finding::new(Rank::Stopped, Some(rose), text)]
    }

    /// The first value of a block that was changed on its way to the axis.
    fn clamped(&self, instance: usize, scan: u64) -> Option<Finding> {
        let name = self.look.name(instance);
        let mut own = self.look.notes_on(name, scan);
        let changed = own.find_map(|note| {
            let at = note.scan as u64;
            Some((at, words::changed(name, at, &note.text)?))
        });
        let (at, text) = changed?;
        let axes = self.look.axes_of(instance);
        let axis = axes.first().map_or("", |axis| self.look.axis_name(*axis));
        let text = text.replacen(" was ", &format!(", of {axis}, was "), 1);
        Some(Finding::new(Rank::Changed, Some(at), text))
    }

    /// A motion that is still in progress.
    pub(super) fn under_way(&self, instance: usize, rose: u64, scan: u64) -> Finding {
        let mut finding = self.follows(instance, rose, scan);
        finding.rank = Rank::Slow;
        let name = self.look.name(instance);
        let axis = self.look.axes_of(instance).first().copied();
        let plan = axis.and_then(|axis| {
            let begins = format!("plan for {name} ");
            let axis = self.look.axis_name(axis);
            self.look.last_note(axis, &begins, rose, scan)
        });
        let length = plan.and_then(|(at, text)| {
            let scans = text.rsplit(" in ").next()?.strip_suffix(" scans")?;
            Some((at, scans.parse::<u64>().ok()?))
        });
        if let Some((at, scans)) = length {
            finding.text.push_str(&format!(
                "; its plan of scan {at} takes {scans} scans, to scan {}",
                at + scans
            ));
        }
        let kind = self.look.instance(instance).map(|found| found.block.name);
        let hint = axis.filter(|_| kind == Some("MC_Home"));
        let hint = hint.and_then(|axis| self.reference(axis, ErrorId::HomingTooFar));
        if let Some(hint) = hint {
            finding.text = format!("{}; {hint}", finding.text);
        }
        if let Some(clamped) = self.clamped(instance, scan) {
            finding.scan = clamped.scan;
            finding.text = format!("{}; {}", clamped.text, finding.text);
        }
        finding
    }

    /// The values of a block's motion, and the limit that holds it.
    pub(super) fn follows(&self, instance: usize, rose: u64, scan: u64) -> Finding {
        let name = self.look.name(instance);
        let kind = self
            .look
            .instance(instance)
            .map_or("", |instance| instance.block.name);
        let values = self.look.values(instance, scan);
        let values = if values.is_empty() {
            values
        } else {
            format!(" with {values}")
        };
        let since = if self.look.shows(instance, "Busy", scan) {
            format!("is under way since scan {rose}")
        } else {
            format!("was triggered last in scan {rose}")
        };
        let mut text = format!("{name} ({kind}) {since}{values}");
        let axis = self.look.axes_of(instance).first().copied();
        if let Some(held) = axis.and_then(|axis| self.held_by(axis, instance, rose, scan)) {
            text = format!("{text}, held by {held}");
        }
        if let Some(slowed) = axis.and_then(|axis| self.slowed(axis, scan)) {
            text = format!("{text}, slowed by {slowed}");
        }
        Finding::new(Rank::Follows, Some(rose), text)
    }

    /// The override of an axis in a scan, if it is not 1.
    fn slowed(&self, axis: usize, scan: u64) -> Option<String> {
        let all = self.look.script().blocks.iter().enumerate();
        let mut own = all.filter(|(_, found)| found.block.name == "MC_SetOverride" && found.has_axis(axis));
        own.find_map(
            |(instance, found)| match self.look.at(instance, "VelFactor", scan)? {
                Cell::Real(factor) if factor != 1.0 && self.look.shows(instance, "Enabled", scan) => {
                    Some(format!("{} with VelFactor {}", found.name, shortest(factor)))
                }
                _ => None,
            },
        )
    }

    /// The limit that held the axis most of the time: an axis limit or the Velocity of the block.
    fn held_by(&self, axis: usize, instance: usize, from: u64, to: u64) -> Option<String> {
        let limits = self.look.rows.trace.header().axes.get(axis)?.limits;
        let name = self.look.axis_name(axis);
        let asked = match self.look.at(instance, "Velocity", to) {
            Some(Cell::Real(value)) if value > 0.0 => Some(value),
            _ => None,
        };
        let limit = |key: &str, value: Option<f64>| {
            value.map(|value| (value, format!("limits.{key} {} of {name}", shortest(value))))
        };
        let velocity = match (asked, limits.velocity) {
            (Some(asked), None) => Some((asked, format!("its Velocity {}", shortest(asked)))),
            (Some(asked), Some(limit)) if asked < limit => {
                Some((asked, format!("its Velocity {}", shortest(asked))))
            }
            (_, velocity) => limit("velocity", velocity),
        };
        let all = [
            (AxisNumber::Velocity, velocity),
            (
                AxisNumber::Acceleration,
                limit("acceleration", limits.acceleration),
            ),
            (AxisNumber::Jerk, limit("jerk", limits.jerk)),
            (AxisNumber::Snap, limit("snap", limits.snap)),
        ];
        let share = |number: AxisNumber, bound: f64| {
            let at = (from..=to).filter(|&scan| {
                let cell = self.look.of(&Signal::Axis(axis, number), scan);
                matches!(cell, Some(Cell::Real(value)) if value.abs() >= AT_LIMIT * bound)
            });
            at.count()
        };
        let shares = all
            .into_iter()
            .filter_map(|(number, bound)| bound.map(|(value, text)| (share(number, value), text)));
        // Of those with equal time, the one of the lower order.
        let most = shares.reduce(|best, next| if next.0 > best.0 { next } else { best })?;
        (most.0 > 0).then_some(most.1)
    }

    /// The place of the reference that a homing did not find.
    pub(super) fn reference(&self, axis: usize, id: ErrorId) -> Option<String> {
        let looks = matches!(
            id,
            ErrorId::HomingTimedOut
                | ErrorId::HomingTooFar
                | ErrorId::HomingSwitchNotFound
                | ErrorId::LimitSwitchReached
                | ErrorId::HomingSignalMissing
        );
        let found = self.look.script().axes.get(axis).filter(|_| looks)?;
        let switches = found.drive.switches();
        crate::advice::reference(&found.name, found.config.position, &found.config.homing, switches)
    }
}

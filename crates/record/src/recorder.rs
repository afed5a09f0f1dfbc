//! The ring of scans and the trigger that freezes it.

use crate::word;
use alloc::string::String;
use alloc::vec::Vec;
use standstill_axis::{Axis, AxisConfig, AxisState, Log, Planner, Record};
use standstill_fb::{AnyInstance, BlockInfo};

/// Words of an axis in a row: its state, and the numbers of a trace.
pub(crate) const AXIS_WORDS: usize = 7;

/// How much a recorder keeps, and when it stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setup {
    /// Scans that are kept: the last ones, and after a freeze those around the trigger. At least 1.
    pub scans: usize,
    /// Of these, scans after that of the trigger. Less than `scans`.
    pub after: usize,
    /// Records of axes (plans, refusals, faults) that are kept; older ones give way.
    pub records: usize,
    /// What freezes it.
    pub trigger: Trigger,
}

impl Default for Setup {
    /// 2000 scans, 500 of them after an axis went into ErrorStop, and 256 records.
    fn default() -> Self {
        Self {
            scans: 2000,
            after: 500,
            records: 256,
            trigger: Trigger::ErrorStop,
        }
    }
}

/// What freezes a recorder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Trigger {
    /// An axis goes into ErrorStop, or [`Recorder::trip`].
    #[default]
    ErrorStop,
    /// Only [`Recorder::trip`].
    Host,
}

/// Where a recorder stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// It keeps the last scans.
    Armed,
    /// The trigger was seen; so many scans are still to come.
    Tripped {
        /// Scans until it freezes.
        left: usize,
    },
    /// What is there stays, until [`Recorder::arm`].
    Frozen,
}

/// What is recorded: axes and block instances, by name.
#[derive(Clone, Debug, Default)]
pub struct Signals {
    axes: Vec<(String, String, AxisConfig)>,
    instances: Vec<(String, u16, &'static BlockInfo)>,
}

impl Signals {
    /// Nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// The next axis of the machine: its name, the label of its unit, and its configuration.
    #[must_use]
    pub fn axis(mut self, name: &str, unit: &str, config: &AxisConfig) -> Self {
        self.axes.push((name.into(), unit.into(), *config));
        self
    }

    /// The next block instance: its name, the number it has in records, and its block.
    #[must_use]
    pub fn instance(mut self, name: &str, number: u16, block: &'static BlockInfo) -> Self {
        self.instances.push((name.into(), number, block));
        self
    }

    /// Names, labels of the units and configurations of the axes.
    pub fn axes(&self) -> impl Iterator<Item = (&str, &str, &AxisConfig)> {
        self.axes
            .iter()
            .map(|(name, unit, config)| (name.as_str(), unit.as_str(), config))
    }

    /// Names, numbers in records and blocks of the instances.
    pub fn instances(&self) -> impl Iterator<Item = (&str, u16, &'static BlockInfo)> {
        self.instances
            .iter()
            .map(|(name, number, block)| (name.as_str(), *number, *block))
    }

    /// Words of a row.
    fn width(&self) -> usize {
        let pins = self.instances.iter().map(|(_, _, block)| block.pins().count());
        self.axes.len() * AXIS_WORDS + pins.sum::<usize>()
    }
}

/// Takes the pins of a scan, instance by instance, in the order of [`Signals`].
#[derive(Debug)]
pub struct Pins<'a> {
    row: &'a mut [u64],
}

impl Pins<'_> {
    /// The next instance. What does not fit the signals is left out.
    pub fn add(&mut self, instance: &dyn AnyInstance) {
        let count = instance.info().pins().count();
        let Some((own, rest)) = core::mem::take(&mut self.row).split_at_mut_checked(count) else {
            return;
        };
        for (place, word) in own.iter_mut().enumerate() {
            *word = instance.get(place).map_or(0, word::of);
        }
        self.row = rest;
    }
}

/// The last scans of a machine, frozen around a trigger: what a flight recorder is for an aircraft.
///
/// Memory is taken by [`Recorder::new`] and never after it: `scans` rows of 8 bytes a signal.
#[derive(Clone, Debug)]
pub struct Recorder {
    signals: Signals,
    setup: Setup,
    width: usize,
    /// Rows one after the other; the one of scan `n` since arming is at `n % scans`.
    words: Vec<u64>,
    /// States after all blocks were called, before the motion step.
    states: Vec<AxisState>,
    /// Scans since arming.
    seen: u64,
    /// Number of the first scan since arming.
    first: u64,
    state: State,
    tripped: Option<Tripped>,
    records: Vec<Record>,
    /// Records since arming.
    recorded: u64,
    /// Records of the log taken so far.
    taken: u64,
}

/// What tripped a recorder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Tripped {
    /// The scan, counted from arming.
    at: u64,
    /// Place of the axis; none if the host did.
    axis: Option<usize>,
}

impl Recorder {
    /// A recorder of these signals. A `setup` of no scans counts as one of 1, and `after` is at most one less than the
    /// scans.
    pub fn new(setup: Setup, signals: Signals) -> Self {
        let scans = setup.scans.max(1);
        let setup = Setup {
            scans,
            after: setup.after.min(scans - 1),
            ..setup
        };
        let width = signals.width();
        Self {
            width,
            words: alloc::vec![0; width.saturating_mul(scans)],
            states: alloc::vec![AxisState::Disabled; signals.axes.len()],
            seen: 0,
            first: 0,
            state: State::Armed,
            tripped: None,
            records: Vec::with_capacity(setup.records),
            recorded: 0,
            taken: 0,
            setup,
            signals,
        }
    }

    /// The states of the axes, to be told after all blocks were called and before the motion step.
    pub fn observe<P: Planner>(&mut self, axes: &[Axis<P>]) {
        let entered = |(state, axis): (&AxisState, &Axis<P>)| {
            axis.state() == AxisState::ErrorStop && *state != AxisState::ErrorStop
        };
        let found = self.states.iter().zip(axes).position(entered);
        for (state, axis) in self.states.iter_mut().zip(axes) {
            *state = axis.state();
        }
        if let (Some(axis), Trigger::ErrorStop) = (found, self.setup.trigger) {
            self.trip_by(Some(axis));
        }
    }

    /// The end of a scan: set-points are those the drives were given. `pins` adds every instance of the signals.
    pub fn record<P: Planner>(
        &mut self,
        scan: u64,
        axes: &[Axis<P>],
        log: &Log,
        pins: impl FnOnce(&mut Pins<'_>),
    ) {
        if self.state == State::Frozen {
            self.taken = log.total();
            return;
        }
        if self.seen == 0 {
            self.first = scan;
        }
        let place = (self.seen % self.setup.scans as u64) as usize * self.width;
        let row = self.words.get_mut(place..place + self.width).unwrap_or_default();
        let Some((own, rest)) = row.split_at_mut_checked(self.states.len() * AXIS_WORDS) else {
            return;
        };
        for ((words, state), axis) in own.chunks_exact_mut(AXIS_WORDS).zip(&self.states).zip(axes) {
            let setpoint = axis.setpoint();
            let numbers = [
                setpoint.position,
                setpoint.velocity,
                setpoint.acceleration,
                setpoint.jerk,
                setpoint.snap,
                axis.actual_position(),
            ];
            let all = core::iter::once(*state as u64).chain(numbers.map(f64::to_bits));
            for (word, value) in words.iter_mut().zip(all) {
                *word = value;
            }
        }
        pins(&mut Pins { row: rest });
        for record in log.since(self.taken) {
            self.keep(*record);
        }
        self.taken = log.total();
        self.seen += 1;
        self.state = match self.state {
            State::Tripped { left: 0 } => State::Frozen,
            State::Tripped { left } => State::Tripped { left: left - 1 },
            other => other,
        };
    }

    /// Keeps a record; the oldest gives way.
    fn keep(&mut self, record: Record) {
        if self.records.len() < self.setup.records {
            self.records.push(record);
        } else if let Some(place) = self.recorded.checked_rem(self.setup.records as u64)
            && let Some(slot) = self.records.get_mut(place as usize)
        {
            *slot = record;
        }
        self.recorded += 1;
    }

    /// Trips the recorder in the scan whose end comes next, for a reason of the host's; without effect on one that has
    /// tripped.
    pub fn trip(&mut self) {
        self.trip_by(None);
    }

    fn trip_by(&mut self, axis: Option<usize>) {
        if self.state == State::Armed {
            self.state = State::Tripped {
                left: self.setup.after,
            };
            self.tripped = Some(Tripped { at: self.seen, axis });
        }
    }

    /// Forgets everything and waits for the next trigger.
    pub fn arm(&mut self) {
        self.seen = 0;
        self.state = State::Armed;
        self.tripped = None;
        self.records.clear();
        self.recorded = 0;
    }

    /// What it records.
    pub const fn signals(&self) -> &Signals {
        &self.signals
    }

    /// Where it stands.
    pub const fn state(&self) -> State {
        self.state
    }

    /// The scan that tripped it, and the place of the axis that went into ErrorStop; no axis if the host did.
    pub fn tripped(&self) -> Option<(u64, Option<usize>)> {
        let tripped = self.tripped?;
        Some((self.first + tripped.at, tripped.axis))
    }

    /// The number of the first scan that is there, and how many are.
    pub fn scans(&self) -> (u64, usize) {
        let kept = self.seen.min(self.setup.scans as u64);
        (self.first + (self.seen - kept), kept as usize)
    }

    /// The words of the scans that are there, oldest first, for a host without `std` to send elsewhere. Of every axis:
    /// the place of its state in [`AxisState::ALL`], then the bits of position, velocity, acceleration, jerk, snap and
    /// actual position. Then the pins of every instance: numbers as their bits, whatever is signed extended with its
    /// sign.
    pub fn rows(&self) -> impl Iterator<Item = &[u64]> {
        let (_, kept) = self.scans();
        let oldest = self.seen - kept as u64;
        (oldest..self.seen).map(|scan| {
            let place = (scan % self.setup.scans as u64) as usize * self.width;
            self.words.get(place..place + self.width).unwrap_or_default()
        })
    }

    /// The records that are there, oldest first.
    pub fn records(&self) -> impl Iterator<Item = &Record> {
        let split = match self.records.len() as u64 {
            0 => 0,
            full if self.recorded > full => (self.recorded % full) as usize,
            _ => 0,
        };
        let (newer, older) = self.records.split_at(split);
        older.iter().chain(newer)
    }
}

//! The recorder of hosts with a heap.

use crate::ring::{AXIS_WORDS, Ring, Setup, State, write_axis};
use alloc::string::String;
use alloc::vec::Vec;
use standstill_axis::{Axis, AxisConfig, AxisState, Log, Planner, Record};
use standstill_fb::{AnyInstance, BlockInfo};

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
        instance.put_words(own);
        self.row = rest;
    }
}

/// The last scans of a machine, frozen around a trigger: what a flight recorder is for an aircraft.
///
/// Memory is taken by [`Recorder::new`] and never after it: `scans` rows of 8 bytes a signal.
#[derive(Clone, Debug)]
pub struct Recorder {
    signals: Signals,
    ring: Ring,
    width: usize,
    /// Rows one after the other, at the places of the ring.
    words: Vec<u64>,
    /// States after all blocks were called, before the motion step.
    states: Vec<AxisState>,
    records: Vec<Record>,
}

impl Recorder {
    /// A recorder of these signals. A `setup` of no scans counts as one of 1, and `after` is at most one less than the
    /// scans.
    pub fn new(setup: Setup, signals: Signals) -> Self {
        let ring = Ring::new(setup);
        let width = signals.width();
        Self {
            width,
            words: alloc::vec![0; width.saturating_mul(ring.setup().scans)],
            states: alloc::vec![AxisState::Disabled; signals.axes.len()],
            records: Vec::with_capacity(setup.records),
            ring,
            signals,
        }
    }

    /// Takes the states of the axes; call it after all blocks and before the motion step.
    pub fn observe<P: Planner>(&mut self, axes: &[Axis<P>]) {
        self.ring.observe(&mut self.states, axes);
    }

    /// The end of a scan: set-points are those the drives were given. `pins` adds every instance of the signals.
    pub fn record<P: Planner>(
        &mut self,
        scan: u64,
        axes: &[Axis<P>],
        log: &Log,
        pins: impl FnOnce(&mut Pins<'_>),
    ) {
        let Some(place) = self.ring.begin(scan, log) else {
            return;
        };
        let place = place * self.width;
        let row = self.words.get_mut(place..place + self.width).unwrap_or_default();
        let Some((own, rest)) = row.split_at_mut_checked(self.states.len() * AXIS_WORDS) else {
            return;
        };
        for ((words, state), axis) in own.chunks_exact_mut(AXIS_WORDS).zip(&self.states).zip(axes) {
            write_axis(words, scan, *state, axis);
        }
        pins(&mut Pins { row: rest });
        for record in log.since(self.ring.taken()) {
            match self.ring.keep() {
                Some(place) if place == self.records.len() => self.records.push(*record),
                Some(place) => {
                    if let Some(slot) = self.records.get_mut(place) {
                        *slot = *record;
                    }
                }
                None => {}
            }
        }
        self.ring.end(log);
    }

    /// Trips the recorder in the scan whose end comes next, for a reason of the host's; without effect on one that has
    /// tripped.
    pub fn trip(&mut self) {
        self.ring.trip(None);
    }

    /// Forgets everything and waits for the next trigger.
    pub fn arm(&mut self) {
        self.ring.arm();
        self.records.clear();
    }

    /// Where rows and records stand.
    #[cfg(feature = "std")]
    pub(crate) const fn ring(&self) -> &Ring {
        &self.ring
    }

    /// What it records.
    pub const fn signals(&self) -> &Signals {
        &self.signals
    }

    /// Where it stands.
    pub const fn state(&self) -> State {
        self.ring.state()
    }

    /// The scan that tripped it, and the place of the axis that went into ErrorStop; no axis if the host did.
    pub fn tripped(&self) -> Option<(u64, Option<usize>)> {
        self.ring.tripped()
    }

    /// The number of the first scan that is there, and how many are.
    pub fn scans(&self) -> (u64, usize) {
        self.ring.scans()
    }

    /// The words of the scans that are there, oldest first, for a host without `std` to send elsewhere. Of every axis:
    /// the place of its state in [`AxisState::ALL`], then the bits of position, velocity, acceleration, jerk, snap, actual
    /// position, and by how much its coordinates moved in that scan. Then the pins of every instance: numbers as their bits, whatever is signed extended with its
    /// sign.
    pub fn rows(&self) -> impl Iterator<Item = &[u64]> {
        let (_, kept) = self.scans();
        (0..kept).filter_map(|row| {
            let place = self.ring.row(row)? * self.width;
            self.words.get(place..place + self.width)
        })
    }

    /// The records that are there, oldest first.
    pub fn records(&self) -> impl Iterator<Item = &Record> {
        self.ring.records().filter_map(|place| self.records.get(place))
    }
}

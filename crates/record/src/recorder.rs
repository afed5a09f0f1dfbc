//! The recorder for hosts with a heap.

use crate::ring::{AXIS_WORDS, Ring, Setup, State};
use alloc::string::String;
use alloc::vec::Vec;
use standstill_axis::{Axis, AxisConfig, AxisState, Log, Planner, Record};
use standstill_fb::{AnyInstance, BlockInfo};

/// The recorded signals: axes and block instances, by name.
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

    /// Adds the next axis of the machine: its name, the label of its unit, and its configuration.
    #[must_use]
    pub fn axis(mut self, name: &str, unit: &str, config: &AxisConfig) -> Self {
        self.axes.push((name.into(), unit.into(), *config));
        self
    }

    /// Adds the next block instance: its name, its number in records, and its block.
    #[must_use]
    pub fn instance(mut self, name: &str, number: u16, block: &'static BlockInfo) -> Self {
        self.instances.push((name.into(), number, block));
        self
    }

    /// Names, unit labels and configurations of the axes.
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

/// Takes the pins of one scan, instance by instance, in the order of [`Signals`].
#[derive(Debug)]
pub struct Pins<'a> {
    row: &'a mut [u64],
}

impl Pins<'_> {
    /// Adds the pins of the next instance. Pins that do not match the signals are left out.
    pub fn add(&mut self, instance: &dyn AnyInstance) {
        let count = instance.info().pins().count();
        let Some((own, rest)) = core::mem::take(&mut self.row).split_at_mut_checked(count) else {
            return;
        };
        instance.put_words(own);
        self.row = rest;
    }
}

/// A flight recorder: the last scans of a machine, frozen around a trigger.
///
/// [`Recorder::new`] allocates all memory: `scans` rows of 8 bytes a signal. Nothing is allocated later.
#[derive(Clone, Debug)]
pub struct Recorder {
    signals: Signals,
    ring: Ring,
    width: usize,
    /// All rows, one after the other, at their places in the ring.
    words: Vec<u64>,
    /// States after all blocks were called, before the motion step.
    states: Vec<AxisState>,
    records: Vec<Record>,
}

impl Recorder {
    /// Creates a recorder of these signals. A `setup` with 0 scans counts as 1, and `after` is limited to
    /// one less than the scans.
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

    /// Takes the states of the axes. Call it after all blocks and before the motion step.
    pub fn observe<P: Planner>(&mut self, axes: &[Axis<P>]) {
        self.ring.observe(&mut self.states, axes);
    }

    /// Ends a scan. The set-points are those that the drives received. `pins` adds every instance of the signals.
    pub fn record<P: Planner>(
        &mut self,
        scan: u64,
        axes: &[Axis<P>],
        log: &Log,
        pins: impl FnOnce(&mut Pins<'_>),
    ) {
        let (states, records) = (&self.states[..], &mut self.records);
        self.ring.record(
            scan,
            (axes, states),
            log,
            &mut self.words,
            |row| pins(&mut Pins { row }),
            |place, record| match records.get_mut(place) {
                Some(slot) => *slot = *record,
                None => records.push(*record),
            },
        );
    }

    /// Trips the recorder in the scan that ends next, for a reason of the host's own. No effect on a tripped
    /// recorder.
    pub fn trip(&mut self) {
        self.ring.trip(None);
    }

    /// Forgets everything and waits for the next trigger.
    pub fn arm(&mut self) {
        self.ring.arm();
        self.records.clear();
    }

    /// The places of rows and records.
    #[cfg(feature = "std")]
    pub(crate) const fn ring(&self) -> &Ring {
        &self.ring
    }

    /// The recorded signals.
    pub const fn signals(&self) -> &Signals {
        &self.signals
    }

    /// Its state: armed, tripped or frozen.
    pub const fn state(&self) -> State {
        self.ring.state()
    }

    /// The scan that tripped the recorder, and the index of the axis that went into ErrorStop; no axis if
    /// the host tripped it.
    pub fn tripped(&self) -> Option<(u64, Option<usize>)> {
        self.ring.tripped()
    }

    /// The number of the first scan in the recorder, and the count of scans.
    pub fn scans(&self) -> (u64, usize) {
        self.ring.scans()
    }

    /// The words of the recorded scans, oldest first, for a host without `std` to send elsewhere. For
    /// every axis: the index of its state in [`AxisState::ALL`], then the bits of position, velocity,
    /// acceleration, jerk, snap and actual position, and the shift of its coordinates in that scan. Then
    /// the pins of every instance: numbers as their bits, signed ones sign-extended.
    pub fn rows(&self) -> impl Iterator<Item = &[u64]> {
        let (_, kept) = self.scans();
        (0..kept).filter_map(|row| {
            let place = self.ring.row(row)? * self.width;
            self.words.get(place..place + self.width)
        })
    }

    /// The recorded records, oldest first.
    pub fn records(&self) -> impl Iterator<Item = &Record> {
        self.ring.records().filter_map(|place| self.records.get(place))
    }
}

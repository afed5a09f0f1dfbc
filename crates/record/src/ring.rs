//! The places of the last scans in memory of any kind, and the trigger that freezes them.

use standstill_axis::{Axis, AxisState, Log, Planner, Record};

/// Words of an axis in a row: its state, the numbers of a trace, and the shift of its coordinates.
///
/// The rows hold the shifts, because the record of a shift may be lost or overwritten while its scan is
/// still in the ring. A trace without the shift would show a jump.
pub const AXIS_WORDS: usize = 8;

/// How much a recorder keeps, and when it stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setup {
    /// Scans that are kept: the last ones, and after a freeze those around the trigger. At least 1.
    pub scans: usize,
    /// Of these, scans after that of the trigger. Less than `scans`.
    pub after: usize,
    /// Records of axes (plans, refusals, faults) that are kept; newer ones replace older ones.
    pub records: usize,
    /// The event that freezes it.
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

/// The event that freezes a recorder.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Trigger {
    /// An axis goes into ErrorStop, or [`Ring::trip`].
    #[default]
    ErrorStop,
    /// Only [`Ring::trip`].
    Host,
}

/// The state of a recorder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum State {
    /// It keeps the last scans.
    Armed,
    /// The trigger was seen; some scans are still to come.
    Tripped {
        /// Scans until it freezes.
        left: usize,
    },
    /// The contents stay until [`Ring::arm`].
    Frozen,
}

/// The cause that tripped a recorder.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Tripped {
    /// The scan, counted from arming.
    at: u64,
    /// Index of the axis; none if the host tripped the recorder.
    axis: Option<usize>,
}

/// The places of rows and records in lists of fixed length, and the moment to stop writing.
///
/// It holds no rows: [`Recorder`](crate::Recorder) keeps them on the heap, other recorders in memory of their host.
#[derive(Clone, Copy, Debug)]
pub struct Ring {
    setup: Setup,
    /// Scans since arming.
    seen: u64,
    /// Number of the first scan since arming.
    first: u64,
    state: State,
    tripped: Option<Tripped>,
    /// Records since arming.
    recorded: u64,
    /// Number of records of the log taken so far.
    taken: u64,
}

impl Ring {
    /// Creates an armed ring. A `setup` with 0 scans counts as 1, and `after` is limited to one less than
    /// the scans.
    pub fn new(setup: Setup) -> Self {
        let scans = setup.scans.max(1);
        Self {
            setup: Setup {
                scans,
                after: setup.after.min(scans - 1),
                ..setup
            },
            seen: 0,
            first: 0,
            state: State::Armed,
            tripped: None,
            recorded: 0,
            taken: 0,
        }
    }

    /// The set-up.
    pub const fn setup(&self) -> &Setup {
        &self.setup
    }

    /// Takes the states of the axes after all blocks were called and before the motion step. `states`
    /// holds those of the scan before and is updated.
    pub fn observe<P: Planner>(&mut self, states: &mut [AxisState], axes: &[Axis<P>]) {
        let entered = |(state, axis): (&AxisState, &Axis<P>)| {
            axis.state() == AxisState::ErrorStop && *state != AxisState::ErrorStop
        };
        let found = states.iter().zip(axes).position(entered);
        for (state, axis) in states.iter_mut().zip(axes) {
            *state = axis.state();
        }
        if let (Some(axis), Trigger::ErrorStop) = (found, self.setup.trigger) {
            self.trip(Some(axis));
        }
    }

    /// Ends `scan`, unless the ring is frozen. `words` are all rows: the axes are written to the next one, with the
    /// states that [`Ring::observe`] took, and `pins` to the words behind them. `keep` gets every new record with its
    /// place.
    pub fn record<P: Planner>(
        &mut self,
        scan: u64,
        (axes, states): (&[Axis<P>], &[AxisState]),
        log: &Log,
        words: &mut [u64],
        pins: impl FnOnce(&mut [u64]),
        mut keep: impl FnMut(usize, &Record),
    ) {
        let new = core::mem::replace(&mut self.taken, log.total());
        if self.state == State::Frozen {
            return;
        }
        if self.seen == 0 {
            self.first = scan;
        }
        let width = words.len().checked_div(self.setup.scans).unwrap_or_default();
        let place = self.place(self.seen, self.setup.scans) * width;
        let row = words.get_mut(place..place + width).unwrap_or_default();
        if let Some((own, rest)) = row.split_at_mut_checked(states.len() * AXIS_WORDS) {
            for ((words, state), axis) in own.chunks_exact_mut(AXIS_WORDS).zip(states).zip(axes) {
                write_axis(words, scan, *state, axis);
            }
            pins(rest);
        }
        let room = self.setup.records;
        for record in log.since(new).filter(|_| room > 0) {
            keep(self.place(self.recorded, room), record);
            self.recorded += 1;
        }
        self.seen += 1;
        self.state = match self.state {
            State::Tripped { left: 0 } => State::Frozen,
            State::Tripped { left } => State::Tripped { left: left - 1 },
            other => other,
        };
    }

    /// Trips in the scan that ends next, because of the axis at this index or for a reason of the host's
    /// own. No effect on a tripped ring.
    pub fn trip(&mut self, axis: Option<usize>) {
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
        self.recorded = 0;
    }

    /// Its state.
    pub const fn state(&self) -> State {
        self.state
    }

    /// The scan that tripped it, and the index of the axis that went into ErrorStop. There is no axis if the host
    /// tripped it.
    pub fn tripped(&self) -> Option<(u64, Option<usize>)> {
        let tripped = self.tripped?;
        Some((self.first + tripped.at, tripped.axis))
    }

    /// The number of the first scan in the ring, and the count of scans.
    pub fn scans(&self) -> (u64, usize) {
        let kept = self.seen.min(self.setup.scans as u64);
        (self.first + (self.seen - kept), kept as usize)
    }

    /// The place of row number `row` among the rows in the ring.
    pub fn row(&self, row: usize) -> Option<usize> {
        let (_, kept) = self.scans();
        let oldest = self.seen - kept as u64;
        (row < kept).then(|| self.place(oldest + row as u64, self.setup.scans))
    }

    /// The places of the records in the ring, oldest first.
    pub fn records(&self) -> impl Iterator<Item = usize> + use<> {
        let ring = *self;
        let kept = ring.recorded.min(ring.setup.records as u64);
        (ring.recorded - kept..ring.recorded).map(move |number| ring.place(number, ring.setup.records))
    }

    /// A number that rises with every scan that is kept, and with every arming.
    pub const fn stamp(&self) -> u64 {
        self.first.wrapping_add(self.seen)
    }

    fn place(&self, number: u64, room: usize) -> usize {
        number.checked_rem(room as u64).unwrap_or_default() as usize
    }
}

/// The shift of the coordinates in this scan (u), from the words of an axis; 0 if there was none.
pub fn moved(words: &[u64]) -> f64 {
    words.last().map_or(0.0, |word| f64::from_bits(*word))
}

/// Writes an axis into its words of the row of `scan`: the index of its state in [`AxisState::ALL`], then the bits
/// of its numbers. `state` is the state before the motion step. The set-points are those that the drive received.
pub fn write_axis<P: Planner>(words: &mut [u64], scan: u64, state: AxisState, axis: &Axis<P>) {
    let setpoint = axis.setpoint();
    let numbers = [
        setpoint.position,
        setpoint.velocity,
        setpoint.acceleration,
        setpoint.jerk,
        setpoint.snap,
        axis.actual_position(),
        axis.coordinates_moved(scan),
    ];
    let all = core::iter::once(state as u64).chain(numbers.map(f64::to_bits));
    for (word, value) in words.iter_mut().zip(all) {
        *word = value;
    }
}

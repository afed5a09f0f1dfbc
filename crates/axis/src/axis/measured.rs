//! Actual positions as a master. They are filtered into a motion with a velocity, an acceleration, a jerk and a snap.
//!
//! A change of one increment in a scan is thousands of times the snap of a machine. So slaves see the feedback
//! through four moving averages in series, each over the time `actual_filter`. The input is the position, held from
//! latch to latch. Four averages of a step make a motion in pieces of constant snap, each one scan long, so its
//! derivatives are exact and not estimated. An average has L scans of T, and the noise is at most q in either
//! direction. Then the largest errors against the undisturbed motion are: snap 16 q / (L T)^4, jerk 8 q / (L T)^3,
//! acceleration 4 q / (L T)^2, velocity 2 q / (L T).
//!
//! All sums are integers. The averages at the ends of scans, times L^4, are running sums of running sums
//! of increments. The part within a scan is a sum with the weights 1, 11, 11, 1 over 24. So nothing
//! drifts, and at rest the reported position is exact to the bit.
//!
//! Drives that use units have no increments. With the filter off, the weights above remain, on
//! floating-point numbers.

use super::Axis;
use super::coupling::Seen;
use crate::{ACTUAL_FILTER_MAX, AxisConfig, DrivePosition, Scaling};
use standstill_planner::turns::split;
use standstill_planner::{Place, Planner, Setpoint};

/// Averages in series.
const AVERAGES: usize = 4;

/// Steps kept.
const RING: usize = AVERAGES * ACTUAL_FILTER_MAX as usize;

/// Steps of the output from which its derivatives in this scan and in the last one are computed.
const OUTPUTS: usize = 6;

/// The feedback is constant if it has been within this span (increments) ..
const BAND: u64 = 2;

/// .. for at least this many scans.
const REST: u32 = 64;

/// The actual positions of an axis as its slaves see them.
#[derive(Clone, Debug)]
pub(super) struct Measured {
    counted: Option<Counted>,
    told: Option<Told>,
}

/// An encoder at rest that trembles by two increments in either direction seems to move by at most one increment in
/// this number of scans. This is the bound of the velocity above, with the filter of an axis that sets none.
const TREMBLE: i128 = 4;

/// A place and its derivatives, per scan.
struct State {
    /// Distance (increments, or u) of the place ahead of `from`.
    ahead: f64,
    /// Velocity, acceleration, jerk and snap.
    rates: [f64; 4],
}

/// A position of the averages: whole increments, and the remainder ahead of them.
type AtIncrement = (i64, State);

/// The filter for a drive that counts increments.
#[derive(Clone, Debug)]
struct Counted {
    /// Scans per average; 1 with the filter off.
    length: u32,
    /// The steps of the last four times `length` scans (increments), in a ring.
    steps: [i32; RING],
    /// Index of the oldest of them.
    oldest: usize,
    /// Sums of the steps over one, two, three and four averages; the last is the step of the output.
    sums: [i64; AVERAGES],
    /// The last steps of the output, the newest first (increments / `length`^4).
    out: [i64; OUTPUTS],
    /// The output (increments / `length`^4).
    place: i128,
    /// The last reported position, and the part of it that went into the averages; none before the first
    /// scan.
    last: Option<(i64, i64)>,
    /// The same in the scan before.
    before: Option<(i64, i64)>,
    /// The number of scans since the last step.
    still: u32,
    band: Band,
}

/// A dead band: whether the feedback is constant except for one increment in either direction.
#[derive(Clone, Copy, Debug, Default)]
struct Band {
    lowest: i64,
    highest: i64,
    /// Scans within these bounds, since they last grew.
    scans: u32,
    /// The last reported position, and for how many scans.
    last: i64,
    same: u32,
    /// Its constant value.
    held: Option<i64>,
}

/// The filter for a drive that uses units.
#[derive(Clone, Debug)]
struct Told {
    /// Turns and position (u) as latched, the newest first.
    places: [(i64, f64); OUTPUTS + 1],
    is_new: bool,
}

impl Band {
    /// The part of `told` that is motion: `told` itself, or a constant position after `told` has been at rest for
    /// `rest` scans.
    fn pass(&mut self, told: i64, rest: u32) -> i64 {
        if let Some(held) = self.held
            && held.abs_diff(told) <= BAND / 2
        {
            return held;
        }
        let (lowest, highest) = (self.lowest.min(told), self.highest.max(told));
        if self.held.is_some() || highest.abs_diff(lowest) > BAND {
            *self = Self::at(told);
            return told;
        }
        let grows = (lowest, highest) != (self.lowest, self.highest);
        let more = |scans: u32| scans.saturating_add(1);
        *self = Self {
            lowest,
            highest,
            scans: if grows { 0 } else { more(self.scans) },
            last: told,
            same: if told == self.last { more(self.same) } else { 0 },
            held: None,
        };
        if self.scans < rest {
            return told;
        }
        let middle = lowest + (highest - lowest) / 2;
        let held = if self.same < rest { middle } else { told };
        self.held = Some(held);
        held
    }

    fn at(told: i64) -> Self {
        Self {
            lowest: told,
            highest: told,
            last: told,
            ..Self::default()
        }
    }
}

impl Counted {
    fn new(length: u32) -> Self {
        Self {
            length: length.clamp(1, ACTUAL_FILTER_MAX),
            steps: [0; RING],
            oldest: 0,
            sums: [0; AVERAGES],
            out: [0; OUTPUTS],
            place: 0,
            last: None,
            before: None,
            still: u32::MAX,
            band: Band::default(),
        }
    }

    /// `length`^4.
    fn scale(&self) -> i128 {
        let length = i128::from(self.length);
        length * length * length * length
    }

    /// Starts at `told`, as if it had always had this value.
    #[cold]
    fn start(&mut self, told: i64) {
        *self = Self {
            place: i128::from(told) * self.scale(),
            last: Some((told, told)),
            band: Band::at(told),
            ..Self::new(self.length)
        };
    }

    /// Takes the increments of the next scan.
    fn take(&mut self, told: i64) {
        let Some((_, fed)) = self.last else {
            return self.start(told);
        };
        let rest = REST.max(4 * self.length);
        let next = self.band.pass(told, rest);
        // No axis moves 2^31 increments in a scan. Such a jump is not a motion.
        let step = next.checked_sub(fed).and_then(|step| i32::try_from(step).ok());
        let Some(step) = step else {
            return self.start(told);
        };
        self.before = self.last;
        self.last = Some((told, next));
        self.push(step);
    }

    /// A scan without a position: the place does not change.
    fn wait(&mut self) {
        if self.last.is_some() {
            self.before = self.last;
            self.push(0);
        }
    }

    fn push(&mut self, step: i32) {
        self.still = if step == 0 {
            self.still.saturating_add(1)
        } else {
            0
        };
        // At rest nothing changes any more.
        if self.is_still() {
            return;
        }
        let length = self.length as usize;
        let at = |averages: usize| {
            let index = self.in_ring(self.oldest + (AVERAGES - averages) * length);
            self.steps.get(index).copied().map_or(0, i64::from)
        };
        // An average is the sum of the input less the input of `length` scans ago; here the latter, four
        // times. Sums of steps below 2^31 in 4 * 64 scans stay below 2^55.
        let mut sum = i64::from(step) - 4 * at(1) + 6 * at(2) - 4 * at(3) + at(4);
        if let Some(oldest) = self.steps.get_mut(self.oldest) {
            *oldest = step;
        }
        self.oldest = self.in_ring(self.oldest + 1);
        for total in &mut self.sums {
            *total = total.wrapping_add(sum);
            sum = *total;
        }
        let [o0, o1, o2, o3, o4, _] = self.out;
        self.out = [sum, o0, o1, o2, o3, o4];
        self.place += i128::from(sum);
    }

    /// A place in the ring of steps, for an `index` below twice its length.
    fn in_ring(&self, index: usize) -> usize {
        let ring = AVERAGES * self.length as usize;
        if index < ring { index } else { index - ring }
    }

    /// Whether the axis has not moved for as long as the filter remembers.
    fn is_still(&self) -> bool {
        self.still > 4 * self.length + OUTPUTS as u32
    }

    /// Whether it is no faster than an encoder at rest that trembles.
    fn trembles(&self) -> bool {
        i128::from(self.out[0]).abs() * TREMBLE <= self.scale()
    }

    /// Shifts the positions of this scan: the last step counts as 0.
    #[cold]
    fn rename(&mut self) {
        let (Some((told, fed)), Some((old, old_fed))) = (self.last, self.before) else {
            return;
        };
        let by = told.wrapping_sub(old);
        // The step that the dead band held back is added.
        let change = old.wrapping_sub(old_fed).wrapping_sub(fed.wrapping_sub(old_fed));
        let newest = self.in_ring(self.oldest + AVERAGES * self.length as usize - 1);
        if let Some(step) = self.steps.get_mut(newest) {
            *step = (i64::from(*step)).wrapping_add(change) as i32;
        }
        for total in &mut self.sums {
            *total = total.wrapping_add(change);
        }
        self.out[0] = self.out[0].wrapping_add(change);
        self.place += i128::from(change) + i128::from(by) * self.scale();
        self.last = Some((told, told));
        self.band = Band::at(told);
        self.still = 0;
    }

    /// The place of this scan, or of the one `before`.
    fn state(&self, before: bool, lead: bool) -> AtIncrement {
        let out = |back: usize| {
            let back = back + usize::from(before);
            self.out.get(back).copied().map_or(0, i128::from)
        };
        let place = if before {
            self.place - i128::from(self.out[0])
        } else {
            self.place
        };
        let scale = self.scale();
        // Averages and weights delay by (4 * length - 1) / 2 scans. The lead is the velocity times this delay. Here
        // everything is doubled.
        let (scale, place, step) = if lead {
            let delay = 4 * i128::from(self.length) - 1;
            let step = |back| 2 * out(back) + delay * (out(back) - out(back + 1));
            (
                2 * scale,
                2 * place + delay * out(0),
                [step(0), step(1), step(2), step(3)],
            )
        } else {
            (scale, place, [out(0), out(1), out(2), out(3)])
        };
        let [e0, e1, e2, e3] = step;
        let place = 24 * place - 23 * e0 - 12 * e1 - e2;
        // The scale is above 0.
        let whole = place.checked_div_euclid(24 * scale).unwrap_or(0);
        let rest = place - whole * (24 * scale);
        let part = |value: i128, of: i128| value as f64 / (of * scale) as f64;
        let state = State {
            ahead: part(rest, 24),
            rates: [
                part(e0 + 4 * e1 + e2, 6),
                part(e0 - e2, 2),
                part(e0 - 2 * e1 + e2, 1),
                part(e0 - 3 * e1 + 3 * e2 - e3, 1),
            ],
        };
        let whole = whole.clamp(i128::from(i64::MIN), i128::from(i64::MAX)) as i64;
        (whole, state)
    }
}

impl Told {
    fn new() -> Self {
        Self {
            places: [(0, 0.0); OUTPUTS + 1],
            is_new: true,
        }
    }

    fn take(&mut self, position: f64, turn: Option<f64>) {
        if core::mem::take(&mut self.is_new) {
            self.places = [(0, position); OUTPUTS + 1];
        }
        let (turns, last) = self.places[0];
        let half = turn.map_or(f64::INFINITY, |length| length / 2.0);
        let turns = if position - last > half {
            turns.wrapping_sub(1)
        } else if last - position > half {
            turns.wrapping_add(1)
        } else {
            turns
        };
        self.places.rotate_right(1);
        self.places[0] = (turns, position);
    }

    fn wait(&mut self) {
        self.places.rotate_right(1);
        self.places[0] = self.places[1];
    }

    /// Shifts positions: `old` (u) becomes `name` (u), or a turn more or less. All others become `by` (u) more.
    fn rename(&mut self, old: f64, name: f64, by: f64, turn: Option<f64>) {
        let round = turn.filter(|length| (old + by - name).abs() > length / 2.0);
        let back = round.map_or(0.0, |length| length.copysign(old + by - name));
        for (turns, position) in &mut self.places {
            *position = if *position == old {
                name
            } else {
                *position + (by - back)
            };
            if back != 0.0 {
                *turns = turns.wrapping_add(if back > 0.0 { 1 } else { -1 });
            }
        }
    }

    fn step(&self, back: usize, length: f64) -> f64 {
        let at = |back: usize| self.places.get(back).copied().unwrap_or_default();
        let ((turns, here), (turns_before, before)) = (at(back), at(back + 1));
        turns.wrapping_sub(turns_before) as f64 * length + (here - before)
    }

    fn is_still(&self) -> bool {
        let first = self.places[0];
        self.places.iter().all(|place| *place == first)
    }

    /// The latched place of this scan, or of the one `before`, and the weighted one relative to it.
    fn state(&self, before: bool, lead: bool, length: f64) -> ((i64, f64), State) {
        let first = usize::from(before);
        let raw = |back: usize| self.step(first + back, length);
        // The same as for averages of one scan.
        let step = |back: usize| {
            if lead {
                raw(back) + 1.5 * (raw(back) - raw(back + 1))
            } else {
                raw(back)
            }
        };
        let ahead = if lead { 1.5 * raw(0) } else { 0.0 };
        let [e0, e1, e2, e3] = [step(0), step(1), step(2), step(3)];
        let state = State {
            ahead: ahead - (23.0 * e0 + 12.0 * e1 + e2) / 24.0,
            rates: [
                (e0 + 4.0 * e1 + e2) / 6.0,
                (e0 - e2) / 2.0,
                (e0 - e1) - (e1 - e2),
                ((e0 - e1) - (e1 - e2)) - ((e1 - e2) - (e2 - e3)),
            ],
        };
        (self.places.get(first).copied().unwrap_or_default(), state)
    }
}

impl Measured {
    pub fn new(config: &AxisConfig) -> Self {
        let length = config.following.actual_filter;
        let counts = config.scaling.is_some();
        Self {
            counted: counts.then(|| Counted::new(length)),
            told: (!counts && length == 0).then(Told::new),
        }
    }

    /// Whether there are values to follow.
    #[inline]
    pub fn is_there(&self) -> bool {
        self.counted.is_some() || self.told.is_some()
    }

    /// Whether it has not moved for as long as the filter remembers.
    fn is_still(&self) -> bool {
        match (&self.counted, &self.told) {
            (Some(counted), _) => counted.is_still(),
            (None, Some(told)) => told.is_still(),
            (None, None) => true,
        }
    }

    /// Sets the last latched position to `name` (u), and shifts earlier ones by `by` (u), except for a `turn`.
    /// Increments are never shifted.
    pub fn call(&mut self, name: f64, by: f64, turn: Option<f64>) {
        if let Some(told) = &mut self.told {
            let (_, last) = told.places[0];
            told.rename(last, name, by, turn);
        }
    }

    /// Shifts the coordinates: from now on the position `old` (u) has the value `name` (u).
    pub fn shift(&mut self, old: f64, name: f64) {
        if let Some(told) = &mut self.told {
            told.rename(old, name, name - old, None);
        }
    }

    /// The drive reported shifted increments in this scan.
    pub fn rename(&mut self) {
        if let Some(counted) = &mut self.counted {
            counted.rename();
        }
    }
}

impl<P: Planner> Axis<P> {
    /// Whether its actual values can be followed: it counts increments, or its filter is off.
    pub(crate) fn is_measured(&self) -> bool {
        self.measured.is_there()
    }

    /// Takes this scan's position, after it was latched; none if there is no fresh one.
    ///
    /// Cost: some sums of integers in each scan, even if no axis follows.
    #[inline(never)]
    pub(super) fn measure_actual(&mut self, told: Option<DrivePosition>) {
        let turn = self.config.modulo;
        let position = self.feedback.position();
        let Measured { counted, told: units } = &mut self.measured;
        if let Some(counted) = counted {
            match told {
                Some(DrivePosition::Increments(increments)) => counted.take(increments),
                // A drive of the host that reports units, although its axis has a scaling.
                Some(DrivePosition::Units(units)) => {
                    let scaling = self.config.scaling;
                    counted.take(scaling.map_or(0, |scaling| scaling.to_increments(units)));
                }
                None => counted.wait(),
            }
        }
        if let Some(units) = units {
            match told {
                Some(_) => units.take(position, turn),
                None => units.wait(),
            }
        }
    }

    /// The actual values as slaves see them in this scan, or saw them in the one `before`, in present
    /// coordinates.
    pub(crate) fn seen_actual(&self, scan: u64, before: bool) -> Seen {
        let lead = self.config.following.actual_lead;
        let (length, cycle) = (self.config.modulo, self.planner.cycle());
        let ((turns, position), state, unit) = match (&self.measured.counted, &self.measured.told) {
            (Some(counted), _) => {
                let (whole, state) = counted.state(before, lead);
                (self.place_at_increment(whole), state, self.unit_of_increment())
            }
            (None, Some(told)) => {
                let (place, state) = told.state(before, lead, length.unwrap_or(0.0));
                (place, state, 1.0)
            }
            (None, None) => ((0, self.feedback.position()), State::AT_REST, 1.0),
        };
        let position = position + state.ahead * unit;
        let (turns, position) = match length {
            Some(length) => {
                let (further, position) = split(position, length);
                (turns.saturating_add(further), position)
            }
            None => (turns, position),
        };
        let [velocity, acceleration, jerk, snap] = state.rates;
        Seen {
            place: Place::new(turns, position),
            at: Setpoint {
                position,
                velocity: velocity * unit / cycle,
                acceleration: acceleration * unit / (cycle * cycle),
                jerk: jerk * unit / (cycle * cycle * cycle),
                snap: snap * unit / (cycle * cycle * cycle * cycle),
            },
            unshifted: None,
            moved: self.coordinates_moved(scan),
            is_operating: self.fresh_position().is_ok(),
            keeps_bound: false,
            trembles: self.measured.counted.as_ref().is_some_and(Counted::trembles),
            // Pieces of constant snap.
            degree: 4,
        }
    }

    /// Whether its actual values are constant.
    pub(crate) fn is_measured_still(&self) -> bool {
        self.measured.is_still()
    }

    /// Scans of its filter.
    pub(crate) fn filter_scans(&self) -> u32 {
        self.config.following.actual_filter
    }

    /// Turns and position (u) at this number of increments.
    fn place_at_increment(&self, increments: i64) -> (i64, f64) {
        let told = DrivePosition::Increments(increments);
        match &self.modulo {
            Some(modulo) => modulo.place_of(&self.config, told, self.frame.shift()),
            None => (0, self.position_at_increment(increments)),
        }
    }

    /// The length of an increment (u), with its sign.
    fn unit_of_increment(&self) -> f64 {
        let unit = |scaling: Scaling| {
            let unit = f64::from(scaling.units()) / f64::from(scaling.increments());
            if scaling.invert() { -unit } else { unit }
        };
        self.config.scaling.map_or(1.0, unit)
    }
}

impl State {
    const AT_REST: Self = Self {
        ahead: 0.0,
        rates: [0.0; 4],
    };
}

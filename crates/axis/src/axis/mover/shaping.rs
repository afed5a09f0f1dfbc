//! Moves without vibration: the published set-point is a weighted mean of the present set-point of the motion and
//! past ones.
//!
//! The motion is planned, kept within limits and changed as on any axis. All of that concerns the set-point of the
//! [`Mover`] before the shaper. The published set-point is that set-point plus its lag. So when another motion takes
//! over, the rest of the earlier motion comes out of the shaper first, and the published set-point keeps every limit
//! that the motion keeps. A command is done when the shaper holds nothing of it any more.
//!
//! The past is kept in memory that the host lends with every [`Scope`](crate::Scope). [`Mover::history_needed`]
//! places of it belong to this axis alone.
//!
//! Derivation: docs/planner.md, section 15.

use super::{Motion, Mover};
use crate::ConfigError;
use crate::axis::guard::RESOLVED;
use standstill_planner::shaper::{LONGEST_PERIOD, MODES};
use standstill_planner::{Plan, Setpoint, Shaper, Shapers, VibrationMode};

/// The shaper of an axis and its state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shaping {
    shapers: Shapers,
    /// Past set-points for each shaper: of the motion, and of the output of the shaper before.
    rings: [Ring; MODES],
    /// The first place of its part of the lent memory.
    first: usize,
    /// The difference of the published set-point from that of the motion.
    lag: Setpoint,
    /// The last known position (u) of the motion, in the coordinates of that time.
    seen: f64,
    /// The shift of coordinates since the last set-point was kept (u).
    moved: f64,
    /// The number of scans in which the motion was even; see [`even_scans`].
    even: u32,
    /// The position of the axis before the first kept set-point (u).
    origin: f64,
    /// The number of set-points kept since.
    kept: u32,
}

/// A part of the memory, used as a ring.
#[derive(Clone, Copy, Debug, Default)]
struct Ring {
    /// Its first place, counted from the first one of the axis.
    first: usize,
    places: usize,
    newest: usize,
}

impl Ring {
    fn part<'a>(&self, history: &'a mut [Setpoint]) -> &'a mut [Setpoint] {
        let end = self.first.saturating_add(self.places);
        history.get_mut(self.first..end).unwrap_or_default()
    }

    fn push(&mut self, history: &mut [Setpoint], setpoint: Setpoint) {
        let next = self.newest.wrapping_add(1);
        self.newest = if next < self.places { next } else { 0 };
        if let Some(place) = self.part(history).get_mut(self.newest) {
            *place = setpoint;
        }
    }

    /// The set-point that was pushed this number of scans ago.
    fn past(&self, history: &[Setpoint], scans: u32) -> Option<Setpoint> {
        let scans = scans as usize;
        let back = self.newest.checked_sub(scans);
        let place = back.or_else(|| (self.newest + self.places).checked_sub(scans))?;
        history.get(self.first.checked_add(place)?).copied()
    }
}

/// The number of scans in a row in which a motion was even: it kept its velocity, with all higher derivatives 0; at
/// rest it also kept its position. There were `before` such scans, and the motion goes from `here` to `next`. Its
/// positions were at most `coarsest` (u).
pub(in crate::axis) fn even_scans(before: u32, here: &Setpoint, next: &Setpoint, coarsest: f64) -> u32 {
    let has_more = next.acceleration != 0.0 || next.jerk != 0.0 || next.snap != 0.0;
    // A short motion may begin and end within a scan.
    let resolved = RESOLVED * (here.position.abs() + next.position.abs() + coarsest);
    let has_moved = next.velocity == 0.0 && (next.position - here.position).abs() > resolved;
    if next.velocity != here.velocity || has_more || has_moved {
        0
    } else {
        before.saturating_add(1)
    }
}

/// The number of set-points to keep for a mode. It is enough for any shaper and down to half of the frequency.
fn places(mode: &VibrationMode, cycle: f64) -> usize {
    let slower = 1.0 - mode.damping * mode.damping;
    let period = 1.0 / (mode.frequency * cycle * slower);
    (2.0 * period).min(LONGEST_PERIOD) as usize + 4
}

impl Shaping {
    /// A shaper for these modes, at rest at `position` (u); none if there are no modes.
    ///
    /// # Errors
    /// [`ConfigError::Vibration`] names the mode.
    pub fn new(
        modes: &[Option<VibrationMode>; MODES],
        cycle: f64,
        position: f64,
    ) -> Result<Option<Self>, ConfigError> {
        let shapers =
            Shapers::new(modes, cycle).map_err(|(place, error)| ConfigError::Vibration { place, error })?;
        if shapers.delay() == 0 {
            return Ok(None);
        }
        let mut rings = [Ring::default(); MODES];
        let mut first = 0;
        for (ring, mode) in rings.iter_mut().zip(modes.iter().flatten()) {
            let places = places(mode, cycle);
            *ring = Ring {
                first,
                places,
                newest: 0,
            };
            first += places;
        }
        Ok(Some(Self {
            shapers,
            rings,
            first: 0,
            lag: Setpoint::default(),
            seen: position,
            moved: 0.0,
            even: u32::MAX,
            origin: position,
            kept: 0,
        }))
    }

    fn places(&self) -> usize {
        self.rings.iter().map(|ring| ring.places).sum()
    }

    /// Whether the motion was even for the whole delay of the shaper, so that nothing else is left in it.
    fn is_through(&self) -> bool {
        self.even >= self.shapers.delay()
    }

    /// The motion goes from `here` to `next`. If `here` is not the last known position, coordinates have moved.
    fn step(&mut self, here: &Setpoint, next: &Setpoint, coarsest: f64) {
        self.moved += here.position - self.seen;
        self.seen = next.position;
        self.even = even_scans(self.even, here, next, coarsest);
    }

    /// At rest at `position` (u), without any past motion.
    fn rest(&mut self, position: f64) {
        self.lag = Setpoint::default();
        self.seen = position;
        self.moved = 0.0;
        self.even = u32::MAX;
        self.origin = position;
        self.kept = 0;
    }

    /// Computes the lag of the set-point `now` of the motion.
    ///
    /// Cost: one set-point for each part of the shapers; if coordinates moved in motion, one for each kept set-point.
    fn shape(&mut self, history: &mut [Setpoint], now: Setpoint) {
        let by = self.moved + (now.position - self.seen);
        self.moved = 0.0;
        self.seen = now.position;
        let end = self.first.saturating_add(self.places());
        let history = history.get_mut(self.first..end).unwrap_or_default();
        if by != 0.0 {
            self.origin += by;
            for setpoint in history.iter_mut() {
                setpoint.position += by;
            }
        }
        self.kept = self.kept.saturating_add(1);
        let (kept, before) = (self.kept, Setpoint::at_rest(self.origin));
        self.lag = Setpoint::default();
        for (ring, shaper) in self.rings.iter_mut().zip(self.shapers.iter()) {
            let now = now.plus(&self.lag);
            ring.push(history, now);
            let past = |delay: u32| {
                let kept = ring.past(history, delay).filter(|_| delay < kept);
                kept.unwrap_or(before)
            };
            self.lag = self.lag.plus(&shaper.lag(&now, past));
        }
    }
}

impl<P: Plan> Mover<P> {
    /// Set-points of the past that its shaper needs; 0 without one.
    pub fn history_needed(&self) -> usize {
        self.shaping.as_ref().map_or(0, Shaping::places)
    }

    /// Its part of the lent memory begins at this place.
    pub fn set_history(&mut self, first: usize) {
        if let Some(shaping) = &mut self.shaping {
            shaping.first = first;
        }
    }

    /// Whether there is a shaper between its motion and its drive.
    #[inline(always)]
    pub fn is_shaped(&self) -> bool {
        self.is_shaped
    }

    /// Whether no change of the motion is left in the shaper: the axis is at rest, or has a constant velocity.
    // For an axis without a shaper this is a test of one flag, inlined. Everything else is outside.
    #[inline(always)]
    pub fn is_through(&self) -> bool {
        !self.is_shaped || self.has_come_out()
    }

    #[cold]
    #[inline(never)]
    fn has_come_out(&self) -> bool {
        // A set-point that follows the feedback is not shaped.
        let follows = matches!(self.motion, Motion::Follow);
        follows || self.shaping.as_ref().is_none_or(Shaping::is_through)
    }

    /// The same for the motion without the superimposed one.
    #[inline(always)]
    pub fn is_base_through(&self) -> bool {
        !self.is_shaped || self.base_has_come_out()
    }

    #[cold]
    #[inline(never)]
    fn base_has_come_out(&self) -> bool {
        match &self.layer {
            Some(layer) => u64::from(layer.even()) >= self.shaping_delay(),
            None => self.has_come_out(),
        }
    }

    /// The number of scans in which the motion was even; see [`even_scans`].
    pub fn even(&self) -> u32 {
        self.shaping.as_ref().map_or(u32::MAX, |shaping| shaping.even)
    }

    /// Scans after which a set-point of the motion has come out of the shaper completely.
    #[inline]
    pub fn shaping_delay(&self) -> u64 {
        self.shaping
            .as_ref()
            .map_or(0, |shaping| shaping.shapers.delay().into())
    }

    /// The set-point for the drive, in the frame of the motion.
    #[inline(always)]
    pub fn commanded(&self) -> Setpoint {
        if !self.is_shaped {
            return self.setpoint;
        }
        self.shaped()
    }

    #[cold]
    #[inline(never)]
    fn shaped(&self) -> Setpoint {
        let lag = self
            .shaping
            .as_ref()
            .map_or(Setpoint::default(), |shaping| shaping.lag);
        self.setpoint.plus(&lag)
    }

    /// The next set-point of the motion is about to be published.
    #[cold]
    #[inline(never)]
    pub(super) fn pass_to_shaper(&mut self, next: &Setpoint) {
        if let Some(shaping) = &mut self.shaping {
            shaping.step(&self.setpoint, next, self.coarsest);
        }
    }

    /// The end of a motion step: computes the published set-point. The past is kept in `history`.
    #[inline(always)]
    pub fn shape(&mut self, history: &mut [Setpoint]) {
        if self.is_shaped {
            self.shape_setpoint(history);
        }
    }

    #[inline(never)]
    fn shape_setpoint(&mut self, history: &mut [Setpoint]) {
        let now = self.setpoint;
        let is_led = !matches!(self.motion, Motion::Follow);
        let Some(shaping) = &mut self.shaping else { return };
        let rests = now.is_at_rest() && shaping.even > shaping.shapers.delay();
        if is_led && !rests {
            shaping.shape(history, now);
        } else {
            shaping.rest(now.position);
        }
    }

    /// Changes the modes of the shaper. The axis is at rest, and the shaper holds no motion.
    pub fn set_shapers(&mut self, shapers: Shapers) {
        let position = self.setpoint.position;
        if let Some(shaping) = &mut self.shaping {
            shaping.shapers = shapers;
            // A longer shaper would use set-points of the motion before.
            shaping.rest(position);
        }
    }

    /// Whether the memory for the past is large enough for these shapers.
    pub fn has_history_for(&self, shapers: &Shapers) -> bool {
        let rings = self.shaping.iter().flat_map(|shaping| &shaping.rings);
        let fits = |(ring, shaper): (&Ring, &Shaper)| (shaper.delay() as usize) < ring.places;
        rings.zip(shapers.iter()).all(fits)
    }
}

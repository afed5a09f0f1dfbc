//! Cams: which tracks are on at a position.
//!
//! Positions are sampled once per scan. With a compensation time t, an edge at E is reached when `position -
//! velocity * t` equals E, so a negative t looks ahead. The path between two samples is known, so no edge is missed
//! at any speed.
//!
//! Source: PLCopen Motion Control Part 1, MC_DigitalCamSwitch; T39 h.

use standstill_axis::{CamTrack, ErrorId, split};
use standstill_fb::{Int, Time, record};

/// Tracks are numbered from 1 to this, one for each output.
pub const TRACKS: usize = 32;

/// The largest number of switches of an instance.
pub const SWITCHES: usize = 32;

const NS: f64 = 1e-9;

record! {
    /// A cam on a track.
    pub struct CamSwitch = "MC_CAMSWITCH_REF" {
        /// The track, from 1 to 32; the cams of one track are ORed.
        TrackNumber => track_number: Int, "";
        /// Lower end of the cam, included. On a modulo axis it may be above the upper end: the cam then passes the
        /// end of the modulo range. In time mode it is the position that switches on.
        FirstOnPosition => first_on: f64, "u";
        /// Upper end of the cam, included; not used in time mode.
        LastOnPosition => last_on: f64, "u";
        /// Direction in which the cam works: 0 both, 1 positive, 2 negative.
        AxisDirection => axis_direction: Int, "";
        /// 0: on between the positions. 1: on for Duration.
        CamSwitchMode => mode: Int, "";
        /// How long the cam is on in time mode.
        Duration => duration: Time, "";
    }
}

record! {
    /// Settings of a whole track.
    pub struct TrackOption = "MC_TRACK_REF" {
        /// Time by which the track switches on later; negative: earlier.
        OnCompensation => on_compensation: Time, "";
        /// Time by which the track switches off later; negative: earlier.
        OffCompensation => off_compensation: Time, "";
        /// Distance from the last switching point within which the track does not switch again.
        Hysteresis => hysteresis: f64, "u";
    }
}

/// An invalid field: its name, the value, the limit and the error.
pub type Refusal = (&'static str, f64, f64, ErrorId);

/// Checks all switches and tracks for an axis whose turn has the length `turn` (u).
///
/// # Errors
/// The first [`Refusal`]; switches are checked before tracks.
pub fn check(switches: &[CamSwitch], tracks: &[TrackOption], turn: Option<f64>) -> Result<(), Refusal> {
    for switch in switches {
        check_switch(switch, turn)?;
    }
    for track in tracks {
        let hysteresis = track.hysteresis;
        if !(hysteresis.is_finite() && hysteresis >= 0.0) {
            return Err(("Hysteresis", hysteresis, 0.0, ErrorId::CamTrackInvalid));
        }
    }
    Ok(())
}

fn check_switch(switch: &CamSwitch, turn: Option<f64>) -> Result<(), Refusal> {
    let number = |name, value: Int, least: Int, most: Int, error| {
        if (least..=most).contains(&value) {
            Ok(())
        } else {
            let limit = if value < least { least } else { most };
            Err((name, f64::from(value), f64::from(limit), error))
        }
    };
    let (track, bad) = (ErrorId::CamTrackInvalid, ErrorId::CamSwitchInvalid);
    number("TrackNumber", switch.track_number, 1, TRACKS as Int, track)?;
    number("AxisDirection", switch.axis_direction, 0, 2, bad)?;
    number("CamSwitchMode", switch.mode, 0, 1, bad)?;
    let place = |name, position: f64| {
        let outside = turn.filter(|turn| !(0.0..*turn).contains(&position));
        if position.is_finite() && outside.is_none() {
            Ok(())
        } else {
            Err((name, position, outside.unwrap_or(f64::NAN), bad))
        }
    };
    place("FirstOnPosition", switch.first_on)?;
    if switch.mode == 1 {
        return if switch.duration > Time(0) {
            Ok(())
        } else {
            Err(("Duration", switch.duration.0 as f64 * NS, 0.0, bad))
        };
    }
    place("LastOnPosition", switch.last_on)?;
    if switch.last_on < switch.first_on && turn.is_none() {
        return Err(("LastOnPosition", switch.last_on, switch.first_on, bad));
    }
    Ok(())
}

/// The axis in one scan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Time (ns).
    pub now_ns: i64,
    /// Position (u); on a modulo axis within the first turn.
    pub position: f64,
    /// Velocity (u/s).
    pub velocity: f64,
    /// Length of a turn (u) of a modulo axis.
    pub turn: Option<f64>,
    /// Position and velocity are those of the set-point, which are exact.
    pub is_set: bool,
    /// Changes whenever the coordinates are moved.
    pub coordinates: u32,
    /// By how much all moves of the coordinates together have moved positions (u).
    pub moved: f64,
}

impl Sample {
    /// Distance (u) from `from` forward to `to`. On a modulo axis it is at least 0 and less than a turn.
    fn ahead(&self, from: f64, to: f64) -> f64 {
        match self.turn {
            Some(turn) => split(to - from, turn).1,
            None => to - from,
        }
    }

    /// Distance (u) between two positions; on a modulo axis the shorter one.
    fn distance(&self, one: f64, other: f64) -> f64 {
        let ahead = self.ahead(one, other);
        match self.turn {
            Some(turn) => ahead.min(turn - ahead),
            None => ahead.abs(),
        }
    }

    /// The sample `before` in the coordinates of this one.
    fn in_these_coordinates(&self, before: Self) -> Self {
        Self {
            position: before.position + (self.moved - before.moved),
            coordinates: self.coordinates,
            moved: self.moved,
            ..before
        }
    }

    /// The signed distance (u) since `before`, which has the same coordinates. On a modulo axis several distances fit
    /// the positions; this is the one nearest to the prediction from the velocities.
    fn way_since(&self, before: &Self) -> f64 {
        let way = self.position - before.position;
        let Some(turn) = self.turn else { return way };
        let time = (self.now_ns.saturating_sub(before.now_ns)) as f64 * NS;
        let expected = 0.5 * (self.velocity + before.velocity) * time;
        let turns = (expected - way) / turn;
        // Whole turns are added to the difference of the positions. So an axis at rest shows no motion by rounding.
        let whole = (if turns < 0.0 { turns - 0.5 } else { turns + 0.5 }) as i64;
        way + whole as f64 * turn
    }
}

/// The memory of an instance for its tracks.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cams {
    before: Option<Sample>,
    /// Whether the last motion was in positive direction; `None` before the first motion.
    forward: Option<bool>,
    /// Whether the coordinates were moved since the scan before.
    is_renamed: bool,
}

impl Cams {
    /// The tracks that are on now, one bit each. Tracks outside `mask` are not changed.
    ///
    /// `switches` and `options` must have passed [`check`]. `tracks` is the memory of the outputs. Cost:
    /// about 60 operations for each switch.
    pub fn scan(
        &mut self,
        switches: &[CamSwitch],
        options: &[TrackOption],
        mask: u32,
        tracks: &mut [CamTrack],
        now: &Sample,
    ) -> u32 {
        let known = self.before.replace(*now);
        let is_renamed = known.is_some_and(|before| before.coordinates != now.coordinates);
        let was_renamed = core::mem::replace(&mut self.is_renamed, is_renamed);
        let before = now.in_these_coordinates(known.unwrap_or(*now));
        let is_still = now.velocity == 0.0 && before.velocity == 0.0;
        let way = if is_renamed && is_still {
            0.0
        } else {
            now.way_since(&before)
        };
        let heading = if now.velocity != 0.0 { now.velocity } else { way };
        // After a new name positions differ by rounding, which is no motion.
        let is_certain = now.is_set && now.velocity != 0.0;
        if heading != 0.0 && (is_certain || !(was_renamed || is_renamed)) {
            self.forward = Some(heading > 0.0);
        }
        let motion = Motion {
            now,
            before: &before,
            way,
            forward: self.forward,
        };
        let mut bits = 0;
        for (index, track) in tracks.iter_mut().enumerate().take(TRACKS) {
            let bit = 1_u32 << index;
            if mask & bit == 0 {
                continue;
            }
            if known.is_none() || is_renamed {
                // The coordinates were moved, or the axis is another, so the old switching points mean nothing.
                (track.point, track.held_at) = (None, None);
            }
            let option = options.get(index).copied().unwrap_or_default();
            let of_track = |switch: &CamSwitch| usize::try_from(switch.track_number).ok() == Some(index + 1);
            let mut wanted = None;
            motion.lets_go(&option, track);
            for (place, switch) in switches.iter().enumerate().filter(|(_, switch)| of_track(switch)) {
                if switch.mode == 1 {
                    motion.times(switch, &option, track);
                } else {
                    let cam = motion.cam(switch, &option);
                    if cam.on && wanted.is_none() {
                        wanted = Some((place, cam));
                    }
                    if track.on && track.by == place {
                        track.leave = cam.leave;
                    }
                }
            }
            follow(track, wanted, option.hysteresis, &motion);
            track.until = track.until.filter(|until| now.now_ns < *until);
            if track.on || track.until.is_some() {
                bits |= bit;
            }
        }
        bits
    }
}

/// A cam in position mode, in one scan.
#[derive(Clone, Copy)]
struct Cam {
    on: bool,
    /// Where it switches on and off in the present direction (u).
    enter: f64,
    leave: f64,
}

/// How the axis moved in this scan.
struct Motion<'a> {
    now: &'a Sample,
    before: &'a Sample,
    /// Since then (u), signed.
    way: f64,
    forward: Option<bool>,
}

impl Motion<'_> {
    fn works(&self, switch: &CamSwitch) -> bool {
        match switch.axis_direction {
            1 => self.forward == Some(true),
            2 => self.forward == Some(false),
            _ => true,
        }
    }

    /// Whether the axis passed or reached `edge` (u), which is shifted by `compensation`, in this scan.
    /// Leaving the edge does not count.
    fn meets(&self, edge: f64, compensation: Time) -> bool {
        let time = compensation.0 as f64 * NS;
        let from = self.before.position - self.before.velocity * time;
        let way = self.way - (self.now.velocity - self.before.velocity) * time;
        // While the axis slows down, the position ahead may move back. That is no crossing.
        if self.forward != Some(way > 0.0) {
            return false;
        }
        let ahead = if way > 0.0 {
            self.now.ahead(from, edge)
        } else {
            self.now.ahead(edge, from)
        };
        // An edge at the starting point was already passed.
        ahead > 0.0 && ahead <= way.abs()
    }

    fn cam(&self, switch: &CamSwitch, option: &TrackOption) -> Cam {
        let now = self.now;
        let (on, off) = (option.on_compensation, option.off_compensation);
        let shift = |compensation: Time| now.velocity * (compensation.0 as f64 * NS);
        let backward = self.forward == Some(false);
        let (lower, upper) = if backward {
            (shift(off), shift(on))
        } else {
            (shift(on), shift(off))
        };
        let (first, last) = (switch.first_on + lower, switch.last_on + upper);
        let length = match now.turn {
            Some(turn) if switch.first_on > switch.last_on => {
                (switch.last_on - switch.first_on + turn) + (upper - lower)
            }
            _ => (switch.last_on - switch.first_on) + (upper - lower),
        };
        let behind = now.ahead(first, now.position);
        let inside = match now.turn {
            Some(_) => behind <= length,
            None => first <= now.position && now.position <= last,
        };
        let (enter, leave, edge) = if backward {
            (last, first, switch.last_on)
        } else {
            (first, last, switch.first_on)
        };
        // A cam that lies wholly within the distance of this scan is on for this scan.
        let passed = || length >= 0.0 && self.meets(edge, on);
        Cam {
            on: self.works(switch) && (inside || passed()),
            enter,
            leave,
        }
    }

    /// Whether the axis has left the position that switched the track on by time, so that the track may switch on
    /// again.
    fn lets_go(&self, option: &TrackOption, track: &mut CamTrack) {
        let near = |at: &f64| self.now.distance(self.now.position, *at) < option.hysteresis;
        track.held_at = track.held_at.filter(near);
    }

    /// A switch in time mode puts its track on.
    fn times(&self, switch: &CamSwitch, option: &TrackOption, track: &mut CamTrack) {
        let (on, off) = (option.on_compensation, option.off_compensation);
        let edge = switch.first_on;
        let held = |at: f64| self.now.distance(edge, at) < option.hysteresis;
        if self.works(switch) && !track.held_at.is_some_and(held) && self.meets(edge, on) {
            let length = switch.duration.0.saturating_add(off.0).saturating_sub(on.0);
            let until = self.now.now_ns.saturating_add(length);
            track.until = Some(track.until.map_or(until, |other| other.max(until)));
            track.held_at = Some(edge);
        }
    }
}

/// Switches the track as the cams demand, unless this is too close to its last switching point.
fn follow(track: &mut CamTrack, wanted: Option<(usize, Cam)>, hysteresis: f64, motion: &Motion<'_>) {
    let now = motion.now;
    let near = |point: f64| now.distance(now.position, point) < hysteresis;
    if wanted.is_some() == track.on || track.point.is_some_and(near) {
        return;
    }
    let edge = wanted.map_or(track.leave, |(_, cam)| cam.enter);
    // If no edge was passed in this scan, the axis reversed inside a cam, and the edge is not the switching point.
    let passed = now.distance(now.position, edge) <= motion.way.abs();
    track.point = Some(if passed { edge } else { now.position });
    track.on = wanted.is_some();
    if let Some((by, cam)) = wanted {
        (track.by, track.leave) = (by, cam.leave);
    }
}

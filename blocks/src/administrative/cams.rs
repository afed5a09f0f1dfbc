//! Cams: which tracks are on at a position.
//!
//! Positions are those of one instant a scan. With a compensation time t an edge at E is met where
//! `position - velocity * t` is E: a negative t looks ahead. Between two instants the way is known, so an edge that was
//! passed is seen however fast the axis goes.
//!
//! Source: PLCopen Motion Control Part 1, MC_DigitalCamSwitch; T39 h.

use standstill_axis::{CamTrack, ErrorId, split};
use standstill_fb::{Int, Time, record};

/// Tracks are numbered from 1 to this, one for each output.
pub const TRACKS: usize = 32;

/// Most switches of an instance.
pub const SWITCHES: usize = 32;

const NS: f64 = 1e-9;

record! {
    /// A cam on a track.
    pub struct CamSwitch = "MC_CAMSWITCH_REF" {
        /// The track, from 1 to 32; the cams of one track are ORed.
        TrackNumber => track_number: Int, "";
        /// Lower end of the cam, included. On a modulo axis it may be above the upper one: the cam then lies over the
        /// end of the turn. In time mode the position that switches on.
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
    /// What is set for a track as a whole.
    pub struct TrackOption = "MC_TRACK_REF" {
        /// Time by which the track switches on later; negative: earlier.
        OnCompensation => on_compensation: Time, "";
        /// Time by which the track switches off later; negative: earlier.
        OffCompensation => off_compensation: Time, "";
        /// Distance from the last switching point below which the track does not switch again.
        Hysteresis => hysteresis: f64, "u";
    }
}

/// A field that is no good: its name, the value, the limit and the error.
pub type Refusal = (&'static str, f64, f64, ErrorId);

/// Whether all switches and tracks can be worked with on an axis whose turns have the length `turn` (u).
///
/// # Errors
/// The first [`Refusal`], switches before tracks.
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

/// Where the axis is in a scan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sample {
    /// Time (ns).
    pub now_ns: i64,
    /// Position (u), on a modulo axis in the first turn.
    pub position: f64,
    /// Velocity (u/s).
    pub velocity: f64,
    /// Length of a turn (u), of a modulo axis.
    pub turn: Option<f64>,
    /// Changes whenever coordinates move: positions before and after have nothing in common.
    pub coordinates: u32,
}

impl Sample {
    /// Distance (u) from `from` ahead to `to`; on a modulo axis from 0 to below a turn.
    fn ahead(&self, from: f64, to: f64) -> f64 {
        match self.turn {
            Some(turn) => split(to - from, turn).1,
            None => to - from,
        }
    }

    /// Distance (u) between two places, the shorter way round.
    fn distance(&self, one: f64, other: f64) -> f64 {
        let ahead = self.ahead(one, other);
        match self.turn {
            Some(turn) => ahead.min(turn - ahead),
            None => ahead.abs(),
        }
    }

    /// The way (u) since `before`, signed: of those that fit the positions the one nearest to what the velocities say.
    fn way_since(&self, before: &Self) -> f64 {
        let way = self.position - before.position;
        let Some(turn) = self.turn else { return way };
        let time = (self.now_ns.saturating_sub(before.now_ns)) as f64 * NS;
        let expected = 0.5 * (self.velocity + before.velocity) * time;
        let ahead = split(way - expected, turn).1;
        expected + if ahead > 0.5 * turn { ahead - turn } else { ahead }
    }
}

/// What an instance remembers of all its tracks together.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cams {
    before: Option<Sample>,
    /// The last motion was in positive direction; none before the first.
    forward: Option<bool>,
}

impl Cams {
    /// The tracks that are on now, a bit each; those not in `mask` are left alone.
    ///
    /// `switches` and `options` have passed [`check`]; `tracks` is what the outputs remember. Cost: some 60 operations
    /// for each switch.
    pub fn scan(
        &mut self,
        switches: &[CamSwitch],
        options: &[TrackOption],
        mask: u32,
        tracks: &mut [CamTrack],
        now: &Sample,
    ) -> u32 {
        let before = self.before.replace(*now);
        let comparable = before.filter(|before| before.coordinates == now.coordinates);
        let way = comparable.map_or(0.0, |before| now.way_since(&before));
        let heading = if now.velocity != 0.0 { now.velocity } else { way };
        if heading != 0.0 {
            self.forward = Some(heading > 0.0);
        }
        let motion = Motion {
            now,
            before: &comparable.unwrap_or(*now),
            way,
            forward: self.forward,
        };
        let mut bits = 0;
        for (index, track) in tracks.iter_mut().enumerate().take(TRACKS) {
            let bit = 1_u32 << index;
            if mask & bit == 0 {
                continue;
            }
            if comparable.is_none() {
                // Switching points lie in coordinates that are gone.
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

/// How the axis came to where it is.
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

    /// Whether `edge` (u), which comes `compensation` later, was met in this scan: passed or reached, not left.
    fn meets(&self, edge: f64, compensation: Time) -> bool {
        let time = compensation.0 as f64 * NS;
        let from = self.before.position - self.before.velocity * time;
        let way = self.way - (self.now.velocity - self.before.velocity) * time;
        // While the axis slows down, what looks ahead may go back; that meets nothing.
        if self.forward != Some(way > 0.0) {
            return false;
        }
        let ahead = if way > 0.0 {
            self.now.ahead(from, edge)
        } else {
            self.now.ahead(edge, from)
        };
        // Where it stood already it was met before.
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
        // A cam that lies wholly within the way of this scan is on for this scan.
        let passed = || length >= 0.0 && self.meets(edge, on);
        Cam {
            on: self.works(switch) && (inside || passed()),
            enter,
            leave,
        }
    }

    /// The position that put the track on by time is behind: it may do so again.
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

/// Switches as the cams want, unless that would be too near to where the track switched last.
fn follow(track: &mut CamTrack, wanted: Option<(usize, Cam)>, hysteresis: f64, motion: &Motion<'_>) {
    let now = motion.now;
    let near = |point: f64| now.distance(now.position, point) < hysteresis;
    if wanted.is_some() == track.on || track.point.is_some_and(near) {
        return;
    }
    let edge = wanted.map_or(track.leave, |(_, cam)| cam.enter);
    // An edge that was not passed just now is not what switched: the axis turned round inside a cam.
    let passed = now.distance(now.position, edge) <= motion.way.abs();
    track.point = Some(if passed { edge } else { now.position });
    track.on = wanted.is_some();
    if let Some((by, cam)) = wanted {
        (track.by, track.leave) = (by, cam.leave);
    }
}

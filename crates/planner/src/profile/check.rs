//! Whether a stretch keeps the limits, and how far it moves. Control points decide; if they do not, the
//! stretch is halved.

use super::ProfileCause;
use super::curve::Curve;
use crate::Limits;

/// Largest number of halvings of a stretch before it is decided.
const DEPTH: u32 = 12;

/// Largest number of pieces of a stretch that are checked.
const PIECES: u32 = 64;

/// Rounding, relative to a limit.
const ROUNDING: f64 = 1e-9;

/// A stretch or a part of one, as control points of the position and of each derivative. Each is halved
/// separately: the derivatives of a short part of a curve are lost in the rounding of its positions.
#[derive(Clone, Copy)]
struct Piece {
    from: f64,
    position: [f64; 8],
    velocity: [f64; 7],
    acceleration: [f64; 6],
    jerk: [f64; 5],
    snap: [f64; 4],
}

impl Piece {
    fn of(curve: &Curve) -> Self {
        let (velocity, acceleration, jerk, snap) = curve.derivatives();
        Self {
            from: curve.from,
            position: curve.points,
            velocity,
            acceleration,
            jerk,
            snap,
        }
    }

    /// Whether all its numbers are finite.
    fn is_finite(&self) -> bool {
        let lower = self.position.iter().chain(&self.velocity);
        let all = lower
            .chain(&self.acceleration)
            .chain(&self.jerk)
            .chain(&self.snap);
        all.copied().all(f64::is_finite)
    }

    fn halves(&self) -> (Self, Self) {
        let (position, velocity, acceleration) = (
            halved(self.position),
            halved(self.velocity),
            halved(self.acceleration),
        );
        let (jerk, snap) = (halved(self.jerk), halved(self.snap));
        let part = |position, velocity, acceleration, jerk, snap| Self {
            from: self.from,
            position,
            velocity,
            acceleration,
            jerk,
            snap,
        };
        (
            part(position.0, velocity.0, acceleration.0, jerk.0, snap.0),
            part(position.1, velocity.1, acceleration.1, jerk.1, snap.1),
        )
    }
}

/// The control points of both halves.
pub(crate) fn halved<const N: usize>(points: [f64; N]) -> ([f64; N], [f64; N]) {
    cut(points, |left, right| 0.5 * (left + right))
}

/// The control points of the two parts of a curve. `between` gives the value at the cut between two
/// values (de Casteljau).
pub(crate) fn cut<const N: usize>(
    points: [f64; N],
    between: impl Fn(f64, f64) -> f64,
) -> ([f64; N], [f64; N]) {
    let (mut row, mut before, mut after) = (points, [0.0; N], [0.0; N]);
    let slots = before.iter_mut().zip(after.iter_mut().rev());
    for (level, (first, last)) in slots.enumerate() {
        *first = row.first().copied().unwrap_or_default();
        *last = row.get(N - 1 - level).copied().unwrap_or_default();
        let mut next = row;
        for (slot, (left, right)) in next.iter_mut().zip(row.iter().zip(row.iter().skip(1))) {
            *slot = between(*left, *right);
        }
        row = next;
    }
    (before, after)
}

/// Pieces that are still to be checked: while one half is halved again, the other half waits.
struct Pieces {
    waiting: [Option<(Piece, u32)>; DEPTH as usize + 1],
    count: usize,
    left: u32,
}

impl Pieces {
    fn of(curve: &Curve) -> Self {
        let mut pieces = Self {
            waiting: [None; DEPTH as usize + 1],
            count: 0,
            left: PIECES,
        };
        pieces.push(Piece::of(curve), 0);
        pieces
    }

    fn push(&mut self, piece: Piece, depth: u32) {
        if let Some(slot) = self.waiting.get_mut(self.count) {
            *slot = Some((piece, depth));
            self.count += 1;
        }
    }

    /// The next piece, and whether it may be halved.
    fn next(&mut self) -> Option<(Piece, u32, bool)> {
        self.count = self.count.checked_sub(1)?;
        let (piece, depth) = self.waiting.get_mut(self.count)?.take()?;
        let further = depth < DEPTH && self.left > 0;
        Some((piece, depth, further))
    }

    fn halve(&mut self, piece: &Piece, depth: u32) {
        self.left = self.left.saturating_sub(1);
        let (before, after) = piece.halves();
        self.push(after, depth + 1);
        self.push(before, depth + 1);
    }
}

/// Smallest and largest.
pub(crate) fn hull<const N: usize>(points: &[f64; N]) -> (f64, f64) {
    let first = points.first().copied().unwrap_or_default();
    points.iter().fold((first, first), |(least, most), point| {
        (
            if *point < least { *point } else { least },
            if *point > most { *point } else { most },
        )
    })
}

/// A limit that the values between `least` and `most` break, with the value furthest out.
fn broken(
    cause: ProfileCause,
    (least, most): (f64, f64),
    (down, up): (f64, f64),
) -> Option<(ProfileCause, f64, f64)> {
    if most > up + ROUNDING * up.abs() {
        Some((cause, most, up))
    } else if least < down - ROUNDING * down.abs() {
        Some((cause, least, down))
    } else {
        None
    }
}

/// The limit that a piece may break, as far as its control points show.
fn first_broken(
    piece: &Piece,
    limits: &Limits,
    range: Option<(f64, f64)>,
) -> Option<(ProfileCause, f64, f64)> {
    let both = |limit: f64| (-limit, limit);
    let speeds = hull(&piece.velocity);
    if let Some((min, max)) = range {
        let (least, most) = hull(&piece.position);
        let places = (least + piece.from, most + piece.from);
        // A stretch that begins outside may come inside, as a move may.
        let bounds = (min.min(piece.from), max.max(piece.from));
        if let Some(found) = broken(ProfileCause::Position, places, bounds) {
            return Some(found);
        }
        // .. and must not leave again once it is inside.
        let still = ROUNDING * limits.velocity;
        let leading_out = (
            if speeds.0 < -still { places.0 } else { min },
            if speeds.1 > still { places.1 } else { max },
        );
        if let Some(found) = broken(ProfileCause::Position, leading_out, (min, max)) {
            return Some(found);
        }
    }
    broken(ProfileCause::Velocity, speeds, both(limits.velocity))
        .or_else(|| broken_rate(speeds, hull(&piece.acceleration), limits))
        .or_else(|| broken(ProfileCause::Jerk, hull(&piece.jerk), both(limits.jerk)))
        .or_else(|| broken(ProfileCause::Snap, hull(&piece.snap), both(limits.snap)))
}

/// Acceleration and deceleration: the sign of the velocity decides which applies in which direction.
fn broken_rate(speeds: (f64, f64), rates: (f64, f64), limits: &Limits) -> Option<(ProfileCause, f64, f64)> {
    let (faster, slower) = (limits.acceleration, limits.deceleration);
    let (least, most) = speeds;
    let (upwards, downwards) = if least >= 0.0 {
        (faster, slower)
    } else if most <= 0.0 {
        (slower, faster)
    } else {
        (faster.min(slower), faster.min(slower))
    };
    let cause = |limit: f64| {
        if limit == faster {
            ProfileCause::Acceleration
        } else {
            ProfileCause::Deceleration
        }
    };
    let up = broken(cause(upwards), (0.0, rates.1), (0.0, upwards));
    up.or_else(|| broken(cause(downwards), (rates.0, 0.0), (-downwards, 0.0)))
}

/// Whether a stretch keeps `limits` and stays inside `range` (u, counted as its positions are).
///
/// Each halving brings a curve four times nearer to its control points. A piece that is undecided after
/// [`DEPTH`] halvings counts as outside the limits. Bounded by [`PIECES`].
///
/// # Errors
/// The limit it breaks, the value and the limit.
pub(super) fn check(
    curve: &Curve,
    limits: &Limits,
    range: Option<(f64, f64)>,
) -> Result<(), (ProfileCause, f64, f64)> {
    let mut pieces = Pieces::of(curve);
    if !Piece::of(curve).is_finite() {
        return Err((ProfileCause::Velocity, f64::INFINITY, limits.velocity));
    }
    // Each piece that is not halved ends a branch, so there is at most one more than halvings.
    for _ in 0..=2 * PIECES {
        let Some((piece, depth, further)) = pieces.next() else {
            break;
        };
        match first_broken(&piece, limits, range) {
            None => {}
            Some(_) if further => pieces.halve(&piece, depth),
            Some(broken) => return Err(broken),
        }
    }
    Ok(())
}

/// Instants of a stretch that are searched for a value that breaks a limit.
const LOOKS: u32 = 32;

/// The value furthest out that `cause` refers to, for the message; `found` if the curve has none.
#[cold]
pub(super) fn peak(curve: &Curve, cause: ProfileCause, found: f64) -> f64 {
    let mut peak = found;
    for look in 0..=LOOKS {
        let state = curve.at(curve.time * (f64::from(look) / f64::from(LOOKS)));
        let value = match cause {
            ProfileCause::Velocity => state.velocity,
            ProfileCause::Acceleration | ProfileCause::Deceleration => state.acceleration,
            ProfileCause::Jerk => state.jerk,
            ProfileCause::Snap => state.snap,
            _ => found,
        };
        // On the same side, so that it breaks the same limit.
        if value / found > peak / found {
            peak = value;
        }
    }
    peak
}

/// The distances (u) of a stretch upwards and downwards. Pieces in which it may turn count by their ends.
pub(super) fn ways(curve: &Curve) -> (f64, f64) {
    let mut pieces = Pieces::of(curve);
    let (mut up, mut down) = (0.0, 0.0);
    for _ in 0..=2 * PIECES {
        let Some((piece, depth, further)) = pieces.next() else {
            break;
        };
        let (least, most) = hull(&piece.velocity);
        let [begin, .., end] = piece.position;
        let way = end - begin;
        if least < 0.0 && most > 0.0 && further {
            pieces.halve(&piece, depth);
        } else if way > 0.0 {
            up += way;
        } else {
            down -= way;
        }
    }
    (up, down)
}

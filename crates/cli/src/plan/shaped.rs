//! `vibration` on a line: the plan of any method from rest to rest, shaped so that a load on a spring does not
//! vibrate at its end.

use crate::json::number;
use crate::plan::fields::{Fields, first_motion};
use crate::plan::methods::Planned;
use crate::plan::refusal::{Code, Refusal};
use crate::plan::samples::Setpoints;
use crate::plan::shared::cycle;
use standstill_planner::papers::peaks;
use standstill_planner::shaper::{DAMPING_MAX, LONGEST_PERIOD, MODES, SHORTEST_PERIOD};
use standstill_planner::{
    Field, Order, PlanError, Segment, Shaper, ShaperKind, Shapers, VibrationMode, grid,
};

/// Largest number of steps to make the stretches of a shaped plan: their number times the parts of the shapers.
const STEPS_MAX: usize = 200_000_000;

/// Two begins of stretches that are no further apart than this (scans) count as one.
const SAME: f64 = 1e-9;

/// The field.
pub const NAME: &str = "vibration";

/// The plan that the line requests: shaped if it has modes.
pub fn shaped(fields: &Fields<'_>, planned: Planned) -> Result<Planned, Refusal> {
    let cycle = cycle(fields)?;
    let modes = modes(fields, cycle)?;
    if modes.iter().all(Option::is_none) {
        return Ok(planned);
    }
    let shapers = Shapers::new(&modes, cycle).map_err(|(_, error)| Refusal::of_plan_error(fields, error))?;
    let (start, end) = (planned.setpoints.at(0), planned.end);
    if let Some((field, value)) = first_motion(&start, end.velocity, end.acceleration) {
        let field = field.name();
        let message = format!("`{NAME}` is for moves from rest to rest: `{field}` must be 0");
        return Err(fields.invalid(field, message).value(&number(value)));
    }
    if planned.scans == 0 {
        return Ok(planned);
    }
    let segments = segments(fields, &planned.segments, cycle, &shapers)?;
    let largest = peaks(Order::Four, segments.iter().copied());
    let scans = shapers.scans(planned.scans);
    Ok(Planned {
        duration: planned.duration + f64::from(shapers.delay()) * cycle,
        scans,
        peak: grid::Peaks {
            velocity: largest.velocity,
            acceleration: largest.acceleration,
            jerk: planned.peak.jerk.map(|_| largest.jerk),
            snap: planned.peak.snap.map(|_| largest.snap),
        },
        segments,
        // They belong to another motion.
        boxes: None,
        counts: None,
        setpoints: Setpoints::Shaped(Box::new(planned.setpoints), shapers),
        ..planned
    })
}

/// The modes of a line.
fn modes(fields: &Fields<'_>, cycle: f64) -> Result<[Option<VibrationMode>; MODES], Refusal> {
    let mut modes = [None; MODES];
    let given = fields.list(NAME, ["frequency", "damping", "shaper"].into_iter())?;
    if given.len() > MODES {
        let message = format!("`{NAME}` has {} modes: there is room for {MODES}", given.len());
        return Err(fields.invalid(NAME, message));
    }
    for (place, (slot, given)) in modes.iter_mut().zip(&given).enumerate() {
        let mode = mode(given).and_then(|mode| {
            // Made separately, so that a refusal is about this one.
            Shaper::new(&mode, cycle).map_err(|error| refuse(given, error))?;
            Ok(mode)
        });
        *slot = Some(mode.map_err(|refusal| refusal.inside(NAME, place))?);
    }
    Ok(modes)
}

/// A mode of a line.
fn mode(given: &Fields<'_>) -> Result<VibrationMode, Refusal> {
    let default = VibrationMode::new(given.required("frequency")?);
    let shaper = match given.string("shaper")? {
        None => default.shaper,
        Some(name) => {
            let known = ShaperKind::ALL.into_iter().find(|kind| kind.name() == name);
            known.ok_or_else(|| {
                let names = ShaperKind::ALL
                    .map(|kind| format!("`{}`", kind.name()))
                    .join(", ");
                given.invalid("shaper", format!("there is no such shaper; there are {names}"))
            })?
        }
    };
    Ok(VibrationMode {
        damping: given.number("damping")?.unwrap_or(default.damping),
        shaper,
        ..default
    })
}

/// The reason why a mode can't be shaped.
fn refuse(given: &Fields<'_>, error: PlanError) -> Refusal {
    let (name, nearest) = match error {
        PlanError::OutOfRange {
            field: Field::Damping,
            nearest,
            ..
        } => ("damping", Some(nearest)),
        PlanError::OutOfRange { nearest, .. } => ("frequency", Some(nearest)),
        _ => ("frequency", None),
    };
    let range = match (name, nearest) {
        ("damping", _) => format!("from 0 to {DAMPING_MAX}"),
        (_, None) => "above 0".to_owned(),
        (_, Some(_)) => format!("such that a period takes from {SHORTEST_PERIOD} to {LONGEST_PERIOD} cycles"),
    };
    let message = format!("`{name}` must be {range}");
    given.invalid(name, message).nearest(nearest.map(number))
}

/// The delays of all parts of the mean, each with its weight. The part without delay is included.
fn parts(shapers: &Shapers) -> Vec<(u32, f64)> {
    let mut weights = vec![1.0];
    for shaper in shapers.iter() {
        let late: Vec<_> = shaper.taps().collect();
        let present = 1.0 - late.iter().map(|tap| tap.weight).sum::<f64>();
        let mut next = vec![0.0; weights.len() + shaper.delay() as usize];
        for (delay, weight) in
            std::iter::once((0, present)).chain(late.iter().map(|tap| (tap.delay, tap.weight)))
        {
            for (place, before) in next.iter_mut().skip(delay as usize).zip(&weights) {
                *place += weight * before;
            }
        }
        weights = next;
    }
    (0..).zip(weights).filter(|(_, weight)| *weight > 0.0).collect()
}

/// The stretches of constant snap of a shaped plan. A new one begins at every begin of a stretch of any part.
fn segments(
    fields: &Fields<'_>,
    plain: &[Segment],
    cycle: f64,
    shapers: &Shapers,
) -> Result<Vec<Segment>, Refusal> {
    let parts = parts(shapers);
    // In scans from the start, so that those of a grid plan are whole.
    let mut begins = vec![0.0];
    let mut time = 0.0;
    for segment in plain {
        time += segment.duration;
        begins.push(whole(time / cycle));
    }
    let mut times: Vec<f64> = parts
        .iter()
        .flat_map(|(delay, _)| begins.iter().map(|begin| begin + f64::from(*delay)))
        .collect();
    times.sort_by(f64::total_cmp);
    times.dedup_by(|next, last| *next - *last <= SAME);
    if times.len().saturating_mul(parts.len()) > STEPS_MAX {
        let message = format!(
            "the plan has {} stretches of {} parts, more than a line can tell: take a shaper of fewer parts, such as `ei`, or a longer `Ts`",
            times.len(),
            parts.len()
        );
        return Err(Refusal::of_field(Code::TooLong, fields, NAME, message));
    }
    let stretch = |pair: &[f64]| {
        let (begin, end) = (pair[0], pair[1]);
        let mut sum = Segment {
            duration: (end - begin) * cycle,
            velocity: 0.0,
            acceleration: 0.0,
            jerk: 0.0,
            snap: 0.0,
        };
        for (delay, weight) in &parts {
            let middle = 0.5 * (begin + end) - f64::from(*delay);
            let place = begins.partition_point(|begun| *begun <= middle);
            let before = place.checked_sub(1);
            let (Some(segment), Some(begun)) = (
                before.and_then(|place| plain.get(place)),
                before.and_then(|place| begins.get(place)),
            ) else {
                continue;
            };
            let [v, a, j, s] = [segment.velocity, segment.acceleration, segment.jerk, segment.snap];
            let t = (begin - f64::from(*delay) - begun).max(0.0) * cycle;
            sum.velocity += weight * (v + t * (a + t * (j / 2.0 + t * s / 6.0)));
            sum.acceleration += weight * (a + t * (j + t * s / 2.0));
            sum.jerk += weight * (j + t * s);
            sum.snap += weight * s;
        }
        sum
    };
    Ok(times.windows(2).map(stretch).collect())
}

/// Rounds a number of scans that is whole except for rounding.
fn whole(scans: f64) -> f64 {
    let nearest = scans.round();
    if (scans - nearest).abs() <= SAME * nearest.max(1.0) {
        nearest
    } else {
        scans
    }
}

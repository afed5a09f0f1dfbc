//! Whether a slave can follow a cam, and how fast its master may be: the results of MC_CamTableSelect.

use super::curve::Curve;
use super::table::{CamError, CamTable, law_name};
use crate::model::Axis;
use standstill_axis::{
    AxisId, CamBounds, CamCurve, CamFit, CamSelection, ErrorId, Limits, Log, Scope, Standard,
};

/// The cycle of axes that are not run (s): no property of a cam depends on it.
const CYCLE: f64 = 1e-3;

/// Samples of a stretch in the search for its worst position.
const LOOKS: u32 = 256;

/// Values this close, relative to their size, are equal; the first one is reported.
const SAME: f64 = 1e-9;

/// Steps towards the worst position from the best sample.
const STEPS: u32 = 48;

/// The axes that a cam is checked against.
#[derive(Clone, Copy, Debug)]
pub struct Asked<'a> {
    /// The slave.
    pub slave: &'a Axis,
    /// The master, up to whose velocity limit the slave must follow.
    pub master: Option<&'a Axis>,
    /// The cam continues with its first row after its last one.
    pub periodic: bool,
    /// Positions of the slave are those of the axis.
    pub slave_absolute: bool,
}

/// The limit of a slave that bounds the velocity of its master.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Limiting {
    /// By the slope.
    Velocity,
    /// By the curvature.
    Acceleration,
    /// By the third derivative.
    Jerk,
    /// By the fourth.
    Snap,
}

impl Limiting {
    /// All, by order of the derivative.
    pub const ALL: [Self; 4] = [Self::Velocity, Self::Acceleration, Self::Jerk, Self::Snap];

    /// The name of the limit.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
            Self::Snap => "snap",
        }
    }

    /// These limits without the others.
    fn alone(self, limits: &Limits) -> Limits {
        let none = Limits::NONE;
        match self {
            Self::Velocity => Limits {
                velocity: limits.velocity,
                ..none
            },
            Self::Acceleration => Limits {
                acceleration: limits.acceleration,
                deceleration: limits.deceleration,
                ..none
            },
            Self::Jerk => Limits {
                jerk: limits.jerk,
                ..none
            },
            Self::Snap => Limits {
                snap: limits.snap,
                ..none
            },
        }
    }
}

/// A stretch of a cam, from one row to the next.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    /// Positions of the master (u).
    pub ends: (f64, f64),
    /// IEC name of its law.
    pub law: &'static str,
    /// The bounds of its derivatives.
    pub bounds: CamBounds,
    /// The highest constant velocity of the master on it (u/s).
    pub highest: f64,
    /// The deciding limit, the position of the master where the derivative is largest, and its value there. None
    /// for a stretch that does not move the slave.
    pub worst: Option<(Limiting, f64, f64)>,
}

/// A fault that keeps a slave from following the cam.
#[derive(Clone, Debug)]
pub struct Finding {
    /// The error of MC_CamTableSelect; none if it accepts the cam.
    pub error: Option<ErrorId>,
    /// The row, from 1, if there is one to name.
    pub row: Option<usize>,
    /// The line of that row.
    pub line: Option<usize>,
    /// The fault, with its place.
    pub message: String,
    /// The value.
    pub value: f64,
    /// The largest permitted value, or the exceeded limit.
    pub limit: f64,
    /// The remedy.
    pub remedy: String,
}

/// The result of checking a cam against its axes.
#[derive(Clone, Debug)]
pub struct Fit {
    /// The cam.
    pub curve: Curve,
    /// The number of derivatives that the slave needs to be continuous.
    pub needed: usize,
    /// The number of continuous derivatives, at the rows where the slave needs them.
    pub continuity: usize,
    /// The rows, from 1, at which the slave comes to rest because a derivative jumps that its limits do not permit
    /// to jump.
    pub stops_at: Vec<usize>,
    /// Whether all positions are inside the software limits of the slave, if it has some.
    pub inside: bool,
    /// The highest constant velocity of the master (u/s): MaxMasterVelocity.
    pub highest: f64,
    /// One for each stretch from row to row.
    pub stretches: Vec<Stretch>,
    /// The faults; a cam without findings can be followed.
    pub findings: Vec<Finding>,
    /// The error that MC_CamTableSelect would show.
    pub refused: Option<ErrorId>,
}

/// Checks a cam against its axes.
///
/// # Errors
/// [`CamError`] if the rows make no cam. A cam that can't be followed is no error; it has
/// [`Fit::findings`].
pub fn fit(table: &CamTable, asked: Asked<'_>) -> Result<Fit, CamError> {
    let curve = Curve::new(table, asked.periodic)?;
    let axis = standstill_axis::Axis::new(AxisId::default(), asked.slave.config, Standard::new(CYCLE));
    let axis = axis.map_err(|error| CamError::Table {
        place: asked.slave.name.clone(),
        message: error.to_string(),
        help: "correct the axis".to_owned(),
    })?;
    let head = &curve.head;
    let fits = axis.fit_of_cam(head);
    let selection = CamSelection {
        periodic: asked.periodic,
        slave_absolute: asked.slave_absolute,
        ..CamSelection::default()
    };
    let velocity = asked.master.map_or(0.0, |master| master.config.limits.velocity);
    let mut log = Log::default();
    let refused = axis
        .check_cam(head, &selection, velocity, &mut Scope::new(0, &mut log))
        .err();
    let mut findings = Vec::new();
    findings.extend(rough(table, &curve, &fits, asked));
    if asked.slave_absolute {
        findings.extend(outside(table, &fits, asked));
    }
    findings.extend(slower(table, &fits, asked, refused));
    let stretches = table.laws.iter().enumerate().take(curve.pieces().len());
    let stretches = stretches
        .map(|(index, law)| stretch(&curve, index, *law, &fits.limits))
        .collect();
    Ok(Fit {
        needed: fits.needed,
        continuity: fits.smooth.continuity.into(),
        stops_at: if refused == Some(ErrorId::CamNotSmooth) {
            Vec::new()
        } else {
            curve.corners(fits.limits_need)
        },
        inside: fits.outside.is_none(),
        highest: fits.highest,
        stretches,
        findings,
        refused,
        curve,
    })
}

/// A derivative jumps that must be continuous.
fn rough(table: &CamTable, curve: &Curve, fits: &CamFit, asked: Asked<'_>) -> Option<Finding> {
    let head = &curve.head;
    let continuity = usize::from(fits.smooth.continuity);
    if continuity >= fits.needed {
        return None;
    }
    let (row, jump) = fits.smooth.jump;
    let what = CamFit::DERIVATIVES.get(continuity)?;
    let name = &asked.slave.name;
    let why = match (asked.slave.config.following.cam_continuity, fits.needed) {
        (Some(_), _) => format!("{name} has a cam_continuity"),
        (None, 3) => format!("{name} has a snap limit"),
        (None, 2) => format!("{name} has a jerk limit"),
        (None, _) => format!("corners would take {name} an endless acceleration"),
    };
    let is_end = !head.periodic && (row == 1 || row == table.rows.len());
    let remedy = if is_end {
        "without periods the slave rests before the first row and behind the last: begin and end so that nothing jumps there, as \
         mcCamRest7 and mcCamThrough do, or, if the cam goes on behind its last row as at its first, select it with Periodic \
         (`--periodic`)"
    } else if head.periodic && row == 1 {
        "row 1 is also where the last row goes on: give both the same slope, curvature and third derivative"
    } else {
        "use mcCamThrough, which estimates smooth derivatives, mcCamRest7 where the slave rests, or mcCamPoly7 with the derivatives \
         of the stretch before"
    };
    Some(Finding {
        error: Some(ErrorId::CamNotSmooth),
        row: Some(row),
        line: table.line(row),
        message: format!(
            "{}: `{what}` jumps by {jump:?}, where {why} and takes no jump of it: continuity {continuity}, needed {}",
            table.place(row),
            fits.needed
        ),
        value: jump,
        limit: 0.0,
        remedy: remedy.to_owned(),
    })
}

/// The cam leaves the software limits of the slave.
fn outside(table: &CamTable, fits: &CamFit, asked: Asked<'_>) -> Option<Finding> {
    let (place, limit, error) = fits.outside?;
    let side = if place > limit { "upper" } else { "lower" };
    Some(Finding {
        error: Some(error),
        row: None,
        line: None,
        message: format!(
            "{}: the slave goes to {place:?}, beyond the {side} software limit {limit:?} of {}",
            table.name, asked.slave.name
        ),
        value: place,
        limit,
        remedy: "move or lower the cam, or, if it is selected without SlaveAbsolute, say `--relative`"
            .to_owned(),
    })
}

/// The master may be faster than the cam allows.
fn slower(table: &CamTable, fits: &CamFit, asked: Asked<'_>, refused: Option<ErrorId>) -> Option<Finding> {
    let master = asked.master?;
    let velocity = master.config.limits.velocity;
    if fits.highest >= velocity {
        return None;
    }
    let highest = fits.highest;
    Some(Finding {
        error: refused.filter(|error| *error == ErrorId::CamBeyondLimits),
        row: None,
        line: None,
        message: format!(
            "{}: the master {} may go {velocity:?}, and {} follows up to {highest:?}",
            table.name, master.name, asked.slave.name
        ),
        value: velocity,
        limit: highest,
        remedy: format!(
            "keep the master below it, stretch the cam, raise the limits of {}, or leave out `--master`",
            asked.slave.name
        ),
    })
}

fn stretch(curve: &Curve, index: usize, law: CamCurve, limits: &Limits) -> Stretch {
    let piece = curve.pieces().get(index);
    let bounds = piece.map(|piece| *piece.bounds()).unwrap_or_default();
    let ends = curve.ends_of(index);
    let speeds = Limiting::ALL.map(|limiting| (limiting, bounds.highest_velocity(&limiting.alone(limits))));
    let least = speeds
        .into_iter()
        .filter(|(_, speed)| speed.is_finite())
        .min_by(|one, other| one.1.total_cmp(&other.1));
    Stretch {
        ends,
        law: law_name(law),
        bounds,
        highest: bounds.highest_velocity(limits),
        worst: least.map(|(limiting, _)| {
            let (place, value) = largest(curve, ends, limiting as usize + 1);
            (limiting, place, value)
        }),
    }
}

/// The position of the largest magnitude of a derivative of this order in a stretch, and its value there.
fn largest(curve: &Curve, (from, to): (f64, f64), order: usize) -> (f64, f64) {
    let last = to.next_down();
    let value = |place: f64| {
        curve
            .at(place.clamp(from, last))
            .get(order)
            .copied()
            .unwrap_or_default()
    };
    let look = |step: u32| from + (to - from) * (f64::from(step) / f64::from(LOOKS));
    let mut best = 0;
    for step in 1..=LOOKS {
        if value(look(step)).abs() > value(look(best)).abs() * (1.0 + SAME) {
            best = step;
        }
    }
    let (mut low, mut high) = (look(best.saturating_sub(1)), look((best + 1).min(LOOKS)));
    for _ in 0..STEPS {
        let (left, right) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if value(left).abs() >= value(right).abs() {
            high = right;
        } else {
            low = left;
        }
    }
    let place = 0.5 * (low + high);
    let looked = look(best);
    // For a peak at an end, or a constant value, the first sample counts.
    if value(place).abs() > value(looked).abs() * (1.0 + SAME) {
        (place, value(place))
    } else {
        (looked, value(looked))
    }
}

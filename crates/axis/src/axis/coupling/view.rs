//! The values of its master that a slave may use in its motion step: its place, its last place, and its
//! plan. Nothing else.

use super::super::modulo::Modulo;
use super::super::{Axis, Motion};
use standstill_planner::{Anchor, Lead, Leads, Limits, Place, Plan, Planner, Setpoint};

/// A master at the end of a motion step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Seen {
    pub place: Place,
    /// Its derivatives; the position is that of `place`.
    pub at: Setpoint,
    /// Its own velocity (u/s) and acceleration (u/s^2), if it is seen with a shift.
    pub unshifted: Option<[f64; 2]>,
    /// The shift of its coordinates in this scan (u).
    pub moved: f64,
    /// Its set-point is the result of a plan.
    pub is_operating: bool,
    /// The smoothness of its motions: 2, 3 or 4.
    pub degree: usize,
    /// Its motion was planned within the limits that its slaves leave.
    pub keeps_bound: bool,
    /// Its feedback may be that of an axis at rest with an encoder that trembles.
    pub trembles: bool,
}

/// The masters of a slave as it sees them; a second one only if it has two.
pub(crate) type SeenBoth = [Seen; 2];

/// The law that applies if the masters are as `seen` and the slave is at this place.
pub(super) fn anchor_at(seen: &SeenBoth, slave: Place) -> Anchor {
    Anchor {
        master: seen[0].place,
        second: seen[1].place,
        slave,
    }
}

/// The masters in their slave's motion step, after their own step.
#[derive(Clone, Copy)]
pub(crate) struct View<'a, Plan> {
    /// The first master, or the only one.
    pub now: Seen,
    /// The length of its turn (u), if it has turns.
    pub turn: Option<f64>,
    /// The second master of two.
    pub second: Option<Seen>,
    pub future: Future<'a, Plan>,
}

/// The known future motion of the masters.
#[derive(Clone, Copy)]
pub(crate) struct Future<'a, Plan> {
    /// For each master; the second is empty if there is none.
    pub parts: [Part<'a, Plan>; 2],
    /// It applies from the end of this scan: the step of a master in this scan had another source.
    pub is_new: bool,
}

/// The known future motion of a master.
#[derive(Clone, Copy)]
pub(crate) struct Part<'a, Plan> {
    /// The axis that has the plan: the master, or the first axis of a chain in gear.
    pub root: usize,
    /// The factor from the derivatives of the plan to those of the master.
    pub factor: f64,
    pub course: Course<'a, Plan>,
}

impl<Plan> Part<'_, Plan> {
    /// For a master that does not exist.
    pub(crate) const NONE: Self = Self {
        root: usize::MAX,
        factor: 0.0,
        course: Course::Still,
    };
}

/// The future motion of an axis.
#[derive(Clone, Copy)]
pub(crate) enum Course<'a, Plan> {
    /// It is at rest.
    Still,
    /// This plan, at this number of scans after its start.
    Plan(&'a Plan, u64),
    /// Not known: more than one plan at once, or a curve.
    Unknown,
    /// Measured values: the motion is not known and its velocity is never quite constant. The way onto the law is
    /// searched again after this number of scans.
    Measured(u64),
}

/// Scans after which the way is searched again while the master's future motion is not known.
pub(super) const UNKNOWN: u64 = 16;

/// The source of the set-points of an axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) enum Source {
    /// Nothing moves it.
    #[default]
    None,
    /// A plan of its own.
    Plan,
    /// The law of its gear.
    Gear,
    /// More than one plan at once, or the feedback.
    Other,
}

/// The kind of a course.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::axis) enum Kind {
    #[default]
    NotSeen,
    Still,
    Plan,
    Unknown,
    Measured,
}

/// The data of the masters' future motions that a slave keeps to detect a change.
pub(super) type Known = [KnownPart; 2];

/// The data of one master.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct KnownPart {
    pub root: usize,
    factor: f64,
    pub kind: Kind,
    pub elapsed: u64,
    /// Position and velocity at the end of the plan.
    end: (f64, f64),
}

impl KnownPart {
    /// Whether the future motion was known.
    pub(super) const fn is_foreseen(&self) -> bool {
        matches!(self.kind, Kind::Still | Kind::Plan)
    }
}

impl<'a, P: Plan> Part<'a, P> {
    /// The known motion now, and whether it continues the motion `known` in the last scan.
    fn compare(&self, known: &KnownPart) -> (KnownPart, bool) {
        let (kind, elapsed, end) = match self.course {
            Course::Still => (Kind::Still, 0, (0.0, 0.0)),
            // A plan in progress is recognized by its scans. Only a plan that has just begun could be
            // mistaken for another.
            Course::Plan(_, elapsed) if elapsed > 1 => (Kind::Plan, elapsed, known.end),
            Course::Plan(plan, elapsed) => {
                let end = plan.end();
                (Kind::Plan, elapsed, (end.position, end.velocity))
            }
            Course::Unknown => (Kind::Unknown, 0, (0.0, 0.0)),
            Course::Measured(_) => (Kind::Measured, 0, (0.0, 0.0)),
        };
        let now = KnownPart {
            root: self.root,
            factor: self.factor,
            kind,
            elapsed,
            end,
        };
        let expected = KnownPart {
            elapsed: if kind == Kind::Plan {
                known.elapsed.wrapping_add(1)
            } else {
                0
            },
            ..*known
        };
        (now, now == expected)
    }
}

/// The distance (u of the slave) that the masters still lead it, from this number of `scans` after the leads begin.
/// `None` if one of them does not come to rest.
pub(in crate::axis) fn way_to_rest<Q: Plan>(leads: &Leads<'_, Q>, scans: u64) -> Option<f64> {
    leads.iter().flatten().try_fold(0.0, |way, lead| {
        let end = lead.plan.end();
        let here = lead.plan.at(lead.elapsed.saturating_add(scans)).position;
        (end.velocity == 0.0).then_some(way + lead.factor * (end.position - here))
    })
}

impl<'a, P: Plan> Future<'a, P> {
    /// The present data of the masters, and whether their motion continues the one `known` from the scan before.
    fn compare(&self, known: &Known) -> (Known, bool) {
        let [first, second] = &self.parts;
        let (first, goes_on) = first.compare(&known[0]);
        let (second, second_goes_on) = second.compare(&known[1]);
        ([first, second], goes_on && second_goes_on)
    }

    /// Notes the known motion and the limits of the slave. Returns whether the motion or a limit has changed since
    /// the last scan. Unless the slave is locked, also returns TRUE when the scans until the next search are over.
    pub(super) fn is_new_to(
        &self,
        (known, left, held): (&mut Known, &mut u64, &mut Limits),
        limits: &Limits,
        is_locked: bool,
    ) -> bool {
        let (now, goes_on) = self.compare(known);
        *known = now;
        let is_over = *left == 0;
        if *left != u64::MAX {
            *left = left.saturating_sub(1);
        }
        let is_lowered = *held != *limits;
        *held = *limits;
        !goes_on || is_lowered || (is_over && !is_locked)
    }

    /// The kind of course that the masters have together.
    pub(in crate::axis) fn kind(&self) -> Kind {
        let kind = |part: &Part<'_, P>| match part.course {
            Course::Still => Kind::Still,
            Course::Plan(..) => Kind::Plan,
            Course::Unknown => Kind::Unknown,
            Course::Measured(_) => Kind::Measured,
        };
        match [kind(&self.parts[0]), kind(&self.parts[1])] {
            [Kind::Unknown, _] | [_, Kind::Unknown] => Kind::Unknown,
            [Kind::Measured, _] | [_, Kind::Measured] => Kind::Measured,
            [Kind::Plan, _] | [_, Kind::Plan] => Kind::Plan,
            _ => Kind::Still,
        }
    }

    /// If the values of the masters are measured: the number of scans after which the way onto their law
    /// is searched again.
    pub(super) fn measured(&self) -> Option<u64> {
        let scans = |part: &Part<'_, P>| match part.course {
            Course::Measured(scans) => Some(scans),
            Course::Still | Course::Plan(..) | Course::Unknown => None,
        };
        let scans = self.parts.iter().filter_map(scans).max();
        scans.filter(|_| self.kind() == Kind::Measured)
    }

    /// If the motion of a master is not known: the number of scans after which the way onto the law is
    /// searched again.
    pub(super) fn unforeseen(&self) -> Option<u64> {
        let scans = |part: &Part<'_, P>| match part.course {
            Course::Measured(scans) => Some(scans),
            Course::Unknown => Some(UNKNOWN),
            Course::Still | Course::Plan(..) => None,
        };
        self.parts.iter().filter_map(scans).max()
    }

    /// Whether it has a plan that was not used for the master's step in this scan.
    pub(in crate::axis) fn is_late(&self) -> bool {
        let plans = self.parts.iter().map(|part| &part.course);
        let is_late = |course: &Course<'_, P>| match course {
            Course::Plan(_, elapsed) => self.is_new || *elapsed == 0,
            Course::Still | Course::Unknown | Course::Measured(_) => false,
        };
        self.kind() == Kind::Plan && plans.into_iter().any(is_late)
    }

    /// The plans of the masters from the end of the last scan, or from the end of this one if they are
    /// late. Each has the factor that `geared` returns for it, and its number. Masters at rest, or with a
    /// ratio of 0, are omitted.
    pub(super) fn leads(&self, geared: impl Fn(usize, f64) -> f64) -> Option<Leads<'a, P>> {
        let is_late = self.is_late();
        let mut leads = [None; 2];
        for (leg, (lead, part)) in leads.iter_mut().zip(&self.parts).enumerate() {
            let Course::Plan(plan, elapsed) = part.course else {
                continue;
            };
            let factor = geared(leg, part.factor);
            *lead = (factor != 0.0).then_some(Lead {
                plan,
                elapsed: if is_late {
                    elapsed
                } else {
                    elapsed.saturating_sub(1)
                },
                factor,
            });
        }
        (self.kind() == Kind::Plan).then_some(leads)
    }

    /// The plan of the first master from the end of the last scan: the scans since its start, and the
    /// number of scans by which it begins later. That number is 1 for a plan that was not used for the
    /// master's step in this scan.
    pub(super) fn plan(&self) -> Option<(&'a P, u64, u64)> {
        match self.parts[0].course {
            Course::Plan(plan, elapsed) if self.is_new => Some((plan, elapsed, 1)),
            Course::Plan(plan, 0) => Some((plan, 0, 1)),
            Course::Plan(plan, elapsed) => Some((plan, elapsed - 1, 0)),
            Course::Still | Course::Unknown | Course::Measured(_) => None,
        }
    }
}

impl<Plan> View<'_, Plan> {
    /// Both masters as they are now.
    pub(super) fn seen(&self) -> SeenBoth {
        [self.now, self.second.unwrap_or_default()]
    }

    /// All masters are in operation.
    pub(super) fn is_operating(&self) -> bool {
        self.now.is_operating && self.second.is_none_or(|seen| seen.is_operating)
    }

    /// Whether the motions of all masters were planned within the limits that their slaves leave.
    pub(super) fn keeps_bound(&self) -> bool {
        self.now.keeps_bound && self.second.is_none_or(|seen| seen.keeps_bound)
    }

    /// Whether all masters may be at rest with encoders that tremble.
    pub(super) fn trembles(&self) -> bool {
        self.now.trembles && self.second.is_none_or(|seen| seen.trembles)
    }

    /// The smoothness of the masters' motions: 2, 3 or 4.
    pub(super) fn degree(&self) -> usize {
        let second = self.second.map_or(usize::MAX, |seen| seen.degree);
        self.now.degree.min(second)
    }
}

impl<P: Planner> Axis<P> {
    /// Its place: whole turns, and the position that programs see.
    #[inline(always)]
    pub(crate) fn place(&self) -> Place {
        match &self.modulo {
            None => Place::new(0, self.mover.setpoint().position),
            Some(modulo) => self.place_round(modulo),
        }
    }

    #[inline(never)]
    fn place_round(&self, modulo: &Modulo) -> Place {
        let shown = modulo.in_turn(self.mover.setpoint().position);
        let further = (self.mover.setpoint().position - shown) / modulo.length;
        let nearest = if further < 0.0 {
            further - 0.5
        } else {
            further + 0.5
        };
        Place::new(modulo.turns().saturating_add(nearest as i64), shown)
    }

    /// Before its step in this scan: the place that its slaves remember.
    pub(crate) fn seen_before(&self, scan: u64) -> Seen {
        let place = self.place();
        Seen {
            place,
            at: self.mover.setpoint().moved_to(place.position),
            moved: self.coordinates_moved(scan),
            ..Seen::default()
        }
    }

    /// The axis as its slaves see it.
    pub(crate) fn seen(&self, scan: u64) -> Seen {
        Seen {
            is_operating: self.is_operating(),
            degree: self.slowed(&self.config.limits).order().degree(),
            keeps_bound: self.keeps_bound(),
            trembles: self.follower.trembles && matches!(self.mover.motion(), Motion::Geared),
            ..self.seen_before(scan)
        }
    }

    /// Whether its set-point is the result of a plan, and not the feedback.
    pub(crate) fn is_operating(&self) -> bool {
        !matches!(self.mover.motion(), Motion::Follow | Motion::Torque { .. })
    }

    /// Its future motion, if that is its own plan.
    pub(crate) fn course(&self) -> Course<'_, P::Plan> {
        match self.mover.motion() {
            _ if self.mover.layer().is_some() => Course::Unknown,
            Motion::Hold => Course::Still,
            // The motion along a curve through points ahead is not known.
            Motion::Run { plan, elapsed, .. } if self.planner.is_curve((plan, *elapsed)) => Course::Unknown,
            Motion::Run { plan, elapsed, .. } => Course::Plan(plan, *elapsed),
            // While it is in gear behind a plan of its master, slaves look along that plan.
            Motion::Geared if self.follower.stands && self.factor_in_gear().is_none() => Course::Still,
            // In gear with measured values its velocity is no more constant than theirs.
            Motion::Geared if self.follows_actual() => Course::Measured(UNKNOWN),
            Motion::Follow | Motion::Torque { .. } | Motion::Geared | Motion::Closing { .. } => {
                Course::Unknown
            }
        }
    }

    /// The source of its next set-point.
    #[inline]
    fn source(&self) -> Source {
        match self.course() {
            Course::Still => Source::None,
            Course::Plan(..) => Source::Plan,
            Course::Unknown if self.factor_in_gear().is_some() => Source::Gear,
            Course::Unknown | Course::Measured(_) => Source::Other,
        }
    }

    /// Before its step in this scan: notes the source of the step.
    pub(crate) fn note_source(&mut self) {
        self.follower.steady.source = self.source();
    }

    /// Whether its next set-point has another source than that of this scan.
    pub(crate) fn has_new_source(&self) -> bool {
        self.follower.steady.source != self.source()
    }

    /// The future motion of its actual values.
    pub(crate) fn course_of_actual(&self) -> Course<'_, P::Plan> {
        if self.is_measured_still() {
            Course::Still
        } else {
            Course::Measured(UNKNOWN.max(self.filter_scans().into()))
        }
    }

    /// In gear, the factor from the derivatives of its master's plan to its own.
    pub(crate) fn factor_in_gear(&self) -> Option<f64> {
        let coupling = self.coupling().filter(|_| !self.follows_actual())?;
        let follows_one = coupling.gearing.second.is_none() && !self.is_phasing() && !self.adds_motion();
        (coupling.rung.is_locked() && matches!(self.mover.motion(), Motion::Geared) && follows_one)
            .then(|| coupling.gearing.first.gear.derivative(1.0))
    }

    /// Before any axis has moved in this scan: notes the places of its masters.
    pub(crate) fn note_masters(&mut self, seen: SeenBoth) {
        let [first, second] = seen;
        let [by, by_second] = self.phases_now();
        let seen = [first.shifted(by), second.shifted(by_second)];
        if let Some(coupling) = &mut self.follower.coupling {
            coupling.was = seen;
        }
        self.note_master_on_cam(seen[0]);
    }
}

//! What a slave may know of its master in its motion step: where it is, where it was, and its plan. Nothing else.

use super::super::modulo::Modulo;
use super::super::{Axis, Motion};
use standstill_planner::{Anchor, Lead, Leads, Limits, Place, Plan, Planner, Setpoint};

/// A master at the end of a motion step.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Seen {
    pub place: Place,
    /// Its derivatives; the position is that of `place`.
    pub at: Setpoint,
    /// By how much its coordinates moved in this scan (u).
    pub moved: f64,
    /// Its set-point is the result of a plan.
    pub is_operating: bool,
    /// How smooth its motions are: 2, 3 or 4.
    pub degree: usize,
    /// Its motion was planned within what its slaves leave of its limits.
    pub keeps_bound: bool,
}

/// The masters of a slave as they are seen: a second one only where it has two.
pub(crate) type SeenBoth = [Seen; 2];

/// The law that holds when the masters are as `seen` and the slave is there.
pub(super) fn anchor_at(seen: &SeenBoth, slave: Place) -> Anchor {
    Anchor {
        master: seen[0].place,
        second: seen[1].place,
        slave,
    }
}

/// The masters in their slave's motion step, after their own.
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

/// What the masters do next, as far as is known.
#[derive(Clone, Copy)]
pub(crate) struct Future<'a, Plan> {
    /// Of each master; of the second one nothing where there is none.
    pub parts: [Part<'a, Plan>; 2],
    /// It holds from the end of this scan on: the step of a master in this scan came from something else.
    pub is_new: bool,
}

/// What a master does next, as far as is known.
#[derive(Clone, Copy)]
pub(crate) struct Part<'a, Plan> {
    /// The axis whose plan it is: the master, or the first one of a chain in gear.
    pub root: usize,
    /// What the derivatives of the plan are multiplied by to be those of the master.
    pub factor: f64,
    pub course: Course<'a, Plan>,
}

impl<Plan> Part<'_, Plan> {
    /// Of a master that there is not.
    pub(crate) const NONE: Self = Self {
        root: usize::MAX,
        factor: 0.0,
        course: Course::Still,
    };
}

/// What an axis does next.
#[derive(Clone, Copy)]
pub(crate) enum Course<'a, Plan> {
    /// It stands.
    Still,
    /// This plan, so many scans after its start.
    Plan(&'a Plan, u64),
    /// Not known: more than one plan at once, or a curve.
    Unknown,
    /// Measured values: not known, and never quite even. The way onto the law is looked for again after so many scans.
    Measured(u64),
}

/// Scans after which the way is looked for again while what the master does next is not known.
pub(super) const UNKNOWN: u64 = 16;

/// Where the set-points of an axis come from.
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

/// What kind of course it is.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in crate::axis) enum Kind {
    #[default]
    NotSeen,
    Still,
    Plan,
    Unknown,
    Measured,
}

/// What a slave remembers of what its masters do next, to see that it is something else.
pub(super) type Known = [KnownPart; 2];

/// What it remembers of one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct KnownPart {
    pub root: usize,
    factor: f64,
    pub kind: Kind,
    pub elapsed: u64,
    /// Position and velocity at the end of the plan.
    end: (f64, f64),
}

impl<'a, P: Plan> Part<'a, P> {
    /// What is known of it now, and whether it goes on from what was `known` in the scan before.
    fn compare(&self, known: &KnownPart) -> (KnownPart, bool) {
        let (kind, elapsed, end) = match self.course {
            Course::Still => (Kind::Still, 0, (0.0, 0.0)),
            // A plan in progress is told by its scans; only one that has just begun could be taken for another.
            Course::Plan(_, elapsed) if elapsed > 1 => (Kind::Plan, elapsed, known.end),
            Course::Plan(plan, elapsed) => {
                let end = plan.at(u64::from(plan.scans()));
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

/// Where the plan of a master ends.
pub(in crate::axis) fn end_of<Q: Plan>(lead: &Lead<'_, Q>) -> Setpoint {
    lead.plan.at(u64::from(lead.plan.scans()))
}

/// The way (u of the slave) on which the masters still lead it, so many `scans` after where the leads begin; `None` where one of them does not
/// come to rest.
pub(in crate::axis) fn way_to_rest<Q: Plan>(leads: &Leads<'_, Q>, scans: u64) -> Option<f64> {
    leads.iter().flatten().try_fold(0.0, |way, lead| {
        let end = end_of(lead);
        let here = lead.plan.at(lead.elapsed.saturating_add(scans)).position;
        (end.velocity == 0.0).then_some(way + lead.factor * (end.position - here))
    })
}

impl<'a, P: Plan> Future<'a, P> {
    /// What is known of it now, and whether it goes on from what was `known` in the scan before.
    fn compare(&self, known: &Known) -> (Known, bool) {
        let [first, second] = &self.parts;
        let (first, goes_on) = first.compare(&known[0]);
        let (second, second_goes_on) = second.compare(&known[1]);
        ([first, second], goes_on && second_goes_on)
    }

    /// Notes what is known of it now, and the limits of the slave. Returns whether that, or a limit, is another one than in the scan
    /// before, or the scans are over after which the way is to be looked for again, unless the slave is locked.
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

    /// What kind of course the masters take together.
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

    /// The values of the masters are measured: after how many scans the way onto their law is looked for again.
    pub(super) fn measured(&self) -> Option<u64> {
        let scans = |part: &Part<'_, P>| match part.course {
            Course::Measured(scans) => Some(scans),
            Course::Still | Course::Plan(..) | Course::Unknown => None,
        };
        let scans = self.parts.iter().filter_map(scans).max();
        scans.filter(|_| self.kind() == Kind::Measured)
    }

    /// It has a plan that the master's step in this scan was not of.
    pub(in crate::axis) fn is_late(&self) -> bool {
        let plans = self.parts.iter().map(|part| &part.course);
        let is_late = |course: &Course<'_, P>| match course {
            Course::Plan(_, elapsed) => self.is_new || *elapsed == 0,
            Course::Still | Course::Unknown | Course::Measured(_) => false,
        };
        self.kind() == Kind::Plan && plans.into_iter().any(is_late)
    }

    /// The plans of the masters from the end of the scan before on, or from the end of this one if they are late: each with the
    /// factor that `geared` gives for it and its number. Nothing of a master that stands, nor of one that is geared by 0.
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

    /// The plan of the first master from the end of the scan before on: the scans after its start, and how many scans later than
    /// that it begins, which is 1 for one that the master's step in this scan was not of.
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
    /// Both masters as they are.
    pub(super) fn seen(&self) -> SeenBoth {
        [self.now, self.second.unwrap_or_default()]
    }

    /// All masters are in operation.
    pub(super) fn is_operating(&self) -> bool {
        self.now.is_operating && self.second.is_none_or(|seen| seen.is_operating)
    }

    /// The motions of all masters were planned within what their slaves leave of their limits.
    pub(super) fn keeps_bound(&self) -> bool {
        self.now.keeps_bound && self.second.is_none_or(|seen| seen.keeps_bound)
    }

    /// How smooth the motions of the masters are: 2, 3 or 4.
    pub(super) fn degree(&self) -> usize {
        let second = self.second.map_or(usize::MAX, |seen| seen.degree);
        self.now.degree.min(second)
    }
}

impl<P: Planner> Axis<P> {
    /// Where it is: whole turns, and the position programs see.
    #[inline(always)]
    pub(crate) fn place(&self) -> Place {
        match &self.modulo {
            None => Place {
                position: self.setpoint.position,
                ..Place::default()
            },
            Some(modulo) => self.place_round(modulo),
        }
    }

    #[inline(never)]
    fn place_round(&self, modulo: &Modulo) -> Place {
        let shown = modulo.in_turn(self.setpoint.position);
        let further = (self.setpoint.position - shown) / modulo.length;
        let nearest = if further < 0.0 {
            further - 0.5
        } else {
            further + 0.5
        };
        Place {
            turns: modulo.turns().saturating_add(nearest as i64),
            position: shown,
            ..Place::default()
        }
    }

    /// Before its step in this scan: what its slaves remember of where it was.
    pub(crate) fn seen_before(&self, scan: u64) -> Seen {
        let place = self.place();
        Seen {
            place,
            at: Setpoint {
                position: place.position,
                ..self.setpoint
            },
            moved: self.coordinates_moved(scan),
            ..Seen::default()
        }
    }

    /// As its slaves see it.
    pub(crate) fn seen(&self, scan: u64) -> Seen {
        Seen {
            is_operating: self.is_operating(),
            degree: self.slowed(&self.config.limits).order().degree(),
            keeps_bound: self.keeps_bound(),
            ..self.seen_before(scan)
        }
    }

    /// Its set-point is the result of a plan, not the feedback.
    pub(crate) fn is_operating(&self) -> bool {
        !matches!(self.motion, Motion::Follow | Motion::Torque { .. })
    }

    /// What it does next, if that is its own plan.
    pub(crate) fn course(&self) -> Course<'_, P::Plan> {
        match &self.motion {
            _ if self.layer.is_some() => Course::Unknown,
            Motion::Hold => Course::Still,
            // Nothing is known of a curve through points ahead.
            Motion::Run { plan, elapsed, .. } if self.planner.is_curve((plan, *elapsed)) => Course::Unknown,
            Motion::Run { plan, elapsed, .. } => Course::Plan(plan, *elapsed),
            // In gear behind measured values it is no more even than those.
            Motion::Geared if self.follows_actual() => Course::Measured(UNKNOWN),
            Motion::Follow | Motion::Torque { .. } | Motion::Geared | Motion::Closing { .. } => {
                Course::Unknown
            }
        }
    }

    /// Where its next set-point comes from.
    #[inline]
    fn source(&self) -> Source {
        match self.course() {
            Course::Still => Source::None,
            Course::Plan(..) => Source::Plan,
            Course::Unknown if self.factor_in_gear().is_some() => Source::Gear,
            Course::Unknown | Course::Measured(_) => Source::Other,
        }
    }

    /// Before its step in this scan, which is from here.
    pub(crate) fn note_source(&mut self) {
        self.steady.source = self.source();
    }

    /// Its next set-point comes from elsewhere than that of this scan.
    pub(crate) fn has_new_source(&self) -> bool {
        self.steady.source != self.source()
    }

    /// What its actual values do next.
    pub(crate) fn course_of_actual(&self) -> Course<'_, P::Plan> {
        if self.is_measured_still() {
            Course::Still
        } else {
            Course::Measured(UNKNOWN.max(self.filter_scans().into()))
        }
    }

    /// In gear it does what the plan of its master does, its derivatives times this.
    pub(crate) fn factor_in_gear(&self) -> Option<f64> {
        let coupling = self.coupling.as_ref().filter(|_| !self.follows_actual())?;
        let follows_one = coupling.gearing.second.is_none() && !self.is_phasing() && !self.adds_motion();
        (coupling.rung.is_locked() && matches!(self.motion, Motion::Geared) && follows_one)
            .then(|| coupling.gearing.first.gear.derivative(1.0))
    }

    /// Before any axis has moved in this scan: its masters are there.
    pub(crate) fn note_masters(&mut self, seen: SeenBoth) {
        let [first, second] = seen;
        let [by, by_second] = self.phases_now();
        let seen = [first.shifted(by), second.shifted(by_second)];
        if let Some(coupling) = &mut self.coupling {
            coupling.was = seen;
        }
        self.note_master_on_cam(seen[0]);
    }
}

//! What a slave may know of its master in its motion step: where it is, where it was, and its plan. Nothing else.

use super::super::{Axis, Motion};
use super::Rung;
use standstill_planner::{Place, Plan, Planner, Setpoint};

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
}

/// A master in its slave's motion step, after its own.
#[derive(Clone, Copy)]
pub(crate) struct View<'a, Plan> {
    pub now: Seen,
    /// The length of its turn (u), if it has turns.
    pub turn: Option<f64>,
    pub future: Future<'a, Plan>,
}

/// What the master does next, as far as is known.
#[derive(Clone, Copy)]
pub(crate) struct Future<'a, Plan> {
    /// The axis whose plan it is: the master, or the first one of a chain in gear.
    pub root: usize,
    /// What the derivatives of the plan are multiplied by to be those of the master.
    pub factor: f64,
    /// It holds from the end of this scan on: the master's step in this scan came from something else.
    pub is_new: bool,
    pub course: Course<'a, Plan>,
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
}

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

/// What kind of course it was.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
enum Kind {
    #[default]
    NotSeen,
    Still,
    Plan,
    Unknown,
}

/// What a slave remembers of a future, to see that it is another one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Known {
    root: usize,
    factor: f64,
    kind: Kind,
    elapsed: u64,
    /// Position and velocity at the end of the plan.
    end: (f64, f64),
}

impl<'a, P: Plan> Future<'a, P> {
    /// What is known of it now, and whether it goes on from what was `known` in the scan before.
    pub(super) fn compare(&self, known: &Known) -> (Known, bool) {
        let (kind, elapsed, end) = match self.course {
            Course::Still => (Kind::Still, 0, (0.0, 0.0)),
            // A plan in progress is told by its scans; only one that has just begun could be taken for another.
            Course::Plan(_, elapsed) if elapsed > 1 => (Kind::Plan, elapsed, known.end),
            Course::Plan(plan, elapsed) => {
                let end = plan.at(u64::from(plan.scans()));
                (Kind::Plan, elapsed, (end.position, end.velocity))
            }
            Course::Unknown => (Kind::Unknown, 0, (0.0, 0.0)),
        };
        let now = Known {
            root: self.root,
            factor: self.factor,
            kind,
            elapsed,
            end,
        };
        let expected = Known {
            elapsed: if kind == Kind::Plan {
                known.elapsed.wrapping_add(1)
            } else {
                0
            },
            ..*known
        };
        (now, now == expected)
    }

    /// Its plan from the end of the scan before on: the scans after its start, and how many scans later than that it begins,
    /// which is 1 for one that the master's step in this scan was not of.
    pub(super) fn plan(&self) -> Option<(&'a P, u64, u64)> {
        match self.course {
            Course::Plan(plan, elapsed) if self.is_new => Some((plan, elapsed, 1)),
            Course::Plan(plan, 0) => Some((plan, 0, 1)),
            Course::Plan(plan, elapsed) => Some((plan, elapsed - 1, 0)),
            Course::Still | Course::Unknown => None,
        }
    }

    /// It is a plan that the master's step in this scan was not of.
    pub(super) fn is_late(&self) -> bool {
        matches!(self.plan(), Some((_, _, 1)))
    }
}

impl<P: Planner> Axis<P> {
    /// Where it is: whole turns, and the position programs see.
    pub(crate) fn place(&self) -> Place {
        let shown = self.setpoint().position;
        let turns = self.modulo.as_ref().map_or(0, |modulo| {
            let further = (self.setpoint.position - shown) / modulo.length;
            let nearest = if further < 0.0 {
                further - 0.5
            } else {
                further + 0.5
            };
            modulo.turns().saturating_add(nearest as i64)
        });
        Place {
            turns,
            position: shown,
            ..Place::default()
        }
    }

    /// As its slaves see it.
    pub(crate) fn seen(&self, scan: u64) -> Seen {
        let place = self.place();
        Seen {
            place,
            at: Setpoint {
                position: place.position,
                ..self.setpoint
            },
            moved: self.coordinates_moved(scan),
            is_operating: self.is_operating(),
            degree: self.config.limits.order().degree(),
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
            Motion::Run { plan, elapsed, .. } => Course::Plan(plan, *elapsed),
            Motion::Follow | Motion::Torque { .. } | Motion::Geared | Motion::Closing { .. } => {
                Course::Unknown
            }
        }
    }

    /// Where its next set-point comes from.
    fn source(&self) -> Source {
        match self.course() {
            Course::Still => Source::None,
            Course::Plan(..) => Source::Plan,
            Course::Unknown if self.factor_in_gear().is_some() => Source::Gear,
            Course::Unknown => Source::Other,
        }
    }

    /// Before its step in this scan, which is from here.
    pub(crate) fn note_source(&mut self) {
        self.source = self.source();
    }

    /// Its next set-point comes from elsewhere than that of this scan.
    pub(crate) fn has_new_source(&self) -> bool {
        self.source != self.source()
    }

    /// In gear it does what its master does, its derivatives times this.
    pub(crate) fn factor_in_gear(&self) -> Option<f64> {
        let coupling = self.coupling.as_ref()?;
        (coupling.rung == Rung::Locked && matches!(self.motion, Motion::Geared) && !self.is_phasing())
            .then(|| coupling.gearing.gear.derivative(1.0))
    }

    /// Before any axis has moved in this scan: its master is there.
    pub(crate) fn note_master(&mut self, seen: Seen) {
        let seen = seen.shifted(self.phase_now());
        if let Some(coupling) = &mut self.coupling {
            coupling.was = seen;
        }
    }
}

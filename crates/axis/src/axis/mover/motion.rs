//! The source of a set-point.

use standstill_planner::Plan;

/// The source of the set-point.
#[derive(Clone, Copy, Debug)]
pub(in crate::axis) enum Motion<Plan> {
    /// The actual position: the axis is not in operation.
    Follow,
    /// The present position, which is held.
    Hold,
    /// A plan, the scans since its start, and the scans to the goal. These are all scans of the plan, or fewer if the
    /// plan continues behind the goal for the next command. Stored, because each scan reads them several times.
    Run { plan: Plan, elapsed: u64, scans: u64 },
    /// The actual position under a torque: the last torque ordered, the ramp of its velocity limit, and the scans
    /// since its start.
    Torque { plan: Plan, elapsed: u64, torque: f64 },
    /// The law of its coupling.
    Geared,
    /// The same, plus a plan beside it.
    Closing { plan: Plan, elapsed: u64, scans: u64 },
}

impl<P: Plan> Motion<P> {
    /// Its plan, and the scans since its start.
    pub fn plan(&self) -> Option<(&P, u64)> {
        match self {
            Self::Run { plan, elapsed, .. } => Some((plan, *elapsed)),
            Self::Follow | Self::Hold | Self::Torque { .. } | Self::Geared | Self::Closing { .. } => None,
        }
    }

    /// Along `plan`, from its start to its goal.
    pub fn along(plan: P) -> Self {
        Self::Run {
            plan,
            elapsed: 0,
            scans: scans_to_goal(&plan),
        }
    }

    /// Along `plan` beside a moving reference, from its start.
    pub fn closing(plan: P) -> Self {
        Self::Closing {
            plan,
            elapsed: 0,
            scans: u64::from(plan.scans()),
        }
    }

    /// Whether its plan continues behind the goal, for the next command.
    pub fn goes_on(&self) -> bool {
        matches!(self, Self::Run { plan, scans, .. } if *scans < u64::from(plan.scans()))
    }

    /// Scans from the start of its plan to the goal; 0 without one.
    pub fn scans(&self) -> u64 {
        match self {
            Self::Run { scans, .. } | Self::Closing { scans, .. } => *scans,
            Self::Follow | Self::Hold | Self::Torque { .. } | Self::Geared => 0,
        }
    }

    /// `None` if the set-point follows the feedback, 0 if it holds, else one more than the scans to the goal.
    pub fn scans_left(&self) -> Option<u32> {
        match self {
            Self::Follow => None,
            Self::Hold | Self::Torque { .. } | Self::Geared => Some(0),
            Self::Run { elapsed, scans, .. } | Self::Closing { elapsed, scans, .. } => {
                // At least 1, to distinguish a plan at its goal from holding.
                let left = scans.saturating_sub(*elapsed);
                Some(u32::try_from(left).unwrap_or(u32::MAX).saturating_add(1))
            }
        }
    }
}

/// Scans of a plan to its goal: the rest at its end, its end passed in motion, or the turn at its target.
pub(in crate::axis) fn scans_to_goal<P: Plan>(plan: &P) -> u64 {
    plan.turn().unwrap_or(plan.scans()).into()
}

//! Couplings, seen from above all axes: who may follow whom, and in which order they move.
//!
//! Masters move before their slaves, whatever their numbers and whichever block was called first. A ring is refused where it
//! would close.

use crate::axis::{Future, View};
use crate::{Axis, AxisId, AxisState, Command, CommandId, ErrorId, Planner, QUEUE_MAX, Request, Scope};

/// Gives `slave` a command that may couple it to a master; any other command is given as it is.
///
/// Cost: that of the command, and of a look up the chains of masters, at most as many looks at all axes as there are.
///
/// # Errors
/// What [`Axis::command`] refuses; besides [`ErrorId::AxisUnknown`] if there is no such slave or master,
/// [`ErrorId::CouplingRing`] if the master follows the slave, [`ErrorId::MasterLost`] if it is not in operation. Nothing changes
/// then.
pub fn couple<P: Planner>(
    axes: &mut [Axis<P>],
    slave: AxisId,
    request: &Request,
    scope: &mut Scope<'_>,
) -> Result<CommandId, ErrorId> {
    let obstacle = match &request.command {
        Command::GearIn { master, .. } => {
            obstacle(axes, slave, master.axis).map(|error| (error, master.axis))
        }
        _ => None,
    };
    let axis = axes.get_mut(slave.index()).ok_or(ErrorId::AxisUnknown)?;
    // Where the slave can't take it now its own state says so, and what waits is asked again when its turn comes.
    let takes = matches!(
        axis.state(),
        AxisState::Standstill
            | AxisState::DiscreteMotion
            | AxisState::ContinuousMotion
            | AxisState::SynchronizedMotion
    );
    let obstacle = obstacle.filter(|(error, _)| takes || *error != ErrorId::MasterLost);
    if let Some((error, master)) = obstacle {
        axis.note_refusal("Master", f64::from(master.number()), f64::NAN, error, scope);
        return Err(error);
    }
    axis.command(request, scope)
}

/// Why `slave` can't follow `master` now.
fn obstacle<P: Planner>(axes: &mut [Axis<P>], slave: AxisId, master: AxisId) -> Option<ErrorId> {
    let Some(is_operating) = axes.get(master.index()).map(Axis::is_operating) else {
        return Some(ErrorId::AxisUnknown);
    };
    if is_above(axes, slave, master) {
        return Some(ErrorId::CouplingRing);
    }
    (!is_operating).then_some(ErrorId::MasterLost)
}

/// Whether `upper` is among `lower`, its masters, and theirs. A command that waits for a place of a master counts: its slave moves
/// behind that already, and masters and slaves that wait for each other would have no order.
///
/// Cost: as many looks at all axes as the longest chain has axes.
fn is_above<P: Planner>(axes: &mut [Axis<P>], upper: AxisId, lower: AxisId) -> bool {
    for axis in axes.iter_mut() {
        axis.set_above(axis.id() == lower);
    }
    for _ in 0..axes.len() {
        let mut is_settled = true;
        for index in 0..axes.len() {
            let Some(axis) = axes.get(index).filter(|axis| axis.is_above()) else {
                continue;
            };
            if axis.id() == upper {
                return true;
            }
            for master in axis.masters() {
                let new = axes.get_mut(master.index()).filter(|axis| !axis.is_above());
                if let Some(axis) = new {
                    axis.set_above(true);
                    is_settled = false;
                }
            }
        }
        if is_settled {
            break;
        }
    }
    false
}

/// The motion step where some axis may follow another: masters first, axes of one rank in the order of their numbers.
#[inline(never)]
pub(crate) fn advance<P: Planner>(axes: &mut [Axis<P>], scope: &mut Scope<'_>) {
    let highest = set_ranks(axes);
    for index in 0..axes.len() {
        let see = |master: Option<AxisId>| Some(axes.get(master?.index())?.seen(scope.scan));
        let seen = see(axes.get(index).and_then(Axis::master));
        let awaited = see(axes.get(index).and_then(Axis::awaited_master));
        let Some(axis) = axes.get_mut(index) else { continue };
        axis.note_source();
        if let Some(seen) = seen {
            axis.note_master(seen);
        }
        if let Some(seen) = awaited {
            axis.note_awaited_master(seen);
        }
    }
    // No chain is longer than there are axes.
    for rank in 0..=highest {
        for index in 0..axes.len() {
            if axes.get(index).is_some_and(|axis| axis.rank() == rank) {
                bar_rings(axes, index);
                advance_one(axes, index, scope);
            }
        }
    }
}

/// Tells every axis how many masters stand above it, those included whose place a command waits for. Returns the most.
///
/// Cost: as many looks at all axes as the longest chain has axes; what waits may close a ring, which takes one for each axis.
fn set_ranks<P: Planner>(axes: &mut [Axis<P>]) -> u16 {
    for axis in axes.iter_mut() {
        axis.set_rank(0);
    }
    let mut highest = 0;
    for _ in 0..axes.len() {
        let mut is_settled = true;
        for index in 0..axes.len() {
            let Some(axis) = axes.get(index) else { continue };
            let above = axis.masters().filter_map(|master| axes.get(master.index()));
            let rank = above.map(|master| master.rank().saturating_add(1)).max();
            let rank = rank.unwrap_or(0);
            highest = rank.max(highest);
            if let Some(axis) = axes.get_mut(index).filter(|axis| axis.rank() != rank) {
                axis.set_rank(rank);
                is_settled = false;
            }
        }
        if is_settled {
            break;
        }
    }
    highest
}

/// What waits behind a motion may become active in this step: if it could not then, it is told before.
fn bar_rings<P: Planner>(axes: &mut [Axis<P>], index: usize) {
    let Some(axis) = axes.get_mut(index).filter(|axis| axis.is_bound()) else {
        return;
    };
    let (slave, masters) = (axis.id(), axis.masters_of_waiting());
    let mut barred = [None; QUEUE_MAX];
    for (error, master) in barred.iter_mut().zip(masters) {
        *error = master.and_then(|master| obstacle(axes, slave, master));
    }
    if let Some(axis) = axes.get_mut(index) {
        axis.bar_waiting(&barred);
    }
}

fn advance_one<P: Planner>(axes: &mut [Axis<P>], index: usize, scope: &mut Scope<'_>) {
    start_at_point(axes, index, scope);
    if let Some(master) = axes.get(index).and_then(Axis::master) {
        look(axes, index, master, scope, Axis::advance_behind);
    } else if let Some(axis) = axes.get_mut(index) {
        axis.advance(scope);
    }
}

/// What waits for a place of its master takes over when that is there, before the step of its slave.
fn start_at_point<P: Planner>(axes: &mut [Axis<P>], index: usize, scope: &mut Scope<'_>) {
    let Some(id) = axes.get(index).and_then(Axis::awaited_master) else {
        return;
    };
    let Some(master) = axes.get(id.index()) else {
        return;
    };
    let (now, turn) = (master.seen(scope.scan), master.config().modulo);
    let Some(slave) = axes.get_mut(index) else { return };
    if !slave.reaches_start(&now, turn) {
        return;
    }
    let slave = slave.id();
    match obstacle(axes, slave, id) {
        None => look(axes, index, id, scope, Axis::start_at_point),
        Some(error) => {
            if let Some(axis) = axes.get_mut(index) {
                axis.bar_awaited(error, scope);
            }
        }
    }
}

/// Lets the axis at `index` act with a look at the master `id`.
fn look<P: Planner>(
    axes: &mut [Axis<P>],
    index: usize,
    id: AxisId,
    scope: &mut Scope<'_>,
    act: impl FnOnce(&mut Axis<P>, &View<'_, P::Plan>, &mut Scope<'_>),
) {
    let Some(master) = axes.get(id.index()) else {
        return;
    };
    let (now, turn) = (master.seen(scope.scan), master.config().modulo);
    let (root, factor, is_new) = root(axes, id);
    // Two different axes: a ring was refused where it would have closed.
    let Ok([slave, root_axis]) = axes.get_disjoint_mut([index, root]) else {
        return;
    };
    let future = Future {
        root,
        factor,
        is_new,
        course: root_axis.course(),
    };
    act(slave, &View { now, turn, future }, scope);
}

/// The axis whose plan a master follows, up the chain of those in gear; what the derivatives of that are multiplied by; and
/// whether the step of this scan was another source's.
fn root<P: Planner>(axes: &[Axis<P>], master: AxisId) -> (usize, f64, bool) {
    let (mut at, mut factor, mut is_new) = (master, 1.0, false);
    for _ in 0..axes.len() {
        let Some(axis) = axes.get(at.index()) else { break };
        is_new |= axis.has_new_source();
        let (Some(next), Some(own)) = (axis.master(), axis.factor_in_gear()) else {
            break;
        };
        factor *= own;
        at = next;
    }
    (at.index(), factor, is_new)
}

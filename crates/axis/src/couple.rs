//! Couplings, seen from above all axes: who may follow whom, and in which order they move.
//!
//! Masters move before their slaves, whatever their numbers and whichever block was called first. A ring is refused where it
//! would close.

use crate::axis::{Future, Part, Seen, Values, View};
use crate::{
    Axis, AxisId, AxisState, Command, CommandId, ErrorId, Followed, Planner, QUEUE_MAX, Request, Scope,
    ValueSource,
};

/// Gives `slave` a command that may couple it to a master; any other command is given as it is.
///
/// Cost: that of the command, and of a look up the chains of masters, at most as many looks at all axes as there are.
///
/// # Errors
/// What [`Axis::command`] refuses; besides [`ErrorId::AxisUnknown`] if there is no such slave or master,
/// [`ErrorId::CouplingRing`] if the master follows the slave, [`ErrorId::MasterLost`] if it is not in operation, for actual values
/// if its drive tells none, [`ErrorId::MasterSourceInvalid`] if it has none that could be followed. Nothing changes then.
pub fn couple<P: Planner>(
    axes: &mut [Axis<P>],
    slave: AxisId,
    request: &Request,
    scope: &mut Scope<'_>,
) -> Result<CommandId, ErrorId> {
    let state = axes.get(slave.index()).map(Axis::state);
    // Where the slave can't take it now its own state says so, and what waits is asked again when its turn comes.
    let takes = matches!(
        state,
        Some(
            AxisState::Standstill
                | AxisState::DiscreteMotion
                | AxisState::ContinuousMotion
                | AxisState::SynchronizedMotion
        )
    );
    check(axes, slave, &request.command, takes, scope)?.command(request, scope)
}

/// Gives a command of `slave` that couples it new values, as [`Axis::update`] does; any other command is given them as it is.
///
/// Cost: that of [`couple`].
///
/// # Errors
/// What [`couple`] refuses, but for a master that is not in operation now. It is recorded, and the command goes on as it was.
pub fn update_coupled<P: Planner>(
    axes: &mut [Axis<P>],
    slave: AxisId,
    id: CommandId,
    command: &Command,
    scope: &mut Scope<'_>,
) -> Result<(), ErrorId> {
    check(axes, slave, command, false, scope)?.update(id, command, scope)
}

/// The slave, if it may follow the masters of this command; masters out of operation do not mind where it `takes` no command.
fn check<'a, P: Planner>(
    axes: &'a mut [Axis<P>],
    slave: AxisId,
    command: &Command,
    takes: bool,
    scope: &mut Scope<'_>,
) -> Result<&'a mut Axis<P>, ErrorId> {
    let mut of = |pins: [&'static str; 2], followed: &Followed| {
        let source = followed.source.get().unwrap_or(ValueSource::Set);
        let values = (followed.master.axis, source);
        obstacle(axes, slave, values).map(|error| (error, pins, values))
    };
    let obstacle = match command {
        Command::GearIn { followed, .. } => of(["Master", "MasterValueSource"], followed),
        Command::CombineAxes { masters, .. } => {
            let [first, second] = masters;
            of(["Master1", "MasterValueSourceM1"], first)
                .or_else(|| of(["Master2", "MasterValueSourceM2"], second))
        }
        Command::CamIn(cam) => of(
            ["Master", "MasterValueSource"],
            &Followed {
                master: cam.master,
                source: cam.source,
                ..Followed::default()
            },
        ),
        _ => None,
    };
    let axis = axes.get_mut(slave.index()).ok_or(ErrorId::AxisUnknown)?;
    let obstacle = obstacle.filter(|(error, ..)| takes || *error != ErrorId::MasterLost);
    if let Some((error, [master_pin, source_pin], (master, source))) = obstacle {
        let (pin, value, limit) = match error {
            ErrorId::MasterSourceInvalid => (source_pin, f64::from(source as i32), 1.0),
            _ => (master_pin, f64::from(master.number()), f64::NAN),
        };
        axis.note_refusal(pin, value, limit, error, scope);
        return Err(error);
    }
    Ok(axis)
}

/// Why `slave` can't follow these values of a master now.
fn obstacle<P: Planner>(axes: &mut [Axis<P>], slave: AxisId, (master, source): Values) -> Option<ErrorId> {
    let Some(axis) = axes.get(master.index()) else {
        return Some(ErrorId::AxisUnknown);
    };
    let (is_there, is_operating) = match source {
        ValueSource::Actual => (axis.is_measured(), axis.fresh_position().is_ok()),
        ValueSource::Set | ValueSource::Commanded => (true, axis.is_operating()),
    };
    if is_above(axes, slave, master) {
        return Some(ErrorId::CouplingRing);
    }
    if !is_there {
        return Some(ErrorId::MasterSourceInvalid);
    }
    (!is_operating).then_some(ErrorId::MasterLost)
}

/// A master at the end of this scan, or before it moved in it.
fn seen<P: Planner>(axes: &[Axis<P>], (master, source): Values, is_before: bool, scan: u64) -> Option<Seen> {
    let axis = axes.get(master.index())?;
    Some(match source {
        ValueSource::Actual => axis.seen_actual(scan, is_before),
        ValueSource::Set | ValueSource::Commanded => axis.seen(scan),
    })
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
        let Some(axis) = axes.get_mut(index) else { continue };
        axis.note_source();
        if axis.is_bound() {
            note_masters(axes, index, scope.scan);
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
    slow_masters(axes, highest, scope);
}

/// Before any axis has moved in this scan: a slave's masters are there.
fn note_masters<P: Planner>(axes: &mut [Axis<P>], index: usize, scan: u64) {
    let Some(axis) = axes.get(index) else { return };
    let see = |values: Option<Values>| seen(axes, values?, true, scan);
    let [first, second] = axis.followed_values();
    let (first, second, awaited) = (see(first), see(second), see(axis.awaited_values()));
    let Some(axis) = axes.get_mut(index) else { return };
    if let Some(seen) = first {
        axis.note_masters([seen, second.unwrap_or_default()]);
    }
    if let Some(seen) = awaited {
        axis.note_awaited_master(seen);
    }
}

/// What slaves leave of the limits of their masters, from the next motion step on: from the lowest slaves up, because what a
/// slave has left counts for its master.
///
/// Cost: a look at each axis; where a slave slows its master, one for each rank, and where a bound changes that of an override.
fn slow_masters<P: Planner>(axes: &mut [Axis<P>], highest: u16, scope: &mut Scope<'_>) {
    if !axes.iter().any(Axis::may_bound) {
        return;
    }
    for axis in axes.iter_mut() {
        axis.begin_bound();
    }
    for rank in (0..=highest).rev() {
        for index in 0..axes.len() {
            let Some(axis) = axes.get_mut(index).filter(|axis| axis.rank() == rank) else {
                continue;
            };
            axis.take_bound(scope);
            for (master, bound) in axis.bounds_of_masters() {
                if let Some(master) = axes.get_mut(master.index()) {
                    master.lower_bound(&bound);
                }
            }
        }
    }
}

/// Tells every axis how many masters stand above it, those included whose place a command waits for. Returns the most.
///
/// Cost: a look at all axes while nothing has changed; else as many as the longest chain has axes. What waits may close a ring, which
/// takes one for each axis.
fn set_ranks<P: Planner>(axes: &mut [Axis<P>]) -> u16 {
    // Without a ring there are no other ranks than those that agree with each other.
    if axes.iter().all(|axis| axis.rank() == rank_below(axes, axis)) {
        return axes.iter().map(Axis::rank).max().unwrap_or(0);
    }
    for axis in axes.iter_mut() {
        axis.set_rank(0);
    }
    let mut highest = 0;
    for _ in 0..axes.len() {
        let mut is_settled = true;
        for index in 0..axes.len() {
            let Some(axis) = axes.get(index) else { continue };
            let rank = rank_below(axes, axis);
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

/// The rank of an axis, as those of its masters are now.
fn rank_below<P: Planner>(axes: &[Axis<P>], axis: &Axis<P>) -> u16 {
    if !axis.is_bound() {
        return 0;
    }
    let above = axis.masters().filter_map(|master| axes.get(master.index()));
    let rank = above.map(|master| master.rank().saturating_add(1)).max();
    rank.unwrap_or(0)
}

/// What waits behind a motion may become active in this step: if it could not then, it is told before.
fn bar_rings<P: Planner>(axes: &mut [Axis<P>], index: usize) {
    let Some(axis) = axes.get_mut(index).filter(|axis| axis.is_bound()) else {
        return;
    };
    if !axis.renew_bound() {
        return;
    }
    let (slave, masters) = (axis.id(), axis.masters_of_waiting());
    let mut barred = [None; QUEUE_MAX];
    for (error, masters) in barred.iter_mut().zip(masters) {
        *error = masters
            .into_iter()
            .flatten()
            .find_map(|master| obstacle(axes, slave, master));
    }
    if let Some(axis) = axes.get_mut(index) {
        axis.bar_waiting(&barred);
    }
}

fn advance_one<P: Planner>(axes: &mut [Axis<P>], index: usize, scope: &mut Scope<'_>) {
    start_at_point(axes, index, scope);
    let masters = axes.get(index).map_or([None; 2], Axis::followed_values);
    if let [Some(first), second] = masters {
        let is_on_cam = axes.get(index).is_some_and(Axis::is_on_cam);
        let act = if is_on_cam {
            Axis::advance_on_cam
        } else {
            Axis::advance_behind
        };
        look(axes, index, (first, second), scope, act);
    } else if let Some(axis) = axes.get_mut(index) {
        axis.advance(scope);
    }
}

/// What waits for a place of its master takes over when that is there, before the step of its slave.
fn start_at_point<P: Planner>(axes: &mut [Axis<P>], index: usize, scope: &mut Scope<'_>) {
    let Some(followed) = axes.get(index).and_then(Axis::awaited_values) else {
        return;
    };
    let (Some(now), turn) = (seen(axes, followed, false, scope.scan), turn_of(axes, followed)) else {
        return;
    };
    let Some(slave) = axes.get_mut(index) else { return };
    if !slave.reaches_start(&now, turn, &scope.cams) {
        return;
    }
    let slave = slave.id();
    match obstacle(axes, slave, followed) {
        None => look(axes, index, (followed, None), scope, Axis::start_at_point),
        Some(error) => {
            if let Some(axis) = axes.get_mut(index) {
                axis.bar_awaited(error, scope);
            }
        }
    }
}

/// The length of a master's turn (u), if it has turns.
fn turn_of<P: Planner>(axes: &[Axis<P>], (master, _): Values) -> Option<f64> {
    axes.get(master.index())?.config().modulo
}

/// Lets the axis at `index` act with a look at these values of its masters.
fn look<P: Planner>(
    axes: &mut [Axis<P>],
    index: usize,
    (first, second): (Values, Option<Values>),
    scope: &mut Scope<'_>,
    act: impl FnOnce(&mut Axis<P>, &View<'_, P::Plan>, &mut Scope<'_>),
) {
    let (Some(now), turn) = (seen(axes, first, false, scope.scan), turn_of(axes, first)) else {
        return;
    };
    let seen_second = second.and_then(|second| seen(axes, second, false, scope.scan));
    let first_root = root(axes, first);
    let second_root = second.map(|second| root(axes, second));
    let Some((before, rest)) = axes.split_at_mut_checked(index) else {
        return;
    };
    let Some((slave, after)) = rest.split_first_mut() else {
        return;
    };
    // Never the slave: a ring was refused where it would have closed.
    let part = |root: &Root| {
        let own = before.get(root.axis);
        let axis = own.or_else(|| after.get(root.axis.checked_sub(index)?.checked_sub(1)?));
        axis.map_or(Part::NONE, |axis| Part {
            root: root.axis,
            factor: root.factor,
            course: if root.is_actual {
                axis.course_of_actual()
            } else {
                axis.course()
            },
        })
    };
    let future = Future {
        parts: [part(&first_root), second_root.as_ref().map_or(Part::NONE, part)],
        is_new: first_root.is_new || second_root.is_some_and(|root| root.is_new),
    };
    let view = View {
        now,
        turn,
        second: seen_second,
        future,
    };
    act(slave, &view, scope);
}

/// Whose plan a master follows.
struct Root {
    /// Its index.
    axis: usize,
    /// What the derivatives of that plan are multiplied by to be those of the master.
    factor: f64,
    /// The step of this scan was another source's.
    is_new: bool,
    /// Its actual values are followed, not its plan.
    is_actual: bool,
}

/// The axis whose plan a master follows, up the chain of those in gear.
fn root<P: Planner>(axes: &[Axis<P>], (master, source): Values) -> Root {
    if source == ValueSource::Actual {
        return Root {
            axis: master.index(),
            factor: 1.0,
            is_new: false,
            is_actual: true,
        };
    }
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
    Root {
        axis: at.index(),
        factor,
        is_new,
        is_actual: false,
    }
}

//! Couplings of all axes: which axis may follow which, and in which order they move.
//!
//! Masters move before their slaves, independent of their numbers and of the order of block calls. A
//! command that would close a ring is refused.

use crate::axis::{Future, Part, Seen, Turn, Values, View};
use crate::{
    Axis, AxisId, AxisState, Command, CommandId, ErrorId, Followed, Planner, QUEUE_MAX, Request, Scope,
    ValueSource,
};

/// Gives `slave` a command that may couple it to a master. Any other command is passed on unchanged.
///
/// Cost: that of the command, and a search of the chains of masters. The search visits all axes at most
/// as many times as there are axes.
///
/// # Errors
/// The errors of [`Axis::command`], and: [`ErrorId::AxisUnknown`] if there is no such slave or master;
/// [`ErrorId::CouplingRing`] if the master follows the slave; [`ErrorId::MasterLost`] if the master is
/// not in operation, or for actual values if its drive reports none; [`ErrorId::MasterSourceInvalid`] if
/// it has no values that can be followed. Nothing changes then.
pub fn couple<P: Planner>(
    axes: &mut [Axis<P>],
    slave: AxisId,
    request: &Request,
    scope: &mut Scope<'_>,
) -> Result<CommandId, ErrorId> {
    let state = axes.get(slave.index()).map(Axis::state);
    // If the slave can't take it now, its own state gives the reason; a waiting command is checked again
    // when it becomes active.
    let takes = matches!(
        state,
        Some(
            AxisState::Standstill
                | AxisState::DiscreteMotion
                | AxisState::ContinuousMotion
                | AxisState::SynchronizedMotion
        )
    );
    check(axes, slave, &request.command, takes, scope)?.take(request, scope)
}

/// Gives a command of `slave` that couples it new values, as [`Axis::update`] does. Any other command is
/// passed on unchanged.
///
/// Cost: that of [`couple`].
///
/// # Errors
/// The errors of [`couple`], except for a master that is not in operation now. The error is recorded, and
/// the command continues unchanged.
pub fn update_coupled<P: Planner>(
    axes: &mut [Axis<P>],
    slave: AxisId,
    id: CommandId,
    command: &Command,
    scope: &mut Scope<'_>,
) -> Result<(), ErrorId> {
    check(axes, slave, command, false, scope)?.update(id, command, scope)
}

/// Checks that the slave may follow the masters of this command, and returns it. A master out of operation is
/// accepted if the slave `takes` no command.
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
    let count = axes.len();
    if command.follows() {
        note_some_follow(axes, true);
    }
    let Some(axis) = axes.get_mut(slave.index()) else {
        return Err(scope.refuse_axis("Slave", slave, count));
    };
    let obstacle = obstacle.filter(|(error, ..)| takes || *error != ErrorId::MasterLost);
    if let Some((error, [master_pin, source_pin], (master, source))) = obstacle {
        let (pin, value, limit) = match error {
            ErrorId::MasterSourceInvalid => (source_pin, f64::from(source as i32), 1.0),
            ErrorId::AxisUnknown => (master_pin, f64::from(master.number()), count as f64),
            _ => (master_pin, f64::from(master.number()), f64::NAN),
        };
        axis.note_refusal(pin, value, limit, error, scope);
        return Err(error);
    }
    Ok(axis)
}

/// The reason why `slave` can't follow these values of a master now.
fn obstacle<P: Planner>(axes: &mut [Axis<P>], slave: AxisId, (master, source): Values) -> Option<ErrorId> {
    let Some(axis) = axes.get(master.index()) else {
        return Some(ErrorId::AxisUnknown);
    };
    let is_led = source == ValueSource::Actual || !axis.is_shaped();
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
    if !is_led {
        return Some(ErrorId::Shaped);
    }
    (!is_operating).then_some(ErrorId::MasterLost)
}

/// A master at the end of this scan.
fn seen<P: Planner>(axes: &[Axis<P>], (master, source): Values, scan: u64) -> Option<Seen> {
    let axis = axes.get(master.index())?;
    Some(match source {
        ValueSource::Actual => axis.seen_actual(scan, false),
        ValueSource::Set | ValueSource::Commanded => axis.seen(scan),
    })
}

/// The same before it moved in this scan.
fn seen_before<P: Planner>(axes: &[Axis<P>], (master, source): Values, scan: u64) -> Option<Seen> {
    let axis = axes.get(master.index())?;
    Some(match source {
        ValueSource::Actual => axis.seen_actual(scan, true),
        ValueSource::Set | ValueSource::Commanded => axis.seen_before(scan),
    })
}

/// Whether `upper` is one of `lower`, its masters, and the masters above those. The master of a command that waits
/// for a position counts, because its slave already moves after it. Masters and slaves that wait for each other would
/// have no order.
///
/// Cost: it visits all axes as many times as the longest chain has axes.
fn is_above<P: Planner>(axes: &mut [Axis<P>], upper: AxisId, lower: AxisId) -> bool {
    for axis in axes.iter_mut() {
        let is_lower = axis.id() == lower;
        axis.links_mut().set_above(is_lower);
    }
    for _ in 0..axes.len() {
        let mut is_settled = true;
        for index in 0..axes.len() {
            let Some(axis) = axes.get(index).filter(|axis| axis.links().is_above()) else {
                continue;
            };
            if axis.id() == upper {
                return true;
            }
            for master in axis.masters() {
                let new = axes
                    .get_mut(master.index())
                    .filter(|axis| !axis.links().is_above());
                if let Some(axis) = new {
                    axis.links_mut().set_above(true);
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

/// The motion step if some axis may follow another: masters first, axes of one rank in the order of their
/// numbers.
#[inline(never)]
pub(crate) fn advance<P: Planner>(axes: &mut [Axis<P>], scope: &mut Scope<'_>) {
    let is_known = axes
        .first()
        .is_some_and(|axis| axis.links().turn().among == axes.len());
    let mut is_new = !is_known || !axes.iter().all(Axis::is_settled);
    if is_new {
        prepare(axes, scope.scan);
    }
    for place in 0..axes.len() {
        let Some(Turn { index, .. }) = axes.get(place).map(|axis| axis.links().turn()) else {
            continue;
        };
        is_new |= !advance_one(axes, index, scope);
    }
    if is_new && axes.iter().any(Axis::may_bound) {
        slow_masters(axes, scope);
    }
    let some_follow = axes.iter().any(|axis| axis.links().is_bound());
    note_some_follow(axes, some_follow);
}

/// Sets whether some axis may follow another from now on. The first axis keeps this for all.
fn note_some_follow<P: Planner>(axes: &mut [Axis<P>], some_follow: bool) {
    if let Some(first) = axes.first_mut() {
        first.links_mut().set_some_follow(some_follow);
    }
}

/// Before any axis has moved in this scan, if something is new: finds the order again if it has changed,
/// and slaves note their masters.
#[inline(never)]
fn prepare<P: Planner>(axes: &mut [Axis<P>], scan: u64) {
    if !is_in_order(axes) {
        set_order(axes);
    }
    for index in 0..axes.len() {
        note_masters(axes, index, scan);
    }
}

/// Before any axis has moved in this scan: a slave for which something may be new notes its masters.
fn note_masters<P: Planner>(axes: &mut [Axis<P>], index: usize, scan: u64) {
    let Some(axis) = axes.get_mut(index).filter(|axis| !axis.is_settled()) else {
        return;
    };
    if !axis.links().is_bound() {
        return axis.settle_alone();
    }
    let Some(axis) = axes.get(index) else { return };
    let see = |values: Option<Values>| seen_before(axes, values?, scan);
    let [first, second] = axis.followed_values();
    let (first, second, awaited) = (see(first), see(second), see(axis.awaited_values()));
    for master in axis.masters() {
        if let Some(master) = axes.get_mut(master.index()) {
            master.links_mut().note_followed();
        }
    }
    let Some(axis) = axes.get_mut(index) else { return };
    if let Some(seen) = first {
        axis.note_masters([seen, second.unwrap_or_default()]);
    }
    if let Some(seen) = awaited {
        axis.note_awaited_master(seen);
    }
}

/// Collects the limits that slaves leave to their masters, for the next motion step on. It starts with
/// the lowest slaves, because the bound of a slave also limits its master.
///
/// Cost: a check of each axis. If a slave slows its master, one such pass for each rank; if a bound
/// changes, the cost of an override.
fn slow_masters<P: Planner>(axes: &mut [Axis<P>], scope: &mut Scope<'_>) {
    for axis in axes.iter_mut() {
        axis.begin_bound();
    }
    let highest = axes.iter().map(|axis| axis.links().rank()).max().unwrap_or(0);
    for rank in (0..=highest).rev() {
        for index in 0..axes.len() {
            let Some(axis) = axes.get_mut(index).filter(|axis| axis.links().rank() == rank) else {
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

/// Whether the last order is still right: each axis is in it once, and masters are above their slaves.
///
/// Cost: a check of each axis and its masters.
fn is_in_order<P: Planner>(axes: &[Axis<P>]) -> bool {
    let mut last = None;
    axes.iter().all(|axis| {
        let Turn { index, among } = axis.links().turn();
        let Some(axis) = axes.get(index) else { return false };
        let this = Some((axis.links().rank(), index));
        let is_next = this > last && among == axes.len();
        last = this;
        is_next && axis.links().rank() == rank_below(axes, axis)
    })
}

/// Finds the order in which axes move, and the number of masters above each. Masters for whose position a command
/// waits also count.
///
/// Cost: it visits all axes two times as many times as the longest chain has axes. Waiting commands may
/// close a ring, which takes one pass for each axis.
#[cold]
#[inline(never)]
fn set_order<P: Planner>(axes: &mut [Axis<P>]) {
    let (highest, count) = (set_ranks(axes), axes.len());
    let mut place = 0;
    for rank in 0..=highest {
        for index in 0..count {
            if axes.get(index).is_some_and(|axis| axis.links().rank() == rank)
                && let Some(axis) = axes.get_mut(place)
            {
                axis.links_mut().set_turn(Turn { index, among: count });
                place += 1;
            }
        }
    }
}

/// Sets the number of masters above every axis. Returns the largest.
fn set_ranks<P: Planner>(axes: &mut [Axis<P>]) -> u16 {
    for axis in axes.iter_mut() {
        axis.links_mut().set_rank(0);
    }
    let mut highest = 0;
    for _ in 0..axes.len() {
        let mut is_settled = true;
        for index in 0..axes.len() {
            let Some(axis) = axes.get(index) else { continue };
            let rank = rank_below(axes, axis);
            highest = rank.max(highest);
            if let Some(axis) = axes.get_mut(index).filter(|axis| axis.links().rank() != rank) {
                axis.links_mut().set_rank(rank);
                is_settled = false;
            }
        }
        if is_settled {
            break;
        }
    }
    highest
}

/// The rank of an axis, from the present ranks of its masters.
fn rank_below<P: Planner>(axes: &[Axis<P>], axis: &Axis<P>) -> u16 {
    if !axis.links().is_bound() {
        return 0;
    }
    let above = axis.masters().filter_map(|master| axes.get(master.index()));
    let rank = above.map(|master| master.links().rank().saturating_add(1)).max();
    rank.unwrap_or(0)
}

/// A waiting command may become active in this step. If it could not follow its master then, it gets the reason
/// before the step.
fn bar_rings<P: Planner>(axes: &mut [Axis<P>], index: usize) {
    let Some(axis) = axes.get_mut(index).filter(|axis| axis.links().is_bound()) else {
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

/// The step of one axis. Returns FALSE if something may be new for a slave, or for its masters.
#[inline(always)]
fn advance_one<P: Planner>(axes: &mut [Axis<P>], index: usize, scope: &mut Scope<'_>) -> bool {
    let Some(axis) = axes.get_mut(index) else {
        return true;
    };
    axis.note_before(scope.scan);
    if !axis.links().is_bound() {
        axis.advance(scope);
        return true;
    }
    let goes_on = goes_on(axes, index, scope);
    if !goes_on {
        advance_bound(axes, index, scope);
    }
    goes_on
}

/// The step of a slave for which nothing is new. Returns FALSE and moves nothing if something is new.
#[inline(always)]
fn goes_on<P: Planner>(axes: &mut [Axis<P>], index: usize, scope: &mut Scope<'_>) -> bool {
    let Some(master) = axes.get(index).and_then(Axis::steady_master) else {
        return false;
    };
    let Ok([slave, master]) = axes.get_disjoint_mut([index, master.index()]) else {
        return false;
    };
    let goes_on = slave.follow_steadily(master, scope);
    if !goes_on {
        slave.note_masters([master.was(), Seen::default()]);
    }
    goes_on
}

/// The step of an axis that follows another one, or may follow one.
#[inline(never)]
fn advance_bound<P: Planner>(axes: &mut [Axis<P>], index: usize, scope: &mut Scope<'_>) {
    if let Some(axis) = axes.get_mut(index) {
        axis.begin_anew();
    }
    bar_rings(axes, index);
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

/// A command that waits for a position of its master takes over when the master is there, before the step of its
/// slave.
fn start_at_point<P: Planner>(axes: &mut [Axis<P>], index: usize, scope: &mut Scope<'_>) {
    let Some(followed) = axes.get(index).and_then(Axis::awaited_values) else {
        return;
    };
    let (Some(now), turn) = (seen(axes, followed, scope.scan), turn_of(axes, followed)) else {
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

/// Runs a step of the axis at `index` with a view of these values of its masters.
fn look<P: Planner>(
    axes: &mut [Axis<P>],
    index: usize,
    (first, second): (Values, Option<Values>),
    scope: &mut Scope<'_>,
    act: impl FnOnce(&mut Axis<P>, &View<'_, P::Plan>, &mut Scope<'_>),
) {
    let (Some(now), turn) = (seen(axes, first, scope.scan), turn_of(axes, first)) else {
        return;
    };
    let seen_second = second.and_then(|second| seen(axes, second, scope.scan));
    let first_root = root(axes, first);
    let second_root = second.map(|second| root(axes, second));
    let Some((before, rest)) = axes.split_at_mut_checked(index) else {
        return;
    };
    let Some((slave, after)) = rest.split_first_mut() else {
        return;
    };
    // Never the slave itself: a command that would close a ring was refused.
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

/// The axis whose plan a master follows.
struct Root {
    /// Its index.
    axis: usize,
    /// The factor from the derivatives of that plan to those of the master.
    factor: f64,
    /// The step of this scan had another source.
    is_new: bool,
    /// Its actual values are followed, not its plan.
    is_actual: bool,
}

/// The axis whose plan a master follows, at the top of the chain of axes in gear.
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

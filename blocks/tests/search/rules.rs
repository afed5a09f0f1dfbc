//! The rules every scan must keep.

use crate::system::{Inputs, NAMES};
use standstill_axis::{AxisState, Outlook};
use standstill_blocks::BlockInstance;
use standstill_fb::{AnyInstance, Value};

/// The Boolean outputs of an instance; those it does not have are FALSE.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Shown {
    pub busy: bool,
    pub active: bool,
    pub done: bool,
    pub aborted: bool,
    pub error: bool,
    pub error_id: u16,
    pub reached: bool,
    pub status: bool,
}

impl Shown {
    pub fn of(block: &BlockInstance) -> Self {
        let read = |pin: &str| {
            let (index, _) = block.info().pin(pin)?;
            block.get(index)
        };
        let flag = |pin: &str| read(pin) == Some(Value::Bool(true));
        Self {
            busy: flag("Busy"),
            active: flag("Active"),
            done: flag("Done"),
            aborted: flag("CommandAborted"),
            error: flag("Error"),
            error_id: if let Some(Value::Word(number)) = read("ErrorID") {
                number
            } else {
                0
            },
            reached: flag("InVelocity"),
            status: flag("Status"),
        }
    }

    pub fn without_error_id(self) -> Self {
        Self { error_id: 0, ..self }
    }

    fn terminal(&self) -> bool {
        self.done || self.aborted || self.error
    }
}

/// A scan after all blocks were called.
pub struct Scene<'a> {
    pub before: &'a Inputs,
    pub inputs: &'a Inputs,
    pub was: &'a [Shown],
    pub shown: &'a [Shown],
    pub state_before: AxisState,
    pub state_at_call: AxisState,
    pub state: AxisState,
    pub powered: bool,
}

fn rule(holds: bool, id: &str, name: &str, what: &str) -> Result<(), String> {
    if holds {
        Ok(())
    } else {
        Err(format!("{id}: {name}: {what}"))
    }
}

/// Rules on what a call shows.
///
/// Covers: R21, R22, R23, R24, R28, R30, R34, R43, R60, R78, S2, S11
pub fn check_calls(scene: &Scene<'_>, kinds: [&str; 4]) -> Result<(), String> {
    let executes = |inputs: &Inputs, name: &str| match name {
        "first" => inputs.execute[0],
        "second" => inputs.execute[1],
        _ => inputs.stop,
    };
    for (place, name) in NAMES.iter().enumerate().filter(|(_, name)| **name != "power") {
        let (was, now) = (&scene.was[place], &scene.shown[place]);
        let (executed, execute) = (executes(scene.before, name), executes(scene.inputs, name));
        let ended = [now.busy, now.done, now.aborted, now.error];
        let count = ended.iter().filter(|flag| **flag).count();
        rule(
            count <= 1,
            "R21",
            name,
            "more than one of Busy, Done, CommandAborted, Error",
        )?;
        rule(
            !execute || count == 1,
            "R22",
            name,
            "Execute without any of Busy, Done, CommandAborted, Error",
        )?;
        rule(
            !(now.active && now.terminal()),
            "R23",
            name,
            "Active beside a terminal output",
        )?;
        rule(!now.active || now.busy, "R24", name, "Active without Busy")?;
        rule(
            now.error == (now.error_id != 0),
            "R34",
            name,
            "Error and ErrorID disagree",
        )?;
        rule(
            !now.reached || (now.active && now.busy),
            "R43",
            name,
            "InVelocity without Active and Busy",
        )?;
        let rising = execute && !executed;
        rule(
            !rising || now.busy || now.error,
            "R24",
            name,
            "neither Busy nor Error at the rising edge",
        )?;
        rule(
            execute || !was.terminal() || !now.terminal() || was.busy,
            "R30",
            name,
            "a terminal output stays longer than one call without Execute",
        )?;
        rule(
            !execute || rising || !was.terminal() || was == now,
            "R28",
            name,
            "a result changes while Execute is TRUE",
        )?;
        let refusing = matches!(scene.state_at_call, AxisState::Disabled | AxisState::ErrorStop);
        rule(
            !(rising && refusing) || now.error || kinds[place] == "MC_HaltSuperimposed",
            "R78",
            name,
            "a command is accepted without power or in ErrorStop",
        )?;
    }
    let stop = &scene.shown[2];
    rule(
        !(stop.done && scene.inputs.stop && scene.was[2].done && scene.state_at_call == AxisState::Stopping)
            || scene.state == AxisState::Stopping
            || !scene.inputs.enable,
        "S2",
        "stop",
        "the axis leaves Stopping while MC_Stop.Execute is TRUE",
    )?;
    rule(
        scene.shown[0].status == scene.powered,
        "R60",
        "power",
        "Status is not that of the power stage",
    )?;
    let jump = (scene.state_before, scene.state);
    rule(
        scene.state_before != AxisState::ErrorStop
            || matches!(
                scene.state,
                AxisState::ErrorStop | AxisState::Disabled | AxisState::Standstill
            )
            || scene.state_at_call != AxisState::ErrorStop,
        "S11",
        "axis",
        &format!("{jump:?} without MC_Reset"),
    )
}

/// Rules on what is so after the motion step, whichever instance was called when.
///
/// Covers: R25, R47, R48, R50, R77, S1
pub fn check_truth(polled: &[Shown], axis: &Outlook, kinds: [&str; 4]) -> Result<(), String> {
    let state = axis.state;
    let owned = axis.owner.is_some();
    let waiting = axis.waiting.iter().flatten().count();
    let beside = |place: usize| kinds[place].ends_with("Superimposed");
    let active_of = |superimposed: bool| {
        let of_kind = polled
            .iter()
            .enumerate()
            .filter(|(place, _)| beside(*place) == superimposed);
        of_kind.filter(|(_, shown)| shown.active).count()
    };
    let active = active_of(false) + active_of(true);
    rule(
        active_of(false) <= 1 && active_of(true) <= 1,
        "R48",
        "axis",
        "two commands are Active",
    )?;
    // What is superimposed, and whether it waits for room.
    let added = axis
        .superimposed
        .and_then(|added| added.command)
        .map(|(.., planned)| planned);
    rule(
        active_of(true) == usize::from(added == Some(true)),
        "R51",
        "axis",
        "Active is not whether the added motion is the block's",
    )?;
    let idle = matches!(
        state,
        AxisState::Disabled | AxisState::Standstill | AxisState::ErrorStop
    );
    rule(
        !(idle && owned),
        "S1",
        "axis",
        &format!("{state:?} with an owner"),
    )?;
    rule(
        !idle || active == 0,
        "R47",
        "axis",
        &format!("{state:?} with an Active block"),
    )?;
    let moving = matches!(
        state,
        AxisState::Homing | AxisState::DiscreteMotion | AxisState::ContinuousMotion
    );
    rule(
        !moving || owned || (state == AxisState::DiscreteMotion && added.is_some()),
        "R25",
        "axis",
        &format!("{state:?} without an owner"),
    )?;
    rule(
        !idle || waiting == 0,
        "R77",
        "axis",
        &format!("{state:?} with a waiting command"),
    )?;
    // MC_Stop has no Active output: it is Busy while it owns the axis.
    let stopping = owned && state == AxisState::Stopping;
    let inactive = polled.iter().filter(|shown| shown.busy && !shown.active).count();
    rule(
        inactive <= waiting + usize::from(stopping) + usize::from(added == Some(false)),
        "R50",
        "axis",
        "an instance is Busy with a command that neither owns the axis nor waits",
    )
}

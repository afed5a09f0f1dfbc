//! The rules for every scan: those of `standstill-soak`, which also check random programs, and some that
//! only apply to this system of blocks.

use crate::system::{Inputs, NAMES};
use standstill_axis::{AxisState, Outlook, WorkKind};
use standstill_soak::rules::{Call, Held, Kind, Shown, Truth, check_call, check_truth};

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
/// Covers: R19, R21, R22, R23, R24, R28, R30, R34, R43, R60, R78, S2, S11
pub fn calls(scene: &Scene<'_>, kinds: [Kind; 4]) -> Result<(), String> {
    let triggers = |inputs: &Inputs, name: &str| match name {
        "power" => inputs.enable,
        "first" => inputs.execute[0],
        "second" => inputs.execute[1],
        _ => inputs.stop,
    };
    let refusing = matches!(scene.state_at_call, AxisState::Disabled | AxisState::ErrorStop);
    for (place, name) in NAMES.iter().enumerate() {
        let call = Call {
            kind: kinds[place],
            executed: triggers(scene.before, name),
            execute: triggers(scene.inputs, name),
            was: scene.was[place],
            now: scene.shown[place],
            refusing,
            powered: scene.powered,
        };
        check_call(&call).map_err(|broken| format!("{}: {name}: {}", broken.id, broken.what))?;
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

/// Rules on the state after the motion step, independent of the order of calls.
///
/// Covers: R25, R47, R48, R50, R51, R77, S1
pub fn truth(polled: &[Shown], axis: &Outlook, kinds: [Kind; 4]) -> Result<(), String> {
    let owned = axis.owner.is_some();
    let [first, ..] = axis.waiting;
    let truth = Truth {
        state: axis.state,
        owned,
        // MC_Stop has no Active output: it is Busy while it owns the axis.
        stopping: owned && axis.state == AxisState::Stopping,
        waiting: axis.waiting.iter().flatten().count(),
        awaited: false,
        shift_due: first.is_some_and(|(_, kind, _)| kind == WorkKind::SetPosition),
        // What is superimposed, and whether it waits for room.
        added: axis
            .superimposed
            .and_then(|added| added.command)
            .map(|(.., planned)| planned),
        orphaned: false,
    };
    let held = polled.iter().zip(kinds).map(|(shown, kind)| Held {
        superimposed: kind.is_superimposed(),
        busy: shown.busy,
        active: shown.active,
    });
    check_truth(&truth, held).map_err(|broken| format!("{}: axis: {}: {axis:?}", broken.id, broken.what))
}

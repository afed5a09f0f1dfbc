//! Scans in which the programs are idle: each block would repeat what it did in the scan before, so none is called.
//!
//! The conditions are: no step is due, all variables and pins have the values of the scan before, and every axis
//! only continues ([`Going`]). Two scans with the same values are enough to know that a block keeps its values in a
//! third one, because its conditions ([`manner`]) have not changed. Blocks that read numbers of an axis are still
//! called. No other block may depend on their outputs.

use super::bench::ScriptMachine;
use super::values::Values;
use crate::model::{Instance, Point, Script};
use standstill_axis::Going;
use standstill_drives::simulated::{DriveSetup, IdealDriveSetup, PlantSetup};
use standstill_drives::switches::Switches;
use standstill_fb::AnyInstance;
use std::collections::BTreeSet;

/// The data on which the outputs and the effects of a block depend, in addition to its inputs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Manner {
    /// Its memory, the states of axes and commands, and a time that shows at its outputs.
    Waits,
    /// The same. It also acts on its axis by the levels of its inputs, so two of them would act in turns.
    Holds,
    /// Numbers of an axis, which it reads and does not change.
    Reads,
    /// Anything else: a script with such a block calls its blocks in every scan.
    Acts,
}

/// The manner of a block. None for a block that is not listed; a test demands that each block is.
fn manner(block: &str) -> Option<Manner> {
    Some(match block {
        "MC_Power" | "MC_SetOverride" => Manner::Holds,
        "MC_ReadActualPosition"
        | "MC_ReadActualVelocity"
        | "MC_ReadActualTorque"
        | "MC_ReadMotionState"
        | "MC_ReadAxisInfo" => Manner::Reads,
        "MC_Reset"
        | "MC_ReadStatus"
        | "MC_ReadAxisError"
        | "MC_Home"
        | "MC_Stop"
        | "MC_Halt"
        | "MC_MoveAbsolute"
        | "MC_MoveRelative"
        | "MC_MoveAdditive"
        | "MC_MoveVelocity"
        | "MC_MoveContinuousAbsolute"
        | "MC_MoveContinuousRelative"
        | "MC_MoveSuperimposed"
        | "MC_HaltSuperimposed"
        | "MC_Jog"
        | "R_TRIG"
        | "F_TRIG"
        | "SR"
        | "RS"
        | "CTU"
        | "CTD"
        | "CTUD"
        | "TON"
        | "TOF"
        | "TP" => Manner::Waits,
        "MC_SetPosition"
        | "MC_ReadParameter"
        | "MC_ReadBoolParameter"
        | "MC_WriteParameter"
        | "MC_WriteBoolParameter"
        | "MC_ReadDigitalInput"
        | "MC_ReadDigitalOutput"
        | "MC_WriteDigitalOutput"
        | "MC_TouchProbe"
        | "MC_AbortTrigger"
        | "MC_DigitalCamSwitch"
        | "MC_TorqueControl"
        | "MC_PositionProfile"
        | "MC_VelocityProfile"
        | "MC_AccelerationProfile"
        | "MC_CombineAxes"
        | "MC_CamTableSelect"
        | "MC_CamIn"
        | "MC_CamOut"
        | "MC_GearIn"
        | "MC_GearInPos"
        | "MC_GearOut"
        | "MC_PhasingAbsolute"
        | "MC_PhasingRelative" => Manner::Acts,
        _ => return None,
    })
}

/// The state of the programs of a run: idle or not.
pub(super) struct Rest {
    /// The instances that are still called.
    readers: Vec<usize>,
    /// The other ones.
    waiting: Vec<usize>,
    /// The state of the axes after the calls of the last scan.
    going: Vec<Going>,
    /// The number of records at the begin of the last scan.
    records: u64,
    /// The last scan had an input from outside.
    disturbed: bool,
    /// The scan after which `words` were taken: those of the variables and of the waiting instances.
    taken: Option<u64>,
    words: Vec<u64>,
    /// Memory for the next words.
    next: Vec<u64>,
}

impl Rest {
    /// None if the programs of a script, or their environment, may do something new in any scan.
    pub(super) fn new(script: &Script) -> Option<Self> {
        let is_told = script.programs.is_empty()
            && script.formulas.is_empty()
            && script
                .axes
                .iter()
                .all(|axis| !axis.on_cam && is_quiet(&axis.drive));
        let called = |index: &usize| script.blocks.get(*index).is_some_and(|it| !it.left_out);
        let manner_of = |index: &usize| script.blocks.get(*index).and_then(|it| manner(it.block.name));
        let all: Vec<usize> = (0..script.blocks.len()).filter(called).collect();
        let is_idle = |index: &usize| manner_of(index).is_some_and(|manner| manner != Manner::Acts);
        let is_known = all.iter().all(is_idle);
        let (readers, waiting): (Vec<usize>, Vec<usize>) =
            (all.iter()).partition(|index| manner_of(index) == Some(Manner::Reads));
        let mut holding = waiting
            .iter()
            .filter(|index| manner_of(index) == Some(Manner::Holds));
        let mut held = BTreeSet::new();
        let act_alone = holding.all(|index| held.insert(script.blocks.get(*index).map(named_axis)));
        let reads = |point: &Point| matches!(point, Point::Pin(index, _) if readers.contains(index));
        let wires = script.blocks.iter().flat_map(|it| &it.wires);
        let are_apart = !wires.flat_map(|(_, wire)| wire.points()).any(reads);
        (is_told && is_known && act_alone && are_apart).then(|| Self {
            readers,
            waiting,
            going: Vec::with_capacity(script.axes.len()),
            records: 0,
            disturbed: true,
            taken: None,
            words: Vec::new(),
            next: Vec::new(),
        })
    }

    /// The instances that are still called.
    pub(super) fn readers(&self) -> &[usize] {
        &self.readers
    }

    /// Call it at the begin of a scan; `disturbed` means an input from outside.
    pub(super) fn begin(&mut self, machine: &ScriptMachine, disturbed: bool) {
        self.disturbed = disturbed;
        self.records = machine.log().total();
    }

    /// Call it after all blocks were called.
    pub(super) fn called(&mut self, machine: &ScriptMachine) {
        self.going.clear();
        self.going.extend(machine.axes().iter().map(|axis| axis.going()));
    }

    /// Whether the programs are idle from the scan after `scan` on, as long as [`Rest::lasts`] and no step is due.
    pub(super) fn begins(&mut self, scan: u64, values: &Values, machine: &ScriptMachine) -> bool {
        if self.disturbed || !self.lasts(machine) {
            return false;
        }
        self.next.clear();
        self.next
            .extend(values.variables.iter().map(|value| value.word()));
        for instance in self
            .waiting
            .iter()
            .filter_map(|index| values.instances.get(*index))
        {
            let first = self.next.len();
            self.next.resize(first + instance.info().pins().count(), 0);
            instance.put_words(self.next.get_mut(first..).unwrap_or_default());
        }
        std::mem::swap(&mut self.words, &mut self.next);
        let before = self.taken.replace(scan);
        before.is_some_and(|before| before + 1 == scan) && self.words == self.next
    }

    /// Counts scans that were done without the programs.
    pub(super) fn went_on(&mut self, scans: u64) {
        self.taken = self.taken.map(|scan| scan + scans);
    }

    /// Whether an event occurred that could not be foreseen, so that the programs were not idle.
    pub(super) fn is_broken(&self, machine: &ScriptMachine) -> bool {
        let is_known = machine.axes().iter().all(|axis| axis.going() != Going::Unknown);
        !is_known || machine.log().total() != self.records
    }

    /// Whether the programs stay idle in the next scan: each axis does what it did before.
    pub(super) fn lasts(&self, machine: &ScriptMachine) -> bool {
        let axes = machine.axes().iter();
        let go_on = axes
            .zip(&self.going)
            .all(|(axis, before)| before.is_onward() && axis.going() == *before);
        go_on && self.going.len() == machine.axes().len() && machine.log().total() == self.records
    }

    /// Whether all axes are at rest.
    pub(super) fn is_still(&self) -> bool {
        self.going.iter().all(|going| *going == Going::Rests)
    }

    /// Number of scans in which the axes can move without their drives. The conditions are: nothing reads the
    /// reports of the drives, no axis has turns, and the next few scans with drives restore the memory of both.
    pub(super) fn moves_alone(&self, machine: &ScriptMachine) -> u64 {
        let axes = machine.axes();
        if !self.readers.is_empty() || axes.iter().any(|axis| axis.config().modulo.is_some()) {
            return 0;
        }
        axes.iter().map(|axis| axis.goes_on_for()).min().unwrap_or(0)
    }
}

/// Whether a drive reports nothing new except positions unless a step disturbs it.
fn is_quiet(drive: &DriveSetup) -> bool {
    match drive {
        DriveSetup::Ideal(IdealDriveSetup { switches, .. })
        | DriveSetup::Plant(PlantSetup { switches, .. }) => *switches == Switches::NONE,
        DriveSetup::Cia402(_) => false,
    }
}

/// The name of a block, and the axis at its first pin.
fn named_axis(instance: &Instance) -> (&'static str, Option<u64>) {
    let axis = instance.constants.iter().find(|(pin, _)| *pin == 0);
    (instance.block.name, axis.map(|(_, value)| value.word()))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A block that is forgotten there would make every run with it slow, without a failing test.
    #[test]
    fn every_block_is_listed() {
        for info in standstill_blocks::REGISTRY {
            assert!(
                manner(info.name).is_some(),
                "{} is not in `manner` of crates/script/src/run/rest.rs: list it with `Acts`, or with the manner that it has",
                info.name
            );
        }
    }
}

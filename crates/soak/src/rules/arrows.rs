//! States change only along the arrows of the state diagram, and each arrow belongs to a part of a scan.

use super::{Broken, rule};
use standstill_axis::{ARROWS, AxisEvent, AxisState};

/// The parts of a scan in which a state may change.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Script steps and the drive's feedback.
    Feedback,
    /// One call of a block.
    Call,
    /// A call in which a command starts or fails that was given before: a profile gives its points, or MC_Power lets a
    /// paused command go on.
    DueCall,
    /// The motion step.
    Motion,
}

impl Part {
    /// Events that may happen in it, and how many in a row: a hand-over is MotionDone and a start.
    const fn events(self) -> (&'static [AxisEvent], usize) {
        use AxisEvent as E;
        match self {
            Self::Feedback => (
                // A queued MC_SetPosition takes effect before the blocks, and the command behind it
                // starts.
                &[
                    E::PowerOn,
                    E::PowerOff,
                    E::Fault,
                    E::ResetPowered,
                    E::ResetUnpowered,
                    E::StartDiscrete,
                    E::StartContinuous,
                    E::StartSynchronized,
                    E::StartHoming,
                ],
                2,
            ),
            Self::Call => (
                &[
                    E::StartHoming,
                    E::StartDiscrete,
                    E::StartContinuous,
                    E::StartSynchronized,
                    E::Stop,
                    E::StopReleased,
                ],
                1,
            ),
            // A command that cannot start is replaced by the next one. If there is none, an axis in motion fails: the
            // arrow of an error starts at every state (note 1 of the diagram).
            Self::DueCall => (
                &[
                    E::MotionDone,
                    E::StartHoming,
                    E::StartDiscrete,
                    E::StartContinuous,
                    E::StartSynchronized,
                    E::Stop,
                    E::Fault,
                ],
                2,
            ),
            Self::Motion => (
                &[
                    E::MotionDone,
                    E::StopReleased,
                    E::Stop,
                    E::StartHoming,
                    E::StartDiscrete,
                    E::StartContinuous,
                    E::StartSynchronized,
                    E::Fault,
                    E::ResetPowered,
                    E::ResetUnpowered,
                ],
                3,
            ),
        }
    }
}

/// For each part of a scan and each state, the states it may change to, as bits.
#[derive(Clone, Debug)]
pub struct Reach([[u16; 8]; 4]);

const fn bit(state: AxisState) -> u16 {
    1 << state as u16
}

impl Default for Reach {
    fn default() -> Self {
        let mut reach = [[0; 8]; 4];
        for part in [Part::Feedback, Part::Call, Part::DueCall, Part::Motion] {
            let (events, most) = part.events();
            for from in AxisState::ALL {
                let mut found = bit(*from);
                for _ in 0..most {
                    let arrows = ARROWS.iter().filter(|arrow| events.contains(&arrow.on));
                    let further = arrows.filter(|arrow| found & bit(arrow.from) != 0);
                    found |= further.map(|arrow| bit(arrow.to)).fold(0, |all, one| all | one);
                }
                reach[part as usize][*from as usize] = found;
            }
        }
        Self(reach)
    }
}

impl Reach {
    /// Whether arrows lead from one state to the other in this part of a scan.
    ///
    /// # Errors
    /// They do not.
    #[inline]
    pub fn check(&self, part: Part, from: AxisState, to: AxisState) -> Result<(), Broken> {
        let drawn = self.0[part as usize][from as usize] & bit(to) != 0;
        rule(drawn, "S3", "the state changes along no arrow")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_drawn_arrows_of_the_part_are_followed() {
        use AxisState as S;
        let reach = Reach::default();
        assert!(reach.check(Part::Call, S::Standstill, S::DiscreteMotion).is_ok());
        assert!(reach.check(Part::Call, S::Standstill, S::Disabled).is_err());
        assert!(reach.check(Part::Call, S::ErrorStop, S::Standstill).is_err());
        assert!(
            reach
                .check(Part::Call, S::ContinuousMotion, S::ErrorStop)
                .is_err()
        );
        assert!(
            reach
                .check(Part::DueCall, S::ContinuousMotion, S::ErrorStop)
                .is_ok()
        );
        assert!(
            reach
                .check(Part::DueCall, S::ErrorStop, S::DiscreteMotion)
                .is_err()
        );
        assert!(reach.check(Part::Motion, S::Stopping, S::DiscreteMotion).is_ok());
        assert!(reach.check(Part::Call, S::Homing, S::DiscreteMotion).is_err());
        assert!(reach.check(Part::Feedback, S::Disabled, S::Standstill).is_ok());
        assert!(
            reach
                .check(Part::Feedback, S::Homing, S::ContinuousMotion)
                .is_err()
        );
    }
}

//! The PLCopen axis state machine: the function that runs, and the standard's arrows as data beside it.
//!
//! Source: PLCopen Motion Control Part 1, section on the state diagram and its notes 1 to 6. A test compares
//! the two over all pairs, so a slip in either shows.

macro_rules! all_of {
    ($(#[$meta:meta])* $name:ident { $($(#[$doc:meta])* $variant:ident,)* }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum $name { $($(#[$doc])* $variant,)* }

        impl $name {
            /// Every one of them, in declaration order.
            pub const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// The name in text.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => stringify!($variant)),* }
            }
        }
    };
}

all_of! {
    /// The state of an axis; it is always in exactly one.
    AxisState {
        /// Power off, no error.
        Disabled,
        /// Power on, no error, no motion command active.
        Standstill,
        /// MC_Home owns the axis.
        Homing,
        /// A motion with a defined end.
        DiscreteMotion,
        /// A motion without an end.
        ContinuousMotion,
        /// The axis follows a master.
        SynchronizedMotion,
        /// MC_Stop owns the axis, or it is ramping down to be switched off.
        Stopping,
        /// An axis error is pending.
        ErrorStop,
    }
}

all_of! {
    /// An event of an axis, after conditions such as "powered?" have been evaluated.
    AxisEvent {
        /// Operation is enabled: MC_Power.Enable and Status are TRUE.
        PowerOn,
        /// Power has been switched off on request.
        PowerOff,
        /// An axis error occurred.
        Fault,
        /// MC_Reset succeeded with power on and wanted.
        ResetPowered,
        /// MC_Reset succeeded with power off.
        ResetUnpowered,
        /// A homing command was accepted.
        StartHoming,
        /// A motion with an end was accepted.
        StartDiscrete,
        /// A motion without an end was accepted.
        StartContinuous,
        /// A coupling to a master was accepted.
        StartSynchronized,
        /// MC_Stop was accepted, or the ramp before switching off began.
        Stop,
        /// MC_Stop is done and no longer held.
        StopReleased,
        /// The owner finished and nothing is buffered.
        MotionDone,
    }
}

/// The standard has no arrow for this event from this state.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Refused;

/// The state after `event`, or [`Refused`] where the standard has no arrow.
pub const fn next(state: AxisState, event: AxisEvent) -> Result<AxisState, Refused> {
    use {AxisEvent as E, AxisState as S};
    match state {
        S::Disabled => match event {
            E::PowerOn => Ok(S::Standstill),
            E::PowerOff => Ok(S::Disabled),
            E::Fault => Ok(S::ErrorStop),
            E::ResetPowered
            | E::ResetUnpowered
            | E::StartHoming
            | E::StartDiscrete
            | E::StartContinuous
            | E::StartSynchronized
            | E::Stop
            | E::StopReleased
            | E::MotionDone => Err(Refused),
        },
        S::Standstill => match event {
            E::PowerOff => Ok(S::Disabled),
            E::Fault => Ok(S::ErrorStop),
            E::StartHoming => Ok(S::Homing),
            E::StartDiscrete => Ok(S::DiscreteMotion),
            E::StartContinuous => Ok(S::ContinuousMotion),
            E::StartSynchronized => Ok(S::SynchronizedMotion),
            E::Stop => Ok(S::Stopping),
            E::PowerOn | E::ResetPowered | E::ResetUnpowered | E::StopReleased | E::MotionDone => {
                Err(Refused)
            }
        },
        S::Homing => match event {
            E::PowerOff => Ok(S::Disabled),
            E::Fault => Ok(S::ErrorStop),
            E::StartHoming => Ok(S::Homing),
            E::Stop => Ok(S::Stopping),
            E::MotionDone => Ok(S::Standstill),
            E::PowerOn
            | E::ResetPowered
            | E::ResetUnpowered
            | E::StartDiscrete
            | E::StartContinuous
            | E::StartSynchronized
            | E::StopReleased => Err(Refused),
        },
        S::DiscreteMotion => match event {
            E::MotionDone => Ok(S::Standstill),
            E::PowerOff
            | E::Fault
            | E::StartDiscrete
            | E::StartContinuous
            | E::StartSynchronized
            | E::Stop
            | E::PowerOn
            | E::ResetPowered
            | E::ResetUnpowered
            | E::StartHoming
            | E::StopReleased => in_any_motion(event),
        },
        S::ContinuousMotion | S::SynchronizedMotion => in_any_motion(event),
        S::Stopping => match event {
            E::PowerOff => Ok(S::Disabled),
            E::Fault => Ok(S::ErrorStop),
            E::Stop => Ok(S::Stopping),
            E::StopReleased => Ok(S::Standstill),
            E::PowerOn
            | E::ResetPowered
            | E::ResetUnpowered
            | E::StartHoming
            | E::StartDiscrete
            | E::StartContinuous
            | E::StartSynchronized
            | E::MotionDone => Err(Refused),
        },
        S::ErrorStop => match event {
            E::Fault => Ok(S::ErrorStop),
            E::ResetPowered => Ok(S::Standstill),
            E::ResetUnpowered => Ok(S::Disabled),
            E::PowerOn
            | E::PowerOff
            | E::StartHoming
            | E::StartDiscrete
            | E::StartContinuous
            | E::StartSynchronized
            | E::Stop
            | E::StopReleased
            | E::MotionDone => Err(Refused),
        },
    }
}

/// The common part of the three motion states.
const fn in_any_motion(event: AxisEvent) -> Result<AxisState, Refused> {
    use {AxisEvent as E, AxisState as S};
    match event {
        E::PowerOff => Ok(S::Disabled),
        E::Fault => Ok(S::ErrorStop),
        E::StartDiscrete => Ok(S::DiscreteMotion),
        E::StartContinuous => Ok(S::ContinuousMotion),
        E::StartSynchronized => Ok(S::SynchronizedMotion),
        E::Stop => Ok(S::Stopping),
        E::PowerOn
        | E::ResetPowered
        | E::ResetUnpowered
        | E::StartHoming
        | E::StopReleased
        | E::MotionDone => Err(Refused),
    }
}

/// One arrow of the state diagram.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arrow {
    /// The state in which it starts.
    pub from: AxisState,
    /// The event that it stands for.
    pub on: AxisEvent,
    /// The state in which it ends.
    pub to: AxisState,
    /// The note of the diagram, or the purpose of the arrow.
    pub note: &'static str,
}

const fn arrow(from: AxisState, on: AxisEvent, to: AxisState, note: &'static str) -> Arrow {
    Arrow { from, on, to, note }
}

/// The arrows of the standard's diagram, copied by eye.
pub const ARROWS: &[Arrow] = {
    use {AxisEvent as E, AxisState as S};
    &[
        // Note 1: any state to ErrorStop.
        arrow(S::Disabled, E::Fault, S::ErrorStop, "note 1"),
        arrow(S::Standstill, E::Fault, S::ErrorStop, "note 1"),
        arrow(S::Homing, E::Fault, S::ErrorStop, "note 1"),
        arrow(S::DiscreteMotion, E::Fault, S::ErrorStop, "note 1"),
        arrow(S::ContinuousMotion, E::Fault, S::ErrorStop, "note 1"),
        arrow(S::SynchronizedMotion, E::Fault, S::ErrorStop, "note 1"),
        arrow(S::Stopping, E::Fault, S::ErrorStop, "note 1"),
        arrow(S::ErrorStop, E::Fault, S::ErrorStop, "note 1"),
        // Note 2: any state without an axis error to Disabled.
        arrow(S::Disabled, E::PowerOff, S::Disabled, "note 2"),
        arrow(S::Standstill, E::PowerOff, S::Disabled, "note 2"),
        arrow(S::Homing, E::PowerOff, S::Disabled, "note 2"),
        arrow(S::DiscreteMotion, E::PowerOff, S::Disabled, "note 2"),
        arrow(S::ContinuousMotion, E::PowerOff, S::Disabled, "note 2"),
        arrow(S::SynchronizedMotion, E::PowerOff, S::Disabled, "note 2"),
        arrow(S::Stopping, E::PowerOff, S::Disabled, "note 2"),
        // Notes 3 to 6.
        arrow(S::ErrorStop, E::ResetUnpowered, S::Disabled, "note 3"),
        arrow(S::ErrorStop, E::ResetPowered, S::Standstill, "note 4"),
        arrow(S::Disabled, E::PowerOn, S::Standstill, "note 5"),
        arrow(S::Stopping, E::StopReleased, S::Standstill, "note 6"),
        // From Standstill by a command.
        arrow(S::Standstill, E::StartHoming, S::Homing, "command"),
        arrow(S::Standstill, E::StartDiscrete, S::DiscreteMotion, "command"),
        arrow(S::Standstill, E::StartContinuous, S::ContinuousMotion, "command"),
        arrow(
            S::Standstill,
            E::StartSynchronized,
            S::SynchronizedMotion,
            "command",
        ),
        arrow(S::Standstill, E::Stop, S::Stopping, "command"),
        // Homing. A second MC_Home takes over: our choice, V11.
        arrow(S::Homing, E::StartHoming, S::Homing, "command"),
        arrow(S::Homing, E::Stop, S::Stopping, "command"),
        arrow(S::Homing, E::MotionDone, S::Standstill, "done"),
        // Between the motion states.
        arrow(S::DiscreteMotion, E::StartDiscrete, S::DiscreteMotion, "command"),
        arrow(
            S::DiscreteMotion,
            E::StartContinuous,
            S::ContinuousMotion,
            "command",
        ),
        arrow(
            S::DiscreteMotion,
            E::StartSynchronized,
            S::SynchronizedMotion,
            "command",
        ),
        arrow(S::DiscreteMotion, E::Stop, S::Stopping, "command"),
        arrow(S::DiscreteMotion, E::MotionDone, S::Standstill, "done"),
        arrow(
            S::ContinuousMotion,
            E::StartDiscrete,
            S::DiscreteMotion,
            "command",
        ),
        arrow(
            S::ContinuousMotion,
            E::StartContinuous,
            S::ContinuousMotion,
            "command",
        ),
        arrow(
            S::ContinuousMotion,
            E::StartSynchronized,
            S::SynchronizedMotion,
            "command",
        ),
        arrow(S::ContinuousMotion, E::Stop, S::Stopping, "command"),
        arrow(
            S::SynchronizedMotion,
            E::StartDiscrete,
            S::DiscreteMotion,
            "command",
        ),
        arrow(
            S::SynchronizedMotion,
            E::StartContinuous,
            S::ContinuousMotion,
            "command",
        ),
        arrow(
            S::SynchronizedMotion,
            E::StartSynchronized,
            S::SynchronizedMotion,
            "command",
        ),
        arrow(S::SynchronizedMotion, E::Stop, S::Stopping, "command"),
        // The same MC_Stop instance again with other values: V7a.
        arrow(S::Stopping, E::Stop, S::Stopping, "command"),
    ]
};

#[cfg(test)]
mod tests {
    use super::*;

    /// Covers: S3, S4, S10
    #[test]
    fn code_and_arrows_agree_on_every_state_and_event() {
        for &state in AxisState::ALL {
            for &event in AxisEvent::ALL {
                let mut arrows = ARROWS.iter().filter(|a| a.from == state && a.on == event);
                let drawn = arrows.next().map(|a| a.to).ok_or(Refused);
                assert!(arrows.next().is_none(), "two arrows leave {state:?} on {event:?}");
                assert_eq!(next(state, event), drawn, "{state:?} on {event:?}");
            }
        }
    }
}

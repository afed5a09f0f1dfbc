//! Pins that several blocks have, with the methods for them. A block's table names a group as `..name;`.
//!
//! | group | section | pins |
//! | --- | --- | --- |
//! | `rates` | `inputs` | Acceleration, Deceleration, Jerk; the block has Snap too |
//! | `snap` | `vendor_inputs` | Snap |
//! | `motion` | `outputs` | Busy, Active, CommandAborted, Error, ErrorID |
//! | `coupling` | `outputs` | the same of a slave |
//! | `queued` | `outputs` | Busy, Error, ErrorID of a block that moves nothing and may wait in the buffer |
//! | `reading` | `outputs` | Valid, Busy, Error, ErrorID |

/// Puts the pins of a group in front of the remaining rows of its section, for [`pins!`](crate::pins).
#[doc(hidden)]
#[macro_export]
macro_rules! pin_group {
    (rates $done:tt $rows:tt { $($left:tt)* } $($later:tt)*) => {
        impl Inputs {
            /// The requested dynamics, with the largest velocity `velocity` (u/s).
            #[inline]
            fn dynamics(&self, velocity: f64) -> $crate::Dynamics {
                $crate::Dynamics {
                    velocity,
                    acceleration: self.acceleration,
                    deceleration: self.deceleration,
                    jerk: self.jerk,
                    snap: self.snap,
                }
            }
        }

        $crate::pins!(@rows $done $rows {
            /// Rate while the speed grows; 0 takes the axis default.
            Acceleration => acceleration: f64 = 0.0, "u/s^2";
            /// Rate while the speed falls; 0 takes the axis default.
            Deceleration => deceleration: f64 = 0.0, "u/s^2";
            /// Jerk; 0 takes the axis default, and no limit if there is none.
            Jerk => jerk: f64 = 0.0, "u/s^3";
            $($left)*
        } $($later)*);
    };
    (snap $done:tt $rows:tt { $($left:tt)* } $($later:tt)*) => {
        $crate::pins!(@rows $done $rows {
            /// Snap; 0 takes the axis default, and no limit if there is none.
            Snap => snap: f64 = 0.0, "u/s^4";
            $($left)*
        } $($later)*);
    };
    (motion $done:tt $rows:tt { $($left:tt)* } $($later:tt)*) => {
        $crate::pin_group!(@phase "The block controls the axis." $done $rows { $($left)* } $($later)*);
    };
    (coupling $done:tt $rows:tt { $($left:tt)* } $($later:tt)*) => {
        $crate::pin_group!(@phase "The block controls the slave." $done $rows { $($left)* } $($later)*);
    };
    (@phase $active:literal $done:tt $rows:tt { $($left:tt)* } $($later:tt)*) => {
        impl From<$crate::Phase> for Outputs {
            #[inline]
            fn from(phase: $crate::Phase) -> Self {
                let none = Self::default();
                match phase.fate() {
                    None | Some($crate::Fate::Done) => none,
                    Some($crate::Fate::Waiting) => Self { busy: true, ..none },
                    Some($crate::Fate::Active { .. }) => Self {
                        busy: true,
                        active: true,
                        ..none
                    },
                    Some($crate::Fate::Aborted) => Self {
                        command_aborted: true,
                        ..none
                    },
                    Some($crate::Fate::Failed(error_id)) => Self {
                        error: true,
                        error_id,
                        ..none
                    },
                }
            }
        }

        $crate::pins!(@rows $done $rows {
            /// Not finished.
            Busy => busy: bool, "";
            #[doc = $active]
            Active => active: bool, "";
            /// Interrupted by another command.
            CommandAborted => command_aborted: bool, "";
            /// Refused, or ended by an error.
            Error => error: bool, "";
            /// Why; 0 without an error.
            ErrorID => error_id: $crate::ErrorId, "";
            $($left)*
        } $($later)*);
    };
    (queued $done:tt $rows:tt { $($left:tt)* } $($later:tt)*) => {
        impl From<$crate::Phase> for Outputs {
            #[inline]
            fn from(phase: $crate::Phase) -> Self {
                Self {
                    busy: phase.is_busy(),
                    // It has no CommandAborted: removed from the buffer it was never executed, which is an error.
                    error: phase.is_error() || phase.is_aborted(),
                    error_id: if phase.is_aborted() {
                        $crate::ErrorId::RemovedFromBuffer
                    } else {
                        phase.error_id()
                    },
                    ..Self::default()
                }
            }
        }

        $crate::pins!(@rows $done $rows {
            /// Waiting in the buffer.
            Busy => busy: bool, "";
            /// Refused, or removed from the buffer.
            Error => error: bool, "";
            /// Why; 0 without an error.
            ErrorID => error_id: $crate::ErrorId, "";
            $($left)*
        } $($later)*);
    };
    (reading $done:tt $rows:tt { $($left:tt)* } $($later:tt)*) => {
        impl<T: Default> From<&$crate::Reading<T>> for Outputs {
            #[inline]
            fn from(reading: &$crate::Reading<T>) -> Self {
                Self {
                    valid: reading.is_valid(),
                    busy: reading.is_busy(),
                    error: reading.is_error(),
                    error_id: reading.error_id(),
                    ..Self::default()
                }
            }
        }

        $crate::pins!(@rows $done $rows {
            /// The other outputs can be relied on.
            Valid => valid: bool, "";
            /// Enabled, and not ended by an error.
            Busy => busy: bool, "";
            /// The block cannot read.
            Error => error: bool, "";
            /// Why; 0 without an error.
            ErrorID => error_id: $crate::ErrorId, "";
            $($left)*
        } $($later)*);
    };
}

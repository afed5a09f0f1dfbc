//! Every `ErrorID` a block can show, in one table.
//!
//! Numbers are interface: they are never reused and never change their meaning. A new error takes the next
//! free number of its class.

/// The subject of an error; the hundreds of its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ErrorClass {
    /// 0: no error.
    None,
    /// 100-199: a pin's value.
    Parameter,
    /// 200-299: the axis state does not allow the command.
    State,
    /// 300-399: the command buffer.
    Buffer,
    /// 400-499: the axis.
    Axis,
    /// 500-599: the drive.
    Drive,
    /// 600-699: the communication with the drive.
    Communication,
    /// 700-799: defined by the standard, not supported by this version.
    Unsupported,
    /// 900-999: a defect of the runtime.
    Internal,
}

macro_rules! error_ids {
    ($($name:ident = $number:literal, $cause:literal, $remedy:literal;)*) => {
        /// The number at an `ErrorID` pin; `None` (0) whenever `Error` is FALSE.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        #[non_exhaustive]
        #[repr(u16)]
        pub enum ErrorId {
            $(#[doc = $cause] $name = $number,)*
        }

        impl ErrorId {
            /// All errors in rising order of their numbers.
            pub const ALL: &'static [Self] = &[$(Self::$name),*];

            /// The error's name as in docs and traces.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$name => stringify!($name)),* }
            }

            /// What happened.
            pub const fn cause(self) -> &'static str {
                match self { $(Self::$name => $cause),* }
            }

            /// What to do about it.
            pub const fn remedy(self) -> &'static str {
                match self { $(Self::$name => $remedy),* }
            }
        }
    };
}

error_ids! {
    None = 0, "No error.", "Nothing to do.";

    AxisUnknown = 100, "The Axis, Master, Slave, Input or Output pin names no axis of this runtime.",
        "Wire it to a configured axis.";
    PositionInvalid = 101, "Position or Distance is NaN or infinite, the target is not representable, or the Position of MC_SetPosition or MC_Home is so large that two set-points would be the same number.",
        "Give a finite number; at MC_SetPosition and MC_Home at most 2^52 times the travel in a scan at the velocity limit.";
    VelocityInvalid = 102, "Velocity is NaN or infinite, or zero or negative where a positive value is needed.",
        "Positioning moves and MC_Jog need a Velocity above 0; give the direction by the target or the button.";
    AccelerationInvalid = 103, "Acceleration is NaN, infinite or negative.",
        "Give a positive number, or 0 for the axis default.";
    DecelerationInvalid = 104, "Deceleration is NaN, infinite or negative.",
        "Give a positive number, or 0 for the axis default.";
    JerkInvalid = 105, "Jerk is NaN, infinite or negative.",
        "Give a positive number, or 0 for the axis default.";
    SnapInvalid = 106, "Snap is NaN, infinite or negative.",
        "Give a positive number, or 0 for the axis default.";
    AccelerationMissing = 107, "Acceleration is 0 and the axis has neither a default nor a limit for it.",
        "Give Acceleration at the block or a default in the axis configuration.";
    DecelerationMissing = 108, "Deceleration is 0 and the axis has neither a default nor a limit for it.",
        "Give Deceleration at the block or a default in the axis configuration.";
    DirectionInvalid = 109, "Direction is not a number of MC_DIRECTION, or not applicable to this block.",
        "Use mcPositiveDirection, mcNegativeDirection or mcCurrentDirection; mcShortestWay only for positioning.";
    BufferModeInvalid = 110, "BufferMode is not a number of MC_BUFFER_MODE.",
        "Use a value from mcAborting (0) to mcBlendingHigh (5).";
    VelocityAboveLimit = 111, "Velocity is above the axis limit and the axis is set to refuse that.",
        "Lower Velocity, raise the limit, or set above_limit to clamp.";
    AccelerationAboveLimit = 112, "Acceleration is above the axis limit and the axis is set to refuse that.",
        "Lower Acceleration, raise the limit, or set above_limit to clamp.";
    DecelerationAboveLimit = 113, "Deceleration is above the axis limit and the axis is set to refuse that.",
        "Lower Deceleration, raise the limit, or set above_limit to clamp.";
    JerkAboveLimit = 114, "Jerk is above the axis limit and the axis is set to refuse that.",
        "Lower Jerk, raise the limit, or set above_limit to clamp.";
    SnapAboveLimit = 115, "Snap is above the axis limit and the axis is set to refuse that.",
        "Lower Snap, raise the limit, or set above_limit to clamp.";
    MoveTooLong = 116, "The move would take more than 2147483647 scans.",
        "Raise the limits, shorten the move or lengthen the cycle.";
    TargetOutsideSoftwareLimits = 117, "The move would end outside the software limits.",
        "Choose a target inside them or change the axis configuration.";
    SourceInvalid = 118, "Source is not a number of MC_SOURCE.",
        "Use mcCommandedValue (0), mcSetValue (1) or mcActualValue (2).";
    PositionOutsideModulo = 119, "The position is not in the first turn of a modulo axis.",
        "Give a position from 0 to below the length of a turn, or move by a distance.";
    EndVelocityInvalid = 120, "EndVelocity is NaN or infinite, or its magnitude is above Velocity.",
        "Give a finite number not above Velocity; its sign is the direction of motion at the target.";
    EndVelocityAboveLimit = 121, "EndVelocity is above the axis limit and the axis is set to refuse that.",
        "Lower EndVelocity, raise the limit, or set above_limit to clamp.";
    ExecutionModeInvalid = 122, "ExecutionMode is not a number of MC_EXECUTION_MODE.",
        "Use mcImmediately (0) or mcQueued (1).";
    OutwardFromSoftwareLimit = 123, "The axis is at or beyond a software limit and the endless motion would lead further out.",
        "Move back inside: in the other direction, or to a target inside.";
    FactorInvalid = 124, "An override factor is NaN, negative, 0 where only VelFactor may be 0, or above the largest one of the axis.",
        "Give VelFactor from 0, AccFactor and JerkFactor from above 0, each at most 1 or the override_max of the axis.";
    JogDistanceInvalid = 125, "Distance of MC_Jog is NaN, infinite or negative.",
        "Give 0 to move while the button is held, or the length of a step above 0; the buttons give the direction.";
    DigitalNumberInvalid = 130, "InputNumber or OutputNumber is not the number of a digital input or output.",
        "Give a number from 0 to 31.";
    TriggerInvalid = 131, "TriggerInput is not a number of MC_TRIGGER_REF.",
        "Use a value from mcProbe1Rising (0) to mcProbe2Falling (3).";
    WindowInvalid = 132, "LastPosition is below FirstPosition on an axis without modulo, so the window is empty.",
        "Give the window in positive direction; only on a modulo axis it may pass the end of the turn.";
    CamSwitchInvalid = 133, "A record of Switches has a position that is not finite or not in the first turn, an empty cam, or a direction, mode or duration out of range.",
        "Give positions of the axis, FirstOnPosition not above LastOnPosition (except on modulo axes), AxisDirection 0 to 2, CamSwitchMode 0 or 1, in time mode a Duration above 0.";
    CamTrackInvalid = 134, "A TrackNumber is not from 1 to 32, or the Hysteresis of a track is NaN, infinite or negative.",
        "Number tracks from 1 to 32, and give a Hysteresis of 0 or above.";
    TableUnknown = 135, "The reference at the pin is not a table of this runtime, or the table has too many records.",
        "Take the reference from Machine::add_table; the page of the block has the largest number of records.";
    ParameterNumberInvalid = 140, "ParameterNumber is not the number of a parameter.",
        "Give a number from 1 to 17, or 1000 or 1001 to read.";
    ParameterKindInvalid = 141, "The parameter is a BOOL and the block one for REAL, or the other way round.",
        "Use MC_ReadBoolParameter and MC_WriteBoolParameter for the numbers 4 to 6, MC_ReadParameter and MC_WriteParameter for all others.";
    ParameterReadOnly = 142, "The parameter can only be read.",
        "Write the limit of the application (9, 13, 15, 17) instead of that of the system; the others only show what the axis does.";
    ParameterValueInvalid = 143, "Value is NaN, or infinite, zero or negative where the parameter does not allow that, or not the number of a shaper, or a frequency or damping outside the range of shapers.",
        "Give a finite position, or a limit above 0; a frequency of at least half that of the set-up with a period from 4 to 4096 cycles, a damping from 0 to 0.9, a shaper from 1 to 4.";
    ParameterAboveSystem = 144, "Value is above the limit of the axis.",
        "Give at most what MC_ReadParameter shows for MaxVelocitySystem (8), MaxAccelerationSystem (12), MaxDecelerationSystem (14) or MaxJerkSystem (16).";
    ParameterMissing = 145, "A software limit or the supervision of the following error is switched on before it has a value.",
        "Write SWLimitPos (2), SWLimitNeg (3) or MaxPositionLag (7) first.";
    SoftwareLimitsCrossed = 146, "The lower software limit would not be below the upper one.",
        "Move the other limit first, or switch one of them off.";
    ParameterOnModulo = 147, "A modulo axis has no software limits: its positions wrap.",
        "Leave the parameters 2 to 5 alone on this axis.";
    VibrationMissing = 148, "The axis was set up without this mode of vibration, so it has no memory for a shaper.",
        "Give the axis the mode in its set-up (its key vibration); then it can be changed while the axis is at rest.";
    RatioInvalid = 150, "RatioDenominator is 0.",
        "Give a denominator from 1; a RatioNumerator of 0 brings the slave to rest.";
    CouplingRing = 151, "Master is the slave itself, or an axis that follows it.",
        "Wire another axis to Master, or end the coupling that closes the ring first.";
    SyncModeInvalid = 152, "SyncMode, CombineMode or StartMode is a number that is not defined.",
        "Use mcShortest (0), mcCatchUp (1) or mcSlowDown (2).";
    CamTableInvalid = 153, "The rows do not form a cam: fewer than 2 or more than 512, a Master that is not above the one before, a number that is NaN or infinite, or a Law that is not defined; or the store of cams has no room.",
        "The record in the log names the row and the field, or what is missing in the store; the size of the store is set up with the machine (cams).";
    CamNotSmooth = 154, "A derivative of the cam jumps that must be continuous for the limits of the slave, or by its cam_continuity.",
        "The record in the log names the row, the derivative and the jump. Use mcCamRest7 or mcCamThrough for slaves with a snap limit, mcCamRest5 for those with a jerk limit; without periods begin and end level. With a lower coupling.cam_continuity the slave stops at such rows.";
    CamUnknown = 155, "CamTableID is not a cam: it was never selected, is not complete yet, or was selected again since.",
        "Wire CamTableID of MC_CamTableSelect and wait for its Done.";
    SyncPositionInvalid = 156, "MasterSyncPosition, SlaveSyncPosition, MasterStartDistance or SwitchAt is NaN or further from 0 than 1e15, on a modulo axis not in its first turn, or not in the cam.",
        "Give finite positions; on a modulo axis at least 0 and less than the length of a turn, on a cam between its first and its last row, and a distance shorter than a turn, or than the period of a cam.";
    CamScalingInvalid = 157, "MasterScaling or SlaveScaling is 0, NaN or infinite, or an offset is NaN or beyond 1e15.",
        "Give finite numbers, and scalings other than 0; a negative SlaveScaling mirrors the cam.";
    CouplingRatioTooFine = 158, "Master and slave are both modulo axes, and the ratio of their turns is not one of integers below 2^63.",
        "Give lengths of turns that have a common measure, such as 360 and 400, or a ratio within the limit that the record in the log names.";
    MasterSourceInvalid = 159, "MasterValueSource is mcCommandedValue, which is not a motion to follow, or mcActualValue of a master without increments, which the filter of actual values needs.",
        "Use mcSetValue (1); for actual values give the master a scaling, or 0 as its coupling.actual_filter.";
    ProfileTableInvalid = 160, "A profile's table has no point after the start, more than 40, a DeltaTime that is not above 0 (the first may be 0) or that TimeScale makes less than 1e-9 of a cycle, or a value that is NaN or infinite.",
        "Give 1 to 40 points, each later than the one before; the record in the log names the point.";
    ProfileStartMismatch = 161, "The first point of a profile is for the start (DeltaTime 0), and the axis has another value there.",
        "Leave the point out, give it a DeltaTime in which to get there, or bring the axis there first.";
    ProfileBeyondLimits = 162, "The curve of a profile would exceed a limit of the axis.",
        "Raise TimeScale, lower the amplitude, or move the point that the record in the log names; it also says how far the limit is exceeded.";
    ProfileScaleInvalid = 163, "TimeScale is not above 0, or a scale or Offset of a profile is NaN or infinite.",
        "Give TimeScale above 0 and finite numbers for the others.";
    TorqueInvalid = 170, "Torque or TorqueRamp is NaN or infinite, or TorqueRamp is negative.",
        "Give a finite Torque, and a TorqueRamp above 0, or 0 for none.";
    TorqueAboveLimit = 171, "Torque is above the largest one the drive can hold.",
        "Lower Torque, or raise the limit of the drive.";

    NotPowered = 201, "The axis is Disabled.",
        "Switch it on with MC_Power and wait for Status.";
    InErrorStop = 202, "The axis is in ErrorStop.",
        "Remove the cause, then call MC_Reset.";
    InStopping = 203, "MC_Stop holds the axis.",
        "Wait for MC_Stop.Done and set its Execute to FALSE.";
    InHoming = 204, "The axis is homing.",
        "Wait for MC_Home.Done, or interrupt it with MC_Stop.";
    InMotion = 205, "The command needs an axis at standstill.",
        "Wait until the axis is in Standstill, or command it buffered behind a move that ends.";
    PoweringOff = 206, "The axis is being switched off and is not Disabled yet.",
        "Wait for Disabled, then switch it on again with MC_Power.";
    NotHomed = 207, "The axis is set to need homing before absolute moves.",
        "Call MC_Home first.";
    PositiveBarred = 208, "The motion needs the positive direction, and EnablePositive of MC_Power is FALSE.",
        "Set EnablePositive to TRUE at the MC_Power instance called last, or move in the other direction.";
    NegativeBarred = 209, "The motion needs the negative direction, and EnableNegative of MC_Power is FALSE.",
        "Set EnableNegative to TRUE at the MC_Power instance called last, or move in the other direction.";
    OutwardFromLimitSwitch = 210, "The axis is on a hardware limit switch and the motion would lead further out.",
        "Move back from the switch: in the other direction, or to a target on that side.";
    ProfileInterrupted = 212, "A profile was stopped because MC_Power barred a direction it needs; its times have passed.",
        "Start it again when the direction is permitted.";
    TorqueControls = 213, "MC_TorqueControl owns the axis, so there is no set position to add a motion to.",
        "Let another motion take over first.";
    TriggerTaken = 215, "Another instance waits for this probe.",
        "Wait for it, or abort it with MC_AbortTrigger; each probe serves one instance at a time.";

    NotCoupled = 216, "MC_GearOut finds no slave of MC_GearIn or MC_GearInPos, MC_CamOut none of MC_CamIn, or MC_PhasingAbsolute or MC_PhasingRelative none of its Master.",
        "Call it while MC_GearIn, MC_GearInPos or MC_CamIn is Active; end other motions with MC_Halt or MC_Stop.";

    MasterTooFast = 218, "The slave of MC_GearInPos is behind a master that is at least as fast as its Velocity, so it can't catch up.",
        "Raise Velocity, or slow the master down until InSync.";
    SyncNotReachable = 219, "On the present plan of its master the slave can't be in sync when the master reaches MasterSyncPosition, or passes the last row of a cam without periods.",
        "Give a longer MasterStartDistance or higher dynamics, or move the slave nearer to its sync position first. If the record names SyncMode, no distance is enough: use mcShortest, with which the slave may go back, or move it back first.";
    CamBeyondLimits = 220, "The slave can't follow the cam at the velocity limit of its master, and its on_limit is error.",
        "Lower the velocity limit of the master to MaxMasterVelocity, raise the limits of the slave, or make the cam wider.";
    BufferModeNotHere = 221, "MC_GearInPos or MC_CamIn with a MasterStartDistance has a BufferMode other than mcAborting, but the position of its start point at the end of the motion before is not known. Or MC_CamIn with SwitchAt has mcAborting.",
        "Use mcAborting, or a MasterStartDistance of 0; with SwitchAt use mcBuffered.";

    Shaped = 222, "The axis has a shaper (its key vibration) between motion and drive, so it can't follow a master, lead slaves by its set values, or be under a torque.",
        "Set it up without vibration, or let slaves follow its actual values (mcActualValue).";

    BufferFull = 301, "All places of the command buffer are taken.",
        "Wait for a buffered command to become active, or enlarge the queue of the axis.";

    RemovedFromBuffer = 302, "The queued command was removed from the buffer before its turn.",
        "Command it again, or behind commands that are not interrupted.";

    AxisFault = 401, "The axis reported a fault.",
        "Remove its cause, then call MC_Reset.";
    SoftwareLimitReached = 402, "A motion would have left the software limits; the axis stopped inside.",
        "Call MC_Reset, then move away from the limit.";
    CauseStillPresent = 403, "MC_Reset found the cause of the axis error still present.",
        "Remove the cause, then give MC_Reset a new rising edge.";
    FollowingErrorTooLarge = 404, "The following error, from actual to set position, was above its limit.",
        "Free the axis or raise MaxPositionLag (7); while it lags, switch it off with MC_Power, then call MC_Reset.";
    LimitSwitchReached = 410, "The axis moved onto a hardware limit switch; it was stopped.",
        "Call MC_Reset, then move back from the switch.";
    HomingTimedOut = 411, "The homing took longer than its time limit.",
        "Find out why the reference was not found; raise the time_limit of the homing if it only needs longer.";
    HomingTooFar = 412, "The homing went further than its distance limit.",
        "Find out why the reference was not found; raise the distance_limit of the homing if it is only further away.";
    HomingSwitchNotFound = 413, "Between both limit switches the home switch did not show the edge that is the reference.",
        "Check the home switch, its wiring and the edge in the homing of the axis.";
    DeviationTooLarge = 420, "The slave could not stay within its limits on the law of its master, or was further from it than the max_deviation of its coupling.",
        "Slow the master down or raise the limits of the slave; coupling.on_limit \"lag\" lets it catch up. Then call MC_Reset.";
    MasterLost = 421, "The set-point of the master is not the result of a plan: it is switched off, has a fault of its power or drive, or is under a torque; or actual values are followed and the drive of the master reports none.",
        "Bring the master into operation before the slave is coupled, and stop the slave before the master is switched off; then call MC_Reset.";

    DriveFault = 501, "The drive reported a fault.",
        "Read the drive's own code, parameter 1000, remove the cause, then call MC_Reset.";
    PowerLost = 502, "The power stage went off without a request.",
        "Restore the power, then call MC_Reset.";
    PowerNotConfirmed = 503, "The drive did not confirm its power within the power_timeout of the axis.",
        "Find out why the drive does not switch on, then give Enable of MC_Power a new rising edge, or call MC_Reset.";
    HomingSignalMissing = 510, "The homing of the axis needs a switch, a reference pulse or a mode that its drive does not have.",
        "Choose a homing the drive has the signals for, or give the drive what is missing.";
    DriveHomingFailed = 511, "The drive aborted its homing.",
        "Read the drive's own code, parameter 1000, and check its homing method and switches, then call MC_Reset.";
    TorqueUnknown = 520, "The drive of the axis does not report its torque.",
        "Use a drive that measures it.";
    TorqueNotHeld = 521, "The drive of the axis cannot hold a torque.",
        "Use a drive that can; its motion is as before.";

    CommunicationLost = 601, "The communication with the drive was lost.",
        "Restore it, then call MC_Reset.";
    FeedbackInvalid = 602, "The drive reported a position or torque that is NaN or infinite, or a position that means an infinite velocity.",
        "Correct the source of such numbers, an encoder or a scaling in the drive's own code, then call MC_Reset.";

    SetpointBroken = 901, "A plan gave a set-point that is not finite.",
        "This is a defect of standstill: please report the trace.";
    FateLost = 902, "The instance was not called while 64 later commands of the axis ended, so its result is gone.",
        "Call the instance while it is Busy.";
    PlanRefused = 903, "The planner refused inputs that the axis had accepted.",
        "This is a defect of standstill: please report the trace.";
    SetpointStep = 904, "A plan gave a set-point further from the last one than the limits allow in one scan. It was not published.",
        "This is a defect of standstill: please report the trace.";
}

/// Numbers that earlier versions showed and no version will show again, each with its old meaning.
pub const RETIRED: &[(u16, &str)] = &[
    (701, "Blending buffer modes were not supported."),
    (702, "ContinuousUpdate was not supported."),
    (703, "EnablePositive and EnableNegative were not supported."),
    (704, "MasterValueSource mcActualValue was not supported."),
    (
        705,
        "MC_MoveSuperimposed on the slave of a gear was not supported.",
    ),
];

// Deriving it needs an attribute on a variant, but the table above writes the variants.
#[allow(clippy::derivable_impls)]
impl Default for ErrorId {
    fn default() -> Self {
        Self::None
    }
}

impl ErrorId {
    /// The number at the pin.
    pub const fn number(self) -> u16 {
        self as u16
    }

    /// The error with this number, if there is one.
    pub fn from_number(number: u16) -> Option<Self> {
        Self::ALL.iter().copied().find(|id| id.number() == number)
    }

    /// The subject of the error.
    pub const fn class(self) -> ErrorClass {
        match self.number() / 100 {
            0 => ErrorClass::None,
            1 => ErrorClass::Parameter,
            2 => ErrorClass::State,
            3 => ErrorClass::Buffer,
            4 => ErrorClass::Axis,
            5 => ErrorClass::Drive,
            6 => ErrorClass::Communication,
            7 => ErrorClass::Unsupported,
            _ => ErrorClass::Internal,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Covers: V27, R73
    #[test]
    fn retired_numbers_are_not_used_again() {
        for (number, _) in RETIRED {
            assert_eq!(ErrorId::from_number(*number), None);
        }
    }

    #[test]
    fn numbers_rise_and_every_error_says_what_to_do() {
        for pair in ErrorId::ALL.windows(2) {
            assert!(pair[0].number() < pair[1].number(), "{pair:?} out of order");
        }
        for id in ErrorId::ALL {
            assert!(id.cause().ends_with('.') && id.remedy().ends_with('.'), "{id:?}");
            assert_eq!(ErrorId::from_number(id.number()), Some(*id));
        }
    }
}

//! Rules on the outputs of one call of one instance.

use super::{Broken, rule};
use standstill_blocks::BlockInstance;
use standstill_fb::{AnyInstance, BlockInfo, Value};

/// The kind of an instance for the rules.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Kind {
    /// Execute, and a command that owns the axis or waits.
    Motion,
    /// MC_Stop: it holds the axis while Execute is TRUE, and has no Active.
    Stop,
    /// MC_MoveSuperimposed.
    Superimposed,
    /// MC_HaltSuperimposed, which has nothing to do in states without motion.
    HaltSuperimposed,
    /// MC_Jog: two buttons in place of Execute, and one command after the other that owns the axis.
    Jog,
    /// Execute without a command that owns the axis: MC_Reset, MC_SetPosition.
    Administrative,
    /// MC_Power.
    Power,
    /// All blocks with Enable except MC_Power.
    Reading,
    /// No block of an axis, or not of its motion.
    Other,
}

impl Kind {
    /// The kind of a block, by its name and pins.
    pub fn of(info: &BlockInfo) -> Self {
        let has = |pin: &str| info.pin(pin).is_some();
        match info.name {
            "MC_Stop" => Self::Stop,
            "MC_Jog" => Self::Jog,
            "MC_MoveSuperimposed" => Self::Superimposed,
            "MC_HaltSuperimposed" => Self::HaltSuperimposed,
            "MC_Power" => Self::Power,
            // They wait for, or switch, peripherals of a drive; these drives have none.
            "MC_TouchProbe" | "MC_DigitalCamSwitch" => Self::Other,
            // The drives here have no torque.
            "MC_TorqueControl" | "MC_ReadActualTorque" => Self::Other,
            // There is no table here, so they are always refused.
            "MC_PositionProfile" | "MC_VelocityProfile" | "MC_AccelerationProfile" => Self::Other,
            _ if !has("Axis") => Self::Other,
            // MC_TouchProbe can be aborted, but moves nothing.
            _ if has("Execute") && has("Active") => Self::Motion,
            _ if has("Execute") => Self::Administrative,
            _ if has("Enable") => Self::Reading,
            _ => Self::Other,
        }
    }

    /// Whether its command runs in addition to the owner.
    pub fn is_superimposed(self) -> bool {
        matches!(self, Self::Superimposed | Self::HaltSuperimposed)
    }

    /// Whether its commands need an axis in operation.
    fn needs_operation(self) -> bool {
        matches!(self, Self::Motion | Self::Stop | Self::Superimposed)
    }
}

/// The outputs that the rules read; missing ones are FALSE.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Shown {
    /// Busy.
    pub busy: bool,
    /// Active.
    pub active: bool,
    /// Done, ProfileCompleted.
    pub done: bool,
    /// CommandAborted.
    pub aborted: bool,
    /// Error.
    pub error: bool,
    /// ErrorID.
    pub error_id: u16,
    /// InVelocity, InEndVelocity, InTorque, InGear, InSync.
    pub reached: bool,
    /// Status of MC_Power.
    pub status: bool,
    /// Valid.
    pub valid: bool,
}

impl Shown {
    /// Reads an instance.
    pub fn of(block: &BlockInstance) -> Self {
        Outputs::of(block.info()).read(block)
    }

    /// The outputs without the number of the error.
    pub fn without_error_id(self) -> Self {
        Self { error_id: 0, ..self }
    }

    /// One of Done, CommandAborted and Error.
    pub fn is_terminal(&self) -> bool {
        self.done | self.aborted | self.error
    }
}

/// The indices of the pins of [`Shown`] in a block's table.
#[derive(Clone, Copy, Debug)]
pub struct Outputs {
    flags: [Option<usize>; 8],
    error_id: Option<usize>,
}

impl Outputs {
    /// Of a block.
    pub fn of(info: &BlockInfo) -> Self {
        let place = |pin: &str| info.pin(pin).map(|(place, _)| place);
        Self {
            flags: [
                place("Busy"),
                place("Active"),
                place("Done").or_else(|| place("ProfileCompleted")),
                place("CommandAborted"),
                place("Error"),
                ["InVelocity", "InEndVelocity", "InTorque", "InGear", "InSync"]
                    .into_iter()
                    .find_map(place),
                place("Status"),
                place("Valid"),
            ],
            error_id: place("ErrorID"),
        }
    }

    /// The outputs of the block's last call.
    pub fn read(&self, block: &BlockInstance) -> Shown {
        let flag = |place: Option<usize>| place.and_then(|place| block.get(place)) == Some(Value::Bool(true));
        let [busy, active, done, aborted, error, reached, status, valid] = self.flags.map(flag);
        let error_id = match self.error_id.and_then(|place| block.get(place)) {
            Some(Value::Word(number)) => number,
            _ => 0,
        };
        Shown {
            busy,
            active,
            done,
            aborted,
            error,
            error_id,
            reached,
            status,
            valid,
        }
    }
}

/// One call.
#[derive(Clone, Copy, Debug)]
pub struct Call {
    /// The kind of the instance.
    pub kind: Kind,
    /// Execute or Enable at the call before.
    pub executed: bool,
    /// Execute or Enable now.
    pub execute: bool,
    /// The outputs of the last call.
    pub was: Shown,
    /// The outputs now.
    pub now: Shown,
    /// The axis is in Disabled or ErrorStop when the block is called.
    pub refusing: bool,
    /// The power stage of the axis is on.
    pub powered: bool,
}

/// Rules on the outputs of a call.
///
/// # Errors
/// The rule that does not hold.
pub fn check_call(call: &Call) -> Result<(), Broken> {
    let now = &call.now;
    rule(
        now.error == (now.error_id != 0),
        "R34",
        "Error and ErrorID disagree",
    )?;
    rule(now.error_id < 900, "R79", "a defect is reported")?;
    match call.kind {
        Kind::Power => rule(
            now.status == call.powered,
            "R60",
            "Status is not that of the power stage",
        ),
        Kind::Reading => {
            rule(!(now.valid && now.error), "R53", "Valid beside Error")?;
            rule(
                call.execute || !(now.valid || now.error || now.busy),
                "R55",
                "an output is TRUE without Enable",
            )
        }
        Kind::Jog => {
            check_outputs(now)?;
            rule(
                !(now.busy && !call.was.busy && call.refusing),
                "R78",
                "a command is accepted without power or in ErrorStop",
            )
        }
        Kind::Other => Ok(()),
        Kind::Motion | Kind::Stop | Kind::Superimposed | Kind::HaltSuperimposed | Kind::Administrative => {
            check_execute(call)
        }
    }
}

/// The outputs of a command together. Returns how many of Busy, Done, CommandAborted and Error are TRUE.
fn check_outputs(now: &Shown) -> Result<u32, Broken> {
    let count = u32::from(now.busy) + u32::from(now.done) + u32::from(now.aborted) + u32::from(now.error);
    rule(
        count <= 1,
        "R21",
        "more than one of Busy, Done, CommandAborted, Error",
    )?;
    rule(
        !(now.active && now.is_terminal()),
        "R23",
        "Active beside a terminal output",
    )?;
    rule(!now.active || now.busy, "R24", "Active without Busy")?;
    Ok(count)
}

fn check_execute(call: &Call) -> Result<(), Broken> {
    let Call {
        kind,
        executed,
        execute,
        was,
        now,
        ..
    } = call;
    let count = check_outputs(now)?;
    rule(
        !execute || count == 1,
        "R22",
        "Execute without any of Busy, Done, CommandAborted, Error",
    )?;
    rule(
        !now.reached || (now.active && now.busy),
        "R43",
        "InVelocity, InEndVelocity or InTorque without Active and Busy",
    )?;
    let rising = *execute && !executed;
    rule(
        !rising || now.busy || now.error || *kind == Kind::Administrative,
        "R24",
        "neither Busy nor Error at the rising edge",
    )?;
    rule(
        *execute || !was.is_terminal() || !now.is_terminal() || was.busy,
        "R30",
        "a terminal output stays longer than one call without Execute",
    )?;
    rule(
        !execute || rising || !was.is_terminal() || was == now,
        "R28",
        "a result changes while Execute is TRUE",
    )?;
    rule(
        rising || !was.busy || count == 1,
        "R24",
        "a command ends in none of Done, CommandAborted, Error",
    )?;
    rule(
        rising || was.busy || !now.busy,
        "R19",
        "a command begins without a rising edge",
    )?;
    rule(
        !(rising && call.refusing) || now.error || !kind.needs_operation(),
        "R78",
        "a command is accepted without power or in ErrorStop",
    )
}

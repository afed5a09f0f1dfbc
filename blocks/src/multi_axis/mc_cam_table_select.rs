//! `MC_CamTableSelect`: makes a cam from a table.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; V20a. docs/cams.md describes the rows.

use core::cell::Cell;
use standstill_axis::{
    AxisId, CAM_ROWS, CAM_ROWS_PER_CALL, CamCause, CamCurve, CamFault, CamHead, CamId, CamRow, CamSelection,
    ErrorId, ExecutionMode, Fate, NoRoom, Planner, Raw,
};
use standstill_fb::{Block, Context, Group, Int, TableOf, pins, record};

record! {
    /// A row of a cam.
    pub struct CamPoint = "MC_CAM_REF" {
        /// Position of the master, above that of the row before.
        Master => master: f64, "u of the master";
        /// Position of the slave.
        Slave => slave: f64, "u";
        /// First derivative there, for mcCamPoly7 and mcCamPoly5.
        Slope => slope: f64, "";
        /// Second derivative there, for mcCamPoly7 and mcCamPoly5.
        Curvature => curvature: f64, "";
        /// Third derivative there, for mcCamPoly7.
        Third => third: f64, "";
        /// Law of the cam from this row to the next.
        Law => law: Raw<CamCurve>, "";
    }
}

pins! {
    in_outs {
        /// The master; the cam is checked against its velocity limit.
        Master => master: AxisId;
        /// The slave; the cam is checked against its limits.
        Slave => slave: AxisId;
        /// The rows, 2 to 512; they are copied, and must not change while the block is Busy.
        CamTable => cam_table: TableOf<CamPoint, CAM_ROWS>;
    }
    inputs {
        /// A rising edge selects the table with the values of that call.
        Execute => execute: bool = false, "";
        /// TRUE: the cam continues with its first row after its last one.
        Periodic => periodic: bool = false, "";
        /// TRUE: positions of the master are those of the axis. FALSE: the first row is at the position of the
        /// master when MC_CamIn begins.
        MasterAbsolute => master_absolute: bool = false, "";
        /// TRUE: positions of the slave are those of the axis. FALSE: the cam passes through the position of the
        /// slave when MC_CamIn begins.
        SlaveAbsolute => slave_absolute: bool = false, "";
        /// mcImmediately, or mcQueued for the end of the commands that the slave has received before.
        ExecutionMode => execution_mode: Raw<ExecutionMode> = Raw::new(0), "";
    }
    vendor_inputs {}
    outputs {
        /// The cam is selected, and CamTableID valid.
        Done => done: bool, "";
        /// Not finished: each call checks 32 rows.
        Busy => busy: bool, "";
        /// Refused.
        Error => error: bool, "";
        /// Why; 0 without an error.
        ErrorID => error_id: ErrorId, "";
        /// The cam, for MC_CamIn; 0 before the first, and while the block is Busy.
        CamTableID => cam_table_id: u32, "";
    }
    vendor_outputs {
        /// The highest constant velocity of the master at which the slave can follow the cam.
        MaxMasterVelocity => max_master_velocity: f64, "u/s of the master";
        /// Number of continuous derivatives of the cam, at most 3.
        Continuity => continuity: Int, "";
    }
}

/// The step the block is in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum At {
    #[default]
    Idle,
    /// Waits until the command given before has finished.
    Waiting,
    Looking,
    /// The cam was completed since the last call.
    Complete,
    Done,
    Failed(ErrorId),
}

/// State kept between calls.
#[doc(alias = "MC_CamTableSelect")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McCamTableSelect {
    executed: bool,
    at: At,
    cam: CamId,
    selection: CamSelection,
    table: TableOf<CamPoint, CAM_ROWS>,
    highest: f64,
    continuity: u8,
}

impl Block for McCamTableSelect {
    const NAME: &'static str = "MC_CamTableSelect";
    const GROUP: Group = Group::MultiAxis;
    const DOC: &'static str = "Checks a table and makes it a cam.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let rising = inputs.execute && !self.executed;
        self.executed = inputs.execute;
        self.at = match self.at {
            At::Complete => At::Done,
            // The result was shown in an earlier call.
            At::Done | At::Failed(_) if !inputs.execute => At::Idle,
            at => at,
        };
        if rising {
            self.begin(inputs, context);
        }
        if self.at == At::Waiting && is_free(context, self.selection.slave) {
            self.at = self.set_up(context).map_or_else(At::Failed, |()| At::Looking);
        }
        if self.at == At::Looking {
            match self.look(context) {
                Ok(true) => self.at = At::Complete,
                Ok(false) => {}
                Err(error) => {
                    context.scope.cams.give_back(self.cam);
                    self.cam = CamId::NONE;
                    self.at = At::Failed(error);
                }
            }
        }
        let is_valid = matches!(self.at, At::Done | At::Idle);
        Outputs {
            done: self.at == At::Done,
            busy: matches!(self.at, At::Waiting | At::Looking | At::Complete),
            error: matches!(self.at, At::Failed(_)),
            error_id: if let At::Failed(error) = self.at {
                error
            } else {
                ErrorId::None
            },
            cam_table_id: if is_valid { self.cam.number() } else { 0 },
            max_master_velocity: if is_valid { self.highest } else { 0.0 },
            continuity: if is_valid { self.continuity.into() } else { 0 },
        }
    }
}

/// Whether the command given to the slave before has finished, or is endless.
fn is_free<P: Planner>(context: &Context<'_, P>, slave: AxisId) -> bool {
    let Some(axis) = context.axes.get(slave.index()) else {
        return true;
    };
    let runs = axis.active_command().map(|id| axis.fate(id));
    let has_finished = !matches!(runs, Some(Fate::Active { reached: false } | Fate::Waiting));
    axis.waiting() == 0 && has_finished
}

impl McCamTableSelect {
    /// A rising edge.
    fn begin<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) {
        context.scope.cams.retire(self.cam);
        (self.cam, self.highest, self.continuity) = (CamId::NONE, 0.0, 0);
        self.table = inputs.cam_table;
        self.selection = CamSelection {
            master: inputs.master,
            slave: inputs.slave,
            periodic: inputs.periodic,
            master_absolute: inputs.master_absolute,
            slave_absolute: inputs.slave_absolute,
        };
        self.at = match self.admit(inputs, context) {
            Ok(()) => At::Waiting,
            Err(error) => At::Failed(error),
        };
        let at_once = inputs.execution_mode.get() == Some(ExecutionMode::Immediately);
        if self.at == At::Waiting && at_once {
            self.at = self.set_up(context).map_or_else(At::Failed, |()| At::Looking);
        }
    }

    fn admit<P: Planner>(&self, inputs: &Inputs, context: &mut Context<'_, P>) -> Result<(), ErrorId> {
        let CamSelection { master, slave, .. } = self.selection;
        let count = context.axes.len();
        for (pin, axis) in [("Slave", slave), ("Master", master)] {
            if axis.index() >= count {
                return Err(context.scope.refuse_axis(pin, axis, count));
            }
        }
        let (axis, scope) = context.axis(slave)?;
        if inputs.execution_mode.get().is_none() {
            let number = f64::from(inputs.execution_mode.number());
            let error = ErrorId::ExecutionModeInvalid;
            axis.note_refusal("ExecutionMode", number, 1.0, error, scope);
            return Err(error);
        }
        if master == slave {
            let number = f64::from(master.number());
            axis.note_refusal("Master", number, f64::NAN, ErrorId::CouplingRing, scope);
            return Err(ErrorId::CouplingRing);
        }
        Ok(())
    }

    /// Takes a slot and reserves room for the rows.
    fn set_up<P: Planner>(&mut self, context: &mut Context<'_, P>) -> Result<(), ErrorId> {
        let rows = usize::from(self.table.place().records);
        if rows > 0 && rows <= CAM_ROWS && self.table.row(context.tables, rows - 1).is_none() {
            return Err(ErrorId::TableUnknown);
        }
        let axes = &*context.axes;
        let is_used = |id| axes.iter().any(|axis| axis.uses_cam(id));
        let begun = context.scope.cams.begin(rows, self.selection, is_used);
        let (pin, value, limit) = match begun {
            Ok(Ok(cam)) => {
                self.cam = cam;
                return Ok(());
            }
            Ok(Err(NoRoom::Slots(slots))) => {
                ("CamTable: slots of the store", slots as f64 + 1.0, slots as f64)
            }
            Ok(Err(NoRoom::Pieces(needed, all))) => {
                ("CamTable: pieces of the store", needed as f64, all as f64)
            }
            Err(fault) => ("CamTable: rows", fault.value, fault.limit),
        };
        let (axis, scope) = context.axis(self.selection.slave)?;
        axis.note_refusal(pin, value, limit, ErrorId::CamTableInvalid, scope);
        Err(ErrorId::CamTableInvalid)
    }

    /// Reads the next rows. Returns whether the cam is complete and valid for both axes.
    fn look<P: Planner>(&mut self, context: &mut Context<'_, P>) -> Result<bool, ErrorId> {
        let (tables, table) = (context.tables, self.table);
        let undefined: Cell<Option<(usize, i32)>> = Cell::new(None);
        let row = |index: usize| {
            let point = table.row(tables, index)?;
            let law = point.law.get();
            if law.is_none() && undefined.get().is_none_or(|(before, _)| index < before) {
                undefined.set(Some((index, point.law.number())));
            }
            Some(CamRow {
                master: point.master,
                slave: point.slave,
                slope: point.slope,
                curvature: point.curvature,
                third: point.third,
                shape: law.unwrap_or(CamCurve::Through).shape(),
            })
        };
        let looked = context.scope.cams.go_on(self.cam, &row);
        let bad_law = undefined.get();
        let selection = self.selection;
        let broken = match looked {
            Err(fault) if bad_law.is_none_or(|(index, _)| fault.row <= index + 1) => {
                Some(told(&fault, row(fault.row.saturating_sub(1))))
            }
            _ => bad_law.map(|(index, number)| (index + 1, "Law", f64::from(number), 5.0)),
        };
        if let Some((number, what, value, limit)) = broken {
            let (axis, scope) = context.axis(selection.slave)?;
            return Err(axis.refuse_row(number, what, value, limit, ErrorId::CamTableInvalid, scope));
        }
        let Ok(Some(head)) = looked else { return Ok(false) };
        self.check(&head, context)?;
        Ok(true)
    }

    /// Whether both axes can follow the complete cam.
    fn check<P: Planner>(&mut self, head: &CamHead, context: &mut Context<'_, P>) -> Result<(), ErrorId> {
        let master = context.axes.get(self.selection.master.index());
        let velocity = master.map_or(f64::INFINITY, |master| master.config().limits.velocity);
        let selection = self.selection;
        let (axis, scope) = context.axis(selection.slave)?;
        self.highest = axis.check_cam(head, &selection, velocity, scope)?;
        self.continuity = head.smooth.continuity;
        Ok(())
    }
}

/// The fault of a row: its number, the field, the value and the limit it breaks.
fn told(fault: &CamFault, row: Option<CamRow>) -> (usize, &'static str, f64, f64) {
    let row = row.unwrap_or_default();
    let fields = [
        ("Master", row.master),
        ("Slave", row.slave),
        ("Slope", row.slope),
        ("Curvature", row.curvature),
        ("Third", row.third),
    ];
    let broken = fields.into_iter().find(|(_, value)| !value.is_finite());
    match (fault.cause, broken) {
        (CamCause::NotFinite, Some((what, value))) => (fault.row, what, value, f64::NAN),
        _ => (fault.row, "Master", fault.value, fault.limit),
    }
}

// The cost of a call is that of the rows it reads.
const _: () = assert!(CAM_ROWS_PER_CALL == 32);

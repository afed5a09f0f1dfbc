//! The common part of the three profile blocks. The values are taken at the rising edge; the points are
//! given when the command becomes active.
//!
//! Source: PLCopen Motion Control Part 1, sections on Execute/Done and ContinuousUpdate; R8 to R14, V24.

use standstill_axis::{
    Axis, AxisId, BufferMode, CommandId, ErrorId, PROFILE_POINTS, Planner, Profile, ProfileKind, ProfileRow,
    Raw, Scope,
};
use standstill_fb::{Context, ExecuteCore, Phase, Record, TableOf};

/// A record of one of the three tables.
pub trait Point: Record {
    /// The kind of its value.
    const KIND: ProfileKind;

    /// The pin of the table.
    const PIN: &'static str;

    /// The same point as the axis takes it.
    fn row(&self) -> ProfileRow;
}

/// The table at a pin.
pub type Points<R> = TableOf<R, PROFILE_POINTS>;

/// The values that define a profile, from the pins.
#[derive(Clone, Copy, Debug)]
pub struct Shape<R> {
    /// The table.
    pub table: Points<R>,
    /// TimeScale.
    pub time_scale: f64,
    /// Factor of the values.
    pub scale: f64,
    /// Offset.
    pub offset: f64,
}

impl<R: Point> Shape<R> {
    fn is_same(&self, other: &Self) -> bool {
        let bits = |shape: &Self| [shape.time_scale, shape.scale, shape.offset].map(f64::to_bits);
        self.table.place() == other.table.place() && bits(self) == bits(other)
    }

    /// Calls `to` with the profile and the points of the table.
    fn read<T>(&self, tables: &[f64], to: impl FnOnce(&Profile<'_>) -> T) -> Option<T> {
        let table = self.table.read(tables)?;
        let mut rows = [ProfileRow::default(); PROFILE_POINTS];
        for (row, record) in rows.iter_mut().zip(table.rows()) {
            *row = record.row();
        }
        Some(to(&Profile {
            kind: R::KIND,
            rows: rows.get(..table.rows().len())?,
            time_scale: self.time_scale,
            scale: self.scale,
            offset: self.offset,
        }))
    }
}

/// The pins that all three have.
#[derive(Clone, Copy, Debug)]
pub struct Pins {
    /// Axis.
    pub axis: AxisId,
    /// Execute.
    pub execute: bool,
    /// ContinuousUpdate.
    pub continuous_update: bool,
    /// BufferMode.
    pub buffer_mode: Raw<BufferMode>,
}

/// State kept between calls.
#[derive(Clone, Copy, Debug)]
pub struct ProfileCore<R> {
    execute: ExecuteCore,
    /// The values in force; none before the first command.
    given: Option<Shape<R>>,
    /// The values last seen while changes counted: those in force, or those that were refused.
    seen: Option<Shape<R>>,
    /// Changed values count, from a rising edge with ContinuousUpdate TRUE until it is FALSE (R10, R11).
    continuous: bool,
}

impl<R> Default for ProfileCore<R> {
    fn default() -> Self {
        Self {
            execute: ExecuteCore::default(),
            given: None,
            seen: None,
            continuous: false,
        }
    }
}

impl<R: Point> ProfileCore<R> {
    /// One call. Cost while the profile runs: some comparisons. At its start, and when a value changes:
    /// reading the table and [`Axis::profile`].
    pub fn scan<P: Planner>(&mut self, pins: &Pins, shape: &Shape<R>, context: &mut Context<'_, P>) -> Phase {
        if let Some((axis, id)) = self.execute.running(pins.execute, context) {
            self.follow(axis, id, pins, shape, context);
        }
        let (given, seen, continuous) = (&mut self.given, &mut self.seen, &mut self.continuous);
        self.execute
            .scan_among(pins.execute, pins.axis, context, |context, _| {
                let tables = context.tables;
                let (axis, scope) = context.axis(pins.axis)?;
                let id = shape
                    .read(tables, |profile| axis.profile(profile, pins.buffer_mode, scope))
                    .unwrap_or_else(|| Err(unknown(axis, R::PIN, scope)))?;
                (*given, *seen, *continuous) = (Some(*shape), Some(*shape), pins.continuous_update);
                Ok(id)
            })
    }

    /// Handles a command in progress before its status is read: passes new values, and the points when it
    /// becomes active.
    fn follow<P: Planner>(
        &mut self,
        axis: AxisId,
        id: CommandId,
        pins: &Pins,
        shape: &Shape<R>,
        context: &mut Context<'_, P>,
    ) {
        self.continuous &= pins.continuous_update;
        let tables = context.tables;
        let (Some(given), Some(seen), Ok((axis, scope))) =
            (&mut self.given, &mut self.seen, context.axis(axis))
        else {
            return;
        };
        let changed = self.continuous && !seen.is_same(shape);
        if changed {
            *seen = *shape;
        }
        if axis.profile_is_due(id) {
            *given = *seen;
            let start = |profile: &Profile<'_>| axis.start_profile(id, profile, scope);
            if given.read(tables, start).is_none() {
                // Without its points it cannot start.
                let none = Profile {
                    kind: R::KIND,
                    rows: &[],
                    time_scale: given.time_scale,
                    scale: given.scale,
                    offset: given.offset,
                };
                axis.start_profile(id, &none, scope);
            }
        } else if changed && !given.is_same(shape) {
            // The block shows no Error: its command continues unchanged (R21).
            let updated = shape.read(tables, |profile| axis.update_profile(id, profile, scope));
            if let Some(Ok(())) = updated {
                *given = *shape;
            }
        }
    }
}

/// The table does not exist at the place that the pin gives.
fn unknown<P: Planner>(axis: &Axis<P>, pin: &'static str, scope: &mut Scope<'_>) -> ErrorId {
    let error = ErrorId::TableUnknown;
    axis.note_refusal(pin, f64::NAN, f64::NAN, error, scope);
    error
}

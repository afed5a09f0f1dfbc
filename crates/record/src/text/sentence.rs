//! The records of the axes, and the state of a recorder, in words.

use super::number::{integer, real, whole};
use crate::ring::Ring;
use core::fmt::{self, Write};
use standstill_axis::{Approach, Event, Excess, Goal, Record};

/// Names of axes and block instances.
pub trait Called {
    /// The axis at a place; empty if there is none.
    fn axis(&self, place: usize) -> &str;

    /// The instance with a number in records.
    fn instance(&self, number: u16) -> Option<&str>;
}

/// The subject of a record's line: the instance for an action of a program, the axis for an action of the
/// axis.
pub fn subject<'n>(names: &'n impl Called, record: &Record) -> &'n str {
    let axis = names.axis(record.axis.index());
    match record.event {
        Event::Refused { .. }
        | Event::PointRefused { .. }
        | Event::Clamped { .. }
        | Event::Raised { .. }
        | Event::Slowed { .. }
        | Event::Superimposed { .. }
        | Event::RoomAwaited
        | Event::CamSelected { .. }
        | Event::CamStops { .. }
        | Event::Orphaned => names.instance(record.instance.0).unwrap_or(axis),
        Event::Unavoidable(_)
        | Event::Planned { .. }
        | Event::Paused { .. }
        | Event::Fault { .. }
        | Event::Coupled { .. }
        | Event::Approaching { .. }
        | Event::InGear
        | Event::GearLost { .. }
        | Event::SyncLate { .. }
        | Event::Phasing { .. }
        | Event::LeadsOutside { .. }
        | Event::OnCam { .. }
        | Event::OntoCam { .. }
        | Event::InSync
        | Event::SyncLost { .. }
        | Event::CamPassed { .. }
        | Event::Shifted { .. } => axis,
    }
}

/// The beginning of the sentence about a shift.
const SHIFTED: &str = "coordinates moved by ";

/// Says that coordinates were shifted by this distance (u).
///
/// # Errors
/// Those of `out`.
pub fn shifted(out: &mut impl Write, by: f64) -> fmt::Result {
    out.write_str(SHIFTED)?;
    real(out, by)
}

/// The shift (u) that a sentence reports, if it reports one.
#[must_use]
pub fn shift(sentence: &str) -> Option<f64> {
    sentence.strip_prefix(SHIFTED)?.parse().ok()
}

/// What happened.
///
/// # Errors
/// Those of `out`.
pub fn happened(out: &mut impl Write, names: &impl Called, record: &Record) -> fmt::Result {
    match record.event {
        Event::Refused {
            pin,
            value,
            limit,
            error,
        } => {
            refusal(out, error.number(), error.name())?;
            if !pin.is_empty() {
                out.write_str(", ")?;
                out.write_str(pin)?;
                out.write_str(" ")?;
                match pin {
                    // Numbers of an enumeration.
                    "BufferMode"
                    | "Direction"
                    | "ExecutionMode"
                    | "CombineMode"
                    | "MasterValueSource"
                    | "MasterValueSourceM1"
                    | "MasterValueSourceM2" => {
                        integer(out, value as i64)?;
                    }
                    "Master" | "Master1" | "Master2" | "Slave" => match value as usize {
                        0 => out.write_str("no axis")?,
                        number => match names.axis(number - 1) {
                            "" => whole(out, number as u64)?,
                            name => out.write_str(name)?,
                        },
                    },
                    _ => real(out, value)?,
                }
            }
            limited(out, limit)
        }
        Event::PointRefused {
            point,
            what,
            value,
            limit,
            error,
        } => {
            refusal(out, error.number(), error.name())?;
            out.write_str(", point ")?;
            whole(out, point.into())?;
            out.write_str(", ")?;
            out.write_str(what)?;
            out.write_str(" ")?;
            real(out, value)?;
            limited(out, limit)
        }
        Event::Clamped { pin, value, limit } => changed(out, "clamped: ", pin, value, limit),
        Event::Raised { pin, value, limit } => changed(out, "raised: ", pin, value, limit),
        Event::Slowed { pin, value, limit } => changed(out, "slowed: ", pin, value, limit),
        Event::Unavoidable(excess) => {
            out.write_str("unavoidable: ")?;
            unavoidable(out, &excess)
        }
        Event::Planned { goal, scans } => {
            out.write_str("plan")?;
            if let Some(name) = names.instance(record.instance.0) {
                out.write_str(" for ")?;
                out.write_str(name)?;
            }
            match goal {
                Goal::Position(position) => {
                    out.write_str(" to position ")?;
                    real(out, position)?;
                }
                Goal::Velocity(velocity) => {
                    out.write_str(" to velocity ")?;
                    real(out, velocity)?;
                }
                Goal::Passing { position, velocity } => {
                    out.write_str(" to velocity ")?;
                    real(out, velocity)?;
                    out.write_str(" at ")?;
                    real(out, position)?;
                }
            }
            in_scans(out, scans)
        }
        Event::Superimposed { distance, scans } => {
            match distance {
                Some(distance) => {
                    out.write_str("superimposes ")?;
                    real(out, distance)?;
                }
                None => out.write_str("superimposed motion to rest")?,
            }
            in_scans(out, scans)
        }
        Event::RoomAwaited => out.write_str("waits for room below the axis limits"),
        Event::Orphaned => out.write_str("orphaned: the motion goes on, and no block follows it"),
        Event::Paused { error } => {
            out.write_str("pauses: ")?;
            whole(out, error.number().into())?;
            out.write_str(" ")?;
            out.write_str(error.name())
        }
        Event::Coupled {
            master,
            numerator,
            denominator,
        } => {
            out.write_str("coupled to ")?;
            out.write_str(names.axis(master.index()))?;
            out.write_str(", ")?;
            integer(out, numerator.into())?;
            out.write_str("/")?;
            whole(out, denominator.into())
        }
        Event::Approaching { way, velocity, scans } => {
            out.write_str("plan")?;
            if let Some(name) = names.instance(record.instance.0) {
                out.write_str(" for ")?;
                out.write_str(name)?;
            }
            out.write_str(": ")?;
            out.write_str(way.name())?;
            if way != Approach::Difference {
                out.write_str(" at ")?;
                real(out, velocity)?;
            }
            in_scans(out, scans)
        }
        Event::InGear => out.write_str("in gear"),
        Event::LeadsOutside { position, limit } => {
            out.write_str("leads to ")?;
            real(out, position)?;
            out.write_str(", outside the software limit ")?;
            real(out, limit)
        }
        Event::CamSelected { velocity, limit } if velocity < limit => {
            out.write_str("cam limits the master to ")?;
            real(out, velocity)?;
            out.write_str(", below its limit ")?;
            real(out, limit)
        }
        Event::CamSelected { velocity, .. } => {
            out.write_str("cam fast enough: the master may go up to ")?;
            real(out, velocity)
        }
        Event::CamStops { row, what, jump } => {
            write!(out, "cam stops its slave: row {row}, {what} jumps by ")?;
            real(out, jump)
        }
        Event::OnCam { master, .. } => {
            out.write_str("onto a cam behind ")?;
            out.write_str(names.axis(master.index()))
        }
        Event::OntoCam { way, value, scans } => {
            out.write_str("plan")?;
            if let Some(name) = names.instance(record.instance.0) {
                out.write_str(" for ")?;
                out.write_str(name)?;
            }
            out.write_str(": ")?;
            out.write_str(way.name())?;
            if way != Approach::Difference {
                let leads = matches!(way, Approach::Move | Approach::Corner);
                out.write_str(if leads { " to " } else { " at " })?;
                real(out, value)?;
            }
            in_scans(out, scans)
        }
        Event::InSync => out.write_str("in sync"),
        Event::SyncLost { what, value, limit } => {
            out.write_str("sync lost: ")?;
            out.write_str(what)?;
            out.write_str(" ")?;
            real(out, value)?;
            limited(out, limit)
        }
        Event::CamPassed { periods } => {
            whole(out, periods.into())?;
            out.write_str(" ends of the cam in one scan")
        }
        Event::Phasing { to, scans } => {
            out.write_str("phase")?;
            if let Some(name) = names.instance(record.instance.0) {
                out.write_str(" of ")?;
                out.write_str(name)?;
            }
            out.write_str(" to ")?;
            real(out, to)?;
            in_scans(out, scans)
        }
        Event::SyncLate { by } => {
            out.write_str("sync late: the master is ")?;
            real(out, by)?;
            out.write_str(" past the sync point")
        }
        Event::GearLost { what, value, limit } => {
            out.write_str("gear lost: ")?;
            out.write_str(what)?;
            out.write_str(" ")?;
            real(out, value)?;
            limited(out, limit)
        }
        Event::Shifted { by } => shifted(out, by),
        Event::Fault { error, code } => {
            out.write_str("fault ")?;
            whole(out, error.number().into())?;
            out.write_str(" ")?;
            out.write_str(error.name())?;
            out.write_str(", code ")?;
            whole(out, code.into())
        }
    }
}

/// Says which scans of the machine a recorder holds, and why there are no more.
///
/// # Errors
/// Those of `out`.
pub fn standing(out: &mut impl Write, ring: &Ring, names: &impl Called) -> fmt::Result {
    let (first, kept) = ring.scans();
    out.write_str("scans ")?;
    whole(out, first)?;
    out.write_str(" to ")?;
    whole(out, first + (kept as u64).saturating_sub(1))?;
    out.write_str(" of the machine")?;
    let Some((scan, axis)) = ring.tripped() else {
        return Ok(());
    };
    out.write_str("; tripped by ")?;
    match axis {
        None => out.write_str("the host")?,
        Some(axis) => {
            out.write_str("ErrorStop of ")?;
            out.write_str(names.axis(axis))?;
        }
    }
    out.write_str(" in scan ")?;
    whole(out, scan)?;
    out.write_str(", here ")?;
    whole(out, scan.saturating_sub(first))
}

fn refusal(out: &mut impl Write, number: u16, name: &str) -> fmt::Result {
    out.write_str("refused: ")?;
    whole(out, number.into())?;
    out.write_str(" ")?;
    out.write_str(name)
}

fn limited(out: &mut impl Write, limit: f64) -> fmt::Result {
    if limit.is_nan() {
        return Ok(());
    }
    out.write_str(", limit ")?;
    real(out, limit)
}

fn changed(out: &mut impl Write, how: &str, pin: &str, from: f64, to: f64) -> fmt::Result {
    out.write_str(how)?;
    out.write_str(pin)?;
    out.write_str(" ")?;
    real(out, from)?;
    out.write_str(" to ")?;
    real(out, to)
}

fn in_scans(out: &mut impl Write, scans: u32) -> fmt::Result {
    out.write_str(" in ")?;
    whole(out, scans.into())?;
    out.write_str(" scans")
}

fn unavoidable(out: &mut impl Write, excess: &Excess) -> fmt::Result {
    let parts = [
        ("velocity ", excess.velocity),
        ("acceleration ", excess.acceleration),
        ("jerk ", excess.jerk),
    ];
    let mut is_first = true;
    for (name, value) in parts.into_iter().filter(|(_, value)| *value != 0.0) {
        if !core::mem::take(&mut is_first) {
            out.write_str(", ")?;
        }
        out.write_str(name)?;
        real(out, value)?;
        out.write_str(" above its limit")?;
    }
    Ok(())
}

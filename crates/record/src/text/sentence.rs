//! The records of the axes, and the state of a recorder, in words.

use super::number::Real;
use crate::ring::Ring;
use core::fmt::{self, Write};
use standstill_axis::{Approach, ErrorId, Event, Excess, Goal, Record};

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
    write!(out, "{SHIFTED}{}", Real(by))
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
            refusal(out, error)?;
            if !pin.is_empty() {
                write!(out, ", {pin} ")?;
                refused_value(out, names, pin, value)?;
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
            refusal(out, error)?;
            write!(out, ", point {point}, {what} {}", Real(value))?;
            limited(out, limit)
        }
        Event::Clamped { pin, value, limit } => changed(out, "clamped", pin, value, limit),
        Event::Raised { pin, value, limit } => changed(out, "raised", pin, value, limit),
        Event::Slowed { pin, value, limit } => changed(out, "slowed", pin, value, limit),
        Event::Unavoidable(excess) => {
            out.write_str("unavoidable: ")?;
            unavoidable(out, &excess)
        }
        Event::Planned { goal, scans } => {
            named(out, names, record, "plan", "for")?;
            match goal {
                Goal::Position(position) => write!(out, " to position {}", Real(position))?,
                Goal::Velocity(velocity) => write!(out, " to velocity {}", Real(velocity))?,
                Goal::Passing { position, velocity } => {
                    write!(out, " to velocity {} at {}", Real(velocity), Real(position))?;
                }
            }
            in_scans(out, scans)
        }
        Event::Superimposed { distance, scans } => {
            match distance {
                Some(distance) => write!(out, "superimposes {}", Real(distance))?,
                None => out.write_str("superimposed motion to rest")?,
            }
            in_scans(out, scans)
        }
        Event::RoomAwaited => out.write_str("waits for room below the axis limits"),
        Event::Orphaned => out.write_str("orphaned: the motion goes on, and no block follows it"),
        Event::Paused { error } => write!(out, "pauses: {} {}", error.number(), error.name()),
        Event::Coupled {
            master,
            numerator,
            denominator,
        } => {
            let master = names.axis(master.index());
            write!(out, "coupled to {master}, {numerator}/{denominator}")
        }
        Event::Approaching { way, velocity, scans } => {
            named(out, names, record, "plan", "for")?;
            write!(out, ": {}", way.name())?;
            if way != Approach::Difference {
                write!(out, " at {}", Real(velocity))?;
            }
            in_scans(out, scans)
        }
        Event::InGear => out.write_str("in gear"),
        Event::LeadsOutside { position, limit } => {
            let (position, limit) = (Real(position), Real(limit));
            write!(out, "leads to {position}, outside the software limit {limit}")
        }
        Event::CamSelected { velocity, limit } if velocity < limit => {
            let (velocity, limit) = (Real(velocity), Real(limit));
            write!(
                out,
                "cam limits the master to {velocity}, below its limit {limit}"
            )
        }
        Event::CamSelected { velocity, .. } => {
            write!(out, "cam fast enough: the master may go up to {}", Real(velocity))
        }
        Event::CamStops { row, what, jump } => {
            write!(
                out,
                "cam stops its slave: row {row}, {what} jumps by {}",
                Real(jump)
            )
        }
        Event::OnCam { master, .. } => write!(out, "onto a cam behind {}", names.axis(master.index())),
        Event::OntoCam { way, value, scans } => {
            named(out, names, record, "plan", "for")?;
            write!(out, ": {}", way.name())?;
            if way != Approach::Difference {
                let leads = matches!(way, Approach::Move | Approach::Corner);
                write!(out, " {} {}", if leads { "to" } else { "at" }, Real(value))?;
            }
            in_scans(out, scans)
        }
        Event::InSync => out.write_str("in sync"),
        Event::SyncLost { what, value, limit } => {
            write!(out, "sync lost: {what} {}", Real(value))?;
            limited(out, limit)
        }
        Event::CamPassed { periods } => write!(out, "{periods} ends of the cam in one scan"),
        Event::Phasing { to, scans } => {
            named(out, names, record, "phase", "of")?;
            write!(out, " to {}", Real(to))?;
            in_scans(out, scans)
        }
        Event::SyncLate { by } => {
            write!(out, "sync late: the master is {} past the sync point", Real(by))
        }
        Event::GearLost { what, value, limit } => {
            write!(out, "gear lost: {what} {}", Real(value))?;
            limited(out, limit)
        }
        Event::Shifted { by } => shifted(out, by),
        Event::Fault { error, code } => {
            write!(out, "fault {} {}, code {code}", error.number(), error.name())
        }
    }
}

/// Says which scans of the machine a recorder holds, and why there are no more.
///
/// # Errors
/// Those of `out`.
pub fn standing(out: &mut impl Write, ring: &Ring, names: &impl Called) -> fmt::Result {
    let (first, kept) = ring.scans();
    let last = first + (kept as u64).saturating_sub(1);
    write!(out, "scans {first} to {last} of the machine")?;
    let Some((scan, axis)) = ring.tripped() else {
        return Ok(());
    };
    match axis {
        None => out.write_str("; tripped by the host")?,
        Some(axis) => write!(out, "; tripped by ErrorStop of {}", names.axis(axis))?,
    }
    write!(out, " in scan {scan}, here {}", scan.saturating_sub(first))
}

fn refusal(out: &mut impl Write, error: ErrorId) -> fmt::Result {
    write!(out, "refused: {} {}", error.number(), error.name())
}

/// The refused value of a pin: enumerations as numbers, axes by name.
fn refused_value(out: &mut impl Write, names: &impl Called, pin: &str, value: f64) -> fmt::Result {
    match pin {
        "BufferMode"
        | "Direction"
        | "ExecutionMode"
        | "CombineMode"
        | "MasterValueSource"
        | "MasterValueSourceM1"
        | "MasterValueSourceM2" => write!(out, "{}", value as i64),
        "Master" | "Master1" | "Master2" | "Slave" => match value as usize {
            0 => out.write_str("no axis"),
            number => match names.axis(number - 1) {
                "" => write!(out, "{number}"),
                name => out.write_str(name),
            },
        },
        _ => write!(out, "{}", Real(value)),
    }
}

fn limited(out: &mut impl Write, limit: f64) -> fmt::Result {
    if limit.is_nan() {
        return Ok(());
    }
    write!(out, ", limit {}", Real(limit))
}

fn changed(out: &mut impl Write, how: &str, pin: &str, from: f64, to: f64) -> fmt::Result {
    write!(out, "{how}: {pin} {} to {}", Real(from), Real(to))
}

/// `what`, and with `of` before it the instance that is the cause, if it is known.
fn named(out: &mut impl Write, names: &impl Called, record: &Record, what: &str, of: &str) -> fmt::Result {
    out.write_str(what)?;
    match names.instance(record.instance.0) {
        Some(name) => write!(out, " {of} {name}"),
        None => Ok(()),
    }
}

fn in_scans(out: &mut impl Write, scans: u32) -> fmt::Result {
    write!(out, " in {scans} scans")
}

fn unavoidable(out: &mut impl Write, excess: &Excess) -> fmt::Result {
    let parts = [
        ("velocity", excess.velocity),
        ("acceleration", excess.acceleration),
        ("jerk", excess.jerk),
    ];
    let mut comma = "";
    for (name, value) in parts.into_iter().filter(|(_, value)| *value != 0.0) {
        write!(out, "{comma}{name} {} above its limit", Real(value))?;
        comma = ", ";
    }
    Ok(())
}

//! The memory before the first scan.

use crate::check::{Program, UnitKind};
use crate::library::blocks;
use crate::types::{Array, Constant, Elementary, Member, MemberKind, Start, Type, TypeId, Types};

/// The number that a variable of an elementary type has by default.
pub(crate) fn first(types: &Types, ty: TypeId) -> i128 {
    match types.get(ty) {
        Type::Enumeration(of) => of.elements.first().map_or(0, |(_, number)| *number),
        Type::Subrange { low, .. } => *low,
        _ => 0,
    }
}

/// Writes the initial value of a variable of type `ty`.
pub(crate) fn write(program: &Program<'_>, ty: TypeId, start: &Start, memory: &mut [u8], at: u32) {
    match (program.types.get(ty), start) {
        (Type::Structure(structure), Start::Default | Start::Members(_)) => {
            members(program, &structure.members.list, start, memory, at);
        }
        (Type::Block(unit), Start::Default | Start::Members(_)) => {
            let unit = program.unit(*unit);
            if let UnitKind::Library(info) = unit.kind {
                use standstill_fb::flat::Pointer;
                let inputs = info.flat_inputs(Pointer::Bits32).size as i128;
                number(Elementary::Udint, inputs, memory, at + blocks::INPUTS);
                let outputs = info.flat_outputs().size as i128;
                number(Elementary::Udint, outputs, memory, at + blocks::outputs(info));
            }
            members(program, &unit.members.list, start, memory, at);
        }
        (Type::Text(_), Start::Text(bytes)) => {
            put(&[bytes.len() as u8], memory, at);
            put(bytes, memory, at + 1);
        }
        (Type::Array(array), _) => elements(program, array, start, memory, at),
        _ => {
            let Some(of) = program.types.elementary(ty) else {
                return;
            };
            match start {
                Start::Value(Constant::Real(value)) => real(of, *value, memory, at),
                Start::Value(Constant::Integer(value)) if of.is_real() => real(of, *value as f64, memory, at),
                Start::Value(Constant::Integer(value)) => number(of, *value, memory, at),
                _ if of.is_real() => {}
                _ => number(of, first(&program.types, ty), memory, at),
            }
        }
    }
}

fn members(program: &Program<'_>, list: &[Member], start: &Start, memory: &mut [u8], at: u32) {
    for (place, member) in list.iter().enumerate() {
        if matches!(member.kind, MemberKind::InOut | MemberKind::External(_)) {
            continue;
        }
        let given = match start {
            Start::Members(given) => given.iter().find(|(it, _)| *it == place).map(|(_, start)| start),
            _ => None,
        };
        write(
            program,
            member.ty,
            given.unwrap_or(&member.start),
            memory,
            at + member.offset,
        );
    }
}

fn elements(program: &Program<'_>, array: &Array, start: &Start, memory: &mut [u8], at: u32) {
    let rows: &[(u32, Start)] = match start {
        Start::List(rows) => rows,
        _ => &[],
    };
    let mut done = 0_u32;
    for (times, start) in rows.iter().chain([&(array.count, Start::Default)]) {
        let times = (*times).min(array.count - done);
        repeat(program, array, start, times, memory, at + done * array.stride);
        done += times;
    }
}

/// The same element several times: it is made once and copied.
fn repeat(program: &Program<'_>, array: &Array, start: &Start, times: u32, memory: &mut [u8], at: u32) {
    if times == 0 {
        return;
    }
    write(program, array.of, start, memory, at);
    let (begin, stride) = (at as usize, array.stride as usize);
    let Some(element) = memory.get(begin..begin + stride) else {
        return;
    };
    if element.iter().all(|byte| *byte == 0) {
        return;
    }
    for time in 1..times as usize {
        memory.copy_within(begin..begin + stride, begin + time * stride);
    }
}

fn number(of: Elementary, value: i128, memory: &mut [u8], at: u32) {
    put(&value.to_le_bytes()[..of.size() as usize], memory, at);
}

fn real(of: Elementary, value: f64, memory: &mut [u8], at: u32) {
    if of == Elementary::Real {
        put(&(value as f32).to_le_bytes(), memory, at);
    } else {
        put(&value.to_le_bytes(), memory, at);
    }
}

fn put(bytes: &[u8], memory: &mut [u8], at: u32) {
    let at = at as usize;
    if let Some(place) = memory.get_mut(at..at + bytes.len()) {
        place.copy_from_slice(bytes);
    }
}

/// Writes the first values of the variables of a program.
pub(crate) fn members_of(program: &Program<'_>, unit: crate::types::UnitId, memory: &mut [u8], at: u32) {
    let unit = program.unit(unit);
    members(program, &unit.members.list, &Start::Default, memory, at);
}

//! The axes that variables of type AXIS_REF refer to at the start.

use crate::Options;
use crate::check::{Program, UnitKind};
use crate::error::{Code, Diagnostic, did_you_mean};
use crate::source::Span;
use crate::types::{Array, Member, MemberKind, Type, TypeId};

/// Largest number of variables that a message lists.
const LISTED_MOST: usize = 8;

/// Writes the initial axis of each variable of type AXIS_REF.
pub(crate) fn bind(program: &Program<'_>, options: &Options, memory: &mut [u8]) -> Result<(), Diagnostic> {
    let mut found = Vec::new();
    for global in &program.globals {
        references(
            program,
            global.member.ty,
            &global.path(),
            global.member.offset,
            &mut found,
        );
    }
    for instance in &program.instances {
        let members = &program.unit(instance.unit).members;
        let path = &instance.name;
        member_references(program, &members.list, path, instance.address, &mut found);
    }
    for (path, _, address) in &found {
        let name = path.rsplit('.').next().unwrap_or(path);
        let axis = options
            .axes
            .iter()
            .position(|axis| axis.eq_ignore_ascii_case(name));
        if let Some(axis) = axis {
            put(memory, *address, axis as u32 + 1);
        }
    }
    let only = match program.instances.as_slice() {
        [one] => Some(one.name.as_str()),
        _ => None,
    };
    let mut bound = Vec::new();
    for (path, number) in &options.bindings {
        let plain: String = path.chars().filter(|c| *c != ' ').collect();
        let within = only.map(|name| format!("{name}.{plain}"));
        let same = |known: &str| {
            known.eq_ignore_ascii_case(&plain)
                || within.as_ref().is_some_and(|it| known.eq_ignore_ascii_case(it))
        };
        let listed = without_list(program, &plain);
        let by_name = found.iter().find(|(known, ..)| same(known));
        match by_name.or_else(|| {
            found
                .iter()
                .find(|(known, ..)| known.eq_ignore_ascii_case(listed))
        }) {
            Some((.., address)) if bound.contains(address) => {
                let message = format!("the variable `{path}` is bound to an axis twice");
                let wrong = Diagnostic::error(Code::UnknownBinding, Span::default(), message);
                return Err(wrong.help("paths are compared without regard to case"));
            }
            Some((.., address)) => {
                bound.push(*address);
                put(memory, *address, (*number).into());
            }
            None => return Err(unknown(path, &found, only)),
        }
    }
    Ok(())
}

/// The path of a global variable without the name of its file: `x` of `GVL.x`.
fn without_list<'p>(program: &Program<'_>, path: &'p str) -> &'p str {
    let Some((list, rest)) = path.split_once('.') else {
        return path;
    };
    let name = rest.split(['.', '[']).next().unwrap_or(rest);
    let listed = program
        .globals
        .iter()
        .any(|global| global.is_in(list) && global.member.name.eq_ignore_ascii_case(name));
    if listed { rest } else { path }
}

/// The message for a path that leads to no variable of type AXIS_REF; `only` is the instance whose name
/// may be left out.
fn unknown(path: &str, found: &References, only: Option<&str>) -> Diagnostic {
    let known: Vec<&str> = found
        .iter()
        .map(|(path, ..)| {
            let inner = only.and_then(|name| path.strip_prefix(name)?.strip_prefix('.'));
            inner.unwrap_or(path)
        })
        .collect();
    let listed = (1..=LISTED_MOST).contains(&known.len());
    let help = did_you_mean(path, known.iter().copied())
        .or_else(|| listed.then(|| format!("there is {}", known.join(", "))));
    let message = format!("there is no variable `{path}` of type AXIS_REF to bind to an axis");
    Diagnostic::error(Code::UnknownBinding, Span::default(), message).maybe_help(help)
}

fn put(memory: &mut [u8], address: u32, number: u32) {
    let at = address as usize;
    if let Some(place) = memory.get_mut(at..at + 4) {
        place.copy_from_slice(&number.to_le_bytes());
    }
}

/// All variables of type AXIS_REF: path, type and address.
type References = Vec<(String, TypeId, u32)>;

fn references(program: &Program<'_>, ty: TypeId, path: &str, address: u32, found: &mut References) {
    /// More axes than any script has.
    const MOST: usize = 65_536;
    if found.len() >= MOST {
        return;
    }
    match program.types.get(ty) {
        Type::Structure(structure) if structure.name == "AXIS_REF" => {
            found.push((path.to_owned(), ty, address))
        }
        Type::Structure(structure) => {
            member_references(program, &structure.members.list, path, address, found)
        }
        Type::Block(unit) => {
            let unit = program.unit(*unit);
            if !matches!(unit.kind, UnitKind::Library(_)) {
                member_references(program, &unit.members.list, path, address, found);
            }
        }
        Type::Array(array) if program.types.elementary(array.of).is_none() => {
            let before = found.len();
            for number in 0..array.count {
                references(
                    program,
                    array.of,
                    &format!("{path}[{}]", indices(array, number)),
                    address + number * array.stride,
                    found,
                );
                // If the first element does not have it, no other one has.
                if found.len() == before {
                    return;
                }
            }
        }
        _ => {}
    }
}

/// The indices of an element: `1,-1`.
fn indices(array: &Array, number: u32) -> String {
    let mut rest = i64::from(number);
    let mut all = Vec::new();
    for (low, high) in array.bounds.iter().rev() {
        let count = high - low + 1;
        all.push((low + rest % count).to_string());
        rest /= count;
    }
    all.reverse();
    all.join(",")
}

fn member_references(
    program: &Program<'_>,
    members: &[Member],
    path: &str,
    address: u32,
    found: &mut References,
) {
    for member in members {
        if !matches!(member.kind, MemberKind::InOut | MemberKind::External(_)) {
            let path = format!("{path}.{}", member.name);
            references(program, member.ty, &path, address + member.offset, found);
        }
    }
}

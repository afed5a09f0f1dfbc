//! The blocks of the registry and their types, from the one table of blocks.
//!
//! An instance of a block in memory is its key (8 bytes), its inputs and its outputs, both in the layout
//! of [`flat`](standstill_fb::flat), then the result of its last call.

use crate::source::Span;
use crate::types::{
    Array, Constant, Elementary, Enumeration, Member, MemberKind, Members, Start, Structure, Type, TypeId,
    Types,
};
use standstill_blocks::REGISTRY;
use standstill_fb::flat::Pointer;
use standstill_fb::{BlockInfo, Direction, EnumInfo, Group, Pin, PinType, TableInfo, Value};
use std::collections::BTreeMap;

/// Offset of the inputs of an instance.
pub(crate) const INPUTS: u32 = 8;

/// Offset of the outputs of an instance.
pub(crate) fn outputs(info: &BlockInfo) -> u32 {
    INPUTS + info.flat_inputs(Pointer::Bits32).size as u32
}

/// Offset of the result of the last call.
pub(crate) fn result(info: &BlockInfo) -> u32 {
    outputs(info) + info.flat_outputs().size as u32
}

/// The name of a block's function: `mc_move_absolute`.
pub(crate) fn import(info: &BlockInfo) -> &'static str {
    let place = REGISTRY.iter().position(|it| it.name == info.name);
    place
        .and_then(|place| IMPORTS.get(place))
        .copied()
        .unwrap_or_default()
}

macro_rules! imports {
    ($($group:ident :: $name:ident :: $block:ident)*) => {
        /// Names of the blocks' functions, in the order of the registry.
        const IMPORTS: &[&str] = &[$(stringify!($name)),*];
    };
}

standstill_blocks::for_every_block!(imports);

/// The names that `export st-matiec` gives to the blocks of IEC 61131-3.
const PREFIX: &str = "STANDSTILL_";

/// The block of this name, in upper case.
pub(crate) fn find(key: &str) -> Option<&'static BlockInfo> {
    let plain = key.strip_prefix(PREFIX);
    let standard = plain
        .and_then(standstill_blocks::registry::find)
        .filter(|info| info.group == Group::Standard);
    standard.or_else(|| standstill_blocks::registry::find(key))
}

/// All names of blocks, for guesses.
pub(crate) fn names() -> impl Iterator<Item = &'static str> {
    REGISTRY.iter().map(|info| info.name)
}

/// The types at pins, by name in upper case.
pub(crate) fn types(types: &mut Types) -> BTreeMap<String, TypeId> {
    let mut named = BTreeMap::new();
    for pin in REGISTRY.iter().flat_map(BlockInfo::pins) {
        pin_type(pin.ty, types, &mut named);
    }
    named
}

fn pin_type(ty: PinType, types: &mut Types, named: &mut BTreeMap<String, TypeId>) -> TypeId {
    let elementary = match ty {
        PinType::Bool => Elementary::Bool,
        PinType::Int => Elementary::Int,
        PinType::Lreal => Elementary::Lreal,
        PinType::Uint => Elementary::Uint,
        PinType::Word => Elementary::Word,
        PinType::Dword => Elementary::Dword,
        PinType::Time => Elementary::Time,
        PinType::Axis(name) => return once(name, types, named, |_, _| reference(name)),
        PinType::Enum(info) => return once(info.name, types, named, |_, _| enumeration(&info)),
        PinType::Table(table) => {
            return once(table.name, types, named, |types, named| {
                table_type(&table, types, named)
            });
        }
    };
    Types::of(elementary)
}

fn once(
    name: &str,
    types: &mut Types,
    named: &mut BTreeMap<String, TypeId>,
    make: impl FnOnce(&mut Types, &mut BTreeMap<String, TypeId>) -> Type,
) -> TypeId {
    let key = name.to_ascii_uppercase();
    if let Some(id) = named.get(&key) {
        return *id;
    }
    let ty = make(types, named);
    let id = types.add(ty);
    named.insert(key, id);
    id
}

fn enumeration(info: &EnumInfo) -> Type {
    Type::Enumeration(Enumeration {
        name: info.name.to_owned(),
        base: Elementary::Dint,
        elements: info
            .elements
            .iter()
            .map(|(name, number)| ((*name).to_owned(), (*number).into()))
            .collect(),
        library: true,
    })
}

fn field(name: &str, ty: TypeId, kind: MemberKind, offset: u32) -> Member {
    Member {
        offset,
        ..Member::new(name, ty, kind, Span::default())
    }
}

/// AXIS_REF and similar types: the number of an axis.
fn reference(name: &str) -> Type {
    let mut members = Members::default();
    let number = field("Number", Types::of(Elementary::Dint), MemberKind::Field, 0);
    members.add(number, 4, 4);
    members.close();
    Type::Structure(Structure {
        name: name.to_owned(),
        members,
    })
}

/// MC_TP_REF and similar types: the number of used records, and the records.
fn table_type(table: &TableInfo, types: &mut Types, named: &mut BTreeMap<String, TypeId>) -> Type {
    let name = format!("{}_RECORD", table.name.trim_end_matches("_REF"));
    let record = once(&name, types, named, |types, named| {
        let mut members = Members::default();
        for pin in table.fields {
            let ty = pin_type(pin.ty, types, named);
            let size = pin.ty.scalar().map_or(8, |scalar| scalar.size() as u32);
            members.add(field(pin.name, ty, MemberKind::Field, 0), size, size);
        }
        members.close();
        Type::Structure(Structure {
            name: name.clone(),
            members,
        })
    });
    let (stride, _) = types.size(record, |_| 0);
    let array = Type::Array(Array {
        bounds: vec![(0, table.most as i64 - 1)],
        of: record,
        stride,
        count: table.most as u32,
    });
    let array = types.shared(array);
    let mut members = Members::default();
    members.add(
        field("Count", Types::of(Elementary::Dint), MemberKind::Field, 0),
        4,
        4,
    );
    members.add(
        field("Records", array, MemberKind::Field, 0),
        stride * table.most as u32,
        8,
    );
    members.close();
    Type::Structure(Structure {
        name: table.name.to_owned(),
        members,
    })
}

/// The pins of a block as members of its instance.
pub(crate) fn members(
    info: &'static BlockInfo,
    types: &mut Types,
    named: &mut BTreeMap<String, TypeId>,
) -> Members {
    let (inputs, out) = (info.flat_inputs(Pointer::Bits32), info.flat_outputs());
    let mut members = Members::default();
    for (index, pin) in info.inputs().iter().enumerate() {
        let ty = pin_type(pin.ty, types, named);
        let offset = INPUTS + inputs.offset(index) as u32;
        members.put(Member {
            start: initial(info.default_of(index)),
            ..field(pin.name, ty, kind_of(pin), offset)
        });
    }
    for (index, pin) in info.outputs().iter().enumerate() {
        let ty = pin_type(pin.ty, types, named);
        let offset = outputs(info) + out.offset(index) as u32;
        members.put(field(pin.name, ty, MemberKind::Output, offset));
    }
    if members.find("RESULT").is_none() {
        let ty = Types::of(Elementary::Dint);
        members.put(field("Result", ty, MemberKind::Output, result(info)));
    }
    members.size = result(info) + 8;
    members
}

/// References are passed by their number or address, on both sides of the block.
const fn kind_of(pin: &Pin) -> MemberKind {
    match (pin.direction, pin.ty) {
        (Direction::InOut, _) | (_, PinType::Axis(_) | PinType::Table(_)) => MemberKind::InOut,
        (Direction::Output, _) => MemberKind::Output,
        (Direction::Input, _) => MemberKind::Input,
    }
}

fn initial(value: Option<Value>) -> Start {
    let number = match value {
        Some(Value::Bool(value)) => i128::from(value),
        Some(Value::Int(value)) => value.into(),
        Some(Value::Word(value)) => value.into(),
        Some(Value::Dword(value)) => value.into(),
        Some(Value::Time(value)) => value.into(),
        Some(Value::Enum(value)) => value.into(),
        Some(Value::Lreal(value)) => return Start::Value(Constant::Real(value)),
        Some(Value::Axis(_) | Value::Table(_)) | None => return Start::Default,
    };
    Start::Value(Constant::Integer(number))
}

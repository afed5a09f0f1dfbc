//! Types, their sizes, and the offsets of the members of structures and blocks.

use crate::source::Span;
use std::collections::BTreeMap;

macro_rules! elementary {
    ($($variant:ident = $name:literal, $class:ident, $size:literal;)*) => {
        /// The elementary types.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
        #[allow(missing_docs)]
        pub enum Elementary { $($variant,)* }

        impl Elementary {
            pub(crate) const ALL: &'static [Self] = &[$(Self::$variant),*];

            /// Its name.
            #[must_use]
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => $name,)* }
            }

            pub(crate) const fn class(self) -> Class {
                match self { $(Self::$variant => Class::$class,)* }
            }

            /// Its bytes, which are its alignment, too.
            #[must_use]
            pub const fn size(self) -> u32 {
                match self { $(Self::$variant => $size,)* }
            }
        }
    };
}

elementary! {
    Bool = "BOOL", Bool, 1;
    Sint = "SINT", Signed, 1;
    Usint = "USINT", Unsigned, 1;
    Int = "INT", Signed, 2;
    Uint = "UINT", Unsigned, 2;
    Dint = "DINT", Signed, 4;
    Udint = "UDINT", Unsigned, 4;
    Lint = "LINT", Signed, 8;
    Ulint = "ULINT", Unsigned, 8;
    Real = "REAL", Real, 4;
    Lreal = "LREAL", Real, 8;
    Byte = "BYTE", Bits, 1;
    Word = "WORD", Bits, 2;
    Dword = "DWORD", Bits, 4;
    Lword = "LWORD", Bits, 8;
    Time = "TIME", Time, 8;
    Ltime = "LTIME", Time, 8;
}

/// The operations on an elementary type.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Class {
    Bool,
    Bits,
    Signed,
    Unsigned,
    Real,
    Time,
}

impl Elementary {
    /// The type of this name, without regard to case.
    pub(crate) fn find(name: &str) -> Option<Self> {
        Self::ALL
            .iter()
            .copied()
            .find(|it| it.name().eq_ignore_ascii_case(name))
    }

    pub(crate) const fn is_integer(self) -> bool {
        matches!(self.class(), Class::Signed | Class::Unsigned)
    }

    pub(crate) const fn is_real(self) -> bool {
        matches!(self.class(), Class::Real)
    }

    pub(crate) const fn is_signed(self) -> bool {
        matches!(self.class(), Class::Signed | Class::Time)
    }

    pub(crate) const fn bits(self) -> u32 {
        self.size() * 8
    }

    /// The whole numbers it holds; for REAL and LREAL those that it holds exactly.
    pub(crate) const fn range(self) -> (i128, i128) {
        match self.class() {
            Class::Bool => (0, 1),
            Class::Bits | Class::Unsigned => (0, (1 << self.bits()) - 1),
            Class::Signed | Class::Time => (-(1 << (self.bits() - 1)), (1 << (self.bits() - 1)) - 1),
            Class::Real if self.size() == 4 => (-(1 << 24), 1 << 24),
            Class::Real => (-(1 << 53), 1 << 53),
        }
    }

    pub(crate) fn holds(self, value: i128) -> bool {
        let (low, high) = self.range();
        (low..=high).contains(&value)
    }

    /// The number that a type of whole numbers keeps of `value`: its low bits.
    pub(crate) const fn wrapped(self, value: i128) -> i128 {
        let bits = self.bits();
        if matches!(self.class(), Class::Bool) {
            return (value != 0) as i128;
        }
        let low = value & ((1 << bits) - 1);
        if self.is_signed() && low >> (bits - 1) != 0 {
            low - (1 << bits)
        } else {
            low
        }
    }

    /// Whether `to` holds every value of it, so that it is converted implicitly.
    pub(crate) fn widens_to(self, to: Self) -> bool {
        use Class::{Bits, Real, Signed, Time, Unsigned};
        match (self.class(), to.class()) {
            _ if self == to => true,
            (Bits, Bits) | (Signed, Signed) | (Unsigned, Unsigned) | (Unsigned, Signed) | (Real, Real) => {
                self.size() < to.size()
            }
            (Signed | Unsigned, Real) => self.size() * 2 <= to.size(),
            (Time, Time) => true,
            _ => false,
        }
    }

    /// The smallest type of numbers to which both are converted implicitly.
    pub(crate) fn common(self, other: Self) -> Option<Self> {
        let fits = |to: &Self| self.widens_to(*to) && other.widens_to(*to);
        Self::ALL.iter().copied().find(fits)
    }
}

/// Largest number of bytes of a string: its length is in one byte.
pub(crate) const TEXT_MOST: u8 = 254;

/// The bytes of a STRING without a length.
pub(crate) const TEXT_USUAL: u8 = 80;

/// A type, by its place in [`Types`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct TypeId(pub u32);

/// A program, function block or function, by its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct UnitId(pub u32);

#[derive(Clone, Debug)]
pub(crate) enum Type {
    Elementary(Elementary),
    Enumeration(Enumeration),
    Subrange {
        name: String,
        base: Elementary,
        low: i128,
        high: i128,
    },
    Structure(Structure),
    Array(Array),
    /// STRING of this number of bytes.
    Text(u8),
    /// An instance of a function block or program.
    Block(UnitId),
    /// A literal without a type, of whole numbers.
    AnyInteger,
    /// A literal without a type, with a point.
    AnyReal,
    /// A type whose fault has been reported: it is compatible with everything.
    Wrong,
}

#[derive(Clone, Debug)]
pub(crate) struct Enumeration {
    pub name: String,
    pub base: Elementary,
    /// Names as declared, and numbers.
    pub elements: Vec<(String, i128)>,
    /// Of the library: its values may be given as numbers.
    pub library: bool,
}

impl Enumeration {
    /// The element of this name, without regard to case.
    pub(crate) fn find(&self, name: &str) -> Option<&(String, i128)> {
        self.elements.iter().find(|(it, _)| it.eq_ignore_ascii_case(name))
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Structure {
    pub name: String,
    pub members: Members,
}

#[derive(Clone, Debug)]
pub(crate) struct Array {
    /// First and last index of each dimension.
    pub bounds: Vec<(i64, i64)>,
    pub of: TypeId,
    /// Bytes from one element to the next.
    pub stride: u32,
    pub count: u32,
}

/// The use of a member of a structure or of a variable of a unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MemberKind {
    /// Of a structure.
    Field,
    Var,
    Input,
    Output,
    InOut,
    Temp,
    /// A global variable.
    External(usize),
    /// The value of a function.
    Result,
}

impl MemberKind {
    /// Whether a call gives it.
    pub(crate) const fn is_given(self) -> bool {
        matches!(self, Self::Input | Self::InOut)
    }
}

#[derive(Clone, Debug)]
pub(crate) struct Member {
    pub name: String,
    pub ty: TypeId,
    pub kind: MemberKind,
    /// Its address; of an in_out, the place of its address.
    pub offset: u32,
    pub start: Start,
    pub span: Span,
    pub constant: bool,
    pub retain: bool,
    /// `%IX0.0`
    pub address: Option<String>,
}

impl Member {
    /// A variable without a place and a first value.
    pub(crate) fn new(name: &str, ty: TypeId, kind: MemberKind, span: Span) -> Self {
        Self {
            name: name.to_owned(),
            ty,
            kind,
            offset: 0,
            start: Start::Default,
            span,
            constant: false,
            retain: false,
            address: None,
        }
    }
}

/// The initial value of a variable.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Start {
    /// The default of its type.
    Default,
    Value(Constant),
    /// The bytes of a string.
    Text(Vec<u8>),
    /// Elements of an array from the first on: the number of times, and the value.
    List(Vec<(u32, Start)>),
    /// Members of a structure or block, by place.
    Members(Vec<(usize, Start)>),
}

/// A value that is known before the program runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Constant {
    /// Of whole numbers, BOOL, bits, TIME (ns), and the number of an enumeration.
    Integer(i128),
    Real(f64),
}

/// Members in their order, found by name.
#[derive(Clone, Debug, Default)]
pub(crate) struct Members {
    pub list: Vec<Member>,
    pub index: BTreeMap<String, usize>,
    pub size: u32,
}

impl Members {
    pub(crate) fn find(&self, key: &str) -> Option<(usize, &Member)> {
        let place = *self.index.get(key)?;
        Some((place, self.list.get(place)?))
    }

    /// Adds a member whose place is known.
    pub(crate) fn put(&mut self, member: Member) {
        self.index
            .insert(member.name.to_ascii_uppercase(), self.list.len());
        self.list.push(member);
    }

    /// Adds a member behind the others.
    pub(crate) fn add(&mut self, mut member: Member, size: u32, align: u32) {
        member.offset = self
            .size
            .checked_next_multiple_of(align.max(1))
            .unwrap_or(u32::MAX);
        self.size = member.offset.saturating_add(size);
        self.put(member);
    }

    /// Rounds the size up, so that instances can be put one after the other.
    pub(crate) fn close(&mut self) {
        self.size = self.size.checked_next_multiple_of(8).unwrap_or(u32::MAX);
    }
}

/// The index of an entry in the types of a program.
#[derive(Debug)]
pub(crate) struct Types {
    list: Vec<Type>,
    /// Arrays and subranges without a name are the same if they have the same definition.
    anonymous: BTreeMap<String, TypeId>,
}

pub(crate) const WRONG: TypeId = TypeId(17);
pub(crate) const ANY_INTEGER: TypeId = TypeId(18);
pub(crate) const ANY_REAL: TypeId = TypeId(19);
pub(crate) const BOOL: TypeId = TypeId(0);

impl Types {
    pub(crate) fn new() -> Self {
        let mut list: Vec<Type> = Elementary::ALL.iter().map(|it| Type::Elementary(*it)).collect();
        list.extend([Type::Wrong, Type::AnyInteger, Type::AnyReal]);
        Self {
            list,
            anonymous: BTreeMap::new(),
        }
    }

    pub(crate) const fn of(elementary: Elementary) -> TypeId {
        TypeId(elementary as u32)
    }

    pub(crate) fn get(&self, id: TypeId) -> &Type {
        self.list.get(id.0 as usize).unwrap_or(&Type::Wrong)
    }

    pub(crate) fn add(&mut self, ty: Type) -> TypeId {
        self.list.push(ty);
        TypeId(self.list.len() as u32 - 1)
    }

    /// Adds a type, or returns the existing one with the same definition.
    pub(crate) fn shared(&mut self, ty: Type) -> TypeId {
        let key = self.anonymous_key(&ty);
        if let Some(id) = self.anonymous.get(&key) {
            return *id;
        }
        let id = self.add(ty);
        self.anonymous.insert(key, id);
        id
    }

    /// STRING of this number of bytes.
    pub(crate) fn text(&mut self, capacity: u8) -> TypeId {
        self.shared(Type::Text(capacity))
    }

    fn anonymous_key(&self, ty: &Type) -> String {
        match ty {
            Type::Array(array) => format!("A{:?}{}", array.bounds, array.of.0),
            Type::Subrange { base, low, high, .. } => format!("S{base:?}{low}..{high}"),
            other => format!("{other:?}"),
        }
    }

    /// The representation of its values in memory and in arithmetic; `None` if it has members or elements.
    pub(crate) fn elementary(&self, id: TypeId) -> Option<Elementary> {
        match self.get(id) {
            Type::Elementary(it) => Some(*it),
            Type::Enumeration(Enumeration { base, .. }) | Type::Subrange { base, .. } => Some(*base),
            _ => None,
        }
    }

    /// The same of a type that is computed with, which an enumeration is not.
    pub(crate) fn computed(&self, id: TypeId) -> Option<Elementary> {
        self.elementary(id).filter(|_| !self.is_enumeration(id))
    }

    /// The type of an expression that reads a variable of this type: for a subrange its base.
    pub(crate) fn value_type(&self, id: TypeId) -> TypeId {
        match self.get(id) {
            Type::Subrange { base, .. } => Self::of(*base),
            _ => id,
        }
    }

    /// The least and the greatest value of a whole number.
    pub(crate) fn range(&self, id: TypeId) -> (i128, i128) {
        match self.get(id) {
            Type::Subrange { low, high, .. } => (*low, *high),
            _ => self.elementary(id).map_or((0, 0), Elementary::range),
        }
    }

    pub(crate) fn is_enumeration(&self, id: TypeId) -> bool {
        matches!(self.get(id), Type::Enumeration(_))
    }

    /// Bytes and alignment; the size of a block is stored with its unit.
    pub(crate) fn size(&self, id: TypeId, unit_size: impl Fn(UnitId) -> u32) -> (u32, u32) {
        match self.get(id) {
            Type::Elementary(it) => (it.size(), it.size()),
            Type::Enumeration(Enumeration { base, .. }) | Type::Subrange { base, .. } => {
                (base.size(), base.size())
            }
            Type::Text(capacity) => (u32::from(*capacity) + 1, 1),
            Type::Structure(structure) => (structure.members.size, 8),
            Type::Array(array) => {
                let align = match self.get(array.of) {
                    Type::Text(_) => 1,
                    _ => self.elementary(array.of).map_or(8, Elementary::size),
                };
                (array.stride.saturating_mul(array.count), align)
            }
            Type::Block(unit) => (unit_size(*unit), 8),
            Type::AnyInteger | Type::AnyReal | Type::Wrong => (8, 8),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use Elementary as E;

    #[test]
    fn the_fixed_places_are_those_of_the_types_they_name() {
        let types = Types::new();
        assert!(matches!(types.get(WRONG), Type::Wrong));
        assert!(matches!(types.get(ANY_INTEGER), Type::AnyInteger));
        assert!(matches!(types.get(ANY_REAL), Type::AnyReal));
        assert!(matches!(types.get(BOOL), Type::Elementary(E::Bool)));
        for it in E::ALL {
            assert!(matches!(types.get(Types::of(*it)), Type::Elementary(found) if found == it));
        }
    }

    /// Covers: ST13
    #[test]
    fn only_what_loses_nothing_is_converted_without_a_word() {
        for (from, to) in [
            (E::Sint, E::Int),
            (E::Int, E::Dint),
            (E::Dint, E::Lint),
            (E::Usint, E::Ulint),
            (E::Usint, E::Int),
            (E::Udint, E::Lint),
            (E::Byte, E::Lword),
            (E::Int, E::Real),
            (E::Uint, E::Real),
            (E::Dint, E::Lreal),
            (E::Udint, E::Lreal),
            (E::Real, E::Lreal),
        ] {
            assert!(from.widens_to(to), "{from:?} {to:?}");
            assert!(!to.widens_to(from), "{to:?} {from:?}");
        }
        for (from, to) in [
            (E::Lint, E::Lreal),
            (E::Ulint, E::Lreal),
            (E::Dint, E::Real),
            (E::Bool, E::Byte),
            (E::Byte, E::Usint),
            (E::Usint, E::Byte),
            (E::Int, E::Uint),
            (E::Uint, E::Int),
            (E::Ulint, E::Lint),
            (E::Time, E::Lint),
        ] {
            assert!(!from.widens_to(to), "{from:?} {to:?}");
        }
    }

    /// Covers: ST33
    #[test]
    fn whole_numbers_wrap_in_their_width() {
        assert_eq!(E::Sint.wrapped(128), -128);
        assert_eq!(E::Usint.wrapped(-1), 255);
        assert_eq!(E::Lint.wrapped(1 << 63), -(1 << 63));
        assert_eq!(E::Ulint.wrapped(-1), (1 << 64) - 1);
    }
}

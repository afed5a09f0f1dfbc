//! Variables AT addresses. Each is a variable of its own here; in a control system one address is one place in memory.

use super::Checker;
use crate::error::{Code, Diagnostic};
use crate::source::Span;
use crate::types::{Member, MemberKind, Type, TypeId, UnitId};
use std::cmp::Reverse;
use std::collections::BTreeMap;
use std::ops::Range;

/// A variable AT an address.
struct Located {
    name: String,
    address: String,
    span: Span,
    bits: Option<Bits>,
}

/// What an address takes of its area, in bits. Systems differ: `%MW1` begins at byte 1 or at byte 2.
struct Bits {
    area: u8,
    by_byte: Range<u64>,
    by_size: Range<u64>,
}

impl Checker<'_> {
    /// Reports addresses that several variables have, or share a part of.
    pub(super) fn check_addresses(&mut self) {
        let mut found: Vec<Located> = Vec::new();
        let mut units: Vec<UnitId> = self.running.iter().map(|it| it.unit).collect();
        for global in &self.globals {
            found.extend(located(&global.member));
            self.units_of(global.member.ty, 1, &mut units);
        }
        // Two instances of a unit are enough to tell that its variables share their addresses.
        let mut instances: BTreeMap<UnitId, u32> = BTreeMap::new();
        while let Some(unit) = units.pop() {
            let count = instances.entry(unit).or_default();
            *count += 1;
            if *count > 2 {
                continue;
            }
            for member in &self.unit(unit).members.list {
                if !matches!(member.kind, MemberKind::External(_) | MemberKind::InOut) {
                    found.extend(located(member));
                    self.units_of(member.ty, 1, &mut units);
                }
            }
        }
        found.sort_by_key(|it| it.span);
        let mut first: BTreeMap<&str, &Located> = BTreeMap::new();
        let mut told = Vec::new();
        for it in &found {
            match first.get(it.address.as_str()) {
                Some(other) => {
                    let message = if it.span == other.span {
                        format!(
                            "`{}` of several instances is at one address, {}",
                            it.name, it.address
                        )
                    } else {
                        format!(
                            "`{}` and `{}` are two variables at one address, {}",
                            other.name, it.name, it.address
                        )
                    };
                    let wrong = Diagnostic::error(Code::DuplicateName, it.span, message);
                    told.push(if it.span == other.span {
                        wrong.help("declare it in VAR_GLOBAL, and hand it over as VAR_INPUT or VAR_IN_OUT")
                    } else {
                        let wrong = wrong.related(other.span, "the other one");
                        wrong.help("declare one of them, in VAR_GLOBAL, and use that in their place")
                    });
                }
                None => _ = first.insert(&it.address, it),
            }
        }
        let mut parts: Vec<(&Located, &Bits)> = first
            .values()
            .filter_map(|it| Some((*it, it.bits.as_ref()?)))
            .collect();
        // A whole comes before its parts.
        parts.sort_by_key(|(_, bits)| (bits.area, bits.by_byte.start, Reverse(bits.by_byte.end)));
        let mut furthest: Option<(&Located, &Bits)> = None;
        for (it, bits) in parts {
            if let Some((other, before)) = furthest
                && before.overlaps(bits)
            {
                let message = format!(
                    "`{}` at {} is a part of `{}` at {} in other systems; here they are apart",
                    it.name, it.address, other.name, other.address
                );
                let doubt = Diagnostic::warning(Code::Portability, it.span, message);
                let doubt = doubt.related(other.span, "the other one");
                told.push(doubt.help("take bits of one variable: `w.3`"));
            }
            let further = furthest
                .is_none_or(|(_, before)| before.area != bits.area || bits.by_byte.end > before.by_byte.end);
            if further {
                furthest = Some((it, bits));
            }
        }
        for diagnostic in told {
            self.tell(diagnostic);
        }
    }

    /// The units whose instances a type holds, each this often, or twice if it is in an array.
    fn units_of(&self, ty: TypeId, times: usize, units: &mut Vec<UnitId>) {
        match self.types.get(ty) {
            Type::Block(unit) => units.extend(std::iter::repeat_n(*unit, times)),
            Type::Array(array) => self.units_of(array.of, if array.count > 1 { 2 } else { times }, units),
            Type::Structure(structure) => {
                let members = structure.members.list.iter();
                members.for_each(|member| self.units_of(member.ty, times, units));
            }
            _ => {}
        }
    }
}

fn located(member: &Member) -> Option<Located> {
    let address = member.address.as_ref().filter(|it| !it.ends_with('*'))?;
    let (area, rest) = address.strip_prefix('%')?.split_at_checked(1)?;
    // A bit may be written without X.
    let (size, number) = match rest.split_at_checked(1)? {
        (size @ ("X" | "B" | "W" | "D" | "L"), number) => (size, number),
        _ => ("X", rest),
    };
    Some(Located {
        name: member.name.clone(),
        address: format!("%{area}{size}{number}"),
        span: member.span,
        bits: bits(area, size, number),
    })
}

/// `None` if systems agree on nothing.
fn bits(area: &str, size: &str, number: &str) -> Option<Bits> {
    let area = *area.as_bytes().first()?;
    let width: u64 = match size {
        "X" => {
            let (byte, bit) = number.split_once('.')?;
            let bit = bit.parse::<u64>().ok().filter(|bit| *bit < 8)?;
            let at = u64::from(byte.parse::<u32>().ok()?) * 8 + bit;
            let all = at..at + 1;
            return Some(Bits {
                area,
                by_byte: all.clone(),
                by_size: all,
            });
        }
        "B" => 8,
        "W" => 16,
        "D" => 32,
        _ => 64,
    };
    let number = u64::from(number.parse::<u32>().ok()?);
    Some(Bits {
        area,
        by_byte: number * 8..number * 8 + width,
        by_size: number * width..(number + 1) * width,
    })
}

impl Bits {
    /// Whether they share something in either way to count.
    fn overlaps(&self, other: &Self) -> bool {
        let share = |one: &Range<u64>, two: &Range<u64>| one.start < two.end && two.start < one.end;
        self.area == other.area
            && share(&self.by_byte, &other.by_byte)
            && share(&self.by_size, &other.by_size)
    }
}

//! Initial values.

use super::Checker;
use crate::error::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::{Expression, Ident, Initial};
use crate::types::{MemberKind, Start, Type, TypeId, WRONG};

impl<'a> Checker<'a> {
    /// The initial value of a variable of type `ty`.
    pub(super) fn start(&mut self, initial: &'a Initial, ty: TypeId) -> Start {
        if ty == WRONG {
            return Start::Default;
        }
        match initial {
            Initial::Value(value) => self.start_value(value, ty),
            Initial::List(items, span) => self.start_list(items, *span, ty),
            Initial::Members(members, span) => self.start_members(members, *span, ty),
        }
    }

    fn start_value(&mut self, value: &'a Expression, ty: TypeId) -> Start {
        let found = self.expression(value, Some(ty));
        let found = self.convert(found, ty);
        if found.is_wrong() {
            return Start::Default;
        }
        if let crate::typed::Kind::Text(bytes) = found.kind {
            return Start::Text(bytes);
        }
        match found.constant() {
            Some(constant) => Start::Value(constant),
            None => {
                self.not_constant(found.span);
                Start::Default
            }
        }
    }

    fn start_list(&mut self, items: &'a [(Option<Expression>, Initial)], span: Span, ty: TypeId) -> Start {
        let Type::Array(array) = self.types.get(ty) else {
            let message = format!("{} has no elements", self.type_name(ty));
            self.error(Code::WrongType, span, message, "`[..]` gives values to an array");
            return Start::Default;
        };
        let (of, count) = (array.of, array.count);
        let mut list = Vec::new();
        let mut total = 0_u64;
        for (times, value) in items {
            let times = times.as_ref().map_or(Some(1), |times| self.whole(times));
            let times = times
                .and_then(|times| u32::try_from(times).ok())
                .unwrap_or(u32::MAX);
            total += u64::from(times);
            if total > u64::from(count) {
                let message = format!("these are more values than the {count} elements of the array");
                self.error(Code::OutOfRange, span, message, "");
                break;
            }
            list.push((times, self.start(value, of)));
        }
        Start::List(list)
    }

    fn start_members(&mut self, given: &'a [(Ident, Initial)], span: Span, ty: TypeId) -> Start {
        let mut list: Vec<(usize, Start)> = Vec::new();
        for (name, initial) in given {
            let members = match self.types.get(ty) {
                Type::Structure(structure) => &structure.members,
                Type::Block(unit) => &self.unit(*unit).members,
                _ => {
                    let message = format!("{} has no members", self.type_name(ty));
                    self.error(
                        Code::WrongType,
                        span,
                        message,
                        "`(A := 1, B := 2)` gives values to a structure",
                    );
                    return Start::Default;
                }
            };
            let Some((place, member)) = members.find(&name.key()) else {
                if let Type::Block(unit) = *self.types.get(ty)
                    && self.is_damaged(unit)
                {
                    continue;
                }
                let names = members.list.iter().map(|member| member.name.as_str());
                let guess = self.guess(&name.text, names);
                let message = format!("{} has no member `{}`", self.type_name(ty), name.text);
                self.tell(Diagnostic::error(Code::UnknownMember, name.span, message).maybe_help(guess));
                continue;
            };
            let (kind, of, constant) = (member.kind, member.ty, member.constant);
            if !matches!(
                kind,
                MemberKind::Field | MemberKind::Input | MemberKind::Output | MemberKind::Var
            ) {
                let message = format!("`{}` has no first value", name.text);
                self.error(
                    Code::NotWritable,
                    name.span,
                    message,
                    "first values are given to inputs",
                );
                continue;
            }
            if constant && kind == MemberKind::Var {
                let message = format!("`{}` is a CONSTANT of {}", name.text, self.type_name(ty));
                self.error(
                    Code::NotWritable,
                    name.span,
                    message,
                    "an instance cannot change it; make it a VAR_INPUT",
                );
                continue;
            }
            if list.iter().any(|(other, _)| *other == place) {
                let message = format!("`{}` is given twice", name.text);
                self.error(Code::BadArgument, name.span, message, "");
                continue;
            }
            let start = self.start(initial, of);
            list.push((place, start));
        }
        Start::Members(list)
    }
}

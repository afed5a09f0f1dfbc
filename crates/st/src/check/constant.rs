//! Constants: VAR CONSTANT and VAR_GLOBAL CONSTANT, evaluated when they are needed.

use super::{Checker, ConstantKey, State};
use crate::error::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::Initial;
use crate::typed::{Expr, Kind};
use crate::types::Constant;

impl Checker<'_> {
    /// The value of a constant; `None` if there is no such constant.
    pub(super) fn constant(&mut self, key: &ConstantKey, span: Span) -> Option<Expr> {
        let (unit, name) = match key {
            ConstantKey::OfUnit(unit, name) => (Some(*unit), name.clone()),
            ConstantKey::Global(place) => (None, self.globals[*place].member.name.to_ascii_uppercase()),
        };
        let entry = self.constants.get_mut(key)?;
        match entry.state {
            State::Done => {}
            State::Busy => {
                let wrong =
                    Diagnostic::error(Code::Circle, span, format!("the constant `{name}` needs itself"));
                self.tell(wrong.help("give one of the constants in the circle a number"));
                return Some(Expr::wrong(span));
            }
            State::Todo => {
                entry.state = State::Busy;
                let (spec, initial) = (entry.spec, entry.initial);
                let value = self.needing(span, None, |checker| {
                    checker.in_scope(unit, |checker| {
                        let (ty, _) = checker.spec(spec);
                        checker.types.elementary(ty)?;
                        let Some(Initial::Value(initial)) = initial else {
                            return None;
                        };
                        let value = checker.expression(initial, Some(ty));
                        let value = checker.convert(value, ty);
                        Some((ty, value.constant()?))
                    })
                });
                if let Some(entry) = self.constants.get_mut(key) {
                    entry.state = State::Done;
                    entry.value = value;
                }
            }
        }
        let (ty, value) = self.constants.get(key)?.value?;
        let kind = match value {
            Constant::Integer(number) => Kind::Integer(number),
            Constant::Real(number) => Kind::Real(number),
        };
        Some(Expr::new(kind, self.types.value_type(ty), span))
    }
}

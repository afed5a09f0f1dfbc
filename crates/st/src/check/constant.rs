//! Constants: VAR CONSTANT and VAR_GLOBAL CONSTANT, evaluated when they are needed.

use super::{Checker, State};
use crate::error::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::Initial;
use crate::typed::{Expr, Kind};
use crate::types::{Constant, UnitId};

impl Checker<'_> {
    /// The value of a constant of a unit, or of all units; `None` if there is no such constant.
    pub(super) fn constant(&mut self, unit: Option<UnitId>, key: &str, span: Span) -> Option<Expr> {
        let entry_key = (unit, key.to_owned());
        let entry = self.constants.get_mut(&entry_key)?;
        match entry.state {
            State::Done => {}
            State::Busy => {
                let wrong =
                    Diagnostic::error(Code::Circle, span, format!("the constant `{key}` needs itself"));
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
                if let Some(entry) = self.constants.get_mut(&entry_key) {
                    entry.state = State::Done;
                    entry.value = value;
                }
            }
        }
        let (ty, value) = self.constants.get(&entry_key)?.value?;
        let kind = match value {
            Constant::Integer(number) => Kind::Integer(number),
            Constant::Real(number) => Kind::Real(number),
        };
        Some(Expr::new(kind, self.types.value_type(ty), span))
    }
}

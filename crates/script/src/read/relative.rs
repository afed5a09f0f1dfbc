//! Claims about events: answers, durations, counts, and windows by condition.

use super::Reader;
use super::expect::is_edge;
use super::json::Node;
use super::shape::{self, Shape};
use super::value::{Fields, WHOLE_MAX};
use crate::error::{Code, Diagnostic};
use crate::model::{Bounds, ClaimKind, Conditions, Window};

impl Reader {
    /// A claim with `when`, `after`, `duration` or `count`; `value` is its value.
    pub(super) fn relative(
        &mut self,
        key: &str,
        value: &Node,
        fields: &Fields<'_>,
        shape: &Shape,
    ) -> Option<ClaimKind> {
        let what = shape.what;
        match key {
            "duration" => {
                let ends = self.ends(value);
                let bounds = self.bounds(fields, what, |reader, node, key| reader.scans(node, key));
                let each = self.optional(fields, "each", false, Self::boolean);
                Some(ClaimKind::Duration {
                    ends: ends?,
                    bounds: bounds?,
                    each: each?,
                })
            }
            "count" => {
                let that = self.conditions(value, "`count`");
                let bounds = self.bounds(fields, what, |reader, node, key| {
                    let number = reader.whole(node, key, 0..=WHOLE_MAX as i64)?;
                    Some(number.unsigned_abs())
                });
                Some(ClaimKind::Count {
                    that: that?,
                    bounds: bounds?,
                })
            }
            _ => {
                let first = key == "after";
                let limit = if first { "by" } else { "within" };
                let when = self.conditions(value, if first { "`after`" } else { "`when`" });
                let within = self
                    .require(fields, limit, what)
                    .and_then(|node| self.scans(node, if first { "`by`" } else { "`within`" }));
                let that = self.that(fields, shape);
                Some(ClaimKind::Answered {
                    when: when?,
                    within: within?,
                    that: that?,
                    first,
                })
            }
        }
    }

    /// The begin and the end of a duration.
    fn ends(&mut self, node: &Node) -> Option<[Conditions; 2]> {
        let items = self.list(node, "`duration`")?;
        let [begin, end] = items else {
            let message = format!(
                "`duration` takes two conditions, its begin and its end; here are {}",
                items.len()
            );
            return self.refuse(
                Diagnostic::new(Code::BadValue, node.span, message)
                    .help("for example \"duration\": [{\"GO\": true}, {\"move.Done\": true}]"),
            );
        };
        let begin = self.conditions(begin, "the begin of `duration`");
        let end = self.conditions(end, "the end of `duration`");
        Some([begin?, end?])
    }

    /// `eq`, `le` and `ge`; at least one is given.
    fn bounds(
        &mut self,
        fields: &Fields<'_>,
        what: &str,
        mut read: impl FnMut(&mut Self, &Node, &str) -> Option<u64>,
    ) -> Option<Bounds> {
        let mut bounds = Bounds::default();
        let mut good = true;
        let mut last = None;
        for key in ["eq", "le", "ge"] {
            let Some(node) = fields.get(key) else { continue };
            last = Some(node);
            let Some(number) = read(self, node, &format!("`{key}`")) else {
                good = false;
                continue;
            };
            if key != "le" {
                bounds.ge = Some(bounds.ge.map_or(number, |ge| ge.max(number)));
            }
            if key != "ge" {
                bounds.le = Some(bounds.le.map_or(number, |le| le.min(number)));
            }
        }
        let Some(last) = last else {
            let message = format!("{what} says how much it may be: give `le` or `ge`");
            return self.refuse(Diagnostic::new(Code::MissingKey, fields.brace(), message));
        };
        match (bounds.ge, bounds.le) {
            (Some(ge), Some(le)) if ge > le => {
                let message =
                    format!("{what} contradicts itself: no number is at least {ge} and at most {le}");
                self.refuse(
                    Diagnostic::new(Code::BadValue, last.span, message)
                        .help("widen the bounds, or turn them"),
                )
            }
            _ => good.then_some(bounds),
        }
    }

    /// A count of scans from 1 on.
    pub(super) fn at_least_one(&mut self, node: &Node, what: &str) -> Option<u64> {
        let scans = self.scans(node, what)?;
        if scans > 0 {
            return Some(scans);
        }
        let message = format!("{what} is 0: it must be one scan at least");
        self.refuse(Diagnostic::new(Code::BadValue, node.span, message))
    }

    /// The conditions at which the scans of a claim begin and end.
    pub(super) fn claim_window(&mut self, claim: &Node) -> Option<Window> {
        let mut edge = |name: &str| {
            let Some(node) = claim.member(name).filter(|node| is_edge(node)) else {
                return Some(None);
            };
            let fields = self.fields(node, &shape::WINDOW_EDGE)?;
            let when = fields.get("when")?;
            self.conditions(when, "`when`").map(Some)
        };
        Some(Window {
            from: edge("from")?,
            to: edge("to")?,
        })
    }
}

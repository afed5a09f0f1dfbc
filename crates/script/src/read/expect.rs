//! Claims: what the author says of the run.

use super::Reader;
use super::json::Node;
use super::names::nearest;
use super::shape::{self, Shape};
use super::value::Fields;
use crate::error::{Code, Diagnostic, quoted};
use crate::format::number_text;
use crate::model::{Claim, ClaimKind, Conditions, Point, Range};
use standstill_fb::PinType;

impl Reader {
    pub(super) fn claims(&mut self, fields: &Fields<'_>) -> Option<Vec<Claim>> {
        let Some(node) = fields.get("expect") else {
            return Some(Vec::new());
        };
        let items = self.list(node, "`expect`")?;
        let mut index = 0;
        self.each(items, |reader, node| {
            let kind = reader.claim(node);
            let path = format!("expect[{index}]");
            index += 1;
            Some(Claim {
                path,
                span: node.span,
                kind: kind?,
            })
        })
    }

    fn claim(&mut self, node: &Node) -> Option<ClaimKind> {
        let members = self.map(node, "a claim")?;
        let kind = |shape: &&Shape| members.iter().any(|(key, _)| key.text == shape.keys[0]);
        let Some(shape) = shape::CLAIMS.iter().find(kind) else {
            let kinds = shape::CLAIMS.iter().map(|shape| shape.keys[0]);
            let slip = members
                .iter()
                .filter(|(key, _)| key.text != "note")
                .find_map(|(key, _)| nearest(&key.text, kinds.clone()));
            let message =
                "a claim says one of `at`, `by`, `always`, `never`, `once`, `exclusive`, `within_limits`";
            self.report(Diagnostic::new(Code::MissingKey, members.brace(), message).maybe_help(slip));
            return None;
        };
        let fields = self.fields(node, shape)?;
        let key = shape.keys[0];
        let value = fields.get(key)?;
        match key {
            "at" => {
                let scan = self.scan_in_run(value, "`at`");
                let that = self.that(&fields, shape.what);
                Some(ClaimKind::At(scan?, that?))
            }
            "by" => {
                let to = self.scan_in_run(value, "`by`");
                let from = self.from(&fields);
                let that = self.that(&fields, shape.what);
                let range = Range {
                    from: from?,
                    to: Some(to?),
                };
                self.check_range(range, value)?;
                Some(ClaimKind::By(range, that?))
            }
            "exclusive" => {
                let range = self.range(&fields);
                let points = self.exclusive(value);
                Some(ClaimKind::Exclusive(range?, points?))
            }
            "within_limits" => {
                let range = self.range(&fields);
                let axis = self.axis_index(value, "`within_limits`");
                let factor = fields.get("factor").map_or(Some(1.0), |node| self.factor(node));
                Some(ClaimKind::WithinLimits {
                    range: range?,
                    axis: axis?,
                    factor: factor?,
                })
            }
            _ => {
                let range = self.range(&fields);
                let that = self.conditions(value, &quoted(key));
                let during = fields
                    .get("while")
                    .map_or(Some(Vec::new()), |node| self.conditions(node, "`while`"));
                let (range, that, during) = (range?, that?, during?);
                Some(match key {
                    "always" => ClaimKind::Always { range, during, that },
                    "never" => ClaimKind::Never { range, during, that },
                    _ => ClaimKind::Once(range, that),
                })
            }
        }
    }

    fn that(&mut self, fields: &Fields<'_>, what: &str) -> Option<Conditions> {
        let node = self.require(fields, "that", what)?;
        self.conditions(node, "`that`")
    }

    fn from(&mut self, fields: &Fields<'_>) -> Option<u64> {
        fields
            .get("from")
            .map_or(Some(0), |node| self.scan_in_run(node, "`from`"))
    }

    fn range(&mut self, fields: &Fields<'_>) -> Option<Range> {
        let from = self.from(fields);
        let Some(node) = fields.get("to") else {
            return Some(Range {
                from: from?,
                to: None,
            });
        };
        let to = self.scan_in_run(node, "`to`");
        let range = Range {
            from: from?,
            to: Some(to?),
        };
        self.check_range(range, node)?;
        Some(range)
    }

    fn check_range(&mut self, range: Range, end: &Node) -> Option<()> {
        match range.to {
            Some(to) if to < range.from => {
                let message = format!(
                    "the range ends with scan {to}, before it begins with scan {}",
                    range.from
                );
                self.report(Diagnostic::new(Code::BadValue, end.span, message));
                None
            }
            _ => Some(()),
        }
    }

    fn factor(&mut self, node: &Node) -> Option<f64> {
        let factor = self.finite(node, "`factor`")?;
        if factor > 0.0 {
            return Some(factor);
        }
        let message = format!("`factor` is {}: it must be above 0", number_text(factor));
        self.report(Diagnostic::new(Code::BadValue, node.span, message));
        None
    }

    fn exclusive(&mut self, node: &Node) -> Option<Vec<(String, Point)>> {
        let items = self.list(node, "`exclusive`")?;
        if items.len() < 2 {
            let message = "`exclusive` needs at least two signals";
            self.report(Diagnostic::new(Code::BadValue, node.span, message));
            return None;
        }
        self.each(items, |reader, item| {
            let text = reader.text(item, "`exclusive`")?;
            let (point, ty) = reader.point(text, item.span)?;
            if ty == PinType::Bool {
                return Some((text.to_owned(), point));
            }
            let message = format!("`exclusive` takes BOOLs, {} is {}", quoted(text), ty.iec_name());
            reader.report(Diagnostic::new(Code::WrongType, item.span, message));
            None
        })
    }
}

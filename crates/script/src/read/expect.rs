//! Claims: the author's statements about the run.

use super::json::Node;
use super::names::nearest;
use super::shape::{self, Shape};
use super::value::Fields;
use super::{Reader, hints};
use crate::error::{Code, Diagnostic, quoted};
use crate::format::number_text;
use crate::model::{Claim, ClaimKind, Conditions, Follow, Point, Range};
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
                may_be_vacuous: node.member("vacuous").is_some(),
                window: reader.claim_window(node)?,
                kind: kind?,
            })
        })
    }

    fn claim(&mut self, node: &Node) -> Option<ClaimKind> {
        let members = self.map(node, "a claim")?;
        let kind = |shape: &&Shape| {
            members
                .iter()
                .any(|(key, _)| shape.names().next() == Some(&key.text))
        };
        let Some(shape) = shape::CLAIMS.iter().find(kind) else {
            let kinds = shape::CLAIMS.iter().filter_map(|shape| shape.names().next());
            let slip = members
                .iter()
                .filter(|(key, _)| key.text != "note")
                .find_map(|(key, _)| {
                    hints::key(&key.text, kinds.clone()).or_else(|| nearest(&key.text, kinds.clone()))
                });
            let message = "a claim says one of `at`, `by`, `always`, `never`, `once`, `exclusive`, `within_limits`, `follows`, `when`, \
                 `after`, `duration`, `count`";
            return self.refuse(Diagnostic::new(Code::MissingKey, members.brace(), message).maybe_help(slip));
        };
        let fields = self.fields(node, shape)?;
        self.may_be_vacuous(&fields);
        let key = shape.names().next()?;
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
            "when" | "after" | "duration" | "count" => self.relative(key, value, &fields, shape.what),
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
            "follows" => {
                let range = self.range(&fields);
                let (follow, during) = self.follows(value)?;
                Some(ClaimKind::Follows {
                    range: range?,
                    during,
                    follow,
                })
            }
            _ => {
                let range = self.range(&fields);
                let that = self.conditions(value, &quoted(key));
                let during = self.optional(&fields, "while", Vec::new(), Self::conditions);
                let (range, that, during) = (range?, that?, during?);
                if let (Some(node), "never") = (fields.get("for"), key) {
                    let scans = self.at_least_one(node, "`for`")?;
                    return Some(ClaimKind::NeverFor {
                        range,
                        during,
                        that,
                        scans,
                    });
                }
                Some(match key {
                    "always" => ClaimKind::Always { range, during, that },
                    "never" => ClaimKind::Never { range, during, that },
                    _ => ClaimKind::Once(range, that),
                })
            }
        }
    }

    fn that(&mut self, fields: &Fields<'_>, what: &str) -> Option<Conditions> {
        self.needed(fields, "that", what, Self::conditions)
    }

    fn from(&mut self, fields: &Fields<'_>) -> Option<u64> {
        fields
            .get("from")
            .filter(|node| !is_edge(node))
            .map_or(Some(0), |node| self.scan_in_run(node, "`from`"))
    }

    pub(super) fn range(&mut self, fields: &Fields<'_>) -> Option<Range> {
        let from = self.from(fields);
        let Some(node) = fields.get("to").filter(|node| !is_edge(node)) else {
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
                self.refuse(Diagnostic::new(Code::BadValue, end.span, message))
            }
            _ => Some(()),
        }
    }

    /// The law of a slave, and the conditions under which it holds.
    fn follows(&mut self, node: &Node) -> Option<(Follow, Conditions)> {
        let fields = self.fields(node, &shape::FOLLOWS)?;
        let what = shape::FOLLOWS.what;
        let slave = self.needed(&fields, "slave", what, Self::axis_index);
        let leader = self.require(&fields, "master", what);
        let master = leader.and_then(|node| self.axis_index(node, "`master`"));
        let num = self.needed(&fields, "num", what, |it, node, key| {
            it.whole(node, key, i16::MIN.into()..=i16::MAX.into())
        });
        let den = self.needed(&fields, "den", what, |it, node, key| {
            it.whole(node, key, 1..=u16::MAX.into())
        });
        let during = self.optional(&fields, "while", Vec::new(), Self::conditions);
        let anchor = fields
            .get("anchor")
            .map_or(Some(None), |node| self.anchor(node).map(Some));
        let (slave, master) = (slave?, master?);
        if slave == master {
            let message = "an axis does not follow itself";
            let help = "`master` is the axis that leads, `slave` the one behind it";
            return self.refuse(Diagnostic::new(Code::BadValue, leader?.span, message).help(help));
        }
        let follow = Follow {
            slave,
            master,
            num: num?.try_into().ok()?,
            den: den?.try_into().ok()?,
            anchor: anchor?,
        };
        Some((follow, during?))
    }

    /// A position of the master, and the position of the slave then.
    fn anchor(&mut self, node: &Node) -> Option<[f64; 2]> {
        let fields = self.fields(node, &shape::ANCHOR)?;
        let master = self.needed(&fields, "master", shape::ANCHOR.what, Self::finite);
        let slave = self.needed(&fields, "slave", shape::ANCHOR.what, Self::finite);
        Some([master?, slave?])
    }

    fn factor(&mut self, node: &Node) -> Option<f64> {
        let factor = self.finite(node, "`factor`")?;
        if factor > 0.0 {
            return Some(factor);
        }
        let message = format!("`factor` is {}: it must be above 0", number_text(factor));
        self.refuse(Diagnostic::new(Code::BadValue, node.span, message))
    }

    fn exclusive(&mut self, node: &Node) -> Option<Vec<(String, Point)>> {
        let items = self.list(node, "`exclusive`")?;
        if items.len() < 2 {
            let message = "`exclusive` needs at least two signals";
            return self.refuse(Diagnostic::new(Code::BadValue, node.span, message));
        }
        self.each(items, |reader, item| {
            let text = reader.text(item, "`exclusive`")?;
            let (point, ty) = reader.point(text, item.span)?;
            if ty == PinType::Bool {
                return Some((text.to_owned(), point));
            }
            let message = format!("`exclusive` takes BOOLs, {} is {}", quoted(text), ty.iec_name());
            reader.refuse(Diagnostic::new(Code::WrongType, item.span, message))
        })
    }
}

/// Whether a window begins or ends here by conditions.
pub(super) fn is_edge(node: &Node) -> bool {
    node.member("when").is_some()
}

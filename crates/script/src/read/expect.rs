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
            let claim = reader.claim(node);
            let window = reader.claim_window(node);
            let path = format!("expect[{index}]");
            index += 1;
            let (range, during, kind) = claim?;
            Some(Claim {
                path,
                span: node.span,
                may_be_vacuous: node.member("vacuous").is_some(),
                range,
                window: window?,
                during,
                kind,
            })
        })
    }

    /// The range of a claim, its `while`, and its statement.
    fn claim(&mut self, node: &Node) -> Option<(Range, Conditions, ClaimKind)> {
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
        let range = match key {
            "at" => self.scan_in_run(value, "`at`").map(|scan| Range {
                from: scan,
                to: Some(scan),
            }),
            "by" => self.range_to(&fields, value, "`by`"),
            _ => self.range(&fields),
        };
        let (during, kind) = match key {
            "at" => (Some(Vec::new()), self.that(&fields, shape).map(ClaimKind::At)),
            "by" => (Some(Vec::new()), self.that(&fields, shape).map(ClaimKind::By)),
            "when" | "after" | "duration" | "count" => {
                let during = self.during(&fields);
                (during, self.relative(key, value, &fields, shape))
            }
            "exclusive" => {
                let points = self.exclusive(value);
                (Some(Vec::new()), points.map(ClaimKind::Exclusive))
            }
            "within_limits" => {
                let axis = self.axis_index(value, "`within_limits`");
                let factor = self.optional(&fields, "factor", 1.0, Self::factor);
                let kind = axis.zip(factor);
                let kind = kind.map(|(axis, factor)| ClaimKind::WithinLimits { axis, factor });
                (Some(Vec::new()), kind)
            }
            "follows" => self.follows(value).unzip(),
            _ => {
                let that = self.conditions(value, &quoted(key));
                let during = self.during(&fields);
                range?;
                let (that, during) = (that?, during?);
                let kind = match (key, fields.get("for")) {
                    ("always", _) => ClaimKind::Always(that),
                    ("once", _) => ClaimKind::Once(that),
                    (_, None) => ClaimKind::Never(that),
                    (_, Some(node)) => {
                        let scans = self.at_least_one(node, "`for`")?;
                        ClaimKind::NeverFor { that, scans }
                    }
                };
                (Some(during), Some(kind))
            }
        };
        Some((range?, during?, kind?))
    }

    pub(super) fn that(&mut self, fields: &Fields<'_>, shape: &Shape) -> Option<Conditions> {
        self.needed(fields, "that", shape.what, Self::conditions)
    }

    fn during(&mut self, fields: &Fields<'_>) -> Option<Conditions> {
        self.optional(fields, "while", Vec::new(), Self::conditions)
    }

    fn from(&mut self, fields: &Fields<'_>) -> Option<u64> {
        fields
            .get("from")
            .filter(|node| !is_edge(node))
            .map_or(Some(0), |node| self.scan_in_run(node, "`from`"))
    }

    fn range(&mut self, fields: &Fields<'_>) -> Option<Range> {
        match fields.get("to").filter(|node| !is_edge(node)) {
            Some(end) => self.range_to(fields, end, "`to`"),
            None => Some(Range {
                from: self.from(fields)?,
                to: None,
            }),
        }
    }

    /// The range up to the scan in `end`.
    fn range_to(&mut self, fields: &Fields<'_>, end: &Node, what: &str) -> Option<Range> {
        let from = self.from(fields);
        let to = self.scan_in_run(end, what)?;
        let from = from?;
        if from <= to {
            return Some(Range { from, to: Some(to) });
        }
        let message = format!("the range ends with scan {to}, before it begins with scan {from}");
        self.refuse(Diagnostic::new(Code::BadValue, end.span, message))
    }

    /// The conditions under which a slave follows, and the law.
    fn follows(&mut self, node: &Node) -> Option<(Conditions, ClaimKind)> {
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
        let during = self.during(&fields);
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
        Some((during?, ClaimKind::Follows(follow)))
    }

    /// A position of the master, and the position of the slave then.
    fn anchor(&mut self, node: &Node) -> Option<[f64; 2]> {
        let fields = self.fields(node, &shape::ANCHOR)?;
        let master = self.needed(&fields, "master", shape::ANCHOR.what, Self::finite);
        let slave = self.needed(&fields, "slave", shape::ANCHOR.what, Self::finite);
        Some([master?, slave?])
    }

    fn factor(&mut self, node: &Node, what: &str) -> Option<f64> {
        let factor = self.finite(node, what)?;
        if factor > 0.0 {
            return Some(factor);
        }
        let message = format!("{what} is {}: it must be above 0", number_text(factor));
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

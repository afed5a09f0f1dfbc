//! Tables at pins: a list of objects with the fields of the record.

use super::Reader;
use super::json::{Json, Node};
use super::names::suggestion;
use crate::error::{Code, Diagnostic, quoted};
use crate::model::Rows;
use standstill_fb::TableInfo;

impl Reader {
    /// The records at a pin of a table's type.
    pub(super) fn table(&mut self, node: &Node, info: TableInfo, what: &str) -> Option<Rows> {
        let Json::List(items) = &node.json else {
            let diagnostic = self.wrong_type(node, what, "a list of objects");
            self.report(diagnostic.help("for example [{}]; what is left out of a record is 0 or FALSE"));
            return None;
        };
        if items.len() > info.most {
            let message = format!("{what} has {} records: {} are the most", items.len(), info.most);
            self.report(Diagnostic::new(Code::BadValue, node.span, message));
            return None;
        }
        self.each(items, |reader, item| reader.record(item, info))
    }

    fn record(&mut self, node: &Node, info: TableInfo) -> Option<Vec<(usize, standstill_fb::Value)>> {
        let members = self.map(node, &format!("a record of {}", info.name))?;
        let mut cells = Vec::new();
        let mut good = true;
        for (key, node) in members.iter() {
            if key.text == "note" {
                good &= self.text(node, "`note`").is_some();
                continue;
            }
            let found = info.fields.iter().position(|field| field.name == key.text);
            let Some((place, field)) = found.and_then(|place| Some((place, info.fields.get(place)?))) else {
                let message = format!("{} has no field {}", info.name, quoted(&key.text));
                let names = info.fields.iter().map(|field| field.name);
                self.report(
                    Diagnostic::new(Code::UnknownKey, key.span, message)
                        .maybe_help(suggestion(&key.text, names)),
                );
                good = false;
                continue;
            };
            let what = format!("{} ({})", quoted(field.name), field.ty.iec_name());
            let value = self.value(node, field.ty, &what);
            good &= value.is_some();
            cells.extend(value.map(|value| (place, value)));
        }
        good.then_some(cells)
    }
}

//! Tables at pins: a list of objects with the fields of the record.

use super::Reader;
use super::json::{Json, Node};
use super::names::suggestion;
use crate::error::{Code, Diagnostic, quoted};
use standstill_fb::{TableInfo, TableRef, Value};

impl Reader {
    /// The records at a pin of a table's type; they join the numbers of all tables.
    pub(super) fn table(&mut self, node: &Node, info: TableInfo, what: &str) -> Option<TableRef> {
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
        let records = self.each(items, |reader, item| reader.record(item, info))?;
        let place = TableRef {
            first: u32::try_from(self.tables.len()).ok()?,
            records: u16::try_from(records.len()).ok()?,
        };
        self.tables.extend(records.into_iter().flatten());
        Some(place)
    }

    fn record(&mut self, node: &Node, info: TableInfo) -> Option<Vec<f64>> {
        let members = self.map(node, &format!("a record of {}", info.name))?;
        let mut cells = vec![0.0; info.fields.len()];
        let mut good = true;
        for (key, node) in members.iter() {
            if key.text == "note" {
                good &= self.text(node, "`note`").is_some();
                continue;
            }
            let mut fields = info.fields.iter().zip(&mut cells);
            let Some((field, cell)) = fields.find(|(field, _)| field.name == key.text) else {
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
            match self.value(node, field.ty, &what).and_then(Value::to_cell) {
                Some(number) => *cell = number,
                None => good = false,
            }
        }
        good.then_some(cells)
    }
}

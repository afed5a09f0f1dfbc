//! Tables at pins: a list of objects with the fields of the record.

use super::json::{Json, Node};
use super::names::suggestion;
use super::program::LoadGuest;
use super::value::{Fields, wrong_type};
use super::{Reader, shape};
use crate::csv;
use crate::error::{Code, Diagnostic, quoted};
use crate::model::NamedTable;
use standstill_fb::{TableInfo, TableRef, Value};
use standstill_trace::printable;

impl Reader {
    /// The records at a pin of a table's type; they are appended to the numbers of all tables.
    pub(super) fn table(&mut self, node: &Node, info: TableInfo, what: &str) -> Option<TableRef> {
        if let Json::Map(_) = &node.json {
            return self.named_table(node, info, what);
        }
        self.rows_of_table(node, info, what)
    }

    /// A table of the script, by its name.
    fn named_table(&mut self, node: &Node, info: TableInfo, what: &str) -> Option<TableRef> {
        let fields = self.fields(node, &shape::TABLE_USE)?;
        let node = self.require(&fields, "table", "a table's use")?;
        let name = self.text(node, "`table`")?;
        let Some((place, found)) = self.named_tables.get(name).copied() else {
            let help = suggestion(name, self.named_tables.keys().map(String::as_str));
            let help = help.or_else(|| Some("declare it under \"tables\"".to_owned()));
            let message = format!("there is no table {}", quoted(name));
            return self.refuse(Diagnostic::new(Code::UnknownSignal, node.span, message).maybe_help(help));
        };
        if found.name != info.name {
            let message = format!(
                "{what} takes a table of {}, and {} is one of {}",
                info.name,
                quoted(name),
                found.name
            );
            return self.refuse(Diagnostic::new(Code::WrongType, node.span, message));
        }
        // An invalid one was reported at its place.
        place
    }

    /// The tables that the script names; `load` returns the bytes of a file.
    pub(super) fn tables(&mut self, fields: &Fields<'_>, load: LoadGuest<'_>) -> Option<()> {
        let Some(node) = fields.get("tables") else {
            return Some(());
        };
        let members = self.map(node, "`tables`")?;
        let mut good = true;
        for (key, node) in members.iter() {
            let Some((info, place)) = self.declared_table(node, load) else {
                good = false;
                continue;
            };
            good &= place.is_some();
            self.named_tables.insert(key.text.clone(), (place, info));
        }
        good.then_some(())
    }

    /// The tables that the script names, for callers that need one by itself.
    pub(super) fn tables_by_name(&self) -> Vec<NamedTable> {
        let tables = self.named_tables.iter();
        let named = tables.filter_map(|(name, (place, info))| {
            Some(NamedTable {
                name: name.clone(),
                info: *info,
                place: (*place)?,
            })
        });
        named.collect()
    }

    fn declared_table(&mut self, node: &Node, load: LoadGuest<'_>) -> Option<(TableInfo, Option<TableRef>)> {
        let fields = self.fields(node, &shape::TABLE)?;
        let kind = self.require(&fields, "type", "a table")?;
        let name = self.text(kind, "`type`")?;
        let Some(info) = csv::table_info(name) else {
            let message = format!("no pin takes a table of {}", quoted(name));
            let help = "the rows of a cam are MC_CAM_POINT";
            return self.refuse(Diagnostic::new(Code::BadValue, kind.span, message).help(help));
        };
        let place = match (fields.get("rows"), fields.get("csv")) {
            (Some(rows), None) => self.rows_of_table(rows, info, "`rows`"),
            (None, Some(file)) => self.file_of_table(file, info, load),
            _ => {
                let message = "a table has either `rows` or `csv`";
                self.refuse(Diagnostic::new(Code::MissingKey, fields.brace(), message))
            }
        };
        Some((info, place))
    }

    fn file_of_table(&mut self, node: &Node, info: TableInfo, load: LoadGuest<'_>) -> Option<TableRef> {
        let name = self.text(node, "`csv`")?;
        let rows = match load(name) {
            Ok(bytes) => csv::read(&bytes, &info).map_err(|fault| {
                let name = printable(name);
                let message = format!("{name}:{}:{}: {}", fault.line, fault.column, fault.message);
                (message, Some(fault.help))
            }),
            Err(why) => Err((format!("the table {} can't be read: {why}", quoted(name)), None)),
        };
        match rows {
            Ok(rows) => self.placed(rows),
            Err((message, help)) => {
                self.refuse(Diagnostic::new(Code::BadValue, node.span, message).maybe_help(help))
            }
        }
    }

    /// Appends records to the numbers of all tables.
    fn placed(&mut self, records: Vec<Vec<f64>>) -> Option<TableRef> {
        let place = TableRef {
            first: u32::try_from(self.tables.len()).ok()?,
            records: u16::try_from(records.len()).ok()?,
        };
        self.tables.extend(records.into_iter().flatten());
        Some(place)
    }

    /// The records of a list.
    fn rows_of_table(&mut self, node: &Node, info: TableInfo, what: &str) -> Option<TableRef> {
        let Json::List(items) = &node.json else {
            return self.refuse(
                wrong_type(node, what, "a list of objects")
                    .help("for example [{}]; what is left out of a record is 0 or FALSE"),
            );
        };
        if items.len() > info.most {
            let message = format!("{what} has {} records: {} are the most", items.len(), info.most);
            return self.refuse(Diagnostic::new(Code::BadValue, node.span, message));
        }
        let records = self.each(items, |reader, item| reader.record(item, info))?;
        self.placed(records)
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
